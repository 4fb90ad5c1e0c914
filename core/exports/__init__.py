"""Datasets and benchmarks in the formats of other programs.

In reading order:

- `kinds`: formats by name, and export to any of them
- `views`: camera frames of a dataset with their poses in one local frame
- `formats`: COLMAP models, nerfstudio's transforms, trajectories of TUM and KITTI
- `tables`: tables of any dataset as Parquet, with footprints
- `huggingface`: folders of images with a card, for Hugging Face's library ``datasets``
- `masks`: areas, boxes, run lengths and outlines of the classes and instances in an image
- `label_sets`: images with labels in the layouts of COCO and YOLO
- `sequences`: flights with inertial data in EuRoC's layout and as ROS 2 bags
- `croissant`: a description of a dataset's files and records
- `stac`: images as STAC items in one GeoParquet table, and their collection
- `scenes`: ground of a benchmark in metres: points seen by queries, and the reference with heights
- `localisers`: benchmarks in the layouts of published sets for visual localisation
"""
