"""Removal of captures in no-fly polygons."""

from __future__ import annotations

import numpy as np

from ...arrays import Flags, Floats
from ...errors import InvalidInput
from ..areas.area import Polygon, area_contains
from .rotated import Pass
from .rows import Layout, picked


def in_no_fly(polygons: tuple[Polygon, ...], lat_deg: Floats, lon_deg: Floats) -> Flags:
    """Which positions (n,) are inside any of the polygons."""
    found = np.zeros(np.shape(lat_deg), bool)
    for polygon in polygons:
        found |= area_contains(polygon, lat_deg, lon_deg)
    return found


def remove_no_fly(
    polygons: tuple[Polygon, ...], layout: Layout, passes: tuple[Pass, ...], parts: tuple[int, ...]
) -> tuple[Layout, tuple[Pass, ...], tuple[int, ...], int]:
    """Remove the captures inside any of the polygons; the others keep their order and indices.

    Parameters
    ----------
    parts : tuple of int
        Indices of the first captures of the polygons of the area.

    Returns
    -------
    layout, passes, parts
        Passes without captures are removed; parts are kept, and may be empty.
    int
        Number of captures removed.

    Raises
    ------
    InvalidInput
        No capture is left.
    """
    forbidden = in_no_fly(polygons, layout.lat_deg, layout.lon_deg)
    count = int(forbidden.sum())
    if not count:
        return layout, passes, parts, 0
    if count == len(forbidden):
        raise InvalidInput(
            "all {0:,} images lie over no-fly areas",
            count,
            field="no_fly",
            remedy="choose another area, or smaller no-fly areas",
        )
    return (*without(forbidden, layout, passes, parts), count)


def without(
    removed: Flags, layout: Layout, passes: tuple[Pass, ...], parts: tuple[int, ...]
) -> tuple[Layout, tuple[Pass, ...], tuple[int, ...]]:
    """Layout, passes and parts without the captures ``removed`` (n,), as `remove_no_fly` returns them."""
    before = np.append(0, np.cumsum(~removed))
    ends = [*(one.first for one in passes[1:]), len(removed)]
    kept = tuple(
        one._replace(first=int(before[one.first])) for one, end in zip(passes, ends) if before[end] > before[one.first]
    )
    return picked(layout, ~removed), kept, tuple(int(before[first]) for first in parts)
