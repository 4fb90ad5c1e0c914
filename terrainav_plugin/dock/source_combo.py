"""The chooser of the source: in groups, and searched by typing."""

from __future__ import annotations

from collections.abc import Sequence

from qgis.PyQt.QtCore import QStringListModel, Qt, pyqtSignal
from qgis.PyQt.QtGui import QFont, QStandardItemModel
from qgis.PyQt.QtWidgets import QComboBox, QCompleter, QStyle

from ..i18n import tr
from ..plain import shown_plain
from ..widgets import Chooser
from .choices import CATALOGUE, CONNECTION, FILE, OTHER, OWN, PROJECT, REGIONAL, SERVICE, SourceChoice

#: Entries that are seen without scrolling.
_ROWS = 24


class SourceCombo(Chooser):
    """Chooser of a source: headings above groups; what is typed finds titles that have it anywhere in them.

    Signals
    -------
    about_to_open()
        The list is going to be shown; this is the time to bring it up to date.
    """

    about_to_open = pyqtSignal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("source")
        self.setEditable(True)
        self.setInsertPolicy(QComboBox.InsertPolicy.NoInsert)
        self.setMaxVisibleItems(_ROWS)
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self._titles = QStringListModel(self)
        completer = QCompleter(self._titles, self)
        completer.setFilterMode(Qt.MatchFlag.MatchContains)
        completer.setCaseSensitivity(Qt.CaseSensitivity.CaseInsensitive)
        completer.setMaxVisibleItems(_ROWS)
        self.setCompleter(completer)
        completer.activated[str].connect(self._take)
        self.lineEdit().editingFinished.connect(self._take_typed)
        self.currentIndexChanged.connect(self._show_start)

    def fill(self, choices: Sequence[SourceChoice], others: Sequence[tuple[str, str]]) -> None:
        """Offer choices, and (value, title) pairs below them; the first choice is chosen."""
        self.clear()
        group = None
        for choice in choices:
            if choice.group != group:
                group = choice.group
                self._add_heading(group)
            self.add(choice.name, choice.title)
        self._add_heading(OTHER)
        for value, title in others:
            self.add(value, title)
        self.setCurrentIndex(self._first())

    def add(self, value: str, title: str) -> None:
        """Add an entry at the end."""
        self.addItem(title, value)
        row = self.count() - 1
        self.setItemData(row, shown_plain(title), Qt.ItemDataRole.ToolTipRole)
        self._titles.setStringList([self.itemText(at) for at in range(self.count()) if self._can_choose(at)])

    def choose(self, value: str) -> None:
        """Choose an entry; the first one where there is none of this value."""
        index = self.findData(value)
        self.setCurrentIndex(index if index >= 0 else self._first())

    def showPopup(self) -> None:
        """Show the list, as it is now."""
        self.about_to_open.emit()
        # The panel is narrow; titles are read whole all the same.
        bar = self.style().pixelMetric(QStyle.PixelMetric.PM_ScrollBarExtent)
        self.view().setMinimumWidth(self.view().sizeHintForColumn(0) + bar)
        super().showPopup()

    def _add_heading(self, group: int) -> None:
        titles = {
            CATALOGUE: tr("Catalogue: worldwide"),
            REGIONAL: tr("Catalogue: one country"),
            OWN: tr("Your own sources"),
            CONNECTION: tr("QGIS connections: XYZ tiles"),
            SERVICE: tr("QGIS connections: WMS and WMTS"),
            PROJECT: tr("This project"),
            FILE: tr("Files"),
            OTHER: tr("Other"),
        }
        self.addItem(titles[group])
        model = self.model()
        if isinstance(model, QStandardItemModel):
            item = model.item(self.count() - 1)
            item.setFlags(Qt.ItemFlag.NoItemFlags)
            font = QFont(self.font())
            font.setBold(True)
            item.setFont(font)

    def _can_choose(self, row: int) -> bool:
        return self.itemData(row) is not None

    def _first(self) -> int:
        return next((row for row in range(self.count()) if self._can_choose(row)), -1)

    def _take(self, title: str) -> None:
        rows = [row for row in range(self.count()) if self._can_choose(row) and self.itemText(row) == title]
        if rows and self.currentIndex() not in rows:
            self.setCurrentIndex(rows[0])

    def _take_typed(self) -> None:
        """Choose what has been typed, where it says which; otherwise show again what is chosen."""
        typed = self.currentText().strip().casefold()
        own = self.itemText(self.currentIndex())
        if typed and typed != own.casefold():
            titles = [self.itemText(row) for row in range(self.count()) if self._can_choose(row)]
            same = [title for title in titles if title.casefold() == typed]
            found = same or [title for title in titles if typed in title.casefold()]
            if len(set(found)) == 1:
                self._take(found[0])
        self.setEditText(self.itemText(self.currentIndex()))

    def _show_start(self) -> None:
        # A title longer than the field is read from its beginning.
        self.lineEdit().setCursorPosition(0)
