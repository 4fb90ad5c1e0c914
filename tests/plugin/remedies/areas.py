"""What refusals of areas advise, in the panel and on the map."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransformContext,
    QgsFeature,
    QgsGeometry,
    QgsProject,
    QgsRasterLayer,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QLocale, Qt
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication, QDialogButtonBox
from terrainav.core.mission.areas.area import Box
from terrainav.terrainav_plugin.area.dialogs import LineDialog, PolygonDialog
from terrainav.terrainav_plugin.area.layers import (
    PointFields,
    layer_extent_area,
    read_lines,
    read_points,
    read_polygons,
)
from terrainav.terrainav_plugin.area.patterns import CorridorDialog, RandomDialog
from terrainav.terrainav_plugin.form.area import area_of_text, entered_area
from terrainav.terrainav_plugin.form.state import FormState
from terrainav.terrainav_plugin.map.canvas import canvas_rectangle
from terrainav.terrainav_plugin.processing.areas import layer_crs
from terrainav.terrainav_plugin.qgis_source.snapshot import grid_of_layers, source_name

from tests.plugin.steps import SMALL_BOX
from tests.plugin.test_area_layers import choose_way, dialog_of, layer_of
from tests.plugin.test_background import follow_hint, small_pictures  # noqa: F401  (a fixture)
from tests.support import rasters
from tests.support.remedies import Case, remedy

CONTEXT = QgsCoordinateTransformContext()
UTM = "EPSG:32616"
SQUARE = "Polygon ((0 0, 9 0, 9 9, 0 9, 0 0))"
LINE = "LineString (1 1, 2 2)"
BOW_TIE = "Polygon ((0 0, 10 10, 0 10, 10 0, 0 0))"


def feature(wkt: str | QgsGeometry) -> QgsFeature:
    made = QgsFeature(7)
    made.setGeometry(QgsGeometry.fromWkt(wkt) if isinstance(wkt, str) else wkt)
    return made


def area(*shapes, crs=UTM):
    return read_polygons(map(feature, shapes), QgsCoordinateReferenceSystem(crs), CONTEXT)


def points(*shapes):
    return read_points(map(feature, shapes), QgsCoordinateReferenceSystem("EPSG:4326"), CONTEXT, PointFields(120.0))


def lines(*shapes):
    return read_lines(map(feature, shapes), QgsCoordinateReferenceSystem("EPSG:4326"), CONTEXT, 120.0)


@remedy("area/layers.py", "no polygon is selected: select at least one in its layer")
def _none_selected(case: Case) -> None:
    case.refused(area)
    case.follow("select at least one in its layer", lambda: area(SQUARE))


@remedy("area/layers.py", "{feature} has no geometry: select one that has")
def _empty(case: Case) -> None:
    case.refused(lambda: area("Polygon EMPTY"))
    case.follow("select one that has", lambda: area(SQUARE))


@remedy("area/layers.py", "{feature} is not a polygon: select one that is")
def _no_polygon(case: Case) -> None:
    case.refused(lambda: area("Point (1 1)"))
    case.follow("select one that is", lambda: area(SQUARE))


@remedy(
    "area/layers.py",
    "{feature} is not a valid polygon ({what}): repair it first (Processing: Fix geometries)",
)
def _unsound(case: Case) -> None:
    spike = "Polygon ((0 0, 9 0, 9 9, 5 9, 5 15, 5 9, 0 9, 0 0))"
    case.refused(lambda: area(spike))
    # As the algorithm does: a part that is no area is left out.
    repaired = [part for part in QgsGeometry.fromWkt(spike).makeValid().asGeometryCollection() if part.area() > 0.0]
    case.follow("repair it first (Processing: Fix geometries)", lambda: area(*repaired))


@remedy("area/layers.py", "{feature} has a hole around a pole: cut it into parts without one")
def _hole_around_a_pole(case: Case) -> None:
    hole = "(-900 -900, 900 -900, 900 900, -900 900, -900 -900)"
    whole = f"Polygon ((-9000 -9000, 9000 -9000, 9000 9000, -9000 9000, -9000 -9000), {hole})"
    case.refused(lambda: area(whole, crs="EPSG:3031"))
    part = "Polygon ((-9000 900, 9000 900, 9000 9000, -9000 9000, -9000 900))"
    case.follow("cut it into parts without one", lambda: area(part, crs="EPSG:3031"))


@remedy("area/layers.py", "{feature} has an edge through a pole or across the edge of its map: cut it")
def _through_a_pole(case: Case) -> None:
    # A cone that is unrolled: beyond its tip the map ends on both sides.
    cone = QgsCoordinateReferenceSystem("PROJ:+proj=lcc +lat_1=40 +lat_2=60 +lat_0=50 +lon_0=10 +datum=WGS84")
    across = "Polygon ((-1000000 6500000, 1000000 6500000, 1000000 7500000, -1000000 7500000, -1000000 6500000))"
    case.refused(lambda: read_polygons([feature(across)], cone, CONTEXT))
    half = "Polygon ((1000 6500000, 1000000 6500000, 1000000 7500000, 1000 7500000, 1000 6500000))"
    case.follow("cut it", lambda: read_polygons([feature(half)], cone, CONTEXT))


@remedy("area/layers.py", "no points to use: select some, or use all points of the layer")
def _no_points(case: Case) -> None:
    case.refused(points)
    case.follow("select some", lambda: points("Point (1 1)"))
    case.follow("use all points of the layer", lambda: points("Point (1 1)", "Point (2 2)"))


@remedy("area/layers.py", "{feature} has no geometry: give it a point, or leave it out")
def _no_place(case: Case) -> None:
    case.refused(lambda: points("Point (1 1)", "Point EMPTY"))
    case.follow("give it a point", lambda: points("Point (1 1)", "Point (2 2)"))
    case.follow("leave it out", lambda: points("Point (1 1)"))


@remedy("area/layers.py", "{feature} is not a point: choose a layer of points")
def _no_point(case: Case) -> None:
    case.refused(lambda: points(SQUARE))
    case.follow("choose a layer of points", lambda: points("Point (1 1)"))


@remedy("area/layers.py", "no lines to fly: select some, or use all lines of the layer")
def _no_lines(case: Case) -> None:
    case.refused(lines)
    case.follow("select some", lambda: lines(LINE))
    case.follow("use all lines of the layer", lambda: lines(LINE, LINE))


@remedy("area/layers.py", "{feature} has no geometry: give it a line, or leave it out")
def _no_way(case: Case) -> None:
    case.refused(lambda: lines(LINE, "LineString EMPTY"))
    case.follow("give it a line", lambda: lines(LINE, LINE))
    case.follow("leave it out", lambda: lines(LINE))


@remedy("area/layers.py", "{feature} is not a line: choose a layer of lines")
def _no_line(case: Case) -> None:
    case.refused(lambda: lines(SQUARE))
    case.follow("choose a layer of lines", lambda: lines(LINE))


@remedy("tasks.py", "layer “{name}” has no CRS: set it in the layer's properties")
def _no_crs(case: Case) -> None:
    """As the extent of a layer, in Processing, and as a source."""
    project = case.fixture("project")
    points = QgsVectorLayer("Point", "mine", "memory")
    points.dataProvider().addFeatures([feature("Point (1 1)"), feature("Point (2 2)")])
    points.updateExtents()
    utm = (465_000.0, 1.0, 0.0, 5_247_000.0, 0.0, -1.0)
    path = rasters.write(case.tmp_path / "plain.tif", np.ones((3, 8, 8), np.uint8), utm, 32632)
    raster = project.addMapLayer(QgsRasterLayer(str(path), "plain", "gdal"))
    uses = (
        (points, "EPSG:4326", lambda: layer_extent_area(points, project)),
        (points, "EPSG:4326", lambda: layer_crs(points)),
        (raster, "EPSG:32632", lambda: grid_of_layers(source_name(raster), project)),
    )
    for layer, _, use in uses:
        layer.setCrs(QgsCoordinateReferenceSystem())
        case.refused(use)
    for layer, crs, _ in uses:
        layer.setCrs(QgsCoordinateReferenceSystem(crs))
    case.follow("set it in the layer's properties", lambda: [use() for _, _, use in uses])


@remedy("form/area.py", "give every point a yaw, or none")
def _yaws(case: Case) -> None:
    case.refused(lambda: area_of_text("35 10 120 5\n35 11 120", 120.0, "m"))
    case.follow("give every point a yaw", lambda: area_of_text("35 10 120 5\n35 11 120 6", 120.0, "m"))
    case.follow("none", lambda: area_of_text("35 10 120\n35 11 120", 120.0, "m"))


@remedy(
    "form/area.py",
    "coordinates “{text}”: a comma may stand between numbers or before decimals; write points before decimals, or "
    "spaces between numbers",
)
def _commas(case: Case) -> None:
    before = QLocale()
    QLocale.setDefault(QLocale("es_ES"))
    try:
        case.refused(lambda: area_of_text("35,14,-89,9", 50.0, "m"))
        case.follow("write points before decimals", lambda: area_of_text("35.14,-89.9", 50.0, "m"))
        case.follow("spaces between numbers", lambda: area_of_text("35,14 -89,9", 50.0, "m"))
    finally:
        QLocale.setDefault(before)


@remedy("map/canvas.py", "this place cannot be shown in the project's CRS {crs}; choose another CRS")
def _no_such_place(case: Case) -> None:
    project, far = QgsProject.instance(), Box(1.0, 179.0, -1.0, -179.0)
    # The Earth as it is seen from far above Greenwich.
    globe = QgsCoordinateReferenceSystem("PROJ:+proj=geos +h=35785831")
    assert "CRS (custom);" in case.refused(lambda: canvas_rectangle(far, globe, project))
    mercator = QgsCoordinateReferenceSystem("EPSG:3857")
    case.follow("choose another CRS", lambda: not canvas_rectangle(far, mercator, project).isEmpty())


@remedy("area/control.py", "the clipboard holds no text; copy coordinates first")
def _nothing_copied(case: Case) -> None:
    desk = case.fixture("desk")
    QApplication.clipboard().clear()
    choose_way(desk, "paste")
    case.says("\n".join(desk.messages()))

    def copy():
        QApplication.clipboard().setText("35.16_-89.90_35.157_-89.897")
        choose_way(desk, "paste")
        return desk.session.state().has_box

    case.follow("copy coordinates first", copy)


TWO_SQUARES = ("Polygon ((0 0, 1 0, 1 1, 0 1, 0 0))", "Polygon ((2 0, 3 0, 3 1, 2 0))")


def asked_for_a_polygon(desk):
    """The dialog for the polygon of a layer that has two of them and none selected."""
    desk.look_at("EPSG:4326", (-0.5, -1.0, 3.5, 2.0))
    desk.iface.setActiveLayer(layer_of("Polygon", "EPSG:4326", TWO_SQUARES))
    choose_way(desk, "polygon")
    return dialog_of(desk)


def click_polygon(desk):
    desk.canvas.waitWhileRendering()
    at = desk.canvas.getCoordinateTransform().transform(0.3, 0.4)
    desk.click_map(at.toQPointF().toPoint())
    desk.wait(lambda: "Polygon, 4 corners" in desk.form.area.words.text())


@remedy("area/control.py", "Click one polygon of “{layer}” on the map.")
def _waiting_for_a_click(case: Case) -> None:
    desk = case.fixture("desk")
    desk.click(asked_for_a_polygon(desk).select)
    case.says("\n".join(desk.messages()))
    case.follow("Click one polygon of “mine” on the map.", lambda: click_polygon(desk))


@remedy("area/dialogs.py", "The project has no layer of polygons: add one, or draw a polygon instead.")
def _no_polygons(case: Case) -> None:
    desk = case.fixture("desk")
    choose_way(desk, "polygon")
    dialog = dialog_of(desk)
    case.says(dialog.words.text())
    dialog.reject()

    def add():
        layer_of("Polygon", "EPSG:4326", TWO_SQUARES[:1])
        again = PolygonDialog(desk.dock, "", None)
        return again.buttons.button(QDialogButtonBox.StandardButton.Ok).isEnabled()

    case.follow("add one", add)
    case.follow("draw a polygon instead.", lambda: drawn_polygon(desk))


@remedy("area/dialogs.py", "The project has no layer of lines: add one, or draw a box instead.")
def _no_line_layer(case: Case) -> None:
    desk = case.fixture("desk")
    choose_way(desk, "line")
    dialog = dialog_of(desk)
    case.says(dialog.words.text())
    dialog.reject()

    def add():
        layer_of("LineString", "EPSG:4326", [LINE])
        again = LineDialog(desk.dock, None, FormState())
        return again.buttons.button(QDialogButtonBox.StandardButton.Ok).isEnabled()

    case.follow("add one", add)
    case.follow("draw a box instead.", lambda: drawn(desk))


@remedy("area/patterns.py", "no area to draw poses in: draw a box or a polygon first")
def _no_area_for_poses(case: Case) -> None:
    desk = case.fixture("desk")

    def poses():
        return RandomDialog(desk.dock, desk.session.state()).reading(QgsProject.instance())

    case.refused(poses)
    case.follow("draw a box", lambda: drawn(desk) and poses() is not None)
    desk.session.missions.begin_new()
    case.follow("a polygon first", lambda: drawn_polygon(desk) and poses() is not None)


@remedy("area/patterns.py", "the camera is not complete: fix its fields in the panel first")
def _no_camera_for_rows(case: Case) -> None:
    desk = case.fixture("desk")
    layer = layer_of("LineString", "EPSG:4326", [LINE])
    desk.form.set_state(replace(desk.session.state(), aspect="wide"))

    def rows():
        return CorridorDialog(desk.dock, layer, desk.session.state()).reading(QgsProject.instance())

    case.refused(rows)

    def fix():
        desk.type_text(desk.form.camera_group.aspect, "3:2")
        return rows() is not None

    case.follow("fix its fields in the panel first", fix)


def look_at_ground(desk):
    """Have the map show a place, and a layer there."""
    layer_of("Point", "EPSG:4326", ["Point (0 0)"])
    QTest.qWait(50)
    desk.look_at("EPSG:4326", (-0.5, -1.0, 3.5, 2.0))


def drawn(desk):
    """Draw a box on the map."""
    look_at_ground(desk)
    desk.click(desk.form.area.draw_box)
    desk.drag(desk.at(0.4, 0.4), desk.at(0.6, 0.6))
    return desk.session.state().has_box


def drawn_polygon(desk):
    """Draw a triangle on the map."""
    look_at_ground(desk)
    desk.click(desk.form.area.draw_polygon)
    return clicked_triangle(desk)


def clicked_triangle(desk):
    for place in ((0.4, 0.4), (0.6, 0.4), (0.6, 0.6)):
        desk.click_map(desk.at(*place))
    QTest.keyClick(desk.canvas, Qt.Key.Key_Return)
    return bool(desk.session.state().shape)


@remedy("area/control.py", "Go on drawing; Backspace removes the last corner.")
def _outline_refused(case: Case) -> None:
    desk = case.fixture("desk")
    look_at_ground(desk)
    desk.click(desk.form.area.draw_polygon)
    for place in ((0.2, 0.2), (0.6, 0.2), (0.6, 0.6), (0.4, 0.1)):
        desk.click_map(desk.at(*place))
    case.says("\n".join(desk.messages()))
    case.follow("Go on drawing", lambda: clicked_more(desk))
    case.follow("Backspace removes the last corner.", lambda: desk.session.state().shape)


def clicked_more(desk):
    desk.click_map(desk.at(0.5, 0.7))
    QTest.keyClick(desk.canvas, Qt.Key.Key_Backspace)
    QTest.keyClick(desk.canvas, Qt.Key.Key_Return)
    return len(entered_area(desk.session.state()).rings[0]) == 3


@remedy("panel/planning.py", "no area yet; draw a box or enter coordinates")
def _no_area(case: Case) -> None:
    desk = case.fixture("desk")
    desk.click(desk.dock.capture)
    case.says("\n".join(desk.messages()))
    case.follow("draw a box", lambda: drawn(desk) and desk.wait_planned() is not None)
    desk.session.missions.begin_new()
    assert not desk.session.state().has_box

    def enter():
        desk.enter_box(**SMALL_BOX)
        return desk.wait_planned() is not None

    case.follow("enter coordinates", enter)


@remedy("session.py", "show the selected imagery")
def _empty_map_with_area(case: Case) -> None:
    case.fixture("small_pictures")
    desk = case.fixture("desk")
    desk.enter_box(**SMALL_BOX)
    case.says(desk.dock.hint.text().replace("</a>", "").replace(">", ">\n").replace(", or add", "\n"))
    follow_hint(desk)
    desk.wait_for_tasks()
    case.follow("show the selected imagery", lambda: desk.wait(lambda: bool(QgsProject.instance().mapLayers())))
    assert desk.canvas.mapTool() is not desk.session.box_tool


@remedy("session.py", "show the selected imagery and draw a box")
def _empty_map(case: Case) -> None:
    case.fixture("small_pictures")
    desk = case.fixture("desk")
    case.says(desk.dock.hint.text().replace("</a>", "").replace(">", ">\n").replace(", or add", "\n"))
    follow_hint(desk)
    desk.wait_for_tasks()
    case.follow("show the selected imagery", lambda: desk.wait(lambda: bool(QgsProject.instance().mapLayers())))
    desk.wait(lambda: desk.canvas.mapTool() is desk.session.box_tool)

    def draw():
        desk.drag(desk.at(0.4, 0.4), desk.at(0.6, 0.6))
        return desk.session.state().has_box

    case.follow("and draw a box", draw)
