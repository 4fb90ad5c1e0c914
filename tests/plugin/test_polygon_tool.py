"""Drawing polygons on the map and changing their corners, holes and parts, in projects of any CRS."""

from __future__ import annotations

import pytest
from pyproj import Geod, Transformer
from qgis.core import QgsCoordinateReferenceSystem, QgsGeometry, QgsPointXY, QgsProject
from qgis.PyQt.QtCore import QPoint, Qt
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QLabel, QMenu
from terrainav.core.mission.areas.area import Box, Points, Polygon, Polygons
from terrainav.terrainav_plugin.area.corners import join_polygon
from terrainav.terrainav_plugin.form.area import entered_area

from tests.plugin.test_area_tool import bands, degrees, pixel
from tests.support.thinning import sampled

pytestmark = pytest.mark.usefixtures("ground")

NONE = Qt.KeyboardModifier.NoModifier
LEFT, RIGHT = Qt.MouseButton.LeftButton, Qt.MouseButton.RightButton
#: Places that are pointed at are kept to seven decimals, twice where they are moved.
LAST_DIGIT_DEG = 1.1e-7
#: CRS, and an extent that shows the ground which corners are clicked on.
PLACES = [
    pytest.param("EPSG:3857", (-10_012_000, 4_176_000, -9_994_000, 4_190_000), id="web mercator"),
    pytest.param("EPSG:4326", (-89.95, 35.08, -89.77, 35.20), id="degrees"),
    pytest.param("EPSG:32616", (232_000, 3_885_000, 249_000, 3_898_000), id="utm"),
    pytest.param("EPSG:3031", (-700_000, 700_000, 700_000, 1_900_000), id="polar"),
    pytest.param("EPSG:4326", (179.9, 10.0, 180.1, 10.1), id="antimeridian in degrees"),
    pytest.param("EPSG:3832", (3_300_000, 1_000_000, 3_380_000, 1_050_000), id="antimeridian in metres"),
]
MERCATOR = PLACES[0].values
#: Shares of the map's width and height.
KITE = ((0.2, 0.2), (0.7, 0.25), (0.8, 0.7), (0.3, 0.8))
INSIDE = ((0.4, 0.4), (0.55, 0.4), (0.5, 0.55))


@pytest.fixture
def tool(desk):
    return desk.session.areas.polygon_tool


def area_of(desk):
    return entered_area(desk.session.state())


def click(desk, *places, button=LEFT):
    viewport = desk.canvas.viewport()
    for place in places:
        at = desk.at(*place)
        QTest.mouseMove(viewport, at)
        QTest.mouseClick(viewport, button, NONE, at)


def double_click(desk, place):
    """As people do: the first click, the second as a double click, and the button let go."""
    click(desk, place)
    viewport, at = desk.canvas.viewport(), desk.at(*place)
    QTest.mouseDClick(viewport, LEFT, NONE, at)
    QTest.mouseRelease(viewport, LEFT, NONE, at)


def press_key(desk, key):
    QTest.keyClick(desk.canvas, key)


def draw(desk, places):
    desk.click(desk.form.area.draw_polygon)
    click(desk, *places)
    press_key(desk, Qt.Key.Key_Return)


def on_map(desk, crs, polygon):
    """Polygon in the canvas's CRS, its edges straight in degrees as they are meant."""
    to_map = Transformer.from_crs("EPSG:4326", crs, always_xy=True)
    rings = []
    for ring in polygon.rings:
        closed = QgsGeometry.fromPolylineXY([QgsPointXY(*corner) for corner in (*ring, ring[0])])
        lon, lat = zip(*((at.x(), at.y()) for at in closed.densifyByCount(20).asPolyline()))
        x, y = (lon, lat) if crs == "EPSG:4326" else to_map.transform(lon, lat)
        rings.append([QgsPointXY(*place) for place in zip(x, y)])
    return QgsGeometry.fromPolygonXY(rings)


def clicked(desk, places):
    """Polygon through the middles of the pixels that were clicked, as the canvas has them."""
    to_map = desk.canvas.getCoordinateTransform()
    ring = [to_map.toMapCoordinates(desk.at(*place)) for place in places]
    return QgsGeometry.fromPolygonXY([[*ring, ring[0]]])


