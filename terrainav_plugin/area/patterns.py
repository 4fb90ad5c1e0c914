"""Dialogs for corridors, orbits, scans and random poses, and the points of these patterns."""

from __future__ import annotations

from functools import cache, partial
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsMapLayer,
    QgsProject,
    QgsVectorLayer,
)
from qgis.PyQt.QtWidgets import QDialog, QFormLayout, QWidget

from ...core.errors import InvalidInput
from ...core.fields import declared_fields, field_named
from ...core.mission.areas.area import Box, Polygon, Polygons
from ...core.mission.parts import Attitude, Flight
from ...core.poses.settings import Corridor, Orbit, Scan
from ..compat import LINE_LAYERS, POLYGON_LAYERS
from ..form.area import entered_area
from ..form.camera import state_camera
from ..form.fields import field_label
from ..i18n import number_text, tr
from ..plain import plain_label
from ..units import length_text
from ..widgets import NumberBox, named, ok_and_cancel, row, spin, tick
from .dialogs import DEGREES, LayerDialog, number_entry
from .layers import Found, Reading, line_reader, outline_reader
from .menu import AreaAction

if TYPE_CHECKING:
    from collections.abc import Callable

    from qgis.gui import QgisInterface

    from ...core.geodesy.camera import Camera, Poses
    from ..form.state import FormState


#: Menu entries that open a pattern's dialog; an orbit needs a click on the map first.
PATTERNS = (AreaAction.CORRIDOR, AreaAction.FACADE, AreaAction.STRUCTURE, AreaAction.RANDOM)


def pattern_dialog(way: str, iface: QgisInterface, state: FormState) -> Any:
    """Dialog of the pattern ``way``, one of `PATTERNS`; call its ``reading`` once it is accepted.

    Raises
    ------
    InvalidInput
        Random poses are wanted, but no area is entered.
    """
    window = iface.mainWindow()
    if way == AreaAction.RANDOM:
        return RandomDialog(window, state)
    kinds = {
        AreaAction.CORRIDOR: CorridorDialog,
        AreaAction.FACADE: FacadeDialog,
        AreaAction.STRUCTURE: StructureDialog,
    }
    return kinds[way](window, iface.activeLayer(), state)


class _Entries:
    """Number entries for the fields of a dataclass with declared fields."""

    def __init__(self, part: type, form: QFormLayout) -> None:
        self._part = part
        self.boxes: dict[str, NumberBox] = {}
        for field in declared_fields(part):
            box = number_entry(field)
            # The initial highest height is the lowest: a single height.
            start = field_named(part, "lowest_m") if field.name == "highest_m" else field
            box.setValue(start.initial_value or 0.0)
            self.boxes[field.name] = box
            form.addRow(field_label(field), box)

    def value(self) -> Any:
        """Return the object with the entered values; raises InvalidInput."""
        kinds = {field.name: field.kind for field in declared_fields(self._part)}
        return self._part(**{name: kinds[name](box.value()) for name, box in self.boxes.items()})


class _PatternDialog(LayerDialog):
    """Ask for a layer and the parameters of a pattern; the panel has camera, height and overlaps."""

    PART: type = Corridor

    def __init__(self, parent: QWidget, title: str, active: QgsMapLayer | None, kind: object, state: FormState) -> None:
        self._state = state
        super().__init__(parent, title, active, kind)

    def wanted(self) -> Any:
        """Return the pattern; raises InvalidInput."""
        return self.entries.value()

    def _add_entries(self) -> None:
        self.entries = _Entries(self.PART, self.form)

    def _describe(self, layer: QgsVectorLayer) -> str:
        selected, count = layer.selectedFeatureCount(), layer.featureCount()
        if selected:
            which = tr("Selected features are taken: {n}.").format(n=number_text(selected))
        elif count == 1:
            which = tr("Its only feature will be used.")
        else:
            which = tr("Nothing is selected in it: all {n} features are taken.").format(n=number_text(count))
        return f"{which} {self._panel_values()}"

    def _panel_values(self) -> str:
        """Text on the values taken from the panel."""
        return tr("Camera and overlaps ({along} %, {across} %) are those of the panel.").format(
            **_percents(self._state)
        )


