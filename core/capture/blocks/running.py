"""A run in blocks: who makes which, what is told meanwhile, and the tables at the end."""

from __future__ import annotations

import time
import uuid
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from fractions import Fraction

from ...arrays import Numbers
from ...dataset.folder import FOOTPRINTS_FILE, PLAN_FILE, TABLE_FILE
from ...dataset.table import other_columns
from ...errors import InvalidInput, Message, OptionName, OutputError, SourceError, TerrAInavError
from ...imagery.opening import NamedSource
from ...imagery.placeholder import Provided, Repeats, noted_digests
from ...imagery.source import Source
from ...mission.export import write_plan
from ...mission.plan import Plan
from ...picture.heights import with_whole_paths
from ...resources import version
from ...storage.files import json_bytes, write_whole
from ...storage.stores import is_address
from ...waiting import ended_where
from ..choices import FOLDERS, IMAGES, WEBDATASET
from ..holding import held
from ..journal import FAILED, Outcome
from ..making import Making, check_source, repeats_of
from ..progress import CaptureResult, Failure, Listener, Progress, Repeat
from ..records import exposures_of, write_tables
from .block import (
    Block,
    BlockResult,
    Control,
    Record,
    WrongWorker,
    block_name,
    call_of,
    controls,
    make_block,
    write_relief,
)
from .destination import Destination, check_in_blocks
from .division import divide
from .engines import Engine
from .shards import INDEX_FILE, index_of

#: How often a block is begun before it is given up: workers that die take it with them.
TRIES = 4
_POLL_S = 0.1
#: Names of errors that a worker's end looks like from here, by Dask and by Ray.
_DEATHS = ("KilledWorker", "CancelledError", "FutureCancelledError", "CommClosedError", "WorkerCrashedError")
#: Blocks in a row that are given up, with none made in between, after which the workers are.
_MOST_LOST = 5
#: Seconds without any worker after which that is said: where one dies, another one is on its way.
_NONE_S = 5.0


@dataclass(frozen=True)
class Blocks:
    """How a capture is divided, and how its files are laid out.

    Parameters
    ----------
    images : int
        Of a block at most.
    layout : str
        One of `choices.LAYOUTS`.
    """

    images: int = IMAGES
    layout: str = FOLDERS


def capture_in_blocks(
    plan: Plan,
    source: NamedSource,
    destination: str,
    engine: Engine,
    blocks: Blocks = Blocks(),
    *,
    connections: int,
    resume: bool,
    only_failed: bool,
    progress: Callable[[Progress], object] | None = None,
    cancelled: Callable[[], bool] | None = None,
    paused: Callable[[], bool] | None = None,
    notice: Callable[[Message], object] | None = None,
) -> CaptureResult:
    """Capture a plan in blocks; see `capture`, which leads here.

    Parameters
    ----------
    connections : int
        Requests under way at once, of all blocks together.
    notice : callable
        Told in one line of each block that was begun again, and why.
    """
    if destination.startswith("memory:") and not engine.in_process:
        raise InvalidInput(
            "address {0}: is of this process alone, and workers are others: must be a folder, or begin with {1}",
            destination,
            "s3://, gs:// or az://",
        )
    listener = Listener(progress, cancelled, paused)
    with ExitStack() as opened:
        own = opened.enter_context(closing(source.open()))
        check_source(plan, own)
        # Nothing is lost yet where a store that says nothing is given up at once.
        with ended_where(cancelled):
            if only_failed:
                check_in_blocks(destination)
            place = Destination(destination, plan, resume=resume or only_failed)
            check = opened.enter_context(held(place.root))
            place.check_division(blocks.layout, blocks.images)
            run = _Run(plan, source, own, place, engine, blocks, connections, listener, check)
            run.notice = notice or (lambda _: None)
            run.begin(only_failed=only_failed)
        try:
            complete = run.make_all()
        finally:
            run.write_tables()
        return run.result(cancelled=not complete)


