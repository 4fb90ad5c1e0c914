"""Work off the main thread: QGIS tasks, Python threads, and the latest of several requests.

pyproj (3.5 to 3.7 at least) refers to a thread's PROJ context twice: a thread-local variable points to the context, and
Python's thread-local storage owns it. On a thread that Python did not create, the storage is cleared whenever a call
into Python returns, but the variable is not: the next call on the same thread of QGIS's pool uses a freed context and
crashes QGIS.

QGIS itself (3.22 to 3.44) caches a CRS for all threads when the first thread reads it, and frees its projection when
that thread ends: transformations from this CRS then return coordinates unchanged until QGIS is restarted.
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
#: CRSs of layers that TerrAInav opens and creates, in addition to the CRS of the imagery.
CRS_IDS = ("EPSG:3857", "EPSG:4326")


class Task(QgsTask):
    """A task whose `work` may raise.

    Signals
    -------
    ended(object)
        The task; emitted on the main thread, whether the task succeeded, failed or was cancelled.

    Attributes
    ----------
    error : str
        Why the task failed; empty otherwise.
    trace : str
        Traceback of an unexpected error.
    """

    ended = pyqtSignal(object)

    def __init__(self, description: str) -> None:
        hold_crs()
        # QGIS shows the description in a tooltip, which may take it for HTML.
        super().__init__(description.replace("<", "‹"), TASK_FLAGS)
        self.error: str = ""
        self.trace = ""

    def work(self) -> None:
        """Do the work, off the main thread; raise `Cancelled` if stopped."""
        raise NotImplementedError

    def begin(self, ended: Callable[[Any], None]) -> None:
        """Pass the task to QGIS's task manager; ``ended`` is called with the task, as for the signal `ended`."""
        self.ended.connect(ended)
        QgsApplication.taskManager().addTask(self)

    def report_progress(self, share: float) -> bool:
        """Report the share done, 0 to 1, and return whether to continue."""
        self.setProgress(100.0 * share)
        return not self.isCanceled()

    def abandon(self) -> None:
        """Cancel the task without emitting `ended`."""
        self.ended.disconnect()
        self.cancel()

    def run(self) -> bool:
        """Run `work`, and keep its error."""
        try:
            on_python_thread(self.work)
        except Cancelled:
            # Return True, as QGIS would report a failure although the user has cancelled.
            return True
        except TerrAInavError as wrong:
            self.error = Message(wrong)
        except Exception as wrong:  # noqa: BLE001  an exception from run() would end QGIS; reported instead
            self.error = tr("unexpected error: {error}").format(error=repr(wrong))
            self.trace = traceback.format_exc()
        return not self.error

    def finished(self, result: bool) -> None:  # noqa: ARG002  QGIS passes it
        """Emit `ended`, on the main thread."""
        # Right after this, QGIS adds a notice, which would cover the plugin's message.
        QTimer.singleShot(0, partial(withdraw_notice, self.description()))
        self.ended.emit(self)


def withdraw_notice(description: str) -> None:
    """Remove QGIS's notice of the end of a task, which no flag suppresses before QGIS 3.26."""
    from qgis.utils import iface

    if iface is None:
        return
    titles = {QCoreApplication.translate("QgisApp", title) for title in ("Task complete", "Task failed")}
    bar = iface.messageBar()
    for item in bar.items():
        if item.title() in titles and item.text() == description:
            bar.popWidget(item)