def readout(desk):
    label = desk.canvas.viewport().findChild(QLabel, "terrainav_readout")
    return "" if label is None or label.isHidden() else label.text()


def menu_at(desk, place):
    """Entries of the menu that a right click opens, by name."""
    click(desk, place, button=RIGHT)
    menus = [menu for menu in desk.canvas.findChildren(QMenu, "edit_area_menu") if menu.isVisible()]
    return {action.objectName(): action for action in menus[0].actions()} if menus else {}


# --- drawing


@pytest.mark.parametrize(("crs", "extent"), sampled(PLACES, 3))
def test_corners_are_where_they_are_clicked(desk, tool, crs, extent):
    """Its edges run as they are drawn, to less than a pixel, whatever is straight in the project's CRS."""
    desk.look_at(crs, extent)
    draw(desk, KITE)
    assert desk.canvas.mapTool() is desk.session.areas.tool
    polygon = area_of(desk)
    expected = clicked(desk, KITE)
    assert on_map(desk, crs, polygon).hausdorffDistance(expected) < desk.canvas.mapUnitsPerPixel()
    for place in KITE:
        lon, lat = degrees(desk, crs, desk.at(*place))
        assert any(
            abs(lat - y) < LAST_DIGIT_DEG and abs((lon - x + 180.0) % 360.0 - 180.0) < LAST_DIGIT_DEG
            for x, y in polygon.rings[0]
        )
    assert desk.form.area.undo.toolTip() == "Undo: draw polygon (Ctrl+Z)"


def test_polygon_around_a_pole(desk):
    desk.look_at("EPSG:3031", (-700_000, -700_000, 700_000, 700_000))
    draw(desk, ((0.3, 0.3), (0.7, 0.3), (0.7, 0.7), (0.3, 0.7)))
    area = area_of(desk)
    assert area.bounds.south_deg == -90.0
    assert area.bounds.span_deg == 360.0
    # Of a square about the pole: the ellipsoid's own area within half a per mille of the plane's, true at 71° S.
    flat = clicked(desk, ((0.3, 0.3), (0.7, 0.3), (0.7, 0.7), (0.3, 0.7))).area()
    assert area.area_m2() == pytest.approx(flat * 1.056, rel=5e-3)


@pytest.mark.parametrize("end", ["double click", "right click", "enter", "return"])
def test_ways_to_finish(desk, tool, end):
    desk.look_at(*MERCATOR)
    before = desk.canvas.mapTool()
    desk.click(desk.form.area.draw_polygon)
    assert desk.canvas.mapTool() is tool
    click(desk, *KITE[:3])
    if end == "double click":
        double_click(desk, KITE[3])
    elif end == "right click":
        click(desk, KITE[3])
        click(desk, (0.5, 0.5), button=RIGHT)
    else:
        click(desk, KITE[3])
        press_key(desk, Qt.Key.Key_Enter if end == "enter" else Qt.Key.Key_Return)
    assert len(area_of(desk).rings[0]) == 4
    # The tool that moves the area goes on, and gives the map back to the tool before both.
    assert desk.canvas.mapTool() is desk.session.areas.tool
    press_key(desk, Qt.Key.Key_Escape)
    assert desk.canvas.mapTool() is before


def test_corners_are_taken_back_and_drawing_is_given_up(desk, tool):
    desk.look_at(*MERCATOR)
    others = len(bands(desk))
    before, state = desk.canvas.mapTool(), desk.session.state()
    desk.click(desk.form.area.draw_polygon)
    click(desk, *KITE[:3], (0.75, 0.75))
    assert len(bands(desk)) > others
    press_key(desk, Qt.Key.Key_Backspace)
    click(desk, KITE[3])
    press_key(desk, Qt.Key.Key_Return)
    assert (
        on_map(desk, MERCATOR[0], area_of(desk)).hausdorffDistance(clicked(desk, KITE)) < desk.canvas.mapUnitsPerPixel()
    )
    desk.click(desk.form.area.undo)
    assert desk.session.state() == state
    desk.plugin.actions["draw_polygon"].trigger()
    click(desk, *KITE[:3])
    press_key(desk, Qt.Key.Key_Escape)
    assert desk.canvas.mapTool() is before
    assert not desk.plugin.actions["draw_polygon"].isChecked()
    assert desk.session.state() == state
    assert len(bands(desk)) == others


