"""Algorithms that make a benchmark from a mission's views and a reference, and score answers to it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsMapLayer,
    QgsProcessing,
    QgsProcessingContext,
    QgsProcessingOutputHtml,
    QgsProcessingOutputRasterLayer,
    QgsProcessingOutputVectorLayer,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFile,
    QgsProcessingParameterFolderDestination,
    QgsProcessingParameterMultipleLayers,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterLayer,
    QgsProcessingParameterString,
)

from ...core.benchmark.choices import METHODS, POSITIVE_IOU, SEMI_POSITIVE_IOU, SPLITS, TILE_OVERLAP
from ...core.dataset.folder import PARTS
from ...core.errors import Cancelled, InvalidInput
from ...core.numbers import real_number
from ...core.storage.files import file_exists
from ..i18n import capitalized, number_text, tr, translate
from ..packages import missing_packages
from .algorithm import Algorithm, AlgorithmRun, AlgorithmTexts, WorkFeedback, is_loadable, off_main_thread
from .capture import layer_ids, tell_result
from .choices import ChoiceParameter
from .datasets import add_gap, add_shares, read_shares
from .imagery import WithImagery, check_terms
from .mission_parameters import add_mission_parameters, read_mission

if TYPE_CHECKING:
    from ...core.benchmark.folder import Benchmark
    from ...core.benchmark.making import BenchmarkResult
    from ...core.benchmark.planning import BenchmarkPlan, BenchmarkSettings
    from ...core.benchmark.scoring import Figure, Scores
    from ...core.capture.progress import Progress
    from ...core.mission.imageries import NamedImagery
    from ...core.mission.mission import Mission

_GROUP = "benchmarks"
_PERCENT = 100.0
#: Names in the core of the figures over all queries, by output.
_FIGURES = {
    "QUERY_COUNT": "queries",
    "RECALL_1": "recall@1",
    "RECALL_5": "recall@5",
    "RECALL_10": "recall@10",
    "AP": "AP",
    "SDM_1": "SDM@1 per metre",
    "PDM_1": "PDM@1",
    "MEDIAN_M": "position",
    "WITHIN_1": "within 1 m",
    "WITHIN_3": "within 3 m",
    "WITHIN_5": "within 5 m",
    "WITHIN_10": "within 10 m",
    "WITHIN_20": "within 20 m",
    "POSE_2": "within 2 m, 2 deg",
    "POSE_3": "within 3 m, 3 deg",
    "POSE_5": "within 5 m, 5 deg",
    "MASK_IOU": "mask IoU",
}


class MakeBenchmark(WithImagery):
    """Queries, the reference in which to find them, and the right answers."""

    NAME, GROUP = "makebenchmark", _GROUP

    def texts(self) -> AlgorithmTexts:
        """Return the texts of the algorithm."""
        return AlgorithmTexts(
            tr("Make a benchmark"),
            tr("Queries from one imagery to find in another, with exact labels."),
            tr("benchmark,localization,geolocalization,retrieval,query,reference,dataset,navigation,gnss"),
            (
                tr(
                    "Captures queries, the views of the mission, and the reference in which to find "
                    "them: one mosaic, and tiles of it. Tables give the position of each query and the "
                    "right tiles."
                ),
                tr(
                    "Take the queries and the reference from imagery of different dates, sources or "
                    "kinds, as rasters or by source: SOURCE, SOURCE@DATE or SOURCE:roadmap, such as "
                    "esri-wayback@2014-02-20, with NAME= in front for another name. world is the "
                    "embedded landscape. Without imagery for the queries, the mission's is used."
                ),
                tr(
                    "“Only count” shows the number of images and requests. Run it again into the same "
                    "folder to resume an interrupted run. “Score a benchmark” then runs a baseline, or "
                    "scores your own answers."
                ),
            ),
        )

    def define(self) -> None:
        """Add the parameters and outputs."""
        add_mission_parameters(self, listed=self._listed)
        self._add_imagery()
        self._add_reference()
        self._add_parts()
        self.add_placeholders()
        self.add_consent()
        self.add(
            QgsProcessingParameterBoolean("DRY_RUN", tr("Only count"), False),
            tr("The log shows what would be captured; nothing is captured."),
        )
        self.add(
            QgsProcessingParameterBoolean("LOAD", tr("Add the results to the project"), True),
            tr("The reference and the footprints of the queries, if the algorithm runs in a project."),
        )
        self.add(
            QgsProcessingParameterFolderDestination("FOLDER", tr("Benchmark folder")),
            tr("A new folder, or the folder of this benchmark, to resume it."),
        )
        self.addOutput(QgsProcessingOutputRasterLayer("MOSAIC", tr("Reference")))
        self.add_numbers(
            {
                "IMAGES": tr("Images"),
                "REQUESTS": tr("Requests"),
                "FAILED": tr("Images that could not be captured"),
                "QUERY_COUNT": tr("Queries"),
                "TILE_COUNT": tr("Tiles of the reference"),
                "WITHOUT_TILE": tr("Queries without a right tile"),
                "TRAIN_QUERIES": tr("Queries for training"),
                "VALIDATION_QUERIES": tr("Queries for validation"),
                "TEST_QUERIES": tr("Queries for the test"),
                "GAP_QUERIES": tr("Queries in no part"),
            }
        )

    def _add_imagery(self) -> None:
        raster = QgsProcessing.SourceType.TypeRaster
        by_name = tr("SOURCE, SOURCE@DATE or SOURCE:roadmap, with NAME= in front for another name.")
        self.add(
            QgsProcessingParameterMultipleLayers("QUERY_LAYERS", tr("Queries: rasters"), raster, optional=True),
            tr("Every query is taken from each of them. Their names are those of the layers."),
        )
        self.add(
            QgsProcessingParameterString("QUERIES", tr("Queries: imagery by name"), multiLine=True, optional=True),
            tr("One per line, beside the rasters: {form} If neither is given, that of the mission.").format(
                form=by_name
            ),
        )
        self.add(
            QgsProcessingParameterRasterLayer("REFERENCE_LAYER", tr("Reference: raster"), optional=True),
            tr("The imagery in which to find the queries; needed unless an imagery is given by name."),
        )
        self.add(
            QgsProcessingParameterString("REFERENCE", tr("Reference: imagery by name"), optional=True),
            by_name,
        )
        self.add(
            QgsProcessingParameterString("REFERENCE_BUILDINGS", tr("Reference: buildings"), optional=True),
            tr(
                "Files of buildings in which to find the queries as well, with semicolons between them, such as "
                "footprints or CityJSON. They are copied into the benchmark's folder, and the queries have masks of "
                "the mission's buildings, or of these if it has none. Needs an elevation."
            ),
        )

    def _add_reference(self) -> None:
        real = QgsProcessingParameterNumber.Type.Double
        self.add(
            QgsProcessingParameterString("TILES", tr("Widths of tiles (metres)"), optional=True),
            tr("With spaces between them. If empty, that of a square with the area of a query's ground."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "TILE_OVERLAP",
                tr("Overlap of tiles (percent)"),
                real,
                _PERCENT * TILE_OVERLAP,
                False,
                0.0,
                99.0,  # With more, the number of tiles explodes.
            ),
            tr("Share of a tile that its neighbour repeats."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterNumber(
                "MARGIN", tr("Margin of the reference (metres)"), real, None, True, 0.0, 1_000_000.0
            ),
            tr("Ground around that of the queries. If empty, the width of the widest tile."),
            advanced=True,
        )
        for name, title, usual, text in (
            (
                "POSITIVE",
                tr("Intersection over union of right tiles"),
                POSITIVE_IOU,
                tr("Minimum for a right tile: the ground shared by tile and query, over the ground of both."),
            ),
            (
                "SEMI_POSITIVE",
                tr("Intersection over union of nearly right tiles"),
                SEMI_POSITIVE_IOU,
                tr("Minimum for a nearly right tile."),
            ),
        ):
            self.add(QgsProcessingParameterNumber(name, title, real, usual, False, 0.0, 1.0), text, advanced=True)

    def _add_parts(self) -> None:
        self.add(
            ChoiceParameter("SPLIT", tr("Parts"), {split: split for split in SPLITS}, SPLITS[0]),
            tr(
                "cross-area: no ground is in two of the parts training, validation and test; same-area: "
                "all parts share one reference; none: no parts."
            ),
        )
        self.add(
            QgsProcessingParameterBoolean("INSIDE", tr("Leave out queries beyond the imagery"), False),
            tr("Queries that show ground beyond their imagery or the reference are left out: they would fail."),
        )
        add_shares(self)
        add_gap(self, tr("With cross-area only: minimum distance between the ground of two parts."))

    def prepared(self, run: AlgorithmRun) -> None:
        """Take the imagery of queries and reference."""
        settings = self._settings = _read_settings(run)
        self._named = {str(one): one for one in (settings.reference, *settings.imageries)}
        self._known = layer_ids(run.context)
        self.take_imagery(run, *(settings.queries.select_imagery(one) for one in self._named.values()))

    def processed(self, run: AlgorithmRun) -> dict[str, Any]:
        """Plan, and capture unless this is a dry run."""
        from ...core.benchmark.planning import plan_benchmark

        folder, dry_run, accepted = Path(run.text("FOLDER")), run.flag("DRY_RUN"), run.flag("ACCEPT_TERMS")

        def work(watch: WorkFeedback) -> tuple[BenchmarkPlan, BenchmarkResult | None]:
            from ..sources import mission_heights

            grids = {name: imagery.grid() for name, imagery in zip(self._named, self._taken)}
            worked_out = plan_benchmark(self._settings, grids, mission_heights(self._settings.queries))
            _tell_plan(worked_out, watch)
            return worked_out, None if dry_run else self._made(worked_out, folder, watch, accepted=accepted)

        worked_out, made = off_main_thread(work, run.feedback)
        return self._results(run, folder, worked_out, made)

    def _made(self, worked_out: BenchmarkPlan, folder: Path, watch: WorkFeedback, *, accepted: bool) -> BenchmarkResult:
        from ...core.benchmark.making import make_benchmark
        from ...core.capture.progress import Listener
        from ...core.imagery.catalogue import shared_requests

        with ExitStack() as open_now:
            sources = {
                name: open_now.enter_context(imagery.opened()) for name, imagery in zip(self._named, self._taken)
            }
            captures = [(plan, sources[str(imagery)]) for imagery, plan in worked_out.captures.values()]
            needed = shared_requests([(source, plan.requests) for plan, source in captures])
            for (plan, source), requests in zip(captures, needed):
                check_terms(plan, source, requests, accepted=accepted)
            made = make_benchmark(
                worked_out,
                sources,
                folder,
                connections=self._taken[0].connections,
                resume=True,
                listener=Listener(progress=_progress(worked_out, watch), cancelled=watch.cancelled),
            )
        tell_result(made.total, watch, folder)
        if made.hint is not None:
            watch.warn(capitalized(translate(made.hint)))
        return made

    def _results(
        self, run: AlgorithmRun, folder: Path, worked_out: BenchmarkPlan, made: BenchmarkResult | None
    ) -> dict[str, Any]:
        plans = [plan for _, plan in worked_out.captures.values()]
        found: dict[str, Any] = {
            "FOLDER": str(folder),
            "IMAGES": sum(map(len, plans)),
            "REQUESTS": sum(plan.requests for plan in plans),
            "QUERY_COUNT": sum(map(len, worked_out.queries.values())),
            "TILE_COUNT": sum(map(len, worked_out.tiles.values())),
        }
        if made is None:
            return found
        found["FAILED"] = len(made.total.failed)
        benchmark = made.benchmark
        if benchmark is None:
            return found
        found.update(
            MOSAIC=str(folder / benchmark.mosaic.file),
            QUERY_COUNT=len(benchmark.queries),
            TILE_COUNT=len(benchmark.references),
            WITHOUT_TILE=sum(not len(right) for right in benchmark.positives()),
            **{f"{part.upper()}_QUERIES": benchmark.queries_of_parts.get(part, 0) for part in (*PARTS, "gap")},
        )
        if run.flag("LOAD"):
            _load(run, benchmark, self._known, _query_layers(benchmark))
        return found


class ScoreBenchmark(Algorithm):
    """Scores of the answers of a baseline, or of answers in a file."""

    NAME, GROUP = "scorebenchmark", _GROUP

    def texts(self) -> AlgorithmTexts:
        """Return the texts of the algorithm."""
        return AlgorithmTexts(
            tr("Score a benchmark"),
            tr("Runs a baseline or reads predictions, scores them, and shows the errors on the map."),
            tr("benchmark,score,judge,recall,localization,error,predictions,baseline,sift,correlation"),
            (
                tr(
                    "Scores answers to the queries of a benchmark: those of a baseline, which it runs, "
                    "or those in a file. Writes a page, the figures, and the error of every query."
                ),
                tr(
                    "ncc correlates the query, as seen vertically from above, with every place of the "
                    "reference. sift and orb match features; they need OpenCV (the Python package "
                    "opencv-python-headless). middle always answers with the middle of the reference, "
                    "which every method has to beat."
                ),
                tr(
                    "prior answers with the simulated measurements as they are. silhouette moves the camera from there "
                    "to where the buildings of the reference overlap the query's mask most; it needs a benchmark with "
                    "buildings."
                ),
                tr(
                    "The map shows the position of each query in the colour of its error, with a line to "
                    "the position of the answer. To show scores again, choose their file of predictions."
                ),
                tr(
                    "A file of predictions is a CSV with the column query, and references (the best tile first, with "
                    "spaces between them) or lat_deg and lon_deg."
                ),
            ),
        )

    def define(self) -> None:
        """Add the parameters and outputs."""
        self.add(
            QgsProcessingParameterFile("BENCHMARK", tr("Benchmark folder"), QgsProcessingParameterFile.Behavior.Folder),
            tr("A folder made by “Make a benchmark”."),
        )
        self.add(
            ChoiceParameter("METHOD", tr("Baseline"), {method: method for method in METHODS}, next(iter(METHODS))),
            tr("Its answers are scored unless a file of predictions is given. sift and orb need OpenCV."),
        )
        self.add(
            QgsProcessingParameterFile("PREDICTIONS", tr("Predictions"), extension="csv", optional=True),
            tr("Scored instead of the baseline's answers."),
        )
        self.add(
            ChoiceParameter("PART", tr("Part"), {part: part for part in PARTS}),
            tr("Only the queries of one part, found among its tiles. If empty, all."),
        )
        self.add(
            QgsProcessingParameterBoolean("LOAD", tr("Add the results to the project"), True),
            tr("The errors and the reference, if the algorithm runs in a project."),
        )
        self.add(
            QgsProcessingParameterFile(
                "FOLDER",
                tr("Folder of the scores"),
                QgsProcessingParameterFile.Behavior.Folder,
                optional=True,
            ),
            tr(
                "If empty, a folder inside the benchmark's, named after the baseline or file of predictions, "
                "and the part."
            ),
        )
        self.addOutput(QgsProcessingOutputHtml("HTML", tr("Scores")))
        self.addOutput(QgsProcessingOutputVectorLayer("ERRORS", tr("Errors of the queries")))
        self.add_numbers(
            {
                "QUERY_COUNT": tr("Queries"),
                "RECALL_1": tr("Recall@1 (share)"),
                "RECALL_5": tr("Recall@5 (share)"),
                "RECALL_10": tr("Recall@10 (share)"),
                "AP": tr("Average precision"),
                "SDM_1": tr("SDM@1 per metre"),
                "PDM_1": tr("PDM@1"),
                "MEDIAN_M": tr("Median error (metres)"),
                "WITHIN_1": tr("Found within 1 m (share)"),
                "WITHIN_3": tr("Found within 3 m (share)"),
                "WITHIN_5": tr("Found within 5 m (share)"),
                "WITHIN_10": tr("Found within 10 m (share)"),
                "WITHIN_20": tr("Found within 20 m (share)"),
                "POSE_2": tr("With buildings: found within 2 m and 2° (share)"),
                "POSE_3": tr("With buildings: found within 3 m and 3° (share)"),
                "POSE_5": tr("With buildings: found within 5 m and 5° (share)"),
                "MASK_IOU": tr("With buildings: intersection over union of masks (share)"),
            }
        )

    def prepared(self, run: AlgorithmRun) -> None:
        """Note the project's layers."""
        self._known = layer_ids(run.context)

    def processed(self, run: AlgorithmRun) -> dict[str, Any]:
        """Answer the queries and score the answers."""
        from ...core.benchmark.folder import Benchmark
        from ...core.benchmark.page import MAP_FILE, figure_rows
        from ...core.benchmark.running import scores_folder

        folder, predictions, part = Path(run.text("BENCHMARK")), run.text("PREDICTIONS"), run.choice("PART")
        name = Path(predictions).stem if predictions else run.choice("METHOD")
        target = Path(run.text("FOLDER") or scores_folder(folder, name, part))

        def work(watch: WorkFeedback) -> tuple[Benchmark, Scores, Path]:
            benchmark = Benchmark.read(folder)
            return benchmark, *_judged(benchmark, name, predictions, part, target, watch)

        benchmark, scores, page = off_main_thread(work, run.feedback)
        figures = next(iter(scores.groups.values()))
        for title, *values, definition in figure_rows(scores.groups):
            values_text = ", ".join(f"{group} {value}" for group, value in zip(scores.groups, values))
            run.feedback.pushInfo(f"{title}: {values_text} ({definition})")
        results = {"FOLDER": str(target), "HTML": str(page), **_numbers(figures)}
        if "MEDIAN_M" not in results:
            run.feedback.pushWarning(tr("The answers have no positions: there are no errors to show on the map."))
            return results
        results["ERRORS"] = str(target / MAP_FILE)
        if run.flag("LOAD"):
            layers = _error_layers(scores, target / MAP_FILE, f"{name}-{part}" if part else name)
            _load(run, benchmark, self._known, layers)
        return results


