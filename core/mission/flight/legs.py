"""Legs from capture to capture, and their durations."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Floats
from ...geodesy.mercator import wrap_lon_deg
from ...geodesy.projections import geodesics
from .wind import Wind


class Legs(NamedTuple):
    """Geodesics from each capture to the next, arrays (n - 1,): azimuth at the start, degrees, and length, metres."""

    azimuth_deg: Floats
    distance_m: Floats

    def headings_deg(self) -> Floats:
        """Track over ground at each exposure, (n,): azimuth of the leg ahead; at the last one, of the leg behind."""
        if not len(self.azimuth_deg):
            return np.zeros(1)
        return np.append(self.azimuth_deg, self.azimuth_deg[-1:])


def legs(lat_deg: Floats, lon_deg: Floats) -> Legs:
    """Legs between captures at positions in degrees, (n,) each, n >= 1."""
    if len(lat_deg) == 1:
        # A plan of one image is made without importing pyproj.
        return Legs(np.empty(0), np.empty(0))
    lon = wrap_lon_deg(lon_deg)
    forward, _, distance = geodesics(lat_deg[:-1], lon[:-1], lat_deg[1:], lon[1:])
    return Legs(forward, distance)


def intervals_s(way: Legs, agl_m: Floats, airspeed_m_per_s: float, wind: Wind | None) -> Floats:
    """Seconds from each exposure to the next, (n - 1,).

    Legs are flown at the ground speed of their heading in the wind, climbs and descents at the airspeed; along a
    slanting leg the two times combine like the sides of a right triangle. Turns and transits are not included.

    Parameters
    ----------
    agl_m : array (n,)
        Heights of the captures above ground.
    wind : Wind or None
        None for still air.
    """
    speed: Floats | float = airspeed_m_per_s
    if wind is not None:
        speed = wind.ground_speed_m_per_s(way.azimuth_deg, airspeed_m_per_s)
    along = way.distance_m / speed
    # A height that is broadcast from one number needs no climbs.
    if not any(agl_m.strides):
        return np.asarray(along, np.float64)
    seconds: Floats = np.hypot(along, np.diff(agl_m) / airspeed_m_per_s)
    return seconds
