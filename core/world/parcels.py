"""The pieces of land under samples, and distances to their edges.

The land is divided in the bent plane: the Mercator plane displaced by the region's ``warp`` splines.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from .division import BORDER, HALF_WIDTH_M, ROOT, ROOT_M, divide, whole_division
from .lattice import WORLD_M, Array, LatticeWindow
from .region import Region
from .samples import Positions

#: Distance from lines, by their class, beyond which distances are not needed; a pixel is added.
_REACHES_M = np.array(HALF_WIDTH_M) + 6.0
#: Most pieces that are found by the lines between them; for more, descending the division is faster.
_FEW = 1024


def bent_plane(region: Region, samples: Positions) -> tuple[Array, Array]:
    """Return the samples' positions in the bent plane, float32 metres from their tile's corner."""
    east, south = samples.local_m()
    scale = np.float32(WORLD_M)
    x = region.value("warp_x", samples)
    x *= scale
    x += east
    y = region.value("warp_y", samples)
    y *= scale
    y += south
    return x, y


def _extents(c: Array, origin: float | Array, pixel_m: float) -> tuple[Array, Array]:
    """Return the extent of each tile's samples along an axis, in metres, with a margin for rounding."""
    margin, tiles = 1e-3 + 1e-5 * 256 * pixel_m, c.reshape(np.size(origin), -1)
    ends = (tiles.min(axis=1).astype(np.float64) - margin, tiles.max(axis=1).astype(np.float64) + margin)
    return ends[0] + np.ravel(origin), ends[1] + np.ravel(origin)


def _squares(ends: Array) -> Array:
    return np.asarray(np.floor(ends / ROOT_M), np.int64)


def root_squares(region: Region, samples: Positions) -> Array:
    """Return the first and last column, and row, of the root squares that each tile touches, shape (tiles, 4)."""
    places = zip(bent_plane(region, samples), samples.origin_m)
    return _squares(np.stack([end for c, origin in places for end in _extents(c, origin, samples.pixel_m)], axis=1))


