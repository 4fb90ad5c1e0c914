"""Areas from layers: polygons and points in any CRS, and what is said where there is none."""

from __future__ import annotations

import math
import re
import sys
import zipfile

import numpy as np
import pytest
from osgeo import ogr
from pyproj import Proj, Transformer
from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransformContext,
    QgsFeature,
    QgsGeometry,
    QgsPointXY,
    QgsProject,
    QgsRectangle,
    QgsVectorFileWriter,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QDate, QDateTime, QPoint, Qt, QTime
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication, QDialogButtonBox, QFileDialog
from terrainav.core.errors import Cancelled, InvalidInput, OutputError
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.areas.files import load_area
from terrainav.terrainav_plugin.area.dialogs import LayerDialog
from terrainav.terrainav_plugin.area.layers import (
    EDGE_TOLERANCE_M,
    PointFields,
    area_file,
    no_fly_file,
    read_lines,
    read_points,
    read_polygons,
)
from terrainav.terrainav_plugin.area.xml import xml_elements

CONTEXT = QgsCoordinateTransformContext()
CONCAVE = (
    "((239000 3890000, 247000 3890000, 247000 3896000, 243000 3892000, 239000 3896000, 239000 3890000),"
    "(241000 3890500, 242500 3890500, 242500 3891800, 241000 3891800, 241000 3890500))"
)


def layer_of(kind, crs, wkts, fields="", values=()):
    """Memory layer in the project; rows of values for its fields."""
    layer = QgsVectorLayer(f"{kind}?crs={crs}{fields}", "mine", "memory")
    features = []
    for index, wkt in enumerate(wkts):
        feature = QgsFeature(layer.fields())
        if wkt:
            feature.setGeometry(QgsGeometry.fromWkt(wkt))
        if values:
            feature.setAttributes(list(values[index]))
        features.append(feature)
    layer.dataProvider().addFeatures(features)
    layer.updateExtents()
    QgsProject.instance().addMapLayer(layer)
    return layer


def polygon(wkt, crs):
    feature = QgsFeature(7)
    feature.setGeometry(QgsGeometry.fromWkt(wkt))
    return read_polygons([feature], QgsCoordinateReferenceSystem(crs), CONTEXT)


def dialog_of(desk):
    found = []

    def there():
        found[:] = [d for d in desk.iface.mainWindow().findChildren(LayerDialog) if d.isVisible()]
        return bool(found)

    desk.wait(there)
    return found[0]


def accept(desk, dialog):
    desk.click(dialog.buttons.button(QDialogButtonBox.StandardButton.Ok))
    desk.wait_for_tasks()
    QApplication.processEvents()


def choose_way(desk, name):
    desk.form.area.area_from.actions_by_name[name].trigger()


# --- KML

OUTER, INNER = (
    "-89.9,35.1,0 -89.8,35.1 -89.8,35.2 -89.9,35.2 -89.9,35.1",
    "-89.86,35.14 -89.84,35.14 -89.84,35.16",
)


def ring(coordinates):
    return f"<LinearRing><coordinates>{coordinates}</coordinates></LinearRing>"


def document(*placemarks, head='<?xml version="1.0" encoding="UTF-8"?>', mark=""):
    inside = "".join(f"<Placemark>{one}</Placemark>" for one in placemarks)
    kml = f'<{mark}kml xmlns{":" + mark[:-1] if mark else ""}="http://www.opengis.net/kml/2.2">'
    return f"{head}<!-- drawn -->{kml}{inside}</{mark}kml>"


FIELD = (
    f"<name>Größe &amp; Form</name><Polygon><outerBoundaryIs>{ring(OUTER)}</outerBoundaryIs><innerBoundaryIs>"
    f"{ring(INNER)}</innerBoundaryIs></Polygon>"
)
OTHER = FIELD.replace("-89.", "-88.").replace(
    INNER.replace("-89.", "-88."), "-88.86, 35.14 -88.84, 35.14 -88.84, 35.16"
)


@pytest.mark.parametrize(
    "body",
    [
        document(FIELD).encode(),
        document(FIELD, f"<MultiGeometry>{OTHER[OTHER.index('<Polygon') :]}</MultiGeometry>").encode(),
        document(FIELD, head='<?xml version="1.0" encoding="ISO-8859-1"?>').encode("latin-1"),
        document(FIELD, head="").encode("utf-16"),
        document(ring(OUTER), "<Point><coordinates>1,2</coordinates></Point>").encode(),
        document(FIELD.replace(OUTER, f"<![CDATA[{OUTER}]]>")).encode(),
        re.sub(r"<(/?)(?=[A-Za-z])(?!k:)", r"<\1k:", document(FIELD, mark="k:")).encode(),
        document("<Polygon/>", FIELD).encode(),
    ],
)
def test_kml_is_read_as_with_lxml(tmp_path, body):
    pytest.importorskip("lxml")
    path = tmp_path / "area.kml"
    path.write_bytes(body)
    assert load_area(path, xml_elements) == load_area(path)


