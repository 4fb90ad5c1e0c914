"""The QGIS plugin: its windows, tools and algorithms. Calculations are in ``terrainav.core``.

Rooms from top to bottom; a room imports only lower rooms, and the session connects rooms of the same level:

plugin          toolbar and menu; loads everything else on first use
session         creates the objects of the rooms and connects them
panel           the mission panel and the options page
processing      the Processing algorithms
area            the mission's area: entries, map tools, layers and files
preview         what would be captured, and the background imagery
capture         the queue of captures
results         viewing and comparing captured images
missions        opening, saving and resuming missions and datasets
dataset_window  cleaning, splitting, labelling and exporting a dataset
planner         planning in the background
sources         sources for planning, capturing and display
dataset         a dataset's files as QGIS layers
qgis_source     project layers and QGIS connections as sources
form            entries, and the mission made from them
map             the canvas, layer tree groups and plan outlines
network         requests over QGIS's own network stack

and used by all: settings, credentials, i18n, units, messages, help, plain, foreign, widgets, tasks, paths, packages
and compat.
"""
