"""Labels and buildings chosen in the panel from the layers of the project."""

from __future__ import annotations

from pathlib import Path

import pytest
from osgeo import ogr, osr
from qgis.core import QgsFeature, QgsGeometry, QgsProject, QgsVectorLayer
from qgis.PyQt.QtWidgets import QLineEdit, QMenu, QToolButton

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