def _read_settings(run: AlgorithmRun) -> BenchmarkSettings:
    from ...core.benchmark.planning import BenchmarkSettings

    mission = read_mission(run)
    return BenchmarkSettings(
        mission.replace(imageries=()),
        _imageries(run, mission),
        _reference(run),
        tile_widths_m=_widths(run.text("TILES")),
        tile_overlap=run.number("TILE_OVERLAP") / _PERCENT,
        margin_m=run.number("MARGIN") if run.is_given("MARGIN") else None,
        positive_iou=run.number("POSITIVE"),
        semi_positive_iou=run.number("SEMI_POSITIVE"),
        split=run.choice("SPLIT"),
        shares=read_shares(run),
        gap_m=run.number("GAP"),
        inside=run.flag("INSIDE"),
        reference_buildings=tuple(one.strip() for one in run.text("REFERENCE_BUILDINGS").split(";") if one.strip()),
    )


def _imageries(run: AlgorithmRun, mission: Mission) -> tuple[NamedImagery, ...]:
    """Imagery of the queries: the given rasters and named imagery; by default, the imagery of the mission."""
    from ...core.mission.imageries import NamedImagery, named_imageries

    lines = [line.strip() for line in run.text("QUERIES").splitlines() if line.strip()]
    layers = run.algorithm.parameterAsLayerList(run.parameters, "QUERY_LAYERS", run.context)
    if not (lines or layers):
        own = mission.imagery
        return own.named or tuple(NamedImagery(map_type, own.source, own.date, map_type) for map_type in own.map_types)
    return named_imageries([*map(_source_text, layers), *lines])


