"""The camera of `reference` in numpy's long double, for millions of scenes at a time.

Nothing is shared with the core, nor with `reference`: the surface is expanded about the ground below the camera, in its
east, north and up, so that neither a camera 1 cm up nor a pole loses digits. All arguments broadcast; memory is about
0.7 kB a scene, so that callers cut their draws into chunks of a million or less.

Long double has a mantissa of 64 bits on x86 outside Windows and 113 on 64-bit ARM Linux. Elsewhere (Windows, macOS on
ARM) it is float64 under another name, which is no reference: tests skip where `EXTENDED` is False.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

Real = np.longdouble
EXTENDED = np.finfo(Real).nmant >= 63
WHY_NOT = "long double is no longer than float64 on this platform"

_DEGREE = 4 * np.arctan(Real(1)) / 180
_FLATTENING = 1 / Real("298.257223563")
_EQUATORIAL_AXIS_M = Real(6378137)


class Seen(NamedTuple):
    """Ground seen; arrays of one shape, NaN where ``hit`` is False."""

    lat_deg: np.ndarray
    dlon_deg: np.ndarray
    hit: np.ndarray


class Looked(NamedTuple):
    """Image points (right, up); arrays of one shape, NaN where ``visible`` is False."""

    x: np.ndarray
    y: np.ndarray
    visible: np.ndarray


def image_ray(fov_deg, aspect_ratio, yaw_deg, tilt_deg, roll_deg, x, y):
    """East, north and up of the direction of image points, 1 along the optical axis."""
    tan_x, tan_y = _half_tangents(fov_deg, aspect_ratio)
    return _body_to_enu(yaw_deg, tilt_deg, roll_deg, _real(y) * tan_y, _real(x) * tan_x, Real(1))


def see(lat_deg, agl_m, fov_deg, aspect_ratio, yaw_deg, tilt_deg, roll_deg, x, y, ground_height_m=0.0):
    """Ground seen at image points: geodetic latitude, longitude from the camera's, and whether there is any."""
    ray = image_ray(fov_deg, aspect_ratio, yaw_deg, tilt_deg, roll_deg, x, y)
    return ground_point(lat_deg, agl_m, ray, ground_height_m)


def ground_point(lat_deg, agl_m, ray_enu, ground_height_m=0.0):
    """Ground that rays (east, north, up) meet, as `see` returns it."""
    place = _Place.at(lat_deg, ground_height_m)
    h = _real(agl_m)
    east, north, up = ray_enu
    polar = place.cos * north + place.sin * up
    # The surface is v·v + e'²(v·ẑ)² + 2N v·n̂ = 0 of the offset v from the ground below the camera; v = h n̂ + t ray.
    square = east * east + north * north + up * up + place.second_e2 * polar * polar
    linear = place.normal_m * up + h * (up + place.second_e2 * place.sin * polar)
    constant = h * (2 * place.normal_m + h * (1 + place.second_e2 * place.sin**2))
    disc = linear * linear - square * constant
    hit = (disc >= 0) & (linear < 0)
    t = constant / np.where(hit, np.sqrt(np.where(hit, disc, 0)) - linear, np.nan)
    east, north, up = t * east, t * north, h + t * up
    # Half the surface's gradient is the outward normal of the point, still in the camera's axes.
    polar = place.second_e2 * (place.cos * north + place.sin * up)
    north, up = north + polar * place.cos, place.normal_m + up + polar * place.sin
    towards = place.cos * up - place.sin * north
    radius = np.hypot(towards, east)
    ahead = towards > 0
    bulge = np.where(ahead, east * (east / np.where(ahead, radius + towards, 1)), radius - towards)
    rise = np.arctan2(north - place.sin * bulge, up + place.cos * bulge)
    lat = _real(lat_deg) + rise / _DEGREE
    return Seen(*np.broadcast_arrays(lat, np.arctan2(east, towards) / _DEGREE, hit))


def look(
    lat_deg,
    agl_m,
    fov_deg,
    aspect_ratio,
    yaw_deg,
    tilt_deg,
    roll_deg,
    point_lat_deg,
    point_dlon_deg,
    ground_height_m=0.0,
):
    """Image points at which ground points are seen, and which are: not behind the camera nor hidden by the Earth."""
    place, point = _Place.at(lat_deg, ground_height_m), _Place.at(point_lat_deg, ground_height_m)
    lat, point_lat = _real(lat_deg), _real(point_lat_deg)
    sin_mid, cos_mid = _sin_cos((lat + point_lat) / 2)
    sin_rise, cos_rise = _sin_cos(point_lat - lat)
    sin_half_rise, _ = _sin_cos((point_lat - lat) / 2)
    sin_dlon, _ = _sin_cos(point_dlon_deg)
    sin_half_dlon, _ = _sin_cos(_real(point_dlon_deg) / 2)
    # Differences of N, of N cos φ and of N sin φ by the addition theorems: nothing of the Earth's size cancels.
    w, point_w = place.a_m / place.normal_m, place.a_m / point.normal_m
    e2 = place.e2
    widening = place.a_m * e2 * 2 * sin_mid * cos_mid * sin_rise / (w * point_w * (w + point_w))
    outward = widening * place.cos - point.normal_m * 2 * sin_mid * sin_half_rise
    outward = outward - 2 * point.normal_m * point.cos * sin_half_dlon**2
    polar = (1 - e2) * (widening * place.sin + point.normal_m * 2 * cos_mid * sin_half_rise)
    east = point.normal_m * point.cos * sin_dlon
    north = place.cos * polar - place.sin * outward
    up = place.cos * outward + place.sin * polar - _real(agl_m)
    bulge = 2 * point.cos * sin_half_dlon**2
    facing = point.cos * sin_dlon * east + (sin_rise + place.sin * bulge) * north + (cos_rise - place.cos * bulge) * up
    forward, right, down = _enu_to_body(yaw_deg, tilt_deg, roll_deg, east, north, up)
    visible = (facing <= 0) & (down > 0)
    depth = np.where(visible, down, np.nan)
    tan_x, tan_y = _half_tangents(fov_deg, aspect_ratio)
    return Looked(*np.broadcast_arrays(right / depth / tan_x, forward / depth / tan_y, visible))


