"""The houses of the landscape with walls and roofs, where the pictures show them from above."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..arrays import Floats, Numbers
from ..geodesy.local import geocentric
from ..geodesy.mercator import MERCATOR
from ..geodesy.triangles import NO_TRIANGLES, ROOF, SKIRT_M, WALL, Triangles
from .division import ROOT, ROOT_M, wall_colours, whole_division
from .heights import ground_m
from .lattice import WORLD_M, Array, LatticeWindow, chart_pole
from .objects import EAVES_M, GABLE_RISE
from .region import BLOCK_ZOOM
from .samples import group_points
from .scene import Scene

#: Positions, in chart metres, are found to this: float32 fields have a quarter of a millimetre.
_CLOSE_M = 1e-3
#: Houses of root squares in memory; a town has some thousand in each.
_KEPT = 64
#: Corners of the walls, (4, 2), and the quadrilaterals between them, from the north-west counter-clockwise.
_CORNERS = np.array([(0, 0), (0, 1), (1, 1), (1, 0)])


@dataclass(frozen=True)
class WorldHouses:
    """The houses of the embedded world, a `FaceModel`.

    Parameters
    ----------
    landscape : int
        From `lattice.chart_seed`.
    """

    landscape: int

    title = "Synthetic (offline)"
    attribution = "Synthetic landscape, TerrAInav"
    #: Numbers are of 29 bits, see `_houses`.
    count = 1 << 29
    warnings = ()

    def triangles(self, lat_deg: Floats, lon_deg: Floats, least_m: float = 0.0) -> Triangles:
        """Triangles of the houses that reach into the bounding box of positions; see `FaceModel`."""
        # Halls are at most 90 m long.
        if chart_pole(self.landscape) or least_m > 90.0:
            return NO_TRIANGLES
        u, v = MERCATOR.forward(np.asarray(lat_deg, np.float64), np.asarray(lon_deg, np.float64))
        west, east, north, south = (float(end) for end in (u.min(), u.max(), v.min(), v.max()))
        parts = []
        for i, j in _root_squares(self.landscape, west, east, north, south):
            houses = _houses(self.landscape, i, j)
            turn = np.round((west + east) / 2.0 - houses.u.mean(axis=1)) if len(houses.u) else np.zeros(0)
            at_u = houses.u + turn[:, np.newaxis]
            near = (at_u.max(axis=1) >= west) & (at_u.min(axis=1) <= east)
            near &= (houses.v.max(axis=1) >= north) & (houses.v.min(axis=1) <= south)
            parts.append(houses.faces.take(near[houses.of_face]))
        return Triangles.joined(parts)


@dataclass(frozen=True)
class _Houses:
    """Houses (n,) of a root square: world fractions (n, 4) of their corners, faces, and the house of each face."""

    u: Floats
    v: Floats
    faces: Triangles
    of_face: Numbers


def _root_squares(landscape: int, west: float, east: float, north: float, south: float) -> list[tuple[int, int]]:
    """Columns and rows of the root squares that hold what stands in a box of world fractions."""
    u, v = (at.ravel() for at in np.meshgrid(np.linspace(west, east, 9), np.linspace(north, south, 9)))
    v = np.clip(v, 0.0, np.nextafter(1.0, 0.0))
    x, y = u * WORLD_M, v * WORLD_M
    east_m, south_m = _warp(landscape, u - np.floor(u), v)
    bent = x + east_m, y + south_m
    # Between the points, the plane bends by less than a quarter of the box; houses reach 100 m beyond their corner.
    ends = []
    for at in bent:
        more = 100.0 + 0.25 * float(np.ptp(at))
        ends.append((int(np.floor((at.min() - more) / ROOT_M)), int(np.floor((at.max() + more) / ROOT_M))))
    (i0, i1), (j0, j1) = ends
    columns = 1 << ROOT
    return [(i % columns, j) for j in range(max(j0, 0), min(j1, columns - 1) + 1) for i in range(i0, i1 + 1)]


def _warp(landscape: int, u: Array, v: Array) -> tuple[Array, Array]:
    """Metres by which the bent plane is displaced at world fractions (n,)."""
    x, y = np.empty(u.size), np.empty(u.size)
    for at, samples in group_points(u, v, np.full(u.size, BLOCK_ZOOM)):
        region = Scene(landscape, samples).region
        x[at], y[at] = region.value("warp_x", samples), region.value("warp_y", samples)
    return x * WORLD_M, y * WORLD_M


def _unbent(landscape: int, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """World fractions of positions (n,) in the bent plane, metres from its north-west corner."""
    found_x, found_y = x.copy(), y.copy()
    for _ in range(100):
        u, v = found_x / WORLD_M, np.clip(found_y / WORLD_M, 0.0, np.nextafter(1.0, 0.0))
        east_m, south_m = _warp(landscape, u - np.floor(u), v)
        off_x, off_y = x - east_m - found_x, y - south_m - found_y
        found_x, found_y = found_x + off_x, found_y + off_y
        if max(float(np.abs(off).max(initial=0.0)) for off in (off_x, off_y)) < _CLOSE_M:
            break
    return found_x / WORLD_M, found_y / WORLD_M


@lru_cache(maxsize=_KEPT)
def _houses(landscape: int, i: int, j: int) -> _Houses:
    """Houses of a root square."""
    division = whole_division(landscape, LatticeWindow(ROOT, i, j, 1, 1))
    buildings, number = division.looks.buildings, np.flatnonzero(division.looks.buildings.there)
    x = np.stack([edge[number] for edge in (buildings.x0, buildings.x1)], axis=1) + i * ROOT_M
    y = np.stack([edge[number] for edge in (buildings.y0, buildings.y1)], axis=1) + j * ROOT_M
    ridge_x, is_flat = buildings.ridge_x[number], buildings.pitch[number] == 0.0
    inside = np.where(ridge_x, np.ptp(y, axis=1), np.ptp(x, axis=1)) / 2.0
    rise_m = np.where(is_flat, 0.0, inside * GABLE_RISE)
    # Corners, and the ends of the ridge, in the middle of two sides.
    ends = np.array([(0.0, 0.5), (1.0, 0.5)])
    ridge = np.where(ridge_x[:, np.newaxis, np.newaxis], ends, ends[:, ::-1])
    shares = np.concatenate([np.broadcast_to(_CORNERS, (len(number), 4, 2)), ridge], axis=1)
    bent = [at[:, :1] + shares[..., axis] * np.ptp(at, axis=1)[:, np.newaxis] for axis, at in enumerate((x, y))]
    u, v = (at.reshape(-1, 6) for at in _unbent(landscape, *(at.ravel() for at in bent)))
    ground = _ground(landscape, u[:, :4].ravel(), v[:, :4].ravel()).reshape(-1, 4)
    roof = np.stack([channel[number] for channel in buildings.roof], axis=1)
    walls = wall_colours(division.leaves.hash[number], roof.T).T
    # Unique within 64 x 64 root squares, 300 km.
    instance = ((((j & 63) << 6) + (i & 63)) << 17) + number + 1
    faces, of_face = _faces(u, v, ground, rise_m, ridge_x, is_flat, (roof, walls), instance)
    return _Houses(u[:, :4], v[:, :4], faces, of_face)


def _ground(landscape: int, u: Floats, v: Floats) -> Floats:
    """Heights of the ground at world fractions (n,)."""
    heights = np.empty(u.size)
    for at, samples in group_points(u - np.floor(u), v, np.full(u.size, BLOCK_ZOOM)):
        heights[at] = ground_m(Scene(landscape, samples))
    return heights


def _faces(
    u: Floats,
    v: Floats,
    ground: Floats,
    rise_m: Floats,
    ridge_x: Array,
    is_flat: Array,
    colours: tuple[Array, Array],
    instance: Numbers,
) -> tuple[Triangles, Numbers]:
    """Triangles of houses (n,), and the house of each: walls, gable ends and roofs.

    Corners are north-west, south-west, south-east, north-east; the ridge runs from west to east, or north to south.
    """
    lat, lon = MERCATOR.inverse(u, v)
    # Heights in the chart's metres, like widths.
    scale = np.cos(np.radians(lat[:, 0]))
    eaves = (ground.mean(axis=1) + EAVES_M * scale)[:, np.newaxis]
    foot = ground.min(axis=1)[:, np.newaxis] - SKIRT_M
    top = eaves + np.concatenate([np.zeros((len(u), 4)), np.repeat((rise_m * scale)[:, np.newaxis], 2, axis=1)], axis=1)
    points = np.concatenate([geocentric(lat, lon, top), geocentric(lat[:, :4], lon[:, :4], foot)], axis=1)
    walls = [side for k in range(4) for side in ((k, 6 + k, 6 + (k + 1) % 4), (k, 6 + (k + 1) % 4, (k + 1) % 4))]
    # West and east ends below a ridge eastward, north and south ends otherwise.
    along_x = [(0, 1, 4), (2, 3, 5)], [(1, 2, 5), (1, 5, 4), (3, 0, 4), (3, 4, 5)]
    along_y = [(3, 0, 4), (1, 2, 5)], [(0, 1, 5), (0, 5, 4), (2, 3, 4), (2, 4, 5)]
    no_ends: list[tuple[int, int, int]] = []
    flat = no_ends, [(0, 1, 2), (0, 2, 3)]
    parts, owners = [], []
    for chosen, (ends, roofs) in ((is_flat, flat), (~is_flat & ridge_x, along_x), (~is_flat & ~ridge_x, along_y)):
        at = np.flatnonzero(chosen)
        corners = np.array([*walls, *ends, *roofs])
        is_roof = np.arange(len(corners)) >= len(walls) + len(ends)
        each = np.repeat(at, len(corners))
        roof = np.tile(is_roof, len(at))
        parts.append(
            Triangles(
                points[at][:, corners].reshape(-1, 3, 3),
                np.where(roof, ROOF, WALL).astype(np.uint8),
                instance[each],
                np.where(roof[:, np.newaxis], colours[0][each], colours[1][each]).astype(np.uint8),
                roof,
            )
        )
        owners.append(each)
    return Triangles.joined(parts), np.concatenate(owners)