class CorridorDialog(_PatternDialog):
    """Ask for a line layer and the width of the strip along its lines."""

    def __init__(self, parent: QWidget, active: QgsMapLayer | None, state: FormState) -> None:
        super().__init__(parent, tr("Corridor along a line"), active, LINE_LAYERS, state)

    def reading(self, project: QgsProject) -> Reading:
        """Return the reader of the corridor's rows; raises InvalidInput."""
        from ...core.poses.patterns import corridor

        wanted, camera, overlaps = self.wanted(), _camera(self._state), _overlaps(self._state)
        agl_m = self._state.agl_m
        return line_reader(
            self.chosen(),
            agl_m,
            lambda lines: Found(corridor(lines, camera, agl_m, overlaps, wanted), agl_m),
            project,
        )

    def _panel_values(self) -> str:
        return tr("Camera, height ({height}) and overlaps ({along} %, {across} %) are those of the panel.").format(
            height=length_text(self._state.agl_m, self._state.agl_unit), **_percents(self._state)
        )


class FacadeDialog(_PatternDialog):
    """Ask for a layer of lines at the feet of walls, and how to scan them."""

    PART = Scan

    def __init__(self, parent: QWidget, active: QgsMapLayer | None, state: FormState) -> None:
        super().__init__(parent, tr("Façade along a line"), active, LINE_LAYERS, state)

    def reading(self, project: QgsProject) -> Reading:
        """Return the reader of the façade's flights; raises InvalidInput."""
        from ...core.poses.patterns import facade

        wanted, camera, overlaps = self.wanted(), _camera(self._state), _overlaps(self._state)
        left, agl_m = self.left.isChecked(), wanted.lowest_m
        return line_reader(
            self.chosen(),
            agl_m,
            lambda lines: Found(facade(lines, camera, overlaps, wanted, left=left), agl_m),
            project,
        )

    def _add_entries(self) -> None:
        super()._add_entries()
        tip = tr("The camera stands to the left of the lines, in their direction; otherwise to their right")
        self.left = tick("left", tr("From the l&eft"), tip)
        self.form.addRow(self.left)


class StructureDialog(_PatternDialog):
    """Ask for a layer of structures' outlines, and how to scan them."""

    PART = Scan

    def __init__(self, parent: QWidget, active: QgsMapLayer | None, state: FormState) -> None:
        super().__init__(parent, tr("Structure around a polygon"), active, POLYGON_LAYERS, state)

    def reading(self, project: QgsProject) -> Reading:
        """Return the reader of the structure's flights; raises InvalidInput."""
        from ...core.poses.patterns import structure

        wanted, camera, overlaps = self.wanted(), _camera(self._state), _overlaps(self._state)
        return outline_reader(
            self.chosen(),
            lambda outlines: Found(structure(outlines, camera, overlaps, wanted), wanted.lowest_m),
            project,
        )


class OrbitDialog(QDialog):
    """Ask for circles around a centre, initially the point clicked."""

    def __init__(self, parent: QWidget, lat_deg: float, lon_deg: float) -> None:
        super().__init__(parent)
        self.setObjectName("orbit_dialog")
        self.setWindowTitle(tr("Orbit around a point"))
        self.form = QFormLayout(self)
        tip = tr("Centre of the circles, as clicked on the map")
        self.lat = spin("centre_lat", -90.0, 90.0, DEGREES, " °", tip)
        self.lon = spin("centre_lon", -180.0, 180.0, DEGREES, " °", tip)
        for box, value in ((self.lat, lat_deg), (self.lon, lon_deg)):
            box.setValue(value)
            # Qt leaves room for the ends of the range without decimals: add room for the decimals.
            digits = box.fontMetrics().horizontalAdvance("0" * (1 + DEGREES))
            box.setMinimumWidth(box.sizeHint().width() + digits)
        self.form.addRow(tr("Centre, l&atitude and longitude"), row(self.lat, self.lon))
        self.entries = _Entries(Orbit, self.form)
        self.form.addRow(ok_and_cancel(self))

    def reading(self, _project: QgsProject) -> Reading:
        """Return the reader of the circles; raises InvalidInput."""
        from ...core.poses.patterns import orbit

        wanted, centre = self.entries.value(), (self.lat.value(), self.lon.value())
        return lambda _task: Found(orbit(*centre, wanted), wanted.lowest_m)


