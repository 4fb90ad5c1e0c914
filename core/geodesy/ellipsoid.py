"""The WGS84 ellipsoid: radii, areas, and intersections of rays from above with the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np

from ..arrays import Floats, NDArray
from ..errors import InvalidInput


@cache
def gauss_legendre(count: int = 16) -> tuple[Floats, Floats]:
    """Nodes in (-1, 1) and weights of Gauss-Legendre quadrature, (count,) each, read-only.

    16 nodes give the area of a zone from equator to pole to a relative 1e-14, so intervals of latitude need not be
    divided.
    """
    nodes, weights = np.polynomial.legendre.leggauss(count)  # type: ignore[no-untyped-call, unused-ignore]
    nodes.flags.writeable = weights.flags.writeable = False
    return nodes, weights


@dataclass(frozen=True)
class Ellipsoid:
    """An ellipsoid of revolution.

    Parameters
    ----------
    a_m, b_m : float
        Equatorial and polar semi-axis in metres, ``a_m >= b_m > 0``.
    """

    a_m: float
    b_m: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.a_m) and self.a_m >= self.b_m > 0):
            raise InvalidInput("ellipsoid semi-axes {0} m, {1} m: need a >= b > 0, both finite", self.a_m, self.b_m)

    @property
    def e2(self) -> float:
        """First eccentricity squared, dimensionless."""
        return (self.a_m - self.b_m) * (self.a_m + self.b_m) / (self.a_m * self.a_m)

    def raised(self, height_m: float) -> Ellipsoid:
        """Ellipsoid through the ground at ``height_m`` above this one.

        Both axes grow by the height. The result is within 1.4 mm per kilometre of height of the true surface of
        constant height.
        """
        return Ellipsoid(self.a_m + height_m, self.b_m + height_m)

    def meridional_radius_m(self, lat_deg: Floats) -> Floats:
        """Radius of curvature in the meridian, M, in metres, at ``lat_deg`` (any shape)."""
        w2 = 1.0 - self.e2 * np.sin(np.radians(lat_deg)) ** 2
        radius: Floats = self.a_m * (1.0 - self.e2) / (w2 * np.sqrt(w2))
        return radius

    def normal_radius_m(self, lat_deg: Floats) -> Floats:
        """Radius of curvature in the prime vertical, N, in metres, at ``lat_deg`` (any shape)."""
        radius: Floats = self.a_m / np.sqrt(1.0 - self.e2 * np.sin(np.radians(lat_deg)) ** 2)
        return radius

    def area_density_m2(self, lat_deg: Floats) -> Floats:
        """Square metres of ground per degree of longitude and degree of latitude: M·N·cos φ, any shape."""
        per_deg = math.radians(1.0)
        cos_lat = np.cos(np.radians(lat_deg))
        radii = self.meridional_radius_m(lat_deg) * self.normal_radius_m(lat_deg)
        density: Floats = radii * cos_lat * per_deg * per_deg
        return density

    def zone_area_m2_per_deg(self, south_deg: Floats, north_deg: Floats) -> Floats:
        """Area of ground between two parallels, in m² per degree of longitude.

        Uses quadrature: a difference of the closed form would lose digits for a band one pixel high.

        Parameters
        ----------
        south_deg, north_deg : array, degrees
            Broadcast against each other; the result is negative where south lies above north.
        """
        south, north = np.broadcast_arrays(np.asarray(south_deg, np.float64), np.asarray(north_deg, np.float64))
        half, middle = np.ravel(north - south) / 2.0, np.ravel(north + south) / 2.0
        # Five nodes are exact to rounding for zones of up to a degree.
        nodes, weights = gauss_legendre(5 if np.all(np.abs(half) <= 0.5) else 16)
        total, step = np.empty(len(half)), 1 << 12  # nodes of as many zones fit into a processor's cache
        for start in range(0, len(half), step):
            some = slice(start, start + step)
            density = self.area_density_m2(middle[some, np.newaxis] + half[some, np.newaxis] * nodes)
            total[some] = (density * weights).sum(axis=1) * half[some]
        return total.reshape(south.shape)

    def ring_area_m2(self, lon_deg: Floats, lat_deg: Floats) -> float:
        """Area of ground inside a ring whose edges are straight in longitude and latitude (RFC 7946).

        Uses Green's theorem, with quadrature along each edge.

        Parameters
        ----------
        lon_deg, lat_deg : array (n,), degrees
            Vertices; the last one is joined to the first. Longitudes are continuous, not wrapped.

        Returns
        -------
        float
            Square metres, never negative.
        """
        corners = np.asarray(lon_deg, np.float64), np.asarray(lat_deg, np.float64)
        return float(self.ring_areas_m2(*corners, np.zeros(len(corners[0]), np.int64), 1)[0])

    def ring_areas_m2(self, lon_deg: Floats, lat_deg: Floats, ring: NDArray[np.int64], count: int) -> Floats:
        """Area of ground inside each of many rings; see `ring_area_m2`.

        Parameters
        ----------
        lon_deg, lat_deg : array (n,), degrees
            Vertices of all rings, one ring after the other.
        ring : array (n,)
            Number of the ring of each vertex, ascending.
        count : int
            Number of rings; rings without vertices have an area of 0.

        Returns
        -------
        array (count,)
            Square metres, never negative.
        """
        nodes, weights = gauss_legendre()
        middle = np.bincount(ring, lon_deg, count) / np.maximum(np.bincount(ring, minlength=count), 1)
        lon, lat = lon_deg - middle[ring], lat_deg
        following = next_corners(ring)
        half_lon = (lon[following] - lon)[:, np.newaxis] / 2.0
        half_lat = (lat[following] - lat)[:, np.newaxis] / 2.0
        along_lon = lon[:, np.newaxis] + half_lon * (1.0 + nodes)
        along_lat = lat[:, np.newaxis] + half_lat * (1.0 + nodes)
        below = np.sum(along_lon * self.area_density_m2(along_lat) * weights * half_lat, axis=1)
        return np.abs(np.bincount(ring, below, count))


def next_corners(ring: NDArray[np.int64]) -> NDArray[np.int64]:
    """Index of the next corner of the same ring, (n,); ``ring`` (n,) is the number of each corner's ring, ascending."""
    following = np.arange(1, len(ring) + 1)
    last = np.append(ring[1:] != ring[:-1], True)[: len(ring)]
    following[last] = np.flatnonzero(np.append(True, last[:-1])[: len(ring)])
    return following


