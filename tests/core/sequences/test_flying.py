"""Sequences as a person or a script flies them, over the embedded world."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.table import unix_seconds
from terrainav.core.geodesy.camera import image_axes
from terrainav.core.geodesy.local import LocalFrame, enu_axes, geocentric

from tests.support import strapdown
from tests.support.command import command

ROOT = Path(__file__).parents[3]
#: Over a minute of flight with turns between rows; few small images.
FLIGHT = ("fly", "--coords", "46.210_-122.20_46.207_-122.196_150", "--fov", "60", "--rate", "1")
SMALL = ("--img-size", "32", "24", "3", "--format", "png", "--quiet", "--data-dir", "out")


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    return command(tmp_path, monkeypatch, capsys)


def table(path):
    return np.genfromtxt(path, delimiter=",", names=True, dtype=None)


def columns(rows, *names):
    return np.stack([rows[name] for name in names], axis=-1).astype(np.float64)


def refusal(done, code=2):
    assert done.returncode == code, done.stderr
    assert done.stdout == ""
    (line,) = (line for line in done.stderr.splitlines() if "frames at" not in line)
    return line


def camera_rotation(lat, lon, yaw, tilt, roll):
    """From the camera's axes (right, down, view) to geocentric ones."""
    right, up, view = image_axes(yaw, tilt, roll)
    return enu_axes(lat, lon).T @ np.stack([right, -up, view], axis=-1)


def test_the_files_of_a_sequence_lead_back_to_the_poses_of_its_frames(run, tmp_path):
    done = run(*FLIGHT, *SMALL, "--tilt", "20", "--imu", "ideal", "--lever-arm", "0.1", "0.0", "0.05")
    assert done.returncode == 0, done.stderr
    images = read_dataset(tmp_path / "out").image_sets["satellite"].table
    imu, truth = (table(tmp_path / "out" / name) for name in ("imu.csv", "trajectory.csv"))
    seconds = unix_seconds(images.time_utc) - imu["time_ns"][0] / 1e9
    assert seconds == pytest.approx(np.arange(len(seconds)), abs=2e-6)
    # From the start of the flight and from within it, over turns, for 60 s each.
    for first in (0, 24):
        begin, end = first * 200, (first + 60) * 200
        lat, lon, height = (float(truth[name][begin]) for name in ("lat_deg", "lon_deg", "height_m"))
        to_earth = Rotation.from_matrix(enu_axes(lat, lon).T)
        q = columns(truth, "q_x", "q_y", "q_z", "q_w")[begin]
        place, _, q = strapdown.integrate(
            columns(imu, *(f"rate_{axis}_rad_per_s" for axis in "xyz"))[begin : end + 1],
            columns(imu, *(f"force_{axis}_m_per_s2" for axis in "xyz"))[begin : end + 1],
            0.005,
            geocentric(lat, lon, height),
            to_earth.apply(columns(truth, "east_m_per_s", "north_m_per_s", "up_m_per_s")[begin]),
            (to_earth * Rotation.from_quat(q)).as_quat()[[3, 0, 1, 2]],
        )
        to_imu = np.array(json.loads((tmp_path / "out" / "sequence.json").read_text())["camera_to_imu"])
        body = Rotation.from_quat(q[[1, 2, 3, 0]])
        at = first + 60
        pose = images.pose_lat_deg[at], images.pose_lon_deg[at]
        camera = geocentric(*pose, images.agl_m[at])
        turned = Rotation.from_matrix(
            camera_rotation(*pose, images.yaw_deg[at], images.tilt_deg[at], images.roll_deg[at])
        )
        assert np.linalg.norm(place + body.apply(to_imu[:3, 3]) - camera) < 0.05
        assert np.degrees(((body * Rotation.from_matrix(to_imu[:3, :3])).inv() * turned).magnitude()) < 0.01


def test_dead_reckoning_with_an_ideal_unit_finds_every_frame(run, tmp_path):
    done = run(*FLIGHT[:-1], "0.5", *SMALL, "--imu", "ideal", "--imagery", "now=world", "map=world:roadmap")
    assert done.returncode == 0, done.stderr
    script = ROOT / "examples" / "dead_reckoning.py"
    subprocess.run([sys.executable, script, "out", "predictions.csv"], cwd=tmp_path, check=True)
    done = run("benchmark", "score", "out/now", "predictions.csv", "--json")
    found = {one["name"]: one["value"] for one in json.loads(done.stdout)}
    assert found["within 1 m"] == 1.0
    # Its steps are of second order, and its gravity knows the flattening alone.
    assert found["median error"] < 0.1
    assert found["drift"] < 1e-3


def test_a_sequence_resumes_and_repeats_to_the_byte(run, tmp_path):
    asked = (*FLIGHT[:-1], "0.2", *SMALL, "--imu-rate", "10", "--wind", "4", "270", "0.2")
    assert run(*asked).returncode == 0
    names = (
        *("imu.csv", "trajectory.csv", "gnss.csv", "barometer.csv", "magnetometer.csv"),
        *("sequence.json", "camera.json", "mission.json"),
    )
    before = {name: (tmp_path / "out" / name).read_bytes() for name in names}
    assert "resume" in refusal(run(*asked), code=3)
    done = run(*asked, "--resume", "--json")
    assert json.loads(done.stdout)["written"] == 0
    assert {name: (tmp_path / "out" / name).read_bytes() for name in names} == before


