"""Queries that are to be found in references: how well methods find them.

In reading order:

- `choices`: what the command and forms choose among
- `folder`: a benchmark's folder as it is read: queries with their truth, tiles, the mosaic
- `planning`: a benchmark worked out before anything is fetched
- `truth`: where queries were taken, and which tiles show their ground
- `making`: the run that captures the reference and the queries
- `loading`: pairs of queries and tiles for training
- `answers`: what a method is asked and what it answers
- `running`: the run of a method over the queries
- `correlation`, `features`: baselines that need no weights
- `metrics`: figures of rankings and of positions, as the field defines them
- `scoring`: how near answers are to the truth
- `page`: what a judge leaves: figures, errors, diagrams and a page
"""
