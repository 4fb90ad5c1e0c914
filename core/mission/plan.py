"""The plan of a mission on a source's pixel grid, as arrays. No I/O."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Floats, Numbers
from ..errors import InvalidInput, Message
from ..geodesy.camera import Camera, Poses
from ..geodesy.ellipsoid import WGS84, Ellipsoid
from ..geodesy.footprint import Corners
from ..geodesy.frames import Windows
from ..geodesy.mercator import PixelGrid
from ..geodesy.planes import ProjectedPlane
from .areas.area import check_area, check_polygons
from .flight.direct import DirectFlight, stated_times_s
from .flight.legs import intervals_s, legs
from .flight.path import FlightPath, flight_path
from .flight.rates import Rates, flight_rates
from .flight.wind import Wind
from .layout.coverage import Coverage, ImageryShare, Overlap, Rectangles, coverage, imagery_share, overlap
from .layout.frames import Frames
from .layout.framing import Framed, ground_ellipsoid, nominal_poses, seen_by_cameras
from .layout.rotated import Pass, plane_share, rotated_coverage, rotated_overlap
from .layout.rows import Layout, sees_below, turns_at_random
from .lenses import CaptureCameras
from .methods import ChosenMethods, camera_methods, choose_methods
from .mission import Mission
from .parts import BY_TIME, IDEAL
from .relief.ground import Flown, Heights, Relief, level_ground
from .resolution import Resolution
from .views import CameraViews

if TYPE_CHECKING:
    from .flight.motion import Disturbance


@dataclass(frozen=True, eq=False)
class Plan:
    """The n captures of a mission in flight order, as arrays.

    Attributes
    ----------
    grid : PixelGrid
        Pixel grid of the source.
    zoom : int
        Zoom of all map frames; for camera frames, the zoom that suits the ground below.
    column, row : array (n,) of int64
        Grid indices; each pair is unique.
    poses : Poses
        Poses as flown, (n,); longitudes are continuous across the antimeridian.
    windows : Windows
        Windows of the north-up global pixel grid at ``zoom``, (n,): the windows that map frames show, or
        rectangles inside the ground that camera frames show.
    corners : Corners
        Ground corners that the camera sees, (n, 4).
    frames : MapFrames or CameraFrames
        Frames of the pictures, (n,).
    accuracy : ChosenMethods
        The methods that were chosen, and their bounds.
    nominal : Poses or None
        Planned poses, if wind or chance has moved them.
    passes : tuple of Pass
        Passes of rotated or crosshatched rows; empty for rows along parallels and for points.
    level_m : float
        Height of the level ground that captures are planned over, above the WGS 84 ellipsoid.
    relief : Relief
        The ground that captures are flown over.
    flown : Flown or None
        Heights of captures over the relief; None over level ground.
    parts : tuple of int
        Index of the first capture of each polygon of several; empty for one polygon.
    left_out : int
        Number of captures that no-fly areas exclude.
    in_skipped_rows : int
        Number of captures in the rows that the mission skips.
    gusting : Disturbance or None
        Rates of the pose errors that wind causes, if images depend on them.

    Everything else is computed on first access, and cached.
    """

    mission: Mission
    grid: PixelGrid
    zoom: int
    column: Numbers
    row: Numbers
    poses: Poses
    windows: Windows
    corners: Corners
    frames: Frames
    accuracy: ChosenMethods
    relief: Relief
    nominal: Poses | None = None
    passes: tuple[Pass, ...] = ()
    level_m: float = 0.0
    flown: Flown | None = None
    parts: tuple[int, ...] = ()
    left_out: int = 0
    in_skipped_rows: int = 0
    gusting: Disturbance | None = None

    def __len__(self) -> int:
        return len(self.column)

    def part(self, which: Numbers) -> Plan:
        """Plan of some captures alone, by their indices (k,).

        Images of the part equal the whole plan's, even where images depend on all captures; flight, rows and coverage
        do not. Pickling leaves out the heights, see `Relief.load`.
        """
        part = replace(
            self,
            column=self.column[which],
            row=self.row[which],
            poses=self.poses.take(which),
            windows=Windows._make(values[which] for values in self.windows),
            corners=Corners._make(values[which] for values in self.corners),
            frames=self.frames.take(which),
            nominal=None if self.nominal is None else self.nominal.take(which),
            passes=(),
            flown=None if self.flown is None else Flown(*(values[which] for values in self.flown)),
            parts=(),
            left_out=0,
            in_skipped_rows=0,
            gusting=None,
        )
        part.__dict__["masked"] = self.masked
        part.__dict__["cameras"] = self.cameras[which]
        if self.mission.takes_time:
            part.__dict__["rates"] = self.rates.take(which)
        part.__dict__["frame_centres"] = tuple(angle[which] for angle in self.frame_centres)
        if self.mission.varied.keep_undistorted:
            part.__dict__["undistorted"] = self.undistorted.part(which)
            part.undistorted.__dict__["names"] = part.names
        return part

    @cached_property
    def undistorted(self) -> Plan:
        """Plan of the same captures with a lens of the same focal length that does not distort.

        Raises
        ------
        InvalidInput
            No methods fit the error budget, or the camera does not see the map.
        """
        mission, cameras = self.mission.undistorted, self.cameras.undistorted
        levelled = mission.replace(ground_height_m=self.level_m)
        poses = self.poses if self.flown is None else self.poses._replace(agl_m=self.flown.seen_agl_m)
        layout = Layout(self.column, self.row, *poses[:4])
        flown = Framed(layout, poses, cameras, self.zoom, self.windows, self.frames)
        flown = seen_by_cameras(levelled, self.grid, flown)
        seen = replace(
            self,
            mission=mission,
            windows=flown.windows,
            corners=_corners(self.relief, cameras, self.poses, self.height_m),
            accuracy=camera_methods(levelled, self.grid, flown, self.relief),
        )
        seen.__dict__["cameras"] = cameras
        if self.mission.takes_time:
            seen.__dict__["rates"] = self.rates
        # Centres of images, after which they are named, depend on the lens.
        seen.__dict__["names"] = self.names
        return seen

    @property
    def lat_deg(self) -> Floats:
        """Latitudes of the poses, (n,)."""
        return self.poses.lat_deg

    @property
    def lon_deg(self) -> Floats:
        """Longitudes of the poses, continuous, (n,)."""
        return self.poses.lon_deg

    @property
    def agl_m(self) -> Floats:
        """Heights above ground of the poses, (n,)."""
        return self.poses.agl_m

    @property
    def meant(self) -> Poses:
        """Planned poses, before wind and chance move them."""
        return self.poses if self.nominal is None else self.nominal

    @property
    def ground(self) -> Ellipsoid:
        """The level ground that captures are planned over."""
        return WGS84.raised(self.level_m) if self.level_m else WGS84

    @property
    def ground_m(self) -> Floats:
        """Heights of the ground below the poses above the WGS 84 ellipsoid, (n,)."""
        if self.flown is None:
            return np.broadcast_to(np.float64(self.level_m), len(self))
        return self.flown.ground_m

    @property
    def height_m(self) -> Floats:
        """Heights of the poses above the WGS 84 ellipsoid, (n,)."""
        return self.ground_m + self.agl_m

    @property
    def asked_agl_m(self) -> Floats:
        """Requested heights above ground, (n,); over relief, captures may be higher."""
        if not self.mission.area.covers_ground:
            return self.meant.agl_m
        lowest: Floats = np.minimum(self.meant.agl_m, self.mission.flight.agl_m)
        return lowest

    @property
    def airspeeds_m_per_s(self) -> Floats:
        """Airspeed towards each capture, (n,); a value common to all takes no memory."""
        return np.broadcast_to(np.float64(self.mission.flight.airspeed_m_per_s), len(self))

    @property
    def joints(self) -> tuple[int, ...]:
        """Index of the first capture of each further mission, if several are flown as one; otherwise empty."""
        return ()

    @property
    def zooms(self) -> Numbers:
        """Zoom of each window, (n,)."""
        return np.broadcast_to(np.int64(self.zoom), len(self))

    @property
    def wrapped_left_px(self) -> Floats | Numbers:
        """Left edges of the windows, wrapped into the world, (n,)."""
        return self.grid.wrapped_px(self.windows.left_px, self.zoom)

    @property
    def rows(self) -> int:
        """Number of rows."""
        if self.in_skipped_rows:
            return len(np.unique(self.row))
        return int(self.row.max()) + 1

    def drawn(self, index: int) -> dict[str, float]:
        """Values that are drawn for one picture, by field, without those that its pose states."""
        varied, seed = self.mission.varied, self.mission.imagery.seed
        if not varied.vary:
            return {}
        place = int(self.column[index]), int(self.row[index])
        offsets = varied.draw_pose(seed, *place)
        stated = {name: value for name, value in offsets.items() if name not in self.poses._fields}
        return {**stated, **varied.draw_lens(seed, *place), **varied.draw(seed, self.names[index])}

    @cached_property
    def cameras(self) -> CaptureCameras:
        """Cameras of the captures."""
        return CaptureCameras.drawn(self.mission, self.column, self.row)

    def camera(self, index: int) -> Camera:
        """Camera of one picture."""
        return self.cameras.of(index)

    @cached_property
    def drawn_fields(self) -> tuple[str, ...]:
        """Fields of the values that are drawn for each picture."""
        return tuple(self.drawn(0))

    def settings(self, index: int) -> Mission:
        """The mission as the camera of one picture has it, with the values that are drawn for the picture."""
        varied = self.mission.varied
        if not (varied.of_camera or self.cameras.vary):
            return self.mission
        drawn = varied.draw(self.mission.imagery.seed, self.names[index])
        return self.mission.replace(vary=(), keep_undistorted=False, camera=self.camera(index), **drawn)

    @cached_property
    def views(self) -> CameraViews:
        """Ground that the cameras see."""
        return CameraViews(
            self.mission,
            self.cameras,
            self.grid,
            self.frames,
            self.poses,
            self.height_m,
            self.level_m,
            self.relief,
            self.accuracy.mesh_tolerance_px / (2.0 if self._has_strips else 1.0),
        )

    @property
    def _has_strips(self) -> bool:
        """Whether pictures may be made of strips of rows, with poses of their own."""
        return self.mission.takes_time and (self.mission.shutter.row_time_us > 0.0 or bool(self.mission.varied.vary))

    @property
    def strip_px(self) -> float:
        """Most motion of an image within a strip of its rows, which is off by half of it.

        Within the error budget: strips take what other methods leave of it, and half of what positions of pixels may be
        off, up to a twentieth of a pixel.
        """
        spare_px = max(self.accuracy.budget_px - self.accuracy.bound_px, 0.0) + self.accuracy.mesh_tolerance_px / 2.0
        return 2.0 * min(spare_px, 0.05)

    @cached_property
    def direct(self) -> DirectFlight:
        """The flight from capture to capture, without turns."""
        return DirectFlight(self.mission, self.column, self.meant, self.poses)

    @cached_property
    def resolution(self) -> Resolution:
        """Ground sample distances."""
        return Resolution(self.mission, self.grid, self.zoom, self.frames, self.poses, self.meant)

    @cached_property
    def masked(self) -> bool:
        """Whether pictures may have pixels without ground, or with ground that the source has no imagery of."""
        return self.frames.has_masks(self)

    @cached_property
    def frame_centres(self) -> tuple[Floats, Floats]:
        """Latitude and longitude (wrapped) of the ground in the middle of pictures, degrees, (n,) each."""
        return self.frames.centres(self)

    @cached_property
    def pixels_m(self) -> Floats:
        """Metres of ground per pixel of the zoom in the middle of pictures, (n,)."""
        return self.grid.ground_m_per_px(*self.frame_centres, self.zoom)

    @cached_property
    def names(self) -> list[str]:
        """File name of each picture without its ending, as in the published dataset."""
        columns = (self.column, self.row, *self.frame_centres, self.frames.named_zooms(self))
        return [
            f"{column}_{row}_{lat_deg:.8f}_{lon_deg:.8f}_{zoom}"
            for column, row, lat_deg, lon_deg, zoom in zip(*(values.tolist() for values in columns))
        ]

    @cached_property
    def edges(self) -> tuple[Floats, Floats, Floats, Floats]:
        """West, south, east, north of the windows in the unit of the grid's CRS (metres of EPSG:3857), (n,) each."""
        left, top, width, height = (np.asarray(part, np.float64) for part in self.windows)
        return self.grid.edges(left, top, width, height, self.zoom)

    @cached_property
    def coverage(self) -> Coverage | None:
        """Share of the area outside no-fly areas that the windows show; None for points.

        Rotated rows are measured by rectangles rotated with them. Cameras that do not see the ground below them show
        low ground of relief elsewhere than level ground, so sample points of the relief are searched for in the images.
        """
        if not self.mission.area.covers_ground:
            return None
        if self.passes:
            found = rotated_coverage(self.mission, self.passes, self._rectangles)
        else:
            found = coverage(self.mission.area, self.windows, self.grid, self.zoom, self.mission.no_fly)
        if sees_below(self.mission) and not self.cameras.vary:
            return found
        missed = self.relief.missed_share(self.cameras, self.poses, self.height_m, self.corners)
        if not missed:
            return found
        return replace(found, complete=False, uncovered_m2=max(found.uncovered_m2, missed * found.area_m2))

    @cached_property
    def imagery(self) -> ImageryShare:
        """Share of the area on the source's imagery, and counts of pictures outside, if the grid states an extent."""
        plane, extent = self.grid.plane, self.grid.extent
        found = imagery_share(self.mission.area, self.windows, self.grid, self.zoom)
        if not isinstance(plane, ProjectedPlane) or extent is None or not self.mission.area.covers_ground:
            return found
        return found._replace(share=plane_share(self.mission.area, plane, extent))

    @cached_property
    def overlap(self) -> Overlap:
        """Overlap of neighbouring pictures; all None for points."""
        if not self.mission.area.covers_ground:
            return Overlap(None, None, None, None)
        if self.passes:
            return rotated_overlap(self.column, self.row, self.passes, self._rectangles)
        is_cover = self.mission.flight.layout == "cover"
        return overlap(self.column, self.row, self.windows, rows_are_level=is_cover, parts=self.parts)

    @cached_property
    def _rectangles(self) -> tuple[Rectangles, ...]:
        """Ground that the images of each pass show, in the plane of the pass."""
        ends = [*(part.first for part in self.passes[1:]), len(self)]
        return tuple(self.frames.rectangles(self, part, slice(part.first, end)) for part, end in zip(self.passes, ends))

    @cached_property
    def requests(self) -> int:
        """Number of distinct tiles, or whole pictures by their centre, to fetch for one map type."""
        if self.grid.centre_decimals is not None:
            return len(np.unique(np.stack([np.asarray(part, np.float64) for part in self.windows]), axis=1).T)
        return self.frames.tile_count(self)

    @cached_property
    def path(self) -> FlightPath:
        """Path of the aircraft through the captures, with the turns and ways of the mission's route."""
        return flight_path(self)

    @cached_property
    def rates(self) -> Rates:
        """Velocities and turn rates of the cameras at the captures, (n,)."""
        return flight_rates(self)

    @cached_property
    def times_s(self) -> Floats:
        """Seconds of each exposure after the first one, (n,): stated by points, or along the planned path.

        The path includes turns and, between sorties, the ways to the take-off and back.
        """
        path = self.path
        return self.direct.exposures_s if path.is_captures else path.time_s[path.capture >= 0]