def _reference(run: AlgorithmRun) -> NamedImagery:
    from ...core.mission.imageries import NamedImagery

    layer = run.algorithm.parameterAsRasterLayer(run.parameters, "REFERENCE_LAYER", run.context)
    given = [text for text in (layer and _source_text(layer), run.text("REFERENCE").strip()) if text]
    if len(given) != 1:
        raise InvalidInput(
            tr("{count} references given: needs one, a raster or an imagery by name").format(count=len(given))
        )
    return NamedImagery.parse(given[0])


def _source_text(layer: QgsMapLayer) -> str:
    """Name of a raster as imagery: its file, or the layer of the project if it has no file."""
    from ...core.mission.imageries import folder_name
    from ..map.mission_group import layer_file
    from ..qgis_source.snapshot import source_name

    path = layer_file(layer)
    is_file = layer.providerType() == "gdal" and file_exists(path)
    return f"{folder_name(layer.name()) or layer.providerType()}={path if is_file else source_name(layer)}"


def _widths(text: str) -> tuple[float, ...]:
    try:
        return tuple(real_number(part) for part in text.replace(",", " ").split())
    except ValueError as wrong:
        raise InvalidInput(
            tr("widths of tiles {text!r}: must be numbers, such as 200 400").format(text=text)
        ) from wrong


