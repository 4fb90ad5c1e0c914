"""Figures of a plan for its pilot: sorties, time between images, and the position of the sun."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...arrays import Floats
from ...errors import InvalidInput, Message, OptionName
from ...fields import field_named
from ...geodesy.sun import sun_position
from ..parts import DJI_FLY, HOVER, Flight, Route, utc_time
from ..plan import Plan
from .legs import legs
from .path import HOVER_S, LANDING, TAKEOFF

#: Speed that is chosen at most: the greatest of DJI's and Litchi's waypoint flights.
FASTEST_M_PER_S = 15.0
#: Speeds of take-off and landing: QGroundControl's defaults.
ASCENT_M_PER_S, DESCENT_M_PER_S = 3.0, 1.0
#: Maximum flight times of drones, minutes, without payload and wind until the battery is empty: DJI, Payload SDK
#: documentation, "Hardware Platform" (developer.dji.com/doc/payload-sdk-tutorial). It has neither the Mavic 3M nor the
#: Mini 4 Pro, which stands for the drones of DJI Fly: these two are not confirmed.
ENDURANCE_MIN = {
    "mavic-3e": 45.0,
    "mavic-3t": 45.0,
    "mavic-3m": 43.0,
    "m30": 41.0,
    "m30t": 41.0,
    "m300": 55.0,
    "m350": 55.0,
    "m4e": 49.0,
    "m4t": 49.0,
    DJI_FLY: 34.0,
}
#: Share of a battery that is flown; QGroundControl warns at 30 %.
FLOWN_SHARE = 0.7

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


def sorties_text(sorties_s: tuple[float, ...], battery_min: float | None) -> Message:
    """Number of sorties, and the minutes of each, of those of a battery."""
    minutes = [seconds / 60.0 for seconds in sorties_s]
    if len(minutes) > 6:
        each = Message("{0:.1f} to {1:.1f}", min(minutes), max(minutes))
    else:
        each = Message.joined(", ", [Message("{0:.1f}", one) for one in minutes])
    if battery_min is None:
        return Message("{0}: {1} min", len(minutes), each)
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


class SpeedLimits(NamedTuple):
    """Greatest airspeeds at which the camera keeps up, and at which the blur is as allowed; None if unlimited."""

    interval_m_per_s: float | None
    blur_m_per_s: float | None
    photo_interval_s: float | None
    exposure_ms: float | None
    blur_px: float

    @property
    def least_m_per_s(self) -> float | None:
        """Greatest airspeed within both limits; None if unlimited."""
        return min((one for one in self[:2] if one is not None), default=None)

    @property
    def text(self) -> Message:
        """Limits in words, the lower one first."""
        interval, blur, photo_interval_s, exposure_ms, blur_px = self
        limits = []
        if interval is not None:
            limits.append((interval, Message("{0:g} m/s for an image every {1:g} s", interval, photo_interval_s)))
        if blur is not None:
            limits.append((blur, Message("{0:g} m/s for {1:g} px of blur in {2:g} ms", blur, blur_px, exposure_ms)))
        return Message.joined(", ", [text for _, text in sorted(limits, key=lambda one: one[0])])


def speed_limits(plan: Plan) -> SpeedLimits:
    """Greatest airspeeds for the camera's interval and for the motion blur, rounded down to 0.1 m/s; 0 if none will do.

    Rows with a tail wind limit the airspeed most. The blur counts straight below the lowest capture; a camera that
    hovers has none.
    """
    shots, route = _shots(plan), plan.mission.route
    interval = blur = None
    if route.photo_interval_s is not None and len(shots.length_m):
        moving_s = route.photo_interval_s - _stop_s(plan)
        interval = _airspeed(plan, shots, shots.length_m / moving_s) if moving_s > 0.0 else None
    blurred = _blurred_speed(plan)
    if blurred is not None:
        blur = _airspeed(plan, shots, np.full_like(shots.length_m, blurred)) if len(shots.length_m) else blurred
    return SpeedLimits(interval, blur, route.photo_interval_s, route.exposure_ms, route.blur_px)


def greatest_speed_m_per_s(plan: Plan) -> float:
    """Greatest airspeed that the camera's interval and the motion blur allow, at most `FASTEST_M_PER_S`.

    Raises
    ------
    InvalidInput
        The mission states neither limit, or no speed is slow enough.
    """
    found = speed_limits(plan).least_m_per_s
    if found is None:
        raise InvalidInput(
            "airspeed auto: needs a limit of the camera",
            remedy=Message(
                "give its minimum image interval{0} or its exposure time{1}",
                OptionName("photo_interval").in_brackets,
                OptionName("exposure_ms").in_brackets,
            ),
            field="airspeed_m_per_s",
        )
    if not found:
        raise InvalidInput(
            "airspeed auto: no speed is slow enough for the camera",
            remedy="overlap less or fly higher",
            field="airspeed_m_per_s",
        )
    return min(found, FASTEST_M_PER_S)


def _blurred_speed(plan: Plan) -> float | None:
    """Ground speed at which the motion blur is as great as allowed, m/s; None if the camera has none."""
    route = plan.mission.route
    if route.exposure_ms is None or plan.mission.trigger == HOVER:
        return None
    gsd_m = plan.mission.camera.gsd_m_per_px(float(plan.meant.agl_m.min()), plan.mission.pixels.image_px)
    return route.blur_px * gsd_m / (route.exposure_ms / 1000.0)


def _airspeed(plan: Plan, shots: _Shots, ground_m_per_s: Floats) -> float:
    """Greatest airspeed at which no leg is flown faster over ground, to 0.1 m/s; 0 if the wind alone is faster."""
    air = ground_m_per_s + shots.headwind_m_per_s
    speed = float(np.where(air > 0.0, np.hypot(air, shots.crosswind_m_per_s), 0.0).min())
    # Rounded down, so that the camera keeps up.
    speed = math.floor(speed * 10.0) / 10.0
    slowest = 0.0 if plan.mission.wind is None else plan.mission.wind.speed_m_per_s
    return speed if speed > slowest else 0.0


def interval_warnings(plan: Plan) -> tuple[str, ...]:
    """Warnings where the flight is too fast for the camera's interval or its motion blur."""
    limits, found_s, blurred = speed_limits(plan), interval_s(plan), _blurred_speed(plan)
    warnings: list[tuple[Message, float | None]] = []
    least_s = limits.photo_interval_s
    if least_s is not None and found_s is not None and found_s < least_s:
        warning = Message("images every {0:.2g} s: the camera takes one every {1:g} s", found_s, least_s)
        warnings.append((warning, limits.interval_m_per_s))
    if blurred is not None and _greatest_ground_speed(plan) > blurred:
        blur_px = limits.blur_px * _greatest_ground_speed(plan) / blurred
        warning = Message("motion blur of {0:.2g} px: more than {1:g} px", blur_px, limits.blur_px)
        warnings.append((warning, limits.blur_m_per_s))
    return tuple(
        Message("{0}; fly at {1:g} m/s or slower ({2})", warning, speed, OptionName("airspeed"))
        if speed
        else Message("{0}; overlap less or fly higher", warning)
        for warning, speed in warnings
    )