def test_kml_is_read_without_lxml(tmp_path, monkeypatch):
    path = tmp_path / "area.kmz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("doc.kml", document(FIELD))
    monkeypatch.setitem(sys.modules, "lxml.etree", None)
    with pytest.raises(OutputError, match="lxml"):
        load_area(path)
    found = area_file(str(path))(None).area
    # Kept, as what is read of it belongs to it.
    opened = ogr.Open(f"/vsizip/{path}/doc.kml")
    feature = opened.GetLayer(0).GetNextFeature()
    drawn = feature.GetGeometryRef()
    assert drawn.GetGeometryCount() == len(found.rings)
    for at, corners in enumerate(found.rings):
        shape = drawn.GetGeometryRef(at)
        assert set(corners) == {shape.GetPoint_2D(number) for number in range(shape.GetPointCount())}
    assert no_fly_file(str(path))(None).area.parts == (found,)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("<kml><a>", "cannot be read as KML"),
        (document(FIELD)[:-9], "cannot be read as KML"),
        ("<kml>" + "<a>" * 5000 + "</a>" * 5000 + "</kml>", "deep"),
        ('<!DOCTYPE kml [<!ENTITY a "1">]>' + document(FIELD, head=""), "document type or entities"),
        (document(FIELD.replace(",35.1,0", ",north,0")), "corner '-89.9,north,0' is not longitude,latitude"),
    ],
)
def test_kml_that_is_none_is_refused_in_one_line(tmp_path, text, says):
    path = tmp_path / "area.kml"
    path.write_text(text)
    with pytest.raises(InvalidInput, match=says) as refused:
        load_area(path, xml_elements)
    assert "\n" not in str(refused.value)


# --- polygons


@pytest.mark.parametrize(
    ("crs", "wkt"),
    [
        ("EPSG:32616", f"Polygon {CONCAVE}"),
        ("EPSG:32616", "Polygon ((100000 3800000, 900000 3800000, 900000 4400000, 100000 3800000))"),
        ("EPSG:3857", "Polygon ((-10000000 4000000, -8000000 6000000, -7500000 4100000, -10000000 4000000))"),
        ("EPSG:3031", "Polygon ((500000 500000, 1500000 600000, 900000 1700000, 500000 500000))"),
        ("EPSG:2274", "Polygon ((700000 200000, 1900000 210000, 1800000 900000, 700000 200000))"),
    ],
)
def test_edges_stay_where_they_are_in_the_layer(crs, wkt):
    """Every place along every edge, by pyproj, is within the tolerance of the polygon's outline in degrees."""
    found = polygon(wkt, crs)
    to_degrees = Transformer.from_crs(crs, "EPSG:4326", always_xy=True)
    rings = QgsGeometry.fromWkt(wkt).asPolygon()
    assert len(found.rings) == len(rings)
    worst = 0.0
    for ring, corners in zip(rings, found.rings):
        closed = np.array([*corners, corners[0]])
        for start, end in zip(ring, ring[1:]):
            for step in range(200):
                share = step / 200.0
                x, y = (a + share * (b - a) for a, b in ((start.x(), end.x()), (start.y(), end.y())))
                worst = max(worst, metres_to_outline(closed, *to_degrees.transform(x, y)))
    assert worst <= EDGE_TOLERANCE_M


