"""Litchi's table: its columns and codes as its Mission Hub writes them, and the limits of DJI's drones."""

from __future__ import annotations

import csv
import re

import numpy as np
import pytest
from pyproj import Geod
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.areas.coords import parse_coords
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.mission import Mission
from terrainav.core.poses.reading import likely_format, read_poses_file
from terrainav.core.poses.settings import PoseFile

from tests.core.mission.flights import ALONE, HERE, IN_WIND, worked_out
from tests.support.thinning import sampled

# As in a file from the Mission Hub, in metric units.
PUBLISHED = (
    "latitude,longitude,altitude(m),heading(deg),curvesize(m),rotationdir,gimbalmode,gimbalpitchangle,actiontype1,"
    "actionparam1,actiontype2,actionparam2,actiontype3,actionparam3,actiontype4,actionparam4,actiontype5,actionparam5,"
    "actiontype6,actionparam6,actiontype7,actionparam7,actiontype8,actionparam8,actiontype9,actionparam9,actiontype10,"
    "actionparam10,actiontype11,actionparam11,actiontype12,actionparam12,actiontype13,actionparam13,actiontype14,"
    "actionparam14,actiontype15,actionparam15,altitudemode,speed(m/s),poi_latitude,poi_longitude,poi_altitude(m),"
    "poi_altitudemode,photo_timeinterval,photo_distinterval"
)
NUMBER = r"-?\d+(\.\d+)?"
LINE = re.compile(
    rf"{NUMBER},{NUMBER},{NUMBER},\d+(\.\d+)?,\d+(\.\d+)?,[01],[012],{NUMBER},((-1|[0-5]),{NUMBER},){{15}}[01],"
    rf"\d+(\.\d+)?,{NUMBER},{NUMBER},{NUMBER},[01],{NUMBER},{NUMBER}"
)
MANY = HERE.replace(area=Box(35.2, -89.92, 35.15, -89.88))


