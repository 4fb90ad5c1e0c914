"""Progress and results of a capture, and callbacks with which the caller follows, pauses or stops it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from ..errors import Message

#: Shortest time between two reports of progress, seconds.
_REPORT_S = 0.1


@dataclass(frozen=True)
class Progress:
    """Progress of a capture, over all its map types.

    Parameters
    ----------
    total : int
        Number of images requested.
    done, failed, skipped : int
        Images written by this run, failed in this run, and made by earlier runs.
    requests : int
        Parts requested from the source so far.
    map_type : str
        Map type being captured.
    active_s : float
        Seconds of work, without pauses.
    paused : bool
    """

    total: int
    done: int
    failed: int
    skipped: int
    requests: int
    map_type: str
    active_s: float = 0.0
    paused: bool = False


class OverallProgress:
    """Progress over several captures, from that of each, which has the capture's name in place of the map type.

    Parameters
    ----------
    images : mapping of str to int
        Number of images of each capture, by its name.
    """

    def __init__(self, images: Mapping[str, int]) -> None:
        self._images = images
        self._latest: dict[str, Progress] = {}

    def add(self, progress: Progress) -> Progress:
        """Take the progress of a capture, and return that of all."""
        self._latest[progress.map_type] = progress
        # A capture of failed images has fewer, which is known once it begins.
        waiting = sum(count for name, count in self._images.items() if name not in self._latest)
        added = ("total", "done", "failed", "skipped", "requests", "active_s")
        sums = {name: sum(getattr(one, name) for one in self._latest.values()) for name in added}
        return replace(progress, **{**sums, "total": sums["total"] + waiting})


@dataclass(frozen=True)
class Failure:
    """An image that could not be made, and the reason."""

    map_type: str
    name: str
    reason: str


@dataclass(frozen=True)
class Repeat:
    """A file that the provider sent for several places far apart: open water, snow, or a placeholder.

    Parameters
    ----------
    sha256 : str
        First digits of the file's SHA-256, in the form in which `open_source` takes placeholders.
    places : int
        Number of tiles (of images, with Static Maps) for which the file was sent.
    images : tuple of str
        Names of the images that show the file, in the plan's order.
    """

    map_type: str
    sha256: str
    places: int
    images: tuple[str, ...]


@dataclass(frozen=True)
class CaptureResult:
    """Result of a capture.

    Parameters
    ----------
    total, written, skipped : int
        Images requested, written by this run, and made by earlier runs.
    failed : tuple of Failure
        By map type, in the plan's order.
    requests, unique_parts : int
        Parts requested from the source, and distinct parts needed; equal unless the run was stopped.
    seconds : float
        Wall time, without pauses.
    cancelled : bool
        Whether the run was stopped and can be resumed.
    repeated : tuple of Repeat
        Files sent in this run for several places far apart, by map type; files with most places first.
    """

    folder: Path
    total: int
    written: int
    failed: tuple[Failure, ...]
    skipped: int
    requests: int
    unique_parts: int
    seconds: float
    cancelled: bool
    repeated: tuple[Repeat, ...] = ()


def _ignore(_: object) -> None:
    """Ignore a report."""


def _never() -> bool:
    return False


@dataclass(frozen=True)
class Listener:
    """Callbacks with which the caller of a capture follows its progress, and pauses or stops it.

    Parameters
    ----------
    progress : callable
        Called in the capturing thread with a `Progress`, at most about ten times a second, and at the end.
    cancelled : callable
        Called many times a second. Once it returns True, the run ends within the time that one image takes. It does
        not wait for requests under way, which end when the source is closed.
    paused : callable
        Called as often as ``cancelled``. While it returns True, no part is requested and no image begun; progress is
        still reported. Other processes finish the blocks that they are making.
    notice : callable
        Called with one-line messages, for example if a block is made again because its worker died.
    """

    progress: Callable[[Progress], object] = _ignore
    cancelled: Callable[[], bool] = _never
    paused: Callable[[], bool] = _never
    notice: Callable[[Message], object] = _ignore

    def named(self, name: str) -> Listener:
        """Listener for one of several captures, whose progress has ``name`` in place of the map type."""
        return replace(self, progress=lambda report: self.progress(replace(report, map_type=name)))

    def guarded(self, check: Callable[[], None]) -> Listener:
        """Listener that also calls ``check``, which may raise, whenever ``cancelled`` is called."""

        def cancelled() -> bool:
            check()
            return self.cancelled()

        return replace(self, cancelled=cancelled)


#: Listener that ignores progress and never stops a run.
SILENT = Listener()


class Reporter:
    """Reports progress to a listener at intervals, and measures time without pauses.

    Attributes
    ----------
    is_paused : bool
        The last answer of the listener's ``paused``.
    """

    def __init__(self, listener: Listener) -> None:
        self._listener = listener
        self._reported_s = -math.inf
        self._started_s = time.monotonic()
        self._pause_began_s = self._pauses_s = 0.0
        self.is_paused = False

    def active_s(self) -> float:
        """Seconds so far, without pauses."""
        until_s = self._pause_began_s if self.is_paused else time.monotonic()
        return until_s - self._started_s - self._pauses_s

    def ask_paused(self) -> bool:
        """Ask whether the run is to pause."""
        paused = self._listener.paused()
        if paused and not self.is_paused:
            self._pause_began_s = time.monotonic()
        elif self.is_paused and not paused:
            self._pauses_s += time.monotonic() - self._pause_began_s
        if paused != self.is_paused:
            self.is_paused = paused
            # Report the change at once.
            self._reported_s = -math.inf
        return paused

    def report(self, progress: Callable[[], Progress], *, at_once: bool = False) -> None:
        """Report progress, unless the last report is recent."""
        now_s = time.monotonic()
        if at_once or now_s - self._reported_s >= _REPORT_S:
            self._reported_s = now_s
            self._listener.progress(progress())

    def ask_cancelled(self) -> bool:
        """Ask whether the run is to stop."""
        return self._listener.cancelled()
