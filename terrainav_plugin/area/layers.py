"""Areas from the features of layers in any CRS and from files, read on a thread."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from qgis.core import (
    Qgis,
    QgsAbstractGeometry,
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsCoordinateTransformContext,
    QgsCsException,
    QgsFeature,
    QgsFeatureRequest,
    QgsGeometry,
    QgsMapLayer,
    QgsPointXY,
    QgsProcessingContext,
    QgsProject,
    QgsRectangle,
    QgsUnitTypes,
    QgsVectorLayer,
    QgsVectorLayerFeatureSource,
)
from qgis.PyQt.QtCore import QDateTime, Qt

from ...core.arrays import Floats
from ...core.errors import Cancelled, InvalidInput
from ...core.fields import field_named
from ...core.geodesy.ellipsoid import WGS84
from ...core.mission.areas.area import Area, Box, Points, Polygon, Polygons, Position, check_area
from ...core.mission.areas.coords import parse_coords
from ...core.mission.areas.files import load_area, load_no_fly
from ...core.mission.clock import check_column
from ...core.mission.parts import Attitude
from ...core.numbers import real_number
from ...core.poses.line import FlownLine, fly
from ...core.poses.reading import read_poses_file
from ...core.poses.settings import LineFlight, PoseFile
from ...core.text.plain import time_s
from ..compat import LINE, POINT, POLYGON
from ..form.area import angle_names
from ..i18n import number_text, tr, translate
from ..map.canvas import LON_LAT, check_crs, rectangle_box
from ..tasks import Task, required_crs
from .corners import nearest_turn
from .xml import xml_elements

#: Largest deviation in metres when an edge or curve of a layer becomes straight lines in degrees: about a pixel of the
#: sharpest imagery.
EDGE_TOLERANCE_M = 0.1
#: Share of the tolerance that is allowed at sampled points of an edge. Between them the deviation may be larger, but
#: less than twice as large, as such a short piece bends only one way.
_SAMPLED_SHARE = 0.5
_M_PER_DEG = math.pi / 180.0 * WGS84.a_m


class Found(NamedTuple):
    """An area that was read, the height of its first point in metres (None without), and a note for the user."""

    area: Area
    agl_m: float | None = None
    note: str = ""


#: Reads an area; takes the task that it reports progress to and that may be cancelled.
Reading = Callable[[Task], Found]


class PointFields(NamedTuple):
    """Sources of the heights, attitudes and times of points.

    Parameters
    ----------
    agl_m : float
        Height of all points if ``agl_field`` is empty.
    agl_field, yaw_field, tilt_field, gimbal_pitch_field, roll_field, time_field : str
        Names of attributes; empty if there is none. A gimbal pitch (-90 is straight down) replaces a tilt.
    m_per_unit : float
        Unit of the heights in ``agl_field``, in metres.
    """

    agl_m: float
    agl_field: str = ""
    yaw_field: str = ""
    tilt_field: str = ""
    gimbal_pitch_field: str = ""
    roll_field: str = ""
    time_field: str = ""
    m_per_unit: float = 1.0


def read_polygons(
    features: Iterable[QgsFeature],
    crs: QgsCoordinateReferenceSystem,
    context: QgsCoordinateTransformContext,
    cancelled: Callable[[], bool] = lambda: False,
) -> Polygon | Polygons:
    """Polygons of all features and their parts, on WGS84; polygons that touch are merged.

    Edges are straight in the layer's CRS. They get intermediate corners, so that the edges between these, straight in
    degrees, deviate by at most `EDGE_TOLERANCE_M`; curves become edges within the same tolerance.

    Raises
    ------
    InvalidInput
        There is no feature, or a feature lacks a valid polygon or has a hole around a pole (the message names it).
    Cancelled
        ``cancelled`` has returned True.
    """
    found: list[QgsGeometry] = []
    shapes: list[list[list[QgsPointXY]]] = []
    name = ""
    for feature in features:
        if cancelled():
            raise Cancelled
        name = tr("feature {id}").format(id=feature.id())
        geometry = _straight(feature.geometry(), crs)
        if geometry.isEmpty():
            raise InvalidInput(tr("{feature} has no geometry: select one that has").format(feature=name))
        if geometry.type() != POLYGON:
            raise InvalidInput(tr("{feature} is not a polygon: select one that is").format(feature=name))
        _refuse_invalid(geometry, name)
        found.append(geometry)
        shapes += _polygon_rings(geometry)
    if not found:
        raise InvalidInput(tr("no polygon is selected: select at least one in its layer"))
    if len(found) > 1:
        name = tr("area of {count} features").format(count=len(found))
        # Merge neighbouring parcels; if none touch, leave all corners as they are.
        joined = _polygon_rings(QgsGeometry.unaryUnion(found))
        shapes = joined if len(joined) < len(shapes) else shapes
    area = Polygons(tuple(polygon_of_rings(rings, crs, context, name) for rings in shapes))
    check_area(area)
    return area if len(area.parts) > 1 else area.parts[0]


def polygon_of_rings(
    rings: list[list[QgsPointXY]],
    crs: QgsCoordinateReferenceSystem,
    context: QgsCoordinateTransformContext,
    name: str,
    tolerance_m: float = EDGE_TOLERANCE_M,
) -> Polygon:
    """Polygon of closed rings, the outer one first, with intermediate corners as in `read_polygons`.

    Parameters
    ----------
    tolerance_m : float
        Largest deviation of edges, in metres on the ground.

    Raises
    ------
    InvalidInput
        A corner is outside the CRS, an edge passes through a pole, or a hole surrounds a pole; the message has
        ``name``.
    """
    place = _Places(crs, context, name, tolerance_m)
    return Polygon(tuple(tuple(_ring(ring, place, name, is_hole=number > 0)) for number, ring in enumerate(rings)))


def read_points(
    features: Iterable[QgsFeature],
    crs: QgsCoordinateReferenceSystem,
    context: QgsCoordinateTransformContext,
    fields: PointFields,
    cancelled: Callable[[], bool] = lambda: False,
) -> Points:
    """Points of all features and their parts, in order of time if they have times.

    Raises
    ------
    InvalidInput
        There is no feature, or a feature lacks a point, or its height, angle or time is missing or outside the domain
        (the message names the feature).
    Cancelled
        ``cancelled`` has returned True.
    """
    poses: list[tuple[float, float, float]] = []
    own: dict[str, list[float]] = {}
    for number, feature in enumerate(features):
        # Check for cancellation every 256 features.
        if number % 256 == 0 and cancelled():
            raise Cancelled
        name = tr("feature {id}").format(id=feature.id())
        agl, values = _agl_m(feature, fields, name), _point_values(feature, fields, name)
        place = _Places(crs, context, name)
        for point in _points(feature.geometry(), name):
            lon, lat = place(point)
            poses.append((lat, lon, agl))
            for what, value in values.items():
                own.setdefault(what, []).append(value)
    if not poses:
        raise InvalidInput(tr("no points to use: select some, or use all points of the layer"))
    if "times_s" in own:
        order = sorted(range(len(poses)), key=own["times_s"].__getitem__)
        poses = [poses[at] for at in order]
        own = {what: [values[at] for at in order] for what, values in own.items()}
        check_column(own["times_s"], tr("points"))
    return Points(tuple(poses), **{what: tuple(values) for what, values in own.items()})


def read_lines(
    features: Iterable[QgsFeature],
    crs: QgsCoordinateReferenceSystem,
    context: QgsCoordinateTransformContext,
    agl_m: float,
    cancelled: Callable[[], bool] = lambda: False,
) -> list[Floats]:
    """Lines of all features and their parts, as `core.poses.line.fly` takes them.

    Edges get intermediate corners as in `read_polygons`.

    Raises
    ------
    InvalidInput
        There is no feature, or a feature lacks a line or has an edge through a pole (the message names it).
    Cancelled
        ``cancelled`` has returned True.
    """
    lines: list[Floats] = []
    for feature in features:
        if cancelled():
            raise Cancelled
        name = tr("feature {id}").format(id=feature.id())
        place = _Places(crs, context, name)
        for part in _line_parts(_straight(feature.geometry(), crs), name):
            corners = [place(part[0])]
            for start, end in zip(part, part[1:]):
                corners += _edge(start, end, place, name)
            lines.append(np.array([(lat, lon, agl_m) for lon, lat in corners]))
    if not lines:
        raise InvalidInput(tr("no lines to fly: select some, or use all lines of the layer"))
    return lines


class ReadTask(Task):
    """Read an area in the background.

    Attributes
    ----------
    found : Found or None
        Set once the task has succeeded.
    step : str
        Name of the undo step.
    """

    def __init__(self, step: str, read: Reading) -> None:
        super().__init__(tr("Reading the area"))
        self.step = step
        self.found: Found | None = None
        self._read = read

    def work(self) -> None:
        """Read."""
        self.found = self._read(self)


def polygons(layer: QgsVectorLayer, project: QgsProject, only_selected: bool = True) -> Reading:
    """Reader of the polygons of a layer."""
    crs, context = _crs(layer), project.transformContext()
    # A snapshot, as the layer itself belongs to the main thread.
    source = QgsVectorLayerFeatureSource(layer)
    request = _selected(layer) if only_selected else QgsFeatureRequest()
    return lambda task: Found(read_polygons(source.getFeatures(request), crs, context, task.isCanceled))


def points(layer: QgsVectorLayer, only_selected: bool, fields: PointFields, project: QgsProject) -> Reading:
    """Reader of the points of a layer."""
    crs, context = _crs(layer), project.transformContext()
    source = QgsVectorLayerFeatureSource(layer)
    request = _selected(layer) if only_selected else QgsFeatureRequest()

    def read(task: Task) -> Found:
        found = read_points(source.getFeatures(request), crs, context, fields, task.isCanceled)
        return Found(found, found.poses[0][2])

    return read


def flown_lines(
    layer: QgsVectorLayer, flight: LineFlight, agl_m: float, start_s: float, project: QgsProject
) -> Reading:
    """Reader of points along the lines of a layer (see `line_reader`), flown one after another."""

    def flown(lines: list[Floats]) -> Found:
        found = fly(lines, flight, start_s)
        return Found(found.points, agl_m, describe_flight(found))

    return line_reader(layer, agl_m, flown, project)


def line_reader(
    layer: QgsVectorLayer, agl_m: float, made: Callable[[list[Floats]], Found], project: QgsProject
) -> Reading:
    """Reader that applies ``made`` to the selected lines of a layer, or to all if none is selected."""
    crs, context = _crs(layer), project.transformContext()
    source, request = QgsVectorLayerFeatureSource(layer), _selected_or_all(layer)

    def read(task: Task) -> Found:
        return made(read_lines(source.getFeatures(request), crs, context, agl_m, task.isCanceled))

    return read


def outline_reader(layer: QgsVectorLayer, made: Callable[[list[Box | Polygon]], Found], project: QgsProject) -> Reading:
    """Reader that applies ``made`` to the selected polygons of a layer, unmerged, or to all if none is selected."""
    crs, context = _crs(layer), project.transformContext()
    source, request = QgsVectorLayerFeatureSource(layer), _selected_or_all(layer)

    def read(task: Task) -> Found:
        features = source.getFeatures(request)
        shapes = (read_polygons([one], crs, context, task.isCanceled) for one in features)
        return made([outline for shape in shapes for outline in shape.parts])

    return read


def describe_flight(flown: FlownLine) -> str:
    """Text on the deviation of a flight from its line, and on its slow turns."""
    words = tr("The flight misses the corners of its line by up to {missed} m.").format(
        missed=number_text(flown.missed_m, ",.1f")
    )
    if not flown.tight:
        return words
    slow = tr("Tighter turns between short legs: {count}, flown at speeds down to {speed} m/s.")
    return f"{words} " + slow.format(count=number_text(flown.tight), speed=number_text(flown.slowest_m_per_s, ".1f"))


def text_file(path: str, agl_unit: str) -> Reading:
    """Reader of a file of points."""
    return lambda _task: Found(*parse_coords(path, agl_unit=agl_unit))


def pose_file(path: str, how: PoseFile) -> Reading:
    """Reader of the poses in a trajectory or flight log."""

    def read(task: Task) -> Found:
        found = read_poses_file(path, how, xml_elements, task.report_progress)
        note = tr("{count} of {total} positions are left out, {reason}.")
        total = number_text(found.positions)
        notes = (
            note.format(count=number_text(count), total=total, reason=translate(reason))
            for reason, count in found.why_left_out.items()
        )
        return Found(found.points, found.points.poses[0][2], " ".join(notes))

    return read


def area_file(path: str) -> Reading:
    """Reader of the polygons of a GeoJSON, KML or KMZ file, as an area."""
    return lambda _task: Found(load_area(path, xml_elements))


def no_fly_file(path: str) -> Reading:
    """Reader of the polygons of a GeoJSON, KML or KMZ file, as no-fly areas."""
    return lambda _task: Found(Polygons(load_no_fly(path, xml_elements)))


def rectangle_area(
    rectangle: QgsRectangle, crs: QgsCoordinateReferenceSystem, project: QgsProject | QgsProcessingContext
) -> Box | Polygon:
    """Area of a rectangle of a map: its bounding box, or a polygon if the box is much larger.

    The box is much larger on polar maps, and wherever the map's axes are far from parallels and meridians.

    Raises
    ------
    InvalidInput
        The rectangle leaves the domain of the CRS.
    """
    box = rectangle_box(rectangle, crs, project)
    if crs.isGeographic():
        return box
    west, south, east, north = (
        rectangle.xMinimum(),
        rectangle.yMinimum(),
        rectangle.xMaximum(),
        rectangle.yMaximum(),
    )
    ring = [QgsPointXY(*at) for at in ((west, south), (east, south), (east, north), (west, north))]
    try:
        polygon = polygon_of_rings([[*ring, ring[0]]], crs, project.transformContext(), tr("rectangle"))
    except InvalidInput:
        # The rectangle reaches the edge of the map, which its box follows.
        return box
    # Prefer the box if it is at most half as large again as the rectangle.
    return polygon if box.area_m2() > 1.5 * polygon.area_m2() else box


def layer_extent_area(layer: QgsMapLayer, project: QgsProject) -> Area:
    """Area of a layer's extent, as from `rectangle_area`.

    Raises
    ------
    InvalidInput
        The layer is empty or has no CRS.
    """
    extent = layer.extent()
    if extent.isNull() or not extent.isFinite():
        raise InvalidInput(tr("layer “{name}” is empty: it has no extent").format(name=layer.name()))
    return rectangle_area(extent, _crs(layer), project)


class _Places:
    """Transformation of a layer's points to degrees, with the tolerance of edges."""

    def __init__(
        self,
        crs: QgsCoordinateReferenceSystem,
        context: QgsCoordinateTransformContext,
        feature: str,
        tolerance_m: float = EDGE_TOLERANCE_M,
    ) -> None:
        self._transform = QgsCoordinateTransform(crs, QgsCoordinateReferenceSystem(LON_LAT), context)
        self._crs, self._feature = crs.authid() or crs.description(), feature
        check_crs(self._transform)
        self.sampled_tolerance_m = _SAMPLED_SHARE * tolerance_m

    def __call__(self, point: QgsPointXY) -> Position:
        """Longitude and latitude in degrees; raises InvalidInput outside the domain of the CRS."""
        try:
            there = self._transform.transform(point)
        except QgsCsException as wrong:
            raise self._outside(point) from wrong
        if not (math.isfinite(there.x()) and abs(there.y()) <= 90.0):
            raise self._outside(point)
        return there.x(), there.y()

    def _outside(self, point: QgsPointXY) -> InvalidInput:
        return InvalidInput(
            tr("{feature}: {x}, {y} is outside the domain of {crs}").format(
                feature=self._feature,
                x=number_text(point.x(), ".10g"),
                y=number_text(point.y(), ".10g"),
                crs=self._crs,
            )
        )


