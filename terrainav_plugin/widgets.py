"""Widgets of forms, and messages at their fields."""

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
from qgis.PyQt.QtCore import QPoint, QSize, Qt, pyqtSignal
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
    QDockWidget,
    QFormLayout,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QMenu,
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

#: Vermillion of the Okabe-Ito palette: seen on light and dark themes, distinct to colour-blind people. Texts keep the
#: theme's colour: on a grey theme, no other has the contrast to be read.
WRONG_COLOUR = "#D55E00"
_WRONG = "terrainavWrong"
#: Property of entries that have a label for their message.
_BESIDE = "terrainavBeside"
STYLE_SHEET = f"""
QLineEdit[{_WRONG}="true"], QComboBox[{_WRONG}="true"] {{
    border: 2px solid {WRONG_COLOUR};
    border-radius: 3px;
}}
QLabel[terrainavMark="true"] {{ border: none; border-left: 3px solid {WRONG_COLOUR}; padding-left: 4px; }}
QLabel[terrainavMark="true"]:disabled {{ color: palette(mid); }}
"""
#: Text of a formula that a number entry evaluates.
_SUM = re.compile(r"[-+*/^().\d\s]{3,100}")
#: A text with an underlined letter, and a function that sets its text.
_Text = tuple[str, Callable[[str], None]]
_Made = TypeVar("_Made", bound=QWidget)
_Box = TypeVar("_Box", bound="NumberBox")


def named(widget: _Made, name: str, tip: str = "") -> _Made:
    """Set the object name and tooltip of a widget, and return the widget."""
    widget.setObjectName(name)
    widget.setToolTip(tip)
    return widget


def box_contents(box: QgsCollapsibleGroupBoxBasic) -> QWidget:
    """Widget for the contents of a group box.

    The entries must not be direct children of the group: unfolding shows all of these, also those to stay hidden.
    """
    contents = QWidget(box)
    around = QVBoxLayout(box)
    around.setContentsMargins(0, 0, 0, 0)
    around.addWidget(contents)
    return contents


def form_layout(box: QgsCollapsibleGroupBoxBasic) -> QFormLayout:
    """Form layout for a group box."""
    form = growing_form(box_contents(box))
    # Compact rows, as the panel is to show a whole tab on a small screen.
    form.setVerticalSpacing(2)
    form.setContentsMargins(9, 0, 9, 2)
    # With a large font, put a label above its entry if both do not fit in a row.
    form.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapLongRows)
    return form


def growing_form(parent: QWidget | None = None) -> QFormLayout:
    """Form layout whose entries grow with the window."""
    form = QFormLayout(parent)
    form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
    return form


def show_row(form: QFormLayout, field: QWidget, shown: bool) -> None:
    """Show or hide the row of a form that holds an entry."""
    for part in (field, form.labelForField(field)):
        if part is not None:
            part.setVisible(shown)


def scrolled(contents: QWidget) -> QScrollArea:
    """Scroll area around a widget."""
    scroll = QScrollArea()
    scroll.setWidgetResizable(True)
    scroll.setFrameShape(QFrame.Shape.NoFrame)
    scroll.setWidget(contents)
    return scroll


def pass_focus(holder: QWidget, to: QWidget) -> None:
    """Let a holder that a label's letter leads to pass the keyboard on; Tab skips it."""
    # Qt leads only to what takes the focus, and would pass a later policy on as well.
    holder.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    holder.setFocusProxy(to)


def row(*widgets: QWidget, stretch: int | Sequence[int] = ()) -> QWidget:
    """Widgets side by side; those with an index in ``stretch`` share the remaining room."""
    holder = QWidget()
    layout = QHBoxLayout(holder)
    layout.setContentsMargins(0, 0, 0, 0)
    wide = (stretch,) if isinstance(stretch, int) else stretch
    for index, widget in enumerate(widgets):
        layout.addWidget(widget, 1 if index in wide else 0)
    pass_focus(holder, widgets[0])
    return holder


def wrapped_label(name: str) -> QLabel:
    """Label of plain text, wrapped and selectable."""
    label = named(plain_label(), name)
    label.setWordWrap(True)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    return label


def push_button(name: str, text: str, tip: str, image: QIcon | None = None) -> QPushButton:
    """Button that is not pressed by Enter in another entry."""
    made = named(QPushButton(text) if image is None else QPushButton(image, text), name, tip)
    made.setAutoDefault(False)
    return made


