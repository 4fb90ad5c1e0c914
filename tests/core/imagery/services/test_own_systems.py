"""WMTS and WMS in their own coordinate reference systems: whose pixels lie where, against GDAL and pyproj."""

from __future__ import annotations

import importlib
import json
import re
import warnings
from dataclasses import replace

import numpy as np
import pyproj
import pytest
from pyproj.database import query_crs_info
from pyproj.enums import PJType
from terrainav.core.capture.runner import capture
from terrainav.core.errors import InvalidInput, PartError, SourceError
from terrainav.core.imagery.cache.tile_cache import TileCache
from terrainav.core.imagery.catalogue import add
from terrainav.core.imagery.opening import DescribedSource, SourceOptions, named_source, open_source
from terrainav.core.imagery.source import Window
from terrainav.core.imagery.systems import epsg_code
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support import patterns, rasters
from tests.support.growth import PROPORTIONAL, growth
from tests.support.services import (
    ANTARCTIC,
    ARCTIC,
    DUTCH,
    EUROPEAN,
    SWISS,
    matrix,
    matrix_set,
    painted_by,
    png,
    wms_document,
    wmts_document,
    wmts_layer,
    xml,
)
from tests.support.thinning import named, sampled, thinned

gdal = pytest.importorskip("osgeo.gdal", reason="images and services are read by GDAL's Python module")
pytest.importorskip("owslib")
with warnings.catch_warnings():
    # It imports a module that Python is going to drop; that is for it to change.
    warnings.simplefilter("ignore", DeprecationWarning)
    importlib.import_module("owslib.wms")

#: Sets, with a place in them, a choice after #, the height of the flight, and the finest pixels.
PLACES = {
    "swisstopo": (SWISS, 46.95, 7.44, "", 100.0, 0.1),
    "swisstopo from 0.25 m on": (SWISS, 46.95, 7.44, "&tilematrix=27", 300.0, 0.25),
    "PDOK": (DUTCH, 52.09, 5.12, "", 40.0, 3440.64 / 2**16),
    "GIBS, Antarctica": (ANTARCTIC, -78.0, 166.0, "", 100_000.0, 256.0),
    "GIBS, the South Pole": (ANTARCTIC, -90.0, 0.0, "", 100_000.0, 256.0),
    "GIBS, Arctic": (ARCTIC, 82.5, -62.3, "", 20_000.0, 32.0),
    "northing first": (EUROPEAN, 48.2, 16.4, "", 800.0, 1.0),
}
QUAD = matrix_set("GoogleMapsCompatible", [matrix(str(zoom), zoom) for zoom in range(19)])


def serve(server, *sets, layer=None, texts=None, mercator=False, **more):
    """Serve tiles of sets as resources below their names; returns the source's name."""
    rest = f"{server.url}/t/{{TileMatrixSet}}/{{TileMatrix}}/{{TileRow}}/{{TileCol}}.png"
    links = {one.name: [] for one in sets} | ({"GoogleMapsCompatible": []} if mercator else {})
    written = layer or wmts_layer("ortho", links, resources=[("image/png", rest)], **more)
    document = wmts_document(
        [written.replace("TILES", rest)],
        [
            *(texts or [one.text(northing_first=one is EUROPEAN) for one in sets]),
            *([QUAD] if mercator else []),
        ],
    )
    by_name = {one.name: one for one in sets}

    def answer(path, query):
        found = re.fullmatch(r"/t/([^/]+)/([^/]+)/(\d+)/(\d+)\.png", path)
        if not found:
            return xml(document)
        name, level, row, column = found.groups()
        if name == "GoogleMapsCompatible":
            return png(patterns.positions("satellite", int(level), int(column), int(row), 256))
        one, place = by_name[name.replace("%3A", ":")], (int(column), int(row))
        if any(at >= count for at, count in zip(place, one.columns(level))):
            return 404, "text/plain", b"no such tile"
        return png(one.tile(level, *place))

    server.answer = answer
    return f"wmts:{server.url}/caps.xml#layer=ortho"


def about(epsg, lat, lon, half_m):
    """Ring about a place, whose corners are those of a square of the CRS."""
    to_crs = pyproj.Transformer.from_crs(4326, epsg, always_xy=True)
    x, y = to_crs.transform(lon, lat)
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    return tuple(to_crs.transform(x + right * half_m, y + up * half_m, direction="INVERSE") for right, up in corners)


def opened(path):
    """Pixels and geotransform of a picture, and its CRS's code, as GDAL reads them."""
    image = gdal.Open(str(path))
    return image.ReadAsArray(), image.GetGeoTransform(), image.GetSpatialRef().GetAuthorityCode(None)


