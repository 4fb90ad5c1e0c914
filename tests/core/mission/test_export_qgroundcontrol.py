"""QGroundControl's plan: keys of its published format, commands and frames of MAVLink by their numbers."""

from __future__ import annotations

import json

import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.area import Box
from terrainav.core.mission.export import write_plan

from tests.core.mission.flights import ACROSS, ALONE, HERE, IN_WIND, worked_out

TAKEOFF, WAYPOINT, RETURN, SPEED, MOUNT, PICTURE = 22, 16, 20, 178, 205, 2000


def read(path):
    def refuse(name):
        raise AssertionError(f"{name} is no JSON")

    return json.loads(path.read_text(), parse_constant=refuse)


@pytest.mark.parametrize(
    "mission", [HERE, ACROSS, ALONE, IN_WIND], ids=["here", "antimeridian", "alone", "wind"]
)
def test_the_plan_has_what_the_format_asks_for(tmp_path, mission):
    flown = worked_out(mission)
    write_plan(flown, tmp_path / "field.plan")
    data = read(tmp_path / "field.plan")
    assert (data["fileType"], data["version"], data["groundStation"]) == ("Plan", 1, "QGroundControl")
    assert data["geoFence"] == {"circles": [], "polygons": [], "version": 2}
    assert data["rallyPoints"] == {"points": [], "version": 2}
    about = data["mission"]
    assert set(about) == {
        *("version", "firmwareType", "globalPlanAltitudeMode", "vehicleType", "cruiseSpeed", "hoverSpeed"),
        *("items", "plannedHomePosition"),
    }
    assert (about["version"], about["hoverSpeed"], about["cruiseSpeed"]) == (2, 15.0, 15.0)
    items = about["items"]
    assert [item["doJumpId"] for item in items] == list(range(1, len(items) + 1))
    assert {item["type"] for item in items} == {"SimpleItem"}
    assert all(item["autoContinue"] is True and len(item["params"]) == 7 for item in items)
    commands = [item["command"] for item in items]
    assert commands == [TAKEOFF, SPEED, MOUNT, *[WAYPOINT, PICTURE] * len(flown), RETURN]
    # Places are in the frame of heights over home (3); the others are commands without a place (2).
    for item in items:
        placed = item["command"] in (TAKEOFF, WAYPOINT)
        assert item["frame"] == (3 if placed else 2)
        assert ("Altitude" in item) is placed
        if placed:
            assert (item["Altitude"], item["AltitudeMode"]) == (item["params"][6], 1)


def test_waypoints_are_the_nominal_captures(tmp_path):
    flown, meant = worked_out(IN_WIND), worked_out(HERE)
    exported = write_plan(flown, tmp_path / "field.plan")
    items = read(tmp_path / "field.plan")["mission"]["items"]
    places = [item["params"] for item in items if item["command"] == WAYPOINT]
    assert [tuple(params[4:6]) for params in places] == list(
        zip(meant.lat_deg.tolist(), meant.lon_deg.tolist())
    )
    assert {(params[0], params[3], params[6]) for params in places} == {(0, 330.0, 120.0)}
    speed, mount = items[1]["params"], items[2]["params"]
    assert speed[:3] == [1, 15.0, -1]  # over ground; the throttle stays
    assert mount == [-70.0, 0, 0, 0, 0, 0, 2]  # targeted by MAVLink
    assert {tuple(item["params"][:3]) for item in items if item["command"] == PICTURE} == {(0, 0, 1)}
    assert "wind is left out" in exported.notes[0]
    assert "place of take-off" in exported.notes[-1]


def test_home_is_below_the_first_waypoint(tmp_path):
    flown = worked_out(HERE.with_(ground_height_m=80.0))
    write_plan(flown, tmp_path / "field.plan")
    home = read(tmp_path / "field.plan")["mission"]["plannedHomePosition"]
    assert home == [flown.lat_deg[0], flown.lon_deg[0], 80.0]


def test_more_than_mavlink_counts_is_refused(tmp_path):
    flown = worked_out(HERE.with_(agl_m=10.0, tilt_deg=0.0, area=Box(35.19, -89.90, 35.15, -89.86)))
    assert len(flown) > 32_765
    with pytest.raises(InvalidInput, match="waypoints: takes 32,765 or fewer"):
        write_plan(flown, tmp_path / "field.plan")
    assert list(tmp_path.iterdir()) == []
