"""Values that a mission varies from image to image: what may vary, and the poses of its plans."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from pyproj import Geod
from terrainav.core.camera.varying import Variation
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid, wrap_lon_deg
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.export.rows import COLUMNS
from terrainav.core.mission.export.writing import write_plan
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.settings import build_mission, resolve

GRID = PixelGrid()
FIELD = Box(47.41, 8.50, 47.36, 8.62)


def planned(*vary, **changes):
    values = {"area": FIELD, "agl_m": 100.0, **changes}
    return plan(Mission(values.pop("area"), values.pop("agl_m"), vary=vary, **values), GRID)


@pytest.fixture(scope="module")
def all_varied():
    """A plan of over 2,000 images, all of whose poses vary."""
    return planned(
        "east_m=normal(0,8)within(-30,30)",
        "north_m=uniform(-20,20)",
        "agl_m=triangular(80,90,140)",
        "yaw_deg=uniform(-180,180)",
        "tilt_deg=normal(0,3)within(-15,15)",
        "roll_deg=normal(1,2)within(-15,15)",
    )


def distribution_of(stats, name):
    return {
        "east_m": stats.truncnorm(-3.75, 3.75, 0.0, 8.0),
        "north_m": stats.uniform(-20.0, 40.0),
        "agl_m": stats.triang(1.0 / 6.0, 80.0, 60.0),
        "yaw_deg": stats.uniform(-180.0, 360.0),
        "tilt_deg": stats.truncnorm(-5.0, 5.0, 0.0, 3.0),
        "roll_deg": stats.truncnorm(-8.0, 7.0, 1.0, 2.0),
    }[name]


@pytest.mark.parametrize("name", ["east_m", "north_m", "agl_m", "yaw_deg", "tilt_deg", "roll_deg"])
def test_poses_have_the_distributions_that_were_asked_for(all_varied, name):
    stats = pytest.importorskip("scipy.stats")
    meant, flown = all_varied.meant, all_varied.poses
    assert len(all_varied) > 2000
    if name in ("east_m", "north_m"):
        azimuth, _, length_m = Geod(ellps="WGS84").inv(meant.lon_deg, meant.lat_deg, flown.lon_deg, flown.lat_deg)
        found = length_m * (np.sin if name == "east_m" else np.cos)(np.radians(azimuth))
    else:
        found = getattr(flown, name)
    assert stats.kstest(found[:2000], distribution_of(stats, name).cdf).pvalue > 0.01


def test_rows_are_where_they_are_without(all_varied):
    still = planned(frame="camera")
    for name in ("lat_deg", "lon_deg", "agl_m", "yaw_deg", "tilt_deg"):
        np.testing.assert_array_equal(getattr(all_varied.meant, name), getattr(still.poses, name))


def test_a_height_takes_the_place_of_the_missions():
    made = planned("agl_m=uniform(90,110)", area=Points(((47.0, 8.0, 100.0), (47.0, 8.1, 300.0))))
    alone = planned("agl_m=uniform(90,110)", area=Points(((47.0, 8.0, 100.0),)))
    assert 90.0 <= made.agl_m[0] <= 110.0
    assert 290.0 <= made.agl_m[1] <= 310.0
    # Another point changes nothing.
    assert made.agl_m[0] == alone.agl_m[0]


def test_an_angle_turns_with_its_row():
    made = planned("yaw_deg=uniform(-5,5)", facing="track", order="serpentine", row_azimuth_deg=30.0)
    away = wrap_lon_deg(made.poses.yaw_deg - made.meant.yaw_deg)
    assert np.abs(away).max() <= 5.0
    assert np.abs(away).max() > 4.0
    assert len(np.unique(np.round(made.meant.yaw_deg))) == 2


def test_poses_in_wind_vary_as_well():
    from terrainav.core.mission.flight.wind import Wind

    wind = Wind(5.0, 270.0, 0.2)
    both, only = planned("east_m=uniform(-20,20)", wind=wind), planned(wind=wind)
    _, _, moved_m = Geod(ellps="WGS84").inv(only.lon_deg, only.lat_deg, both.lon_deg, both.lat_deg)
    assert 19.0 < moved_m.max() <= 20.0
    np.testing.assert_array_equal(both.poses.yaw_deg, only.poses.yaw_deg)


@pytest.mark.parametrize("lat_deg", [-89.9, 60.0, 84.9])
def test_offsets_are_metres_anywhere(lat_deg):
    texts = ("east_m=choice(30)", "north_m=choice(-40)")
    if abs(lat_deg) > 85.0:
        with pytest.raises(InvalidInput, match="beyond the map"):
            planned(*texts, area=Points(((lat_deg, 179.9999, 100.0),)))
        return
    made = planned(*texts, area=Points(((lat_deg, 179.9999, 100.0),)))
    azimuth, _, length_m = Geod(ellps="WGS84").inv(
        made.meant.lon_deg[0], made.meant.lat_deg[0], made.lon_deg[0], made.lat_deg[0]
    )
    assert length_m == pytest.approx(50.0, abs=1e-6)
    assert azimuth == pytest.approx(90.0 + np.degrees(np.arctan2(40.0, 30.0)), abs=1e-4)
    # Longitudes go on across the antimeridian.
    assert abs(made.lon_deg[0] - 179.9999) < 0.01


def test_a_field_does_not_depend_on_others():
    one, both = planned("agl_m=uniform(90,110)"), planned("east_m=uniform(0,4)", "agl_m=uniform(90,110)")
    np.testing.assert_array_equal(one.agl_m, both.agl_m)
    assert (planned("agl_m=uniform(90,110)", seed=1).agl_m != one.agl_m).all()


def test_a_part_of_a_plan_has_its_values():
    made = planned("east_m=uniform(-9,9)")
    which = np.array([7, 3, 100])
    part = made.part(which)
    assert [part.drawn(index) for index in range(3)] == [made.drawn(index) for index in which.tolist()]
    assert set(made.drawn(0)) == {"east_m"}


def test_images_that_turn_are_as_the_camera_sees_them():
    assert planned("agl_m=uniform(90,110)", "east_m=uniform(-1,1)").frames.on_map
    made = planned("roll_deg=uniform(-5,5)")
    assert not made.frames.on_map
    assert "turned at random" in dict(made.accuracy.lines())["method of image"]


def test_preview_estimate_and_files_show_the_poses_that_are_flown(tmp_path):
    made = planned("east_m=uniform(-20,20)", "yaw_deg=uniform(-180,180)", area=Box(47.402, 8.50, 47.40, 8.503))
    write_plan(made, tmp_path / "plan.geojson")
    drawn = json.loads((tmp_path / "plan.geojson").read_text())["features"]
    for index, feature in enumerate(drawn):
        lon, lat = np.array(feature["geometry"]["coordinates"][0][:4]).T
        corners_lon, corners_lat = made.corners.lon_deg[index], made.corners.lat_deg[index]
        assert {(round(x, 6), round(y, 6)) for x, y in zip(lon, lat)} == {
            (round(x, 6), round(y, 6)) for x, y in zip(corners_lon, corners_lat)
        }
    assert made.coverage.share < planned(area=Box(47.402, 8.50, 47.40, 8.503)).coverage.share == 1.0


SENSOR = {"image_sensor": "custom", "pixel_um": 3.0, "quantum_efficiency": 0.6, "full_well_e": 1e4}


def test_values_of_the_camera_have_the_distributions_that_were_asked_for():
    stats = pytest.importorskip("scipy.stats")
    made = planned(
        "exposure_ms=lognormal(4,0.5)", "prnu=triangular(0,0.01,0.02)", "read_noise_e=uniform(1,9)", **SENSOR
    )
    drawn = [made.drawn(index) for index in range(2000)]
    for name, known in (
        ("exposure_ms", stats.lognorm(0.5, scale=4.0)),
        ("prnu", stats.triang(0.5, 0.0, 0.02)),
        ("read_noise_e", stats.uniform(1.0, 8.0)),
    ):
        assert stats.kstest([values[name] for values in drawn], known.cdf).pvalue > 0.01


def test_lenses_have_the_distributions_that_were_asked_for():
    stats = pytest.importorskip("scipy.stats")
    made = planned("k1=normal(0,0.02)within(-0.06,0.06)", "fov_deg=uniform(60,70)", "red_scale=uniform(0,0.01)")
    drawn = [made.drawn(index) for index in range(2000)]
    for name, known in (
        ("k1", stats.truncnorm(-3.0, 3.0, 0.0, 0.02)),
        ("fov_deg", stats.uniform(60.0, 10.0)),
        ("red_scale", stats.uniform(0.0, 0.01)),
    ):
        assert stats.kstest([values[name] for values in drawn], known.cdf).pvalue > 0.01


def test_rows_are_those_of_the_missions_camera():
    given = {"area": Box(47.402, 8.50, 47.40, 8.503), "camera": Camera(60.0), "frame": "camera"}
    made, still = planned("fov_deg=uniform(50,75)", "k1=uniform(-0.1,0)", **given), planned(**given)
    for one, other in zip(made.poses, still.poses):
        np.testing.assert_array_equal(one, other)
    assert made.coverage.share < still.coverage.share == 1.0
    part = made.part(np.array([4, 2]))
    assert [part.camera(0), part.camera(1)] == [made.camera(4), made.camera(2)]
    assert still.camera(3) is still.mission.camera
    own = made.camera(2)
    assert own == Camera(made.drawn(2)["fov_deg"], k1=made.drawn(2)["k1"])
    assert planned("k1=choice(0.1)", **given).frames.on_map is False


def test_the_camera_of_an_image_has_its_values():
    made = planned("exposure_ms=lognormal(4,0.5)", "read_noise_e=uniform(1,9)", "east_m=uniform(-1,1)", **SENSOR)
    for index in (0, 7, 1000):
        settings, drawn = made.settings(index), made.drawn(index)
        assert set(drawn) == {"exposure_ms", "read_noise_e", "east_m"}
        assert settings.route.exposure_ms == drawn["exposure_ms"]
        assert settings.sensor.read_noise_e == settings.sensor.figures["read_noise_e"] == drawn["read_noise_e"]
        assert settings.replace(exposure_ms=None, read_noise_e=None, vary=made.mission.varied.vary) == made.mission
    assert made.drawn(0) != made.drawn(1)


def test_tables_of_plans_have_the_values_that_are_drawn(tmp_path):
    made = planned("exposure_ms=lognormal(4,0.5)", "east_m=uniform(-1,1)", "tilt_deg=uniform(0,4)", **SENSOR)
    write_plan(made, tmp_path / "plan.csv")
    with (tmp_path / "plan.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == (*COLUMNS, "east_m", "exposure_ms")
    assert [float(row["tilt_deg"]) for row in rows] == made.poses.tilt_deg.tolist()
    write_plan(made, tmp_path / "plan.geojson")
    features = json.loads((tmp_path / "plan.geojson").read_text())["features"]
    for stated in (rows, [feature["properties"] for feature in features]):
        assert [{name: float(values[name]) for name in ("east_m", "exposure_ms")} for values in stated] == [
            made.drawn(index) for index in range(len(made))
        ]
    write_plan(planned(), tmp_path / "ideal.csv")
    assert (tmp_path / "ideal.csv").read_text().split("\n")[0] == ",".join(COLUMNS)


def test_values_of_light_go_to_its_effects():
    from terrainav.core.picture.effects import effects

    texts = ("white_balance_k=uniform(4500,7500)", "iso=choice(100,400)", "visibility_km=loguniform(5,50)")
    made = planned(*texts, exposure="manual", exposure_ms=4.0)
    for index in range(3):
        drawn, chain = made.drawn(index), effects(made.settings(index))
        haze, exposed, balance = chain
        assert haze.visibility_km == drawn["visibility_km"]
        assert exposed.control.iso == drawn["iso"]
        assert balance.temperature_k == drawn["white_balance_k"]
    assert effects(made.mission) != chain


def test_the_longest_exposure_that_may_be_drawn_ends_before_the_next_image():
    kept = {"exposure": "manual", "exposure_ms": 4.0, "airspeed_m_per_s": 40.0, "area": Box(47.41, 8.50, 47.405, 8.51)}
    assert len(planned("exposure_ms=lognormal(4,0.5)", **kept))
    with pytest.raises(InvalidInput, match="exposure time 9999"):
        planned("exposure_ms=uniform(1,9999.99)", **kept)
    with pytest.raises(InvalidInput, match="exposure and reading of rows take"):
        planned("row_time_us=uniform(1,9999)", **kept)


def test_values_are_drawn_by_seed_and_name_of_the_image():
    made = planned("read_noise_e=uniform(1,9)", map_types=("satellite", "roadmap"), seed=5, **SENSOR)
    variation = Variation.from_text("read_noise_e=uniform(1,9)")
    drawn = [made.drawn(index) for index in range(50)]
    assert [values["read_noise_e"] for values in drawn] == [variation.draw(5, name) for name in made.names[:50]]
    part = made.part(np.arange(3, 40, 5))
    assert [part.drawn(index) for index in range(len(part))] == drawn[3:40:5]


@pytest.mark.parametrize("name", ["flight.plan", "flight.kml", "flight.gpkg"])
def test_flights_for_drones_are_along_the_planned_poses(tmp_path, name):
    if name.endswith(".gpkg"):
        pytest.importorskip("osgeo.ogr")
    flight = {"area": Box(47.402, 8.50, 47.40, 8.503), "frame": "camera"}
    random = write_plan(planned("east_m=uniform(-20,20)", **flight), tmp_path / f"random.{name}")
    assert any("random poses" in note for note in random.notes)
    assert not any("wind" in note for note in random.notes)
    if name.endswith(".plan"):
        still = write_plan(planned(**flight), tmp_path / f"still.{name}")
        assert [path.read_bytes() for path in random.files] == [path.read_bytes() for path in still.files]


def test_whole_numbers_are_drawn_whole():
    made = planned("adc_bits=uniform(8,12)", **SENSOR)
    drawn = [made.drawn(index)["adc_bits"] for index in range(2000)]
    assert all(type(value) is int for value in drawn)
    counts = np.bincount(drawn)[8:]
    # Each of five is as likely: 400 of 2,000, with a deviation of 18.
    assert np.abs(counts - 400).max() < 4 * 18
    assert len(counts) == 5


@pytest.mark.parametrize(
    ("texts", "why"),
    [
        (("agl_m=normal(100,10)",), "has no bounds, and height above ground must be above 0; add bounds"),
        (("agl_m=uniform(-1,5)",), "height above ground -1.0 m: must be above 0"),
        (("tilt_deg=uniform(0,181)",), "tilt 181.0 deg: must be from -180 to 180"),
        (("tilt_deg=normal(0,1)",), "has no bounds, and tilt must be from -180 to 180"),
        (("tilt_deg=lognormal(1,1)",), "has no bounds"),
        (("layout=uniform(0,1)",), "layout may not vary: fields that may are east_m, north_m, agl_m"),
        (("high=uniform(0,1)",), "high may not vary: fields that may are east_m"),
        (("agl_m=uniform(90,110)", "agl_m=uniform(80,110)"), "agl_m appears twice"),
        (("white_balance=uniform(4500,7500)",), "white_balance may not vary: did you mean white_balance_k?"),
        (("agl_m",), "must be as exposure_ms=lognormal(4,0.5)"),
        ((4.0,), "must be text"),
        (("agl_m=choice(100,1e10)",), "at most"),
        (("aspect_ratio=uniform(1,2)",), "the images of a mission have one shape; plan a mission for each"),
        (("lens=choice(0,1)",), "lens may not vary: fields that may are east_m"),
        (("fov_deg=normal(60,5)",), "has no bounds, and field of view must be between 0 and 180"),
        (("principal_x=uniform(0,0.6)",), "principal point, right 0.6: must be from -0.5 to 0.5"),
        (("k1=uniform(-0.7,0)",), "with k1 -0.7, lens distortion: folds the image at 0.46 focal lengths"),
        (("exposure_ms=normal(4,1)",), "has no bounds, and exposure time must be above 0"),
        (("exposure_ms=lognormal(9000,0.5)",), "must be at most 10000"),
        (("row_time_us=lognormal(10,1)",), "has no bounds, and row time must be from 0 to 10000"),
        (("read_noise_e=uniform(1,9)",), "needs an image sensor; name one"),
    ],
)
def test_what_cannot_vary_is_refused_in_one_line(texts, why):
    with pytest.raises(InvalidInput) as wrong:
        planned(*texts)
    assert why in str(wrong.value)
    assert "\n" not in str(wrong.value)
    assert wrong.value.field == "vary"


def test_cameras_on_the_ground_are_refused():
    with pytest.raises(InvalidInput, match="one of the cameras would be -"):
        planned("agl_m=uniform(90,110)", area=Points(((47.0, 8.0, 100.0), (47.0, 8.1, 0.5))), agl_m=200.0)


def test_heights_may_have_a_tail_where_only_their_arithmetic_is_bounded():
    made = planned("agl_m=lognormal(100,0.1)")
    assert 60.0 < made.agl_m.min() < 80.0
    assert made.agl_m.max() > 130.0


def test_the_command_takes_several_fields():
    given = {"coords": "47.41_8.50_47.40_8.52_100", "vary": ("agl_m=uniform(90,110)", "tilt_deg=uniform(0,4)")}
    mission = build_mission(resolve(given, {}))
    assert mission.varied.vary == given["vary"]
    assert Mission.from_json(mission.to_json()) == mission
    in_environment = {"TERRAINAV_VARY": "agl_m=uniform(90,110) tilt_deg=uniform(0,4)"}
    assert build_mission(resolve({"coords": given["coords"]}, in_environment)) == mission


def test_missions_without_are_as_they_were():
    mission = Mission(FIELD, 100.0, Camera(60.0))
    assert "varied" not in mission.to_dict()
    assert plan(mission, GRID).settings(0) is mission
    assert plan(mission, GRID).drawn(0) == {}
