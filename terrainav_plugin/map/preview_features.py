"""Captures of a plan as map features. Runs in the background: plain values in, features out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from qgis.core import QgsFeature, QgsGeometry, QgsMultiPolygon, QgsPointXY, QgsRectangle
from qgis.PyQt.QtCore import QDateTime, QTimeZone

from ...core.geodesy.mercator import HALF_WORLD_M, wrap_lon_deg
from ...core.mission.area import Polygon
from .outlines import camera_outlines, metres, ring_polygon, surface
from .preview_view import WORLD_M

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...core.mission.area import Box
    from ...core.mission.mission import Mission
    from ...core.mission.plan import Plan

    Floats = NDArray[np.float64]
    Numbers = NDArray[np.int64]

#: Pieces an edge of the area is drawn in: parallels and meridians, which other CRSs bend.
_EDGE_PIECES = 64


class Clock:
    """When each capture is exposed, and the next one."""

    def __init__(self, plan: Plan) -> None:
        self.start_ms = utc_ms(plan.mission)
        self.at_ms = self.start_ms + np.round(1000.0 * plan.times_s)
        last = self.at_ms[-1] - self.at_ms[-2] if len(self.at_ms) > 1 else 0.0
        #: A picture is the latest one until the next; of a single one there is no next, so it is for a second.
        self.until_ms = np.append(self.at_ms[1:], self.at_ms[-1] + (last or 1000.0))

    def during(self, times_ms: tuple[float, float]) -> tuple[int, int]:
        """First capture shown in a range of time, and the one after the last."""
        begin, end = times_ms
        first = int(np.searchsorted(self.until_ms, begin))
        return first, max(int(np.searchsorted(self.at_ms, end, "right")), first)


def utc_ms(mission: Mission) -> float:
    """Start of a mission in milliseconds of Unix time."""
    from ...core.mission.mission import utc_time

    return utc_time(mission.start).timestamp() * 1000.0


def moment(unix_ms: float) -> QDateTime:
    """Time in UTC."""
    return QDateTime.fromMSecsSinceEpoch(int(unix_ms), QTimeZone.utc())


def feature(geometry: QgsGeometry, *attributes: object) -> QgsFeature:
    """Feature of a geometry and its attributes."""
    made = QgsFeature()
    made.setGeometry(geometry)
    made.setAttributes(list(attributes))
    return made


def area_features(plan: Plan) -> list[QgsFeature]:
    """Outline of the area; none of points.

    Its edges are straight in longitude and latitude, in pieces as other CRSs bend them.
    """
    if plan.mission.kind != "raster":
        return []
    area = plan.mission.area
    share = np.arange(_EDGE_PIECES) / _EDGE_PIECES
    outer, *holes = (
        ring_polygon(*((at[:, None] + share * (np.roll(at, -1) - at)[:, None]).ravel() for at in ring))
        for ring in _rings(area)
    )
    for hole in holes:
        outer = outer.difference(hole)
    box = area.bounds
    return [feature(outer, box.north_deg, box.west_deg, box.south_deg, box.east_deg)]


def _rings(area: Box | Polygon) -> list[tuple[Floats, Floats]]:
    if isinstance(area, Polygon):
        return area.arrays()
    west, east = area.west_deg, area.continuous_east_deg
    north, south = area.north_deg, area.south_deg
    return [(np.array([west, east, east, west]), np.array([north, north, south, south]))]


class Picked(NamedTuple):
    """Some captures of a plan, as a plan of their own, and what the whole plan knows of them.

    ``overlap`` is how many of all planned images show the middle of each, ``crowd`` how many of these are drawn over
    the middle of each, by the rectangles around them.
    """

    plan: Plan
    at_ms: Floats
    until_ms: Floats
    overlap: Numbers
    crowd: Numbers


def part_of(plan: Plan, ids: Numbers) -> Plan:
    """Plan of some of a plan's captures."""
    windows, corners = plan.windows, plan.corners
    return replace(
        plan,
        column=plan.column[ids],
        row=plan.row[ids],
        poses=plan.poses.take(ids),
        windows=type(windows)(*(values[ids] for values in windows)),
        corners=type(corners)(*(values[ids] for values in corners)),
        nominal=None,
    )


def footprint_features(picked: Picked) -> list[QgsFeature]:
    """What each picture shows: the frame its file will state, or the ground the camera sees."""
    plan = picked.plan
    where = (plan.column, plan.row, plan.lat_deg, wrap_lon_deg(plan.lon_deg), plan.agl_m, _gsd(plan))
    sight = (picked.overlap, picked.crowd, *plan.poses.attitude, ~plan.corners.hit.all(axis=1))
    columns = (values.tolist() for values in (*where, *sight))
    return [
        feature(shape, name, *values, *times)
        for shape, name, times, *values in zip(_shapes(plan), plan.names, _times(picked), *columns)
    ]


def centre_features(picked: Picked) -> list[QgsFeature]:
    """Where the camera is at each capture."""
    plan = picked.plan
    lon = wrap_lon_deg(plan.lon_deg)
    places = (values.tolist() for values in metres(lon, plan.lat_deg))
    where = (plan.column, plan.row, plan.lat_deg, lon, plan.agl_m, _gsd(plan), plan.poses.yaw_deg)
    columns = (values.tolist() for values in where)
    return [
        feature(QgsGeometry.fromPointXY(QgsPointXY(east, north)), name, *values, *times)
        for east, north, name, times, *values in zip(*places, plan.names, _times(picked), *columns)
    ]


def _gsd(plan: Plan) -> Floats:
    return plan.grid.ground_m_per_px(plan.lat_deg, plan.zoom)


def _times(picked: Picked) -> Iterator[tuple[QDateTime, QDateTime]]:
    for at, until in zip(picked.at_ms.tolist(), picked.until_ms.tolist()):
        yield moment(at), moment(until)


def _shapes(plan: Plan) -> Iterator[QgsGeometry]:
    if plan.size_px is not None:
        yield from camera_outlines(plan)
        return
    for edges in zip(*(edge.tolist() for edge in plan.edges_m)):
        yield _rectangle(*edges)


def _rectangle(west: float, south: float, east: float, north: float) -> QgsGeometry:
    """Rectangle in EPSG:3857, in two parts where it crosses the antimeridian."""
    shift = WORLD_M * ((west + HALF_WORLD_M) // WORLD_M)
    west, east = west - shift, east - shift
    if east <= HALF_WORLD_M:
        return QgsGeometry.fromRect(QgsRectangle(west, south, east, north))
    parts = QgsMultiPolygon()
    for left, right in ((west, HALF_WORLD_M), (-HALF_WORLD_M, east - WORLD_M)):
        parts.addGeometry(surface([left, left, right, right], [south, north, north, south]))
    return QgsGeometry(parts)
