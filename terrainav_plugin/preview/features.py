"""Captures and flight line of a plan as map features. Runs in the background."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from qgis.core import (
    QgsFeature,
    QgsGeometry,
    QgsPointXY,
)
from qgis.PyQt.QtCore import QDateTime, QTimeZone

from ...core.geodesy.mercator import wrap_lon_deg
from ...core.mission.areas.area import Polygon
from ..map.outlines import flight_lines, footprint_shapes, metres, placed, ring_polygon
from .index import Rects

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...core.mission.areas.area import Box
    from ...core.mission.plan import Plan
    from .index import CaptureIndex
    from .view import Rect

    Floats = NDArray[np.float64]
    Numbers = NDArray[np.int64]

#: Largest number of captures of flights that are always drawn completely, and of corners of longer flights from afar.
MOST_CORNERS = 4000


class ExposureTimes:
    """Times of the exposures of a plan, and until when each image is current."""

    def __init__(self, plan: Plan) -> None:
        self.start_ms = utc_ms(plan)
        self.at_ms = self.start_ms + np.round(1000.0 * plan.times_s)
        last = self.at_ms[-1] - self.at_ms[-2] if len(self.at_ms) > 1 else 0.0
        #: An image is current until the next one; a single image, for a second.
        self.until_ms = np.append(self.at_ms[1:], self.at_ms[-1] + (last or 1000.0))

    def during(self, times_ms: tuple[float, float]) -> tuple[int, int]:
        """Index of the first capture shown in a time range, and of the first one after it."""
        begin, end = times_ms
        first = int(np.searchsorted(self.until_ms, begin))
        return first, max(int(np.searchsorted(self.at_ms, end, "right")), first)


def utc_ms(plan: Plan) -> float:
    """Time of the first exposure of a plan, in milliseconds of Unix time."""
    from ...core.mission.parts import utc_time

    return utc_time(plan.direct.start).timestamp() * 1000.0


def moment(unix_ms: float) -> QDateTime:
    """Unix time as a QDateTime in UTC."""
    return QDateTime.fromMSecsSinceEpoch(int(unix_ms), QTimeZone.utc())


def feature(geometry: QgsGeometry, *attributes: object) -> QgsFeature:
    """Feature with a geometry and attributes."""
    made = QgsFeature()
    made.setGeometry(geometry)
    made.setAttributes(list(attributes))
    return made


def area_features(plan: Plan) -> list[QgsFeature]:
    """Outline of each polygon of the area, or of the box; empty for points.

    Edges are straight in longitude and latitude; they are divided into pieces, as they are curves in other CRSs.
    """
    if plan.mission.kind != "raster":
        return []
    area = plan.mission.area
    # Number of pieces of an edge, which is a curve in other CRSs.
    pieces = 64
    share = np.arange(pieces) / pieces
    plane = plan.grid.plane
    found = []
    for part in area.parts:
        outer, *holes = (
            ring_polygon(plane, *((at[:, None] + share * (np.roll(at, -1) - at)[:, None]).ravel() for at in ring))
            for ring in _rings(part)
        )
        for hole in holes:
            outer = outer.difference(hole)
        box = part.bounds
        found.append(feature(outer, box.north_deg, box.west_deg, box.south_deg, box.east_deg))
    return found


class Picked(NamedTuple):
    """Some captures of a plan, as a plan, with figures from the whole plan.

    ``overlap`` is the number of planned images that show the middle of each capture; ``crowd`` is the number of
    captures in this object whose bounding rectangles contain it.
    """

    plan: Plan
    at_ms: Floats
    until_ms: Floats
    overlap: Numbers
    crowd: Numbers


def plan_part(plan: Plan, ids: Numbers) -> Plan:
    """Plan of some of a plan's captures."""
    windows, corners = plan.windows, plan.corners
    return replace(
        plan,
        column=plan.column[ids],
        row=plan.row[ids],
        poses=plan.poses.take(ids),
        windows=type(windows)(*(values[ids] for values in windows)),
        corners=type(corners)(*(values[ids] for values in corners)),
        frames=plan.frames.take(ids),
        flown=None if plan.flown is None else type(plan.flown)(*(values[ids] for values in plan.flown)),
        nominal=None,
    )


