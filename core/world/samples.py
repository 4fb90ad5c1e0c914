"""Positions at which the world is evaluated: a tile's pixels, cells of several tiles, or scattered points.

On a lattice a position is an integer cell and a float32 fraction of it, exact at every level for pixel centres of every
zoom. Results that neighbouring tiles share are computed once (`shared`).
"""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass
from functools import lru_cache, wraps
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from .lattice import TILE_PX, WORLD_M, Array, LatticeWindow

Result = TypeVar("Result")


def _taps(f: Array, derivative: bool) -> tuple[Array, Array, Array, Array]:
    """Weights of the four coefficients around fractions `f` (float32) of a cell, for values or for slopes per cell."""
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


class Positions(ABC):
    """Positions to evaluate the world at, all in or near one tile; see `Grid` and `ScatteredPositions`.

    Attributes
    ----------
    zoom, x, y : int
        The tile; its north-west corner is the origin of the local metres.
    shape : tuple of int
        Shape of the results.
    """

    zoom: int
    x: int
    y: int
    shape: tuple[int, ...]
    _cells: dict[tuple[int, bool], LatticeCells]

    @property
    def pixel_m(self) -> float:
        """Pixel size of the tile's zoom in Mercator metres."""
        return float(WORLD_M / (TILE_PX << self.zoom))

    @property
    def origin_m(self) -> tuple[float | Array, float | Array]:
        """The tile's north-west corner in Mercator metres east and south of the world's."""
        return self.x * TILE_PX * self.pixel_m, self.y * TILE_PX * self.pixel_m

    @abstractmethod
    def local_m(self) -> tuple[Array, Array]:
        """Return float32 metres east and south of the tile's corner, broadcastable to `shape`."""

    def spline(self, coefficients: Array, window: LatticeWindow, dx: bool = False, dy: bool = False) -> Array:
        """Evaluate a spline (rows, columns) at the samples, or its slope per cell eastward or southward."""
        return self.cells(window.level).spline(coefficients, window, dx, dy)

    def cells(self, level: int, shifted: bool = False) -> LatticeCells:
        """Locate the samples on a lattice; `shifted` moves the lattice by half a cell north-west."""
        key = (level, shifted)
        if key not in self._cells:
            self._cells[key] = self._locate(level, shifted)
        return self._cells[key]

    @abstractmethod
    def _locate(self, level: int, shifted: bool) -> LatticeCells:
        """Locate the samples in a level's cells."""


class Few(NamedTuple):
    """Some of the samples on a lattice: their flat indices, the fractions of their cells, and the cells in a window."""

    at: Array
    fx: Array
    fy: Array
    cells: tuple[Array, Array]


class LatticeCells(ABC):
    """Samples on one lattice.

    `i`, `j` are columns and rows of cells; `fx`, `fy` are float32 fractions of the cell, broadcastable to the inner
    shape.
    """

    level: int
    fx: Array
    fy: Array

    def __init__(self, level: int, i: Array, j: Array, fx: Array, fy: Array, shape: tuple[int, ...]) -> None:
        self.level, self.i, self.j, self.fx, self.fy, self.shape = level, i, j, fx, fy, shape
        self._window: LatticeWindow | None = None

    def window(self, before: int = 0, after: int = 0) -> LatticeWindow:
        """Return the block of cells that hold the samples, with a margin."""
        if self._window is None:
            i0, j0 = int(self.i.min()), int(self.j.min())
            columns, rows = int(self.i.max()) - i0 + 1, int(self.j.max()) - j0 + 1
            self._window = LatticeWindow(self.level, i0, j0, columns, rows)
        held, more = self._window, before + after
        return LatticeWindow(self.level, held.i0 - before, held.j0 - before, held.columns + more, held.rows + more)

    def support(self) -> LatticeWindow:
        """Return the block of coefficients that a cubic spline needs at the samples."""
        return self.window(1, 2)

    @abstractmethod
    def spread(self, table: Array, window: LatticeWindow) -> Array:
        """Give each sample the entry of its cell from a table (rows, columns), broadcastable to the inner shape."""

    @abstractmethod
    def inner(self) -> tuple[int, ...]:
        """Return the inner shape; it holds as many values as the samples' shape, in the same order."""

    @abstractmethod
    def pick(self, at: Array) -> LatticeCells:
        """Locate only the samples of some flat indices."""

    def among(self, chosen: Array) -> Few:
        """Return the samples in chosen cells, given as a bool array of the shape of their window."""
        held = self.window()
        at = np.flatnonzero(np.broadcast_to(self.spread(chosen, held), self.inner()))
        cells = self.pick(at)
        return Few(at, cells.fx, cells.fy, (cells.j - held.j0, cells.i - held.i0))

    @abstractmethod
    def spline(self, c: Array, window: LatticeWindow, dx: bool, dy: bool) -> Array:
        """Evaluate a spline; see `Positions.spline`."""


