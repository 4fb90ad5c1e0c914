"""Moving the area on the map by mouse and keys, in projects of any CRS."""

from __future__ import annotations

import math

import pytest
from pyproj import Transformer
from qgis.gui import QgsRubberBand
from qgis.PyQt.QtCore import QPoint, Qt
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication, QScrollArea
from terrainav.core.geodesy.mercator import MAX_LAT_DEG
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.terrainav_plugin.area.outline import moved, stretched

from tests.support.thinning import sampled

pytestmark = pytest.mark.usefixtures("ground")

NONE, SHIFT = Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.ShiftModifier
LEFT = Qt.MouseButton.LeftButton
# Of a degree, as the fields show it; two fields' roundings.
LAST_DECIMAL_DEG = 1.1e-7
MEMPHIS = Box(35.16, -89.90, 35.115, -89.823)
#: CRS, extent that shows the box, box.
PLACES = [
    pytest.param("EPSG:3857", (-10_012_000, 4_176_000, -9_994_000, 4_190_000), MEMPHIS, id="web mercator"),
    pytest.param("EPSG:4326", (-89.95, 35.08, -89.77, 35.20), MEMPHIS, id="degrees"),
    pytest.param("EPSG:32616", (232_000, 3_885_000, 249_000, 3_898_000), MEMPHIS, id="utm"),
    pytest.param("EPSG:3031", (-700_000, 700_000, 700_000, 1_900_000), Box(-76.0, -20.0, -80.0, 20.0), id="polar"),
]


@pytest.fixture
def tool(desk):
    return desk.session.areas.tool


def enter(desk, area):
    desk.form.area_editing.set_area(area, "test")


def shown_box(desk):
    return Box(*(float(desk.form.edges[name].text()) for name in ("north", "west", "south", "east")))


def edges(box):
    return [box.north_deg, box.west_deg, box.south_deg, box.east_deg]


def pixel(desk, crs, lon, lat):
    """Pixel of the canvas at a place, by another program's way."""
    x, y = Transformer.from_crs("EPSG:4326", crs, always_xy=True).transform(lon, lat)
    at = desk.canvas.getCoordinateTransform().transform(x, y)
    return QPoint(round(at.x()), round(at.y()))


def degrees(desk, crs, at):
    x, y = (lambda p: (p.x(), p.y()))(desk.canvas.getCoordinateTransform().toMapCoordinates(at))
    return Transformer.from_crs(crs, "EPSG:4326", always_xy=True).transform(x, y)


def bands(desk):
    return [item for item in desk.canvas.scene().items() if isinstance(item, QgsRubberBand)]


def look_and_switch_on(desk, crs, extent, box):
    desk.look_at(crs, extent)
    enter(desk, box)
    desk.dock.findChild(QScrollArea).ensureWidgetVisible(desk.form.area)
    desk.click(desk.form.area.edit)


@pytest.mark.parametrize(("crs", "extent", "box"), PLACES)
def test_dragging_inside_moves_the_box_with_the_pointer(desk, tool, crs, extent, box):
    look_and_switch_on(desk, crs, extent, box)
    assert desk.canvas.mapTool() is tool
    start = pixel(desk, crs, (box.west_deg + box.east_deg) / 2.0, (box.north_deg + box.south_deg) / 2.0)
    end = start + QPoint(37, 21)
    desk.drag(start, end)
    (lon0, lat0), (lon1, lat1) = degrees(desk, crs, start), degrees(desk, crs, end)
    expected = [
        *(box.north_deg + lat1 - lat0, box.west_deg + lon1 - lon0),
        *(box.south_deg + lat1 - lat0, box.east_deg + lon1 - lon0),
    ]
    assert edges(shown_box(desk)) == pytest.approx(expected, abs=LAST_DECIMAL_DEG)
    assert desk.canvas.mapTool() is tool


@pytest.mark.parametrize("told", [(), (0.5,)], ids=["no move is told", "half the way"])
def test_the_box_ends_where_the_button_is_let_go(desk, told):
    """A busy application hears of fewer moves than there were, and the last may be missing."""
    crs, extent, box = PLACES[0].values
    look_and_switch_on(desk, crs, extent, box)
    start = pixel(desk, crs, (box.west_deg + box.east_deg) / 2.0, (box.north_deg + box.south_deg) / 2.0)
    end = start + QPoint(37, 21)
    viewport = desk.canvas.viewport()
    QTest.mousePress(viewport, LEFT, NONE, start)
    for share in told:
        QTest.mouseMove(viewport, start + (end - start) * share)
    QTest.mouseRelease(viewport, LEFT, NONE, end)
    (lon0, _), (lon1, _) = degrees(desk, crs, start), degrees(desk, crs, end)
    assert shown_box(desk).west_deg == pytest.approx(box.west_deg + lon1 - lon0, abs=LAST_DECIMAL_DEG)


