"""The run: a plan becomes a folder of pictures with their poses.

In reading order:

- `runner`: the run
- `progress`: what it tells
- `several`: runs beside each other in one folder
- `begun`: what a capture was begun with, to which later runs are held
- `folder`: the dataset's folder, and what it must not hold before
- `journal`: what is done, for the next run
- `pipeline`: fetching, assembling and writing at the same time
- `making`: pictures of a plan and a source, one after the other
- `records`: each picture's job, and its row of the table
- `writers`: pictures in files
- `georeference`: where a picture lies
- `metadata`: what a picture's file says of it
- `tiff`: tags as bytes
- `holding`: a place held by one run against others
- `choices`: what is chosen of blocks
- `blocks`: a capture in blocks, which other processes and machines make
- `odm`: files for OpenDroneMap
"""
