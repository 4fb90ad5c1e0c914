"""The usual integrators of flight in wind, by the covariances they give: no sampling noise hides their error.

Each is a linear recursion x ← M x + v with v of covariance Q, so that its covariance goes P ← M P Mᵀ + Q. Methods as in
Kloeden & Platen 1992, "Numerical Solution of Stochastic Differential Equations": Euler-Maruyama, and the implicit Euler
family with weight 1 (implicit Euler) and one half (the trapezoid).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput
from ..mission.sde import LinearSystem

Floats = NDArray[np.float64]

EXACT, EULER_MARUYAMA, IMPLICIT_EULER, TRAPEZOID = "exact", "Euler-Maruyama", "implicit Euler", "trapezoid"
METHODS = (EXACT, EULER_MARUYAMA, IMPLICIT_EULER, TRAPEZOID)
#: Part of a step by which a horizon may pass a whole number of steps and still be that many: rounding of a quotient.
WHOLE_STEPS = 1e-9


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


def moments(
    method: str, system: LinearSystem, horizon_s: float, step_s: float, start: Floats | None = None
) -> Floats:
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
    count = max(1, math.ceil(horizon_s / step_s * (1.0 - WHOLE_STEPS)))
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
