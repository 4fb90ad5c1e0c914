"""One capture, from the queue to its end, and texts about its state. No widgets."""

from __future__ import annotations

import enum
import math
import os
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from qgis.PyQt.QtCore import QObject, pyqtSignal

from ...core.mission.estimate import mosaic_s
from ..dataset.mosaic import MOST_PICTURES
from ..i18n import number_text, tr, translate
from ..units import duration_text
from .task import CaptureTask

if TYPE_CHECKING:
    from ...core.capture.progress import CaptureResult, Progress
    from ...core.mission.mission import Mission
    from ..sources import MissionPlans


class Stage(enum.Enum):
    """Stage of a run."""

    WAITING = "waiting"
    RUNNING = "running"
    PAUSED = "paused"
    STOPPING = "stopping"
    DONE = "done"
    INCOMPLETE = "incomplete"
    STOPPED = "stopped"
    BROKEN = "broken"


#: Stages of an unfinished run.
_UNDER_WAY = (Stage.RUNNING, Stage.PAUSED, Stage.STOPPING)


class BackgroundRun(QObject):
    """A capture of a plan as requested; later changes of entries do not affect it.

    Parameters
    ----------
    plans : MissionPlans
    folder : Path
    keys : dict of str to (str or None)
        API key of each imagery.
    test_shot, only_failed : bool
        As for `CaptureTask`.

    Signals
    -------
    changed()
        The stage or the figures have changed.
    failed_changed(object, object, object)
        The run, a folder of its dataset, and a layer of the images that have failed there; None if none has.
    mosaic_refused(object, str)
        The run, and why there will be no mosaic; emitted before the first image.
    ended(object)
        The run, whatever its end.

    Raises
    ------
    TerrAInavError
        The source cannot be used.
    """

    changed = pyqtSignal()
    failed_changed = pyqtSignal(object, object, object)
    mosaic_refused = pyqtSignal(object, str)
    ended = pyqtSignal(object)

    def __init__(
        self,
        plans: MissionPlans,
        folder: Path,
        keys: dict[str, str | None],
        *,
        test_shot: bool = False,
        only_failed: bool = False,
    ) -> None:
        super().__init__()
        self.plans = plans
        self.folder = folder
        self.test_shot = test_shot
        self.only_failed = only_failed
        self.stage = Stage.WAITING
        self.progress: Progress | None = None
        #: Progress when the latest pause began, shown until it ends: images under way are finished meanwhile.
        self.paused_at: Progress | None = None
        self.percent = 0.0
        shown = [plan for plan in plans.by_imagery.values() if len(plan) <= MOST_PICTURES and not test_shot]
        self._mosaic_s = sum(mosaic_s(plan, cores=os.cpu_count() or 1) for plan in shown)
        self._mosaic_began_s = math.nan
        self.task = CaptureTask(plans, folder, keys, test_shot, only_failed)

    @property
    def mission(self) -> Mission:
        """Mission to capture."""
        return self.plans.captured

    @property
    def images(self) -> int:
        """Number of images of the dataset."""
        return self.plans.images

    @property
    def name(self) -> str:
        """Name for users: the last part of the folder's path, or the whole path."""
        return self.folder.name or str(self.folder)

    @property
    def result(self) -> CaptureResult | None:
        """Result once the run has ended."""
        return self.task.result

    @property
    def has_ended(self) -> bool:
        """Whether the run has ended."""
        return self.stage is not Stage.WAITING and not self.under_way

    @property
    def under_way(self) -> bool:
        """Whether the run has begun and not ended."""
        return self.stage in _UNDER_WAY

    @property
    def can_pause(self) -> bool:
        """Whether pausing is possible: not while a mosaic is made."""
        return self.stage is Stage.PAUSED or (self.stage is Stage.RUNNING and not self.has_all_images)

    @property
    def has_all_images(self) -> bool:
        """Whether every image is there or has failed."""
        progress = self.progress
        return progress is not None and progress.done + progress.failed + progress.skipped >= progress.total > 0

    @property
    def mosaic_left_s(self) -> float:
        """Seconds left for the mosaic: as estimated until a part of it is made, then at the pace so far."""
        share = (self.percent / 100.0 - self.task.capture_share) / (1.0 - self.task.capture_share)
        # A small part says little.
        if not self.has_all_images or share < 0.05 or math.isnan(self._mosaic_began_s):
            return self._mosaic_s
        return (monotonic() - self._mosaic_began_s) * (1.0 - share) / share

    def begin(self) -> None:
        """Start the task, when the run is first in the queue."""
        self.task.progressed.connect(self._progressed)
        self.task.progressChanged.connect(self._show_progress)
        self.task.failed_changed.connect(lambda place, layer: self.failed_changed.emit(self, place, layer))
        self.task.mosaic_refused.connect(lambda reason: self.mosaic_refused.emit(self, reason))
        self._become(Stage.RUNNING)
        self.task.begin(self._ended)

    def pause(self, paused: bool) -> None:
        """Pause or resume the run."""
        if self.stage in (Stage.RUNNING, Stage.PAUSED):
            self.task.paused = paused
            self.paused_at = self.progress
            self._become(Stage.PAUSED if paused else Stage.RUNNING)

    def cancel(self) -> None:
        """Stop the run and show its finished images; called again or after the last image, also stop the mosaic."""
        if self.stage is Stage.WAITING:
            self.task.discard()
            self._become(Stage.STOPPED)
            self.ended.emit(self)
        elif self.under_way:
            end = self.task.cancel if self.stage is Stage.STOPPING or self.has_all_images else self.task.stop
            # Change the stage first: the cancelled task may end at once.
            self._become(Stage.STOPPING)
            end()

    def close(self) -> None:
        """Stop the run and wait for its end, without messages."""
        if self.stage is Stage.WAITING:
            self.task.discard()
        elif self.under_way:
            for signal in (
                self.task.progressed,
                self.task.progressChanged,
                self.task.failed_changed,
                self.task.mosaic_refused,
                self.task.ended,
            ):
                signal.disconnect()
            self.task.cancel()
            self.task.waitForFinished()
        self.stage = Stage.STOPPED

    def _progressed(self, progress: Progress) -> None:
        self.progress = progress
        if self.has_all_images and math.isnan(self._mosaic_began_s):
            self._mosaic_began_s = monotonic()
        self.changed.emit()

    def _show_progress(self, percent: float) -> None:
        if self.stage is not Stage.PAUSED:
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


