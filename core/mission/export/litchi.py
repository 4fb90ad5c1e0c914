"""A plan for Litchi, which flies DJI drones: the CSV of its Mission Hub.

Columns, codes and ranges are those of files written by the Mission Hub (44 columns in metric units), as described at
https://www.litchiutilities.com/docs/litchiCsv.php; limits of a mission come from DJI's SDK.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...errors import InvalidInput, Message
from ..flight.legs import legs
from ..flight.path import LANDING, TAKEOFF
from ..parts import BY_DISTANCE, HOVER
from ..plan import Plan
from .sorties import Sortie, sorties
from .waypoints import Waypoint, waypoint_notes, waypoints

#: Greatest number of actions of a waypoint.
ACTIONS = 15
#: Columns of the file.
COLUMNS = (
    *("latitude", "longitude", "altitude(m)", "heading(deg)", "curvesize(m)", "rotationdir"),
    *("gimbalmode", "gimbalpitchangle"),
    *(f"action{field}{number}" for number in range(1, ACTIONS + 1) for field in ("type", "param")),
    *("altitudemode", "speed(m/s)", "poi_latitude", "poi_longitude", "poi_altitude(m)", "poi_altitudemode"),
    *("photo_timeinterval", "photo_distinterval"),
)
#: Limit of DJI's SDK on the waypoints of one mission.
MAX_WAYPOINTS = 99
#: Limit of DJI's SDK on heights.
MAX_HEIGHT_M = 500.0
#: Limit of DJI's SDK on the speed.
MAX_SPEED_M_PER_S = 15.0
#: Limit on the files of one flight: Litchi holds about 10,000 waypoints.
MAX_PARTS = 101
#: Codes of actions.
_STAY, _TAKE_PHOTO, _NONE = 0, 1, -1


def check_litchi(plan: Plan) -> None:
    """Raise InvalidInput for a mission that Litchi or DJI's drones do not accept."""
    meant, path = plan.meant, plan.path
    air = ~np.isin(path.kind, (TAKEOFF, LANDING))
    count = int(np.count_nonzero(air))
    if count < 2:
        raise InvalidInput("Litchi mission of one waypoint: takes two or more", remedy="plan a list or an area")
    if plan.mission.trigger != BY_DISTANCE and count > MAX_PARTS * MAX_WAYPOINTS:
        raise InvalidInput(
            "Litchi mission of {0:,} waypoints: takes {1:,} or fewer",
            count,
            MAX_PARTS * MAX_WAYPOINTS,
            remedy="plan a smaller area, a greater height or less overlap",
        )
    highest = float(meant.agl_m.max()) if path.is_captures else float(path.agl_m.max())
    if highest > MAX_HEIGHT_M:
        raise InvalidInput("Litchi mission at {0:g} m: must be {1:g} m above ground or less", highest, MAX_HEIGHT_M)
    pitch = float(np.abs(meant.tilt_deg).max()) - 90.0
    low_deg, high_deg = -90.0, 30.0
    if pitch > high_deg:
        raise InvalidInput(
            "Litchi mission with the gimbal lifted to {0:g} deg: must be {1:g} to {2:g}, a tilt of {3:g} or less",
            pitch,
            low_deg,
            high_deg,
            90.0 + high_deg,
        )


