"""Gusts and the aircraft that holds its place and attitude in them, as one linear stochastic system.

Gusts are Dryden's, with the spectra and the scale lengths of MIL-F-8785C (1980); MIL-HDBK-1797 writes the same spectra
with scale lengths of half the size across and upwards. Gust rotation rates are left out: a small aircraft is much
shorter than any of the scale lengths.

The aircraft is a small multirotor, linear about its steady flight: air drags it along, it leans to hold its place,
and its rotors turn it to the lean that is asked for. Place is held with an integral term, so that no steady wind
leaves an offset, and the steady lean and crab are trimmed out by the camera's mount: every error has mean zero.

A linear system, dx = A x dt + dw with ``w`` a Wiener process of covariance rate N, is discretised exactly for any
step: over one x(t + dt) = (I + E) x(t) + v, where E = exp(A dt) - I and v is normal with covariance
Q = ∫ exp(A s) N exp(A s)ᵀ ds from 0 to dt (Van Loan 1978, "Computing integrals involving the matrix exponential", IEEE
Trans. Automatic Control 23(3)). Van Loan's block exponential taken in one go fails where dt is long beside the fastest
time constant, and taking Q from the stationary P, as P - exp(A dt) P exp(A dt)ᵀ, cancels where it is short. Here the
series of both are summed at dt / 2^k, where they converge at once, and doubled k times.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...arrays import Floats
from ...errors import InvalidInput
from ...units import M_PER_FT

GRAVITY_M_PER_S2 = 9.80665
#: Heights in feet between which the low-altitude model holds, and from which the scale is the same at every height.
LOW_FT = 10.0
MIDDLE_FT = 1000.0
HIGH_FT = 2000.0
HIGH_SCALE_FT = 1750.0
#: Drag takes a multirotor at some 15 m/s to the speed of the air in about this long, along and across; its rotors
#: resist the vertical more.
DRAG_S = 4.0
HEAVE_S = 1.5
#: Rate loop and its actuators: two equal lags of 5 ms.
RATE_LAG_S = 0.005
#: Attitude loop: lean follows what is asked for.
ATTITUDE_S = 0.16
#: Heading loop, and the lag of yaw, which only rotor drag turns.
HEADING_S = 0.5
YAW_LAG_S = 0.15
#: Thrust lag of the rotors.
THRUST_S = 0.05
#: Position hold: acceleration asked for a metre of error and for a metre a second, along and across, and upwards.
HOLD_PER_S2, HOLD_DAMPING_PER_S = 0.25, 0.75
HEIGHT_PER_S2, HEIGHT_DAMPING_PER_S = 1.0, 1.5
#: Integral term of the position hold.
INTEGRAL_S = 20.0
#: Rates at which a gust of 1 m/s turns the aircraft: the lean it is blown into, and the nose into the wind.
LEAN_RAD_PER_M = 0.03
WEATHERCOCK_RAD_PER_M = 0.05
STATES = tuple(
    "along_gust along_speed along_lean along_m along_rate along_rate_slope along_integral "
    "across_gust across_gust_lagged across_speed across_lean yaw yaw_rate across_m across_rate across_rate_slope "
    "across_integral up_gust up_gust_lagged up_speed thrust up_m up_integral".split()
)
#: What `outputs` picks: metres along the flight through the air, to its right and up; radians of nose up, right side
#: down and nose to the right.
OUTPUTS = ("along_m", "across_m", "up_m", "pitch", "roll", "yaw")
#: Largest ‖A‖ dt that the series are summed at: every term is then at most half the one before it.
SERIES_NORM = 0.5
#: Terms of the series. The variance of a state that noise reaches through m integrations starts only at term 2m + 1
#: (m is 4 for the integral of a position), and 16 more bring it to rounding; that leaves room for m = 5.
SERIES_TERMS = 28
#: 2^64 steps of the series outlast the slowest time constant of any system that float64 can hold beside its fastest.
MOST_DOUBLINGS = 64
#: Largest entry of exp(A dt) from which on doubling no longer changes the covariance: it enters squared, and leaves
#: room for states whose sigmas are up to 1e6 apart.
FORGOTTEN = 1e-14
#: Largest entry of exp(A dt) that no stable system reaches on its way to rest.
RUNAWAY = 1e12
#: Rounding of a pivot of a correlation matrix, in units of the matrix's size: what lies below is noise of the
#: arithmetic, not noise of the process.
PIVOT_ROUNDING = 4.0 * float(np.finfo(np.float64).eps)
#: Share of the largest pivot that one must have to be taken. Gusts have pivots of exactly a half of it, which rounding
#: would take on one processor and leave on another: none is that near to a little more.
PIVOT_SHARE = 0.5001


def scale_lengths_m(agl_m: float) -> tuple[float, float]:
    """Horizontal (along, across) and vertical scale lengths of turbulence, in metres.

    MIL-F-8785C: h / (0.177 + 0.000823 h)^1.2 and h up to h = 1000 ft, both 1750 ft from 2000 ft on, and between them
    the line that joins the two. Below 10 ft as at 10 ft.
    """
    height_ft = max(agl_m / M_PER_FT, LOW_FT)
    if height_ft <= MIDDLE_FT:
        return height_ft / (0.177 + 0.000823 * height_ft) ** 1.2 * M_PER_FT, height_ft * M_PER_FT
    share = min((height_ft - MIDDLE_FT) / (HIGH_FT - MIDDLE_FT), 1.0)
    scale_m = (MIDDLE_FT + share * (HIGH_SCALE_FT - MIDDLE_FT)) * M_PER_FT
    return scale_m, scale_m


def vertical_share(agl_m: float) -> float:
    """Sigma of the vertical gusts over that of the horizontal ones: (0.177 + 0.000823 h)^0.4, h in 10..1000 ft."""
    height_ft = min(max(agl_m / M_PER_FT, LOW_FT), MIDDLE_FT)
    return float((0.177 + 0.000823 * height_ft) ** 0.4)


class _Equations:
    """Rows of A and N, addressed by the names of the states."""

    def __init__(self) -> None:
        self.drift = np.zeros((len(STATES), len(STATES)))
        self.noise = np.zeros((len(STATES), len(STATES)))

    def rate(self, state: str, **coefficients: float) -> None:
        """State's rate of change as a sum of other states times coefficients."""
        for other, coefficient in coefficients.items():
            self.drift[STATES.index(state), STATES.index(other)] += coefficient

    def first_order_gust(self, state: str, sigma_m_per_s: float, scale_s: float) -> None:
        """Dryden's longitudinal spectrum."""
        row = STATES.index(state)
        self.drift[row, row] = -1.0 / scale_s
        self.noise[row, row] = 2.0 * sigma_m_per_s**2 / scale_s

    def second_order_gust(self, state: str, sigma_m_per_s: float, scale_s: float) -> dict[str, float]:
        """Dryden's transverse spectrum; returns the gust as a sum of states."""
        row = STATES.index(state)
        self.drift[row, row] = -1.0 / scale_s
        self.noise[row, row] = sigma_m_per_s**2 / scale_s
        self.rate(f"{state}_lagged", **{state: 1.0 / scale_s, f"{state}_lagged": -1.0 / scale_s})
        return {state: math.sqrt(3.0), f"{state}_lagged": 1.0 - math.sqrt(3.0)}

    def horizontal_hold(self, axis: str, gust: dict[str, float]) -> None:
        """Drag, lean and position hold along or across."""
        speed, lean, place = f"{axis}_speed", f"{axis}_lean", f"{axis}_m"
        rate, slope, integral = f"{axis}_rate", f"{axis}_rate_slope", f"{axis}_integral"
        self.rate(speed, **{speed: -1.0 / DRAG_S, lean: GRAVITY_M_PER_S2})
        self.rate(speed, **{name: share / DRAG_S for name, share in gust.items()})
        self.rate(place, **{speed: 1.0})
        self.rate(integral, **{place: 1.0 / INTEGRAL_S})
        # The rate of lean is counted in units of the attitude loop's: the norm of A stays that of its fastest lag.
        self.rate(lean, **{rate: 1.0 / ATTITUDE_S})
        self.rate(lean, **{name: share * LEAN_RAD_PER_M for name, share in gust.items()})
        self.rate(rate, **{slope: 1.0 / RATE_LAG_S})
        hold = HOLD_PER_S2 / GRAVITY_M_PER_S2
        wanted = {place: -hold, integral: -hold, speed: -HOLD_DAMPING_PER_S / GRAVITY_M_PER_S2}
        self.rate(slope, **{name: share / RATE_LAG_S for name, share in wanted.items()})
        self.rate(slope, **{lean: -1.0 / RATE_LAG_S, rate: -1.0 / RATE_LAG_S, slope: -2.0 / RATE_LAG_S})

    def heading_hold(self, gust: dict[str, float]) -> None:
        """The nose, which gusts from the side turn into the wind."""
        self.rate("yaw", yaw_rate=1.0 / HEADING_S)
        self.rate("yaw", **{name: -share * WEATHERCOCK_RAD_PER_M for name, share in gust.items()})
        self.rate("yaw_rate", yaw=-1.0 / YAW_LAG_S, yaw_rate=-1.0 / YAW_LAG_S)

    def height_hold(self, gust: dict[str, float]) -> None:
        """Heave, thrust and the hold of height."""
        self.rate("up_speed", up_speed=-1.0 / HEAVE_S, thrust=1.0)
        self.rate("up_speed", **{name: share / HEAVE_S for name, share in gust.items()})
        self.rate("up_m", up_speed=1.0)
        self.rate("up_integral", up_m=1.0 / INTEGRAL_S)
        wanted = {"up_m": -HEIGHT_PER_S2, "up_integral": -HEIGHT_PER_S2, "up_speed": -HEIGHT_DAMPING_PER_S}
        self.rate("thrust", thrust=-1.0 / THRUST_S)
        self.rate("thrust", **{name: share / THRUST_S for name, share in wanted.items()})


