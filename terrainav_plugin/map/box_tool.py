"""Drawing the area on the map: press, drag, release."""

from __future__ import annotations

from qgis.core import QgsCsException, QgsPointXY, QgsProject, QgsRectangle
from qgis.gui import QgsMapCanvas, QgsMapMouseEvent, QgsRubberBand
from qgis.PyQt.QtCore import QPoint, Qt, pyqtSignal
from qgis.PyQt.QtWidgets import QApplication

from ...core.errors import TerrAInavError
from ...core.mission.area import Box
from ..compat import POLYGON
from ..form.area import size_text
from ..i18n import told
from .area_bands import Readout, area_band
from .canvas import TemporaryTool, box_of


class BoxTool(TemporaryTool):
    """Draws a box on the canvas and tells its longitudes and latitudes, whatever the project's CRS.

    Signals
    -------
    drawn(object)
        The `Box`, once the mouse is released.
    refused(str)
        Why a rectangle makes no box.
    """

    drawn = pyqtSignal(object)
    refused = pyqtSignal(str)

    def __init__(self, canvas: QgsMapCanvas) -> None:
        super().__init__(canvas)
        self._band: QgsRubberBand | None = None
        self._readout = Readout(canvas)
        self._pressed_at: QPoint | None = None
        self._start: QgsPointXY | None = None
        self._given_up = False

    def canvasPressEvent(self, event: QgsMapMouseEvent) -> None:
        """Start a box."""
        if event.button() == Qt.MouseButton.LeftButton:
            self._pressed_at = event.pos()
            # In map units, so that zooming with the wheel meanwhile moves the corner with the map.
            self._start = self.toMapCoordinates(event.pos())

    def canvasMoveEvent(self, event: QgsMapMouseEvent) -> None:
        """Stretch the box."""
        if self._pressed_at is not None:
            self._show(self._rectangle(event.pos()))
            self._say_size(event.pos())

    def canvasReleaseEvent(self, event: QgsMapMouseEvent) -> None:
        """Finish the box; a click without a drag draws none."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        if self._pressed_at is None:
            if self._given_up:
                self.stop()
            return
        moved = (event.pos() - self._pressed_at).manhattanLength()
        rectangle = self._rectangle(event.pos())
        if moved < QApplication.startDragDistance() or rectangle.width() == 0 or rectangle.height() == 0:
            self._clear()
            return
        try:
            box = self._box(event.pos())
        except (TerrAInavError, QgsCsException) as wrong:
            self.refused.emit(told(wrong))
            return
        finally:
            self._clear()
        self.stop()
        self.drawn.emit(box)

    def give_up(self) -> None:
        """Drop the box; the tool stays until the mouse button is up, which another tool would take for its own."""
        if self._pressed_at is None:
            self.stop()
        else:
            self._clear()
            self._given_up = True

    def deactivate(self) -> None:
        """Leave no half-drawn box."""
        self._clear()
        self._given_up = False
        super().deactivate()

    def _rectangle(self, released_at: QPoint) -> QgsRectangle:
        return QgsRectangle(self._start, self.toMapCoordinates(released_at))

    def _show(self, rectangle: QgsRectangle) -> None:
        if self._band is None:
            self._band = area_band(self.canvas())
        self._band.reset(POLYGON)
        west, south, east, north = (
            rectangle.xMinimum(),
            rectangle.yMinimum(),
            rectangle.xMaximum(),
            rectangle.yMaximum(),
        )
        for x, y in ((west, south), (east, south), (east, north)):
            self._band.addPoint(QgsPointXY(x, y), False)
        self._band.addPoint(QgsPointXY(west, north), True)

    def _say_size(self, at: QPoint) -> None:
        """Say beside the pointer how large the box would be; nothing where there is none."""
        try:
            text = size_text(self._box(at))
        except (TerrAInavError, QgsCsException):
            text = ""
        self._readout.say(text, at)

    def _box(self, at: QPoint) -> Box:
        return box_of(
            self._rectangle(at), self.canvas().mapSettings().destinationCrs(), QgsProject.instance()
        )

    def _clear(self) -> None:
        self._readout.clear()
        self._pressed_at = self._start = None
        if self._band is not None:
            self.canvas().scene().removeItem(self._band)
            self._band = None
