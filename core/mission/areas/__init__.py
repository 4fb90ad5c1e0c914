"""Areas of missions.

In reading order:

- `area`: boxes, polygons and points
- `coords`: areas in text
- `geojson`: shapes of GeoJSON files, in degrees of WGS 84
- `files`: polygons in GeoJSON, KML and KMZ files
"""
