"""The height profile as a diagram with a cursor, zoomed and panned along the distance. Drawn with Qt only."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from qgis.PyQt.QtCore import QEvent, QPointF, QRectF, QSize, Qt, pyqtSignal
from qgis.PyQt.QtGui import (
    QColor,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QPolygonF,
    QResizeEvent,
    QWheelEvent,
)
from qgis.PyQt.QtWidgets import QApplication, QSizePolicy, QWidget

from ...core.mission.flight.path import CAPTURE
from ...core.mission.profile import HeightProfile
from ...core.units import M_PER_FT
from ..i18n import number_text, tr
from ..units import FEET

if TYPE_CHECKING:
    from ...core.arrays import Floats

_TICK_PX, _GAP_PX = 4, 3
#: Colours of Okabe and Ito, distinct for all kinds of colour vision, on light and on dark windows.
FLIGHT, SURFACE, GROUND, CLEARANCE = QColor("#0072b2"), QColor("#009e73"), QColor("#8a6d4b"), QColor("#d55e00")
_FLIGHT_ON_DARK, _GROUND_ON_DARK = QColor("#56b4e9"), QColor("#c9a97f")
#: Least part of the flight that is seen, in metres.
_LEAST_SEEN_M = 5.0
_ZOOM_STEP = 1.25
_METRES_PER_KM, _FT_PER_MILE = 1000.0, 5280.0


class ProfileChart(QWidget):
    """Heights of flight, surface and ground over the distance flown.

    Signals
    -------
    pointed(int)
        Point of the profile under the cursor; -1 if there is none.
    chosen(int)
        Point that the user has clicked, or chosen by Enter.

    Attributes
    ----------
    look : QWidget
        Widget whose text colour to use: QGIS themes are style sheets, which do not change a plain widget's palette.
    profile : HeightProfile or None
    at : int
        Point under the cursor; -1 if there is none.
    seen_m : (float, float)
        Distances between which the flight is seen.
    """

    pointed = pyqtSignal(int)
    chosen = pyqtSignal(int)

    def __init__(self, look: QWidget) -> None:
        super().__init__()
        self.setObjectName("profile_chart")
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        self.setAccessibleName(tr("Height profile"))
        self.setToolTip(
            tr(
                "A click shows the place on the map, the wheel zooms, dragging pans, and a double click shows the "
                "whole flight.\n"
                "Arrow keys move the cursor, Page keys from image to image, Enter shows the place, + and - zoom, "
                "Esc shows the whole flight."
            )
        )
        self.look = look
        self.profile: HeightProfile | None = None
        self.unit = "m"
        self.at = -1
        self.seen_m = 0.0, 1.0
        self._hint = ""
        self._part: HeightProfile | None = None
        #: Lowest and highest height that is seen, in metres, with some room.
        self._heights_m = 0.0, 1.0
        self._pressed: QPointF | None = None
        self._drags = False

    def show_profile(self, profile: HeightProfile, unit: str) -> None:
        """Show a profile in metres or feet; what is seen stays if the flight is as long as before."""
        same = self.profile is not None and abs(self.profile.length_m - profile.length_m) < 0.5
        self.profile, self.unit, self._hint = profile, unit, ""
        self._point(-1)
        self._see(*self.seen_m) if same else self.show_whole()

    def show_hint(self, text: str) -> None:
        """Show a text instead of a profile."""
        self.profile, self._part, self._hint = None, None, text
        self._point(-1)
        self.update()

    def clear_cursor(self) -> None:
        """Remove the cursor."""
        self._point(-1)

    def show_whole(self) -> None:
        """See the whole flight."""
        if self.profile is not None:
            self._see(0.0, self.profile.length_m)

    def show_lowest(self) -> None:
        """Move the cursor to the least clearance, and choose the place."""
        if self.profile is not None and self.profile.lowest is not None:
            self._go(self.profile.lowest)
            self.chosen.emit(self.at)

    def frame(self) -> QRectF:
        """Rectangle of the plot."""
        metrics = self.fontMetrics()
        widest = max((metrics.horizontalAdvance(text) for _, text in self._height_ticks()), default=0)
        left = widest + _TICK_PX + 2 * _GAP_PX + metrics.height()
        below = 2 * metrics.height() + _TICK_PX + _GAP_PX
        top, right = float(_GAP_PX + metrics.height() // 2), self.width() - 2.0 * metrics.horizontalAdvance("0")
        return QRectF(left, top, max(right - left, 1.0), max(self.height() - below - top, 1.0))

    def x_px(self, distance_m: float) -> float:
        """Position of a distance."""
        frame, (first, last) = self.frame(), self.seen_m
        return frame.left() + (distance_m - first) / (last - first) * frame.width()

    def distance_m(self, x_px: float) -> float:
        """Distance at a position."""
        frame, (first, last) = self.frame(), self.seen_m
        return first + (x_px - frame.left()) / frame.width() * (last - first)

    def sizeHint(self) -> QSize:
        """Enough room to show the shape of the ground."""
        return QSize(600, 170)

    def minimumSizeHint(self) -> QSize:
        """Enough room for the axes and the lines."""
        return QSize(200, 5 * self.fontMetrics().height())

    # --- what is seen

    def _see(self, first_m: float, last_m: float) -> None:
        """See the flight between two distances, within its length."""
        if self.profile is None:
            return
        length = max(self.profile.length_m, _LEAST_SEEN_M)
        wide = min(max(last_m - first_m, _LEAST_SEEN_M), length)
        first = min(max(first_m, 0.0), length - wide)
        self.seen_m = first, first + wide
        self._cut()
        self.update()

    def _cut(self) -> None:
        """Keep what is seen, in about four points for each pixel."""
        if self.profile is None:
            return
        part = self._part = self.profile.part(*self.seen_m, 4 * max(self.width(), 100))
        values = np.concatenate([part.height_m, part.ground_m, part.surface_m])
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        room = 0.08 * max(high - low, 1.0)
        self._heights_m = low - room, high + room

    def _zoom(self, factor: float, around_m: float) -> None:
        first, last = self.seen_m
        self._see(around_m - (around_m - first) / factor, around_m + (last - around_m) / factor)

    def _point(self, at: int) -> None:
        """Move the cursor to a point; -1 removes it."""
        if at != self.at:
            self.at = at
            self.pointed.emit(at)
            self.update()

    def _nearest(self, distance_m: float) -> int:
        """Point nearest to a distance."""
        if self.profile is None:
            return -1
        along = self.profile.distance_m
        after = min(int(np.searchsorted(along, distance_m)), len(along) - 1)
        before = max(after - 1, 0)
        return before if abs(along[before] - distance_m) < abs(along[after] - distance_m) else after

    # --- mouse and keyboard

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin a click, or dragging."""
        if event.button() == Qt.MouseButton.LeftButton and self.profile is not None:
            self._pressed, self._drags = QPointF(event.pos()), False

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Move the cursor, or drag."""
        if self.profile is None:
            return
        x = float(event.pos().x())
        if self._pressed is not None:
            moved = x - self._pressed.x()
            self._drags = self._drags or abs(moved) >= QApplication.startDragDistance()
            if self._drags:
                first, last = self.seen_m
                by_m = moved / self.frame().width() * (last - first)
                self._see(first - by_m, last - by_m)
                self._pressed.setX(x)
        self._point(self._nearest(self.distance_m(x)))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Choose the place that was clicked."""
        if event.button() != Qt.MouseButton.LeftButton or self._pressed is None:
            return
        self._pressed = None
        if not self._drags and self.profile is not None:
            self._point(self._nearest(self.distance_m(float(event.pos().x()))))
            self.chosen.emit(self.at)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """See the whole flight."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.show_whole()

    def leaveEvent(self, event: QEvent) -> None:
        """Remove the cursor."""
        super().leaveEvent(event)
        if not self.hasFocus():
            self._point(-1)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom about the mouse."""
        turned = event.angleDelta().y()
        if self.profile is None or not turned:
            event.ignore()
            return
        self._zoom(_ZOOM_STEP ** (turned / 120.0), self.distance_m(float(event.position().x())))
        event.accept()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Move the cursor, choose its place, or zoom, by key."""
        profile, key = self.profile, event.key()
        if profile is None:
            super().keyPressEvent(event)
            return
        far = 10.0 if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1.0
        steps = {Qt.Key.Key_Left: -far, Qt.Key.Key_Down: -far, Qt.Key.Key_Right: far, Qt.Key.Key_Up: far}
        ends = {Qt.Key.Key_Home: 0, Qt.Key.Key_End: len(profile) - 1}
        zooms = {Qt.Key.Key_Plus: _ZOOM_STEP, Qt.Key.Key_Equal: _ZOOM_STEP, Qt.Key.Key_Minus: 1.0 / _ZOOM_STEP}
        if key in steps:
            self._step(steps[key])
        elif key in (Qt.Key.Key_PageUp, Qt.Key.Key_PageDown):
            self._step_image(forward=key == Qt.Key.Key_PageUp)
        elif key in ends:
            self._go(ends[key])
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            if self.at >= 0:
                self.chosen.emit(self.at)
        elif key in zooms:
            around = float(profile.distance_m[self.at]) if self.at >= 0 else sum(self.seen_m) / 2.0
            self._zoom(zooms[key], around)
        elif key == Qt.Key.Key_Escape:
            self.show_whole()
        else:
            super().keyPressEvent(event)

    def _step(self, pixels: float) -> None:
        """Move the cursor by pixels, and at least to the next point."""
        profile = self.profile
        if profile is None:
            return
        if self.at < 0:
            self._go(self._nearest(self.seen_m[0]))
            return
        first, last = self.seen_m
        by_m = pixels * (last - first) / self.frame().width()
        at = self._nearest(float(profile.distance_m[self.at]) + by_m)
        least = self.at + (1 if pixels > 0.0 else -1)
        at = max(at, least) if pixels > 0.0 else min(at, least)
        self._go(min(max(at, 0), len(profile) - 1))

    def _step_image(self, *, forward: bool) -> None:
        profile = self.profile
        if profile is None:
            return
        images = np.flatnonzero(profile.kind == CAPTURE)
        others = images[images > self.at] if forward else images[images < self.at]
        if len(others):
            self._go(int(others[0] if forward else others[-1]))

    def _go(self, at: int) -> None:
        """Move the cursor to a point, and see it."""
        if self.profile is None:
            return
        distance, (first, last) = float(self.profile.distance_m[at]), self.seen_m
        if not first <= distance <= last:
            self._see(distance - (last - first) / 2.0, distance + (last - first) / 2.0)
        self._point(at)

    # --- drawing

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Draw as many points as there is room for."""
        super().resizeEvent(event)
        self._cut()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: ARG002  Qt passes it
        """Paint."""
        painter = QPainter(self)
        self.paint_on(painter)

    def paint_on(self, painter: QPainter) -> None:
        """Paint the diagram, or the hint."""
        text = self.look.palette().windowText().color()
        if self._part is None:
            painter.setPen(text)
            flags = int(Qt.AlignmentFlag.AlignCenter) | int(Qt.TextFlag.TextWordWrap)
            painter.drawText(self.rect().adjusted(_GAP_PX, _GAP_PX, -_GAP_PX, -_GAP_PX), flags, self._hint)
            return
        # Grey while a newer profile is being worked out.
        painter.setOpacity(1.0 if self.isEnabled() else 0.35)
        frame = self.frame()
        self._paint_axes(painter, frame, text)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.save()
        painter.setClipRect(frame)
        self._paint_lines(painter, frame, self._part)
        self._paint_lowest(painter, frame)
        self._paint_cursor(painter, frame, text)
        painter.restore()
        if self.hasFocus():
            painter.setPen(QPen(self.look.palette().highlight().color(), 1.0))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(frame)

    def colours(self) -> tuple[QColor, QColor, QColor]:
        """Colours of flight, surface and ground, for a light or a dark window."""
        is_dark = self.look.palette().windowText().color().lightnessF() > 0.5
        return (_FLIGHT_ON_DARK if is_dark else FLIGHT), SURFACE, (_GROUND_ON_DARK if is_dark else GROUND)

    def y_px(self, height_m: float) -> float:
        """Position of a height."""
        frame, (low, high) = self.frame(), self._heights_m
        return frame.bottom() - (height_m - low) / (high - low) * frame.height()

    def _unit_m(self) -> float:
        return M_PER_FT if self.unit == FEET else 1.0

    def _height_ticks(self) -> list[tuple[float, str]]:
        low, high = self._heights_m
        count = max(int(self.height() / (2.5 * self.fontMetrics().height())), 2)
        return _ticks(low, high, self._unit_m(), count)

    def _distance_unit(self) -> tuple[float, str]:
        """Unit of the distance: its size in metres, and its name."""
        wide = self.seen_m[1] - self.seen_m[0]
        small = self._unit_m()
        large, name = (_FT_PER_MILE * small, "mi") if self.unit == FEET else (_METRES_PER_KM, "km")
        return (large, name) if wide >= 2.0 * large else (small, self.unit)

    def _paint_axes(self, painter: QPainter, frame: QRectF, text: QColor) -> None:
        metrics = self.fontMetrics()
        faint = QColor(text)
        faint.setAlphaF(0.16)
        for height, label in self._height_ticks():
            y = self.y_px(height)
            painter.setPen(faint)
            painter.drawLine(QPointF(frame.left() - _TICK_PX, y), QPointF(frame.right(), y))
            painter.setPen(text)
            x = frame.left() - _TICK_PX - _GAP_PX - metrics.horizontalAdvance(label)
            painter.drawText(QPointF(x, y + metrics.ascent() / 2.0 - 1.0), label)
        size_m, name = self._distance_unit()
        count = max(int(frame.width() / (8 * metrics.averageCharWidth())), 2)
        for distance, label in _ticks(*self.seen_m, size_m, count):
            x = self.x_px(distance)
            painter.setPen(faint)
            painter.drawLine(QPointF(x, frame.top()), QPointF(x, frame.bottom() + _TICK_PX))
            painter.setPen(text)
            at = x - metrics.horizontalAdvance(label) / 2.0
            painter.drawText(QPointF(at, frame.bottom() + _TICK_PX + metrics.ascent()), label)
        across = tr("Distance flown ({unit})").format(unit=name)
        up = tr("Height ({unit})").format(unit=self.unit)
        middle = frame.center().x() - metrics.horizontalAdvance(across) / 2.0
        painter.drawText(QPointF(middle, self.height() - metrics.descent() - 1.0), across)
        painter.save()
        painter.translate(metrics.ascent() + 1.0, frame.center().y() + metrics.horizontalAdvance(up) / 2.0)
        painter.rotate(-90.0)
        painter.drawText(QPointF(0.0, 0.0), up)
        painter.restore()

    def _paint_lines(self, painter: QPainter, frame: QRectF, part: HeightProfile) -> None:
        flight, surface, ground = self.colours()
        (first, last), (low, high) = self.seen_m, self._heights_m
        x = frame.left() + (part.distance_m - first) / (last - first) * frame.width()

        def y_of(heights: Floats) -> Floats:
            return frame.bottom() - (heights - low) / (high - low) * frame.height()

        soil = QColor(ground)
        soil.setAlphaF(0.35)
        new_sortie = np.flatnonzero(np.diff(part.sortie)) + 1
        painter.setPen(QPen(self.look.palette().windowText().color(), 1.0, Qt.PenStyle.DotLine))
        for start in new_sortie.tolist():
            painter.drawLine(QPointF(x[start], frame.top()), QPointF(x[start], frame.bottom()))
        for line in _runs(x, y_of(part.ground_m), new_sortie):
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(soil)
            feet = [QPointF(line[-1].x(), frame.bottom()), QPointF(line[0].x(), frame.bottom())]
            painter.drawPolygon(QPolygonF([*line, *feet]))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(ground, 1.5))
            painter.drawPolyline(QPolygonF(line))
        if part.has_surface:
            painter.setPen(QPen(surface, 1.3))
            for line in _runs(x, y_of(part.surface_m), new_sortie):
                painter.drawPolyline(QPolygonF(line))
        painter.setPen(QPen(flight, 2.0))
        for line in _runs(x, y_of(part.height_m), new_sortie):
            painter.drawPolyline(QPolygonF(line))
        self._paint_images(painter, frame, flight)

    def _paint_images(self, painter: QPainter, frame: QRectF, colour: QColor) -> None:
        """Draw a dot for each image, if all are known and their dots do not touch each other."""
        profile = self.profile
        if profile is None:
            return
        some = slice(*np.searchsorted(profile.distance_m, self.seen_m))
        images = np.flatnonzero(profile.kind[some] == CAPTURE) + some.start
        if not len(images) or len(images) * 7.0 > frame.width():
            return
        if profile.image[images[-1]] - profile.image[images[0]] >= len(images):
            return
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(colour)
        for image in images.tolist():
            at = QPointF(self.x_px(float(profile.distance_m[image])), self.y_px(float(profile.height_m[image])))
            painter.drawEllipse(at, 3.0, 3.0)

    def _paint_lowest(self, painter: QPainter, frame: QRectF) -> None:
        """Mark the least clearance by a line from surface to flight, and a triangle."""
        profile = self.profile
        if profile is None or profile.lowest is None:
            return
        at = profile.lowest
        x, y = self.x_px(float(profile.distance_m[at])), self.y_px(float(profile.height_m[at]))
        if not frame.left() <= x <= frame.right():
            return
        painter.setPen(QPen(CLEARANCE, 2.0))
        painter.drawLine(QPointF(x, y), QPointF(x, self.y_px(float(profile.height_m[at] - profile.clearance_m[at]))))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(CLEARANCE)
        painter.drawPolygon(QPolygonF([QPointF(x, y - 1.0), QPointF(x - 6.0, y - 10.0), QPointF(x + 6.0, y - 10.0)]))

    def _paint_cursor(self, painter: QPainter, frame: QRectF, text: QColor) -> None:
        profile, at = self.profile, self.at
        if profile is None or at < 0:
            return
        x, y = self.x_px(float(profile.distance_m[at])), self.y_px(float(profile.height_m[at]))
        painter.setPen(QPen(text, 1.0))
        painter.drawLine(QPointF(x, frame.top()), QPointF(x, frame.bottom()))
        painter.setBrush(text)
        painter.drawEllipse(QPointF(x, y), 4.0, 4.0)


