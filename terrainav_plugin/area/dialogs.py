"""Dialogs about the layer or pose file from which an area is taken."""

from __future__ import annotations

from qgis.core import QgsFieldProxyModel, QgsMapLayer, QgsProject, QgsVectorLayer
from qgis.gui import QgsFieldComboBox, QgsMapLayerComboBox
from qgis.PyQt.QtWidgets import (
    QButtonGroup,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QRadioButton,
    QWidget,
)

from ...core.fields import Field, field_named
from ...core.mission.parts import utc_time
from ...core.mission.pose_table import usual_names
from ...core.poses.line import turn_radius_m
from ...core.poses.reading import likely_format
from ...core.poses.settings import (
    COUNTED_FORMATS,
    LOCAL_FORMATS,
    LOG_FORMATS,
    WITHOUT_TIMES,
    LineFlight,
    PoseFile,
)
from ...core.units import LENGTHS_M
from ..compat import LINE_LAYERS, POINT_LAYERS, POLYGON_LAYERS
from ..form.fields import field_choices, field_label, field_tip
from ..form.state import FormState, in_metres
from ..i18n import number_text, tr
from ..map.mission_group import preview_layers
from ..plain import plain_label
from ..widgets import NumberBox, choose, combo, named, ok_and_cancel, row, show_row, spin, tick
from .layers import PointFields

_MOST, _MOST_INTERVAL = 1e9, 1e6
#: Default interval between images.
_INTERVAL_S = 2.0
#: Number of decimals of degrees, about a centimetre.
DEGREES = 7


class LayerDialog(QDialog):
    """Ask for a layer.

    Parameters
    ----------
    active : QgsMapLayer or None
        Layer selected initially, if the dialog offers it.
    """

    def __init__(self, parent: QWidget, title: str, active: QgsMapLayer | None, kind: object = None) -> None:
        super().__init__(parent)
        self.setObjectName("area_layer_dialog")
        self.setWindowTitle(title)
        self.layer = named(QgsMapLayerComboBox(), "layer", tr("Layer of this project, in any CRS"))
        if kind is not None:
            self.layer.setFilters(kind)
        self.layer.setExceptedLayerList(preview_layers(QgsProject.instance()))
        if active is not None:
            self.layer.setLayer(active)
        if self.layer.currentLayer() is None and self.layer.count():
            # The dialog does not offer the active layer: select the first one.
            self.layer.setCurrentIndex(0)
        self.words = named(plain_label(), "words")
        self.words.setWordWrap(True)
        self.buttons = ok_and_cancel(self)
        self.form = QFormLayout(self)
        self.form.addRow(tr("&Layer"), self.layer)
        self.form.addRow(self.words)
        self._add_entries()
        self.form.addRow(self.buttons)
        self.layer.layerChanged.connect(self.show_layer)
        self.show_layer(self.layer.currentLayer())

    def chosen(self) -> QgsMapLayer | None:
        """Return the chosen layer."""
        return self.layer.currentLayer()

    def show_layer(self, layer: QgsMapLayer | None) -> None:
        """Describe the area that would be taken from a layer."""
        ok = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        ok.setEnabled(layer is not None)
        self.words.setText(self._describe(layer) if layer is not None else tr("The project has no such layer."))

    def _add_entries(self) -> None:
        """Add further entries."""

    def _describe(self, layer: QgsMapLayer) -> str:
        return tr(
            "The smallest box of longitudes and latitudes around it ({crs}), or its rectangle, as a "
            "polygon, if the box would be much larger."
        ).format(crs=layer.crs().authid() or tr("no CRS"))


