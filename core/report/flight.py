"""Flight in wind: the exact discretisation and the usual integrators, error against run time and against the step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..mission.choices import DEFAULT_AIRSPEED_M_PER_S
from ..mission.flight import intervals_s, legs
from ..mission.gusts import flight_system
from ..mission.plan import Plan
from ..mission.sde import LinearSystem, factor
from ..mission.wind import Wind, fly
from .timing import QUICK, Effort, Seconds, timed
from .wind_methods import EXACT, METHODS, moments, one_step, stability_limit_s

Floats = NDArray[np.float64]

#: Steps of the integrators in one interval between exposures, at most: powers of two up to it.
_MOST_STEPS, _MOST_STEPS_QUICK = 1 << 14, 1 << 9
#: Steps from which on the stationary covariance is worked out, s: shorter and longer than any mission's.
_SHORTEST_S, _LONGEST_S, _STEPS = 1e-4, 100.0, 37
#: Doublings of a recursion after which it has forgotten where it started, at 1e-4 s for time constants of minutes.
_DOUBLINGS = 40
#: Covariances beyond this are a recursion that grows without end.
_RUNAWAY = 1e30
#: Steps that are timed: the integrators take one after the other.
_TIMED_STEPS = 256
#: Captures whose flight is timed.
_FLOWN = 20_000
#: What stands for a mission's wind where it has no gusts, for what leaving it out saves; flown at the usual airspeed.
_USUAL = Wind(5.0, 0.0, 0.15)
#: Interval where a plan has none of its own, s.
_INTERVAL_S = 10.0


@dataclass(frozen=True)
class Integrated:
    """A method at one step: relative error of the covariance at the next exposure, after so many steps.

    The error is None where the recursion has run away.
    """

    method: str
    count: int
    step_s: float
    error: float | None


@dataclass(frozen=True)
class Settled:
    """A method at one step: relative error of the covariance it settles at; None where it never does."""

    method: str
    step_s: float
    error: float | None


@dataclass(frozen=True)
class Flight:
    """Wind of a mission, by each method.

    Attributes
    ----------
    airspeed_m_per_s : float
    interval_s : float
        Between exposures: median of the plan.
    fastest_s, slowest_s : float
        Time constants of gusts and aircraft.
    limits_s : dict
        Longest stable step of each method.
    step : Seconds
        That one step takes, of whatever method: a product of a matrix and a state, and fresh noise.
    integrated : tuple of Integrated
    settled : tuple of Settled
    """

    wind: Wind
    airspeed_m_per_s: float
    interval_s: float
    fastest_s: float
    slowest_s: float
    limits_s: dict[str, float]
    step: Seconds
    integrated: tuple[Integrated, ...]
    settled: tuple[Settled, ...]


def measure_flight(
    wind: Wind, airspeed_m_per_s: float, interval_s: float, agl_m: float, effort: Effort
) -> Flight:
    """Compare the methods on one flight: gusts of a wind at a height, and an interval between exposures."""
    system = flight_system(wind.sigma_m_per_s, airspeed_m_per_s, agl_m)
    finer = LinearSystem(
        system.drift_per_s.astype(np.longdouble),
        system.noise_per_s.astype(np.longdouble),
    )
    truth = finer.discretise(np.array([interval_s]))[1][0]
    integrated = []
    most = _MOST_STEPS_QUICK if effort is QUICK else _MOST_STEPS
    for method in METHODS:
        counts = [1] if method == EXACT else [1 << power for power in range(most.bit_length())]
        for count in counts:
            step_s = interval_s / count
            found = moments(method, system, interval_s, step_s)
            integrated.append(Integrated(method, count, step_s, _relative(found, truth)))
    stationary = system.stationary_covariance()
    settled = [
        Settled(method, float(step_s), _relative(_settled(method, system, float(step_s)), stationary))
        for method in METHODS
        for step_s in np.geomspace(_SHORTEST_S, _LONGEST_S, _STEPS)
    ]
    constants = system.time_constants_s
    return Flight(
        wind,
        airspeed_m_per_s,
        interval_s,
        float(constants[0]),
        float(constants[-1]),
        {method: stability_limit_s(method, system) for method in METHODS},
        _step(system, interval_s, effort),
        tuple(integrated),
        tuple(settled),
    )


def _relative(found: Floats, truth: Floats) -> float | None:
    """Greatest error of a covariance's entries, in units of the sigmas they are of; None where they ran away."""
    if not np.isfinite(found).all() or np.abs(found).max() > _RUNAWAY:
        return None
    sigma = np.sqrt(np.diagonal(truth))
    known = sigma > 0.0
    scale = sigma[known]
    return float(np.max(np.abs(found - truth)[np.ix_(known, known)] / scale[:, np.newaxis] / scale))


def _settled(method: str, system: LinearSystem, step_s: float) -> Floats:
    """Covariance that a recursion settles at, by doubling the number of its steps."""
    mean, covariance = one_step(method, system, step_s)
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(_DOUBLINGS):
            covariance = covariance + mean @ covariance @ mean.T
            if not np.isfinite(covariance).all() or np.abs(covariance).max() > _RUNAWAY:
                return np.full_like(covariance, np.inf)
            mean = mean @ mean
    # One that does not grow, but does not forget either, has not settled.
    return covariance if np.abs(mean).max() < 1.0 else np.full_like(covariance, np.inf)


def _step(system: LinearSystem, interval_s: float, effort: Effort) -> Seconds:
    """Seconds to take a sampled state one step on."""
    mean, covariance = one_step(EXACT, system, interval_s)
    noise = factor(covariance[np.newaxis])[0]
    deviates = np.random.Generator(np.random.PCG64(1)).standard_normal((_TIMED_STEPS, len(mean)))

    def run() -> None:
        state = np.zeros(len(mean))
        for deviate in deviates:
            state = mean @ state + noise @ deviate

    return timed(run, effort)[1] * (1.0 / _TIMED_STEPS)


def interval_of(plan: Plan) -> float:
    """Median time between exposures of a plan, s."""
    interval_s = np.diff(plan.times_s)
    moving = interval_s[interval_s > 0.0]
    return float(np.median(moving)) if moving.size else _INTERVAL_S


def seconds_of_flight(plan: Plan, effort: Effort) -> Seconds:
    """Seconds that the poses of a whole plan in wind take; of a usual wind where the mission has none."""
    wind, airspeed = plan.mission.wind, plan.mission.airspeed_m_per_s
    if wind is None or wind.sigma_m_per_s == 0.0:
        wind, airspeed = _USUAL, DEFAULT_AIRSPEED_M_PER_S
    gusty, count = wind, min(len(plan), _FLOWN)
    agl = plan.agl_m[:count]
    way = legs(plan.lat_deg[:count], plan.lon_deg[:count])
    interval_s = intervals_s(way, agl, airspeed, gusty)
    _, seconds = timed(lambda: fly(gusty, airspeed, interval_s, way.headings_deg(), agl), effort)
    return seconds * (len(plan) / count)
