"""Calls into libraries in C that may take long: whoever waits for one can leave it.

Python handles signals between its own instructions only, so Ctrl-C is not heard while the main thread is inside GDAL.
Here the library works on a thread of its own, and its caller waits in Python. A call that is left goes on until it ends
by itself, as GDAL cannot be stopped within a block, and its result is dropped.
"""

from __future__ import annotations

import atexit
import logging
import os
import sys
import threading
import time
from collections.abc import Callable
from functools import cache
from typing import Generic, TypeVar

from ..errors import Cancelled

Result = TypeVar("Result")
#: Seconds that calls have to end after the program was asked to, so that images in progress can be finished; and that
#: each one has which begins later.
GRACE_S, _LEAST_S = 1.0, 0.1


class _Ending:
    """When the program is to have ended, in seconds of the monotonic clock; never, unless a signal asks for it."""

    def __init__(self) -> None:
        self.signals: list[int] = []
        self._until_s = float("inf")

    def ask(self, number: int, grace_s: float) -> None:
        self.signals.append(number)
        self._until_s = min(self._until_s, time.monotonic() + grace_s)

    def has_passed(self, began_s: float) -> bool:
        return time.monotonic() > max(self._until_s, began_s + _LEAST_S)


_ending = _Ending()
_exit_code: int | None = None


def ask_to_end(number: int, grace_s: float = GRACE_S) -> None:
    """Have all calls left that have not ended by themselves after some seconds; ``number`` is that of a signal."""
    _ending.ask(number, grace_s)


def signals_asked() -> list[int]:
    """Signals that asked the program to end."""
    return _ending.signals


def forget_signals() -> None:
    """Let later calls take as long as they need; those that have begun stay asked to end."""
    global _ending  # noqa: PLW0603 (signals are the process's)
    _ending = _Ending()


class NativeCall(Generic[Result]):
    """A call that is made once, on a thread of its own."""

    def __init__(self, work: Callable[[], Result]) -> None:
        self._work, self._ending = work, _ending
        self._lock, self._ended = threading.Lock(), threading.Event()
        self._has_begun = False
        self._result: list[Result] = []
        self._wrong: BaseException | None = None
        self._afterwards: Callable[[list[Result]], None] | None = None
        self._thread = _Thread(self._run)

    def result(self, is_wanted: Callable[[], bool] = lambda: True) -> Result:
        """Make the call and wait for its result; raises what the call has raised.

        Raises
        ------
        Cancelled
            It is not wanted any more, or the program is asked to end.
        """
        began_s = time.monotonic()
        _have_end_wait()
        # Before the thread: a signal may be met while that is started.
        self._has_begun = True
        self._thread.start()
        # Look every 50 ms whether the result is still wanted.
        while not self._ended.wait(0.05):
            if not is_wanted() or self._ending.has_passed(began_s):
                raise Cancelled("stopped while a raster was read")
        if self._wrong is not None:
            raise self._wrong
        return self._result.pop()

    def when_ended(self, afterwards: Callable[[list[Result]], None]) -> None:
        """Do something when the call has ended, now or on its thread: with its result, unless it was waited for."""
        with self._lock:
            if self._has_begun and not self._ended.is_set():
                self._afterwards = afterwards
                return
        afterwards(self._result)

    def _run(self) -> None:
        try:
            self._result.append(self._work())
        except BaseException as wrong:  # noqa: BLE001 (raised where the result is waited for)
            self._wrong = wrong
        with self._lock:
            self._ended.set()
        if self._afterwards is not None:
            self._afterwards(self._result)


class _Thread(threading.Thread):
    """A daemon, for which Python does not wait at its end."""

    def __init__(self, work: Callable[[], None]) -> None:
        super().__init__(target=work, name="terrainav-native", daemon=True)


def set_exit_code(code: int) -> None:
    """Have the process end with an exit code at once, although calls that were left are still under way."""
    global _exit_code  # noqa: PLW0603 (a process has one)
    if _under_way():
        _exit_code = code


def _under_way() -> list[_Thread]:
    return [thread for thread in threading.enumerate() if isinstance(thread, _Thread)]


@cache
def _have_end_wait() -> None:
    atexit.register(_end)


def _end() -> None:
    """Keep GDAL from being torn down around threads that are in it."""
    if _exit_code is not None and _under_way():
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()
        logging.shutdown()
        os._exit(_exit_code)
    for thread in _under_way():
        thread.join()
