"""Capture a plan into a dataset with threads of this process, or in blocks."""

from __future__ import annotations

import os
from collections.abc import Iterable
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import replace
from typing import TYPE_CHECKING

from ..dataset.folder import FOOTPRINTS_FILE, PLAN_FILE, TABLE_FILE
from ..dataset.table import other_columns
from ..errors import InvalidInput, Message
from ..imagery.opening import NamedSource
from ..imagery.placeholder import Placeholder, Provided, Repeats
from ..imagery.source import Source
from ..map_types import twin_type
from ..mission.export import write_plan
from ..mission.plan import Plan
from ..picture.camera_frame import load_code
from ..storage.stores import is_address, store_path
from ..waiting import cancellable
from .cameras import write_cameras
from .images import CaptureJournal, ImageJournal
from .journal import FAILED, Outcome
from .labels import open_labels, write_label_tables
from .making import DEFAULT_CONNECTIONS, ImageMaker, ImageParts, Maker, Piece, check_source
from .progress import SILENT, CaptureResult, Failure, Listener, Progress, Repeat, Reporter
from .records import plan_exposures, twin_plan, write_tables

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
    listener: Listener = SILENT,
) -> CaptureResult:
    """Capture the images of a plan into a dataset folder.

    By default, threads of this process make the images one by one. With ``executor`` or ``blocks``, and in an object
    store, images are made in blocks by any workers that have TerrAInav; each block is committed atomically.

    Images are written atomically and noted in the journal. If an image cannot be made, the reason is noted in journal
    and table, and the run continues. Tables are written at the end, also if the run is stopped, and keep additional
    columns. The same mission gives the same images and tables, in one run or in several.

    Parameters
    ----------
    source : Source or NamedSource
        Source with the pixel grid of the plan; for blocks a NamedSource, which each worker opens.
    folder : path or str
        Folder, created if it does not exist, or an address in an object store (see `store_path`).
    executor : Executor, Engine or None
        Executor of the blocks, such as one of `concurrent.futures`; None for this process.
    blocks : Blocks or None
        Size of blocks and layout of files; None for the defaults.
    connections : int
        Parts fetched at once, at least 1.
    workers : int or None
        Images assembled and written at once; None for the number of processors.
    resume : bool
        Continue in a folder that holds this mission: make images that are missing or have failed, and images that show
        a file (see `Repeat`) that the source now counts as a placeholder.
    only : iterable of int or None
        Indices of the captures to make; None for all.
    only_failed : bool
        Make only images that failed in an earlier run or show a placeholder, as with ``resume``; the folder must hold
        this mission.
    listener : Listener
        Callbacks for progress, pause and stop.

    Raises
    ------
    InvalidInput
        The source does not have the map type or the plan's pixel grid; nothing is written then.
    OutputError
        The folder cannot be written, holds another mission, holds this mission without ``resume``, or does not hold it
        with ``only_failed``.
    SourceError
        The source cannot serve; finished images are kept.
    """
    for count, what in ((connections, Message("connections")), (workers, Message("workers"))):
        if count is not None and count < 1:
            raise InvalidInput("{0} {1}: must be 1 or more", count, what)
    root = store_path(folder)
    # Before time counts, by which the rest is estimated.
    load_code(plan)
    with cancellable(listener.cancelled):
        labels = open_labels(plan)
    reporter = Reporter(listener)
    with ExitStack() as opened:
        # Before images are made, waiting for an object store can be cancelled at once.
        with cancellable(listener.cancelled):
            journal: CaptureJournal
            maker: Maker
            if executor is not None or blocks is not None or is_address(root):
                if not isinstance(source, NamedSource) or only is not None:
                    raise InvalidInput(
                        "capture in blocks: needs a source by its name, and is of all captures of a plan"
                    )
                # Imported here, as it is slow and only blocks need it.
                from .blocks.engines import Engine, local_engine
                from .blocks.running import Blocks, opened_blocks

                engine = (
                    opened.enter_context(local_engine(workers))
                    if executor is None
                    else Engine.from_executor(executor, workers)
                )
                journal, maker = opened.enter_context(
                    opened_blocks(
                        plan,
                        source,
                        root,
                        engine,
                        blocks or Blocks(),
                        connections,
                        listener.notice,
                        resume=resume,
                        only_failed=only_failed,
                    )
                )
            else:
                if isinstance(source, NamedSource):
                    raise InvalidInput("source {0!r}: must be opened, but for a capture in blocks", source.text)
                check_source(plan, source)
                journal = opened.enter_context(
                    ImageJournal.opened(plan, root, only, resume=resume, only_failed=only_failed)
                )
                maker = ImageMaker(
                    ImageParts(plan, source),
                    root,
                    connections,
                    workers or os.cpu_count() or 1,
                    plan_exposures(plan),
                    journal.write,
                    labels,
                )
            run = CaptureRun(journal, maker, reporter, only_failed=only_failed)
            run.prepare()
            if labels is not None:
                write_label_tables(labels, root, plan.mission.output.image_format)
        complete = run.make()
    return run.result(cancelled=not complete)


