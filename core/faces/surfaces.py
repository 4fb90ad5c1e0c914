"""Polygons in space cut into triangles, and closed shells of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Floats, Numbers
from .triangulation import signed_area, triangulate

#: Distance from a polygon's plane beyond which its vertices count as off it; val3dity's tolerance, too.
FLAT_M = 0.01
#: Area of the smallest surface that counts.
LEAST_AREA_M2 = 1e-6


class Cut(NamedTuple):
    """Triangles of a polygon.

    Attributes
    ----------
    triangles : array (t, 3)
        Indices of points, counter-clockwise as the polygon; empty if it has no area.
    off_plane, crosses, cleaned : bool
        Whether vertices lie off the plane; whether rings cross, so that triangles fan out from the first vertex;
        whether vertices or holes were left out, as they repeat others or have no area.
    """

    triangles: Numbers
    off_plane: bool = False
    crosses: bool = False
    cleaned: bool = False


_NOTHING = Cut(np.empty((0, 3), np.int64))


def cut(rings: Sequence[Sequence[int]], points_m: Floats) -> Cut:
    """Cut a polygon into triangles.

    Parameters
    ----------
    rings : sequence of sequences of int
        Indices of points: the outer ring, then holes; open or closed.
    points_m : array (m, 3)
    """
    outer = _distinct(rings[0])
    if len(outer) < 3:
        return _NOTHING
    corner = points_m[outer[0]]
    normal = _newell(points_m[outer] - corner)
    area = 0.5 * float(np.linalg.norm(normal))
    if area < LEAST_AREA_M2:
        # Loops of a ring that crosses itself may cancel each other.
        fan = _fan(outer)
        around = points_m[fan] - corner
        loops = np.linalg.norm(np.cross(around[:, 1], around[:, 2]), axis=1).sum()
        return Cut(fan, crosses=True) if 0.5 * loops > LEAST_AREA_M2 and len(fan) > 1 else _NOTHING
    unit = normal / (2.0 * area)
    repeats_first = len(rings[0]) > 1 and rings[0][0] == rings[0][-1]
    cleaned = len(outer) != len(rings[0]) - repeats_first
    if len(outer) == 3 and len(rings) == 1:
        return Cut(np.array([outer], np.int64), cleaned=cleaned)
    kept = [outer]
    for hole in map(_distinct, rings[1:]):
        inner = _newell(points_m[hole] - corner) if len(hole) > 2 else np.zeros(3)
        if 0.5 * float(np.linalg.norm(inner)) < LEAST_AREA_M2:
            cleaned = True
        else:
            kept.append(hole if inner @ unit < 0.0 else hole[::-1])
    index = np.concatenate([np.array(ring, np.int64) for ring in kept])
    offset = points_m[index] - corner
    off_plane = bool(np.abs(offset @ unit).max() > FLAT_M)
    triangles = _flat_triangles(kept, offset, unit)
    if len(triangles):
        return Cut(index[triangles], off_plane, cleaned=cleaned)
    return Cut(_fan(outer), off_plane, True, cleaned)


def is_closed(triangles: Numbers) -> bool:
    """Whether each edge of triangles (t, 3) is met by another in the opposite direction."""
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    most = int(triangles.max()) + 1 if len(triangles) else 1
    return bool((np.sort(start * most + end) == np.sort(end * most + start)).all())


def volume_m3(triangles: Numbers, points_m: Floats) -> float:
    """Volume that closed triangles (t, 3) enclose, by the divergence theorem; negative if they face inward."""
    a, b, c = np.moveaxis(points_m[triangles] - points_m[triangles[0, 0]], 1, 0)
    return float((a * np.cross(b, c)).sum()) / 6.0


def rim(triangles: Numbers) -> Numbers:
    """Edges (e, 2) of triangles (t, 3) that no other meets in the opposite direction."""
    edges = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    most = int(triangles.max()) + 1 if len(triangles) else 1
    lonely: Numbers = edges[~np.isin(edges @ [most, 1], edges @ [1, most])]
    return lonely


def _distinct(ring: Sequence[int]) -> list[int]:
    """Ring without vertices that repeat the one before, without its closing vertex, and without spikes."""
    found: list[int] = []
    for one in ring:
        if len(found) > 1 and found[-2] == one:
            found.pop()
        elif not found or found[-1] != one:
            found.append(one)
    while len(found) > 1 and (found[0] == found[-1] or found[1] == found[-1]):
        # The end meets the start, or the start is the tip of a spike.
        found = found[:-1] if found[0] == found[-1] else found[1:]
    return found


def _fan(ring: list[int]) -> Numbers:
    return np.array([(ring[0], a, b) for a, b in zip(ring[1:], ring[2:])], np.int64)


def _newell(ring_m: Floats) -> Floats:
    """Normal of a ring (n, 3), twice as long as its area, by Newell's method."""
    # Rings are short: a loop is several times as fast as numpy's cross product.
    x = y = z = 0.0
    points = ring_m.tolist()
    ax, ay, az = points[-1]
    for bx, by, bz in points:
        x += ay * bz - az * by
        y += az * bx - ax * bz
        z += ax * by - ay * bx
        ax, ay, az = bx, by, bz
    return np.array([x, y, z])


def _flat_triangles(rings: list[list[int]], offset_m: Floats, unit: Floats) -> Numbers:
    """Triangles as indices into the rings' vertices; empty if rings cross.

    They are cut along the axis nearest to the normal, which keeps straight edges straight to the last bit; bent rings
    that cross there may not cross in their own plane.
    """
    axis = int(np.abs(unit).argmax())
    first, second = (axis + 1) % 3, (axis + 2) % 3
    found = _cut_flat(rings, offset_m[:, [first, second] if unit[axis] > 0.0 else [second, first]])
    if not len(found):
        east = np.cross(unit, np.eye(3)[int(np.abs(unit).argmin())])
        found = _cut_flat(rings, offset_m @ np.stack([east, np.cross(unit, east)], axis=1))
    return found


def _cut_flat(rings: list[list[int]], flat: Floats) -> Numbers:
    """Triangles of rings whose vertices lie one after the other in a plane; empty if rings cross or turn wrongly."""
    if len(rings) == 1:
        return triangulate([flat])
    parts = np.split(flat, np.cumsum([len(ring) for ring in rings])[:-1])
    turned = [signed_area(part) for part in parts]
    good = turned[0] > 0.0 and all(area < 0.0 for area in turned[1:])
    return triangulate(parts) if good else np.empty((0, 3), np.int64)
