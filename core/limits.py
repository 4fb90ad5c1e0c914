"""How much a server, a file or a mission may ask of this machine: every limit that protects it, in one place.

What lies beyond is refused in one line, before memory, time or disk is spent on it. Limits of another kind (of a
method's domain, of a format) stand where they come from.
"""

from __future__ import annotations

# --- What a server answers


# --- Pictures

#: Widest tiles: 48 MB of pixels, and twice what any server is known to have.
MAX_TILE_PX = 4096

# --- Documents, files and databases

#: Largest capabilities of a service; those of national services have some MB.
MAX_DOCUMENT_BYTES = 32 << 20
#: Elements of a document, how deep they may be within each other, and attributes of one; the largest services have
#: some 100,000 elements, 20 deep, with a dozen attributes.
MAX_XML_ELEMENTS = 1_000_000
MAX_XML_DEPTH = 100
MAX_XML_ATTRIBUTES = 1_000
#: Properties that layers of a service inherit, over all layers: 6,000 coordinate systems for 1,000 layers are 12 M.
MAX_XML_INHERITED = 40_000_000
#: Largest VRT, of some 50,000 files, and how deep one may read another.
MAX_VRT_BYTES = 64 << 20
MAX_VRT_DEPTH = 8
#: Seconds that a look-up in a database of others may take: an index makes them milliseconds.
MAX_QUERY_S = 5.0
#: Characters of a line of its metadata, and bytes of one of its tiles.
MAX_METADATA_CHARACTERS = 4096
MAX_STORED_TILE_BYTES = 32 << 20

# --- Missions