def _straight(geometry: QgsGeometry, crs: QgsCoordinateReferenceSystem) -> QgsGeometry:
    """Geometry with curves replaced by straight edges."""
    shape = geometry.constGet()
    if shape is None or not shape.hasCurvedSegments():
        return geometry
    m_per_unit = (
        _M_PER_DEG
        if crs.isGeographic()
        else QgsUnitTypes.fromUnitToUnitFactor(crs.mapUnits(), QgsUnitTypes.DistanceUnit.DistanceMeters)
    )
    kind = QgsAbstractGeometry.SegmentationToleranceType.MaximumDifference
    return QgsGeometry(shape.segmentize(_SAMPLED_SHARE * EDGE_TOLERANCE_M / m_per_unit, kind))


def _polygon_rings(geometry: QgsGeometry) -> list[list[list[QgsPointXY]]]:
    """Rings of each polygon of a geometry."""
    return geometry.asMultiPolygon() if geometry.isMultipart() else [geometry.asPolygon()]


def _refuse_invalid(geometry: QgsGeometry, name: str) -> None:
    errors = geometry.validateGeometry(Qgis.GeometryValidationEngine.Geos)
    if errors:
        where = errors[0]
        what = where.what()
        if where.hasWhere():
            what += f" ({number_text(where.where().x(), '.10g')}, {number_text(where.where().y(), '.10g')})"
        raise InvalidInput(
            tr("{feature} is not a valid polygon ({what}): repair it first (Processing: Fix geometries)").format(
                feature=name, what=what
            )
        )


