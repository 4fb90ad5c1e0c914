"""Groups of entries that most missions leave as they are: attitude, wind, accuracy."""

from __future__ import annotations

import html
from typing import Any

from qgis.gui import QgsCollapsibleGroupBoxBasic
from qgis.PyQt.QtCore import Qt, pyqtSignal
from qgis.PyQt.QtWidgets import QAbstractSpinBox, QCheckBox, QComboBox, QLabel, QWidget

from ..i18n import tr
from .field_marks import FieldMarks
from .form_state import FormState
from .form_widgets import NumberBox, choose, combo, form_layout, spin

#: Numbers are taken as typed, and judged in words: what a spin box lets through is far more than what is right.
_ANGLE, _HEIGHT_M, _SPEED_M_PER_S, _BUDGET_PX = 1e4, 1e6, 1e4, 1e6


class Section(QgsCollapsibleGroupBoxBasic):
    """A group whose entries are fields of `FormState`; collapsed until an entry is not the usual one.

    Signals
    -------
    changed()
    """

    changed = pyqtSignal()

    def __init__(self, name: str, title: str, marks: FieldMarks) -> None:
        super().__init__(title)
        self.setObjectName(name)
        self.entries: dict[str, QWidget] = {}
        self._marks = marks
        self._form = form_layout(self)

    def values(self) -> dict[str, Any]:
        """Return what is entered, by field."""
        return {name: _value(widget) for name, widget in self.entries.items()}

    def set_state(self, state: FormState) -> None:
        """Enter the fields of a state; shows them where one is not as usual."""
        usual = FormState()
        for name, widget in self.entries.items():
            _enter(widget, getattr(state, name))
        if any(getattr(state, name) != getattr(usual, name) for name in self.values()):
            self.setCollapsed(False)

    def show_marked(self, messages: dict[str, str]) -> None:
        """Open where something is said about an entry."""
        if any(name in messages for name in self.entries):
            self.setCollapsed(False)

    def _number(self, name: str, label: str, widget: NumberBox) -> None:
        widget.setStepType(QAbstractSpinBox.StepType.AdaptiveDecimalStepType)
        widget.valueChanged.connect(self.changed)
        self._add(name, label, widget)

    def _choice(self, name: str, label: str, widget: QComboBox) -> None:
        widget.currentIndexChanged.connect(self.changed)
        self._add(name, label, widget)

    def _add(self, name: str, label: str, widget: QWidget) -> None:
        self.entries[name] = widget
        self._form.addRow(label, self._marks.field(name, widget))


def _value(widget: QWidget) -> Any:
    if isinstance(widget, QComboBox):
        return widget.currentData()
    return widget.isChecked() if isinstance(widget, QCheckBox) else widget.value()


def _enter(widget: QWidget, value: Any) -> None:
    if isinstance(widget, QComboBox):
        choose(widget, value)
    elif isinstance(widget, QCheckBox):
        widget.setChecked(value)
    else:
        widget.setValue(value)


class AttitudeSection(Section):
    """Where every picture looks, and how high the ground lies."""

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("attitude", tr("Attitude"), marks)
        angles = (
            (
                "yaw_deg",
                tr("Yaw"),
                tr("Direction of the picture's top edge, in degrees clockwise from north (-360 to 360)"),
            ),
            (
                "tilt_deg",
                tr("Tilt"),
                tr(
                    "Degrees the view is lifted from straight down (0) towards the picture's top edge; "
                    "90 looks level (-180 to 180)"
                ),
            ),
            (
                "roll_deg",
                tr("Roll"),
                tr("Degrees the camera is rolled about its line of sight, right side down (-180 to 180)"),
            ),
        )
        for name, label, tip in angles:
            self._number(name, label, spin(name, -_ANGLE, _ANGLE, 6, " °", tip))
        tip = tr("Height of the ground above the WGS84 ellipsoid, in metres (-12,000 to 9,000)")
        name = "ground_height_m"
        self._number(name, tr("Ground height"), spin(name, -_HEIGHT_M, _HEIGHT_M, 3, " m", tip))
        self.setCollapsed(True)


