"""Polygons from GeoJSON, KML and KMZ files."""

from __future__ import annotations

import io
import json
import zipfile

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.limits import MAX_POLYGONS
from terrainav.core.mission.areas import files as area_files
from terrainav.core.mission.areas.area import Polygon, Polygons
from terrainav.core.mission.areas.files import load_area, load_no_fly
from terrainav.core.mission.layout import parallels as rows
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.text import safe_xml

from tests.support.growth import PROPORTIONAL, growth

RING = [[-89.9, 35.16], [-89.82, 35.16], [-89.86, 35.11], [-89.9, 35.16]]


@pytest.mark.parametrize(
    "wrap",
    [
        lambda g: g,
        lambda g: {"type": "Feature", "properties": {}, "geometry": g},
        lambda g: {
            "type": "FeatureCollection",
            "features": [{"type": "Feature", "properties": None, "geometry": g}],
        },
    ],
)
def test_a_polygon_from_geojson(tmp_path, wrap):
    file = tmp_path / "area.geojson"
    file.write_text(json.dumps(wrap({"type": "Polygon", "coordinates": [RING]})))
    assert load_area(str(file)) == Polygon((tuple((x, y) for x, y in RING[:-1]),))


@pytest.mark.parametrize(
    "content",
    [
        "",
        "{}",
        "[1]",
        '{"type": "Point", "coordinates": [1, 2]}',
        '{"type": "Polygon", "coordinates": [[[1]]]}',
        '{"type": "FeatureCollection", "features": null}',
        '{"type": "FeatureCollection", "features": 5}',
        '{"type": "GeometryCollection", "geometries": null}',
        '{"type": "Polygon", "coordinates": null}',
        '{"type": "Polygon", "coordinates": {"0": 1}}',
        '{"type": "Polygon", "coordinates": [[{"a": 1}, {"b": 2}, {}]]}',
        '{"type": "MultiPolygon", "coordinates": null}',
        '{"type": "MultiPolygon", "coordinates": [5]}',
        '{"geometry": ' * 900 + "null" + "}" * 900,
        '{"geometry": ' * 100_000,
        "[" * 100_000,
    ],
)
def test_geojson_without_a_polygon_is_refused(tmp_path, content):
    file = tmp_path / "area.geojson"
    file.write_text(content)
    with pytest.raises(InvalidInput, match=r"area\.geojson"):
        load_area(str(file))


def test_a_ring_closed_twice_is_the_same_ring_when_it_is_read_again(tmp_path):
    file = tmp_path / "area.geojson"
    file.write_text(json.dumps({"type": "Polygon", "coordinates": [[*RING, RING[-1], RING[-1]]]}))
    area = load_area(str(file))
    assert area == Polygon((tuple((x, y) for x, y in RING[:-1]),))
    assert Polygon(area.rings) == area


SQUARES = [
    [[-89.9, 35.1], [-89.8, 35.1], [-89.8, 35.2], [-89.9, 35.2]],
    [[-89.7, 35.1], [-89.6, 35.1], [-89.6, 35.2], [-89.7, 35.2]],
    [[-89.5, 35.1], [-89.4, 35.1], [-89.4, 35.2], [-89.5, 35.2]],
]
HOLE = [[-89.86, 35.14], [-89.84, 35.14], [-89.84, 35.16]]
FIRST, SECOND, THIRD = (Polygon((tuple(map(tuple, ring)),)) for ring in SQUARES)
WITH_HOLE = Polygon((FIRST.rings[0], tuple(map(tuple, HOLE))))


def closed(ring):
    return [*ring, ring[0]]


def as_polygon(*rings):
    return {"type": "Polygon", "coordinates": [closed(ring) for ring in rings]}


def test_all_polygons_of_geojson_are_taken_wherever_they_are(tmp_path):
    inner = {
        "type": "GeometryCollection",
        "geometries": [
            {"type": "Point", "coordinates": [1, 2]},
            {"type": "MultiPolygon", "coordinates": [as_polygon(one)["coordinates"] for one in SQUARES[1:]]},
        ],
    }
    features = [
        {"type": "Feature", "geometry": as_polygon(SQUARES[0], HOLE), "properties": {}},
        {"type": "Feature", "geometry": None, "properties": None},
        {"type": "Feature", "geometry": inner, "properties": {}},
        {"type": "Feature", "geometry": as_polygon(SQUARES[1]), "properties": {}},
    ]
    path = tmp_path / "fields.json"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    assert load_area(path) == Polygons((WITH_HOLE, SECOND, THIRD))
    assert load_no_fly(path) == (WITH_HOLE, SECOND, THIRD)


