"""Algorithm: a mission worked out, as layers, numbers and files. Fetches no imagery."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsFeature,
    QgsFeatureSink,
    QgsProcessing,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingOutputNumber,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFileDestination,
    QgsWkbTypes,
)

from ..i18n import told, tr
from . import features
from .algorithm import Algorithm, paragraphs, run_beside
from .mission_parameters import add_mission_parameters, mission_of

if TYPE_CHECKING:
    from ...core.mission.estimate import Summary
    from ...core.mission.plan import Plan as WorkedOut

#: Features written between two looks at whether the user has cancelled.
_BATCH = 1000
_PERCENT = 100.0


class Plan(Algorithm):
    """Footprints, captures and flight line of a mission."""

    NAME = "plan"

    def displayName(self) -> str:
        """Title."""
        return tr("Plan a mission")

    def shortDescription(self) -> str:
        """Tooltip."""
        return tr("Footprints, coverage and figures of a simulated UAV flight; fetches nothing.")

    def tags(self) -> list[str]:
        """Words that it is found by."""
        return tr("uav,drone,mission,plan,footprint,flight,overlap,coverage,photogrammetry,waypoints").split(
            ","
        )

    def shortHelpString(self) -> str:
        """Help."""
        return paragraphs(
            tr(
                "Works a mission out and fetches no imagery: where each picture is taken, which ground it shows, when "
                "on the flight, and what the whole takes."
            ),
            tr(
                "Footprints are those of the pictures that a capture of the same mission writes. Coverage and overlap "
                "are counted on the pixels that the files will show; the error bound is that of the methods chosen."
            ),
            tr("Give the area as an extent, as a layer of one polygon or of points, or as coordinates."),
        )

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:  # noqa: ARG002  QGIS passes it
        """Add parameters and outputs."""
        add_mission_parameters(self, listed=self._listed)
        kinds = QgsProcessing.SourceType
        for name, title, kind, usual in (
            ("FOOTPRINTS", tr("Footprints"), kinds.TypeVectorPolygon, True),
            ("CAPTURES", tr("Captures"), kinds.TypeVectorPoint, False),
            ("FLIGHT", tr("Flight line"), kinds.TypeVectorLine, False),
        ):
            self.addParameter(
                QgsProcessingParameterFeatureSink(
                    name, title, kind, optional=not usual, createByDefault=usual
                )
            )
        for name, title, ending in (
            ("MISSION_FILE", tr("Mission as a file"), tr("Mission files (*.json)")),
            ("EXPORT", tr("Plan as a file"), tr("All files (*.*)")),
        ):
            file = QgsProcessingParameterFileDestination(
                name, title, ending, optional=True, createByDefault=False
            )
            self.addParameter(file)
        for name, title in _figures().items():
            self.addOutput(QgsProcessingOutputNumber(name, title))

    def prepared(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> None:
        """Read the mission, and the grid of layers of the project."""
        from ..sources import grid_finder

        self._mission = mission_of(self, parameters, context, feedback)
        self._grid = grid_finder(self._mission)
        self._export = self.parameterAsFileOutput(parameters, "EXPORT", context)
        if self._export:
            from ...core.mission.export import check_plan_ending

            check_plan_ending(self._export)

    def processed(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """Plan, and write what is asked for."""
        from ...core.mission.estimate import estimate
        from ...core.mission.plan import plan
        from ..settings import Settings
        from ..sources import costs_of

        def work(_watch: object) -> tuple[WorkedOut, Summary]:
            worked_out = plan(self._mission, self._grid())
            costs, connections = costs_of(self._mission.source), Settings().connections
            return worked_out, estimate(worked_out, costs, connections, os.cpu_count() or 1)

        worked_out, summary = run_beside(work, feedback)
        for label, text in summary.lines():
            tell = feedback.pushWarning if label == "warning" else feedback.pushInfo
            tell(f"{told(label)}: {told(text)}")
        results: dict[str, Any] = _values(summary)
        kinds = QgsWkbTypes.Type
        for name, found, kind, fields in (
            ("FOOTPRINTS", features.footprints, kinds.MultiPolygon, features.capture_fields()),
            ("CAPTURES", features.captures, kinds.Point, features.capture_fields()),
            (
                "FLIGHT",
                lambda one: [features.flight_line(one)],
                kinds.MultiLineString,
                features.flight_fields(),
            ),
        ):
            if parameters.get(name) is None:
                continue
            crs = QgsCoordinateReferenceSystem(features.CRS)
            sink, results[name] = self.parameterAsSink(parameters, name, context, fields, kind, crs)
            if sink is None:
                raise QgsProcessingException(self.invalidSinkError(parameters, name))
            _fill(sink, found(worked_out), len(worked_out), feedback)
            del sink
        self._write_files(worked_out, parameters, context, feedback, results)
        return results

    def _write_files(
        self,
        worked_out: WorkedOut,
        parameters: dict[str, Any],
        context: QgsProcessingContext,
        feedback: QgsProcessingFeedback,
        results: dict[str, Any],
    ) -> None:
        from ...core.mission.export import write_plan

        path = self.parameterAsFileOutput(parameters, "MISSION_FILE", context)
        if path:
            self._mission.save(path)
            results["MISSION_FILE"] = path
        if self._export:
            exported = write_plan(worked_out, self._export)
            for file in exported.files:
                feedback.pushInfo(tr("Written: {file}").format(file=file))
            for note in exported.notes:
                feedback.pushInfo(told(note))
            # A flight too long for one file is in several.
            results["EXPORT"] = str(exported.files[0])


def _fill(
    sink: QgsFeatureSink, found: Iterable[QgsFeature], count: int, feedback: QgsProcessingFeedback
) -> None:
    for done, feature in enumerate(found):
        if done % _BATCH == 0:
            feedback.setProgress(_PERCENT * done / count)
            if feedback.isCanceled():
                return
        if not sink.addFeature(feature, QgsFeatureSink.Flag.FastInsert):
            raise QgsProcessingException(
                tr("The layer cannot be written: {reason}").format(reason=sink.lastError())
            )


def _figures() -> dict[str, str]:
    return {
        "IMAGES": tr("Images of one map type"),
        "COVERAGE": tr("Coverage (percent)"),
        "OVERLAP_LEAST_ALONG": tr("Least overlap along rows (share)"),
        "OVERLAP_LEAST_ACROSS": tr("Least overlap across rows (share)"),
        "REQUESTED_GSD": tr("Ground sample distance requested (metres)"),
        "DELIVERED_GSD": tr("Ground sample distance delivered (metres)"),
        "CHOSEN_ZOOM": tr("Zoom of the plan"),
        "TILES": tr("Tiles of one map type"),
        "DOWNLOAD_BYTES": tr("Download (bytes)"),
        "FILE_BYTES": tr("Files (bytes)"),
        "CAPTURE_S": tr("Time of the capture (seconds)"),
        "FLIGHT_M": tr("Flight distance (metres)"),
        "FLIGHT_S": tr("Flight time (seconds)"),
        "ERROR_BOUND": tr("Bound of the error (px)"),
    }


def _values(summary: Summary) -> dict[str, Any]:
    """Values of the numbers; those that have no meaning, such as a coverage of points, are left out."""
    share = summary.covered_share
    values = {
        "IMAGES": summary.images,
        "COVERAGE": None if share is None else _PERCENT * share,
        "OVERLAP_LEAST_ALONG": summary.least_overlap_along,
        "OVERLAP_LEAST_ACROSS": summary.least_overlap_across,
        "REQUESTED_GSD": summary.requested_gsd_m_per_px,
        "DELIVERED_GSD": summary.delivered_gsd_m_per_px,
        "CHOSEN_ZOOM": summary.zoom,
        "TILES": summary.unique_tiles,
        "DOWNLOAD_BYTES": summary.download_bytes,
        "FILE_BYTES": summary.output_bytes,
        "CAPTURE_S": summary.seconds,
        "FLIGHT_M": summary.flight_distance_m,
        "FLIGHT_S": summary.flight_s,
        "ERROR_BOUND": summary.accuracy.bound_px,
    }
    return {name: value for name, value in values.items() if value is not None}
