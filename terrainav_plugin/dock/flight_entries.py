"""The entries of the flight: height, overlap, the lines flown, speed."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ..form.camera import shown_gsd
from ..form.state import FormState
from ..i18n import number_text, tr
from ..units import length_text
from ..widgets import FieldMarks, FieldMessage, combo, row, spin, tick
from .entries import Entries

#: What the spin boxes let through; what is right is said in words.
_HEIGHT, _GSD, _ANGLE_DEG, _SPEED_M_PER_S = 1e9, 1e9, 1e4, 1e4
#: Flights below this are seldom meant: such a height comes of a small image.
_LOW_M = 20.0


class FlightEntries(Entries):
    """Group of the flight.

    Attributes
    ----------
    height_by : str
        What the height follows from, as in `FormState`: what was typed last.
    """

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("flight", tr("Flight"), marks)
        self.height_by = "agl"
        self._add_height()
        self._add_overlap()
        self._add_lines()
        tip = tr("Speed of the flight through the air, in metres a second (0.1 to 340)")
        name = "airspeed_m_per_s"
        self.add(name, tr("Airspeed"), spin(name, -_SPEED_M_PER_S, _SPEED_M_PER_S, 3, " m/s", tip))

    def values(self) -> dict[str, Any]:
        """Return what is entered; a ground sample distance only where the height follows from it."""
        values = {**super().values(), "height_by": self.height_by}
        return values if self.height_by == "gsd" else {**values, "camera_gsd": 0.0}

    def enter(self, state: FormState) -> None:
        """Enter the fields of a state; shows the ground sample distance that follows from a height."""
        self.camera_gsd.setSuffix(" " + (tr("in") if state.agl_unit == "ft" else tr("cm")))
        super().enter(replace(state, camera_gsd=shown_gsd(state)))
        # Last, as every entry above counts as typed.
        self.height_by = state.height_by
        self.show_low(state)

    def show_low(self, state: FormState) -> None:
        """Say what a ground sample distance comes to where that is a flight close to the ground."""
        is_low = state.height_by == "gsd" and 0.0 < state.agl_m < _LOW_M
        text = tr(
            "With {px} px along the image's longer side this is {height} above ground. To fly higher, enter more under "
            "“Image's longer side” of the camera."
        ).format(px=number_text(state.image_px), height=length_text(state.agl_m, state.agl_unit))
        self.low.say(text if is_low else "")

    def _add_height(self) -> None:
        self.agl = spin(
            "agl",
            -_HEIGHT,
            _HEIGHT,
            4,
            "",
            tr("Height above the ground (AGL), in metres or feet as chosen beside"),
        )
        self.agl_unit = combo(
            "agl_unit",
            (("m", tr("m")), ("ft", tr("ft"))),
            tr(
                "Metres or international feet: for the height, and for the lengths and areas of the estimates"
            ),
        )
        self.agl.valueChanged.connect(lambda: setattr(self, "height_by", "agl"))
        self.take("agl_unit", self.agl_unit)
        self.add("agl", tr("Height above gro&und"), self.agl, row(self.agl, self.agl_unit, stretch=0))
        tip = tr(
            "Ground sample distance of the camera: the ground that one pixel of an image with the longer side of the "
            "camera shows, straight down, in centimetres (inches with feet) per px. Height and ground sample distance "
            "follow each other; the one typed last stays. How fine the source's own pixels are is in the estimates."
        )
        self.camera_gsd = spin("camera_gsd", 0.0, _GSD, 4, "", tip)
        self.camera_gsd.valueChanged.connect(lambda: setattr(self, "height_by", "gsd"))
        self.add("camera_gsd", tr("&Ground per px"), self.camera_gsd)
        self.low = FieldMessage()
        self.low.setObjectName("camera_gsd_hint")
        self.low.setWordWrap(True)
        self.low.hide()
        self._form.addRow(self.low)

    def _add_overlap(self) -> None:
        tip = tr(
            "Front overlap: share of a picture that the next one along the flight line shows again, in percent"
        )
        self.overlap_along = spin("overlap_along", 0.0, 100.0, 1, " %", tip)
        self.overlap_along.setPrefix(tr("front") + " ")
        tip = tr("Side overlap: share of a picture that the next flight line shows again, in percent")
        self.overlap_across = spin("overlap_across", 0.0, 100.0, 1, " %", tip)
        self.overlap_across.setPrefix(tr("side") + " ")
        overlaps = {"overlap_along": self.overlap_along, "overlap_across": self.overlap_across}
        for spin_box in overlaps.values():
            spin_box.times = 100.0
        self.add_two(tr("Overlap"), *overlaps, overlaps)

    def _add_lines(self) -> None:
        layouts = (("cover", tr("Cover (no gaps)")), ("paper", tr("Paper (UTM grid)")))
        tip = tr("Cover: rows that leave nothing out. Paper: the grid in UTM as published.")
        self.layout_choice = combo("layout", layouts, tip)
        self.add("layout", tr("La&yout"), self.layout_choice)
        tip = tr(
            "Degrees the rows are turned clockwise from east (-180 to 180); the pictures turn with them. Points "
            "have no rows."
        )
        angle = spin("grid_angle_deg", -_ANGLE_DEG, _ANGLE_DEG, 6, " °", tip)
        tip = tr("Fly the area a second time, in rows across the first ones: about twice the images")
        crosshatch = tick("crosshatch", tr("Crosshatch"), tip)
        two = {"grid_angle_deg": angle, "crosshatch": crosshatch}
        self.add_two(tr("Grid angle"), *two, two)
        orders = (("serpentine", tr("Serpentine (to and fro)")), ("one-way", tr("One way")))
        tip = tr("Serpentine: every other row is flown back. One way: every row is flown from its beginning.")
        self.add("order", tr("Order"), combo("order", orders, tip))
