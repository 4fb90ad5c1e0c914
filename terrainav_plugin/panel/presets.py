"""Choosers of presets, whose tooltips describe them: of values for a purpose, and of kinds of cameras."""

from __future__ import annotations

from collections.abc import Sequence

from qgis.PyQt.QtCore import QSignalBlocker, Qt, pyqtSignal
from qgis.PyQt.QtGui import QStandardItemModel
from qgis.PyQt.QtWidgets import QHBoxLayout, QLabel, QWidget

from ...core.mission.presets import PRESETS, Preset
from ..i18n import tr, translate
from ..plain import shown_plain
from ..widgets import combo

_CUSTOM = ""


class PresetChooser(QWidget):
    """Presets by name.

    Signals
    -------
    chosen(object)
        A `Preset` chosen by the user.

    Attributes
    ----------
    preset : Preset or None
        The preset shown.
    """

    chosen = pyqtSignal(object)

    def __init__(
        self, name: str = "preset", presets: Sequence[Preset] = PRESETS, tip: str = "", *, labelled: bool = True
    ) -> None:
        super().__init__()
        self.preset: Preset | None = None
        self._presets = presets
        items = [(preset.name, translate(preset.title)) for preset in presets]
        self._tip = tip or tr("Fills in suitable values for a purpose; you can change each of them")
        self.choice = combo(name, [*items, (_CUSTOM, tr("Custom"))], self._tip)
        for number, preset in enumerate(presets):
            self.choice.setItemData(number, _note(preset), Qt.ItemDataRole.ToolTipRole)
        model = self.choice.model()
        if isinstance(model, QStandardItemModel):
            # The last item, shown for values of no preset, cannot be chosen.
            model.item(self.choice.count() - 1).setFlags(Qt.ItemFlag.NoItemFlags)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        if labelled:
            label = QLabel(tr("Preset"))
            label.setBuddy(self.choice)
            layout.addWidget(label)
        self.setFocusProxy(self.choice)
        layout.addWidget(self.choice, 1)
        self.choice.activated.connect(self._activated)
        self.show_preset(None)

    def show_preset(self, preset: Preset | None) -> None:
        """Show the preset that is entered, without emitting signals; None for values of no preset."""
        self.preset = preset
        with QSignalBlocker(self.choice):
            self.choice.setCurrentIndex(self.choice.findData(_CUSTOM if preset is None else preset.name))
        self.choice.setToolTip(shown_plain(self._tip if preset is None else f"{_note(preset)}\n{self._tip}"))

    def _activated(self) -> None:
        name = self.choice.currentData()
        found = next((preset for preset in self._presets if preset.name == name), None)
        if found is not None:
            self.chosen.emit(found)


def _note(preset: Preset) -> str:
    return translate(preset.note) + "."
