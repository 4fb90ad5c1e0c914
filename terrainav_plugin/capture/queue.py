"""The queue of captures: one runs, the others wait; ended captures are listed until dismissed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from qgis.core import QgsProcessingUtils
from qgis.PyQt.QtCore import QObject, pyqtSignal
from qgis.PyQt.QtWidgets import QWidget

from ...core.errors import TerrAInavError
from ..form import mission_form
from ..form.mission_form import FormError
from ..i18n import number_text, tr, translate
from ..settings import Settings
from ..sources import MissionPlans, each_imagery, grid_finders, mission_grid, source_key
from .endings import Endings
from .questions import Questions
from .run import BackgroundRun
from .unfinished import FindTask, PlanTask, Unfinished, UnfinishedCapture

if TYPE_CHECKING:
    from ...core.mission.mission import Mission
    from ..dataset.placing import OpenProject
    from ..form.state import FormState
    from ..map.mission_group import MissionGroup
    from ..messages import Messages
    from ..planner import PlannedMission
    from .task import CaptureTask


class _Wanted(NamedTuple):
    """A capture that waits for its plan."""

    folder: Path
    name: str
    refusal: str
    only_failed: bool = False


class Runs(QObject):
    """Captures in the order of their requests.

    A paused capture keeps its place, and the others wait behind it.

    Parameters
    ----------
    messages : Messages
    window : QWidget
        Parent of dialogs.
    open_project : OpenProject
    group : callable
        Returns the group of the panel's mission, for test shots.

    Signals
    -------
    listed(object)
        A run was added to the list.
    dismissed(object)
        A run was removed from the list.
    moved()
        The queue has advanced.
    running(bool)
        True when the first run begins, False when the last run has ended.
    refused(object)
        Error messages by field.
    other_folder_wanted(object)
        The folder into which to capture the entered mission.
    results_shown(object), test_shot_shown(object), dataset_wanted(object)
        As in `Endings`.
    """

    listed = pyqtSignal(object)
    dismissed = pyqtSignal(object)
    moved = pyqtSignal()
    running = pyqtSignal(bool)
    refused = pyqtSignal(object)
    other_folder_wanted = pyqtSignal(object)
    results_shown = pyqtSignal(object)
    test_shot_shown = pyqtSignal(object)
    dataset_wanted = pyqtSignal(object)

    def __init__(
        self,
        messages: Messages,
        window: QWidget,
        open_project: OpenProject,
        group: Callable[[], MissionGroup],
    ) -> None:
        super().__init__()
        self._messages = messages
        self.questions = Questions(
            messages, window, self.refused.emit, self.other_folder_wanted.emit, lambda: self.folders
        )
        self.runs: list[BackgroundRun] = []
        self._endings = Endings(messages, open_project, group, self)
        self._endings.shown.connect(self.results_shown)
        self._endings.test_shot_shown.connect(self.test_shot_shown)
        self._endings.dataset_wanted.connect(self.dataset_wanted)
        self._endings.resume_wanted.connect(self.resume)
        self._endings.failed_wanted.connect(self.capture_failed)
        self._endings.missing_wanted.connect(self.treat_as_missing)
        self._unfinished = Unfinished()
        self._finding: FindTask | None = None
        self._planning: dict[PlanTask, _Wanted] = {}
        self._was_idle = True
        self._closed = False

    @property
    def waiting(self) -> list[BackgroundRun]:
        """Unfinished runs in order; the first is running."""
        return [run for run in self.runs if not run.has_ended]

    @property
    def idle(self) -> bool:
        """Whether no run is running or waiting."""
        return not self.waiting

    @property
    def task(self) -> CaptureTask | None:
        """Task of the running capture; None when idle."""
        return next((run.task for run in self.waiting), None)

    @property
    def folders(self) -> list[Path]:
        """Folders of all runs, in the order of their requests."""
        return [run.folder for run in self.runs if not run.test_shot]

    def can_start(self, state: FormState) -> bool:
        """Whether there is a folder for the capture, and the keys of its sources; reports what is missing."""
        if not self.questions.has_folder(state.folder):
            return False
        try:
            mission = mission_form.mission(state)
        except FormError:
            # Reported by planning.
            return True
        return self.questions.has_usable_keys(mission)

    def start(self, planned: PlannedMission, folder: Path, only_failed: bool = False) -> None:
        """Ask the questions about a capture, and put it into the queue."""
        # First the problems that a choice of folder cannot solve.
        if not self.questions.check_limits(planned.plans):
            return
        if self.questions.belongs_to_another(planned.plans, folder, may_count_on=not only_failed):
            return
        self._enqueue(planned.plans, folder, only_failed)

    def offer_unfinished(self) -> None:
        """Offer to resume unfinished captures of earlier sessions; changes nothing without consent."""
        self._finding = FindTask()
        self._finding.begin(self._offer)

    def _offer(self, task: FindTask) -> None:
        self._finding = None
        for left in task.found:
            text = tr("{name}: its capture did not end.").format(name=left.name)
            if left.there is not None and left.images is not None:
                text = tr("{name}: its capture did not end: {there} of {total} images.").format(
                    name=left.name, there=number_text(left.there), total=number_text(left.images)
                )
            # By topic: a new capture into the folder removes the message, as "Forget" would then concern that capture.
            with self._messages.topic(str(left.folder)):
                self._messages.warning(
                    text,
                    action=(tr("Resume"), partial(self.resume_unfinished, left)),
                    other=(tr("Forget (files are kept)"), left.forget),
                )

    def resume_unfinished(self, left: UnfinishedCapture) -> None:
        """Plan an unfinished capture of an earlier session again, and put it into the queue."""
        refusal = tr("{name}: cannot be resumed: {reason}")
        self._plan(left.mission, _Wanted(left.folder, left.name, refusal, left.only_failed))

    def start_mission(self, mission: Mission, folder: Path) -> None:
        """Plan a mission other than the panel's, and put its capture into the queue."""
        self._plan(mission, _Wanted(folder, folder.name, tr("{name}: cannot be captured: {reason}")))

    def _plan(self, mission: Mission, wanted: _Wanted) -> None:
        if not self.questions.has_usable_keys(mission):
            return
        task = PlanTask(mission, grid_finders(mission))
        self._planning[task] = wanted
        task.begin(self._planned)

    def _planned(self, task: PlanTask) -> None:
        wanted = self._planning.pop(task)
        if task.plans is None:
            self._messages.failed(
                wanted.refusal.format(name=wanted.name, reason=translate(task.error) or tr("stopped")), task.trace
            )
        elif not self.questions.belongs_to_another(task.plans, wanted.folder):
            self._enqueue(task.plans, wanted.folder, wanted.only_failed)

    def capture_failed(self, run: BackgroundRun) -> None:
        """Capture the failed images of an ended run again, and nothing else."""
        self._capture_again(run, run.task.failed, only_failed=True)

    def treat_as_missing(self, run: BackgroundRun, digest: str, images: int) -> None:
        """Count a tile as missing from now on, and capture the run's images that contain it again."""
        Settings().treat_as_missing(digest)
        self._capture_again(run, run.task.failed + images, only_failed=False)

    def _capture_again(self, run: BackgroundRun, images: int, *, only_failed: bool) -> None:
        share = min(images / max(run.images, 1), 1.0)
        if not self.questions.has_usable_keys(run.mission):
            return
        if self._enqueue(run.plans, run.folder, only_failed, share):
            self.dismiss(run)

    def resume(self, run: BackgroundRun) -> None:
        """Resume a paused run, or put a run that ended early into the queue again."""
        if not run.has_ended:
            run.pause(False)
        elif self.questions.has_usable_keys(run.mission):
            self._enqueue(run.plans, run.folder, run.only_failed)

    def start_test_shot(self, state: FormState, lat_deg: float, lon_deg: float) -> None:
        """Capture one image above a point, with camera, height and source as entered."""
        from ..sources import plan_mission

        if not self.idle:
            return
        try:
            mission = mission_form.test_shot(state, lat_deg, lon_deg)
            steps = plan_mission(mission, lambda: mission_grid(mission))
        except FormError as wrong:
            self.refused.emit(wrong.messages)
            self._messages.refused(translate(wrong), tr("No test shot."))
            return
        except TerrAInavError as wrong:
            self._messages.refused(translate(wrong), tr("No test shot."))
            return
        plans = MissionPlans(mission, {"": steps})
        if self.questions.has_usable_keys(mission) and self.questions.terms_allow(plans):
            # QGIS removes its temporary files on exit.
            folder = Path(QgsProcessingUtils.generateTempFilename("test-shot"))
            self._add(BackgroundRun(plans, folder, _keys(mission), test_shot=True))

    def dismiss(self, run: BackgroundRun) -> None:
        """Remove an ended run from the list."""
        if run in self.runs and run.has_ended:
            self.runs.remove(run)
            self.dismissed.emit(run)
            run.deleteLater()

    def cancel(self) -> None:
        """Stop all runs; finished images are kept."""
        for run in reversed(self.waiting):
            run.cancel()

    def close(self) -> None:
        """Stop all runs and wait for their end, without messages."""
        self._closed = True
        self._endings.close()
        self._unfinished.close()
        for task in (*self._planning, *filter(None, (self._finding,))):
            task.abandon()
        for run in reversed(self.runs):
            run.close()
        self.runs.clear()

    def _enqueue(self, plans: MissionPlans, folder: Path, only_failed: bool, share: float = 1.0) -> bool:
        mission = plans.captured
        if self.questions.is_queued(mission, folder, self.waiting) or not self.questions.terms_allow(plans, share):
            return False
        try:
            # Copies of the plans: the views that they cache belong to the capture.
            copies = {name: replace(plan) for name, plan in plans.by_imagery.items()}
            run = BackgroundRun(plans._replace(by_imagery=copies), folder, _keys(mission), only_failed=only_failed)
        except TerrAInavError as wrong:
            self._messages.warning(tr("Nothing captured: {reason}").format(reason=translate(wrong)))
            return False
        self._add(run)
        return True

    def _add(self, run: BackgroundRun) -> None:
        if self._closed:
            # The plugin was unloaded during the question about terms.
            run.close()
            return
        self._endings.begin(run)
        run.failed_changed.connect(self._endings.show_failed)
        run.mosaic_refused.connect(self._endings.warn_of_mosaic)
        run.ended.connect(self._ended)
        # The new run replaces earlier ones into the same folder.
        for old in [old for old in self.runs if old.has_ended and old.folder == run.folder]:
            self.dismiss(old)
        self.runs.append(run)
        self._unfinished.note(run)
        self.listed.emit(run)
        self._advance()

    def _ended(self, run: BackgroundRun) -> None:
        self._unfinished.forget(run)
        self._endings.tell(run)
        if run.test_shot:
            self.dismiss(run)
        self._advance()

    def _advance(self) -> None:
        waiting = self.waiting
        if waiting and not waiting[0].under_way:
            waiting[0].begin()
        self.moved.emit()
        if self._was_idle != self.idle:
            self._was_idle = self.idle
            self.running.emit(not self.idle)


def _keys(mission: Mission) -> dict[str, str | None]:
    """API key of each imagery of a mission. Main thread only."""
    return {name: source_key(one.imagery.source) for name, one in each_imagery(mission).items()}
