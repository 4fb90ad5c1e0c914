"""Closed solids with roofs over footprints, in a local plane of metres east and north, heights up."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Floats, NDArray, Numbers
from ..geodesy.triangles import FLOOR, ROOF, WALL
from .triangulation import triangulate

FLAT, SKILLION, GABLED, HIPPED, PYRAMIDAL, DOME = "flat", "skillion", "gabled", "hipped", "pyramidal", "dome"
SHAPES = (FLAT, SKILLION, GABLED, HIPPED, PYRAMIDAL, DOME)
#: Other shapes of OpenStreetMap, and the nearest of the six.
NEAREST = {
    "lean_to": SKILLION, "lean-to": SKILLION, "pitched": GABLED, "saltbox": GABLED, "gambrel": GABLED, "round": GABLED,
    "double_saltbox": GABLED, "gabled_height_moved": GABLED, "half-hipped": HIPPED, "half_hipped": HIPPED,
    "side_hipped": HIPPED, "side_half-hipped": HIPPED, "mansard": HIPPED, "hipped-and-gabled": HIPPED,
    "cone": PYRAMIDAL, "conical": PYRAMIDAL, "tented": PYRAMIDAL, "spherical": DOME, "onion": DOME,
}  # fmt: skip
#: Angle of pitched roofs without height and angle, degrees.
PITCH_DEG = 30.0
#: Rings of triangles from the edge of a dome to its top.
_DOME_RINGS = 6
#: Distance, metres, from a crease within which vertices lie on it.
_ON_CREASE_M = 1e-6


class Solid(NamedTuple):
    """Closed surface of triangles, counter-clockwise seen from outside.

    Attributes
    ----------
    points_m : array (n, 3)
        East, north, up.
    triangles : array (t, 3)
        Indices of points.
    kind : array (t,) of uint8
        `ROOF`, `WALL` or `FLOOR`.
    """

    points_m: Floats
    triangles: Numbers
    kind: NDArray[np.uint8]

    @property
    def volume_m3(self) -> float:
        """Enclosed volume."""
        a, b, c = (self.points_m[self.triangles[:, k]] - self.points_m[0] for k in range(3))
        return float((a * np.cross(b, c)).sum() / 6.0)


@dataclass(frozen=True)
class Roof:
    """Shape of a roof.

    Parameters
    ----------
    shape : str
        One of `SHAPES`.
    height_m : float
        Rise from its edge to its top.
    direction_deg : float
        Compass direction that the roof's main face looks to; NaN: across the footprint's longer side.
    across : bool
        Whether the ridge runs across the longer side.
    """

    shape: str = FLAT
    height_m: float = 0.0
    direction_deg: float = math.nan
    across: bool = False


class _Rectangle(NamedTuple):
    """Frame of a rectangle: its centre, axes along the ridge and across, and half its sides."""

    centre: Floats
    along: Floats
    across: Floats
    half_along: float
    half_across: float


def smallest_rectangle(ring: Floats) -> tuple[Floats, Floats, float, float]:
    """Smallest rectangle around a ring (n, 2): centre, unit vector along the longer side, and half of both sides."""
    edges = np.roll(ring, -1, axis=0) - ring
    edges = edges[(edges != 0).any(axis=1)]
    axes = edges / np.hypot(*edges.T)[:, None]
    along = ring @ axes.T
    across = ring @ np.stack([-axes[:, 1], axes[:, 0]])
    spans = np.ptp(along, axis=0), np.ptp(across, axis=0)
    # Not only edges of the hull: the smallest rectangle lies on one of those, and others are larger.
    best = int(np.argmin(spans[0] * spans[1]))
    axis, normal = axes[best], np.array([-axes[best, 1], axes[best, 0]])
    middle = 0.5 * (along[:, best].min() + along[:, best].max()), 0.5 * (across[:, best].min() + across[:, best].max())
    centre = middle[0] * axis + middle[1] * normal
    half, other = 0.5 * float(spans[0][best]), 0.5 * float(spans[1][best])
    return (centre, axis, half, other) if half >= other else (centre, normal, other, half)


def pitched_height_m(ring: Floats, shape: str, across: bool = False, angle_deg: float = PITCH_DEG) -> float:
    """Rise of a roof of some angle over a footprint (n, 2); half the width for domes, 0 for flat roofs."""
    if shape == FLAT:
        return 0.0
    _, _, longer, shorter = smallest_rectangle(ring)
    if shape == DOME:
        return shorter
    run = longer if across and shape == GABLED else shorter
    return math.tan(math.radians(angle_deg)) * (2.0 * run if shape == SKILLION else run)


def build(rings: Sequence[Floats], bottom_m: float, top_m: float, roof: Roof) -> tuple[Solid | None, bool]:
    """Solid of a footprint, and whether its roof has the shape asked for: it is flat where that cannot be.

    Parameters
    ----------
    rings : sequence of arrays (n, 2)
        Open rings as of `triangulate`.
    bottom_m, top_m : float
        Heights of the underside and of the roof's top.
    roof : Roof
        Rises at most from the bottom to the top.

    Returns
    -------
    Solid or None, bool
        None for rings that cross or have no area.
    """
    rise = min(roof.height_m, top_m - bottom_m)
    shape = roof.shape if rise > 0.0 else FLAT
    if shape in (PYRAMIDAL, DOME):
        fan = _fan(rings, shape)
        if fan is not None:
            return _closed(fan[0], fan[1], fan[2] * rise + (top_m - rise), bottom_m), True
        shape = FLAT
    triangles = triangulate(rings)
    if not len(triangles):
        return None, False
    points = np.concatenate(rings)
    if shape == FLAT:
        return _closed(points, triangles, np.full(len(points), top_m), bottom_m), roof.shape == FLAT or rise <= 0.0
    points, triangles, share = _pitched(rings[0], points, triangles, roof, shape)
    return _closed(points, triangles, share * rise + (top_m - rise), bottom_m), True


def _frame(ring: Floats, roof: Roof, shape: str) -> _Rectangle:
    """Frame of a roof; ``across`` points down a skillion."""
    centre, axis, longer, shorter = smallest_rectangle(ring)
    other = np.array([-axis[1], axis[0]])
    if math.isfinite(roof.direction_deg):
        angle = math.radians(roof.direction_deg)
        down = np.array([math.sin(angle), math.cos(angle)])
        if shape == SKILLION:
            along = np.array([-down[1], down[0]])
            span = ring @ down
            middle = centre + (0.5 * (span.min() + span.max()) - centre @ down) * down
            return _Rectangle(middle, along, down, float(np.ptp(ring @ along)) / 2, float(np.ptp(span)) / 2)
        turned = abs(axis @ down) > abs(other @ down)
    else:
        turned = roof.across
    if turned and shape != HIPPED:
        return _Rectangle(centre, other, axis, shorter, longer)
    return _Rectangle(centre, axis, other, longer, shorter)


def _pitched(
    ring: Floats, points: Floats, triangles: Numbers, roof: Roof, shape: str
) -> tuple[Floats, Numbers, Floats]:
    """Points and triangles cut along the roof's creases, and the points' share of its rise, 0 at its edge."""
    frame = _frame(ring, roof, shape)
    a, b = frame.half_along, frame.half_across
    if shape == SKILLION:
        share = 0.5 - (points - frame.centre) @ frame.across / (2.0 * b)
        return points, triangles, np.clip(share, 0.0, 1.0)
    lines = [(frame.across, 0.0)]
    if shape == HIPPED:
        for u, v in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
            # Where u·x along the ridge and v·y across it are equally far from the edge: u·x - v·y = a - b.
            lines.append((u * frame.along - v * frame.across, a - b))
    for normal, offset in lines:
        points, triangles = _cut(points, triangles, (points - frame.centre) @ normal - offset)
    x, y = np.abs((points - frame.centre) @ frame.along), np.abs((points - frame.centre) @ frame.across)
    rise = 1.0 - y / b
    if shape == HIPPED:
        rise = np.minimum(rise, (a - x) / b)
    return points, triangles, np.clip(rise, 0.0, 1.0)


def _cut(points: Floats, triangles: Numbers, away: Floats) -> tuple[Floats, Numbers]:
    """Points and triangles cut along the line where ``away`` (n,) is 0; neighbours share the points on their edge."""
    sign = np.where(np.abs(away) <= _ON_CREASE_M, 0, np.sign(away)).astype(np.int64)
    corners = sign[triangles]
    mixed = (corners.min(axis=1) < 0) & (corners.max(axis=1) > 0)
    if not mixed.any():
        return points, triangles
    new: list[Floats] = []
    known: dict[tuple[int, int], int] = {}

    def crossing(i: int, j: int) -> int:
        key = (i, j) if i < j else (j, i)
        if key not in known:
            i, j = key
            share = away[i] / (away[i] - away[j])
            new.append(points[i] + share * (points[j] - points[i]))
            known[key] = len(points) + len(new) - 1
        return known[key]

    found: list[list[int]] = []
    for triangle in triangles[mixed].tolist():
        sides: tuple[list[int], list[int]] = ([], [])
        for i, j in zip(triangle, triangle[1:] + triangle[:1]):
            for side, part in zip((1, -1), sides):
                if sign[i] * side >= 0:
                    part.append(i)
            if sign[i] * sign[j] < 0:
                middle = crossing(i, j)
                for part in sides:
                    part.append(middle)
        for part in sides:
            found.extend([part[0], part[k], part[k + 1]] for k in range(1, len(part) - 1))
    return np.concatenate([points, new]), np.concatenate([triangles[~mixed], np.array(found, np.int64)])


def _fan(rings: Sequence[Floats], shape: str) -> tuple[Floats, Numbers, Floats] | None:
    """Points, triangles and shares of the rise of a roof around the centroid; None if it does not see all edges."""
    ring = rings[0]
    if len(rings) > 1 or len(ring) < 3:
        return None
    shifted = ring - ring[0]
    after = np.roll(shifted, -1, axis=0)
    cross = shifted[:, 0] * after[:, 1] - shifted[:, 1] * after[:, 0]
    if cross.sum() <= 0.0:
        return None
    centre = ((shifted + after) * cross[:, None]).sum(axis=0) / (3.0 * cross.sum()) + ring[0]
    out = ring - centre
    after = np.roll(out, -1, axis=0)
    if (out[:, 0] * after[:, 1] - out[:, 1] * after[:, 0]).min() <= 0.0:
        return None
    steps = np.linspace(0.0, math.pi / 2, _DOME_RINGS + 1)[:-1] if shape == DOME else np.zeros(1)
    count = len(ring)
    # The first ring is the footprint itself, to the last bit.
    points = np.concatenate([ring, *(centre + math.cos(step) * out for step in steps[1:]), centre[None]])
    share = np.append(np.repeat(np.sin(steps), count), 1.0)
    i, j = np.arange(count), (np.arange(count) + 1) % count
    triangles = [np.stack([i, j, np.full(count, len(points) - 1)], axis=-1)]
    triangles[0][:, :2] += (len(steps) - 1) * count
    for k in range(len(steps) - 1):
        low, high = k * count, (k + 1) * count
        triangles += [np.stack([i + low, j + low, j + high], -1), np.stack([i + low, j + high, i + high], -1)]
    return points, np.concatenate(triangles), share


def _closed(points: Floats, roof: Numbers, up_m: Floats, bottom_m: float) -> Solid:
    """Solid below a roof: its triangles, the same at the bottom, and walls along its edge."""
    count = len(points)
    start, end = roof.ravel(), np.roll(roof, -1, axis=1).ravel()
    forth, back = start * count + end, end * count + start
    edge = ~np.isin(forth, back)
    i, j = start[edge], end[edge]
    walls = [np.stack([i + count, j + count, j], -1), np.stack([i + count, j, i], -1)]
    triangles = np.concatenate([roof, roof[:, ::-1] + count, *walls])
    kind = np.repeat(np.array([ROOF, FLOOR, WALL], np.uint8), [len(roof), len(roof), 2 * len(i)])
    high = np.column_stack([points, up_m])
    low = np.column_stack([points, np.full(count, bottom_m)])
    return Solid(np.concatenate([high, low]), triangles, kind)
