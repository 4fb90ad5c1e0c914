"""Groups of entries: flight, output and less common entries."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import QRect, Qt, pyqtSignal
from qgis.PyQt.QtWidgets import QCompleter, QFormLayout, QLabel, QLineEdit, QMenu, QWidget

from ...core.fields import declared_fields
from ...core.geodesy.lens import COEFFICIENTS, LENS_FIELDS, PERSPECTIVE
from ...core.mission.parts import (
    BY_ISO,
    BY_TIME,
    FLAT_PARTS,
    IDEAL,
    LONGEST_SIDE,
    REALISM_PARTS,
    SHORTEST,
    ImageSensor,
)
from ...core.mission.presets import CAMERA_KINDS
from ...core.mission.sensors import CUSTOM, shipped_sensors
from ..form.camera import shown_gsd
from ..form.fields import field_label, field_tip
from ..form.state import DECLARED, FormState
from ..form.text import short_place
from ..i18n import number_text, tr
from ..paths import icon
from ..plain import plain_label
from ..units import gsd_text, length_text
from ..widgets import (
    FieldMarks,
    FieldMessage,
    ShortLine,
    combo,
    folder_entry,
    form_layout,
    named,
    push_button,
    row,
    short_number,
    show_row,
    spin,
    tick,
    tool_button,
)
from .elevation import HeightsLine
from .entries import (
    Entries,
    FacingBox,
    Section,
    declared_choice,
    declared_line,
    declared_number,
    declared_tick,
    declared_widget,
)
from .keyboard import KEYLESS
from .layers import BuildingsLine, LabelsLine, LayersLine
from .presets import PresetChooser
from .start import StartEntry

if TYPE_CHECKING:
    from ...core.mission.plan import Plan

#: Figures of an image sensor.
_FIGURES = tuple(one.name for one in declared_fields(ImageSensor) if one.kind in (float, int))
#: Largest values of the spin boxes, beyond the valid ones: messages explain invalid values.
_HEIGHT, _GSD, _SIZE_PX = 1e9, 1e9, 1_000_000


class FlightEntries(Entries):
    """Group of the flight.

    Signals
    -------
    align_clicked(str)
        The user wants to align the rows, in one of `parts.ALIGNMENTS`.
    profile_clicked()
        The user wants to see the height profile.
    fastest_clicked()
        The user wants the greatest airspeed that the camera allows.

    Attributes
    ----------
    height_by : str
        Entry that determines the height, as in `FormState`: of height and ground sample distance, the one changed last.
    """

    align_clicked = pyqtSignal(str)
    profile_clicked = pyqtSignal()
    fastest_clicked = pyqtSignal()

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("flight", tr("Flight"), marks)
        self.height_by = "agl"
        self._add_height()
        self._add_overlap()
        self._add_lines()

    def values(self) -> dict[str, Any]:
        """Return the values of the entries; a ground sample distance that does not determine the height is 0."""
        values = {**super().values(), "height_by": self.height_by}
        return values if self.height_by == "gsd" else {**values, "camera_gsd": 0.0}

    def enter(self, state: FormState) -> None:
        """Enter the fields of a state; the ground sample distance may be computed from its height."""
        self.camera_gsd.setSuffix(" " + (tr("in") if state.agl_unit == "ft" else tr("cm")))
        gsd = shown_gsd(state)
        super().enter(replace(state, camera_gsd=gsd if state.height_by == "gsd" else short_number(gsd)))
        # Set it last, as entering a value above counts as typing.
        self.height_by = state.height_by
        self.show_low(state)

    def show_low(self, state: FormState) -> None:
        """Warn of a ground sample distance that results in a low flight."""
        # Flights below 20 m are seldom intended, but follow from a small image size.
        is_low = state.height_by == "gsd" and 0.0 < state.agl_m < 20.0
        text = tr(
            "With {px} px along the image's longer side, this means flying {height} above ground. To fly "
            "higher, increase “Image's longer side” under Camera."
        ).format(px=number_text(state.image_px), height=length_text(state.agl_m, state.agl_unit))
        self.low.say(text if is_low else "")

    def _add_height(self) -> None:
        self.agl = spin(
            "agl",
            -_HEIGHT,
            _HEIGHT,
            4,
            "",
            tr("Height above ground (AGL), in the unit selected beside it"),
        )
        self.agl_unit = combo(
            "agl_unit",
            (("m", tr("m")), ("ft", tr("ft"))),
            tr("Metres or international feet, for this height and for lengths and areas in the estimates"),
        )
        self.agl.valueChanged.connect(lambda: setattr(self, "height_by", "agl"))
        self.take("agl_unit", self.agl_unit)
        self.add("agl", field_label(DECLARED["agl"]), self.agl, row(self.agl, self.agl_unit, stretch=0))
        tip = tr(
            "Ground sample distance (GSD) of the camera, straight down, in cm per px (inches with feet). "
            "Height and GSD depend on each other; the one entered last is kept. The estimates show the GSD of "
            "the source."
        )
        self.camera_gsd = spin("camera_gsd", 0.0, _GSD, 4, "", tip)
        self.camera_gsd.valueChanged.connect(lambda: setattr(self, "height_by", "gsd"))
        tip = tr("Show the heights of flight, ground and surface along the flight, below the map")
        self.profile = push_button("profile", tr("Profile"), tip)
        self.profile.clicked.connect(lambda _checked: self.profile_clicked.emit())
        self.add("camera_gsd", tr("&GSD"), self.camera_gsd, row(self.camera_gsd, self.profile, stretch=0))
        self.low = named(FieldMessage(), "camera_gsd_hint")
        self.low.setWordWrap(True)
        self.low.hide()
        self._form.addRow(self.low)

    def _add_overlap(self) -> None:
        self.overlap_along, self.overlap_across = map(declared_number, ("overlap_along", "overlap_across"))
        self.overlap_along.setPrefix(tr("front") + " ")
        self.overlap_across.setPrefix(tr("side") + " ")
        for box in (self.overlap_along, self.overlap_across):
            box.setMinimumWidth(14 * box.fontMetrics().averageCharWidth())
        overlaps = {"overlap_along": self.overlap_along, "overlap_across": self.overlap_across}
        self.add_two(tr("Overlap"), *overlaps, overlaps)

    def _add_lines(self) -> None:
        self.layout_choice = declared_choice("layout")
        self.add_declared("layout", self.layout_choice)
        azimuth = declared_widget("row_azimuth_deg")
        self.align = push_button("align", tr("Align"), tr("Turn the rows to suit the area"))
        menu = named(QMenu(self.align), "align_menu")
        for way, text in ((LONGEST_SIDE, tr("Align to longest side")), (SHORTEST, tr("Shortest flight"))):
            action = menu.addAction(text)
            action.setObjectName(way)
            action.triggered.connect(lambda _checked=False, way=way: self.align_clicked.emit(way))
        self.align.setMenu(menu)
        label = field_label(DECLARED["row_azimuth_deg"])
        self.add("row_azimuth_deg", label, azimuth, row(azimuth, self.align, stretch=0))
        self.add_declared("order")
        self.add_declared("crosshatch")
        self.add_declared("facing", FacingBox("facing", field_tip(DECLARED["facing"])))
        airspeed = declared_widget("airspeed_m_per_s")
        tip = tr(
            "Enter the greatest speed for the minimum image interval, and for the exposure time and motion blur, which "
            "are in the tab Advanced; at most 15 m/s, as DJI's drones"
        )
        self.fastest = push_button("fastest", tr("Auto"), tip)
        self.fastest.clicked.connect(lambda _checked: self.fastest_clicked.emit())
        label = field_label(DECLARED["airspeed_m_per_s"])
        self.add("airspeed_m_per_s", label, airspeed, row(airspeed, self.fastest, stretch=0))


class OutputEntries(Entries):
    """Group of the output."""

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("output", tr("Output"), marks)
        tip = tr("Folder for the images; the mission takes its name on the map")
        self.folder = folder_entry("folder", tr("Folder for the images"), tip)
        self.add("folder", tr("Folder"), self.folder)
        self.image_format = declared_choice("image_format")
        self.add_declared("image_format", self.image_format)


class AttitudeSection(Section):
    """Attitude of the images, height of the ground, and start of the flight."""

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("attitude", tr("Attitude, ground and time"), marks)
        for name in ("yaw_deg", "random_yaw", "tilt_deg", "roll_deg", "ground_height_m"):
            self.add_declared(name)
        self.add_declared("start", StartEntry(field_tip(DECLARED["start"])))


class PixelsSection(Section):
    """Resolution of the source's pixels, and size of the images."""

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("pixels", tr("Pixels"), marks)
        ways = (
            ("auto", tr("Automatic")),
            ("zoom", tr("Zoom")),
            ("gsd", tr("GSD")),
        )
        tip = tr(
            "Zoom of the source. Automatic: the zoom whose GSD is closest to the camera's, which follows from "
            "the height and the image's longer side."
        )
        ways_chosen = combo("resolution", ways, tip)
        ways_chosen.activated.connect(self._way_chosen)
        self.add("resolution", tr("Source resolution"), ways_chosen)
        self._zoom_entry = declared_number("zoom")
        self._zoom = self.add_declared("zoom", self._zoom_entry)
        self._zooms = named(plain_label(), "zooms")
        self._zooms.setWordWrap(True)
        self._form.addRow(self._zooms)
        self._plan: Plan | None = None
        self._gsd = self.add_declared("gsd_m_per_px")
        crs = declared_line("crs")
        crs.setPlaceholderText(tr("the source's own"))
        self.add_declared("crs", crs)
        self.upsample = declared_tick("upsample")
        self.add_declared("upsample", self.upsample)
        self.add_declared("max_px")
        bands = declared_line("bands")
        bands.setPlaceholderText(tr("all, or the colour bands"))
        self.add_declared("bands", bands)
        self.add_declared("stretch")
        tip = tr("Resize every image to the width and height below, in pixels (px)")
        self.add("resize", "", tick("resize", tr("Resize images"), tip))
        names = ("resize_width_px", "resize_height_px")
        tips = (
            tr("Width of the resized images in pixels (px)"),
            tr("Height of the resized images in pixels (px)"),
        )
        sizes = {name: spin(name, 0, _SIZE_PX, 0, " px", tip) for name, tip in zip(names, tips)}
        self._size = self.add_two(tr("Size"), *names, sizes, "×")
        tip = tr("Write one grey channel instead of three colour channels")
        self._grey = self.add("resize_grey", "", tick("resize_grey", tr("Greyscale"), tip))
        self.edited.connect(self._show_rows)
        self._show_rows()

    def show_zooms(self, plan: Plan, unit: str) -> None:
        """Show the zooms of a plan's source with their ground sample distances; ``unit`` is m or ft."""
        self._plan, grid = plan, plan.grid
        text = tr(
            "Zoom {native} is the source's native resolution, with a GSD of {size}. Each zoom below it, down "
            "to {least}, doubles the GSD."
        )
        size = gsd_text(plan.resolution.source_m_per_px, unit)
        self._zooms.setText(text.format(native=grid.native_zoom, size=size, least=grid.min_zoom))
        self._show_rows()

    def source_gsd_m(self) -> float | None:
        """Ground sample distance of the source in the plan shown last; None before there is one."""
        return None if self._plan is None else self._plan.resolution.source_m_per_px

    def _way_chosen(self) -> None:
        """Enter the zoom of the plan if the source lacks the entered zoom."""
        values, plan = self.values(), self._plan
        if plan is None or values["resolution"] != "zoom":
            return
        highest = plan.grid.max_zoom if values["upsample"] else plan.grid.native_zoom
        if not plan.grid.min_zoom <= values["zoom"] <= highest:
            self._zoom_entry.setValue(plan.zoom)

    def _show_rows(self) -> None:
        """Show the rows that apply to the choices made."""
        values = self.values()
        self.show_row(self._zoom, values["resolution"] == "zoom")
        self._zooms.setVisible(values["resolution"] == "zoom" and self._plan is not None)
        self.show_row(self._gsd, values["resolution"] == "gsd")
        for field in (self._size, self._grey):
            self.show_row(field, values["resize"])


