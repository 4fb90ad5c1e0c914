"""Algorithm that plans a mission and writes the plan as layers, numbers and files. Fetches no imagery."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsFeature,
    QgsFeatureSink,
    QgsFields,
    QgsGeometry,
    QgsPointXY,
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterMultipleLayers,
    QgsWkbTypes,
)
from qgis.PyQt.QtCore import QDateTime, Qt

from ...core.errors import InvalidInput
from ...core.mission.parts import ALIGNMENTS
from ..compat import field
from ..i18n import tr, translate
from ..tasks import crs_named, read_crs_on_main_thread
from .algorithm import Algorithm, AlgorithmRun, AlgorithmTexts, WorkFeedback, off_main_thread
from .choices import ChoiceParameter
from .mission_parameters import add_mission_parameters, read_mission

if TYPE_CHECKING:
    from ...core.mission.estimate import Summary
    from ...core.mission.mission import Mission
    from ...core.mission.plan import Plan

_PERCENT = 100.0
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


class PlanAlgorithm(Algorithm):
    """Footprints, captures and flight line of a mission."""

    NAME = "plan"

    def texts(self) -> AlgorithmTexts:
        """Return the texts of the algorithm."""
        return AlgorithmTexts(
            tr("Plan a mission"),
            tr("Footprints, coverage and figures of a simulated UAV flight; fetches nothing."),
            tr("uav,drone,mission,plan,footprint,flight,overlap,coverage,photogrammetry,waypoints"),
            (
                tr(
                    "Plans a mission without fetching imagery: the position, ground and time of each image, and "
                    "the time and data that the capture needs."
                ),
                tr(
                    "Footprints are those of the images that a capture of the same mission writes. Coverage and "
                    "overlap are counted on the pixels that the files will show; the error bound is that of the "
                    "methods chosen."
                ),
                tr("Give the area as an extent, as a layer of polygons or of points, or as coordinates."),
            ),
        )

    def define(self) -> None:
        """Add the parameters and outputs."""
        from ..missions.plan_export import file_filters

        add_mission_parameters(self, listed=self._listed)
        self.add(
            ChoiceParameter("ALIGN", tr("Align rows"), {way: way for way in ALIGNMENTS}),
            tr(
                "Turns the rows along the longest side of the area or for the shortest flight, instead "
                "of by the row azimuth; the mission file has the azimuth found."
            ),
        )
        kinds = QgsProcessing.SourceType
        for name, title, kind, usual in (
            ("FOOTPRINTS", tr("Footprints"), kinds.TypeVectorPolygon, True),
            ("CAPTURES", tr("Captures"), kinds.TypeVectorPoint, False),
            ("FLIGHT", tr("Flight line"), kinds.TypeVectorLine, False),
        ):
            self.addParameter(
                QgsProcessingParameterFeatureSink(name, title, kind, optional=True, createByDefault=usual)
            )
        for name, title, ending in (
            ("MISSION_FILE", tr("Mission as a file"), tr("Mission files (*.json)")),
            ("EXPORT", tr("Plan as a file"), f"{tr('All files (*.*)')};;{file_filters()}"),
        ):
            file = QgsProcessingParameterFileDestination(name, title, ending, optional=True, createByDefault=False)
            self.addParameter(file)
        self.add(
            QgsProcessingParameterMultipleLayers(
                "FURTHER_MISSIONS", tr("Further missions of the plan's file"), kinds.TypeFile, optional=True
            ),
            tr(
                "Mission files that one flight serves after this mission, in their order, with safe transits between "
                "them. Layers and numbers are of this mission alone."
            ),
        )
        self.add_numbers(_figures())

    def prepared(self, run: AlgorithmRun) -> None:
        """Read the mission, and the pixel grid of project layers."""
        from ...core.mission.mission import Mission
        from ..sources import grid_finder, grid_finders

        self._mission = read_mission(run)
        self._align = run.choice("ALIGN") if run.is_given("ALIGN") else None
        self._grids = grid_finders(self._mission)
        self._export = self.parameterAsFileOutput(run.parameters, "EXPORT", run.context)
        if self._export:
            from ...core.mission.export import check_plan_ending

            check_plan_ending(self._export)
        files = [*filter(None, self.parameterAsFileList(run.parameters, "FURTHER_MISSIONS", run.context))]
        if files and not self._export:
            raise InvalidInput(tr("further missions: need the plan as a file"))
        # Several imageries share one flight.
        self._further = [Mission.load(path).of_first_imagery for path in files]
        self._further_grids = [grid_finder(mission) for mission in self._further]
        self._names = [tr("mission"), *(Path(path).stem for path in files)]

    def processed(self, run: AlgorithmRun) -> dict[str, Any]:
        """Plan, and write the requested outputs."""
        from ..planner import summary_of_all
        from ..sources import plan_imageries, plan_summary

        def work(watch: WorkFeedback) -> tuple[Plan, Summary]:
            if self._align is not None:
                self._mission = self._aligned(watch)
            plans = plan_imageries(self._mission, self._grids)
            summaries = {name: plan_summary(one) for name, one in plans.by_imagery.items()}
            self._flight = self._joined(plans.first) if self._further else plans.first
            # All have the footprints and the flight of the first.
            return plans.first, summary_of_all(summaries)

        worked_out, summary = off_main_thread(work, run.feedback)
        for label, text in summary.lines():
            tell = run.feedback.pushWarning if label == "warning" else run.feedback.pushInfo
            tell(f"{translate(label)}: {translate(text)}")
        results: dict[str, Any] = _values(summary)
        kinds = QgsWkbTypes.Type
        for name, found, kind, fields in (
            ("FOOTPRINTS", footprints, kinds.MultiPolygon, capture_fields(worked_out)),
            ("CAPTURES", captures, kinds.Point, capture_fields(worked_out)),
            ("FLIGHT", flight_line_features, kinds.MultiLineString, flight_fields()),
        ):
            if not run.is_given(name):
                continue
            # Write the layers in the CRS of the images' pixels, in which image edges are exact.
            read_crs_on_main_thread(worked_out.grid.plane.crs)
            crs = crs_named(worked_out.grid.plane.crs)
            sink, results[name] = self.parameterAsSink(run.parameters, name, run.context, fields, kind, crs)
            if sink is None:
                raise QgsProcessingException(self.invalidSinkError(run.parameters, name))
            fill(sink, found(worked_out), len(worked_out), run.feedback)
            del sink
        self._write_files(run, results)
        return results

    def _joined(self, first: Plan) -> Plan:
        """Flight of the mission and the further ones."""
        from ...core.mission.flight.joined import join_plans
        from ..sources import mission_heights, plan_mission

        further = [plan_mission(mission, grid) for mission, grid in zip(self._further, self._further_grids)]
        return join_plans([first, *further], self._names, mission_heights(first.mission))

    def _aligned(self, watch: WorkFeedback) -> Mission:
        """Align the rows of the mission as requested, and report the gain."""
        from ...core.mission.flight.alignment import align_rows
        from ..sources import mission_heights

        found = align_rows(
            self._mission,
            next(iter(self._grids.values()))(),
            mission_heights(self._mission),
            self._align or "",
            watch.progress,
        )
        watch.say(translate(found.text()))
        return self._mission.replace(row_azimuth_deg=found.azimuth_deg)

    def _write_files(self, run: AlgorithmRun, results: dict[str, Any]) -> None:
        from ...core.mission.export import write_plan

        path = self.parameterAsFileOutput(run.parameters, "MISSION_FILE", run.context)
        if path:
            self._mission.save(path)
            results["MISSION_FILE"] = path
        if self._export:
            exported = write_plan(self._flight, self._export)
            for file in exported.files:
                run.feedback.pushInfo(tr("Written: {file}").format(file=file))
            for note in exported.notes:
                run.feedback.pushInfo(translate(note))
            # The first file, as a flight too long for one file is divided among several.
            results["EXPORT"] = str(exported.files[0])


def capture_fields(plan: Plan) -> QgsFields:
    """Fields of the layers of footprints and captures."""
    return make_fields((*_CAPTURE, *((name, "number") for name in plan.drawn_fields)))


def flight_fields() -> QgsFields:
    """Fields of the layer of the flight line."""
    return make_fields((("images", "integer"), ("length_m", "number"), ("flight_s", "number"), ("sortie", "integer")))


def footprints(plan: Plan) -> Iterator[QgsFeature]:
    """Footprint of each image: the extent of a map frame, or the ground that the camera sees."""
    from ..map.outlines import footprint_shapes

    for shape, values in zip(footprint_shapes(plan), _attributes(plan)):
        shape.convertToMultiType()
        yield make_feature(shape, values)


def captures(plan: Plan) -> Iterator[QgsFeature]:
    """Point on the ground below the camera for each image, in flight order."""
    from ...core.geodesy.mercator import wrap_lon_deg
    from ..map.outlines import placed

    east, north = placed(plan.grid.plane, wrap_lon_deg(plan.lon_deg), plan.lat_deg)
    for x, y, values in zip(east.tolist(), north.tolist(), _attributes(plan)):
        yield make_feature(QgsGeometry.fromPointXY(QgsPointXY(x, y)), values)


def flight_line_features(plan: Plan) -> Iterator[QgsFeature]:
    """Line from the first capture to the last, or the path of each sortie; in parts across the antimeridian."""
    from ..map.outlines import flight_lines

    path = plan.path
    if path.is_captures:
        lines = flight_lines(plan.grid.plane, [(plan.lon_deg, plan.lat_deg)])
        yield make_feature(lines, (len(plan), plan.direct.distance_m, plan.direct.duration_s, 1))
        return
    for number, seconds in enumerate(path.sorties_s.tolist()):
        one = path.sortie_path(number)
        lines = flight_lines(plan.grid.plane, [(one.lon_deg, one.lat_deg)])
        images = sum(capture >= 0 for capture in one.capture.tolist())
        yield make_feature(lines, (images, one.distance_m, seconds, number + 1))


def fill(sink: QgsFeatureSink, found: Iterable[QgsFeature], count: int, feedback: QgsProcessingFeedback) -> None:
    """Write features to a sink until the user cancels."""
    for done, feature in enumerate(found):
        # Check every 1,000 features whether the user has cancelled.
        if done % 1000 == 0:
            feedback.setProgress(_PERCENT * done / count)
            if feedback.isCanceled():
                return
        if not sink.addFeature(feature, QgsFeatureSink.Flag.FastInsert):
            raise QgsProcessingException(tr("The layer cannot be written: {reason}").format(reason=sink.lastError()))


def _figures() -> dict[str, str]:
    return {
        "IMAGES": tr("Images of one map type"),
        "COVERAGE": tr("Coverage (percent)"),
        "LEAST_FRONT_OVERLAP": tr("Minimum front overlap (percent)"),
        "LEAST_SIDE_OVERLAP": tr("Minimum side overlap (percent)"),
        "REQUESTED_GSD": tr("Ground sample distance requested (metres)"),
        "DELIVERED_GSD": tr("Ground sample distance delivered (metres)"),
        "CHOSEN_ZOOM": tr("Zoom of the plan"),
        "TILES": tr("Tiles of one map type"),
        "DOWNLOAD_BYTES": tr("Download (bytes)"),
        "FILE_BYTES": tr("Files (bytes)"),
        "CAPTURE_S": tr("Time of the capture (seconds)"),
        "FLIGHT_M": tr("Flight distance (metres)"),
        "FLIGHT_S": tr("Flight time (seconds)"),
        "PATH_M": tr("Flight path with take-off and turns (metres)"),
        "PATH_S": tr("Time of the flight path (seconds)"),
        "SORTIES": tr("Sorties"),
        "ERROR_BOUND": tr("Error bound (px)"),
    }


def _values(summary: Summary) -> dict[str, Any]:
    """Values of the outputs, without undefined values such as the coverage of points."""
    percent = {
        "COVERAGE": summary.covered_share,
        "LEAST_FRONT_OVERLAP": summary.least_overlap_along,
        "LEAST_SIDE_OVERLAP": summary.least_overlap_across,
    }
    values = {
        "IMAGES": summary.images,
        **{name: None if share is None else _PERCENT * share for name, share in percent.items()},
        "REQUESTED_GSD": summary.requested_gsd_m_per_px,
        "DELIVERED_GSD": summary.delivered_gsd_m_per_px,
        "CHOSEN_ZOOM": summary.zoom,
        "TILES": summary.unique_tiles,
        "DOWNLOAD_BYTES": summary.download_bytes,
        "FILE_BYTES": summary.output_bytes,
        "CAPTURE_S": summary.seconds,
        "FLIGHT_M": summary.flight_distance_m,
        "FLIGHT_S": summary.flight_s,
        "PATH_M": summary.path_m,
        "PATH_S": summary.path_s,
        "SORTIES": len(summary.sorties_s) or None,
        "ERROR_BOUND": summary.accuracy.bound_px,
    }
    return {name: value for name, value in values.items() if value is not None}


def make_fields(kinds: tuple[tuple[str, str], ...]) -> QgsFields:
    """Fields of a layer, from names and kinds."""
    fields = QgsFields()
    for name, kind in kinds:
        fields.append(field(name, kind))
    return fields


def make_feature(geometry: QgsGeometry, values: tuple[Any, ...]) -> QgsFeature:
    """Feature with a geometry and attributes."""
    feature = QgsFeature()
    feature.setGeometry(geometry)
    feature.setAttributes(list(values))
    return feature


def _attributes(plan: Plan) -> Iterator[tuple[Any, ...]]:
    import numpy as np

    from ...core.geodesy.mercator import wrap_lon_deg
    from ...core.mission.parts import utc_time

    start = QDateTime.fromMSecsSinceEpoch(round(utc_time(plan.direct.start).timestamp() * 1000.0), Qt.TimeSpec.UTC)
    columns = (
        plan.column,
        plan.row,
        plan.lat_deg,
        wrap_lon_deg(plan.lon_deg),
        plan.agl_m,
        *plan.poses.attitude,
        np.broadcast_to(plan.zoom, len(plan)),
        plan.grid.wrapped_px(np.asarray(plan.windows.left_px, np.float64), plan.zoom),
        np.asarray(plan.windows.top_px, np.float64),
        plan.frames.width_px,
        plan.frames.height_px,
        plan.grid.ground_m_per_px(plan.lat_deg, plan.lon_deg, plan.zoom),
        ~plan.corners.hit.all(axis=1),
        plan.times_s,
    )
    for index, (name, *values) in enumerate(zip(plan.names, *(column.tolist() for column in columns))):
        yield (name, *values, start.addMSecs(round(1000.0 * values[-1])), *plan.drawn(index).values())
