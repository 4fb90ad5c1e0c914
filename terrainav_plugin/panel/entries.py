"""Groups of entries; each entry is a field of the panel's state."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

from qgis.gui import QgsCollapsibleGroupBoxBasic, QgsFileWidget
from qgis.PyQt.QtCore import QSignalBlocker, pyqtSignal
from qgis.PyQt.QtGui import QMouseEvent
from qgis.PyQt.QtWidgets import QCheckBox, QComboBox, QHBoxLayout, QLabel, QLineEdit, QVBoxLayout, QWidget

from ...core.mission.parts import NORTH, TRACK
from ..form.fields import field_choices, field_label, field_tip
from ..form.state import DECLARED, ENTERED_AS_DECLARED, FormState
from ..i18n import tr
from ..widgets import (
    FieldMarks,
    NumberBox,
    ShortLine,
    choose,
    combo,
    form_layout,
    line_edit,
    named,
    row,
    show_row,
    spin,
    tick,
)
from .keyboard import fold_button
from .start import StartEntry

#: Largest value of spin boxes, far beyond the valid ones: numbers are accepted as typed, and messages explain errors.
_MOST = 1e6
#: Item of the chooser of the camera's facing that stands for an azimuth.
_AZIMUTH = "azimuth"


class _Access(NamedTuple):
    """Functions to read, enter and observe a widget's value."""

    read: Callable[[], Any]
    enter: Callable[[Any], None]
    changed: Any


class WordsLine(QLineEdit):
    """Line for words separated by spaces, or names separated by commas; neither separates inside of brackets."""

    def words(self) -> tuple[str, ...]:
        """Return the words entered."""
        text = self.text()
        separator = "," if "," in re.sub(r"\([^()]*\)", "", text) else r"\s"
        parts = re.split(separator + r"(?![^()]*\))", text)
        return tuple(part.strip() for part in parts if part.strip())

    def enter(self, words: tuple[str, ...]) -> None:
        """Enter words."""
        self.setText((", " if any(" " in word for word in words) else " ").join(words))


class FacingBox(QWidget):
    """Chooser of the camera's facing, with an entry for an azimuth; its value is the text in a mission.

    Signals
    -------
    changed()
    """

    changed = pyqtSignal()

    def __init__(self, name: str, tip: str) -> None:
        super().__init__()
        items = [(NORTH, tr("North")), (TRACK, tr("Flight direction")), (_AZIMUTH, tr("Azimuth"))]
        self.choice = combo(f"{name}_choice", items, tip)
        self.azimuth = spin(f"{name}_azimuth", -_MOST, _MOST, 2, " °", tip)
        named(self, name, tip)
        self._entered = self._shown = ""
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.choice, 1)
        layout.addWidget(self.azimuth, 1)
        self.setFocusProxy(self.choice)
        self.azimuth.hide()
        self.choice.currentIndexChanged.connect(self._chosen)
        for signal in (self.azimuth.valueChanged, self.azimuth.judged):
            signal.connect(self.changed)

    def text(self) -> str:
        """Value chosen; an azimuth that the user has not changed is returned as entered."""
        if self.choice.currentData() != _AZIMUTH:
            return str(self.choice.currentData())
        shown = f"{self.azimuth.value():.15g}"
        return self._entered if shown == self._shown else shown

    def unread(self) -> str | None:
        """Return the text of the azimuth if it is invalid; None otherwise."""
        return self.azimuth.unread() if self.choice.currentData() == _AZIMUTH else None

    def enter(self, text: str) -> None:
        """Enter a value."""
        if text in (NORTH, TRACK):
            choose(self.choice, text)
            return
        self.azimuth.setValue(float(text))
        choose(self.choice, _AZIMUTH)
        self._entered, self._shown = text, f"{self.azimuth.value():.15g}"

    def _chosen(self) -> None:
        self.azimuth.setVisible(self.choice.currentData() == _AZIMUTH)
        self.changed.emit()


