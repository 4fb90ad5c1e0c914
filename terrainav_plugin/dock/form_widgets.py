"""Small makers of the dock's widgets."""

from __future__ import annotations

from collections.abc import Sequence

from qgis.gui import QgsCollapsibleGroupBoxBasic, QgsDoubleSpinBox
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtGui import QWheelEvent
from qgis.PyQt.QtWidgets import (
    QAbstractSpinBox,
    QCheckBox,
    QComboBox,
    QFormLayout,
    QHBoxLayout,
    QVBoxLayout,
    QWidget,
)


def form_layout(box: QgsCollapsibleGroupBoxBasic) -> QFormLayout:
    """Layout of labelled entries for a group box.

    It is inside one widget: unfolding a group shows all that is right inside it, also rows that are to be hidden.
    """
    contents = QWidget(box)
    around = QVBoxLayout(box)
    around.setContentsMargins(0, 0, 0, 0)
    around.addWidget(contents)
    form = QFormLayout(contents)
    form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
    form.setVerticalSpacing(4)
    return form


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
    combo = Chooser()
    combo.setObjectName(name)
    combo.setToolTip(tip)
    combo.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
    combo.setMinimumContentsLength(3)
    for value, label in items:
        combo.addItem(label, value)
    return combo


def tick(name: str, text: str, tip: str) -> QCheckBox:
    """Box to tick."""
    box = QCheckBox(text)
    box.setObjectName(name)
    box.setToolTip(tip)
    return box


class NumberBox(QgsDoubleSpinBox):
    """A spin box that shows no zeros a person would not write.

    Attributes
    ----------
    times : float
        What the dock's state is multiplied by to be shown: 100 for a share in percent.
    """

    times: float = 1.0

    def textFromValue(self, value: float) -> str:
        """Text of a number."""
        text = super().textFromValue(value)
        point = self.locale().decimalPoint()
        return text.rstrip("0").rstrip(point) if point in text else text

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Step only where the box has been entered: otherwise the panel is scrolled."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()

    def number(self) -> float | int:
        """What is entered; whole where no decimals are taken."""
        return self.value() / self.times if self.decimals() else int(self.value())

    def enter(self, number: float) -> None:
        """Show what `number` returns then, to the decimals there are."""
        self.setValue(number * self.times)


def spin(name: str, least: float, most: float, decimals: int, suffix: str, tip: str) -> NumberBox:
    """Entry for a number with a unit."""
    spin = NumberBox()
    spin.setObjectName(name)
    spin.setRange(least, most)
    spin.setDecimals(decimals)
    spin.setSuffix(suffix)
    spin.setShowClearButton(False)
    spin.setToolTip(tip)
    spin.setStepType(QAbstractSpinBox.StepType.AdaptiveDecimalStepType)
    spin.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    return spin


def choose(combo: QComboBox, value: object) -> None:
    """Select the item with this data; an unknown one leaves the first."""
    combo.setCurrentIndex(max(combo.findData(value), 0))
