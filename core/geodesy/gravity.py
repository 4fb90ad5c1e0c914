"""Normal gravity of WGS 84, and the Earth's rotation."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Floats
from .ellipsoid import WGS84, arctan2

#: Angular velocity of the Earth in rad/s, and gravitational constant of Earth and atmosphere in m³/s² (WGS 84).
EARTH_RATE_RAD_PER_S = 7.292115e-5
_GM_M3_PER_S2 = 3.986004418e14
#: Linear eccentricity of the ellipsoid.
_FOCUS_M = math.sqrt(WGS84.a_m**2 - WGS84.b_m**2)


def normal_gravity(points_m: Floats) -> Floats:
    """Normal gravity (n, 3) in m/s² at geocentric coordinates (n, 3), with the centrifugal acceleration.

    The field of the level ellipsoid in closed form, in ellipsoidal-harmonic coordinates: equations 4-5 to 4-18 of NIMA
    TR8350.2 (third edition, 2000). Exact outside of the ellipsoid, and continued into it.
    """
    x, y, z = np.asarray(points_m, np.float64).T
    e, rate, across = _FOCUS_M, EARTH_RATE_RAD_PER_S, np.hypot(x, y)
    excess = x * x + y * y + z * z - e * e
    u2 = 0.5 * excess * (1.0 + np.sqrt(1.0 + (2.0 * e * z / excess) ** 2))
    u, r2 = np.sqrt(u2), u2 + e * e
    r = np.sqrt(r2)
    beta = arctan2(z * r, u * across)
    sine, cosine = np.sin(beta), np.cos(beta)
    w = np.sqrt((u2 + (e * sine) ** 2) / r2)
    turning = (rate * WGS84.a_m) ** 2
    q, q0 = _second_harmonic(u), float(_second_harmonic(np.array(WGS84.b_m)))
    slope = 3.0 * (1.0 + u2 / (e * e)) * (1.0 - u / e * np.arctan(e / u)) - 1.0
    along_u = rate**2 * u * cosine**2 - (_GM_M3_PER_S2 + turning * e * slope / q0 * (0.5 * sine**2 - 1.0 / 6.0)) / r2
    along_beta = (turning * q / (q0 * r) - rate**2 * r) * sine * cosine
    outward = (along_u * u / r * cosine - along_beta * sine) / w**2
    # On the axis the acceleration has no component across it.
    shared = outward / np.where(across > 0.0, across, 1.0)
    return np.stack([shared * x, shared * y, (along_u * sine + along_beta * u / r * cosine) / w**2], axis=-1)


def _second_harmonic(u: Floats) -> Floats:
    """The function q of TR8350.2 at semi-minor axes u of confocal ellipsoids."""
    found: Floats = 0.5 * ((1.0 + 3.0 * (u / _FOCUS_M) ** 2) * np.arctan(_FOCUS_M / u) - 3.0 * u / _FOCUS_M)
    return found
