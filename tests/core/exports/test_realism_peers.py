"""Datasets with every effect of a real camera, and cameras that distort, in COLMAP, readers of tags and the loaders."""

from __future__ import annotations

import importlib.util
import re
import shutil

import pytest
from terrainav.core.cli import main

from tests.support.peers import BENCHMARKS, told_by_benchmark, told_by_peers

SCRIPT = "realism_peers.py"
pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def everything(tmp_path_factory):
    folder = tmp_path_factory.mktemp("everything")
    told_by_benchmark(SCRIPT, "capture", folder)
    return folder


def test_colmap_projects_points_to_their_pixels(everything):
    told = told_by_peers(BENCHMARKS / SCRIPT, "colmap", everything)
    models = [line.split(", ")[3] for line in told.splitlines()]
    of_lenses = "FULL_OPENCV", "OPENCV_FISHEYE", "FULL_OPENCV"
    assert models == [model for lens in of_lenses for model in (lens, lens, "PINHOLE")]


def test_tags_are_the_tables_values(everything):
    if shutil.which("exiftool") is None:
        pytest.skip("exiftool (Debian: libimage-exiftool-perl) is not installed")
    assert len(told_by_peers(BENCHMARKS / SCRIPT, "tags", everything).splitlines()) == 3


def test_loaders_give_images_and_random_values(everything):
    missing = [name for name in ("torch", "keras", "webdataset") if importlib.util.find_spec(name) is None]
    if missing:
        pytest.skip(f"{', '.join(missing)}: not installed")
    assert len(told_by_benchmark(SCRIPT, "loaders", everything).splitlines()) == 15


@pytest.mark.parametrize(
    "lens",
    ["", "--k1 -0.1 --p1 0.001", "--fov 80 --lens fisheye --k1 0.03 --k2=-0.01 --sampling area"],
    ids=["ideal", "brown", "fisheye"],
)
def test_colmap_triangulates_its_own_matches(tmp_path, lens):
    out, model = tmp_path / "out", tmp_path / "model"
    mission = "--coords 35.1450_-89.8620_35.1435_-89.8600_100 --frame camera --tilt 10 --yaw 20 --overlap 0.7"
    assert main(["capture", *mission.split(), *lens.split(), "--format", "jpg", "--data-dir", str(out)]) == 0
    assert main(["export", str(out), str(model), "--as", "colmap"]) == 0
    told = told_by_peers(BENCHMARKS / "export_peers.py", out / "satellite", model)
    assert float(re.search(r"reprojection error ([0-9.]+) px", told)[1]) < 0.35
