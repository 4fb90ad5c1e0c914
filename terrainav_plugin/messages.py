"""Messages to the user in the message bar, with details in the log."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from qgis.core import Qgis, QgsMessageLog
from qgis.gui import QgisInterface, QgsMessageBarItem
from qgis.PyQt.QtCore import QEvent, QObject, Qt, QTimer
from qgis.PyQt.QtGui import QResizeEvent
from qgis.PyQt.QtWidgets import (
    QBoxLayout,
    QDockWidget,
    QPushButton,
    QSizePolicy,
    QTabWidget,
    QTextBrowser,
    QWidget,
)

from .compat import LOG_IS_PLAIN
from .i18n import tr
from .plain import escaped

TITLE = "TerrAInav"
#: Number of characters that fit in two lines of the bar, next to its buttons.
_MOST_LETTERS = 140


def _masked(text: str, most: int) -> str:
    """Text of at most ``most`` characters, without credentials in addresses."""
    # Import the core only on first use.
    from ..core.addresses import without_credentials
    from ..core.text.plain import shortened

    return shortened(without_credentials(text), most)


def log(text: str, level: Qgis.MessageLevel = Qgis.MessageLevel.Info) -> None:
    """Write a line to the log panel's TerrAInav tab, verbatim."""
    text = _masked(text, 16384)
    shown = text if LOG_IS_PLAIN or "<" not in text else escaped(text)
    QgsMessageLog.logMessage(shown, TITLE, level, notifyUser=False)


class LogPanelHandler(logging.Handler):
    """Write warnings and errors of the core, with tracebacks, to the log panel; on any thread."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._logger = logging.getLogger(__name__.partition(".")[0])
        self._logger.addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record."""
        is_error = record.levelno >= logging.ERROR
        log(self.format(record), Qgis.MessageLevel.Critical if is_error else Qgis.MessageLevel.Warning)

    def close(self) -> None:
        """Stop receiving records."""
        self._logger.removeHandler(self)
        super().close()


def show_log(iface: QgisInterface) -> None:
    """Open the log panel, with TerrAInav's tab in front."""
    iface.openMessageLog()
    panel = iface.mainWindow().findChild(QDockWidget, "MessageLog")
    for tabs in panel.findChildren(QTabWidget) if panel is not None else ():
        for index in range(tabs.count()):
            if tabs.tabText(index) == TITLE:
                tabs.setCurrentIndex(index)


