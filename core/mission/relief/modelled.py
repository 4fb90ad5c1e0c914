"""A flight over relief: heights of captures, their clearance, and the ground that they are certain to see."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...arrays import Floats, NDArray, Numbers
from ...errors import InvalidInput, Message, OptionName
from ...geodesy.camera import CORNERS, Camera, Poses
from ...geodesy.ellipsoid import WGS84, sight_lines, sin_cos
from ...geodesy.footprint import Corners, ImagePoints, Outline, exact, image_centres
from ...geodesy.mercator import wrap_lon_deg
from ...geodesy.raytracing.surface import Surface
from ..areas.area import ANGLES, Area, Points, area_contains, pairs_in_batches
from ..flight.legs import legs
from ..layout.rows import Layout, point_angles_deg, sees_below
from ..lenses import CaptureCameras
from ..mission import Mission
from ..parts import ELLIPSOID, GROUND, REFUSE, TAKEOFF
from .ground import Flown, Heights, Relief, ReliefFigures, level_ground, refuse_hole
from .path_ground import BATCH, ReliefPathGround, TiledPathGround, cell_size_m, highest_around, lowest_around
from .roofed import planned_surface

if TYPE_CHECKING:
    from ...geodesy.raytracing.tracing import ElevationModel

#: Tangent of the angle off the vertical up to which the relief is searched for ground that an image may see.
_MAX_TANGENT = 4.0
#: Least height of a capture above the ground that it sees, as a share of its height above ground.
_MIN_SEEN_SHARE = 0.02
#: Points of the area that are searched for in images.
_SAMPLES = 2048
#: Relief up to this height counts as level: the last digit of heights.
_LEVEL_M = 1e-4
#: Rays followed at a time, which bounds memory.
_RAYS = 1 << 16


class ModelledRelief:
    """Relief that captures fly over and see, a `Relief`, as finely resolved as the size of the area allows.

    Parameters
    ----------
    mission : Mission
    heights : Heights

    Raises
    ------
    InvalidInput
        No height at the take-off, none in the whole area, or a hole where holes are refused.
    """

    is_level = False

    def __init__(self, mission: Mission, heights: Heights) -> None:
        self.mission, self.heights = mission, heights
        self._reach = _reach(mission)
        lat, lon = _area_positions(mission)
        #: Positions of the area, and positions that enclose the captures.
        self._positions = self._enclosing = lat, lon
        if mission.flight.margin_m and mission.area.covers_ground:
            lat, lon = self._enclosing = _widened(lat, lon, mission.flight.margin_m)
        first = heights.ground.surface(*_widened(lat, lon, mission.flight.agl_m * self._reach))
        if not np.isfinite(first.heights_m).any():
            refuse_hole(float(lat[0]), float(lon[0]))
        self._ground = first
        # Cameras at a constant height are higher above the valleys, and see more of them.
        wanted, below = self.wanted_m(lat, lon)
        if np.isnan(below).all():
            refuse_hole(float(lat[0]), float(lon[0]))
        above_m = max(float(np.nanmax(wanted)) - float(np.nanmin(first.heights_m)), 1.0)
        self.radius_m = above_m * self._reach
        self._surface = first
        self._read(lat, lon)
        if mission.terrain.holes == REFUSE:
            for surface in (self._ground, self._surface):
                self._check_whole(surface)

    def __getstate__(self) -> dict[str, Any]:
        """Return what images depend on, without the heights, which are large: see `load`."""
        kept = ("mission", "radius_m", "lowest_m", "highest_m", "has_holes")
        without = replace(self._surface, heights_m=np.empty((0, 0), np.float32), holes=None, interpolated=None)
        return {**{name: getattr(self, name) for name in kept}, "_surface": without}

    @property
    def is_loaded(self) -> bool:
        """Whether the heights are in memory; pickling leaves them out."""
        return bool(self._surface.heights_m.size)

    @property
    def heights_m(self) -> NDArray[Any]:
        """Heights of the surface that captures see, (rows, columns)."""
        return self._surface.heights_m

    def load(self, heights: Heights, heights_m: NDArray[Any]) -> None:
        """Restore the elevation models, and the heights in memory, after unpickling."""
        self.heights = heights
        self._surface = replace(self._surface, heights_m=heights_m)

    @property
    def _planned(self) -> ElevationModel:
        """The surface that the flight keeps clear of."""
        return planned_surface(self.heights)

    def _read(self, lat_deg: Floats, lon_deg: Floats) -> None:
        """Read the relief around positions (n,), as far as images from there may see."""
        around = _widened(lat_deg, lon_deg, self.radius_m + self.mission.terrain.clearance_distance_m)
        self._ground = self._surface = self.heights.ground.surface(*around)
        if self._planned is not self.heights.ground:
            self._surface = self._planned.surface(*around)
        self.lowest_m, self.highest_m = (float(f(self._surface.heights_m)) for f in (np.nanmin, np.nanmax))
        # Cached properties of the relief that was read before.
        for name in ("merge_distance_m", "_low", "_merged_low", "_tops", "_merged_tops", "_seen_by_latitude", "_whole"):
            self.__dict__.pop(name, None)

    def covers(self, lat_deg: Floats, lon_deg: Floats) -> bool:
        """Whether the relief around captures (n,) had been read; if not, as for oblique images, read it now."""
        if _contains(self._ground, lat_deg, lon_deg):
            return True
        lat, lon = (np.concatenate(at) for at in zip(self._positions, (lat_deg, lon_deg)))
        self._enclosing = np.array([lat.min(), lat.max()]), np.array([lon.min(), lon.max()])
        self._read(*self._enclosing)
        return False

    def around(self, lat_deg: Floats, lon_deg: Floats, room_m: float) -> ReliefPathGround:
        """Relief within ``room_m`` around positions (n,), at the finest resolution."""
        around = _widened(lat_deg, lon_deg, room_m + self.mission.terrain.clearance_distance_m)
        # Unpickled relief has no ground.
        has_ground = hasattr(self, "_ground")
        if has_ground and all(_is_finest(surface, *around) for surface in (self._ground, self._surface)):
            return self._whole
        lat, lon = around
        high_m = math.radians(float(np.ptp(lat))) * WGS84.b_m
        wide_m = math.radians(float(np.ptp(lon))) * WGS84.a_m * math.cos(math.radians(float(np.abs(lat).min())))
        if high_m * wide_m > 4.0 * self._tiled.side_m**2:
            return self._tiled
        return self._read_around(lat_deg, lon_deg, room_m)

    def _read_around(self, lat_deg: Floats, lon_deg: Floats, room_m: float) -> ReliefPathGround:
        distance_m = self.mission.terrain.clearance_distance_m
        around = _widened(lat_deg, lon_deg, room_m + distance_m)
        ground = surface = self.heights.ground.surface(*around)
        if self._planned is not self.heights.ground:
            surface = self._planned.surface(*around)
        return ReliefPathGround(ground, surface, distance_m)

    @cached_property
    def _tiled(self) -> TiledPathGround:
        """Relief at the finest resolution for areas of any size."""
        lat, lon = _area_positions(self.mission)
        around = _widened(lat[:1], lon[:1], 4.0)
        finest = (one.surface(*around) for one in (self.heights.ground, self._planned))
        return TiledPathGround(self._read_around, min(map(cell_size_m, finest)))

    @cached_property
    def _whole(self) -> ReliefPathGround:
        """All relief in memory."""
        return ReliefPathGround(self._ground, self._surface, self.mission.terrain.clearance_distance_m)

    @property
    def is_flat(self) -> bool:
        """Whether the ground is level in all images and below all transits and detours."""
        if self._ground.heights_m.size == 0 or self.highest_m - self.lowest_m > _LEVEL_M:
            return False
        around = self._path_extent()
        if around is None:
            return True
        for heights in {id(one): one for one in (self.heights.ground, self._planned)}.values():
            surface = heights.surface(*around)
            highest, lowest = (float(f(surface.heights_m)) for f in (np.nanmax, np.nanmin))
            if max(highest, self.highest_m) - min(lowest, self.lowest_m) > _LEVEL_M:
                return False
            if not _is_finest(surface, *around):
                # Something narrow may stand between the coarse cells.
                return False
        return True

    def _path_extent(self) -> tuple[Floats, Floats] | None:
        """Positions around all ground that a path may cross; None for a path that has only captures."""
        route = self.mission.route
        (lat, lon), middle = self._enclosing, float(self._enclosing[1].min() + self._enclosing[1].max()) / 2.0
        extension_m = route.turnaround_m + route.lead_in_m
        if route.takeoff is not None:
            lat, lon = (
                np.append(lat, route.takeoff[0]),
                np.append(lon, middle + wrap_lon_deg(np.asarray(route.takeoff[1] - middle))),
            )
        elif not (extension_m or self.mission.no_fly):
            return None
        south, north, west, east = (float(f(at)) for at in (lat, lon) for f in (np.min, np.max))
        for polygon in self.mission.no_fly:
            box = polygon.bounds
            box_west = middle + float(wrap_lon_deg(np.asarray(box.west_deg - middle)))
            box_east = box_west + box.span_deg
            if box.south_deg < north and box.north_deg > south and box_west < east and box_east > west:
                # The detour leads along the edges of the box.
                lat = np.append(lat, (box.south_deg, box.north_deg))
                lon = np.append(lon, (box_west, box_east))
        room_m = self.radius_m + extension_m + self.mission.terrain.clearance_distance_m
        return _widened(np.array([lat.min(), lat.max()]), np.array([lon.min(), lon.max()]), room_m)

    @cached_property
    def filled(self) -> tuple[int, int, int]:
        """Numbers of heights around the area: filled by further sources, interpolated, and all."""
        filled = interpolated = count = 0
        for surface in {id(one): one for one in (self._ground, self._surface)}.values():
            pixels = self._area_pixels(surface)
            heights = surface.heights_m[pixels]
            count += heights.size
            invented = 0 if surface.interpolated is None else int(np.count_nonzero(surface.interpolated[pixels]))
            interpolated += invented
            if surface.holes is not None:
                filled += int(np.count_nonzero(surface.holes[pixels] & ~np.isnan(heights))) - invented
        return filled, interpolated, count

    def _area_pixels(self, surface: Surface) -> tuple[slice, slice]:
        """Rows and columns of the pixels of a surface around the area."""
        rows, columns = surface.heights_m.shape
        column, row = surface.position(*self._positions)
        return _pixel_range(row, rows), _pixel_range(column, columns)

    def _check_whole(self, surface: Surface) -> None:
        """Refuse an area in which the first source of heights has holes."""
        if surface.holes is None:
            return
        high, wide = self._area_pixels(surface)
        row, column = np.nonzero(surface.holes[high, wide])
        row, column = (row + high.start).astype(np.float64), (column + wide.start).astype(np.float64)
        area, (lat, lon) = self.mission.area, surface.places(column, row)
        west, east = float(self._positions[1].min()), float(self._positions[1].max())
        lon = lon - 360.0 * np.rint((lon - (west + east) / 2.0) / 360.0)
        if area.covers_ground:
            inside = area_contains(area, lat, lon)
        else:
            point_column, point_row = surface.position(*self._positions)
            # The height below a point is interpolated between the four pixels around it.
            inside = np.zeros(len(row), bool)
            for x, y in zip(point_column.tolist(), point_row.tolist()):
                inside |= (np.abs(column - x) < 1.0) & (np.abs(row - y) < 1.0)
        found = np.flatnonzero(inside)
        if len(found):
            raise InvalidInput(
                "hole in the heights at latitude {0:.6f}, longitude {1:.6f}: the first source has none there",
                float(lat[found[0]]),
                float(wrap_lon_deg(lon[found[0]])),
                field="holes",
                remedy=Message("take a further source that fills it ({0})", OptionName("holes")),
            )

    @property
    def attribution(self) -> str:
        """Credit for the heights, and for buildings."""
        all_of_them = (self._planned.attribution, self.heights.ground.attribution, self.heights.faces.attribution)
        return "; ".join(dict.fromkeys(filter(None, all_of_them)))

    @cached_property
    def has_holes(self) -> bool:
        """Whether heights are missing near the mission, or images may see beyond it."""
        return self._reach >= _MAX_TANGENT or bool(np.isnan(self._surface.heights_m).any())

    def seen(self, camera: Camera, poses: Poses, height_m: Floats, points: ImagePoints) -> tuple[Corners, Floats]:
        """Ground that captures of a camera see at image points (k,), and its heights, (n, k) each.

        Rays that miss the relief in memory meet level ground at its lowest height.
        """
        each = max(_RAYS // len(points), 1)
        batches = [slice(first, first + each) for first in range(0, len(height_m), each)]
        found = [self._seen(camera, poses.take(some), height_m[some], points) for some in batches]
        corners, heights = zip(*found)
        return Corners(*map(np.concatenate, zip(*corners))), np.concatenate(heights)

    def _seen(self, camera: Camera, poses: Poses, height_m: Floats, points: ImagePoints) -> tuple[Corners, Floats]:
        # A camera must be above the ground, if only by a millimetre.
        level = poses._replace(agl_m=np.maximum(height_m - self.lowest_m, 1e-3))
        found = exact(camera, level, points, WGS84.raised(self.lowest_m))
        rays = camera.rays_enu(points, *poses.attitude)
        lat, lon, height = (np.repeat(values, len(points)) for values in (poses.lat_deg, poses.lon_deg, height_m))
        shape = found.lat_deg.shape
        *met, hits = self._surface.first_points(lat, lon, height, rays.reshape(-1, 3), self.lowest_m)
        seen_lat, dlon, heights = (values.reshape(shape) for values in met)
        hit = hits.reshape(shape)
        corners = Corners(
            np.where(hit, seen_lat, found.lat_deg),
            np.where(hit, poses.lon_deg[:, np.newaxis] + dlon, found.lon_deg),
            found.hit | hit,
        )
        return corners, np.where(hit, heights, self.lowest_m)

    def corners(self, camera: Camera, poses: Poses, height_m: Floats) -> Corners:
        """Ground corners that captures see, (n, 4)."""
        return self.seen(camera, poses, height_m, CORNERS)[0]

    def image_centres(self, camera: Camera, poses: Poses, height_m: Floats) -> tuple[Floats, Floats]:
        """Latitudes and longitudes of the ground in the middle of images, (n,) each; see `footprint.image_centres`."""
        seen, _ = self.seen(camera, poses, height_m, ((0.0, 0.0),))
        lat, lon = seen.lat_deg[:, 0], seen.lon_deg[:, 0]
        beyond = np.flatnonzero(~seen.hit[:, 0])
        if len(beyond):
            level = poses.take(beyond)._replace(agl_m=height_m[beyond] - self.lowest_m)
            lat[beyond], lon[beyond] = image_centres(camera, level, WGS84.raised(self.lowest_m))
        return lat, lon

    def outlines(self, camera: Camera, poses: Poses, height_m: Floats) -> list[Outline | None]:
        """Outlines of the ground that captures see; None for a capture whose edges partly miss the ground."""
        along = np.linspace(-1.0, 1.0, 16, endpoint=False)
        ones = np.ones_like(along)
        x, y = np.concatenate([along, ones, -along, -ones]), np.concatenate([-ones, along, ones, -along])
        seen, _ = self.seen(camera, poses, height_m, tuple(zip(x.tolist(), y.tolist())))
        level, image_xy = np.zeros(len(x), bool), np.stack([x, y], axis=1)
        return [
            Outline(lat, lon - pose_lon, level, image_xy, 0) if hit.all() else None
            for lat, lon, hit, pose_lon in zip(*seen, poses.lon_deg.tolist())
        ]

    def text(self) -> Message:
        """Description for people."""
        return Message(
            "relief of {0} from {1:.1f} to {2:.1f} m above the ellipsoid",
            self._planned.title,
            self.lowest_m,
            self.highest_m,
        )

    def _takeoff_m(self) -> float:
        lat, lon = self._positions
        at = lat[:1], lon[:1]
        if self.mission.area.covers_ground:
            at = np.array([lat.max()]), np.array([lon.min()])
        found = float(self._ground.heights(*self._ground.position(*at))[0])
        if math.isnan(found):
            refuse_hole(float(at[0][0]), float(at[1][0]))
        return found

    @cached_property
    def takeoff_m(self) -> float:
        """Height of the ground at the take-off."""
        return self._takeoff_m()

    def ground_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Heights of the ground at positions (n,); raises InvalidInput where unknown."""
        found = self._ground.heights(*self._ground.position(lat_deg, lon_deg))
        missing = np.flatnonzero(np.isnan(found))
        if len(missing):
            refuse_hole(float(lat_deg[missing[0]]), float(lon_deg[missing[0]]))
        return found

    def wanted_m(self, lat_deg: Floats, lon_deg: Floats, agl_m: Floats | None = None) -> tuple[Floats, Floats]:
        """Requested heights of captures above the ellipsoid, and heights of the ground below, (n,) each."""
        agl = np.full(len(lat_deg), self.mission.flight.agl_m) if agl_m is None else agl_m
        above = self.mission.terrain.height_above
        if above == GROUND:
            ground = self._ground.heights(*self._ground.position(lat_deg, lon_deg))
            return ground + agl, ground
        base = self.takeoff_m if above == TAKEOFF else 0.0
        return base + agl, self._ground.heights(*self._ground.position(lat_deg, lon_deg))

    @cached_property
    def merge_distance_m(self) -> float:
        """Distance below which rows treat positions as one: a cell, or a small share of an image."""
        # Captures closer than a sixteenth of the reach are merged.
        return max(cell_size_m(self._surface), cell_size_m(self._ground), self.radius_m / 16.0)

    @cached_property
    def _low(self) -> Callable[[Floats, Floats], Floats]:
        """Least height of the ground within a cell of positions (n,)."""
        return lowest_around(self._ground, 0.0)

    @cached_property
    def _merged_low(self) -> Callable[[Floats, Floats], Floats]:
        """Least height of the ground within `merge_distance_m` of positions (n,)."""
        return lowest_around(self._ground, self.merge_distance_m)

    @cached_property
    def _tops(self) -> Callable[[Floats, Floats], Floats]:
        """Greatest height that may be visible from positions (n,)."""
        return highest_around(self._surface, self.radius_m)

    @cached_property
    def _merged_tops(self) -> Callable[[Floats, Floats], Floats]:
        """Greatest height that may be visible from within `merge_distance_m` of positions (n,)."""
        return highest_around(self._surface, self.radius_m + self.merge_distance_m)

    def seen_agl_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Least height of captures near positions (n,) above the highest ground that they see; may be NaN.

        Near means within `merge_distance_m`.
        """
        if self.mission.terrain.height_above == GROUND:
            wanted = self._merged_low(lat_deg, lon_deg) + self.mission.flight.agl_m
        else:
            wanted, _ = self.wanted_m(lat_deg, lon_deg)
        return wanted - self._merged_tops(lat_deg, lon_deg)

    def least_seen_agl_m(self, lat_deg: Floats) -> Floats:
        """Least height of captures at latitudes (n,) above the highest ground that they see."""
        at_lat, least, *_ = self._seen_by_latitude
        return np.interp(lat_deg, at_lat, least)

    def most_seen_agl_m(self, lat_deg: Floats) -> Floats:
        """Greatest height of captures at latitudes (n,) above the highest ground that they see.

        For images that look very far, the least height.
        """
        at_lat, least, most, _ = self._seen_by_latitude
        return np.interp(lat_deg, at_lat, most if self._reach < _MAX_TANGENT else least)

    @cached_property
    def _seen_by_latitude(self) -> tuple[Floats, Floats, Floats, float]:
        """Latitudes, `least_seen_agl_m` and `most_seen_agl_m` there, and `deepest_m`."""
        mission, surface = self.mission, self._surface
        lat, lon = self._enclosing
        south, north = float(lat.min()), float(lat.max())
        west, east = float(lon.min()), float(lon.max())
        rows, columns = surface.cells
        # Every n-th cell is enough, as tops include the cells around.
        step = max(int(math.sqrt(rows * columns / 4e6)), 1)
        middle = (west + east) / 2.0
        # Captures of a row are up to half an image outside the area.
        room = np.degrees(self.radius_m / WGS84.b_m)
        wide = room / max(math.cos(math.radians(min(max(abs(south), abs(north)), 89.0))), 1e-3)
        edges = np.linspace(south - room, north + room, 2048 + 1)
        centres = (edges[1:] + edges[:-1]) / 2.0
        metres = np.radians(centres - centres[0]) * WGS84.b_m
        over_tops, over_highest = np.full((2, len(centres)), np.inf)
        deepest_m = -math.inf
        above_ground = mission.terrain.height_above == GROUND
        highest = highest_around(self._ground, 0.0) if above_ground else None
        bottoms = None if sees_below(mission) else lowest_around(surface, self.radius_m)
        all_columns, all_rows = np.arange(0.0, columns + 1.0, step), np.arange(0.0, rows + 1.0, step)
        for some_rows in np.array_split(all_rows, len(all_rows) * len(all_columns) // BATCH + 1):
            column, row = (at.ravel() for at in np.meshgrid(all_columns, some_rows))
            at_lat, at_lon = surface.places(column, row)
            at_lon = at_lon - 360.0 * np.rint((at_lon - middle) / 360.0)
            near = (at_lat >= south - room) & (at_lat <= north + room)
            near &= (at_lon >= west - wide) & (at_lon <= east + wide)
            at_lat, at_lon = at_lat[near], at_lon[near]
            low, ground = self.wanted_m(at_lat, at_lon)
            high = low
            if highest is not None:
                # Between the centres of cells the ground may be lower or higher than at these.
                low, high = (find(at_lat, at_lon) + mission.flight.agl_m for find in (self._low, highest))
            tops = np.where(np.isnan(ground), np.nan, self._tops(at_lat, at_lon))
            bins = np.clip(np.searchsorted(edges, at_lat) - 1, 0, len(edges) - 2)
            for least, values in ((over_tops, low - tops), (over_highest, tops - high)):
                known = np.isfinite(values)
                np.minimum.at(least, bins[known], values[known])
            if bottoms is not None:
                deepest_m = max(deepest_m, float(np.nanmax(high - bottoms(at_lat, at_lon), initial=-np.inf)))
        least, most = _lower_bound(over_tops, metres), -_lower_bound(over_highest, metres)
        if not np.isfinite(least).all():
            refuse_hole(south, west)
        # Lower flights are refused.
        least, most = (np.maximum(over, _MIN_SEEN_SHARE * mission.flight.agl_m) for over in (least, most))
        return centres, least, most, float(most.max()) if bottoms is None else deepest_m

    @property
    def deepest_m(self) -> float:
        """Greatest height of a capture above the lowest ground that it sees.

        For images that show the ground straight below, the greatest height above the highest ground.
        """
        return self._seen_by_latitude[3]

    def flown(self, layout: Layout) -> Flown:
        """Heights of captures; refuses those that are too low."""
        mission, terrain = self.mission, self.mission.terrain
        lat, lon = layout.lat_deg, layout.lon_deg
        self.covers(lat, lon)
        ground = self.ground_m(lat, lon)
        agl = np.full(len(lat), mission.flight.agl_m) if mission.area.covers_ground else layout.agl_m
        wanted, _ = self.wanted_m(lat, lon, agl)
        least, near = self._least_m(lat, lon)
        height = wanted
        if terrain.height_above == GROUND:
            height = np.maximum(wanted, least)
            if terrain.climb_m_per_s is not None and len(lat) > 1:
                way_m = np.append(0.0, np.cumsum(legs(lat, lon).distance_m))
                height = _no_steeper(height, way_m, terrain.climb_m_per_s / mission.flight.airspeed_m_per_s)
        else:
            self._check_kept(lat, lon, height, least, near)
        seen = height - self._tops(lat, lon)
        low = np.flatnonzero(seen < _MIN_SEEN_SHARE * agl)
        if len(low):
            at = int(low[0])
            raise InvalidInput(
                "capture at latitude {0:.6f}, longitude {1:.6f}, {2:.1f} m above the ellipsoid: what its image may see "
                "there rises to {3:.1f} m",
                float(lat[at]),
                float(lon[at]),
                float(height[at]),
                float(height[at] - seen[at]),
                field="agl_m",
                remedy=Message("fly higher, or keep a clearance ({0})", OptionName("clearance")),
            )
        return Flown(height, ground, seen)

    def zoomed(self, layout: Layout) -> Layout:
        """Captures with the heights that determine the zoom: those above the highest ground that they see."""
        if self.mission.terrain.height_above == GROUND:
            return layout
        return layout._replace(agl_m=self.flown(layout).seen_agl_m)

    def lone(self, layout: Layout, flown: Flown | None) -> Layout:
        """Captures with heights above the highest ground that each may see; each point as if it were flown alone.

        Otherwise, the reach of other points would lower a point's height, and so change its image.
        """
        if flown is None or self.mission.area.covers_ground:
            return layout
        lat, lon, height = layout.lat_deg, layout.lon_deg, flown.height_m
        reach = _reaches(self.mission, (self.mission.camera,))[layout.column]
        lowest = _extremes(lowest_around, self._ground, lat, lon, (height - flown.ground_m) * reach)
        above = np.maximum(height - np.fmin(lowest, flown.ground_m), 1.0)
        tops = _extremes(highest_around, self._surface, lat, lon, above * reach)
        return layout._replace(agl_m=height - np.fmax(tops, flown.ground_m))

    def figures(self, cameras: CaptureCameras, poses: Poses, flown: Flown | None, corners: Corners) -> ReliefFigures:
        """Figures of a flight with captures (n,) and image corners (n, 4)."""
        if flown is None:
            raise ValueError("a flight over relief without its heights")
        lowest = lowest_around(self._surface, self.radius_m)(poses.lat_deg, poses.lon_deg)
        _, near = self._least_m(poses.lat_deg, poses.lon_deg)
        return ReliefFigures(
            float(flown.ground_m.min()),
            float(flown.ground_m.max()),
            float(flown.seen_agl_m.min()),
            float(np.nanmax(flown.height_m - lowest)),
            float((flown.height_m - np.where(np.isfinite(near), near, flown.ground_m)).min()),
            self._hidden_share(cameras, poses, flown.height_m, corners),
            self.filled,
        )

    def _hidden_share(self, cameras: CaptureCameras, poses: Poses, height_m: Floats, corners: Corners) -> float:
        """Share of the area's ground that relief hides from all images that contain it; 0 for points.

        Estimated from `_SAMPLES` points spread over the area.
        """
        lat, lon, height = self._area_samples()
        candidates = _Candidates.near(lat, lon, poses, corners)
        pairs = candidates.pairs(np.arange(len(lat)), 0, len(height_m))
        blocks = [self._containing(cameras, poses, height_m, (lat, lon, height), *some) for some in pairs]
        if not blocks:
            return 0.0
        point, camera, vectors = (np.concatenate(parts) for parts in zip(*blocks))
        dlon = lon[point] - poses.lon_deg[camera]
        held = np.arange(len(point))
        # The camera with the steepest view of a point usually sees the point, so try this camera first.
        steep = np.hypot(vectors[held, 0], vectors[held, 1]) / -vectors[held, 2]
        held = held[np.lexsort((steep, point[held]))]
        first = np.append(True, np.diff(point[held]) > 0) if len(held) else np.zeros(0, bool)
        seen = np.zeros(len(lat), bool)
        for pairs in (held[first], held[~first]):
            some = pairs[~seen[point[pairs]]]
            at, viewer = point[some], camera[some]
            found = self._surface.first_points(
                poses.lat_deg[viewer], poses.lon_deg[viewer], height_m[viewer], vectors[some], self.lowest_m
            )
            off_m = np.linalg.norm(sight_lines(lat[at], np.zeros(len(at)), found[0], found[1] - dlon[some]), axis=-1)
            # A ray that meets the surface within a hundredth of a cell of the point has met the point.
            seen[at[~(off_m > 0.01 * cell_size_m(self._surface))]] = True
        contained = np.zeros(len(lat), bool)
        contained[point[held]] = True
        return float((contained & ~seen).sum() / max(len(lat), 1))

    def missed_share(self, cameras: CaptureCameras, poses: Poses, height_m: Floats, corners: Corners) -> float:
        """Share of the area's ground, without no-fly areas, that lies outside all images, whether hidden or not.

        Estimated from `_SAMPLES` points spread over the area, and as many along its edge.
        """
        area = self.mission.area
        if not area.covers_ground:
            return 0.0
        spread, edge = self._area_samples(), self._surface_points(*_edge_points(area))
        lat, lon, height = (np.concatenate(parts) for parts in zip(spread, edge))
        missed = np.ones(len(lat), bool)
        candidates = _Candidates.near(lat, lon, poses, corners)
        # Most points are in one of a few images: more are tried for the rest alone.
        left, first, last = np.arange(len(lat)), 0, 16
        while len(left):
            for pairs in candidates.pairs(left, first, last):
                missed[self._containing(cameras, poses, height_m, (lat, lon, height), *pairs)[0]] = False
            left = left[missed[left] & (candidates.counts[left] > last).any(axis=1)]
            first, last = last, 3 * last
        for polygon in self.mission.no_fly:
            missed &= ~area_contains(polygon, lat, lon)
        return float(missed.sum()) / max(len(lat), 1)

    def _containing(
        self,
        cameras: CaptureCameras,
        poses: Poses,
        height_m: Floats,
        points: tuple[Floats, Floats, Floats],
        point: Numbers,
        camera: Numbers,
    ) -> tuple[Numbers, Numbers, Floats]:
        """Those pairs of a surface point and a capture, by index, whose image contains it, and vectors to it (m, 3)."""
        lat, lon, height = points
        # Sight lines lead to the ellipsoid; points lie above it, along its normals.
        dlon = lon[point] - poses.lon_deg[camera]
        vectors = sight_lines(poses.lat_deg[camera], height_m[camera], lat[point], dlon)
        vectors += height[point, np.newaxis] * _normals_enu(poses.lat_deg[camera], lat[point], dlon)
        attitude = [np.broadcast_to(angle, height_m.shape)[camera] for angle in poses.attitude]
        image_xy, in_front = cameras[camera].together(
            lambda one, at: one.image_xy(vectors[at, np.newaxis], *(angle[at] for angle in attitude))
        )
        held = (in_front & (np.abs(image_xy) <= 1.0).all(axis=-1))[:, 0]
        return point[held], camera[held], vectors[held]

    def _area_samples(self) -> tuple[Floats, Floats, Floats]:
        """Latitudes, longitudes and heights of points spread over the area, where the surface is known."""
        area = self.mission.area
        if not area.covers_ground:
            return np.empty(0), np.empty(0), np.empty(0)
        west, south, east, north = area.bounds.edges_deg
        # Kronecker sequence of powers of the plastic number, which is evenly distributed for any count.
        count = np.arange(1.0, _SAMPLES + 1.0)
        lon, lat = (
            begin + (end - begin) * np.mod(count * step, 1.0)
            for begin, end, step in ((west, east, 0.7548776662466927), (south, north, 0.5698402909980532))
        )
        inside = area_contains(area, lat, lon)
        lon, lat = lon[inside], lat[inside]
        return self._surface_points(lat, lon)

    def _surface_points(self, lat: Floats, lon: Floats) -> tuple[Floats, Floats, Floats]:
        """Positions at which the surface is known, and its heights there."""
        height = self._surface.heights(*self._surface.position(lat, lon))
        known = np.isfinite(height)
        return lat[known], lon[known], height[known]

    def _least_m(self, lat: Floats, lon: Floats) -> tuple[Floats, Floats]:
        """Least heights that captures may have, and greatest heights within the clearance's distance."""
        terrain = self.mission.terrain
        below = self._surface.heights(*self._surface.position(lat, lon))
        near = below
        if terrain.clearance_distance_m:
            near = highest_around(self._surface, terrain.clearance_distance_m)(lat, lon)
        near = np.where(np.isnan(near), -np.inf, near)
        return near + terrain.clearance_m, near

    def _check_kept(self, lat: Floats, lon: Floats, height: Floats, least: Floats, near: Floats) -> None:
        """Refuse captures that are closer to the surface than the clearance allows."""
        low = np.flatnonzero((height < least) | (height <= near))
        if not len(low):
            return
        at = int(low[np.argmax((least - height)[low])])
        raise InvalidInput(
            "capture at latitude {0:.6f}, longitude {1:.6f}, {2:.1f} m above the ellipsoid: the surface there rises to "
            "{3:.1f} m, and {4:g} m of clearance are to be kept",
            float(lat[at]),
            float(lon[at]),
            float(height[at]),
            float(near[at]),
            self.mission.terrain.clearance_m,
            field="agl_m",
            remedy=Message("fly {0:.0f} m higher, or above the ground below", math.ceil(least[at] - height[at])),
        )


