"""What is chosen of a capture in blocks, for forms and the command; what needs no numerics."""

from __future__ import annotations

#: How files are laid out: each image in a file of its own, or the images of a block in one.
LAYOUTS = FOLDERS, WEBDATASET = ("folders", "webdataset")
#: Images of a block where nothing else is said: seconds to a minute of one processor, and about 100 MB of GeoTIFF.
IMAGES = 256
#: Folder of the blocks' records, which are the journal, and what in it says how a destination is divided.
BLOCKS_FOLDER, DIVISION_FILE = "blocks", "blocks.json"
