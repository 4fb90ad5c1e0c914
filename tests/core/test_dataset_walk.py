"""The walk of docs/datasets.md, from a capture to a training: its very command line, on a smaller box."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.folder import PARTS
from terrainav.core.dataset.labels import LABELS_FILE, Labels
from terrainav.core.dataset.loading import LabelledImages
from terrainav.core.dataset.table import image_parts

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "datasets.md"
#: Of the paper's box, a part with a town and fields beside it: some 160 places.
PAPERS_BOX, SMALL_BOX = "35.16_-89.90_35.115_-89.823_120", "35.150_-89.866_35.134_-89.846_120"
#: Seconds; the walk takes a fraction of it, also where other work goes on.
TIMEOUT_S = 300


def documented() -> str:
    """The command line of the page, on one line."""
    blocks = re.findall(r"^```sh\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    (found,) = [block for block in blocks if "terrainav capture" in block and "train_matching.py" in block]
    return found.replace("\\\n", " ").strip()


def test_the_documented_line_is_one_line_of_every_step():
    steps = [shlex.split(step)[:2] for step in documented().split("&&")]
    assert steps == [
        ["terrainav", "capture"],
        ["terrainav", "clean"],
        ["terrainav", "split"],
        ["terrainav", "load"],
        ["python", "examples/train_matching.py"],
    ]


@pytest.fixture
def shell(tmp_path):
    """Run a line as a user's shell does, in a folder beside which nothing is configured or cached."""
    programs = tmp_path / "bin"
    programs.mkdir()
    for name, arguments in (("terrainav", "-m terrainav.core.cli "), ("python", "")):
        script = programs / name
        script.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} {arguments}"$@"\n', encoding="utf-8")
        script.chmod(0o755)
    kept = {name: value for name, value in os.environ.items() if not name.startswith("TERRAINAV_")}
    environment = {
        **kept,
        "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}",
        "TERRAINAV_CONFIG_DIR": str(tmp_path / "config"),
        "TERRAINAV_CACHE_DIR": str(tmp_path / "cache"),
    }
    folder = tmp_path / "here"
    shutil.copytree(ROOT / "examples", folder / "examples")

    def run(line):
        return folder, subprocess.run(
            line,
            shell=True,
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            timeout=TIMEOUT_S,
            check=False,
        )

    return run


@pytest.mark.thorough
def test_the_documented_line_goes_from_capture_to_training(shell):
    pytest.importorskip("torch", reason="the walk's training is with PyTorch")
    line = documented()
    assert line.count(PAPERS_BOX) == 1
    folder, done = shell(line.replace(PAPERS_BOX, SMALL_BOX))
    assert done.returncode == 0, done.stderr

    dataset = read_dataset(folder / "agricenter")
    satellite, roadmap = (dataset.image_set(name) for name in ("satellite", "roadmap"))
    rejected = np.array([bool(mark) for mark in satellite.table.other["rejected"]])
    assert 0 < rejected.sum() < len(rejected), "the box has both kinds of places"
    assert np.array_equal(rejected, roadmap.table.entropies < 2.1)

    parts = np.array(image_parts(satellite.table))
    assert tuple(parts) == image_parts(roadmap.table)
    assert set(parts[rejected]) == {""}
    assert set(PARTS) <= set(parts[~rejected])
    labels = Labels.load(folder / "agricenter" / LABELS_FILE)
    assert labels.images == (parts == "train").sum()

    samples = LabelledImages(dataset, part="train")
    assert len(samples) == labels.images
    # Labels are scaled by the training part, and float32 keeps six digits.
    assert np.allclose(samples.values.mean(axis=0), 0.0, atol=1e-5)
    assert np.allclose(samples.values.std(axis=0), 1.0, atol=1e-5)
    assert f"{len(samples):,} images" in done.stdout

    (said,) = re.findall(r"^test, on ground not seen before: (\d+) of (\d+) at first rank", done.stdout, re.MULTILINE)
    assert int(said[1]) == (parts == "test").sum()
    assert int(said[0]) > int(said[1]) / 5
    assert done.stdout.splitlines()[-1].endswith(": better than chance")


def test_a_step_that_fails_stops_the_walk(shell):
    line = documented().replace(PAPERS_BOX, SMALL_BOX)
    _, _, after_capture = line.partition("&&")
    folder, done = shell(after_capture)
    assert done.returncode == 2
    assert done.stdout == ""
    (said,) = done.stderr.splitlines()
    assert said.startswith("terrainav: folder agricenter")
    assert not (folder / "agricenter").exists()


def test_the_capture_of_the_line_is_the_papers_mission():
    capture = shlex.split(documented().split("&&")[0])
    assert capture[capture.index("--coords") + 1] == PAPERS_BOX
    from terrainav.core.cli.options import parser

    arguments = parser().parse_args(capture[1:])
    assert arguments.data_dir == "agricenter"
    assert list(arguments.map_type) == ["satellite", "roadmap"]
