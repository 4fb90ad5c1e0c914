"""A user's own sources: kept in a file, under their provider's terms, without a key."""

from __future__ import annotations

import dataclasses
import json

import pytest
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.imagery.catalogue import (
    add,
    described,
    entry_named,
    remove,
    shelf,
    sources,
    user_sources,
)
from terrainav.core.imagery.entry import CatalogueEntry
from terrainav.core.imagery.opening import open_source
from terrainav.core.imagery.policy import Policy
from terrainav.core.imagery.source import Window

from tests.support.errors import refused
from tests.support.patterns import positions
from tests.support.tileserver import TileServer


@pytest.fixture(autouse=True)
def folder(monkeypatch, tmp_path):
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))
    monkeypatch.delenv("TERRAINAV_KEY", raising=False)
    return tmp_path / "config"


def test_a_source_is_kept_listed_opened_and_forgotten(folder):
    with TileServer() as server:
        data = described(
            server.url_template,
            title="Mine",
            attribution="© Me",
            licence="CC0",
            max_zoom=17,
            max_connections=3,
        )
        added = add("my-tiles", data)
        (listed,) = [entry for entry in sources() if entry.user]
        assert listed == added == entry_named("My-Tiles")
        assert [entry.name for entry in sources()][-1] == "my-tiles"
        source = open_source("my-tiles")
        assert (source.name, source.title, source.attribution) == ("my-tiles", "Mine", "© Me")
        assert (source.grid.max_zoom, source.policy.max_connections) == (17, 3)
        assert (source.fetch("", Window(3, 256, 512, 256, 256)) == positions("satellite", 3, 1, 2, 256)).all()
        source.close()
    remove("my-tiles")
    assert user_sources() == ()
    assert not [path for path in folder.iterdir() if path.name != "sources.json"]


@pytest.mark.parametrize("name", ["", "Mine", "-mine", "my tiles", "a/b", "x" * 65, "ümlaut", "a.tif"])
def test_names_that_are_refused(name):
    with pytest.raises(InvalidInput, match="must be lower-case letters, digits, hyphens and underscores"):
        add(name, described("https://h.example/{z}/{x}/{y}"))


def test_names_that_are_taken():
    with pytest.raises(InvalidInput, match="is one of the catalogue's"):
        add("osm", described("https://h.example/{z}/{x}/{y}"))
    add("mine", described("https://h.example/{z}/{x}/{y}"))
    with pytest.raises(InvalidInput, match="is taken"):
        add("mine", described("https://other.example/{z}/{x}/{y}"))
    assert user_sources()[0].title == "h.example"


def test_what_cannot_be_removed():
    with pytest.raises(InvalidInput, match="is part of the catalogue"):
        remove("osm")
    add("mine", described("https://h.example/{z}/{x}/{y}"))
    with pytest.raises(InvalidInput, match="not one of your own, which are mine"):
        remove("yours")


@pytest.mark.parametrize(
    ("url", "options"),
    [
        ("https://h.example/{z}/{x}", {}),
        ("https://h.example/{z}/{x}/{y}?api_key=1234", {}),
        ("https://me:word@h.example/{z}/{x}/{y}", {}),
        ("https://h.example/{z}/{x}/{y}", {"default_date": "2020"}),
        ("https://h.example/{z}/{x}/{y}", {"max_zoom": 99}),
        ("https://h.example/{z}/{x}/{y}", {"tile_px": 300}),
        ("https://h.example/{z}/{x}/{y}", {"max_connections": 0}),
    ],
)
def test_what_is_not_right_is_not_kept(folder, url, options):
    with pytest.raises(InvalidInput):
        add("mine", described(url, **options))
    assert not folder.exists()


def test_a_provider_s_terms_stay_whatever_is_said(folder):
    generous = described(
        "https://{s}.tile.openstreetmap.org/{z}/{x}/{y}.png", max_connections=64, requests_per_s=1000.0
    )
    entry = add("fast-osm", generous)
    own = entry_named("osm")
    assert entry.policy == own.policy
    assert entry.attribution == own.attribution
    # Nor by hand in the file.
    data = json.loads((folder / "sources.json").read_text())
    data["fast-osm"].update(bulk_allowed="yes", max_tiles=None)
    (folder / "sources.json").write_text(json.dumps(data))
    assert user_sources()[0].policy == own.policy
    source = open_source("fast-osm")
    assert source.policy.bulk_allowed == "no"
    source.close()


def test_a_key_is_asked_of_the_environment_and_not_in_the_file(folder, monkeypatch):
    with TileServer() as server:
        add("keyed", described(server.url_template + "?token={key}", key_env="MY_TILES_KEY"))
        monkeypatch.setenv("MY_TILES_KEY", "s3cret")
        source = open_source("keyed")
        source.fetch("", Window(1, 0, 0, 256, 256))
        assert list(server.requests) == ["/1/0/0.png?token=s3cret"]
        source.close()
    assert "s3cret" not in (folder / "sources.json").read_text()


def test_templates_that_say_more_than_where():
    add(
        "dated",
        described("https://t{1-4}.h.example/{map_type}/{date}/{z}/{x}/{-y}{r}.png", default_date="2020"),
    )
    (entry,) = user_sources()
    assert entry.map_types == ("satellite", "roadmap", "terrain")
    urls = {entry.templates("2021")[""].url(4, x, 1, map_type="roadmap") for x in range(4)}
    assert urls == {f"https://t{1 + (x + 1) % 4}.h.example/roadmap/2021/4/{x}/14.png" for x in range(4)}
    assert entry.date(None) == "2020"
    add("asked", described("https://h.example/{date}/{z}/{x}/{y}"))
    with refused("{0}: has imagery of several dates", "h.example", field="date") as caught:
        open_source("asked")
    assert str(caught.value).endswith("; say which (--date)")


