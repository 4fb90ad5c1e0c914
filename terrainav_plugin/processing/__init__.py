"""The Processing algorithms: plan, capture and measure missions, clean and split datasets, make benchmarks.

provider            the provider in QGIS's toolbox
algorithm           base of all algorithms, which runs their work off the main thread
choices             parameters for choices, by value, title or number
areas               areas from extents, polygons and points
mission_parameters  the parameters of a mission, and the mission read from them
imagery             the imagery of a mission, taken on the main thread before an algorithm runs
line                poses along a line that is flown at constant speed
plan                a plan as layers, numbers and files
capture             capture a mission into a dataset folder, or failed images again
datasets            clean, split and export a dataset, or make its mosaic
benchmarks          make a benchmark from a mission's views and a reference, or score answers to it
windows             Processing's benchmark windows, opened with the panel's mission
report              a mission's error measured against run time
"""
