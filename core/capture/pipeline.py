"""Fetching, assembling and writing at the same time, with a bounded number of pictures on the way."""

from __future__ import annotations

import io
import tempfile
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from queue import Empty, SimpleQueue
from typing import IO, Generic, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from ..arrays import Bytes
from ..errors import Cancelled, PartError, TerrAInavError
from ..external.unexpected import UnexpectedErrors
from ..geodesy.frames import Windows
from ..imagery.source import Part, Window

Job = TypeVar("Job")
Result = TypeVar("Result")
Outcome = TypeVar("Outcome")
#: Longest wait until the caller is asked again whether to go on, seconds.
_POLL_S = 0.05
#: Requests handed to the connections ahead of need, for each: one under way and one that is ready to follow.
_FETCHES_PER_CONNECTION = 2
#: Pictures whose parts are there, for each worker: one being made and seven that are ready to follow, so that workers
#: that are just quick enough never wait while fetching pauses.
_READY_PER_WORKER = 8
#: Pictures on the way in all: they may wait for a part that is slow to come while others go on.
_MOST_ON_THE_WAY = 256
#: Pixels in memory, bytes: a hundred tiles of 256 px, which is what missions of fifty pictures across share from one
#: strip to the next.
MEMORY_BYTES = 20 << 20


def sweep(windows: Windows, chosen: NDArray[np.int64]) -> NDArray[np.int64]:
    """Order in which parts wait for their last picture as briefly as possible.

    Strips across the shorter extent of the chosen pictures, one after the other along the longer: what has to be
    kept is what one strip shares with the next, however long the mission.

    Parameters
    ----------
    windows : Windows
        Of all captures.
    chosen : array (k,) of int64
        Indices of those to be made.

    Returns
    -------
    array (k,) of int64
    """
    if len(chosen) == 0:
        return chosen
    left, top, width, height = (np.asarray(values, np.float64)[chosen] for values in windows)
    along, across, size = left, top, width
    if np.ptp(top) > np.ptp(left):
        along, across, size = top, left, height
    # Camera frames that look to the horizon may stand for no rectangle of the map at all.
    strip = np.floor((along - along.min()) / max(float(size.max()), 1.0))
    return np.asarray(chosen[np.lexsort((along, across, strip))], np.int64)


@dataclass
class _Picture(Generic[Job]):
    """A picture on the way, and how many of its parts are not there yet."""

    job: Job
    parts: Sequence[Part]
    missing: int = 0


@dataclass
class _PartOnTheWay(Generic[Job]):
    """A part that was asked for.

    The pictures that wait for it; then its pixels, the place they are put aside in, or why there are none; and how many
    pictures on the way need it.
    """

    waiting: list[_Picture[Job]] = field(default_factory=list)
    content: Bytes | _Slot | PartError | None = None
    needed: int = 0


class _Gate:
    """What work that was handed to threads waits at: it begins while the gate is open, and never after its end."""

    def __init__(self) -> None:
        self._open = threading.Event()
        self._over = False

    def hold(self, held: bool) -> None:
        """Let work begin, or keep it back."""
        if held:
            self._open.clear()
        else:
            self._open.set()

    def end(self) -> None:
        """Send away what waits, and what still comes."""
        self._over = True
        self._open.set()

    def pass_through(self, work: Callable[..., Outcome], *arguments: object) -> Outcome:
        """Do the work when it may begin; raises Cancelled where it may not any more."""
        self._open.wait()
        if self._over:
            raise Cancelled("not begun: the run was stopped")
        return work(*arguments)


