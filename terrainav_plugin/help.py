"""The guide: in a window of its own where it is installed with the plugin, otherwise at the project's homepage."""

from __future__ import annotations

from configparser import ConfigParser
from pathlib import Path

from qgis.PyQt.QtCore import QUrl
from qgis.PyQt.QtGui import QDesktopServices
from qgis.PyQt.QtWidgets import QDialogButtonBox

from .i18n import language, tr

_PLUGIN = Path(__file__).resolve().parent.parent
_GUIDE = "guide"


def help_url(topic: str = "") -> QUrl:
    """Where the guide is: a file of the plugin, in the user's language where there is one, or the homepage.

    Parameters
    ----------
    topic : str
        Heading to go to, as it is written in links; empty for the beginning.
    """
    for name in (f"{_GUIDE}.{language()}.md", f"{_GUIDE}.md"):
        path = _PLUGIN / "docs" / name
        if path.is_file():
            url = QUrl.fromLocalFile(str(path))
            url.setFragment(topic)
            return url
    metadata = ConfigParser(interpolation=None)
    metadata.read(_PLUGIN / "metadata.txt", encoding="utf-8")
    return QUrl(metadata["general"]["homepage"])


def show_help(topic: str = "") -> None:
    """Open the guide."""
    url = help_url(topic)
    if not url.isLocalFile():
        QDesktopServices.openUrl(url)
        return
    from .dock.guide_window import GuideWindow

    GuideWindow.show_at(url)


def close_help() -> None:
    """Close the guide where it is open."""
    from .dock.guide_window import GuideWindow

    GuideWindow.close_all()


def add_help_button(buttons: QDialogButtonBox, topic: str) -> None:
    """Add a button to a dialog's that opens the guide at a topic, a heading in the user's language."""
    button = buttons.addButton(QDialogButtonBox.StandardButton.Help)
    button.setToolTip(tr("Open the guide"))
    buttons.helpRequested.connect(lambda: show_help(topic))
