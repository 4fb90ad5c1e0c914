"""Flight in wind: the discretisation against 50 digits, the gusts against their specification, the sample paths."""

from __future__ import annotations

import dataclasses
import itertools
import json
import math
from functools import cache

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.flight import gusts, motion
from terrainav.core.mission.flight.gusts import LinearSystem, factor
from terrainav.core.mission.flight.motion import fly
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.units import M_PER_FT

from tests.support.thinning import sampled

SIGMA, AIRSPEED, AGL_M = 1.4, 15.0, 120.0
SYSTEM = gusts.flight_system(SIGMA, AIRSPEED, AGL_M)
SIZE = len(gusts.STATES)
BREEZE = Wind(speed_m_per_s=8.0, from_deg=250.0, turbulence=0.175)

# Largest error seen: 1e-13 of the states' sigmas in the covariance, 1e-15 in the exponential.
COVARIANCE_TOLERANCE = 1e-12
EXPONENTIAL_TOLERANCE = 1e-14

steps = st.floats(-4.0, 2.0).map(lambda power: 10.0**power)


def stepped(step_s, system=SYSTEM):
    change, covariance = system.discretise(np.array([step_s]))
    return np.eye(len(change[0])) + change[0], covariance[0]


def in_sigmas(difference, covariance):
    """Largest entry of a difference of covariances, in units of the sigmas of its row and column."""
    sigma = np.sqrt(np.diag(covariance))
    return float(np.abs(difference / np.outer(sigma, sigma)).max())


def steady(count, interval_s=4.0):
    return np.full(max(count - 1, 0), interval_s), np.full(count, 90.0), np.full(count, AGL_M)


# ----------------------------------------------------------------------------------------- discretisation


def van_loan(states, step_s):
    """exp(A dt) and Q of some states, by Van Loan's block exponential in one go: with digits to spare it is right."""
    with mpmath.workdps(150):
        rows = np.ix_(states, states)
        drift = mpmath.matrix(SYSTEM.drift_per_s[rows].tolist())
        noise = mpmath.matrix(SYSTEM.noise_per_s[rows].tolist())
        size = len(states)
        block = mpmath.matrix(2 * size)
        block[:size, :size], block[:size, size:], block[size:, size:] = -drift, noise, drift.T
        whole = mpmath.expm(block * mpmath.mpf(step_s))
        growth = whole[size:, size:].T
        return growth, growth * whole[:size, size:]


def repeated(step, times):
    """Moments of many steps from those of one."""
    growth, covariance = step
    with mpmath.workdps(150):
        total = None
        while times:
            if times & 1:
                total = (
                    (growth, covariance)
                    if total is None
                    else (growth * total[0], growth * total[1] * growth.T + covariance)
                )
            growth, covariance = growth * growth, growth * covariance * growth.T + covariance
            times >>= 1
        return total


@pytest.fixture(scope="module")
def reference():
    """dt -> states -> moments; the axes are independent, which makes them small enough for mpmath."""
    axes = [
        [i for i, name in enumerate(gusts.STATES) if name.startswith("along")],
        [i for i, name in enumerate(gusts.STATES) if name.startswith(("across", "yaw"))],
        [i for i, name in enumerate(gusts.STATES) if name.startswith(("up", "thrust"))],
    ]
    assert sorted(itertools.chain(*axes)) == list(range(SIZE))
    exactly = cache(lambda axis, step_s: van_loan([*axis], step_s))

    def moments(step_s):
        found = {}
        for axis in map(tuple, axes):
            once = exactly(axis, min(step_s, 0.25))
            matrices = repeated(once, round(step_s / 0.25)) if step_s > 0.25 else once
            found[axis] = tuple(np.array(matrix.tolist(), float) for matrix in matrices)
        return found

    return moments