def flight_system(sigma_m_per_s: float, airspeed_m_per_s: float, agl_m: float) -> LinearSystem:
    """Return the system of gusts and aircraft at one height.

    Parameters
    ----------
    sigma_m_per_s : float
        Of the horizontal gusts; the vertical ones are `vertical_share` of it.
    airspeed_m_per_s : float
        Speed through the (frozen) turbulence, > 0.
    agl_m : float
        Height above ground, > 0.

    Returns
    -------
    LinearSystem
        Of the states `STATES`: metres, metres a second and radians.
    """
    horizontal_m, vertical_m = scale_lengths_m(agl_m)
    equations = _Equations()
    equations.first_order_gust("along_gust", sigma_m_per_s, horizontal_m / airspeed_m_per_s)
    equations.horizontal_hold("along", {"along_gust": 1.0})
    across = equations.second_order_gust("across_gust", sigma_m_per_s, horizontal_m / airspeed_m_per_s)
    equations.horizontal_hold("across", across)
    equations.heading_hold(across)
    sigma_up = sigma_m_per_s * vertical_share(agl_m)
    equations.height_hold(equations.second_order_gust("up_gust", sigma_up, vertical_m / airspeed_m_per_s))
    return LinearSystem(equations.drift, equations.noise)


def outputs() -> Floats:
    """Return the matrix (6, d) from the states to `OUTPUTS`; leaning forwards is pitching down."""
    picked = np.zeros((len(OUTPUTS), len(STATES)))
    for row, (state, sign) in enumerate(
        (("along_m", 1), ("across_m", 1), ("up_m", 1), ("along_lean", -1), ("across_lean", 1), ("yaw", 1))
    ):
        picked[row, STATES.index(state)] = sign
    return picked


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """dx = A x dt + dw, stable (every eigenvalue of A left of the imaginary axis).

    Parameters
    ----------
    drift_per_s : array (d, d)
        A.
    noise_per_s : array (d, d)
        Covariance rate N of the driving Wiener process, in squared units of the states a second.
    """

    drift_per_s: Floats
    noise_per_s: Floats

    def discretise(self, step_s: Floats) -> tuple[Floats, Floats]:
        """Exact discretisation for each of many steps.

        Parameters
        ----------
        step_s : array (k,)
            0 or more.

        Returns
        -------
        tuple of array (k, d, d)
            E = exp(A dt) - I, whose small entries keep their digits where dt is short, and Q, symmetric.
        """
        step_s = np.asarray(step_s, np.float64)
        if not bool(np.all(np.isfinite(step_s) & (step_s >= 0.0))):
            raise InvalidInput(
                "steps of {0} to {1} s: must be 0 or more, and finite", step_s.min(), step_s.max()
            )
        doublings = np.array([self._doublings(step) for step in step_s.tolist()], np.int64)
        change, covariance = self._series(np.ldexp(step_s, -doublings))
        for done in range(int(doublings.max(initial=0))):
            due = np.flatnonzero(doublings > done)
            change[due], covariance[due] = _doubled(change[due], covariance[due])
        return change, covariance

    def stationary_covariance(self) -> Floats:
        """Covariance (d, d) that the system tends to from anywhere: the solution of A P + P Aᵀ + N = 0.

        Raises
        ------
        InvalidInput
            When A is not stable, so that there is none.
        """
        fastest = float(np.abs(self.drift_per_s).sum(axis=1).max())
        change, covariance = self._series(np.array([SERIES_NORM / fastest]))
        unit = np.eye(len(self.drift_per_s))
        for _ in range(MOST_DOUBLINGS):
            remembered = float(np.abs(change + unit).max())
            if remembered < FORGOTTEN:
                settled: Floats = covariance[0]
                return settled
            if remembered > RUNAWAY:
                break
            change, covariance = _doubled(change, covariance)
        raise InvalidInput("system without a stationary covariance: it must be stable")

    def _doublings(self, step_s: float) -> int:
        norm_per_s = float(np.abs(self.drift_per_s).sum(axis=1).max())
        if step_s == 0.0 or norm_per_s == 0.0:
            return 0
        # Logarithms are added because the product may overflow.
        return max(0, math.ceil(math.log2(norm_per_s) + math.log2(step_s) - math.log2(SERIES_NORM)))

    def _series(self, step_s: Floats) -> tuple[Floats, Floats]:
        """E and Q of short steps from their Taylor series: dQ/dt = A Q + Q Aᵀ + N, term by term."""
        drift = self.drift_per_s * step_s[:, np.newaxis, np.newaxis]
        term_of_change = drift
        term_of_covariance = self.noise_per_s * step_s[:, np.newaxis, np.newaxis]
        change, covariance = term_of_change.copy(), term_of_covariance.copy()
        for order in range(2, SERIES_TERMS + 1):
            term_of_change = drift @ term_of_change / order
            half = drift @ term_of_covariance / order
            term_of_covariance = half + half.swapaxes(-1, -2)
            change += term_of_change
            covariance += term_of_covariance
        return change, covariance


