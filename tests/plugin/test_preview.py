"""The preview shows what would be captured, follows every change, and touches nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from pyproj import Transformer
from qgis.core import QgsCoordinateReferenceSystem, QgsCoordinateTransform, QgsProject, QgsVectorLayer
from qgis.PyQt.QtCore import QCoreApplication
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.preview.scene import PreviewScene
from terrainav.terrainav_plugin.sources import mission_grid

LAYERS = ["Area", "Capture centres", "Flight line", "Planned images", "Images per place"]


def rectangles(layer):
    """Edges of a layer's features in the order of the layer, (n, 4): west, south, east, north."""
    boxes = [feature.geometry().boundingBox() for feature in layer.getFeatures()]
    return np.array([[b.xMinimum(), b.yMinimum(), b.xMaximum(), b.yMaximum()] for b in boxes])


@pytest.fixture
def previewed(desk):
    # The box fills the map: from afar, more images than a few give way to images per place.
    desk.look_at("EPSG:4326", (-89.871, 35.130, -89.855, 35.141))
    desk.enter_small_mission()
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    return desk


def test_preview_is_one_group_of_layers(previewed):
    assert previewed.layer_names() == LAYERS
    assert previewed.group().name() == "TerrAInav: mission"
    assert previewed.plugin.actions["preview"].isChecked()


def test_previewed_images_have_the_edges_of_the_plan(previewed):
    layer, planned = previewed.layer("Planned images"), previewed.session.planned.plan
    assert layer.crs().authid() == "EPSG:3857"
    assert np.array_equal(rectangles(layer), np.stack(planned.edges, axis=1))
    first = next(layer.getFeatures())
    assert first["name"] == planned.names[0]
    assert (first["column"], first["row"]) == (planned.column[0], planned.row[0])
    assert first["lat"] == planned.lat_deg[0]
    assert first["lon"] == planned.lon_deg[0]
    assert first["agl_m"] == 120.0
    # Metres of ground a pixel at zoom 19 there, from the sphere's formula.
    assert first["gsd_m"] == pytest.approx(0.2986 * np.cos(np.radians(first["lat"])), rel=2e-3)


def test_centres_and_flight_line_follow_the_plan(previewed):
    planned = previewed.session.planned.plan
    centres = list(previewed.layer("Capture centres").getFeatures())
    poses = list(zip(planned.lat_deg.tolist(), planned.lon_deg.tolist()))
    assert [(feature["lat"], feature["lon"]) for feature in centres] == poses
    points = [feature.geometry().asPoint() for feature in centres]
    to_degrees = Transformer.from_crs("EPSG:3857", "EPSG:4326")
    drawn = to_degrees.transform([p.x() for p in points], [p.y() for p in points])
    # A nanodegree is a tenth of a millimetre: the noise of two formulas for the same place.
    assert np.allclose(np.transpose(drawn), poses, rtol=0.0, atol=1e-9)
    flight = next(previewed.layer("Flight line").getFeatures())
    (line,) = flight.geometry().asMultiPolyline()
    assert line == points
    assert flight["length_m"] == planned.direct.distance_m


def test_preview_follows_a_changed_height_in_place(previewed):
    ids = [previewed.layer(name).id() for name in LAYERS]
    before = previewed.layer("Planned images").featureCount()
    previewed.form.agl.setValue(90.0)
    previewed.wait(lambda: previewed.layer("Planned images").featureCount() > before)
    previewed.wait_planned()
    images = previewed.session.planned.summary.images
    previewed.wait(lambda: previewed.layer("Planned images").featureCount() == images)
    assert images > before
    assert [previewed.layer(name).id() for name in LAYERS] == ids
    assert previewed.layer_names() == LAYERS


def test_preview_follows_a_box_drawn_anew(previewed):
    previewed.look_at("EPSG:3857", (-10_010_000, 4_178_000, -9_998_000, 4_187_000))
    previewed.click(previewed.form.draw_box)
    previewed.drag(previewed.at(0.45, 0.45), previewed.at(0.5, 0.5))
    previewed.wait_planned()
    box = previewed.session.planned.mission.area
    area = next(previewed.layer("Area").getFeatures())
    assert [area[name] for name in ("north", "west", "south", "east")] == [
        box.north_deg,
        box.west_deg,
        box.south_deg,
        box.east_deg,
    ]
    west, north = Transformer.from_crs("EPSG:4326", "EPSG:3857", always_xy=True).transform(box.west_deg, box.north_deg)
    drawn = area.geometry().boundingBox()
    assert (drawn.xMinimum(), drawn.yMaximum()) == pytest.approx((west, north), abs=1e-6)


def test_preview_goes_when_it_is_switched_off(previewed):
    previewed.click(previewed.dock.preview)
    assert previewed.group() is None
    assert not QgsProject.instance().mapLayers()
    assert not previewed.plugin.actions["preview"].isChecked()


def test_preview_ends_when_the_user_removes_its_images(previewed):
    QgsProject.instance().removeMapLayer(previewed.layer("Planned images").id())
    previewed.wait(lambda: not previewed.dock.preview.isChecked())
    assert not QgsProject.instance().mapLayers()


def test_layer_the_user_removed_comes_back_with_the_next_change(previewed):
    QgsProject.instance().removeMapLayer(previewed.layer("Flight line").id())
    assert previewed.dock.preview.isChecked()
    previewed.form.agl.setValue(90.0)
    previewed.wait_planned()
    assert previewed.layer_names() == LAYERS


def test_preview_survives_a_new_project(previewed):
    previewed.iface.newProject(False)
    previewed.wait(lambda: not previewed.dock.preview.isChecked())
    previewed.enter_small_mission()
    previewed.click(previewed.dock.preview)
    previewed.wait_previewed()
    assert previewed.layer_names() == LAYERS


