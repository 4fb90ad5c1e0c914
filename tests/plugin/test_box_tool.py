"""Drawing the area on the map with the mouse, whatever the project's CRS."""

from __future__ import annotations

import pytest
from pyproj import Geod, Transformer
from qgis.core import QgsCoordinateReferenceSystem, QgsProject
from qgis.gui import QgsRubberBand
from qgis.PyQt.QtCore import QPoint, Qt
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QLabel
from terrainav.core.errors import InvalidInput
from terrainav.terrainav_plugin.map.canvas import box_of_outline, canvas_rectangle, rectangle_box

pytestmark = pytest.mark.usefixtures("ground")

# Of a degree, as the fields show it.
LAST_DECIMAL_DEG = 1e-7


def rubber_bands(desk):
    return sum(isinstance(item, QgsRubberBand) for item in desk.canvas.scene().items())


def corners_by_pyproj(desk, crs, start, end):
    """Longitudes and latitudes of the two dragged corners, worked out by another program's way."""
    to_degrees = Transformer.from_crs(crs, "EPSG:4326", always_xy=True)
    to_map = desk.canvas.getCoordinateTransform().toMapCoordinates
    return [to_degrees.transform(*to_map(at)) for at in (start, end)]


@pytest.mark.parametrize(
    ("crs", "extent"),
    [
        ("EPSG:3857", (-10_010_000, 4_178_000, -9_998_000, 4_187_000)),
        ("EPSG:4326", (-89.95, 35.10, -89.80, 35.20)),
    ],
)
def test_dragged_box_fills_the_fields(desk, crs, extent):
    desk.look_at(crs, extent)
    before = desk.canvas.mapTool()
    desk.click(desk.form.draw_box)
    assert desk.canvas.mapTool() is desk.session.box_tool
    start, end = desk.at(0.3, 0.3), desk.at(0.6, 0.7)
    desk.drag(start, end)

    (west, north), (east, south) = corners_by_pyproj(desk, crs, start, end)
    shown = {name: float(edit.text()) for name, edit in desk.form.edges.items()}
    expected = {"north": north, "west": west, "south": south, "east": east}
    assert shown == pytest.approx(expected, abs=LAST_DECIMAL_DEG)
    # The box can be moved at once; Esc gives the map back.
    assert desk.canvas.mapTool() is desk.session.areas.tool
    QTest.keyClick(desk.canvas, Qt.Key.Key_Escape)
    assert desk.canvas.mapTool() is before
    assert desk.wait_planned().plan.mission.area.north_deg == shown["north"]


def test_box_in_a_utm_project_holds_the_bulge_of_its_sides(desk):
    """Sides of the rectangle are no parallels there: its top bulges north between the corners."""
    desk.look_at("EPSG:32616", (300_000, 3_850_000, 700_000, 4_100_000))
    desk.click(desk.form.draw_box)
    start, end = desk.at(0.1, 0.2), desk.at(0.9, 0.8)
    desk.drag(start, end)

    (_, north_west), _ = corners_by_pyproj(desk, "EPSG:32616", start, end)
    to_degrees = Transformer.from_crs("EPSG:32616", "EPSG:4326", always_xy=True)
    top = desk.canvas.getCoordinateTransform().toMapCoordinates(start).y()
    highest = to_degrees.transform(500_000, top)[1]
    north = float(desk.form.edges["north"].text())
    assert north > north_west
    assert north == pytest.approx(highest, abs=1e-4)


def test_box_across_the_antimeridian(desk):
    desk.look_at("EPSG:3832", (3_200_000, -500_000, 3_500_000, -200_000))
    desk.click(desk.form.draw_box)
    desk.drag(desk.at(0.1, 0.1), desk.at(0.9, 0.9))
    west, east = (float(desk.form.edges[name].text()) for name in ("west", "east"))
    assert 178.0 < west < 180.0
    assert -180.0 < east < -178.0
    assert desk.message("west") == desk.message("east") == ""


def test_escape_while_dragging_gives_up_and_restores_the_tool(desk):
    desk.look_at("EPSG:3857", (-10_010_000, 4_178_000, -9_998_000, 4_187_000))
    before, state, extent = desk.canvas.mapTool(), desk.session.state(), desk.canvas.extent()
    desk.click(desk.form.draw_box)
    viewport, items = desk.canvas.viewport(), rubber_bands(desk)
    QTest.mousePress(viewport, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, desk.at(0.3, 0.3))
    desk.move(desk.at(0.5, 0.5), held=Qt.MouseButton.LeftButton)
    assert rubber_bands(desk) > items
    QTest.keyClick(desk.canvas, Qt.Key.Key_Escape)
    assert rubber_bands(desk) == items
    QTest.mouseRelease(viewport, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, desk.at(0.5, 0.5))
    assert desk.canvas.mapTool() is before
    assert desk.session.state() == state
    assert desk.canvas.extent() == extent