def metres_to_outline(closed, lon, lat):
    """Metres from a place to a line of straight pieces in degrees, on the plane that touches the Earth there."""
    plane = (closed - [lon, lat]) * [math.cos(math.radians(lat)), 1.0] * 111_319.49
    start, along = plane[:-1], np.diff(plane, axis=0)
    share = np.clip(-(start * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    return float(np.hypot(*(start + share[:, np.newaxis] * along).T).min())


def test_corners_are_kept_and_no_more_are_made_than_needed():
    found = polygon("Polygon ((-90 35, -89 35, -89 36, -89.5 35.2, -90 36, -90 35))", "EPSG:4326")
    assert found.rings == (((-90.0, 35.0), (-89.0, 35.0), (-89.0, 36.0), (-89.5, 35.2), (-90.0, 36.0)),)


@pytest.mark.parametrize(
    ("crs", "west", "south", "size", "off_deg"),
    [
        ("EPSG:25832", 462000, 5249900, 20000, 1e-9),
        ("EPSG:2180", 500000, 500000, 20000, 1e-9),
        # EPSG has 39 transformations of ED50 to WGS 84, of which GDAL and QGIS take different ones.
        ("EPSG:4230", 8.5, 47.4, 0.1, 1e-4),
    ],
)
def test_geojson_that_qgis_wrote_is_where_its_layer_is(tmp_path, crs, west, south, size, off_deg):
    wkt = QgsGeometry.fromRect(QgsRectangle(west, south, west + size, south + size)).asWkt()
    layer = layer_of("Polygon", crs, [wkt])
    options = QgsVectorFileWriter.SaveVectorOptions()
    options.driverName, options.layerOptions = "GeoJSON", ["COORDINATE_PRECISION=15"]
    path = tmp_path / "area.geojson"
    QgsVectorFileWriter.writeAsVectorFormatV3(layer, str(path), CONTEXT, options)
    assert crs.partition(":")[2] in path.read_text().partition("features")[0]
    area, no_fly = area_file(str(path))(None).area, no_fly_file(str(path))(None).area
    assert no_fly.parts == (area,)
    found, wanted = np.array(area.rings[0]), np.array(polygon(wkt, crs).rings[0])
    assert found.shape == wanted.shape
    assert np.abs(found - wanted).max() < off_deg


def test_curves_become_edges_within_the_tolerance():
    """A circle of a kilometre in UTM: its corners are on it, its edges' middles within the tolerance of it."""
    arcs = "500000 3900000, 501000 3901000, 502000 3900000, 501000 3899000, 500000 3900000"
    ring = polygon(f"CurvePolygon (CircularString ({arcs}))", "EPSG:32616").rings[0]
    to_utm = Transformer.from_crs("EPSG:4326", "EPSG:32616", always_xy=True)
    places = [to_utm.transform(*corner) for corner in ring]
    for (x0, y0), (x1, y1) in zip(places, places[1:] + places[:1]):
        for x, y in ((x0, y0), ((x0 + x1) / 2.0, (y0 + y1) / 2.0)):
            assert abs(math.hypot(x - 501_000, y - 3_900_000) - 1_000.0) <= EDGE_TOLERANCE_M


def test_polygon_across_the_antimeridian_runs_on():
    found = polygon("Polygon ((19900000 0, 20200000 0, 20200000 300000, 19900000 0))", "EPSG:3857")
    west, east = found.bounds.west_deg, found.bounds.east_deg
    assert west == pytest.approx(178.765, abs=1e-3)
    assert east == pytest.approx(-178.540, abs=1e-3)
    assert found.area_m2() < 1e11


@pytest.mark.parametrize(
    ("crs", "wkt", "words"),
    [
        (
            "EPSG:32616",
            "Polygon ((0 0, 10 10, 0 10, 10 0, 0 0))",
            r"feature 7 is not a valid polygon \(.*intersection.* \(5, 5\)\): repair it first",
        ),
        ("EPSG:32616", "Polygon EMPTY", "feature 7 has no geometry"),
        ("EPSG:32616", "Point (1 1)", "feature 7 is not a polygon"),
        (
            "EPSG:3031",
            "Polygon ((-9 -9, 9 -9, 9 9, -9 9, -9 -9), (-2 -2, 2 -2, 2 2, -2 2, -2 -2))",
            "feature 7 has a hole around a pole",
        ),
        (
            "EPSG:32616",
            "Polygon ((1e9 1e9, 2e9 1e9, 2e9 2e9, 1e9 1e9))",
            "feature 7: .* is outside the domain of EPSG:32616",
        ),
    ],
)
def test_what_makes_no_polygon_is_named(crs, wkt, words):
    with pytest.raises(InvalidInput, match=words):
        polygon(wkt, crs)


def test_multipolygon_of_one_part_is_one():
    assert len(polygon("MultiPolygon (((0 0, 1 0, 1 1, 0 0)))", "EPSG:4326").rings[0]) == 3


def test_selected_polygon_of_the_active_layer_is_planned_without_what_does_not_touch_it(desk, screenshot):
    """Through the whole dock: of all pictures of the box, those kept are those QGIS's own geometry finds to touch."""
    layer = layer_of("Polygon", "EPSG:32616", [f"Polygon {CONCAVE}", "Polygon ((0 0, 1 0, 1 1, 0 0))"])
    # QGIS takes a first layer's CRS, and zooms to it, once its events are worked through.
    QApplication.processEvents()
    desk.look_at("EPSG:3857", (-10_010_000, 4_178_000, -9_990_000, 4_192_000))
    desk.iface.setActiveLayer(layer)
    layer.selectByIds([1])
    desk.form.agl.setValue(400.0)
    choose_way(desk, "polygon")
    desk.wait_for_tasks()
    desk.wait(lambda: "Polygon" in desk.form.area.words.text())
    words = desk.form.area.words.text()
    assert words.startswith("Polygon, ")
    assert "1 hole" in words
    planned = desk.wait_planned()
    area = planned.mission.area
    kept = footprints(planned.plan)
    desk.click(desk.form.area.edit)
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    desk.canvas.waitWhileRendering()
    screenshot("polygon-preview")

    degrees = QgsGeometry.fromPolygonXY([[QgsPointXY(*corner) for corner in (*ring, ring[0])] for ring in area.rings])
    assert len(kept) > 20
    assert all(degrees.intersects(frame) for frame in kept)
    # The plan of the box around it has more, and none of those left out touches the polygon.
    choose_way(desk, "box")
    all_of_box = footprints(desk.wait_planned().plan)
    assert len(all_of_box) > len(kept)
    middles = {key(frame) for frame in kept}
    left_out = [frame for frame in all_of_box if key(frame) not in middles]
    assert len(left_out) >= len(all_of_box) - len(kept)
    # Rows are centred on what each holds of the area, so frames of the box may lie between those of the polygon.
    covered = QgsGeometry.unaryUnion(kept)
    assert degrees.difference(covered.buffer(1e-9, 2)).area() < 1e-9 * degrees.area()


def footprints(plan):
    """Rectangles of degrees of a plan's pictures, a pixel wider all around: their edges are rounded to pixels."""
    to_degrees = Transformer.from_crs("EPSG:3857", "EPSG:4326", always_xy=True)
    pixel = 2.0 * 20_037_508.342789244 / 256.0 / 2.0**plan.zoom
    rectangles = []
    for west, south, east, north in zip(*plan.edges):
        left, bottom = to_degrees.transform(west - pixel, south - pixel)
        right, top = to_degrees.transform(east + pixel, north + pixel)
        rectangles.append(QgsGeometry.fromRect(QgsRectangle(left, bottom, right, top)))
    return rectangles


def key(frame):
    middle = frame.boundingBox().center()
    return round(middle.x(), 7), round(middle.y(), 7)


def test_several_selected_polygons_are_one_area(desk):
    """Those that touch become one; each keeps its corners but those on the border between."""
    wkts = [
        "Polygon ((0 0, 0.01 0, 0.01 0.01, 0 0.01, 0 0))",
        "Polygon ((0.01 0, 0.02 0, 0.02 0.01, 0.01 0.01, 0.01 0))",
        "MultiPolygon (((0.04 0, 0.05 0, 0.05 0.01, 0.04 0)), ((0.06 0, 0.07 0, 0.07 0.01, 0.06 0)))",
    ]
    layer = layer_of("MultiPolygon", "EPSG:4326", wkts)
    desk.iface.setActiveLayer(layer)
    layer.selectAll()
    choose_way(desk, "polygon")
    desk.wait(lambda: desk.form.area.words.text().startswith("3 polygons, "))
    area = desk.wait_planned().mission.area
    whole = QgsGeometry.unaryUnion([QgsGeometry.fromWkt(wkt) for wkt in wkts])
    shapes = [
        QgsGeometry.fromPolygonXY([[QgsPointXY(*at) for at in (*part.rings[0], part.rings[0][0])]])
        for part in area.parts
    ]
    assert QgsGeometry.collectGeometry(shapes).symDifference(whole).area() == pytest.approx(0.0, abs=1e-15)


def test_layer_of_the_polygon_is_asked_for_where_the_active_one_has_none(desk, screenshot):
    wkts = ["Polygon ((0 0, 0.01 0, 0.01 0.01, 0 0))", "Polygon ((1 0, 1.01 0, 1.01 0.01, 1 0))"]
    layer = layer_of("Polygon", "EPSG:4326", wkts)
    layer_of("Point", "EPSG:4326", ["Point (0 0)"])
    choose_way(desk, "polygon")
    dialog = dialog_of(desk)
    assert dialog.words.text() == "Nothing is selected: all 2 polygons are taken."
    assert dialog.layer.count() == 1
    layer.selectByIds([1])
    dialog.show_layer(layer)
    screenshot("polygon-dialog", dialog)
    accept(desk, dialog)
    desk.wait(lambda: "Polygon, 3 corners" in desk.form.area.words.text())


def test_polygon_is_selected_on_the_map_from_the_dialog(desk, screenshot):
    wkts = ["Polygon ((0 0, 1 0, 1 1, 0 1, 0 0))", "Polygon ((2 0, 3 0, 3 1, 2 0))"]
    layer = layer_of("Polygon", "EPSG:4326", wkts)
    desk.look_at("EPSG:4326", (-0.5, -1.0, 3.5, 2.0))
    desk.iface.setActiveLayer(layer)
    choose_way(desk, "polygon")
    dialog = dialog_of(desk)
    screenshot("polygon-nothing-selected", dialog)
    desk.click(dialog.select)
    assert any("Click one polygon" in text for text in desk.messages())
    desk.canvas.waitWhileRendering()
    to_pixel = desk.canvas.getCoordinateTransform()
    desk.click_map(to_pixel.transform(0.3, 0.4).toQPointF().toPoint())
    desk.wait(lambda: "Polygon, 4 corners" in desk.form.area.words.text())
    # Later selections are the user's own business.
    layer.selectByIds([2])
    desk.wait_for_tasks()
    assert "Polygon, 4 corners" in desk.form.area.words.text()


def test_layer_that_says_which_polygon_is_offered_first(desk):
    many = ["Polygon ((0 0, 1 0, 1 1, 0 0))", "Polygon ((2 0, 3 0, 3 1, 2 0))"]
    active = layer_of("Polygon", "EPSG:4326", many)
    only = layer_of("Polygon", "EPSG:4326", ["Polygon ((0 0, 0.01 0, 0.01 0.01, 0 0))"])
    desk.iface.setActiveLayer(active)
    choose_way(desk, "polygon")
    dialog = dialog_of(desk)
    assert dialog.chosen() == only
    assert dialog.words.text() == "Its only polygon will be used."
    accept(desk, dialog)
    desk.wait(lambda: "Polygon, 3 corners" in desk.form.area.words.text())


def test_project_without_polygons_says_what_else_to_do(desk):
    choose_way(desk, "polygon")
    dialog = dialog_of(desk)
    assert "draw a polygon instead" in dialog.words.text()
    assert not dialog.buttons.button(QDialogButtonBox.StandardButton.Ok).isEnabled()
    assert not dialog.select.isEnabled()
    dialog.reject()


# --- extents


def test_extent_of_a_layer_in_another_crs(desk, screenshot):
    layer = layer_of("Polygon", "EPSG:32616", [f"Polygon {CONCAVE}"])
    desk.iface.setActiveLayer(layer)
    choose_way(desk, "layer")
    dialog = dialog_of(desk)
    assert dialog.chosen() == layer
    screenshot("layer-dialog", dialog)
    accept(desk, dialog)
    to_degrees = Transformer.from_crs("EPSG:32616", "EPSG:4326", always_xy=True)
    west, south, east, north = to_degrees.transform_bounds(239_000, 3_890_000, 247_000, 3_896_000, densify_pts=999)
    expected = {"north": north, "west": west, "south": south, "east": east}
    shown = {name: float(edit.text()) for name, edit in desk.form.edges.items()}
    assert shown == pytest.approx(expected, abs=2e-7)
    assert desk.form.area.undo.toolTip() == "Undo: extent of mine (Ctrl+Z)"


def test_layer_without_an_extent_is_refused(desk):
    layer = layer_of("Polygon", "EPSG:4326", [])
    desk.iface.setActiveLayer(layer)
    choose_way(desk, "layer")
    accept(desk, dialog_of(desk))
    assert any("Layer “mine” is empty" in text for text in desk.messages())


def test_extent_of_a_rotated_canvas_holds_its_corners(desk):
    desk.look_at("EPSG:32616", (239_000, 3_890_000, 247_000, 3_896_000))
    desk.canvas.setRotation(30.0)
    try:
        choose_way(desk, "canvas")
        to_map = desk.canvas.getCoordinateTransform().toMapCoordinates
        to_degrees = Transformer.from_crs("EPSG:32616", "EPSG:4326", always_xy=True)
        box = Box(*(float(edit.text()) for edit in desk.form.edges.values()))
        for x_px in (0, desk.canvas.width() - 1):
            for y_px in (0, desk.canvas.height() - 1):
                at = to_map(x_px, y_px)
                lon, lat = to_degrees.transform(at.x(), at.y())
                assert box.west_deg - 1e-4 < lon < box.east_deg + 1e-4
                assert box.south_deg - 1e-4 < lat < box.north_deg + 1e-4
    finally:
        desk.canvas.setRotation(0.0)


# --- points

FIELDS = "&field=height:double&field=heading:double&field=words:string(20)"


def test_points_with_heights_and_yaws_from_fields(desk, screenshot):
    values = [(100.0, 10.0, "400"), (150.0, 20.0, "500"), (200.0, 30.0, "600")]
    wkts = ["Point (240000 3891000)", "Point (241000 3892000)", "Point (242000 3893000)"]
    layer = layer_of("Point", "EPSG:32616", wkts, FIELDS, values)
    desk.iface.setActiveLayer(layer)
    layer.selectByIds([2, 3])
    choose_way(desk, "points")
    dialog = dialog_of(desk)
    assert dialog.selected.isChecked()
    assert dialog.selected.text() == "&Selected (2)"
    for button in (dialog.all, dialog.by_field):
        at = QPoint(8, button.height() // 2)
        QTest.mouseClick(button, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, at)
    assert dialog.all.isChecked()
    assert dialog.by_field.isChecked()
    dialog.agl_field.setField("words")
    dialog.unit.setCurrentIndex(dialog.unit.findData("ft"))
    dialog.yaw_field.setField("heading")
    screenshot("points-dialog", dialog)
    accept(desk, dialog)
    desk.wait(lambda: "3 points" in desk.form.area.words.text())
    area = desk.wait_planned().mission.area
    to_degrees = Transformer.from_crs("EPSG:32616", "EPSG:4326", always_xy=True)
    for (lat, lon, agl), (x, y), feet in zip(
        area.poses, ((240_000, 3_891_000), (241_000, 3_892_000), (242_000, 3_893_000)), (400, 500, 600)
    ):
        assert (lon, lat) == pytest.approx(to_degrees.transform(x, y), abs=1e-9)
        assert agl == pytest.approx(feet * 0.3048)
    assert area.yaws_deg == (10.0, 20.0, 30.0)
    assert "3 points, 121.9–182.9 m AGL, each with its yaw" in desk.form.area.words.text()
    screenshot("points")


def test_points_with_one_height_for_all(desk):
    layer = layer_of("MultiPoint", "EPSG:4326", ["MultiPoint ((0 0), (0.001 0))", "MultiPoint ((0 0.001))"])
    desk.iface.setActiveLayer(layer)
    desk.form.agl.setValue(80.0)
    choose_way(desk, "points")
    dialog = dialog_of(desk)
    assert not dialog.by_field.isEnabled()
    accept(desk, dialog)
    desk.wait(lambda: "3 points, 80 m AGL" in desk.form.area.words.text())
    assert desk.wait_planned().mission.area.yaws_deg == ()


OWN = "&field=agl:double&field=Heading:double&field=gimbal_pitch:double&field=roll:double&field=timestamp:datetime"


def test_points_with_attitude_and_time_by_the_usual_names_of_their_fields(desk, screenshot):
    """Nothing has to be chosen; they are flown in the order of their times, which are UTC where they say no zone."""
    clock = QDateTime(QDate(2024, 6, 21), QTime(10, 30), Qt.TimeSpec.LocalTime)
    values = [
        (120.0, 10.0, -90.0, 1.0, clock.addSecs(4)),
        (100.0, 20.0, -60.0, -2.0, clock),
        (
            110.0,
            30.0,
            -100.0,
            0.0,
            QDateTime(clock.date(), clock.time(), Qt.TimeSpec.OffsetFromUTC, 3600).addSecs(3602),
        ),
    ]
    wkts = ["Point (1 0)", "Point (1.001 0)", "Point (1.002 0)"]
    layer = layer_of("Point", "EPSG:4326", wkts, OWN, values)
    desk.iface.setActiveLayer(layer)
    choose_way(desk, "points")
    dialog = dialog_of(desk)
    screenshot("points-with-attitude", dialog)
    accept(desk, dialog)
    desk.wait(lambda: "3 points, 100–120 m AGL, each with its yaw, tilt, roll and time" in desk.form.area.words.text())
    area = desk.wait_planned().mission.area
    assert area.poses == ((0.0, 1.001, 100.0), (0.0, 1.002, 110.0), (0.0, 1.0, 120.0))
    assert (area.yaws_deg, area.tilts_deg) == ((20.0, 30.0, 10.0), (30.0, -10.0, 0.0))
    assert area.rolls_deg == (-2.0, 0.0, 1.0)
    assert area.times_s == (1_718_965_800.0, 1_718_965_802.0, 1_718_965_804.0)
    assert not desk.form.area.undo.toolTip().startswith("No change")


@pytest.mark.parametrize(
    ("value", "seconds"),
    [
        ("2024-06-21T10:30:00Z", 1_718_965_800.0),
        ("2024-06-21 12:30:00.5+02:00", 1_718_965_800.5),
        ("86400", 86_400.0),
    ],
)
def test_times_may_be_text(value, seconds):
    layer = layer_of("Point", "EPSG:4326", ["Point (0 0)"], "&field=at:string(40)", [(value,)])
    fields = PointFields(9.0, time_field="at")
    assert read_points(layer.getFeatures(), layer.crs(), CONTEXT, fields).times_s == (seconds,)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"tilt_field": "height"}, "feature 1: tilt in “height” is 181°: must be from -180 to 180"),
        (
            {"gimbal_pitch_field": "height"},
            "feature 1: gimbal pitch in “height” is 181°: must be from -180 to 90",
        ),
        ({"roll_field": "words"}, "feature 1: roll in “words” is “noon”: must be a number"),
        ({"time_field": "words"}, "feature 1: time in “words”: time 'noon': must be as 2024-06-21T10:30:00Z"),
        ({"time_field": "heading"}, "feature 1: time in “heading” is empty"),
    ],
)
def test_bad_attitudes_and_times_are_named_by_feature(fields, words):
    layer = layer_of("Point", "EPSG:4326", ["Point (0 0)"], FIELDS, [(181.0, None, "noon")])
    with pytest.raises(InvalidInput, match=re.escape(words)):
        read_points(layer.getFeatures(), layer.crs(), CONTEXT, PointFields(9.0, **fields))


