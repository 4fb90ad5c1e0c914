"""A capture as a QGIS task, and what makes its pictures fit for the map."""

from __future__ import annotations

import time
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.PyQt.QtCore import pyqtSignal

from .i18n import tr
from .sources import open_for_capture, snapshot_for
from .task import Task

if TYPE_CHECKING:
    from ..core.capture.runner import CaptureResult, Progress
    from ..core.mission.plan import Plan
    from .map.mosaic import Mosaic
    from .network.transport import QgisTransport

#: Share of the progress that capturing is; the mosaic takes the rest.
_CAPTURE_SHARE = 0.9


class CaptureTask(Task):
    """Captures a plan into a folder; makes a mosaic of map frames, and lays a test shot on the map.

    Everything it needs is handed over when it is made, on the main thread; `run` uses plain values only.

    Parameters
    ----------
    plan : Plan
    folder : Path
        Goes on where an earlier run of the same mission was stopped.
    key : str or None
        API key.
    test_shot : bool
        Whether it is a single picture, to be looked at.

    Signals
    -------
    progressed(object)
        `Progress`, about ten times a second.

    Attributes
    ----------
    result : CaptureResult or None
    mosaics : list of Mosaic
    picture : Path or None
        Of a test shot: what shows it on the map.
    """

    progressed = pyqtSignal(object)

    def __init__(self, plan: Plan, folder: Path, key: str | None = None, test_shot: bool = False) -> None:
        super().__init__(tr("Capturing {name}").format(name=folder.name))
        self.plan = plan
        self.folder = folder
        self.started_s = time.monotonic()
        self.result: CaptureResult | None = None
        self.mosaics: list[Mosaic] = []
        self.picture: Path | None = None
        self._key = key
        self._test_shot = test_shot
        self._snapshot = snapshot_for(plan.mission)
        self._with_mosaic = not test_shot and plan.size_px is None
        self._transport = _transport()

    @property
    def stopped(self) -> bool:
        """Whether the user ended it."""
        return self.isCanceled()

    def work(self) -> bool:
        """Capture."""
        self._capture()
        return not self.isCanceled()

    def finished(self, result: bool) -> None:
        """Tell; on the main thread."""
        # A task that is cancelled before its turn does not run.
        self._transport.close()
        super().finished(result)

    def _capture(self) -> None:
        from ..core.capture.runner import capture

        with closing(self._transport) as transport:
            source = open_for_capture(
                self.plan.mission, self._key, transport=transport, snapshot=self._snapshot
            )
            with closing(source):
                self.result = capture(
                    self.plan,
                    source,
                    self.folder,
                    resume=True,
                    progress=self._report,
                    cancelled=self.isCanceled,
                )
        if self.isCanceled():
            return
        if self._with_mosaic:
            self._make_mosaics()
        elif self._test_shot and self.result.written:
            self._place_picture()

    def _make_mosaics(self) -> None:
        from .map.mosaic import MOST_PICTURES, build_mosaics

        if len(self.plan) <= MOST_PICTURES:
            self.mosaics = build_mosaics(self.plan, self.folder, self._mosaic_progress)

    def _place_picture(self) -> None:
        mission = self.plan.mission
        folder = self.folder / mission.map_types[0]
        picture = folder / f"{self.plan.names[0]}.{mission.image_format}"
        if self.plan.size_px is not None:
            from .map.on_map import lay_on_map

            on_map = folder / "on-map.tif"
            lay_on_map(self.plan, picture, on_map)
            picture = on_map
        self.picture = picture

    def _report(self, progress: Progress) -> None:
        done = progress.done + progress.failed + progress.skipped
        share = _CAPTURE_SHARE if self._with_mosaic else 1.0
        self.setProgress(100.0 * share * done / max(progress.total, 1))
        self.progressed.emit(progress)

    def _mosaic_progress(self, share: float) -> bool:
        self.setProgress(100.0 * (_CAPTURE_SHARE + (1.0 - _CAPTURE_SHARE) * share))
        return not self.isCanceled()


def _transport() -> QgisTransport:
    """Make the way to the network, in the thread that it works in."""
    from ..core.capture.runner import DEFAULT_CONNECTIONS
    from .network.transport import QgisTransport

    return QgisTransport(DEFAULT_CONNECTIONS)
