"""The dialog that adds an imagery to a mission, or changes one."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from qgis.PyQt.QtCore import QSignalBlocker
from qgis.PyQt.QtWidgets import QButtonGroup, QDialog, QDialogButtonBox, QVBoxLayout, QWidget

from ...core.errors import TerrAInavError
from ..form.state import URL_TEMPLATE
from ..i18n import tr, translate
from ..settings import Settings
from ..widgets import STYLE_SHEET, FieldMarks, growing_form, line_edit, ok_and_cancel
from .choices import SourceChoice
from .imagery import ImageryEntries
from .imagery_list import free_name

if TYPE_CHECKING:
    from ...core.mission.imageries import NamedImagery


class ImageryDialog(QDialog):
    """Ask for a source, a date, a map type and a name.

    Parameters
    ----------
    parent : QWidget
    choices : sequence of SourceChoice
    taken : collection of str
        Names of the other imageries.
    given : NamedImagery or None
        Imagery to change.

    Attributes
    ----------
    imagery : NamedImagery or None
        Imagery entered; None while an entry is wrong.
    """

    def __init__(
        self, parent: QWidget, choices: Sequence[SourceChoice], taken: Collection[str], given: NamedImagery | None
    ) -> None:
        super().__init__(parent)
        self.setObjectName("terrainav_imagery")
        self.setWindowTitle(tr("TerrAInav: imagery") if given is not None else tr("TerrAInav: add imagery"))
        self.setStyleSheet(STYLE_SHEET)
        self.imagery: NamedImagery | None = None
        self._taken, self._is_named = taken, given is not None
        self.marks = FieldMarks()
        self.entries = ImageryEntries(self.marks, choices)
        self.entries.others.hide()
        self.entries.show_on_map.hide()
        self._kinds = QButtonGroup(self)
        for box in self.entries.map_types.values():
            self._kinds.addButton(box)
        self.name = line_edit("imagery_name", tr("Name of the imagery, and of its folder"))
        self.name.textEdited.connect(self._name_typed)
        form = growing_form()
        form.addRow(tr("Name"), self.marks.field("imagery_name", self.name))
        self.buttons = ok_and_cancel(self)
        layout = QVBoxLayout(self)
        layout.addWidget(self.entries)
        layout.addLayout(form)
        layout.addStretch(1)
        layout.addWidget(self.buttons)
        self.resize(460, 300)
        self._enter(given)
        self.entries.changed.connect(self._check)
        self.entries.key.selectedConfigIdChanged.connect(self._key_chosen)
        self._check()

    def _enter(self, given: NamedImagery | None) -> None:
        from ...core.imagery.opening import source_kind

        entries = self.entries
        if given is None:
            next(iter(entries.map_types.values())).setChecked(True)
            return
        is_address = source_kind(given.source).is_address
        entries.choose_source(URL_TEMPLATE if is_address else given.source)
        entries.template.setText(given.source if is_address else "")
        entries.date.setText(given.date)
        entries.map_types[given.map_type].setChecked(True)
        self.name.setText(given.name)

    def _name_typed(self) -> None:
        self._is_named = bool(self.name.text().strip())
        self._check()

    def _key_chosen(self, authcfg: str) -> None:
        Settings().set_authcfg(self.entries.source_name(), authcfg)

    def _check(self) -> None:
        """Work out the imagery, and show what is wrong at its entry."""
        wrong: dict[str, str] = {}
        with QSignalBlocker(self.entries.key):
            self.entries.key.setConfigId(Settings().authcfg(self.entries.source_name()))
        self.imagery = None
        if not self.entries.ticked():
            # The source has other map types than the one before.
            next(box for box in self.entries.map_types.values() if box.isEnabled()).setChecked(True)
        try:
            made = self.entries.own_imagery()
        except TerrAInavError as problem:
            wrong["source"] = translate(problem)
        else:
            wrong.update(self._named(made))
        self.marks.show(wrong)
        self.buttons.button(QDialogButtonBox.StandardButton.Ok).setEnabled(not wrong)

    def _named(self, made: NamedImagery) -> dict[str, str]:
        """Name the imagery; returns messages about its name."""
        if not self._is_named:
            made = free_name(made, self._taken)
            self.name.setText(made.name)
        name = self.name.text().strip()
        if name.lower() in {one.lower() for one in self._taken}:
            return {"imagery_name": tr("imagery “{name}”: is there already").format(name=name)}
        try:
            self.imagery = replace(made, name=name)
        except TerrAInavError as problem:
            return {"imagery_name": translate(problem)}
        return {}
