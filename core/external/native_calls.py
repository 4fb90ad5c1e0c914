"""Long calls into C libraries that the caller can abandon.

Python handles signals between bytecode instructions only, so Ctrl-C has no effect while the main thread is inside GDAL.
Here the library runs in a separate thread, and the caller waits in Python. An abandoned call runs to its end, as GDAL
cannot be stopped within a block; its result is dropped.
"""

from __future__ import annotations

import atexit
import os
import sys
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack
from functools import cache
from queue import Queue
from typing import Generic, TypeVar

from ..errors import Cancelled

Result = TypeVar("Result")
#: Seconds for which calls may continue after a request to end the program, to finish images in progress.
GRACE_S = 1.0


class _Ending:
    """Deadline of the program, by the monotonic clock; infinite until a signal asks the program to end."""

    def __init__(self) -> None:
        self.signals: list[int] = []
        self._until_s = float("inf")

    def ask(self, number: int, grace_s: float) -> None:
        self.signals.append(number)
        self._until_s = min(self._until_s, time.monotonic() + grace_s)

    def has_passed(self, began_s: float) -> bool:
        # A call that begins after the deadline still has 0.1 s.
        return time.monotonic() > max(self._until_s, began_s + 0.1)


_ending = _Ending()
_local = threading.local()
_exit_code: int | None = None


def ask_to_end(number: int, grace_s: float = GRACE_S) -> None:
    """Abandon calls that do not end within the grace period; ``number`` is the number of the signal."""
    _ending.ask(number, grace_s)


def signals_asked() -> list[int]:
    """Signals that asked the program to end."""
    return _ending.signals


def forget_signals() -> None:
    """Let later calls run without a deadline; the deadline of calls in progress stays."""
    global _ending  # noqa: PLW0603 (signals concern the whole process)
    _ending = _Ending()


class NativeThread:
    """A thread for calls, made one after the other; `close` ends it.

    Parameters
    ----------
    keeps_contexts : bool
        Whether calls may enter `thread_contexts` that stay for later ones.
    """

    def __init__(self, *, keeps_contexts: bool = True) -> None:
        self._keeps_contexts = keeps_contexts
        self._thread: _Thread | None = None

    def make(self, call: Callable[[], None]) -> None:
        """Make a call after the earlier ones."""
        # A process that was forked has none.
        if self._thread is None or not self._thread.is_alive():
            self._thread = _Thread(keeps_contexts=self._keeps_contexts)
            self._thread.start()
        self._thread.calls.put(call)

    def close(self) -> None:
        """End the thread after its calls."""
        thread, self._thread = self._thread, None
        if thread is not None:
            thread.calls.put(None)

    __del__ = close


def thread_contexts() -> ExitStack | None:
    """Contexts of the current thread, left at its end; None if it is not one that keeps them."""
    contexts: ExitStack | None = getattr(_local, "contexts", None)
    return contexts


class NativeCall(Generic[Result]):
    """A call that is made once, in a separate thread.

    Parameters
    ----------
    work : callable
    thread : NativeThread or None
        None for a thread of this call only.
    """

    def __init__(self, work: Callable[[], Result], thread: NativeThread | None = None) -> None:
        self._work, self._ending = work, _ending
        self._lock, self._ended = threading.Lock(), threading.Event()
        self._has_begun = False
        self._result: list[Result] = []
        self._wrong: BaseException | None = None
        self._afterwards: Callable[[list[Result]], None] | None = None
        self._thread = thread

    def result(self, is_wanted: Callable[[], bool] = lambda: True) -> Result:
        """Make the call and wait for the result; re-raise the exception of the call.

        Raises
        ------
        Cancelled
            The result is no longer wanted, or the program must end.
        """
        began_s = time.monotonic()
        _register_end()
        # Set this before the thread starts, as a signal may interrupt the start.
        self._has_begun = True
        thread = self._thread or NativeThread(keeps_contexts=False)
        thread.make(self._run)
        if self._thread is None:
            thread.close()
        # Check every 50 ms whether the result is still wanted.
        while not self._ended.wait(0.05):
            if not is_wanted() or self._ending.has_passed(began_s):
                raise Cancelled("stopped while a raster was read")
        if self._wrong is not None:
            raise self._wrong
        return self._result.pop()

    def when_ended(self, afterwards: Callable[[list[Result]], None]) -> None:
        """Call ``afterwards`` when the call has ended, now or in its thread, with the result in a list unless taken."""
        with self._lock:
            if self._has_begun and not self._ended.is_set():
                self._afterwards = afterwards
                return
        afterwards(self._result)

    def _run(self) -> None:
        try:
            self._result.append(self._work())
        except BaseException as wrong:  # noqa: BLE001 (raised again by result())
            self._wrong = wrong
        with self._lock:
            self._ended.set()
        if self._afterwards is not None:
            self._afterwards(self._result)


class _Thread(threading.Thread):
    """A daemon thread, for which Python does not wait at exit; makes the calls put in its queue until there is None."""

    def __init__(self, *, keeps_contexts: bool) -> None:
        super().__init__(name="terrainav-native", daemon=True)
        self._keeps_contexts = keeps_contexts
        self.calls: Queue[Callable[[], None] | None] = Queue()

    def run(self) -> None:
        with ExitStack() as contexts:
            if self._keeps_contexts:
                _local.contexts = contexts
            while (call := self.calls.get()) is not None:
                try:
                    call()
                finally:
                    self.calls.task_done()
                # Nothing of a call is kept while the next one is awaited.
                del call
        self.calls.task_done()


def set_exit_code(code: int) -> None:
    """Make the process exit at once with a code, if abandoned calls are still running at its end."""
    global _exit_code  # noqa: PLW0603 (a process has one)
    if _under_way():
        _exit_code = code


def _under_way() -> list[_Thread]:
    threads = (thread for thread in threading.enumerate() if isinstance(thread, _Thread))
    return [thread for thread in threads if thread.calls.unfinished_tasks]


@cache
def _register_end() -> None:
    atexit.register(_end)


def _end() -> None:
    """Keep GDAL from being unloaded while threads are inside it."""
    if _exit_code is not None and _under_way():
        import logging

        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()
        logging.shutdown()
        os._exit(_exit_code)
    for thread in _under_way():
        thread.calls.join()