#: EPSG:7030
WGS84 = Ellipsoid(6378137.0, 6378137.0 * (1.0 - 1.0 / 298.257223563))


class GroundPoints(NamedTuple):
    """Points where rays meet the ground; the arrays share one shape.

    ``lat_deg`` is geodetic; ``dlon_deg`` is the difference of longitude from the camera, in (-180, 180]; both are NaN
    where ``hit`` is False, as the ray misses the Earth.
    """

    lat_deg: Floats
    dlon_deg: Floats
    hit: NDArray[np.bool_]


class _Viewpoint(NamedTuple):
    """A camera over the ellipsoid: latitude with sine and cosine, length N of the normal there, and height.

    Points are computed in the camera's east, north and up, relative to the camera or the ground below it: the Earth's
    radius, whose last digit is a nanometre, is never subtracted. ``e2`` is e², ``e2_prime`` is
    e'² = e²/(1 - e²).
    """

    lat_deg: Floats
    sin: Floats
    cos: Floats
    normal_m: Floats
    agl_m: Floats
    e2: float
    e2_prime: float

    @classmethod
    def locate(cls, lat_deg: Floats, agl_m: Floats, ground: Ellipsoid) -> _Viewpoint:
        """Build from a geodetic latitude and a height above ``ground``."""
        sin, cos = sin_cos(lat_deg)
        e2 = ground.e2
        normal = ground.a_m / np.sqrt(1.0 - e2 * sin * sin)
        return cls(
            np.asarray(lat_deg, np.float64),
            sin,
            cos,
            normal,
            np.asarray(agl_m, np.float64),
            e2,
            e2 / (1.0 - e2),
        )

    @property
    def excess_m2(self) -> Floats:
        """Value of the surface equation at the camera: h(2N + h(1 + e'² sin² φ))."""
        h = self.agl_m
        excess: Floats = h * (2.0 * self.normal_m + h * (1.0 + self.e2_prime * self.sin * self.sin))
        return excess

    @property
    def lean_m(self) -> Floats:
        """Distance of the Earth's centre from the camera's vertical: N e² sin φ cos φ."""
        lean: Floats = self.normal_m * self.e2 * self.sin * self.cos
        return lean

    @property
    def reach_m(self) -> Floats:
        """Height of the camera over the Earth's centre, projected onto the camera's vertical: N(1 - e² sin² φ) + h."""
        reach: Floats = self.normal_m * (1.0 - self.e2 * self.sin * self.sin) + self.agl_m
        return reach

    def polar(self, north: Floats, up: Floats) -> Floats:
        """Component of vectors along the Earth's axis."""
        part: Floats = self.cos * north + self.sin * up
        return part

    def product(self, one: Floats, other: Floats) -> Floats:
        """Inner product, times a², of vectors (..., 3) in space scaled so that the ellipsoid is the unit sphere."""
        along = self.polar(one[..., 1], one[..., 2]) * self.polar(other[..., 1], other[..., 2])
        inner: Floats = np.sum(one * other, axis=-1) + self.e2_prime * along
        return inner

    def geodetic(self, east_m: Floats, north_m: Floats, up_m: Floats) -> tuple[Floats, Floats]:
        """Latitude, and difference of longitude from the camera, in degrees, of points on the ellipsoid.

        Offsets count from the ground below the camera. The latitude is the camera's plus the angle between the two
        normals; the point's normal is half the gradient of the surface equation, rotated into the camera's meridian.
        """
        s, c = self.sin, self.cos
        bend = self.e2_prime * self.polar(north_m, up_m)
        north, up = north_m + bend * c, self.normal_m + up_m + bend * s
        towards = c * up - s * north
        radius = np.hypot(towards, east_m)
        ahead = towards > 0.0
        bulge = np.where(ahead, east_m * (east_m / np.where(ahead, radius + towards, 1.0)), radius - towards)
        rise = np.arctan2(north - s * bulge, up + c * bulge)
        lat: Floats = np.clip(self.lat_deg + np.degrees(rise), -90.0, 90.0)
        dlon: Floats = np.degrees(np.arctan2(east_m, towards))
        return lat, dlon


