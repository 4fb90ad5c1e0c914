"""Labels of pictures of buildings on relief, and labels from files."""

from __future__ import annotations

import csv
import json
import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest
import shapely
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.labels import write_label_tables
from terrainav.core.capture.runner import capture
from terrainav.core.cli import main
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.triangles import RELIEF, ROOF, WALL
from terrainav.core.imagery.opening import named_source
from terrainav.core.labels.classes import LayerValues, class_table
from terrainav.core.labels.label_map import LabelLayer
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.parts import Terrain
from terrainav.core.mission.plan import plan
from terrainav.core.picture import labels as opening
from terrainav.core.picture.heights import absolute_terrain
from terrainav.core.picture.products import _near_level_ground, products, sighting

from tests.core.geodesy.boxes import LAT, LON, METRE_LAT, METRE_LON, Boxes
from tests.core.picture.test_faces import GROUND_M, files, planned, size_of  # noqa: F401
from tests.support.labels import ShapelyLayer


def rectangle(west_m, south_m, east_m, north_m):
    west, east = (LON + at * METRE_LON for at in (west_m, east_m))
    return shapely.box(west, LAT + south_m * METRE_LAT, east, LAT + north_m * METRE_LAT)


@pytest.fixture
def houses():
    """Two houses: the field of the layer lies on the western half of the first, and on ground around it."""
    tops = [(-10.0, 20.0, 20.0, 15.0, GROUND_M, GROUND_M + 20.0), (18.0, 25.0, 8.0, 10.0, GROUND_M, GROUND_M + 9.0)]
    return Boxes(tops)


#: An ideal lens, and two that distort.
LENSES = {
    "ideal": Camera(78.8, 4.0 / 3.0),
    "barrel": Camera(60.0, 4.0 / 3.0, k1=-0.3),
    "fisheye": Camera(150.0, 4.0 / 3.0, lens="fisheye"),
}
FIELDS = [rectangle(-200.0, 60.0, 200.0, 300.0), rectangle(-40.0, -40.0, 0.0, 50.0)]


def labels_of(made, monkeypatch, layer):
    monkeypatch.setattr(opening, "_layer", lambda text: LabelLayer(layer, "fields"))
    monkeypatch.setattr(opening, "_state", lambda text: None)
    opening._opened.cache_clear()
    return opening.plan_labels(made)


@pytest.mark.parametrize("camera", LENSES.values(), ids=LENSES)
def test_walls_and_roofs_are_labelled_with_their_building(files, houses, monkeypatch, tmp_path, camera):  # noqa: F811
    made, _ = planned(files, houses, labels=("fields.gpkg",), agl=110.0, camera=camera)
    labels = labels_of(made, monkeypatch, ShapelyLayer(FIELDS))
    found = dict(products(made, 0, size_of(made), None, labels))
    seen = sighting(made, 0, size_of(made))
    points = shapely.points(seen.lon_deg, seen.lat_deg)
    field = np.where(shapely.contains_properly(FIELDS[0], points), 1, 0)
    field[shapely.contains_properly(FIELDS[1], points)] = 2
    # Places are rounded to 1/8192 of a pixel; leave out those as close as that to an edge.
    with np.errstate(invalid="ignore"):
        clear = np.min([shapely.distance(one.boundary, points) for one in FIELDS], axis=0) > 1e-9
    # The fisheye sees the sky, too.
    clear &= np.isfinite(seen.depth_m)
    assert clear.mean() > 0.5
    ids = {one.name: one.id for one in labels.classes.classes}
    wanted = np.where(field > 0, ids["fields"], 0)
    numbers = field.copy()
    walls, roofs = seen.kind == WALL, (seen.kind == ROOF) & (field == 0)
    wanted[walls], wanted[roofs] = ids["wall"], ids["roof"]
    built = walls | roofs
    numbers[built] = len(FIELDS) + seen.instance[built]
    np.testing.assert_array_equal(found["classes"][clear], wanted[clear])
    np.testing.assert_array_equal(found["instances"][clear], numbers[clear])
    assert set(np.unique(numbers[built])) == {3, 4}
    assert ((seen.kind == ROOF) & (found["classes"] == ids["fields"])).any()
    assert ((seen.kind == RELIEF) & (found["classes"] == ids["fields"])).any()
    write_label_tables(labels, tmp_path, "png")
    rows = list(csv.reader((tmp_path / "instances.csv").read_text().splitlines()))
    assert rows[-2:] == [["3", str(ids["wall"]), "buildings", "1"], ["4", str(ids["wall"]), "buildings", "2"]]
    assert json.loads((tmp_path / "classes.json").read_text())["files"]["instances"] == {"format": "png", "bits": 16}