def plan(mission: Mission, grid: PixelGrid, heights: Heights | None = None) -> Plan:
    """Plan a mission on a source's pixel grid, by the cheapest methods that fit its error budget.

    Parameters
    ----------
    mission : Mission
    grid : PixelGrid
    heights : Heights or None
        Heights of the mission's elevation (`picture.heights.mission_heights`), if it has one.

    Raises
    ------
    InvalidInput
        A polygon of the area or of a no-fly area is invalid (`check_rings`). The mission cannot be flown: too many
        captures, an area or pictures beyond Web Mercator, a camera that sees nothing of the Earth, a zoom that the
        source does not have, pictures under one pixel, an exposure longer than the time between two
        images. No methods fit the error budget, and the mission does not accept to exceed it.
    """
    if mission.imagery.imageries:
        raise InvalidInput(
            "imagery {0}: a mission of several imageries needs a plan for each of them",
            " ".join(mission.imagery.imageries),
            remedy="choose one of them as the source",
            field="imageries",
        )
    attitude = mission.attitude
    if turns_at_random(mission) and (attitude.tilt_deg or attitude.roll_deg):
        raise InvalidInput(
            "random yaw with a tilt of {0:g} and a roll of {1:g} deg: must look straight down",
            attitude.tilt_deg,
            attitude.roll_deg,
            field="random_yaw",
        )
    check_area(mission.area)
    check_polygons(mission.no_fly, Message("no-fly areas"), "no_fly")
    levelled, relief = _relief_below(mission, heights)
    flown, chosen = choose_methods(levelled, grid, partial(_disturbed, levelled), relief)
    layout = flown.layout
    gusting = None
    if mission.takes_time and mission.wind is not None:
        from .flight.motion import fly_rates

        gusting = _in_wind(fly_rates, levelled, mission.wind, layout, nominal_poses(levelled, layout))
    poses, over_relief = flown.poses, flown.flown
    nominal = None
    if mission.moves_poses:
        nominal = nominal_poses(mission, layout)
    if over_relief is not None:
        raised_m = over_relief.height_m - over_relief.ground_m - over_relief.seen_agl_m
        poses = poses._replace(agl_m=poses.agl_m + raised_m)
        over_relief = over_relief._replace(height_m=over_relief.ground_m + poses.agl_m)
        if nominal is not None:
            nominal = nominal._replace(agl_m=nominal.agl_m + raised_m)
    height_m = levelled.flight.ground_height_m + poses.agl_m if over_relief is None else over_relief.height_m
    corners = _corners(relief, flown.cameras, poses, height_m)
    planned = Plan(
        mission=mission,
        grid=grid,
        zoom=flown.zoom,
        column=layout.column,
        row=layout.row,
        poses=poses,
        windows=flown.windows,
        corners=corners,
        frames=flown.frames,
        accuracy=chosen,
        nominal=nominal,
        passes=flown.passes,
        level_m=levelled.flight.ground_height_m,
        relief=relief,
        flown=over_relief,
        parts=flown.parts,
        left_out=flown.left_out,
        in_skipped_rows=flown.in_skipped_rows,
        gusting=gusting,
    )
    planned.__dict__["cameras"] = flown.cameras
    if mission.exposure.exposure != IDEAL or mission.takes_time:
        _check_exposure(planned)
    if mission.varied.keep_undistorted:
        _ = planned.undistorted
    return planned


