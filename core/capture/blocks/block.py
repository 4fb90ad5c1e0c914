"""A block: captures of a plan as a plain value, whose images any process can make."""

from __future__ import annotations

import io
import json
import math
import platform
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from functools import lru_cache
from multiprocessing.reduction import ForkingPickler
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...arrays import NDArray, Numbers
from ...errors import OutputError
from ...imagery.opening import NamedSource, SourceOptions
from ...imagery.placeholder import Repeats, noted_digests
from ...imagery.source import Source
from ...limits import MAX_RELIEF_BYTES
from ...mission.parts import PixelLabels, Terrain
from ...mission.plan import Plan
from ...picture.camera_frame import load_code
from ...picture.heights import landscape_crs, terrain_heights
from ...picture.optics import Exposures
from ...picture.shot import lens_plans
from ...resources import version
from ...storage.files import read_existing, write_whole
from ...storage.stores import store_path
from ...text.safe_json import parse_json
from ..choices import BLOCKS_FOLDER, FOLDERS, WEBDATASET
from ..journal import FAILED, Outcome
from ..labels import open_labels
from ..making import ImageMaker, ImageParts, Piece
from ..records import image_table
from .shards import Gathered

#: File of the relief's heights, for workers in other processes.
RELIEF_FILE = "relief.npy"


@dataclass(frozen=True)
class Block:
    """Captures of one map type, with everything that is needed to make their images.

    Parameters
    ----------
    number : int
    map_type : str
    plan : Plan
        Plan of these captures only (see `Plan.part`).
    indices : array (n,) of int64
        Indices of the captures in the whole plan.
    source : NamedSource
        Source of the imagery, which the block's maker opens.
    destination : str
        Absolute path or address of a folder.
    terrain : Terrain
        Terrain of the mission, with absolute paths.
    labels : PixelLabels
        Labels of the mission, with absolute paths.
    layout : str
        One of `choices.LAYOUTS`.
    exposures : Exposures or None
        Exposures for the images' tags.
    connections, workers : int
        As for `capture`, but for this block only.
    run : str
        Name of the run, which is the key of its `Control` in the same process.
    """

    number: int
    map_type: str
    plan: Plan
    indices: Numbers
    source: NamedSource
    destination: str
    terrain: Terrain
    labels: PixelLabels
    layout: str = FOLDERS
    exposures: Exposures | None = None
    connections: int = 1
    workers: int = 1
    run: str = ""

    @property
    def name(self) -> str:
        """Name of the block's files, without ending."""
        return block_name(self.map_type, self.number)


def block_name(map_type: str, number: int) -> str:
    """Name of a block's files, without ending."""
    return f"{map_type}-{number:06d}"


def shard_name(map_type: str, number: int) -> str:
    """Name of the file that holds the images of a block."""
    return f"{block_name(map_type, number)}.tar"


class Record(NamedTuple):
    """Record of a block that is done.

    Attributes
    ----------
    outcomes : dict of str to Outcome
        Outcomes by image name.
    shard_bytes : int
        Size of the block's shard in bytes; 0 for images in separate files.
    noted : bytes
        Digests of the files that a provider sent, and their places, as packed by `Repeats`.
    """

    outcomes: dict[str, Outcome]
    shard_bytes: int = 0
    noted: bytes = b""

    @property
    def failed(self) -> bool:
        """Whether any image has failed."""
        return any(one.status == FAILED for one in self.outcomes.values())

    def matches(self, map_type: str, names: Sequence[str]) -> bool:
        """Whether the record has exactly the images of these names and this map type."""
        return self.outcomes.keys() == {*names} and all(one.map_type == map_type for one in self.outcomes.values())

    def fits(self, shard: str) -> bool:
        """Whether the images are in a shard without overlap or, if ``shard`` is empty, in separate files."""
        made = [one for one in self.outcomes.values() if one.status != FAILED]
        if any(one.shard != shard for one in made):
            return False
        ends = sorted((one.offset_bytes, one.offset_bytes + one.length_bytes) for one in made) if shard else []
        borders = [0, *(border for pair in ends for border in pair), self.shard_bytes]
        return not ends or borders == sorted(borders)

    def to_bytes(self) -> bytes:
        """Content of the record's file: a line of JSON for the block, then a line for each image."""
        head: dict[str, Any] = {"images": len(self.outcomes), "shard_bytes": self.shard_bytes}
        if self.noted:
            head["noted"] = self.noted.hex()
        lines = [json.dumps(head).encode("ascii") + b"\n"]
        return b"".join(lines + [one.to_line() for one in self.outcomes.values()])

    def commit(self, destination: Path, name: str) -> None:
        """Write the record of the named block, which makes the block count as done; raises OutputError."""
        write_whole(destination / BLOCKS_FOLDER / f"{name}.jsonl", self.to_bytes())

    @classmethod
    def from_bytes(cls, data: bytes) -> Record | None:
        """Parse a file's content; None if it is torn."""
        first, *lines = data.splitlines(keepends=True) or [b""]
        outcomes = [Outcome.from_line(line) for line in lines]
        try:
            head = parse_json(first)
            shard_bytes, noted = int(head["shard_bytes"]), bytes.fromhex(head.get("noted", ""))
            noted_digests(noted)
            if head["images"] != len(outcomes) or not data.endswith(b"\n"):
                return None
        except (ValueError, KeyError, TypeError, AttributeError, OverflowError):
            return None
        known = {one.name: one for one in outcomes if one is not None}
        return cls(known, shard_bytes, noted) if len(known) == len(lines) else None