@pytest.mark.parametrize(
    "place",
    thinned(named(PLACES), ("swisstopo", "GIBS, the South Pole", "GIBS, Arctic", "northing first")),
)
def test_images_of_a_wmts_are_its_own_pixels(place, server, tmp_path):
    tiles, lat, lon, choice, agl_m, finest = PLACES[place]
    name = serve(server, tiles) + choice
    source = open_source(name)
    assert source.grid.plane.crs == f"EPSG:{tiles.epsg}"
    assert source.grid.pixel_size(source.grid.native_zoom) == pytest.approx((finest, finest), rel=1e-9)
    ring = about(tiles.epsg, lat, lon, agl_m)
    area = Points(((lat, lon, agl_m),)) if "Pole" in place else Polygon((ring,))
    # From so far up a window is not what the camera would see; which pixels it has is all that counts here.
    exact = {"frame": "map", "accept_error": True}
    mission = Mission(area, agl_m, source=name, zoom=source.grid.native_zoom, **exact)
    worked_out = plan(mission, source.grid)
    assert worked_out.accuracy.picture.method.name == "map"
    result = capture(worked_out, source, tmp_path / "out")
    source.close()
    assert result.written == len(worked_out)
    assert not result.failed
    to_crs = pyproj.Transformer.from_crs(4326, tiles.epsg, always_xy=True)
    levels = {round(size, 9): level for level, size in tiles.resolutions.items()}
    for at, picture in enumerate(worked_out.names):
        shown, (left, width, _, top, _, height), code = opened(tmp_path / "out/satellite" / f"{picture}.tif")
        assert code == str(tiles.epsg)
        assert (width, -height) == pytest.approx((finest, finest), rel=1e-9)
        column, row = (left - tiles.west) / finest, (tiles.north - top) / finest
        assert abs(column - round(column)) < 1e-4
        assert abs(row - round(row)) < 1e-4
        # What the server has painted there, by its own pixels.
        columns, rows = patterns.decode_position(shown.transpose(1, 2, 0))
        assert (columns == (round(column) + np.arange(shown.shape[2])) % patterns.MODULUS).all()
        assert (rows == (round(row) + np.arange(shown.shape[1]))[:, np.newaxis] % patterns.MODULUS).all()
        # The middle of the picture is where the camera is above, by PROJ.
        x, y = to_crs.transform(worked_out.lon_deg[at], worked_out.lat_deg[at])
        middle = left + width * shown.shape[2] / 2, top + height * shown.shape[1] / 2
        assert np.hypot(middle[0] - x, middle[1] - y) < 2.0 * finest
    assert f"/t/{tiles.name.replace(':', '%3A')}/{levels[round(finest, 9)]}/" in server.asked[-1].replace(":", "%3A")


