"""Inertial measurements: integrated by a program that shares no code, and judged by their Allan deviations."""

from __future__ import annotations

import allantools
import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.gravity import normal_gravity
from terrainav.core.geodesy.local import geocentric
from terrainav.core.sequences.inertial import Inertial, exact_inertial, measured_inertial
from terrainav.core.sequences.settings import UNITS, InertialErrors
from terrainav.core.sequences.trajectory import (
    Rig,
    Trajectory,
    evaluate_spline,
    spline_slopes,
)

from tests.support import strapdown

START_US = 1_718_965_800_000_000


def winding(seconds=61.0, rig=None, lat=46.2, every_s=0.1):
    """A climbing, banking flight along a spiral, the camera turning about all axes."""
    t = np.round(np.arange(0.0, seconds + every_s / 2, every_s), 6)
    angle = 0.2 * t + 0.3 * np.sin(0.5 * t)
    north, east = 80.0 * np.sin(angle) + 3.0 * t, 80.0 * np.cos(angle)
    height = 500.0 + 15.0 * np.sin(0.3 * t)
    lat_deg, lon_deg = lat + north / 111_000.0, -122.2 + east / 77_000.0
    attitude = np.degrees(angle), 20.0 + 15.0 * np.sin(0.7 * t), 25.0 * np.sin(0.9 * t)
    return Trajectory.through_cameras(t, lat_deg, lon_deg, height, attitude, rig or Rig(), START_US)


@pytest.mark.parametrize(
    ("lat", "lon", "height"), [(0.0, 10.0, 0.0), (45.0, -60.0, 3000.0), (90.0, 0.0, 100.0), (-67.0, 170.0, 9000.0)]
)
def test_normal_gravity_is_that_of_zonal_harmonics(lat, lon, height):
    place = geocentric(lat, lon, height)
    earth = np.array([0.0, 0.0, strapdown.OMEGA])
    expected = strapdown.gravitation(place) - np.cross(earth, np.cross(earth, place))
    assert normal_gravity(place[np.newaxis])[0] == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize(("lat", "expected"), [(0.0, 9.7803253359), (90.0, 9.8321849378)])
def test_normal_gravity_on_the_ellipsoid_is_that_of_the_standard(lat, expected):
    assert np.linalg.norm(normal_gravity(geocentric(lat, 0.0)[np.newaxis])) == pytest.approx(expected, abs=1e-9)


def test_splines_are_those_of_scipy():
    random = np.random.default_rng(3)
    knots = np.cumsum(random.uniform(0.1, 1.0, 40))
    values = random.normal(size=(40, 3))
    reference = CubicSpline(knots, values)
    at = np.linspace(knots[0], knots[-1], 999)
    for order, found in enumerate(evaluate_spline(knots, values, spline_slopes(knots, values), at)):
        assert found == pytest.approx(reference(at, order), abs=1e-10)


@pytest.mark.parametrize(
    ("rig", "lat"),
    [(Rig(), 46.2), (Rig("camera", (0.1, -0.05, 0.2)), -89.99), (Rig("urf", (-1.0, 0.5, 0.3)), 0.0)],
    ids=["frd", "camera", "urf"],
)
def test_integrated_exact_measurements_return_to_the_pose(rig, lat):
    flown = winding(rig=rig, lat=lat)
    step_s, count = 0.005, 12_001
    motion = flown.at(np.arange(count) * step_s)
    measured = exact_inertial(motion)
    first = Rotation.from_matrix(motion.rotation[0]).as_quat()[[3, 0, 1, 2]]
    place, speed, q = strapdown.integrate(*measured, step_s, motion.place_m[0], motion.velocity_m_per_s[0], first)
    turn = Rotation.from_quat(q[[1, 2, 3, 0]]).inv() * Rotation.from_matrix(motion.rotation[-1])
    assert np.linalg.norm(place - motion.place_m[-1]) < 0.05
    assert np.degrees(turn.magnitude()) < 0.01
    assert np.linalg.norm(speed - motion.velocity_m_per_s[-1]) < 1e-3


def test_an_inertial_unit_at_rest_measures_gravity_and_the_turning_earth():
    t = np.arange(10.0)
    still = np.full(10, 30.0), np.full(10, 7.0), np.full(10, 120.0)
    flown = Trajectory.through_cameras(t, *still, (np.zeros(10), np.zeros(10), np.zeros(10)), Rig("flu"), START_US)
    measured = exact_inertial(flown.at(np.array([4.5])))
    gravity = np.linalg.norm(normal_gravity(geocentric(30.0, 7.0, 120.0)[np.newaxis]))
    # Forward is north, left west. The plumb line is off the ellipsoid's normal by microradians at this height.
    assert measured.force_m_per_s2[0] == pytest.approx([0.0, 0.0, gravity], abs=1e-5)
    expected = strapdown.OMEGA * np.array([np.cos(np.radians(30.0)), 0.0, np.sin(np.radians(30.0))])
    assert measured.rate_rad_per_s[0] == pytest.approx(expected, abs=1e-12)


def test_the_camera_is_where_it_was_given():
    flown = winding(rig=Rig("flu", (0.3, 0.1, -0.2)))
    rig, t = Rig("flu", (0.3, 0.1, -0.2)), flown.knots_s
    _, _, height, (_, tilt, roll) = rig.camera(flown.at(t))
    assert height == pytest.approx(500.0 + 15.0 * np.sin(0.3 * t), abs=1e-6)
    assert tilt == pytest.approx(20.0 + 15.0 * np.sin(0.7 * t), abs=1e-9)
    assert roll == pytest.approx(25.0 * np.sin(0.9 * t), abs=1e-9)


