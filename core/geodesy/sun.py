"""Height and azimuth of the sun, by the equations of NOAA's solar calculator.

These are the low-precision equations of J. Meeus, Astronomical Algorithms (2nd edition), chapters 12, 13, 22 and 25:
from 1950 to 2050 within 0.01 degrees of NREL's SPA, as a test proves. Refraction, 0.03 degrees at a height of 30, is
ignored.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Floats


def sun_position(start: str, after_s: Floats, lat_deg: float, lon_deg: float) -> tuple[Floats, Floats]:
    """Height above the horizon and azimuth, clockwise from north, of the sun's centre, degrees (n,) each.

    Parameters
    ----------
    start : str
        UTC, ISO 8601, such as 2024-06-21T10:30:00Z.
    after_s : array (n,)
        Seconds after ``start``.
    """
    first = np.datetime64(start.rstrip("Z"), "us")
    j2000 = np.datetime64("2000-01-01T12:00:00", "us")
    days = ((first - j2000).astype(np.int64) + np.asarray(after_s, np.float64) * 1e6) / 86_400e6
    t = days / 36_525.0
    longitude = 280.46646 + t * (36_000.76983 + 0.0003032 * t)
    anomaly = np.radians(357.52911 + t * (35_999.05029 - 0.0001537 * t))
    centre = (
        np.sin(anomaly) * (1.914602 - t * (0.004817 + 0.000014 * t))
        + np.sin(2.0 * anomaly) * (0.019993 - 0.000101 * t)
        + np.sin(3.0 * anomaly) * 0.000289
    )
    node = np.radians(125.04 - 1934.136 * t)
    apparent = np.radians(longitude + centre - 0.00569 - 0.00478 * np.sin(node))
    obliquity = np.radians(23.4392911 - 0.0130042 * t + 0.00256 * np.cos(node))
    ascension = np.arctan2(np.cos(obliquity) * np.sin(apparent), np.cos(apparent))
    declination = np.arcsin(np.sin(obliquity) * np.sin(apparent))
    # Greenwich mean sidereal time, and the angle by which the sun is past the meridian.
    sidereal = 280.46061837 + 360.98564736629 * days + 0.000387933 * t * t
    hour = np.radians(sidereal + lon_deg) - ascension
    lat = np.radians(lat_deg)
    east = -np.cos(declination) * np.sin(hour)
    north = np.sin(declination) * np.cos(lat) - np.cos(declination) * np.sin(lat) * np.cos(hour)
    up = np.sin(declination) * np.sin(lat) + np.cos(declination) * np.cos(lat) * np.cos(hour)
    height = np.degrees(np.arctan2(up, np.hypot(east, north)))
    return height, np.mod(np.degrees(np.arctan2(east, north)), 360.0)
