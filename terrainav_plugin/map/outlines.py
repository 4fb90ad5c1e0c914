"""What a plan draws on the map: footprints and the flight line in EPSG:3857, cut at the antimeridian. On any thread."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

import numpy as np
from qgis.core import (
    QgsGeometry,
    QgsLineString,
    QgsMultiLineString,
    QgsMultiPolygon,
    QgsPolygon,
    QgsRectangle,
)

from ...core.geodesy.mercator import HALF_WORLD_M, MAX_LAT_DEG, lat_to_v, lon_to_u
from ...core.mission.export.rings import footprint_ring, line_parts, split_at_antimeridian
from ...core.mission.shape import cut_half_plane

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...core.mission.plan import Plan

    Floats = NDArray[np.float64]

#: Degrees of a great circle from which on the edges of a footprint are drawn with their bend: below, a straight one is
#: within 3 m, a thousandth of its length, of the true one.
_BENT_DEG = 0.1
#: A centimetre from the poles, which are infinitely far away on the map.
_FARTHEST_DEG = 90.0 - 1e-7


def footprint_shapes(plan: Plan) -> Iterator[QgsGeometry]:
    """What each picture shows: the frame that its file will state, or the ground that the camera sees."""
    if plan.size_px is not None:
        yield from camera_outlines(plan)
        return
    for edges in zip(*(edge.tolist() for edge in plan.edges_m)):
        yield _rectangle(*edges)


def camera_outlines(plan: Plan) -> Iterator[QgsGeometry]:
    """Footprint of each camera frame, in EPSG:3857; in several parts where it crosses the antimeridian.

    Where the horizon or a pole is in the picture, the footprint ends there; what lies beyond the map is cut off.
    """
    first, run = plan.poses.runs()
    corners = plan.corners
    wide_deg = np.ptp(corners.lon_deg, axis=1) * np.cos(np.radians(plan.lat_deg))
    large = np.maximum(np.ptp(corners.lat_deg, axis=1), wide_deg) > _BENT_DEG
    bent = (large | ~corners.hit.all(axis=1) | (plan.poles != 0)).tolist()
    west, east = corners.lon_deg.min(axis=1), corners.lon_deg.max(axis=1)
    off_map = (np.abs(corners.lat_deg).max(axis=1) > MAX_LAT_DEG) | (west < -180.0) | (east > 180.0)
    # Corners come clockwise, as the plain polygons of most maps do.
    corner_x, corner_y = metres(corners.lon_deg, np.clip(corners.lat_deg, -MAX_LAT_DEG, MAX_LAT_DEG))
    shared: dict[int, tuple[Floats, Floats]] = {}
    for index, (is_bent, is_off) in enumerate(zip(bent, off_map.tolist())):
        if is_bent:
            # Captures of one row differ in longitude alone.
            start = int(first[run[index]])
            if start not in shared:
                shared = {start: bent_ring(plan, start)}
            lon, lat = shared[start]
            yield ring_polygon(lon + (plan.lon_deg[index] - plan.lon_deg[start]), lat)
        elif is_off:
            yield ring_polygon(corners.lon_deg[index], corners.lat_deg[index])
        else:
            yield _whole(corner_x[index], corner_y[index])


def bent_ring(plan: Plan, index: int) -> tuple[Floats, Floats]:
    """Longitudes, continuous, and latitudes of a capture's footprint, its edges with their bend."""
    if plan.corners.hit[index].all() and not plan.poles[index]:
        seen = plan.outline(index)
        return seen.dlon_deg + plan.lon_deg[index], seen.lat_deg
    return footprint_ring(plan, index)


def ring_polygon(lon_deg: Floats, lat_deg: Floats) -> QgsGeometry:
    """Polygons of a ring, cut at the ends of the map."""
    lon, lat = cut_half_plane(lon_deg, lat_deg, 1, MAX_LAT_DEG, -1.0)
    lon, lat = cut_half_plane(lon, lat, 1, -MAX_LAT_DEG, 1.0)
    parts = QgsMultiPolygon()
    for part_lon, part_lat in split_at_antimeridian(lon, lat) if len(lon) >= 3 else ():
        parts.addGeometry(surface(*metres(part_lon, part_lat)))
    geometry = QgsGeometry(parts)
    # A ring cut in two may keep its halves joined along the cut.
    return geometry if geometry.isGeosValid() else geometry.makeValid()


def surface(x_m: Floats, y_m: Floats) -> QgsPolygon:
    """Polygon of a ring, closed or not."""
    line = QgsLineString(np.asarray(x_m).tolist(), np.asarray(y_m).tolist())
    line.close()
    return QgsPolygon(line)


def flight_lines(runs: Iterable[tuple[Floats, Floats]]) -> QgsGeometry:
    """Ways through longitudes and latitudes in their order, from each place to the next the shorter way around."""
    lines = QgsMultiLineString()
    for lon_deg, lat_deg in runs:
        for lon, lat, _ in line_parts(lon_deg, lat_deg, np.zeros(len(lon_deg))):
            # A single capture is no line.
            if len(lon) > 1:
                x, y = metres(lon, lat)
                lines.addGeometry(QgsLineString(x.tolist(), y.tolist()))
    return QgsGeometry(lines)


def metres(lon_deg: Floats, lat_deg: Floats) -> tuple[Floats, Floats]:
    """Easting and northing in EPSG:3857 of longitudes (not wrapped) and latitudes; finite at the poles, too."""
    lat = np.clip(np.asarray(lat_deg, np.float64), -_FARTHEST_DEG, _FARTHEST_DEG)
    east = (2.0 * lon_to_u(np.asarray(lon_deg, np.float64)) - 1.0) * HALF_WORLD_M
    north = (1.0 - 2.0 * lat_to_v(lat)) * HALF_WORLD_M
    return east, north


def _rectangle(west: float, south: float, east: float, north: float) -> QgsGeometry:
    """Rectangle, in two parts where it crosses the antimeridian."""
    world_m = 2.0 * HALF_WORLD_M
    shift = world_m * ((west + HALF_WORLD_M) // world_m)
    west, east = west - shift, east - shift
    if east <= HALF_WORLD_M:
        return QgsGeometry.fromRect(QgsRectangle(west, south, east, north))
    parts = QgsMultiPolygon()
    for left, right in ((west, HALF_WORLD_M), (-HALF_WORLD_M, east - world_m)):
        parts.addGeometry(surface([left, left, right, right], [south, north, north, south]))
    return QgsGeometry(parts)


def _whole(x_m: Floats, y_m: Floats) -> QgsGeometry:
    parts = QgsMultiPolygon()
    parts.addGeometry(surface(x_m, y_m))
    return QgsGeometry(parts)
