"""Benchmarks of visual localisation: queries, a reference in which methods find them, and scores of methods.

In reading order:

- `choices`: choices and defaults of the command and forms
- `folder`: files of a benchmark: queries with their truth, tiles, the mosaic
- `planning`: queries and reference, planned before anything is fetched
- `truth`: where queries were taken, and which tiles show their ground
- `making`: the run that captures the reference and the queries
- `silhouettes`: buildings of the reference at any pose, and masks of queries
- `loading`: pairs of queries and tiles for training
- `answers`: queries as methods see them, and answers of methods
- `running`: a method applied to all queries
- `correlation`, `features`, `fitting`: baselines without weights
- `metrics`: metrics of rankings and positions, as the literature defines them
- `scoring`: answers compared with the truth
- `sequences`: predictions for the frames of a sequence compared with its poses
- `page`: scores, errors and diagrams, written with a page
"""
