"""Widgets that forms are made of, and what is said at their fields."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar

from qgis.gui import (
    QgisInterface,
    QgsCollapsibleGroupBoxBasic,
    QgsDockWidget,
    QgsDoubleSpinBox,
    QgsFileWidget,
)
from qgis.PyQt.QtCore import QLocale, QPoint, QSize, Qt, pyqtSignal
from qgis.PyQt.QtGui import (
    QColor,
    QFocusEvent,
    QIcon,
    QKeySequence,
    QPainter,
    QPaintEvent,
    QPalette,
    QResizeEvent,
    QValidator,
    QWheelEvent,
)
from qgis.PyQt.QtWidgets import (
    QAbstractButton,
    QAbstractSpinBox,
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QMenuBar,
    QPushButton,
    QScrollArea,
    QStyle,
    QStyleOptionFrame,
    QTabBar,
    QToolButton,
    QToolTip,
    QVBoxLayout,
    QWidget,
)

from ..core.text.plain import shortened
from .i18n import localized, plain_number, tr
from .plain import plain_label, shown_plain

#: Vermillion of the Okabe-Ito palette: readable on light and dark themes, distinct to colour-blind people.
WRONG_COLOUR = "#D55E00"
#: Share of that colour behind the text of a spin box.
_TINT = 0.3
_WRONG = "terrainavWrong"
#: Entries that have room beside them for what is wrong.
_BESIDE = "terrainavBeside"
#: Numbers of no more decimals are shown as they are, as they may have been typed; of others these many digits.
_TYPED_DECIMALS, _READ_DIGITS = 6, 5
STYLE_SHEET = f"""
QLineEdit[{_WRONG}="true"], QComboBox[{_WRONG}="true"] {{
    border: 2px solid {WRONG_COLOUR};
    border-radius: 3px;
}}
QLabel[terrainavMark="true"] {{ color: {WRONG_COLOUR}; }}
QLabel[terrainavMark="true"]:disabled {{ color: palette(mid); }}
"""
#: What people let an entry add up or multiply.
_SUM = re.compile(r"[-+*/^().\d\s]{3,100}")
#: Characters of a text that its tooltip shows, and of one that is measured: screens are no wider.
_MOST_TIP, _MOST_MEASURED = 200, 10_000
#: A text with an underlined letter, and what gives it another.
_Text = tuple[str, Callable[[str], None]]
_Made = TypeVar("_Made", bound=QWidget)
_Box = TypeVar("_Box", bound="NumberBox")


def named(widget: _Made, name: str, tip: str = "") -> _Made:
    """Widget with the name that it is found by, and with its tip."""
    widget.setObjectName(name)
    widget.setToolTip(tip)
    return widget


def box_contents(box: QgsCollapsibleGroupBoxBasic) -> QWidget:
    """Widget for all that a group box holds.

    Unfolding a group shows all that is right inside it, also what is to be hidden.
    """
    contents = QWidget(box)
    around = QVBoxLayout(box)
    around.setContentsMargins(0, 0, 0, 0)
    around.addWidget(contents)
    return contents


def form_layout(box: QgsCollapsibleGroupBoxBasic) -> QFormLayout:
    """Layout of labelled entries for a group box."""
    form = growing_form(box_contents(box))
    form.setVerticalSpacing(4)
    # With large letters, a label stands above its entry where there is no room for both.
    form.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapLongRows)
    return form


def growing_form(parent: QWidget | None = None) -> QFormLayout:
    """Layout of labelled entries that grow with the window."""
    form = QFormLayout(parent)
    form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
    return form


def show_row(form: QFormLayout, field: QWidget, shown: bool) -> None:
    """Show or hide a row of a form, by its entry."""
    for part in (field, form.labelForField(field)):
        if part is not None:
            part.setVisible(shown)


def scrolled(contents: QWidget) -> QScrollArea:
    """Widget in an area that is scrolled where it is too small for it."""
    scroll = QScrollArea()
    scroll.setWidgetResizable(True)
    scroll.setFrameShape(QFrame.Shape.NoFrame)
    scroll.setWidget(contents)
    return scroll


def row(*widgets: QWidget, stretch: int | Sequence[int] = ()) -> QWidget:
    """Widgets side by side; those numbered in ``stretch`` share the room left."""
    holder = QWidget()
    layout = QHBoxLayout(holder)
    layout.setContentsMargins(0, 0, 0, 0)
    wide = (stretch,) if isinstance(stretch, int) else stretch
    for index, widget in enumerate(widgets):
        layout.addWidget(widget, 1 if index in wide else 0)
    holder.setFocusProxy(widgets[0])
    return holder


def wrapped_label(name: str) -> QLabel:
    """Label of any text, in as many lines as that takes, for users to copy from."""
    label = named(plain_label(), name)
    label.setWordWrap(True)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    return label


def push_button(name: str, text: str, tip: str, image: QIcon | None = None) -> QPushButton:
    """Button that no other key than its own presses."""
    made = named(QPushButton(text) if image is None else QPushButton(image, text), name, tip)
    made.setAutoDefault(False)
    return made


def tool_button(name: str, image: QIcon, tip: str, text: str = "") -> QToolButton:
    """Button with an image, and with a text beside it where there is one."""
    made = named(QToolButton(), name, tip)
    made.setIcon(image)
    if text:
        made.setText(text)
        made.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
    return made


def line_edit(name: str, tip: str, placeholder: str = "") -> QLineEdit:
    """Entry for a text, and what it shows while it is empty."""
    made = named(QLineEdit(), name, tip)
    made.setPlaceholderText(placeholder)
    return made


class ShortLine(QLineEdit):
    """Entry for a text that is shown shorter than it is, and stays whole until it is edited.

    Where not all of it can be seen, the tooltip begins with it.

    Parameters
    ----------
    shorten : callable
        Text as people read it.
    """

    def __init__(self, shorten: Callable[[str], str]) -> None:
        super().__init__()
        self._shorten = shorten
        self._whole = self._shown = self._tip = ""
        self.textEdited.connect(self._forget)
        self.textChanged.connect(self._show_tip)

    def setToolTip(self, tip: str) -> None:
        """Say what the entry is for."""
        self._tip = tip
        self._show_tip()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Show the first digits of what was typed."""
        super().focusOutEvent(event)
        self.setCursorPosition(0)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """See whether all of the text is to be seen."""
        super().resizeEvent(event)
        self._show_tip()

    def whole(self) -> str:
        """Return what is entered."""
        return self._whole if self._whole and self.text() == self._shown else self.text()

    def enter(self, text: str) -> None:
        """Enter a text; one that is there already stays as it was typed."""
        if text == self.whole():
            return
        self._whole, self._shown = text, self._shorten(text)
        self.setText(self._shown)
        # Long numbers show their first digits.
        self.setCursorPosition(0)

    def _forget(self) -> None:
        self._whole = ""

    def _show_tip(self, *_: object) -> None:
        whole, text = self.whole(), self.text()
        option = QStyleOptionFrame()
        self.initStyleOption(option)
        room = self.style().subElementRect(QStyle.SubElement.SE_LineEditContents, option, self).width()
        # Qt leaves two pixels on either side of the text, and one for the cursor.
        # An entry leaves 5 px free beside its text.
        is_cut = self.fontMetrics().horizontalAdvance(text[:_MOST_MEASURED]) > room - 5
        begins = f"{whole[:_MOST_TIP]}\n" if whole != text or is_cut else ""
        super().setToolTip(shown_plain(begins + self._tip))