def footprint_features(picked: Picked) -> list[QgsFeature]:
    """Footprint of each image: the extent of a map frame, or the ground that the camera sees."""
    plan = picked.plan
    where = (plan.column, plan.row, plan.lat_deg, wrap_lon_deg(plan.lon_deg), plan.agl_m, _gsd(plan))
    sight = (picked.overlap, picked.crowd, *plan.poses.attitude, ~plan.corners.hit.all(axis=1))
    columns = (values.tolist() for values in (*where, *sight))
    return [
        feature(shape, name, *values, *times)
        for shape, name, times, *values in zip(footprint_shapes(plan), plan.names, _times(picked), *columns)
    ]


def centre_features(picked: Picked) -> list[QgsFeature]:
    """Position of the camera at each capture."""
    plan = picked.plan
    lon = wrap_lon_deg(plan.lon_deg)
    places = (values.tolist() for values in placed(plan.grid.plane, lon, plan.lat_deg))
    where = (plan.column, plan.row, plan.lat_deg, lon, plan.agl_m, _gsd(plan), plan.poses.yaw_deg)
    columns = (values.tolist() for values in where)
    return [
        feature(QgsGeometry.fromPointXY(QgsPointXY(east, north)), name, *values, *times)
        for east, north, name, times, *values in zip(*places, plan.names, _times(picked), *columns)
    ]


def plan_flight(plan: Plan, index: CaptureIndex, clock: ExposureTimes) -> FlightLine | SortieLines:
    """Flight of a plan: a line from capture to capture, or a path with further points."""
    return FlightLine(plan, index, clock) if plan.path.is_captures else SortieLines(plan, clock)


class SortieLines:
    """Flight path of a plan, by sortie, with points besides the captures; always drawn completely."""

    is_short = True

    def __init__(self, plan: Plan, clock: ExposureTimes) -> None:
        self._plan, self._clock = plan, clock
        path, rows = plan.path, np.full(len(plan.path), -1)
        taken = path.capture >= 0
        rows[taken] = plan.row[path.capture[taken]]
        # Of long flights, keep only the ends of rows.
        inside = taken & np.append(False, rows[1:] == rows[:-1]) & np.append(rows[1:] == rows[:-1], False)
        self._kept = ~inside if len(path) > MOST_CORNERS else np.ones(len(path), bool)

    def whole(self) -> list[QgsFeature]:
        """Return the line of each sortie."""
        return [self._line(number) for number in range(self._plan.path.sorties)]

    def ends(self) -> list[QgsFeature]:
        """Return the line of each sortie, as the ways to the area and back also matter from afar."""
        return self.whole()

    def is_clear(self, _bounds: Rect, _px_per_m: float) -> bool:
        """Return True, as the path is always drawn."""
        return True

    def legs(self, _ids: Numbers, _rect: Rect) -> list[QgsFeature]:
        """Return the line of each sortie."""
        return self.whole()

    def _line(self, number: int) -> QgsFeature:
        path = self._plan.path.sortie_path(number)
        kept = self._kept[self._plan.path.sortie == number]
        lines = flight_lines(self._plan.grid.plane, [(path.lon_deg[kept], path.lat_deg[kept])])
        begin, end = (moment(self._clock.start_ms + 1000.0 * float(path.time_s[at])) for at in (0, -1))
        place = float(path.lat_deg[0]), float(wrap_lon_deg(path.lon_deg[:1])[0])
        images, several = int(np.count_nonzero(path.capture >= 0)), self._plan.path.sorties > 1
        return feature(lines, path.distance_m, images, *place, begin, end, number + 1 if several else 0)