@pytest.mark.parametrize(("crs", "extent", "box"), sampled(PLACES, 3))
@pytest.mark.parametrize("grip", [("north",), ("west",), ("south",), ("east",), ("north", "west"), ("south", "east")])
def test_dragging_edges_and_corners(desk, crs, extent, box, grip):
    """An edge is caught anywhere along it: a quarter of the way, where in some CRSs it is no straight line."""
    look_and_switch_on(desk, crs, extent, box)
    lon = box.west_deg + 0.25 * box.span_deg
    lat = box.south_deg + 0.25 * (box.north_deg - box.south_deg)
    for edge in grip:
        if edge in ("west", "east"):
            lon = getattr(box, f"{edge}_deg")
        else:
            lat = getattr(box, f"{edge}_deg")
    start = pixel(desk, crs, lon, lat)
    end = start + QPoint(13, -9)
    desk.drag(start, end)
    (lon0, lat0), (lon1, lat1) = degrees(desk, crs, start), degrees(desk, crs, end)
    expected = {name: getattr(box, f"{name}_deg") for name in ("north", "west", "south", "east")}
    for edge in grip:
        expected[edge] += lon1 - lon0 if edge in ("west", "east") else lat1 - lat0
    assert edges(shown_box(desk)) == pytest.approx(list(expected.values()), abs=LAST_DECIMAL_DEG)


def test_numbers_are_live_while_dragging_and_escape_puts_them_back(desk, tool, screenshot):
    crs, extent, box = PLACES[0].values
    others = len(bands(desk))
    look_and_switch_on(desk, crs, extent, box)
    assert len(bands(desk)) > others
    state, count = desk.session.state(), desk.form.area_editing.history.stack.count()
    viewport = desk.canvas.viewport()
    start = pixel(desk, crs, box.west_deg, box.north_deg)
    QTest.mousePress(viewport, LEFT, NONE, start)
    desk.move(start + QPoint(-40, -30), held=LEFT)
    desk.wait(lambda: shown_box(desk).west_deg < box.west_deg)
    assert shown_box(desk).north_deg > box.north_deg
    screenshot("drag-corner")
    QTest.keyClick(desk.canvas, Qt.Key.Key_Escape)
    assert desk.session.state() == state
    QTest.mouseRelease(viewport, LEFT, NONE, start + QPoint(-40, -30))
    assert desk.session.state() == state
    assert desk.form.area_editing.history.stack.count() == count
    # The tool is still on; a second Esc leaves it, and of its drawing the outline alone stays on the canvas.
    assert desk.canvas.mapTool() is tool
    QTest.keyClick(desk.canvas, Qt.Key.Key_Escape)
    assert desk.canvas.mapTool() is not tool
    assert sum(not band.asGeometry().isEmpty() for band in bands(desk)) == 1
    assert not desk.form.area.edit.isChecked()
    desk.form.set_state(type(state)())
    assert len(bands(desk)) == others


def test_cursor_tells_what_would_be_dragged(desk, tool):
    crs, extent, box = PLACES[0].values
    look_and_switch_on(desk, crs, extent, box)
    viewport = desk.canvas.viewport()
    middle = ((box.west_deg + box.east_deg) / 2.0, (box.north_deg + box.south_deg) / 2.0)
    cursors = {
        (box.west_deg, box.north_deg): Qt.CursorShape.SizeFDiagCursor,
        (box.east_deg, box.south_deg): Qt.CursorShape.SizeFDiagCursor,
        (box.east_deg, box.north_deg): Qt.CursorShape.SizeBDiagCursor,
        (box.west_deg, box.south_deg): Qt.CursorShape.SizeBDiagCursor,
        (middle[0], box.north_deg): Qt.CursorShape.SizeVerCursor,
        (box.west_deg, middle[1]): Qt.CursorShape.SizeHorCursor,
        middle: Qt.CursorShape.SizeAllCursor,
        (box.west_deg - 0.02, middle[1]): Qt.CursorShape.ArrowCursor,
    }
    for (lon, lat), cursor in cursors.items():
        desk.move(pixel(desk, crs, lon, lat))
        desk.wait(lambda cursor=cursor: viewport.cursor().shape() == cursor)