class ElidedLabel(QLabel):
    """A line that is cut where the panel is narrow; the tooltip has all of it.

    Parameters
    ----------
    mode : Qt.TextElideMode
        Where it is cut.
    least : int
        Characters that there is always room for.
    """

    def __init__(self, mode: Qt.TextElideMode, least: int) -> None:
        super().__init__()
        self._mode, self._least = mode, least
        self.setTextFormat(Qt.TextFormat.PlainText)

    def say(self, text: str) -> None:
        """Show a text."""
        self.setText(text)
        self.setToolTip(shown_plain(text))

    def minimumSizeHint(self) -> QSize:
        """Room for some characters."""
        metrics = self.fontMetrics()
        wide = min(metrics.averageCharWidth() * self._least, metrics.horizontalAdvance(self.text()))
        return QSize(wide, super().minimumSizeHint().height())

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw what there is room for."""
        painter = QPainter(self)
        text = self.fontMetrics().elidedText(self.text(), self._mode, self.width())
        alignment = int(Qt.AlignmentFlag.AlignLeft) | int(Qt.AlignmentFlag.AlignVCenter)
        self.style().drawItemText(
            painter, self.rect(), alignment, self.palette(), self.isEnabled(), text, self.foregroundRole()
        )


def folder_entry(name: str, title: str, tip: str) -> QgsFileWidget:
    """Entry for a folder, which a dialog of that title is there to choose."""
    made = named(QgsFileWidget(), name, tip)
    made.setStorageMode(QgsFileWidget.StorageMode.GetDirectory)
    made.setDialogTitle(title)
    # A label's key goes to what is typed into.
    made.setFocusProxy(made.lineEdit())
    return made


def ok_and_cancel(dialog: QDialog) -> QDialogButtonBox:
    """Buttons that accept and reject a dialog."""
    standard = QDialogButtonBox.StandardButton
    made = QDialogButtonBox(standard.Ok | standard.Cancel)
    made.accepted.connect(lambda: first_problem(dialog) or dialog.accept())
    made.rejected.connect(dialog.reject)
    return made


def first_problem(form: QWidget) -> str:
    """Return what is wrong with the first entry of a number that counts, and go there; empty where all are right."""
    for box in form.findChildren(NumberBox):
        if box.isEnabled() and box.isVisibleTo(form) and box.problem():
            box.setFocus()
            box.say_problem()
            return box.problem()
    return ""


class Chooser(QComboBox):
    """A chooser that a wheel turns only when it has been entered: otherwise the panel is scrolled."""

    def __init__(self) -> None:
        super().__init__()
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Choose, or leave the wheel to the panel."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()


def combo(name: str, items: Sequence[tuple[str, str]], tip: str) -> QComboBox:
    """Chooser of (value, label) pairs."""
    combo = named(Chooser(), name, tip)
    combo.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
    combo.setMinimumContentsLength(3)
    for value, label in items:
        combo.addItem(label, value)
    return combo


def tick(name: str, text: str, tip: str) -> QCheckBox:
    """Box to tick."""
    return named(QCheckBox(text), name, tip)


class NumberBox(QgsDoubleSpinBox):
    """A spin box that takes every text as it is typed, and shows no zeros a person would not write.

    A text that is no number of its range stays, for its user to be told: nothing is read out of it, and nothing else
    put in its place.

    Signals
    -------
    judged()
        The text is no number any more, another one that is none, or a number again.

    Attributes
    ----------
    times : float
        What the dock's state is multiplied by to be shown: 100 for a share in percent.
    may_be_left_out : bool
        Whether the least value stands for no number.
    """

    judged = pyqtSignal()
    times: float = 1.0
    may_be_left_out: bool = False
    #: While it is made, and while a number is entered, what it shows is nothing that was typed.
    _is_typed_into: bool = False

    def __init__(self) -> None:
        super().__init__()
        self._judged: str | None = None
        #: Text that was looked at last, and what came of it: forms ask for all their entries at every key.
        self._checked_features: tuple[str, str | None] = ("", None)
        self._is_typed_into = True
        self.lineEdit().textChanged.connect(self._judge)
        self.editingFinished.connect(self.say_problem)

    def let_be_left_out(self, below: float) -> None:
        """Have a value below all that is right stand for no number, and be shown as such."""
        self.may_be_left_out = True
        self.setMinimum(below)
        self.setSpecialValueText(tr("not set"))

    def unread(self) -> str | None:
        """Return a text that is no number of the range; None where it is one."""
        if not self._is_typed_into:
            return None
        shown = self.lineEdit().text()
        if shown != self._checked_features[0] or not shown:
            text = self._typed(shown)
            self._checked_features = shown, text if self._read(text) is None else None
        return self._checked_features[1]

    def problem(self) -> str:
        """Say what is wrong with what is typed; empty where it is a number of the range."""
        text = self.unread()
        if text is None:
            return ""
        try:
            value = plain_number(text)
        except ValueError:
            return tr("“{text}”: must be a number").format(text=text)
        if not self.decimals() and value != int(value):
            return tr("“{text}”: must be a whole number").format(text=text)
        least, most = (localized(f"{end:.15g}") for end in (self.minimum(), self.maximum()))
        if self.may_be_left_out:
            right = tr("“{text}”: must be above {least} and at most {most}, or empty")
        else:
            right = tr("“{text}”: must be from {least} to {most}")
        return right.format(text=text, least=least, most=most)

    def say_problem(self) -> None:
        """Say what is wrong where no form has room for it beside the entry."""
        if self.problem() and not self.property(_BESIDE):
            QToolTip.showText(self.mapToGlobal(QPoint(0, self.height())), shown_plain(self.problem()), self)

    def validate(self, text: str, *position: int) -> tuple[Any, ...]:
        """Let everything be typed."""
        if position:
            return QValidator.State.Acceptable, text, *position
        # QGIS hands over no position, and wants it back: behind the prefix that Qt has put before what was typed.
        line = self.lineEdit()
        before = 0 if line.text().startswith(self.prefix()) else len(self.prefix())
        return QValidator.State.Acceptable, line.cursorPosition() + before

    def setValue(self, value: float) -> None:
        """Enter a number, in place of whatever has been typed."""
        with self._entering():
            super().setValue(value)

    def stepBy(self, steps: int) -> None:
        """Step from the last number that was read."""
        with self._entering():
            super().stepBy(steps)

    def textFromValue(self, value: float) -> str:
        """Text of a number; where something else is typed, that."""
        typed = self.unread() if self._is_typed_into else None
        if typed is not None and value == self.value():
            return typed
        text = super().textFromValue(value)
        point = self.locale().decimalPoint()
        return text.rstrip("0").rstrip(point) if point in text else text

    def valueFromText(self, text: str) -> float:
        """Number of a text; of one that is none the last number, but never one that says that there is none."""
        value = self._read(self._typed(text))
        if value is not None:
            return value
        left_out = self.may_be_left_out and self.value() == self.minimum()
        return self.minimum() + 1.0 if left_out else self.value()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Step only where the box has been entered: otherwise the panel is scrolled."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()

    def number(self) -> float | int | None:
        """Number entered, an int where no decimals are taken; None where there is none."""
        if self.may_be_left_out and (self.value() == self.minimum() or self.unread() is not None):
            return None
        return self.value() / self.times if self.decimals() else int(self.value())

    def enter(self, number: float | None) -> None:
        """Show what `number` returns then, to the decimals there are and the digits that people read."""
        self.setValue(self.minimum() if number is None else short_number(number * self.times))

    def _typed(self, text: str) -> str:
        """Text without what stands before and behind it by itself, and a unit that was typed all the same."""
        prefix, suffix = self.prefix().strip(), self.suffix().strip()
        text = text.strip().removeprefix(prefix).removesuffix(suffix).strip()
        return text.removesuffix(suffix).strip()

    def _read(self, text: str) -> float | None:
        """Number of a text, in the range and to the decimals there are; None where it is none."""
        if self.may_be_left_out and text in ("", self.specialValueText()):
            return self.minimum()
        value = self._number(text)
        if value is not None and self.decimals():
            # What is not shown does not count.
            value = round(value, self.decimals())
        if value is None or not self.minimum() <= value <= self.maximum():
            return None
        left_out = self.may_be_left_out and value == self.minimum()
        return None if left_out or (not self.decimals() and value != int(value)) else value

    def _number(self, text: str) -> float | None:
        """Number of a text, or what a sum of numbers comes to; None where it is neither."""
        if not self.locale().numberOptions() & QLocale.NumberOption.OmitGroupSeparator:
            # Where QGIS keeps thousands apart in what it shows, they are when that is read.
            value, is_number = self.locale().toDouble(text)
            if is_number:
                return value
        try:
            return plain_number(text)
        except ValueError:
            return _result(text) if _SUM.fullmatch(text) else None

    @contextmanager
    def _entering(self) -> Iterator[None]:
        self._is_typed_into = False
        try:
            yield
        finally:
            self._is_typed_into = True
            self._judge()

    def _judge(self, *_: object) -> None:
        """Tell whether what is typed is a number, where that has changed."""
        unread = self.unread()
        if unread != self._judged:
            self._judged = unread
            self.judged.emit()
            if not self.property(_BESIDE):
                _mark(self, unread is not None)


class WholeBox(NumberBox):
    """A spin box of whole numbers."""

    def value(self) -> int:
        """Return what is entered."""
        return int(super().value())


def _result(text: str) -> float | None:
    """Result of a sum of numbers, as QGIS works it out; None for none."""
    from qgis.core import QgsExpression

    value = QgsExpression(text).evaluate()
    return float(value) if isinstance(value, (int, float)) and math.isfinite(value) else None


def short_number(value: float) -> float:
    """Number with the digits that people read, where it has more than they type: 330.26666… is shown as 330.27."""
    if not math.isfinite(value) or round(value, _TYPED_DECIMALS) == value:
        return value
    before = math.floor(math.log10(abs(value))) + 1
    return round(value, max(_READ_DIGITS - before, 1))


def spin(name: str, least: float, most: float, decimals: int, suffix: str, tip: str) -> NumberBox:
    """Entry for a number with a unit."""
    made = _number_box(named(NumberBox(), name, tip), least, most, decimals)
    made.setSuffix(suffix)
    made.setStepType(QAbstractSpinBox.StepType.AdaptiveDecimalStepType)
    return made


def whole_spin(name: str, least: int, most: int, tip: str) -> WholeBox:
    """Entry for a whole number of a range."""
    return _number_box(named(WholeBox(), name, tip), least, most, 0)


def _number_box(made: _Box, least: float, most: float, decimals: int) -> _Box:
    made.setDecimals(decimals)
    made.setRange(least, most)
    # Shows a number from the start: what an empty entry shows would be taken for typed.
    made.setValue(made.value())
    made.setShowClearButton(False)
    made.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    return made


def choose(combo: QComboBox, value: object) -> None:
    """Select the item with this data; an unknown one leaves the first."""
    combo.setCurrentIndex(max(combo.findData(value), 0))


class FieldMessage(QLabel):
    """Text as high as its lines need; layouts forget about that where widgets are nested."""

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Make room for the lines there are at this width."""
        super().resizeEvent(event)
        self._fit()

    def say(self, text: str) -> None:
        """Show a text, or nothing."""
        self.setTextFormat(Qt.TextFormat.PlainText)
        # A few lines below a field.
        self.setText(shortened(text, 1000))
        self.setVisible(bool(text))
        self._fit()

    def _fit(self) -> None:
        self.setMinimumHeight(self.heightForWidth(self.width()) if self.text() else 0)


