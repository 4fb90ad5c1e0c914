"""A camera over the ellipsoid at 50 digits, written from the definitions and sharing nothing with the core.

Angles are degrees and lengths metres. Numbers go in as int, float or mpf, each taken exactly, and come out as mpf.
"""

from __future__ import annotations

import mpmath

DIGITS = 50
#: WGS 84 (EPSG:7030), exact by definition.
EQUATORIAL_AXIS_M = 6378137
INVERSE_FLATTENING = "298.257223563"


def axes(ground_height_m=0):
    """Semi-axes (a, b) of WGS 84 with both raised by the height of the ground."""
    with mpmath.workdps(DIGITS):
        a = mpmath.mpf(EQUATORIAL_AXIS_M)
        b = a * (1 - 1 / mpmath.mpf(INVERSE_FLATTENING))
        return a + _exact(ground_height_m), b + _exact(ground_height_m)


def image_ray(fov_deg, aspect_ratio, yaw_deg, tilt_deg, roll_deg, x, y):
    """East, north, up of the direction of an image point (right, up; each -1..1), 1 along the optical axis.

    Body axes are an aircraft's (forward, right, down) in north, east, down axes: the matrix product
    Rz(yaw)·Ry(tilt)·Rx(roll) takes the first to the second. The camera looks down the third body axis with the top
    of its image forward.
    """
    with mpmath.workdps(DIGITS):
        tan_x, tan_y = _half_tangents(fov_deg, aspect_ratio)
        body = mpmath.matrix([_exact(y) * tan_y, _exact(x) * tan_x, 1])
        north, east, down = _attitude(yaw_deg, tilt_deg, roll_deg) * body
        return east, north, -down


def ground_point(lat_deg, agl_m, ray_enu, ground_height_m=0):
    """Latitude and longitude from the camera's where a ray meets the ground; None where it misses.

    The latitudes are geodetic on the raised ellipsoid, over which the camera is ``agl_m`` high.
    """
    with mpmath.workdps(DIGITS):
        a, b = axes(ground_height_m)
        camera = _position(lat_deg, 0, agl_m, a, b)
        ray = _local_axes(lat_deg).T * mpmath.matrix([_exact(part) for part in ray_enu])
        # The surface x²/a² + y²/a² + z²/b² = 1 along camera + t·ray, as the textbook quadratic in t.
        scale = (a, a, b)
        square = sum((r / s) ** 2 for r, s in zip(ray, scale))
        linear = 2 * sum(c * r / s**2 for c, r, s in zip(camera, ray, scale))
        constant = sum((c / s) ** 2 for c, s in zip(camera, scale)) - 1
        disc = linear * linear - 4 * square * constant
        if disc < 0:
            return None
        t = (-linear - mpmath.sqrt(disc)) / (2 * square)
        if t <= 0:
            return None
        px, py, pz = (c + t * r for c, r in zip(camera, ray))
        lat = mpmath.atan2(pz, (b / a) ** 2 * mpmath.hypot(px, py))
        return mpmath.degrees(lat), mpmath.degrees(mpmath.atan2(py, px))


def see(lat_deg, agl_m, fov_deg, aspect_ratio, yaw_deg, tilt_deg, roll_deg, x, y, ground_height_m=0):
    """Latitude and longitude from the camera's of the ground seen at an image point; None for sky."""
    ray = image_ray(fov_deg, aspect_ratio, yaw_deg, tilt_deg, roll_deg, x, y)
    return ground_point(lat_deg, agl_m, ray, ground_height_m)


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
    ground_height_m=0,
):
    """Image point (right, up) at which a ground point is seen, the inverse of `see`.

    None where the point lies behind the camera or the Earth hides it; beyond -1..1 it lies outside the image.
    """
    with mpmath.workdps(DIGITS):
        a, b = axes(ground_height_m)
        point = _position(point_lat_deg, point_dlon_deg, 0, a, b)
        sight = point - _position(lat_deg, 0, agl_m, a, b)
        outward = (point[0] / a**2, point[1] / a**2, point[2] / b**2)
        if sum(s * n for s, n in zip(sight, outward)) > 0:
            return None
        east, north, up = _local_axes(lat_deg) * sight
        forward, right, down = _attitude(yaw_deg, tilt_deg, roll_deg).T * mpmath.matrix([north, east, -up])
        if down <= 0:
            return None
        tan_x, tan_y = _half_tangents(fov_deg, aspect_ratio)
        return right / down / tan_x, forward / down / tan_y