@pytest.mark.parametrize(("crs", "extent", "box"), PLACES)
def test_arrow_keys_move_by_pixels_and_with_shift_by_ten(desk, crs, extent, box):
    look_and_switch_on(desk, crs, extent, box)
    lon, lat = (box.west_deg + box.east_deg) / 2.0, (box.north_deg + box.south_deg) / 2.0
    before = desk.canvas.extent()
    to_map = Transformer.from_crs("EPSG:4326", crs, always_xy=True)
    x0, y0 = to_map.transform(lon, lat)
    QTest.keyClick(desk.canvas, Qt.Key.Key_Right)
    QTest.keyClick(desk.canvas, Qt.Key.Key_Up, SHIFT)
    there = shown_box(desk)
    x1, y1 = to_map.transform((there.west_deg + there.east_deg) / 2.0, (there.north_deg + there.south_deg) / 2.0)
    unit = desk.canvas.mapUnitsPerPixel()
    # Fields round to seven decimals: a hundredth of a pixel here at most.
    assert ((x1 - x0) / unit, (y1 - y0) / unit) == pytest.approx((1.0, 10.0), abs=0.02)
    assert desk.canvas.extent() == before
    # However many, they are one step.
    desk.click(desk.form.area.undo)
    assert edges(shown_box(desk)) == pytest.approx(edges(box))


def test_box_goes_across_the_antimeridian(desk, screenshot):
    crs, box = "EPSG:3857", Box(10.0, 170.0, 0.0, 178.0)
    look_and_switch_on(desk, crs, (17_500_000, -1_000_000, 20_037_508, 2_000_000), box)
    start = pixel(desk, crs, 174.0, 5.0)
    end = start + QPoint(round(4.0 * 111_319.49 / desk.canvas.mapUnitsPerPixel()), 0)
    desk.drag(start, end)
    there = shown_box(desk)
    assert there.span_deg == pytest.approx(8.0, abs=LAST_DECIMAL_DEG)
    assert there.west_deg > 173.0
    assert -180.0 <= there.east_deg < -177.0
    assert desk.message("west") == desk.message("east") == ""
    # On this map it lies at both ends; nothing is drawn across the world.
    area = next(band for band in bands(desk) if band.asGeometry().area() > 0.0).asGeometry()
    parts = sorted((part.boundingBox() for part in area.asGeometryCollection()), key=lambda part: part.xMinimum())
    assert len(parts) == 2
    assert parts[0].xMinimum() == pytest.approx(-20_037_508.34, abs=1.0)
    assert parts[1].xMaximum() == pytest.approx(20_037_508.34, abs=1.0)
    assert sum(part.width() for part in parts) == pytest.approx(8.0 * 111_319.49, rel=1e-4)
    screenshot("antimeridian")


def test_box_stops_where_pictures_end(desk):
    crs, extent = "EPSG:3031", (-2_000_000, -2_000_000, 2_000_000, 2_000_000)
    box = Box(-76.0, -20.0, -80.0, 20.0)
    look_and_switch_on(desk, crs, extent, box)
    desk.drag(pixel(desk, crs, 0.0, -78.0), pixel(desk, crs, 0.0, -89.5))
    there = shown_box(desk)
    assert there.south_deg == pytest.approx(-MAX_LAT_DEG, abs=LAST_DECIMAL_DEG)
    assert there.north_deg - there.south_deg == pytest.approx(4.0, abs=LAST_DECIMAL_DEG)
    assert desk.message("south") == ""


def test_edge_stops_at_the_opposite_one(desk):
    crs, extent, box = PLACES[0].values
    look_and_switch_on(desk, crs, extent, box)
    middle_lat = (box.north_deg + box.south_deg) / 2.0
    desk.drag(pixel(desk, crs, box.west_deg, middle_lat), pixel(desk, crs, box.east_deg + 0.02, middle_lat))
    there = shown_box(desk)
    assert there.east_deg == box.east_deg
    assert 0.0 < there.span_deg < 2e-6