class CaptureRun:
    """Run of a capture: reads outcomes from the journal, has the maker make missing images, and counts.

    Parameters
    ----------
    journal : CaptureJournal
    maker : Maker
    reporter : Reporter
    only_failed : bool
        Whether to make only images that have failed.

    Raises
    ------
    OutputError
        The journal belongs to another plan, or a folder cannot be read.
    """

    def __init__(self, journal: CaptureJournal, maker: Maker, reporter: Reporter, *, only_failed: bool) -> None:
        self._journal, self._maker, self._reporter = journal, maker, reporter
        self._plan, self._source = maker.parts.plan, maker.parts.source
        self._map_types = self._plan.mission.imagery.map_types
        self._done = 0
        self._failures: list[Outcome] = []
        self._repeats = {map_type: Repeats(self._plan.grid) for map_type in self._map_types}
        self._repeated: list[Repeat] = []
        self._known: dict[str, dict[str, Outcome]] = {}
        self._pieces: dict[str, list[Piece]] = {}
        source = self._source
        placeholder = source.placeholder if isinstance(source, Provided) else Placeholder()
        for map_type in self._map_types:
            found = journal.read(map_type, placeholder, only_failed=only_failed)
            self._known[map_type], self._pieces[map_type] = found
        pending = sum(len(piece.indices) for pieces in self._pieces.values() for piece in pieces)
        self._total = pending if only_failed else journal.images * len(self._map_types)
        self._skipped = self._total - pending

    def prepare(self) -> None:
        """Write the plan and its cameras, and files that makers need."""
        for name in (PLAN_FILE, FOOTPRINTS_FILE):
            self._journal.check()
            write_plan(self._plan, self._journal.root / name)
        self._journal.check()
        write_cameras(self._plan, self._journal.root)
        self._maker.prepare()

    def make(self) -> bool:
        """Make the images, then the tables; returns False if the listener stopped it."""
        for map_types in self._maker.rounds(self._map_types):
            try:
                complete = self._maker.make([piece for map_type in map_types for piece in self._pieces[map_type]], self)
            finally:
                self._finish(map_types)
            if not complete:
                return False
        return True

    def wants_more(self) -> bool:
        """Report progress, and ask whether to make more images; raises OutputError if another run took the place."""
        self._journal.check()
        self._reporter.report(self._progress)
        return not self._reporter.ask_cancelled()

    def is_paused(self) -> bool:
        """Ask whether to wait before more images are made."""
        return self._reporter.ask_paused()

    def note(self, outcome: Outcome) -> None:
        """Take the outcome of an image."""
        if outcome.status == FAILED:
            self._failures.append(outcome)
        else:
            self._done += 1
        self._journal.note(outcome)
        self._known[outcome.map_type][outcome.name] = outcome

    def repeats(self, map_type: str) -> Repeats:
        """Files that a provider has sent for a map type in this run."""
        return self._repeats[map_type]

    def _finish(self, map_types: Iterable[str]) -> None:
        """Write the tables of map types; raises OutputError if another run has taken the place."""
        self._journal.check()
        for map_type in map_types:
            self._note_repeats(map_type)
            folder = self._journal.root / map_type
            write_tables(
                folder,
                self._plan,
                self._source,
                self._known[map_type],
                other_columns(folder / TABLE_FILE),
                in_shards=self._journal.in_shards,
            )
            if not self._journal.in_shards:
                self._write_twin_tables(map_type)
            self._journal.write_index(map_type)
        self._reporter.report(self._progress, at_once=True)

    def _write_twin_tables(self, map_type: str) -> None:
        """Write the tables of the twins of a map type's images."""
        for kind in self._plan.mission.varied.twins:
            folder = self._journal.root / twin_type(map_type, kind)
            outcomes = {name: one.twin(kind) for name, one in self._known[map_type].items()}
            plan = twin_plan(self._plan, kind)
            write_tables(folder, plan, self._source, outcomes, other_columns(folder / TABLE_FILE))

    def _note_repeats(self, map_type: str) -> None:
        """Note the images that show files sent for several places far apart."""
        repeated, known = self._repeats[map_type].found(), self._known[map_type]
        shown = self._maker.parts.find_images(repeated, known)
        for name, digests in shown.items():
            known[name] = replace(known[name], repeated=tuple(sorted({*known[name].repeated, *digests})))
            self._journal.note(known[name])
        self._repeated += [
            Repeat(map_type, digest, len(places), tuple(name for name, one in shown.items() if digest in one))
            for digest, places in repeated.items()
        ]

    def _progress(self) -> Progress:
        return Progress(
            self._total,
            self._done + self._maker.under_way,
            len(self._failures),
            self._skipped,
            self._maker.requests,
            self._maker.map_type,
            self._reporter.active_s(),
            self._reporter.is_paused,
        )

    def result(self, *, cancelled: bool) -> CaptureResult:
        """Return the result of the run."""
        order = {name: at for at, name in enumerate(self._plan.names)} if self._failures else {}
        failures = sorted(self._failures, key=lambda one: (self._map_types.index(one.map_type), order[one.name]))
        return CaptureResult(
            folder=self._journal.root,
            total=self._total,
            written=self._done,
            failed=tuple(Failure(one.map_type, one.name, one.reason) for one in failures),
            skipped=self._skipped,
            requests=self._maker.requests,
            unique_parts=self._maker.unique_parts,
            seconds=self._reporter.active_s(),
            cancelled=cancelled,
            repeated=tuple(self._repeated),
        )
