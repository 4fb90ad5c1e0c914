"""Positions of captures, frames of pictures on the map, and coverage of the area.

In reading order:

- `rows`: captures in flight order, and functions of all layouts; single points
- `parallels`: rows along parallels
- `paper`: the UTM grid of the published datasets
- `entry`: the entry of a flight into its rows
- `rotated`: rows in a plane: rotated, crosshatched, or in the source's CRS
- `polygons`: several polygons as one flight
- `no_fly`: removal of captures over no-fly areas
- `skipped`: removal of the rows that a mission skips
- `frames`: map frames and camera frames
- `framing`: frames of the captures, with zoom and size
- `coverage`: coverage of the area, overlap of neighbours, and the extent of the imagery
"""