@pytest.mark.parametrize(("count", "bits"), [(65_533, 16), (65_534, 32)])
def test_instances_of_buildings_take_32_bits_only_beyond_16(files, houses, monkeypatch, count, bits):  # noqa: F811
    houses.count = count
    made, _ = planned(files, houses, labels=("fields.gpkg",))
    labels = labels_of(made, monkeypatch, ShapelyLayer(FIELDS))
    assert labels.instance_dtype.itemsize * 8 == bits
    assert dict(products(made, 0, size_of(made), None, labels))["instances"].dtype == labels.instance_dtype
    assert sum(1 for _ in labels.instance_rows()) == len(FIELDS) + count


def written(path, fields, crs="urn:ogc:def:crs:OGC:1.3:CRS84"):
    """Write a GeoJSON of polygons with values of the field crop."""
    features = [
        {"type": "Feature", "properties": {"crop": crop}, "geometry": shapely.geometry.mapping(shape)}
        for shape, crop in fields
    ]
    named = {"crs": {"type": "name", "properties": {"name": crs}}}
    path.write_text(json.dumps({"type": "FeatureCollection", **named, "features": features}))
    return path


CROPS = list(zip([rectangle(-60, -60, 0, 60), rectangle(0, -60, 60, 60)], ["rye", "oats"]))


def mission_of(labels, **values):
    places = Points(tuple((LAT + at * METRE_LAT * 10.0, LON, 60.0) for at in range(3)))
    return Mission(places, 60.0, labels=labels, camera=Camera(60.0, 1.5), zoom=18, image_format="png", **values)


def captured(mission, folder, **options):
    source = named_source("world")
    opened = source.open()
    made = plan(mission, opened.grid)
    capture(made, source if options else opened, folder, **options)
    opened.close()
    return made


def test_workers_read_layers_named_from_the_users_folder(tmp_path, monkeypatch):
    written(tmp_path / "fields.geojson", CROPS)
    monkeypatch.chdir(tmp_path)
    mission = mission_of(("fields.geojson:crop",))
    made = captured(mission, tmp_path / "one")
    (tmp_path / "elsewhere").mkdir()

    with ProcessPoolExecutor(1, get_context("spawn"), os.chdir, (str(tmp_path / "elsewhere"),)) as executor:
        captured(mission, tmp_path / "blocks", executor=executor, blocks=Blocks(2))
    for product in ("classes", "instances"):
        for name in made.names:
            one, other = (tmp_path / folder / product / f"{name}.png" for folder in ("one", "blocks"))
            assert one.read_bytes() == other.read_bytes()


def test_workers_read_buildings_named_from_the_users_folder(tmp_path, monkeypatch):
    written(tmp_path / "houses.geojson", CROPS)
    monkeypatch.chdir(tmp_path)
    terrain = Terrain(elevation=("100",), buildings=("houses.geojson",))
    assert absolute_terrain(terrain).buildings == (str(tmp_path / "houses.geojson"),)


def test_a_side_file_gives_values_ids_names_and_colours(tmp_path):
    path = written(tmp_path / "fields.geojson", CROPS)
    side = {"classes": [{"value": "rye", "id": 7, "name": "Winter rye", "color": "#123456"}]}
    (tmp_path / "fields.classes.json").write_text(json.dumps(side))
    captured(mission_of((f"{path}:crop",)), tmp_path / "out")
    table = json.loads((tmp_path / "out" / "classes.json").read_text())
    assert [(one["id"], one["name"]) for one in table["classes"]] == [(1, "oats"), (7, "Winter rye")]
    assert table["classes"][1]["color"] == "#123456"


@pytest.mark.parametrize("command", ["plan", "capture"])
def test_the_commands_state_what_of_labels_was_repaired_left_out_or_has_no_value(
    tmp_path, monkeypatch, capsys, command
):
    monkeypatch.setenv("TERRAINAV_CACHE", str(tmp_path / "cache"))
    rings = [
        [[-89.901, 35.150], [-89.891, 35.160], [-89.891, 35.150], [-89.901, 35.160], [-89.901, 35.150]],
        [[-89.901, 35.150], [-89.891, 35.150], [-89.901, 35.150]],
        [[-89.911, 35.150], [-89.901, 35.150], [-89.901, 35.160], [-89.911, 35.150]],
    ]
    features = [
        {"type": "Feature", "properties": {"crop": crop}, "geometry": {"type": "Polygon", "coordinates": [ring]}}
        for crop, ring in zip(("oats", "rye", None), rings)
    ]
    path = tmp_path / "fields.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    where = ["--coords", "35.155_-89.896_100", "--source", "world", "--image-px", "64"]
    into = ["--data-dir", str(tmp_path / "out")] if command == "capture" else []
    assert main([command, *where, "--labels", f"{path}:crop", *into]) == 0
    said = capsys.readouterr().err.splitlines()
    assert "labels fields: features repaired, as they cross themselves: 1" in said
    assert "labels fields: features left out, as they are empty or have no area or length: 1" in said
    assert "labels: features without a value, whose pixels are ignore: 1" in said


