"""Fetch, assemble and write images at the same time, with a bounded number under way."""

from __future__ import annotations

import io
import math
import tempfile
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from heapq import heappop, heappush
from queue import Empty, SimpleQueue
from typing import IO, Generic, NamedTuple, TypeVar, Union, cast

import numpy as np

from ..arrays import Bytes, NDArray
from ..errors import Cancelled, PartError, TerrAInavError
from ..external.unexpected import UnexpectedErrors
from ..geodesy.frames import Windows
from ..imagery.source import Part, Window
from ..waiting import cancellable

Job = TypeVar("Job")
Result = TypeVar("Result")
Outcome = TypeVar("Outcome")
#: Parts of an image, or a function that finds them, for a worker.
Parts = Union[Sequence[Part], Callable[[], Sequence[Part]]]
#: Longest time between two calls of ``go_on``, seconds.
_POLL_S = 0.05
#: Requests handed out for each connection: one under way and one ready to follow.
_FETCHES_PER_CONNECTION = 2
#: Images with all parts for each worker: one being made and seven ready to follow, so that workers have work while
#: fetching pauses.
_READY_PER_WORKER = 8
#: Images whose parts are found at once for each worker: one under way and one ready to follow.
_FOUND_PER_WORKER = 2
#: Most images under way at once: while some wait for a slow part, others continue.
_MOST_UNDER_WAY = 256
#: Bytes of pixels kept in memory: a hundred tiles of 256 px, which missions fifty images wide share from one strip to
#: the next.
MEMORY_BYTES = 20 << 20


