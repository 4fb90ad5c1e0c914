"""Features of vector files, in any reference system: read and checked once, then found by place.

- `names`: layers and fields as users name them, ``FILE[:LAYER][:FIELD]``
- `features`: features as arrays, in longitude and latitude
- `wkb`: geometries in well-known binary
- `geojson`: GeoJSON without GDAL
- `reading`: records of vector files, through GDAL where it is installed
- `shaping`: rings in WGS 84, with vertices where straight edges of the file's plane would bend
- `index`: the SQLite file in which the features of a layer are kept
- `layer`: an opened layer
"""
