"""Map types: kinds of imagery, named alike in missions, sources and folders of datasets."""

from __future__ import annotations

SATELLITE, ROADMAP, TERRAIN = MAP_TYPES = ("satellite", "roadmap", "terrain")
