"""The QGIS plugin: what people see and touch. Calculations are in ``terrainav.core``.

Rooms, from the top; arrows point down, and rooms of one floor talk through what the session joins:

plugin          toolbar and menu; everything else is loaded when it is first used
session         the plugin at work: makes what the rooms hold, and joins it
panel           the mission panel, and the page of settings
processing      the algorithms of Processing
area            the area of a mission: entries, tools, layers and files
preview         what would be captured, and the map below it
capture         the queue of captures
results         captured images, looked at one by one
missions        missions and datasets: opened, saved, taken up again
cleaning        a dataset cleaned by eye
planner         plans worked out in the background
sources         sources to plan with, to capture from and to show
dataset         a dataset's files as QGIS shows them
qgis_source     layers of the project, and QGIS's connections, as sources
form            what is entered, and the mission that it asks for
map             the canvas, the layer tree's groups, what a plan draws
network         requests over QGIS's own network stack

and for all: settings, credentials, i18n, units, messages, help, plain, foreign, widgets, tasks, paths, packages and
compat.
"""
