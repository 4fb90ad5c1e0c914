"""Layers of the project, and QGIS's connections, as sources of imagery.

connections     the connections to servers that the user has made in QGIS
terms           whose terms hold for a layer
snapshot        the project's layers as they are when a capture starts
source          a layer, or the whole map, as a source
tiles           layers of tiles: their pixels as the server has them
sampling        a raster file's layer on another pixel grid
renderer        QGIS's renderer and raster pipes on the threads of a capture
"""
