"""A plane about a place of the ellipsoid, its axes turned: conformal, in metres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pyproj import Proj

from .proj_arrays import projection, through_proj

Floats = NDArray[np.float64]

#: Noise of positions in degrees and of the projection, metres: seen are 4 nm.
NOISE_M = 5e-8
#: Half a step of latitude from which the direction of north is worked out, degrees: 11 m of ground, so that the noise
#: of positions turns it by 4e-10 rad.
_STEP_DEG = 1e-4


@dataclass(frozen=True)
class LocalPlane:
    """Oblique stereographic plane (EPSG method 9809) with true scale in its middle.

    It enlarges by 1 + (r / 2R)² at the distance r from there: 0.02 px of 640 at 100 km.

    Parameters
    ----------
    lat_deg, lon_deg : float
        Its middle, on WGS84.
    angle_deg : float
        By which its axes are turned clockwise from east and north.
    """

    lat_deg: float
    lon_deg: float
    angle_deg: float = 0.0

    def forward(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Positions in metres along the axes, of positions in degrees (any shape)."""
        east, north = through_proj(_projection(self.lat_deg), lon_deg - self.lon_deg, lat_deg)
        sine, cosine = self._turn()
        return east * cosine - north * sine, east * sine + north * cosine

    def inverse(self, x_m: Floats, y_m: Floats) -> tuple[Floats, Floats]:
        """Latitude and longitude in degrees of positions (any shape); longitudes are continuous with the middle's."""
        sine, cosine = self._turn()
        east, north = x_m * cosine + y_m * sine, y_m * cosine - x_m * sine
        dlon, lat = through_proj(_projection(self.lat_deg), east, north, inverse=True)
        return lat, self.lon_deg + dlon

    def north_deg(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Direction of true north at positions (any shape), degrees clockwise from the plane's second axis."""
        ends = (self.forward(lat_deg + step, lon_deg) for step in (-_STEP_DEG, _STEP_DEG))
        (x0, y0), (x1, y1) = ends
        bearing: Floats = np.degrees(np.arctan2(x1 - x0, y1 - y0))
        return bearing

    def _turn(self) -> tuple[float, float]:
        angle = np.radians(self.angle_deg)
        return float(np.sin(angle)), float(np.cos(angle))


def _projection(lat_deg: float) -> Proj:
    """Longitudes count from its middle."""
    return projection(proj="sterea", lat_0=lat_deg, lon_0=0.0, ellps="WGS84")