def test_rates_of_turn_are_those_of_the_attitude():
    flown = winding()
    t, step = np.linspace(1.0, 60.0, 50), 1e-4
    before, after = (Rotation.from_matrix(flown.at(t + d).rotation) for d in (-step, step))
    assert flown.at(t).rate_rad_per_s == pytest.approx((before.inv() * after).as_rotvec() / (2.0 * step), abs=1e-6)


@pytest.fixture(scope="module")
def noise():
    """Ten hours of a resting unit at 100 Hz: gyros with noise and walk of one size, accelerometers of another."""
    errors = InertialErrors(gyro_noise=2e-4, gyro_walk=1e-5, accelerometer_noise=2e-3, accelerometer_walk=1e-4)
    rest = Inertial(np.zeros((3_600_000, 3)), np.zeros((3_600_000, 3)))
    return measured_inertial(rest, errors, 100.0, 7)[0]


@pytest.mark.parametrize(("kind", "white", "walk"), [(0, 2e-4, 1e-5), (1, 2e-3, 1e-4)], ids=["gyros", "accelerometers"])
def test_allan_deviations_are_those_asked_for(noise, kind, white, walk):
    # At 1 s white noise has a deviation of its density; the walk's is that of its density by sqrt(tau / 3).
    for tau, expected in (
        (1.0, np.hypot(white, walk / np.sqrt(3.0))),
        (300.0, np.hypot(white / np.sqrt(300.0), walk * 10.0)),
    ):
        found = [allantools.oadev(axis, rate=100.0, data_type="freq", taus=[tau])[1][0] for axis in noise[kind].T]
        assert np.sqrt(np.mean(np.square(found))) == pytest.approx(expected, rel=0.1)


def test_errors_are_the_same_for_a_longer_flight_and_another_for_another_seed():
    errors, _ = UNITS["euroc"]
    exact = exact_inertial(winding().at(np.arange(400) * 0.005))
    whole, biases = measured_inertial(exact, errors, 200.0, 1)
    part, _ = measured_inertial(Inertial(*(one[:100] for one in exact)), errors, 200.0, 1)
    other, _ = measured_inertial(exact, errors, 200.0, 2)
    assert (whole.force_m_per_s2[:100] == part.force_m_per_s2).all()
    assert (whole.force_m_per_s2 != other.force_m_per_s2).all()
    assert (biases.rate_rad_per_s[0] == 0.0).all()


def test_first_biases_and_scales_have_the_deviations_asked_for():
    errors = InertialErrors(gyro_bias=0.1, accelerometer_scale=0.02)
    exact = Inertial(np.zeros((2, 3)), np.ones((2, 3)))
    drawn = [measured_inertial(exact, errors, 100.0, seed)[0] for seed in range(400)]
    assert np.std([one.rate_rad_per_s[0] for one in drawn]) == pytest.approx(0.1, rel=0.1)
    assert np.std([one.force_m_per_s2[0] for one in drawn]) == pytest.approx(0.02, rel=0.1)


def test_an_ideal_unit_measures_what_is_exact():
    exact = exact_inertial(winding().at(np.arange(400) * 0.005))
    measured, _ = measured_inertial(exact, UNITS["ideal"][0], 200.0, 1)
    assert all((one == other).all() for one, other in zip(exact, measured))


def test_a_negative_figure_is_refused():
    with pytest.raises(InvalidInput, match="gyro_noise -1: must be 0 or more"):
        InertialErrors(gyro_noise=-1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t, h, yaw: (t[:3], h[:3], yaw[:3]), "trajectory of 3 poses: needs at least 4"),
        (lambda t, h, yaw: (np.where(t == 5.0, 4.9, t), h, yaw), r"pose 51 has the time of the one before it, 4\.9 s"),
        (lambda t, h, yaw: (t, np.where(t == 5.0, h + 9.0, h), yaw), r"jumps at pose 51, 5 s after the start"),
        (lambda t, h, yaw: (t, h, np.where(t == 5.0, 120.0, yaw)), "jumps by 120 deg from pose 50 to the next"),
    ],
    ids=["few", "time twice", "height", "turn"],
)
def test_bad_trajectories_are_refused(change, message):
    t = np.round(np.arange(0.0, 10.0, 0.1), 6)
    t, height, yaw = change(t, np.full(100, 300.0), np.zeros(100))
    level = np.zeros_like(t)
    with pytest.raises(InvalidInput, match=message):
        Trajectory.through_cameras(t, 46.0 + t * 1e-5, level, height, (yaw, level, level), Rig(), START_US)


def test_a_smoothed_trajectory_is_a_b_spline():
    t = np.arange(0.0, 41.0)
    corner = np.where(t < 20.0, 0.0, (t - 20.0) * 1e-4)
    level = np.zeros_like(t)
    flown, smooth = (
        Trajectory.through_cameras(
            t, 46.0 + corner, level, level + 100.0, (level, level, level), Rig(), START_US, interval_s
        )
        for interval_s in (0.0, 4.0)
    )
    motion = smooth.at(np.linspace(0.0, 40.0, 500))
    assert np.linalg.norm(motion.acceleration_m_per_s2, axis=1).max() < 1.1 * 11.1 / 4.0
    off = np.linalg.norm(smooth.at(t).place_m - flown.at(t).place_m, axis=1)
    # A corner is cut by a sixth of the change of velocity by the interval.
    assert off.max() == pytest.approx(11.1 * 4.0 / 6.0, rel=0.01)
