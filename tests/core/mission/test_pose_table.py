"""Poses of a table: read by any of their names, each flown as it says, and written with their times."""

from __future__ import annotations

import csv
import json
from dataclasses import astuple, replace
from datetime import datetime, timezone

import numpy as np
import pytest
from PIL import Image
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.opening import SourceOptions
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.areas.coords import parse_coords
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights

from tests.support.command import command
from tests.support.sources import PatternSource
from tests.support.thinning import sampled

run = pytest.fixture(command, name="run")

BEGIN = datetime(2024, 6, 21, 10, 30, tzinfo=timezone.utc).timestamp()
POINTS = Points(
    ((35.16, -89.90, 120.0), (35.161, -89.899, 90.5), (35.162, -89.898, 150.0)),
    (0.0, 45.0, -90.0),
    (0.0, 30.0, 50.0),
    (5.0, 0.0, -7.5),
    (BEGIN, BEGIN + 1.25, BEGIN + 60.0),
)
SAME = {
    "usual.csv": "lat,lon,agl,yaw,tilt,roll,time\n"
    "35.16,-89.9,120,0,0,5,2024-06-21T10:30:00Z\n"
    "35.161,-89.899,90.5,45,30,0,2024-06-21T10:30:01.25Z\n"
    "35.162,-89.898,150,-90,50,-7.5,2024-06-21T10:31:00Z\n",
    "others.txt": "# a flight\n\nframe\tTimestamp\tHeading\tLongitude\tAltitude\tLatitude\tgimbal_pitch\tRoll_deg\n"
    f"a\t{BEGIN}\t0\t-89,9\t120\t35,16\t-90\t5\n"
    f"b\t{BEGIN + 1.25}\t45\t-89,899\t90,5\t35,161\t-60\t0\n"
    f"c\t{BEGIN + 60}\t\u221290\t-89,898\t150\t35,162\t-40\t-7,5\n",
    "zone.csv": '"lon";"lat";"time";"agl_m";"azimuth_deg";"off_nadir";"roll"\n'
    "-89,9;35,16;2024-06-21 12:30:00+02:00;120;0;0;5\n"
    "-89,899;35,161;2024-06-21 12:30:01,25+0200;90,5;45;30;0\n"
    "-89,898;35,162;2024-06-21T12:31+02:00;150;-90;50;-7,5\n",
    "spreadsheet.csv": "\ufeffsep=;\nnote;lat;lon;agl;yaw;tilt;roll;time\n"
    f'"of two\nlines";35,16;-89,9;120;0;0;5;{BEGIN:.0f},0\n'
    f'"a ""b""\n\n# c";35,161;-89,899;90,5;45;30;0;{BEGIN:.0f}\u002c25\n'.replace(
        f"{BEGIN:.0f},25", f"{BEGIN + 1:.0f},25"
    )
    + f"plain;35,162;-89,898;150;-90;50;-7,5;{BEGIN + 60:.0f}\n",
    "spaces.txt": "\ufefflat lon agl yaw tilt roll time\n"
    "35.16 -89.9 120 0 0 5 2024-06-21T10:30:00\n"
    "35.161 -89.899 90.5 45 30 0 2024-06-21T10:30:01.25\n"
    "35.162 -89.898 150 -90 50 -7.5 2024-06-21T10:31:00\n",
}


