"""A strip of images just below and just above the threshold."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from qgis.PyQt.QtCore import QSize, Qt, pyqtSignal
from qgis.PyQt.QtGui import QColor, QIcon, QPainter, QPaintEvent, QPixmap
from qgis.PyQt.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QToolButton, QWidget

from ..i18n import number_text, tr
from ..plain import shown_plain
from .colours import KEPT, REJECTED
from .entropies import Example
from .picture import Picture, read_picture

#: Pictures on either side.
COUNT = 4
_ICON_PX = (72, 54)
_LINE_PX = 3


class Shown(NamedTuple):
    """An example with its picture."""

    example: Example
    picture: Picture


def read_examples(
    examples: tuple[Sequence[Example], Sequence[Example]], ratio: float
) -> tuple[list[Shown], list[Shown]]:
    """Read pictures for a screen that has ``ratio`` pixels for each of Qt's; on any thread."""
    longest_px = round(max(_ICON_PX) * ratio)
    below, above = ([Shown(one, read_picture(one.path, longest_px)) for one in side] for side in examples)
    return below, above


class ExampleStrip(QWidget):
    """Shows images, those nearest to the threshold in the middle.

    Signals
    -------
    chosen(int)
        Row of the table.
    """

    chosen = pyqtSignal(int)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("examples")
        self.below, self.above = _buttons("below"), _buttons("above")
        self._rows: dict[QToolButton, int] = {}
        layout = QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setVerticalSpacing(2)
        sides = (
            # The nearest of the rejected ones comes last, beside the nearest of the kept ones.
            (tr("Just below: rejected"), REJECTED, self.below[::-1]),
            (tr("Just above: kept"), KEPT, self.above),
        )
        for column, (title, colour, buttons) in enumerate(sides):
            heading = QLabel(title)
            heading.setAlignment(Qt.AlignmentFlag.AlignCenter)
            layout.addWidget(heading, 0, column)
            layout.addWidget(_Line(colour), 1, column)
            row = QHBoxLayout()
            row.setSpacing(2)
            for button in buttons:
                row.addWidget(button)
                button.clicked.connect(lambda _=False, button=button: self._choose(button))
            layout.addLayout(row, 2, column)
        self.clear()

    def clear(self) -> None:
        """Show none."""
        self.show_examples([], [])

    def show_examples(self, below: Sequence[Shown], above: Sequence[Shown]) -> None:
        """Show images, the nearest to the threshold first."""
        self._rows.clear()
        for buttons, shown in ((self.below, below), (self.above, above)):
            for button, one in zip(buttons, [*shown, *[None] * (len(buttons) - len(shown))]):
                self._show(button, one)

    def _show(self, button: QToolButton, shown: Shown | None) -> None:
        button.setEnabled(shown is not None)
        if shown is None:
            button.setIcon(QIcon())
            button.setText("")
            button.setToolTip("")
            button.setAccessibleName("")
            return
        example, picture = shown
        button.setIcon(_icon(picture, self.devicePixelRatioF()))
        button.setText(number_text(example.entropy, ".3f"))
        tip = tr("{name}\n{bits} bits; press to show it on the map").format(
            name=example.path.name, bits=number_text(example.entropy, ".3f")
        )
        button.setToolTip(shown_plain(f"{tip}\n{picture.problem}" if picture.problem else tip))
        button.setAccessibleName(tip)
        self._rows[button] = example.index

    def _choose(self, button: QToolButton) -> None:
        if button in self._rows:
            self.chosen.emit(self._rows[button])


class _Line(QWidget):
    """A line in the colour that a side has in the charts."""

    def __init__(self, colour: QColor) -> None:
        super().__init__()
        self._colour = colour
        self.setFixedHeight(_LINE_PX)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: ARG002  Qt passes it
        QPainter(self).fillRect(self.rect(), self._colour)


def _buttons(side: str) -> list[QToolButton]:
    buttons = []
    for number in range(COUNT):
        button = QToolButton()
        button.setObjectName(f"{side}_{number}")
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextUnderIcon)
        button.setIconSize(QSize(*_ICON_PX))
        button.setAutoRaise(True)
        button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        buttons.append(button)
    return buttons


def _icon(picture: Picture, ratio: float) -> QIcon:
    size = QSize(*_ICON_PX) * ratio
    if picture.image is None:
        pixmap = QPixmap(size)
        pixmap.fill(QColor(0, 0, 0, 0))
    else:
        # Filled, its edges cut: pictures of many shapes make an even row.
        whole = picture.image.scaled(
            size, Qt.AspectRatioMode.KeepAspectRatioByExpanding, Qt.TransformationMode.SmoothTransformation
        )
        left, top = (whole.width() - size.width()) // 2, (whole.height() - size.height()) // 2
        pixmap = QPixmap.fromImage(whole.copy(left, top, size.width(), size.height()))
    pixmap.setDevicePixelRatio(ratio)
    return QIcon(pixmap)
