"""Frames of the captures of a mission: their zoom, windows and sizes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import ClassVar, NamedTuple, Protocol

import numpy as np

from ...arrays import Floats, NDArray, Numbers
from ...errors import InvalidInput, Message, OptionName
from ...geodesy.accuracy import ImageGeometry
from ...geodesy.camera import Camera, Poses
from ...geodesy.ellipsoid import WGS84, Ellipsoid, trace
from ...geodesy.frames import (
    FrameEdges,
    Sizes,
    Windows,
    frame_windows,
    map_frame_edges,
    plane_runs,
    quarter_turns,
    swapped,
)
from ...geodesy.mercator import MAX_LAT_DEG, PixelGrid, Plane, fitting_zoom, lat_to_v, wrap_lon_deg
from ...geodesy.rectangles import inscribed_edges
from ...geodesy.view import fitting_detail
from ...limits import MAX_PICTURE_PX, MAX_PICTURE_SIDE_PX
from ..areas.area import Points
from ..lenses import CaptureCameras
from ..mission import Mission
from ..parts import FIRST, TRACK
from ..relief.ground import Flown, Relief
from .entry import from_entry
from .frames import CameraFrames, Frames, MapFrames, highest_zoom
from .no_fly import remove_no_fly
from .parallels import lay_out
from .polygons import lay_out_polygons
from .rotated import Pass, is_rotated, lay_out_rotated
from .rows import (
    Layout,
    bounds_with_margin,
    lay_out_points,
    point_angles_deg,
    random_yaws_deg,
    row_yaws_deg,
    sees_below,
    turns_at_random,
)
from .skipped import remove_rows

#: Computes the flown poses of captures from their layout and nominal poses.
Disturbed = Callable[[Layout, Poses], Poses]

#: Greatest change of the side of a picture when its edges are rounded.
_ROUNDED_PX = 1.0


class Framed(NamedTuple):
    """Captures with the windows of their pictures.

    ``passes`` describe rows in a plane, and ``flown`` has the heights of captures over relief. ``parts`` are the
    indices of the first captures of several polygons. ``left_out`` counts captures removed by no-fly areas, and
    ``in_skipped_rows`` those of rows that the mission skips.
    """

    layout: Layout
    poses: Poses
    cameras: CaptureCameras
    zoom: int
    windows: Windows
    frames: Frames
    passes: tuple[Pass, ...] = ()
    flown: Flown | None = None
    parts: tuple[int, ...] = ()
    left_out: int = 0
    in_skipped_rows: int = 0


class Framing(Protocol):
    """A kind of frame."""

    @property
    def resamples(self) -> bool:
        """Whether pictures are resampled: windows are then rectangles inside the pictures."""
        ...

    def edges(self, poses: Poses, pixel: float, camera: Camera | None = None, /) -> FrameEdges:
        """Edges of the frames of poses, for pixels of a size as a world fraction; None for the mission's camera."""
        ...

    def zoom(self, layout: Layout) -> int:
        """Zoom of a mission's pictures."""
        ...

    def frames(self, layout: Layout, windows: Windows, poses: Poses, /) -> Frames:
        """Frames of the pictures, with sizes from their layout or windows."""
        ...


def ground_ellipsoid(mission: Mission) -> Ellipsoid:
    """Level ground of a mission as an ellipsoid."""
    return WGS84.raised(mission.flight.ground_height_m) if mission.flight.ground_height_m else WGS84


