"""Capture a plan into a folder of images with their poses.

In reading order:

- `runner`: `capture`, and the run that makes the images that the journal lacks
- `progress`: progress, results and callbacks
- `several`: several captures in one folder
- `folder`: the folder of a capture, which a mission claims and a run holds
- `holding`: locks and leases against other runs
- `begun`: the settings that a capture was begun with
- `images`: the journal of a capture image by image
- `journal`: the file with a line for each image
- `labels`: opened labels, and their tables
- `making`: make images with threads
- `uses`: the last image that may need a part
- `pipeline`: fetch, assemble and write at the same time
- `records`: the job of an image, and tables of images
- `cameras`: what the pixels of a dataset mean
- `writers`: image files
- `georeference`: georeferences of images
- `metadata`: metadata of image files
- `tiff`: directories of TIFF tags
- `odm`: files for OpenDroneMap
- `choices`: options of a capture in blocks
- `blocks`: capture in blocks, which other processes and machines make
"""
