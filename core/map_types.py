"""Kinds of imagery: the words that missions, sources and folders of datasets share."""

from __future__ import annotations

SATELLITE, ROADMAP, TERRAIN = MAP_TYPES = ("satellite", "roadmap", "terrain")