def _runs(x: Floats, y: Floats, breaks: Floats) -> list[list[QPointF]]:
    """Lines through points, cut at breaks and where a height is unknown."""
    found: list[list[QPointF]] = []
    for part_x, part_y in zip(np.split(x, breaks), np.split(y, breaks)):
        known = np.isfinite(part_y)
        edges = np.flatnonzero(np.diff(known)) + 1
        for some_x, some_y, some in zip(np.split(part_x, edges), np.split(part_y, edges), np.split(known, edges)):
            if len(some) and some[0]:
                found.append([QPointF(*at) for at in zip(some_x.tolist(), some_y.tolist())])
    return found


def _ticks(low_m: float, high_m: float, unit_m: float, most: int) -> list[tuple[float, str]]:
    """Positions in metres and texts of ticks, at steps of 1, 2 or 5 times a power of ten of a unit."""
    low, high = low_m / unit_m, high_m / unit_m
    rough = max((high - low) / most, 1e-3)
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * factor for factor in (1.0, 2.0, 5.0, 10.0) if power * factor >= rough * (1.0 - 1e-9))
    decimals = max(-math.floor(math.log10(step) + 1e-9), 0)
    numbers = range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)
    return [(number * step * unit_m, number_text(number * step, f",.{decimals}f")) for number in numbers]
