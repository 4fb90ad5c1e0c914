"""A plan in files: tables, layers, and missions for those who fly.

In reading order:

- `writing`: a file by its ending
- `rows`: the table, and rows, times and rings for others
- `waypoints`, `sorties`: captures, and the path through them, as an autopilot is asked for them
- `geojson`, `geopackage`, `kml`: for GIS and Google Earth
- `flown`: files that lead over relief, read back and held against the surface
- `gpx`, `litchi`, `wpml`, `qgroundcontrol`, `survey`: for those who fly
"""

from .writing import PartsAlreadyThere, PlanFiles, check_plan_ending, write_plan

__all__ = ["PartsAlreadyThere", "PlanFiles", "check_plan_ending", "write_plan"]
