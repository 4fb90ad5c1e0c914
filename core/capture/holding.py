"""A folder, or an object store's, held by one run against others."""

from __future__ import annotations

import json
import threading
import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from ..dataset.folder import JOURNAL_FILE
from ..errors import OutputError
from ..files import open_locked, read_if_there
from ..limits import MAX_SETTINGS_BYTES
from ..stores import is_address, put, put_new, remove
from ..waiting import check_cancelled
from .folder import LOCK_FILE

#: Seconds between a run's signs of life, and after how many without one it counts as dead.
BEAT_S, DEAD_S = 5.0, 30.0


@contextmanager
def held(root: Path) -> Iterator[Callable[[], None]]:
    """Hold a place against other runs meanwhile; yields what raises OutputError where another has taken it.

    Raises
    ------
    OutputError
        Another run is at work there.
    """
    if not is_address(root):
        with open_locked(root / JOURNAL_FILE):
            yield lambda: None
        return
    with _Lease(root / LOCK_FILE) as lease:
        yield lease.check


class _Lease:
    """An object that only one run has, and which it changes as a sign that it is alive.

    Object stores have no locks, but put an object only if there is none. A run that dies leaves its own: who finds one
    watches it, and takes it over where it does not change for longer than a run that is alive would let it be. Nothing
    depends on clocks of different machines.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._token = uuid.uuid4().hex
        self._beats = 0
        self._ended = threading.Event()
        self._lost: OutputError | None = None
        self._thread = threading.Thread(target=self._beat, name="terrainav-lease", daemon=True)

    def __enter__(self) -> _Lease:
        if not put_new(self._path, self._content()):
            self._take_over()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()
        # Another run may have taken over since the last beat.
        if self._lost is None and self._is_own(read_if_there(self._path, MAX_SETTINGS_BYTES)):
            remove(self._path)

    def check(self) -> None:
        """Raise OutputError where another run has taken the place, or it can be written no more."""
        if self._lost is not None:
            raise self._lost

    def _content(self) -> bytes:
        return json.dumps({"run": self._token, "beat": self._beats}).encode("ascii")

    def _take_over(self) -> None:
        found = read_if_there(self._path, MAX_SETTINGS_BYTES)
        until_s = time.monotonic() + DEAD_S
        while time.monotonic() < until_s:
            check_cancelled()
            time.sleep(BEAT_S / 5.0)
            now = read_if_there(self._path, MAX_SETTINGS_BYTES)
            if now != found and now is not None:
                raise self._busy()
            if now is None:
                if put_new(self._path, self._content()):
                    return
                raise self._busy()
        # Of two that take over at once the last one to put has it; the other finds that out before it begins.
        put(self._path, self._content())
        time.sleep(BEAT_S / 5.0)
        if read_if_there(self._path, MAX_SETTINGS_BYTES) != self._content():
            raise self._busy()

    def _busy(self) -> OutputError:
        return OutputError(
            "address {0}: another run is at work there", self._path.parent, remedy="wait until it has ended"
        )

    def _is_own(self, found: bytes | None) -> bool:
        return found is not None and self._token.encode("ascii") in found

    def _beat(self) -> None:
        heard_s = time.monotonic()
        while self._lost is None and not self._ended.wait(BEAT_S):
            wrong = self._signed()
            if wrong is None:
                heard_s = time.monotonic()
            # A store may be out of reach for a moment; by then others may take this run for dead.
            elif time.monotonic() - heard_s > DEAD_S - BEAT_S:
                self._lost = wrong

    def _signed(self) -> OutputError | None:
        """Give a sign of life, unless another run has taken over; what was wrong with that, if anything."""
        try:
            found = read_if_there(self._path, MAX_SETTINGS_BYTES)
            if found is not None and not self._is_own(found):
                self._lost = OutputError(
                    "address {0}: another run has taken over, as this one gave no sign of life for {1:g} s",
                    self._path.parent,
                    DEAD_S,
                )
                return self._lost
            self._beats += 1
            put(self._path, self._content())
        except OutputError as wrong:
            return wrong
        return None