class WindSection(Section):
    """What moves and turns the camera at each exposure; off unless it is ticked."""

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("wind", tr("Wind"), marks)
        self.setCheckable(True)
        self.setChecked(False)
        self.setToolTip(
            tr(
                "Gusts move and turn the camera at every exposure: pictures are then as the camera really sees them"
            )
        )
        name = "wind_speed_m_per_s"
        tip = tr("Mean wind at flight height, in metres a second; below the airspeed")
        self._number(name, tr("Speed"), spin(name, -_SPEED_M_PER_S, _SPEED_M_PER_S, 3, " m/s", tip))
        name = "wind_from_deg"
        tip = tr("Direction the wind blows from, in degrees clockwise from north")
        self._number(name, tr("From"), spin(name, -_ANGLE, _ANGLE, 3, " °", tip))
        name = "turbulence"
        tip = tr(
            "Strength of the gusts: their standard deviation over the mean wind, without unit; "
            "about 0.1 over water, 0.2 over fields, 0 for a steady wind"
        )
        self._number(name, tr("Turbulence"), spin(name, -1e3, 1e3, 4, "", tip))
        name = "airspeed_m_per_s"
        tip = tr("Speed of the flight through the air, in metres a second (0.1 to 340)")
        self._number(name, tr("Airspeed"), spin(name, -_SPEED_M_PER_S, _SPEED_M_PER_S, 3, " m/s", tip))
        self.toggled.connect(self.changed)
        self.setCollapsed(True)

    def values(self) -> dict[str, Any]:
        """Return what is entered, and whether it counts."""
        return {**super().values(), "wind": self.isChecked()}

    def set_state(self, state: FormState) -> None:
        """Enter the fields of a state."""
        self.setChecked(state.wind)
        super().set_state(state)


class AccuracySection(Section):
    """How wrong pictures and footprints may be, and what kind of picture is made.

    Signals
    -------
    reset_clicked()
        What goes beyond the entries is to be forgotten.
    """

    reset_clicked = pyqtSignal()

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("accuracy", tr("Accuracy"), marks)
        tip = tr(
            "Most that the errors of all steps may add up to, in pixels of the planned image, by their bounds; "
            "above 0. The cheapest methods that fit are used."
        )
        name = "error_budget_px"
        self._number(name, tr("Error budget"), spin(name, 0.0, _BUDGET_PX, 12, " px", tip))
        check = QCheckBox(tr("Go on beyond the budget"))
        check.setObjectName("accept_error")
        check.setToolTip(
            tr("Where no methods fit the budget (px), take the most accurate ones instead of refusing")
        )
        check.toggled.connect(self.changed)
        self._add("accept_error", "", check)
        frames = (
            ("auto", tr("Automatic")),
            ("map", tr("Map frame (north-up)")),
            ("camera", tr("Camera frame (as seen)")),
        )
        tip = tr(
            "Map frame: a window of the source's own pixels, for cameras that look straight down. Camera frame: "
            "the picture as the camera sees it. Automatic: a map frame where its error in px fits the budget."
        )
        self._choice("frame", tr("Pictures"), combo("frame", frames, tip))
        kernels = (
            ("nearest", tr("Nearest pixel")),
            ("bilinear", tr("Bilinear")),
            ("bicubic", tr("Bicubic")),
            ("lanczos", tr("Lanczos")),
        )
        tip = tr(
            "How camera frames take their values between the source's pixels, from 1 px to 6 px across; "
            "map frames are not resampled"
        )
        self._choice("resampling", tr("Resampling"), combo("resampling", kernels, tip))
        # What a camera frame is resampled with says nothing about a map frame.
        frame, resampling = self.entries["frame"], self.entries["resampling"]
        frame.currentIndexChanged.connect(lambda: resampling.setEnabled(frame.currentData() != "map"))
        self.more = QLabel()
        self.more.setObjectName("more")
        self.more.setWordWrap(True)
        self.more.setTextFormat(Qt.TextFormat.RichText)
        self.more.setToolTip(tr("Settings of the mission's file that this panel has no entries for"))
        self.more.linkActivated.connect(self.reset_clicked)
        self._form.addRow(self.more)
        self._form.addRow(marks.label("more", self.more))
        self.more.hide()

    def show_more(self, text: str) -> None:
        """Show what goes beyond the entries; nothing for an empty text."""
        link = tr("forget")
        shown = tr("Also set: {text}").format(text=html.escape(text))
        self.more.setText(f'{shown} (<a href="forget">{link}</a>)' if text else "")
        self.more.setVisible(bool(text))
