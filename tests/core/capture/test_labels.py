"""Classes and instances beside images: where they lie, what files they are in, and that they can be resumed."""

from __future__ import annotations

import csv
import json
import tarfile
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
import shapely
from osgeo import gdal
from PIL import Image
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.runner import capture
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.geodesy.camera import Camera
from terrainav.core.imagery.opening import named_source
from terrainav.core.labels.label_map import LabelLayer
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture import labels as opening
from terrainav.core.picture.products import sighting

from tests.support.labels import ShapelyLayer
from tests.support.sources import PatternSource

gdal.UseExceptions()
LAT, LON = 35.158, -89.897
PLACES = Points(tuple((LAT + 0.0003 * at, LON, 100.0) for at in range(3)))


def fields():
    """Squares of 0.0002 degrees in a grid with gaps, and a hole in each."""
    found = []
    for row in range(-12, 18):
        for column in range(-16, 16):
            west, south = LON + column * 0.00025, LAT + row * 0.00025
            box = shapely.box(west, south, west + 0.0002, south + 0.0002)
            found.append(box.difference(shapely.box(west + 8e-5, south + 8e-5, west + 0.00012, south + 0.00012)))
    return found


@pytest.fixture(autouse=True)
def layers(monkeypatch):
    """Vector files by name."""
    shapes = fields()
    known = {
        "fields.gpkg": ShapelyLayer(shapes, crop=[("oats", "rye", None)[at % 3] for at in range(len(shapes))]),
        "many.gpkg": ShapelyLayer(shapes * 80),
        "wide.gpkg": ShapelyLayer(shapes, number=[at % 300 for at in range(len(shapes))]),
    }

    def opened(text):
        path, _, field = text.partition(":")
        return LabelLayer(known[Path(path).name], Path(path).stem, field)

    monkeypatch.setattr(opening, "_layer", opened)
    monkeypatch.setattr(opening, "_state", lambda text: None)
    monkeypatch.setattr(opening, "whole_layer_path", lambda text: text)
    opening._opened.cache_clear()
    return known


def captured(folder, labels=("fields.gpkg:crop",), *, source=None, **values):
    source = source or PatternSource()
    mission = Mission(PLACES, 100.0, labels=labels, zoom=18, **{"camera": Camera(60.0, 1.5), **values})
    made = plan(mission, source.grid)
    capture(made, source, folder, resume=(folder / "mission.json").exists())
    return made


def tif(path):
    data = gdal.Open(str(path))
    return data, data.ReadAsArray()


def wanted_at(lat, lon, geometries):
    """Number of the geometry at each place, by shapely; 0 for none."""
    points = shapely.points(np.where(np.isnan(lat), 0.0, lon), np.where(np.isnan(lat), 0.0, lat))
    numbers = np.zeros(lat.shape, int)
    for number, one in enumerate(geometries, 1):
        shapely.prepare(one)
        numbers[shapely.contains_properly(one, points)] = number
    return numbers


@pytest.mark.parametrize(
    ("values", "on_map"),
    [
        ({}, True),
        ({"img_size": (96, 64, 3)}, True),
        ({"tilt_deg": 40.0, "yaw_deg": 25.0, "image_px": 160}, False),
        ({"tilt_deg": 40.0, "yaw_deg": 25.0, "image_px": 160, "img_size": (90, 60, 3)}, False),
        ({"tilt_deg": 80.0, "yaw_deg": 10.0, "image_px": 120}, False),
    ],
)
def test_pixels_have_the_labels_of_their_ground(tmp_path, layers, values, on_map):
    made = captured(tmp_path / "out", **values)
    assert made.frames.on_map == on_map
    for index, name in enumerate(made.names):
        _, instances = tif(tmp_path / "out" / "instances" / f"{name}.tif")
        data, classes = tif(tmp_path / "out" / "classes" / f"{name}.tif")
        seen = sighting(made, index, classes.shape[::-1])
        # Rounded to 1/8192 of a pixel, so that places as close as that to an edge may differ.
        numbers = wanted_at(seen.lat_deg, seen.lon_deg, layers["fields.gpkg"].geometries)
        same = instances == numbers
        assert same.mean() > 0.999
        assert numbers.any()
        crop = np.array([0, *((np.arange(len(fields())) % 3) + 1)])[instances]
        wanted = np.where(crop == 3, 255, crop)
        np.testing.assert_array_equal(classes, np.where(np.isnan(seen.depth_m), 255, wanted))
        table = data.GetRasterBand(1).GetColorTable()
        assert table.GetColorEntry(1)[:3] == (0xE6, 0x9F, 0x00)
        image = gdal.Open(str(tmp_path / "out" / "satellite" / f"{name}.tif"))
        assert data.GetGeoTransform() == image.GetGeoTransform()
        assert (data.RasterXSize, data.RasterYSize) == (image.RasterXSize, image.RasterYSize)


def test_turned_map_frames_turn_their_labels(tmp_path, layers):
    made = captured(tmp_path / "out", yaw_deg=90.0)
    assert made.frames.on_map
    assert set(made.frames.quarter_turns.tolist()) == {1}
    for index, name in enumerate(made.names):
        _, instances = tif(tmp_path / "out" / "instances" / f"{name}.tif")
        seen = sighting(made, index, instances.shape[::-1])
        numbers = wanted_at(seen.lat_deg, seen.lon_deg, layers["fields.gpkg"].geometries)
        assert (instances == numbers).mean() > 0.999


