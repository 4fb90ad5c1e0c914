"""The preview of a mission on the map, and the background imagery.

view            the current view of the map
preview         layers that follow every change of the mission and the view
layers          attributes, styles, map tips and times of the preview's layers
scene           the features of a plan to draw for a view
index           spatial index of captures, to find those in view among a million
features        captures and flight line as map features
ground          labels and buildings around a plan as map features
picking         rows to skip and splits of the flight, picked by clicks on planned images
density         number of images per place, drawn if there are too many images
background      the entered source, shown around the area
"""