def test_outline_that_crosses_itself_is_refused_and_drawing_goes_on(desk, tool, screenshot):
    desk.look_at(*MERCATOR)
    desk.click(desk.form.area.draw_polygon)
    click(desk, *KITE[:3], (0.5, 0.1))
    assert readout(desk) == "The outline would cross itself"
    assert [text for text in desk.messages() if "would cross itself" in text] == [
        "The outline would cross itself. Go on drawing; Backspace removes the last corner."
    ]
    screenshot("polygon-crossing")
    # Of these four corners it is the way back to the first that crosses.
    click(desk, (0.4, 0.1))
    assert desk.canvas.mapTool() is tool
    click(desk, KITE[3])
    press_key(desk, Qt.Key.Key_Return)
    assert len(area_of(desk).rings[0]) == 4
    assert not any("would cross itself" in text for text in desk.messages())


def test_way_back_to_the_first_corner_may_not_cross_either(desk, tool):
    desk.look_at(*MERCATOR)
    desk.click(desk.form.area.draw_polygon)
    click(desk, (0.2, 0.2), (0.8, 0.2), (0.8, 0.8), (0.3, 0.8), (0.3, 0.4), (0.6, 0.4), (0.6, 0.6))
    click(desk, (0.6, 0.6), button=RIGHT)
    assert desk.canvas.mapTool() is tool
    assert area_of(desk) is None


def test_fewer_than_three_corners_are_no_polygon(desk, tool):
    desk.look_at(*MERCATOR)
    desk.click(desk.form.area.draw_polygon)
    click(desk, KITE[0])
    double_click(desk, KITE[1])
    assert desk.canvas.mapTool() is tool
    assert any("at least 3 corners" in text for text in desk.messages())
    click(desk, KITE[2])
    press_key(desk, Qt.Key.Key_Return)
    assert len(area_of(desk).rings[0]) == 3


@pytest.mark.parametrize(("unit", "words"), [("m", ("km", "km²")), ("ft", ("mi", "acres"))])
def test_length_and_area_are_said_at_the_pointer(desk, screenshot, unit, words):
    crs, extent = MERCATOR
    desk.look_at(crs, extent)
    desk.choose(desk.form.agl_unit, unit)
    desk.click(desk.form.area.draw_polygon)
    desk.move(desk.at(*KITE[0]))
    desk.wait(lambda: readout(desk) == "Click the first corner")
    click(desk, *KITE[:2])
    desk.move(desk.at(*KITE[2]))
    desk.wait(lambda: words[1] in readout(desk) or "sq mi" in readout(desk))
    screenshot(f"polygon-readout-{unit}")
    length, size = readout(desk).split(", ", 1) if unit == "m" else readout(desk).rsplit(", ", 1)
    lon, lat = zip(*(degrees(desk, crs, desk.at(*place)) for place in KITE[:3]))
    geod = Geod(ellps="WGS84")
    m2 = abs(geod.polygon_area_perimeter(lon, lat)[0])
    m = geod.inv(lon[1], lat[1], lon[2], lat[2])[2]
    per_m, per_m2 = (1e-3, 1e-6) if unit == "m" else (1.0 / 1609.344, 1.0 / 1609.344**2)
    assert float(length.split()[0]) == pytest.approx(m * per_m, rel=1e-3)
    assert float(size.split()[0]) == pytest.approx(m2 * per_m2, rel=1e-3)


def test_corners_stay_on_the_ground_when_the_crs_changes(desk):
    desk.look_at(*MERCATOR)
    desk.click(desk.form.area.draw_polygon)
    click(desk, *KITE)
    places = [degrees(desk, MERCATOR[0], desk.at(*place)) for place in KITE]
    QgsProject.instance().setCrs(QgsCoordinateReferenceSystem("EPSG:32616"))
    press_key(desk, Qt.Key.Key_Return)
    for (lon, lat), corner in zip(places, area_of(desk).rings[0]):
        assert corner == pytest.approx((lon, lat), abs=2 * LAST_DIGIT_DEG)


