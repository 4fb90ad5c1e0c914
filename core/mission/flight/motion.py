"""Flight from capture to capture: its legs and its clock, and how gusts move and turn the camera at each exposure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Floats
from ...errors import InvalidInput
from ...geodesy.mercator import wrap_lon_deg
from ...geodesy.projections import geodesics
from ...units import M_PER_FT
from .gusts import HIGH_FT, LOW_FT, STATES, factor, flight_system, outputs
from .wind import Wind

Ints = NDArray[np.intp]
#: Intervals shorter than this are as good as none: the fastest time constant is 5 ms.
SHORTEST_S = 1e-9
#: Longer ones are cut to this: even the slowest gusts, of 533 m at 0.1 m/s, are forgotten by then to 1e-80.
LONGEST_S = 1e6
#: Discretisations for one flight, of 8 KB and half a millisecond each.
MOST_STEPS = 2048
#: Shares of an interval or a height within which two are the same, and how many different pairs are met before the next
#: one counts. The first is what distances along parallels agree to, and more; the last has few pairs left.
ROUNDED = ((1e-6, 480), (4e-3, 800), (0.016, 200), (0.064, 200), (0.256, 100), (1.0, MOST_STEPS))
#: Exposures sampled at a time: 1.5 MB of states and noise, which stay in the processor's cache.
CHUNK = 4096


class Legs(NamedTuple):
    """Geodesics from each capture to the next, arrays (n - 1,): azimuth at their beginning in degrees, and metres."""

    azimuth_deg: Floats
    distance_m: Floats

    def headings_deg(self) -> Floats:
        """Track over ground at each exposure, (n,): that of the leg ahead, at the last one that of the leg behind."""
        if not len(self.azimuth_deg):
            return np.zeros(1)
        return np.append(self.azimuth_deg, self.azimuth_deg[-1:])


def legs(lat_deg: Floats, lon_deg: Floats) -> Legs:
    """Legs between captures at positions in degrees, (n,) each, n >= 1."""
    lon = wrap_lon_deg(lon_deg)
    forward, _, distance = geodesics(lat_deg[:-1], lon[:-1], lat_deg[1:], lon[1:])
    return Legs(forward, distance)


def intervals_s(way: Legs, agl_m: Floats, airspeed_m_per_s: float, wind: Wind | None) -> Floats:
    """Seconds from each exposure to the next, (n - 1,).

    A leg over ground is flown at the ground speed that its heading has in the wind, and a climb or descent at the
    airspeed; along a slanting leg both go together, as the sides of a right triangle. Turns, and the way there and
    back, are not counted.

    Parameters
    ----------
    agl_m : array (n,)
        Heights above ground of the captures.
    wind : Wind or None
        None for still air.
    """
    speed: Floats | float = airspeed_m_per_s
    if wind is not None:
        speed = wind.ground_speed_m_per_s(way.azimuth_deg, airspeed_m_per_s)
    along = way.distance_m / speed
    if not any(agl_m.strides):
        return np.asarray(along, np.float64)
    seconds: Floats = np.hypot(along, np.diff(agl_m) / airspeed_m_per_s)
    return seconds


@dataclass(frozen=True, eq=False)
class Disturbance:
    """Error of the real pose relative to the nominal one at each exposure.

    Parameters
    ----------
    east_m, north_m, up_m : array (n,)
        Offset of the camera, in metres.
    yaw_deg, tilt_deg, roll_deg : array (n,)
        To be added to the nominal angles, in degrees.
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

    `gusts.flight_system` is the process. Its state lives in the directions of flight through the air and goes along
    through turns: what was ahead of the aircraft stays ahead. Between two exposures the height is that of the second.
    Steady wind turns those directions by the crab angle and nothing else: the hold takes out a steady offset, and the
    camera's mount a steady lean and crab. The aircraft's remaining pitch and roll become the camera's tilt and
    roll through the angle from the top of the image to the direction of flight, to first order in them and with the
    camera looking down; of an oblique camera they are taken as the errors of its mount's own angles.

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
        The same on every platform and with every numpy, to a millionth of its sigma (the rounding of processors,
        through nearly singular covariances), and the same for the exposures that two flights have in common at their
        beginning.

    Raises
    ------
    InvalidInput
        On shapes that do not match, on values outside the domain, and as `Wind.flown_at` does.
    """
    wind.flown_at(airspeed_m_per_s)
    heading_deg, agl_m = np.asarray(heading_deg, np.float64), np.asarray(agl_m, np.float64)
    interval_s, yaw_deg = np.asarray(interval_s, np.float64), np.asarray(yaw_deg, np.float64)
    _check(interval_s, heading_deg, agl_m, yaw_deg)
    if wind.sigma_m_per_s == 0.0 or heading_deg.size == 0:
        return Disturbance(*np.zeros((6, heading_deg.size)))
    along, across, up, pitch, roll, yaw = _sampled(wind, airspeed_m_per_s, interval_s, agl_m)
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
            raise InvalidInput(
                "{0} of shape {1}: must be {2} for {3} exposures", name, values.shape, wanted, count
            )
    if yaw_deg.shape not in ((), (count,)):
        raise InvalidInput(
            "yaws of shape {0}: must be one, or one for each of {1} exposures", yaw_deg.shape, count
        )
    for name, values, right, rule in (
        ("interval", interval_s, interval_s >= 0.0, "s: must be 0 or more"),
        ("heading", heading_deg, np.isfinite(heading_deg), "deg: must be a number"),
        ("height above ground", agl_m, agl_m > 0.0, "m: must be above 0"),
        ("yaw", yaw_deg, np.isfinite(yaw_deg), "deg: must be a number"),
    ):
        wrong = values[~(right & np.isfinite(values))]
        if wrong.size:
            raise InvalidInput("{0} {1} {2}", name, wrong.flat[0], rule)


def _sampled(wind: Wind, airspeed_m_per_s: float, interval_s: Floats, agl_m: Floats) -> Floats:
    """`gusts.OUTPUTS` at each exposure (6, n).

    Each exposure is one product of a matrix with the state before it and fresh normal deviates beside each other.
    """
    steps, which = _steps(wind.sigma_m_per_s, airspeed_m_per_s, interval_s, agl_m)
    size = len(STATES)
    picked = outputs()
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


def _steps(
    sigma_m_per_s: float, airspeed_m_per_s: float, interval_s: Floats, agl_m: Floats
) -> tuple[Floats, Ints]:
    """Return the matrices (m, d, 2 d) that step the state, one for each kind of step, and each exposure's kind (n,).

    The first starts the flight: it forgets the state and draws from the stationary distribution. Rounding an interval
    or a height, where there are too many, leaves the distribution at each exposure exact; only the correlation
    between neighbours is then that of the rounded interval.
    """
    heights_m = np.clip(agl_m, LOW_FT * M_PER_FT, HIGH_FT * M_PER_FT)
    kinds, which = _kinds(heights_m[1:], np.minimum(interval_s, LONGEST_S))
    size = len(STATES)
    steps = np.zeros((len(kinds) + 1, size, 2 * size))
    covariances = np.empty((len(kinds) + 1, size, size))
    start = flight_system(sigma_m_per_s, airspeed_m_per_s, float(heights_m[0]))
    covariances[0] = start.stationary_covariance()
    height_of, interval_of = heights_m[1:][kinds], np.minimum(interval_s, LONGEST_S)[kinds]
    for height_m in np.unique(height_of).tolist():
        due = np.flatnonzero(height_of == height_m)
        system = flight_system(sigma_m_per_s, airspeed_m_per_s, height_m)
        change, covariances[1 + due] = system.discretise(interval_of[due])
        steps[1 + due, :, :size] = change + np.eye(size)
    steps[:, :, size:] = factor(covariances)
    return steps, np.append(np.zeros(1, np.intp), 1 + which)


def _kinds(height_m: Floats, interval_s: Floats) -> tuple[Ints, Ints]:
    """Different pairs of heights and intervals, (n,) each, as far as they are told apart.

    How far depends on how many there have been: what an exposure counts as does not depend on any that follow.

    Returns
    -------
    kinds : array (k,)
        Indices of the pairs that stand for those like them: the first of each.
    which : array (n,)
        The kind of each pair.
    """
    places = np.log(np.stack([height_m, np.maximum(interval_s, SHORTEST_S)]))
    kinds: list[Ints] = []
    which = np.empty(len(height_m), np.intp)
    start = count = 0
    for resolution, most in ROUNDED:
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


def normal(bits: np.random.PCG64, count: int, size: int) -> Floats:
    """Independent standard normal deviates (count, size), by Box and Muller's method.

    From the generator's raw words, which numpy keeps the same for ever, and not from its own normal deviates, which
    it does not. Every row takes the same number of words, so that a flight does not depend on how it is cut up.
    """
    pairs = (size + 1) // 2
    even = uniform(bits, 2 * count * pairs).reshape(count, 2, pairs)
    radius = np.sqrt(-2.0 * np.log(1.0 - even[:, 0]))  # of 2^-53 to 1, without rounding
    angle = (2.0 * np.pi) * even[:, 1]
    normal: Floats = np.concatenate([radius * np.cos(angle), radius * np.sin(angle)], axis=1)[:, :size]
    return normal


def uniform(bits: np.random.PCG64, count: int) -> Floats:
    """Numbers (count,) evenly from 0 to below 1, of 53 bits of a raw word each."""
    words = np.asarray(bits.random_raw(count), np.uint64)
    numbers: Floats = (words >> np.uint64(11)) * 2.0**-53
    return numbers
