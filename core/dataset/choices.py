"""What commands on datasets choose among, and what holds where nothing is said; without what works on them."""

from __future__ import annotations

#: The paper's: in its dataset, images below it lack significant detail.
DEFAULT_ENTROPY = 2.1
#: How folders of datasets may be laid out: ours and the paper's published ones, and the Night Vision supplement's.
LAYOUTS = ("TerrAInav", "VBN")
TRAIN, VALIDATION, TEST = PARTS = ("train", "validation", "test")
#: The paper's.
SHARES = (0.8, 0.1, 0.1)
SEED = 2024
#: How images are put in order, or by what they are split.
WAYS = ("shuffled", "in-order", "blocks")
#: Frames of labels that are chosen by name; else a code ``EPSG:…``.
FRAMES = ("utm", "mercator", "mission")
