"""Removal of the rows that a mission skips."""

from __future__ import annotations

import numpy as np

from ...arrays import Flags
from ...errors import InvalidInput
from ...text.ranges import read_ranges
from ..mission import Mission
from ..parts import ONE_WAY
from .entry import keeps_ways, turned_yaws_deg
from .no_fly import without
from .rotated import Pass
from .rows import Layout, picked


def remove_rows(
    mission: Mission, layout: Layout, passes: tuple[Pass, ...], parts: tuple[int, ...]
) -> tuple[Layout, tuple[Pass, ...], tuple[int, ...], int]:
    """Remove the rows that the mission skips; the others keep their order and indices.

    The remaining rows of each pass are flown to and fro anew, unless oblique views were placed for the direction.

    Returns
    -------
    layout, passes, parts
        As `no_fly.remove_no_fly` returns them.
    int
        Number of captures removed.

    Raises
    ------
    InvalidInput
        The mission has no such row, or no other.
    """
    asked = read_ranges(mission.flight.skip_rows)
    if not asked:
        return layout, passes, parts, 0
    if not mission.area.covers_ground:
        raise InvalidInput("skipped rows {0}: points have no rows", mission.flight.skip_rows, field="skip_rows")
    last = int(layout.row.max())
    if asked[-1][1] > last:
        raise InvalidInput(
            "skipped rows {0}: the rows of this mission are 0 to {1:,}",
            mission.flight.skip_rows,
            last,
            field="skip_rows",
        )
    removed = np.zeros(len(layout.row), bool)
    for first, end in asked:
        removed |= (layout.row >= first) & (layout.row <= end)
    if removed.all():
        raise InvalidInput("skipped rows {0}: no row is left", mission.flight.skip_rows, field="skip_rows")
    if mission.flight.order != ONE_WAY and not keeps_ways(mission):
        layout = _to_and_fro(mission, layout, removed, {0, *parts, *(one.first for one in passes)})
    return (*without(removed, layout, passes, parts), int(removed.sum()))


def _to_and_fro(mission: Mission, layout: Layout, removed: Flags, firsts: set[int]) -> Layout:
    """Captures with rows reversed that come after an odd number of skipped rows of their pass."""
    count = len(layout.row)
    begins = np.append(True, np.diff(layout.row) != 0)
    begins[[one for one in firsts if one < count]] = True
    rows = np.flatnonzero(begins)
    ends = np.append(rows[1:], count)
    order, yaw, skipped = np.arange(count), layout.yaw_deg, 0
    for first, end in zip(rows.tolist(), ends.tolist()):
        skipped = 0 if first in firsts else skipped
        if removed[first]:
            skipped += 1
        elif skipped % 2:
            order[first:end] = order[first:end][::-1]
            yaw = turned_yaws_deg(mission, yaw, slice(first, end))
    return picked(layout._replace(yaw_deg=yaw), order)
