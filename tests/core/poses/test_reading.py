"""Trajectories become poses: against rotations written down by hand, PROJ, and what exports write."""

from __future__ import annotations

import math
import re
import warnings

import numpy as np
import pytest
from pyproj import Transformer
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.errors import Cancelled, InvalidInput
from terrainav.core.exports.formats import export
from terrainav.core.exports.views import Views
from terrainav.core.fields import field_named
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.areas.coords import parse_coords
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.pose_table import table_text
from terrainav.core.poses.gpx import read_gpx
from terrainav.core.poses.reading import read_poses_file
from terrainav.core.poses.settings import LOCAL_FORMATS, PoseFile
from terrainav.core.poses.track import Track
from terrainav.core.poses.trajectories import BODIES, FORMATS, WORLDS, read_trajectory

from tests.support.command import command
from tests.support.sources import PatternSource

run = pytest.fixture(command, name="run")

ORIGIN = (35.16, -89.90, 80.0)
POSES = Points(
    ((35.1605, -89.9004, 120.0), (35.1612, -89.8991, 90.5), (35.162, -89.898, 150.25)),
    (10.0, 120.0, -75.0),
    (0.0, 30.0, 55.0),
    (0.0, -12.0, 20.0),
)


def near(points: Points, wanted: Points, *, agl_m=1e-3, deg=1e-6) -> None:
    np.testing.assert_allclose(np.array(points.poses)[:, :2], np.array(wanted.poses)[:, :2], rtol=0.0, atol=1e-8)
    np.testing.assert_allclose(np.array(points.poses)[:, 2], np.array(wanted.poses)[:, 2], atol=agl_m)
    for name in ("yaw", "tilt", "roll"):
        np.testing.assert_allclose(points.stated_deg(name), wanted.stated_deg(name), atol=deg)


def test_a_trajectory_that_was_exported_is_flown_again(tmp_path, run):
    mission = Mission(POSES, 120.0, frame="camera", image_px=48, image_format="png", accept_error=True)
    capture(plan(mission, PatternSource().grid), PatternSource(), tmp_path / "out")
    views = Views.read(tmp_path / "out")
    export(views, tmp_path / "tum", "tum")
    place = [repr(angle) for angle in (views.frame.lat_deg, views.frame.lon_deg)]
    said = run(
        *("poses", "read", str(tmp_path / "tum" / "trajectory.txt"), "--format", "tum", "--origin", *place),
        *("--output", "poses.csv"),
    )
    assert said.stdout == "3 poses in poses.csv\n"
    near(parse_coords(str(tmp_path / "poses.csv"))[0], POSES)


