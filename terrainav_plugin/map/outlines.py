"""Outlines of a plan as QGIS geometries, in the CRS of the source's pixels. On any thread.

In EPSG:3857, outlines are cut at the antimeridian and at the edges of the map; other CRSs have no such edges.
"""

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
    QgsWkbTypes,
)

from ...core.geodesy.mercator import MAX_LAT_DEG
from ...core.geodesy.planes import ProjectedPlane
from ...core.mission.areas.area import cut_half_plane
from ...core.mission.outlines import cut_at_antimeridian, cut_line, metres, pictures_m
from ..compat import POLYGON

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...core.geodesy.mercator import Plane
    from ...core.mission.outlines import Ring
    from ...core.mission.plan import Plan

    Floats = NDArray[np.float64]

__all__ = [
    "CUTS_WKT",
    "flight_lines",
    "footprint_shapes",
    "metres",
    "placed",
    "remove_pole_seams",
    "ring_polygon",
    "seen_edges",
]

#: Lines at which footprints in degrees are cut: the antimeridian and the poles.
CUTS_WKT = "LineString (-180 -90, 180 -90, 180 90, -180 90, -180 -90)"
#: Points within a micrometre count as equal.
_SAME_M = 1e-6


def placed(plane: Plane, lon_deg: Floats, lat_deg: Floats) -> Ring:
    """Coordinates of longitudes (not wrapped) and latitudes, arrays of any shape, in the CRS of a plane.

    Infinite or NaN outside the domain of the CRS.
    """
    return plane.to_crs(lat_deg, lon_deg) if isinstance(plane, ProjectedPlane) else metres(lon_deg, lat_deg)


def footprint_shapes(plan: Plan) -> Iterator[QgsGeometry]:
    """Footprint of each image: the extent of a map frame, or the ground that the camera sees."""
    return map(_polygons, pictures_m(plan))


def ring_polygon(plane: Plane, lon_deg: Floats, lat_deg: Floats) -> QgsGeometry:
    """Polygons of a ring in the CRS of a plane, cut at the edges of the CRS."""
    if isinstance(plane, ProjectedPlane):
        # In degrees, a ring around a pole runs along the pole, which is a point in this CRS: drop corners at the pole.
        kept = np.abs(lat_deg) < (90.0 - 1e-9)
        x, y = plane.to_crs(lat_deg[kept], lon_deg[kept])
        reached = np.isfinite(x)
        shape = _polygons([(x[reached], y[reached])] if reached.sum() > 2 else [])
        return shape if kept.all() else remove_pole_seams(shape)
    lon, lat = cut_half_plane(lon_deg, lat_deg, 1, MAX_LAT_DEG, -1.0)
    lon, lat = cut_half_plane(lon, lat, 1, -MAX_LAT_DEG, 1.0)
    return _polygons([metres(*part) for part in cut_at_antimeridian(lon, lat)])


def flight_lines(plane: Plane, runs: Iterable[tuple[Floats, Floats]]) -> QgsGeometry:
    """Lines through places in order, in the CRS of a plane; each step goes the shorter way around the Earth."""
    lines = QgsMultiLineString()
    for run in runs:
        for lon, lat in [run] if isinstance(plane, ProjectedPlane) else cut_line(*run):
            # A single capture has no line.
            if len(lon) > 1:
                x, y = placed(plane, lon, lat)
                lines.addGeometry(QgsLineString(x.tolist(), y.tolist()))
    return QgsGeometry(lines)


def seen_edges(outline: QgsGeometry) -> QgsGeometry:
    """Edges of a footprint in degrees, except for cuts along the antimeridian and the poles.

    `dataset.layers.hide_antimeridian` draws the same edges.
    """
    return QgsGeometry(outline.constGet().boundary()).difference(QgsGeometry.fromWkt(CUTS_WKT))


def _polygons(rings: list[Ring]) -> QgsGeometry:
    parts = QgsMultiPolygon()
    for x, y in rings:
        line = QgsLineString(x.tolist(), y.tolist())
        line.close()
        parts.addGeometry(QgsPolygon(line))
    geometry = QgsGeometry(parts)
    # A single ring of four corners, as of a frame, cannot touch itself.
    if len(rings) == 1 and len(rings[0][0]) <= 4:
        return geometry
    # The halves of a cut ring may be joined along the cut, and a ring around a pole has a seam to the pole and back.
    return geometry if geometry.isGeosValid() else _only_polygons(geometry.makeValid())


def remove_pole_seams(shape: QgsGeometry) -> QgsGeometry:
    """Polygons in a CRS in which the pole is a point, without the seams to the pole that rings have in degrees."""
    # Snapping makes both sides of a seam coincide, so that they enclose nothing.
    return _only_polygons(shape.snappedToGrid(_SAME_M, _SAME_M).makeValid())


def _only_polygons(geometry: QgsGeometry) -> QgsGeometry:
    """Geometry without lines and points, which `makeValid` may leave."""
    if QgsWkbTypes.flatType(geometry.wkbType()) == QgsWkbTypes.Type.GeometryCollection:
        geometry.convertGeometryCollectionToSubclass(POLYGON)
    return geometry
