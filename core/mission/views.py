"""Ground that the cameras of a plan see: outlines of footprints, views of camera frames, rays over relief."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from ..arrays import Floats, NDArray
from ..errors import InvalidInput
from ..geodesy.accuracy import ImageGeometry
from ..geodesy.camera import Camera, Poses
from ..geodesy.ellipsoid import WGS84, Ellipsoid
from ..geodesy.footprint import Corners, ImagePoints, Outline, outline, poles_seen
from ..geodesy.frames import plane_runs
from ..geodesy.mercator import PixelGrid, wrap_lon_deg
from ..geodesy.view import View, view
from .layout.frames import Frames, Runs, sampled_zooms
from .layout.rotated import Pass
from .layout.rows import turns_at_random
from .lenses import CaptureCameras
from .methods import COARSEST_MESH_PX
from .mission import Mission
from .relief.ground import Relief

if TYPE_CHECKING:
    from ..geodesy.raytracing.tracing import Tracing

Kept = TypeVar("Kept")

#: Greatest number of views, outlines or blocks of outlines in memory; captures of one row share a view.
_KEPT = 16
#: Captures over relief whose outlines are computed together.
_BLOCK = 128


@dataclass(frozen=True, eq=False)
class CameraViews:
    """Ground that the cameras of n captures see.

    Attributes
    ----------
    cameras : CaptureCameras
        Cameras of the captures, (n,).
    poses : Poses
        Poses as flown, (n,).
    height_m : array (n,)
        Heights of the poses above the WGS 84 ellipsoid.
    level_m : float
        Height of the level ground that captures are planned over, above the WGS 84 ellipsoid.
    relief : Relief
        The ground that captures are flown over.
    tolerance_px : float
        Allowed error of pixel positions in a picture.
    """

    mission: Mission
    cameras: CaptureCameras
    grid: PixelGrid
    frames: Frames
    poses: Poses
    height_m: Floats
    level_m: float
    relief: Relief
    tolerance_px: float

    @property
    def ground(self) -> Ellipsoid:
        """The level ground that captures are planned over."""
        return WGS84.raised(self.level_m) if self.level_m else WGS84

    @cached_property
    def _runs(self) -> Runs:
        if self.cameras.vary:
            each = np.arange(len(self.height_m))
            return each, each
        return self.frames.runs(plane_runs(self.grid, self.poses))

    @cached_property
    def poles(self) -> NDArray[np.int64]:
        """1 for each capture that sees the north pole, -1 for the south pole, else 0; (n,)."""
        first, run = self._runs
        some = self.poses.take(first)
        (found,) = self.cameras.together(lambda camera, at: (poles_seen(camera, some.take(at), self.ground),))
        return found[run]

    def centres(self) -> tuple[Floats, Floats]:
        """Latitude and longitude (wrapped) where the cameras' axes meet the ground, degrees, (n,) each.

        See `Relief.image_centres` for cameras whose axis misses the ground.
        """
        poses = self.poses._replace(lon_deg=wrap_lon_deg(self.poses.lon_deg))
        lat, lon = self.cameras.together(
            lambda camera, at: self.relief.image_centres(camera, poses.take(at), self.height_m[at])
        )
        return lat, wrap_lon_deg(lon)

    def outline(self, index: int) -> Outline:
        """Outline of the ground that a capture sees; longitudes are relative to the camera, so rows share outlines."""
        if not self.relief.is_level:
            found = self._outline_on_relief(index)
            if found is not None:
                return found

        def make(pose: Poses) -> Outline:
            yaw, tilt, roll = (float(angle[0]) for angle in pose.attitude)
            lat, agl = float(pose.lat_deg[0]), float(pose.agl_m[0])
            return outline(self.cameras.of(index), lat, agl, (yaw, tilt, roll), self.ground)

        return self._kept("outlines", index, make)

    def seen(self, index: int, points: ImagePoints) -> tuple[Corners, Floats]:
        """Ground that a capture sees at image points (k,), and the heights there, (1, k).

        Longitudes are continuous with the wrapped longitude of the capture.
        """
        pose = self.poses.take(np.array([index]))
        pose = pose._replace(lon_deg=wrap_lon_deg(pose.lon_deg))
        return self.relief.seen(self.cameras.of(index), pose, self.height_m[index : index + 1], points)

    def view(
        self,
        index: int,
        *,
        rows: tuple[int, int] | None = None,
        pose: Poses | None = None,
        camera: Camera | None = None,
    ) -> View:
        """View that makes the picture of a camera frame; captures of one row share it.

        Parameters
        ----------
        rows, pose, camera
            As in `tracing`.

        Raises
        ------
        InvalidInput
            A map frame, which has no view.
        """
        if not self.relief.is_level:
            return self.traced_view(self.tracing(index, rows=rows, pose=pose, camera=camera))
        if rows is None and pose is None and camera is None:
            return self._level_view(index)
        self._check_camera_frame()
        flown = self.poses.take(slice(index, index + 1)) if pose is None else pose
        scene = ImageGeometry(camera or self.cameras.of(index), *self.size_px(index), flown, self.ground)
        return self._view_of_level(scene, self.tolerance_px, rows)

    def traced_view(self, tracing: Tracing) -> View:
        """View that makes the picture of a camera frame over relief from traced rays.

        Where level ground displaces no pixel by more than half the tolerance, this is a level view with the other half.
        """
        zooms, level_m = sampled_zooms(self.mission, self.grid), tracing.level_m
        if level_m is None:
            return tracing.view(self.grid, zooms, by_area=self.mission.optics.by_area)
        poses = tracing.scene.poses._replace(agl_m=np.array([tracing.height_m - level_m]))
        scene = replace(tracing.scene, poses=poses, ground=WGS84.raised(level_m))
        return self._view_of_level(scene, tracing.tolerance_px / 2.0, tracing.rows)

    def tracing(
        self,
        index: int,
        size_px: tuple[int, int] | None = None,
        *,
        rows: tuple[int, int] | None = None,
        pose: Poses | None = None,
        camera: Camera | None = None,
    ) -> Tracing:
        """Trace the rays of a capture to the relief, for its picture or one of another size.

        Parameters
        ----------
        rows : tuple of int, or None
            First row of pixels and the one after the last, for a part of the picture; None for all.
        pose : Poses, or None
            One pose to look from instead of the capture's own; its ``agl_m`` counts from the ground that the capture's
            counts from, so that it differs as the heights of the cameras do.
        camera : Camera, or None
            Camera to look with instead of the capture's own, such as that of one colour.

        Raises
        ------
        InvalidInput
            The ground is level.
        """
        from ..geodesy.raytracing.tracing import Tracing, settled

        heights, size = self.relief.heights, size_px or self.size_px(index)
        flown, height_m = self.poses.take(slice(index, index + 1)), float(self.height_m[index])
        if pose is not None:
            height_m += float(pose.agl_m[0]) - float(flown.agl_m[0])
            flown = pose
        scene = ImageGeometry(camera or self.cameras.of(index), *size, flown, self.ground)
        # Share of the tolerance for the rounding of the camera's pose.
        settling = 2.0**-7
        return Tracing(
            *settled(scene, height_m, self.tolerance_px * settling),
            heights.surface,
            self.relief.lowest_m,
            self.tolerance_px * (1.0 - settling),
            heights.faces,
            rows,
        )

    def box(self, index: int, pose: Poses | None = None) -> tuple[float, float, float, float]:
        """West, north, east and south end of the ground that a capture may show, as fractions of the world.

        Over relief, without tracing its rays; see `Tracing.box`.

        Parameters
        ----------
        pose
            As in `tracing`.
        """
        if not self.relief.is_level:
            return self.tracing(index, pose=pose).box(self.grid)
        seen = [ends for _, *ends in self.view(index, pose=pose).extents() if len(ends[0])]
        if not seen:
            return np.inf, np.inf, -np.inf, -np.inf
        west, east, north, south = zip(*seen)
        lon_deg = self.poses.lon_deg[index] if pose is None else pose.lon_deg[0]
        u = float(self.grid.meridian_u(np.asarray(lon_deg)))
        return (
            u + min(float(ends.min()) for ends in west),
            min(float(ends.min()) for ends in north),
            u + max(float(ends.max()) for ends in east),
            max(float(ends.max()) for ends in south),
        )

    def size_px(self, index: int) -> tuple[int, int]:
        """Width and height of a capture's picture."""
        return int(self.frames.width_px[index]), int(self.frames.height_px[index])

    def tile_keys(self, passes: tuple[Pass, ...]) -> NDArray[np.int64]:
        """Keys of the distinct tiles, of all zooms, that the camera frames see; see `View.tile_keys`.

        Exact where captures of a row share a view. Where wind or a grid in UTM gives each of many captures a different
        view, some views are also used for neighbouring captures.
        """
        first, _ = self._runs
        # In still air, views of rotated rows differ only by convergence and latitude, so that fewer suffice.
        most = 60 if passes and not self.mission.moves_poses and not turns_at_random(self.mission) else 500
        starts, count = first, len(self.poses.lat_deg)
        if len(first) > most:
            starts = np.arange(0, count, -(-count // most))
            starts = np.union1d(starts, [part.first for part in passes]).astype(np.intp)
        # On the map, poles lie at infinity, and offsets from there are not finite.
        u, v = self.grid.plane.forward(self.poses.lat_deg, self.poses.lon_deg)
        positions = (
            np.zeros(count) if self.grid.plane.wraps else u,
            np.clip(v, -1.0, 2.0) if self.grid.plane.wraps else v,
        )
        seen: NDArray[np.int64] = np.empty(0, np.int64)
        added: list[NDArray[np.int64]] = []
        for start, end in zip(starts.tolist(), np.append(starts[1:], count).tolist()):
            u, v = (values[start:end] - values[start] for values in positions)
            added.append(self._level_view(start).tile_keys(self.poses.lon_deg[start:end], u, v))
            # Sorting as many new keys as there are bounds both time and memory.
            if end == count or sum(map(len, added)) > len(seen):
                seen = np.unique(np.concatenate([seen, *added]))
                added = []
        return seen

    def _level_view(self, index: int) -> View:
        """View over the level ground that captures are planned over, cached."""
        self._check_camera_frame()
        size = self.size_px(index)
        tolerance = self.tolerance_px if self.relief.is_level else COARSEST_MESH_PX

        def make(pose: Poses) -> View:
            return self._view_of_level(ImageGeometry(self.cameras.of(index), *size, pose, self.ground), tolerance)

        return self._kept("views", index, make)

    def _check_camera_frame(self) -> None:
        if self.frames.on_map:
            raise InvalidInput("view of a map frame: its image is a window of the source as it is")

    def _view_of_level(self, scene: ImageGeometry, tolerance_px: float, rows: tuple[int, int] | None = None) -> View:
        mission = self.mission
        by_rays = tolerance_px == 0.0 or mission.accuracy.resampling == "lanczos"
        zooms = sampled_zooms(mission, self.grid)
        by_area = mission.optics.by_area
        return view(scene, self.grid, zooms, tolerance_px, by_rays=by_rays, rows=rows, by_area=by_area)

    def _outline_on_relief(self, index: int) -> Outline | None:
        """Outline of a capture over relief, computed and kept together with its neighbours' outlines."""
        block = index // _BLOCK
        kept: dict[int, list[Outline | None]] = self.__dict__.get("_blocks_of_outlines", {})
        if block not in kept:
            part = slice(block * _BLOCK, (block + 1) * _BLOCK)
            found = self._outlines_on_relief(part)
            # Replaced as a whole, see `_kept`.
            kept = {**dict(list(kept.items())[1 - _KEPT :]), block: found}
            self.__dict__["_blocks_of_outlines"] = kept
        return kept[block][index % _BLOCK]

    def _outlines_on_relief(self, part: slice) -> list[Outline | None]:
        found: dict[int, Outline | None] = {}
        poses, height_m = self.poses.take(part), self.height_m[part]
        for camera, which in self.cameras[part].groups():
            outlines = self.relief.outlines(camera, poses.take(which), height_m[which])
            found.update(zip(np.arange(len(height_m))[which].tolist(), outlines))
        return [found[at] for at in range(len(height_m))]

    def _kept(self, what: str, index: int, make: Callable[[Poses], Kept]) -> Kept:
        """Value for the run of poses that a capture belongs to; the last few are kept."""
        first, run = self._runs
        at = int(run[index])
        kept: dict[int, Kept] = self.__dict__.get(f"_kept_{what}", {})
        found = kept.get(at)
        if found is None:
            found = make(self.poses.take(first[at : at + 1]))
            # Replaced as a whole, so that threads may share a plan; at worst, two make the same value.
            last = dict(list(kept.items())[1 - _KEPT :])
            self.__dict__[f"_kept_{what}"] = {**last, at: found}
        return found
