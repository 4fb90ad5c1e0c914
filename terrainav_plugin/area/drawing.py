"""Drawing polygons on the map, corner by corner."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsCsException,
    QgsGeometry,
    QgsPointXY,
    QgsProject,
)
from qgis.gui import QgsMapCanvas, QgsMapMouseEvent, QgsRubberBand
from qgis.PyQt.QtCore import QEvent, QObject, QPoint, Qt, pyqtSignal
from qgis.PyQt.QtGui import QKeyEvent

from ...core.errors import InvalidInput, TerrAInavError
from ...core.geodesy.projections import geodesics
from ...core.mission.areas.area import Polygon, check_rings
from ..compat import POINT, POLYGON
from ..i18n import capitalized, tr, translate
from ..map.canvas import TemporaryTool
from ..units import METRES, area_text, length_text
from .bands import AREA_COLOURS, BandColours, PointerText, area_band, corner_band
from .corners import LEAST_CORNERS, pointed
from .layers import polygon_of_rings
from .outline import point_lon_lat

_FINISH = (Qt.Key.Key_Return, Qt.Key.Key_Enter)


class PolygonTool(TemporaryTool):
    """Draw a polygon: a click adds a corner; a double click, a right click or Enter finishes.

    Backspace removes the last corner. A corner that would make the outline cross itself is refused.

    Parameters
    ----------
    colours : BandColours
        Colours of the polygon.
    hint : str
        Text shown at the pointer until the first click.

    Signals
    -------
    drawn(object)
        The `Polygon`, after the tool has left the canvas.
    refused(str)
        Why a corner or an outline is invalid.

    Attributes
    ----------
    length_unit : str
        Unit of sizes shown at the pointer.
    accept : callable
        Called with the polygon before the tool ends; if it raises InvalidInput, drawing continues.
    """

    drawn = pyqtSignal(object)
    refused = pyqtSignal(str)
    is_resumed = False

    def __init__(self, canvas: QgsMapCanvas, hint: str, colours: BandColours = AREA_COLOURS) -> None:
        super().__init__(canvas)
        self.length_unit = METRES
        self.accept: Callable[[Polygon], object] = lambda _polygon: None
        self._hint, self._colours = hint, colours
        #: Corners in the canvas's CRS, in which edges are straight.
        self._corners: list[QgsPointXY] = []
        self._crs = QgsCoordinateReferenceSystem()
        self._at: QPoint | None = None
        self._bands: list[QgsRubberBand] = []
        self._readout = PointerText(canvas)
        self._is_down = self._leaving = self._last_refused = False
        self._finished: Polygon | None = None

    # --- starting and stopping

    def activate(self) -> None:
        """Begin drawing."""
        super().activate()
        canvas = self.canvas()
        self._crs = canvas.mapSettings().destinationCrs()
        canvas.destinationCrsChanged.connect(self._follow_crs)
        canvas.extentsChanged.connect(self._draw)

    def deactivate(self) -> None:
        """Discard an unfinished polygon."""
        canvas = self.canvas()
        canvas.extentsChanged.disconnect(self._draw)
        canvas.destinationCrsChanged.disconnect(self._follow_crs)
        self._clear()
        self._is_down = self._leaving = self._last_refused = False
        self._finished = None
        super().deactivate()

    def give_up(self) -> None:
        """Discard the drawing and leave the tool."""
        self._clear()
        self._leave()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Remove corners and finish by keys, even if these are shortcuts of the window."""
        if isinstance(event, QKeyEvent) and event.key() in (
            Qt.Key.Key_Backspace,
            Qt.Key.Key_Delete,
            *_FINISH,
        ):
            if event.type() == QEvent.Type.ShortcutOverride:
                event.accept()
                return True
            if event.type() == QEvent.Type.KeyPress:
                if event.key() in _FINISH:
                    self._finish()
                elif self._corners:
                    self._corners.pop()
                    self._draw()
                return True
        return super().eventFilter(watched, event)

    # --- the mouse

    def canvasPressEvent(self, _event: QgsMapMouseEvent) -> None:
        """Note that a button is down."""
        self._is_down = True

    def canvasMoveEvent(self, event: QgsMapMouseEvent) -> None:
        """Update the outline."""
        self._at = event.pos()
        self._draw()

    def canvasReleaseEvent(self, event: QgsMapMouseEvent) -> None:
        """Add a corner, or finish."""
        self._is_down = False
        if self._leaving:
            # The tool could not be left before this release, which another tool would have received.
            self._leave()
        elif event.button() == Qt.MouseButton.LeftButton:
            self._add(event.pos())
        elif event.button() == Qt.MouseButton.RightButton:
            self._finish()

    def canvasDoubleClickEvent(self, event: QgsMapMouseEvent) -> None:
        """Finish; the first of the two clicks has added the last corner."""
        self._is_down = True
        if event.button() == Qt.MouseButton.LeftButton and not self._last_refused:
            self._finish()

    # --- implementation

    def _add(self, at: QPoint) -> None:
        self._at, self._last_refused = at, False
        point = self.toMapCoordinates(at)
        # Ignore a corner within 2 px of the last one: it is the second click of a double click.
        if self._corners and self._pixels(self._corners[-1], point) < 2.0:
            return
        if point_lon_lat(point, self._crs, QgsProject.instance()) is None:
            self._refuse(tr("this place is outside the map"))
        elif not _is_simple([*self._corners, point]):
            self._refuse(tr("the outline would cross itself"))
        else:
            self._corners.append(point)
            self._draw()

    def _finish(self) -> None:
        try:
            polygon = self._polygon(self._corners)
            self.accept(polygon)
        except (TerrAInavError, QgsCsException) as wrong:
            self._refuse(translate(wrong))
            return
        self._clear()
        self._finished = polygon
        self._leave()

    def _leave(self) -> None:
        """Leave the canvas once no button is down, then emit the polygon."""
        self._leaving = self._is_down
        if self._leaving:
            return
        polygon = self._finished
        self.stop()
        if polygon is not None:
            self.drawn.emit(polygon)

    def _polygon(self, corners: list[QgsPointXY]) -> Polygon:
        """Polygon with the drawn edges; raises InvalidInput if the corners form no polygon."""
        if len(corners) < LEAST_CORNERS:
            raise InvalidInput(tr("a polygon needs at least 3 corners"))
        ring = [*corners, corners[0]]
        if not QgsGeometry.fromPolygonXY([ring]).isGeosValid():
            raise InvalidInput(tr("the outline would cross itself"))
        context = QgsProject.instance().transformContext()
        found = polygon_of_rings([ring], self._crs, context, tr("outline"), self._tolerance_m(corners[0]))
        polygon = Polygon(tuple(tuple(pointed(*corner) for corner in ring) for ring in found.rings))
        check_rings(polygon)
        return polygon

    def _tolerance_m(self, point: QgsPointXY) -> float:
        """Size of half a screen pixel on the ground, in metres."""
        unit = self.canvas().mapUnitsPerPixel()
        # The polygon's edges deviate from the drawn edges by at most half a pixel.
        return 0.5 * self._length_m(point, QgsPointXY(point.x() + unit, point.y()))

    def _length_m(self, start: QgsPointXY, end: QgsPointXY) -> float:
        """Length on the ground in metres; 0 outside the domain of the CRS."""
        places = [point_lon_lat(point, self._crs, QgsProject.instance()) for point in (start, end)]
        if None in places:
            return 0.0
        (lon0, lat0), (lon1, lat1) = places
        return float(np.asarray(geodesics(lat0, lon0, lat1, lon1)[2]))

    def _pixels(self, one: QgsPointXY, other: QgsPointXY) -> float:
        return one.distance(other) / self.canvas().mapUnitsPerPixel()

    def _refuse(self, reason: str) -> None:
        self._last_refused = True
        if self._at is not None:
            self._readout.say(capitalized(reason), self._at)
        self.refused.emit(reason)

    def _draw(self) -> None:
        """Draw the outline up to the pointer, and show its size there."""
        if self._leaving:
            return
        pointer = [] if self._at is None else [self.toMapCoordinates(self._at)]
        if not self._bands:
            self._bands = [
                area_band(self.canvas(), POLYGON, self._colours),
                corner_band(self.canvas(), self._colours),
            ]
        outline, corners = self._bands
        outline.reset(POLYGON)
        corners.reset(POINT)
        drawn = [*self._corners, *pointer]
        for point in drawn:
            outline.addPoint(point, point is drawn[-1])
        for point in self._corners:
            corners.addPoint(point, point is self._corners[-1])
        if self._at is not None:
            self._readout.say(self._readout_text(pointer[0]), self._at)

    def _readout_text(self, pointer: QgsPointXY) -> str:
        """Text with the length of the current edge, and the size of the polygon."""
        if not self._corners:
            return self._hint
        corners = [*self._corners, pointer]
        if not _is_simple(corners):
            return capitalized(tr("the outline would cross itself"))
        length = length_text(self._length_m(self._corners[-1], pointer), self.length_unit)
        try:
            size = area_text(self._polygon(corners).area_m2(), self.length_unit)
        except (TerrAInavError, QgsCsException):
            return length
        return f"{length}, {size}"

    def _follow_crs(self) -> None:
        """Transform the corners to a new CRS of the canvas; discard the drawing if one is outside its domain."""
        before, self._crs = self._crs, self.canvas().mapSettings().destinationCrs()
        transform = QgsCoordinateTransform(before, self._crs, QgsProject.instance())
        try:
            self._corners = [transform.transform(point) for point in self._corners]
        except QgsCsException:
            self._corners = []
        self._draw()

    def _clear(self) -> None:
        self._corners, self._at = [], None
        self._readout.clear()
        for band in self._bands:
            self.canvas().scene().removeItem(band)
        self._bands = []


def _is_simple(corners: list[QgsPointXY]) -> bool:
    """Whether a line through the corners does not touch itself."""
    return len(corners) <= LEAST_CORNERS - 1 or QgsGeometry.fromPolylineXY(corners).isSimple()
