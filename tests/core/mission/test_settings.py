"""Where an option's value comes from, and what is refused."""

from __future__ import annotations

import json

import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.cameras import add_camera
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.options import OPTIONS, RUN_OPTIONS
from terrainav.core.mission.settings import build_mission, resolve

from tests.support.growth import PROPORTIONAL, growth


@pytest.fixture
def config(tmp_path):
    def write(**options):
        path = tmp_path / "config.json"
        path.write_text(json.dumps(options))
        return str(path)

    return write


def test_the_command_line_comes_before_the_environment_before_the_file_before_the_defaults(config):
    file = config(fov=60, overlap=0.3, seed=7)
    environment = {"TERRAINAV_FOV": "70", "TERRAINAV_OVERLAP": "0.2", "TERRAINAV_UNRELATED": "x"}
    values = resolve({"fov": "80", "overlap": None}, environment, file)
    assert values["fov"] == 80.0
    assert values["overlap"] == (0.2,)
    assert values["seed"] == 7
    assert values["layout"] == "cover"


CAMERA = {"fov", "hfov", "vfov", "camera", "sensor", "focal_length", "aspect_ratio", "image_px"}


@pytest.mark.parametrize(
    ("given", "environment", "file", "left"),
    [
        ({"hfov": "60"}, {}, {"fov": 70}, {"hfov": 60.0}),
        ({"camera": "DJI Mini 2"}, {}, {"fov": 70, "aspect_ratio": [4, 3]}, {"camera": "DJI Mini 2"}),
        (
            {"fov": "60"},
            {},
            {"camera": "DJI Mini 2", "aspect_ratio": [3, 2]},
            {"fov": 60.0, "aspect_ratio": (3.0, 2.0)},
        ),
        ({"vfov": "60"}, {}, {"sensor": [36, 24], "focal_length": 50}, {"vfov": 60.0}),
        ({}, {"TERRAINAV_HFOV": "60"}, {"vfov": 70}, {"hfov": 60.0}),
        ({"fov": "80"}, {"TERRAINAV_HFOV": "60"}, {"camera": "DJI Mini 2"}, {"fov": 80.0}),
        # What goes together may come from two places.
        (
            {"focal_length": "35"},
            {},
            {"sensor": [36, 24], "focal_length": 50},
            {"focal_length": 35.0, "sensor": (36.0, 24.0)},
        ),
        # A camera by name has its own pixels, unless others are asked for where it is, or before it.
        ({"camera": "DJI Mini 2"}, {"TERRAINAV_IMAGE_PX": "900"}, {}, {"camera": "DJI Mini 2"}),
        ({}, {}, {"camera": "NVIG", "image_px": 900}, {"camera": "NVIG", "image_px": 900}),
        ({"image_px": "900"}, {}, {"camera": "NVIG"}, {"camera": "NVIG", "image_px": 900}),
        # What has lost is not even read.
        ({"hfov": "60"}, {"TERRAINAV_FOV": "wide"}, {}, {"hfov": 60.0}),
        # A shape is no camera: this is refused as before.
        (
            {"aspect_ratio": ["3", "2"]},
            {},
            {"camera": "DJI Mini 2"},
            {"aspect_ratio": (3.0, 2.0), "camera": "DJI Mini 2"},
        ),
        # In one place they contradict each other as before.
        ({}, {}, {"fov": 60, "hfov": 50}, {"fov": 60.0, "hfov": 50.0}),
    ],
)
def test_one_way_to_state_the_camera_displaces_the_others_of_later_places(config, given, environment, file, left):
    values = resolve(given, environment, config(**file))
    assert {name: values[name] for name in CAMERA if values[name] is not None} == left


def test_zoom_and_area_displace_their_other_ways_too(config):
    file = config(gsd=0.5, coords="35.1_-89.8_120")
    values = resolve({"zoom": "17", "area": "field.geojson"}, {}, file)
    assert (values["zoom"], values["gsd"]) == (17, None)
    assert (values["area"], values["coords"]) == ("field.geojson", None)
    values = resolve({"gsd": "0.3"}, {}, file)
    assert (values["gsd"], values["coords"]) == (0.3, "35.1_-89.8_120")


