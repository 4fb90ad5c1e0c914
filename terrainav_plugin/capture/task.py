"""A capture as a QGIS task, with mosaics of its images."""

from __future__ import annotations

import time
from contextlib import ExitStack, closing
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.PyQt.QtCore import pyqtSignal

from ...core.capture.progress import OverallProgress
from ...core.dataset.folder import FOOTPRINTS_FILE
from ...core.errors import InvalidInput, OutputError, SourceError
from ...core.map_types import CLEAN, twin_type
from ...core.storage.files import file_exists
from ..i18n import tr, translate
from ..settings import Settings
from ..sources import MissionPlans, mission_heights, mission_snapshot, open_for_capture, source_transport
from ..tasks import Task

if TYPE_CHECKING:
    from ...core.capture.progress import CaptureResult, Progress
    from ...core.imagery.source import Source
    from ...core.mission.mission import Mission
    from ...core.mission.plan import Plan
    from ..dataset.layers import FailedImages, OpenedResults
    from ..dataset.mosaic import MosaicRaster

#: Shortest time between two checks for failed images, in s.
_FAILED_LOOK_S = 3.0


class CaptureTask(Task):
    """Capture plans into a folder, then make mosaics of the images or place a test shot on the map.

    All data is passed to the constructor on the main thread and does not change afterwards; `run` uses plain values.

    Parameters
    ----------
    plans : MissionPlans
    folder : Path
        Folder of the dataset; an interrupted run of the same mission there is resumed. Each of several imageries has a
        folder of its name inside.
    keys : dict of str to (str or None)
        API key of each imagery.
    test_shot : bool
        Whether to capture a single image, to be shown on the map only.
    only_failed : bool
        Whether to capture only images that failed earlier.

    Signals
    -------
    progressed(object)
        `Progress`, about ten times a second.
    failed_changed(object, object)
        Folder of the dataset, or of one of its imageries, and the layer of its images that have failed in any run, for
        the main thread; None if no image has failed. Every few seconds at most.
    mosaic_refused(str)
        Why there will be no mosaic; emitted before the first image.

    Attributes
    ----------
    paused : bool
        Set on the main thread; while True, the task makes no requests and begins no image.
    capture_share : float
        Share of the capture in the progress; the mosaic has the rest.
    result : CaptureResult or None
    mosaics : list of MosaicRaster
    without_mosaic : str
        Why there is no mosaic although there are images.
    opened : list of OpenedResults
        Layers of the results of each imagery, for the main thread.
    failed : int
        Number of images of the dataset that have failed.
    picture : Path or None
        File that shows a test shot on the map.
    clean_picture : Path or None
        File that shows it without effects of a real camera, if it has any.
    """

    progressed = pyqtSignal(object)
    failed_changed = pyqtSignal(object, object)
    mosaic_refused = pyqtSignal(str)

    def __init__(
        self,
        plans: MissionPlans,
        folder: Path,
        keys: dict[str, str | None],
        test_shot: bool = False,
        only_failed: bool = False,
    ) -> None:
        super().__init__(tr("Capturing {name}").format(name=folder.name))
        self.plans = plans
        self.folder = folder
        self.paused = False
        self.result: CaptureResult | None = None
        self.mosaics: list[MosaicRaster] = []
        self.without_mosaic = ""
        self.opened: list[OpenedResults] = []
        self.failed = 0
        self.picture: Path | None = None
        self.clean_picture: Path | None = None
        self._keys = keys
        self._test_shot, self._only_failed = test_shot, only_failed
        missions = {name: plan.mission for name, plan in plans.by_imagery.items()}
        self._snapshots = {name: mission_snapshot(one) for name, one in missions.items()}
        self._with_mosaic = not test_shot
        # Share of capturing in the progress; the mosaic takes the rest, which is longer if it is orthorectified.
        self.capture_share = 0.9 if plans.first.frames.is_north_up else 0.6
        self._connections = Settings().connections
        self._transports = {name: source_transport(one.imagery.source) for name, one in missions.items()}
        self._stopping = False
        self._failures: dict[Path, FailedImages] = {}
        self._overall = OverallProgress(plans.images_each) if plans.mission.imagery.imageries else None
        self._there = self._failed_seen = self._mosaics_made = 0
        self._next_look_s = 0.0

    @property
    def stopped(self) -> bool:
        """Whether the user has stopped the capture."""
        return self._stopping or self.isCanceled()

    def stop(self) -> None:
        """Stop capturing; finished images still get a mosaic, unless the task is cancelled too."""
        self._stopping = True

    def work(self) -> None:
        """Capture, and report failed images."""
        try:
            self._capture()
        finally:
            # If the capture could not begin, no image has failed: a message suffices.
            if self.result is not None or self._there:
                self._look_at_failed()
        if self._shows_results:
            self._open_results()

    def discard(self) -> None:
        """Dispose of a task that was never started."""
        self._close_transports()

    def finished(self, result: bool) -> None:
        """Emit `ended`, on the main thread."""
        # Also needed here: a task cancelled before its start does not run `work`.
        self._close_transports()
        super().finished(result)

    def _close_transports(self) -> None:
        for transport in self._transports.values():
            transport.close()

    @property
    def _places(self) -> dict[Path, Plan]:
        """Plan of each dataset, by its folder."""
        return {self.folder / name: plan for name, plan in self.plans.by_imagery.items()}

    def _capture(self) -> None:
        from ..dataset.layers import FailedImages

        if not self._test_shot:
            self._failures = {place: FailedImages(place) for place in self._places}
            self._next_look_s = time.monotonic() + _FAILED_LOOK_S
        self._check_mosaics()
        with ExitStack() as opened:
            sources = {name: self._open(name, plan.mission, opened) for name, plan in self.plans.by_imagery.items()}
            self.result = self._captured(sources)
        if self._with_mosaic and self._shows_results:
            self._make_mosaics()
        elif self._test_shot and self.result.written:
            self._place_picture()

    def _open(self, name: str, mission: Mission, opened: ExitStack) -> Source:
        """Open the source of an imagery until the capture ends."""
        transport = opened.enter_context(closing(self._transports[name]))
        try:
            source = open_for_capture(mission, self._keys[name], transport=transport, snapshot=self._snapshots[name])
        except (InvalidInput, SourceError) as wrong:
            if not name:
                raise
            raise SourceError("{0}: {1}", name, wrong) from wrong
        return opened.enter_context(closing(source))

    def _captured(self, sources: dict[str, Source]) -> CaptureResult:
        """Capture the plan, or the plans of all imageries."""
        from ...core.capture.progress import Listener
        from ...core.capture.runner import capture
        from ...core.capture.several import capture_imageries

        how = {
            "connections": self._connections,
            "resume": True,
            "only_failed": self._only_failed,
            "listener": Listener(progress=self._report, cancelled=lambda: self.stopped, paused=lambda: self.paused),
        }
        if self.plans.mission.imagery.imageries:
            return capture_imageries(self.plans.mission, self.plans.by_imagery, sources, self.folder, **how)
        return capture(self.plans.first, *sources.values(), self.folder, **how)

    @property
    def _shows_results(self) -> bool:
        """Whether there are results to show on the map."""
        result = self.result
        if result is None or self._test_shot or self.isCanceled():
            return False
        return not result.cancelled or result.written + result.skipped > 0

    def _check_mosaics(self) -> None:
        """Report before the first image that there will be no mosaic."""
        from ..dataset.mosaic import check_mosaics

        if not self._with_mosaic:
            return
        try:
            for plan in self.plans.by_imagery.values():
                check_mosaics(plan, mission_heights)
        except (InvalidInput, SourceError) as wrong:
            self.mosaic_refused.emit(translate(wrong))

    def _make_mosaics(self) -> None:
        from ..dataset.mosaic import build_any_mosaics

        for number, (place, plan) in enumerate(self._begun().items()):
            self._mosaics_made = number
            try:
                self.mosaics += build_any_mosaics(plan, place, mission_heights, self._mosaic_progress)
            except (InvalidInput, SourceError) as wrong:
                # For example at a pole, which is outside Web Mercator; such images can be viewed one at a time.
                self.without_mosaic = translate(wrong)

    def _begun(self) -> dict[Path, Plan]:
        """Plans whose datasets have been begun: a run that was stopped may not have come to the last imagery."""
        return {place: plan for place, plan in self._places.items() if file_exists(place / FOOTPRINTS_FILE)}

    def _open_results(self) -> None:
        from ..dataset.layers import open_results

        for place, plan in self._begun().items():
            mosaics = [one for one in self.mosaics if one.path.is_relative_to(place)]
            self.opened.append(open_results(place, plan.mission, mosaics))

    def _place_picture(self) -> None:
        mission = self.plans.first.mission
        map_type = mission.imagery.map_types[0]
        self.picture = self._on_map(map_type)
        if mission.varied.keep_clean:
            self.clean_picture = self._on_map(twin_type(map_type, CLEAN))

    def _on_map(self, map_type: str) -> Path:
        """File that shows a test shot of a map type on the map."""
        plan, folder = self.plans.first, self.folder / map_type
        picture = folder / f"{plan.names[0]}.{plan.mission.output.image_format}"
        if plan.frames.on_map:
            return picture
        from ..dataset.rectify import lay_on_map

        on_map = folder / "on-map.tif"
        lay_on_map(plan, picture, on_map)
        return on_map

    def _report(self, progress: Progress) -> None:
        if self._overall is not None:
            progress = self._overall.add(progress)
        done = progress.done + progress.failed + progress.skipped
        share = self.capture_share if self._with_mosaic else 1.0
        if not self.paused:
            self.setProgress(100.0 * share * done / max(progress.total, 1))
        self._there = progress.done + progress.skipped
        self.progressed.emit(progress)
        if progress.failed > self._failed_seen and time.monotonic() >= self._next_look_s:
            self._failed_seen = progress.failed
            self._look_at_failed()

    def _look_at_failed(self) -> None:
        """Update the lists of failed images, and emit those that have changed."""
        if not self._failures:
            return
        from ..dataset.layers import open_failed

        began_s = time.monotonic()
        try:
            for place, failures in self._failures.items():
                if failures.update():
                    self.failed_changed.emit(place, open_failed(place))
        except OutputError:
            # The capture itself reports a folder that cannot be written.
            return
        # Checks take at most a twentieth of the time.
        ended_s = time.monotonic()
        self._next_look_s = ended_s + max(_FAILED_LOOK_S, 20.0 * (ended_s - began_s))
        self.failed = sum(map(len, self._failures.values()))

    def _mosaic_progress(self, share: float) -> bool:
        whole = (self._mosaics_made + share) / len(self.plans.by_imagery)
        return self.report_progress(self.capture_share + (1.0 - self.capture_share) * whole)
