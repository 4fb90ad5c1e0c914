"""Entries that are scrolled up and down only."""

from __future__ import annotations

from qgis.gui import QgsCollapsibleGroupBoxBasic
from qgis.PyQt.QtCore import QEvent, QObject, Qt, QTimer
from qgis.PyQt.QtGui import QShowEvent
from qgis.PyQt.QtWidgets import QFrame, QScrollArea, QStyle, QWidget


class FormScroll(QScrollArea):
    """A scroll area that is never narrower than its contents, which may grow wider as entries come and go."""

    def __init__(self, contents: QWidget) -> None:
        super().__init__()
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setWidget(contents)
        contents.installEventFilter(self)
        # Groups of QGIS scroll to themselves when they are unfolded, and also when they are first shown.
        self._groups = contents.findChildren(QgsCollapsibleGroupBoxBasic)
        self._let_groups_scroll(False)
        self._fit()

    def showEvent(self, event: QShowEvent) -> None:
        """Begin at the top; from then on, groups that are unfolded come into sight."""
        super().showEvent(event)
        QTimer.singleShot(0, self._shown)

    def _shown(self) -> None:
        self._let_groups_scroll(True)

    def _let_groups_scroll(self, scroll: bool) -> None:
        for group in self._groups:
            group.setScrollOnExpand(scroll)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Follow the contents."""
        if event.type() == QEvent.Type.LayoutRequest and watched is self.widget():
            self._fit()
        return super().eventFilter(watched, event)

    def _fit(self) -> None:
        bar = self.style().pixelMetric(QStyle.PixelMetric.PM_ScrollBarExtent)
        self.setMinimumWidth(self.widget().minimumSizeHint().width() + bar)