def _ring(ring: list[QgsPointXY], place: _Places, name: str, *, is_hole: bool = False) -> Sequence[Position]:
    """Open ring in degrees with continuous longitudes; a ring around a pole is closed along the pole."""
    first = place(ring[0])
    corners = [first]
    for start, end in zip(ring, ring[1:]):
        for lon, lat in _edge(start, end, place, name):
            corners.append((nearest_turn(lon, corners[-1][0]), lat))
    if abs(corners[-1][0] - first[0]) > 180.0:
        if is_hole:
            raise InvalidInput(
                tr("{feature} has a hole around a pole: cut it into parts without one").format(feature=name)
            )
        return _close_along_pole(corners)
    if len(corners) > 1 and corners[-1] == first:
        corners.pop()
    return corners


def _close_along_pole(corners: list[Position]) -> list[Position]:
    """Ring for corners around a pole (the last is the first, a turn on): from 180° W to 180° E, back along the pole."""
    if corners[-1][0] < corners[0][0]:
        corners.reverse()
    west = math.floor((corners[0][0] + 180.0) / 360.0) * 360.0 + 180.0
    cut = next(at for at, (lon, _) in enumerate(corners) if lon >= west)
    (lon0, lat0), (lon1, lat1) = corners[cut - 1 : cut + 1]
    lat = lat0 + (west - lon0) / (lon1 - lon0) * (lat1 - lat0)
    after = [(x - west - 180.0, y) for x, y in corners[cut:] if x != west]
    # Skip the first corner, which is repeated at the end.
    before = [(x - west + 180.0, y) for x, y in corners[1:cut]]
    pole = math.copysign(90.0, corners[0][1])
    # Corners along the pole must be less than half a turn apart.
    along = [(share * 180.0, pole) for share in (1.0, 1.0 / 3.0, -1.0 / 3.0, -1.0)]
    return [(-180.0, lat), *after, *before, (180.0, lat), *along]


