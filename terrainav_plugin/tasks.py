"""Work beside the main thread: QGIS tasks, threads that Python has made, and the latest of several requests.

pyproj (3.5 to 3.7 at least) holds PROJ's context of a thread twice: a variable of the thread points to it, and
Python's storage for the thread owns it. On a thread that Python has not made, that storage is emptied whenever a call
into Python returns, while the variable stays: the next call on the same thread of QGIS's pool uses a context that is
gone, and QGIS ends with it.

QGIS itself (3.22 to 3.44) shares among its threads what the first of them has read of a CRS, and the projection is lost
with that thread: transformations from this CRS then return coordinates as they were, until QGIS is closed.
"""

from __future__ import annotations

import threading
import traceback
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from typing import Any, Generic, TypeVar

from qgis.core import QgsApplication, QgsCoordinateReferenceSystem, QgsTask
from qgis.PyQt.QtCore import QCoreApplication, QObject, Qt, QThread, QTimer, pyqtSignal, pyqtSlot

from ..core.errors import Cancelled, InvalidInput, Message, TerrAInavError
from .compat import TASK_FLAGS
from .i18n import tr

Result = TypeVar("Result")
#: CRSs of layers that TerrAInav opens and makes, beside those that imagery has of its own.
CRS_IDS = ("EPSG:3857", "EPSG:4326")


class Task(QgsTask):
    """A task whose `work` may raise.

    Signals
    -------
    ended(object)
        The task itself, on the main thread, whatever became of it.

    Attributes
    ----------
    error : str
        Why it ended early; empty otherwise.
    trace : str
        Where an error came from that should not have been.
    """

    ended = pyqtSignal(object)

    def __init__(self, description: str) -> None:
        hold_crs()
        # QGIS shows it in a tooltip, which finds out by itself whether it is HTML.
        super().__init__(description.replace("<", "‹"), TASK_FLAGS)
        self.error: str = ""
        self.trace = ""

    def work(self) -> None:
        """Do it, on a thread beside the main one; raises `Cancelled` where it was stopped on the way."""
        raise NotImplementedError

    def begin(self, ended: Callable[[Any], None]) -> None:
        """Hand it to QGIS's task manager, and call ``ended`` with it on the main thread, whatever becomes of it."""
        self.ended.connect(ended)
        QgsApplication.taskManager().addTask(self)

    def go_on(self, share: float) -> bool:
        """Show how much is done, 0 to 1; returns whether to go on."""
        self.setProgress(100.0 * share)
        return not self.isCanceled()

    def abandon(self) -> None:
        """End it early, and tell nobody."""
        self.ended.disconnect()
        self.cancel()

    def run(self) -> bool:
        """Work; an error ends the task and is kept."""
        try:
            on_python_thread(self.work)
        except Cancelled:
            # Asked for: QGIS would say that the task has failed.
            return True
        except TerrAInavError as wrong:
            self.error = Message(wrong)
        except Exception as wrong:  # noqa: BLE001  an exception that leaves run() ends QGIS; it is reported instead
            self.error = tr("unexpected error: {error}").format(error=repr(wrong))
            self.trace = traceback.format_exc()
        return not self.error

    def finished(self, result: bool) -> None:  # noqa: ARG002  QGIS passes it
        """Tell; on the main thread."""
        # QGIS adds its own words right after this, which would lie on top of those of the plugin.
        QTimer.singleShot(0, partial(withdraw_notice, self.description()))
        self.ended.emit(self)


def withdraw_notice(description: str) -> None:
    """Take back QGIS's "Task complete" about a task, also a cancelled one: before 3.26 no flag keeps it away."""
    from qgis.utils import iface

    if iface is None:
        return
    titles = {QCoreApplication.translate("QgisApp", title) for title in ("Task complete", "Task failed")}
    bar = iface.messageBar()
    for item in bar.items():
        if item.title() in titles and item.text() == description:
            bar.popWidget(item)


