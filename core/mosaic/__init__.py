"""Images of a dataset as one orthophoto of the ground.

In reading order:

- `raster`: pixels of the map that it is made of, and the ground in them
- `frames`: camera frames and map frames: which ground each shows, and where
- `bigtiff`: GeoTIFFs larger than memory
- `orthomosaic`: the image that shows each pixel from most nearly above, and its colours there
"""
