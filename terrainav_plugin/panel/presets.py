"""Chooser of a preset at the top of the panel, with a description of the preset."""

from __future__ import annotations

from qgis.PyQt.QtCore import QSignalBlocker, Qt, pyqtSignal
from qgis.PyQt.QtGui import QStandardItemModel
from qgis.PyQt.QtWidgets import QFormLayout, QVBoxLayout, QWidget

from ...core.mission.presets import PRESETS, Preset
from ..i18n import tr, translate
from ..widgets import combo, wrapped_label

_CUSTOM = ""


class PresetChooser(QWidget):
    """Presets by name, and a line that describes the selected preset.

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

    def __init__(self) -> None:
        super().__init__()
        self.preset: Preset | None = None
        items = [(preset.name, translate(preset.title)) for preset in PRESETS]
        tip = tr("Fills in suitable values for a purpose; you can change each of them")
        self.choice = combo("preset", [*items, (_CUSTOM, tr("Custom"))], tip)
        model = self.choice.model()
        if isinstance(model, QStandardItemModel):
            # The last item, shown for values of no preset, cannot be chosen.
            model.item(self.choice.count() - 1).setFlags(Qt.ItemFlag.NoItemFlags)
        self.note = wrapped_label("preset_note")
        layout = QVBoxLayout(self)
        layout.setContentsMargins(9, 0, 9, 0)
        form = QFormLayout()
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        form.addRow(tr("Preset"), self.choice)
        layout.addLayout(form)
        layout.addWidget(self.note)
        self.choice.activated.connect(self._activated)
        self.show_preset(None)

    def show_preset(self, preset: Preset | None) -> None:
        """Show the preset that is entered, without emitting signals; None for values of no preset."""
        self.preset = preset
        with QSignalBlocker(self.choice):
            self.choice.setCurrentIndex(self.choice.findData(_CUSTOM if preset is None else preset.name))
        self.note.setText("" if preset is None else translate(preset.note) + ".")
        self.note.setVisible(preset is not None)

    def _activated(self) -> None:
        name = self.choice.currentData()
        found = next((preset for preset in PRESETS if preset.name == name), None)
        if found is not None:
            self.chosen.emit(found)