def slant_and_grazing(lat_deg, agl_m, point_lat_deg, point_dlon_deg, ground_height_m=0.0):
    """Metres from cameras to ground points, and the sine of the angle at which their rays meet the ground."""
    place, point = _Place.at(lat_deg, ground_height_m), _Place.at(point_lat_deg, ground_height_m)
    sin_dlon, cos_dlon = _sin_cos(point_dlon_deg)
    outward = point.normal_m * point.cos * cos_dlon - (place.normal_m + agl_m) * place.cos
    east = point.normal_m * point.cos * sin_dlon
    polar = point.normal_m * (1 - point.e2) * point.sin - (place.normal_m * (1 - place.e2) + agl_m) * place.sin
    slant = np.sqrt(outward**2 + east**2 + polar**2)
    down = point.cos * (cos_dlon * outward + sin_dlon * east) + point.sin * polar
    return slant, -down / slant


def distance_m(lat_deg, dlon_deg, other_lat_deg, other_dlon_deg):
    """Metres between ground points that are near each other."""
    place = _Place.at(lat_deg, 0.0)
    meridional_m = place.normal_m * (1 - place.e2) * (place.normal_m / place.a_m) ** 2
    turn = _real(other_dlon_deg) - dlon_deg
    turn = turn - 360 * np.round(turn / 360)
    return np.hypot(
        meridional_m * (_real(other_lat_deg) - lat_deg) * _DEGREE, place.normal_m * place.cos * turn * _DEGREE
    )


def latitude_deg(v):
    """Geodetic latitude of world fractions southward from the north of Web Mercator."""
    psi = (Real(0.5) - _real(v)) * 360 * _DEGREE
    return np.arctan(np.sinh(psi)) / _DEGREE


class _Place(NamedTuple):
    """A latitude on an ellipsoid: its sine and cosine, its normal radius, and the ellipsoid."""

    sin: np.ndarray
    cos: np.ndarray
    normal_m: np.ndarray
    a_m: np.ndarray
    e2: np.ndarray
    second_e2: np.ndarray

    @classmethod
    def at(cls, lat_deg, ground_height_m):
        a = _EQUATORIAL_AXIS_M + _real(ground_height_m)
        gap = _EQUATORIAL_AXIS_M * _FLATTENING
        b = a - gap
        sin, cos = _sin_cos(lat_deg)
        e2, second_e2 = gap * (a + b) / a**2, gap * (a + b) / b**2
        return cls(sin, cos, a / np.sqrt(1 - e2 * sin**2), a, e2, second_e2)


def _real(values):
    return np.asarray(values, Real)


def _sin_cos(angle_deg):
    """Sine and cosine by way of the nearest quarter turn, found in degrees where it is exact."""
    angle = _real(angle_deg)
    quarter = np.round(angle / 90)
    rest = (angle - 90 * quarter) * _DEGREE
    sin, cos = np.sin(rest), np.cos(rest)
    turn = np.mod(quarter, 4)
    odd = np.mod(turn, 2) == 1
    sin, cos = np.where(odd, cos, sin), np.where(odd, sin, cos)
    return np.where(turn >= 2, -sin, sin), np.where((turn == 1) | (turn == 2), -cos, cos)


def _half_tangents(fov_deg, aspect_ratio):
    fov, ratio = _real(fov_deg), _real(aspect_ratio)
    wide = fov > 90
    small = np.tan(np.where(wide, 180 - fov, fov) * _DEGREE / 2)
    diagonal = np.where(wide, 1 / small, small)
    height = diagonal / np.hypot(Real(1), ratio)
    return ratio * height, height


def _body_to_enu(yaw_deg, tilt_deg, roll_deg, forward, right, down):
    """Roll, then tilt, then yaw of vectors in an aircraft's axes; east, north, up."""
    (sin_yaw, cos_yaw), (sin_tilt, cos_tilt), (sin_roll, cos_roll) = map(_sin_cos, (yaw_deg, tilt_deg, roll_deg))
    right, down = cos_roll * right - sin_roll * down, sin_roll * right + cos_roll * down
    forward, down = cos_tilt * forward + sin_tilt * down, cos_tilt * down - sin_tilt * forward
    return sin_yaw * forward + cos_yaw * right, cos_yaw * forward - sin_yaw * right, -down


def _enu_to_body(yaw_deg, tilt_deg, roll_deg, east, north, up):
    (sin_yaw, cos_yaw), (sin_tilt, cos_tilt), (sin_roll, cos_roll) = map(_sin_cos, (yaw_deg, tilt_deg, roll_deg))
    forward, right, down = cos_yaw * north + sin_yaw * east, cos_yaw * east - sin_yaw * north, -up
    forward, down = cos_tilt * forward - sin_tilt * down, sin_tilt * forward + cos_tilt * down
    return forward, cos_roll * right + sin_roll * down, cos_roll * down - sin_roll * right
