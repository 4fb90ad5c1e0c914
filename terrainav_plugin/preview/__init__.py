"""The preview of a mission on the map, and the background below it.

view            what the map shows now
preview         layers that follow every change of the mission and of the view
layers          their attributes, styles, map tips and times
scene           what of a plan is drawn for a view
index           where captures are, so that those in view are found among a million
features        captures and the flight line as map features
density         how many images show each place, for images too many to be drawn
background      the source that is entered, shown around the area
"""
