"""GeoJSON in other reference systems than WGS 84, against GDAL and PROJ."""

from __future__ import annotations

import json

import numpy as np
import pytest
from pyproj import CRS, Geod, Transformer
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.areas import geojson
from terrainav.core.mission.areas.files import load_area, load_no_fly
from terrainav.core.mission.areas.geojson import EDGE_TOLERANCE_M
from terrainav.core.poses.line import read_lines

from tests.support.command import command
from tests.support.thinning import sampled

run = pytest.fixture(command, name="run")

GEOD = Geod(ellps="WGS84")


def named(name):
    return {"type": "name", "properties": {"name": name}}


def written(path, crs, corners, kind="Polygon", inside=None):
    """File of one shape, with a crs where there is one, and maybe one inside its geometry."""
    geometry = {"type": kind, "coordinates": corners if kind == "LineString" else [corners]}
    if inside is not None:
        geometry["crs"] = inside
    feature = {"type": "Feature", "properties": {}, "geometry": geometry}
    member = {} if crs is None else {"crs": crs}
    path.write_text(json.dumps({"type": "FeatureCollection", **member, "features": [feature]}))
    return path


def square(x, y, size):
    return [[x, y], [x + size, y], [x + size, y + size], [x, y + size], [x, y]]


#: Systems, a place in each by its own coordinates with the easting first, and metres by which that place is off where
#: it is taken for WGS 84 (None for projected ones).
SYSTEMS = {
    "urn:ogc:def:crs:EPSG::4230": (8.5, 47.4, 129.0),  # ED50
    "EPSG:4267": (-90.0, 35.1, 13.6),  # NAD27
    "urn:ogc:def:crs:OGC:1.3:CRS27": (-90.0, 35.1, 13.6),
    "http://www.opengis.net/def/crs/EPSG/0/4277": (-1.0, 52.0, 115.6),  # OSGB36
    "urn:ogc:def:crs:EPSG::4807": (1.0, 54.0, None),  # grads from Paris
    "urn:ogc:def:crs:EPSG:6.9:25832": (462000.0, 5249900.0, None),
    "EPSG:2180": (500000.0, 500000.0, None),  # its own order is northing, easting
    "EPSG:27700": (450000.0, 250000.0, None),
    "EPSG:2274": (770000.0, 300000.0, None),  # US survey feet
    "urn:ogc:def:crs,crs:EPSG::27700,crs:EPSG::5701": (450000.0, 250000.0, None),
    "ESRI:102100": (946000.0, 6000000.0, None),
}


@pytest.mark.parametrize("name", sampled(SYSTEMS, 3))
def test_areas_are_where_gdal_puts_them(tmp_path, name):
    warp = pytest.importorskip("rasterio.warp", reason="the places are GDAL's, by rasterio")
    x, y, off_m = SYSTEMS[name]
    size = 0.01 if CRS(name).is_geographic else 200.0
    corners = square(x, y, size)
    path = written(tmp_path / "a.geojson", named(name), corners)
    # GDAL's own transformation, of a system that has the easting first.
    lon, lat = warp.transform(name, "EPSG:4326", *np.array(corners[:-1]).T.tolist())
    for found in (load_area(path), *load_no_fly(path)):
        (ring,) = found.rings
        got = np.array(ring)
        assert got.shape == (4, 2)
        assert np.max(GEOD.inv(got[:, 0], got[:, 1], lon, lat)[2]) < 1e-3
    if off_m is not None:
        assert GEOD.inv(*ring[0], x, y)[2] == pytest.approx(off_m, abs=2.0)


@pytest.mark.parametrize(
    "crs",
    [
        None,
        named("urn:ogc:def:crs:OGC:1.3:CRS84"),
        named("urn:ogc:def:crs:OGC::CRS84"),
        named("CRS84"),
        named("EPSG:4326"),
        named("urn:ogc:def:crs:EPSG::4326"),
        {"type": "EPSG", "properties": {"code": 4326}},
        {"type": "OGC", "properties": {"urn": "urn:ogc:def:crs:OGC:1.3:CRS84"}},
    ],
)
def test_wgs_84_by_any_name_is_as_it_stands_longitude_first(tmp_path, crs):
    corners = square(8.512345678901, 47.412345678901, 0.01)
    path = written(tmp_path / "a.geojson", crs, corners)
    assert load_area(path).rings == (tuple(map(tuple, corners[:-1])),)


