"""Patterns of the menu *Area from*: their dialogs, and the points that the mission becomes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from osgeo import gdal
from qgis.core import QgsCoordinateReferenceSystem, QgsFeature, QgsGeometry, QgsProject, QgsVectorLayer
from qgis.PyQt.QtWidgets import QDialog, QDialogButtonBox
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.areas.area import Points, Polygon
from terrainav.core.poses.patterns import corridor, facade, orbit, structure
from terrainav.core.poses.settings import Corridor, Orbit, Scan
from terrainav.terrainav_plugin.form.area import entered_area
from terrainav.terrainav_plugin.form.camera import state_camera

LINE = [(7.4, 46.9), (7.41, 46.9), (7.41, 46.905)]
RING = [(7.4, 46.9), (7.401, 46.9), (7.401, 46.901), (7.4, 46.901), (7.4, 46.9)]


@pytest.fixture
def layers(desk):
    for kind, words in (("LineString", LINE), ("Polygon", RING)):
        layer = QgsVectorLayer(f"{kind}?crs=EPSG:4326", kind, "memory")
        corners = ", ".join(f"{lon} {lat}" for lon, lat in words)
        feature = QgsFeature()
        feature.setGeometry(
            QgsGeometry.fromWkt(f"LineString ({corners})" if kind == "LineString" else f"Polygon (({corners}))")
        )
        layer.dataProvider().addFeatures([feature])
        layer.updateExtents()
        QgsProject.instance().addMapLayer(layer)
    state = desk.session.state()
    desk.form.set_state(replace(state, agl=100.0, overlap_along=0.7, overlap_across=0.6))


def dialog_of(desk, way):
    desk.form.area.area_from.actions_by_name[way].trigger()
    return shown_dialog(desk)


def shown_dialog(desk):
    window = desk.iface.mainWindow()
    desk.wait(lambda: any(one.isVisible() for one in window.findChildren(QDialog)))
    return next(one for one in window.findChildren(QDialog) if one.isVisible())


def entered_after(desk, dialog):
    """Area that there is once the dialog is accepted."""
    before = entered_area(desk.session.state())
    buttons = dialog.findChild(QDialogButtonBox)
    desk.click(buttons.button(QDialogButtonBox.StandardButton.Ok))
    desk.wait(lambda: entered_area(desk.session.state()) != before)
    return entered_area(desk.session.state())


def test_line_becomes_a_corridor(desk, layers, screenshot):
    dialog = dialog_of(desk, "corridor")
    dialog.entries.boxes["width_m"].setValue(150.0)
    screenshot("pattern-corridor", dialog)
    assert "(100 m) and overlaps (70 %, 60 %)" in dialog.words.text()
    line = np.array([(lat, lon) for lon, lat in LINE])
    expected = corridor([line], Camera(), 100.0, (0.7, 0.6), Corridor(150.0))
    assert entered_after(desk, dialog) == expected


def test_line_becomes_a_facade(desk, layers, screenshot):
    dialog = dialog_of(desk, "facade")
    dialog.entries.boxes["highest_m"].setValue(40.0)
    dialog.left.setChecked(True)
    screenshot("pattern-facade", dialog)
    line = np.array([(lat, lon) for lon, lat in LINE])
    expected = facade([line], Camera(), (0.7, 0.6), Scan(20.0, 10.0, 40.0), left=True)
    assert entered_after(desk, dialog) == expected


def test_polygon_becomes_a_scan_of_a_structure(desk, layers):
    dialog = dialog_of(desk, "structure")
    expected = structure([Polygon((tuple(RING),))], Camera(), (0.7, 0.6), Scan(20.0, 10.0, 10.0))
    found = entered_after(desk, dialog)
    assert isinstance(found, Points)
    np.testing.assert_allclose(found.poses, expected.poses, atol=1e-8)
    np.testing.assert_allclose(found.yaws_deg, expected.yaws_deg, atol=1e-4)


def test_orbit_is_around_the_point_that_is_clicked(desk, layers, screenshot):
    desk.look_at("EPSG:4326", (7.39, 46.89, 7.41, 46.91))
    desk.form.area.area_from.actions_by_name["orbit"].trigger()
    at = desk.at(0.3, 0.4)
    desk.click_map(at)
    dialog = shown_dialog(desk)
    clicked = desk.canvas.getCoordinateTransform().toMapCoordinates(at)
    centre = dialog.lat.value(), dialog.lon.value()
    assert centre == pytest.approx((clicked.y(), clicked.x()), abs=1e-6)
    # Their digits are all to be seen.
    for box in (dialog.lat, dialog.lon):
        text = box.fontMetrics().horizontalAdvance(box.text())
        assert text < box.lineEdit().width()
    screenshot("pattern-orbit", dialog)
    assert entered_after(desk, dialog) == orbit(*centre, Orbit(40.0, 30.0, 30.0))


def test_random_poses_are_inside_the_area(desk, layers, screenshot):
    desk.enter_box("46.91", "7.40", "46.90", "7.42")
    dialog = dialog_of(desk, "random")
    assert dialog.low.value() == dialog.high.value() == desk.session.state().agl_m
    dialog.count.setValue(40)
    dialog.low.setValue(80.0)
    dialog.high.setValue(150.0)
    dialog.tilt.setValue(15.0)
    screenshot("pattern-random", dialog)
    found = entered_after(desk, dialog)
    lat, lon, agl = np.array(found.poses).T
    assert len(lat) == 40
    assert ((lat > 46.90) & (lat < 46.91) & (lon > 7.40) & (lon < 7.42)).all()
    assert ((agl >= 80.0) & (agl <= 150.0)).all()
    assert 0.0 <= min(found.tilts_deg) < max(found.tilts_deg) <= 15.0


def test_random_poses_within_the_imagery_see_no_ground_beyond_it(desk, layers, tmp_path):
    path = tmp_path / "ortho.tif"
    # 11 m a pixel of latitude: 1.1 x 1.5 km.
    dataset = gdal.GetDriverByName("GTiff").Create(str(path), 200, 100, 1)
    dataset.SetGeoTransform((7.40, 1e-4, 0.0, 46.91, 0.0, -1e-4))
    dataset.SetProjection(QgsCoordinateReferenceSystem("EPSG:4326").toWkt())
    dataset.FlushCache()
    desk.enter_box("46.91", "7.40", "46.90", "7.42")
    desk.form.set_state(replace(desk.session.state(), source=str(path)))
    dialog = dialog_of(desk, "random")
    dialog.count.setValue(30)
    entered_after(desk, dialog)
    desk.wait_planned()
    assert "reach beyond it" in desk.dock.figures.warnings.text()
    desk.enter_box("46.91", "7.40", "46.90", "7.42")
    dialog = dialog_of(desk, "random")
    dialog.count.setValue(30)
    dialog.inside.setChecked(True)
    found = entered_after(desk, dialog)
    assert len(found.poses) == 30
    camera = state_camera(desk.session.state())
    reach_m = np.hypot(*camera.half_tangents) * np.array(found.poses)[:, 2]
    lat, lon, _ = np.array(found.poses).T
    # The circle around each image, less what its corners leave out of it at the worst turn.
    least_m = np.min(camera.half_tangents) * np.array(found.poses)[:, 2]
    north_m = 111_170.0 * np.minimum(46.91 - lat, lat - 46.90)
    east_m = 111_170.0 * np.cos(np.radians(46.9)) * np.minimum(7.42 - lon, lon - 7.40)
    assert (np.minimum(north_m, east_m) > least_m).all()
    assert (np.minimum(north_m, east_m) < 4.0 * reach_m).any()


def test_what_is_missing_is_said(desk, layers):
    """At once: nothing has been entered yet that would be lost."""
    desk.form.area.area_from.actions_by_name["random"].trigger()
    assert any("o area to draw poses in" in text for text in desk.messages())
    assert not any(one.isVisible() for one in desk.iface.mainWindow().findChildren(QDialog))


def test_layers_of_the_preview_are_none_to_take_points_from(desk):
    """They hold what the map shows, which may be less than the plan."""
    desk.look_at("EPSG:4326", (-89.871, 35.130, -89.855, 35.141))
    desk.enter_small_mission()
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    desk.iface.setActiveLayer(desk.layer("Capture centres"))
    mine = QgsVectorLayer("Point?crs=EPSG:4326", "mine", "memory")
    QgsProject.instance().addMapLayer(mine)
    dialog = dialog_of(desk, "points")
    assert [dialog.layer.itemText(row) for row in range(dialog.layer.count())] == ["mine"]
    assert dialog.chosen() == mine
    dialog.reject()
