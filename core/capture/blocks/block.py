"""A block: captures of a plan as a plain value, which any process makes without sharing anything with others."""

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
from numpy.typing import NDArray

from ...arrays import Numbers
from ...errors import OutputError, PartError
from ...imagery.opening import NamedSource, SourceOptions
from ...imagery.placeholder import Repeats, noted_digests
from ...imagery.source import Source
from ...limits import MAX_RELIEF_BYTES
from ...mission.parts import Terrain
from ...mission.plan import Plan
from ...picture.heights import heights_for, landscape_crs
from ...picture.optics import Exposures
from ...resources import version
from ...storage.files import read_if_there, write_whole
from ...storage.stores import store_path
from ...text.safe_json import parse_json
from ..choices import BLOCKS_FOLDER, FOLDERS, WEBDATASET
from ..journal import FAILED, Outcome
from ..making import Making
from ..records import Made, PictureJob, outcome_of, table_of
from .shards import Gathered

#: Heights of the relief that blocks of other processes see.
RELIEF_FILE = "relief.npy"
#: Digits of blocks' numbers in names of files, and of captures' indices in shards.
_DIGITS, _KEY_DIGITS = 6, 9


@dataclass(frozen=True)
class Block:
    """Captures of one map type, and all that their images are made from.

    Parameters
    ----------
    number : int
    map_type : str
    plan : Plan
        Of these captures alone (`Plan.part`), with the mission and the grid.
    indices : array (n,) of int64
        Of the captures in the whole plan.
    source : NamedSource
        The imagery, which the block's maker opens.
    destination : str
        Folder, from the root on, or address.
    terrain : Terrain
        That of the plan's mission, as its maker finds the heights.
    layout : str
        One of `choices.LAYOUTS`.
    exposures : Exposures or None
        What images' tags say of the camera.
    connections, workers : int
        As for `capture`, of this block alone.
    run : str
        Name of the run, by which a block in the run's own process learns that it is to wait or to end.
    """

    number: int
    map_type: str
    plan: Plan
    indices: Numbers
    source: NamedSource
    destination: str
    terrain: Terrain
    layout: str = FOLDERS
    exposures: Exposures | None = None
    connections: int = 1
    workers: int = 1
    run: str = ""

    @property
    def name(self) -> str:
        """What its files are called, without ending."""
        return block_name(self.map_type, self.number)

    @property
    def shard(self) -> str:
        """File of its images; empty where each has one of its own."""
        return f"{self.name}.tar" if self.layout == WEBDATASET else ""


def block_name(map_type: str, number: int) -> str:
    """Name of a block's files, without ending."""
    return f"{map_type}-{number:0{_DIGITS}d}"


class Record(NamedTuple):
    """What is known of a block that is done: its journal.

    Attributes
    ----------
    outcomes : dict of str to Outcome
        By the image's name.
    shard_bytes : int
        Of the file of its images; 0 where there is none.
    noted : bytes
        Files of a provider and their places, as `Repeats` keeps them.
    """

    outcomes: dict[str, Outcome]
    shard_bytes: int = 0
    noted: bytes = b""

    @property
    def failed(self) -> bool:
        """Whether any of its images has failed."""
        return any(one.status == FAILED for one in self.outcomes.values())

    def is_of(self, map_type: str, names: Sequence[str]) -> bool:
        """Whether it is of a block of these images: of each of them, and of no other."""
        return self.outcomes.keys() == {*names} and all(
            one.map_type == map_type for one in self.outcomes.values()
        )

    def fits(self, shard: str) -> bool:
        """Whether its images that were made are where they may be: each by itself, or apart in a shard."""
        made = [one for one in self.outcomes.values() if one.status != FAILED]
        if any(one.shard != shard for one in made):
            return False
        ends = (
            sorted((one.offset_bytes, one.offset_bytes + one.length_bytes) for one in made) if shard else []
        )
        borders = [0, *(border for pair in ends for border in pair), self.shard_bytes]
        return not ends or borders == sorted(borders)

    def to_bytes(self) -> bytes:
        """Content of its file: one line of JSON for the block, and one for each image."""
        head: dict[str, Any] = {"images": len(self.outcomes), "shard_bytes": self.shard_bytes}
        if self.noted:
            head["noted"] = self.noted.hex()
        lines = [json.dumps(head).encode("ascii") + b"\n"]
        return b"".join(lines + [one.to_line() for one in self.outcomes.values()])

    def commit(self, destination: Path, name: str) -> None:
        """Have the block of a name count as done; raises OutputError."""
        write_whole(destination / BLOCKS_FOLDER / f"{name}.jsonl", self.to_bytes())

    @classmethod
    def from_bytes(cls, data: bytes) -> Record | None:
        """Record of a file's content; None where that is torn."""
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
    """What making a block has come to; its record is where the results are."""

    record: Record
    requests: int
    unique_parts: int


@dataclass
class Control:
    """The say of a run over blocks that are made in its own process, and how many images each has made so far."""

    stopped: threading.Event = field(default_factory=threading.Event)
    held: threading.Event = field(default_factory=threading.Event)
    made: dict[str, int] = field(default_factory=dict)
    #: Raises OutputError where another run has taken the place.
    check: Callable[[], None] = lambda: None


#: Of the runs of this process, by name. Blocks of other processes find none, and go on to their end.
controls: dict[str, Control] = {}


