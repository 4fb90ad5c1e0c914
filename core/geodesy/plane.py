"""A plane about a place of the ellipsoid, its axes turned: conformal, in metres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pyproj import Proj

from .angles import sin_cos
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
        project, middle_m = _projection(self.lat_deg)
        east, north = through_proj(project, lon_deg - self.lon_deg, lat_deg)
        north = north - middle_m
        sine, cosine = self._turn()
        return east * cosine - north * sine, east * sine + north * cosine

    def inverse(self, x_m: Floats, y_m: Floats) -> tuple[Floats, Floats]:
        """Latitude and longitude in degrees of positions (any shape); longitudes are continuous with the middle's."""
        sine, cosine = self._turn()
        east, north = x_m * cosine + y_m * sine, y_m * cosine - x_m * sine
        project, middle_m = _projection(self.lat_deg)
        dlon, lat = through_proj(project, east, north + middle_m, inverse=True)
        return lat, self.lon_deg + dlon

    def north_deg(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Direction of true north at positions (any shape), degrees clockwise from the plane's second axis."""
        ends = (self.forward(lat_deg + step, lon_deg) for step in (-_STEP_DEG, _STEP_DEG))
        (x0, y0), (x1, y1) = ends
        bearing: Floats = np.degrees(np.arctan2(x1 - x0, y1 - y0))
        return bearing

    def _turn(self) -> tuple[float, float]:
        sine, cosine = sin_cos(self.angle_deg)
        return float(sine), float(cosine)


def _projection(lat_deg: float) -> tuple[Proj, float]:
    """Projection of a middle, and how far north of the projection's origin that is, metres.

    PROJ takes an origin within 5e-9 degrees of the equator for one on it. Longitudes count from the middle.
    """
    project = projection(proj="sterea", lat_0=lat_deg, lon_0=0.0, ellps="WGS84")
    return project, float(project(0.0, lat_deg)[1])
