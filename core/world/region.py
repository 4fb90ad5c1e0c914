"""Land, sea, climate, relief and the courses of rivers and motorways: the world at the scale of kilometres.

Every quantity is a cubic spline on a hashed lattice (`lattice`), summed over octaves down to a few hundred metres or to
four pixels of the zoom, whichever is coarser. Octaves that a zoom cannot show blur edges by their standard
deviation: a shore drawn without them is as soft as the average of the shore drawn with them.
"""

from __future__ import annotations

from functools import cached_property
from typing import Callable

import numpy as np

from .lattice import WORLD_M, Array, LatticeWindow, cell_hash, chart_pole, refine, salt, signed
from .samples import Grid, Positions, shared

#: Level of the finest octave of any field, with cells of 76 m.
FINEST_OCTAVE = 19
#: Level (39 km cells) at which settlement is decided, and down to which coefficients are remembered.
COARSE = 10
#: From this zoom on, regions are computed and remembered for tiles of this zoom, 1.2 km wide.
BLOCK_ZOOM = 15
#: First level of each field, and the amplitudes of its octaves from this level on.
_FIELDS: dict[str, tuple[int, tuple[float, ...]]] = {
    "land": (
        1,
        (
            0.55,
            0.8,
            0.85,
            0.62,
            0.42,
            0.28,
            0.18,
            0.12,
            0.08,
            0.054,
            0.036,
            0.024,
            0.016,
            0.011,
            0.007,
            0.004,
        ),
    ),
    "rough": (3, (0.7, 0.9, 0.8, 0.6, 0.45, 0.3, 0.2, 0.12)),
    "heat": (2, (0.1, 0.1, 0.08, 0.06, 0.05, 0.04, 0.03, 0.02)),
    "wet": (2, (0.5, 0.5, 0.4, 0.3, 0.2, 0.15, 0.1, 0.08, 0.06)),
    "river": (7, (1.0, 0.8, 0.55, 0.34, 0.2, 0.12, 0.075, 0.045, 0.025, 0.012, 0.005)),
    "brook": (11, (1.0, 0.8, 0.6, 0.4, 0.22, 0.1, 0.04)),
    "lake": (10, (0.6, 0.8, 1.0, 0.9, 0.5, 0.3, 0.16, 0.08, 0.04)),
    "wood": (9, (0.5, 0.5, 0.5, 0.6, 0.8, 0.9, 0.8, 0.6, 0.4, 0.25, 0.15)),
    "motorway": (9, (1.0, 0.8, 0.4, 0.1)),
    "warp_x": (11, (0.24 / 2**11, 0.24 / 2**12, 0.26 / 2**13, 0.24 / 2**14)),
    "warp_y": (11, (0.24 / 2**11, 0.24 / 2**12, 0.26 / 2**13, 0.24 / 2**14)),
    "relief": (4, tuple(1.0 / 2.0 ** (k - 4) for k in range(4, 18))),
}
NAMES = tuple(_FIELDS)
_INDEX = {name: row for row, name in enumerate(NAMES)}
_AMPLITUDE = np.zeros((len(NAMES), FINEST_OCTAVE + 2), dtype=np.float32)
for _row, (_first, _octaves) in enumerate(_FIELDS.values()):
    _AMPLITUDE[_row, _first : _first + len(_octaves)] = _octaves
_RIDGED = _INDEX["relief"]


def left_out_sd(name: str, level: int) -> float:
    """Return the standard deviation of the octaves of a field that lie beyond a level."""
    # A spline whose coefficients are uniform in [-1, 1) has a standard deviation of 0.277.
    return float(0.277 * np.sqrt(np.sum(np.square(_AMPLITUDE[_INDEX[name], level + 1 :], dtype=np.float64))))


