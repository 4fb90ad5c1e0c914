"""From a name to a source: catalogue, template, file, with key, date, cache and size of tiles."""

from __future__ import annotations

import sqlite3
from collections import Counter
from dataclasses import replace
from importlib import import_module
from urllib.parse import urlsplit

import numpy as np
import pytest
from PIL import Image
from terrainav.core.errors import InvalidInput, SourceError
from terrainav.core.imagery.cache.tile_cache import TileCache
from terrainav.core.imagery.catalogue import add, check_policy, described, entry_named
from terrainav.core.imagery.entry import PIXELS, CatalogueEntry, shipped, under_provider
from terrainav.core.imagery.http.transport import Response
from terrainav.core.imagery.opening import (
    KINDS,
    NamedSource,
    SourceOptions,
    named_source,
    open_source,
    source_kind,
)
from terrainav.core.imagery.policy import TermsError
from terrainav.core.imagery.source import Window
from terrainav.core.imagery.staticmap import StaticMapSource
from terrainav.core.imagery.xyz import XYZSource

from tests.support.patterns import positions, to_bytes
from tests.support.tileserver import TileServer


@pytest.fixture(autouse=True)
def _nobody(monkeypatch, tmp_path):
    """No keys and no sources of the user who runs the tests."""
    for name in ("TERRAINAV_KEY", "TERRAINAV_GOOGLE_KEY", "TERRAINAV_GOOGLE_SECRET", "TERRAINAV_MAPBOX_KEY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))


def test_the_world_opens_with_its_seed():
    window = Window(14, 256 * 4000, 256 * 6000, 256, 256)
    one, two = (open_source("world", seed=seed) for seed in (7, 8))
    assert one.title == "Synthetic (offline)"
    assert one.fetch("satellite", window).shape == (256, 256, 3)
    assert (one.fetch("satellite", window) != two.fetch("satellite", window)).any()


@pytest.mark.parametrize(
    ("name", "template", "file"),
    [
        ("https://h/{z}/{x}/{y}.png", True, False),
        ("http://h/{z}/{x}/{y}.tif", True, False),
        ("ftp://h/{z}/{x}/{y}", True, False),
        ("{z}/{x}/{y}", True, False),
        ("tiles.example/{z}/{x}/{y}.png", True, False),
        ("x" * 5000, False, False),
        ("photos/ortho_{date}.tif", False, True),
        ("C:\\maps\\ortho.TIF", False, True),
        ("/vsicurl/https://h/cog.tif", False, True),
        ("https://h/a/cog.tif", False, True),
        ("HTTPS://h/cog.TIFF?v=3", False, True),
        ("https://h/ortho_{date}.tif", False, True),
        ("https://h/{z}.tif", True, False),
        ("https://h/tiles.tif/{z}/{x}/{y}", True, False),
        ("https://h/tile.png", True, False),
        ("tiles.mbtiles", False, True),
        ("wmts:https://h/c.xml#layer=a", False, False),
        ("WMS:https://h/wms?map={key}", False, False),
        ("usgs", False, False),
        ("wms", False, False),
    ],
)
def test_what_a_name_is_taken_for(name, template, file):
    assert (source_kind(name).name == "template", source_kind(name).is_file) == (template, file)


def test_a_file_that_is_there_is_known_for_one(tmp_path, monkeypatch):
    (tmp_path / "orthophoto").write_bytes(b"x")
    monkeypatch.chdir(tmp_path)
    assert not source_kind("orthophoto").is_file
    assert source_kind("./orthophoto").is_file
    assert source_kind(str(tmp_path / "orthophoto")).is_file
    with pytest.raises(InvalidInput, match="orthophoto"):
        open_source(str(tmp_path / "orthophoto"))


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("wrld", r"source 'wrld' is unknown: did you mean world\?"),
        ("google", "did you mean google-static"),
        ("zzz", "source 'zzz' is unknown: `terrainav sources` lists the names"),
        ("ortho.tif", r"ortho\.tif"),
        ("tiles.mbtiles", r"tiles\.mbtiles"),
        ("http://h/{z}/{x}", r"without \{y\}"),
        ("qgis:project", "can be captured inside QGIS only"),
        ("qgis:layer/a.tif", "can be captured inside QGIS only"),
    ],
)
def test_names_that_are_none(name, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InvalidInput, match=message) as raised:
        open_source(name)
    assert "\n" not in str(raised.value)