def tool_button(name: str, image: QIcon, tip: str, text: str = "") -> QToolButton:
    """Button with an image and, if given, a text next to it."""
    made = named(QToolButton(), name, tip)
    made.setIcon(image)
    if text:
        made.setText(text)
        made.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
    return made


def line_edit(name: str, tip: str, placeholder: str = "") -> QLineEdit:
    """Text entry, with a placeholder shown while it is empty."""
    made = named(QLineEdit(), name, tip)
    made.setPlaceholderText(placeholder)
    return made


class ShortLine(QLineEdit):
    """Text entry that shows a shortened text, and keeps the whole text until the user edits it.

    If the whole text is not visible, the tooltip begins with it.

    Parameters
    ----------
    shorten : callable
        Returns the text to show.
    """

    def __init__(self, shorten: Callable[[str], str]) -> None:
        super().__init__()
        self._shorten = shorten
        self._whole = self._shown = self._tip = ""
        self.textEdited.connect(self._forget)
        self.textChanged.connect(self._show_tip)

    def setToolTip(self, tip: str) -> None:
        """Set the tooltip, which the whole text precedes if it is not visible."""
        self._tip = tip
        self._show_tip()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Show the beginning of the text."""
        super().focusOutEvent(event)
        self.setCursorPosition(0)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Update the tooltip, as the text may no longer be visible."""
        super().resizeEvent(event)
        self._show_tip()

    def whole(self) -> str:
        """Return the whole text."""
        return self._whole if self._whole and self.text() == self._shown else self.text()

    def enter(self, text: str) -> None:
        """Enter a text; if it is already entered, leave it as typed."""
        if text == self.whole():
            return
        self._whole, self._shown = text, self._shorten(text)
        self.setText(self._shown)
        # Show the beginning of the text, such as the first digits of a long number.
        self.setCursorPosition(0)

    def _forget(self) -> None:
        self._whole = ""

    def _show_tip(self, *_: object) -> None:
        whole, text = self.whole(), self.text()
        option = QStyleOptionFrame()
        self.initStyleOption(option)
        room = self.style().subElementRect(QStyle.SubElement.SE_LineEditContents, option, self).width()
        # Qt leaves 5 px free: two on each side of the text, and one for the cursor.
        is_cut = self.fontMetrics().horizontalAdvance(text[:10_000]) > room - 5
        begins = f"{whole[:200]}\n" if whole != text or is_cut else ""
        super().setToolTip(shown_plain(begins + self._tip))


