"""Gusts, and the aircraft that holds its position and attitude in them, as one linear stochastic system.

Gusts follow Dryden's model, with the spectra and scale lengths of MIL-F-8785C (1980); MIL-HDBK-1797 writes the same
spectra with scale lengths of half the size across and upwards. Gust rotation rates are neglected: a small aircraft is
much shorter than any of the scale lengths.

The aircraft is a small multirotor, linearised about its steady flight: air drags it along, it tilts to hold its
position, and its rotors turn it to the tilt demanded. The position hold has an integral term, so that steady wind
leaves no offset, and the camera's mount trims out the steady tilt and crab: every error has mean zero.

A linear system, dx = A x dt + dw with ``w`` a Wiener process of covariance rate N, is discretised exactly for any
step dt: x(t + dt) = (I + E) x(t) + v, where E = exp(A dt) - I and v is normal with covariance
Q = ∫ exp(A s) N exp(A s)ᵀ ds from 0 to dt (Van Loan 1978, "Computing integrals involving the matrix exponential", IEEE
Trans. Automatic Control 23(3)). Van Loan's block exponential in a single step fails where dt is long compared with the
fastest time constant, and Q from the stationary P, as P - exp(A dt) P exp(A dt)ᵀ, cancels where dt is short. Here the
series of E and Q are summed at dt / 2^k, where they converge quickly, and doubled k times.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...arrays import Floats
from ...errors import InvalidInput
from ...units import M_PER_FT

GRAVITY_M_PER_S2 = 9.80665
#: Least height of the model in feet; below, its values are the same.
LOW_FT = 10.0
#: Top of the low-altitude model in feet.
MIDDLE_FT = 1000.0
#: Height in feet from which the scale length is constant.
HIGH_FT = 2000.0
#: Names of the states of `flight_system`.
STATES = tuple(
    "along_gust along_speed along_lean along_m along_rate along_rate_slope along_integral "
    "across_gust across_gust_lagged across_speed across_lean yaw yaw_rate across_m across_rate across_rate_slope "
    "across_integral up_gust up_gust_lagged up_speed thrust up_m up_integral".split()
)
#: Rows of `output_matrix`: metres along the track through the air, to its right and up; radians of nose up, right side
#: down and nose to the right.
OUTPUTS = ("along_m", "across_m", "up_m", "pitch", "roll", "yaw")


@dataclass(frozen=True)
class Multirotor:
    """Time constants and gains of a small multirotor at some 15 m/s, and of the autopilot that holds its position.

    Parameters
    ----------
    drag_s, heave_s : float
        Time constants with which drag takes the aircraft to the speed of the air: horizontally, and vertically, where
        its rotors resist more.
    rate_lag_s : float
        Each of two equal lags of the rate loop and its actuators.
    attitude_s, heading_s : float
        Time constants of the attitude and the heading loop.
    yaw_lag_s, thrust_s : float
        Lags of yaw, which only rotor drag turns, and of thrust.
    hold_per_s2, hold_damping_per_s, height_per_s2, height_damping_per_s : float
        Acceleration demanded for each metre and each metre per second of error, horizontally and vertically.
    integral_s : float
        Time constant of the integral term of the position hold.
    lean_rad_per_m, weathercock_rad_per_m : float
        Rates at which a gust of 1 m/s tilts the aircraft, and turns its nose into the wind.
    """

    drag_s: float = 4.0
    heave_s: float = 1.5
    rate_lag_s: float = 0.005
    attitude_s: float = 0.16
    heading_s: float = 0.5
    yaw_lag_s: float = 0.15
    thrust_s: float = 0.05
    hold_per_s2: float = 0.25
    hold_damping_per_s: float = 0.75
    height_per_s2: float = 1.0
    height_damping_per_s: float = 1.5
    integral_s: float = 20.0
    lean_rad_per_m: float = 0.03
    weathercock_rad_per_m: float = 0.05


def scale_lengths_m(agl_m: float) -> tuple[float, float]:
    """Horizontal (along, across) and vertical scale lengths of turbulence, in metres.

    MIL-F-8785C: h / (0.177 + 0.000823 h)^1.2 and h from 10 ft to 1000 ft, both 1750 ft from 2000 ft on, linear between
    these, constant below 10 ft.
    """
    height_ft = max(agl_m / M_PER_FT, LOW_FT)
    if height_ft <= MIDDLE_FT:
        return height_ft / (0.177 + 0.000823 * height_ft) ** 1.2 * M_PER_FT, height_ft * M_PER_FT
    share = min((height_ft - MIDDLE_FT) / (HIGH_FT - MIDDLE_FT), 1.0)
    scale_m = (MIDDLE_FT + share * (1750.0 - MIDDLE_FT)) * M_PER_FT
    return scale_m, scale_m


def vertical_share(agl_m: float) -> float:
    """Sigma of the vertical gusts over sigma of the horizontal: (0.177 + 0.000823 h)^0.4, h in 10..1000 ft."""
    height_ft = min(max(agl_m / M_PER_FT, LOW_FT), MIDDLE_FT)
    return float((0.177 + 0.000823 * height_ft) ** 0.4)


class _Equations:
    """Rows of A and N, addressed by the names of the states."""

    def __init__(self, craft: Multirotor) -> None:
        self.craft = craft
        self.drift = np.zeros((len(STATES), len(STATES)))
        self.noise = np.zeros((len(STATES), len(STATES)))

    def rate(self, state: str, **coefficients: float) -> None:
        """Add other states times coefficients to the rate of change of a state."""
        for other, coefficient in coefficients.items():
            self.drift[STATES.index(state), STATES.index(other)] += coefficient

    def first_order_gust(self, state: str, sigma_m_per_s: float, scale_s: float) -> None:
        """Set a gust of Dryden's longitudinal spectrum."""
        row = STATES.index(state)
        self.drift[row, row] = -1.0 / scale_s
        self.noise[row, row] = 2.0 * sigma_m_per_s**2 / scale_s

    def second_order_gust(self, state: str, sigma_m_per_s: float, scale_s: float) -> dict[str, float]:
        """Set a gust of Dryden's transverse spectrum; returns it as coefficients of states."""
        row = STATES.index(state)
        self.drift[row, row] = -1.0 / scale_s
        self.noise[row, row] = sigma_m_per_s**2 / scale_s
        self.rate(f"{state}_lagged", **{state: 1.0 / scale_s, f"{state}_lagged": -1.0 / scale_s})
        return {state: math.sqrt(3.0), f"{state}_lagged": 1.0 - math.sqrt(3.0)}

    def horizontal_hold(self, axis: str, gust: dict[str, float]) -> None:
        """Set drag, tilt and position hold along or across the track."""
        speed, lean, place = f"{axis}_speed", f"{axis}_lean", f"{axis}_m"
        rate, slope, integral = f"{axis}_rate", f"{axis}_rate_slope", f"{axis}_integral"
        self.rate(speed, **{speed: -1.0 / self.craft.drag_s, lean: GRAVITY_M_PER_S2})
        self.rate(speed, **{name: share / self.craft.drag_s for name, share in gust.items()})
        self.rate(place, **{speed: 1.0})
        self.rate(integral, **{place: 1.0 / self.craft.integral_s})
        # Tilt rate in units of the attitude loop's time constant: the fastest lag still determines the norm of A.
        self.rate(lean, **{rate: 1.0 / self.craft.attitude_s})
        self.rate(lean, **{name: share * self.craft.lean_rad_per_m for name, share in gust.items()})
        self.rate(rate, **{slope: 1.0 / self.craft.rate_lag_s})
        hold = self.craft.hold_per_s2 / GRAVITY_M_PER_S2
        wanted = {place: -hold, integral: -hold, speed: -self.craft.hold_damping_per_s / GRAVITY_M_PER_S2}
        self.rate(slope, **{name: share / self.craft.rate_lag_s for name, share in wanted.items()})
        self.rate(
            slope,
            **{
                lean: -1.0 / self.craft.rate_lag_s,
                rate: -1.0 / self.craft.rate_lag_s,
                slope: -2.0 / self.craft.rate_lag_s,
            },
        )

    def heading_hold(self, gust: dict[str, float]) -> None:
        """Set the heading, which gusts from the side turn into the wind."""
        self.rate("yaw", yaw_rate=1.0 / self.craft.heading_s)
        self.rate("yaw", **{name: -share * self.craft.weathercock_rad_per_m for name, share in gust.items()})
        self.rate("yaw_rate", yaw=-1.0 / self.craft.yaw_lag_s, yaw_rate=-1.0 / self.craft.yaw_lag_s)

    def height_hold(self, gust: dict[str, float]) -> None:
        """Set heave, thrust and height hold."""
        self.rate("up_speed", up_speed=-1.0 / self.craft.heave_s, thrust=1.0)
        self.rate("up_speed", **{name: share / self.craft.heave_s for name, share in gust.items()})
        self.rate("up_m", up_speed=1.0)
        self.rate("up_integral", up_m=1.0 / self.craft.integral_s)
        wanted = {
            "up_m": -self.craft.height_per_s2,
            "up_integral": -self.craft.height_per_s2,
            "up_speed": -self.craft.height_damping_per_s,
        }
        self.rate("thrust", thrust=-1.0 / self.craft.thrust_s)
        self.rate("thrust", **{name: share / self.craft.thrust_s for name, share in wanted.items()})


