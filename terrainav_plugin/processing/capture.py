"""Algorithms that capture a mission into a dataset folder, or capture failed images again."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsProcessingContext,
    QgsProcessingOutputFolder,
    QgsProcessingOutputRasterLayer,
    QgsProcessingOutputVectorLayer,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFolderDestination,
    QgsProject,
)

from ...core.dataset.folder import FOOTPRINTS_FILE, MISSION_FILE
from ...core.errors import InvalidInput, SourceError
from ...core.storage.files import file_exists
from ..i18n import number_text, tr, translate
from .algorithm import AlgorithmRun, AlgorithmTexts, WorkFeedback, is_loadable, off_main_thread
from .imagery import WithImagery, check_terms
from .mission_parameters import add_mission_parameters, read_mission

if TYPE_CHECKING:
    from ...core.capture.progress import CaptureResult, Progress
    from ...core.mission.mission import Mission
    from ...core.mission.plan import Plan
    from ..dataset.mosaic import MosaicRaster

#: Share of capturing in the progress; the mosaic takes the rest.
_CAPTURE_SHARE = 0.9
#: Largest number of failed images named in the log; the journal and the tables name all.
_NAMED_FAILURES = 20


class _Capturing(WithImagery):
    """Base of both algorithms: their common parameters, run and outputs."""

    def _add_run(self) -> None:
        self.add_access(
            tr(
                "Configuration of QGIS's authentication database: a Basic one with the key as its password for sources "
                "that take a key, any other for the requests. Without one, that of the mission panel, or the "
                "environment's TERRAINAV_KEY."
            )
        )
        self.add_placeholders()
        self.add(
            QgsProcessingParameterBoolean("MAKE_MOSAIC", tr("Make a mosaic"), True),
            tr(
                "One raster for each map type, of the images that are there; turned and tilted ones are orthorectified."
            ),
            advanced=True,
        )

    def _add_results(self) -> None:
        self.add(
            QgsProcessingParameterBoolean("LOAD", tr("Add the results to the project"), True),
            tr("The footprints and the mosaics, if the algorithm runs in a project."),
        )
        self.addOutput(QgsProcessingOutputVectorLayer("FOOTPRINTS", tr("Footprints")))
        self.addOutput(QgsProcessingOutputRasterLayer("MOSAIC", tr("Mosaic of the first map type")))
        self.add_numbers(
            {
                "TOTAL": tr("Images asked for"),
                "WRITTEN": tr("Images written"),
                "SKIPPED": tr("Images that already existed"),
                "FAILED": tr("Images that could not be captured"),
                "REQUESTS": tr("Requests"),
            }
        )

    def _take_run(self, mission: Mission, run: AlgorithmRun) -> None:
        from ..sources import each_imagery

        missions = each_imagery(mission)
        self.take_imagery(run, *missions.values())
        self._mission, self._names = mission, tuple(missions)
        self._accepted = run.flag("ACCEPT_TERMS")
        self._with_mosaic = run.flag("MAKE_MOSAIC")
        self._made: list[MosaicRaster] = []
        self._known = layer_ids(run.context)

    def _captured(self, run: AlgorithmRun, folder: Path, **options: bool) -> dict[str, Any]:
        """Capture, make the mosaics, and return the outputs."""
        from ...core.capture.progress import Listener, OverallProgress
        from ...core.capture.runner import capture
        from ...core.capture.several import capture_imageries
        from ...core.imagery.catalogue import shared_requests
        from ..dataset.scores import MOSAIC
        from ..map.mission_group import CAPTURED
        from ..sources import MissionPlans

        def work(watch: WorkFeedback) -> tuple[CaptureResult, list[MosaicRaster]]:
            def report(progress: Progress) -> None:
                progress = progress if overall is None else overall.add(progress)
                finished = progress.done + progress.failed + progress.skipped
                watch.progress(_CAPTURE_SHARE * finished / max(progress.total, 1))

            with ExitStack() as opened:
                sources = {name: opened.enter_context(one.opened()) for name, one in zip(self._names, self._taken)}
                plans = {name: one.planned() for name, one in zip(self._names, self._taken)}
                needed = [one.requests * len(one.mission.imagery.map_types) for one in plans.values()]
                for (name, one), requests in zip(plans.items(), shared_requests([*zip(sources.values(), needed)])):
                    check_terms(one, sources[name], requests, accepted=self._accepted)
                images = MissionPlans(self._mission, plans).images_each
                overall = OverallProgress(images) if self._mission.imagery.imageries else None
                total = number_text(sum(images.values()))
                watch.say(tr("{count} images into {folder}.").format(count=total, folder=folder))
                how: Any = {
                    "connections": self._imagery.connections,
                    "listener": Listener(progress=report, cancelled=watch.cancelled),
                    **options,
                }
                if self._mission.imagery.imageries:
                    result = capture_imageries(self._mission, plans, sources, folder, **how)
                else:
                    result = capture(*plans.values(), *sources.values(), folder, **how)
            tell_result(result, watch, folder)
            return result, self._mosaics(plans, folder, result, watch)

        result, self._made = off_main_thread(work, run.feedback)
        if run.flag("LOAD"):
            for mosaic in self._made:
                self._load_when_done(run.context, mosaic.path, mosaic.title, f"{MOSAIC}/{mosaic.path.name}")
            for name in self._names:
                footprints = folder / name / FOOTPRINTS_FILE
                if file_exists(footprints) and is_loadable(footprints, run.feedback):
                    title = tr("Captured images, {name}").format(name=name) if name else tr("Captured images")
                    self._load_when_done(run.context, footprints, title, CAPTURED)
        return {
            "FOLDER": str(folder),
            # Of the first imagery, if there are several.
            "FOOTPRINTS": str(folder / self._names[0] / FOOTPRINTS_FILE),
            **({"MOSAIC": str(self._made[0].path)} if self._made else {}),
            "TOTAL": result.total,
            "WRITTEN": result.written,
            "SKIPPED": result.skipped,
            "FAILED": len(result.failed),
            "REQUESTS": result.requests,
        }

    def _load_when_done(self, context: QgsProcessingContext, path: Path, title: str, role: str) -> None:
        """Add a layer to the group of its dataset after the algorithm; does nothing without a project."""
        from ..dataset.scores import group_post_processor

        if context.project() is not None:
            details = QgsProcessingContext.LayerDetails(title, context.project(), title)
            details.setPostProcessor(group_post_processor(path.parent, role, self._known))
            context.addLayerToLoadOnCompletion(str(path), details)

    def finished(self) -> None:
        """Put the new mosaics in place, which the project may show."""
        from ..dataset.placing import place_mosaics

        place_mosaics(QgsProject.instance(), self._made)

    def _mosaics(
        self, plans: dict[str, Plan], folder: Path, result: CaptureResult, watch: WorkFeedback
    ) -> list[MosaicRaster]:
        """Mosaics of all map types and imageries; empty if none are wanted or possible."""
        from ..dataset.mosaic import build_any_mosaics
        from ..sources import mission_heights

        if result.cancelled or not self._with_mosaic:
            return []

        made: list[MosaicRaster] = []
        for number, (name, one) in enumerate(plans.items()):

            def progress(share: float, number: int = number) -> bool:
                return watch.progress(_CAPTURE_SHARE + (1.0 - _CAPTURE_SHARE) * (number + share) / len(plans))

            try:
                made += build_any_mosaics(one, folder / name, mission_heights, progress)
            except (InvalidInput, SourceError) as wrong:
                watch.warn(tr("Without a mosaic: {reason}").format(reason=translate(wrong)))
        return made


class Capture(_Capturing):
    """Capture a mission into a folder."""

    NAME = "capture"

    def texts(self) -> AlgorithmTexts:
        """Return the texts of the algorithm."""
        return AlgorithmTexts(
            tr("Capture a mission"),
            tr("Georeferenced images with their poses, as a simulated UAV takes them."),
            tr("uav,drone,capture,images,dataset,tiles,download,georeferenced,photogrammetry,training"),
            (
                tr(
                    "Captures the images of a mission into a folder: georeferenced images, a table with the pose of "
                    "each, the footprints, and a journal. Each tile is fetched once."
                ),
                tr(
                    "Images are written completely or not at all; the log, the journal and the table "
                    "give the reason for each that could not be fetched. Run it again into the same "
                    "folder to resume an interrupted capture."
                ),
                tr("The mission comes from the parameters or from a mission file, among the advanced parameters."),
            ),
        )

    def define(self) -> None:
        """Add the parameters and outputs."""
        add_mission_parameters(self, listed=self._listed)
        self._add_run()
        self.add(
            QgsProcessingParameterFolderDestination("FOLDER", tr("Dataset folder")),
            tr("A new folder, or the folder of this mission, to resume it."),
        )
        self._add_results()

    def prepared(self, run: AlgorithmRun) -> None:
        """Take the mission's imagery."""
        self._take_run(read_mission(run), run)

    def processed(self, run: AlgorithmRun) -> dict[str, Any]:
        """Capture."""
        return self._captured(run, Path(run.text("FOLDER")), resume=True)


