"""Roofs beneath others, which imagery taken from above does not show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Flags, Floats, Numbers, expand_counts
from .local import enu_axes, geodetic
from .triangles import ROOF, WALL, Triangles

#: Side of the cells by which triangles above each other are searched for, metres.
_CELL_M = 16.0
#: Triangles of a cell from which its roofs count as covered: their pairs would fill the memory.
_MOST_IN_CELL = 4096
#: Pairs compared at once.
_BATCH = 1 << 16
#: How far two triangles overlap, and one lies above the other, to count: neighbours share edges.
_LEAST_M = 0.02


def with_covered(triangles: Triangles, group: Numbers) -> Triangles:
    """Triangles whose roofs do not show the imagery where a triangle of another group lies above some point of them.

    Parameters
    ----------
    triangles : Triangles
        Within a few kilometres of each other.
    group : array (n,) of int64
        Those of one group do not cover each other.
    """
    level = np.flatnonzero(triangles.kind != WALL)
    lower = np.flatnonzero((triangles.shows_imagery & (triangles.kind == ROOF))[level])
    if not len(lower) or group.min() == group.max():
        return triangles
    corners, group = triangles.corners_m[level], group[level]
    centre = corners[lower[0], 0]
    lat, lon, _ = geodetic(centre)
    corners = (corners - centre) @ enu_axes(lat, lon).T
    # Three corners compared are several times as fast as a reduction of rows of three.
    first, second, third = corners[:, 0], corners[:, 1], corners[:, 2]
    low, high = (end(end(first, second), third) for end in (np.minimum, np.maximum))
    one, other, crowded = _pairs(low, high, lower)
    # Overlapping boxes, of which the other's is not all beneath.
    near = (group[one] != group[other]) & (high[other, 2] > low[one, 2] + _LEAST_M)
    near &= (np.minimum(high[one, :2], high[other, :2]) - np.maximum(low[one, :2], low[other, :2]) > _LEAST_M).all(
        axis=1
    )
    one, other = one[near], other[near]
    shows = triangles.shows_imagery.copy()
    shows[level[crowded]] = False
    for begin in range(0, len(one), _BATCH):
        some = slice(begin, begin + _BATCH)
        shows[level[one[some][_is_above(corners[one[some]], corners[other[some]])]]] = False
    return replace(triangles, shows_imagery=shows)


def _pairs(low: Floats, high: Floats, lower: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """Pairs of one of the triangles ``lower`` and any triangle whose boxes share a cell; each pair once.

    Those of ``lower`` in a crowded cell are in no pair, and returned by themselves.
    """
    first, last = (np.floor(at[:, :2] / _CELL_M).astype(np.int64) for at in (low, high))
    size = last - first + 1
    stride = int(last[:, 1].max()) + 2 - int(first[:, 1].min())

    def cells(which: Numbers) -> tuple[Numbers, Numbers]:
        at, number = expand_counts(size[which].prod(axis=1))
        some = which[at]
        across, down = number // size[some, 1], number % size[some, 1]
        return some, (first[some, 0] + across) * stride + first[some, 1] + down

    (one, one_cell), (other, other_cell) = cells(lower), cells(np.arange(len(low)))
    order = np.argsort(other_cell, kind="stable")
    other, other_cell = other[order], other_cell[order]
    begin, end = (np.searchsorted(other_cell, one_cell, side) for side in ("left", "right"))
    is_crowded = end - begin > _MOST_IN_CELL
    at, number = expand_counts(np.where(is_crowded, 0, end - begin))
    pairs = np.unique(one[at] * np.int64(len(low)) + other[begin[at] + number])
    return pairs // len(low), pairs % len(low), np.unique(one[is_crowded])


def _is_above(one: Floats, other: Floats) -> Flags:
    """Whether the second triangle of each pair (n, 3, 3), east, north and up, lies above some point of the first.

    The corners of what both cover from above are corners of either, or where edges cross; their mean is inside.
    """
    points = np.concatenate([one[..., :2], other[..., :2], _crossings(one[..., :2], other[..., :2])], axis=1)
    inside = np.isfinite(points).all(axis=2)
    points = np.where(inside[..., np.newaxis], points, 0.0)
    for triangle in (one, other):
        inside &= _edge_distances(triangle[..., :2], points).min(axis=2) > -_LEAST_M / 4.0
    count = inside.sum(axis=1)
    mean = (points * inside[..., np.newaxis]).sum(axis=1) / np.maximum(count, 1)[:, np.newaxis]
    room = [_edge_distances(triangle[..., :2], mean[:, np.newaxis])[:, 0].min(axis=1) for triangle in (one, other)]
    found: Flags = (count > 0) & (np.minimum(*room) > _LEAST_M / 2.0)
    found &= _height(other, mean) > _height(one, mean) + _LEAST_M
    return found


def _turned(corners: Floats) -> tuple[Floats, Floats]:
    """Corners (n, 3, 2) of triangles, each with the next; counter-clockwise."""
    after = np.roll(corners, -1, axis=1)
    way, third = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    clockwise = (way[:, 0] * third[:, 1] < way[:, 1] * third[:, 0])[:, np.newaxis, np.newaxis]
    return np.where(clockwise, after, corners), np.where(clockwise, corners, after)


def _edge_distances(corners: Floats, points: Floats) -> Floats:
    """How far points (n, k, 2) are inside each edge of a triangle (n, 3, 2); (n, k, 3)."""
    begin, end = _turned(corners)
    way = end - begin
    length = np.maximum(np.hypot(way[..., 0], way[..., 1]), np.finfo(float).tiny)
    offsets = points[:, :, np.newaxis] - begin[:, np.newaxis]
    cross = way[:, np.newaxis, :, 0] * offsets[..., 1] - way[:, np.newaxis, :, 1] * offsets[..., 0]
    distances: Floats = cross / length[:, np.newaxis]
    return distances


def _crossings(one: Floats, other: Floats) -> Floats:
    """Points (n, 9, 2) where lines through the edges of two triangles cross; not finite where they are parallel."""
    begin, way = one[:, :, np.newaxis], (np.roll(one, -1, axis=1) - one)[:, :, np.newaxis]
    start, course = other[:, np.newaxis], (np.roll(other, -1, axis=1) - other)[:, np.newaxis]
    gap = start - begin
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (gap[..., 0] * course[..., 1] - gap[..., 1] * course[..., 0]) / (
            way[..., 0] * course[..., 1] - way[..., 1] * course[..., 0]
        )
        points: Floats = (begin + share[..., np.newaxis] * way).reshape(len(one), 9, 2)
    return points


def _height(corners: Floats, points: Floats) -> Floats:
    """Height of the planes of triangles (n, 3, 3) at points (n, 2)."""
    first = corners[:, 0]
    normal = np.cross(corners[:, 1] - first, corners[:, 2] - first)
    with np.errstate(divide="ignore", invalid="ignore"):
        fall = (normal[:, :2] * (points - first[:, :2])).sum(axis=1) / normal[:, 2]
    heights: Floats = first[:, 2] - fall
    return heights
