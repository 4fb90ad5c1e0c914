"""One capture, from the line to its end, as the panel and the messages see it."""

from __future__ import annotations

import enum
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import QObject, pyqtSignal

from ..capture_task import CaptureTask

if TYPE_CHECKING:
    from ...core.capture.runner import CaptureResult, Progress
    from ...core.mission.mission import Mission
    from ...core.mission.plan import Plan


class Stage(enum.Enum):
    """Where a run is."""

    WAITING = "waiting"
    RUNNING = "running"
    PAUSED = "paused"
    STOPPING = "stopping"
    DONE = "done"
    INCOMPLETE = "incomplete"
    STOPPED = "stopped"
    BROKEN = "broken"


#: Stages of a run that still has something to do.
_UNDER_WAY = (Stage.RUNNING, Stage.PAUSED, Stage.STOPPING)


class Run(QObject):
    """A capture of a plan as it was when it was asked for; what is entered later does not touch it.

    Parameters
    ----------
    plan : Plan
    folder : Path
    key : str or None
        API key.
    test_shot, only_failed : bool
        As for a `CaptureTask`.

    Signals
    -------
    changed()
        Stage or figures are others now.
    failed_changed(object, object)
        The run, and what has failed of its dataset by now as a layer; None for nothing.
    ended(object)
        The run itself, whatever became of it.

    Raises
    ------
    TerrAInavError
        Where the source cannot be used.
    """

    changed = pyqtSignal()
    failed_changed = pyqtSignal(object, object)
    ended = pyqtSignal(object)

    def __init__(
        self,
        plan: Plan,
        folder: Path,
        key: str | None,
        *,
        test_shot: bool = False,
        only_failed: bool = False,
    ) -> None:
        super().__init__()
        self.plan = plan
        self.folder = folder
        self.test_shot = test_shot
        self.only_failed = only_failed
        self.stage = Stage.WAITING
        self.progress: Progress | None = None
        self.percent = 0.0
        self.task = CaptureTask(plan, folder, key, test_shot, only_failed)

    @property
    def mission(self) -> Mission:
        """What is captured."""
        return self.plan.mission

    @property
    def name(self) -> str:
        """What users call it: the last part of its folder's path, the whole of one that has no parts."""
        return self.folder.name or str(self.folder)

    @property
    def result(self) -> CaptureResult | None:
        """What the run has done, once it has."""
        return self.task.result

    @property
    def over(self) -> bool:
        """Whether it has come to its end."""
        return self.stage is not Stage.WAITING and not self.under_way

    @property
    def under_way(self) -> bool:
        """Whether it has begun and not ended."""
        return self.stage in _UNDER_WAY

    @property
    def can_pause(self) -> bool:
        """Whether there is something to hold: while a mosaic is made there is not."""
        return self.stage is Stage.PAUSED or (self.stage is Stage.RUNNING and not self.all_made)

    @property
    def all_made(self) -> bool:
        """Whether every picture is there or has failed."""
        progress = self.progress
        return (
            progress is not None and progress.done + progress.failed + progress.skipped >= progress.total > 0
        )

    def begin(self) -> None:
        """Hand it to QGIS's task manager: its turn has come."""
        self.task.progressed.connect(self._progressed)
        self.task.progressChanged.connect(self._moved_on)
        self.task.failed_changed.connect(lambda layer: self.failed_changed.emit(self, layer))
        self.task.ended.connect(self._ended)
        self._become(Stage.RUNNING)
        QgsApplication.taskManager().addTask(self.task)

    def pause(self, paused: bool) -> None:
        """Hold it in its place, or let it go on."""
        if self.stage in (Stage.RUNNING, Stage.PAUSED):
            self.task.paused = paused
            self._become(Stage.PAUSED if paused else Stage.RUNNING)

    def cancel(self) -> None:
        """Stop it; what is finished is kept and shown. The second time, or with every picture there, stop that, too."""
        if self.stage is Stage.WAITING:
            self.task.discard()
            self._become(Stage.STOPPED)
            self.ended.emit(self)
        elif self.under_way:
            end = self.task.cancel if self.stage is Stage.STOPPING or self.all_made else self.task.stop
            # Before the task is told: that may be the end of it at once.
            self._become(Stage.STOPPING)
            end()

    def close(self) -> None:
        """Stop it and wait for its end, without a word."""
        if self.stage is Stage.WAITING:
            self.task.discard()
        elif self.under_way:
            for signal in (
                self.task.progressed,
                self.task.progressChanged,
                self.task.failed_changed,
                self.task.ended,
            ):
                signal.disconnect()
            self.task.cancel()
            self.task.waitForFinished()
        self.stage = Stage.STOPPED

    def _progressed(self, progress: Progress) -> None:
        self.progress = progress
        self.changed.emit()

    def _moved_on(self, percent: float) -> None:
        self.percent = percent
        self.changed.emit()

    def _ended(self, task: CaptureTask) -> None:
        result = task.result
        if task.error:
            stage = Stage.BROKEN
        elif result is None or result.cancelled or task.stopped:
            stage = Stage.STOPPED
        else:
            stage = Stage.INCOMPLETE if task.failed or result.failed else Stage.DONE
            self.percent = 100.0
        self._become(stage)
        self.ended.emit(self)

    def _become(self, stage: Stage) -> None:
        self.stage = stage
        self.changed.emit()
