"""Underlined letters of panels: a panel shares QGIS's window, and with it the Alt key, with QGIS's own menus."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from qgis.PyQt.QtGui import QKeySequence
from qgis.PyQt.QtWidgets import QAbstractButton, QLabel, QMenuBar, QTabBar, QWidget

#: A text with an underlined letter, and what gives it another.
_Text = tuple[str, Callable[[str], None]]


def free_of_menus(panel: QWidget, menus: QMenuBar) -> None:
    """Take back the letters of a panel that open a menu, which plugins and languages add to, or that come twice."""
    taken = {letter_of(action.text()) for action in menus.actions() if action.isVisible()}
    for text, change in list(_texts(panel)):
        letter = letter_of(text)
        if letter and letter in taken:
            change(text.replace("&", "", 1))
        taken.add(letter)


def letter_of(text: str) -> str:
    """Key that a text's underlined letter stands for, as ``Alt+F``; empty where there is none."""
    return QKeySequence.mnemonic(text).toString()


def _texts(panel: QWidget) -> Iterator[_Text]:
    for widget in panel.findChildren(QWidget):
        if isinstance(widget, QAbstractButton) or (isinstance(widget, QLabel) and widget.buddy() is not None):
            yield widget.text(), widget.setText
        elif isinstance(widget, QTabBar):
            for index in range(widget.count()):
                yield widget.tabText(index), lambda text, bar=widget, at=index: bar.setTabText(at, text)
