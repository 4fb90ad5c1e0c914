"""Buildings as triangles that stand on the ground.

In reading order:

- `heights`: lengths, floors and colours as files write them
- `triangulation`: polygons with holes cut into triangles
- `roofs`: closed solids with roofs over footprints
- `buildings`: buildings of a vector layer, standing on the ground
- `surfaces`: polygons in space cut into triangles
- `appearance`: colours of materials and textures
- `cityjson`: buildings of CityJSON files
- `city_buildings`: these, at their heights or standing on the ground
- `opening`: buildings by name
"""
