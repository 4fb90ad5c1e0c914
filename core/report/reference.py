"""The exact camera in numpy's long double: what the methods' errors are measured against.

Nothing but the ellipsoid's axes is shared with the camera that is measured. Where long double is longer than float64
(x86 and ARM under Linux) differences of positions in Earth's frame need no care; where it is not (Windows, macOS on
ARM) the same differences are good to some nanometres of ground, which `floor_px` states.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..geodesy.accuracy import Scene
from ..geodesy.camera import Camera

Floats = NDArray[np.float64]
#: Long double arrays: numpy's name for their type depends on the platform.
Long = NDArray[Any]

#: Roundings of a coordinate in Earth's frame that may add up in a difference of two.
_ROUNDINGS = 8.0


def floor_px(scene: Scene) -> float:
    """Error of the reference itself in px: smaller ones cannot be told from none."""
    rounding_m = _ROUNDINGS * float(np.finfo(np.longdouble).eps) * scene.ground.a_m
    # An image coordinate also ends at float64, in which the method's own is given.
    of_image = float(np.finfo(np.float64).eps) * float(np.max(scene.half_diagonal_px))
    return rounding_m / float(np.min(scene.nadir_px_m)) + of_image


def map_errors_px(scene: Scene, du: Floats, v: Floats, x: Floats, y: Floats) -> Floats:
    """As `errors_px` of map positions: world fractions (n, k) from the camera's meridian and from the map's north.

    They become degrees in long double: in float64 that is as wrong as what is measured.
    """
    across, down = (np.asarray(part, np.longdouble) for part in (du, v))
    lat: Long = np.arctan(np.sinh(_radians((0.5 - down) * 360))) / _radians(np.ones_like(down))
    return errors_px(scene, lat, across * 360, x, y)


def errors_px(scene: Scene, lat_deg: Long, dlon_deg: Long, x: Floats, y: Floats) -> Floats:
    """Distances in the image between where ground points are put and where the exact camera sees them.

    Parameters
    ----------
    scene : Scene
        Of n poses.
    lat_deg, dlon_deg : array (n, k)
        Ground points: geodetic latitude, and longitude from the camera's.
    x, y : array (n, k)
        Image points (right, up) at which a method puts them, -1..1.

    Returns
    -------
    array (n, k)
        px; infinite for points behind the camera.
    """
    seen_x, seen_y, in_front = _seen(scene, lat_deg, dlon_deg)
    width, height = (
        np.broadcast_to(np.asarray(size, np.float64), scene.poses.lat_deg.shape)[:, np.newaxis]
        for size in (scene.width_px, scene.height_px)
    )
    across, up = (seen_x - x) * width / 2.0, (seen_y - y) * height / 2.0
    return np.where(in_front, np.hypot(across, up), np.inf).astype(np.float64)


def _seen(scene: Scene, lat_deg: Long, dlon_deg: Long) -> tuple[Long, Long, NDArray[np.bool_]]:
    """Image points of ground points, and whether they are in front of the camera."""
    a, b = np.longdouble(scene.ground.a_m), np.longdouble(scene.ground.b_m)
    e2 = (a - b) * (a + b) / a**2
    sin, cos = _sin_cos(scene.poses.lat_deg[:, np.newaxis])
    normal = a / np.sqrt(1 - e2 * sin**2)
    agl = scene.poses.agl_m[:, np.newaxis].astype(np.longdouble)
    point_sin, point_cos = _sin_cos(lat_deg)
    point_normal = a / np.sqrt(1 - e2 * point_sin**2)
    lon_sin, lon_cos = _sin_cos(dlon_deg)
    outward = point_normal * point_cos * lon_cos - (normal + agl) * cos
    east = point_normal * point_cos * lon_sin
    polar = point_normal * (1 - e2) * point_sin - (normal * (1 - e2) + agl) * sin
    return _image(
        scene.camera, scene.poses.attitude, (east, cos * polar - sin * outward, cos * outward + sin * polar)
    )


def _image(
    camera: Camera, attitude: tuple[Floats, Floats, Floats], enu: tuple[Long, Long, Long]
) -> tuple[Long, Long, NDArray[np.bool_]]:
    """Turn east, north, up by yaw, tilt and roll, and project."""
    (sin_yaw, cos_yaw), (sin_tilt, cos_tilt), (sin_roll, cos_roll) = (
        _sin_cos(angle[:, np.newaxis]) for angle in attitude
    )
    east, north, up = enu
    forward: Long = sin_yaw * east + cos_yaw * north
    right: Long = cos_yaw * east - sin_yaw * north
    down: Long = -up
    forward, down = cos_tilt * forward - sin_tilt * down, sin_tilt * forward + cos_tilt * down
    right, down = cos_roll * right + sin_roll * down, cos_roll * down - sin_roll * right
    in_front = np.asarray(down > 0)
    depth = np.where(in_front, down, 1)
    fov = np.asarray(camera.fov_deg, np.longdouble)
    # Above a right angle through the complement, where the argument of the tangent itself would lose digits.
    half = np.tan(_radians(fov) / 2) if camera.fov_deg <= 90.0 else 1 / np.tan(_radians(180 - fov) / 2)
    tan_y = half / np.hypot(np.longdouble(1), np.longdouble(camera.aspect_ratio))
    tan_x = tan_y * np.longdouble(camera.aspect_ratio)
    return right / depth / tan_x, forward / depth / tan_y, in_front


def _radians(angle_deg: Long) -> Long:
    return np.asarray(angle_deg * (np.arctan(np.longdouble(1)) / 45))


def _sin_cos(angle_deg: Long) -> tuple[Long, Long]:
    angle = _radians(np.asarray(angle_deg, np.longdouble))
    return np.sin(angle), np.cos(angle)
