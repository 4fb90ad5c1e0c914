"""The map canvas: longitude and latitude on it in any CRS, and tools that restore the previous tool."""

from __future__ import annotations

import math
from collections.abc import Callable

from qgis.core import (
    Qgis,
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsCsException,
    QgsMapSettings,
    QgsPointXY,
    QgsProject,
    QgsRectangle,
)
from qgis.gui import QgsMapCanvas, QgsMapMouseEvent, QgsMapTool
from qgis.PyQt.QtCore import QDateTime, QEvent, QObject, Qt, QTimeZone, pyqtSignal
from qgis.PyQt.QtGui import QKeyEvent

from ...core.errors import InvalidInput, TerrAInavError
from ...core.mission.areas.area import Box
from ..i18n import tr, translate

LON_LAT = "EPSG:4326"


def to_lon_lat(crs: QgsCoordinateReferenceSystem, project: QgsProject) -> QgsCoordinateTransform:
    """Return the transformation from a CRS to longitude and latitude on WGS84."""
    return QgsCoordinateTransform(crs, QgsCoordinateReferenceSystem(LON_LAT), project.transformContext())


def canvas_lon_lat(point: QgsPointXY, crs: QgsCoordinateReferenceSystem, project: QgsProject) -> tuple[float, float]:
    """Longitude in [-180, 180) and latitude in degrees of a point on the canvas.

    Raises
    ------
    InvalidInput
        The place is outside the domain of the project's CRS.
    """
    lon, lat = _transformed(point, to_lon_lat(crs, project))
    return wrap_longitude(lon), lat


def wrap_longitude(lon_deg: float) -> float:
    """Longitude in [-180, 180)."""
    return lon_deg if -180.0 <= lon_deg < 180.0 else (lon_deg + 180.0) % 360.0 - 180.0


def rectangle_box(rectangle: QgsRectangle, crs: QgsCoordinateReferenceSystem, project: QgsProject) -> Box:
    """Smallest box around a rectangle of the canvas.

    The outline is sampled, as the sides may be curved. Across the antimeridian, the west of the box exceeds its east.

    Raises
    ------
    InvalidInput
        The rectangle leaves the domain of the project's CRS.
    """
    transform = to_lon_lat(crs, project)
    outline = [_transformed(point, transform) for point in _outline(rectangle)]
    return box_of_outline(outline, lambda: _transformed(rectangle.center(), transform)[1])


def box_of_outline(outline: list[tuple[float, float]], centre_lat_deg: Callable[[], float]) -> Box:
    """Smallest box around a closed outline of (longitude, latitude), with steps of less than half a turn.

    An outline that goes around the Earth contains the pole on the side of its centre.
    """
    lons = [outline[0][0]]
    for lon, _ in outline[1:]:
        lons.append(lon - 360.0 * round((lon - lons[-1]) / 360.0))
    lats = [lat for _, lat in outline]
    north, south, west, east = max(lats), min(lats), min(lons), max(lons)
    closing = lons[0] - 360.0 * round((lons[0] - lons[-1]) / 360.0)
    if abs(closing - lons[0]) > 180.0:
        if centre_lat_deg() > 0.0:
            north = 90.0
        else:
            south = -90.0
        return Box(north, -180.0, south, 180.0)
    return continuous_box(north, west, south, east)


def continuous_box(north_deg: float, west_deg: float, south_deg: float, east_deg: float) -> Box:
    """Box from longitudes that may continue across the antimeridian."""
    if east_deg - west_deg >= 360.0:
        return Box(north_deg, -180.0, south_deg, 180.0)
    turn = 360.0 * math.floor((west_deg + 180.0) / 360.0)
    west, east = west_deg - turn, east_deg - turn
    return Box(north_deg, west, south_deg, east - 360.0 if east > 180.0 else east)


def canvas_rectangle(box: Box, crs: QgsCoordinateReferenceSystem, project: QgsProject) -> QgsRectangle:
    """Rectangle of the canvas around a box; raises InvalidInput outside the domain of the CRS."""
    transform = to_lon_lat(crs, project)
    check_crs(transform)
    rectangle = QgsRectangle(*box.edges_deg)
    try:
        return transform.transformBoundingBox(rectangle, Qgis.TransformDirection.Reverse)
    except QgsCsException as wrong:
        raise InvalidInput(
            tr("this place cannot be shown in the project's CRS {crs}; choose another CRS").format(crs=_named(crs))
        ) from wrong


def is_in_sight(canvas: QgsMapCanvas, rectangle: QgsRectangle) -> bool:
    """Whether a rectangle in the canvas's CRS is visible: at least partly, and as more than a dot."""
    wide_px = max(rectangle.width(), rectangle.height()) / canvas.mapUnitsPerPixel()
    # A rectangle smaller than 6 px on the screen is a dot.
    return not 0.0 < wide_px < 6.0 and canvas.extent().intersects(rectangle)


def show_extent(canvas: QgsMapCanvas, rectangle: QgsRectangle, scale: float) -> None:
    """Move the map to a rectangle in the map's CRS, enlarged by ``scale``."""
    rectangle.scale(scale)
    canvas.setExtent(rectangle)
    canvas.refresh()


def shown_times_ms(settings: QgsMapSettings) -> tuple[float, float] | None:
    """First and last moment shown by the temporal controller, in milliseconds UTC; None if it shows all times."""
    if not settings.isTemporal():
        return None
    shown = settings.temporalRange()
    return _utc_ms(shown.begin(), -math.inf), _utc_ms(shown.end(), math.inf)


