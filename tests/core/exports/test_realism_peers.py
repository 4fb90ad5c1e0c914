"""Datasets with every effect of a real camera, in COLMAP, readers of tags and the loaders."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.peers import told_by_peers

SCRIPT = Path(__file__).parents[3] / "benchmarks" / "realism_peers.py"
pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def everything(tmp_path_factory):
    folder = tmp_path_factory.mktemp("everything")
    run("capture", folder)
    return folder


def run(action: str, folder: Path) -> str:
    command = [sys.executable, SCRIPT, action, folder]
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=1800)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_colmap_projects_points_to_their_pixels(everything):
    told = told_by_peers(SCRIPT, "colmap", everything)
    assert [line.split(", ")[1] for line in told.splitlines()] == ["FULL_OPENCV"] * 2 + ["OPENCV_FISHEYE"] * 2


def test_tags_are_the_tables_values(everything):
    if shutil.which("exiftool") is None:
        pytest.skip("exiftool (Debian: libimage-exiftool-perl) is not installed")
    assert len(told_by_peers(SCRIPT, "tags", everything).splitlines()) == 3


def test_loaders_give_images_and_random_values(everything):
    missing = [name for name in ("torch", "keras", "webdataset") if importlib.util.find_spec(name) is None]
    if missing:
        pytest.skip(f"{', '.join(missing)}: not installed")
    assert len(run("loaders", everything).splitlines()) == 11
