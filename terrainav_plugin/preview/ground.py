"""Labels and buildings around a plan as map features. Runs in the background."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from qgis.core import QgsGeometry, QgsPointXY

from ...core.vectors.features import LINE, POLYGON
from ..map.outlines import flight_lines, placed, ring_polygon
from .features import feature

if TYPE_CHECKING:
    from qgis.core import QgsFeature

    from ...core.geodesy.mercator import Plane
    from ..plan_features import DrawnFeatures

#: Segments of a quarter of a circle around points and ends of lines.
_SEGMENTS = 6


def ground_features(drawn: tuple[DrawnFeatures, ...], plane: Plane, check: Callable[[], None]) -> list[QgsFeature]:
    """Features of layers as polygons with the title of their kind and their number, in the CRS of a plane.

    Parameters
    ----------
    check : callable
        Called between features; raises an exception if the work is overtaken.
    """
    found = []
    for one in drawn:
        for index, place in enumerate(one.places):
            if place < 0:
                continue
            check()
            shape = _shape(one, index, plane)
            if not shape.isEmpty():
                found.append(feature(shape, one.kinds[place][0], int(one.features.number[index])))
    return found


def _shape(drawn: DrawnFeatures, index: int, plane: Plane) -> QgsGeometry:
    """Polygons of a feature; lines and points have their width and radius on the ground."""
    features = drawn.features
    parts = range(features.feature_starts[index], features.feature_starts[index + 1])
    found = []
    for part in parts:
        rings = [
            (features.lon_deg[first:after], features.lat_deg[first:after])
            for first, after in (
                (features.ring_starts[ring], features.ring_starts[ring + 1])
                for ring in range(features.part_starts[part], features.part_starts[part + 1])
            )
        ]
        if features.kind[index] == POLYGON:
            outer, *holes = (ring_polygon(plane, lon[:-1], lat[:-1]) for lon, lat in rings)
            for hole in holes:
                outer = outer.difference(hole)
            found.append(outer)
            continue
        lon, lat = rings[0]
        unit_m = float(np.cos(np.radians(lat.mean()))) if plane.wraps else plane.unit_m
        if features.kind[index] == LINE:
            line = flight_lines(plane, [(lon, lat)])
            found.append(line.buffer(drawn.width_m / 2.0 / unit_m, _SEGMENTS))
        else:
            x, y = placed(plane, lon, lat)
            if np.isfinite((x[0], y[0])).all():
                point = QgsGeometry.fromPointXY(QgsPointXY(x[0], y[0]))
                found.append(point.buffer(drawn.radius_m / unit_m, _SEGMENTS))
    found = [one for one in found if not one.isEmpty()]
    # Triangles of a roof become one outline.
    whole = found[0] if len(found) == 1 else QgsGeometry.unaryUnion(found)
    whole.convertToMultiType()
    return whole
