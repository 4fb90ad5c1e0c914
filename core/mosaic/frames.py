"""Images and the ground that they show: camera frames by their poses, map frames by their places in the map."""

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
from ..geodesy.camera import CORNERS, Camera, Poses, image_axes
from ..geodesy.ellipsoid import WGS84, Ellipsoid, trace
from ..geodesy.local import enu_axes, geocentric
from ..geodesy.mercator import MAX_LAT_DEG, Plane, WebMercator, wrap_lon_deg
from ..geodesy.planes import ProjectedPlane
from ..geodesy.raytracing.surface import Surface
from ..geodesy.raytracing.tracing import ElevationModel
from ..limits import MAX_SETTINGS_BYTES
from ..mission.mission import Mission
from ..mission.plan import Plan
from ..mission.relief.ground import Heights
from ..numbers import real_number
from ..picture.heights import heights_of
from ..storage.files import open_foreign, read_limited
from ..text.safe_json import decoded
from .raster import BlockGround, PixelBlock, places, positions

OpenHeights = Callable[[Mission], "Heights | None"]

#: Ground is taken from images that see it at less than this from straight above, degrees: beyond, the pixels of a
#: camera reach over 30 of those below it.
FLATTEST_DEG = 80.0
#: Rays along each side of an image by which the box of its ground is found, and what that may be larger by: ground
#: bends between rays by less.
_RAYS, _MARGIN = 9, 1.0 / 32.0
#: Pixels from ray to ray in an image within which the relief ends; nodes along each side of a box by which the relief
#: about it is found; rounding of rays along an image's edge.
_EACH_PX, _NODES, _ON_EDGE = 2, 5, 1.0 + 1e-9
#: Images whose boxes are worked out at a time, to bound memory: some 30 MB.
_BOXED = 2048
_WORLD_FILES = {".jpg": ".jgw", ".png": ".pgw"}


class Sight(NamedTuple):
    """Where an image shows the ground of a block, (h, w) each.

    Attributes
    ----------
    x, y : array
        In shares of the image's width and height, from its upper left corner; without meaning where it shows none.
    inside : array of bool
        Whether it holds the ground; relief in front may hide it all the same.
    steepness : array
        Greater, the more nearly the ground lies below the camera.
    """

    x: Floats
    y: Floats
    inside: Flags
    steepness: Floats


class ImageBoxes(NamedTuple):
    """Boxes (n,) that hold what images show of the ground, in the unit of a CRS; NaN for none."""

    west: Floats
    south: Floats
    east: Floats
    north: Floats


class Ends(NamedTuple):
    """Edges of a rectangle, in the unit of a CRS."""

    west: float
    south: float
    east: float
    north: float


