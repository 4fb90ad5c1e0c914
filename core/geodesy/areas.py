"""Pixels that average what they cover: the zoom of each, and samples over its footprint on a plane.

A pixel sees a parallelogram: its sides are the steps to the next pixel along a row and down a column. The ellipse with
the same second moments (Heckbert 1989, elliptical weighted average) has a longer and a shorter axis, in any direction.
The source's pixels, means of what they cover, and interpolation between them spread light by a variance of 1/12 + 1/6 =
1/4 of a source pixel squared. The zoom is the lowest at which that is no more than what the pixel covers along the
shorter axis, and at which it covers enough source pixels. Samples of equal weight are spread over the parallelogram so
that the sum of the variances is its own: nothing is averaged twice. They are at most as far apart as a box of that
variance is wide, so that the blurs of samples side by side leave no gaps, nor overlap and soften the pixel's edges.
Such a box is what a sensor's pixel collects; the Gaussian that is usual in graphics would blur more. Parallelograms
that are far longer than wide and lie across their sides, as under a rolled camera, are replaced by the rectangle along
the axes of the ellipse, which needs fewer samples.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from ..arrays import Flags, Floats, Numbers
from ..external.compiling import loaded_numba
from .mercator import PixelGrid, Plane

#: Variance of a source pixel and of bilinear interpolation, in source pixels squared, times the 12 of a box's variance.
_SOURCE_BLUR = 3.0
#: Most source pixels that a pixel spans, and samples along it; longer ones have a lower zoom, which bounds their cost.
MOST_LENGTH = 64
#: Least number of source pixels that a pixel covers, where the source has them: of a zone plate, their mean has less
#: than 1 % of the energy by which interpolation differs from the exact mean.
_LEAST_COVERED = 49.0
#: Pixels whose sides span at most so many times their area are sampled along their sides, others along the axes.
_MOST_SKEW = 2.0
#: Pixels whose samples are computed at a time.
_BATCH = 1 << 16
#: Samples more than which a rounding error must not ask for.
_ROUNDING = 1e-9
_TINY = float(np.finfo(float).tiny)


class TracedRays(Protocol):
    """Rays of an image, traced to a plane: `view.ImageRays`."""

    @property
    def plane(self) -> Plane:
        """The plane."""

    def map_points(self, x_px: Floats, y_px: Floats, /) -> tuple[Floats, Floats, Flags]:
        """World fractions at image points, and which rays hit."""


class Areas(NamedTuple):
    """Pixels sampled over what they cover.

    Attributes
    ----------
    row, column : array (m,)
    du, v : array (m,)
        World fractions of the middle.
    steps : array (m, 4)
        From one sample to the next, eastward and southward, along one axis and along the other.
    counts : array (m, 2)
        Samples along each axis.
    """

    zoom: int
    row: Numbers
    column: Numbers
    du: Floats
    v: Floats
    steps: Floats
    counts: Numbers

    def bounds(self) -> tuple[Floats, Floats]:
        """Least and greatest du, and v, of the samples of each pixel; (m, 2) each."""
        reach = (self.counts - 1) / 2.0
        across = np.abs(self.steps[:, 0]) * reach[:, 0] + np.abs(self.steps[:, 2]) * reach[:, 1]
        down = np.abs(self.steps[:, 1]) * reach[:, 0] + np.abs(self.steps[:, 3]) * reach[:, 1]
        du, v = (
            np.stack([middle - half, middle + half], axis=1) for middle, half in ((self.du, across), (self.v, down))
        )
        return du, v

    def in_pixels(self, u: float, world_px: int, left_px: int, top_px: int) -> Areas:
        """Areas in source pixels from a corner, of a camera whose meridian is at ``u``."""
        du, v = (u + self.du) * world_px - left_px, self.v * world_px - top_px
        return self._replace(du=du, v=v, steps=self.steps * world_px)

    def samples(self, most: int) -> Iterator[tuple[Numbers, Numbers, Floats, Floats]]:
        """Yield rows and columns (n,) of pixels, and du and v (n, k) of their samples, at most so many at a time."""
        kinds = self.counts[:, 0] * (MOST_LENGTH + 1) + self.counts[:, 1]
        order = np.argsort(kinds, kind="stable")
        ends = np.cumsum(np.bincount(kinds))
        for kind in np.flatnonzero(np.diff(ends, prepend=0)).tolist():
            first, second = divmod(kind, MOST_LENGTH + 1)
            off_one, off_other = (
                one.ravel() - (count - 1) / 2.0
                for one, count in zip(np.meshgrid(np.arange(first), np.arange(second)), (first, second))
            )
            of_kind = order[ends[kind - 1] if kind else 0 : ends[kind]]
            step = max(most // (first * second), 1)
            for start in range(0, len(of_kind), step):
                at = of_kind[start : start + step]
                du, v = (
                    middle[at, np.newaxis]
                    + self.steps[at, axis, np.newaxis] * off_one
                    + self.steps[at, 2 + axis, np.newaxis] * off_other
                    for axis, middle in enumerate((self.du, self.v))
                )
                yield self.row[at], self.column[at], du, v


class _Ellipses(NamedTuple):
    """Ellipses (n,) with the second moments of what pixels cover: squared axes, in world fractions, and direction.

    ``axis_u, axis_v`` is a unit vector along the longer axis.
    """

    long2: Floats
    short2: Floats
    axis_u: Floats
    axis_v: Floats

    @classmethod
    def of(cls, steps: Sequence[tuple[Floats, Floats]]) -> _Ellipses:
        """Ellipses of pixels whose sides are steps, in world fractions."""
        (across_u, across_v), (down_u, down_v) = steps
        uu, uv, vv = across_u**2 + down_u**2, across_u * across_v + down_u * down_v, across_v**2 + down_v**2
        apart, half = (uu - vv) / 2.0, (uu + vv) / 2.0
        eccentric = np.sqrt(apart * apart + uv * uv)
        long2 = np.maximum(half + eccentric, _TINY)
        short2 = np.maximum((across_u * down_v - across_v * down_u) ** 2 / long2, _TINY)
        # Half the angle of (apart, uv), without trigonometry.
        is_east = apart >= 0.0
        axis_u = np.where(is_east, eccentric + np.abs(apart), uv)
        axis_v = np.where(is_east, uv, eccentric + np.abs(apart))
        length = np.sqrt(axis_u * axis_u + axis_v * axis_v)
        with np.errstate(invalid="ignore", divide="ignore"):
            # A circle has no longer axis.
            axis_u, axis_v = np.where(length > 0.0, (axis_u, axis_v) / length, ((1.0,), (0.0,)))
        return cls(long2, short2, axis_u, axis_v)


def plane_areas(
    row: Numbers,
    column: Numbers,
    place: tuple[Floats, Floats],
    steps: Sequence[tuple[Floats, Floats]],
    grid: PixelGrid,
    zooms: tuple[int, int],
) -> list[Areas]:
    """Areas of pixels (n,) that see planes; parameters as those of `view.plane_samples`."""
    world = float(grid.world_px(0))
    if loaded_numba():
        return _compiled_areas(row, column, *place, np.stack([*steps[0], *steps[1]], axis=1), world, zooms)
    ellipses = _Ellipses.of(steps)
    zoom = _zooms(ellipses, world, zooms)
    return _by_zoom(row, column, *place, *_spread(ellipses, steps, np.ldexp(world, zoom)), zoom)


def _compiled_areas(
    row: Numbers, column: Numbers, du: Floats, v: Floats, steps: Floats, world: float, zooms: tuple[int, int]
) -> list[Areas]:
    """Areas as of `plane_areas`; steps (n, 4) are written over."""
    from .spreading import SpreadRules, spread

    rules = SpreadRules(_SOURCE_BLUR, _LEAST_COVERED, _MOST_SKEW, MOST_LENGTH, _ROUNDING, _TINY)
    zoom, counts = np.empty(len(row), np.int64), np.empty((len(row), 2), np.int64)
    spread(world, zooms, rules, steps, zoom, counts)
    return _by_zoom(row, column, du, v, steps, counts, zoom)


def _by_zoom(
    row: Numbers, column: Numbers, du: Floats, v: Floats, steps: Floats, counts: Numbers, zoom: Numbers
) -> list[Areas]:
    """Areas of pixels (n,), parted by zoom."""
    found, parts = [], (row, column, du, v, steps, counts)
    for one in np.flatnonzero(np.bincount(zoom)).tolist():
        at = np.flatnonzero(zoom == one)
        found.append(Areas(one, *(parts if len(at) == len(zoom) else (part[at] for part in parts))))
    return found


def _spread(ellipses: _Ellipses, steps: Sequence[tuple[Floats, Floats]], world_px: Floats) -> tuple[Floats, Numbers]:
    """Steps (n, 4) between the samples of pixels, and numbers (n, 2) of samples, as `Areas` has them.

    ``world_px`` (n,) are the source's pixels around the world, at the zoom of each.
    """
    long2, short2, axis_u, axis_v = ellipses
    # Shares of the axes that are left when the source's own blur is taken away.
    blur = _SOURCE_BLUR / (world_px * world_px)
    left_long, left_short = (np.sqrt(np.maximum(1.0 - blur / axis2, 0.0)) for axis2 in (long2, short2))
    longer, shorter = np.sqrt(long2), np.sqrt(short2)
    sides2 = [side_u * side_u + side_v * side_v for side_u, side_v in steps]
    is_even = sides2[0] * sides2[1] <= (_MOST_SKEW * longer * shorter) ** 2
    spread, counts = [], []
    for step, axis in zip(steps, ((axis_u * longer, axis_v * longer), (-axis_v * shorter, axis_u * shorter))):
        side_u, side_v = (np.where(is_even, one, other) for one, other in zip(step, axis))
        along = (side_u * axis_u + side_v * axis_v) * left_long
        aside = (side_v * axis_u - side_u * axis_v) * left_short
        # k samples at a distance of d have a variance of d²(k² - 1)/12. Each is blurred as by a box of √3 source
        # pixels; side by side, such boxes make an even one.
        length = np.sqrt(along * along + aside * aside) * world_px
        count = np.minimum(np.ceil(np.sqrt(length * length / _SOURCE_BLUR + 1.0) - _ROUNDING), MOST_LENGTH)
        share = 1.0 / np.sqrt(np.maximum(count * count - 1.0, 1.0))
        spread += [(along * axis_u - aside * axis_v) * share, (along * axis_v + aside * axis_u) * share]
        counts.append(count.astype(np.int64))
    return np.stack(spread, axis=1), np.stack(counts, axis=1)


def _zooms(ellipses: _Ellipses, world: float, zooms: tuple[int, int]) -> Numbers:
    """Zooms (n,) for ellipses; ``world`` is the number of source pixels around the world at zoom 0."""
    # `frexp` splits a number into a share in [1/2, 1) and a power of two.
    covered = np.sqrt(ellipses.long2 * ellipses.short2)
    least = np.sqrt(np.maximum(_SOURCE_BLUR / ellipses.short2, _LEAST_COVERED / covered)) / world
    share, finest = np.frexp(least)
    _, most = np.frexp(MOST_LENGTH / (np.sqrt(ellipses.long2) * world))
    found: Numbers = np.clip(np.minimum(finest - (share == 0.5), most - 1), *zooms).astype(np.int64)
    return found


def cell_pixels(box: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """Row, column and number of the cell, (n,) each, of the pixels in cells (k, 4) of left, top, right and bottom."""
    width = box[:, 2] - box[:, 0]
    counts = width * (box[:, 3] - box[:, 1])
    cell = np.repeat(np.arange(len(box)), counts)
    at = np.arange(len(cell)) - np.repeat(np.cumsum(counts) - counts, counts)
    down = at // width[cell]
    return box[cell, 1] + down, box[cell, 0] + at - down * width[cell], cell


class AreaCells(NamedTuple):
    """Cells of an image, as `view.Cells` has them, whose pixels are areas of one zoom."""

    zoom: int
    box: Numbers
    du: Floats
    v: Floats

    def bounds(self, grid: PixelGrid) -> tuple[Floats, Floats]:
        """Least and greatest du, and v, of what the pixels of each cell cover; (k, 2) each."""
        # Samples lie on the ellipse, which reaches beyond the pixel by less than a fifth of its length.
        reach = MOST_LENGTH / 5.0 / grid.world_px(self.zoom)
        du, v = (np.stack([at.min(axis=1) - reach, at.max(axis=1) + reach], axis=1) for at in (self.du, self.v))
        return du, v

    def areas(self, grid: PixelGrid, rays: TracedRays | None) -> Iterator[Areas]:
        """Yield the areas of the pixels, a bounded number at a time; traced if rays are given."""
        sizes = (self.box[:, 2:] - self.box[:, :2]).prod(axis=1)
        first = np.searchsorted(np.cumsum(sizes), np.arange(0, int(sizes.sum()) + _BATCH, _BATCH), side="right")
        for start, stop in zip(first[:-1].tolist(), first[1:].tolist()):
            cells = self._replace(**{name: getattr(self, name)[start:stop] for name in ("box", "du", "v")})
            zooms = self.zoom, self.zoom
            if rays is None and loaded_numba():
                yield from _compiled_areas(*_seen_pixels(cells), float(grid.world_px(0)), zooms)
                continue
            row, column, cell = cell_pixels(cells.box)
            if rays is not None:
                yield from traced_areas(rays, row, column, grid, zooms)
            elif len(row):
                left, top = cells.box[cell, :2].T
                seen = _Perspectives.through(*cells[1:]).take(cell)
                x, y = column - left + 0.5, row - top + 0.5
                yield from plane_areas(row, column, seen.positions(x, y), seen.steps(x, y), grid, zooms)


def _seen_pixels(cells: AreaCells) -> tuple[Numbers, Numbers, Floats, Floats, Floats]:
    """Row, column, du, v and steps (n, 4) of the pixels of cells, by compiled code."""
    from .spreading import see_pixels

    count = int((cells.box[:, 2:] - cells.box[:, :2]).prod(axis=1).sum())
    (row, column), (du, v), steps = np.empty((2, count), np.int64), np.empty((2, count)), np.empty((count, 4))
    see_pixels(cells.box, *_Perspectives.through(*cells[1:]), row, column, du, v, steps)
    return row, column, du, v, steps


class _Perspectives(NamedTuple):
    """Perspectives from pixels, from the upper left corners of cells, to world fractions.

    ``factors`` is (8, n), see `perspectives`, to fractions from the positions ``du, v`` (n,) of the corners.
    """

    factors: Floats
    du: Floats
    v: Floats

    @classmethod
    def through(cls, box: Numbers, du: Floats, v: Floats) -> _Perspectives:
        """Perspectives through the corners of cells."""
        first_u, first_v = du[:, 0], v[:, 0]
        sizes = (box[:, 2:] - box[:, :2]).T
        factors = perspectives(du - first_u[:, np.newaxis], v - first_v[:, np.newaxis], *sizes)
        return cls(factors.T, first_u, first_v)

    def take(self, which: Numbers) -> _Perspectives:
        """Some perspectives, by index."""
        return _Perspectives(self.factors[:, which], self.du[which], self.v[which])

    def positions(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """World fractions at pixels (n,)."""
        a, b, c, d, e, f, g, h = self.factors
        divisor = g * x + h * y + 1.0
        return self.du + (a * x + b * y + c) / divisor, self.v + (d * x + e * y + f) / divisor

    def steps(self, x: Floats, y: Floats) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
        """By how much the fractions change along columns, and along rows."""
        a, b, c, d, e, f, g, h = self.factors
        divisor = g * x + h * y + 1.0
        du, v = (a * x + b * y + c) / divisor, (d * x + e * y + f) / divisor
        return (
            ((a - du * g) / divisor, (d - v * g) / divisor),
            ((b - du * h) / divisor, (e - v * h) / divisor),
        )


def area_cells(box: Numbers, du: Floats, v: Floats, grid: PixelGrid, zooms: tuple[int, int]) -> list[AreaCells]:
    """Cells (k), as `view.Cells` has them, grouped by the zoom that suits their finest pixel."""
    if not len(box):
        return []
    seen = _Perspectives.through(box, du, v)
    right, bottom = (box[:, 2:] - box[:, :2]).T.astype(np.float64)
    ends = [
        _Ellipses.of(seen.steps(x, y))
        for x, y in ((0.0 * right, 0.0 * right), (right, 0.0 * right), (0.0 * right, bottom), (right, bottom))
    ]
    longest, shortest = np.max([one.long2 for one in ends], axis=0), np.min([one.short2 for one in ends], axis=0)
    zoom = _zooms(ends[0]._replace(long2=longest, short2=shortest), float(grid.world_px(0)), zooms)
    return [AreaCells(one, *(at[zoom == one] for at in (box, du, v))) for one in np.unique(zoom).tolist()]


def perspectives(x: Floats, y: Floats, width: Numbers, height: Numbers) -> Floats:
    """Coefficients (k, 8) of the perspective transforms from rectangles of px to quadrilaterals.

    In Pillow's order a, b, c, d, e, f, g, h of ((ax + by + c)/(gx + hy + 1), (dx + ey + f)/(gx + hy + 1)). Corners
    (k, 4) are upper left, lower left, lower right, upper right. Solved for the unit square (Heckbert 1989).
    """
    x0, y0 = x[:, 0], y[:, 0]
    (x3, x2, x1), (y3, y2, y1) = (x[:, 1:] - x[:, :1]).T, (y[:, 1:] - y[:, :1]).T
    sum_x, sum_y = x2 - x1 - x3, y2 - y1 - y3
    bend = (x1 - x2) * (y3 - y2) - (x3 - x2) * (y1 - y2)
    g = (sum_x * (y3 - y2) - (x3 - x2) * sum_y) / bend
    h = ((x1 - x2) * sum_y - sum_x * (y1 - y2)) / bend
    columns = [
        (x1 + g * (x1 + x0)) / width,
        (x3 + h * (x3 + x0)) / height,
        x0,
        (y1 + g * (y1 + y0)) / width,
        (y3 + h * (y3 + y0)) / height,
        y0,
        g / width,
        h / height,
    ]
    return np.stack(columns, axis=1)


def traced_areas(
    rays: TracedRays, row: Numbers, column: Numbers, grid: PixelGrid, zooms: tuple[int, int]
) -> list[Areas]:
    """Areas of pixels (n,) that see the map, traced one by one."""
    x, y = column + 0.5, row + 0.5
    du, v, _ = rays.map_points(x, y)
    steps = [_traced_step(rays, x, y, (du, v), *off) for off in ((0.5, 0.0), (0.0, 0.5))]
    return plane_areas(row, column, (du, v), steps, grid, zooms)


def _traced_step(
    rays: TracedRays, x: Floats, y: Floats, middle: tuple[Floats, Floats], off_x: float, off_y: float
) -> tuple[Floats, Floats]:
    """World fractions (n,) from one edge of pixels to the other, or twice those to the edge that is not sky."""
    ways_u, ways_v, hits = [], [], []
    for sign in (1.0, -1.0):
        du, v, hit = rays.map_points(x + sign * off_x, y + sign * off_y)
        with np.errstate(invalid="ignore"):
            way = du - middle[0]
            # Points across a pole, or across the meridian opposite the camera, are near although their longitudes are
            # not.
            shorter = rays.plane.shorter(np.abs(way))
            way = np.where(shorter < np.abs(way), -np.sign(way) * shorter, way)
            ways_u.append(sign * way)
            ways_v.append(sign * (v - middle[1]))
            hits.append(hit & np.isfinite(way) & np.isfinite(ways_v[-1]))
    total = np.zeros(len(x)), np.zeros(len(x))
    for axis, ways in enumerate((ways_u, ways_v)):
        one, other = (np.where(hit, way, 0.0) for hit, way in zip(hits, ways))
        total[axis][:] = np.where(hits[0] & hits[1], one + other, 2.0 * (one + other))
    # Pixels that see ground only at their middle look very far.
    return np.where(hits[0] | hits[1], total[0], 1.0), total[1]
