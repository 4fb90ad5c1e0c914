"""Camera frames over relief: the ground at each pixel, and the source pixels that an image is made of."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import takewhile
from typing import NamedTuple, Protocol

import numpy as np

from ...arrays import Flags, Floats, NDArray, Numbers
from ...external.compiling import uses_numba
from ..accuracy import ImageGeometry
from ..camera import Poses
from ..ellipsoid import WGS84, clearance, positions, sight_lines, trace
from ..local import enu_axes, geocentric
from ..mercator import PixelGrid, wrap_lon_deg
from ..triangles import NO_FACES, RELIEF, FaceModel, Triangles
from ..view import ImageRays, View, joined
from .faces import FaceHits, face_hits
from .paths import Paths
from .pixel_rays import PixelRays
from .seen import STEEP, Seen
from .seen_faces import Painted, SeenFaces
from .surface import Surface

#: Most cells of a ring; those of images of many pixels end sooner, and have larger cells.
MOST_CELLS = 1 << 22
#: Most cells of a ring to the horizon, without further rings of larger cells.
_FEW_CELLS = 1 << 21
#: Most pixels across a cell of ground that faces the camera, where a ring is nearest; 1 in the first ring.
_MOST_PX = 1.5
#: Factor on sizes of cells at the camera, for those at other places of its rings.
_SLACK = 1.02
#: Factor on the reach of sampled rays: ground at the same distance between two of them lies beyond their chord.
_BULGE = 1.03
#: Factor on the length to which rays are followed.
_MARGIN = 1.01
#: Least number by which to divide.
_LEAST = 1e-12
#: Distance up to which all faces are asked for, in heights of the camera above the ground; twice as far each time
#: after that, without those that are smaller than this share of a pixel.
_FIRST_HEIGHTS, _LEAST_PX = 2.0, 0.5


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

    def end_m(self, lat_deg: float, lon_deg: float) -> float:
        """Level distance from a place beyond which there is no ground, metres; infinite if unknown."""


class Sighting(NamedTuple):
    """Ground at the pixels of an image, (height, width) each; NaN without ground.

    Attributes
    ----------
    depth_m : array
        Depth along the optical axis.
    lat_deg, lon_deg, height_m : array
        Ground points; longitudes are continuous with the camera's, heights are above the ellipsoid.
    normals : array (height, width, 3)
        Unit normals of the surface, in east, north and up; those of buildings face the camera.
    steep : array of bool
        Faces whose colours no map shows: steep relief, and what of buildings the imagery does not show.
    kind : array of uint8
        `RELIEF`, also without ground, or the kind of a building's face: see `triangles`.
    instance : array of int64
        Number of the building; 0 for relief.
    """

    depth_m: Floats
    lat_deg: Floats
    lon_deg: Floats
    height_m: Floats
    normals: Floats
    steep: Flags
    kind: NDArray[np.uint8]
    instance: Numbers

    @classmethod
    def blank(cls, shape: tuple[int, ...]) -> Sighting:
        """Pixels without ground."""
        depth, lat, lon, height = (np.full(shape, np.nan) for _ in range(4))
        # The sign is that of slopes turned round, so that files keep their bytes.
        normals, steep = np.full((*shape, 3), -np.nan), np.zeros(shape, bool)
        kind, instance = np.full(shape, RELIEF, np.uint8), np.zeros(shape, np.int64)
        return cls(depth, lat, lon, height, normals, steep, kind, instance)


def relief_normals(slope_east: Floats, slope_north: Floats) -> Floats:
    """Unit normals (..., 3), in east, north and up, of surfaces with slopes in metres per metre."""
    up = np.stack([-slope_east, -slope_north, np.ones_like(slope_east)], axis=-1)
    normals: Floats = up / np.linalg.norm(up, axis=-1, keepdims=True)
    return normals


class Ring(NamedTuple):
    """Ground between two level distances from a camera: there, it is this surface."""

    surface: Surface
    begin_m: float
    end_m: float


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
    faces : FaceModel
        Buildings, which hide the relief behind them.
    rows : tuple of int, or None
        First row of pixels and the one after the last, to trace a part of the image; None for all.
    """

    scene: ImageGeometry
    height_m: float
    relief: ElevationModel
    lowest_m: float
    tolerance_px: float
    faces: FaceModel = NO_FACES
    rows: tuple[int, int] | None = None

    @property
    def place(self) -> tuple[float, float]:
        """Latitude and longitude of the camera."""
        poses = self.scene.poses
        return float(poses.lat_deg[0]), float(poses.lon_deg[0])

    @cached_property
    def rays(self) -> PixelRays:
        """Rays of the image, or of its rows."""
        whole = PixelRays.of_image(ImageRays.from_scene(self.scene))
        return whole if self.rows is None else whole.rows(*self.rows)

    @cached_property
    def level_m(self) -> float | None:
        """Height of level ground that equals the relief within half the tolerance at every pixel; None if none does."""
        if self._face_hits is not None:
            return None
        pixel = self.rays.pixel / float((self._reach[0] ** 2).sum(axis=1).max())
        low, high = np.inf, -np.inf
        for surface, *_ in self.rings():
            if surface.has_holes:
                return None
            low, high = min(low, surface.lowest_m), max(high, surface.highest_m)
            if high - low > self.tolerance_px * pixel * (self.height_m - high):
                return None
        return (low + high) / 2.0

    @cached_property
    def _face_hits(self) -> FaceHits | None:
        """Hits of the rays on faces, whether or not relief hides them; None if there are none."""
        if self.faces is NO_FACES:
            return None
        place = *self.place, self.height_m
        found = face_hits(
            Triangles.joined(list(self._near_faces())), geocentric(*place), enu_axes(*place[:2]), self.rays
        )
        return found if (found.triangle >= 0).any() else None

    def _near_faces(self) -> Iterator[Triangles]:
        """Faces that may be seen, from near to far; those smaller than half a pixel are left out."""
        (lat, lon), last_m = self.place, float(self._reach[2].max())
        begin_m, end_m = 0.0, _FIRST_HEIGHTS * max(self.height_m - self.lowest_m, 100.0)
        while begin_m < last_m:
            end_m = end_m if end_m < last_m else np.inf
            at_lat, dlon, _ = positions(np.array(lat), np.array(self.height_m), self._points(begin_m, end_m))
            away_m = begin_m or self._least_above_m(end_m)
            found = self.faces.triangles(at_lat, lon + dlon, _LEAST_PX * self.rays.pixel * away_m)
            if begin_m > 0.0:
                # What lies nearer has been asked for before.
                offsets = found.corners_m - geocentric(lat, lon, self.height_m)
                found = found.take((np.einsum("nij,nij->ni", offsets, offsets) > begin_m * begin_m).any(axis=1))
            yield found
            begin_m, end_m = end_m, 2.0 * end_m

    def _least_above_m(self, end_m: float) -> float:
        """Height of the camera above the highest ground up to a level distance; 0 if below it."""
        near = takewhile(lambda ring: ring.begin_m < end_m, self.rings())
        tops = [ring.surface.highest_m for ring in near if ring.surface.has_ground]
        return max(self.height_m - max(tops, default=self.lowest_m), 0.0)

    @cached_property
    def _seen_faces(self) -> SeenFaces | None:
        """Pixels that see faces; None if none does."""
        if self._face_hits is None:
            return None
        row, column = np.nonzero((self._face_hits.triangle >= 0) & np.isnan(self._relief_depth_m))
        return SeenFaces(row, column, self._face_hits, self.rays, (*self.place, self.height_m)) if len(row) else None

    @cached_property
    def _seen(self) -> list[Seen]:
        """Hits on surfaces from near to far; on each, of the pixels that hit no nearer surface, or face."""
        lat, lon = self.place
        found: list[Seen] = []
        unmet = np.ones((self.rays.height, self.rays.width), bool)
        before = nearer = None
        for ring in self.rings():
            before, nearer = nearer, ring.surface
            surface, begin_m, end_m = ring
            if not surface.has_ground or begin_m > _MARGIN * surface.away_m(lat, lon, self.height_m):
                # The surface ends before the distance from which it counts.
                continue
            top, bottom, after, until = self._spans(ring, unmet)
            if top == bottom:
                continue
            rays = self.rays.rows(top, bottom)
            paths, farthest, _ = surface.paths(lat, lon, self.height_m, rays, self.tolerance_px / 2.0, end_m)
            spans = after, np.minimum(until, farthest)
            hits = surface.image_hits(paths, rays, spans, self.tolerance_px / 2.0, begins=begin_m > 0.0)
            seen = Seen(surface, hits, paths.forms[0][:2, :2], rays, top)
            if begin_m > 0.0 and before is not None:
                seen = self._begun_above(before, seen, paths, after)
            unmet[top:bottom] &= np.isnan(hits.t)
            if self._face_hits is not None:
                unmet &= self._face_hits.t > end_m / self._ways[0]
            found.append(seen)
            if not unmet.any():
                break
        return found

    def _spans(self, ring: Ring, unmet: Flags) -> tuple[int, int, Floats, Floats]:
        """First row of the pixels that may see a ring, and the row after the last; t from and up to which they may.

        t from which they may, (rows, width), is infinite for those that see nearer ground, or that are too high.
        """
        surface, begin_m, end_m = ring
        some = np.flatnonzero(unmet.any(axis=1))
        top, bottom = (int(some[0]), int(some[-1]) + 1) if len(some) else (0, 0)
        level, up = (values[top:bottom] for values in self._ways)
        after, until = begin_m / level, end_m / level
        if self._face_hits is not None:
            until = np.minimum(until, self._face_hits.t[top:bottom])
            after[after > until] = np.inf
        # The Earth falls away by the squared distance over twice its radius, or at least 98 % of that; 1 m is for
        # higher terms.
        least_m = self.height_m + np.where(up < 0.0, until, after) * up + 0.98 * begin_m**2 / (2.0 * WGS84.a_m)
        after[~unmet[top:bottom] | (least_m > surface.highest_m + 1.0)] = np.inf
        some = np.flatnonzero(np.isfinite(after).any(axis=1))
        first, last = (int(some[0]), int(some[-1]) + 1) if len(some) else (0, 0)
        return top + first, top + last, after[first:last], until[first:last]

    @cached_property
    def _ways(self) -> tuple[Floats, Floats]:
        """Level and upward components of the pixels' rays, (height, width) each."""
        east, north, up = self.rays.components()
        return np.maximum(np.hypot(east, north), _LEAST), up

    def _begun_above(self, before: Surface, seen: Seen, paths: Paths, after: Floats) -> Seen:
        """Drop hits where a ring begins of rays that are also below the ground of the ring before; tell the others."""
        hits = seen.hits
        row, column = np.nonzero(hits.t == after)
        if not len(row):
            return seen
        t = hits.t[row, column]
        at_column, at_row, height = paths.evaluate(seen.rays.through(row, column), t)
        ground = before.heights(*before.position(*seen.surface.places(at_column, at_row)))
        allowed = self.tolerance_px * self.rays.pixel * t
        above = height >= ground - allowed
        for values in hits:
            values[row[~above], column[~above]] = np.nan
        return seen._replace(begun=(row[above], column[above], height[above]))

    @cached_property
    def _reach(self) -> tuple[Floats, Floats, Floats]:
        """Rays (n, 3) all over the image, their level components, and how far they are followed, in level metres."""
        directions = self.rays.outlook()
        level = np.maximum(np.hypot(directions[:, 0], directions[:, 1]), _LEAST)
        ground = WGS84.raised(self.lowest_m)
        lat, above_m = self.place[0], self.height_m - self.lowest_m
        seen = trace(np.array(lat), np.array(above_m), directions, ground)
        with np.errstate(invalid="ignore"):
            last = sight_lines(np.array(lat), np.array(above_m), seen.lat_deg, seen.dlon_deg, ground)
        # Mountains are visible beyond the horizon, up to 9 km high and 700 km away.
        reach_m = np.where(seen.hit, np.hypot(last[:, 0], last[:, 1]), np.inf)
        horizon_m = np.sqrt(2.0 * WGS84.a_m * above_m) + np.sqrt(2.0 * WGS84.a_m * 9_000.0)
        most_m = min(horizon_m, 700_000.0, self.relief.end_m(*self.place))
        return directions, level, _MARGIN * np.minimum(reach_m, most_m)

    def box(self, grid: PixelGrid) -> tuple[float, float, float, float]:
        """West, north, east and south end of the ground that the image may show, as fractions of the world.

        Without tracing. Longitudes are not wrapped; infinite where the grid ends.
        """
        lat, lon = self.place
        points = self._points(0.0, np.inf)
        at_lat, dlon, _ = positions(np.array(lat), np.array(self.height_m), points)
        u, v = grid.plane.forward(at_lat, lon + dlon)
        if not (np.isfinite(u).all() and np.isfinite(v).all()):
            return -np.inf, -np.inf, np.inf, np.inf
        west, north, east, south = (float(end) for end in (u.min(), v.min(), u.max(), v.max()))
        # Samples of the outermost pixels reach beyond.
        aside, up = 0.05 * (east - west), 0.05 * (south - north)
        return west - aside, north - up, east + aside, south + up

    def rings(self) -> Iterator[Ring]:
        """Yield the ground from near to far.

        A ring has the source's largest cells, of 1, 2, 4 … pixels, that are no larger than what a pixel of the image
        covers of ground that faces it, at the ring's highest ground and least distance.
        """
        yield from self._rings
        last_m = float(self._reach[2].max())
        while (begin_m := self._rings[-1].end_m if self._rings else 0.0) < last_m:
            self._rings.append(self._ring(begin_m, last_m))
            yield self._rings[-1]

    @cached_property
    def _rings(self) -> list[Ring]:
        """Rings that were read."""
        return []

    def _ring(self, begin_m: float, last_m: float) -> Ring:
        """Ring that begins at a distance."""
        finest_m = least_m = _SLACK * self.relief.cell_m(*self.place)
        while self._area_m2(begin_m, 2.0 * begin_m) > MOST_CELLS * least_m**2:
            least_m *= 2.0
        pixel = self.rays.pixel
        most_px = _MOST_PX if begin_m > 0.0 else 1.0
        # From as far above the ground as it may be, until its heights are known.
        above_m, cell_m = self.height_m - self.lowest_m, np.inf
        while True:
            most_m = most_px * pixel * math.hypot(begin_m, max(above_m, 0.0))
            doublings = math.floor(math.log2(max(most_m / finest_m, 1.0)))
            cell_m = max(min(finest_m * 2.0**doublings, cell_m / 2.0), least_m)
            end_m = self._end_m(begin_m, last_m, cell_m, pixel)
            points = self._points(begin_m, end_m)
            lat, dlon, _ = positions(np.array(self.place[0]), np.array(self.height_m), points)
            surface = self.relief.surface(lat, self.place[1] + dlon, cell_m if cell_m > finest_m else 0.0)
            if surface.has_ground:
                above_m = self.height_m - surface.highest_m
            if cell_m <= max(most_px * pixel * math.hypot(begin_m, max(above_m, 0.0)), least_m):
                return Ring(surface, begin_m, end_m if end_m < last_m else np.inf)

    def _end_m(self, begin_m: float, last_m: float, cell_m: float, pixel: float) -> float:
        """Distance at which a ring ends: where cells may be twice as large, or where it would have too many."""
        if self._area_m2(begin_m, last_m) <= _FEW_CELLS * cell_m**2:
            return last_m
        # A thousandth more than needed, for rounding.
        end_m = max(2.002 * cell_m / (_MOST_PX * pixel), 2.0 * begin_m)
        while self._area_m2(begin_m, end_m) > MOST_CELLS * cell_m**2:
            end_m = max(end_m / 2.0, 2.0 * begin_m)
        return end_m

    def _area_m2(self, begin_m: float, end_m: float) -> float:
        """Area of the box around the ground between two distances that the image may show."""
        return float(np.prod(np.ptp(self._points(begin_m, end_m)[:, :2], axis=0)))

    def _points(self, begin_m: float, end_m: float) -> Floats:
        """Points along rays at two level distances, relative to the camera."""
        directions, level, reach_m = self._reach
        last = _BULGE * np.minimum(reach_m, end_m) / level
        return np.concatenate([t[:, np.newaxis] * directions for t in (np.minimum(begin_m / level, last), last)])

    @cached_property
    def sky(self) -> Flags:
        """Whether rays of pixels miss both the Earth at its lowest height and the relief, (height, width)."""
        sky = np.isnan(self.depth_m)
        if sky.any():
            row, column = np.nonzero(sky)
            disc, half = clearance(
                np.array(self.place[0]),
                np.array(self.height_m - self.lowest_m),
                self.rays.through(row, column),
                WGS84.raised(self.lowest_m),
            )
            sky[row, column] = (disc < 0.0) | (half >= 0.0)
        return sky

    @cached_property
    def depth_m(self) -> Floats:
        """Depths along the optical axis, (height, width); NaN without ground."""
        if (faces := self._seen_faces) is None:
            return self._relief_depth_m
        depths = self._relief_depth_m.copy()
        depths[faces.row, faces.column] = faces.t
        return depths

    @cached_property
    def _relief_depth_m(self) -> Floats:
        """Depths of relief that no face hides, (height, width); NaN without."""
        depths: Floats = np.full((self.rays.height, self.rays.width), np.nan)
        for one in self._seen:
            rows = depths[one.top : one.top + one.rays.height]
            np.fmax(rows, one.hits.t, out=rows)
        return depths

    @cached_property
    def sighting(self) -> Sighting:
        """Ground at the pixels."""
        _, lon = self.place
        found = Sighting.blank(self.depth_m.shape)
        for one in self._seen:
            at = np.isfinite(one.hits.t)
            column, row = one.hits.column[at], one.hits.row[at]
            point_lat, point_lon = one.surface.places(column, row)
            slopes = one.slopes(column, row)
            rows = slice(one.top, one.top + one.rays.height)
            found.depth_m[rows][at] = one.hits.t[at]
            found.lat_deg[rows][at] = point_lat
            found.lon_deg[rows][at] = lon + wrap_lon_deg(point_lon - lon)
            found.height_m[rows][at] = one.surface.heights(column, row)
            if one.begun is not None:
                found.height_m[rows][one.begun[:2]] = one.begun[2]
            found.normals[rows][at] = relief_normals(*slopes)
            found.steep[rows][at] = np.hypot(*slopes) > STEEP
        if (faces := self._seen_faces) is not None:
            pixels, triangle, hit = (faces.row, faces.column), faces.triangle, faces.hits.triangles
            found.lat_deg[pixels], found.lon_deg[pixels], found.height_m[pixels] = faces.points()
            axes = enu_axes(found.lat_deg[pixels], found.lon_deg[pixels])
            found.normals[pixels] = np.einsum("nij,nj->ni", axes, faces.normals(triangle))
            found.depth_m[pixels], found.steep[pixels] = faces.t, ~faces.is_shown
            found.kind[pixels], found.instance[pixels] = hit.kind[triangle], hit.instance[triangle]
        return found

    def painted(self) -> Painted | None:
        """Pixels that see faces which the imagery does not show; None if none does."""
        return None if self._seen_faces is None else self._seen_faces.painted()

    def view(self, grid: PixelGrid, zooms: tuple[int, int], *, by_area: bool = False) -> View:
        """Map the image to a source's pixels; positions count from the camera's meridian."""
        found = [one.samples(self.place[1], grid, zooms, by_area=by_area) for one in self._seen]
        parts, unmapped, facades = [part for parts, _ in found for part in parts], ~self.sky, sum(n for _, n in found)
        if (faces := self._seen_faces) is not None:
            parts += faces.samples(grid, zooms, by_area=by_area)
            some = ~faces.is_shown
            unmapped[faces.row[some], faces.column[some]] = False
            facades += int(np.count_nonzero(some))
        samples = joined(parts)
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
            facade_share=facades / (self.rays.width * self.rays.height),
        )


def compile_code() -> None:
    """Compile what follows rays and samples pixels, where numba is used.

    Takes some seconds once on a computer, and half a second in each process.
    """
    if not uses_numba():
        return
    grid, zoom = PixelGrid(), 18
    surface = Surface(grid, zoom, 0, grid.world_px(zoom) // 2, np.zeros((4, 4), np.float32))
    (lat,), (lon,) = surface.places(np.array([1.5]), np.array([1.5]))
    down = PixelRays(np.array([-0.05, 0.05, -1.0]), np.array([0.01, 0.0, 0.0]), np.array([0.0, -0.01, 0.0]), 10, 10)
    paths, farthest, _ = surface.paths(lat, lon, 10.0, down, 0.1)
    hits = surface.image_hits(paths, down, (np.zeros((10, 10)), np.full((10, 10), farthest)), 0.1)
    seen = Seen(surface, hits, paths.forms[0][:2, :2], down)
    surface.first_hits(paths.start, paths.coefficients(down.directions(np.array([5.0]), np.array([5.0]))), np.ones(1))
    samples, _ = seen.samples(lon, grid, (0, zoom))
    View(10, 10, grid, (), tuple(samples), None, None, 0.0).tiles(lon)
