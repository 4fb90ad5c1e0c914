"""Small makers of the dock's widgets."""

from __future__ import annotations

from collections.abc import Sequence

from qgis.gui import QgsCollapsibleGroupBoxBasic, QgsDoubleSpinBox
from qgis.PyQt.QtWidgets import QComboBox, QFormLayout, QHBoxLayout, QWidget


def form_layout(box: QgsCollapsibleGroupBoxBasic) -> QFormLayout:
    """Layout of labelled entries for a group box."""
    form = QFormLayout(box)
    form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
    form.setVerticalSpacing(4)
    return form


def row(*widgets: QWidget, stretch: int | None = None) -> QWidget:
    """Widgets side by side; the one numbered ``stretch`` takes the room left."""
    holder = QWidget()
    layout = QHBoxLayout(holder)
    layout.setContentsMargins(0, 0, 0, 0)
    for index, widget in enumerate(widgets):
        layout.addWidget(widget, 1 if index == stretch else 0)
    return holder


def combo(name: str, items: Sequence[tuple[str, str]], tip: str) -> QComboBox:
    """Chooser of (value, label) pairs."""
    combo = QComboBox()
    combo.setObjectName(name)
    combo.setToolTip(tip)
    combo.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
    combo.setMinimumContentsLength(3)
    for value, label in items:
        combo.addItem(label, value)
    return combo


class NumberBox(QgsDoubleSpinBox):
    """A spin box that shows no zeros a person would not write."""

    def textFromValue(self, value: float) -> str:
        """Text of a number."""
        text = super().textFromValue(value)
        point = self.locale().decimalPoint()
        return text.rstrip("0").rstrip(point) if point in text else text


def spin(name: str, least: float, most: float, decimals: int, suffix: str, tip: str) -> NumberBox:
    """Entry for a number with a unit."""
    spin = NumberBox()
    spin.setObjectName(name)
    spin.setRange(least, most)
    spin.setDecimals(decimals)
    spin.setSuffix(suffix)
    spin.setShowClearButton(False)
    spin.setToolTip(tip)
    return spin


def choose(combo: QComboBox, value: object) -> None:
    """Select the item with this data; an unknown one leaves the first."""
    combo.setCurrentIndex(max(combo.findData(value), 0))