def ring_text(ring, ending=",0"):
    return " ".join(f"{lon},{lat}{ending}" for lon, lat in closed(ring))


def kml_polygon(*rings, ending=",0"):
    outer, *holes = (f"<LinearRing><coordinates>{ring_text(ring, ending)}</coordinates></LinearRing>" for ring in rings)
    inner = "".join(f"<innerBoundaryIs>{hole}</innerBoundaryIs>" for hole in holes)
    return f"<Polygon><tessellate>1</tessellate><outerBoundaryIs>{outer}</outerBoundaryIs>{inner}</Polygon>"


def kml(*content, version="http://www.opengis.net/kml/2.2"):
    placemarks = "".join(f"<Placemark><name>field</name>{one}</Placemark>" for one in content)
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="{version}" xmlns:gx="http://www.google.com/kml/ext/2.2">'
        f"<Document><Style id='s'/><Folder>{placemarks}</Folder></Document></kml>"
    )


@pytest.mark.parametrize(
    "version", ["http://www.opengis.net/kml/2.2", "http://earth.google.com/kml/2.1"], ids=["2.2", "2.1"]
)
def test_polygons_of_google_earth(tmp_path, version):
    path = tmp_path / "fields.kml"
    several = f"<MultiGeometry>{kml_polygon(SQUARES[1])}<Point><coordinates>1,2</coordinates></Point></MultiGeometry>"
    path.write_text(kml(kml_polygon(SQUARES[0], HOLE), several, version=version))
    assert load_area(path) == Polygons((WITH_HOLE, SECOND))


def test_a_ring_that_stands_alone_is_a_polygon_and_a_line_is_none(tmp_path):
    path = tmp_path / "ring.kml"
    alone = f"<LinearRing><coordinates>{ring_text(SQUARES[2])}</coordinates></LinearRing>"
    line = f"<LineString><coordinates>{ring_text(SQUARES[0])}</coordinates></LineString>"
    path.write_text(kml(alone, line))
    assert load_area(path) == THIRD


def test_spaces_lines_and_missing_heights_are_read(tmp_path):
    path = tmp_path / "area.kml"
    corners = "\n".join(f"  {lon} , {lat}" for lon, lat in closed(SQUARES[0]))
    text = kml_polygon(SQUARES[0]).replace(ring_text(SQUARES[0]), corners)
    path.write_bytes(b"\xef\xbb\xbf" + kml(text).encode())
    assert load_area(path) == FIRST
    path.write_bytes(kml(text).replace("UTF-8", "UTF-16").encode("utf-16"))
    assert load_area(path) == FIRST


def zipped(path, **files):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            archive.writestr(name.replace("__", "/").replace("_", "."), text)
    return path


def test_the_main_file_of_a_kmz_is_taken(tmp_path):
    other, main = kml(kml_polygon(SQUARES[1])), kml(kml_polygon(SQUARES[0]))
    assert load_area(zipped(tmp_path / "a.kmz", files__other_kml=other, doc_kml=main)) == FIRST
    # As DJI Pilot writes it, and named as a zip.
    dji = main.replace(
        "<Placemark>", "<Placemark xmlns:wpml='http://www.dji.com/wpmz/1.0.2'><wpml:index>0</wpml:index>"
    )
    assert load_area(zipped(tmp_path / "b.zip", wpmz__res__a_png="", wpmz__template_kml=dji)) == FIRST


