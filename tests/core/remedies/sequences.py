"""What refusals of sequences advise."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
from terrainav.core.exports.kinds import export_as
from terrainav.core.exports.sequences import RecordedSequence, _euroc
from terrainav.core.sequences.files import SequenceRecord
from terrainav.core.sequences.jsbsim import fly_script
from terrainav.core.sequences.trajectory import Rig, Trajectory

from tests.core.remedies.files import extra_brings
from tests.support.remedies import Case, remedy

PLACE = ("--coords", "46.212_-122.20_46.209_-122.196_150", "--fov", "60")
SMALL = ("--rate", "0.2", "--imu-rate", "10", "--img-size", "16", "12", "3", "--quiet", "--data-dir")


def fly(case: Case, *more: str, place=PLACE, to="out"):
    return case.run("fly", *place, *SMALL, to, *more)


def works(case: Case, *more: str, **where) -> bool:
    return fly(case, *more, **where).returncode == 0


def tum(case: Case) -> tuple[str, ...]:
    rows = [f"{1.7e9 + s} {5 * s} 0 90 1 0 0 0" for s in range(6)]
    (case.tmp_path / "flight.txt").write_text("\n".join(rows))
    return ("--trajectory", "flight.txt", "--origin", "46.2", "-122.2")


@remedy("cli/sequencing.py", "coordinates: the flight has its own; leave them out")
def _two_places(case: Case) -> None:
    case.says(fly(case, *tum(case)).stderr)
    case.follow("leave them out", lambda: works(case, *tum(case), place=()))


@remedy(
    "cli/sequencing.py",
    "trajectory: does not say how high its ground is; give that (--trajectory-ground-height)",
)
def _no_ground(case: Case) -> None:
    points = "".join(
        f'<trkpt lat="{46.2 + 1e-4 * s}" lon="-122.2"><ele>200</ele><time>2024-06-21T10:30:{s:02d}Z</time></trkpt>'
        for s in range(9)
    )
    (case.tmp_path / "way.gpx").write_text(f"<gpx><trk><trkseg>{points}</trkseg></trk></gpx>")
    case.says(fly(case, "--trajectory", "way.gpx", place=()).stderr)
    case.follow(
        "give that (--trajectory-ground-height)",
        lambda: works(case, "--trajectory", "way.gpx", "--trajectory-ground-height", "80", place=()),
    )


@remedy("exports/sequences.py", "lens with {} coefficients: EuRoC's files state four; write a bag (rosbag2)")
def _rational_lens(case: Case) -> None:
    assert works(case)
    found = RecordedSequence.read(case.tmp_path / "out")
    values = (("k1", 0.1), ("k2", 0.0), ("p1", 0.0), ("p2", 0.0), ("k3", 0.2))
    lens = replace(found, contract=replace(found.contract, distortion=values))
    case.refused(lambda: _euroc(lens, case.tmp_path / "euroc", None))
    case.follow("write a bag (rosbag2)", lambda: export_as(case.tmp_path / "out", case.tmp_path / "bag", "rosbag2"))


@remedy(
    "exports/sequences.py",
    "rosbags, which writes bags, is not installed; get it with: pip install 'terrainav[ros]'",
)
def _no_rosbags(case: Case) -> None:
    assert works(case)
    with case.monkeypatch.context() as without:
        without.setitem(sys.modules, "rosbags.rosbag2", None)
        case.refused(lambda: export_as(case.tmp_path / "out", case.tmp_path / "bag", "mcap"))
    case.follow("get it with: pip install 'terrainav[ros]'", lambda: extra_brings("ros", "rosbags"))


@remedy("sequences/files.py", "folder {}: is not a sequence, as it has no {}; fly one")
def _no_sequence(case: Case) -> None:
    case.refused(lambda: SequenceRecord.read(case.tmp_path))
    case.follow("fly one", lambda: works(case) and SequenceRecord.read(case.tmp_path / "out"))


@remedy("sequences/flying.py", "frame {}: frames of a sequence are perspectives; choose camera")
def _map_frames(case: Case) -> None:
    case.says(fly(case, "--frame", "map").stderr)
    case.follow("choose camera", lambda: works(case, "--frame", "camera"))


@remedy("sequences/flying.py", "{} at random: frames of a sequence have the poses of its trajectory; leave it out")
def _random_poses(case: Case) -> None:
    case.says(fly(case, "--vary", "yaw_deg=uniform(0,10)").stderr)
    case.follow("leave it out", lambda: works(case))


@remedy(
    "sequences/flying.py",
    "exposure time {} ms: longer than the {} ms between two frames; shorten the exposure, or take fewer frames "
    "(--rate)",
)
def _long_exposure(case: Case) -> None:
    blurred = ("--motion-blur", "--exposure-ms")
    case.says(fly(case, *blurred, "150", "--rate", "10").stderr)
    case.follow("shorten the exposure", lambda: works(case, *blurred, "4"))
    case.follow("take fewer frames (--rate)", lambda: works(case, *blurred, "150", "--rate", "0.2", to="slow"))


@remedy(
    "sequences/flying.py",
    "frame {}, {} s after the start: is {} m below the ground or the ellipsoid; fly higher",
)
def _below_ground(case: Case) -> None:
    case.says(fly(case, *tum(case), "--raise", "-100", place=()).stderr)
    case.follow("fly higher", lambda: works(case, *tum(case), "--raise", "10", place=()))


@remedy("sequences/flying.py", "wind: poses with times are flown as they are; leave the wind out")
def _wind(case: Case) -> None:
    rows = "\n".join(f"{46.2 + 1e-4 * s},-122.2,200,{1.7e9 + s}" for s in range(9))
    (case.tmp_path / "poses.csv").write_text(f"lat,lon,agl,time\n{rows}")
    place = ("--coords", "poses.csv")
    case.says(fly(case, "--wind", "4", "270", "0.2", place=place).stderr)
    case.follow("leave the wind out", lambda: works(case, place=place))


@remedy(
    "sequences/jsbsim.py",
    "jsbsim, which flies aircraft, is not installed; get it with: pip install 'terrainav[jsbsim]'",
)
def _no_jsbsim(case: Case) -> None:
    with case.monkeypatch.context() as without:
        without.setitem(sys.modules, "jsbsim", None)
        case.refused(lambda: fly_script("scripts/Test_F450_Launch.xml"))
    case.follow("get it with: pip install 'terrainav[jsbsim]'", lambda: extra_brings("jsbsim", "jsbsim"))


def through(time_s, north_m, yaw_deg=0.0) -> Trajectory:
    time_s, level = np.asarray(time_s, float), np.zeros(len(time_s))
    lat = 46.2 + np.asarray(north_m) / 111_000.0
    return Trajectory.through_cameras(time_s, lat, level, level + 100.0, (level + yaw_deg, level, level), Rig(), 0)


@remedy(
    "sequences/trajectory.py",
    "trajectory: pose {} has the time of the one before it, {} s after the start, or an earlier one; remove one of the "
    "two",
)
def _time_twice(case: Case) -> None:
    case.refused(lambda: through([0, 1, 1, 2, 3], [0, 5, 5, 10, 15]))
    case.follow("remove one of the two", lambda: through([0, 1, 2, 3], [0, 5, 10, 15]))


@remedy(
    "sequences/trajectory.py",
    "trajectory: jumps by {} deg from pose {} to the next: must be at most {}; give poses that are closer in time",
)
def _wide_turn(case: Case) -> None:
    case.refused(lambda: through(range(5), range(5), np.arange(5) * 120.0))
    halves = np.arange(0.0, 4.1, 0.5)
    case.follow("give poses that are closer in time", lambda: through(halves, halves, halves * 120.0))


@remedy(
    "sequences/trajectory.py",
    "trajectory: jumps at pose {}, {} s after the start: no aircraft accelerates by {} m/s²; remove the pose, or "
    "smooth the trajectory (--smooth)",
)
def _jump(case: Case) -> None:
    t, north = np.arange(9.0), np.arange(9.0)
    case.refused(lambda: through(t, np.where(t == 4.0, 400.0, north)))
    case.follow("remove the pose", lambda: through(np.delete(t, 4), np.delete(north, 4)))
    rows = [f"{1.7e9 + s} {5 * s + 400 * (s == 4)} 0 90 1 0 0 0" for s in range(12)]
    tum(case)
    (case.tmp_path / "flight.txt").write_text("\n".join(rows))
    asked = ("--trajectory", "flight.txt", "--origin", "46.2", "-122.2")
    assert not works(case, *asked, place=())
    case.follow("smooth the trajectory (--smooth)", lambda: works(case, *asked, "--smooth", "3", place=()))