@dataclass(frozen=True)
class _Axis:
    """Positions along one axis: `count` pixels, starting at pixel `inside` of a cell of ``2**shift`` pixels.

    Nearly all tiles of a zoom have equal axes, so results are remembered.
    """

    inside: int
    count: int
    shift: int

    @property
    def cells(self) -> Array:
        """Cell of each pixel, counted from the first pixel's cell."""
        return _axis(self)[0]

    @property
    def fractions(self) -> Array:
        """Fraction of each pixel in its cell, float32."""
        return _axis(self)[1]

    def taps(self, derivative: bool) -> tuple[Array, Array, Array, Array]:
        """Weights of a spline's coefficients; see `_taps`."""
        return _axis_taps(self, derivative)


@lru_cache(maxsize=128)
def _axis(axis: _Axis) -> tuple[Array, Array]:
    return _split(np.arange(axis.inside, axis.inside + axis.count, dtype=np.int64), axis.shift)


@lru_cache(maxsize=128)
def _axis_taps(axis: _Axis, derivative: bool) -> tuple[Array, Array, Array, Array]:
    return _taps(axis.fractions, derivative)


class GridCells(LatticeCells):
    """Cells under a block of pixels; the rows of a cell are kept together, so that few coefficients are gathered."""

    def __init__(
        self, level: int, corner: tuple[int, int], columns: _Axis, rows: _Axis, shape: tuple[int, ...]
    ) -> None:
        """Locate a block of pixels whose north-west one is in the cell `corner`.

        `rows` may have only the pixels of one cell if the block consists of whole cells.
        """
        i = corner[0] + columns.cells
        cell_rows = shape[0] // rows.count
        # Whether the block has rows of several cells, but not of whole cells.
        self._apart = cell_rows == 1 and int(rows.cells[-1]) > 0
        if self._apart:
            j, fy = corner[1] + rows.cells, rows.fractions[:, None, None]
        else:
            j, fy = corner[1] + np.arange(cell_rows, dtype=np.int64), rows.fractions[None, :, None]
        super().__init__(level, i, j, columns.fractions, fy, shape)
        self._columns, self._rows = columns, rows
        self._window = LatticeWindow(
            level, *corner, int(columns.cells[-1]) + 1, int(rows.cells[-1]) + 1 if self._apart else cell_rows
        )

    def inner(self) -> tuple[int, ...]:
        """Return the inner shape; see `LatticeCells.inner`."""
        return len(self.j), self.shape[0] // len(self.j), self.shape[1]

    def among(self, chosen: Array) -> Few:
        """Return the samples in chosen cells, cell by cell if cells are whole; see `LatticeCells.among`."""
        side = 1 << self._columns.shift
        if self._apart or self._columns.inside or self._rows.inside:
            return super().among(chosen)
        row, column = np.nonzero(chosen)
        first = (row * (side * self.shape[1]) + column * side)[:, None]
        fx, fy = self._columns.fractions[:side], self._rows.fractions
        inside = (np.arange(side)[:, None] * self.shape[1] + np.arange(side)).reshape(1, -1)
        return Few(first + inside, np.tile(fx, side), np.repeat(fy, side), (row[:, None], column[:, None]))

    def pick(self, at: Array) -> LatticeCells:
        """Return the cells of some samples; see `LatticeCells.pick`."""
        row, column = at // self.shape[1], at % self.shape[1]
        group = row // (self.shape[0] // len(self.j))
        inside = row - group * (self.shape[0] // len(self.j))
        fy = self.fy[np.minimum(group, self.fy.shape[0] - 1), inside, 0]
        return PointCells(self.level, self.i[column], self.j[group], self.fx[column], fy, at.shape)

    def spread(self, table: Array, window: LatticeWindow) -> Array:
        """Give each sample the entry of its cell; see `LatticeCells.spread`."""
        out: Array = table[self.j - window.j0][:, self.i - window.i0][:, None, :]
        return out

    def spline(self, c: Array, window: LatticeWindow, dx: bool, dy: bool) -> Array:
        """Evaluate a spline; see `Positions.spline`."""
        wx, wy = self._columns.taps(dx), self._rows.taps(dy)
        held = self.window()
        row, column = held.j0 - window.j0, self.i - window.i0
        c = c[row - 1 : row + held.rows + 2]
        rows = c.take(column - 1, axis=1)
        rows *= wx[0]
        for t in (1, 2, 3):
            part = c.take(column + (t - 1), axis=1)
            part *= wx[t]
            rows += part
        if self._apart:
            block_row = self.j - held.j0
            taps = [rows[block_row + t] * wy[t][:, None] for t in range(4)]
            return np.asarray(((taps[0] + taps[1]) + taps[2]) + taps[3])
        out: Array = rows[: held.rows, None, :] * wy[0][:, None]
        part = np.empty_like(out)
        for t in (1, 2, 3):
            np.multiply(rows[t : held.rows + t, None, :], wy[t][:, None], out=part)
            out += part
        return out.reshape(self.shape)


class PointCells(LatticeCells):
    """Cells under scattered points."""

    def inner(self) -> tuple[int, ...]:
        """Return the inner shape; see `LatticeCells.inner`."""
        return self.shape

    def pick(self, at: Array) -> LatticeCells:
        """Return the cells of some samples; see `LatticeCells.pick`."""
        return PointCells(self.level, self.i[at], self.j[at], self.fx[at], self.fy[at], at.shape)

    def spread(self, table: Array, window: LatticeWindow) -> Array:
        """Give each sample the entry of its cell; see `LatticeCells.spread`."""
        out: Array = table[self.j - window.j0, self.i - window.i0]
        return out

    def spline(self, c: Array, window: LatticeWindow, dx: bool, dy: bool) -> Array:
        """Evaluate a spline; see `Positions.spline`."""
        wx, wy = _taps(self.fx, dx), _taps(self.fy, dy)
        column, row = self.i - window.i0, self.j - window.j0

        def row_values(r: Array) -> Array:
            total = c[r, column - 1] * wx[0]
            for t in (1, 2, 3):
                total += c[r, column + (t - 1)] * wx[t]
            summed: Array = total
            return summed

        out = row_values(row - 1) * wy[0]
        for t in (1, 2, 3):
            out += row_values(row + (t - 1)) * wy[t]
        return out


class TileCells(PointCells):
    """Cells under blocks of equal shape: `i` has shape (tiles, 1, columns), `j` (tiles, rows, 1)."""

    def spline(self, c: Array, window: LatticeWindow, dx: bool, dy: bool) -> Array:
        """Evaluate a spline; see `Positions.spline`."""
        wx, wy = _taps(self.fx[:, 0], dx), _taps(self.fy, dy)
        column, row = self.i[:, 0] - window.i0, self.j[..., 0] - window.j0
        tile = np.arange(self.shape[0])[:, None]
        rows = c[:, column - 1] * wx[0]
        for t in (1, 2, 3):
            rows += c[:, column + (t - 1)] * wx[t]
        out: Array = rows[row - 1, tile] * wy[0]
        for t in (1, 2, 3):
            out += rows[row + (t - 1), tile] * wy[t]
        return out


def _split(position: Array, shift: int) -> tuple[Array, Array]:
    """Split positions, integers plus 1/2, into cells of ``2**shift`` and fractions of them."""
    cell = position >> shift
    inside = position - (cell << shift)
    return cell, ((inside + 0.5) / float(1 << shift)).astype(np.float32)


@lru_cache(maxsize=64)
def _centres_m(first: int, count: int, pixel_m: float) -> Array:
    """Metres from a tile's edge to the centres of some pixels."""
    return ((np.arange(first, first + count) + 0.5) * pixel_m).astype(np.float32)


class Grid(Positions):
    """The centres of a tile's pixels."""

    def __init__(self, zoom: int, x: int, y: int) -> None:
        self.zoom, self.x, self.y = zoom, x, y
        self.block = LatticeWindow(zoom + 8, x * TILE_PX, y * TILE_PX, TILE_PX, TILE_PX)
        self.shape = (self.block.rows, self.block.columns)
        self._cells = {}

    def local_m(self) -> tuple[Array, Array]:
        """Metres east and south of the tile's corner; see `Positions.local_m`."""
        left, top = self.block.i0 - self.x * TILE_PX, self.block.j0 - self.y * TILE_PX
        east, south = (
            _centres_m(first, count, self.pixel_m)
            for first, count in ((left, self.block.columns), (top, self.block.rows))
        )
        return east, south[:, None]

    def _locate(self, level: int, shifted: bool) -> LatticeCells:
        shift = self.block.level - level
        if shift < 0:
            raise ValueError(f"cells {2.0**shift} pixels wide, smaller than a pixel")
        per_cell = 1 << shift
        half = per_cell >> 1 if shifted else 0
        i, x = divmod(self.block.i0 + half, per_cell)
        j, y = divmod(self.block.j0 + half, per_cell)
        rows = self.block.rows if y or self.block.rows % per_cell else per_cell
        return GridCells(level, (i, j), _Axis(x, self.block.columns, shift), _Axis(y, rows, shift), self.shape)


class TilePositions(Positions):
    """The centres of the cells of `level` in several tiles and in a margin of one cell, relative to each tile's corner.

    The shape is (tiles, rows, columns); `x`, `y` are the first tile's. Results equal those of one tile after the other
    to the last bit, with one NumPy call in place of many.

    Parameters
    ----------
    x, y : int64 arrays (n,)
        The tiles.
    level : int
        Level of the cells, ``zoom`` or finer.
    """

    def __init__(self, zoom: int, x: Array, y: Array, level: int) -> None:
        self.zoom, self.x, self.y, self.level = zoom, int(x[0]), int(y[0]), level
        self._tile_x, self._tile_y = x[:, None, None], y[:, None, None]
        count = 1 << (level - zoom)
        steps = np.arange(-1, count + 1, dtype=np.int64)
        self.columns = self._tile_x * count + steps[None, None, :]
        self.rows = self._tile_y * count + steps[None, :, None]
        self.shape = (x.size, steps.size, steps.size)
        self._cells = {}

    @property
    def origin_m(self) -> tuple[float | Array, float | Array]:
        """The tiles' corners, shape (tiles, 1, 1); see `Positions.origin_m`."""
        return self._tile_x * TILE_PX * self.pixel_m, self._tile_y * TILE_PX * self.pixel_m

    def local_m(self) -> tuple[Array, Array]:
        """Metres east and south of each tile's corner; see `Positions.local_m`."""
        step, scale = self.pixel_m, 2.0 ** (self.zoom + 8 - self.level)
        east = ((self.columns + 0.5) * scale - self._tile_x * TILE_PX) * step
        south = ((self.rows + 0.5) * scale - self._tile_y * TILE_PX) * step
        return east.astype(np.float32), south.astype(np.float32)

    def _locate(self, level: int, shifted: bool) -> LatticeCells:
        shift = self.level - level
        half = (1 << shift) >> 1 if shifted else 0
        column, fx = _split(self.columns + half, shift)
        row, fy = _split(self.rows + half, shift)
        return TileCells(level, column, row, fx, fy, self.shape)


class ScatteredPositions(Positions):
    """Scattered positions in one tile: `u`, `v` are float64 world fractions from the north-west corner."""

    def __init__(self, zoom: int, x: int, y: int, u: Array, v: Array) -> None:
        self.zoom, self.x, self.y, self.u, self.v = zoom, x, y, u, v
        self.shape = u.shape
        self._cells = {}

    def local_m(self) -> tuple[Array, Array]:
        """Metres east and south of the tile's corner; see `Positions.local_m`."""
        scale, step = float(TILE_PX << self.zoom), self.pixel_m
        east = (self.u * scale - self.x * TILE_PX) * step
        south = (self.v * scale - self.y * TILE_PX) * step
        return east.astype(np.float32), south.astype(np.float32)

    def _locate(self, level: int, shifted: bool) -> LatticeCells:
        scale, half = float(1 << level), 0.5 if shifted else 0.0
        column, row = self.u * scale + half, self.v * scale + half
        i, j = np.floor(column), np.floor(row)
        fx, fy = (column - i).astype(np.float32), (row - j).astype(np.float32)
        return PointCells(level, i.astype(np.int64), j.astype(np.int64), fx, fy, self.shape)


class _SharedResult(Generic[Result]):
    """A result, computed by the thread that holds the lock."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.results: list[Result] = []


def shared(count: int) -> Callable[[Callable[..., Result]], Callable[..., Result]]:
    """Remember the last `count` results of a function of hashable arguments, as `lru_cache` does.

    Threads that need the same result at the same time wait for the one that computes it; with `lru_cache` each would
    compute it.
    """

    def remember(function: Callable[..., Result]) -> Callable[..., Result]:
        entries: OrderedDict[tuple[Hashable, ...], _SharedResult[Result]] = OrderedDict()
        guard = threading.Lock()

        @wraps(function)
        def cached(*arguments: Any) -> Result:
            with guard:
                entry = entries.get(arguments)
                if entry is None:
                    entry = entries[arguments] = _SharedResult()
                    if len(entries) > count:
                        entries.popitem(last=False)
                else:
                    entries.move_to_end(arguments)
            if not entry.results:
                with entry.lock:
                    if not entry.results:
                        entry.results.append(function(*arguments))
            return entry.results[0]

        return cached

    return remember


def group_points(u: Array, v: Array, zoom: Array) -> Iterator[tuple[Array, ScatteredPositions]]:
    """Group points by the tiles of their zooms; yield the indices and positions of each group."""
    x, y = np.floor(u * 2.0**zoom).astype(np.int64), np.floor(v * 2.0**zoom).astype(np.int64)
    key = (zoom << 44) | (y << 22) | x
    order = np.argsort(key, kind="stable")
    starts = np.flatnonzero(np.diff(key[order], prepend=-1))
    for at in np.split(order, starts[1:]):
        if at.size:
            first = at[0]
            yield at, ScatteredPositions(int(zoom[first]), int(x[first]), int(y[first]), u[at], v[at])
