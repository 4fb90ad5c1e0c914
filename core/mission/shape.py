"""A mission's area against bands and rectangles of latitude and longitude."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..geodesy.ellipsoid import WGS84
from ..geodesy.mercator import v_to_lat
from .area import Box, Polygon

Floats = NDArray[np.float64]


class Rings(Protocol):
    """Something of rings, the outer one first, whose sides are straight along two axes: of degrees, or of a plane."""

    def arrays(self) -> list[tuple[Floats, Floats]]:
        """First and second coordinates of each ring's corners."""
        ...


def sides_of(polygon: Rings) -> tuple[Floats, Floats, Floats, Floats]:
    """Start longitude, start latitude, end longitude, end latitude of every side of every ring."""
    rings = polygon.arrays()
    lon0, lat0 = (np.concatenate(parts) for parts in zip(*rings))
    lon1, lat1 = (np.concatenate([np.roll(part, -1) for part in parts]) for parts in zip(*rings))
    return lon0, lat0, lon1, lat1


def in_band(
    edges: tuple[Floats, Floats, Floats, Floats], south: float, north: float
) -> tuple[Floats, Floats]:
    """Least and greatest longitude of what each edge has strictly between two parallels; others left out."""
    lon0, lat0, lon1, lat1 = edges
    inside = (np.maximum(lat0, lat1) > south) & (np.minimum(lat0, lat1) < north)
    lon0, lat0, lon1, lat1 = (part[inside] for part in edges)
    rise = np.where(lat1 == lat0, 1.0, lat1 - lat0)
    slope = (lon1 - lon0) / rise
    ends = []
    for lon, lat in ((lon0, lat0), (lon1, lat1)):
        cut = np.clip(lat, south, north)
        ends.append(np.where(cut == lat, lon, lon0 + slope * (cut - lat0)))
    return np.minimum(*ends), np.maximum(*ends)


def row_spans(area: Box | Polygon, top_v: Floats, bottom_v: Floats) -> Floats:
    """West and east end, in continuous degrees, of what each band of latitude holds of an area.

    Parameters
    ----------
    top_v, bottom_v : array (n,)
        Bands as world fractions southward.

    Returns
    -------
    array (n, 2)
        NaN where a band holds nothing.
    """
    if isinstance(area, Box):
        return np.tile([area.west_deg, area.continuous_east_deg], (len(top_v), 1))
    edges = sides_of(area)
    spans = np.full((len(top_v), 2), np.nan)
    for index, (south, north) in enumerate(zip(v_to_lat(bottom_v), v_to_lat(top_v))):
        west, east = in_band(edges, float(south), float(north))
        if len(west):
            spans[index] = west.min(), east.max()
    return spans


def touching(polygon: Rings, west: Floats, south: Floats, east: Floats, north: Floats) -> NDArray[np.bool_]:
    """Which rectangles of degrees share ground with a polygon (n,); longitudes continuous with it.

    Rectangles of one row (equal south and north, one after the other) are looked at together.
    """
    edges = sides_of(polygon)
    touches = np.zeros(len(west), bool)
    change = np.flatnonzero((np.diff(south) != 0.0) | (np.diff(north) != 0.0)) + 1
    for start, stop in zip([0, *change], [*change, len(west)]):
        row = slice(start, stop)
        low, high = in_band(edges, float(south[start]), float(north[start]))
        crossings = _crossings(edges, float(south[start] + north[start]) / 2.0)
        middle = (west[row] + east[row]) / 2.0
        within = np.searchsorted(crossings, middle) % 2 == 1
        # An edge meets a rectangle unless it ends before it or begins after it.
        before = np.searchsorted(np.sort(high), west[row], side="right")
        after = len(low) - np.searchsorted(np.sort(low), east[row], side="left")
        touches[row] = within | (before + after < len(low))
    return touches


def _crossings(edges: tuple[Floats, Floats, Floats, Floats], lat: float) -> Floats:
    """Sorted longitudes where a parallel crosses the polygon's edges."""
    lon0, lat0, lon1, lat1 = edges
    cross = (lat0 <= lat) != (lat1 <= lat)
    lon0, lat0, lon1, lat1 = (part[cross] for part in edges)
    return np.sort(lon0 + (lat - lat0) * (lon1 - lon0) / (lat1 - lat0))


def area_within_m2(area: Box | Polygon, west: Floats, south: Floats, east: Floats, north: Floats) -> Floats:
    """Square metres of an area inside rectangles of degrees that do not pass its box, (n,)."""
    if isinstance(area, Box):
        return (east - west) * WGS84.zone_area_m2_per_deg(south, north)
    rings = area.arrays()
    sign = (1.0, *(-1.0 for _ in rings[1:]))
    return np.array(
        [
            sum(k * _clipped_ring_m2(lon, lat, rectangle) for k, (lon, lat) in zip(sign, rings))
            for rectangle in zip(west, south, east, north)
        ]
    )


def _clipped_ring_m2(lon: Floats, lat: Floats, rectangle: tuple[float, float, float, float]) -> float:
    """Square metres of a ring inside a rectangle."""
    lon, lat = clipped(lon, lat, rectangle)
    return WGS84.ring_area_m2(lon, lat) if len(lon) else 0.0


def clipped(x: Floats, y: Floats, rectangle: tuple[float, float, float, float]) -> tuple[Floats, Floats]:
    """Ring inside a rectangle of least x, least y, greatest x, greatest y (Sutherland and Hodgman's clipping).

    Without corners where nothing of it is.
    """
    west, south, east, north = rectangle
    for axis, limit, sense in ((0, west, 1.0), (0, east, -1.0), (1, south, 1.0), (1, north, -1.0)):
        x, y = cut_half_plane(x, y, axis, limit, sense)
        if len(x) < 3:
            return x[:0], y[:0]
    return x, y


def cut_half_plane(lon: Floats, lat: Floats, axis: int, limit: float, sense: float) -> tuple[Floats, Floats]:
    """Ring cut by a meridian (axis 0) or parallel (axis 1) at ``limit``, one side of it kept.

    Parameters
    ----------
    lon, lat : array (n,)
        Corners in degrees, not closed.
    sense : float
        1 keeps the side where the coordinate is greater, -1 the other.

    Returns
    -------
    arrays (m,), (m,)
        Corners of what is left; a concave ring's separate pieces stay joined along the cut.
    """
    points = np.stack([lon, lat], axis=1)
    following = np.roll(points, -1, axis=0)
    here = sense * (points[:, axis] - limit)
    there = sense * (following[:, axis] - limit)
    cross = (here >= 0.0) != (there >= 0.0)
    share = np.where(cross, here / np.where(cross, here - there, 1.0), 0.0)
    cuts = points + share[:, np.newaxis] * (following - points)
    cuts[:, axis] = np.where(cross, limit, cuts[:, axis])
    both = np.stack([points, cuts], axis=1).reshape(-1, 2)
    keep = np.stack([here >= 0.0, cross], axis=1).ravel()
    return both[keep, 0], both[keep, 1]
