"""The preview of a mission on the map, and background imagery.

view            the current view of the map
preview         layers that follow every change of the mission and the view
layers          attributes, styles, map tips and times of these layers
scene           features drawn of a plan for a view
index           spatial index of captures, to find those in view among a million
features        captures and flight line as map features
density         number of images per place, if there are too many images to draw
background      the source entered, shown around the area
"""
