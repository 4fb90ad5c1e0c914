"""No-fly areas and the take-off point on the map, in the panel, in missions and projects."""

from __future__ import annotations

import json
import re

import pytest
from qgis.core import QgsFeature, QgsGeometry, QgsProject, QgsVectorLayer
from qgis.gui import QgsRubberBand
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QFileDialog
from terrainav.core.mission.areas.area import Polygon
from terrainav.core.mission.mission import Mission
from terrainav.terrainav_plugin.area.bands import NO_FLY_COLOURS
from terrainav.terrainav_plugin.form import mission_form
from terrainav.terrainav_plugin.form.area import entered_area, entered_no_fly

from tests.plugin.test_area_layers import accept, dialog_of, layer_of
from tests.plugin.test_area_tool import bands, degrees
from tests.plugin.test_polygon_tool import KITE, LEFT, MERCATOR, NONE, click, draw, on_map, press_key
from tests.support.thinning import sampled

RING = ((-89.87, 35.13), (-89.86, 35.13), (-89.86, 35.14))
CORNER = ((0.6, 0.4), (0.95, 0.4), (0.9, 0.6))


def draw_no_fly(desk, places=CORNER):
    desk.form.area.no_fly_from.actions_by_name["draw_no_fly"].trigger()
    click(desk, *places)
    press_key(desk, Qt.Key.Key_Return)


def words(desk):
    label = desk.form.area.no_fly_words
    return re.sub("<[^>]*>", "", label.text()) if label.isVisibleTo(desk.form) else ""


def hatched(desk):
    """Ground that is hatched on the map."""
    shapes = [band.asGeometry() for band in bands(desk) if band.fillColor() == NO_FLY_COLOURS.fill]
    return sum(shape.area() for shape in shapes if not shape.isEmpty())


def choose_file(monkeypatch, path):
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(path), ""))


def geojson(path, *rings):
    shapes = [{"type": "Polygon", "coordinates": [[*ring, ring[0]]]} for ring in rings]
    path.write_text(json.dumps({"type": "GeometryCollection", "geometries": shapes}))
    return path


def kml(path, *rings):
    placemarks = "".join(
        "<Placemark><Polygon><outerBoundaryIs><LinearRing><coordinates>"
        + " ".join(f"{lon},{lat},0" for lon, lat in (*ring, ring[0]))
        + "</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>"
        for ring in rings
    )
    path.write_text(f'<kml xmlns="http://www.opengis.net/kml/2.2"><Document>{placemarks}</Document></kml>')
    return path


# --- no-fly areas


def test_no_fly_areas_are_drawn_listed_undone_and_cleared(ground, desk, screenshot):
    crs, extent = MERCATOR
    desk.look_at(crs, extent)
    draw(desk, KITE)
    area = entered_area(desk.session.state())
    assert words(desk) == ""
    draw_no_fly(desk)
    assert words(desk) == "1 no-fly area (remove)"
    (one,) = entered_no_fly(desk.session.state())
    assert on_map(desk, crs, one).area() == pytest.approx(hatched(desk), rel=1e-3)
    draw_no_fly(desk, ((0.1, 0.6), (0.3, 0.6), (0.2, 0.95)))
    assert words(desk) == "2 no-fly areas (remove)"
    screenshot("no-fly")
    assert desk.form.area.undo.toolTip() == "Undo: draw a no-fly area (Ctrl+Z)"
    desk.click(desk.form.area.undo)
    assert entered_no_fly(desk.session.state()) == (one,)
    desk.click(desk.form.area.redo)
    assert len(desk.wait_planned().mission.no_fly) == 2
    desk.form.area.no_fly_words.linkActivated.emit("remove")
    assert words(desk) == ""
    assert hatched(desk) == 0.0
    desk.click(desk.form.area.undo)
    assert words(desk) == "2 no-fly areas (remove)"
    assert entered_area(desk.session.state()) == area


