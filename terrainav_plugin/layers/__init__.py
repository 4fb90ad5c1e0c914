"""Layers of the project as a source of imagery, drawn by QGIS."""
