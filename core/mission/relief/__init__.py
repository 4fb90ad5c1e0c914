"""The ground below a mission.

In reading order:

- `ground`: the interface that plans use, and level ground
- `path_ground`: relief below a path, and profiles below its legs
- `roofed`: the surface that flights keep clear of, with roofs on it
- `modelled`: heights of captures over relief, and the ground they are certain to see
"""
