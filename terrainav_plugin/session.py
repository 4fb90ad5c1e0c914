"""What happens when: from an entry in the dock to figures, preview, background and runs."""

from __future__ import annotations

import html
import traceback
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import QgsProject
from qgis.gui import QgisInterface
from qgis.PyQt.QtCore import QObject, Qt, pyqtSignal
from qgis.PyQt.QtWidgets import QComboBox, QDialog

from ..core.errors import TerrAInavError
from ..core.mission.area import Box
from .area.control import AreaControl
from .area.tools import BoxTool, PointTool
from .capture.queue import Runs
from .cleaning.cleaning import Cleaning
from .form import mission_form
from .form.mission_form import FormError
from .form.state import BOX_FIELDS, FormState
from .i18n import told, tr
from .map.mission_group import MissionGroup
from .messages import Messages
from .missions.missions import Missions
from .panel.camera import camera_choices
from .panel.choices import source_choices
from .panel.dock import Dock
from .panel.figures import readout
from .panel.memory import FormMemory
from .panel.refusals import in_words_of_the_dock, refused_fields
from .panel.runs import RunPanel
from .panel.source_shelf import SourceShelf
from .paths import folder_of, open_in_system
from .planner import Planned, Planner
from .preview.background import Background, SourceOnMap
from .preview.preview import Preview
from .results.viewing import Viewing
from .settings import Settings
from .sources import policy_of
from .widgets import free_of_menus

if TYPE_CHECKING:
    from ..core.mission.mission import Mission

#: Height of a first mission in feet, where those are set: about that in metres.
_USUAL_AGL_FT = 400.0


