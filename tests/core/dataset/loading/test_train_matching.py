"""The example: noise teaches it nothing. That what it learns of one part of the ground holds on another: the walk."""

from __future__ import annotations

import re
import runpy
import sys
from pathlib import Path

import pytest
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.clean import clean
from terrainav.core.dataset.split import split
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

pytest.importorskip("torch")
EXAMPLE = Path(__file__).resolve().parents[4] / "examples" / "train_matching.py"


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
    """A town of the embedded world, split by blocks."""
    folder = tmp_path_factory.mktemp("captured") / "OUT"
    source = open_source("world")
    box = Box(35.145, -89.866, 35.134, -89.852)
    mission = Mission(box, 120.0, image_format="jpg", map_types=("satellite", "roadmap"), zoom=17)
    capture(plan(mission, source.grid), source, folder)
    # Of open land one roadmap is like the other.
    clean(folder, 2.0)
    split(folder, (0.6, 0.1, 0.3), how="blocks")
    return folder


def judged(out):
    """Places found and asked for."""
    found = re.search(r"^test, on ground not seen before: (\d+) of (\d+) at first rank", out, re.MULTILINE)
    return int(found[1]), int(found[2])


@pytest.mark.thorough
def test_noise_teaches_nothing(captured, example):
    code, out = example(captured, "--noise")
    hits, count = judged(out)
    assert code == 1
    assert count > 20
    assert hits < count / 5
    assert out.splitlines()[-1].endswith(": no better than chance")


def test_a_folder_that_is_no_dataset_is_refused_in_one_line(tmp_path, example):
    code, out = example(tmp_path)
    assert code.startswith(f"train_matching: folder {tmp_path}: is not a dataset")
    assert "\n" not in code
    assert out == ""
