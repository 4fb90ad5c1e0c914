"""The guide: shown in a window if it is installed with the plugin; otherwise the project's homepage."""

from __future__ import annotations

import re
from configparser import ConfigParser
from pathlib import Path

from qgis.PyQt.QtCore import Qt, QUrl
from qgis.PyQt.QtGui import QCloseEvent, QDesktopServices, QImageReader, QResizeEvent, QTextDocument
from qgis.PyQt.QtWidgets import QDialogButtonBox, QTextBrowser, QWidget

from .i18n import language, tr
from .tasks import single_shot

_PLUGIN = Path(__file__).resolve().parent.parent
_GUIDE = "guide"
#: The open window, if any; without this reference, Python would drop the object's attributes.
_OPEN: list[GuideWindow] = []


def help_url(topic: str = "") -> QUrl:
    """Address of the guide: a file of the plugin, in the user's language if available; otherwise the homepage.

    Parameters
    ----------
    topic : str
        Heading to scroll to, as in the fragment of a link; empty for the beginning.
    """
    for name in (f"{_GUIDE}.{language()}.md", f"{_GUIDE}.md"):
        path = _PLUGIN / "docs" / name
        if path.is_file():
            url = QUrl.fromLocalFile(str(path))
            url.setFragment(topic)
            return url
    return QUrl(homepage())


def homepage() -> str:
    """Address of the project's homepage."""
    metadata = ConfigParser(interpolation=None)
    metadata.read(_PLUGIN / "metadata.txt", encoding="utf-8")
    return metadata["general"]["homepage"]


def show_help(topic: str = "") -> None:
    """Open the guide."""
    url = help_url(topic)
    if not url.isLocalFile():
        QDesktopServices.openUrl(url)
        return
    GuideWindow.show_page(url)


def close_help() -> None:
    """Close the guide if it is open."""
    GuideWindow.close_all()


def add_help_button(buttons: QDialogButtonBox, topic: str) -> None:
    """Add a button that opens the guide at ``topic``, a heading in the user's language."""
    button = buttons.addButton(QDialogButtonBox.StandardButton.Help)
    button.setToolTip(tr("Open the guide"))
    buttons.helpRequested.connect(lambda: show_help(topic))


class GuideWindow(QTextBrowser):
    """Show the guide; follow links within it, and open other links in the browser."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowFlags(Qt.WindowType.Window)
        self.setObjectName("terrainav_guide")
        self.setWindowTitle(tr("TerrAInav: guide"))
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setOpenLinks(False)
        self.anchorClicked.connect(self._follow)
        self.resize(760, 720)
        self._path = Path()
        self._fitted_px = 0
        self._shown: QTextDocument | None = None
        self._fit_soon = single_shot(self._fit, self, 150)

    @classmethod
    def show_page(cls, url: QUrl) -> None:
        """Bring the window to the front, with the guide at the fragment of ``url``."""
        if not _OPEN:
            from qgis.utils import iface

            _OPEN.append(cls(iface.mainWindow()))
        window = _OPEN[0]
        # Show the window first: only then is its width final, which the layout of pictures and headings needs.
        window.show()
        window.load(Path(url.toLocalFile()))
        window.show_heading(url.fragment())
        window.raise_()
        window.activateWindow()

    @classmethod
    def close_all(cls) -> None:
        """Close the window if it is open."""
        while _OPEN:
            _OPEN[0].close()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Drop the reference to the window."""
        super().closeEvent(event)
        if self in _OPEN:
            _OPEN.remove(self)

    def load(self, path: Path) -> None:
        """Show a page."""
        self._path = path
        self._fitted_px = self.viewport().width()
        # Picture paths are relative to the page.
        self.setSearchPaths([str(path.parent)])
        # Use a new document each time, as the old one would keep the formats of its contents.
        document, before = QTextDocument(self), self._shown
        document.setDefaultFont(self.font())
        document.setMarkdown(path.read_text(encoding="utf-8"), QTextDocument.MarkdownFeature.MarkdownDialectGitHub)
        self.setDocument(document)
        self._shown = document
        if before is not None:
            before.deleteLater()

    def loadResource(self, kind: int, name: QUrl) -> object:
        """Load a picture, no wider than the window."""
        path = self._path.parent / name.path()
        if path.suffix not in (".jpg", ".png"):
            return super().loadResource(kind, name)
        reader = QImageReader(str(path))
        # Subtract 12 px of margins, and 40 px by which Qt indents lists, as images may be in lists.
        size, room = reader.size(), self.viewport().width() - 12 - 40
        if size.width() > room > 0:
            # The reader scales JPEG while reading, in a fraction of the time.
            reader.setScaledSize(size * (room / size.width()))
        return reader.read()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fit the pictures to the new width after a pause."""
        super().resizeEvent(event)
        if self._path.is_file():
            self._fit_soon.start()

    def _fit(self) -> None:
        if self.viewport().width() == self._fitted_px:
            return
        bar = self.verticalScrollBar()
        share = bar.value() / max(bar.maximum(), 1)
        self.load(self._path)
        bar.setValue(round(share * bar.maximum()))

    def show_heading(self, topic: str) -> None:
        """Scroll to a heading, named as in a link; to the beginning if there is no such heading."""
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
                if not path.is_file():
                    QDesktopServices.openUrl(
                        QUrl("https://github.com/terrainav/terrainav/blob/HEAD/docs/" + link.path())
                    )
                    return
                if path.suffix != ".md" or not path.is_file():
                    QDesktopServices.openUrl(QUrl.fromLocalFile(str(path)))
                    return
                self.load(path)
            self.show_heading(link.fragment())
        elif link.scheme() in ("http", "https"):
            QDesktopServices.openUrl(link)


def _anchor(heading: str) -> str:
    """Name of a heading in links."""
    return re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", heading.strip().lower()))
