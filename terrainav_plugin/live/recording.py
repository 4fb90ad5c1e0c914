"""Poses recorded one after another, and the mission that captures them. No widgets."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...core.mission.areas.area import Points
from ...core.mission.parts import ELLIPSOID, GROUND
from ..form import mission_form

if TYPE_CHECKING:
    from ...core.live.camera import FrameRequest
    from ...core.mission.mission import Mission
    from ..form.state import FormState

#: Largest number of poses of a recording.
MOST_POSES = 10_000


class Recording:
    """Poses in the order of their times; a pose like the one before, or before it in time, is left out.

    Parameters
    ----------
    state : FormState
        Entries of the mission when the recording began.
    """

    def __init__(self, state: FormState) -> None:
        self._state = state
        self.poses: list[FrameRequest] = []

    def __len__(self) -> int:
        return len(self.poses)

    @property
    def is_full(self) -> bool:
        """Whether it has as many poses as it may have."""
        return len(self) >= MOST_POSES

    def add(self, pose: FrameRequest) -> None:
        """Add a pose with its time."""
        if self.is_full:
            return
        last = self.poses[-1] if self.poses else None
        if last is None or (pose.time_s > last.time_s and pose._replace(time_s=last.time_s) != last):
            self.poses.append(pose)

    def mission(self) -> Mission:
        """Mission that captures the poses; raises FormError if an entry is wrong."""
        from ...core.poses.track import ANGLE_DIGITS, PLACE_DIGITS

        state = self._state
        is_level = not (state.effective.elevation or state.effective.surface)
        above = ELLIPSOID if self.poses[0].above_ellipsoid and not is_level else GROUND
        lowered_m = state.ground_height_m if self.poses[0].above_ellipsoid and is_level else 0.0
        rounded = [
            (
                round(pose.lat_deg, PLACE_DIGITS),
                round(pose.lon_deg, PLACE_DIGITS),
                round(pose.up_m - lowered_m, ANGLE_DIGITS),
            )
            for pose in self.poses
        ]
        yaws, tilts, rolls = (
            tuple(round(getattr(pose, name), ANGLE_DIGITS) for pose in self.poses)
            for name in ("yaw_deg", "tilt_deg", "roll_deg")
        )
        times = tuple(round(pose.time_s, 3) for pose in self.poses)
        return mission_form.recorded(state, Points(tuple(rounded), yaws, tilts, rolls, times), above)