@pytest.mark.parametrize("step_s", sampled([0.01, 1e-4, 1e-3, 0.25, 1.0, 5.0, 20.0, 100.0, 1e4], 4))
def test_discretisation_against_50_digits(reference, step_s):
    growth, covariance = stepped(step_s)
    seen = np.zeros((SIZE, SIZE), bool)
    for states, (right_growth, right_covariance) in reference(step_s).items():
        rows = np.ix_(states, states)
        seen[rows] = True
        assert np.abs(growth[rows] - right_growth).max() <= EXPONENTIAL_TOLERANCE
        assert in_sigmas(covariance[rows] - right_covariance, right_covariance) <= COVARIANCE_TOLERANCE
        variances = np.diag(right_covariance)
        assert np.abs(np.diag(covariance[rows]) / variances - 1.0).max() <= COVARIANCE_TOLERANCE
    assert not growth[~seen].any()
    assert not covariance[~seen].any()


def test_stationary_covariance_against_50_digits(reference):
    stationary = SYSTEM.stationary_covariance()
    # Five hundred of the longest time constants.
    for states, (_, right) in reference(1e4).items():
        assert in_sigmas(stationary[np.ix_(states, states)] - right, right) <= COVARIANCE_TOLERANCE


@given(steps)
def test_two_halves_make_a_whole_step(step_s):
    growth, covariance = stepped(step_s)
    half_growth, half_covariance = stepped(step_s / 2.0)
    assert np.abs(half_growth @ half_growth - growth).max() <= 1e-11
    twice = half_growth @ half_covariance @ half_growth.T + half_covariance
    # Terms of a product cancel in states that are much smaller than those they follow.
    assert in_sigmas(twice - covariance, covariance) <= 1e-8
    picked = gusts.output_matrix()
    assert np.diag(picked @ twice @ picked.T) == pytest.approx(np.diag(picked @ covariance @ picked.T), rel=1e-11)


@given(steps)
def test_a_stationary_flight_stays_stationary(step_s):
    stationary = SYSTEM.stationary_covariance()
    growth, covariance = stepped(step_s)
    after = growth @ stationary @ growth.T + covariance
    picked = gusts.output_matrix()
    assert np.diag(picked @ after @ picked.T) == pytest.approx(np.diag(picked @ stationary @ picked.T), rel=1e-12)
    assert np.all(np.diag(covariance) <= np.diag(stationary) * (1.0 + 1e-9))


def test_no_step_changes_nothing_and_an_endless_one_forgets():
    growth, covariance = stepped(0.0)
    assert np.array_equal(growth, np.eye(SIZE))
    assert not covariance.any()
    growth, covariance = stepped(1e300)
    stationary = SYSTEM.stationary_covariance()
    assert np.abs(growth).max() <= 1e-15
    assert in_sigmas(covariance - stationary, stationary) <= COVARIANCE_TOLERANCE


def test_steps_of_any_length_together_are_those_taken_alone():
    lengths = np.array([5.0, 0.0, 1e-4, 100.0, 0.3])
    change, covariance = SYSTEM.discretise(lengths)
    for index, step_s in enumerate(lengths):
        alone = SYSTEM.discretise(np.array([step_s]))
        assert np.array_equal(change[index], alone[0][0])
        assert np.array_equal(covariance[index], alone[1][0])


def test_what_has_no_stationary_covariance_is_refused():
    for rate in (0.0, 0.1):
        drift = np.array([[-1.0, 0.0], [0.0, rate]])
        with pytest.raises(InvalidInput, match="stable"):
            LinearSystem(drift, np.eye(2)).stationary_covariance()
    with pytest.raises(InvalidInput, match=r"-1\.0"):
        SYSTEM.discretise(np.array([1.0, -1.0]))


@given(st.floats(-9.0, 4.0).map(lambda power: 10.0**power))
def test_factor_of_a_nearly_singular_covariance(step_s):
    _, covariance = stepped(step_s)
    root = factor(covariance[np.newaxis])[0]
    assert in_sigmas(root @ root.T - covariance, covariance) <= 1e-13


def test_factor_of_a_covariance_without_full_rank():
    thin = np.array([[3.0, 0.0], [4.0, 0.0], [0.0, 1e-9], [0.0, 0.0]])
    covariance = np.stack([thin @ thin.T, np.zeros((4, 4)), np.diag([1e-300, 1.0, 0.0, 1e300])])
    root = factor(covariance)
    assert root @ root.swapaxes(1, 2) == pytest.approx(covariance, rel=1e-15, abs=0.0)
    assert not root[0][:, 2:].any()