def _utc_ms(moment: QDateTime, otherwise: float) -> float:
    """Moment of the temporal controller, which has no time zones, in milliseconds UTC; ``otherwise`` if not set."""
    if not moment.isValid():
        return otherwise
    return float(QDateTime(moment.date(), moment.time(), QTimeZone.utc()).toMSecsSinceEpoch())


class TemporaryTool(QgsMapTool):
    """A map tool that restores the previous tool when it stops.

    Attributes
    ----------
    is_resumed : bool
        Whether a tool that is started from this one restores this one when it stops, and not the tool before.
    """

    is_resumed = True

    def __init__(self, canvas: QgsMapCanvas) -> None:
        super().__init__(canvas)
        self.setCursor(Qt.CursorShape.CrossCursor)
        self._previous: QgsMapTool | None = None

    def start(self) -> None:
        """Make this the tool of the canvas."""
        canvas = self.canvas()
        if canvas.mapTool() is not self:
            previous = canvas.mapTool()
            while isinstance(previous, TemporaryTool) and not previous.is_resumed:
                previous = previous._previous  # noqa: SLF001  of the same class
            self._previous = previous
            canvas.setMapTool(self)
        # Give the canvas the focus, so that it receives Esc.
        canvas.setFocus()

    def stop(self) -> None:
        """Restore the previous tool."""
        canvas, previous = self.canvas(), self._previous
        self._previous = None
        if canvas.mapTool() is self:
            canvas.unsetMapTool(self)
            if previous is not None:
                canvas.setMapTool(previous)

    def give_up(self) -> None:
        """Leave the tool, on Esc."""
        self.stop()

    def activate(self) -> None:
        """Also receive the canvas's keys."""
        super().activate()
        # While a mouse button is down, the canvas passes no keys to its tool.
        self.canvas().installEventFilter(self)

    def deactivate(self) -> None:
        """Stop receiving keys."""
        self.canvas().removeEventFilter(self)
        super().deactivate()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Handle Esc."""
        pressed = event.type() == QEvent.Type.KeyPress
        if pressed and isinstance(event, QKeyEvent) and event.key() == Qt.Key.Key_Escape:
            self.give_up()
            return True
        return super().eventFilter(watched, event)


class ClickTool(TemporaryTool):
    """Emit the places of clicks, in any project CRS, until another tool is chosen.

    Signals
    -------
    clicked(float, float)
        Latitude and longitude in degrees.
    refused(str)
        Why a place cannot be used.
    """

    clicked = pyqtSignal(float, float)
    refused = pyqtSignal(str)

    def canvasReleaseEvent(self, event: QgsMapMouseEvent) -> None:
        """Emit the place clicked."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        crs = self.canvas().mapSettings().destinationCrs()
        try:
            lon, lat = canvas_lon_lat(self.toMapCoordinates(event.pos()), crs, QgsProject.instance())
        except (TerrAInavError, QgsCsException) as wrong:
            self.refused.emit(translate(wrong))
            return
        self._take(lat, lon)

    def _take(self, lat_deg: float, lon_deg: float) -> None:
        self.clicked.emit(lat_deg, lon_deg)


def _outline(rectangle: QgsRectangle) -> list[QgsPointXY]:
    # With 64 points along a side, a parallel deviates by less than 1/16000 of the side between them.
    steps = [step / 64 for step in range(64)]
    west, south, east, north = (
        rectangle.xMinimum(),
        rectangle.yMinimum(),
        rectangle.xMaximum(),
        rectangle.yMaximum(),
    )
    corners = [(west, south), (east, south), (east, north), (west, north)]
    # Keep corners exact: interpolation would change their last digit.
    return [
        QgsPointXY(x0, y0) if step == 0.0 else QgsPointXY(x0 + step * (x1 - x0), y0 + step * (y1 - y0))
        for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1])
        for step in steps
    ]


def check_crs(transform: QgsCoordinateTransform, name: str = "") -> None:
    """Refuse a CRS without a transformation to degrees, as QGIS would take its coordinates for degrees.

    Raises InvalidInput.

    Parameters
    ----------
    name : str
        The CRS as entered, which may be unknown. If empty, a missing CRS is accepted, as in a new project.
    """
    crs = transform.sourceCrs()
    if not transform.isValid() and (name or crs.isValid()):
        raise InvalidInput(tr("CRS {crs}: must be one of the Earth, such as EPSG:4326").format(crs=name or _named(crs)))


def _transformed(point: QgsPointXY, transform: QgsCoordinateTransform) -> tuple[float, float]:
    check_crs(transform)
    try:
        there = transform.transform(point)
    except QgsCsException as wrong:
        raise _outside(transform) from wrong
    if not (math.isfinite(there.x()) and math.isfinite(there.y())) or abs(there.y()) > 90.0:
        raise _outside(transform)
    return there.x(), there.y()


def _outside(transform: QgsCoordinateTransform) -> InvalidInput:
    crs = _named(transform.sourceCrs())
    return InvalidInput(tr("this place is outside the domain of the project's CRS {crs}").format(crs=crs))


def _named(crs: QgsCoordinateReferenceSystem) -> str:
    return crs.authid() or crs.description() or tr("(custom)")
