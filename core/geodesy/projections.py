"""Geodesics, projections in metres (UTM, and a conformal plane about any position), and coordinates in any CRS."""

from __future__ import annotations

import math
import re
import threading
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Floats
from .ellipsoid import WGS84, sin_cos
from .reference import read_reference

if TYPE_CHECKING:
    # Imported only where used: level plans on the Web-Mercator map need no projection.
    from pyproj import CRS, Geod, Proj

#: Rounding of positions in degrees and of projections, metres; 4 nm were observed.
NOISE_M = 5e-8


@dataclass(frozen=True)
class UTMZone:
    """A zone, 1 to 60, of one hemisphere."""

    number: int
    south: bool

    @property
    def epsg(self) -> int:
        """EPSG code of WGS 84 / UTM in this zone."""
        return (32700 if self.south else 32600) + self.number

    @property
    def central_meridian_deg(self) -> float:
        """Longitude of the zone's central meridian in degrees."""
        return 6.0 * self.number - 183.0

    def forward(self, lon_deg: Floats, lat_deg: Floats) -> tuple[Floats, Floats]:
        """Easting and northing in metres of positions in degrees (any shape)."""
        x, y = through_proj(_utm(self), lon_deg, lat_deg)
        return np.asarray(x, np.float64), np.asarray(y, np.float64)

    def inverse(self, x_m: Floats, y_m: Floats) -> tuple[Floats, Floats]:
        """Longitude (wrapped) and latitude in degrees of eastings and northings in metres (any shape)."""
        lon, lat = through_proj(_utm(self), x_m, y_m, inverse=True)
        return np.asarray(lon, np.float64), np.asarray(lat, np.float64)


def _utm(zone: UTMZone) -> Proj:
    return projection(proj="utm", zone=zone.number, south=zone.south, ellps="WGS84")


