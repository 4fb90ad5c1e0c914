"""Camera frames in the real application: previewed, captured, and laid on the map."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from osgeo import gdal
from qgis.core import QgsExpression, QgsGeometry, QgsPointXY, QgsRasterLayer, QgsRectangle
from terrainav.core.capture.runner import capture as run_capture
from terrainav.core.geodesy.footprint import exact
from terrainav.core.geodesy.mercator import HALF_WORLD_M
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.layout.framing import ground_ellipsoid
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.dataset.rectify import lay_on_map
from terrainav.terrainav_plugin.map.outlines import metres
from terrainav.terrainav_plugin.preview.layers import field_names
from terrainav.terrainav_plugin.preview.scene import PreviewScene
from terrainav.terrainav_plugin.sources import mission_grid

from tests.plugin.test_capture import capture
from tests.support.thinning import sampled

SMALL = Box(35.14, -89.87, 35.131, -89.856)


def features_of(area, agl_m, **changes):
    there = Mission(area=area, agl_m=agl_m, **changes)
    planned = plan(there, mission_grid(there))
    drawn = PreviewScene(planned).draw(None).layers["footprints"]
    names = field_names("footprints")
    return planned, [(f.geometry(), dict(zip(names, f.attributes()))) for f in drawn]


def one(lat, lon, agl_m, **changes):
    return features_of(Points(((lat, lon, agl_m),)), agl_m, **changes)


def seen_points(planned, index=0, count=21, margin=0.99):
    """Ground that the exact camera sees at points spread over its image, in EPSG:3857; and those points, -1..1."""
    x, y = (v.ravel() for v in np.meshgrid(*[np.linspace(-margin, margin, count)] * 2))
    pose = planned.poses.take(np.array([index]))
    image = tuple(zip(x.tolist(), y.tolist()))
    ground = exact(planned.mission.camera, pose, image, ground_ellipsoid(planned.mission))
    hit = ground.hit[0]
    east, north = metres(ground.lon_deg[0][hit], ground.lat_deg[0][hit])
    return np.stack([east, north], axis=1), np.stack([x, y], axis=1)[hit]


def contains(geometry, points):
    return [geometry.contains(QgsGeometry.fromPointXY(QgsPointXY(*point))) for point in points]


# --- outlines


def test_outline_is_the_ground_that_the_camera_sees():
    planned, drawn = features_of(SMALL, 120.0, tilt_deg=60.0, yaw_deg=30.0)
    assert len(drawn) == len(planned)
    for index in (0, len(planned) - 1):
        geometry, values = drawn[index]
        assert geometry.isGeosValid()
        assert all(contains(geometry, seen_points(planned, index)[0]))
        outside, image = seen_points(planned, index, margin=1.02)
        border = np.abs(image).max(axis=1) > 1.0
        assert not any(contains(geometry, outside[border]))
        assert (values["yaw"], values["tilt"], values["roll"]) == (30.0, 60.0, 0.0)
        assert values["horizon"] is False
        assert values["name"] == planned.names[index]


@pytest.mark.parametrize(
    ("place", "changes"),
    [
        ((35.13, -89.86, 120.0), {"tilt_deg": 85.0, "yaw_deg": 200.0}),
        ((35.13, -89.86, 120.0), {"tilt_deg": 89.0, "roll_deg": 30.0}),
        ((0.0, 0.0, 36e6), {}),
        ((10.0, 175.0, 8e6), {}),
        ((-20.0, -179.99, 4e5), {"tilt_deg": 70.0, "yaw_deg": 270.0}),
        ((60.0, 170.0, 8e6), {}),
        ((-70.0, 10.0, 8e6), {"tilt_deg": 10.0, "roll_deg": -15.0}),
        ((84.0, 0.0, 1e6), {}),
    ],
)
def test_horizon_and_poles_give_valid_polygons_on_the_map(place, changes):
    planned, ((geometry, values),) = one(*place, **changes)
    assert not geometry.isEmpty()
    assert geometry.isGeosValid()
    assert values["horizon"] is (not planned.corners.hit.all())
    box = geometry.boundingBox()
    assert -HALF_WORLD_M <= box.xMinimum() < box.xMaximum() <= HALF_WORLD_M
    assert -HALF_WORLD_M * (1 + 1e-9) <= box.yMinimum() < box.yMaximum() <= HALF_WORLD_M * (1 + 1e-9)
    # What is seen well inside the picture and lies on the map is inside the outline, wherever the map is cut.
    points, _ = seen_points(planned, margin=0.97)
    points[:, 0] -= 2.0 * HALF_WORLD_M * np.floor((points[:, 0] + HALF_WORLD_M) / (2.0 * HALF_WORLD_M))
    points = points[(np.abs(points) < 0.9999 * HALF_WORLD_M).all(axis=1)]
    assert len(points) > 20
    # Arcs of the horizon are drawn in pieces, which leave out slivers.
    assert np.mean(contains(geometry, points)) > 0.98


def test_row_shares_an_outline_and_each_is_in_its_place():
    planned, drawn = features_of(Box(0.5, 178.0, -0.5, -178.0), 16_000.0, tilt_deg=20.0)
    assert len(planned) > 5
    for index, (geometry, _) in enumerate(drawn):
        assert geometry.isGeosValid()
        points, _ = seen_points(planned, index, count=7)
        points[:, 0] -= 2.0 * HALF_WORLD_M * np.floor((points[:, 0] + HALF_WORLD_M) / (2.0 * HALF_WORLD_M))
        assert all(contains(geometry, points))


def test_bent_edges_are_drawn_bent():
    """At 500 km a straight edge between two corners misses the ground by kilometres."""
    planned, ((geometry, _),) = one(50.0, 10.0, 5e5)
    assert planned.corners.hit.all()
    edge = tuple((share, 1.0) for share in np.linspace(-0.9, 0.9, 7).tolist())
    ground = exact(planned.mission.camera, planned.poses, edge)
    east, north = metres(ground.lon_deg[0], ground.lat_deg[0])
    border = QgsGeometry(geometry.constGet().boundary())
    gaps = [border.distance(QgsGeometry.fromPointXY(QgsPointXY(*at))) for at in zip(east, north)]
    assert max(gaps) < 2000.0
    straight = QgsGeometry.fromPolylineXY(
        [
            QgsPointXY(*at)
            for at in zip(*(v[:2] for v in metres(planned.corners.lon_deg[0], planned.corners.lat_deg[0])))
        ]
    )
    assert straight.distance(QgsGeometry.fromPointXY(QgsPointXY(east[3], north[3]))) > 10.0 * max(gaps)


def test_wind_gives_every_capture_an_outline_of_its_own():
    planned, drawn = features_of(SMALL, 120.0, wind=Wind(5.0, 270.0, 0.2))
    assert len({values["tilt"] for _, values in drawn}) == len(planned)
    assert all(all(contains(g, seen_points(planned, i, count=5)[0])) for i, (g, _) in enumerate(drawn))


# --- captures


@pytest.fixture
def tilted(desk):
    desk.enter_small_mission()
    # Small images: what is laid on the map has 16 times fewer pixels.
    state = replace(desk.session.state(), tilt_deg=60.0, yaw_deg=30.0, agl=300.0, image_px=160)
    desk.form.set_state(state)
    desk.wait_planned()
    return desk


def test_tilted_mission_from_preview_to_mosaic(tilted, screenshot):
    planned = tilted.session.planned.plan
    assert planned.frames.largest_px == (160, 120)
    tilted.click(tilted.dock.preview)
    tilted.wait_previewed()
    features = list(tilted.layer("Planned images").getFeatures())
    assert [feature["name"] for feature in features] == planned.names
    assert {(feature["yaw"], feature["tilt"], feature["horizon"]) for feature in features} == {(30.0, 60.0, False)}
    capture(tilted)

    # Footprints, and a mosaic that is orthorectified.
    assert tilted.layer_names() == [
        "Area",
        "Capture centres",
        "Flight line",
        "Planned images",
        "Images per place",
        "Captured images",
        "Satellite images",
    ]
    assert not list(tilted.folder.glob("*.vrt"))
    mosaic = tilted.layer("Satellite images")
    assert mosaic.isValid()
    assert mosaic.crs().authid() == "EPSG:3857"
    assert mosaic.bandCount() == 4
    raster = gdal.Open(str(tilted.folder / "satellite.tif"))
    assert raster.GetRasterBand(1).GetOverviewCount() > 0
    # No farther than the footprints: ground that is seen too flat is left out.
    box = tilted.layer("Captured images").extent()
    x, y = metres(*np.array([[box.xMinimum(), box.xMaximum()], [box.yMinimum(), box.yMaximum()]]))
    footprints = QgsRectangle(x[0], y[0], x[1], y[1])
    assert footprints.buffered(0.05 * footprints.width()).contains(mosaic.extent())
    assert mosaic.extent().area() > 0.1 * footprints.area()
    shown = mosaic.extent()
    tilted.look_at("EPSG:3857", (shown.xMinimum(), shown.yMinimum(), shown.xMaximum(), shown.yMaximum()))
    screenshot("mosaic-tilted")
    layer = tilted.layer("Captured images")
    assert layer.featureCount() == len(planned)
    for feature in layer.getFeatures():
        picture = Path(feature["satellite_file"])
        assert picture.parent == tilted.folder / "satellite"
        assert gdal.Open(str(picture)).GetGCPCount() > 0
    assert "satellite_file" in layer.mapTipTemplate()
    (action,) = layer.actions().actions()
    context = layer.createExpressionContext()
    context.setFeature(feature)
    assert QgsExpression.replaceExpressionText(action.command(), context) == str(picture)


@pytest.mark.thorough
def test_map_tip_shows_pictures_that_can_be_shown(tilted):
    tilted.choose(tilted.form.image_format, "jpg")
    tilted.wait_planned()
    capture(tilted)
    assert "<img src=" in tilted.layer("Captured images").mapTipTemplate()


@pytest.mark.thorough
def test_second_capture_of_what_is_there_keeps_the_layer(tilted):
    capture(tilted)
    layer = tilted.layer("Captured images").id()
    capture(tilted)
    assert any("already exist" in text for text in tilted.messages())
    assert tilted.layer("Captured images").id() == layer


def test_wind_mission_is_captured_with_its_poses(desk):
    desk.enter_small_mission()
    desk.form.set_state(replace(desk.session.state(), agl=300.0, image_px=160))
    desk.form.wind.setChecked(True)
    planned = desk.wait_planned().plan
    capture(desk)
    layer = desk.layer("Captured images")
    tilts = {feature["name"]: feature["tilt_deg"] for feature in layer.getFeatures()}
    assert tilts == dict(zip(planned.names, planned.poses.tilt_deg.tolist()))
    assert Mission.load(desk.folder / "mission.json") == planned.mission


@pytest.mark.thorough
def test_test_shot_of_a_tilted_camera_lies_where_it_looks(tilted):
    tilted.look_at("EPSG:3857", (-10_010_000, 4_178_000, -9_998_000, 4_187_000))
    tilted.click(tilted.dock.test_shot)
    tilted.click_map(tilted.at(0.4, 0.6))
    tilted.wait(lambda: tilted.group() is not None)
    tilted.wait_for_run()
    (node,) = tilted.group().findLayers()
    layer = node.layer()
    assert isinstance(layer, QgsRasterLayer)
    assert layer.crs().authid() == "EPSG:3857"
    lat, lon = map(float, node.name().split()[2:])
    _, ((outline, _),) = one(lat, lon, 300.0, tilt_deg=60.0, yaw_deg=30.0)
    # The name has five decimals: a metre.
    assert outline.boundingBox().buffered(3.0).contains(layer.extent())
    assert layer.extent().area() == pytest.approx(outline.boundingBox().area(), rel=0.01)


def test_test_shot_of_a_camera_turned_by_a_quarter_lies_on_its_ground(desk, screenshot):
    """QGIS draws the turned file so that its ground lies where the north-up image of the same place has it."""
    shots = []
    for number, yaw_deg in enumerate((0.0, 90.0)):
        desk.enter_coarse_mission()
        desk.form.set_state(replace(desk.session.state(), yaw_deg=yaw_deg, aspect="1:1"))
        desk.wait_planned()
        desk.look_at("EPSG:3857", (-10_010_000, 4_178_000, -9_998_000, 4_187_000))
        desk.click(desk.dock.test_shot)
        desk.click_map(desk.at(0.4, 0.6))
        desk.wait(lambda count=number: desk.group() is not None and len(desk.group().findLayers()) > count)
        desk.wait_for_run()
        shots = [node.layer() for node in desk.group().findLayers()]
    screenshot("test-shot-turned")
    turned, upright = shots
    assert turned.extent().center().distance(upright.extent().center()) < 0.01 * upright.extent().width()
    assert turned.extent().width() == pytest.approx(upright.extent().width(), rel=0.02)
    box = upright.extent().buffered(-0.05 * upright.extent().width())
    drawn = []
    for layer in shots:
        block = layer.dataProvider().block(1, box, 60, 60)
        drawn.append(np.array([[block.value(row, column) for column in range(60)] for row in range(60)]))
    assert drawn[0].std() > 10.0
    assert np.corrcoef(drawn[0].ravel(), drawn[1].ravel())[0, 1] > 0.9


@pytest.mark.parametrize(
    ("place", "changes"),
    sampled(
        [
            ((35.13, -89.86, 300.0), {"tilt_deg": 60.0, "yaw_deg": 30.0}),
            ((35.13, -89.86, 300.0), {"tilt_deg": 85.0, "roll_deg": 10.0}),
            ((10.0, 179.999, 500.0), {"tilt_deg": 40.0, "yaw_deg": 90.0, "ground_height_m": 800.0}),
            ((60.0, 170.0, 8e6), {}),
        ],
        2,
    ),
)
def test_picture_on_the_map_is_the_picture_of_the_camera(tmp_path, place, changes):
    """Ground that the exact camera sees at a pixel has that pixel's colour on the map."""
    there = Mission(area=Points((place,)), agl_m=place[2], image_px=320, **changes)
    source = open_source("world", seed=there.imagery.seed)
    planned = plan(there, source.grid)
    run_capture(planned, source, tmp_path / "shot")
    picture = tmp_path / "shot" / "satellite" / f"{planned.names[0]}.tif"
    target = tmp_path / "map.tif"
    lay_on_map(planned, picture, target)
    assert not list(tmp_path.glob("*.part"))

    on_map = gdal.Open(str(target))
    west, step, _, north, _, _ = on_map.GetGeoTransform()
    pixels = on_map.ReadAsArray().astype(float)
    image = gdal.Open(str(picture)).ReadAsArray().astype(float)
    points, at = seen_points(planned, count=61, margin=0.9)
    column, row = ((points - [west, north]) / [step, -step]).T
    inside = (column >= 1) & (row >= 1) & (column < pixels.shape[2] - 1) & (row < pixels.shape[1] - 1)
    assert inside.sum() > 200
    column, row = (np.floor(values[inside]).astype(int) for values in (column, row))
    assert (pixels[3, row, column] == 255).mean() > 0.99
    # The picture's value at the very point; the map's pixel is centred up to half its width away.
    x = np.floor((at[inside, 0] + 1.0) / 2.0 * image.shape[2]).astype(int)
    y = np.floor((1.0 - at[inside, 1]) / 2.0 * image.shape[1]).astype(int)
    off = np.abs(pixels[:3, row, column] - image[:3, y, x]).mean()
    spread = np.abs(pixels[:3, row, column] - image[:3, y[::-1], x[::-1]]).mean()
    assert off < 0.35 * spread
