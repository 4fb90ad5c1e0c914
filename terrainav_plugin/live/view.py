"""The live view: picture, map and entries at one pose, which the user or the flight's time changes."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from datetime import datetime, timezone
from typing import TYPE_CHECKING

from qgis.core import QgsProject
from qgis.gui import QgisInterface
from qgis.PyQt.QtCore import QObject, QSignalBlocker, Qt, QTimer, pyqtSignal

from ...core.dataset.folder import MISSION_FILE
from ...core.errors import TerrAInavError
from ..form import mission_form
from ..i18n import tr, translate
from ..map.canvas import canvas_lon_lat, canvas_rectangle, is_in_sight, shown_times_ms
from ..paths import entered_folder, exists, next_folder
from ..settings import Settings
from ..tasks import failure_reason, single_shot
from ..widgets import add_docked, remove_menu_mnemonics
from .dock import LiveDock
from .feed import LiveFeed
from .marks import CameraMarks
from .recording import Recording
from .source import LiveSource
from .tool import CameraTool

if TYPE_CHECKING:
    from ...core.live.camera import FrameRequest
    from ...core.mission.plan import Plan
    from ..form.state import FormState
    from ..planner import PlannedMission
    from .flight import FlightPoses
    from .source import LiveImage

#: Height at which the panel opens.
_HEIGHT_PX = 420
#: Pause in the panel's changes before the camera follows them.
_PAUSE_MS = 300


class LiveView(QObject):
    """The panel with the live picture, and the camera on the map; both work only while the panel is seen.

    Parameters
    ----------
    state : callable
        Returns the entries of the mission.
    planned : callable
        Returns the `PlannedMission` to follow; None without one.

    Signals
    -------
    recorded(object, object)
        A mission to be captured, and its folder.
    shown(bool)
        Whether the panel is seen.
    """

    recorded = pyqtSignal(object, object)
    shown = pyqtSignal(bool)

    def __init__(
        self,
        project: QgsProject,
        iface: QgisInterface,
        state: Callable[[], FormState],
        planned: Callable[[], PlannedMission | None],
    ) -> None:
        super().__init__()
        self._project, self._iface, self._canvas = project, iface, iface.mapCanvas()
        self._state, self._planned = state, planned
        self.dock: LiveDock | None = None
        self.pose: FrameRequest | None = None
        self.recording: Recording | None = None
        self._home: tuple[float, float] | None = None
        self._source: LiveSource | None = None
        self._flight: tuple[Plan, FlightPoses] | None = None
        self._latest: LiveImage | None = None
        self.feed = LiveFeed()
        self.feed.shown.connect(self._show)
        self.feed.failed.connect(lambda error: self._refuse(translate(failure_reason(error))))
        self.marks = CameraMarks(self._canvas)
        self.tool = CameraTool(self._canvas, self.marks)
        self.tool.moved.connect(lambda lat, lon: self._change(lat_deg=lat, lon_deg=lon))
        self.tool.turned.connect(lambda yaw: self._change(yaw_deg=(yaw + 180.0) % 360.0 - 180.0))
        self.tool.refused.connect(self._refuse)
        self._soon = single_shot(self._reopen, self, _PAUSE_MS)
        self._clock = QTimer(self)
        self._clock.timeout.connect(self._note_pose)
        project.cleared.connect(self._forget)
        self._canvas.temporalRangeChanged.connect(self._follow)

    @property
    def is_seen(self) -> bool:
        """Whether the panel is seen."""
        return self.dock is not None and self.dock.isUserVisible()

    @property
    def follows(self) -> bool:
        """Whether the camera follows the flight."""
        return self.dock is not None and self.dock.follow.isChecked()

    def open(self) -> None:
        """Show the panel, and let the user move the camera on the map."""
        if self.dock is None:
            self.dock = self._make_dock()
            add_docked(self.dock, self._iface, area=Qt.DockWidgetArea.LeftDockWidgetArea)
            self._iface.mainWindow().resizeDocks([self.dock], [_HEIGHT_PX], Qt.Orientation.Vertical)
        self.dock.setUserVisible(True)
        self._begin()
        if self.pose is not None and not self.follows:
            self.tool.start()

    def hide(self) -> None:
        """Hide the panel, which stops everything."""
        if self.dock is not None:
            self.dock.setUserVisible(False)

    def close(self) -> None:
        """Stop for good, and remove the panel."""
        self._project.cleared.disconnect(self._forget)
        self._canvas.temporalRangeChanged.disconnect(self._follow)
        self.recording = None
        self._stop()
        self.feed.close()
        self.marks.close()
        self.tool.deleteLater()
        if self.dock is not None:
            dock, self.dock = self.dock, None
            dock.visibilityChanged.disconnect(self._visibility_changed)
            self._iface.removeDockWidget(dock)
            dock.deleteLater()

    def refresh(self) -> None:
        """Take up changed entries of the mission, after a pause."""
        if self.is_seen:
            self._soon.start()

    def show_plan(self) -> None:
        """Follow a new plan."""
        if self.follows:
            self._follow()

    # --- beginning and end

    def _make_dock(self) -> LiveDock:
        dock = LiveDock()
        first = Settings().missions / "live-1"
        dock.folder.setFilePath(str(next_folder(first) if exists(first) else first))
        remove_menu_mnemonics(dock, self._iface.mainWindow().menuBar())
        dock.visibilityChanged.connect(self._visibility_changed)
        dock.pose_entered.connect(self._enter)
        dock.place.toggled.connect(lambda on: self.tool.start() if on else self.tool.stop())
        dock.follow.toggled.connect(self._set_following)
        dock.record.toggled.connect(self._set_recording)
        self.tool.activated.connect(lambda: self._press_place(True))
        self.tool.deactivated.connect(lambda: self._press_place(False))
        return dock

    def _press_place(self, on: bool) -> None:
        if self.dock is not None:
            with QSignalBlocker(self.dock.place):
                self.dock.place.setChecked(on)

    def _visibility_changed(self, visible: bool) -> None:
        if visible:
            self._begin()
        else:
            self._finish_recording()
            self._stop()
        self.shown.emit(visible)

    def _begin(self) -> None:
        """Open the camera of the mission, and take its first picture."""
        if self._source is not None:
            return
        try:
            if self.pose is None:
                self.pose = self._first_pose()
            self._home = self.pose.lat_deg, self.pose.lon_deg
        except TerrAInavError as wrong:
            self.dock.show_text("")
            self._refuse(translate(wrong))
            return
        self._reopen()

    def _stop(self) -> None:
        for timer in (self._soon, self._clock):
            timer.stop()
        self.feed.stop()
        self._source = self._latest = self._flight = None
        self.tool.stop()
        self.marks.clear()

    def _forget(self) -> None:
        """End with the project."""
        self._drop_recording()
        if self.dock is not None:
            self.dock.follow.setChecked(False)
        self.hide()
        self._stop()
        self.pose = None

    def _first_pose(self) -> FrameRequest:
        """Pose above the middle of the mission's area if it is in sight, otherwise above the middle of the map."""
        from ...core.live.camera import FrameRequest

        state = self._state()
        crs = self._canvas.mapSettings().destinationCrs()
        box = mission_form.box(state)
        if box is not None and (
            not self._project.mapLayers() or is_in_sight(self._canvas, canvas_rectangle(box, crs, self._project))
        ):
            west, south, east, north = box.edges_deg
            lat, lon = (south + north) / 2.0, (west + east) / 2.0
        else:
            lon, lat = canvas_lon_lat(self._canvas.center(), crs, self._project)
        attitude = mission_form.single_view(state, lat, lon).attitude
        return FrameRequest(lat, lon, state.agl_m, attitude.yaw_deg, attitude.tilt_deg, attitude.roll_deg)

    def _reopen(self) -> None:
        """Take pictures of the mission as it is entered now."""
        if self.dock is None or self.pose is None or self._home is None:
            return
        state = self._state()
        self.dock.set_unit(state.agl_unit)
        try:
            mission = mission_form.single_view(state, *self._home)
            if self._source is not None and self._source.mission == mission:
                return
            source = LiveSource(mission)
        except TerrAInavError as wrong:
            self.feed.stop()
            self._source = None
            self._refuse(translate(wrong))
            return
        self.dock.show_problem("")
        if self._latest is None:
            self.dock.show_text(tr("Opening the imagery…"))
        self._source = source
        self.feed.open(source)
        if self.follows:
            self._follow()
        else:
            self._set_pose(self.pose)

    # --- the pose

    def _change(self, **values: float) -> None:
        """Change the pose by the map or the entries."""
        if self.pose is not None and not self.follows:
            self._set_pose(self.pose._replace(**values))

    def _enter(self, name: str, value: float) -> None:
        self._change(**{"up_m" if name == "height" else f"{name}_deg": value})

    def _set_pose(self, pose: FrameRequest) -> None:
        self.pose = pose
        self.tool.set_yaw(pose.yaw_deg)
        self.marks.show_pose(pose)
        self.dock.show_pose(pose, None if pose.above_ellipsoid else pose.up_m)
        self.feed.ask(pose)

    def _show(self, taken: LiveImage) -> None:
        self._latest = taken
        if self.dock is None:
            return
        self.dock.show_problem("")
        self.dock.show_image(taken, self._state().agl_unit)
        self.marks.show_footprint(taken.footprint, taken.crs)
        if taken.request.above_ellipsoid:
            self.dock.show_pose(taken.request, taken.agl_m)

    def _refuse(self, text: str) -> None:
        if self.dock is not None:
            self.dock.show_problem(text)

    # --- following the flight

    def _set_following(self, on: bool) -> None:
        self.dock.show_following(on)
        if on:
            self.tool.stop()
            self._follow()
            return
        self.dock.show_problem("")
        if self.pose is not None and self.pose.above_ellipsoid:
            # Stay where the flight was.
            ground_m = 0.0 if self._latest is None else self._latest.ground_m
            self._set_pose(self.pose._replace(up_m=self.pose.up_m - ground_m, above_ellipsoid=False))

    def _follow(self, *_: object) -> None:
        """Move the camera to where the flight is at the time of the map."""
        from .flight import FlightPoses

        if not (self.is_seen and self.follows):
            return
        self.feed.forget()
        planned = self._planned()
        if planned is None:
            self._refuse(tr("There is no flight to follow: enter a mission in the panel first."))
            return
        if self._flight is None or self._flight[0] is not planned.plan:
            self._flight = planned.plan, FlightPoses(planned.plan)
        poses = self._flight[1]
        times_ms = shown_times_ms(self._canvas.mapSettings())
        begin, end = map(_utc_text, poses.span_s)
        if times_ms is None:
            text = tr("The flight is from {begin} to {end} UTC: play it in QGIS's temporal controller.")
            self._refuse(text.format(begin=begin, end=end))
            return
        moment_s = next((at / 1000.0 for at in times_ms if math.isfinite(at)), poses.span_s[0])
        pose = poses.at(moment_s)
        if pose is None:
            text = tr("The flight is from {begin} to {end} UTC, and the temporal controller at {now}.")
            self._refuse(text.format(begin=begin, end=end, now=_utc_text(moment_s)))
            return
        self._set_pose(pose)
        self._add_pose(pose)

    # --- recording

    def _set_recording(self, on: bool) -> None:
        if not on:
            self._finish_recording()
            return
        problem = self._recording_problem()
        if problem:
            self._refuse(problem)
            self._drop_recording()
            return
        self.recording = Recording(self._state())
        if self.follows:
            self._follow()
        else:
            self._note_pose()
            self._clock.start(round(1000.0 / self.dock.rate.value()))
        self.dock.show_recording(len(self.recording))

    def _recording_problem(self) -> str:
        """Why nothing can be recorded; empty if it can."""
        if self.pose is None or not self.feed.is_open:
            return self.dock.problem.text() or tr("There is no picture to record.")
        text = self.dock.folder.filePath().strip()
        if not text:
            return tr("Name a folder for the recording.")
        folder = entered_folder(text)
        if exists(folder / MISSION_FILE):
            return tr("{folder} holds a mission already: name another folder.").format(folder=folder)
        return ""

    def _note_pose(self) -> None:
        """Record where the user has the camera now."""
        if self.pose is not None:
            self._add_pose(self.pose._replace(time_s=time.time()))

    def _add_pose(self, pose: FrameRequest) -> None:
        if self.recording is not None:
            self.recording.add(pose)
            self.dock.show_recording(len(self.recording))
            if self.recording.is_full:
                self._finish_recording()

    def _drop_recording(self) -> None:
        self._clock.stop()
        self.recording = None
        if self.dock is not None:
            with QSignalBlocker(self.dock.record):
                self.dock.record.setChecked(False)
            self.dock.show_recording(None)

    def _finish_recording(self) -> None:
        """Have the recorded poses captured."""
        recording = self.recording
        self._drop_recording()
        if recording is None or not len(recording):
            return
        folder = entered_folder(self.dock.folder.filePath())
        try:
            mission = recording.mission()
        except TerrAInavError as wrong:
            self._refuse(translate(wrong))
            return
        self.dock.folder.setFilePath(str(next_folder(folder, [folder])))
        self.recorded.emit(mission, folder)


def _utc_text(unix_s: float) -> str:
    """Date and time to the second, as in the temporal controller."""
    return datetime.fromtimestamp(unix_s, timezone.utc).strftime("%Y-%m-%d %H:%M:%S")
