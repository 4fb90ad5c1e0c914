"""Messages to the user: the message bar, and a log for the details."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from qgis.core import Qgis, QgsMessageLog
from qgis.gui import QgisInterface, QgsMessageBarItem
from qgis.PyQt.QtCore import QEvent, QObject, Qt
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
#: Characters that two lines of the bar have room for beside its buttons, and those that end a part of a sentence.
_MOST_LETTERS = 140


def _masked(text: str, most: int) -> str:
    """Text without the credentials of an address in it, of so many characters at most."""
    # Of the core, which is loaded when it is first used.
    from ..core.addresses import without_credentials
    from ..core.text.plain import shortened

    return shortened(without_credentials(text), most)


def log(text: str, level: Qgis.MessageLevel = Qgis.MessageLevel.Info) -> None:
    """Write a line to the log panel's TerrAInav tab, as it is."""
    text = _masked(text, 16384)
    shown = text if LOG_IS_PLAIN or "<" not in text else escaped(text)
    QgsMessageLog.logMessage(shown, TITLE, level, notifyUser=False)


class LogPanelHandler(logging.Handler):
    """Hands warnings and errors of the core, with their traces, to the log panel; from any thread."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._logger = logging.getLogger(__name__.partition(".")[0])
        self._logger.addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record."""
        is_error = record.levelno >= logging.ERROR
        log(self.format(record), Qgis.MessageLevel.Critical if is_error else Qgis.MessageLevel.Warning)

    def close(self) -> None:
        """Hear no more."""
        self._logger.removeHandler(self)
        super().close()


def show_log(iface: QgisInterface) -> None:
    """Open the log panel at TerrAInav's tab."""
    iface.openMessageLog()
    panel = iface.mainWindow().findChild(QDockWidget, "MessageLog")
    for tabs in panel.findChildren(QTabWidget) if panel is not None else ():
        for index in range(tabs.count()):
            if tabs.tabText(index) == TITLE:
                tabs.setCurrentIndex(index)


class Messages(QObject):
    """Messages of one session; `close` takes back those still shown."""

    def __init__(self, iface: QgisInterface) -> None:
        super().__init__()
        self._iface = iface
        self._shown: list[QgsMessageBarItem] = []
        #: Refusal that is shown, if any: the next one takes its place.
        self._refusal: QgsMessageBarItem | None = None
        #: What is said while something is waited for.
        self._waiting: QgsMessageBarItem | None = None
        #: Items by what they are about.
        self._topics: dict[str, list[QgsMessageBarItem]] = {}
        # The bar says when an item goes. What an item calls as it is destroyed may be gone already itself.
        iface.messageBar().widgetRemoved.connect(self._forget)

    def info(self, text: str, action: tuple[str, Callable[[], None]] | None = None) -> None:
        """Say what happened."""
        self._show(text, Qgis.MessageLevel.Info, action)

    def success(self, text: str, action: tuple[str, Callable[[], None]] | None = None) -> None:
        """Say that what was asked for is done."""
        self._show(text, Qgis.MessageLevel.Success, action)

    def warning(
        self,
        text: str,
        details: str = "",
        action: tuple[str, Callable[[], None]] | None = None,
        other: tuple[str, Callable[[], None]] | None = None,
    ) -> None:
        """Say what went wrong, or partly wrong, and offer one or two ways on."""
        self._show(text, Qgis.MessageLevel.Warning, action, details, other=other)

    def refused(self, reason: str, what: str) -> None:
        """Say why something asked for was not done, the reason first; the refusal before it goes.

        Parameters
        ----------
        what : str
            What there is not because of it, as a sentence.
        """
        self.withdraw_refusal()
        text = f"{reason[:1].upper()}{reason[1:].rstrip('.')}. {what}"
        short = shortened(text)
        self._refusal = self._show(short, Qgis.MessageLevel.Warning, details="" if short == text else text, logged=text)

    def withdraw_refusal(self) -> None:
        """Take back the refusal that is shown, if any."""
        if self._refusal is not None:
            self._iface.messageBar().popWidget(self._refusal)

    def error(self, text: str, details: str = "") -> None:
        """Say that something failed that should not have."""
        self._show(text, Qgis.MessageLevel.Critical, details=details)

    def failed(self, text: str, trace: str) -> None:
        """Say why work has ended early; of an error that should not have been, ``trace`` says where it came from."""
        if trace:
            self.error(text, trace)
        else:
            self.warning(text)

    def wait(self, text: str) -> None:
        """Say what is waited for, until `stop_waiting`."""
        self.stop_waiting()
        self._waiting = self._show(text, Qgis.MessageLevel.Info, lasts=True)

    def stop_waiting(self) -> None:
        """Take back what was waited for."""
        if self._waiting is not None:
            self._iface.messageBar().popWidget(self._waiting)

    @contextmanager
    def about(self, topic: str) -> Iterator[None]:
        """Note what the messages shown inside are about, for `withdraw`."""
        before = len(self._shown)
        yield
        self._topics.setdefault(topic, []).extend(self._shown[before:])

    def withdraw(self, topic: str) -> None:
        """Take back what is still shown about something: it no longer holds."""
        for item in self._topics.pop(topic, []):
            if item in self._shown:
                self._iface.messageBar().popWidget(item)

    def close(self) -> None:
        """Take back what is still shown, for good."""
        self._iface.messageBar().widgetRemoved.disconnect(self._forget)
        for item in list(self._shown):
            self._iface.messageBar().popWidget(item)
        self._shown.clear()

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
        # The bar reads every text as HTML.
        # Some lines on any map; Qt takes minutes to lay out a million characters.
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
        self._iface.messageBar().pushItem(item)
        return item

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
        """Let go of an item: the bar deletes it, and its wrapper must not be used after that."""
        if item in self._shown:
            self._shown.remove(item)
        if item is self._refusal:
            self._refusal = None
        if item is self._waiting:
            self._waiting = None
        for items in self._topics.values():
            if item in items:
                items.remove(item)


class _Fitting(QObject):
    """Fits a message to the map: as wide as that is, and as high as its lines.

    QGIS gives every text the height of one or two lines. And its bar asks for the width that text and buttons have by
    themselves: beside a panel, on a small screen, that takes the layers' panel its own, and gives nothing back.

    Attributes
    ----------
    buttons : QBoxLayout
        For the message's buttons.
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
        """Follow the width there is."""
        if isinstance(event, QResizeEvent):
            if watched is self._text:
                self._fit_text(event.size().width())
            else:
                # In a narrow message the buttons stand below each other, to leave the text room.
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
    """Text that the bar shows whole: as many parts of its sentences as there is room for."""
    if len(text) <= _MOST_LETTERS:
        return text
    room = text[:_MOST_LETTERS]
    end = max(room.rfind(mark) for mark in ("; ", ". ", ": ", ", "))
    return f"{room[: end if end > 0 else room.rfind(' ')]} …"
