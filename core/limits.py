"""How much a server, a file or a mission may ask of this machine: every limit that protects it, in one place.

What lies beyond is refused in one line, before memory, time or disk is spent on it. Limits of another kind (of a
method's domain, of a format) stand where they come from.
"""

from __future__ import annotations

# --- What a server answers


# --- Pictures


# --- Documents, files and databases

#: Levels of lists and objects in a JSON text: GeoJSON has up to ten, and Python's stack has room for a thousand.
JSON_DEPTH = 100
#: Digits of a whole number in a JSON text: every such number has a float, and takes no time to be read.
JSON_DIGITS = 300
#: Length of a file of settings, sources, cameras or labels, bytes: a hundred times the largest that is known.
DOCUMENT_BYTES = 16 << 20
#: Length of a file with a mission or its places, bytes: ten million points, as many as a mission may have images by
#: default, take 750 MB.
MISSION_BYTES = 1 << 30


# --- Missions
