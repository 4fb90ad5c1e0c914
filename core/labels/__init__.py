"""Labels of ground points: classes and instances from vector layers.

In reading order:

- `classes`: the classes of layers, their ids, names and colours
- `pieces`: features as polygons, and segments with a radius, in the plane of an image
- `drawing`: the topmost piece at each pixel's centre
- `kernels`: the same, compiled
- `label_map`: the layers of a mission, and the labels of an image
"""
