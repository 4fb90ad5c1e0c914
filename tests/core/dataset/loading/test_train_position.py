"""The example: a captured dataset goes through the loader into a network, and the loss falls."""

from __future__ import annotations

import re
import runpy
import sys
from pathlib import Path

import pytest
from terrainav.core.capture.runner import capture
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

pytest.importorskip("torch")
EXAMPLE = Path(__file__).resolve().parents[4] / "examples" / "train_position.py"


@pytest.fixture
def example(monkeypatch, capsys):
    """Run the example as a script, in this process, where PyTorch is loaded already; returns exit code and output."""

    def run(folder, *arguments):
        monkeypatch.setattr(sys, "argv", [str(EXAMPLE), str(folder), *arguments])
        with pytest.raises(SystemExit) as ended:
            runpy.run_path(str(EXAMPLE), run_name="__main__")
        return ended.value.code, capsys.readouterr().out

    return run


@pytest.fixture(scope="module")
def captured(tmp_path_factory):
    folder = tmp_path_factory.mktemp("captured") / "OUT"
    source = open_source("world")
    mission = Mission(Box(35.160, -89.900, 35.156, -89.895), 120.0, image_format="jpg")
    capture(plan(mission, source.grid), source, folder)
    return folder


def test_the_loss_falls_on_the_embedded_world(captured, example):
    code, out = example(
        captured, "--part", "all", "--steps", "20", "--img-size", "32", "32", "3", "--augment"
    )
    assert code == 0
    losses = [float(one) for one in re.findall(r"^step \d+: loss ([\d.]+)$", out, re.MULTILINE)]
    assert len(losses) == 20
    # Scaled labels have variance 1: a network that only knows their mean stays there.
    assert 0.3 < sum(losses[:2]) / 2 < 4.0
    assert sum(losses[-2:]) / 2 < 0.25
    assert out.splitlines()[-1].endswith("falls")


def test_a_loss_that_does_not_fall_is_an_error(captured, example):
    code, out = example(captured, "--part", "all", "--steps", "1")
    assert code == 1
    assert out.splitlines()[-1].endswith("does not fall")


def test_a_folder_that_is_no_dataset_is_refused_in_one_line(tmp_path, example):
    code, out = example(tmp_path)
    assert code.startswith(f"train_position: folder {tmp_path}: is no dataset")
    assert "\n" not in code
    assert out == ""