class TicksBox(QWidget):
    """Check boxes for several values, one below the other.

    Signals
    -------
    changed()
    """

    changed = pyqtSignal()

    def __init__(self, name: str, choices: Iterable[tuple[str, str]], tip: str) -> None:
        super().__init__()
        named(self, name, tip)
        self._boxes = {value: tick(f"{name}_{value}", label, tip) for value, label in choices}
        self._entered: tuple[str, ...] = ()
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        for box in self._boxes.values():
            layout.addWidget(box)
            box.toggled.connect(self.changed)
        self.setFocusProxy(next(iter(self._boxes.values())))

    def ticked(self) -> tuple[str, ...]:
        """Return the checked values; until the user changes them, in the order in which they were entered."""
        ticked = tuple(value for value, box in self._boxes.items() if box.isChecked())
        return self._entered if set(self._entered) == set(ticked) else ticked

    def enter(self, values: tuple[str, ...]) -> None:
        """Check values."""
        self._entered = values
        for value, box in self._boxes.items():
            box.setChecked(value in values)


class Entries(QgsCollapsibleGroupBoxBasic):
    """A group of labelled entries, each a field of `FormState`.

    Signals
    -------
    edited(str)
        The user has changed the entry of a field.

    Attributes
    ----------
    entries : dict of str to QWidget
    """

    edited = pyqtSignal(str)

    def __init__(self, name: str, title: str, marks: FieldMarks) -> None:
        super().__init__(title)
        self.setObjectName(name)
        self.entries: dict[str, QWidget] = {}
        self._access: dict[str, _Access] = {}
        self._marks = marks
        self._form = form_layout(self)

    def values(self) -> dict[str, Any]:
        """Return the values of the entries, by field."""
        return {name: access.read() for name, access in self._access.items()}

    def unread(self) -> tuple[tuple[str, str], ...]:
        """Return field and text of each enabled number entry whose text is invalid."""
        found = (
            (name, widget.unread())
            for name, widget in self.entries.items()
            if isinstance(widget, (NumberBox, FacingBox)) and widget.isEnabled()
        )
        return tuple((name, text) for name, text in found if text is not None)

    def forget_unread(self) -> None:
        """Replace invalid texts in number entries by their last valid numbers."""
        for name, _ in self.unread():
            self._access[name].enter(self._access[name].read())

    def enter(self, state: FormState) -> None:
        """Enter the fields of a state; leave entries with the same value alone, as the user may be in one."""
        for name, access in self._access.items():
            value = getattr(state, name)
            if access.read() != value:
                access.enter(value)

    def show_marked(self, messages: dict[str, str]) -> None:
        """Unfold the group for a message at an entry."""
        if any(name in messages for name in self.entries):
            self.unfold()

    def unfold(self) -> None:
        """Unfold the group without storing this as the user's choice."""
        if self.isCollapsed():
            with QSignalBlocker(self):
                self.setCollapsed(False)

    def take(self, name: str, widget: QWidget) -> None:
        """Make a widget the entry of a field."""
        access = _access(widget)
        self.entries[name] = widget
        self._access[name] = access
        access.changed.connect(lambda *_: self.edited.emit(name))
        if isinstance(widget, NumberBox):
            widget.judged.connect(lambda: self.edited.emit(name))

    def add(self, name: str, label: str, widget: QWidget, shown: QWidget | None = None) -> QWidget:
        """Add the entry of a field with its label, inside ``shown`` if given; return the row's widget."""
        self.take(name, widget)
        field = self._marks.field(name, widget, shown)
        self._form.addRow(label, field)
        return field

    def add_declared(self, name: str, widget: QWidget | None = None) -> QWidget:
        """Add the entry of a declared field; return the row's widget."""
        label = "" if DECLARED[name].kind is bool else field_label(DECLARED[name])
        return self.add(name, label, widget or declared_widget(name))

    def add_two(
        self, label: str, first: str, second: str, widgets: Mapping[str, QWidget], between: str = ""
    ) -> QWidget:
        """Add the entries of two fields in one row, separated by ``between``; return the row's widget."""
        pair = (widgets[first], widgets[second])
        signs = [QLabel(between)] if between else []
        numbers = [index for index in (0, 1) if isinstance(pair[index], NumberBox)]
        shown = row(pair[0], *signs, pair[1], stretch=[index * (1 + len(signs)) for index in numbers])
        for name, widget in zip((first, second), pair):
            self.take(name, widget)
        field = self._marks.field(second, pair[1], self._marks.field(first, pair[0], shown))
        self._form.addRow(label, field)
        return field

    def show_row(self, field: QWidget, shown: bool) -> None:
        """Show or hide a row, given the widget from `add`."""
        show_row(self._form, field, shown)