def sweep(windows: Windows, chosen: NDArray[np.int64]) -> NDArray[np.int64]:
    """Order captures so that each part waits as briefly as possible for the last image that needs it.

    Strips across the shorter extent of the chosen captures follow each other along the longer extent. However long the
    mission, only parts that one strip shares with the next have to be kept.

    Parameters
    ----------
    windows : Windows
        Windows of all captures.
    chosen : array (k,) of int64
        Indices of the captures to make.

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
    # Camera frames that look to the horizon may have no rectangle on the map.
    strip = np.floor((along - along.min()) / max(float(size.max()), 1.0))
    return np.asarray(chosen[np.lexsort((along, across, strip))], np.int64)


@dataclass
class _Picture(Generic[Job]):
    """An image under way, and how many of its parts are still missing."""

    job: Job
    parts: Sequence[Part]
    missing: int = 0


@dataclass
class _RequestedPart(Generic[Job]):
    """A part that was requested.

    Attributes
    ----------
    waiting : list of _Picture
        Images that wait for the part.
    content : array, _Slot, PartError or None
        Pixels, their slot in the spool, or the error; None until it arrives.
    needed : int
        Number of images under way that need the part.
    last_user : int
        Number of the last image that may need the part.
    """

    last_user: int

    waiting: list[_Picture[Job]] = field(default_factory=list)
    content: Bytes | _Slot | PartError | None = None
    needed: int = 0


class _Gate:
    """Gate for work handed to threads: work begins only while the gate is open, and is cancelled by `end`."""

    def __init__(self) -> None:
        self._open = threading.Event()
        self._over = False

    def hold(self, held: bool) -> None:
        """Close the gate if ``held``, else open it."""
        if held:
            self._open.clear()
        else:
            self._open.set()

    def end(self) -> None:
        """Cancel waiting and later work, and work under way where it can be."""
        self._over = True
        self._open.set()

    def pass_through(self, work: Callable[..., Outcome], *arguments: object) -> Outcome:
        """Do the work once the gate is open; raises Cancelled after `end`, also from within work that can stop."""
        self._open.wait()
        if self._over:
            raise Cancelled("not begun: the run was stopped")
        with cancellable(lambda: self._over):
            return work(*arguments)


class Pipeline(Generic[Job, Result]):
    """Makes images from parts, each of which is fetched once and dropped after its last image.

    The calling thread coordinates; parts are fetched on ``connections`` threads, images made on ``workers`` threads.
    The number of parts in memory depends only on these two numbers: parts for later images are kept in a `Spool`.

    Parameters
    ----------
    last_user : callable
        Returns the number, in the order of the jobs, of the last image that may need a window. A part that an image
        needs later all the same is fetched again.
    fetch : callable
        Returns the pixels of a window. A PartError or an unexpected error (see `UnexpectedErrors`) fails the images
        that need the part; any other `TerrAInavError` stops the run.
    work : callable
        Called with a job, its parts, and their pixels by window; returns the result. A PartError fails the image; any
        other error stops the run.
    finished : callable
        Called in the calling thread with each job and its result or PartError, as they complete.
    connections, workers : int
        At least 1 each.
    at_once : int
        Most images under way, at least 1; choose few for large images.
    spool : Spool or None
        Spool, closed at the end of the run; None for a spool of the default size.

    Attributes
    ----------
    requests, unique_parts : int
        Calls of ``fetch``, and different parts needed, so far.
    """

    def __init__(
        self,
        last_user: Callable[[Window], int],
        fetch: Callable[[Window], Bytes],
        work: Callable[[Job, Sequence[Part], Mapping[Window, Bytes]], Result],
        finished: Callable[[Job, Result | PartError], None],
        *,
        connections: int,
        workers: int,
        at_once: int = _MOST_UNDER_WAY,
        spool: Spool | None = None,
    ) -> None:
        self.requests = self.unique_parts = 0
        self._unexpected = UnexpectedErrors()
        self._last_user = last_user
        self._fetch, self._work, self._finished = fetch, work, finished
        self._fetching_limit = connections * _FETCHES_PER_CONNECTION
        self._ready_limit = workers * _READY_PER_WORKER
        self._finding_limit = workers * _FOUND_PER_WORKER
        self._at_once = min(at_once, _MOST_UNDER_WAY)
        self._fetching = self._under_way = self._begun = 0
        # Images whose parts are being found, in the order of the jobs.
        self._finding: deque[tuple[Job, Future[Sequence[Part]]]] = deque()
        self._making: dict[Future[Result], Job] = {}
        self._parts: dict[Window, _RequestedPart[Job]] = {}
        # Parts put aside, by the last image that may need them.
        self._aside: list[tuple[int, Window]] = []
        self._spool = spool or Spool()
        self._events: SimpleQueue[Callable[[], None]] = SimpleQueue()
        self._gate = _Gate()
        self._connections = ThreadPoolExecutor(connections, "terrainav-fetch")
        self._workers = ThreadPoolExecutor(workers, "terrainav-work")

    def run(
        self,
        jobs: Iterable[tuple[Job, Parts]],
        go_on: Callable[[], bool],
        paused: Callable[[], bool] = lambda: False,
    ) -> bool:
        """Make the images of ``jobs``, each with its parts or a function that finds them; to be called only once.

        ``go_on`` is called many times a second. Once it returns False, or an error stops the run, waiting images are
        dropped, images being made are finished and reported unless they check whether they are cancelled, and requests
        under way are left to end. ``paused`` is called as often; while it returns True, no part is requested and no
        image begun.

        Returns
        -------
        bool
            Whether all images were made or failed; False if ``go_on`` stopped the run.
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
                complete = not more and self._under_way == 0
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
        """Fetch the pixels of a part; an unexpected error fails the part and does not end the run."""
        try:
            return self._fetch(window)
        except TerrAInavError:
            raise
        except BaseException as wrong:
            # BaseException includes sys.exit() in a thread.
            raise self._unexpected.failure(wrong) from wrong

    def _report_made(self) -> None:
        """Report images finished while the run was stopping."""
        for making, job in self._making.items():
            if not making.cancelled() and making.exception() is None:
                self._finished(job, making.result())

    def _admit(self, waiting: Iterator[tuple[Job, Parts]]) -> bool:
        """Begin images while there is room; returns whether there may be more."""
        while (
            self._fetching < self._fetching_limit
            and len(self._making) < self._ready_limit
            and len(self._finding) < self._finding_limit
            and self._under_way < self._at_once
        ):
            following = next(waiting, None)
            if following is None:
                return False
            job, parts = following
            self._under_way += 1
            if callable(parts):
                finding = self._workers.submit(self._gate.pass_through, parts)
                self._finding.append((job, finding))
                finding.add_done_callback(lambda _: self._events.put(self._begin_found))
            else:
                self._begin(_Picture(job, parts))
        return True

    def _begin_found(self) -> None:
        """Begin the images whose parts have been found, in the order of the jobs."""
        while self._finding and self._finding[0][1].done():
            job, finding = self._finding.popleft()
            self._begin(_Picture(job, finding.result()))

    def _begin(self, picture: _Picture[Job]) -> None:
        for window in dict.fromkeys(part.window for part in picture.parts):
            part = self._parts.get(window)
            if part is None:
                part = self._parts[window] = _RequestedPart(self._last_user(window))
                self.unique_parts += 1
                self._request(window)
            self._bring_back(window, part)
            part.needed += 1
            if part.content is None:
                part.waiting.append(picture)
                picture.missing += 1
        self._begun += 1
        self._drop_unneeded()
        if picture.missing == 0:
            self._make(picture)

    def _drop_unneeded(self) -> None:
        """Drop parts put aside that no image needed after all."""
        while self._aside and self._aside[0][0] < self._begun:
            _, window = heappop(self._aside)
            part = self._parts.get(window)
            if part is not None and part.needed == 0:
                if isinstance(part.content, _Slot):
                    self._spool.free(part.content)
                del self._parts[window]

    def _request(self, window: Window) -> None:
        self.requests += 1
        self._fetching += 1
        request = self._connections.submit(self._gate.pass_through, self._fetched, window)
        request.add_done_callback(lambda done: self._events.put(partial(self._part_arrived, window, done)))

    def _handle_event(self) -> None:
        """Wait briefly for an event, and handle it."""
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

    def _put_aside(self, part: _RequestedPart[Job]) -> None:
        """Keep a part for images that are not under way yet.

        In the order of `sweep`, parts put aside first are needed first, so they stay in memory, and later parts go into
        the spool's file.
        """
        if isinstance(part.content, np.ndarray):
            # If the disk is full, the part stays in memory.
            with suppress(OSError):
                part.content = self._spool.put(part.content)

    def _bring_back(self, window: Window, part: _RequestedPart[Job]) -> None:
        """Take a part out of the spool, as an image needs it again."""
        if isinstance(part.content, _Slot):
            try:
                part.content = self._spool.take(part.content)
            except OSError:
                part.content = None
                self._request(window)

    def _make(self, picture: _Picture[Job]) -> None:
        """Hand an image with all its parts to the workers, and drop parts that no other image needs."""
        pixels: dict[Window, Bytes] = {}
        failure: PartError | None = None
        for window in dict.fromkeys(part.window for part in picture.parts):
            part = self._parts[window]
            if isinstance(part.content, PartError):
                failure = failure or part.content
            elif isinstance(part.content, np.ndarray):
                pixels[window] = part.content
            part.needed -= 1
            if part.needed > 0:
                continue
            if part.last_user < self._begun:
                del self._parts[window]
            else:
                self._put_aside(part)
                heappush(self._aside, (part.last_user, window))
        if failure is not None:
            self._under_way -= 1
            self._finished(picture.job, failure)
            return
        making = self._workers.submit(self._gate.pass_through, self._work, picture.job, picture.parts, pixels)
        self._making[making] = picture.job
        making.add_done_callback(lambda done: self._events.put(partial(self._picture_made, done)))

    def _picture_made(self, making: Future[Result]) -> None:
        job = self._making.pop(making)
        self._under_way -= 1
        try:
            result: Result | PartError = making.result()
        except PartError as wrong:
            result = wrong
        self._finished(job, result)