@pytest.mark.parametrize(
    ("wkt", "values", "words"),
    [
        ("Point (1 1)", (None, 1.0, ""), "feature 2: height in “height” is empty"),
        ("Point (1 1)", (-5.0, 1.0, ""), "feature 2: height in “height” is -5 m: must be above 0"),
        ("Point (1 1)", (5.0, None, ""), "feature 2: yaw in “heading” is empty"),
        ("Point (1 1)", (5.0, 400.0, ""), "feature 2: yaw in “heading” is 400°: must be from -360 to 360"),
        ("Point (1 1)", (float("nan"), 1.0, ""), "feature 2: height in “height” is “nan”: must be a number"),
        ("", (5.0, 1.0, ""), "feature 2 has no geometry"),
    ],
)
def test_bad_points_are_named_by_feature(wkt, values, words):
    layer = layer_of("Point", "EPSG:4326", ["Point (0 0)", wkt], FIELDS, [(9.0, 1.0, "x"), values])
    fields = PointFields(100.0, "height", "heading")
    with pytest.raises(InvalidInput, match=words):
        read_points(layer.getFeatures(), layer.crs(), CONTEXT, fields)


def test_words_in_a_field_are_no_height():
    layer = layer_of("Point", "EPSG:4326", ["Point (0 0)"], FIELDS, [(9.0, 1.0, "tall")])
    with pytest.raises(InvalidInput, match="feature 1: height in “words” is “tall”: must be a number"):
        read_points(layer.getFeatures(), layer.crs(), CONTEXT, PointFields(1.0, "words"))


