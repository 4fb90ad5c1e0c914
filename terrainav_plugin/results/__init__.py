"""Viewing captured images one by one.

shots       captured images under a click, and their data
viewer      the window that shows one image at a time
compare     two images on the map, shown alternately
viewing     the image of a clicked footprint
"""