def test_no_images_are_planned_over_no_fly_areas(desk):
    desk.look_at("EPSG:4326", (-89.875, 35.128, -89.85, 35.143))
    desk.enter_small_mission()
    count = len(desk.wait_planned().plan)
    desk.form.area_editing.set_no_fly((Polygon((RING,)),), "test")
    plan = desk.wait_planned().plan
    assert 0 < len(plan) < count
    ring = QgsGeometry.fromWkt(f"Polygon (({', '.join(f'{x} {y}' for x, y in (*RING, RING[0]))}))")
    assert not any(
        ring.contains(QgsGeometry.fromWkt(f"Point ({lon} {lat})")) for lat, lon in zip(plan.lat_deg, plan.lon_deg)
    )


def test_they_are_hatched_while_the_panel_is_there_and_under_a_preview(desk, screenshot):
    desk.look_at("EPSG:4326", (-89.875, 35.128, -89.85, 35.143))
    desk.enter_small_mission()
    desk.form.area_editing.set_no_fly((Polygon((RING,)),), "test")
    assert hatched(desk) > 0.0
    desk.session.set_preview(True)
    desk.wait_previewed()
    assert hatched(desk) > 0.0
    screenshot("no-fly-preview")
    desk.session.show_dock(False)
    desk.wait(lambda: hatched(desk) == 0.0)
    desk.session.show_dock(True)
    desk.wait(lambda: hatched(desk) > 0.0)


def test_no_fly_areas_of_a_layer(desk, screenshot):
    wkts = [
        "Polygon ((0 0, 1 0, 1 1, 0 0), (0.5 0.1, 0.6 0.1, 0.6 0.2, 0.5 0.1))",
        "Polygon ((2 0, 3 0, 3 1, 2 0))",
    ]
    layer = layer_of("Polygon", "EPSG:4326", wkts)
    desk.iface.setActiveLayer(layer)
    desk.form.area.no_fly_from.actions_by_name["no_fly_layer"].trigger()
    dialog = dialog_of(desk)
    assert "all 2 polygons" in dialog.words.text()
    screenshot("no-fly-layer", dialog)
    accept(desk, dialog)
    desk.wait(lambda: words(desk) == "2 no-fly areas (remove)")
    assert [len(one.rings) for one in entered_no_fly(desk.session.state())] == [2, 1]
    # More are added to those that are there.
    layer.selectByIds([2])
    desk.form.area.no_fly_from.actions_by_name["no_fly_layer"].trigger()
    accept(desk, dialog_of(desk))
    desk.wait_for_tasks()
    # The same polygon once more forbids no more.
    desk.qtbot.wait(50)
    assert words(desk) == "2 no-fly areas (remove)"


@pytest.mark.parametrize("write", [geojson, kml])
def test_no_fly_areas_of_a_file(desk, tmp_path, monkeypatch, write):
    beside = tuple((lon + 1.0, lat) for lon, lat in RING)
    choose_file(monkeypatch, write(tmp_path / f"some.{write.__name__}", RING, beside))
    desk.form.area.no_fly_from.actions_by_name["no_fly_file"].trigger()
    desk.wait(lambda: words(desk) == "2 no-fly areas (remove)")
    assert entered_no_fly(desk.session.state()) == (Polygon((RING,)), Polygon((beside,)))


def test_a_file_without_polygons_is_refused(desk, tmp_path, monkeypatch):
    choose_file(monkeypatch, geojson(tmp_path / "none.geojson"))
    desk.form.area.no_fly_from.actions_by_name["no_fly_file"].trigger()
    desk.wait(lambda: any("holds no polygon" in text for text in desk.messages()))
    assert words(desk) == ""


@pytest.mark.parametrize("write", [geojson, kml])
def test_area_of_a_file_with_several_polygons(desk, tmp_path, monkeypatch, write):
    beside = tuple((lon + 0.02, lat) for lon, lat in RING)
    desk.look_at("EPSG:4326", (10.0, 50.0, 10.1, 50.1))
    choose_file(monkeypatch, write(tmp_path / f"some.{write.__name__}", RING, beside))
    desk.form.area.area_from.actions_by_name["area_file"].trigger()
    desk.wait(lambda: desk.form.area.words.text().startswith("2 polygons, 6 corners"))
    assert desk.form.area.undo.toolTip() == "Undo: area file (Ctrl+Z)"
    # The map goes where it can be seen.
    desk.wait(lambda: desk.canvas.extent().contains(-89.86, 35.13))


