"""How much a server, a file or a mission may ask of this machine: every limit that protects it, in one place.

What lies beyond is refused in one line, before memory, time or disk is spent on it. Limits of another kind (of a
method's domain, of a format) stand where they come from.
"""

from __future__ import annotations

# --- What a server answers


# --- Pictures

#: Pixels of one picture, as it is planned and as it is resized to: 20,000 x 10,000, a third more than the largest
#: cameras of unmanned aircraft have (151 million). Making it takes 15 bytes a pixel, 3 GB.
PICTURE_PX = 200_000_000
#: Pixels along its longer side.
PICTURE_SIDE_PX = 20_000
#: Pixels of all pictures that are on the way at once: one that is made while the next is fetched.
PICTURES_AT_ONCE_PX = 2 * PICTURE_PX


# --- Documents, files and databases

#: Levels of lists and objects in a JSON text: GeoJSON has up to ten, and Python's stack has room for a thousand.
JSON_DEPTH = 100
#: Digits of a whole number in a JSON text: every such number has a float, and takes no time to be read.
JSON_DIGITS = 300
#: Length of a file of settings, sources, cameras or labels, bytes: a hundred times the largest that is known.
DOCUMENT_BYTES = 16 << 20
#: Length of a line in a capture's journal, bytes: a name and a reason take a few hundred.
JOURNAL_LINE_BYTES = 1 << 20
#: Length of a file with a mission or its places, bytes: ten million points, as many as a mission may have images by
#: default, take 700 MB.
MISSION_BYTES = 1 << 30


# --- Missions

#: Whole numbers of a mission: those of 64 bits, as its seed may be.
WHOLE_NUMBER = 2**64 - 1