@pytest.mark.parametrize("place", PLACES)
def test_tiles_lie_where_gdal_finds_them(place, server, tmp_path, monkeypatch):
    # It keeps tiles in the current folder.
    monkeypatch.chdir(tmp_path)
    tiles, lat, lon, choice, _, _ = PLACES[place]
    source = open_source(serve(server, tiles) + choice)
    grid = source.grid
    x, y = pyproj.Transformer.from_crs(4326, tiles.epsg, always_xy=True).transform(lon, lat)
    for zoom in range(grid.min_zoom, grid.native_zoom + 1):
        pixel, _ = grid.pixel_size(zoom)
        (level,) = (name for name, size in tiles.resolutions.items() if abs(size / pixel - 1.0) < 1e-9)
        by_gdal = gdal.Open(f"WMTS:{server.url}/caps.xml,layer=ortho,tilematrix={level}")
        assert by_gdal.GetSpatialRef().GetAuthorityCode(None) == str(tiles.epsg)
        left, width, _, top, _, height = by_gdal.GetGeoTransform()
        assert (width, -height) == pytest.approx((pixel, pixel), rel=1e-9)
        # A tile about the place, as our grid has it, and its pixels in GDAL's own raster.
        column, row = (int((x - grid.plane.west) / pixel) // tiles.tile_px,
                       int((grid.plane.north - y) / pixel) // tiles.tile_px)  # fmt: skip
        window = Window(zoom, column * tiles.tile_px, row * tiles.tile_px, tiles.tile_px, tiles.tile_px)
        west, _, _, north = grid.edges(*(np.array(edge) for edge in window[1:]), zoom)
        first = round((float(west) - left) / pixel), round((top - float(north)) / pixel)
        inside = [slice(max(-at, 0), min(tiles.tile_px, end - at))
                  for at, end in zip(first, (by_gdal.RasterXSize, by_gdal.RasterYSize))]  # fmt: skip
        starts = [at + part.start for at, part in zip(first, inside)]
        sizes = [part.stop - part.start for part in inside]
        expected = by_gdal.ReadAsArray(*starts, *sizes)[:3]
        fetched = source.fetch("", window)[inside[1], inside[0], :3]
        assert (fetched.transpose(2, 0, 1) == expected).all()
    source.close()


# --- which system, which set


def crs_of(name, **options):
    """Coordinate reference system that a source's images are in."""
    return named_source(name, SourceOptions(**options)).grid.plane.crs


def test_web_mercator_is_taken_where_there_is_one_and_any_other_by_name(server):
    name = serve(server, DUTCH, EUROPEAN, mercator=True)
    assert crs_of(name) == "EPSG:3857"
    assert named_source(name).grid.plane.wraps
    for wanted in ("EPSG:3857", "EPSG:28992", "EPSG:3035"):
        assert crs_of(name, crs=wanted) == wanted
    assert crs_of(name + "&tilematrixset=inspire") == "EPSG:3035"
    with pytest.raises(InvalidInput) as refused:
        crs_of(name, crs="EPSG:2056")
    assert refused.value.field == "crs"
    assert str(refused.value) == (
        "coordinate reference system EPSG:2056: layer 'ortho' of 127.0.0.1 has EPSG:28992, EPSG:3035, EPSG:3857"
    )
    with pytest.raises(InvalidInput, match="EPSG:28992: Orthophotos has EPSG:3035") as refused:
        crs_of(name + "&tilematrixset=inspire", crs="EPSG:28992")
    assert refused.value.field == "crs"


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("EPSG:2056", "EPSG:2056"),
        ("epsg:2056", "EPSG:2056"),
        (" urn:ogc:def:crs:EPSG::2056 ", "EPSG:2056"),
        ("urn:ogc:def:crs:EPSG:6.3:28992", "EPSG:28992"),
        ("urn:ogc:def:crs:EPSG:6.18:3:28992", "EPSG:28992"),
        ("urn:x-ogc:def:crs:EPSG:28992", "EPSG:28992"),
        ("http://www.opengis.net/def/crs/EPSG/0/28992", "EPSG:28992"),
        ("http://www.opengis.net/gml/srs/epsg.xml#28992", "http://www.opengis.net/gml/srs/epsg.xml#28992"),
        ("urn:ogc:def:crs:EPSG:6.18:3:3857", "EPSG:3857"),
        ("urn:ogc:def:crs:ESRI::102100", "EPSG:3857"),
        ("urn:ogc:def:crs:EPSG::900913", "EPSG:3857"),
        ("3857", "EPSG:3857"),
        ("urn:ogc:def:crs:OGC:1.3:CRS84", "urn:ogc:def:crs:OGC:1.3:CRS84"),
        ("IGNF:LAMB93", "IGNF:LAMB93"),
    ],
)
def test_names_of_systems_in_documents(name, code):
    assert epsg_code(name) == code


def test_without_web_mercator_the_system_that_suits_the_layer_is_taken(server):
    for bounds, best in (
        ((3.2, 50.7, 7.3, 53.6), "EPSG:28992"),
        ((-16.1, 32.9, 40.2, 84.7), "EPSG:3035"),
        ((-180.0, -90.0, 180.0, -65.0), "EPSG:3031"),
    ):
        assert crs_of(serve(server, ANTARCTIC, DUTCH, EUROPEAN, bounds=bounds)) == best


@pytest.mark.parametrize(
    ("area", "best"),
    [
        (Box(81.0, -70.0, 80.0, -60.0), "EPSG:3413"),
        (Polygon((((-180.0, -90.0), (180.0, -90.0), (180.0, -89.9), (-180.0, -89.9)),)), "EPSG:3031"),
        (Points(((52.09, 5.12, 120.0),)), "EPSG:28992"),
        (Box(46.01, 7.0, 46.0, 7.01), "EPSG:3035"),
        (Box(-16.5, 179.995, -16.505, -179.995), "EPSG:28992"),
    ],
)
def test_of_systems_of_a_whole_world_the_one_that_suits_the_mission_is_taken(server, area, best):
    """Where none suits it, the layer decides."""
    name = serve(server, DUTCH, ARCTIC, ANTARCTIC, EUROPEAN, bounds=(3.2, 50.7, 7.3, 53.6))
    assert crs_of(name, area_deg=area.bounds.edges_deg) == best
    serve_wms(server, wms_layer(server, "EPSG:28992", "EPSG:3413", "EPSG:3031", "EPSG:3035", box=(3, 50, 7, 53)))
    assert crs_of(f"wms:{server.url}/ows#layers=ortho", area_deg=area.bounds.edges_deg) == best


def test_of_two_sets_of_a_system_the_finer_is_taken(server):
    coarse = replace(DUTCH, name="coarse", resolutions=dict(list(DUTCH.resolutions.items())[:5]))
    source = named_source(serve(server, coarse, DUTCH))
    assert source.grid.pixel_size(source.grid.native_zoom)[0] == pytest.approx(3440.64 / 2**16)
    assert "EPSG:28992/" in source.entry.urls[""]