def test_they_are_part_of_saved_missions_and_of_the_session(desk):
    desk.enter_small_mission()
    desk.form.area_editing.set_no_fly((Polygon((RING,)),), "test")
    desk.form.area_editing.set_takeoff("35.1, -89.8", "test")
    state = desk.session.state()
    mission = mission_form.mission(state)
    assert mission.no_fly == (Polygon((RING,)),)
    assert mission.route.takeoff == (35.1, -89.8)
    again = mission_form.mission_state(Mission.from_json(mission.to_json()), state.folder)
    assert (again.no_fly, again.takeoff) == (state.no_fly, state.takeoff)
    assert type(state).from_json(state.to_json()).no_fly == state.no_fly


def test_a_test_shot_is_taken_anywhere(desk):
    desk.enter_small_mission()
    desk.form.area_editing.set_no_fly((Polygon((RING,)),), "test")
    assert mission_form.test_shot(desk.session.state(), 35.133, -89.862).no_fly == ()


# --- take-off


def test_take_off_point_is_clicked_shown_and_cleared(ground, desk, screenshot):
    crs, extent = MERCATOR
    desk.look_at(crs, extent)
    draw(desk, KITE)
    route = desk.form.route
    route.setCollapsed(False)
    desk.click(route.pick_takeoff)
    at = desk.at(0.15, 0.5)
    QTest.mouseClick(desk.canvas.viewport(), LEFT, NONE, at)
    lon, lat = degrees(desk, crs, at)
    assert tuple(map(float, route.takeoff.text().split(","))) == pytest.approx((lat, lon), abs=1e-7)
    assert desk.wait_planned().mission.route.takeoff == pytest.approx((lat, lon), abs=1e-7)
    (place,) = (band.asGeometry() for band in bands(desk) if band.icon() == QgsRubberBand.IconType.ICON_SVG)
    expected = QgsGeometry.fromPointXY(desk.canvas.getCoordinateTransform().toMapCoordinates(at))
    assert place.distance(expected) < desk.canvas.mapUnitsPerPixel()
    screenshot("take-off")
    # The map's tool before it goes on.
    assert desk.canvas.mapTool() is desk.session.areas.tool
    desk.click(desk.form.area.undo)
    assert route.takeoff.text() == ""
    assert desk.session.areas.takeoff_mark.area is None
    desk.click(desk.form.area.redo)
    route.takeoff.clear()
    assert desk.session.areas.takeoff_mark.area is None


def test_take_off_point_that_is_typed_is_shown(desk):
    desk.form.route.setCollapsed(False)
    desk.type_text(desk.form.route.takeoff, "35.1 -89.8")
    assert desk.session.areas.takeoff_mark.area.poses[0][:2] == (35.1, -89.8)
    desk.type_text(desk.form.route.takeoff, "somewhere")
    assert desk.session.areas.takeoff_mark.area is None


# --- the map


def test_a_new_mission_leaves_nothing_on_the_map(desk, wait_until_drawn, screenshot):
    desk.look_at("EPSG:4326", (-89.875, 35.128, -89.85, 35.143))
    layer_of("Polygon", "EPSG:4326", ["Polygon ((0 0, 1 0, 1 1, 0 0))"])
    wait_until_drawn()
    desk.look_at("EPSG:4326", (-89.875, 35.128, -89.85, 35.143))
    empty = colours(desk)
    desk.enter_small_mission()
    desk.form.area_editing.set_no_fly((Polygon((RING,)),), "test")
    desk.form.area_editing.set_takeoff("35.1405, -89.871", "test")
    desk.session.set_preview(True)
    desk.wait_previewed()
    desk.canvas.waitWhileRendering()
    assert colours(desk) != empty
    desk.session.missions.begin_new()
    state = desk.session.state()
    assert (state.north, state.no_fly, state.takeoff) == ("", "", "")
    assert all(band.asGeometry().isEmpty() for band in bands(desk))
    desk.wait(lambda: colours(desk) == empty)