class Parcels:
    """The pieces under some samples.

    `at` are their indices among the division's leaves, `index` is each sample's index in `at`. `x`, `y` are the
    samples' positions in the bent plane, float32 metres from the tile's `corner`.
    """

    def __init__(self, seed: int, region: Region, samples: Positions) -> None:
        self.shape = samples.shape
        self.pixel_m = samples.pixel_m
        self.x, self.y = bent_plane(region, samples)
        x, y = (_extents(c, start, self.pixel_m) for c, start in zip((self.x, self.y), samples.origin_m))
        west, east, north, south = x[0].min(), x[1].max(), y[0].min(), y[1].max()
        i0, i1, j0, j1 = (int(end) for end in _squares(np.array([west, east, north, south])))
        self.roots = LatticeWindow(ROOT, i0, j0, i1 - i0 + 1, j1 - j0 + 1)
        # From zoom 14 on a tile touches few root squares, which are divided completely and remembered.
        whole = samples.zoom >= 14
        self.division = whole_division(seed, self.roots) if whole else divide(seed, self.roots, samples.pixel_m)
        left, top = i0 * ROOT_M, j0 * ROOT_M
        self.corner = (left - samples.origin_m[0], top - samples.origin_m[1])
        self._low, self._high = (west - left, north - top), (east - left, south - top)
        self.index = np.zeros(self.shape, dtype=np.intp)
        self.at = self._find()
        self._distances: dict[int, Array | None] = {}

    def _find(self) -> Array:
        """Find the samples' pieces: few by the lines between them, many by descending the division."""
        leaves = self.division.leaves
        if len(self.shape) == 2:
            at = np.flatnonzero(self.touched(leaves.x0, leaves.x1, leaves.y0, leaves.y1))
            if at.size <= _FEW and self._find_few(at):
                return at
        return self._descend()

    def _find_few(self, at: Array) -> bool:
        """Find the samples' pieces among few; return False, and do nothing, where descending is faster.

        The lines between pieces cut the plane into a table of rectangles; the rectangles of a piece are adjacent.
        """
        leaves = self.division.leaves
        x, across = _lines(self.x, *(self._edges(edge[at], 0) for edge in (leaves.x0, leaves.x1)))
        y, down = _lines(self.y, *(self._edges(edge[at], 1) for edge in (leaves.y0, leaves.y1)))
        columns, rows = x.size + 1, y.size + 1
        if rows * columns > self.x.size:
            return False
        if at.size > 1:
            table = np.empty((rows, columns), dtype=np.intp)
            for piece, (left, right, top, bottom) in enumerate(zip(*across, *down)):
                table[top:bottom, left:right] = piece
            cell = _count_passed(self.y, y)
            cell *= columns
            cell += _count_passed(self.x, x)
            self.index = table.ravel().take(cell, mode="clip")
        return True

    def _edges(self, edges: Array, axis: int) -> Array:
        """Return the edges of pieces, float32 local metres; samples beyond an edge are greater."""
        local = np.asarray(edges + self.corner[axis], np.float32)
        squares = self.roots.rows if axis else self.roots.columns
        if squares > 1:
            # A sample exactly on the border of a root square counts as beyond it, on any other line as before it.
            border = np.isin(edges, np.arange(1, squares) * ROOT_M)
            local = np.where(border, np.nextafter(local, np.float32(-np.inf)), local)
        return local

    def _descend(self) -> Array:
        """Descend the division with the samples, skipping pieces that their box does not touch."""
        roots = self.division.roots
        for axis, c, count, stride in ((0, self.x, roots.columns, 1), (1, self.y, roots.rows, roots.columns)):
            for n in range(1, count):
                self.index += (c >= np.float32(self.corner[axis] + n * ROOT_M)) * stride
        at = np.arange(roots.rows * roots.columns)
        for depth, (cuts, first) in enumerate(zip(self.division.cuts, self.division.first)):
            axis = depth & 1
            low, high = self._low[axis], self._high[axis]
            if at.size == 1:  # the common case at low depths, without arrays
                only = int(at[0])
                where = float(cuts[only])
                if where > high or where < low:
                    at = first[only : only + 1] + int(where < low)
                    continue
            cut = cuts[at]
            before, after = cut >= low, cut <= high
            both = before & after
            parts = 1 + both
            start = np.cumsum(parts) - parts
            child = first[at] + ~before
            at = np.repeat(child, parts)
            if both.any():
                at[start[both] + 1] += 1
                beyond = (self.y if axis else self.x) > self.local(cut, axis)
                self.index = (start - ~before).take(self.index, mode="clip")
                self.index += beyond
        return at

    def leaf(self, table: Array) -> Array:
        """Return the entries of the pieces under the samples, shape (n,), from a table of all leaves."""
        out: Array = table[self.at]
        return out

    def spread(self, entries: Array) -> Array:
        """Give each sample the entry of its piece, from the entries of the pieces under the samples."""
        if entries.size == 1:
            return np.full(self.shape, entries[0])
        out: Array = entries.take(self.index, mode="clip")
        return out

    def take(self, table: Array) -> Array:
        """Give each sample its piece's entry from a table of all leaves."""
        return self.spread(table[self.at])

    def local(self, edges: Array, axis: int) -> Array:
        """Give each sample an edge of its piece along an axis, float32 metres from the corner of the sample's tile.

        `edges` belong to the pieces under the samples, float64 metres from the root squares' corner.
        """
        corner = self.corner[axis]
        if np.ndim(corner) == 0:
            return self.spread((edges + corner).astype(np.float32))
        return np.asarray((self.spread(edges) + corner).astype(np.float32))

    def touched(self, x0: Array, x1: Array, y0: Array, y1: Array, margin_m: float = 0.0) -> Array:
        """Whether the samples' box touches rectangles, given from the root squares' corner."""
        (left, top), (right, bottom) = self._low, self._high
        touched: Array = (x1 >= left - margin_m) & (x0 <= right + margin_m)
        touched &= (y1 >= top - margin_m) & (y0 <= bottom + margin_m)
        return touched

    def distance_m(self, line: int) -> Array | None:
        """Return each sample's distance to the nearest line of a class around its piece, or None without any.

        Distances beyond the reach of the class are not exact.
        """
        if line not in self._distances:
            self._distances[line] = self._distance_m(line)
        return self._distances[line]

    @cached_property
    def _nearby_lines(self) -> tuple[Array, frozenset[int]]:
        """Lines along the pieces' sides, shape (4, n), `BORDER` where out of the samples' reach; and their classes."""
        leaves = self.division.leaves
        sides = leaves.sides[:, self.at]
        reach = _REACHES_M[sides] + self.pixel_m
        (left, top), (right, bottom) = self._low, self._high
        near = np.stack(
            [
                self.leaf(leaves.x0) >= left - reach[0],
                self.leaf(leaves.x1) <= right + reach[1],
                self.leaf(leaves.y0) >= top - reach[2],
                self.leaf(leaves.y1) <= bottom + reach[3],
            ]
        )
        sides = np.where(near, sides, BORDER)
        return sides, frozenset(np.flatnonzero(np.bincount(sides.ravel())).tolist())

    def _distance_m(self, line: int) -> Array | None:
        sides, classes = self._nearby_lines
        if line not in classes:
            return None
        leaves = self.division.leaves
        best: Array | None = None
        beyond_m = 1e6
        for side, edges in enumerate((leaves.x0, leaves.x1, leaves.y0, leaves.y1)):
            is_line = sides[side] == line
            if not is_line.any():
                continue
            axis, far = side // 2, side & 1
            c = self.y if axis else self.x
            local = self.local(np.where(is_line, self.leaf(edges), beyond_m if far else -beyond_m), axis)
            d = np.subtract(local, c, out=local) if far else np.subtract(c, local, out=local)
            best = d if best is None else np.minimum(best, d, out=best)
        return best


