"""Parts of the map that rooms share.

canvas          longitudes and latitudes on the canvas, and tools that give way to the tool before them
mission_group   the one group of the layer tree that holds the layers of a mission
outlines        what a plan draws on the map, as geometries
"""