@pytest.mark.parametrize(
    ("crs", "says"),
    [
        (
            {"type": "link", "properties": {"href": "http://127.0.0.1:9/crs", "type": "proj4"}},
            r"a link \(http",
        ),
        ({"type": "url", "properties": {"url": "http://127.0.0.1:9/crs"}}, r"a link \(http"),
        ({"type": "link"}, r"a link \(\)"),
        (None, "crs has no name"),
        ({}, "crs has no name"),
        ("EPSG:4230", "crs has no name"),
        ({"type": "name", "properties": {}}, "crs has no name"),
        ({"type": "name", "properties": {"name": 4230}}, "crs has no name"),
        ({"type": "EPSG", "properties": {"code": [4230]}}, "crs has no name"),
        (named(""), "crs '' is not a geographic"),
        (named("EPSG:99999999"), "crs 'EPSG:99999999' is not a geographic"),
        (named("USER:100000"), "crs 'USER:100000' is not a geographic"),
        (named("EPSG:4978"), "crs 'EPSG:4978' is not a geographic"),  # geocentric
        (named("EPSG:5703"), "crs 'EPSG:5703' is not a geographic"),  # heights alone
        (named("+proj=longlat +nadgrids=/etc/passwd"), r"crs '\+proj=longlat .*' is not a geographic"),
        (
            named("http://127.0.0.1:9/ref/epsg/4230/"),
            "crs 'http://127.0.0.1:9/ref/epsg/4230/' is not a geographic",
        ),
        (named("x" * 100_000), "crs 'x{80}' is not a geographic"),
    ],
)
def test_a_system_that_is_not_known_is_refused_by_its_name(tmp_path, crs, says):
    path = written(tmp_path / "a.geojson", None, square(8.5, 47.4, 0.01))
    path.write_text(json.dumps({"crs": crs, **json.loads(path.read_text())}))
    line = written(tmp_path / "l.geojson", None, [[8.5, 47.4, 50.0], [8.6, 47.4, 50.0]], "LineString")
    line.write_text(json.dumps({"crs": crs, **json.loads(line.read_text())}))
    for read, file in ((load_area, path), (load_no_fly, path), (lambda p: read_lines(str(p)), line)):
        with pytest.raises(InvalidInput, match=says) as refused:
            read(file)
        assert file.name in str(refused.value)
        assert "\n" not in str(refused.value)


def test_the_nearest_crs_holds_as_postgis_writes_one_into_each_geometry(tmp_path):
    corners = square(462000.0, 5249900.0, 200.0)
    whole = load_area(written(tmp_path / "a.geojson", named("EPSG:25832"), corners))
    inner = load_area(written(tmp_path / "b.geojson", None, corners, inside=named("EPSG:25832")))
    both = load_area(written(tmp_path / "c.geojson", named("EPSG:4230"), corners, inside=named("EPSG:25832")))
    assert whole == inner == both


def test_lines_are_transformed_and_keep_their_heights(tmp_path):
    corners = [[462000.0, 5249900.0, 80.0], [462500.0, 5249900.0, 120.0]]
    path = str(written(tmp_path / "l.geojson", named("EPSG:25832"), corners, "LineString"))
    lon, lat = Transformer.from_crs(25832, 4326, always_xy=True).transform(*np.array(corners)[:, :2].T)
    (found,) = read_lines(path)
    assert found == pytest.approx(np.stack([lat, lon, [80.0, 120.0]], axis=1), abs=1e-9)
    assert read_lines(path, 50.0)[0][:, 2].tolist() == [50.0, 50.0]


