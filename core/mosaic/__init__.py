"""Orthomosaics of the images of a dataset.

In reading order:

- `raster`: the mosaic's pixel grid, and the ground in its pixels
- `frames`: camera frames and map frames, and the ground that they show
- `bigtiff`: GeoTIFFs larger than memory
- `orthomosaic`: each pixel from the image that sees it most nearly from above
"""