class Pipeline(Generic[Job, Result]):
    """Makes pictures out of parts, each of which is fetched once and dropped after its last picture.

    The calling thread coordinates; parts are fetched on ``connections`` threads, pictures made on ``workers``
    threads. How many parts are in memory depends on those, not on the number of pictures or on how far apart the users
    of a part are: what later pictures need (see `sweep`) is put aside in a `Spool`.

    Parameters
    ----------
    users : Counter of Window
        How many of the pictures need each part; counted down as they are made.
    fetch : callable
        Window to pixels; a PartError fails the pictures that need the part, and so does an error that nobody foresaw
        (see `UnexpectedErrors`); any other `TerrAInavError` stops the run.
    work : callable
        Job, its parts, and their pixels by window, to a result; a PartError is the picture's failure, anything else
        stops the run.
    finished : callable
        Called in the calling thread with each job and its result or PartError, in the order they come.
    connections, workers : int
        At least 1 each.
    at_once : int
        Pictures on the way in all, at least 1: where they are large, few are.
    spool : Spool or None
        Closed with the run; None for one of the usual size.

    Attributes
    ----------
    requests : int
        Calls of ``fetch`` so far.
    """

    def __init__(
        self,
        users: Counter[Window],
        fetch: Callable[[Window], Bytes],
        work: Callable[[Job, Sequence[Part], Mapping[Window, Bytes]], Result],
        finished: Callable[[Job, Result | PartError], None],
        *,
        connections: int,
        workers: int,
        at_once: int = _MOST_ON_THE_WAY,
        spool: Spool | None = None,
    ) -> None:
        self.requests = 0
        self._unexpected = UnexpectedErrors()
        self._users = users
        self._fetch, self._work, self._finished = fetch, work, finished
        self._fetching_limit = connections * _FETCHES_PER_CONNECTION
        self._ready_limit = workers * _READY_PER_WORKER
        self._at_once = min(at_once, _MOST_ON_THE_WAY)
        self._fetching = self._on_the_way = 0
        self._making: dict[Future[Result], Job] = {}
        self._parts: dict[Window, _PartOnTheWay[Job]] = {}
        self._spool = spool or Spool()
        self._events: SimpleQueue[Callable[[], None]] = SimpleQueue()
        self._gate = _Gate()
        self._connections = ThreadPoolExecutor(connections, "terrainav-fetch")
        self._workers = ThreadPoolExecutor(workers, "terrainav-work")

    def run(
        self,
        jobs: Iterable[tuple[Job, Sequence[Part]]],
        go_on: Callable[[], bool],
        paused: Callable[[], bool] = lambda: False,
    ) -> bool:
        """Make the pictures of ``jobs``; once.

        ``go_on`` is asked many times a second. When it says no, or an error stops the run, what waits is dropped,
        what is being made is finished and reported, and requests under way are left to end by themselves. While
        ``paused``, which is asked as often, says yes, no part is asked for and no picture begun.

        Returns
        -------
        bool
            Whether all were made or failed; False where ``go_on`` stopped it.
        """
        waiting = iter(jobs)
        complete = False
        try:
            while not complete:
                if not go_on():
                    return False
                held = paused()
                self._gate.hold(held)
                more = held or self._admit(waiting)
                complete = not more and self._on_the_way == 0
                if not complete:
                    self._handle_event()
            return True
        finally:
            self._gate.end()
            self._connections.shutdown(wait=complete, cancel_futures=True)
            self._workers.shutdown(wait=True, cancel_futures=True)
            self._spool.close()
            self._report_made()

    def _fetched(self, window: Window) -> Bytes:
        """Pixels of a part; an error that nobody foresaw is its failure, and ends no run."""
        try:
            return self._fetch(window)
        except TerrAInavError:
            raise
        except BaseException as wrong:
            # What ends a program, such as sys.exit(), ends no thread of ours either.
            raise self._unexpected.failure(wrong) from wrong

    def _report_made(self) -> None:
        """Report pictures that were finished while the run was being stopped."""
        for making, job in self._making.items():
            if not making.cancelled() and making.exception() is None:
                self._finished(job, making.result())

    def _admit(self, waiting: Iterator[tuple[Job, Sequence[Part]]]) -> bool:
        """Take pictures on as long as there is room; whether there may be more."""
        while (
            self._fetching < self._fetching_limit
            and len(self._making) < self._ready_limit
            and self._on_the_way < self._at_once
        ):
            following = next(waiting, None)
            if following is None:
                return False
            self._take_on(_Picture(*following))
        return True

    def _take_on(self, picture: _Picture[Job]) -> None:
        self._on_the_way += 1
        for window in dict.fromkeys(part.window for part in picture.parts):
            part = self._parts.get(window)
            if part is None:
                part = self._parts[window] = _PartOnTheWay()
                self._ask_for(window)
            self._bring_back(window, part)
            part.needed += 1
            if part.content is None:
                part.waiting.append(picture)
                picture.missing += 1
        if picture.missing == 0:
            self._make(picture)

    def _ask_for(self, window: Window) -> None:
        self.requests += 1
        self._fetching += 1
        request = self._connections.submit(self._gate.pass_through, self._fetched, window)
        request.add_done_callback(lambda done: self._events.put(partial(self._part_arrived, window, done)))

    def _handle_event(self) -> None:
        """Wait shortly for something to happen, and act on it."""
        try:
            event = self._events.get(timeout=_POLL_S)
        except Empty:
            return
        event()

    def _part_arrived(self, window: Window, request: Future[Bytes]) -> None:
        self._fetching -= 1
        part = self._parts[window]
        try:
            part.content = request.result()
        except PartError as wrong:
            part.content = wrong
        for picture in part.waiting:
            picture.missing -= 1
            if picture.missing == 0:
                self._make(picture)
        part.waiting.clear()

    def _put_aside(self, part: _PartOnTheWay[Job]) -> None:
        """Keep a part that only pictures that are not on the way yet will need.

        In the order of a sweep those put aside first are needed first. So they stay in memory, and what comes when
        that is full, and goes to the spool's file, is what is needed last.
        """
        if isinstance(part.content, np.ndarray):
            # A disk that is full costs memory, not pictures.
            with suppress(OSError):
                part.content = self._spool.put(part.content)

    def _bring_back(self, window: Window, part: _PartOnTheWay[Job]) -> None:
        """Have a part at hand that a picture needs again."""
        if isinstance(part.content, _Slot):
            try:
                part.content = self._spool.take(part.content)
            except OSError:
                part.content = None
                self._ask_for(window)

    def _make(self, picture: _Picture[Job]) -> None:
        """Hand a picture whose parts are there to the workers, and drop the parts that it was the last to need."""
        pixels: dict[Window, Bytes] = {}
        failure: PartError | None = None
        for window in dict.fromkeys(part.window for part in picture.parts):
            part = self._parts[window]
            if isinstance(part.content, PartError):
                failure = failure or part.content
            elif isinstance(part.content, np.ndarray):
                pixels[window] = part.content
            part.needed -= 1
            self._users[window] -= 1
            if self._users[window] <= 0:
                del self._users[window], self._parts[window]
            elif part.needed == 0:
                self._put_aside(part)
        if failure is not None:
            self._on_the_way -= 1
            self._finished(picture.job, failure)
            return
        making = self._workers.submit(self._gate.pass_through, self._work, picture.job, picture.parts, pixels)
        self._making[making] = picture.job
        making.add_done_callback(lambda done: self._events.put(partial(self._picture_made, done)))

    def _picture_made(self, making: Future[Result]) -> None:
        job = self._making.pop(making)
        self._on_the_way -= 1
        try:
            result: Result | PartError = making.result()
        except PartError as wrong:
            result = wrong
        self._finished(job, result)


