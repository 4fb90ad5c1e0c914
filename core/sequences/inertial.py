"""Inertial units: rates and specific force on a trajectory, exact and with errors.

Samples are the values at their times, not means over the time from the last one.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..geodesy.gravity import EARTH_RATE_RAD_PER_S, normal_gravity
from ..mission.flight.deviates import normal
from .settings import InertialErrors
from .trajectory import Motion


class Inertial(NamedTuple):
    """Measurements of an inertial unit in its axes, arrays (n, 3).

    Attributes
    ----------
    rate_rad_per_s : array
        Rate of turn against the stars.
    force_m_per_s2 : array
        Specific force: acceleration against free fall.
    """

    rate_rad_per_s: Floats
    force_m_per_s2: Floats


def exact_inertial(motion: Motion) -> Inertial:
    """What an inertial unit without errors measures, with normal gravity and the Earth's rotation."""
    to_body = np.swapaxes(motion.rotation, -1, -2)
    earth = np.array([0.0, 0.0, EARTH_RATE_RAD_PER_S])
    force = motion.acceleration_m_per_s2 + 2.0 * np.cross(earth, motion.velocity_m_per_s)
    force -= normal_gravity(motion.place_m)
    return Inertial(motion.rate_rad_per_s + to_body @ earth, np.einsum("nij,nj->ni", to_body, force))


def measured_inertial(exact: Inertial, errors: InertialErrors, rate_hz: float, seed: int) -> tuple[Inertial, Inertial]:
    """Measurements with errors, and their biases.

    A measurement is the exact value by a scale factor, plus a bias, plus white noise. Scale factors and first biases
    are drawn once for each axis; biases then walk at random. A measurement does not depend on those after it.

    Parameters
    ----------
    exact : Inertial
        Exact values at a constant rate.
    rate_hz : float
        Samples per second.
    seed : int
        At least 0.
    """
    once_bits, white_bits, walk_bits = (np.random.PCG64(one) for one in np.random.SeedSequence(seed).spawn(3))
    count = len(exact.rate_rad_per_s)
    once = normal(once_bits, 1, 12)[0].reshape(4, 3)
    white, walk = (normal(bits, count, 6).reshape(count, 2, 3) for bits in (white_bits, walk_bits))
    # The first bias is that of the start.
    walk[0] = 0.0
    walk = np.cumsum(walk, axis=0) / math.sqrt(rate_hz)
    white *= math.sqrt(rate_hz)
    measured, biases = [], []
    sizes = (
        (errors.gyro_bias, errors.gyro_scale, errors.gyro_walk, errors.gyro_noise),
        (errors.accelerometer_bias, errors.accelerometer_scale, errors.accelerometer_walk, errors.accelerometer_noise),
    )
    for number, (values, (bias, scale, walking, noise)) in enumerate(zip(exact, sizes)):
        biases.append(bias * once[2 * number] + walking * walk[:, number])
        measured.append(values * (1.0 + scale * once[2 * number + 1]) + biases[-1] + noise * white[:, number])
    return Inertial(*measured), Inertial(*biases)