class ElidedLabel(QLabel):
    """A line of text that is elided if it does not fit; the tooltip has the whole text.

    Parameters
    ----------
    mode : Qt.TextElideMode
        Where the text is elided.
    least : int
        Number of characters that always fit.
    """

    def __init__(self, mode: Qt.TextElideMode, least: int) -> None:
        super().__init__()
        self._mode, self._least = mode, least
        self.setTextFormat(Qt.TextFormat.PlainText)

    def say(self, text: str) -> None:
        """Set the text."""
        self.setText(text)
        self.setToolTip(shown_plain(text))

    def minimumSizeHint(self) -> QSize:
        """Room for ``least`` characters."""
        metrics = self.fontMetrics()
        wide = min(metrics.averageCharWidth() * self._least, metrics.horizontalAdvance(self.text()))
        return QSize(wide, super().minimumSizeHint().height())

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw as much text as fits."""
        painter = QPainter(self)
        text = self.fontMetrics().elidedText(self.text(), self._mode, self.width())
        alignment = int(Qt.AlignmentFlag.AlignLeft) | int(Qt.AlignmentFlag.AlignVCenter)
        self.style().drawItemText(
            painter, self.rect(), alignment, self.palette(), self.isEnabled(), text, self.foregroundRole()
        )


def folder_entry(name: str, title: str, tip: str) -> QgsFileWidget:
    """Folder entry with a button for a dialog titled ``title``."""
    made = named(QgsFileWidget(), name, tip)
    made.setStorageMode(QgsFileWidget.StorageMode.GetDirectory)
    made.setDialogTitle(title)
    pass_focus(made, made.lineEdit())
    return made


def ok_and_cancel(dialog: QDialog) -> QDialogButtonBox:
    """Buttons that accept and reject a dialog."""
    standard = QDialogButtonBox.StandardButton
    made = QDialogButtonBox(standard.Ok | standard.Cancel)
    made.accepted.connect(lambda: first_problem(dialog) or dialog.accept())
    made.rejected.connect(dialog.reject)
    return made


def first_problem(form: QWidget) -> str:
    """Problem of the first invalid number box, which gets the focus; empty if all are valid."""
    for box in form.findChildren(NumberBox):
        if box.isEnabled() and box.isVisibleTo(form) and box.problem():
            box.setFocus()
            box.say_problem()
            return box.problem()
    return ""


class Chooser(QComboBox):
    """A combo box that the mouse wheel changes only while it has the focus; otherwise the wheel scrolls the panel."""

    def __init__(self) -> None:
        super().__init__()
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Change the choice if the box has the focus; otherwise leave the wheel to the panel."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()


def combo(name: str, items: Sequence[tuple[str, str]], tip: str) -> QComboBox:
    """Combo box of (value, label) pairs."""
    combo = named(Chooser(), name, tip)
    combo.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
    combo.setMinimumContentsLength(3)
    for value, label in items:
        combo.addItem(label, value)
    return combo


def tick(name: str, text: str, tip: str) -> QCheckBox:
    """Check box."""
    return named(QCheckBox(text), name, tip)


class NumberBox(QgsDoubleSpinBox):
    """A spin box that accepts any text, and shows no superfluous zeros.

    A text that is not a number in the range stays visible and is reported; it is neither read nor replaced.

    Signals
    -------
    judged()
        The text has become valid or invalid, or another invalid text.

    Attributes
    ----------
    times : float
        Factor from the value in the form's state to the value shown: 100 for a share in percent.
    is_optional : bool
        Whether the least value stands for "not set".
    """

    judged = pyqtSignal()
    times: float = 1.0
    is_optional: bool = False
    #: Whether a change of the text is the user's; False while the box is set up, or a number is entered.
    _is_typed_into: bool = False

    def __init__(self) -> None:
        super().__init__()
        self._judged: str | None = None
        #: Text checked last, and the result, as forms read all their entries at every key.
        self._checked_features: tuple[str, str | None] = ("", None)
        self._is_typed_into = True
        # A comma is a decimal sign in every entry, so no number is shown with commas between thousands.
        self.setGroupSeparatorShown(False)
        self.lineEdit().textChanged.connect(self._judge)
        self.editingFinished.connect(self.say_problem)

    def allow_unset(self, below: float) -> None:
        """Let the value ``below`` the range stand for "not set", and show it as such."""
        self.is_optional = True
        self.setMinimum(below)
        self.setSpecialValueText(tr("not set"))

    def unread(self) -> str | None:
        """Return the text if it is not a number in the range; None otherwise."""
        if not self._is_typed_into:
            return None
        shown = self.lineEdit().text()
        if shown != self._checked_features[0] or not shown:
            text = self._typed(shown)
            self._checked_features = shown, text if self._read(text) is None else None
        return self._checked_features[1]

    def problem(self) -> str:
        """Return why the text is invalid; empty if it is a number in the range."""
        text = self.unread()
        if text is None:
            return ""
        try:
            value = plain_number(text)
        except ValueError:
            return tr("“{text}”: must be a number").format(text=text)
        if not self.decimals() and value != int(value):
            return tr("“{text}”: must be a whole number").format(text=text)
        if self._vanishes(value):
            return tr("“{text}”: is too small").format(text=text)
        least, most = (localized(f"{end:.15g}") for end in (self.minimum(), self.maximum()))
        if self.is_optional:
            right = tr("“{text}”: must be above {least} and at most {most}, or empty")
        else:
            right = tr("“{text}”: must be from {least} to {most}")
        return right.format(text=text, least=least, most=most)

    def say_problem(self) -> None:
        """Show the problem in a tooltip, if the entry has no label for messages."""
        if self.problem() and not self.property(_BESIDE):
            QToolTip.showText(self.mapToGlobal(QPoint(0, self.height())), shown_plain(self.problem()), self)

    def validate(self, text: str, *position: int) -> tuple[Any, ...]:
        """Accept any text."""
        if position:
            return QValidator.State.Acceptable, text, *position
        # QGIS passes no position but expects one: the cursor's, after a prefix that Qt will insert.
        line = self.lineEdit()
        before = 0 if line.text().startswith(self.prefix()) else len(self.prefix())
        return QValidator.State.Acceptable, line.cursorPosition() + before

    def setSuffix(self, suffix: str) -> None:
        """Set the unit; Qt would also write the number anew, amid what is being typed."""
        if suffix != self.suffix():
            super().setSuffix(suffix)

    def setValue(self, value: float) -> None:
        """Set a number, in place of any text typed."""
        with self._entering():
            super().setValue(value)

    def stepBy(self, steps: int) -> None:
        """Step from the last valid number."""
        with self._entering():
            super().stepBy(steps)

    def textFromValue(self, value: float) -> str:
        """Text of a number; an invalid text stays as typed."""
        typed = self.unread() if self._is_typed_into else None
        if typed is not None and value == self.value():
            return typed
        text = super().textFromValue(value)
        point = self.locale().decimalPoint()
        return text.rstrip("0").rstrip(point) if point in text else text

    def valueFromText(self, text: str) -> float:
        """Number of a text; if it is invalid, the last number, or a number other than "not set" if that was shown."""
        value = self._read(self._typed(text))
        if value is not None:
            return value
        left_out = self.is_optional and self.value() == self.minimum()
        return self.minimum() + 1.0 if left_out else self.value()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Step if the box has the focus; otherwise leave the wheel to the panel."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()

    def number(self) -> float | int | None:
        """Entered number, an int if the box has no decimals; None if not set."""
        if self.is_optional and (self.value() == self.minimum() or self.unread() is not None):
            return None
        return self.value() / self.times if self.decimals() else int(self.value())

    def enter(self, number: float | None) -> None:
        """Enter a number such as `number` returns, rounded to the decimals of the box and to readable digits."""
        self.setValue(self.minimum() if number is None else short_number(number * self.times))

    def _typed(self, text: str) -> str:
        """Text without prefix and suffix, and without a unit typed in addition."""
        prefix, suffix = self.prefix().strip(), self.suffix().strip()
        text = text.strip().removeprefix(prefix).removesuffix(suffix).strip()
        return text.removesuffix(suffix).strip()

    def _read(self, text: str) -> float | None:
        """Number of a text, in the range and rounded to the decimals; None if it is invalid."""
        if self.is_optional and text in ("", self.specialValueText()):
            return self.minimum()
        value = self._number(text)
        if value is None or self._vanishes(value):
            return None
        if self.decimals():
            # Digits that are not shown do not count for the range.
            value = round(value, self.decimals())
        if not self.minimum() <= value <= self.maximum() or math.copysign(1.0, value) < 0.0 <= self.minimum():
            return None
        left_out = self.is_optional and value == self.minimum()
        return None if left_out or (not self.decimals() and value != int(value)) else value

    def _vanishes(self, value: float) -> bool:
        """Whether a number would become 0 in the decimals of the box."""
        return bool(self.decimals()) and value != 0.0 == round(value, self.decimals())

    @staticmethod
    def _number(text: str) -> float | None:
        """Number of a text, or the value of a formula; None if it is neither."""
        try:
            return plain_number(text)
        except ValueError:
            plain = text.replace(",", ".")
            return _result(plain) if _SUM.fullmatch(plain) else None

    @contextmanager
    def _entering(self) -> Iterator[None]:
        self._is_typed_into = False
        try:
            yield
        finally:
            self._is_typed_into = True
            self._judge()

    def _judge(self, *_: object) -> None:
        """Emit `judged` if the validity of the text has changed."""
        unread = self.unread()
        if unread != self._judged:
            self._judged = unread
            self.judged.emit()
            if not self.property(_BESIDE):
                _mark(self, unread is not None)


class WholeBox(NumberBox):
    """A spin box of integers."""

    def value(self) -> int:
        """Return the value."""
        return int(super().value())


def _result(text: str) -> float | None:
    """Value of a formula, evaluated by QGIS; None if it has no value."""
    from qgis.core import QgsExpression

    value = QgsExpression(text).evaluate()
    return float(value) if isinstance(value, (int, float)) and math.isfinite(value) else None


def short_number(value: float) -> float:
    """Number rounded to readable digits if it has more decimals than people type: 330.26666… becomes 330.27."""
    # Numbers of up to 6 decimals may have been typed; round others to 5 significant digits.
    if not math.isfinite(value) or round(value, 6) == value:
        return value
    before = math.floor(math.log10(abs(value))) + 1
    return round(value, max(5 - before, 1))


def spin(name: str, least: float, most: float, decimals: int, suffix: str, tip: str) -> NumberBox:
    """Spin box of a number with a unit."""
    made = _number_box(named(NumberBox(), name, tip), least, most, decimals)
    made.setSuffix(suffix)
    made.setStepType(QAbstractSpinBox.StepType.AdaptiveDecimalStepType)
    return made


def whole_spin(name: str, least: int, most: int, tip: str) -> WholeBox:
    """Spin box of an integer in a range."""
    return _number_box(named(WholeBox(), name, tip), least, most, 0)


def _number_box(made: _Box, least: float, most: float, decimals: int) -> _Box:
    made.setDecimals(decimals)
    made.setRange(least, most)
    # Show a number from the start, as an empty text would count as typed.
    made.setValue(made.value())
    made.setShowClearButton(False)
    # Narrower than the longest number of the range, so that the box fits beside its label.
    made.setMinimumWidth(10 * made.fontMetrics().averageCharWidth())
    made.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    return made


def choose(combo: QComboBox, value: object) -> None:
    """Select the item with the data ``value``; the first item if there is none."""
    combo.setCurrentIndex(max(combo.findData(value), 0))


class FieldMessage(QLabel):
    """Wrapped text that sets its own minimum height, as nested layouts do not ask for the height at a width."""

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fit the height to the lines at this width."""
        super().resizeEvent(event)
        self._fit()

    def say(self, text: str) -> None:
        """Set the text; hidden if empty."""
        self.setTextFormat(Qt.TextFormat.PlainText)
        # Shorten it to a few lines below the field.
        self.setText(shortened(text, 1000))
        self.setVisible(bool(text))
        self._fit()

    def _fit(self) -> None:
        # A label's height for a width is at least its minimum, that of the text before.
        self.setMinimumHeight(0)
        self.setMinimumHeight(self.heightForWidth(self.width()) if self.text() else 0)