class _Run:
    """One run: blocks that are to be made, those under way, and what is known of all images."""

    notice: Callable[[Message], object]

    def __init__(
        self,
        plan: Plan,
        source: NamedSource,
        own: Source,
        place: Destination,
        engine: Engine,
        blocks: Blocks,
        connections: int,
        listener: Listener,
        check: Callable[[], None],
    ) -> None:
        self._plan, self._source, self._own = plan, source, own
        self._place = place
        self._engine, self._blocks = engine, blocks
        self._connections, self._listener, self._check = connections, listener, check
        self._name = uuid.uuid4().hex
        self._control = Control(check=check)
        # Of workers each may have a current folder of its own.
        self._terrain = with_whole_paths(plan.mission.terrain)
        self._whole = str(place.root) if is_address(place.root) else str(place.root.absolute())
        self._map_types = plan.mission.imagery.map_types
        self._divided: list[Numbers] = divide(plan.windows, blocks.images)
        self._exposures = exposures_of(plan)
        self._records: dict[str, dict[int, Record]] = {}
        self._made: set[tuple[str, int]] = set()
        self._pending: deque[tuple[str, int]] = deque()
        self._tries: dict[tuple[str, int], int] = {}
        self._under_way: dict[Future[BlockResult], tuple[str, int, Fraction]] = {}
        self._none_since_s: float | None = None
        self._none_is_told = False
        self._lost_in_a_row = 0
        self._requests = self._unique_parts = self._total = self._skipped = self._done = self._failed = 0

    def begin(self, *, only_failed: bool) -> None:
        """See what is there, write what tells of the whole, and put what is missing in a row."""
        for map_type in self._map_types:
            self._records[map_type] = self._place.records(map_type, self._divided)
            for number in range(len(self._divided)):
                record = self._records[map_type].get(number)
                missing = not only_failed if record is None else record.failed or self._is_placeholder(record)
                if missing:
                    self._pending.append((map_type, number))
                elif record is not None and not only_failed:
                    self._skipped += len(record.outcomes)
        pending = sum(len(self._divided[number]) for _, number in self._pending)
        self._total = pending if only_failed else len(self._plan) * len(self._map_types)
        for name in (PLAN_FILE, FOOTPRINTS_FILE):
            write_plan(self._plan, self._place.root / name)
        if not self._engine.in_process:
            write_relief(self._plan, self._place.root)

    def _is_placeholder(self, record: Record) -> bool:
        """Whether a block has a file that counts as placeholder by now."""
        if not isinstance(self._own, Provided):
            return False
        return any(map(self._own.placeholder.knows, noted_digests(record.noted)))

    def make_all(self) -> bool:
        """Make all blocks that are missing; False where cancelled."""
        controls[self._name] = control = self._control
        try:
            while self._pending or self._under_way:
                self._check()
                self._listener.tell(self._progress)
                if not self._listener.go_on():
                    return False
                held = self._listener.wait()
                (control.held.set if held else control.held.clear)()
                if not held:
                    self._submit()
                if self._under_way:
                    self._take(wait(self._under_way, _POLL_S, FIRST_COMPLETED).done)
                else:
                    time.sleep(_POLL_S)
            return True
        finally:
            control.stopped.set()
            for future in self._under_way:
                future.cancel()
            if self._engine.in_process:
                # Its threads would go on with what the caller is about to close.
                self._take(wait(self._under_way).done, ended=True)
            del controls[self._name]

    def _submit(self) -> None:
        """Hand blocks to workers that have none, as far as the provider's limits have shares left."""
        slots = self._slots()
        most = self._source.policy.most_sharers if not self._source.is_local else None
        sharers = slots if most is None else min(slots, most)
        share = Fraction(1, max(sharers, 1))
        while self._pending and len(self._under_way) < sharers:
            # Shares of blocks that were begun when there were fewer workers are larger than those of today.
            if most is not None and sum(one for *_, one in self._under_way.values()) + share > 1:
                return
            map_type, number = self._pending.popleft()
            block = self._block(map_type, number, sharers)
            try:
                if self._engine.in_process:
                    future = self._engine.executor.submit(make_block, block)
                else:
                    call, about = call_of(block)
                    future = self._engine.executor.submit(call, about)
            except (RuntimeError, OSError) as wrong:
                raise _broken(wrong) from wrong
            self._under_way[future] = (map_type, number, share)

    def _slots(self) -> int:
        """How many blocks workers make at once, now; where there has been none for a while, that is said."""
        try:
            slots = self._engine.slots()
        except (RuntimeError, OSError) as wrong:
            raise _broken(wrong) from wrong
        if slots:
            if self._none_is_told:
                self.notice(Message("workers: {0:,} there: going on", slots))
            self._none_since_s, self._none_is_told = None, False
        elif self._none_since_s is None:
            self._none_since_s = time.monotonic()
        elif not self._none_is_told and time.monotonic() - self._none_since_s > _NONE_S:
            self._none_is_told = True
            self.notice(Message("workers: none is there: waiting for one"))
        return slots

    def _block(self, map_type: str, number: int, sharers: int) -> Block:
        which = self._divided[number]
        connections = max(self._connections // sharers, 1)
        options = replace(self._source.options, connections=connections, sharers=sharers)
        return Block(
            number,
            map_type,
            self._plan.part(which),
            which,
            self._source.asked(options),
            self._whole,
            self._terrain,
            self._blocks.layout,
            None if self._exposures is None else self._exposures.part(which),
            connections,
            self._engine.workers,
            self._name,
        )

    def _take(self, done: Iterable[Future[BlockResult]], *, ended: bool = False) -> None:
        """Note what has come of blocks; those whose worker died, or whose place could not be written, come again."""
        for future in done:
            map_type, number, _ = self._under_way.pop(future)
            self._control.made.pop(block_name(map_type, number), None)
            wrong = _end_of(future)
            if wrong is None:
                result = future.result()
                self._note(map_type, number, result.record)
                self._lost_in_a_row = 0
                self._requests += result.requests
                self._unique_parts += result.unique_parts
            elif not ended:
                self._again(map_type, number, wrong)

    def _note(self, map_type: str, number: int, record: Record) -> None:
        """Take the record of a block that this run has made, or has given up."""
        self._records[map_type][number] = record
        self._made.add((map_type, number))
        # Counted once: who asks for progress does so many times a second, and images may be millions.
        failed = sum(one.status == FAILED for one in record.outcomes.values())
        self._failed += failed
        self._done += len(record.outcomes) - failed

    def _again(self, map_type: str, number: int, wrong: BaseException) -> None:
        """Put a block in the row again, or give it up; what stops the whole run is raised."""
        # Ray hands on what was raised within an error of its own.
        cause = getattr(wrong, "cause", None)
        wrong = cause if isinstance(cause, BaseException) else wrong
        if isinstance(wrong, (WrongWorker, SourceError, InvalidInput)) or (
            self._engine.in_process and isinstance(wrong, TerrAInavError)
        ):
            raise wrong
        if isinstance(wrong, BrokenExecutor):
            raise _broken(wrong) from wrong
        if isinstance(wrong, ModuleNotFoundError) and "terrainav" in str(wrong):
            raise OutputError(
                "workers: not all have TerrAInav {0}",
                version(),
                remedy="install it on each, of the same version",
            ) from wrong
        if isinstance(wrong, ImportError) and not self._engine.in_process:
            raise OutputError(
                "workers: not all have what TerrAInav needs ({0})", wrong, remedy="install it on each"
            ) from wrong
        reason = Message(wrong) if isinstance(wrong, TerrAInavError) else _died(wrong)
        key, name = (map_type, number), block_name(map_type, number)
        self._tries[key] = self._tries.get(key, 1) + 1
        if self._tries[key] > TRIES:
            if isinstance(wrong, OutputError):
                raise wrong
            self._lost_in_a_row += 1
            if self._lost_in_a_row > _MOST_LOST:
                raise OutputError(
                    "workers: {0} blocks in a row could not be made ({1})",
                    self._lost_in_a_row,
                    reason,
                    remedy=Message("resume it{0} once they are well", OptionName("resume").in_brackets),
                )
            lost = (self._plan.names[index] for index in self._divided[number].tolist())
            record = Record({one: Outcome(map_type, one, reason=reason) for one in lost})
            record.commit(self._place.root, name)
            self._note(map_type, number, record)
            self.notice(Message("block {0}: {1}, {2} times: given up", name, reason, TRIES))
            return
        self.notice(Message("block {0}: {1}: it is begun again", name, reason))
        self._pending.appendleft(key)

    def _progress(self) -> Progress:
        map_type = self._pending[0][0] if self._pending else self._map_types[-1]
        return Progress(
            self._total,
            self._done + sum(self._control.made.copy().values()),
            self._failed,
            self._skipped,
            self._requests,
            map_type,
            self._listener.active_s(),
            self._listener.is_paused,
        )

    def write_tables(self) -> None:
        """Write what tells of all images that are done or have failed so far."""
        # Where another run has taken the place, the tables are its own.
        self._check()
        for map_type in self._map_types:
            folder, in_shards = self._place.root / map_type, self._blocks.layout == WEBDATASET
            others, outcomes = other_columns(folder / TABLE_FILE), self._outcomes(map_type)
            write_tables(folder, self._plan, self._own, outcomes, others, in_shards=in_shards)
            if in_shards:
                write_whole(folder / INDEX_FILE, json_bytes(index_of(self._shards(map_type))))
        self._listener.tell(self._progress, at_once=True)

    def _outcomes(self, map_type: str) -> dict[str, Outcome]:
        records = self._records[map_type]
        return {name: one for number in sorted(records) for name, one in records[number].outcomes.items()}

    def _shards(self, map_type: str) -> dict[str, tuple[int, int]]:
        """Images and bytes of each shard, by file name."""
        return {
            f"{block_name(map_type, number)}.tar": (
                sum(one.status != FAILED for one in record.outcomes.values()),
                record.shard_bytes,
            )
            for number, record in sorted(self._records[map_type].items())
            if record.shard_bytes
        }

    def _repeats(self) -> Iterator[Repeat]:
        """Files that came for places far apart in the blocks that this run has made, and the images that show them."""
        for map_type in self._map_types:
            repeats = Repeats(self._plan.grid)
            for made, number in self._made:
                if made == map_type:
                    repeats.add(self._records[map_type][number].noted)
            found = repeats.found()
            if found:
                making = Making(
                    self._plan, self._own, self._place.root, 1, 1, lambda *_: None, exposures=None
                )
                yield from repeats_of(map_type, found, making.shown(found, self._outcomes(map_type)))

    def result(self, *, cancelled: bool) -> CaptureResult:
        """Return what the run has done."""
        order = {name: at for at, name in enumerate(self._plan.names)}
        failed = [
            Failure(map_type, one.name, one.reason)
            for map_type in self._map_types
            for made, number in self._made
            if made == map_type
            for one in self._records[map_type][number].outcomes.values()
            if one.status == FAILED
        ]
        failed.sort(key=lambda one: (self._map_types.index(one.map_type), order[one.name]))
        progress = self._progress()
        return CaptureResult(
            folder=self._place.root,
            total=self._total,
            written=self._done,
            failed=tuple(failed),
            skipped=self._skipped,
            requests=self._requests,
            unique_parts=self._unique_parts,
            seconds=progress.active_s,
            cancelled=cancelled,
            repeated=tuple(self._repeats()),
        )


def _end_of(future: Future[BlockResult]) -> BaseException | None:
    """What ended a block that was not made, of whatever kind: sys.exit() on a worker ends no run."""
    try:
        return future.exception()
    except CancelledError as wrong:
        return wrong


def _died(wrong: BaseException) -> Message:
    """Few words for what a worker's end, or a fault on it, looks like from here."""
    kind = type(wrong).__name__
    if kind in _DEATHS:
        return Message("its worker died")
    said = str(wrong).partition("\n")[0][:120]
    return Message("{0} on its worker ({1})", kind, said)


def _broken(wrong: BaseException) -> OutputError:
    # What Dask says is of its connections, and of their ends within it.
    return OutputError("workers: all are gone ({0})", type(wrong).__name__)
