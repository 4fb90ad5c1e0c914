"""Height and azimuth of the sun, by NREL's Solar Position Algorithm.

I. Reda and A. Andreas, Solar Position Algorithm for Solar Radiation Applications, NREL/TP-560-34302 (2004, revised
2008), whose uncertainty is 0.0003 degrees. UT1 is taken as UTC, which turns the Earth by at most 0.004 degrees, and
terrestrial time as UTC and `DELTA_T_S`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput
from .sun_terms import DISTANCE, LATITUDE, LONGITUDE, NUTATION

#: Terrestrial time less UT1 in the 2020s; 12 s more or less move the sun by 0.0002 degrees.
DELTA_T_S = 69.0
#: Radius of the sun's disc, and refraction at the horizon, degrees, as the algorithm has them.
RADIUS_DEG, HORIZON_REFRACTION_DEG = 0.26667, 0.5667
#: Mean elongation of the moon, anomalies of sun and moon, argument of latitude and node of the moon, degrees: rows of
#: coefficients of 1, t, t² and t³, with t in centuries.
_ARGUMENTS = np.array(
    [
        [297.85036, 445_267.111480, -0.0019142, 1.0 / 189_474.0],
        [357.52772, 35_999.050340, -0.0001603, -1.0 / 300_000.0],
        [134.96298, 477_198.867398, 0.0086972, 1.0 / 56_250.0],
        [93.27191, 483_202.017538, -0.0036825, 1.0 / 327_270.0],
        [125.04452, -1934.136261, 0.0020708, 1.0 / 450_000.0],
    ]
)
#: Mean obliquity of the ecliptic, arcseconds: coefficients of powers of 10,000 years, from the highest.
_OBLIQUITY = (2.45, 5.79, 27.87, 7.12, -39.05, -249.67, -51.38, 1999.25, -1.55, -4680.93, 84_381.448)
#: Polar over equatorial radius of the Earth.
_FLATTENED = 0.99664719


def sun_position(
    start: str, after_s: Floats, lat_deg: float, lon_deg: float, *, refracted: bool = False
) -> tuple[Floats, Floats]:
    """Height above the horizon and azimuth, clockwise from north, of the sun's centre, degrees (n,) each.

    Seen from the ellipsoid; 1 km higher it moves by less than a millionth of a degree.

    Parameters
    ----------
    start : str
        UTC, ISO 8601, such as 2024-06-21T10:30:00Z.
    after_s : array (n,)
        Seconds after ``start``.
    refracted : bool
        Whether the height is the apparent one, raised by refraction; see `refraction_deg`.
    """
    first = np.datetime64(start.rstrip("Z"), "us")
    j2000 = np.datetime64("2000-01-01T12:00:00", "us")
    days = ((first - j2000).astype(np.int64) + np.asarray(after_s, np.float64) * 1e6) / 86_400e6
    ascension, declination, distance, equation = _geocentric(days + DELTA_T_S / 86_400.0)
    t = days / 36_525.0
    sidereal = 280.46061837 + 360.98564736629 * days + t * t * (0.000387933 - t / 38_710_000.0) + equation
    hour = np.radians(sidereal + lon_deg) - ascension
    # Vectors to the equator below the meridian, east along the equator, and north; of the place, in Earth radii.
    sun = np.stack([np.cos(declination) * np.cos(hour), -np.cos(declination) * np.sin(hour), np.sin(declination)])
    lat = np.radians(lat_deg)
    reduced = np.arctan2(_FLATTENED * np.sin(lat), np.cos(lat))
    parallax = np.radians(8.794 / 3600.0) / distance
    sun[0] -= np.cos(reduced) * parallax
    sun[2] -= _FLATTENED * np.sin(reduced) * parallax
    east, north = sun[1], sun[2] * np.cos(lat) - sun[0] * np.sin(lat)
    up = sun[0] * np.cos(lat) + sun[2] * np.sin(lat)
    height = np.degrees(np.arctan2(up, np.hypot(east, north)))
    if refracted:
        height = height + refraction_deg(height)
    return height, np.mod(np.degrees(np.arctan2(east, north)), 360.0)


def refraction_deg(height_deg: Floats, pressure_mbar: float = 1010.0, temperature_c: float = 10.0) -> Floats:
    """Degrees by which refraction raises the sun, from its height without refraction; 0 once it has set."""
    bent = 1.02 / (60.0 * np.tan(np.radians(height_deg + 10.3 / (height_deg + 5.11))))
    bent *= pressure_mbar / 1010.0 * 283.0 / (273.0 + temperature_c)
    return np.where(height_deg >= -RADIUS_DEG - HORIZON_REFRACTION_DEG, bent, 0.0)


def _geocentric(days: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Right ascension and declination, radians, distance, and equation of the equinoxes, degrees.

    ``days`` (n,) of terrestrial time count from 2000-01-01T12:00.
    """
    centuries = days / 36_525.0
    millennia = centuries / 10.0
    distance = _series(DISTANCE, millennia)
    arguments = np.radians(_ARGUMENTS @ np.stack([centuries**k for k in range(4)]))
    angle = NUTATION[:, :5] @ arguments
    a, b, c, d = (column[:, np.newaxis] for column in NUTATION[:, 5:].T)
    in_longitude = ((a + b * centuries) * np.sin(angle)).sum(axis=0) / 36e6
    in_obliquity = ((c + d * centuries) * np.cos(angle)).sum(axis=0) / 36e6
    obliquity = np.radians(np.polyval(_OBLIQUITY, millennia / 10.0) / 3600.0 + in_obliquity)
    aberration = -20.4898 / (3600.0 * distance)
    longitude = _series(LONGITUDE, millennia) + np.pi + np.radians(in_longitude + aberration)
    latitude = -_series(LATITUDE, millennia)
    ascension = np.arctan2(
        np.sin(longitude) * np.cos(obliquity) - np.tan(latitude) * np.sin(obliquity), np.cos(longitude)
    )
    declination = np.arcsin(
        np.sin(latitude) * np.cos(obliquity) + np.cos(latitude) * np.sin(obliquity) * np.sin(longitude)
    )
    return ascension, declination, distance, in_longitude * np.cos(obliquity)


