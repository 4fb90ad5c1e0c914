"""Shortest ways around polygons in a plane at a clearance: A* on the visibility graph of their corners."""

from __future__ import annotations

import heapq
import math
from collections.abc import Sequence

import numpy as np

from ..arrays import Flags, Floats
from ..errors import InvalidInput, Message
from .ellipsoid import arctan2

#: Relative tolerance of clearances for rounding, as ways pass corners at exactly the clearance.
_TOLERANCE = 1e-6


def way_around(
    start_m: Floats, end_m: Floats, polygons: Sequence[Sequence[Floats]], clearance_m: float = 0.0
) -> Floats:
    """Shortest way from one point of a plane to another that keeps a clearance from polygons.

    Around a corner the way follows a polygon circumscribed about the arc, which adds less than 2 % of the clearance to
    the shortest way. If start or end lies nearer to a polygon than the clearance, the first or last leg keeps
    that smaller distance.

    Parameters
    ----------
    start_m, end_m : array (2,)
        Points in the plane, metres.
    polygons : sequence of polygons
        Each a sequence of rings, arrays (k, 2), the outer one first, not closed; ways may lead through holes.
    clearance_m : float
        Least distance from polygons; at least 1 mm is kept.

    Returns
    -------
    array (m, 2)
        Points of the way with start and end; only these two if the straight way is free.

    Raises
    ------
    InvalidInput
        Start or end lie inside a polygon, or no way connects them.
    """
    start, end = (np.asarray(place, np.float64).reshape(2) for place in (start_m, end_m))
    straight: Floats = np.stack([start, end])
    rings = [np.asarray(ring, np.float64).reshape(-1, 2) for polygon in polygons for ring in polygon]
    if not rings:
        return straight
    sides = np.concatenate([np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in rings])
    inside = _inside(straight, polygons)
    if inside.any():
        which = Message("the start of a leg") if inside[0] else Message("the end of a leg")
        raise InvalidInput("{0}: lies inside a no-fly area", which, remedy="move it outside")
    # A way that touches a polygon cannot be distinguished from one that cuts its corner.
    clearance = max(clearance_m, 1e-3)
    kept = np.minimum(_distances(straight, straight, sides).min(axis=1), clearance)
    if _free(start, end[np.newaxis], sides, np.array([kept.min()]))[0]:
        return straight
    corners = np.concatenate([_arc_corners(ring, clearance) for ring in _oriented(polygons)])
    off = _distances(corners, corners, sides).min(axis=1) >= clearance * (1.0 - _TOLERANCE)
    corners = corners[off & ~_inside(corners, polygons)]
    places = np.concatenate([straight, corners])
    least = np.concatenate([kept, np.full(len(corners), clearance)])
    return _shortest(places, least, sides)


def _shortest(places: Floats, least: Floats, sides: Floats) -> Floats:
    """Shortest way from the first point to the second through others; legs keep the smaller clearance of their ends."""
    to_end = np.linalg.norm(places - places[1], axis=1)
    length, before = np.full(len(places), np.inf), np.full(len(places), -1)
    length[0] = 0.0
    settled = np.zeros(len(places), bool)
    waiting = [(float(to_end[0]), 0)]
    while waiting:
        _, here = heapq.heappop(waiting)
        if here == 1:
            way = [1]
            while way[-1] != 0:
                way.append(int(before[way[-1]]))
            return np.asarray(places[way[::-1]])
        if settled[here]:
            continue
        settled[here] = True
        through = length[here] + np.linalg.norm(places - places[here], axis=1)
        # Only legs that shorten a way are tested.
        better = np.flatnonzero(~settled & (through < length))
        free = _free(places[here], places[better], sides, np.minimum(least[better], least[here]))
        for next_ in better[free].tolist():
            length[next_], before[next_] = through[next_], here
            heapq.heappush(waiting, (float(through[next_] + to_end[next_]), next_))
    raise InvalidInput("no way leads around the no-fly areas", remedy="leave room between them, or keep less distance")


