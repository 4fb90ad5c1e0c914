"""The QGIS plugin: what people see and touch. Calculations are in ``terrainav.core``."""