def test_letting_go_of_the_double_click_is_no_click_of_the_tool_before(desk):
    """QGIS's own panning moves the map to a place that is clicked."""
    desk.look_at(*MERCATOR)
    desk.iface.actionPan().trigger()
    extent = desk.canvas.extent()
    desk.session.areas.no_fly_tool.start()
    click(desk, *KITE[:3])
    double_click(desk, KITE[3])
    assert desk.canvas.extent() == extent
    assert len(desk.session.areas.no_fly_mark.area.parts) == 1


# --- corners


@pytest.mark.parametrize(("crs", "extent"), sampled(PLACES, 3))
def test_a_corner_follows_the_pointer(desk, crs, extent):
    desk.look_at(crs, extent)
    draw(desk, KITE)
    before = area_of(desk)
    desk.drag(desk.at(*KITE[1]), desk.at(0.75, 0.15))
    there = on_map(desk, crs, area_of(desk))
    expected = clicked(desk, (KITE[0], (0.75, 0.15), *KITE[2:]))
    # Edges of the new corner are straight in degrees now, which in polar maps bends them.
    corner = QgsGeometry.fromPointXY(desk.canvas.getCoordinateTransform().toMapCoordinates(desk.at(0.75, 0.15)))
    distances = [QgsGeometry.fromPointXY(QgsPointXY(at)).distance(corner) for at in there.asPolygon()[0]]
    assert min(distances) < 0.01 * desk.canvas.mapUnitsPerPixel()
    if crs != "EPSG:3031":
        assert there.hausdorffDistance(expected) < desk.canvas.mapUnitsPerPixel()
    assert desk.form.area.undo.toolTip() == "Undo: move a corner (Ctrl+Z)"
    desk.click(desk.form.area.undo)
    assert area_of(desk) == before


@pytest.mark.parametrize("where", sampled([0.5, 0.3], 2), ids=["its middle", "elsewhere"])
@pytest.mark.parametrize("end", [(0.55, 0.1), None], ids=["dragged", "clicked"])
def test_an_edge_gets_a_corner_where_it_is_taken_hold_of(desk, where, end):
    crs, extent = MERCATOR
    desk.look_at(crs, extent)
    draw(desk, KITE)
    start = tuple(one + where * (other - one) for one, other in zip(KITE[0], KITE[1]))
    desk.drag(desk.at(*start), desk.at(*end)) if end else click(desk, start)
    ring = area_of(desk).rings[0]
    assert len(ring) == 5
    assert ring[1] == pytest.approx(degrees(desk, crs, desk.at(*(end or start))), abs=LAST_DIGIT_DEG)
    assert desk.form.area.undo.toolTip() == "Undo: add a corner (Ctrl+Z)"


@pytest.mark.parametrize("way", sampled(["right click", "delete", "backspace"], 2))
def test_a_corner_is_removed(desk, way):
    desk.look_at(*MERCATOR)
    draw(desk, (*KITE, (0.15, 0.5)))
    if way == "right click":
        click(desk, KITE[1], button=RIGHT)
    else:
        desk.move(desk.at(*KITE[1]))
        desk.wait(lambda: desk.canvas.viewport().cursor().shape() == Qt.CursorShape.PointingHandCursor)
        press_key(desk, Qt.Key.Key_Delete if way == "delete" else Qt.Key.Key_Backspace)
    expected = clicked(desk, (KITE[0], *KITE[2:], (0.15, 0.5)))
    assert on_map(desk, MERCATOR[0], area_of(desk)).hausdorffDistance(expected) < desk.canvas.mapUnitsPerPixel()
    assert desk.form.area.undo.toolTip() == "Undo: remove a corner (Ctrl+Z)"
    click(desk, KITE[0], button=RIGHT)
    three = area_of(desk)
    click(desk, KITE[2], button=RIGHT)
    assert area_of(desk) == three
    assert any("at least 3 corners" in text for text in desk.messages())


