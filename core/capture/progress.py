"""What a capture tells: how far it is, what failed, what came of it; and the caller's say while it runs."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

#: Shortest time between two reports of progress, seconds.
_REPORT_S = 0.1


@dataclass(frozen=True)
class Progress:
    """How far a capture is, over all its map types.

    Parameters
    ----------
    total : int
        Pictures asked for.
    done, failed, skipped : int
        Written by this run; failed in it; there already.
    requests : int
        Parts asked of the source so far.
    map_type : str
        The one being captured.
    active_s : float
        Seconds that the run has worked: pauses are left out, so that rates can be had from it.
    paused : bool
        Whether it is held.
    """

    total: int
    done: int
    failed: int
    skipped: int
    requests: int
    map_type: str
    active_s: float = 0.0
    paused: bool = False


@dataclass(frozen=True)
class Failure:
    """A picture that could not be made, and why."""

    map_type: str
    name: str
    reason: str


@dataclass(frozen=True)
class Repeat:
    """A file that the provider sent for several places far apart: open water, snow, or a placeholder.

    Parameters
    ----------
    sha256 : str
        First digits of its SHA-256, as `open_source` takes them for a placeholder.
    places : int
        Tiles it came for; with Static Maps, pictures.
    images : tuple of str
        Names of the pictures that show it, in the plan's order.
    """

    map_type: str
    sha256: str
    places: int
    images: tuple[str, ...]


@dataclass(frozen=True)
class CaptureResult:
    """What a capture did.

    Parameters
    ----------
    total, written, skipped : int
        Pictures asked for; written by this run; there already.
    failed : tuple of Failure
        By map type, in the plan's order.
    requests, unique_parts : int
        Parts asked of the source, and different parts that the pictures to be made needed; equal, but for a run
        that was stopped.
    seconds : float
        Wall time, without pauses.
    cancelled : bool
        Whether it was stopped; it can be resumed.
    repeated : tuple of Repeat
        What came for several places far apart in this run, by map type, that of the most places first.
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


class Listener:
    """The caller's callbacks: told of progress now and then, asked whether to go on or wait, which takes the time.

    Attributes
    ----------
    is_paused : bool
        What the caller has last said.
    """

    def __init__(
        self,
        progress: Callable[[Progress], object] | None,
        cancelled: Callable[[], bool] | None,
        paused: Callable[[], bool] | None,
    ) -> None:
        self._progress, self._cancelled, self._paused = progress, cancelled, paused
        self._told_s = -math.inf
        self._started_s = time.monotonic()
        self._pause_began_s = self._pauses_s = 0.0
        self.is_paused = False

    def active_s(self) -> float:
        """Seconds so far in which the run was not held."""
        until_s = self._pause_began_s if self.is_paused else time.monotonic()
        return until_s - self._started_s - self._pauses_s

    def wait(self) -> bool:
        """Whether the caller holds the run."""
        held = self._paused is not None and self._paused()
        if held and not self.is_paused:
            self._pause_began_s = time.monotonic()
        elif self.is_paused and not held:
            self._pauses_s += time.monotonic() - self._pause_began_s
        if held != self.is_paused:
            self.is_paused = held
            # The next report says so, however short a time ago the last one was.
            self._told_s = -math.inf
        return held

    def tell(self, progress: Callable[[], Progress], *, at_once: bool = False) -> None:
        """Report progress, unless the last report was a moment ago."""
        now_s = time.monotonic()
        if self._progress is not None and (at_once or now_s - self._told_s >= _REPORT_S):
            self._told_s = now_s
            self._progress(progress())

    def go_on(self) -> bool:
        """Whether the caller has not cancelled."""
        return self._cancelled is None or not self._cancelled()
