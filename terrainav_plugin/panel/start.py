"""Entry of the first image's capture time: date and time in UTC, next to the local time."""

from __future__ import annotations

from datetime import datetime, timezone

from qgis.gui import QgsDateTimeEdit
from qgis.PyQt.QtCore import QDate, QDateTime, QLocale, QSignalBlocker, Qt, QTime, pyqtSignal
from qgis.PyQt.QtGui import QWheelEvent
from qgis.PyQt.QtWidgets import QVBoxLayout, QWidget

from ...core.errors import InvalidInput
from ...core.mission.parts import Flight, utc_time
from ..i18n import tr
from ..widgets import FieldMessage, named


class _DayAndTime(QgsDateTimeEdit):
    """Date and time entry that a single Tab leaves, and that the mouse wheel changes only while it has the focus."""

    def focusNextPrevChild(self, forward: bool) -> bool:
        """Move to the next entry; the arrow keys move between the parts of this one."""
        return QWidget.focusNextPrevChild(self, forward)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Change the value if the entry has the focus; otherwise leave the wheel to the panel."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()


class StartEntry(QWidget):
    """Date and time in UTC; empty for the mission's default.

    An entered text is kept, including decimals of a second, until the user changes the time.

    Signals
    -------
    changed()
    """

    changed = pyqtSignal()

    def __init__(self, tip: str) -> None:
        super().__init__()
        self.setToolTip(tip)
        self.edit = named(_DayAndTime(), "start", tip)
        self.edit.setTimeSpec(Qt.TimeSpec.UTC)
        self.edit.setDisplayFormat("yyyy-MM-dd HH:mm:ss 'UTC'")
        self.edit.setCalendarPopup(True)
        self.edit.setAllowNull(True)
        self.edit.setNullRepresentation(tr("not set"))
        self.edit.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.local = named(FieldMessage(), "start_local")
        self.local.setWordWrap(True)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(1)
        layout.addWidget(self.edit)
        layout.addWidget(self.local)
        self.setFocusProxy(self.edit)
        self._text = Flight.start
        self._show()
        self.edit.valueChanged.connect(self._edited)

    def text(self) -> str:
        """Return the text for the mission."""
        return self._text

    def enter(self, text: str) -> None:
        """Enter a text without emitting signals; an invalid text is kept, so that its error is shown."""
        if text != self._text:
            self._text = text
            self._show()

    def _show(self) -> None:
        with QSignalBlocker(self.edit):
            try:
                time = None if self._text == Flight.start else utc_time(self._text)
            except InvalidInput:
                time = None
            if time is None:
                # Also needed: `clear` alone shows the current time until the entry loses the focus or is shown again.
                self.edit.setDateTime(QDateTime())
            else:
                at = QTime(time.hour, time.minute, time.second, time.microsecond // 1000)
                self.edit.setDateTime(QDateTime(QDate(time.year, time.month, time.day), at, Qt.TimeSpec.UTC))
        self._show_local()

    def _edited(self) -> None:
        time = self.edit.dateTime()
        if self.edit.isNull() or not time.isValid():
            self._text = Flight.start
        else:
            form = "yyyy-MM-ddTHH:mm:ss.zzz" if time.time().msec() else "yyyy-MM-ddTHH:mm:ss"
            self._text = time.toString(form) + "Z"
        self._show_local()
        self.changed.emit()

    def _show_local(self) -> None:
        """Show the same time in this computer's time zone."""
        text = ""
        if self._text != Flight.start:
            try:
                text = local_text(utc_time(self._text))
            except InvalidInput:
                text = ""
        self.local.say(text)


def local_text(time: datetime) -> str:
    """Local time in the user's format; empty if this computer cannot convert it."""
    try:
        seconds = int(time.replace(tzinfo=timezone.utc).timestamp())
    except (OverflowError, OSError, ValueError):
        return ""
    local = QDateTime.fromSecsSinceEpoch(seconds)
    shown = QLocale().toString(local, QLocale.FormatType.ShortFormat)
    return tr("{time} {zone}, local time of this computer").format(time=shown, zone=local.timeZoneAbbreviation())