def test_reading_points_can_be_cancelled():
    layer = layer_of("Point", "EPSG:4326", ["Point (0 0)"] * 300)
    asked = []
    with pytest.raises(Cancelled):
        read_points(
            layer.getFeatures(),
            layer.crs(),
            CONTEXT,
            PointFields(1.0),
            lambda: bool(asked.append(1) or len(asked) > 1),
        )


# --- lines


def test_line_is_flown_at_a_speed(desk, screenshot):
    """Two sides of 400 m in UTM: the way is shorter by what the turn saves, and the top of the image follows it."""
    wkt = "LineString (240000 3891000, 240000 3891400, 240400 3891400)"
    layer = layer_of("LineString", "EPSG:32616", [wkt, "LineString (0 0, 1 1)"])
    desk.iface.setActiveLayer(layer)
    desk.form.agl.setValue(150.0)
    choose_way(desk, "line")
    dialog = dialog_of(desk)
    assert "Nothing is selected: all 2 lines" in dialog.words.text()
    layer.selectByIds([1])
    dialog.show_layer(layer)
    dialog.speed.setValue(10.0)
    dialog.interval_in.setCurrentIndex(dialog.interval_in.findData("every_m"))
    dialog.interval.setValue(20.0)
    dialog.fixed_camera.setChecked(True)
    assert dialog.words.text() == "1 line is selected. Corners become turns with a radius of 21.9 m."
    screenshot("line-dialog", dialog)
    accept(desk, dialog)
    desk.wait(lambda: "150 m AGL, each with its yaw, roll and time" in desk.form.area.words.text())
    assert any("misses the corners of its line by up to 9.1 m." in text for text in desk.messages())
    assert desk.form.area.undo.toolTip() == "Undo: line of mine (Ctrl+Z)"
    area = desk.wait_planned().mission.area
    # A metre of UTM is 1.0004 m of ground at this edge of its zone.
    length = 800.0 / scale_of_utm(240_200.0, 3_891_200.0) - (2.0 - math.pi / 2.0) * 21.87
    assert len(area.poses) == math.floor(length / 20.0) + 1
    assert {agl for _, _, agl in area.poses} == {150.0}
    assert area.times_s[1] - area.times_s[0] == pytest.approx(2.0)
    # Grid north leans by 1.6 degrees from true north here.
    assert area.yaws_deg[-1] - area.yaws_deg[0] == pytest.approx(90.0, abs=0.01)
    assert max(area.rolls_deg) > 20.0
    assert area.rolls_deg[0] == area.rolls_deg[-1] == 0.0
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    desk.canvas.waitWhileRendering()
    screenshot("line-preview")
    desk.form.area.undo.click()
    assert desk.form.area.words.text() == ""


