"""The catalogue: every entry states what it must, and terms are kept."""

from __future__ import annotations

import json

import pytest
from terrainav.core.errors import InvalidInput, SourceError
from terrainav.core.imagery.catalogue import alternatives, check_policy, entry_named, sources
from terrainav.core.imagery.entry import CatalogueEntry, serving, shipped
from terrainav.core.imagery.opening import open_source
from terrainav.core.imagery.policy import Policy
from terrainav.core.imagery.tiles import Template
from terrainav.core.resources import read_json

ENTRIES = shipped()
NAMES = [entry.name for entry in ENTRIES]
MAP_TYPES = {"satellite", "roadmap", "terrain"}
REQUIRED = {
    "world",
    "google-static",
    "osm",
    "esri-world-imagery",
    "esri-wayback",
    "nasa-gibs",
    "s2cloudless",
    "usgs",
    "mapbox-satellite",
} | {
    "swisstopo",
    "pdok",
    "ign",
    "ign-dated",
    "pdok-dated",
    "basemap-at",
}
# What every entry of resources/sources.json states in its own words, and what may be left to a default.
STATED = {
    "title": str,
    "kind": str,
    "area": str,
    "attribution": str,
    "licence": str,
    "bulk_allowed": str,
    "cache_allowed": bool,
    "min_zoom": int,
    "max_zoom": int,
    "native_zoom": int,
}
STATED_ONLINE = {
    "terms": str,
    "terms_url": str,
    "hosts": list,
    "max_connections": int,
    "requests_per_s": int,
}
OPTIONAL = {
    "map_types": list,
    "urls": dict,
    "tile_px": list,
    "key_env": str,
    "signing_env": str,
    "max_tiles": int,
    "dates": dict,
    "placeholder": dict,
    "bounds_deg": list,
}


@pytest.fixture(autouse=True)
def _nobody(monkeypatch, tmp_path):
    """No keys and no sources of the user who runs the tests."""
    for name in ("TERRAINAV_KEY", "TERRAINAV_GOOGLE_KEY", "TERRAINAV_GOOGLE_SECRET", "TERRAINAV_MAPBOX_KEY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path))


def test_the_catalogue_is_whole_and_the_world_comes_first():
    assert set(NAMES) >= REQUIRED
    assert NAMES[0] == "world"


@pytest.mark.parametrize("entry", ENTRIES, ids=NAMES)
def test_every_entry_states_its_policy(entry):
    stated = read_json("sources.json")[entry.name]
    needed = dict(STATED) if entry.kind == "world" else {**STATED, **STATED_ONLINE}
    assert set(needed) <= set(stated)
    for field, value in stated.items():
        assert isinstance(value, {**needed, **OPTIONAL}[field]), field
        assert value not in ("", [], {}), field
    assert entry.bulk_allowed in ("yes", "ask", "no")
    assert (entry.policy.max_tiles is None) == (entry.bulk_allowed == "yes")
    assert 0 <= entry.min_zoom <= entry.native_zoom <= entry.max_zoom
    assert set(entry.map_types) <= MAP_TYPES
    assert entry.map_types
    json.dumps(entry.to_dict())
    assert entry.to_dict()["bulk_allowed"] == entry.bulk_allowed
    assert entry.to_dict()["licence"] == entry.licence
    if entry.kind != "world":
        assert entry.policy.requests_per_s > 0
        assert entry.policy.max_connections > 0
        assert entry.policy.terms_url.startswith("https://")


@pytest.mark.parametrize("entry", ENTRIES, ids=NAMES)
def test_every_template_is_of_the_provider_whose_policy_it_is_under(entry):
    for size in entry.tile_px:
        entry.grid(size)
    for url in entry.urls.values():
        template = Template(url)
        assert url.startswith("https://")
        assert any(f".{template.host}".endswith(f".{own}") for own in entry.hosts)
        assert serving(template.host).hosts == entry.hosts
        assert ("r" in template.names) == (len(entry.tile_px) > 1)
    assert ("{date}" in "".join(entry.urls.values())) == (entry.dates is not None)


@pytest.mark.parametrize(
    "entry", [entry for entry in ENTRIES if entry.dates], ids=[entry.name for entry in ENTRIES if entry.dates]
)
def test_every_date_makes_an_address(entry):
    dates = [*entry.dates.values, entry.dates.default, entry.dates.first]
    for date in dates:
        for template in entry.templates(entry.date(date)).values():
            url = template.url(12, 2000, 1500, key="k")
            assert "{" not in url
            assert entry.dates.written(date).rpartition("=")[2] in url


def test_two_dates_are_two_addresses():
    for entry in ENTRIES:
        if entry.dates and entry.dates.values:
            urls = {entry.templates(date)["satellite"].text for date in entry.dates.values}
            assert len(urls) == len(entry.dates.values)


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


def test_names_in_any_case():
    assert entry_named("OSM").name == "osm"


def test_a_broken_file_of_the_user_is_in_the_way_of_unknown_names_only(tmp_path):
    (tmp_path / "sources.json").write_text("{")
    assert entry_named("osm").name == "osm"
    for ask in (sources, lambda: entry_named("mine")):
        with pytest.raises(InvalidInput, match=r"sources\.json: cannot be read as JSON"):
            ask()


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
    assert "sources that allow it: " in text
    assert text.endswith("Synthetic (offline) [world]")
    source.close()


def test_other_sources_are_named_that_show_the_same_of_the_same_place():
    vienna = (16.3, 48.1, 16.5, 48.3)
    assert alternatives(("satellite",), vienna) == (
        "basemap.at [basemap-at] (with --accept-terms)",
        "EOX Sentinel-2 cloudless [s2cloudless] (with --accept-terms)",
        "NASA GIBS, VIIRS true colour [nasa-gibs]",
        "Synthetic (offline) [world]",
    )
    memphis = (-90.0, 35.0, -89.8, 35.2)
    assert "USGS National Map [usgs]" in alternatives(("satellite",), memphis)
    assert "USGS National Map [usgs]" not in alternatives(("roadmap",), memphis)
    forbidden = {"osm", "esri-world-imagery", "mapbox-satellite"}
    assert not forbidden & {one.rpartition("[")[2].partition("]")[0] for one in alternatives((), None)}
    # As they are listed, they can be named.
    assert entry_named("synthetic (offline) [world]").name == "world"
    source = open_source("esri-world-imagery")
    with pytest.raises(SourceError, match=r"sources that allow it: basemap.at \[basemap-at\] \(with --accept-terms\)"):
        check_policy(source, 101, map_types=("satellite",), bounds_deg=vienna)
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
        {"bounds_deg": [10, 0, 0, 5]},
        {"bounds_deg": "world"},
        {"dates": {"kind": "day", "first": "2020-01-01", "default": "2021-01-01"}},
        {"title": ""},
        {"tile_px": [300]},
        {"levels": [1]},
    ],
    ids=str,
)
def test_an_entry_that_is_wrong_is_refused(change):
    data = {**read_json("sources.json")["osm"], **change}
    with pytest.raises(InvalidInput, match="catalogue entry 'x'"):
        CatalogueEntry.from_dict("x", data)
