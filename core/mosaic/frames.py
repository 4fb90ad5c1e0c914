"""Images and the ground that they show: camera frames by pose, map frames by georeference."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import NamedTuple, Union

import numpy as np

from ..arrays import Flags, Floats, Numbers
from ..dataset.dataset import ImageSet, read_dataset
from ..dataset.folder import MISSION_FILE
from ..dataset.geotiff import parse_affine
from ..dataset.ground import are_camera_frames, check_poses, image_plane
from ..dataset.labels import middle_position
from ..dataset.table import Table, usable_rows
from ..errors import InvalidInput
from ..external.compiling import without_numba
from ..geodesy.camera import CORNERS, Camera, Poses, image_axes
from ..geodesy.ellipsoid import WGS84, Ellipsoid, trace
from ..geodesy.local import enu_axes, geocentric
from ..geodesy.mercator import MAX_LAT_DEG, Plane, WebMercator, wrap_lon_deg
from ..geodesy.planes import ProjectedPlane
from ..geodesy.raytracing.surface import Surface
from ..geodesy.raytracing.tracing import ElevationModel
from ..limits import MAX_SETTINGS_BYTES
from ..mission.estimate import ORTHOMOSAIC_DEG
from ..mission.lenses import CaptureCameras
from ..mission.mission import Mission
from ..mission.plan import Plan
from ..mission.relief.ground import Heights
from ..mission.relief.roofed import seen_surface
from ..numbers import real_number
from ..picture.heights import mission_heights
from ..storage.files import open_foreign, read_limited
from ..text.safe_json import decoded
from .raster import BlockGround, PixelBlock, places, positions

OpenHeights = Callable[[Mission], "Heights | None"]

_WORLD_FILES = {".jpg": ".jgw", ".png": ".pgw"}


class Sight(NamedTuple):
    """Position of a block's ground in an image, (h, w) each.

    Attributes
    ----------
    x, y : array
        Shares of the image's width and height from its upper left corner; meaningless where not ``inside``.
    inside : array of bool
        Whether the ground is in the image; relief may still hide it.
    steepness : array
        Larger, the more vertically the camera sees the ground.
    """

    x: Floats
    y: Floats
    inside: Flags
    steepness: Floats


class ImageBoxes(NamedTuple):
    """Bounding boxes (n,) of the ground in images, in the unit of a CRS; NaN for none."""

    west: Floats
    south: Floats
    east: Floats
    north: Floats


class Extent(NamedTuple):
    """Rectangle in the unit of a CRS."""

    west: float
    south: float
    east: float
    north: float


@dataclass(frozen=True, eq=False)
class CameraImages:
    """Camera frames, n of them.

    Parameters
    ----------
    cameras : CaptureCameras
        Cameras of the images.
    poses : Poses
        Poses with heights above ``ground`` and continuous longitudes.
    ground : Ellipsoid
        Level ground, WGS 84 where there is relief.
    relief : ElevationModel or None
    paths : tuple of Path
    sizes_px : array (n, 2)
        Widths and heights of the image files.
    plane : Plane
        CRS of the mosaic.
    flattest_deg : float
        Ground seen at a larger angle from the vertical is left out.
    """

    cameras: CaptureCameras
    poses: Poses
    ground: Ellipsoid
    relief: ElevationModel | None
    paths: tuple[Path, ...]
    sizes_px: Numbers
    plane: Plane
    flattest_deg: float = ORTHOMOSAIC_DEG

    def __len__(self) -> int:
        return len(self.paths)

    @classmethod
    def from_plan(cls, plan: Plan, index: int, path: Path) -> CameraImages:
        """Image of one of a plan's captures."""
        poses = plan.poses.take(slice(index, index + 1))
        if not plan.relief.is_level:
            poses = poses._replace(agl_m=plan.height_m[index : index + 1])
        size = plan.mission.output.img_size or (
            int(plan.frames.width_px[index]),
            int(plan.frames.height_px[index]),
        )
        return cls(
            CaptureCameras((plan.camera(index),)),
            poses,
            plan.ground if plan.relief.is_level else WGS84,
            None if plan.relief.is_level else seen_surface(plan.relief.heights),
            (path,),
            np.array([size[:2]]),
            plan.grid.plane,
        )

    @cached_property
    def centres(self) -> Floats:
        """Geocentric positions (n, 3) of the cameras."""
        return geocentric(self.poses.lat_deg, self.poses.lon_deg, self.poses.agl_m, self.ground)

    @cached_property
    def axes(self) -> Floats:
        """Right, up and viewing direction of the images as rows (n, 3, 3), in geocentric axes."""
        local = np.stack(image_axes(*self.poses.attitude), axis=-2)
        turned: Floats = local @ enu_axes(self.poses.lat_deg, self.poses.lon_deg)
        return turned

    @cached_property
    def nadirs(self) -> tuple[Floats, Floats]:
        """Nadirs (n,) of the cameras in the CRS."""
        return positions(self.plane, self.poses.lat_deg, self.poses.lon_deg)

    @property
    def gsd_m(self) -> float:
        """Median ground sample distance of the images at the centre, if they looked straight down."""
        below = self.poses.agl_m
        if self.relief is not None:
            below = below - self._heights_below
        first = self.cameras.of(0)
        wider = self.cameras.each(lambda camera: (max(camera.half_tangents) / max(first.half_tangents),))[0]
        return first.gsd_m_per_px(float(np.nanmedian(wider * (below / self.sizes_px.max(axis=1)))), 1.0)

    @property
    def coarsest_gsd_m(self) -> float:
        """Ground that a pixel spans across the direction of view where images look flattest, up to ``flattest_deg``."""
        (rays,) = self.cameras.together(
            lambda camera, which: (camera.rays_enu(CORNERS, *self.poses.take(which).attitude),)
        )
        upright = float((-rays[..., 2] / np.linalg.norm(rays, axis=-1)).min())
        return self.gsd_m / max(upright, math.cos(math.radians(self.flattest_deg)))

    @cached_property
    def _heights_below(self) -> Floats:
        """Heights (n,) of the relief below the cameras; NaN where it has none."""
        surface = self._surface(self.poses.lat_deg, self.poses.lon_deg)
        return surface.heights(*surface.position(self.poses.lat_deg, self.poses.lon_deg))

    @cached_property
    def _base_m(self) -> float:
        """Greatest height above ``ground`` of the relief below the cameras."""
        return 0.0 if self.relief is None else max(float(np.nanmax(self._heights_below)), 0.0)

    @cached_property
    def _levels_m(self) -> tuple[float, ...]:
        """Heights above ``ground`` that enclose all ground in the images."""
        if self.relief is None:
            return (0.0,)
        lat, lon = self.poses.lat_deg, self.poses.lon_deg
        below = float(np.nanmin(self._heights_below))
        reach = float(np.max(self.poses.agl_m - below)) * math.tan(math.radians(min(self.flattest_deg, 75.0)))
        wide = np.degrees(reach / self.ground.b_m)
        wider = wide / np.maximum(np.cos(np.radians(lat)), 1e-3)
        surface = self._surface(
            np.clip(np.concatenate([lat - wide, lat + wide]), -90.0, 90.0),
            np.concatenate([lon - wider, lon + wider]),
        )
        lowest, highest = surface.lowest_m, surface.highest_m
        # Coarse cells lack peaks and hollows.
        spare = 0.1 * (highest - lowest)
        return (lowest - spare, min(highest + spare, float(self.poses.agl_m.min()) - 1.0))

    def boxes(self, rays: int = 9, margin: float = 1.0 / 32.0) -> ImageBoxes:
        """Bounding boxes of the ground in images.

        Parameters
        ----------
        rays : int
            Rays traced along each axis of an image.
        margin : float
            Share of a box's size by which the box is enlarged: more than the ground curves between rays.
        """
        edges = np.full((4, len(self)), np.nan)
        # 2048 images at a time take some 30 MB.
        for start in range(0, len(self), 2048):
            part = slice(start, start + 2048)
            poses = self.poses.take(part)
            for camera, which in self.cameras[part].groups():
                edges[:, part][:, which] = self._boxes(camera, poses.take(which), rays, margin)
        return ImageBoxes(*edges)

    def extent(self, boxes: ImageBoxes) -> Extent:
        """Extent of the ground in images, to a pixel or two; not finite if they show no ground.

        The farthest ground in each direction lies at the edge of an image, or at ``flattest_deg``, where one ray a
        pixel is traced. Images whose boxes do not reach beyond the extent so far are skipped.

        Parameters
        ----------
        boxes : ImageBoxes
            Boxes of all images.
        """
        extents: dict[int, Extent] = {}
        found = [math.inf, math.inf, -math.inf, -math.inf]
        for at, (box, sign) in enumerate(zip(boxes, (1.0, 1.0, -1.0, -1.0))):
            outermost = np.argsort(sign * box)[: int(np.isfinite(box).sum())]
            for index in outermost.tolist():
                if sign * float(box[index]) >= sign * found[at]:
                    break
                if index not in extents:
                    one = extents[index] = self._extent(index, boxes)
                    found = [*map(min, found[:2], one[:2]), *map(max, found[2:], one[2:])]
        return Extent(*found)

    def _extent(self, index: int, boxes: ImageBoxes) -> Extent:
        """Extent of the ground in one image."""
        width, height = self.sizes_px[index].tolist()
        x, y = np.linspace(-1.0, 1.0, width + 1), np.linspace(-1.0, 1.0, height + 1)
        edge = [*(np.stack([x, np.full_like(x, at)], axis=-1) for at in (-1.0, 1.0))]
        edge += [*(np.stack([np.full_like(y, at), y], axis=-1) for at in (-1.0, 1.0))]
        east, north, all_met = self._traced(index, np.concatenate(edge), boxes)
        if not all_met:
            # The relief ends within the image: trace a ray every other pixel.
            x, y = (np.linspace(-1.0, 1.0, side // 2 + 2) for side in (width, height))
            inner_east, inner_north, _ = self._traced(index, np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2), boxes)
            east, north = np.concatenate([east, inner_east]), np.concatenate([north, inner_north])
        if not len(east):
            return Extent(math.inf, math.inf, -math.inf, -math.inf)
        return Extent(*(float(edge) for edge in (east.min(), north.min(), east.max(), north.max())))

    def _traced(self, index: int, points: Floats, boxes: ImageBoxes) -> tuple[Floats, Floats, bool]:
        """Trace image points (k, 2) to the ground; returns positions in the CRS, and whether all rays meet it."""
        pose, camera = self.poses.take(np.array([index])), self.cameras.of(index)
        rays = self._limit_flatness(camera.rays_enu(points, *pose.attitude), pose)[0]
        right, up, depth = np.moveaxis(rays @ np.stack(image_axes(*pose.attitude), axis=-1)[0], -1, 0)
        # Rays made steeper may leave the image. Rays along its edge are inside but for rounding.
        tolerance = 1.0 + 1e-9
        if camera.distorts:
            rays = rays[(np.abs(np.stack(_seen(camera, right, up, depth))) <= tolerance).all(axis=0) & (depth > 0.0)]
        else:
            tan_x, tan_y = camera.half_tangents
            rays = rays[(np.abs(right) <= tolerance * tan_x * depth) & (np.abs(up) <= tolerance * tan_y * depth)]
        lat, lon, agl = (np.broadcast_to(at, len(rays)) for at in pose[:3])
        if self.relief is None:
            seen = trace(lat, agl, rays, self.ground)
            seen_lat, dlon = seen.lat_deg, seen.dlon_deg
        else:
            # Take the relief around a grid of five by five nodes, as edges of the box are curves in degrees.
            nodes = np.meshgrid(
                *(
                    np.linspace(float(low[index]), float(high[index]), 5)
                    for low, high in ((boxes.west, boxes.east), (boxes.south, boxes.north))
                )
            )
            about_lat, about_lon = (at.ravel() for at in places(self.plane, *nodes))
            known = np.isfinite(about_lat)
            surface = self._surface(np.append(about_lat[known], lat[:1]), np.append(about_lon[known], lon[:1]))
            seen_lat, dlon, _, _ = surface.first_points(lat, lon, agl, rays, surface.lowest_m)
        east, north = self._on_map(seen_lat, lon + dlon)
        met = np.isfinite(east) & np.isfinite(north)
        return east[met], north[met], bool(met.all())

    def _on_map(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Positions in the CRS, clipped to Web Mercator's latitudes."""
        if isinstance(self.plane, WebMercator):
            lat_deg = np.clip(lat_deg, -MAX_LAT_DEG, MAX_LAT_DEG)
        return positions(self.plane, lat_deg, lon_deg)

    def _limit_flatness(self, rays: Floats, poses: Poses) -> Floats:
        """Rays (n, k, 3), of which rays flatter than ``flattest_deg`` at the ground are tilted down to that angle."""
        # The angle from the vertical grows along a ray, as the Earth curves away.
        radius = WGS84.b_m + self._base_m
        reach = radius / (WGS84.b_m + np.maximum(poses.agl_m, self._base_m))
        tangent = np.tan(np.arcsin(reach * math.sin(math.radians(self.flattest_deg))))[:, np.newaxis]
        level = np.hypot(rays[..., 0], rays[..., 1])
        flat = level > -rays[..., 2] * tangent
        bent = np.stack(
            [
                *(rays[..., axis] / np.maximum(level, 1e-12) * tangent for axis in (0, 1)),
                -np.ones_like(level),
            ],
            axis=-1,
        )
        return np.where(flat[..., np.newaxis], bent, rays)

    def _boxes(self, camera: Camera, poses: Poses, count: int, margin: float) -> Floats:
        side = np.linspace(-1.0, 1.0, count)
        points = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
        rays = self._limit_flatness(camera.rays_enu(points, *poses.attitude), poses)
        x: list[Floats] = []
        y: list[Floats] = []
        for level_m in self._levels_m:
            seen = trace(
                poses.lat_deg[:, np.newaxis],
                poses.agl_m[:, np.newaxis] - level_m,
                rays,
                self.ground.raised(level_m),
            )
            found = self._on_map(seen.lat_deg, poses.lon_deg[:, np.newaxis] + seen.dlon_deg)
            for parts, values in zip((x, y), found):
                parts.append(np.where(np.isfinite(values), values, np.nan))
        across, down = np.concatenate(x, axis=1), np.concatenate(y, axis=1)
        has_ground = np.isfinite(across).any(axis=1) & np.isfinite(down).any(axis=1)
        across, down = (np.where(has_ground[:, np.newaxis], at, 0.0) for at in (across, down))
        west, east, south, north = (end(at, axis=1) for at in (across, down) for end in (np.nanmin, np.nanmax))
        more_x, more_y = margin * (east - west), margin * (north - south)
        box = np.stack([west - more_x, south - more_y, east + more_x, north + more_y])
        return np.where(has_ground, box, np.nan)

    def block_ground(self, block: PixelBlock, candidates: Numbers) -> BlockGround:
        """Ground of a block that candidate images may show."""
        if self.relief is None:
            return BlockGround.level(block, self.ground)
        known = np.isfinite(block.lat_deg)
        lat = np.concatenate([block.lat_deg[known], self.poses.lat_deg[candidates]])
        lon = np.concatenate([block.lon_deg[known], self.poses.lon_deg[candidates]])
        return BlockGround.from_surface(block, self._surface(lat, lon))

    def _surface(self, lat_deg: Floats, lon_deg: Floats) -> Surface:
        """Relief over the bounding box of places, with a bounded number of cells."""
        relief = self.relief
        if relief is None:
            raise InvalidInput("relief: the ground is level")
        high = float(np.ptp(lat_deg)) * math.radians(1.0) * WGS84.a_m
        wide = float(np.ptp(lon_deg)) * math.radians(1.0) * WGS84.a_m * math.cos(math.radians(lat_deg[0]))
        # At most a million cells of relief for one block.
        least_m = math.sqrt(high * wide / (1 << 20))
        finest_m = relief.cell_m(float(lat_deg[0]), float(lon_deg[0]))
        return relief.surface(lat_deg, lon_deg, least_m if least_m > finest_m else 0.0)

    def sight(self, index: int, block: PixelBlock, ground: BlockGround) -> Sight:  # noqa: ARG002  as of map frames
        """Position of a block's ground in one image."""
        towards = ground.points - self.centres[index]
        right, up, depth = np.moveaxis(towards @ self.axes[index].T, -1, 0)
        with np.errstate(invalid="ignore", divide="ignore"):
            image_x, image_y = _seen(self.cameras.of(index), right, up, depth)
            x, y = (1.0 + image_x) / 2.0, (1.0 - image_y) / 2.0
            steepness = -np.einsum("...i,...i", towards, ground.normals) / np.linalg.norm(towards, axis=-1)
            inside = (depth > 0.0) & (x >= 0.0) & (x <= 1.0) & (y >= 0.0) & (y <= 1.0)
            inside &= steepness > math.cos(math.radians(self.flattest_deg))
        return Sight(x, y, inside, steepness)

    def visible(self, index: int, ground: BlockGround, which: Flags) -> Flags:
        """Pixels (h, w) among ``which`` whose ground is not hidden from an image by relief."""
        surface = ground.surface
        if surface is None or not which.any():
            return which
        points = ground.points[which]
        towards = points - self.centres[index]
        pose = self.poses.take(np.full(len(points), index))
        # Compiled code takes several times as long for rays from one camera to scattered points.
        with without_numba():
            lat, dlon, height, hit = surface.first_points(
                pose.lat_deg,
                pose.lon_deg,
                pose.agl_m,
                towards @ enu_axes(pose.lat_deg[0], pose.lon_deg[0]).T,
                surface.lowest_m,
            )
        met = geocentric(lat, pose.lon_deg + dlon, height)
        cell = float(surface.grid.ground_m_per_px(pose.lat_deg[:1], pose.lon_deg[:1], surface.zoom)[0])
        # At grazing angles, rounding puts visible ground up to 0.02 cells behind the point that its ray meets.
        seen = ~(hit & (np.linalg.norm(met - points, axis=-1) > 0.02 * cell))
        found = which.copy()
        found[which] = seen
        return found

    def steepness_bounds(self, block: PixelBlock, ground: BlockGround, candidates: Numbers) -> Floats:
        """Upper bounds (k,) of the steepness of images anywhere in a block."""
        away = _away(block, *(at[candidates] for at in self.nadirs)) * _metres_a_unit(block, ground)
        lowest = 0.0 if ground.surface is None else ground.surface.lowest_m
        above = np.maximum(self.poses.agl_m[candidates] - lowest, 1e-3)
        bound: Floats = above / np.hypot(above, away)
        return np.where(np.isfinite(bound), bound, 1.0)

    def take(self, rows: Numbers) -> CameraImages:
        """Return some of the images."""
        paths = tuple(self.paths[row] for row in rows.tolist())
        return replace(
            self, cameras=self.cameras[rows], poses=self.poses.take(rows), paths=paths, sizes_px=self.sizes_px[rows]
        )


def _seen(camera: Camera, right: Floats, up: Floats, depth: Floats) -> tuple[Floats, Floats]:
    """Image points of vectors by their parts; meaningless where ``depth`` is not positive."""
    tan_x, tan_y = camera.half_tangents
    if not camera.distorts:
        return right / depth / tan_x, up / depth / tan_y
    ahead = np.where(depth > 0.0, depth, 1.0)
    at = camera.seen_xy(np.stack([right / ahead / tan_x, up / ahead / tan_y], axis=-1))
    return at[..., 0], at[..., 1]


@dataclass(frozen=True, eq=False)
class MapImages:
    """Map frames, n of them, in any orientation.

    Parameters
    ----------
    affines : array (n, 6)
        Geotransforms, in GDAL's order.
    sizes_px : array (n, 2)
        Width and height.
    nadirs : tuple of arrays (n,)
        Nadirs of the cameras in the CRS.
    gsd_m : float
        Ground that a pixel spans.
    """

    affines: Floats
    sizes_px: Numbers
    nadirs: tuple[Floats, Floats]
    gsd_m: float
    paths: tuple[Path, ...]
    plane: Plane

    def __len__(self) -> int:
        return len(self.paths)

    @property
    def coarsest_gsd_m(self) -> float:
        """``gsd_m``: all pixels of a map are alike."""
        return self.gsd_m

    def boxes(self) -> ImageBoxes:
        """Exact bounding boxes of the ground in images."""
        x0, xx, xy, y0, yx, yy = self.affines.T
        width, height = self.sizes_px.T
        x = np.stack([x0 + xx * a * width + xy * b * height for a in (0, 1) for b in (0, 1)])
        y = np.stack([y0 + yx * a * width + yy * b * height for a in (0, 1) for b in (0, 1)])
        return ImageBoxes(x.min(axis=0), y.min(axis=0), x.max(axis=0), y.max(axis=0))

    def extent(self, boxes: ImageBoxes) -> Extent:
        """Exact extent of the ground in images."""
        west, south, east, north = boxes
        return Extent(*map(float, (west.min(), south.min(), east.max(), north.max())))

    def block_ground(self, block: PixelBlock, candidates: Numbers) -> BlockGround:  # noqa: ARG002  as of camera frames
        """Return an empty ground, as images show the map itself."""
        empty = np.zeros((*block.lat_deg.shape, 0))
        return BlockGround(empty, empty)

    def sight(self, index: int, block: PixelBlock, ground: BlockGround) -> Sight:  # noqa: ARG002  as of camera frames
        """Position of a block's pixels in one image."""
        x0, xx, xy, y0, yx, yy = self.affines[index].tolist()
        width, height = self.sizes_px[index].tolist()
        x, y = np.meshgrid(block.x - x0, block.y - y0)
        turn = xx * yy - xy * yx
        across, down = (x * yy - y * xy) / turn / width, (y * xx - x * yx) / turn / height
        inside = (across >= 0.0) & (across <= 1.0) & (down >= 0.0) & (down <= 1.0)
        nadir_x, nadir_y = (float(at[index]) for at in self.nadirs)
        away = (block.x - nadir_x) ** 2 + ((block.y - nadir_y) ** 2)[:, np.newaxis]
        return Sight(across, down, inside, -away)

    def visible(self, index: int, ground: BlockGround, which: Flags) -> Flags:  # noqa: ARG002  as of camera frames
        """Return ``which``: nothing hides a map."""
        return which

    def steepness_bounds(self, block: PixelBlock, ground: BlockGround, candidates: Numbers) -> Floats:  # noqa: ARG002
        """Upper bounds (k,) of the steepness of images anywhere in a block."""
        bound: Floats = -(_away(block, *(at[candidates] for at in self.nadirs)) ** 2)
        return bound


PlacedImages = Union[CameraImages, MapImages]


def place_images(
    folder: Path, map_type: str | None = None, open_heights: OpenHeights = mission_heights
) -> tuple[PlacedImages, ImageSet, Numbers]:
    """Find the images of a dataset's map type (None for the first), without failed and rejected images.

    Returns
    -------
    frames
    images : ImageSet
    rows : array (n,)
        Rows of the images in their table.

    Raises
    ------
    InvalidInput
        The folder is not a capture, lacks the map type or images, or an image has no georeference.
    SourceError
        The heights cannot be opened.
    """
    dataset = read_dataset(folder)
    images = dataset.image_set(map_type or next(iter(dataset.image_sets)))
    rows = np.flatnonzero(usable_rows(images.table)).astype(np.int64)
    if not len(rows):
        raise InvalidInput("folder {0}: has no image to make a mosaic of", images.folder)
    if are_camera_frames(images, rows, Path(folder)):
        return camera_frames(folder, images, rows, open_heights), images, rows
    return _map_frames(images, rows), images, rows


def camera_frames(folder: Path, images: ImageSet, rows: Numbers, open_heights: OpenHeights) -> CameraImages:
    """Camera frames of some rows of a map type's table; image files are not read.

    Raises
    ------
    InvalidInput
        The folder lacks the mission file, which holds the camera.
    SourceError
        The heights cannot be opened.
    """
    if not (folder / MISSION_FILE).is_file():
        raise InvalidInput("folder {0}: has no {1}, which describes the camera", folder, MISSION_FILE)
    check_poses(images, rows, needed=True)
    mission, table = Mission.load(folder / MISSION_FILE), images.table
    lat, agl = table.pose_lat_deg[rows], table.agl_m[rows]
    _, middle = middle_position(lat, table.pose_lon_deg[rows])
    lon = middle + wrap_lon_deg(table.pose_lon_deg[rows] - middle)
    relief, ground = None, WGS84.raised(mission.flight.ground_height_m)
    heights = open_heights(mission)
    if heights is not None:
        # Captures over level relief have no heights in the table.
        height = table.height_m[rows]
        relief, ground = seen_surface(heights), WGS84
        if np.isnan(height).any():
            below = heights.ground.surface(lat[:1], lon[:1])
            relief = None
            ground = WGS84.raised(float(below.heights(*below.position(lat[:1], lon[:1]))[0]))
        else:
            agl = height
    attitude = (table.yaw_deg[rows], table.tilt_deg[rows], table.roll_deg[rows])
    sizes = np.stack([side[rows] for side in (table.image_width_px, table.image_height_px)], axis=1)
    return CameraImages(
        CaptureCameras.drawn(mission, table.columns[rows], table.rows[rows], images.map_type),
        Poses(lat, lon, agl, *attitude),
        ground,
        relief,
        tuple(images.path(row) for row in rows.tolist()),
        sizes.astype(np.int64),
        _table_plane(table, rows),
    )


def _map_frames(images: ImageSet, rows: Numbers) -> MapImages:
    check_poses(images, rows, needed=False)
    table, plane = images.table, _table_plane(images.table, rows)
    paths = tuple(images.path(row) for row in rows.tolist())
    affines = np.array([_read_affine(path) for path in paths])
    sizes = np.stack([side[rows] for side in (table.image_width_px, table.image_height_px)], axis=1)
    sizes = sizes.astype(np.int64)
    lat, lon = table.pose_lat_deg[rows], table.pose_lon_deg[rows]
    lat, lon = (np.where(np.isnan(pose), at[rows], pose) for pose, at in ((lat, table.lat_deg), (lon, table.lon_deg)))
    x, y = positions(plane, lat, lon)
    if isinstance(plane, WebMercator):
        middle = affines[:, 0] + affines[:, 1] * sizes[:, 0] / 2.0 + affines[:, 2] * sizes[:, 1] / 2.0
        # A camera and its image may be on different sides of the antimeridian.
        x = x + np.rint((middle - x) / plane.width) * plane.width
        turns = np.rint((x - x[0]) / plane.width) * plane.width
        affines[:, 0] -= turns
        x = x - turns
    pixel_size = math.sqrt(abs(affines[0, 1] * affines[0, 5] - affines[0, 2] * affines[0, 4]))
    gsd = pixel_size * unit_m(plane, float(lat[0]), float(lon[0]))
    return MapImages(affines, sizes, (x, y), gsd, paths, plane)


def _read_affine(path: Path) -> tuple[float, ...]:
    """Read the geotransform of a map frame from its file, or from the world file beside it."""
    try:
        if path.suffix not in _WORLD_FILES:
            # Map the file, so that only the directory of a large one is read.
            with open_foreign(path) as file, mmap(file.fileno(), 0, access=ACCESS_READ) as data:
                found = parse_affine(data)
        else:
            text = decoded(read_limited(path.with_suffix(_WORLD_FILES[path.suffix]), MAX_SETTINGS_BYTES))
            xx, yx, xy, yy, x, y = map(real_number, text.split())
            found = (x - (xx + xy) / 2.0, xx, xy, y - (yx + yy) / 2.0, yx, yy)
    except (OSError, ValueError) as wrong:
        raise InvalidInput("image {0}: cannot be read ({1})", path, wrong) from wrong
    if found is None:
        raise InvalidInput("image {0}: has no georeference", path)
    return found


def _table_plane(table: Table, rows: Numbers) -> Plane:
    """Plane of the CRS of a table's images."""
    return image_plane(table, int(rows[0])) if table.crs[rows[0]] else WebMercator()


def unit_m(plane: Plane, lat_deg: float, lon_deg: float) -> float:
    """Metres of ground along a unit of a CRS at a place, along its rows."""
    lat, lon = np.array([lat_deg]), np.array([lon_deg])
    if isinstance(plane, ProjectedPlane):
        return float(plane.ground_m(lat, lon)[0][0]) / plane.width
    return float((WGS84.normal_radius_m(lat) / WGS84.a_m * np.cos(np.radians(lat)))[0])


def _away(block: PixelBlock, x: Floats, y: Floats) -> Floats:
    """Lower bounds (k,) of distances from places to a block, in the unit of the CRS."""
    off_x = np.maximum(np.maximum(block.x[0] - x, x - block.x[-1]), 0.0)
    off_y = np.maximum(np.maximum(block.y[-1] - y, y - block.y[0]), 0.0)
    # Reduced by 3 %, as the scale of a map varies.
    away: Floats = 0.97 * np.hypot(off_x, off_y)
    return away


def _metres_a_unit(block: PixelBlock, ground: BlockGround) -> float:
    """Metres of ground along a unit of the CRS in a block; 0 if unknown."""
    span = math.hypot(block.x[-1] - block.x[0], block.y[-1] - block.y[0])
    metres = float(np.linalg.norm(ground.points[-1, -1] - ground.points[0, 0]))
    return metres / span if span > 0.0 and math.isfinite(metres) else 0.0