def _oriented(polygons: Sequence[Sequence[Floats]]) -> list[Floats]:
    """Rings with the polygon's inside to the left of their sides."""
    found = []
    for polygon in polygons:
        for number, ring in enumerate(polygon):
            corners = np.asarray(ring, np.float64).reshape(-1, 2)
            x, y = corners.T
            twice = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
            found.append(corners if (twice > 0.0) == (number == 0) else corners[::-1])
    return found


def _arc_corners(ring: Floats, distance: float) -> Floats:
    """Corners (m, 2) of polygons circumscribed about the arcs at ``distance`` around a ring's convex corners."""
    come, go = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    turn = np.arctan2(come[:, 0] * go[:, 1] - come[:, 1] * go[:, 0], np.sum(come * go, axis=1))
    # The arc begins to the right of the side before the corner.
    first = arctan2(-come[:, 0], come[:, 1])
    found = [np.empty((0, 2))]
    for corner, begin, angle in zip(ring, first.tolist(), turn.tolist()):
        if angle <= 0.0:
            continue
        # Turns of 22.5 degrees at most leave the arc by less than 2 % of the distance.
        pieces = max(math.ceil(angle / math.radians(22.5)), 1)
        step = angle / pieces
        at = begin + step * (np.arange(pieces) + 0.5)
        found.append(corner + distance / math.cos(step / 2.0) * np.stack([np.cos(at), np.sin(at)], axis=1))
    return np.concatenate(found)


def _free(start: Floats, ends: Floats, sides: Floats, least_m: Floats) -> Flags:
    """Whether legs from a point to others (n, 2) keep distances (n,) from sides (k, 2, 2)."""
    starts = np.broadcast_to(start, ends.shape)
    # 200,000 pairs of leg and side at a time bound the memory.
    step = max(200_000 // len(sides), 1)
    free = np.ones(len(ends), bool)
    for first in range(0, len(ends), step):
        some = slice(first, first + step)
        nearest = _distances(starts[some], ends[some], sides).min(axis=1)
        free[some] = nearest >= least_m[some] * (1.0 - _TOLERANCE)
    return free


def _distances(starts: Floats, ends: Floats, sides: Floats) -> Floats:
    """Distances (n, k) between legs (n, 2) and sides (k, 2, 2); 0 where they cross."""
    a, b = starts[:, np.newaxis], ends[:, np.newaxis]
    c, d = sides[np.newaxis, :, 0], sides[np.newaxis, :, 1]
    apart = np.minimum(
        np.minimum(_segment_distance(a, c, d), _segment_distance(b, c, d)),
        np.minimum(_segment_distance(c, a, b), _segment_distance(d, a, b)),
    )
    crossed = (_side(a, b, c) * _side(a, b, d) < 0.0) & (_side(c, d, a) * _side(c, d, b) < 0.0)
    return np.where(crossed, 0.0, apart)


def _side(a: Floats, b: Floats, place: Floats) -> Floats:
    """Cross product, > 0 where points lie to the left of lines."""
    along, to = b - a, place - a
    side: Floats = along[..., 0] * to[..., 1] - along[..., 1] * to[..., 0]
    return side


def _segment_distance(place: Floats, a: Floats, b: Floats) -> Floats:
    """Distances between points and line segments."""
    along, to = b - a, place - a
    square = np.sum(along * along, axis=-1)
    share = np.clip(np.sum(to * along, axis=-1) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    return np.asarray(np.linalg.norm(to - share[..., np.newaxis] * along, axis=-1))


def _inside(places: Floats, polygons: Sequence[Sequence[Floats]]) -> Flags:
    """Whether points (n, 2) lie inside any polygon and outside its holes, (n,)."""
    inside = np.zeros(len(places), bool)
    for polygon in polygons:
        odd = np.zeros(len(places), bool)
        for ring in polygon:
            corners = np.asarray(ring, np.float64).reshape(-1, 2)
            for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0)):
                crossed = (y0 <= places[:, 1]) != (y1 <= places[:, 1])
                if crossed.any():
                    x = x0 + (places[:, 1] - y0) * ((x1 - x0) / (y1 - y0 or 1.0))
                    odd ^= crossed & (x < places[:, 0])
        inside |= odd
    return inside
