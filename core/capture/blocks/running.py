"""Make a capture in blocks: hand blocks to an engine, and retry blocks whose worker died."""

from __future__ import annotations

import time
import uuid
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

from ...errors import InvalidInput, Message, OptionName, OutputError, SourceError, TerrAInavError
from ...imagery.opening import NamedSource
from ...mission.plan import Plan
from ...picture.heights import absolute_terrain
from ...resources import version
from ...storage.stores import is_address
from ..choices import FOLDERS, IMAGES
from ..labels import absolute_labels
from ..making import ImageParts, Orders, Piece, check_source
from ..records import plan_exposures
from .block import (
    Block,
    BlockResult,
    Control,
    Record,
    WrongWorker,
    block_name,
    controls,
    make_block,
    packed_call,
    write_relief,
)
from .engines import Engine
from .journal import BlockJournal

#: Number of times a block is tried before it is given up.
TRIES = 4
_POLL_S = 0.1
#: Seconds without any worker before the caller gets a notice: a worker that died is usually replaced sooner.
_PATIENCE_S = 5.0


@dataclass(frozen=True)
class Blocks:
    """Size of the blocks of a capture, and layout of its files.

    Parameters
    ----------
    images : int
        Most images of a block.
    layout : str
        One of `choices.LAYOUTS`.
    """

    images: int = IMAGES
    layout: str = FOLDERS


@contextmanager
def opened_blocks(
    plan: Plan,
    source: NamedSource,
    root: Path,
    engine: Engine,
    blocks: Blocks,
    connections: int,
    notice: Callable[[Message], object],
    *,
    resume: bool,
    only_failed: bool,
) -> Iterator[tuple[BlockJournal, BlockMaker]]:
    """Open the journal and the maker of a capture in blocks; other parameters as for `capture`.

    Parameters
    ----------
    connections : int
        Requests under way at once, in all blocks together.
    notice : callable
        As for `Listener`.
    """
    if str(root).startswith("memory:") and not engine.in_process:
        raise InvalidInput(
            "address {0}: is of this process alone, and workers are others: must be a folder, or begin with {1}",
            root,
            "s3://, gs:// or az://",
        )
    with closing(source.open()) as opened:
        check_source(plan, opened)
        with BlockJournal.opened(
            plan, root, blocks.layout, blocks.images, resume=resume, only_failed=only_failed
        ) as journal:
            maker = BlockMaker(source, ImageParts(plan, opened), journal, engine, blocks, connections, notice)
            yield journal, maker


