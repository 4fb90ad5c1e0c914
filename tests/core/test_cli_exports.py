"""Plans written for those who fly, by the command."""

from __future__ import annotations

import json

import pytest

from tests.support.command import command

BOX = ("plan", "--coords", "35.16_-89.90_35.155_-89.89_120")


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    return command(tmp_path, monkeypatch, capsys)


def test_every_format_at_once(run, tmp_path):
    names = ["a.csv", "a.geojson", "a.kml", "a.gpx", "a.litchi.csv", "A.PLAN", "a.json"]
    outputs = [part for name in names for part in ("--output", name)]
    done = run(*BOX, "--json", *outputs)
    assert done.returncode == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)
    # The figures are the program's, the notes a person's.
    assert json.loads(done.stdout)["images"] == len((tmp_path / "a.csv").read_text().splitlines()) - 1
    notes = done.stderr.splitlines()
    assert [note.partition(": ")[0] for note in notes] == ["a.gpx", "a.litchi.csv", "A.PLAN"]
    assert "Heading Mode" in notes[1]
    assert (tmp_path / "a.litchi.csv").read_text().startswith("latitude,longitude,altitude(m)")
    assert json.loads((tmp_path / "A.PLAN").read_text())["fileType"] == "Plan"


@pytest.mark.parametrize("name", ["a.shp", "plan", "a.litchi", ".gpkg", ".litchi.csv"])
def test_other_endings_are_refused_before_anything_is_worked_out(run, tmp_path, name):
    done = run(*BOX, "--output", "a.csv", "--output", name)
    assert done.returncode == 2
    assert done.stderr == (
        f"terrainav: plan file {name!r}: must end in .csv, .geojson, .kml, .gpkg, .gpx, .litchi.csv, .kmz, .plan, "
        ".survey.plan, .json\n"
    )
    assert list(tmp_path.iterdir()) == []


def test_a_plan_that_a_format_does_not_take_is_one_line(run, tmp_path):
    done = run("plan", "--coords", "35.16_-89.90_120", "--output", "a.litchi.csv")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "terrainav: Litchi mission of one waypoint: takes two or more; plan a list or an area\n"
