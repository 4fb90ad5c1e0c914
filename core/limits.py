"""How much a server, a file or a mission may ask of this machine: every limit that protects it, in one place.

What lies beyond is refused in one line, before memory, time or disk is spent on it. Limits of another kind (of a
method's domain, of a format) stand where they come from.
"""

from __future__ import annotations

# --- What a server answers

#: Largest body read, packed or not; a tile of 512 px takes about 1 MB at most as PNG.
MAX_BODY_BYTES = 32 << 20
#: Lines of an answer's head; servers send ten to thirty. `http.client` reads no more of them, either.
MAX_HEADERS = 100
#: All that may come on a connection for one answer beside its body: head, sizes of chunks, trailers.
MAX_FRAMING_BYTES = 8 << 20
#: Characters of a header that is interpreted.
MAX_HEADER_CHARACTERS = 4096
#: Redirects followed for one request; tile servers need one or two.
MAX_REDIRECTS = 5
#: Seconds within which attempts at one part begin: five silences of 20 s and the waits between them.
MAX_PART_S = 120.0
#: Parts one after the other for which no answer came in time, until the server is left alone for a while.
MAX_LATE_PARTS = 5
#: Characters of a text that others wrote which are looked at.
MAX_TEXT_CHARACTERS = 16384
#: Those of it that are shown, in one line.
MAX_LINE_CHARACTERS = 300
#: Largest answer for which a file at an address is read from a server that sends whole files only; it is in memory.
MAX_WHOLE_ANSWER_BYTES = 1 << 30
#: Longest file that is copied from an address: footprints and tables of ten million images take some GB.
MAX_FETCHED_FILE_BYTES = 16 << 30
#: Longest file of one image that is fetched to be looked at; it is in memory.
MAX_FETCHED_IMAGE_BYTES = 512 << 20


# --- Pictures

#: Widest tiles: 48 MB of pixels, and twice what any server is known to have.
MAX_TILE_PX = 4096
#: Bytes of a picture's file beyond those of its pixels with 16 bits a channel: metadata, colour profiles.
MAX_PICTURE_EXTRA_BYTES = 4 << 20
#: Segments of a JPEG, and bytes that fill up between those of its head; cameras and editors write up to some hundred.
MAX_JPEG_SEGMENTS = 10_000
#: Scans of a JPEG, each of which may touch every pixel; progressive ones have about ten.
MAX_JPEG_SCANS = 100
#: Pixels of one picture, as it is planned and as it is resized to: 20,000 x 10,000, a third more than the largest
#: cameras of unmanned aircraft have (151 million). Making it takes 15 bytes a pixel, 3 GB.
MAX_PICTURE_PX = 200_000_000
#: Bytes of the same with many bands, or of more than 8 bits: four of 16 bits.
MAX_PICTURE_BYTES = 8 * MAX_PICTURE_PX
#: Longest file of an image that is read: that of the largest picture, not packed; it is in memory.
MAX_IMAGE_FILE_BYTES = MAX_PICTURE_BYTES + MAX_PICTURE_EXTRA_BYTES
#: Files of one image in a shard: it, its row, what places it on the map, its products. There are ten kinds of them.
MAX_IMAGE_MEMBERS = 100
#: Pixels along its longer side.
MAX_PICTURE_SIDE_PX = 20_000
#: Bands of a picture: imaging spectrometers have some 250.
MAX_BANDS = 1_000
#: Sources of heights that fill each other.
MAX_HEIGHT_SOURCES = 16
#: Imageries that one mission is captured from.
MAX_IMAGERIES = 64
#: Poses that are drawn at random, or flown along a line.
MAX_POSES = 10_000_000
#: Tiles that one picture is made of: the largest one, from pixels half as large, takes some 12,000 of 256 px.
MAX_IMAGE_TILES = 32_768
#: Pixels of all pictures that are on the way at once: one that is made while the next is fetched.
MAX_PICTURES_AT_ONCE_PX = 2 * MAX_PICTURE_PX