class RandomDialog(QDialog):
    """Ask for distributions of poses inside the entered area; raises InvalidInput if no area is entered."""

    def __init__(self, parent: QWidget, state: FormState) -> None:
        area = entered_area(state)
        if not isinstance(area, (Box, Polygon, Polygons)):
            raise InvalidInput(tr("no area to draw poses in: draw a box or a polygon first"))
        super().__init__(parent)
        self.setObjectName("random_dialog")
        self.setWindowTitle(tr("Random poses in the area"))
        self._area = area
        self._state, self._seed = state, state.seed
        form = QFormLayout(self)
        words = named(plain_label(), "words")
        words.setWordWrap(True)
        words.setText(
            tr(
                "Places spread evenly over the area, in any direction, with heights and tilts spread evenly between "
                "two values."
            )
        )
        form.addRow(words)
        self.count = spin("count", 1, 1_000_000, 0, "", tr("Number of images"))
        self.count.setValue(500)
        form.addRow(tr("&Images"), self.count)
        agl, tilt = field_named(Flight, "agl_m"), field_named(Attitude, "tilt_deg")
        self.low, self.high = (number_entry(agl, name) for name in ("lowest", "highest"))
        self.tilt = spin(
            "most_tilt", 0.0, 90.0, tilt.unit.decimals, tilt.unit.suffix, tr("Maximum tilt; the minimum is 0")
        )
        # As entered in the panel, until another range is chosen.
        for box, value in ((self.low, state.agl_m), (self.high, state.agl_m), (self.tilt, 0.0)):
            box.setValue(value)
        form.addRow(tr("&Height above ground, from and to"), row(self.low, self.high))
        form.addRow(tr("&Tilt up to"), self.tilt)
        tip = tr(
            "Draw only poses from which the panel's camera sees no ground without imagery: other images, "
            "such as those at the edge of a raster, fail"
        )
        self.inside = tick("inside", tr("&Within the selected imagery"), tip)
        form.addRow(self.inside)
        form.addRow(ok_and_cancel(self))

    def reading(self, _project: QgsProject) -> Reading:
        """Return the reader of the poses; raises InvalidInput."""
        from ...core.poses.random_poses import Distribution, PoseDistributions, random_poses

        area, count, seed = self._area, int(self.count.value()), self._seed
        uniform = partial(Distribution, "uniform")
        poses = PoseDistributions(
            uniform(self.low.value(), self.high.value()),
            uniform(-180.0, 180.0),
            uniform(0.0, self.tilt.value()),
            Distribution("fixed", 0.0),
        )
        keep = _whole_images(self._state) if self.inside.isChecked() else None
        return lambda _task: _found(random_poses(area, count, poses, seed, keep))


def _whole_images(state: FormState) -> Callable[[Poses], Any]:
    """Function that tests which poses see no ground without imagery; raises FormError if an entry is invalid."""
    from ...core.geodesy.ellipsoid import WGS84
    from ...core.mission.inside import poses_inside
    from ..form.mission_form import mission
    from ..sources import grid_finder

    asked = mission(state)
    find_grid, camera, image_px = cache(grid_finder(asked)), asked.camera, asked.pixels.image_px
    ground = WGS84.raised(asked.flight.ground_height_m)
    return lambda poses: poses_inside(find_grid(), camera, poses, image_px, ground)


def _found(points: Any) -> Found:
    return Found(points, points.poses[0][2])


def _camera(state: FormState) -> Camera:
    camera = state_camera(state)
    if camera is None:
        raise InvalidInput(tr("the camera is not complete: fix its fields in the panel first"))
    return camera


def _overlaps(state: FormState) -> tuple[float, float]:
    return state.overlap_along, state.overlap_across


def _percents(state: FormState) -> dict[str, str]:
    return {name: number_text(100.0 * overlap, ".3g") for name, overlap in zip(("along", "across"), _overlaps(state))}