@pytest.mark.parametrize("crs", ["EPSG:{}", "http://www.opengis.net/def/crs/EPSG/0/{}", "urn:ogc:def:crs:EPSG:9.9:{}"])
@pytest.mark.parametrize("written", ["by easting", "by northing"])
def test_corners_in_another_order_than_the_system_s_are_known_by_the_layer_s_ground(server, crs, written):
    text = EUROPEAN.text(northing_first=written == "by northing", crs=crs)
    plane = named_source(serve(server, EUROPEAN, texts=[text], bounds=(9.5, 46.4, 17.2, 49.0))).grid.plane
    assert (plane.west, plane.north) == (900_000.0, 5_500_000.0)


def test_a_set_in_feet(server):
    feet = replace(DUTCH, name="feet", epsg=2263, west=900_000.0, north=280_000.0, width=180_000.0, height=170_000.0,
                   resolutions={"a": 8.0, "b": 4.0, "c": 2.0}, unit_m=1200 / 3937)  # fmt: skip
    source = named_source(serve(server, feet, bounds=(-74.3, 40.5, -73.7, 40.9)))
    assert source.grid.pixel_size(source.grid.native_zoom) == pytest.approx((2.0, 2.0), rel=1e-12)
    assert source.grid.native_zoom - source.grid.min_zoom == 2


@pytest.mark.parametrize(
    ("choice", "says"),
    [
        ("&tilematrix=99", r"tilematrix '99': 127\.0\.0\.1 offers 0, 1, 2, 3, 4, 5, 6, 7 and 21 more"),
        ("&tilematrixset=none", "tilematrixset 'none': 127.0.0.1 offers 2056_28"),
    ],
)
def test_a_matrix_that_is_not_there(server, choice, says):
    with pytest.raises(InvalidInput, match=says):
        named_source(serve(server, SWISS) + choice).entry  # noqa: B018


def test_only_levels_that_halve_are_used(server):
    name = serve(server, SWISS)
    levels = {
        "": ["28"],
        "&tilematrix=27": ["27", "26", "25", "23"],
        "&tilematrix=22": ["22", "21", "20", "19"],
    }
    for choice, chain in levels.items():
        entry = named_source(name + choice).entry
        named = dict(entry.levels)
        assert [named.get(zoom, str(zoom)) for zoom in range(entry.max_zoom, entry.min_zoom - 1, -1)] == chain


# --- where tiles end


def test_beyond_the_limits_there_is_no_imagery_and_no_request(server):
    limits = dict.fromkeys(list(DUTCH.resolutions)[:4], (2, 3, 5, 6))
    rest = [("image/png", "TILES")]
    layer = wmts_layer("ortho", {DUTCH.name: limits}, resources=rest)
    source = open_source(serve(server, DUTCH, layer=layer))
    zoom = source.grid.native_zoom
    assert source.grid.pixel_size(zoom)[0] == pytest.approx(3440.64 / 8)
    tile = source.fetch("", Window(zoom, 2 * 256, 3 * 256, 256, 256))
    assert (tile == DUTCH.tile("03", 2, 3)).all()
    asked = len(server.asked)
    for column, row in ((1, 3), (2, 2), (6, 3), (2, 7), (7, 7), (-1, 3), (1 << zoom, 3)):
        with pytest.raises(PartError, match="beyond the"):
            source.fetch("", Window(zoom, column * 256, row * 256, 256, 256))
    assert len(server.asked) == asked
    # The ends are the imagery's, and a plan knows.
    side = 256.0 * 3440.64 / 8
    (left, top), _, (right, bottom), _ = source.grid.extent
    across = source.grid.plane.width
    assert [at * across / side for at in (left, top, right, bottom)] == pytest.approx([2, 3, 6, 7])
    source.close()
    lon, lat = pyproj.Transformer.from_crs(28992, 4326, always_xy=True).transform(
        DUTCH.west + 5.9 * side, DUTCH.north - 4.5 * side
    )
    ring = about(28992, lat, lon, 20_000.0)
    worked_out = plan(Mission(Polygon((ring,)), 5_000.0, source="x", frame="map", accept_error=True), source.grid)
    assert 0.0 < worked_out.imagery.share < 1.0
    assert worked_out.imagery.outside > 0


def test_a_matrix_ends_where_its_columns_do(server):
    source = open_source(serve(server, ANTARCTIC))
    zoom = source.grid.native_zoom
    assert source.fetch("", Window(zoom, 63 * 512, 63 * 512, 512, 512)).shape == (512, 512, 3)
    asked = len(server.asked)
    with pytest.raises(PartError, match="beyond the edge"):
        source.fetch("", Window(zoom, 64 * 512, 0, 512, 512))
    source = open_source(serve(server, SWISS))
    with pytest.raises(PartError, match="beyond the tiles of Orthophotos"):
        source.fetch("", Window(source.grid.native_zoom, 18_750 * 256, 0, 256, 256))
    assert [path for path in server.asked[asked:] if "/t/" in path] == []


