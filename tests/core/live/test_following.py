"""Tracks of poses that arrive late and with gaps, against SciPy's interpolation and PROJ's coordinates."""

from __future__ import annotations

import math

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import image_axes
from terrainav.core.live.following import FURTHEST_S, Mount, PoseTrack, vehicle_quaternion

pytest.importorskip("scipy", reason="its interpolation is that to compare with")
pytest.importorskip("pymavlink", reason="the vehicle speaks MAVLink")

from pyproj import Transformer
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation, Slerp

from tests.core.live.vehicles import attitude, path, velocity_ned

TO_GEOCENTRIC = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)


def geocentric(time_s):
    lat, lon, height, _ = path(time_s)
    return np.array(TO_GEOCENTRIC.transform(lon, lat, height))


def fill(track, times, late=lambda time_s: 0.0):
    """Add the vehicle's poses at times, in the order in which they arrive."""
    for time_s in sorted(times, key=lambda time_s: time_s + late(time_s)):
        arrived_s = time_s + late(time_s)
        track.add_place(time_s, arrived_s, *path(time_s)[:3], velocity_ned(time_s))
        roll, pitch, yaw = np.degrees(attitude(time_s))
        track.add_attitude(time_s, arrived_s, vehicle_quaternion(yaw, pitch, roll))
    return track


def distance_m(pose, time_s):
    found = np.array(TO_GEOCENTRIC.transform(pose.lon_deg, pose.lat_deg, pose.height_m))
    return float(np.linalg.norm(found - geocentric(time_s)))


def test_places_lie_on_the_path_and_attitudes_on_the_shortest_turn():
    times = np.arange(0.0, 8.0, 0.1)
    track = fill(PoseTrack(), times)
    angles = np.array([attitude(time_s)[::-1] for time_s in times])
    turns = Slerp(times, Rotation.from_euler("ZYX", angles))
    for time_s in np.random.default_rng(2).uniform(0.0, times[-1], 200):
        pose = track.at(time_s)
        assert distance_m(pose, time_s) < 1e-5
        expected = turns(time_s).as_matrix()
        assert Rotation.from_quat(pose.quaternion[[1, 2, 3, 0]]).as_matrix() == pytest.approx(expected, abs=1e-9)
        assert pose.extrapolated_s == 0.0


def test_the_order_of_arrival_does_not_matter_and_gaps_are_bridged():
    rng = np.random.default_rng(4)
    times = [time_s for time_s in np.arange(0.0, 8.0, 0.05) if rng.random() > 0.05]
    delays = {time_s: rng.uniform(0.0, 0.08) for time_s in times}
    late, prompt = fill(PoseTrack(), times, delays.get), fill(PoseTrack(), times)
    for time_s in rng.uniform(0.1, times[-1], 100):
        assert late.at(time_s).lat_deg == prompt.at(time_s).lat_deg
        assert distance_m(late.at(time_s), time_s) < 1e-4
    assert late.counts == {"taken": 2 * len(times)}
    # By the pose that arrived soonest, the vehicle's clock is known to its delay.
    assert late.time_s(100.0) == pytest.approx(100.0, abs=0.01)


def test_two_poses_give_the_cubic_with_their_velocities():
    track = fill(PoseTrack(), [1.0, 1.8])
    from_enu = []
    for time_s in (1.0, 1.8):
        lat, lon = np.radians(path(time_s)[:2])
        north, east, down = velocity_ned(time_s)
        axes = np.array(
            [
                [-math.sin(lon), math.cos(lon), 0.0],
                [-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)],
                [math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)],
            ]
        )
        from_enu.append(np.array([east, north, -down]) @ axes)
    spline = CubicHermiteSpline([1.0, 1.8], [geocentric(1.0), geocentric(1.8)], from_enu)
    for time_s in (1.1, 1.4, 1.75):
        pose = track.at(time_s)
        found = TO_GEOCENTRIC.transform(pose.lon_deg, pose.lat_deg, pose.height_m)
        assert found == pytest.approx(spline(time_s), abs=1e-6)


def test_extrapolation_is_bounded_and_stated():
    track = fill(PoseTrack(), [0.0, 0.1])
    pose = track.at(0.1 + FURTHEST_S)
    assert pose.extrapolated_s == pytest.approx(FURTHEST_S)
    # What is left out is half the acceleration times the time squared.
    assert distance_m(pose, 0.1 + FURTHEST_S) < 0.5 * 3.0 * FURTHEST_S**2
    for time_s, words in ((0.2 + FURTHEST_S, "last known"), (-0.1, "that early")):
        with pytest.raises(InvalidInput, match=words):
            track.at(time_s)
    with pytest.raises(InvalidInput, match="none is known for 5"):
        fill(track, [5.1], late=lambda _: 0.0).at(3.0)


