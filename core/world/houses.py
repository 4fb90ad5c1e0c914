"""The houses of the landscape with walls and roofs, where the pictures show them from above."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..arrays import Floats, Numbers
from ..geodesy.local import enu_axes, geocentric
from ..geodesy.mercator import MAX_LAT_DEG, MERCATOR
from ..geodesy.triangles import NO_TRIANGLES, ROOF, SKIRT_M, WALL, Triangles
from .division import ROOT, ROOT_M, wall_colours, whole_division
from .heights import ground_m
from .lattice import WORLD_M, Array, LatticeWindow
from .objects import EAVES_M, GABLE_RISE
from .region import Region
from .samples import group_points
from .scene import Scene

#: Positions, in chart metres, are found to this: float32 fields have a quarter of a millimetre.
_CLOSE_M = 1e-3
_MOST_STEPS = 50
#: Zoom of the tiles, of 10 km, in which the bent plane is evaluated.
_WARP_ZOOM = 12
#: Greatest height and width of houses, and least height of walls above the ground, in the chart's metres.
_HIGHEST_M, _WIDEST_M, _LEAST_WALL_M = 10.0, 100.0, 2.0
#: Root squares whose houses are in memory; a town has some thousand in each.
_KEPT = 128
#: Corners of the walls, (4, 2), as shares of the sides, from the north-west counter-clockwise.
_CORNERS = np.array([(0, 0), (0, 1), (1, 1), (1, 0)])
#: Faces by corners: of the walls 0 to 3, at the eaves, with 6 to 9 below them, and of the ridge from 4 to 5.
_SIDES = [side for k in range(4) for side in ((k, 6 + k, 6 + (k + 1) % 4), (k, 6 + (k + 1) % 4, (k + 1) % 4))]
#: Shapes: flat, gabled from west to east, and gabled from north to south: walls with gable ends, and roofs.
_SHAPES: tuple[tuple[list[tuple[int, int, int]], list[tuple[int, int, int]]], ...] = (
    (_SIDES, [(0, 1, 2), (0, 2, 3)]),
    ([*_SIDES, (0, 1, 4), (2, 3, 5)], [(1, 2, 5), (1, 5, 4), (3, 0, 4), (3, 4, 5)]),
    ([*_SIDES, (3, 0, 4), (1, 2, 5)], [(0, 1, 5), (0, 5, 4), (2, 3, 4), (2, 4, 5)]),
)


@dataclass(frozen=True)
class WorldHouses:
    """The houses of the embedded world on the map, a `FaceModel`; charts about the poles have none.

    Parameters
    ----------
    landscape : int
        From `lattice.chart_seed`.
    """

    landscape: int

    title = "Synthetic (offline)"
    attribution = "Synthetic landscape, TerrAInav"
    warnings = ()
    #: Numbers are of 29 bits, see `_Houses`; most of them are of no house.
    count, listed = 1 << 29, 0

    def triangles(self, lat_deg: Floats, lon_deg: Floats, least_m: float = 0.0) -> Triangles:
        """Triangles of the houses that reach into the bounding box of positions; see `FaceModel`.

        Houses less high than twice ``least_m``, a pixel, are left out also where they are wider, as heights of the
        relief are without such detail; the imagery shows their roofs.
        """
        lat = np.clip(np.asarray(lat_deg, np.float64), -MAX_LAT_DEG, MAX_LAT_DEG)
        if 2.0 * least_m >= _HIGHEST_M * np.cos(np.radians(np.abs(lat).min())):
            return NO_TRIANGLES
        u, v = MERCATOR.forward(lat, np.asarray(lon_deg, np.float64))
        box = _Box(*(float(end) for end in (u.min(), v.min(), u.max(), v.max())))
        (i0, i1), (j0, j1) = bent = _bent_box(self.landscape, box)
        columns = 1 << ROOT
        squares = [
            (i, j)
            for j in range(max(int(j0 // ROOT_M), 0), min(int(j1 // ROOT_M), columns - 1) + 1)
            for i in range(int(i0 // ROOT_M), int(i1 // ROOT_M) + 1)
        ]
        parts = [
            _houses(self.landscape, i % columns, j).triangles(
                tuple((low - k * ROOT_M, high - k * ROOT_M) for (low, high), k in zip(bent, (i, j))), box, least_m
            )
            for i, j in squares
        ]
        return Triangles.joined(parts)


class _Box(NamedTuple):
    """Box of world fractions; columns are continuous."""

    west: float
    north: float
    east: float
    south: float


class _Houses:
    """Houses (n,) of a root square; where they stand is found when they are first asked for."""

    def __init__(self, landscape: int, i: int, j: int) -> None:
        self._landscape, self._corner_m = landscape, (i * ROOT_M, j * ROOT_M)
        division = whole_division(landscape, LatticeWindow(ROOT, i, j, 1, 1))
        buildings, number = division.looks.buildings, np.flatnonzero(division.looks.buildings.there)
        #: Sides (n, 2) in the bent plane, metres from the square's corner.
        self._x = np.stack([buildings.x0[number], buildings.x1[number]], axis=1)
        self._y = np.stack([buildings.y0[number], buildings.y1[number]], axis=1)
        self._is_ridge_x, is_flat = buildings.ridge_x[number], buildings.pitch[number] == 0.0
        inside = np.where(self._is_ridge_x, np.ptp(self._y, axis=1), np.ptp(self._x, axis=1)) / 2.0
        self._rise_m = np.where(is_flat, 0.0, inside * GABLE_RISE)
        # In metres on the ground, at the latitude of the square's middle.
        lat, _ = MERCATOR.inverse(np.array(0.5), np.array((j + 0.5) / (1 << ROOT)))
        self._high_m = (EAVES_M + self._rise_m) * np.cos(np.radians(lat))
        self._shape = np.where(is_flat, 0, np.where(self._is_ridge_x, 1, 2))
        roof = np.stack([channel[number] for channel in buildings.roof], axis=1)
        walls = wall_colours(division.leaves.hash[number], roof.T).T
        self._colours = np.stack([walls, roof], axis=1).astype(np.uint8)
        # Unique within 64 x 64 root squares, 300 km.
        self._instance = ((((j & 63) << 6) + (i & 63)) << 17) + number + 1
        self._is_known = np.zeros(len(number), bool)
        #: World fractions (n, 4) of the corners, and geocentric points (n, 10, 3) as in `_SHAPES`.
        self._u, self._v = np.empty((2, len(number), 4))
        self._points = np.empty((len(number), 10, 3))

    def triangles(self, bent: tuple[tuple[float, float], ...], box: _Box, least_m: float) -> Triangles:
        """Triangles of the houses in a box, which lies in ``bent``, metres of the bent plane from the corner."""
        (west, east), (north, south) = bent
        near = (self._x[:, 1] >= west) & (self._x[:, 0] <= east) & (self._y[:, 1] >= north) & (self._y[:, 0] <= south)
        at = np.flatnonzero(near & (self._high_m >= 2.0 * least_m))
        new = at[~self._is_known[at]]
        if len(new):
            self._find(new)
        turn = np.round((box.west + box.east) / 2.0 - self._u[at].mean(axis=1))[:, np.newaxis]
        u, v = self._u[at] + turn, self._v[at]
        inside = (u.max(axis=1) >= box.west) & (u.min(axis=1) <= box.east)
        inside &= (v.max(axis=1) >= box.north) & (v.min(axis=1) <= box.south)
        return self._faces(at[inside])

    def _find(self, at: Numbers) -> None:
        """Find where houses (k,) stand: corners on the map, and their heights."""
        bent = [
            side[at, :1] + _CORNERS[:, axis] * np.ptp(side[at], axis=1)[:, np.newaxis] + self._corner_m[axis]
            for axis, side in enumerate((self._x, self._y))
        ]
        u, v = _unbent(self._landscape, *bent)
        lat, lon = MERCATOR.inverse(u, v)
        ground = _ground(self._landscape, u.ravel(), v.ravel()).reshape(-1, 4)
        # Heights in the chart's metres, like widths.
        scale = np.cos(np.radians(lat[:, 0]))
        eaves = np.maximum(ground.mean(axis=1) + EAVES_M * scale, ground.max(axis=1) + _LEAST_WALL_M * scale)
        rise_m = self._rise_m[at] * scale
        foot = ground.min(axis=1) - SKIRT_M
        top, below = (geocentric(lat, lon, np.repeat(height[:, np.newaxis], 4, axis=1)) for height in (eaves, foot))
        up = enu_axes(lat[:, 0], lon[:, 0])[:, 2] * rise_m[:, np.newaxis]
        # The ridge, in the middle of two sides, from west to east or from north to south.
        first = np.where(self._is_ridge_x[at], 0, 3)
        each = np.arange(len(at))
        ridge = np.stack([(top[each, k] + top[each, (k + 1) % 4]) / 2.0 + up for k in (first, (first + 2) % 4)], axis=1)
        self._points[at] = np.concatenate([top, ridge, below], axis=1)
        self._u[at], self._v[at] = u, v
        self._is_known[at] = True

    def _faces(self, at: Numbers) -> Triangles:
        """Triangles of some houses."""
        parts = []
        for shape, (walls, roofs) in enumerate(_SHAPES):
            some = at[self._shape[at] == shape]
            corners = np.array([*walls, *roofs])
            is_roof = np.arange(len(corners)) >= len(walls)
            parts.append(
                Triangles(
                    # One gather of points: by houses and then by corners, it takes twice as long.
                    self._points.reshape(-1, 3)[(some[:, np.newaxis, np.newaxis] * 10 + corners).reshape(-1, 3)],
                    np.tile(np.where(is_roof, ROOF, WALL).astype(np.uint8), len(some)),
                    np.repeat(self._instance[some], len(corners)),
                    self._colours[some][:, is_roof.astype(np.intp)].reshape(-1, 3),
                    np.tile(is_roof, len(some)),
                )
            )
        return Triangles.joined(parts)


@lru_cache(maxsize=_KEPT)
def _houses(landscape: int, i: int, j: int) -> _Houses:
    """Houses of a root square."""
    return _Houses(landscape, i, j)


def _bent_box(landscape: int, box: _Box) -> tuple[tuple[float, float], tuple[float, float]]:
    """Ends, west and east, north and south, in metres of the bent plane, of the houses that may reach into a box."""
    u, v = (at.ravel() for at in np.meshgrid(np.linspace(box.west, box.east, 9), np.linspace(box.north, box.south, 9)))
    v = np.clip(v, 0.0, np.nextafter(1.0, 0.0))
    # Between the points, an eighth of the box apart, the plane bends by less than their distance.
    more = _WIDEST_M + max(box.east - box.west, box.south - box.north) * WORLD_M / 8.0
    found = []
    for at, moved in zip((u, v), _warp(landscape, u, v)):
        bent = at * WORLD_M + moved
        found.append((float(bent.min()) - more, float(bent.max()) + more))
    return found[0], found[1]


def _warp(landscape: int, u: Array, v: Array) -> tuple[Floats, Floats]:
    """Metres, east and south, by which the bent plane is displaced at world fractions (n,)."""
    found = np.empty((2, u.size))
    for at, samples in group_points(u - np.floor(u), v, np.full(u.size, _WARP_ZOOM)):
        region = Region.around(landscape, samples)
        for values, name in zip(found, ("warp_x", "warp_y")):
            values[at] = region.value(name, samples)
    found *= WORLD_M
    return found[0], found[1]


def _slopes(landscape: int, u: Array, v: Array) -> Floats:
    """Slopes (n, 2, 2) of the bent plane's positions, x and y, by metres east and south, at world fractions (n,)."""
    found = np.empty((u.size, 2, 2))
    for at, samples in group_points(u - np.floor(u), v, np.full(u.size, _WARP_ZOOM)):
        region = Region.around(landscape, samples)
        for axis, name in enumerate(("warp_x", "warp_y")):
            found[at, axis] = np.stack(region.slope(name, samples), axis=1) * WORLD_M
    return found + np.eye(2)