def _greatest_ground_speed(plan: Plan) -> float:
    shots, airspeed = _shots(plan), plan.mission.flight.airspeed_m_per_s
    ground = np.sqrt(airspeed**2 - shots.crosswind_m_per_s**2) - shots.headwind_m_per_s
    return float(ground.max()) if len(ground) else airspeed


def airborne_s(plan: Plan) -> Floats:
    """Seconds from take-off to landing of each sortie, (k,), as QGroundControl counts them.

    Climb and landing are vertical, at its default speeds; in between, times are those of the path. Without a take-off
    point, the flight begins and ends below the first point. Turns take the time of their way alone.
    """
    path, found = plan.path, []
    for number in range(path.sorties):
        one = path.sortie_path(number)
        air = np.flatnonzero((one.kind != TAKEOFF) & (one.kind != LANDING))
        first, last = int(air[0]), int(air[-1])
        has_home = first > 0
        base_m = path.base_m if has_home else float(one.ground_m[first])
        home = 0 if has_home else first
        back = legs(one.lat_deg[[last, home]], one.lon_deg[[last, home]])
        speed = plan.mission.flight.airspeed_m_per_s
        if plan.mission.wind is not None:
            speed = float(plan.mission.wind.ground_speed_m_per_s(back.azimuth_deg, speed)[0])
        found.append(
            float(one.time_s[last] - one.time_s[first])
            + float(back.distance_m[0]) / speed
            + abs(float(one.height_m[first]) - base_m) / ASCENT_M_PER_S
            + abs(float(one.height_m[last]) - base_m) / DESCENT_M_PER_S
        )
    return np.array(found)


def airborne_text(seconds: float, count: int, drone: str) -> Message:
    """Time from take-off to landing in words, with the batteries of a drone that it takes."""
    title = Message(field_named(Route, "drone").choices[drone])
    return Message("{0:.1f} min; batteries of the {1}: {2:,}", seconds / 60.0, title, count)


def batteries(plan: Plan, seconds: Floats) -> int:
    """Number of batteries that sorties take: one for each, or as the endurance of the drone is."""
    if plan.mission.route.battery_min is not None:
        return len(seconds)
    flown_s = 60.0 * FLOWN_SHARE * ENDURANCE_MIN[plan.mission.route.drone]
    return sum(math.ceil(one / flown_s) for one in seconds.tolist())


def _stop_s(plan: Plan) -> float:
    return HOVER_S if plan.mission.trigger == HOVER else 0.0
