"""Viewing captured images one by one.

shots           finds captured images under a click, and reads their data
labels_pane     labels over an image
viewer          the window that shows one image at a time
compare         shows two images on the map alternately
viewing         the map tool, and the image of a clicked footprint
"""