def test_a_name_that_is_close_to_one_of_the_user_s():
    add("ortho-town", described("https://h.example/{z}/{x}/{y}"))
    with pytest.raises(InvalidInput, match="did you mean ortho-town"):
        open_source("orto-town")


# --- files


def test_an_mbtiles_file_is_a_source(tmp_path):
    path = tmp_path / "town.mbtiles"
    with sqlite3.connect(path) as database:
        database.execute("CREATE TABLE metadata (name TEXT, value TEXT)")
        database.execute("CREATE TABLE tiles (zoom_level INT, tile_column INT, tile_row INT, tile_data BLOB)")
        database.executemany(
            "INSERT INTO metadata VALUES (?, ?)",
            [
                ("name", "Town"),
                ("format", "png"),
                ("minzoom", "5"),
                ("maxzoom", "5"),
                ("attribution", "© Town"),
            ],
        )
        picture = to_bytes(positions("satellite", 5, 9, 12, 256), "png")
        # Rows count from the south in MBTiles.
        database.execute("INSERT INTO tiles VALUES (5, 9, ?, ?)", (2**5 - 1 - 12, picture))
    database.close()
    source = open_source(str(path))
    assert source.attribution == "© Town"
    tile = source.fetch("", Window(5, 9 * 256, 12 * 256, 256, 256))
    assert (tile[..., :3] == positions("satellite", 5, 9, 12, 256)).all()
    source.close()
    with pytest.raises(InvalidInput, match=r"date '2020': .*town\.mbtiles has no dates to choose from"):
        open_source(str(path), date="2020")


@pytest.fixture
def dated_rasters(tmp_path):
    """Two photographs of one place on the grid of zoom 10, in Web Mercator; returns the path with {date}."""
    gdal = pytest.importorskip("osgeo.gdal")
    gdal.UseExceptions()
    half_m = np.pi * 6378137.0
    size_m = 2 * half_m / (256 << 10)
    for date, value in (("2020", 40), ("2022", 90)):
        png = tmp_path / f"photo_{date}.png"
        Image.fromarray(np.full((256, 256, 3), value, np.uint8)).save(png)
        west, north = 300 * 256 * size_m - half_m, half_m - 400 * 256 * size_m
        options = gdal.TranslateOptions(
            outputSRS="EPSG:3857", outputBounds=[west, north, west + 256 * size_m, north - 256 * size_m]
        )
        gdal.Translate(str(tmp_path / f"photo_{date}.tif"), str(png), options=options)
    return str(tmp_path / "photo_{date}.tif")


def test_a_raster_file_is_a_source_and_dates_choose_among_several(dated_rasters):
    window = Window(10, 300 * 256, 400 * 256, 256, 256)
    for date, value in (("2020", 40), ("2022", 90)):
        source = open_source(dated_rasters, date=date)
        assert source.date == date
        assert (source.fetch("", window)[..., :3] == value).all()
        source.close()
    with pytest.raises(InvalidInput):
        open_source(dated_rasters, date="2021")
    source = open_source(dated_rasters.replace("{date}", "2022"))
    assert (source.fetch("", window)[..., :3] == 90).all()
    source.close()


# --- keys


@pytest.mark.parametrize(
    ("name", "variable"),
    [("google-static", "TERRAINAV_GOOGLE_KEY"), ("mapbox-satellite", "TERRAINAV_MAPBOX_KEY")],
)
def test_a_missing_key_names_its_variable(name, variable, monkeypatch):
    with pytest.raises(SourceError, match=f"needs an API key: set the environment variable {variable}"):
        open_source(name)
    assert named_source(name).grid.max_zoom > 20
    monkeypatch.setenv(variable, "from-the-environment")
    source = open_source(name)
    assert "from-the-environment" not in repr(source)
    source.close()


