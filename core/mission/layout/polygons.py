"""Several polygons as one flight: rows of each by themselves, in the order and from the corners that keep it short."""

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

#: Rows of one polygon, and their passes where they lie in planes.
LaidOut = Callable[[Mission], tuple[Layout, tuple[Pass, ...]]]

#: Polygons up to which the shortest order is found for sure, and up to which that from the nearest to the next nearest
#: is made shorter by turning stretches of it round.
_EXACT, _IMPROVED = 8, 400
#: Polygons from which an order is begun, at most, and times that all its stretches are looked at.
_BEGINNINGS, _ROUNDS = 16, 50


class _Ways(NamedTuple):
    """Ways to fly the rows of one polygon.

    Attributes
    ----------
    start, end : array (v, 3)
        Geocentric places, metres.
    length : array (v,)
        Of what is flown between rows, in steps.
    turns : tuple of tuples
        For each way which of `_TURNS` each pass is flown by.
    """

    start: Floats
    end: Floats
    length: Numbers
    turns: tuple[tuple[int, ...], ...]


#: Whether the captures of a pass are taken from the last to the first, and whether each row is turned round then: as
#: laid out, from the other end of the first row, and from either end of the last row.
_TURNS = ((False, False), (False, True), (True, False), (True, True))


def lay_out_polygons(mission: Mission, laid_out: LaidOut) -> tuple[Layout, tuple[Pass, ...], tuple[int, ...]]:
    """Places of a mission's captures, those of one polygon after those of another.

    Numbers of rows go on from polygon to polygon in flight order, so that pairs of column and row occur once.

    Parameters
    ----------
    laid_out : callable
        Lays out a mission over one polygon.

    Returns
    -------
    Layout, passes, and the index of the first capture of each polygon in flight order; without these last ones where
    there is one polygon.

    Raises
    ------
    InvalidInput
        As `rows.lay_out` does, of all captures together.
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
    # Captures of cameras that look aside along the track are placed for the way that the row is flown.
    kept = mission.flight.order == ONE_WAY or keeps_ways(mission)
    # These two fly each row in the direction of its layout.
    ways = [_ways(layout, passes, (0, 3) if kept else tuple(range(len(_TURNS)))) for layout, passes in found]
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
    """Each polygon's rows by themselves, longitudes in the turn of the world that the area's bounds begin."""
    count = 0
    for polygon, placed in zip(area.parts, area.placed()):
        layout, passes = laid_out(mission.replace(area=polygon))
        count += len(layout.row)
        refuse_too_many(count, mission.output.max_images)
        west, _, east, _ = placed.edges_deg
        # On another CRS longitudes begin with another turn of the world.
        turn = 360.0 * round(((west + east) / 2.0 - float(np.mean(layout.lon_deg))) / 360.0)
        yield (
            layout._replace(lon_deg=layout.lon_deg + turn) if turn else layout,
            tuple(one._replace(area=polygon) for one in passes),
        )


def _joined(layouts: Sequence[Layout]) -> Layout:
    """All captures of layouts; what is the same for all takes no memory."""
    column, row, lat, lon, *others = (list(values) for values in zip(*layouts))
    whole = [np.concatenate(values) for values in (column, row, lat, lon)]
    for values in others:
        same = all(not any(one.strides) and one[0] == values[0][0] for one in values)
        whole.append(np.broadcast_to(values[0][:1], whole[0].shape) if same else np.concatenate(values))
    return Layout(*whole)


def _slices(layout: Layout, passes: tuple[Pass, ...]) -> list[slice]:
    """Captures of each pass; all captures where rows have no passes."""
    firsts = [one.first for one in passes] or [0]
    return [slice(*ends) for ends in zip(firsts, [*firsts[1:], len(layout.row)])]


def _runs(row: Numbers) -> tuple[Numbers, Numbers]:
    """First and last index of each row."""
    change = np.flatnonzero(np.diff(row)) + 1
    return np.append(0, change), np.append(change - 1, len(row) - 1)


def _ways(layout: Layout, passes: tuple[Pass, ...], which: tuple[int, ...]) -> _Ways:
    """Ways to fly the rows of a polygon: each of its passes from either end of its first row or its last."""
    each: list[dict[int, tuple[Floats, Floats, int]]] = []
    for part in _slices(layout, passes):
        first, last = (_places(layout.lat_deg[part][at], layout.lon_deg[part][at]) for at in _runs(layout.row[part]))
        ends: dict[int, tuple[Floats, Floats, int]] = {}
        for turn in which:
            back, turned = _TURNS[turn]
            # Where each row is begun and ended, in the order in which they are flown.
            begin, end = (last, first) if back != turned else (first, last)
            begin, end = (begin[::-1], end[::-1]) if back else (begin, end)
            ends[turn] = begin[0], end[-1], int(_steps(end[:-1], begin[1:]).sum())
        each.append(ends)
    starts: list[Floats] = []
    ends_: list[Floats] = []
    lengths: list[int] = []
    turns: list[tuple[int, ...]] = []
    for chosen in product(which, repeat=len(each)):
        flown = [ends[turn] for ends, turn in zip(each, chosen)]
        between = (int(_steps(one[1], next_[0])) for one, next_ in zip(flown, flown[1:]))
        starts.append(flown[0][0])
        ends_.append(flown[-1][1])
        lengths.append(sum(one[2] for one in flown) + sum(between))
        turns.append(chosen)
    return _Ways(np.stack(starts), np.stack(ends_), np.array(lengths, np.int64), tuple(turns))


def _places(lat_deg: Floats, lon_deg: Floats) -> Floats:
    """Geocentric places (n, 3) on a sphere, metres: near enough to tell which way is the shorter one."""
    (sin_lat, cos_lat), (sin_lon, cos_lon) = sin_cos(lat_deg), sin_cos(lon_deg)
    places: Floats = WGS84.a_m * np.stack([cos_lat * cos_lon, cos_lat * sin_lon, sin_lat], axis=-1)
    return places


def _steps(start: Floats, end: Floats) -> Numbers:
    """Distances of places (..., 3) in whole steps."""
    # To the millimetre, so that the rounding of sines does not decide between ways of equal length.
    return np.asarray(np.rint(np.linalg.norm(end - start, axis=-1) * 1000.0), np.int64)


def _flown(mission: Mission, layout: Layout, passes: tuple[Pass, ...], turns: tuple[int, ...]) -> Layout:
    """Layout of a polygon with its passes flown in some way."""
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
    """Polygons in the order in which they are flown, each with the number of its way."""
    if len(ways) <= _EXACT:
        return _exact(ways)
    order = _nearest_next(ways) if len(ways) > _IMPROVED else _improved(_gaps(ways))
    return _best_ways(ways, order)


def _exact(ways: Sequence[_Ways]) -> list[tuple[int, int]]:
    """Order and ways of the shortest flight, from those of all smaller sets of polygons (Held and Karp)."""
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
            own = slice(part * each, (part + 1) * each)
            through = best[flown][:, np.newaxis] + gaps[:, own]
            nearest = through.argmin(axis=0)
            best[flown | 1 << part, own] = np.minimum(through.min(axis=0) + lengths[part], far)
            before[flown | 1 << part, own] = nearest
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
    """Least distances (n, n) from the end of one polygon to the start of another, whichever of both comes first."""
    starts = np.stack([one.start for one in ways])
    gaps = np.stack([_steps(one.end[:, np.newaxis, np.newaxis], starts[np.newaxis]).min(axis=(0, 2)) for one in ways])
    return np.asarray(np.minimum(gaps, gaps.T))


def _improved(gaps: Numbers) -> list[int]:
    """Order that begins with the nearest next, and has no stretch that would be shorter turned round (2-opt)."""
    count = len(gaps)
    best: list[int] = []
    least = None
    for beginning in np.unique(np.linspace(0, count - 1, _BEGINNINGS).astype(int)).tolist():
        order, left = [beginning], set(range(count)) - {beginning}
        while left:
            here = order[-1]
            order.append(min(left, key=lambda part: (int(gaps[here, part]), part)))
            left.remove(order[-1])
        order = _turned_round(order, gaps)
        length = int(gaps[order[:-1], order[1:]].sum())
        if least is None or length < least:
            best, least = order, length
    return best


def _turned_round(order: list[int], gaps: Numbers) -> list[int]:
    """Order with stretches turned round as long as that makes it shorter."""
    count = len(order)
    # Nothing is flown before the first polygon and after the last.
    wide = np.zeros((count + 1, count + 1), np.int64)
    wide[:count, :count] = gaps
    way = np.array([count, *order, count])
    for _ in range(_ROUNDS):
        shorter = False
        for first in range(1, count):
            last = np.arange(first + 1, count + 1)
            a, b, c, d = way[first - 1], way[first], way[last], way[last + 1]
            saved = wide[a, b] + wide[c, d] - wide[a, c] - wide[b, d]
            best = int(saved.argmax())
            if saved[best] > 0:
                way[first : last[best] + 1] = way[first : last[best] + 1][::-1]
                shorter = True
        if not shorter:
            break
    return [int(part) for part in way[1:-1]]


def _nearest_next(ways: Sequence[_Ways]) -> list[int]:
    """Order from the first polygon to the nearest next, by where they are flown as they are laid out."""
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
    """Ways of the shortest flight over polygons in this order."""
    length, before = ways[order[0]].length, []
    for part, next_ in zip(order, order[1:]):
        through = length[:, np.newaxis] + _steps(ways[part].end[:, np.newaxis], ways[next_].start[np.newaxis])
        before.append(through.argmin(axis=0))
        length = through.min(axis=0) + ways[next_].length
    at = [int(length.argmin())]
    for nearest in reversed(before):
        at.append(int(nearest[at[-1]]))
    return list(zip(order, reversed(at)))