def smoothstep(low: float, high: float, x: Array) -> Array:
    """Rise smoothly from 0 at `low` to 1 at `high`, with slopes of 0 at both."""
    t = np.minimum(np.maximum((x - low) * (1.0 / (high - low)), 0.0), 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def _add_octave(seed: int, window: LatticeWindow, c: Array, ridge_noise: Array | None) -> tuple[Array, Array | None]:
    """Add the octave of the window's level to coefficients of that level; return them and the noise of relief."""
    level = window.level
    if ridge_noise is not None:
        # Relief consists of ridges, 1 - 2|n|, computed one level finer than the noise n, where coefficients are
        # close to values.
        mountains = smoothstep(0.1, 0.95, c[_INDEX["rough"]]) + np.float32(0.06)
        if level > 9:  # flat valley floors along the rivers
            mountains *= np.float32(0.15) + np.float32(0.85) * smoothstep(0.02, 0.3, np.abs(c[_INDEX["river"]]))
        c[_RIDGED] += (
            mountains * (np.float32(0.66) - np.float32(2.2) * np.abs(ridge_noise)) * _AMPLITUDE[_RIDGED, level - 1]
        )
    amplitude = _AMPLITUDE[:, level] if level <= FINEST_OCTAVE else _AMPLITUDE[:, -1]
    active = np.flatnonzero(amplitude)
    if active.size == 0:
        return c, None
    i, j = window.indices()
    salts = np.array([salt(seed, 1, int(row)) for row in active], dtype=np.uint32)[:, None, None]
    noise = signed(cell_hash(salts, level, i, j))
    c[active] += noise * amplitude[active][:, None, None]
    relief = noise[active == _RIDGED]
    return c, (relief[0] if relief.size else None)


def _descend(seed: int, windows: list[LatticeWindow], c: Array, ridge: Array | None) -> tuple[Array, Array | None]:
    """Refine coefficients from the first window down to the last, adding an octave at each."""
    for coarse, fine in zip(windows, windows[1:]):
        c = refine(c, coarse, fine)
        ridge = None if ridge is None else refine(ridge, coarse, fine)
        c, ridge = _add_octave(seed, fine, c, ridge)
    return c, ridge


@shared(64)
def _coarse(seed: int, window: LatticeWindow) -> tuple[Array, Array | None]:
    """Coefficients at a window of level `COARSE` or coarser, shared by neighbouring tiles."""
    windows = _ancestry(window, 0)
    start = np.zeros((len(NAMES), windows[0].rows, windows[0].columns), dtype=np.float32)
    c, ridge = _descend(seed, windows, start, None)
    pole = chart_pole(seed)
    if pole:
        colatitude = _colatitude(window)
        # Charts about the poles are colder than the map at the same latitude, the southern one most.
        c[_INDEX["heat"]] += _heat(np.sin(colatitude)) - np.float32({1: 0.04, -1: 0.13}[pole])
        c[_INDEX["land"]] += _polar_land(pole, colatitude)
    else:
        c[_INDEX["heat"]] += _latitude_heat(window)
    return c, ridge


def coarse_fields(seed: int, window: LatticeWindow) -> dict[str, Array]:
    """Return the coefficients of all fields at a window of level `COARSE`."""
    return dict(zip(NAMES, _coarse(seed, window)[0]))


def _ancestry(window: LatticeWindow, level: int) -> list[LatticeWindow]:
    """Return the windows of all levels from `level` down to a window; only the window if its level is coarser."""
    windows = [window]
    while windows[-1].level > level:
        windows.append(windows[-1].parent())
    return windows[::-1]


def _latitude_heat(window: LatticeWindow) -> Array:
    """Warmth by latitude at lattice points, 0 at the ice and 1 at the equator; splines reproduce it closely."""
    j = window.indices()[1]
    v = np.clip(j / float(1 << window.level), 0.0, 1.0)
    latitude = np.arctan(np.sinh(np.pi * (1.0 - 2.0 * v)))
    return _heat(np.cos(latitude))


def _heat(cosine: Array) -> Array:
    """Warmth by the cosine of the latitude."""
    heat: Array = (1.06 * cosine**1.15 - 0.1).astype(np.float32)
    return heat


def _colatitude(window: LatticeWindow) -> Array:
    """Angle from the pole of a chart, in radians, at lattice points; splines reproduce it closely."""
    i, j = window.indices()
    middle, cell_m = 0.5 * (1 << window.level), WORLD_M / (1 << window.level)
    # Polar stereographic projection of a sphere, with true scale at 70 to 71 degrees.
    diameter_m = 2.0 * 6371007.0 * 0.9698
    return np.asarray(2.0 * np.arctan(np.hypot(i - middle, j - middle) * (cell_m / diameter_m)))


def _polar_land(pole: int, colatitude: Array) -> Array:
    """Change of `land` about a pole: a sea with islands in the north, a continent in the south."""
    degrees = np.degrees(colatitude)
    if pole > 0:
        return np.asarray(-0.5 * smoothstep(19.0, 9.0, degrees), np.float32)
    return np.asarray(0.75 * smoothstep(30.0, 8.0, degrees) - 0.45 * smoothstep(18.0, 30.0, degrees), np.float32)


def finest_level(zoom: int) -> int:
    """Return the level of a region's coefficients at a zoom.

    Its cells are 4 px wide, as a cubic spline passes wavelengths down to half of that; at high zooms they are a quarter
    of a tile wide.
    """
    return min(zoom + 8 - 2, max(FINEST_OCTAVE, min(zoom + 2, FINEST_OCTAVE + 2)))


def neighbourhood(samples: Positions) -> tuple[int, int, int]:
    """Return the tile (zoom, x, y) around the samples, up to two zooms lower, in which trees and speckle are shared."""
    up = min(max(samples.zoom - BLOCK_ZOOM, 0), 2)
    return samples.zoom - up, samples.x >> up, samples.y >> up


class Region:
    """The regional fields over a block: a tile of zoom `BLOCK_ZOOM` or, at lower zooms, one tile."""

    def __init__(self, seed: int, zoom: int, block: tuple[int, int, int]) -> None:
        self.seed, self.zoom = seed, zoom
        self.level = finest_level(zoom)
        # Two cells more than the tile's spline needs: one for `nodes`, one for trees whose cells cross its edge.
        self.window = Grid(*block).cells(self.level).support().grown(2)
        windows = _ancestry(self.window, COARSE)
        self.coefficients = c = _descend(seed, windows, *_coarse(seed, windows[0]))[0]
        wide = (c[:, :-2] + c[:, 2:] + np.float32(4) * c[:, 1:-1]) * np.float32(1 / 6)
        values = (wide[..., :-2] + wide[..., 2:] + np.float32(4) * wide[..., 1:-1]) * np.float32(1 / 6)
        self.nodes: dict[str, Array] = dict(zip(NAMES, values))
        self._derived: dict[str, Array] = {}
        low, high = c.min(axis=(1, 2)), c.max(axis=(1, 2))
        self._extremes = dict(zip(NAMES, zip(low.tolist(), high.tolist())))

    @staticmethod
    def around(seed: int, samples: Positions) -> Region:
        """Return the region of a tile."""
        up = max(samples.zoom - BLOCK_ZOOM, 0)
        return _region(seed, samples.zoom, (samples.zoom - up, samples.x >> up, samples.y >> up))

    def value(self, name: str, samples: Positions) -> Array:
        """Evaluate a field at samples."""
        return samples.spline(self.coefficients[_INDEX[name]], self.window)

    def hills(self, samples: Positions) -> Array:
        """Evaluate the octaves of relief beyond `COARSE`, which are hills; 0 at zooms without them."""
        return samples.spline(self._hills, self.window)

    @cached_property
    def _hills(self) -> Array:
        windows = _ancestry(self.window, COARSE)
        base = _coarse(self.seed, windows[0])[0][_RIDGED]
        for coarse, fine in zip(windows, windows[1:]):
            base = refine(base, coarse, fine)
        return np.asarray(self.coefficients[_RIDGED] - base)

    def highest(self, window: LatticeWindow, turns: int) -> tuple[float, float, float]:
        """Bound `land`, `relief` and hills from above over the region's part of a window of finer cells.

        Fields have all their octaves; ``turns`` is by how many tiles of the region's zoom the window is east of it.
        """
        down = window.level - self.level
        east = turns << (self.level - self.zoom)
        i0, i1 = (window.i0 >> down) - east, ((window.i0 + window.columns - 1) >> down) - east
        j0, j1 = window.j0 >> down, (window.j0 + window.rows - 1) >> down
        own = self.window
        # A spline lies between the four coefficients around a cell.
        rows = slice(max(j0 - 1 - own.j0, 0), max(j1 + 3 - own.j0, 1))
        columns = slice(max(i0 - 1 - own.i0, 0), max(i1 + 3 - own.i0, 1))
        left_out = [float(_AMPLITUDE[_INDEX["land"], self.level + 1 :].sum())]
        # Ridges are computed a level finer than their noise, and at most 0.66 of 1.06 high.
        left_out += [0.66 * 1.06 * float(_AMPLITUDE[_RIDGED, self.level :].sum())] * 2
        fields = (self.coefficients[_INDEX["land"]], self.coefficients[_RIDGED], self._hills)
        land, relief, hills = (float(c[rows, columns].max()) + more for c, more in zip(fields, left_out))
        return land, relief, hills

    def slope(self, name: str, samples: Positions) -> tuple[Array, Array]:
        """Evaluate a field's slope per Mercator metre, east and south."""
        c, per_m = self.coefficients[_INDEX[name]], np.float32((1 << self.level) / WORLD_M)
        return samples.spline(c, self.window, dx=True) * per_m, samples.spline(c, self.window, dy=True) * per_m

    def steepness(self, name: str, samples: Positions) -> Array:
        """Evaluate the length of a field's slope, per Mercator metre."""
        east, south = self.slope(name, samples)
        east *= east
        south *= south
        east += south
        return np.sqrt(east, out=east)

    def extremes(self, name: str) -> tuple[float, float]:
        """Bound a field over the whole block."""
        return self._extremes[name]

    def span(self, name: str, samples: Positions) -> tuple[float, float]:
        """Bound a field over samples: a spline lies between its coefficients."""
        c = self._under(self.coefficients[_INDEX[name]], self.window, samples)
        return float(c.min()), float(c.max())

    def blur(self, name: str) -> float:
        """Return the width of a ramp with the standard deviation of the octaves that this zoom leaves out."""
        return float(12.0**0.5 * left_out_sd(name, self.level))

    def _under(self, c: Array, window: LatticeWindow, samples: Positions) -> Array:
        support = samples.cells(self.level).support()
        i, j = support.i0 - window.i0, support.j0 - window.j0
        return c[..., j : j + support.rows, i : i + support.columns]

    def derived(self, function: Callable[[dict[str, Array]], Array]) -> Array:
        """Evaluate a function of the fields at the lattice points, shape (..., rows, columns)."""
        name = function.__name__
        if name not in self._derived:
            self._derived[name] = function(self.nodes).astype(np.float32, copy=False)
        return self._derived[name]

    def derived_extremes(self, function: Callable[[dict[str, Array]], Array]) -> tuple[float, float]:
        """Bound a function of the fields over the whole block."""
        name = function.__name__
        if name not in self._extremes:
            c = self.derived(function)
            self._extremes[name] = float(c.min()), float(c.max())
        return self._extremes[name]

    def smooth(self, function: Callable[[dict[str, Array]], Array], samples: Positions) -> Array:
        """Evaluate a function of the fields at samples, smoothly between lattice points."""
        c, window = self.derived(function), self.window.grown(-1)
        if c.ndim == 2:
            return samples.spline(c, window)
        return np.stack([samples.spline(part, window) for part in c])

    def derived_span(self, function: Callable[[dict[str, Array]], Array], samples: Positions) -> tuple[float, float]:
        """Bound a function of the fields over samples."""
        c = self._under(self.derived(function), self.window.grown(-1), samples)
        return float(c.min()), float(c.max())


@shared(48)
def _region(seed: int, zoom: int, block: tuple[int, int, int]) -> Region:
    return Region(seed, zoom, block)
