"""Spatial index of captures, which finds the captures in view among a million in milliseconds. Numpy only."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .view import MERCATOR, PreviewWorld, Rect

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Numbers = NDArray[np.int64]


class Rects(NamedTuple):
    """Rectangles of a world in metres, (n,) each; across the antimeridian, ``east`` exceeds the world's east edge."""

    west: Floats
    south: Floats
    east: Floats
    north: Floats
    world: PreviewWorld = MERCATOR

    @classmethod
    def wrapped(cls, west: Floats, south: Floats, east: Floats, north: Floats, world: PreviewWorld = MERCATOR) -> Rects:
        """Rectangles from continuous eastings; none is wider than the world."""
        if world.wraps:
            east = np.minimum(east, west + world.size)
            turn = np.floor((west - world.west) / world.size)
            if turn.any():
                west, east = west - world.size * turn, east - world.size * turn
        return cls(west, south, east, north, world)

    @property
    def longer_m(self) -> Floats:
        """Longer side of each rectangle."""
        return np.maximum(self.east - self.west, self.north - self.south)

    def take(self, which: Numbers) -> Rects:
        """Return some of the rectangles."""
        return Rects(*(edge[which] for edge in self.edges), self.world)

    @property
    def edges(self) -> tuple[Floats, Floats, Floats, Floats]:
        """West, south, east, north."""
        return self[:4]

    @property
    def middles(self) -> tuple[Floats, Floats]:
        """Middle of each rectangle, within the world."""
        x = (self.west + self.east) / 2.0
        if self.world.wraps:
            # The middle may be beyond the antimeridian.
            x = np.where(x >= self.world.east, x - self.world.size, x)
        return x, (self.south + self.north) / 2.0

    def meets(self, rect: Rect) -> NDArray[np.bool_]:
        """Whether each rectangle overlaps ``rect``."""
        in_rows = (self.south <= rect.north) & (self.north >= rect.south)
        in_columns = np.zeros(len(self.west), bool)
        for shift in self.world.shifts:
            in_columns |= (self.west + shift <= rect.east) & (self.east + shift >= rect.west)
        return in_rows & in_columns


class CaptureIndex:
    """Captures by place and size, in classes of sizes that differ by less than a factor of two.

    The bins of a class are as wide as its largest captures. A query reads the ranges of the bins it needs from sorted
    arrays, and no other captures.
    """

    def __init__(self, boxes: Rects) -> None:
        self.boxes = boxes
        self.longer_m = boxes.longer_m
        # Bins are at least 0.1 m wide, so that their numbers fit into 64 bits.
        least = max(float(self.longer_m.min()), 0.05)
        size_class = np.floor(np.log2(np.maximum(self.longer_m, least) / least)).astype(np.int64)
        self._levels = [
            _SizeClass(boxes, np.flatnonzero(size_class == number), least * 2.0 ** (number + 1))
            for number in np.unique(size_class).tolist()
        ]

    def __len__(self) -> int:
        return len(self.longer_m)

    def count(self, rect: Rect, from_m: float = 0.0) -> int:
        """Upper limit of the number of captures from `find`, computed without reading them."""
        return sum(int((stop - start).sum()) for _, start, stop in self._slices(rect, from_m))

    def find(self, rect: Rect, from_m: float = 0.0) -> Numbers:
        """Captures that overlap a rectangle and whose longer side is at least ``from_m``, in flight order."""
        found = [level.ids[_ranges(start, stop)] for level, start, stop in self._slices(rect, from_m)]
        ids = np.sort(np.concatenate([np.empty(0, np.int64), *found]))
        return ids[(self.longer_m[ids] >= from_m) & self.boxes.take(ids).meets(rect)]

    def _slices(self, rect: Rect, from_m: float) -> list[tuple[_SizeClass, Numbers, Numbers]]:
        return [(level, *level.slices(rect)) for level in self._levels if level.bin_m >= from_m]


class _SizeClass:
    """Captures of one size class, sorted by bin."""

    def __init__(self, boxes: Rects, ids: Numbers, bin_m: float) -> None:
        self.bin_m = bin_m
        world = self._world = boxes.world
        middle_x, middle_y = (boxes if len(ids) == len(boxes.west) else boxes.take(ids)).middles
        column, row = self._bin(middle_x, world.west), self._bin(middle_y, world.south)
        self._columns = int(world.size / bin_m) + 2
        key = row * self._columns + column
        order = np.argsort(key, kind="stable")
        self.ids, self._keys = ids[order], key[order]
        rows = self._keys // self._columns
        self._rows = rows[np.r_[True, rows[1:] != rows[:-1]]]

    def _bin(self, position_m: Floats, from_m: float) -> Numbers:
        return np.floor((position_m - from_m) / self.bin_m).astype(np.int64)

    def slices(self, rect: Rect) -> tuple[Numbers, Numbers]:
        """Ranges in ``ids`` of the bins that a rectangle may touch: starts and stops."""
        reach, world = self.bin_m / 2.0, self._world
        low, high = self._bin(np.array([rect.south - reach, rect.north + reach]), world.south).tolist()
        rows = self._rows[np.searchsorted(self._rows, low) : np.searchsorted(self._rows, high, "right")]
        starts, stops = [], []
        after = -1
        for shift in world.shifts:
            west = max(rect.west - reach + shift, world.west)
            east = min(rect.east + reach + shift, world.east)
            if west > east:
                continue
            first, last = self._bin(np.array([west, east]), world.west).tolist()
            first = max(first, after)
            if first <= last:
                starts.append(np.searchsorted(self._keys, rows * self._columns + first))
                stops.append(np.searchsorted(self._keys, rows * self._columns + last, "right"))
                after = last + 1
        none = [np.empty(0, np.int64)]
        return np.concatenate(starts or none), np.concatenate(stops or none)


def _ranges(start: Numbers, stop: Numbers) -> Numbers:
    """Integers of all ranges, one range after another."""
    counts = stop - start
    before = np.cumsum(counts) - counts
    return np.arange(int(counts.sum())) + np.repeat(start - before, counts)


def count_shown(boxes: Rects, x_m: Floats, y_m: Floats) -> Numbers:
    """Number of rectangles that contain each place, (m,); ``x_m`` must be within the world."""
    order = np.argsort(y_m)
    heights, eastings = y_m[order], x_m[order]
    first = np.searchsorted(heights, boxes.south)
    last = np.searchsorted(heights, boxes.north)
    pairs = np.cumsum(last - first)
    shown = np.zeros(len(order), np.int64)
    # Work in parts, to limit the memory.
    pairs_at_once = 1_000_000
    cuts = np.searchsorted(pairs, np.arange(pairs_at_once, pairs[-1] if len(pairs) else 0, pairs_at_once)).tolist()
    for begin, end in zip([0, *cuts], [*cuts, len(first)]):
        place = _ranges(first[begin:end], last[begin:end])
        box = np.repeat(np.arange(begin, end), (last - first)[begin:end])
        x, west, east = eastings[place], boxes.west[box], boxes.east[box]
        inside = (west <= x) & (x < east)
        if boxes.world.wraps:
            inside |= x + boxes.world.size < east
        shown += np.bincount(place[inside], minlength=len(shown))
    result = np.empty_like(shown)
    result[order] = shown
    return result
