"""Flight in wind by the usual integrators, beside the exact discretisation that missions are flown with.

Each is a linear recursion x ← M x + v with v of covariance Q, so that its covariance goes P ← M P Mᵀ + Q: no sampling
noise hides its error. Methods as in Kloeden & Platen 1992, "Numerical Solution of Stochastic Differential Equations":
Euler-Maruyama, and the implicit Euler family with weight 1 (implicit Euler) and one half (the trapezoid).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from terrainav.core.errors import InvalidInput
from terrainav.core.external.drawing import BLUE, FONT, GREEN, ORANGE, VERMILION, dress, new_figure, png
from terrainav.core.mission.flight.gusts import LinearSystem, factor, flight_system
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.plan import Plan
from terrainav.core.report.plots import Look, logarithmic, whisker
from terrainav.core.report.tables import NOTHING, TextTable, number_text, seconds_text
from terrainav.core.timing import QUICK, Effort, Seconds, timed

Floats = NDArray[np.float64]

EXACT, EULER_MARUYAMA, IMPLICIT_EULER, TRAPEZOID = "exact", "Euler-Maruyama", "implicit Euler", "trapezoid"
METHODS = (EXACT, EULER_MARUYAMA, IMPLICIT_EULER, TRAPEZOID)
#: Part of a step by which a horizon may pass a whole number of steps and still be that many: rounding of a quotient.
_WHOLE_STEPS = 1e-9
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
#: Interval where a plan has none of its own, s.
_INTERVAL_S = 10.0
#: Halvings of the step over which the order is measured.
_HALVINGS = 3
#: Error that the table asks for.
_PER_CENT = 0.01
_GREY = "#777777"
_METHODS = dict(
    zip(
        METHODS,
        (
            Look(BLUE, "*", "exact (used)"),
            Look(VERMILION, "o", "Euler–Maruyama"),
            Look(ORANGE, "s", "implicit Euler"),
            Look(GREEN, "^", "trapezoid"),
        ),
    )
)


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


def one_step(method: str, system: LinearSystem, step_s: float) -> tuple[Floats, Floats]:
    """Return M (d, d), by which a step takes the mean on, and Q (d, d), the covariance that it adds.

    Parameters
    ----------
    method : str
        One of `METHODS`.
    system : LinearSystem
    step_s : float
        Above 0.

    Raises
    ------
    InvalidInput
        On an unknown method, or a step that is not above 0.
    """
    _check(method, step_s)
    drift, noise = system.drift_per_s * step_s, system.noise_per_s * step_s
    unit = np.eye(len(drift))
    if method == EXACT:
        change, covariance = system.discretise(np.array([step_s]))
        return unit + change[0], covariance[0]
    if method == EULER_MARUYAMA:
        return unit + drift, noise
    share = 1.0 if method == IMPLICIT_EULER else 0.5
    inverse = np.linalg.inv(unit - share * drift)
    return inverse @ (unit + (1.0 - share) * drift), inverse @ noise @ inverse.T


def moments(method: str, system: LinearSystem, horizon_s: float, step_s: float, start: Floats | None = None) -> Floats:
    """Covariance of the state after a time, stepped there as a simulation would be.

    Parameters
    ----------
    method : str
        One of `METHODS`.
    system : LinearSystem
    horizon_s : float
        0 or more.
    step_s : float
        Above 0; taken a little shorter where a whole number of them does not fill the horizon.
    start : array (d, d), optional
        Covariance at the beginning; all at rest without it.

    Returns
    -------
    array (d, d)
        All infinite once the recursion has left the range of float64, as it does beyond `stability_limit_s`.

    Raises
    ------
    InvalidInput
        On an unknown method, a step that is not above 0 or a horizon that is not 0 or more.
    """
    _check(method, step_s)
    if not (math.isfinite(horizon_s) and horizon_s >= 0.0):
        raise InvalidInput(f"horizon {horizon_s} s: must be 0 or more")
    covariance = np.zeros_like(system.noise_per_s) if start is None else np.array(start, np.float64)
    if horizon_s == 0.0:
        return covariance
    count = max(1, math.ceil(horizon_s / step_s * (1.0 - _WHOLE_STEPS)))
    mean, added = one_step(method, system, horizon_s / count)
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(count):
            covariance = mean @ covariance @ mean.T + added
            # One entry that is not finite spreads to all in a few steps; a NaN must not be what is returned.
            if not math.isfinite(float(covariance.sum())):
                return np.full_like(covariance, np.inf)
    return covariance


def stability_limit_s(method: str, system: LinearSystem) -> float:
    """Longest step at which the method's recursion does not grow, in seconds; infinite where every step is stable.

    Euler-Maruyama multiplies each mode by 1 + λ dt, which stays within the unit circle up to dt = -2 Re λ / |λ|². The
    others are A-stable.
    """
    _check(method, 1.0)
    if method != EULER_MARUYAMA:
        return math.inf
    modes = np.linalg.eigvals(system.drift_per_s)
    return float(np.min(-2.0 * modes.real / np.abs(modes) ** 2))


def _check(method: str, step_s: float) -> None:
    if method not in METHODS:
        raise InvalidInput(f"method {method!r}: must be one of {', '.join(METHODS)}")
    if not (math.isfinite(step_s) and step_s > 0.0):
        raise InvalidInput(f"step {step_s} s: must be above 0")


def time_constants_s(system: LinearSystem) -> Floats:
    """One over the magnitude of each eigenvalue of the drift, fastest first (d,)."""
    return np.sort(1.0 / np.abs(np.linalg.eigvals(system.drift_per_s)))


def flight_of(plan: Plan, effort: Effort) -> Flight:
    """Compare the methods on the flight of a plan in gusts."""
    wind = plan.mission.wind
    if wind is None:
        raise InvalidInput("flight in still air: there is nothing to integrate")
    agl_m = float(np.median(plan.agl_m))
    return measure_flight(wind, plan.mission.flight.airspeed_m_per_s, _interval_s(plan), agl_m, effort)


def measure_flight(wind: Wind, airspeed_m_per_s: float, interval_s: float, agl_m: float, effort: Effort) -> Flight:
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
    constants = time_constants_s(system)
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


def _interval_s(plan: Plan) -> float:
    """Median time between exposures of a plan, s."""
    interval_s = np.diff(plan.times_s)
    moving = interval_s[interval_s > 0.0]
    return float(np.median(moving)) if moving.size else _INTERVAL_S


def flight_table(flight: Flight) -> TextTable:
    """Integrators of flight in wind: what each needs for one per cent, and where it is stable."""
    rows = []
    for method, limit_s in flight.limits_s.items():
        own = [one for one in flight.integrated if one.method == method]
        fitting = [one for one in own if one.error is not None and one.error <= _PER_CENT]
        best = min(fitting, key=lambda one: one.count) if fitting else None
        rows.append(
            (
                method,
                "any step" if math.isinf(limit_s) else f"up to {seconds_text(limit_s)}",
                NOTHING if best is None else seconds_text(best.step_s),
                "not reached" if best is None else f"{best.count:,}",
                NOTHING if best is None else seconds_text(flight.step * best.count),
                NOTHING if best is None or best.error is None else number_text(best.error),
                _order_text(own),
            )
        )
    header = (
        "method",
        "stable for steps of",
        "longest step for 1 %",
        "steps an exposure",
        "time an exposure then",
        "relative error then",
        "order",
    )
    return TextTable(header, rows, frozenset({0}))


def _order_text(own: list[Integrated]) -> str:
    """Order of convergence: power of the step with which the error falls, in the finest halvings."""
    errors = [one.error for one in sorted(own, key=lambda one: one.step_s) if one.error]
    if len(errors) < _HALVINGS + 1:
        return "exact at any step"
    return f"{math.log2(errors[_HALVINGS] / errors[0]) / _HALVINGS:.2f}"


def integrators_text(flight: Flight) -> str:
    """Why flight in wind is discretised exactly."""
    return (
        "Gusts and the aircraft's position hold have time constants from "
        f"{flight.fastest_s * 1e3:.2g} ms to {flight.slowest_s:.3g} s, {flight.slowest_s / flight.fastest_s:,.0f} "
        "times as long: a stiff system. TerrAInav discretises it exactly, with one step from each exposure to the next "
        f"({flight.interval_s:.3g} s); the usual integrators are shown for comparison. A step takes the same time for "
        f"all, {seconds_text(flight.step)}."
    )


def flight_diagram(found: Flight) -> bytes:
    """Two diagrams of the integrators: error against run time, and error against the step with its stable limit."""
    figure = new_figure(12.5, 5.4)
    work, steps = figure.subplots(1, 2)
    dress(
        work,
        f"Flight in wind from one exposure to the next, {found.interval_s:.3g} s",
        "relative error of the covariance",
        "processor seconds an exposure",
    )
    dress(steps, "Covariance that each method settles at", "step, s", "relative error of the covariance")
    for axes in (work, steps):
        logarithmic(axes, "xy")
    for method, look in _METHODS.items():
        style = {"color": look.colour, "marker": look.marker, "linewidth": 1.6, "label": look.label}
        limit_s = found.limits_s[method]
        tried = [one for one in found.integrated if one.method == method and one.error and one.step_s <= limit_s]
        size = 15 if look.marker == "*" else 6
        times = [found.step * one.count for one in tried]
        work.plot([one.error for one in tried], [time.median for time in times], markersize=size, **style)
        for one, time in zip(tried, times):
            if one.error is not None:
                whisker(work, one.error, time, look.colour)
        settled = [one for one in found.settled if one.method == method and one.error]
        steps.plot(
            [one.step_s for one in settled],
            [one.error for one in settled],
            markersize=8 if look.marker == "*" else 5,
            **style,
        )
        if math.isfinite(limit_s):
            steps.axvline(limit_s, color=look.colour, linestyle=":", linewidth=1.4)
            steps.annotate(
                f"{look.label} is unstable\nbeyond {limit_s * 1e3:.2g} ms",
                (limit_s, 0.35),
                xycoords=("data", "axes fraction"),
                xytext=(6, 0),
                textcoords="offset points",
                fontsize=FONT["note"],
                color=look.colour,
            )
    steps.axvline(found.interval_s, color=_GREY, linestyle="--", linewidth=1.0)
    steps.annotate(
        "interval between\nexposures",
        (found.interval_s, 0.62),
        xycoords=("data", "axes fraction"),
        xytext=(-5, 0),
        textcoords="offset points",
        ha="right",
        fontsize=FONT["note"],
        color=_GREY,
    )
    work.legend(fontsize=FONT["note"], frameon=False)
    return png(figure)