class _Slot(NamedTuple):
    """Slot of a spool: an array, or its offset in the file, shape and type."""

    held: Bytes | None
    at: int
    shape: tuple[int, ...]
    dtype: str


class Spool:
    """Arrays kept for later: in memory while there is room, then in an anonymous file.

    The file is made when needed, in the folder for temporary files (TMPDIR, TEMP), and disappears with the process. The
    space of a taken array is reused for arrays of the same size. A spool is for one thread at a time.
    """

    def __init__(self, memory_bytes: int = MEMORY_BYTES) -> None:
        self._room_bytes = memory_bytes
        self._file: io.FileIO | None = None
        self._end = 0
        self._free: dict[int, list[int]] = {}

    def put(self, pixels: Bytes) -> _Slot:
        """Keep an array, which must not be changed afterwards.

        Raises
        ------
        OSError
            The disk does not take the array; it is then not kept.
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
        """Return an array and free its space.

        Raises
        ------
        OSError
            The array cannot be read from the disk.
        """
        self.free(slot)
        if slot.held is not None:
            return slot.held
        pixels = np.empty(slot.shape, slot.dtype)
        self._read(slot.at, pixels)
        return pixels

    def free(self, slot: _Slot) -> None:
        """Free the space of an array."""
        if slot.held is not None:
            self._room_bytes += slot.held.nbytes
        else:
            size = math.prod(slot.shape) * np.dtype(slot.dtype).itemsize
            self._free.setdefault(size, []).append(slot.at)

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            self._file.close()

    def _write(self, at: int, content: Bytes) -> None:
        if self._file is None:
            # Unbuffered: arrays are large, and a full disk is noticed at once.
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
