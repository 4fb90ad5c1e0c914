"""The integrators that the exact discretisation of wind is compared with, against it and against their theory."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.flight import gusts
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.timing import QUICK

from benchmarks import integrators
from tests.core.mission.test_wind import SYSTEM, in_sigmas, stepped, steps
from tests.support.thinning import examples


@pytest.mark.parametrize(
    ("method", "order"),
    [
        (integrators.EULER_MARUYAMA, 1),
        (integrators.IMPLICIT_EULER, 1),
        (integrators.TRAPEZOID, 2),
    ],
)
def test_methods_converge_at_their_order(method, order):
    _, right = stepped(0.5)
    coarse, fine = (
        in_sigmas(integrators.moments(method, SYSTEM, 0.5, step_s) - right, right) for step_s in (1e-3, 5e-4)
    )
    assert 0.0 < fine < 2e-2
    assert math.log2(coarse / fine) == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize("method", integrators.METHODS)
def test_only_euler_maruyama_has_a_longest_step(method):
    limit_s = integrators.stability_limit_s(method, SYSTEM)
    assert limit_s == math.inf or (method == integrators.EULER_MARUYAMA and 8e-3 < limit_s < 10e-3)
    stationary = SYSTEM.stationary_covariance()
    for step_s in (1e-3, 0.02, 5.0):
        after = integrators.moments(method, SYSTEM, 1000.0 * step_s, step_s, stationary)
        assert not np.isnan(after).any()
        growth = float((np.diag(after) / np.diag(stationary)).max())
        if step_s > limit_s:
            assert growth == math.inf
        elif method == integrators.EXACT:
            assert growth == pytest.approx(1.0, abs=1e-6)
        else:
            assert growth < 1e6


def test_the_stability_limit_is_where_growth_begins():
    limit_s = integrators.stability_limit_s(integrators.EULER_MARUYAMA, SYSTEM)
    for share, grows in ((0.999, False), (1.001, True)):
        mean, _ = integrators.one_step(integrators.EULER_MARUYAMA, SYSTEM, share * limit_s)
        assert (np.abs(np.linalg.eigvals(mean)).max() > 1.0) == grows


@settings(max_examples=examples(20))
@given(steps)
def test_the_exact_method_does_not_care_for_the_step(step_s):
    # Through a hundred steps at most: rounding grows with their number.
    horizon_s = step_s * 100.0
    _, right = stepped(horizon_s)
    picked = gusts.output_matrix()
    many = integrators.moments(integrators.EXACT, SYSTEM, horizon_s, step_s)
    assert np.diag(picked @ many @ picked.T) == pytest.approx(np.diag(picked @ right @ picked.T), rel=1e-11)


def test_methods_start_at_rest_and_refuse_what_they_cannot_step():
    assert not integrators.moments(integrators.EXACT, SYSTEM, 0.0, 1.0).any()
    for arguments, says in (
        (("Heun", SYSTEM, 1.0, 1.0), "method 'Heun'"),
        ((integrators.EXACT, SYSTEM, 1.0, 0.0), "step 0.0 s"),
        ((integrators.EXACT, SYSTEM, math.nan, 1.0), "horizon nan s"),
    ):
        with pytest.raises(InvalidInput, match=says):
            integrators.moments(*arguments)


def test_the_exact_discretisation_is_the_only_exact_one_and_euler_maruyama_ends():
    flight = integrators.measure_flight(Wind(6.0, 250.0, 0.15), 15.0, 4.0, 120.0, QUICK)
    exact = [one for one in flight.integrated if one.method == integrators.EXACT]
    assert len(exact) == 1
    assert exact[0].error < 1e-11
    assert all((one.error or 9.0) > 1e-6 for one in flight.integrated if one.method != integrators.EXACT)
    for one in flight.settled:
        stable = one.method != integrators.EULER_MARUYAMA or one.step_s < 0.0085
        assert (one.error is not None) == stable
        if one.method == integrators.EXACT:
            assert one.error < 1e-9
    table = integrators.flight_table(flight)
    assert [row[0] for row in table.rows] == list(integrators.METHODS)
    assert table.rows[0][1] == "any step"


def test_time_constants_span_milliseconds_to_twenty_seconds():
    constants_s = integrators.time_constants_s(SYSTEM)
    assert 4e-3 < constants_s[0] < 5e-3
    assert 18.0 < constants_s[-1] < 20.0
    assert constants_s[-1] / constants_s[0] > 4e3
