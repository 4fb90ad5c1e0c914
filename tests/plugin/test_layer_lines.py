"""Labels and buildings chosen in the panel from the layers of the project."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from osgeo import gdal, ogr, osr
from qgis.core import (
    QgsCategorizedSymbolRenderer,
    QgsFeature,
    QgsFillSymbol,
    QgsGeometry,
    QgsProject,
    QgsRasterLayer,
    QgsRectangle,
    QgsRendererCategory,
    QgsVectorLayer,
)
from qgis.PyQt.QtWidgets import QLineEdit, QMenu, QToolButton
from terrainav.terrainav_plugin.compat import QAction

from tests.plugin.steps import COARSE_BOX
from tests.plugin.test_capture import capture, images

SQUARE = "POLYGON((-89.87 35.13, -89.86 35.13, -89.86 35.14, -89.87 35.13))"


@pytest.fixture
def roofs():
    """A layer in memory, with one feature."""
    layer = QgsVectorLayer("Polygon?crs=EPSG:4326&field=kind:string&field=rank:integer", "Roofs & sheds", "memory")
    feature = QgsFeature(layer.fields())
    feature.setGeometry(QgsGeometry.fromWkt(SQUARE))
    feature.setAttributes(["tile", 3])
    assert layer.dataProvider().addFeatures([feature])[0]
    return QgsProject.instance().addMapLayer(layer)


@pytest.fixture
def fields(tmp_path):
    """A layer of a GeoPackage."""
    path = tmp_path / "land use.gpkg"
    made = ogr.GetDriverByName("GPKG").CreateDataSource(str(path))
    spatial = osr.SpatialReference()
    spatial.ImportFromEPSG(4326)
    layer = made.CreateLayer("fields", spatial, ogr.wkbPolygon)
    layer.CreateField(ogr.FieldDefn("crop", ogr.OFTString))
    for crop in ("maize", "wheat"):
        feature = ogr.Feature(layer.GetLayerDefn())
        feature.SetField("crop", crop)
        feature.SetGeometry(ogr.CreateGeometryFromWkt(SQUARE))
        layer.CreateFeature(feature)
    feature = layer = made = None
    added = QgsVectorLayer(f"{path}|layername=fields", "Fields", "ogr")
    assert added.isValid()
    return QgsProject.instance().addMapLayer(added)


def offers(desk, name):
    """Titles offered at an entry, with the actions or submenus behind them."""
    menu = desk.form.findChild(QToolButton, f"{name}_choose").menu()
    menu.aboutToShow.emit()
    return {action.text(): action.menu() or action for action in menu.actions() if action.text()}


def of_field(desk, layer, field):
    menu = offers(desk, "labels")[layer]
    assert isinstance(menu, QMenu)
    next(action for action in menu.actions() if action.text() == field).trigger()


def test_a_layer_of_a_file_is_named_by_its_file_layer_and_field(desk, fields, tmp_path):
    of_field(desk, "Fields", "crop")
    assert desk.session.state().labels == (f"{tmp_path / 'land use.gpkg'}:fields:crop",)
    of_field(desk, "Fields", "crop")
    assert len(desk.session.state().labels) == 1
    of_field(desk, "Fields", "One class")
    assert desk.session.state().labels[1] == f"{tmp_path / 'land use.gpkg'}:fields"
    offers(desk, "labels")["None"].trigger()
    assert desk.session.state().labels == ()


def test_a_layer_without_a_file_is_copied_once_and_anew_once_it_changes(desk, roofs):
    of_field(desk, "Roofs && sheds", "kind")
    (first,) = desk.session.state().labels
    path, layer, field = first.rsplit(":", 2)
    assert field == "kind"
    opened = ogr.Open(path)
    copy = opened.GetLayerByName(layer)
    assert copy.GetFeatureCount() == 1
    assert copy.GetSpatialRef().GetAuthorityCode(None) == "4326"
    of_field(desk, "Roofs && sheds", "kind")
    assert desk.session.state().labels == (first,)
    assert roofs.dataProvider().changeAttributeValues({1: {0: "slate"}})
    of_field(desk, "Roofs && sheds", "kind")
    _, second = desk.session.state().labels
    changed = ogr.Open(second.rsplit(":", 2)[0])
    assert changed.GetLayerByName(layer).GetNextFeature().GetField("kind") == "slate"
    assert not list(Path(path).parent.glob("*.partial*"))


def test_a_filtered_layer_is_copied_as_the_map_shows_it(desk, fields):
    assert fields.setSubsetString("crop = 'wheat'")
    of_field(desk, "Fields", "crop")
    path, layer, _ = desk.session.state().labels[0].rsplit(":", 2)
    assert not path.endswith("land use.gpkg")
    copy = ogr.Open(path)
    assert copy.GetLayerByName(layer).GetFeatureCount() == 1


def test_entries_of_buildings_and_labels_appear_with_them(desk, roofs):
    section = desk.form.labels
    section.unfold()
    for name, other in (("buildings", "building_height_field"), ("labels", "label_order")):
        entry = section.findChild(QLineEdit, other)
        assert entry.parentWidget().isHidden()
        section.findChild(QLineEdit, name).setText("houses.geojson")
        assert not entry.parentWidget().isHidden()
    offers(desk, "buildings")["Roofs && sheds"].trigger()
    assert desk.session.state().buildings[1].partition(".gpkg:")[2] == "Roofs___sheds"


def test_a_capture_writes_the_classes_and_instances_of_a_layer_in_memory(desk):
    layer = QgsVectorLayer("Polygon?crs=EPSG:4326&field=kind:string", "Halves", "memory")
    box = COARSE_BOX
    west, north, east, south = (float(box[name]) for name in ("west", "north", "east", "south"))
    middle = (west + east) / 2.0
    features = []
    for kind, left, right in (("tile", west - 1.0, middle), ("slate", middle, east + 1.0)):
        feature = QgsFeature(layer.fields())
        feature.setGeometry(QgsGeometry.fromRect(QgsRectangle(left, south - 1.0, right, north + 1.0)))
        feature.setAttributes([kind])
        features.append(feature)
    assert layer.dataProvider().addFeatures(features)[0]
    categories = [
        QgsRendererCategory("tile", QgsFillSymbol.createSimple({"color": "#b22222"}), "Tiled roof"),
        QgsRendererCategory(["slate", "lead"], QgsFillSymbol.createSimple({"color": "#708090"}), ""),
        QgsRendererCategory(None, QgsFillSymbol(), "others"),
    ]
    layer.setRenderer(QgsCategorizedSymbolRenderer("kind", categories))
    QgsProject.instance().addMapLayer(layer)
    desk.enter_coarse_mission()
    of_field(desk, "Halves", "kind")
    desk.wait_planned()
    capture(desk)
    table = json.loads((desk.folder / "classes.json").read_text("utf-8"))
    # With the names and colours of the map's symbols.
    assert [(one["id"], one["name"], one["color"]) for one in table["classes"]] == [
        (1, "slate", "#708090"),
        (2, "Tiled roof", "#b22222"),
    ]
    made = images(desk)
    assert made
    for image in made:
        opened = gdal.Open(str(image))
        classes, instances = (gdal.Open(str(desk.folder / name / image.name)) for name in ("classes", "instances"))
        assert classes.RasterXSize == opened.RasterXSize
        assert classes.GetRasterBand(1).GetColorTable() is not None
        first, across = opened.GetGeoTransform()[:2]
        x = first + (np.arange(opened.RasterXSize) + 0.5) * across
        is_west = x < middle * 20037508.342789244 / 180.0
        assert (classes.ReadAsArray() == np.where(is_west, 2, 1)).all()
        assert (instances.ReadAsArray() == np.where(is_west, 1, 2)).all()


@pytest.fixture
def raster(tmp_path):
    """An orthophoto around the layers, below them on the map, and another one elsewhere above it."""
    for name, west in (("ortho", -90.0), ("elsewhere", 12.0)):
        made = gdal.GetDriverByName("GTiff").Create(str(tmp_path / f"{name}.tif"), 100, 100, 3)
        made.SetGeoTransform((west, 0.005, 0.0, 35.4, 0.0, -0.005))
        spatial = osr.SpatialReference()
        spatial.ImportFromEPSG(4326)
        made.SetProjection(spatial.ExportToWkt())
        made = None
    added = [QgsRasterLayer(str(tmp_path / f"{name}.tif"), name) for name in ("ortho", "elsewhere")]
    for layer in added:
        assert layer.isValid()
        QgsProject.instance().addMapLayer(layer)
    return added[0]


def label_action(plugin):
    (action,) = [
        one for one in plugin.iface.mainWindow().findChildren(QAction) if one.objectName() == "terrainav_label_layer"
    ]
    return action


def test_a_layers_menu_enters_its_extent_its_field_and_the_imagery_below_it(desk, fields, raster, plugin):
    categories = [QgsRendererCategory(crop, QgsFillSymbol(), crop) for crop in ("maize", "wheat")]
    fields.setRenderer(QgsCategorizedSymbolRenderer("crop", categories))
    desk.iface.setActiveLayer(fields)
    label_action(plugin).trigger()
    state = desk.session.state()
    assert state.labels == (f"{Path(fields.source().split('|')[0])}:fields:crop",)
    assert state.source == f"qgis:layer/{raster.id()}"
    edges = [float(edge) for edge in (state.south, state.north, state.west, state.east)]
    assert edges == pytest.approx([35.13, 35.14, -89.87, -89.86], abs=1e-6)
    assert desk.dock.isVisible()


def test_a_layers_menu_keeps_the_imagery_where_no_raster_lies_below_it(desk, roofs, plugin):
    before = desk.session.state().source
    desk.iface.setActiveLayer(roofs)
    label_action(plugin).trigger()
    state = desk.session.state()
    assert state.source == before
    assert len(state.labels) == 1


def test_a_layers_menu_refuses_a_layer_without_features(desk, plugin):
    empty = QgsProject.instance().addMapLayer(QgsVectorLayer("Polygon?crs=EPSG:4326", "Empty", "memory"))
    before = desk.session.state()
    desk.iface.setActiveLayer(empty)
    label_action(plugin).trigger()
    assert "it has no extent" in desk.messages()[-1]
    assert desk.session.state().labels == before.labels