def _unbent(landscape: int, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """World fractions (n, 4) of the corners of houses, from metres in the bent plane.

    By Newton's steps, in which houses do not depend on each other: first to the middle of each, and from there to its
    corners by its slopes.
    """
    middle = np.stack([x.mean(axis=1), y.mean(axis=1)], axis=1)
    found = _stepped(landscape, middle, middle - np.stack(_warp(landscape, *_fractions(middle)), axis=1), None)
    slopes = _slopes(landscape, *_fractions(found))
    bent = np.stack([x, y], axis=2)
    ahead = np.linalg.solve(slopes, (bent - middle[:, np.newaxis]).transpose(0, 2, 1)).transpose(0, 2, 1)
    corners = _stepped(
        landscape, bent.reshape(-1, 2), (found[:, np.newaxis] + ahead).reshape(-1, 2), np.repeat(slopes, 4, axis=0)
    )
    u, v = _fractions(corners)
    return u.reshape(x.shape), v.reshape(x.shape)


def _ground(landscape: int, u: Floats, v: Floats) -> Floats:
    """Heights of the ground at world fractions (n,)."""
    heights = np.empty(u.size)
    for at, samples in group_points(u - np.floor(u), v, np.full(u.size, _WARP_ZOOM)):
        heights[at] = ground_m(Scene(landscape, samples))
    return heights


def _stepped(landscape: int, bent: Floats, start: Floats, slopes: Floats | None) -> Floats:
    """Positions (n, 2) on the map, in metres, of positions in the bent plane; slopes are found if there are none."""
    found, rest = start.copy(), np.arange(len(start))
    for _ in range(_MOST_STEPS):
        at = _fractions(found[rest])
        off = bent[rest] - found[rest] - np.stack(_warp(landscape, *at), axis=1)
        by = _slopes(landscape, *at) if slopes is None else slopes[rest]
        step = np.linalg.solve(by, off[..., np.newaxis])[..., 0]
        found[rest] += step
        rest = rest[np.abs(step).max(axis=1) >= _CLOSE_M]
        if not len(rest):
            break
    return found


def _fractions(metres: Floats) -> tuple[Floats, Floats]:
    """World fractions of positions (n, 2) on the map in metres."""
    u, v = metres.T / WORLD_M
    return u, np.clip(v, 0.0, np.nextafter(1.0, 0.0))
