"""The flight: its order, its clock, and points with yaws of their own."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pyproj import Geod
from terrainav.core.geodesy.camera import CORNERS
from terrainav.core.geodesy.ellipsoid import trace
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.estimate import duration_text, estimate
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

GRID = PixelGrid(max_zoom=22, native_zoom=22)
GEOD = Geod(ellps="WGS84")
FIELD = Box(35.16, -89.90, 35.15, -89.88)


def test_times_are_those_of_geodesics_at_the_airspeed():
    worked_out = plan(Mission(FIELD, 120.0, airspeed_m_per_s=12.0), GRID)
    way_m = 0.0
    for index in range(len(worked_out)):
        if index:
            ends = [values[at] for at in (index - 1, index) for values in (worked_out.lon_deg, worked_out.lat_deg)]
            way_m += GEOD.inv(*ends)[2]
        assert worked_out.times_s[index] == pytest.approx(way_m / 12.0, rel=1e-12)
    assert worked_out.times_s[0] == 0.0
    assert worked_out.direct.duration_s == worked_out.times_s[-1]
    assert worked_out.direct.duration_s == pytest.approx(worked_out.direct.distance_m / 12.0, rel=1e-12)


@pytest.mark.parametrize("turbulence", [0.0, 0.2])
def test_against_the_wind_is_slower_than_with_it(turbulence):
    still = Mission(FIELD, 120.0, airspeed_m_per_s=12.0, frame="camera")
    calm, windy = (plan(still.replace(wind=wind), GRID) for wind in (None, Wind(5.0, 270.0, turbulence)))
    row = windy.row
    still_s, moved_s = np.diff(calm.times_s), np.diff(windy.times_s)
    for westward in (False, True):
        along = (row[1:] == row[:-1]) & (row[1:] % 2 == westward)
        # A parallel's geodesics head east and west to a millionth of a degree.
        np.testing.assert_allclose(
            moved_s[along], still_s[along] * 12.0 / (12.0 - 5.0 * (-1) ** (not westward)), rtol=1e-6
        )
    between = row[1:] != row[:-1]
    # Across the wind the way through the air is the hypotenuse.
    np.testing.assert_allclose(moved_s[between], still_s[between] * 12.0 / math.sqrt(144.0 - 25.0), rtol=0.2)


def test_climbs_are_flown_at_the_airspeed():
    up = Points(((35.0, -89.0, 100.0), (35.0, -89.0, 220.0), (35.01, -89.0, 220.0), (35.02, -89.0, 100.0)))
    worked_out = plan(Mission(up, 100.0, airspeed_m_per_s=10.0), GRID)
    leg_m = [GEOD.inv(-89.0, lat, -89.0, lat + 0.01)[2] for lat in (35.0, 35.01)]
    np.testing.assert_allclose(
        np.diff(worked_out.times_s), [12.0, leg_m[0] / 10.0, math.hypot(leg_m[1], 120.0) / 10.0], rtol=1e-9
    )
    assert worked_out.direct.distance_m == pytest.approx(sum(leg_m), rel=1e-12)


def test_one_picture_takes_no_time():
    worked_out = plan(Mission(Points(((35.0, -89.0, 100.0),)), 100.0), GRID)
    assert worked_out.times_s.tolist() == [0.0]
    assert dict(estimate(worked_out).lines())["flight time"] == "0 s"


def test_the_flight_time_is_among_the_figures():
    worked_out = plan(Mission(FIELD, 120.0), GRID)
    summary = estimate(worked_out)
    assert summary.flight_s == worked_out.direct.duration_s == summary.to_dict()["flight_s"]
    assert dict(summary.lines())["flight time"] == duration_text(worked_out.direct.duration_s)
    assert [duration_text(seconds) for seconds in (0.2, 0.6, 89.0, 600.0, 7200.0)] == [
        "0 s",
        "1 s",
        "89 s",
        "10 min",
        "2.0 h",
    ]


@pytest.mark.parametrize("layout", ["cover", "paper"])
def test_one_way_rows_all_begin_at_their_first_column(layout):
    to_and_fro = plan(Mission(FIELD, 120.0, layout=layout), GRID)
    one_way = plan(Mission(FIELD, 120.0, layout=layout, order="one-way"), GRID)
    for made in (to_and_fro, one_way):
        assert (np.diff(made.row) >= 0).all()
    for row in range(one_way.rows):
        assert (np.diff(one_way.column[one_way.row == row]) == 1).all()
        turned = np.diff(to_and_fro.column[to_and_fro.row == row])
        assert (turned == (-1 if row % 2 else 1)).all()
    assert set(one_way.names) == set(to_and_fro.names)
    assert one_way.direct.duration_s > 1.5 * to_and_fro.direct.duration_s
    assert one_way.coverage == to_and_fro.coverage
    assert one_way.overlap == to_and_fro.overlap
    assert one_way.requests == to_and_fro.requests


def test_points_look_where_their_own_yaws_say():
    places = ((35.1, -89.8, 120.0), (35.1, -89.7, 120.0), (35.2, -89.9, 80.0), (35.2, -89.9, 80.0))
    yaws = (0.0, 30.0, -120.0, 360.0)
    mission = Mission(Points(places, yaws), 120.0, yaw_deg=77.0, tilt_deg=20.0)
    worked_out = plan(mission, GRID)
    assert not worked_out.frames.on_map
    assert worked_out.poses.yaw_deg.tolist() == list(yaws)
    for index, (place, yaw) in enumerate(zip(places, yaws)):
        alone = plan(mission.replace(area=Points((place,)), yaw_deg=yaw, agl_m=place[2]), GRID)
        np.testing.assert_array_equal(worked_out.corners.lat_deg[index], alone.corners.lat_deg[0])
        seen = trace(np.array(place[0]), np.array(place[2]), mission.camera.rays_enu(CORNERS, yaw, 20.0, 0.0))
        np.testing.assert_allclose(worked_out.corners.lat_deg[index], seen.lat_deg, rtol=0.0, atol=1e-12)
        np.testing.assert_allclose(worked_out.corners.lon_deg[index] - place[1], seen.dlon_deg, atol=1e-12)
        assert worked_out.views.view(index).bound_px == alone.views.view(0).bound_px
    own = plan(mission.replace(area=Points(places)), GRID)
    assert own.poses.yaw_deg.tolist() == [77.0] * 4


def test_one_yaw_beyond_the_budget_makes_all_pictures_camera_frames():
    places = ((35.1, -89.8, 120.0), (35.1, -89.7, 120.0))
    north_up = Mission(Points(places, (0.0, 0.0)), 120.0, yaw_deg=45.0)
    assert plan(north_up, GRID).frames.on_map
    turned = plan(north_up.replace(area=Points(places, (0.0, 5.0))), GRID)
    assert not turned.frames.on_map
    assert "budget" in turned.accuracy.picture.reason


def test_yaws_of_points_turn_the_wind_s_lean():
    places = tuple((35.1, -89.8 + 0.001 * index, 120.0) for index in range(20))
    wind = Wind(6.0, 250.0, 0.2)
    level = plan(Mission(Points(places), 120.0, wind=wind), GRID)
    turned = plan(Mission(Points(places, (90.0,) * 20), 120.0, wind=wind), GRID)
    assert turned.nominal.yaw_deg.tolist() == [90.0] * 20
    np.testing.assert_allclose(turned.poses.yaw_deg - level.poses.yaw_deg, 90.0)
    # What lifts the view of a north-up image northward rolls one whose top is east to its left.
    np.testing.assert_allclose(turned.poses.roll_deg, level.poses.tilt_deg, atol=1e-12)
    np.testing.assert_allclose(turned.poses.tilt_deg, -level.poses.roll_deg, atol=1e-12)
    assert np.abs(level.poses.tilt_deg).max() > 1e-3
