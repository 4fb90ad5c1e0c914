"""The WGS84 ellipsoid: radii, areas, and where a ray from above meets the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput

Floats = NDArray[np.float64]

#: Gauss-Legendre nodes per latitude interval. With 16 the area of a zone from equator to pole is right to
#: 1e-14 relative, so no interval needs to be divided.
_QUADRATURE_NODES = 16


def gauss_legendre(count: int) -> tuple[Floats, Floats]:
    """Nodes in (-1, 1) and weights of Gauss-Legendre quadrature, (count,) each."""
    nodes, weights = np.polynomial.legendre.leggauss(count)  # type: ignore[no-untyped-call, unused-ignore]
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
            raise InvalidInput(
                f"ellipsoid semi-axes {self.a_m} m, {self.b_m} m: need a >= b > 0, both finite"
            )

    @property
    def e2(self) -> float:
        """First eccentricity squared, dimensionless."""
        return (self.a_m - self.b_m) * (self.a_m + self.b_m) / (self.a_m * self.a_m)

    def raised(self, height_m: float) -> Ellipsoid:
        """Ellipsoid through the ground at ``height_m`` over this one.

        Both axes grow by the height, and every later formula uses the eccentricity of the grown axes:
        that stays within 1.4 mm of the true surface of constant height per kilometre of it.
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
        """Ground between two parallels, in m² per degree of longitude.

        Quadrature instead of a difference of the closed form: a band one pixel high keeps all its digits.

        Parameters
        ----------
        south_deg, north_deg : array, degrees
            Broadcast against each other; the result is negative where south lies above north.
        """
        nodes, weights = gauss_legendre(_QUADRATURE_NODES)
        south, north = np.broadcast_arrays(
            np.asarray(south_deg, np.float64), np.asarray(north_deg, np.float64)
        )
        half = (north - south)[..., np.newaxis] / 2.0
        middle = (north + south)[..., np.newaxis] / 2.0
        density: Floats = self.area_density_m2(middle + half * nodes)
        total: Floats = np.sum(density * weights * half, axis=-1)
        return total

    def ring_area_m2(self, lon_deg: Floats, lat_deg: Floats) -> float:
        """Ground inside a ring whose edges are straight in longitude and latitude (RFC 7946).

        Green's theorem with quadrature along each edge.

        Parameters
        ----------
        lon_deg, lat_deg : array (n,), degrees
            Vertices; the last one is joined to the first. Longitudes are continuous, not wrapped.

        Returns
        -------
        float
            Square metres, never negative.
        """
        nodes, weights = gauss_legendre(_QUADRATURE_NODES)
        lon = np.asarray(lon_deg, np.float64) - float(np.mean(lon_deg))
        lat = np.asarray(lat_deg, np.float64)
        half_lon = (np.roll(lon, -1) - lon)[:, np.newaxis] / 2.0
        half_lat = (np.roll(lat, -1) - lat)[:, np.newaxis] / 2.0
        along_lon = lon[:, np.newaxis] + half_lon * (1.0 + nodes)
        along_lat = lat[:, np.newaxis] + half_lat * (1.0 + nodes)
        return abs(float(np.sum(along_lon * self.area_density_m2(along_lat) * weights * half_lat)))


#: EPSG:7030.
WGS84 = Ellipsoid(6378137.0, 6378137.0 * (1.0 - 1.0 / 298.257223563))


class GroundPoints(NamedTuple):
    """Where rays meet the ground; the arrays share one shape.

    ``lat_deg`` is geodetic; ``dlon_deg`` is the longitude from the camera's, in (-180, 180], never wrapped
    into the camera's own; both are NaN where ``hit`` is False, that is where a ray misses the Earth.
    """

    lat_deg: Floats
    dlon_deg: Floats
    hit: NDArray[np.bool_]


class _Station(NamedTuple):
    """A camera in the meridian plane: distance from the axis and from the equator in metres, and Q·Q - 1.

    Q is the camera in space scaled to a unit sphere, (x/a, y/a, z/b): the last number is how far it is from the
    ground, built from the height so that nothing cancels.
    """

    rho_m: Floats
    z_m: Floats
    excess: Floats


