"""Polygons with holes cut into triangles, by ear clipping.

Every ear turns left, so winding numbers add up: the triangles cover the inside of the rings exactly once and nothing
else. All vertices are kept, those on straight edges too: what shares the boundary fits without cracks.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import Flags, Floats, Numbers

#: Reflex vertices from which numpy is faster than a loop.
_MANY = 48
#: Twice the area, as share of the polygon's squared extent, below which rounding explains an ear.
_FLAT = 1e-14

Point = tuple[float, float]


def signed_area(ring: Floats) -> float:
    """Area of a ring (n, 2), open or closed; positive if counter-clockwise."""
    x, y = (ring - ring[0]).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def open_ring(ring: Floats) -> Floats:
    """Ring (n, 2) without its closing vertex and without vertices that repeat the one before."""
    same = (ring == np.roll(ring, 1, axis=0)).all(axis=1)
    return ring[~same] if same.any() else ring


def triangulate(rings: Sequence[Floats]) -> Numbers:
    """Triangles (t, 3) of a polygon, counter-clockwise, as indices into its rings' vertices one after the other.

    Parameters
    ----------
    rings : sequence of arrays (n, 2)
        Open rings: the outer one counter-clockwise, then holes, clockwise. Rings may touch, but not cross.

    Returns
    -------
    array (t, 3)
        Vertices at one place have the index of the first of them, and edges that a vertex of another ring touches
        are split there. Empty if rings cross or have no area, so that no triangles turning left make them up.
    """
    outer = rings[0]
    if len(outer) < 3:
        return np.empty((0, 3), np.int64)
    shifted = np.concatenate(rings) - outer[0]
    points: list[Point] = [(x, y) for x, y in shifted.tolist()]
    known: dict[Point, int] = {}
    same = [known.setdefault(point, i) for i, point in enumerate(points)]
    chain = same[: len(outer)]
    first, holes = len(outer), []
    for ring in rings[1:]:
        if len(ring) >= 3:
            holes.append(same[first : first + len(ring)])
        first += len(ring)
    if holes:
        chain, *holes = (_with_touching(shifted, points, one) for one in (chain, *holes))
    # From the right: the bridge of each hole meets only the outer ring and holes joined before.
    for hole in sorted(holes, key=lambda one: -max(points[i] for i in one)[0]):
        chain = _joined(points, chain, hole)
    extent = float(np.ptp(shifted[: len(outer)], axis=0).max())
    return _clip_ears(points, chain, _FLAT * extent * extent)


def _cross(a: Point, b: Point, c: Point) -> float:
    """Twice the area of a triangle; positive if it turns left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _with_touching(shifted: Floats, points: list[Point], ring: list[int]) -> list[int]:
    """Ring with the vertices of others that lie on its edges, within a billionth of the polygon's extent."""
    found, near = [], 1e-9 * float(np.ptp(shifted, axis=0).max())
    for i, j in zip(ring, [*ring[1:], ring[0]]):
        found.append(i)
        edge = shifted[j] - shifted[i]
        length = float(np.hypot(*edge))
        offset = shifted - shifted[i]
        along = offset @ edge / length
        across = np.abs(offset[:, 0] * edge[1] - offset[:, 1] * edge[0]) / length
        on = np.flatnonzero((across <= near) & (along > near) & (along < length - near))
        if len(on):
            new = {points[k]: int(k) for k in on[np.argsort(along[on], kind="stable")][::-1]}
            found.extend(k for k in reversed(list(new.values())) if k not in ring)
    return found


def _joined(points: list[Point], chain: list[int], hole: list[int]) -> list[int]:
    """Chain of vertices with a hole, joined at a vertex of both or by the shortest free bridge."""
    for at, k in ((hole.index(one), k) for k, one in enumerate(chain) if one in hole):
        turned = hole[at:] + hole[:at]
        if _sees_inside(points, chain, k, points[turned[1]]):
            return [*chain[: k + 1], *turned[1:], *chain[k:]]
    at = max(range(len(hole)), key=lambda k: points[hole[k]])
    turned = hole[at:] + hole[:at]
    start = points[turned[0]]
    around = np.array([points[i] for i in chain])
    inner = np.array([points[i] for i in turned])
    edges = [(around, np.roll(around, -1, axis=0)), (inner, np.roll(inner, -1, axis=0))]
    order = np.argsort(((around - start) ** 2).sum(axis=1), kind="stable")
    best = int(order[0])
    for k in order.tolist():
        if _sees_inside(points, chain, k, start) and not any(_crosses(start, points[chain[k]], *e) for e in edges):
            best = k
            break
    return [*chain[: best + 1], *turned, turned[0], *chain[best:]]


