"""A reader of DJI's WPML of its own: elements in the order of DJI's reference, which are needed, and their values.

Written from the tables of https://developer.dji.com/doc/cloud-api-tutorial/en (DJI WPML), and for DJI Fly from the
elements that public writers of its files use. It knows nothing of the exporter.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
import zipfile
from typing import NamedTuple

KML = "{http://www.opengis.net/kml/2.2}"
ENTERPRISE, FLY = "http://www.dji.com/wpmz/1.0.6", "http://www.dji.com/wpmz/1.0.2"
#: Drone's type and variant, and the cameras that it carries, of DJI's "Product support".
AIRCRAFT = {
    (60, 0): {42, 43, 50, 61, 82, 83},
    (89, 0): {42, 43, 50, 61, 82, 83},
    (67, 0): {52},
    (67, 1): {53},
    (77, 0): {66},
    (77, 1): {67},
    (77, 2): {68},
    (99, 0): {88},
    (99, 1): {89},
    (68, 0): {None},
}


def one_of(*values):
    return lambda text: text in values


def number(least, most):
    return lambda text: least <= float(text) <= most


def whole(least, most):
    return lambda text: text.isdigit() and least <= int(text) <= most


def place(text):
    lat, lon, _ = map(float, text.split(","))
    return abs(lat) <= 90.0 and abs(lon) <= 180.0


FLAG, INDEX, ANGLE = one_of("0", "1"), whole(0, 65_535), number(-180.0, 180.0)
SPEED, PITCH = number(1.0, 15.0), number(-120.0, 45.0)
TURNS = (
    "coordinateTurn",
    "toPointAndStopWithDiscontinuityCurvature",
    "toPointAndStopWithContinuityCurvature",
    "toPointAndPassWithContinuityCurvature",
)
HEADING = [
    (
        "waypointHeadingMode",
        True,
        one_of("followWayline", "manually", "fixed", "smoothTransition", "towardPOI"),
    ),
    ("waypointHeadingAngle", True, ANGLE),
    ("waypointPoiPoint", False, place),
    # Not in the tables: Pilot 2 writes it into the file that is flown.
    ("waypointHeadingAngleEnable", False, FLAG),
    ("waypointHeadingPathMode", True, one_of("clockwise", "counterClockwise", "followBadArc")),
]
TURN = [("waypointTurnMode", True, one_of(*TURNS)), ("waypointTurnDampingDist", True, number(0.0, 1e4))]
ACTION_VALUES = {
    "takePhoto": [
        ("payloadPositionIndex", True, whole(0, 2)),
        ("fileSuffix", False, lambda text: text.replace("-", "").isalnum()),
        ("payloadLensIndex", False, one_of("zoom", "wide", "ir", "narrow_band", "visable")),
        ("useGlobalPayloadLensIndex", False, FLAG),
    ],
    "hover": [("hoverTime", True, number(1e-3, 3600.0))],
    "gimbalRotate": [
        ("gimbalHeadingYawBase", True, one_of("north", "aircraft")),
        ("gimbalRotateMode", True, one_of("absoluteAngle")),
        ("gimbalPitchRotateEnable", True, FLAG),
        ("gimbalPitchRotateAngle", True, PITCH),
        ("gimbalRollRotateEnable", True, FLAG),
        ("gimbalRollRotateAngle", True, ANGLE),
        ("gimbalYawRotateEnable", True, FLAG),
        ("gimbalYawRotateAngle", True, ANGLE),
        ("gimbalRotateTimeEnable", True, FLAG),
        ("gimbalRotateTime", True, number(0.0, 3600.0)),
        ("payloadPositionIndex", True, whole(0, 2)),
    ],
}
ACTION = [
    ("actionId", True, INDEX),
    ("actionActuatorFunc", True, one_of(*ACTION_VALUES)),
    ("actionActuatorFuncParam", True, None),
]
GROUP = [
    ("actionGroupId", True, INDEX),
    ("actionGroupStartIndex", True, INDEX),
    ("actionGroupEndIndex", True, INDEX),
    ("actionGroupMode", True, one_of("sequence", "parallel")),
    (
        "actionTrigger",
        True,
        [
            (
                "actionTriggerType",
                True,
                one_of("reachPoint", "betweenAdjacentPoints", "multipleTiming", "multipleDistance"),
            ),
            ("actionTriggerParam", False, number(1e-3, 1e5)),
        ],
    ),
    ("action", True, ACTION),
]
CONFIG = [
    ("flyToWaylineMode", True, one_of("safely", "pointToPoint")),
    ("finishAction", True, one_of("goHome", "noAction", "autoLand", "gotoFirstWaypoint")),
    ("exitOnRCLost", True, one_of("goContinue", "executeLostAction")),
    ("executeRCLostAction", False, one_of("goBack", "landing", "hover")),
    ("takeOffSecurityHeight", True, number(1.2, 1500.0)),
    ("takeOffRefPoint", False, place),
    ("takeOffRefPointAGLHeight", False, number(-1e4, 1e4)),
    ("globalTransitionalSpeed", True, SPEED),
    ("globalRTHHeight", False, number(2.0, 1500.0)),
    ("droneInfo", True, [("droneEnumValue", True, whole(0, 999)), ("droneSubEnumValue", True, whole(0, 9))]),
    (
        "payloadInfo",
        False,
        [
            ("payloadEnumValue", True, whole(0, 65_534)),
            # Not in the tables: Pilot 2 writes it.
            ("payloadSubEnumValue", False, whole(0, 9)),
            ("payloadPositionIndex", True, whole(0, 2)),
        ],
    ),
]
POINT = ("Point", True, [("coordinates", True, lambda text: len(text.split(",")) == 2)])
TEMPLATE_MARK = [
    POINT,
    ("index", True, INDEX),
    ("ellipsoidHeight", True, number(-1e5, 1e5)),
    ("height", True, number(-1500.0, 1500.0)),
    ("useGlobalHeight", True, FLAG),
    ("useGlobalSpeed", True, FLAG),
    ("waypointSpeed", False, SPEED),
    ("useGlobalHeadingParam", True, FLAG),
    ("waypointHeadingParam", False, HEADING),
    ("useGlobalTurnParam", True, FLAG),
    ("waypointTurnParam", False, TURN),
    ("useStraightLine", False, FLAG),
    ("gimbalPitchAngle", True, PITCH),
    ("actionGroup", False, GROUP),
    ("isRisky", False, FLAG),
]
FLOWN_MARK = [
    POINT,
    ("index", True, INDEX),
    ("executeHeight", True, number(-1500.0, 1500.0)),
    ("waypointSpeed", True, SPEED),
    ("waypointHeadingParam", True, HEADING),
    ("waypointTurnParam", True, TURN),
    ("useStraightLine", False, FLAG),
    ("actionGroup", False, GROUP),
    ("isRisky", False, FLAG),
]
TEMPLATE_FOLDER = [
    ("templateType", True, one_of("waypoint")),
    ("templateId", True, INDEX),
    (
        "waylineCoordinateSysParam",
        True,
        [
            ("coordinateMode", True, one_of("WGS84")),
            ("heightMode", True, one_of("EGM96", "relativeToStartPoint", "aboveGroundLevel")),
        ],
    ),
    ("autoFlightSpeed", True, SPEED),
    ("globalHeight", True, number(-1500.0, 1500.0)),
    ("caliFlightEnable", False, FLAG),
    ("gimbalPitchMode", True, one_of("manual", "usePointSetting")),
    ("globalWaypointHeadingParam", True, HEADING),
    ("globalWaypointTurnMode", True, one_of(*TURNS)),
    ("globalUseStraightLine", False, FLAG),
    ("Placemark", True, TEMPLATE_MARK),
    (
        "payloadParam",
        False,
        [
            ("payloadPositionIndex", True, whole(0, 2)),
            ("imageFormat", True, one_of("zoom", "wide", "ir", "narrow_band", "visable")),
        ],
    ),
]
FLOWN_FOLDER = [
    ("templateId", True, INDEX),
    ("executeHeightMode", True, one_of("WGS84", "relativeToStartPoint", "realTimeFollowSurface")),
    ("waylineId", True, INDEX),
    ("distance", False, number(0.0, 1e9)),
    ("duration", False, number(0.0, 1e9)),
    ("autoFlightSpeed", True, SPEED),
    ("Placemark", True, FLOWN_MARK),
]
AUTHOR = [
    ("author", False, bool),
    ("createTime", False, lambda text: text.isdigit()),
    ("updateTime", False, lambda text: text.isdigit()),
]
SEVERAL = {"Placemark", "actionGroup", "action"}
STANDARD = {"Document", "Folder", "Placemark", "Point", "coordinates"}


class Photo(NamedTuple):
    """An image that the file asks for."""

    lat_deg: float
    lon_deg: float
    height_m: float
    heading_deg: float
    pitch_deg: float


class Mark(NamedTuple):
    """A waypoint of the file that is flown."""

    lat_deg: float
    lon_deg: float
    height_m: float
    heading_deg: float
    turn: str
    groups: list
    speed_m_per_s: float


def checked(element, rules, namespace):
    """Check an element's children against rules; raises AssertionError with what is wrong."""
    names = [child.tag.rpartition("}")[2] for child in element]
    for child, name in zip(element, names):
        wanted = KML if name in STANDARD else f"{{{namespace}}}"
        assert child.tag == wanted + name, child.tag
    order = [name for name, _, _ in rules]
    assert set(names) <= set(order), set(names) - set(order)
    assert names == sorted(names, key=order.index), names
    for name, needed, rule in rules:
        count = names.count(name)
        assert count >= needed, f"{name} is missing"
        assert count <= 1 or name in SEVERAL, f"{name} {count} times"
        for child in (one for one, its in zip(element, names) if its == name):
            if isinstance(rule, list):
                checked(child, rule, namespace)
            elif rule is not None:
                assert len(child) == 0
                assert rule(child.text), f"{name} {child.text!r}"


