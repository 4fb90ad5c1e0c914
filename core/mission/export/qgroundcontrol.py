"""A plan for QGroundControl: its ``.plan`` of JSON, flown by PX4 and ArduPilot.

Keys are those of https://docs.qgroundcontrol.com (developer guide, plan file format); commands, frames and modes those
of MAVLink's common messages.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from itertools import chain, islice
from typing import Any, Union

from ...errors import InvalidInput, Message
from ..plan import Plan
from .rows import BATCH
from .waypoints import not_flown, waypoints

#: Items that a MAVLink mission can count (16 bits).
MOST_ITEMS = 65_535
NAV_WAYPOINT, NAV_RETURN_TO_LAUNCH, NAV_TAKEOFF = 16, 20, 22
DO_CHANGE_SPEED, DO_MOUNT_CONTROL, IMAGE_START_CAPTURE = 178, 205, 2000
#: Frames of an item: none; latitude, longitude and height over the place of take-off.
FRAME_MISSION, FRAME_RELATIVE = 2, 3
#: The gimbal holds what the mission says; the speed is that over ground.
_MOUNT_BY_MAVLINK, _GROUND_SPEED = 2, 1
_PX4, _QUADROTOR = 12, 2
#: QGroundControl's name for heights over the place of take-off.
_ALTITUDE_RELATIVE = 1
#: Items before and after those of the captures, and of each capture.
_AROUND, _EACH = 4, 2

Number = Union[float, int, None]


def check_qgroundcontrol(plan: Plan) -> None:
    """Raise InvalidInput for a mission of more items than MAVLink counts."""
    most = (MOST_ITEMS - _AROUND) // _EACH
    if len(plan) > most:
        raise InvalidInput(
            "QGroundControl plan of {0:,} waypoints: takes {1:,} or fewer",
            len(plan),
            most,
            remedy="plan a smaller area, a greater height or less overlap",
        )


def qgroundcontrol_text(plan: Plan) -> Iterator[str]:
    """Text of the plan, in blocks."""
    whole = json.dumps(_whole(plan), indent=1)
    # The items come in between, one a line, and are never all in memory.
    before, after = whole.split('"items": []')
    yield before + '"items": [\n'
    flown = _items(plan)
    first = True
    while True:
        block = list(islice(flown, BATCH))
        if not block:
            break
        yield ("" if first else ",\n") + ",\n".join(json.dumps(item) for item in block)
        first = False
    yield "\n]" + after + "\n"


def qgroundcontrol_notes(plan: Plan) -> tuple[str, ...]:
    """What the plan cannot say, one line each."""
    return (
        *not_flown(plan),
        Message(
            "heights are over the place of take-off: as high above the ground only where the ground is level with it"
        ),
    )


def _whole(plan: Plan) -> dict[str, Any]:
    first = next(waypoints(plan))
    speed = plan.mission.flight.airspeed_m_per_s
    return {
        "fileType": "Plan",
        "geoFence": {"circles": [], "polygons": [], "version": 2},
        "groundStation": "QGroundControl",
        "mission": {
            "cruiseSpeed": speed,
            "firmwareType": _PX4,
            "globalPlanAltitudeMode": _ALTITUDE_RELATIVE,
            "hoverSpeed": speed,
            "items": [],
            "plannedHomePosition": [first.lat_deg, first.lon_deg, float(plan.ground_m[0])],
            "vehicleType": _QUADROTOR,
            "version": 2,
        },
        "rallyPoints": {"points": [], "version": 2},
        "version": 1,
    }


def _items(plan: Plan) -> Iterator[dict[str, Any]]:
    for number, (command, frame, params) in enumerate(_commands(plan), start=1):
        item: dict[str, Any] = {
            "autoContinue": True,
            "command": command,
            "doJumpId": number,
            "frame": frame,
            "params": list(params),
            "type": "SimpleItem",
        }
        if frame == FRAME_RELATIVE:
            item.update(AMSLAltAboveTerrain=None, Altitude=params[6], AltitudeMode=_ALTITUDE_RELATIVE)
        yield item


def _commands(plan: Plan) -> Iterator[tuple[int, int, Sequence[Number]]]:
    """Command, frame and the seven parameters of each item."""
    flown = waypoints(plan)
    first = next(flown)
    yield NAV_TAKEOFF, FRAME_RELATIVE, (0, 0, 0, None, first.lat_deg, first.lon_deg, first.above_first_m)
    speed = plan.mission.flight.airspeed_m_per_s
    yield DO_CHANGE_SPEED, FRAME_MISSION, (_GROUND_SPEED, speed, -1, 0, 0, 0, 0)
    yield DO_MOUNT_CONTROL, FRAME_MISSION, (first.gimbal_pitch_deg, 0, 0, 0, 0, 0, _MOUNT_BY_MAVLINK)
    for one in chain([first], flown):
        place = (one.lat_deg, one.lon_deg, one.above_first_m)
        yield NAV_WAYPOINT, FRAME_RELATIVE, (0, 0, 0, one.heading_deg, *place)
        # One picture, at once; the last four are for the camera to choose.
        yield IMAGE_START_CAPTURE, FRAME_MISSION, (0, 0, 1, None, None, None, None)
    yield NAV_RETURN_TO_LAUNCH, FRAME_MISSION, (0, 0, 0, 0, 0, 0, 0)