NOWHERE = (46.6, 8.1, 150.0, (0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    "place",
    [
        (math.nan, *NOWHERE[1:]),
        (91.0, *NOWHERE[1:]),
        (46.6, 181.0, *NOWHERE[2:]),
        (0.0, 0.0, *NOWHERE[2:]),
        (46.6, 8.1, 1e6, NOWHERE[3]),
        (46.6, 8.1, 150.0, (math.inf, 0.0, 0.0)),
        (46.6, 8.1, 150.0, (5000.0, 0.0, 0.0)),
    ],
)
def test_nonsense_is_dropped_and_counted(place):
    track = fill(PoseTrack(), [0.0, 0.1])
    track.add_place(0.05, 0.1, *place)
    track.add_attitude(0.05, 0.1, np.full(4, math.nan))
    track.add_attitude(0.05, 0.1, np.zeros(4))
    assert track.counts["nonsense"] == 3
    assert distance_m(track.at(0.05), 0.05) < 1e-5


def test_a_stray_pose_and_a_repeated_one_change_nothing():
    track = fill(PoseTrack(), [0.0, 0.1, 0.2])
    track.add_place(0.15, 0.2, *NOWHERE[:1], 8.2, *NOWHERE[2:])
    track.add_place(900.0, 0.2, *path(0.2)[:3], velocity_ned(0.2))
    track.add_place(0.1, 0.2, *NOWHERE)
    assert (track.counts["stray"], track.counts["repeated"]) == (2, 1)
    assert distance_m(track.at(0.15), 0.15) < 1e-5


@pytest.mark.parametrize("shift_s", [-500.0, 500.0])
def test_a_clock_that_jumps_begins_the_track_anew(shift_s):
    track = fill(PoseTrack(), np.arange(0.0, 2.0, 0.1))
    for number, time_s in enumerate(np.arange(2.0, 3.0, 0.1)):
        track.add_place(time_s + shift_s, time_s, *path(time_s)[:3], velocity_ned(time_s))
        track.add_attitude(time_s + shift_s, time_s, np.array([1.0, 0.0, 0.0, 0.0]))
        assert track.counts["restarted"] == (number >= 2)
    assert track.time_s(3.0) == pytest.approx(3.0 + shift_s)
    pose = track.at(2.75 + shift_s)
    assert distance_m(pose, 2.75) < 1e-5
    with pytest.raises(InvalidInput):
        track.at(1.5)


def test_memory_is_bounded():
    track = fill(PoseTrack(), np.arange(0.0, 60.0, 0.05))
    assert len(track._places.times) <= 202
    assert track.latest().time_s == pytest.approx(59.95)


@pytest.mark.parametrize("on_horizon", [True, False])
@pytest.mark.parametrize("on_north", [True, False])
def test_a_mount_turns_as_scipy_says(on_horizon, on_north):
    for yaw, pitch, roll, gimbal_pitch, gimbal_yaw in np.random.default_rng(6).uniform(-80.0, 15.0, (20, 5)):
        mount = Mount(gimbal_pitch, gimbal_yaw, on_horizon, on_north)
        track = fill(PoseTrack(), [0.0])
        pose = track.at(0.0)._replace(quaternion=vehicle_quaternion(yaw, pitch, roll))
        level = [0.0 if on_north else yaw, *((0.0, 0.0) if on_horizon else (pitch, roll))]
        expected = Rotation.from_euler("ZYX", level, degrees=True)
        expected *= Rotation.from_euler("ZY", [gimbal_yaw, gimbal_pitch], degrees=True)
        request = mount.request(pose, 7.0, 3.0)
        right, top, view = image_axes(request.yaw_deg, request.tilt_deg, request.roll_deg)
        for found, axis in ((view, 0), (right, 1), (-top, 2)):
            assert found[[1, 0, 2]] * [1.0, 1.0, -1.0] == pytest.approx(expected.as_matrix()[:, axis], abs=1e-9)
        assert Rotation.from_quat(mount.quaternion(pose.quaternion)[[1, 2, 3, 0]]).as_matrix() == pytest.approx(
            expected.as_matrix(), abs=1e-9
        )
        assert (request.time_s, request.up_m) == (7.0, pytest.approx(pose.height_m + 3.0))