class Messages(QObject):
    """Messages of one session; `close` removes those still shown."""

    def __init__(self, iface: QgisInterface) -> None:
        super().__init__()
        self._iface = iface
        self._shown: list[QgsMessageBarItem] = []
        #: The refusal shown, if any; the next refusal replaces it.
        self._refusal: QgsMessageBarItem | None = None
        #: The message shown while the user waits, if any.
        self._waiting: QgsMessageBarItem | None = None
        #: Messages without an action: the next message replaces those of an earlier event.
        self._notices: list[QgsMessageBarItem] = []
        self._earlier: list[QgsMessageBarItem] = []
        self._event_over = QTimer(self)
        self._event_over.setSingleShot(True)
        self._event_over.timeout.connect(self._end_event)
        #: Items by topic.
        self._topics: dict[str, list[QgsMessageBarItem]] = {}
        # Use the bar's signal: on the destruction of an item, objects that it calls may already be deleted.
        iface.messageBar().widgetRemoved.connect(self._forget)

    def info(self, text: str, action: tuple[str, Callable[[], None]] | None = None, lasts: bool = False) -> None:
        """Show information, which goes by itself unless it ``lasts``."""
        self._show(text, Qgis.MessageLevel.Info, action, lasts=lasts)

    def success(
        self, text: str, action: tuple[str, Callable[[], None]] | None = None, details: str = "", lasts: bool = False
    ) -> None:
        """Report that a request was carried out; the message goes by itself unless it ``lasts``."""
        self._show(text, Qgis.MessageLevel.Success, action, details, lasts=lasts)

    def warning(
        self,
        text: str,
        details: str = "",
        action: tuple[str, Callable[[], None]] | None = None,
        other: tuple[str, Callable[[], None]] | None = None,
    ) -> None:
        """Report a full or partial failure, with one or two actions."""
        self._show(text, Qgis.MessageLevel.Warning, action, details, other=other)

    def refused(self, reason: str, what: str) -> None:
        """Report why a request was refused, in place of the previous refusal.

        Parameters
        ----------
        what : str
            What is missing as a result, as a sentence.
        """
        self.withdraw_refusal()
        text = f"{reason[:1].upper()}{reason[1:].rstrip('.')}. {what}"
        short = shortened(text)
        self._refusal = self._show(short, Qgis.MessageLevel.Warning, details="" if short == text else text, logged=text)

    def withdraw_refusal(self) -> None:
        """Remove the refusal shown, if any."""
        if self._refusal is not None:
            self._iface.messageBar().popWidget(self._refusal)

    def error(self, text: str, details: str = "") -> None:
        """Report an unexpected failure."""
        self._show(text, Qgis.MessageLevel.Critical, details=details)

    def failed(self, text: str, trace: str) -> None:
        """Report why work ended early; ``trace`` is the traceback of an unexpected error, empty for other errors."""
        if trace:
            self.error(text, trace)
        else:
            self.warning(text)

    def wait(self, text: str) -> None:
        """Show a text until `stop_waiting`."""
        self.stop_waiting()
        self._waiting = self._show(text, Qgis.MessageLevel.Info, lasts=True)

    def stop_waiting(self) -> None:
        """Remove the text shown by `wait`."""
        if self._waiting is not None:
            self._iface.messageBar().popWidget(self._waiting)

    @contextmanager
    def topic(self, topic: str) -> Iterator[None]:
        """Assign a topic to the messages shown within the context, for `withdraw`."""
        before = len(self._shown)
        yield
        self._topics.setdefault(topic, []).extend(self._shown[before:])

    def withdraw(self, topic: str) -> None:
        """Remove the messages of a topic, which no longer apply."""
        for item in self._topics.pop(topic, []):
            if item in self._shown:
                self._iface.messageBar().popWidget(item)

    def close(self) -> None:
        """Remove all messages, and show no more."""
        self._iface.messageBar().widgetRemoved.disconnect(self._forget)
        for item in list(self._shown):
            self._iface.messageBar().popWidget(item)
        self._shown.clear()
        self._notices.clear()

    def _show(
        self,
        text: str,
        level: Qgis.MessageLevel,
        action: tuple[str, Callable[[], None]] | None = None,
        details: str = "",
        logged: str = "",
        other: tuple[str, Callable[[], None]] | None = None,
        lasts: bool = False,
    ) -> QgsMessageBarItem:
        log(logged or (f"{text}\n{details}" if details else text), level)
        self._withdraw_earlier()
        # Escape the text, as the bar reads every text as HTML, and shorten it to a few lines: Qt takes minutes to lay
        # out a million characters.
        shown = escaped(_masked(text, 2000))
        item = QgsMessageBarItem(
            TITLE,
            shown,
            level,
            0 if lasts else {Qgis.MessageLevel.Info: 8, Qgis.MessageLevel.Success: 12}.get(level, 0),
        )
        fitting = _Fitting(item)
        for offered in filter(None, (action, other)):
            fitting.buttons.addWidget(self._button(item, *offered))
        if details:
            fitting.buttons.addWidget(self._button(item, tr("Details"), lambda: show_log(self._iface), keep=True))
        self._shown.append(item)
        if action is None and other is None and not lasts:
            self._notices.append(item)
            self._event_over.start(0)
        self._iface.messageBar().pushItem(item)
        return item

    def _end_event(self) -> None:
        self._earlier = list(self._notices)

    def _withdraw_earlier(self) -> None:
        """Remove notices of earlier events, which would come back when the next message goes."""
        for item in self._earlier:
            if item in self._notices:
                self._iface.messageBar().popWidget(item)
        self._earlier = []

    def _button(
        self, item: QgsMessageBarItem, label: str, action: Callable[[], None], keep: bool = False
    ) -> QPushButton:
        button = QPushButton(label)
        button.clicked.connect(lambda: self._press(item, action, keep))
        return button

    def _press(self, item: QgsMessageBarItem, action: Callable[[], None], keep: bool) -> None:
        if not keep:
            self._iface.messageBar().popWidget(item)
        action()

    def _forget(self, item: QgsMessageBarItem) -> None:
        """Drop an item that the bar deletes, as its wrapper must not be used afterwards."""
        for items in (self._shown, self._notices):
            if item in items:
                items.remove(item)
        if item is self._refusal:
            self._refusal = None
        if item is self._waiting:
            self._waiting = None
        for items in self._topics.values():
            if item in items:
                items.remove(item)


class _Fitting(QObject):
    """Fit the width of a message to the canvas, and its height to its lines.

    QGIS gives every text the height of one or two lines, and its bar requests the full width of text and buttons: on a
    small screen, this permanently narrows the panels next to the map.

    Attributes
    ----------
    buttons : QBoxLayout
        Layout of the message's buttons.
    """

    def __init__(self, item: QgsMessageBarItem) -> None:
        super().__init__(item)
        item.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Minimum)
        self._text = item.findChild(QTextBrowser)
        holder = QWidget()
        self.buttons = QBoxLayout(QBoxLayout.Direction.LeftToRight, holder)
        self.buttons.setContentsMargins(0, 0, 0, 0)
        holder.setSizePolicy(QSizePolicy.Policy.Maximum, QSizePolicy.Policy.Maximum)
        item.layout().addWidget(holder)
        if self._text is not None:
            self._text.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
            self._text.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
            self._text.installEventFilter(self)
        item.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Fit the message to a new width."""
        if isinstance(event, QResizeEvent):
            if watched is self._text:
                self._fit_text(event.size().width())
            else:
                # In a narrow message, stack the buttons to leave room for the text.
                narrow = event.size().width() < 700
                down, along = QBoxLayout.Direction.TopToBottom, QBoxLayout.Direction.LeftToRight
                self.buttons.setDirection(down if narrow else along)
        return super().eventFilter(watched, event)

    def _fit_text(self, width_px: int) -> None:
        document, edges_px = self._text.document(), 2 * self._text.frameWidth()
        document.setTextWidth(width_px - edges_px)
        height_px = math.ceil(document.size().height()) + edges_px
        if height_px != self._text.minimumHeight():
            self._text.setFixedHeight(height_px)


def shortened(text: str) -> str:
    """Beginning of a text that fits in the bar, cut after a part of a sentence."""
    if len(text) <= _MOST_LETTERS:
        return text
    room = text[:_MOST_LETTERS]
    end = max(room.rfind(mark) for mark in ("; ", ". ", ": ", ", "))
    return f"{room[: end if end > 0 else room.rfind(' ')]} …"
