"""Parts of the map that several rooms use.

canvas          longitude and latitude on the canvas, and tools that restore the previous tool
mission_group   the layer tree group of a mission's layers
outlines        outlines of a plan, as geometries
"""