def test_google_takes_key_secret_scale_and_address(monkeypatch):
    secret = "c2VjcmV0LXNlY3JldA=="
    with TileServer(key="k-123", secret=secret) as server:
        monkeypatch.setenv("TERRAINAV_GOOGLE_URL", server.static_map_url)
        monkeypatch.setenv("TERRAINAV_GOOGLE_SECRET", secret)
        source = open_source("google-static", key="k-123", tile_px=512)
        assert isinstance(source, StaticMapSource)
        assert source.fetch("satellite", Window(0, 0.0, 0.0, 512, 512)).shape == (512, 512, 3)
        source.close()


def test_the_key_of_a_template_is_the_environment_s(monkeypatch):
    with TileServer() as server:
        template = server.url_template + "?t={key}"
        with pytest.raises(SourceError, match="set the environment variable TERRAINAV_KEY"):
            open_source(template, named_by_user=True)
        monkeypatch.setenv("TERRAINAV_KEY", "k 1")
        source = open_source(template, tile_px=256, max_zoom=18, named_by_user=True)
        assert source.grid.max_zoom == 18
        tile = source.fetch("", Window(5, 256, 512, 256, 256))
        assert (tile == positions("satellite", 5, 1, 2, 256)).all()
        assert list(server.requests) == ["/5/1/2.png?t=k%201"]
        assert source.name == template
        source.close()


# --- dates


def test_dates():
    for name, asked, got in (
        ("nasa-gibs", "2023-02-28", "2023-02-28"),
        ("nasa-gibs", None, "2024-06-21"),
        ("esri-wayback", "2014-02-20", "2014-02-20"),
        ("ign-dated", "1950-1965", "1950-1965"),
        ("osm", None, ""),
        ("world", None, ""),
    ):
        source = open_source(name, date=asked)
        assert source.date == got
        source.close()
    cloudless = open_source("s2cloudless", date="2020")
    assert "Sentinel data 2020" in cloudless.attribution
    cloudless.close()


@pytest.mark.parametrize(
    ("name", "date", "says"),
    [
        ("nasa-gibs", "2023-02-30", "must be YYYY-MM-DD"),
        ("nasa-gibs", "2023", "must be YYYY-MM-DD"),
        ("nasa-gibs", "1999-01-01", "from 2015-11-24 to now"),
        ("s2cloudless", "2017", "must be YYYY, from 2018 to 2024"),
        ("esri-wayback", "2014-02-21", "such as 2014-02-20"),
        ("osm", "2020", "OpenStreetMap has no dates to choose from"),
        ("world", "2020", "has no dates to choose from"),
        ("google-static", "2020", "has no dates to choose from"),
        ("http://h/{z}/{x}/{y}", "2020", "h has no dates to choose from"),
    ],
)
def test_dates_that_are_refused(name, date, says):
    with pytest.raises(InvalidInput, match=f"date '{date}': .*{says}"):
        named_source(name, SourceOptions(date=date)).grid  # noqa: B018


def test_a_release_is_asked_for_by_its_number():
    source = named_source("esri-wayback").entry
    url = source.templates("2014-02-20")["satellite"].url(5, 3, 4)
    assert url.endswith("/MapServer/tile/10/5/4/3")


def test_the_date_of_a_template():
    with TileServer() as server:
        template = server.url + "/{z}/{x}/{y}.png?d={date}"
        source = open_source(template, date="2020-05-06")
        source.fetch("", Window(2, 256, 0, 256, 256))
        assert list(server.requests) == ["/2/1/0.png?d=2020-05-06"]
        assert (source.date, source.name) == ("2020-05-06", template)
        source.close()
        with pytest.raises(InvalidInput, match="has imagery of several dates"):
            open_source(template)


# --- tiles, terms, cache


def test_sizes_of_tiles_an_entry_does_not_have():
    with pytest.raises(InvalidInput, match="tiles of 512 px: OpenStreetMap has 256"):
        open_source("osm", tile_px=512)