def relief_below(mission: Mission, heights: Heights | None) -> tuple[Mission, Relief]:
    """Relief that a mission flies over, and the mission with its ground height set to the lowest of the relief.

    Raises
    ------
    InvalidInput
        The mission names an elevation, but heights are missing; and as for `ModelledRelief`.
    """
    if heights is None:
        raise InvalidInput(
            "elevation {0}: the mission is planned without its heights", ", ".join(mission.terrain.elevation)
        )
    check_clearance(mission)
    relief = ModelledRelief(mission, heights)
    level = mission.replace(ground_height_m=relief.lowest_m)
    if relief.is_flat and mission.terrain.height_above != ELLIPSOID:
        return level, level_ground(level)
    return level, relief


def check_clearance(mission: Mission) -> None:
    """Refuse a clearance that is greater than the height above ground."""
    terrain, agl = mission.terrain, mission.flight.agl_m
    if terrain.height_above != ELLIPSOID and terrain.clearance_m > agl:
        raise InvalidInput(
            "clearance {0:g} m and height {1:g} m above ground: the clearance must be the smaller one",
            terrain.clearance_m,
            agl,
            field="clearance_m",
        )


def _pixel_range(at: Floats, count: int) -> slice:
    """Pixels around positions along an axis of ``count`` pixels."""
    low, high = float(np.nanmin(at)), float(np.nanmax(at))
    first = min(max(math.floor(low), 0), count - 1)
    return slice(first, max(min(math.ceil(high) + 1, count), first + 1))


