"""Sources on the command line: added by URL, shown with their limits, captured, captured again without a network."""

from __future__ import annotations

import csv
import importlib
import json
import re
import warnings

import pytest
from terrainav.core.mission.mission import Mission

from tests.support.command import command
from tests.support.json_services import answer_of, map_service
from tests.support.patterns import positions, to_bytes
from tests.support.services import DUTCH, ServiceServer, matrix, matrix_set, wmts_document, wmts_layer
from tests.support.tileserver import TileServer

POINT = "35.16_-89.90_400"
BOX = "35.16_-89.90_35.155_-89.89_400"
LARGE = "35.22_-90.07_35.06_-89.73_120"


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    return command(tmp_path, monkeypatch, capsys)


def good(process):
    assert process.returncode == 0, process.stderr
    return process.stdout


def one_line(process, code=2):
    assert process.returncode == code, process.stderr
    # Some missions have something to be told of first; an error is one line, the last.
    *_, line = process.stderr.splitlines()
    assert line.startswith("terrainav")
    assert "Traceback" not in process.stderr
    return line


def files(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*.tif")}


def test_a_source_by_url_from_adding_to_capturing_without_a_network(run, tmp_path):
    with TileServer() as server:
        added = good(
            run(
                *(
                    "sources",
                    "add",
                    "town",
                    server.url_template,
                    "--title",
                    "Town",
                    "--attribution",
                    "© Town",
                ),
                *(
                    "--max-zoom",
                    "18",
                    "--max-connections",
                    "3",
                    "--requests-per-s",
                    "500",
                    "--licence",
                    "CC0",
                ),
            )
        )
        assert "town added: Town" in added
        shown = dict(line.split("  ", 1) for line in good(run("sources", "show", "town")).splitlines())
        shown = {label.strip(): text.strip() for label, text in shown.items()}
        assert shown["name"] == "town (your own)"
        assert shown["bulk download"] == "yes: unlimited requests; 3 connections, 500 requests/s"
        assert (shown["zooms"], shown["licence"]) == ("0 to 18, detail to 18", "CC0")
        assert shown["URL"] == server.url_template
        assert "Town (your own)" in good(run("sources"))
        first = json.loads(good(run("capture", "--coords", BOX, "--source", "town", "--data-dir", "one", "--json")))
        assert first["written"] == first["total"]
        assert sum(server.requests.values()) == first["unique_parts"]
        # The cache is by source: another user's name for the same tiles, or none, is the same file or another,
        # but never the wrong tiles.
        assert json.loads(good(run("cache", "--json")))["files"][0]["tiles"] == first["unique_parts"]
    second = json.loads(good(run("capture", "--coords", BOX, "--source", "town", "--data-dir", "two", "--json")))
    assert second["written"] == first["written"]
    assert files(tmp_path / "one") == files(tmp_path / "two") != {}
    # Without the cache there is nothing to be had any more.
    without = run("capture", "--coords", POINT, "--source", "town", "--data-dir", "three", "--no-cache", "--json")
    assert without.returncode == 1
    assert "1 tiles" not in good(run("cache", "list"))
    good(run("sources", "remove", "town"))
    assert "'town' is unknown" in one_line(run("plan", "--coords", POINT, "--source", "town"))


def test_the_cache_is_listed_and_cleared_by_name(run, tmp_path):
    with TileServer() as server:
        for name in ("one", "two"):
            good(run("sources", "add", name, server.url_template, "--title", name.title()))
            good(run("capture", "--coords", POINT, "--source", name, "--data-dir", name))
    listed = good(run("cache", "list"))
    assert "One" in listed
    assert str(tmp_path / "cache") in listed
    assert "is not there" in one_line(run("cache", "clear", "three"))
    freed = json.loads(good(run("cache", "clear", "one", "--json")))
    assert freed["freed_bytes"] > 0
    assert [file["title"] for file in json.loads(good(run("cache", "--json")))["files"]] == ["Two"]
    good(run("cache", "clear"))
    assert good(run("cache")).startswith("0 files, 0 bytes")
    # Another folder than the usual one.
    assert str(tmp_path / "other") in good(run("cache", "list", "--cache-dir", str(tmp_path / "other")))
    assert "cache limit 0 MB: must be 1 or more" in one_line(
        run("capture", "--coords", POINT, "--cache-limit", "0", "--data-dir", "x")
    )


def test_run_options_go_with_a_mission_file_and_leave_the_mission_alone(run, tmp_path):
    with TileServer() as server:
        good(run("plan", "--coords", POINT, "--source", server.url_template, "--output", "m.json"))
        good(
            run(
                *("capture", "m.json", "--data-dir", "out", "--cache-dir", str(tmp_path / "mine")),
                *("--cache-limit", "50"),
            )
        )
    assert (tmp_path / "mine").is_dir()
    assert not (tmp_path / "cache").exists()
    assert (tmp_path / "out" / "mission.json").read_bytes() == (tmp_path / "m.json").read_bytes()
    assert "cache" not in (tmp_path / "m.json").read_text()


def test_dates_are_part_of_the_mission_and_of_its_pictures(run, tmp_path):
    with TileServer() as server:
        good(run("sources", "add", "dated", server.url + "/{z}/{x}/{y}.png?d={date}"))
        asked = ("--coords", POINT, "--source", "dated", "--data-dir", "out")
        assert "has imagery of several dates; say which (--date)" in one_line(run("capture", *asked))
        good(run("capture", *asked, "--date", "2021-07-01"))
        assert all(path.endswith("?d=2021-07-01") for path in server.requests)
        assert json.loads((tmp_path / "out" / "mission.json").read_text())["imagery"]["date"] == "2021-07-01"
        assert "another mission" in one_line(run("capture", *asked, "--date", "2022-07-01", "--resume"), 3)
        again = good(run("capture", "out/mission.json", "--data-dir", "out", "--resume", "--json"))
        assert json.loads(again)["skipped"] == 1
        # From the environment as well.
        plan = json.loads(good(run("plan", *asked[:4], "--json", TERRAINAV_DATE="2020-01-01")))
        assert plan["date"] == "2020-01-01"
    assert "no dates to choose from" in one_line(run("plan", "--coords", POINT, "--date", "2020"))
    assert "one of those there are" in one_line(
        run("plan", "--coords", POINT, "--source", "esri-wayback", "--date", "2020")
    )


def test_a_service_is_listed_added_and_planned_with_when_it_is_gone(run):
    pytest.importorskip("owslib")
    with warnings.catch_warnings():
        # It imports a module that Python is going to drop; that is for it to change.
        warnings.simplefilter("ignore", DeprecationWarning)
        importlib.import_module("owslib.wms")
    quad = matrix_set("quad", [matrix(f"z{zoom}", zoom) for zoom in range(20)])
    with ServiceServer() as server:
        rest = f"{server.url}/{{TileMatrix}}/{{TileCol}}/{{TileRow}}.png"
        layers = [
            wmts_layer(name, {"quad": []}, title=name.title(), resources=[("image/png", rest)])
            for name in ("ortho", "topo")
        ]
        picture = to_bytes(positions("satellite", 0, 0, 0, 256), "png")
        server.answer = lambda path, _: (
            (200, "text/xml", wmts_document(layers, [quad])) if path.endswith(".xml") else (200, "image/png", picture)
        )
        address = f"wmts:{server.url}/c.xml"
        listed = good(run("sources", "show", address)).splitlines()
        assert [line.split() for line in listed] == [["ortho", "Ortho"], ["topo", "Topo"]]
        shown = json.loads(good(run("sources", "show", address + "#layer=topo", "--json")))
        assert (shown["title"], shown["native_zoom"]) == ("Topo", 19)
        good(run("sources", "add", "topo", address + "#layer=topo", "--max-connections", "2"))
        captured = json.loads(
            good(run("capture", "--coords", POINT, "--source", "topo", "--data-dir", "out", "--json"))
        )
        assert captured["written"] == 1
        assert server.asked[-1].startswith("/z")
    figures = json.loads(good(run("plan", "--coords", POINT, "--source", "topo", "--json")))
    assert (figures["source"], figures["policy"]["max_connections"]) == ("Topo", 2)
    assert "capabilities" in one_line(run("plan", "--coords", POINT, "--source", address), 3)


def test_a_layer_is_captured_in_the_system_that_is_named(run, tmp_path):
    pytest.importorskip("owslib")
    gdal = pytest.importorskip("osgeo.gdal", reason="images are read by GDAL's Python module")
    place = "52.09_5.12_100"
    with ServiceServer() as server:
        rest = f"{server.url}/{{TileMatrix}}/{{TileCol}}/{{TileRow}}.png"
        layer = wmts_layer("ortho", {DUTCH.name: []}, title="Aerial", resources=[("image/png", rest)])
        document = wmts_document([layer], [DUTCH.text()])

        def answer(path, _):
            if path.endswith(".xml"):
                return 200, "text/xml", document
            level, column, row = path.removesuffix(".png").split("/")[1:]
            return 200, "image/png", to_bytes(DUTCH.tile(level, int(column), int(row)), "png")

        server.answer = answer
        address = f"wmts:{server.url}/c.xml#layer=ortho"
        printed = good(run("plan", "--coords", place, "--source", address))
        assert re.search(r"^source +Aerial, EPSG:28992$", printed, re.MULTILINE)
        assert json.loads(good(run("plan", "--coords", place, "--source", address, "--json")))["crs"] == "EPSG:28992"
        for wanted in ("EPSG:3857", "EPSG:2056"):
            refusal = one_line(run("plan", "--coords", place, "--source", address, "--crs", wanted), 2)
            assert f"{wanted}: layer 'ortho' of 127.0.0.1 has EPSG:28992" in refusal
            assert wanted in one_line(run("sources", "add", "x", address, "--crs", wanted), 2)
            assert wanted in one_line(run("sources", "show", address, "--crs", wanted), 2)
        assert "osm" in good(run("sources", "show", "osm", "--crs", "EPSG:3857"))
        assert "has EPSG:3857" in one_line(run("sources", "show", "osm", "--crs", "EPSG:2056"), 2)
        assert "2056: must be a code" in one_line(
            run("plan", "--coords", place, "--source", address, "--crs", "2056"), 2
        ).replace("'", "")
        shown = good(run("sources", "show", address, "--crs", "EPSG:28992"))
        assert re.search(r"^reference system +EPSG:28992$", shown, re.MULTILINE)
        good(run("sources", "add", "aerial", address, "--crs", "EPSG:28992"))
        good(run("capture", "--coords", place, "--source", "aerial", "--crs", "EPSG:28992", "--data-dir", "out"))
    (picture,) = (tmp_path / "out/satellite").glob("*.tif")
    assert gdal.Open(str(picture)).GetSpatialRef().GetAuthorityCode(None) == "28992"
    (row,) = csv.DictReader((tmp_path / "out/satellite/meta_data.csv").read_text("utf-8").splitlines())
    assert row["crs"] == "EPSG:28992"
    # The mission of the dataset asks for the same again.
    assert json.loads((tmp_path / "out/mission.json").read_text())["imagery"]["crs"] == "EPSG:28992"
    template = "https://h.example/{z}/{x}/{y}.png"
    assert "a URL template has EPSG:3857" in one_line(run("sources", "add", "x", template, "--crs", "EPSG:2056"), 2)


def test_names_and_addresses_that_are_refused(run, tmp_path):
    template = "https://h.example/{z}/{x}/{y}"
    for arguments, says in (
        (("add", "OSM2", template), "must be lower-case letters"),
        (("add", "osm", template), "is one of the catalogue's"),
        (("add", "mine", "https://h.example/{z}/{x}"), "without {y}"),
        (("add", "mine", template + "?key=abc123"), "holds a key in 'key'"),
        (("add", "mine", template, "--default-date", "2020"), "no {date} to put it in"),
        (("add", "mine", template, "--max-zoom", "high"), "invalid int value"),
        (("remove", "mine"), "not one of your own"),
        (("show", "atlantis"), "'atlantis' is unknown"),
        (("show", "ortho.tif"), "a file states no terms"),
    ):
        assert says in one_line(run("sources", *arguments))
    assert not (tmp_path / "config").exists()


def test_the_catalogue_with_all_limits(run):
    listed = good(run("sources", "list"))
    assert "dates: every day from 2015-11-24 to now" in listed
    assert listed == good(run("sources"))
    shown = good(run("sources", "show", "esri-wayback"))
    for text in (
        "no: at most 100 requests, whatever you agree to; 4 connections, 10 requests/s; nothing may be cached",
        'users "may not scrape, download, or store" the basemap',
        "https://www.esri.com/",
        "189 from 2014-02-20 to 2025-12-18; 2025-12-18 by default",
        "2020-10-14,",
    ):
        assert text in shown
    assert json.loads(good(run("sources", "show", "osm", "--json")))["max_tiles"] == 250
    assert "at most 250 requests" in good(run("sources", "show", "https://tile.openstreetmap.org/{z}/{x}/{y}.png"))


def test_consent(run):
    plan = good(run("plan", "--coords", LARGE, "--source", "swisstopo"))
    assert "over 1,000 requests require accepting the terms (--accept-terms)" in plan
    assert "this mission takes" in plan
    ask = one_line(run("capture", "--coords", LARGE, "--source", "swisstopo", "--data-dir", "out"), 3)
    assert "refrain from automatic requests of high intensity" in ask
    assert ask.endswith("agree to the terms first (--accept-terms)")
    no = one_line(run("capture", "--coords", LARGE, "--source", "osm", "--accept-terms", "--data-dir", "out"), 3)
    assert "prohibits bulk downloading" in no
    assert "sources that allow it: " in no


def test_agreeing_lets_a_run_begin(run, tmp_path):
    with TileServer() as server:
        good(run("sources", "add", "mine", server.url_template))
        path = tmp_path / "config" / "sources.json"
        data = json.loads(path.read_text())
        data["mine"] |= {"bulk_allowed": "ask", "max_tiles": 1, "terms": "ask us first"}
        path.write_text(json.dumps(data))
        asked = ("capture", "--coords", POINT, "--source", "mine", "--data-dir", "out")
        assert "ask us first" in one_line(run(*asked), 3)
        assert not server.requests
        good(run(*asked, "--accept-terms"))
        assert server.requests


def test_upsampling_is_warned_of(run):
    small = ("plan", "--coords", POINT, "--source", "usgs")
    assert "warning" not in good(run(*small))
    warned = good(run(*small, "--zoom", "16", "--img-size", "8000", "6000", "3"))
    assert "times, images show no more detail; ask for --img-size " in warned
    assert json.loads(good(run(*small, "--json")))["warnings"] == []


def test_a_title_names_its_source_as_the_name_does(run, tmp_path):
    asked = ("plan", "--coords", BOX, "--json", "--source")
    plans = [json.loads(good(run(*asked, name))) for name in ("world", "Synthetic (offline)", "synthetic (OFFLINE)")]
    for plan in plans:
        # Times of this machine.
        del plan["cost"]
    assert plans[0] == plans[1] == plans[2]
    # The mission that a capture leaves names it by its name.
    good(
        run(
            "capture",
            "--coords",
            POINT,
            "--source",
            "Synthetic (offline)",
            "--data-dir",
            str(tmp_path / "out"),
        )
    )
    assert Mission.load(tmp_path / "out" / "mission.json").imagery.source == "world"
    for name in ("one", "two"):
        good(run("sources", "add", name, f"https://{name}.example/{{z}}/{{x}}/{{y}}.png", "--title", "My tiles"))
    assert "name one of one, two" in one_line(run("sources", "show", "my tiles"))
    assert "is unknown" in one_line(run("sources", "show", "No such title"))


def test_an_address_alone_tells_which_service_it_is_of(run):
    base = "/arcgis/rest/services/Ortho/MapServer"
    with ServiceServer() as server:

        def answer(path, query):
            if path == base:
                return answer_of(map_service())
            if path == "/arcgis/rest/services":
                return answer_of({"services": [{"name": "Ortho", "type": "MapServer"}]})
            return 404, "text/plain", b""

        server.answer = answer
        listed = good(run("sources", "show", f"{server.url}/arcgis/rest/services"))
        assert f"arcgis:{server.url}/arcgis/rest/services#service=NAME" in listed
        assert "Ortho/MapServer" in listed
        shown = good(run("sources", "show", f"{server.url}{base}"))
        assert f"arcgis:{server.url}{base}" in shown
        assert "Survey of Somewhere" in shown
        good(run("sources", "add", "ortho", f"{server.url}{base}"))
        assert "Orthophotos 2023" in good(run("sources", "show", "ortho"))
        planned = json.loads(good(run("plan", "--coords", BOX, "--json", "--source", f"arcgis:{server.url}{base}")))
        assert planned["source"] == "Orthophotos 2023"
        assert "404" in one_line(run("sources", "show", f"{server.url}/nothing"), 3)