@pytest.mark.parametrize("content", ["[]", "{", '"mine"'])
def test_a_file_that_is_not_right_is_named_and_left_alone(folder, content):
    folder.mkdir()
    (folder / "sources.json").write_text(content)
    with pytest.raises(InvalidInput) as raised:
        user_sources()
    assert "sources.json" in str(raised.value)
    assert "\n" not in str(raised.value)
    assert (folder / "sources.json").read_text() == content


@pytest.mark.parametrize(
    ("name", "data", "says"),
    [
        ("broken", 3, "must be an object"),
        ("broken", {"kind": "world"}, "title is missing"),
        ("broken", {}, "title is missing"),
        ("Bad name", described("https://h.example/{z}/{x}/{y}"), "must be lower-case letters"),
        ("osm", described("https://h.example/{z}/{x}/{y}"), "is one of the catalogue's"),
    ],
)
def test_an_entry_that_is_not_right_hides_no_other(folder, name, data, says):
    """It is told by its name with the file, wherever it is asked for, and left alone."""
    add("first", described("https://h.example/{z}/{x}/{y}"))
    path = folder / "sources.json"
    known = json.loads(path.read_text())
    text = json.dumps({name: data, **known, "last": known["first"]})
    path.write_text(text)
    assert [entry.name for entry in user_sources()] == ["first", "last"]
    names = [entry.name for entry in sources()]
    assert names[-2:] == ["first", "last"]
    assert len(set(names)) == len(names)
    problems = shelf().problems
    assert list(problems) == [name]
    assert says in problems[name]
    assert str(path) in problems[name]
    assert "\n" not in problems[name]
    assert entry_named("last").title == "h.example"
    if name == "osm":
        assert not entry_named("osm").user
    elif name == "broken":
        with pytest.raises(InvalidInput, match=says):
            entry_named(name)
    assert path.read_text() == text
    remove(name)
    assert shelf().problems == {}


def test_a_folder_that_cannot_be_made_is_named(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "file"))
    with pytest.raises((OutputError, InvalidInput), match="file"):
        add("mine", described("https://h.example/{z}/{x}/{y}"))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"title": "two\nlines"}, "title 'two\\\\nlines': must be text of one line"),
        ({"attribution": 5}, "attribution 5: must be text"),
        ({"title": None}, "title None: must be text"),
        ({"max_zoom": 5.5}, "max_zoom 5.5: must be a whole number"),
        ({"max_zoom": True}, "max_zoom True: must be a whole number"),
        ({"max_connections": "3"}, "max_connections '3': must be a whole number"),
        ({"requests_per_s": float("inf")}, "requests_per_s inf: must be a number above 0"),
        ({"cache_allowed": "no"}, "cache_allowed 'no': must be true or false"),
        ({"tile_px": "256"}, "tile_px '256': must be a list"),
        ({"tile_px": [256.0]}, "tile_px with 256.0: must be whole numbers"),
        ({"tile_px": []}, r"tile_px \[\]: needs the width of its tiles"),
        ({"tile_px": [1 << 20]}, "tile size 1048576 px: must be 4096 or less"),
        ({"urls": {"": 7}}, "urls with 7: must be text"),
        ({"key_env": "FOO BAR"}, "environment variable 'FOO BAR': must be letters"),
        ({"foo": 1}, "'foo' is unknown; known are title"),
        ({"kind": ...}, "kind is missing"),
    ],
)
def test_data_of_another_kind_are_refused_and_named(change, says, folder):
    data = {**described("https://h.example/{z}/{x}/{y}"), **change}
    with pytest.raises(InvalidInput, match=says):
        add("mine", {name: value for name, value in data.items() if value is not ...})
    assert not folder.exists()


def test_null_stands_for_the_default_of_every_field(folder):
    folder.mkdir()
    stated = ("title", "kind", "min_zoom", "max_zoom", "native_zoom", "urls")
    data = described("https://h.example/{z}/{x}/{y}")
    needed = {name: data[name] for name in stated}
    fields = [one.name for part in (CatalogueEntry, Policy) for one in dataclasses.fields(part)]
    # Nobody states `rest_s`, which is of a run that shares a provider, or `any_size`, which QGIS's connections have.
    for name in sorted({*fields} - {*stated, "name", "policy", "user", "rest_s", "any_size"}):
        (folder / "sources.json").write_text(json.dumps({"mine": needed, "null": {**needed, name: None}}))
        assert dataclasses.replace(entry_named("null"), name="mine") == entry_named("mine"), name
    assert entry_named("null").credit("2024") == ""


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("{", "cannot be read as JSON"),
        ("[" * 100_000, "cannot be read as JSON"),
        ("[]", "must hold"),
    ],
)
def test_a_broken_file_is_named_once(folder, text, says):
    folder.mkdir()
    (folder / "sources.json").write_text(text)
    with pytest.raises(InvalidInput, match=says) as raised:
        sources()
    assert str(raised.value).count("sources.json") == 1
    assert (folder / "sources.json").read_text() == text


@pytest.mark.parametrize(
    "url",
    [
        "https://tile.openstreetmap.org./{z}/{x}/{y}.png",
        "https://{switch:x,tile}.openstreetmap.org/{z}/{x}/{y}.png",
    ],
)
def test_terms_hold_however_the_host_is_spelled(url):
    assert add("mine", described(url)).bulk_allowed == "no"