class FieldMarks:
    """The named fields of a form; marks fields with invalid values, and shows messages below them."""

    def __init__(self) -> None:
        self._fields: dict[str, tuple[QWidget, FieldMessage]] = {}

    def field(self, name: str, widget: QWidget, shown: QWidget | None = None) -> QWidget:
        """Widget for a layout: ``shown`` (by default ``widget``) above the label for the field's message."""
        holder = QWidget()
        layout = QVBoxLayout(holder)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(1)
        layout.addWidget(shown or widget)
        layout.addWidget(self.label(name, widget))
        pass_focus(holder, shown or widget)
        return holder

    def label(self, name: str, widget: QWidget) -> FieldMessage:
        """Label for the message of a field, for layouts in which it is not directly below the field."""
        label = named(FieldMessage(), f"{name}_message")
        label.setProperty("terrainavMark", "true")
        label.setWordWrap(True)
        label.hide()
        self._fields[name] = (widget, label)
        widget.setProperty(_BESIDE, "true")
        return label

    def show(self, messages: dict[str, str]) -> None:
        """Mark the fields in ``messages``, and unmark all others."""
        for name, (widget, label) in self._fields.items():
            text = messages.get(name, "")
            label.say(text)
            if text or widget.property(_WRONG):
                _mark(widget, bool(text))

    def message(self, name: str) -> str:
        """Message at a field; empty if it is valid."""
        return self._fields[name][1].text()

    def hidden(self) -> tuple[str, ...]:
        """Fields whose rows are hidden, other than by folding a group."""
        return tuple(name for name, (_, label) in self._fields.items() if _is_hidden(label.parentWidget()))

    def hidden_messages(self, messages: dict[str, str]) -> str:
        """Messages for hidden and unknown fields, as one text."""
        hidden = self.hidden()
        texts = (text for name, text in messages.items() if name not in self._fields or name in hidden)
        return "\n".join(texts)

    def fields(self) -> list[tuple[QWidget, QLabel]]:
        """Fields, and the labels for their messages."""
        return list(self._fields.values())

    def wrong(self) -> list[QWidget]:
        """Fields with a message, other than those whose rows are hidden."""
        hidden = self.hidden()
        return [widget for name, (widget, label) in self._fields.items() if label.text() and name not in hidden]

    def first_message(self) -> str:
        """Message at the first marked field; empty if none is marked."""
        return next((label.text() for _, label in self._fields.values() if label.text()), "")


