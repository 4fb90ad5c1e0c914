"""Datasets in the formats that other programs read.

In reading order:

- `views`: camera frames of a dataset with their poses in one local frame
- `formats`: COLMAP models, nerfstudio's transforms, trajectories as TUM has them
"""