def flight_system(sigma_m_per_s: float, airspeed_m_per_s: float, agl_m: float) -> LinearSystem:
    """System of gusts and aircraft at one height.

    Parameters
    ----------
    sigma_m_per_s : float
        Standard deviation of the horizontal gusts; the vertical gusts have `vertical_share` of it.
    airspeed_m_per_s : float
        Speed through the (frozen) turbulence, > 0.
    agl_m : float
        Height above ground, > 0.

    Returns
    -------
    LinearSystem
        Its states are `STATES`, in metres, metres per second and radians.
    """
    horizontal_m, vertical_m = scale_lengths_m(agl_m)
    equations = _Equations(Multirotor())
    equations.first_order_gust("along_gust", sigma_m_per_s, horizontal_m / airspeed_m_per_s)
    equations.horizontal_hold("along", {"along_gust": 1.0})
    across = equations.second_order_gust("across_gust", sigma_m_per_s, horizontal_m / airspeed_m_per_s)
    equations.horizontal_hold("across", across)
    equations.heading_hold(across)
    sigma_up = sigma_m_per_s * vertical_share(agl_m)
    equations.height_hold(equations.second_order_gust("up_gust", sigma_up, vertical_m / airspeed_m_per_s))
    return LinearSystem(equations.drift, equations.noise)


