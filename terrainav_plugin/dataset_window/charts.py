"""The paper's two charts, with a threshold that mouse and keyboard move. Drawn with Qt only."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from qgis.PyQt.QtCore import QPointF, QRectF, QSize, Qt, pyqtSignal
from qgis.PyQt.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPalette, QPen
from qgis.PyQt.QtWidgets import QSizePolicy, QWidget

from ...core.arrays import Floats
from ..i18n import number_text, tr

#: Range of the entropy of 256 grey levels, bits.
LOWEST, HIGHEST = 0.0, 8.0
#: Decimals of a threshold.
DECIMALS = 2
#: Step of the threshold by arrow key, in bits.
_STEP = 0.01
#: Step by arrow key with Shift.
_SHIFT_STEP = 0.1
#: Step by page key.
_PAGE_STEP = 0.5
_TICK_PX, _GAP_PX = 4, 3
_HANDLE_PX = 5.0
#: Least height of a non-empty bin, so that a few images among thousands are visible: they matter most.
_LEAST_BAR_PX = 2.0
_BETWEEN_PX = 1.0
#: Distinguishable for colour-blind people, on light and dark windows and over imagery.
KEPT = QColor(42, 134, 220)
REJECTED = QColor(230, 40, 150)


class PlotArea(NamedTuple):
    """Rectangle of a chart's plot, px."""

    left: float
    top: float
    right: float
    bottom: float

    @property
    def rect(self) -> QRectF:
        """Rectangle as Qt draws it."""
        return QRectF(self.left, self.top, self.right - self.left, self.bottom - self.top)