def run_title(run: BackgroundRun) -> str:
    """Title of a run in the list."""
    if run.test_shot:
        return tr("Test shot")
    if run.only_failed:
        return tr("{name}: failed images").format(name=run.name)
    return run.name


def row_text(run: BackgroundRun, place: int = 0) -> str:
    """One-line state of a run.

    Parameters
    ----------
    place : int
        Number of runs before it in the queue.
    """
    if run.stage is Stage.WAITING:
        return tr("Waiting: next") if place <= 1 else tr("Waiting: {place} ahead of it").format(place=place)
    if run.stage is Stage.STOPPING:
        return tr("Stopping…") if run.result is None else tr("Stopped; making the mosaic…")
    if run.has_ended:
        return _end_text(run)
    if run.stage is Stage.PAUSED:
        return tr("Paused") if run.paused_at is None else tr("Paused: {counts}").format(counts=_counts(run.paused_at))
    if run.progress is None:
        # A task with relief first reads heights, to trace the images.
        return tr("Reading heights…") if run.mission.terrain.elevation else tr("Starting…")
    return _counts(run.progress) + _pace(run.progress, run.mosaic_left_s, making_mosaic=not run.test_shot)


def done_text(result: CaptureResult) -> str:
    """Summary of an ended run."""
    if not result.total:
        return tr("No images were missing.")
    if not result.written:
        if result.total == 1:
            return tr("The image already exists.")
        return tr("All {total} images already exist.").format(total=number_text(result.total))
    duration = duration_text(result.seconds)
    if result.skipped:
        return tr("All {total} images captured: {written} now, in {time}; {skipped} in earlier runs.").format(
            total=number_text(result.total),
            written=number_text(result.written),
            time=duration,
            skipped=number_text(result.skipped),
        )
    if result.written == 1:
        return tr("One image captured in {time}.").format(time=duration)
    return tr("{written} images captured in {time}.").format(written=number_text(result.written), time=duration)


def note_saved_images(error: str, result: CaptureResult | None) -> str:
    """Error of a run, with a note that images were saved."""
    return error if result is None else tr("{error} (the images were saved)").format(error=error)


def _counts(progress: Progress) -> str:
    done = progress.done + progress.skipped
    text = tr("{done} of {total} images").format(done=number_text(done), total=number_text(progress.total))
    if progress.failed:
        text += tr(", {failed} failed").format(failed=number_text(progress.failed))
    return text


def _pace(progress: Progress, mosaic_left_s: float, making_mosaic: bool) -> str:
    """Rate, and remaining time with that of the mosaic, computed without pauses."""
    done = progress.done + progress.failed
    left = progress.total - progress.skipped - done
    if not left:
        time_left = duration_text(max(mosaic_left_s, 1.0))
        return tr("; making the mosaic, {time} left").format(time=time_left) if making_mosaic else ""
    # The rate of the first ten images is not representative: they wait for connections.
    if done < 10 or progress.active_s <= 0.0:
        return ""
    rate = done / progress.active_s
    # Decimals of a higher rate are not significant.
    shown = number_text(rate, ".0f") if rate >= 10.0 else number_text(rate, ".1f")
    return tr(", {rate} a second, {time} left").format(rate=shown, time=duration_text(left / rate + mosaic_left_s))


def _end_text(run: BackgroundRun) -> str:
    result = run.result
    if run.task.error:
        return note_saved_images(translate(run.task.error), result)
    if result is None:
        return tr("Stopped before the first image")
    there = number_text(result.written + result.skipped)
    if run.stage is Stage.STOPPED:
        if not result.cancelled:
            return tr("Stopped without the mosaic, with {there} of {total} images").format(
                there=there, total=number_text(result.total)
            )
        return tr("Stopped with {there} of {total} images").format(there=there, total=number_text(result.total))
    if run.task.failed:
        return tr("Missing: {failed} of {total} images").format(
            failed=number_text(run.task.failed), total=number_text(run.images)
        )
    return done_text(result)
