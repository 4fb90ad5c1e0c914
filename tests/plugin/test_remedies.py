"""What the plugin advises where an area, a layer or a connection cannot be used is done, and works."""

from __future__ import annotations

import os

import numpy as np
import pytest
from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransformContext,
    QgsFeature,
    QgsGeometry,
    QgsProject,
    QgsRasterLayer,
    QgsVectorLayer,
)
from terrainav.terrainav_plugin.dock.area_text import area_of_text
from terrainav.terrainav_plugin.dock.options_page import folder_problem
from terrainav.terrainav_plugin.layers.snapshot import PROJECT_SOURCE, grid_of_layers, layers_of, source_name
from terrainav.terrainav_plugin.map.area_layers import PointFields, points_of, polygon_of
from terrainav.terrainav_plugin.map.area_reading import extent_of
from terrainav.terrainav_plugin.processing.areas import _polygon

from tests.support import rasters
from tests.support.remedies import ENTRIES, Case, places, remedy

PACKAGE = "terrainav_plugin"
#: Modules each of whose messages with advice is tried here.
MODULES = (
    *("map/area_layers.py", "map/area_reading.py", "processing/areas.py", "dock/area_text.py"),
    *("layers/snapshot.py", "dock/options_page.py"),
)
CONTEXT = QgsCoordinateTransformContext()
UTM = "EPSG:32616"
SQUARE, FAR = "Polygon ((0 0, 9 0, 9 9, 0 9, 0 0))", "Polygon ((50 50, 59 50, 59 59, 50 50))"
TWO_PARTS = "MultiPolygon (((0 0, 1 0, 1 1, 0 0)), ((5 5, 6 5, 6 6, 5 5)))"
BOW_TIE = "Polygon ((0 0, 10 10, 0 10, 10 0, 0 0))"


def feature(wkt: str | QgsGeometry) -> QgsFeature:
    made = QgsFeature(7)
    made.setGeometry(QgsGeometry.fromWkt(wkt) if isinstance(wkt, str) else wkt)
    return made


def area(*shapes, crs=UTM):
    return polygon_of(map(feature, shapes), QgsCoordinateReferenceSystem(crs), CONTEXT)


def points(*shapes):
    return points_of(
        map(feature, shapes), QgsCoordinateReferenceSystem("EPSG:4326"), CONTEXT, PointFields(120.0)
    )


@remedy("map/area_layers.py", "no polygon is selected: select exactly one in its layer")
def _none_selected(case: Case) -> None:
    case.refused(area)
    case.follow("select exactly one in its layer", lambda: area(SQUARE))


@remedy(
    "map/area_layers.py",
    "{count} polygons are selected, and an area is one: select only that one, or join them first (Vector > "
    "Geoprocessing Tools > Dissolve)",
)
def _several(case: Case) -> None:
    beside = "Polygon ((9 0, 20 0, 20 9, 9 9, 9 0))"
    case.refused(lambda: area(SQUARE, beside))
    case.follow("select only that one", lambda: area(SQUARE))
    joined = QgsGeometry.unaryUnion([QgsGeometry.fromWkt(SQUARE), QgsGeometry.fromWkt(beside)])
    case.follow("join them first (Vector > Geoprocessing Tools > Dissolve)", lambda: area(joined))


@remedy("map/area_layers.py", "{feature} has no geometry: select one that has")
def _empty(case: Case) -> None:
    case.refused(lambda: area("Polygon EMPTY"))
    case.follow("select one that has", lambda: area(SQUARE))


@remedy("map/area_layers.py", "{feature} is no polygon: select one that is")
def _no_polygon(case: Case) -> None:
    case.refused(lambda: area("Point (1 1)"))
    case.follow("select one that is", lambda: area(SQUARE))


@remedy(
    "map/area_layers.py",
    "{feature} has {count} parts, and an area is one: take it apart first (Vector > Geometry Tools > Multipart to "
    "Singleparts) and select one of them",
)
def _parts(case: Case) -> None:
    case.refused(lambda: area(TWO_PARTS))
    apart = QgsGeometry.fromWkt(TWO_PARTS).asGeometryCollection()
    case.follow(
        "take it apart first (Vector > Geometry Tools > Multipart to Singleparts) and select one of them",
        lambda: area(apart[1]),
    )