# ------------------------------------------------------------------------------------- gusts and aircraft


def response(state_shares, omega_per_s):
    """One-sided spectral density of a sum of states, from the transfer function."""
    row = np.zeros(SIZE)
    for state, share in state_shares.items():
        row[gusts.STATES.index(state)] = share
    resolvent = np.linalg.solve(1j * omega_per_s * np.eye(SIZE) - SYSTEM.drift_per_s.T, row)
    return float(np.real(resolvent @ SYSTEM.noise_per_s @ resolvent.conj())) / math.pi, row


@pytest.mark.parametrize("axis", ["along", "across", "up"])
def test_gusts_have_drydens_spectrum(axis):
    horizontal_m, vertical_m = gusts.scale_lengths_m(AGL_M)
    scale_m = vertical_m if axis == "up" else horizontal_m
    sigma = SIGMA * (gusts.vertical_share(AGL_M) if axis == "up" else 1.0)
    shares = {"along_gust": 1.0}
    if axis != "along":
        shares = {f"{axis}_gust": math.sqrt(3.0), f"{axis}_gust_lagged": 1.0 - math.sqrt(3.0)}
    for omega_per_s in (0.0, 1e-3, 0.05, 0.2, 1.0, 30.0):
        x = (scale_m * omega_per_s / AIRSPEED) ** 2
        spectrum = 2.0 / (1.0 + x) if axis == "along" else (1.0 + 3.0 * x) / (1.0 + x) ** 2
        density, row = response(shares, omega_per_s)
        assert density == pytest.approx(sigma**2 * scale_m / (math.pi * AIRSPEED) * spectrum, rel=1e-12)
    stationary = SYSTEM.stationary_covariance()
    assert row @ stationary @ row == pytest.approx(sigma**2, rel=1e-13)
    # The time over which gusts are correlated: the integral of their correlation function.
    correlated_s = -row @ np.linalg.solve(SYSTEM.drift_per_s, stationary @ row) / sigma**2
    assert correlated_s == pytest.approx(scale_m / AIRSPEED * (1.0 if axis == "along" else 0.5), rel=1e-10)


def test_scale_lengths_are_the_specifications():
    ft = M_PER_FT
    assert gusts.scale_lengths_m(200.0 * ft) == pytest.approx((200.0 / 0.3416**1.2 * ft, 200.0 * ft))
    assert gusts.scale_lengths_m(1000.0 * ft) == pytest.approx((1000.0 * ft, 1000.0 * ft))
    assert gusts.scale_lengths_m(1500.0 * ft) == pytest.approx((1375.0 * ft, 1375.0 * ft))
    assert gusts.scale_lengths_m(8e6) == gusts.scale_lengths_m(2000.0 * ft)
    assert gusts.scale_lengths_m(8e6) == pytest.approx((1750.0 * ft, 1750.0 * ft))
    assert gusts.scale_lengths_m(0.01) == gusts.scale_lengths_m(10.0 * ft)
    assert gusts.vertical_share(1000.0 * ft) == pytest.approx(1.0)
    assert gusts.vertical_share(1e5) == pytest.approx(1.0)
    assert gusts.vertical_share(200.0 * ft) == pytest.approx(0.3416**0.4)


@given(st.floats(0.1, 340.0), st.floats(0.01, 1e7))
def test_stable_at_every_height_and_speed(airspeed_m_per_s, agl_m):
    system = gusts.flight_system(1.0, airspeed_m_per_s, agl_m)
    assert np.linalg.eigvals(system.drift_per_s).real.max() < 0.0
    sigma = np.sqrt(np.diag(gusts.output_matrix() @ system.stationary_covariance() @ gusts.output_matrix().T))
    assert np.all((sigma > 0.0) & (sigma < 1.5))


