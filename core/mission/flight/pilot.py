"""What a pilot asks of a plan: its sorties, whether the camera keeps up, and where the sun stands."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...arrays import Floats
from ...errors import Message, OptionName
from ...geodesy.sun import sun_position
from ..parts import HOVER, Flight, utc_time
from ..plan import Plan
from .path import HOVER_S

#: Below this the sun casts shadows longer than 1.7 times what stands there, degrees.
_LOW_SUN_DEG = 30.0
#: Sorties that are told one by one.
_TOLD = 6
_DIRECTIONS = (
    *(Message("north"), Message("north-east"), Message("east"), Message("south-east")),
    *(Message("south"), Message("south-west"), Message("west"), Message("north-west")),
)


class Sun(NamedTuple):
    """The sun over the area's middle: its height and azimuth, clockwise from north, at the flight's start and end."""

    height_deg: float
    azimuth_deg: float
    end_height_deg: float
    end_azimuth_deg: float

    def text(self, fov_deg: float) -> Message:
        """Where it stands, in words, and what that does to images that look straight down; 0 for others."""
        start = _stands(self.height_deg, self.azimuth_deg)
        end = _stands(self.end_height_deg, self.end_azimuth_deg)
        text = start if start == end else Message("{0}, at the end {1}", start, end)
        heights = self.height_deg, self.end_height_deg
        if min(heights) < 0.0:
            return Message("{0}: night", text)
        if min(heights) < _LOW_SUN_DEG:
            return Message("{0}: long shadows", text)
        # What lies opposite the sun shows no shadows, and water at the same angle mirrors it.
        if 90.0 - max(heights) < fov_deg / 2.0:
            return Message("{0}: a bright spot, and glint on water, lie in the images", text)
        return text


def _stands(height_deg: float, azimuth_deg: float) -> Message:
    where = _DIRECTIONS[round(azimuth_deg / 45.0) % len(_DIRECTIONS)]
    if height_deg < 0.0:
        return Message("{0:.0f}° below the horizon in the {1}", -height_deg, where)
    return Message("{0:.0f}° high in the {1}", height_deg, where)


def sun_of(plan: Plan) -> Sun | None:
    """Where the sun stands; None where the mission does not say when it is flown."""
    # Lines are flown from the start that is entered: their times say no more than it does.
    if plan.mission.flight.start == Flight.start and (
        not plan.has_times or utc_time(plan.start) == utc_time(Flight.start)
    ):
        return None
    west, south, east, north = plan.mission.area.bounds.edges_deg
    seconds = plan.path.time_s[[0, -1]]
    heights, azimuths = sun_position(plan.start, seconds, (south + north) / 2.0, (west + east) / 2.0)
    return Sun(float(heights[0]), float(azimuths[0]), float(heights[1]), float(azimuths[1]))


def sorties_text(sorties_s: tuple[float, ...], battery_min: float) -> Message:
    """How many sorties there are, and how long they take of a battery."""
    minutes = [seconds / 60.0 for seconds in sorties_s]
    if len(minutes) > _TOLD:
        each = Message("{0:.1f} to {1:.1f}", min(minutes), max(minutes))
    else:
        each = Message.joined(", ", [Message("{0:.1f}", one) for one in minutes])
    return Message("{0}: {1} of {2:g} min", len(minutes), each, battery_min)


class _Shots(NamedTuple):
    """Legs between images of one row: their lengths, and the wind along and across them towards the aircraft."""

    length_m: Floats
    against_m_per_s: Floats
    across_m_per_s: Floats


def _shots(plan: Plan) -> _Shots:
    way = plan.legs
    along = way.distance_m > 0.0 if len(plan) > 1 else np.zeros(0, bool)
    along &= np.diff(plan.row) == 0
    azimuth = np.radians(way.azimuth_deg[along])
    wind = plan.mission.wind
    speed, origin = (0.0, 0.0) if wind is None else (wind.speed_m_per_s, math.radians(wind.from_deg))
    return _Shots(way.distance_m[along], speed * np.cos(origin - azimuth), speed * np.sin(origin - azimuth))


def interval_s(plan: Plan) -> float | None:
    """Least time between two images of a row; None where no row has two."""
    shots, airspeed = _shots(plan), plan.mission.flight.airspeed_m_per_s
    if not len(shots.length_m):
        return None
    ground = np.sqrt(airspeed**2 - shots.across_m_per_s**2) - shots.against_m_per_s
    return float((shots.length_m / ground).min()) + _stop_s(plan)


def too_fast(plan: Plan) -> tuple[str, ...]:
    """Return what there is to say of images that follow each other faster than the camera takes them."""
    least_s, found_s = plan.mission.route.photo_interval_s, interval_s(plan)
    if least_s is None or found_s is None or found_s >= least_s:
        return ()
    said = Message("images every {0:.2g} s: the camera takes one every {1:g} s", found_s, least_s)
    shots, moving_s = _shots(plan), least_s - _stop_s(plan)
    air = shots.length_m / moving_s + shots.against_m_per_s
    slowest = 0.0 if plan.mission.wind is None else plan.mission.wind.speed_m_per_s
    speed = float(np.where(air > 0.0, np.hypot(air, shots.across_m_per_s), 0.0).min())
    # Rounded down, so that it does.
    speed = math.floor(speed * 10.0) / 10.0
    if speed <= slowest:
        return (Message("{0}; overlap less or fly higher", said),)
    return (Message("{0}; fly at {1:g} m/s or slower ({2})", said, speed, OptionName("airspeed")),)


def _stop_s(plan: Plan) -> float:
    return HOVER_S if plan.mission.trigger == HOVER else 0.0
