"""Datasets and benchmarks in the formats that other programs read.

In reading order:

- `kinds`: the formats by name, and one way into all of them
- `views`: camera frames of a dataset with their poses in one local frame
- `formats`: COLMAP models, nerfstudio's transforms, trajectories as TUM and KITTI have them
- `tables`: tables of any dataset as Parquet, with footprints
- `huggingface`: folders of images with a card, for Hugging Face's datasets
- `croissant`: a description of a dataset's files and records
- `stac`: all images as items of STAC, in one table of GeoParquet, and their collection
- `scenes`: the ground of a benchmark in metres, as its queries see it and as its reference shows it
- `localisers`: benchmarks in the layouts of the sets that localisers are judged on
"""