class Chart(QWidget):
    """Base of both charts: axes, and a movable threshold line.

    Signals
    -------
    threshold_moved(float)
        Threshold in bits; the user has moved the line.

    Attributes
    ----------
    look : QWidget
        Widget whose colours to use: QGIS themes are style sheets, which do not change a plain widget's palette.
    """

    threshold_moved = pyqtSignal(float)
    #: Whether the threshold is on the horizontal axis.
    ACROSS = True

    def __init__(self, name: str) -> None:
        super().__init__()
        self.setObjectName(name)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        self.setToolTip(
            tr(
                "Drag the line: images with less entropy (bits) are rejected.\nArrow keys move it by {step}, with "
                "Shift by {shift}, Page keys by {page} bits."
            ).format(step=_STEP, shift=_SHIFT_STEP, page=_PAGE_STEP)
        )
        self.look: QWidget = self
        self.bits: Floats = np.zeros(0)
        self.threshold = LOWEST
        self.suggested: float | None = None
        self._hint = ""
        self._held = False

    def show_bits(self, bits: Floats, suggested: float | None) -> None:
        """Show entropies (n,) in flight order, NaN for missing images."""
        self.bits, self.suggested, self._hint = bits, suggested, ""
        self.prepare()
        self.update()

    def show_hint(self, text: str) -> None:
        """Show a text instead of entropies."""
        self.bits, self.suggested, self._hint = np.zeros(0), None, text
        self.prepare()
        self.update()

    def show_threshold(self, threshold: float) -> None:
        """Move the line to a threshold, in bits."""
        self.threshold = threshold
        self.setAccessibleName(tr("Threshold {bits} bits").format(bits=f"{threshold:.{DECIMALS}f}"))
        self.update()

    def axis_px(self, bits: float, frame: PlotArea | None = None) -> float:
        """Position in px of an entropy on the threshold's axis, in ``frame`` (by default the current plot area)."""
        frame = frame or self.frame()
        share = (bits - LOWEST) / (HIGHEST - LOWEST)
        if self.ACROSS:
            return frame.left + share * (frame.right - frame.left)
        return frame.bottom - share * (frame.bottom - frame.top)

    def bits_from_point(self, x: float, y: float) -> float:
        """Entropy at a point of the chart, clamped and rounded like thresholds."""
        frame = self.frame()
        share = (
            (x - frame.left) / (frame.right - frame.left)
            if self.ACROSS
            else (frame.bottom - y) / (frame.bottom - frame.top)
        )
        return round(min(max(LOWEST + share * (HIGHEST - LOWEST), LOWEST), HIGHEST), DECIMALS)

    def frame(self) -> PlotArea:
        """Current plot area."""
        metrics = self.fontMetrics()
        left = max(metrics.horizontalAdvance(text) for _, text in self.left_ticks()) + _TICK_PX + 2 * _GAP_PX
        below = 2 * metrics.height() + _TICK_PX + 2 * _GAP_PX
        above = metrics.height() + 2 * _GAP_PX + _HANDLE_PX
        right = self.width() - metrics.horizontalAdvance("00") - _GAP_PX
        return PlotArea(left + metrics.height(), above, max(right, left + 1), max(self.height() - below, above + 1))

    def sizeHint(self) -> QSize:
        """Enough room to show the shape of a distribution."""
        return QSize(420, 190)

    def minimumSizeHint(self) -> QSize:
        """Enough room for the axes and a line."""
        return QSize(240, 140)

    # --- differences between the charts

    def prepare(self) -> None:
        """Compute values that every repaint uses."""

    def left_ticks(self) -> list[tuple[float, str]]:
        """Values and texts of the vertical axis, which begins at 0."""
        raise NotImplementedError

    def bottom_ticks(self) -> list[tuple[float, str]]:
        """Values and texts of the horizontal axis."""
        raise NotImplementedError

    def titles(self) -> tuple[str, str]:
        """Titles of the horizontal and the vertical axis, with unit."""
        raise NotImplementedError

    def ranges(self) -> tuple[float, float]:
        """Upper ends of the horizontal and vertical axes, which begin at 0."""
        raise NotImplementedError

    def paint_data(self, painter: QPainter, frame: PlotArea) -> None:
        """Draw the entropies."""
        raise NotImplementedError

    # --- mouse and keyboard

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin dragging the line."""
        if event.button() == Qt.MouseButton.LeftButton:
            self._held = True
            self._drag(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag the line."""
        if not len(self.bits):
            self.unsetCursor()
            return
        self.setCursor(Qt.CursorShape.SplitHCursor if self.ACROSS else Qt.CursorShape.SplitVCursor)
        if self._held:
            self._drag(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End dragging the line."""
        if event.button() == Qt.MouseButton.LeftButton:
            self._held = False

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Move the line by key."""
        step = _SHIFT_STEP if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else _STEP
        moved = {
            Qt.Key.Key_Left: self.threshold - step,
            Qt.Key.Key_Down: self.threshold - step,
            Qt.Key.Key_Right: self.threshold + step,
            Qt.Key.Key_Up: self.threshold + step,
            Qt.Key.Key_PageDown: self.threshold - _PAGE_STEP,
            Qt.Key.Key_PageUp: self.threshold + _PAGE_STEP,
            Qt.Key.Key_Home: LOWEST,
            Qt.Key.Key_End: HIGHEST,
        }.get(event.key())
        if moved is None or not len(self.bits):
            super().keyPressEvent(event)
            return
        self._move(round(min(max(moved, LOWEST), HIGHEST), DECIMALS))

    def _drag(self, event: QMouseEvent) -> None:
        if len(self.bits):
            self._move(self.bits_from_point(event.pos().x(), event.pos().y()))

    def _move(self, threshold: float) -> None:
        if threshold != self.threshold:
            self.show_threshold(threshold)
            self.threshold_moved.emit(threshold)

    # --- drawing

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: ARG002  Qt passes it
        """Paint."""
        painter = QPainter(self)
        if not len(self.bits):
            flags = int(Qt.AlignmentFlag.AlignCenter) | int(Qt.TextFlag.TextWordWrap)
            # In colours of an enabled widget, even if disabled: the hint may explain why.
            painter.setPen(self.look.palette().color(QPalette.ColorGroup.Active, QPalette.ColorRole.WindowText))
            painter.drawText(self.rect().adjusted(_GAP_PX, _GAP_PX, -_GAP_PX, -_GAP_PX), flags, self._hint)
            return
        frame = self.frame()
        painter.fillRect(frame.rect, self.look.palette().base())
        self._paint_axes(painter, frame)
        self.paint_data(painter, frame)
        self._paint_line(painter, frame)
        if self.hasFocus():
            painter.setPen(QPen(self.look.palette().highlight().color(), 1.0))
            painter.drawRect(frame.rect)

    def _text_colour(self) -> QColor:
        return self.look.palette().windowText().color()

    def _paint_axes(self, painter: QPainter, frame: PlotArea) -> None:
        metrics, text = self.fontMetrics(), self._text_colour()
        faint = QColor(text)
        # Faint grid lines.
        faint.setAlphaF(0.16)
        width, height = self.ranges()
        up_px, across_px = (frame.bottom - frame.top) / height, (frame.right - frame.left) / width
        for value, label in _apart(self.left_ticks(), up_px, metrics.height()):
            y = frame.bottom - value * up_px
            painter.setPen(faint)
            painter.drawLine(QPointF(frame.left - _TICK_PX, y), QPointF(frame.right, y))
            painter.setPen(text)
            x = frame.left - _TICK_PX - _GAP_PX - metrics.horizontalAdvance(label)
            painter.drawText(QPointF(x, y + metrics.ascent() / 2.0 - 1.0), label)
        below = self.bottom_ticks()
        widest = max(metrics.horizontalAdvance(label) for _, label in below) + 2 * _GAP_PX
        for value, label in _apart(below, across_px, widest):
            x = frame.left + value * across_px
            painter.setPen(faint)
            painter.drawLine(QPointF(x, frame.bottom), QPointF(x, frame.bottom + _TICK_PX))
            painter.setPen(text)
            at = QPointF(x - metrics.horizontalAdvance(label) / 2.0, frame.bottom + _TICK_PX + metrics.ascent())
            painter.drawText(at, label)
        across, up = self.titles()
        middle = (frame.left + frame.right - metrics.horizontalAdvance(across)) / 2.0
        painter.drawText(QPointF(middle, self.height() - _GAP_PX - metrics.descent()), across)
        painter.save()
        painter.translate(metrics.ascent() + 1.0, (frame.top + frame.bottom + metrics.horizontalAdvance(up)) / 2.0)
        painter.rotate(-90.0)
        painter.drawText(QPointF(0.0, 0.0), up)
        painter.restore()

    def _paint_line(self, painter: QPainter, frame: PlotArea) -> None:
        """Draw the threshold with handle and value, and the suggested threshold as a dotted line."""
        text = self._text_colour()
        if self.suggested is not None:
            painter.setPen(QPen(text, 1.0, Qt.PenStyle.DotLine))
            painter.drawLine(*self._ends(self.suggested, frame))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(text, 2.0))
        start, end = self._ends(self.threshold, frame)
        painter.drawLine(start, end)
        painter.setBrush(text)
        painter.drawEllipse(start if self.ACROSS else end, _HANDLE_PX, _HANDLE_PX)
        # Without a fill, which the focus frame would otherwise have.
        painter.setBrush(Qt.BrushStyle.NoBrush)
        label = tr("{bits} bits").format(bits=f"{self.threshold:.{DECIMALS}f}")
        metrics = self.fontMetrics()
        wide = metrics.horizontalAdvance(label)
        if self.ACROSS:
            x = min(max(start.x() - wide / 2.0, 0.0), self.width() - wide)
            at = QPointF(x, frame.top - _HANDLE_PX - _GAP_PX - metrics.descent())
        else:
            at = QPointF(frame.right - wide, max(start.y() - _HANDLE_PX - _GAP_PX, float(metrics.ascent())))
        painter.drawText(at, label)

    def _ends(self, bits: float, frame: PlotArea) -> tuple[QPointF, QPointF]:
        """Ends of the line at an entropy."""
        at = self.axis_px(bits, frame)
        if self.ACROSS:
            return QPointF(at, frame.top), QPointF(at, frame.bottom)
        return QPointF(frame.left, at), QPointF(frame.right, at)


