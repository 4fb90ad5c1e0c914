"""Hits of an image on one surface, and the samples that its pixels are made of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial.polynomial import polyval2d, polyvander2d

from ...arrays import Flags, Floats, Numbers
from ...external.compiling import uses_numba
from ..areas import plane_areas
from ..mercator import PixelGrid, wrap_lon_deg
from ..view import KIND_BITS, MOST_POWER, NEAREST_PX, Detail, Sampled, Samples, plane_samples
from .pixel_rays import PixelRays
from .surface import Hits, Surface

#: Slope, metres per metre, above which faces cannot be seen from above: no map shows their colours.
STEEP = 2.0
#: Least number by which to divide.
_LEAST = 1e-12


class Seen(NamedTuple):
    """Hits of rows of an image, from ``top`` on, on one surface.

    ``per_metre`` (2, 2) are columns and rows of the surface per metre eastward and northward; ``rays`` are those of the
    rows. ``begun`` are rows, columns and heights of the pixels whose rays come in below the surface where it begins.
    """

    surface: Surface
    hits: Hits
    per_metre: Floats
    rays: PixelRays
    top: int = 0
    begun: tuple[Numbers, Numbers, Floats] | None = None

    def slopes(self, column: Floats, row: Floats) -> tuple[Floats, Floats]:
        """Slopes of the surface eastward and northward, metres per metre, at columns and rows (n,)."""
        across, down = self.surface.slopes(column, row)
        per = self.per_metre
        return across * per[0, 0] + down * per[1, 0], across * per[0, 1] + down * per[1, 1]

    def has_ground_around(self, column: Floats, row: Floats, steps: list[tuple[Floats, Floats]]) -> Flags:
        """Whether points (n,) have ground all around, within the samples of their pixels; ``steps`` are in metres."""
        ways = [self.per_metre @ np.stack(step) for step in steps]
        # At the coarsest zoom, samples lie up to two pixels to either side.
        wide, high = (2.0 * (np.abs(ways[0][axis]) + np.abs(ways[1][axis])) for axis in (0, 1))
        rows, columns = self.surface.cells
        has_ground = np.ones(len(column), bool)
        for across, down in ((-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)):
            # Points beyond the surface count as its edge, which has no ground where the model ends.
            x, y = np.clip(column + across * wide, 0.0, columns), np.clip(row + down * high, 0.0, rows)
            has_ground &= np.isfinite(self.surface.heights(x, y))
        return has_ground

    def face_edges(self, column: Floats, row: Floats) -> tuple[Floats, Floats]:
        """Upper or lower ends of the steep faces at points (n,), whichever is nearer in height."""
        height = self.surface.heights(column, row)
        above, below = (self.follow_faces(column, row, sign) for sign in (1.0, -1.0))
        with np.errstate(invalid="ignore"):
            to_above, to_below = (np.abs(self.surface.heights(*end) - height) for end in (above, below))
        upper = to_above <= to_below
        return np.where(upper, above[0], below[0]), np.where(upper, above[1], below[1])

    def follow_faces(self, column: Floats, row: Floats, sign: float) -> tuple[Floats, Floats]:
        """Ends of the steep faces at points (n,), uphill for a sign of 1 and downhill for -1."""
        surface = self.surface
        across, down = surface.slopes(column, row)
        length = np.maximum(np.hypot(across, down), _LEAST)
        x, y = column.copy(), row.copy()
        moving = np.ones(len(x), bool)
        # Faces reach at most six cells to either side.
        for _ in range(2 * 6):
            new_x = np.where(moving, x + sign * 0.5 * across / length, x)
            new_y = np.where(moving, y + sign * 0.5 * down / length, y)
            x, y = np.clip(new_x, 0.0, surface.cells[1]), np.clip(new_y, 0.0, surface.cells[0])
            with np.errstate(invalid="ignore"):
                moving &= np.hypot(*self.slopes(x, y)) > STEEP
            if not moving.any():
                break
        return x, y

    def samples(
        self, lon_deg: float, grid: PixelGrid, zooms: tuple[int, int], *, by_area: bool = False
    ) -> tuple[Sequence[Sampled], int]:
        """Samples or areas of the pixels that see the surface, and the number of them that see steep faces.

        Positions count from the meridian of ``lon_deg``.
        """
        if uses_numba():
            return self._compiled_samples(lon_deg, grid, zooms, by_area)
        row, column = np.nonzero(np.isfinite(self.hits.t))
        if not len(row):
            return [], 0
        at_column, at_row, t = (values[row, column] for values in (self.hits.column, self.hits.row, self.hits.t))
        slope_east, slope_north = self.slopes(at_column, at_row)
        steep = np.hypot(slope_east, slope_north) > STEEP
        faces = int(np.count_nonzero(steep))
        ray_east, ray_north, ray_up = directions = self.rays.through(row, column).T
        # Intersect the ground's tangent plane, n·p = const, with the rays of neighbouring pixels; rays that are nearly
        # parallel to it count as steeper.
        facing = np.minimum(ray_up - slope_east * ray_east - slope_north * ray_north, -0.02 * np.abs(ray_up) - _LEAST)
        steps: list[tuple[Floats, Floats]] = []
        for per in self.rays.changes(row, column, *(way[:, np.newaxis] for way in self.rays.ways[1:])):
            ahead = (per[2] - slope_east * per[0] - slope_north * per[1]) / facing
            ahead[steep] = 0.0
            steps.append((t * (per[0] - ahead * directions[0]), t * (per[1] - ahead * directions[1])))
        if faces:
            at_column[steep], at_row[steep] = self.face_edges(at_column[steep], at_row[steep])
        if self.surface.has_holes:
            # Pixels whose samples reach beyond the end of the model have no picture.
            whole = self.has_ground_around(at_column, at_row, steps)
            steps = [(east[whole], north[whole]) for east, north in steps]
            row, column = row[whole], column[whole]
            at_column, at_row = at_column[whole], at_row[whole]
            if not len(row):
                return [], faces
        to_plane = _fit_plane(self.surface, grid, lon_deg, at_column, at_row)
        du, v = to_plane(at_column, at_row)
        turn = to_plane.slopes(at_column, at_row) @ self.per_metre
        spans = [
            (turn[0, 0] * east + turn[0, 1] * north, turn[1, 0] * east + turn[1, 1] * north) for east, north in steps
        ]
        sampled = plane_areas if by_area else plane_samples
        return sampled(row + self.top, column, (du, v), spans, grid, zooms), faces

    def _compiled_samples(
        self, lon_deg: float, grid: PixelGrid, zooms: tuple[int, int], by_area: bool
    ) -> tuple[Sequence[Sampled], int]:
        from . import sampling

        pixels = sampling.SeenPixels.blank(int(np.count_nonzero(np.isfinite(self.hits.t))))
        heights, has_holes = self.surface.grid_heights_m, self.surface.has_holes
        rays = self.rays.ways, self.rays.points
        count, faces = sampling.seen_pixels(heights, has_holes, *self.hits, *rays, self.per_metre, STEEP, pixels)
        if not count:
            return [], faces
        pixels = pixels.first(count)
        to_plane = _fit_plane(self.surface, grid, lon_deg, pixels.x, pixels.y)
        turn = to_plane.slopes(pixels.x, pixels.y) @ self.per_metre
        if by_area:
            place, ways = to_plane(pixels.x, pixels.y), pixels.steps.T
            spans = [
                (turn[0, 0] * x + turn[0, 1] * y, turn[1, 0] * x + turn[1, 1] * y) for x, y in (ways[:2], ways[2:])
            ]
            return plane_areas(pixels.row + self.top, pixels.column, place, spans, grid, zooms), faces
        kinds = np.empty(count, np.int64)
        world = float(grid.world_px(0))
        sampling.detail(pixels, *to_plane.coefficients, turn, world, zooms, NEAREST_PX, MOST_POWER, KIND_BITS, kinds)
        counts = np.bincount(kinds)
        each = Detail.of_kinds(np.arange(len(counts)))
        first_pixel = np.cumsum(counts) - counts
        samples = counts * each.samples_x * each.samples_y
        first_sample = np.cumsum(samples) - samples
        row, column = np.empty((2, count), np.int64)
        du, v = np.empty((2, int(samples.sum())))
        begin = first_pixel.copy(), first_sample.copy()
        sampling.spread_samples(pixels, kinds, each.samples_x, each.samples_y, *begin, row, column, du, v)
        found: list[Sampled] = []
        for kind in np.flatnonzero(counts).tolist():
            some = slice(first_pixel[kind], first_pixel[kind] + counts[kind])
            all_samples = slice(first_sample[kind], first_sample[kind] + samples[kind])
            du_each, v_each = (at[all_samples].reshape(counts[kind], -1) for at in (du, v))
            found.append(Samples(int(each.zoom[kind]), row[some] + self.top, column[some], du_each, v_each))
        return found, faces


class _Polynomials:
    """World fractions of another plane, as polynomials in a surface's columns and rows."""

    def __init__(self, middle: Floats, half: Floats, factors: Floats) -> None:
        self._middle, self._half, self._factors = middle, half, factors

    @property
    def coefficients(self) -> tuple[Floats, Floats, Floats]:
        """Middle and half of the extent in columns and rows, and coefficients (2, n, n) on it, by powers of both."""
        return self._middle, self._half, self._factors

    def __call__(self, column: Floats, row: Floats) -> tuple[Floats, Floats]:
        """World fractions at columns and rows (n,)."""
        x, y = ((at - m) / h for at, m, h in zip((column, row), self._middle, self._half))
        return _value(x, y, self._factors[0]), _value(x, y, self._factors[1])

    def slopes(self, column: Floats, row: Floats) -> Floats:
        """Derivatives (2, 2) of the fractions by column and row, at the mean of points (n,)."""
        x, y = np.array(np.mean(column)), np.array(np.mean(row))
        found: Floats = np.array(
            [
                [self(x + step_x, y + step_y)[axis] - self(x - step_x, y - step_y)[axis]
                 for step_x, step_y in ((0.5, 0.0), (0.0, 0.5))]
                for axis in (0, 1)
            ]
        )  # fmt: skip
        return found


