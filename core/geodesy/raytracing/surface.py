"""Relief as a surface: heights on a grid, and the first hits of a camera's rays."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...arrays import Flags, Floats, NDArray, Numbers
from ...external.compiling import uses_numba
from ..ellipsoid import WGS84, sight_lines, trace
from ..mercator import PixelGrid
from .paths import Paths, evaluate, fit_paths, interpolate_rays
from .pixel_rays import PixelRays, end_of_bundles, finer, on_grid
from .pyramid import Pyramid

if TYPE_CHECKING:
    from .kernels import HeightBlocks, Rules

#: Sides, px, of square bundles of pixels followed together; each bundle leads the smaller ones in it near the ground.
_BUNDLES_PX = (64, 16, 4)
#: The same for compiled code.
_COMPILED_BUNDLES_PX = (32, 8)
#: Rows of pixels followed at a time: their data fits a processor's cache.
_STRIPE_PX = 32
#: Iterations of Newton's method.
_TURNS = 3
#: Most steps along a ray; rays that graze a surface for longer are abandoned.
_MOST_STEPS = 1 << 14
#: Depth below a surface that rounding explains; deeper rays come from beneath, beyond the edge of the surface.
_TOUCHING_M = 1e-6
#: Metres per t by which chords may leave single rays, and share of an image's tolerance for its rays.
_CHORD, _CHORD_SHARE = 1e-8, 0.1
#: Factor on the speed of rays for its growth within a step.
_SPEEDING = 1.01
#: Least speed by which to divide.
_SLOWEST = 1e-12
#: Cells for each one looked at, up to which all are packed first.
_PACKED_CELLS = 16


class Hits(NamedTuple):
    """First points where rays hit a surface, (n,) each.

    Attributes
    ----------
    t : array
        Distance along the ray, in units of its direction; NaN for a miss.
    column, row : array
        Position on the surface, in pixels from its first pixel's centre; NaN for a miss.
    """

    t: Floats
    column: Floats
    row: Floats


@dataclass(frozen=True, eq=False)
class Surface:
    """Heights above the ellipsoid, bilinear between the pixel centres of a grid.

    Parameters
    ----------
    grid : PixelGrid
    zoom : int
        Zoom of the pixels that have the heights.
    left_px, top_px : int
        First pixel.
    heights_m : array (rows, columns)
        NaN where there is no ground; the four cells around such a pixel have no ground either.
    holes : array (rows, columns) of bool, or None
        Pixels whose heights the first source lacks: filled from other sources, or NaN. None if it lacks none.
    interpolated : array (rows, columns) of bool, or None
        Pixels whose heights are interpolated because no source has them. None if no height is.
    """

    grid: PixelGrid
    zoom: int
    left_px: int
    top_px: int
    heights_m: NDArray[Any]
    holes: Flags | None = None
    interpolated: Flags | None = None

    @property
    def cells(self) -> tuple[int, int]:
        """Rows and columns of the cells between pixels' centres."""
        rows, columns = self.heights_m.shape
        return rows - 1, columns - 1

    def position(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Columns and rows from the first pixel's centre (any shape)."""
        u, v = self.grid.plane.forward(lat_deg, lon_deg)
        world = self.grid.world_px(self.zoom)
        return u * world - (self.left_px + 0.5), v * world - (self.top_px + 0.5)

    @cached_property
    def corners_m(self) -> Floats:
        """Height of each cell's upper left corner, rise along rows, rise along columns, and twist: (cells, 4)."""
        h = np.asarray(self.heights_m, np.float64)
        a, b, c, d = h[:-1, :-1], h[:-1, 1:], h[1:, :-1], h[1:, 1:]
        corners: Floats = np.stack([a, b - a, c - a, (d - c) - (b - a)], axis=-1).reshape(-1, 4)
        return corners

    def _corners(self, i: Numbers, j: Numbers) -> tuple[Floats, ...]:
        """`corners_m` of cells (n,)."""
        # Packing all cells pays for images' rays. Compiled code leaves few cells to look at, and so do flights.
        is_packed = "corners_m" in vars(self)
        if not uses_numba() and (is_packed or _PACKED_CELLS * len(i) > self.cells[0] * self.cells[1]):
            return tuple(self.corners_m.take(i * self.cells[1] + j, axis=0).T)
        a, b, c, d = (
            np.asarray(self.heights_m[i + down, j + right], np.float64) for down in (0, 1) for right in (0, 1)
        )
        return a, b - a, c - a, (d - c) - (b - a)

    @cached_property
    def lowest_m(self) -> float:
        """Lowest height."""
        return float(np.nanmin(self.heights_m))

    @cached_property
    def has_ground(self) -> bool:
        """Whether there is ground somewhere."""
        return bool(np.isfinite(self.heights_m).any())

    @cached_property
    def has_holes(self) -> bool:
        """Whether ground is missing somewhere."""
        return bool(np.isnan(self.heights_m).any())

    @cached_property
    def highest_m(self) -> float:
        """Highest height."""
        return float(np.nanmax(self.heights_m))

    @cached_property
    def _tops(self) -> Pyramid:
        """Greatest heights."""
        h = np.where(np.isnan(self.heights_m), -np.inf, self.heights_m)
        return Pyramid.build(np.maximum(np.maximum(h[:-1, :-1], h[:-1, 1:]), np.maximum(h[1:, :-1], h[1:, 1:])))

    @cached_property
    def _slopes(self) -> tuple[Pyramid, Pyramid]:
        """Greatest slopes along rows and along columns, metres per pixel, up or down."""
        h = np.asarray(self.heights_m, np.float64)
        across, down = np.abs(np.diff(h, axis=1)), np.abs(np.diff(h, axis=0))
        # A cell without ground counts as infinitely steep.
        first, second = (
            Pyramid.build(np.where(np.isnan(steep), np.inf, steep))
            for steep in (np.maximum(across[:-1], across[1:]), np.maximum(down[:, :-1], down[:, 1:]))
        )
        return first, second

    @cached_property
    def grid_heights_m(self) -> Floats:
        """Heights as `kernels` take them."""
        kind = np.float32 if self.heights_m.dtype == np.float32 else np.float64
        return np.ascontiguousarray(self.heights_m, kind)

    @cached_property
    def _blocks(self) -> tuple[HeightBlocks, Rules]:
        """What `kernels` need of the surface beside its heights."""
        from .kernels import HeightBlocks, Rules

        blocks = HeightBlocks.build(self.grid_heights_m)
        return blocks, Rules(self.lowest_m, _TOUCHING_M, _SPEEDING, _SLOWEST, _MOST_STEPS)

    def heights(self, column: Floats, row: Floats) -> Floats:
        """Heights at columns and rows (n,); NaN without ground."""
        rows, columns = self.cells
        inside = (column >= 0.0) & (column <= columns) & (row >= 0.0) & (row <= rows)
        x, y = np.where(inside, column, 0.0), np.where(inside, row, 0.0)
        i, j = (np.minimum(at.astype(np.int64), most - 1) for at, most in ((y, rows), (x, columns)))
        a, b, c, d = self._corners(i, j)
        x, y = x - j, y - i
        return np.where(inside, a + b * x + c * y + d * x * y, np.nan)

    def slopes(self, column: Floats, row: Floats) -> tuple[Floats, Floats]:
        """Rise of heights per pixel along rows and along columns, at columns and rows (n,)."""
        rows, columns = self.cells
        i = np.clip(row.astype(np.int64), 0, rows - 1)
        j = np.clip(column.astype(np.int64), 0, columns - 1)
        _, b, c, d = self._corners(i, j)
        return b + d * (row - i), c + d * (column - j)

    def first_hits(self, start: Floats, coefficients: Floats, farthest: Floats) -> Hits:
        """First hits of rays, given by the coefficients of their paths, up to t (n,)."""
        if uses_numba():
            from . import kernels

            longest = self._longest(start, np.abs(coefficients), farthest, _CHORD)
            found = np.full((3, len(farthest)), np.nan)
            starts = np.ascontiguousarray(start if start.ndim == coefficients.ndim - 1 else start[:, np.newaxis])
            ways = np.ascontiguousarray(coefficients)
            kernels.search(self.grid_heights_m, *self._blocks, starts, ways, longest, farthest, found)
            return Hits(*found)
        t, _ = self.clear(start, coefficients, np.zeros(len(farthest)), farthest, None)
        return self.search_cells(start, coefficients, t, farthest)

    def _longest(self, start: Floats, most: Floats, farthest: Floats | float, off_per_t: float) -> Floats:
        """Longest chords of rays, in √t, that leave them by at most ``off_per_t`` metres per t.

        ``most`` (degree, 3, n) are bounds of the coefficients. A chord from t to u is off by at most half the second
        derivative times (√u - √t)², per t: a third of what is allowed along each axis.
        """
        place = self.places(*start.reshape(3, -1)[:2, :1])
        cell = float(self.grid.ground_m_per_px(*place, self.zoom)[0])
        allowed = off_per_t / 3.0 / np.array([[cell], [cell], [1.0]])
        with np.errstate(divide="ignore"):
            longest: Floats = np.sqrt(2.0 * allowed / _bends(most, farthest)).min(axis=0)
        return longest

    def first_points(
        self, lat_deg: Floats, lon_deg: Floats, height_m: Floats, rays_enu: Floats, lowest_m: float
    ) -> tuple[Floats, Floats, Floats, Flags]:
        """First hits of single rays, each of a different camera.

        Parameters
        ----------
        lat_deg, lon_deg, height_m : array (n,)
            Positions of the cameras, with heights above the ellipsoid.
        rays_enu : array (n, 3)
        lowest_m : float
            Height below which rays are not followed.

        Returns
        -------
        lat_deg, dlon_deg, height_m : array (n,)
            NaN for a miss; longitudes count from the cameras'.
        hit : array (n,) of bool
        """
        ground = WGS84.raised(lowest_m - 1.0)
        level = trace(lat_deg, height_m - lowest_m + 1.0, rays_enu, ground)
        with np.errstate(invalid="ignore"):
            ends = sight_lines(lat_deg, height_m - lowest_m + 1.0, level.lat_deg, level.dlon_deg, ground)
            farthest = np.linalg.norm(ends, axis=1) / np.linalg.norm(rays_enu, axis=1)
        # Longer paths need polynomials of a higher degree.
        at = np.flatnonzero(level.hit & (farthest < 50_000.0))
        lat, dlon, height = (np.full(len(lat_deg), np.nan) for _ in range(3))
        hit = np.zeros(len(lat_deg), bool)
        batch = 1 << 16  # bounds memory
        for first in range(0, len(at), batch):
            some = at[first : first + batch]

            def coordinates(points_lat: Floats, points_dlon: Floats, up: Floats) -> Floats:
                return np.stack([*self.position(points_lat, lon_deg[some] + points_dlon), up], axis=1)  # noqa: B023

            last = level.lat_deg[some], level.dlon_deg[some], np.full(len(some), lowest_m - 1.0)
            start, coefficients = interpolate_rays(
                lat_deg[some], height_m[some], rays_enu[some], farthest[some], last, coordinates
            )
            hits = self.first_hits(start, coefficients, farthest[some])
            good = np.isfinite(hits.t)
            points_lat, points_lon = self.places(hits.column[good], hits.row[good])
            lat[some[good]] = points_lat
            height[some[good]] = self.heights(hits.column[good], hits.row[good])
            apart = points_lon - lon_deg[some[good]]
            dlon[some[good]] = apart - 360.0 * np.rint(apart / 360.0)
            hit[some[good]] = True
        return lat, dlon, height, hit

    def paths(
        self,
        lat_deg: float,
        lon_deg: float,
        height_m: float,
        rays: PixelRays,
        tolerance_px: float,
        reach_m: float = np.inf,
    ) -> tuple[Paths, float, float]:
        """Paths of an image's rays over the surface.

        Parameters
        ----------
        lat_deg, lon_deg, height_m : float
            Position of the camera, with its height above the ellipsoid.
        tolerance_px : float
            Largest error, in pixels of the image.
        reach_m : float
            Level distance up to which rays are followed.

        Returns
        -------
        Paths
            Paths of column, row and height.
        farthest : float
            t beyond which no ray hits the surface.
        off_px : float
            Bound of the paths' error, in pixels of the image.
        """
        directions, shape = rays.spread(81), (81, 81)
        away = min(self.away_m(lat_deg, lon_deg, height_m), reach_m)
        with np.errstate(divide="ignore"):
            down = np.where(directions[:, 2] < 0.0, (height_m - self.lowest_m) / -directions[:, 2], np.inf)
        # Paths are fitted a little farther than rays are followed.
        farthest = 1.05 * np.minimum(down, away / np.maximum(np.hypot(*directions[:, :2].T), _SLOWEST))
        reach = float(farthest.max())
        # Fit 6 x 6 rays and the longest in each column, which reach the lowest ground and the edge at once.
        fitted = np.zeros(shape, bool)
        fitted[::16, ::16] = True
        fitted[farthest.reshape(shape).argmax(axis=0)[::16], np.arange(0, 81, 16)] = True
        directions, farthest = directions[fitted.ravel()], farthest[fitted.ravel()]
        cell = float(self.grid.ground_m_per_px(np.array(lat_deg), np.array(lon_deg), self.zoom))
        tolerances = tolerance_px * rays.pixel / np.array([cell, cell, 1.0]) / 3.0

        def coordinates(lat: Floats, dlon: Floats, height: Floats) -> Floats:
            return np.stack([*self.position(lat, lon_deg + dlon), height], axis=1)

        found, off = fit_paths(lat_deg, height_m, directions, farthest, coordinates, tolerances)
        return found, reach, tolerance_px * float((off / tolerances).sum()) / 3.0

    def away_m(self, lat_deg: float, lon_deg: float, height_m: float) -> float:
        """Level distance from a camera to the surface's farthest corner."""
        rows, columns = self.cells
        lat, lon = self.places(np.array([0.0, columns, 0.0, columns]), np.array([0.0, 0.0, rows, rows]))
        corners = sight_lines(np.array(lat_deg), np.array(height_m), lat, lon - lon_deg)
        return float(np.hypot(corners[:, 0], corners[:, 1]).max())

    def places(self, column: Floats, row: Floats) -> tuple[Floats, Floats]:
        """Latitudes and longitudes of columns and rows (any shape)."""
        world = self.grid.world_px(self.zoom)
        return self.grid.plane.inverse((column + self.left_px + 0.5) / world, (row + self.top_px + 0.5) / world)

    def image_hits(
        self,
        paths: Paths,
        rays: PixelRays,
        spans: tuple[Floats, Floats],
        tolerance_px: float,
        *,
        begins: bool = False,
    ) -> Hits:
        """First hits of the rays through the pixel centres of an image, (height, width) each.

        Pixels are followed in bundles; each starts at the point before which the larger one certainly hits nothing. If
        rays fall more steeply than the ground around them, there is exactly one hit: the tangent plane at the hit of a
        bundle's middle ray gives a guess for the others, which Newton's method refines. Other rays continue from cell
        to cell. Compiled code follows each ray through blocks of cells, see `kernels`.

        Parameters
        ----------
        paths : Paths
            Paths of column, row and height.
        spans : tuple of array (height, width)
            t from which and up to which hits count; the first is infinite to skip a pixel.
        tolerance_px : float
            Largest error of hits along the ray, in pixels of the image.
        begins : bool
            Whether rays that are below the surface where their spans begin hit it there.
        """
        forms, (after, until) = rays.forms(paths), spans
        farthest = float(np.max(until, where=np.isfinite(after), initial=0.0))
        close = tolerance_px * rays.pixel
        if uses_numba():
            return self._compiled_hits(paths.start, forms, rays, spans, farthest, close, begins)
        hits = self._bundled_hits(paths.start, forms, rays, after, farthest, close)
        if begins:
            self._begin_below(paths, rays, after, hits)
        with np.errstate(invalid="ignore"):
            beyond = hits.t > until
        for values in hits:
            values[beyond] = np.nan
        return hits

    def _compiled_hits(
        self,
        start: Floats,
        forms: list[Floats],
        rays: PixelRays,
        spans: tuple[Floats, Floats],
        farthest: float,
        close: float,
        begins: bool,
    ) -> Hits:
        from . import kernels

        corners = on_grid(forms, *(np.array([0.0, side]) for side in rays.plane_px))
        most = np.abs(corners).max(axis=(2, 3))[..., np.newaxis]
        (longest,) = self._longest(start, most, farthest, _CHORD_SHARE * close)
        found = np.full((3, rays.height, rays.width), np.nan)
        kernels.image_hits(
            self.grid_heights_m,
            *self._blocks,
            start,
            _padded(forms),
            rays.points,
            longest,
            spans,
            farthest,
            begins,
            _COMPILED_BUNDLES_PX,
            kernels.Scratch.blank(len(forms)),
            found,
        )
        return Hits(*found)

    def _bundled_hits(
        self, start: Floats, forms: list[Floats], rays: PixelRays, after: Floats, farthest: float, close: float
    ) -> Hits:
        least, smaller = [after], 1
        for side in _BUNDLES_PX[::-1]:
            least.append(end_of_bundles(least[-1], side // smaller))
            smaller = side
        t, larger = least.pop(), _BUNDLES_PX[0]
        for side in _BUNDLES_PX:
            middle, spread = rays.bundles(forms, side)
            # 0.1 % more for rays between the corners of a bundle.
            spread = 1.001 * np.stack([spread[:, :2].max(axis=1), spread[:, 2]], axis=1)
            flat, pairs = (len(forms), 3, -1), (len(forms), 2, -1)
            begin = t if side == larger else np.maximum(least.pop(), finer(t, middle.shape[2:], larger // side))
            clear, may_hit = self.clear(
                start, middle.reshape(flat), begin.ravel(), np.full(begin.size, farthest), spread.reshape(pairs)
            )
            t, larger = np.where(may_hit, clear, np.inf).reshape(middle.shape[2:]), side
            if np.isinf(t).all():
                return Hits(*(np.full(after.shape, np.nan) for _ in range(3)))
        falls = self._falling(start, middle.reshape(flat), spread.reshape(pairs), t.ravel(), farthest)
        falling = [one.reshape(t.shape) for one in falls]
        return self._pixels(start, forms, rays, (after, t, *falling), farthest, close)

    def _begin_below(self, paths: Paths, rays: PixelRays, after: Floats, hits: Hits) -> None:
        """Record hits of the rays that are below the surface at the t from which hits count."""
        row, column = np.nonzero(np.isfinite(after) & np.isnan(hits.t))
        t = after[row, column]
        at_column, at_row, height = paths.evaluate(rays.through(row, column), t)
        with np.errstate(invalid="ignore"):
            below = self.heights(at_column, at_row) >= height
        for whole, part in zip(hits, (t, at_column, at_row)):
            whole[row[below], column[below]] = part[below]

    def _falling(
        self, start: Floats, middle: Floats, spread: Floats, after: Floats, farthest: float
    ) -> tuple[Floats, Floats]:
        """Least speed at which bundles approach the ground, metres per t, or 0 if unknown; and t by which they hit it.

        A bundle that falls more steeply than all slopes around it until it reaches the ground hits it once.
        """
        rate, reach = np.zeros(len(after)), np.zeros(len(after))
        t = np.where(np.isfinite(after), after, 1.0)
        x, y, h = evaluate(start, middle, t)
        per_x, per_y = (np.abs(_slope(middle[:, axis], t)) + _slope(spread[:, 0], t) for axis in (0, 1))
        fall = -_slope(middle[:, 2], t) - _slope(spread[:, 1], t)
        wide, deep = (_polynomial(spread[:, axis], t) for axis in (0, 1))
        rows, columns = self.cells
        near = self.heights(np.clip(x, 0.0, columns), np.clip(y, 0.0, rows))
        across, down = self._slopes
        # Up to 8 levels: within blocks of 128 cells.
        for level in range(min(8, across.levels)):
            steep_x, steep_y = (pyramid.around(level, x, y) for pyramid in (across, down))
            steep_x, steep_y = np.maximum(steep_x, 0.0), np.maximum(steep_y, 0.0)
            with np.errstate(invalid="ignore", divide="ignore"):
                found = (fall - steep_x * per_x - steep_y * per_y) / _SPEEDING
                rest = (h - near + deep + (steep_x + steep_y) * wide) / found
                stays = wide + _SPEEDING * np.maximum(per_x, per_y) * rest <= 2.0**level
                good = (found > 0.0) & stays & (t + rest <= farthest)
            reach = np.where((rate == 0.0) & good, t + rest, reach)
            rate = np.where((rate == 0.0) & good, found, rate)
        return rate, reach

    def _pixels(
        self,
        start: Floats,
        forms: list[Floats],
        rays: PixelRays,
        bundles: tuple[Floats, ...],
        farthest: float,
        close: float,
    ) -> Hits:
        """First hits of the pixels of bundles that hit nothing before t; t is infinite if they hit nothing at all."""
        after, t, falls, reach = bundles
        side = _BUNDLES_PX[-1]
        found = Hits(*(np.full((rays.height, rays.width), np.nan) for _ in range(3)))
        for top in range(0, rays.height, _STRIPE_PX):
            bottom = min(top + _STRIPE_PX, rays.height)
            part = slice(top // side, -(-bottom // side))
            if not np.isfinite(t[part]).any():
                continue
            coefficients = rays.coefficients(forms, top, bottom)
            shape = coefficients.shape[2:]
            coefficients = coefficients.reshape(len(forms), 3, -1)
            # Newton's method may use 5 % of the error allowed.
            within = 0.05 * close * falls[part]
            guess = self._guessed(start, forms, rays.middles(forms, top, bottom, side), (t[part], within), shape)
            first, within, until = (finer(one, shape, side).ravel() for one in (t[part], within, reach[part]))
            first = np.maximum(first, after[top:bottom].ravel())
            rest = np.isfinite(first)
            some = np.flatnonzero(rest & (within > 0.0))
            hits = self._newton(
                start,
                coefficients.take(some, axis=2),
                np.fmax(guess.ravel()[some], first[some]),
                within[some],
            )
            good = np.flatnonzero((hits.t >= first[some]) & (hits.t <= until[some]))
            some = some[good]
            whole = [values[top:bottom].reshape(-1) for values in found]
            for values, new in zip(whole, hits):
                values[some] = new.take(good)
            rest[some] = False
            others = np.flatnonzero(rest)
            if len(others):
                ends = np.full(len(others), farthest)
                exact = self.search_cells(start, coefficients.take(others, axis=2), first[others], ends)
                for values, new in zip(whole, exact):
                    values[others] = new
        return found

    def _guessed(
        self,
        start: Floats,
        forms: list[Floats],
        middles: tuple[Floats, Floats, Floats],
        bundles: tuple[Floats, Floats],
        shape: tuple[int, ...],
    ) -> Floats:
        """Values of t where rays at x and y hit the ground's tangent plane at the hit of their bundle's middle ray."""
        (coefficients, off_x, off_y), (t, within) = middles, bundles
        some = np.flatnonzero(np.isfinite(t) & (within > 0.0))
        coefficients = coefficients.take(some, axis=2)
        met = self._newton(start, coefficients, t.ravel()[some], within.ravel()[some])
        with np.errstate(invalid="ignore"):
            across, down = self.slopes(met.column, met.row)
        fall = [_slope(coefficients[:, axis], met.t) for axis in range(3)]
        rises = (fall, forms[0][:, 0, 1], forms[0][:, 1, 0])
        facing, *turns = (rise[2] - across * rise[0] - down * rise[1] for rise in rises)
        values = np.full((3, t.size), np.nan)
        values[:, some] = met.t, turns[0] / facing, turns[1] / facing
        met_t, by_x, by_y = (finer(one.reshape(t.shape), shape, _BUNDLES_PX[-1]) for one in values)
        guess: Floats = met_t / (1.0 + by_x * off_x + by_y * off_y)
        return guess

    def _newton(self, start: Floats, coefficients: Floats, t: Floats, within: Floats) -> Hits:
        """Hits (n,) near t, off by at most ``within`` metres of height per t; NaN if not found."""
        rows, columns = self.cells
        found = Hits(*(np.full(len(t), np.nan) for _ in range(3)))
        index = np.arange(len(t))
        for turn in range(_TURNS + 1):
            x, y, h = evaluate(start, coefficients, t)
            with np.errstate(divide="ignore", invalid="ignore"):
                j = np.minimum(np.maximum(x, 0.0), columns - 1.0).astype(np.int32)
                i = np.minimum(np.maximum(y, 0.0), rows - 1.0).astype(np.int32)
                a, b, c, d = self.corners_m.take(i * np.int32(columns) + j, axis=0).T
                u, v = x - j, y - i
                across = b + d * v
                off = h - (a + across * u + c * v)
                good = np.abs(off) <= within * t
                inside = (x >= 0.0) & (x <= columns) & (y >= 0.0) & (y <= rows)
            at = np.flatnonzero(good & inside)
            for whole, part in zip(found, (t, x, y)):
                whole[index.take(at)] = part.take(at)
            if turn == _TURNS or good.all():
                break
            left = np.flatnonzero(~good)
            index, within, t, off, across, down = _only(left, index, within, t, off, across, c + d * u)
            coefficients = coefficients.take(left, axis=2)
            with np.errstate(divide="ignore", invalid="ignore"):
                per_x, per_y, per_h = (_slope(coefficients[:, axis], t) for axis in range(3))
                step = off / (per_h - across * per_x - down * per_y)
                # Holes, and rays along the ground, give no useful step.
                t = np.where(np.abs(step) <= t, t - step, t)
        return found

    def clear(
        self,
        start: Floats,
        coefficients: Floats,
        after: Floats,
        farthest: Floats,
        spread: Floats | None,
    ) -> tuple[Floats, Flags]:
        """Follow rays, or bundles of rays, for as long as they certainly hit nothing.

        Parameters
        ----------
        start, coefficients
            Column, row and height along the middle rays; see `evaluate`.
        after, farthest : array (n,)
            t from which and up to which they are followed.
        spread : array (degree, 2, n), or None
            Largest distance of the other rays of a bundle from the middle one: coefficients of t, t², …, in pixels and
            in metres of height.

        Returns
        -------
        t : array (n,)
        may_hit : array (n,) of bool
            Whether the ray may hit something from t on.
        """
        tops = self._tops
        t_found, may_hit = np.array(after, np.float64), np.zeros(len(after), bool)
        index = np.flatnonzero(after <= farthest)
        t, end, c = t_found.take(index), farthest.take(index), coefficients.take(index, axis=2)
        start = _take_starts(start, index)
        s = None if spread is None else spread.take(index, axis=2)
        # Single rays start near the ground, so at a low level.
        level = np.full(len(index), tops.levels - 1 if s is not None else min(2, tops.levels - 1))
        for _ in range(_MOST_STEPS):
            if not len(index):
                break
            x, y, h = evaluate(start, c, t)
            per_x, per_y = _speed(c, t)
            # Within the width of a block, in any direction, no ray leaves the neighbouring blocks.
            size = np.ldexp(1.0, level)
            per_t = np.maximum(np.abs(per_x), np.abs(per_y))
            wide, widens, deep = np.zeros(1), np.zeros(1), np.zeros(1)
            if s is not None:
                wide, widens = _polynomial(s[:, 0], t), _slope(s[:, 0], t)
                per_t = per_t + widens
            # Blocks that are not much wider than the bundle allow only tiny steps.
            roomy = wide <= 0.5 * size
            step = np.where(roomy, size - wide, 0.0) / (_SPEEDING * np.maximum(per_t, _SLOWEST))
            ahead = np.minimum(t + step, end)
            if s is not None:
                deep = _polynomial(s[:, 1], ahead)
            sag = _bulge(c) * (ahead - t) ** 2
            top = tops.around(level, x, y)
            over, fall = h - deep - sag - top, h - evaluate(start[2:], c[:, 2:], ahead)[0]
            free = roomy & (over > np.maximum(fall, 0.0))
            partly = roomy & ~free & (over > 0.0)
            reach = t + np.where(partly, over / np.where(partly, fall, 1.0), 0.0) * (ahead - t)
            stuck = ~free & ((level <= 0) | ~roomy)
            gone = ~stuck & (
                (ahead >= end) & free
                | self._leaves(x, y, per_x, per_y, wide, widens)
                | (h + deep < self.lowest_m - _TOUCHING_M)
            )
            t = np.where(free, ahead, np.where(partly, reach, t))
            level = np.where(free, np.minimum(level + 1, tops.levels - 1), np.maximum(level - 1, 0))
            done = stuck | gone
            if done.any():
                at, keep = np.flatnonzero(done), np.flatnonzero(~done)
                t_found[index.take(at)], may_hit[index.take(at)] = t.take(at), stuck.take(at)
                index, t, end, level = _only(keep, index, t, end, level)
                start, c = _take_starts(start, keep), c.take(keep, axis=2)
                s = None if s is None else s.take(keep, axis=2)
        t_found[index], may_hit[index] = t, True
        return t_found, may_hit

    def _leaves(
        self,
        x: Floats,
        y: Floats,
        per_x: Floats,
        per_y: Floats,
        wide: Floats | float = 0.0,
        widens: Floats | float = 0.0,
    ) -> Flags:
        """Whether rays, or bundles that widen at a rate, lie beside the surface and move away from it."""
        rows, columns = self.cells
        beside: Flags = (
            ((x + wide < 0.0) & (per_x + widens <= 0.0))
            | ((x - wide > columns) & (per_x - widens >= 0.0))
            | ((y + wide < 0.0) & (per_y + widens <= 0.0))
            | ((y - wide > rows) & (per_y - widens >= 0.0))
        )
        return beside

    def search_cells(self, start: Floats, coefficients: Floats, after: Floats, farthest: Floats) -> Hits:
        """First hits, searched cell by cell from where `clear` stopped; none where ``after`` is infinite."""
        n = len(after)
        found = Hits(*(np.full(n, np.nan) for _ in range(3)))
        rows, columns = self.cells
        index, t, end, c = np.arange(n), np.asarray(after, np.float64), farthest, coefficients
        # Whether rays were above ground in the cell before.
        over = np.zeros(n, bool)
        for count in range(_MOST_STEPS):
            # Every eight cells, try again to skip whole blocks.
            if count % 8 == 7:
                t, may_hit = self.clear(start, c, t, end, None)
                left = np.flatnonzero(may_hit)
                index, t, end, over = _only(left, index, t, end, over)
                start, c = _take_starts(start, left), c.take(left, axis=2)
                fresh = True
            else:
                fresh = count == 0
            if not len(index):
                break
            if fresh:
                x, y, h = evaluate(start, c, t)
                per_x, per_y = _speed(c, t)
                j, i = (
                    np.floor(at).astype(np.int64) - ((at == np.floor(at)) & (per < 0.0))
                    for at, per in ((x, per_x), (y, per_y))
                )
            else:
                per_x, per_y = _speed(c, t)
            with np.errstate(divide="ignore", invalid="ignore"):
                to_x = np.where(per_x != 0.0, (j + (per_x > 0.0) - x) / per_x, np.inf)
                to_y = np.where(per_y != 0.0, (i + (per_y > 0.0) - y) / per_y, np.inf)
            across = to_x <= to_y
            t_next = np.minimum(t + np.maximum(np.minimum(to_x, to_y), 0.0), end)
            x_next, y_next, h_next = evaluate(start, c, t_next)
            inside = (j >= 0) & (j < columns) & (i >= 0) & (i < rows)
            cell = np.where(inside, i * columns + j, 0)
            u, v, u_next, v_next = (
                np.minimum(np.maximum(at, 0.0), 1.0) for at in (x - j, y - i, x_next - j, y_next - i)
            )
            corners = self.corners_m.take(cell, axis=0)
            share = first_share(corners, over, u, v, h, u_next, v_next, h_next)
            hit = np.flatnonzero(inside & (share <= 1.0))
            part, ray = share.take(hit), index.take(hit)
            for whole, one, one_next in zip(found, (t, x, y), (t_next, x_next, y_next)):
                begin = one.take(hit)
                whole[ray] = begin + part * (one_next.take(hit) - begin)
            over = inside & np.isfinite(corners[:, 3])
            # Rays that neither hit the ground nor came from beneath it go on.
            keep = np.flatnonzero(((share > 1.0) | ~inside) & (t_next < end) & ~self._leaves(x, y, per_x, per_y))
            j += across * np.sign(per_x).astype(np.int64)
            i += ~across * np.sign(per_y).astype(np.int64)
            index, t, end, over, x, y, h, j, i = _only(keep, index, t_next, end, over, x_next, y_next, h_next, j, i)
            start, c = _take_starts(start, keep), c.take(keep, axis=2)
        # Rounding may put hits on the outermost edge of the surface beyond it.
        for values, most in ((found.column, columns), (found.row, rows)):
            np.clip(values, 0, most, out=values)
        return found


def first_share(
    corners: Floats,
    over: Flags,
    x: Floats,
    y: Floats,
    h: Floats,
    x_next: Floats,
    y_next: Floats,
    h_next: Floats,
) -> Floats:
    """Share of chords through cells at which they reach the surface from above, (n,).

    Infinite if a chord stays above. A chord that starts below the surface hits it at the start if the ray was above
    ground in the cell before: rounding moves the end of a step past the cell's edge, where a cliff may rise. Other
    chords that start below come from beneath the ground: NaN.
    """
    a, b, c, d = corners.T
    dx, dy = x_next - x, y_next - y
    above = h - (a + b * x + c * y + d * x * y)
    rising = b * dx + c * dy + d * (x * dy + y * dx) - (h_next - h)
    bend = d * dx * dy
    # bend s² + rising s - above = 0
    square = rising * rising + 4.0 * bend * above
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(square)
        share = np.where((rising >= 0.0) | (bend <= 0.0), 2.0 * above / (rising + root), (root - rising) / (2.0 * bend))
        share = np.where(share >= 0.0, share, np.inf)
        # Cells without ground are NaN, which no comparison counts as below.
        return np.where((above < -_TOUCHING_M) & ~over, np.nan, np.where(above <= 0.0, 0.0, share))


def _only(which: NDArray[Any], *arrays: NDArray[Any]) -> list[Any]:
    """Values of each array at some indices."""
    return [values.take(which) for values in arrays]


def _take_starts(start: Floats, which: NDArray[Any]) -> Floats:
    """Starts of some rays, from one start (c,) for all or one each (c, n)."""
    return start if start.ndim == 1 else start.take(which, axis=1)


def _speed(coefficients: Floats, t: Floats) -> tuple[Floats, Floats]:
    """Derivatives of the first two coordinates by t."""
    return _slope(coefficients[:, 0], t), _slope(coefficients[:, 1], t)


def _bulge(coefficients: Floats) -> Floats | float:
    """Largest drop of heights within a step below both its ends, per squared step: half the second derivative."""
    return np.abs(coefficients[1, 2]) if len(coefficients) > 1 else 0.0


def _padded(forms: list[Floats]) -> Floats:
    """Forms of `PixelRays.forms` as one array (degree, c, k, k)."""
    degree = len(forms)
    return np.stack([np.pad(form, [(0, 0), *2 * [(0, degree - power)]]) for power, form in enumerate(forms, 1)])


def _bends(coefficients: Floats, end: Floats | float) -> Floats:
    """Bounds of the second derivatives of polynomials from 0 to ``end``, from bounds (degree, …) of coefficients."""
    total: Floats = np.zeros(coefficients.shape[1:])
    for power in range(len(coefficients), 1, -1):
        total = total * end + power * (power - 1) * coefficients[power - 1]
    return total


def _polynomial(factors: Floats, t: Floats) -> Floats:
    """Polynomials with coefficients (degree, n) of t, t², … at t."""
    total: Floats = factors[-1] * t
    for factor in factors[-2::-1]:
        total = (total + factor) * t
    return total


def _slope(factors: Floats, t: Floats) -> Floats:
    """Derivative of `_polynomial` by t."""
    total: Floats = len(factors) * factors[-1]
    for power in range(len(factors) - 1, 0, -1):
        total = total * t + power * factors[power - 1]
    return total