class FlightLine:
    """Line from the first capture of a plan to the last."""

    def __init__(self, plan: Plan, index: CaptureIndex, clock: ExposureTimes) -> None:
        self._plan = plan
        lon = wrap_lon_deg(np.array([plan.lon_deg[0]]))
        self._attributes = (
            plan.direct.distance_m,
            len(plan),
            float(plan.lat_deg[0]),
            float(lon[0]),
            moment(clock.at_ms[0]),
            moment(clock.until_ms[-1]),
            0,
        )
        self._whole = _corners(plan.row)
        if self.is_short:
            return
        # Long legs may cross a view that does not touch their images: they need their own bounding boxes.
        if plan.grid.plane.wraps:
            x, y = metres(np.unwrap(plan.lon_deg, period=360.0), plan.lat_deg)
        else:
            x, y = placed(plan.grid.plane, plan.lon_deg, plan.lat_deg)
        step = np.maximum(np.abs(np.diff(x)), np.abs(np.diff(y)))
        self._long = np.flatnonzero(step > np.minimum(index.longer_m[:-1], index.longer_m[1:]))
        x0, y0, x1, y1 = (values[self._long + shift] for shift in (0, 1) for values in (x, y))
        self._long_boxes = Rects.wrapped(
            np.minimum(x0, x1), np.minimum(y0, y1), np.maximum(x0, x1), np.maximum(y0, y1), index.boxes.world
        )

    @property
    def is_short(self) -> bool:
        """Whether the line is always drawn completely."""
        return len(self._plan) <= MOST_CORNERS

    def whole(self) -> list[QgsFeature]:
        """Line from end to end; a long flight is reduced to the ends of rows and some corners between them."""
        return self._feature([self._whole])

    def ends(self) -> list[QgsFeature]:
        """First and last row."""
        row = self._plan.row[self._whole]
        return self._feature([self._whole[row == end] for end in np.unique([row[0], row[-1]])])

    def is_clear(self, bounds: Rect, px_per_m: float) -> bool:
        """Whether the legs of the whole flight are, on average, far enough apart on the screen."""
        area_m2 = (bounds.east - bounds.west) * (bounds.north - bounds.south)
        plane = self._plan.grid.plane
        # The map's scale enlarges lengths linearly and areas quadratically.
        shrunk = np.cos(np.radians(float(np.mean(self._plan.lat_deg[self._whole])))) if plane.wraps else plane.unit_m
        length_m = self._plan.direct.distance_m / shrunk
        # Legs less than 10 px apart on the screen would hide everything else.
        return bool(area_m2 * px_per_m >= 10.0 * length_m)

    def legs(self, ids: Numbers, rect: Rect) -> list[QgsFeature]:
        """Legs from and to the captures ``ids``, and long legs that cross a part of the world."""
        last = len(self._plan) - 1
        crossing = self._long[self._long_boxes.meets(rect)]
        legs = np.unique(np.concatenate([ids, ids - 1, crossing]))
        legs = legs[(legs >= 0) & (legs < last)]
        cuts = np.flatnonzero(np.diff(legs) > 1) + 1
        return self._feature([np.append(run, run[-1] + 1) for run in np.split(legs, cuts) if len(run)])

    def _feature(self, runs: list[Numbers]) -> list[QgsFeature]:
        plan = self._plan
        lines = flight_lines(plan.grid.plane, ((plan.lon_deg[run], plan.lat_deg[run]) for run in runs))
        return [feature(lines, *self._attributes)]


def _rings(area: Box | Polygon) -> list[tuple[Floats, Floats]]:
    if isinstance(area, Polygon):
        return area.arrays()
    west, east = area.west_deg, area.continuous_east_deg
    north, south = area.north_deg, area.south_deg
    return [(np.array([west, east, east, west]), np.array([north, north, south, south]))]


def _gsd(plan: Plan) -> Floats:
    return plan.grid.ground_m_per_px(plan.lat_deg, plan.lon_deg, plan.zoom)


def _times(picked: Picked) -> Iterator[tuple[QDateTime, QDateTime]]:
    for at, until in zip(picked.at_ms.tolist(), picked.until_ms.tolist()):
        yield moment(at), moment(until)


def _corners(row: Numbers) -> Numbers:
    count = len(row)
    if count <= MOST_CORNERS:
        return np.arange(count)
    turns = row[1:] != row[:-1]
    ends = np.flatnonzero(np.r_[True, turns] | np.r_[turns, True])
    if len(ends) > MOST_CORNERS:
        return np.unique(np.linspace(0, count - 1, MOST_CORNERS).astype(np.int64))
    between = np.linspace(0, count - 1, MOST_CORNERS - len(ends)).astype(np.int64)
    return np.union1d(ends, between)
