"""The two kinds of frames of pictures: map frames, rectangles of the source's pixels, and camera frames."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, Union

import numpy as np

from ...arrays import Floats, NDArray, Numbers
from ...geodesy.camera import Camera, Poses
from ...geodesy.ellipsoid import Ellipsoid
from ...geodesy.footprint import Corners
from ...geodesy.frames import Sizes, Windows, quarter_turns, swapped, window_centres
from ...geodesy.mercator import MAX_LAT_DEG, PixelGrid, u_to_lon, v_to_lat
from ...geodesy.planes import TurnedPlane
from ..lenses import CaptureCameras, Which
from ..mission import Mission
from ..relief.ground import Flown, Relief
from .coverage import Rectangles, unique_tiles
from .rotated import Pass, inner_rectangles, rotated_rectangles

#: First captures of runs of poses, (k,), and the run of each, (n,): see `Poses.runs`.
Runs = tuple[NDArray[np.intp], NDArray[np.intp]]


class SeenGround(Protocol):
    """Ground that the cameras of a plan see: see `views.CameraViews`."""

    @property
    def poles(self) -> NDArray[np.int64]:
        """1 or -1 for captures that see a pole, else 0, (n,)."""
        ...

    def centres(self) -> tuple[Floats, Floats]:
        """Latitude and longitude where the cameras' axes meet the ground, degrees, (n,) each."""
        ...

    def tile_keys(self, passes: tuple[Pass, ...]) -> NDArray[np.int64]:
        """Keys of the different tiles in the camera frames."""
        ...


class FramedPlan(Protocol):
    """Attributes of a `plan.Plan` that frames use."""

    @property
    def mission(self) -> Mission:
        """Mission of the plan."""

    @property
    def grid(self) -> PixelGrid:
        """Pixel grid of the source."""

    @property
    def zoom(self) -> int:
        """Zoom of the windows."""

    @property
    def row(self) -> Numbers:
        """Row of each capture, (n,)."""

    @property
    def cameras(self) -> CaptureCameras:
        """Cameras of the captures, (n,)."""

    @property
    def poses(self) -> Poses:
        """Poses as flown, (n,)."""

    @property
    def meant(self) -> Poses:
        """Planned poses, (n,)."""

    @property
    def nominal(self) -> Poses | None:
        """Planned poses if wind has moved them; else None."""

    @property
    def windows(self) -> Windows:
        """Windows on the grid, (n,)."""

    @property
    def edges(self) -> tuple[Floats, Floats, Floats, Floats]:
        """West, south, east, north of the windows in the unit of the CRS, (n,) each."""

    @property
    def corners(self) -> Corners:
        """Ground corners that the camera sees, (n, 4)."""

    @property
    def ground(self) -> Ellipsoid:
        """Level ground below captures."""

    @property
    def relief(self) -> Relief:
        """Ground below captures."""

    @property
    def flown(self) -> Flown | None:
        """Heights over relief; None over level ground."""

    @property
    def passes(self) -> tuple[Pass, ...]:
        """Passes of rows in a plane."""

    @property
    def views(self) -> SeenGround:
        """Ground that the cameras see."""

    @property
    def undistorted(self) -> FramedPlan:
        """Plan of the same captures with a lens that does not distort."""


