"""A plan for DJI's drones: the KMZ of WPML in which DJI Pilot 2, FlightHub 2 and DJI Fly store waypoint flights.

Elements, values and ranges are those of DJI's reference (https://developer.dji.com/doc/cloud-api-tutorial/en, DJI
WPML). DJI does not document the files of DJI Fly; here, they follow public programs that write such files. Programs
show and edit ``template.kml``, and drones fly ``waylines.wpml``; here both describe the same flight.
"""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ...arrays import NDArray
from ...errors import InvalidInput, Message
from ...fields import field_named
from ...geodesy.projections import LocalPlane, geodesics
from ..parts import BY_DISTANCE, DJI_FLY, HOVER, Route, utc_time
from ..plan import Plan
from .sorties import Sortie, continuous, sorties
from .waypoints import waypoint_notes

#: Limit on the files of one plan, for flights with more waypoints than a drone accepts.
MAX_FILES = 100
#: Speeds that all drones accept.
MIN_SPEED_M_PER_S, MAX_SPEED_M_PER_S = 1.0, 15.0
#: Legs below this length leave no room for rounded corners, so the aircraft stops at both ends.
_SHORT_LEG_M = 1.0
#: Turn modes.
_STOP, _PASS = "toPointAndStopWithDiscontinuityCurvature", "toPointAndPassWithContinuityCurvature"


class _Drone(NamedTuple):
    """Codes of a drone and its camera; ``camera`` is None for DJI Fly, which needs no code of a camera.

    Parameters
    ----------
    lens : str
        Lens whose images are kept, in DJI's spelling.
    """

    kind: int
    variant: int
    camera: int | None
    lens: str = "visable"
    namespace: str = "http://www.dji.com/wpmz/1.0.6"
    max_waypoints: int = 65_535
    max_height_m: float = 1500.0

    @property
    def is_dji_fly(self) -> bool:
        return self.camera is None


_DRONES = {
    "mavic-3e": _Drone(77, 0, 66),
    "mavic-3t": _Drone(77, 1, 67),
    "mavic-3m": _Drone(77, 2, 68),
    "m30": _Drone(67, 0, 52, "wide"),
    "m30t": _Drone(67, 1, 53, "wide"),
    "m300": _Drone(60, 0, 50),
    "m350": _Drone(89, 0, 50),
    "m4e": _Drone(99, 0, 88),
    "m4t": _Drone(99, 1, 89),
    DJI_FLY: _Drone(68, 0, None, "", "http://www.dji.com/wpmz/1.0.2", 200, 500.0),
}


