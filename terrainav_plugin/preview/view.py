"""What the map shows now: the part of the world in view, and how large things are on the screen."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsCsException,
    QgsPointXY,
    QgsRectangle,
)
from qgis.gui import QgsMapCanvas
from qgis.PyQt.QtCore import QDateTime, QTimeZone

from ...core.geodesy.mercator import HALF_WORLD_M, MAX_LAT_DEG

#: Of all layers: that of the pictures' pixels, in which their edges are exact.
CRS = "EPSG:3857"
#: Width of the world in metres of that CRS.
WORLD_M = 2.0 * HALF_WORLD_M
#: Points a side at which a view in another CRS is looked up: a twentieth of it apart, which is also its margin.
_SAMPLES = 21
#: Widest gap in degrees between longitudes looked up in a view that goes around the Earth.
_AROUND_DEG = 40.0


class Rect(NamedTuple):
    """Part of the world in metres of EPSG:3857: west within it, east beyond its end across the antimeridian."""

    west: float
    south: float
    east: float
    north: float

    @classmethod
    def fitted(cls, west: float, south: float, east: float, north: float) -> Rect:
        """Rectangle brought to where the world is; at most once around it."""
        if east - west >= WORLD_M:
            west, east = -HALF_WORLD_M, HALF_WORLD_M
        turn = WORLD_M * math.floor((west + HALF_WORLD_M) / WORLD_M)
        return cls(west - turn, max(south, -HALF_WORLD_M), east - turn, min(north, HALF_WORLD_M))

    @property
    def longer_m(self) -> float:
        """Longer side."""
        return max(self.east - self.west, self.north - self.south)

    def grown(self, share: float) -> Rect:
        """Rectangle with a margin on each side, as a share of its own."""
        x, y = share * (self.east - self.west), share * (self.north - self.south)
        return Rect.fitted(self.west - x, self.south - y, self.east + x, self.north + y)

    def contains(self, other: Rect) -> bool:
        """Whether another one lies inside."""
        if self.south > other.south or self.north < other.north:
            return False
        if self.east - self.west >= WORLD_M:
            return True
        west = other.west + (WORLD_M if other.west < self.west else 0.0)
        return west + (other.east - other.west) <= self.east

    def is_empty(self) -> bool:
        """Whether nothing of the world is in it."""
        return self.south >= self.north or self.west >= self.east


WORLD = Rect(-HALF_WORLD_M, -HALF_WORLD_M, HALF_WORLD_M, HALF_WORLD_M)


@dataclass(frozen=True)
class View:
    """A look at the map.

    Attributes
    ----------
    rect : Rect
        What is in view; a little more where the project has another CRS.
    to_map : QgsCoordinateTransform
        From EPSG:3857 to the map's CRS.
    units_per_px : float
        Map units of a pixel of the screen.
    width_px : int
        Width of the map on the screen.
    times_ms : tuple of float, or None
        First and last moment that the temporal controller shows, milliseconds UTC.
    """

    rect: Rect
    to_map: QgsCoordinateTransform
    units_per_px: float
    width_px: int
    times_ms: tuple[float, float] | None = None

    def px_per_m(self, x_m: float, y_m: float) -> float:
        """Pixels of the screen that a metre of EPSG:3857 takes at a place."""
        step = max(self.rect.longer_m * 1e-3, 1e-3)
        at = []
        try:
            for x, y in (
                (x_m, y_m),
                (x_m - math.copysign(step, x_m), y_m),
                (x_m, y_m - math.copysign(step, y_m)),
            ):
                at.append(self.to_map.transform(QgsPointXY(x, y)))
        except QgsCsException:
            at = []
        lengths = [at[0].distance(there) for there in at[1:]]
        longest = max(lengths, default=math.nan)
        if not (math.isfinite(longest) and longest > 0.0):
            return self.width_px / (self.rect.east - self.rect.west)
        return longest / step / self.units_per_px


def view_of(canvas: QgsMapCanvas) -> View | None:
    """What a map canvas shows; None of one that shows nothing yet. On the main thread."""
    settings = canvas.mapSettings()
    extent, crs = settings.visibleExtent(), settings.destinationCrs()
    size = settings.outputSize()
    if extent.isEmpty() or not extent.isFinite() or size.isEmpty():
        return None
    context = settings.transformContext()
    web = QgsCoordinateReferenceSystem(CRS)
    to_map = QgsCoordinateTransform(web, crs, context) if crs.isValid() else QgsCoordinateTransform()
    to_map.setBallparkTransformsAreAppropriate(True)
    times = None
    if settings.isTemporal():
        shown = settings.temporalRange()
        times = (_utc_ms(shown.begin(), -math.inf), _utc_ms(shown.end(), math.inf))
    rect = _in_web_metres(extent, crs, context)
    return View(rect, to_map, settings.mapUnitsPerPixel(), size.width(), times)


def _in_web_metres(extent: QgsRectangle, crs: QgsCoordinateReferenceSystem, context: object) -> Rect:
    edges = extent.xMinimum(), extent.yMinimum(), extent.xMaximum(), extent.yMaximum()
    if not crs.isValid() or crs.authid() == CRS:
        # Such maps have one world; beside it there is nothing.
        return Rect(*(min(max(edge, -HALF_WORLD_M), HALF_WORLD_M) for edge in edges))
    if crs.isGeographic():
        west, south, east, north = edges
        return _of_degrees(max(west, -180.0), south, min(east, 180.0), north)
    to_degrees = QgsCoordinateTransform(crs, QgsCoordinateReferenceSystem("EPSG:4326"), context)
    to_degrees.setBallparkTransformsAreAppropriate(True)
    places = _looked_up(extent, to_degrees)
    if not places:
        return WORLD
    lons = sorted(lon for lon, _ in places)
    lats = [lat for _, lat in places]
    margin = (max(lats) - min(lats)) / (_SAMPLES - 1)
    gaps = [(after - lon, after) for lon, after in zip(lons, [*lons[1:], lons[0] + 360.0])]
    gap, west = max(gaps)
    south, north = min(lats) - margin, max(lats) + margin
    if gap < _AROUND_DEG:
        return _of_degrees(-180.0, south, 180.0, north)
    margin = (360.0 - gap) / (_SAMPLES - 1)
    return _of_degrees(west - margin, south, west + 360.0 - gap + margin, north)


def _looked_up(extent: QgsRectangle, to_degrees: QgsCoordinateTransform) -> list[tuple[float, float]]:
    """Longitudes and latitudes of points spread over a view, of those that lie on the Earth."""
    found = []
    for i in range(_SAMPLES):
        x = extent.xMinimum() + extent.width() * i / (_SAMPLES - 1)
        for j in range(_SAMPLES):
            y = extent.yMinimum() + extent.height() * j / (_SAMPLES - 1)
            try:
                place = to_degrees.transform(QgsPointXY(x, y))
            except QgsCsException:
                continue
            if math.isfinite(place.x()) and math.isfinite(place.y()):
                found.append((place.x(), place.y()))
    return found


def _of_degrees(west: float, south: float, east: float, north: float) -> Rect:
    def northing(lat_deg: float) -> float:
        lat = math.radians(min(max(lat_deg, -MAX_LAT_DEG), MAX_LAT_DEG))
        return HALF_WORLD_M * math.asinh(math.tan(lat)) / math.pi

    metre = HALF_WORLD_M / 180.0
    return Rect.fitted(west * metre, northing(south), east * metre, northing(north))


def _utc_ms(moment: QDateTime, otherwise: float) -> float:
    """Moment of the temporal controller, which knows no time zones, as UTC."""
    if not moment.isValid():
        return otherwise
    return float(QDateTime(moment.date(), moment.time(), QTimeZone.utc()).toMSecsSinceEpoch())
