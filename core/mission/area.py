"""Where a mission goes: a box, a polygon, or points."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Union

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput
from ..geodesy.ellipsoid import WGS84
from ..geodesy.mercator import wrap_lon_deg

Floats = NDArray[np.float64]
Position = tuple[float, float]

#: Greatest height above ground, metres: up to there double precision holds the ground to less than a micrometre.
HIGHEST_AGL_M = 1e9


def check_lat_lon(lat_deg: float, lon_deg: float) -> None:
    """Refuse a latitude beyond ±90 or a longitude beyond ±360 degrees (or not a number)."""
    if not -90.0 <= lat_deg <= 90.0:
        raise InvalidInput(f"latitude {lat_deg}: must be within -90 and 90 degrees")
    if not -360.0 <= lon_deg <= 360.0:
        raise InvalidInput(f"longitude {lon_deg}: must be within -360 and 360 degrees")


def check_agl(agl_m: float) -> None:
    """Refuse a height that is not a positive number of metres, or beyond `HIGHEST_AGL_M`."""
    if not agl_m > 0.0:
        raise InvalidInput(f"height above ground {agl_m} m: must be above 0")
    if agl_m > HIGHEST_AGL_M:
        raise InvalidInput(f"height above ground {agl_m:g} m: must be at most {HIGHEST_AGL_M:g} m")


def check_yaw(yaw_deg: float) -> None:
    """Refuse a yaw beyond ±360 degrees (or not a number)."""
    if not -360.0 <= yaw_deg <= 360.0:
        raise InvalidInput(f"yaw {yaw_deg} deg: must be from -360 to 360")


@dataclass(frozen=True)
class Box:
    """A latitude-longitude box, in degrees; one whose west exceeds its east crosses the antimeridian."""

    north_deg: float
    west_deg: float
    south_deg: float
    east_deg: float

    def __post_init__(self) -> None:
        check_lat_lon(self.north_deg, self.west_deg)
        check_lat_lon(self.south_deg, self.east_deg)
        if self.south_deg > self.north_deg:
            raise InvalidInput(
                f"box from latitude {self.north_deg} down to {self.south_deg}: south lies above north; "
                "give the top-left corner first"
            )

    @property
    def span_deg(self) -> float:
        """Longitudes from west to east, in [0, 360] degrees."""
        span = self.east_deg - self.west_deg
        return min(span, 360.0) if span >= 0.0 else span % 360.0

    @property
    def continuous_east_deg(self) -> float:
        """East edge, never less than west."""
        return self.west_deg + self.span_deg

    @property
    def bounds(self) -> Box:
        """The box itself."""
        return self

    def area_m2(self) -> float:
        """Square metres of ellipsoid inside."""
        return self.span_deg * float(
            WGS84.zone_area_m2_per_deg(np.asarray(self.south_deg), np.asarray(self.north_deg))
        )


@dataclass(frozen=True)
class Polygon:
    """A polygon with holes; edges are straight in longitude and latitude (RFC 7946).

    Parameters
    ----------
    rings : tuple of rings, each a tuple of (longitude, latitude) in degrees
        The outer ring first, then holes; closed or not. Longitudes run on across the antimeridian (179,
        181) instead of jumping; a jump of more than 180 degrees is read as such a crossing.
    """

    rings: tuple[tuple[Position, ...], ...]

    def __post_init__(self) -> None:
        if not self.rings:
            raise InvalidInput("polygon without a ring: needs at least one of three corners")
        outer, *holes = (_tidy_ring(ring) for ring in self.rings)
        west = min(lon for lon, _ in outer)
        outer = _turned(outer, -math.floor((west + 180.0) / 360.0))
        middle = sum(lon for lon, _ in outer) / len(outer)
        near = (_turned(hole, round((middle - hole[0][0]) / 360.0)) for hole in holes)
        object.__setattr__(self, "rings", (outer, *near))

    def arrays(self) -> list[tuple[Floats, Floats]]:
        """Longitudes and latitudes of each ring; continuous, the westernmost in [-180, 180)."""
        return [(np.array([p[0] for p in ring]), np.array([p[1] for p in ring])) for ring in self.rings]

    @property
    def bounds(self) -> Box:
        """The smallest box around the outer ring."""
        lon, lat = self.arrays()[0]
        east = float(lon.max())
        return Box(
            float(lat.max()), float(lon.min()), float(lat.min()), east - 360.0 if east > 180.0 else east
        )

    def area_m2(self) -> float:
        """Square metres of ellipsoid inside the outer ring and outside the holes."""
        outer, *holes = (WGS84.ring_area_m2(lon, lat) for lon, lat in self.arrays())
        return outer - sum(holes)


def _tidy_ring(ring: tuple[Position, ...]) -> tuple[Position, ...]:
    """Ring without its closing corner, longitudes made continuous."""
    corners = [(float(lon), float(lat)) for lon, lat in ring]
    # As often as it is there: what is written and read again is the same ring.
    while len(corners) > 1 and corners[0] == corners[-1]:
        corners.pop()
    if len(corners) < 3:
        raise InvalidInput(f"polygon ring of {len(corners)} corners: needs at least 3")
    for lon, lat in corners:
        check_lat_lon(lat, lon)
    tidy = [corners[0]]
    for lon, lat in corners[1:]:
        turns = round((lon - tidy[-1][0]) / 360.0)
        tidy.append((lon - 360.0 * turns, lat))
    return tuple(tidy)


@dataclass(frozen=True)
class Points:
    """Single captures, each with its own height.

    Parameters
    ----------
    poses : tuple of (latitude, longitude, height above ground), degrees and metres
    yaws_deg : tuple of float
        Yaw of each, -360..360; empty where all have the mission's own.
    """

    poses: tuple[tuple[float, float, float], ...]
    yaws_deg: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not self.poses:
            raise InvalidInput("list of points is empty: needs at least one latitude, longitude and height")
        for lat, lon, agl in self.poses if not _sound(self.poses) else ():
            check_lat_lon(lat, lon)
            check_agl(agl)
        if self.yaws_deg and len(self.yaws_deg) != len(self.poses):
            raise InvalidInput(
                f"{len(self.yaws_deg)} yaws of {len(self.poses)} points: give one for each, or none"
            )
        for yaw in self.yaws_deg:
            check_yaw(yaw)

    @property
    def bounds(self) -> Box:
        """The smallest box around the points: across the antimeridian where that is the shorter way."""
        lat, lon, _ = np.array(self.poses, np.float64).reshape(-1, 3).T
        lon = np.unique(np.where(np.abs(lon) <= 180.0, lon, wrap_lon_deg(lon)))
        # It ends where the widest gap between neighbours begins; the first is the one across the antimeridian.
        gaps = np.diff(lon, prepend=lon[-1] - 360.0)
        first = int(np.argmax(gaps))
        return Box(float(lat.max()), float(lon[first]), float(lat.min()), float(lon[first - 1]))


def _sound(poses: tuple[tuple[float, float, float], ...]) -> bool:
    """Whether poses are surely right, looked at all at once; where not, each is looked at by itself."""
    values = np.array(poses) if len({len(pose) for pose in poses}) == 1 else np.empty(0)
    if values.dtype.kind not in "fiu" or values.shape[1:] != (3,):
        return False
    lat, lon, agl = values.T
    sound = (np.abs(lat) <= 90.0) & (np.abs(lon) <= 360.0) & (agl > 0.0) & (agl <= HIGHEST_AGL_M)
    return bool(sound.all())


def _turned(ring: tuple[Position, ...], turns: int) -> tuple[Position, ...]:
    return tuple((lon + 360.0 * turns, lat) for lon, lat in ring) if turns else ring


Area = Union[Box, Polygon, Points]
