"""Work on a thread of QGIS's task manager that tells how it ended and never raises."""

from __future__ import annotations

import traceback

from qgis.core import QgsTask
from qgis.PyQt.QtCore import pyqtSignal

from ..core.errors import Cancelled, TerrAInavError
from .compat import TASK_FLAGS
from .i18n import tr
from .threads import hold_crs, on_python_thread


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
        self.error = ""
        self.trace = ""

    def work(self) -> None:
        """Do it, on a thread beside the main one; raises `Cancelled` where it was stopped on the way."""
        raise NotImplementedError

    def run(self) -> bool:
        """Work; an error ends the task and is kept."""
        try:
            on_python_thread(self.work)
        except Cancelled:
            # Asked for: QGIS would say that the task has failed.
            return True
        except TerrAInavError as wrong:
            self.error = str(wrong)
        except Exception as wrong:  # noqa: BLE001  an exception that leaves run() ends QGIS; it is reported instead
            self.error = tr("unexpected error: {error}").format(error=repr(wrong))
            self.trace = traceback.format_exc()
        return not self.error

    def finished(self, result: bool) -> None:  # noqa: ARG002  QGIS passes it
        """Tell; on the main thread."""
        self.ended.emit(self)
