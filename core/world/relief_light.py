"""Light of the sun on the relief: its slopes, and the horizon towards the sun.

It is computed at the cells of a lattice, the same for all zooms from `RELIEF_ZOOM` on, and evaluated as a spline: it is
a function of position alone. Heights are in the chart's metres, divided by its scale: as the chart is conformal, angles
are those on the ground.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from ..arrays import NDArray
from ..geodesy.ellipsoid import WGS84
from ..geodesy.sun import RADIUS_DEG
from .heights import HIGHEST_M, chart_scale, ground_m, highest_m
from .lattice import TILE_PX, WORLD_M, Array, LatticeWindow
from .rays import ChartSun, Ray
from .region import BLOCK_ZOOM, Region
from .samples import Grid, Positions, shared
from .scene import Scene

#: From this zoom on, the light of the relief is the same at each zoom.
RELIEF_ZOOM = 13
#: Steps of a ray between two checks whether the ground ahead can be in its way.
_CHUNK = 32
#: Steps that are left out at once where the ground ahead is too low.
_SKIPS = (32 * _CHUNK, _CHUNK)
#: Height of what lies beyond a chart.
_NO_GROUND_M = -20_000.0


def lattice_level(zoom: int) -> int:
    """Level of the lattice on whose cells the light of the relief is computed: 2 px, and 38 m from `RELIEF_ZOOM` on."""
    return min(zoom, RELIEF_ZOOM) + 7


def relief_light(landscape: int, sun: ChartSun, samples: Positions) -> tuple[Array | None, Array, Array]:
    """Light of the relief at samples.

    Returns the degrees by which the sun's centre stands above the horizon, or None where the whole disc does; the
    cosine of the angle between ground and sun over that of level ground; and the share of the sky that the slope sees.
    """
    zoom, level = samples.zoom, lattice_level(samples.zoom)
    up = max(zoom - BLOCK_ZOOM, 0)
    window, tables = _block(landscape, sun, level, (zoom - up, samples.x >> up, samples.y >> up))
    cells = samples.cells(level, shifted=True)
    support = cells.support()
    i, j = support.i0 - window.i0, support.j0 - window.j0
    is_clear = bool((tables[0, j : j + support.rows, i : i + support.columns] > RADIUS_DEG).all())
    found = [cells.spline(table, window, False, False) for table in tables[is_clear:]]
    return (None if is_clear else found[0]), found[-2], found[-1]


@shared(64)
def _block(landscape: int, sun: ChartSun, level: int, block: tuple[int, int, int]) -> tuple[LatticeWindow, Array]:
    """Coefficients (3, rows, columns) of the light of a tile's relief, see `_relief`, and their window.

    The window is one of the shifted lattice, whose points are the centres of cells.
    """
    shifted = Grid(*block).cells(level, shifted=True).support()
    # A margin for the coefficients, and another for the slopes.
    cells = LatticeWindow(level, shifted.i0 - 1, shifted.j0 - 1, shifted.columns, shifted.rows).grown(2)
    relief, inner = ChartRelief(landscape, level), cells.grown(-1)
    ground, cell_m = relief.heights_m(cells), relief.cell_m
    east = (ground[1:-1, 2:] - ground[1:-1, :-2]) * np.float32(0.5 / cell_m)
    south = (ground[2:, 1:-1] - ground[:-2, 1:-1]) * np.float32(0.5 / cell_m)
    up = np.float32(1) / np.sqrt(np.float32(1) + east * east + south * south)
    over_tangent = np.float32(1.0 / max(sun.tangent, 1e-6))
    facing = up * (np.float32(1) - (east * np.float32(sun.east) + south * np.float32(sun.south)) * over_tangent)
    clearance = np.float32(sun.height_deg) - np.degrees(np.arctan(horizon_tangent(relief, inner, sun)))
    np.minimum(clearance, np.float32(clearest_deg(sun)), out=clearance)
    tables = np.stack([clearance, facing, np.float32(0.5) + np.float32(0.5) * up])
    return shifted, _coefficients(tables)


def _coefficients(values: Array) -> NDArray[np.float32]:
    """Coefficients of a cubic spline that passes close to values (..., rows, columns), for all but the outer ones."""
    c = np.float32(8) * values[..., 1:-1, :] - values[..., :-2, :] - values[..., 2:, :]
    c = np.float32(8) * c[..., 1:-1] - c[..., :-2] - c[..., 2:]
    return np.asarray(c * np.float32(1 / 36), np.float32)


class HeightLattice(Protocol):
    """Ground at the centres of the cells of a lattice."""

    @property
    def cell_m(self) -> float:
        """Width of cells."""

    def heights_m(self, window: LatticeWindow) -> NDArray[np.float32]:
        """Heights (rows, columns)."""

    def highest_m(self, window: LatticeWindow) -> float:
        """Upper bound of the heights in a window."""

    def limit_m(self, window: LatticeWindow) -> float:
        """Upper bound of all heights around a window."""

    def curvature_per_m(self, window: LatticeWindow) -> NDArray[np.float32]:
        """Curvature of the level in each row, (rows, 1): that of the Earth in the metres of the lattice."""


class ChartRelief(NamedTuple):
    """The ground of a landscape at the cells of a level, in the chart's metres."""

    landscape: int
    level: int

    @property
    def cell_m(self) -> float:
        """Width of cells."""
        return float(WORLD_M / (1 << self.level))

    def heights_m(self, window: LatticeWindow) -> NDArray[np.float32]:
        """Heights; far below the ground beyond the chart."""
        out = np.full((window.rows, window.columns), _NO_GROUND_M, np.float32)
        columns = 1 << (self.level - 8)
        last = min((window.j0 + window.rows - 1) // TILE_PX, columns - 1)
        for y in range(max(window.j0 // TILE_PX, 0), last + 1):
            for x in range(window.i0 // TILE_PX, (window.i0 + window.columns - 1) // TILE_PX + 1):
                lay(out, window, _ground(self.landscape, self.level, x % columns, y), x, y)
        return out

    def highest_m(self, window: LatticeWindow) -> float:
        """Upper bound of the heights in a window."""
        return highest_m(self.landscape, window)

    def limit_m(self, window: LatticeWindow) -> float:
        """Upper bound of all heights around a window."""
        return HIGHEST_M / float(chart_scale(self.landscape, window.rows_v).min())

    def curvature_per_m(self, window: LatticeWindow) -> NDArray[np.float32]:
        """Curvature of the level in each row; a function of the place alone, so that tiles join."""
        return chart_scale(self.landscape, window.rows_v)[:, np.newaxis] * np.float32(1.0 / WGS84.a_m)


def clearest_deg(sun: ChartSun) -> float:
    """Degrees above the horizon to which the height of the sun is known: more than the radius of its disc is enough."""
    return min(2.0, max(0.5 * sun.height_deg, 1.5 * RADIUS_DEG))


@shared(64)
def _ground(landscape: int, level: int, x: int, y: int) -> NDArray[np.float32]:
    """Heights at the centres of 256 x 256 cells, in the chart's metres."""
    samples = Grid(level - 8, x, y)
    scene = Scene(landscape, samples, Region(landscape, level - 7, (samples.zoom, x, y)))
    # The chart is conformal: divided by its scale, heights make the angles of the ground.
    return np.asarray(ground_m(scene) / chart_scale(landscape, samples.block.rows_v)[:, np.newaxis], np.float32)


def horizon_tangent(relief: HeightLattice, window: LatticeWindow, sun: ChartSun) -> NDArray[np.float32]:
    """Greatest tangent of the height of the ground in the direction of the sun, at the centres of cells.

    It is exact where the sun stands less than `clearest_deg` above the horizon, and elsewhere too low at most: rays end
    where the highest ground ahead is below that. The Earth curves away below them.
    """
    ray, base, falls = Ray.to(sun), relief.heights_m(window), 0.5 * relief.curvature_per_m(window)
    best, above = np.full(base.shape, -np.inf, np.float32), np.empty_like(base)
    step_m, lowest, flattest = ray.length * relief.cell_m, float(base.min()), float(falls.min())
    first, rise = 1, float(np.tan(np.radians(sun.height_deg - clearest_deg(sun))))
    while True:
        distance = first * step_m
        least = lowest + distance * (rise + distance * flattest)
        ahead = ray.ahead(window, first, first + _CHUNK)
        if least > relief.limit_m(ahead):
            return best
        skipped = next((n for n in _SKIPS if relief.highest_m(ray.ahead(window, first, first + n)) < least), 0)
        if skipped:
            first += skipped
            continue
        ground, origin = relief.heights_m(ahead), (window.i0 - ahead.i0, window.j0 - ahead.j0)
        for step in range(first, first + _CHUNK):
            distance = step * step_m
            np.subtract(_moved(ground, origin, base.shape, ray.at(step, 0.0)), base, out=above)
            above -= falls * np.float32(distance * distance)
            above *= np.float32(1.0 / distance)
            np.maximum(best, above, out=best)
        first += _CHUNK


def _moved(
    ground: Array, origin: tuple[int, int], shape: tuple[int, ...], at: tuple[int, int, float, bool]
) -> NDArray[np.float32]:
    """Part of a lattice, linearly interpolated, at a place along a ray."""
    column, row, share, is_east = at
    i, j = origin[0] + column, origin[1] + row
    here = ground[j : j + shape[0], i : i + shape[1]]
    if share == 0.0:
        return here
    i, j = (i + 1, j) if is_east else (i, j + 1)
    following = ground[j : j + shape[0], i : i + shape[1]]
    return np.asarray(here + (following - here) * np.float32(share))


def lay(out: Array, window: LatticeWindow, tile: Array, x: int, y: int) -> None:
    """Copy the part of a tile of 256 x 256 cells that lies in a window."""
    i, j = x * TILE_PX - window.i0, y * TILE_PX - window.j0
    part = out[max(j, 0) : j + TILE_PX, max(i, 0) : i + TILE_PX]
    part[:] = tile[max(-j, 0) :, max(-i, 0) :][: part.shape[0], : part.shape[1]]