def _reach(mission: Mission) -> float:
    """Greatest of `_reaches`, of any lens that the images may have."""
    return float(_reaches(mission, mission.varied.extreme_cameras(mission.camera)).max())


def _reaches(mission: Mission, cameras: tuple[Camera, ...]) -> Floats:
    """Distance, per metre of height, to which images see level ground: of each point (n,), or for an area (1,).

    The distance is measured from the point below the camera, and is at most `_MAX_TANGENT`.
    """
    area = mission.area
    if isinstance(area, Points):
        angles = [point_angles_deg(mission, area, name) for name in ANGLES]
    else:
        angles = [np.array([getattr(mission.attitude, f"{name}_deg")]) for name in ANGLES]
    # The yaw does not change the distance, and equal attitudes are computed once.
    (tilts, rolls), which = np.unique(np.stack(angles[1:]), axis=1, return_inverse=True)
    if mission.varied.keep_undistorted:
        cameras += tuple(one.undistorted for one in cameras)
    seen = [one.rays_enu(one.extremes.image_xy, np.zeros_like(tilts), tilts, rolls) for one in cameras]
    rays = np.concatenate(seen, axis=-2)
    with np.errstate(divide="ignore"):
        tangents = np.hypot(rays[..., 0], rays[..., 1]) / np.maximum(-rays[..., 2], 1e-9)
    farthest: Floats = np.minimum(tangents.max(axis=-1), _MAX_TANGENT)
    return farthest[np.ravel(which)]


