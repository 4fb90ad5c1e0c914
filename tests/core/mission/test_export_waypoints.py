"""Waypoints and flight lines: what is asked of an aircraft."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import CORNERS, Camera
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.export.rows import clock
from terrainav.core.mission.export.waypoints import flight_line, waypoint_notes, waypoints
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.outlines import cut_line

from tests.core.mission.flights import ACROSS, ALONE, HERE, IN_WIND, worked_out


def test_waypoints_are_the_captures_in_flight_order():
    flown = worked_out(HERE)
    points = list(waypoints(flown))
    assert [one.name for one in points] == flown.names
    assert [(one.column, one.row) for one in points] == list(zip(flown.column, flown.row))
    assert [(one.lat_deg, one.lon_deg, one.agl_m) for one in points] == list(
        zip(flown.lat_deg, flown.lon_deg, flown.agl_m)
    )
    assert {(one.heading_deg, one.gimbal_pitch_deg) for one in points} == {(330.0, -70.0)}
    start = datetime(2024, 6, 21, 10, 30, 0, 250_000, tzinfo=timezone.utc)
    for one, seconds in zip(points, flown.times_s.tolist()):
        time = datetime.strptime(one.time, "%Y-%m-%dT%H:%M:%S.%fZ").replace(tzinfo=timezone.utc)
        assert abs(time - start - timedelta(seconds=seconds)) <= timedelta(milliseconds=0.51)
    assert points[0].time == "2024-06-21T10:30:00.250Z"


def test_wind_moves_pictures_but_not_waypoints():
    flown = worked_out(IN_WIND)
    places = [(one.lat_deg, one.lon_deg, one.heading_deg) for one in waypoints(flown)]
    assert places == [(one.lat_deg, one.lon_deg, one.heading_deg) for one in waypoints(worked_out(HERE))]
    assert not np.isin(flown.lat_deg, [place[0] for place in places]).any()
    assert waypoint_notes(flown) == ("wind is left out: waypoints are at the planned positions",)


@pytest.mark.parametrize("yaw", [0.0, 37.0, 200.0, -180.0])
@pytest.mark.parametrize("roll", [0.0, 3.0])
def test_a_view_to_the_rear_is_one_to_the_front_of_an_aircraft_turned_around(yaw, roll):
    mission = ALONE.replace(yaw_deg=yaw, tilt_deg=-25.0)
    (point,) = waypoints(worked_out(mission))
    assert point.gimbal_pitch_deg == -65.0
    assert 0.0 <= point.heading_deg < 360.0
    # The same corners of the ground, each in the opposite corner of the picture.
    camera = Camera()
    meant = camera.rays_enu(CORNERS, yaw, -25.0, roll)
    flown = camera.rays_enu(CORNERS, point.heading_deg, point.gimbal_pitch_deg + 90.0, -roll)
    np.testing.assert_allclose(flown, np.roll(meant, 2, axis=0), atol=1e-14)
    assert "upside down" in waypoint_notes(worked_out(mission))[0]


def test_a_heading_a_hair_west_of_north_is_below_360():
    (point,) = waypoints(worked_out(ALONE.replace(yaw_deg=-1e-20)))
    assert point.heading_deg == 0.0


def test_a_roll_is_said_to_be_left_out():
    assert waypoint_notes(worked_out(ALONE.replace(roll_deg=5.0))) == (
        "the roll of 5 deg is left out: waypoints have none",
    )
    assert waypoint_notes(worked_out(ALONE)) == ()


def test_times_before_1970_and_over_a_leap_day():
    assert clock("1969-12-31T23:59:59.9Z", np.array([0.0, 0.1, 0.2504])) == [
        "1969-12-31T23:59:59.900Z",
        "1970-01-01T00:00:00.000Z",
        "1970-01-01T00:00:00.150Z",
    ]
    assert clock("2024-02-28T00:00:00Z", np.array([86_400.0])) == ["2024-02-29T00:00:00.000Z"]


def test_a_line_is_cut_where_it_crosses_the_antimeridian():
    lon, lat, agl = np.array([179.0, -179.0, 178.0]), np.array([0.0, 2.0, 5.0]), np.array([10.0, 20.0, 50.0])
    parts = cut_line(lon, lat, agl)
    assert [tuple(map(list, part)) for part in parts] == [
        ([179.0, 180.0], [0.0, 1.0], [10.0, 15.0]),
        ([-180.0, -179.0, -180.0], [1.0, 2.0, 3.0], [15.0, 20.0, 30.0]),
        ([180.0, 178.0], [3.0, 5.0], [30.0, 50.0]),
    ]


def test_longitudes_beyond_180_and_single_places():
    ((lon, _, _),) = cut_line(np.array([190.0, 200.0]), np.zeros(2), np.ones(2))
    assert lon.tolist() == [-170.0, -160.0]
    ((lon, lat, agl),) = cut_line(np.array([3.0]), np.array([4.0]), np.array([5.0]))
    assert (lon.tolist(), lat.tolist(), agl.tolist()) == ([3.0], [4.0], [5.0])


def test_lines_go_through_every_waypoint_and_stay_within_180():
    flown = worked_out(ACROSS)
    parts = flight_line(flown)
    assert len(parts) == flown.rows + 1  # each row crosses once, and the next begins where it ended
    places = {(one.lat_deg, one.lon_deg) for one in waypoints(flown)}
    drawn = {(y, x) for lon, lat, _ in parts for x, y in zip(lon.tolist(), lat.tolist())}
    found = [min(abs(y - lat) + abs(x - lon) for y, x in drawn) for lat, lon in places]
    assert max(found) < 1e-12
    assert all(np.abs(lon).max() <= 180.0 and np.ptp(lon) < 1.0 for lon, _, _ in parts)


def test_long_lines_keep_the_ends_of_their_rows(monkeypatch):
    monkeypatch.setattr("terrainav.core.mission.export.waypoints.LINE_POINTS", 200)
    flown = worked_out(Mission(Box(35.2, -89.95, 35.15, -89.85), 120.0))
    assert len(flown) > 600
    ((lon, lat, _),) = flight_line(flown)
    assert len(lon) <= 400
    drawn = set(zip(lon.tolist(), lat.tolist()))
    ends = [*np.flatnonzero(np.diff(flown.row)), *(np.flatnonzero(np.diff(flown.row)) + 1), 0, len(flown) - 1]
    assert {(flown.lon_deg[end], flown.lat_deg[end]) for end in ends} <= drawn


def test_long_lines_of_short_rows_stay_short(monkeypatch):
    monkeypatch.setattr("terrainav.core.mission.export.waypoints.LINE_POINTS", 50)
    poses = tuple((10.0 + index * 1e-3, 20.0, 100.0) for index in range(500))
    flown = worked_out(Mission(Points(poses), 100.0))
    ((_, lat, _),) = flight_line(flown)
    assert len(lat) <= 102
    assert (lat[0], lat[-1]) == (poses[0][0], poses[-1][0])


def test_a_flight_beyond_the_years_of_four_digits_is_refused():
    start = "9999-12-31T23:59:59Z"
    assert clock(start, np.array([0.999])) == ["9999-12-31T23:59:59.999Z"]
    with pytest.raises(InvalidInput, match="goes beyond the year 9999; start earlier"):
        clock(start, np.array([0.0, 1.0]))
