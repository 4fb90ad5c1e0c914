"""How much a server, a file or a mission may ask of this machine: every limit that protects it, in one place.

What lies beyond is refused in one line, before memory, time or disk is spent on it. Limits of another kind (of a method's
domain, of a format) stand where they come from.
"""

from __future__ import annotations

# --- What a server answers


# --- Pictures


# --- Documents, files and databases


# --- Missions