# --- cache, catalogue, datasets


def test_tiles_of_two_systems_are_kept_apart(server, tmp_path):
    cache = TileCache(tmp_path)
    body = wms_layer(server, "EPSG:2056", "EPSG:21781")
    serve_wms(server, body)
    tiles = {}
    for crs in ("EPSG:2056", "EPSG:21781"):
        for _ in range(2):
            source = open_source(f"wms:{server.url}/ows#layers=ortho", crs=crs, cache=cache)
            zoom = source.grid.native_zoom
            column = int((2_600_000.0 - source.grid.plane.west) / source.grid.pixel_size(zoom)[0]) // 256
            tiles.setdefault(crs, []).append(source.fetch("", Window(zoom, column * 256, 256, 256, 256)))
            source.close()
    assert sum("GetMap" in path for path in server.asked) == 2
    assert sorted(file.title for file in cache.list()) == [
        "Orthophotos (EPSG:2056)",
        "Orthophotos (EPSG:21781)",
    ]
    # Of one address, whose document has moved the corner since, as well.
    one, moved = (replace(DUTCH, north=north) for north in (DUTCH.north, DUTCH.north + 512.0 * DUTCH.resolutions["16"]))
    shown = []
    for tiles in (one, moved):
        source = open_source(serve(server, tiles), cache=cache)
        shown.append(len(server.asked))
        source.fetch("", Window(source.grid.native_zoom, 256, 256, 256, 256))
        shown[-1] = len(server.asked) - shown[-1]
        source.close()
    assert shown == [1, 1]


def test_a_service_is_kept_by_a_name_with_its_system(server, tmp_path):
    name = serve(server, EUROPEAN, bounds=(9.5, 46.4, 17.2, 49.0))
    entry = named_source(name).entry
    data = json.loads(json.dumps(entry.to_data()))
    kept = add("austria", data, tmp_path)
    assert kept.plane == entry.plane
    assert kept.tile_limits == entry.tile_limits
    assert kept.levels == entry.levels
    assert kept.grid() == entry.grid()
    source = DescribedSource(kept, SourceOptions(crs="EPSG:3035")).open()
    tile = source.fetch("", Window(kept.native_zoom, 512, 768, 256, 256))
    assert (tile == EUROPEAN.tile("L12", 2, 3)).all()
    source.close()
    with pytest.raises(InvalidInput, match="EPSG:3857: Orthophotos has EPSG:3035"):
        DescribedSource(kept, SourceOptions(crs="EPSG:3857")).open()


@pytest.mark.parametrize(
    "plane",
    [
        {"crs": "EPSG:3857", "west": 0, "north": 0, "width": 1, "height": 1},
        {"crs": "EPSG:4326", "west": 0, "north": 0, "width": 1, "height": 1},
        {"crs": "nonsense", "west": 0, "north": 0, "width": 1, "height": 1},
        {"crs": 5, "west": 0, "north": 0, "width": 1, "height": 1},
        {"crs": "EPSG:2056", "west": 0, "north": 0, "width": 0, "height": 1},
        {"crs": "EPSG:2056", "west": "0", "north": 0, "width": 1, "height": 1},
        {"crs": "EPSG:2056", "west": 0, "north": 0, "width": 1},
        {"crs": "EPSG:2056", "west": 0, "north": 0, "width": 1, "height": 1, "more": 1},
    ],
)
def test_planes_that_are_none(plane, tmp_path):
    data = {"title": "t", "kind": "xyz", "min_zoom": 0, "max_zoom": 3, "native_zoom": 3}
    with pytest.raises(InvalidInput, match="catalogue entry 'mine': plane") as refused:
        add("mine", {**data, "urls": {"": "https://h.example/{z}/{x}/{y}"}, "plane": plane}, tmp_path)
    assert "\n" not in str(refused.value)


def test_templates_are_of_the_map_or_state_their_plane(tmp_path):
    data = {"title": "t", "kind": "xyz", "min_zoom": 0, "max_zoom": 20, "native_zoom": 20}
    plane = {"crs": "EPSG:25832", "west": 0.0, "north": 6e6, "width": 2.0**20, "height": 2.0**20}
    url = "https://h.example/wms?bbox={bbox}"
    kept = add("mine", {**data, "urls": {"": url}, "plane": plane}, tmp_path)
    assert kept.templates("")[""].url(2, 1, 1).endswith("bbox=262144.0,5475712.0,524288.0,5737856.0")
    with pytest.raises(InvalidInput, match=r"\{bbox\} is for a source that states a plane"):
        open_source(url)
    with pytest.raises(InvalidInput, match=r"\{bbox-epsg-3857\} is for tiles of the Web-Mercator map"):
        add("other", {**data, "urls": {"": "https://h.example/?{bbox-epsg-3857}"}, "plane": plane}, tmp_path)
    for name in ("https://h.example/{z}/{x}/{y}.png", "osm"):
        assert crs_of(name, crs="EPSG:3857") == "EPSG:3857"
        with pytest.raises(InvalidInput, match=r"coordinate reference system EPSG:25832: .* has EPSG:3857") as refused:
            crs_of(name, crs="EPSG:25832")
        assert refused.value.field == "crs"


