"""A dataset's files as QGIS shows them. Knows no window; on any thread, except where layers come into a project.

footprints      where the footprints are, by place and by number
shown           images of any bands, as 8 bits
picture         an image read for the screen
rectify         an image of a camera frame, laid on the map
mosaic          one raster over all images of a run, and its overviews
layers          footprints, mosaics and failed images, opened as layers
placing         these layers in their mission's group
splitting       what forms and Processing say of a split
scores          layers of a benchmark in its group, and the errors of a method
"""