def bits_ticks() -> list[tuple[float, str]]:
    """Ticks of an axis of entropies: whole bits."""
    return [(float(bits), str(bits)) for bits in range(int(LOWEST), int(HIGHEST) + 1)]


def count_ticks(end: float) -> list[tuple[float, str]]:
    """Ticks of an axis of counts from 0 to ``end``, at steps of 1, 2 or 5 times a power of ten."""
    # For about five ticks.
    rough = max(end / 5, 1.0)
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * factor for factor in (1.0, 2.0, 5.0, 10.0) if power * factor >= rough)
    return [(value, number_text(value, ",.0f")) for value in np.arange(0.0, end + step / 1e6, step).tolist()]


class Histogram(Chart):
    """Number of images by entropy."""

    ACROSS = True

    def __init__(self) -> None:
        super().__init__("histogram")
        self.prepare()

    def prepare(self) -> None:
        """Count the images in each bin."""
        # Bins of a tenth of a bit.
        self.counts, self._edges = np.histogram(self.bits[~np.isnan(self.bits)], 80, (LOWEST, HIGHEST))

    def left_ticks(self) -> list[tuple[float, str]]:
        """Counts."""
        return count_ticks(self.ranges()[1])

    def bottom_ticks(self) -> list[tuple[float, str]]:
        """Bits."""
        return bits_ticks()

    def titles(self) -> tuple[str, str]:
        """Titles of the axes."""
        return tr("Entropy (bits)"), tr("Images")

    def ranges(self) -> tuple[float, float]:
        """Ends of the axes."""
        # Leave room above the highest bin.
        return HIGHEST, max(float(self.counts.max()), 1.0) * 1.08

    def paint_data(self, painter: QPainter, frame: PlotArea) -> None:
        """Draw the bins, in a different colour on each side of the threshold."""
        line = self.axis_px(self.threshold, frame)
        scale = (frame.bottom - frame.top) / self.ranges()[1]
        for low, high, count in zip(self._edges[:-1], self._edges[1:], self.counts.tolist()):
            if not count:
                continue
            left, right = self.axis_px(low, frame), self.axis_px(high, frame)
            tall = max(count * scale, _LEAST_BAR_PX)
            right -= min(_BETWEEN_PX, (right - left) / 4.0)
            middle = min(max(line, left), right)
            for start, end, colour in ((left, middle, REJECTED), (middle, right, KEPT)):
                if end > start:
                    painter.fillRect(QRectF(start, frame.bottom - tall, end - start, tall), colour)


