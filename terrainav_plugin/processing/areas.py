"""Areas out of what Processing hands over: extents, polygons and points in any CRS."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsCsException,
    QgsFeature,
    QgsGeometry,
    QgsProcessingFeatureSource,
)

from ...core.errors import InvalidInput
from ..compat import POINT, chosen_fields
from ..i18n import tr

if TYPE_CHECKING:
    from ...core.mission.area import Area, Box, Points, Polygon
    from .algorithm import Run


#: Latitude and longitude, which missions are in.
_GEOGRAPHIC = "EPSG:4326"
#: Pieces that the longest side of a polygon is cut in where its CRS is another: straight edges bend.
_PIECES = 256


def box_of_extent(run: Run) -> Box:
    """Box around an extent; raises InvalidInput."""
    from ...core.mission.area import Box

    geographic = QgsCoordinateReferenceSystem(_GEOGRAPHIC)
    try:
        extent = run.algorithm.parameterAsExtent(run.parameters, "EXTENT", run.context, geographic)
    except QgsCsException as wrong:
        raise InvalidInput(
            tr("extent: has no place in latitude and longitude ({error})").format(error=wrong)
        ) from wrong
    if extent.isNull() or not extent.isFinite():
        raise InvalidInput(
            tr("extent {text}: cannot be read; must be xmin,xmax,ymin,ymax [EPSG:code]").format(
                text=run.parameters.get("EXTENT")
            )
        )
    return Box(extent.yMaximum(), extent.xMinimum(), extent.yMinimum(), extent.xMaximum())


def area_of_layer(run: Run, agl_m: float) -> tuple[Area, float]:
    """Polygon or points of a layer, and the mission's height; raises InvalidInput."""
    source = run.algorithm.parameterAsSource(run.parameters, "AREA", run.context)
    if source is None:
        raise InvalidInput(tr("area {name}: no such layer").format(name=run.parameters.get("AREA")))
    features = _located(source, run)
    if not features:
        raise InvalidInput(tr("area {name}: has no features").format(name=source.sourceName()))
    if source.wkbType() and _is_points(features):
        fields = [
            next(iter(chosen_fields(run.algorithm, run.parameters, name, run.context)), None)
            for name in ("AGL_FIELD", "YAW_FIELD")
        ]
        points = _points(features, *fields, agl_m)
        return points, points.poses[0][2]
    return _polygon(features), agl_m


def _is_points(features: list[tuple[QgsFeature, QgsGeometry]]) -> bool:
    return all(geometry.type() == POINT for _, geometry in features)


def _located(source: QgsProcessingFeatureSource, run: Run) -> list[tuple[QgsFeature, QgsGeometry]]:
    """Features with their geometries in longitude and latitude."""
    geographic = QgsCoordinateReferenceSystem(_GEOGRAPHIC)
    to_geographic = QgsCoordinateTransform(source.sourceCrs(), geographic, run.context.transformContext())
    size = max(source.sourceExtent().width(), source.sourceExtent().height())
    found = []
    for feature in source.getFeatures():
        if run.feedback.isCanceled() or not feature.hasGeometry():
            continue
        geometry = QgsGeometry(feature.geometry())
        if source.sourceCrs() != geographic:
            if geometry.type() != POINT and size > 0.0:
                geometry = geometry.densifyByDistance(size / _PIECES)
            try:
                geometry.transform(to_geographic)
            except QgsCsException as wrong:
                raise InvalidInput(
                    tr("area {name}: has no place in latitude and longitude ({error})").format(
                        name=source.sourceName(), error=wrong
                    )
                ) from wrong
        found.append((feature, geometry))
    return found


def _points(
    features: list[tuple[QgsFeature, QgsGeometry]], agl_field: str | None, yaw_field: str | None, agl_m: float
) -> Points:
    from ...core.mission.area import Points

    poses, yaws = [], []
    for feature, geometry in features:
        agl = agl_m if agl_field is None else _value(feature, agl_field)
        for vertex in geometry.vertices():
            poses.append((vertex.y(), vertex.x(), agl))
            if yaw_field is not None:
                yaws.append(_value(feature, yaw_field))
    return Points(tuple(poses), tuple(yaws))


def _value(feature: QgsFeature, field: str) -> float:
    try:
        return float(feature[field])
    except (KeyError, TypeError, ValueError) as wrong:
        raise InvalidInput(
            tr("point {id}, field {field}: {value} is no number").format(
                id=feature.id(), field=field, value=feature.attribute(field)
            )
        ) from wrong


def _polygon(features: list[tuple[QgsFeature, QgsGeometry]]) -> Polygon:
    from ...core.mission.area import Polygon

    whole = QgsGeometry.unaryUnion([geometry for _, geometry in features])
    parts = whole.asMultiPolygon() if whole.isMultipart() else [whole.asPolygon()]
    if len(parts) != 1 or not parts[0]:
        raise InvalidInput(
            tr("area of {count} separate polygons: must be one; select one, or run it as a batch").format(
                count=len(parts)
            )
        )
    return Polygon(tuple(tuple((corner.x(), corner.y()) for corner in ring) for ring in parts[0]))
