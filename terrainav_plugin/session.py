"""The running plugin: creates the objects of the rooms, and connects them by signals and callables."""

from __future__ import annotations

import html
import traceback
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import QgsProject, QgsVectorLayer
from qgis.gui import QgisInterface
from qgis.PyQt.QtCore import QObject, pyqtSignal
from qgis.PyQt.QtWidgets import QComboBox, QDialog

from ..core.errors import TerrAInavError
from .area.control import AreaControl
from .area.tools import BoxTool, PointTool
from .capture.queue import Runs
from .dataset.placing import OpenProject
from .dataset_window.datasets import CLEAN, Datasets
from .form.state import FormState
from .i18n import tr, translate
from .live.view import LiveView
from .map.canvas import is_in_sight
from .map.mission_group import GroupsOnTop, MissionGroup
from .messages import Messages
from .missions.missions import Missions
from .panel.alignment import RowAlignment
from .panel.camera import camera_choices
from .panel.choices import source_choices
from .panel.dock import Dock
from .panel.form import FormMemory
from .panel.layers import LabelsLine, LayersLine
from .panel.planning import Planning
from .panel.runs import OpeningRow, RunPanel
from .panel.source_list import SourceList
from .panel.speed import enter_fastest
from .paths import entered_folder, exists, next_folder, open_in_system
from .planner import PlannedMission, Planner
from .preview.background import Background, SourceOnMap
from .preview.picking import PlanPicking
from .preview.preview import Preview
from .processing.windows import BenchmarkWindows
from .profile.profiles import Profiles
from .qgis_source.snapshot import raster_around
from .remote.copies import read_only_reason
from .remote.trust import agree, source_names
from .results.compare import Compare
from .results.viewing import Viewing
from .settings import Settings
from .widgets import add_docked, menu_keys

if TYPE_CHECKING:
    from ..core.mission.areas.area import Box
    from ..core.mission.presets import Preset
    from .plan_features import PlanFeatures


