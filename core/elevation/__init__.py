"""Sources of heights and their vertical datums.

In reading order:

- `layered`: sources of heights, one filling the holes of another
- `filling`: interpolation of holes in heights
- `heights`: heights of one source, in its pixels
- `datum`: vertical datums, and their heights over the ellipsoid
"""