class Bars(Chart):
    """Entropy of each image in flight order; if images outnumber pixels, the range of several images."""

    ACROSS = False

    def __init__(self) -> None:
        super().__init__("bars")

    def left_ticks(self) -> list[tuple[float, str]]:
        """Bits."""
        return bits_ticks()

    def bottom_ticks(self) -> list[tuple[float, str]]:
        """Image numbers."""
        return count_ticks(float(max(len(self.bits), 1)))

    def titles(self) -> tuple[str, str]:
        """Titles of the axes."""
        return tr("Image, in the order of the flight"), tr("Entropy (bits)")

    def ranges(self) -> tuple[float, float]:
        """Ends of the axes."""
        return float(max(len(self.bits), 1)), HIGHEST

    def paint_data(self, painter: QPainter, frame: PlotArea) -> None:
        """Draw a bar for each image, or for each column of pixels."""
        count = len(self.bits)
        columns = min(count, max(int(frame.right - frame.left), 1))
        starts = np.arange(columns) * count // columns
        # Draw the kept part first, so that the rejected part is always visible.
        highest = np.fmax.reduceat(self.bits, starts)
        lowest = np.fmin.reduceat(self.bits, starts)
        wide = (frame.right - frame.left) / columns
        between = _BETWEEN_PX if wide >= 4.0 * _BETWEEN_PX else 0.0
        for column, (low, high) in enumerate(zip(lowest.tolist(), highest.tolist())):
            left = frame.left + column * wide
            if high >= self.threshold:
                self._bar(painter, frame, left, wide - between, high, rejected=False)
            if low < self.threshold:
                self._bar(painter, frame, left, wide - between, low, rejected=True)

    def _bar(
        self, painter: QPainter, frame: PlotArea, left: float, wide: float, bits: float, *, rejected: bool
    ) -> None:
        top = min(self.axis_px(bits, frame), frame.bottom - _LEAST_BAR_PX)
        painter.fillRect(QRectF(left, top, wide, frame.bottom - top), REJECTED if rejected else KEPT)


def _apart(ticks: list[tuple[float, str]], unit_px: float, least_px: float) -> list[tuple[float, str]]:
    """Every n-th of evenly spaced ticks that begin at 0, so that they are at least ``least_px`` apart."""
    if len(ticks) < 2:
        return ticks
    return ticks[:: max(math.ceil(least_px / max(ticks[1][0] * unit_px, 1.0)), 1)]
