"""What refusals of labels and of vector files advise."""

from __future__ import annotations

import json

import numpy as np
from osgeo import ogr, osr
from shapely.geometry import box
from terrainav.core.capture.labels import write_label_tables
from terrainav.core.labels.classes import class_table
from terrainav.core.labels.label_map import GroundBox, LabelLayer, LabelMap
from terrainav.core.labels.pieces import DegreePlane
from terrainav.core.vectors.layer import open_layer

from tests.support.labels import ShapelyLayer
from tests.support.remedies import Case, remedy

SQUARES = [box(0.0, 0.0, 1.0, 1.0), box(2.0, 0.0, 3.0, 1.0)]


def table_of(field: str, values: dict) -> object:
    """Table of classes of a layer with these values in its field."""
    layer = ShapelyLayer(SQUARES, **{field: tuple(values)}) if field else ShapelyLayer(SQUARES)
    layer.values = lambda _field: dict(values)
    return class_table([LabelLayer(layer, "fields", field).values])


@remedy("labels/classes.py", "labels {}: the field {} has no value in any feature; choose another field, or none")
def _empty_field(case: Case) -> None:
    case.refused(lambda: table_of("crop", {None: 2}))
    case.follow("choose another field", lambda: table_of("kind", {"a": 2}))
    case.follow("none", lambda: table_of("", {}))


@remedy(
    "labels/classes.py",
    "labels of {} classes: files of 16 bits hold {}; choose a field with fewer values, or none and tell features apart "
    "by the product instances",
)
def _too_many_classes(case: Case) -> None:
    case.refused(lambda: table_of("name", {f"field {number}": 1 for number in range(70_000)}))
    case.follow("choose a field with fewer values", lambda: table_of("crop", {"maize": 35_000, "wheat": 35_000}))
    case.follow("none and tell features apart by the product instances", lambda: table_of("", {}))


@remedy("labels/label_map.py", "label order {}: has the value {}, which is no number; choose a field of numbers")
def _order_by_names(case: Case) -> None:
    layer = LabelLayer(ShapelyLayer(SQUARES, name=("low", "high"), rank=(1, 2)), "fields")

    def read(field: str) -> None:
        lon, lat = np.array([[0.5, 2.5]]), np.array([[0.5, 0.5]])
        LabelMap([layer], field, 3.0, 3.0).draw(DegreePlane(), lon, lat, GroundBox.around(lat, lon))

    case.refused(lambda: read("name"))
    case.follow("choose a field of numbers", lambda: read("rank"))


def _with_two_layers(case: Case) -> str:
    path = case.tmp_path / "place.gpkg"
    made = ogr.GetDriverByName("GPKG").CreateDataSource(str(path))
    degrees = osr.SpatialReference()
    degrees.ImportFromEPSG(4326)
    for name in ("roofs", "fields"):
        layer = made.CreateLayer(name, degrees, ogr.wkbPolygon)
        feature = ogr.Feature(layer.GetLayerDefn())
        feature.SetGeometry(ogr.CreateGeometryFromWkt("POLYGON((0 0, 1 0, 1 1, 0 0))"))
        layer.CreateFeature(feature)
    return str(path)


@remedy("vectors/reading.py", "{}: has several layers; name one of {}")
def _several_layers(case: Case) -> None:
    path = _with_two_layers(case)
    text = case.refused(lambda: open_layer(path, index_dir=case.tmp_path))
    case.follow(
        f"name one of {text.rpartition('name one of ')[2]}", lambda: open_layer(path, "roofs", index_dir=case.tmp_path)
    )


@remedy("vectors/reading.py", "{}: refers to other files; name these")
def _virtual_file(case: Case) -> None:
    path = case.tmp_path / "other.geojson"
    ring = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0]]
    feature = {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [ring]}}
    path.write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}), "utf-8")
    virtual = case.tmp_path / "all.vrt"
    virtual.write_text(
        f'<OGRVRTDataSource><OGRVRTLayer name="other"><SrcDataSource>{path}</SrcDataSource></OGRVRTLayer>'
        "</OGRVRTDataSource>",
        "utf-8",
    )
    case.refused(lambda: open_layer(str(virtual), index_dir=case.tmp_path))
    case.follow("name these", lambda: open_layer(str(path), index_dir=case.tmp_path))


@remedy(
    "vectors/layer.py",
    "field {} of {}: more than {} distinct values, which 16 bits cannot hold; choose a field with fewer values, or "
    "none and tell features apart by the product instances",
)
def _too_many_values(case: Case) -> None:
    square = [[[7.0, 46.0], [7.1, 46.0], [7.1, 46.1], [7.0, 46.0]]]
    features = [
        {
            "type": "Feature",
            "geometry": {"type": "Polygon", "coordinates": square},
            "properties": {"name": f"field {number}", "crop": "maize"},
        }
        for number in range(65_536)
    ]
    path = case.tmp_path / "fields.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}), encoding="utf-8")
    layer = open_layer(str(path), index_dir=case.tmp_path / "index")
    case.refused(lambda: layer.values("name"))
    case.follow("choose a field with fewer values", lambda: layer.values("crop"))
    case.follow("none and tell features apart by the product instances", lambda: table_of("", {}))


@remedy(
    "capture/labels.py",
    "folder {}: its {} is of other labels, as layers have changed since its images were made; choose another folder, "
    "or restore the layers",
)
def _other_labels(case: Case) -> None:
    def write(folder: str, *crops: str) -> None:
        crops_of = {"crop": crops}
        labels = LabelMap([LabelLayer(ShapelyLayer(SQUARES, **crops_of), "fields", "crop")])
        (case.tmp_path / folder).mkdir(exist_ok=True)
        write_label_tables(labels, case.tmp_path / folder, "png")

    write("out", "maize", "wheat")
    case.refused(lambda: write("out", "maize", "oats"))
    case.follow("restore the layers", lambda: write("out", "maize", "wheat"))
    case.follow("choose another folder", lambda: write("other", "maize", "oats"))
