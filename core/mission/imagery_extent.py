"""How much of a mission lies where its source has imagery."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geodesy.ellipsoid import WGS84
from ..geodesy.frames import Windows
from ..geodesy.mercator import PixelGrid, lat_to_v, lon_to_u, u_to_lon, v_to_lat
from .area import Area, Box, Points, Polygon

Floats = NDArray[np.float64]

#: What rounding moves a picture's edge by, px: one that reaches beyond the imagery by no more lies inside.
_ROUNDED_PX = 0.5
#: Share of the area below which nothing is missing: the noise of areas worked out along two ways.
_NOTHING_MISSING = 1e-9


class Imagery(NamedTuple):
    """What a source has imagery of.

    Attributes
    ----------
    share : float or None
        Of the mission's area; None for points.
    outside, partly : int
        Pictures that show nothing of it, and that show also ground without it.
    """

    share: float | None
    outside: int
    partly: int


def imagery_of(area: Area, windows: Windows, grid: PixelGrid, zoom: int) -> Imagery:
    """What of an area, and of pictures over it, lies on the extent of the source's imagery."""
    whole = None if isinstance(area, Points) else 1.0
    if grid.extent is None:
        return Imagery(whole, 0, 0)
    extent = np.array(grid.extent, np.float64)
    extent = extent if _twice_area(extent) > 0.0 else extent[::-1]
    outside, partly = _pictures_beyond(windows, extent, grid.world_px(zoom))
    share = None if isinstance(area, Points) else _share(_rings(area), extent)
    return Imagery(share, outside, partly)


def _rings(area: Box | Polygon) -> list[tuple[Floats, Floats]]:
    if isinstance(area, Polygon):
        return area.arrays()
    west, east, north, south = area.west_deg, area.continuous_east_deg, area.north_deg, area.south_deg
    return [(np.array([west, east, east, west]), np.array([north, north, south, south]))]


def _twice_area(ring: Floats) -> float:
    following = np.roll(ring, -1, axis=0)
    return float(np.sum(ring[:, 0] * following[:, 1] - following[:, 0] * ring[:, 1]))


def _turns(u: Floats, extent: Floats) -> Floats:
    """Extents that may be under world fractions, whole turns of the world apart: their moves."""
    first = np.floor(float(u.min()) - float(extent[:, 0].max()))
    last = np.ceil(float(u.max()) - float(extent[:, 0].min()))
    return np.arange(first, last + 1.0)


def _pictures_beyond(windows: Windows, extent: Floats, world_px: int) -> tuple[int, int]:
    """Pictures outside an extent (positively oriented), and partly so."""
    left, top, right, bottom = (edge / world_px for edge in windows.bounds_px)
    room = _ROUNDED_PX / world_px
    inside, touched = np.zeros(len(left), bool), np.zeros(len(left), bool)
    for turn in _turns(np.concatenate([left, right]), extent):
        corners = extent + np.array([turn, 0.0])
        (west, north), (east, south) = corners.min(axis=0), corners.max(axis=0)
        held = np.ones(len(left), bool)
        meets = (left < east - room) & (right > west + room) & (top < south - room) & (bottom > north + room)
        for (u, v), (next_u, next_v) in zip(corners, np.roll(corners, -1, axis=0)):
            # Distance inward of a side, at the corners of each picture that lie farthest in and farthest out.
            inward_u, inward_v = np.array([v - next_v, next_u - u]) / max(
                np.hypot(next_u - u, next_v - v), 1e-300
            )
            ends_u = np.sort([inward_u * (left - u), inward_u * (right - u)], axis=0)
            ends_v = np.sort([inward_v * (top - v), inward_v * (bottom - v)], axis=0)
            held &= ends_u[0] + ends_v[0] >= -room
            meets &= ends_u[1] + ends_v[1] > room
        inside |= held
        touched |= meets
    return int(np.sum(~(touched | inside))), int(np.sum(touched & ~inside))


def _share(rings: list[tuple[Floats, Floats]], extent: Floats) -> float:
    """Share of an area, whose outer ring comes first, that lies on an extent (positively oriented)."""
    total = held = 0.0
    for sign, (lon, lat) in zip((1.0, *(-1.0 for _ in rings[1:])), rings):
        total += sign * WGS84.ring_area_m2(lon, lat)
        on_map = np.stack([lon_to_u(lon), lat_to_v(lat)], axis=1)
        for turn in _turns(on_map[:, 0], extent):
            part = _cut(on_map, extent + np.array([turn, 0.0]))
            if len(part) > 2:
                held += sign * WGS84.ring_area_m2(u_to_lon(part[:, 0]), v_to_lat(part[:, 1]))
    share = held / total if total > 0.0 else 1.0
    return 1.0 if share > 1.0 - _NOTHING_MISSING else max(share, 0.0)


def _cut(ring: Floats, convex: Floats) -> Floats:
    """Ring inside a convex one that is positively oriented (Sutherland and Hodgman's clipping)."""
    for corner, following in zip(convex, np.roll(convex, -1, axis=0)):
        along = following - corner
        depth = along[0] * (ring[:, 1] - corner[1]) - along[1] * (ring[:, 0] - corner[0])
        after, there = np.roll(ring, -1, axis=0), np.roll(depth, -1)
        cross = (depth >= 0.0) != (there >= 0.0)
        share = np.where(cross, depth / np.where(cross, depth - there, 1.0), 0.0)
        both = np.stack([ring, ring + share[:, np.newaxis] * (after - ring)], axis=1).reshape(-1, 2)
        ring = both[np.stack([depth >= 0.0, cross], axis=1).ravel()]
        if len(ring) < 3:
            return ring[:0]
    return ring
