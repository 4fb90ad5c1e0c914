"""The order of the Tab key: as the eye reads a form."""

from __future__ import annotations

from collections.abc import Iterator

from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtWidgets import QGridLayout, QLayout, QLayoutItem, QWidget


def set_tab_order(layout: QLayout) -> None:
    """Let the Tab key follow the rows of a layout, and of those inside it."""
    widgets = list(_in_order(layout))
    for before, after in zip(widgets, widgets[1:]):
        QWidget.setTabOrder(before, after)


def _in_order(layout: QLayout) -> Iterator[QWidget]:
    """Widgets that take the keyboard, line by line."""
    for item in _items(layout):
        widget, inner = item.widget(), item.layout()
        if widget is not None:
            if widget.focusProxy() is None and widget.focusPolicy() & Qt.FocusPolicy.TabFocus:
                yield widget
            inner = widget.layout()
        if inner is not None:
            yield from _in_order(inner)


def _items(layout: QLayout) -> list[QLayoutItem]:
    """Items of a layout; those of a grid by line and column."""
    numbers = range(layout.count())
    if isinstance(layout, QGridLayout):
        places = sorted((layout.getItemPosition(number)[:2], number) for number in numbers)
        numbers = [number for _, number in places]
    return [layout.itemAt(number) for number in numbers]
