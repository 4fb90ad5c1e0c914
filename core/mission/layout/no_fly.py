"""No-fly polygons: captures whose camera would stand inside one are left out."""

from __future__ import annotations

import numpy as np

from ...arrays import Flags, Floats
from ...errors import InvalidInput
from ..areas.area import Polygon, inside
from .rotated import Pass
from .rows import Layout, picked


def in_no_fly(polygons: tuple[Polygon, ...], lat_deg: Floats, lon_deg: Floats) -> Flags:
    """Which places (n,) are inside any of the polygons."""
    found = np.zeros(np.shape(lat_deg), bool)
    for polygon in polygons:
        found |= inside(polygon, lat_deg, lon_deg)
    return found


def left_out(
    polygons: tuple[Polygon, ...], layout: Layout, passes: tuple[Pass, ...], parts: tuple[int, ...]
) -> tuple[Layout, tuple[Pass, ...], tuple[int, ...], int]:
    """Captures that stand outside all polygons, in their order and with their indices.

    Parameters
    ----------
    parts : tuple of int
        Indices of the first captures of the area's polygons.

    Returns
    -------
    layout, passes, parts
        Without passes that have lost all captures; parts are kept, and may be empty.
    int
        How many were left out.

    Raises
    ------
    InvalidInput
        None is left.
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
    before = np.append(0, np.cumsum(~forbidden))
    ends = [*(one.first for one in passes[1:]), len(forbidden)]
    kept = tuple(
        one._replace(first=int(before[one.first])) for one, end in zip(passes, ends) if before[end] > before[one.first]
    )
    return picked(layout, ~forbidden), kept, tuple(int(before[first]) for first in parts), count
