"""Pose errors that gusts cause at each exposure of a flight."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import Floats, NDArray
from ...errors import InvalidInput
from ...units import M_PER_FT
from .deviates import normal
from .gusts import HIGH_FT, LOW_FT, STATES, factor, flight_system, output_matrix
from .wind import Wind

Ints = NDArray[np.intp]
#: Greatest number of discretisations for one flight; each takes 8 KB and half a millisecond.
MOST_STEPS = 2048
#: Relative resolutions of intervals and heights, and the number of different pairs after which the next
#: resolution applies. The first is coarser than the differences along parallels; few pairs are left for the last.
RESOLUTIONS = ((1e-6, 480), (4e-3, 800), (0.016, 200), (0.064, 200), (0.256, 100), (1.0, MOST_STEPS))
#: Exposures sampled at a time: 1.5 MB of states and noise, which stay in the processor's cache.
CHUNK = 4096


@dataclass(frozen=True, eq=False)
class Disturbance:
    """Difference of the real pose from the nominal one at each exposure.

    Parameters
    ----------
    east_m, north_m, up_m : array (n,)
        Offset of the camera, in metres.
    yaw_deg, tilt_deg, roll_deg : array (n,)
        Angles to add to the nominal ones, in degrees.
    """

    east_m: Floats
    north_m: Floats
    up_m: Floats
    yaw_deg: Floats
    tilt_deg: Floats
    roll_deg: Floats


def fly(
    wind: Wind,
    airspeed_m_per_s: float,
    interval_s: Floats,
    heading_deg: Floats,
    agl_m: Floats,
    yaw_deg: Floats | float = 0.0,
) -> Disturbance:
    """Pose errors of a flight: one sample path of the stationary process, exact at every exposure.

    The process is `gusts.flight_system`. Its axes follow the direction of flight through the air, also through turns:
    an error ahead of the aircraft stays ahead. Between two exposures, the height of the second holds. Steady wind
    turns the axes by the crab angle and has no other effect: the position hold removes a steady offset, and the
    camera's mount a steady tilt and crab. The aircraft's remaining pitch and roll become the camera's tilt and roll
    through the angle from the top of the image to the direction of flight, to first order, for a camera that looks
    down; for an oblique camera, pitch and roll are taken as errors of the mount's angles.

    Parameters
    ----------
    airspeed_m_per_s : float
        Flight speed through the air.
    interval_s : array (n - 1,)
        Time from each exposure to the next, >= 0.
    heading_deg : array (n,)
        Track over ground at each exposure, clockwise from north.
    agl_m : array (n,)
        Height above ground, > 0.
    yaw_deg : array (n,) or float
        Nominal direction of the top of the image, clockwise from north.

    Returns
    -------
    Disturbance
        Equal on every platform and with every numpy to a millionth of sigma: so far do nearly singular covariances
        amplify the rounding of processors. Flights that share their first exposures have equal errors there.

    Raises
    ------
    InvalidInput
        Shapes do not match, values lie outside the domain, or `Wind.checked` raises it.
    """
    return _flown(output_matrix(), wind, airspeed_m_per_s, interval_s, heading_deg, agl_m, yaw_deg)


def fly_rates(
    wind: Wind,
    airspeed_m_per_s: float,
    interval_s: Floats,
    heading_deg: Floats,
    agl_m: Floats,
    yaw_deg: Floats | float = 0.0,
) -> Disturbance:
    """Rates per second, at each exposure, of the pose errors that `fly` returns for the same arguments.

    No noise drives positions and angles directly, so they have rates at every time, which follow from the states. The
    rates do not depend on the height.
    """
    drift_per_s = flight_system(wind.sigma_m_per_s, airspeed_m_per_s, HIGH_FT * M_PER_FT).drift_per_s
    return _flown(output_matrix() @ drift_per_s, wind, airspeed_m_per_s, interval_s, heading_deg, agl_m, yaw_deg)


def _flown(
    picked: Floats,
    wind: Wind,
    airspeed_m_per_s: float,
    interval_s: Floats,
    heading_deg: Floats,
    agl_m: Floats,
    yaw_deg: Floats | float,
) -> Disturbance:
    """What a matrix (6, d) picks from the states, in the axes of poses; the other arguments are those of `fly`."""
    wind.checked(airspeed_m_per_s)
    heading_deg, agl_m = np.asarray(heading_deg, np.float64), np.asarray(agl_m, np.float64)
    interval_s, yaw_deg = np.asarray(interval_s, np.float64), np.asarray(yaw_deg, np.float64)
    _check(interval_s, heading_deg, agl_m, yaw_deg)
    if wind.sigma_m_per_s == 0.0 or heading_deg.size == 0:
        return Disturbance(*np.zeros((6, heading_deg.size)))
    along, across, up, pitch, roll, yaw = _sampled(picked, wind, airspeed_m_per_s, interval_s, agl_m)
    air_deg = heading_deg + wind.crab_deg(heading_deg, airspeed_m_per_s)
    sine, cosine = np.sin(np.radians(air_deg)), np.cos(np.radians(air_deg))
    turn = np.radians(air_deg - yaw_deg)
    return Disturbance(
        east_m=along * sine + across * cosine,
        north_m=along * cosine - across * sine,
        up_m=up,
        yaw_deg=np.degrees(yaw),
        tilt_deg=np.degrees(pitch * np.cos(turn) + roll * np.sin(turn)),
        roll_deg=np.degrees(roll * np.cos(turn) - pitch * np.sin(turn)),
    )


def _check(interval_s: Floats, heading_deg: Floats, agl_m: Floats, yaw_deg: Floats) -> None:
    count = heading_deg.size
    for name, values, wanted in (
        ("headings", heading_deg, (count,)),
        ("heights", agl_m, (count,)),
        ("intervals", interval_s, (max(count - 1, 0),)),
    ):
        if values.shape != wanted:
            raise InvalidInput("{0} of shape {1}: must be {2} for {3} exposures", name, values.shape, wanted, count)
    if yaw_deg.shape not in ((), (count,)):
        raise InvalidInput("yaws of shape {0}: must be one, or one for each of {1} exposures", yaw_deg.shape, count)
    for name, values, right, rule in (
        ("interval", interval_s, interval_s >= 0.0, "s: must be 0 or more"),
        ("heading", heading_deg, np.isfinite(heading_deg), "deg: must be a number"),
        ("height above ground", agl_m, agl_m > 0.0, "m: must be above 0"),
        ("yaw", yaw_deg, np.isfinite(yaw_deg), "deg: must be a number"),
    ):
        wrong = values[~(right & np.isfinite(values))]
        if wrong.size:
            raise InvalidInput("{0} {1} {2}", name, wrong.flat[0], rule)


def _sampled(picked: Floats, wind: Wind, airspeed_m_per_s: float, interval_s: Floats, agl_m: Floats) -> Floats:
    """Sample what a matrix (6, d) picks from the states, `gusts.OUTPUTS` or their rates, at each exposure, (6, n).

    Each exposure is the product of one matrix with the previous state followed by fresh normal deviates.
    """
    steps, which = _steps(wind.sigma_m_per_s, airspeed_m_per_s, interval_s, agl_m)
    size = len(STATES)
    bits = np.random.PCG64(np.random.SeedSequence(int(wind.seed)))
    sampled = np.empty((len(picked), which.size))
    states = np.zeros((min(CHUNK, which.size) + 1, 2 * size))
    for start in range(0, which.size, CHUNK):
        count = min(CHUNK, which.size - start)
        states[:count, size:] = normal(bits, count, size)
        products = [steps[step] for step in which[start : start + count].tolist()]
        for product, before, after in zip(products, states[:count], states[1 : count + 1, :size]):
            product.dot(before, after)
        sampled[:, start : start + count] = picked @ states[1 : count + 1, :size].T
        states[0, :size] = states[count, :size]
    return sampled


def _steps(sigma_m_per_s: float, airspeed_m_per_s: float, interval_s: Floats, agl_m: Floats) -> tuple[Floats, Ints]:
    """Matrices (m, d, 2 d) that step the state, one for each kind of step, and the kind of each exposure (n,).

    The first matrix starts the flight: it ignores the state and draws from the stationary distribution. Rounding
    intervals and heights, where there are too many, leaves the distribution at each exposure exact; only the
    correlation between neighbours follows the rounded interval.
    """
    heights_m = np.clip(agl_m, LOW_FT * M_PER_FT, HIGH_FT * M_PER_FT)
    # After 1e6 s even the slowest gusts, of 533 m at 0.1 m/s, have decayed to 1e-80.
    interval_s = np.minimum(interval_s, 1e6)
    kinds, which = _kinds(heights_m[1:], interval_s)
    size = len(STATES)
    steps = np.zeros((len(kinds) + 1, size, 2 * size))
    covariances = np.empty((len(kinds) + 1, size, size))
    start = flight_system(sigma_m_per_s, airspeed_m_per_s, float(heights_m[0]))
    covariances[0] = start.stationary_covariance()
    height_of, interval_of = heights_m[1:][kinds], interval_s[kinds]
    for height_m in np.unique(height_of).tolist():
        due = np.flatnonzero(height_of == height_m)
        system = flight_system(sigma_m_per_s, airspeed_m_per_s, height_m)
        change, covariances[1 + due] = system.discretise(interval_of[due])
        steps[1 + due, :, :size] = change + np.eye(size)
    steps[:, :, size:] = factor(covariances)
    return steps, np.append(np.zeros(1, np.intp), 1 + which)


def _kinds(height_m: Floats, interval_s: Floats) -> tuple[Ints, Ints]:
    """Distinct pairs of heights and intervals, (n,) each, at the resolutions of `RESOLUTIONS`.

    The resolution depends on the number of pairs so far, so the kind of an exposure does not depend on later ones.

    Returns
    -------
    kinds : array (k,)
        Index of the first pair of each kind.
    which : array (n,)
        Kind of each pair.
    """
    # Intervals below 1 ns act like 0, as the fastest time constant is 5 ms.
    places = np.log(np.stack([height_m, np.maximum(interval_s, 1e-9)]))
    kinds: list[Ints] = []
    which = np.empty(len(height_m), np.intp)
    start = count = 0
    for resolution, most in RESOLUTIONS:
        height, interval = np.floor(places[:, start:] / resolution).astype(np.int64)
        _, first, cell = np.unique((height << 32) + interval, return_index=True, return_inverse=True)
        order = np.argsort(first)
        rank = np.empty_like(order)
        rank[order] = np.arange(len(order))
        met = first[order]
        end = int(met[most]) if len(met) > most else len(height)
        which[start : start + end] = count + rank[cell[:end]]
        kinds.append(start + met[:most])
        start, count = start + end, count + min(len(met), most)
    return np.concatenate(kinds), which
