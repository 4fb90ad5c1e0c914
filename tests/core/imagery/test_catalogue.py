from __future__ import annotations

import json

import pytest
from terrainav.core.errors import InvalidInput, SourceError
from terrainav.core.imagery.catalogue import (
    CatalogueEntry,
    Dates,
    check_policy,
    entry_named,
    open_source,
    sources,
)
from terrainav.core.imagery.policy import Policy
from terrainav.core.imagery.source import Window
from terrainav.core.imagery.staticmap import StaticMapSource
from terrainav.core.imagery.template import Template
from terrainav.core.resources import read_json

from tests.support.patterns import positions
from tests.support.tileserver import TileServer

ENTRIES = sources()
NAMES = [entry.name for entry in ENTRIES]
MAP_TYPES = {"satellite", "roadmap", "terrain"}
REQUIRED = {
    "world",
    "google-static",
    "osm",
    "esri-world-imagery",
    "nasa-gibs",
    "s2cloudless",
    "usgs",
    "mapbox-satellite",
} | {
    "swisstopo",
    "pdok",
    "ign",
    "basemap-at",
}


@pytest.fixture(autouse=True)
def _no_keys(monkeypatch):
    for name in ("TERRAINAV_KEY", "TERRAINAV_GOOGLE_KEY", "TERRAINAV_GOOGLE_SECRET", "TERRAINAV_MAPBOX_KEY"):
        monkeypatch.delenv(name, raising=False)


def test_the_catalogue_is_whole_and_the_world_comes_first():
    assert set(NAMES) >= REQUIRED
    assert NAMES[0] == "world"


@pytest.mark.parametrize("entry", ENTRIES, ids=NAMES)
def test_every_entry_states_its_policy(entry):
    stated = read_json("sources.json")[entry.name]
    assert {
        "attribution",
        "licence",
        "bulk_allowed",
        "cache_allowed",
        "min_zoom",
        "max_zoom",
        "native_zoom",
    } <= set(stated)
    assert set(entry.map_types) <= MAP_TYPES
    assert entry.map_types
    if entry.kind != "world":
        assert {"terms", "terms_url", "max_connections", "requests_per_s", "hosts"} <= set(stated)
        assert entry.area
    for size in entry.tile_px:
        entry.grid(size)
    for url in entry.urls.values():
        template = Template(url)
        assert url.startswith("https://")
        assert entry.serves(template.host)
        assert ("r" in template.names) == (len(entry.tile_px) > 1)
    json.dumps(entry.to_dict())
    assert entry.to_dict()["bulk_allowed"] == entry.bulk_allowed
    assert entry.to_dict()["licence"] == entry.licence


@pytest.mark.parametrize("entry", [entry for entry in ENTRIES if entry.kind != "world"], ids=NAMES[1:])
def test_every_entry_opens(entry):
    source = open_source(entry.name, key="a-key")
    assert (source.name, source.title, source.map_types) == (entry.name, entry.title, entry.map_types)
    assert "{" not in source.attribution
    assert (source.grid.min_zoom, source.grid.max_zoom) == (entry.min_zoom, entry.max_zoom)
    source.close()


def test_undocumented_endpoints_are_not_shipped():
    hosts = " ".join(Template(url).host for entry in ENTRIES for url in entry.urls.values())
    assert "google" not in hosts
    assert "virtualearth" not in hosts


def test_the_world_opens_with_its_seed():
    source = open_source("world", seed=7)
    assert source.title == "Synthetic (offline)"
    assert source.fetch("satellite", Window(3, 256, 512, 256, 256)).shape == (256, 256, 3)


def test_names_in_any_case():
    assert entry_named("OSM").name == "osm"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("wrld", r"source 'wrld' is unknown: did you mean world\?"),
        ("google", "did you mean google-static"),
        ("zzz", "source 'zzz' is unknown: `terrainav sources` lists the names"),
        ("ortho.tif", "source ortho.tif: raster files are not supported by this version"),
        ("http://h/{z}/{x}", r"without \{y\}"),
    ],
)
def test_unknown_sources(name, message):
    with pytest.raises(InvalidInput, match=message) as raised:
        open_source(name)
    assert "\n" not in str(raised.value)


def test_a_file_that_is_there_is_known_for_one(tmp_path):
    (tmp_path / "orthophoto").write_bytes(b"x")
    with pytest.raises(InvalidInput, match="raster files are not supported"):
        open_source(str(tmp_path / "orthophoto"))


