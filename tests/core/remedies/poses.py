"""What refusals of trajectories, logs and random poses advise."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.areas.coords import parse_coords
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.inside import captured_points, poses_inside
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.pose_table import read_poses
from terrainav.core.poses.gpx import read_gpx
from terrainav.core.poses.logs import read_dataflash, read_ulog
from terrainav.core.poses.random_poses import Distribution, PoseDistributions, random_poses
from terrainav.core.poses.track import Track
from terrainav.core.poses.trajectories import read_trajectory

from tests.core.remedies.files import extra_brings
from tests.support.logs import dataflash, e7, us
from tests.support.remedies import Case, remedy

TUM = "0 0 0 90 1 0 0 0\n"
KITTI = "1 0 0 0 0 0 1 -90 0 -1 0 0\n1 0 0 0 0 0 1 -90 0 -1 0 50\n"
GPX = '<gpx><trkpt lat="35.16" lon="-89.9"><ele>200</ele></trkpt><trkpt lat="35.17" lon="-89.9"/></gpx>'
ORIGIN = ("--origin", "35.16", "-89.9")


def read(case: Case, *arguments: str) -> bool:
    return case.run("poses", "read", *arguments, "--output", "poses.csv").returncode == 0


def refused_read(case: Case, *arguments: str) -> None:
    case.says(case.run("poses", "read", *arguments, "--output", "poses.csv").stderr)


@remedy("poses/reading.py", "trajectory {}: its ending does not tell its format; give --format")
def _no_ending(case: Case) -> None:
    (case.tmp_path / "flight.txt").write_text(TUM)
    refused_read(case, "flight.txt", *ORIGIN)
    case.follow("give --format", lambda: read(case, "flight.txt", *ORIGIN, "--format", "tum"))


@remedy(
    "poses/reading.py",
    "trajectory {}: {} is in metres of a local frame; say where its origin lies (--origin LAT LON [HEIGHT])",
)
def _no_origin(case: Case) -> None:
    (case.tmp_path / "flight.txt").write_text(TUM)
    refused_read(case, "flight.txt", "--format", "tum")
    case.follow(
        "say where its origin lies (--origin LAT LON [HEIGHT])",
        lambda: read(case, "flight.txt", "--format", "tum", *ORIGIN, "80"),
    )


@remedy(
    "cli/posing.py",
    "area {}: no such file, and no box; give a GeoJSON, KML or KMZ file of polygons, or a box "
    '"latTL_lonTL_latBR_lonBR"',
)
def _no_area(case: Case) -> None:
    def drawn(area: str):
        return case.run(*"poses random --count 3 --agl 90 --output p.csv --area".split(), area)

    case.says(drawn("area.geojson").stderr)
    ring = [[-89.9, 35.15], [-89.89, 35.15], [-89.89, 35.16], [-89.9, 35.15]]
    (case.tmp_path / "area.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": [ring]}))
    case.follow("give a GeoJSON, KML or KMZ file of polygons", lambda: drawn("area.geojson").returncode == 0)
    case.follow('a box "latTL_lonTL_latBR_lonBR"', lambda: drawn("35.16_-89.90_35.15_-89.89").returncode == 0)


@remedy(
    "mission/areas/coords.py",
    "file {}: is a trajectory or a flight log; make a table of poses from it (terrainav poses read)",
)
def _no_table(case: Case) -> None:
    pytest.importorskip("lxml")
    path = case.tmp_path / "way.gpx"
    path.write_text(GPX)
    case.refused(lambda: parse_coords(str(path)))
    case.follow("make a table of poses from it (terrainav poses read)", lambda: read(case, "way.gpx", "--agl", "90"))
    assert len(parse_coords(str(case.tmp_path / "poses.csv"))[0].poses) == 2


@remedy(
    "poses/logs.py",
    "{}, which reads such files, is not installed; get it with: pip install 'terrainav[logs]'",
)
def _no_reader(case: Case) -> None:
    with case.monkeypatch.context() as without:
        without.setitem(sys.modules, "pyulog", None)
        case.refused(lambda: read_ulog(case.tmp_path / "flight.ulg"))
    case.follow(
        "get it with: pip install 'terrainav[logs]'",
        lambda: all(extra_brings("logs", name) for name in ("pyulog", "pymavlink", "lxml")),
    )


@remedy(
    "poses/random_poses.py",
    "area: fills hardly any of the box around it; give a polygon that is less narrow",
)
def _needle(case: Case) -> None:
    def drawn(width: float):
        area = Polygon((((0.0, 0.0), (1.0, 1.0), (1.0, 1.0 + width)),))
        return random_poses(area, 3, PoseDistributions(Distribution("fixed", 90.0)), 1)

    case.refused(lambda: drawn(1e-9))
    case.follow("give a polygon that is less narrow", lambda: drawn(0.1))


@remedy("poses/track.py", "start: the trajectory has no times; give the start to the capture (--start)")
def _no_times_to_start(case: Case) -> None:
    (case.tmp_path / "poses.txt").write_text(KITTI)
    file, start = ("poses.txt", "--format", "kitti", *ORIGIN), ("--start", "2024-06-21T10:30:00Z")
    refused_read(case, *file, *start)
    assert read(case, *file)
    case.follow(
        "give the start to the capture (--start)",
        lambda: case.run("plan", "--coords", "poses.csv", *start).returncode == 0,
    )


@remedy("poses/track.py", "interval of {} s: the trajectory has no times; give one in metres (--every-m)")
def _no_times_to_thin(case: Case) -> None:
    (case.tmp_path / "poses.txt").write_text(KITTI)
    file = ("poses.txt", "--format", "kitti", *ORIGIN)
    refused_read(case, *file, "--every-s", "2")
    case.follow("give one in metres (--every-m)", lambda: read(case, *file, "--every-m", "2"))


@remedy(
    "poses/track.py",
    "trajectory: does not say how high its ground is; give that in the heights of the file (--ground-height), or one "
    "height above ground (--agl)",
)
def _no_ground(case: Case) -> None:
    track = Track(np.ones(2), np.ones(2), np.array([200.0, 210.0]))
    case.refused(track.points)
    case.follow("give that in the heights of the file (--ground-height)", lambda: track.points(ground_m=80.0))
    case.follow("one height above ground (--agl)", lambda: track.points(agl_m=90.0))


@remedy("poses/track.py", "trajectory: position {} has no height; give one height above ground (--agl)")
def _no_height(case: Case) -> None:
    ones = np.ones(2)
    track = Track(ones, ones, np.array([90.0, np.nan]), 0.0)
    case.refused(track.points)
    case.follow("give one height above ground (--agl)", lambda: track.points(agl_m=90.0))


@remedy(
    "poses/trajectories.py",
    "{}: EuRoC's poses are those of an inertial unit; give --body: urf for that of the published flights, flu or "
    "frd for an aircraft's",
)
def _no_body(case: Case) -> None:
    def track(**options: str) -> Track:
        return read_trajectory("0,0,0,90,1,0,0,0\n", "euroc", (35.16, -89.9, 0.0), **options)

    case.refused(track)
    case.follow("give --body: urf for that of the published flights", lambda: track(body="urf"))
    case.follow("flu", lambda: track(body="flu"))
    case.follow("frd for an aircraft's", lambda: track(body="frd"))


@remedy(
    "poses/logs.py",
    "log {}: its clock starts again at position {}: it holds {} flights; choose one of them (--flight)",
)
def _two_flights(case: Case) -> None:
    pytest.importorskip("pymavlink")
    seconds = [*range(1, 11), *range(1, 11)]
    dataflash(
        case.tmp_path / "two.bin",
        [("POS", us(at), e7(35.0), e7(9.0 + 1e-4 * at), 500.0 + at, float(at), 0.0) for at in seconds],
    )
    refused_read(case, "two.bin")
    case.follow("choose one of them (--flight)", lambda: read(case, "two.bin", "--flight", "2"))


@remedy("poses/trajectories.py", "{}: its times go back at pose {}; leave the times out (--times)")
def _times_go_back(case: Case) -> None:
    (case.tmp_path / "back.txt").write_text("5 0 0 90 1 0 0 0\n3 5 0 90 1 0 0 0\n")
    file = ("back.txt", "--format", "tum", *ORIGIN)
    refused_read(case, *file)
    case.follow("leave the times out (--times)", lambda: read(case, *file, "--times", "none"))


@remedy("poses/trajectories.py", "{}: {}; give their unit, or leave them out (--times)")
def _other_unit(case: Case) -> None:
    text = "".join(f"1403636579.{at},{at},0,90,1,0,0,0\n" for at in range(9))
    (case.tmp_path / "e.csv").write_text(text)
    file = ("e.csv", "--format", "euroc", "--body", "flu", *ORIGIN)
    case.refused(lambda: read_trajectory(text, "euroc", (0.0, 0.0, 0.0), body="flu"))
    case.follow("give their unit", lambda: read(case, *file, "--times", "s"))
    case.follow("leave them out (--times)", lambda: read(case, *file, "--times", "none"))


@remedy("poses/gpx.py", "{}: {}; leave the times out (--times)")
def _points_go_back(case: Case) -> None:
    pytest.importorskip("lxml")
    point = '<trkpt lat="35.16" lon="-89.9"><time>2024-06-21T10:30:{}Z</time></trkpt>'
    text = f"<gpx>{point.format(30)}{point.format(10)}</gpx>"
    (case.tmp_path / "back.gpx").write_text(text)
    case.refused(lambda: read_gpx(text.encode()))
    case.follow("leave the times out (--times)", lambda: read(case, "back.gpx", "--agl", "90", "--times", "none"))


@remedy("poses/logs.py", "log {}: {}; leave the times out (--times)")
def _short_log(case: Case) -> None:
    pytest.importorskip("pymavlink")
    rows = [("POS", at, e7(35.0), e7(9.0 + 1e-4 * at), 500.0 + at, float(at), 0.0) for at in range(5)]
    path = dataflash(case.tmp_path / "short.bin", rows)
    case.refused(lambda: read_dataflash(path))
    case.follow("leave the times out (--times)", lambda: read(case, "short.bin", "--times", "none"))


@remedy("mission/clock.py", "{}: {}; give seconds after 1970, or remove the column of times")
def _table_in_milliseconds(case: Case) -> None:
    def times(factor: float) -> str:
        rows = "".join(f"35,9.000{at},90,{factor * (1_718_965_800 + at):.0f}\n" for at in range(3))
        return "lat,lon,agl,time\n" + rows

    case.refused(lambda: read_poses(times(1e-3).splitlines()))
    case.follow("give seconds after 1970", lambda: read_poses(times(1.0).splitlines()))
    untimed = [line.rpartition(",")[0] for line in times(1e-3).splitlines()]
    case.follow("remove the column of times", lambda: read_poses(untimed))


@remedy(
    "poses/random_poses.py",
    "{} of {} poses lie within the imagery with all that they see; choose an area that lies farther inside, lower "
    "heights, or less tilt",
)
def _beyond_the_imagery(case: Case) -> None:
    extent = ((0.5, 0.5), (0.501, 0.5), (0.501, 0.501), (0.5, 0.501))
    grid = PixelGrid(extent=extent)

    def drawn(lon: float, agl_m: float, tilt_deg: float) -> None:
        box = Box(-0.15, lon, -0.2, lon + 0.05)
        poses = PoseDistributions(Distribution("fixed", agl_m), tilt=Distribution("fixed", tilt_deg))
        random_poses(box, 3, poses, 1, lambda some: poses_inside(grid, Camera(60.0), some, 640))

    case.refused(lambda: drawn(-0.01, 90_000.0, 0.0))
    case.follow("lower heights", lambda: drawn(0.1, 9_000.0, 0.0))
    case.follow("choose an area that lies farther inside", lambda: drawn(0.15, 12_000.0, 0.0))
    case.follow("less tilt", lambda: drawn(0.15, 12_000.0, 5.0))


def _of_one(mission: Mission, kept: bool) -> Mission:
    worked_out = plan(mission, PixelGrid())
    return captured_points(mission, worked_out, np.full(len(worked_out), kept))


@remedy(
    "mission/inside.py",
    "none of the {} images lies within the imagery; choose another area, or lower flights",
)
def _none_inside(case: Case) -> None:
    mission = Mission(Box(35.16, -89.9, 35.159, -89.899), 60.0)
    case.refused(lambda: _of_one(mission, False))
    for advice in ("choose another area", "lower flights"):
        case.follow(advice, lambda: _of_one(mission, True))


@remedy(
    "mission/inside.py",
    "images within the imagery: cannot be selected for an area over relief, in wind or with random poses; give points",
)
def _an_area_in_wind(case: Case) -> None:
    mission = Mission(Box(35.16, -89.9, 35.159, -89.899), 60.0, wind=Wind(3.0), accept_error=True)
    case.refused(lambda: _of_one(mission, True))
    case.follow("give points", lambda: _of_one(mission.replace(area=Points(((35.16, -89.9, 60.0),))), True))
