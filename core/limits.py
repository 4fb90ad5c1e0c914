"""Limits on servers, files and missions that protect this machine.

Input beyond a limit is refused with a one-line message, before memory, time or disk is spent on it. Limits of methods
and formats are in their modules.
"""

from __future__ import annotations

# --- Responses of servers

#: Largest body that is read, compressed or not; a PNG tile of 512 px takes at most about 1 MB.
MAX_BODY_BYTES = 32 << 20
#: Header lines of a response; servers send ten to thirty. It is also the limit of `http.client`.
MAX_HEADERS = 100
#: Bytes of a response besides its body: head, chunk sizes, trailers.
MAX_FRAMING_BYTES = 8 << 20
#: Characters of a header that is interpreted.
MAX_HEADER_CHARACTERS = 4096
#: Redirects followed for one request; tile servers need one or two.
MAX_REDIRECTS = 5
#: Seconds within which attempts at one tile begin: five timeouts of 20 s and the waits between them.
MAX_PART_S = 120.0
#: Consecutive tiles without a response in time, until the server gets no requests for a while.
MAX_LATE_PARTS = 5
#: Characters of a foreign text that are processed.
MAX_TEXT_CHARACTERS = 16384
#: Characters of a foreign text that are shown, in one line.
MAX_LINE_CHARACTERS = 300
#: Largest response when a file at an address is read from a server without range requests; it is in memory.
MAX_WHOLE_ANSWER_BYTES = 1 << 30
#: Largest file copied from an address: footprints and tables of ten million images take some GB.
MAX_FETCHED_FILE_BYTES = 16 << 30
#: Largest file of one image fetched for the viewer; it is in memory.
MAX_FETCHED_IMAGE_BYTES = 512 << 20


# --- Images

#: Side of the largest tiles: 48 MB of pixels, and twice the largest size known.
MAX_TILE_PX = 4096
#: Bytes of an image file beyond those of its pixels with 16 bits per channel: metadata, colour profiles.
MAX_PICTURE_EXTRA_BYTES = 4 << 20
#: Segments of a JPEG, and fill bytes between those of its head; cameras and editors write up to some hundred.
MAX_JPEG_SEGMENTS = 10_000
#: Scans of a JPEG, each of which may touch every pixel; progressive JPEGs have about ten.
MAX_JPEG_SCANS = 100
#: Pixels of one image, planned or resized: 20,000 x 10,000, a third more than the largest cameras of unmanned aircraft
#: (151 million). Making it takes 15 bytes per pixel, 3 GB.
MAX_PICTURE_PX = 200_000_000
#: Bytes of one image with many bands, or with more than 8 bits: four bands of 16 bits.
MAX_PICTURE_BYTES = 8 * MAX_PICTURE_PX
#: Largest image file that is read: that of the largest image, uncompressed; it is in memory.
MAX_IMAGE_FILE_BYTES = MAX_PICTURE_BYTES + MAX_PICTURE_EXTRA_BYTES
#: Files of one image in a shard: the image, its row, sidecar files and products. There are eleven kinds.
MAX_IMAGE_MEMBERS = 100
#: Pixels along the longer side of an image.
MAX_PICTURE_SIDE_PX = 20_000
#: Bands of an image: imaging spectrometers have some 250.
MAX_BANDS = 1_000
#: Sources of heights of one mission.
MAX_HEIGHT_SOURCES = 16
#: Vector layers of labels, or of buildings, of one mission.
MAX_VECTOR_LAYERS = 16
#: Fields of one mission that vary from image to image.
MAX_VARIED = 64
#: Imageries of one mission.
MAX_IMAGERIES = 64
#: Poses that are drawn at random, or flown along a line.
MAX_POSES = 10_000_000
#: Places of cross-view pairs spread over a box, each of which is compared with all before it.
MAX_PAIR_PLACES = 1_000_000
#: Views of a place in cross-view pairs; University-1652 has 54.
MAX_PAIR_VIEWS = 10_000
#: Pixels along a side of a mosaic.
MAX_MOSAIC_SIDE_PX = 1 << 22
#: Tiles of one image: the largest image, from pixels half as large, takes some 12,000 of 256 px.
MAX_IMAGE_TILES = 32_768
#: Pixels of all images in progress: one that is made while the next is fetched.
MAX_PICTURES_AT_ONCE_PX = 2 * MAX_PICTURE_PX


