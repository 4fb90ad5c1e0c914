"""Sources of heights, and vertical datums.

In reading order:

- `layered`: combination of sources, each of which fills holes of the sources before
- `filling`: interpolation of holes in heights
- `heights`: heights of one source, on its pixel grid
- `datum`: vertical datums, and heights of their zero surfaces over the ellipsoid
"""