def test_errors_are_those_of_a_small_aircraft():
    picked = gusts.output_matrix()
    sigma = np.sqrt(np.diag(picked @ SYSTEM.stationary_covariance() @ picked.T))
    assert np.all((sigma[:3] > 0.5) & (sigma[:3] < 1.5))
    assert np.all((np.degrees(sigma[3:]) > 1.5) & (np.degrees(sigma[3:]) < 2.5))


@pytest.mark.parametrize("axis", ["along", "across", "up"])
def test_a_steady_wind_leaves_no_offset(axis):
    push = np.zeros(SIZE)
    push[gusts.STATES.index(f"{axis}_speed")] = 1.0
    settled = -np.linalg.solve(SYSTEM.drift_per_s, push)
    assert abs(settled[gusts.STATES.index(f"{axis}_m")]) <= 1e-12
    assert abs(settled[gusts.STATES.index(f"{axis}_integral")]) > 0.5


# --------------------------------------------------------------------------------------------- sample paths


def test_sampled_moments_are_those_of_the_process():
    pairs = 20_000
    interval_s = np.full(2 * pairs - 1, 1e4)  # pairs that know nothing of each other
    interval_s[::2] = 1.0
    north = np.zeros(2 * pairs)
    flown = fly(Wind(8.0, 0.0, 0.175), AIRSPEED, interval_s, north, np.full(2 * pairs, AGL_M))
    sampled = np.array(
        [flown.north_m, flown.east_m, flown.up_m]
        + [np.radians(angle) for angle in (flown.tilt_deg, flown.roll_deg, flown.yaw_deg)]
    )
    picked = gusts.output_matrix()
    growth, _ = stepped(1.0)
    stationary = SYSTEM.stationary_covariance()
    now = picked @ stationary @ picked.T
    later = picked @ growth @ stationary @ picked.T
    sigma = np.sqrt(np.diag(now))
    # The standard error of a correlation is at most sqrt(2 / pairs); five of them leave 1e-5 for 100 entries.
    bound = 5.0 * math.sqrt(2.0 / pairs)
    first, second = sampled[:, ::2], sampled[:, 1::2]
    for seen, right in ((first @ first.T, now), (second @ second.T, now), (second @ first.T, later)):
        assert np.abs((seen / pairs - right) / np.outer(sigma, sigma)).max() <= bound
    assert np.abs(first.mean(axis=1) / sigma).max() <= 5.0 / math.sqrt(pairs)
    # It would notice an interval taken for twice as long.
    longer = picked @ stepped(2.0)[0] @ stationary @ picked.T
    assert np.abs((longer - later) / np.outer(sigma, sigma)).max() > 2.0 * bound


def test_the_seed_decides_and_a_flight_does_not_depend_on_what_follows():
    count = motion.CHUNK + 100
    interval_s, heading_deg, agl_m = steady(count)
    whole = fly(BREEZE, AIRSPEED, interval_s, heading_deg, agl_m)
    again = fly(BREEZE, AIRSPEED, interval_s, heading_deg, agl_m)
    start = fly(BREEZE, AIRSPEED, interval_s[:50], heading_deg[:51], agl_m[:51])
    other = fly(dataclasses.replace(BREEZE, seed=7), AIRSPEED, interval_s[:50], heading_deg[:51], agl_m[:51])
    for name, values in vars(whole).items():
        assert values.shape == (count,)
        assert np.all(np.isfinite(values))
        assert np.array_equal(values, getattr(again, name))
        assert np.array_equal(values[:51], getattr(start, name))
        assert not np.any(values[:51] == getattr(other, name))


def test_a_flight_is_the_same_everywhere():
    flown = fly(BREEZE, AIRSPEED, np.array([4.0, 0.01]), np.full(3, 90.0), np.full(3, AGL_M))
    for name, values in {
        "east_m": [1.39581186, 1.4262416, 1.42514039],
        "north_m": [-2.38409568, -2.69604898, -2.69460602],
        "up_m": [0.0262093766, 0.359729275, 0.360371619],
        "yaw_deg": [-6.04198276, -5.38029581, -5.38148575],
        "tilt_deg": [-6.04723555, -6.30404782, -6.30173578],
        "roll_deg": [-0.659949511, -1.36363866, -1.35851853],
    }.items():
        assert getattr(flown, name) == pytest.approx(values, abs=2e-6)


