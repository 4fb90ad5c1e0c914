"""A plan for Litchi, which flies DJI drones: the CSV of its Mission Hub.

Columns, codes and ranges are those of the files that the Mission Hub writes (44 columns in metric units), described at
https://www.litchiutilities.com/docs/litchiCsv.php; limits of a mission are those of DJI's SDK.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...errors import InvalidInput, Message
from ..flight.legs import legs
from ..flight.path import LANDING, TAKEOFF
from ..parts import BY_DISTANCE, HOVER
from ..plan import Plan
from .sorties import sorties
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
#: Codes of the columns: the pitch is set; the height is above ground; the aircraft stays; an image is taken; no further
#: action.
_INTERPOLATE, _ABOVE_GROUND, _STAY, _TAKE_PHOTO, _NONE = 2, 1, 0, 1, -1


def check_litchi(plan: Plan) -> None:
    """Raise InvalidInput for a mission that Litchi or DJI's drones do not take."""
    meant, path = plan.meant, plan.path
    air = ~np.isin(path.kind, (TAKEOFF, LANDING))
    count = int(np.count_nonzero(air))
    if count < FEWEST_WAYPOINTS:
        raise InvalidInput("Litchi mission of one waypoint: takes two or more", remedy="plan a list or an area")
    if plan.mission.trigger != BY_DISTANCE and count > MOST_PARTS * MOST_WAYPOINTS:
        raise InvalidInput(
            "Litchi mission of {0:,} waypoints: takes {1:,} or fewer",
            count,
            MOST_PARTS * MOST_WAYPOINTS,
            remedy="plan a smaller area, a greater height or less overlap",
        )
    highest = float(meant.agl_m.max()) if path.is_captures else float(path.agl_m.max())
    if highest > HIGHEST_M:
        raise InvalidInput("Litchi mission at {0:g} m: must be {1:g} m above ground or less", highest, HIGHEST_M)
    pitch = float(np.abs(meant.tilt_deg).max()) - 90.0
    if pitch > _PITCHES_DEG[1]:
        raise InvalidInput(
            "Litchi mission with the gimbal lifted to {0:g} deg: must be {1:g} to {2:g}, a tilt of {3:g} or less",
            pitch,
            _PITCHES_DEG[0],
            _PITCHES_DEG[1],
            90.0 + _PITCHES_DEG[1],
        )


def litchi_texts(plan: Plan) -> list[Iterator[str]]:
    """Text of each file, in blocks: sorties, in parts of `MOST_WAYPOINTS` or fewer, as long as each other."""
    speed = min(plan.mission.flight.airspeed_m_per_s, FASTEST_M_PER_S)
    texts = []
    for sortie in range(plan.path.sorties):
        # At most 10,000 waypoints: all of them may be in memory.
        lines = [_line(one, speed, actions, spacing_m) for one, actions, spacing_m in _shots(plan, sortie)]
        count, files = len(lines), _files(len(lines))
        ends = [count * number // files for number in range(files + 1)]
        texts += [iter([",".join(COLUMNS) + "\n", *lines[first:end]]) for first, end in zip(ends, ends[1:])]
    return texts


def _files(waypoints: int) -> int:
    """Files that a sortie is cut into."""
    return -(-waypoints // MOST_WAYPOINTS)


def _shots(plan: Plan, sortie: int) -> Iterator[tuple[Waypoint, tuple[int, ...], float]]:
    """Waypoints of a sortie in the air, with the actions there, and the distance between images from there on.

    Where distance releases the camera, of a row there are its ends alone, and over relief where it bends.
    """
    # Milliseconds of hovering for an image.
    hover = (_STAY, 1000) if plan.mission.trigger == HOVER else ()
    flown = [one for one in waypoints(plan, sortie) if one.kind not in (TAKEOFF, LANDING)]
    if plan.mission.trigger != BY_DISTANCE:
        for one in flown:
            yield one, (*hover, _TAKE_PHOTO, 0) if one.is_capture else (), -1.0
        return
    own = sorties(plan)[sortie]
    way_m = legs(own.lat_deg, own.lon_deg).distance_m
    spacing_m = {}
    for first, last in own.runs(plan):
        spacing_m.update(dict.fromkeys(range(first, last), float(way_m[first:last].min(initial=np.inf))))
    for at in np.flatnonzero(own.waypoints(plan)).tolist():
        yield flown[at], (_TAKE_PHOTO, 0) if flown[at].is_capture else (), spacing_m.get(at, -1.0)


def litchi_notes(plan: Plan) -> tuple[str, ...]:
    """What the file cannot say, one line each."""
    notes = [Message("in Litchi set Heading Mode to Custom and Path Mode to Straight Lines, which the file cannot say")]
    if plan.mission.flight.airspeed_m_per_s > FASTEST_M_PER_S:
        notes.append(
            Message(
                "the speed of {0:g} m/s is reduced to Litchi's {1:g} m/s",
                plan.mission.flight.airspeed_m_per_s,
                FASTEST_M_PER_S,
            )
        )
    files = [_files(sum(1 for _ in _shots(plan, sortie))) for sortie in range(plan.path.sorties)]
    if sum(files) > len(files) > 1:
        first = (str(1 + sum(files[:number])) for number in range(len(files)))
        notes.append(Message("sorties begin at the parts {0}", ", ".join(first)))
    return (*not_flown(plan), *notes)


def _line(one: Waypoint, speed_m_per_s: float, actions: tuple[int, ...], spacing_m: float) -> str:
    # Plain decimals: eight of a degree are a millimetre. Headings are rounded before they are taken modulo 360.
    heading = round(one.heading_deg, 2) % 360.0
    actions = (*actions, *(_NONE, 0) * (ACTIONS - len(actions) // 2))
    cells = (
        *(f"{one.lat_deg:.8f}", f"{one.lon_deg:.8f}", f"{one.agl_m:.2f}", f"{heading:.2f}", "0", "0"),
        *(str(_INTERPOLATE), f"{one.gimbal_pitch_deg:.2f}"),
        *map(str, actions),
        *(str(_ABOVE_GROUND), f"{speed_m_per_s:.2f}", "0", "0", "0", "0"),
        *("-1", "-1" if spacing_m < 0.0 else f"{spacing_m:.2f}"),
    )
    return ",".join(cells) + "\n"