def test_the_dataset_says_the_system_and_can_be_resumed(server, tmp_path):
    name = serve(server, DUTCH, mercator=True)
    mission = Mission(Points(((52.09, 5.12, 120.0), (52.091, 5.121, 120.0))), 120.0, source=name)
    for crs, stated in (("EPSG:28992", "EPSG:28992"), ("", None), ("EPSG:3857", "EPSG:3857")):
        source = open_source(name, crs=crs)
        worked_out = plan(mission.replace(crs=crs), source.grid)
        folder = tmp_path / (crs.replace(":", "") or "default")
        capture(worked_out, source, folder)
        file = folder / "mission.json"
        assert json.loads(file.read_text())["imagery"].get("crs") == stated
        assert capture(worked_out, source, folder, resume=True).skipped == 2
        source.close()
    assert (tmp_path / "default/mission.json").read_text() == mission.to_json()
    assert Mission.load(tmp_path / "EPSG28992/mission.json").imagery.crs == "EPSG:28992"


# --- WMS


def wms_layer(server, *systems, version="1.3.0", scale="", box=(5.9, 45.8, 10.5, 47.9)):
    """Capabilities of a layer that is offered in systems."""
    west, south, east, north = box
    new = version == "1.3.0"
    listed = "".join(f"<CRS>{one}</CRS>" if new else f"<SRS>{one}</SRS>" for one in systems)
    bounds = (
        f"<EX_GeographicBoundingBox><westBoundLongitude>{west}</westBoundLongitude><eastBoundLongitude>{east}"
        f"</eastBoundLongitude><southBoundLatitude>{south}</southBoundLatitude><northBoundLatitude>{north}"
        "</northBoundLatitude></EX_GeographicBoundingBox>"
        if new
        else f'<LatLonBoundingBox minx="{west}" miny="{south}" maxx="{east}" maxy="{north}"/>'
    )
    layer = f"<Layer><Name>ortho</Name><Title>Orthophotos</Title>{bounds}{scale}</Layer>"
    return wms_document(version, f"{server.url}/ows", f"<Layer><Title>All</Title>{listed}{layer}</Layer>")


def serve_wms(server, document, pixel=None, corner=(0.0, 0.0), **order):
    def answer(path, query):
        if query["REQUEST"] == "GetCapabilities":
            return xml(document)
        edges = [float(edge) for edge in query["BBOX"].split(",")]
        size = pixel or (edges[2] - edges[0]) / int(query["WIDTH"])
        return png(painted_by(query, size, *corner, **order))

    server.answer = answer