def _edge(start: QgsPointXY, end: QgsPointXY, place: _Places, name: str) -> Iterator[Position]:
    """Corners after ``start`` up to ``end``, as many as the tolerance of the edge requires."""
    # A stack instead of recursion; the piece nearest to ``start`` is last.
    pieces = [(start, place(start), end, place(end), 0)]
    while pieces:
        one, here, other, there, depth = pieces.pop()
        if _is_straight(one, here, other, there, place):
            yield there
            continue
        # An edge that is still curved after 24 halvings crosses a pole or the edge of the map.
        if depth == 24:
            raise InvalidInput(
                tr("{feature} has an edge through a pole or across the edge of its map: cut it").format(feature=name)
            )
        middle = QgsPointXY((one.x() + other.x()) / 2.0, (one.y() + other.y()) / 2.0)
        between = place(middle)
        pieces += [(middle, between, other, there, depth + 1), (one, here, middle, between, depth + 1)]


def _is_straight(one: QgsPointXY, here: Position, other: QgsPointXY, there: Position, place: _Places) -> bool:
    dlon, dlat = nearest_turn(there[0], here[0]) - here[0], there[1] - here[1]
    for share in (0.25, 0.5, 0.75):
        lon, lat = place(QgsPointXY(one.x() + share * (other.x() - one.x()), one.y() + share * (other.y() - one.y())))
        wanted = here[0] + share * dlon
        east = (nearest_turn(lon, wanted) - wanted) * math.cos(math.radians(lat))
        north = lat - (here[1] + share * dlat)
        if math.hypot(east, north) * _M_PER_DEG > place.sampled_tolerance_m:
            return False
    return True


