"""The run that turns a plan into a dataset: folder, journal, pictures, tables, and what it tells meanwhile."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Numbers
from ..dataset.folder import FOOTPRINTS_FILE, JOURNAL_FILE, PLAN_FILE, TABLE_FILE
from ..dataset.table import other_columns
from ..errors import InvalidInput, Message, OutputError, PartError
from ..imagery.opening import NamedSource
from ..imagery.placeholder import PLACEHOLDER_REASON, Provided, Repeats
from ..imagery.source import Source, Window
from ..mission.export import write_plan
from ..mission.plan import Plan
from ..storage.files import write_whole
from ..storage.stores import is_address, store_path
from .begun import hold_to_mission
from .folder import (
    captured_mission,
    check_captured,
    complete_pictures,
    has_blocks,
    open_folder,
    remove_picture,
)
from .holding import kept
from .journal import FAILED, Journal, Outcome
from .making import DEFAULT_CONNECTIONS, Making, check_source, chosen_of, repeats_of
from .progress import CaptureResult, Failure, Listener, Progress, Repeat
from .records import Made, PictureJob, exposures_of, outcome_of, write_tables
from .writers import file_endings

if TYPE_CHECKING:
    from .blocks.engines import Engine
    from .blocks.running import Blocks


def capture(
    plan: Plan,
    source: Source | NamedSource,
    folder: str | os.PathLike[str],
    *,
    executor: Executor | Engine | None = None,
    blocks: Blocks | None = None,
    connections: int = DEFAULT_CONNECTIONS,
    workers: int | None = None,
    resume: bool = False,
    only: Iterable[int] | None = None,
    only_failed: bool = False,
    progress: Callable[[Progress], object] | None = None,
    cancelled: Callable[[], bool] | None = None,
    paused: Callable[[], bool] | None = None,
    notice: Callable[[Message], object] | None = None,
) -> CaptureResult:
    """Capture the pictures of a plan into a dataset folder.

    With an executor, into an object store, or where ``blocks`` are asked for, they are made in blocks: by any workers
    that have TerrAInav, a block committed whole or not at all, and what is committed is the journal. All else is done
    by threads of this process, picture by picture.

    Pictures are written whole or not at all, and noted in the journal one by one; those that cannot be made are
    named in the journal and the table with the reason, and the others go on. The tables are written at the end,
    also of a run that was stopped; columns that others have added to them are kept. The same mission leaves the same
    pictures and tables, in one go or in several.

    Parameters
    ----------
    source : Source or NamedSource
        With the pixel grid that the plan was made for; in blocks one that is named, which their makers open themselves.
    folder : path or str
        Made if it is not there; or the address of an object store's, as `store_path` takes it.
    executor : Executor, Engine or None
        Who makes blocks: any of `concurrent.futures`' kind; None for this process.
    blocks : Blocks or None
        How captures are divided, and how files are laid out; None for the usual way.
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
        Asked as often; while it says yes, no part is asked for and no picture begun. Progress is still reported. Blocks
        that other processes make go on to their end.
    notice : callable
        Told in one line of each block that is begun again, as its worker died.

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
    folder = store_path(folder)
    if executor is not None or blocks is not None or is_address(folder):
        if not isinstance(source, NamedSource) or only is not None:
            raise InvalidInput(
                "capture in blocks: needs a source by its name, and is of all captures of a plan"
            )
        # What makes blocks takes its time to load, and others do not need it.
        from .blocks.engines import Engine, here
        from .blocks.running import Blocks, capture_in_blocks

        with ExitStack() as opened:
            engine = opened.enter_context(here(workers)) if executor is None else Engine.of(executor, workers)
            return capture_in_blocks(
                plan,
                source,
                str(folder),
                engine,
                blocks or Blocks(),
                connections=connections,
                resume=resume,
                only_failed=only_failed,
                progress=progress,
                cancelled=cancelled,
                paused=paused,
                notice=notice,
            )
    if isinstance(source, NamedSource):
        raise InvalidInput("source {0!r}: must be opened, but for a capture in blocks", source.text)
    check_source(plan, source)
    chosen = chosen_of(plan, only)
    if only_failed:
        check_captured(folder)
    if has_blocks(folder):
        raise OutputError("folder {0}: was captured in blocks", folder, remedy="choose another folder")
    mission = captured_mission(plan)
    path = open_folder(folder, mission, resume=resume or only_failed)
    listener = Listener(progress, cancelled, paused)
    with Journal(path / JOURNAL_FILE) as journal, kept(path / JOURNAL_FILE, journal.file) as check:
        hold_to_mission(path, mission)
        run = _Run(plan, source, path, journal, chosen, listener, check, only_failed=only_failed)
        making = Making(
            plan,
            source,
            path,
            connections,
            workers or os.cpu_count() or 1,
            run.note,
            exposures=exposures_of(plan),
            write=partial(_write_checked, run.check),
        )
        for name in (PLAN_FILE, FOOTPRINTS_FILE):
            run.check()
            write_plan(plan, path / name)
        complete = all(run.capture_map_type(map_type, making) for map_type in plan.mission.imagery.map_types)
    return run.result(making, listener.active_s(), cancelled=not complete)


