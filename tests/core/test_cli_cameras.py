"""Own cameras by the command, and missions flown with them."""

from __future__ import annotations

import json

import pytest
from terrainav.core.geodesy.camera import Camera

from tests.support.command import command


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    return command(tmp_path, monkeypatch, capsys)


def test_a_camera_is_added_listed_flown_and_removed(run, tmp_path):
    done = run(
        *("cameras", "add", "My camera", "--sensor", "23.5", "15.6", "--focal-length", "16"),
        *("--size-px", "6000", "4000", "--source", "its data sheet"),
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "My camera added: 82.79 deg diagonal, 72.51 by 52.11 deg\n"
    assert "My camera                   82.8 deg diagonal, 1.500 : 1 (your own)" in run("cameras").stdout
    own = json.loads(run("cameras", "list", "--json").stdout)[-1]
    assert (own["name"], own["user"], own["size_px"]) == ("My camera", True, [6000, 4000])
    assert (own["sensor_mm"], own["focal_length_mm"]) == ([23.5, 15.6], 16.0)
    planned = run("plan", "--coords", "35_-89_120", "--camera", "my camera", "--output", "m.json")
    assert planned.returncode == 0
    saved = json.loads((tmp_path / "m.json").read_text())["camera"]
    assert Camera(**saved) == Camera.from_sensor((23.5, 15.6), 16.0, 1.5)
    assert run("cameras", "remove", "MY CAMERA").stdout == "My camera removed\n"
    assert "My camera" not in run("cameras").stdout


@pytest.mark.parametrize(
    ("options", "angle", "degrees"),
    [
        (("--fov", "80"), "fov_deg", 80.0),
        (("--hfov", "60"), "horizontal_fov_deg", 60.0),
        (("--vfov", "40"), "vertical_fov_deg", 40.0),
    ],
)
def test_a_camera_by_each_field_of_view(run, options, angle, degrees):
    assert run("cameras", "add", "Mine", *options, "--aspect-ratio", "16", "9").returncode == 0
    own = json.loads(run("cameras", "--json").stdout)[-1]
    assert own[angle] == pytest.approx(degrees, abs=1e-12)
    assert own["aspect_ratio"] == 16 / 9


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("add", "Mine"), "no field of view: give one of"),
        (("add", "Mine", "--fov", "60"), "needs aspect_ratio or size_px"),
        (("add", "Mine", "--sensor", "36"), "expected 2 arguments"),
        (("add", "DJI Mini 2", "--fov", "60", "--aspect-ratio", "4", "3"), "is taken"),
        (("remove", "Mine"), "not one of your own"),
    ],
)
def test_what_is_not_right_is_one_line(run, arguments, says):
    done = run("cameras", *arguments)
    assert done.returncode == 2
    assert says in done.stderr
    assert done.stderr.count("\n") == 1


def test_a_broken_camera_is_told_and_hides_no_other(run, tmp_path):
    assert run("cameras", "add", "Mine", "--fov", "60", "--aspect-ratio", "4", "3").returncode == 0
    file = tmp_path / "config" / "cameras.json"
    file.write_text(json.dumps({"Broken": 3, **json.loads(file.read_text())}))
    done = run("cameras")
    assert done.returncode == 0
    assert "Mine" in done.stdout
    assert done.stderr == f"terrainav: {file}: camera Broken: must be an object\n"


def test_a_broken_source_is_told_and_hides_no_other(run, tmp_path):
    assert run("sources", "add", "mine", "https://h.example/{z}/{x}/{y}").returncode == 0
    file = tmp_path / "config" / "sources.json"
    file.write_text(json.dumps({"broken": 3, **json.loads(file.read_text())}))
    done = run("sources")
    assert done.returncode == 0
    assert "mine" in done.stdout
    assert done.stderr == f"terrainav: {file}: catalogue entry 'broken': must be an object\n"


@pytest.mark.parametrize(
    ("options", "camera"),
    [
        (("--hfov", "70"), Camera.from_horizontal_fov(70.0, 4 / 3)),
        (("--vfov", "50", "--aspect-ratio", "3", "2"), Camera.from_vertical_fov(50.0, 1.5)),
        (("--sensor", "36", "24", "--focal-length", "35"), Camera.from_sensor((36.0, 24.0), 35.0)),
    ],
)
def test_a_mission_by_other_terms_of_its_camera(run, tmp_path, options, camera):
    assert run("plan", "--coords", "35_-89_120", *options, "--output", "m.json").returncode == 0
    assert Camera(**json.loads((tmp_path / "m.json").read_text())["camera"]) == camera


def test_two_terms_of_one_camera_are_refused(run):
    done = run("plan", "--coords", "35_-89_120", "--hfov", "70", "--vfov", "50")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "terrainav: hfov 70.0 and vfov 50.0: give one of the two\n"


def test_image_sensors_are_listed_with_their_sources(run):
    listed = run("cameras", "sensors")
    assert (listed.returncode, listed.stderr) == (0, "")
    line = "Allied Vision Alvium 1800 C-507m   3.45 µm, 64%, 10,400 e-, read noise 2.1 e-"
    assert line in listed.stdout.splitlines()
    sensors = {one["name"]: one for one in json.loads(run("cameras", "sensors", "--json").stdout)}
    assert sensors["FRAMOS IMX900 low gain"]["prnu"] == 0.007
    assert all("data sheet" in one["source"] for one in sensors.values())
