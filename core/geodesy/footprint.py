"""Where points of a camera's image meet the ground."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .camera import CORNERS, Camera
from .ellipsoid import WGS84, Ellipsoid, limb, trace
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


#: A way to work out where image points see the ground.
Footprint = Callable[[Camera, Poses, ImagePoints, Ellipsoid], Corners]


def ground_corners(
    camera: Camera, poses: Poses, ground: Ellipsoid = WGS84, footprint: Footprint = exact
) -> Corners:
    """Ground corners of each pose's image, worked out once for each run of poses that share them.

    ``footprint`` is only another than `exact` where that is compared with others.
    """
    first, run = poses.runs()
    at_zero = poses.take(first)._replace(lon_deg=np.zeros(len(first)))
    corners = footprint(camera, at_zero, CORNERS, ground)
    return Corners(
        corners.lat_deg[run], poses.lon_deg[:, np.newaxis] + corners.lon_deg[run], corners.hit[run]
    )