@pytest.mark.parametrize("command", ["plan", "capture"])
def test_the_commands_state_what_of_buildings_cannot_be_read(tmp_path, monkeypatch, capsys, command):
    monkeypatch.setenv("TERRAINAV_CACHE", str(tmp_path / "cache"))
    features = [
        {"type": "Feature", "properties": values, "geometry": {"type": "Polygon", "coordinates": [ring]}}
        for west, values in (
            (-89.8962, {"height": "abc"}),
            (-89.8960, {"height": "9 m", "roof:shape": "9.0"}),
            (-89.8958, {"height": 1e9}),
        )
        for ring in [[[west, 35.155], [west + 1e-4, 35.155], [west + 1e-4, 35.1551], [west, 35.155]]]
    ]
    path = tmp_path / "houses.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    where = ["--coords", "35.155_-89.896_100", "--source", "world", "--image-px", "64", "--elevation", "60"]
    into = ["--data-dir", str(tmp_path / "out")] if command == "capture" else []
    assert main([command, *where, "--buildings", str(path), *into]) == 0
    said = capsys.readouterr().err.splitlines()
    assert "buildings houses: buildings without height, 6 m instead: 2" in said
    assert "buildings houses: buildings with unknown shapes of roofs: 1" in said
    assert "buildings houses: values of height that cannot be read, such as 'abc': 2" in said


def test_values_that_a_side_file_does_not_name_have_ids_of_their_own():
    counts = dict.fromkeys(("barley", "oats", "rye", "wheat"), 1)
    named = {"barley": {"id": 3, "name": "Spring barley"}, "rye": {"id": 5}}
    table = class_table([LayerValues("fields", "crop", counts, named)])
    assert dict(table.values[0]) == {"barley": 3, "oats": 2, "rye": 5, "wheat": 4}
    # The third's own number is the first's.
    table = class_table([LayerValues("fields", "crop", counts, {"barley": {"id": 3, "name": "Spring barley"}})])
    assert dict(table.values[0]) == {"barley": 3, "oats": 2, "rye": 5, "wheat": 4}
    assert [one.name for one in table.classes] == ["oats", "Spring barley", "wheat", "rye"]
    # Whole numbers are ids themselves: a side file may join them.
    table = class_table([LayerValues("fields", "crop", {1: 1, 2: 1}, {"1": {"id": 2}})])
    assert dict(table.values[0]) == {1: 2, 2: 2}


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ('{"classes": [{"value": "rye", "id": -1}]}', "id -1: must be a whole number from 0 to 65534"),
        ('{"classes": [{"value": "rye", "color": "red"}]}', "color 'red': must be #rrggbb"),
        ("[]", "it must hold a list named classes"),
    ],
)
def test_side_files_that_cannot_be_read_are_refused(tmp_path, text, why):
    path = written(tmp_path / "fields.geojson", CROPS)
    (tmp_path / "fields.classes.json").write_text(text)
    with pytest.raises(InvalidInput) as refused:
        captured(mission_of((f"{path}:crop",)), tmp_path / "out")
    assert str(refused.value) == f"table of classes {tmp_path / 'fields.classes.json'}: {why}"
    assert refused.value.field == "labels"


def test_a_layer_without_reference_system_is_refused(tmp_path):
    ogr = pytest.importorskip("osgeo.ogr")
    made = ogr.GetDriverByName("GPKG").CreateDataSource(str(tmp_path / "fields.gpkg"))
    layer = made.CreateLayer("fields", None, ogr.wkbPolygon)
    feature = ogr.Feature(layer.GetLayerDefn())
    feature.SetGeometry(ogr.CreateGeometryFromWkt(CROPS[0][0].wkt))
    layer.CreateFeature(feature)
    del feature, layer, made
    with pytest.raises(InvalidInput) as refused:
        captured(mission_of((str(tmp_path / "fields.gpkg"),)), tmp_path / "out")
    assert "layer fields of fields.gpkg: has no reference system (CRS)" in str(refused.value)
    assert "\n" not in str(refused.value)
    assert refused.value.field == "labels"
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("lat_deg", [0.0, -33.0, 71.0])
@pytest.mark.parametrize("agl_m", [80.0, 20_000.0])
@pytest.mark.parametrize("tilt_deg", [0.0, 30.0, 55.0, 70.0])
def test_level_ground_of_labels_is_within_a_thousandth_of_a_pixel(lat_deg, agl_m, tilt_deg):
    camera = Camera(60.0, 4.0 / 3.0)
    mission = Mission(Points(((lat_deg, 11.0, agl_m),)), agl_m, camera, tilt_deg=tilt_deg, yaw_deg=25.0, frame="camera")
    made = plan(mission, named_source("world").grid)
    lat, dlon = _near_level_ground(made, 0, (320, 240))
    exact = sighting(made, 0, (320, 240))
    assert np.array_equal(np.isnan(lat), np.isnan(exact.lat_deg))
    metre = 180.0 / np.pi / 6_371_000.0
    off = np.hypot(lat - exact.lat_deg, (dlon + made.lon_deg[0] - exact.lon_deg) * np.cos(np.radians(lat_deg)))
    assert np.nanmax(off) < 1e-3 * metre * camera.gsd_m_per_px(agl_m, 320)
