"""Figures of a plan for its pilot: sorties, time between images, and the position of the sun."""

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

_DIRECTIONS = (
    *(Message("north"), Message("north-east"), Message("east"), Message("south-east")),
    *(Message("south"), Message("south-west"), Message("west"), Message("north-west")),
)


class Sun(NamedTuple):
    """Sun over the middle of the area: height and azimuth (clockwise from north) at start and end of the flight."""

    height_deg: float
    azimuth_deg: float
    end_height_deg: float
    end_azimuth_deg: float

    def text(self, fov_deg: float) -> Message:
        """Position in words, and its effect on images.

        Parameters
        ----------
        fov_deg : float
            Diagonal field of view of a camera that looks straight down; 0 for other cameras.
        """
        start = _position_text(self.height_deg, self.azimuth_deg)
        end = _position_text(self.end_height_deg, self.end_azimuth_deg)
        text = start if start == end else Message("{0}, at the end {1}", start, end)
        heights = self.height_deg, self.end_height_deg
        if min(heights) < 0.0:
            return Message("{0}: night", text)
        # Shadows are longer than 1.7 times the height of objects.
        if min(heights) < 30.0:
            return Message("{0}: long shadows", text)
        # Opposite the sun no shadows are visible, and water reflects the sun at the same angle.
        if 90.0 - max(heights) < fov_deg / 2.0:
            return Message("{0}: a bright spot, and glint on water, lie in the images", text)
        return text


def _position_text(height_deg: float, azimuth_deg: float) -> Message:
    where = _DIRECTIONS[round(azimuth_deg / 45.0) % len(_DIRECTIONS)]
    if height_deg < 0.0:
        return Message("{0:.0f}° below the horizon in the {1}", -height_deg, where)
    return Message("{0:.0f}° high in the {1}", height_deg, where)


def area_sun(plan: Plan) -> Sun | None:
    """Position of the sun during the flight; None where the mission has no start time."""
    # The default start states no date, nor do times that count from it.
    if plan.mission.flight.start == Flight.start and (
        not plan.direct.has_times or utc_time(plan.direct.start) == utc_time(Flight.start)
    ):
        return None
    west, south, east, north = plan.mission.area.bounds.edges_deg
    seconds = plan.path.time_s[[0, -1]]
    heights, azimuths = sun_position(plan.direct.start, seconds, (south + north) / 2.0, (west + east) / 2.0)
    return Sun(float(heights[0]), float(azimuths[0]), float(heights[1]), float(azimuths[1]))


def sorties_text(sorties_s: tuple[float, ...], battery_min: float) -> Message:
    """Number of sorties, and the share of a battery that each takes."""
    minutes = [seconds / 60.0 for seconds in sorties_s]
    if len(minutes) > 6:
        each = Message("{0:.1f} to {1:.1f}", min(minutes), max(minutes))
    else:
        each = Message.joined(", ", [Message("{0:.1f}", one) for one in minutes])
    return Message("{0}: {1} of {2:g} min", len(minutes), each, battery_min)


class _Shots(NamedTuple):
    """Legs between images of one row: length, headwind and crosswind."""

    length_m: Floats
    headwind_m_per_s: Floats
    crosswind_m_per_s: Floats


def _shots(plan: Plan) -> _Shots:
    flown_legs = plan.direct.legs
    along = flown_legs.distance_m > 0.0 if len(plan) > 1 else np.zeros(0, bool)
    along &= np.diff(plan.row) == 0
    azimuth = np.radians(flown_legs.azimuth_deg[along])
    wind = plan.mission.wind
    speed, origin = (0.0, 0.0) if wind is None else (wind.speed_m_per_s, math.radians(wind.from_deg))
    return _Shots(flown_legs.distance_m[along], speed * np.cos(origin - azimuth), speed * np.sin(origin - azimuth))


def interval_s(plan: Plan) -> float | None:
    """Shortest time between two images of a row; None where no row has two."""
    shots, airspeed = _shots(plan), plan.mission.flight.airspeed_m_per_s
    if not len(shots.length_m):
        return None
    ground = np.sqrt(airspeed**2 - shots.crosswind_m_per_s**2) - shots.headwind_m_per_s
    return float((shots.length_m / ground).min()) + _stop_s(plan)


def interval_warnings(plan: Plan) -> tuple[str, ...]:
    """Warnings where images follow each other faster than the camera can take them."""
    least_s, found_s = plan.mission.route.photo_interval_s, interval_s(plan)
    if least_s is None or found_s is None or found_s >= least_s:
        return ()
    warning = Message("images every {0:.2g} s: the camera takes one every {1:g} s", found_s, least_s)
    shots, moving_s = _shots(plan), least_s - _stop_s(plan)
    air = shots.length_m / moving_s + shots.headwind_m_per_s
    slowest = 0.0 if plan.mission.wind is None else plan.mission.wind.speed_m_per_s
    speed = float(np.where(air > 0.0, np.hypot(air, shots.crosswind_m_per_s), 0.0).min())
    # Rounded down, so that the camera keeps up.
    speed = math.floor(speed * 10.0) / 10.0
    if speed <= slowest:
        return (Message("{0}; overlap less or fly higher", warning),)
    return (Message("{0}; fly at {1:g} m/s or slower ({2})", warning, speed, OptionName("airspeed")),)


def _stop_s(plan: Plan) -> float:
    return HOVER_S if plan.mission.trigger == HOVER else 0.0
