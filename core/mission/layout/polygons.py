"""Several polygons as one flight, in an order and with entries that keep the flight short."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from ...arrays import Floats, Numbers
from ...errors import InvalidInput, Message, OptionName
from ...geodesy.ellipsoid import WGS84, sin_cos
from ..areas.area import Polygons
from ..mission import Mission
from ..parts import ONE_WAY, PAPER
from .entry import keeps_ways, turned_yaws_deg
from .rotated import Pass
from .rows import Layout, picked, refuse_too_many

#: Lays out the rows of one polygon; only rows in a plane have passes.
LaidOut = Callable[[Mission], tuple[Layout, tuple[Pass, ...]]]

#: Greatest number of polygons whose shortest order is found exactly.
_MAX_EXACT = 8
#: Greatest number of polygons whose order 2-opt improves.
_MAX_IMPROVED = 400


class _Ways(NamedTuple):
    """Ways to fly the rows of one polygon.

    Attributes
    ----------
    start, end : array (v, 3)
        Geocentric positions, metres.
    length : array (v,)
        Length of the flight between rows, in millimetres.
    turns : tuple of tuples
        Index in `_TURNS` of each pass, for each way.
    """

    start: Floats
    end: Floats
    length: Numbers
    turns: tuple[tuple[int, ...], ...]


#: Ways to fly a pass: whether the order of all captures is reversed, and whether captures are reversed within each row.
#: In turn: as laid out, from the other end of the first row, and from either end of the last row.
_TURNS = ((False, False), (False, True), (True, False), (True, True))


def lay_out_polygons(mission: Mission, laid_out: LaidOut) -> tuple[Layout, tuple[Pass, ...], tuple[int, ...]]:
    """Positions of the captures of a mission, polygon by polygon.

    Row numbers continue from polygon to polygon in flight order, so that pairs of column and row are unique.

    Parameters
    ----------
    laid_out : callable
        Lays out a mission over one polygon.

    Returns
    -------
    Layout, passes, and the indices of the first captures of polygons in flight order (empty for a single polygon).

    Raises
    ------
    InvalidInput
        As for `parallels.lay_out`, for all captures together.
    """
    area = mission.area
    if not isinstance(area, Polygons):
        return (*laid_out(mission), ())
    if len(area.parts) == 1:
        return (*laid_out(mission.replace(area=area.parts[0])), ())
    if mission.flight.layout == PAPER:
        raise InvalidInput(
            "layout {0}: lays one grid over one polygon, and there are {1:,}",
            PAPER,
            len(area.parts),
            field="layout",
            remedy=Message("use {0} {1}", OptionName("layout"), "cover"),
        )
    found = list(_laid_out(mission, area, laid_out))
    # Oblique views along the track were placed for the direction of flight.
    keeps_direction = mission.flight.order == ONE_WAY or keeps_ways(mission)
    # Ways 0 and 3 fly each row in the direction of the layout.
    ways = [_ways(layout, passes, (0, 3) if keeps_direction else tuple(range(len(_TURNS)))) for layout, passes in found]
    chosen = _shortest(ways)
    layouts, joined, firsts, rows, count = [], [], [], 0, 0
    for part, way in chosen:
        layout, passes = found[part]
        flown = _flown(mission, layout, passes, ways[part].turns[way])
        layouts.append(flown._replace(row=flown.row + rows))
        joined += [one._replace(first=one.first + count, first_row=one.first_row + rows) for one in passes]
        firsts.append(count)
        rows += int(layout.row.max()) + 1
        count += len(layout.row)
    return _joined(layouts), tuple(joined), tuple(firsts)


def _laid_out(mission: Mission, area: Polygons, laid_out: LaidOut) -> Iterator[tuple[Layout, tuple[Pass, ...]]]:
    """Rows of each polygon, with longitudes continuous over the whole area."""
    count = 0
    for polygon, placed in zip(area.parts, area.placed()):
        layout, passes = laid_out(mission.replace(area=polygon))
        count += len(layout.row)
        refuse_too_many(count, mission.output.max_images)
        west, _, east, _ = placed.edges_deg
        # Longitudes of another CRS may be a turn away.
        turn = 360.0 * round(((west + east) / 2.0 - float(np.mean(layout.lon_deg))) / 360.0)
        yield (
            layout._replace(lon_deg=layout.lon_deg + turn) if turn else layout,
            tuple(one._replace(area=polygon) for one in passes),
        )


def _joined(layouts: Sequence[Layout]) -> Layout:
    """Captures of all layouts; a value common to all takes no memory."""
    column, row, lat, lon, *others = (list(values) for values in zip(*layouts))
    whole = [np.concatenate(values) for values in (column, row, lat, lon)]
    for values in others:
        same = all(not any(one.strides) and one[0] == values[0][0] for one in values)
        whole.append(np.broadcast_to(values[0][:1], whole[0].shape) if same else np.concatenate(values))
    return Layout(*whole)


def _slices(layout: Layout, passes: tuple[Pass, ...]) -> list[slice]:
    """Captures of each pass; without passes, all captures."""
    firsts = [one.first for one in passes] or [0]
    return [slice(*ends) for ends in zip(firsts, [*firsts[1:], len(layout.row)])]


def _runs(row: Numbers) -> tuple[Numbers, Numbers]:
    """First and last index of each row."""
    change = np.flatnonzero(np.diff(row)) + 1
    return np.append(0, change), np.append(change - 1, len(row) - 1)


def _ways(layout: Layout, passes: tuple[Pass, ...], which: tuple[int, ...]) -> _Ways:
    """Ways to fly the rows of a polygon: each pass from either end of its first or last row."""
    each: list[dict[int, tuple[Floats, Floats, int]]] = []
    for part in _slices(layout, passes):
        first, last = (_places(layout.lat_deg[part][at], layout.lon_deg[part][at]) for at in _runs(layout.row[part]))
        ends: dict[int, tuple[Floats, Floats, int]] = {}
        for turn in which:
            back, turned = _TURNS[turn]
            # Ends of rows in flight order.
            begin, end = (last, first) if back != turned else (first, last)
            begin, end = (begin[::-1], end[::-1]) if back else (begin, end)
            ends[turn] = begin[0], end[-1], int(_steps(end[:-1], begin[1:]).sum())
        each.append(ends)
    starts: list[Floats] = []
    stops: list[Floats] = []
    lengths: list[int] = []
    turns: list[tuple[int, ...]] = []
    for chosen in product(which, repeat=len(each)):
        flown = [ends[turn] for ends, turn in zip(each, chosen)]
        between = (int(_steps(before[1], after[0])) for before, after in zip(flown, flown[1:]))
        starts.append(flown[0][0])
        stops.append(flown[-1][1])
        lengths.append(sum(one[2] for one in flown) + sum(between))
        turns.append(chosen)
    return _Ways(np.stack(starts), np.stack(stops), np.array(lengths, np.int64), tuple(turns))


def _places(lat_deg: Floats, lon_deg: Floats) -> Floats:
    """Geocentric positions (n, 3) on a sphere, in metres, which is accurate enough to compare ways."""
    (sin_lat, cos_lat), (sin_lon, cos_lon) = sin_cos(lat_deg), sin_cos(lon_deg)
    places: Floats = WGS84.a_m * np.stack([cos_lat * cos_lon, cos_lat * sin_lon, sin_lat], axis=-1)
    return places


def _steps(start: Floats, end: Floats) -> Numbers:
    """Distances of positions (..., 3) in whole millimetres, so that rounding does not decide between equal ways."""
    return np.asarray(np.rint(np.linalg.norm(end - start, axis=-1) * 1000.0), np.int64)


def _flown(mission: Mission, layout: Layout, passes: tuple[Pass, ...], turns: tuple[int, ...]) -> Layout:
    """Layout of a polygon with its passes flown by ``turns``."""
    if not any(turns):
        return layout
    order, yaw = [], layout.yaw_deg
    for part, turn in zip(_slices(layout, passes), turns):
        back, turned = _TURNS[turn]
        if back != turned:
            yaw = turned_yaws_deg(mission, yaw, part)
        index = np.arange(part.stop - part.start)
        if turned:
            first, last = _runs(layout.row[part])
            run = np.repeat(np.arange(len(first)), last - first + 1)
            index = first[run] + last[run] - index
        order.append(part.start + (index[::-1] if back else index))
    which = np.concatenate(order)
    return picked(layout._replace(yaw_deg=yaw), which)


# --- the order of polygons


def _shortest(ways: Sequence[_Ways]) -> list[tuple[int, int]]:
    """Polygons in flight order, each with the index of its way."""
    if len(ways) <= _MAX_EXACT:
        return _exact(ways)
    order = _nearest_next(ways) if len(ways) > _MAX_IMPROVED else _improved(_gaps(ways))
    return _best_ways(ways, order)


def _exact(ways: Sequence[_Ways]) -> list[tuple[int, int]]:
    """Order and ways of the shortest flight, by dynamic programming (Held–Karp)."""
    count, each = len(ways), len(ways[0].length)
    lengths = np.stack([one.length for one in ways])
    starts, ends = (np.concatenate([getattr(one, name) for one in ways]) for name in ("start", "end"))
    gaps = _steps(ends[:, np.newaxis], starts[np.newaxis])
    far = np.iinfo(np.int64).max // 4
    best = np.full((1 << count, count * each), far)
    before = np.zeros((1 << count, count * each), np.int64)
    for part in range(count):
        best[1 << part, part * each : (part + 1) * each] = lengths[part]
    for flown in range(1, 1 << count):
        for part in (one for one in range(count) if not flown >> one & 1):
            states = slice(part * each, (part + 1) * each)
            through = best[flown][:, np.newaxis] + gaps[:, states]
            nearest = through.argmin(axis=0)
            best[flown | 1 << part, states] = np.minimum(through.min(axis=0) + lengths[part], far)
            before[flown | 1 << part, states] = nearest
    flown = (1 << count) - 1
    at = int(best[flown].argmin())
    chosen = []
    while True:
        part, way = divmod(at, each)
        chosen.append((part, way))
        rest = flown & ~(1 << part)
        if not rest:
            return chosen[::-1]
        at, flown = int(before[flown, at]), rest


def _gaps(ways: Sequence[_Ways]) -> Numbers:
    """Least distances (n, n) between polygons, in either order."""
    starts = np.stack([one.start for one in ways])
    gaps = np.stack([_steps(one.end[:, np.newaxis, np.newaxis], starts[np.newaxis]).min(axis=(0, 2)) for one in ways])
    return np.asarray(np.minimum(gaps, gaps.T))


def _improved(gaps: Numbers) -> list[int]:
    """Short order: the best of several nearest-neighbour orders, improved by 2-opt."""
    count = len(gaps)
    best: list[int] = []
    least = None
    for beginning in np.unique(np.linspace(0, count - 1, 16).astype(int)).tolist():
        order, left = [beginning], set(range(count)) - {beginning}
        while left:
            here = order[-1]
            order.append(min(left, key=lambda part: (int(gaps[here, part]), part)))
            left.remove(order[-1])
        order = _two_opt(order, gaps)
        length = int(gaps[order[:-1], order[1:]].sum())
        if least is None or length < least:
            best, least = order, length
    return best


def _two_opt(order: list[int], gaps: Numbers) -> list[int]:
    """Order improved by reversing stretches (2-opt)."""
    count = len(order)
    # No distance is flown before the first polygon or after the last.
    wide = np.zeros((count + 1, count + 1), np.int64)
    wide[:count, :count] = gaps
    sequence = np.array([count, *order, count])
    # 50 rounds bound the time.
    for _ in range(50):
        shorter = False
        for first in range(1, count):
            last = np.arange(first + 1, count + 1)
            a, b, c, d = sequence[first - 1], sequence[first], sequence[last], sequence[last + 1]
            saved = wide[a, b] + wide[c, d] - wide[a, c] - wide[b, d]
            best = int(saved.argmax())
            if saved[best] > 0:
                sequence[first : last[best] + 1] = sequence[first : last[best] + 1][::-1]
                shorter = True
        if not shorter:
            break
    return [int(part) for part in sequence[1:-1]]


def _nearest_next(ways: Sequence[_Ways]) -> list[int]:
    """Nearest-neighbour order from the first polygon, for rows flown as laid out."""
    starts, ends = (np.stack([getattr(one, name)[0] for one in ways]) for name in ("start", "end"))
    left = np.ones(len(ways), bool)
    order = [0]
    left[0] = False
    while left.any():
        distances = _steps(ends[order[-1]], starts)
        distances[~left] = np.iinfo(np.int64).max
        order.append(int(distances.argmin()))
        left[order[-1]] = False
    return order


def _best_ways(ways: Sequence[_Ways], order: Sequence[int]) -> list[tuple[int, int]]:
    """Ways of the shortest flight over polygons in an order."""
    length, before = ways[order[0]].length, []
    for part, following in zip(order, order[1:]):
        through = length[:, np.newaxis] + _steps(ways[part].end[:, np.newaxis], ways[following].start[np.newaxis])
        before.append(through.argmin(axis=0))
        length = through.min(axis=0) + ways[following].length
    at = [int(length.argmin())]
    for nearest in reversed(before):
        at.append(int(nearest[at[-1]]))
    return list(zip(order, reversed(at)))
