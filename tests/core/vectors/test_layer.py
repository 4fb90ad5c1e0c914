"""Features of vector files against what GDAL's own modules state of the same files."""

from __future__ import annotations

import json
import pickle
import struct
import tracemalloc
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from terrainav.core.errors import Cancelled, InvalidInput
from terrainav.core.storage.files import PARTIAL_ENDING, lock_tried
from terrainav.core.vectors import index, reading
from terrainav.core.vectors import layer as layers
from terrainav.core.vectors.features import LINE, POINT, POLYGON
from terrainav.core.vectors.layer import open_layer, parse_layer
from terrainav.core.vectors.shaping import Reference
from terrainav.core.waiting import cancellable, reporting

SQUARE = [[7.0, 46.0], [7.0, 46.001], [7.001, 46.001], [7.001, 46.0], [7.0, 46.0]]
HOLE = [[7.0002, 46.0002], [7.0004, 46.0002], [7.0004, 46.0004], [7.0002, 46.0004], [7.0002, 46.0002]]
#: Crosses itself; its two triangles differ, so that its signed area is not 0.
BOW_TIE = [[7.01, 46.0], [7.02, 46.01], [7.02, 46.0], [7.01, 46.02], [7.01, 46.0]]
FLAT = [[7.0, 46.0], [7.1, 46.0], [7.2, 46.0], [7.0, 46.0]]
EVERYWHERE = (-180.0, -90.0, 180.0, 90.0)


def geojson(path, geometries, values=None):
    features = [
        {"type": "Feature", "geometry": one, "properties": values[place] if values else {"n": place}}
        for place, one in enumerate(geometries)
    ]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}), encoding="utf-8")
    return str(path)


def polygon(*rings):
    return {"type": "Polygon", "coordinates": rings}


@pytest.fixture(params=["osgeo", "pyogrio", ""])
def by(request, monkeypatch):
    """Each way to read files; GeoJSON alone by the last."""
    if request.param:
        pytest.importorskip(request.param)
    monkeypatch.setattr(reading, "backend", lambda: request.param)
    monkeypatch.setattr(layers, "backend", lambda: request.param)
    return request.param


def geopackage(path, wkt, epsg, name="roofs"):
    ogr, osr = pytest.importorskip("osgeo.ogr"), pytest.importorskip("osgeo.osr")
    reference = None
    if epsg:
        reference = osr.SpatialReference()
        reference.ImportFromEPSG(epsg)
    made = ogr.GetDriverByName("GPKG").CreateDataSource(str(path))
    layer = made.CreateLayer(name, reference, ogr.wkbUnknown)
    layer.CreateField(ogr.FieldDefn("class", ogr.OFTString))
    for text in wkt:
        feature = ogr.Feature(layer.GetLayerDefn())
        feature.SetField("class", "field")
        feature.SetGeometry(ogr.CreateGeometryFromWkt(text))
        layer.CreateFeature(feature)
    return str(path)


def test_polygons_lines_and_points_come_in_order_with_turned_rings(tmp_path, by):
    line = {"type": "LineString", "coordinates": [[7.0, 46.0], [7.1, 46.1]]}
    point = {"type": "MultiPoint", "coordinates": [[7.0, 46.0], [7.2, 46.2]]}
    path = geojson(tmp_path / "a.geojson", [polygon(SQUARE, HOLE), line, point])
    layer = pickle.loads(pickle.dumps(open_layer(path, index_dir=tmp_path)))
    found = layer.features(*EVERYWHERE, ["n"])
    assert found.number.tolist() == [1, 2, 3]
    assert found.kind.tolist() == [POLYGON, LINE, POINT]
    assert found.values == {"n": (0, 1, 2)}
    assert found.feature_starts.tolist() == [0, 1, 2, 4]
    assert found.part_starts.tolist() == [0, 2, 3, 4, 5]
    assert found.ring_starts.tolist() == [0, 5, 10, 12, 13, 14]
    np.testing.assert_array_equal(np.column_stack([found.lon_deg, found.lat_deg])[:10], SQUARE[::-1] + HOLE[::-1])


def test_areas_that_cross_themselves_are_repaired_or_left_out_and_counted(tmp_path, by):
    path = geojson(tmp_path / "a.geojson", [polygon(SQUARE), polygon(BOW_TIE), polygon(FLAT), None])
    layer = open_layer(path, index_dir=tmp_path)
    found = layer.features(*EVERYWHERE)
    assert layer.count == 4
    assert found.number.tolist() == ([1, 2] if by else [1])
    assert (layer.repaired, layer.dropped) == ((1, 2) if by else (0, 3))
    if by:
        # Two triangles.
        assert found.feature_starts.tolist() == [0, 1, 3]