def framed(
    mission: Mission,
    grid: PixelGrid,
    framing: Framing,
    disturbed: Disturbed,
    relief: Relief,
) -> Framed:
    """Lay a mission out in frames of one kind.

    Over relief, frames are computed for the highest ground that each capture sees: rows are closer where the ground is
    higher, and images overlap no less than requested.

    Raises
    ------
    InvalidInput
        As for `plan`.
    """
    choose_zoom = partial(_zoom, framing, relief)
    rows = _placing(mission, grid, framing, relief)
    placed = rows.first
    zoom = choose_zoom(placed.layout)
    if rows.needs_room:
        placed = rows.place(zoom)
        lower = choose_zoom(placed.layout)
        if lower < zoom:
            # The room for rounding may lower the zoom, whose larger pixels need more room.
            zoom = lower
            placed = rows.place(zoom)
    layout, passes, parts, in_skipped_rows = remove_rows(mission, *placed)
    layout, passes, parts, lost = remove_no_fly(mission.no_fly, layout, passes, parts)
    layout = from_entry(mission, layout, (*parts, *(one.first for one in passes)))
    flown = relief.flown(layout)
    if flown is not None:
        layout = layout._replace(agl_m=flown.seen_agl_m)
    poses = disturbed(layout, nominal_poses(mission, layout))
    cameras = CaptureCameras.drawn(mission, layout.column, layout.row)
    is_steady = not (mission.moves_poses or cameras.vary or turns_at_random(mission)) and flown is None
    share_frames = passes and framing.resamples and grid.plane.wraps and is_steady
    reference = _laid_out_first(mission, layout) if share_frames else None
    windows = _windows(framing, cameras, poses, grid, zoom, reference)
    frames = framing.frames(relief.lone(layout, flown), windows, poses)
    return Framed(layout, poses, cameras, zoom, windows, frames, passes, flown, parts, lost, in_skipped_rows)


def seen_by_cameras(mission: Mission, grid: PixelGrid, flown: Framed) -> Framed:
    """Return the same camera frames with the windows of their cameras; the camera of the mission if they share one."""
    windows = _windows(CameraFraming(mission, grid), flown.cameras, flown.poses, grid, flown.zoom, None)
    return flown._replace(windows=windows)


class PlacedCaptures(NamedTuple):
    """Captures in rows: their layout, passes, and the indices of the first captures of several polygons."""

    layout: Layout
    passes: tuple[Pass, ...] = ()
    parts: tuple[int, ...] = ()


class Placing(Protocol):
    """Method of placing the captures of a mission."""

    @property
    def first(self) -> PlacedCaptures:
        """Captures without room for the rounding of frames to pixels."""
        ...

    @property
    def needs_room(self) -> bool:
        """Whether frames are rounded to pixels."""
        ...

    def place(self, zoom: int, /) -> PlacedCaptures:
        """Captures with room for the rounding of frames to the pixels of a zoom."""
        ...


@dataclass(frozen=True)
class _SinglePoints:
    """Captures at the points of a mission."""

    mission: Mission
    grid: PixelGrid

    needs_room: ClassVar[bool] = False

    @cached_property
    def first(self) -> PlacedCaptures:
        """Captures at the points; yaws of the mission are from grid north."""
        return PlacedCaptures(_grid_north_yaws(self.mission, self.grid.plane, lay_out_points(self.mission)))

    def place(self, _zoom: int, /) -> PlacedCaptures:
        """Return the same captures at every zoom."""
        return self.first


@dataclass(frozen=True)
class _RowsAlongParallels:
    """Rows along parallels, with frames for each latitude."""

    mission: Mission
    grid: PixelGrid
    framing: Framing
    relief: Relief

    needs_room: ClassVar[bool] = True

    @cached_property
    def first(self) -> PlacedCaptures:
        """Captures without room for the rounding of frames to pixels."""
        return self._placed(0.0)

    def place(self, zoom: int, /) -> PlacedCaptures:
        """Captures with room for the rounding of the outermost frames."""
        return self._placed(1.0 / self.grid.world_px(zoom))

    def _placed(self, pixel: float) -> PlacedCaptures:
        relief = self.relief
        frames = partial(self._common_frames, pixel)

        def lay_out_part(part: Mission) -> tuple[Layout, tuple[Pass, ...]]:
            return lay_out(part, frames, pixel, relief), ()

        placed = PlacedCaptures(*lay_out_polygons(self.mission, lay_out_part))
        if relief.covers(placed.layout.lat_deg, placed.layout.lon_deg):
            return placed
        # The heights around these captures have been read just now, and may move the captures.
        return PlacedCaptures(*lay_out_polygons(self.mission, lay_out_part))

    def _common_frames(self, pixel: float, lat_deg: Floats, agl_m: Floats) -> FrameEdges:
        """Edges of the common part of frames of rows flown in both directions, (n,)."""
        leans = (self.mission.attitude.tilt_deg, self.mission.attitude.roll_deg)
        poses = (
            Poses.from_attitude(lat_deg, np.zeros_like(lat_deg), agl_m, yaw, *leans)
            for yaw in row_yaws_deg(self.mission)
        )
        west, east, top, bottom = zip(*(self.framing.edges(some, pixel) for some in poses))
        return FrameEdges(np.max(west, axis=0), np.min(east, axis=0), np.max(top, axis=0), np.min(bottom, axis=0))


