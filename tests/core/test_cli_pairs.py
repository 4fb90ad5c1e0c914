"""`terrainav pairs` as a person or a script runs it."""

from __future__ import annotations

import hashlib
import json

import numpy as np
import pytest
from PIL import Image

from tests.support.command import command
from tests.support.faults import flat_placeholder
from tests.support.thinning import sampled
from tests.support.tileserver import TileServer

BOX = "35.16_-89.90_35.0_-89.7"
SMALL = ("--heights", "120", "--yaws", "2", "--size", "48")


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    return command(tmp_path, monkeypatch, capsys)


def refusal(done, code=2):
    assert done.returncode == code, done.stderr
    assert done.stdout == ""
    (line,) = done.stderr.splitlines()
    return line


def test_a_dry_run_tells_and_writes_nothing(run, tmp_path):
    done = run("pairs", BOX, "--count", "20", "--views", "6", "--dry-run")
    assert done.returncode == 0, done.stderr
    assert "20: 9 to train, 8 to test, 3 distractors; no ground is seen in two parts" in done.stdout
    assert "140: for each place 1 of the satellite and 6 of the drone" in done.stdout
    assert list(tmp_path.iterdir()) == []
    told = json.loads(run("pairs", BOX, "--count", "20", "--views", "6", "--dry-run", "--json").stdout)
    assert told["places"] == {"train": 9, "test": 8, "distractor": 3}


def test_pairs_of_a_file_of_places_with_a_contact_sheet(run, tmp_path):
    (tmp_path / "places.txt").write_text("35.12 -89.93 Airport\n35.15 -89.85 Park\n", encoding="utf-8")
    asked = ("pairs", "places.txt", *SMALL, "--split", "1", "1", "0", "--data-dir", "out")
    done = run(*asked, "--sheet", "sheet.jpg", "--quiet")
    assert done.returncode == 0, done.stderr
    assert "6 images written, 0 failed" in done.stdout
    assert "2 places: 1 to train, 1 to test, 0 distractors; no ground is seen in two parts" in done.stdout
    with Image.open(tmp_path / "sheet.jpg") as image:
        assert image.size == (3 * 206 + 6, 2 * 222 + 6)
    settings = json.loads((tmp_path / "out" / "pairs.json").read_text(encoding="utf-8"))
    assert [place["name"] for place in settings["places"]] == ["Airport", "Park"]

    assert "resume them (--resume)" in refusal(run(*asked), code=3)
    again = run(*asked, "--resume", "--json")
    assert again.returncode == 0, again.stderr
    assert (json.loads(again.stdout)["written"], json.loads(again.stdout)["skipped"]) == (0, 6)


def test_options_of_missions_are_taken_as_plan_takes_them(run):
    asked = ("pairs", BOX, "--count", "2", "--views", "2", "--dry-run", "--json")
    done = run(*asked, "--elevation", "5", "7", "--map-type", "roadmap")
    assert done.returncode == 0, done.stderr
    assert "unrecognized arguments: roadmap" in refusal(run(*asked, "--map-type", "satellite", "roadmap"))


def test_a_placeholder_is_told_and_taken_out_of_the_pairs(run, tmp_path):
    (tmp_path / "places.txt").write_text("35.12 -89.93\n35.15 -89.85\n", encoding="utf-8")
    grey = np.full((256, 256, 3), 204, np.uint8)
    with TileServer(lambda *_: grey) as server:
        asked = ("pairs", "places.txt", *SMALL, "--split", "1", "1", "0", "--source", server.url_template)
        first = run(*asked, "--data-dir", "out", "--quiet", "--json")
        assert first.returncode == 0, first.stderr
        repeated = json.loads(first.stdout)["repeated"]
        assert {one["sha256"] for one in repeated} == {hashlib.sha256(flat_placeholder()).hexdigest()[:16]}
        assert "satellite" in {one["capture"] for one in repeated}
        placed = [path for part in ("train", "test") for path in (tmp_path / "out" / part).rglob("*.jp*g")]
        # Two more stand in for street views in each part.
        assert len(placed) == 3 + 2 * 3 + 2 * 2
        again = run(*asked, "--data-dir", "out", "--resume", "--quiet", "--placeholder", repeated[0]["sha256"])
    assert again.returncode == 1, again.stderr
    assert "6 failed" in again.stdout
    # Other programs read whatever is in the folders.
    assert not any(path.exists() for path in placed)
    table = (tmp_path / "out" / "pairs.csv").read_text(encoding="utf-8")
    # With the rows of two stand-ins for street views, and of one for Google's.
    assert table.count(",failed,") == 6 + 3
    assert "train/" not in table