class FieldMarks:
    """The named fields of a form; marks those that hold a bad value, in words below the field."""

    def __init__(self) -> None:
        self._fields: dict[str, tuple[QWidget, FieldMessage]] = {}

    def field(self, name: str, widget: QWidget, shown: QWidget | None = None) -> QWidget:
        """Widget, or ``shown`` which holds it, with the room for its message, to put into a layout."""
        holder = QWidget()
        layout = QVBoxLayout(holder)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(1)
        layout.addWidget(shown or widget)
        layout.addWidget(self.label(name, widget))
        # Qt lets a label's key go only to what takes the keyboard; Tab passes over what has a proxy. Set before that,
        # which would get this policy, too.
        holder.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        holder.setFocusProxy(shown or widget)
        return holder

    def label(self, name: str, widget: QWidget) -> FieldMessage:
        """Label for the message of a field, where it cannot stand right below."""
        label = named(FieldMessage(), f"{name}_message")
        label.setProperty("terrainavMark", "true")
        label.setWordWrap(True)
        label.hide()
        self._fields[name] = (widget, label)
        widget.setProperty(_BESIDE, "true")
        return label

    def show(self, messages: dict[str, str]) -> None:
        """Mark the fields in ``messages`` and unmark all others."""
        for name, (widget, label) in self._fields.items():
            text = messages.get(name, "")
            label.say(text)
            if text or widget.property(_WRONG):
                _mark(widget, bool(text))

    def message(self, name: str) -> str:
        """Return what is said about a field; empty where it is right."""
        return self._fields[name][1].text()

    def hidden(self) -> tuple[str, ...]:
        """Return the fields whose rows are hidden, wherever the form is folded."""
        return tuple(name for name, (_, label) in self._fields.items() if _is_hidden(label.parentWidget()))

    def out_of_sight(self, messages: dict[str, str]) -> str:
        """Return what is said in ``messages`` about fields that nobody can see; empty for nothing."""
        hidden = self.hidden()
        texts = (text for name, text in messages.items() if name not in self._fields or name in hidden)
        return "\n".join(texts)

    def fields(self) -> list[tuple[QWidget, QLabel]]:
        """Fields and the labels for their messages."""
        return list(self._fields.values())

    def first_message(self) -> str:
        """Return what is wrong with the first field that is marked; empty where none is."""
        return next((label.text() for _, label in self._fields.values() if label.text()), "")


