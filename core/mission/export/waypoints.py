"""The captures as waypoints for an autopilot: where to fly, how to point aircraft and gimbal, and when."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import Message
from ...geodesy.mercator import wrap_lon_deg
from ..outlines import cut_line
from ..plan import Plan
from .rows import clock, parts

Floats = NDArray[np.float64]

#: Points of a flight line, about; a longer one is drawn through the ends of its rows and some places between.
LINE_POINTS = 50_000


class Waypoint(NamedTuple):
    """One capture as it is asked of an aircraft.

    Parameters
    ----------
    lat_deg, lon_deg : float
        Longitude in [-180, 180).
    heading_deg : float
        Of the aircraft, which is where the top of the picture points, in [0, 360).
    above_first_m : float
        Height above the ground below the first capture; the height above ground where that is level.
    gimbal_pitch_deg : float
        -90 straight down, 0 to the horizon.
    time : str
        UTC, ISO 8601 to the millisecond.
    """

    name: str
    column: int
    row: int
    lat_deg: float
    lon_deg: float
    agl_m: float
    above_first_m: float
    heading_deg: float
    gimbal_pitch_deg: float
    time: str

    @property
    def details(self) -> dict[str, float]:
        """What files say of a waypoint beside its name, place and time."""
        names = ("column", "row", "agl_m", "heading_deg", "gimbal_pitch_deg")
        return {name: getattr(self, name) for name in names}


def waypoints(plan: Plan) -> Iterator[Waypoint]:
    """Captures in flight order, where they were meant to be: what wind does to a flight is not asked of an aircraft.

    A gimbal does not look backwards: a view that is lifted to the rear becomes one to the front of an aircraft that
    is turned around. It sees the same ground, upside down.
    """
    meant = plan.poses if plan.nominal is None else plan.nominal
    lon = wrap_lon_deg(meant.lon_deg)
    above_first = meant.agl_m + (plan.ground_m - plan.ground_m[0])
    for part in parts(len(plan)):
        backwards = meant.tilt_deg[part] < 0.0
        heading = np.mod(meant.yaw_deg[part] + 180.0 * backwards, 360.0)
        # The remainder of a tiny negative angle is rounded to 360.
        heading = np.where(heading >= 360.0, 0.0, heading)
        yield from map(
            Waypoint._make,
            zip(
                plan.names[part],
                plan.column[part].tolist(),
                plan.row[part].tolist(),
                meant.lat_deg[part].tolist(),
                lon[part].tolist(),
                meant.agl_m[part].tolist(),
                above_first[part].tolist(),
                heading.tolist(),
                (np.abs(meant.tilt_deg[part]) - 90.0).tolist(),
                clock(plan.start, plan.times_s[part]),
            ),
        )


def flight_line(plan: Plan) -> list[tuple[Floats, Floats, Floats]]:
    """Way from waypoint to waypoint as longitudes, latitudes and heights above ground, cut at the antimeridian.

    Of more than `LINE_POINTS` waypoints it goes through every k-th and through the ends of the rows, and where even
    those are too many, through every k-th.
    """
    meant = plan.poses if plan.nominal is None else plan.nominal
    count = len(plan)
    stride = -(-count // LINE_POINTS)
    places = np.arange(0, count, stride)
    if stride > 1:
        turns = np.flatnonzero(np.diff(plan.row))
        if 2 * len(turns) <= LINE_POINTS:
            places = np.union1d(places, np.concatenate([turns, turns + 1]))
        places = np.union1d(places, [count - 1])
    lines = cut_line(meant.lon_deg[places], meant.lat_deg[places], meant.agl_m[places])
    return [(lon, lat, agl) for lon, lat, agl in lines]


def not_flown(plan: Plan) -> tuple[str, ...]:
    """What of a mission an autopilot's mission of waypoints cannot say, one line each."""
    notes = []
    meant = plan.poses if plan.nominal is None else plan.nominal
    roll, tilt = float(meant.roll_deg[np.abs(meant.roll_deg).argmax()]), float(meant.tilt_deg.min())
    if roll:
        notes.append(Message("the roll of {0:g} deg is left out: waypoints have none", roll))
    if tilt < 0.0:
        notes.append(
            Message(
                "the tilt of {0:g} deg is flown with the aircraft turned around: same ground, "
                "images upside down",
                tilt,
            )
        )
    if plan.nominal is not None:
        notes.append(Message("wind is left out: waypoints are at the planned positions"))
    return tuple(notes)
