"""The area of a mission: its entries in the panel, the map tools that draw and move it, and other origins of areas.

menu        menu of the origins of an area
no_fly      menu of the origins of no-fly areas
entries     entries of the four edges, arranged as on a map, and a description of the area
history     undo and redo of changes to the area
editing     undoable edits, from the entries to the form
dialogs     questions about the layer or file that an area is taken from
patterns    corridors, orbits, scans and random poses, turned into points
xml         KML and GPX read by Qt, which every QGIS has
layers      areas from the features of layers and from files
outline     an area in the canvas's CRS, and how dragging changes it
corners     changes to the corners, holes and parts of polygons
bands       rubber bands of an area, and text at the pointer
drawing     drawing polygons, corner by corner
tools       drawing a box, picking a point, changing an area
control     connects the menu, the map tools and the form
"""