class Wpml:
    """Both files of a KMZ, checked."""

    def __init__(self, path):
        with zipfile.ZipFile(path) as archive:
            assert archive.testzip() is None
            assert archive.namelist() == ["wpmz/template.kml", "wpmz/waylines.wpml"]
            assert {one.date_time for one in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
            template, flown = (ET.fromstring(archive.read(name)) for name in archive.namelist())
        config = next(child for child in flown[0] if child.tag.endswith("missionConfig"))
        self.namespace = config.tag[1:].partition("}")[0]
        assert self.namespace in (ENTERPRISE, FLY)
        self.of_fly = self.namespace == FLY
        self._checked_document(template, True)
        self._checked_document(flown, False)
        self.config, self.folder = config, flown[0].find(f"{KML}Folder")
        kind = tuple(int(self.text(config, f"droneInfo/{name}")) for name in ("droneEnumValue", "droneSubEnumValue"))
        camera = self.text(config, "payloadInfo/payloadEnumValue")
        assert (None if camera is None else int(camera)) in AIRCRAFT[kind]
        self.kind = kind
        self.marks = [self._mark(one) for one in self.folder.findall(f"{KML}Placemark")]
        self._checked_groups()
        self.template = template[0].find(f"{KML}Folder")
        if not self.of_fly:
            self._checked_pair(template)

    def path(self, names):
        return "/".join((KML if name in STANDARD else f"{{{self.namespace}}}") + name for name in names.split("/"))

    def text(self, element, names):
        found = element.find(self.path(names))
        return None if found is None else found.text

    def _checked_document(self, root, template):
        assert root.tag == f"{KML}kml"
        assert [child.tag for child in root] == [f"{KML}Document"]
        folder = TEMPLATE_FOLDER if template else FLOWN_FOLDER
        alone = template and self.of_fly
        rules = [
            *(AUTHOR if template else []),
            ("missionConfig", True, CONFIG),
            *([] if alone else [("Folder", True, folder)]),
        ]
        checked(root[0], rules, self.namespace)

    def _mark(self, element):
        lon, lat = map(float, self.text(element, "Point/coordinates").split(","))
        assert abs(lat) <= 90.0
        assert -180.0 <= lon <= 180.0
        return Mark(
            lat,
            lon,
            float(self.text(element, "executeHeight")),
            float(self.text(element, "waypointHeadingParam/waypointHeadingAngle")) % 360.0,
            self.text(element, "waypointTurnParam/waypointTurnMode"),
            [self._group(one) for one in element.findall(self.path("actionGroup"))],
            float(self.text(element, "waypointSpeed")),
        )

    def _group(self, element):
        trigger = self.text(element, "actionTrigger/actionTriggerType")
        spacing = self.text(element, "actionTrigger/actionTriggerParam")
        # Only what is repeated has an interval.
        assert (spacing is None) == (trigger == "reachPoint")
        actions = []
        for number_, one in enumerate(element.findall(self.path("action"))):
            assert int(self.text(one, "actionId")) == number_
            name, values = (
                self.text(one, "actionActuatorFunc"),
                one.find(self.path("actionActuatorFuncParam")),
            )
            checked(values, ACTION_VALUES[name], self.namespace)
            actions.append((name, values))
        ends = tuple(int(self.text(element, f"actionGroup{end}Index")) for end in ("Start", "End"))
        return int(self.text(element, "actionGroupId")), ends, trigger, spacing and float(spacing), actions

    def _checked_groups(self):
        indices = [int(self.text(one, "index")) for one in self.folder.findall(f"{KML}Placemark")]
        assert indices == list(range(len(self.marks)))
        ids = [group[0] for mark in self.marks for group in mark.groups]
        assert ids == list(range(len(ids)))
        for at, mark in enumerate(self.marks):
            for _, (first, last), _, _, _ in mark.groups:
                assert at == first <= last < len(self.marks)

    def _checked_pair(self, template):
        """What is edited is what is flown."""
        edited = self.template.findall(f"{KML}Placemark")
        flown = self.folder.findall(f"{KML}Placemark")
        assert len(edited) == len(flown)
        assert self.text(self.template, "waylineCoordinateSysParam/heightMode") == self.text(
            self.folder, "executeHeightMode"
        )
        for one, other in zip(edited, flown):
            for name in ("Point/coordinates", "index", "waypointHeadingParam/waypointHeadingAngle"):
                assert self.text(one, name) == self.text(other, name)
            assert self.text(one, "height") == self.text(other, "executeHeight")
            groups = [[ET.tostring(group) for group in it.findall(self.path("actionGroup"))] for it in (one, other)]
            assert groups[0] == groups[1]

    def photos(self, along):
        """Images that are taken, in order; ``along`` gives a place some metres from one towards another."""
        found, pitch = [], None
        for at, mark in enumerate(self.marks):
            for _, (_, last), trigger, spacing, actions in mark.groups:
                for name, values in actions:
                    if name == "gimbalRotate":
                        pitch = float(self.text(values, "gimbalPitchRotateAngle"))
                    if name != "takePhoto":
                        continue
                    assert pitch is not None
                    if trigger == "reachPoint":
                        found.append(Photo(*mark[:4], pitch))
                        continue
                    end = self.marks[last]
                    assert last == at + 1
                    assert end.heading_deg == mark.heading_deg
                    for lat, lon, share in along(mark, end, spacing):
                        height = mark.height_m + share * (end.height_m - mark.height_m)
                        found.append(Photo(lat, lon, height, mark.heading_deg, pitch))
        return found
