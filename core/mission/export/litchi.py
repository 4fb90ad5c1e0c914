"""A plan for Litchi, which flies DJI drones: the CSV of its Mission Hub.

Columns, codes and ranges are those of the files that the Mission Hub writes (44 columns in metric units), described at
https://www.litchiutilities.com/docs/litchiCsv.php; limits of a mission are those of DJI's SDK.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...errors import InvalidInput, Message
from ..plan import Plan
from .waypoints import Waypoint, not_flown, waypoints

ACTIONS = 15
COLUMNS = (
    *("latitude", "longitude", "altitude(m)", "heading(deg)", "curvesize(m)", "rotationdir"),
    *("gimbalmode", "gimbalpitchangle"),
    *(f"action{what}{number}" for number in range(1, ACTIONS + 1) for what in ("type", "param")),
    *("altitudemode", "speed(m/s)", "poi_latitude", "poi_longitude", "poi_altitude(m)", "poi_altitudemode"),
    *("photo_timeinterval", "photo_distinterval"),
)
#: Waypoints that DJI's drones take in one go, and that make a mission at all.
MOST_WAYPOINTS, FEWEST_WAYPOINTS = 99, 2
#: Files of one flight, at most: Litchi itself holds no more than some 10,000 waypoints.
MOST_PARTS = 101
HIGHEST_M = 500.0
FASTEST_M_PER_S = 15.0
#: Lowest and highest pitch that the format takes.
_PITCHES_DEG = (-90.0, 30.0)
#: Codes of the columns: the pitch is set; the height is above ground; a picture is taken; no further action.
_INTERPOLATE, _ABOVE_GROUND, _TAKE_PHOTO, _NONE = 2, 1, 1, -1


def check_litchi(plan: Plan) -> None:
    """Raise InvalidInput for a mission that Litchi or DJI's drones do not take."""
    meant = plan.poses if plan.nominal is None else plan.nominal
    if len(plan) < FEWEST_WAYPOINTS:
        raise InvalidInput(
            "Litchi mission of one waypoint: takes two or more", remedy="plan a list or an area"
        )
    if len(plan) > MOST_PARTS * MOST_WAYPOINTS:
        raise InvalidInput(
            "Litchi mission of {0:,} waypoints: takes {1:,} or fewer",
            len(plan),
            MOST_PARTS * MOST_WAYPOINTS,
            remedy="plan a smaller area, a greater height or less overlap",
        )
    highest = float(meant.agl_m.max())
    if highest > HIGHEST_M:
        raise InvalidInput(
            "Litchi mission at {0:g} m: must be {1:g} m above ground or less", highest, HIGHEST_M
        )
    pitch = float(np.abs(meant.tilt_deg).max()) - 90.0
    if pitch > _PITCHES_DEG[1]:
        raise InvalidInput(
            "Litchi mission with the gimbal lifted to {0:g} deg: must be {1:g} to {2:g}, a tilt of {3:g} or "
            "less",
            pitch,
            _PITCHES_DEG[0],
            _PITCHES_DEG[1],
            90.0 + _PITCHES_DEG[1],
        )


def litchi_texts(plan: Plan) -> list[Iterator[str]]:
    """Text of each file, in blocks: parts of one flight, of `MOST_WAYPOINTS` or fewer, as long as each other."""
    count = len(plan)
    files = -(-count // MOST_WAYPOINTS)
    flown = waypoints(plan)
    speed = min(plan.mission.flight.airspeed_m_per_s, FASTEST_M_PER_S)
    sizes = [count * (number + 1) // files - count * number // files for number in range(files)]
    # At most 10,000 waypoints: all of them may be in memory.
    return [
        iter([",".join(COLUMNS) + "\n", *(_line(next(flown), speed) for _ in range(size))]) for size in sizes
    ]


def litchi_notes(plan: Plan) -> tuple[str, ...]:
    """What the file cannot say, one line each."""
    notes = [
        Message(
            "in Litchi set Heading Mode to Custom and Path Mode to Straight Lines, which the file cannot say"
        )
    ]
    if plan.mission.flight.airspeed_m_per_s > FASTEST_M_PER_S:
        notes.append(
            Message(
                "the speed of {0:g} m/s is cut to Litchi's {1:g} m/s",
                plan.mission.flight.airspeed_m_per_s,
                FASTEST_M_PER_S,
            )
        )
    return (*not_flown(plan), *notes)


def _line(one: Waypoint, speed_m_per_s: float) -> str:
    # Plain decimals: eight of a degree are a millimetre. Headings are rounded before they are taken modulo 360.
    heading = round(one.heading_deg, 2) % 360.0
    actions = (_TAKE_PHOTO, 0, *(_NONE, 0) * (ACTIONS - 1))
    cells = (
        *(f"{one.lat_deg:.8f}", f"{one.lon_deg:.8f}", f"{one.agl_m:.2f}", f"{heading:.2f}", "0", "0"),
        *(str(_INTERPOLATE), f"{one.gimbal_pitch_deg:.2f}"),
        *map(str, actions),
        *(str(_ABOVE_GROUND), f"{speed_m_per_s:.2f}", "0", "0", "0", "0"),
        *("-1", "-1"),
    )
    return ",".join(cells) + "\n"
