"""Keys of a ``.plan`` that QGroundControl's own loaders ask for, and a reader that asks as they do.

Read off ``load`` of the classes named, in QGroundControl v3.5.6, v4.2.3 and the development version of 25 April 2026
(commit 3ebcc5736): a key is needed where one of the three needs it, and its type is that of all three. Where loaders of
later versions first convert sections of the first version, which is ours, the keys are those that they convert.
"""

from __future__ import annotations

from typing import NamedTuple

NUMBER, TRUTH, TEXT, LIST, OBJECT = (int, float), bool, str, list, dict


class Keys(NamedTuple):
    """What a loader asks for: keys that have to be there, and keys that may."""

    needed: dict
    optional: dict


LOADERS = {
    # PlanMasterController::loadFromFile with JsonHelper::validateExternalQGCJsonFile.
    "PlanMasterController": Keys(
        {
            "fileType": TEXT,
            "groundStation": TEXT,
            "version": NUMBER,
            "mission": OBJECT,
            "geoFence": OBJECT,
            "rallyPoints": OBJECT,
        },
        {},
    ),
    "GeoFenceController": Keys({"version": NUMBER, "circles": LIST, "polygons": LIST}, {"breachReturn": LIST}),
    "RallyPointController": Keys({"version": NUMBER, "points": LIST}, {}),
    # MissionController::_loadJsonMissionFileV2; its version is written and not asked for.
    "MissionController": Keys(
        {"plannedHomePosition": LIST, "items": LIST, "firmwareType": NUMBER},
        {
            "version": NUMBER,
            "vehicleType": NUMBER,
            "cruiseSpeed": NUMBER,
            "hoverSpeed": NUMBER,
            "globalPlanAltitudeMode": NUMBER,
        },
    ),
    # SimpleMissionItem::load asks for AltitudeMode, Altitude and AMSLAltAboveTerrain only where one of them is there;
    # between 7 and 17 December 2025 (commits f3f7162d2 and 9248a39c2) a null among them is refused.
    "MissionItem": Keys(
        {"type": TEXT, "frame": NUMBER, "command": NUMBER, "params": LIST, "autoContinue": TRUTH},
        {"doJumpId": NUMBER},
    ),
    "SurveyComplexItem": Keys(
        {
            "version": NUMBER,
            "type": TEXT,
            "complexItemType": TEXT,
            "entryLocation": NUMBER,
            "angle": NUMBER,
            "splitConcavePolygons": TRUTH,
            "polygon": LIST,
            "TransectStyleComplexItem": OBJECT,
        },
        {"flyAlternateTransects": TRUTH},
    ),
    # FollowTerrain is needed up to v3.5 and converted since; CameraShots is needed since, and 0 where it is missing.
    "TransectStyleComplexItem": Keys(
        {
            "version": NUMBER,
            "TurnAroundDistance": NUMBER,
            "CameraTriggerInTurnAround": TRUTH,
            "HoverAndCapture": TRUTH,
            "Refly90Degrees": TRUTH,
            "FollowTerrain": TRUTH,
            "CameraCalc": OBJECT,
            "VisualTransectPoints": LIST,
            "Items": LIST,
            "CameraShots": NUMBER,
        },
        {},
    ),
    # The same loader, where FollowTerrain holds.
    "terrain": Keys(
        {
            "TerrainAdjustTolerance": NUMBER,
            "TerrainAdjustMaxClimbRate": NUMBER,
            "TerrainAdjustMaxDescentRate": NUMBER,
        },
        {"TerrainFlightSpeed": NUMBER},
    ),
    # DistanceToSurfaceRelative is needed up to v3.5, and made a DistanceMode since.
    "CameraCalc": Keys(
        {
            "version": NUMBER,
            "CameraName": TEXT,
            "AdjustedFootprintSide": NUMBER,
            "AdjustedFootprintFrontal": NUMBER,
            "DistanceToSurface": NUMBER,
            "DistanceToSurfaceRelative": TRUTH,
            "ValueSetIsDistance": TRUTH,
            "ImageDensity": NUMBER,
            "FrontalOverlap": NUMBER,
            "SideOverlap": NUMBER,
        },
        {},
    ),
    "CameraSpec": Keys(
        {
            "SensorWidth": NUMBER,
            "SensorHeight": NUMBER,
            "ImageWidth": NUMBER,
            "ImageHeight": NUMBER,
            "FocalLength": NUMBER,
            "Landscape": TRUTH,
            "FixedOrientation": TRUTH,
            "MinTriggerInterval": NUMBER,
        },
        {},
    ),
}


def is_a(value, kind):
    """Whether a value has a JSON type; in Python a truth is a number as well, in JSON it is none."""
    return isinstance(value, kind) and (kind is not NUMBER or not isinstance(value, bool))


def loaded(data, *loaders):
    """Check an object as loaders do, and that it has no key that none of them knows."""
    needed, optional = {}, {}
    for name in loaders:
        needed.update(LOADERS[name].needed)
        optional.update(LOADERS[name].optional)
    assert not set(needed) - set(data), set(needed) - set(data)
    assert not set(data) - {*needed, *optional}, set(data) - {*needed, *optional}
    for key, kind in {**needed, **optional}.items():
        assert key not in data or is_a(data[key], kind), (key, data[key])


def loaded_places(places, size):
    """Check latitudes and longitudes, with heights where ``size`` is 3."""
    for place in places:
        assert len(place) == size
        assert all(is_a(value, NUMBER) for value in place)
        assert abs(place[0]) <= 90.0
        assert abs(place[1]) <= 180.0


def loaded_item(item):
    """Check a simple item, at any depth."""
    loaded(item, "MissionItem")
    assert item["type"] == "SimpleItem"
    assert len(item["params"]) == 7
    assert all(value is None or is_a(value, NUMBER) for value in item["params"])


def loaded_survey(survey):
    """Check a survey, and give its rows and camera."""
    loaded(survey, "SurveyComplexItem")
    assert (survey["type"], survey["complexItemType"]) == ("ComplexItem", "survey")
    assert survey["version"] in (4, 5)
    loaded_places(survey["polygon"], 2)
    transects = survey["TransectStyleComplexItem"]
    loaded(transects, "TransectStyleComplexItem", *(["terrain"] if transects["FollowTerrain"] else []))
    # A later one is refused by v3.5, whatever is in it.
    assert (transects["version"], transects["CameraCalc"]["version"]) == (1, 1)
    loaded_places(transects["VisualTransectPoints"], 2)
    for item in transects["Items"]:
        loaded_item(item)
    loaded(transects["CameraCalc"], "CameraCalc", "CameraSpec")
    return transects


def loaded_plan(data):
    """Check a whole plan, and give its items."""
    loaded(data, "PlanMasterController")
    assert (data["fileType"], data["version"]) == ("Plan", 1)
    loaded(data["geoFence"], "GeoFenceController")
    loaded(data["rallyPoints"], "RallyPointController")
    assert (data["geoFence"]["version"], data["rallyPoints"]["version"]) == (2, 2)
    mission = data["mission"]
    loaded(mission, "MissionController")
    loaded_places([mission["plannedHomePosition"]], 3)
    for item in mission["items"]:
        if item["type"] == "ComplexItem":
            loaded_survey(item)
        else:
            loaded_item(item)
    return mission["items"]
