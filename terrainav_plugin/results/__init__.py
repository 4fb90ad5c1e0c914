"""Viewing captured images one by one.

shots       captured images under a click, and what is known of each
viewer      the window that shows one image after the other
compare     two images on the map, one after the other in the same place
viewing     from a click on a captured footprint to its image
"""
