"""Groups of entries: flight, output, and what most missions leave as it is."""

from __future__ import annotations

import html
from dataclasses import replace
from typing import Any

from qgis.gui import QgsFileWidget
from qgis.PyQt.QtCore import Qt, pyqtSignal
from qgis.PyQt.QtWidgets import QLabel, QLineEdit

from ..form.camera import shown_gsd
from ..form.state import FormState
from ..i18n import number_text, tr
from ..units import length_text
from ..widgets import FieldMarks, FieldMessage, combo, row, spin, tick
from .entries import Entries, Section

#: What the spin boxes let through; what is right is said in words.
_HEIGHT, _GSD, _ANGLE_DEG, _SPEED_M_PER_S = 1e9, 1e9, 1e4, 1e4
#: Flights below this are seldom meant: such a height comes of a small image.
_LOW_M = 20.0
#: Numbers are taken as typed, and judged in words: what a spin box lets through is far more than what is right.
_ANGLE, _HEIGHT_M, _WIND_M_PER_S, _BUDGET_PX, _ZOOM, _SIZE_PX = 1e4, 1e6, 1e4, 1e6, 99, 1_000_000


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


class OutputEntries(Entries):
    """Group of the output."""

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("output", tr("Output"), marks)
        self.folder = QgsFileWidget()
        self.folder.setObjectName("folder")
        self.folder.setStorageMode(QgsFileWidget.StorageMode.GetDirectory)
        self.folder.setDialogTitle(tr("Folder for the pictures"))
        self.folder.setToolTip(tr("Folder for the pictures; its last part names the mission on the map"))
        # A label's key goes to what is typed into.
        self.folder.setFocusProxy(self.folder.lineEdit())
        self.add("folder", tr("Folder"), self.folder)
        formats = (
            ("tif", tr("GeoTIFF (lossless)")),
            ("jpg", tr("JPEG (smaller)")),
            ("png", tr("PNG")),
        )
        tip = tr("Format of the pictures; all three know their coordinate reference system")
        self.image_format = combo("image_format", formats, tip)
        self.add("image_format", tr("Format"), self.image_format)


class AttitudeSection(Section):
    """Where every picture looks, how high the ground lies, and when the flight begins."""

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("attitude", tr("Attitude, ground and time"), marks)
        yaw = tr(
            "Direction of the picture's top edge, in degrees clockwise from north (-360 to 360); counted from the "
            "grid's own north where a grid angle turns the rows"
        )
        tilt = tr(
            "Degrees the view is lifted from straight down (0) towards the picture's top edge; "
            "90 looks level (-180 to 180)"
        )
        roll = tr("Degrees the camera is rolled about its line of sight, right side down (-180 to 180)")
        ground = tr("Height of the ground above the WGS84 ellipsoid, in metres (-12,000 to 9,000)")
        self.add("yaw_deg", tr("Yaw"), spin("yaw_deg", -_ANGLE, _ANGLE, 6, " °", yaw))
        self.add("tilt_deg", tr("Tilt"), spin("tilt_deg", -_ANGLE, _ANGLE, 6, " °", tilt))
        self.add("roll_deg", tr("Roll"), spin("roll_deg", -_ANGLE, _ANGLE, 6, " °", roll))
        name = "ground_height_m"
        self.add(name, tr("Ground height"), spin(name, -_HEIGHT_M, _HEIGHT_M, 3, " m", ground))
        start = QLineEdit()
        start.setObjectName("start")
        start.setPlaceholderText("2024-06-21T10:30:00Z")
        start.setToolTip(
            tr("Time of the first image, in UTC as 2024-06-21T10:30:00Z: the clock of the simulated flight")
        )
        self.add("start", tr("Start"), start)


