"""A dataset's files as QGIS shows them. No windows; on any thread, except where layers are added to a project.

footprints      spatial and numeric access to the footprints
shown           images of any bands, as 8 bits
picture         an image read for display
overlay         labels over an image
rectify         camera frames laid on the map
mosaic          one raster of all images of a run, with overviews
layers          footprints, mosaics and failed images as layers
placing         the layers of a dataset in their mission's group
splitting       texts about a split, for forms and Processing
scores          layers of a benchmark, including a method's errors, in the benchmark's group
"""