@pytest.mark.parametrize(
    ("epsg", "version", "by_northing", "lat", "lon", "tile_px"),
    sampled(
        [
            case if case[5] == tile_px else pytest.param(*case[:5], tile_px, marks=pytest.mark.thorough)
            for tile_px in (256, 512, 768)
            for case in (
                (2056, "1.3.0", False, 46.95, 7.44, 256),
                (2056, "1.1.1", False, 46.95, 7.44, 512),
                (2180, "1.3.0", True, 52.2, 21.0, 768),
                (2180, "1.1.1", False, 52.2, 21.0, 256),
                (31467, "1.3.0", True, 49.5, 8.5, 512),
                (3031, "1.3.0", False, -78.0, 166.0, 256),
                (32661, "1.3.0", True, 88.5, 12.0, 768),
                (2263, "1.3.0", False, 40.75, -73.98, 256),
            )
        ],
        3,
    ),
)
def test_images_of_a_wms_are_pixels_that_it_is_asked_for(
    server, tmp_path, epsg, version, by_northing, lat, lon, tile_px
):
    unit = pyproj.CRS(epsg).axis_info[0].unit_conversion_factor
    # So fine that the next finer pixels, of a quarter, are not drawn.
    scale = f"<MinScaleDenominator>{0.4 * unit / 0.00028}</MinScaleDenominator>" if version == "1.3.0" else ""
    pixel, corner = 0.5, (1000.0, -3000.0)
    document = wms_layer(server, f"EPSG:{epsg}", version=version, scale=scale, box=(lon - 1, lat - 1, lon + 1, lat + 1))
    serve_wms(server, document, pixel, corner, northing_first=by_northing)
    name = f"wms:{server.url}/ows#layers=ortho&version={version}"
    source = open_source(name, tile_px=tile_px)
    assert (source.grid.plane.crs, source.grid.tile_px) == (f"EPSG:{epsg}", tile_px)
    (zoom,) = (zoom for zoom in range(31) if source.grid.pixel_size(zoom)[0] == pixel)
    assert source.grid.native_zoom == zoom if scale else source.grid.pixel_size(source.grid.native_zoom)[0] == 2**-5
    agl_m = 120.0 * unit
    ring = about(epsg, lat, lon, agl_m / unit)
    worked_out = plan(Mission(Polygon((ring,)), agl_m, source=name, zoom=zoom), source.grid)
    assert worked_out.coverage.complete
    result = capture(worked_out, source, tmp_path / "out")
    source.close()
    assert result.written == len(worked_out) > 1
    to_crs = pyproj.Transformer.from_crs(4326, epsg, always_xy=True)
    for at, picture in enumerate(worked_out.names):
        shown, (left, width, _, top, _, height), code = opened(tmp_path / "out/satellite" / f"{picture}.tif")
        assert (code, width, height) == (str(epsg), pixel, -pixel)
        columns, rows = patterns.decode_position(shown.transpose(1, 2, 0))
        first = (left - corner[0]) / pixel, (corner[1] - top) / pixel
        assert (columns == (first[0] + np.arange(shown.shape[2])) % patterns.MODULUS).all()
        assert (rows == (first[1] + np.arange(shown.shape[1]))[:, np.newaxis] % patterns.MODULUS).all()
        x, y = to_crs.transform(worked_out.lon_deg[at], worked_out.lat_deg[at])
        middle = left + width * shown.shape[2] / 2, top + height * shown.shape[1] / 2
        assert np.hypot(middle[0] - x, middle[1] - y) < 2.0 * pixel
    assert f"{'CRS' if version == '1.3.0' else 'SRS'}=EPSG:{epsg}&" in server.asked[-1]


def test_the_system_of_a_wms(server):
    name = f"wms:{server.url}/ows#layers=ortho"
    serve_wms(
        server,
        wms_layer(server, "EPSG:4326", "EPSG:25832", "EPSG:2056", "EPSG:3857", "EPSG:2053", "AUTO:42001"),
    )
    assert crs_of(name) == "EPSG:3857"
    assert crs_of(name, crs="EPSG:25832") == "EPSG:25832"
    # Degrees, and axes to the west and the south, make no grid of images.
    for wanted in ("EPSG:4326", "EPSG:2053", "EPSG:31370", "EPSG:9999999"):
        with pytest.raises(InvalidInput) as refused:
            crs_of(name, crs=wanted)
        assert refused.value.field == "crs"
        assert str(refused.value) == (
            f"coordinate reference system {wanted}: layer 'ortho' of 127.0.0.1 has EPSG:3857, EPSG:2056, EPSG:25832"
        )
    serve_wms(server, wms_layer(server, "EPSG:4326", "EPSG:25832", "EPSG:2056", "EPSG:3035"))
    assert crs_of(name) == "EPSG:2056"
    with pytest.raises(
        InvalidInput, match=r"EPSG:3857: layer 'ortho' of 127\.0\.0\.1 has EPSG:2056, EPSG:3035, EPSG:25832"
    ):
        crs_of(name, crs="EPSG:3857")


def test_neighbouring_boxes_share_their_edges_to_the_last_digit(server):
    serve_wms(server, wms_layer(server, "EPSG:2056"))
    template = named_source(f"wms:{server.url}/ows#layers=ortho").entry.templates("")[""]
    boxes = {at: re.search("BBOX=([^&]*)", template.url(19, *at))[1].split(",") for at in ((9, 9), (10, 9), (9, 10))}
    assert boxes[9, 9][2] == boxes[10, 9][0]
    assert boxes[9, 9][1] == boxes[9, 10][3]
    assert all(float(edge) % 256 == 0 for edge in boxes[9, 9])


# --- documents that attack


def refusal(server, **changed):
    """What becomes of a set whose text is changed."""
    text = DUTCH.text()
    for tag, value in changed.items():
        text = re.sub(f"<{tag}>[^<]*</{tag}>", f"<{tag}>{value}</{tag}>", text)
    with pytest.raises((InvalidInput, SourceError)) as refused:
        named_source(serve(server, DUTCH, texts=[text])).entry  # noqa: B018
    assert "\n" not in str(refused.value)
    return str(refused.value)


