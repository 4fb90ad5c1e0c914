"""Captures and test shots: started, watched, ended."""

from __future__ import annotations

import html
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import QgsApplication, QgsProcessingUtils
from qgis.PyQt.QtCore import QObject, QUrl
from qgis.PyQt.QtGui import QDesktopServices
from qgis.PyQt.QtWidgets import QMessageBox

from ..core.errors import TerrAInavError
from .capture_task import CaptureTask
from .dock import mission_form
from .dock.estimates import duration_text
from .dock.mission_form import FormError, FormState
from .i18n import tr
from .map.results import load_results, load_test_shot
from .sources import grid_of, key_in, terms_problem

if TYPE_CHECKING:
    from ..core.capture.runner import CaptureResult, Progress
    from ..core.mission.mission import Mission
    from .planner import Planned
    from .workflow import Workflow

#: A rate is shown once so many pictures are there: the first ones wait for connections.
_LEAST_FOR_RATE = 10


class Runs(QObject):
    """At most one run at a time."""

    def __init__(self, workflow: Workflow) -> None:
        super().__init__()
        self._workflow = workflow
        self._messages = workflow.messages
        self.task: CaptureTask | None = None

    def folder_is_given(self, state: FormState) -> bool:
        """Whether there is a folder to write to; says so at the field where there is none."""
        if state.folder.strip():
            return True
        message = tr("folder is empty: choose where the pictures go")
        self._workflow.dock.form.show_messages({"folder": message})
        self._messages.warning(tr("Nothing to capture yet: {reason}").format(reason=message))
        return False

    def start(self, planned: Planned) -> None:
        """Capture a plan, after what has to be asked has been asked."""
        mission, state = planned.mission, self._workflow.state()
        folder = Path(state.folder.strip()).expanduser()
        if self.task is not None or self._belongs_to_another(mission, folder):
            return
        requests = planned.plan.requests * len(mission.map_types)
        if not self._terms_allow(mission, requests):
            return
        key = key_in(self._workflow.settings.authcfg(state.source))
        try:
            task = CaptureTask(planned.plan, folder, key)
        except TerrAInavError as wrong:
            self._messages.warning(tr("Nothing captured: {reason}").format(reason=wrong))
            return
        self._run(task, self._capture_ended)

    def start_test_shot(self, lat_deg: float, lon_deg: float) -> None:
        """Capture one picture above a point, with camera, height and source as entered."""
        from ..core.mission.plan import plan

        if self.task is not None:
            return
        state = self._workflow.state()
        try:
            mission = mission_form.test_shot(state, lat_deg, lon_deg)
            steps = plan(mission, grid_of(mission))
        except FormError as wrong:
            self._workflow.dock.form.show_messages(wrong.messages)
            self._messages.warning(tr("No test shot: {reason}").format(reason=wrong))
            return
        except TerrAInavError as wrong:
            self._messages.warning(tr("No test shot: {reason}").format(reason=wrong))
            return
        if not self._terms_allow(mission, steps.requests):
            return
        # QGIS removes its temporary folder when it ends.
        folder = Path(QgsProcessingUtils.generateTempFilename("test-shot"))
        key = key_in(self._workflow.settings.authcfg(state.source))
        self._run(CaptureTask(steps, folder, key, test_shot=True), self._test_shot_ended)

    def cancel(self) -> None:
        """Stop the run; what is finished is kept."""
        if self.task is not None:
            self.task.cancel()
            self._workflow.dock.show_running(tr("Stopping…"), self.task.progress())

    def close(self) -> None:
        """Stop the run and wait for its end, without a word."""
        if self.task is None:
            return
        task, self.task = self.task, None
        for signal in (task.progressed, task.progressChanged, task.ended):
            signal.disconnect()
        task.cancel()
        task.waitForFinished()

    # --- before

    def _belongs_to_another(self, mission: Mission, folder: Path) -> bool:
        """Whether the folder holds another mission; offers one beside it."""
        from ..core.capture.folder import MISSION_FILE

        mark = folder / MISSION_FILE
        try:
            if not mark.is_file() or mark.read_bytes() == mission.to_json().encode():
                return False
        except OSError:
            # The run itself says what is wrong with the folder.
            return False
        other = next_folder(folder)
        self._messages.warning(
            tr("{folder} holds another mission; nothing was changed there.").format(folder=folder),
            action=(tr("Capture into {name}").format(name=other.name), lambda: self._capture_into(other)),
        )
        return True

    def _capture_into(self, folder: Path) -> None:
        self._workflow.dock.form.set_state(mission_form.with_folder(self._workflow.state(), str(folder)))
        self._workflow.capture()

    def _terms_allow(self, mission: Mission, requests: int) -> bool:
        """Whether the source's terms allow a run; asks the user where agreeing to them is enough."""
        problem = terms_problem(mission, requests)
        if problem is None:
            return True
        text, can_agree = problem
        window, title = self._workflow.iface.mainWindow(), tr("TerrAInav: terms of the source")
        if not can_agree:
            # The message bar shows its first lines only.
            self._messages.warning(
                text, action=(tr("Terms and alternatives"), lambda: QMessageBox.warning(window, title, text))
            )
            return False
        asked = tr("Do you agree to these terms, and are you allowed to download?")
        answer = QMessageBox.question(window, title, f"{text}<p>{html.escape(asked)}</p>")
        return answer == QMessageBox.StandardButton.Yes

    # --- while

    def _run(self, task: CaptureTask, ended: object) -> None:
        self.task = task
        task.progressed.connect(self._show_progress)
        task.progressChanged.connect(self._show_share)
        task.ended.connect(ended)
        self._workflow.dock.show_running(tr("Starting…"))
        self._workflow.running.emit(True)
        QgsApplication.taskManager().addTask(task)

    def _show_progress(self, progress: Progress) -> None:
        if self.task is None or self.task.isCanceled():
            return
        after = tr("; making the mosaic…") if self.task.plan.size_px is None else ""
        text = _progress_text(progress, self.task.started_s, after)
        self._workflow.dock.show_running(text, self.task.progress())

    def _show_share(self, percent: float) -> None:
        self._workflow.dock.progress.setValue(int(percent))

    # --- after

    def _capture_ended(self, task: CaptureTask) -> None:
        self._tell(task)
        if task.result is not None and not task.result.cancelled and (task.mosaics or task.plan.size_px):
            self._show(lambda: self._load_results(task))
        self._over()

    def _test_shot_ended(self, task: CaptureTask) -> None:
        if task.picture is not None:
            self._show(lambda: self._load_test_shot(task))
        else:
            self._tell(task)
        self._over()

    def _over(self) -> None:
        self.task = None
        self._workflow.dock.show_running(None)
        self._workflow.running.emit(False)

    def _show(self, load: Callable[[], None]) -> None:
        try:
            load()
        except TerrAInavError as wrong:
            self._messages.error(str(wrong))

    def _load_results(self, task: CaptureTask) -> None:
        load_results(self._workflow.group_of(task.folder), task.folder, task.mosaics, task.plan.mission)
        # The pictures themselves are there now; plans on top would only hide them.
        self._workflow.preview.set_footprints_visible(False)

    def _load_test_shot(self, task: CaptureTask) -> None:
        lat, lon, _ = task.plan.mission.area.poses[0]
        title = tr("Test shot {lat:.5f} {lon:.5f}").format(lat=lat, lon=lon)
        layer = load_test_shot(self._workflow.group(), task.picture, title)
        self._workflow.background.zoom_to_layer(layer)

    def _tell(self, task: CaptureTask) -> None:
        """Say how a run ended."""
        result = task.result
        if task.error:
            tell = self._messages.error if task.trace else self._messages.warning
            tell(_with_kept(task.error, result), task.trace)
        elif result is None:
            self._messages.info(tr("Stopped before the first image."))
        elif result.cancelled:
            self._messages.info(
                tr("Stopped: {there} of {total} images are there. Press Capture to go on.").format(
                    there=f"{result.written + result.skipped:,}", total=f"{result.total:,}"
                )
            )
        elif result.failed:
            self._tell_failed(result)
        else:
            text = _done_text(result)
            if task.plan.size_px is not None:
                text += " " + tr("Camera frames make no mosaic: see their footprints.")
            self._messages.success(text, (tr("Open folder"), lambda: _open(result.folder)))

    def _tell_failed(self, result: CaptureResult) -> None:
        first = result.failed[0]
        text = tr("{failed} of {total} images could not be made ({reason}); the others are there.").format(
            failed=f"{len(result.failed):,}", total=f"{result.total:,}", reason=first.reason
        )
        lines = (f"{failure.map_type}/{failure.name}: {failure.reason}" for failure in result.failed)
        self._messages.warning(text, "\n".join(lines), (tr("Try again"), self._workflow.capture))


