"""A strapdown integrator that shares no code with the program: numpy alone, in geocentric axes.

Gravitation is the gradient of the zonal harmonics of the level ellipsoid, not the closed form that the program uses.
"""

from __future__ import annotations

import math

import numpy as np

GM, A, F, OMEGA = 3.986004418e14, 6378137.0, 1.0 / 298.257223563, 7.292115e-5
E2 = F * (2.0 - F)
# Of WGS 84 (NIMA TR8350.2, table 3.2 and equation 3-65).
J2 = 1.08262982131e-3
J = {
    2 * n: (-1) ** (n + 1) * 3.0 * E2**n / ((2 * n + 1) * (2 * n + 3)) * (1 - n + 5 * n * J2 / E2) for n in range(1, 6)
}


LEGENDRE = {n: np.polynomial.legendre.leg2poly([0.0] * n + [1.0])[::-1] for n in J}
SLOPES = {n: np.polyder(p) for n, p in LEGENDRE.items()}


def gravitation(place: np.ndarray) -> np.ndarray:
    """Gradient of GM/r (1 - sum J_n (a/r)^n P_n(z/r)), by Legendre's polynomials and their derivatives."""
    r = math.sqrt(place @ place)
    s = place[2] / r
    radial, polar = 1.0, 0.0
    for n, j in J.items():
        radial -= (n + 1) * j * (A / r) ** n * np.polyval(LEGENDRE[n], s)
        polar -= j * (A / r) ** n * np.polyval(SLOPES[n], s)
    out = place / r
    towards_pole = np.array([0.0, 0.0, 1.0]) - s * out
    return GM / r**2 * (-radial * out + polar * towards_pole)


def _rates(state, gyro, force):
    place, speed, q = state[:3], state[3:6], state[6:]
    q = q / np.linalg.norm(q)
    w, x, y, z = q
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    earth = np.array([0.0, 0.0, OMEGA])
    a, b, c = gyro - turn.T @ earth
    dq = 0.5 * np.array([-x * a - y * b - z * c, w * a + y * c - z * b, w * b - x * c + z * a, w * c + x * b - y * a])
    pull = gravitation(place) - np.cross(earth, np.cross(earth, place))
    return np.concatenate([speed, turn @ force + pull - 2.0 * np.cross(earth, speed), dq])


def integrate(gyro, force, step_s, place, speed, quaternion):
    """Integrate samples (2 n + 1, 3) that are ``step_s`` apart; return place, speed and quaternion at the last one."""
    state = np.concatenate([place, speed, quaternion])
    h = 2.0 * step_s
    for at in range(0, len(gyro) - 2, 2):
        one, two, three = (np.stack([gyro[at + k], force[at + k]]) for k in range(3))
        k1 = _rates(state, *one)
        k2 = _rates(state + 0.5 * h * k1, *two)
        k3 = _rates(state + 0.5 * h * k2, *two)
        k4 = _rates(state + h * k3, *three)
        state = state + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return state[:3], state[3:6], state[6:] / np.linalg.norm(state[6:])
