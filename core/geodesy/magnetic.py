"""The Earth's main magnetic field: IGRF, 14th generation."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput
from ..resources import read_json
from .local import enu_axes, geocentric

#: Reference radius of the model.
_RADIUS_M = 6_371_200.0
_DEGREE = 13


@cache
def _model() -> tuple[Floats, Floats]:
    """Years (k,) and Schmidt semi-normalised coefficients (k, 14, 14, 2) in nT: g, and h, by degree and order."""
    data = read_json("igrf14.json")
    found = np.zeros((len(data["years"]), _DEGREE + 1, _DEGREE + 1, 2))
    for degree, order, *values in data["coefficients"]:
        found[:, degree, abs(order), int(order < 0)] = values
    return np.array(data["years"], np.float64), found


def magnetic_field(lat_deg: Floats, lon_deg: Floats, height_m: Floats, year: float) -> Floats:
    """Main field (n, 3) to the east, north and up in nT at positions (n,) and heights above the ellipsoid.

    Parameters
    ----------
    year : float
        Decimal year, from 1990 to 2030.

    Raises
    ------
    InvalidInput
        The model does not have the year.
    """
    years, coefficients = _model()
    if not years[0] <= year <= years[-1]:
        raise InvalidInput(
            "year {0:.1f}: the magnetic field is known from {1:.0f} to {2:.0f}",
            year,
            years[0],
            years[-1],
            field="start",
        )
    at = min(int(np.searchsorted(years, year, side="right")) - 1, len(years) - 2)
    share = (year - years[at]) / (years[at + 1] - years[at])
    g, h = np.moveaxis((1.0 - share) * coefficients[at] + share * coefficients[at + 1], -1, 0)
    places = geocentric(lat_deg, lon_deg, height_m)
    radius = np.linalg.norm(places, axis=-1)
    cosine = places[..., 2] / radius
    # The field is smooth across the poles, where its components along the parallel are the limits.
    sine = np.maximum(np.hypot(places[..., 0], places[..., 1]) / radius, 1e-9)
    longitude = np.radians(lon_deg)
    outward, southward, eastward = _spherical(g, h, radius, cosine, sine, longitude)
    along = np.stack([np.cos(longitude), np.sin(longitude)], axis=-1)
    across = outward * sine + southward * cosine
    field = np.stack(
        [
            across * along[..., 0] - eastward * along[..., 1],
            across * along[..., 1] + eastward * along[..., 0],
            outward * cosine - southward * sine,
        ],
        axis=-1,
    )
    enu: Floats = np.einsum("nij,nj->ni", enu_axes(lat_deg, lon_deg), field)
    return enu


def _spherical(
    g: Floats, h: Floats, radius: Floats, cosine: Floats, sine: Floats, longitude: Floats
) -> tuple[Floats, Floats, Floats]:
    """Components (n,) outwards, to the south and to the east, of the sphere; by recursion over the order."""
    outward, southward, eastward = (np.zeros_like(radius) for _ in range(3))
    diagonal, slope = np.ones_like(radius), np.zeros_like(radius)
    for m in range(_DEGREE + 1):
        if m:
            factor = math.sqrt(1.0 - 0.5 / m) if m > 1 else 1.0
            diagonal, slope = factor * sine * diagonal, factor * (sine * slope + cosine * diagonal)
        # Legendre functions of degrees n - 1 and n - 2, with their derivatives by colatitude.
        last, last_slope, before, before_slope = diagonal, slope, np.zeros_like(radius), np.zeros_like(radius)
        for n in range(m, _DEGREE + 1):
            if n > m:
                k, j = math.sqrt(n * n - m * m), math.sqrt((n - 1) ** 2 - m * m)
                new = ((2 * n - 1) * cosine * last - j * before) / k
                new_slope = ((2 * n - 1) * (cosine * last_slope - sine * last) - j * before_slope) / k
                last, last_slope, before, before_slope = new, new_slope, last, last_slope
            if not n:
                continue
            power = (_RADIUS_M / radius) ** (n + 2)
            wave = g[n, m] * np.cos(m * longitude) + h[n, m] * np.sin(m * longitude)
            turned = g[n, m] * np.sin(m * longitude) - h[n, m] * np.cos(m * longitude)
            outward += (n + 1) * power * wave * last
            southward -= power * wave * last_slope
            eastward += power * m * turned * last / sine
    return outward, southward, eastward
