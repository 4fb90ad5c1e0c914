"""Features as arrays, in longitude and latitude."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Floats, NDArray, Numbers

POLYGON, LINE, POINT = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Features:
    """Polygons, lines and points of a layer, n features of p parts with r rings and m vertices in all.

    Parameters
    ----------
    number : array of int64, shape (n,)
        Place of the feature in its layer, from 1: its instance id. Ascending.
    kind : array of uint8, shape (n,)
        `POLYGON`, `LINE` or `POINT`.
    lon_deg, lat_deg : array of float64, shape (m,)
        Vertices in WGS 84. Rings are closed, outer ones counter-clockwise, holes clockwise.
    ring_starts : array of int64, shape (r + 1,)
        First vertex of each ring, line or point.
    part_starts : array of int64, shape (p + 1,)
        First ring of each part: of a polygon its outer ring, then its holes.
    feature_starts : array of int64, shape (n + 1,)
        First part of each feature.
    values : dict of str to tuple
        Values of each field that was asked for, n of them: text, numbers, or None.
    """

    number: Numbers
    kind: NDArray[np.uint8]
    lon_deg: Floats
    lat_deg: Floats
    ring_starts: Numbers
    part_starts: Numbers
    feature_starts: Numbers
    values: dict[str, tuple[Any, ...]]

    def __len__(self) -> int:
        return len(self.number)


def starts(counts: list[Numbers]) -> Numbers:
    """Running sums of counts, from 0: one more than there are counts."""
    joined = np.concatenate([np.zeros(1, np.int64), *counts])
    return np.cumsum(joined, dtype=np.int64)