def _station(lat_deg: Floats, agl_m: Floats, ground: Ellipsoid) -> _Station:
    phi = np.radians(np.asarray(lat_deg, np.float64))
    h = np.asarray(agl_m, np.float64)
    a, b, e2 = ground.a_m, ground.b_m, ground.e2
    s, c = np.sin(phi), np.cos(phi)
    n = a / np.sqrt(1.0 - e2 * s * s)
    excess = 2.0 * h * (n * c * c / a**2 + n * (1.0 - e2) * s * s / b**2) + h * h * (
        c * c / a**2 + s * s / b**2
    )
    return _Station((n + h) * c, (n * (1.0 - e2) + h) * s, excess)


def _meridian_frame(lat_deg: Floats, vectors_enu: Floats) -> tuple[Floats, Floats, Floats]:
    """Vectors in east, north, up turned to axes through the camera's meridian on the equator, east, north pole."""
    phi = np.radians(np.asarray(lat_deg, np.float64))
    s, c = np.sin(phi), np.cos(phi)
    east, north, up = vectors_enu[..., 0], vectors_enu[..., 1], vectors_enu[..., 2]
    return -s * north + c * up, east, c * north + s * up


def trace(lat_deg: Floats, agl_m: Floats, rays_enu: Floats, ground: Ellipsoid = WGS84) -> GroundPoints:
    """Intersect rays from a camera above the ellipsoid with it.

    The quadratic is built from the height, so that nothing cancels: against 50-digit arithmetic the ground is off by
    three roundings of the ray at most, 3·2⁻⁵³·slant/sin(incidence), and by the 1.6e-9 m that degrees resolve.

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
    rho, z, excess = _station(lat_deg, agl_m, ground)
    rays = np.asarray(rays_enu, np.float64)
    disc, half_lin = clearance(lat_deg, agl_m, rays, ground)
    hit = np.asarray((disc >= 0.0) & (half_lin < 0.0))
    with np.errstate(invalid="ignore", divide="ignore"):
        t = np.where(hit, excess / (np.sqrt(np.where(hit, disc, 0.0)) - half_lin), np.nan)
    ray_x, ray_y, ray_z = _meridian_frame(lat_deg, rays)
    return GroundPoints(*_geodetic(rho + t * ray_x, t * ray_y, z + t * ray_z, ground.e2), hit)


def clearance(
    lat_deg: Floats, agl_m: Floats, rays_enu: Floats, ground: Ellipsoid = WGS84
) -> tuple[Floats, Floats]:
    """How rays pass the Earth: two numbers (...), of which a ray that hits has the first >= 0 and the second < 0.

    They are the discriminant of the quadratic along the ray and half its linear term. Along a straight line in the
    image the first is a quadratic and the second is linear.
    """
    a, b, e2 = ground.a_m, ground.b_m, ground.e2
    rho, z, excess = _station(lat_deg, agl_m, ground)
    x, east, w = _meridian_frame(lat_deg, rays_enu)
    square = (x**2 + east**2) / a**2 + w**2 / b**2
    half_lin: Floats = rho * x / a**2 + z * w / b**2
    near = half_lin**2 - square * excess
    if np.all(excess <= 1.0):
        return near, half_lin
    # From high up those two cancel; |d|² - |Q × d|², the same by Lagrange's identity, does not.
    phi = np.radians(np.asarray(lat_deg, np.float64))
    s, c = np.sin(phi), np.cos(phi)
    n = a / np.sqrt(1.0 - e2 * s * s)
    moment = (n * (1.0 - e2 * s * s) + agl_m) * rays_enu[..., 1] + n * e2 * s * c * rays_enu[..., 2]
    high = square - (1.0 + excess) * (east / a) ** 2 - (moment / (a * b)) ** 2
    return np.where(excess > 1.0, high, near), half_lin


def _geodetic(x: Floats, y: Floats, z: Floats, e2: float) -> tuple[Floats, Floats]:
    """Latitude, and longitude from the camera's, of points on the ellipsoid, degrees."""
    lat: Floats = np.degrees(np.arctan2(z, (1.0 - e2) * np.hypot(x, y)))
    dlon: Floats = np.degrees(np.arctan2(y, x))
    return lat, dlon