class ReliefSection(Section):
    """Elevation of the ground, and terrain following."""

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("relief", tr("Relief"), marks)
        for name in ("elevation", "surface"):
            line = HeightsLine(name, field_tip(DECLARED[name]))
            line.setPlaceholderText(tr("level ground") if name == "elevation" else tr("same as the elevation"))
            self.take(name, line)
            self._form.addRow(field_label(DECLARED[name]), self._marks.field(name, line, row(line, line.button)))
        self.add_declared("height_above")
        self.add_declared("climb_m_per_s")
        self.add_declared("height_tolerance_m")
        for name in ("clearance_m", "clearance_distance_m"):
            self.add_declared(name)
        datum = declared_line("vertical_datum")
        datum.setPlaceholderText(tr("as the source says"))
        self.add_declared("vertical_datum", datum)
        self.add_declared("height_unit")
        self.add_declared("height_offset_m")
        self.add_declared("holes")


class LabelsSection(Section):
    """Labels of pixels, buildings, and files with a value for every pixel."""

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("labels", tr("Labels and buildings"), marks)
        self._notes: dict[str, FieldMessage] = {}
        labels = LabelsLine("labels", field_tip(DECLARED["labels"]), tr("Choose a layer and its field of classes"))
        buildings = BuildingsLine("buildings", field_tip(DECLARED["buildings"]), tr("Choose footprints of buildings"))
        further = {
            labels: ("label_order", "line_width_m", "point_radius_m"),
            buildings: ("building_height_field", "building_height_m"),
        }
        for line, names in further.items():
            name = line.objectName()
            line.setPlaceholderText(tr("none"))
            self.take(name, line)
            self._form.addRow(field_label(DECLARED[name]), self._marks.field(name, line, row(line, line.button)))
            note = self._notes[name] = named(FieldMessage(), f"{name}_note")
            note.setWordWrap(True)
            note.hide()
            self._form.addRow(note)
            self._show_with(line, [self.add_declared(one) for one in names])
        self.add_declared("products")

    def show_notes(self, notes: Mapping[str, str]) -> None:
        """Show what the files of entries hold, by entry; entries without a text have no note."""
        for name, note in self._notes.items():
            note.say(notes.get(name, ""))

    def _show_with(self, line: LayersLine, fields: list[QWidget]) -> None:
        """Show rows where a line names something."""

        def show(text: str = "") -> None:
            for field in fields:
                self.show_row(field, bool(text.strip()))

        line.textChanged.connect(show)
        show()


