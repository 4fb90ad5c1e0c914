"""Parts of a dataset: what the column ``split`` of a table says."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .clean import REJECTED
from .table import Table

#: Column of the table: the part of an image. A table that has none is not split.
SPLIT = "split"
#: In place of a part: an image that is in none, as its ground is shared with another part or is too near to one.
GAP = "gap"


def part_of(table: Table) -> tuple[str, ...] | None:
    """Part of each row: one of `choices.PARTS`, `GAP`, or empty where the image is not taken; None without a split."""
    return table.other.get(SPLIT)


def taken(table: Table) -> NDArray[np.bool_]:
    """Rows (n,) whose images are there and have not been rejected by cleaning."""
    there = np.array([status != "failed" for status in table.status], np.bool_)
    marks = table.other.get(REJECTED, ("",) * len(table))
    return there & np.array([not mark for mark in marks], np.bool_)
