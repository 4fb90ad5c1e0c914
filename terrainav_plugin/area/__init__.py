"""The area of a mission: its entries in the panel, the tools that draw and move it, and where else it comes from.

menu        what an area may be taken from
no_fly      what no-fly areas may be taken from
entries     four edges around a button, as on a map, and what the area is
history     undo and redo of changes to the area
editing     what happens between the entries and the form that they are part of
dialogs     questions about the layer that an area is taken from
patterns    corridors, orbits, scans and random poses, which become points
xml         KML and GPX read by Qt, which every QGIS has
layers      areas from the features of layers and from files
outline     an area on a canvas of any CRS, and what becomes of it when dragged
corners     changes to the corners, holes and parts of polygons
bands       an area drawn over the canvas, and what is said at the pointer
drawing     drawing polygons, corner by corner
tools       drawing a box, choosing a point, changing an area
control     where areas come from and go to: the menu, the map's tools, and the form
"""
