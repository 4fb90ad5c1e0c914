"""The plugin's page in QGIS's options."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from qgis.gui import QgsAuthConfigSelect, QgsFileWidget, QgsOptionsPageWidget
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtWidgets import (
    QAbstractItemView,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QGroupBox,
    QHeaderView,
    QLabel,
    QPushButton,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from ...core.errors import InvalidInput, TerrAInavError
from ...core.external.compiling import code_in_use
from ...core.mission.estimate import size_text
from ..help import add_help_button
from ..i18n import number_text, tr, translate
from ..messages import log
from ..plain import shown_plain
from ..settings import Settings
from ..widgets import (
    STYLE_SHEET,
    FieldMarks,
    WholeBox,
    choose,
    combo,
    folder_entry,
    growing_form,
    line_edit,
    named,
    row,
    scrolled,
    whole_spin,
    wrapped_label,
)


class OptionsPage(QgsOptionsPageWidget):
    """Show the settings, mark invalid settings, and save valid ones when QGIS's options are accepted.

    Parameters
    ----------
    parent : QWidget or None
    applied : callable
        Called after the settings are saved.

    Attributes
    ----------
    folders : dict of str to QgsFileWidget
        Entries of folders, by the names of their settings.
    """

    def __init__(self, parent: QWidget | None, applied: Callable[[], None]) -> None:
        super().__init__(parent)
        self.setStyleSheet(STYLE_SHEET)
        self._settings, self._applied = Settings(), applied
        self.marks = FieldMarks()
        self.folders: dict[str, QgsFileWidget] = {}
        self._lay_out()
        self.show_settings()
        for widget in self.folders.values():
            widget.fileChanged.connect(self._check)
        self.placeholders.textChanged.connect(self._check)
        for number in self._numbers.values():
            number.judged.connect(self._check)

    def show_settings(self) -> None:
        """Show the current settings."""
        settings = self._settings
        for name, widget in self.folders.items():
            widget.setFilePath(getattr(settings, name))
        self.connections.setValue(settings.connections)
        self.cache_limit.setValue(settings.cache_limit_mb)
        self.placeholders.setText(" ".join(settings.missing_tiles))
        choose(self.units, settings.units)
        self.keys.fill()
        self._check()

    def show_defaults(self) -> None:
        """Show the default settings; leave keys as they are."""
        for widget in self.folders.values():
            widget.setFilePath("")
        self.connections.setValue(Settings.connections.default)
        self.cache_limit.setValue(Settings.cache_limit_mb.default)
        self.placeholders.clear()
        choose(self.units, "m")

    def apply(self) -> None:
        """Save the valid settings; report invalid settings in the log, and keep their previous values."""
        problems = self._check()
        for name, widget in self.folders.items():
            if name in problems:
                log(tr("Not kept: {problem}").format(problem=problems[name]))
            else:
                setattr(self._settings, name, widget.filePath().strip())
        for name, number in self._numbers.items():
            if name in problems:
                log(tr("Not kept: {problem}").format(problem=problems[name]))
            else:
                setattr(self._settings, name, number.value())
        if "placeholders" in problems:
            log(tr("Not kept: {problem}").format(problem=problems["placeholders"]))
        else:
            self._settings.placeholders = self.placeholders.text().strip()
        self._settings.units = self.units.currentData()
        self.keys.keep()
        self._applied()

    def isValid(self) -> bool:
        """Whether all settings are valid."""
        return not self._check()

    def show_cache(self) -> None:
        """Show the contents of the cache."""
        dialog = CacheDialog(self.window())
        dialog.exec()
        dialog.deleteLater()

    # --- layout

    def _lay_out(self) -> None:
        inside = QWidget()
        layout = QVBoxLayout(inside)
        for box in (self._missions(), self._cache(), self._keys()):
            layout.addWidget(box)
        buttons = QDialogButtonBox()
        self.reset = named(
            buttons.addButton(tr("Reset to defaults"), QDialogButtonBox.ButtonRole.ResetRole),
            "reset",
            tr("All settings except keys, which stay as they are"),
        )
        self.reset.clicked.connect(self.show_defaults)
        add_help_button(buttons, tr("settings"))
        layout.addWidget(buttons)
        layout.addStretch(1)
        outside = QVBoxLayout(self)
        outside.setContentsMargins(0, 0, 0, 0)
        outside.addWidget(scrolled(inside))

    def _missions(self) -> QGroupBox:
        box, form = _box(tr("Missions"))
        tip = tr("New missions are captured into folders below this one")
        self._folder(form, tr("Folder for missions"), "missions_folder", str(self._settings.home), tip)
        units = (("m", tr("Metres")), ("ft", tr("Feet (international)")))
        self.units = combo("units", units, tr("Unit of heights above ground: m or ft"))
        form.addRow(tr("Heights in"), self.units)
        limits, tip = Settings.connections, tr("Requests under way at once; fewer where a provider says so")
        self.connections = whole_spin("connections", limits.least, limits.most, tip)
        form.addRow(tr("Connections at once"), self.marks.field("connections", self.connections))
        tip = tr("Images of the synthetic landscape that are shown as background")
        place = str(self._settings.profile)
        self._folder(form, tr("Folder for backgrounds"), "backgrounds_folder", place, tip)
        code = wrapped_label("relief_code")
        code.setText(translate(code_in_use()))
        form.addRow(tr("Images over relief by"), code)
        return box

    def _cache(self) -> QGroupBox:
        from ...core.imagery.cache.tile_cache import default_folder

        box, form = _box(tr("Cache of tiles"))
        tip = tr("Tiles that providers allow to be stored; they are not requested again")
        self._folder(form, tr("Folder of the cache"), "cache_folder", str(default_folder()), tip)
        limits = Settings.cache_limit_mb
        tip = tr("Size limit of the cache in MB; beyond it, the least recently used tiles are deleted")
        self.cache_limit = whole_spin("cache_limit", limits.least, limits.most, tip)
        self.cache_limit.setSuffix(" MB")
        self.cache_limit.setSingleStep(500)
        self.cache_button = named(
            QPushButton(tr("View or clear…")),
            "cache",
            tr("Shows what is in the cache, and clears some or all of it"),
        )
        self.cache_button.clicked.connect(self.show_cache)
        limit = row(self.cache_limit, self.cache_button, stretch=0)
        form.addRow(tr("At most"), self.marks.field("cache_limit_mb", self.cache_limit, limit))
        tip = tr("SHA-256 of tiles that show no imagery, 16 digits or more of each, with spaces between them")
        self.placeholders = line_edit("placeholders", tip)
        form.addRow(tr("Treat as missing"), self.marks.field("placeholders", self.placeholders))
        return box

    def _keys(self) -> QGroupBox:
        box = QGroupBox(tr("Keys and authentication"))
        layout = QVBoxLayout(box)
        about = QLabel(
            tr(
                "Keys are stored encrypted in QGIS's authentication database, each as the password of a "
                "Basic configuration. TerrAInav saves only the configuration's id; no project, mission or "
                "layer contains a key."
            )
        )
        about.setWordWrap(True)
        layout.addWidget(about)
        self.keys = KeysTable(self._settings)
        layout.addWidget(self.keys)
        return box

    def _folder(self, form: QFormLayout, label: str, name: str, usual: str, tip: str) -> None:
        widget = folder_entry(name, label, tip)
        widget.lineEdit().setPlaceholderText(usual)
        self.folders[name] = widget
        form.addRow(label, self.marks.field(name, widget.lineEdit(), widget))

    @property
    def _numbers(self) -> dict[str, WholeBox]:
        """Number entries, by the names of their settings."""
        return {"connections": self.connections, "cache_limit_mb": self.cache_limit}

    def _check(self) -> dict[str, str]:
        """Mark invalid settings, and return their problems by name."""
        problems = {name: folder_problem(widget.filePath()) for name, widget in self.folders.items()}
        problems["placeholders"] = placeholders_problem(self.placeholders.text())
        problems.update((name, number.problem()) for name, number in self._numbers.items())
        problems = {name: problem for name, problem in problems.items() if problem}
        self.marks.show(problems)
        return problems


def placeholders_problem(text: str) -> str:
    """Problem with the SHA-256 of tiles to treat as missing; empty if there is none."""
    from ...core.imagery.placeholder import Placeholder

    try:
        Placeholder().extended(text.split())
    except InvalidInput as wrong:
        return translate(wrong)
    return ""


def folder_problem(text: str) -> str:
    """Problem with a folder to write to; empty if there is none, or if ``text`` is empty."""
    text = text.strip()
    if not text:
        return ""
    try:
        folder = Path(text).expanduser()
        if not folder.is_absolute():
            return tr("{folder}: must be an absolute path, such as {example}").format(
                folder=text, example=Path.home() / "TerrAInav"
            )
        there = next(place for place in (folder, *folder.parents) if place.exists())
    except (OSError, RuntimeError, StopIteration, ValueError) as wrong:
        return tr("{folder}: cannot be a folder ({reason})").format(folder=text, reason=wrong)
    if not there.is_dir():
        return tr("{folder}: {file} is a file; choose a folder").format(folder=text, file=there)
    if not os.access(there, os.W_OK):
        return tr("{folder}: cannot be written to; choose another").format(folder=text)
    return ""


class KeysTable(QTableWidget):
    """Sources that need a key or have a configuration, each with a chooser.

    Attributes
    ----------
    choosers : dict of str to QgsAuthConfigSelect
        Choosers by the names of sources in the settings.
    """

    def __init__(self, settings: Settings) -> None:
        super().__init__(0, 2)
        self.setObjectName("keys")
        self.setToolTip(tr("Sources that need a key or are authenticated, and the configurations that hold it"))
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
        """Show the current settings."""
        chosen = self._settings.authcfgs()
        titles = {**dict.fromkeys(chosen, ""), **_keyless_titles()}
        self.choosers.clear()
        self.setRowCount(len(titles))
        for line, (name, title) in enumerate(sorted(titles.items(), key=lambda one: one[1] or one[0])):
            item = QTableWidgetItem(title or name)
            item.setToolTip(shown_plain(name))
            self.setItem(line, 0, item)
            chooser = named(QgsAuthConfigSelect(), f"key_{name}")
            chooser.setConfigId(chosen.get(name, ""))
            # The chooser's buttons get the same tooltip.
            chooser.findChild(QComboBox).setToolTip(
                shown_plain(tr("Configuration for {title}").format(title=title or name))
            )
            self.choosers[name] = chooser
            self.setCellWidget(line, 1, chooser)
            self.setRowHeight(line, chooser.sizeHint().height() + 4)
        shown = range(min(self.rowCount(), 6))
        rows_px = sum(self.rowHeight(line) for line in shown)
        self.setMinimumHeight(self.horizontalHeader().sizeHint().height() + rows_px + 2 * self.frameWidth())

    def keep(self) -> None:
        """Save the choices."""
        for name, chooser in self.choosers.items():
            self._settings.set_authcfg(name, chooser.configId())


class CacheDialog(QDialog):
    """List the contents of the tile cache, to clear some or all of them."""

    def __init__(self, parent: QWidget | None = None) -> None:
        from ..settings import Settings

        super().__init__(parent)
        self.setObjectName("terrainav_cache")
        self.setWindowTitle(tr("TerrAInav: cache"))
        self._cache = Settings().tile_cache()
        self.notice = wrapped_label("notice")
        self.table = QTableWidget(0, 5)
        self.table.setHorizontalHeaderLabels([tr("Source"), tr("Map type"), tr("Date"), tr("Tiles"), tr("Size")])
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
        for widget in (self.notice, self.table, buttons):
            layout.addWidget(widget)
        self.resize(620, 320)
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
                translate(size_text(file.bytes)),
            )
            for column, text in enumerate(texts):
                item = QTableWidgetItem(text)
                item.setData(Qt.ItemDataRole.UserRole, file.path.name)
                if column > 2:
                    item.setTextAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
                self.table.setItem(line, column, item)
        size = translate(size_text(sum(file.bytes for file in files)))
        limit = translate(size_text(self._cache.limit_bytes))
        text = tr("{size} of at most {limit} in {folder}").format(size=size, limit=limit, folder=self._cache.folder)
        self.notice.setText(f"{more} {text}".strip())
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
            self._fill(translate(wrong))
            return
        self._fill(tr("{size} freed.").format(size=translate(size_text(freed))))


def _box(title: str) -> tuple[QGroupBox, QFormLayout]:
    box = QGroupBox(title)
    return box, growing_form(box)


def _keyless_titles() -> dict[str, str]:
    """Titles of the sources that need a key, by name."""
    from ...core.imagery.catalogue import sources

    try:
        return {entry.name: entry.title for entry in sources() if entry.key_env is not None}
    except TerrAInavError:
        # The user's sources cannot be read, which the source chooser reports: list the others.
        from ...core.imagery.entry import shipped

        return {entry.name: entry.title for entry in shipped() if entry.key_env is not None}
