"""Where heights come from, and what they count from.

In reading order:

- `relief`: sources of heights as one relief, and surfaces of it
- `filling`: holes in heights, interpolated from those around them
- `heights`: the heights of one source, in its own pixels
- `datum`: what heights count from, and how far that is from the ellipsoid
"""
