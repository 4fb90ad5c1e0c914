"""Camera frames over relief: the ground at each pixel, and the source pixels that an image is made of."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy.polynomial.polynomial import polyval2d, polyvander2d

from ...arrays import Flags, Floats, Numbers
from ..accuracy import ImageGeometry
from ..camera import Poses
from ..ellipsoid import WGS84, clearance, positions, sight_lines, trace
from ..mercator import PixelGrid, wrap_lon_deg
from ..view import ImageRays, Samples, View, detail_groups, pixel_detail, sample_offsets
from .paths import Paths
from .surface import Hits, PixelRays, Surface

#: Most cells of a surface; ground farther away is another surface, whose cells are twice as large.
MOST_CELLS = 1 << 21
#: Least distance, in cells, at which larger cells begin: beyond it a cell is less than a pixel of most cameras.
_LEAST_CELLS = 700.0
#: Factor on the reach of sampled rays: ground at the same distance between two of them lies beyond their chord.
_BULGE = 1.03
#: Factor on the length to which rays are followed.
_MARGIN = 1.01
#: Least number by which to divide.
_LEAST = 1e-12
#: Slope, metres per metre, above which faces cannot be seen from above: no map shows their colours.
STEEP = 2.0


class ElevationModel(Protocol):
    """Source of heights above the WGS 84 ellipsoid."""

    @property
    def title(self) -> str:
        """Name for users."""

    @property
    def attribution(self) -> str:
        """Credit for the heights."""

    def surface(self, lat_deg: Floats, lon_deg: Floats, cell_m: float = 0.0) -> Surface:
        """Heights over the bounding box of positions, with cells of at most ``cell_m``, or the finest for 0."""

    def cell_m(self, lat_deg: float, lon_deg: float) -> float:
        """Size in metres of the finest cells at a place."""


class Sighting(NamedTuple):
    """Ground at the pixels of an image, (height, width) each; NaN without ground.

    Attributes
    ----------
    depth_m : array
        Depth along the optical axis.
    lat_deg, lon_deg, height_m : array
        Ground points; longitudes are continuous with the camera's, heights are above the ellipsoid.
    slope_east, slope_north : array
        Slopes of the surface, metres per metre.
    steep : array of bool
        Steep faces, whose colours no map shows.
    """

    depth_m: Floats
    lat_deg: Floats
    lon_deg: Floats
    height_m: Floats
    slope_east: Floats
    slope_north: Floats
    steep: Flags

    @property
    def normals(self) -> Floats:
        """Unit normals of the surface, (height, width, 3), in east, north and up."""
        up = np.stack([-self.slope_east, -self.slope_north, np.ones_like(self.depth_m)], axis=-1)
        normals: Floats = up / np.linalg.norm(up, axis=-1, keepdims=True)
        return normals


class Faces(NamedTuple):
    """Pixels of an image that see steep faces, (n,) each.

    Attributes
    ----------
    row, column : array of int
    lat_deg, lon_deg : array
        Upper ends of the faces, at the edge of the roof; longitudes are in -180 … 180.
    east, north : array
        Level directions that they face: down the slope, as unit vectors.
    """

    row: Numbers
    column: Numbers
    lat_deg: Floats
    lon_deg: Floats
    east: Floats
    north: Floats


def settled(scene: ImageGeometry, height_m: float, tolerance_px: float) -> tuple[ImageGeometry, float]:
    """Round the geometry of one pose and its height, to make images independent of a processor's last digits.

    Hits of rays depend on every digit, within their tolerance, so the images of a mission would differ from machine to
    machine. Rounding moves no pixel by more than the tolerance.
    """
    pose, focal_px = scene.poses, float(scene.focal_px)
    nearest_m = float(pose.agl_m[0]) / focal_px
    # Apart from slant, each of six numbers moves a pixel of level ground by at most twice its rounding.
    share_px = tolerance_px / (16.0 * (1.0 + scene.diagonal_tangent**2))
    metre, turn = (power_of_two(share_px * size) for size in (nearest_m, math.degrees(1.0 / focal_px)))
    degree = power_of_two(math.degrees(metre / WGS84.a_m))

    def rounded(values: Floats, step: float) -> Floats:
        found: Floats = np.rint(values / step) * step
        return found

    poses = Poses(
        rounded(pose.lat_deg, degree),
        rounded(pose.lon_deg, degree),
        rounded(pose.agl_m, metre),
        *(rounded(angle, turn) for angle in pose.attitude),
    )
    return replace(scene, poses=poses), float(rounded(np.array(height_m), metre))


def power_of_two(value: float) -> float:
    """Greatest power of two that does not exceed a value."""
    return math.ldexp(0.5, math.frexp(value)[1])


@dataclass(frozen=True, eq=False)
class Tracing:
    """Rays of one image over relief, each followed to its first hit.

    Parameters
    ----------
    scene : ImageGeometry
        One pose.
    height_m : float
        Height of the camera above the WGS 84 ellipsoid.
    relief : ElevationModel
    lowest_m : float
        Lower bound of the ground that the image may show.
    tolerance_px : float
        Largest error of hits along their rays, in pixels of the image.
    """

    scene: ImageGeometry
    height_m: float
    relief: ElevationModel
    lowest_m: float
    tolerance_px: float

    @property
    def place(self) -> tuple[float, float]:
        """Latitude and longitude of the camera."""
        poses = self.scene.poses
        return float(poses.lat_deg[0]), float(poses.lon_deg[0])

    @cached_property
    def rays(self) -> PixelRays:
        """Rays of the image."""
        rays = ImageRays.from_scene(self.scene)
        return PixelRays(rays.origin, rays.per_x, rays.per_y, *self.scene.one_size_px)

    @cached_property
    def level_m(self) -> float | None:
        """Height of level ground that equals the relief within half the tolerance at every pixel; None if none does."""
        rays = self.rays
        x, y = (at.ravel() for at in np.meshgrid((0.0, float(rays.width)), (0.0, float(rays.height))))
        pixel = min(float(np.linalg.norm(per)) for per in (rays.per_x, rays.per_y))
        pixel /= float((rays.directions(x, y) ** 2).sum(axis=1).max())
        low, high = np.inf, -np.inf
        for surface, _ in self._surfaces():
            if surface.has_holes:
                return None
            low, high = min(low, surface.lowest_m), max(high, surface.highest_m)
            if high - low > self.tolerance_px * pixel * (self.height_m - high):
                return None
        return (low + high) / 2.0

    @cached_property
    def _seen(self) -> list[_Seen]:
        """Hits on surfaces from near to far; on each, of the pixels that hit no nearer surface."""
        rays, (lat, lon) = self.rays, self.place
        found: list[_Seen] = []
        unmet, after = np.ones((rays.height, rays.width), bool), np.zeros((rays.height, rays.width))
        for surface, begin_m in self._surfaces():
            if not np.isfinite(surface.heights_m).any():
                continue
            if begin_m > _MARGIN * surface.away_m(lat, lon, self.height_m):
                # The surface ends before the distance from which it counts.
                continue
            if begin_m > 0.0:
                after = np.where(unmet, begin_m / self._ways[0], np.inf)
            paths, farthest, _ = surface.paths(lat, lon, self.height_m, rays, self.tolerance_px / 2.0)
            hits = surface.image_hits(paths, rays, after, farthest, self.tolerance_px / 2.0)
            if begin_m > 0.0:
                self._begin_below(surface, paths, after, hits)
            unmet &= np.isnan(hits.t)
            found.append(_Seen(surface, hits, paths.forms[0][:2, :2]))
            if not unmet.any():
                break
        return found

    @cached_property
    def _ways(self) -> tuple[Floats, Floats]:
        """Level and upward components of the pixels' rays, (height, width) each."""
        x, y = np.arange(self.rays.width) + 0.5, np.arange(self.rays.height) + 0.5
        east, north, up = (
            origin + x * per_x + y[:, np.newaxis] * per_y
            for origin, per_x, per_y in zip(self.rays.origin, self.rays.per_x, self.rays.per_y)
        )
        return np.maximum(np.hypot(east, north), _LEAST), up

    def _begin_below(self, surface: Surface, paths: Paths, after: Floats, hits: Hits) -> None:
        """Record hits of rays that start below a surface, which may be higher than the finer, nearer one."""
        level, up = self._ways
        with np.errstate(invalid="ignore"):
            # The Earth falls away by the squared distance over twice its radius, or at least 98 % of that; 1 m is for
            # higher terms.
            height = self.height_m + after * (up + 0.98 * after * level**2 / (2.0 * WGS84.a_m))
            row, column = np.nonzero(np.isfinite(after) & np.isnan(hits.t) & (height < surface.highest_m + 1.0))
            t = after[row, column]
            at_column, at_row, height = paths.evaluate(self.rays.directions(column + 0.5, row + 0.5), t)
            below = surface.heights(at_column, at_row) >= height
        for whole, part in zip(hits, (t, at_column, at_row)):
            whole[row[below], column[below]] = part[below]

    @cached_property
    def _reach(self) -> tuple[Floats, Floats, Floats]:
        """Rays (n, 3) all over the image, their level components, and how far they are followed, in level metres."""
        x, y = np.meshgrid(*(np.linspace(0.0, side, 9) for side in (self.rays.width, self.rays.height)))
        directions = self.rays.directions(x.ravel(), y.ravel())
        level = np.maximum(np.hypot(directions[:, 0], directions[:, 1]), _LEAST)
        ground = WGS84.raised(self.lowest_m)
        lat, above_m = self.place[0], self.height_m - self.lowest_m
        seen = trace(np.array(lat), np.array(above_m), directions, ground)
        with np.errstate(invalid="ignore"):
            last = sight_lines(np.array(lat), np.array(above_m), seen.lat_deg, seen.dlon_deg, ground)
        # Mountains are visible beyond the horizon, up to 9 km high and 700 km away.
        reach_m = np.where(seen.hit, np.hypot(last[:, 0], last[:, 1]), np.inf)
        horizon_m = np.sqrt(2.0 * WGS84.a_m * above_m) + np.sqrt(2.0 * WGS84.a_m * 9_000.0)
        return directions, level, _MARGIN * np.minimum(reach_m, min(horizon_m, 700_000.0))

    def box(self, grid: PixelGrid) -> tuple[float, float, float, float]:
        """West, north, east and south end of the ground that the image may show, as fractions of the world.

        Without tracing. Longitudes are not wrapped; infinite where the grid ends.
        """
        (lat, lon), (directions, level, reach_m) = self.place, self._reach
        points = self._points(directions, np.zeros_like(level), _BULGE * reach_m / level)
        at_lat, dlon, _ = positions(np.array(lat), np.array(self.height_m), points)
        u, v = grid.plane.forward(at_lat, lon + dlon)
        if not (np.isfinite(u).all() and np.isfinite(v).all()):
            return -np.inf, -np.inf, np.inf, np.inf
        west, north, east, south = (float(end) for end in (u.min(), v.min(), u.max(), v.max()))
        # Samples of the outermost pixels reach beyond.
        aside, up = 0.05 * (east - west), 0.05 * (south - north)
        return west - aside, north - up, east + aside, south + up

    def _surfaces(self) -> Iterator[tuple[Surface, float]]:
        """Yield surfaces from near to far, and the level distance from the camera at which each begins.

        The first has the finest cells; if those would be too many, the next has cells twice as large, and so on.
        """
        (lat, lon), (directions, level, reach_m) = self.place, self._reach
        above_m = self.height_m - self.lowest_m
        begin_m, cell_m = 0.0, self.relief.cell_m(lat, lon)
        while begin_m < reach_m.max():
            end_m = float(reach_m.max())
            points = self._points(directions, begin_m / level, _BULGE * np.minimum(reach_m, end_m) / level)
            area_m2 = float(np.prod(np.ptp(points[:, :2], axis=0)))
            if begin_m == 0.0:
                # For a high camera even larger cells are less than a pixel.
                while area_m2 > MOST_CELLS * cell_m**2 and above_m > 2.0 * _LEAST_CELLS * cell_m:
                    cell_m *= 2.0
            if area_m2 > MOST_CELLS * cell_m**2:
                end_m = max(_LEAST_CELLS * cell_m, 2.0 * begin_m)
                points = self._points(directions, begin_m / level, _BULGE * np.minimum(reach_m, end_m) / level)
            at_lat, dlon, _ = positions(np.array(lat), np.array(self.height_m), points)
            yield self.relief.surface(at_lat, lon + dlon, cell_m), begin_m
            begin_m, cell_m = end_m, 2.0 * cell_m

    @staticmethod
    def _points(directions: Floats, first: Floats, last: Floats) -> Floats:
        """Points at two values of t along rays, relative to the camera."""
        return np.concatenate([t[:, np.newaxis] * directions for t in (np.minimum(first, last), last)])

    @cached_property
    def sky(self) -> Flags:
        """Whether rays of pixels miss both the Earth at its lowest height and the relief, (height, width)."""
        lat, _ = self.place
        x, y = np.meshgrid(np.arange(self.rays.width) + 0.5, np.arange(self.rays.height) + 0.5)
        rays = self.rays.directions(x.ravel(), y.ravel())
        disc, half = clearance(
            np.array(lat), np.array(self.height_m - self.lowest_m), rays, WGS84.raised(self.lowest_m)
        )
        missed = ((disc < 0.0) | (half >= 0.0)).reshape(x.shape)
        return np.asarray(missed & np.isnan(self.depth_m))

    @cached_property
    def depth_m(self) -> Floats:
        """Depths along the optical axis, (height, width); NaN without ground."""
        depths: Floats = np.fmax.reduce([one.hits.t for one in self._seen])
        return depths

    @cached_property
    def sighting(self) -> Sighting:
        """Ground at the pixels."""
        _, lon = self.place
        shape = self.depth_m.shape
        found = Sighting._make([*(np.full(shape, np.nan) for _ in range(6)), np.zeros(shape, bool)])
        for one in self._seen:
            at = np.isfinite(one.hits.t)
            column, row = one.hits.column[at], one.hits.row[at]
            point_lat, point_lon = one.surface.places(column, row)
            slopes = one.slopes(column, row)
            values = (
                one.hits.t[at],
                point_lat,
                lon + wrap_lon_deg(point_lon - lon),
                one.surface.heights(column, row),
                *slopes,
                np.hypot(*slopes) > STEEP,
            )
            for whole, part in zip(found, values):
                whole[at] = part
        return found

    def faces(self) -> Faces:
        """Pixels that see steep faces; `view` samples them at the edges of the faces."""
        found: list[Faces] = []
        for one in self._seen:
            row, column = np.nonzero(np.isfinite(one.hits.t))
            at_column, at_row = one.hits.column[row, column], one.hits.row[row, column]
            slope_east, slope_north = one.slopes(at_column, at_row)
            slope = np.hypot(slope_east, slope_north)
            at = slope > STEEP
            lat, lon = one.surface.places(*one.follow_faces(at_column[at], at_row[at], 1.0))
            east, north = -slope_east[at] / slope[at], -slope_north[at] / slope[at]
            found.append(Faces(row[at], column[at], lat, lon, east, north))
        return Faces(*(np.concatenate(parts) for parts in zip(*found)))

    def view(self, grid: PixelGrid, zooms: tuple[int, int]) -> View:
        """Map the image to a source's pixels; positions count from the camera's meridian."""
        found = [self._sampled(one, grid, zooms) for one in self._seen]
        samples = [part for parts, _ in found for part in parts]
        unmapped = ~self.sky
        for part in samples:
            unmapped[part.row, part.column] = False
        return View(
            self.rays.width,
            self.rays.height,
            grid,
            (),
            tuple(samples),
            self.sky if self.sky.any() else None,
            unmapped if unmapped.any() else None,
            self.tolerance_px,
            facade_share=sum(faces for _, faces in found) / (self.rays.width * self.rays.height),
        )

    def _sampled(self, one: _Seen, grid: PixelGrid, zooms: tuple[int, int]) -> tuple[list[Samples], int]:
        """Samples of the pixels that see a surface, and the number of them that see steep faces."""
        row, column = np.nonzero(np.isfinite(one.hits.t))
        if not len(row):
            return [], 0
        at_column, at_row, t = (values[row, column] for values in (one.hits.column, one.hits.row, one.hits.t))
        slope_east, slope_north = one.slopes(at_column, at_row)
        steep = np.hypot(slope_east, slope_north) > STEEP
        faces = int(np.count_nonzero(steep))
        ray_east, ray_north, ray_up = rays = self.rays.directions(column + 0.5, row + 0.5).T
        # Intersect the ground's tangent plane, n·p = const, with the rays of neighbouring pixels; rays that are nearly
        # parallel to it count as steeper.
        facing = np.minimum(ray_up - slope_east * ray_east - slope_north * ray_north, -0.02 * np.abs(ray_up) - _LEAST)
        steps: list[tuple[Floats, Floats]] = []
        for per in (self.rays.per_x, self.rays.per_y):
            ahead = (per[2] - slope_east * per[0] - slope_north * per[1]) / facing
            ahead[steep] = 0.0
            steps.append((t * (per[0] - ahead * rays[0]), t * (per[1] - ahead * rays[1])))
        if faces:
            at_column[steep], at_row[steep] = one.face_edges(at_column[steep], at_row[steep])
        if one.surface.has_holes:
            # Pixels whose samples reach beyond the end of the model have no picture.
            whole = one.has_ground_around(at_column, at_row, steps)
            steps = [(east[whole], north[whole]) for east, north in steps]
            row, column = row[whole], column[whole]
            at_column, at_row = at_column[whole], at_row[whole]
            if not len(row):
                return [], faces
        to_plane = _fit_plane(one.surface, grid, self.place[1], at_column, at_row)
        du, v = to_plane(at_column, at_row)
        turn = to_plane.slopes(at_column, at_row) @ one.per_metre
        spans = [
            (turn[0, 0] * east + turn[0, 1] * north, turn[1, 0] * east + turn[1, 1] * north) for east, north in steps
        ]
        per_x, per_y = (np.sqrt(across * across + down * down) for across, down in spans)
        found = []
        for zoom, samples_x, samples_y, at in detail_groups(pixel_detail(per_x, per_y, grid, zooms)):
            off_x, off_y = sample_offsets(samples_x, samples_y)
            sub_du, sub_v = (
                place[at, np.newaxis] + spans[0][axis][at, np.newaxis] * off_x + spans[1][axis][at, np.newaxis] * off_y
                for axis, place in enumerate((du, v))
            )
            found.append(Samples(zoom, row[at], column[at], sub_du, sub_v))
        return found, faces


class _Seen(NamedTuple):
    """Hits of an image on one surface.

    ``per_metre`` (2, 2) are columns and rows of the surface per metre eastward and northward.
    """

    surface: Surface
    hits: Hits
    per_metre: Floats

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


class _Polynomials:
    """World fractions of another plane, as polynomials in a surface's columns and rows."""

    def __init__(self, middle: Floats, half: Floats, factors: Floats) -> None:
        self._middle, self._half, self._factors = middle, half, factors

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