def trace(lat_deg: Floats, agl_m: Floats, rays_enu: Floats, ground: Ellipsoid = WGS84) -> GroundPoints:
    """Intersect the ellipsoid with rays from cameras above it.

    If sines and arctangents are within 4 units in the last place, 8·2⁻⁵³ each, a ground point is off by at most 64
    roundings of the ray, 2⁻⁴⁷·slant/sin(incidence), plus half the last digit of its latitude, 0.8e-9 m.

    Parameters
    ----------
    lat_deg : array, degrees
        Geodetic latitude of the camera; broadcasts against the rays' leading shape.
    agl_m : array, metres
        Height of the camera over ``ground``, > 0; broadcasts likewise.
    rays_enu : array (..., 3)
        Directions in the camera's east, north, up; any length but zero.
    ground : Ellipsoid
        The surface to hit; ``WGS84.raised(g)`` for ground at height g.
    """
    place = _Viewpoint.locate(lat_deg, agl_m, ground)
    rays = np.asarray(rays_enu, np.float64)
    t, hit = _meeting(place, rays, ground)
    return GroundPoints(*place.geodetic(t * rays[..., 0], t * rays[..., 1], place.agl_m + t * rays[..., 2]), hit)


def distances_m(lat_deg: Floats, agl_m: Floats, rays_enu: Floats, ground: Ellipsoid = WGS84) -> Floats:
    """Distances (...) in metres from cameras to the ground along rays; infinite where they miss it.

    Parameters are those of `trace`.
    """
    rays = np.asarray(rays_enu, np.float64)
    t, hit = _meeting(_Viewpoint.locate(lat_deg, agl_m, ground), rays, ground)
    found: Floats = np.where(hit, t * np.sqrt(rays[..., 0] ** 2 + rays[..., 1] ** 2 + rays[..., 2] ** 2), np.inf)
    return found


def _meeting(place: _Viewpoint, rays: Floats, ground: Ellipsoid) -> tuple[Floats, NDArray[np.bool_]]:
    """Multiples of rays at which they meet the ground, NaN if they do not; and whether they do."""
    disc, half_lin = _clearance(place, rays, ground)
    hit = np.asarray((disc >= 0.0) & (half_lin < 0.0))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(hit, place.excess_m2 / (np.sqrt(np.where(hit, disc, 0.0)) - half_lin), np.nan), hit


def clearance(lat_deg: Floats, agl_m: Floats, rays_enu: Floats, ground: Ellipsoid = WGS84) -> tuple[Floats, Floats]:
    """Discriminant, and half the linear term, of the quadratic equation along each ray, (...) each.

    A ray hits the Earth where the discriminant is >= 0 and the linear term < 0. Along a straight line in the image the
    discriminant is quadratic and the linear term linear.
    """
    return _clearance(_Viewpoint.locate(lat_deg, agl_m, ground), np.asarray(rays_enu, np.float64), ground)