def test_a_flight_does_not_depend_on_how_it_is_cut_up(monkeypatch):
    whole = fly(BREEZE, AIRSPEED, *steady(50, interval_s=0.3))
    monkeypatch.setattr(motion, "CHUNK", 7)
    parts = fly(BREEZE, AIRSPEED, *steady(50, interval_s=0.3))
    for name, values in vars(whole).items():
        assert getattr(parts, name) == pytest.approx(values, rel=1e-12, abs=1e-12)


def test_a_flight_goes_to_each_exposure_at_its_height():
    agl_m = np.array([30.0, 120.0, 30.0])
    steps_taken, which = motion._steps(BREEZE.sigma_m_per_s, AIRSPEED, np.array([2.0, 5.0]), agl_m)
    start = gusts.flight_system(BREEZE.sigma_m_per_s, AIRSPEED, 30.0).stationary_covariance()
    root = steps_taken[which[0], :, SIZE:]
    assert not steps_taken[which[0], :, :SIZE].any()
    assert in_sigmas(root @ root.T - start, start) <= 1e-12
    for exposure, interval_s in ((1, 2.0), (2, 5.0)):
        system = gusts.flight_system(BREEZE.sigma_m_per_s, AIRSPEED, float(agl_m[exposure]))
        growth, covariance = stepped(interval_s, system)
        step = steps_taken[which[exposure]]
        assert step[:, :SIZE] == pytest.approx(growth, abs=1e-12)
        assert in_sigmas(step[:, SIZE:] @ step[:, SIZE:].T - covariance, covariance) <= 1e-12


def test_equal_intervals_but_for_rounding_are_one_step():
    interval_s = 4.0 * (1.0 + 1e-14 * np.arange(1000))
    steps_taken, which = motion._steps(BREEZE.sigma_m_per_s, AIRSPEED, interval_s, np.full(1001, AGL_M))
    assert len(steps_taken) == 2
    assert which[0] == 0
    assert np.all(which[1:] == 1)


@given(st.lists(st.tuples(st.floats(3.1, 600.0), st.floats(0.0, 1e6)), min_size=1, max_size=60), st.data())
def test_what_steps_count_as_does_not_depend_on_those_that_follow(monkeypatch_rounding, pairs, data):
    height_m, interval_s = np.array(pairs).T
    kinds, which = motion._kinds(height_m, interval_s)
    assert sorted(set(which.tolist())) == list(range(len(kinds)))
    for values in (np.log(height_m), np.log(np.maximum(interval_s, 1e-9))):
        assert np.abs(values[kinds[which]] - values).max() <= motion.RESOLUTIONS[-1][0] + 1e-9
    count = data.draw(st.integers(1, len(pairs)))
    first_kinds, first_which = motion._kinds(height_m[:count], interval_s[:count])
    assert np.array_equal(first_which, which[:count])
    assert np.array_equal(first_kinds, kinds[: len(first_kinds)])


@pytest.fixture(scope="module")
def monkeypatch_rounding():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(motion, "RESOLUTIONS", ((1e-6, 5), (0.01, 4), (0.1, 6), (1.0, 10_000)))
        yield