class Stopped(Exception):
    """A block was stopped with its run; nothing of it is committed."""


class _Call:
    """What a pickle is of whose reading makes a block."""

    def __init__(self, data: bytes) -> None:
        self._arguments = data, version(), platform.python_version()

    def __reduce__(self) -> tuple[Callable[..., BlockResult], tuple[bytes, str, str]]:
        return make_packed, self._arguments


def call_of(block: Block) -> tuple[Callable[[bytes], BlockResult], bytes]:
    """Function of Python's own, and what it is to be called with, for another process to make a block.

    So a worker without TerrAInav says what is missing. A function of ours it could not even be told of: Dask's workers
    end of that.
    """
    return ForkingPickler.loads, bytes(ForkingPickler.dumps(_Call(bytes(ForkingPickler.dumps(block)))))


def make_packed(data: bytes, of_version: str, of_python: str) -> BlockResult:
    """Make a block that another process has packed.

    Raises
    ------
    OutputError
        This process has another version of TerrAInav or of Python.
    """
    for what, own, wanted in (
        ("TerrAInav", version(), of_version),
        ("Python", _minor(platform.python_version()), _minor(of_python)),
    ):
        if own != wanted:
            raise WrongWorker(
                "worker on {0}: has {1} {2}, and the run has {3}: both need the same",
                platform.node(),
                what,
                own,
                wanted,
            )
    block: Block = ForkingPickler.loads(data)
    return make_block(block)


class WrongWorker(OutputError):
    """A worker that cannot make blocks of this run."""


def _minor(python: str) -> str:
    return ".".join(python.split(".")[:2])


def make_block(block: Block) -> BlockResult:
    """Make the images of a block and commit it: its record comes last, when all else is where it belongs.

    The same block leaves the same bytes wherever it is made, and as often as it is made.

    Raises
    ------
    SourceError
        The source cannot serve.
    OutputError
        The destination cannot be written.
    Stopped
    """
    control = controls.get(block.run) or Control()
    is_wanted = _asking_engine()

    def go_on() -> bool:
        return not control.stopped.is_set() and is_wanted()

    outcomes: dict[str, Outcome] = {}

    def note(job: PictureJob, result: Made | PartError) -> None:
        outcome = outcomes[job.description.name] = outcome_of(job, result)
        if outcome.status != FAILED:
            control.made[block.name] = control.made.get(block.name, 0) + 1

    def write_checked(path: Path, data: bytes) -> None:
        control.check()
        write_whole(path, data)

    destination = store_path(block.destination)
    gathered = Gathered() if block.layout == WEBDATASET else None
    with closing(block.source.open()) as source:
        plan = _with_heights(block)
        making = Making(
            plan,
            source,
            destination,
            block.connections,
            block.workers,
            note,
            exposures=block.exposures,
            write=write_checked if gathered is None else gathered.write,
        )
        repeats = Repeats(plan.grid)
        complete = making.make(block.map_type, np.arange(len(plan)), go_on, control.held.is_set, repeats.note)
        # What another worker, or another run, may have committed meanwhile is left alone.
        if not (complete and go_on()):
            raise Stopped
        control.check()
        # In the order of the plan, whatever order they were made in.
        done = {name: outcomes[name] for name in plan.names}
        shard_bytes = 0
        if gathered is not None:
            shard_bytes = _write_shard(block, source, plan, gathered, destination, done)
    record = Record(done, shard_bytes, repeats.noted())
    control.check()
    record.commit(destination, block.name)
    return BlockResult(record, making.requests, making.unique_parts)


def _asking_engine() -> Callable[[], bool]:
    """What tells whether the engine still waits for this block: Dask tells its workers where a run has gone."""
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


def _with_heights(block: Block) -> Plan:
    """Plan of a block, whose relief has its heights again where it comes from another process."""
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
    heights = heights_for(block.terrain, asked)
    if heights is not None:
        plan.relief.load(heights, _surface(block.destination, block.run))
    return plan


@lru_cache(maxsize=1)
def _surface(destination: str, _run: str) -> NDArray[Any]:
    """Heights that a run has left for its workers."""
    data = read_if_there(store_path(destination) / BLOCKS_FOLDER / RELIEF_FILE, MAX_RELIEF_BYTES)
    if data is None:
        raise OutputError("{0}: has no {1} any more", destination, RELIEF_FILE)
    try:
        return _array_of(data)
    except ValueError as wrong:
        raise OutputError("{0}: {1} cannot be read ({2})", destination, RELIEF_FILE, wrong) from wrong


def _array_of(data: bytes) -> NDArray[Any]:
    """Heights of a file of numpy's, whose header may ask for more than there is; raises ValueError."""
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
    """Leave the heights of a plan's relief for workers, which need them all for each block."""
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
    """Write the images of a block in one file, and enter where each is; returns the file's bytes."""
    made = {name: one for name, one in outcomes.items() if one.status != FAILED}
    keys = {name: f"{index:0{_KEY_DIGITS}d}" for name, index in zip(plan.names, block.indices.tolist())}
    table = table_of(plan, source, made)
    data, members = gathered.packed(block.map_type, keys, table, plan.mission.output.products)
    write_whole(destination / block.map_type / block.shard, data)
    for name, member in members.items():
        outcomes[name] = replace(
            made[name],
            shard=block.shard,
            offset_bytes=member.offset_bytes,
            length_bytes=member.length_bytes,
        )
    return len(data)
