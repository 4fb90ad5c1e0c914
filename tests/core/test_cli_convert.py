"""`terrainav convert`, and `clean` of published folders, as users run them."""

from __future__ import annotations

import json

import pytest
from terrainav.core.cli.exits import BAD_INPUT, FAILED

from tests.support.command import command
from tests.support.published import FLIGHT, write_published, write_vbn


@pytest.fixture
def terrainav(tmp_path, monkeypatch, capsys):
    return command(tmp_path, monkeypatch, capsys)


def test_published_folders_are_converted_and_cleaned(tmp_path, terrainav):
    write_published(tmp_path / "Memphis" / "satellite_0")
    write_published(tmp_path / "Memphis" / "roadmap_0", blank=[(0, 0)])
    done = terrainav("clean", "Memphis", "--dry-run")
    assert done.returncode == 0, done.stderr
    assert "satellite_0 6 images, 1 rejected (entropy below 2.1 of the roadmap)" in done.stdout

    done = terrainav("convert", "Memphis", "ours")
    assert done.returncode == 0, done.stderr
    assert done.stdout == (
        "roadmap     6 images, 6 of which show known ground\n"
        "satellite   6 images, 6 of which show known ground\n"
        "dataset in ours\n"
    )
    done = terrainav("clean", "ours", "--json")
    assert {one["map_type"]: one["rejected"] for one in json.loads(done.stdout)} == {
        "satellite": 1,
        "roadmap": 1,
    }


@pytest.mark.parametrize("layout", ["VBN", "vbn"])
def test_a_supplement_is_converted(tmp_path, terrainav, layout):
    write_vbn(tmp_path / "Raster", ["1", "2"], texts=["1", "2", "3"])
    done = terrainav("convert", "Raster", "ours", "--dataset", layout, "--json")
    assert json.loads(done.stdout) == [{"map_type": "camera", "images": 2, "failed": 1, "framed": 0}]
    again = terrainav("convert", "Raster", "ours", "--dataset", layout)
    assert (again.returncode, again.stdout) == (FAILED, "")
    assert again.stderr == "terrainav: folder ours: is there already; choose a new or empty folder\n"
    third = terrainav("convert", "Raster", "others", "--dataset", layout)
    assert "2 images, 0 of which show known ground, 1 without an image" in third.stdout


def test_bad_input_is_one_line_and_changes_nothing(tmp_path, terrainav):
    names = write_published(tmp_path / "Memphis" / "satellite", images=FLIGHT)
    (tmp_path / "Memphis" / "satellite" / FLIGHT / names[2]).unlink()
    for arguments, said in (
        (("Memphis", "ours"), f"{names[2]} of the table is not there"),
        (("nothing", "ours"), "folder nothing: cannot be read"),
        (("Memphis", "ours", "--dataset", "VBN"), "is not a VBN dataset"),
        (("Memphis", "ours", "--dataset", "other"), "invalid choice: 'other'"),
    ):
        done = terrainav("convert", *arguments)
        assert done.returncode == BAD_INPUT
        assert done.stdout == ""
        assert said in done.stderr
        assert done.stderr.count("\n") == 1
    assert not (tmp_path / "ours").exists()