class PolygonDialog(LayerDialog):
    """Ask for a polygon layer, and whether to use all polygons or the selected ones.

    Attributes
    ----------
    select : QPushButton
        Closes the dialog, so that the user can select polygons on the map.
    """

    def __init__(self, parent: QWidget, title: str, active: QgsMapLayer | None) -> None:
        super().__init__(parent, title, active, POLYGON_LAYERS)
        rows = range(self.layer.count())
        ready = next((self.layer.layer(row) for row in rows if _says_which(self.layer.layer(row))), None)
        if ready is not None and not _says_which(self.chosen()):
            self.layer.setLayer(ready)

    def only_selected(self) -> bool:
        """Return whether to use selected features only."""
        return self.selected.isChecked()

    def show_layer(self, layer: QgsVectorLayer | None) -> None:
        """Show the number of polygons, and of selected polygons, in a layer."""
        count = 0 if layer is None else layer.selectedFeatureCount()
        self.selected.setText(tr("&Selected ({n})").format(n=number_text(count)))
        self.selected.setEnabled(count > 0)
        self.all.setEnabled(layer is not None)
        (self.selected if count else self.all).setChecked(True)
        self.select.setEnabled(layer is not None)
        super().show_layer(layer)
        if layer is None:
            self.words.setText(tr("The project has no layer of polygons: add one, or draw a polygon instead."))

    def _add_entries(self) -> None:
        self.all = named(QRadioButton(tr("&All")), "all")
        self.selected = named(QRadioButton(), "selected")
        for button in (self.all, self.selected):
            button.setToolTip(tr("Polygons that are taken, with their holes"))
        self.form.addRow(tr("Polygons"), row(self.all, self.selected, stretch=1))
        self.select = named(
            self.buttons.addButton(tr("Select on the &map"), QDialogButtonBox.ButtonRole.ActionRole),
            "select_on_map",
            tr("Click a polygon of this layer on the map; it becomes the area"),
        )

    def _describe(self, layer: QgsVectorLayer) -> str:
        selected, count = layer.selectedFeatureCount(), layer.featureCount()
        if count == 1:
            return tr("Its only polygon will be used.")
        if selected == 0:
            return tr("Nothing is selected: all {n} polygons are taken.").format(n=number_text(count))
        if selected == 1:
            return tr("1 polygon is selected.")
        return tr("{n} polygons are selected.").format(n=number_text(selected))


def _says_which(layer: QgsVectorLayer | None) -> bool:
    """Whether it is clear which polygons of a layer to use: the selected ones, or the only one."""
    return layer is not None and (layer.selectedFeatureCount() > 0 or layer.featureCount() == 1)


