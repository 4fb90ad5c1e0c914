"""Spatial blocks: parts of a dataset that share no ground, and have a gap between them.

The ground is cut into blocks, bands of latitude cut by meridians, and each block is given to a part, with all images
that have their centre in it. Images of one part whose ground then reaches into that of another, or nearer to it than
the gap, are taken out of both parts' way: of the training part first, of the test part never. What is left shares no
ground whatever the blocks are like, as every image is compared with all that are near.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from .ground import Boxes

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Numbers = NDArray[np.int64]

#: Length of the equator, and of a degree of latitude on average, metres: for sizes of blocks, which are nominal.
_EQUATOR_M, _DEGREE_M = 40_075_017.0, 111_195.0
#: Below the ellipsoid's smallest radius of curvature, 6335 km: distances that are turned to angles come out too large.
_RADIUS_M = 6_330_000.0
#: Of a block: to this share centres are rounded, which in regular missions often lie right on a border, so that each
#: machine finds the same one of two blocks.
_ROUNDED = 2.0**-20
#: Pairs that are compared at a time, to bound memory: some 100 MB.
_PAIRS = 2_000_000
#: Images whose sizes differ by less than this are looked for in one go.
_ALIKE = 4.0
#: Times that blocks are chosen anew, as images that are taken out change what the shares are of.
_ROUNDS = 6


def largest_side_m(boxes: Boxes) -> float:
    """Longest side of boxes (n,), n > 0, metres on the ground."""
    shrink = np.cos(np.radians((boxes.south_deg + boxes.north_deg) / 2.0))
    width_m = (boxes.east_u - boxes.west_u) * _EQUATOR_M * shrink
    return float(max(width_m.max(), ((boxes.north_deg - boxes.south_deg) * _DEGREE_M).max()))


def blocks_of(boxes: Boxes, block_m: float) -> Numbers:
    """Number of the block (n,) in which the centre of each box lies; blocks are at least about so large."""
    lat, u = (boxes.south_deg + boxes.north_deg) / 2.0, (boxes.west_u + boxes.east_u) / 2.0
    south, west = boxes.south_deg.min(), boxes.west_u.min()
    step_deg = block_m / _DEGREE_M
    row = _floor((lat - south) / step_deg)
    middle = np.radians(np.clip(south + (row + 0.5) * step_deg, -89.9, 89.9))
    # Whole blocks around the world: each has two neighbours, wherever the antimeridian is.
    around = np.maximum(np.floor(_EQUATOR_M * np.cos(middle) / block_m), 1.0)
    column = _floor(np.mod(u - west, 1.0) * around)
    _, numbers = np.unique(np.stack([row, column]), axis=1, return_inverse=True)
    return np.asarray(numbers, np.int64).reshape(-1)


def parted(
    boxes: Boxes, block: Numbers, order: Sequence[int], shares: Sequence[float], gap_m: float
) -> Numbers:
    """Part (n,) of each box: 0 training, 1 validation, 2 test, -1 for the gap.

    Parameters
    ----------
    block : array (n,)
        Block of each box, as `blocks_of` has it.
    order : sequence of int
        All blocks, in the order in which they are given to the test and the validation part.
    shares : sequence of float
        Of training, validation and test among the boxes that are left.
    gap_m : float
        Least distance between ground of different parts.
    """
    sizes = np.bincount(block)
    best, best_off = np.full(len(block), -1, np.int64), math.inf
    targets = [share * len(block) for share in shares]
    for _ in range(_ROUNDS):
        of_block = _given(sizes, order, shares, targets)
        part = _without_gap(boxes, of_block[block], gap_m)
        off = deviation(part, shares)
        if off < best_off:
            best, best_off = part, off
        counts = np.array([(part == one).sum() for one in range(3)], np.float64)
        # What a part gave away to the gap it is to have more of; what it has too much of, less.
        moved = [
            target + (share * counts.sum() - count) / 2.0
            for target, share, count in zip(targets, shares, counts)
        ]
        if moved == targets:
            break
        targets = moved
    return best


def deviation(part: Numbers, shares: Sequence[float]) -> float:
    """Largest difference of the shares reached from those asked for; infinite where a part is left without images."""
    counts = [int((part == one).sum()) for one in range(3)]
    if any(share > 0.0 and not count for share, count in zip(shares, counts)):
        return math.inf
    return max(abs(count / sum(counts) - share) for share, count in zip(shares, counts))


def _given(
    sizes: Numbers, order: Sequence[int], shares: Sequence[float], targets: Sequence[float]
) -> Numbers:
    """Part of each block, so that parts have about as many images as is aimed for."""
    of_block = np.zeros(len(sizes), np.int64)
    left = list(order)
    for part in (2, 1):
        if shares[part] <= 0.0:
            continue
        taken = 0
        kept: list[int] = []
        others_need = int(shares[0] > 0.0) + (int(shares[1] > 0.0) if part == 2 else 0)
        for at, one in enumerate(left):
            size = int(sizes[one])
            room = len(left) - at - 1 + len(kept) >= others_need
            if room and (not taken or taken + size / 2.0 <= targets[part]) and taken < targets[part]:
                taken += size
                of_block[one] = part
            else:
                kept.append(one)
        left = kept
    if shares[0] <= 0.0:
        of_block[left] = 1 if shares[1] > 0.0 else 2
    return of_block


def _without_gap(boxes: Boxes, part: Numbers, gap_m: float) -> Numbers:
    """Parts (n,), -1 for boxes that come too near to one of another part that comes before theirs."""
    part = part.copy()
    for low, high in ((1, (2,)), (0, (1, 2))):
        mine, others = np.flatnonzero(part == low), np.flatnonzero(np.isin(part, high))
        if len(mine) and len(others):
            part[mine[near(boxes.take(mine), boxes.take(others), gap_m)]] = -1
    return part


def near(boxes: Boxes, others: Boxes, gap_m: float) -> Flags:
    """Which of the boxes (n,) share ground with one of others (m,), or are nearer to one than the gap.

    Boxes that only touch share nothing. In doubt (at corners, by the shape of the Earth) they are near.
    """
    wide = _grown(others, gap_m)
    found = np.zeros(len(boxes.west_u), np.bool_)
    for mine in _alike(boxes):
        for theirs in _alike(wide):
            some = boxes.take(mine)
            # The ground of boxes half a world away from the middle is the same one turn on.
            for turn in (-1.0, 0.0, 1.0):
                turned = wide.take(theirs)._replace(
                    west_u=wide.west_u[theirs] + turn, east_u=wide.east_u[theirs] + turn
                )
                within = (turned.east_u > some.west_u.min()) & (turned.west_u < some.east_u.max())
                if within.any():
                    found[mine] |= _meeting(some, turned.take(within))
    return found


def _grown(boxes: Boxes, gap_m: float) -> Boxes:
    """Boxes that hold all ground nearer than a gap to boxes.

    On a sphere the ground within the angle d of a point at latitude φ reaches asin(sin d / cos φ) east and west of it.
    """
    if gap_m == 0.0:
        return boxes
    angle = gap_m / _RADIUS_M
    farthest = np.radians(np.maximum(np.abs(boxes.south_deg), np.abs(boxes.north_deg)))
    ratio = math.sin(angle) / np.maximum(np.cos(farthest), 1e-12)
    over_pole = farthest + angle >= math.pi / 2.0
    more_u = np.where(over_pole, 0.5, np.arcsin(np.minimum(ratio, 1.0)) / (2.0 * math.pi))
    more_deg = math.degrees(angle)
    return Boxes(
        boxes.west_u - more_u, boxes.east_u + more_u, boxes.south_deg - more_deg, boxes.north_deg + more_deg
    )


def _alike(boxes: Boxes) -> Iterator[NDArray[np.intp]]:
    """Numbers of boxes of about the same size."""
    size = np.maximum(boxes.east_u - boxes.west_u, (boxes.north_deg - boxes.south_deg) / 360.0)
    kind = np.floor(np.log(np.maximum(size, 1e-12)) / math.log(_ALIKE))
    for one in np.unique(kind):
        yield np.flatnonzero(kind == one)


def _meeting(boxes: Boxes, others: Boxes) -> Flags:
    """Which of the boxes (n,) have ground in common with one of others (m,), n and m > 0."""
    bin_u = max(_widest(boxes.east_u - boxes.west_u), _widest(others.east_u - others.west_u))
    bin_deg = max(_widest(boxes.north_deg - boxes.south_deg), _widest(others.north_deg - others.south_deg))
    west, south = others.west_u.min() - bin_u, others.south_deg.min() - bin_deg

    def columns(u: Floats) -> Numbers:
        return np.asarray(np.floor((u - west) / bin_u), np.int64)

    def rows(lat_deg: Floats) -> Numbers:
        return np.asarray(np.floor((lat_deg - south) / bin_deg), np.int64)

    # Each box counts for the bin of its south-west corner; from one that meets another it is at most a bin away.
    first_column, last_column = columns(others.west_u) - 1, columns(others.east_u)
    first_row, last_row = rows(others.south_deg) - 1, rows(others.north_deg)
    across = max(int(last_column.max()), int(columns(boxes.west_u).max())) + 3
    inside = columns(boxes.west_u) >= -1
    # Columns before the first are those of boxes that meet none.
    candidates = np.flatnonzero(inside)
    keys = rows(boxes.south_deg[candidates]) * across + columns(boxes.west_u[candidates]) + 1
    sorting = np.argsort(keys, kind="stable")
    candidates, keys = candidates[sorting], keys[sorting]
    found = np.zeros(len(boxes.west_u), np.bool_)
    for step in range(int((last_row - first_row).max()) + 1):
        row = first_row + step
        start = np.searchsorted(keys, row * across + first_column + 1, "left")
        stop = np.searchsorted(keys, row * across + last_column + 1, "right")
        stop = np.where(row <= last_row, np.maximum(stop, start), start)
        for other, mine in _pairs(start, stop):
            at = candidates[mine]
            met = (
                (boxes.west_u[at] < others.east_u[other])
                & (boxes.east_u[at] > others.west_u[other])
                & (boxes.south_deg[at] < others.north_deg[other])
                & (boxes.north_deg[at] > others.south_deg[other])
            )
            found[at[met]] = True
    return found


def _pairs(start: Numbers, stop: Numbers) -> Iterator[tuple[Numbers, Numbers]]:
    """Pairs of i and of each number from start[i] up to stop[i], some at a time."""
    counts = stop - start
    ends = np.cumsum(counts)
    first = 0
    while first < len(counts):
        before = int(ends[first - 1]) if first else 0
        last = max(int(np.searchsorted(ends, before + _PAIRS, "right")), first + 1)
        some = np.arange(first, last)
        index = np.repeat(some, counts[first:last])
        offset = np.arange(len(index)) - np.repeat(
            ends[first:last] - counts[first:last] - before, counts[first:last]
        )
        yield index, start[index] + offset
        first = last


def _widest(sizes: Floats) -> float:
    """Largest size, and a little more, so that rounding puts no two boxes that meet two bins apart."""
    return max(float(sizes.max()), 1e-12) * (1.0 + 1e-6)


def _floor(values: Floats) -> Floats:
    whole: Floats = np.floor(np.round(values / _ROUNDED) * _ROUNDED)
    return whole