@dataclass(frozen=True)
class _RowsInPlane:
    """Rows in a plane around the area, or of the source's CRS."""

    mission: Mission
    grid: PixelGrid
    framing: Framing
    relief: Relief

    @property
    def needs_room(self) -> bool:
        """Whether frames are rounded to pixels, as all frames are except camera frames on the map."""
        return not (self.grid.plane.wraps and self.framing.resamples)

    @cached_property
    def first(self) -> PlacedCaptures:
        """Captures without room for the rounding of frames to pixels."""
        return self._placed()

    def place(self, zoom: int, /) -> PlacedCaptures:
        """Captures with room for the rounding of all frames, or of the outermost."""
        grid = self.grid
        if not grid.plane.wraps:
            return self._placed(room_m=_ROUNDED_PX * grid.plane.unit_m * max(grid.pixel_size(zoom)))
        # Edges of map frames are rounded, and not quite parallel to the axes of the plane.
        off_px = _ROUNDED_PX + self.mission.accuracy.error_budget_px
        layout = self.first.layout
        pixels_m = grid.ground_m_per_px(layout.lat_deg, layout.lon_deg, zoom)
        return self._placed(narrowed_m=off_px * float(np.max(pixels_m)))

    def _placed(self, **room: float) -> PlacedCaptures:
        # Rows in a plane all have the spacing that the highest ground needs.
        least = _highest_mission(self.mission, self.relief)
        lower, ground = _deepest_share(least, self.relief), ground_ellipsoid(self.mission)
        return PlacedCaptures(
            *lay_out_polygons(least, lambda part: lay_out_rotated(part, ground, self.grid.plane, lower=lower, **room))
        )


def _placing(mission: Mission, grid: PixelGrid, framing: Framing, relief: Relief) -> Placing:
    """Placing of the captures of a mission."""
    if isinstance(mission.area, Points):
        return _SinglePoints(mission, grid)
    if is_rotated(mission) or not grid.plane.wraps:
        return _RowsInPlane(mission, grid, framing, relief)
    return _RowsAlongParallels(mission, grid, framing, relief)


def _laid_out_first(mission: Mission, layout: Layout) -> int:
    """Index of the first capture as laid out, whose frame is the reference for any entry of the flight."""
    return 0 if mission.route.entry == FIRST else int(np.lexsort((layout.column, layout.row))[0])


def _windows(
    framing: Framing, cameras: CaptureCameras, poses: Poses, grid: PixelGrid, zoom: int, reference: int | None
) -> Windows:
    """Windows of captures; with the index of a ``reference`` capture, nearly equal poses share a frame."""
    pixel = 1.0 / grid.world_px(zoom)
    if reference is not None:
        edges, run = _rounded_edges(framing, poses, pixel, reference), np.arange(len(poses.lat_deg))
    elif cameras.vary:
        each = cameras.together(lambda camera, at: framing.edges(poses.take(at), pixel, camera))
        edges, run = FrameEdges(*each), np.arange(len(poses.lat_deg))
    else:
        first, run = plane_runs(grid, poses)
        edges = framing.edges(poses.take(first), pixel)
    return frame_windows(edges, run, poses.lon_deg, grid, zoom)


