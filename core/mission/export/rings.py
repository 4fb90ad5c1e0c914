"""Footprints and flight lines as longitudes and latitudes, cut at the antimeridian."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..plan import Plan
from ..shape import cut_half_plane

Floats = NDArray[np.float64]
Ring = list[tuple[float, float]]

#: Height in degrees up to which a footprint's edges are as good as straight in longitude and latitude: at middle
#: latitudes they leave their chord by some 1e-4 of their length.
_STRAIGHT_DEG = 0.1


def split_at_antimeridian(lon_deg: Floats, lat_deg: Floats) -> list[tuple[Floats, Floats]]:
    """Ring cut where it crosses ±180°, each part within them (RFC 7946, section 3.1.9).

    Parameters
    ----------
    lon_deg, lat_deg : array (n,)
        Ring without its closing corner; longitudes continuous.
    """
    first = int(np.floor((lon_deg.min() + 180.0) / 360.0))
    last = int(np.ceil((lon_deg.max() + 180.0) / 360.0))
    parts = []
    for turn in range(first, max(last, first + 1)):
        west = 360.0 * turn - 180.0
        lon, lat = cut_half_plane(*cut_half_plane(lon_deg, lat_deg, 0, west, 1.0), 0, west + 360.0, -1.0)
        if len(lon) >= 3 and float(lon.max()) > float(lon.min()):
            parts.append((np.clip(lon - 360.0 * turn, -180.0, 180.0), lat))
    return parts


def footprint_ring(plan: Plan, index: int) -> tuple[Floats, Floats]:
    """Longitudes (continuous) and latitudes of a capture's footprint, counter-clockwise, not closed.

    Its corners; where it is so large that its edges are bent on a map, or the horizon or a pole is in the picture,
    the outline of what is seen. Around a pole that goes once around the world and back along the pole's parallel.
    """
    small = np.ptp(plan.corners.lat_deg[index]) < _STRAIGHT_DEG
    if small and plan.corners.hit[index].all() and not plan.poles[index]:
        # Corners come as north-west, north-east, south-east, south-west: clockwise.
        return plan.corners.lon_deg[index, ::-1], plan.corners.lat_deg[index, ::-1]
    seen = plan.outline(index)
    lon, lat = seen.dlon_deg + plan.lon_deg[index], seen.lat_deg
    if seen.pole:
        turn = 360.0 * seen.pole
        lon = np.concatenate([lon, lon[:1] + turn, lon[:1] + turn, lon[:1]])
        lat = np.concatenate([lat, lat[:1], [90.0 * seen.pole] * 2])
    return lon, lat


def closed_rings(plan: Plan, part: slice) -> Iterator[list[Ring]]:
    """Closed rings, counter-clockwise, of each capture's footprint; several where it crosses ±180°."""
    for index in range(*part.indices(len(plan))):
        lon, lat = footprint_ring(plan, index)
        inside = lon.min() >= -180.0 and lon.max() <= 180.0
        pieces = [(lon, lat)] if inside else split_at_antimeridian(lon, lat)
        yield [[*zip(x.tolist(), y.tolist()), (float(x[0]), float(y[0]))] for x, y in pieces]


def line_parts(lon_deg: Floats, lat_deg: Floats, agl_m: Floats) -> list[tuple[Floats, Floats, Floats]]:
    """Line through places in their order, cut where it crosses ±180°; from each to the next the shorter way around.

    Parameters
    ----------
    lon_deg, lat_deg, agl_m : array (n,)

    Returns
    -------
    list of (lon_deg, lat_deg, agl_m)
        Parts of two places or more, longitudes within ±180; one part of one place where there is but one.
    """
    lon = np.unwrap(np.asarray(lon_deg, np.float64), period=360.0)
    turn = np.floor((lon + 180.0) / 360.0)
    leaves = np.flatnonzero(np.diff(turn))
    # Where each leg that crosses meets the antimeridian, and the height there.
    edge = 360.0 * np.maximum(turn[leaves], turn[leaves + 1]) - 180.0
    share = (edge - lon[leaves]) / (lon[leaves + 1] - lon[leaves])
    at = [values[leaves] + share * (values[leaves + 1] - values[leaves]) for values in (lat_deg, agl_m)]
    parts = []
    for number, (first, last) in enumerate(zip([0, *(leaves + 1)], [*(leaves + 1), len(lon)])):
        own = 360.0 * turn[first]
        columns = [lon[first:last] - own, lat_deg[first:last], agl_m[first:last]]
        for crossing, before in ((number - 1, True), (number, False)):
            if 0 <= crossing < len(leaves):
                ends = [
                    [edge[crossing] - own],
                    at[0][crossing : crossing + 1],
                    at[1][crossing : crossing + 1],
                ]
                pairs = zip(ends, columns) if before else zip(columns, ends)
                columns = [np.concatenate(pair) for pair in pairs]
        parts.append((columns[0], columns[1], columns[2]))
    return parts
