"""TerrAInav's core: missions, plans, imagery and capture without any GUI."""