@dataclass(frozen=True, eq=False)
class MapFrames:
    """Pictures that are windows of the source's pixels, turned by quarter turns and not resampled.

    Attributes
    ----------
    width_px, height_px : array (n,) of int64
        Sizes of the pictures, before any resizing.
    quarter_turns : array (n,) of int64
        Clockwise quarter turns from the map's north to the tops of the pictures, 0 to 3.
    """

    #: Whether pictures are rectangles of the map, stated by their edges and not resampled.
    on_map: ClassVar[bool] = True

    width_px: Numbers
    height_px: Numbers
    quarter_turns: Numbers

    @classmethod
    def from_windows(cls, windows: Windows, poses: Poses, grid: PixelGrid) -> MapFrames:
        """Frames of windows (n,), turned like the cameras."""
        turns = quarter_turns(poses, grid.plane)
        wide, high = windows.width_px, windows.height_px
        if turns.any():
            across = turns % 2 == 1
            wide, high = np.where(across, high, wide), np.where(across, wide, high)
        return cls(wide, high, turns)

    @property
    def largest_px(self) -> tuple[int, int]:
        """Width and height of the largest pictures."""
        return int(self.width_px.max()), int(self.height_px.max())

    @property
    def is_north_up(self) -> bool:
        """Whether the tops of all pictures point to the map's north."""
        return not self.quarter_turns.any()

    def take(self, which: NDArray[Any] | slice) -> MapFrames:
        """Frames of some captures, by index, mask or slice."""
        return MapFrames(self.width_px[which], self.height_px[which], self.quarter_turns[which])

    def runs(self, runs: Runs) -> Runs:
        """Runs of poses whose pictures have one view."""
        return runs

    def scene_sizes_px(self, windows: Windows, first: NDArray[np.intp]) -> tuple[Floats, Floats]:
        """Greatest widths and heights of the pictures of runs that begin at ``first``, (k,).

        Rounded edges make pictures of one row differ by a pixel.
        """
        sizes = (np.asarray(size[first], np.float64) + 1.0 for size in (windows.width_px, windows.height_px))
        return swapped(self.quarter_turns[first], *sizes)

    def resampled_px(self) -> float:
        """Number of resampled pixels: 0."""
        return 0.0

    def kernel(self, _mission: Mission, /) -> str:
        """Resampling of the pictures."""
        return "none"

    def has_masks(self, _plan: FramedPlan, /) -> bool:
        """Whether pictures may have pixels without imagery: no."""
        return False

    def centres(self, plan: FramedPlan) -> tuple[Floats, Floats]:
        """Latitude and longitude (wrapped) of the centres of the windows, degrees, (n,) each."""
        return window_centres(plan.windows, plan.grid, plan.zoom)

    def named_zooms(self, plan: FramedPlan) -> Numbers:
        """Zooms in the names of the pictures, (n,)."""
        return np.broadcast_to(np.int64(plan.zoom), self.width_px.shape)

    def finest_zoom(self, plan: FramedPlan) -> int:
        """Highest zoom of sampled pixels."""
        return plan.zoom

    def gsd_m_per_px(self, _mission: Mission, poses: Poses, grid: PixelGrid, zoom: int, /) -> float:
        """Median ground sample distance of the pictures: of the pixels at the zoom."""
        return float(np.median(grid.ground_m_per_px(poses.lat_deg, poses.lon_deg, zoom)))

    def tile_count(self, plan: FramedPlan) -> int:
        """Number of different tiles in the pictures."""
        return unique_tiles(plan.windows, plan.grid, plan.zoom)

    def rectangles(self, plan: FramedPlan, part: Pass, at: slice) -> Rectangles:
        """Windows of a pass in the plane of its rows, which is the map turned by quarter turns."""
        plane = part.plane
        if not isinstance(plane, TurnedPlane):
            world = plan.grid.world_px(plan.zoom)
            left, top, right, bottom = (edge[at] / world for edge in plan.windows.bounds_px)
            return inner_rectangles(plane, u_to_lon(left), v_to_lat(bottom), u_to_lon(right), v_to_lat(top))
        west, south, east, north = (edge[at] for edge in plan.edges)
        (x0, y0), (x1, y1) = plane.from_crs(west, south), plane.from_crs(east, north)
        return Rectangles(np.minimum(x0, x1), np.minimum(y0, y1), np.maximum(x0, x1), np.maximum(y0, y1))