def _lines(c: Array, low: Array, high: Array) -> tuple[Array, tuple[list[int], list[int]]]:
    """Return the lines between pieces, ascending, and how many lie before the low and the high end of each piece.

    A line counts as before every sample greater than it, so a piece includes its high end.
    """
    least = c.min()
    lines = np.array(sorted(set(low[low >= least].tolist())), dtype=np.float32)
    start, stop = np.searchsorted(lines, low, "right"), np.searchsorted(lines, high, "left") + (high >= least)
    return lines, (start.tolist(), stop.tolist())


def _count_passed(c: Array, lines: Array) -> Array:
    """Count the lines, ascending, that are less than each sample."""
    if lines.size <= 28:  # faster than binning
        count, beyond = np.zeros(c.shape, dtype=np.uint8), np.empty(c.shape, dtype=np.bool_)
        for line in lines:
            np.greater(c, line, out=beyond)
            count += beyond.view(np.uint8)
        return np.asarray(count, np.intp)
    # Samples and lines are sorted into equal bins: samples are compared only with lines in the same bin.
    least, greatest = c.min(), c.max()
    bins = 64 * lines.size
    per_m = np.float32(bins / (float(greatest - least) + 1e-3))

    def binned(values: Array) -> Array:
        place = values - least
        place *= per_m
        return np.asarray(place, np.intp)

    line_bins = binned(np.clip(lines, least, greatest))
    inside = np.bincount(line_bins, minlength=bins + 1)
    before = np.cumsum(inside) - inside
    at = binned(c)
    beyond_lines = before.take(at, mode="clip")
    for nth in range(int(inside.max())):
        line = np.full(bins + 1, np.inf, dtype=np.float32)
        has_nth = inside > nth
        line[has_nth] = lines[before[has_nth] + nth]
        beyond_lines += c > line.take(at, mode="clip")
    return beyond_lines