class CaptureFailed(_Capturing):
    """Capture failed images again."""

    NAME = "capturefailed"

    def texts(self) -> AlgorithmTexts:
        """Return the texts of the algorithm."""
        return AlgorithmTexts(
            tr("Capture failed images again"),
            tr("Only those that failed in an earlier capture."),
            tr("uav,drone,capture,failed,retry,resume,dataset"),
            (
                tr(
                    "Captures again the images of a dataset folder that failed in an earlier run, and "
                    "nothing else. If none failed, there is nothing to do."
                ),
            ),
        )

    def define(self) -> None:
        """Add the parameters and outputs."""
        self.add_dataset(tr("Of an earlier capture."))
        self._add_run()
        self.addOutput(QgsProcessingOutputFolder("FOLDER", tr("Dataset folder")))
        self._add_results()

    def prepared(self, run: AlgorithmRun) -> None:
        """Take the imagery of the captured mission."""
        from ...core.mission.mission import Mission

        self._folder = Path(run.text("DATASET"))
        mark = self._folder / MISSION_FILE
        if not file_exists(mark):
            raise InvalidInput(
                tr("folder {folder}: holds no capture, as it has no {file}").format(
                    folder=self._folder, file=MISSION_FILE
                )
            )
        self._take_run(Mission.load(str(mark)), run)

    def processed(self, run: AlgorithmRun) -> dict[str, Any]:
        """Capture."""
        return self._captured(run, self._folder, only_failed=True)