class _EntryBlock(NamedTuple):
    """Rows that are shown and hidden together: what holds them, their form, and the widgets of the rows by field."""

    holder: QWidget
    form: QFormLayout
    rows: dict[str, QWidget]


class RealismSection(Section):
    """Effects of a real camera, by kind of camera and part by part; none by default."""

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("realism", tr("Camera realism"), marks)
        tip = tr("Fills in the effects of a kind of camera; a test shot shows them beside the ideal image")
        self.kinds = PresetChooser("camera_kind", CAMERA_KINDS, tip, labelled=False)
        self._form.addRow(tr("Kind of camera"), self.kinds)
        lens, *coefficients = LENS_FIELDS
        self.add_declared(lens)
        self.distortion = push_button("distortion", tr("Distortion"), tr("Show or hide the coefficients of the lens"))
        self.distortion.setCheckable(True)
        self.distortion.toggled.connect(self._show_rows)
        self._form.addRow("", self.distortion)
        self._coefficients = self._block(coefficients)
        self._rows = {}
        for part in REALISM_PARTS:
            names = [one.name for one in declared_fields(FLAT_PARTS[part])]
            for name in names:
                if name not in _FIGURES:
                    self._rows[name] = self.add_declared(name, _entry(name))
                elif name == _FIGURES[0]:
                    self._figures = self._block(_FIGURES)
        self.edited.connect(self._show_rows)
        self._show_rows()

    def enter(self, state: FormState) -> None:
        """Enter the fields of a state, and show the rows that apply."""
        super().enter(state)
        self._show_rows()

    def _block(self, names: Sequence[str]) -> _EntryBlock:
        """Add the entries of fields that are shown and hidden together."""
        holder, outer = QWidget(), self._form
        holder.setProperty(KEYLESS, True)
        self._form = form_layout(holder)
        self._form.setContentsMargins(0, 0, 0, 0)
        block = _EntryBlock(holder, self._form, {name: self.add_declared(name) for name in names})
        self._form = outer
        outer.addRow(holder)
        return block

    def _show_rows(self, *_: object) -> None:
        """Show the rows that apply to the choices made, and those of other values than the defaults."""
        values, usual = self.values(), FormState()
        exposure, sensor = values["exposure"], values["image_sensor"]
        applies = {
            "airlight": values["visibility_km"] is not None,
            **dict.fromkeys(("f_number", "iso", "illuminance_lx"), exposure != IDEAL),
            "metering": exposure in (BY_TIME, BY_ISO),
            **dict.fromkeys(("shortest_exposure_ms", "longest_exposure_ms"), exposure == BY_TIME),
            "highest_iso": exposure == BY_ISO,
            **dict.fromkeys(("bayer", "demosaicing"), bool(sensor)),
        }
        applies.update((name, name in COEFFICIENTS[values["lens"]]) for name in COEFFICIENTS[PERSPECTIVE])
        changed = {name for name in values if values[name] != getattr(usual, name)}
        for form, rows in ((self._form, self._rows), self._coefficients[1:]):
            for name, field in rows.items():
                show_row(form, field, applies.get(name, True) or name in changed)
        for block, is_on in ((self._coefficients, self.distortion.isChecked()), (self._figures, sensor == CUSTOM)):
            block.holder.setVisible(is_on or not changed.isdisjoint(block.rows))


