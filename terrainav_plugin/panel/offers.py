"""Line for names of sources or files, with a menu that offers some."""

from __future__ import annotations

from qgis.PyQt.QtWidgets import QFileDialog, QMenu, QToolButton

from ..i18n import tr
from ..widgets import named
from .entries import WordsLine


class OfferedLine(WordsLine):
    """Line for names separated by semicolons, as paths may contain spaces and commas; a button offers names.

    Parameters
    ----------
    name : str
        Field of the entry.
    tip, button_tip : str

    Attributes
    ----------
    button : QToolButton
    """

    _SEPARATOR = ";"

    def __init__(self, name: str, tip: str, button_tip: str) -> None:
        super().__init__()
        named(self, name, tip)
        self.button = named(QToolButton(), f"{name}_choose", button_tip)
        self.button.setText("…")
        self.button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self._menu = QMenu(self.button)
        self._menu.aboutToShow.connect(self._fill)
        self.button.setMenu(self._menu)

    def words(self) -> tuple[str, ...]:
        """Return the names entered."""
        return tuple(filter(None, map(str.strip, self.text().split(self._SEPARATOR))))

    def enter(self, words: tuple[str, ...]) -> None:
        """Enter names."""
        self.setText(f"{self._SEPARATOR} ".join(words))

    def _fill(self) -> None:
        """Fill the menu with what is offered now."""
        raise NotImplementedError

    def _choose_file(self, title: str, kinds: str) -> None:
        """Let the user choose a file, and add it."""
        path, _ = QFileDialog.getOpenFileName(self, title, "", kinds)
        if path:
            self.enter((*self.words(), path))

    def _offer_none(self) -> None:
        """Offer to clear the line, if there is something in it."""
        if self.words():
            self._menu.addSeparator()
            self._menu.addAction(tr("None"), self.clear)
