"""Align the rows to the area in a QGIS task, and report the gain."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from qgis.PyQt.QtCore import QObject

from ..i18n import capitalized, tr, translate
from ..tasks import Task
from ..units import length_text

if TYPE_CHECKING:
    from ...core.mission.flight.alignment import Alignment
    from ..form.state import FormState
    from ..messages import Messages
    from ..planner import PlannedMission
    from .form import DockForm
    from .planning import Planning


class RowAlignment(QObject):
    """Compute the azimuth of rows, enter it, and report the gain.

    Parameters
    ----------
    form : DockForm
    planning : Planning
    messages : Messages

    Attributes
    ----------
    task : AlignTask or None
        The task, while it computes an azimuth.
    """

    def __init__(self, form: DockForm, planning: Planning, messages: Messages) -> None:
        super().__init__()
        self._form, self._planning, self._messages = form, planning, messages
        self.task: AlignTask | None = None
        form.flight.align_clicked.connect(self.align)

    def close(self) -> None:
        """Stop for good."""
        if self.task is not None:
            self.task.abandon()
            self.task = None

    def align(self, way: str) -> None:
        """Align the rows of the entered mission; ``way`` is one of `parts.ALIGNMENTS`."""
        self._planning.use_plan(partial(self._look, way), tr("The rows stay as they are."))

    def _look(self, way: str, planned: PlannedMission) -> None:
        if self.task is not None:
            return
        self._form.flight.align.setEnabled(False)
        self.task = AlignTask(planned, way)
        self.task.begin(partial(self._take, self._form.state()))

    def _take(self, state: FormState, task: AlignTask) -> None:
        self.task = None
        self._form.flight.align.setEnabled(True)
        if task.trace:
            self._messages.error(f"{translate(task.error)}. {tr('The rows stay as they are.')}", task.trace)
        elif task.error:
            self._messages.refused(translate(task.error), tr("The rows stay as they are."))
        elif task.found is not None:
            self._enter(state, task.found)

    def _enter(self, state: FormState, found: Alignment) -> None:
        if self._form.state() != state:
            self._messages.info(tr("The entries changed while the rows were being aligned: press the button again."))
            return
        self._form.set_state(replace(state, row_azimuth_deg=found.azimuth_deg))
        # In the units of the figures, so that both texts agree.
        text = translate(found.text(partial(length_text, unit=state.agl_unit)))
        self._messages.success(capitalized(text))


class AlignTask(Task):
    """Compute an azimuth, with progress and cancellation in QGIS's status bar.

    Attributes
    ----------
    found : Alignment or None
        Result of the task; None until it has ended, and if it was cancelled.
    """

    def __init__(self, planned: PlannedMission, way: str) -> None:
        super().__init__(tr("Aligning the rows"))
        self._planned, self._way = planned, way
        self.found: Alignment | None = None

    def work(self) -> None:
        """Compute the azimuth."""
        from ...core.mission.flight.alignment import align_rows
        from ..sources import mission_heights

        mission = self._planned.mission
        self.found = align_rows(
            mission, self._planned.plan.grid, mission_heights(mission), self._way, self.report_progress
        )