def _area_positions(mission: Mission) -> tuple[Floats, Floats]:
    """Latitudes and longitudes of the points, or of 5 by 5 positions in the bounds of an area."""
    area = mission.area
    if isinstance(area, Points):
        lat, lon, _ = np.array(area.poses, np.float64).reshape(-1, 3).T
        return lat, lon
    box = area.bounds
    east = box.east_deg + (360.0 if box.east_deg < box.west_deg else 0.0)
    lat, lon = np.meshgrid(np.linspace(box.south_deg, box.north_deg, 5), np.linspace(box.west_deg, east, 5))
    return lat.ravel(), lon.ravel()


def _widened(lat: Floats, lon: Floats, room_m: float) -> tuple[Floats, Floats]:
    """Positions (n,) moved by ``room_m`` to the four corners around each, (4 n,)."""
    room = math.degrees(room_m / WGS84.b_m)
    wide = room / np.maximum(np.cos(np.radians(lat)), 1e-3)
    north, south = np.minimum(lat + room, 90.0), np.maximum(lat - room, -90.0)
    return (
        np.concatenate([north, north, south, south]),
        np.concatenate([lon - wide, lon + wide, lon - wide, lon + wide]),
    )


def _edge_points(area: Area) -> tuple[Floats, Floats]:
    """Latitudes and longitudes of about `_SAMPLES` points along the rings of an area, including their corners."""
    rings = [ring for part in area.parts for ring in part.arrays()]
    share = np.linspace(0.0, 1.0, max(_SAMPLES // sum(len(lon) for lon, _ in rings), 1), endpoint=False)
    lon, lat = (
        np.concatenate([(at[:, np.newaxis] + (np.roll(at, -1) - at)[:, np.newaxis] * share).ravel() for at in axis])
        for axis in zip(*rings)
    )
    return lat, lon


class _Candidates(NamedTuple):
    """Captures whose images may contain points: neighbours in a grid of images.

    Attributes
    ----------
    first, counts : array (n, 3)
        Ranges of ``order`` for each point, one for each row of the grid.
    order : array (m,)
        Captures by their cell in the grid.
    """

    first: Numbers
    counts: Numbers
    order: Numbers

    @classmethod
    def near(cls, lat: Floats, lon: Floats, poses: Poses, corners: Corners) -> _Candidates:
        """Candidates of points (n,)."""
        north_m = math.radians(1.0) * WGS84.b_m
        east_m = north_m * math.cos(math.radians(float(np.clip(np.mean(lat), -89.0, 89.0)))) if len(lat) else 1.0
        corner_lon = poses.lon_deg[:, np.newaxis] + wrap_lon_deg(corners.lon_deg - poses.lon_deg[:, np.newaxis])
        x, y = corner_lon * east_m, corners.lat_deg * north_m
        middle = np.stack([np.nanmean(x, axis=1), np.nanmean(y, axis=1)], axis=1)
        reach = float(np.nanmax(np.hypot(x - middle[:, :1], y - middle[:, 1:]), initial=1.0))
        points = np.stack([lon * east_m, lat * north_m], axis=1)
        start = np.minimum(np.nanmin(middle, axis=0), points.min(axis=0, initial=np.inf))
        # An image may extend 5 % beyond its corners.
        (point_x, point_y), (x_at, y_at) = (
            np.floor((at - start) / (1.05 * reach)).astype(np.int64).T + 1 for at in (points, middle)
        )
        wide = int(max(point_x.max(initial=0), x_at.max(initial=0))) + 2
        keys = y_at * wide + x_at
        # Neighbours in flight are far apart among the captures of a cell.
        spread = np.argsort(np.mod(np.arange(len(keys)) * 0.6180339887498949, 1.0))
        order = spread[np.argsort(keys[spread], kind="stable")]
        # The three cells of a row have consecutive keys.
        key = (point_y[:, np.newaxis] + np.array([0, -1, 1])) * wide + point_x[:, np.newaxis]
        first = np.searchsorted(keys[order], key - 1)
        return cls(first, np.searchsorted(keys[order], key + 1, side="right") - first, order)

    def pairs(self, points: Numbers, start: int, stop: int) -> Iterator[tuple[Numbers, Numbers]]:
        """Yield pairs of points and candidates in batches: of each row, the ``start``-th up to the ``stop``-th."""
        counts = np.clip(self.counts[points] - start, 0, stop - start)
        for at, place in pairs_in_batches((self.first[points] + start).ravel(), counts.ravel()):
            yield points[at // 3], self.order[place]


def _normals_enu(lat_deg: Floats, at_lat_deg: Floats, dlon_deg: Floats) -> Floats:
    """Normals of the ellipsoid at latitudes ``at_lat_deg``, (n, 3), as east, north and up at latitudes ``lat_deg``."""
    (sine, cosine), (at_sine, at_cosine) = sin_cos(lat_deg), sin_cos(at_lat_deg)
    sin_dlon, cos_dlon = sin_cos(dlon_deg)
    return np.stack(
        [
            at_cosine * sin_dlon,
            at_sine * cosine - at_cosine * sine * cos_dlon,
            at_sine * sine + at_cosine * cosine * cos_dlon,
        ],
        axis=-1,
    )


def _contains(surface: Surface, lat_deg: Floats, lon_deg: Floats) -> bool:
    """Whether a surface contains all positions (n,)."""
    column, row = surface.position(lat_deg, lon_deg)
    rows, columns = surface.cells
    return bool(((column >= 0.0) & (column <= columns) & (row >= 0.0) & (row <= rows)).all())


def _is_finest(surface: Surface, lat_deg: Floats, lon_deg: Floats) -> bool:
    """Whether a surface contains positions (n,) at the finest resolution."""
    return surface.zoom == surface.grid.native_zoom and _contains(surface, lat_deg, lon_deg)


def _extremes(
    find: Callable[[Surface, float], Callable[[Floats, Floats], Floats]],
    surface: Surface,
    lat_deg: Floats,
    lon_deg: Floats,
    radius_m: Floats,
) -> Floats:
    """Extreme heights within a radius of each position, (n,), by `highest_around` or `lowest_around`.

    Radii are rounded down, by 16 % at most, so that few different ones are searched.
    """
    cell_m = cell_size_m(surface)
    steps = np.floor(4.0 * np.log2(np.maximum(radius_m / cell_m, 1.0)))
    found = np.full(len(lat_deg), np.nan)
    for step in np.unique(steps).tolist():
        at = steps == step
        found[at] = find(surface, cell_m * 2.0 ** (step / 4.0))(lat_deg[at], lon_deg[at])
    return found


def _lower_bound(least: Floats, metres: Floats) -> Floats:
    """Greatest function of ``metres`` (b,) that is below the least values (b,) of bins and changes slowly.

    Bins without values have infinity; so has the function if all have.
    """
    # A value counts for both adjacent bins, as functions are interpolated between bin centres.
    least = np.append(least[0], np.append(np.minimum(np.minimum(least[:-2], least[1:-1]), least[2:]), least[-1]))
    # Slopes of 5 % at most let the search for rows converge.
    slopes = 0.05 * metres
    found: Floats = np.minimum(
        np.minimum.accumulate(least - slopes) + slopes,
        np.minimum.accumulate((least + slopes)[::-1])[::-1] - slopes,
    )
    return found


def _no_steeper(height: Floats, way_m: Floats, slope: float) -> Floats:
    """Lowest profile above heights along a way, with slopes up to ``slope``."""
    up = np.maximum.accumulate(height + slope * way_m) - slope * way_m
    down = np.maximum.accumulate((height - slope * way_m)[::-1])[::-1] + slope * way_m
    found: Floats = np.maximum(up, down)
    return found
