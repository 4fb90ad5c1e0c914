"""The way from capture to capture: its legs, and the clock of the flight."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pyproj import Geod

from ..geodesy.ellipsoid import WGS84
from ..geodesy.mercator import wrap_lon_deg
from ..geodesy.projections import through_proj
from .wind import Wind

Floats = NDArray[np.float64]


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
    ellipsoid = Geod(a=WGS84.a_m, b=WGS84.b_m)
    forward, _, distance = through_proj(ellipsoid.inv, lon[:-1], lat_deg[:-1], lon[1:], lat_deg[1:])
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
    airspeed_m_per_s : float
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