def _doubled(change: Floats, covariance: Floats) -> tuple[Floats, Floats]:
    """E and Q of twice the step, without ever adding I to E: slow states would lose digits at every squaring."""
    carried = change @ covariance
    later = carried @ change.swapaxes(-1, -2)
    # carried @ changeᵀ is symmetric but for rounding, which would grow with the doublings.
    added = carried + carried.swapaxes(-1, -2) + 0.5 * (later + later.swapaxes(-1, -2))
    return 2.0 * change + change @ change, 2.0 * covariance + added


def factor(covariance: Floats) -> Floats:
    """Matrices L with L Lᵀ = Q, for positive semidefinite Q of any scale and rank.

    Cholesky's method on the correlation matrix (states whose variances are many orders apart weigh the same), large
    pivots first, and pivots that are nothing but rounding taken as zero. It is written out rather than left to
    LAPACK because that gives up on a semidefinite matrix, and because eigenvectors, the usual way out, come with
    signs that change from one machine to the next. For the same reason the pivot is not the largest one but the
    first of more than half its size: every first pivot is 1, and rounding must not choose among equals.

    Parameters
    ----------
    covariance : array (k, d, d)

    Returns
    -------
    array (k, d, d)
        Columns in the order of the pivots, and zeros from the rank on.
    """
    count, size, _ = covariance.shape
    every = np.arange(count)
    sigma = np.sqrt(np.maximum(np.diagonal(covariance, axis1=1, axis2=2), 0.0))
    scale = np.where(sigma > 0.0, sigma, 1.0)
    left = covariance / scale[:, :, np.newaxis] / scale[:, np.newaxis, :]
    columns = np.zeros_like(left)
    for step in range(size):
        pivots = np.diagonal(left, axis1=1, axis2=2)
        largest = pivots.max(axis=1)
        chosen = np.argmax(pivots >= PIVOT_SHARE * largest[:, np.newaxis], axis=1)
        pivot = left[every, chosen, chosen]
        sound = pivot > size * PIVOT_ROUNDING
        if not bool(sound.any()):
            break
        root = np.sqrt(np.where(sound, pivot, 1.0))
        column = np.where(sound[:, np.newaxis], left[every, :, chosen] / root[:, np.newaxis], 0.0)
        columns[:, :, step] = column
        left = left - column[:, :, np.newaxis] * column[:, np.newaxis, :]
        # What is explained is exactly so: rounding must not bring it back as a pivot.
        left[every, chosen, :] = 0.0
        left[every, :, chosen] = 0.0
    factored: Floats = columns * scale[:, :, np.newaxis]
    return factored
