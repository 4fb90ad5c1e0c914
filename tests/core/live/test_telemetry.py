"""Positions of a vehicle's messages: the finer ones serve where they say the same place."""

from __future__ import annotations

import math

import pytest
from terrainav.core.live.following import PoseTrack
from terrainav.core.live.telemetry import Telemetry

pytest.importorskip("pymavlink", reason="its messages are those to read")

from pymavlink.dialects.v20 import common

from tests.core.live.test_following import distance_m
from tests.core.live.vehicles import ORIGIN, TO_LOCAL, path, velocity_ned

#: Largest distance of a position that is rounded to 1e-7 degrees and a millimetre.
ROUNDED_M = math.hypot(0.5e-7 * 111_200.0, 0.5e-7 * 76_500.0, 0.0005) + 1e-4


def topocentric(lat, lon, height):
    east, north, up = TO_LOCAL.transform(lon, lat, height)
    return north, east, -up


def on_a_sphere(lat, lon, height):
    """North, east and down as PX4 counts them: azimuthal equidistant on a sphere of 6371 km."""
    lat0, lon0, lat, lon = (math.radians(angle) for angle in (*ORIGIN[:2], lat, lon))
    cosine = math.sin(lat0) * math.sin(lat) + math.cos(lat0) * math.cos(lat) * math.cos(lon - lon0)
    angle = math.acos(min(cosine, 1.0))
    scale = 6_371_000.0 * (1.0 if angle == 0.0 else angle / math.sin(angle))
    north = scale * (math.cos(lat0) * math.sin(lat) - math.sin(lat0) * math.cos(lat) * math.cos(lon - lon0))
    return north, scale * math.cos(lat) * math.sin(lon - lon0), ORIGIN[2] - height


def fly(local, keep=lambda kind, number: True):
    """Track of a vehicle whose local positions are counted in some way."""
    telemetry = Telemetry(PoseTrack())
    lat, lon, height = ORIGIN
    origin = common.MAVLink_gps_global_origin_message(round(lat * 1e7), round(lon * 1e7), round(height * 1e3))
    telemetry.receive(origin, 0.0)
    for number in range(200):
        time_s, stamp = number * 0.05, number * 50
        lat, lon, height, _ = path(time_s)
        north, east, down = velocity_ned(time_s)
        rounded = (round(lat * 1e7), round(lon * 1e7), round(height * 1e3), 0)
        speeds = (round(north * 100), round(east * 100), round(down * 100), 0)
        messages = {
            "global": common.MAVLink_global_position_int_message(stamp, *rounded, *speeds),
            "local": common.MAVLink_local_position_ned_message(stamp, *local(lat, lon, height), north, east, down),
            "attitude": common.MAVLink_attitude_message(stamp, 0, 0, 0, 0, 0, 0),
        }
        for kind, message in messages.items():
            if keep(kind, number):
                telemetry.receive(message, time_s)
    return telemetry


def worst_m(telemetry):
    times = [1.0 + 0.05 * number for number in range(170)]
    return max(distance_m(telemetry.track.at(time_s), time_s) for time_s in times)


def test_local_positions_serve_where_both_agree():
    telemetry = fly(topocentric)
    assert telemetry.is_fine
    assert worst_m(telemetry) < 1e-5
    # Also where either is lost now and then.
    lost = {"global": 5, "local": 7, "attitude": 11}
    assert worst_m(fly(topocentric, lambda kind, number: number % lost[kind] > 0)) < 1e-3


def test_local_positions_of_another_projection_do_not():
    telemetry = fly(on_a_sphere)
    assert not telemetry.is_fine
    assert 1e-3 < worst_m(telemetry) < ROUNDED_M


def test_global_positions_serve_when_local_ones_end():
    telemetry = fly(topocentric, lambda kind, number: kind != "local" or number < 100)
    assert not telemetry.is_fine
    assert telemetry.track.latest().time_s == pytest.approx(9.95)
