"""Buildings as triangles that stand on the ground.

In reading order:

- `heights`: lengths, floors and colours as files write them
- `triangulation`: polygons with holes cut into triangles
- `roofs`: closed solids with roofs over footprints
- `buildings`: buildings of a vector layer, standing on the ground
"""