class LatestWorker(QObject):
    """One piece of work at a time on a thread: the last one asked for wins.

    Answers and errors of work that is overtaken are dropped, and so is work that has not begun by then.

    Parameters
    ----------
    name : str
        Of the thread.

    Signals
    -------
    failed(object)
        The error of the last work asked for.
    """

    failed = pyqtSignal(object)
    _finished = pyqtSignal(int, object, object)

    def __init__(self, name: str, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._latest = self._open = 0
        self._closed = False
        self._pool = ThreadPoolExecutor(1, thread_name_prefix=f"terrainav-{name}")
        # Emitted on the worker's thread, received on this object's.
        self._finished.connect(self._deliver)

    @property
    def closed(self) -> bool:
        """Whether it has ended: work under way may stop."""
        return self._closed

    @property
    def busy(self) -> bool:
        """Whether work is under way or waits, overtaken or not."""
        return self._open > 0

    def ask(self, work: Callable[[Callable[[], bool]], Any], answer: Callable[[Any], None]) -> None:
        """Have something done.

        Parameters
        ----------
        work : callable
            Called on the worker's thread with what says, at any time, whether nobody waits for it any more.
        answer : callable
            Called with what the work gave, on the thread of the caller.
        """
        self.forget()
        self._open += 1
        number = self._latest

        def overtaken() -> bool:
            return number != self._latest

        self._pool.submit(lambda: None if overtaken() else work(overtaken)).add_done_callback(
            lambda future: self._finished.emit(number, future, answer)
        )

    def forget(self) -> None:
        """Wait for nothing any more: what has been asked for is overtaken."""
        self._latest += 1

    def close(self) -> None:
        """End the thread; no answer comes any more."""
        self.forget()
        self._closed = True
        self._pool.shutdown(wait=True, cancel_futures=True)

    def _deliver(self, number: int, future: Future[Any], answer: Callable[[Any], None]) -> None:
        self._open -= 1
        if number != self._latest or future.cancelled():
            return
        error = future.exception()
        if error is None:
            answer(future.result())
        else:
            self.failed.emit(error)


def failure_reason(error: BaseException) -> str:
    """Why work has failed: in words, or as Python has it where that should not have happened."""
    return Message(error) if isinstance(error, TerrAInavError) else repr(error)


def single_shot(act: Callable[[], None], parent: QObject, pause_ms: int = 0) -> QTimer:
    """Timer that has something done once, a while after it was started last."""
    timer = QTimer(parent)
    timer.setSingleShot(True)
    timer.setInterval(pause_ms)
    timer.timeout.connect(act)
    return timer


class PythonThread(Generic[Result]):
    """A thread of Python's own that does some work, from now on, and what comes of it."""

    def __init__(self, work: Callable[[], Result], name: str) -> None:
        self._results: list[Result] = []
        self._failures: list[BaseException] = []
        self._thread = threading.Thread(target=self._run, args=(work,), name=name)
        self._thread.start()

    @property
    def works(self) -> bool:
        """Whether it is at work."""
        return self._thread.is_alive()

    def wait(self) -> None:
        """Wait until it has ended."""
        self._thread.join()

    def result(self) -> Result:
        """Wait, and return or raise what the work does; once."""
        self.wait()
        if self._failures:
            # Held by nothing but the exception on its way: its trace holds what belongs to the main thread.
            raise self._failures.pop()
        return self._results.pop()

    def _run(self, work: Callable[[], Result]) -> None:
        try:
            self._results.append(work())
        except BaseException as failure:  # noqa: BLE001  (raised in the thread that waits)
            self._failures.append(failure)


def crs_named(text: str) -> QgsCoordinateReferenceSystem:
    """CRS of a code or of a WKT; the first time on the main thread, see above."""
    if text.count(":") == 1 and "[" not in text:
        return QgsCoordinateReferenceSystem(text)
    return QgsCoordinateReferenceSystem.fromWkt(text)


def required_crs(crs: QgsCoordinateReferenceSystem, layer_name: str) -> QgsCoordinateReferenceSystem:
    """CRS of a layer; raises InvalidInput where it has none."""
    if not crs.isValid():
        raise InvalidInput(tr("layer “{name}” has no CRS: set it in the layer's properties").format(name=layer_name))
    return crs


def hold_crs() -> None:
    """Read the CRSs of TerrAInav's layers on the main thread, before work on another one does."""
    for identifier in CRS_IDS:
        QgsCoordinateReferenceSystem(identifier)


def held_crs(text: str) -> bool:
    """Have the main thread read a CRS, a code or WKT, before this one does; False where it had no time for that."""
    if text in CRS_IDS:
        return True
    if QThread.currentThread() == QgsApplication.instance().thread():
        crs_named(text)
        return True
    return _Reading(text).wait()


class _Reading(QObject):
    """A CRS that the main thread is to read as soon as it comes to it."""

    _asked = pyqtSignal()

    def __init__(self, text: str) -> None:
        super().__init__()
        self._text = text
        self._read_there = threading.Event()
        self.moveToThread(QgsApplication.instance().thread())
        self._asked.connect(self._read, Qt.ConnectionType.QueuedConnection)

    def wait(self) -> bool:
        """Wait for it, but no longer than a user would: the main thread may wait for this one."""
        self._asked.emit()
        # Wait up to 3 s for the main thread to read another CRS.
        return self._read_there.wait(3.0)

    @pyqtSlot()
    def _read(self) -> None:
        crs_named(self._text)
        self._read_there.set()


def is_foreign() -> bool:
    """Whether the current thread is one that Python has not made."""
    return isinstance(threading.current_thread(), threading._DummyThread)  # noqa: SLF001  (no other way to tell)


def on_python_thread(work: Callable[[], Result]) -> Result:
    """Result of ``work``, which runs here if Python has made this thread, and else on one of its own meanwhile."""
    if not is_foreign():
        return work()
    return PythonThread(work, "terrainav-task").result()
