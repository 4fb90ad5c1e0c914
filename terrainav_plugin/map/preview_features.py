"""A plan as map features. Runs in the background: plain values in, features out."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

from qgis.core import (
    QgsFeature,
    QgsGeometry,
    QgsLineString,
    QgsMultiLineString,
    QgsMultiPolygon,
    QgsPointXY,
    QgsRectangle,
)

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ...core.mission.area import Box, Polygon
    from ...core.mission.plan import Plan

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
        "&field=yaw:double&field=tilt:double&field=roll:double&field=horizon:bool"
    ),
    "centres": (
        "field=name:string&field=column:integer&field=row:integer&field=lat:double&field=lon:double"
        "&field=agl_m:double"
    ),
    "flight": "field=length_m:double&field=images:integer",
}


def field_names(role: str) -> list[str]:
    """Names of the attributes of a layer."""
    return [part.partition("=")[2].partition(":")[0] for part in FIELDS[role].split("&")]


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
        area=[_area(plan.mission.area)] if plan.mission.kind == "raster" else [],
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


def _area(area: Box | Polygon) -> QgsFeature:
    """Outline of the area: edges that are straight in longitude and latitude, in pieces as other CRSs bend them."""
    import numpy as np

    from ...core.mission.area import Polygon
    from .camera_outlines import ring_polygon

    if isinstance(area, Polygon):
        rings = area.arrays()
    else:
        west, east = area.west_deg, area.continuous_east_deg
        north, south = area.north_deg, area.south_deg
        rings = [(np.array([west, east, east, west]), np.array([north, north, south, south]))]
    share = np.arange(_EDGE_PIECES) / _EDGE_PIECES
    outer, *holes = (
        ring_polygon(*((at[:, None] + share * (np.roll(at, -1) - at)[:, None]).ravel() for at in ring))
        for ring in rings
    )
    for hole in holes:
        outer = outer.difference(hole)
    box = area.bounds
    return _feature(outer, box.north_deg, box.west_deg, box.south_deg, box.east_deg)


def _rectangle(west: float, south: float, east: float, north: float, half_world_m: float) -> QgsGeometry:
    """Rectangle in EPSG:3857, in two parts where it crosses the antimeridian."""
    turn = 2.0 * half_world_m
    shift = turn * ((west + half_world_m) // turn)
    west, east = west - shift, east - shift
    if east <= half_world_m:
        return QgsGeometry.fromRect(QgsRectangle(west, south, east, north))
    from .camera_outlines import surface

    parts = QgsMultiPolygon()
    for left, right in ((west, half_world_m), (-half_world_m, east - turn)):
        parts.addGeometry(surface([left, left, right, right], [south, north, north, south]))
    return QgsGeometry(parts)


def _footprints(plan: Plan) -> list[QgsFeature]:
    """What each picture shows: the frame its file will state, or the ground the camera sees."""
    gsd = plan.grid.ground_m_per_px(plan.lat_deg, plan.zoom)
    where = (plan.column, plan.row, plan.lat_deg, _wrapped(plan.lon_deg), plan.agl_m, gsd)
    sight = (*plan.poses.attitude, ~plan.corners.hit.all(axis=1))
    return [
        _feature(shape, name, *values[: len(where)], 1, *values[len(where) :])
        for shape, name, *values in zip(
            _shapes(plan), plan.names, *(values.tolist() for values in (*where, *sight))
        )
    ]


def _shapes(plan: Plan) -> Iterator[QgsGeometry]:
    from ...core.geodesy.mercator import HALF_WORLD_M
    from .camera_outlines import camera_outlines

    if plan.size_px is not None:
        yield from camera_outlines(plan)
        return
    for edges in zip(*(edge.tolist() for edge in plan.edges_m)):
        yield _rectangle(*edges, HALF_WORLD_M)


def _rows(plan: Plan) -> list[QgsFeature]:
    """One rectangle for each run of touching frames in a row."""
    import numpy as np

    from ...core.geodesy.mercator import HALF_WORLD_M

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
    # A row is no picture: it has no attitude and no horizon.
    none = (None,) * 4
    return [
        _feature(
            _rectangle(*box, HALF_WORLD_M), f"row {number}", None, number, lat, None, agl, gsd, count, *none
        )
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
    from ...core.geodesy.mercator import wrap_lon_deg

    return wrap_lon_deg(lon_deg)


def _metres(lon_deg: Floats | list[float], lat_deg: Floats | list[float]) -> tuple[list[float], list[float]]:
    """Easting and northing in EPSG:3857 of longitudes (not wrapped) and latitudes."""
    from .camera_outlines import metres

    east, north = metres(lon_deg, lat_deg)
    return east.tolist(), north.tolist()
