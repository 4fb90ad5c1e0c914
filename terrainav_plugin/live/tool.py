"""The map tool that moves and turns a camera."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from qgis.core import QgsCsException, QgsPointXY, QgsProject
from qgis.gui import QgsMapCanvas, QgsMapMouseEvent
from qgis.PyQt.QtCore import QEvent, QObject, QPoint, Qt, pyqtSignal
from qgis.PyQt.QtGui import QKeyEvent, QWheelEvent

from ...core.errors import TerrAInavError
from ..i18n import translate
from ..map.canvas import TemporaryTool, canvas_lon_lat
from .marks import HANDLE_PX

if TYPE_CHECKING:
    from .marks import CameraMarks

#: Distance in screen pixels within which the pointer grips the camera or its handle.
_REACH_PX = 12.0
#: Turn by a notch of the wheel or an arrow key; with Shift, the fine one.
_TURN_DEG, _FINE_DEG = 5.0, 1.0
#: Forward and turn, in steps, by key.
_STEPS = {
    Qt.Key.Key_Up: (1.0, 0.0),
    Qt.Key.Key_Down: (-1.0, 0.0),
    Qt.Key.Key_Left: (0.0, -1.0),
    Qt.Key.Key_Right: (0.0, 1.0),
}
#: Pixels on the screen by which a key moves the camera; with Shift, the fine step.
_MOVE_PX, _FINE_PX = 20.0, 4.0


class CameraTool(TemporaryTool):
    """Drag the camera, or press anywhere, to move it; drag its handle, or use the wheel over it, to turn it.

    With the keyboard on the map, arrow keys move and turn the camera.

    Signals
    -------
    moved(float, float)
        Latitude and longitude in degrees.
    turned(float)
        Yaw in degrees.
    refused(str)
        Why a place cannot be used.
    """

    moved = pyqtSignal(float, float)
    turned = pyqtSignal(float)
    refused = pyqtSignal(str)

    def __init__(self, canvas: QgsMapCanvas, marks: CameraMarks) -> None:
        super().__init__(canvas)
        self._marks = marks
        #: Offset of the camera from the pointer that drags it, in pixels; None if nothing, or the handle, is dragged.
        self._offset_px: tuple[float, float] | None = None
        self._turns = False
        self._pressed_at = QPoint()
        self._yaw_deg = 0.0

    def set_yaw(self, yaw_deg: float) -> None:
        """Set the yaw from which keys and the wheel turn the camera."""
        self._yaw_deg = yaw_deg

    def canvasPressEvent(self, event: QgsMapMouseEvent) -> None:
        """Grip the handle or the camera, or move the camera to the pointer."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        x, y = event.pos().x(), event.pos().y()
        self._pressed_at = event.pos()
        if self._is_near(self._marks.handle, x, y):
            self._turns = True
            return
        compass = self._marks.compass
        gripped = compass is not None and self._is_near((compass.x, compass.y), x, y)
        self._offset_px = (compass.x - x, compass.y - y) if gripped else (0.0, 0.0)
        if not gripped:
            self._move(x, y)

    def canvasMoveEvent(self, event: QgsMapMouseEvent) -> None:
        """Move or turn what is dragged."""
        self._drag(event.pos().x(), event.pos().y())

    def _drag(self, x: int, y: int) -> None:
        compass = self._marks.compass
        if self._turns and compass is not None:
            self.turned.emit(compass.yaw_deg(x, y))
        elif self._offset_px is not None:
            self._move(x + self._offset_px[0], y + self._offset_px[1])

    def canvasReleaseEvent(self, event: QgsMapMouseEvent) -> None:
        """Let go."""
        if event.button() == Qt.MouseButton.LeftButton:
            # The last moves may have been joined with the release.
            if event.pos() != self._pressed_at:
                self._drag(event.pos().x(), event.pos().y())
            self._offset_px, self._turns = None, False

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Turn the camera if the pointer is over it; otherwise leave the wheel to the map."""
        at, compass = event.position(), self._marks.compass
        over = compass is not None and math.hypot(at.x() - compass.x, at.y() - compass.y) <= HANDLE_PX + _REACH_PX
        # With Alt or a horizontal wheel, the turn is sideways.
        turn = event.angleDelta().y() or event.angleDelta().x()
        if not over or not turn:
            event.ignore()
            return
        event.accept()
        fine = event.modifiers() & Qt.KeyboardModifier.ShiftModifier
        # A notch is 120 eighths of a degree.
        self.turned.emit(self._yaw_deg + turn / 120.0 * (_FINE_DEG if fine else _TURN_DEG))

    def deactivate(self) -> None:
        """Let go."""
        self._offset_px, self._turns = None, False
        super().deactivate()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Handle arrow keys."""
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress and self._step(event):
            return True
        return super().eventFilter(watched, event)

    def _step(self, event: QKeyEvent) -> bool:
        """Move or turn by a key; False for keys of the map."""
        forward, turn = _STEPS.get(event.key(), (0.0, 0.0))
        compass = self._marks.compass
        if compass is None or not (forward or turn):
            return False
        fine = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        if turn:
            self.turned.emit(self._yaw_deg + turn * (_FINE_DEG if fine else _TURN_DEG))
        else:
            self._move(*compass.ahead(self._yaw_deg, forward * (_FINE_PX if fine else _MOVE_PX)))
        return True

    @staticmethod
    def _is_near(target: tuple[float, float] | None, x: float, y: float) -> bool:
        return target is not None and math.hypot(target[0] - x, target[1] - y) <= _REACH_PX

    def _move(self, x: float, y: float) -> None:
        there: QgsPointXY = self.canvas().getCoordinateTransform().toMapCoordinatesF(x, y)
        try:
            lon, lat = canvas_lon_lat(there, self.canvas().mapSettings().destinationCrs(), QgsProject.instance())
        except (TerrAInavError, QgsCsException) as wrong:
            self.refused.emit(translate(wrong))
            return
        self.moved.emit(lat, lon)
