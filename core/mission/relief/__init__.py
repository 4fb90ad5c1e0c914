"""The ground below a mission.

In reading order:

- `overflown`: relief below a path, and profiles below its legs
- `modelled`: heights of captures over relief, and what they surely see
"""
