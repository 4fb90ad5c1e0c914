"""Algorithm that flies along a line at constant speed, and writes poses with attitude and time."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsFeature,
    QgsGeometry,
    QgsPointXY,
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterString,
    QgsWkbTypes,
)
from qgis.PyQt.QtCore import QDateTime, Qt

from ...core.fields import declared_fields, field_named
from ...core.mission.parts import Flight, utc_time
from ...core.poses.settings import LineFlight
from ..form.fields import field_sentence, field_title
from ..i18n import tr
from .algorithm import Algorithm, AlgorithmRun, AlgorithmTexts, off_main_thread
from .areas import layer_crs, layer_features
from .mission_parameters import number_parameter
from .plan import fill, make_feature, make_fields

if TYPE_CHECKING:
    from ...core.mission.areas.area import Points


class PosesAlongLine(Algorithm):
    """Points of a flight along lines."""

    NAME = "posesalongline"

    def texts(self) -> AlgorithmTexts:
        """Return the texts of the algorithm."""
        return AlgorithmTexts(
            tr("Poses along a line"),
            tr("Points along lines that are flown at a speed, with height, yaw, roll and time."),
            tr("uav,drone,line,trajectory,flight,speed,turn,bank,yaw,points,poses"),
            (
                tr(
                    "Flies lines at a speed, one after another, and gives points at intervals of time or "
                    "distance. Corners become turns whose radius follows from speed and bank angle; "
                    "between short legs they are tighter and slower."
                ),
                tr(
                    "The points are an area for the other algorithms: choose their fields there for "
                    "height, yaw, roll and time."
                ),
            ),
        )

    def define(self) -> None:
        """Add the parameters and outputs."""
        lines = QgsProcessing.SourceType.TypeVectorLine
        self.add(
            QgsProcessingParameterFeatureSource("INPUT", tr("Lines"), [lines]),
            tr("Lines in any CRS; the first exposure is at the beginning of each."),
        )
        for one in (field_named(Flight, "agl_m"), *declared_fields(LineFlight)):
            name = one.name_of_option.upper()
            self.add(
                QgsProcessingParameterBoolean(name, field_title(one), one.default)
                if one.kind is bool
                else number_parameter(name, one, one.initial_value),
                field_sentence(one),
            )
        start = field_named(Flight, "start")
        self.add(QgsProcessingParameterString("START", field_title(start), start.default), field_sentence(start))
        self.addParameter(
            QgsProcessingParameterFeatureSink("OUTPUT", tr("Poses"), QgsProcessing.SourceType.TypeVectorPoint)
        )

    def prepared(self, run: AlgorithmRun) -> None:
        """Read the lines and the flight's parameters."""
        from ..area.layers import read_lines

        self._flight = LineFlight(
            run.number("SPEED"),
            *(run.number(name) if run.is_given(name) else None for name in ("EVERY_S", "EVERY_M")),
            run.number("BANK"),
            run.flag("FIXED_CAMERA"),
        )
        self._start_s = utc_time(run.text("START").strip()).timestamp()
        source = self.parameterAsSource(run.parameters, "INPUT", run.context)
        if source is None:
            raise QgsProcessingException(self.invalidSourceError(run.parameters, "INPUT"))
        self._lines = read_lines(
            layer_features(source),
            layer_crs(source),
            run.context.transformContext(),
            run.number("AGL"),
            run.feedback.isCanceled,
        )

    def processed(self, run: AlgorithmRun) -> dict[str, Any]:
        """Fly the lines and write the points."""
        from ...core.poses.line import fly
        from ..area.layers import describe_flight

        flown = off_main_thread(lambda _watch: fly(self._lines, self._flight, self._start_s), run.feedback)
        run.feedback.pushInfo(describe_flight(flown))
        sink, output = self.parameterAsSink(
            run.parameters,
            "OUTPUT",
            run.context,
            make_fields((("agl_m", "number"), ("yaw_deg", "number"), ("roll_deg", "number"), ("time", "time"))),
            QgsWkbTypes.Type.Point,
            QgsCoordinateReferenceSystem("EPSG:4326"),
        )
        if sink is None:
            raise QgsProcessingException(self.invalidSinkError(run.parameters, "OUTPUT"))
        fill(sink, _features(flown.points), len(flown.points.poses), run.feedback)
        return {"OUTPUT": output}


def _features(points: Points) -> Iterator[QgsFeature]:
    rolls = points.rolls_deg or (0.0,) * len(points.poses)
    for (lat, lon, agl), yaw, roll, time in zip(points.poses, points.yaws_deg, rolls, points.times_s):
        when = QDateTime.fromMSecsSinceEpoch(round(1000.0 * time), Qt.TimeSpec.UTC)
        yield make_feature(QgsGeometry.fromPointXY(QgsPointXY(lon, lat)), (agl, yaw, roll, when))