# --- Documents, files and databases

#: Largest capabilities of a service; those of national services have some MB.
MAX_CAPABILITIES_BYTES = 32 << 20
#: Largest JSON description of a service; those of servers with thousands of layers have some hundred kB.
MAX_SERVICE_JSON_BYTES = 8 << 20
#: Elements of an XML document; the largest services have some 100,000.
MAX_XML_ELEMENTS = 1_000_000
#: Elements and attributes of an XML document together: lxml takes 220 bytes for each.
MAX_XML_NODES = 3_000_000
#: Nesting depth of XML elements; services have up to 20 levels.
MAX_XML_DEPTH = 100
#: Attributes of one element, which parsers compare pairwise; services write up to a dozen.
MAX_XML_ATTRIBUTES = 200
#: Different names of elements and attributes; services use some hundred.
MAX_XML_NAMES = 10_000
#: Layers of a service and styles of layers: OWSLib takes 0.1 ms and 7 kB for each. The largest services have thousands.
MAX_SERVICE_LAYERS = 50_000
#: Properties inherited by all layers of a service together: 6,000 coordinate systems for 1,000 layers at depth 2 are 12
#: million.
MAX_XML_INHERITED = 40_000_000
#: Largest VRT, with some 50,000 files.
MAX_VRT_BYTES = 64 << 20
#: Nesting depth of VRTs.
MAX_VRT_DEPTH = 8
#: References of a VRT to data, including those of nested VRTs: 50,000 files with three bands.
MAX_VRT_SOURCES = 150_000
#: Bands of a raster, of which a mission selects some: stacks of many dates have hundreds.
MAX_RASTER_BANDS = 10_000
#: Overviews of a raster: repeated halving of the widest raster that GDAL reads gives 31.
MAX_RASTER_OVERVIEWS = 100
#: Bytes of a block of a raster, which is decoded whole for a single pixel: strips and tiles have some hundred kB,
#: heights of a square degree in one strip 26 MB.
MAX_RASTER_BLOCK_BYTES = 256 << 20
#: Metadata items or control points of a raster: GDAL compares each with all previous ones.
MAX_RASTER_ITEMS = 50_000
#: Directories of a TIFF, each an image, a mask or an overview: all are read when it is opened.
MAX_TIFF_DIRECTORIES = 1_000
#: Bytes of the texts of a GeoTIFF's keys, which can address the first 131,070; programs write some hundred.
MAX_TIFF_TEXT_BYTES = 1 << 17
#: Boxes, except those of pixels, of a JPEG 2000 or JPEG XL in an archive or on another machine; there are some ten.
MAX_BOXES = 1_000
#: Bytes of these boxes, which must still be in GDAL's cache of 16 MiB when it opens the checked file.
MAX_BOXES_BYTES = 4 << 20
#: Seconds for a query in an MBTiles file: with an index it takes milliseconds.
MAX_QUERY_S = 5.0
#: Characters of a metadata line of an MBTiles file or a raster.
MAX_METADATA_CHARACTERS = 4096
#: Characters of a view in an MBTiles file; programs write some hundred. Its results are at most that many times larger
#: than the file's values.
MAX_VIEW_CHARACTERS = 2000
#: Bytes of a tile in an MBTiles file.
MAX_STORED_TILE_BYTES = 32 << 20
#: Characters of the definition of a coordinate reference system; compound ones take some 10,000.
MAX_CRS_CHARACTERS = 1 << 16
#: Bytes of the `crs` of a GeoJSON file without references, including spaces.
MAX_GEOJSON_CRS_BYTES = 1024
#: Levels of lists and objects in a JSON text: GeoJSON has up to ten, and Python's stack has room for a thousand.
MAX_JSON_DEPTH = 100
#: Digits of an integer in a text: such a number can be converted to a float, and is read in no time.
MAX_JSON_DIGITS = 300
#: Bytes of a file of settings, sources, cameras or labels: a hundred times the largest known.
MAX_SETTINGS_BYTES = 16 << 20
#: Bytes of a line in a capture's journal: a name and a reason take a few hundred.
MAX_JOURNAL_LINE_BYTES = 1 << 20
#: Bytes of a line in a table, or of a feature on one line: rows of 1 kB have some dozen columns.
MAX_LINE_BYTES = 1 << 20
#: Bytes of a table, a plan, a journal or a file of footprints: those of ten million images take some GB.
MAX_TABLE_BYTES = 16 << 30
#: Bytes of a block's record in an object store: a block of 100,000 images takes some 40 MB.
MAX_RECORD_BYTES = 256 << 20
#: Places in the rankings of a benchmark's queries, with the length of the longest for each: 64 bytes each while they
#: are scored. Equals ten thousand queries that rank ten thousand tiles.
MAX_RANKED = 100_000_000
#: Bytes of the heights of a relief that a run stores for its workers.
MAX_RELIEF_BYTES = 4 << 30
#: Bytes of a mission file or of its places: ten million points, the default limit of images of a mission, take 700 MB.
MAX_MISSION_BYTES = 1 << 30
#: Bytes of a flight log that belong to no message: readers process them one by one, and print a line for each.
MAX_LOG_DAMAGE_BYTES = 1 << 20
#: Fields of all topics that a PX4 log defines, with arrays and nested types expanded; flights have some 10,000.
MAX_LOG_FIELDS = 100_000
#: Characters of the name of such a field or topic; PX4 has up to some 50.
MAX_LOG_NAME_CHARACTERS = 255
#: Nesting depth of the types of such fields; PX4 has two levels.
MAX_LOG_DEPTH = 5
#: Kinds of messages in an ArduPilot text log; binary logs number them with a byte.
MAX_LOG_KINDS = 512
#: Polygons of an area or of no-fly areas, each checked and laid out separately; farms have some hundred.
MAX_POLYGONS = 10_000
#: Pairs of a polygon's sides with common longitudes, which are checked for crossings: 0.1 s for a million. Outlines of
#: a million corners have some ten for each.
MAX_PAIRS_OF_SIDES = 100_000_000
#: Files in a KMZ, which is a zip; those of map programs hold a KML file and some hundred images.
MAX_KMZ_FILES = 100_000