def free_of_menus(panel: QWidget, menus: QMenuBar) -> None:
    """Take back the letters of a panel that open a menu, which plugins and languages add to, or that come twice."""
    taken = {mnemonic_key(action.text()) for action in menus.actions() if action.isVisible()}
    for text, change in list(_texts(panel)):
        letter = mnemonic_key(text)
        if letter and letter in taken:
            change(text.replace("&", "", 1))
        taken.add(letter)


def add_floating(panel: QgsDockWidget, iface: QgisInterface, size_px: tuple[int, int]) -> None:
    """Add a window over the map's corner, whole on the screen."""
    window = iface.mainWindow()
    free_of_menus(panel, window.menuBar())
    # Floating before it is added: a wide one would widen the panels that it is put beside for good.
    panel.setParent(window)
    panel.setFloating(True)
    iface.addDockWidget(Qt.DockWidgetArea.LeftDockWidgetArea, panel)
    # A little into the map.
    corner = iface.mapCanvas().mapToGlobal(QPoint(12, 36))
    screen = window.screen().availableGeometry()
    wide, high = min(size_px[0], screen.width()), min(size_px[1], screen.height())
    left = max(min(corner.x(), screen.right() - wide), screen.left())
    # The window's own title comes on top.
    panel.setGeometry(left, max(min(corner.y(), screen.bottom() - high), screen.top()), wide, high)


