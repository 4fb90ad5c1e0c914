"""An area in the canvas's CRS: its outline and handles, and how dragging changes it. No widgets."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from qgis.core import (
    Qgis,
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsCsException,
    QgsGeometry,
    QgsMapToPixel,
    QgsPointXY,
    QgsProject,
    QgsRectangle,
)

from ...core.errors import InvalidInput
from ...core.geodesy.mercator import MAX_LAT_DEG
from ...core.mission.areas.area import Area, Box, Points, Polygon, Polygons, Position
from ..map.canvas import canvas_lon_lat, continuous_box, to_lon_lat, wrap_longitude
from ..map.outlines import remove_pole_seams

#: Number of segments in which an edge is drawn, as it may be a curve on the canvas.
_STEPS = 48
#: Largest number of points drawn, picked at even steps: more would merge and take long to paint.
MOST_POINTS = 2_000
#: Distance of cut outlines from the map's edge: a tenth of a millimetre on the ground.
_CUT_DEG = 1e-9
#: Highest latitude drawn, a decimetre from the pole: the pole is outside the domain of many CRSs.
_BESIDE_POLE_DEG = 90.0 - 1e-6
_EDGES = ("north", "west", "south", "east")
#: Grips of a box: the two edges at a corner, or one edge.
GRIPS = (
    *(frozenset((vertical, side)) for vertical in ("north", "south") for side in ("west", "east")),
    *(frozenset((edge,)) for edge in _EDGES),
)
#: Least span of a box: a decimetre on the ground, visible in the entries' seven decimals.
LEAST_SPAN_DEG = 1e-6
#: Largest number of corners with handles: more would merge, and redraw slowly at every move.
MOST_CORNERS = 2_000


class Corner(NamedTuple):
    """Indices of a corner: of its polygon, its ring and its place in the ring. An edge has the indices of its start."""

    part: int
    ring: int
    at: int


class AreaOutline:
    """An area on a canvas.

    Parameters
    ----------
    near_lon_deg : float
        Longitude of the canvas's middle; on geographic maps, the area is drawn on the same turn around the Earth.

    Attributes
    ----------
    shape : QgsGeometry
        Polygons or points in the canvas's CRS; empty outside its domain.
    handles : dict of frozenset of edges to QgsPointXY
        Corners, and middles of the sides, of a box.
    sides : dict of edge to list of (QgsPointXY, QgsPointXY)
        Segments in which each side of a box is drawn.
    corners : dict of Corner to QgsPointXY
        Corners of polygons; empty if there are more than `MOST_CORNERS` or the area surrounds a pole.
    edges : dict of Corner to list of (QgsPointXY, QgsPointXY)
        Segments in which the edge after each of ``corners`` is drawn.
    middles : dict of Corner to QgsPointXY
        Middle of each of ``edges``.
    """

    def __init__(
        self,
        area: Area,
        crs: QgsCoordinateReferenceSystem,
        project: QgsProject,
        near_lon_deg: float,
    ) -> None:
        self._transform = to_lon_lat(crs, project)
        self._is_geographic = crs.isGeographic()
        self._turn_deg = 360.0 * count_turns(area, near_lon_deg) if crs.isGeographic() else 0.0
        self.handles: dict[frozenset[str], QgsPointXY] = {}
        self.sides: dict[str, list[tuple[QgsPointXY, QgsPointXY]]] = {}
        self.corners: dict[Corner, QgsPointXY] = {}
        self.edges: dict[Corner, list[tuple[QgsPointXY, QgsPointXY]]] = {}
        self.middles: dict[Corner, QgsPointXY] = {}
        if isinstance(area, Points):
            every = max(1, math.ceil(len(area.poses) / MOST_POINTS))
            west = area.bounds.west_deg
            # Longitudes continue eastwards from the area's west edge, as in a box.
            placed = (self.project(west + (lon - west) % 360.0, lat) for lat, lon, _ in area.poses[::every])
            self.shape = QgsGeometry.fromMultiPointXY([point for point in placed if point is not None])
            return
        self._cut_deg = None if crs.isGeographic() else self._find_cut(area)
        self.shape = self._projected(_degrees(area))
        if isinstance(area, Box):
            self._place_handles(area)
        else:
            self._place_corners(area)

    def project(self, lon_deg: float, lat_deg: float) -> QgsPointXY | None:
        """Point in the canvas's CRS; None outside its domain."""
        return _placed(self._transform, QgsPointXY(lon_deg + self._turn_deg, _clip_pole(lat_deg)))

    def project_all(self, places: Sequence[Position]) -> list[QgsPointXY | None]:
        """Points in the canvas's CRS, as from `project`, transformed in one call."""
        points = QgsGeometry.fromMultiPointXY(
            [QgsPointXY(lon + self._turn_deg, _clip_pole(lat)) for lon, lat in places]
        )
        try:
            points.transform(self._transform, Qgis.TransformDirection.Reverse)
        except QgsCsException:
            # Some places are outside the domain: transform them one by one.
            return [self.project(*place) for place in places]
        return [_finite(point) for point in points.asMultiPoint()]

    def _find_cut(self, area: Area) -> float | None:
        """Longitude inside an area at which the map is cut; None if there is none."""
        box = area.bounds
        west, span = box.west_deg, box.span_deg
        lat = (box.north_deg + box.south_deg) / 2.0
        lons = [west + span * step / _STEPS for step in range(_STEPS + 1)]
        places = [self.project(lon, lat) for lon in lons]
        steps = [
            (one.distance(other), start, end)
            for one, other, start, end in zip(places, places[1:], lons, lons[1:])
            if one is not None and other is not None
        ]
        if not steps:
            return None
        longest, start, end = max(steps)
        # A step 20 times longer than the median leads across the edge of the map.
        if longest <= 20.0 * statistics.median(length for length, _, _ in steps):
            return None
        first = self.project(start, lat)
        for _ in range(50):
            middle = (start + end) / 2.0
            place = self.project(middle, lat)
            if place is None or place.distance(first) > longest / 2.0:
                end = middle
            else:
                start = middle
        return (start + end) / 2.0

    def _projected(self, degrees: QgsGeometry) -> QgsGeometry:
        pieces = [degrees]
        if self._cut_deg is not None:
            box = degrees.boundingBox()
            south, north = box.yMinimum() - 1.0, box.yMaximum() + 1.0
            halves = (
                QgsRectangle(box.xMinimum() - 1.0, south, self._cut_deg - _CUT_DEG, north),
                QgsRectangle(self._cut_deg + _CUT_DEG, south, box.xMaximum() + 1.0, north),
            )
            pieces = [degrees.intersection(QgsGeometry.fromRect(half)) for half in halves]
        parts = []
        for piece in pieces:
            corners = max(sum(1 for _ in piece.vertices()), 1)
            # Use fewer segments per edge if the outline would exceed 4,000 points.
            fine = piece.densifyByCount(max(min(_STEPS, 4_000 // corners), 0))
            for part in _polygons(fine):
                rings = [self._ring(ring) for ring in part]
                if rings and len(rings[0]) >= 3:
                    parts.append([ring for ring in rings if len(ring) >= 3])
        shape = QgsGeometry.fromMultiPolygonXY(parts) if parts else QgsGeometry()
        box = degrees.boundingBox()
        reaches_pole = max(abs(box.yMinimum()), abs(box.yMaximum())) >= 90.0
        is_around = reaches_pole and box.width() >= 360.0 and self._cut_deg is None
        return remove_pole_seams(shape) if is_around and not self._is_geographic else shape

    def _ring(self, ring: list[QgsPointXY]) -> list[QgsPointXY]:
        placed = self.project_all([(corner.x(), corner.y()) for corner in ring])
        return [point for point in placed if point is not None]

    def _place_handles(self, box: Box) -> None:
        lons = {"west": box.west_deg, "east": box.continuous_east_deg}
        lats = {"north": box.north_deg, "south": box.south_deg}
        middle_lon, middle_lat = sum(lons.values()) / 2.0, sum(lats.values()) / 2.0
        for grip in GRIPS:
            lon = next((lons[edge] for edge in grip if edge in lons), middle_lon)
            lat = next((lats[edge] for edge in grip if edge in lats), middle_lat)
            place = self.project(lon, lat)
            if place is not None:
                self.handles[grip] = place
        for edge in _EDGES:
            if edge in lats:
                walk = [(lon, lats[edge]) for lon in _steps(lons["west"], lons["east"])]
            else:
                walk = [(lons[edge], lat) for lat in _steps(lats["south"], lats["north"])]
            self.sides[edge] = list(self._segments(walk))

    def _place_corners(self, area: Polygon | Polygons) -> None:
        shapes = area_rings(area)
        if area.bounds.span_deg >= 360.0 or sum(len(ring) for rings in shapes for ring in rings) > MOST_CORNERS:
            return
        for part, rings in enumerate(shapes):
            for number, ring in enumerate(rings):
                ends = [*ring[1:], ring[0]]
                places = self.project_all(ring)
                middles = self.project_all([_between(*edge, 0.5) for edge in zip(ring, ends)])
                for at, (place, middle, end) in enumerate(zip(places, middles, [*places[1:], places[0]])):
                    corner = Corner(part, number, at)
                    if place is None:
                        continue
                    self.corners[corner] = place
                    if middle is not None and end is not None and not self._is_cut(ring[at], ends[at]):
                        self.middles[corner] = middle
                        self.edges[corner] = self._edge(ring[at], ends[at], (place, middle, end))

    def _edge(
        self, start: Position, end: Position, places: tuple[QgsPointXY, QgsPointXY, QgsPointXY]
    ) -> list[tuple[QgsPointXY, QgsPointXY]]:
        """Segments of an edge, given its start, middle and end on the canvas: several if the edge is a curve."""
        first, middle, last = places
        # An edge counts as straight if its middle deviates by at most 0.2 % of its length.
        if _distance(middle, first, last) <= 0.002 * first.distance(last):
            return [(first, last)]
        return list(self._segments([_between(start, end, step / 16) for step in range(17)]))

    def _is_cut(self, start: Position, end: Position) -> bool:
        """Whether the map is cut between two places."""
        return self._cut_deg is not None and min(start[0], end[0]) < self._cut_deg < max(start[0], end[0])

    def _segments(self, walk: Sequence[tuple[float, float]]) -> Iterator[tuple[QgsPointXY, QgsPointXY]]:
        places = self.project_all(walk)
        for here, there, start, end in zip(walk, walk[1:], places, places[1:]):
            if start is not None and end is not None and not self._is_cut(here, there):
                yield start, end


def find_grip(
    outline: AreaOutline, to_pixel: QgsMapToPixel, x_px: float, y_px: float, reach_px: float
) -> frozenset[str]:
    """Edges of a box at the pointer: two at a corner, one at a side, none elsewhere.

    Corners take precedence over sides. A box that is small on the screen is gripped only outside, so that it can still
    be moved.
    """
    handles = {grip: to_pixel.transform(place) for grip, place in outline.handles.items()}
    xs, ys = [p.x() for p in handles.values()], [p.y() for p in handles.values()]
    if not xs:
        return frozenset()
    reach = min(reach_px, max(1.0, min(max(xs) - min(xs), max(ys) - min(ys)) / 4.0))
    at = QgsPointXY(x_px, y_px)
    corners = [(place.distance(at), sorted(grip)) for grip, place in handles.items() if len(grip) == 2]
    distance, corner = min(corners, default=(math.inf, []))
    if distance <= reach:
        return frozenset(corner)
    found = min(
        (
            (_distance(at, to_pixel.transform(start), to_pixel.transform(end)), edge)
            for edge, segments in outline.sides.items()
            for start, end in segments
        ),
        default=(math.inf, ""),
    )
    return frozenset((found[1],)) if found[0] <= reach else frozenset()


def find_corner(outline: AreaOutline, point: QgsPointXY, reach: float) -> Corner | None:
    """Return the corner of polygons nearest to a point of the canvas, within ``reach`` in map units."""
    if not outline.corners:
        return None
    x, y = np.array([(place.x(), place.y()) for place in outline.corners.values()]).T
    distances = np.hypot(x - point.x(), y - point.y())
    nearest = int(distances.argmin())
    return list(outline.corners)[nearest] if distances[nearest] <= reach else None


def find_edge(outline: AreaOutline, point: QgsPointXY, reach: float) -> Corner | None:
    """Return the edge of polygons nearest to a point of the canvas, within ``reach`` in map units."""
    found = [(corner, *segment) for corner, segments in outline.edges.items() for segment in segments]
    if not found:
        return None
    x0, y0, x1, y1 = np.array([(one.x(), one.y(), other.x(), other.y()) for _, one, other in found]).T
    dx, dy, px, py = x1 - x0, y1 - y0, point.x() - x0, point.y() - y0
    length2 = np.maximum(dx * dx + dy * dy, np.finfo(float).tiny)
    along = np.clip((px * dx + py * dy) / length2, 0.0, 1.0)
    distances = np.hypot(px - along * dx, py - along * dy)
    nearest = int(distances.argmin())
    return found[nearest][0] if distances[nearest] <= reach else None


def point_lon_lat(
    point: QgsPointXY, crs: QgsCoordinateReferenceSystem, project: QgsProject
) -> tuple[float, float] | None:
    """Longitude and latitude of a point on the canvas; None outside the domain of the CRS."""
    try:
        return canvas_lon_lat(point, crs, project)
    except (InvalidInput, QgsCsException):
        return None


def contains(area: Area, lon_deg: float, lat_deg: float) -> bool:
    """Whether a place is in a box or polygon, or in the box around points."""
    box = area.bounds
    lon = box.west_deg + (lon_deg - box.west_deg) % 360.0
    if not (box.south_deg <= lat_deg <= box.north_deg and lon <= box.west_deg + box.span_deg):
        return False
    return not isinstance(area, (Polygon, Polygons)) or _degrees(area).contains(QgsPointXY(lon, lat_deg))


def moved(area: Area, dlat_deg: float, dlon_deg: float) -> Area:
    """Area moved by degrees: freely across the antimeridian, but limited in latitude.

    The limit is that of Web Mercator; an area beyond it may be moved up to the pole. A polygon around a pole is not
    moved, as that would change its shape.
    """
    bounds = area.bounds
    if isinstance(area, (Polygon, Polygons)) and bounds.span_deg >= 360.0:
        return area
    limit = _limit(max(abs(bounds.north_deg), abs(bounds.south_deg)))
    dlat = min(max(dlat_deg, -limit - bounds.south_deg), limit - bounds.north_deg)
    if isinstance(area, Box):
        north, south = min(area.north_deg + dlat, limit), max(area.south_deg + dlat, -limit)
        return continuous_box(north, area.west_deg + dlon_deg, south, area.continuous_east_deg + dlon_deg)
    if isinstance(area, Polygons):
        return Polygons(tuple(_moved_polygon(part, dlat, dlon_deg) for part in area.parts))
    if isinstance(area, Polygon):
        return _moved_polygon(area, dlat, dlon_deg)
    return replace(
        area,
        poses=tuple((_clamp_latitude(lat + dlat), wrap_longitude(lon + dlon_deg), agl) for lat, lon, agl in area.poses),
    )


def _moved_polygon(polygon: Polygon, dlat_deg: float, dlon_deg: float) -> Polygon:
    return Polygon(
        tuple(tuple((lon + dlon_deg, _clamp_latitude(lat + dlat_deg)) for lon, lat in ring) for ring in polygon.rings)
    )


def stretched(box: Box, edges: frozenset[str], dlat_deg: float, dlon_deg: float) -> Box:
    """Box with some edges (north, west, south, east) moved by degrees, but not past the opposite edge."""
    north, south = box.north_deg, box.south_deg
    west, east = box.west_deg, box.continuous_east_deg
    if "north" in edges:
        north = min(max(north + dlat_deg, south + LEAST_SPAN_DEG), _limit(abs(north)))
    if "south" in edges:
        south = max(min(south + dlat_deg, north - LEAST_SPAN_DEG), -_limit(abs(south)))
    if "west" in edges:
        west = max(min(west + dlon_deg, east - LEAST_SPAN_DEG), east - 360.0)
    if "east" in edges:
        east = min(max(east + dlon_deg, west + LEAST_SPAN_DEG), west + 360.0)
    return continuous_box(north, west, south, east)


def area_middle(area: Area) -> tuple[float, float]:
    """Longitude and latitude of the middle of an area's bounds."""
    box = area.bounds
    return wrap_longitude(box.west_deg + box.span_deg / 2.0), (box.north_deg + box.south_deg) / 2.0


def count_turns(area: Area, lon_deg: float) -> int:
    """Number of turns around the Earth from an area, whose longitudes continue beyond 180°, to a longitude."""
    box = area.bounds
    return round((lon_deg - box.west_deg - box.span_deg / 2.0) / 360.0)


def area_rings(area: Polygon | Polygons) -> list[list[list[Position]]]:
    """Rings of each polygon as (longitude, latitude), continuous from the west edge of the area's bounds."""
    if isinstance(area, Polygon):
        return [[list(ring) for ring in area.rings]]
    return [[list(zip(lon.tolist(), lat.tolist())) for lon, lat in part.arrays()] for part in area.placed()]


def polygon_geometry(rings: Sequence[Sequence[Position]]) -> QgsGeometry:
    """Geometry of a polygon's rings of longitudes and latitudes."""
    return QgsGeometry.fromPolygonXY([_closed(ring) for ring in rings])


def _closed(ring: Sequence[Position]) -> list[QgsPointXY]:
    return [QgsPointXY(*corner) for corner in (*ring, ring[0])]


def _degrees(area: Box | Polygon | Polygons) -> QgsGeometry:
    """Area as a geometry with continuous longitudes."""
    if isinstance(area, Box):
        return QgsGeometry.fromRect(QgsRectangle(*area.edges_deg))
    if isinstance(area, Polygon):
        return polygon_geometry(area.rings)
    return QgsGeometry.fromMultiPolygonXY([[_closed(ring) for ring in rings] for rings in area_rings(area)])


def _polygons(geometry: QgsGeometry) -> list[list[list[QgsPointXY]]]:
    if geometry.isEmpty():
        return []
    return geometry.asMultiPolygon() if geometry.isMultipart() else [geometry.asPolygon()]


def _placed(transform: QgsCoordinateTransform, lon_lat: QgsPointXY) -> QgsPointXY | None:
    try:
        place = transform.transform(lon_lat, Qgis.TransformDirection.Reverse)
    except QgsCsException:
        return None
    return _finite(place)


def _finite(place: QgsPointXY) -> QgsPointXY | None:
    return place if math.isfinite(place.x()) and math.isfinite(place.y()) else None


def _clip_pole(lat_deg: float) -> float:
    return min(max(lat_deg, -_BESIDE_POLE_DEG), _BESIDE_POLE_DEG)


def _between(start: Position, end: Position, share: float) -> Position:
    return start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])


def _steps(start: float, end: float) -> list[float]:
    return [start + (end - start) * step / _STEPS for step in range(_STEPS)] + [end]


def _distance(at: QgsPointXY, start: QgsPointXY, end: QgsPointXY) -> float:
    """Distance in pixels from a point to a segment."""
    dx, dy = end.x() - start.x(), end.y() - start.y()
    length2 = dx * dx + dy * dy
    along = 0.0
    if length2 > 0.0:
        along = ((at.x() - start.x()) * dx + (at.y() - start.y()) * dy) / length2
    along = min(max(along, 0.0), 1.0)
    return math.hypot(at.x() - start.x() - along * dx, at.y() - start.y() - along * dy)


def _clamp_latitude(lat_deg: float) -> float:
    """Latitude limited to ±90°, which rounding may exceed."""
    return min(max(lat_deg, -90.0), 90.0)


def move_latitude(lat_deg: float, dlat_deg: float) -> float:
    """Latitude moved by degrees, with the limits of `moved`."""
    limit = _limit(abs(lat_deg))
    return min(max(lat_deg + dlat_deg, -limit), limit)


def _limit(lat_deg: float) -> float:
    return MAX_LAT_DEG if lat_deg <= MAX_LAT_DEG else 90.0