# --- Object stores and clusters

#: Seconds without a response of an object store, until the run ends: three timeouts of 15 s, and the waits between
#: them.
MAX_STORE_SILENCE_S = 60.0
#: Least bytes per second, received or sent, over the same time: a tenth of a slow line.
MIN_STORE_BYTES_PER_S = 10_000
#: Seconds for one request to a store in all: a list of ten million names takes half an hour.
MAX_STORE_S = 3600.0
#: Response of a store other than an object: a page of a list has a thousand names of at most 1 kB.
MAX_STORE_ANSWER_BYTES = 8 << 20
#: Objects in a folder of a store: a list of them takes 200 bytes each.
MAX_STORE_NAMES = 10_000_000
#: Seconds within which a Dask scheduler must respond.
MAX_SCHEDULER_SILENCE_S = 10.0


# --- Projects

#: Latest servers and files that QGIS's settings store as allowed.
MAX_AGREED_PLACES = 1000
#: Characters of one of them: a name of 253 letters and its placeholders.
MAX_PLACE_CHARACTERS = 1000
#: How often an address within an address is decoded.
MAX_DECODINGS = 3


# --- Missions

#: Greatest integer in a mission, and, negated, the least one: 64 bits, the range of its seed.
MAX_WHOLE_NUMBER = 2**64 - 1