# --- Documents, files and databases

#: Largest capabilities of a service; those of national services have some MB.
MAX_CAPABILITIES_BYTES = 32 << 20
#: Largest description of a service in JSON; those of servers with thousands of layers have some hundred kB.
MAX_SERVICE_JSON_BYTES = 8 << 20
#: Elements of a document in XML; the largest services have some 100,000.
MAX_XML_ELEMENTS = 1_000_000
#: Elements and attributes of a document together: lxml takes 220 bytes for each.
MAX_XML_NODES = 3_000_000
#: How deep they may be within each other; those of services are up to 20 deep.
MAX_XML_DEPTH = 100
#: Attributes of one of them, each of which parsers compare with all others; services write up to a dozen.
MAX_XML_ATTRIBUTES = 200
#: Different names of elements and attributes; services use some hundred.
MAX_XML_NAMES = 10_000
#: Layers of a service and styles of layers: OWSLib takes 0.1 ms and 7 kB for each. The largest services have thousands.
MAX_SERVICE_LAYERS = 50_000
#: Properties that layers of a service inherit, over all layers: 6,000 coordinate systems for 1,000 layers are 12 M.
MAX_XML_INHERITED = 40_000_000
#: Largest VRT, of some 50,000 files.
MAX_VRT_BYTES = 64 << 20
#: How deep one may read another.
MAX_VRT_DEPTH = 8
#: Parts of a VRT that name data, those within the VRTs that it reads among them: 50,000 files with three bands.
MAX_VRT_SOURCES = 150_000
#: Bands of a raster, some of which make a picture: stacks of many dates have hundreds.
MAX_RASTER_BANDS = 10_000
#: Overviews of a raster: those of halves of a raster as wide as GDAL reads are 31.
MAX_RASTER_OVERVIEWS = 100
#: Bytes of a block of a raster, which is decoded whole for one pixel: strips and tiles have some hundred kB, heights
#: of a square degree in one strip 26 MB.
MAX_RASTER_BLOCK_BYTES = 256 << 20
#: Items of metadata of a raster, or points that place it: GDAL looks each one up among those before it.
MAX_RASTER_ITEMS = 50_000
#: Directories of a TIFF, each an image, a mask or an overview: all of them are looked through when it is opened.
MAX_TIFF_DIRECTORIES = 1_000
#: Bytes of the texts of a GeoTIFF's keys, which lead to the first 131,070 of them; programs write some hundred.
MAX_TIFF_TEXT_BYTES = 1 << 17
#: Boxes, but for those of pixels, of a JPEG 2000 or JPEG XL in an archive or on another machine; there are some ten.
MAX_BOXES = 1_000
#: Bytes of them, which GDAL is to have at hand still when it opens what was looked through: it keeps 16 MiB.
MAX_BOXES_BYTES = 4 << 20
#: Seconds that a look-up in an MBTiles file may take: an index makes them milliseconds.
MAX_QUERY_S = 5.0
#: Characters of a line of metadata, of an MBTiles file or a raster.
MAX_METADATA_CHARACTERS = 4096
#: Characters of a view of an MBTiles file; programs write some hundred. What it makes of the file's values is larger
#: than these by no more than that many times.
MAX_VIEW_CHARACTERS = 2000
#: Bytes of a tile in an MBTiles file.
MAX_STORED_TILE_BYTES = 32 << 20
#: Characters of the definition of a coordinate reference system; compound ones take some 10,000.
MAX_CRS_CHARACTERS = 1 << 16
#: Length of the `crs` of a file of GeoJSON that leads nowhere, with the spaces in it, bytes.
MAX_GEOJSON_CRS_BYTES = 1024
#: Levels of lists and objects in a JSON text: GeoJSON has up to ten, and Python's stack has room for a thousand.
MAX_JSON_DEPTH = 100
#: Digits of a whole number in a text: every such number has a float, and takes no time to be read.
MAX_JSON_DIGITS = 300
#: Length of a file of settings, sources, cameras or labels, bytes: a hundred times the largest that is known.
MAX_SETTINGS_BYTES = 16 << 20
#: Length of a line in a capture's journal, bytes: a name and a reason take a few hundred.
MAX_JOURNAL_LINE_BYTES = 1 << 20
#: Length of a line in a table or of a feature in a line, bytes: rows of a kB have some dozen columns.
MAX_LINE_BYTES = 1 << 20
#: Length of a table, a plan, a journal or a file of footprints, bytes: those of ten million images take some GB.
MAX_TABLE_BYTES = 16 << 30
#: Length of a record of a block in an object store, bytes: a block of 100,000 images takes some 40 MB.
MAX_RECORD_BYTES = 256 << 20
#: Places in the rankings of a benchmark's queries, as many for each as the longest has: 64 bytes each while they are
#: judged. Ten thousand queries that rank ten thousand tiles are as many.
MAX_RANKED = 100_000_000
#: Length of the heights of a relief that a run leaves to its workers, bytes.
MAX_RELIEF_BYTES = 4 << 30
#: Length of a file with a mission or its places, bytes: ten million points, as many as a mission may have images by
#: default, take 700 MB.
MAX_MISSION_BYTES = 1 << 30
#: Bytes of a flight log that belong to no message: readers go through them one by one, and print a line for each.
MAX_LOG_DAMAGE_BYTES = 1 << 20
#: Fields of all topics that a PX4 log defines, each array and nested type in full; flights have some 10,000.
MAX_LOG_FIELDS = 100_000
#: Characters of the name of such a field or topic; PX4 has up to some 50.
MAX_LOG_NAME_CHARACTERS = 255
#: How deep types of such fields may be within each other; PX4 has two.
MAX_LOG_DEPTH = 5
#: Kinds of messages of an ArduPilot log in text; binary ones have a byte to number them.
MAX_LOG_KINDS = 512
#: Polygons of an area or of no-fly areas, each of which is checked and laid out by itself; farms have some hundred.
MAX_POLYGONS = 10_000
#: Pairs of a polygon's sides that are looked at for crossings, as they share a longitude: 0.1 s for a million. Outlines
#: of a million corners have some ten for each.
MAX_PAIRS_OF_SIDES = 100_000_000
#: Files in a KMZ, which is a zip; those of map programs hold a KML file and some hundred images.
MAX_KMZ_FILES = 100_000


