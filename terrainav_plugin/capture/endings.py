"""End of a run: results on the map, and a message with the outcome."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from qgis.core import QgsVectorLayer
from qgis.PyQt.QtCore import QObject, pyqtSignal

from ...core.errors import TerrAInavError
from ..dataset.placing import load_test_shot, place_mosaics, show_failed, show_results
from ..i18n import number_text, tr, translate
from ..paths import open_in_system
from .run import BackgroundRun, Stage, done_text, note_saved_images

if TYPE_CHECKING:
    from pathlib import Path

    from ..dataset.placing import OpenProject
    from ..map.mission_group import MissionGroup
    from ..messages import Messages


class Endings(QObject):
    """Show the results of runs on the map and in the message bar, with follow-up actions.

    Parameters
    ----------
    messages : Messages
    open_project : OpenProject
    group : callable
        Returns the group of the panel's mission, for test shots.

    Signals
    -------
    shown(object)
        Folder of a run that was not stopped, once its results are on the map.
    test_shot_shown(object)
        Layer of a test shot.
    dataset_wanted(object)
        Folder of a dataset to open.
    resume_wanted(object), failed_wanted(object)
        A run to resume; a run whose failed images are to be captured again.
    missing_wanted(object, str, int)
        A run, the SHA-256 of a tile to count as missing, and the number of the run's images with that tile.
    """

    shown = pyqtSignal(object)
    test_shot_shown = pyqtSignal(object)
    dataset_wanted = pyqtSignal(object)
    resume_wanted = pyqtSignal(object)
    failed_wanted = pyqtSignal(object)
    missing_wanted = pyqtSignal(object, str, int)

    def __init__(
        self,
        messages: Messages,
        open_project: OpenProject,
        group: Callable[[], MissionGroup],
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._messages, self._open_project, self._group = messages, open_project, group
        self._begun_in: dict[BackgroundRun, int] = {}

    def close(self) -> None:
        """Forget all runs, so that nothing more is shown."""
        self._begun_in.clear()

    def show_failed(self, run: BackgroundRun, place: Path, layer: QgsVectorLayer | None) -> None:
        """Show the images in a folder that have failed so far."""
        if self._is_open(run) and not run.test_shot:
            group = self._open_project.mission_group(place)
            show_failed(group, layer)
            if layer is not None:
                mission = run.mission.missions_by_imagery.get(place.name, run.mission)
                group.remember_mission(mission.to_json())

    def warn_of_mosaic(self, run: BackgroundRun, reason: str) -> None:
        """Warn before a capture that there will be no mosaic."""
        with self._messages.topic(str(run.folder)):
            self._messages.warning(
                tr("{name}: there will be no mosaic: {reason}. Its images are captured all the same.").format(
                    name=run.name, reason=reason.rstrip(".")
                )
            )

    def begin(self, run: BackgroundRun) -> None:
        """Note the project of a run, and remove messages about an earlier run into the same folder."""
        self._messages.withdraw(str(run.folder))
        self._begun_in[run] = self._open_project.number

    def tell(self, run: BackgroundRun) -> None:
        """Show the results of a run and report its outcome."""
        with self._messages.topic(str(run.folder)):
            self._tell(run)

    def _tell(self, run: BackgroundRun) -> None:
        is_open = self._is_open(run)
        self._begun_in.pop(run, None)
        if run.test_shot:
            if run.task.picture is not None and is_open:
                self._show(lambda: self._load_test_shot(run))
                return
        elif run.task.opened and is_open and (run.result.written or run.result.skipped):
            self._show(lambda: self._load_results(run))
        else:
            self._show(lambda: place_mosaics(self._open_project.project, run.task.mosaics))
        # Release layers that are not shown: the run stays listed, and they would keep files open.
        run.task.opened = []
        # The last message is shown on top: failures above all, then other problems.
        if run.task.failed or (run.result is not None and run.result.failed):
            self._tell_repeated(run)
            self._say(run, is_open)
        else:
            self._say(run, is_open)
            self._tell_repeated(run)

    def _is_open(self, run: BackgroundRun) -> bool:
        return self._open_project.shows(self._begun_in.get(run), run.folder)

    def _show(self, load: Callable[[], None]) -> None:
        try:
            load()
        except TerrAInavError as wrong:
            self._messages.error(translate(wrong))

    def _load_results(self, run: BackgroundRun) -> None:
        # Failed images count as changes: existing images with tiles that now count as missing are removed.
        changed = run.result is None or bool(run.result.written or run.result.failed)
        # In reverse, as each is inserted above the others, and the first one must be on top.
        for opened in reversed(run.task.opened):
            show_results(self._open_project.mission_group(opened.folder), opened, changed=changed)
        if run.mission.imagery.imageries:
            # The group around those of the imageries.
            self._open_project.mission_group(run.folder).remember_mission(run.mission.to_json())
        # A complete set of images replaces the plan on the map; after a stop, the plan still shows what is missing.
        if run.stage is not Stage.STOPPED:
            self.shown.emit(run.folder)

    def _load_test_shot(self, run: BackgroundRun) -> None:
        lat, lon, _ = run.mission.area.poses[0]
        lat_text, lon_text = (number_text(degrees, ".5f") for degrees in (lat, lon))
        if run.task.clean_picture is not None:
            # Below the other, to be compared with it.
            title = tr("Ideal test shot {lat} {lon}").format(lat=lat_text, lon=lon_text)
            load_test_shot(self._group(), run.task.clean_picture, title)
        title = tr("Test shot {lat} {lon}").format(lat=lat_text, lon=lon_text)
        self.test_shot_shown.emit(load_test_shot(self._group(), run.task.picture, title))

    def _say(self, run: BackgroundRun, is_open: bool) -> None:
        result, name = run.result, run.name
        if run.task.error:
            self._messages.failed(note_saved_images(translate(run.task.error), result), run.task.trace)
        elif run.stage is Stage.STOPPED and result is None:
            self._messages.info(tr("{name}: stopped before the first image.").format(name=name))
        elif run.stage is Stage.STOPPED:
            text = tr("{name}: stopped with {there} of {total} images.")
            if not result.cancelled:
                text = tr("{name}: stopped without the mosaic, with {there} of {total} images.")
            self._messages.info(
                text.format(
                    name=name,
                    there=number_text(result.written + result.skipped),
                    total=number_text(result.total),
                ),
                (tr("Resume"), lambda: self.resume_wanted.emit(run)),
            )
        elif run.task.failed or result.failed:
            self._tell_failed(run)
        else:
            text = done_text(result)
            if run.task.without_mosaic:
                text += " " + tr("Without a mosaic: {reason}. “View images” shows them one by one.").format(
                    reason=run.task.without_mosaic
                )
            action = (tr("Open folder"), lambda: open_in_system(run.folder))
            if not is_open:
                text += " " + tr("Its project is closed.")
                action = (tr("Open dataset"), lambda: self.dataset_wanted.emit(run.folder))
            if run.task.without_mosaic:
                # A warning stays until the user closes it.
                self._messages.warning(f"{name}: {text}", action=action)
            else:
                # So does the only way to results that are not on the map.
                self._messages.success(f"{name}: {text}", action, lasts=not is_open)

    def _tell_failed(self, run: BackgroundRun) -> None:
        failed = run.result.failed
        reason = translate(failed[0].reason) if failed else tr("in an earlier run")
        text = tr("{name}: {failed} of {total} images could not be captured ({reason}).").format(
            name=run.name,
            failed=number_text(run.task.failed or len(failed)),
            total=number_text(run.images),
            reason=reason,
        )
        lines = (f"{failure.map_type}/{failure.name}: {translate(failure.reason)}" for failure in failed)
        again = (tr("Capture only the failed ones"), lambda: self.failed_wanted.emit(run))
        self._messages.warning(text, "\n".join(lines), again)

    def _tell_repeated(self, run: BackgroundRun) -> None:
        """Report tiles received for distant places, and offer to count them as missing."""
        # Report three at most; the journal has all of them.
        for repeat in run.result.repeated[:3] if run.result is not None else ():
            images = len(repeat.images)
            text = tr("{name}: the same tile came for {places} places and is in {images} images.").format(
                name=run.name, places=number_text(repeat.places), images=number_text(images)
            )
            details = tr(
                "Its SHA-256 begins with {digest}; {image} shows it. It may be water or snow. If it "
                "shows no imagery, “Treat as missing” removes the images with it and requests its places "
                "again; the options list such tiles."
            ).format(digest=repeat.sha256, image=next(iter(repeat.images), ""))
            missing = partial(self.missing_wanted.emit, run, repeat.sha256, images)
            self._messages.warning(text, details, (tr("Treat as missing"), missing))