class BlockResult(NamedTuple):
    """Result of making a block, whose record was committed beside the images."""

    record: Record
    requests: int
    unique_parts: int


@dataclass
class Control:
    """Control of a run over the blocks made in its process.

    Attributes
    ----------
    stopped, paused : Event
    made : dict of str to int
        Number of images made so far in each block under way.
    check : callable
        Raises OutputError if another run has claimed the folder.
    """

    stopped: threading.Event = field(default_factory=threading.Event)
    paused: threading.Event = field(default_factory=threading.Event)
    made: dict[str, int] = field(default_factory=dict)
    check: Callable[[], None] = lambda: None


#: Controls of the runs in this process, by name. Blocks in other processes have none and run to their end.
controls: dict[str, Control] = {}


class Stopped(Exception):
    """A block was stopped together with its run, and not committed."""


class _BlockOrders:
    """Stop and pause for the images of a block, from its run if that is in this process; collects their outcomes."""

    def __init__(self, block: Block, plan: Plan, control: Control) -> None:
        self._control, self._name = control, block.name
        self._is_wanted = _engine_check()
        self._repeats = Repeats(plan.grid)
        self.outcomes: dict[str, Outcome] = {}

    def wants_more(self) -> bool:
        return not self._control.stopped.is_set() and self._is_wanted()

    def is_paused(self) -> bool:
        return self._control.paused.is_set()

    def note(self, outcome: Outcome) -> None:
        self.outcomes[outcome.name] = outcome
        if outcome.status != FAILED:
            self._control.made[self._name] = self._control.made.get(self._name, 0) + 1

    def repeats(self, _: str) -> Repeats:
        return self._repeats


class _Call:
    """Object whose unpickling makes a block."""

    def __init__(self, data: bytes) -> None:
        self._arguments = data, version(), platform.python_version()

    def __reduce__(self) -> tuple[Callable[..., BlockResult], tuple[bytes, str, str]]:
        return make_packed, self._arguments


def packed_call(block: Block) -> tuple[Callable[[bytes], BlockResult], bytes]:
    """Return a function of Python's library and its argument; calling it in another process makes the block.

    As every worker has the function, a worker without TerrAInav can report what is missing; Dask's workers die if they
    cannot unpickle a function.
    """
    return ForkingPickler.loads, bytes(ForkingPickler.dumps(_Call(bytes(ForkingPickler.dumps(block)))))


def make_packed(data: bytes, of_version: str, of_python: str) -> BlockResult:
    """Make a block that another process has packed.

    Raises
    ------
    OutputError
        This process has another version of TerrAInav or of Python.
    """
    for what, found, wanted in (
        ("TerrAInav", version(), of_version),
        ("Python", _minor(platform.python_version()), _minor(of_python)),
    ):
        if found != wanted:
            raise WrongWorker(
                "worker on {0}: has {1} {2}, and the run has {3}: both need the same",
                platform.node(),
                what,
                found,
                wanted,
            )
    block: Block = ForkingPickler.loads(data)
    return make_block(block)


class WrongWorker(OutputError):
    """The worker has another version of TerrAInav or Python than the run."""


def _minor(python: str) -> str:
    return ".".join(python.split(".")[:2])


def make_block(block: Block) -> BlockResult:
    """Make the images of a block and commit it by writing its record last.

    A block gives the same bytes on every machine and every time.

    Raises
    ------
    SourceError
        The source fails.
    OutputError
        The destination cannot be written.
    Stopped
    """
    control = controls.get(block.run) or Control()

    def write_checked(path: Path, data: bytes) -> None:
        control.check()
        write_whole(path, data)

    destination = store_path(block.destination)
    gathered = Gathered() if block.layout == WEBDATASET else None
    with closing(block.source.open()) as source:
        plan = _restore_heights(block)
        load_code(plan)
        maker = ImageMaker(
            ImageParts(plan, source),
            destination,
            block.connections,
            block.workers,
            block.exposures,
            write_checked if gathered is None else gathered.write,
            open_labels(plan, block.labels),
        )
        orders = _BlockOrders(block, plan, control)
        complete = maker.make([Piece(block.map_type, np.arange(len(plan)))], orders)
        # Stopped, or no longer wanted by Dask: another worker may have committed the block.
        if not (complete and orders.wants_more()):
            raise Stopped
        # Raises if another run has claimed the folder.
        control.check()
        # In the plan's order rather than the order of making.
        outcomes = {name: orders.outcomes[name] for name in plan.names}
        shard_bytes = 0
        if gathered is not None:
            shard_bytes = _write_shard(block, source, plan, gathered, destination, outcomes)
    record = Record(outcomes, shard_bytes, orders.repeats(block.map_type).noted())
    control.check()
    record.commit(destination, block.name)
    return BlockResult(record, maker.requests, maker.unique_parts)


