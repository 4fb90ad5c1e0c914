"""Groups of entries that are fields of the dock's state."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

from qgis.gui import QgsCollapsibleGroupBoxBasic, QgsFileWidget
from qgis.PyQt.QtCore import QSignalBlocker, pyqtSignal
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
from .start import StartEntry

#: Numbers are taken as typed, and judged in words: what a spin box lets through is far more than what is right.
_MOST = 1e6
#: What the chooser of where cameras face holds for an azimuth.
_AZIMUTH = "azimuth"


class _Access(NamedTuple):
    """How a widget's value is read, entered and listened to."""

    read: Callable[[], Any]
    enter: Callable[[Any], None]
    changed: Any


class WordsLine(QLineEdit):
    """Line for several words, or several names with commas between them."""

    def words(self) -> tuple[str, ...]:
        """Return what is entered."""
        text = self.text()
        parts = text.split(",") if "," in text else text.split()
        return tuple(part.strip() for part in parts if part.strip())

    def enter(self, words: tuple[str, ...]) -> None:
        """Enter words."""
        self.setText((", " if any(" " in word for word in words) else " ").join(words))


class FacingBox(QWidget):
    """Choice of where cameras face, with a number for an azimuth; its value is the text that missions have.

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
        """The value chosen; an azimuth as it was entered, as long as it is the same."""
        if self.choice.currentData() != _AZIMUTH:
            return str(self.choice.currentData())
        shown = f"{self.azimuth.value():.15g}"
        return self._entered if shown == self._shown else shown

    def unread(self) -> str | None:
        """Return what is typed in place of a number of degrees; None where nothing is."""
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
    """Boxes to tick, one for each of several values, below each other.

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
        """Return the values that are ticked; in the order that they were entered in, as long as they are the same."""
        ticked = tuple(value for value, box in self._boxes.items() if box.isChecked())
        return self._entered if set(self._entered) == set(ticked) else ticked

    def enter(self, values: tuple[str, ...]) -> None:
        """Tick values."""
        self._entered = values
        for value, box in self._boxes.items():
            box.setChecked(value in values)


class Entries(QgsCollapsibleGroupBoxBasic):
    """A group of labelled entries, each a field of `FormState`.

    Signals
    -------
    edited(str)
        An entry has changed, named by its field.

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
        """Return what is entered, by field."""
        return {name: access.read() for name, access in self._access.items()}

    def unread(self) -> tuple[tuple[str, str], ...]:
        """Return the fields of numbers that hold another text, each with that; not those that are switched off."""
        found = (
            (name, widget.unread())
            for name, widget in self.entries.items()
            if isinstance(widget, (NumberBox, FacingBox)) and widget.isEnabled()
        )
        return tuple((name, text) for name, text in found if text is not None)

    def forget_unread(self) -> None:
        """Show again the numbers of entries that hold another text."""
        for name, _ in self.unread():
            self._access[name].enter(self._access[name].read())

    def enter(self, state: FormState) -> None:
        """Enter the fields of a state; entries that hold theirs already are left alone, also in mid-typing."""
        for name, access in self._access.items():
            value = getattr(state, name)
            if access.read() != value:
                access.enter(value)

    def show_marked(self, messages: dict[str, str]) -> None:
        """Open where something is said about an entry."""
        if any(name in messages for name in self.entries):
            self.unfold()

    def unfold(self) -> None:
        """Open without that being remembered as the user's wish."""
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
        """Add the entry of a field with its label, inside ``shown`` if that is given; return the row's field."""
        self.take(name, widget)
        field = self._marks.field(name, widget, shown)
        self._form.addRow(label, field)
        return field

    def add_declared(self, name: str, widget: QWidget | None = None) -> QWidget:
        """Add the entry of a field that a mission declares, as it is declared; return the row's field."""
        label = "" if DECLARED[name].kind is bool else field_label(DECLARED[name])
        return self.add(name, label, widget or declared_widget(name))

    def add_two(
        self, label: str, first: str, second: str, widgets: Mapping[str, QWidget], between: str = ""
    ) -> QWidget:
        """Add the entries of two fields in one row, with a sign between them; return the row's field."""
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
        """Show or hide a row, by what `add` returned."""
        show_row(self._form, field, shown)


class Section(Entries):
    """A group that most missions leave as it is: folded until an entry is not the usual one."""

    def __init__(self, name: str, title: str, marks: FieldMarks) -> None:
        super().__init__(name, title, marks)
        self.setCollapsed(True)

    def enter(self, state: FormState) -> None:
        """Enter the fields of a state; opens where that changes one to what is not usual."""
        before, usual = self.values(), FormState()
        super().enter(state)
        if any(value not in (before[name], getattr(usual, name)) for name, value in self.values().items()):
            self.unfold()


def declared_widget(name: str) -> QWidget:
    """Widget for a field that a mission declares, with its title, unit, choices and tip."""
    field = DECLARED[name]
    if field.choices:
        return declared_ticks(name) if field.kind is tuple else declared_choice(name)
    if field.kind is bool:
        return declared_tick(name)
    return declared_number(name) if field.kind in (float, int) else declared_line(name)


def declared_choice(name: str) -> QComboBox:
    """Choice among the values of a field."""
    return combo(name, field_choices(DECLARED[name]), field_tip(DECLARED[name]))


def declared_ticks(name: str) -> TicksBox:
    """Boxes for the values of a field that has several at once."""
    return TicksBox(name, field_choices(DECLARED[name]), field_tip(DECLARED[name]))


def declared_tick(name: str) -> QCheckBox:
    """Box to tick, with the title of a field."""
    return tick(name, field_label(DECLARED[name]), field_tip(DECLARED[name]))


def declared_line(name: str) -> QLineEdit:
    """Line for the text of a field, or for its words."""
    tip = field_tip(DECLARED[name])
    return named(WordsLine(), name, tip) if DECLARED[name].kind is tuple else line_edit(name, tip)


def declared_number(name: str) -> NumberBox:
    """Entry for the number of a field, shares in percent."""
    field, unit = DECLARED[name], DECLARED[name].unit
    is_positive = (field.above is not None and field.above >= 0.0) or (field.least or 0.0) > 0.0
    least, most = (0.0 if is_positive else -_MOST, _MOST) if unit.times == 1.0 else (0.0, unit.times)
    number = spin(name, least, most, unit.decimals if field.kind is float else 0, unit.suffix, field_tip(field))
    number.times = unit.times
    if field.optional and name in ENTERED_AS_DECLARED:
        number.let_be_left_out(least if field.least is None else field.least - 1.0)
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
