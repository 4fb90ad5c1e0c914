"""Relief below a path: heights at places, and profiles below legs, whole or in squares that are read as needed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from ...arrays import Floats, Numbers
from ...geodesy.ellipsoid import WGS84
from ...geodesy.projections import LocalPlane
from ...geodesy.raytracing.surface import Surface
from ..flight.legs import legs
from .ground import Profile

#: Pieces of legs that are straight on any map, metres: to 3 mm at 60 degrees of latitude.
_PIECE_M = 250.0
#: Cells along a side of the squares that larger areas are read in, and squares that are kept: 200 MB.
_SIDE_CELLS, _SQUARES = 1024, 16


class Overflown:
    """Relief below a path that goes beyond the captures.

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
        """Heights of the ground at positions (n,); NaN where there is none."""
        return self._ground.heights(*self._ground.position(lat_deg, lon_deg))

    def highest_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Greatest height within the clearance's distance of positions (n,); minus infinity where there is none.

        It looks a cell farther than that, as places between the nodes of a profile have to keep it, too.
        """
        return self._highest(self._near, lat_deg, lon_deg)

    def highest_within_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Greatest height of the surface at positions (n,) and of its pixels within the clearance's distance, a square.

        Minus infinity where there is none.
        """
        return self._highest(self._within, lat_deg, lon_deg)

    @cached_property
    def _within(self) -> Callable[[Floats, Floats], Floats] | None:
        if not self._distance_m:
            return None
        # Half a cell lies between a place and its nearest pixel.
        return _highest_of(self._surface, math.floor(self._distance_m / self.cell_m + 0.5))

    def _highest(self, near: Callable[[Floats, Floats], Floats] | None, lat_deg: Floats, lon_deg: Floats) -> Floats:
        found = self._surface.heights(*self._surface.position(lat_deg, lon_deg))
        if near is not None:
            found = np.fmax(found, near(lat_deg, lon_deg))
        return np.where(np.isnan(found), -np.inf, found)

    def profiles(self, lat_deg: Floats, lon_deg: Floats, plane: LocalPlane) -> Iterator[Profile]:
        """Profiles below straight legs from position to position (n,), of as many at a time as memory is for."""
        way_m = np.append(0.0, np.cumsum(legs(lat_deg, lon_deg).distance_m))
        # 250,000 cells at a time bound the memory.
        blocks = np.unique(way_m // (250_000 * self.cell_m), return_index=True)[1]
        for first, last in zip(blocks, np.append(blocks[1:], len(lat_deg) - 1)):
            if last > first:
                some = slice(first, last + 1)
                yield self.profile(lat_deg[some], lon_deg[some], plane, int(first))

    def profile(self, lat_deg: Floats, lon_deg: Floats, plane: LocalPlane, first: int = 0) -> Profile:
        """Profile below straight legs of a plane from position to position (n,); the first leg has a number.

        Nodes are where legs cross the lines between pixels' centres, and half-way between those: there is one
        parabola from crossing to crossing, and what a leg has to be higher than half-way is where its tangents meet.
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
        heights = self._surface.heights(values[2], values[3])
        halves = np.flatnonzero(at >= len(at) - len(half))
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
        )


class OverflownInParts(Overflown):
    """The same of a path over more than one surface holds at its finest: of squares, read as they are needed.

    Parameters
    ----------
    read : callable
        Relief about positions (n,), and so many metres around them.
    cell_m : float
        Size of the finest cells.

    Attributes
    ----------
    side_m : float
        Of a square.
    """

    def __init__(self, read: Callable[[Floats, Floats, float], Overflown], cell_m: float) -> None:
        self.cell_m = cell_m
        self.side_m = _SIDE_CELLS * cell_m
        self._side_deg = math.degrees(self.side_m / WGS84.b_m)
        self._square = lru_cache(maxsize=_SQUARES)(self._read)
        self._about = read

    def _read(self, row: int, column: int) -> Overflown:
        lat = self._side_deg * np.array([row, row + 1.0])
        lon = float(self._wide_deg(np.array(row))) * np.array([column, column + 1.0])
        # Pieces of legs whose middle is in the square lie within.
        return self._about(np.clip(lat, -90.0, 90.0), lon, _PIECE_M)

    def _wide_deg(self, row: Numbers) -> Floats:
        middle = np.radians(self._side_deg * (row + 0.5))
        wide: Floats = self._side_deg / np.maximum(np.cos(middle), 1e-3)
        return wide

    def _squares(self, lat_deg: Floats, lon_deg: Floats) -> Numbers:
        """Row and column of the square that each position (n,) lies in, (n, 2)."""
        row = np.floor(lat_deg / self._side_deg).astype(np.int64)
        return np.stack([row, np.floor(lon_deg / self._wide_deg(row)).astype(np.int64)], axis=1)

    def ground_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Heights of the ground at positions (n,); NaN where there is none."""
        return self._gathered(Overflown.ground_m, lat_deg, lon_deg)

    def highest_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Greatest height within the clearance's distance and a cell; minus infinity where there is none."""
        return self._gathered(Overflown.highest_m, lat_deg, lon_deg)

    def highest_within_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Greatest height within the clearance's distance; minus infinity where there is none."""
        return self._gathered(Overflown.highest_within_m, lat_deg, lon_deg)

    def _gathered(
        self, find: Callable[[Overflown, Floats, Floats], Floats], lat_deg: Floats, lon_deg: Floats
    ) -> Floats:
        found = np.empty(len(lat_deg))
        squares, which = np.unique(self._squares(lat_deg, lon_deg), axis=0, return_inverse=True)
        for number, square in enumerate(squares.tolist()):
            at = np.flatnonzero(which.ravel() == number)
            found[at] = find(self._square(*square), lat_deg[at], lon_deg[at])
        return found

    def profile(self, lat_deg: Floats, lon_deg: Floats, plane: LocalPlane, first: int = 0) -> Profile:
        """Profile below straight legs of a plane from position to position (n,); the first leg has a number."""
        x, y = plane.forward(lat_deg, lon_deg)
        leg, begin, pieces = _pieces(x, y)
        start = [at[leg] + begin * (at[leg + 1] - at[leg]) for at in (x, y)]
        half = 0.5 / pieces[leg]
        middle = [at + half * (whole[leg + 1] - whole[leg]) for at, whole in zip(start, (x, y))]
        square = self._squares(*plane.inverse(*middle))
        lat, lon = (np.append(at, end[-1]) for at, end in zip(plane.inverse(*start), (lat_deg, lon_deg)))
        found = []
        for run in np.split(np.arange(len(leg)), np.flatnonzero(np.diff(square, axis=0).any(axis=1)) + 1):
            ends = slice(run[0], run[-1] + 2)
            part = self._square(*square[run[0]].tolist()).profile(lat[ends], lon[ends], plane)
            piece = run[part.leg]
            share = begin[piece] + part.share / pieces[leg[piece]]
            found.append(part._replace(leg=leg[piece] + first, share=share))
        return Profile(*(np.concatenate(column) for column in zip(*found)))


def _pieces(x: Floats, y: Floats) -> tuple[Numbers, Floats, Numbers]:
    """Pieces of legs between places (n,) of a plane: the leg of each, its begin on that, and how many each leg has."""
    pieces = np.maximum(np.ceil(np.hypot(np.diff(x), np.diff(y)) / _PIECE_M), 1.0).astype(np.int64)
    leg = np.repeat(np.arange(len(pieces)), pieces)
    begin = (np.arange(len(leg)) - np.repeat(np.cumsum(pieces) - pieces, pieces)) / pieces[leg]
    return leg, begin, pieces


def _crossings(column: Floats, row: Floats) -> tuple[Numbers, Floats]:
    """Where straight pieces from place to place (n,) cross whole columns and rows: number of the piece, and share.

    Beginning and end of each piece are among them.
    """
    count = len(column) - 1
    pieces, shares = [np.arange(count), np.arange(count)], [np.zeros(count), np.ones(count)]
    for at in (column, row):
        low, high = np.minimum(at[:-1], at[1:]), np.maximum(at[:-1], at[1:])
        first = np.floor(low).astype(np.int64) + 1
        number = np.maximum(np.ceil(high).astype(np.int64) - first, 0)
        piece = np.repeat(np.arange(count), number)
        line = np.arange(len(piece)) - np.repeat(np.cumsum(number) - number, number) + first[piece]
        pieces.append(piece)
        shares.append((line - at[piece]) / (at[piece + 1] - at[piece]))
    piece, share = np.concatenate(pieces), np.clip(np.concatenate(shares), 0.0, 1.0)
    order = np.lexsort((share, piece))
    return piece[order], share[order]


def cell_size_m(surface: Surface) -> float:
    """Size of a surface's cells in its middle."""
    lat, lon = surface.places(*(np.array([side / 2.0]) for side in surface.cells[::-1]))
    return float(surface.grid.ground_m_per_px(lat, lon, surface.zoom)[0])


def highest_around(surface: Surface, radius_m: float) -> Callable[[Floats, Floats], Floats]:
    """For positions (n,), the greatest height of a surface within a distance; NaN where it has none there."""
    return _highest_of(surface, math.ceil(radius_m / cell_size_m(surface)) + 1)


def _highest_of(surface: Surface, reach: int) -> Callable[[Floats, Floats], Floats]:
    """For positions (n,), the greatest height of a surface's pixels up to so many from the nearest one."""
    top = np.where(np.isnan(surface.heights_m), -np.inf, surface.heights_m).astype(np.float32)
    for axis in (0, 1):
        top = _running_max(top, min(reach, top.shape[axis] - 1), axis)

    def highest(lat_deg: Floats, lon_deg: Floats) -> Floats:
        column, row = surface.position(lat_deg, lon_deg)
        i = np.clip(np.rint(row), 0, top.shape[0] - 1).astype(np.int64)
        j = np.clip(np.rint(column), 0, top.shape[1] - 1).astype(np.int64)
        found = top[i, j].astype(np.float64)
        return np.where(np.isfinite(found), found, np.nan)

    return highest


def lowest_around(surface: Surface, radius_m: float) -> Callable[[Floats, Floats], Floats]:
    """The same of least heights."""
    highest = highest_around(replace(surface, heights_m=-surface.heights_m), radius_m)
    return lambda lat_deg, lon_deg: -highest(lat_deg, lon_deg)


def _running_max(values: NDArray[np.float32], reach: int, axis: int) -> NDArray[np.float32]:
    """Greatest of values up to ``reach`` to either side along an axis."""
    if reach <= 0:
        return values
    width = 2 * reach + 1
    pad = [(0, 0), (0, 0)]
    pad[axis] = (reach, reach)
    found = np.pad(values, pad, constant_values=-np.inf)

    def part(begin: int, end: int) -> tuple[slice, ...]:
        along = slice(begin, end)
        return (along, slice(None)) if axis == 0 else (slice(None), along)

    covered = 1
    while covered < width:
        step = min(covered, width - covered)
        size = found.shape[axis]
        found = np.maximum(found[part(0, size - step)], found[part(step, size)])
        covered += step
    return found