def test_kml_as_gdal_writes_it_is_read_as_it_was_put_in(tmp_path):
    ogr = pytest.importorskip("osgeo.ogr")
    from osgeo import osr

    driver = ogr.GetDriverByName("LIBKML") or ogr.GetDriverByName("KML")
    reference = osr.SpatialReference()
    reference.ImportFromEPSG(4326)
    reference.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    endings = ["kml", "kmz"] if driver.GetName() == "LIBKML" else ["kml"]
    for ending in endings:
        path = str(tmp_path / f"fields.{ending}")
        written = driver.CreateDataSource(path)
        layer = written.CreateLayer("fields", reference, ogr.wkbUnknown)
        for shape in (
            as_polygon(SQUARES[0], HOLE),
            {"type": "MultiPolygon", "coordinates": [as_polygon(one)["coordinates"] for one in SQUARES[1:]]},
            {"type": "Point", "coordinates": [1.0, 2.0]},
        ):
            feature = ogr.Feature(layer.GetLayerDefn())
            feature.SetGeometry(ogr.CreateGeometryFromJson(json.dumps(shape)))
            layer.CreateFeature(feature)
            feature = None
        layer = written = None
        found = load_area(path)
        assert isinstance(found, Polygons)
        for polygon, expected in zip(found.parts, (WITH_HOLE, SECOND, THIRD)):
            assert len(polygon.rings) == len(expected.rings)
            for ring, other in zip(polygon.rings, expected.rings):
                # Which corner comes first, and which way round they go, is the writer's own.
                assert {(round(x, 9), round(y, 9)) for x, y in ring} == set(other)


BROKEN = kml(
    "<Polygon><outerBoundaryIs><LinearRing><coordinates>1,2 3,4</coordinates></LinearRing></outerBoundaryIs></Polygon>"
)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("<kml><Polygon>", "cannot be read as KML"),
        ("<!DOCTYPE kml [<!ENTITY a 'b'>]><kml>&a;</kml>", "document type or entities"),
        (kml(), "holds no polygon; give a GeoJSON, KML or KMZ file"),
        (BROKEN, "polygon 1: polygon ring of 2 corners"),
        (BROKEN.replace("3,4", "3,x"), "corner '3,x' is not longitude,latitude"),
        (BROKEN.replace("3,4", "3"), "corner '3' is not longitude,latitude"),
        (BROKEN.replace("3,4", "3,95 5,6"), "polygon 1: latitude 95.0"),
        (BROKEN.replace("3,4", "nan,4 5,6"), "corner 'nan,4' is not longitude,latitude"),
        (b"\x89PNG", "cannot be read as GeoJSON, KML or KMZ"),
        (b"PK\x03\x04 and no more", "cannot be read as KMZ"),
    ],
)
def test_broken_files_are_refused_in_one_line(tmp_path, content, says):
    path = tmp_path / "broken.kml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(InvalidInput) as refused:
        load_area(path)
    assert str(refused.value).startswith(f"area file {path}: ")
    assert says in str(refused.value)
    assert "\n" not in str(refused.value)


def test_archives_beyond_the_limits_are_refused(tmp_path, monkeypatch):
    plain = zipped(tmp_path / "plain.kmz", readme_txt="no map")
    with pytest.raises(InvalidInput, match="is a zip without a KML file"):
        load_area(plain)
    monkeypatch.setattr(area_files, "MAX_CAPABILITIES_BYTES", 1 << 20)
    bomb = zipped(tmp_path / "bomb.kmz", doc_kml=kml() + " " * (1 << 21))
    assert bomb.stat().st_size < 10_000
    with pytest.raises(InvalidInput, match="its KML is larger than 1 MB"):
        load_area(bomb)
    monkeypatch.setattr(area_files, "MAX_KMZ_FILES", 0)
    with pytest.raises(InvalidInput, match="holds more than 0 files"):
        load_area(plain)


def test_an_archive_that_is_packed_in_another_way_is_refused(tmp_path):
    path = tmp_path / "area.kmz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_BZIP2) as archive:
        archive.writestr("doc.kml", kml(kml_polygon(SQUARES[0])))
    with pytest.raises(InvalidInput, match="is compressed in a way that KMZ does not use"):
        load_area(path)


def test_files_with_bytes_changed_are_read_or_refused_in_one_line(tmp_path):
    """Whatever becomes of a file on its way: an area, or one line of ours, and no other error."""
    path = tmp_path / "area"
    packed = zipped(tmp_path / "a.kmz", doc_kml=kml(kml_polygon(SQUARES[0], HOLE))).read_bytes()
    bits, said = np.random.default_rng(8), []
    for body in (packed, kml(kml_polygon(SQUARES[0])).encode(), json.dumps(as_polygon(SQUARES[0])).encode()):
        for _ in range(150):
            changed = bytearray(body)
            for at, value in zip(bits.integers(0, len(body), 3), bits.integers(0, 256, 3)):
                changed[at] = value
            path.write_bytes(changed)
            try:
                load_area(path)
            except InvalidInput as refused:
                said.append(str(refused))
    assert said
    assert not [line for line in said if "\n" in line]


