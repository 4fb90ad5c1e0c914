"""Local frames: metres east, north and up from an origin (EPSG methods 9837 and 9602), through PROJ."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Floats
from .ellipsoid import WGS84, Ellipsoid, sin_cos
from .projections import through_proj

if TYPE_CHECKING:
    from pyproj import Transformer


@dataclass(frozen=True)
class LocalFrame:
    """Metres east, north and up from an origin on WGS 84.

    Parameters
    ----------
    lat_deg, lon_deg, height_m : float
        Origin, and its height above the ellipsoid.
    """

    lat_deg: float
    lon_deg: float
    height_m: float = 0.0

    @cached_property
    def _transformer(self) -> Transformer:
        from pyproj import Transformer

        origin = f"+lat_0={self.lat_deg!r} +lon_0={self.lon_deg!r} +h_0={self.height_m!r}"
        return Transformer.from_pipeline(
            "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad +step +proj=cart +ellps=WGS84 "
            f"+step +proj=topocentric +ellps=WGS84 {origin}"
        )

    def enu(self, lat_deg: Floats, lon_deg: Floats, height_m: Floats) -> Floats:
        """Coordinates (..., 3) in metres of positions in degrees and heights above the ellipsoid."""
        return np.stack(through_proj(self._transformer.transform, lon_deg, lat_deg, height_m), axis=-1)

    def geodetic(self, enu_m: Floats) -> tuple[Floats, Floats, Floats]:
        """Latitude, longitude in degrees and height above the ellipsoid of coordinates (..., 3)."""
        lon, lat, height = through_proj(self._transformer.transform, *np.moveaxis(enu_m, -1, 0), direction="INVERSE")
        return lat, lon, height

    def rotations(self, lat_deg: Floats | float, lon_deg: Floats | float) -> Floats:
        """Rotation matrices (..., 3, 3) that take vectors of this frame to the frames at other positions."""
        turn: Floats = enu_axes(lat_deg, lon_deg) @ enu_axes(self.lat_deg, self.lon_deg).T
        return turn


def geocentric(
    lat_deg: Floats | float,
    lon_deg: Floats | float,
    height_m: Floats | float = 0.0,
    ground: Ellipsoid = WGS84,
) -> Floats:
    """Geocentric coordinates (..., 3) in metres of positions and heights above an ellipsoid; all broadcast."""
    (sin_lat, cos_lat), (sin_lon, cos_lon) = sin_cos(lat_deg), sin_cos(lon_deg)
    normal = ground.a_m / np.sqrt(1.0 - ground.e2 * sin_lat * sin_lat)
    level = (normal + height_m) * cos_lat
    up = (normal * (1.0 - ground.e2) + height_m) * sin_lat
    return np.stack(np.broadcast_arrays(level * cos_lon, level * sin_lon, up), axis=-1)


@cache
def _cart() -> Transformer:
    from pyproj import Transformer

    return Transformer.from_pipeline(
        "+proj=pipeline +step +proj=cart +ellps=WGS84 +inv +step +proj=unitconvert +xy_in=rad +xy_out=deg"
    )


def geodetic(points_m: Floats) -> tuple[Floats, Floats, Floats]:
    """Latitudes, longitudes in degrees and heights above WGS 84 of geocentric coordinates (..., 3), through PROJ.

    Within 1e-6 m up to heights of 9 km.
    """
    lon, lat, height = through_proj(_cart().transform, *np.moveaxis(points_m, -1, 0))
    return lat, lon, height


def enu_axes(lat_deg: Floats | float, lon_deg: Floats | float) -> Floats:
    """Unit vectors east, north and up at positions, in geocentric axes, as rows (..., 3, 3)."""
    (sin_lat, cos_lat), (sin_lon, cos_lon) = sin_cos(lat_deg), sin_cos(lon_deg)
    rows = [
        [-sin_lon, cos_lon, np.zeros_like(sin_lon)],
        [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
        [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
