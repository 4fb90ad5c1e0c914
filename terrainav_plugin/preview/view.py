"""The current view of the map: the part of a plan's world in view, and its scale on the screen."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from qgis.core import (
    Qgis,
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsCsException,
    QgsPointXY,
    QgsRectangle,
)
from qgis.gui import QgsMapCanvas

from ...core.geodesy.ellipsoid import WGS84
from ...core.geodesy.mercator import HALF_WORLD_M, MAX_LAT_DEG
from ..map.canvas import shown_times_ms
from ..tasks import crs_named

if TYPE_CHECKING:
    from ...core.mission.plan import Plan

#: CRS of images on the web map's grid.
CRS = "EPSG:3857"
#: Width of the world in `CRS`, in metres.
WORLD_M = 2.0 * HALF_WORLD_M
#: Number of points along each side of a view that are transformed to another CRS; the margin is their spacing.
_SAMPLES = 21


@dataclass(frozen=True)
class PreviewWorld:
    """Square in which a plan is drawn: the whole web map, or the surroundings of the plan in another CRS.

    Parameters
    ----------
    crs : str
        CRS of the images' pixels, in which image edges are exact, and of all layers: ``EPSG:code``, or WKT.
    west, south, size : float
        Lower left corner and side of the square, in the unit of the CRS, which is called metres in this room.
    wraps : bool
        Whether the world repeats to the east, as on the web map.
    """

    crs: str = CRS
    west: float = -HALF_WORLD_M
    south: float = -HALF_WORLD_M
    size: float = WORLD_M
    wraps: bool = True

    @property
    def east(self) -> float:
        """Right edge."""
        return self.west + self.size

    @property
    def north(self) -> float:
        """Upper edge."""
        return self.south + self.size

    @property
    def shifts(self) -> tuple[float, ...]:
        """Eastward shifts by which places may repeat."""
        return (-self.size, 0.0, self.size) if self.wraps else (0.0,)

    @property
    def whole(self) -> Rect:
        """The whole square."""
        return Rect(self.west, self.south, self.east, self.north, self)


MERCATOR = PreviewWorld()


def preview_world(plan: Plan) -> PreviewWorld:
    """World in which a plan is drawn."""
    plane = plan.grid.plane
    if plane.wraps:
        return MERCATOR
    west, south, east, north = plan.edges
    edges = float(west.min()), float(south.min()), float(east.max()), float(north.max())
    reach = 0.0
    if not plan.frames.on_map:
        lat, lon, _ = plan.corners
        east_deg = (lon - plan.lon_deg[:, np.newaxis]) * np.cos(np.radians(plan.lat_deg))[:, np.newaxis]
        degrees = np.hypot(lat - plan.lat_deg[:, np.newaxis], east_deg)
        reach = math.radians(float(np.nanmax(degrees))) * WGS84.a_m / plane.unit_m
    longest = max(edges[2] - edges[0], edges[3] - edges[1]) + 2.0 * reach
    # At least four times the extent of the images, and a power of two, so that density cells have round sizes.
    size = 2.0 ** math.ceil(math.log2(4.0 * longest))
    middle_x, middle_y = (edges[0] + edges[2]) / 2.0, (edges[1] + edges[3]) / 2.0
    return PreviewWorld(plane.crs, middle_x - size / 2.0, middle_y - size / 2.0, size, wraps=False)


class Rect(NamedTuple):
    """Rectangle of a world in metres; across the antimeridian, ``east`` exceeds the world's east edge."""

    west: float
    south: float
    east: float
    north: float
    world: PreviewWorld = MERCATOR

    @classmethod
    def fitted(cls, west: float, south: float, east: float, north: float, world: PreviewWorld = MERCATOR) -> Rect:
        """Rectangle moved into the world, and limited to its width."""
        south, north = max(south, world.south), min(north, world.north)
        if not world.wraps:
            return cls(max(west, world.west), south, min(east, world.east), north, world)
        if east - west >= world.size:
            west, east = world.west, world.east
        turn = world.size * math.floor((west - world.west) / world.size)
        return cls(west - turn, south, east - turn, north, world)

    @property
    def edges(self) -> tuple[float, float, float, float]:
        """West, south, east, north."""
        return self[:4]

    @property
    def longer_m(self) -> float:
        """Longer side."""
        return max(self.east - self.west, self.north - self.south)

    def grown(self, share: float) -> Rect:
        """Rectangle enlarged on each side by a share of its width or height."""
        x, y = share * (self.east - self.west), share * (self.north - self.south)
        return Rect.fitted(self.west - x, self.south - y, self.east + x, self.north + y, self.world)

    def contains(self, other: Rect) -> bool:
        """Whether another rectangle is inside this one."""
        if self.south > other.south or self.north < other.north:
            return False
        if not self.world.wraps:
            return self.west <= other.west and other.east <= self.east
        if self.east - self.west >= self.world.size:
            return True
        west = other.west + (self.world.size if other.west < self.west else 0.0)
        return west + (other.east - other.west) <= self.east

    def is_empty(self) -> bool:
        """Whether the rectangle contains no part of the world."""
        return self.south >= self.north or self.west >= self.east


WORLD = MERCATOR.whole


