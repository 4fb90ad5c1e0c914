"""Plan the entered mission, and show its figures or the errors of entries."""

from __future__ import annotations

import operator
import traceback
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from qgis.PyQt.QtCore import QObject, pyqtSignal

from ...core.errors import TerrAInavError
from ..form import mission_form
from ..form.area import FormError
from ..form.state import BOX_FIELDS, DECLARED, FormState
from ..i18n import tr, translate
from ..sources import source_policy
from .figures import readout

if TYPE_CHECKING:
    from ...core.mission.mission import Mission
    from ..messages import Messages
    from ..planner import PlannedMission, Planner
    from .dock import Dock


class Planning(QObject):
    """Keep the figures up to date with the entries, and provide the plan of the entered mission.

    Parameters
    ----------
    dock : Dock
    planner : Planner
    messages : Messages
    timed : callable
        Returns whether methods may be timed now: during a capture, the times would be wrong.

    Signals
    -------
    planned(object)
        The `PlannedMission` of the entered mission.
    unplanned(str)
        There is no plan of the entered mission any more, with the reason; an empty text while one is worked out.

    Attributes
    ----------
    latest : PlannedMission or None
        Plan of the entered mission; None until it exists.
    """

    planned = pyqtSignal(object)
    unplanned = pyqtSignal(str)

    def __init__(self, dock: Dock, planner: Planner, messages: Messages, timed: Callable[[], bool]) -> None:
        super().__init__()
        self._dock, self._form, self._planner = dock, dock.form, planner
        self._messages, self._may_time = messages, timed
        self.latest: PlannedMission | None = None
        self._asked: Mission | None = None
        #: Mission whose rows and images the numbers of skipped rows and splits count; None after another was opened.
        self._numbered: Mission | None = None
        self._timed: tuple[Mission, str] | None = None
        self._when_planned: Callable[[PlannedMission], None] | None = None
        self._refusal = ""
        self._closed = False
        self._form.changed.connect(self._form_changed)
        planner.planned.connect(self._show_planned)
        planner.costed.connect(self._show_cost)
        planner.refused.connect(self._show_refused)
        planner.reading.connect(dock.figures.show_reading)
        planner.features_read.connect(lambda _planned, features: self._form.labels.show_notes(features.notes))
        dock.reading_cancelled.connect(self.cancel_reading)
        dock.reading_wanted.connect(lambda: self.plan(at_once=True))

    def close(self) -> None:
        """Stop for good."""
        self._closed = True
        self._planner.close()

    def use_plan(self, act: Callable[[PlannedMission], None], refusal: str, *, anew: bool = False) -> None:
        """Call ``act`` with the plan of the entered mission, as soon as there is one.

        Parameters
        ----------
        refusal : str
            Text shown after the reason if planning fails.
        anew : bool
            Whether to plan again even if there is a plan, as the source may have changed.
        """
        if self._closed:
            # The plugin was unloaded while a dialog was open.
            return
        if self.latest is not None and not anew and self.is_entered(self.latest.mission):
            act(self.latest)
            return
        is_waiting = self._when_planned is not None and self._asked is not None
        self._when_planned = act
        self._refusal = refusal
        if is_waiting and self._planner.busy and self.is_entered(self._asked):
            # A repeated request does not restart planning.
            return
        # Withdraw it before planning, which may take a while.
        self._messages.withdraw_refusal()
        self._messages.wait(tr("Working out the plan…"))
        if not self.plan(at_once=True):
            self._stop_waiting()
            self.refuse(refusal)

    def plan(self, at_once: bool = False) -> bool:
        """Request a plan; if an entry is wrong, mark it and return False."""
        state = self._form.state()
        try:
            mission = mission_form.mission(state)
        except FormError as wrong:
            self._planner.forget()
            self.latest = None
            messages = wrong.messages
            if not any(getattr(state, name).strip() for name in BOX_FIELDS):
                # An empty form is not an error.
                messages = {name: text for name, text in messages.items() if name not in BOX_FIELDS}
            self._form.show_messages(messages)
            unseen = self._form.marks.hidden_messages(messages)
            if unseen or state.has_box:
                self._show_problem(unseen)
            else:
                self._dock.show_nothing()
                self.unplanned.emit(tr("No area yet."))
            return False
        if self._clear_numbers(state, mission):
            # The form has changed, and is being planned.
            return True
        self._form.show_messages({})
        self._asked = mission
        outdated = self.latest is None or self.latest.mission != mission
        self._dock.figures.show_working(outdated)
        if outdated:
            self.unplanned.emit("")
        timed = not self._mission_cost(mission) and self._may_time() and self._when_planned is None
        self._planner.request(mission, at_once, timed)
        return True

    def cancel_reading(self) -> None:
        """Stop reading files; there is no plan until an entry changes, or the user wants them to be read."""
        self._planner.forget()
        self.latest = None
        self._stop_waiting()
        self._dock.figures.show_cancelled()
        self.unplanned.emit(self._dock.problem.text())

    def forget_numbers(self) -> None:
        """Take the numbers of skipped rows and splits of the next mission as they are, as another one is opened."""
        self._numbered = None

    def has_rows_of(self, planned: PlannedMission) -> bool:
        """Whether the rows and images of a plan have the numbers of the entered mission's."""
        return self._asked is not None and all(map(operator.eq, _numbering(self._asked), _numbering(planned.mission)))

    def _clear_numbers(self, state: FormState, mission: Mission) -> bool:
        """Clear skipped rows and splits if the user's change has given other numbers to rows or images."""
        before, self._numbered = self._numbered, mission
        if before is None:
            return False
        (rows, images), (old_rows, old_images) = _numbering(mission), _numbering(before)
        cleared: dict[str, str] = {}
        skipped, splits = mission.flight.skip_rows, mission.route.split_after
        if rows != old_rows and skipped and skipped == before.flight.skip_rows:
            cleared["skip_rows"] = ""
        if images != old_images and splits and splits == before.route.split_after:
            cleared["split_after"] = ""
        if not cleared:
            return False
        self._messages.info(
            tr("Cleared because rows and images have new numbers: {entries}.").format(
                entries=", ".join(translate(DECLARED[name].title) for name in cleared)
            )
        )
        self._form.set_state(replace(state, **cleared))
        return True

    def is_entered(self, mission: Mission) -> bool:
        """Return whether a mission is the entered one."""
        try:
            return bool(mission_form.mission(self._form.state()) == mission)
        except FormError:
            return False

    def refuse(self, what: str) -> None:
        """Report the first problem of the entries; ``what`` is a sentence on what is missing as a result."""
        wrong = self._form.marks.first_message() or self._dock.problem.text()
        self._messages.refused(wrong or tr("no area yet; draw a box or enter coordinates"), what)

    def _form_changed(self) -> None:
        if self._when_planned is not None:
            self._stop_waiting()
            self._messages.info(tr("The entries changed while the plan was being computed: press the button again."))
        self.plan()

    def _stop_waiting(self) -> None:
        self._when_planned = None
        self._messages.stop_waiting()

    def _show_planned(self, planned: PlannedMission) -> None:
        self.latest = planned
        if not (planned.mission.labels.labels or planned.mission.terrain.buildings):
            self._form.labels.show_notes({})
        self._show_figures(planned)
        self._form.pixels.show_zooms(planned.plan, self._form.state().agl_unit)
        self.planned.emit(planned)
        act = self._when_planned
        self._stop_waiting()
        if act is not None:
            act(planned)

    def _show_cost(self, planned: PlannedMission, cost: str) -> None:
        self._timed = planned.mission, cost
        self._show_figures(planned)

    def _show_figures(self, planned: PlannedMission) -> None:
        cost = self._mission_cost(planned.mission)
        if not cost and (not self._may_time() or self._when_planned is not None):
            cost = tr("not timed during a capture")
        unit = self._form.state().agl_unit
        policy = source_policy(planned.plan.mission.imagery.source)
        others = {
            name: (one.requests, source_policy(one.mission.imagery.source))
            for name, one in [*planned.plans.by_imagery.items()][1:]
        }
        self._dock.figures.show_readout(readout(planned.plan, planned.summary, unit, cost, policy, others))

    def _mission_cost(self, mission: Mission) -> str:
        """Text on the timing of a mission's methods; empty if unknown."""
        return self._timed[1] if self._timed is not None and self._timed[0] == mission else ""

    def _show_problem(self, text: str) -> None:
        """Show why there are no figures; an empty text refers to the marked fields."""
        self._form.labels.show_notes({})
        self._dock.show_problem(text)
        self.unplanned.emit(text or self._form.marks.first_message())

    def _show_refused(self, error: Exception) -> None:
        self.latest = None
        waiting = self._when_planned
        self._stop_waiting()
        if isinstance(error, FormError):
            self._form.show_messages(error.messages)
            self._show_problem(self._form.marks.hidden_messages(error.messages))
        elif isinstance(error, TerrAInavError):
            messages = mission_form.refused_fields(error)
            self._form.show_messages(messages)
            self._show_problem(next(iter(messages.values()), translate(error)))
        else:
            self._show_problem(tr("Unexpected error: {error}").format(error=repr(error)))
            self._messages.error(
                tr("The mission could not be planned."),
                "".join(traceback.format_exception(None, error, error.__traceback__)),
            )
        if waiting is not None:
            self.refuse(self._refusal)


def _numbering(mission: Mission) -> tuple[Any, Any]:
    """Settings that number the rows, and settings that number the images in flight order."""
    from ...core.mission.parts import NEAREST, Flight

    skipped = mission.flight.skip_rows
    flight = replace(mission.flight, skip_rows="", airspeed_m_per_s=Flight.airspeed_m_per_s, start=Flight.start)
    accuracy, imagery, route = mission.accuracy, mission.imagery, mission.route
    rows = (
        *(mission.area, mission.camera, mission.attitude, replace(flight, order=Flight.order), mission.pixels),
        *(mission.terrain, accuracy.frame, accuracy.error_budget_px, imagery.source, imagery.crs),
    )
    home = route.takeoff if route.entry == NEAREST else None
    return rows, (rows, flight.order, skipped, mission.no_fly, route.entry, home)
