"""Choices and defaults of the command and forms; imports nothing."""

from __future__ import annotations

#: How queries are split: into parts with no ground in common, tiles too; at random, over one reference; not at all.
CROSS_AREA, SAME_AREA, NO_SPLIT = SPLITS = ("cross-area", "same-area", "none")
#: Least intersection over union of a positive and of a semi-positive tile: those of GTA-UAV.
POSITIVE_IOU, SEMI_POSITIVE_IOU = 0.39, 0.14
#: Tiles overlap by half: along each axis, any place is within a quarter of a tile's width of the middle of a tile.
TILE_OVERLAP = 0.5
#: Built-in methods: module and function.
METHODS = {
    "ncc": (".correlation", "correlation"),
    "sift": (".features", "sift"),
    "orb": (".features", "orb"),
    "middle": (".running", "middle"),
}