def test_a_mission_with_a_camera_of_the_command_line_and_a_field_of_view_of_the_file(config):
    file = config(fov=60, coords="35.1_-89.8_120")
    assert build_mission(resolve({"hfov": "50"}, {}, file)).camera == Camera.from_horizontal_fov(50.0)
    assert build_mission(resolve({"camera": "DJI Mini 2"}, {}, file)).camera != Camera(60.0)


def test_a_file_may_use_hyphens_and_lists(config):
    values = resolve({}, {}, config(**{"aspect-ratio": [16, 9], "map_type": ["roadmap", "terrain"], "upsample": True}))
    assert values["aspect_ratio"] == (16.0, 9.0)
    assert values["map_type"] == ("roadmap", "terrain")
    assert values["upsample"] is True


def test_config_json_of_the_current_folder_is_read(config, tmp_path, monkeypatch):
    config(fov=61)
    monkeypatch.chdir(tmp_path)
    assert resolve({}, {})["fov"] == 61.0


def test_the_environment_may_hold_several_values():
    values = resolve({}, {"TERRAINAV_ASPECT_RATIO": "3 2", "TERRAINAV_IMG_SIZE": "64 48 1"}, None)
    assert values["aspect_ratio"] == (3.0, 2.0)
    assert values["img_size"] == (64, 48, 1)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"fov": "wide"}, "fov 'wide': must be a number"),
        ({"fov": "6_0"}, "fov '6_0': must be a number"),
        ({"zoom": "1_7"}, "zoom '1_7': must be a whole number"),
        ({"overlap": ["6_0%"]}, "overlap '6_0%': must be a share"),
        ({"zoom": "1.5"}, "zoom '1.5': must be a whole number"),
        ({"aspect_ratio": ["4"]}, "takes 2 values"),
        ({"overlap": ["0.1", "0.2", "0.3"]}, "takes 1 to 2 values"),
        ({"layout": "spiral"}, "must be one of cover, paper"),
    ],
)
def test_a_bad_value_is_named(given, says):
    with pytest.raises(InvalidInput) as refused:
        resolve(given, {}, None)
    assert says in str(refused.value)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("{", "cannot be read as JSON"),
        ("[]", "must hold a JSON object"),
        ('{"fow": 3}', "did you mean 'fov'"),
        ('{"fov": "x"}', "'x'"),
    ],
)
def test_a_bad_file_is_named(tmp_path, content, says):
    path = tmp_path / "c.json"
    path.write_text(content)
    with pytest.raises(InvalidInput) as refused:
        resolve({}, {}, str(path))
    assert says in str(refused.value)
    assert "c.json" in str(refused.value)


def test_a_file_asked_for_must_be_there(tmp_path):
    with pytest.raises(InvalidInput, match=r"none\.json"):
        resolve({}, {}, str(tmp_path / "none.json"))


def make(**given):
    return build_mission(resolve(dict(given), {}, None))


def test_the_papers_example():
    mission = make(coords="35.22_-90.07_35.06_-89.73_400", overlap=["0.25"], aspect_ratio=["16", "9"])
    assert mission.area == Box(35.22, -90.07, 35.06, -89.73)
    assert (mission.flight.agl_m, mission.flight.overlap_along, mission.flight.overlap_across) == (
        400.0,
        0.25,
        0.25,
    )
    assert mission.camera.fov_deg == 78.8
    assert mission.camera.aspect_ratio == pytest.approx(16 / 9)


def test_overlap_along_and_across():
    mission = make(coords="35.22_-90.07_35.06_-89.73_400", overlap=["0.8", "0.6"])
    assert (mission.flight.overlap_along, mission.flight.overlap_across) == (0.8, 0.6)


@pytest.mark.parametrize(("given", "shares"), [("60%", (0.6, 0.6)), ("60% 0.3", (0.6, 0.3)), (["7.5 %"], (0.075,) * 2)])
def test_overlap_in_percent_is_the_share(given, shares):
    mission = make(coords="35.22_-90.07_35.06_-89.73_400", overlap=given)
    assert (mission.flight.overlap_along, mission.flight.overlap_across) == shares


