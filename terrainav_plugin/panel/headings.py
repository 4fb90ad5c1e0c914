"""Summaries next to the titles of folded groups."""

from __future__ import annotations

from qgis.gui import QgsCollapsibleGroupBoxBasic
from qgis.PyQt.QtCore import QEvent, QObject, Qt
from qgis.PyQt.QtWidgets import QGroupBox, QStyle, QStyleOptionGroupBox

from ..i18n import tr
from ..plain import shown_plain


class Heading(QObject):
    """Title of a group; while the group is folded, a summary follows, and both are elided to the width."""

    def __init__(self, box: QgsCollapsibleGroupBoxBasic) -> None:
        super().__init__(box)
        # The title of QGroupBox: some groups redefine `title`, for example as the title of their source.
        self._box, self._title, self._tip, self._words = box, QGroupBox.title(box), box.toolTip(), ""
        box.collapsedStateChanged.connect(self._show)
        box.installEventFilter(self)

    def say(self, words: str) -> None:
        """Set the summary."""
        if words != self._words:
            self._words = words
            self._show()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Elide the title to a new width."""
        if event.type() in (QEvent.Type.Resize, QEvent.Type.FontChange):
            self._show()
        return super().eventFilter(watched, event)

    def _show(self, _folded: bool = False) -> None:
        box = self._box
        if not box.isCollapsed() or not self._words:
            title, tip = self._title, self._tip
        else:
            whole = tr("{title}: {values}").format(title=self._title.replace("&", ""), values=self._words)
            # A group's arrow and frame take 24 px.
            room = max(box.width() - 24 - self._mark_px(), 0)
            shown = box.fontMetrics().elidedText(whole, Qt.TextElideMode.ElideRight, room)
            title, tip = shown.replace("&", "&&"), shown_plain("\n".join(filter(None, (whole, self._tip))))
        if title != QGroupBox.title(box):
            box.setTitle(title)
        box.setToolTip(tip)
        # Make folded groups a little higher than QGIS does, which cuts off descenders.
        box.setMinimumHeight(box.fontMetrics().height() + 5 if box.isCollapsed() else 0)

    def _mark_px(self) -> int:
        """Width of a group's check box, if it has one."""
        if not self._box.isCheckable():
            return 0
        style, option = self._box.style(), QStyleOptionGroupBox()
        return style.pixelMetric(QStyle.PixelMetric.PM_IndicatorWidth, option, self._box) + style.pixelMetric(
            QStyle.PixelMetric.PM_CheckBoxLabelSpacing, option, self._box
        )
