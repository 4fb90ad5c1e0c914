"""Where other writers of DJI's WPML put its elements: structure alone, to hold our files against.

Children of each element in their order; those of ``actionActuatorFuncParam`` stand under the name of the action. Each
listing is `outline` of a file that the writer made of three waypoints with the gimbal straight down, a heading of 90
degrees and an image each, in November 2026:

- ``drone-flightplan`` 1.0.0 (PyPI, AGPL-3.0-only, HOT's DroneTM): ``drone_flightplan.output.dji.create_wpml``, with and
  without ``take_photo``. It writes no template.
- ``DJI-Mapper`` (github.com/YarosMallorca/DJI-Mapper at 5691d3d, MIT): read off the classes of its
  ``dji_waypoint_engine`` and what ``lib/layouts/export.dart`` makes of them, as no Dart runs here.
- ``djikmz`` 0.1.0 (PyPI, MIT): ``DroneTask("M3E")`` with ``fly_to``, ``height``, ``turn_mode``, ``heading``,
  ``gimbal_pitch``, ``hover`` and ``take_photo``. It writes the template alone.
- ``dji_wpml_builder`` (github.com/bonchan/dji_wpml_builder at 5c2f806, MIT): ``KMZGenerator`` with ``gimbalRotate``,
  ``rotateYaw`` and ``takePhoto``.
- ``Payload SDK`` 3.13.1 (github.com/dji-sdk/Payload-SDK, MIT): DJI's own ``waypoint_v3_test_file.kmz``, a sample for a
  Mavic 3E with more actions.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
import zipfile

TEMPLATE, WAYLINES = "wpmz/template.kml", "wpmz/waylines.wpml"

_DRONE = "droneEnumValue droneSubEnumValue"
_TURN = "waypointTurnMode waypointTurnDampingDist"
_GROUP = "actionGroupId actionGroupStartIndex actionGroupEndIndex actionGroupMode actionTrigger action"
_ACTION = "actionId actionActuatorFunc actionActuatorFuncParam"
_GIMBAL = (
    "gimbalRotateMode gimbalPitchRotateEnable gimbalPitchRotateAngle gimbalRollRotateEnable gimbalRollRotateAngle "
    "gimbalYawRotateEnable gimbalYawRotateAngle gimbalRotateTimeEnable gimbalRotateTime"
)
_SIDE = "payloadEnumValue payloadSubEnumValue payloadPositionIndex"

_DRONE_FLIGHTPLAN = {
    WAYLINES: {
        "kml": "Document",
        "Document": "missionConfig Folder",
        "missionConfig": (
            "flyToWaylineMode finishAction exitOnRCLost globalTransitionalSpeed globalRTHHeight droneInfo"
        ),
        "droneInfo": _DRONE,
        "Folder": (
            "templateId executeHeightMode waylineId distance duration globalWaypointTurnMode globalUseStraightLine "
            "autoFlightSpeed Placemark"
        ),
        "Placemark": (
            "Point index executeHeight waypointSpeed waypointHeadingParam waypointTurnParam useStraightLine actionGroup"
        ),
        "Point": "coordinates",
        "waypointHeadingParam": (
            "waypointHeadingMode waypointHeadingAngle waypointPoiPoint waypointHeadingAngleEnable"
        ),
        "waypointTurnParam": _TURN,
        "actionGroup": _GROUP,
        "actionTrigger": "actionTriggerType",
        "action": _ACTION,
        "takePhoto": "payloadPositionIndex",
        "gimbalRotate": f"gimbalHeadingYawBase {_GIMBAL} payloadPositionIndex",
        "gimbalEvenlyRotate": (
            "gimbalPitchRotateAngle gimbalRollRotateEnable gimbalRollRotateAngle gimbalYawRotateEnable "
            "gimbalYawRotateAngle gimbalRotateTimeEnable gimbalRotateTime payloadPositionIndex"
        ),
    }
}
_MAPPER_CONFIG = {
    "kml": "Document",
    "missionConfig": (
        "flyToWaylineMode finishAction exitOnRCLost executeRCLostAction globalTransitionalSpeed droneInfo"
    ),
    "droneInfo": _DRONE,
}
_DJI_MAPPER = {
    TEMPLATE: {**_MAPPER_CONFIG, "Document": "author createTime updateTime missionConfig"},
    WAYLINES: {
        **_MAPPER_CONFIG,
        "Document": "missionConfig Folder",
        "Folder": "templateId executeHeightMode waylineId distance duration autoFlightSpeed Placemark",
        "Placemark": (
            "Point index executeHeight waypointSpeed waypointHeadingParam waypointTurnParam useStraightLine actionGroup"
        ),
        "Point": "coordinates",
        "waypointHeadingParam": (
            "waypointHeadingMode waypointHeadingAngle waypointPoiPoint waypointHeadingAngleEnable "
            "waypointHeadingPathMode"
        ),
        "waypointTurnParam": _TURN,
        "actionGroup": _GROUP,
        "actionTrigger": "actionTriggerType",
        "action": _ACTION,
        "takePhoto": "payloadPositionIndex",
        "hover": "hoverTime",
        "gimbalEvenlyRotate": "gimbalPitchRotateAngle payloadPositionIndex",
    },
}
_DJIKMZ = {
    TEMPLATE: {
        "kml": "Document",
        "Document": "author createTime updateTime missionConfig Folder",
        "missionConfig": ("flyToWaylineMode finishAction takeOffSecurityHeight droneInfo payloadInfo exitOnRCLost"),
        "droneInfo": _DRONE,
        "payloadInfo": "payloadEnumValue payloadPositionIndex",
        "Folder": (
            "templateType templateId waylineCoordinateSysParam autoFlightSpeed globalHeight globalWaypointHeadingParam "
            "globalWaypointTurnMode globalUseStraightLine globalGimbalPitchMode Placemark"
        ),
        "waylineCoordinateSysParam": "coordinateMode heightMode positioningType",
        "globalWaypointHeadingParam": "waypointHeadingMode waypointHeadingPathMode",
        "Placemark": (
            "index height useGlobalHeight useGlobalSpeed useGlobalHeadingParam waypointTurnParam useGlobalTurnParam "
            "useStraightLine actionGroup Point"
        ),
        "Point": "coordinates",
        "waypointTurnParam": "waypointTurnMode",
        "actionGroup": ("actionGroupId actionGroupStartIndex actionGroupEndIndex actionGroupMode action actionTrigger"),
        "actionTrigger": "actionTriggerType",
        "action": "actionActuatorFunc actionId actionActuatorFuncParam",
        "rotateYaw": "aircraftHeading aircraftPathMode",
        "gimbalRotate": f"payloadPositionIndex {_GIMBAL} gimbalHeadingYawBase",
        "hover": "hoverTime",
        "takePhoto": "payloadPositionIndex fileSuffix useGlobalPayloadLensIndex",
    }
}
_BUILDER_BOTH = {
    "kml": "Document",
    "missionConfig": (
        "flyToWaylineMode finishAction exitOnRCLost executeRCLostAction takeOffSecurityHeight globalTransitionalSpeed "
        "globalRTHHeight takeOffRefPoint droneInfo payloadInfo"
    ),
    "droneInfo": _DRONE,
    "Point": "coordinates",
    "waypointTurnParam": _TURN,
    "actionGroup": _GROUP,
    "actionTrigger": "actionTriggerType",
    "action": _ACTION,
    "rotateYaw": "aircraftHeading aircraftPathMode",
    "gimbalRotate": "gimbalRotateMode gimbalPitchRotateEnable gimbalPitchRotateAngle",
    "takePhoto": "payloadPositionIndex fileSuffix payloadLensIndex useGlobalPayloadLensIndex",
}
_DJI_WPML_BUILDER = {
    TEMPLATE: {
        **_BUILDER_BOTH,
        "Document": "author createTime updateTime missionConfig Folder",
        "payloadInfo": "payloadEnumValue payloadPositionIndex",
        "Folder": "templateType templateId waylineCoordinateSysParam autoFlightSpeed Placemark payloadParam",
        "waylineCoordinateSysParam": "coordinateMode heightMode",
        "Placemark": (
            "Point index ellipsoidHeight height waypointSpeed waypointTurnParam useGlobalHeight useGlobalSpeed "
            "useGlobalHeadingParam useGlobalTurnParam useStraightLine actionGroup isRisky"
        ),
        "payloadParam": "payloadPositionIndex imageFormat",
    },
    WAYLINES: {
        **_BUILDER_BOTH,
        "Document": "missionConfig Folder",
        "payloadInfo": _SIDE,
        "Folder": "templateId executeHeightMode waylineId autoFlightSpeed Placemark",
        "Placemark": (
            "Point index executeHeight waypointSpeed waypointTurnParam useStraightLine actionGroup "
            "waypointGimbalHeadingParam isRisky waypointWorkType"
        ),
        "waypointGimbalHeadingParam": "waypointGimbalPitchAngle waypointGimbalYawAngle",
    },
}
_SDK_BOTH = {
    "kml": "Document",
    "missionConfig": (
        "flyToWaylineMode finishAction exitOnRCLost executeRCLostAction takeOffSecurityHeight globalTransitionalSpeed "
        "droneInfo payloadInfo"
    ),
    "droneInfo": _DRONE,
    "payloadInfo": _SIDE,
    "Point": "coordinates",
    "actionGroup": _GROUP,
    "actionTrigger": "actionTriggerType actionTriggerParam",
    "action": _ACTION,
    "takePhoto": "fileSuffix payloadPositionIndex useGlobalPayloadLensIndex",
    "gimbalRotate": f"{_GIMBAL} payloadPositionIndex",
    "startRecord": "fileSuffix payloadPositionIndex useGlobalPayloadLensIndex",
    "stopRecord": "payloadPositionIndex",
    "zoom": "focalLength isUseFocalFactor payloadPositionIndex",
    "customDirName": "payloadPositionIndex",
}
_PAYLOAD_SDK = {
    TEMPLATE: {
        **_SDK_BOTH,
        "Document": "createTime updateTime missionConfig Folder",
        "Folder": (
            "templateType templateId waylineCoordinateSysParam autoFlightSpeed globalHeight caliFlightEnable "
            "gimbalPitchMode globalWaypointHeadingParam globalWaypointTurnMode globalUseStraightLine Placemark "
            "payloadParam"
        ),
        "waylineCoordinateSysParam": "coordinateMode heightMode positioningType",
        "globalWaypointHeadingParam": (
            "waypointHeadingMode waypointHeadingAngle waypointPoiPoint waypointHeadingPoiIndex"
        ),
        "Placemark": (
            "Point index ellipsoidHeight height useGlobalHeight useGlobalSpeed useGlobalHeadingParam "
            "useGlobalTurnParam useStraightLine actionGroup"
        ),
        "payloadParam": "payloadPositionIndex",
    },
    WAYLINES: {
        **_SDK_BOTH,
        "Document": "missionConfig Folder",
        "Folder": "templateId executeHeightMode waylineId distance duration autoFlightSpeed Placemark",
        "Placemark": (
            "Point index executeHeight waypointSpeed waypointHeadingParam waypointTurnParam useStraightLine actionGroup"
        ),
        "waypointHeadingParam": (
            "waypointHeadingMode waypointHeadingAngle waypointPoiPoint waypointHeadingAngleEnable "
            "waypointHeadingPoiIndex"
        ),
        "waypointTurnParam": _TURN,
        "focus": ("focusX focusY focusRegionWidth focusRegionHeight isPointFocus isInfiniteFocus payloadPositionIndex"),
    },
}
#: Writers for the same program: DJI Fly; Pilot 2 and FlightHub 2.
FLY_WRITERS = {"drone-flightplan": _DRONE_FLIGHTPLAN, "DJI-Mapper": _DJI_MAPPER}
PILOT_WRITERS = {"djikmz": _DJIKMZ, "dji_wpml_builder": _DJI_WPML_BUILDER, "Payload SDK": _PAYLOAD_SDK}


def outline(path, name):
    """Children of each element of a file in a KMZ, in every order that is met: ``{parent: {(child, …), …}}``."""
    with zipfile.ZipFile(path) as archive:
        root = ET.fromstring(archive.read(name))
    found = {}

    def walk(element, parent):
        names = [child.tag.rpartition("}")[2] for child in element]
        found.setdefault(parent, set()).add(tuple(dict.fromkeys(names)))
        action = next((child.text for child, its in zip(element, names) if its == "actionActuatorFunc"), None)
        for child, its in zip(element, names):
            if len(child):
                walk(child, action if its == "actionActuatorFuncParam" else its)

    walk(root, "kml")
    return found