def _tell_plan(worked_out: BenchmarkPlan, watch: WorkFeedback) -> None:
    """Report the number of images by folder."""
    for folder, (imagery, plan) in worked_out.captures.items():
        watch.say(
            tr("{folder}: {imagery}; images: {images}, {width} x {height} px; requests: {requests}").format(
                folder=folder,
                images=number_text(len(plan)),
                width=number_text(int(plan.frames.width_px.max())),
                height=number_text(int(plan.frames.height_px.max())),
                requests=number_text(plan.requests),
                imagery=imagery,
            )
        )
    if worked_out.left_out:
        left_out = tr("Queries of each imagery left out, as they show ground beyond the imagery: {n}")
        watch.say(left_out.format(n=number_text(worked_out.left_out)))


def _progress(worked_out: BenchmarkPlan, watch: WorkFeedback) -> Callable[[Progress], object]:
    """Callback that reports the progress of all captures together, weighted by their requests."""
    weights = {folder: max(plan.requests, 1) for folder, (_, plan) in worked_out.captures.items()}
    shares: dict[str, float] = {}

    def report(progress: Progress) -> None:
        finished = progress.done + progress.failed + progress.skipped
        shares[progress.map_type] = finished / max(progress.total, 1)
        done = sum(weights[folder] * share for folder, share in shares.items())
        watch.progress(done / sum(weights.values()))

    return report


