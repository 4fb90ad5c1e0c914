"""Coverage of an area by pictures, overlap of neighbours, and the extent of the source's imagery."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...arrays import Floats, Numbers, expand_counts
from ...geodesy.ellipsoid import WGS84
from ...geodesy.frames import Windows
from ...geodesy.mercator import PixelGrid, lat_to_v, lon_to_u, u_to_lon, v_to_lat
from ..areas.area import (
    Area,
    Box,
    PlacedRings,
    Polygon,
    Polygons,
    Rings,
    area_within_m2,
    shared_rings,
)

#: Strips per chunk, which bounds the memory for any number of rectangles.
_CHUNK = 250_000
#: Rectangles whose gaps are found at a time, which bounds the memory, too.
_BAND = 1 << 17
#: Missing shares of the area below this are rounding between two ways to compute areas.
_NOTHING_MISSING = 1e-9


@dataclass(frozen=True)
class Coverage:
    """Coverage of an area by pictures, without its no-fly areas.

    Parameters
    ----------
    area_m2 : float
        Ground of the area outside no-fly areas.
    uncovered_m2 : float
        Part of this ground that no picture shows.
    complete : bool
    no_fly_m2 : float
        Ground of the area inside no-fly areas, whether pictures show it or not.
    """

    area_m2: float
    uncovered_m2: float
    complete: bool
    no_fly_m2: float = 0.0

    def without(self, held: Sequence[Coverage]) -> Coverage:
        """Coverage without the disjoint parts ``held`` that lie in no-fly areas."""
        if not held:
            return self
        inside = summed(held)
        area_m2 = max(self.area_m2 - inside.area_m2, 0.0)
        uncovered_m2 = min(self.uncovered_m2 - inside.uncovered_m2, area_m2)
        complete = self.complete or uncovered_m2 <= _NOTHING_MISSING * self.area_m2
        # In a plane, sides of the parts bend differently from sides of the whole area.
        complete |= area_m2 <= 1e-8 * self.area_m2
        return Coverage(area_m2, 0.0 if complete else uncovered_m2, complete, inside.area_m2)

    @property
    def share(self) -> float:
        """Covered share of the area outside no-fly areas in [0, 1], rounded down; 1 only where nothing is missing."""
        if self.complete:
            return 1.0
        covered = 1.0 - self.uncovered_m2 / self.area_m2 if self.area_m2 > 0.0 else 0.0
        # Rounded down, so that 100 % is complete coverage.
        unit = 10.0**6
        return max(min(math.floor(covered * unit) / unit, 1.0 - 1.0 / unit), 0.0)


def summed(found: Sequence[Coverage]) -> Coverage:
    """Coverage of several areas together."""
    if len(found) == 1:
        return found[0]
    return Coverage(
        sum(one.area_m2 for one in found),
        sum(one.uncovered_m2 for one in found),
        all(one.complete for one in found),
        sum(one.no_fly_m2 for one in found),
    )


@dataclass(frozen=True)
class Overlap:
    """Shares of pictures that their neighbours also show, negative for gaps; None without neighbours.

    Along: from picture to picture in a row; across: from row to row.
    """

    least_along: float | None
    median_along: float | None
    least_across: float | None
    median_across: float | None


class Rectangles(NamedTuple):
    """Rectangles as edges, arrays (n,): half open, x east and y south."""

    x0: Floats
    y0: Floats
    x1: Floats
    y1: Floats


def joined(rectangles: Rectangles) -> Rectangles:
    """Rectangles (n,), n >= 1, with consecutive ones merged where they touch side by side."""
    left, top, right, bottom = rectangles
    neighbours = np.zeros(len(left), bool)
    neighbours[1:] = (
        (top[1:] == top[:-1]) & (bottom[1:] == bottom[:-1]) & (left[1:] <= right[:-1]) & (left[:-1] <= right[1:])
    )
    first = np.flatnonzero(~neighbours)
    return Rectangles(np.minimum.reduceat(left, first), top[first], np.maximum.reduceat(right, first), bottom[first])


def _reached(strip: Numbers, end: Floats) -> Floats:
    """Greatest end of the previous pieces in each piece's strip (-inf for the first); pieces are sorted by strip.

    This is a running maximum of ranks, offset by strip: ranks keep the edges exact.
    """
    values, rank = np.unique(end, return_inverse=True)
    lift = strip * len(values)
    running = np.maximum.accumulate(lift + rank)
    before = np.full(len(end), -np.inf)
    same = strip[1:] == strip[:-1]
    before[1:][same] = values[(running[:-1] - lift[:-1])[same]]
    return before


def _pieces(rectangles: Rectangles, first: Numbers, last: Numbers) -> tuple[Numbers, Floats, Floats]:
    """Strip, start and end of every rectangle's piece in each of its strips ``first`` to ``last`` (excluded)."""
    owner, strip = _expand_ranges(first, last)
    return strip, rectangles.x0[owner], rectangles.x1[owner]