@dataclass(frozen=True)
class MapView:
    """A view of the map.

    Attributes
    ----------
    rect : Rect
        Part of the world in view; slightly larger if the map has another CRS.
    to_map : QgsCoordinateTransform
        Transformation from the world's CRS to the map's.
    units_per_px : float
        Map units per pixel of the screen.
    width_px : int
        Width of the map on the screen.
    times_ms : tuple of float, or None
        First and last moment shown by the temporal controller, in milliseconds UTC.
    """

    rect: Rect
    to_map: QgsCoordinateTransform
    units_per_px: float
    width_px: int
    times_ms: tuple[float, float] | None = None

    def px_per_m(self, x_m: float, y_m: float) -> float:
        """Screen pixels per metre of the world at a point."""
        step = max(self.rect.longer_m * 1e-3, 1e-3)
        world, at = self.rect.world, []
        # Step towards the middle of the world, as points beyond its edges may be outside the CRS's domain.
        beside_x = x_m - math.copysign(step, x_m - (world.west + world.east) / 2.0)
        beside_y = y_m - math.copysign(step, y_m - (world.south + world.north) / 2.0)
        try:
            for x, y in ((x_m, y_m), (beside_x, y_m), (x_m, beside_y)):
                at.append(self.to_map.transform(QgsPointXY(x, y)))
        except QgsCsException:
            at = []
        lengths = [at[0].distance(there) for there in at[1:]]
        longest = max(lengths, default=math.nan)
        if not (math.isfinite(longest) and longest > 0.0):
            return self.width_px / (self.rect.east - self.rect.west)
        return longest / step / self.units_per_px


def current_view(canvas: QgsMapCanvas, world: PreviewWorld = MERCATOR) -> MapView | None:
    """View of a world on a map canvas; None if the canvas has no size yet. Main thread only."""
    settings = canvas.mapSettings()
    extent, crs = settings.visibleExtent(), settings.destinationCrs()
    size = settings.outputSize()
    if extent.isEmpty() or not extent.isFinite() or size.isEmpty():
        return None
    context = settings.transformContext()
    own = crs_named(world.crs)
    to_map = QgsCoordinateTransform(own, crs, context) if crs.isValid() else QgsCoordinateTransform()
    to_map.setBallparkTransformsAreAppropriate(True)
    times = shown_times_ms(settings)
    rect = _visible_web_rect(extent, crs, context) if world.wraps else _visible_crs_rect(extent, to_map, world)
    return MapView(rect, to_map, settings.mapUnitsPerPixel(), size.width(), times)


def _visible_web_rect(extent: QgsRectangle, crs: QgsCoordinateReferenceSystem, context: object) -> Rect:
    edges = extent.xMinimum(), extent.yMinimum(), extent.xMaximum(), extent.yMaximum()
    if not crs.isValid() or crs.authid() == CRS:
        # Web maps show the world once, without repetition.
        return Rect(*(min(max(edge, -HALF_WORLD_M), HALF_WORLD_M) for edge in edges))
    if crs.isGeographic():
        west, south, east, north = edges
        return _degree_rect(max(west, -180.0), south, min(east, 180.0), north)
    to_degrees = QgsCoordinateTransform(crs, QgsCoordinateReferenceSystem("EPSG:4326"), context)
    to_degrees.setBallparkTransformsAreAppropriate(True)
    places, _ = _looked_up(extent, to_degrees)
    if not places:
        return WORLD
    lons = sorted(lon for lon, _ in places)
    lats = [lat for _, lat in places]
    margin = (max(lats) - min(lats)) / (_SAMPLES - 1)
    gaps = [(after - lon, after) for lon, after in zip(lons, [*lons[1:], lons[0] + 360.0])]
    gap, west = max(gaps)
    south, north = min(lats) - margin, max(lats) + margin
    # Without a gap of 40° between its longitudes, the view goes around the Earth.
    if gap < 40.0:
        return _degree_rect(-180.0, south, 180.0, north)
    margin = (360.0 - gap) / (_SAMPLES - 1)
    return _degree_rect(west - margin, south, west + 360.0 - gap + margin, north)


def _visible_crs_rect(extent: QgsRectangle, to_map: QgsCoordinateTransform, world: PreviewWorld) -> Rect:
    """Part of a world without wrapping that is in view; the whole world if the view leaves the domain of its CRS."""
    if not to_map.isValid() or to_map.isShortCircuited():
        edges = extent.xMinimum(), extent.yMinimum(), extent.xMaximum(), extent.yMaximum()
        return Rect.fitted(*edges, world)
    places, whole = _looked_up(extent, to_map, Qgis.TransformDirection.Reverse)
    if not whole:
        return world.whole
    x, y = ([place[axis] for place in places] for axis in (0, 1))
    margin_x, margin_y = ((max(at) - min(at)) / (_SAMPLES - 1) for at in (x, y))
    return Rect.fitted(min(x) - margin_x, min(y) - margin_y, max(x) + margin_x, max(y) + margin_y, world)


def _looked_up(
    extent: QgsRectangle,
    transform: QgsCoordinateTransform,
    direction: Qgis.TransformDirection = Qgis.TransformDirection.Forward,
) -> tuple[list[tuple[float, float]], bool]:
    """Points of a view that can be transformed to another CRS, transformed; and whether all can."""
    found = []
    for i in range(_SAMPLES):
        x = extent.xMinimum() + extent.width() * i / (_SAMPLES - 1)
        for j in range(_SAMPLES):
            y = extent.yMinimum() + extent.height() * j / (_SAMPLES - 1)
            try:
                place = transform.transform(QgsPointXY(x, y), direction)
            except QgsCsException:
                continue
            if math.isfinite(place.x()) and math.isfinite(place.y()):
                found.append((place.x(), place.y()))
    return found, len(found) == _SAMPLES**2


def _degree_rect(west: float, south: float, east: float, north: float) -> Rect:
    def northing(lat_deg: float) -> float:
        lat = math.radians(min(max(lat_deg, -MAX_LAT_DEG), MAX_LAT_DEG))
        return HALF_WORLD_M * math.asinh(math.tan(lat)) / math.pi

    metre = HALF_WORLD_M / 180.0
    return Rect.fitted(west * metre, northing(south), east * metre, northing(north))
