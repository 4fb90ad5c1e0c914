"""Where the captures stand, how their pictures lie on the map, and what those show of the area.

In reading order:

- `rows`: captures in flight order, and what all layouts have in common; single points
- `parallels`: rows along parallels
- `paper`: the published datasets' grid in UTM
- `entry`: where a flight enters its layout
- `rotated`: rows that are turned from east, or crossed
- `polygons`: several polygons as one flight
- `no_fly`: captures over no-fly areas, which are left out
- `frames`: the two kinds of frames: rectangles of the map, or what the camera sees
- `framing`: the frames of the captures, their zoom and their size
- `coverage`: what the pictures show, what neighbours share, and where the source has no imagery
"""