def _judged(
    benchmark: Benchmark, name: str, predictions: str, part: str, target: Path, watch: WorkFeedback
) -> tuple[Scores, Path]:
    """Scores of a file of predictions or of a baseline, and the path of a page that shows them."""
    from ...core.benchmark.answers import Predictions
    from ...core.benchmark.page import write_scores
    from ...core.benchmark.running import method_named, prediction_file, run_method
    from ...core.benchmark.scoring import score
    from ...core.storage.files import make_folder

    if predictions:
        answers = Predictions.read(predictions, benchmark)
    else:
        # Answering takes most of the time.
        found = run_method(
            benchmark,
            method_named(name),
            part,
            progress=lambda done, total: watch.progress((0.5 if benchmark.has_buildings else 0.9) * done / total),
            cancelled=watch.cancelled,
        )
        if found is None:
            raise Cancelled(tr("nothing was written"))
        answers = found
        make_folder(target)
        answers.write(prediction_file(target, name), benchmark)
    # Silhouettes of buildings take time as well.
    scores = score(
        benchmark,
        answers,
        part,
        progress=lambda done, total: watch.progress(0.5 + 0.4 * done / total),
        cancelled=watch.cancelled,
    )
    diagrams = not missing_packages("matplotlib")
    if not diagrams:
        watch.warn(tr("The page has no diagrams: QGIS's Python lacks the package matplotlib."))
    return scores, write_scores(benchmark, scores, target, name, diagrams=diagrams)


