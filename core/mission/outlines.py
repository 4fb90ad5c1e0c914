"""Geometries of a plan: pictures, footprints and lines, cut at the antimeridian and at the ends of the map.

The preview, Processing's layers and exported files draw these geometries: in degrees for files (RFC 7946), in metres of
EPSG:3857 for maps. Rings run counter-clockwise and are not closed.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arrays import Floats, NDArray
from ..geodesy.mercator import HALF_WORLD_M, MAX_LAT_DEG, lat_to_v, lon_to_u
from ..geodesy.planes import ProjectedPlane
from .areas.area import cut_half_plane
from .plan import Plan

#: Horizontal and vertical coordinates of corners, (k,) each.
Ring = tuple[Floats, Floats]

_ALL = slice(None)


def metres(lon_deg: Floats, lat_deg: Floats) -> Ring:
    """Project longitudes (not wrapped) and latitudes, any shape, to EPSG:3857; finite at the poles."""
    # A centimetre from the poles, which the map shows at infinity.
    farthest_deg = 90.0 - 1e-7
    lat = np.clip(np.asarray(lat_deg, np.float64), -farthest_deg, farthest_deg)
    east = (2.0 * lon_to_u(np.asarray(lon_deg, np.float64)) - 1.0) * HALF_WORLD_M
    return east, (1.0 - 2.0 * lat_to_v(lat)) * HALF_WORLD_M


def pictures_m(plan: Plan, part: slice = _ALL) -> Iterator[list[Ring]]:
    """Outline of each picture in the CRS of the plan's grid: its map frame, as its file states it, or its footprint.

    Footprints are cut at the ends of the map, which may leave nothing.

    Yields
    ------
    list of (easting, northing)
        Rings of one picture; several where it crosses the antimeridian.
    """
    plane = plan.grid.plane
    if plan.frames.on_map:
        for edges in zip(*(edge[part].tolist() for edge in plan.edges)):
            yield _rectangles(*edges) if plane.wraps else [_rectangle(*edges)]
        return
    if isinstance(plane, ProjectedPlane):
        for index in range(*part.indices(len(plan))):
            x, y = plane.to_crs(*_ground_seen(plan, index)[::-1])
            reached = np.isfinite(x)
            yield [(x[reached], y[reached])] if reached.sum() > 2 else []
        return
    corners = plan.corners
    lon, lat = corners.lon_deg[part], corners.lat_deg[part]
    on_map = (np.abs(lat).max(axis=1) <= MAX_LAT_DEG) & (lon.min(axis=1) >= -180.0) & (lon.max(axis=1) <= 180.0)
    straight = _straight(plan, part)
    plain = on_map & straight
    east, north = metres(lon[:, ::-1], np.clip(lat[:, ::-1], -MAX_LAT_DEG, MAX_LAT_DEG))
    for index, at in enumerate(range(*part.indices(len(plan)))):
        if plain[index]:
            yield [(east[index], north[index])]
        else:
            ring = _footprint(plan, at, straight=bool(straight[index]))
            yield [metres(*inside) for inside in cut_at_antimeridian(*_clipped_to_map(*ring))]


def footprints_deg(plan: Plan, part: slice = _ALL) -> Iterator[list[Ring]]:
    """Ground that each camera sees, as longitudes and latitudes; several rings where it crosses ±180°."""
    straight = _straight(plan, part).tolist()
    for index, at in enumerate(range(*part.indices(len(plan)))):
        yield cut_at_antimeridian(*_footprint(plan, at, straight=straight[index]))


def cut_at_antimeridian(lon_deg: Floats, lat_deg: Floats) -> list[Ring]:
    """Cut a ring at ±180° into rings that do not cross it (RFC 7946, section 3.1.9).

    Parameters
    ----------
    lon_deg, lat_deg : array (n,)
        Ring without its closing corner, longitudes continuous; fewer than 3 corners give no ring.
    """
    if len(lon_deg) < 3:
        return []
    low, high = float(lon_deg.min()), float(lon_deg.max())
    if low >= -180.0 and high <= 180.0:
        return [(lon_deg, lat_deg)]
    first = int(np.floor((low + 180.0) / 360.0))
    last = int(np.ceil((high + 180.0) / 360.0))
    rings = []
    for turn in range(first, max(last, first + 1)):
        west = 360.0 * turn - 180.0
        lon, lat = cut_half_plane(*cut_half_plane(lon_deg, lat_deg, 0, west, 1.0), 0, west + 360.0, -1.0)
        if len(lon) >= 3 and float(lon.max()) > float(lon.min()):
            rings.append((np.clip(lon - 360.0 * turn, -180.0, 180.0), lat))
    return rings


def cut_line(lon_deg: Floats, *values: Floats) -> list[tuple[Floats, ...]]:
    """Cut a line at ±180°; each leg takes the shorter way around.

    Parameters
    ----------
    lon_deg : array (n,)
    values : array (n,) each
        Latitudes, heights and other values that are interpolated along a leg.

    Returns
    -------
    list of (longitudes, values ...)
        Parts of at least two places, longitudes within ±180; a line of one place is one part.
    """
    lon = np.unwrap(np.asarray(lon_deg, np.float64), period=360.0)
    turn = np.floor((lon + 180.0) / 360.0)
    leaves = np.flatnonzero(np.diff(turn))
    # Longitude of each crossing, and its share of the length of its leg.
    edge = 360.0 * np.maximum(turn[leaves], turn[leaves + 1]) - 180.0
    share = (edge - lon[leaves]) / (lon[leaves + 1] - lon[leaves])
    crossings = [edge, *(row[leaves] + share * (row[leaves + 1] - row[leaves]) for row in values)]
    parts = []
    for number, (first, last) in enumerate(zip([0, *(leaves + 1)], [*(leaves + 1), len(lon)])):
        come, go = slice(max(number - 1, 0), number), slice(number, number + 1)
        part_lon, *rest = (
            np.concatenate([crossing[come], row[first:last], crossing[go]])
            for crossing, row in zip(crossings, (lon, *values))
        )
        parts.append((part_lon - 360.0 * turn[first], *rest))
    return parts


def _footprint(plan: Plan, index: int, *, straight: bool) -> Ring:
    """Ring of a footprint, from its four corners if its edges are ``straight``."""
    if straight:
        # Corners come as north-west, north-east, south-east, south-west: clockwise.
        return plan.corners.lon_deg[index, ::-1], plan.corners.lat_deg[index, ::-1]
    pole = plan.views.outline(index).pole
    lon, lat = _ground_seen(plan, index)
    return _around_pole(lon, lat, pole) if pole else (lon, lat)


def _ground_seen(plan: Plan, index: int) -> Ring:
    """Outline of a footprint; an outline around a pole is not closed, but ends a whole turn from its start."""
    seen = plan.views.outline(index)
    return seen.dlon_deg + plan.lon_deg[index], seen.lat_deg


def _around_pole(lon_deg: Floats, lat_deg: Floats, pole: int) -> Ring:
    """Ring of an outline around a pole: from ±180° once around, and back along the pole."""
    turn, count = 360.0 * pole, len(lon_deg)
    lon, lat = np.concatenate([lon_deg, lon_deg + turn]), np.concatenate([lat_deg, lat_deg])
    edge = pole * (360.0 * np.ceil((pole * lon[0] + 180.0) / 360.0) - 180.0)
    after = int(np.argmax(pole * (lon - edge) > 0.0))
    share = (edge - lon[after - 1]) / (lon[after] - lon[after - 1])
    at_edge = lat[after - 1] + share * (lat[after] - lat[after - 1])
    lon, lat = lon[after : after + count], lat[after : after + count]
    inside = pole * (edge + turn - lon) > 0.0
    return (
        np.concatenate([[edge], lon[inside], [edge + turn, edge + turn, edge]]),
        np.concatenate([[at_edge], lat[inside], [at_edge], [90.0 * pole] * 2]),
    )


def _straight(plan: Plan, part: slice) -> NDArray[np.bool_]:
    """Which footprints may be drawn by their four corners alone."""
    lat, lon, hit = (values[part] for values in plan.corners)
    wide_deg = np.ptp(lon, axis=1) * np.cos(np.radians(plan.lat_deg[part]))
    # Edges of up to 0.1 degrees are straight to within 3 m, in degrees and on the map.
    small = np.maximum(np.ptp(lat, axis=1), wide_deg) < 0.1
    if not plan.grid.plane.wraps:
        # Near a pole, where the map does not reach, a straight edge misses the true one by an eighth of its turn.
        small &= np.ptp(lon, axis=1) < 0.5
    # Relief bends every edge, and so does a lens that distorts.
    bends = plan.cameras.distort or not plan.relief.is_level
    return np.asarray(small & hit.all(axis=1) & (plan.views.poles[part] == 0) & (not bends))


def _rectangles(west: float, south: float, east: float, north: float) -> list[Ring]:
    """Rectangle in EPSG:3857, split in two where it crosses the antimeridian."""
    world_m = 2.0 * HALF_WORLD_M
    shift = world_m * ((west + HALF_WORLD_M) // world_m)
    spans = [(west - shift, min(east - shift, HALF_WORLD_M))]
    if east - shift > HALF_WORLD_M:
        spans.append((-HALF_WORLD_M, east - shift - world_m))
    return [_rectangle(left, south, right, north) for left, right in spans]


def _rectangle(west: float, south: float, east: float, north: float) -> Ring:
    return np.array([west, east, east, west]), np.array([south, south, north, north])


def _clipped_to_map(lon_deg: Floats, lat_deg: Floats) -> Ring:
    """Part of a ring within the latitudes of the map; empty where the ring lies beyond."""
    lon, lat = cut_half_plane(lon_deg, lat_deg, 1, MAX_LAT_DEG, -1.0)
    return cut_half_plane(lon, lat, 1, -MAX_LAT_DEG, 1.0)
