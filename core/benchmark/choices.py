"""Choices and defaults of the command and forms; imports nothing."""

from __future__ import annotations

#: Splits. With ``cross-area``, parts of queries and tiles have no ground in common; with ``same-area``, queries are
#: split at random and share all tiles.
CROSS_AREA, SAME_AREA, NO_SPLIT = SPLITS = ("cross-area", "same-area", "none")
#: Least intersection over union of a positive and of a semi-positive tile, as in GTA-UAV.
POSITIVE_IOU, SEMI_POSITIVE_IOU = 0.39, 0.14
#: Overlap of tiles: with a half, any place is within a quarter of a tile's width of the middle of a tile on each axis.
TILE_OVERLAP = 0.5
#: Module and function of each built-in method.
METHODS = {
    "ncc": (".correlation", "correlation"),
    "sift": (".features", "sift"),
    "orb": (".features", "orb"),
    "middle": (".running", "middle"),
    "prior": (".running", "prior"),
    "silhouette": (".fitting", "silhouette"),
}