def _chunks(first: Numbers, last: Numbers, strips: int) -> list[tuple[int, int]]:
    """Ranges of strips that hold a bounded number of pieces each."""
    change = np.bincount(first, minlength=strips + 1) - np.bincount(last, minlength=strips + 1)
    pieces = np.cumsum(np.cumsum(change)[:strips] + 2)
    cuts = np.searchsorted(pieces, np.arange(_CHUNK, pieces[-1], _CHUNK)).tolist() if strips else []
    bounds = [0, *cuts, strips]
    return [(start, stop) for start, stop in zip(bounds, bounds[1:]) if stop > start]


def gaps(rectangles: Rectangles, within: tuple[float, float, float, float]) -> Rectangles:
    """Gaps that rectangles leave in ``within`` (x0, y0, x1, y1), as rectangles.

    Gaps are found cell by cell in a grid of about the rectangles' average size, so that the work is linear in the
    number of rectangles unless many overlap. Nothing is rounded: edges of cells are additional cuts.
    """
    west, north, east, south = within
    x0, x1 = (np.clip(x, west, east) for x in (rectangles.x0, rectangles.x1))
    y0, y1 = (np.clip(y, north, south) for y in (rectangles.y0, rectangles.y1))
    held = (x1 > x0) & (y1 > y0)
    clipped = Rectangles(x0[held], y0[held], x1[held], y1[held])
    if not (east > west and south > north):
        return Rectangles(*np.empty((4, 0)))
    if not held.any():
        return Rectangles(*(np.array([edge]) for edge in within))
    cells = _Cells.under(clipped, within)
    found = [cells.unoccupied(), *cells.gaps(clipped)]
    return Rectangles(*(np.concatenate(edges) for edges in zip(*found)))