def _grid_north_yaws(mission: Mission, plane: Plane, layout: Layout) -> Layout:
    """Points with the mission's yaw from grid north, as in rows; yaws of a table or the track are from true north."""
    north_deg = plane.north_deg(layout.lat_deg, layout.lon_deg)
    with np.errstate(invalid="ignore"):
        beyond = ~np.isfinite(north_deg + plane.forward(layout.lat_deg, layout.lon_deg)[0])
    if beyond.any():
        at = int(np.flatnonzero(beyond)[0])
        plane.refuse_frame(float(layout.lat_deg[at]), float(layout.lon_deg[at]), float(layout.agl_m[at]))
    stated_yaws = mission.area.stated_deg("yaw")
    if stated_yaws or mission.flight.facing == TRACK or plane.wraps:
        return layout
    return layout._replace(yaw_deg=wrap_lon_deg(layout.yaw_deg - north_deg))


def _zoom(framing: Framing, relief: Relief, layout: Layout) -> int:
    """Zoom of a mission's pictures."""
    return framing.zoom(relief.zoomed(layout))


def _highest_mission(mission: Mission, relief: Relief) -> Mission:
    """Mission over level ground, at the least height above the highest relief that its captures see."""
    if relief.is_level:
        return mission
    box = bounds_with_margin(mission, mission.area)
    least = relief.least_seen_agl_m(np.linspace(box.south_deg, box.north_deg, 1000))
    return mission.replace(agl_m=float(least.min()))


def _deepest_share(least: Mission, relief: Relief) -> float:
    """Ratio of the greatest to the least height above the ground that oblique views see; 1 for other views."""
    if sees_below(least):
        return 1.0
    return max(relief.deepest_m / least.flight.agl_m, 1.0)


def _rounded_edges(framing: Framing, poses: Poses, pixel: float, reference: int) -> FrameEdges:
    """Edges of frames of rotated rows, (n,), shared by poses of nearly the same latitude and yaw.

    The frame of the ``reference`` determines the tolerance. A frame within r of the camera, turned by an angle or
    stretched by a share, still contains the frame reduced on every side by r times that angle or share.
    """

    def extents(edges: FrameEdges, lat_deg: Floats) -> tuple[Floats, Floats]:
        v = lat_to_v(lat_deg)
        across = np.maximum(np.abs(edges.west_u), np.abs(edges.east_u))
        down = np.maximum(np.abs(edges.top_v - v), np.abs(edges.bottom_v - v))
        return np.hypot(across, down), np.minimum(*edges.size) / 2.0

    one = slice(reference, reference + 1)
    (far,), (near,) = extents(framing.edges(poses.take(one), pixel), poses.lat_deg[one])
    # World fraction for frames without extent, far below a pixel.
    least = 1e-12
    # Shared frames may be smaller by a thousandth.
    turn_deg = math.degrees(2.0 * 1e-3 * max(float(near), least) / max(float(far), least))
    step_deg = turn_deg / (1.0 + math.tan(math.radians(float(np.abs(poses.lat_deg).max()))))
    lat, yaw = np.rint(poses.lat_deg / step_deg), np.rint(poses.yaw_deg / turn_deg)
    cells, cell = np.unique(lat + 1j * yaw, return_inverse=True)
    same = poses.take(np.zeros(len(cells), np.intp))
    shared = same._replace(lat_deg=cells.real * step_deg, yaw_deg=cells.imag * turn_deg)
    west, east, top, bottom = edges = framing.edges(shared, pixel)
    far, _ = extents(edges, shared.lat_deg)
    # Poses differ by half a step of latitude and of yaw; 10 % more allows for second-order terms.
    room = far * math.radians(turn_deg) * 1.1
    across, down = (np.minimum(room, size / 2.0) for size in edges.size)
    moved = lat_to_v(poses.lat_deg) - lat_to_v(shared.lat_deg)[cell]
    return FrameEdges(
        (west + across)[cell],
        (east - across)[cell],
        (top + down)[cell] + moved,
        (bottom - down)[cell] + moved,
    )