# --- Object stores and clusters

#: Seconds without an answer of an object store, until it is given up: three silences of 15 s, and the waits between.
MAX_STORE_SILENCE_S = 60.0
#: Bytes a second that come, or are sent, at least, over as many seconds: a tenth of a slow line.
MIN_STORE_BYTES_PER_S = 10_000
#: Seconds that one request to a store may take in all: a list of ten million names takes half an hour.
MAX_STORE_S = 3600.0
#: Answer of a store that is no object: a page of a list has a thousand names, of a kB each at most.
MAX_STORE_ANSWER_BYTES = 8 << 20
#: Objects in a folder of a store: a list of them takes 200 bytes each.
MAX_STORE_NAMES = 10_000_000
#: Seconds within which a scheduler of Dask's answers.
MAX_SCHEDULER_SILENCE_S = 10.0


# --- Projects

#: Servers and files that QGIS's settings keep as agreed to, the last ones.
MAX_AGREED_PLACES = 1000
#: Characters of one of them: a name of 253 letters and what stands in it in braces.
MAX_PLACE_CHARACTERS = 1000
#: How often an address within an address is decoded.
MAX_DECODINGS = 3


# --- Missions

#: Whole numbers of a mission, and negative ones down to as many: those of 64 bits, as its seed may be.
MAX_WHOLE_NUMBER = 2**64 - 1