@remedy(
    "map/area_layers.py",
    "{feature} is no sound polygon, {what}: repair it first (Processing: Fix geometries)",
)
def _unsound(case: Case) -> None:
    spike = "Polygon ((0 0, 9 0, 9 9, 5 9, 5 15, 5 9, 0 9, 0 0))"
    case.refused(lambda: area(spike))
    # As the algorithm does: a part that is no area is left out.
    repaired = [
        part for part in QgsGeometry.fromWkt(spike).makeValid().asGeometryCollection() if part.area() > 0.0
    ]
    case.follow("repair it first (Processing: Fix geometries)", lambda: area(*repaired))


@remedy("map/area_layers.py", "{feature} goes around a pole: an area's edges must close without that; cut it")
def _around_a_pole(case: Case) -> None:
    whole = "Polygon ((-900000 -900000, 900000 -900000, 900000 900000, -900000 900000, -900000 -900000))"
    case.refused(lambda: area(whole, crs="EPSG:3031"))
    half = "Polygon ((100000 -900000, 900000 -900000, 900000 900000, 100000 900000, 100000 -900000))"
    case.follow("cut it", lambda: area(half, crs="EPSG:3031"))


@remedy("map/area_layers.py", "{feature} has an edge through a pole or across the edge of its map: cut it")
def _through_a_pole(case: Case) -> None:
    # A cone that is unrolled: beyond its tip the map ends on both sides.
    cone = QgsCoordinateReferenceSystem("PROJ:+proj=lcc +lat_1=40 +lat_2=60 +lat_0=50 +lon_0=10 +datum=WGS84")
    across = (
        "Polygon ((-1000000 6500000, 1000000 6500000, 1000000 7500000, -1000000 7500000, -1000000 6500000))"
    )
    case.refused(lambda: polygon_of([feature(across)], cone, CONTEXT))
    half = "Polygon ((1000 6500000, 1000000 6500000, 1000000 7500000, 1000 7500000, 1000 6500000))"
    case.follow("cut it", lambda: polygon_of([feature(half)], cone, CONTEXT))


@remedy("map/area_layers.py", "no point is there to be taken: select some, or take all of the layer")
def _no_points(case: Case) -> None:
    case.refused(points)
    case.follow("select some", lambda: points("Point (1 1)"))
    case.follow("take all of the layer", lambda: points("Point (1 1)", "Point (2 2)"))


@remedy("map/area_layers.py", "{feature} has no geometry: give it a point, or leave it out")
def _no_place(case: Case) -> None:
    case.refused(lambda: points("Point (1 1)", "Point EMPTY"))
    case.follow("give it a point", lambda: points("Point (1 1)", "Point (2 2)"))
    case.follow("leave it out", lambda: points("Point (1 1)"))


@remedy("map/area_layers.py", "{feature} is no point: take a layer of points")
def _no_point(case: Case) -> None:
    case.refused(lambda: points(SQUARE))
    case.follow("take a layer of points", lambda: points("Point (1 1)"))


@remedy("map/area_reading.py", "layer “{name}” has no CRS: set it in the layer's properties")
def _no_crs(case: Case) -> None:
    layer = QgsVectorLayer("Point", "mine", "memory")
    layer.dataProvider().addFeatures([feature("Point (1 1)"), feature("Point (2 2)")])
    layer.updateExtents()
    layer.setCrs(QgsCoordinateReferenceSystem())
    case.refused(lambda: extent_of(layer, QgsProject.instance()))
    layer.setCrs(QgsCoordinateReferenceSystem("EPSG:4326"))
    case.follow("set it in the layer's properties", lambda: extent_of(layer, QgsProject.instance()))


@remedy(
    "processing/areas.py",
    "area of {count} separate polygons: must be one; select one, or run it as a batch",
)
def _separate(case: Case) -> None:
    both = [(feature(shape), QgsGeometry.fromWkt(shape)) for shape in (SQUARE, FAR)]
    case.refused(lambda: _polygon(both))
    case.follow("select one", lambda: _polygon(both[:1]))
    # A batch runs once for each.
    case.follow("run it as a batch", lambda: [_polygon([one]) for one in both])


