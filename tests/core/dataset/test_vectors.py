"""GeoJSON of a dataset: what captures and GDAL write is let through, what leads elsewhere is refused."""

from __future__ import annotations

import json

import pytest
from terrainav.core.dataset import vectors
from terrainav.core.dataset.vectors import HEAD_BYTES, check_geojson, checked_geojson, json_without_tags
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.export.geojson import geojson_text
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

FEATURE = '{"type": "Feature", "properties": {"name": "1"}, "geometry": {"type": "Point", "coordinates": [1, 2]}}'


def collection(more="", features=FEATURE):
    return f'{{"type": "FeatureCollection", {more}"features": [{features}]}}'.encode()


def crs(name):
    return f'"crs": {{"type": "name", "properties": {{"name": "{name}"}}}}, '


def refused(text, name="x.geojson"):
    with pytest.raises(InvalidInput) as wrong:
        list(checked_geojson([text], name))
    assert "\n" not in str(wrong.value)
    return str(wrong.value)


def test_footprints_of_a_capture_are_let_through(tmp_path):
    path = tmp_path / "footprints.geojson"
    mission = Mission(Box(35.16, -89.90, 35.13, -89.85), 120.0, tilt_deg=20.0, image_px=64)
    path.write_text("".join(geojson_text(plan(mission, PixelGrid()))), "utf-8")
    assert path.stat().st_size > HEAD_BYTES
    check_geojson(path)


@pytest.mark.parametrize("driver", ["GeoJSON"])
@pytest.mark.parametrize("code", [4326, 25832, 3857])
def test_what_gdal_writes_is_let_through(tmp_path, driver, code):
    ogr = pytest.importorskip("osgeo.ogr", reason="needs GDAL's Python bindings")
    osr = pytest.importorskip("osgeo.osr")
    system = osr.SpatialReference()
    system.ImportFromEPSG(code)
    path = tmp_path / "x.geojson"
    made = ogr.GetDriverByName(driver).CreateDataSource(str(path))
    layer = made.CreateLayer("x", system, ogr.wkbPoint, options=["RFC7946=NO"])
    feature = ogr.Feature(layer.GetLayerDefn())
    feature.SetGeometry(ogr.CreateGeometryFromWkt("POINT (1 2)"))
    layer.CreateFeature(feature)
    feature = layer = made = None
    assert code == 4326 or b'"crs"' in path.read_bytes()
    check_geojson(path)


@pytest.mark.parametrize(
    "more",
    ["", '"name": "crs of it", ', '"crs": null, ', crs("EPSG:25832"), crs("urn:ogc:def:crs:OGC:1.3:CRS84"),
     crs("urn:ogc:def:crs:EPSG::4326"), '"note": "it says \\"crs\\": x", '],
)  # fmt: skip
def test_plain_systems_are_let_through(more):
    assert b"".join(checked_geojson([collection(more)], "x")) == collection(more)


@pytest.mark.parametrize(
    "more",
    [
        '"crs": {"type": "link", "properties": {"href": "http://host/x"}}, ',
        '"CRS": {"type": "link", "properties": {"href": "http://host/x"}}, ',
        '"\\u0063\\u0072\\u0053" : {"type": "link", "properties": {"href": "http://host/x"}}, ',
        "'crs': {\"type\": \"link\"}, ",
        '"crs"/**/: {"type": "name", "properties": {"name": "EPSG:4326"}}, ',
        '"crs": {"type": "url", "properties": {"url": "http://host/x"}}, ',
        crs("http://host/x"), crs("https://www.opengis.net/def/crs/EPSG/0/4326"), crs("/etc/passwd"),
        crs("+proj=longlat +nadgrids=/x +no_defs"), crs("EPSG:4326+nadgrids"), crs("urn:ogc:def:crs,crs:x,y"),
        '"crs": {"type": "name", "properties": {"name": "EPSG:4326"}, "href": "x"}, ',
        '"crs":' + " " * 2000 + "null, ",
    ],
)  # fmt: skip
def test_other_systems_are_refused_wherever_blocks_end(more):
    text = collection(features=FEATURE.replace('"coordinates"', more + '"coordinates"'))
    assert "crs" in refused(text)
    assert "crs" in refused(collection(more))
    for at in range(0, len(text), 1 + len(text) // 300):
        with pytest.raises(InvalidInput):
            list(checked_geojson([text[:at], text[at:]], "x"))


@pytest.mark.parametrize(
    "text",
    [b"", b"{", b"[]", b"<kml>", b'{"type": "Topology"}', b'{"features": []}', b'"type": "FeatureCollection"',
     b"\xff\xfe{\x00", b'{"type": "FeatureCollection2", "features": []}'],
)  # fmt: skip
def test_other_files_are_refused(text):
    assert "are not GeoJSON" in refused(text)


def test_a_tag_is_refused_in_the_head_and_escaped_where_it_is_written():
    name = {"name": "<OGRVRTDataSource>"}
    assert "must be written as \\u003c" in refused(collection(f'"x": {json.dumps(name)}, '))
    text = json_without_tags(json.dumps(name))
    assert json.loads(text) == name
    assert list(checked_geojson([collection(f'"x": {text}, ')], "x"))


def test_its_work_grows_with_the_length(monkeypatch):
    """Bytes that are looked at, those that are left over from each block among them."""
    seen = []
    checked = vectors._checked
    monkeypatch.setattr(vectors, "_checked", lambda text, *rest: seen.append(len(text)) or checked(text, *rest))

    def work(count):
        seen.clear()
        list(checked_geojson([collection(), *[b'"crs ' * 16_384] * count], "x"))
        return sum(seen)

    assert work(40) < 4.2 * work(10)


def test_a_name_that_no_file_has_is_one_line(tmp_path):
    for path in (tmp_path / "x.geojson", tmp_path):
        with pytest.raises(InvalidInput, match="cannot be read"):
            check_geojson(path)