def _points(geometry: QgsGeometry, name: str) -> list[QgsPointXY]:
    if geometry.isEmpty():
        raise InvalidInput(tr("{feature} has no geometry: give it a point, or leave it out").format(feature=name))
    if geometry.type() != POINT:
        raise InvalidInput(tr("{feature} is not a point: choose a layer of points").format(feature=name))
    return geometry.asMultiPoint() if geometry.isMultipart() else [geometry.asPoint()]


def _line_parts(geometry: QgsGeometry, name: str) -> list[list[QgsPointXY]]:
    if geometry.isEmpty():
        raise InvalidInput(tr("{feature} has no geometry: give it a line, or leave it out").format(feature=name))
    if geometry.type() != LINE:
        raise InvalidInput(tr("{feature} is not a line: choose a layer of lines").format(feature=name))
    return geometry.asMultiPolyline() if geometry.isMultipart() else [geometry.asPolyline()]


def _agl_m(feature: QgsFeature, fields: PointFields, name: str) -> float:
    if not fields.agl_field:
        return fields.agl_m
    what = tr("{feature}: height in “{field}”").format(feature=name, field=fields.agl_field)
    agl = _number(feature, fields.agl_field, what) * fields.m_per_unit
    if not agl > 0.0:
        raise InvalidInput(tr("{what} is {value} m: must be above 0").format(what=what, value=number_text(agl, "g")))
    return agl


