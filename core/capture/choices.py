"""Options of a capture in blocks, importable without numerics."""

from __future__ import annotations

#: Layouts of files: one file for each image, or one shard for the images of each block.
LAYOUTS = FOLDERS, WEBDATASET = ("folders", "webdataset")
#: Default number of images in a block, which take one processor seconds to a minute and about 100 MB as GeoTIFF.
IMAGES = 256
#: Folder of the blocks' records, which are the journal, and the file in it that describes the division.
BLOCKS_FOLDER, DIVISION_FILE = "blocks", "blocks.json"
