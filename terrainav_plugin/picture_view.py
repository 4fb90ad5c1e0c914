"""Widget that shows one image."""

from __future__ import annotations

from qgis.PyQt.QtCore import QEvent, QPoint, QPointF, QRect, QSize, Qt, pyqtSignal
from qgis.PyQt.QtGui import QBrush, QColor, QImage, QMouseEvent, QPainter, QPaintEvent, QPen
from qgis.PyQt.QtWidgets import QSizePolicy, QWidget


class PictureView(QWidget):
    """Show a whole image with its aspect ratio, over a pattern that makes transparency visible.

    Signals
    -------
    pointed(QPointF or None)
        Position in the image under the mouse, as shares of its width and height; None outside.
    """

    pointed = pyqtSignal(object)

    def __init__(self, name: str) -> None:
        super().__init__()
        self.setObjectName(name)
        self.setMouseTracking(True)
        self._mark: QPointF | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.image: QImage | None = None
        self.overlay: QImage | None = None
        self._opacity = 1.0
        self._text = ""

    def show_image(self, image: QImage | None, text: str = "") -> None:
        """Show an image, or a text in its place."""
        self.image, self._text, self._mark, self.overlay = image, text, None, None
        self.setAccessibleName(text)
        self.update()

    def mark(self, at: QPointF | None) -> None:
        """Draw a ring around a position in the image; None removes the ring."""
        self._mark = at
        self.update()

    def lay_over(self, overlay: QImage | None, opacity: float) -> None:
        """Draw an image over the one shown, with an opacity from 0 to 1; None removes it."""
        self.overlay, self._opacity = overlay, opacity
        self.update()

    def place(self) -> QRect:
        """Rectangle in which the image is drawn."""
        size = QSize() if self.image is None else self.image.size()
        size = size.scaled(self.size(), Qt.AspectRatioMode.KeepAspectRatio)
        return QRect(QPoint((self.width() - size.width()) // 2, (self.height() - size.height()) // 2), size)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Emit the position under the mouse."""
        place = self.place()
        if self.image is None or not place.contains(event.pos()):
            self.pointed.emit(None)
            return
        # Use the middle of the screen pixel.
        x, y = event.pos().x() + 0.5 - place.left(), event.pos().y() + 0.5 - place.top()
        self.pointed.emit(QPointF(x / place.width(), y / place.height()))

    def leaveEvent(self, event: QEvent) -> None:
        """Emit that the mouse has left."""
        self.pointed.emit(None)
        super().leaveEvent(event)

    def sizeHint(self) -> QSize:
        """Room for an image of four by three."""
        return QSize(400, 300)

    def minimumSizeHint(self) -> QSize:
        """Room for a small image."""
        return QSize(80, 60)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: ARG002  Qt passes it
        """Paint."""
        painter = QPainter(self)
        if self.image is None:
            flags = int(Qt.AlignmentFlag.AlignCenter) | int(Qt.TextFlag.TextWordWrap)
            painter.drawText(self.rect(), flags, self._text)
            return
        place = self.place()
        painter.fillRect(place, QBrush(self.palette().mid().color(), Qt.BrushStyle.DiagCrossPattern))
        enlarged = place.width() > self.image.width()
        # Show enlarged pixels as squares.
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, not enlarged)
        painter.drawImage(place, self.image)
        if self.overlay is not None:
            painter.setOpacity(self._opacity)
            painter.drawImage(place, self.overlay)
            painter.setOpacity(1.0)
        if self._mark is None:
            return
        middle = QPointF(place.left() + self._mark.x() * place.width(), place.top() + self._mark.y() * place.height())
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for colour, width in ((Qt.GlobalColor.black, 3.0), (Qt.GlobalColor.white, 1.0)):
            painter.setPen(QPen(QColor(colour), width))
            painter.drawEllipse(middle, 5.0, 5.0)