def utm_zone(lat_deg: float, lon_deg: float) -> UTMZone:
    """Zone of a position in degrees, with the exceptions of Norway and Svalbard (EPSG guidance note 7-2).

    North of 84° and south of 80°, where charts use the polar UPS, it is the zone of the longitude: its grid still
    points north, and the projection stays exact.
    """
    lon = (lon_deg + 180.0) % 360.0 - 180.0
    number = min(int((lon + 180.0) // 6.0) + 1, 60)
    if 56.0 <= lat_deg < 64.0 and 3.0 <= lon < 12.0:
        number = 32
    elif 72.0 <= lat_deg < 84.0 and 0.0 <= lon < 42.0:
        number = 31 if lon < 9.0 else 33 if lon < 21.0 else 35 if lon < 33.0 else 37
    return UTMZone(number, lat_deg < 0.0)


@dataclass(frozen=True)
class LocalPlane:
    """Oblique stereographic plane (EPSG method 9809) with true scale at its origin.

    The scale at the distance r is 1 + (r / 2R)²: 100 km away it moves the edges of an image of 640 px by 0.02 px.

    Parameters
    ----------
    lat_deg, lon_deg : float
        Origin, on WGS84.
    angle_deg : float
        Angle by which the axes are turned clockwise from east and north.
    """

    lat_deg: float
    lon_deg: float
    angle_deg: float = 0.0

    def forward(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Positions in metres along the axes, of positions in degrees (any shape)."""
        project, middle_m = _stereographic(self.lat_deg)
        east, north = through_proj(project, lon_deg - self.lon_deg, lat_deg)
        north = north - middle_m
        sine, cosine = self._turn()
        return east * cosine - north * sine, east * sine + north * cosine

    def inverse(self, x_m: Floats, y_m: Floats) -> tuple[Floats, Floats]:
        """Latitude and longitude in degrees of positions (any shape); longitudes are continuous with the origin's."""
        sine, cosine = self._turn()
        east, north = x_m * cosine + y_m * sine, y_m * cosine - x_m * sine
        project, middle_m = _stereographic(self.lat_deg)
        dlon, lat = through_proj(project, east, north + middle_m, inverse=True)
        return lat, self.lon_deg + dlon

    def north_deg(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Direction of true north at positions (any shape), degrees clockwise from the plane's second axis."""
        # Over 11 m of ground to either side, rounding of positions turns the direction by 4e-10 rad.
        ends = (self.forward(lat_deg + step_deg, lon_deg) for step_deg in (-1e-4, 1e-4))
        (x0, y0), (x1, y1) = ends
        bearing: Floats = np.degrees(np.arctan2(x1 - x0, y1 - y0))
        return bearing

    def _turn(self) -> tuple[float, float]:
        sine, cosine = sin_cos(self.angle_deg)
        return float(sine), float(cosine)


def _stereographic(lat_deg: float) -> tuple[Proj, float]:
    """Projection about a latitude, with longitudes counted from the origin, and the origin's northing in metres.

    The northing is 0 except within 5e-9 degrees of the equator, where PROJ puts the origin on the equator.
    """
    project = projection(proj="sterea", lat_0=lat_deg, lon_0=0.0, ellps="WGS84")
    return project, float(project(0.0, lat_deg)[1])


def _new_projection(**definition: Any) -> Proj:
    from pyproj import Proj

    return Proj(**definition)


class _Projections(threading.local):
    """Cache of projections, one per thread: a projection takes 0.4 ms to create and is not thread-safe."""

    def __init__(self) -> None:
        self.get = lru_cache(maxsize=8)(_new_projection)


_PROJECTIONS = _Projections()


def projection(**definition: Any) -> Proj:
    """Projection by PROJ's parameters, for the current thread."""
    return _PROJECTIONS.get(**definition)


def through_proj(function: Callable[..., tuple[Any, ...]], *values: Any, **options: Any) -> tuple[Floats, ...]:
    """Call a pyproj function with arrays that broadcast; results have their common shape.

    pyproj converts an array of one value to a number, which numpy 2 deprecates, so such a value is passed twice.
    """
    arrays = np.broadcast_arrays(*(np.asarray(value, np.float64) for value in values))
    shape, size = arrays[0].shape, arrays[0].size
    flat = [np.resize(array, 2) if size == 1 else array.ravel() for array in arrays]
    return tuple(np.asarray(result, np.float64)[:size].reshape(shape) for result in function(*flat, **options))


class Transformation:
    """PROJ's transformation from WGS 84 to a CRS, and its exact inverse; used only by the thread that made it.

    PROJ's inverses are approximate: a Helmert transformation is up to 6 mm off, as small angles replace their sines,
    and for a CRS with one transformation per region PROJ may choose different ones forward and back. So the forward
    transformation alone defines positions.

    Parameters
    ----------
    crs : CRS
    """

    def __init__(self, crs: CRS) -> None:
        from pyproj import Transformer

        self._proj = Transformer.from_crs("EPSG:4326", crs, always_xy=True)
        unit = float(crs.axis_info[0].unit_conversion_factor)
        #: Full turn (infinite for lengths) and rounding, in the CRS's unit.
        self._turn = 2.0 * math.pi / unit if crs.is_geographic else math.inf
        self._noise = NOISE_M / (unit * (WGS84.b_m if crs.is_geographic else 1.0))
        formal = ("pipeline", "unitconvert", "axisswap", "noop")
        steps = [step for step in re.findall(r"\bproj=(\w+)", self._proj.definition) if step not in formal]
        #: Whether PROJ's inverse is within `NOISE_M`, as for each of these projections without further steps.
        self._is_exact = len(steps) == 1 and steps[0] in ("utm", "tmerc", "lcc", "merc", "sterea")

    def forward(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Coordinates, easting first, of positions in degrees (any shape); infinite beyond the projection."""
        x, y = through_proj(self._proj.transform, lon_deg, lat_deg)
        return x, y

    def inverse(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Latitude and longitude (in [-180, 180]) in degrees of coordinates, easting first (any shape).

        Fixed-point iteration from PROJ's inverse: subtracts the error of `forward` until it is rounding or stops
        decreasing. Each step leaves about 1e-5 of the error.
        """
        lat, lon = self._back(x, y)
        if self._is_exact:
            return lat, lon
        shape, (x, y) = lat.shape, (part.ravel() for part in np.broadcast_arrays(x, y))
        found, tried = np.stack([lat.ravel(), lon.ravel()]), np.stack([lat.ravel(), lon.ravel()])
        asked_x, asked_y, least = x.astype(np.float64), y.astype(np.float64), np.full(x.size, np.inf)
        index = np.flatnonzero(np.isfinite(found).all(axis=0))
        for _ in range(8):
            if not len(index):
                break
            with np.errstate(invalid="ignore"):
                reached_x, reached_y = self.forward(*tried[:, index])
                off_x, off_y = reached_x - x[index], reached_y - y[index]
                if np.isfinite(self._turn):
                    off_x -= self._turn * np.rint(off_x / self._turn)
                off = np.hypot(off_x, off_y)
                nearer = off < least[index]
            at = index[nearer]
            found[:, at], least[at] = tried[:, at], off[nearer]
            more = nearer & (off > self._noise)
            index = index[more]
            asked_x[index] -= off_x[more]
            asked_y[index] -= off_y[more]
            tried[:, index] = self._back(asked_x[index], asked_y[index])
        lat, lon = found.reshape(2, *shape)
        return lat, lon

    def _back(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Latitude and longitude by PROJ's inverse."""
        lon, lat = through_proj(self._proj.transform, x, y, direction="INVERSE")
        return lat, lon


class _Transformations(threading.local):
    """Cache of transformations, one per thread: they are costly to create and not thread-safe."""

    def __init__(self) -> None:
        self.get = lru_cache(maxsize=8)(lambda crs: Transformation(read_reference(crs)))


_TRANSFORMATIONS = _Transformations()


def transformation(crs: str) -> Transformation:
    """Transformation to a CRS by code, WKT or PROJ string, for the current thread; see `read_reference`."""
    return _TRANSFORMATIONS.get(crs)


def geodesics(
    lat_deg: Floats | float, lon_deg: Floats | float, to_lat_deg: Floats | float, to_lon_deg: Floats | float
) -> tuple[Floats, Floats, Floats]:
    """Forward azimuths at both ends, in degrees, and lengths in metres of geodesics of WGS 84 (any shape)."""
    start, back, length_m = through_proj(_geod().inv, lon_deg, lat_deg, to_lon_deg, to_lat_deg)
    return start, back + 180.0, length_m


def geodesic_ends(
    lat_deg: Floats, lon_deg: Floats, azimuth_deg: Floats, length_m: Floats
) -> tuple[Floats, Floats, Floats]:
    """Latitudes, longitudes and azimuths at the ends of geodesics of WGS 84 (any shape); see `geodesics`."""
    lon, lat, back = through_proj(_geod().fwd, lon_deg, lat_deg, azimuth_deg, length_m)
    return lat, lon, back + 180.0


def _geod() -> Geod:
    from pyproj import Geod

    return Geod(a=WGS84.a_m, b=WGS84.b_m)
