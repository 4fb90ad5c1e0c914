"""Text that gives way to other widgets where a screen is small, and is scrolled then."""

from __future__ import annotations

from qgis.PyQt.QtCore import QSize, Qt
from qgis.PyQt.QtGui import QResizeEvent
from qgis.PyQt.QtWidgets import QFrame, QScrollArea, QSizePolicy, QVBoxLayout, QWidget

#: Lines of text that are always to be seen.
_LEAST_LINES = 6


class Figures(QScrollArea):
    """Labels below each other, as high as their text where there is room for it."""

    def __init__(self, *labels: QWidget) -> None:
        super().__init__()
        contents = QWidget()
        layout = QVBoxLayout(contents)
        layout.setContentsMargins(0, 0, 0, 0)
        for label in labels:
            layout.addWidget(label)
        self.setWidget(contents)
        self.setWidgetResizable(True)
        for background in (contents, self.viewport()):
            background.setAutoFillBackground(False)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)

    def sizeHint(self) -> QSize:
        """All of the text at this width."""
        return QSize(super().sizeHint().width(), self._text_height())

    def minimumSizeHint(self) -> QSize:
        """Some lines, or all of the text where it has fewer."""
        least = _LEAST_LINES * self.fontMetrics().lineSpacing()
        return QSize(super().minimumSizeHint().width(), min(least, self._text_height()))

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Ask for another height where the text breaks otherwise."""
        super().resizeEvent(event)
        if event.oldSize().width() != event.size().width():
            self.fit()

    def fit(self) -> None:
        """Ask for room after the text has changed."""
        self.updateGeometry()

    def _text_height(self) -> int:
        layout = self.widget().layout()
        return layout.totalHeightForWidth(max(self.viewport().width(), layout.minimumSize().width()))