def _corners(relief: Relief, cameras: CaptureCameras, poses: Poses, height_m: Floats) -> Corners:
    """Ground corners that the cameras see, (n, 4)."""
    return Corners(*cameras.together(lambda camera, at: relief.corners(camera, poses.take(at), height_m[at])))


def _check_exposure(plan: Plan) -> None:
    """Raise InvalidInput if the shutter may be open for longer than the time between two images.

    Captures at one place and time are no flight.
    """
    mission, is_by_time = plan.mission, plan.mission.exposure.exposure == BY_TIME
    field = "longest_exposure_ms" if is_by_time else "exposure_ms"
    stated_ms = mission.exposure.longest_exposure_ms if is_by_time else mission.route.exposure_ms
    exposure_ms = mission.varied.greatest(field, stated_ms)
    between_s = np.diff(plan.times_s)
    between_s = between_s[between_s > 0.0]
    row_time_us = mission.varied.greatest("row_time_us", mission.shutter.row_time_us) or 0.0
    read_ms = row_time_us / 1000.0 * (int(plan.frames.height_px.max()) - 1)
    open_ms = (exposure_ms or 0.0) + read_ms
    if not len(between_s) or open_ms / 1000.0 <= between_s.min():
        return
    if read_ms:
        raise InvalidInput(
            "exposure and reading of rows take {0:.4g} ms: longer than the {1:.4g} ms between two images",
            open_ms,
            1000.0 * float(between_s.min()),
            remedy="fly slower, overlap less or shorten the row time",
            field="row_time_us",
        )
    raise InvalidInput(
        "exposure time {0:g} ms: longer than the {1:.4g} ms between two images",
        exposure_ms,
        1000.0 * float(between_s.min()),
        remedy="fly slower, overlap less or shorten the exposure",
        field=field,
    )