@dataclass(frozen=True, eq=False)
class CameraFrames:
    """Pictures as the camera sees them, resampled; for coverage, each counts as a rectangle inside it."""

    on_map: ClassVar[bool] = False
    is_north_up: ClassVar[bool] = False

    sizes: Sizes

    @property
    def width_px(self) -> Numbers:
        """Widths of the pictures, before any resizing, (n,)."""
        return self.sizes.width_px

    @property
    def height_px(self) -> Numbers:
        """Heights of the pictures, before any resizing, (n,)."""
        return self.sizes.height_px

    @property
    def largest_px(self) -> tuple[int, int]:
        """Width and height of the largest pictures."""
        return self.sizes.largest

    @property
    def quarter_turns(self) -> Numbers:
        """Zeros, (n,)."""
        return np.broadcast_to(np.int64(0), self.width_px.shape)

    def take(self, which: NDArray[Any] | slice) -> CameraFrames:
        """Frames of some captures, by index, mask or slice."""
        return CameraFrames(self.sizes.take(which))

    def runs(self, runs: Runs) -> Runs:
        """Runs of poses whose pictures have one view."""
        return self.sizes.runs(*runs)

    def scene_sizes_px(self, _windows: Windows, first: NDArray[np.intp], /) -> tuple[Floats, Floats]:
        """Widths and heights of the pictures of runs that begin at ``first``, (k,)."""
        width, height = (np.asarray(side, np.float64) for side in self.sizes.take(first))
        return width, height

    def resampled_px(self) -> float:
        """Number of resampled pixels: all."""
        return float(np.sum(self.width_px * self.height_px))

    def kernel(self, mission: Mission) -> str:
        """Resampling of the pictures."""
        return mission.accuracy.resampling

    def has_masks(self, plan: FramedPlan) -> bool:
        """Whether pictures may have pixels without ground, or with ground outside the map of the source."""
        corners = plan.corners
        if plan.relief.has_holes:
            return True
        if not plan.grid.plane.wraps:
            return not corners.hit.all()
        beyond = np.abs(corners.lat_deg) > MAX_LAT_DEG
        return bool(not corners.hit.all() or beyond.any() or plan.views.poles.any())

    def centres(self, plan: FramedPlan) -> tuple[Floats, Floats]:
        """Latitude and longitude (wrapped) where the cameras' axes meet the ground, degrees, (n,) each.

        See `image_centres` for axes that miss the ground.
        """
        return plan.views.centres()

    def named_zooms(self, plan: FramedPlan) -> Numbers:
        """Zooms in the names of the pictures, (n,): the requested zoom, or the zoom of the camera's pixels on the map.

        These zooms do not depend on the source, so a pose has the same name in all imageries.
        """
        pixels = plan.mission.pixels
        if pixels.zoom is not None:
            return np.broadcast_to(np.int64(plan.zoom), self.width_px.shape)
        pixel_m = plan.mission.camera.gsd_m_per_px(1.0, pixels.image_px) * plan.meant.agl_m
        coarsest_m = PixelGrid().ground_m_per_px(plan.meant.lat_deg, plan.meant.lon_deg, 0)
        zooms: Numbers = np.maximum(np.rint(np.log2(coarsest_m / pixel_m)), 0.0).astype(np.int64)
        return zooms

    def finest_zoom(self, plan: FramedPlan) -> int:
        """Highest zoom of sampled pixels."""
        return sampled_zooms(plan.mission, plan.grid)[1]

    def gsd_m_per_px(self, mission: Mission, poses: Poses, _grid: PixelGrid, _zoom: int, /) -> float:
        """Median ground sample distance of the pictures straight down."""
        return camera_gsd_m_per_px(mission, poses, self)

    def tile_count(self, plan: FramedPlan) -> int:
        """Number of different tiles of all zooms in the pictures and their twins: see `CameraViews.tile_keys`."""
        keys = plan.views.tile_keys(plan.passes)
        if plan.mission.varied.keep_undistorted:
            keys = np.union1d(keys, plan.undistorted.views.tile_keys(plan.passes))
        return len(keys)

    def rectangles(self, plan: FramedPlan, part: Pass, at: slice) -> Rectangles:
        """Rectangles of ground inside the pictures of a pass, in the plane of its rows."""
        poses, cameras = plan.poses, plan.cameras[at]
        moved = plan.nominal is not None or plan.flown is not None or cameras.vary
        if plan.flown is not None:
            # From this height, cameras see as much level ground as they at least see of the relief.
            poses = poses._replace(agl_m=plan.flown.seen_agl_m)
        poses, row = poses.take(at), plan.row[at]

        def shown(camera: Camera, which: Which) -> Rectangles:
            one = plan.mission, camera, part, poses.take(which), row[which]
            return rotated_rectangles(*one, plan.ground, moved=moved)

        return Rectangles(*cameras.together(shown))


#: Frames of a plan, of one kind.
Frames = Union[MapFrames, CameraFrames]


def camera_gsd_m_per_px(mission: Mission, poses: Poses, frames: Frames) -> float:
    """Median ground sample distance of the exact camera with the pixels of its picture."""
    width_m, _ = mission.camera.ground_size_m(1.0)
    return float(np.median(width_m * poses.agl_m / frames.width_px))


def highest_zoom(mission: Mission, grid: PixelGrid) -> int:
    """Highest zoom of a mission: the zoom of the native pixels, unless upsampling is allowed."""
    return grid.max_zoom if mission.pixels.upsample else grid.native_zoom


def sampled_zooms(mission: Mission, grid: PixelGrid) -> tuple[int, int]:
    """Lowest and highest zoom of pixels sampled by camera frames."""
    highest = highest_zoom(mission, grid) if mission.pixels.zoom is None else mission.pixels.zoom
    return grid.min_zoom, max(highest, grid.min_zoom)
