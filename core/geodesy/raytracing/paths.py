"""Paths of rays in map coordinates: plane position and height above the ellipsoid, as polynomials of distance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np

from ...arrays import Floats
from ..ellipsoid import WGS84, Ellipsoid, positions

#: Function that returns coordinates (n, c) for latitudes and differences of longitude from the camera, in degrees, and
#: heights in metres.
Coordinates = Callable[[Floats, Floats, Floats], Floats]


@dataclass(frozen=True, eq=False)
class Paths:
    """Coordinates along the rays of a camera, as polynomials; made by `fit_paths`.

    A ray of direction d reaches the point t·d from the camera. Each coordinate is a polynomial in the components of
    t·d: along one ray it is a polynomial in t, whose coefficient of tᵏ is a form of degree k in d.

    Parameters
    ----------
    start : array (c,)
        Coordinates of the camera.
    forms : tuple of array (c, m)
        Coefficients of the monomials of degree 1, 2, …
    """

    start: Floats
    forms: tuple[Floats, ...]

    @property
    def degree(self) -> int:
        """Highest power of t."""
        return len(self.forms)

    def coefficients(self, rays_enu: Floats) -> Floats:
        """Coefficients of t, t², … along rays (n, 3): (degree, c, n)."""
        powers = (_monomials(rays_enu, degree) for degree in range(1, self.degree + 1))
        return np.stack([form @ monomials for form, monomials in zip(self.forms, powers)])

    def evaluate(self, rays_enu: Floats, t: Floats) -> Floats:
        """Coordinates (c, n) at t (n,) along rays (n, 3)."""
        return evaluate(self.start, self.coefficients(rays_enu), t)


def evaluate(start: Floats, coefficients: Floats, t: Floats) -> Floats:
    """Coordinates (c, n) at t (n,) of polynomials (degree, c, n); ``start`` is (c,), or (c, n) where rays differ."""
    total: Floats = coefficients[-1] * t
    for term in coefficients[-2::-1]:
        total = (total + term) * t
    total += start if start.ndim == total.ndim else start[..., np.newaxis]
    return total


def interpolate_rays(
    lat_deg: Floats,
    height_m: Floats,
    rays_enu: Floats,
    farthest: Floats,
    ends: tuple[Floats, Floats, Floats],
    coordinates: Coordinates,
) -> tuple[Floats, Floats]:
    """Interpolate rays, each of a different camera, by polynomials.

    The polynomials pass through the camera, the end and equidistant points between. They are cubic, or quadratic if no
    ray is longer than 2 km, as the next term grows with the third power of the length over R².

    Parameters
    ----------
    lat_deg, height_m : array (n,)
        Positions of the cameras.
    rays_enu : array (n, 3)
    farthest : array (n,)
        t up to which each ray is followed.
    ends : tuple of array (n,)
        Latitudes, differences of longitude from the camera, and heights of the points at ``farthest``.
    coordinates : callable
        Function that returns coordinates (n, c) of positions.

    Returns
    -------
    start : array (c, n)
    coefficients : array (degree, c, n)
        Coefficients of t, t², …
    """
    start = coordinates(lat_deg, np.zeros_like(lat_deg), height_m).T
    longest = float((farthest * np.linalg.norm(rays_enu, axis=1)).max())
    degree = 3 if longest > 2_000.0 else 2
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


def fit_paths(
    lat_deg: float,
    height_m: float,
    rays_enu: Floats,
    farthest: Floats,
    coordinates: Coordinates,
    tolerances: Floats,
    ground: Ellipsoid = WGS84,
) -> tuple[Paths, Floats]:
    """Fit paths of the lowest degree that is accurate enough.

    Parameters
    ----------
    lat_deg, height_m : float
        Position of the camera, with its height above ``ground``.
    rays_enu : array (n, 3)
        Rays that enclose all others.
    farthest : array (n,)
        t up to which each ray is followed.
    coordinates : callable
        Function that returns the coordinates to fit.
    tolerances : array (c,)
        Largest error of each coordinate at t, per unit of t.

    Returns
    -------
    Paths, array (c,)
        Paths, and a bound of the error of each coordinate per unit of t; it exceeds ``tolerances`` if no degree up to 6
        is accurate enough.
    """
    start = coordinates(*(np.array([value]) for value in (lat_deg, 0.0, height_m)))[0]
    points, wanted = _points(lat_deg, height_m, rays_enu, farthest, 8, coordinates, ground)
    tried, true = _points(lat_deg, height_m, rays_enu, farthest, 13, coordinates, ground)
    scale = np.abs(points).max(axis=0)
    per_t, per_t_tried = (1.0 / np.linalg.norm(offsets, axis=1) for offsets in (points, tried))
    tried_degrees: list[tuple[Paths, Floats]] = []
    for degree in range(1, 7):
        columns = [_monomials(points / scale, k) for k in range(1, degree + 1)]
        system = np.concatenate(columns).T * per_t[:, np.newaxis]
        found = np.linalg.lstsq(system, (wanted - start) * per_t[:, np.newaxis], rcond=None)[0].T
        ends = np.cumsum([len(column) for column in columns])[:-1]
        forms = tuple(
            form / _monomials(scale[np.newaxis], k + 1)[:, 0] for k, form in enumerate(np.split(found, ends, axis=1))
        )
        paths = Paths(start, forms)
        off = np.abs(paths.evaluate(tried, np.ones(len(tried))).T - true) * per_t_tried[:, np.newaxis]
        # Between the compared points, errors are at most twice as large.
        residual = 2.0 * off.max(axis=0) * np.linalg.norm(rays_enu, axis=1).max()
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
    """All monomials (m, n) of one degree in the components of vectors (n, 3)."""
    parts = vectors.T
    return np.stack(
        [np.prod(parts[list(chosen)], axis=0) for chosen in combinations_with_replacement(range(3), degree)]
    )
