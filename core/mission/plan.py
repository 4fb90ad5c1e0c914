"""The plan: a mission worked out on a source's pixel grid, as arrays. No I/O."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats, Numbers
from ..errors import InvalidInput, Message
from ..geodesy.accuracy import Scene
from ..geodesy.camera import Poses
from ..geodesy.ellipsoid import WGS84, Ellipsoid
from ..geodesy.footprint import (
    Corners,
    ImagePoints,
    Outline,
    exact,
    ground_corners,
    image_centres,
    outline,
    poles_seen,
)
from ..geodesy.frames import Sizes, Windows, quarter_turns, runs_on, window_centres
from ..geodesy.mercator import MAX_LAT_DEG, PixelGrid, lat_to_v, u_to_lon, v_to_lat, wrap_lon_deg
from ..geodesy.planes import TurnedPlane
from ..geodesy.raytracing.tracing import Tracing, settled
from ..geodesy.view import View, view
from .areas.area import Points, check_area, check_polygons
from .flight.motion import Legs, fly, intervals_s, legs
from .flight.path import FlightPath, flight_path
from .layout.coverage import (
    Coverage,
    Imagery,
    Overlap,
    Rectangles,
    coverage,
    imagery_of,
    overlap,
    unique_tiles,
)
from .layout.framing import ground_of, nominal_poses, sampled_zooms
from .layout.rotated import (
    Pass,
    rectangles_within,
    rotated_coverage,
    rotated_overlap,
    rotated_rectangles,
    share_on,
)
from .layout.rows import Layout, sees_below
from .methods import COARSEST_MESH_PX, Accuracy, choose_methods
from .mission import Mission
from .parts import ELLIPSOID
from .relief.modelled import Flown, Heights, ModelledRelief, check_clearance

Kept = TypeVar("Kept")

#: Views and outlines kept of the captures looked at last: those of one row share one.
_KEPT = 16
#: Captures over relief whose outlines are worked out together.
_OUTLINED = 128
#: Share of what rays over relief may be off by that is left to the rounding of their camera's pose.
_OF_SETTLING = 2.0**-7
#: Views from which tiles are counted, at most: a plan of more distinct ones moves some of them to where the others are.
_VIEWS_COUNTED = 500
#: The same of turned rows in still air, whose views differ by the plane's convergence and by latitude alone.
_ROTATED_VIEWS_COUNTED = 60


@dataclass(frozen=True, eq=False)
class Plan:
    """A mission worked out: n captures in flight order, as arrays.

    Attributes
    ----------
    grid : PixelGrid
        Pixel grid of the source the plan is for.
    zoom : int
        Of map frames, that of all pictures; of camera frames, the one that suits the ground below.
    column, row : array (n,) of int64
        Grid indices; each pair once.
    poses : Poses
        As they are flown, (n,); longitudes are continuous across the antimeridian.
    windows : Windows
        In the global pixel grid at ``zoom``, north-up: what each map frame shows, and a rectangle inside what each
        camera frame shows.
    corners : Corners
        Ground corners that the camera sees, (n, 4).
    sizes : Sizes or None
        Of camera frames; None for map frames, which are as large as their windows.
    accuracy : Accuracy
        The methods that were chosen, and their bounds.
    nominal : Poses or None
        As they were meant to be, where wind has moved them.
    passes : tuple of Pass
        Of turned or crossed rows; empty for rows along parallels and for points.
    level_m : float
        Height of the level ground that captures are planned over, over the WGS 84 ellipsoid.
    relief : ModelledRelief or None
        The relief that they are flown over; None where the ground is level.
    flown : Flown or None
        How high they are over that.
    parts : tuple of int
        Of an area of several polygons, the index of the first capture of each in flight order; empty for one.
    left_out : int
        Captures that no-fly areas have cost.

    Everything else is worked out when first asked for, and kept.
    """

    mission: Mission
    grid: PixelGrid
    zoom: int
    column: Numbers
    row: Numbers
    poses: Poses
    windows: Windows
    corners: Corners
    sizes: Sizes | None
    accuracy: Accuracy
    nominal: Poses | None = None
    passes: tuple[Pass, ...] = ()
    level_m: float = 0.0
    relief: ModelledRelief | None = None
    flown: Flown | None = None
    parts: tuple[int, ...] = ()
    left_out: int = 0

    def __len__(self) -> int:
        return len(self.column)

    def part(self, which: Numbers) -> Plan:
        """Plan of some captures alone, by their indices (k,), whose images are those of this one.

        What images depend on is kept, also where it follows from all captures; of flight, rows and coverage it knows
        nothing. Heights are left out when it is pickled: see `ModelledRelief`.
        """
        part = replace(
            self,
            column=self.column[which],
            row=self.row[which],
            poses=self.poses.take(which),
            windows=Windows._make(values[which] for values in self.windows),
            corners=Corners._make(values[which] for values in self.corners),
            sizes=None if self.sizes is None else self.sizes.take(which),
            nominal=None if self.nominal is None else self.nominal.take(which),
            passes=(),
            flown=None if self.flown is None else Flown(*(values[which] for values in self.flown)),
            parts=(),
            left_out=0,
        )
        part.__dict__["masked"] = self.masked
        part.__dict__["frame_centres"] = tuple(angle[which] for angle in self.frame_centres)
        return part

    @cached_property
    def size_px(self) -> tuple[int, int] | None:
        """Width and height of the largest camera frame; None for map frames."""
        return None if self.sizes is None else self.sizes.largest

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
    def ground(self) -> Ellipsoid:
        """The level ground that captures are planned over."""
        return WGS84.raised(self.level_m) if self.level_m else WGS84

    @property
    def ground_m(self) -> Floats:
        """Heights of the ground below the poses over the WGS 84 ellipsoid, (n,)."""
        if self.flown is None:
            return np.broadcast_to(np.float64(self.level_m), len(self))
        return self.flown.ground_m

    @property
    def height_m(self) -> Floats:
        """Heights of the poses over the WGS 84 ellipsoid, (n,)."""
        return self.ground_m + self.agl_m

    @cached_property
    def quarter_turns(self) -> Numbers:
        """Clockwise quarter turns from the map's north of the tops of map frames, 0 to 3, (n,); 0 of camera frames.

        A map frame is its window of the source's pixels, turned by so many without resampling.
        """
        if self.size_px is not None:
            return np.broadcast_to(np.int64(0), len(self))
        return quarter_turns(self.poses, self.grid.own)

    @property
    def is_north_up(self) -> bool:
        """Whether all pictures are map frames whose tops point to the map's north."""
        return self.size_px is None and not self.quarter_turns.any()

    @cached_property
    def _sizes_px(self) -> tuple[Numbers, Numbers]:
        if self.sizes is not None:
            return self.sizes.width_px, self.sizes.height_px
        wide, high = self.windows.width_px, self.windows.height_px
        if self.is_north_up:
            return wide, high
        across = self.quarter_turns % 2 == 1
        return np.where(across, high, wide), np.where(across, wide, high)

    @property
    def width_px(self) -> Numbers:
        """Widths of the pictures, before any resizing, (n,)."""
        return self._sizes_px[0]

    @property
    def height_px(self) -> Numbers:
        """Heights of the pictures, before any resizing, (n,)."""
        return self._sizes_px[1]

    @cached_property
    def _runs(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        first, run = runs_on(self.grid, self.poses)
        return (first, run) if self.sizes is None else self.sizes.runs(first, run)

    @cached_property
    def poles(self) -> NDArray[np.int64]:
        """For each capture 1 or -1 where it sees the north or south pole, else 0; (n,)."""
        first, run = self._runs
        return poles_seen(self.mission.camera, self.poses.take(first), self.ground)[run]

    @cached_property
    def masked(self) -> bool:
        """Whether a picture may have pixels without ground, or with ground that no map of the source shows."""
        if self.size_px is None:
            return False
        if self.relief is not None and self.relief.has_holes:
            return True
        if self.grid.own is not None:
            return not self.corners.hit.all()
        beyond = np.abs(self.corners.lat_deg) > MAX_LAT_DEG
        return bool(not self.corners.hit.all() or beyond.any() or self.poles.any())

    def outline(self, index: int) -> Outline:
        """Outline of the ground that a capture sees; longitudes count from the camera's. Captures of a row share it."""
        if self.relief is not None:
            found = self._outlines_over_relief(index)
            if found is not None:
                return found

        def made(pose: Poses) -> Outline:
            yaw, tilt, roll = (float(angle[0]) for angle in pose.attitude)
            lat, agl = float(pose.lat_deg[0]), float(pose.agl_m[0])
            return outline(self.mission.camera, lat, agl, (yaw, tilt, roll), self.ground)

        return self._kept("outlines", index, made)

    def seen(self, index: int, points: ImagePoints) -> tuple[Corners, Floats]:
        """Ground that a capture sees at image points (k,), and its heights, (1, k); its longitude is wrapped."""
        pose = self.poses.take(np.array([index]))
        pose = pose._replace(lon_deg=wrap_lon_deg(pose.lon_deg))
        if self.relief is not None:
            return self.relief.seen(pose, self.height_m[index : index + 1], points)
        found = exact(self.mission.camera, pose, points, self.ground)
        return found, np.full(found.lat_deg.shape, self.level_m)

    def view(self, index: int) -> View:
        """How the picture of a camera frame is made; captures of one row share it.

        Raises
        ------
        InvalidInput
            Of a map frame, which is a window of the source as it is.
        """
        if self.relief is not None:
            return self.view_of(self.tracing(index))
        return self._level_view(index)

    def view_of(self, tracing: Tracing) -> View:
        """How the picture of a camera frame over relief is made, whose rays are traced.

        Where level ground moves no pixel by more than half of what it may, the other half is left to its view.
        """
        zooms, level_m = sampled_zooms(self.mission, self.grid), tracing.level_m
        if level_m is None:
            return tracing.view(self.grid, zooms)
        poses = tracing.scene.poses._replace(agl_m=np.array([tracing.height_m - level_m]))
        scene = replace(tracing.scene, poses=poses, ground=WGS84.raised(level_m))
        return self._view_over_level(scene, tracing.tolerance_px / 2.0)

    def tracing(self, index: int, size_px: tuple[int, int] | None = None) -> Tracing:
        """Rays of one capture over the relief, of its picture or of one of another size.

        Raises
        ------
        InvalidInput
            The ground is level.
        """
        relief, size = self.relief, size_px or self.picture_size_px(index)
        if relief is None:
            raise InvalidInput("rays over relief: the ground is level")
        scene = Scene(self.mission.camera, *size, self.poses.take(slice(index, index + 1)), self.ground)
        tolerance_px = self.accuracy.mesh_tolerance_px
        return Tracing(
            *settled(scene, float(self.height_m[index]), tolerance_px * _OF_SETTLING),
            relief.heights.surface,
            relief.lowest_m,
            tolerance_px * (1.0 - _OF_SETTLING),
        )

    def _level_view(self, index: int) -> View:
        """View over the level ground that captures are planned over."""
        if self.sizes is None:
            raise InvalidInput("view of a map frame: its image is a window of the source as it is")
        size = self.picture_size_px(index)
        tolerance = self.accuracy.mesh_tolerance_px
        if self.relief is not None:
            tolerance = COARSEST_MESH_PX

        def made(pose: Poses) -> View:
            return self._view_over_level(Scene(self.mission.camera, *size, pose, self.ground), tolerance)

        return self._kept("views", index, made)

    def picture_size_px(self, index: int) -> tuple[int, int]:
        """Width and height of a capture's picture."""
        return int(self.width_px[index]), int(self.height_px[index])

    def _view_over_level(self, scene: Scene, tolerance_px: float) -> View:
        mission = self.mission
        by_rays = tolerance_px == 0.0 or mission.accuracy.resampling == "lanczos"
        return view(scene, self.grid, sampled_zooms(mission, self.grid), tolerance_px, by_rays=by_rays)

    def _outlines_over_relief(self, index: int) -> Outline | None:
        """Outline of a capture; those of its neighbours are worked out with it, and kept."""
        relief, block = self.relief, index // _OUTLINED
        kept: dict[int, list[Outline | None]] = self.__dict__.get("_blocks_of_outlines", {})
        if relief is not None and block not in kept:
            part = slice(block * _OUTLINED, (block + 1) * _OUTLINED)
            found = relief.outlines(self.poses.take(part), self.height_m[part])
            # Replaced as a whole, as in `_kept`.
            kept = {**dict(list(kept.items())[1 - _KEPT :]), block: found}
            self.__dict__["_blocks_of_outlines"] = kept
        return kept[block][index % _OUTLINED]

    def _kept(self, what: str, index: int, make: Callable[[Poses], Kept]) -> Kept:
        """What belongs to a capture's run of poses, made when first asked for; the last few are kept."""
        first, run = self._runs
        at = int(run[index])
        kept: dict[int, Kept] = self.__dict__.get(f"_kept_{what}", {})
        found = kept.get(at)
        if found is None:
            found = make(self.poses.take(first[at : at + 1]))
            # Replaced as a whole, so that threads may share a plan: at worst one makes anew what another has made.
            last = dict(list(kept.items())[1 - _KEPT :])
            self.__dict__[f"_kept_{what}"] = {**last, at: found}
        return found

    @cached_property
    def frame_centres(self) -> tuple[Floats, Floats]:
        """Latitude and longitude (wrapped) of the ground in the middle of pictures, degrees, (n,) each.

        Of a map frame it is the centre of its window; of a camera frame where the exact camera's axis meets the ground
        or the relief, see `image_centres`.
        """
        if self.sizes is None:
            return window_centres(self.windows, self.grid, self.zoom)
        poses = self.poses._replace(lon_deg=wrap_lon_deg(self.lon_deg))
        if self.relief is None:
            lat, lon = image_centres(self.mission.camera, poses, self.ground)
        else:
            lat, lon = self.relief.image_centres(poses, self.height_m)
        return lat, wrap_lon_deg(lon)

    @cached_property
    def names(self) -> list[str]:
        """Name of each picture without its ending, as the published dataset has them.

        Those of camera frames do not depend on the source: one pose has one name in all imageries.
        """
        return [
            f"{column}_{row}_{lat_deg:.8f}_{lon_deg:.8f}_{zoom}"
            for column, row, lat_deg, lon_deg, zoom in zip(
                *(
                    values.tolist()
                    for values in (self.column, self.row, *self.frame_centres, self._named_zooms)
                )
            )
        ]

    @property
    def _named_zooms(self) -> Numbers:
        """Zooms in names, (n,): of camera frames the one asked for, or that of the camera's own pixels on the map."""
        mission = self.mission
        if self.sizes is None or mission.pixels.zoom is not None:
            return np.broadcast_to(np.int64(self.zoom), len(self))
        pixel_m = mission.camera.gsd_m_per_px(1.0, mission.pixels.image_px) * self.meant.agl_m
        coarsest_m = PixelGrid().ground_m_per_px(self.meant.lat_deg, self.meant.lon_deg, 0)
        zooms: Numbers = np.maximum(np.rint(np.log2(coarsest_m / pixel_m)), 0.0).astype(np.int64)
        return zooms

    @cached_property
    def edges(self) -> tuple[Floats, Floats, Floats, Floats]:
        """West, south, east, north of the windows in the unit of the grid's CRS (metres of EPSG:3857), (n,) each."""
        left, top, width, height = (np.asarray(part, np.float64) for part in self.windows)
        return self.grid.edges(left, top, width, height, self.zoom)

    @cached_property
    def coverage(self) -> Coverage | None:
        """What the windows show of the area outside no-fly areas; None for points.

        Of turned rows it is what the rectangles show that are turned with them. Cameras that do not see what is below
        them show the lower ground of relief elsewhere: points of it are looked for in their images.
        """
        if isinstance(self.mission.area, Points):
            return None
        if self.passes:
            found = rotated_coverage(self.mission, self.passes, self._rectangles)
        else:
            found = coverage(self.mission.area, self.windows, self.grid, self.zoom, self.mission.no_fly)
        if self.relief is None or self.flown is None or sees_below(self.mission):
            return found
        missed = self.relief.missed_share(self.poses, self.flown.height_m, self.corners)
        if not missed:
            return found
        return replace(found, complete=False, uncovered_m2=max(found.uncovered_m2, missed * found.area_m2))

    @cached_property
    def imagery(self) -> Imagery:
        """What the source has imagery of, as far as its grid says where that ends."""
        own, extent = self.grid.own, self.grid.extent
        found = imagery_of(self.mission.area, self.windows, self.grid, self.zoom)
        if own is None or extent is None or isinstance(self.mission.area, Points):
            return found
        return found._replace(share=share_on(self.mission.area, own, extent))

    @cached_property
    def overlap(self) -> Overlap:
        """What neighbouring pictures really share; all None for points."""
        if isinstance(self.mission.area, Points):
            return Overlap(None, None, None, None)
        if self.passes:
            return rotated_overlap(self.column, self.row, self.passes, self._rectangles)
        return overlap(
            self.column,
            self.row,
            self.windows,
            rows_are_level=self.mission.flight.layout == "cover",
            parts=self.parts,
        )

    @cached_property
    def _rectangles(self) -> tuple[Rectangles, ...]:
        """What the images of each pass show, in its plane."""
        if self.size_px is None:
            return tuple(self._windows_in(part, at) for part, at in self._slices())
        mission, moved = self.mission, self.nominal is not None or self.flown is not None
        return tuple(
            rotated_rectangles(mission, part, self._seeing.take(at), self.row[at], self.ground, own=moved)
            for part, at in self._slices()
        )

    @property
    def _seeing(self) -> Poses:
        """Poses from which the level ground is seen as much as captures see of the relief at least."""
        if self.flown is None:
            return self.poses
        return self.poses._replace(agl_m=self.flown.seen_agl_m)

    def _slices(self) -> list[tuple[Pass, slice]]:
        ends = [*(part.first for part in self.passes[1:]), len(self)]
        return [(part, slice(part.first, end)) for part, end in zip(self.passes, ends)]

    def _windows_in(self, part: Pass, at: slice) -> Rectangles:
        """Map frames in the plane of rows that run along their source's, or nearly so in one about the area."""
        plane = part.plane
        if not isinstance(plane, TurnedPlane):
            world = self.grid.world_px(self.zoom)
            left, top, right, bottom = (edge[at] / world for edge in self.windows.bounds_px)
            return rectangles_within(plane, u_to_lon(left), v_to_lat(bottom), u_to_lon(right), v_to_lat(top))
        west, south, east, north = (edge[at] for edge in self.edges)
        (x0, y0), (x1, y1) = plane.of_crs(west, south), plane.of_crs(east, north)
        # The plane's axes may be turned by quarter turns.
        return Rectangles(np.minimum(x0, x1), np.minimum(y0, y1), np.maximum(x0, x1), np.maximum(y0, y1))

    @cached_property
    def requests(self) -> int:
        """Parts to fetch for one map type, each once: tiles, or whole pictures by their centre."""
        if self.grid.centre_decimals is not None:
            return len(np.unique(np.stack([np.asarray(part, np.float64) for part in self.windows]), axis=1).T)
        if self.size_px is not None:
            return self._tiles_of_views()
        return unique_tiles(self.windows, self.grid, self.zoom)

    def _tiles_of_views(self) -> int:
        """Tiles of all zooms that the camera frames see, each counted once.

        Exact for rows of captures that share their view; nearly so where wind or a grid in UTM gives each capture a
        view of its own, and there are more than a few hundred.
        """
        first, _ = self._runs
        most = _ROTATED_VIEWS_COUNTED if self.passes and self.mission.wind is None else _VIEWS_COUNTED
        starts = first
        if len(first) > most:
            starts = np.arange(0, len(self), -(-len(self) // most))
            starts = np.union1d(starts, [part.first for part in self.passes]).astype(np.intp)
        # A pole is infinitely far up or down the map, and no other place lies by a distance from there.
        moved = np.zeros(len(self)), np.clip(lat_to_v(self.lat_deg), -1.0, 2.0)
        if self.grid.own is not None:
            moved = self.grid.own.forward(self.lat_deg, self.lon_deg)
        seen: NDArray[np.int64] = np.empty(0, np.int64)
        for start, end in zip(starts.tolist(), np.append(starts[1:], len(self)).tolist()):
            u, v = (place[start:end] - place[start] for place in moved)
            keys = self._level_view(start).tile_keys(self.lon_deg[start:end], u, v)
            seen = np.union1d(seen, keys)
        return len(seen)

    @cached_property
    def flight_distance_m(self) -> float:
        """Geodesic length of the way from the first capture to the last, without climbs."""
        way = self.legs if self.nominal is None else legs(self.lat_deg, self.lon_deg)
        return float(np.sum(way.distance_m))

    @cached_property
    def legs(self) -> Legs:
        """Legs as they were meant to be."""
        return legs(self.meant.lat_deg, self.meant.lon_deg)

    @property
    def meant(self) -> Poses:
        """Poses as they were meant to be, which wind has moved."""
        return self.poses if self.nominal is None else self.nominal

    @cached_property
    def times_s(self) -> Floats:
        """Seconds of each exposure after the first one, (n,): the points' own, or along the path as it was meant.

        So turns count where the mission has a route, and ways to the take-off and back between sorties.
        """
        path = self.path
        return self.exposures_s if path.is_captures else path.time_s[path.capture >= 0]

    @cached_property
    def exposures_s(self) -> Floats:
        """The same of a flight from capture to capture, without turns.

        `flight.intervals_s` says what is counted: legs at the ground speed, climbs at the airspeed, no turns.
        """
        mission = self.mission
        own = _times_s(mission, self.column)
        if own is not None:
            since: Floats = own - own[0]
            return since
        times = np.zeros(len(self))
        np.cumsum(
            intervals_s(self.legs, self.meant.agl_m, mission.flight.airspeed_m_per_s, mission.wind),
            out=times[1:],
        )
        return times

    @cached_property
    def path(self) -> FlightPath:
        """What an aircraft flies: the captures, and what the mission's route has between and around them."""
        return flight_path(self)

    @property
    def has_times(self) -> bool:
        """Whether the captures are of points that say when they are."""
        return _times_s(self.mission, self.column) is not None

    @property
    def start(self) -> str:
        """UTC of the first exposure, as ISO 8601: that of the first point with a time, or the mission's."""
        own = _times_s(self.mission, self.column)
        if own is None:
            return self.mission.flight.start
        return f"{np.datetime64(round(float(own[0]) * 1e6), 'us')}Z"

    @property
    def flight_s(self) -> float:
        """Seconds from the first exposure to the last, without turns and ways to the take-off: see `path` for these."""
        return float(self.exposures_s[-1])

    @property
    def rows(self) -> int:
        """Rows of captures."""
        return int(self.row.max()) + 1

    @property
    def columns(self) -> int:
        """Captures of the longest row."""
        return int(self.column.max()) + 1

    @cached_property
    def requested_gsd_m_per_px(self) -> float:
        """Ground sample distance that was asked for, or else that of the camera's own image straight down, median."""
        mission = self.mission
        if mission.pixels.gsd_m_per_px is not None:
            return mission.pixels.gsd_m_per_px
        meant = self.poses if self.nominal is None else self.nominal
        return mission.camera.gsd_m_per_px(float(np.median(meant.agl_m)), mission.pixels.image_px)

    @cached_property
    def delivered_gsd_m_per_px(self) -> float:
        """Ground sample distance of the files along their pictures' longer side, after any resizing; median."""
        size = self.mission.output.img_size
        if size is None:
            return self.picture_gsd_m_per_px
        wide = self.mission.camera.aspect_ratio >= 1.0
        planned, written = (self.width_px, size[0]) if wide else (self.height_px, size[1])
        return self.picture_gsd_m_per_px * float(np.median(planned)) / written

    @cached_property
    def picture_gsd_m_per_px(self) -> float:
        """Ground sample distance of the planned pictures: of the zoom's pixels, or of camera frames straight down."""
        if self.size_px is None:
            return float(np.median(self.grid.ground_m_per_px(self.lat_deg, self.lon_deg, self.zoom)))
        return self.camera_gsd_m_per_px

    @cached_property
    def source_gsd_m_per_px(self) -> float:
        """Ground sample distance of the finest pixels that the source has of its own, median over the captures."""
        return float(np.median(self.grid.ground_m_per_px(self.lat_deg, self.lon_deg, self.grid.native_zoom)))

    @cached_property
    def camera_gsd_m_per_px(self) -> float:
        """Ground sample distance of the exact camera with as many pixels as its picture, median."""
        width_m, _ = self.mission.camera.ground_size_m(1.0)
        return float(np.median(width_m * self.agl_m / self.width_px))


def plan(mission: Mission, grid: PixelGrid, heights: Heights | None = None) -> Plan:
    """Work out a mission on a source's pixel grid, by the cheapest methods that fit its error budget.

    Parameters
    ----------
    mission : Mission
    grid : PixelGrid
    heights : Heights or None
        Those of the mission's elevation (`elevation.relief.heights_of`), where it has one.

    Raises
    ------
    InvalidInput
        Where an area or a no-fly area is no polygon (`check_rings`), or the mission cannot be flown: too many captures,
        an area or pictures beyond Web Mercator, a camera that sees nothing of the Earth, a zoom the source does not
        have, pictures under one pixel; where no methods fit the error budget and the mission does not accept that.
    """
    if mission.imagery.imageries:
        raise InvalidInput(
            "imagery {0}: a mission of several imageries has a plan for each, and not one",
            " ".join(mission.imagery.imageries),
            remedy="choose one of them as the source",
            field="imageries",
        )
    check_area(mission.area)
    check_polygons(mission.no_fly, Message("no-fly areas"), "no_fly")
    levelled, relief = _over(mission, heights)
    flown, chosen = choose_methods(levelled, grid, partial(_disturbed, levelled), relief)
    layout, ground = flown.layout, ground_of(levelled)
    poses, over = flown.poses, flown.flown
    nominal = None
    if mission.wind is not None:
        nominal = nominal_poses(mission, layout)
    if over is None or relief is None:
        corners = ground_corners(mission.camera, poses, ground)
    else:
        higher = over.height_m - over.ground_m - over.seen_agl_m
        poses = poses._replace(agl_m=poses.agl_m + higher)
        over = over._replace(height_m=over.ground_m + poses.agl_m)
        if nominal is not None:
            nominal = nominal._replace(agl_m=nominal.agl_m + higher)
        corners = relief.corners(poses, over.height_m)
    return Plan(
        mission=mission,
        grid=grid,
        zoom=flown.zoom,
        column=layout.column,
        row=layout.row,
        poses=poses,
        windows=flown.windows,
        corners=corners,
        sizes=flown.sizes,
        accuracy=chosen,
        nominal=nominal,
        passes=flown.passes,
        level_m=levelled.flight.ground_height_m,
        relief=relief,
        flown=over,
        parts=flown.parts,
        left_out=flown.left_out,
    )


def _over(mission: Mission, heights: Heights | None) -> tuple[Mission, ModelledRelief | None]:
    """A mission over the level ground that is nearest to what it flies over, and the relief, if there is any."""
    if not mission.terrain.elevation:
        return mission, None
    if heights is None:
        raise InvalidInput(
            "elevation {0}: the mission is planned without its heights", ", ".join(mission.terrain.elevation)
        )
    check_clearance(mission)
    relief = ModelledRelief(mission, heights)
    level = mission.with_(ground_height_m=relief.lowest_m)
    if relief.is_level and mission.terrain.height_above != ELLIPSOID:
        return level, None
    return level, relief


def _times_s(mission: Mission, column: Numbers) -> Floats | None:
    """When points of a mission, by their columns, are captured, (n,); None where they do not say."""
    times = mission.area.times_s if isinstance(mission.area, Points) else ()
    return np.array(times, np.float64)[column] if times else None


def _disturbed(mission: Mission, layout: Layout, nominal: Poses) -> Poses:
    """Poses that are flown: moved and turned by the wind."""
    if mission.wind is None:
        return nominal
    way, airspeed = legs(layout.lat_deg, layout.lon_deg), mission.flight.airspeed_m_per_s
    own = _times_s(mission, layout.column)
    interval_s = np.diff(own) if own is not None else intervals_s(way, layout.agl_m, airspeed, mission.wind)
    off = fly(mission.wind, airspeed, interval_s, way.headings_deg(), layout.agl_m, layout.yaw_deg)
    lat, ground = nominal.lat_deg, ground_of(mission)
    north = np.degrees(off.north_m / ground.meridional_radius_m(lat))
    east = np.degrees(off.east_m / (ground.normal_radius_m(lat) * np.cos(np.radians(lat))))
    agl = nominal.agl_m + off.up_m
    if (agl <= 0.0).any():
        raise InvalidInput(
            "wind of {0:g} m/s at {1:g} m: the gusts throw the camera to the ground",
            mission.wind.speed_m_per_s,
            mission.flight.agl_m,
            field="wind",
            remedy="fly higher or in less turbulence",
        )
    return Poses(
        lat + north,
        nominal.lon_deg + east,
        agl,
        nominal.yaw_deg + off.yaw_deg,
        nominal.tilt_deg + off.tilt_deg,
        nominal.roll_deg + off.roll_deg,
    )