class PointsDialog(LayerDialog):
    """Ask for a point layer, and the sources of heights, attitudes and times.

    Fields with common names are selected initially.
    """

    def __init__(self, parent: QWidget, active: QgsMapLayer | None, agl: float, agl_unit: str) -> None:
        self._agl, self._agl_unit = agl, agl_unit
        super().__init__(parent, tr("Points of a layer"), active, POINT_LAYERS)

    def fields(self) -> PointFields:
        """Return the sources of heights, attitudes and times."""
        m_per_unit = LENGTHS_M[self.unit.currentData()]
        return PointFields(
            self.agl.value() * m_per_unit,
            agl_field=self.agl_field.currentField() if self.by_field.isChecked() else "",
            yaw_field=self.yaw_field.currentField(),
            roll_field=self.roll_field.currentField(),
            time_field=self.time_field.currentField(),
            m_per_unit=m_per_unit,
            **{f"{self.tilt_is.currentData()}_field": self.tilt_field.currentField()},
        )

    def only_selected(self) -> bool:
        """Return whether to use selected features only."""
        return self.selected.isChecked()

    def show_layer(self, layer: QgsVectorLayer | None) -> None:
        """Show the fields of a layer and the number of selected points."""
        count = 0 if layer is None else layer.selectedFeatureCount()
        self.selected.setText(tr("&Selected ({n})").format(n=number_text(count)))
        self.selected.setEnabled(count > 0)
        (self.selected if count else self.all).setChecked(True)
        usual = usual_names([] if layer is None else layer.fields().names())
        if "tilt" not in usual and "gimbal_pitch" in usual:
            usual["tilt"] = usual["gimbal_pitch"]
            choose(self.tilt_is, "gimbal_pitch")
        else:
            choose(self.tilt_is, "tilt")
        for what, fields in (
            ("agl", self.agl_field),
            ("yaw", self.yaw_field),
            ("tilt", self.tilt_field),
            ("roll", self.roll_field),
            ("time", self.time_field),
        ):
            fields.setLayer(layer)
            if what in usual:
                fields.setField(usual[what][0])
        self.by_field.setEnabled(self.agl_field.count() > 0)
        (self.by_field if "agl" in usual else self.by_value).setChecked(True)
        super().show_layer(layer)

    def _add_entries(self) -> None:
        self.all = named(QRadioButton(tr("&All")), "all")
        self.selected = named(QRadioButton(), "selected")
        for button in (self.all, self.selected):
            button.setToolTip(tr("Features that become images"))
        self.form.addRow(tr("Features"), row(self.all, self.selected, stretch=1))
        self.by_value, self.by_field = (
            QRadioButton(tr("&Height of all")),
            QRadioButton(tr("Height from &field")),
        )
        self.by_value.setObjectName("by_value")
        self.by_field.setObjectName("by_field")
        self.by_value.setToolTip(tr("The same height above ground (AGL) for all points"))
        self.by_field.setToolTip(tr("An attribute holds each point's height above ground (AGL), in the unit below"))
        self.agl: NumberBox = spin("agl", 0.0, _MOST, 4, "", tr("Height above the ground (AGL) in the unit below"))
        self.agl.setValue(self._agl)
        self.agl_field = _fields("agl_field", tr("Numbers above 0, in the unit below"))
        self.unit = combo("unit", (("m", tr("m")), ("ft", tr("ft"))), tr("Metres or international feet"))
        self.unit.setCurrentIndex(self.unit.findData(self._agl_unit))
        self.form.addRow(self.by_value, self.agl)
        self.form.addRow(self.by_field, self.agl_field)
        self.form.addRow(tr("&Unit of heights"), self.unit)
        self.yaw_field = _fields("yaw_field", tr("Degrees clockwise from north; empty: the mission's yaw"))
        self.tilt_field = _fields("tilt_field", tr("Degrees; empty: the mission's tilt"))
        self.tilt_is = combo(
            "tilt_is",
            (("tilt", tr("tilt: 0 looks down")), ("gimbal_pitch", tr("gimbal pitch: -90 looks down"))),
            tr("Where the angle is 0: straight down, or at the horizon"),
        )
        self.tilt_is.setMinimumContentsLength(max(map(len, map(self.tilt_is.itemText, range(2)))))
        self.roll_field = _fields("roll_field", tr("Degrees, right side down; empty: the mission's roll"))
        self.time_field = _fields(
            "time_field",
            tr(
                "Dates with their times, text such as 2024-06-21T10:30:00Z, or seconds after 1970, in UTC where no "
                "zone is stated; empty: they follow from the mission's start and airspeed. Images are in the order of "
                "times."
            ),
            QgsFieldProxyModel.Filter.DateTime,
        )
        for fields in (self.yaw_field, self.tilt_field, self.roll_field, self.time_field):
            fields.setAllowEmptyFieldName(True)
        self.form.addRow(tr("&Yaw from field"), self.yaw_field)
        self.form.addRow(tr("&Tilt from field"), self.tilt_field)
        self.form.addRow("", self.tilt_is)
        self.form.addRow(tr("&Roll from field"), self.roll_field)
        self.form.addRow(tr("Ti&me from field"), self.time_field)
        # Radio buttons of one parent form one choice unless grouped.
        for pair in ((self.all, self.selected), (self.by_value, self.by_field)):
            choice = QButtonGroup(self)
            for button in pair:
                choice.addButton(button)
        self.by_value.toggled.connect(self.agl.setEnabled)
        self.by_field.toggled.connect(self.agl_field.setEnabled)
        self.agl_field.setEnabled(False)
        self.by_value.setChecked(True)

    def _describe(self, layer: QgsVectorLayer) -> str:
        return tr("One image above each point ({crs}).").format(crs=layer.crs().authid() or tr("no CRS"))