def _entry(name: str) -> QWidget:
    """Widget for a field of a real camera."""
    if name != "image_sensor":
        return declared_widget(name)
    line = declared_line(name)
    line.setPlaceholderText(tr("ideal"))
    sensors = [*(one.name for one in shipped_sensors()), CUSTOM]
    names = QCompleter(sensors, line)
    names.setCaseSensitivity(Qt.CaseSensitivity.CaseInsensitive)
    names.setFilterMode(Qt.MatchFlag.MatchContains)
    names.popup().setTextElideMode(Qt.TextElideMode.ElideMiddle)
    line.setCompleter(names)
    wide = max(map(line.fontMetrics().horizontalAdvance, sensors)) + 20

    def list_all() -> None:
        names.setCompletionPrefix("")
        # The entry is narrower than names, and often at the right edge of the screen.
        names.complete(QRect(line.width() - wide, 0, wide, line.height()))

    arrow = QgsApplication.getThemeIcon("/mActionArrowDown.svg")
    every = line.addAction(arrow, QLineEdit.ActionPosition.TrailingPosition)
    every.setToolTip(tr("List the image sensors"))
    every.triggered.connect(list_all)
    return line


class RouteSection(Section):
    """Take-off, margin, connection of rows, trigger of the camera, and batteries.

    Signals
    -------
    pick_clicked(), rows_clicked(), splits_clicked()
        The user wants to pick the take-off point, rows to skip, or images after which the flight is split on the map.
    """

    pick_clicked = pyqtSignal()
    rows_clicked = pyqtSignal()
    splits_clicked = pyqtSignal()

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("route", tr("Flight path"), marks)
        self.takeoff = named(ShortLine(short_place), "takeoff", field_tip(DECLARED["takeoff"]))
        self.takeoff.setPlaceholderText(tr("none: from the first capture to the last"))
        self.takeoff.setClearButtonEnabled(True)
        self.pick_takeoff = tool_button(
            "pick_takeoff", icon("takeoff"), tr("Set take-off point, by a click on the map")
        )
        self.pick_takeoff.clicked.connect(lambda _checked: self.pick_clicked.emit())
        label = field_label(DECLARED["takeoff"])
        self.add("takeoff", label, self.takeoff, row(self.takeoff, self.pick_takeoff, stretch=0))
        for name in (
            "margin_m",
            "entry",
            "lead_in_m",
            "turnaround_m",
            "trigger",
            "photo_interval_s",
            "exposure_ms",
            "blur_px",
            "battery_min",
            "drone",
        ):
            self.add_declared(name)
        for name, clicked, tip in (
            ("skip_rows", self.rows_clicked, tr("Pick rows to skip, by clicks on the preview")),
            ("split_after", self.splits_clicked, tr("Pick the last images of sorties, by clicks on the preview")),
        ):
            line = declared_line(name)
            line.setPlaceholderText(tr("none"))
            button = tool_button(f"pick_{name}", QgsApplication.getThemeIcon("/mActionSelectRectangle.svg"), tip)
            button.clicked.connect(lambda _checked, clicked=clicked: clicked.emit())
            self.add(name, field_label(DECLARED[name]), line, row(line, button, stretch=0))


