"""The algorithms of Processing: missions planned, captured and measured, datasets cleaned and split, benchmarks.

provider            what QGIS lists in its toolbox
algorithm           what all algorithms have in common; their work is kept off the main thread
choices             choices, and every way in which a script, a model or a terminal may name one
areas               areas out of what Processing hands over: extents, polygons and points
mission_parameters  the parameters of a mission, and the mission that they ask for
imagery             the imagery of a mission, taken on the main thread before an algorithm runs
line                poses along a line that is flown at a speed
plan                a mission worked out, as layers, numbers and files
capture             a mission captured into a dataset folder, and what has failed captured again
datasets            a dataset cleaned of images with too little to see, and divided into parts
benchmarks          a benchmark made of a mission's views and a reference, and answers to it judged
windows             Processing's windows for benchmarks, opened with the panel's mission
report              a mission's error measured against run time
"""
