"""What the plugin tells the user: the message bar, and a log for the details."""

from __future__ import annotations

from collections.abc import Callable

from qgis.core import Qgis, QgsMessageLog
from qgis.gui import QgisInterface, QgsMessageBarItem
from qgis.PyQt.QtCore import QObject
from qgis.PyQt.QtWidgets import QDockWidget, QPushButton, QTabWidget

from .i18n import tr

TITLE = "TerrAInav"
#: What QGIS calls its log panel.
_LOG_PANEL = "MessageLog"
_SECONDS = {Qgis.MessageLevel.Info: 8, Qgis.MessageLevel.Success: 12}


def log(text: str, level: Qgis.MessageLevel = Qgis.MessageLevel.Info) -> None:
    """Write a line to the log panel's TerrAInav tab."""
    QgsMessageLog.logMessage(text, TITLE, level, notifyUser=False)


def show_log(iface: QgisInterface) -> None:
    """Open the log panel at TerrAInav's tab."""
    iface.openMessageLog()
    panel = iface.mainWindow().findChild(QDockWidget, _LOG_PANEL)
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
        # The bar says when an item goes. What an item calls as it is destroyed may be gone already itself.
        iface.messageBar().widgetRemoved.connect(self._forget)

    def info(self, text: str) -> None:
        """Say what happened."""
        self._show(text, Qgis.MessageLevel.Info)

    def success(self, text: str, action: tuple[str, Callable[[], None]] | None = None) -> None:
        """Say that what was asked for is done."""
        self._show(text, Qgis.MessageLevel.Success, action)

    def warning(
        self, text: str, details: str = "", action: tuple[str, Callable[[], None]] | None = None
    ) -> None:
        """Say what went wrong, or partly wrong."""
        self._show(text, Qgis.MessageLevel.Warning, action, details)

    def error(self, text: str, details: str = "") -> None:
        """Say that something failed that should not have."""
        self._show(text, Qgis.MessageLevel.Critical, details=details)

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
    ) -> None:
        log(f"{text}\n{details}" if details else text, level)
        item = QgsMessageBarItem(TITLE, text, level, _SECONDS.get(level, 0))
        if action is not None:
            self._add_button(item, *action)
        if details:
            self._add_button(item, tr("Details"), lambda: show_log(self._iface), keep=True)
        self._shown.append(item)
        self._iface.messageBar().pushItem(item)

    def _add_button(
        self, item: QgsMessageBarItem, label: str, action: Callable[[], None], keep: bool = False
    ) -> None:
        button = QPushButton(label)
        button.clicked.connect(lambda: self._press(item, action, keep))
        item.layout().addWidget(button)

    def _press(self, item: QgsMessageBarItem, action: Callable[[], None], keep: bool) -> None:
        if not keep:
            self._iface.messageBar().popWidget(item)
        action()

    def _forget(self, item: QgsMessageBarItem) -> None:
        """Let go of an item: the bar deletes it, and its wrapper must not be used after that."""
        if item in self._shown:
            self._shown.remove(item)
