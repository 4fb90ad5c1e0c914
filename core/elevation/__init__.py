"""Where heights come from, and what they count from.

In reading order:

- `layered`: sources of heights, one filling the holes of another
- `filling`: holes in heights, interpolated from those around them
- `heights`: the heights of one source, in its own pixels
- `datum`: what heights count from, and how far that is from the ellipsoid
"""