def output_matrix() -> Floats:
    """Matrix (6, d) from the states to `OUTPUTS`; tilting forwards is pitching down."""
    picked = np.zeros((len(OUTPUTS), len(STATES)))
    for row, (state, sign) in enumerate(
        (("along_m", 1), ("across_m", 1), ("up_m", 1), ("along_lean", -1), ("across_lean", 1), ("yaw", 1))
    ):
        picked[row, STATES.index(state)] = sign
    return picked


#: Largest ‖A‖ dt at which series are summed: every term is at most half the previous term.
_SERIES_NORM = 0.5


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """dx = A x dt + dw, stable (every eigenvalue of A left of the imaginary axis).

    Parameters
    ----------
    drift_per_s : array (d, d)
        A.
    noise_per_s : array (d, d)
        Covariance rate N of the driving Wiener process, in squared units of the states per second.
    """

    drift_per_s: Floats
    noise_per_s: Floats

    def discretise(self, step_s: Floats) -> tuple[Floats, Floats]:
        """Discretise exactly, for each of many steps.

        Parameters
        ----------
        step_s : array (k,)
            0 or more.

        Returns
        -------
        tuple of array (k, d, d)
            E = exp(A dt) - I, whose small entries keep their digits where dt is short; and Q, symmetric.
        """
        step_s = np.asarray(step_s, np.float64)
        if not bool(np.all(np.isfinite(step_s) & (step_s >= 0.0))):
            raise InvalidInput("steps of {0} to {1} s: must be 0 or more, and finite", step_s.min(), step_s.max())
        doublings = np.array([self._doublings(step) for step in step_s.tolist()], np.int64)
        change, covariance = self._series(np.ldexp(step_s, -doublings))
        for done in range(int(doublings.max(initial=0))):
            due = np.flatnonzero(doublings > done)
            change[due], covariance[due] = _doubled(change[due], covariance[due])
        return change, covariance

    def stationary_covariance(self) -> Floats:
        """Stationary covariance (d, d): the solution of A P + P Aᵀ + N = 0.

        Raises
        ------
        InvalidInput
            A is not stable.
        """
        fastest = float(np.abs(self.drift_per_s).sum(axis=1).max())
        change, covariance = self._series(np.array([_SERIES_NORM / fastest]))
        unit = np.eye(len(self.drift_per_s))
        # 64 doublings outlast the slowest time constant that float64 can hold beside the fastest.
        for _ in range(64):
            transition = float(np.abs(change + unit).max())
            # The transition enters the covariance squared; sigmas of states may still differ by a factor of 1e6.
            if transition < 1e-14:
                settled: Floats = covariance[0]
                return settled
            # No stable system reaches this on its way to rest.
            if transition > 1e12:
                break
            change, covariance = _doubled(change, covariance)
        raise InvalidInput("system without a stationary covariance: it must be stable")

    def _doublings(self, step_s: float) -> int:
        """Number of halvings that bring the norm of a step to `_SERIES_NORM` or below."""
        norm_per_s = float(np.abs(self.drift_per_s).sum(axis=1).max())
        if step_s == 0.0 or norm_per_s == 0.0:
            return 0
        # Logarithms are added because the product may overflow.
        return max(0, math.ceil(math.log2(norm_per_s) + math.log2(step_s) - math.log2(_SERIES_NORM)))

    def _series(self, step_s: Floats) -> tuple[Floats, Floats]:
        """E and Q of short steps from their Taylor series, dQ/dt = A Q + Q Aᵀ + N, term by term.

        The variance of a state that noise reaches through m integrations begins at term 2m + 1 (m is 4 for the integral
        of a position), and 16 more terms bring it to rounding; 28 terms leave room for m = 5.
        """
        drift = self.drift_per_s * step_s[:, np.newaxis, np.newaxis]
        term_of_change = drift
        term_of_covariance = self.noise_per_s * step_s[:, np.newaxis, np.newaxis]
        change, covariance = term_of_change.copy(), term_of_covariance.copy()
        for order in range(2, 29):
            term_of_change = drift @ term_of_change / order
            half = drift @ term_of_covariance / order
            term_of_covariance = half + half.swapaxes(-1, -2)
            change += term_of_change
            covariance += term_of_covariance
        return change, covariance


