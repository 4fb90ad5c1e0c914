"""A picture as large as its place lets it be."""

from __future__ import annotations

from qgis.PyQt.QtCore import QRect, QSize, Qt
from qgis.PyQt.QtGui import QBrush, QImage, QPainter, QPaintEvent
from qgis.PyQt.QtWidgets import QSizePolicy, QWidget

_LEAST_PX = 160
_USUAL_PX = (400, 300)


class PictureView(QWidget):
    """Shows an image whole, its proportions kept, over a pattern that shines through where there is nothing."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("picture")
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.image: QImage | None = None
        self._text = ""

    def show_image(self, image: QImage | None, text: str = "") -> None:
        """Show an image, or a text in its place."""
        self.image, self._text = image, text
        self.setAccessibleName(text)
        self.update()

    def sizeHint(self) -> QSize:
        """Room for a picture of four by three."""
        return QSize(*_USUAL_PX)

    def minimumSizeHint(self) -> QSize:
        """Room to see something."""
        return QSize(_LEAST_PX, _LEAST_PX * 3 // 4)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: ARG002  Qt passes it
        """Paint."""
        painter = QPainter(self)
        if self.image is None:
            flags = int(Qt.AlignmentFlag.AlignCenter) | int(Qt.TextFlag.TextWordWrap)
            painter.drawText(self.rect(), flags, self._text)
            return
        size = self.image.size().scaled(self.size(), Qt.AspectRatioMode.KeepAspectRatio)
        place = QRect(
            (self.width() - size.width()) // 2,
            (self.height() - size.height()) // 2,
            size.width(),
            size.height(),
        )
        painter.fillRect(place, QBrush(self.palette().mid().color(), Qt.BrushStyle.DiagCrossPattern))
        enlarged = size.width() > self.image.width()
        # Pixels stay pixels when enlarged.
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, not enlarged)
        painter.drawImage(place, self.image)
