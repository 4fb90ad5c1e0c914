"""The two charts of the paper: how often each entropy is, and the entropy of each image."""

from __future__ import annotations

import numpy as np
from qgis.PyQt.QtCore import QRectF
from qgis.PyQt.QtGui import QPainter

from ..i18n import tr
from .chart import HIGHEST, LOWEST, Chart, Frame, bits_ticks, count_ticks
from .colours import KEPT, REJECTED

#: Width of a bin of the histogram: a tenth of a bit.
_BINS = 80
#: Head room above the highest bin.
_ROOM = 1.08
#: Least height of a bin that is not empty: a few images among thousands are what is looked for.
_LEAST_PX = 2.0
_BETWEEN_PX = 1.0


class Histogram(Chart):
    """How many images have which entropy."""

    ACROSS = True

    def __init__(self) -> None:
        super().__init__("histogram")
        self.prepare()

    def prepare(self) -> None:
        """Count."""
        there = self.bits[~np.isnan(self.bits)]
        self.counts, self._edges = np.histogram(there, _BINS, (LOWEST, HIGHEST))

    def left_ticks(self) -> list[tuple[float, str]]:
        """Counts."""
        return count_ticks(self.ranges()[1])

    def bottom_ticks(self) -> list[tuple[float, str]]:
        """Bits."""
        return bits_ticks()

    def titles(self) -> tuple[str, str]:
        """Of the axes."""
        return tr("Entropy (bits)"), tr("Images")

    def ranges(self) -> tuple[float, float]:
        """Of the axes."""
        return HIGHEST, max(float(self.counts.max()), 1.0) * _ROOM

    def paint_data(self, painter: QPainter, frame: Frame) -> None:
        """Draw bins, in two colours on either side of the threshold."""
        line = self.place_of(self.threshold, frame)
        scale = (frame.bottom - frame.top) / self.ranges()[1]
        for low, high, count in zip(self._edges[:-1], self._edges[1:], self.counts.tolist()):
            if not count:
                continue
            left, right = self.place_of(low, frame), self.place_of(high, frame)
            tall = max(count * scale, _LEAST_PX)
            right -= min(_BETWEEN_PX, (right - left) / 4.0)
            middle = min(max(line, left), right)
            for start, end, colour in ((left, middle, REJECTED), (middle, right, KEPT)):
                if end > start:
                    painter.fillRect(QRectF(start, frame.bottom - tall, end - start, tall), colour)


class Bars(Chart):
    """The entropy of each image, in the order of the flight; where images outnumber pixels, the range of several."""

    ACROSS = False

    def __init__(self) -> None:
        super().__init__("bars")

    def left_ticks(self) -> list[tuple[float, str]]:
        """Bits."""
        return bits_ticks()

    def bottom_ticks(self) -> list[tuple[float, str]]:
        """Numbers of images."""
        return count_ticks(float(max(len(self.bits), 1)))

    def titles(self) -> tuple[str, str]:
        """Of the axes."""
        return tr("Image, in the order of the flight"), tr("Entropy (bits)")

    def ranges(self) -> tuple[float, float]:
        """Of the axes."""
        return float(max(len(self.bits), 1)), HIGHEST

    def paint_data(self, painter: QPainter, frame: Frame) -> None:
        """Draw a bar for each image, or each column of pixels."""
        count = len(self.bits)
        columns = min(count, max(int(frame.right - frame.left), 1))
        starts = np.arange(columns) * count // columns
        # The kept part stands behind the rejected one, which is always seen.
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
        self, painter: QPainter, frame: Frame, left: float, wide: float, bits: float, *, rejected: bool
    ) -> None:
        top = min(self.place_of(bits, frame), frame.bottom - _LEAST_PX)
        painter.fillRect(QRectF(left, top, wide, frame.bottom - top), REJECTED if rejected else KEPT)
