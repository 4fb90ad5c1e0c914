"""All entries of the panel: area, camera, flight, imagery, output and less common entries."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from qgis.core import QgsSettings
from qgis.gui import QgsCollapsibleGroupBoxBasic
from qgis.PyQt.QtCore import QObject, QSignalBlocker, pyqtSignal
from qgis.PyQt.QtWidgets import QVBoxLayout, QWidget

from ...core.mission.presets import Preset
from ..area.editing import AreaEditing
from ..area.entries import AreaEntries
from ..form.camera import GSD_M, settled
from ..form.headings import headings
from ..form.mission_form import drop_extras, extras_text
from ..form.presets import (
    apply_camera_kind,
    apply_preset,
    find_camera_kind,
    find_preset,
    preset_changes,
    with_camera_of,
    without_preset,
)
from ..form.state import FormState, keep_unchanged
from ..i18n import tr
from ..settings import Settings
from ..tasks import single_shot
from ..widgets import STYLE_SHEET, FieldMarks, named
from .camera import CameraEntries
from .choices import CameraChoice, SourceChoice
from .entries import Section
from .headings import Heading
from .imagery import ImageryEntries
from .pages import Pages
from .presets import PresetChooser
from .sections import (
    AccuracySection,
    AttitudeSection,
    FlightEntries,
    LabelsSection,
    OutputEntries,
    PixelsSection,
    RealismSection,
    ReliefSection,
    RouteSection,
    WindSection,
)

_KEY = "TerrAInav/folded/{name}"


class DockForm(QWidget):
    """Entries that together make a mission.

    Signals
    -------
    changed()
        Emitted after every change, by the user or by `set_state`.
    draw_box_clicked(), show_on_map_clicked()
    preset_taken(object, object)
        A preset was chosen; titles of the values that it has changed.
    """

    changed = pyqtSignal()
    draw_box_clicked = pyqtSignal()
    show_on_map_clicked = pyqtSignal()
    preset_taken = pyqtSignal(object, object)

    def __init__(self, sources: Sequence[SourceChoice], cameras: Sequence[CameraChoice]) -> None:
        super().__init__()
        self.marks = FieldMarks()
        self._setting = False
        self._given = self._shown = FormState()
        #: State before a preset was chosen; None once the user has changed a value of the preset.
        self._before_preset: FormState | None = None
        #: Camera that the preset has chosen.
        self._preset_camera: CameraChoice | None = None
        self.setStyleSheet(STYLE_SHEET)
        self._make_groups(sources, cameras)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.pages)
        self._folds = Folds(self.boxes)
        self._headings = {box.objectName(): Heading(box) for box in self.boxes}
        self._show(FormState())
        self.area_editing = AreaEditing(self.area, self.state, self.set_state, self)
        self._connect()

    # --- state

    def state(self) -> FormState:
        """Return the state of the entries."""
        return keep_unchanged(self._read(), self._shown, self._given)

    def _read(self) -> FormState:
        """Return the state of the widgets; fields without a widget stay as given."""
        imagery = self.imagery
        read: dict[str, Any] = {
            **self.area.values(),
            "source": imagery.source.currentData(),
            "template": imagery.template.text(),
            "date": imagery.date.text().strip(),
            "map_types": imagery.ticked(),
            **imagery.others.values(),
            "hidden": self.marks.hidden(),
        }
        for group in self.groups:
            read.update(group.values())
        read["unread"] = tuple(one for group in self.groups for one in group.unread())
        return replace(self._given, **read)

    def set_state(self, state: FormState) -> None:
        """Enter a state, and emit `changed` once, at the end."""
        self.area_editing.wrong = {}
        self._show(state)
        self._folds.restore()
        self.changed.emit()

    def _show(self, state: FormState) -> None:
        """Enter a state without emitting signals."""
        self._setting = True
        try:
            self.area.set_state(state)
            self.imagery.choose_source(state.source)
            self.imagery.enter_map_types(state.map_types)
            self.imagery.template.setText(state.template)
            self.imagery.date.setText(state.date)
            self.imagery.others.enter(state.imagery_name, state.imageries)
            for group in self.groups:
                group.forget_unread()
            self._enter(state)
        finally:
            self._setting = False

    def _enter(self, state: FormState) -> None:
        """Enter a state into the groups; leave entries with the same value alone."""
        setting, self._setting = self._setting, True
        try:
            for group in self.groups:
                group.enter(state)
        finally:
            self._setting = setting
        self._given = state
        self._shown = self._read()

    def show_messages(self, messages: dict[str, str]) -> None:
        """Mark fields with messages; errors of pasted coordinates stay until their field changes."""
        messages = {**messages, **self.area_editing.wrong}
        for group in self.groups:
            group.show_marked(messages)
        self.marks.show(messages)
        self.pages.mark(self.marks.wrong())

    def show_first_wrong(self) -> None:
        """Show the first field with an invalid value."""
        wrong = self.marks.wrong()
        if wrong:
            # In the order of the panel, which is not that of the messages.
            order = [widget for page in self.pages.pages() for widget in page.findChildren(QWidget)]
            self.pages.show_field(min(wrong, key=order.index))

    def show_key(self, authcfg: str) -> None:
        """Show the authentication configuration of the chosen source."""
        if self.key.configId() != authcfg:
            with QSignalBlocker(self.key):
                self.key.setConfigId(authcfg)

    def allow_upsampling(self) -> None:
        """Check the box that allows images finer than the source."""
        self.pixels.upsample.setChecked(True)

    def fly_higher(self) -> None:
        """Enter the height at which the camera's pixels are as large as the source's."""
        gsd_m = self.pixels.source_gsd_m()
        if gsd_m is not None:
            self.camera_gsd.setValue(gsd_m / GSD_M[self.state().agl_unit])

    # --- presets

    def _take_preset(self, preset: Preset) -> None:
        """Enter the values of a preset, in place of the values of the previous preset."""
        state, last = self.state(), self.presets.preset
        if last is not None and self._before_preset is not None:
            if self._preset_camera is not None and self.camera_group.is_entered(self._preset_camera):
                state = with_camera_of(state, self._before_preset)
            state = without_preset(state, last, self._before_preset)
        else:
            self._before_preset = state
        camera = self._preset_camera = self.camera_group.real_camera(state, preset.camera) if preset.camera else None
        entered = apply_preset(state, preset, self.imagery.offered())
        if camera is not None:
            entered = self.camera_group.apply_camera(entered, camera)
        self._set_in_place(entered)
        changes = preset_changes(state, entered, preset, camera.name if camera is not None else "")
        self.preset_taken.emit(preset, changes)

    def _set_in_place(self, state: FormState) -> None:
        """Enter a state; groups that unfold for unusual values do not scroll the chooser out of view."""
        scrolls = [box for box in self.boxes if box.scrollOnExpand()]
        for box in scrolls:
            box.setScrollOnExpand(False)
        self.set_state(state)
        for box in scrolls:
            box.setScrollOnExpand(True)

    def _show_preset(self) -> None:
        preset = find_preset(self.state(), self.imagery.offered())
        if preset is None:
            self._before_preset = None
        self.presets.show_preset(preset)
        self.realism.kinds.show_preset(find_camera_kind(self.state()))

    def _show_headings(self) -> None:
        """Show summaries next to the titles of groups."""
        for name, words in headings(self.state(), self.imagery.title()).items():
            self._headings[name].say(words)

    # --- groups

    def _make_groups(self, sources: Sequence[SourceChoice], cameras: Sequence[CameraChoice]) -> None:
        self.presets = PresetChooser()
        area = self.area = named(AreaEntries(self.marks), "area_group")
        self.edges, self.draw_box = area.edges, area.draw_box
        imagery = self.imagery = named(ImageryEntries(self.marks, sources), "imagery_group")
        self.source, self.template, self.date = imagery.source, imagery.template, imagery.date
        self.key, self.map_types, self.show_on_map = imagery.key, imagery.map_types, imagery.show_on_map
        camera = self.camera_group = CameraEntries(self.marks, cameras)
        self.camera, self.fov, self.aspect = camera.camera, camera.fov, camera.aspect
        flight = self.flight = FlightEntries(self.marks)
        self.agl, self.agl_unit, self.camera_gsd = flight.agl, flight.agl_unit, flight.camera_gsd
        self.overlap_along, self.overlap_across = flight.overlap_along, flight.overlap_across
        self.layout_choice = flight.layout_choice
        output = self.output = OutputEntries(self.marks)
        self.folder, self.image_format = output.folder, output.image_format
        self.attitude, self.pixels = AttitudeSection(self.marks), PixelsSection(self.marks)
        self.relief, self.wind = ReliefSection(self.marks), WindSection(self.marks)
        self.labels, self.realism = LabelsSection(self.marks), RealismSection(self.marks)
        self.route, self.accuracy = RouteSection(self.marks), AccuracySection(self.marks)
        self.sections = (
            *(self.attitude, self.relief, self.labels, self.realism, self.route, self.pixels, self.wind),
            self.accuracy,
        )
        #: Groups whose entries have the names of fields of the state.
        self.groups = (camera, flight, output, *self.sections)
        #: All groups from top to bottom.
        self.boxes = (area, camera, flight, imagery, output, *self.sections)
        self.pages = Pages(
            (
                (tr("Area"), tr("What the images are to show"), (area,)),
                (tr("Flight"), tr("Camera and flight"), (camera, flight)),
                (tr("Imagery"), tr("Imagery and output"), (imagery, output)),
                (
                    tr("Advanced"),
                    tr("Attitude, relief, labels, realism, flight path, pixels, wind and accuracy"),
                    self.sections,
                ),
            )
        )

    # --- reactions

    def _connect(self) -> None:
        self.draw_box.clicked.connect(self.draw_box_clicked)
        self.imagery.show_on_map_clicked.connect(self.show_on_map_clicked)
        self.area_editing.typed.connect(self.changed)
        self.changed.connect(self.area_editing.note)
        self.imagery.changed.connect(self._changed)
        self.presets.chosen.connect(self._take_preset)
        self.realism.kinds.chosen.connect(lambda kind: self._set_in_place(apply_camera_kind(self.state(), kind)))
        self.changed.connect(self._show_preset)
        self.changed.connect(self._show_headings)
        for group in self.groups:
            group.edited.connect(self._edited)
        for section in self.sections:
            section.opened.connect(partial(self._fold_others, section))
        self.camera_group.chosen.connect(self._take_camera)
        self.changed.connect(lambda: self.accuracy.show_more(extras_text(self.state())))
        self.accuracy.reset_clicked.connect(lambda: self.set_state(drop_extras(self.state())))

    def _changed(self) -> None:
        if not self._setting:
            self.changed.emit()

    def _fold_others(self, opened: Section) -> None:
        """Leave one section open, so that the others stay in sight."""
        for section in self.sections:
            if section is not opened:
                section.setCollapsed(True)

    def _edited(self, field: str) -> None:
        """Update the entries that depend on the one changed by the user."""
        if not self._setting:
            self._enter(settled(self._given, self.state(), field))
            self.changed.emit()

    def _take_camera(self, choice: CameraChoice) -> None:
        self._enter(self.camera_group.apply_camera(self.state(), choice))
        self.changed.emit()


class Folds:
    """Store in the settings which groups the user has folded and unfolded."""

    def __init__(self, boxes: Sequence[QgsCollapsibleGroupBoxBasic]) -> None:
        self._boxes = boxes
        self._restored = False
        for box in boxes:
            box.collapsedStateChanged.connect(
                lambda folded, box=box: QgsSettings().setValue(_KEY.format(name=box.objectName()), folded)
            )

    def restore(self) -> None:
        """Restore the folding of the last session; only the first call, made when the entries are restored, does so."""
        if self._restored:
            return
        self._restored = True
        settings = QgsSettings()
        for box in self._boxes:
            key = _KEY.format(name=box.objectName())
            if settings.contains(key):
                box.setCollapsed(settings.value(key, box.isCollapsed(), type=bool))


class FormMemory(QObject):
    """Save the entries to the settings after a pause in typing.

    Parameters
    ----------
    read : callable
        Returns the state of the form.
    """

    def __init__(self, settings: Settings, read: Callable[[], FormState], parent: QObject) -> None:
        super().__init__(parent)
        self._settings, self._read = settings, read
        # Save only after a pause, as QGIS writes its whole settings file each time.
        self._pause = single_shot(self.write, self, 1000)

    @property
    def pending(self) -> bool:
        """Whether there are unsaved changes."""
        return self._pause.isActive()

    def note(self) -> None:
        """Handle a change of the form."""
        self._pause.start()

    def write(self) -> None:
        """Save the current entries."""
        self._pause.stop()
        self._settings.form = self._read().to_json()
