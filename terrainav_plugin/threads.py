"""What work on another thread than QGIS's main one needs: a thread that Python has made, and CRSs of the main one.

pyproj (3.5 to 3.7 at least) holds PROJ's context of a thread twice: a variable of the thread points to it, and
Python's storage for the thread owns it. On a thread that Python has not made, that storage is emptied whenever a call
into Python returns, while the variable stays: the next call on the same thread of QGIS's pool uses a context that is
gone, and QGIS ends with it.

QGIS itself (3.22 to 3.44) shares among its threads what the first of them has read of a CRS, and the projection is lost
with that thread: transformations from this CRS then return coordinates as they were, until QGIS is closed.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

from qgis.core import QgsCoordinateReferenceSystem

Result = TypeVar("Result")

#: Of the layers that TerrAInav opens and makes.
CRS_IDS = ("EPSG:3857", "EPSG:4326")


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


def hold_crs() -> None:
    """Read the CRSs of TerrAInav's layers on the main thread, before work on another one does."""
    for identifier in CRS_IDS:
        QgsCoordinateReferenceSystem(identifier)


def is_foreign() -> bool:
    """Whether the current thread is one that Python has not made."""
    return isinstance(threading.current_thread(), threading._DummyThread)  # noqa: SLF001  (no other way to tell)


def on_python_thread(work: Callable[[], Result]) -> Result:
    """Result of ``work``, which runs here if Python has made this thread, and else on one of its own meanwhile."""
    if not is_foreign():
        return work()
    return PythonThread(work, "terrainav-task").result()