def _doubled(change: Floats, covariance: Floats) -> tuple[Floats, Floats]:
    """E and Q of twice the step. I is never added to E, as slow states would lose digits at every squaring."""
    carried = change @ covariance
    later = carried @ change.swapaxes(-1, -2)
    # carried @ changeᵀ is symmetric but for rounding, which would grow with the doublings.
    added = carried + carried.swapaxes(-1, -2) + 0.5 * (later + later.swapaxes(-1, -2))
    return 2.0 * change + change @ change, 2.0 * covariance + added


def factor(covariance: Floats) -> Floats:
    """Factor positive semidefinite Q of any scale and rank into L Lᵀ.

    Cholesky's method with pivoting on the correlation matrix, so that states whose variances are many orders apart
    weigh the same; pivots within rounding are taken as zero. LAPACK's Cholesky rejects semidefinite matrices, and the
    signs of eigenvectors, the usual alternative, differ between machines. So that machines agree, the pivot is not the
    largest candidate but the first of more than half the largest: at first all candidates are 1, and rounding must not
    choose among equals. Gusts have pivots of exactly a half, so the limit is a little more.

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
    rounding = 4.0 * size * float(np.finfo(np.float64).eps)
    sigma = np.sqrt(np.maximum(np.diagonal(covariance, axis1=1, axis2=2), 0.0))
    scale = np.where(sigma > 0.0, sigma, 1.0)
    residual = covariance / scale[:, :, np.newaxis] / scale[:, np.newaxis, :]
    columns = np.zeros_like(residual)
    for step in range(size):
        pivots = np.diagonal(residual, axis1=1, axis2=2)
        largest = pivots.max(axis=1)
        chosen = np.argmax(pivots >= 0.5001 * largest[:, np.newaxis], axis=1)
        pivot = residual[every, chosen, chosen]
        is_positive = pivot > rounding
        if not bool(is_positive.any()):
            break
        root = np.sqrt(np.where(is_positive, pivot, 1.0))
        column = np.where(is_positive[:, np.newaxis], residual[every, :, chosen] / root[:, np.newaxis], 0.0)
        columns[:, :, step] = column
        residual = residual - column[:, :, np.newaxis] * column[:, np.newaxis, :]
        # An explained state has no variance left: rounding must not bring it back as a pivot.
        residual[every, chosen, :] = 0.0
        residual[every, :, chosen] = 0.0
    factored: Floats = columns * scale[:, :, np.newaxis]
    return factored
