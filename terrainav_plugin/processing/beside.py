"""Work of an algorithm, on whatever thread QGIS runs it: the main one is kept free for its events.

Imagery that comes over QGIS's network stack or is drawn by QGIS needs the main thread to work through its events. The
toolbox and models run algorithms beside it. But a terminal (``qgis_process``) and ``processing.run`` run them in it,
where an algorithm that waits for a picture would wait for itself. There the work moves to a thread of its own, while
the main one turns its events over until it is done; that is also why no algorithm needs to ask for ``NoThreading``.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from queue import Empty, SimpleQueue
from typing import TypeVar

from qgis.core import QgsProcessingFeedback
from qgis.PyQt.QtCore import QEventLoop, QTimer

from ..tasks import PythonThread, on_python_thread

Result = TypeVar("Result")

#: Milliseconds between two looks at what the work tells, and at whether the user has cancelled.
_LOOK_MS = 20


class Watch:
    """What work tells of itself, in the thread that it runs on, and whether it is to go on."""

    def __init__(self, feedback: QgsProcessingFeedback) -> None:
        self._feedback = feedback

    def say(self, text: str) -> None:
        """Add a line to the log."""
        self._feedback.pushInfo(text)

    def warn(self, text: str) -> None:
        """Add a warning to the log."""
        self._feedback.pushWarning(text)

    def progress(self, share: float) -> bool:
        """Set how much is done, 0 to 1; returns whether to go on."""
        self._feedback.setProgress(100.0 * share)
        return not self.cancelled()

    def cancelled(self) -> bool:
        """Whether the user has cancelled."""
        return self._feedback.isCanceled()


class _Relay(Watch):
    """A watch whose words go through the main thread, where the caller's feedback expects them."""

    def __init__(self, feedback: QgsProcessingFeedback) -> None:
        super().__init__(feedback)
        self._told: SimpleQueue[Callable[[], object]] = SimpleQueue()
        self._stop = threading.Event()

    def say(self, text: str) -> None:
        self._told.put(lambda: Watch.say(self, text))

    def warn(self, text: str) -> None:
        self._told.put(lambda: Watch.warn(self, text))

    def progress(self, share: float) -> bool:
        self._told.put(lambda: Watch.progress(self, share))
        return not self.cancelled()

    def cancelled(self) -> bool:
        return self._stop.is_set()

    def deliver(self) -> None:
        """Pass on what has been told; in the main thread."""
        if self._feedback.isCanceled():
            self._stop.set()
        try:
            while True:
                self._told.get_nowait()()
        except Empty:
            return

    def stop(self) -> None:
        """Ask the work to end."""
        self._stop.set()


def beside_main(work: Callable[[Watch], Result], feedback: QgsProcessingFeedback) -> Result:
    """Do ``work`` while the main thread is free for its events; returns or raises what it does.

    Called in another thread, which is beside it already, that one waits.
    """
    from ..network.worker import in_main_thread

    if not in_main_thread():
        return on_python_thread(lambda: work(Watch(feedback)))
    relay, loop, timer = _Relay(feedback), QEventLoop(), QTimer()
    thread = PythonThread(lambda: work(relay), "terrainav-algorithm")

    def look() -> None:
        relay.deliver()
        if not thread.works:
            loop.quit()

    timer.timeout.connect(look)
    timer.start(_LOOK_MS)
    try:
        # What the user does meanwhile waits, as it does for every algorithm that runs here.
        loop.exec(QEventLoop.ProcessEventsFlag.ExcludeUserInputEvents)
    finally:
        relay.stop()
        thread.wait()
        timer.stop()
    relay.deliver()
    return thread.result()
