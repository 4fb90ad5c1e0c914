"""What a plan draws on the map, as QGIS's geometries in EPSG:3857, cut at the antimeridian. On any thread."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

import numpy as np
from qgis.core import QgsGeometry, QgsLineString, QgsMultiLineString, QgsMultiPolygon, QgsPolygon

from ...core.geodesy.mercator import MAX_LAT_DEG
from ...core.mission.area import cut_half_plane
from ...core.mission.outlines import cut_at_antimeridian, cut_line, metres, pictures_m

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...core.mission.outlines import Ring
    from ...core.mission.plan import Plan

    Floats = NDArray[np.float64]

__all__ = ["flight_lines", "footprint_shapes", "metres", "ring_polygon"]

#: Corners up to which a ring in one piece cannot touch itself: those of a frame.
_PLAIN_CORNERS = 4


def footprint_shapes(plan: Plan) -> Iterator[QgsGeometry]:
    """What each picture shows: the frame that its file will state, or the ground that the camera sees."""
    return map(_polygons, pictures_m(plan))


def ring_polygon(lon_deg: Floats, lat_deg: Floats) -> QgsGeometry:
    """Polygons of a ring, cut at the ends of the map."""
    lon, lat = cut_half_plane(lon_deg, lat_deg, 1, MAX_LAT_DEG, -1.0)
    lon, lat = cut_half_plane(lon, lat, 1, -MAX_LAT_DEG, 1.0)
    return _polygons([metres(*part) for part in cut_at_antimeridian(lon, lat)])


def flight_lines(runs: Iterable[tuple[Floats, Floats]]) -> QgsGeometry:
    """Ways through longitudes and latitudes in their order, from each place to the next the shorter way around."""
    lines = QgsMultiLineString()
    for run in runs:
        for lon, lat in cut_line(*run):
            # A single capture is no line.
            if len(lon) > 1:
                x, y = metres(lon, lat)
                lines.addGeometry(QgsLineString(x.tolist(), y.tolist()))
    return QgsGeometry(lines)


def _polygons(rings: list[Ring]) -> QgsGeometry:
    parts = QgsMultiPolygon()
    for x, y in rings:
        line = QgsLineString(x.tolist(), y.tolist())
        line.close()
        parts.addGeometry(QgsPolygon(line))
    geometry = QgsGeometry(parts)
    if len(rings) == 1 and len(rings[0][0]) <= _PLAIN_CORNERS:
        return geometry
    # A ring cut in two may keep its halves joined along the cut.
    return geometry if geometry.isGeosValid() else geometry.makeValid()
