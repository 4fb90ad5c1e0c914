"""Upload of a flight to a vehicle, by MAVLink's mission protocol (https://mavlink.io/en/services/mission.html).

The mission is that of QGroundControl's ``.plan``, checked as the file is.
"""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable
from typing import Any

from ...errors import InvalidInput, Message, OptionName, OutputError
from ...external.importing import imported
from ...text.safe_json import parse_json

#: Addresses of vehicles: a server of the vehicle's, or a port at which vehicles call, or are called, by datagrams.
ADDRESS = re.compile(r"(tcp|udp|udpin|udpout):[\w.\-]{1,253}:[0-9]{1,5}")
#: Seconds until a message is sent again, and how often, as the protocol recommends.
RETRY_S, RETRIES = 1.5, 5
#: Seconds to wait for the first heartbeat; vehicles send one a second.
HEARTBEAT_S = 10.0
#: MAVLink's number of ArduPilot, whose first item is the home position.
_ARDUPILOT = 3
#: MAVLink's frames: latitude, longitude and height above sea level; and above the take-off.
_GLOBAL, _RELATIVE = 0, 3
_NAV_WAYPOINT = 16


def upload(text: str, address: str, *, heartbeat_s: float = HEARTBEAT_S, retry_s: float = RETRY_S) -> int:
    """Send the items of a ``.plan`` to a vehicle, and return their number.

    Parameters
    ----------
    text : str
        Of the file, with simple items.
    address : str
        ``tcp:HOST:PORT``, ``udp:HOST:PORT`` (waits there for the vehicle) or ``udpout:HOST:PORT``.

    Raises
    ------
    InvalidInput
        Another address.
    OutputError
        pymavlink is missing, or the vehicle is not there, does not answer, or refuses the mission.
    """
    if not ADDRESS.fullmatch(address):
        raise InvalidInput("vehicle {0!r}: must be tcp:HOST:PORT, udp:HOST:PORT or udpout:HOST:PORT", address)
    try:
        mavutil = imported("pymavlink.mavutil")
    except ImportError as missing:
        raise OutputError("upload to a vehicle: the Python package {0} is missing", "pymavlink") from missing
    try:
        link = mavutil.mavlink_connection(address, source_system=255, retries=1)
    except (OSError, ValueError) as wrong:
        raise OutputError("vehicle {0}: cannot be reached ({1})", address, wrong) from wrong
    try:
        return _send(link, mavutil.mavlink, parse_json(text)["mission"], address, heartbeat_s, retry_s)
    except OSError as wrong:
        raise OutputError("vehicle {0}: the connection broke ({1})", address, wrong) from wrong
    finally:
        link.close()


def _send(link: Any, mavlink: Any, mission: dict[str, Any], address: str, heartbeat_s: float, retry_s: float) -> int:
    heartbeat = _heard(link, mavlink, heartbeat_s)
    if heartbeat is None:
        raise OutputError("vehicle {0}: sent no heartbeat within {1:g} s", address, heartbeat_s)
    target = heartbeat.get_srcSystem(), heartbeat.get_srcComponent()
    items = _items(mission, is_ardupilot=heartbeat.autopilot == _ARDUPILOT)

    def announce() -> None:
        link.mav.mission_count_send(*target, len(items))

    def send(number: int) -> None:
        link.mav.mission_item_int_send(*target, number, *items[number])

    again: Callable[[], None] = announce
    again()
    tries = 0
    while tries < RETRIES:
        kinds = ["MISSION_REQUEST_INT", "MISSION_REQUEST", "MISSION_ACK"]
        answer = link.recv_match(type=kinds, blocking=True, timeout=retry_s)
        if answer is None:
            tries += 1
            again()
        elif answer.get_srcSystem() != target[0]:
            continue
        elif answer.get_type() == "MISSION_ACK":
            if answer.type != mavlink.MAV_MISSION_ACCEPTED:
                known = mavlink.enums["MAV_MISSION_RESULT"].get(answer.type)
                name = known.name if known else str(answer.type)
                raise OutputError("vehicle {0}: refused the mission ({1})", address, name)
            return len(items)
        elif 0 <= answer.seq < len(items):
            tries = 0
            # The vehicle asks again for an item that it lacks.
            send(answer.seq)
            again = _nothing
    raise OutputError("vehicle {0}: did not answer {1} times", address, RETRIES)


def _nothing() -> None:
    """Wait for the vehicle, which repeats its request."""


def _heard(link: Any, mavlink: Any, seconds: float) -> Any:
    """First heartbeat of a vehicle, to which ours are sent, as it may wait for them; None without one."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        link.mav.heartbeat_send(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0)
        found = link.recv_match(type="HEARTBEAT", blocking=True, timeout=min(1.0, seconds))
        if found is not None and found.autopilot != mavlink.MAV_AUTOPILOT_INVALID:
            return found
    return None


def _items(mission: dict[str, Any], *, is_ardupilot: bool) -> list[tuple[Any, ...]]:
    """Frame, command, current, continue, four parameters, scaled position and height of each item."""
    home = mission["plannedHomePosition"]
    found = [(one["frame"], one["command"], one["params"]) for one in mission["items"]]
    if is_ardupilot:
        found = [(_GLOBAL, _NAV_WAYPOINT, (0, 0, 0, 0, *home)), *found]
    # ArduPilot refuses NaN, which leaves a value to PX4.
    unset = 0.0 if is_ardupilot else math.nan
    items = []
    for number, (frame, command, params) in enumerate(found):
        numbers = [unset if one is None else float(one) for one in params]
        scale = 1e7 if frame in (_GLOBAL, _RELATIVE) else 1.0
        place = (round(one * scale) for one in numbers[4:6])
        items.append((frame, command, int(number == 0), 1, *numbers[:4], *place, numbers[6]))
    return items


def vehicle_text(texts: list[str], sortie: int | None) -> str:
    """Text of the sortie to upload, numbered from 1; raises InvalidInput unless it is one."""
    if sortie is None and len(texts) == 1:
        return texts[0]
    if sortie is None or not 1 <= sortie <= len(texts):
        raise InvalidInput(
            "flight of {0} sorties: a vehicle takes one",
            len(texts),
            remedy=Message("choose one from 1 to {0}{1}", len(texts), OptionName("sortie").in_brackets),
        )
    return texts[sortie - 1]
