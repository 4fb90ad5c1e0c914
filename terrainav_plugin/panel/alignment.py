"""Rows turned so that they suit the area, beside the main thread, and what that gains."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from qgis.PyQt.QtCore import QObject

from ..i18n import tr, translate
from ..tasks import LatestWorker, reason_of
from ..units import length_text

if TYPE_CHECKING:
    from ...core.mission.flight.alignment import Alignment
    from ..form.state import FormState
    from ..messages import Messages
    from ..planner import Planned
    from .form import DockForm
    from .planning import Planning


class RowAlignment(QObject):
    """Finds the azimuth that is asked for, enters it, and says what it gains.

    Parameters
    ----------
    form : DockForm
    planning : Planning
    messages : Messages
    """

    def __init__(self, form: DockForm, planning: Planning, messages: Messages) -> None:
        super().__init__()
        self._form, self._planning, self._messages = form, planning, messages
        self._worker = LatestWorker("align", self)
        self._worker.failed.connect(self._failed)
        form.flight.align_clicked.connect(self.align)

    @property
    def busy(self) -> bool:
        """Whether an azimuth is being looked for."""
        return bool(self._worker.busy)

    def close(self) -> None:
        """End the thread; no answer comes any more."""
        self._worker.close()

    def align(self, way: str) -> None:
        """Align the rows of what is entered, in one of `parts.ALIGNMENTS`."""
        self._planning.with_plan(partial(self._look, way), tr("The rows stay as they are."))

    def _look(self, way: str, planned: Planned) -> None:
        self._form.flight.align.setEnabled(False)
        state = self._form.state()
        self._worker.ask(partial(_found, planned, way), partial(self._enter, state))

    def _enter(self, state: FormState, found: Alignment) -> None:
        self._form.flight.align.setEnabled(True)
        if self._form.state() != state:
            self._messages.info(
                tr("The entries changed while the rows were being aligned: press the button again.")
            )
            return
        self._form.set_state(replace(state, row_azimuth_deg=found.azimuth_deg))
        # In the words of the flight's figure, which is then the same.
        text = translate(found.text(partial(length_text, unit=state.agl_unit)))
        self._messages.success(text[:1].upper() + text[1:])

    def _failed(self, error: Exception) -> None:
        self._form.flight.align.setEnabled(True)
        self._messages.refused(translate(reason_of(error)), tr("The rows stay as they are."))


def _found(planned: Planned, way: str, overtaken: Callable[[], bool]) -> Alignment:
    """Look for an azimuth. Runs on a thread of its own."""
    from ...core.mission.flight.alignment import aligned
    from ..sources import heights_for

    mission = planned.mission
    return aligned(mission, planned.plan.grid, heights_for(mission), way, lambda _share: not overtaken())