class PixelsSection(Section):
    """Which of the source's pixels are taken, and what size they are written in."""

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("pixels", tr("Pixels"), marks)
        ways = (
            ("auto", tr("Automatic")),
            ("zoom", tr("Zoom")),
            ("gsd", tr("Ground per px")),
        )
        tip = tr(
            "Which of the source's pixels make the pictures. Automatic: those that come nearest to the camera's, whose "
            "ground per px follows from the height and the image's longer side."
        )
        self.add("resolution", tr("Source's pixels"), combo("resolution", ways, tip))
        tip = tr(
            "Zoom level of the source, without unit: each one has pixels half the size of the one before"
        )
        self._zoom = self.add("zoom", tr("Zoom"), spin("zoom", -_ZOOM, _ZOOM, 0, "", tip))
        tip = tr("Ground that a pixel of the source is to show, in metres; the zoom nearest to it is taken")
        name = "gsd_m_per_px"
        self._gsd = self.add(name, tr("Source's ground per px"), spin(name, 0.0, 1e6, 6, " m", tip))
        tip = tr(
            "Also take zooms above the finest that the source has pixels of its own for. Pictures get more pixels "
            "(px), and show nothing more."
        )
        self.upsample = tick("upsample", tr("Allow enlarged pixels"), tip)
        self.add("upsample", "", self.upsample)
        tip = tr(
            "No picture gets a longer side than so many pixels (px; of a source's 256 px tiles): where one would, a "
            "coarser zoom is taken for all"
        )
        most = spin("max_px", 0, _SIZE_PX, 0, " px", tip)
        most.setSpecialValueText(tr("no limit"))
        self.add("max_px", tr("Longest side"), most)
        tip = tr("Resize every picture to the width and height below, in pixels (px)")
        self.add("resize", "", tick("resize", tr("Resize pictures"), tip))
        names = ("resize_width_px", "resize_height_px")
        tips = (
            tr("Width of the resized pictures in pixels (px)"),
            tr("Height of the resized pictures in pixels (px)"),
        )
        sizes = {name: spin(name, 0, _SIZE_PX, 0, " px", tip) for name, tip in zip(names, tips)}
        self._size = self.add_two(tr("To"), *names, sizes, "×")
        tip = tr("Write one channel of grey values instead of three of colours (without unit)")
        self._grey = self.add("resize_grey", "", tick("resize_grey", tr("Grey"), tip))
        self.edited.connect(self._show_rows)
        self._show_rows()

    def _show_rows(self) -> None:
        """Show what is said by the choices made."""
        values = self.values()
        self.show_row(self._zoom, values["resolution"] == "zoom")
        self.show_row(self._gsd, values["resolution"] == "gsd")
        for field in (self._size, self._grey):
            self.show_row(field, values["resize"])


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
        speed = tr("Mean wind at flight height, in metres a second; below the airspeed")
        name = "wind_speed_m_per_s"
        self.add(name, tr("Speed"), spin(name, -_WIND_M_PER_S, _WIND_M_PER_S, 3, " m/s", speed))
        origin = tr("Direction the wind blows from, in degrees clockwise from north")
        self.add("wind_from_deg", tr("From"), spin("wind_from_deg", -_ANGLE, _ANGLE, 3, " °", origin))
        gusts = tr(
            "Strength of the gusts: their standard deviation over the mean wind, without unit; "
            "about 0.1 over water, 0.2 over fields, 0 for a steady wind"
        )
        self.add("turbulence", tr("Turbulence"), spin("turbulence", -1e3, 1e3, 4, "", gusts))
        self.toggled.connect(lambda: self.edited.emit("wind"))

    def values(self) -> dict[str, Any]:
        """Return what is entered, and whether it counts."""
        return {**super().values(), "wind": self.isChecked()}

    def enter(self, state: FormState) -> None:
        """Enter the fields of a state; opens where the wind is switched on."""
        switched_on = state.wind and not self.isChecked()
        self.setChecked(state.wind)
        super().enter(state)
        if switched_on:
            self.unfold()


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
        budget = tr(
            "Most that the errors of all steps may add up to, in pixels of the planned image, by their bounds; "
            "above 0. The cheapest methods that fit are used."
        )
        name = "error_budget_px"
        self.add(name, tr("Error budget"), spin(name, 0.0, _BUDGET_PX, 12, " px", budget))
        tip = tr("Where no methods fit the budget (px), take the most accurate ones instead of refusing")
        self.add("accept_error", "", tick("accept_error", tr("Go on beyond the budget"), tip))
        frames = (
            ("auto", tr("Automatic")),
            ("map", tr("Map frame (north-up)")),
            ("camera", tr("Camera frame (as seen)")),
        )
        tip = tr(
            "Map frame: a window of the source's own pixels, for cameras that look straight down. Camera frame: "
            "the picture as the camera sees it. Automatic: a map frame where its error in px fits the budget."
        )
        frame = combo("frame", frames, tip)
        self.add("frame", tr("Pictures"), frame)
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
        resampling = combo("resampling", kernels, tip)
        self.add("resampling", tr("Resampling"), resampling)
        # What a camera frame is resampled with says nothing about a map frame.
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
