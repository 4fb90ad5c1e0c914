"""Areas of missions.

In reading order:

- `area`: boxes, polygons and points
- `coords`: areas from text, in the paper's formats
- `geojson`: shapes of GeoJSON files, in degrees of WGS 84
- `files`: polygons from GeoJSON, KML and KMZ files
"""
