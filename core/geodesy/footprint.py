"""Where the corners of a camera's image meet the ground: the rungs from flat ground to the exact camera."""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput
from .camera import CORNERS, Camera
from .ellipsoid import WGS84, Ellipsoid, limb, sight_lines, trace
from .poses import Poses

Floats = NDArray[np.float64]
#: Image points as `CORNERS` has them.
ImagePoints = tuple[tuple[float, float], ...]
#: Length of a direction's horizontal part, as a share of the whole, below which its azimuth is only noise.
_VERTICAL = 1e-15


class Corners(NamedTuple):
    """Ground corners that a camera sees, in the order of `CORNERS`; arrays (n, 4), degrees.

    Longitudes are continuous with the camera's. Where ``hit`` is False the corner looks past the Earth, and the
    point is the one of the horizon below it.
    """

    lat_deg: Floats
    lon_deg: Floats
    hit: NDArray[np.bool_]


def exact(camera: Camera, poses: Poses, points: ImagePoints, ground: Ellipsoid = WGS84) -> Corners:
    """Ground seen at image points by the exact camera, (n, k); of the horizon where a ray misses the Earth."""
    lat, agl = poses.lat_deg[:, np.newaxis], poses.agl_m[:, np.newaxis]
    rays = camera.rays_enu(points, *poses.attitude)
    seen = trace(lat, agl, rays, ground)
    if not seen.hit.all():
        missed = ~seen.hit
        towards = rays[missed]
        vertical = np.hypot(towards[:, 0], towards[:, 1]) <= _VERTICAL * np.abs(towards[:, 2])
        towards[vertical] = (0.0, 1.0, 0.0)
        at = np.nonzero(missed)[0]
        edge = limb(poses.lat_deg[at], poses.agl_m[at], towards, ground)
        seen.lat_deg[missed], seen.dlon_deg[missed] = edge.lat_deg, edge.dlon_deg
    return Corners(seen.lat_deg, poses.lon_deg[:, np.newaxis] + seen.dlon_deg, seen.hit)


def _flat_offsets(camera: Camera, poses: Poses, points: ImagePoints) -> tuple[Floats, Floats]:
    """Metres east and north of level cameras at which flat ground is seen, (n, k) each."""
    rays = camera.rays_enu(points, poses.yaw_deg)
    agl = poses.agl_m[:, np.newaxis]
    return rays[..., 0] * agl, rays[..., 1] * agl


def loc1(camera: Camera, poses: Poses, points: ImagePoints, ground: Ellipsoid = WGS84) -> Corners:
    """Flat ground laid along the radii of curvature at the camera; for cameras that look straight down."""
    east_m, north_m = _flat_offsets(camera, poses, points)
    lat = poses.lat_deg[:, np.newaxis]
    normal, meridional = ground.normal_radius_m(lat), ground.meridional_radius_m(lat)
    return _around(poses, north_m / meridional, east_m / (normal * np.cos(np.radians(lat))))


def loc2(camera: Camera, poses: Poses, points: ImagePoints, ground: Ellipsoid = WGS84) -> Corners:
    """Flat ground laid on the ellipsoid to the second order of its size; for cameras that look straight down.

    The geodesic series about the camera: latitude y/M - x²T/(2MN) - 3ηy²/(2M²), longitude x/(N cos φ)·(1 + yT/N)
    with η = e² sin φ cos φ / (1 - e² sin² φ).
    """
    x, y = _flat_offsets(camera, poses, points)
    lat = poses.lat_deg[:, np.newaxis]
    sin, cos = np.sin(np.radians(lat)), np.cos(np.radians(lat))
    normal, meridional = ground.normal_radius_m(lat), ground.meridional_radius_m(lat)
    tangent = sin / cos
    eta = ground.e2 * sin * cos / (1.0 - ground.e2 * sin * sin)
    dlat = y / meridional - x * x * tangent / (2.0 * meridional * normal) - 1.5 * eta * (y / meridional) ** 2
    return _around(poses, dlat, x / (normal * cos) * (1.0 + y * tangent / normal))


def _around(poses: Poses, dlat: Floats, dlon: Floats) -> Corners:
    lat = poses.lat_deg[:, np.newaxis] + np.degrees(dlat)
    return Corners(lat, poses.lon_deg[:, np.newaxis] + np.degrees(dlon), np.ones(lat.shape, bool))


#: The rungs of the stage, from cheap to exact.
FOOTPRINT_RUNGS: dict[str, Callable[[Camera, Poses, ImagePoints, Ellipsoid], Corners]] = {
    "loc1": loc1,
    "loc2": loc2,
    "exact": exact,
}


def ground_corners(camera: Camera, poses: Poses, ground: Ellipsoid = WGS84, rung: str = "exact") -> Corners:
    """Ground corners of each pose's image, worked out once for each run of poses that share them.

    Parameters
    ----------
    rung : str
        loc1, loc2 or exact; the first two only within the domain that `accuracy` gives them.

    Raises
    ------
    InvalidInput
        An unknown rung.
    """
    if rung not in FOOTPRINT_RUNGS:
        raise InvalidInput(f"footprint rung {rung!r}: must be one of {', '.join(FOOTPRINT_RUNGS)}")
    first, run = poses.runs()
    at_zero = poses.take(first)._replace(lon_deg=np.zeros(len(first)))
    corners = FOOTPRINT_RUNGS[rung](camera, at_zero, CORNERS, ground)
    return Corners(
        corners.lat_deg[run], poses.lon_deg[:, np.newaxis] + corners.lon_deg[run], corners.hit[run]
    )


def image_points(
    camera: Camera, poses: Poses, lat_deg: Floats, lon_deg: Floats, ground: Ellipsoid = WGS84
) -> Floats:
    """Image points, (n, k, 2), at which exact cameras see ground points (n, k); the inverse of `exact`.

    Points behind a camera give NaN; whether the Earth hides a point is not asked.
    """
    vectors = sight_lines(
        poses.lat_deg[:, np.newaxis],
        poses.agl_m[:, np.newaxis],
        lat_deg,
        lon_deg - poses.lon_deg[:, np.newaxis],
        ground,
    )
    points, in_front = camera.image_xy(vectors, *poses.attitude)
    return np.where(in_front[..., np.newaxis], points, np.nan)