def remove_menu_mnemonics(panel: QWidget, menus: QMenuBar) -> None:
    """Remove a panel's mnemonics that open a menu of the window, or that appear twice."""
    taken = {f"Alt+{key}" for key in menu_keys(menus)}
    for text, change in list(_texts(panel)):
        letter = mnemonic_key(text)
        if letter and letter in taken:
            change(text.replace("&", "", 1))
        taken.add(letter)


def menu_keys(menus: QMenuBar) -> set[str]:
    """Underlined letters of a window's menus."""
    keys = (mnemonic_key(action.text()) for action in menus.actions() if action.isVisible())
    return {key.rpartition("+")[2] for key in keys if key}


def add_docked(
    panel: QgsDockWidget,
    iface: QgisInterface,
    beside: str = "",
    area: Qt.DockWidgetArea = Qt.DockWidgetArea.RightDockWidgetArea,
) -> None:
    """Dock a widget where the user had it, by default in ``area``, as a tab next to the widget named ``beside``."""
    window = iface.mainWindow()
    if window.restoreDockWidget(panel):
        # As `addDockWidget` of QGIS does, which would move the widget.
        menu = window.findChild(QMenu, "mPanelMenu")
        if menu is not None:
            menu.addAction(panel.toggleViewAction())
        # Qt shows a restored tab only after it is added as a tab.
        for other in window.tabifiedDockWidgets(panel)[:1]:
            window.tabifyDockWidget(other, panel)
    else:
        _dock(panel, iface, beside, area)
    # Not `setUserVisible`, which takes a restored tab to be in front before it is.
    panel.show()
    panel.raise_()


