"""What is kept of earlier captures, and how to be rid of it."""

from __future__ import annotations

from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtWidgets import (
    QAbstractItemView,
    QDialog,
    QDialogButtonBox,
    QHeaderView,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from ...core.errors import TerrAInavError
from ...core.mission.estimate import size_text
from ..help import add_help_button
from ..i18n import localized, number_text, told, tr
from ..plain import plain_label

_ROOM_PX = (620, 320)


class CacheDialog(QDialog):
    """Lists the files of the tile cache, and clears some or all of them."""

    def __init__(self, parent: QWidget | None = None) -> None:
        from ..settings import Settings

        super().__init__(parent)
        self.setObjectName("terrainav_cache")
        self.setWindowTitle(tr("TerrAInav: cache"))
        self._cache = Settings().tile_cache()
        self.told = plain_label()
        self.told.setWordWrap(True)
        self.told.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.table = QTableWidget(0, 5)
        self.table.setHorizontalHeaderLabels(
            [tr("Source"), tr("Map type"), tr("Date"), tr("Tiles"), tr("Size")]
        )
        self.table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.table.verticalHeader().hide()
        self.table.horizontalHeader().setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        self.table.itemSelectionChanged.connect(self._show_selection)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        role = QDialogButtonBox.ButtonRole.ActionRole
        self.clear_some = buttons.addButton(tr("Clear selected"), role)
        self.clear_all = buttons.addButton(tr("Clear all"), role)
        self.clear_some.clicked.connect(lambda: self._clear(self._selected()))
        self.clear_all.clicked.connect(lambda: self._clear(None))
        buttons.rejected.connect(self.reject)
        add_help_button(buttons, tr("sources"))
        layout = QVBoxLayout(self)
        for widget in (self.told, self.table, buttons):
            layout.addWidget(widget)
        self.resize(*_ROOM_PX)
        self._fill()

    def _fill(self, more: str = "") -> None:
        files = self._cache.list()
        self.table.setRowCount(len(files))
        for line, file in enumerate(files):
            texts = (
                file.title or file.source,
                file.map_type,
                file.date,
                number_text(file.tiles),
                localized(size_text(file.bytes)),
            )
            for column, text in enumerate(texts):
                item = QTableWidgetItem(text)
                item.setData(Qt.ItemDataRole.UserRole, file.path.name)
                if column > 2:
                    item.setTextAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
                self.table.setItem(line, column, item)
        size = localized(size_text(sum(file.bytes for file in files)))
        limit = localized(size_text(self._cache.limit_bytes))
        text = tr("{size} of at most {limit} in {folder}").format(
            size=size, limit=limit, folder=self._cache.folder
        )
        self.told.setText(f"{more} {text}".strip())
        self.clear_all.setEnabled(bool(files))
        self._show_selection()

    def _selected(self) -> list[str]:
        rows = {index.row() for index in self.table.selectionModel().selectedRows()}
        return [self.table.item(line, 0).data(Qt.ItemDataRole.UserRole) for line in sorted(rows)]

    def _show_selection(self) -> None:
        self.clear_some.setEnabled(bool(self._selected()))

    def _clear(self, names: list[str] | None) -> None:
        try:
            freed = self._cache.clear(names)
        except TerrAInavError as wrong:
            self._fill(told(wrong))
            return
        self._fill(tr("{size} freed.").format(size=localized(size_text(freed))))
