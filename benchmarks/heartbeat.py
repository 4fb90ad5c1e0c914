"""How long an application's event loop was held up, and by what: work of the main thread, or waiting."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Any, NamedTuple

from qgis.PyQt.QtCore import Qt, QTimer

_NANO = 1e-9


class Block(NamedTuple):
    """A time for which the event loop did not turn, in seconds.

    Attributes
    ----------
    wall_s : float
    work_s : float
        Of it, the main thread at work on a processor.
    queued_s : float
        Of it, the main thread ready to work while other threads or programs had the processors. What is left it has
        waited for locks and files.
    """

    wall_s: float = 0.0
    work_s: float = 0.0
    queued_s: float = 0.0

    def text(self) -> str:
        """Milliseconds: all, at work, and in the queue."""
        return f"{1e3 * self.wall_s:.0f} ({1e3 * self.work_s:.0f} + {1e3 * self.queued_s:.0f})"


class Heartbeat:
    """A timer that is due every millisecond, and notes how late it comes. Made on the main thread."""

    def __init__(self) -> None:
        self._times = _schedule()
        self._last = self._now()
        self.longest = Block()
        self.most_work_s = 0.0
        self._timer = QTimer()
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._beat)
        self._timer.start(1)

    def reset(self) -> None:
        """Begin anew."""
        self._last, self.longest, self.most_work_s = self._now(), Block(), 0.0

    def _now(self) -> Block:
        queued_s = int(self._times.read_text().split()[1]) * _NANO if self._times is not None else 0.0
        return Block(time.perf_counter(), time.thread_time(), queued_s)

    def _beat(self) -> None:
        now = self._now()
        block = Block(*(after - before for before, after in zip(self._last, now)))
        self._last = now
        self.longest = max(self.longest, block)
        self.most_work_s = max(self.most_work_s, block.work_s)


def _schedule() -> Path | None:
    """File in which Linux says how long this thread has waited for a processor; None elsewhere."""
    path = Path(f"/proc/self/task/{threading.get_native_id()}/schedstat")
    return path if path.exists() else None


class Steps:
    """Longest call of some functions of the main thread, and the time spent in all of them."""

    def __init__(self) -> None:
        self.longest_s = self.total_s = 0.0
        self.slowest = ""
        self._depth = 0

    def reset(self) -> None:
        """Begin anew."""
        self.longest_s = self.total_s = 0.0
        self.slowest = ""

    @contextmanager
    def watch(self, owner: Any, *names: str) -> Iterator[None]:
        """Time methods of a class meanwhile; those called by others count as part of them."""
        originals = {name: vars(owner)[name] for name in names}
        for name, method in originals.items():
            setattr(owner, name, self._timed(method))
        try:
            yield
        finally:
            for name, method in originals.items():
                setattr(owner, name, method)

    def _timed(self, method: Any) -> Any:
        @wraps(method)
        def timed(*args: Any, **kwargs: Any) -> Any:
            if self._depth:
                return method(*args, **kwargs)
            self._depth += 1
            start = time.perf_counter()
            try:
                return method(*args, **kwargs)
            finally:
                self._depth -= 1
                seconds = time.perf_counter() - start
                self.total_s += seconds
                if seconds > self.longest_s:
                    self.longest_s, self.slowest = seconds, method.__name__

        return timed