def test_dragging_beside_the_area_moves_the_map(desk):
    crs, extent, box = PLACES[0].values
    look_and_switch_on(desk, crs, extent, box)
    before, state = desk.canvas.extent(), desk.session.state()
    desk.drag(desk.at(0.05, 0.05), desk.at(0.15, 0.15))
    assert desk.session.state() == state
    assert desk.canvas.extent().center() != before.center()


RING = ((-89.9, 35.1), (-89.8, 35.1), (-89.8, 35.2), (-89.85, 35.13), (-89.9, 35.2))
HOLE = ((-89.89, 35.11), (-89.88, 35.11), (-89.88, 35.12))


def test_dragging_inside_a_polygon_moves_it_and_its_hole_does_not(desk, screenshot):
    crs = "EPSG:3857"
    look_and_switch_on(desk, crs, (-10_012_000, 4_172_000, -9_990_000, 4_192_000), Polygon((RING, HOLE)))
    screenshot("polygon")
    state = desk.session.state()
    in_hole = pixel(desk, crs, -89.883, 35.113)
    desk.drag(in_hole, in_hole + QPoint(20, 0))
    assert desk.session.state() == state
    start = pixel(desk, crs, -89.87, 35.12)
    end = start + QPoint(30, 15)
    desk.drag(start, end)
    (lon0, lat0), (lon1, lat1) = degrees(desk, crs, start), degrees(desk, crs, end)
    there = desk.wait_planned().mission.area
    for ring, moved_ring in zip((RING, HOLE), there.rings):
        for (lon, lat), found in zip(ring, moved_ring):
            assert found == pytest.approx((lon + lon1 - lon0, lat + lat1 - lat0), abs=1e-9)
    assert "Polygon, 8 corners, 1 hole" in desk.form.area.words.text()


def test_points_are_moved_together(desk):
    crs = "EPSG:32616"
    points = Points(((35.12, -89.89, 50.0), (35.15, -89.83, 80.0)), (10.0, 20.0))
    look_and_switch_on(desk, crs, (232_000, 3_885_000, 249_000, 3_898_000), points)
    start = pixel(desk, crs, -89.83, 35.15)
    end = start + QPoint(-25, 10)
    desk.drag(start, end)
    (lon0, lat0), (lon1, lat1) = degrees(desk, crs, start), degrees(desk, crs, end)
    there = desk.wait_planned().mission.area
    assert there.yaws_deg == points.yaws_deg
    for (lat, lon, agl), found in zip(points.poses, there.poses):
        assert found == pytest.approx((lat + lat1 - lat0, lon + lon1 - lon0, agl), abs=1e-9)


def test_single_capture_by_a_click(desk, screenshot):
    crs, extent, _ = PLACES[0].values
    desk.look_at(crs, extent)
    desk.form.agl.setValue(90.0)
    desk.form.area.area_from.actions_by_name["single"].trigger()
    at = desk.at(0.4, 0.6)
    desk.click_map(at)
    lon, lat = degrees(desk, crs, at)
    mission = desk.wait_planned().mission
    assert mission.kind == "single"
    assert mission.area.poses[0] == pytest.approx((lat, lon, 90.0), abs=1e-9)
    assert desk.form.area.words.text().startswith("Single capture, 90 m AGL")
    screenshot("single-capture")
    # It moves with the pointer, and its height with the entry.
    desk.drag(at, at + QPoint(30, 0))
    desk.form.agl.setValue(75.0)
    lon, lat = degrees(desk, crs, at + QPoint(30, 0))
    assert desk.wait_planned().mission.area.poses[0] == pytest.approx((lat, lon, 75.0), abs=1e-9)


