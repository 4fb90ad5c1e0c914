"""Poses along the flight of a plan. No widgets."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...core.live.camera import FrameRequest
from ...core.mission.parts import utc_time
from ..map.canvas import wrap_longitude

if TYPE_CHECKING:
    from ...core.mission.plan import Plan


class FlightPoses:
    """The camera along a planned path: straight from point to point, turned evenly from capture to capture.

    At the time of a capture, the pose is the capture's, moved by wind if there is any.
    """

    def __init__(self, plan: Plan) -> None:
        path = plan.path
        self.start_s = utc_time(plan.direct.start).timestamp()
        self._time_s = path.time_s
        taken = path.capture >= 0
        captures = path.capture[taken]
        self._capture_s = path.time_s[taken]
        self._places = []
        for along, at_captures in (
            (path.lat_deg, plan.lat_deg),
            (path.lon_deg, plan.lon_deg),
            (path.height_m, plan.height_m),
        ):
            places = np.array(along)
            places[taken] = np.asarray(at_captures)[captures]
            self._places.append(places)
        # Turned the shorter way from each capture to the next.
        self._angles = [np.unwrap(angle[captures], period=360.0) for angle in plan.poses.attitude]

    @property
    def span_s(self) -> tuple[float, float]:
        """First and last moment of the flight, in Unix time."""
        return self.start_s + float(self._time_s[0]), self.start_s + float(self._time_s[-1])

    def at(self, unix_s: float) -> FrameRequest | None:
        """Pose at a time; None before and after the flight."""
        first_s, last_s = self.span_s
        if not first_s <= unix_s <= last_s:
            return None
        after_s = unix_s - self.start_s
        lat, lon, height = (float(np.interp(after_s, self._time_s, values)) for values in self._places)
        yaw, tilt, roll = (float(np.interp(after_s, self._capture_s, values)) for values in self._angles)
        turned = yaw - 360.0 * round(yaw / 360.0)
        return FrameRequest(lat, wrap_longitude(lon), height, turned, tilt, roll, unix_s, above_ellipsoid=True)
