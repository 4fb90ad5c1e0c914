"""What has been captured, looked at image by image.

shots       captured images under a click, and what is known of each
viewer      the window that shows one image after the other
viewing     from a click on a captured footprint to its image
"""
