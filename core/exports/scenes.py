"""Ground of a benchmark in metres: points seen by pixels of queries, and the reference with heights."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arrays import Bytes, Flags, Floats
from ..benchmark.folder import Benchmark
from ..errors import InvalidInput
from ..geodesy.accuracy import ImageGeometry
from ..geodesy.contract import CameraContract
from ..geodesy.ellipsoid import WGS84
from ..geodesy.local import LocalFrame
from ..geodesy.raytracing.surface import Surface
from ..geodesy.raytracing.tracing import ElevationModel, Tracing
from ..geodesy.view import ImageRays
from ..mission.mission import Mission
from ..mission.relief.ground import Heights
from ..mission.relief.roofed import seen_surface
from ..picture.heights import mission_heights
from ..picture.resampling import sample
from .views import camera_rotations


class QueryCamera(NamedTuple):
    """Camera of a query in a local frame.

    Attributes
    ----------
    k : array (3, 3)
        Intrinsics; the centre of the first pixel is (0, 0).
    rotation : array (3, 3)
        Rotation from the frame to the camera's right, down and view (OpenCV's axes).
    centre_m : array (3,)
    """

    k: Floats
    rotation: Floats
    centre_m: Floats


class Ortho(NamedTuple):
    """Orthographic view of a part of the reference.

    Attributes
    ----------
    image : array (h, w, 3) of uint8
        Black outside the reference.
    points_m : array (h, w, 3)
        Ground at pixel centres in a local frame; heights are NaN where ground or imagery is unknown.
    """

    image: Bytes
    points_m: Floats


class OrthoGrid(NamedTuple):
    """Square pixels in a local frame: centre of the first pixel, size, and counts; rows run south."""

    west_m: float
    north_m: float
    pixel_m: float
    width_px: int
    height_px: int


@dataclass(frozen=True, eq=False)
class SceneGround:
    """Ground of a benchmark.

    Parameters
    ----------
    benchmark : Benchmark
    heights : Heights or None
        Surface and buildings that cameras see; None for level ground.
    """

    benchmark: Benchmark
    heights: Heights | None

    @property
    def relief(self) -> ElevationModel | None:
        """Surface with buildings that shows from above; None for level ground."""
        return None if self.heights is None else seen_surface(self.heights)

    @classmethod
    def from_benchmark(cls, benchmark: Benchmark) -> SceneGround:
        """Ground of a benchmark; opens the benchmark's elevation, if it has one.

        Raises
        ------
        InvalidInput, SourceError
            The elevation cannot be opened.
        """
        asked = benchmark.about.get("queries")
        if not isinstance(asked, dict):
            raise InvalidInput("benchmark {0}: does not say how its queries were taken", benchmark.folder)
        return cls(benchmark, mission_heights(Mission.from_dict(asked)))

    @cached_property
    def mosaic(self) -> Bytes:
        """The reference as one image, (h, w, 3)."""
        return self.benchmark.colours(self.benchmark.mosaic.file)

    @cached_property
    def _outline(self) -> tuple[Floats, Floats]:
        """Latitudes and longitudes of points along the mosaic's edges."""
        return self.benchmark.mosaic.rim()

    @cached_property
    def lowest_m(self) -> float:
        """Height of level ground, or a lower bound of the relief's heights."""
        if self.relief is None:
            return float(self.benchmark.queries.ground_m.min())
        # The surface's cells may be coarser than the relief's and hide ground up to 100 m lower.
        return float(np.nanmin(self.relief.surface(*self._outline).heights_m)) - 100.0

    def camera(self, index: int, frame: LocalFrame) -> QueryCamera:
        """Camera of a query."""
        one = self.benchmark.queries.take(np.array([index]))
        numbers = (one.width_px, one.height_px, one.fx_px, one.fy_px, one.cx_px, one.cy_px)
        k = CameraContract(*(values[0] for values in numbers)).k
        rotation = camera_rotations(frame, one.lat_deg, one.lon_deg, *one.poses.attitude)[0]
        return QueryCamera(k, rotation, frame.enu(one.lat_deg, one.lon_deg, one.height_m)[0])

    def points(self, index: int, frame: LocalFrame) -> Floats:
        """Ground points that the pixel centres of a query see, (h, w, 3) in metres; NaN where they miss the ground."""
        queries = self.benchmark.queries
        width, height = int(queries.width_px[index]), int(queries.height_px[index])
        pose, up_m = queries.poses.take(slice(index, index + 1)), float(queries.height_m[index])
        pose = pose._replace(agl_m=np.array([up_m - self.lowest_m]))
        scene = ImageGeometry(queries.camera(index), width, height, pose, WGS84.raised(self.lowest_m))
        if self.heights is None:
            seen = ImageRays.from_scene(scene).ground(*np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5))
            lat, lon = seen.lat_deg, pose.lon_deg[0] + seen.dlon_deg
            return _finite(frame.enu(lat, lon, np.full(lat.shape, self.lowest_m)))
        # Trace to a hundredth of a pixel.
        found = Tracing(scene, up_m, self.heights.surface, self.lowest_m, 0.01, self.heights.faces).sighting
        return _finite(frame.enu(found.lat_deg, found.lon_deg, found.height_m))

    def ortho(self, frame: LocalFrame, grid: OrthoGrid) -> Ortho:
        """Orthographic view of the reference on a grid, with the surface's colours and heights."""
        image = np.zeros((grid.height_px, grid.width_px, 3), np.uint8)
        points = np.empty((grid.height_px, grid.width_px, 3))
        x = grid.west_m + np.arange(grid.width_px) * grid.pixel_m
        # Process 256 rows at a time to bound memory.
        for start in range(0, grid.height_px, 256):
            rows = np.arange(start, min(start + 256, grid.height_px))
            part = np.stack(np.meshgrid(x, grid.north_m - rows * grid.pixel_m), axis=-1)
            z, lat, lon = self._surface(frame, part)
            image[rows], inside = self.sample(lat, lon)
            points[rows] = np.dstack([part, np.where(inside, z, np.nan)])
        return Ortho(image, points)

    def sample(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Bytes, Flags]:
        """Colours (..., 3) of the reference at positions (...), black outside, and whether positions are inside."""
        column, row = self.benchmark.mosaic.px(lat_deg, lon_deg)
        high, wide = self.mosaic.shape[:2]
        inside = (column >= 0.0) & (column <= wide) & (row >= 0.0) & (row <= high)
        colours = np.zeros((*inside.shape, 3), np.uint8)
        found = sample(self.mosaic, column[inside], row[inside], "bilinear")
        colours[inside] = np.clip(np.rint(found), 0, 255).astype(np.uint8)
        return colours, inside

    def crop(self, left_px: int, top_px: int, side_px: int) -> Bytes:
        """Square crop (side, side, 3) of the reference; black outside the reference."""
        piece = np.zeros((side_px, side_px, 3), np.uint8)
        left, top = max(left_px, 0), max(top_px, 0)
        seen = self.mosaic[top : max(top_px + side_px, 0), left : max(left_px + side_px, 0)]
        rows, columns = seen.shape[:2]
        piece[top - top_px :, left - left_px :][:rows, :columns] = seen
        return piece

    def _surface(self, frame: LocalFrame, xy_m: Floats) -> tuple[Floats, Floats, Floats]:
        """Heights (h, w) in a frame of the surface at points (h, w, 2), NaN where unknown; latitudes and longitudes."""
        up = np.zeros(xy_m.shape[:2])
        surface: Surface | None = None
        # Fixed-point iteration: the vertical differs from the frame's vertical by a milliradian per 6 km, so each step
        # reduces the error about a thousandfold.
        for _ in range(4):
            lat, lon, height = frame.geodetic(np.dstack([xy_m, up]))
            if self.relief is None:
                wanted = np.full(lat.shape, self.lowest_m)
            else:
                surface = surface or self.relief.surface(_rim(lat), _rim(lon))
                column, row = surface.position(lat.ravel(), lon.ravel())
                wanted = surface.heights(column, row).reshape(lat.shape)
            is_known = np.isfinite(wanted)
            up = np.where(is_known, up + wanted - height, up)
        lat, lon, _ = frame.geodetic(np.dstack([xy_m, up]))
        return np.where(is_known, up, np.nan), lat, lon

    def pixel_m(self, frame: LocalFrame) -> float:
        """Pixel size of the mosaic at the origin of a frame."""
        mosaic = self.benchmark.mosaic
        column, row = (float(at) for at in mosaic.px(np.array(frame.lat_deg), np.array(frame.lon_deg)))
        lat, lon = mosaic.ground(np.array([column, column + 1.0, column]), np.array([row, row, row + 1.0]))
        place = frame.enu(lat, lon, np.full(3, frame.height_m))
        across, down = (float(np.linalg.norm(place[at] - place[0])) for at in (1, 2))
        return max(across, down)

    def bounds_m(self, frame: LocalFrame) -> tuple[float, float, float, float]:
        """Edges of the mosaic in a frame: west, south, east and north."""
        lat, lon = self._outline
        rim = frame.enu(lat, lon, np.full(lat.shape, frame.height_m))
        west, south = (float(value) for value in rim[:, :2].min(axis=0))
        east, north = (float(value) for value in rim[:, :2].max(axis=0))
        return west, south, east, north


def local_frame(lat_deg: float, lon_deg: float, ground_m: float) -> LocalFrame:
    """Local frame at a position rounded to 10 cm, and to 1 mm in height, so that files state it exactly."""
    return LocalFrame(round(lat_deg, 6), round(lon_deg, 6), round(ground_m, 3))


def _rim(values: Floats) -> Floats:
    """Values along the edges of an array (h, w)."""
    return np.concatenate([values[0], values[-1], values[:, 0], values[:, -1]])


def _finite(points_m: Floats) -> Floats:
    """Points; if any coordinate of a point is not finite, all its coordinates are NaN."""
    return np.where(np.isfinite(points_m).all(axis=-1, keepdims=True), points_m, np.nan)