def test_features_are_found_across_the_antimeridian(tmp_path, by):
    west = polygon([[179.5, 0], [179.9, 0], [179.9, 1], [179.5, 0]])
    east = polygon([[-179.9, 0], [-179.5, 0], [-179.5, 1], [-179.9, 0]])
    layer = open_layer(geojson(tmp_path / "a.geojson", [west, east]), index_dir=tmp_path)
    assert layer.features(179.0, -1.0, 181.0, 2.0).lon_deg.tolist()[4:] == pytest.approx([180.1, 180.5, 180.5, 180.1])
    assert layer.features(-181.0, -1.0, -179.0, 2.0).lon_deg.tolist()[:2] == pytest.approx([-180.5, -180.1])
    assert layer.features(-179.7, -1.0, -179.0, 2.0).number.tolist() == [2]
    assert layer.features(0.0, -1.0, 10.0, 2.0).number.tolist() == []
    assert layer.features(179.0, -1.0, 181.0, 2.0, least_m=1e6).number.tolist() == []


@pytest.mark.parametrize("module", ["osgeo", "pyogrio"])
def test_edges_of_a_plane_stay_straight_there(tmp_path, monkeypatch, module):
    pytest.importorskip(module)
    path = geopackage(
        tmp_path / "a.gpkg", ["POLYGON ((0 6000000, 0 6100000, 900000 6100000, 900000 6000000, 0 6000000))"], 32632
    )
    monkeypatch.setattr(reading, "backend", lambda: module)
    monkeypatch.setattr(layers, "backend", lambda: module)
    found = open_layer(path, index_dir=tmp_path / module).features(*EVERYWHERE)
    from pyproj import Transformer

    share = np.linspace(0.0, 1.0, 7)
    middle = np.outer(1 - share, [1, 1])[:, :1]
    lon, lat = found.lon_deg, found.lat_deg
    between = [middle * a[:-1] + (1 - middle) * a[1:] for a in (lon, lat)]
    x, y = Transformer.from_crs("OGC:CRS84", "EPSG:32632", always_xy=True).transform(*between)
    off = np.min([abs(x), abs(x - 9e5), abs(y - 6.0e6), abs(y - 6.1e6)], axis=0)
    assert off.max() < 2e-3
    assert found.lat_deg.size > 100


def test_two_readers_give_the_same_of_a_geopackage(tmp_path, monkeypatch):
    pytest.importorskip("pyogrio")
    shapes = ["POLYGON ((0 0, 0 9, 9 9, 9 0, 0 0))", "LINESTRING (0 0, 5 5)", "POINT (3 4)"]
    path = geopackage(tmp_path / "a.gpkg", shapes, 32632)
    found = []
    for module in ("osgeo", "pyogrio"):
        monkeypatch.setattr(reading, "backend", lambda module=module: module)
        found.append(open_layer(path, "roofs", index_dir=tmp_path / module).features(*EVERYWHERE, ["class"]))
    for name in ("number", "kind", "lon_deg", "lat_deg", "ring_starts", "part_starts", "feature_starts"):
        np.testing.assert_array_equal(getattr(found[0], name), getattr(found[1], name))
    assert found[0].values == found[1].values == {"class": ("field",) * 3}


def test_names_of_layers_and_fields(tmp_path):
    path = geopackage(tmp_path / "a:b.gpkg", ["POINT (3 4)"], 4326)
    assert parse_layer(path) == (path, "", "")
    assert parse_layer(f"{path}:roofs") == (path, "roofs", "")
    assert parse_layer(f"{path}:class") == (path, "", "class")
    assert parse_layer(f"{path}:roofs:class") == (path, "roofs", "class")
    with pytest.raises(InvalidInput, match="no such file"):
        parse_layer(r"C:\none.gpkg:roofs")


def test_a_changed_file_is_indexed_anew(tmp_path, by):
    path = geojson(tmp_path / "a.geojson", [polygon(SQUARE)])
    assert open_layer(path, index_dir=tmp_path / "index").count == 1
    geojson(tmp_path / "a.geojson", [polygon(SQUARE), polygon(SQUARE)])
    assert open_layer(path, index_dir=tmp_path / "index").count == 2


