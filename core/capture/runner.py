"""The run that turns a plan into a dataset: folder, journal, pictures, tables, and what it tells meanwhile."""

from __future__ import annotations

import math
import os
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..bands import RGB, bands_of
from ..dataset.folder import FOOTPRINTS_FILE, JOURNAL_FILE, PLAN_FILE, TABLE_FILE
from ..dataset.table import other_columns
from ..errors import InvalidInput, Message, OutputError, PartError
from ..imagery.placeholder import PLACEHOLDER_REASON, Provided, Received, Repeats, corner
from ..imagery.source import Part, Source, Window
from ..limits import MAX_PICTURE_BYTES, MAX_PICTURES_AT_ONCE_PX
from ..mission.export import write_plan
from ..mission.plan import Plan
from ..picture.camera_frame import parts_of_tiles
from ..picture.map_frame import check_size
from ..picture.shot import parts_of, tiles_of
from .folder import (
    captured_mission,
    check_captured,
    complete_pictures,
    open_folder,
    remove_picture,
)
from .journal import FAILED, Journal, Outcome
from .odm import write_odm_files
from .pipeline import Pipeline, sweep
from .records import Made, PictureJob, exposures_of, job_of, make_picture, table_of
from .writers import file_endings

__all__ = ["CaptureResult", "Failure", "Progress", "Repeat", "capture", "check_source"]
Numbers = NDArray[np.int64]
#: Connections where nothing else is said: what browsers open to a server is 6, tile servers bear a few more.
DEFAULT_CONNECTIONS = 8
#: Pictures that are traced ahead of each other before it is asked whether to go on.
_TRACED_AT_ONCE = 64
#: Shortest time between two reports of progress, seconds.
_REPORT_S = 0.1


def capture(
    plan: Plan,
    source: Source,
    folder: str | os.PathLike[str],
    *,
    connections: int = DEFAULT_CONNECTIONS,
    workers: int | None = None,
    resume: bool = False,
    only: Iterable[int] | None = None,
    only_failed: bool = False,
    progress: Callable[[Progress], object] | None = None,
    cancelled: Callable[[], bool] | None = None,
    paused: Callable[[], bool] | None = None,
) -> CaptureResult:
    """Capture the pictures of a plan into a dataset folder.

    Pictures are written whole or not at all, and noted in the journal one by one; those that cannot be made are
    named in the journal and the table with the reason, and the others go on. The tables are written at the end,
    also of a run that was stopped; columns that others have added to them are kept. The same mission leaves the same
    pictures and tables, in one go or in several.

    Parameters
    ----------
    source : Source
        With the pixel grid that the plan was made for.
    folder : path
        Made if it is not there.
    connections : int
        Parts fetched at once, at least 1.
    workers : int or None
        Pictures assembled and written at once; None for as many as there are processors.
    resume : bool
        Go on with a folder that holds this mission: what is missing or has failed is made, and so is what shows a
        file that the source counts as placeholder by now, if an earlier run has noted it (a `Repeat`).
    only : iterable of int or None
        Indices of the captures to make; None for all.
    only_failed : bool
        Make those that an earlier run has noted as failed, and those with such a placeholder, and nothing else; the
        folder has to hold this mission.
    progress : callable
        Called in this thread with a Progress, about ten times a second at most, and at the end.
    cancelled : callable
        Asked many times a second; when it says yes the run ends within the time a picture takes. It waits for no
        request: those under way are left to the source, and end when it is closed.
    paused : callable
        Asked as often; while it says yes, no part is asked for and no picture begun. Progress is still reported.

    Raises
    ------
    InvalidInput
        A map type the source does not have, a plan for another pixel grid: before anything is written.
    OutputError
        A folder that cannot be written, that holds another mission, or holds this one without ``resume``, or
        does not hold it where only what has failed is wanted.
    SourceError
        The source cannot serve; what was finished is kept.
    """
    for count, what in ((connections, Message("connections")), (workers, Message("workers"))):
        if count is not None and count < 1:
            raise InvalidInput("{0} {1}: must be 1 or more", count, what)
    check_source(plan, source)
    chosen = _chosen(plan, only)
    if only_failed:
        check_captured(folder)
    path = open_folder(folder, captured_mission(plan), resume=resume or only_failed)
    listener = _Listener(progress, cancelled, paused)
    with Journal(path / JOURNAL_FILE) as journal:
        run = _Run(plan, source, path, journal, chosen, listener, only_failed=only_failed)
        for name in (PLAN_FILE, FOOTPRINTS_FILE):
            write_plan(plan, path / name)
        complete = all(
            run.capture_map_type(map_type, connections, workers or os.cpu_count() or 1)
            for map_type in plan.mission.imagery.map_types
        )
    return run.result(listener.active_s(), cancelled=not complete)


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


