"""Entry of a flight into its rows: the order of rows, and the direction in which they are flown."""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np

from ...arrays import Floats, Numbers
from ...geodesy.mercator import wrap_lon_deg
from ..mission import Mission
from ..parts import COMPASS_CORNERS, FIRST, NEAREST, ONE_WAY, TRACK
from .rows import Layout, picked


def from_entry(mission: Mission, layout: Layout, firsts: tuple[int, ...]) -> Layout:
    """Captures in the order of a flight that enters the rows at the corner which the route of the mission names.

    Rows are flown as laid out, from the other end, in reverse order, or both. The four possible first captures are
    assigned to the corners of the compass so that the sum of squared distances is least. Each further pass begins at
    the first capture nearest to the end of the previous pass. Points keep their order.

    Parameters
    ----------
    firsts : tuple of int
        Indices of the first captures of passes and polygons, which keep their order; empty for a single pass.
    """
    route = mission.route
    if not mission.area.covers_ground or route.entry == FIRST:
        return layout
    starts = sorted({0, *(first for first in firsts if first < len(layout.row))})
    north = layout.lat_deg - layout.lat_deg[0]
    east = (layout.lon_deg - layout.lon_deg[0]) * math.cos(math.radians(float(layout.lat_deg.mean())))
    place = np.stack([east, north], axis=1)
    orders: list[Numbers] = []
    yaw = layout.yaw_deg
    for start, end in zip(starts, [*starts[1:], len(layout.row)]):
        candidates = _ways(layout, slice(start, end), mission.flight.order)
        # Oblique views along the track were placed for the direction of flight.
        candidates = [one for one in candidates if not (one.turned and keeps_ways(mission))]
        sequences = [one.order + start for one in candidates]
        begins = place[[one[0] for one in sequences]]
        if orders:
            chosen = _nearest(begins, place[orders[-1][-1]])
        elif route.entry == NEAREST and route.takeoff is not None:
            lat, lon = route.takeoff
            turn = 360.0 * round((float(layout.lon_deg[0]) - lon) / 360.0)
            scale = math.cos(math.radians(float(layout.lat_deg.mean())))
            home = np.array([(lon + turn - layout.lon_deg[0]) * scale, lat - layout.lat_deg[0]])
            chosen = _nearest(begins, home)
        else:
            chosen = _corner_pass(begins, place[start:end], route.entry)
        if candidates[chosen].turned:
            yaw = turned_yaws_deg(mission, yaw, slice(start, end))
        orders.append(sequences[chosen])
    return picked(layout._replace(yaw_deg=yaw), np.concatenate(orders))


def keeps_ways(mission: Mission) -> bool:
    """Whether rows must be flown in the direction of the layout: oblique views along the track."""
    sees_aside = bool(mission.attitude.tilt_deg or mission.attitude.roll_deg)
    return sees_aside and mission.flight.facing == TRACK


def turned_yaws_deg(mission: Mission, yaw_deg: Floats, which: slice) -> Floats:
    """Yaws of captures (n,), with the captures ``which`` flown in the other direction."""
    if mission.flight.facing != TRACK:
        return yaw_deg
    turned = np.array(yaw_deg)
    turned[which] = wrap_lon_deg(turned[which] + 180.0)
    return turned


class _RowOrder(NamedTuple):
    """Order of the captures of a pass, and whether its rows are flown against the layout."""

    order: Numbers
    turned: bool


def _ways(layout: Layout, part: slice, order: str) -> list[_RowOrder]:
    """Orders of a pass: from the first or the last row, and from either end of that row."""
    _, row = np.unique(layout.row[part], return_inverse=True)
    last, column = int(row.max()), layout.column[part]
    found = []
    for rows, from_last in ((row, False), (last - row, True)):
        back = np.zeros_like(rows) if order == ONE_WAY else rows % 2
        # With an even number of rows the last one is laid out backwards.
        is_other = from_last and order != ONE_WAY and last % 2 == 1
        for along, turned in ((column, is_other), (-column, not is_other)):
            found.append(_RowOrder(np.lexsort((np.where(back, -along, along), rows)), turned))
    return found


def _nearest(places: Floats, to: Floats) -> int:
    return int(np.argmin(np.hypot(*(places - to).T)))


def _corner_pass(begins: Floats, places: Floats, entry: str) -> int:
    """Index of the first capture, of ``begins`` (v, 2), for a corner of the box around ``places`` (n, 2).

    Four first captures are assigned to the four corners so that the sum of squared distances is least.
    """
    low, high = places.min(axis=0), places.max(axis=0)
    corners = np.array(
        [[(low, high)[side > 0][axis] for axis, side in enumerate(both)] for both in COMPASS_CORNERS.values()]
    )
    asked = list(COMPASS_CORNERS).index(entry)
    if len(begins) < len(corners):
        return _nearest(begins, corners[asked])
    apart = np.square(begins[np.newaxis] - corners[:, np.newaxis]).sum(axis=-1)
    found = min(itertools.permutations(range(4)), key=lambda which: float(apart[range(4), which].sum()))
    return found[asked]
