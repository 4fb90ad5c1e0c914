"""A folder, or an object store's, held by one run against others."""

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

from ..dataset.folder import JOURNAL_FILE
from ..errors import InvalidInput, Message, OutputError
from ..limits import MAX_SETTINGS_BYTES
from ..storage.files import lock_tried, open_locked, open_own, read_if_there, write_whole
from ..storage.stores import is_address, put, put_new, remove
from ..waiting import check_cancelled
from .folder import LOCK_FILE

#: What it has in a folder, where the file system has no locks.
LEASE_FILE = "run.lease"
#: Seconds between a run's signs of life, and after how many without one it counts as dead.
BEAT_S, DEAD_S = 5.0, 30.0


@contextmanager
def held(root: Path) -> Iterator[Callable[[], None]]:
    """Hold a place against other runs meanwhile; yields what raises OutputError where another has taken it.

    Raises
    ------
    OutputError
        Another run is at work there, or has taken the place before this one came to its end.
    """
    if not is_address(root):
        with open_locked(root / JOURNAL_FILE) as file, kept(root / JOURNAL_FILE, file) as check:
            yield check
        return
    with _Lease(root / LOCK_FILE) as lease:
        yield lease.check


@contextmanager
def kept(path: Path, file: IO[bytes]) -> Iterator[Callable[[], None]]:
    """Watch over a file that `open_locked` has opened: yields what raises OutputError where its lock holds nobody off.

    So it is where the file was replaced or removed meanwhile. File systems without locks have a lease in their place.
    """
    # The current folder may become another one meanwhile.
    place = path.absolute()
    with ExitStack() as opened:
        lease = None if _is_exclusive(path) else opened.enter_context(_Lease(place.with_name(LEASE_FILE)))

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
    """Whether a file that is locked cannot be locked once more, as where a file system has locks."""
    with lock_tried(path) as is_free:
        return not is_free


def _steady_s() -> float:
    """Seconds of a clock that nobody sets, and which goes on while the machine sleeps, where there is such a one."""
    clock = getattr(time, "CLOCK_BOOTTIME", None)
    return time.monotonic() if clock is None else time.clock_gettime(clock)


class _Lease:
    """An object or file that only one run has, and which it changes as a sign that it is alive.

    Object stores have no locks, but put an object only if there is none. A run that dies leaves its own: who finds one
    watches it, and takes it over where it does not change for longer than a run that is alive would let it be. Nothing
    depends on clocks of different machines.

    A run that stood still, as its machine slept or its process was stopped, finds that its last sign is long past, and
    looks whether the place is still its own before it does anything else.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._token = uuid.uuid4().hex
        self._beats = 0
        self._ended = threading.Event()
        self._lost: OutputError | None = None
        #: Held by the thread that gives a sign.
        self._signing = threading.Lock()
        #: When a sign was given, and when it was tried, by the steady clock and by that of the wall.
        self._signed_s = self._tried_s = self._clocks_s()
        self._thread = threading.Thread(target=self._beat, name="terrainav-lease", daemon=True)

    def __enter__(self) -> _Lease:
        if not self._put_new():
            self._take_over()
        self._signed_s = self._tried_s = self._clocks_s()
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        self._thread.join()
        try:
            # Another run may have taken over since the last sign, or this one's last sign may stand in place of its.
            if self._is_own(self._read()):
                self._remove()
            elif self._lost is None:
                self._lost = self._taken()
        except OutputError:
            if error is None:
                raise
        if error is None:
            self.check()

    def check(self) -> None:
        """Raise OutputError where another run has taken the place, or it can be written no more."""
        if self._since_s(self._signed_s) > 2.0 * BEAT_S and self._since_s(self._tried_s) > BEAT_S:
            self._sign()
        if self._lost is not None:
            raise self._lost

    @staticmethod
    def _clocks_s() -> tuple[float, float]:
        return _steady_s(), time.time()

    def _since_s(self, then_s: tuple[float, float]) -> float:
        """Seconds since then by the clock that says more: one may have stood still, or was set back."""
        return max(now - then for now, then in zip(self._clocks_s(), then_s))

    def _put_new(self) -> bool:
        if is_address(self._path):
            return put_new(self._path, self._content())
        try:
            with open_own(self._path, "xb") as file:
                file.write(self._content())
        except FileExistsError:
            return False
        except OSError as wrong:
            raise OutputError(
                "folder {0}: cannot write {1} ({2})", self._path.parent, self._path.name, wrong.strerror
            ) from wrong
        return True

    def _read(self) -> bytes | None:
        """What is there, None for nothing; raises OutputError, also where it is too long to be any run's."""
        try:
            return read_if_there(self._path, MAX_SETTINGS_BYTES)
        except InvalidInput as wrong:
            raise OutputError("{0}", wrong) from wrong

    def _put(self) -> None:
        if is_address(self._path):
            put(self._path, self._content())
        else:
            write_whole(self._path, self._content())

    def _remove(self) -> None:
        if is_address(self._path):
            remove(self._path)
        else:
            self._path.unlink(missing_ok=True)

    def _content(self) -> bytes:
        return json.dumps({"run": self._token, "beat": self._beats}).encode("ascii")

    def _take_over(self) -> None:
        found = self._read()
        until_s = time.monotonic() + DEAD_S
        while time.monotonic() < until_s:
            check_cancelled()
            time.sleep(BEAT_S / 5.0)
            now = self._read()
            if now != found and now is not None:
                raise self._busy()
            if now is None:
                if self._put_new():
                    return
                raise self._busy()
        # Of two that take over at once the last one to put has it; the other finds that out before it begins.
        self._put()
        time.sleep(BEAT_S / 5.0)
        if self._read() != self._content():
            raise self._busy()

    def _busy(self) -> OutputError:
        place = self._path.parent
        if is_address(place):
            return OutputError(
                "address {0}: another run is at work there", place, remedy="wait until it has ended"
            )
        return OutputError("folder {0}: another run is at work in it", place)

    def _taken(self) -> OutputError:
        kind = Message("address") if is_address(self._path) else Message("folder")
        return OutputError(
            "{0} {1}: another run has taken over, as this one gave no sign of life for {2:g} s",
            kind,
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
                # A store may be out of reach for a moment; by then others may take this run for dead.
                if _steady_s() - self._signed_s[0] > DEAD_S - BEAT_S:
                    self._lost = wrong
            else:
                if is_own:
                    self._signed_s = self._clocks_s()
                else:
                    self._lost = self._taken()

    def _is_signed(self) -> bool:
        """Write that this run is alive; False where the place is another's by now."""
        while True:
            looked_s = _steady_s()
            found = self._read()
            # A run that took over and has ended has left none.
            if not self._is_own(found):
                return False
            if _steady_s() - looked_s < BEAT_S:
                # What was seen longer ago, as this process stood still in between, may be true no more.
                break
        self._beats += 1
        self._put()
        # Had it stood still just now, it would have written over another run's sign.
        return _steady_s() - looked_s < DEAD_S
