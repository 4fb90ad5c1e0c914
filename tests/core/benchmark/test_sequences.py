"""Scores of sequences, against errors made on purpose."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from terrainav.core.benchmark.answers import POSE
from terrainav.core.benchmark.sequences import FramePoses, compare
from terrainav.core.geodesy.local import LocalFrame

from tests.support.command import command

ORIGIN = LocalFrame(46.2, -122.2, 0.0)


def poses(east_m, north_m, up_m, yaw_deg):
    """Poses (n, 6) of a level camera."""
    lat, lon, height = ORIGIN.geodetic(np.stack([east_m, north_m, up_m], axis=-1))
    return np.stack([lat, lon, height, yaw_deg, 0.0 * lat, 0.0 * lat], axis=1)


def figures(truth, found):
    return {one.name: one.value for one in compare(FramePoses.from_table(truth), FramePoses.from_table(found))}


@pytest.fixture(scope="module")
def truth():
    """A straight way of a kilometre, with a frame each 10 m."""
    along = np.arange(0.0, 1001.0, 10.0)
    return poses(along, 0.0 * along, 0.0 * along + 100.0, 0.0 * along + 90.0)


def test_true_poses_have_no_errors(truth):
    found = figures(truth, truth)
    assert found["frames"] == 101
    assert (found["answered"], found["within 1 m"], found["within 0.1 m, 1 deg"]) == (1.0, 1.0, 1.0)
    assert found["median error"] == found["median angle"] == found["drift"] == found["drift of attitude"] == 0.0


def test_drift_is_the_share_by_which_a_way_is_too_long(truth):
    along = np.arange(0.0, 1001.0, 10.0)
    found = figures(truth, poses(1.019 * along, 0.0 * along, 0.0 * along + 100.0, 90.0 + along / 100.0))
    assert found["drift"] == pytest.approx(0.019, rel=1e-3)
    # A degree each 100 m.
    assert found["drift of attitude"] == pytest.approx(1.0, rel=1e-3)
    assert found["median error"] == pytest.approx(9.5, rel=1e-3)
    assert found["median angle"] == pytest.approx(5.0, rel=1e-3)
    # Of 101 frames those up to 520 m are within 10 m.
    assert found["within 10 m"] == pytest.approx(53 / 101)


def test_a_constant_error_is_no_drift(truth):
    along = np.arange(0.0, 1001.0, 10.0)
    found = figures(truth, poses(along + 3.0, 0.0 * along + 4.0, 0.0 * along + 100.0, 0.0 * along + 97.0))
    assert found["median error"] == pytest.approx(5.0, rel=1e-4)
    assert found["median angle"] == pytest.approx(7.0, rel=1e-4)
    assert found["drift"] == pytest.approx(0.0, abs=1e-6)


def test_frames_without_an_answer_are_not_localised(truth):
    found = truth.copy()
    found[::2] = np.nan
    scores = figures(truth, found)
    assert scores["answered"] == scores["within 1 m"] == pytest.approx(50 / 101)
    assert scores["drift"] == 0.0


@pytest.fixture
def flown(tmp_path, monkeypatch, capsys):
    run = command(tmp_path, monkeypatch, capsys)
    asked = (
        "fly",
        "--coords",
        "46.212_-122.20_46.209_-122.196_150",
        "--fov",
        "60",
        "--rate",
        "0.5",
        "--imu-rate",
        "10",
    )
    assert run(*asked, "--img-size", "16", "12", "3", "--quiet", "--data-dir", "out").returncode == 0
    return run


def test_the_command_scores_a_sequence(flown, tmp_path):
    with (tmp_path / "out" / "satellite" / "meta_data.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    names = ("pose_lat_deg", "pose_lon_deg", "", "yaw_deg", "tilt_deg", "roll_deg")

    def predict(rows):
        cells = (",".join([row["img_names"], *(row.get(name, "") for name in names)]) for row in rows)
        (tmp_path / "mine.csv").write_text("\n".join(["query," + ",".join(POSE), *cells]))

    predict(rows[:-1])
    done = flown("benchmark", "score", "out", "mine.csv", "--json")
    assert done.returncode == 0, done.stderr
    found = {one["name"]: one["value"] for one in json.loads(done.stdout)}
    assert found["frames"] == len(rows)
    assert found["within 0.1 m, 1 deg"] == pytest.approx(1.0 - 1.0 / len(rows))
    assert found["drift"] == pytest.approx(0.0, abs=1e-5)
    assert "drift of attitude" in flown("benchmark", "score", "out", "mine.csv").stdout
    predict([*rows, rows[3]])
    done = flown("benchmark", "score", "out", "mine.csv")
    assert (done.returncode, "is answered in line 5 already" in done.stderr) == (2, True)
    predict([{**rows[0], "img_names": "x.tif"}])
    assert "frame 'x.tif' is not in the sequence" in flown("benchmark", "score", "out", "mine.csv").stderr
    assert "--part: is for benchmarks" in flown("benchmark", "score", "out", "mine.csv", "--part", "test").stderr
