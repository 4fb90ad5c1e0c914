"""Enter the greatest airspeed that the camera allows."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from ...core.errors import TerrAInavError
from ..i18n import number_text, tr, translate

if TYPE_CHECKING:
    from ..messages import Messages
    from ..planner import PlannedMission
    from .form import DockForm
    from .planning import Planning


def enter_fastest(form: DockForm, planning: Planning, messages: Messages) -> None:
    """Enter the greatest airspeed for the camera's interval and for the motion blur, and say which one it follows."""
    planning.use_plan(partial(_enter, form, messages), tr("The airspeed stays as it is."))


def _enter(form: DockForm, messages: Messages, planned: PlannedMission) -> None:
    from ...core.mission.flight.pilot import greatest_speed_m_per_s, speed_limits

    try:
        speed = greatest_speed_m_per_s(planned.plan)
    except TerrAInavError as wrong:
        messages.refused(translate(wrong), tr("The airspeed stays as it is."))
        return
    form.set_state(replace(form.state(), airspeed_m_per_s=speed))
    text = tr("Airspeed {speed} m/s. Greatest speed: {limits}.")
    messages.success(text.format(speed=number_text(speed, "g"), limits=translate(speed_limits(planned.plan).text)))