def test_flights_of_many_heights_that_begin_alike_are_alike_there():
    count, draw = 3000, np.random.default_rng(5)
    interval_s, agl_m = draw.uniform(3.0, 20.0, count - 1), draw.uniform(60.0, 300.0, count)
    heading_deg = draw.uniform(-180.0, 180.0, count)
    whole = fly(BREEZE, AIRSPEED, interval_s, heading_deg, agl_m)
    for begun in (1, 40, 700, 2500):
        start = fly(BREEZE, AIRSPEED, interval_s[: begun - 1], heading_deg[:begun], agl_m[:begun])
        for name, values in vars(whole).items():
            assert getattr(start, name) == pytest.approx(values[:begun], rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("agl_m", [10.0, 120.0, 700.0])
def test_rounding_does_not_choose_among_the_states_that_a_flight_begins_with(agl_m):
    draw = np.random.default_rng(3)
    for speed in (3.0, 8.0, 12.0, 20.0):
        covariance = gusts.flight_system(1.3, speed, agl_m).stationary_covariance()
        sigma = np.sqrt(np.diag(covariance))
        noise = draw.standard_normal((20, SIZE, SIZE)) * 2e-15 * np.outer(sigma, sigma)
        roots = factor(covariance + (noise + noise.swapaxes(1, 2)) / 2.0)
        assert np.abs((roots - factor(covariance[np.newaxis])) / sigma[:, np.newaxis]).max() < 1e-6


def test_a_flight_of_many_heights_and_intervals():
    count = 6000
    draw = np.random.default_rng(1)
    interval_s, agl_m = 10.0 ** draw.uniform(-4, 2, count - 1), 10.0 ** draw.uniform(0, 4, count)
    steps_taken, which = motion._steps(BREEZE.sigma_m_per_s, AIRSPEED, interval_s, agl_m)
    assert len(steps_taken) <= motion.MOST_STEPS + 1
    assert which.max() == len(steps_taken) - 1
    flown = fly(BREEZE, AIRSPEED, interval_s, draw.uniform(-360, 360, count), agl_m)
    for values in vars(flown).values():
        assert np.all(np.isfinite(values))
        assert 0.1 < values.std() < 4.0


def test_no_time_between_exposures_is_no_change():
    flown = fly(BREEZE, AIRSPEED, *steady(5, interval_s=0.0))
    for values in vars(flown).values():
        assert np.all(values == values[0])


def test_without_gusts_nothing_is_drawn(monkeypatch):
    monkeypatch.setattr(motion, "_sampled", None)
    for calm in (Wind(), Wind(speed_m_per_s=8.0), Wind(turbulence=0.3)):
        for count in (0, 1, 10):
            for values in vars(fly(calm, AIRSPEED, *steady(count))).values():
                assert values.shape == (count,)
                assert not values.any()


@given(st.floats(0.0, 14.9), st.floats(-360.0, 360.0), st.floats(-360.0, 360.0))
def test_the_wind_triangle_closes(speed, from_deg, heading_deg):
    flight = Wind(speed, from_deg)
    ground = flight.ground_speed_m_per_s(heading_deg, AIRSPEED)
    air_deg = heading_deg + flight.crab_deg(heading_deg, AIRSPEED)
    for function in (np.sin, np.cos):
        through_air = 15.0 * function(np.radians(air_deg)) - speed * function(np.radians(from_deg))
        assert through_air == pytest.approx(ground * function(np.radians(heading_deg)), abs=1e-12)
    assert ground > 0.0


def test_the_aircraft_looks_the_same_way_whatever_the_top_of_the_image_is():
    # Small enough that what is not linear in the angles, their products, drops out.
    light = dataclasses.replace(BREEZE, turbulence=1e-6)
    count = 40
    heading_deg = np.linspace(0.0, 360.0, count)
    flight = (light, AIRSPEED, np.full(count - 1, 3.0), heading_deg, np.full(count, AGL_M))
    own = fly(*flight, yaw_deg=heading_deg + light.crab_deg(heading_deg, AIRSPEED))
    centre = ((0.0, 0.0), (1.0, 0.0))
    for yaw_deg in (0.0, 77.0):
        seen = fly(*flight, yaw_deg=yaw_deg)
        aircraft = Camera().rays_enu(
            centre, heading_deg + light.crab_deg(heading_deg, AIRSPEED), own.tilt_deg, own.roll_deg
        )
        camera = Camera().rays_enu(centre, yaw_deg, seen.tilt_deg, seen.roll_deg)
        lean = np.abs(aircraft[:, 0, :2]).max()
        assert lean > 1e-8
        assert np.abs(camera[:, 0] - aircraft[:, 0]).max() <= 1e-6 * lean
        assert np.array_equal(seen.yaw_deg, own.yaw_deg)
        assert np.array_equal(seen.east_m, own.east_m)


def test_position_errors_turn_with_the_flight():
    count = 30
    interval_s, heading_deg, agl_m = steady(count)
    calm_air = Wind(1e-3, 0.0, 300.0)  # gusts without a wind to speak of: no crab
    east = fly(calm_air, AIRSPEED, interval_s, heading_deg, agl_m)
    north = fly(calm_air, AIRSPEED, interval_s, 0.0 * heading_deg, agl_m)
    assert east.east_m == pytest.approx(north.north_m, abs=1e-3)
    assert east.north_m == pytest.approx(-north.east_m, abs=1e-3)
    assert np.array_equal(east.up_m, north.up_m)


def test_wind_is_ready_for_json():
    assert Wind(**json.loads(json.dumps(dataclasses.asdict(BREEZE)))) == BREEZE


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"speed_m_per_s": -1.0}, "wind speed -1.0 m/s"),
        ({"speed_m_per_s": math.nan}, "wind speed nan"),
        ({"from_deg": math.inf}, "wind direction inf deg"),
        ({"turbulence": -0.1}, "turbulence -0.1"),
        ({"turbulence": math.nan}, "turbulence nan"),
        ({"seed": -1}, "seed of the wind -1"),
        ({"seed": 1.5}, "seed of the wind 1.5"),
    ],
)
def test_a_wind_that_cannot_be(changes, says):
    with pytest.raises(InvalidInput, match=says) as refused:
        dataclasses.replace(BREEZE, **changes)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("changes", "airspeed_m_per_s", "says"),
    [
        ({"speed_m_per_s": 15.0}, 15.0, "below the airspeed, 15.0"),
        ({"turbulence": 2.0}, 15.0, "gusts of 16 m/s"),
        ({}, 0.0, "airspeed 0.0 m/s"),
        ({}, math.inf, "airspeed inf"),
        ({}, math.nan, "airspeed nan"),
    ],
)
def test_a_wind_that_cannot_be_flown_in(changes, airspeed_m_per_s, says):
    there = dataclasses.replace(BREEZE, **changes)
    refusals = (
        lambda: fly(there, airspeed_m_per_s, *steady(3)),
        lambda: Mission(Points(((1.0, 2.0, 3.0),)), 3.0, wind=there, airspeed_m_per_s=airspeed_m_per_s),
    )
    for refusal in refusals:
        with pytest.raises(InvalidInput, match=says) as refused:
            refusal()
        assert "\n" not in str(refused.value)
    assert BREEZE.checked(15.0) is BREEZE


