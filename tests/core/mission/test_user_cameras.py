"""A user's own cameras: kept in a file, found by name, none hidden by one that is broken."""

from __future__ import annotations

import json
import math

import pytest
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.cameras import (
    add_camera,
    camera_named,
    camera_shelf,
    cameras,
    remove_camera,
)
from terrainav.core.mission.settings import build_camera, resolve

WIDE = {"horizontal_fov_deg": 100.0, "aspect_ratio": [16, 9]}


@pytest.fixture(autouse=True)
def folder(monkeypatch, tmp_path):
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))
    return tmp_path / "config"


def test_a_camera_is_kept_listed_found_and_forgotten(folder):
    facts = {
        "sensor_mm": [35.9, 24.0],
        "focal_length_mm": 35,
        "size_px": [9504, 6336],
        "source": "data sheet",
    }
    added = add_camera("Sony α7R 35 mm", facts)
    assert added.user
    assert added.camera == Camera.from_sensor((35.9, 24.0), 35.0, 9504 / 6336)
    assert (added.sensor_mm, added.focal_length_mm, added.width_px) == ((35.9, 24.0), 35.0, 9504)
    assert camera_shelf().entries == (added,)
    assert cameras()[-1] == added == camera_named("sony  Α7r 35 MM") == camera_named("α7r 35 mm")
    assert [path.name for path in folder.iterdir()] == ["cameras.json"]
    assert json.loads((folder / "cameras.json").read_text("utf-8")) == {"Sony α7R 35 mm": facts}
    assert remove_camera("SONY α7R 35 mm") == "Sony α7R 35 mm"
    assert camera_shelf().entries == ()


def test_a_camera_that_ships_goes_before_one_found_without_its_maker():
    add_camera("My Mini 2", WIDE)
    assert camera_named("dji mini 2").name == "DJI Mini 2"
    # Of two without their maker, the user's own.
    assert camera_named("mini 2").name == "My Mini 2"


@pytest.mark.parametrize("name", ["", " Wide", "Wide  angle", "two\nlines", "x" * 65, "bell\a"])
def test_names_that_are_refused(folder, name):
    with pytest.raises(InvalidInput, match="must be 1 to 64 characters of one line"):
        add_camera(name, WIDE)
    assert not folder.exists()


def test_names_that_are_taken():
    with pytest.raises(InvalidInput, match="DJI Mini 2 is taken"):
        add_camera("dji mini 2", WIDE)
    add_camera("Wide", WIDE)
    with pytest.raises(InvalidInput, match="Wide is taken"):
        add_camera("WIDE", {"fov_deg": 50.0, "aspect_ratio": [1, 1]})
    assert camera_shelf().entries[0].camera == Camera.from_horizontal_fov(100.0, 16 / 9)


@pytest.mark.parametrize(
    ("facts", "says"),
    [
        ({}, "no field of view: give one of"),
        ({"fov_deg": 60, **WIDE}, "fov_deg and horizontal_fov_deg: give one of"),
        ({"fov_deg": 60}, "needs aspect_ratio or size_px"),
        ({"fov_deg": 60, "aspect_ratio": [4, 3], "size_px": [4, 3]}, "give one of the two"),
        ({"fov_deg": "60", "aspect_ratio": [4, 3]}, "fov_deg '60': must be a number above 0"),
        ({"fov_deg": 10**400, "aspect_ratio": [4, 3]}, "must be a number above 0"),
        ({"fov_deg": True, "aspect_ratio": [4, 3]}, "fov_deg True: must be a number"),
        ({"fov_deg": 180, "aspect_ratio": [4, 3]}, "field of view 180"),
        ({"vertical_fov_deg": 190, "aspect_ratio": [4, 3]}, "vertical field of view 190"),
        ({"fov_deg": 60, "aspect_ratio": 1.5}, "aspect_ratio 1.5: must be a list of width and height"),
        ({"fov_deg": 60, "aspect_ratio": [4, 0]}, "must be a list of width and height, each above 0"),
        ({"fov_deg": 60, "size_px": [40.5, 30]}, "must be whole numbers"),
        ({"sensor_mm": [36, 24]}, "one needs the other"),
        ({"fov_deg": 60, "aspect_ratio": [4, 3], "focal_length_mm": 5}, "one needs the other"),
        ({"sensor_mm": [36, 24], "focal_length_mm": 50, "size_px": [1920, 1080]}, "would not be square"),
        ({"fov": 60, "aspect_ratio": [4, 3]}, "'fov' is unknown; known are fov_deg"),
        ({**WIDE, "source": "two\nlines"}, "must be text of one line"),
    ],
)
def test_facts_that_are_not_right_are_not_kept(folder, facts, says):
    with pytest.raises(InvalidInput) as raised:
        add_camera("Mine", facts)
    assert says in str(raised.value)
    assert str(raised.value).startswith("camera Mine: ")
    assert "\n" not in str(raised.value)
    assert not folder.exists()


def test_what_cannot_be_removed():
    with pytest.raises(InvalidInput, match="comes with TerrAInav"):
        remove_camera("dji mavic")
    add_camera("Wide", WIDE)
    with pytest.raises(InvalidInput, match="not one of your own, which are Wide"):
        remove_camera("yours")