@pytest.mark.parametrize(
    "changed",
    [
        {"ScaleDenominator": "0"},
        {"ScaleDenominator": "-5"},
        {"ScaleDenominator": "nan"},
        {"ScaleDenominator": "inf"},
        {"ScaleDenominator": "1e300"},
        {"TopLeftCorner": "nan nan"},
        {"TopLeftCorner": "1e300 0"},
        {"TopLeftCorner": "5"},
        {"MatrixWidth": "0"},
        {"MatrixHeight": "-1"},
        {"MatrixWidth": str(10**40)},
        {"MatrixWidth": "many"},
        {"TileWidth": "100"},
        {"TileWidth": str(256 * 10**6), "TileHeight": str(256 * 10**6)},
        {"TileHeight": "512"},
        {"ows:SupportedCRS": "urn:ogc:def:crs:EPSG::0"},
        {"ows:SupportedCRS": "urn:ogc:def:crs:EPSG::2053"},
        {"ows:SupportedCRS": "EPSG:" + "9" * 4000},
        {"ows:SupportedCRS": "+proj=utm +zone=32"},
    ],
)
def test_sets_that_make_no_sense_are_one_line(server, changed):
    assert len(refusal(server, **changed)) < 1000


@pytest.mark.thorough
def test_each_of_hundreds_of_systems_takes_as_long_as_one_of_a_few(server):
    codes = list(dict.fromkeys(info.code for info in query_crs_info("EPSG", PJType.PROJECTED_CRS)))

    def read(count):
        serve_wms(server, wms_layer(server, *(f"EPSG:{code}" for code in codes[:count])))
        named_source(f"wms:{server.url}/ows#layers=ortho").entry  # noqa: B018
        sets = [replace(DUTCH, name=f"s{code}", epsg=code) for code in codes[:count]]
        named_source(serve(server, *sets)).entry  # noqa: B018

    assert growth(read, 25) < PROPORTIONAL


@pytest.mark.thorough
def test_levels_without_number_are_read_in_time(server):
    def read(count):
        many = replace(DUTCH, resolutions={f"m{at}": 1.0 + at / 1e4 for at in range(count)})
        return named_source(serve(server, many)).entry

    assert growth(read, 2_500) < PROPORTIONAL
    assert [name for _, name in read(20_000).levels] == ["m10000", "m0"]


def test_a_tilted_picture_of_tiles_is_that_of_a_raster_of_the_same_pixels(server, tmp_path):
    """Through the whole of it, by tiles and by windows of a file; positions as smooth colours."""
    lat, lon, level, pixel = 52.09, 5.12, "14", 3440.64 / 2**14
    x, y = pyproj.Transformer.from_crs(4326, 28992, always_xy=True).transform(lon, lat)
    middle = [int(at / pixel) // 256 for at in (x - DUTCH.west, DUTCH.north - y)]

    def colours(column, row, size):
        steps = np.arange(size)
        return np.stack(
            [
                *np.meshgrid(*(rasters.triangle(at * 256 + steps + 0.5) for at in (column, row))),
                np.full((size, size), 90.0),
            ],
            axis=-1,
        ).astype(np.uint8)

    name = serve(server, DUTCH)
    documents = server.answer

    def answer(path, query):
        found = re.fullmatch(r"/t/[^/]+/(\d+)/(\d+)/(\d+)\.png", path)
        if not found:
            return documents(path, query)
        coarser, row, column = int(level) - int(found[1]), int(found[2]), int(found[3])
        fine = colours(column << coarser, row << coarser, 256 << coarser).astype(float)
        return png(fine.reshape(256, 1 << coarser, 256, 1 << coarser, 3).mean(axis=(1, 3)).round().astype(np.uint8))

    server.answer = answer
    first = [at - 8 for at in middle]
    west, north = DUTCH.west + first[0] * 256 * pixel, DUTCH.north - first[1] * 256 * pixel
    path = rasters.write(
        tmp_path / "same.tif",
        colours(*first, 16 * 256).transpose(2, 0, 1),
        (west, pixel, 0.0, north, 0.0, -pixel),
        28992,
    )
    shown = []
    for source_name in (f"{name}&tilematrix={level}", str(path)):
        source = open_source(source_name)
        mission = Mission(Points(((lat, lon, 120.0),)), 120.0, tilt_deg=35.0, yaw_deg=20.0, source=source_name)
        worked_out = plan(mission, source.grid)
        assert worked_out.accuracy.picture.method.name == "camera"
        assert source.grid.pixel_size(worked_out.zoom)[0] == pytest.approx(pixel)
        folder = tmp_path / f"out{len(shown)}"
        assert capture(worked_out, source, folder).written == 1
        source.close()
        (picture,) = (folder / "satellite").glob("*.tif")
        shown.append(gdal.Open(str(picture)).ReadAsArray().astype(int))
    # Grey levels that lie between two may be rounded either way; four of them are a pixel.
    assert np.abs(shown[0] - shown[1]).max() <= 1
    assert abs((shown[0] - shown[1]).mean()) < 0.2