def test_values_are_counted_up_to_what_16_bits_hold(tmp_path, by, monkeypatch):
    values = [{"class": value} for value in ("a", None, "a", "b")]
    layer = open_layer(geojson(tmp_path / "a.geojson", [polygon(SQUARE)] * 4, values), index_dir=tmp_path)
    assert layer.values("class") == {"a": 2, None: 1, "b": 1}
    monkeypatch.setattr(layers, "MAX_VALUES", 2)
    with pytest.raises(InvalidInput, match="more than 2 distinct values"):
        layer.values("class")
    with pytest.raises(InvalidInput, match="has no field 'klass', but class"):
        layer.features(*EVERYWHERE, ["klass"])


def test_bad_files_get_one_line(tmp_path, by):
    bad = tmp_path / "bad.geojson"
    bad.write_text("{", encoding="utf-8")
    with pytest.raises(InvalidInput, match=r"bad\.geojson: "):
        open_layer(str(bad), index_dir=tmp_path)
    with pytest.raises(InvalidInput, match="cannot be read"):
        open_layer(str(tmp_path / "none.geojson"), index_dir=tmp_path)
    good = geojson(tmp_path / "good.geojson", [polygon(SQUARE)])
    with pytest.raises(InvalidInput, match="has no layer 'roofs', but good"):
        open_layer(good, "roofs", index_dir=tmp_path)
    with pytest.raises(InvalidInput, match="has no features with a geometry"):
        open_layer(geojson(tmp_path / "empty.geojson", [None]), index_dir=tmp_path)


def test_a_layer_without_reference_system_is_refused(tmp_path):
    path = geopackage(tmp_path / "a.gpkg", ["POINT (3 4)"], 0)
    with pytest.raises(InvalidInput, match="reference system"):
        open_layer(path, index_dir=tmp_path)


OSM = """<osm version="0.6">
<node id="1" version="1" lat="46.0" lon="7.0"/><node id="2" version="1" lat="46.0" lon="7.001"/>
<node id="3" version="1" lat="46.001" lon="7.001"/><node id="4" version="1" lat="46.001" lon="7.0"/>
<way id="5" version="1"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="4"/><nd ref="1"/>
<tag k="building:part" v="yes"/><tag k="min_height" v="3 m"/><tag k="roof:shape" v="gabled"/></way>
<way id="6" version="1"><nd ref="1"/><nd ref="3"/><tag k="highway" v="path"/></way>
</osm>"""


@pytest.mark.parametrize("module", ["osgeo", "pyogrio"])
def test_parts_of_buildings_are_areas_with_their_heights(tmp_path, monkeypatch, module):
    pytest.importorskip(module)
    monkeypatch.setattr(reading, "backend", lambda: module)
    monkeypatch.setattr(layers, "backend", lambda: module)
    path = tmp_path / "a.osm"
    path.write_text(OSM, encoding="utf-8")
    layer = open_layer(str(path), index_dir=tmp_path / "index")
    names = ("building:part", "min_height", "roof:shape", "height")
    found = layer.features(*EVERYWHERE, names)
    assert layer.attribution == "© OpenStreetMap contributors"
    assert found.kind.tolist() == [POLYGON]
    assert found.values == dict(zip(names, [("yes",), ("3 m",), ("gabled",), (None,)]))
    assert open_layer(str(path), "lines", index_dir=tmp_path / "index").features(*EVERYWHERE).kind.tolist() == [LINE]


def peak_bytes(path, count):
    """Most memory that indexing a number of points takes."""
    records = ((struct.pack("<BIdd", 1, 1, place % 180, 0.0), False, ("a" * 100,)) for place in range(count))
    tracemalloc.start()
    try:
        index.write_index(path, records, Reference("EPSG:4326"), {})
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_memory_does_not_grow_with_the_number_of_features(tmp_path, monkeypatch):
    monkeypatch.setattr(index, "_BATCH", 500)
    peak_bytes(tmp_path / "first.sqlite", 10)
    few, many = peak_bytes(tmp_path / "few.sqlite", 1_000), peak_bytes(tmp_path / "many.sqlite", 10_000)
    assert many < 1.2 * few


HELSINKI = Path(__file__).resolve().parents[4] / "shared" / "data" / "osm" / "helsinki.osm.pbf"


@pytest.mark.real_data
@pytest.mark.skipif(not HELSINKI.is_file(), reason="the extracts of ../shared/data/osm are not there")
def test_two_readers_give_the_same_of_openstreetmap(tmp_path, monkeypatch):
    pytest.importorskip("osgeo.ogr")
    pytest.importorskip("pyogrio")
    found = []
    for module in ("osgeo", "pyogrio"):
        monkeypatch.setattr(reading, "backend", lambda module=module: module)
        layer = open_layer(str(HELSINKI), index_dir=tmp_path / module)
        found.append((layer.count, layer.repaired, layer.dropped, layer.fields, layer.values("roof:shape")))
        assert layer.features(*EVERYWHERE).number.size == layer.count - layer.dropped
    assert found[0] == found[1]


