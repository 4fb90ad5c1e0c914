"""What the command and forms choose among, and what they begin with, before numpy is needed."""

from __future__ import annotations

#: How queries are shared out: no ground in two parts, neither of queries nor of tiles; by places, over one reference;
#: or not at all.
CROSS_AREA, SAME_AREA, NO_SPLIT = SPLITS = ("cross-area", "same-area", "none")
#: Intersection over union from which a tile is right, and from which it is nearly so: those of GTA-UAV.
POSITIVE_IOU, SEMI_POSITIVE_IOU = 0.39, 0.14
#: Tiles of the reference overlap by half: every place is then within a quarter of a tile's width of a tile's middle,
#: along each side.
TILE_OVERLAP = 0.5
#: Methods that are part of the program: their modules and functions.
METHODS = {
    "ncc": (".correlation", "correlation"),
    "sift": (".features", "sift"),
    "orb": (".features", "orb"),
    "middle": (".running", "middle"),
}
