"""Project layers and QGIS connections as imagery sources.

connections     QGIS connections of the user to servers
terms           terms of use of a layer's providers
snapshot        copies of the project's layers at the start of a capture
source          a layer, or the whole map, as a source
tiles           tile layers, with pixels as the server sends them
sampling        a raster file's layer, sampled on another pixel grid
vector_files    vector layers as files
renderer        QGIS's renderer and raster pipes on capture threads
"""