def rows(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_each_waypoint_takes_one_picture_above_ground(tmp_path):
    flown = worked_out(HERE)
    exported = write_plan(flown, tmp_path / "field.litchi.csv")
    assert exported.files == (tmp_path / "field.litchi.csv",)
    header, *lines = (tmp_path / "field.litchi.csv").read_text().splitlines()
    assert header == PUBLISHED
    assert all(LINE.fullmatch(line) for line in lines)
    table = rows(tmp_path / "field.litchi.csv")
    assert len(table) == len(flown) <= 99
    for row, lat, lon in zip(table, flown.lat_deg, flown.lon_deg):
        assert float(row["latitude"]) == pytest.approx(lat, abs=5.1e-9)
        assert float(row["longitude"]) == pytest.approx(lon, abs=5.1e-9)
        wanted = {
            "altitude(m)": 120.0,
            "altitudemode": 1,
            "heading(deg)": 330.0,
            "gimbalmode": 2,
            "gimbalpitchangle": -70.0,
            "actiontype1": 1,
            "actionparam1": 0,
            "speed(m/s)": 15.0,
            "photo_timeinterval": -1,
            "photo_distinterval": -1,
        }
        assert {name: float(row[name]) for name in wanted} == wanted
        assert {row[f"actiontype{number}"] for number in range(2, 16)} == {"-1"}
    (note,) = exported.notes
    assert "Heading Mode to Custom" in note


def test_numbers_near_zero_have_no_exponent(tmp_path):
    write_plan(
        worked_out(Mission(Points(((1e-7, -1e-7, 50.0), (0.001, 0.0, 50.0))), 50.0)),
        tmp_path / "n.litchi.csv",
    )
    assert all(LINE.fullmatch(line) for line in (tmp_path / "n.litchi.csv").read_text().splitlines()[1:])


def test_a_heading_is_not_rounded_to_360(tmp_path):
    path = tmp_path / "n.litchi.csv"
    write_plan(worked_out(HERE.replace(yaw_deg=-0.001)), path)
    assert {row["heading(deg)"] for row in rows(path)} == {"0.00"}


def test_long_flights_come_in_parts_of_99_or_fewer(tmp_path):
    flown = worked_out(MANY)
    exported = write_plan(flown, tmp_path / "big.litchi.csv")
    names = [file.name for file in exported.files]
    count = -(-len(flown) // 99)
    assert count > 2
    assert names == [f"big-{number}.litchi.csv" for number in range(1, count + 1)]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)
    tables = [rows(file) for file in exported.files]
    sizes = [len(table) for table in tables]
    assert max(sizes) <= 99
    assert max(sizes) - min(sizes) <= 1
    flat = [float(row["longitude"]) for table in tables for row in table]
    assert flat == pytest.approx(flown.lon_deg.tolist(), abs=5.1e-9)
    assert exported.notes[0] == f"{count} parts of one flight, big-1.litchi.csv to big-{count}.litchi.csv"


@pytest.mark.parametrize(("poses", "sizes"), [(99, [99]), (100, [50, 50]), (198, [99, 99]), (199, [66, 66, 67])])
def test_sizes_of_the_parts(tmp_path, poses, sizes):
    places = tuple((10.0 + index * 1e-3, 20.0, 100.0) for index in range(poses))
    exported = write_plan(worked_out(Mission(Points(places), 100.0)), tmp_path / "p.litchi.csv")
    assert [len(rows(file)) for file in exported.files] == sizes


@pytest.mark.parametrize(
    ("mission", "says"),
    sampled(
        [
            (ALONE, "of one waypoint: takes two or more"),
            (HERE.replace(agl_m=501.0, area=Box(35.2, -90.0, 35.15, -89.9)), "at 501 m: must be 500 m"),
            (
                HERE.replace(tilt_deg=121.0, camera=Camera(150.0)),
                "lifted to 31 deg: must be -90 to 30, a tilt of 120 or less",
            ),
            (HERE.replace(agl_m=10.0, area=Box(35.17, -89.90, 35.15, -89.88)), "waypoints: takes 9,999 or fewer"),
        ],
        2,
    ),
)
def test_what_no_drone_would_take_is_refused(tmp_path, mission, says):
    with pytest.raises(InvalidInput, match=says):
        write_plan(worked_out(mission), tmp_path / "n.litchi.csv")
    assert list(tmp_path.iterdir()) == []


def test_what_the_file_cannot_say_is_told(tmp_path):
    mission = IN_WIND.replace(roll_deg=4.0, airspeed_m_per_s=22.0)
    notes = " | ".join(write_plan(worked_out(mission), tmp_path / "n.litchi.csv").notes)
    assert "the roll of 4 deg is left out" in notes
    assert "wind is left out" in notes
    assert "speed of 22 m/s is reduced to Litchi's 15 m/s" in notes
    assert {row["speed(m/s)"] for row in rows(tmp_path / "n.litchi.csv")} == {"15.00"}


def test_part_of_a_flight_is_not_left_behind(tmp_path):
    (tmp_path / "big-2.litchi.csv").mkdir()
    with pytest.raises(OutputError, match=r"big-2\.litchi\.csv"):
        write_plan(worked_out(MANY), tmp_path / "big.litchi.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["big-2.litchi.csv"]


# --- read back


@pytest.mark.parametrize("trigger", ["waypoint", "hover", "distance"])
def test_the_file_is_read_back_as_its_images(tmp_path, trigger):
    mission = HERE.replace(
        takeoff=(35.153, -89.9), turnaround_m=25.0, trigger=trigger, area=Box(35.16, -89.90, 35.157, -89.895)
    )
    flown = worked_out(mission)
    (path,) = write_plan(flown, tmp_path / "field.litchi.csv").files
    points, agl_m = parse_coords(str(path))
    assert agl_m == pytest.approx(120.0)
    for found in (points, read_poses_file(path, PoseFile()).points):
        lat, lon, agl = np.array(found.poses).T
        # By distance, images are as far from each other as the centimetres of the file say.
        away = Geod(ellps="WGS84").inv(lon, lat, flown.lon_deg, flown.lat_deg)[2]
        assert away.max() < (0.5 if trigger == "distance" else 0.002)
        assert agl == pytest.approx(flown.agl_m, abs=0.006)
        assert found.yaws_deg == pytest.approx([330.0] * len(flown))
        assert found.tilts_deg == pytest.approx([20.0] * len(flown))


HUB = (
    "latitude,longitude,altitude({unit}),heading(deg),curvesize(m),rotationdir,gimbalmode,gimbalpitchangle,altitudemode"
)


def test_missions_of_the_hub_without_images_are_their_waypoints(tmp_path):
    path = tmp_path / "hub.csv"
    path.write_text(HUB.format(unit="ft") + "\n47.1,8.1,328.084,10,0,0,2,-60,1\n47.2,8.1,328.084,20,0,0,0,0,1\n")
    points, _ = parse_coords(str(path))
    assert points.poses == ((47.1, 8.1, pytest.approx(100.0)), (47.2, 8.1, pytest.approx(100.0)))
    assert points.yaws_deg == (10.0, 20.0)
    assert points.tilts_deg == (30.0, 0.0)
    assert likely_format(path) == "litchi"


def test_heights_above_the_take_off_are_no_heights_above_ground(tmp_path):
    path = tmp_path / "hub.csv"
    path.write_text(HUB.format(unit="m") + "\n47.1,8.1,100,10,0,0,2,-60,1\n47.2,8.1,100,20,0,0,0,0,0\n")
    with pytest.raises(InvalidInput, match=r"waypoint 2: its height of 100 m is above the take-off"):
        parse_coords(str(path))
    points, _ = parse_coords(str(path), agl_m=80.0)
    assert [pose[2] for pose in points.poses] == [80.0, 80.0]
    path.write_text(HUB.format(unit="m") + "\n47.1,x,100,10,0,0,2,-60,1\n")
    with pytest.raises(InvalidInput, match=r"waypoint 1: 'x': must be a number"):
        parse_coords(str(path))


@pytest.mark.parametrize(
    ("cells", "says"),
    [
        (("0.0000001", ""), r"waypoint 1: images each 1e-07 m: must be [\d,]+ in all or fewer"),
        (("x" * 200_000, ""), "cannot be read as a table"),
    ],
)
def test_what_no_camera_could_take_is_refused(tmp_path, cells, says):
    lines = [f"47.{at},8.1,100,10,0,0,2,-60,1,{cell}" for at, cell in enumerate(cells, 1)]
    path = tmp_path / "hub.csv"
    path.write_text("\n".join([HUB.format(unit="m") + ",photo_distinterval", *lines, ""]))
    with pytest.raises(InvalidInput, match=says):
        parse_coords(str(path))
    path.write_text(
        "\n".join([HUB.format(unit="m") + ",photo_distinterval", *(one[: one.rindex(",") + 1] for one in lines), ""])
    )
    # Left empty, as by spreadsheets, no image is taken by distance.
    assert len(parse_coords(str(path))[0].poses) == 2