class BlockMaker:
    """Maker that has an engine run blocks: as many at once as there are workers, and as the provider allows.

    Parameters
    ----------
    source : NamedSource
    parts : ImageParts
    journal : BlockJournal
    engine : Engine
    blocks : Blocks
    connections : int
        Requests under way at once, in all blocks together.
    notice : callable
        As for `Listener`.
    """

    def __init__(
        self,
        source: NamedSource,
        parts: ImageParts,
        journal: BlockJournal,
        engine: Engine,
        blocks: Blocks,
        connections: int,
        notice: Callable[[Message], object],
    ) -> None:
        self.parts, self.requests, self.unique_parts = parts, 0, 0
        self._plan, self._source, self._journal = parts.plan, source, journal
        self._engine, self._blocks, self._connections = engine, blocks, connections
        self._notice = notice
        self._name = uuid.uuid4().hex
        self._control = Control(check=journal.check)
        # Workers may have other current folders.
        self._terrain = absolute_terrain(parts.plan.mission.terrain)
        self._labels = absolute_labels(parts.plan.mission.labels)
        root = journal.root
        self._destination = str(root) if is_address(root) else str(root.absolute())
        self._exposures = plan_exposures(parts.plan)
        self._pending: deque[Piece] = deque()
        self._tries: Counter[tuple[str, int]] = Counter()
        self._under_way: dict[Future[BlockResult], tuple[Piece, Fraction]] = {}
        self._workers_gone_s: float | None = None
        self._gone_is_noticed = False
        self._lost_in_a_row = 0

    @property
    def under_way(self) -> int:
        """Number of images made so far in blocks under way."""
        return sum(self._control.made.copy().values())

    @property
    def map_type(self) -> str:
        """Map type of the next block."""
        return self._pending[0].map_type if self._pending else self._plan.mission.imagery.map_types[-1]

    def rounds(self, map_types: tuple[str, ...]) -> Iterable[tuple[str, ...]]:
        """One round of all map types, so that no worker waits for the last block of a map type."""
        return [map_types]

    def prepare(self) -> None:
        """Write the relief for workers in other processes."""
        if not self._engine.in_process:
            write_relief(self._plan, self._journal.root)

    def make(self, pieces: Sequence[Piece], orders: Orders) -> bool:
        """Make blocks; returns False if the run stopped it."""
        self._pending.extend(pieces)
        controls[self._name] = control = self._control
        try:
            while self._pending or self._under_way:
                if not orders.wants_more():
                    return False
                paused = orders.is_paused()
                (control.paused.set if paused else control.paused.clear)()
                if not paused:
                    self._submit()
                if self._under_way:
                    self._take(wait(self._under_way, _POLL_S, FIRST_COMPLETED).done, orders)
                else:
                    time.sleep(_POLL_S)
            return True
        finally:
            control.stopped.set()
            for future in self._under_way:
                future.cancel()
            if self._engine.in_process:
                # Wait for the engine's threads, which use objects that the caller is about to close.
                self._take(wait(self._under_way).done, orders, ended=True)
            del controls[self._name]

    def _submit(self) -> None:
        """Hand blocks to idle workers, within the provider's limits."""
        slots = self._count_slots()
        most = self._source.policy.most_sharers if not self._source.is_local else None
        sharers = slots if most is None else min(slots, most)
        share = Fraction(1, max(sharers, 1))
        while self._pending and len(self._under_way) < sharers:
            # Blocks begun when there were fewer workers have larger shares of the provider's limits.
            if most is not None and sum(one for _, one in self._under_way.values()) + share > 1:
                return
            piece = self._pending.popleft()
            block = self._block(piece, sharers)
            try:
                if self._engine.in_process:
                    future = self._engine.executor.submit(make_block, block)
                else:
                    function, argument = packed_call(block)
                    future = self._engine.executor.submit(function, argument)
            except (RuntimeError, OSError) as wrong:
                raise _broken(wrong) from wrong
            self._under_way[future] = (piece, share)

    def _count_slots(self) -> int:
        """Count the blocks that workers can make at once; notifies the caller after some seconds without workers."""
        try:
            slots = self._engine.slots()
        except (RuntimeError, OSError) as wrong:
            raise _broken(wrong) from wrong
        if slots:
            if self._gone_is_noticed:
                self._notice(Message("workers: {0:,} there: going on", slots))
            self._workers_gone_s, self._gone_is_noticed = None, False
        elif self._workers_gone_s is None:
            self._workers_gone_s = time.monotonic()
        elif not self._gone_is_noticed and time.monotonic() - self._workers_gone_s > _PATIENCE_S:
            self._gone_is_noticed = True
            self._notice(Message("workers: none is there: waiting for one"))
        return slots

    def _block(self, piece: Piece, sharers: int) -> Block:
        connections = max(self._connections // sharers, 1)
        options = replace(self._source.options, connections=connections, sharers=sharers)
        return Block(
            piece.number,
            piece.map_type,
            self._plan.part(piece.indices),
            piece.indices,
            self._source.asked(options),
            self._destination,
            self._terrain,
            self._labels,
            self._blocks.layout,
            None if self._exposures is None else self._exposures.take(piece.indices),
            connections,
            self._engine.workers,
            self._name,
        )

    def _take(self, done: Iterable[Future[BlockResult]], orders: Orders, *, ended: bool = False) -> None:
        """Take the results of blocks, and retry blocks whose worker died or could not write."""
        for future in done:
            piece, _ = self._under_way.pop(future)
            self._control.made.pop(block_name(piece.map_type, piece.number), None)
            wrong = _find_error(future)
            if wrong is None:
                result = future.result()
                self._lost_in_a_row = 0
                self.requests += result.requests
                self.unique_parts += result.unique_parts
                self._note(piece, result.record, orders)
            elif not ended:
                self._retry(piece, wrong, orders)

    def _note(self, piece: Piece, record: Record, orders: Orders) -> None:
        """Note the record of a block that was made or given up."""
        self._journal.take(piece, record)
        orders.repeats(piece.map_type).add(record.noted)
        for outcome in record.outcomes.values():
            orders.note(outcome)

    def _retry(self, piece: Piece, wrong: BaseException, orders: Orders) -> None:
        """Queue a block again or, after `TRIES` tries, give it up; raises errors that end the run."""
        # Ray wraps errors of workers.
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
        reason = Message(wrong) if isinstance(wrong, TerrAInavError) else _describe(wrong)
        name = block_name(piece.map_type, piece.number)
        self._tries[piece.map_type, piece.number] += 1
        if self._tries[piece.map_type, piece.number] < TRIES:
            self._notice(Message("block {0}: {1}: it is begun again", name, reason))
            self._pending.appendleft(piece)
            return
        if isinstance(wrong, OutputError):
            raise wrong
        self._lost_in_a_row += 1
        # If so many blocks fail in a row, the workers are at fault.
        if self._lost_in_a_row > 5:
            raise OutputError(
                "workers: {0} blocks in a row could not be made ({1})",
                self._lost_in_a_row,
                reason,
                remedy=Message("resume it{0} once they are well", OptionName("resume").in_brackets),
            )
        self._note(piece, self._journal.give_up(piece, reason), orders)
        self._notice(Message("block {0}: {1}, {2} times: given up", name, reason, TRIES))


def _find_error(future: Future[BlockResult]) -> BaseException | None:
    """Error that ended a block: of any kind, as sys.exit() on a worker must not end the run."""
    try:
        return future.exception()
    except CancelledError as wrong:
        return wrong


def _describe(wrong: BaseException) -> Message:
    """Describe the error of a worker briefly."""
    kind = type(wrong).__name__
    # Dask and Ray raise these errors if a worker dies.
    if kind in (
        "KilledWorker",
        "CancelledError",
        "FutureCancelledError",
        "CommClosedError",
        "WorkerCrashedError",
    ):
        return Message("its worker died")
    text = str(wrong).partition("\n")[0][:120]
    return Message("{0} on its worker ({1})", kind, text)


def _broken(wrong: BaseException) -> OutputError:
    # Name only the type, as Dask's text is about its connections.
    return OutputError("workers: all are gone ({0})", type(wrong).__name__)