def test_points_have_no_layer_of_an_area(previewed):
    previewed.session.areas._editing.set_area(Points(((35.135, -89.865, 90.0),)), "points")
    previewed.wait(lambda: previewed.layer("Planned images").featureCount() == 1)
    assert previewed.layer_names() == LAYERS[1:]
    previewed.form.area.undo.click()
    previewed.wait(lambda: previewed.layer("Planned images").featureCount() > 1)
    assert previewed.layer_names() == LAYERS


def test_another_folder_names_the_group_anew(previewed):
    previewed.form.folder.setFilePath(str(previewed.folder.with_name("other")))
    previewed.wait(lambda: previewed.group() is not None and previewed.group().name() == "TerrAInav: other")
    previewed.wait_previewed()
    assert previewed.layer_names() == LAYERS


def test_preview_without_an_area_says_what_is_missing(desk):
    desk.click(desk.dock.preview)
    assert any("No preview yet" in text for text in desk.messages())
    assert not desk.dock.preview.isChecked()
    assert desk.group() is None


def test_project_of_the_user_is_not_touched(desk, clean_project, wait_until_drawn):
    mine = QgsVectorLayer("Polygon?crs=EPSG:32616", "mine", "memory")
    clean_project.addMapLayer(mine)
    clean_project.setCrs(QgsCoordinateReferenceSystem("EPSG:32616"))
    # The map notices its new CRS and layer first, which is a change to the project as well.
    wait_until_drawn()
    QCoreApplication.processEvents()
    clean_project.setDirty(False)
    desk.enter_small_mission()
    desk.form.agl.setValue(100.0)
    desk.wait_planned()
    # Typing alone changes nothing at all.
    assert not clean_project.isDirty()
    before = clean_project.layerTreeRoot().children()
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    desk.click(desk.dock.preview)
    assert clean_project.crs().authid() == "EPSG:32616"
    assert list(clean_project.mapLayers().values()) == [mine]
    assert clean_project.layerTreeRoot().children() == before


def test_map_moves_to_a_preview_out_of_sight(desk, clean_project):
    clean_project.addMapLayer(QgsVectorLayer("Polygon?crs=EPSG:32616", "mine", "memory"))
    desk.look_at("EPSG:32616", (0, 0, 1000, 1000))
    desk.enter_small_mission()
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    layer = desk.layer("Planned images")
    there = QgsCoordinateTransform(layer.crs(), clean_project.crs(), clean_project)
    desk.wait(lambda: desk.canvas.extent().contains(there.transformBoundingBox(layer.extent())))
    assert clean_project.crs().authid() == "EPSG:32616"


def test_map_stays_where_the_preview_can_be_seen(desk, clean_project, wait_until_drawn):
    clean_project.addMapLayer(QgsVectorLayer("Polygon?crs=EPSG:3857", "mine", "memory"))
    desk.look_at("EPSG:3857", (-10_010_000, 4_178_000, -9_998_000, 4_187_000))
    before = desk.canvas.extent()
    desk.enter_small_mission()
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    wait_until_drawn()
    assert desk.canvas.extent() == before


def test_first_layer_gives_an_empty_project_the_crs_of_web_maps(previewed, clean_project):
    previewed.wait(lambda: clean_project.crs().authid() == "EPSG:3857")


# --- features alone


def features_of(area, **changes):
    mission = Mission(area=area, agl_m=changes.pop("agl_m", 120.0), **changes)
    planned = plan(mission, mission_grid(mission))
    return planned, PreviewScene(planned).draw(None).layers


def test_images_across_the_antimeridian_stay_on_the_map():
    planned, drawn = features_of(Box(0.004, 179.996, -0.004, -179.996))
    half_world = 20_037_508.342789244
    boxes = [feature.geometry().boundingBox() for feature in drawn["footprints"]]
    assert all(-half_world <= b.xMinimum() and b.xMaximum() <= half_world for b in boxes)
    shares = sum(feature.geometry().area() for feature in drawn["footprints"])
    west, south, east, north = planned.edges
    assert shares == pytest.approx(float(((east - west) * (north - south)).sum()), rel=1e-9)
    lines = drawn["flight"][0].geometry().asMultiPolyline()
    assert all(-half_world <= point.x() <= half_world for line in lines for point in line)
    # Each row crosses once.
    assert len(lines) == planned.rows + 1
    assert drawn["area"][0].geometry().asGeometryCollection()[0].boundingBox().xMaximum() == half_world


def test_polygon_is_drawn_with_its_holes_and_on_either_side_of_the_antimeridian():
    outer = ((179.98, 0.0), (180.02, 0.0), (180.02, 0.02), (179.98, 0.02))
    hole = ((179.99, 0.005), (180.01, 0.005), (180.0, 0.015))
    _, drawn = features_of(Polygon((outer, hole)), agl_m=500.0)
    (area,) = drawn["area"]
    assert area.geometry().isGeosValid()
    # Near the equator degrees are the same everywhere.
    metres = 20_037_508.342789244 / 180.0
    assert area.geometry().area() == pytest.approx((0.04 * 0.02 - 0.02 * 0.01 / 2) * metres**2, rel=1e-5)
    assert abs(area.geometry().boundingBox().xMinimum()) <= 20_037_508.342789244


def test_points_have_no_area():
    planned, drawn = features_of(Points(((10.0, 20.0, 100.0), (10.01, 20.0, 200.0))))
    assert drawn["area"] == []
    assert len(drawn["footprints"]) == len(drawn["centres"]) == len(planned) == 2