@pytest.mark.parametrize(
    ("place", "value", "says"),
    [
        (0, np.ones(3), r"intervals of shape \(3,\): must be \(2,\)"),
        (0, np.array([1.0, -1.0]), "interval -1.0 s"),
        (0, np.array([1.0, np.nan]), "interval nan s"),
        (0, np.array([1.0, np.inf]), "interval inf s"),
        (1, np.array([0.0, np.nan, 0.0]), "heading nan deg"),
        (2, np.array([120.0, 0.0, 120.0]), "height above ground 0.0 m"),
        (2, np.array([120.0, np.inf, 120.0]), "height above ground inf m"),
        (2, np.array(120.0), "heights of shape"),
        (3, np.array(np.nan), "yaw nan deg"),
        (3, np.zeros(2), "yaws of shape"),
    ],
)
@pytest.mark.parametrize("flight", [Wind(), BREEZE])
def test_a_flight_that_cannot_be(flight, place, value, says):
    given_values = [*steady(3), 0.0]
    given_values[place] = value
    with pytest.raises(InvalidInput, match=says):
        fly(flight, AIRSPEED, *given_values)


def test_a_direction_beyond_64_bits_is_a_direction():
    calm, far = Wind(5.0, 0.0), Wind(5.0, 360 * 10**30)
    assert math.isfinite(far.crab_deg(10.0, 12.0))
    assert far.ground_speed_m_per_s(10.0, 12.0) <= calm.ground_speed_m_per_s(180.0, 12.0)
