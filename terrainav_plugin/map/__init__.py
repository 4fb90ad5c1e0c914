"""Map parts shared by the rooms.

canvas          longitude and latitude on the canvas, and tools that restore the previous tool
mission_group   the layer tree group of a mission's layers
outlines        outlines of a plan, as geometries
"""