def _sees_inside(points: list[Point], chain: list[int], k: int, target: Point) -> bool:
    """Whether a point lies within the inner angle at vertex ``k``."""
    a, b, c = points[chain[k - 1]], points[chain[k]], points[chain[(k + 1) % len(chain)]]
    left_of_in, left_of_out = _cross(a, b, target) > 0, _cross(b, c, target) > 0
    return (left_of_in and left_of_out) if _cross(a, b, c) > 0 else (left_of_in or left_of_out)


def _crosses(p: Point, q: Point, starts: Floats, ends: Floats) -> bool:
    """Whether a segment meets any edge (n, 2) other than at the segment's own end points."""
    d = np.subtract(q, p)
    away_start = d[0] * (starts[:, 1] - p[1]) - d[1] * (starts[:, 0] - p[0])
    away_end = d[0] * (ends[:, 1] - p[1]) - d[1] * (ends[:, 0] - p[0])
    e = ends - starts
    side_p = e[:, 0] * (p[1] - starts[:, 1]) - e[:, 1] * (p[0] - starts[:, 0])
    side_q = e[:, 0] * (q[1] - starts[:, 1]) - e[:, 1] * (q[0] - starts[:, 0])
    meets = (away_start * away_end <= 0) & (side_p * side_q <= 0) & ((away_start != 0) | (away_end != 0))
    for end in (p, q):
        meets &= ~((starts == end).all(axis=1) | (ends == end).all(axis=1))
    return bool(meets.any())


def _clip_ears(points: list[Point], chain: list[int], flat: float) -> Numbers:
    """Triangles (t, 3) of a chain of vertices; empty if ears run out."""
    count = len(chain)
    before, after = [count - 1, *range(count - 1)], [*range(1, count), 0]
    at = [points[i] for i in chain]
    reflex = {k for k in range(count) if _cross(at[before[k]], at[k], at[after[k]]) <= 0}
    many = np.array(at) if len(reflex) >= _MANY else None
    alive = np.zeros(count, np.bool_)
    alive[list(reflex)] = True
    found, k, left, tried = [], 0, count, 0
    while left > 3 and tried <= left:
        i, j = before[k], after[k]
        if k in reflex or _cross(at[i], at[k], at[j]) <= flat or _blocked(at, i, k, j, reflex, many, alive):
            k, tried = j, tried + 1
            continue
        found.append((chain[i], chain[k], chain[j]))
        after[i], before[j] = j, i
        for one in (i, j):
            if one in reflex and _cross(at[before[one]], at[one], at[after[one]]) > 0:
                reflex.discard(one)
                alive[one] = False
        # Ears of every other vertex: fans of slivers are rare that way.
        k, left, tried = after[j], left - 1, 0
        if left == 3:
            k = i
    i, j = before[k], after[k]
    if left > 3 or _cross(at[i], at[k], at[j]) <= 0:
        return np.empty((0, 3), np.int64)
    return np.array([*found, (chain[i], chain[k], chain[j])], np.int64)


def _blocked(at: list[Point], i: int, k: int, j: int, reflex: set[int], many: Floats | None, alive: Flags) -> bool:
    """Whether a vertex lies in or on the triangle at vertex ``k``, other than at its corners."""
    a, b, c = at[i], at[k], at[j]
    if many is not None and len(reflex) >= _MANY:
        p = many[alive]
        inside = np.ones(len(p), np.bool_)
        for s, e in ((a, b), (b, c), (c, a)):
            inside &= (e[0] - s[0]) * (p[:, 1] - s[1]) - (e[1] - s[1]) * (p[:, 0] - s[0]) >= 0
        for corner in (a, b, c):
            inside &= (p[:, 0] != corner[0]) | (p[:, 1] != corner[1])
        return bool(inside.any())
    for one in reflex:
        q = at[one]
        if _cross(a, b, q) >= 0 and _cross(b, c, q) >= 0 and _cross(c, a, q) >= 0 and q != a and q != b and q != c:
            return True
    return False