class WindSection(Section):
    """Wind and gusts, which move and turn the camera; off by default."""

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("wind", tr("Wind"), marks)
        self.setCheckable(True)
        self.setChecked(False)
        self.setToolTip(tr("Gusts move and turn the camera at every exposure; images show what the moved camera sees"))
        for name in ("wind_speed_m_per_s", "wind_from_deg", "turbulence"):
            self.add_declared(name)
        self.toggled.connect(lambda: self.edited.emit("wind"))

    def values(self) -> dict[str, Any]:
        """Return the values of the entries, and whether there is wind."""
        return {**super().values(), "wind": self.isChecked()}

    def enter(self, state: FormState) -> None:
        """Enter the fields of a state; unfold the group if that switches the wind on."""
        switched_on = state.wind and not self.isChecked()
        self.setChecked(state.wind)
        super().enter(state)
        if switched_on:
            self.unfold()


class AccuracySection(Section):
    """Error budget of images and footprints, and the kind of image.

    Signals
    -------
    reset_clicked()
        The user wants to reset the values that have no entries.
    """

    reset_clicked = pyqtSignal()

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__("accuracy", tr("Accuracy"), marks)
        self.add_declared("error_budget_px")
        self.add_declared("accept_error")
        frame, resampling = declared_choice("frame"), declared_choice("resampling")
        self.add_declared("frame", frame)
        self.add_declared("resampling", resampling)
        # The resampling of camera frames does not apply to map frames.
        frame.currentIndexChanged.connect(lambda: resampling.setEnabled(frame.currentData() != "map"))
        self.more = named(QLabel(), "more", tr("Settings in the mission file that the panel cannot show"))
        self.more.setWordWrap(True)
        self.more.setTextFormat(Qt.TextFormat.RichText)
        self.more.linkActivated.connect(self.reset_clicked)
        self._form.addRow(self.more)
        self._form.addRow(marks.label("more", self.more))
        self.more.hide()

    def show_more(self, text: str) -> None:
        """Show the values that have no entries; an empty text hides the line."""
        link = tr("reset")
        shown = tr("Also set: {text}").format(text=html.escape(text))
        self.more.setText(f'{shown} (<a href="forget">{link}</a>)' if text else "")
        self.more.setVisible(bool(text))
