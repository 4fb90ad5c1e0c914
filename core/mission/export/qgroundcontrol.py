"""A plan for QGroundControl: its JSON ``.plan``, flown by PX4 and ArduPilot.

Keys are documented at https://docs.qgroundcontrol.com (developer guide, plan file format); commands, frames and modes
are those of MAVLink's common messages.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from typing import Any, NamedTuple, Union

import numpy as np

from ...errors import InvalidInput, Message
from ...geodesy.projections import geodesics
from ..parts import BY_DISTANCE, HOVER
from ..plan import Plan
from .rows import BATCH
from .sorties import Sortie, sorties
from .waypoints import waypoint_notes

#: Limit of the items of a MAVLink mission, whose count has 16 bits.
MAX_ITEMS = 65_535
#: Limit of heights above the take-off in ArduPilot.
MAX_HEIGHT_M = 83_000.0
#: MAVLink commands.
NAV_WAYPOINT, NAV_RETURN_TO_LAUNCH, NAV_TAKEOFF = 16, 20, 22
DO_CHANGE_SPEED, DO_MOUNT_CONTROL, DO_SET_CAM_TRIGG_DIST, IMAGE_START_CAPTURE = 178, 205, 206, 2000
#: MAVLink frame of commands without a position.
FRAME_MISSION = 2
#: MAVLink frame of latitude, longitude and height above the take-off.
FRAME_RELATIVE = 3
#: Number of items before and after the items of captures.
_AROUND = 4
#: Greatest number of items of a capture.
_EACH = 2

Number = Union[float, int, None]


class Command(NamedTuple):
    """An item of a mission: MAVLink command, frame and seven parameters."""

    command: int
    frame: int
    params: Sequence[Number]


def check_qgroundcontrol(plan: Plan) -> None:
    """Raise InvalidInput for a mission with more items or at a greater height than autopilots accept."""
    by_distance = plan.mission.trigger == BY_DISTANCE
    for sortie in sorties(plan):
        points, triggers = len(sortie), int(np.count_nonzero(sortie.capture >= 0))
        if by_distance:
            points, triggers = int(np.count_nonzero(sortie.waypoints(plan))), _EACH * len(sortie.runs(plan))
        turned = sum(int(np.count_nonzero(np.diff(one))) for one in (sortie.gimbal_pitch_deg, sortie.speed_m_per_s))
        # Over relief the way back takes up to two items.
        back = 0 if plan.relief.is_level else 2
        if points + triggers + turned + back + _AROUND > MAX_ITEMS:
            raise InvalidInput(
                "QGroundControl plan of {0:,} waypoints: takes {1:,} or fewer",
                len(sortie),
                (MAX_ITEMS - _AROUND) // _EACH,
                remedy="plan a smaller area, a greater height or less overlap",
            )
        highest = float(sortie.height_m.max())
        if highest >= MAX_HEIGHT_M:
            raise InvalidInput(
                "QGroundControl plan at {0:g} m: must be below {1:g} m above the take-off",
                highest,
                MAX_HEIGHT_M,
            )


def qgroundcontrol_texts(plan: Plan) -> list[Iterator[str]]:
    """Text of the plan of each sortie, in blocks."""
    return [plan_text(plan_object(sortie), simple_items(_commands(plan, sortie), first=1)) for sortie in sorties(plan)]


def plan_text(whole: dict[str, Any], items: Iterable[dict[str, Any]]) -> Iterator[str]:
    """Text of a plan with its items, in blocks."""
    # Items are inserted one a line and are never all in memory.
    before, after = json.dumps(whole, indent=1).split('"items": []')
    yield before + '"items": [\n'
    first, rest = True, iter(items)
    while True:
        block = list(islice(rest, BATCH))
        if not block:
            break
        yield ("" if first else ",\n") + ",\n".join(json.dumps(item) for item in block)
        first = False
    yield "\n]" + after + "\n"


def qgroundcontrol_notes(plan: Plan) -> tuple[str, ...]:
    """Notes on what the plan cannot express, one line each."""
    heights = Message(
        "heights are above the take-off point: they are heights above ground only where the ground is level with it"
    )
    if not plan.relief.is_level:
        heights = Message(
            "heights are above the take-off point, computed for ground at {0:.1f} m above the ellipsoid there",
            plan.path.base_m,
        )
    return *waypoint_notes(plan), heights


def plan_object(sortie: Sortie, mixed_heights: bool = False) -> dict[str, Any]:
    """JSON object of a plan, without its items."""
    speed = float(sortie.speed_m_per_s[0])
    return {
        "fileType": "Plan",
        "geoFence": {"circles": [], "polygons": [], "version": 2},
        "groundStation": "QGroundControl",
        "mission": {
            "cruiseSpeed": speed,
            # PX4.
            "firmwareType": 12,
            # Heights above the take-off, or mixed.
            "globalPlanAltitudeMode": 0 if mixed_heights else 1,
            "hoverSpeed": speed,
            "items": [],
            "plannedHomePosition": [*sortie.home, sortie.base_m],
            # Quadrotor.
            "vehicleType": 2,
            "version": 2,
        },
        "rallyPoints": {"points": [], "version": 2},
        "version": 1,
    }


def simple_items(commands: Iterable[Command], first: int) -> Iterator[dict[str, Any]]:
    """JSON items of commands, numbered from ``first``.

    Items leave out ``AltitudeMode``, ``Altitude`` and ``AMSLAltAboveTerrain``: QGroundControl requires all or none of
    these keys, and some versions refuse an unknown height above sea level. Without the keys, QGroundControl uses frame
    and parameters.
    """
    for number, (command, frame, params) in enumerate(commands, start=first):
        yield {
            "autoContinue": True,
            "command": command,
            "doJumpId": number,
            "frame": frame,
            "params": list(params),
            "type": "SimpleItem",
        }


def _commands(plan: Plan, sortie: Sortie) -> Iterator[Command]:
    yield from departure(sortie)
    yield from flight(plan, sortie)
    yield from return_home(plan, sortie)


def departure(sortie: Sortie) -> Iterator[Command]:
    """Take-off, speed and gimbal."""
    height = float(sortie.height_m[0])
    yield Command(NAV_TAKEOFF, FRAME_RELATIVE, (0, 0, 0, None, *sortie.home, height))
    yield _speed(float(sortie.speed_m_per_s[0]))
    yield _gimbal(float(sortie.gimbal_pitch_deg[0]))


def return_home(plan: Plan, sortie: Sortie) -> Iterator[Command]:
    """Return to the take-off; over relief after a climb to a safe height."""
    height = sortie.way_home_m(plan, -1)
    if sortie.takeoff is None and height > sortie.height_m[-1]:
        heading, last = float(sortie.heading_deg[-1]), (float(sortie.lat_deg[-1]), float(sortie.lon_deg[-1]))
        for place in (last, sortie.home):
            yield Command(NAV_WAYPOINT, FRAME_RELATIVE, (0, 0, 0, heading, *place, height))
    yield Command(NAV_RETURN_TO_LAUNCH, FRAME_MISSION, (0, 0, 0, 0, 0, 0, 0))


def flight(plan: Plan, sortie: Sortie) -> Iterator[Command]:
    """Waypoints and triggers of the camera.

    If the camera is triggered by distance, a row has waypoints only at its ends and, over relief, at its bends. The
    gimbal turns on the leg to a waypoint with another pitch, which is flown at the speed of the waypoint.
    """
    trigger = plan.mission.trigger
    by_distance = trigger == BY_DISTANCE
    ends = dict(sortie.runs(plan)) if by_distance else {}
    is_waypoint = sortie.waypoints(plan) if by_distance else np.ones(len(sortie), bool)
    # Hovering for an image takes 1 s.
    hold = 1.0 if trigger == HOVER else 0
    last, previous_pitch, previous_speed = -1, float(sortie.gimbal_pitch_deg[0]), float(sortie.speed_m_per_s[0])
    points = zip(
        sortie.lat_deg.tolist(),
        sortie.lon_deg.tolist(),
        sortie.height_m.tolist(),
        sortie.heading_deg.tolist(),
        sortie.gimbal_pitch_deg.tolist(),
        sortie.capture.tolist(),
        sortie.speed_m_per_s.tolist(),
    )
    for at, (lat, lon, height, heading, pitch, capture, speed) in enumerate(points):
        if not is_waypoint[at]:
            continue
        if speed != previous_speed:
            yield _speed(speed)
            previous_speed = speed
        if pitch != previous_pitch:
            yield _gimbal(pitch)
            previous_pitch = pitch
        yield Command(NAV_WAYPOINT, FRAME_RELATIVE, (hold if capture >= 0 else 0, 0, 0, heading, lat, lon, height))
        if at == last:
            yield _trigger_distance(0)
        elif at < last:
            continue
        elif ends.get(at, at) > at:
            last = ends[at]
            yield _trigger_distance(spacing_m(sortie, at, last))
        elif capture >= 0:
            # One image, at once. ArduPilot refuses NaN, even in parameters that it does not use.
            yield Command(IMAGE_START_CAPTURE, FRAME_MISSION, (0, 0, 1, 0, 0, 0, 0))


def spacing_m(sortie: Sortie, first: int, last: int) -> float:
    """Distance between the images of a row from point ``first`` to point ``last`` of a sortie."""
    lat, lon = sortie.lat_deg, sortie.lon_deg
    return float(geodesics(lat[first], lon[first], lat[last], lon[last])[2]) / (last - first)


def _trigger_distance(spacing: float) -> Command:
    """Trigger the camera now and every ``spacing`` metres; 0 takes a last image and stops, as in QGroundControl."""
    return Command(DO_SET_CAM_TRIGG_DIST, FRAME_MISSION, (spacing, 0, 1, 0, 0, 0, 0))


def _speed(speed_m_per_s: float) -> Command:
    # Type 1 is ground speed.
    return Command(DO_CHANGE_SPEED, FRAME_MISSION, (1, speed_m_per_s, -1, 0, 0, 0, 0))


def _gimbal(pitch_deg: float) -> Command:
    # Mode 2: the mount follows MAVLink.
    return Command(DO_MOUNT_CONTROL, FRAME_MISSION, (pitch_deg, 0, 0, 0, 0, 0, 2))