def scale_of_utm(x, y):
    factors = Proj("EPSG:32616").get_factors(*Transformer.from_crs(32616, 4326, always_xy=True).transform(x, y))
    return factors.meridional_scale


def test_sides_of_lines_stay_where_they_are_in_the_layer():
    """A side of 300 km on a polar map, which bends between degrees."""
    layer = layer_of("LineString", "EPSG:3031", ["LineString (500000 500000, 700000 700000)"])
    (line,) = read_lines(layer.getFeatures(), layer.crs(), CONTEXT, 80.0)
    assert len(line) > 2
    x, y = Transformer.from_crs(4326, 3031, always_xy=True).transform(line[:, 1], line[:, 0])
    assert np.abs(x - y).max() <= EDGE_TOLERANCE_M
    assert set(line[:, 2]) == {80.0}


@pytest.mark.parametrize(
    ("kind", "wkts", "words"),
    [
        ("LineString", [], "no lines to fly: select some, or use all lines of the layer"),
        ("LineString", [""], "feature 1 has no geometry"),
        ("Point", ["Point (1 1)"], "feature 1 is not a line"),
    ],
)
def test_what_is_no_line_is_named(kind, wkts, words):
    layer = layer_of(kind, "EPSG:4326", wkts)
    with pytest.raises(InvalidInput, match=words):
        read_lines(layer.getFeatures(), layer.crs(), CONTEXT, 80.0)