def _value(x: Floats, y: Floats, factors: Floats) -> Floats:
    """Values of a polynomial with coefficients (n, n), by powers of x and of y."""
    values: Floats = polyval2d(x, y, factors)  # type: ignore[no-untyped-call, unused-ignore]
    return values


def _fit_plane(surface: Surface, grid: PixelGrid, lon_deg: float, column: Floats, row: Floats) -> _Polynomials:
    """Fit polynomials from columns and rows of a surface, over the extent of points (n,), to world fractions of a grid.

    On the map, fractions count from the meridian of ``lon_deg``.
    """
    lows = np.array([column.min(), row.min()]) - 1.0
    highs = np.array([column.max(), row.max()]) + 1.0
    middle, half = (lows + highs) / 2.0, (highs - lows) / 2.0

    def exact(x: Floats, y: Floats) -> Floats:
        lat, lon = surface.places(middle[0] + half[0] * x, middle[1] + half[1] * y)
        lon = lon_deg + wrap_lon_deg(lon - lon_deg)
        u, v = grid.plane.forward(lat, lon)
        return np.stack([u - float(grid.meridian_u(np.asarray(lon_deg))), v])

    # Chebyshev nodes along each side, enough for the highest degree, 5.
    nodes = np.cos(np.pi * (np.arange(9) + 0.5) / 9)
    x, y = (at.ravel() for at in np.meshgrid(nodes, nodes))
    between = (nodes[1:] + nodes[:-1]) / 2.0
    check_x, check_y = (at.ravel() for at in np.meshgrid(between, between))
    wanted, checked = exact(x, y), exact(check_x, check_y)
    good, good_check = np.isfinite(wanted).all(axis=0), np.isfinite(checked).all(axis=0)
    # 0.02 px of the finest zoom.
    allowed = 0.02 / grid.world_px(grid.native_zoom)
    for degree in (1, 2, 3, 5):
        system = polyvander2d(x, y, [degree, degree])[good]  # type: ignore[no-untyped-call, unused-ignore]
        factors = np.linalg.lstsq(system, wanted[:, good].T, rcond=None)[0].T.reshape(2, degree + 1, degree + 1)
        found = _Polynomials(middle, half, factors)
        off = np.stack([_value(check_x, check_y, part) for part in factors]) - checked
        if float(np.abs(off[:, good_check]).max(initial=0.0)) <= allowed:
            break
    return found