def squares(path, count):
    """File of squares in a row, 0.01 degrees apart."""
    west = [7.0 + 0.01 * at for at in range(count)]
    shapes = [
        polygon([[x + a, 46.0 + b] for a, b in ((0, 0), (5e-3, 0), (5e-3, 5e-3), (0, 5e-3), (0, 0))]) for x in west
    ]
    return geojson(path, shapes)


def test_indexing_reports_features_and_can_be_cancelled(tmp_path, monkeypatch, by):
    path = squares(tmp_path / "roofs.geojson", 25)
    monkeypatch.setattr(index, "_BATCH", 10)
    said = []
    with pytest.raises(Cancelled), cancellable(lambda: len(said) == 3), reporting(said.append):
        open_layer(path, index_dir=tmp_path / "index")
    assert [*map(str, said)] == [
        "roofs.geojson: opening…",
        "roofs.geojson: 10 of 25 features read",
        "roofs.geojson: 20 of 25 features read",
    ]
    # Nothing is left of it, and the next one reads all.
    assert not list((tmp_path / "index").iterdir())
    said.clear()
    with reporting(said.append):
        layer = open_layer(path, index_dir=tmp_path / "index")
        assert layer.count == 25
        assert str(said[-1]) == "roofs.geojson: 25 of 25 features read"
        said.clear()
        open_layer(path, index_dir=tmp_path / "index")
    assert said == []
    with pytest.raises(Cancelled), cancellable(lambda: True):
        layer.values("n")


def test_threads_that_need_one_index_write_it_once(tmp_path, monkeypatch):
    path = squares(tmp_path / "roofs.geojson", 25)
    monkeypatch.setattr(index, "_BATCH", 5)
    written, said = [], []
    write = layers._write
    monkeypatch.setattr(layers, "_write", lambda *how: (written.append(how), write(*how)))
    with ThreadPoolExecutor(4) as pool:
        opened = list(pool.map(lambda _: open_layer(path, index_dir=tmp_path / "index"), range(4)))
    assert len(written) == 1
    assert all(one == opened[0] for one in opened)
    # One that waits for another's can be cancelled.
    with layers._INDEXING, pytest.raises(Cancelled), cancellable(lambda: True), reporting(said.append):
        open_layer(squares(tmp_path / "other.geojson", 3), index_dir=tmp_path / "index")
    assert said == []


def test_an_index_that_another_process_writes_is_waited_for(tmp_path):
    path = squares(tmp_path / "roofs.geojson", 3)
    made = open_layer(path, index_dir=tmp_path / "index").index
    made.unlink()
    partial = made.with_name(made.name + PARTIAL_ENDING)
    partial.write_bytes(b"half")
    # Locks of files exclude other files opened in the same process, too.
    with lock_tried(tmp_path / "index.lock"), pytest.raises(Cancelled), cancellable(lambda: True):
        open_layer(path, index_dir=tmp_path / "index")
    assert partial.read_bytes() == b"half"
    assert open_layer(path, index_dir=tmp_path / "index").index == made
    assert not partial.exists()


def test_files_of_other_programs_beside_a_layer_leave_its_index_as_it_is(tmp_path):
    path = squares(tmp_path / "roofs.geojson", 3)
    first = open_layer(path, index_dir=tmp_path / "index")
    (tmp_path / "roofs.qml").write_text("a style")
    assert open_layer(path, index_dir=tmp_path / "index").index == first.index
    (tmp_path / "roofs.prj").write_text("of a shapefile")
    assert open_layer(path, index_dir=tmp_path / "index").index != first.index


def test_features_in_a_box_are_counted_and_limited(tmp_path):
    layer = open_layer(squares(tmp_path / "roofs.geojson", 25), index_dir=tmp_path / "index")
    box = (7.02, 45.0, 7.101, 47.0)
    assert layer.count_in(*box) == 9
    assert layer.count_in(*(at + 360.0 * (side % 2 == 0) for side, at in enumerate(box))) == 9
    assert layer.features(*box).number.tolist() == list(range(3, 12))
    assert sorted(layer.features(*box, most=3).number.tolist()) == [6, 7, 8]
    assert len(layer.features(*box, most=0)) == 0