@pytest.mark.parametrize(("unit", "km", "km2"), [("m", "km", "km²"), ("ft", "mi", "sq mi")], ids=["metres", "feet"])
def test_size_is_told_beside_the_pointer_while_drawing(desk, screenshot, unit, km, km2):
    """By another program's geodesics; in the unit of the heights, in the panel too."""
    desk.choose(desk.form.agl_unit, unit)
    desk.look_at("EPSG:3857", (-10_010_000, 4_178_000, -9_998_000, 4_187_000))
    desk.click(desk.form.draw_box)
    viewport, start, end = desk.canvas.viewport(), desk.at(0.3, 0.3), desk.at(0.6, 0.7)
    QTest.mousePress(viewport, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, start)
    desk.move(start, held=Qt.MouseButton.LeftButton)
    desk.move(end, held=Qt.MouseButton.LeftButton)
    (west, north), (east, south) = corners_by_pyproj(desk, "EPSG:3857", start, end)
    geod = Geod(ellps="WGS84")
    middle = (north + south) / 2.0
    m_per_unit = {"km": 1000.0, "mi": 1609.344}[km]
    width = geod.inv(west, middle, east, middle)[2] / m_per_unit
    height = geod.inv(west, south, west, north)[2] / m_per_unit
    size = f"{width:.4g} {km} × {height:.4g} {km}, {width * height:.4g} {km2}"
    label = viewport.findChild(QLabel, "terrainav_readout")
    assert label.text() == size
    assert viewport.rect().contains(label.geometry())
    screenshot(f"draw-box-{unit}")
    QTest.mouseRelease(viewport, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, end)
    desk.wait(lambda: viewport.findChild(QLabel, "terrainav_readout") is None)
    assert desk.form.findChild(QLabel, "describe_area").text() == f"Box, {size}"


def test_escape_before_dragging_restores_the_tool(desk):
    before = desk.canvas.mapTool()
    desk.click(desk.form.draw_box)
    QTest.keyClick(desk.canvas, Qt.Key.Key_Escape)
    assert desk.canvas.mapTool() is before


def test_click_without_a_drag_draws_nothing(desk):
    desk.look_at("EPSG:3857", (-10_010_000, 4_178_000, -9_998_000, 4_187_000))
    state = desk.session.state()
    desk.click(desk.form.draw_box)
    desk.drag(desk.at(0.5, 0.5), desk.at(0.5, 0.5) + QPoint(2, 1))
    assert desk.session.state() == state
    assert desk.canvas.mapTool() is desk.session.box_tool


def test_toolbar_button_shows_the_tool_in_use(desk):
    action = desk.plugin.actions["draw_box"]
    action.trigger()
    assert action.isChecked()
    assert desk.canvas.mapTool() is desk.session.box_tool
    QTest.keyClick(desk.canvas, Qt.Key.Key_Escape)
    assert not action.isChecked()


def test_outline_around_a_pole_reaches_it():
    around = [(float(lon), 80.0) for lon in range(-180, 180, 5)]
    north = box_of_outline(around, lambda: 90.0)
    assert (north.north_deg, north.south_deg, north.west_deg, north.east_deg) == (90.0, 80.0, -180.0, 180.0)
    south = box_of_outline([(lon, -lat) for lon, lat in around], lambda: -90.0)
    assert (south.north_deg, south.south_deg) == (-80.0, -90.0)


@pytest.mark.parametrize("crs", ["EPSG:4326", "EPSG:3857", "EPSG:32616", "EPSG:2163"])
def test_box_of_the_rectangle_of_a_box_holds_it(clean_project, crs):
    from terrainav.core.mission.areas.area import Box

    box = Box(35.16, -89.90, 35.115, -89.823)
    there = QgsCoordinateReferenceSystem(crs)
    found = rectangle_box(canvas_rectangle(box, there, clean_project), there, clean_project)
    # Rectangles along other axes are larger than what they hold; by no more than the box's own tilt makes them.
    assert -1e-9 < found.north_deg - box.north_deg < 0.01
    assert -1e-9 < box.west_deg - found.west_deg < 0.01
    assert -1e-9 < box.south_deg - found.south_deg < 0.01
    assert -1e-9 < found.east_deg - box.east_deg < 0.01


def test_rectangle_outside_the_crs_is_refused_in_words():
    from qgis.core import QgsRectangle

    crs = QgsCoordinateReferenceSystem("EPSG:32616")
    with pytest.raises(InvalidInput, match="outside the domain of the project's CRS EPSG:32616"):
        rectangle_box(QgsRectangle(1e9, 1e9, 2e9, 2e9), crs, QgsProject.instance())
