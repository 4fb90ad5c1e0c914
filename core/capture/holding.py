"""Keep other runs out of a local folder or a folder of an object store."""

from __future__ import annotations

import json
import os
import threading
import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import TracebackType
from typing import IO

from ..errors import InvalidInput, OutputError
from ..limits import MAX_SETTINGS_BYTES
from ..storage.files import lock_tried, open_locked, read_existing, remove_file, write_new, write_whole
from ..storage.stores import is_address, place_kind
from ..waiting import check_cancelled

#: File of the lease in local folders whose file system has no locks.
LEASE_FILE = "run.lease"
#: Seconds between a run's signs of life, and seconds without one after which it counts as dead.
BEAT_S, DEAD_S = 5.0, 30.0


@contextmanager
def locked(path: Path) -> Iterator[Callable[[], None]]:
    """Lock a file against other runs; yields the same as `kept`.

    Raises
    ------
    OutputError
        Another run works in the folder, or took it over before this run ended.
    """
    with open_locked(path) as file, kept(path, file) as check:
        yield check


@contextmanager
def kept(path: Path, file: IO[bytes]) -> Iterator[Callable[[], None]]:
    """Watch a file that `open_locked` has opened; yields a function that raises OutputError if the lock is void.

    The lock is void once the file was replaced or removed. On file systems without locks, a lease replaces it.
    """
    # The current folder may change meanwhile.
    place = path.absolute()
    with ExitStack() as opened:
        lease = None if _is_exclusive(path) else opened.enter_context(Lease(place.with_name(LEASE_FILE)))

        def check() -> None:
            if lease is not None:
                lease.check()
            try:
                is_same = os.path.samestat(os.fstat(file.fileno()), place.stat())
            except OSError:
                is_same = False
            if not is_same:
                raise OutputError(
                    "folder {0}: its {1} was replaced or removed, so that another run may be at work in it",
                    path.parent,
                    path.name,
                )

        yield check
        check()


def _is_exclusive(path: Path) -> bool:
    """Whether a locked file cannot be locked again; on file systems without locks it can."""
    with lock_tried(path) as is_free:
        return not is_free


def _steady_s() -> float:
    """Seconds of a clock that is never set; if the system has such a clock, it also runs while the machine sleeps."""
    clock = getattr(time, "CLOCK_BOOTTIME", None)
    return time.monotonic() if clock is None else time.clock_gettime(clock)


class Lease:
    """An object or file that one run owns, and rewrites at intervals as a sign of life.

    Object stores have no locks, but can put an object only if it does not exist yet. A run that dies leaves its lease
    behind: the next run watches it, and takes it over once it has not changed for longer than a living run allows.
    Clocks of different machines are not compared.

    A run whose machine slept or whose process was suspended notices that its last sign is old. Before it does anything
    else, it checks that it still owns the place.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._token = uuid.uuid4().hex
        self._beats = 0
        self._ended = threading.Event()
        self._lost: OutputError | None = None
        self._signing = threading.Lock()
        # Times of the last sign and of the last attempt, by the steady clock and the wall clock.
        self._signed_s = self._tried_s = self._clocks_s()
        self._thread = threading.Thread(target=self._beat, name="terrainav-lease", daemon=True)

    def __enter__(self) -> Lease:
        if not write_new(self._path, self._content()):
            self._seize()
        self._signed_s = self._tried_s = self._clocks_s()
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        self._thread.join()
        try:
            # Since the last sign, another run may have taken over; or that sign may have overwritten its lease.
            if self._is_own(self._read()):
                remove_file(self._path)
            elif self._lost is None:
                self._lost = self._taken()
        except OutputError:
            if error is None:
                raise
        if error is None:
            self.check()

    def check(self) -> None:
        """Raise OutputError if another run has taken the place, or the lease can no longer be written."""
        if self._since_s(self._signed_s) > 2.0 * BEAT_S and self._since_s(self._tried_s) > BEAT_S:
            self._sign()
        if self._lost is not None:
            raise self._lost

    @staticmethod
    def _clocks_s() -> tuple[float, float]:
        return _steady_s(), time.time()

    def _since_s(self, then_s: tuple[float, float]) -> float:
        """Seconds since a time, by the clock that shows more, as a clock may have stood still or been set back."""
        return max(now - then for now, then in zip(self._clocks_s(), then_s))

    def _read(self) -> bytes | None:
        """Content of the lease, None without one; raises OutputError if it cannot be read or is too long."""
        try:
            return read_existing(self._path, MAX_SETTINGS_BYTES)
        except InvalidInput as wrong:
            raise OutputError("{0}", wrong) from wrong

    def _put(self) -> None:
        write_whole(self._path, self._content())

    def _content(self) -> bytes:
        return json.dumps({"run": self._token, "beat": self._beats}).encode("ascii")

    def _seize(self) -> None:
        found = self._read()
        until_s = time.monotonic() + DEAD_S
        while time.monotonic() < until_s:
            check_cancelled()
            time.sleep(BEAT_S / 5.0)
            now = self._read()
            if now != found and now is not None:
                raise self._busy()
            if now is None:
                if write_new(self._path, self._content()):
                    return
                raise self._busy()
        # If two runs take over at once, the last to write owns the place; the other run notices before it begins.
        self._put()
        time.sleep(BEAT_S / 5.0)
        if self._read() != self._content():
            raise self._busy()

    def _busy(self) -> OutputError:
        place = self._path.parent
        if is_address(place):
            return OutputError("address {0}: another run is at work there", place, remedy="wait until it has ended")
        return OutputError("folder {0}: another run is at work in it", place)

    def _taken(self) -> OutputError:
        return OutputError(
            "{0} {1}: another run has taken over, as this one gave no sign of life for {2:g} s",
            place_kind(self._path),
            self._path.parent,
            DEAD_S,
        )

    def _is_own(self, found: bytes | None) -> bool:
        return found is not None and self._token.encode("ascii") in found

    def _beat(self) -> None:
        while self._lost is None and not self._ended.wait(BEAT_S):
            self._sign()

    def _sign(self) -> None:
        """Give a sign of life, unless another run has taken over."""
        with self._signing:
            if self._lost is not None:
                return
            self._tried_s = self._clocks_s()
            try:
                is_own = self._is_signed()
            except OutputError as wrong:
                # A store may be out of reach for a moment; give up before other runs consider this run dead.
                if _steady_s() - self._signed_s[0] > DEAD_S - BEAT_S:
                    self._lost = wrong
            else:
                if is_own:
                    self._signed_s = self._clocks_s()
                else:
                    self._lost = self._taken()

    def _is_signed(self) -> bool:
        """Write a sign of life; returns False if another run owns the place."""
        while True:
            looked_s = _steady_s()
            found = self._read()
            # The lease is also missing if another run took over and has ended.
            if not self._is_own(found):
                return False
            # If the process stood still meanwhile, the lease may have changed: read it again.
            if _steady_s() - looked_s < BEAT_S:
                break
        self._beats += 1
        self._put()
        # If the process stood still here, it may have overwritten another run's sign.
        return _steady_s() - looked_s < DEAD_S
