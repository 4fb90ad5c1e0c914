"""What has been captured: its layers on the map, and its images one by one.

layers      mosaics, footprints and failed images in their mission's group
shots       captured images under a click, and what is known of each
viewer      the window that shows one image after the other
viewing     from a click on a captured footprint to its image
"""