class LineDialog(LayerDialog):
    """Ask for a line layer, and how to fly its lines.

    Parameters
    ----------
    state : FormState
        State with the initial height, unit and airspeed.
    """

    def __init__(self, parent: QWidget, active: QgsMapLayer | None, state: FormState) -> None:
        self._state = state
        super().__init__(parent, tr("Line of a layer"), active, LINE_LAYERS)

    def flight(self) -> LineFlight:
        """Return how to fly the lines; raises InvalidInput."""
        return LineFlight(
            self.speed.value(),
            bank_deg=self.bank.value(),
            fixed_camera=self.fixed_camera.isChecked(),
            **{self.interval_in.currentData(): self.interval.value()},
        )

    def agl_m(self) -> float:
        """Return the height above ground."""
        return in_metres(self.agl.value(), LENGTHS_M[self.unit.currentData()])

    def show_layer(self, layer: QgsVectorLayer | None) -> None:
        """Show which lines are flown, and the radius of turns."""
        super().show_layer(layer)
        if layer is None:
            self.words.setText(tr("The project has no layer of lines: add one, or draw a box instead."))

    def _add_entries(self) -> None:
        self.speed, self.bank = (number_entry(field_named(LineFlight, name)) for name in ("speed_m_per_s", "bank_deg"))
        self.interval: NumberBox = spin(
            "interval",
            0.001,
            _MOST_INTERVAL,
            3,
            "",
            tr("Interval between images; the first is at the beginning"),
        )
        self.interval_in = combo(
            "interval_in",
            (("every_s", tr("seconds")), ("every_m", tr("metres"))),
            tr("Time, or distance flown"),
        )
        self.agl: NumberBox = spin("agl", 0.0, _MOST, 4, "", tr("Height above the ground (AGL) of the whole flight"))
        self.unit = combo("unit", (("m", tr("m")), ("ft", tr("ft"))), tr("Metres or international feet"))
        camera = field_named(LineFlight, "fixed_camera")
        self.fixed_camera = tick("fixed_camera", field_label(camera), field_tip(camera))
        self.speed.setValue(self._state.airspeed_m_per_s)
        self.interval.setValue(_INTERVAL_S)
        self.agl.setValue(self._state.agl)
        choose(self.unit, self._state.agl_unit)
        self.bank.setValue(LineFlight.bank_deg)
        for name, entry in (("speed_m_per_s", self.speed), ("bank_deg", self.bank)):
            self.form.addRow(field_label(field_named(LineFlight, name)), entry)
            entry.valueChanged.connect(lambda _: self.show_layer(self.chosen()))
        self.form.addRow(self.fixed_camera)
        self.form.addRow(tr("&Interval"), row(self.interval, self.interval_in, stretch=0))
        self.form.addRow(tr("&Height above ground"), row(self.agl, self.unit, stretch=0))

    def _describe(self, layer: QgsVectorLayer) -> str:
        selected, count = layer.selectedFeatureCount(), layer.featureCount()
        if selected > 1:
            which = tr("{n} lines are selected and will be flown one after the other.").format(n=number_text(selected))
        elif selected == 1:
            which = tr("1 line is selected.")
        elif count == 1:
            which = tr("Its only line will be flown.")
        else:
            which = tr("Nothing is selected: all {n} lines will be flown one after the other.").format(
                n=number_text(count)
            )
        turns = tr("Corners become turns with a radius of {radius} m.").format(
            radius=number_text(turn_radius_m(self.flight()), ",.1f")
        )
        return f"{which} {turns}"


def number_entry(field: Field, name: str = "") -> NumberBox:
    """Number box for a declared field, with its range."""
    decimals = 0 if field.kind is int else field.unit.decimals
    least = field.least if field.least is not None else 10.0**-decimals
    most = field.most if field.most is not None else _MOST
    return spin(name or field.name, least, most, decimals, field.unit.suffix, field_tip(field))