def _point_values(feature: QgsFeature, fields: PointFields, name: str) -> dict[str, float]:
    """Angles and time of a feature's points, by their names in `Points`."""
    found = {}
    for angle, field in (
        ("yaw", fields.yaw_field),
        ("tilt", fields.tilt_field),
        ("gimbal_pitch", fields.gimbal_pitch_field),
        ("roll", fields.roll_field),
    ):
        if not field:
            continue
        what = tr("{feature}: {what} in “{field}”").format(feature=name, what=angle_names()[angle], field=field)
        degrees = _number(feature, field, what)
        declared = None if angle == "gimbal_pitch" else field_named(Attitude, f"{angle}_deg")
        least, most = (-180.0, 90.0) if declared is None else (declared.least, declared.most)
        if not least <= degrees <= most:
            raise InvalidInput(
                tr("{what} is {value}°: must be from {least} to {most}").format(
                    what=what, value=number_text(degrees, "g"), least=f"{least:g}", most=f"{most:g}"
                )
            )
        found.update({"tilts_deg": 90.0 + degrees} if angle == "gimbal_pitch" else {f"{angle}s_deg": degrees})
    if fields.time_field:
        what = tr("{feature}: time in “{field}”").format(feature=name, field=fields.time_field)
        found["times_s"] = _time_s(feature, fields.time_field, what)
    return found


def _time_s(feature: QgsFeature, field: str, what: str) -> float:
    """Unix time in seconds from an attribute: a date and time (UTC if without a zone), a number or a text."""
    value = feature.attribute(field)
    if isinstance(value, QDateTime) and value.isValid():
        if value.timeSpec() == Qt.TimeSpec.LocalTime:
            value = QDateTime(value.date(), value.time(), Qt.TimeSpec.UTC)
        return value.toMSecsSinceEpoch() / 1000.0
    if isinstance(value, str):
        try:
            return real_number(value.replace(",", "."))
        except ValueError:
            return time_s(value, f"{what}:")
    return _number(feature, field, what)


def _number(feature: QgsFeature, field: str, what: str) -> float:
    """Number in an attribute, which may be text."""
    value = feature.attribute(field)
    # PyQt 5 returns NULL as a QVariant, PyQt 6 as None.
    if value is None or (hasattr(value, "isNull") and value.isNull()):
        raise InvalidInput(tr("{what} is empty (NULL): must be a number").format(what=what))
    try:
        is_text, is_flag = isinstance(value, str), isinstance(value, bool)
        number = real_number(value) if is_text else math.nan if is_flag else float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise InvalidInput(tr("{what} is “{value}”: must be a number").format(what=what, value=value))
    return number


def _crs(layer: QgsMapLayer) -> QgsCoordinateReferenceSystem:
    return required_crs(layer.crs(), layer.name())


def _selected(layer: QgsVectorLayer) -> QgsFeatureRequest:
    return QgsFeatureRequest().setFilterFids(layer.selectedFeatureIds())


def _selected_or_all(layer: QgsVectorLayer) -> QgsFeatureRequest:
    return _selected(layer) if layer.selectedFeatureCount() else QgsFeatureRequest()
