"""The ground below a mission.

In reading order:

- `ground`: the ground as a plan asks for it, and level ground
- `overflown`: relief below a path, and profiles below its legs
- `modelled`: heights of captures over relief, and what they surely see
"""
