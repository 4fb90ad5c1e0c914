"""Cross-view pairs: the same places from a satellite and from a drone, as University-1652 has them.

In reading order:

- `places`: read from a file, or spread over a box
- `views`: from where the drone looks at a place
- `parts`: which places are for training and which for testing
- `planning`: a dataset worked out before anything is fetched
- `capturing`: the run, and the folders that it leaves
- `sheet`: a contact sheet of some places
"""