@pytest.mark.parametrize(
    ("name", "variable"),
    [("google-static", "TERRAINAV_GOOGLE_KEY"), ("mapbox-satellite", "TERRAINAV_MAPBOX_KEY")],
)
def test_a_missing_key_names_its_variable(name, variable, monkeypatch):
    with pytest.raises(SourceError, match=f"needs an API key: set the environment variable {variable}"):
        open_source(name)
    open_source(name, plan_only=True).close()
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
    monkeypatch.setenv("TERRAINAV_KEY", "k 1")
    with TileServer() as server:
        source = open_source(server.url_template + "?t={key}", tile_px=256, max_zoom=18)
        assert source.grid.max_zoom == 18
        tile = source.fetch("", Window(5, 256, 512, 256, 256))
        assert (tile == positions("satellite", 5, 1, 2, 256)).all()
        assert list(server.requests) == ["/5/1/2.png?t=k%201"]
        assert source.name == server.url_template + "?t={key}"
        source.close()


def test_dates():
    source = open_source("nasa-gibs", date="2023-02-28")
    assert source.date == "2023-02-28"
    source.close()
    cloudless = open_source("s2cloudless", date="2020")
    assert "Sentinel data 2020" in cloudless.attribution
    cloudless.close()
    for name, date in [
        ("nasa-gibs", "2023-02-30"),
        ("nasa-gibs", "2023"),
        ("nasa-gibs", "1999-01-01"),
        ("s2cloudless", "2017"),
    ]:
        with pytest.raises(InvalidInput, match=f"date '{date}': must be YYYY"):
            open_source(name, date=date)
    with pytest.raises(InvalidInput, match="OpenStreetMap has no dates to choose from"):
        open_source("osm", date="2020")
    with pytest.raises(InvalidInput):
        Dates("day", first="2020-01-01", default="2019-01-01")


def test_sizes_of_tiles_an_entry_does_not_have():
    with pytest.raises(InvalidInput, match="tiles of 512 px: OpenStreetMap has 256"):
        open_source("osm", tile_px=512)


# --- terms


def test_no_means_no():
    source = open_source("osm")
    check_policy(source, source.policy.max_tiles)
    with pytest.raises(SourceError) as raised:
        check_policy(source, source.policy.max_tiles + 1, accept_terms=True)
    text = str(raised.value)
    assert "\n" not in text
    assert source.policy.terms in text
    assert source.policy.terms_url in text
    assert "usgs" in text
    assert "world" in text
    source.close()


def test_ask_means_ask():
    source = open_source("swisstopo")
    check_policy(source, 1)
    check_policy(source, 100_000, accept_terms=True)
    with pytest.raises(SourceError, match="--accept-terms"):
        check_policy(source, 100_000)
    source.close()


@pytest.mark.parametrize("name", ["usgs", "world"])
def test_yes_means_yes(name):
    check_policy(open_source(name), 10_000_000)


def test_a_source_without_terms_is_free():
    source = open_source("http://127.0.0.1:9/{z}/{x}/{y}.png")
    check_policy(source, 10_000_000)
    source.close()


@pytest.mark.parametrize(
    "template",
    [
        "https://tile.openstreetmap.org/{z}/{x}/{y}.png",
        "https://{s}.tile.openstreetmap.org/{z}/{x}/{y}.png",
        "https://services.arcgisonline.com/ArcGIS/rest/services/World_Topo_Map/MapServer/tile/{z}/{y}/{x}",
    ],
)
def test_terms_hold_for_a_provider_s_tiles_by_template_too(template):
    source = open_source(template)
    assert source.attribution
    with pytest.raises(SourceError):
        check_policy(source, 10_000, accept_terms=True)
    source.close()


def test_connections_are_those_the_provider_allows():
    assert entry_named("osm").policy.connections(16) == 2
    assert Policy().connections(16) == 16


@pytest.mark.parametrize(
    "options",
    [
        {"bulk_allowed": "maybe"},
        {"bulk_allowed": "no"},
        {"max_tiles": 0},
        {"max_connections": -1},
        {"requests_per_s": 0.0},
    ],
)
def test_policies_that_say_nothing_sensible(options):
    with pytest.raises(InvalidInput):
        Policy(**options)


@pytest.mark.parametrize(
    "change",
    [
        {"colour": "blue"},
        {"kind": "wms"},
        {"urls": {}},
        {"attribution": ""},
        {"terms_url": "http://insecure"},
        {"urls": {"roadmap": "https://h/{date}/{z}/{x}/{y}"}},
        {"urls": {"roadmap": "https://h/{z}/{x}/{y}?k={key}"}},
        {"placeholder": {"colour": 1}},
    ],
    ids=str,
)
def test_an_entry_that_is_wrong_is_refused(change):
    data = {**read_json("sources.json")["osm"], **change}
    with pytest.raises(InvalidInput, match="catalogue entry 'x'"):
        CatalogueEntry.from_dict("x", data)
