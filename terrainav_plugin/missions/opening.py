"""Opening a dataset that is there: its footprints, mosaics, and what has failed. Runs in the background."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import QgsVectorLayer

from ...core.errors import OutputError, TerrAInavError
from ..dataset.layers import FailedImages, OpenedResults, open_failed, open_results
from ..dataset.mosaic import MOST_PICTURES, Mosaic, build_mosaics, mosaics_there
from ..i18n import tr, translate
from ..tasks import Task

if TYPE_CHECKING:
    from ...core.geodesy.mercator import PixelGrid
    from ...core.mission.mission import Mission


class DatasetTask(Task):
    """Opens a dataset's layers; makes the mosaics that a command has not made.

    Parameters
    ----------
    find_grid : callable
        Gives the pixel grid of the mission's source, for mosaics that are not there yet.

    Attributes
    ----------
    opened : OpenedResults or None
    failed : QgsVectorLayer or None
        What has failed of it.
    left_out : str
        Why there are no mosaics, where there could be some.
    """

    def __init__(self, folder: Path, mission: Mission, find_grid: Callable[[], PixelGrid]) -> None:
        super().__init__(tr("Opening {name}").format(name=folder.name))
        self.folder, self.mission = folder, mission
        self.opened: OpenedResults | None = None
        self.failed: QgsVectorLayer | None = None
        self.left_out = ""
        self._find_grid = find_grid

    def work(self) -> None:
        """Open."""
        mosaics = mosaics_there(self.folder, self.mission)
        if mosaics is None:
            mosaics = self._made_mosaics()
        if self.isCanceled():
            return
        self.opened = open_results(self.folder, self.mission, mosaics)
        if self.isCanceled():
            return
        try:
            FailedImages(self.folder).update()
            self.failed = open_failed(self.folder)
        except OutputError as wrong:
            self.left_out = self.left_out or translate(wrong)

    def _made_mosaics(self) -> list[Mosaic]:
        from ...core.mission.plan import plan

        try:
            steps = plan(self.mission, self._find_grid())
            if steps.size_px is not None or len(steps) > MOST_PICTURES:
                return []
            return build_mosaics(steps, self.folder, self._go_on)
        except TerrAInavError as wrong:
            # The footprints can be had without the source.
            self.left_out = translate(wrong)
            return []

    def _go_on(self, share: float) -> bool:
        self.setProgress(100.0 * share)
        return not self.isCanceled()
