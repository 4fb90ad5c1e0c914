"""What a capture tells while it runs and when it ends."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


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
    map_type : str
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
    folder : Path
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