@pytest.mark.parametrize(
    "template",
    [
        "https://tile.openstreetmap.org/{z}/{x}/{y}.png",
        "https://{s}.tile.openstreetmap.org/{z}/{x}/{y}.png",
        "https://TILE%2eopenstreetmap%2Eorg./{z}/{x}/{y}.png",
        "https://\N{FULLWIDTH LATIN SMALL LETTER T}ile\N{IDEOGRAPHIC FULL STOP}openstreetmap.org/{z}/{x}/{y}.png",
        "https://til{r}e.openstreetmap.org/{z}/{x}/{y}.png",
        "https://{map_type}.tile.openstreetmap.org/{z}/{x}/{y}.png",
        "https://services.arcgisonline.com/ArcGIS/rest/services/World_Topo_Map/MapServer/tile/{z}/{y}/{x}",
    ],
)
def test_terms_hold_for_a_provider_s_tiles_by_template_too(template):
    source = open_source(template)
    assert source.attribution
    with pytest.raises(SourceError):
        check_policy(source, 10_000, accept_terms=True)
    source.close()


class Answers:
    """A transport that sends the same tile from everywhere, and redirects from where it is told to."""

    def __init__(self, redirects):
        self.redirects, self.asked = redirects, Counter()
        self.tile = to_bytes(positions("satellite", 1, 0, 0, 256), "png")

    def get(self, url, headers=None, *, origin=""):
        host = urlsplit(url).hostname
        self.asked[host] += 1
        if host in self.redirects:
            return Response(302, {"location": url.replace(host, self.redirects[host], 1)}, b"")
        return Response(200, {}, self.tile)

    def close(self):
        pass


@pytest.mark.parametrize(
    ("template", "options", "redirects"),
    [
        ("https://{date}.openstreetmap.org/{z}/{x}/{y}.png", {"date": "tile"}, {}),
        ("https://own.example/{z}/{x}/{y}.png", {}, {"own.example": "tile.openstreetmap.org"}),
        (
            "https://own.example/{z}/{x}/{y}.png",
            {},
            {"own.example": "two.example", "two.example": "%74ile.openstreetmap.org"},
        ),
    ],
)
def test_terms_that_nothing_overrides_hold_for_the_host_that_is_asked_in_the_end(template, options, redirects):
    transport = Answers(redirects)
    source = XYZSource(template, transport=transport, **options)
    limit = entry_named("osm").policy.max_tiles
    for x in range(limit):
        source.fetch("", Window(12, x * 256, 0, 256, 256))
    with pytest.raises(SourceError, match=f"^OpenStreetMap: {limit + 1} requests, but at most {limit} are allowed"):
        source.fetch("", Window(12, limit * 256, 0, 256, 256))
    assert sum(times for host, times in transport.asked.items() if "openstreetmap" in host) == limit
    source.close()


def test_a_redirect_within_a_provider_is_no_further_tile():
    transport = Answers({"tile.osm.org": "tile.openstreetmap.org"})
    policy = replace(entry_named("osm").policy, requests_per_s=None)
    source = XYZSource("https://tile.osm.org/{z}/{x}/{y}.png", transport=transport, policy=policy)
    for x in range(policy.max_tiles):
        source.fetch("", Window(12, x * 256, 0, 256, 256))
    with pytest.raises(SourceError, match="are allowed without"):
        source.fetch("", Window(12, 0, 256, 256, 256))
    source.close()


def test_of_several_providers_the_terms_of_the_strictest_hold():
    known = {name: entry_named(name) for name in ("usgs", "osm", "pdok")}
    urls = {name: next(iter(entry.urls.values())) for name, entry in known.items()}
    data = {**described("https://own.example/{z}/{x}/{y}.png"), "map_types": list(urls), "urls": urls}
    entry = under_provider(CatalogueEntry.from_dict("own", data, user=True))
    assert entry.policy == known["osm"].policy


def test_a_template_of_several_map_types():
    with TileServer() as server:
        source = open_source(server.map_type_template)
        assert source.map_types == ("satellite", "roadmap", "terrain")
        tile = source.fetch("roadmap", Window(2, 256, 0, 256, 256))
        assert (tile == positions("roadmap", 2, 1, 0, 256)).all()
        source.close()