def test_a_corner_that_makes_outlines_cross_goes_back(desk):
    desk.look_at(*MERCATOR)
    draw(desk, KITE)
    before, count = area_of(desk), desk.form.area_editing.history.stack.count()
    desk.drag(desk.at(*KITE[1]), desk.at(0.1, 0.6))
    assert area_of(desk) == before
    assert desk.form.area_editing.history.stack.count() == count
    assert "The outline would cross itself. The area is unchanged." in desk.messages()
    # What the entries showed while it was dragged has gone back, too.
    assert float(desk.form.edges["west"].text()) == before.bounds.west_deg


def test_escape_puts_a_corner_back(desk):
    desk.look_at(*MERCATOR)
    draw(desk, KITE)
    before, viewport = area_of(desk), desk.canvas.viewport()
    QTest.mousePress(viewport, LEFT, NONE, desk.at(*KITE[1]))
    desk.move(desk.at(0.75, 0.15), held=LEFT)
    assert readout(desk) != ""
    press_key(desk, Qt.Key.Key_Escape)
    QTest.mouseRelease(viewport, LEFT, NONE, desk.at(0.75, 0.15))
    assert area_of(desk) == before
    assert desk.canvas.mapTool() is desk.session.areas.tool


def test_polygon_is_moved_from_inside(desk):
    desk.look_at(*MERCATOR)
    draw(desk, KITE)
    before = area_of(desk)
    start, end = desk.at(0.5, 0.5), desk.at(0.5, 0.5) + QPoint(30, 20)
    desk.drag(start, end)
    (lon0, lat0), (lon1, lat1) = (degrees(desk, MERCATOR[0], at) for at in (start, end))
    for (lon, lat), corner in zip(before.rings[0], area_of(desk).rings[0]):
        assert corner == pytest.approx((lon + lon1 - lon0, lat + lat1 - lat0), abs=1e-9)


# --- holes and parts


def test_a_hole_is_cut_and_removed(desk, screenshot):
    crs, extent = MERCATOR
    desk.look_at(crs, extent)
    draw(desk, KITE)
    menu_at(desk, (0.5, 0.5))["add_hole"].trigger()
    click(desk, *INSIDE)
    press_key(desk, Qt.Key.Key_Return)
    screenshot("polygon-with-hole")
    expected = clicked(desk, KITE).difference(clicked(desk, INSIDE))
    there = on_map(desk, crs, area_of(desk))
    assert there.symDifference(expected).area() < 1e-4 * expected.area()
    assert "1 hole" in desk.form.area.words.text()
    # Corners of holes are moved as others are.
    desk.drag(desk.at(*INSIDE[2]), desk.at(0.5, 0.65))
    assert on_map(desk, crs, area_of(desk)).area() < there.area()
    menu_at(desk, (0.48, 0.45))["remove_hole"].trigger()
    assert on_map(desk, crs, area_of(desk)).hausdorffDistance(clicked(desk, KITE)) < desk.canvas.mapUnitsPerPixel()
    for _ in range(2):
        desk.click(desk.form.area.undo)
    assert on_map(desk, crs, area_of(desk)).symDifference(there).area() < 1e-6 * there.area()


def test_a_hole_lies_inside(desk):
    desk.look_at(*MERCATOR)
    draw(desk, KITE)
    before = area_of(desk)
    desk.form.area.area_from.actions_by_name["add_hole"].trigger()
    click(desk, (0.6, 0.4), (0.95, 0.4), (0.6, 0.5))
    press_key(desk, Qt.Key.Key_Return)
    assert desk.canvas.mapTool() is desk.session.areas.hole_tool
    assert any("A hole must lie inside the area" in text for text in desk.messages())
    press_key(desk, Qt.Key.Key_Escape)
    assert desk.canvas.mapTool() is desk.session.areas.tool
    assert area_of(desk) == before