def check_source(plan: Plan, source: Source) -> None:
    """Raise InvalidInput where a source has not what a plan needs: its grid, map types, bands that can be written."""
    if source.grid != plan.grid:
        raise InvalidInput(
            "plan is for another pixel grid than that of {0}: plan with the source's own", source.title
        )
    for map_type in plan.mission.imagery.map_types:
        if source.map_types and map_type not in source.map_types:
            raise InvalidInput(
                "map type {0!r}: {1} has {2}", map_type, source.title, ", ".join(source.map_types)
            )
    bands, output = bands_of(source), plan.mission.output
    if output.image_format != "tif" and not bands.are_colours:
        raise InvalidInput(
            "image format {0}: has grey, or red, green and blue of 8 bits, and {1} gives {2}",
            output.image_format,
            source.title,
            bands,
            field="image_format",
        )
    check_size(output.img_size, bands)
    if _largest_px(plan) * bands.bytes_per_px > MAX_PICTURE_BYTES:
        raise InvalidInput(
            "images of {0:,} px with {1} bands of {2}: more than {3:,} bytes each",
            _largest_px(plan),
            len(bands),
            bands.data_type,
            MAX_PICTURE_BYTES,
            field="bands",
        )


def _largest_px(plan: Plan) -> int:
    """Pixels of the largest picture, as it is planned or as it is resized to."""
    width, height, _ = plan.mission.output.img_size or (1, 1, 1)
    return max(int((plan.width_px * plan.height_px).max()), width * height)


def _chosen(plan: Plan, only: Iterable[int] | None) -> Numbers:
    if only is None:
        return np.arange(len(plan), dtype=np.int64)
    chosen = np.unique(np.array(list(only), np.int64))
    outside = chosen[(chosen < 0) | (chosen >= len(plan))]
    if len(outside):
        raise InvalidInput("capture {0} of the plan: it has 0 to {1}", outside[0], len(plan) - 1)
    return chosen


class _Listener:
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