def _dock(panel: QgsDockWidget, iface: QgisInterface, beside: str, area: Qt.DockWidgetArea) -> None:
    window = iface.mainWindow()
    docked = [one for one in window.findChildren(QDockWidget) if one is not panel and not one.isFloating()]
    # Also next to a hidden one, which would otherwise come back above or below.
    others = [one for one in docked if one.objectName() == beside]
    others += [one for one in docked if one.isVisible() and window.dockWidgetArea(one) == area]
    iface.addDockWidget(area, panel)
    if beside and others:
        window.tabifyDockWidget(others[0], panel)


def mnemonic_key(text: str) -> str:
    """Shortcut of the underlined letter in a text, such as ``Alt+F``; empty if there is none."""
    return QKeySequence.mnemonic(text).toString()


def _is_hidden(part: QWidget) -> bool:
    """Whether a widget of a form, or one of its parents, is hidden other than by folding its group."""
    around = part.parentWidget()
    while around is not None and not isinstance(around, QgsCollapsibleGroupBoxBasic):
        if part.isHidden():
            return True
        part, around = around, around.parentWidget()
    return False


def _mark(widget: QWidget, wrong: bool) -> None:
    widget.setProperty(_WRONG, "true" if wrong else "")
    if isinstance(widget, QAbstractSpinBox):
        # By palette, as a border by style sheet would spoil the arrows.
        palette = QPalette()
        if wrong:
            palette.setColor(QPalette.ColorRole.Base, _tinted(palette.color(QPalette.ColorRole.Base)))
        for part in (widget, widget.findChild(QLineEdit)):
            part.setPalette(palette)
    else:
        widget.style().unpolish(widget)
        widget.style().polish(widget)


def _tinted(base: QColor) -> QColor:
    """A colour of the theme, blended with the colour of errors."""
    wrong = QColor(WRONG_COLOUR)
    parts = zip(base.getRgb()[:3], wrong.getRgb()[:3])
    return QColor(*(round(0.7 * own + 0.3 * other) for own, other in parts))


def _texts(panel: QWidget) -> Iterator[_Text]:
    for widget in panel.findChildren(QWidget):
        if isinstance(widget, QAbstractButton) or (isinstance(widget, QLabel) and widget.buddy() is not None):
            yield widget.text(), widget.setText
        elif isinstance(widget, QTabBar):
            for index in range(widget.count()):
                yield widget.tabText(index), lambda text, bar=widget, at=index: bar.setTabText(at, text)
