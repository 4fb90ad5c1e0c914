"""Universal Transverse Mercator: zones, and positions in metres of a zone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pyproj import Proj

from .proj_arrays import projection, through_proj

Floats = NDArray[np.float64]


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
        x, y = through_proj(_projection(self), lon_deg, lat_deg)
        return np.asarray(x, np.float64), np.asarray(y, np.float64)

    def inverse(self, x_m: Floats, y_m: Floats) -> tuple[Floats, Floats]:
        """Longitude (wrapped) and latitude in degrees of eastings and northings in metres (any shape)."""
        lon, lat = through_proj(_projection(self), x_m, y_m, inverse=True)
        return np.asarray(lon, np.float64), np.asarray(lat, np.float64)


def _projection(zone: UTMZone) -> Proj:
    return projection(proj="utm", zone=zone.number, south=zone.south, ellps="WGS84")


def utm_zone(lat_deg: float, lon_deg: float) -> UTMZone:
    """Zone of a position in degrees, with the exceptions of Norway and Svalbard (EPSG guidance note 7-2).

    North of 84° and south of 80°, where charts change to the polar UPS, the zone of the longitude goes on:
    its grid still points north, and the projection stays exact.
    """
    lon = (lon_deg + 180.0) % 360.0 - 180.0
    number = min(int((lon + 180.0) // 6.0) + 1, 60)
    if 56.0 <= lat_deg < 64.0 and 3.0 <= lon < 12.0:
        number = 32
    elif 72.0 <= lat_deg < 84.0 and 0.0 <= lon < 42.0:
        number = 31 if lon < 9.0 else 33 if lon < 21.0 else 35 if lon < 33.0 else 37
    return UTMZone(number, lat_deg < 0.0)