def test_a_height_of_its_own_replaces_the_coordinates():
    assert make(coords="35.1_-89.8_120", agl="1000", agl_unit="ft").area == Points(((35.1, -89.8, 304.8),))


def test_a_camera_by_name():
    assert make(coords="35.1_-89.8_120", camera="dji mini 2").camera.fov_deg == pytest.approx(82.4, abs=0.1)


@pytest.mark.parametrize(
    ("given", "image_px"),
    [
        ({}, 640),
        ({"fov": "60"}, 640),
        ({"camera": "Mavic 3E"}, 5280),
        # Of which nobody has stated the pixels.
        ({"camera": "NVIG"}, 640),
        ({"camera": "Mavic 3E", "image_px": "1000"}, 1000),
        ({"image_px": "1000"}, 1000),
    ],
)
def test_a_camera_by_name_brings_its_own_pixels(given, image_px):
    assert make(coords="35.1_-89.8_120", **given).pixels.image_px == image_px


def test_an_image_of_no_pixels_is_refused():
    with pytest.raises(InvalidInput, match="0 px: must be 1 or more"):
        make(coords="35.1_-89.8_120", image_px="0")


@pytest.mark.parametrize(
    ("given", "camera"),
    [
        ({"hfov": "66.6", "aspect_ratio": ["16", "9"]}, Camera.from_horizontal_fov(66.6, 16 / 9)),
        ({"hfov": "66.6"}, Camera.from_horizontal_fov(66.6, 4 / 3)),
        ({"vfov": "40"}, Camera.from_vertical_fov(40.0, 4 / 3)),
        ({"sensor": ["13.2", "8.8"], "focal_length": "8.8"}, Camera.from_sensor((13.2, 8.8), 8.8)),
        (
            {"sensor": ["17.3", "13"], "focal_length": "12.29", "aspect_ratio": ["4", "3"]},
            Camera.from_sensor((17.3, 13.0), 12.29, 4 / 3),
        ),
    ],
)
def test_a_camera_by_other_terms(given, camera):
    assert make(coords="35.1_-89.8_120", **given).camera == camera


def test_a_camera_of_the_user_s_own(tmp_path, monkeypatch):
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path))
    add_camera("Mine", {"fov_deg": 91.0, "aspect_ratio": [3, 2]})
    assert make(coords="35.1_-89.8_120", camera="mine").camera == Camera(91.0, 1.5)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({}, "no coordinates"),
        ({"coords": "1_2_3", "area": "a.geojson"}, "give one of the two"),
        ({"area": "a.geojson"}, "needs a height"),
        ({"coords": "1_2_3", "camera": "DJI Mini 2", "fov": "70"}, "give one of the two"),
        ({"coords": "1_2_3", "camera": "DJI Mini 2", "aspect_ratio": ["4", "3"]}, "give one of the two"),
        ({"coords": "1_2_3", "fov": "70", "hfov": "60"}, "fov 70.0 and hfov 60.0: give one of the two"),
        ({"coords": "1_2_3", "vfov": "70", "hfov": "60"}, "hfov 60.0 and vfov 70.0: give one of the two"),
        (
            {"coords": "1_2_3", "vfov": "70", "sensor": ["36", "24"], "focal_length": "50"},
            "vfov 70.0 and sensor 36 24: give one of the two",
        ),
        ({"coords": "1_2_3", "sensor": ["36", "24"]}, "sensor 36 24: needs focal_length as well"),
        ({"coords": "1_2_3", "focal_length": "50"}, "focal_length 50.0: needs sensor as well"),
        ({"coords": "1_2_3", "focal_length": "50", "fov": "60"}, "focal_length 50.0: needs sensor as well"),
        ({"coords": "1_2_3", "sensor": ["36"], "focal_length": "50"}, "takes 2 values"),
        ({"coords": "1_2_3", "hfov": "180"}, "horizontal field of view 180"),
        ({"coords": "1_2_3", "camera": "DJI Mini"}, "DJI Mini"),
        ({"coords": "1_2_3", "camera": ""}, "camera '' is unknown"),
        ({"coords": "1_2_3", "aspect_ratio": ["0", "3"]}, "aspect ratio 0 3"),
        ({"coords": "1_2_3", "fov": "180"}, "field of view 180"),
        ({"coords": "1_2_3", "overlap": ["60", "0.5"]}, "overlap '60': must be a share from 0 to below 1"),
        ({"coords": "1_2_3", "map_type": ["hybrid"]}, "map types 'hybrid'"),
    ],
)
def test_what_is_missing_or_contradicts_is_named(given, says):
    with pytest.raises(InvalidInput) as refused:
        make(**given)
    assert says in str(refused.value)
    assert "\n" not in str(refused.value)