def test_undo_by_keys_on_the_canvas(desk):
    crs, extent, box = PLACES[0].values
    look_and_switch_on(desk, crs, extent, box)
    start = pixel(desk, crs, (box.west_deg + box.east_deg) / 2.0, (box.north_deg + box.south_deg) / 2.0)
    desk.drag(start, start + QPoint(40, 0))
    after = shown_box(desk)
    QTest.keyClick(desk.canvas, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert edges(shown_box(desk)) == pytest.approx(edges(box))
    QTest.keyClick(desk.canvas, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier | SHIFT)
    assert shown_box(desk) == after


def test_tool_goes_with_the_area_it_is_for(desk, tool):
    crs, extent, box = PLACES[0].values
    look_and_switch_on(desk, crs, extent, box)
    desk.form.set_state(type(desk.session.state())())
    assert desk.canvas.mapTool() is not tool
    assert not desk.form.area.edit.isEnabled()


def test_outline_in_a_polar_project_is_curved(desk, screenshot):
    """The box's southern edge is an arc there: a place half way along it lies on the band, far from the chord."""
    crs, extent, box = PLACES[3].values
    look_and_switch_on(desk, crs, extent, box)
    screenshot("polar")
    shape = next(band for band in bands(desk) if band.asGeometry().area() > 0.0).asGeometry()
    to_map = Transformer.from_crs("EPSG:4326", crs, always_xy=True)
    from qgis.core import QgsGeometry, QgsPointXY

    outline = QgsGeometry(shape.constGet().boundary())
    middle = QgsGeometry.fromPointXY(QgsPointXY(*to_map.transform(0.0, -80.0)))
    corners = [to_map.transform(lon, -80.0) for lon in (-20.0, 20.0)]
    chord = QgsGeometry.fromPolylineXY([QgsPointXY(*corner) for corner in corners])
    # Drawn in steps, each of which bends less than can be seen.
    assert outline.distance(middle) < 0.1 * desk.canvas.mapUnitsPerPixel()
    assert chord.distance(middle) > 50_000.0


# --- degrees alone


@pytest.mark.parametrize(
    ("box", "dlat", "dlon", "expected"),
    [
        (Box(10.0, 175.0, 0.0, 179.0), 0.0, 3.0, Box(10.0, 178.0, 0.0, -178.0)),
        (Box(10.0, -179.0, 0.0, -175.0), 0.0, -3.0, Box(10.0, 178.0, 0.0, -178.0)),
        (Box(89.0, 0.0, 88.0, 1.0), 5.0, 0.0, Box(90.0, 0.0, 89.0, 1.0)),
        (Box(10.0, -180.0, 0.0, 180.0), 1.0, 50.0, Box(11.0, -180.0, 1.0, 180.0)),
        (Box(80.0, 0.0, 75.0, 1.0), 20.0, 0.0, Box(MAX_LAT_DEG, 0.0, MAX_LAT_DEG - 5.0, 1.0)),
    ],
)
def test_boxes_moved_by_degrees(box, dlat, dlon, expected):
    assert edges(moved(box, dlat, dlon)) == pytest.approx(edges(expected))


def test_stretching_beyond_a_turn_ends_at_the_whole_world():
    there = stretched(Box(10.0, 0.0, 0.0, 10.0), frozenset({"east"}), 0.0, 900.0)
    assert there.span_deg == 360.0
    assert not math.isnan(there.area_m2())


def test_polygons_and_points_stay_on_the_earth():
    polygon = moved(Polygon((RING,)), 80.0, 0.0)
    assert polygon.bounds.north_deg == pytest.approx(MAX_LAT_DEG)
    points = moved(Points(((10.0, 179.0, 1.0), (11.0, -179.0, 2.0))), 0.0, 3.0)
    assert [pose[1] for pose in points.poses] == [-178.0, -176.0]


@pytest.mark.thorough
def test_dark_theme(desk, screenshot):
    """For a person to look at; the readout's text must differ from what is behind it."""
    from qgis.core import QgsApplication
    from qgis.PyQt.QtWidgets import QLabel

    application, theme = QApplication.instance(), QgsApplication.themeName()
    palette = application.palette()
    crs, extent, box = PLACES[0].values
    QgsApplication.setUITheme("Night Mapping")
    try:
        look_and_switch_on(desk, crs, extent, box)
        viewport = desk.canvas.viewport()
        start = pixel(desk, crs, box.west_deg, box.north_deg)
        QTest.mousePress(viewport, LEFT, NONE, start)
        desk.move(start + QPoint(-40, -30), held=LEFT)
        desk.wait(lambda: viewport.findChild(QLabel, "terrainav_readout") is not None)
        image = viewport.findChild(QLabel, "terrainav_readout").grab().toImage()
        shades = [image.pixelColor(x, y).lightness() for x in range(image.width()) for y in range(image.height())]
        # Dark ground with light letters on it, whatever the map below is like.
        assert sum(shade < 64 for shade in shades) > len(shades) / 2
        assert max(shades) > 200
        screenshot("dark-drag")
        QTest.mouseRelease(viewport, LEFT, NONE, start + QPoint(-40, -30))
    finally:
        QgsApplication.setUITheme(theme)
        application.setPalette(palette)
        application.processEvents()