def test_poses_with_times_are_gone_through(run, tmp_path):
    t = np.arange(12)
    rows = [
        f"{46.2 + 1e-4 * s:.9f},{-122.2 + 2e-5 * s * s:.9f},{200 + 3 * s},{5 * s},{10 + s},{-s},{1.7e9 + s}" for s in t
    ]
    (tmp_path / "poses.csv").write_text("lat_deg,lon_deg,agl_m,yaw_deg,tilt_deg,roll_deg,time\n" + "\n".join(rows))
    done = run("fly", "--coords", "poses.csv", "--rate", "2", "--ground-height", "30", "--sun", "time", *SMALL)
    assert done.returncode == 0, done.stderr
    found = read_dataset(tmp_path / "out").image_sets["satellite"].table
    assert len(found.yaw_deg) == 23
    assert found.yaw_deg[::2] == pytest.approx(5.0 * t, abs=1e-6)
    assert found.roll_deg[::2] == pytest.approx(-1.0 * t, abs=1e-6)
    assert found.agl_m[::2] == pytest.approx(200.0 + 3.0 * t, abs=1e-5)
    off = LocalFrame(46.2, -122.2).enu(found.pose_lat_deg[::2], found.pose_lon_deg[::2], 0.0 * t)
    expected = LocalFrame(46.2, -122.2).enu(46.2 + 1e-4 * t, -122.2 + 2e-5 * t * t, 0.0 * t)
    assert off == pytest.approx(expected, abs=2e-4)


def test_frames_over_relief_have_heights_above_the_ellipsoid(run, tmp_path):
    done = run(*FLIGHT[:-1], "0.1", *SMALL, "--elevation", "world", "--imu-rate", "10", "--products", "depth")
    assert done.returncode == 0, done.stderr
    mission = json.loads((tmp_path / "out" / "mission.json").read_text())
    truth = table(tmp_path / "out" / "trajectory.csv")
    heights = [pose[2] for pose in mission["area"]["poses"]]
    assert heights == pytest.approx(truth["height_m"][::100][: len(heights)], abs=1e-5)


def test_two_imageries_share_the_frames(run, tmp_path):
    done = run(*FLIGHT[:-1], "0.1", *SMALL, "--imu-rate", "10", "--imagery", "now=world", "then=world")
    assert done.returncode == 0, done.stderr
    sets = [read_dataset(tmp_path / "out" / name).image_sets for name in ("now", "then")]
    now, then = (next(iter(one.values())).table for one in sets)
    assert (now.pose_lat_deg == then.pose_lat_deg).all()
    assert (tmp_path / "out" / "imu.csv").is_file()


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (("--rate", "0"), "frame rate 0.0 Hz: must be from 0.1 to 240"),
        (
            ("--rate", "30", "--imu-rate", "20"),
            "rate of the inertial unit 20 Hz: must be at least that of the frames, 30 Hz",
        ),
        (("--imu-rate", "5000"), "must be from 10 to 4000"),
        (
            ("--exposure-ms", "60", "--motion-blur", "--rate", "20"),
            "exposure time 60 ms: longer than the 50 ms between two frames",
        ),
        (("--frame", "map"), "frames of a sequence are perspectives"),
        (("--vary", "yaw_deg=uniform(0,10)"), "frames of a sequence have the poses of its trajectory"),
        (("--sortie", "2"), "sortie 2: the flight has 1"),
        (("--gyro-noise", "-1"), "gyro_noise -1.0: must be 0 or more"),
    ],
    ids=["rate", "rates", "imu rate", "exposure", "map frames", "random poses", "sortie", "figure"],
)
def test_bad_input_is_refused_in_one_line(run, tmp_path, more, message):
    assert message in refusal(run(*FLIGHT, *SMALL, *more))
    assert not (tmp_path / "out").exists()


def test_poses_that_jump_or_repeat_a_time_are_refused(run, tmp_path):
    head = "lat_deg,lon_deg,agl_m,time\n"
    rows = [f"{46.2 + 1e-4 * s:.6f},-122.2,200,{1.7e9 + s}" for s in range(9)]
    rows[5] = f"46.3,-122.2,200,{1.7e9 + 5}"
    (tmp_path / "poses.csv").write_text(head + "\n".join(rows))
    assert "trajectory: jumps at pose 6, 5 s after the start" in refusal(run("fly", "--coords", "poses.csv", *SMALL))
    rows[5] = f"46.2005,-122.2,200,{1.7e9 + 4}"
    (tmp_path / "poses.csv").write_text(head + "\n".join(rows))
    assert "pose 6 has the time of the one before it" in refusal(run("fly", "--coords", "poses.csv", *SMALL))