def check_wpml(plan: Plan) -> None:
    """Raise InvalidInput for a mission that DJI's programs or drones do not accept."""
    drone = _drone(plan)
    stops = [len(one) for one in _stops(plan)]
    if min(stops) < 2:
        raise InvalidInput("DJI mission of one waypoint: takes two or more", remedy="plan a list or an area")
    files = sum(-(-count // drone.max_waypoints) for count in stops)
    if files > MAX_FILES:
        raise InvalidInput(
            "DJI mission of {0:,} waypoints: takes {1:,} or fewer, in {2} files",
            sum(stops),
            MAX_FILES * drone.max_waypoints,
            MAX_FILES,
            remedy="plan a smaller area, a greater height or less overlap",
        )
    found = _parts(plan)
    highest = max(max(float(one.height_m.max()), one.way_home_m(plan, 0), one.way_home_m(plan, -1)) for one in found)
    if highest > drone.max_height_m:
        raise InvalidInput(
            "DJI mission at {0:g} m: must be {1:g} m above the take-off or less", highest, drone.max_height_m
        )
    pitch = max(float(one.gimbal_pitch_deg.max()) for one in found)
    low_deg, high_deg = -90.0, 30.0
    if pitch > high_deg:
        raise InvalidInput(
            "DJI mission with the gimbal lifted to {0:g} deg: must be {1:g} to {2:g}, a tilt of {3:g} or less",
            pitch,
            low_deg,
            high_deg,
            90.0 + high_deg,
        )
    speed = float(plan.airspeeds_m_per_s.min())
    if speed < MIN_SPEED_M_PER_S:
        raise InvalidInput(
            "DJI mission at {0:g} m/s: must be {1:g} to {2:g} m/s",
            speed,
            MIN_SPEED_M_PER_S,
            MAX_SPEED_M_PER_S,
            field="airspeed_m_per_s",
        )


def wpml_files(plan: Plan) -> list[bytes]:
    """Contents of each file: sorties in order, divided into parts that the drone accepts."""
    return [_kmz(plan, part) for part in _parts(plan)]


def _parts(plan: Plan) -> list[Sortie]:
    """Flights of the files in order: sorties, or parts of sorties with too many waypoints."""
    most, found = _drone(plan).max_waypoints, []
    for sortie in _stops(plan):
        count = -(-len(sortie) // most)
        edges = [len(sortie) * number // count for number in range(count + 1)]
        found += [sortie.part(slice(*ends)) for ends in zip(edges, edges[1:])]
    return found


def wpml_notes(plan: Plan) -> tuple[str, ...]:
    """Notes on what the files cannot express and what the pilot has to know, one line each."""
    drone = _drone(plan)
    titles = field_named(Route, "drone").choices
    notes = [
        Message("the file is for the drone {0}", Message(titles[plan.mission.route.drone])),
        Message("not flown yet: files for DJI's programs were checked by their structure and by reading them back"),
        _height_note(_parts(plan)),
    ]
    fastest = float(plan.airspeeds_m_per_s.max())
    if fastest > MAX_SPEED_M_PER_S:
        notes.append(
            Message(
                "the speed of {0:g} m/s is reduced to DJI's {1:g} m/s",
                fastest,
                MAX_SPEED_M_PER_S,
            )
        )
    if drone.is_dji_fly:
        notes.append(Message("DJI Fly opens no files: put this one in the place of a mission that you made there"))
        if plan.mission.trigger == BY_DISTANCE:
            notes.append(Message("DJI Fly releases no camera by distance: each image has a waypoint of its own"))
        if plan.mission.trigger != HOVER:
            notes.append(
                Message(
                    "the drone stops at each waypoint; times and sorties count these stops with the trigger hover alone"
                )
            )
    return (*waypoint_notes(plan), *notes)


def _drone(plan: Plan) -> _Drone:
    return _DRONES[plan.mission.route.drone]


def _is_distance_triggered(plan: Plan) -> bool:
    return plan.mission.trigger == BY_DISTANCE and not _drone(plan).is_dji_fly


def _height_note(parts: list[Sortie]) -> Message:
    """Note on the reference of the heights."""
    bases_m = [part.base_m for part in parts]
    # Heights are stated to 0.1 m, so within 5 cm one figure is enough.
    if max(bases_m) - min(bases_m) < 0.05:
        return Message(
            "heights are above the take-off point, computed for ground at {0:.1f} m above the ellipsoid there",
            bases_m[0],
        )
    return Message(
        "heights are above the take-off point, which is taken to be below the first waypoint of each file: ground at "
        "{0:.1f} to {1:.1f} m above the ellipsoid",
        min(bases_m),
        max(bases_m),
    )


def _stops(plan: Plan) -> list[Sortie]:
    """Sorties with only those points that become waypoints."""
    found = sorties(plan)
    if not _is_distance_triggered(plan):
        return found
    return [sortie.take(sortie.waypoints(plan)) for sortie in found]


def _kmz(plan: Plan, sortie: Sortie) -> bytes:
    """Zip of the two files, with constant times so that bytes are reproducible."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in (
            ("wpmz/template.kml", _template(plan, sortie)),
            ("wpmz/waylines.wpml", _waylines(plan, sortie)),
        ):
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.compress_type, entry.create_system, entry.external_attr = (
                zipfile.ZIP_DEFLATED,
                3,
                0o644 << 16,
            )
            with archive.open(entry, "w") as file:
                file.writelines(block.encode() for block in text)
    return packed.getvalue()


def _template(plan: Plan, sortie: Sortie) -> Iterator[str]:
    drone = _drone(plan)
    made_ms = round(utc_time(plan.direct.start).timestamp() * 1000.0)
    yield (
        _head(drone)
        + (
            f"<wpml:author>TerrAInav</wpml:author>\n<wpml:createTime>{made_ms}</wpml:createTime>\n"
            f"<wpml:updateTime>{made_ms}</wpml:updateTime>\n"
        )
        + _config(plan, sortie, reference=True)
    )
    if not drone.is_dji_fly:
        yield (
            "<Folder>\n<wpml:templateType>waypoint</wpml:templateType>\n<wpml:templateId>0</wpml:templateId>\n"
            "<wpml:waylineCoordinateSysParam><wpml:coordinateMode>WGS84</wpml:coordinateMode>"
            "<wpml:heightMode>relativeToStartPoint</wpml:heightMode></wpml:waylineCoordinateSysParam>\n"
            f"<wpml:autoFlightSpeed>{_speed(sortie)}</wpml:autoFlightSpeed>\n"
            f"<wpml:globalHeight>{sortie.height_m[0]:.3f}</wpml:globalHeight>\n"
            "<wpml:caliFlightEnable>0</wpml:caliFlightEnable>\n"
            "<wpml:gimbalPitchMode>usePointSetting</wpml:gimbalPitchMode>\n"
            f"<wpml:globalWaypointHeadingParam>{_heading(float(sortie.heading_deg[0]), executed=False)}"
            "</wpml:globalWaypointHeadingParam>\n"
            f"<wpml:globalWaypointTurnMode>{_STOP}</wpml:globalWaypointTurnMode>\n"
            "<wpml:globalUseStraightLine>1</wpml:globalUseStraightLine>\n"
        )
        yield from _placemarks(plan, sortie, executed=False)
        yield (
            "<wpml:payloadParam><wpml:payloadPositionIndex>0</wpml:payloadPositionIndex>"
            f"<wpml:imageFormat>{drone.lens}</wpml:imageFormat></wpml:payloadParam>\n</Folder>\n"
        )
    yield "</Document>\n</kml>\n"


def _waylines(plan: Plan, sortie: Sortie) -> Iterator[str]:
    lat, lon = sortie.lat_deg, sortie.lon_deg
    length_m = float(geodesics(lat[:-1], lon[:-1], lat[1:], lon[1:])[2].sum())
    yield (
        _head(_drone(plan))
        + _config(plan, sortie, reference=False)
        + (
            "<Folder>\n<wpml:templateId>0</wpml:templateId>\n"
            "<wpml:executeHeightMode>relativeToStartPoint</wpml:executeHeightMode>\n<wpml:waylineId>0</wpml:waylineId>\n"
            f"<wpml:distance>{length_m:.1f}</wpml:distance>\n"
            f"<wpml:duration>{float(sortie.time_s[-1] - sortie.time_s[0]):.1f}</wpml:duration>\n"
            f"<wpml:autoFlightSpeed>{_speed(sortie)}</wpml:autoFlightSpeed>\n"
        )
    )
    yield from _placemarks(plan, sortie, executed=True)
    yield "</Folder>\n</Document>\n</kml>\n"


def _head(drone: _Drone) -> str:
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:wpml="{drone.namespace}">\n<Document>\n'
    )


def _config(plan: Plan, sortie: Sortie, reference: bool) -> str:
    """Settings of the whole flight, with the take-off for which it was computed."""
    drone = _drone(plan)
    lat, lon = sortie.home
    # The aircraft departs and returns at 20 m, or higher where relief requires it.
    departure_m, return_m = (math.ceil(max(sortie.way_home_m(plan, at), 20.0)) for at in (0, -1))
    return_m = max(return_m, math.ceil(sortie.height_m.max()))
    place = f"<wpml:takeOffRefPoint>{lat:.9f},{lon:.9f},{sortie.base_m:.3f}</wpml:takeOffRefPoint>\n"
    camera = (
        f"<wpml:payloadInfo><wpml:payloadEnumValue>{drone.camera}</wpml:payloadEnumValue>"
        "<wpml:payloadSubEnumValue>0</wpml:payloadSubEnumValue>"
        "<wpml:payloadPositionIndex>0</wpml:payloadPositionIndex></wpml:payloadInfo>\n"
    )
    return (
        "<wpml:missionConfig>\n<wpml:flyToWaylineMode>safely</wpml:flyToWaylineMode>\n"
        "<wpml:finishAction>goHome</wpml:finishAction>\n<wpml:exitOnRCLost>executeLostAction</wpml:exitOnRCLost>\n"
        "<wpml:executeRCLostAction>goBack</wpml:executeRCLostAction>\n"
        f"<wpml:takeOffSecurityHeight>{departure_m}</wpml:takeOffSecurityHeight>\n"
        f"{place if reference and not drone.is_dji_fly else ''}"
        f"<wpml:globalTransitionalSpeed>{_speed(sortie)}</wpml:globalTransitionalSpeed>\n"
        f"<wpml:globalRTHHeight>{return_m}</wpml:globalRTHHeight>\n"
        f"<wpml:droneInfo><wpml:droneEnumValue>{drone.kind}</wpml:droneEnumValue>"
        f"<wpml:droneSubEnumValue>{drone.variant}</wpml:droneSubEnumValue></wpml:droneInfo>\n"
        f"{'' if drone.is_dji_fly else camera}</wpml:missionConfig>\n"
    )


def _placemarks(plan: Plan, sortie: Sortie, executed: bool) -> Iterator[str]:
    """Waypoints of the file that is flown (``executed``) or edited."""
    rounding_m = _rounding_m(plan, sortie)
    several_speeds = any(plan.airspeeds_m_per_s.strides)
    # DJI Fly does not know this element.
    risk = "" if _drone(plan).is_dji_fly else "<wpml:isRisky>0</wpml:isRisky>\n"
    for at, actions in enumerate(_actions(plan, sortie)):
        lat, lon, height = float(sortie.lat_deg[at]), float(sortie.lon_deg[at]), float(sortie.height_m[at])
        turn = (
            "<wpml:waypointTurnParam>"
            f"<wpml:waypointTurnMode>{_PASS if rounding_m[at] else _STOP}</wpml:waypointTurnMode>"
            f"<wpml:waypointTurnDampingDist>{rounding_m[at]:g}</wpml:waypointTurnDampingDist>"
            "</wpml:waypointTurnParam>\n<wpml:useStraightLine>1</wpml:useStraightLine>\n"
        )
        heading = _heading(float(sortie.heading_deg[at]), executed)
        heading = f"<wpml:waypointHeadingParam>{heading}</wpml:waypointHeadingParam>\n"
        if executed:
            settings = (
                f"<wpml:executeHeight>{height:.3f}</wpml:executeHeight>\n"
                f"<wpml:waypointSpeed>{_speed(sortie, at)}</wpml:waypointSpeed>\n{heading}{turn}"
            )
        else:
            speed = "<wpml:useGlobalSpeed>1</wpml:useGlobalSpeed>\n"
            if several_speeds:
                speed = (
                    "<wpml:useGlobalSpeed>0</wpml:useGlobalSpeed>\n"
                    f"<wpml:waypointSpeed>{_speed(sortie, at)}</wpml:waypointSpeed>\n"
                )
            settings = (
                f"<wpml:ellipsoidHeight>{height + sortie.base_m:.3f}</wpml:ellipsoidHeight>\n"
                f"<wpml:height>{height:.3f}</wpml:height>\n<wpml:useGlobalHeight>0</wpml:useGlobalHeight>\n"
                f"{speed}<wpml:useGlobalHeadingParam>0</wpml:useGlobalHeadingParam>\n{heading}"
                f"<wpml:useGlobalTurnParam>0</wpml:useGlobalTurnParam>\n{turn}"
                f"<wpml:gimbalPitchAngle>{float(sortie.gimbal_pitch_deg[at]):.2f}</wpml:gimbalPitchAngle>\n"
            )
        yield (
            f"<Placemark>\n<Point><coordinates>{lon:.9f},{lat:.9f}</coordinates></Point>\n"
            f"<wpml:index>{at}</wpml:index>\n{settings}{actions}{risk}</Placemark>\n"
        )


def _rounding_m(plan: Plan, sortie: Sortie) -> list[float]:
    """Distance before each waypoint at which the aircraft may leave the line to it; 0 where it stops."""
    found = np.zeros(len(sortie))
    if plan.mission.trigger == HOVER or _drone(plan).is_dji_fly:
        return [float(one) for one in found]
    plane = LocalPlane(float(sortie.lat_deg[0]), float(sortie.lon_deg[0]))
    lon = continuous(sortie.lon_deg, plane.lon_deg)
    leg = np.diff(np.stack([*plane.forward(sortie.lat_deg, lon), sortie.height_m], axis=1), axis=0)
    length = np.linalg.norm(leg, axis=1)
    level = geodesics(sortie.lat_deg[:-1], sortie.lon_deg[:-1], sortie.lat_deg[1:], sortie.lon_deg[1:])[2]
    # The first and the last waypoint have only one leg.
    passed = np.append(False, level >= _SHORT_LEG_M) & np.append(level >= _SHORT_LEG_M, False)
    if _is_distance_triggered(plan):
        passed &= _triggered_rows(plan, sortie).between
    # Enough for a smooth turn, and too little to matter for images.
    found[passed] = 0.2
    if not plan.relief.is_level:
        direction = leg / np.maximum(length, _SHORT_LEG_M)[:, np.newaxis]
        turn = np.linalg.norm(np.diff(direction, axis=0), axis=1)
        # Over relief, cut corners must hardly lower the flight.
        cut_m = 0.005
        most = np.floor(2000.0 * cut_m / np.maximum(turn, cut_m)) / 1000.0
        found[1:-1] = np.minimum(found[1:-1], most)
    return [float(one) for one in found]


def _actions(plan: Plan, sortie: Sortie) -> Iterator[str]:
    """Action groups of each waypoint: gimbal turns where the pitch changes, and images."""
    drone, hovers = _drone(plan), plan.mission.trigger == HOVER
    rows = _triggered_rows(plan, sortie)
    number, previous_pitch = 0, math.nan
    for at, (pitch, capture) in enumerate(zip(sortie.gimbal_pitch_deg.tolist(), sortie.capture.tolist())):
        actions = []
        if pitch != previous_pitch:
            actions.append(_gimbal(drone, pitch))
            previous_pitch = pitch
        shot = capture >= 0 and at not in rows.inside
        if shot and hovers:
            # The aircraft comes to rest within 1 s.
            actions.append(("hover", "<wpml:hoverTime>1</wpml:hoverTime>"))
        if shot:
            actions.append(_photo(drone, f"{plan.column[capture]}-{plan.row[capture]}"))
        text = ""
        if actions:
            text += _group(drone, number, (at, at), "reachPoint", None, actions)
            number += 1
        if at in rows.spacing_m:
            last, spacing = rows.spacing_m[at]
            photo = [_photo(drone, f"row-{plan.row[capture]}")]
            text += _group(drone, number, (at, last), "multipleDistance", spacing, photo)
            number += 1
        yield text


class _TriggeredRows(NamedTuple):
    """Rows with a camera triggered by distance.

    Parameters
    ----------
    spacing_m : dict
        By first waypoint of a row, the last waypoint and the distance between the images of the row.
    inside : set
        Waypoints of rows, at which no action takes an image.
    between : array of bool
        Waypoints of rows other than the ends.
    """

    spacing_m: dict[int, tuple[int, float]]
    inside: set[int]
    between: NDArray[np.bool_]


def _triggered_rows(plan: Plan, sortie: Sortie) -> _TriggeredRows:
    found = _TriggeredRows({}, set(), np.zeros(len(sortie), bool))
    if not _is_distance_triggered(plan):
        return found
    ends = {
        int(one.capture[first]): int(one.capture[last])
        for one in sorties(plan)
        for first, last in one.runs(plan)
        if last > first
    }
    waypoint = {capture: at for at, capture in enumerate(sortie.capture.tolist()) if capture >= 0}
    lat, lon = sortie.lat_deg, sortie.lon_deg
    for first, last in ends.items():
        if first not in waypoint or last not in waypoint:
            continue
        begin, end = waypoint[first], waypoint[last]
        places = (lat[begin:end], lon[begin:end], lat[begin + 1 : end + 1], lon[begin + 1 : end + 1])
        length_m = float(geodesics(*places)[2].sum())
        # Rounded down, so that the last image is not beyond the row.
        spacing = math.floor(length_m / (last - first) * 1000.0) / 1000.0
        if spacing > 0.0:
            found.spacing_m[begin] = end, spacing
            found.inside.update(range(begin, end + 1))
            found.between[begin + 1 : end] = True
    return found


def _group(
    drone: _Drone,
    number: int,
    ends: tuple[int, int],
    trigger: str,
    spacing_m: float | None,
    actions: list[tuple[str, str]],
) -> str:
    parameter = "" if spacing_m is None else f"<wpml:actionTriggerParam>{spacing_m:.3f}</wpml:actionTriggerParam>"
    return (
        f"<wpml:actionGroup><wpml:actionGroupId>{number}</wpml:actionGroupId>"
        f"<wpml:actionGroupStartIndex>{ends[0]}</wpml:actionGroupStartIndex>"
        f"<wpml:actionGroupEndIndex>{ends[1]}</wpml:actionGroupEndIndex>"
        f"<wpml:actionGroupMode>{'parallel' if drone.is_dji_fly else 'sequence'}</wpml:actionGroupMode>"
        f"<wpml:actionTrigger><wpml:actionTriggerType>{trigger}</wpml:actionTriggerType>{parameter}"
        "</wpml:actionTrigger>"
        + "".join(
            f"<wpml:action><wpml:actionId>{at}</wpml:actionId>"
            f"<wpml:actionActuatorFunc>{name}</wpml:actionActuatorFunc>"
            f"<wpml:actionActuatorFuncParam>{values}</wpml:actionActuatorFuncParam></wpml:action>"
            for at, (name, values) in enumerate(actions)
        )
        + "</wpml:actionGroup>\n"
    )


def _photo(drone: _Drone, name: str) -> tuple[str, str]:
    values = "<wpml:payloadPositionIndex>0</wpml:payloadPositionIndex>"
    if not drone.is_dji_fly:
        values += (
            f"<wpml:fileSuffix>{name}</wpml:fileSuffix><wpml:payloadLensIndex>{drone.lens}</wpml:payloadLensIndex>"
            "<wpml:useGlobalPayloadLensIndex>0</wpml:useGlobalPayloadLensIndex>"
        )
    return "takePhoto", values


def _gimbal(drone: _Drone, pitch_deg: float) -> tuple[str, str]:
    base = "aircraft" if drone.is_dji_fly else "north"
    return "gimbalRotate", (
        f"<wpml:gimbalHeadingYawBase>{base}</wpml:gimbalHeadingYawBase>"
        "<wpml:gimbalRotateMode>absoluteAngle</wpml:gimbalRotateMode>"
        "<wpml:gimbalPitchRotateEnable>1</wpml:gimbalPitchRotateEnable>"
        f"<wpml:gimbalPitchRotateAngle>{pitch_deg:.2f}</wpml:gimbalPitchRotateAngle>"
        "<wpml:gimbalRollRotateEnable>0</wpml:gimbalRollRotateEnable>"
        "<wpml:gimbalRollRotateAngle>0</wpml:gimbalRollRotateAngle>"
        "<wpml:gimbalYawRotateEnable>0</wpml:gimbalYawRotateEnable>"
        "<wpml:gimbalYawRotateAngle>0</wpml:gimbalYawRotateAngle>"
        "<wpml:gimbalRotateTimeEnable>0</wpml:gimbalRotateTimeEnable>"
        "<wpml:gimbalRotateTime>0</wpml:gimbalRotateTime>"
        "<wpml:payloadPositionIndex>0</wpml:payloadPositionIndex>"
    )


def _heading(heading_deg: float, executed: bool) -> str:
    """Heading to which the aircraft turns, the shorter way, on the leg to the waypoint."""
    wrapped = round((heading_deg + 180.0) % 360.0 - 180.0, 2)
    return (
        "<wpml:waypointHeadingMode>smoothTransition</wpml:waypointHeadingMode>"
        f"<wpml:waypointHeadingAngle>{wrapped:.2f}</wpml:waypointHeadingAngle>"
        "<wpml:waypointPoiPoint>0.000000,0.000000,0.000000</wpml:waypointPoiPoint>"
        f"{'<wpml:waypointHeadingAngleEnable>1</wpml:waypointHeadingAngleEnable>' if executed else ''}"
        "<wpml:waypointHeadingPathMode>followBadArc</wpml:waypointHeadingPathMode>"
    )


def _speed(sortie: Sortie, at: int = 0) -> str:
    return f"{min(float(sortie.speed_m_per_s[at]), MAX_SPEED_M_PER_S):.2f}"