def test_attitude_budget_and_wind():
    mission = make(
        coords="35.1_-89.8_120",
        yaw="30",
        tilt="60",
        roll="-2",
        ground_height="80",
        error_budget="0.5",
        resampling="bicubic",
        wind=["8", "270", "0.2"],
        airspeed="12",
        seed="7",
    )
    assert (
        mission.attitude.yaw_deg,
        mission.attitude.tilt_deg,
        mission.attitude.roll_deg,
        mission.flight.ground_height_m,
    ) == (30, 60, -2, 80)
    assert (mission.accuracy.error_budget_px, mission.accuracy.resampling) == (0.5, "bicubic")
    assert mission.wind == Wind(8.0, 270.0, 0.2, 7)
    assert mission.flight.airspeed_m_per_s == 12.0
    assert make(coords="35.1_-89.8_120").wind is None
    with pytest.raises(InvalidInput, match="takes 3 values"):
        make(coords="35.1_-89.8_120", wind=["8"])


def test_the_flight():
    mission = make(
        coords="35.22_-90.07_35.06_-89.73_400",
        row_azimuth="127",
        crosshatch=True,
        order="one-way",
        airspeed="12",
        start="2024-06-21T10:30:00Z",
    )
    assert (mission.flight.row_azimuth_deg, mission.flight.crosshatch, mission.flight.order) == (
        127.0,
        True,
        "one-way",
    )
    assert (mission.flight.airspeed_m_per_s, mission.flight.start) == (12.0, "2024-06-21T10:30:00Z")
    assert mission.wind is None
    with pytest.raises(InvalidInput, match=r"option order 'zigzag': must be one of serpentine, one-way"):
        make(coords="35.1_-89.8_120", order="zigzag")


def test_a_height_of_its_own_leaves_the_yaws_of_points(tmp_path):
    file = tmp_path / "p.txt"
    file.write_text("35.1 -89.8 126 10\n35.2 -89.9 80 -20\n")
    area = make(coords=str(file), agl="50").area
    assert area == Points(((35.1, -89.8, 50.0), (35.2, -89.9, 50.0)), (10.0, -20.0))


def test_the_date_is_the_mission_s_and_the_cache_the_run_s():
    values = resolve(
        {"coords": "35.1_-89.8_120", "date": "2021"},
        {"TERRAINAV_CACHE_DIR": "/fast/disk", "TERRAINAV_NO_CACHE": "yes"},
        None,
    )
    assert (values["cache_dir"], values["no_cache"], values["cache_limit"]) == ("/fast/disk", True, None)
    mission = build_mission(values)
    assert mission.imagery.date == "2021"
    assert mission == make(coords="35.1_-89.8_120", date="2021")
    assert mission != make(coords="35.1_-89.8_120", date="2022")
    assert make(coords="35.1_-89.8_120").imagery.date == ""
    assert set(RUN_OPTIONS) <= {option.name for option in OPTIONS}


def test_every_option_explains_itself():
    for option in OPTIONS:
        assert option.help
        assert option.default is None or option.flag or option.read(option.default, "default") == option.default


def test_a_long_crs_is_refused_in_time_that_grows_with_its_length():
    def refuse(characters):
        with pytest.raises(InvalidInput, match="must be a code such as EPSG:2056"):
            Mission(Points(((35.13, -89.87, 120.0),)), 120.0, crs="A" * characters)

    assert growth(refuse, 5_000) < PROPORTIONAL
