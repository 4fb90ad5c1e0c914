"""JSBSim's F450 quadrotor, and trajectories of files, as sequences."""

from __future__ import annotations

import json
import sys

import jsbsim
import numpy as np
import pytest
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.sequences.flying import track_trajectory
from terrainav.core.sequences.inertial import exact_inertial
from terrainav.core.sequences.jsbsim import fly_script
from terrainav.core.sequences.settings import SequenceSettings
from terrainav.core.sequences.trajectory import Rig

from tests.core.sequences.test_flying import SMALL, columns, refusal, table
from tests.support.command import command

SCRIPT = "scripts/Test_F450_Launch.xml"
M_PER_FT = 0.3048


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    return command(tmp_path, monkeypatch, capsys)


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    """What JSBSim itself states of the flight: time, rates against the stars, and forces by mass."""
    model = jsbsim.FGFDMExec(None)
    model.set_debug_level(0)
    model.set_output_path(str(tmp_path_factory.mktemp("tables")))
    model.load_script(SCRIPT)
    model["ic/lat-geod-deg"], model["ic/long-gc-deg"] = 46.2, -122.2
    model.run_ic()
    model.run()
    names = [*(f"velocities/{axis}i-rad_sec" for axis in "pqr"), *(f"forces/fb{axis}-total-lbs" for axis in "xyz")]
    rows = []
    while model.run():
        values = np.array([model[name] for name in names])
        values[3:] *= M_PER_FT / model["inertia/mass-slugs"]
        rows.append([model.get_sim_time(), *values])
    return np.array(rows)


def test_measurements_are_the_rates_and_forces_of_the_model(own):
    """While the quadrotor rolls, pitches and yaws after its climb; JSBSim integrates steps of 2 ms."""
    track = fly_script(SCRIPT, place_deg=(46.2, -122.2))
    flown = track_trajectory(track, track.height_m + 300.0, SequenceSettings(), Rig(), 0)
    t = np.arange(3.0, 29.0, 0.05)
    exact = exact_inertial(flown.at(t))
    # Times of the track are after its first position.
    expected = np.stack([np.interp(t, own[:, 0] - own[0, 0], column) for column in own[:, 1:].T], axis=1)
    rates = exact.rate_rad_per_s - expected[:, :3]
    forces = exact.force_m_per_s2 - expected[:, 3:]
    assert np.sqrt(np.mean(rates**2)) < 2e-3
    assert np.abs(expected[:, :3]).max() > 0.1
    assert np.sqrt(np.mean(forces**2)) < 0.02
    assert np.abs(expected[:, 5]).min() > 9.0


def test_nothing_is_left_in_the_working_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    fly_script(SCRIPT, place_deg=(46.2, -122.2))
    assert list(tmp_path.iterdir()) == []


def test_the_quadrotor_flies_over_relief(run, tmp_path):
    done = run("fly", "--jsbsim", SCRIPT, "--jsbsim-place", "46.2", "-122.2", "--raise", "50", "--rate", "1",
               "--tilt", "40", "--elevation", "world", *SMALL)  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "30 frames at 1 Hz in 30.0 s" in done.stderr
    found = read_dataset(tmp_path / "out").image_sets["satellite"].table
    assert found.agl_m[0] == pytest.approx(50.15, abs=0.1)
    assert found.agl_m.max() > 200.0
    # The aircraft pitches up by 2.7 degrees, and its camera is fixed to it.
    assert np.median(found.tilt_deg) == pytest.approx(42.7, abs=0.2)
    assert json.loads((tmp_path / "out" / "sequence.json").read_text())["flight"]["jsbsim"] == "Test_F450_Launch.xml"


def test_a_missing_extra_and_a_missing_script_are_one_line(run, monkeypatch):
    assert "JSBSim script none.xml: no such file" in refusal(run("fly", "--jsbsim", "none.xml", *SMALL))
    monkeypatch.setitem(sys.modules, "jsbsim", None)
    assert "jsbsim, which flies aircraft, is not installed" in refusal(run("fly", "--jsbsim", SCRIPT, *SMALL), code=3)
    with pytest.raises(OutputError):
        fly_script(SCRIPT)


def test_a_trajectory_of_a_file_is_flown_exactly(run, tmp_path):
    t = np.arange(0.0, 4.0, 0.1)
    rows = [f"{1.7e9 + s:.3f} {5 * s:.4f} {2 * np.sin(s):.4f} {80 + s:.4f} 0 0 0.7071068 0.7071068" for s in t]
    (tmp_path / "flight.tum").write_text("\n".join(rows))
    asked = ("--trajectory", "flight.tum", "--body", "flu")
    done = run("fly", *asked, "--origin", "46.2", "-122.2", "--rate", "10", "--raise", "20", *SMALL)
    assert done.returncode == 0, done.stderr
    found = read_dataset(tmp_path / "out").image_sets["satellite"].table
    assert found.agl_m == pytest.approx(100.0 + t, abs=1e-3)
    truth = table(tmp_path / "out" / "trajectory.csv")
    assert columns(truth, "east_m_per_s", "up_m_per_s")[100:600] == pytest.approx(
        np.tile([5.0, 1.0], (500, 1)), abs=5e-3
    )


def test_a_trajectory_needs_times_and_has_its_own_coordinates(run, tmp_path):
    (tmp_path / "flight.txt").write_text("\n".join(["1 0 0 0 0 1 0 0 0 0 1 50"] * 9))
    asked = ("--trajectory", "flight.txt", "--trajectory-format", "kitti", "--origin", "46.2", "-122.2")
    assert "trajectory: has no times" in refusal(run("fly", *asked, "--world", "enu", *SMALL))
    assert "coordinates: the flight has its own" in refusal(run("fly", *asked, "--coords", "46_7_100", *SMALL))


def test_a_script_that_is_none_is_refused(tmp_path):
    (tmp_path / "x.xml").write_text("<runscript/>")
    with pytest.raises(InvalidInput, match=r"x\.xml: cannot be"):
        fly_script(tmp_path / "x.xml")