def test_an_encrypted_archive_is_refused(tmp_path):
    body = bytearray(zipped(tmp_path / "a.kmz", doc_kml=kml(kml_polygon(SQUARES[0]))).read_bytes())
    # The flag of encryption, in the file's own head and in the directory.
    for mark, at in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        body[body.index(mark) + at] |= 1
    path = tmp_path / "locked.kmz"
    path.write_bytes(body)
    with zipfile.ZipFile(io.BytesIO(body)) as archive:
        assert archive.namelist() == ["doc.kml"]
    with pytest.raises(InvalidInput, match="cannot be read as KMZ"):
        load_area(path)


def test_without_lxml_it_is_said_how_to_get_it(tmp_path, monkeypatch):
    path = tmp_path / "area.kml"
    path.write_text(kml(kml_polygon(SQUARES[0])))

    def missing(name):
        raise ModuleNotFoundError(name)

    monkeypatch.setattr(safe_xml.importlib, "import_module", missing)
    with pytest.raises(OutputError, match=r"lxml, which reads KML, is not installed; get it with: pip install"):
        load_area(path)


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(InvalidInput, match=r"no-fly file .*missing\.kml: cannot be read"):
        load_no_fly(tmp_path / "missing.kml")


# --- rings that tell no ground


def ring(west, south, size):
    east, north = west + size, south + size
    return [[west, south], [east, south], [east, north], [west, north], [west, south]]


SQUARE = ring(-89.9, 35.1, 0.01)


@pytest.mark.parametrize("load", [load_area, load_no_fly])
@pytest.mark.parametrize(
    ("rings", "says"),
    [
        (
            [[[-89.9, 35.1], [-89.89, 35.11], [-89.89, 35.1], [-89.9, 35.11]]],
            r"sides cross at latitude 35\.105000, longitude -89\.895000: its sides may only touch$",
        ),
        (
            [SQUARE, ring(-89.893, 35.103, 0.006)],
            r"sides cross at latitude 35\.103000, longitude -89\.890000",
        ),
        ([[[179.99, 10], [-179.99, 10.02], [-179.99, 10], [179.99, 10.02]]], r"longitude -180\.000000"),
        ([SQUARE, ring(-89.8, 35.103, 0.003)], "hole 1 outside of it: holes lie inside the outer ring$"),
        ([SQUARE, ring(-89.898, 35.102, 0.003), ring(-89.95, 35.05, 0.1)], "hole 2 outside of it"),
        ([SQUARE, SQUARE], "polygon without ground: "),
        ([[[-89.9, 35.1], [-89.89, 35.1], [-89.88, 35.1]]], "polygon without ground: "),
        ([[[-180, -85], [180, -85], [180, 85], [-180, 85]]], "more than half the Earth apart"),
        (
            [[[0, 89.9], [90, 89.9], [180, 89.9], [-90, 89.9]]],
            "around a pole: its sides are straight in degrees",
        ),
    ],
)
def test_rings_that_tell_no_ground_are_refused_in_one_line(tmp_path, load, rings, says):
    path = tmp_path / "wrong.geojson"
    path.write_text(json.dumps({"type": "MultiPolygon", "coordinates": [[RING], rings]}))
    with pytest.raises(InvalidInput, match=says) as refused:
        load(path)
    assert "wrong.geojson: polygon 2: polygon" in str(refused.value)
    assert "\n" not in str(refused.value)


def test_rings_may_touch_each_other_and_themselves(tmp_path):
    """Corners on sides and on other corners, and a side that is gone twice, as editors leave them."""
    touching = [[-89.9, 35.1], [-89.897, 35.103], [-89.894, 35.1]]
    twice = [[0, 0], [1, 0], [1, 1], [2, 1], [1, 1], [0, 1]]
    on_corner = [
        [-89.8, 35.1],
        [-89.79, 35.1],
        [-89.795, 35.105],
        [-89.79, 35.11],
        [-89.8, 35.11],
        [-89.795, 35.105],
    ]
    path = tmp_path / "touching.geojson"
    path.write_text(json.dumps({"type": "MultiPolygon", "coordinates": [[SQUARE, touching], [twice], [on_corner]]}))
    area = load_area(path)
    assert len(area.parts) == 3
    assert area.parts[1].area_m2() == pytest.approx(Polygon((((0, 0), (1, 0), (1, 1), (0, 1)),)).area_m2())


