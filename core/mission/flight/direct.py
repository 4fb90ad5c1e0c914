"""The direct flight from capture to capture, without turns and transits: legs and exposures."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Floats, Numbers
from ...geodesy.camera import Poses
from ..mission import Mission
from .legs import Legs, intervals_s, legs


@dataclass(frozen=True, eq=False)
class DirectFlight:
    """Flight through captures (n) in order.

    Attributes
    ----------
    column : array (n,) of int64
        Column of each capture; of points, the index in the mission.
    meant, flown : Poses
        Planned poses, (n,), and poses moved by wind.
    """

    mission: Mission
    column: Numbers
    meant: Poses
    flown: Poses

    @cached_property
    def legs(self) -> Legs:
        """Legs between planned poses."""
        return legs(self.meant.lat_deg, self.meant.lon_deg)

    @cached_property
    def distance_m(self) -> float:
        """Geodesic length of the flight from the first capture to the last, without climbs."""
        is_moved = self.flown is not self.meant
        flown_legs = legs(self.flown.lat_deg, self.flown.lon_deg) if is_moved else self.legs
        return float(np.sum(flown_legs.distance_m))

    @cached_property
    def exposures_s(self) -> Floats:
        """Seconds of each exposure after the first one, (n,).

        Points may state times; otherwise times follow from the legs, see `legs.intervals_s`.
        """
        mission = self.mission
        stated = stated_times_s(mission, self.column)
        if stated is not None:
            since: Floats = stated - stated[0]
            return since
        times = np.zeros(len(self.column))
        np.cumsum(
            intervals_s(self.legs, self.meant.agl_m, mission.flight.airspeed_m_per_s, mission.wind),
            out=times[1:],
        )
        return times

    @property
    def duration_s(self) -> float:
        """Seconds from the first exposure to the last."""
        return float(self.exposures_s[-1])

    @property
    def has_times(self) -> bool:
        """Whether the captures are points that state their times."""
        return stated_times_s(self.mission, self.column) is not None

    @property
    def start(self) -> str:
        """UTC of the first exposure as ISO 8601: the time of the first point, or the mission's start."""
        stated = stated_times_s(self.mission, self.column)
        if stated is None:
            return self.mission.flight.start
        return f"{np.datetime64(round(float(stated[0]) * 1e6), 'us')}Z"


def stated_times_s(mission: Mission, column: Numbers) -> Floats | None:
    """Times of points by column, (n,); None if the mission states none."""
    times = mission.area.times_s
    return np.array(times, np.float64)[column] if times else None
