"""Entries of a form with a place for what is wrong with them."""

from __future__ import annotations

from qgis.gui import QgsCollapsibleGroupBoxBasic
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtGui import QColor, QPalette, QResizeEvent
from qgis.PyQt.QtWidgets import QAbstractSpinBox, QLabel, QLineEdit, QVBoxLayout, QWidget

#: Vermillion of the Okabe-Ito palette: readable on light and dark themes, told apart by colour-blind people.
WRONG_COLOUR = "#D55E00"
#: Share of that colour behind the text of a spin box.
_TINT = 0.3
_WRONG = "terrainavWrong"
STYLE_SHEET = f"""
QLineEdit[{_WRONG}="true"], QComboBox[{_WRONG}="true"] {{
    border: 2px solid {WRONG_COLOUR};
    border-radius: 3px;
}}
QLabel[terrainavMark="true"] {{ color: {WRONG_COLOUR}; }}
"""


class FieldMessage(QLabel):
    """Text as high as its lines need; layouts forget about that where widgets are nested."""

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Make room for the lines there are at this width."""
        super().resizeEvent(event)
        self._fit()

    def say(self, text: str) -> None:
        """Show a text, or nothing."""
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setText(text)
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
        label = FieldMessage()
        label.setObjectName(f"{name}_message")
        label.setProperty("terrainavMark", "true")
        label.setWordWrap(True)
        label.hide()
        self._fields[name] = (widget, label)
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
