"""The camera on the map: its place, a handle for its heading, and its footprint."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from qgis.core import Qgis, QgsCsException, QgsPointXY, QgsProject
from qgis.gui import QgsMapCanvas, QgsMapCanvasItem, QgsRubberBand, QgsVertexMarker
from qgis.PyQt.QtCore import QObject
from qgis.PyQt.QtGui import QColor

from ...core.geodesy.ellipsoid import WGS84
from ..compat import LINE, POLYGON
from ..map.canvas import to_lon_lat
from ..tasks import crs_named

if TYPE_CHECKING:
    from qgis.core import QgsGeometry

    from ...core.live.camera import FrameRequest

#: Blue of the Okabe-Ito palette, which colour-blind people distinguish from the colours of areas.
_COLOUR, _FILL = QColor(0, 114, 178), QColor(0, 114, 178, 40)
#: Distance of the handle from the camera on the screen.
HANDLE_PX = 64.0
#: Distance on the ground by which directions on the map are determined.
_STEP_M = 1.0


class Compass(NamedTuple):
    """A place on the screen, and the directions of north and east there as unit vectors, in pixels.

    Parameters
    ----------
    x, y : float
    north, east : tuple of two floats
    """

    x: float
    y: float
    north: tuple[float, float]
    east: tuple[float, float]

    @classmethod
    def at(cls, canvas: QgsMapCanvas, lat_deg: float, lon_deg: float) -> Compass | None:
        """Compass at a place; None where the map's CRS cannot show it."""
        # Towards the equator at a pole, and not across the end of the map.
        way = -1.0 if lat_deg > 0.0 else 1.0
        north_deg = math.degrees(_STEP_M / float(WGS84.meridional_radius_m(lat_deg)))
        parallel_m = float(WGS84.normal_radius_m(lat_deg)) * max(math.cos(math.radians(lat_deg)), 1e-9)
        across = -1.0 if lon_deg > 0.0 else 1.0
        east_deg = math.degrees(_STEP_M / parallel_m)
        at = _pixel(canvas, lat_deg, lon_deg)
        north = _pixel(canvas, lat_deg + way * north_deg, lon_deg)
        east = _pixel(canvas, lat_deg, lon_deg + across * east_deg)
        if at is None or north is None or east is None:
            return None
        directions = []
        for there, sign in ((north, way), (east, across)):
            x, y = sign * (there.x() - at.x()), sign * (there.y() - at.y())
            length = math.hypot(x, y)
            if not length > 0.0 or not math.isfinite(length):
                return None
            directions.append((x / length, y / length))
        return cls(at.x(), at.y(), *directions)

    def ahead(self, yaw_deg: float, distance_px: float) -> tuple[float, float]:
        """Pixel in the direction of a yaw."""
        sin, cos = math.sin(math.radians(yaw_deg)), math.cos(math.radians(yaw_deg))
        x, y = (cos * north + sin * east for north, east in zip(self.north, self.east))
        length = math.hypot(x, y)
        return self.x + distance_px * x / length, self.y + distance_px * y / length

    def yaw_deg(self, x_px: float, y_px: float) -> float:
        """Yaw towards a pixel, the inverse of `ahead`."""
        x, y = x_px - self.x, y_px - self.y
        (north_x, north_y), (east_x, east_y) = self.north, self.east
        turn = north_x * east_y - north_y * east_x
        return math.degrees(math.atan2((north_x * y - north_y * x) / turn, (x * east_y - y * east_x) / turn))


class CameraMarks(QObject):
    """Camera, handle and footprint on the canvas, while there is a pose.

    Attributes
    ----------
    compass : Compass or None
        Place of the camera on the screen; None without a camera in the map.
    """

    def __init__(self, canvas: QgsMapCanvas) -> None:
        super().__init__()
        self._canvas = canvas
        self._pose: FrameRequest | None = None
        self._items: list[QgsMapCanvasItem] = []
        self.compass: Compass | None = None
        for signal in self._signals():
            signal.connect(self._draw)

    def close(self) -> None:
        """Remove the marks for good."""
        for signal in self._signals():
            signal.disconnect(self._draw)
        self.clear()

    def show_pose(self, pose: FrameRequest) -> None:
        """Show the camera at a pose."""
        self._pose = pose
        self._draw()

    def show_footprint(self, shape: QgsGeometry, crs: str) -> None:
        """Show the ground that the camera sees."""
        if self._items:
            self._items[0].setToGeometry(shape, crs_named(crs))

    def clear(self) -> None:
        """Remove the marks from the map."""
        self._pose = self.compass = None
        for item in self._items:
            self._canvas.scene().removeItem(item)
        self._items = []

    @property
    def handle(self) -> tuple[float, float] | None:
        """Pixel of the handle."""
        if self.compass is None or self._pose is None:
            return None
        return self.compass.ahead(self._pose.yaw_deg, HANDLE_PX)

    @property
    def items(self) -> list[QgsMapCanvasItem]:
        """Footprint, heading, camera and handle on the canvas; empty without a camera."""
        return self._items

    def _signals(self) -> tuple[Any, ...]:
        canvas = self._canvas
        return canvas.extentsChanged, canvas.scaleChanged, canvas.rotationChanged, canvas.destinationCrsChanged

    def _draw(self, *_: object) -> None:
        if self._pose is None:
            return
        if not self._items:
            self._items = self._made()
        footprint, heading, camera, handle = self._items
        self.compass = Compass.at(self._canvas, self._pose.lat_deg, self._pose.lon_deg)
        for item in (heading, camera, handle):
            item.setVisible(self.compass is not None)
        if self.compass is None:
            footprint.reset(POLYGON)
            return
        to_map = self._canvas.getCoordinateTransform()
        place, end = (
            to_map.toMapCoordinatesF(*at) for at in ((self.compass.x, self.compass.y), self.handle or (0.0, 0.0))
        )
        heading.reset(LINE)
        heading.addPoint(place, False)
        heading.addPoint(end, True)
        camera.setCenter(place)
        handle.setCenter(end)

    def _made(self) -> list[QgsMapCanvasItem]:
        footprint, heading = (QgsRubberBand(self._canvas, kind) for kind in (POLYGON, LINE))
        for band in (footprint, heading):
            band.setStrokeColor(_COLOUR)
            band.setFillColor(_FILL)
            band.setWidth(2)
        camera, handle = QgsVertexMarker(self._canvas), QgsVertexMarker(self._canvas)
        for mark, size_px in ((camera, 16), (handle, 11)):
            mark.setIconType(QgsVertexMarker.IconType.ICON_CIRCLE)
            mark.setColor(_COLOUR)
            mark.setFillColor(QColor(255, 255, 255) if mark is handle else _COLOUR)
            mark.setIconSize(size_px)
            mark.setPenWidth(3)
        return [footprint, heading, camera, handle]


def _pixel(canvas: QgsMapCanvas, lat_deg: float, lon_deg: float) -> QgsPointXY | None:
    """Pixel of a place on the canvas; None if the map's CRS cannot show it."""
    transform = to_lon_lat(canvas.mapSettings().destinationCrs(), QgsProject.instance())
    try:
        there = transform.transform(QgsPointXY(lon_deg, lat_deg), Qgis.TransformDirection.Reverse)
    except QgsCsException:
        return None
    if not (math.isfinite(there.x()) and math.isfinite(there.y())):
        return None
    return canvas.getCoordinateTransform().transform(there)
