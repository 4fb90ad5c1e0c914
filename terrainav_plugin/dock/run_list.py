"""The list of captures in the panel."""

from __future__ import annotations

from qgis.PyQt.QtCore import QSize, Qt
from qgis.PyQt.QtWidgets import QFrame, QScrollArea, QSizePolicy, QVBoxLayout, QWidget

from .run_row import RunRow

#: Rows to be seen at once; others are scrolled to.
_ROWS = 3


class RunList(QScrollArea):
    """Rows below each other, as high as they are up to a few of them; hidden while there are none."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("runs")
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        contents = QWidget()
        self._layout = QVBoxLayout(contents)
        self._layout.setContentsMargins(0, 0, 0, 0)
        self._layout.setSpacing(2)
        self._layout.addStretch(1)
        self.setWidget(contents)
        self._to_newest = False
        self.verticalScrollBar().rangeChanged.connect(self._grown)
        self.hide()

    @property
    def rows(self) -> list[RunRow]:
        """From the top."""
        widgets = (self._layout.itemAt(index).widget() for index in range(self._layout.count()))
        return [widget for widget in widgets if isinstance(widget, RunRow)]

    def add(self, row: RunRow) -> None:
        """Put a row below the others."""
        self._layout.insertWidget(self._layout.count() - 1, row)
        self._to_newest = True
        self.show()
        self.fit()

    def remove(self, row: RunRow) -> None:
        """Take a row away."""
        self._layout.removeWidget(row)
        row.hide()
        row.deleteLater()
        self.setVisible(bool(self.rows))
        self.fit()

    def fit(self) -> None:
        """Ask for room after rows have changed."""
        self.updateGeometry()

    def sizeHint(self) -> QSize:
        """All rows, up to a few."""
        return QSize(super().sizeHint().width(), self._height_of(_ROWS))

    def minimumSizeHint(self) -> QSize:
        """One row."""
        return QSize(super().minimumSizeHint().width(), self._height_of(1))

    def _grown(self, _least: int, most: int) -> None:
        """Scroll to a row that has come, once it has its place."""
        if self._to_newest:
            self._to_newest = False
            self.verticalScrollBar().setValue(most)

    def _height_of(self, count: int) -> int:
        width = max(self.viewport().width(), 1)
        heights = [
            row.heightForWidth(width) if row.hasHeightForWidth() else row.sizeHint().height()
            for row in self.rows[:count]
        ]
        return sum(heights) + self._layout.spacing() * len(heights)
