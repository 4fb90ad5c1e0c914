"""Masks of the classes and instances in an image: areas, boxes, run lengths and outlines."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arrays import Flags, NDArray, Numbers

#: Bits of a class id in the keys of masks, below those of the instance.
_CLASS_BITS = 16
#: Characters of a number in COCO's run lengths: five bits each, and a sign.
_MOST_CHARACTERS = 7
#: Pairs of corners whose distances are computed at once.
_MOST_PAIRS = 1 << 22


class MaskOutlines(NamedTuple):
    """Rings of masks along the edges of pixels, with the mask on the right; corners only.

    Parameters
    ----------
    mask : array (k,)
        Mask of each ring, ascending. A mask has one outer ring for each part whose pixels share edges.
    is_hole : array (k,)
    starts : array (k + 1,)
        First corner of each ring.
    corners : array (m, 2)
        Column and row of pixel corners; (0, 0) is the image's upper left corner. Rings are not closed.
    """

    mask: Numbers
    is_hole: Flags
    starts: Numbers
    corners: Numbers

    def rings(self, mask: int) -> list[Numbers]:
        """Rings (c, 2) of one mask; outer rings precede their holes."""
        first, end = np.searchsorted(self.mask, [mask, mask + 1]).tolist()
        starts = self.starts[first : end + 1].tolist()
        return [self.corners[start:stop] for start, stop in zip(starts, starts[1:])]


class Masks:
    """Pixels of an image by class and instance; masks are numbered from 0 by instance, then class.

    Parameters
    ----------
    classes, instances : array (h, w) of int64
        Classes of 16 bits, instances of 32.
    left_out : tuple of int
        Classes whose pixels belong to no mask.

    Attributes
    ----------
    classes, instances : array (n,)
        Class and instance of each mask.
    areas_px : array (n,)
    boxes_px : array (n, 4)
        Left, top, width, height.
    """

    def __init__(self, classes: Numbers, instances: Numbers, left_out: tuple[int, ...]) -> None:
        self.height, self.width = classes.shape
        # Runs of equal pixels down the columns, one column after the other, as COCO has them.
        keys = ((instances << _CLASS_BITS) | classes).ravel(order="F")
        starts = np.concatenate([[0], np.flatnonzero(keys[1:] != keys[:-1]) + 1])
        lengths = np.diff(starts, append=len(keys))
        found, number = np.unique(keys[starts], return_inverse=True)
        found_classes = found & ((1 << _CLASS_BITS) - 1)
        kept = ~np.isin(found_classes, left_out)
        # Numbers from 1; 0 is no mask.
        mask = (np.cumsum(kept) * kept)[number]
        self._image = np.repeat(mask, lengths).reshape(self.width, self.height).T
        self.classes, self.instances = found_classes[kept], found[kept] >> _CLASS_BITS
        by_mask = np.argsort(mask, kind="stable")[np.count_nonzero(mask == 0) :]
        self._start, self._end = starts[by_mask], starts[by_mask] + lengths[by_mask]
        self._counts = np.bincount(mask[by_mask] - 1, minlength=len(self))
        self.areas_px = np.add.reduceat(lengths[by_mask], self._first) if len(self) else self._counts
        self.boxes_px = self._boxes()

    def __len__(self) -> int:
        return len(self.classes)

    @property
    def _first(self) -> Numbers:
        """First run of each mask."""
        return np.cumsum(self._counts) - self._counts

    def _boxes(self) -> Numbers:
        if not len(self):
            return np.zeros((0, 4), np.int64)
        left, top = np.divmod(self._start, self.height)
        right, bottom = np.divmod(self._end - 1, self.height)
        # Runs that continue in the next column have its first row, and the last row of their own.
        is_long = right > left
        least = [np.minimum.reduceat(one, self._first) for one in (left, np.where(is_long, 0, top))]
        most = [
            np.maximum.reduceat(one, self._first) + 1 for one in (right, np.where(is_long, self.height - 1, bottom))
        ]
        return np.stack([*least, most[0] - least[0], most[1] - least[1]], axis=1)

    def run_lengths(self) -> list[str]:
        """Run lengths of each mask as text, as COCO's `rleToString` writes them."""
        counts = self._counts
        gap = self._start.copy()
        gap[1:] -= self._end[:-1]
        gap[self._first] = self._start[self._first]
        last = self.height * self.width - self._end[np.cumsum(counts) - 1]
        lengths = np.insert(np.stack([gap, self._end - self._start], axis=1).ravel(), 2 * np.cumsum(counts), last)
        mask = np.repeat(np.arange(len(self)), 2 * counts + 1)
        ends = np.cumsum(2 * counts + 1)
        kept = np.ones(len(mask), np.bool_)
        kept[ends - 1] = last > 0
        # From the fourth on, numbers are differences from the last but one.
        place = np.arange(len(mask)) - np.repeat(ends - 2 * counts - 1, 2 * counts + 1)
        values = lengths.copy()
        values[2:] -= np.where(place[2:] > 2, lengths[:-2], 0)
        characters = _characters(values[kept])
        sizes = np.bincount(mask[kept], np.count_nonzero(characters, axis=1), len(self)).astype(np.int64)
        text = characters[characters > 0].tobytes().decode("ascii")
        stops = np.cumsum(sizes)
        return [text[start:stop] for start, stop in zip((stops - sizes).tolist(), stops.tolist())]

    @cached_property
    def outlines(self) -> MaskOutlines:
        """Outlines of all masks."""
        # A rim of no mask on all sides. Corners are numbered as the pixels to their upper left.
        image = np.pad(self._image, 1)
        row_px = image.shape[1]
        pixels = image.ravel()
        # Offsets from a corner to the pixels on the right of edges that begin there, to the east, south, west, north.
        right = np.array([row_px + 1, row_px, 0, 1])
        left = np.roll(right, 1)
        ahead = np.array([1, row_px, -1, -row_px])
        corners = [pixels[offset : offset + len(pixels) - row_px - 1] for offset in right.tolist()]
        starts = [np.flatnonzero((corners[to] > 0) & (corners[to] != corners[to - 1])) for to in range(4)]
        start, direction = np.concatenate(starts), np.repeat(np.arange(4), [len(one) for one in starts])
        mask = pixels[start + right[direction]]
        end = start + ahead[direction]
        # At its end, an edge turns right unless the mask goes on there: parts that touch at a corner stay apart.
        goes_on = pixels[end + right[direction]] == mask
        turn = np.where(~goes_on, 1, np.where(pixels[end + left[direction]] == mask, -1, 0))
        edge = np.empty(4 * len(pixels), np.int64)
        edge[4 * start + direction] = np.arange(len(start))
        following = edge[4 * end + (direction + turn) % 4]
        begins = np.zeros(len(start), np.bool_)
        begins[following] = turn != 0
        order, counts = _cycles(following, begins)
        places = np.stack([start[order] % row_px, start[order] // row_px], axis=1)
        return _outlines(mask[order] - 1, counts, places)


def _characters(values: Numbers) -> NDArray[np.uint8]:
    """Characters (n, 7) of numbers as in COCO's run lengths; 0 after the last."""
    found = np.zeros((len(values), _MOST_CHARACTERS), np.uint8)
    left = np.arange(len(values))
    for at in range(_MOST_CHARACTERS):
        bits, values = values & 31, values >> 5
        more = values != np.where(bits & 16, -1, 0)
        found[left, at] = 48 + bits + 32 * more
        left, values = left[more], values[more]
    return found


def _cycles(following: Numbers, begins: Flags) -> tuple[Numbers, Numbers]:
    """Cycles of a permutation: elements that begin something, cycle by cycle, and their number in each cycle."""
    after, is_kept = following.tolist(), begins.tolist()
    order: list[int] = []
    ends = [0]
    for first in np.flatnonzero(begins).tolist():
        at = first
        while after[at] >= 0:
            if is_kept[at]:
                order.append(at)
            following_one, after[at] = after[at], -1
            at = following_one
        if len(order) > ends[-1]:
            ends.append(len(order))
    return np.array(order, np.int64), np.diff(np.array(ends, np.int64))


def _outlines(mask: Numbers, counts: Numbers, corners: Numbers) -> MaskOutlines:
    """Outlines of rings with ``counts`` corners each, in the order of their masks."""
    starts = np.cumsum(counts) - counts
    if not len(starts):
        return MaskOutlines(starts, np.zeros(0, np.bool_), np.zeros(1, np.int64), corners)
    after = np.arange(1, len(corners) + 1)
    after[starts + counts - 1] = starts
    twice = corners[:, 0] * corners[after, 1] - corners[after, 0] * corners[:, 1]
    by_mask = np.argsort(mask[starts], kind="stable")
    sizes = counts[by_mask]
    stops = np.cumsum(sizes)
    moved = np.arange(len(corners)) + np.repeat(starts[by_mask] - (stops - sizes), sizes)
    is_hole = np.add.reduceat(twice, starts)[by_mask] < 0
    return MaskOutlines(mask[starts][by_mask], is_hole, np.concatenate([[0], stops]), corners[moved])


def join_rings(rings: list[Numbers]) -> Numbers:
    """Join rings (c, 2) to one (c, 2), by bridges there and back between nearest corners, along edges of pixels."""
    whole = rings[0]
    for ring in rings[1:]:
        at, to = _nearest(whole, ring)
        bridge = np.array([[ring[to, 0], whole[at, 1]]])
        whole = np.concatenate(
            [whole[: at + 1], bridge, np.roll(ring, -to, axis=0), ring[to : to + 1], bridge, whole[at:]]
        )
    return whole


def _nearest(one: Numbers, other: Numbers) -> tuple[int, int]:
    """Indices of two corners with the least distance along rows and columns."""
    step = max(_MOST_PAIRS // len(other), 1)
    best = (np.inf, 0, 0)
    for start in range(0, len(one), step):
        distance = np.abs(one[start : start + step, np.newaxis] - other).sum(axis=2)
        at, to = divmod(int(distance.argmin()), len(other))
        best = min(best, (float(distance[at, to]), start + at, to))
    return best[1], best[2]