class Session(QObject):
    """The running plugin; created on first use.

    Signals
    -------
    preview_shown(bool)
        Whether the preview is visible; emitted when the preview or its layers are shown or hidden.
    """

    preview_shown = pyqtSignal(bool)

    def __init__(self, iface: QgisInterface, messages: Messages) -> None:
        super().__init__()
        self.iface, self.messages = iface, messages
        self.settings = Settings()
        self._units = self.settings.units
        self.project = QgsProject.instance()
        self.open_project = OpenProject(self.project)
        self._groups_on_top = GroupsOnTop(self.project)
        canvas, window = iface.mapCanvas(), iface.mainWindow()
        self.planner = Planner()
        self.preview = Preview(self.project, canvas)
        self.background = Background(self.project, iface)
        self.box_tool, self.point_tool = BoxTool(canvas), PointTool(canvas)
        self.dock = Dock(source_choices(self.project)[0], camera_choices()[0])
        form = self.dock.form
        self.source_on_map = SourceOnMap(self.background, messages, form.state, form.imagery.title)
        self.memory = FormMemory(self.settings, form.state, self)
        self.areas = AreaControl(iface, self.dock, form.area, form.area_editing, messages, self.box_tool, self._draw)
        self.runs = Runs(messages, window, self.open_project, self.group)
        self.run_panel = RunPanel(
            self.runs,
            self.dock.run_list,
            zoom=lambda run: self.zoom_to_box(run.mission.area.bounds),
            open_folder=lambda run: open_in_system(run.folder),
            clean=lambda run: self.datasets.open(run.folder, CLEAN),
        )
        self.planning = Planning(self.dock, self.planner, messages, lambda: self.runs.idle)
        self.picking = PlanPicking(canvas, messages, form.state, self.planning.has_rows_of)
        self.alignment = RowAlignment(form, self.planning, messages)
        self.missions = Missions(
            self.dock.missions,
            messages,
            self.open_project,
            form.state,
            self._enter_mission,
            lambda: self.runs.folders,
        )
        self.opening_row = OpeningRow(self.dock.run_list, self.missions.stop_opening)
        self.viewing = Viewing(self.project, iface, messages)
        self.compare = Compare(self.project, iface)
        self.profiles = Profiles(iface, messages, lambda: form.state().agl_unit)
        self.live = LiveView(self.project, iface, form.state, lambda: self.planned)
        self.datasets = Datasets(iface, messages, self._datasets)
        self.benchmarks = BenchmarkWindows(iface, messages)
        self.source_list = SourceList(self.project, form.imagery, messages, window, self.background.visible_box)
        self._previewing = self._zoom_to_preview = False
        self._join_panel()
        self._join_rooms()
        self.dock.assign_letters(menu_keys(window.menuBar()))
        add_docked(self.dock, iface)
        self._restore()

    # --- requests of toolbar and panel

    def state(self) -> FormState:
        """State of the panel's entries."""
        return self.dock.form.state()

    @property
    def planned(self) -> PlannedMission | None:
        """Plan of the entered mission; None until it exists."""
        return self.planning.latest

    def show_dock(self, visible: bool) -> None:
        """Show or hide the dock."""
        self.dock.setUserVisible(visible)

    def draw_box(self) -> None:
        """Let the user draw a box."""
        self.dock.setUserVisible(True)
        self._draw(self.box_tool.start)

    def draw_polygon(self) -> None:
        """Let the user draw a polygon."""
        self.dock.setUserVisible(True)
        self._draw(self.areas.polygon_tool.start)

    def take_test_shot(self) -> None:
        """Let the user click the place of a single image."""
        self.dock.setUserVisible(True)
        self.point_tool.start()

    def label_layer(self, layer: QgsVectorLayer) -> None:
        """Enter a mission that labels images with a layer: over its extent, of the imagery below it on the map."""
        self.dock.setUserVisible(True)
        if not self.areas.take_extent(layer):
            return
        form = self.dock.form
        imagery = raster_around(layer, self.project)
        if imagery:
            form.imagery.choose_source(imagery)
        form.findChild(LabelsLine).take_layer(layer)
        self.set_preview(True)

    def set_preview(self, on: bool) -> None:
        """Show the preview and zoom to it, or remove it."""
        self.dock.setUserVisible(True)
        if not on:
            self.preview.remove()
            self._show_preview_state(False)
            return
        self._zoom_to_preview = True
        # The layers may exist but be hidden.
        self.preview.set_footprints_visible(True)
        self._show_preview_state(True)
        if not self.planning.plan(at_once=True):
            self._show_preview_state(False)
            self.planning.refuse(tr("No preview yet."))

    def capture(self, only_failed: bool = False) -> None:
        """Capture the entered mission, or only its failed images."""
        self.dock.setUserVisible(True)
        state = self.state()
        if self.runs.can_start(state):
            folder = entered_folder(state.folder)
            self.planning.use_plan(
                lambda planned: self.runs.start(planned, folder, only_failed),
                tr("Nothing to capture yet."),
                anew=True,
            )

    def make_benchmark(self) -> None:
        """Ask for the settings of a benchmark whose queries are the views of the entered mission."""
        self.dock.setUserVisible(True)
        self.planning.use_plan(lambda planned: self.benchmarks.make(planned.mission), tr("No benchmark yet."))

    def show_on_map(self) -> None:
        """Add the source as background, and zoom to the area."""
        self.source_on_map.show()

    def group(self) -> MissionGroup:
        """Layer tree group of the entered mission."""
        return self.open_project.mission_group(entered_folder(self.state().folder))

    def zoom_to_box(self, box: Box) -> None:
        """Show an area on the map."""
        self._on_map(lambda: self.background.zoom_to_box(box))

    def settings_changed(self) -> None:
        """Apply the settings changed in QGIS's options."""
        units = self.dock.form.findChild(QComboBox, "agl_unit")
        if self._units != self.settings.units:
            self._units = self.settings.units
            units.setCurrentIndex(units.findData(self._units))
        self._show_key()
        self.planning.plan()

    def project_begun(self) -> None:
        """Start a new mission with a new project, unless captures are under way."""
        if self.runs.idle:
            self.missions.begin_anew()

    def close(self) -> None:
        """Remove everything that the session has made."""
        # End open dialogs, which would otherwise be deleted with the dock while they are running.
        for dialog in self.dock.findChildren(QDialog):
            dialog.reject()
        self.memory.write()
        for room in (
            self.runs,
            self.missions,
            self.viewing,
            self.compare,
            self.profiles,
            self.live,
            self.datasets,
            self.benchmarks,
            self.source_on_map,
            self.alignment,
            self.planning,
        ):
            room.close()
        self.open_project.close()
        self._groups_on_top.close()
        for signal in (self.project.layersAdded, self.project.layersRemoved, self.project.cleared):
            signal.disconnect(self._show_hint)
        self.source_list.close()
        self.areas.close()
        self.picking.close()
        for tool in (self.box_tool, self.point_tool):
            tool.stop()
            tool.deleteLater()
        self.preview.close()
        self.background.close()
        self.iface.removeDockWidget(self.dock)
        self.dock.deleteLater()

    # --- connections

    def _join_panel(self) -> None:
        dock, form = self.dock, self.dock.form
        form.changed.connect(self.memory.note)
        form.changed.connect(self._show_key)
        form.changed.connect(self._show_hint)
        form.changed.connect(self.live.refresh)
        form.draw_box_clicked.connect(self.draw_box)
        form.show_on_map_clicked.connect(self.show_on_map)
        form.route.pick_clicked.connect(self.areas.takeoff_tool.start)
        for line in form.findChildren(LayersLine):
            line.refused.connect(self.messages.warning)
        form.route.rows_clicked.connect(lambda: self._pick(self.picking.pick_rows))
        form.route.splits_clicked.connect(lambda: self._pick(self.picking.pick_splits))
        self.picking.entered.connect(form.area_editing.set_entry)
        self.planning.planned.connect(self.picking.show)
        form.preset_taken.connect(self._tell_preset)
        form.key.selectedConfigIdChanged.connect(self._key_chosen)
        dock.preview_toggled.connect(self.set_preview)
        dock.test_shot_clicked.connect(self.take_test_shot)
        dock.hint_followed.connect(self._follow_hint)
        dock.capture_clicked.connect(self.capture)
        # A source in the panel was chosen by the user, or the user has agreed to it.
        self.planning.planned.connect(lambda planned: agree(source_names(planned.mission)))
        self.planning.planned.connect(self._preview_plan)
        self.planner.features_read.connect(self._preview_features)
        self.planning.planned.connect(lambda planned: self.profiles.show_plan(planned.plan))
        self.planning.unplanned.connect(self.profiles.show_reason)
        self.planning.planned.connect(lambda _planned: self.live.show_plan())
        form.flight.profile_clicked.connect(self.profiles.open)
        form.flight.fastest_clicked.connect(lambda: enter_fastest(form, self.planning, self.messages))
        self.planning.planned.connect(lambda _planned: self._show_plannable(""))
        self.planning.unplanned.connect(self._show_unplanned)
        self.source_on_map.drawing.connect(form.show_on_map.setDisabled)
        for signal in (self.project.layersAdded, self.project.layersRemoved, self.project.cleared):
            signal.connect(self._show_hint)

    def _join_rooms(self) -> None:
        form, runs, missions, preview = self.dock.form, self.runs, self.missions, self.preview
        self.box_tool.refused.connect(self.messages.warning)
        self.point_tool.refused.connect(self.messages.warning)
        self.point_tool.clicked.connect(lambda lat, lon: runs.start_test_shot(self.state(), lat, lon))
        self.live.recorded.connect(runs.start_mission)
        runs.running.connect(self.dock.show_busy)
        runs.refused.connect(form.show_messages)
        runs.other_folder_wanted.connect(self._capture_into)
        runs.dataset_wanted.connect(missions.open_dataset)
        runs.results_shown.connect(self._hide_planned)
        runs.results_shown.connect(missions.gather)
        runs.test_shot_shown.connect(self.background.zoom_to_layer)
        missions.preview_wanted.connect(self.set_preview)
        missions.reopened.connect(self._show_preview_again)
        missions.zoom_wanted.connect(self.zoom_to_box)
        missions.refused.connect(form.show_messages)
        missions.capture_failed_wanted.connect(lambda: self.capture(only_failed=True))
        missions.clean_wanted.connect(lambda folder: self.datasets.open(folder, CLEAN))
        missions.opening.connect(self._show_opening)
        missions.plan_export.plan_wanted.connect(self.planning.use_plan)
        missions.plan_export.refused.connect(form.show_messages)
        missions.vehicle_export.plan_wanted.connect(self.planning.use_plan)
        self.dock.export_plan_clicked.connect(missions.plan_export.ask)
        self.datasets.dataset_wanted.connect(missions.open_dataset)
        self.datasets.compare_wanted.connect(self.compare.open)
        missions.compare_wanted.connect(self.compare.open)
        self.datasets.benchmark_wanted.connect(self.make_benchmark)
        self.datasets.score_wanted.connect(self.benchmarks.score)
        preview.closed.connect(lambda: self._show_preview_state(False))
        preview.visibility_changed.connect(lambda _visible: self._show_preview_state(self._previewing))
        preview.failed.connect(self._preview_failed)

    def _restore(self) -> None:
        state = FormState.from_json(self.settings.form)
        if not self.settings.form and self._units == "ft":
            # The default height in feet.
            state = replace(state, agl_unit="ft", agl=400.0)
        if not state.folder:
            first = self.settings.missions / "mission-1"
            self.settings.suggested_folder = str(next_folder(first) if exists(first) else first)
            state = replace(state, folder=self.settings.suggested_folder)
        self.dock.form.set_state(state)
        self._show_hint()

    def _enter_mission(self, state: FormState) -> None:
        """Enter another mission, whose skipped rows and splits are as stated."""
        self.planning.forget_numbers()
        self.dock.form.set_state(state)

    # --- the preview

    def _pick(self, begin: Callable[[], None]) -> None:
        """Begin picking on the preview, which is shown first."""
        if not (self._previewing and self.preview.visible):
            self.set_preview(True)
        begin()

    def _preview_features(self, planned: PlannedMission, features: PlanFeatures) -> None:
        """Add labels and buildings to the preview of a plan."""
        if self._previewing and planned is self.planning.latest:
            self.preview.show(self.group(), planned.mission, planned.plan, features)

    def _preview_plan(self, planned: PlannedMission) -> None:
        if not self._previewing:
            return
        self.preview.show(self.group(), planned.mission, planned.plan)
        self.group().make_current()
        if self._zoom_to_preview:
            self._zoom_to_preview = False
            self._on_map(lambda: self._zoom_if_out_of_sight(planned.mission.area.bounds))

    def _show_preview_again(self) -> None:
        """Show the preview of an opened mission."""
        self._show_preview_state(True)
        self.planning.plan(at_once=True)

    def _show_preview_state(self, on: bool) -> None:
        """Note whether there is a preview; the preview buttons are pressed while it is visible."""
        self._previewing = on
        seen = on and self.preview.visible
        self.picking.show_previewed(seen)
        self.areas.show_previewed(seen)
        self.dock.set_preview_pressed(seen)
        self.preview_shown.emit(seen)

    def _preview_failed(self, error: Exception) -> None:
        trace = "".join(traceback.format_exception(None, error, error.__traceback__))
        self.messages.error(tr("The preview could not be drawn: {error}").format(error=repr(error)), trace)

    def _hide_planned(self, folder: Path) -> None:
        """Hide the planned images of a captured mission, but not if another mission has been planned since."""
        planned = self.planned
        if planned is None or not self.planning.is_entered(planned.mission):
            return
        is_here = self.group().is_same(self.open_project.mission_group(folder))
        if is_here and planned.plans.are_in(folder):
            self.preview.set_footprints_visible(False)

    # --- smaller reactions

    def _show_opening(self, name: str, percent: float) -> None:
        """Show that a dataset is being opened, whose mission the panel will have."""
        has_changed = name != self.dock.opening
        self.dock.opening = name
        self.opening_row.show(name, percent)
        if has_changed:
            self._show_hint()
            if not self.state().has_box:
                self.planning.plan()

    def _show_unplanned(self, reason: str) -> None:
        # Without a reason, the plan is being worked out, and the button waits for it.
        if reason:
            self._show_plannable(self.dock.form.marks.first_message() or reason)

    def _show_plannable(self, reason: str) -> None:
        self.missions.plan_export.reason = reason
        self.dock.show_plannable(reason)

    def _datasets(self) -> list[Path]:
        """Folders of the latest datasets, then the folder of the panel's mission unless it is read-only."""
        in_panel = entered_folder(self.state().folder)
        return [*reversed(self.runs.folders), *([] if read_only_reason(in_panel) else [in_panel])]

    def _capture_into(self, folder: Path) -> None:
        self.missions.restore_dataset(entered_folder(self.state().folder))
        self.settings.suggested_folder = str(folder)
        self.dock.form.set_state(replace(self.state(), folder=str(folder)))
        self.capture()

    def _tell_preset(self, preset: Preset, changes: list[str]) -> None:
        """Say what a preset has changed."""
        text = tr("“{preset}” has set: {values}.") if changes else tr("“{preset}”: its values were there already.")
        self.messages.withdraw("preset")
        with self.messages.topic("preset"):
            self.messages.info(text.format(preset=translate(preset.title), values=", ".join(changes)))

    def _show_key(self) -> None:
        self.dock.form.show_key(self.settings.authcfg(self.state().source_name))

    def _key_chosen(self, authcfg: str) -> None:
        self.settings.set_authcfg(self.state().source_name, authcfg)
        # Plan again, to remove messages about the previous choice.
        self.planning.plan()

    def _on_map(self, zoom: Callable[[], None]) -> None:
        try:
            zoom()
        except TerrAInavError as wrong:
            self.messages.warning(translate(wrong))

    def _draw(self, begin: Callable[[], None]) -> None:
        """Begin drawing; if the map is empty, first show the selected imagery."""
        if self.project.mapLayers():
            begin()
        else:
            self.source_on_map.show(then=begin)

    def _zoom_if_out_of_sight(self, box: Box) -> None:
        """Move the map only if the preview is not in view, to keep the user's view."""
        if not is_in_sight(self.iface.mapCanvas(), self.background.rectangle(box)):
            self.background.zoom_to_box(box)

    def _show_hint(self, *_: object) -> None:
        hint, has_box = "", self.state().has_box
        if self.dock.opening:
            self.dock.show_hint("")
            return
        if not self.project.mapLayers():
            to_show = tr("show the selected imagery") if has_box else tr("show the selected imagery and draw a box")
            hint = tr("The map is empty: {link}, or add layers of your own.").format(link=_link("show", to_show))
        elif not has_box:
            hint = tr("{link} and drag over the area, or paste its coordinates in the tab Area.").format(
                link=_link("draw", tr("Draw a box"))
            )
        self.dock.show_hint(hint)

    def _follow_hint(self, link: str) -> None:
        if link == "show":
            self.source_on_map.show(then=None if self.state().has_box else self.draw_box)
        else:
            self.draw_box()


def _link(address: str, text: str) -> str:
    return f'<a href="{address}">{html.escape(text)}</a>'
