"""Height profiles as files of the command: a table that agrees with the plan, and a diagram."""

from __future__ import annotations

import csv

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.flight.path import CAPTURE
from terrainav.core.mission.profile import height_profile
from terrainav.core.report.heights import profile_diagram, write_profile

from tests.core.mission.flights import ACROSS, ALONE, HERE, worked_out
from tests.support.command import command

BOX = "35.16_-89.90_35.155_-89.89_120"


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    return command(tmp_path, monkeypatch, capsys)


def rows_of(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_the_table_has_the_images_of_the_plans_table(tmp_path):
    made = worked_out(ACROSS)
    profile, target = write_profile(made, tmp_path / "heights.csv"), tmp_path / "heights.csv"
    write_plan(made, tmp_path / "plan.csv")
    rows, plan_rows = rows_of(target), rows_of(tmp_path / "plan.csv")
    images = [row for row in rows if row["point"] == "image"]
    assert [int(row["image"]) for row in images] == list(range(1, len(made) + 1))
    for name in ("lat_deg", "lon_deg"):
        assert [float(row[name]) for row in images] == pytest.approx([float(row[name]) for row in plan_rows], abs=1e-8)
    assert [float(row["clearance_m"]) for row in images] == pytest.approx([float(row["agl_m"]) for row in plan_rows])
    assert len(rows) == len(profile)
    assert {row["sortie"] for row in rows} == {"1"}


def test_the_command_writes_table_and_diagram(run, tmp_path):
    done = run("plan", "--coords", BOX, "--takeoff", "35.154", "-89.9", "--profile", "heights.csv")
    assert "least clearance 120.0 m" in done.stderr
    assert "written                 heights.csv" in done.stdout
    rows = rows_of(tmp_path / "heights.csv")
    assert (rows[0]["point"], rows[0]["clearance_m"], rows[0]["image"]) == ("take-off", "0.000", "")
    assert rows[-1]["point"] == "landing"
    pytest.importorskip("matplotlib", reason="diagrams are drawn by matplotlib")
    run("plan", "--coords", BOX, "--elevation", "world", "--profile", "heights.png")
    assert (tmp_path / "heights.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("name", ["heights.svg", "heights", ".csv"])
def test_other_endings_are_refused_before_planning(run, tmp_path, name):
    done = run("plan", "--coords", BOX, "--profile", name)
    assert done.returncode == 2
    assert "must end in .csv, .png" in done.stderr
    assert not list(tmp_path.iterdir())
    with pytest.raises(InvalidInput, match="must end in"):
        write_profile(worked_out(ALONE), tmp_path / name)


@pytest.mark.parametrize("mission", [HERE, ALONE, HERE.replace(takeoff=(35.15, -89.9), battery_min=8.0)])
def test_diagrams_of_any_flight_are_drawn(mission):
    pytest.importorskip("matplotlib", reason="diagrams are drawn by matplotlib")
    profile = height_profile(worked_out(mission))
    assert (profile.kind == CAPTURE).any()
    assert np.isfinite(profile.height_m).all()
    assert profile_diagram(profile) == profile_diagram(profile)