def nominal_poses(mission: Mission, layout: Layout) -> Poses:
    """Planned poses of captures."""
    area = mission.area
    if isinstance(area, Points):
        # Columns are indices of points, as some may be removed by no-fly areas.
        tilt, roll = (select_columns(point_angles_deg(mission, area, name), layout.column) for name in ("tilt", "roll"))
    else:
        tilt, roll = (
            np.broadcast_to(np.float64(angle), layout.lat_deg.shape)
            for angle in (mission.attitude.tilt_deg, mission.attitude.roll_deg)
        )
    yaw = random_yaws_deg(mission, len(layout.lat_deg)) if turns_at_random(mission) else layout.yaw_deg
    return Poses(layout.lat_deg, layout.lon_deg, layout.agl_m, yaw, tilt, roll)


def select_columns(values: Floats, column: Numbers) -> Floats:
    """Values of points, by column; a value common to all takes no memory."""
    return values[column] if any(values.strides) else np.broadcast_to(values[:1], column.shape)


def _limit_px(mission: Mission, grid: PixelGrid) -> int:
    """Greatest side of a picture that mission, source and memory allow."""
    limits = [limit * grid.scale for limit in (mission.limit_px, grid.max_size_px) if limit is not None]
    return min([MAX_PICTURE_SIDE_PX, *limits])


def _check_size(width_px: int, height_px: int, mission: Mission, grid: PixelGrid, *, coarsest: bool) -> None:
    """Refuse pictures that are too large; ``coarsest`` states that no coarser pixels exist."""
    limit, longest_px = _limit_px(mission, grid), max(width_px, height_px)
    advice = Message("fly lower")
    if not coarsest:
        coarser = Message("choose a lower zoom"), Message("choose a larger ground sample distance")
        advice = coarser[mission.pixels.gsd_m_per_px is not None]
    if longest_px <= limit:
        if width_px * height_px <= MAX_PICTURE_PX:
            return
        if not coarsest and mission.pixels.zoom is None and mission.pixels.gsd_m_per_px is None:
            advice = Message("{0}, or make them smaller ({1})", advice, OptionName("max_px"))
        raise InvalidInput(
            "images of {0:,} x {1:,} px: {2:,} px in all are allowed",
            width_px,
            height_px,
            MAX_PICTURE_PX,
            field="max_px",
            remedy=advice,
        )
    if mission.limit_px is not None and mission.limit_px * grid.scale == limit:
        advice = Message("{0}, or allow larger images ({1})", advice, OptionName("max_px"))
    raise InvalidInput(
        "images of {0:,} px: the longest side allowed here is {1:,} px",
        longest_px,
        limit,
        field="max_px",
        remedy=advice,
    )


def _nearest_zoom(mission: Mission, grid: PixelGrid, layout: Layout, px_m: Floats) -> int:
    """Zoom with the pixel size closest in ratio to ``px_m``, the pixel size of images straight below each capture."""
    world_m = (
        WGS84.normal_radius_m(layout.lat_deg) * np.cos(np.radians(layout.lat_deg)) * 2.0 * math.pi
        if grid.plane.wraps
        else float(np.median(grid.plane.ground_m(*_thinned(layout.lat_deg, layout.lon_deg))[0]))
    )
    span = float(np.median(px_m / np.maximum(world_m, 1.0)))
    return fitting_detail(span, grid, (grid.min_zoom, highest_zoom(mission, grid)))


