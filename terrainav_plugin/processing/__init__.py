"""The Processing algorithms: plan, capture and measure missions, clean and split datasets, make benchmarks.

provider            the provider in QGIS's toolbox
algorithm           base of all algorithms, which runs their work off the main thread
choices             parameters for choices, by value, title or number
areas               areas from extents, polygons and points
mission_parameters  the parameters of a mission, and the mission read from them
imagery             the imagery of a mission, taken on the main thread before an algorithm runs
line                poses along a line flown at a speed
plan                a plan as layers, numbers and files
capture             a mission captured into a dataset folder; failed images captured again
datasets            a dataset cleaned, split, mosaicked and exported
benchmarks          a benchmark made from a mission's views and a reference; answers scored
windows             Processing's benchmark windows, opened with the panel's mission
report              a mission's error measured against run time
"""