def litchi_texts(plan: Plan) -> list[Iterator[str]]:
    """Text of each file, in blocks: sorties, divided into equal parts of at most `MAX_WAYPOINTS`."""
    texts = []
    for number, sortie in enumerate(sorties(plan)):
        # At most 10,000 waypoints, which fit into memory.
        shots = list(_shots(plan, number, sortie))
        lines = [_line(one, actions, spacing_m, speed) for one, actions, spacing_m, speed in shots]
        files, shared = _files(plan, len(lines)), _shared(plan)
        ends = [(len(lines) - shared) * number // files for number in range(files + 1)]
        for first, end in zip(ends, ends[1:]):
            part = lines[first : end + shared]
            if shared and first:
                # The file before has taken the image here.
                part[0] = _line(shots[first][0], (), *shots[first][2:])
            texts.append(iter([",".join(COLUMNS) + "\n", *part]))
    return texts


def _files(plan: Plan, waypoints: int) -> int:
    """Number of files of a sortie."""
    shared = _shared(plan)
    return max(-(-(waypoints - shared) // (MAX_WAYPOINTS - shared)), 1)


def _shared(plan: Plan) -> int:
    """Number of waypoints that a file repeats of the one before it.

    If the camera is triggered by distance, images are taken on the leg between two waypoints, so it must be flown.
    """
    return int(plan.mission.trigger == BY_DISTANCE)


def _shots(plan: Plan, number: int, sortie: Sortie) -> Iterator[tuple[Waypoint, tuple[int, ...], float, float]]:
    """Waypoints of a sortie in the air, with the actions at each, the distance between images after it, and the speed.

    If the camera is triggered by distance, a row has waypoints only at its ends and, over relief, at its bends.
    """
    # Hovering for an image takes 1000 ms.
    hover = (_STAY, 1000) if plan.mission.trigger == HOVER else ()
    flown = [one for one in waypoints(plan, number) if one.kind not in (TAKEOFF, LANDING)]
    speeds = np.minimum(sortie.speed_m_per_s, MAX_SPEED_M_PER_S).tolist()
    if plan.mission.trigger != BY_DISTANCE:
        for one, speed in zip(flown, speeds):
            yield one, (*hover, _TAKE_PHOTO, 0) if one.is_capture else (), -1.0, speed
        return
    way_m = legs(sortie.lat_deg, sortie.lon_deg).distance_m
    spacing_m = {}
    for first, last in sortie.runs(plan):
        spacing_m.update(dict.fromkeys(range(first, last), float(way_m[first:last].min(initial=np.inf))))
    for at in np.flatnonzero(sortie.waypoints(plan)).tolist():
        yield flown[at], (_TAKE_PHOTO, 0) if flown[at].is_capture else (), spacing_m.get(at, -1.0), speeds[at]


def litchi_notes(plan: Plan) -> tuple[str, ...]:
    """Notes on what the file cannot express, one line each."""
    notes = [Message("in Litchi set Heading Mode to Custom and Path Mode to Straight Lines, which the file cannot say")]
    fastest = float(plan.airspeeds_m_per_s.max())
    if fastest > MAX_SPEED_M_PER_S:
        notes.append(
            Message(
                "the speed of {0:g} m/s is reduced to Litchi's {1:g} m/s",
                fastest,
                MAX_SPEED_M_PER_S,
            )
        )
    files = [_files(plan, sum(1 for _ in _shots(plan, *one))) for one in enumerate(sorties(plan))]
    if sum(files) > len(files) > 1:
        first = (str(1 + sum(files[:number])) for number in range(len(files)))
        notes.append(Message("sorties begin at the parts {0}", ", ".join(first)))
    return (*waypoint_notes(plan), *notes)


def _line(one: Waypoint, actions: tuple[int, ...], spacing_m: float, speed_m_per_s: float) -> str:
    # Eight decimals of a degree are a millimetre. Rounding before the modulo keeps headings below 360.
    heading = round(one.heading_deg, 2) % 360.0
    actions = (*actions, *(_NONE, 0) * (ACTIONS - len(actions) // 2))
    cells = (
        *(f"{one.lat_deg:.8f}", f"{one.lon_deg:.8f}", f"{one.agl_m:.2f}", f"{heading:.2f}", "0", "0"),
        # The gimbal turns to its pitch on the leg to the waypoint.
        *("2", f"{one.gimbal_pitch_deg:.2f}"),
        *map(str, actions),
        # Heights are above ground.
        *("1", f"{speed_m_per_s:.2f}", "0", "0", "0", "0"),
        *("-1", "-1" if spacing_m < 0.0 else f"{spacing_m:.2f}"),
    )
    return ",".join(cells) + "\n"
