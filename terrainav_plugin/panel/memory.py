"""The dock's entries, remembered between sessions."""

from __future__ import annotations

from collections.abc import Callable

from qgis.PyQt.QtCore import QObject, QTimer

from ..form.state import FormState
from ..settings import Settings

#: Pause in typing after which entries are written down: QGIS writes its whole file of settings each time.
_PAUSE_MS = 1000


class FormMemory(QObject):
    """Writes entries to the settings once typing has paused.

    Parameters
    ----------
    read : callable
        State of the form.
    """

    def __init__(self, settings: Settings, read: Callable[[], FormState], parent: QObject) -> None:
        super().__init__(parent)
        self._settings, self._read = settings, read
        self._pause = QTimer(self)
        self._pause.setSingleShot(True)
        self._pause.setInterval(_PAUSE_MS)
        self._pause.timeout.connect(self.write)

    @property
    def pending(self) -> bool:
        """Whether there is something to be written down."""
        return self._pause.isActive()

    def note(self) -> None:
        """Take up that the form has changed."""
        self._pause.start()

    def write(self) -> None:
        """Write down what is entered now."""
        self._pause.stop()
        self._settings.form = self._read().to_json()
