"""QGroundControl's plan: keys that its loaders ask for, commands and frames of MAVLink by their numbers."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.opening import SourceOptions
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights

from tests.core.mission.flights import ACROSS, ALONE, HERE, IN_WIND, worked_out
from tests.core.mission.qgc_loaders import loaded_plan
from tests.core.mission.qgc_survey import GEOD, photos
from tests.core.mission.test_export_wpml import SURVEY, with_sorties

TAKEOFF, WAYPOINT, RETURN, SPEED, MOUNT, PICTURE = 22, 16, 20, 178, 205, 2000


def read(path):
    def refuse(name):
        raise AssertionError(f"{name} is no JSON")

    return json.loads(path.read_text(), parse_constant=refuse)


@pytest.mark.parametrize("mission", [HERE, ACROSS, ALONE, IN_WIND], ids=["here", "antimeridian", "alone", "wind"])
def test_the_plan_has_what_the_loaders_ask_for(tmp_path, mission):
    flown = worked_out(mission)
    write_plan(flown, tmp_path / "field.plan")
    data = read(tmp_path / "field.plan")
    items, about = loaded_plan(data), data["mission"]
    assert data["groundStation"] == "QGroundControl"
    assert (about["version"], about["hoverSpeed"], about["cruiseSpeed"]) == (2, 15.0, 15.0)
    assert [item["doJumpId"] for item in items] == list(range(1, len(items) + 1))
    assert all(item["autoContinue"] is True for item in items)
    commands = [item["command"] for item in items]
    assert commands == [TAKEOFF, SPEED, MOUNT, *[WAYPOINT, PICTURE] * len(flown), RETURN]
    # Places are in the frame of heights over home (3); the others are commands without a place (2).
    for item in items:
        assert item["frame"] == (3 if item["command"] in (TAKEOFF, WAYPOINT) else 2)


def test_waypoints_are_the_nominal_captures(tmp_path):
    flown, meant = worked_out(IN_WIND), worked_out(HERE)
    exported = write_plan(flown, tmp_path / "field.plan")
    items = read(tmp_path / "field.plan")["mission"]["items"]
    places = [item["params"] for item in items if item["command"] == WAYPOINT]
    assert [tuple(params[4:6]) for params in places] == list(zip(meant.lat_deg.tolist(), meant.lon_deg.tolist()))
    assert {(params[0], params[3], params[6]) for params in places} == {(0, 330.0, 120.0)}
    speed, mount = items[1]["params"], items[2]["params"]
    assert speed[:3] == [1, 15.0, -1]  # over ground; the throttle stays
    assert mount == [-70.0, 0, 0, 0, 0, 0, 2]  # targeted by MAVLink
    assert {tuple(item["params"][:3]) for item in items if item["command"] == PICTURE} == {(0, 0, 1)}
    assert "wind is left out" in exported.notes[0]
    assert "heights above ground only" in exported.notes[-1]


def test_over_relief_it_is_said_what_ground_heights_are_worked_out_for(tmp_path):
    area = Box(35.1555, -89.896, 35.154, -89.894)
    mission = HERE.replace(area=area, agl_m=60.0, elevation=("world",), takeoff=(35.1545, -89.895), tilt_deg=0.0)
    flown = plan(mission, PixelGrid(), mission_heights(mission, SourceOptions()))
    (note,) = write_plan(flown, tmp_path / "field.plan").notes
    assert note == (
        f"heights are above the take-off point, computed for ground at {flown.path.base_m:.1f} m above the ellipsoid "
        "there"
    )


def test_home_is_below_the_first_waypoint(tmp_path):
    flown = worked_out(HERE.replace(ground_height_m=80.0))
    write_plan(flown, tmp_path / "field.plan")
    home = read(tmp_path / "field.plan")["mission"]["plannedHomePosition"]
    assert home == [flown.lat_deg[0], flown.lon_deg[0], 80.0]


#: Parameters that ArduPilot lets be no number, by command: AP_Mission::sanity_check_params.
MAY_BE_NULL = {16: {4}, 21: {4}, 22: {4}, 84: {4}, 85: {3, 4}}


def items_within(node):
    """Simple items at any depth."""
    if isinstance(node, dict):
        if node.get("type") == "SimpleItem":
            yield node
        node = list(node.values())
    if isinstance(node, list):
        for value in node:
            yield from items_within(value)


@pytest.mark.parametrize("ending", [".plan", ".survey.plan"])
@pytest.mark.parametrize("trigger", ["waypoint", "distance", "hover"])
def test_ardupilot_takes_every_parameter(tmp_path, ending, trigger):
    mission = SURVEY.replace(trigger=trigger, takeoff=(47.39, 8.49), turnaround_m=20.0)
    (path,) = write_plan(worked_out(mission), tmp_path / f"field{ending}").files
    items = list(items_within(read(path)))
    null = [
        (item["command"], number)
        for item in items
        for number, value in enumerate(item["params"], 1)
        if value is None and number not in MAY_BE_NULL.get(item["command"], ())
    ]
    assert null == []
    # mavlink_int_to_mission_cmd: places, and heights below LOCATION_ALT_MAX_M.
    for item in items:
        if item["frame"] == 3:
            lat, lon, height = item["params"][4:]
            assert abs(lat) <= 90.0
            assert abs(lon) <= 180.0
            assert abs(height) < 83_000.0


def test_heights_that_ardupilot_refuses_are_refused(tmp_path):
    points = tuple((47.4, 8.5 + 0.01 * at, 83_000.0) for at in range(3))
    with pytest.raises(InvalidInput, match=r"at 83000 m: must be below 83000 m above the take-off"):
        write_plan(worked_out(Mission(Points(points), 83_000.0)), tmp_path / "field.plan")


@pytest.mark.thorough
def test_more_than_mavlink_counts_is_refused(tmp_path):
    flown = worked_out(HERE.replace(agl_m=10.0, tilt_deg=0.0, area=Box(35.19, -89.90, 35.15, -89.86)))
    assert len(flown) > 32_765
    with pytest.raises(InvalidInput, match="waypoints: takes 32,765 or fewer"):
        write_plan(flown, tmp_path / "field.plan")
    assert list(tmp_path.iterdir()) == []


def test_each_sortie_is_a_plan_from_the_takeoff(tmp_path):
    flown = worked_out(SURVEY.replace(ground_height_m=500.0))
    count = int(np.flatnonzero(flown.row == 3)[0])
    exported = write_plan(with_sorties(flown, count), tmp_path / "field.plan")
    assert [path.name for path in exported.files] == ["field-1.plan", "field-2.plan"]
    for path, captures in zip(exported.files, (count, len(flown) - count)):
        mission = read(path)["mission"]
        assert mission["plannedHomePosition"] == [47.39, 8.49, 430.0]
        commands = [item["command"] for item in mission["items"]]
        # A transit and a lead-in on the way there, a turn at the end.
        assert commands == [
            *(TAKEOFF, SPEED, MOUNT, WAYPOINT, WAYPOINT),
            *[WAYPOINT, PICTURE] * captures,
            *(WAYPOINT, RETURN),
        ]
        assert mission["items"][0]["params"][4:] == [47.39, 8.49, 120.0]


def test_distance_and_hovering_release_the_camera(tmp_path):
    flown = worked_out(SURVEY)
    by_distance = replace(flown, mission=flown.mission.replace(trigger="distance"))
    write_plan(by_distance, tmp_path / "field.plan")
    items = read(tmp_path / "field.plan")["mission"]["items"][3:-1]
    assert [item["command"] for item in items] == [WAYPOINT, 206, WAYPOINT, 206] * flown.rows
    taken = np.array(photos(items))
    assert GEOD.inv(taken[:, 1], taken[:, 0], flown.lon_deg, flown.lat_deg)[2].max() < 0.05
    write_plan(replace(flown, mission=flown.mission.replace(trigger="hover")), tmp_path / "field.plan")
    items = read(tmp_path / "field.plan")["mission"]["items"]
    assert {item["params"][0] for item in items if item["command"] == WAYPOINT} == {1.0}


def test_the_gimbal_is_turned_where_its_pitch_changes(tmp_path):
    poses = ((47.4, 8.5, 80.0), (47.4, 8.501, 80.0), (47.4, 8.502, 80.0))
    write_plan(worked_out(Mission(Points(poses, tilts_deg=(0.0, 30.0, 30.0)), 80.0)), tmp_path / "field.plan")
    items = read(tmp_path / "field.plan")["mission"]["items"]
    assert [(item["command"], item["params"][0]) for item in items if item["command"] in (MOUNT, PICTURE)] == [
        *((MOUNT, -90.0), (PICTURE, 0), (MOUNT, -60.0), (PICTURE, 0), (PICTURE, 0))
    ]