@remedy("dock/area_text.py", "give every point a yaw, or none")
def _yaws(case: Case) -> None:
    case.refused(lambda: area_of_text("35 10 120 5\n35 11 120", 120.0, "m"))
    case.follow("give every point a yaw", lambda: area_of_text("35 10 120 5\n35 11 120 6", 120.0, "m"))
    case.follow("none", lambda: area_of_text("35 10 120\n35 11 120", 120.0, "m"))


@pytest.fixture
def project():
    """The project, whose layers go with the test."""
    yield QgsProject.instance()
    QgsProject.instance().clear()


@remedy("layers/snapshot.py", "the map shows no layer: tick one in the Layers panel")
def _nothing_ticked(case: Case) -> None:
    project = case.fixture("project")
    layer = memory_layer(project)
    node = project.layerTreeRoot().findLayer(layer)
    node.setItemVisibilityChecked(False)
    case.refused(lambda: layers_of(PROJECT_SOURCE, project))
    node.setItemVisibilityChecked(True)
    case.follow("tick one in the Layers panel", lambda: layers_of(PROJECT_SOURCE, project) == [layer])


def memory_layer(project):
    layer = QgsVectorLayer("Point?crs=EPSG:4326", "mine", "memory")
    layer.dataProvider().addFeatures([feature("Point (1 1)")])
    layer.updateExtents()
    project.addMapLayer(layer)
    return layer


@remedy(
    "layers/snapshot.py", "source {name}: the project has no such layer (any more); choose another source"
)
def _no_such_layer(case: Case) -> None:
    project = case.fixture("project")
    gone, there = memory_layer(project), memory_layer(project)
    name = source_name(gone)
    project.removeMapLayer(gone.id())
    case.refused(lambda: layers_of(name, project))
    case.follow("choose another source", lambda: layers_of(source_name(there), project) == [there])


@remedy("layers/snapshot.py", "layer {name}: shows nothing; repair its data source")
def _broken_layer(case: Case) -> None:
    project = case.fixture("project")
    path = case.tmp_path / "points.geojson"
    path.write_text('{"type": "Point", "coordinates": [10, 35]}')
    layer = QgsVectorLayer(str(path), "mine", "ogr")
    project.addMapLayer(layer)
    layer.setDataSource(str(path) + ".gone", "mine", "ogr")
    case.refused(lambda: layers_of(source_name(layer), project))
    layer.setDataSource(str(path), "mine", "ogr")
    case.follow("repair its data source", lambda: layers_of(source_name(layer), project) == [layer])


@remedy("layers/snapshot.py", "layer {name}: its place on the globe is not known; set its CRS")
def _unknown_place(case: Case) -> None:
    project = case.fixture("project")
    utm = (505_000.0, 2.0, 0.0, 5_317_000.0, 0.0, -2.0)
    path = rasters.write(case.tmp_path / "r.tif", np.ones((3, 8, 8), np.uint8), utm, 4326)
    layer = QgsRasterLayer(str(path), "mine")
    project.addMapLayer(layer)
    case.refused(lambda: grid_of_layers(source_name(layer), project))
    layer.setCrs(QgsCoordinateReferenceSystem("EPSG:32632"))
    case.follow("set its CRS", lambda: grid_of_layers(source_name(layer), project))


@remedy("dock/options_page.py", "{folder}: {file} is a file; choose a folder")
def _file_in_place(case: Case) -> None:
    path = case.tmp_path / "file"
    path.write_text("")
    case.says(folder_problem(str(path)))
    case.follow("choose a folder", lambda: not folder_problem(str(case.tmp_path / "folder")))


@remedy("dock/options_page.py", "{folder}: cannot be written to; choose another")
def _not_writable(case: Case) -> None:
    locked = case.tmp_path / "locked"
    locked.mkdir()
    # Who runs the tests may be allowed everything.
    case.monkeypatch.setattr(os, "access", lambda path, _mode: str(path) != str(locked))
    case.says(folder_problem(str(locked)))
    case.follow("choose another", lambda: not folder_problem(str(case.tmp_path / "other")))


def test_each_message_with_advice_has_its_entry():
    found = {place for place in places(PACKAGE) if place.module in MODULES}
    assert sorted(map(str, found ^ {place for place in ENTRIES if place.module in MODULES})) == []


@pytest.mark.parametrize("place", ENTRIES, ids=lambda place: f"{place.module}: {place.message}")
def test_what_is_advised_works(place, request):
    case = Case(place, PACKAGE, request)
    ENTRIES[place](case)
    case.check()