def next_folder(folder: Path) -> Path:
    """Folder beside ``folder`` that does not exist yet: mission, mission-2, mission-3."""
    stem = re.sub(r"-\d+$", "", folder.name)
    number = 2
    while (candidate := folder.with_name(f"{stem}-{number}")).exists():
        number += 1
    return candidate


def _progress_text(progress: Progress, started_s: float, after: str) -> str:
    """How far a run is; ``after`` is what follows the last picture."""
    done = progress.done + progress.failed
    text = tr("{done} of {total} images").format(
        done=f"{done + progress.skipped:,}", total=f"{progress.total:,}"
    )
    if progress.failed:
        text += tr(", {failed} failed").format(failed=f"{progress.failed:,}")
    seconds = time.monotonic() - started_s
    left = progress.total - progress.skipped - done
    if not left:
        return text + after
    if done >= _LEAST_FOR_RATE and seconds > 0.0:
        rate = done / seconds
        text += tr(", {rate:.0f} a second, {time} left").format(rate=rate, time=duration_text(left / rate))
    return text


def _done_text(result: CaptureResult) -> str:
    if not result.written:
        return tr("All {total} images were there already.").format(total=f"{result.total:,}")
    return tr("{written} images captured in {time}.").format(
        written=f"{result.written:,}", time=duration_text(result.seconds)
    )


def _with_kept(error: str, result: CaptureResult | None) -> str:
    if result is None:
        return error
    return tr("{error} (the images are written)").format(error=error)


def _open(folder: Path) -> None:
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(folder)))