def test_one_more_polygon_is_drawn_and_removed(desk, screenshot):
    crs, extent = MERCATOR
    desk.look_at(crs, extent)
    draw(desk, KITE)
    first = area_of(desk)
    beside = ((0.85, 0.1), (0.95, 0.1), (0.95, 0.4))
    menu_at(desk, (0.1, 0.1))["add_polygon"].trigger()
    click(desk, *beside)
    press_key(desk, Qt.Key.Key_Return)
    area = area_of(desk)
    assert isinstance(area, Polygons)
    assert [len(part.rings[0]) for part in area.parts] == [4, 3]
    assert desk.form.area.words.text().startswith("2 polygons, 7 corners, ")
    assert desk.wait_planned().mission.area == area
    screenshot("two-polygons")
    desk.drag(desk.at(*beside[0]), desk.at(0.82, 0.12))
    assert area_of(desk).parts[0] == first
    assert area_of(desk).parts[1].rings[0][0] == pytest.approx(
        degrees(desk, crs, desk.at(0.82, 0.12)), abs=LAST_DIGIT_DEG
    )
    menu_at(desk, (0.93, 0.15))["remove_polygon"].trigger()
    assert area_of(desk) == first


def test_polygons_that_overlap_are_joined(desk):
    crs, extent = MERCATOR
    desk.look_at(crs, extent)
    draw(desk, KITE)
    over = ((0.6, 0.4), (0.95, 0.4), (0.6, 0.5))
    desk.form.area.area_from.actions_by_name["add_polygon"].trigger()
    click(desk, *over)
    press_key(desk, Qt.Key.Key_Return)
    expected = clicked(desk, KITE).combine(clicked(desk, over))
    there = on_map(desk, crs, area_of(desk))
    assert there.symDifference(expected).area() < 1e-4 * expected.area()


def test_one_more_polygon_across_the_antimeridian_is_on_the_turn_of_the_first():
    west = Polygon((((179.0, 0.0), (179.5, 0.0), (179.5, 1.0), (179.0, 1.0)),))
    over = Polygon((((-181.0, 0.5), (-179.0, 0.5), (-179.0, 0.8), (-181.0, 0.8)),))
    joined = join_polygon(west, over)
    assert isinstance(joined, Polygon)
    assert joined.bounds == Box(1.0, 179.0, 0.0, -179.0)
    apart = join_polygon(west, Polygon((((-179.9, 0.5), (-179.0, 0.5), (-179.0, 0.8)),)))
    assert apart.bounds == Box(1.0, 179.0, 0.0, -179.0)


def test_a_box_becomes_a_polygon(desk):
    desk.look_at(*MERCATOR)
    box = Box(35.16, -89.90, 35.115, -89.823)
    desk.form.area_editing.set_area(box, "test")
    desk.click(desk.form.area.edit)
    menu_at(desk, (0.5, 0.5))["to_polygon"].trigger()
    area = area_of(desk)
    assert isinstance(area, Polygon)
    assert area.bounds == box
    assert area.area_m2() == pytest.approx(box.area_m2(), rel=1e-9)
    assert "to_polygon" not in menu_at(desk, (0.5, 0.5))


def test_points_have_no_such_menu(desk):
    desk.look_at(*MERCATOR)
    desk.form.area_editing.set_area(Points(((35.14, -89.85, 100.0),)), "test")
    desk.click(desk.form.area.edit)
    assert menu_at(desk, (0.5, 0.5)) == {}
    assert not desk.form.area.area_from.actions_by_name["add_hole"].isEnabled()


def test_handles_follow_the_edges_on_a_polar_map(desk, screenshot):
    """Edges that are straight in degrees are arcs there: they are caught along the arc."""
    crs, extent = PLACES[3].values
    desk.look_at(crs, extent)
    ring = ((-20.0, -80.0), (20.0, -80.0), (20.0, -76.0), (-20.0, -76.0))
    desk.form.area_editing.set_area(Polygon((ring,)), "test")
    desk.click(desk.form.area.edit)
    screenshot("polar-polygon")
    start = pixel(desk, crs, 10.0, -80.0)
    desk.drag(start, start + QPoint(0, 15))
    found = area_of(desk).rings[0]
    assert len(found) == 5
    assert found[1] == pytest.approx(degrees(desk, crs, start + QPoint(0, 15)), abs=LAST_DIGIT_DEG)
