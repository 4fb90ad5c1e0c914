"""Shortest ways around polygons of a plane, at a distance from them: A* on the visibility graph of their corners."""

from __future__ import annotations

import heapq
import math
from collections.abc import Sequence

import numpy as np

from ..arrays import Flags, Floats
from ..errors import InvalidInput, Message
from .ellipsoid import arctan2

#: Ways keep at least so far off, metres: one that touched a polygon could not be told from one that cuts its corner.
_LEAST_M = 1e-3
#: What a way may be nearer than asked for, as a share: the noise of distances, of which corners keep exactly as many.
_NOISE = 1e-6
#: Turn of a way around a corner, at most, from one of its places to the next, degrees: it leaves the arc about the
#: corner by under 2 % of the distance.
_TURN_DEG = 22.5
#: Pairs of a leg and a side looked at in one go, to bound memory.
_CHUNK = 200_000


def way_around(
    start_m: Floats, end_m: Floats, polygons: Sequence[Sequence[Floats]], clearance_m: float = 0.0
) -> Floats:
    """Shortest way from one place of a plane to another that keeps a distance from polygons.

    Around a corner the way goes along the sides of a regular polygon about the arc that is meant: it is longer than the
    shortest one by under 2 % of the distance, a corner. A place that is nearer to a polygon than asked for keeps
    what distance it has until the first corner on the way, or from the last.

    Parameters
    ----------
    start_m, end_m : array (2,)
        Places in the plane, metres.
    polygons : sequence of polygons
        Each a sequence of rings, arrays (k, 2), the outer one first, not closed; inside its holes a way may lead.
    clearance_m : float
        Distance to be kept.

    Returns
    -------
    array (m, 2)
        Places of the way, start and end among them; two where the straight way is free.

    Raises
    ------
    InvalidInput
        A place lies inside a polygon, or no way leads from one to the other.
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
    clearance = max(clearance_m, _LEAST_M)
    kept = np.minimum(_distances(straight, straight, sides).min(axis=1), clearance)
    if _free(start, end[np.newaxis], sides, np.array([kept.min()]))[0]:
        return straight
    corners = np.concatenate([_about(ring, clearance) for ring in _turned(polygons)])
    off = _distances(corners, corners, sides).min(axis=1) >= clearance * (1.0 - _NOISE)
    corners = corners[off & ~_inside(corners, polygons)]
    places = np.concatenate([straight, corners])
    least = np.concatenate([kept, np.full(len(corners), clearance)])
    return _shortest(places, least, sides)


def _shortest(places: Floats, least: Floats, sides: Floats) -> Floats:
    """Shortest way from the first place to the second over others, each leg as far off as both its ends may be (n,)."""
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
        # Only legs that would make a way shorter are looked at.
        better = np.flatnonzero(~settled & (through < length))
        free = _free(places[here], places[better], sides, np.minimum(least[better], least[here]))
        for next_ in better[free].tolist():
            length[next_], before[next_] = through[next_], here
            heapq.heappush(waiting, (float(through[next_] + to_end[next_]), next_))
    raise InvalidInput(
        "no way leads around the no-fly areas", remedy="leave room between them, or keep less distance"
    )


def _turned(polygons: Sequence[Sequence[Floats]]) -> list[Floats]:
    """Rings with what is forbidden to the left of their sides."""
    found = []
    for polygon in polygons:
        for number, ring in enumerate(polygon):
            corners = np.asarray(ring, np.float64).reshape(-1, 2)
            x, y = corners.T
            twice = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
            found.append(corners if (twice > 0.0) == (number == 0) else corners[::-1])
    return found


def _about(ring: Floats, distance: float) -> Floats:
    """Places around a ring's corners that turn away from what is forbidden: of polygons about their arcs, (m, 2)."""
    come, go = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    turn = np.arctan2(come[:, 0] * go[:, 1] - come[:, 1] * go[:, 0], np.sum(come * go, axis=1))
    # To the right of the side that comes.
    first = arctan2(-come[:, 0], come[:, 1])
    found = [np.empty((0, 2))]
    for corner, begin, angle in zip(ring, first.tolist(), turn.tolist()):
        if angle <= 0.0:
            continue
        pieces = max(math.ceil(angle / math.radians(_TURN_DEG)), 1)
        step = angle / pieces
        at = begin + step * (np.arange(pieces) + 0.5)
        found.append(corner + distance / math.cos(step / 2.0) * np.stack([np.cos(at), np.sin(at)], axis=1))
    return np.concatenate(found)


def _free(start: Floats, ends: Floats, sides: Floats, least_m: Floats) -> Flags:
    """Whether legs from one place to others (n, 2) keep distances (n,) from sides (k, 2, 2)."""
    starts = np.broadcast_to(start, ends.shape)
    step = max(_CHUNK // len(sides), 1)
    free = np.ones(len(ends), bool)
    for first in range(0, len(ends), step):
        some = slice(first, first + step)
        nearest = _distances(starts[some], ends[some], sides).min(axis=1)
        free[some] = nearest >= least_m[some] * (1.0 - _NOISE)
    return free


def _distances(starts: Floats, ends: Floats, sides: Floats) -> Floats:
    """Distances (n, k) of legs (n, 2) from sides (k, 2, 2); 0 where they cross."""
    a, b = starts[:, np.newaxis], ends[:, np.newaxis]
    c, d = sides[np.newaxis, :, 0], sides[np.newaxis, :, 1]
    apart = np.minimum(
        np.minimum(_from_line(a, c, d), _from_line(b, c, d)),
        np.minimum(_from_line(c, a, b), _from_line(d, a, b)),
    )
    crossed = (_side(a, b, c) * _side(a, b, d) < 0.0) & (_side(c, d, a) * _side(c, d, b) < 0.0)
    return np.where(crossed, 0.0, apart)


def _side(a: Floats, b: Floats, place: Floats) -> Floats:
    """Above 0 where places lie to the left of lines."""
    along, to = b - a, place - a
    side: Floats = along[..., 0] * to[..., 1] - along[..., 1] * to[..., 0]
    return side


def _from_line(place: Floats, a: Floats, b: Floats) -> Floats:
    """Distances of places from stretches of lines."""
    along, to = b - a, place - a
    square = np.sum(along * along, axis=-1)
    share = np.clip(np.sum(to * along, axis=-1) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    return np.asarray(np.linalg.norm(to - share[..., np.newaxis] * along, axis=-1))


def _inside(places: Floats, polygons: Sequence[Sequence[Floats]]) -> Flags:
    """Which places (n, 2) lie inside any polygon, and outside its holes."""
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