def colours(desk):
    image = desk.canvas.grab().toImage()
    return {image.pixel(x, y) for x in range(0, image.width(), 2) for y in range(0, image.height(), 2)}


def names(desk):
    return [node.name() for node in QgsProject.instance().layerTreeRoot().children()]


def test_layers_that_are_added_do_not_hide_the_preview(desk):
    desk.enter_small_mission()
    desk.session.set_preview(True)
    desk.wait_previewed()
    group = desk.group().name()
    desk.iface.layerTreeView().setCurrentIndex(desk.iface.layerTreeView().model().index(-1, -1))
    footprints = desk.layer("Planned images").id()
    add_layer("first")
    desk.wait(lambda: names(desk) == [group, "first"])
    assert desk.layer("Planned images").id() == footprints
    # What a user puts above it stays there, and so does what comes above that.
    root = QgsProject.instance().layerTreeRoot()
    node = root.children()[1]
    root.insertChildNode(0, node.clone())
    root.removeChildNode(node)
    desk.qtbot.wait(50)
    assert names(desk) == ["first", group]
    add_layer("second")
    desk.wait(lambda: len(names(desk)) == 3)
    assert names(desk).index("first") < names(desk).index(group)


def test_layers_that_are_added_do_not_go_into_the_mission_group(desk):
    """QGIS puts them above the current layer, which may be one of the mission's."""
    desk.enter_small_mission()
    desk.session.set_preview(True)
    desk.wait_previewed()
    group, inside = desk.group().name(), desk.layer_names()
    desk.iface.setActiveLayer(desk.layer("Planned images"))
    add_layer("mine")
    desk.wait(lambda: names(desk) == [group, "mine"])
    assert desk.layer_names() == inside
    assert QgsProject.instance().mapLayersByName("mine")


def add_layer(name):
    """Layer at the top, as QGIS adds one while none is current."""
    layer = QgsVectorLayer("Polygon?crs=EPSG:4326", name, "memory")
    feature = QgsFeature()
    feature.setGeometry(QgsGeometry.fromWkt("Polygon ((-90 35, -89 35, -89 36, -90 35))"))
    layer.dataProvider().addFeatures([feature])
    layer.updateExtents()
    QgsProject.instance().addMapLayer(layer)
    return layer


@pytest.mark.parametrize("way", sampled(["typed", "pasted", "layer", "extent", "undo"], 3))
def test_the_map_goes_to_an_area_that_is_out_of_sight(desk, way, qapp):
    layer = layer_of("Polygon", "EPSG:4326", ["Polygon ((-89.87 35.13, -89.86 35.13, -89.86 35.14, -89.87 35.13))"])
    desk.iface.setActiveLayer(layer)
    desk.look_at("EPSG:4326", (10.0, 50.0, 10.1, 50.1))
    if way == "typed":
        desk.enter_box("35.14", "-89.87", "35.13", "-89.86")
    elif way == "pasted":
        qapp.clipboard().setText("35.14_-89.87_35.13_-89.86_120")
        desk.session.areas.paste()
    elif way in ("layer", "extent"):
        desk.form.area.area_from.actions_by_name["polygon" if way == "layer" else "layer"].trigger()
        accept(desk, dialog_of(desk))
    else:
        desk.enter_box("35.14", "-89.87", "35.13", "-89.86")
        desk.wait(lambda: desk.canvas.extent().contains(-89.865, 35.135))
        desk.form.area.area_from.actions_by_name["canvas"].trigger()
        desk.look_at("EPSG:4326", (10.0, 50.0, 10.1, 50.1))
        desk.click(desk.form.area.undo)
    desk.wait(lambda: desk.canvas.extent().contains(-89.865, 35.135))