def test_tables_name_classes_and_instances(tmp_path):
    captured(tmp_path / "out")
    table = json.loads((tmp_path / "out" / "classes.json").read_text())
    assert [(one["id"], one["name"]) for one in table["classes"]] == [(1, "oats"), (2, "rye")]
    assert (table["background"], table["ignore"]) == (0, 255)
    assert table["files"] == {"classes": {"format": "tif", "bits": 8}, "instances": {"format": "tif", "bits": 16}}
    rows = list(csv.reader((tmp_path / "out" / "instances.csv").read_text().splitlines()))
    assert rows[0] == ["id", "class", "layer", "feature"]
    assert rows[1:4] == [["1", "1", "fields", "1"], ["2", "2", "fields", "2"], ["3", "255", "fields", "3"]]
    assert len(rows) == len(fields()) + 1


@pytest.mark.parametrize("image_format", ["png", "jpg"])
def test_png_files_have_a_palette_and_sidecars(tmp_path, image_format):
    made = captured(tmp_path / "tif")
    captured(tmp_path / "out", image_format=image_format)
    for name in made.names:
        for product in ("classes", "instances"):
            path = tmp_path / "out" / product / f"{name}.png"
            wanted, pixels = tif(tmp_path / "tif" / product / f"{name}.tif")
            with Image.open(path) as image:
                assert (image.mode == "P") == (product == "classes")
                np.testing.assert_array_equal(np.asarray(image), pixels)
            assert tif(path)[0].GetGeoTransform() == pytest.approx(wanted.GetGeoTransform(), abs=1e-6)
        data, _ = tif(tmp_path / "out" / "classes" / f"{name}.png")
        table = data.GetRasterBand(1).GetColorTable()
        assert table.GetColorEntry(2)[:3] == (0x56, 0xB4, 0xE9)


def test_many_instances_take_32_bits_and_many_classes_16(tmp_path):
    made = captured(tmp_path / "out", ("many.gpkg", "wide.gpkg:number"), image_format="png")
    data, instances = tif(tmp_path / "out" / "instances" / f"{made.names[0]}.tif")
    assert instances.dtype == np.uint32
    assert instances.max() > 65_535
    assert data.RasterCount == 1
    _, classes = tif(tmp_path / "out" / "classes" / f"{made.names[0]}.png")
    assert classes.dtype == np.uint16
    table = json.loads((tmp_path / "out" / "classes.json").read_text())
    assert table["ignore"] == 65_535
    assert table["files"]["instances"] == {"format": "tif", "bits": 32}


def test_a_capture_resumed_gives_the_same_bytes(tmp_path):
    made = captured(tmp_path / "whole")
    captured(tmp_path / "out")
    for product in ("satellite", "classes", "instances"):
        (tmp_path / "out" / product / f"{made.names[1]}.tif").unlink()
    captured(tmp_path / "out")
    for product in ("classes", "instances"):
        for name in made.names:
            one, other = (tmp_path / folder / product / f"{name}.tif" for folder in ("whole", "out"))
            assert one.read_bytes() == other.read_bytes()


@pytest.mark.parametrize("image_format", ["tif", "png"])
def test_blocks_and_shards_hold_the_same_labels(tmp_path, image_format):
    source = named_source("world")
    with closing(source.open()) as opened:
        made = captured(tmp_path / "one", source=opened, image_format=image_format)
    capture(made, source, tmp_path / "shards", blocks=Blocks(2, "webdataset"))
    capture(made, source, tmp_path / "blocks", blocks=Blocks(2))
    for product in ("classes", "instances"):
        for path in (tmp_path / "one" / product).iterdir():
            assert path.read_bytes() == (tmp_path / "blocks" / product / path.name).read_bytes()
    packed = {}
    for shard in sorted((tmp_path / "shards" / "satellite").glob("*.tar")):
        with tarfile.open(shard) as tar:
            packed.update({member.name: tar.extractfile(member).read() for member in tar})
    for number, name in enumerate(made.names):
        for product in ("classes", "instances"):
            whole = (tmp_path / "one" / product / f"{name}.{image_format}").read_bytes()
            assert packed[f"{number:09d}.{product}.{image_format}"] == whole
    assert (tmp_path / "shards" / "classes.json").read_bytes() == (tmp_path / "one" / "classes.json").read_bytes()


def test_an_empty_field_and_too_many_classes_are_refused(tmp_path, layers):
    layers["fields.gpkg"].columns["empty"] = [None, ""] * (len(fields()) // 2)
    with pytest.raises(InvalidInput, match="labels fields: the field empty has no value in any feature"):
        captured(tmp_path / "out", ("fields.gpkg:empty",))
    layers["fields.gpkg"].columns["each"] = [f"value {at}" for at in range(70_000)]
    with pytest.raises(InvalidInput, match="labels of 70,000 classes: files of 16 bits hold 65,534"):
        captured(tmp_path / "out", ("fields.gpkg:each",))
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("changed", "name"),
    [
        (lambda shapes: {"crop": [("oats", "barley", None)[at % 3] for at in range(len(shapes))]}, "classes.json"),
        (lambda shapes: {"crop": [("rye", "oats", None)[at % 3] for at in range(len(shapes))]}, "instances.csv"),
    ],
)
def test_a_capture_is_not_resumed_with_labels_that_have_changed(tmp_path, layers, changed, name):
    folder = tmp_path / "out"
    made = captured(folder)
    (folder / "satellite" / f"{made.names[0]}.tif").unlink()
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    kept, shapes = layers["fields.gpkg"], fields()
    layers["fields.gpkg"] = ShapelyLayer(shapes, **changed(shapes))
    opening._opened.cache_clear()
    with pytest.raises(OutputError, match=f"its {name} is of other labels"):
        captured(folder)
    assert {path: path.read_bytes() for path in before} == before
    layers["fields.gpkg"] = kept
    opening._opened.cache_clear()
    captured(folder)
    assert (folder / "satellite" / f"{made.names[0]}.tif").is_file()
    assert (folder / "classes.json").read_bytes() == before[folder / "classes.json"]