@pytest.mark.parametrize(
    ("name", "data", "says"),
    [
        ("Broken", 3, "must be an object"),
        ("Broken", {"fov_deg": 500}, "needs aspect_ratio"),
        ("two\nlines", WIDE, "must be 1 to 64 characters"),
        ("DJI MINI 2", WIDE, "DJI Mini 2 is taken"),
    ],
)
def test_a_camera_that_is_not_right_hides_no_other(folder, name, data, says):
    add_camera("First", WIDE)
    path = folder / "cameras.json"
    text = json.dumps({name: data, **json.loads(path.read_text()), "Last": WIDE})
    path.write_text(text)
    assert [preset.name for preset in camera_shelf().entries] == ["First", "Last"]
    shelf = camera_shelf()
    assert list(shelf.problems) == [name]
    assert says in shelf.problems[name]
    assert str(path) in shelf.problems[name]
    assert "\n" not in shelf.problems[name]
    if name == "Broken":
        with pytest.raises(InvalidInput, match=says):
            camera_named("broken")
    # The others can be changed, which leaves it as it is; and it can be removed.
    add_camera("More", WIDE)
    assert name in json.loads(path.read_text())
    remove_camera(name)
    assert camera_shelf().problems == {}


def test_a_file_that_cannot_be_read_does_not_hide_what_ships(folder):
    folder.mkdir()
    (folder / "cameras.json").write_text("{")
    assert camera_named("DJI Mavic").camera == Camera()
    with pytest.raises(InvalidInput, match=r"cameras\.json: cannot be read as JSON"):
        cameras()
    with pytest.raises(InvalidInput, match=r"cameras\.json"):
        add_camera("Mine", WIDE)
    assert (folder / "cameras.json").read_text() == "{"


def test_a_folder_that_cannot_be_made_is_named(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "file"))
    with pytest.raises((OutputError, InvalidInput), match="file"):
        add_camera("Mine", WIDE)


def test_a_calibrated_camera_has_its_lens():
    facts = {
        "focal_px": 1000.0,
        "size_px": [1280, 960],
        "principal_px": [650.0, 470.4],
        "k1": -0.2,
        "k2": 0.05,
        "p1": 1e-3,
        "source": "calibration",
    }
    camera = add_camera("Mine", facts).camera
    assert camera_named("mine").camera == camera
    assert (camera.k1, camera.k2, camera.p1, camera.k3) == (-0.2, 0.05, 1e-3, 0.0)
    assert camera.principal_x == pytest.approx(650.0 / 1280.0 - 0.5)
    assert camera.principal_y == pytest.approx(470.4 / 960.0 - 0.5)
    assert camera.half_tangents == pytest.approx((0.64, 0.48))
    wide = add_camera("Fisheye", {"focal_px": 600.0, "size_px": [1280, 960], "lens": "fisheye", "k4": 1e-4}).camera
    assert wide.lens == "fisheye"
    assert wide.half_tangents == pytest.approx((64.0 / 60.0, 0.8))
    assert wide.horizontal_fov_deg == pytest.approx(math.degrees(128.0 / 60.0))


@pytest.mark.parametrize(
    ("facts", "says"),
    [
        ({"focal_px": 500.0, "aspect_ratio": [4, 3]}, "focal_px 500.0: needs size_px beside it"),
        ({"principal_px": [1, 2], **WIDE}, r"principal_px \[1, 2\]: needs size_px beside it"),
        ({"k1": "a", **WIDE}, "distortion k1 'a': must be a number"),
        ({"k1": -3.0, **WIDE}, "folds the image"),
        ({"lens": "pinhole", **WIDE}, "must be one of perspective, fisheye"),
        ({"focal_px": 100.0, "fov_deg": 60.0, "size_px": [4, 3]}, "fov_deg and focal_px: give one of"),
        ({"focal_px": 1e-3, "size_px": [4, 3], "lens": "fisheye"}, "field of view across the diagonal"),
    ],
)
def test_calibrations_that_are_refused(facts, says):
    with pytest.raises(InvalidInput, match=says):
        add_camera("Wrong", facts)


def test_options_of_a_lens_change_a_named_camera():
    add_camera("Mine", {"fov_deg": 60.0, "aspect_ratio": [4, 3], "k1": -0.1, "p1": 1e-3})
    camera, _ = build_camera(resolve({"camera": "mine", "k1": -0.2}, {}))
    assert (camera.fov_deg, camera.k1, camera.p1) == (60.0, -0.2, 1e-3)
    camera, _ = build_camera(
        resolve({"hfov": 120.0, "lens": "fisheye", "k2": "-0.01"}, {"TERRAINAV_BLUE_SCALE": "0.001"})
    )
    assert camera.horizontal_fov_deg == pytest.approx(120.0)
    assert camera.blue_scale == 1e-3
    camera, _ = build_camera(resolve({"sensor": (12.8, 9.6), "focal_length": 8.0, "lens": "fisheye"}, {}))
    assert camera.half_tangents == pytest.approx((0.8, 0.6))
    assert build_camera(resolve({}, {}))[0] == Camera()
