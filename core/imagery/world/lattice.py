"""Hashed lattices and spline noise: the deterministic ground the embedded world stands on.

Level *k* divides the world square into ``2**k`` by ``2**k`` cells. A cell's hash depends on its column modulo ``2**k``,
so everything built on it is periodic across the antimeridian. Noise is a uniform cubic B-spline whose coefficients sit
on such lattices: spline spaces of successive levels are nested, so the sum of many octaves is *one* spline on
the finest
level, evaluated once per pixel however many octaves it has, and its coefficients bound its values.

A position is an integer cell and a float32 fraction of it, exact at every level for pixel centres of every zoom.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

WORLD_M = 40075016.685578488
"""Side of the Web-Mercator square in Mercator metres (EPSG:3857, 2 pi a)."""

TILE_PX = 256

_MASK = 0xFFFFFFFF


def mix(h: Array) -> NDArray[np.uint32]:
    """Scramble ``uint32`` values, so that each output bit depends on each input bit (MurmurHash3's finalizer)."""
    h = h.astype(np.uint32)
    h ^= h >> np.uint32(16)
    h *= np.uint32(0x85EBCA6B)
    h ^= h >> np.uint32(13)
    h *= np.uint32(0xC2B2AE35)
    h ^= h >> np.uint32(16)
    return h


def salt(seed: int, *words: int) -> int:
    """Hash of a seed and a few small integers, as a Python integer below ``2**32``."""
    h = seed & _MASK
    for word in ((seed >> 32) & _MASK, *words):
        h = (h ^ (word * 0x9E3779B1)) & _MASK
        h ^= h >> 16
        h = (h * 0x85EBCA6B) & _MASK
        h ^= h >> 13
        h = (h * 0xC2B2AE35) & _MASK
        h ^= h >> 16
    return h


def cell_hash(salts: int | Array, level: int, i: Array, j: Array) -> NDArray[np.uint32]:
    """Hash of lattice cells.

    Parameters
    ----------
    salts : int or uint32 array
        What tells one use of the lattice from another; broadcast with `i` and `j`.
    level : int
        The lattice has ``2**level`` columns; `i` wraps around.
    i, j : int64 arrays
        Columns and rows, broadcast together.
    """
    column = mix((i & ((1 << level) - 1)).astype(np.uint32) + np.uint32(0x27D4EB2F))
    row = mix((j & _MASK).astype(np.uint32) + np.uint32((0x165667B1 + level * 0x9E3779B1) & _MASK))
    key = (column * np.uint32(0x9E3779B1)) ^ row
    return mix(key ^ np.asarray(salts, dtype=np.uint32))


def unit(h: Array) -> NDArray[np.float32]:
    """Map ``uint32`` hashes to float32 in [0, 1)."""
    return (h >> np.uint32(8)).astype(np.float32) * np.float32(2.0**-24)


def signed(h: Array) -> NDArray[np.float32]:
    """Map ``uint32`` hashes to float32 in [-1, 1)."""
    return h.view(np.int32).astype(np.float32) * np.float32(2.0**-31)


def bits(h: Array, shift: int, count: int) -> NDArray[np.float32]:
    """Take `count` bits of hashes as float32 in [0, 1): several independent numbers from one hash."""
    return ((h >> np.uint32(shift)) & np.uint32((1 << count) - 1)).astype(np.float32) * np.float32(
        2.0**-count
    )


@dataclass(frozen=True)
class Window:
    """A block of lattice points: columns ``i0 … i0 + columns - 1`` and rows ``j0 … j0 + rows - 1`` of `level`."""

    level: int
    i0: int
    j0: int
    columns: int
    rows: int

    def indices(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the columns, shape (1, columns), and the rows, shape (rows, 1)."""
        i = np.arange(self.i0, self.i0 + self.columns, dtype=np.int64)[None, :]
        j = np.arange(self.j0, self.j0 + self.rows, dtype=np.int64)[:, None]
        return i, j

    def parent(self) -> Window:
        """Return the block one level coarser that `refine` needs to fill this one."""
        i0, j0 = self.i0 // 2 - 1, self.j0 // 2 - 1
        i1, j1 = (self.i0 + self.columns - 1) // 2 + 1, (self.j0 + self.rows - 1) // 2 + 1
        return Window(self.level - 1, i0, j0, i1 - i0 + 1, j1 - j0 + 1)

    def grown(self, cells: int) -> Window:
        """Return the block with a margin of `cells` on each side."""
        return Window(
            self.level, self.i0 - cells, self.j0 - cells, self.columns + 2 * cells, self.rows + 2 * cells
        )


def refine(coefficients: Array, coarse: Window, fine: Window) -> Array:
    """Give the coefficients of the same cubic spline one level finer (two-scale relation, masks 1 6 1 and 4 4 over 8).

    `coefficients` has shape (..., coarse.rows, coarse.columns); the result (..., fine.rows, fine.columns).
    """
    tall = _refine_last(np.swapaxes(coefficients, -1, -2), coarse.j0, fine.j0, fine.rows)
    return _refine_last(np.swapaxes(tall, -1, -2), coarse.i0, fine.i0, fine.columns)


def _refine_last(c: Array, coarse0: int, fine0: int, count: int) -> Array:
    first = fine0 // 2 - coarse0
    pairs = (fine0 + count - 1) // 2 - fine0 // 2 + 1
    out = np.empty((*c.shape[:-1], 2 * pairs), dtype=np.float32)
    middle = c[..., first : first + pairs]
    right = c[..., first + 1 : first + pairs + 1]
    even = out[..., 0::2]
    np.add(c[..., first - 1 : first + pairs - 1], right, out=even)
    even *= np.float32(0.125)
    even += np.float32(0.75) * middle
    odd = out[..., 1::2]
    np.add(middle, right, out=odd)
    odd *= np.float32(0.5)
    offset = fine0 & 1
    return out[..., offset : offset + count]


def _taps(f: Array, derivative: bool) -> tuple[Array, Array, Array, Array]:
    """Weights of the four coefficients around fractions `f` (float32) of a cell: values, or slopes per cell."""
    g = np.float32(1) - f
    f2, g2 = f * f, g * g
    half, sixth, three = np.float32(0.5), np.float32(1 / 6), np.float32(3)
    if derivative:
        low, high = -half * g2, half * f2
        second = half * f * (three * f - np.float32(4))
        return low, second, -half * g * (three * g - np.float32(4)), high
    low, high = sixth * g2 * g, sixth * f2 * f
    second = np.float32(2 / 3) - half * f2 * (np.float32(2) - f)
    return low, second, np.float32(1) - low - second - high, high


class Samples(ABC):
    """Positions to evaluate the world at, all in or near one tile; see `Grid` and `Points`.

    Attributes
    ----------
    zoom, x, y : int
        The tile; its north-west corner is the origin of the local metres.
    shape : tuple of int
        Shape of what is evaluated.
    """

    zoom: int
    x: int
    y: int
    shape: tuple[int, ...]
    _cells: dict[tuple[int, bool], Cells]

    @property
    def pixel_m(self) -> float:
        """Pixel size of the tile's zoom in Mercator metres."""
        return float(WORLD_M / (TILE_PX << self.zoom))

    @property
    def origin_m(self) -> tuple[float, float]:
        """The tile's north-west corner in Mercator metres east and south of the world's."""
        return self.x * TILE_PX * self.pixel_m, self.y * TILE_PX * self.pixel_m

    @abstractmethod
    def local_m(self) -> tuple[Array, Array]:
        """Return float32 metres east and south of the tile's corner, broadcastable to `shape`."""

    def spline(self, coefficients: Array, window: Window, dx: bool = False, dy: bool = False) -> Array:
        """Evaluate a spline (rows, columns) at the samples, or its slope per cell eastward or southward."""
        return self.cells(window.level).spline(coefficients, window, dx, dy)

    def cells(self, level: int, shifted: bool = False) -> Cells:
        """Locate the samples on a lattice; `shifted` moves the lattice by half a cell north-west."""
        key = (level, shifted)
        if key not in self._cells:
            self._cells[key] = self._locate(level, shifted)
        return self._cells[key]

    @abstractmethod
    def _locate(self, level: int, shifted: bool) -> Cells:
        """Locate the samples in a level's cells."""


class Cells(ABC):
    """Where samples lie on one lattice.

    `i`, `j` are columns and rows of cells; `fx`, `fy` float32 fractions of the cell, broadcastable to the inner shape.
    """

    level: int
    fx: Array
    fy: Array

    def __init__(self, level: int, i: Array, j: Array, fx: Array, fy: Array, shape: tuple[int, ...]) -> None:
        self.level, self.i, self.j, self.fx, self.fy, self.shape = level, i, j, fx, fy, shape
        self._taps: dict[tuple[str, bool], tuple[Array, Array, Array, Array]] = {}

    def _weights(self, dx: bool, dy: bool) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
        for axis, f, derivative in (("x", self.fx, dx), ("y", self.fy, dy)):
            if (axis, derivative) not in self._taps:
                self._taps[axis, derivative] = _taps(f, derivative)
        return self._taps["x", dx], self._taps["y", dy]

    def window(self, before: int = 0, after: int = 0) -> Window:
        """Return the block of cells that hold the samples, with a margin."""
        i0, j0 = int(self.i.min()) - before, int(self.j.min()) - before
        return Window(
            self.level, i0, j0, int(self.i.max()) + after - i0 + 1, int(self.j.max()) + after - j0 + 1
        )

    def support(self) -> Window:
        """Return the block of coefficients that a cubic spline needs at the samples."""
        return self.window(1, 2)

    @abstractmethod
    def spread(self, table: Array, window: Window) -> Array:
        """Give each sample the entry of its cell from a table (rows, columns), broadcastable to the inner shape."""

    @abstractmethod
    def inner(self) -> tuple[int, ...]:
        """Return the inner shape; it holds as many values as the samples' shape, in the same order."""

    @abstractmethod
    def pick(self, at: Array) -> Cells:
        """Locate only the samples of some flat indices."""

    @abstractmethod
    def spline(self, c: Array, window: Window, dx: bool, dy: bool) -> Array:
        """Evaluate a spline; see `Samples.spline`."""


class GridCells(Cells):
    """Cells under a block of pixels: rows of one cell are kept together, so that little is gathered."""

    def inner(self) -> tuple[int, ...]:
        """Return the inner shape; see `Cells.inner`."""
        return len(self.j), self.shape[0] // len(self.j), self.shape[1]

    def pick(self, at: Array) -> Cells:
        """Return the cells of some samples; see `Cells.pick`."""
        row, column = at // self.shape[1], at % self.shape[1]
        group = row // (self.shape[0] // len(self.j))
        inside = row - group * (self.shape[0] // len(self.j))
        fy = self.fy[np.minimum(group, self.fy.shape[0] - 1), inside, 0]
        return PointCells(self.level, self.i[column], self.j[group], self.fx[column], fy, at.shape)

    def spread(self, table: Array, window: Window) -> Array:
        """Give each sample the entry of its cell; see `Cells.spread`."""
        out: Array = table[self.j - window.j0][:, self.i - window.i0][:, None, :]
        return out

    def spline(self, c: Array, window: Window, dx: bool, dy: bool) -> Array:
        """Evaluate a spline; see `Samples.spline`."""
        wx, wy = self._weights(dx, dy)
        column = self.i - window.i0
        rows = c.take(column - 1, axis=1) * wx[0]
        for t in (1, 2, 3):
            rows += c.take(column + (t - 1), axis=1) * wx[t]
        row = self.j - window.j0
        out: Array = rows[row - 1][:, None, :] * wy[0]
        part = np.empty_like(out)
        for t in (1, 2, 3):
            np.multiply(rows[row + (t - 1)][:, None, :], wy[t], out=part)
            out += part
        return out.reshape(self.shape)


class PointCells(Cells):
    """Cells under scattered points."""

    def inner(self) -> tuple[int, ...]:
        """Return the inner shape; see `Cells.inner`."""
        return self.shape

    def pick(self, at: Array) -> Cells:
        """Return the cells of some samples; see `Cells.pick`."""
        return PointCells(self.level, self.i[at], self.j[at], self.fx[at], self.fy[at], at.shape)

    def spread(self, table: Array, window: Window) -> Array:
        """Give each sample the entry of its cell; see `Cells.spread`."""
        out: Array = table[self.j - window.j0, self.i - window.i0]
        return out

    def spline(self, c: Array, window: Window, dx: bool, dy: bool) -> Array:
        """Evaluate a spline; see `Samples.spline`."""
        wx, wy = self._weights(dx, dy)
        column, row = self.i - window.i0, self.j - window.j0

        def along(r: Array) -> Array:
            total = c[r, column - 1] * wx[0]
            for t in (1, 2, 3):
                total += c[r, column + (t - 1)] * wx[t]
            summed: Array = total
            return summed

        out = along(row - 1) * wy[0]
        for t in (1, 2, 3):
            out += along(row + (t - 1)) * wy[t]
        return out


def _split(position: Array, shift: int) -> tuple[Array, Array]:
    """Split half-integer positions, given as integers + 1/2, into cells of ``2**shift`` and fractions of them."""
    if shift < 0:
        raise ValueError(f"cells {2.0**shift} pixels wide, smaller than a pixel")
    cell = position >> shift
    inside = position - (cell << shift)
    return cell, ((inside + 0.5) / float(1 << shift)).astype(np.float32)


class Grid(Samples):
    """The centres of a block of pixels of `zoom` (by default the tile's) relative to a tile.

    ``level - 8`` is the zoom the block's pixels belong to; `left`, `top` are pixels of that zoom's whole picture.
    """

    def __init__(self, zoom: int, x: int, y: int, block: Window | None = None) -> None:
        self.zoom, self.x, self.y = zoom, x, y
        self.block = block or Window(zoom + 8, x * TILE_PX, y * TILE_PX, TILE_PX, TILE_PX)
        self.shape = (self.block.rows, self.block.columns)
        self._cells = {}

    def local_m(self) -> tuple[Array, Array]:
        """Metres east and south of the tile's corner; see `Samples.local_m`."""
        i, j = self.block.indices()
        step, scale = self.pixel_m, 2.0 ** (self.zoom + 8 - self.block.level)
        east = ((i + 0.5) * scale - self.x * TILE_PX) * step
        south = ((j + 0.5) * scale - self.y * TILE_PX) * step
        return east.astype(np.float32), south.astype(np.float32)

    def _locate(self, level: int, shifted: bool) -> Cells:
        shift = self.block.level - level
        half = (1 << shift) >> 1 if shifted else 0
        i, j = self.block.indices()
        column, fx = _split(i[0] + half, shift)
        row, fy = _split(j[:, 0] + half, shift)
        per_cell = 1 << shift
        rows = self.block.rows
        if row[0] == row[-1]:
            row, fy3 = row[:1], fy[None, :, None]
        elif (self.block.j0 + half) % per_cell == 0 and rows % per_cell == 0:
            row, fy3 = row[::per_cell], fy[None, :per_cell, None]
        else:
            fy3 = fy[:, None, None]
        return GridCells(level, column, row, fx, fy3, self.shape)


class Points(Samples):
    """Scattered positions in one tile: `u`, `v` are float64 world fractions from the north-west corner."""

    def __init__(self, zoom: int, x: int, y: int, u: Array, v: Array) -> None:
        self.zoom, self.x, self.y, self.u, self.v = zoom, x, y, u, v
        self.shape = u.shape
        self._cells = {}

    def local_m(self) -> tuple[Array, Array]:
        """Metres east and south of the tile's corner; see `Samples.local_m`."""
        scale, step = float(TILE_PX << self.zoom), self.pixel_m
        east = (self.u * scale - self.x * TILE_PX) * step
        south = (self.v * scale - self.y * TILE_PX) * step
        return east.astype(np.float32), south.astype(np.float32)

    def _locate(self, level: int, shifted: bool) -> Cells:
        scale, half = float(1 << level), 0.5 if shifted else 0.0
        column, row = self.u * scale + half, self.v * scale + half
        i, j = np.floor(column), np.floor(row)
        fx, fy = (column - i).astype(np.float32), (row - j).astype(np.float32)
        return PointCells(level, i.astype(np.int64), j.astype(np.int64), fx, fy, self.shape)
