"""Options of a capture in blocks, importable without numerics."""

from __future__ import annotations

#: Layouts of files: one file for each image, or one for the images of each block.
LAYOUTS = FOLDERS, WEBDATASET = ("folders", "webdataset")
#: Images of a block by default: seconds to a minute of one processor, and about 100 MB of GeoTIFF.
IMAGES = 256
#: Folder of the blocks' records, which are the journal, and the file in it that describes the division.
BLOCKS_FOLDER, DIVISION_FILE = "blocks", "blocks.json"