class PosesDialog(QDialog):
    """Ask for the parameters that a trajectory or flight log does not state, depending on its format.

    Parameters
    ----------
    path : str
        Path of the file; its ending or first line determines the initial format.
    state : FormState
        State with the initial height, unit and start.
    """

    def __init__(self, parent: QWidget, path: str, state: FormState) -> None:
        super().__init__(parent)
        self.setObjectName("poses_dialog")
        self.setWindowTitle(tr("Trajectory or flight log"))
        self._state = state
        self.form = QFormLayout(self)
        self.words = named(plain_label(), "words")
        self.words.setWordWrap(True)
        self._add_frame()
        self.form.insertRow(1, self.words)
        self._add_heights()
        self._add_sampling()
        self.buttons = ok_and_cancel(self)
        self.form.addRow(self.buttons)
        self.format.currentIndexChanged.connect(self._show_format)
        choose(self.format, likely_format(path))
        self._show_format()

    def set_origin(self, lon_deg: float, lat_deg: float) -> None:
        """Set the initial origin of a local frame."""
        self.origin_lat.setValue(lat_deg)
        self.origin_lon.setValue(lon_deg)

    def pose_settings(self) -> PoseFile:
        """Return the parameters for reading the file; raises InvalidInput."""
        file_format = self.format.currentData()
        is_local, by_value = file_format in LOCAL_FORMATS, self.by_value.isChecked()
        interval = self.interval_in.currentData()
        return PoseFile(
            file_format,
            origin=(self.origin_lat.value(), self.origin_lon.value(), self.origin_height.value()) if is_local else (),
            body=self.body.currentData() if is_local else None,
            world=self.world.currentData() if is_local else None,
            ground_height_m=None if by_value else self.ground.number(),
            agl_m=in_metres(self.agl.value(), LENGTHS_M[self.unit.currentData()]) if by_value else None,
            start_s=utc_time(self._state.start).timestamp() if self.restart.isChecked() else None,
            times=self.times.currentData() or None,
            flight=self.flight.number() if file_format in LOG_FORMATS else None,
            nadir=self.nadir.isChecked(),
            **({interval: self.interval.value()} if interval else {}),
        )

    def _show_format(self) -> None:
        """Show the entries that the chosen format needs."""
        file_format = self.format.currentData()
        is_local, is_log = file_format in LOCAL_FORMATS, file_format in LOG_FORMATS
        for row_of in (self._origin, self.body, self.world):
            show_row(self.form, row_of, is_local)
        choose(self.body, "urf" if file_format == "euroc" else "camera")
        choose(self.world, "rdf" if file_format == "kitti" else "enu")
        (self.by_value if file_format == "gpx" else self.by_file).setChecked(True)
        show_row(self.form, self.nadir, file_format != "gpx")
        self.nadir.setChecked(False)
        self._show_times(file_format)
        show_row(self.form, self.flight, is_log)
        choose(self.interval_in, "every_s" if is_log else "")
        self._show_interval()
        self.ground.setSpecialValueText(tr("the origin") if is_local else tr("home") if is_log else tr("not set"))
        self.words.setText(self._describe(file_format))

    def _show_times(self, file_format: str) -> None:
        """Offer units of time if the file does not state its unit."""
        has_times = file_format != "kitti"
        self.times.clear()
        self.times.addItem(tr("as in the file"), "")
        for value, label in field_choices(field_named(PoseFile, "times")) if has_times else ():
            if value == WITHOUT_TIMES or file_format in COUNTED_FORMATS:
                self.times.addItem(label, value)
        for entry in (self.times, self.restart):
            show_row(self.form, entry, has_times)
        self.restart.setChecked(False)

    def _show_interval(self) -> None:
        self.interval.setEnabled(bool(self.interval_in.currentData()))

    def _add_frame(self) -> None:
        fields = {name: field_named(PoseFile, name) for name in ("format", "origin", "body", "world")}
        self.format, self.body, self.world = (
            combo(name, field_choices(fields[name]), field_tip(fields[name])) for name in ("format", "body", "world")
        )
        tip = field_tip(fields["origin"])
        self.origin_lat = spin("origin_lat", -90.0, 90.0, DEGREES, " °", tip)
        self.origin_lon = spin("origin_lon", -180.0, 180.0, DEGREES, " °", tip)
        ground = field_named(PoseFile, "ground_height_m")
        self.origin_height = spin("origin_height", ground.least, ground.most, 3, ground.unit.suffix, tip)
        self._origin = row(self.origin_lat, self.origin_lon, self.origin_height)
        for name, entry in (
            ("format", self.format),
            ("origin", self._origin),
            ("body", self.body),
            ("world", self.world),
        ):
            self.form.addRow(field_label(fields[name]), entry)

    def _add_heights(self) -> None:
        agl, ground = (field_named(PoseFile, name) for name in ("agl_m", "ground_height_m"))
        self.by_file = named(QRadioButton(tr("Heights of the fi&le, over ground at")), "by_file", field_tip(ground))
        self.by_value = named(QRadioButton(tr("&Height of all")), "by_value", field_tip(agl))
        self.ground = spin("ground", ground.least, ground.most, 3, ground.unit.suffix, field_tip(ground))
        self.ground.allow_unset(ground.least - 1.0)
        self.ground.enter(None)
        self.agl: NumberBox = spin("agl", 0.0, _MOST, 4, "", field_tip(agl))
        self.agl.setValue(self._state.agl)
        self.unit = combo("unit", (("m", tr("m")), ("ft", tr("ft"))), tr("Metres or international feet"))
        choose(self.unit, self._state.agl_unit)
        heights = row(self.agl, self.unit, stretch=0)
        self.form.addRow(self.by_file, self.ground)
        self.form.addRow(self.by_value, heights)
        self.by_file.toggled.connect(self.ground.setEnabled)
        self.by_file.toggled.connect(heights.setDisabled)

    def _add_sampling(self) -> None:
        nadir = field_named(PoseFile, "nadir")
        self.nadir = tick("nadir", field_label(nadir), field_tip(nadir))
        self.interval: NumberBox = spin(
            "interval", 0.001, _MOST_INTERVAL, 3, "", tr("Interval between images; the first is at the beginning")
        )
        self.interval.setValue(_INTERVAL_S)
        self.interval_in = combo(
            "interval_in",
            (("", tr("all positions")), ("every_s", tr("seconds")), ("every_m", tr("metres"))),
            tr("All positions of the file, or one per interval of time or distance"),
        )
        self.interval_in.setMinimumContentsLength(len(self.interval_in.itemText(0)))
        self.interval_in.currentIndexChanged.connect(self._show_interval)
        self.restart = tick(
            "restart",
            tr("Begin at the panel's &start"),
            tr("Give the first position the time of Start; otherwise times are those of the file"),
        )
        times, flight = (field_named(PoseFile, name) for name in ("times", "flight"))
        self.times = combo("times", (), field_tip(times))
        self.times.setMinimumContentsLength(len(tr("as in the file")))
        self.flight: NumberBox = spin("flight", flight.least, flight.most, 0, "", field_tip(flight))
        self.flight.allow_unset(flight.least - 1.0)
        self.flight.enter(None)
        self.form.addRow(field_label(times), self.times)
        self.form.addRow(field_label(flight), self.flight)
        self.form.addRow(tr("&Interval"), row(self.interval, self.interval_in, stretch=0))
        self.form.addRow(self.nadir)
        self.form.addRow(self.restart)

    @staticmethod
    def _describe(file_format: str) -> str:
        if file_format in LOCAL_FORMATS:
            return tr("Poses in metres in a local frame, whose place is not in the file.")
        if file_format == "gpx":
            return tr(
                "Heights of GPX are usually above sea level. The top of each image points in the direction of travel."
            )
        return tr(
            "Heights are above home, or above the first position. The camera is fixed to the aircraft "
            "and looks down, with the top of its image ahead."
        )


def _fields(name: str, tip: str, more: QgsFieldProxyModel.Filter | None = None) -> QgsFieldComboBox:
    fields = named(QgsFieldComboBox(), name, tip)
    # Offer text fields too, as they may contain numbers.
    kinds = QgsFieldProxyModel.Filter.Numeric | QgsFieldProxyModel.Filter.String
    fields.setFilters(kinds if more is None else kinds | more)
    return fields