def _clearance(place: _Viewpoint, rays: Floats, ground: Ellipsoid) -> tuple[Floats, Floats]:
    """Discriminant and half the linear term, as `clearance` returns them."""
    east, north, up = rays[..., 0], rays[..., 1], rays[..., 2]
    polar = place.polar(north, up)
    square = east * east + north * north + up * up + place.e2_prime * polar * polar
    half_lin: Floats = place.normal_m * up + place.agl_m * (up + place.e2_prime * place.sin * polar)
    near = half_lin * half_lin - square * place.excess_m2
    a2 = ground.a_m**2
    from_afar = place.excess_m2 > a2
    if not np.any(from_afar):
        return near, half_lin
    # High up, the two terms nearly cancel; |d|² - |Q × d|², equal by Lagrange's identity, keeps its digits.
    moment = place.reach_m * north + place.lean_m * up
    high = a2 * square - (a2 + place.excess_m2) * east * east - (1.0 + place.e2_prime) * moment * moment
    return np.where(from_afar, high, near), half_lin


def limb(lat_deg: Floats, agl_m: Floats, towards_enu: Floats, ground: Ellipsoid = WGS84) -> GroundPoints:
    """Points of the horizon below given directions.

    In space scaled to the unit sphere the limb is the circle about Q/|Q|² with radius sqrt(1 - 1/|Q|²); the point lies
    in the plane of the camera, the centre and the direction.

    Parameters
    ----------
    lat_deg, agl_m : array
        As in `trace`.
    towards_enu : array (..., 3)
        Directions, not vertical.

    Returns
    -------
    GroundPoints
        All hit.
    """
    place = _Viewpoint.locate(lat_deg, agl_m, ground)
    towards = np.asarray(towards_enu, np.float64)
    from_centre = np.stack(np.broadcast_arrays(0.0 * place.lean_m, -place.lean_m, place.reach_m), axis=-1)
    a2, excess = ground.a_m**2, place.excess_m2
    inward = place.product(towards, from_centre) / (a2 + excess)
    across = towards - inward[..., np.newaxis] * from_centre
    radius = ground.a_m * np.sqrt(excess / (a2 + excess) / place.product(across, across))
    offset = radius[..., np.newaxis] * across - (excess / (a2 + excess))[..., np.newaxis] * from_centre
    lat, dlon = place.geodetic(offset[..., 0], offset[..., 1], place.agl_m + offset[..., 2])
    return GroundPoints(lat, dlon, np.ones(lat.shape, bool))


def limb_azimuth(lat_deg: Floats, agl_m: Floats, towards_enu: Floats, ground: Ellipsoid = WGS84) -> Floats:
    """Azimuths, radians from north, of the level directions that share the horizon points of given directions.

    Directions that differ only along the line to the Earth's centre share their point of the `limb`; that line leans
    from the vertical by N e² sin φ cos φ over N(1 - e² sin² φ) + h.
    """
    place = _Viewpoint.locate(lat_deg, agl_m, ground)
    towards = np.asarray(towards_enu, np.float64)
    lean = place.lean_m / place.reach_m
    azimuth: Floats = arctan2(towards[..., 0], towards[..., 1] + lean * towards[..., 2])
    return azimuth


def sight_lines(
    lat_deg: Floats, agl_m: Floats, ground_lat_deg: Floats, dlon_deg: Floats, ground: Ellipsoid = WGS84
) -> Floats:
    """Vectors from cameras to points of the ground; the inverse of `trace`.

    Parameters
    ----------
    lat_deg, agl_m : array
        Cameras, as in `trace`.
    ground_lat_deg, dlon_deg : array
        Points: geodetic latitude, and difference of longitude from the camera. All broadcast.

    Returns
    -------
    array (..., 3)
        East, north, up of the camera in metres, good to 64 roundings of their length, 2⁻⁴⁷.
    """
    place, point = _Viewpoint.locate(lat_deg, agl_m, ground), _Viewpoint.locate(ground_lat_deg, agl_m, ground)
    half_rise, half_turn = np.radians(point.lat_deg - place.lat_deg) / 2.0, np.radians(dlon_deg) / 2.0
    sin_half, sin_half_dlon = np.sin(half_rise), np.sin(half_turn)
    # Addition theorems give the difference of the normals' directions and, by a²/N² = 1 - e² sin² φ, of their lengths.
    sin_rise, bulge = 2.0 * sin_half * np.cos(half_rise), 2.0 * point.cos * sin_half_dlon * sin_half_dlon
    n, camera_n = point.normal_m, place.normal_m
    rising = sin_rise * (point.sin * place.cos + point.cos * place.sin)
    longer = ground.e2 * rising * (n / ground.a_m) ** 2 * camera_n * camera_n / (n + camera_n)
    sin_gain = place.cos * sin_rise - 2.0 * place.sin * sin_half * sin_half
    flatter = ground.e2 * (n * sin_gain + longer * place.sin)
    east = n * (2.0 * point.cos * sin_half_dlon * np.cos(half_turn))
    north = n * (sin_rise + place.sin * bulge) - place.cos * flatter
    up = longer - n * (2.0 * sin_half * sin_half + place.cos * bulge) - place.sin * flatter - place.agl_m
    return np.stack(np.broadcast_arrays(east, north, up), axis=-1)