def _numbers(figures: tuple[Figure, ...]) -> dict[str, float]:
    """Values of the figures in `_FIGURES`, by output, without NaN."""
    values = {figure.name: figure.value for figure in figures}
    found = {output: values[name] for output, name in _FIGURES.items() if name in values}
    return {output: value for output, value in found.items() if value == value}


def _query_layers(benchmark: Benchmark) -> dict[str, tuple[Path, str, str]]:
    """Layers of the queries' footprints: by role, file, options and title."""
    from ...core.benchmark.folder import QUERIES_FOLDER
    from ...core.dataset.folder import FOOTPRINTS_FILE
    from ..dataset.scores import QUERIES

    folder = benchmark.folder / QUERIES_FOLDER
    return {
        f"{QUERIES}/{name}": (folder / name / FOOTPRINTS_FILE, "", tr("Queries of {name}").format(name=name))
        for name in dict.fromkeys(benchmark.queries.imagery)
    }


def _error_layers(scores: Scores, path: Path, name: str) -> dict[str, tuple[Path, str, str]]:
    """Layers of a method's errors: one for each imagery, because queries from different imagery coincide."""
    from ..dataset.scores import ERRORS

    title = tr("Errors of {name}").format(name=name)
    imageries = list(dict.fromkeys(scores.errors.imagery))
    if len(imageries) == 1:
        return {f"{ERRORS}/{name}": (path, "", title)}
    return {f"{ERRORS}/{name}/{one}": (path, f"|subset=\"imagery\" = '{one}'", f"{title}, {one}") for one in imageries}


def _load(
    run: AlgorithmRun, benchmark: Benchmark, known: frozenset[str], layers: dict[str, tuple[Path, str, str]]
) -> None:
    """Add the reference and the given layers to the benchmark's group; does nothing without a project."""
    from ..dataset.scores import REFERENCE, group_post_processor

    context = run.context
    if context.project() is None:
        return
    mosaic = benchmark.folder / benchmark.mosaic.file
    for role, (file, options, title) in {REFERENCE: (mosaic, "", tr("Reference")), **layers}.items():
        if not is_loadable(file, run.feedback):
            continue
        # The layers of several benchmarks are in one project.
        name = f"{benchmark.folder.name}: {title}"
        details = QgsProcessingContext.LayerDetails(name, context.project(), name)
        details.setPostProcessor(group_post_processor(benchmark.folder, role, known))
        context.addLayerToLoadOnCompletion(f"{file}{options}", details)