@dataclass(frozen=True, eq=False)
class CameraImages:
    """Images of cameras, n of them.

    Parameters
    ----------
    poses : Poses
        ``agl_m`` over ``ground``; longitudes are continuous.
    ground : Ellipsoid
        The level ground that they see; WGS 84 where there is relief.
    relief : ElevationModel or None
    paths : tuple of Path
    sizes_px : array (n, 2)
        Widths and heights of the images as written.
    plane : Plane
        Of the CRS that their mosaic is to have.
    flattest_deg : float
        Ground seen at more than this from straight above is left out.
    """

    camera: Camera
    poses: Poses
    ground: Ellipsoid
    relief: ElevationModel | None
    paths: tuple[Path, ...]
    sizes_px: Numbers
    plane: Plane
    flattest_deg: float = FLATTEST_DEG

    def __len__(self) -> int:
        return len(self.paths)

    @classmethod
    def from_plan(cls, plan: Plan, index: int, path: Path) -> CameraImages:
        """The image of one of a plan's captures, as far as it sees the ground."""
        poses = plan.poses.take(slice(index, index + 1))
        if not plan.relief.is_level:
            poses = poses._replace(agl_m=plan.height_m[index : index + 1])
        size = plan.mission.output.img_size or (
            int(plan.frames.width_px[index]),
            int(plan.frames.height_px[index]),
        )
        return cls(
            plan.mission.camera,
            poses,
            plan.ground if plan.relief.is_level else WGS84,
            None if plan.relief.is_level else plan.relief.heights.surface,
            (path,),
            np.array([size[:2]]),
            plan.grid.plane,
        )

    @cached_property
    def centres(self) -> Floats:
        """Cameras from the Earth's centre, (n, 3)."""
        return geocentric(self.poses.lat_deg, self.poses.lon_deg, self.poses.agl_m, self.ground)

    @cached_property
    def axes(self) -> Floats:
        """Right, top and view of the images as rows, (n, 3, 3), in geocentric axes."""
        own = np.stack(image_axes(*self.poses.attitude), axis=-2)
        turned: Floats = own @ enu_axes(self.poses.lat_deg, self.poses.lon_deg)
        return turned

    @cached_property
    def nadirs(self) -> tuple[Floats, Floats]:
        """Places below the cameras, (n,), in the CRS."""
        return positions(self.plane, self.poses.lat_deg, self.poses.lon_deg)

    @property
    def gsd_m(self) -> float:
        """Ground that a pixel in the middle of an image that looks straight down spans: the median of all."""
        below = self.poses.agl_m
        if self.relief is not None:
            below = below - self._heights_below
        return self.camera.gsd_m_per_px(float(np.nanmedian(below / self.sizes_px.max(axis=1))), 1.0)

    @property
    def coarsest_gsd_m(self) -> float:
        """Ground that a pixel spans across the view where images look flattest, as far as that counts."""
        rays = self.camera.rays_enu(CORNERS, *self.poses.attitude)
        upright = float((-rays[..., 2] / np.linalg.norm(rays, axis=-1)).min())
        return self.gsd_m / max(upright, math.cos(math.radians(self.flattest_deg)))

    @cached_property
    def _heights_below(self) -> Floats:
        """Heights of the relief below the cameras, (n,); NaN where it has none."""
        surface = self._surface(self.poses.lat_deg, self.poses.lon_deg)
        return surface.heights(*surface.position(self.poses.lat_deg, self.poses.lon_deg))

    @cached_property
    def _base_m(self) -> float:
        """Height over ``ground`` of that below the cameras, at its highest."""
        return 0.0 if self.relief is None else max(float(np.nanmax(self._heights_below)), 0.0)

    @cached_property
    def _levels_m(self) -> tuple[float, ...]:
        """Heights over ``ground`` between which all ground lies that images show."""
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
        # Larger cells than the finest leave peaks and hollows out.
        spare = 0.1 * (highest - lowest)
        return (lowest - spare, min(highest + spare, float(self.poses.agl_m.min()) - 1.0))

    def boxes(self, rays: int = _RAYS, margin: float = _MARGIN) -> ImageBoxes:
        """Boxes of the ground that images show."""
        edges = np.full((4, len(self)), np.nan)
        for start in range(0, len(self), _BOXED):
            part = slice(start, start + _BOXED)
            edges[:, part] = self._boxes(self.poses.take(part), rays, margin)
        return ImageBoxes(*edges)

    def ends(self, boxes: ImageBoxes) -> Ends:
        """Ends of the ground that images show, to a pixel or two of theirs; not finite where they show none.

        Along each direction from below a camera, what it shows farthest away lies at the edge of its image, or where
        it looks too flat: one ray a pixel goes there. Only images whose boxes reach beyond what others show count.

        Parameters
        ----------
        boxes : ImageBoxes
            Of all images.
        """
        own: dict[int, Ends] = {}
        found = [math.inf, math.inf, -math.inf, -math.inf]
        for at, (box, sign) in enumerate(zip(boxes, (1.0, 1.0, -1.0, -1.0))):
            outermost = np.argsort(sign * box)[: int(np.isfinite(box).sum())]
            for index in outermost.tolist():
                if sign * float(box[index]) >= sign * found[at]:
                    break
                if index not in own:
                    own[index] = self._ends(index, boxes)
                    found = [*map(min, found[:2], own[index][:2]), *map(max, found[2:], own[index][2:])]
        return Ends(*found)

    def _ends(self, index: int, boxes: ImageBoxes) -> Ends:
        """Ends of the ground that one image shows."""
        width, height = self.sizes_px[index].tolist()
        x, y = np.linspace(-1.0, 1.0, width + 1), np.linspace(-1.0, 1.0, height + 1)
        edge = [*(np.stack([x, np.full_like(x, at)], axis=-1) for at in (-1.0, 1.0))]
        edge += [*(np.stack([np.full_like(y, at), y], axis=-1) for at in (-1.0, 1.0))]
        east, north, all_met = self._met(index, np.concatenate(edge), boxes)
        if not all_met:
            # The relief ends within the image.
            x, y = (np.linspace(-1.0, 1.0, side // _EACH_PX + 2) for side in (width, height))
            inner_east, inner_north, _ = self._met(index, np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2), boxes)
            east, north = np.concatenate([east, inner_east]), np.concatenate([north, inner_north])
        if not len(east):
            return Ends(math.inf, math.inf, -math.inf, -math.inf)
        return Ends(*(float(end) for end in (east.min(), north.min(), east.max(), north.max())))

    def _met(self, index: int, points: Floats, boxes: ImageBoxes) -> tuple[Floats, Floats, bool]:
        """Where rays of an image through points (k, 2) of it meet the ground, in the CRS; whether all do."""
        pose = self.poses.take(np.array([index]))
        rays = self._no_flatter(self.camera.rays_enu(points, *pose.attitude), pose)[0]
        right, up, depth = np.moveaxis(rays @ np.stack(image_axes(*pose.attitude), axis=-1)[0], -1, 0)
        tan_x, tan_y = self.camera.half_tangents
        # Those that were bent may have left it.
        rays = rays[(np.abs(right) <= _ON_EDGE * tan_x * depth) & (np.abs(up) <= _ON_EDGE * tan_y * depth)]
        lat, lon, agl = (np.broadcast_to(at, len(rays)) for at in pose[:3])
        if self.relief is None:
            seen = trace(lat, agl, rays, self.ground)
            seen_lat, dlon = seen.lat_deg, seen.dlon_deg
        else:
            corners = np.meshgrid(
                *(
                    np.linspace(float(low[index]), float(high[index]), _NODES)
                    for low, high in ((boxes.west, boxes.east), (boxes.south, boxes.north))
                )
            )
            about_lat, about_lon = (at.ravel() for at in places(self.plane, *corners))
            known = np.isfinite(about_lat)
            surface = self._surface(np.append(about_lat[known], lat[:1]), np.append(about_lon[known], lon[:1]))
            seen_lat, dlon, _, _ = surface.first_points(lat, lon, agl, rays, surface.lowest_m)
        east, north = self._on_map(seen_lat, lon + dlon)
        met = np.isfinite(east) & np.isfinite(north)
        return east[met], north[met], bool(met.all())

    def _on_map(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Places in the CRS; what lies beyond the map's edge is on none of its images."""
        if isinstance(self.plane, WebMercator):
            lat_deg = np.clip(lat_deg, -MAX_LAT_DEG, MAX_LAT_DEG)
        return positions(self.plane, lat_deg, lon_deg)

    def _no_flatter(self, rays: Floats, poses: Poses) -> Floats:
        """Rays (n, k, 3), those that would see ground too flat bent down to where that begins."""
        # The Earth bends away below a ray.
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

    def _boxes(self, poses: Poses, count: int, margin: float) -> Floats:
        side = np.linspace(-1.0, 1.0, count)
        points = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
        rays = self._no_flatter(self.camera.rays_enu(points, *poses.attitude), poses)
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
        there = np.isfinite(across).any(axis=1) & np.isfinite(down).any(axis=1)
        across, down = (np.where(there[:, np.newaxis], at, 0.0) for at in (across, down))
        west, east, south, north = (end(at, axis=1) for at in (across, down) for end in (np.nanmin, np.nanmax))
        more_x, more_y = margin * (east - west), margin * (north - south)
        box = np.stack([west - more_x, south - more_y, east + more_x, north + more_y])
        return np.where(there, box, np.nan)

    def block_ground(self, block: PixelBlock, candidates: Numbers) -> BlockGround:
        """Ground of a block, which some images may show."""
        if self.relief is None:
            return BlockGround.level(block, self.ground)
        known = np.isfinite(block.lat_deg)
        lat = np.concatenate([block.lat_deg[known], self.poses.lat_deg[candidates]])
        lon = np.concatenate([block.lon_deg[known], self.poses.lon_deg[candidates]])
        return BlockGround.from_surface(block, self._surface(lat, lon))

    def _surface(self, lat_deg: Floats, lon_deg: Floats) -> Surface:
        """Relief over the box about places, of a bounded number of cells."""
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
        """Where one image shows the ground of a block."""
        towards = ground.points - self.centres[index]
        right, up, depth = np.moveaxis(towards @ self.axes[index].T, -1, 0)
        tan_x, tan_y = self.camera.half_tangents
        with np.errstate(invalid="ignore", divide="ignore"):
            x, y = (1.0 + right / depth / tan_x) / 2.0, (1.0 - up / depth / tan_y) / 2.0
            steepness = -np.einsum("...i,...i", towards, ground.normals) / np.linalg.norm(towards, axis=-1)
            inside = (depth > 0.0) & (x >= 0.0) & (x <= 1.0) & (y >= 0.0) & (y <= 1.0)
            inside &= steepness > math.cos(math.radians(self.flattest_deg))
        return Sight(x, y, inside, steepness)

    def unhidden(self, index: int, ground: BlockGround, which: Flags) -> Flags:
        """Those of some pixels (h, w) of a block whose ground no relief hides from an image."""
        surface = ground.surface
        if surface is None or not which.any():
            return which
        points = ground.points[which]
        towards = points - self.centres[index]
        pose = self.poses.take(np.full(len(points), index))
        lat, dlon, height, hit = surface.first_points(
            pose.lat_deg,
            pose.lon_deg,
            pose.agl_m,
            towards @ enu_axes(pose.lat_deg[0], pose.lon_deg[0]).T,
            surface.lowest_m,
        )
        met = geocentric(lat, pose.lon_deg + dlon, height)
        cell = float(surface.grid.ground_m_per_px(pose.lat_deg[:1], pose.lon_deg[:1], surface.zoom)[0])
        # Rounding and grazing rays leave ground this share of a cell behind the point that a ray meets.
        seen = ~(hit & (np.linalg.norm(met - points, axis=-1) > 0.02 * cell))
        found = which.copy()
        found[which] = seen
        return found

    def steepest(self, block: PixelBlock, ground: BlockGround, candidates: Numbers) -> Floats:
        """Least upper bounds (k,) of the steepness that images have anywhere in a block."""
        away = _away(block, *(at[candidates] for at in self.nadirs)) * _metres_a_unit(block, ground)
        lowest = 0.0 if ground.surface is None else ground.surface.lowest_m
        above = np.maximum(self.poses.agl_m[candidates] - lowest, 1e-3)
        bound: Floats = above / np.hypot(above, away)
        return np.where(np.isfinite(bound), bound, 1.0)

    def take(self, rows: Numbers) -> CameraImages:
        """Some of the images."""
        paths = tuple(self.paths[row] for row in rows.tolist())
        return replace(self, poses=self.poses.take(rows), paths=paths, sizes_px=self.sizes_px[rows])


@dataclass(frozen=True, eq=False)
class MapImages:
    """Images that are pieces of a map, n of them, however they are turned in it.

    Parameters
    ----------
    affines : array (n, 6)
        GDAL's six numbers of each.
    sizes_px : array (n, 2)
        Width and height.
    nadirs : tuple of arrays (n,)
        Places below the cameras, in the CRS.
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
        """As of camera frames: of a map all pixels are alike."""
        return self.gsd_m

    def boxes(self) -> ImageBoxes:
        """Boxes of the ground that images show, exactly."""
        x0, xx, xy, y0, yx, yy = self.affines.T
        width, height = self.sizes_px.T
        x = np.stack([x0 + xx * a * width + xy * b * height for a in (0, 1) for b in (0, 1)])
        y = np.stack([y0 + yx * a * width + yy * b * height for a in (0, 1) for b in (0, 1)])
        return ImageBoxes(x.min(axis=0), y.min(axis=0), x.max(axis=0), y.max(axis=0))

    def ends(self, boxes: ImageBoxes) -> Ends:
        """Ends of the ground that images show, exactly."""
        west, south, east, north = boxes
        return Ends(*map(float, (west.min(), south.min(), east.max(), north.max())))

    def block_ground(self, block: PixelBlock, candidates: Numbers) -> BlockGround:  # noqa: ARG002  as of camera frames
        """Ground of a block: none, as images show the map itself."""
        none = np.zeros((*block.lat_deg.shape, 0))
        return BlockGround(none, none)

    def sight(self, index: int, block: PixelBlock, ground: BlockGround) -> Sight:  # noqa: ARG002  as of camera frames
        """Where one image shows a block of the map."""
        x0, xx, xy, y0, yx, yy = self.affines[index].tolist()
        width, height = self.sizes_px[index].tolist()
        x, y = np.meshgrid(block.x - x0, block.y - y0)
        turn = xx * yy - xy * yx
        across, down = (x * yy - y * xy) / turn / width, (y * xx - x * yx) / turn / height
        inside = (across >= 0.0) & (across <= 1.0) & (down >= 0.0) & (down <= 1.0)
        nadir_x, nadir_y = (float(at[index]) for at in self.nadirs)
        away = (block.x - nadir_x) ** 2 + ((block.y - nadir_y) ** 2)[:, np.newaxis]
        return Sight(across, down, inside, -away)

    def unhidden(self, index: int, ground: BlockGround, which: Flags) -> Flags:  # noqa: ARG002  as of camera frames
        """All pixels: nothing of a map is hidden."""
        return which

    def steepest(self, block: PixelBlock, ground: BlockGround, candidates: Numbers) -> Floats:  # noqa: ARG002  likewise
        """Least upper bounds (k,) of the steepness that images have anywhere in a block."""
        bound: Floats = -(_away(block, *(at[candidates] for at in self.nadirs)) ** 2)
        return bound


PlacedImages = Union[CameraImages, MapImages]


def place_images(
    folder: Path, map_type: str | None = None, open_heights: OpenHeights = heights_of
) -> tuple[PlacedImages, ImageSet, Numbers]:
    """Images of a dataset's map type, of its first one for None, without those that failed or are rejected.

    Returns
    -------
    frames
    images : ImageSet
    rows : array (n,)
        Of its table.

    Raises
    ------
    InvalidInput
        A folder that is no capture, has no such map type or no image, or whose images say no place.
    SourceError
        Heights that cannot be had.
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
    """Camera frames of a dataset, of some rows of a map type's table; their files are not looked at.

    Raises
    ------
    InvalidInput
        A folder without a mission file, which has the camera.
    SourceError
        Heights that cannot be had.
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
        # Relief that is level leaves no heights in the table.
        height = table.height_m[rows]
        relief, ground = heights.surface, WGS84
        if np.isnan(height).any():
            below = heights.ground.surface(lat[:1], lon[:1])
            relief = None
            ground = WGS84.raised(float(below.heights(*below.position(lat[:1], lon[:1]))[0]))
        else:
            agl = height
    attitude = (table.yaw_deg[rows], table.tilt_deg[rows], table.roll_deg[rows])
    sizes = np.stack([side[rows] for side in (table.image_width_px, table.image_height_px)], axis=1)
    return CameraImages(
        mission.camera,
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
        # A camera and its image may be given on different sides of the antimeridian.
        x = x + np.rint((middle - x) / plane.width) * plane.width
        turns = np.rint((x - x[0]) / plane.width) * plane.width
        affines[:, 0] -= turns
        x = x - turns
    a_pixel = math.sqrt(abs(affines[0, 1] * affines[0, 5] - affines[0, 2] * affines[0, 4]))
    gsd = a_pixel * unit_m(plane, float(lat[0]), float(lon[0]))
    return MapImages(affines, sizes, (x, y), gsd, paths, plane)


def _read_affine(path: Path) -> tuple[float, ...]:
    """GDAL's six numbers of a captured map frame, as its file or the world file beside it says."""
    try:
        if path.suffix not in _WORLD_FILES:
            # Of a large file, its directory alone is read.
            with open_foreign(path) as file, mmap(file.fileno(), 0, access=ACCESS_READ) as data:
                found = parse_affine(data)
        else:
            text = decoded(read_limited(path.with_suffix(_WORLD_FILES[path.suffix]), MAX_SETTINGS_BYTES))
            xx, yx, xy, yy, x, y = map(real_number, text.split())
            found = (x - (xx + xy) / 2.0, xx, xy, y - (yx + yy) / 2.0, yx, yy)
    except (OSError, ValueError) as wrong:
        raise InvalidInput("image {0}: cannot be read ({1})", path, wrong) from wrong
    if found is None:
        raise InvalidInput("image {0}: says no place on the map", path)
    return found


def _table_plane(table: Table, rows: Numbers) -> Plane:
    """Plane of the CRS that images of a table have."""
    return image_plane(table, int(rows[0])) if table.crs[rows[0]] else WebMercator()


def unit_m(plane: Plane, lat_deg: float, lon_deg: float) -> float:
    """Metres of ground that a unit of a CRS spans at a place, along its rows."""
    lat, lon = np.array([lat_deg]), np.array([lon_deg])
    if isinstance(plane, ProjectedPlane):
        return float(plane.ground_m(lat, lon)[0][0]) / plane.width
    return float((WGS84.normal_radius_m(lat) / WGS84.a_m * np.cos(np.radians(lat)))[0])


def _away(block: PixelBlock, x: Floats, y: Floats) -> Floats:
    """Distances (k,) from places to a block, in the unit of the CRS; a little less, as maps stretch ground unevenly."""
    off_x = np.maximum(np.maximum(block.x[0] - x, x - block.x[-1]), 0.0)
    off_y = np.maximum(np.maximum(block.y[-1] - y, y - block.y[0]), 0.0)
    away: Floats = 0.97 * np.hypot(off_x, off_y)
    return away


def _metres_a_unit(block: PixelBlock, ground: BlockGround) -> float:
    """Metres of ground that a unit of the CRS spans in a block; 0 where that is not known."""
    span = math.hypot(block.x[-1] - block.x[0], block.y[-1] - block.y[0])
    metres = float(np.linalg.norm(ground.points[-1, -1] - ground.points[0, 0]))
    return metres / span if span > 0.0 and math.isfinite(metres) else 0.0