def above_tangent_plane_m(lat_deg: Floats, vectors_enu: Floats, ground_lat_deg: Floats, dlon_deg: Floats) -> Floats:
    """Height of cameras above the tangent planes of the ellipsoid at ground points; a point is visible where it is > 0.

    Parameters
    ----------
    lat_deg : array
        Cameras.
    vectors_enu : array (..., 3)
        From cameras to points, as `sight_lines` returns them.
    ground_lat_deg, dlon_deg : array
        The points. All broadcast.
    """
    (s, c), (sin_lat, cos_lat) = sin_cos(lat_deg), sin_cos(ground_lat_deg)
    sin_dlon, cos_dlon = sin_cos(dlon_deg)
    east, north, up = vectors_enu[..., 0], vectors_enu[..., 1], vectors_enu[..., 2]
    outward, polar = c * up - s * north, c * north + s * up
    height: Floats = -cos_lat * (cos_dlon * outward + sin_dlon * east) - sin_lat * polar
    return height


def positions(
    lat_deg: Floats, height_m: Floats, offsets_enu: Floats, ground: Ellipsoid = WGS84
) -> tuple[Floats, Floats, Floats]:
    """Latitude, difference of longitude from the camera, and height of points given in its east, north and up.

    The height follows from the surface equation at the point, the latitude from the point's foot on the surface, found
    by fixed-point iteration along the normal: each step multiplies the error by h·e²/R, which is a thousandth at 1,000
    km.

    Parameters
    ----------
    lat_deg, height_m : array
        Cameras, as in `trace`.
    offsets_enu : array (..., 3)
        From cameras to points, metres; points lie less than the Earth's radius below the surface.

    Returns
    -------
    lat_deg, dlon_deg, height_m : array (...)
    """
    place = _Viewpoint.locate(lat_deg, height_m, ground)
    offsets = np.asarray(offsets_enu, np.float64)
    east, north, up = offsets[..., 0], offsets[..., 1], offsets[..., 2] + place.agl_m
    polar = place.polar(north, up)
    excess = east * east + north * north + up * up + place.e2_prime * polar * polar + 2.0 * place.normal_m * up
    lat, dlon = place.geodetic(east, north, up)
    for _ in range(5):  # enough to leave only rounding
        (sine, cosine), (sin_dlon, cos_dlon) = sin_cos(lat), sin_cos(dlon)
        normal = ground.a_m / np.sqrt(1.0 - ground.e2 * sine * sine)
        stretch = 1.0 + place.e2_prime * sine * sine
        height = excess / (normal + np.sqrt(normal * normal + excess * stretch))
        lat, dlon = place.geodetic(
            east - height * cosine * sin_dlon,
            north - height * (sine * place.cos - cosine * place.sin * cos_dlon),
            up - height * (sine * place.sin + cosine * place.cos * cos_dlon),
        )
    return lat, dlon, height


def arctan2(across: Floats, along: Floats) -> Floats:
    """Same as `numpy.arctan2`, but independent of the arrays' layout in memory.

    numpy 1.24 with AVX-512 rounds slices of larger arrays in one of two ways, depending on where the result lies in
    memory: the last digits of a mission would change from run to run.
    """
    found: Floats = np.arctan2(np.array(across, np.float64, order="C"), np.array(along, np.float64, order="C"))
    return found


def sin_cos(angle_deg: Floats | float) -> tuple[Floats, Floats]:
    """Sine and cosine of angles (any shape), each with small relative error, also near 0.

    The nearest quarter turn is subtracted in degrees, which is exact: in radians the cosine of 89.9999 degrees would be
    off by a part in 10¹⁰, as π/2 is not a float64.
    """
    angle = np.asarray(angle_deg, np.float64)
    quarters = np.rint(angle / 90.0)
    rest = np.radians(angle - 90.0 * quarters)
    sine, cosine = np.sin(rest), np.cos(rest)
    if not quarters.any():
        return sine, cosine
    turn = quarters % 4.0
    swapped, opposite = turn % 2.0 == 1.0, turn >= 2.0
    sine, cosine = np.where(swapped, cosine, sine), np.where(swapped, sine, cosine)
    return np.where(opposite, -sine, sine), np.where((turn == 1.0) | (turn == 2.0), -cosine, cosine)
