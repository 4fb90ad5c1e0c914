"""The entries of the dock: area, imagery, camera, flight and output."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from qgis.gui import QgsCollapsibleGroupBoxBasic, QgsFileWidget
from qgis.PyQt.QtCore import pyqtSignal
from qgis.PyQt.QtWidgets import (
    QLineEdit,
    QVBoxLayout,
    QWidget,
)

from ..i18n import tr
from .area_entries import AreaEntries
from .choices import CameraChoice, SourceChoice
from .dock_sections import AccuracySection, AttitudeSection, WindSection
from .field_marks import STYLE_SHEET, FieldMarks
from .form_state import M_PER_FT, FormState, with_unchanged
from .form_text import aspect_text, looks_like_coordinates
from .form_widgets import choose, combo, form_layout, row, spin
from .imagery_entries import ImageryEntries
from .mission_form import FormError, beyond_text, with_coordinates


class DockForm(QWidget):
    """Entries that together make a mission.

    Signals
    -------
    changed()
        After every change, typed or set.
    draw_box_clicked(), show_on_map_clicked()
    """

    changed = pyqtSignal()
    draw_box_clicked = pyqtSignal()
    show_on_map_clicked = pyqtSignal()

    def __init__(self, sources: Sequence[SourceChoice], cameras: Sequence[CameraChoice]) -> None:
        super().__init__()
        self.marks = FieldMarks()
        self._cameras = cameras
        self._setting = False
        self._coordinates_wrong = ""
        self._more = ""
        self.setStyleSheet(STYLE_SHEET)
        area = AreaEntries(self.marks)
        self.edges, self.draw_box = area.edges, area.draw_box
        imagery = self.imagery = ImageryEntries(self.marks, sources)
        self.source, self.template, self.date = imagery.source, imagery.template, imagery.date
        self.key, self.map_types, self.show_on_map = imagery.key, imagery.map_types, imagery.show_on_map
        camera, output = self._camera_box(), self._output_box()
        self.attitude, self.wind = AttitudeSection(self.marks), WindSection(self.marks)
        self.accuracy = AccuracySection(self.marks)
        self.sections = (self.attitude, self.wind, self.accuracy)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        for box in (area, imagery, camera, *self.sections, output):
            layout.addWidget(box)
        layout.addStretch(1)
        self._given = self._shown = self._read()
        self._connect()

    # --- the entries as a value

    def state(self) -> FormState:
        """Return what is entered."""
        return with_unchanged(self._read(), self._shown, self._given)

    def _read(self) -> FormState:
        """Return what the widgets say."""
        return FormState(
            north=self.edges["north"].text(),
            west=self.edges["west"].text(),
            south=self.edges["south"].text(),
            east=self.edges["east"].text(),
            fov_deg=self.fov.value(),
            aspect=self.aspect.text(),
            agl=self.agl.value(),
            agl_unit=self.agl_unit.currentData(),
            overlap_along=self.overlap_along.value() / 100.0,
            overlap_across=self.overlap_across.value() / 100.0,
            layout=self.layout_choice.currentData(),
            map_types=tuple(
                name for name, check in self.map_types.items() if check.isChecked() and check.isEnabled()
            ),
            source=self.source.currentData(),
            template=self.template.text(),
            date=self.date.text().strip(),
            image_format=self.image_format.currentData(),
            folder=self.folder.filePath(),
            more=self._more,
            **{name: value for section in self.sections for name, value in section.values().items()},
        )

    def set_state(self, state: FormState) -> None:
        """Enter a state; `changed` comes once, at the end."""
        self._setting = True
        try:
            for name, edit in self.edges.items():
                edit.setText(getattr(state, name))
            self.fov.setValue(state.fov_deg)
            self.aspect.setText(state.aspect)
            choose(self.agl_unit, state.agl_unit)
            self._agl_unit_shown = state.agl_unit
            self.agl.setValue(state.agl)
            self.overlap_along.setValue(100.0 * state.overlap_along)
            self.overlap_across.setValue(100.0 * state.overlap_across)
            choose(self.layout_choice, state.layout)
            self.imagery.choose_source(state.source)
            for name, check in self.map_types.items():
                check.setChecked(name in state.map_types)
            self.template.setText(state.template)
            self.date.setText(state.date)
            choose(self.image_format, state.image_format)
            self.folder.setFilePath(state.folder)
            for section in self.sections:
                section.set_state(state)
            self._more = state.more
        finally:
            self._setting = False
        self._given, self._shown = state, self._read()
        self._show_camera_name()
        self._coordinates_wrong = ""
        self.changed.emit()

    def show_messages(self, messages: dict[str, str]) -> None:
        """Mark fields; what was wrong with pasted coordinates stays until the field changes."""
        if self._coordinates_wrong:
            messages = {**messages, "north": self._coordinates_wrong}
        for section in self.sections:
            section.show_marked(messages)
        self.marks.show(messages)

    def show_key(self, authcfg: str) -> None:
        """Show which authentication configuration holds the key of the chosen source."""
        if self.key.configId() != authcfg:
            self.key.blockSignals(True)
            self.key.setConfigId(authcfg)
            self.key.blockSignals(False)

    # --- groups

    def _camera_box(self) -> QgsCollapsibleGroupBoxBasic:
        box = QgsCollapsibleGroupBoxBasic(tr("Camera and flight"))
        form = form_layout(box)
        self.camera = combo("camera", (), tr("Fills in field of view and aspect ratio"))
        for choice in self._cameras:
            self.camera.addItem(choice.name, choice)
        self.camera.addItem(tr("Own values"), None)
        form.addRow(tr("Camera"), self.camera)
        self.fov = spin(
            "fov_deg", 0.0, 360.0, 6, " °", tr("Field of view across the picture's diagonal, in degrees")
        )
        form.addRow(tr("Field of view"), self.marks.field("fov_deg", self.fov))
        self.aspect = QLineEdit()
        self.aspect.setObjectName("aspect")
        self.aspect.setToolTip(tr("Picture width to height: 4:3, 4000x3000 or 1.333"))
        form.addRow(tr("Aspect ratio"), self.marks.field("aspect", self.aspect))
        self.agl = spin("agl", -1e9, 1e9, 4, "", tr("Height above the ground (AGL) in the unit beside"))
        self.agl_unit = combo(
            "agl_unit", (("m", tr("m")), ("ft", tr("ft"))), tr("Metres or international feet")
        )
        self._agl_unit_shown = "m"
        form.addRow(
            tr("Height above ground"),
            self.marks.field("agl", self.agl, row(self.agl, self.agl_unit, stretch=0)),
        )
        tip = tr("Share of a picture that the next one of its row shows again, in percent")
        self.overlap_along = spin("overlap_along", 0.0, 100.0, 1, " %", tip)
        self.overlap_along.setPrefix(tr("along") + " ")
        tip = tr("Share of a picture that the next row shows again, in percent")
        self.overlap_across = spin("overlap_across", 0.0, 100.0, 1, " %", tip)
        self.overlap_across.setPrefix(tr("across") + " ")
        spins = row(self.overlap_along, self.overlap_across)
        overlaps = self.marks.field("overlap_along", self.overlap_along, spins)
        overlaps = self.marks.field("overlap_across", self.overlap_across, overlaps)
        form.addRow(tr("Overlap"), overlaps)
        self.layout_choice = combo(
            "layout",
            (
                ("cover", tr("Cover (no gaps)")),
                ("paper", tr("Paper (UTM grid)")),
            ),
            tr("Cover: rows along parallels that leave nothing out. Paper: the grid as published."),
        )
        form.addRow(tr("Layout"), self.marks.field("layout", self.layout_choice))
        return box

    def _output_box(self) -> QgsCollapsibleGroupBoxBasic:
        box = QgsCollapsibleGroupBoxBasic(tr("Output"))
        form = form_layout(box)
        self.folder = QgsFileWidget()
        self.folder.setObjectName("folder")
        self.folder.setStorageMode(QgsFileWidget.StorageMode.GetDirectory)
        self.folder.setDialogTitle(tr("Folder for the pictures"))
        self.folder.setToolTip(tr("Folder for the pictures; its last part names the mission on the map"))
        form.addRow(tr("Folder"), self.marks.field("folder", self.folder))
        self.image_format = combo(
            "image_format",
            (
                ("tif", tr("GeoTIFF (lossless)")),
                ("jpg", tr("JPEG (smaller)")),
                ("png", tr("PNG")),
            ),
            tr("All three know their coordinate reference system"),
        )
        form.addRow(tr("Format"), self.marks.field("image_format", self.image_format))
        return box

    # --- reactions

    def _connect(self) -> None:
        self.draw_box.clicked.connect(self.draw_box_clicked)
        self.imagery.show_on_map_clicked.connect(self.show_on_map_clicked)
        for edit in self.edges.values():
            edit.textChanged.connect(self._take_pasted)
        self.camera.activated.connect(self._take_camera)
        self.fov.valueChanged.connect(self._show_camera_name)
        self.aspect.textChanged.connect(self._show_camera_name)
        self.agl_unit.currentIndexChanged.connect(self._convert_agl)
        for signal in (
            self.imagery.changed,
            self.fov.valueChanged,
            self.aspect.textChanged,
            self.agl.valueChanged,
            self.agl_unit.currentIndexChanged,
            self.overlap_along.valueChanged,
            self.overlap_across.valueChanged,
            self.layout_choice.currentIndexChanged,
            self.image_format.currentIndexChanged,
            self.folder.fileChanged,
            *(section.changed for section in self.sections),
        ):
            signal.connect(self._changed)
        self.changed.connect(lambda: self.accuracy.show_more(beyond_text(self.state())))
        self.accuracy.reset_clicked.connect(lambda: self.set_state(replace(self.state(), more="")))

    def _changed(self) -> None:
        if not self._setting:
            self.changed.emit()

    def _take_pasted(self, text: str) -> None:
        """Spread coordinates pasted into one field over all of them."""
        if self._setting:
            return
        self._coordinates_wrong = ""
        if looks_like_coordinates(text):
            try:
                self.set_state(with_coordinates(self.state(), text))
            except FormError as wrong:
                self._coordinates_wrong = wrong.messages["north"]
            else:
                return
        self.changed.emit()

    def _take_camera(self) -> None:
        choice = self.camera.currentData()
        if choice is not None:
            self.set_state(
                replace(self.state(), fov_deg=choice.fov_deg, aspect=aspect_text(choice.aspect_ratio))
            )

    def _show_camera_name(self) -> None:
        """Name the camera whose values are entered."""
        if self._setting:
            return
        values = (round(self.fov.value(), 6), self.aspect.text().strip())
        for index, choice in enumerate(self._cameras):
            if values == (round(choice.fov_deg, 6), aspect_text(choice.aspect_ratio)):
                # Cameras may share their values; the one chosen stays.
                current = self.camera.currentData()
                if current is None or values != (
                    round(current.fov_deg, 6),
                    aspect_text(current.aspect_ratio),
                ):
                    self.camera.setCurrentIndex(index)
                return
        self.camera.setCurrentIndex(self.camera.count() - 1)

    def _convert_agl(self) -> None:
        """Keep the height when its unit changes."""
        unit = self.agl_unit.currentData()
        if self._setting or unit == self._agl_unit_shown:
            return
        self._agl_unit_shown = unit
        factor = 1.0 / M_PER_FT if unit == "ft" else M_PER_FT
        self.agl.blockSignals(True)
        self.agl.setValue(self.agl.value() * factor)
        self.agl.blockSignals(False)
