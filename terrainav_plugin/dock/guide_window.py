"""The guide as it is installed with the plugin, to be read beside the work."""

from __future__ import annotations

import re
from pathlib import Path

from qgis.PyQt.QtCore import Qt, QUrl
from qgis.PyQt.QtGui import QCloseEvent, QDesktopServices, QTextDocument
from qgis.PyQt.QtWidgets import QTextBrowser, QWidget
from qgis.utils import iface

from ..i18n import tr

_ROOM_PX = (760, 720)
_NAME = "terrainav_guide"
#: The window while it is open: Qt alone does not keep what Python has added to it.
_OPEN: list[GuideWindow] = []


class GuideWindow(QTextBrowser):
    """Shows the guide; links to its own headings and pages are followed here, others by the user's browser."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowFlags(Qt.WindowType.Window)
        self.setObjectName(_NAME)
        self.setWindowTitle(tr("TerrAInav: guide"))
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setOpenLinks(False)
        self.anchorClicked.connect(self._follow)
        self.resize(*_ROOM_PX)
        self._path = Path()

    @classmethod
    def show_at(cls, url: QUrl) -> None:
        """Bring the window to the front, with the guide at the fragment of ``url``."""
        if not _OPEN:
            _OPEN.append(cls(iface.mainWindow()))
        window = _OPEN[0]
        window.load(Path(url.toLocalFile()))
        window.go_to(url.fragment())
        window.show()
        window.raise_()
        window.activateWindow()

    @classmethod
    def close_all(cls) -> None:
        """Close it where it is open."""
        while _OPEN:
            _OPEN[0].close()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Be forgotten."""
        super().closeEvent(event)
        if self in _OPEN:
            _OPEN.remove(self)

    def load(self, path: Path) -> None:
        """Show a page."""
        self._path = path
        # Pictures are named by their place beside the page.
        self.setSearchPaths([str(path.parent)])
        self.document().setMarkdown(
            path.read_text(encoding="utf-8"), QTextDocument.MarkdownFeature.MarkdownDialectGitHub
        )

    def go_to(self, topic: str) -> None:
        """Scroll to a heading, named as links name it; to the beginning where there is none."""
        block = self.document().begin()
        while block.isValid():
            if block.blockFormat().headingLevel() and _anchor(block.text()) == topic:
                top = self.document().documentLayout().blockBoundingRect(block).top()
                self.verticalScrollBar().setValue(int(top))
                return
            block = block.next()
        self.verticalScrollBar().setValue(0)

    def _follow(self, link: QUrl) -> None:
        if not link.scheme():
            if link.path():
                path = self._path.parent / link.path()
                if path.suffix != ".md" or not path.is_file():
                    QDesktopServices.openUrl(QUrl.fromLocalFile(str(path)))
                    return
                self.load(path)
            self.go_to(link.fragment())
        elif link.scheme() in ("http", "https"):
            QDesktopServices.openUrl(link)


def _anchor(heading: str) -> str:
    """Name of a heading in links."""
    return re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", heading.strip().lower()))
