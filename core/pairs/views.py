"""Drone views of a place: rings or a spiral around it, with the optical axis through the place."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput
from ..geodesy.camera import Camera, Poses
from ..geodesy.ellipsoid import WGS84, Ellipsoid, trace
from ..geodesy.footprint import ground_corners
from ..limits import MAX_PAIR_VIEWS
from ..mission.areas.area import check_agl, check_yaw
from .places import cartesian_m

#: University-1652's flight (Zheng, Wei, Yang 2020, section 3): three rounds from 256 m down to 121.5 m, 54 views.
HEIGHTS_M, ROUNDS, VIEWS = (256.0, 121.5), 3, 54
DEFAULT_TILT_DEG = 45.0
#: At a tilt of 80 degrees, the camera is 5.7 heights away; beyond, a place is a strip below the horizon.
MOST_TILT_DEG = 80.0


@dataclass(frozen=True)
class PairView:
    """One view of every place.

    Parameters
    ----------
    agl_m : float
        Height of the camera above the ground, > 0.
    yaw_deg : float
        Direction of view, clockwise from north; at 0 the camera is south of the place.
    tilt_deg : float
        Angle from straight down, 0..80.
    """

    agl_m: float
    yaw_deg: float
    tilt_deg: float

    def __post_init__(self) -> None:
        check_agl(self.agl_m)
        check_yaw(self.yaw_deg)
        if not 0.0 <= self.tilt_deg <= MOST_TILT_DEG:
            raise InvalidInput("tilt {0} deg: must be from 0 (straight down) to {1:g}", self.tilt_deg, MOST_TILT_DEG)


def rings(heights_m: Sequence[float], yaws: int, tilts_deg: Sequence[float]) -> tuple[PairView, ...]:
    """Views in rings around a place: for each tilt and height, ``yaws`` views evenly around.

    Raises
    ------
    InvalidInput
    """
    _check(heights_m, tilts_deg)
    if not 1 <= yaws <= MAX_PAIR_VIEWS:
        raise InvalidInput("{0} yaws: must be from 1 to {1:,}", yaws, MAX_PAIR_VIEWS)
    return tuple(
        PairView(float(height), 360.0 * at / yaws, float(tilt))
        for tilt in tilts_deg
        for height in heights_m
        for at in range(yaws)
    )


def spiral(
    heights_m: Sequence[float] = HEIGHTS_M,
    count: int = VIEWS,
    rounds: float = ROUNDS,
    tilts_deg: Sequence[float] = (DEFAULT_TILT_DEG,),
) -> tuple[PairView, ...]:
    """Views along a spiral from the greatest height down to the least, a spiral for each tilt.

    Parameters
    ----------
    count : int
        Views of a spiral, evenly along it.
    rounds : float
        Turns around the place, > 0.

    Raises
    ------
    InvalidInput
    """
    _check(heights_m, tilts_deg)
    if not 1 <= count <= MAX_PAIR_VIEWS:
        raise InvalidInput("{0} views: must be from 1 to {1:,}", count, MAX_PAIR_VIEWS)
    if not (math.isfinite(rounds) and 0.0 < rounds <= count):
        raise InvalidInput("{0:g} rounds of {1} views: must be above 0, and no more than the views", rounds, count)
    top, bottom = float(max(heights_m)), float(min(heights_m))
    fall = (top - bottom) / max(count - 1, 1)
    return tuple(
        PairView(round(top - fall * at, 6), round(360.0 * rounds * at / count % 360.0, 9), float(tilt))
        for tilt in tilts_deg
        for at in range(count)
    )


def _check(heights_m: Sequence[float], tilts_deg: Sequence[float]) -> None:
    for values, what in ((heights_m, "height"), (tilts_deg, "tilt")):
        if not values:
            raise InvalidInput("no {0}: give one or more", what)
        if len(set(values)) != len(values):
            raise InvalidInput("{0}s {1}: each may be named once", what, " ".join(f"{value:g}" for value in values))
    for height in heights_m:
        check_agl(height)


def standing_poses(lat_deg: Floats, lon_deg: Floats, view: PairView, ground: Ellipsoid = WGS84) -> Poses:
    """Poses from which the optical axis meets the ground at places.

    Found iteratively: the axis is traced to the ground, and the camera is moved by the distance by which the axis
    misses the place.

    Parameters
    ----------
    lat_deg, lon_deg : array (n,)
        Places.
    ground : Ellipsoid
        Level ground that heights refer to.

    Raises
    ------
    InvalidInput
        The axis misses the Earth.
    """
    agl = np.full(lat_deg.shape, view.agl_m)
    axis = Camera().rays_enu(((0.0, 0.0),), view.yaw_deg, view.tilt_deg)[0]
    lat, lon = lat_deg.copy(), lon_deg.copy()
    # Each pass divides the error by the Earth's radius over the stand-off: few are needed if the iteration converges.
    for _ in range(40):
        seen = trace(lat, agl, np.broadcast_to(axis, (*lat.shape, 3)), ground)
        if not seen.hit.all():
            break
        miss_lat, miss_lon = lat_deg - seen.lat_deg, lon_deg - (lon + seen.dlon_deg)
        lat, lon = np.clip(lat + miss_lat, -90.0, 90.0), lon + miss_lon
        # 1e-12 degrees are 0.1 micrometres. Rounding to 10 micrometres, far below a pixel, removes noise.
        if max(np.abs(miss_lat).max(), np.abs(miss_lon).max()) <= 1e-12:
            return Poses.from_attitude(np.round(lat, 10), np.round(lon, 10), agl, view.yaw_deg, view.tilt_deg, 0.0)
    raise InvalidInput(
        "view from {0:g} m at a tilt of {1:g} deg: the camera cannot look at the place",
        view.agl_m,
        view.tilt_deg,
        remedy="fly lower or tilt less",
    )


def reach_m(lat_deg: Floats, views: Sequence[PairView], camera: Camera, ground: Ellipsoid = WGS84) -> Floats:
    """Greatest distance (n,) in metres between a place at each latitude and the ground in any of its views.

    Distances are straight lines in space, as all distances between places. Infinite if a view sees the horizon.
    """
    lon = np.zeros_like(lat_deg)
    middle = cartesian_m(lat_deg, lon)[:, np.newaxis]
    farthest = np.zeros(lat_deg.shape)
    for view in views:
        seen = ground_corners(camera, standing_poses(lat_deg, lon, view, ground), ground)
        distance = np.sqrt(np.sum((cartesian_m(seen.lat_deg, seen.lon_deg) - middle) ** 2, axis=-1))
        # The sides of a footprint bulge beyond the lines between its corners by less than a thousandth.
        farthest = np.maximum(farthest, np.where(seen.hit, distance * 1.001, np.inf).max(axis=-1))
    return farthest
