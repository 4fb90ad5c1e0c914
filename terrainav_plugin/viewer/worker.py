"""One piece of work at a time on a thread of its own: the last one asked for wins."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from qgis.PyQt.QtCore import QObject, pyqtSignal

from ...core.errors import TerrAInavError


class Worker(QObject):
    """Answers with what the last work gave; earlier answers are dropped.

    Signals
    -------
    refused(str)
        The message of an error.
    """

    refused = pyqtSignal(str)
    _finished = pyqtSignal(int, object, object)

    def __init__(self) -> None:
        super().__init__()
        self._latest = self._open = 0
        self._closed = False
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="terrainav-viewer")
        # Emitted on the worker's thread, received on this object's.
        self._finished.connect(self._deliver)

    @property
    def closed(self) -> bool:
        """Whether it has ended: work under way may stop."""
        return self._closed

    @property
    def busy(self) -> bool:
        """Whether an answer is still to come."""
        return self._open > 0

    def ask(self, work: Callable[[], Any], answer: Callable[[Any], None]) -> None:
        """Have something done, and ``answer`` called with what it gave, on the thread of the caller."""
        self._latest += 1
        self._open += 1
        number = self._latest
        self._pool.submit(lambda: work() if number == self._latest else None).add_done_callback(
            lambda future: self._finished.emit(number, future, answer)
        )

    def close(self) -> None:
        """End the thread; no answer comes any more."""
        self._latest += 1
        self._closed = True
        self._pool.shutdown(wait=True, cancel_futures=True)

    def _deliver(self, number: int, future: Future[Any], answer: Callable[[Any], None]) -> None:
        self._open -= 1
        if number != self._latest or future.cancelled():
            return
        error = future.exception()
        if error is None:
            answer(future.result())
        elif isinstance(error, TerrAInavError):
            self.refused.emit(str(error))
        else:
            self.refused.emit(repr(error))
