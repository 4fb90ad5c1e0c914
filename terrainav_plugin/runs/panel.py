"""The captures of this session in the panel: at work, in line, and over."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from qgis.PyQt.QtCore import QObject

from ..capture.run import Run, Stage, row_text, title_of
from ..dock.run_list import RunList
from ..dock.run_row import RunRow

if TYPE_CHECKING:
    from ..capture.queue import Runs


class RunPanel(QObject):
    """Keeps the list in step with the line of captures.

    Parameters
    ----------
    zoom, open_folder, clean : callable
        What to do with a run whose row asks for it.
    """

    def __init__(
        self,
        runs: Runs,
        shown: RunList,
        zoom: Callable[[Run], None],
        open_folder: Callable[[Run], None],
        clean: Callable[[Run], None],
    ) -> None:
        super().__init__()
        self._runs, self._list = runs, shown
        self._rows: dict[Run, RunRow] = {}
        self._deeds: dict[str, Callable[[Run], None]] = {
            RunRow.PAUSE: lambda run: run.pause(True),
            RunRow.RESUME: runs.resume,
            RunRow.CANCEL: lambda run: run.cancel(),
            RunRow.FAILED: runs.capture_failed,
            RunRow.ZOOM: zoom,
            RunRow.OPEN: open_folder,
            RunRow.CLEAN: clean,
            RunRow.DISMISS: runs.dismiss,
        }
        runs.listed.connect(self._add)
        runs.dismissed.connect(self._remove)
        runs.moved.connect(self._show_all)

    def row(self, run: Run) -> RunRow:
        """Row of a run."""
        return self._rows[run]

    def _add(self, run: Run) -> None:
        row = self._rows[run] = RunRow(title_of(run))
        row.asked.connect(lambda deed: self._deeds[deed](run))
        run.changed.connect(lambda: self._show(run))
        self._show(run)
        self._list.add(row)

    def _remove(self, run: Run) -> None:
        row = self._rows.pop(run, None)
        if row is not None:
            self._list.remove(row)

    def _show_all(self) -> None:
        for run in self._rows:
            self._show(run)

    def _show(self, run: Run) -> None:
        row = self._rows.get(run)
        if row is None:
            return
        line = self._runs.waiting
        row.show_progress(run.percent, row_text(run, line.index(run) if run in line else 0))
        row.show_deeds(_deeds_of(run), run.can_pause, underway=not run.over)
        self._list.fit()


def _deeds_of(run: Run) -> set[str]:
    """What can be done with a run now."""
    if run.stage is Stage.WAITING:
        return {RunRow.CANCEL}
    if run.stage is Stage.RUNNING:
        return {RunRow.CANCEL, RunRow.PAUSE}
    if run.stage is Stage.PAUSED:
        return {RunRow.CANCEL, RunRow.RESUME}
    if run.stage is Stage.STOPPING:
        # Once nothing is captured any more, what is left to be stopped is the mosaic.
        return {RunRow.CANCEL} if run.result is not None else set()
    deeds = {RunRow.ZOOM, RunRow.OPEN, RunRow.DISMISS}
    if run.stage in (Stage.DONE, Stage.INCOMPLETE) and not run.test_shot:
        deeds.add(RunRow.CLEAN)
    if run.stage in (Stage.STOPPED, Stage.BROKEN) and not run.test_shot:
        deeds.add(RunRow.RESUME)
    return deeds | ({RunRow.FAILED} if run.task.failed else set())