def test_the_cache_serves_the_drone_what_the_satellite_has_fetched(run, tmp_path):
    (tmp_path / "places.txt").write_text("35.12 -89.93\n", encoding="utf-8")
    with TileServer() as server:
        template = server.url_template
        asked = ("pairs", "places.txt", *SMALL, "--split", "1", "0", "0", "--source", template, "--quiet")
        done = run(*asked, "--data-dir", "out")
        assert done.returncode == 0, done.stderr
    assert server.requests
    assert set(server.requests.values()) == {1}


@pytest.mark.parametrize(
    ("arguments", "told"),
    sampled(
        [
            (("nowhere.txt",), "no such file, and no box"),
            ((BOX,), "needs a number of places, --count"),
            ((BOX, "--count", "0"), "0 places: must be from 1 to 1,000,000"),
            ((BOX, "--count", "5000"), "the box has room for"),
            ((BOX, "--count", "2", "--tilt", "85"), "tilt 85.0 deg: must be from 0 (straight down) to 80"),
            ((BOX, "--count", "2", "--tilt", "70"), "see the horizon"),
            ((BOX, "--count", "2", "--heights", "0"), "height above ground 0.0 m: must be above 0"),
            ((BOX, "--count", "2", "--yaws", "3", "--rounds", "2"), "rings have no rounds"),
            ((BOX, "--count", "4", "--split", "1", "0", "1"), "distractors are of a test"),
            ((BOX, "--count", "1"), "none is left for"),
            ((BOX, "--count", "3", "--size", "0"), "size of images 0 px"),
            ((BOX, "--count", "3", "--satellite-m", "-1"), "width of the satellite view -1.0 m"),
            ((BOX, "--count", "3", "--gap", "-1"), "gap -1.0 m: must be 0 or more"),
            ((BOX, "--count", "9", "--spacing", "50", "--gap", "20000"), "--allow-shared-ground"),
            ((BOX, "--count", "3", "--map-type", "satellite roadmap"), "pairs are of one"),
            ((BOX, "--count", "3", "--sheet", "sheet.png"), "must end in .jpg"),
            ((BOX, "--count", "3", "--source", "nosuchsource"), "source 'nosuchsource' is unknown"),
            (("86 0 85.5 1", "--count", "3"), "latitude 85.5: the map ends at"),
        ],
        4,
    ),
)
def test_mistakes_are_one_line_and_change_nothing(run, tmp_path, arguments, told):
    assert told in refusal(run("pairs", *arguments, "--data-dir", "out"))
    assert not (tmp_path / "out").exists()


def test_a_folder_has_to_be_named(run):
    assert "give --data-dir" in refusal(run("pairs", BOX, "--count", "3"))


def test_a_file_takes_no_options_of_a_box(run, tmp_path):
    (tmp_path / "places.txt").write_text("35.12 -89.93\n", encoding="utf-8")
    assert "it is for places of a box" in refusal(run("pairs", "places.txt", "--count", "3", "--data-dir", "out"))


def test_the_sources_terms_are_asked_first(run, tmp_path):
    few = ("--count", "40", "--spacing", "100", "--views", "1", "--tilt", "0", "--size", "1024")
    done = run("pairs", BOX, *few, "--allow-shared-ground", "--source", "osm", "--data-dir", "out")
    assert "allowed without breaking its terms" in refusal(done, code=3)
    assert not (tmp_path / "out").exists()