def limb(lat_deg: Floats, agl_m: Floats, towards_enu: Floats, ground: Ellipsoid = WGS84) -> GroundPoints:
    """Points of the horizon below given directions.

    In space scaled to the unit sphere the limb is the circle about Q/|Q|² with radius sqrt(1 - 1/|Q|²); the point
    is the one in the plane of the camera, the centre and the direction.

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
    a, b = ground.a_m, ground.b_m
    rho, z, excess = _station(lat_deg, agl_m, ground)
    x, y, w = _meridian_frame(lat_deg, np.asarray(towards_enu, np.float64))
    q_x, q_z, size2 = rho / a, z / b, 1.0 + excess
    x, y, w = x / a, y / a, w / b
    inward = (x * q_x + w * q_z) / size2
    x, w = x - inward * q_x, w - inward * q_z
    radius = np.sqrt(excess / size2) / np.sqrt(x * x + y * y + w * w)
    lat, dlon = _geodetic(
        (q_x / size2 + radius * x) * a, radius * y * a, (q_z / size2 + radius * w) * b, ground.e2
    )
    return GroundPoints(lat, dlon, np.ones(lat.shape, bool))


def limb_azimuth(lat_deg: Floats, agl_m: Floats, towards_enu: Floats, ground: Ellipsoid = WGS84) -> Floats:
    """Azimuth, radians from north, of the level directions whose points of the horizon are those of given ones.

    Directions that differ by a part along the line from the Earth's centre share their point of the `limb`; that line
    leans from the vertical by N e² sin φ cos φ over N(1 - e² sin² φ) + h.
    """
    phi = np.radians(np.asarray(lat_deg, np.float64))
    s, c = np.sin(phi), np.cos(phi)
    n = ground.a_m / np.sqrt(1.0 - ground.e2 * s * s)
    lean = n * ground.e2 * s * c / (n * (1.0 - ground.e2 * s * s) + agl_m)
    azimuth: Floats = np.arctan2(towards_enu[..., 0], towards_enu[..., 1] + lean * towards_enu[..., 2])
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
        Points: geodetic latitude, and longitude from the camera's. All broadcast.

    Returns
    -------
    array (..., 3)
        East, north, up of the camera in metres, good to a nanometre.
    """
    rho, z, _ = _station(lat_deg, agl_m, ground)
    phi, lam = np.radians(ground_lat_deg), np.radians(dlon_deg)
    n = ground.normal_radius_m(np.asarray(ground_lat_deg, np.float64))
    x = n * np.cos(phi) * np.cos(lam) - rho
    w = n * (1.0 - ground.e2) * np.sin(phi) - z
    s, c = np.sin(np.radians(lat_deg)), np.cos(np.radians(lat_deg))
    return np.stack(np.broadcast_arrays(n * np.cos(phi) * np.sin(lam), c * w - s * x, c * x + s * w), axis=-1)


def above_tangent_plane_m(
    lat_deg: Floats, vectors_enu: Floats, ground_lat_deg: Floats, dlon_deg: Floats
) -> Floats:
    """Height of cameras over the planes that touch the ellipsoid at ground points: those are seen from above them only.

    Parameters
    ----------
    lat_deg : array
        Cameras.
    vectors_enu : array (..., 3)
        From them to the points, as `sight_lines` gives them.
    ground_lat_deg, dlon_deg : array
        The points. All broadcast.
    """
    phi, lam = np.radians(ground_lat_deg), np.radians(dlon_deg)
    x, east, w = _meridian_frame(lat_deg, vectors_enu)
    height: Floats = -np.cos(phi) * (np.cos(lam) * x + np.sin(lam) * east) - np.sin(phi) * w
    return height
