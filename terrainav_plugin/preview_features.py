"""A plan as map features. Runs in the background: plain values in, features out."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from qgis.core import (
    QgsFeature,
    QgsGeometry,
    QgsLineString,
    QgsMultiLineString,
    QgsMultiPolygon,
    QgsPointXY,
    QgsPolygon,
    QgsRectangle,
)

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..core.mission.area import Box
    from ..core.mission.plan import Plan

    Floats = NDArray[np.float64]

#: Of all layers: that of the pictures' pixels, in which their edges are exact.
CRS = "EPSG:3857"
#: Beyond this many captures only the outline of each row is drawn.
MOST_FOOTPRINTS = 20_000
#: Pieces an edge of the area is drawn in: parallels and meridians, which other CRSs bend.
_EDGE_PIECES = 64

FIELDS = {
    "area": "field=north:double&field=west:double&field=south:double&field=east:double",
    "footprints": (
        "field=name:string&field=column:integer&field=row:integer&field=lat:double&field=lon:double"
        "&field=agl_m:double&field=gsd_m:double&field=images:integer"
    ),
    "centres": (
        "field=name:string&field=column:integer&field=row:integer&field=lat:double&field=lon:double"
        "&field=agl_m:double"
    ),
    "flight": "field=length_m:double&field=images:integer",
}


class PreviewFeatures(NamedTuple):
    """What the preview layers hold; ``outlined`` when rows stand for their footprints."""

    area: list[QgsFeature]
    footprints: list[QgsFeature]
    centres: list[QgsFeature]
    flight: list[QgsFeature]
    outlined: bool


def preview_features(plan: Plan) -> PreviewFeatures:
    """Area, footprints, capture centres and flight line of a plan."""
    outlined = len(plan) > MOST_FOOTPRINTS
    return PreviewFeatures(
        area=[_area(plan.mission.area.bounds)] if plan.mission.kind == "raster" else [],
        footprints=_rows(plan) if outlined else _footprints(plan),
        centres=[] if outlined else _centres(plan),
        flight=[_flight(plan)],
        outlined=outlined,
    )


def _feature(geometry: QgsGeometry, *attributes: object) -> QgsFeature:
    feature = QgsFeature()
    feature.setGeometry(geometry)
    feature.setAttributes(list(attributes))
    return feature


def _area(box: Box) -> QgsFeature:
    """Outline of the box, along its parallels and meridians."""
    west, south, north = box.west_deg, box.south_deg, box.north_deg
    parts = [(west, box.continuous_east_deg)]
    if box.continuous_east_deg > 180.0:
        parts = [(west, 180.0), (-180.0, box.continuous_east_deg - 360.0)]
    polygons = QgsMultiPolygon()
    for left, right in parts:
        x, y = _metres([left, right, right, left], [north, north, south, south])
        corners = list(zip(x, y))
        ring = [
            QgsPointXY(x0 + step / _EDGE_PIECES * (x1 - x0), y0 + step / _EDGE_PIECES * (y1 - y0))
            for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1])
            for step in range(_EDGE_PIECES)
        ]
        polygons.addGeometry(QgsPolygon(QgsLineString([*ring, ring[0]])))
    return _feature(QgsGeometry(polygons), box.north_deg, box.west_deg, box.south_deg, box.east_deg)


def _rectangle(west: float, south: float, east: float, north: float, half_world_m: float) -> QgsGeometry:
    """Rectangle in EPSG:3857, in two parts where it crosses the antimeridian."""
    turn = 2.0 * half_world_m
    shift = turn * ((west + half_world_m) // turn)
    west, east = west - shift, east - shift
    if east <= half_world_m:
        return QgsGeometry.fromRect(QgsRectangle(west, south, east, north))
    parts = QgsMultiPolygon()
    for left, right in ((west, half_world_m), (-half_world_m, east - turn)):
        parts.addGeometry(QgsGeometry.fromRect(QgsRectangle(left, south, right, north)).constGet().clone())
    return QgsGeometry(parts)


def _footprints(plan: Plan) -> list[QgsFeature]:
    """Frames of the pictures, exactly as their files will state them."""
    from ..core.geodesy.mercator import HALF_WORLD_M

    gsd = plan.grid.ground_m_per_px(plan.lat_deg, plan.zoom)
    columns = (plan.column, plan.row, plan.lat_deg, _wrapped(plan.lon_deg), plan.agl_m, gsd, *plan.edges_m)
    return [
        _feature(_rectangle(west, south, east, north, HALF_WORLD_M), name, column, row, lat, lon, agl, gsd, 1)
        for name, column, row, lat, lon, agl, gsd, west, south, east, north in zip(
            plan.names, *(values.tolist() for values in columns)
        )
    ]


def _rows(plan: Plan) -> list[QgsFeature]:
    """One rectangle for each run of touching frames in a row."""
    import numpy as np

    from ..core.geodesy.mercator import HALF_WORLD_M

    west, south, east, north = plan.edges_m
    order = np.lexsort((west, plan.row))
    row, west, south, east, north = (values[order] for values in (plan.row, west, south, east, north))
    starts = np.flatnonzero(np.r_[True, (row[1:] != row[:-1]) | (west[1:] > east[:-1])])
    counts = np.diff(np.r_[starts, len(row)])
    edges = (
        west[starts],
        np.minimum.reduceat(south, starts),
        np.maximum.reduceat(east, starts),
        np.maximum.reduceat(north, starts),
    )
    gsd = plan.grid.ground_m_per_px(plan.lat_deg, plan.zoom)[order][starts]
    lat, agl = plan.lat_deg[order][starts], plan.agl_m[order][starts]
    return [
        _feature(_rectangle(*box, HALF_WORLD_M), f"row {number}", None, number, lat, None, agl, gsd, count)
        for number, count, lat, agl, gsd, *box in zip(
            *(values.tolist() for values in (row[starts], counts, lat, agl, gsd, *edges))
        )
    ]


def _centres(plan: Plan) -> list[QgsFeature]:
    lon = _wrapped(plan.lon_deg)
    x, y = _metres(lon, plan.lat_deg)
    columns = (plan.column, plan.row, plan.lat_deg, lon, plan.agl_m)
    return [
        _feature(QgsGeometry.fromPointXY(QgsPointXY(east, north)), name, *pose)
        for east, north, name, *pose in zip(x, y, plan.names, *(values.tolist() for values in columns))
    ]


def _flight(plan: Plan) -> QgsFeature:
    """Way from the first capture to the last; of a mission too large to draw, from row end to row end."""
    import numpy as np

    keep = np.ones(len(plan), bool)
    if len(plan) > MOST_FOOTPRINTS:
        turns = plan.row[1:] != plan.row[:-1]
        keep = np.r_[True, turns] | np.r_[turns, True]
    lon, lat = plan.lon_deg[keep], plan.lat_deg[keep]
    lines = QgsMultiLineString()
    for part_lon, part_lat in _split_at_antimeridian(lon, lat):
        lines.addGeometry(QgsLineString(*_metres(part_lon, part_lat)))
    return _feature(QgsGeometry(lines), plan.flight_distance_m, len(plan))


def _split_at_antimeridian(lon: Floats, lat: Floats) -> list[tuple[Floats, Floats]]:
    """Parts of a line of continuous longitudes, each within one turn of the Earth."""
    import numpy as np

    turn = np.floor((lon + 180.0) / 360.0)
    at = np.flatnonzero(turn[1:] != turn[:-1])
    if not len(at):
        return [(lon - 360.0 * turn[0], lat)]
    border = 360.0 * np.maximum(turn[at], turn[at + 1]) - 180.0
    share = (border - lon[at]) / (lon[at + 1] - lon[at])
    crossing_lat = lat[at] + share * (lat[at + 1] - lat[at])
    parts = []
    for begin, end in zip([0, *(at + 1)], [*(at + 1), len(lon)]):
        part_lon, part_lat = lon[begin:end], lat[begin:end]
        if begin > 0:
            index = int(np.searchsorted(at + 1, begin))
            part_lon, part_lat = np.r_[border[index], part_lon], np.r_[crossing_lat[index], part_lat]
        if end < len(lon):
            index = int(np.searchsorted(at + 1, end))
            part_lon, part_lat = np.r_[part_lon, border[index]], np.r_[part_lat, crossing_lat[index]]
        parts.append((part_lon - 360.0 * turn[begin], part_lat))
    return parts


def _wrapped(lon_deg: Floats) -> Floats:
    from ..core.geodesy.mercator import wrap_lon_deg

    return wrap_lon_deg(lon_deg)


def _metres(lon_deg: Floats | list[float], lat_deg: Floats | list[float]) -> tuple[list[float], list[float]]:
    """Easting and northing in EPSG:3857 of longitudes (not wrapped) and latitudes."""
    import numpy as np

    from ..core.geodesy.mercator import HALF_WORLD_M, lat_to_v, lon_to_u

    east = (2.0 * lon_to_u(np.asarray(lon_deg)) - 1.0) * HALF_WORLD_M
    north = (1.0 - 2.0 * lat_to_v(np.asarray(lat_deg))) * HALF_WORLD_M
    return east.tolist(), north.tolist()