class _Slot(NamedTuple):
    """Where a spool has an array: the array itself, or its place in the file and what it was."""

    held: Bytes | None
    at: int
    shape: tuple[int, ...]
    dtype: str


class Spool:
    """Arrays that wait: the first in memory, those for which there is no room in an anonymous file.

    The file is in the folder for temporary files (TMPDIR, TEMP), made when it is needed, and goes with the process,
    however that ends. The room of an array that was taken is used again for one of the same size, so that the file is
    as large as what it held at most. For one thread at a time.
    """

    def __init__(self, memory_bytes: int = MEMORY_BYTES) -> None:
        self._room_bytes = memory_bytes
        self._file: io.FileIO | None = None
        self._end = 0
        self._free: dict[int, list[int]] = {}

    def put(self, pixels: Bytes) -> _Slot:
        """Keep an array, which must not be changed any more.

        Raises
        ------
        OSError
            Where the disk does not take it; nothing is kept then.
        """
        size = pixels.nbytes
        if size <= self._room_bytes:
            self._room_bytes -= size
            return _Slot(pixels, 0, pixels.shape, pixels.dtype.str)
        free = self._free.get(size)
        at = free[-1] if free else self._end
        self._write(at, np.ascontiguousarray(pixels))
        if free:
            free.pop()
        else:
            self._end += size
        return _Slot(None, at, pixels.shape, pixels.dtype.str)

    def take(self, slot: _Slot) -> Bytes:
        """Return an array and free its room.

        Raises
        ------
        OSError
            Where the disk does not give it back.
        """
        if slot.held is not None:
            self._room_bytes += slot.held.nbytes
            return slot.held
        pixels = np.empty(slot.shape, slot.dtype)
        self._free.setdefault(pixels.nbytes, []).append(slot.at)
        self._read(slot.at, pixels)
        return pixels

    def close(self) -> None:
        """Give the file up, and what it holds."""
        if self._file is not None:
            self._file.close()

    def _write(self, at: int, content: Bytes) -> None:
        if self._file is None:
            # Unbuffered: arrays are large, and what a full disk does not take is known at once.
            file: IO[bytes] = tempfile.TemporaryFile(prefix="terrainav-", buffering=0)  # noqa: SIM115 (see close)
            self._file = cast(io.FileIO, file)
        self._file.seek(at)
        if self._file.write(content.data) != content.nbytes:
            raise OSError("the disk took only a part of an array")

    def _read(self, at: int, pixels: Bytes) -> None:
        if self._file is None:
            raise ValueError("this spool has no file: the slot is of another one")
        self._file.seek(at)
        if self._file.readinto(pixels.data) != pixels.nbytes:
            raise OSError("the disk gave only a part of an array back")