def _write_checked(check: Callable[[], None], path: Path, data: bytes) -> None:
    """Write a file in a place that is still the run's."""
    check()
    write_whole(path, data)


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
        listener: Listener,
        check: Callable[[], None],
        *,
        only_failed: bool,
    ) -> None:
        self._is_held = check
        self._plan, self._source, self._folder = plan, source, folder
        self._journal, self._listener = journal, listener
        self._map_types = plan.mission.imagery.map_types
        self._done = self._requests = 0
        self._failures: list[tuple[int, int, Failure]] = []
        self._repeated: list[Repeat] = []
        self._endings = file_endings(plan.mission.output.image_format, on_map=plan.frames.on_map)
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

    def check(self) -> None:
        """Raise OutputError where another run has taken the folder."""
        self._is_held()
        self._journal.check()

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

    def capture_map_type(self, map_type: str, making: Making) -> bool:
        """Make the pictures of a map type that are not there, and its table; False where cancelled."""
        repeats = Repeats(self._plan.grid)

        def go_on() -> bool:
            self._requests = making.requests
            self._listener.tell(partial(self._progress, map_type))
            self.check()
            return self._listener.go_on()

        try:
            return making.make(map_type, self._pending[map_type], go_on, self._listener.wait, repeats.note)
        finally:
            self._requests = making.requests
            # Where another run has taken the folder, the tables are its own.
            self.check()
            self._note_repeats(map_type, repeats.found(), making)
            write_tables(
                self._folder / map_type,
                self._plan,
                self._source,
                self._outcomes[map_type],
                self._other_columns[map_type],
            )
            self._listener.tell(partial(self._progress, map_type), at_once=True)

    def note(self, job: PictureJob, result: Made | PartError) -> None:
        """Enter what became of a picture."""
        outcome = outcome_of(job, result)
        if outcome.status == FAILED:
            failure = Failure(outcome.map_type, outcome.name, outcome.reason)
            self._failures.append((self._map_types.index(outcome.map_type), job.index, failure))
        else:
            self._done += 1
        self._journal.add(outcome)
        self._outcomes[outcome.map_type][outcome.name] = outcome

    def _note_repeats(self, map_type: str, found: Mapping[str, frozenset[Window]], making: Making) -> None:
        """Enter in the journal which pictures show files that came for places far apart."""
        outcomes, shown = self._outcomes[map_type], making.shown(found, self._outcomes[map_type])
        for name, digests in shown.items():
            repeated = tuple(sorted({*outcomes[name].repeated, *digests}))
            outcomes[name] = outcome = replace(outcomes[name], repeated=repeated)
            self._journal.add(outcome)
        self._repeated += repeats_of(map_type, found, shown)

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

    def result(self, making: Making, seconds: float, *, cancelled: bool) -> CaptureResult:
        """Return what the run has done."""
        return CaptureResult(
            folder=self._folder,
            total=self._total,
            written=self._done,
            failed=tuple(failure for _, _, failure in sorted(self._failures, key=lambda entry: entry[:2])),
            skipped=self._skipped,
            requests=making.requests,
            unique_parts=making.unique_parts,
            seconds=seconds,
            cancelled=cancelled,
            repeated=tuple(self._repeated),
        )