class Section(Entries):
    """A group of less common entries: folded unless an entry differs from its default.

    Signals
    -------
    opened()
        The user has unfolded the group.
    """

    opened = pyqtSignal()

    def __init__(self, name: str, title: str, marks: FieldMarks) -> None:
        super().__init__(name, title, marks)
        self.setCollapsed(True)
        fold = fold_button(self)
        if fold is not None:
            fold.clicked.connect(self._folded)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Fold or unfold the group by a click on its title."""
        was_collapsed = self.isCollapsed()
        super().mouseReleaseEvent(event)
        if was_collapsed:
            self._folded()

    def _folded(self, *_: object) -> None:
        if not self.isCollapsed():
            self.opened.emit()

    def enter(self, state: FormState) -> None:
        """Enter the fields of a state; unfold the group if an entry changes to a value other than its default."""
        before, usual = self.values(), FormState()
        super().enter(state)
        if any(value not in (before[name], getattr(usual, name)) for name, value in self.values().items()):
            self.unfold()


def declared_widget(name: str) -> QWidget:
    """Widget for a declared field, with title, unit, choices and tip."""
    field = DECLARED[name]
    if field.choices:
        return declared_ticks(name) if field.kind is tuple else declared_choice(name)
    if field.kind is bool:
        return declared_tick(name)
    return declared_number(name) if field.kind in (float, int) else declared_line(name)


def declared_choice(name: str) -> QComboBox:
    """Combo box of a field's values."""
    return combo(name, field_choices(DECLARED[name]), field_tip(DECLARED[name]))


def declared_ticks(name: str) -> TicksBox:
    """Check boxes for a field with several values."""
    return TicksBox(name, field_choices(DECLARED[name]), field_tip(DECLARED[name]))


def declared_tick(name: str) -> QCheckBox:
    """Check box with a field's title."""
    return tick(name, field_label(DECLARED[name]), field_tip(DECLARED[name]))


def declared_line(name: str) -> QLineEdit:
    """Line for the text or words of a field."""
    tip = field_tip(DECLARED[name])
    return named(WordsLine(), name, tip) if DECLARED[name].kind is tuple else line_edit(name, tip)


def declared_number(name: str) -> NumberBox:
    """Number box of a field; shares are shown in percent."""
    field, unit = DECLARED[name], DECLARED[name].unit
    is_positive = (field.above is not None and field.above >= 0.0) or (field.least or 0.0) > 0.0
    least, most = (0.0 if is_positive else -_MOST, _MOST) if unit.times == 1.0 else (0.0, unit.times)
    number = spin(name, least, most, unit.decimals if field.kind is float else 0, unit.suffix, field_tip(field))
    number.times = unit.times
    if field.optional and name in ENTERED_AS_DECLARED:
        number.allow_unset(least if field.least is None else field.least - 1.0)
    return number


def _access(widget: QWidget) -> _Access:
    if isinstance(widget, FacingBox):
        return _Access(widget.text, widget.enter, widget.changed)
    if isinstance(widget, TicksBox):
        return _Access(widget.ticked, widget.enter, widget.changed)
    if isinstance(widget, QComboBox):
        return _Access(widget.currentData, lambda value: choose(widget, value), widget.currentIndexChanged)
    if isinstance(widget, QCheckBox):
        return _Access(widget.isChecked, widget.setChecked, widget.toggled)
    if isinstance(widget, NumberBox):
        return _Access(widget.number, widget.enter, widget.valueChanged)
    if isinstance(widget, QgsFileWidget):
        return _Access(widget.filePath, widget.setFilePath, widget.fileChanged)
    if isinstance(widget, WordsLine):
        return _Access(widget.words, widget.enter, widget.textChanged)
    if isinstance(widget, ShortLine):
        return _Access(lambda: widget.whole().strip(), widget.enter, widget.textChanged)
    if isinstance(widget, StartEntry):
        return _Access(widget.text, widget.enter, widget.changed)
    if isinstance(widget, QLineEdit):
        return _Access(lambda: widget.text().strip(), widget.setText, widget.textChanged)
    raise TypeError(f"{type(widget).__name__}: not a widget that entries know")
