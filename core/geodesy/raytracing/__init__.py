"""Rays over relief.

In reading order:

- `paths`: paths of rays over a map's plane, as polynomials
- `surface`: heights on a grid, and the first point of them that each ray meets
- `tracing`: the rays of an image, what its pixels see, and the camera frame made of it
"""
