"""Readings of a GNSS receiver, a barometer and a magnetometer on a trajectory, with random errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Floats
from ..geodesy.ellipsoid import WGS84
from ..geodesy.local import enu_axes, geodetic
from ..geodesy.magnetic import magnetic_field
from ..geodesy.mercator import wrap_lon_deg
from ..poses.priors import draw_errors
from ..poses.settings import Sensors
from .trajectory import Motion

#: The International Standard Atmosphere below 11 km (ISO 2533:1975): temperature and pressure at sea level, lapse rate,
#: and the exponent g/(R L).
_SEA_K, _SEA_PA, _LAPSE_K_PER_M = 288.15, 101_325.0, 0.0065
_EXPONENT = 9.80665 / (287.05287 * _LAPSE_K_PER_M)
#: Seconds of a mean year of the Gregorian calendar, and its first year.
_YEAR_S, _FIRST_YEAR = 365.2425 * 86_400.0, 1970.0


def gnss_places(motion: Motion, time_s: Floats, sensors: Sensors, seed: int) -> tuple[Floats, Floats, Floats]:
    """Latitudes, longitudes and heights above the ellipsoid (n,) that a receiver measures; NaN in outages.

    Errors to the east, to the north and of the height each have the deviation of the sensor's place.
    """
    errors, fixed = draw_errors(time_s, replace(sensors, barometer_m=sensors.gnss_m), seed)
    lat, lon, height = geodetic(motion.place_m)
    north = np.degrees(errors[:, 1] / WGS84.meridional_radius_m(lat))
    east = np.degrees(errors[:, 0] / (WGS84.normal_radius_m(lat) * np.cos(np.radians(lat))))
    measured = (np.clip(lat + north, -90.0, 90.0), wrap_lon_deg(lon + east), height + errors[:, 2])
    found = np.where(fixed, np.stack(measured), np.nan)
    return found[0], found[1], found[2]


def pressures_pa(motion: Motion, time_s: Floats, sensors: Sensors, seed: int) -> Floats:
    """Pressures (n,) of the standard atmosphere, with heights above the ellipsoid as those above the sea."""
    errors, _ = draw_errors(time_s, sensors, seed)
    height = geodetic(motion.place_m)[2] + errors[:, 2]
    pressures: Floats = _SEA_PA * (1.0 - _LAPSE_K_PER_M * height / _SEA_K) ** _EXPONENT
    return pressures


def magnetic_fields_nt(motion: Motion, time_s: Floats, start_us: int, sensors: Sensors, seed: int) -> Floats:
    """Main magnetic field (n, 3) in the body's axes, turned about the vertical by the errors of the compass."""
    errors, _ = draw_errors(time_s, sensors, seed)
    lat, lon, height = geodetic(motion.place_m)
    east, north, up = magnetic_field(lat, lon, height, _FIRST_YEAR + start_us / 1e6 / _YEAR_S).T
    # A heading that reads too much sees north too far to the left.
    turn = np.radians(errors[:, 3])
    field = np.stack(
        [east * np.cos(turn) - north * np.sin(turn), east * np.sin(turn) + north * np.cos(turn), up], axis=-1
    )
    to_body = np.swapaxes(enu_axes(lat, lon) @ motion.rotation, -1, -2)
    fields: Floats = np.einsum("nij,nj->ni", to_body, field)
    return fields