@pytest.mark.parametrize(
    ("world", "body", "quaternion", "attitude"),
    [
        # A camera that looks straight down, its top to the north: right is east, down is south, forward is down.
        ("enu", "camera", (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        # An aircraft that flies level to the north, with a camera that looks down.
        ("ned", "frd", (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        # To the east, by a turn of 90 degrees about down; and its nose up by 20, which lifts the view ahead.
        ("ned", "frd", (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)), (90.0, 0.0, 0.0)),
        ("ned", "frd", (math.cos(math.radians(10)), 0.0, math.sin(math.radians(10)), 0.0), (0.0, 20.0, 0.0)),
        # Its right wing down by 15.
        (
            "ned",
            "frd",
            (math.cos(math.radians(7.5)), math.sin(math.radians(7.5)), 0.0, 0.0),
            (0.0, 0.0, 15.0),
        ),
        # Forward, left, up, which looks east where nothing is turned.
        ("enu", "flu", (1.0, 0.0, 0.0, 0.0), (90.0, 0.0, 0.0)),
    ],
)
def test_axes_are_those_that_are_said(world, body, quaternion, attitude):
    w, x, y, z = quaternion
    up = "-40" if world == "ned" else "40"
    track = read_trajectory(f"# t x y z\n\n5.5 0 0 {up} {x} {y} {z} {w}\n", "tum", ORIGIN, body=body, world=world)
    points, left_out = track.points()
    assert left_out == 0
    assert points.times_s == (5.5,)
    np.testing.assert_allclose(points.poses[0], (*ORIGIN[:2], 40.0), atol=1e-6)
    found = [points.stated_deg(name)[0] for name in ("yaw", "tilt", "roll")]
    np.testing.assert_allclose(found, attitude, atol=1e-5)


def test_euroc_and_kitti_have_the_same_poses_as_tum():
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    w = math.sqrt(1.0 + np.trace(turn)) / 2.0
    x, y, z = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / (4.0 * w)
    tum = read_trajectory(f"1.25 10 20 30 {x} {y} {z} {w}", "tum", ORIGIN, world="enu")
    euroc = read_trajectory(
        f"#timestamp [ns],p_RS_R_x [m]\n1250000000,10,20,30,{w},{x},{y},{z}\n", "euroc", ORIGIN, body="camera"
    )
    rows = np.column_stack([turn, (10.0, 20.0, 30.0)]).ravel()
    kitti = read_trajectory(" ".join(map(str, rows)), "kitti", ORIGIN, world="enu")
    assert tum.time_s == euroc.time_s == [1.25]
    assert kitti.time_s is None
    for one in (euroc, kitti):
        for mine, theirs in zip(
            (one.lat_deg, one.lon_deg, one.height_m, *one.attitude_deg),
            (
                tum.lat_deg,
                tum.lon_deg,
                tum.height_m,
                *tum.attitude_deg,
            ),
        ):
            np.testing.assert_allclose(mine, theirs, atol=1e-9)
    # PROJ's own way from metres about a place to degrees.
    to_cart = Transformer.from_pipeline(
        "+proj=pipeline +step +inv +proj=topocentric +ellps=WGS84 +lat_0=35.16 +lon_0=-89.9 +h_0=80 "
        "+step +inv +proj=cart +ellps=WGS84 +step +proj=unitconvert +xy_in=rad +xy_out=deg"
    )
    lon, lat, height = to_cart.transform(10.0, 20.0, 30.0)
    np.testing.assert_allclose((tum.lat_deg[0], tum.lon_deg[0], tum.height_m[0]), (lat, lon, height), atol=1e-9)


def test_the_unit_of_euroc_is_mounted_as_its_calibration_says():
    # T_BS of the left camera, from the published sensor.yaml: columns are its right, down and forward in the unit.
    published = np.array(
        [
            [0.0148655429818, -0.999880929698, 0.00414029679422],
            [0.999557249008, 0.0149672133247, 0.025715529948],
            [-0.0257744366974, 0.00375618835797, 0.999660727178],
        ]
    )
    right, down, forward = published.T
    np.testing.assert_allclose(BODIES["urf"], (right, -down, forward), atol=0.03)


def test_a_long_way_turns_with_the_ground():
    # A camera that keeps its attitude in the frame looks ever less straight down where the ground curves away.
    text = "0 0 0 100 1 0 0 0\n1 0 0 100 1 0 0 0\n2 0 111000 100 1 0 0 0\n"
    track = read_trajectory(text, "tum", ORIGIN)
    yaw, tilt, _ = track.attitude_deg
    assert np.abs(np.array((yaw, tilt))[:, :2]).max() < 1e-4
    # The frame's down is ahead of the place's own down, seen by a camera whose top is north.
    assert tilt[2] == pytest.approx(track.lat_deg[2] - ORIGIN[0], abs=1e-6)
    assert track.height_m[2] > 1_000.0


def test_what_is_read_is_offered():
    assert LOCAL_FORMATS == FORMATS
    assert tuple(field_named(PoseFile, "body").choices) == tuple(BODIES)
    assert tuple(field_named(PoseFile, "world").choices) == tuple(WORLDS)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("poses.txt", "".join(f"{at} 0 0 90 1 0 0 0\n" for at in range(20_000))),
        ("way.gpx", "<gpx>" + '<trkpt lat="35.16" lon="-89.9"/>' * 10_000 + "</gpx>"),
    ],
)
def test_reading_says_how_far_it_is_and_can_be_stopped(tmp_path, name, text):
    pytest.importorskip("lxml")
    path = tmp_path / name
    path.write_text(text)
    how = PoseFile(agl_m=90.0) if name.endswith(".gpx") else PoseFile("tum", ORIGIN)
    shares = []
    read = read_poses_file(path, how, progress=lambda share: shares.append(share) is None)
    assert len(read.points.poses) == read.positions == text.count("\n") + text.count("<trkpt")
    assert shares == sorted(shares)
    assert 0.8 < shares[-1] <= 1.0
    asked = []
    with pytest.raises(Cancelled):
        read_poses_file(path, how, progress=lambda share: asked.append(share) is not None)
    assert len(asked) == 1


def test_kitti_looks_north_where_its_world_does():
    # The first camera looks level to the north: right is east.
    points, _ = read_trajectory("1 0 0 0 0 1 0 -50 0 0 1 7", "kitti", ORIGIN).points()
    lat, lon, agl = points.poses[0]
    assert agl == pytest.approx(50.0, abs=1e-4)
    # Seven metres on, the level is another, by so many degrees.
    assert points.tilts_deg[0] == pytest.approx(90.0 - (lat - ORIGIN[0]), abs=1e-5)
    assert (lat - ORIGIN[0]) * 110_950 == pytest.approx(7.0, abs=0.02)
    assert lon == ORIGIN[1]


GPX = """<?xml version="1.0"?><gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1"><trk><trkseg>
<trkpt lat="35.16" lon="-89.90"><ele>200</ele><time>2024-06-21T10:30:00Z</time></trkpt>
<trkpt lat="35.17" lon="-89.90"><ele>210</ele><time>2024-06-21T10:30:10.5Z</time></trkpt></trkseg><trkseg>
<trkpt lat="35.17" lon="-89.88"><ele>205.5</ele><time>2024-06-21T10:30:30Z</time></trkpt>
</trkseg></trk></gpx>"""


def test_gpx_looks_along_its_way(tmp_path, run):
    pytest.importorskip("lxml")
    (tmp_path / "way.gpx").write_text(GPX)
    assert run("poses", "read", "way.gpx", "--ground-height", "80", "--output", "p.csv").returncode == 0
    points, _ = parse_coords(str(tmp_path / "p.csv"))
    assert points.poses == ((35.16, -89.9, 120.0), (35.17, -89.9, 130.0), (35.17, -89.88, 125.5))
    assert np.diff(points.times_s).tolist() == [10.5, 19.5]
    assert points.times_s[0] == 1718965800.0
    # North, then east; the last one as the leg behind it.
    np.testing.assert_allclose(points.yaws_deg, (0.0, 89.99, 89.99), atol=0.01)
    assert points.tilts_deg == ()
    refused = run("poses", "read", "way.gpx", "--output", "q.csv")
    assert refused.returncode != 0
    assert "does not say how high its ground is; give that" in refused.stderr


def test_a_flight_of_a_gpx_is_captured_with_its_times(tmp_path, run):
    pytest.importorskip("lxml")
    (tmp_path / "way.gpx").write_text(GPX)
    read = run("poses", "read", "way.gpx", "--agl", "90", "--every-s", "15", "--output", "p.csv")
    assert read.stdout == "2 poses in p.csv\n"
    run("capture", "--coords", "p.csv", "--image-px", "32", "--quiet", "--data-dir", "out")
    table = Table.load(tmp_path / "out" / "satellite" / "meta_data.csv")
    assert table.time_utc == ("2024-06-21T10:30:00.000Z", "2024-06-21T10:30:30.000Z")
    assert set(table.agl_m) == {90.0}
    refused = run("capture", "--coords", "way.gpx", "--data-dir", "other")
    assert "a trajectory or a flight log; make a table of poses from it (terrainav poses read)" in refused.stderr


def test_one_who_stands_looks_where_he_went(tmp_path):
    lat = np.array([1.0, 1.0, 1.0, 1.0, 1.001])
    lon = np.array([2.0, 2.0, 2.001, 2.001, 2.001])
    points, _ = Track(lat, lon, np.full(5, 9.0)).points(0.0)
    np.testing.assert_allclose(points.yaws_deg, (90.0, 90.0, 90.0, 0.0, 0.0), atol=0.01)
    still, _ = Track(lat[:2], lon[:2], np.full(2, 9.0)).points(0.0)
    assert still.yaws_deg == (0.0, 0.0)


def test_a_track_may_start_anew_and_be_kept_level():
    ones = np.ones(2)
    track = Track(ones, ones, ones, 0.0, np.array([5.0, 7.5]), (10.0 * ones, 20.0 * ones, 30.0 * ones))
    points, _ = track.starting(1_000.0).nadir().points()
    assert points.times_s == (1_000.0, 1_002.5)
    assert (points.yaws_deg, points.tilts_deg, points.rolls_deg) == ((10.0, 10.0), (0.0, 0.0), (0.0, 0.0))


def test_positions_are_thinned_by_time_and_by_way():
    count = 101
    track = Track(np.full(count, 0.0), np.arange(count) * 1e-4, np.full(count, 50.0), 0.0, np.arange(count) * 0.1)
    assert np.diff(track.thinned(every_s=0.3).time_s).tolist() == pytest.approx([0.3] * 33)
    # 11.13 m each.
    by_way = track.thinned(every_m=20.0)
    assert np.diff(by_way.lon_deg).tolist() == pytest.approx([2e-4] * 50)
    climbing = Track(np.zeros(4), np.zeros(4), np.array([0.0, 10.0, 20.0, 35.0]), 0.0)
    assert climbing.thinned(every_m=20.0).height_m.tolist() == [0.0, 20.0]
    # What stands on the ground is left out before.
    points, left_out = climbing.points(every_m=20.0)
    assert ([agl for _, _, agl in points.poses], left_out) == ([10.0, 35.0], 1)
    with pytest.raises(InvalidInput, match="interval of 0 m: must be above 0"):
        track.thinned(every_m=0)
    with pytest.raises(InvalidInput, match=r"has no times; give one in metres \(--every-m\)"):
        Track(track.lat_deg, track.lon_deg, track.height_m).thinned(every_s=1.0)


def test_what_stands_on_the_ground_is_left_out():
    track = Track(np.array([1.0, 1.1, 1.2]), np.zeros(3), np.array([10.0, 40.0, 12.0]), 11.0)
    points, left_out = track.points()
    assert (left_out, [agl for _, _, agl in points.poses]) == (1, [29.0, 1.0])
    assert [agl for _, _, agl in track.points(agl_m=70.0)[0].poses] == [70.0] * 3
    with pytest.raises(InvalidInput, match="none of its 3 positions is above the ground"):
        track.points(90.0)


def test_tables_are_read_as_they_are_written(tmp_path):
    timed = Points(POSES.poses, POSES.yaws_deg, POSES.tilts_deg, POSES.rolls_deg, (0.5, 1.0, 2.25))
    for points in (POSES, timed, Points(POSES.poses)):
        (tmp_path / "poses.csv").write_text(table_text(points))
        assert parse_coords(str(tmp_path / "poses.csv"))[0] == points


#: Times (s) of a flight; those of EuRoC are in nanoseconds.
CLOCK_S = 1_403_636_579.75 + 0.05 * np.arange(200)


def timed(form, numbers):
    rows = (f"{number} {at / 10} 0 90 1 0 0 0" for at, number in enumerate(numbers))
    text = "\n".join(rows)
    return text.replace(" ", ",") if form == "euroc" else text


@pytest.mark.parametrize(
    ("form", "numbers", "unit", "said"),
    [
        (
            "euroc",
            CLOCK_S,
            "s",
            "its 200 times are all within 9.95e-09 s; they are probably not in nanoseconds",
        ),
        ("euroc", 1e3 * CLOCK_S, "ms", "its 200 times are all within 9.95e-06 s"),
        ("euroc", 0.05 * np.arange(200), "s", "its 200 times are all within 9.95e-09 s"),
        ("tum", 1e9 * CLOCK_S, "ns", "are not of 1990 to 2099; they are probably not in seconds"),
        ("tum", 1e3 * CLOCK_S, "ms", "are not of 1990 to 2099; they are probably not in seconds"),
        ("tum", 1e6 * (CLOCK_S - CLOCK_S[0] + 100.0), "us", "are not of 1990 to 2099"),
        ("tum", CLOCK_S - CLOCK_S[0] - 1.0, None, "are not of 1990 to 2099"),
        ("tum", np.full(3, 1_403_636_579.0), None, "its 3 times are all within 0 s"),
    ],
)
def test_a_clock_in_another_unit_is_refused_until_it_is_named(form, numbers, unit, said):
    text = timed(form, numbers.tolist())
    with pytest.raises(InvalidInput) as refused:
        read_trajectory(text, form, ORIGIN, body="flu")
    assert said in str(refused.value)
    assert str(refused.value).endswith("; give their unit, or leave them out (--times)")
    assert read_trajectory(text, form, ORIGIN, body="flu", times="none").time_s is None
    if unit is not None:
        found = read_trajectory(text, form, ORIGIN, body="flu", times=unit).time_s
        np.testing.assert_allclose(np.diff(found), 0.05, atol=1e-5)


def test_clocks_that_flights_have_are_read():
    for form, numbers in (
        ("tum", CLOCK_S),
        ("tum", [0.0, 1.0]),
        ("tum", [604_799.0, 604_801.5]),
        ("tum", [12.25]),
        ("euroc", 1e9 * CLOCK_S),
        ("euroc", [100_000_000_000, 101_000_000_000]),
    ):
        track = read_trajectory(timed(form, list(numbers)), form, ORIGIN, body="flu")
        np.testing.assert_allclose(track.time_s, np.array(numbers) * (1e-9 if form == "euroc" else 1.0))


def test_a_burst_has_dates_and_a_unit_that_is_named():
    burst = timed("euroc", (1e9 * CLOCK_S[:5]).tolist())
    with pytest.raises(InvalidInput, match=r"are all within 0.2 s"):
        read_trajectory(burst, "euroc", ORIGIN, body="flu")
    assert len(read_trajectory(burst, "euroc", ORIGIN, body="flu", times="ns")) == 5
    with pytest.raises(InvalidInput, match=r"are all within 0.0002 s; they are probably not in milliseconds"):
        read_trajectory(timed("tum", [0.1, 0.2, 0.3]), "tum", ORIGIN, times="ms")


def test_euroc_in_seconds_is_flown_once_its_unit_is_named(tmp_path, run):
    (tmp_path / "e.csv").write_text(timed("euroc", CLOCK_S.tolist()))
    read = (
        "poses",
        "read",
        "e.csv",
        "--format",
        "euroc",
        "--body",
        "flu",
        "--origin",
        "35",
        "0",
        "--output",
        "p.csv",
    )
    assert run(*read).returncode == 2
    assert run(*read, "--times", "s").returncode == 0
    np.testing.assert_allclose(parse_coords(str(tmp_path / "p.csv"))[0].times_s, CLOCK_S, atol=1e-6)
    said = run("poses", "read", "e.gpx", "--times", "s", "--output", "p.csv").stderr
    assert "unit of times s: is for tum, euroc, and not for gpx" in said


def test_points_without_a_time_are_left_out_where_others_have_one(tmp_path, run):
    pytest.importorskip("lxml")
    (tmp_path / "way.gpx").write_text(GPX.replace("<time>2024-06-21T10:30:10.5Z</time>", ""))
    read = ("poses", "read", "way.gpx", "--ground-height", "80", "--output", "p.csv")
    assert run(*read).stdout == "2 poses in p.csv\n1 of 3 positions left out, without a time\n"
    points, _ = parse_coords(str(tmp_path / "p.csv"))
    assert points.poses == ((35.16, -89.9, 120.0), (35.17, -89.88, 125.5))
    assert run(*read, "--times", "none").stdout == "3 poses in p.csv\n"
    assert parse_coords(str(tmp_path / "p.csv"))[0].times_s == ()


def test_dates_of_a_receiver_without_a_fix_are_refused():
    pytest.importorskip("lxml")
    for body, said in (
        (GPX.replace("2024-06-21", "1980-01-06"), "are not of 1990 to 2099"),
        (re.sub(r"<time>[^<]*", "<time>2024-01-06T00:00:00Z", GPX), "its 3 times are all within 0 s"),
    ):
        with pytest.raises(InvalidInput, match=said):
            read_gpx(body.encode())
        assert read_gpx(body.encode(), with_times=False).time_s is None


def test_numbers_are_of_plain_digits():
    for wrong in ("1_20", "\u0661", "0x1"):
        with pytest.raises(InvalidInput, match="must be 8 numbers"):
            read_trajectory(f"0 {wrong} 0 90 1 0 0 0\n", "tum", ORIGIN)
    with pytest.raises(InvalidInput, match="must be a number"):
        read_gpx(b'<gpx><trkpt lat="1_20" lon="1"/></gpx>')


@pytest.mark.parametrize(
    ("form", "text", "said"),
    [
        ("tum", "", "holds no poses"),
        ("tum", "1 2 3\n", "line 1: '1 2 3': must be 8 numbers"),
        ("tum", "1 0 0 0 0 0 0 2\n", "the quaternion of pose 1 has the length 2, and not 1"),
        ("tum", "2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", "its times go back at pose 2"),
        ("tum", "1 0 0 nan 0 0 0 1\n", "must be 8 numbers"),
        ("kitti", "1 0 0 0 0 2 0 0 0 0 1 0\n", "pose 1 is not a rotation"),
        ("kitti", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 -1 0\n", "pose 2 is not a rotation"),
        ("euroc", "1,0,0,0,1,0,0,0\n", "give --body: urf"),
    ],
)
def test_what_cannot_be_read_is_named(form, text, said):
    with pytest.raises(InvalidInput) as refused:
        read_trajectory(text, form, ORIGIN)
    assert said in str(refused.value)


def test_files_that_are_no_tracks_are_refused(tmp_path, run):
    pytest.importorskip("lxml")
    for name, body, said in (
        ("a.gpx", "no XML", "cannot be read as GPX"),
        ("b.gpx", "<gpx/>", "has no track points and no route points"),
        ("c.gpx", '<gpx><trkpt lat="a" lon="1"/></gpx>', "point 1: 'a': must be a number"),
        ("d.gpx", '<!DOCTYPE g [<!ENTITY a "b">]><gpx/>', "a document type or entities"),
        (
            "f.gpx",
            GPX.replace("<ele>210</ele>", ""),
            "position 2 has no height; give one height above ground (--agl)",
        ),
        ("e.txt", "1 2 3", "its ending does not tell its format; give --format"),
    ):
        (tmp_path / name).write_text(body)
        refused = run("poses", "read", name, "--ground-height", "80", "--output", "q.csv")
        assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
        assert said in refused.stderr
    (tmp_path / "way.gpx").write_text(GPX)
    (tmp_path / "bytes.txt").write_bytes(b"1 \xff")
    for options, said in (
        (("e.txt", "--format", "tum"), "say where its origin lies (--origin LAT LON [HEIGHT])"),
        (("b.gpx", "--body", "frd"), "are for tum, kitti, euroc"),
        (("e.txt", "--format", "tum", "--origin", "95", "0"), "latitude 95.0: must be within"),
        (("way.gpx", "--agl", "0"), "height above ground 0.0 m: must be above 0"),
        (("b.gpx", "--agl", "9", "--start", "noon"), "--start time 'noon': must be as 2024"),
        (("gone.gpx",), "no such file"),
        (
            ("bytes.txt", "--format", "tum", "--origin", "35", "0"),
            "trajectory bytes.txt: cannot be read (not UTF-8: byte 2 is invalid)",
        ),
    ):
        assert said in run("poses", "read", *options, "--output", "q.csv").stderr
    with pytest.raises(InvalidInput, match="its times go back at point 2"):
        read_gpx(GPX.replace("10:30:10.5Z", "09:00:00Z").encode())


LEVEL_TUM = "0 0 0 100 0 0 0 1\n"


@pytest.mark.parametrize(
    ("line", "options", "said"),
    [
        (
            "1e308 0 0 100 0 0 0 1",
            (),
            "its times, as seconds from 1e+308 to 1e+308, are not of 1990 to 2099; they are probably",
        ),
        ("0 0 0 100 1e200 0 0 0", (), "the quaternion of pose 1 has the length inf, and not 1"),
        ("0 1e300 0 100 0 0 0 1", (), "pose 1 must be within 1e+09 m of the origin"),
        (LEVEL_TUM, ("--agl", "nan"), "height above ground nan m: must be above 0"),
        (LEVEL_TUM, ("--ground-height", "nan"), "ground height nan m: must be from"),
        (LEVEL_TUM, ("--origin", "0", "0", "inf"), "ground height inf m: must be from"),
        (LEVEL_TUM, ("--output", ""), "folder .: cannot write  (Is a directory)"),
        (LEVEL_TUM, ("--output", "x" * 300), "File name too long"),
    ],
)
def test_numbers_beyond_measure_are_refused_in_one_line(tmp_path, run, line, options, said):
    (tmp_path / "t.txt").write_text(line)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        refused = run(
            *("poses", "read", "t.txt", "--format", "tum", "--origin", "35", "0", "--output", "q.csv"),
            *options,
        )
    assert (refused.returncode in (2, 3), refused.stderr.count("\n"), refused.stdout) == (True, 1, "")
    assert said in refused.stderr
    assert not (tmp_path / "q.csv").exists()


def test_a_matrix_beyond_measure_is_no_rotation():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(InvalidInput, match="pose 1 is not a rotation"):
            read_trajectory("1e200 0 0 0 0 1 0 0 0 0 1 0", "kitti", ORIGIN)


@pytest.mark.parametrize("interval", [5e-324, 1e-300, 1e-9])
def test_intervals_too_short_to_be_added_keep_every_position(interval):
    at = np.array([5.0, 5.0, 6.0, 9.0])
    track = Track(at, at, at + 100.0, 0.0, at)
    assert track.thinned(every_s=interval).time_s.tolist()[-3:] == [5.0, 6.0, 9.0]


def test_a_name_too_long_for_a_file_is_none(run):
    refused = run("poses", "read", "x" * 300 + ".gpx", "--output", "q.csv")
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert "no such file" in refused.stderr