def layer_ids(context: QgsProcessingContext) -> frozenset[str]:
    """Ids of the project's layers; empty without a project. Main thread only."""
    project = context.project()
    return frozenset(() if project is None else project.mapLayers())


def tell_result(result: CaptureResult, watch: WorkFeedback, folder: Path) -> None:
    """Report the images written and failed, and tiles that were received for many places."""
    watch.say(
        tr("{written} images written, {skipped} already existed, {failed} failed, in {seconds} s.").format(
            written=number_text(result.written),
            skipped=number_text(result.skipped),
            failed=number_text(len(result.failed)),
            seconds=number_text(result.seconds, ".1f"),
        )
    )
    for failure in result.failed[:_NAMED_FAILURES]:
        watch.warn(f"{failure.map_type}/{failure.name}: {translate(failure.reason)}")
    if len(result.failed) > _NAMED_FAILURES:
        watch.warn(
            tr("{count} more, named in the folder's journal and tables.").format(
                count=number_text(len(result.failed) - _NAMED_FAILURES)
            )
        )
    for repeat in result.repeated:
        watch.warn(
            tr(
                "{map_type}: the same tile came for {places} places and is in {images} images, such as {image}. It may "
                "be water or snow; if it shows no imagery, enter {digest} under “Tiles to treat as missing” and run it "
                "again."
            ).format(
                map_type=repeat.map_type,
                places=number_text(repeat.places),
                images=number_text(len(repeat.images)),
                image=next(iter(repeat.images), ""),
                digest=repeat.sha256,
            )
        )
    if result.cancelled:
        # A run without a folder has a new one each time.
        watch.warn(
            tr("Stopped at {done} of {total} images. Enter {folder} as the folder, and run it again to go on.").format(
                done=number_text(result.written + result.skipped), total=number_text(result.total), folder=folder
            )
        )