def test_with_a_cache_the_second_run_asks_for_nothing(tmp_path):
    cache = TileCache(tmp_path / "cache")
    window = Window(3, 256, 512, 256, 256)
    with TileServer() as server:
        for _ in range(2):
            source = open_source(server.url_template, cache=cache)
            assert (source.fetch("", window) == positions("satellite", 3, 1, 2, 256)).all()
            source.close()
        assert sum(server.requests.values()) == 1
        add("unstored", described(server.url_template, cache_allowed=False))
        for _ in range(2):
            source = open_source("unstored", cache=cache)
            source.fetch("", window)
            source.close()
        assert sum(server.requests.values()) == 3


@pytest.mark.parametrize("connections", [0, -1])
def test_connections_that_are_none_are_refused(connections):
    with pytest.raises(InvalidInput, match=f"^{connections} connections: must be 1 or more"):
        open_source("world", connections=connections)


# --- what a name tells before its source is opened


@pytest.mark.parametrize("entry", shipped(), ids=lambda entry: entry.name)
def test_a_named_source_says_what_the_opened_one_is(entry):
    named = named_source(entry.name, SourceOptions(key="k"))
    source = named.open()
    assert (named.title, named.map_types, named.grid, named.date, named.policy.terms) == (
        source.title,
        source.map_types,
        source.grid,
        source.date,
        source.policy.terms,
    )
    assert named.needs_key == (entry.key_env is not None)
    assert named.is_local == (entry.name == "world")
    source.close()


class Silent:
    """A transport that nobody may ask."""

    def get(self, url, headers=None, *, origin=""):
        raise AssertionError(url)

    def close(self):
        pass


@pytest.mark.parametrize(
    ("name", "kind", "is_local", "needs_key", "has_terms"),
    [
        ("world", "catalogue", True, False, True),
        ("google-static", "catalogue", False, True, True),
        ("https://h/{z}/{x}/{y}.png?k={key}", "template", False, True, True),
        ("https://h/{z}/{x}?k={key}", "template", False, True, None),
        ("wmts:https://h/c.xml?k={key}#layer=a", "service", False, True, False),
        ("WMS:https://h/wms", "service", False, False, False),
        ("there/is/none.tif", "raster", True, False, True),
        ("there/is/none.mbtiles", "mbtiles", True, False, True),
        ("/vsizip/there/is/none.zip/a.tif", "raster", True, False, True),
        ("/vsicurl/https://h/cog.tif", "raster", False, False, True),
        ("https://h/cog.tif", "raster", False, False, True),
        ("/vsizip//vsis3/bucket/a.zip/a.tif", "raster", False, False, True),
    ],
)
def test_what_the_text_tells_is_told_without_asking_anybody(name, kind, is_local, needs_key, has_terms):
    named = named_source(name, SourceOptions(transport=Silent()))
    assert (source_kind(name).name, named.is_local, named.needs_key) == (kind, is_local, needs_key)
    if has_terms is not None:
        assert (named.stated_policy is not None) == has_terms


def test_terms_that_refuse_say_so_in_parts():
    named = named_source("osm")
    with pytest.raises(TermsError) as raised:
        check_policy(named, 10_000, accept_terms=True)
    refused = raised.value
    assert (refused.title, refused.policy, refused.requests) == (named.title, named.policy, 10_000)
    assert not refused.can_agree
    assert "Synthetic (offline) [world]" in refused.instead
    with pytest.raises(TermsError) as raised:
        check_policy(named_source("google-static"), 10_000)
    assert raised.value.can_agree


def test_every_kind_is_where_the_tables_say():
    imagery = "terrainav.core.imagery"
    for kind in KINDS:
        assert issubclass(getattr(import_module(kind.module, imagery), kind.source), NamedSource)
    for module in PIXELS.values():
        assert callable(import_module(module, imagery).open_entry)
    assert {entry.kind for entry in shipped()} <= set(PIXELS)