def _relief_below(mission: Mission, heights: Heights | None) -> tuple[Mission, Relief]:
    """Relief below a mission, and the mission over level ground at the relief's lowest height."""
    if not mission.terrain.elevation:
        return mission, level_ground(mission)
    # Imported here, as level ground needs no ray tracing.
    from .relief.modelled import relief_below

    return relief_below(mission, heights)


def _disturbed(mission: Mission, layout: Layout, nominal: Poses) -> Poses:
    """Poses as flown, moved and turned by the wind and at random."""
    poses = nominal if mission.wind is None else _blown(mission, mission.wind, layout, nominal)
    if not mission.varied.of_poses:
        return poses
    from .flight.varied import vary_poses

    return vary_poses(mission, layout.column, layout.row, poses, ground_ellipsoid(mission))


def _in_wind(
    of_flight: Callable[..., Disturbance], mission: Mission, wind: Wind, layout: Layout, nominal: Poses
) -> Disturbance:
    """What `motion.fly`, or `motion.fly_rates`, returns for a flight."""
    flown_legs, airspeed = legs(layout.lat_deg, layout.lon_deg), mission.flight.airspeed_m_per_s
    stated = stated_times_s(mission, layout.column)
    interval_s = np.diff(stated) if stated is not None else intervals_s(flown_legs, layout.agl_m, airspeed, wind)
    return of_flight(wind, airspeed, interval_s, flown_legs.headings_deg(), layout.agl_m, nominal.yaw_deg)


def _blown(mission: Mission, wind: Wind, layout: Layout, nominal: Poses) -> Poses:
    """Poses moved and turned by the wind."""
    from .flight.motion import fly

    motion = _in_wind(fly, mission, wind, layout, nominal)
    lat, ground = nominal.lat_deg, ground_ellipsoid(mission)
    north = np.degrees(motion.north_m / ground.meridional_radius_m(lat))
    east = np.degrees(motion.east_m / (ground.normal_radius_m(lat) * np.cos(np.radians(lat))))
    agl = nominal.agl_m + motion.up_m
    if (agl <= 0.0).any():
        raise InvalidInput(
            "wind of {0:g} m/s at {1:g} m: the gusts throw the camera to the ground",
            wind.speed_m_per_s,
            mission.flight.agl_m,
            field="wind",
            remedy="fly higher or in less turbulence",
        )
    return Poses(
        lat + north,
        nominal.lon_deg + east,
        agl,
        nominal.yaw_deg + motion.yaw_deg,
        nominal.tilt_deg + motion.tilt_deg,
        nominal.roll_deg + motion.roll_deg,
    )
