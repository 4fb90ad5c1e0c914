"""A capture as a QGIS task, with mosaics of its images."""

from __future__ import annotations

import time
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.PyQt.QtCore import pyqtSignal

from ...core.errors import InvalidInput, OutputError, SourceError
from ..i18n import tr, translate
from ..settings import Settings
from ..sources import mission_heights, mission_snapshot, open_for_capture, source_transport
from ..tasks import Task

if TYPE_CHECKING:
    from ...core.capture.progress import CaptureResult, Progress
    from ...core.mission.plan import Plan
    from ..dataset.layers import FailedImages, OpenedResults
    from ..dataset.mosaic import MosaicRaster

#: Shortest time between two checks for failed images, in s.
_FAILED_LOOK_S = 3.0


class CaptureTask(Task):
    """Capture a plan into a folder, then make a mosaic of the images or place a test shot on the map.

    All data is passed to the constructor on the main thread and does not change afterwards; `run` uses plain values.

    Parameters
    ----------
    plan : Plan
    folder : Path
        Folder of the dataset; an interrupted run of the same mission there is resumed.
    key : str or None
        API key.
    test_shot : bool
        Whether to capture a single image, to be shown on the map only.
    only_failed : bool
        Whether to capture only images that failed earlier.

    Signals
    -------
    progressed(object)
        `Progress`, about ten times a second.
    failed_changed(object)
        Layer of the dataset's images that have failed in any run, for the main thread; None if no image has failed.
        Every few seconds at most.
    mosaic_refused(str)
        Why there will be no mosaic; emitted before the first image.

    Attributes
    ----------
    paused : bool
        Set on the main thread; while True, the task makes no requests and begins no image.
    result : CaptureResult or None
    mosaics : list of MosaicRaster
    without_mosaic : str
        Why there is no mosaic although there are images.
    opened : OpenedResults or None
        Layers of the results, for the main thread.
    failed : int
        Number of images of the dataset that have failed.
    picture : Path or None
        File that shows a test shot on the map.
    """

    progressed = pyqtSignal(object)
    failed_changed = pyqtSignal(object)
    mosaic_refused = pyqtSignal(str)

    def __init__(
        self,
        plan: Plan,
        folder: Path,
        key: str | None = None,
        test_shot: bool = False,
        only_failed: bool = False,
    ) -> None:
        super().__init__(tr("Capturing {name}").format(name=folder.name))
        self.plan = plan
        self.folder = folder
        self.paused = False
        self.result: CaptureResult | None = None
        self.mosaics: list[MosaicRaster] = []
        self.without_mosaic = ""
        self.opened: OpenedResults | None = None
        self.failed = 0
        self.picture: Path | None = None
        self._key = key
        self._test_shot, self._only_failed = test_shot, only_failed
        self._snapshot = mission_snapshot(plan.mission)
        self._with_mosaic = not test_shot
        # Share of capturing in the progress; the mosaic takes the rest, which is longer if it is orthorectified.
        self._capture_share = 0.9 if plan.frames.is_north_up else 0.6
        self._connections = Settings().connections
        self._transport = source_transport(plan.mission.imagery.source)
        self._stopping = False
        self._failures: FailedImages | None = None
        self._there = self._failed_seen = 0
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
        self._transport.close()

    def finished(self, result: bool) -> None:
        """Emit `ended`, on the main thread."""
        # Also needed here: a task cancelled before its start does not run `work`.
        self._transport.close()
        super().finished(result)

    def _capture(self) -> None:
        from ...core.capture.progress import Listener
        from ...core.capture.runner import capture
        from ..dataset.layers import FailedImages

        if not self._test_shot:
            self._failures = FailedImages(self.folder)
            self._next_look_s = time.monotonic() + _FAILED_LOOK_S
        self._check_mosaics()
        with closing(self._transport) as transport:
            source = open_for_capture(self.plan.mission, self._key, transport=transport, snapshot=self._snapshot)
            with closing(source):
                self.result = capture(
                    self.plan,
                    source,
                    self.folder,
                    connections=self._connections,
                    resume=True,
                    only_failed=self._only_failed,
                    listener=Listener(
                        progress=self._report, cancelled=lambda: self.stopped, paused=lambda: self.paused
                    ),
                )
        if self._with_mosaic and self._shows_results:
            self._make_mosaics()
        elif self._test_shot and self.result.written:
            self._place_picture()

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
            check_mosaics(self.plan, mission_heights)
        except (InvalidInput, SourceError) as wrong:
            self.mosaic_refused.emit(translate(wrong))

    def _make_mosaics(self) -> None:
        from ..dataset.mosaic import build_any_mosaics

        try:
            self.mosaics = build_any_mosaics(self.plan, self.folder, mission_heights, self._mosaic_progress)
        except (InvalidInput, SourceError) as wrong:
            # For example at a pole, which is outside Web Mercator; such images can be viewed one at a time.
            self.without_mosaic = translate(wrong)

    def _open_results(self) -> None:
        from ..dataset.layers import open_results

        self.opened = open_results(self.folder, self.plan.mission, self.mosaics)

    def _place_picture(self) -> None:
        mission = self.plan.mission
        folder = self.folder / mission.imagery.map_types[0]
        picture = folder / f"{self.plan.names[0]}.{mission.output.image_format}"
        if not self.plan.frames.on_map:
            from ..dataset.rectify import lay_on_map

            on_map = folder / "on-map.tif"
            lay_on_map(self.plan, picture, on_map)
            picture = on_map
        self.picture = picture

    def _report(self, progress: Progress) -> None:
        done = progress.done + progress.failed + progress.skipped
        share = self._capture_share if self._with_mosaic else 1.0
        self.setProgress(100.0 * share * done / max(progress.total, 1))
        self._there = progress.done + progress.skipped
        self.progressed.emit(progress)
        if progress.failed > self._failed_seen and time.monotonic() >= self._next_look_s:
            self._failed_seen = progress.failed
            self._look_at_failed()

    def _look_at_failed(self) -> None:
        """Update the list of failed images, and emit it if it has changed."""
        if self._failures is None:
            return
        from ..dataset.layers import open_failed

        began_s = time.monotonic()
        try:
            if self._failures.update():
                self.failed_changed.emit(open_failed(self.folder))
        except OutputError:
            # The capture itself reports a folder that cannot be written.
            return
        # Checks take at most a twentieth of the time.
        ended_s = time.monotonic()
        self._next_look_s = ended_s + max(_FAILED_LOOK_S, 20.0 * (ended_s - began_s))
        self.failed = len(self._failures)

    def _mosaic_progress(self, share: float) -> bool:
        return self.report_progress(self._capture_share + (1.0 - self._capture_share) * share)