def _series(powers: tuple[Floats, ...], millennia: Floats) -> Floats:
    """Sum of periodic terms, times powers of time, in radians or astronomical units."""
    sums = [
        (terms[:, :1] * np.cos(terms[:, 1:2] + terms[:, 2:] * millennia)).sum(axis=0) * millennia**power
        for power, terms in enumerate(powers)
    ]
    return np.asarray(sum(sums) / 1e8)


@dataclass(frozen=True)
class SunDirection:
    """Where the sun stands over a place, and how much of the light there comes from the sky.

    Parameters
    ----------
    height_deg, azimuth_deg : float
        Above the horizon, above 0 and at most 90; clockwise from north.
    lat_deg, lon_deg : float
        The place. The sun's rays are parallel: elsewhere they make other angles with the vertical and with north.

    Raises
    ------
    InvalidInput
        A height or azimuth out of range.
    """

    height_deg: float
    azimuth_deg: float
    lat_deg: float = 0.0
    lon_deg: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 < self.height_deg <= 90.0:
            raise InvalidInput(
                "sun at a height of {0:g} degrees: must be above 0 and at most 90", self.height_deg, field="sun"
            )
        if not -360.0 <= self.azimuth_deg <= 360.0:
            raise InvalidInput("sun at an azimuth of {0:g} degrees: must be -360 to 360", self.azimuth_deg, field="sun")

    @property
    def enu(self) -> Floats:
        """Unit vector to the sun, in east, north and up, (3,)."""
        up, around = np.radians(self.height_deg), np.radians(self.azimuth_deg)
        return np.array([np.cos(up) * np.sin(around), np.cos(up) * np.cos(around), np.sin(up)])

    @property
    def direct_lx(self) -> float:
        """Illuminance of level ground by the sun alone, under a clear sky: IES Lighting Handbook, 10th edition, 7.7.

        With the mean distance of the sun, and an air mass of the height's cosecant.
        """
        sine = math.sin(math.radians(self.height_deg))
        return 128_000.0 * math.exp(-0.21 / sine) * sine

    @property
    def sky_lx(self) -> float:
        """Illuminance of level ground by the clear sky alone."""
        return 800.0 + 15_500.0 * math.sqrt(math.sin(math.radians(self.height_deg)))

    @property
    def sky_share(self) -> float:
        """Share of the light on level ground, in the sun, that comes from the sky."""
        return self.sky_lx / (self.sky_lx + self.direct_lx)

    def light(self, cosine: Floats, up: Floats) -> Floats:
        """Light on surfaces (n,) relative to that of level ground in the sun.

        Parameters
        ----------
        cosine : array (n,)
            Of the angles between their normals and the sun.
        up : array (n,)
            Upward component of their unit normals; they get light from the part of an even sky that they face.
        """
        direct = np.maximum(cosine, 0.0) / math.sin(math.radians(self.height_deg))
        return np.asarray(self.sky_share * (1.0 + up) / 2.0 + (1.0 - self.sky_share) * direct)