class _Run:
    """One run: what is known of each picture, what is to be made, and the counts.

    Raises
    ------
    OutputError
        Where the journal is of another plan, or a folder cannot be read.
    """

    def __init__(
        self,
        plan: Plan,
        source: Source,
        folder: Path,
        journal: Journal,
        chosen: Numbers,
        listener: _Listener,
        *,
        only_failed: bool,
    ) -> None:
        self._plan, self._source, self._folder = plan, source, folder
        self._journal, self._listener = journal, listener
        self._map_types = plan.mission.imagery.map_types
        self._done = self._requests = self._unique_parts = 0
        self._failures: list[tuple[int, int, Failure]] = []
        self._repeated: list[Repeat] = []
        #: Zooms, columns and rows of the tiles that captures over relief see, which take long to tell.
        self._tiles: dict[int, NDArray[np.int32]] = {}
        self._endings = file_endings(plan.mission.output.image_format, on_map=plan.size_px is None)
        self._outcomes = self._known_outcomes()
        self._drop_placeholders()
        self._other_columns = {
            map_type: other_columns(folder / map_type / TABLE_FILE) for map_type in self._map_types
        }
        wanted = (FAILED,) if only_failed else (FAILED, None)
        self._pending = {
            map_type: np.array([i for i in chosen.tolist() if self._status(map_type, i) in wanted], np.int64)
            for map_type in self._map_types
        }
        pending = sum(len(indices) for indices in self._pending.values())
        self._total = pending if only_failed else len(chosen) * len(self._map_types)
        self._skipped = self._total - pending

    def _known_outcomes(self) -> dict[str, dict[str, Outcome]]:
        """What earlier runs have left of each map type: failures, and pictures that are still there."""
        names = set(self._plan.names)
        known: dict[str, dict[str, Outcome]] = {}
        for map_type in self._map_types:
            outcomes = {name: o for (kind, name), o in self._journal.outcomes.items() if kind == map_type}
            foreign = min(set(outcomes) - names, default=None)
            if foreign is not None:
                raise OutputError(
                    "folder {0}: holds this mission with other images, such as {1}, because the "
                    "source or the version was another",
                    self._folder,
                    foreign,
                    remedy="choose another folder",
                )
            there = complete_pictures(self._folder / map_type, self._endings, outcomes)
            known[map_type] = {n: o for n, o in outcomes.items() if o.status == FAILED or n in there}
        return known

    def _drop_placeholders(self) -> None:
        """Count as failed, and remove, pictures of earlier runs that show what is known to be a placeholder by now."""
        if not isinstance(self._source, Provided):
            return
        for map_type, outcomes in self._outcomes.items():
            for name, outcome in outcomes.items():
                if any(map(self._source.placeholder.knows, outcome.repeated)):
                    remove_picture(self._folder / map_type, self._endings, name)
                    outcomes[name] = Outcome(map_type, name, reason=PLACEHOLDER_REASON)
                    self._journal.add(outcomes[name])

    def _status(self, map_type: str, index: int) -> str | None:
        outcome = self._outcomes[map_type].get(self._plan.names[index])
        return None if outcome is None else outcome.status

    def capture_map_type(self, map_type: str, connections: int, workers: int) -> bool:
        """Make the pictures of a map type that are not there, and its table; False where cancelled."""
        folder = self._folder / map_type
        try:
            order = sweep(self._plan.windows, self._pending[map_type]).tolist()
            users = self._users(map_type, order, workers)
            if users is None:
                return False
            self._unique_parts += len(users)
            pipeline: Pipeline[PictureJob, Made] = Pipeline(
                users,
                partial(self._source.fetch, map_type),
                make_picture,
                self._note,
                connections=connections,
                workers=workers,
                at_once=max(MAX_PICTURES_AT_ONCE_PX * RGB.bytes_per_px // self._largest_bytes(), 1),
            )
            exposures, products_in = exposures_of(self._plan), self._products_in(map_type)
            jobs = (
                (
                    job_of(self._plan, index, self._source, map_type, folder, exposures, products_in),
                    self._parts(index),
                )
                for index in order
            )
            earlier = self._requests

            def go_on() -> bool:
                self._requests = earlier + pipeline.requests
                return self._go_on(map_type)

            repeats = Repeats(self._plan.grid)
            try:
                with _received_by(repeats.note, self._source):
                    return pipeline.run(jobs, go_on, self._listener.wait)
            finally:
                self._requests = earlier + pipeline.requests
                self._note_repeats(map_type, repeats.found())
        finally:
            self._write_tables(map_type)
            self._listener.tell(partial(self._progress, map_type), at_once=True)

    def _largest_bytes(self) -> int:
        return _largest_px(self._plan) * max(bands_of(self._source).bytes_per_px, RGB.bytes_per_px)

    def _write_tables(self, map_type: str) -> None:
        """Write what tells of all pictures of a map type that are done or have failed so far."""
        folder, outcomes = self._folder / map_type, self._outcomes[map_type]
        table = table_of(self._plan, self._source, outcomes)
        table.with_other(self._other_columns[map_type]).save(folder / TABLE_FILE)
        if self._plan.mission.output.image_format == "jpg":
            there = [
                index
                for index in range(len(self._plan))
                if self._status(map_type, index) not in (FAILED, None)
            ]
            write_odm_files(folder, self._plan, np.array(there, np.int64))

    def _products_in(self, map_type: str) -> Path | None:
        """Folder of products, which are those of all map types and made with the first one's pictures."""
        is_first = map_type == self._map_types[0]
        return self._folder if is_first and self._plan.mission.output.products else None

    def _users(self, map_type: str, order: list[int], workers: int) -> Counter[Window] | None:
        """How many of the pictures to be made need each part; None where cancelled meanwhile."""
        users: Counter[Window] = Counter()
        with ThreadPoolExecutor(workers, "terrainav-trace") as threads:
            # Over relief every picture is traced to tell, so all processors do.
            ahead = threads.map if self._plan.relief is not None else map
            for start in range(0, len(order), _TRACED_AT_ONCE):
                for parts in ahead(self._parts, order[start : start + _TRACED_AT_ONCE]):
                    users.update({part.window for part in parts})
                    if not self._go_on(map_type):
                        return None
        return users

    def _go_on(self, map_type: str) -> bool:
        self._listener.tell(partial(self._progress, map_type))
        return self._listener.go_on()

    def _parts(self, index: int) -> list[Part]:
        if self._plan.relief is None:
            return parts_of(self._plan, self._source, index)
        if index not in self._tiles:
            self._tiles[index] = np.array(tiles_of(self._plan, index), np.int32).reshape(-1, 3)
        return parts_of_tiles(self._plan.grid, self._tiles[index].tolist())

    def _note(self, job: PictureJob, result: Made | PartError) -> None:
        """Enter what became of a picture."""
        map_type, name = job.description.map_type, job.description.name
        if isinstance(result, PartError):
            outcome = Outcome(map_type, name, reason=Message(result))
            failure = Failure(map_type, name, outcome.reason)
            self._failures.append((self._map_types.index(map_type), job.index, failure))
        else:
            outcome = Outcome(map_type, name, result.entropy, "", *result[1:])
            self._done += 1
        self._journal.add(outcome)
        self._outcomes[map_type][name] = outcome

    def _note_repeats(self, map_type: str, found: Mapping[str, frozenset[Window]]) -> None:
        """Enter in the journal which pictures show files that came for places far apart."""
        digests = {place: digest for digest, places in found.items() for place in places}
        images: dict[str, list[str]] = {digest: [] for digest in found}
        for index, name in enumerate(self._plan.names if found else ()):
            outcome = self._outcomes[map_type].get(name)
            if outcome is None or outcome.status == FAILED:
                continue
            corners = (corner(*part.window[:3]) for part in self._parts(index))
            shown = tuple(sorted({digests[place] for place in corners if place in digests}))
            if shown:
                repeated = tuple(sorted({*outcome.repeated, *shown}))
                self._outcomes[map_type][name] = outcome = replace(outcome, repeated=repeated)
                self._journal.add(outcome)
            for digest in shown:
                images[digest].append(name)
        self._repeated += [
            Repeat(map_type, digest, len(places), tuple(images[digest])) for digest, places in found.items()
        ]

    def _progress(self, map_type: str) -> Progress:
        return Progress(
            self._total,
            self._done,
            len(self._failures),
            self._skipped,
            self._requests,
            map_type,
            self._listener.active_s(),
            self._listener.is_paused,
        )

    def result(self, seconds: float, *, cancelled: bool) -> CaptureResult:
        """Return what the run has done."""
        return CaptureResult(
            folder=self._folder,
            total=self._total,
            written=self._done,
            failed=tuple(failure for _, _, failure in sorted(self._failures, key=lambda entry: entry[:2])),
            skipped=self._skipped,
            requests=self._requests,
            unique_parts=self._unique_parts,
            seconds=seconds,
            cancelled=cancelled,
            repeated=tuple(self._repeated),
        )


@contextmanager
def _received_by(note: Received, source: Source) -> Iterator[None]:
    """Have a source tell which files a provider sends it, if one does."""
    if not isinstance(source, Provided):
        yield
        return
    source.received = note
    try:
        yield
    finally:
        source.received = None