def read(tmp_path, text, *more, name="poses.csv"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return parse_coords(str(path), *more)


@pytest.mark.parametrize("name", SAME)
def test_columns_go_by_any_of_their_names_in_any_order(tmp_path, name):
    points, agl_m = read(tmp_path, SAME[name], name=name)
    assert points == POINTS
    assert agl_m == 120.0


def test_what_the_table_leaves_out_the_mission_says(tmp_path, run):
    points, _ = read(tmp_path, "lat lon agl\n35 -89 100\n35.1 -89 100\n")
    assert points == Points(((35.0, -89.0, 100.0), (35.1, -89.0, 100.0)))
    points, _ = read(tmp_path, "lat lon\n35 -89\n", None, "m", 80.0)
    assert points.poses == ((35.0, -89.0, 80.0),)
    points, _ = read(tmp_path, "lat lon agl\n35 -89 100\n36 -89 100\n", "single", "ft")
    assert points.poses == ((35.0, -89.0, 100.0 * 0.3048),)
    said = run("plan", "--coords", str(tmp_path / "poses.csv"), "--tilt", "20", "--output", "m.json").stdout
    assert "images                  2" in said
    assert Mission.load(tmp_path / "m.json").attitude.tilt_deg == 20.0


def test_the_tables_of_plans_and_datasets_are_flown_again(tmp_path):
    mission = Mission(POINTS, 120.0, image_format="png", image_px=48)
    worked_out = plan(mission, PatternSource().grid)
    write_plan(worked_out, tmp_path / "plan.csv")
    again, _ = parse_coords(str(tmp_path / "plan.csv"))
    assert again == POINTS
    capture(worked_out, PatternSource(), tmp_path / "out")
    again, _ = parse_coords(str(tmp_path / "out" / "satellite" / "meta_data.csv"))
    np.testing.assert_allclose(again.poses, POINTS.poses, rtol=1e-12)
    assert (again.yaws_deg, again.tilts_deg, again.times_s) == (
        POINTS.yaws_deg,
        POINTS.tilts_deg,
        POINTS.times_s,
    )


OVER_RELIEF = {"elevation": ("world",)}


# Over relief what looks far takes long.
@pytest.mark.parametrize(
    ("points", "relief"),
    sampled(
        [
            (POINTS, {}),
            (Points(*(column[:2] for column in astuple(POINTS))), OVER_RELIEF),
            pytest.param(POINTS, OVER_RELIEF, marks=pytest.mark.thorough),
        ],
        2,
    ),
    ids=["level", "relief", "relief seen from afar"],
)
def test_each_capture_is_what_a_mission_of_its_own_attitude_makes(points, relief):
    mission = Mission(points, 120.0, image_px=320, accept_error=True, frame="camera", **relief)
    # Over relief, how fine the heights are taken depends on all captures: 0.2 m, half a pixel.
    grid, within_deg = PixelGrid(), 2e-6 if relief else 1e-12
    worked_out = plan(mission, grid, mission_heights(mission, SourceOptions()) if relief else None)
    for index, pose in enumerate(points.poses):
        angles = {name: getattr(points, f"{name[:-4]}s_deg")[index] for name in ("yaw_deg", "tilt_deg", "roll_deg")}
        single = mission.replace(area=Points((pose,)), agl_m=pose[2], **angles)
        alone = plan(single, grid, mission_heights(single, SourceOptions()) if relief else None)
        assert all(values[index] == own[0] for values, own in zip(worked_out.poses, alone.poses))
        for corner, own in zip(worked_out.corners, alone.corners):
            np.testing.assert_allclose(corner[index], own[0], rtol=0.0, atol=within_deg)


def test_times_are_those_of_the_points(tmp_path):
    mission = Mission(POINTS, 120.0, image_px=64, image_format="jpg", airspeed_m_per_s=3.0)
    worked_out = plan(mission, PatternSource().grid)
    np.testing.assert_allclose(worked_out.times_s, [0.0, 1.25, 60.0])
    capture(worked_out, PatternSource(), tmp_path / "out")
    said = ["2024-06-21T10:30:00.000Z", "2024-06-21T10:30:01.250Z", "2024-06-21T10:31:00.000Z"]
    table = Table.load(tmp_path / "out" / "satellite" / "meta_data.csv")
    assert list(table.time_utc) == said
    with (tmp_path / "out" / "plan.csv").open(newline="") as file:
        assert [row["time_utc"] for row in csv.DictReader(file)] == said
    with Image.open(tmp_path / "out" / "satellite" / table.img_names[2]) as image:
        assert image.getexif().get_ifd(0x8769)[0x9003] == "2024:06:21 10:31:00"
    without = plan(mission.replace(area=replace(POINTS, times_s=())), PatternSource().grid)
    capture(without, PatternSource(), tmp_path / "without")
    header = (tmp_path / "without" / "satellite" / "meta_data.csv").read_text().splitlines()[0]
    assert "time_utc" not in header


def test_gusts_are_those_of_the_points_own_times():
    windy = Mission(POINTS, 120.0, wind=Wind(8.0, 270.0, 0.2), image_px=64)
    soon = replace(POINTS, times_s=(BEGIN, BEGIN + 1e-4, BEGIN + 2e-4))

    def offsets(points):
        worked_out = plan(windy.replace(area=points), PixelGrid())
        return worked_out.poses.agl_m - [agl for _, _, agl in POINTS.poses]

    # Within a tenth of a millisecond gusts have moved nothing; in a minute they are others.
    assert np.ptp(offsets(soon)[1:]) < 1e-3 < np.ptp(offsets(POINTS)[1:])


def test_mission_files_keep_them_and_stay_as_they_were_without(tmp_path):
    mission = Mission(POINTS, 120.0)
    mission.save(tmp_path / "mission.json")
    assert Mission.load(tmp_path / "mission.json") == mission
    area = json.loads(Mission(replace(POINTS, tilts_deg=(), rolls_deg=(), times_s=()), 120.0).to_json())["area"]
    assert set(area) == {"type", "poses", "yaws_deg"}
    with pytest.raises(InvalidInput, match=r"mission field 'area\.tilt'"):
        Mission.from_json(mission.to_json().replace("tilts_deg", "tilt"))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("lat lon agl\n", "holds no poses below its header"),
        ("lat agl\n1 2\n", "has no column lon, only lat, agl"),
        ("lat lon\n1 2\n", "has no column agl, only lat, lon"),
        ("lat latitude lon agl\n1 1 2 3\n", "columns lat latitude say the same"),
        ("lat lon lon agl\n1 2 2 3\n", "columns lon say the same"),
        ("lat lon agl tilt gimbal_pitch\n1 2 3 0 -90\n", "columns tilt gimbal_pitch say the same"),
        ("lat lon agl pitch\n1 2 3 0\n", "may count from the horizon or from straight down; name it tilt"),
        ("lat lon agl\n1 2 3\n1 2\n", "line 3: '1 2' has 2 cells; its header names 3"),
        ("lat,lon,agl\n1,2,3\n1,east,3\n", "line 3: lon 'east': must be a number"),
        ("lat,lon,agl\n91,2,3\n", "line 2: latitude 91"),
        ("lat,lon,agl,tilt\n1,2,3,190\n", "line 2: tilt 190"),
        ("lat,lon,agl,time\n1,2,3,noon\n", "line 2: time 'noon': must be as 2024-06-21T10:30:00Z"),
        ("lat,lon,agl,time\n1,2,3,2024-02-30T10:30:00Z\n", "line 2: time '2024-02-30T10:30:00Z'"),
        ("lat,lon,agl,time\n1,2,3,nan\n", "line 2: time nan of point 1"),
        (f"lat,lon,agl\n1,2,{'9' * 1000}x\n", f"line 2: agl '{'9' * 80}': must be a number"),
        (
            "lat,lon,agl\n1,2,3" + ",4" * 1000,
            f"line 2: '1,2,3{',4' * 37},' has 1003 cells; its header names 3",
        ),
        (f'lat,lon,agl\n1,2,"{"9" * 200_000}"\n', "line 2: height above ground inf m: must be at most"),
        ("lat,lon,agl,time\n1,2,3,20\n1,2,3,10\n", "time of point 2: is before that of the one before it"),
        ("lat,lon,agl\n1_20,2,3\n", "line 2: lat '1_20': must be a number"),
        ("lat,lon,agl\n1,\u0662,3\n", "line 2: lon '\u0662': must be a number"),
        ("lat,lon,agl,time\n1,2,3,1_20\n", "line 2: time '1_20': must be as 2024"),
        ('lat,lon,agl,note\n1,2,3,"a\nb"\n1,2,3\n', "line 4: '1,2,3' has 3 cells"),
        ('lat,lon,agl,note\n1,2,3,"a\n1,2,3,b\n', "line 2: has a quotation mark without another one"),
        # Longer than the csv module reads of one cell.
        (
            'lat,lon,agl,note\n1,2,3,"a\n' + 12_000 * "1,2,3,a longer note\n",
            "line 2: has a quotation mark without another one",
        ),
        (
            "lat,lon,agl,time\n1,2,3,0.1\n1,2,3,0.3\n",
            "its 2 times are all within 0.2 s; they are probably not in",
        ),
        (
            "lat,lon,agl,time\n1,2,3,1e8\n1,2,3,2e8\n",
            "are not of 1990 to 2099; they are probably not in seconds",
        ),
        (
            "lat,lon,agl,time\n1,2,3,1980-01-06T00:00:00Z\n",
            "are not of 1990 to 2099; give seconds after 1970",
        ),
    ],
)
def test_what_cannot_be_read_is_named(tmp_path, text, said):
    with pytest.raises(InvalidInput) as refused:
        read(tmp_path, text)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_cells_without_end_are_left_out(tmp_path):
    """As notes may be, beyond what the csv module reads of one."""
    points, _ = read(tmp_path, f"lat,lon,agl,note\n1,2,3,{'x' * 200_000}\n")
    assert points.poses == ((1.0, 2.0, 3.0),)