def test_a_ring_through_a_pole_holds_the_ground_around_it(tmp_path):
    """As RFC 7946 asks for: the meridian of 180 is cut, and a side leads along the pole."""
    around = [[lon, 89.9] for lon in range(-180, 181, 60)]
    path = tmp_path / "cap.geojson"
    path.write_text(json.dumps({"type": "Polygon", "coordinates": [[*around, [180, 90], [-180, 90], around[0]]]}))
    cap = load_area(path)
    # On a sphere of the Earth's radius at the pole.
    assert cap.area_m2() == pytest.approx(np.pi * (6_399_594.0 * np.radians(0.1)) ** 2, rel=1e-3)
    again = Polygon(cap.rings)
    assert again == cap


@pytest.mark.parametrize(
    ("lat", "images"),
    [
        (1, r"45\d,\d{3},\d{3}"),
        pytest.param(85, r"2\d,\d{3},\d{3},\d{3}", marks=pytest.mark.thorough),
    ],
)
def test_a_polygon_of_far_too_many_rows_is_refused_before_they_are_followed(monkeypatch, lat, images):
    band = Polygon(
        (tuple((lon, -lat) for lon in range(-180, 181, 60)) + tuple((lon, lat) for lon in range(180, -181, -60)),)
    )
    monkeypatch.setattr(rows, "row_spans", lambda *_: pytest.fail("rows are followed"))
    with pytest.raises(InvalidInput, match=f"mission of {images} images: the limit is 10,000,000"):
        plan(Mission(band, 120.0), PixelGrid())


def test_spaces_around_corners_take_time_in_proportion(tmp_path):
    path = tmp_path / "spaces.kml"

    def read(spaces):
        gap = " " * spaces
        path.write_text(kml(f"<Polygon><outerBoundaryIs><LinearRing><coordinates>8,47{gap}9 , 47 9,48 8,47"
                            "</coordinates></LinearRing></outerBoundaryIs></Polygon>"))  # fmt: skip
        assert load_area(path).rings[0][:3] == ((8.0, 47.0), (9.0, 47.0), (9.0, 48.0))

    assert growth(read, 10_000) < PROPORTIONAL


def squares(corners):
    """GeoJSON of squares, by their south-western corners."""
    rings = ([[x, y], [x + 0.001, y], [x + 0.001, y + 0.001], [x, y + 0.001], [x, y]] for x, y in corners)
    shapes = [{"type": "Polygon", "coordinates": [ring]} for ring in rings]
    return json.dumps({"type": "GeometryCollection", "geometries": shapes})


def test_equal_polygons_are_checked_once(tmp_path, monkeypatch):
    path = tmp_path / "same.geojson"
    path.write_text(squares([(10.0, 45.0)] * 20_000))
    checked = []
    monkeypatch.setattr(area_files, "check_rings", checked.append)
    assert isinstance(load_area(path), Polygon)
    assert len(checked) == 1


def test_more_polygons_than_are_laid_out_are_refused(tmp_path):
    path = tmp_path / "many.geojson"
    path.write_text(squares((10.0 + one * 1e-9, 45.0) for one in range(MAX_POLYGONS + 1)))
    with pytest.raises(InvalidInput, match="holds more than 10,000 polygons"):
        load_area(path)


def test_sides_beside_each_other_without_measure_are_refused(tmp_path):
    """Each of 40,000 sides of a comb shares its longitudes with half of the others: 400 million pairs."""
    count = 20_000
    comb = [
        corner
        for one in range(count // 2)
        for corner in ([10.0, 45 + 2 * one / count], [11.0, 45 + 2 * one / count],
                       [11.0, 45 + (2 * one + 1) / count], [10.001, 45 + (2 * one + 1) / count])
    ]  # fmt: skip
    ring = [*comb, [9.0, 46.0], [9.0, 45.0], comb[0]]
    path = tmp_path / "comb.geojson"
    path.write_text(json.dumps({"type": "Polygon", "coordinates": [ring]}))
    with pytest.raises(InvalidInput, match=r"pairs of them share a longitude; 100,000,000 at most"):
        load_area(path)
