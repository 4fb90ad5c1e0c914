"""Areas and no-fly areas from Processing parameters: extents, polygons and points in any CRS."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsCsException,
    QgsFeature,
    QgsFeatureIterator,
    QgsFeatureRequest,
    QgsProcessingFeatureSource,
)

from ...core.errors import InvalidInput
from ...core.text.plain import one_line
from ..compat import POINT, POLYGON, chosen_fields
from ..i18n import number_text, tr, translate
from ..tasks import required_crs

if TYPE_CHECKING:
    from ...core.mission.areas.area import Area, Box, Polygon, Polygons
    from .algorithm import AlgorithmRun


#: Attributes of points; each has a parameter for its field, such as AGL_FIELD.
POINT_FIELDS = ("agl", "yaw", "tilt", "gimbal_pitch", "roll", "time")
#: An extent or a point in QGIS's notation, with its CRS in square brackets.
_NUMBERS_OF_CRS = re.compile(r"(?:[^,\[\]]*,){1,3}[^,\[\]]*\[(.*)\]\s*", re.DOTALL)
#: CRS of missions.
_GEOGRAPHIC = "EPSG:4326"


def area_of_extent(run: AlgorithmRun) -> Box | Polygon:
    """Area of an extent, as for a rectangle drawn on the map; raises InvalidInput."""
    from ..area.layers import rectangle_area

    check_parameter_crs(run, "EXTENT")
    geographic = QgsCoordinateReferenceSystem(_GEOGRAPHIC)
    extent = run.algorithm.parameterAsExtent(run.parameters, "EXTENT", run.context)
    try:
        in_degrees = run.algorithm.parameterAsExtent(run.parameters, "EXTENT", run.context, geographic)
    except QgsCsException as wrong:
        raise InvalidInput(
            tr("extent: cannot be transformed to latitude and longitude ({error})").format(error=wrong)
        ) from wrong
    if extent.isNull() or not in_degrees.isFinite():
        raise InvalidInput(
            tr("extent {text}: cannot be read; must be xmin,xmax,ymin,ymax [EPSG:code]").format(
                text=run.parameters.get("EXTENT")
            )
        )
    # QGIS does not transform numbers without a CRS: they are degrees, not coordinates in the project's CRS.
    crs = (
        geographic
        if extent == in_degrees
        else run.algorithm.parameterAsExtentCrs(run.parameters, "EXTENT", run.context)
    )
    return rectangle_area(extent, crs, run.context)


def check_parameter_crs(run: AlgorithmRun, name: str) -> None:
    """Check the CRS of an extent or a point, if any, with `check_crs`; raises InvalidInput."""
    from ..map.canvas import check_crs

    named = _NUMBERS_OF_CRS.fullmatch(str(run.parameters.get(name)))
    if named is not None:
        crs, degrees = QgsCoordinateReferenceSystem(named[1].strip()), QgsCoordinateReferenceSystem(_GEOGRAPHIC)
        transform = QgsCoordinateTransform(crs, degrees, run.context.transformContext())
        check_crs(transform, f"[{one_line(named[1].strip())}]")


def area_of_layer(run: AlgorithmRun, agl_m: float) -> tuple[Area, float]:
    """Polygons or points of a layer, and the height of the mission; raises InvalidInput."""
    source = run.algorithm.parameterAsSource(run.parameters, "AREA", run.context)
    if source is None:
        raise InvalidInput(tr("area {name}: no such layer").format(name=run.parameters.get("AREA")))
    features = _features(run, source)
    if not features:
        raise InvalidInput(tr("area {name}: has no features").format(name=source.sourceName()))
    if source.wkbType() and all(feature.geometry().type() == POINT for feature in features):
        from ..area.layers import PointFields, read_points

        fields = {
            f"{name}_field": next(
                iter(chosen_fields(run.algorithm, run.parameters, f"{name}_field".upper(), run.context)), ""
            )
            for name in POINT_FIELDS
        }
        for field in filter(None, fields.values()):
            # QGIS checks field names only in its windows.
            if source.fields().lookupField(field) < 0:
                raise InvalidInput(
                    tr("area {name}: has no field {field}").format(name=source.sourceName(), field=field)
                )
        if fields["tilt_field"] and fields["gimbal_pitch_field"]:
            raise InvalidInput(tr("fields for tilt and gimbal pitch given: needs one of the two"))
        crs, context = layer_crs(source), run.context.transformContext()
        points = read_points(features, crs, context, PointFields(agl_m, **fields), run.feedback.isCanceled)
        return points, points.poses[0][2]
    name = tr("area {name}").format(name=source.sourceName())
    polygons = _polygons(run, features, source, name)
    if len(polygons) == 1:
        return polygons[0], agl_m
    run.feedback.pushInfo(
        tr("The area has {count} polygons: each gets separate rows.").format(count=number_text(len(polygons)))
    )
    return _together(polygons), agl_m


def no_fly_of_layer(run: AlgorithmRun) -> tuple[Polygon, ...]:
    """No-fly polygons of a layer; empty if the layer is empty or not given."""
    if not run.is_given("NO_FLY"):
        return ()
    source = run.algorithm.parameterAsSource(run.parameters, "NO_FLY", run.context)
    if source is None:
        raise InvalidInput(tr("no-fly areas {name}: no such layer").format(name=run.parameters.get("NO_FLY")))
    features = _features(run, source)
    name = tr("no-fly areas {name}").format(name=source.sourceName())
    return _polygons(run, features, source, name) if features else ()


def _together(polygons: tuple[Polygon, ...]) -> Polygons:
    from ...core.mission.areas.area import Polygons

    return Polygons(polygons)


def layer_crs(source: QgsProcessingFeatureSource) -> QgsCoordinateReferenceSystem:
    """CRS of a layer; raises InvalidInput if it has none."""
    return required_crs(source.sourceCrs(), source.sourceName())


def layer_features(source: QgsProcessingFeatureSource) -> QgsFeatureIterator:
    """Features of a layer, without QGIS's check of geometries; the callers check them.

    If QGIS's check fails, its C++ exception passes through Python (seen in 3.22), and the next call crashes QGIS.
    """
    unchecked = QgsProcessingFeatureSource.Flag.FlagSkipGeometryValidityChecks
    return source.getFeatures(QgsFeatureRequest(), unchecked)


def _features(run: AlgorithmRun, source: QgsProcessingFeatureSource) -> list[QgsFeature]:
    """Features of a layer with a non-empty geometry."""
    return [
        feature
        for feature in layer_features(source)
        if not run.feedback.isCanceled() and not feature.geometry().isEmpty()
    ]


def _polygons(
    run: AlgorithmRun, features: list[QgsFeature], source: QgsProcessingFeatureSource, name: str
) -> tuple[Polygon, ...]:
    """Polygons of features, including all parts, as for a layer in the panel; raises InvalidInput."""
    from ..area.layers import read_polygons

    crs, context = layer_crs(source), run.context.transformContext()
    if not any(feature.geometry().type() == POLYGON for feature in features):
        raise InvalidInput(tr("{layer}: has no polygons").format(layer=name))
    try:
        return read_polygons(features, crs, context, run.feedback.isCanceled).parts
    except InvalidInput as wrong:
        raise InvalidInput(tr("{layer}: {problem}").format(layer=name, problem=translate(wrong))) from wrong
