"""Footprints cheaper than the exact footprint, for comparison: flat ground mapped onto the ellipsoid.

For nadir cameras, within the domain of `accuracy.outside_flat_domain`.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Floats
from ..geodesy.accuracy import ImageGeometry, bound_px, flat_bending_px, outside_flat_domain
from ..geodesy.camera import Camera, Poses
from ..geodesy.ellipsoid import WGS84, Ellipsoid
from ..geodesy.footprint import Corners, Footprint, ImagePoints, exact
from ..mission.methods import Method, exact_footprint


def _flat_offsets(camera: Camera, poses: Poses, points: ImagePoints) -> tuple[Floats, Floats]:
    """Offsets east and north (n, k) at which nadir cameras see flat ground, metres."""
    rays = camera.rays_enu(points, poses.yaw_deg)
    agl = poses.agl_m[:, np.newaxis]
    return rays[..., 0] * agl, rays[..., 1] * agl


def loc1(camera: Camera, poses: Poses, points: ImagePoints, ground: Ellipsoid = WGS84) -> Corners:
    """Flat ground, mapped by the radii of curvature at the camera; for nadir cameras."""
    east_m, north_m = _flat_offsets(camera, poses, points)
    lat = poses.lat_deg[:, np.newaxis]
    normal, meridional = ground.normal_radius_m(lat), ground.meridional_radius_m(lat)
    return _around(poses, north_m / meridional, east_m / (normal * np.cos(np.radians(lat))))


def loc2(camera: Camera, poses: Poses, points: ImagePoints, ground: Ellipsoid = WGS84) -> Corners:
    """Flat ground, mapped onto the ellipsoid to second order; for nadir cameras.

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


def loc1_px(scene: ImageGeometry) -> Floats:
    """Bounds (n,) of `loc1`: those of `loc2` plus ρκ(T + e²)."""
    first = scene.half_diagonal_px * scene.size_share * (scene.lat_tangent + scene.ground.e2)
    return bound_px(scene, first + _second_order_px(scene))


def loc2_px(scene: ImageGeometry) -> Floats:
    """Bounds (n,) of `loc2`: ρ[εt²/2 + κ²(½ + T²)]."""
    return bound_px(scene, _second_order_px(scene))


def _second_order_px(scene: ImageGeometry) -> Floats:
    laid_out = scene.size_share**2 * (0.5 + scene.lat_tangent**2)
    return flat_bending_px(scene) + scene.half_diagonal_px * laid_out


#: Methods of footprints by name, from cheap to exact.
FOOTPRINTS: dict[str, Footprint] = {"loc1": loc1, "loc2": loc2, "exact": exact}


def footprint_methods(scene: ImageGeometry) -> list[Method]:
    """Methods of the footprint in a scene, from cheap to exact."""
    outside = outside_flat_domain(scene)
    # A pixel spans most ground at the corners, where the slant of rays enlarges it by 1 + t².
    slant = 1.0 + scene.diagonal_tangent**2
    methods = []
    for name, bound in (("loc1", loc1_px), ("loc2", loc2_px)):
        if outside:
            methods.append(Method("footprint", name, math.inf, math.inf, outside))
            continue
        px = bound(scene)
        metres = float(np.max(px * scene.nadir_px_m)) * slant
        methods.append(Method("footprint", name, float(np.max(px)), metres))
    return [*methods, exact_footprint(scene)]
