"""What is said of a run: in its row of the panel, and at its end. Knows no widget."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..dock.estimates import duration_text
from ..i18n import number_text, told, tr
from .run import Run, Stage

if TYPE_CHECKING:
    from ...core.capture.runner import CaptureResult, Progress

#: A rate is shown once so many pictures are there: the first ones wait for connections.
_LEAST_FOR_RATE = 10
#: From this rate on decimals say nothing.
_WHOLE_RATE = 10.0


def title_of(run: Run) -> str:
    """Name that a run goes by."""
    if run.test_shot:
        return tr("Test shot")
    if run.only_failed:
        return tr("{name}: failed images").format(name=run.name)
    return run.name


def row_text(run: Run, place: int = 0) -> str:
    """How far a run is, in a line.

    Parameters
    ----------
    place : int
        Runs before it in the line.
    """
    if run.stage is Stage.WAITING:
        return (
            tr("Waiting: next in line")
            if place <= 1
            else tr("Waiting: {place} before it").format(place=place)
        )
    if run.stage is Stage.STOPPING:
        return tr("Stopping…") if run.result is None else tr("Stopped; making the mosaic…")
    if run.over:
        return _end_text(run)
    if run.progress is None:
        return tr("Paused") if run.stage is Stage.PAUSED else tr("Starting…")
    if run.stage is Stage.PAUSED:
        return tr("Paused: {counts}").format(counts=_counts(run.progress))
    return _counts(run.progress) + _pace(run.progress, making_mosaic=run.plan.size_px is None)


def _counts(progress: Progress) -> str:
    done = progress.done + progress.skipped
    text = tr("{done} of {total} images").format(done=number_text(done), total=number_text(progress.total))
    if progress.failed:
        text += tr(", {failed} failed").format(failed=number_text(progress.failed))
    return text


def _pace(progress: Progress, making_mosaic: bool) -> str:
    """Rate and remaining time, of the time that the run has worked: pauses do not count."""
    done = progress.done + progress.failed
    left = progress.total - progress.skipped - done
    if not left:
        return tr("; making the mosaic…") if making_mosaic else ""
    if done < _LEAST_FOR_RATE or progress.active_s <= 0.0:
        return ""
    rate = done / progress.active_s
    shown = number_text(rate, ".0f") if rate >= _WHOLE_RATE else number_text(rate, ".1f")
    return tr(", {rate} a second, {time} left").format(rate=shown, time=duration_text(left / rate))


def _end_text(run: Run) -> str:
    result = run.result
    if run.task.error:
        return with_kept(told(run.task.error), result)
    if result is None:
        return tr("Stopped before the first image")
    there = number_text(result.written + result.skipped)
    if result.cancelled:
        return tr("Stopped with {there} of {total} images").format(
            there=there, total=number_text(result.total)
        )
    if run.task.failed:
        total = len(run.plan) * len(run.mission.map_types)
        return tr("Missing: {failed} of {total} images").format(
            failed=number_text(run.task.failed), total=number_text(total)
        )
    return done_text(result)


def done_text(result: CaptureResult) -> str:
    """What a run that came to its end has done."""
    if not result.total:
        return tr("No image was missing.")
    if not result.written:
        if result.total == 1:
            return tr("The image was there already.")
        return tr("All {total} images were there already.").format(total=number_text(result.total))
    time = duration_text(result.seconds)
    if result.skipped:
        return tr("All {total} images are there: {written} captured now in {time}, {skipped} before.").format(
            total=number_text(result.total),
            written=number_text(result.written),
            time=time,
            skipped=number_text(result.skipped),
        )
    if result.written == 1:
        return tr("One image captured in {time}.").format(time=time)
    return tr("{written} images captured in {time}.").format(written=number_text(result.written), time=time)


def with_kept(error: str, result: CaptureResult | None) -> str:
    """Error of a run, and that its images are there all the same."""
    return error if result is None else tr("{error} (the images are written)").format(error=error)
