"""What a pilot is told: the camera's interval, the sun, and sorties."""

from __future__ import annotations

import math
import re

import pytest
from pyproj import Geod
from terrainav.core.fields import field_named
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.estimate import estimate
from terrainav.core.mission.flight.path import HOVER_S
from terrainav.core.mission.flight.pilot import (
    ENDURANCE_MIN,
    FLOWN_SHARE,
    Sun,
    airborne_s,
    area_sun,
    interval_s,
    interval_warnings,
    sorties_text,
    speed_limits,
)
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.parts import Route
from terrainav.core.mission.plan import plan

from tests.support.command import command
from tests.support.thinning import sampled

run = pytest.fixture(command, name="run")
GRID = PixelGrid()
FIELD = Mission(Box(35.158, -89.90, 35.155, -89.894), 120.0, overlap_along=0.8, overlap_across=0.5)
HOME = (35.1565, -89.9015)


def planned(**changes):
    return plan(FIELD.replace(**changes), GRID)


def least_step_m(made):
    lon, lat = made.meant.lon_deg, made.meant.lat_deg
    steps = Geod(ellps="WGS84").inv(lon[:-1], lat[:-1], lon[1:], lat[1:])[2]
    return min(step for step, row, next_ in zip(steps, made.row, made.row[1:]) if row == next_)


def test_the_interval_is_that_of_the_shortest_step_at_the_speed_over_ground():
    still = planned()
    step = least_step_m(still)
    assert interval_s(still) == pytest.approx(step / 15.0, rel=1e-9)
    assert interval_s(planned(trigger="hover")) == pytest.approx(step / 15.0 + HOVER_S, rel=1e-9)
    # Rows run east and west: one of them has the wind behind it.
    assert interval_s(planned(wind=Wind(5.0, 270.0, 0.0))) == pytest.approx(step / 20.0, rel=1e-4)
    assert interval_s(plan(Mission(Points(((35.0, -89.0, 90.0),)), 90.0), GRID)) is None


@pytest.mark.parametrize("wind", sampled([None, Wind(4.0, 200.0, 0.0), Wind(2.0, 270.0, 0.1)], 3))
@pytest.mark.parametrize("trigger", ["waypoint", "distance", "hover"])
def test_the_speed_that_is_named_is_the_highest_that_does(wind, trigger):
    least_s = 2.6 + (HOVER_S if trigger == "hover" else 0.0)
    fast = planned(photo_interval_s=least_s, wind=wind, trigger=trigger, airspeed_m_per_s=18.0)
    (text,) = interval_warnings(fast)
    assert f"the camera takes one every {least_s:g} s" in text
    speed = float(re.search(r"fly at ([0-9.]+) m/s or slower", text).group(1))
    assert (
        interval_warnings(planned(photo_interval_s=least_s, wind=wind, trigger=trigger, airspeed_m_per_s=speed)) == ()
    )
    faster = planned(photo_interval_s=least_s, wind=wind, trigger=trigger, airspeed_m_per_s=speed + 0.1)
    assert interval_warnings(faster) != ()
    assert text in estimate(fast).warnings


def test_no_speed_does_where_the_wind_alone_is_faster():
    made = planned(photo_interval_s=8.0, wind=Wind(9.0, 270.0, 0.0))
    (text,) = interval_warnings(made)
    assert "overlap less or fly higher" in text
    assert "m/s" not in text


def test_without_an_interval_nothing_is_said():
    assert interval_warnings(planned()) == ()
    assert interval_warnings(planned(photo_interval_s=0.5)) == ()


def ground_speeds(made):
    """Along each leg of a row: what still air leaves of the airspeed, by vectors."""
    lon, lat, wind = made.meant.lon_deg, made.meant.lat_deg, made.mission.wind
    azimuth = Geod(ellps="WGS84").inv(lon[:-1], lat[:-1], lon[1:], lat[1:])[0]
    found = []
    for one, row, next_ in zip(azimuth, made.row, made.row[1:]):
        if row == next_:
            off = math.radians(one - (wind.from_deg + 180.0)) if wind else 0.0
            blowing = wind.speed_m_per_s if wind else 0.0
            airspeed = made.mission.flight.airspeed_m_per_s
            found.append(blowing * math.cos(off) + math.sqrt(airspeed**2 - (blowing * math.sin(off)) ** 2))
    return found


@pytest.mark.parametrize("wind", sampled([None, Wind(4.0, 200.0, 0.0), Wind(2.0, 270.0, 0.1)], 3))
@pytest.mark.parametrize(("exposure_ms", "blur_px"), [(10.0, 0.5), (4.0, 0.3)])
def test_at_the_greatest_speed_the_ground_moves_as_far_as_allowed(wind, exposure_ms, blur_px):
    asked = {"wind": wind, "exposure_ms": exposure_ms, "blur_px": blur_px, "image_px": 1000}
    made = planned(**asked)
    limit = speed_limits(made).blur_m_per_s
    (camera,) = (made.mission.camera,)
    # A pinhole camera's longer side, straight down from 120 m.
    diagonal = 2.0 * 120.0 * math.tan(math.radians(camera.fov_deg) / 2.0)
    gsd_m = diagonal / math.hypot(1.0, 1.0 / camera.aspect_ratio) / 1000

    def blur(speed):
        return max(ground_speeds(planned(**asked, airspeed_m_per_s=speed))) * exposure_ms / 1000.0 / gsd_m

    assert blur(limit) <= blur_px * (1.0 + 1e-6) < blur(limit + 0.1)
    assert interval_warnings(planned(**asked, airspeed_m_per_s=limit)) == ()
    (text,) = interval_warnings(planned(**asked, airspeed_m_per_s=limit + 0.1))
    assert f"more than {blur_px:g} px; fly at {limit:g} m/s or slower" in text
    assert speed_limits(planned(**asked, trigger="hover")).blur_m_per_s is None