def gaps_by_band(rectangles: Rectangles, within: tuple[float, float, float, float]) -> Iterator[Rectangles]:
    """Gaps of `gaps`, cut at the edges of bands with a bounded number of rectangles each."""
    west, north, east, south = within
    edges = np.linspace(north, south, len(rectangles.y0) // _BAND + 2).tolist()
    if len(edges) == 2:
        yield gaps(rectangles, within)
        return
    for top, bottom in zip(edges, edges[1:]):
        meets = (rectangles.y1 > top) & (rectangles.y0 < bottom)
        yield gaps(Rectangles(*(edge[meets] for edge in rectangles)), (west, top, east, bottom))


class _Cells(NamedTuple):
    """Grid over rectangles, with the pairs of cells and rectangles that overlap, sorted by cell.

    Attributes
    ----------
    x, y : array (columns + 1,), (rows + 1,)
    column, row : array (m,)
        Cell of each pair.
    owner : array (m,)
        Index of the rectangle of each pair.
    """

    x: Floats
    y: Floats
    column: Numbers
    row: Numbers
    owner: Numbers

    @classmethod
    def under(cls, rectangles: Rectangles, within: tuple[float, float, float, float]) -> _Cells:
        """Grid over rectangles that lie within bounds."""
        west, north, east, south = within
        x, first_x, last_x = _lines(rectangles.x0, rectangles.x1, west, east)
        y, first_y, last_y = _lines(rectangles.y0, rectangles.y1, north, south)
        owner, column = _expand_ranges(first_x, last_x)
        pair, row = _expand_ranges(first_y[owner], last_y[owner])
        column, owner = column[pair], owner[pair]
        order = np.argsort(row * len(x) + column, kind="stable")
        return cls(x, y, column[order], row[order], owner[order])

    def unoccupied(self) -> Rectangles:
        """Cells without a rectangle, merged along rows, and empty rows."""
        columns, rows = len(self.x) - 1, len(self.y) - 1
        new = np.append(True, (np.diff(self.row) > 0) | (np.diff(self.column) > 0))
        column, row = self.column[new], self.row[new]
        # Cells before each occupied cell of a row, and after the last.
        begins = np.append(True, row[1:] != row[:-1])
        ends = np.append(begins[1:], True)
        first = np.concatenate([np.where(begins, 0, np.append(0, column[:-1] + 1)), column[ends] + 1])
        last = np.concatenate([column, np.full(int(ends.sum()), columns)])
        top = np.concatenate([row, row[ends]])
        some = last > first
        first, last, top = first[some], last[some], top[some]
        used = np.concatenate([[-1], row[ends], [rows]])
        empty = np.flatnonzero(np.diff(used) > 1)
        return Rectangles(
            np.concatenate([self.x[first], np.full(len(empty), self.x[0])]),
            np.concatenate([self.y[top], self.y[used[empty] + 1]]),
            np.concatenate([self.x[last], np.full(len(empty), self.x[-1])]),
            np.concatenate([self.y[top + 1], self.y[used[empty + 1]]]),
        )

    def gaps(self, rectangles: Rectangles) -> Iterator[Rectangles]:
        """Gaps that rectangles leave in occupied cells, in blocks of cells."""
        new = np.append(True, (np.diff(self.row) > 0) | (np.diff(self.column) > 0))
        cell = np.cumsum(new) - 1
        column, row = self.column[new], self.row[new]
        bounds = Rectangles(self.x[column], self.y[row], self.x[column + 1], self.y[row + 1])
        x0, y0, x1, y1 = (edge[self.owner] for edge in rectangles)
        left, top, right, bottom = (edge[cell] for edge in bounds)
        whole = (x0 <= left) & (y0 <= top) & (x1 >= right) & (y1 >= bottom)
        hidden = np.zeros(len(column), bool)
        hidden[cell[whole]] = True
        not_hidden = ~hidden[cell]
        parts = Rectangles(
            np.maximum(x0, left)[not_hidden],
            np.maximum(y0, top)[not_hidden],
            np.minimum(x1, right)[not_hidden],
            np.minimum(y1, bottom)[not_hidden],
        )
        cell = cell[not_hidden]
        counts = np.bincount(cell, minlength=len(column))
        # A cell of k parts has up to 2 k + 1 strips, each of which may hold all of them.
        size = np.cumsum(counts * (2 * counts + 1))
        start = 0
        while start < len(counts):
            stop = max(int(np.searchsorted(size, (size[start - 1] if start else 0) + _CHUNK)), start + 1)
            some = slice(*np.searchsorted(cell, [start, stop]).tolist())
            cells = start + np.flatnonzero(~hidden[start:stop])
            if len(cells):
                some_parts = Rectangles(*(edge[some] for edge in parts))
                some_bounds = Rectangles(*(edge[cells] for edge in bounds))
                yield _gaps_in_cells(some_parts, cell[some], some_bounds, cells)
            start = stop


def _lines(low: Floats, high: Floats, least: float, most: float) -> tuple[Floats, Numbers, Numbers]:
    """Lines of a grid along one axis, and the first and last cell (excluded) of spans between them."""
    # Cells as wide as the average span, but at most four cells per span.
    count = min(math.ceil((most - least) / float(np.mean(high - low))), 4 * len(low))
    lines = np.linspace(least, most, count + 1)
    return lines, np.searchsorted(lines, low, "right") - 1, np.searchsorted(lines, high, "left")


def _expand_ranges(first: Numbers, last: Numbers) -> tuple[Numbers, Numbers]:
    """Numbers in the ranges ``first`` to ``last`` (excluded), with the index of the range of each."""
    owner, number = expand_counts(np.maximum(last - first, 0))
    return owner, first[owner] + number


def _gaps_in_cells(parts: Rectangles, cell: Numbers, bounds: Rectangles, cells: Numbers) -> Rectangles:
    """Gaps that parts leave in their cells, found in strips between the tops and bottoms of the parts.

    Parameters
    ----------
    parts : Rectangles
        Rectangles (m,) inside their cells.
    cell : array (m,)
        Cell number of each part.
    bounds : Rectangles
        Bounds (k,) of the cells.
    cells : array (k,)
        Cell numbers.
    """
    y = np.concatenate([parts.y0, parts.y1, bounds.y0, bounds.y1])
    owner = np.concatenate([cell, cell, cells, cells])
    order = np.lexsort((y, owner))
    y, owner = y[order], owner[order]
    new = np.append(True, (owner[1:] != owner[:-1]) | (y[1:] != y[:-1]))
    rank = np.empty(len(order), np.int64)
    rank[order] = np.cumsum(new) - 1
    y, owner = y[new], owner[new]
    # A strip has the number of its upper line; no strip begins at the last line of a cell.
    is_strip = np.append(owner[1:] == owner[:-1], False)
    at = np.searchsorted(cells, owner)
    west, east, below = bounds.x0[at], bounds.x1[at], np.append(y[1:], np.inf)
    count = len(parts.y0)
    strip, begin, end = _pieces(parts, rank[:count], rank[count : 2 * count])
    by_start = np.lexsort((begin, strip))
    strip, begin, end = strip[by_start], begin[by_start], end[by_start]
    reached = np.maximum(_reached(strip, end), west[strip])
    between = begin > reached
    last = np.append(strip[1:] != strip[:-1], True) if len(strip) else np.empty(0, bool)
    to, after = np.maximum(reached, end)[last], strip[last]
    ending = to < east[after]
    to, after = to[ending], after[ending]
    bare = np.flatnonzero(is_strip & (np.bincount(strip, minlength=len(y)) == 0))
    at = np.concatenate([strip[between], after, bare])
    return Rectangles(
        np.concatenate([reached[between], to, west[bare]]),
        y[at],
        np.concatenate([begin[between], east[after], east[bare]]),
        below[at],
    )


def coverage(
    area: Area,
    windows: Windows,
    grid: PixelGrid,
    zoom: int,
    no_fly: Sequence[Polygon] = (),
) -> Coverage:
    """Coverage of an area outside no-fly areas by windows; exact on the pixel grid for a box.

    Images of one polygon also count for the others.
    """
    shown, world = Rectangles(*windows.bounds_px), grid.world_px(zoom)
    several = isinstance(area, Polygons)
    found = []
    for part, placed in zip(area.parts, area.placed() if isinstance(area, Polygons) else area.parts):
        whole = _polygon_coverage(
            part.area_m2(),
            placed,
            placed.edges_deg if isinstance(placed, PlacedRings) else placed.bounds.edges_deg,
            shown,
            world,
            others=several,
        )
        held = [
            _polygon_coverage(
                WGS84.ring_area_m2(*ring),
                PlacedRings((ring,)),
                PlacedRings((ring,)).edges_deg,
                shown,
                world,
                others=True,
            )
            for ring in shared_rings(placed, no_fly)
        ]
        found.append(whole.without(held))
    return summed(found)


def _polygon_coverage(
    total_m2: float,
    placed: Box | Rings,
    edges_deg: tuple[float, float, float, float],
    shown: Rectangles,
    world: int,
    *,
    others: bool = False,
) -> Coverage:
    """Coverage of a box or polygon, in longitudes continuous with the windows', by rectangles of pixels.

    ``others`` states that most rectangles may show other polygons.
    """
    west_deg, south_deg, east_deg, north_deg = edges_deg
    west, east = (lon_to_u(np.array([west_deg, east_deg])) * world).tolist()
    north, south = (lat_to_v(np.array([north_deg, south_deg])) * world).tolist()
    if others:
        near = (shown.x0 < east) & (shown.x1 > west) & (shown.y0 < south) & (shown.y1 > north)
        if not near.any():
            return Coverage(total_m2, total_m2, complete=False)
        shown = Rectangles(*(edge[near] for edge in shown))
    lost_m2 = 0.0
    for missing in gaps_by_band(joined(shown), (west, north, east, south)):
        ground = area_within_m2(
            placed,
            u_to_lon(missing.x0 / world),
            v_to_lat(missing.y1 / world),
            u_to_lon(missing.x1 / world),
            v_to_lat(missing.y0 / world),
        )
        # Less than 1 mm² is rounding of clipping in degrees: 1e-14 degrees along a kilometre of edge.
        lost_m2 += float(ground[ground > 1e-6].sum())
    return Coverage(total_m2, lost_m2, complete=lost_m2 == 0.0)


def unique_tiles(windows: Windows, grid: PixelGrid, zoom: int) -> int:
    """Number of different tiles in windows, without listing them."""
    size = grid.part_px(zoom)
    columns = max(grid.world_px(zoom) // size, 1)
    pixels = joined(Rectangles(*windows.bounds_px))
    x0, y0 = pixels.x0 // size, pixels.y0 // size
    x1, y1 = np.ceil(pixels.x1 / size), np.ceil(pixels.y1 / size)
    x1 = np.minimum(x1, x0 + columns)
    turn = np.floor(x0 / columns) * columns
    x0, x1 = x0 - turn, x1 - turn
    beyond = x1 > columns
    tiles = Rectangles(
        np.concatenate([x0, np.zeros(int(beyond.sum()))]),
        np.concatenate([y0, y0[beyond]]),
        np.concatenate([np.minimum(x1, columns), x1[beyond] - columns]),
        np.concatenate([y1, y1[beyond]]),
    )
    lowest = int(tiles.y0.min())
    first, last = (tiles.y0 - lowest).astype(np.int64), (tiles.y1 - lowest).astype(np.int64)
    total = 0
    for start, stop in _chunks(first, last, int(last.max())):
        strip, begin, end = _pieces(tiles, np.maximum(first, start), np.minimum(last, stop))
        order = np.lexsort((begin, strip))
        strip, begin, end = strip[order], begin[order], end[order]
        total += int(np.maximum(end - np.maximum(begin, _reached(strip, end)), 0.0).sum())
    return total


def overlap(
    column: Numbers, row: Numbers, windows: Windows, rows_are_level: bool, parts: tuple[int, ...] = ()
) -> Overlap:
    """Overlap of neighbouring windows; parameters are as for `shares`.

    Windows of several polygons, with first captures ``parts``, are neighbours only within a polygon.
    """
    rectangles = Rectangles(*windows.bounds_px)
    found = []
    for first, end in zip(parts or (0,), (*parts[1:], len(row))):
        if end > first:
            part = slice(first, end)
            inside = Rectangles(*(edge[part] for edge in rectangles))
            found.append(shares(column[part], row[part], inside, rows_are_level))
    return summarize_overlap(*(np.concatenate(values) for values in zip(*found)))


def summarize_overlap(along: Floats, across: Floats) -> Overlap:
    """Least and median of the shares of neighbours along and across rows."""
    return Overlap(*_least_and_median(along), *_least_and_median(across))


def shares(column: Numbers, row: Numbers, rectangles: Rectangles, rows_are_level: bool) -> tuple[Floats, Floats]:
    """Shared widths of neighbours along rows, and heights across rows, as shares of the smaller neighbour.

    Parameters
    ----------
    column, row : array (n,)
        Grid indices in flight order.
    rectangles : Rectangles
        (n,).
    rows_are_level : bool
        Whether rows run along the sides of rectangles: the neighbour in the next row is then the nearest rectangle,
        otherwise the rectangle of the same column.
    """
    left, top, right, bottom = rectangles
    along: list[Floats] = []
    neighbours = np.flatnonzero((row[1:] == row[:-1]) & (np.abs(np.diff(column)) == 1))
    for here in _batches(neighbours):
        shared = np.minimum(right[here], right[here + 1]) - np.maximum(left[here], left[here + 1])
        width, next_width = (right[at] - left[at] for at in (here, here + 1))
        along.append(_smaller_shares(shared, width, next_width))

    # Position in the row, scaled to 0.5 or less: by column, or by the middle of the rectangle.
    place = column.astype(np.float64)
    if rows_are_level:
        place = left + right
    place = (place - place.min()) / (2.0 * max(float(np.ptp(place)), 1.0))
    order = np.argsort(row + place)
    keys = (row + place)[order]
    across: list[Floats] = []
    for here in _batches(np.arange(len(row))):
        after = np.searchsorted(keys, row[here] + place[here] + 1.0)
        before, behind = (order[np.clip(at, 0, len(keys) - 1)] for at in (after - 1, after))
        off_before, off_behind = (
            np.where(row[at] == row[here] + 1, np.abs(place[at] - place[here]), np.inf) for at in (before, behind)
        )
        apart = np.minimum(off_before, off_behind)
        is_near = np.isfinite(apart) if rows_are_level else apart == 0.0
        one, next_one = here[is_near], np.where(off_before <= off_behind, before, behind)[is_near]
        shared = np.minimum(bottom[one], bottom[next_one]) - np.maximum(top[one], top[next_one])
        across.append(_smaller_shares(shared, bottom[one] - top[one], bottom[next_one] - top[next_one]))
    return np.concatenate(along), np.concatenate(across)


def _batches(which: Numbers) -> list[Numbers]:
    """Indices (n,) in parts that bound the memory."""
    return np.array_split(which, len(which) // _BAND + 1)


def _smaller_shares(shared: Floats, one: Floats, other: Floats) -> Floats:
    """Shares of the smaller of two extents, (n,).

    Gusts may turn an image so far that it contains no rectangle: the share is then of the neighbour's extent, or -1 if
    neither contains a rectangle.
    """
    smaller, larger = np.minimum(one, other), np.maximum(one, other)
    extent = np.where(smaller > 0.0, smaller, larger)
    return np.where(extent > 0.0, shared / np.where(extent > 0.0, extent, 1.0), -1.0)


def _least_and_median(shares: Floats) -> tuple[float | None, float | None]:
    return (float(shares.min()), float(np.median(shares))) if len(shares) else (None, None)


class ImageryShare(NamedTuple):
    """Part of a mission that lies on the imagery of the source.

    Attributes
    ----------
    share : float or None
        Share of the area; None for points.
    outside, partly : int
        Numbers of pictures outside the imagery, and partly outside.
    """

    share: float | None
    outside: int
    partly: int


def imagery_share(area: Area, windows: Windows, grid: PixelGrid, zoom: int) -> ImageryShare:
    """Shares of an area, and of pictures over it, that lie on the extent of the source's imagery.

    The share of the area is None on another plane than the map (see `rotated.plane_share`).
    """
    whole = 1.0 if area.covers_ground else None
    if grid.extent is None:
        return ImageryShare(whole, 0, 0)
    extent = np.array(grid.extent, np.float64)
    extent = extent if twice_area(extent) > 0.0 else extent[::-1]
    outside, partly = _outside_counts(windows, extent, grid, zoom)
    share = _share(area, extent) if area.covers_ground and grid.plane.wraps else None
    return ImageryShare(share, outside, partly)


def twice_area(ring: Floats) -> float:
    """Twice the signed area of a ring (n, 2)."""
    following = np.roll(ring, -1, axis=0)
    return float(np.sum(ring[:, 0] * following[:, 1] - following[:, 0] * ring[:, 1]))


def _turns(u: Floats, extent: Floats) -> Floats:
    """Whole turns of the world by which an extent may be shifted to meet world fractions ``u``."""
    first = np.floor(float(u.min()) - float(extent[:, 0].max()))
    last = np.ceil(float(u.max()) - float(extent[:, 0].min()))
    return np.arange(first, last + 1.0)


def _outside_counts(windows: Windows, extent: Floats, grid: PixelGrid, zoom: int) -> tuple[int, int]:
    """Numbers of pictures outside an extent (positively oriented), and partly outside."""
    world_px = grid.world_px(zoom)
    left, top, right, bottom = (edge / world_px for edge in windows.bounds_px)
    # Rounding may move the edge of an image beyond the imagery by half a pixel.
    room = 0.5 / world_px
    inside, touched = np.zeros(len(left), bool), np.zeros(len(left), bool)
    for turn in [0.0] if not grid.plane.wraps else _turns(np.concatenate([left, right]), extent):
        corners = extent + np.array([turn, 0.0])
        (west, north), (east, south) = corners.min(axis=0), corners.max(axis=0)
        held = np.ones(len(left), bool)
        meets = (left < east - room) & (right > west + room) & (top < south - room) & (bottom > north + room)
        for (u, v), (next_u, next_v) in zip(corners, np.roll(corners, -1, axis=0)):
            # Inward distance, from a side, of each picture's outermost corner, then of its innermost.
            inward_u, inward_v = np.array([v - next_v, next_u - u]) / max(np.hypot(next_u - u, next_v - v), 1e-300)
            ends_u = np.sort([inward_u * (left - u), inward_u * (right - u)], axis=0)
            ends_v = np.sort([inward_v * (top - v), inward_v * (bottom - v)], axis=0)
            held &= ends_u[0] + ends_v[0] >= -room
            meets &= ends_u[1] + ends_v[1] > room
        inside |= held
        touched |= meets
    return int(np.sum(~(touched | inside))), int(np.sum(touched & ~inside))


def _share(area: Area, extent: Floats) -> float:
    """Share of an area on an extent (positively oriented)."""
    total = held = 0.0
    signed = [(-1.0 if number else 1.0, ring) for part in area.parts for number, ring in enumerate(part.arrays())]
    for sign, (lon, lat) in signed:
        total += sign * WGS84.ring_area_m2(lon, lat)
        on_map = np.stack([lon_to_u(lon), lat_to_v(lat)], axis=1)
        for turn in _turns(on_map[:, 0], extent):
            part = clip_ring(on_map, extent + np.array([turn, 0.0]))
            if len(part) > 2:
                held += sign * WGS84.ring_area_m2(u_to_lon(part[:, 0]), v_to_lat(part[:, 1]))
    share = held / total if total > 0.0 else 1.0
    return 1.0 if share > 1.0 - _NOTHING_MISSING else max(share, 0.0)


def clip_ring(ring: Floats, convex: Floats) -> Floats:
    """Ring clipped to a convex, positively oriented ring (Sutherland–Hodgman)."""
    for corner, following in zip(convex, np.roll(convex, -1, axis=0)):
        along = following - corner
        depth = along[0] * (ring[:, 1] - corner[1]) - along[1] * (ring[:, 0] - corner[0])
        next_corners, next_depth = np.roll(ring, -1, axis=0), np.roll(depth, -1)
        cross = (depth >= 0.0) != (next_depth >= 0.0)
        share = np.where(cross, depth / np.where(cross, depth - next_depth, 1.0), 0.0)
        both = np.stack([ring, ring + share[:, np.newaxis] * (next_corners - ring)], axis=1).reshape(-1, 2)
        ring = both[np.stack([depth >= 0.0, cross], axis=1).ravel()]
        if len(ring) < 3:
            return ring[:0]
    return ring