def test_line_that_is_too_sharp_is_refused(desk):
    layer = layer_of("LineString", "EPSG:4326", ["LineString (0 0, 0 0.001, 0 0)"])
    desk.iface.setActiveLayer(layer)
    choose_way(desk, "line")
    dialog = dialog_of(desk)
    assert dialog.words.text().startswith("Its only line will be flown.")
    accept(desk, dialog)
    desk.wait(lambda: any("turns by 180 degrees at 0.001000, 0.000000" in text for text in desk.messages()))


# --- files

TABLE = "latitude;longitude;height;heading;gimbal_pitch;roll;timestamp\n35,1;-89,9;100;5;-90;1;2024-06-21T10:30:00Z\n"


def test_table_of_poses_in_a_file_or_on_the_clipboard(desk, tmp_path, monkeypatch):
    path = tmp_path / "poses.csv"
    path.write_text(TABLE, encoding="utf-8")
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(path), ""))
    choose_way(desk, "file")
    desk.wait_for_tasks()
    read = desk.wait_planned().mission.area
    assert (read.poses, read.yaws_deg, read.tilts_deg, read.rolls_deg, read.times_s) == (
        ((35.1, -89.9, 100.0),),
        (5.0,),
        (0.0,),
        (1.0,),
        (1_718_965_800.0,),
    )
    desk.form.agl.setValue(60.0)
    QApplication.clipboard().setText(TABLE)
    choose_way(desk, "paste")
    assert desk.wait_planned().mission.area == read
    desk.form.agl.setValue(60.0)
    desk.form.edges["north"].setText(TABLE)
    assert desk.wait_planned().mission.area == read
    # Without heights, the height entered is that of all.
    desk.form.agl.setValue(60.0)
    QApplication.clipboard().setText("lat\tlon\theading\n35.1\t-89.9\t5\n35.2\t-89.9\t6\n")
    choose_way(desk, "paste")
    area = desk.wait_planned().mission.area
    assert (area.poses, area.yaws_deg) == (((35.1, -89.9, 60.0), (35.2, -89.9, 60.0)), (5.0, 6.0))