def test_the_lower_limit_stands_first():
    summary = estimate(planned(exposure_ms=2.0, photo_interval_s=5.0, image_px=4000))
    text = str(dict(summary.lines())["greatest speed"])
    assert text.index("for an image every 5 s") < text.index("for 0.5 px of blur in 2 ms")
    assert "greatest speed" not in dict(estimate(planned()).lines())


@pytest.mark.parametrize("takeoff", [None, HOME])
def test_time_from_take_off_to_landing_has_the_climb_the_way_home_and_the_landing(takeoff):
    made = planned(takeoff=takeoff)
    lon, lat = made.meant.lon_deg.tolist(), made.meant.lat_deg.tolist()
    home = takeoff or (lat[0], lon[0])
    lat, lon = [home[0], *lat, home[0]], [home[1], *lon, home[1]]
    way_m = sum(Geod(ellps="WGS84").inv(lon[:-1], lat[:-1], lon[1:], lat[1:])[2])
    assert airborne_s(made) == pytest.approx([120.0 / 3.0 + way_m / 15.0 + 120.0 / 1.0], rel=1e-9)


def test_every_drone_has_an_endurance_and_batteries_follow_from_it():
    assert set(ENDURANCE_MIN) == set(field_named(Route, "drone").choices)
    made = planned(airspeed_m_per_s=1.0, drone="m350")
    (seconds,) = airborne_s(made)
    assert estimate(made).batteries == math.ceil(seconds / (60.0 * 55.0 * FLOWN_SHARE)) > 1
    split = planned(takeoff=HOME, battery_min=4.0)
    assert estimate(split).batteries == split.path.sorties > 1


def test_the_command_chooses_the_greatest_speed(run, tmp_path):
    field = ("plan", "--coords", "35.158_-89.90_35.155_-89.894_120", "--overlap", "0.8", "--airspeed", "auto")
    said = run(*field, "--photo-interval", "3", "--exposure-ms", "20", "--image-px", "2000", "--output", "auto.json")
    limits = speed_limits(plan(Mission.load(tmp_path / "auto.json"), GRID))
    assert said.returncode == 0
    assert Mission.load(tmp_path / "auto.json").flight.airspeed_m_per_s == limits.least_m_per_s < 15.0
    assert "no speed" not in said.stderr
    assert "needs a limit of the camera" in run(*field).stderr


def test_the_sun_is_told_where_the_start_is():
    assert area_sun(planned()) is None
    sun = area_sun(planned(start="2024-12-21T15:00:00Z"))
    # As pvlib has it in the middle of Memphis, a few kilometres away.
    assert sun.height_deg == pytest.approx(17.83, abs=0.05)
    assert sun.azimuth_deg == pytest.approx(137.52, abs=0.05)
    assert sun.end_azimuth_deg > sun.azimuth_deg
    said = dict(estimate(planned(start="2024-12-21T15:00:00Z")).lines())
    assert said["sun"] == "18° high in the south-east: long shadows"
    assert "sun" not in dict(estimate(planned()).lines())


@pytest.mark.parametrize(("first_s", "is_told"), [(946_684_800.0, False), (1_718_965_800.0, True)])
def test_the_sun_is_not_told_of_a_line_that_is_flown_from_no_start(first_s, is_told):
    line = Points(((35.0, -89.0, 90.0), (35.0, -89.001, 90.0)), times_s=(first_s, first_s + 6.0))
    assert (area_sun(plan(Mission(line, 90.0), GRID)) is not None) == is_told


@pytest.mark.parametrize(
    ("sun", "fov", "text"),
    [
        (Sun(45.0, 100.0, 45.2, 104.0), 60.0, "45° high in the east"),
        (
            Sun(38.0, 200.0, 29.0, 230.0),
            60.0,
            "38° high in the south, at the end 29° high in the south-west: long shadows",
        ),
        (
            Sun(64.0, 350.0, 66.0, 10.0),
            60.0,
            "64° high in the north, at the end 66° high in the north: a bright spot",
        ),
        (Sun(64.0, 350.0, 64.0, 350.0), 0.0, "64° high in the north"),
        (
            Sun(-3.0, 271.0, -4.0, 272.0),
            60.0,
            "3° below the horizon in the west, at the end 4° below the horizon",
        ),
        (Sun(40.0, 359.9, 40.0, 0.1), 60.0, "40° high in the north"),
    ],
)
def test_the_sun_in_words(sun, fov, text):
    assert str(sun.text(fov)).startswith(text)
    if sun.end_height_deg < 0.0:
        assert str(sun.text(fov)).endswith(": night")


def test_sorties_are_told_one_by_one_or_by_their_range():
    assert str(sorties_text((600.0, 90.0), 12.0)) == "2: 10.0, 1.5 of 12 min"
    assert str(sorties_text(tuple(60.0 * count for count in range(3, 12)), 12.5)) == "9: 3.0 to 11.0 of 12.5 min"


def test_figures_of_the_path_are_those_of_all_sorties():
    made = planned(takeoff=HOME, battery_min=5.0)
    summary = estimate(made)
    assert summary.path_m == made.path.distance_m
    assert summary.sorties_s == tuple(made.path.sorties_s)
    assert summary.path_s == pytest.approx(math.fsum(summary.sorties_s))
    said = dict(summary.lines())
    assert said["flight path"].endswith("min with turns")
    assert said["sorties"].endswith("of 5 min")
    assert summary.to_dict()["battery_min"] == 5.0
    plain = estimate(planned())
    assert plain.path_m is None
    assert not {"flight path", "sorties", "sun"} & set(dict(plain.lines()))