class Session(QObject):
    """The plugin at work; made when it is first used.

    Signals
    -------
    preview_shown(bool)
        The preview has come or gone, or its layers have in the layer tree.
    running(bool)
        A run has begun or ended.
    """

    preview_shown = pyqtSignal(bool)
    running = pyqtSignal(bool)

    def __init__(self, iface: QgisInterface, messages: Messages) -> None:
        super().__init__()
        self.iface = iface
        self.messages = messages
        self.settings = Settings()
        self._units = self.settings.units
        self.project = QgsProject.instance()
        canvas = iface.mapCanvas()
        self.planner = Planner()
        self.preview = Preview(self.project, canvas)
        self.background = Background(self.project, iface)
        self.box_tool = BoxTool(canvas)
        self.point_tool = PointTool(canvas)
        self.dock = Dock(source_choices(self.project)[0], camera_choices()[0])
        self.source_on_map = SourceOnMap(self.background, self.dock, messages, self.settings)
        self.memory = FormMemory(self.settings, self.state, self)
        self.areas = AreaControl(iface, self.dock, messages, self.box_tool)
        self.runs = Runs(self)
        self.run_panel = RunPanel(
            self.runs,
            self.dock.run_list,
            zoom=lambda run: self.zoom_to(run.mission.area.bounds),
            open_folder=lambda run: open_in_system(run.folder),
            clean=lambda run: self.cleaning.open(run.folder),
        )
        self.missions = Missions(self)
        self.viewing = Viewing(self.project, iface, messages)
        self.cleaning = Cleaning(self)
        self.shelf = SourceShelf(self.project, self.dock.form.imagery, messages, iface.mainWindow())
        self.planned: Planned | None = None
        self._timed: tuple[Mission, str] | None = None
        self._when_planned: Callable[[Planned], None] | None = None
        self._refusal = ""
        self._closed = False
        self._previewing = self._zoom_to_preview = False
        self._connect()
        free_of_menus(self.dock, iface.mainWindow().menuBar())
        iface.addDockWidget(Qt.DockWidgetArea.RightDockWidgetArea, self.dock)
        self._restore()

    # --- what toolbar and dock ask for

    def state(self) -> FormState:
        """What is entered."""
        return self.dock.form.state()

    def show_dock(self, visible: bool) -> None:
        """Show or hide the dock."""
        self.dock.setUserVisible(visible)

    def draw_box(self) -> None:
        """Let the user draw the area."""
        self.dock.setUserVisible(True)
        self.box_tool.start()

    def take_test_shot(self) -> None:
        """Let the user click where one picture is to be taken."""
        self.dock.setUserVisible(True)
        self.point_tool.start()

    def set_preview(self, on: bool) -> None:
        """Show the preview and zoom to it, or take it away."""
        self.dock.setUserVisible(True)
        if not on:
            self.preview.remove()
            self._show_preview_state(False)
            return
        self._zoom_to_preview = True
        # Layers may be there, and hidden.
        self.preview.set_footprints_visible(True)
        self._show_preview_state(True)
        if not self._plan(at_once=True):
            self._show_preview_state(False)
            self.messages.refused(self._reason(), tr("No preview yet."))

    def capture(self, only_failed: bool = False) -> None:
        """Capture the mission that is entered, as it is now; or of it only what has failed."""
        self.dock.setUserVisible(True)
        state, asks = self.state(), self.runs.questions
        if asks.folder_is_given(state) and asks.key_is_there(state.source_name):
            folder = folder_of(state.folder)
            self.with_plan(lambda planned: self.runs.start(planned, folder, only_failed))

    def with_plan(self, act: Callable[[Planned], None], refusal: str = "") -> None:
        """Do something with the plan of what is entered now, as soon as there is one.

        Parameters
        ----------
        refusal : str
            What to say after the reason where there is none.
        """
        if self._closed:
            # Unloaded while a dialog was open that has led here.
            return
        self._when_planned = act
        self._refusal = refusal or tr("Nothing to capture yet.")
        if not self._plan(at_once=True):
            self._when_planned = None
            self.messages.refused(self._reason(), self._refusal)

    def show_on_map(self) -> None:
        """Add the source as background and zoom to the area."""
        self.source_on_map.show()

    def group(self) -> MissionGroup:
        """Group of the mission that is entered."""
        return self.group_of(folder_of(self.state().folder))

    def group_of(self, folder: Path) -> MissionGroup:
        """Group of the mission that is captured into a folder."""
        return MissionGroup(self.project, folder.name or tr("mission"), str(folder))

    def show_preview_again(self) -> None:
        """Show the preview of a mission that has been opened."""
        self._show_preview_state(True)
        self._plan(at_once=True)

    def zoom_to(self, box: Box) -> None:
        """Show an area on the map."""
        try:
            self.background.zoom_to(box)
        except TerrAInavError as wrong:
            self.messages.warning(told(wrong))

    def settings_changed(self) -> None:
        """Take up what the user has set among QGIS's options."""
        units = self.dock.form.findChild(QComboBox, "agl_unit")
        if self._units != self.settings.units:
            self._units = self.settings.units
            units.setCurrentIndex(units.findData(self._units))
        self.dock.form.show_key(self.settings.authcfg(self.state().source_name))
        self._plan()

    def close(self) -> None:
        """Leave nothing behind."""
        self._closed = True
        # One that stays open would be deleted with the dock while it still runs.
        for dialog in self.dock.findChildren(QDialog):
            dialog.reject()
        self.memory.write()
        self.runs.close()
        self.missions.close()
        self.viewing.close()
        self.cleaning.close()
        self.source_on_map.close()
        self.planner.close()
        for signal in (self.project.layersAdded, self.project.layersRemoved, self.project.cleared):
            signal.disconnect(self._show_hint)
        self.shelf.close()
        self.areas.close()
        for tool in (self.box_tool, self.point_tool):
            tool.stop()
            tool.deleteLater()
        self.preview.close()
        self.background.close()
        self.iface.removeDockWidget(self.dock)
        self.dock.deleteLater()

    # --- from entries to a plan

    def _connect(self) -> None:
        form = self.dock.form
        form.changed.connect(self._form_changed)
        form.draw_box_clicked.connect(self.draw_box)
        form.show_on_map_clicked.connect(self.show_on_map)
        form.key.selectedConfigIdChanged.connect(self._key_chosen)
        self.dock.preview_toggled.connect(self.set_preview)
        self.dock.test_shot_clicked.connect(self.take_test_shot)
        self.dock.hint_followed.connect(self._follow_hint)
        self.dock.capture_clicked.connect(self.capture)
        self.running.connect(self.dock.show_busy)
        self.box_tool.refused.connect(self.messages.warning)
        self.point_tool.clicked.connect(self.runs.start_test_shot)
        self.point_tool.refused.connect(self.messages.warning)
        self.planner.planned.connect(self._show_planned)
        self.planner.costed.connect(self._show_cost)
        self.planner.refused.connect(self._show_refused)
        self.preview.closed.connect(lambda: self._show_preview_state(False))
        self.preview.visibility_changed.connect(lambda _visible: self._show_preview_state(self._previewing))
        self.preview.failed.connect(self._preview_failed)
        for signal in (self.project.layersAdded, self.project.layersRemoved, self.project.cleared):
            signal.connect(self._show_hint)

    def _restore(self) -> None:
        state = FormState.from_json(self.settings.form)
        if not self.settings.form and self._units == "ft":
            state = replace(state, agl_unit="ft", agl=_USUAL_AGL_FT)
        if not state.folder:
            state = mission_form.with_folder(state, str(self.settings.missions / "mission-1"))
        self.dock.form.set_state(state)
        self._show_hint()

    def _form_changed(self) -> None:
        self.memory.note()
        self.dock.form.show_key(self.settings.authcfg(self.state().source_name))
        if self._when_planned is not None:
            self._when_planned = None
            self.messages.info(
                tr("The entries have changed before their plan was there: press the button again.")
            )
        self._plan()
        self._show_hint()

    def _plan(self, at_once: bool = False) -> bool:
        """Have what is entered planned; False where an entry is wrong, which is then marked."""
        state = self.state()
        try:
            mission = mission_form.mission(state)
        except FormError as wrong:
            self.planner.forget()
            self.planned = None
            messages = wrong.messages
            if not any(getattr(state, name).strip() for name in BOX_FIELDS):
                # Nothing entered yet is not an error.
                messages = {name: text for name, text in messages.items() if name not in BOX_FIELDS}
            self.dock.form.show_messages(messages)
            unseen = self.dock.form.marks.out_of_sight(messages)
            self.dock.show_problem(unseen) if unseen or state.has_box else self.dock.show_nothing()
            return False
        self.dock.form.show_messages({})
        # Beside a run, times would be those of the run.
        timed = not self._cost_of(mission) and self.runs.idle and self._when_planned is None
        self.planner.request(mission, at_once, timed)
        return True

    def _show_planned(self, planned: Planned) -> None:
        self.planned = planned
        self._show_figures(planned)
        if self._previewing:
            self.preview.show(self.group(), planned.mission, planned.plan)
            self.group().make_current()
            if self._zoom_to_preview:
                self._zoom_to_preview = False
                self._zoom_if_out_of_sight(planned.mission.area.bounds)
        act, self._when_planned = self._when_planned, None
        if act is not None:
            act(planned)

    def _show_cost(self, planned: Planned, cost: str) -> None:
        self._timed = planned.mission, cost
        self._show_figures(planned)

    def _show_figures(self, planned: Planned) -> None:
        cost = self._cost_of(planned.mission)
        if not cost and (not self.runs.idle or self._when_planned is not None):
            cost = tr("not timed beside a run")
        unit = self.state().agl_unit
        policy = policy_of(planned.mission.source)
        self.dock.figures.show_readout(readout(planned.plan, planned.summary, unit, cost, policy))

    def _cost_of(self, mission: Mission) -> str:
        """What a mission's methods were timed at; empty where that is not known."""
        return self._timed[1] if self._timed is not None and self._timed[0] == mission else ""

    def _show_refused(self, error: Exception) -> None:
        self.planned = None
        waiting, self._when_planned = self._when_planned, None
        if isinstance(error, FormError):
            self.dock.form.show_messages(error.messages)
            self.dock.show_problem(self.dock.form.marks.out_of_sight(error.messages))
        elif isinstance(error, TerrAInavError):
            messages = refused_fields(error)
            self.dock.form.show_messages(messages)
            self.dock.show_problem(next(iter(messages.values()), in_words_of_the_dock(error)))
        else:
            self.dock.show_problem(tr("Unexpected error: {error}").format(error=repr(error)))
            self.messages.error(
                tr("The mission could not be planned."),
                "".join(traceback.format_exception(None, error, error.__traceback__)),
            )
        if waiting is not None:
            self.messages.refused(self._reason(), self._refusal)

    def _reason(self) -> str:
        """First thing that is wrong with the entries."""
        wrong = self.dock.form.marks.first_message() or self.dock.problem.text()
        return wrong or tr("no area yet; draw a box or enter coordinates")

    # --- smaller reactions

    def _box(self) -> Box | None:
        """Area that is entered; None while there is none."""
        return mission_form.box(self.state())

    def _key_chosen(self, authcfg: str) -> None:
        self.settings.set_authcfg(self.state().source_name, authcfg)
        # What was said about it no longer holds.
        self._plan()

    def _show_preview_state(self, on: bool) -> None:
        """Keep a preview from now on, or none; the buttons are pressed while it is to be seen."""
        self._previewing = on
        self.areas.show_previewed(on)
        seen = on and self.preview.visible
        self.dock.show_preview_on(seen)
        self.preview_shown.emit(seen)

    def _preview_failed(self, error: Exception) -> None:
        trace = "".join(traceback.format_exception(None, error, error.__traceback__))
        self.messages.error(tr("The preview could not be drawn: {error}").format(error=repr(error)), trace)

    def _zoom_if_out_of_sight(self, box: Box) -> None:
        """Move the map only where the preview could not be seen: users keep the view they chose."""
        canvas = self.iface.mapCanvas()
        try:
            if not canvas.extent().intersects(self.background.rectangle(box)):
                self.background.zoom_to(box)
        except TerrAInavError as wrong:
            self.messages.warning(told(wrong))

    def _show_hint(self, *_: object) -> None:
        hint = ""
        if not self.project.mapLayers():
            hint = tr("The map is empty: {link}, or add layers of your own.").format(
                link=_link("show", tr("show the imagery chosen below and draw a box"))
            )
        elif not self.state().has_box:
            hint = tr("{link} and drag over the area, or paste its coordinates below.").format(
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
