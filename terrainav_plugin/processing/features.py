"""A plan as features: footprints, captures and the flight line, with every attribute of the plan."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsFeature,
    QgsFields,
    QgsGeometry,
    QgsLineString,
    QgsMultiLineString,
    QgsMultiPolygon,
    QgsPointXY,
)
from qgis.PyQt.QtCore import QDateTime, Qt

from ..compat import field

if TYPE_CHECKING:
    from ...core.mission.plan import Plan

#: Of all layers: that of the pictures' pixels, in which their edges are exact.
CRS = "EPSG:3857"
_CAPTURE = (
    ("name", "text"),
    ("column", "integer"),
    ("row", "integer"),
    ("lat_deg", "number"),
    ("lon_deg", "number"),
    ("agl_m", "number"),
    ("yaw_deg", "number"),
    ("tilt_deg", "number"),
    ("roll_deg", "number"),
    ("zoom", "integer"),
    ("left_px", "number"),
    ("top_px", "number"),
    ("width_px", "integer"),
    ("height_px", "integer"),
    ("gsd_m", "number"),
    ("horizon", "yes_no"),
    ("time_s", "number"),
    ("time", "time"),
)
_FLIGHT = (("images", "integer"), ("length_m", "number"), ("flight_s", "number"))


def capture_fields() -> QgsFields:
    """Attributes of a footprint and of a capture."""
    return _fields(_CAPTURE)


def flight_fields() -> QgsFields:
    """Attributes of the flight line."""
    return _fields(_FLIGHT)


def footprints(plan: Plan) -> Iterator[QgsFeature]:
    """What each picture shows: the frame its file will state, or the ground the camera sees."""
    return (_feature(shape, values) for shape, values in zip(_shapes(plan), _attributes(plan)))


def captures(plan: Plan) -> Iterator[QgsFeature]:
    """Points below the camera, in flight order."""
    from ...core.geodesy.mercator import wrap_lon_deg
    from ..map.outlines import metres

    east, north = metres(wrap_lon_deg(plan.lon_deg), plan.lat_deg)
    for x, y, values in zip(east.tolist(), north.tolist(), _attributes(plan)):
        yield _feature(QgsGeometry.fromPointXY(QgsPointXY(x, y)), values)


def flight_line(plan: Plan) -> QgsFeature:
    """Way from the first capture to the last, in two parts where it crosses the antimeridian."""
    import numpy as np

    from ..map.outlines import metres

    lat, lon = plan.lat_deg, plan.lon_deg
    turn = np.floor((lon + 180.0) / 360.0)
    lines = QgsMultiLineString()
    # A leg across is cut at 180 degrees, where its latitude is that of the straight line on the map.
    at = np.flatnonzero(turn[1:] != turn[:-1])
    border = 360.0 * np.maximum(turn[at], turn[at + 1]) - 180.0
    share = (border - lon[at]) / (lon[at + 1] - lon[at])
    crossing = lat[at] + share * (lat[at + 1] - lat[at])
    starts, ends = [0, *(at + 1).tolist()], [*(at + 1).tolist(), len(lon)]
    for number, (start, end) in enumerate(zip(starts, ends)):
        part_lon, part_lat = lon[start:end], lat[start:end]
        if number > 0:
            part_lon = np.r_[border[number - 1], part_lon]
            part_lat = np.r_[crossing[number - 1], part_lat]
        if number < len(at):
            part_lon, part_lat = np.r_[part_lon, border[number]], np.r_[part_lat, crossing[number]]
        east, north = metres(part_lon - 360.0 * turn[start], part_lat)
        # A single capture is no line.
        if len(east) > 1:
            lines.addGeometry(QgsLineString(east.tolist(), north.tolist()))
    return _feature(QgsGeometry(lines), (len(plan), plan.flight_distance_m, plan.flight_s))


def _fields(kinds: tuple[tuple[str, str], ...]) -> QgsFields:
    fields = QgsFields()
    for name, kind in kinds:
        fields.append(field(name, kind))
    return fields


def _feature(geometry: QgsGeometry, values: tuple[Any, ...]) -> QgsFeature:
    feature = QgsFeature()
    feature.setGeometry(geometry)
    feature.setAttributes(list(values))
    return feature


def _attributes(plan: Plan) -> Iterator[tuple[Any, ...]]:
    import numpy as np

    from ...core.geodesy.mercator import wrap_lon_deg
    from ...core.mission.mission import utc_time

    start = QDateTime.fromMSecsSinceEpoch(
        round(utc_time(plan.mission.start).timestamp() * 1000.0), Qt.TimeSpec.UTC
    )
    columns = (
        plan.column,
        plan.row,
        plan.lat_deg,
        wrap_lon_deg(plan.lon_deg),
        plan.agl_m,
        *plan.poses.attitude,
        np.broadcast_to(plan.zoom, len(plan)),
        np.mod(np.asarray(plan.windows.left_px, np.float64), plan.grid.world_px(plan.zoom)),
        np.asarray(plan.windows.top_px, np.float64),
        plan.width_px,
        plan.height_px,
        plan.grid.ground_m_per_px(plan.lat_deg, plan.zoom),
        ~plan.corners.hit.all(axis=1),
        plan.times_s,
    )
    for name, *values in zip(plan.names, *(column.tolist() for column in columns)):
        yield (name, *values, start.addMSecs(round(1000.0 * values[-1])))


def _shapes(plan: Plan) -> Iterator[QgsGeometry]:
    from ...core.geodesy.mercator import HALF_WORLD_M
    from ..map.outlines import camera_outlines, surface

    if plan.size_px is not None:
        yield from camera_outlines(plan)
        return
    turn = 2.0 * HALF_WORLD_M
    for west, south, east, north in zip(*(edge.tolist() for edge in plan.edges_m)):
        shift = turn * ((west + HALF_WORLD_M) // turn)
        left, right = west - shift, east - shift
        pieces = [(left, min(right, HALF_WORLD_M))]
        if right > HALF_WORLD_M:
            pieces.append((-HALF_WORLD_M, right - turn))
        shape = QgsMultiPolygon()
        for start, end in pieces:
            shape.addGeometry(surface([start, start, end, end], [south, north, north, south]))
        yield QgsGeometry(shape)
