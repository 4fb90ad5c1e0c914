"""Tab for exporting a dataset or benchmark to formats of other programs."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from qgis.PyQt.QtCore import QSignalBlocker
from qgis.PyQt.QtWidgets import (
    QButtonGroup,
    QGridLayout,
    QGroupBox,
    QHBoxLayout,
    QLabel,
    QRadioButton,
    QVBoxLayout,
)

from ...core.errors import TerrAInavError
from ...core.exports.kinds import BENCHMARKS, BESIDE_TABLES, DATASETS, KINDS, LABEL_SETS, SEQUENCES, VIEWS
from ...core.map_types import SATELLITE
from ..form.fields import map_type_title
from ..i18n import number_text, tr, translate
from ..paths import entered_folder, exists, next_folder, open_in_system
from ..plain import shown_plain
from ..widgets import combo, folder_entry, growing_form, named, push_button, wrapped_label
from .tab import Tab, no_folder
from .tasks import DatasetExportTask, Work

_COLUMNS = 2


class ExportFormats(NamedTuple):
    """Formats to which a folder can be exported.

    Parameters
    ----------
    reasons : dict
        By format, the reason why it is impossible; None if it is possible.
    map_types : tuple of str
        Empty for a benchmark.
    """

    reasons: dict[str, TerrAInavError | None]
    map_types: tuple[str, ...]


def read_possible(folder: Path) -> ExportFormats:
    """Determine the possible formats of a folder; on any thread."""
    from ...core.dataset.folder import map_type_folders
    from ...core.exports.kinds import refusals

    reasons = refusals(folder)
    try:
        map_types = tuple(map_type_folders(folder))
    except TerrAInavError:
        map_types = ()
    return ExportFormats(reasons, map_types)


class ExportTab(Tab):
    """Formats in groups; only the formats possible for the dataset are enabled."""

    def __init__(self, work: Work) -> None:
        super().__init__("export_tab")
        self._work = work
        self._possible: ExportFormats | None = None
        self._suggested = ""
        self._read_folder: Path | None = None
        self._written: Path | None = None
        self.kinds: dict[str, QRadioButton] = {}
        self._group = QButtonGroup(self)
        self.notes: list[QLabel] = []
        self.map_type = combo("export_map_type", [], tr("The one to export, of several"))
        self.target = folder_entry(
            "export_folder",
            tr("TerrAInav: folder of the export"),
            tr("New or empty; if left out, parquet, croissant and stac are written into the dataset's folder."),
        )
        self.target.fileChanged.connect(lambda _path: self.enable())
        self.export = push_button("export", tr("E&xport"), tr("Write the dataset in this format"))
        self.export.clicked.connect(lambda _checked: self._export())
        self.result = wrapped_label("export_result")
        self.open_folder = push_button("open_export", tr("Open folder"), tr("Show what was written"))
        self.open_folder.clicked.connect(lambda _checked: open_in_system(self._written))
        self._lay_out()
        self.show_dataset()

    @property
    def kind(self) -> str:
        """Format chosen; empty for none."""
        return next((kind for kind, button in self.kinds.items() if button.isChecked()), "")

    def show_dataset(self) -> None:
        """Read which formats are possible."""
        self._possible = None
        self.show_result("")
        folder = self.folder
        if folder != self._read_folder:
            # The previous entries were for another dataset.
            self._read_folder, self._suggested = folder, ""
            with QSignalBlocker(self.target):
                self.target.setFilePath("")
        if folder is None:
            self.hint.setText(no_folder())
        else:
            self.hint.setText(tr("Reading {name}…").format(name=folder.name))
            self.reader.ask(lambda _: read_possible(folder), self._show)
        self.hint.show()
        self.enable()

    def enable(self) -> None:
        """Enable the actions that are possible now."""
        reasons = {} if self._possible is None else self._possible.reasons
        for kind, button in self.kinds.items():
            button.setEnabled(kind in reasons and reasons[kind] is None and not self.working)
        kind = self.kind
        self.map_type.setEnabled(self.map_type.count() > 0 and kind not in BENCHMARKS and not self.working)
        has_place = bool(self.target.filePath().strip()) or kind in BESIDE_TABLES
        chosen = kind in reasons and reasons[kind] is None
        self.export.setEnabled(chosen and has_place and not self.working)

    def _show(self, possible: ExportFormats) -> None:
        self._possible = possible
        self.hint.hide()
        for kinds, note in zip((VIEWS, DATASETS, LABEL_SETS, SEQUENCES, BENCHMARKS), self.notes):
            reasons = [possible.reasons[kind] for kind in kinds]
            for kind, reason in zip(kinds, reasons):
                self.kinds[kind].setToolTip("" if reason is None else shown_plain(translate(reason)))
            # If the whole group is impossible, show the reason once as text: tooltips need a mouse.
            if None in reasons:
                note.setText("")
            elif kinds is LABEL_SETS:
                note.setText(tr("This folder has no labels of pixels."))
            elif kinds is SEQUENCES:
                note.setText(tr("This folder is not a sequence."))
            elif kinds is BENCHMARKS:
                note.setText(tr("This folder is not a benchmark."))
            else:
                note.setText(translate(reasons[0]))
            note.setVisible(None not in reasons)
        if not self.kind or possible.reasons[self.kind] is not None:
            first = next((kind for kind in KINDS if possible.reasons[kind] is None), None)
            if first is not None:
                self.kinds[first].setChecked(True)
        self._kind_chosen()

    def _kind_chosen(self) -> None:
        """Offer map types and a folder for the format."""
        map_types = () if self._possible is None else self._possible.map_types
        before = self.map_type.currentData()
        with QSignalBlocker(self.map_type):
            self.map_type.clear()
            if self.kind in DATASETS:
                self.map_type.addItem(tr("All"), None)
            if self.kind not in BENCHMARKS:
                for name in map_types:
                    self.map_type.addItem(map_type_title(name), name)
            usual = None if self.kind in DATASETS else SATELLITE
            self.map_type.setCurrentIndex(max(self.map_type.findData(before if before in map_types else usual), 0))
        self._suggest_folder()
        self.enable()

    def _suggest_folder(self) -> None:
        """Propose a folder next to the dataset's folder, unless the user has entered one."""
        if self.folder is None or not self.kind or self.target.filePath().strip() != self._suggested:
            return
        self._suggested = ""
        if self.kind not in BESIDE_TABLES:
            beside = self.folder.with_name(f"{self.folder.name}-{self.kind}")
            self._suggested = str(next_folder(beside) if exists(beside) else beside)
        with QSignalBlocker(self.target):
            self.target.setFilePath(self._suggested)

    def _export(self) -> None:
        if self.folder is not None:
            text = self.target.filePath().strip()
            task = DatasetExportTask(
                self.folder, entered_folder(text) if text else None, self.kind, self.map_type.currentData()
            )
            self.show_result("")
            self._work.start(task, self._done, self.show_result)

    def _done(self, task: DatasetExportTask) -> None:
        if task.done is None:
            self.show_result(tr("Stopped: nothing of the export is left."))
            return
        count, where = number_text(task.done.written), task.target or task.folder
        if task.kind in VIEWS:
            text = tr("{count} images as {format} in {folder}; the image files stay where they are.")
        elif task.kind in LABEL_SETS or task.kind in SEQUENCES:
            text = tr("{count} images as {format} in {folder}.")
        elif task.kind in BENCHMARKS:
            text = tr("{count} queries as {format} in {folder}.")
        else:
            text = tr("{count} files as {format} in {folder}.")
        self._suggest_folder()
        self.show_result(text.format(count=count, format=translate(KINDS[task.kind]), folder=where), where)

    def show_result(self, text: str, written: Path | None = None) -> None:
        """Show the result of the export, or why it failed."""
        self._written = written
        self.result.setText(text)
        self.open_folder.setVisible(written is not None)

    def _lay_out(self) -> None:
        layout = QVBoxLayout(self)
        # As narrow as the panel next to which the window is docked.
        layout.setContentsMargins(4, 6, 4, 6)
        layout.addWidget(self.hint)
        for title, kinds in (
            (tr("Camera frames"), VIEWS),
            (tr("Any dataset"), DATASETS),
            (tr("Labels of pixels"), LABEL_SETS),
            (tr("Sequences"), SEQUENCES),
            (tr("Benchmarks"), BENCHMARKS),
        ):
            box = QGroupBox(title)
            grid = QGridLayout(box)
            grid.setContentsMargins(4, 4, 4, 4)
            grid.setHorizontalSpacing(4)
            for at, (kind, words) in enumerate(kinds.items()):
                button = named(QRadioButton(translate(words)), f"export_{kind}")
                button.clicked.connect(lambda _checked: self._kind_chosen())
                self._group.addButton(button)
                self.kinds[kind] = button
                grid.addWidget(button, at // _COLUMNS, at % _COLUMNS)
            note = wrapped_label(f"export_note_{len(self.notes)}")
            note.hide()
            self.notes.append(note)
            grid.addWidget(note, (len(kinds) + 1) // _COLUMNS, 0, 1, _COLUMNS)
            layout.addWidget(box)
        form = growing_form()
        for title, widget in ((tr("Map type"), self.map_type), (tr("Folder of the export"), self.target)):
            label = QLabel(title)
            label.setBuddy(widget)
            form.addRow(label, widget)
        layout.addLayout(form)
        buttons = QHBoxLayout()
        buttons.addStretch(1)
        buttons.addWidget(self.open_folder)
        buttons.addWidget(self.export)
        layout.addWidget(self.result)
        layout.addLayout(buttons)
        layout.addStretch(1)
