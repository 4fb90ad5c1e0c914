"""Lines flown at a speed: where the way goes, how fast, and how the aircraft turns and banks."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from pyproj import Geod, Transformer
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.areas.coords import parse_coords
from terrainav.core.poses.line import TOLERANCE_M, fly, read_lines, turn_radius_m
from terrainav.core.poses.settings import LineFlight

from tests.support.command import command

run = pytest.fixture(command, name="run")

GEOD = Geod(ellps="WGS84")
G = 9.80665
#: A square's three sides, a zigzag of short legs, and a dense curve, in metres east and north of a place.
SHAPES = {
    "sides": [(0, 0), (0, 400), (400, 400), (400, 0)],
    "zigzag": [(0, 0), (40, 30), (0, 60), (40, 90), (300, 90)],
    "curve": [(300 * math.sin(a), 300 - 300 * math.cos(a)) for a in np.arange(0.0, 3.0, 0.05)],
}
#: At middle latitudes, across the antimeridian, and 22 km from the pole.
PLACES = [(35.0, -90.0), (-17.0, 179.999), (89.8, 40.0)]


def line(shape, lat, lon, agl=120.0):
    """Corners about a place, by an azimuthal projection of PROJ."""
    back = Transformer.from_crs(f"+proj=aeqd +lat_0={lat} +lon_0={lon}", 4326, always_xy=True)
    lons, lats = back.transform(*np.array(SHAPES[shape], float).T)
    return np.stack([lats, lons, np.full(len(lats), agl)], axis=1)


def arrays(points):
    return (*np.array(points.poses).T, np.array(points.yaws_deg), np.array(points.times_s))


def apart(lat, lon):
    _, _, distance = GEOD.inv(lon[:-1], lat[:-1], lon[1:], lat[1:])
    return distance


def wrapped(angle):
    return (angle + 180.0) % 360.0 - 180.0


def off_line(corners, lat, lon):
    """Metres from places to a line that is straight in degrees, on a plane about its first corner."""
    there = Transformer.from_crs(4326, f"+proj=aeqd +lat_0={corners[0][0]} +lon_0={corners[0][1]}", always_xy=True)
    lons = corners[0][1] + np.append(0.0, np.cumsum(wrapped(np.diff(corners[:, 1]))))
    sides = np.linspace(0.0, len(corners) - 1.0, 50 * (len(corners) - 1) + 1)
    numbers = np.arange(len(corners))
    dense = np.stack(there.transform(np.interp(sides, numbers, lons), np.interp(sides, numbers, corners[:, 0])), axis=1)
    places = np.stack(there.transform(lon, lat), axis=1)[:, np.newaxis]
    start, along = dense[:-1], np.diff(dense, axis=0)
    share = np.clip(((places - start) * along).sum(-1) / (along**2).sum(-1), 0.0, 1.0)
    return np.hypot(*np.moveaxis(start + share[..., np.newaxis] * along - places, -1, 0)).min(axis=1)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("shape", SHAPES)
def test_a_line_is_flown_at_its_speed_and_turned_by_its_bank(shape, place):
    corners, flight = line(shape, *place), LineFlight(12.0, every_s=0.1)
    flown = fly([corners], flight, 1000.0)
    lat, lon, _, yaw, time = arrays(flown.points)
    assert time == pytest.approx(1000.0 + 0.1 * np.arange(len(time)), abs=1e-6)
    # A chord of the turn's circle is shorter than its arc by (s / r)² / 24, of 1.2 m and the tightest turn there is.
    speed, tightest = apart(lat, lon) / 0.1, flown.slowest_m_per_s**2 / (G * math.tan(math.radians(25.0)))
    assert speed.max() == pytest.approx(12.0, abs=0.01)
    assert speed.min() >= flown.slowest_m_per_s * (1.0 - (0.1 * flown.slowest_m_per_s / tightest) ** 2 / 20.0) - 0.01
    assert (flown.tight > 0) == (flown.slowest_m_per_s < 12.0) == (shape == "zigzag")
    if not flown.tight:
        assert speed.min() == pytest.approx(12.0, abs=0.01)
    # At a bank the rate of a turn is g tan b / v; seen from a pole north turns as well, by the way over the distance.
    north = 0.1 * 12.0 / GEOD.inv(place[1], place[0], 0.0, 90.0)[2]
    turned = np.abs(wrapped(np.diff(yaw)))
    rate = 0.1 * math.degrees(G * math.tan(math.radians(25.0)) / flown.slowest_m_per_s)
    assert turned.max() <= rate + math.degrees(1.1 * north) + 1e-6
    # The top of the image points along the way: to the next place, but for half of the turn on the way there, and a
    # little more where it is faster behind the turn.
    ahead, _, _ = GEOD.inv(lon[:-1], lat[:-1], lon[1:], lat[1:])
    assert np.abs(wrapped(ahead - yaw[:-1])).max() <= 0.52 * rate + 0.01
    # It is nowhere further off the line than corners are missed, and it misses one by that.
    far = off_line(corners, lat, lon)
    assert far.max() <= flown.missed_m + TOLERANCE_M
    distances = [
        GEOD.inv(np.full(len(lon), corner[1]), np.full(len(lat), corner[0]), lon, lat)[2].min()
        for corner in corners[1:-1]
    ]
    # To the nearest exposure, which may be half a step off.
    assert flown.missed_m - 1e-3 <= max(distances) <= math.hypot(flown.missed_m, 0.6) + 0.01


def test_a_right_angle_is_cut_by_the_circle_of_the_speed_and_the_bank():
    flight = LineFlight(20.0, every_m=1.0, bank_deg=30.0, fixed_camera=True)
    radius = 20.0**2 / (G * math.tan(math.radians(30.0)))
    assert turn_radius_m(flight) == pytest.approx(radius)
    flown = fly([line("sides", 35.0, -90.0)], flight)
    assert flown.missed_m == pytest.approx(radius * (math.sqrt(2.0) - 1.0), rel=1e-5)
    *_, yaw, time = arrays(flown.points)
    # Two corners, each shorter by what the arc saves: 2 r - π r / 2.
    assert time[-1] == pytest.approx((1200.0 - 2.0 * (2.0 - math.pi / 2.0) * radius) / 20.0, abs=1.0 / 20.0)
    roll = np.array(flown.points.rolls_deg)
    # In the middle of a right turn the right side is down by the bank; away from turns it is level.
    middle = np.argmin(np.abs(yaw - 45.0))
    assert roll[middle] == pytest.approx(30.0)
    assert roll[0] == roll[len(roll) // 2] == roll[-1] == 0.0
    assert np.abs(np.diff(roll) / np.diff(time)).max() <= 30.0 * (1.0 + 1e-4)
    # Turned as far as the mean bank says, when it sets in and ends.
    banked = ((roll[:-1] + roll[1:]) / 2.0 * np.diff(time)).sum() / 30.0
    assert banked * math.degrees(20.0 / radius) == pytest.approx(180.0, rel=1e-3)


def test_left_turns_bank_to_the_left_and_heights_rise_along_the_line():
    corners = line("sides", 35.0, -90.0)[::-1]
    corners[:, 2] = (100.0, 200.0, 200.0, 100.0)
    flown = fly([corners], LineFlight(8.0, every_m=2.0, fixed_camera=True))
    _, _, agl, _, _ = arrays(flown.points)
    assert max(flown.points.rolls_deg) == 0.0
    assert min(flown.points.rolls_deg) == pytest.approx(-25.0)
    assert agl[100] == pytest.approx(150.0, abs=0.01)
    assert np.abs(np.diff(agl)).max() <= 2.0 * 100.0 / 400.0 * 1.3


def test_long_sides_are_straight_in_degrees():
    """As GeoJSON has them: along a parallel, from which the shortest way would be kilometres off."""
    corners = np.array([[60.0, 178.0, 900.0], [60.0, -178.0, 900.0]])
    lat, lon, *_ = arrays(fly([corners], LineFlight(60.0, every_s=10.0)).points)
    assert np.abs(lat - 60.0).max() * 111_412.0 <= TOLERANCE_M
    assert lon.min() < -179.9 < 179.9 < lon.max()
    # Its length is that of four degrees of the parallel.
    assert (len(lon) - 1) * 600.0 == pytest.approx(4.0 * 55_800.0, abs=600.0)


def test_a_side_across_the_equator_is_straight_in_degrees():
    corners = np.array([[-30.0, 0.0, 900.0], [30.0, 60.0, 900.0]])
    lat, lon, *_ = arrays(fly([corners], LineFlight(100.0, every_m=20_000.0)).points)
    assert len(lat) > 400
    assert np.abs((lon - 30.0 - lat) * np.cos(np.radians(lat))).max() * 111_320.0 <= TOLERANCE_M * math.sqrt(2.0)


def test_lines_are_flown_one_after_the_other():
    first, second = line("sides", 35.0, -90.0), line("curve", 35.01, -90.0)
    flight = LineFlight(10.0, every_s=2.0)
    alone, both = fly([first], flight), fly([first, second], flight)
    count = len(alone.points.poses)
    assert both.points.poses[:count] == alone.points.poses
    assert both.points.poses[count][:2] == pytest.approx(second[0][:2], abs=1e-9)
    # It comes to the end of the first, and goes straight to the second.
    radius = turn_radius_m(flight)
    end_s = (1200.0 - 2.0 * (2.0 - math.pi / 2.0) * radius) / 10.0
    between = GEOD.inv(first[-1][1], first[-1][0], second[0][1], second[0][0])[2]
    assert both.points.times_s[count] == pytest.approx(end_s + between / 10.0, abs=1e-3)


@pytest.mark.parametrize(
    ("flight", "words"),
    [
        ({"speed_m_per_s": 0.0, "every_s": 1.0}, "speed 0.0 m/s: must be from 0.1 to 340"),
        (
            {"speed_m_per_s": 9.0, "every_s": 1.0, "bank_deg": 90.0},
            "bank in turns 90.0 deg: must be from 1 to 80",
        ),
        ({"speed_m_per_s": 9.0}, "interval: must be either in seconds or in metres"),
        ({"speed_m_per_s": 9.0, "every_s": 1.0, "every_m": 1.0}, "interval: must be either"),
        ({"speed_m_per_s": 9.0, "every_m": math.nan}, "distance interval nan m: must be above 0"),
    ],
)
def test_flights_that_are_none(flight, words):
    with pytest.raises(InvalidInput, match=words):
        LineFlight(**flight)


@pytest.mark.parametrize(
    ("corners", "every_m", "words"),
    [
        ([], 1.0, "line 1: is a single place"),
        ([(35.0, -90.0, 100.0)], 1.0, "line 1: is a single place"),
        ([(35.0, -90.0, 100.0), (35.0000005, -90.0, 100.0)], 1.0, "line 1: is a single place"),
        ([(35.0, -90.0, 100.0), (95.0, -90.0, 100.0)], 1.0, "latitude 95.0"),
        ([(35.0, -90.0, 0.0), (35.1, -90.0, 100.0)], 1.0, "above 0"),
        (
            [(35.0, -90.0, 9.0), (36.0, -90.0, 9.0)],
            1e-3,
            "110,949,769 poses: must be from 1 to 10,000,000",
        ),
        (
            [(35.0, -90.0, 9.0), (35.001, -90.0, 9.0), (35.0, -90.0, 9.0)],
            1.0,
            "line 1: turns by 180 degrees at 35.001000, -90.000000, between legs of 110.9 m and 110.9 m",
        ),
    ],
)
def test_lines_that_cannot_be_flown(corners, every_m, words):
    with pytest.raises(InvalidInput, match=words):
        fly([np.array(corners).reshape(-1, 3)], LineFlight(9.0, every_m=every_m))


def test_the_command_writes_what_missions_are_flown_from(run, tmp_path):
    sides = [[lon, lat] for lat, lon, _ in line("sides", 35.0, -90.0).tolist()]
    data = {
        "type": "FeatureCollection",
        "features": [{"type": "Feature", "geometry": {"type": "Point"}}, None],
    }
    data["features"][1] = {"type": "Feature", "geometry": {"type": "MultiLineString", "coordinates": [sides]}}
    (tmp_path / "line.geojson").write_text(json.dumps(data))
    words = "poses line line.geojson --speed 12 --every-s 2 --agl 120 --fixed-camera --start 2024-06-21T10:30:00Z"
    said = run(*words.split(), "--output", "poses.csv")
    assert said.stdout == "49 poses in poses.csv\nturns of 31.5 m, which miss corners by up to 13.0 m\n"
    points, _ = parse_coords(str(tmp_path / "poses.csv"))
    assert points.times_s[:2] == (1_718_965_800.0, 1_718_965_802.0)
    assert {agl for _, _, agl in points.poses} == {120.0}
    assert max(points.rolls_deg) == pytest.approx(25.0)
    tight = run(*"poses line line.geojson --speed 40 --every-m 9 --agl 9 --output q.csv".split())
    assert tight.stdout.splitlines()[2] == "tighter ones between short legs: 2, flown at down to 30.2 m/s"
    assert run(*"poses line no.geojson --speed 9 --every-m 9 --output q.csv".split()).returncode == 2


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({"type": "Point", "coordinates": [0, 1]}, "holds no LineString"),
        ({"type": "FeatureCollection", "features": 7}, "holds no LineString"),
        ({"type": "MultiLineString", "coordinates": [[], None]}, "holds no LineString"),
        ({"type": "LineString", "coordinates": [[0, 1], [0, 2]]}, "have no height above ground"),
        ({"type": "LineString", "coordinates": [[0, 1, 5], [0, 2]]}, "have no height above ground"),
        ({"type": "LineString", "coordinates": [[0, 1, 5], [0]]}, "a corner is not longitude, latitude"),
        (
            {"type": "LineString", "coordinates": [[0, 1, 5], [0, "x", 5]]},
            "a corner is not longitude, latitude",
        ),
        ({"type": "LineString", "coordinates": [[0, 1, 5], 7]}, "a corner is not longitude, latitude"),
    ],
)
def test_files_that_hold_no_line(tmp_path, data, words):
    path = tmp_path / "line.geojson"
    path.write_text(json.dumps(data))
    with pytest.raises(InvalidInput, match=words):
        read_lines(str(path))


def test_third_coordinates_are_heights_above_ground(tmp_path):
    path = tmp_path / "line.geojson"
    path.write_text(json.dumps({"type": "LineString", "coordinates": [[-90, 35, 80], [-90, 35.01, 90]]}))
    assert read_lines(str(path))[0].tolist() == [[35.0, -90.0, 80.0], [35.01, -90.0, 90.0]]
    assert read_lines(str(path), 50.0)[0][:, 2].tolist() == [50.0, 50.0]
