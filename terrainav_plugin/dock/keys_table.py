"""Which authentication configuration is which source's."""

from __future__ import annotations

from qgis.gui import QgsAuthConfigSelect
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtWidgets import QAbstractItemView, QComboBox, QHeaderView, QTableWidget, QTableWidgetItem

from ...core.errors import TerrAInavError
from ..i18n import tr
from ..plain import shown_plain
from ..settings import Settings

#: Rows that are seen without scrolling.
_ROWS = 6


class KeysTable(QTableWidget):
    """Sources that need a key or have a configuration, each with a chooser of one.

    Attributes
    ----------
    choosers : dict of str to QgsAuthConfigSelect
        By what the settings call the sources.
    """

    def __init__(self, settings: Settings) -> None:
        super().__init__(0, 2)
        self.setObjectName("keys")
        self.setToolTip(
            tr("Sources that need a key or are authenticated, and the configurations that hold it")
        )
        self._settings = settings
        self.choosers: dict[str, QgsAuthConfigSelect] = {}
        self.setHorizontalHeaderLabels([tr("Source"), tr("Authentication configuration")])
        self.verticalHeader().hide()
        self.setSelectionMode(QAbstractItemView.SelectionMode.NoSelection)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.horizontalHeader().setSectionResizeMode(0, QHeaderView.ResizeMode.ResizeToContents)
        self.horizontalHeader().setSectionResizeMode(1, QHeaderView.ResizeMode.Stretch)

    def fill(self) -> None:
        """Show what is set."""
        chosen = self._settings.authcfgs()
        titles = {**dict.fromkeys(chosen, ""), **_in_need()}
        self.choosers.clear()
        self.setRowCount(len(titles))
        for line, (name, title) in enumerate(sorted(titles.items(), key=lambda one: one[1] or one[0])):
            item = QTableWidgetItem(title or name)
            item.setToolTip(shown_plain(name))
            self.setItem(line, 0, item)
            chooser = QgsAuthConfigSelect()
            chooser.setObjectName(f"key_{name}")
            chooser.setConfigId(chosen.get(name, ""))
            # Its buttons beside it tell the same.
            chooser.findChild(QComboBox).setToolTip(
                shown_plain(tr("Configuration for {title}").format(title=title or name))
            )
            self.choosers[name] = chooser
            self.setCellWidget(line, 1, chooser)
            self.setRowHeight(line, chooser.sizeHint().height() + 4)
        shown = range(min(self.rowCount(), _ROWS))
        rows_px = sum(self.rowHeight(line) for line in shown)
        self.setMinimumHeight(self.horizontalHeader().sizeHint().height() + rows_px + 2 * self.frameWidth())

    def keep(self) -> None:
        """Keep what is chosen."""
        for name, chooser in self.choosers.items():
            self._settings.set_authcfg(name, chooser.configId())


def _in_need() -> dict[str, str]:
    """Titles of the sources that need a key, by name."""
    from ...core.imagery.catalogue import sources

    try:
        return {entry.name: entry.title for entry in sources() if entry.key_env is not None}
    except TerrAInavError:
        # The chooser of sources tells what is wrong with the user's own.
        from ...core.imagery.entry import shipped

        return {entry.name: entry.title for entry in shipped() if entry.key_env is not None}