class LatestWorker(QObject):
    """Do one piece of work at a time on a thread; only the latest request counts.

    Earlier requests are overtaken: if still waiting, they are not begun; otherwise their answer or error is ignored.

    Parameters
    ----------
    name : str
        Name of the thread.

    Signals
    -------
    failed(object)
        The error of the latest request.
    awaited(bool)
        Whether the latest request is to be answered.
    """

    failed = pyqtSignal(object)
    awaited = pyqtSignal(bool)
    _finished = pyqtSignal(int, object, object)

    def __init__(self, name: str, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._latest = self._open = 0
        self.is_awaited = False
        self._closed = False
        self._pool = ThreadPoolExecutor(1, thread_name_prefix=f"terrainav-{name}")
        # The signal is emitted on the worker's thread and received on the thread of this object.
        self._finished.connect(self._deliver)

    @property
    def closed(self) -> bool:
        """Whether the worker is closed, so that current work may stop."""
        return self._closed

    @property
    def busy(self) -> bool:
        """Whether work is under way or waiting, even if overtaken."""
        return self._open > 0

    def ask(self, work: Callable[[Callable[[], bool]], Any], answer: Callable[[Any], None]) -> None:
        """Request some work.

        Parameters
        ----------
        work : callable
            Called on the worker's thread; takes a function that returns whether the request is overtaken.
        answer : callable
            Called with the result of the work, on the caller's thread.
        """
        self.forget()
        self._open += 1
        number = self._latest
        self._await(True)

        def overtaken() -> bool:
            return number != self._latest

        self._pool.submit(lambda: None if overtaken() else work(overtaken)).add_done_callback(
            lambda future: self._finished.emit(number, future, answer)
        )

    def forget(self) -> None:
        """Make all requests so far overtaken."""
        self._latest += 1
        self._await(False)

    def close(self) -> None:
        """End the thread, and deliver no more answers."""
        self.forget()
        self._closed = True
        self._pool.shutdown(wait=True, cancel_futures=True)

    def _await(self, awaited: bool) -> None:
        if awaited != self.is_awaited:
            self.is_awaited = awaited
            self.awaited.emit(awaited)

    def _deliver(self, number: int, future: Future[Any], answer: Callable[[Any], None]) -> None:
        self._open -= 1
        if number != self._latest or future.cancelled():
            return
        self._await(False)
        error = future.exception()
        if error is None:
            answer(future.result())
        else:
            self.failed.emit(error)


def failure_reason(error: BaseException) -> str:
    """Why work has failed: the message of an expected error, or the representation of another error."""
    return Message(error) if isinstance(error, TerrAInavError) else repr(error)


def single_shot(act: Callable[[], None], parent: QObject, pause_ms: int = 0) -> QTimer:
    """Timer that calls ``act`` once, ``pause_ms`` after its latest start."""
    timer = QTimer(parent)
    timer.setSingleShot(True)
    timer.setInterval(pause_ms)
    timer.timeout.connect(act)
    return timer


class PythonThread(Generic[Result]):
    """A Python thread that begins work at once, and keeps the result."""

    def __init__(self, work: Callable[[], Result], name: str) -> None:
        self._results: list[Result] = []
        self._failures: list[BaseException] = []
        self._thread = threading.Thread(target=self._run, args=(work,), name=name)
        self._thread.start()

    @property
    def works(self) -> bool:
        """Whether the thread is still working."""
        return self._thread.is_alive()

    def wait(self) -> None:
        """Wait for the end of the work."""
        self._thread.join()

    def result(self) -> Result:
        """Wait, and return the result or raise the error; call only once."""
        self.wait()
        if self._failures:
            # Keep no reference to the exception, as its traceback refers to objects of the main thread.
            raise self._failures.pop()
        return self._results.pop()

    def _run(self, work: Callable[[], Result]) -> None:
        try:
            self._results.append(work())
        except BaseException as failure:  # noqa: BLE001  (raised in the thread that waits)
            self._failures.append(failure)


def crs_named(text: str) -> QgsCoordinateReferenceSystem:
    """CRS of a code or WKT; it must be read on the main thread first (see the module's text)."""
    if text.count(":") == 1 and "[" not in text:
        return QgsCoordinateReferenceSystem(text)
    return QgsCoordinateReferenceSystem.fromWkt(text)


def required_crs(crs: QgsCoordinateReferenceSystem, layer_name: str) -> QgsCoordinateReferenceSystem:
    """CRS of a layer; raises InvalidInput if it has none."""
    if not crs.isValid():
        raise InvalidInput(tr("layer “{name}” has no CRS: set it in the layer's properties").format(name=layer_name))
    return crs


def hold_crs() -> None:
    """Read the CRSs of TerrAInav's layers, to be called on the main thread before another thread does."""
    for identifier in CRS_IDS:
        QgsCoordinateReferenceSystem(identifier)


def read_crs_on_main_thread(text: str) -> bool:
    """Let the main thread read a CRS (a code or WKT) before this thread does; False if it did not in time."""
    if text in CRS_IDS:
        return True
    if QThread.currentThread() == QgsApplication.instance().thread():
        crs_named(text)
        return True
    return _Reading(text).wait()


class _Reading(QObject):
    """A CRS that the main thread is to read as soon as it can."""

    _asked = pyqtSignal()

    def __init__(self, text: str) -> None:
        super().__init__()
        self._text = text
        self._read_there = threading.Event()
        self.moveToThread(QgsApplication.instance().thread())
        self._asked.connect(self._read, Qt.ConnectionType.QueuedConnection)

    def wait(self) -> bool:
        """Wait for the main thread to read the CRS, and return whether it has."""
        self._asked.emit()
        # Not longer than 3 s, as the main thread may be waiting for this thread.
        return self._read_there.wait(3.0)

    @pyqtSlot()
    def _read(self) -> None:
        crs_named(self._text)
        self._read_there.set()


def is_foreign() -> bool:
    """Whether Python did not create the current thread."""
    return isinstance(threading.current_thread(), threading._DummyThread)  # noqa: SLF001  (no other way to tell)


def on_python_thread(work: Callable[[], Result]) -> Result:
    """Run ``work`` on this thread if Python created the thread, otherwise on a new Python thread; return its result."""
    if not is_foreign():
        return work()
    return PythonThread(work, "terrainav-task").result()