def _engine_check() -> Callable[[], bool]:
    """Return a function that reports whether the engine still waits for this block; only Dask's workers know."""
    distributed = sys.modules.get("distributed")
    try:
        worker = distributed and distributed.get_worker()
        key = worker and worker.get_current_task()
    except ValueError:
        worker = None
    if not worker:
        return lambda: True

    def is_wanted() -> bool:
        task = worker.state.tasks.get(key)
        is_ending = worker.status.name in ("closing", "closed", "failed")
        return task is not None and task.state != "cancelled" and not is_ending

    return is_wanted


def _restore_heights(block: Block) -> Plan:
    """Return the plan of a block. The heights of its relief are not pickled: read them from the destination."""
    plan, options = block.plan, block.source.options
    if plan.relief.is_loaded:
        return plan
    asked = SourceOptions(
        seed=plan.mission.imagery.seed,
        crs=landscape_crs(plan.mission.imagery.source, plan.mission.imagery.crs),
        connections=options.connections,
        cache=options.cache,
        named_by_user=options.named_by_user,
        sharers=options.sharers,
    )
    heights = terrain_heights(block.terrain, asked)
    if heights is not None:
        for one in lens_plans(plan):
            one.relief.load(heights, _surface(block.destination, block.run))
    return plan


@lru_cache(maxsize=1)
def _surface(destination: str, _run: str) -> NDArray[Any]:
    """Read the heights that a run wrote for its workers; ``_run`` is only part of the cache's key."""
    data = read_existing(store_path(destination) / BLOCKS_FOLDER / RELIEF_FILE, MAX_RELIEF_BYTES)
    if data is None:
        raise OutputError("{0}: has no {1} any more", destination, RELIEF_FILE)
    try:
        return _read_heights(data)
    except ValueError as wrong:
        raise OutputError("{0}: {1} cannot be read ({2})", destination, RELIEF_FILE, wrong) from wrong


def _read_heights(data: bytes) -> NDArray[Any]:
    """Read heights in numpy's format; raises ValueError if kind or size are wrong."""
    file = io.BytesIO(data)
    numpy_format: Any = np.lib.format
    if numpy_format.read_magic(file) != (1, 0):
        raise ValueError("it is of another version of numpy's format")
    shape, in_columns, dtype = numpy_format.read_array_header_1_0(file)
    if dtype.kind != "f" or len(shape) != 2:
        raise ValueError("it holds no heights")
    if math.prod(shape) * dtype.itemsize != len(data) - file.tell():
        raise ValueError("it is cut short, or has more than it says")
    heights_m: NDArray[Any] = np.frombuffer(data, dtype, offset=file.tell()).reshape(
        shape, order="F" if in_columns else "C"
    )
    return heights_m


def write_relief(plan: Plan, destination: Path) -> None:
    """Write all heights of a plan's relief for workers, as each block needs the whole relief."""
    if not plan.relief.is_level:
        data = io.BytesIO()
        np.save(data, plan.relief.heights_m, allow_pickle=False)
        write_whole(destination / BLOCKS_FOLDER / RELIEF_FILE, data.getvalue())


def _write_shard(
    block: Block,
    source: Source,
    plan: Plan,
    gathered: Gathered,
    destination: Path,
    outcomes: dict[str, Outcome],
) -> int:
    """Write the images of a block into one file and note their positions in outcomes; returns the size in bytes."""
    made = {name: one for name, one in outcomes.items() if one.status != FAILED}
    keys = {name: f"{index:09d}" for name, index in zip(plan.names, block.indices.tolist())}
    table = image_table(plan, source, made)
    data, members = gathered.packed(block.map_type, keys, table, plan.mission.products)
    shard = shard_name(block.map_type, block.number)
    write_whole(destination / block.map_type / shard, data)
    for name, member in members.items():
        outcomes[name] = replace(
            made[name],
            shard=shard,
            offset_bytes=member.offset_bytes,
            length_bytes=member.length_bytes,
        )
    return len(data)