def slant_and_grazing(lat_deg, agl_m, point, ground_height_m=0):
    """Distance from a camera to a ground point (latitude, longitude), and the sine of the ray's angle to the ground.

    A small turn of the ray moves its end by the turn times the first over the second.
    """
    with mpmath.workdps(DIGITS):
        a, b = axes(ground_height_m)
        spot = _position(*point, 0, a, b)
        sight = spot - _position(lat_deg, 0, agl_m, a, b)
        normal = mpmath.matrix([spot[0] / a**2, spot[1] / a**2, spot[2] / b**2])
        slant = mpmath.norm(sight)
        return slant, -sum(s * n for s, n in zip(sight, normal)) / slant / mpmath.norm(normal)


def distance_m(one, other, ground_height_m=0):
    """Straight line between two ground points given as (latitude, longitude)."""
    with mpmath.workdps(DIGITS):
        a, b = axes(ground_height_m)
        return mpmath.norm(_position(*one, 0, a, b) - _position(*other, 0, a, b))


def zone_area_m2(south_deg, north_deg):
    """Ground between two parallels over all longitudes, by the closed form of the authalic latitude."""
    with mpmath.workdps(DIGITS):
        a, b = axes()
        e = mpmath.sqrt(1 - (b / a) ** 2)

        def half(lat_deg):
            s = mpmath.sin(mpmath.radians(_exact(lat_deg)))
            return mpmath.pi * b * b * (s / (1 - (e * s) ** 2) + mpmath.atanh(e * s) / e)

        return half(north_deg) - half(south_deg)


def _exact(number):
    return number if isinstance(number, mpmath.mpf) else mpmath.mpf(float(number))


def _half_tangents(fov_deg, aspect_ratio):
    diagonal = mpmath.tan(mpmath.radians(_exact(fov_deg)) / 2)
    ratio = _exact(aspect_ratio)
    height = diagonal / mpmath.sqrt(1 + ratio**2)
    return ratio * height, height


def _attitude(yaw_deg, tilt_deg, roll_deg):
    """Matrix from an aircraft's forward, right, down to north, east, down."""
    angles = [mpmath.radians(_exact(angle)) for angle in (yaw_deg, tilt_deg, roll_deg)]
    (cz, cy, cx), (sz, sy, sx) = map(mpmath.cos, angles), map(mpmath.sin, angles)
    about_z = mpmath.matrix([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    about_y = mpmath.matrix([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_x = mpmath.matrix([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    return about_z * about_y * about_x


def _local_axes(lat_deg):
    """Rows: east, north and up of a place on the prime meridian, in geocentric axes."""
    phi = mpmath.radians(_exact(lat_deg))
    s, c = mpmath.sin(phi), mpmath.cos(phi)
    return mpmath.matrix([[0, 1, 0], [-s, 0, c], [c, 0, s]])


def _position(lat_deg, lon_deg, height_m, a, b):
    """Geocentric position of geodetic coordinates (EPSG method 9602)."""
    phi, lam, h = mpmath.radians(_exact(lat_deg)), mpmath.radians(_exact(lon_deg)), _exact(height_m)
    s, c = mpmath.sin(phi), mpmath.cos(phi)
    n = a**2 / mpmath.sqrt((a * c) ** 2 + (b * s) ** 2)
    return mpmath.matrix([(n + h) * c * mpmath.cos(lam), (n + h) * c * mpmath.sin(lam), ((b / a) ** 2 * n + h) * s])
