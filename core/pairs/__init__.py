"""Cross-view pairs: the same places seen by a satellite and a drone, in the layout of University-1652.

In reading order:

- `places`: read from a file, or spread over a box
- `views`: drone poses around a place
- `parts`: split of the places into training and test
- `planning`: the missions of a dataset, planned before anything is fetched
- `capturing`: the run, and its folders
- `sheet`: a contact sheet of some places
"""