def _thinned(*values: Floats) -> tuple[Floats, ...]:
    """Every k-th value of arrays (n,), at most 1000 values, whose median hardly differs."""
    return tuple(value[:: -(-len(value) // 1000)] for value in values)


def _checked_zoom(zoom: int, mission: Mission, grid: PixelGrid) -> int:
    if not grid.min_zoom <= zoom <= grid.max_zoom:
        raise InvalidInput("zoom {0}: the source has {1} to {2}", zoom, grid.min_zoom, grid.max_zoom, field="zoom")
    if zoom > highest_zoom(mission, grid):
        raise InvalidInput(
            "zoom {0}: the source's own pixels end at zoom {1}",
            zoom,
            grid.native_zoom,
            field="zoom",
            remedy=Message("ask for that, or allow upsampling ({0})", OptionName("upsample")),
        )
    return zoom


@dataclass(frozen=True)
class MapFraming:
    """Framing of pictures that are rectangles of the map."""

    resamples: ClassVar[bool] = False

    mission: Mission
    grid: PixelGrid

    def edges(self, poses: Poses, _pixel: float, camera: Camera | None = None, /) -> FrameEdges:
        """Edges through the midpoints of image edges."""
        return map_frame_edges(camera or self.mission.camera, poses, ground_ellipsoid(self.mission), self.grid.plane)

    def frames(self, _layout: Layout, windows: Windows, poses: Poses, /) -> MapFrames:
        """Frames of the size of their windows."""
        return MapFrames.from_windows(windows, poses, self.grid)

    def zoom(self, layout: Layout) -> int:
        """Return the requested zoom, or the closest to the camera's pixels within size and limits."""
        mission, grid = self.mission, self.grid
        if mission.pixels.zoom is not None:
            return _checked_zoom(mission.pixels.zoom, mission, grid)
        if mission.pixels.gsd_m_per_px is not None:
            return _zoom_for_gsd(mission.pixels.gsd_m_per_px, grid, layout, highest_zoom(mission, grid))
        camera_px_m = mission.camera.gsd_m_per_px(1.0, mission.pixels.image_px) * layout.agl_m
        zoom = _nearest_zoom(mission, grid, layout, camera_px_m)
        level = np.broadcast_to(np.float64(0.0), layout.lat_deg.shape)
        poses = Poses(layout.lat_deg, layout.lon_deg, layout.agl_m, layout.yaw_deg, level, level)
        first, run = plane_runs(grid, poses)
        edges = self.edges(poses.take(first), 0.0)
        if mission.output.img_size is not None:
            sizes = swapped(quarter_turns(poses.take(first), grid.plane), *edges.size)
            zoom = max(min(zoom, _zoom_for_size(mission.output.img_size, sizes, grid)), grid.min_zoom)
        return self._fitting(zoom, edges, run, layout.lon_deg)

    def _fitting(self, zoom: int, edges: FrameEdges, run: NDArray[np.intp], lon_deg: Floats) -> int:
        """Highest zoom up to ``zoom`` at which no picture is too large (the paper's eq. 8), or the lowest zoom."""
        grid, limit = self.grid, _limit_px(self.mission, self.grid)
        # Rounding of the edges adds at most one pixel to a picture.
        most = max(float(size.max()) for size in edges.size)

        def fits(zoom: int) -> bool:
            if grid.centre_decimals is None and abs(most * grid.world_px(zoom) - limit) > _ROUNDED_PX:
                return most * grid.world_px(zoom) < limit
            windows = frame_windows(edges, run, lon_deg, grid, zoom)
            return _largest_px(windows) <= limit

        while zoom > grid.min_zoom and not fits(zoom):
            zoom -= 1
        return zoom


@dataclass(frozen=True)
class CameraFraming:
    """Framing of pictures as the camera sees them, each of which counts as the north-up rectangle inside it."""

    resamples: ClassVar[bool] = True

    mission: Mission
    grid: PixelGrid

    def edges(self, poses: Poses, pixel: float, camera: Camera | None = None, /) -> FrameEdges:
        """Edges of the rectangles inside the pictures, with room for rounding."""
        return inscribed_edges(
            camera or self.mission.camera, poses, ground_ellipsoid(self.mission), pixel, self.grid.plane
        )

    def frames(self, layout: Layout, _windows: Windows, _poses: Poses, /) -> CameraFrames:
        """Frames of the sizes of `sizes`."""
        return CameraFrames(self.sizes(layout))

    def sizes(self, layout: Layout) -> Sizes:
        """Sizes of images: for the requested zoom or ground sample distance, else the camera's, within limits.

        All images of an area have one size; the size at a point does not depend on other points.
        """
        mission, grid = self.mission, self.grid
        aspect = mission.camera.aspect_ratio
        longest = float(min(mission.pixels.image_px, _limit_px(mission, grid)))
        most = longest if aspect >= 1.0 else longest * aspect
        if mission.output.img_size is not None:
            most = min(most, max(float(mission.output.img_size[0]), mission.output.img_size[1] * aspect))
        width = np.broadcast_to(np.float64(most), layout.lat_deg.shape)
        ground_m = mission.camera.ground_size_m(1.0)[0] * self._each_or_median(layout.agl_m)
        if mission.pixels.gsd_m_per_px is not None:
            finest_m = float(np.median(self._pixels_m(layout, highest_zoom(mission, grid))))
            if mission.pixels.gsd_m_per_px < finest_m * 0.995:  # people enter three digits
                raise _too_fine(mission.pixels.gsd_m_per_px, finest_m)
            width = ground_m / mission.pixels.gsd_m_per_px
        elif mission.pixels.zoom is not None:
            zoom = _checked_zoom(mission.pixels.zoom, mission, grid)
            width = ground_m / self._pixels_m(layout, zoom)
        elif not mission.pixels.upsample:
            shown = ground_m / self._pixels_m(layout, highest_zoom(mission, grid))
            width = np.minimum(width, np.maximum(shown, max(1.0, aspect)))
        sizes = Sizes.from_widths(width, aspect)
        least = float(width.min())
        if round(min(least, least / aspect)) < 1:
            raise self._under_one_pixel(least, least / aspect)
        _check_size(*sizes.largest, mission, grid, coarsest=mission.pixels.zoom == grid.min_zoom)
        return sizes

    def _pixels_m(self, layout: Layout, zoom: int) -> Floats:
        """Pixel sizes of the source at captures, in metres, (n,), see `_each_or_median`."""
        return self._each_or_median(self.grid.ground_m_per_px(layout.lat_deg, layout.lon_deg, zoom))

    def _each_or_median(self, values: Floats) -> Floats:
        """Values of captures (n,) for points; their median for an area."""
        if self.mission.area.covers_ground:
            return np.broadcast_to(np.median(values), values.shape)
        return values

    def _under_one_pixel(self, width_px: float, height_px: float) -> InvalidInput:
        mission = self.mission
        text = Message("image of {0:.3g} x {1:.3g} px: under one pixel", width_px, height_px)
        if mission.pixels.zoom is not None:
            return InvalidInput(text, field="zoom", remedy="fly higher or choose a higher zoom")
        if mission.pixels.gsd_m_per_px is not None:
            return InvalidInput(
                text, field="gsd_m_per_px", remedy="fly higher or choose a smaller ground sample distance"
            )
        if _limit_px(mission, self.grid) < mission.pixels.image_px:
            return InvalidInput(
                text,
                field="max_px",
                remedy=Message("choose a less extreme aspect ratio or larger images ({0})", OptionName("max_px")),
            )
        return InvalidInput(
            text,
            field="image_px",
            remedy=Message("choose a less extreme aspect ratio or a larger image ({0})", OptionName("image_px")),
        )

    def zoom(self, layout: Layout) -> int:
        """Return the requested zoom, or the closest to the pixels straight below the camera."""
        mission, grid = self.mission, self.grid
        if mission.pixels.zoom is not None:
            return _checked_zoom(mission.pixels.zoom, mission, grid)
        poses = Poses.level(layout.lat_deg, layout.lon_deg, layout.agl_m)
        width, height = (np.asarray(side, np.float64) for side in self.sizes(layout))
        scene = ImageGeometry(mission.camera, width, height, poses)
        return _nearest_zoom(mission, grid, layout, scene.nadir_px_m)


def _zoom_for_size(size: tuple[int, int, int], sizes: tuple[Floats, Floats], grid: PixelGrid) -> int:
    """Return the lowest zoom at which no picture (sides in world fractions) is enlarged to a size."""
    width, height = (float(np.min(side)) for side in sizes)
    times = max(size[0] / width, size[1] / height) / grid.world_px(0)
    # Rounding up is rounding down of the negative exponent.
    return -fitting_zoom(times, 256.0)


def _zoom_for_gsd(gsd_m_per_px: float, grid: PixelGrid, layout: Layout, highest: int) -> int:
    """Return the lowest zoom with pixels nowhere larger than requested.

    In another CRS than Web Mercator, pixels have their nominal size, whatever the scale of the projection.
    """
    for zoom in range(grid.min_zoom, highest + 1):
        pixel_m = grid.pixel_size(zoom)[0] * grid.plane.unit_m
        if not grid.plane.wraps and pixel_m <= gsd_m_per_px * (1.0 + 1e-9):  # files round the size
            return zoom
        if float(grid.ground_m_per_px(layout.lat_deg, layout.lon_deg, zoom).max()) <= gsd_m_per_px:
            return zoom
    finest = float(grid.ground_m_per_px(layout.lat_deg, layout.lon_deg, highest).max())
    raise _too_fine(gsd_m_per_px, finest)


def _too_fine(gsd_m_per_px: float, finest_m: float) -> InvalidInput:
    # Rounded up to three digits, so that the advice works.
    unit = 10.0 ** (math.floor(math.log10(finest_m)) - 2)
    finest_m = math.ceil(finest_m / unit) * unit
    return InvalidInput(
        "ground sample distance {0} m: the source's own pixels are {1:.3g} m here",
        gsd_m_per_px,
        finest_m,
        field="gsd_m_per_px",
        remedy=Message("ask for that or more, or allow upsampling ({0})", OptionName("upsample")),
    )


def _sees_the_map(mission: Mission, poses: Poses) -> NDArray[np.bool_]:
    """Whether images show ground of the map at any of 33 by 33 points, (n,)."""
    steps = np.linspace(-1.0, 1.0, 33)
    points = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    rays = mission.camera.rays_enu(points, *poses.attitude)
    seen = trace(poses.lat_deg[:, np.newaxis], poses.agl_m[:, np.newaxis], rays, ground_ellipsoid(mission))
    with np.errstate(invalid="ignore"):
        return np.asarray((seen.hit & (np.abs(seen.lat_deg) <= MAX_LAT_DEG)).any(axis=1))


def _largest_px(windows: Windows) -> int:
    return int(max(windows.width_px.max(), windows.height_px.max()))


def check_sizes(framed: Framed, mission: Mission, grid: PixelGrid) -> None:
    """Refuse map frames that are too large."""
    windows = framed.windows
    coarsest = framed.zoom == grid.min_zoom
    _check_size(int(windows.width_px.max()), int(windows.height_px.max()), mission, grid, coarsest=coarsest)


def check_windows(framed: Framed, mission: Mission, grid: PixelGrid) -> None:
    """Refuse map frames outside the map or under one pixel, and camera frames that do not see the map."""
    windows, poses, zoom = framed.windows, framed.poses, framed.zoom
    world = grid.world_px(zoom)
    _, top, _, bottom = windows.bounds_px
    if not grid.plane.wraps:
        outside = np.zeros(len(top), bool)
    elif not framed.frames.on_map:
        middle = (top + bottom) / 2.0
        outside = ~((middle >= 0.0) & (middle <= world))
    else:
        outside = (top < 0) | (bottom > world) | (windows.width_px > world)
    beyond = np.flatnonzero(outside)
    if not framed.frames.on_map and len(beyond):
        beyond = beyond[~_sees_the_map(mission, poses.take(beyond))]
    if len(beyond):
        place = Message(
            "image at latitude {0!r} from {1:g} m",
            float(poses.lat_deg[beyond[0]]),
            float(poses.agl_m[beyond[0]]),
        )
        if not framed.frames.on_map:
            raise InvalidInput(
                "{0}: lies beyond the map, which ends at ±{1:.4f}",
                place,
                MAX_LAT_DEG,
                remedy="fly higher or nearer to the equator, or choose imagery in a polar CRS",
            )
        raise InvalidInput(
            "{0}: reaches beyond the map, which ends at ±{1:.4f}",
            place,
            MAX_LAT_DEG,
            remedy="fly lower or nearer to the equator, or choose imagery in a polar CRS",
        )
    if not framed.frames.on_map:
        return
    small = np.minimum(windows.width_px, windows.height_px) < 1
    if small.any():
        at = int(np.flatnonzero(small)[0])
        raise InvalidInput(
            "image from {0:g} m at zoom {1}: under one pixel",
            float(poses.agl_m[at]),
            zoom,
            field="agl_m",
            remedy="fly higher or choose a higher zoom",
        )
