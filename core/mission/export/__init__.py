"""Plans written to files: tables, layers, and missions for autopilots.

In reading order:

- `writing`: formats by file ending
- `rows`: the table, and batches of rows, times and rings for the other formats
- `waypoints`, `sorties`: the path as points for an autopilot, one by one or as arrays
- `geojson`, `geopackage`, `kml`: formats of GIS and Google Earth
- `clearance`: files over relief, read back and checked against the surface
- `gpx`, `litchi`, `wpml`, `qgroundcontrol`, `survey`: formats of autopilots and navigation devices
- `vehicle`: upload over MAVLink
"""

from .writing import PartsAlreadyThere, PlanFiles, check_plan_ending, plan_texts, write_plan

__all__ = ["PartsAlreadyThere", "PlanFiles", "check_plan_ending", "plan_texts", "write_plan"]
