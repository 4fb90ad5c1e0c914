"""Cameras that ship: their published facts, and how they are found."""

from __future__ import annotations

import math

import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.cameras import CameraPreset, camera_named, cameras, shipped_cameras
from terrainav.core.resources import read_json

# Diagonal fields of view in degrees, to a tenth, as published beside the facts.
PUBLISHED_FOV_DEG = {
    "DJI Mavic": 78.8,
    "DJI Mini 2": 82.4,
    "DJI Mini 3 Pro": 81.9,
    "DJI Air 2S": 86.9,
    "DJI Air 3S": 84.0,
    "DJI Mavic Pro": 80.2,
    "DJI Mavic Air 2": 83.3,
    "DJI Mavic 2 Pro": 75.4,
    "DJI Mavic 3E": 82.7,
    "DJI Phantom 3/4": 94.9,
    "DJI Phantom 4 Pro": 84.1,
    "DJI Zenmuse X4S": 83.7,
    "DJI Zenmuse P1 35 mm": 63.5,
    "DJI H20 thermal": 40.0,
    "Yuneec E90": 87.5,
    "Sentera 65R": 68.6,
    "Sony a6000 16 mm": 82.8,
}
FACTS = read_json("cameras.json")
PRESETS = {preset.name: preset for preset in shipped_cameras()}


@pytest.fixture(autouse=True)
def folder(monkeypatch, tmp_path):
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))


def test_presets_are_the_published_ones_and_the_paper_s_come_with_them():
    assert set(PRESETS) == {*PUBLISHED_FOV_DEG, "NVIG"}
    assert cameras()[0].camera == Camera()
    assert cameras() == shipped_cameras()


@pytest.mark.parametrize(("name", "fov_deg"), PUBLISHED_FOV_DEG.items())
def test_fields_of_view_are_the_published_ones(name, fov_deg):
    assert PRESETS[name].camera.fov_deg == pytest.approx(fov_deg, abs=0.05 + 1e-9)


def test_the_supplement_s_camera_sees_75_degrees_both_ways():
    camera = PRESETS["NVIG"].camera
    assert camera.horizontal_fov_deg == pytest.approx(75.0, abs=1e-12)
    assert camera.vertical_fov_deg == pytest.approx(75.0, abs=1e-12)


@pytest.mark.parametrize("facts", [facts for facts in FACTS if "sensor_mm" in facts], ids=lambda facts: facts["name"])
def test_pixels_are_square(facts):
    pitch_um = [1000.0 * size / count for size, count in zip(facts["sensor_mm"], facts["size_px"])]
    assert pitch_um[0] == pytest.approx(pitch_um[1], rel=0.03)
    preset = PRESETS[facts["name"]]
    assert [preset.width_px, preset.height_px] == facts["size_px"]
    assert preset.image_px == max(facts["size_px"])
    assert preset.camera.aspect_ratio == facts["size_px"][0] / facts["size_px"][1]
    # The focal length in px is that of the lens, but for the sensor's own rounding.
    assert preset.width_px / (2.0 * preset.camera.half_tangents[0]) == pytest.approx(
        1000.0 * facts["focal_length_mm"] / pitch_um[0], rel=0.03
    )


@pytest.mark.parametrize("facts", FACTS, ids=lambda facts: facts["name"])
def test_every_preset_names_its_source(facts):
    assert facts["source"]
    preset = PRESETS[facts["name"]]
    assert preset.source == facts["source"]
    assert not preset.user
    sensor = facts.get("sensor_mm")
    assert preset.sensor_mm == (None if sensor is None else tuple(sensor))
    assert preset.focal_length_mm == facts.get("focal_length_mm")


def test_a_sensor_of_another_shape_than_its_pixels_is_refused():
    data = {
        "source": "s",
        "sensor_mm": [6.16, 4.62],
        "focal_length_mm": 4.5,
        "size_px": [3840, 2160],
    }
    with pytest.raises(InvalidInput, match=r"camera X: .*not be square"):
        CameraPreset.from_dict("X", data)


def test_a_horizontal_field_of_view_becomes_the_diagonal_one():
    data = {"source": "s", "horizontal_fov_deg": 60.0, "aspect_ratio": [16, 9]}
    camera = CameraPreset.from_dict("X", data).camera
    assert camera.horizontal_fov_deg == pytest.approx(60.0, abs=1e-12)
    assert camera.aspect_ratio == 16 / 9


def test_a_vertical_field_of_view_and_a_size_in_pixels():
    data = {"vertical_fov_deg": 40.0, "size_px": [3000, 2000]}
    preset = CameraPreset.from_dict("X", data, user=True)
    assert preset.camera.vertical_fov_deg == pytest.approx(40.0, abs=1e-12)
    assert (preset.camera.aspect_ratio, preset.width_px, preset.height_px) == (1.5, 3000, 2000)
    assert (preset.source, preset.user, preset.sensor_mm) == ("", True, None)
    assert preset.image_px == 3000


def test_pixels_along_the_longer_side_of_a_shape():
    data = {"fov_deg": 60.0, "aspect_ratio": [2, 3], "image_px": 1001}
    preset = CameraPreset.from_dict("X", data, user=True)
    assert (preset.image_px, preset.width_px, preset.camera.aspect_ratio) == (1001, None, 2 / 3)
    for wrong, says in (
        ({"image_px": 100.5}, "image_px 100.5: must be a whole number"),
        ({"image_px": 0}, "image_px 0: must be a number above 0"),
        ({"size_px": [2, 3], "aspect_ratio": None}, "size_px and image_px: give one of the two"),
    ):
        with pytest.raises(InvalidInput, match=says):
            CameraPreset.from_dict("X", {**data, **wrong}, user=True)


@pytest.mark.parametrize("name", ["DJI Mavic 3E", "dji mavic 3e", "  DJI  MAVIC 3e ", "mavic 3e"])
def test_names_in_any_case_and_without_the_maker(name):
    assert camera_named(name).name == "DJI Mavic 3E"


def test_an_exact_name_goes_before_one_without_its_maker():
    assert camera_named("DJI Mavic").name == "DJI Mavic"
    assert math.isclose(camera_named("Mavic").camera.fov_deg, 78.8)


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("DJI Mavik Pro", "did you mean DJI Mavic Pro"),
        ("a6000", "did you mean Sony a6000 16 mm"),
        ("Leica", "unknown: `terr"),
    ],
)
def test_unknown_cameras(name, hint):
    with pytest.raises(InvalidInput, match=hint):
        camera_named(name)
