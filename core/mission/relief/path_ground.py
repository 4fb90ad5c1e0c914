"""Relief below a path: heights at positions and profiles below legs, read at once or in tiles as needed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cached_property, lru_cache

import numpy as np

from ...arrays import Floats, NDArray, Numbers, expand_counts
from ...geodesy.ellipsoid import WGS84
from ...geodesy.projections import LocalPlane
from ...geodesy.raytracing.surface import Surface
from ..flight.legs import legs
from .ground import Profile

#: Legs are divided into pieces of this length, which are straight on any map to 3 mm at 60 degrees of latitude.
_PIECE_M = 250.0
#: Cells along a side of the tiles in which large areas are read.
_TILE_CELLS = 1024
#: Positions whose heights are looked up together, which bounds memory.
BATCH = 1 << 16
#: Pixels that a running maximum passes in the time that one position takes by itself, however few pixels it looks at.
_PIXELS_PER_CALL = 300


class ReliefPathGround:
    """Relief below a path, a `PathGround`.

    Parameters
    ----------
    ground, surface : Surface
    clearance_distance_m : float
    """

    def __init__(self, ground: Surface, surface: Surface, clearance_distance_m: float) -> None:
        self._ground, self._surface = ground, surface
        self.cell_m = cell_size_m(surface)
        self._distance_m = clearance_distance_m
        self._near = highest_around(surface, clearance_distance_m) if clearance_distance_m else None

    def ground_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Heights of the ground at positions (n,); NaN where unknown."""
        return self._ground.heights(*self._ground.position(lat_deg, lon_deg))

    def highest_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Greatest height within the clearance's distance of positions (n,); minus infinity where unknown.

        The search reaches a cell farther, so that the clearance also holds between the nodes of a profile.
        """
        return self._highest(self._near, lat_deg, lon_deg)

    def highest_within_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Greatest height of the surface at positions (n,) and of its pixels in a square of the clearance's distance.

        Minus infinity where unknown.
        """
        return self._highest(self._nearby_pixels, lat_deg, lon_deg)

    @cached_property
    def _nearby_pixels(self) -> Callable[[Floats, Floats], Floats] | None:
        if not self._distance_m:
            return None
        # A position is up to half a cell from its nearest pixel.
        return _highest_pixels(self._surface, math.floor(self._distance_m / self.cell_m + 0.5))

    def _highest(self, near: Callable[[Floats, Floats], Floats] | None, lat_deg: Floats, lon_deg: Floats) -> Floats:
        found = self._surface.heights(*self._surface.position(lat_deg, lon_deg))
        if near is not None:
            found = np.fmax(found, near(lat_deg, lon_deg))
        return np.where(np.isnan(found), -np.inf, found)

    def profiles(self, lat_deg: Floats, lon_deg: Floats, plane: LocalPlane) -> Iterator[Profile]:
        """Profiles below straight legs from position to position (n,), in blocks that bound the memory."""
        way_m = np.append(0.0, np.cumsum(legs(lat_deg, lon_deg).distance_m))
        # Blocks cross about 250,000 cells each.
        blocks = np.unique(way_m // (250_000 * self.cell_m), return_index=True)[1]
        for first, last in zip(blocks, np.append(blocks[1:], len(lat_deg) - 1)):
            if last > first:
                some = slice(first, last + 1)
                yield self.profile(lat_deg[some], lon_deg[some], plane, int(first))

    def profile(self, lat_deg: Floats, lon_deg: Floats, plane: LocalPlane, first: int = 0) -> Profile:
        """Profile below straight legs of a plane from position to position (n,); ``first`` numbers the first leg.

        Nodes are the crossings of legs with the lines through pixel centres, and the midpoints between crossings. From
        crossing to crossing the surface below a leg is a parabola, whose tangents at both ends meet at the midpoint: a
        leg that is no lower than this intersection is nowhere below the parabola.
        """
        x, y = plane.forward(lat_deg, lon_deg)
        leg, begin, pieces = _pieces(x, y)
        lat, lon = plane.inverse(*(a[leg] + begin * (a[leg + 1] - a[leg]) for a in (x, y)))
        ends = np.append(lat, lat_deg[-1]), np.append(lon, lon_deg[-1])
        column, row = self._surface.position(*ends)
        piece, along = _crossings(column, row)
        half = np.flatnonzero(np.diff(piece) == 0)
        middle = (along[half] + along[half + 1]) / 2.0
        at = np.argsort(np.append(np.arange(len(piece)), half + 0.5), kind="stable")
        piece, along = np.append(piece, piece[half])[at], np.append(along, middle)[at]
        ground = self._ground.position(*ends)
        values = [a[piece] + along * (a[piece + 1] - a[piece]) for a in (*ends, column, row, *ground)]
        surface = self._surface.heights(values[2], values[3])
        heights = surface.copy()
        is_middle = at >= len(at) - len(half)
        halves = np.flatnonzero(is_middle)
        bulge = heights[halves] - (heights[halves - 1] + heights[halves + 1]) / 2.0
        heights[halves] += np.maximum(np.where(np.isnan(bulge), 0.0, bulge), 0.0)
        if self._near is not None:
            heights = np.fmax(heights, self._near(values[0], values[1]))
        return Profile(
            leg[piece] + first,
            begin[piece] + along / pieces[leg[piece]],
            values[0],
            values[1],
            np.where(np.isnan(heights), -np.inf, heights),
            self._ground.heights(values[4], values[5]),
            surface,
            is_middle,
        )


class TiledPathGround(ReliefPathGround):
    """Relief below a path too long for one surface at the finest resolution, in square tiles that are read as needed.

    Parameters
    ----------
    read : callable
        Returns the relief within some metres of positions (n,).
    cell_m : float
        Size of the finest cells.

    Attributes
    ----------
    side_m : float
        Side of a tile.
    """

    def __init__(self, read: Callable[[Floats, Floats, float], ReliefPathGround], cell_m: float) -> None:
        self.cell_m = cell_m
        self.side_m = _TILE_CELLS * cell_m
        self._side_deg = math.degrees(self.side_m / WGS84.b_m)
        # 16 tiles take 200 MB.
        self._tile = lru_cache(maxsize=16)(self._read)
        self._relief = read

    def _read(self, row: int, column: int) -> ReliefPathGround:
        """Read a tile."""
        lat = self._side_deg * np.array([row, row + 1.0])
        lon = float(self._width_deg(np.array(row))) * np.array([column, column + 1.0])
        # With this room, the relief contains every piece of a leg whose midpoint is in the tile.
        return self._relief(np.clip(lat, -90.0, 90.0), lon, _PIECE_M)

    def _width_deg(self, row: Numbers) -> Floats:
        """Widths of the tiles of rows, in degrees of longitude."""
        middle = np.radians(self._side_deg * (row + 0.5))
        # The bound keeps tiles at the poles below a full turn.
        width: Floats = self._side_deg / np.maximum(np.cos(middle), 1e-3)
        return width

    def _tile_numbers(self, lat_deg: Floats, lon_deg: Floats) -> Numbers:
        """Row and column of the tile that holds each position (n,), (n, 2)."""
        row = np.floor(lat_deg / self._side_deg).astype(np.int64)
        return np.stack([row, np.floor(lon_deg / self._width_deg(row)).astype(np.int64)], axis=1)

    def ground_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Heights of the ground at positions (n,); NaN where unknown."""
        return self._gather(ReliefPathGround.ground_m, lat_deg, lon_deg)

    def highest_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Greatest height within the clearance's distance and a cell; minus infinity where unknown."""
        return self._gather(ReliefPathGround.highest_m, lat_deg, lon_deg)

    def highest_within_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Greatest height within the clearance's distance; minus infinity where unknown."""
        return self._gather(ReliefPathGround.highest_within_m, lat_deg, lon_deg)

    def _gather(
        self, find: Callable[[ReliefPathGround, Floats, Floats], Floats], lat_deg: Floats, lon_deg: Floats
    ) -> Floats:
        """Values at positions (n,), each found in the tile that contains the position."""
        found = np.empty(len(lat_deg))
        tiles, which = np.unique(self._tile_numbers(lat_deg, lon_deg), axis=0, return_inverse=True)
        for number, tile in enumerate(tiles.tolist()):
            at = np.flatnonzero(which.ravel() == number)
            found[at] = find(self._tile(*tile), lat_deg[at], lon_deg[at])
        return found

    def profile(self, lat_deg: Floats, lon_deg: Floats, plane: LocalPlane, first: int = 0) -> Profile:
        """Profile below straight legs of a plane from position to position (n,); ``first`` numbers the first leg."""
        x, y = plane.forward(lat_deg, lon_deg)
        leg, begin, pieces = _pieces(x, y)
        start = [at[leg] + begin * (at[leg + 1] - at[leg]) for at in (x, y)]
        half = 0.5 / pieces[leg]
        middle = [at + half * (whole[leg + 1] - whole[leg]) for at, whole in zip(start, (x, y))]
        tile = self._tile_numbers(*plane.inverse(*middle))
        lat, lon = (np.append(at, end[-1]) for at, end in zip(plane.inverse(*start), (lat_deg, lon_deg)))
        found = []
        for run in np.split(np.arange(len(leg)), np.flatnonzero(np.diff(tile, axis=0).any(axis=1)) + 1):
            ends = slice(run[0], run[-1] + 2)
            below = self._tile(*tile[run[0]].tolist()).profile(lat[ends], lon[ends], plane)
            piece = run[below.leg]
            share = begin[piece] + below.share / pieces[leg[piece]]
            found.append(below._replace(leg=leg[piece] + first, share=share))
        return Profile(*(np.concatenate(column) for column in zip(*found)))


def _pieces(x: Floats, y: Floats) -> tuple[Numbers, Floats, Numbers]:
    """Pieces of legs between points (n,) of a plane: leg and start (share of the leg) of each, and count per leg."""
    pieces = np.maximum(np.ceil(np.hypot(np.diff(x), np.diff(y)) / _PIECE_M), 1.0).astype(np.int64)
    leg, number = expand_counts(pieces)
    return leg, number / pieces[leg], pieces


def _crossings(column: Floats, row: Floats) -> tuple[Numbers, Floats]:
    """Crossings of straight pieces, from point to point (n,), with whole columns and rows: piece, share of the piece.

    The ends of each piece are included.
    """
    count = len(column) - 1
    pieces, shares = [np.arange(count), np.arange(count)], [np.zeros(count), np.ones(count)]
    for at in (column, row):
        low, high = np.minimum(at[:-1], at[1:]), np.maximum(at[:-1], at[1:])
        first = np.floor(low).astype(np.int64) + 1
        number = np.maximum(np.ceil(high).astype(np.int64) - first, 0)
        piece, line = expand_counts(number)
        line = line + first[piece]
        pieces.append(piece)
        shares.append((line - at[piece]) / (at[piece + 1] - at[piece]))
    piece, share = np.concatenate(pieces), np.clip(np.concatenate(shares), 0.0, 1.0)
    order = np.lexsort((share, piece))
    return piece[order], share[order]


def cell_size_m(surface: Surface) -> float:
    """Size of the cells in the middle of a surface."""
    lat, lon = surface.places(*(np.array([side / 2.0]) for side in surface.cells[::-1]))
    return float(surface.grid.ground_m_per_px(lat, lon, surface.zoom)[0])


def highest_around(surface: Surface, radius_m: float) -> Callable[[Floats, Floats], Floats]:
    """Function that returns the greatest height within a distance of positions (n,); NaN where unknown."""
    return _highest_pixels(surface, math.ceil(radius_m / cell_size_m(surface)) + 1)


def _highest_pixels(surface: Surface, reach: int) -> Callable[[Floats, Floats], Floats]:
    """Function that returns the greatest height of pixels up to ``reach`` from the nearest one to positions (n,)."""
    heights = surface.heights_m

    @lru_cache(maxsize=1)
    def tops() -> NDArray[np.float32]:
        """Greatest heights around all pixels; minus infinity where unknown."""
        top = np.where(np.isnan(heights), -np.inf, heights).astype(np.float32)
        for axis in (0, 1):
            top = _running_max(top, min(reach, top.shape[axis] - 1), axis)
        return top

    def around(row: int, column: int) -> np.float32:
        """Greatest height around one pixel; NaN where unknown."""
        near = heights[max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1]
        return np.float32(np.fmax.reduce(near, axis=None))

    # Few positions are cheaper one by one.
    few = heights.size // max(min((2 * reach + 1) ** 2, heights.size), _PIXELS_PER_CALL)

    def highest(lat_deg: Floats, lon_deg: Floats) -> Floats:
        found = np.empty(len(lat_deg))
        for start in range(0, len(found), BATCH):
            some = slice(start, start + BATCH)
            column, row = surface.position(lat_deg[some], lon_deg[some])
            i = np.clip(np.rint(row), 0, heights.shape[0] - 1).astype(np.int64)
            j = np.clip(np.rint(column), 0, heights.shape[1] - 1).astype(np.int64)
            if len(found) <= few:
                found[some] = [around(*at) for at in zip(i.tolist(), j.tolist())]
            else:
                found[some] = tops()[i, j]
        found[~np.isfinite(found)] = np.nan
        return found

    return highest


def lowest_around(surface: Surface, radius_m: float) -> Callable[[Floats, Floats], Floats]:
    """Function that returns the least height within a distance of positions (n,); NaN where unknown."""
    highest = highest_around(replace(surface, heights_m=-surface.heights_m), radius_m)
    return lambda lat_deg, lon_deg: -highest(lat_deg, lon_deg)


def _running_max(values: NDArray[np.float32], reach: int, axis: int) -> NDArray[np.float32]:
    """Running maximum over ``reach`` values to either side along an axis."""
    if reach <= 0:
        return values
    width = 2 * reach + 1
    pad = [(0, 0), (0, 0)]
    pad[axis] = (reach, reach)
    found = np.pad(values, pad, constant_values=-np.inf)

    def window(begin: int, end: int) -> tuple[slice, ...]:
        along = slice(begin, end)
        return (along, slice(None)) if axis == 0 else (slice(None), along)

    covered = 1
    while covered < width:
        step = min(covered, width - covered)
        size = found.shape[axis]
        found = np.maximum(found[window(0, size - step)], found[window(step, size)])
        covered += step
    return found
