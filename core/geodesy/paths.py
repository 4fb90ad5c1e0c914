"""Ways of rays through space as polynomials: where they are on a map's plane, and how high over the ellipsoid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np

from ..arrays import Floats
from .ellipsoid import WGS84, Ellipsoid, positions

#: Coordinates (n, c) of latitudes, longitudes from the camera's, in degrees, and heights in metres, (n,) each.
Coordinates = Callable[[Floats, Floats, Floats], Floats]

#: Highest degree that is tried.
_HIGHEST_DEGREE = 6
#: Points of a ray that polynomials are fitted to, and points in between at which they are compared.
_FITTED, _COMPARED = 8, 13
#: Degree of the ways of single rays, and metres up to which one less is as good: third powers over R squared.
_SEPARATE, _SHORT_M = 3, 2_000.0
#: Factor on the largest difference found for points that are not looked at.
_BETWEEN = 2.0


@dataclass(frozen=True, eq=False)
class Paths:
    """Coordinates along the rays of a camera, as polynomials; made by `fitted`.

    The ray of direction d reaches the point t·d from the camera. A coordinate is a polynomial in the three parts of
    that, so along one ray a polynomial in t, whose coefficient of tᵏ is a form of degree k in d.

    Parameters
    ----------
    start : array (c,)
        Coordinates of the camera.
    forms : tuple of array (c, m)
        Factors of the monomials of degree 1, 2, …
    """

    start: Floats
    forms: tuple[Floats, ...]

    @property
    def degree(self) -> int:
        """Highest power of t."""
        return len(self.forms)

    def coefficients(self, rays_enu: Floats) -> Floats:
        """Of t, t², … along rays (n, 3): (degree, c, n)."""
        powers = (_monomials(rays_enu, degree) for degree in range(1, self.degree + 1))
        return np.stack([form @ monomials for form, monomials in zip(self.forms, powers)])

    def at(self, rays_enu: Floats, t: Floats) -> Floats:
        """Coordinates (c, n) at t (n,) along rays (n, 3)."""
        return along(self.start, self.coefficients(rays_enu), t)


def along(start: Floats, coefficients: Floats, t: Floats) -> Floats:
    """Coordinates (c, n) at t (n,), of coefficients (degree, c, n); ``start`` is (c,), or (c, n) of each ray's own."""
    total: Floats = coefficients[-1] * t
    for term in coefficients[-2::-1]:
        total = (total + term) * t
    total += start if start.ndim == total.ndim else start[..., np.newaxis]
    return total


def separate(
    lat_deg: Floats,
    height_m: Floats,
    rays_enu: Floats,
    farthest: Floats,
    ends: tuple[Floats, Floats, Floats],
    coordinates: Coordinates,
) -> tuple[Floats, Floats]:
    """Ways of rays of as many cameras, each a polynomial of its own.

    Parameters
    ----------
    lat_deg, height_m : array (n,)
        Of the cameras.
    rays_enu : array (n, 3)
    farthest : array (n,)
        t up to which each is followed.
    ends : tuple of array (n,)
        Latitudes, longitudes from each one's camera, and heights of the points there.
    coordinates : callable
        Of such positions; (n, c).

    Returns
    -------
    start : array (c, n)
    coefficients : array (degree, c, n)
        Of t, t², … : through the cameras, the ends and points between, so that little is left.
    """
    start = coordinates(lat_deg, np.zeros_like(lat_deg), height_m).T
    longest = float((farthest * np.linalg.norm(rays_enu, axis=1)).max())
    degree = _SEPARATE if longest > _SHORT_M else _SEPARATE - 1
    shares = (np.arange(degree) + 1.0) / degree
    values = []
    for share in shares[:-1]:
        points = (share * farthest)[:, np.newaxis] * rays_enu
        values.append(coordinates(*positions(lat_deg, height_m, points)).T - start)
    values.append(coordinates(*ends).T - start)
    inverse = np.linalg.inv(np.vander(shares, degree + 1, increasing=True)[:, 1:])
    powers = np.arange(degree) + 1.0
    coefficients: Floats = np.einsum("ij,jcn->icn", inverse, np.stack(values))
    return start, coefficients / farthest ** powers[:, np.newaxis, np.newaxis]


def fitted(
    lat_deg: float,
    height_m: float,
    rays_enu: Floats,
    farthest: Floats,
    coordinates: Coordinates,
    tolerances: Floats,
    ground: Ellipsoid = WGS84,
) -> tuple[Paths, Floats]:
    """Fit paths of the least degree that is exact enough.

    Parameters
    ----------
    lat_deg, height_m : float
        Of the camera, the height over ``ground``.
    rays_enu : array (n, 3)
        Rays that others lie between.
    farthest : array (n,)
        t up to which each is followed.
    coordinates : callable
        What the polynomials stand for.
    tolerances : array (c,)
        What each coordinate may be off by at t, per unit of t.

    Returns
    -------
    Paths, array (c,)
        The latter what each may be off by, per unit of t; more than asked for where no degree is exact enough.
    """
    start = coordinates(*(np.array([value]) for value in (lat_deg, 0.0, height_m)))[0]
    points, wanted = _points(lat_deg, height_m, rays_enu, farthest, _FITTED, coordinates, ground)
    tried, true = _points(lat_deg, height_m, rays_enu, farthest, _COMPARED, coordinates, ground)
    scale = np.abs(points).max(axis=0)
    # Per unit of t, by which errors are told.
    per_t, per_t_tried = (1.0 / np.linalg.norm(offsets, axis=1) for offsets in (points, tried))
    tried_degrees: list[tuple[Paths, Floats]] = []
    for degree in range(1, _HIGHEST_DEGREE + 1):
        columns = [_monomials(points / scale, k) for k in range(1, degree + 1)]
        system = np.concatenate(columns).T * per_t[:, np.newaxis]
        found = np.linalg.lstsq(system, (wanted - start) * per_t[:, np.newaxis], rcond=None)[0].T
        ends = np.cumsum([len(column) for column in columns])[:-1]
        forms = tuple(
            form / _monomials(scale[np.newaxis], k + 1)[:, 0]
            for k, form in enumerate(np.split(found, ends, axis=1))
        )
        paths = Paths(start, forms)
        off = np.abs(paths.at(tried, np.ones(len(tried))).T - true) * per_t_tried[:, np.newaxis]
        residual = _BETWEEN * off.max(axis=0) * np.linalg.norm(rays_enu, axis=1).max()
        tried_degrees.append((paths, residual))
        if (residual <= tolerances).all():
            break
    return min(tried_degrees, key=lambda one: float((one[1] / tolerances).max()))


def _points(
    lat_deg: float,
    height_m: float,
    rays_enu: Floats,
    farthest: Floats,
    count: int,
    coordinates: Coordinates,
    ground: Ellipsoid,
) -> tuple[Floats, Floats]:
    """Points (n, 3) along rays from the camera, and their coordinates (n, c)."""
    shares = (1.0 - np.cos(np.pi * (np.arange(count) + 1.0) / (count + 0.5))) / 2.0
    points = ((shares[:, np.newaxis] * farthest)[..., np.newaxis] * rays_enu).reshape(-1, 3)
    lat, dlon, height = positions(np.array(lat_deg), np.array(height_m), points, ground)
    return points, coordinates(lat, dlon, height)


def _monomials(vectors: Floats, degree: int) -> Floats:
    """Products of ``degree`` parts of vectors (n, 3), each once: (m, n)."""
    parts = vectors.T
    return np.stack(
        [np.prod(parts[list(chosen)], axis=0) for chosen in combinations_with_replacement(range(3), degree)]
    )