def test_text_file_of_points(desk, tmp_path, monkeypatch):
    path = tmp_path / "points.txt"
    path.write_text("# lat lon agl yaw\n35.1 -89.9 100 5\n35.2 -89.8 120 6\n", encoding="utf-8")
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(path), ""))
    choose_way(desk, "file")
    desk.wait_for_tasks()
    desk.wait(lambda: "2 points, 100–120 m AGL" in desk.form.area.words.text())
    area = desk.wait_planned().mission.area
    assert area.poses == ((35.1, -89.9, 100.0), (35.2, -89.8, 120.0))
    assert area.yaws_deg == (5.0, 6.0)
    assert desk.form.agl.value() == 100.0


def test_text_file_that_cannot_be_read_is_named_with_its_line(desk, tmp_path, monkeypatch):
    path = tmp_path / "points.txt"
    path.write_text("35.1 -89.9 100\n35.2 -89.8\n", encoding="utf-8")
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(path), ""))
    choose_way(desk, "file")
    desk.wait(lambda: any("line 2" in text for text in desk.messages()))


@pytest.mark.parametrize("ring", ["9 -8, 9 7, -6 7, -6 -8, 9 -8", "0 -9, -7 3, 5 4, 0 -9"])
@pytest.mark.parametrize("crs", ["EPSG:3031", "EPSG:3413"])
def test_polygon_around_a_pole_goes_back_along_it(crs, ring):
    """From 180 W to 180 E, as files have such a ring; as large as by pyproj's formulas, also the other way around."""
    km = re.sub(r"-?\d+", lambda number: f"{number[0]}000", ring)
    for text in (km, ", ".join(reversed(km.split(", ")))):
        (outer,) = polygon(f"Polygon (({text}))", crs).arrays()
        lon, lat = outer
        pole = -90.0 if crs == "EPSG:3031" else 90.0
        assert (lon.min(), lon.max()) == (-180.0, 180.0)
        assert np.abs(np.diff(lon)).max() < 180.0
        assert set(lon[lat == pole]) >= {-180.0, 180.0}
        x, y = Transformer.from_crs(4326, crs, always_xy=True).transform(lon[lat != pole], lat[lat != pole])
        drawn = QgsGeometry.fromPolygonXY([[QgsPointXY(*at) for at in zip(x, y)]])
        wanted = QgsGeometry.fromWkt(f"Polygon (({km}))")
        # A decimetre along its sides of 60 km at most.
        assert drawn.symDifference(wanted).area() < 6_000.0