@pytest.mark.parametrize(
    ("name", "start", "end"),
    [
        ("EPSG:25832", (462000.0, 5249900.0), (492000.0, 5249900.0)),
        ("EPSG:3413", (-900000.0, -400000.0), (-700000.0, 200000.0)),
        ("EPSG:3832", (3300000.0, 100000.0), (3400000.0, 900000.0)),  # across the antimeridian
    ],
)
def test_sides_stay_where_they_are_in_their_system(tmp_path, name, start, end):
    # Heights stand for the share of the way, to find the place on the side that a place on the line is of.
    corners = [[*start, 0.0], [*end, 1000.0]]
    (line,) = read_lines(str(written(tmp_path / "l.geojson", named(name), corners, "LineString")))
    assert len(line) > 2
    share = np.linspace(0.0, 1.0, 5001)
    back = Transformer.from_crs(name, 4326, always_xy=True)
    lon, lat = back.transform(*(a + share * (b - a) for a, b in zip(start, end)))
    at = line[:, 2] / 1000.0
    flat_lat, flat_lon = (np.interp(share, at, np.unwrap(line[:, i], period=360.0)) for i in (0, 1))
    # Along the side there is no telling how far a place has come: across it alone.
    azimuth, _, off = GEOD.inv(lon, lat, flat_lon, flat_lat)
    way, _, _ = GEOD.inv(lon[:-1], lat[:-1], lon[1:], lat[1:])
    across = off[:-1] * np.abs(np.sin(np.radians(azimuth[:-1] - way)))
    assert across.max() <= EDGE_TOLERANCE_M


@pytest.mark.parametrize(
    ("name", "corners", "says"),
    [
        (
            "EPSG:25832",
            [[1e30, 5.2e6], [4.6e5, 5.2e6], [4.6e5, 5.3e6], [1e30, 5.2e6]],
            "corner 1e.30, 5.2e.06 is outside",
        ),
        (
            "ESRI:54052",
            square(-1.2e7, -3e6, 2e6),
            "(across the edge of the map|outside the domain) of .*ESRI:54052",
        ),
        ("EPSG:3995", square(-1e5, -1e5, 2e5), "polygon around a pole"),
        ("EPSG:25832", [[8.5, 47.4], ["x", 47.4], [8.5, 47.5]], "a corner is not longitude, latitude"),
    ],
)
def test_corners_that_a_system_does_not_have_are_refused(tmp_path, name, corners, says):
    with pytest.raises(InvalidInput, match=rf"^area file .*a\.geojson: .*{says}"):
        load_area(written(tmp_path / "a.geojson", named(name), corners))


def test_sides_are_divided_up_to_a_limit(tmp_path, monkeypatch):
    monkeypatch.setattr(geojson, "_MOST_CORNERS", 20)
    path = written(tmp_path / "a.geojson", named("EPSG:25832"), square(462000.0, 5249900.0, 50000.0))
    with pytest.raises(InvalidInput, match="too far; must be cut"):
        load_area(path)


def test_commands_take_areas_no_fly_areas_and_lines_in_other_systems(run, tmp_path):
    """ED50 of a place is 129 m from WGS 84 of the same numbers: what is planned moves by that."""
    corners = square(8.5, 47.4, 0.004)
    lons = []
    for crs, name in ((None, "w"), (named("urn:ogc:def:crs:EPSG::4230"), "e")):
        written(tmp_path / f"{name}.geojson", crs, corners)
        written(tmp_path / f"{name}n.geojson", crs, square(8.501, 47.401, 0.001))
        written(tmp_path / f"{name}l.geojson", crs, [[8.5, 47.4], [8.5, 47.404]], "LineString")
        asked = f"plan --area {name}.geojson --no-fly {name}n.geojson --agl 100 --output {name}p.csv"
        assert run(*asked.split()).returncode == 0
        asked = f"poses line {name}l.geojson --speed 12 --every-s 2 --agl 100 --output {name}l.csv"
        assert run(*asked.split()).returncode == 0
        header, *rows = (tmp_path / f"{name}l.csv").read_text().splitlines()
        lons.append(float(rows[0].split(",")[header.split(",").index("lon")]))
    assert lons[0] - lons[1] == pytest.approx(8.5 - 8.498893623, abs=1e-7)
    assert (tmp_path / "wp.csv").read_text() != (tmp_path / "ep.csv").read_text()