def add_docked(panel: QgsDockWidget, iface: QgisInterface, beside: str) -> None:
    """Add a window to those on the right of the map, in front of one by name: no part of the map is covered."""
    window = iface.mainWindow()
    free_of_menus(panel, window.menuBar())
    iface.addDockWidget(Qt.DockWidgetArea.RightDockWidgetArea, panel)
    other = window.findChild(QgsDockWidget, beside)
    if other is not None and other.isVisible() and not other.isFloating():
        window.tabifyDockWidget(other, panel)
    panel.show()
    panel.raise_()


def mnemonic_key(text: str) -> str:
    """Key that a text's underlined letter stands for, as ``Alt+F``; empty where there is none."""
    return QKeySequence.mnemonic(text).toString()


def _is_hidden(part: QWidget) -> bool:
    """Whether a part of a form is hidden, or something that it is in: not where it is only folded with its group."""
    around = part.parentWidget()
    while around is not None and not isinstance(around, QgsCollapsibleGroupBoxBasic):
        if part.isHidden():
            return True
        part, around = around, around.parentWidget()
    return False


def _mark(widget: QWidget, wrong: bool) -> None:
    widget.setProperty(_WRONG, "true" if wrong else "")
    if isinstance(widget, QAbstractSpinBox):
        # A frame by style sheet would spoil the arrows.
        palette = QPalette()
        if wrong:
            palette.setColor(QPalette.ColorRole.Base, _tinted(palette.color(QPalette.ColorRole.Base)))
        for part in (widget, widget.findChild(QLineEdit)):
            part.setPalette(palette)
    else:
        widget.style().unpolish(widget)
        widget.style().polish(widget)


def _tinted(base: QColor) -> QColor:
    """Colour on the way from a theme's own to that of what is wrong."""
    wrong = QColor(WRONG_COLOUR)
    parts = zip(base.getRgb()[:3], wrong.getRgb()[:3])
    return QColor(*(round((1.0 - _TINT) * own + _TINT * other) for own, other in parts))


def _texts(panel: QWidget) -> Iterator[_Text]:
    for widget in panel.findChildren(QWidget):
        if isinstance(widget, QAbstractButton) or (isinstance(widget, QLabel) and widget.buddy() is not None):
            yield widget.text(), widget.setText
        elif isinstance(widget, QTabBar):
            for index in range(widget.count()):
                yield widget.tabText(index), lambda text, bar=widget, at=index: bar.setTabText(at, text)
