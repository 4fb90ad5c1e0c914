"""The example of segmentation: what it counts, and that it learns what images show, and nothing from noise."""

from __future__ import annotations

import json
import re
import runpy
import sys
from pathlib import Path

import numpy as np
import pytest
from pyproj import Transformer
from terrainav.core.geodesy.triangles import ROOF
from terrainav.core.world.houses import WorldHouses
from terrainav.core.world.lattice import chart_seed

from tests.support.datasets import write_dataset
from tests.support.labelled import NAMES, write_labelled

pytest.importorskip("torch")
shapely = pytest.importorskip("shapely")
EXAMPLES = Path(__file__).resolve().parents[4] / "examples"
#: Neither stops by the clock.
CHOICE = ("--minutes", "1000", "--batch-size", "4", "--img-size", "64", "48", "3")


@pytest.fixture
def run(monkeypatch, capsys):
    """Run an example as a script, in this process, where PyTorch is loaded already; returns exit code and output."""

    def example(name, *arguments):
        monkeypatch.setattr(sys, "argv", [name, *map(str, arguments)])
        try:
            runpy.run_path(str(EXAMPLES / name), run_name="__main__")
        except SystemExit as ended:
            return ended.code, capsys.readouterr().out
        return 0, capsys.readouterr().out

    return example


@pytest.fixture(scope="module")
def parts():
    """Functions of the example."""
    return runpy.run_path(str(EXAMPLES / "train_segmentation.py"), run_name="example")


def rows(out):
    """Accuracy, mean and each class's intersection over union by name."""
    found = re.findall(r"^(\S.*?) +([\d.]+) % +([\d.]+)((?: +\S+)*)$", out, re.MULTILINE)
    return {name: [float(accuracy), float(mean), *map(float, each.split())] for name, accuracy, mean, each in found}


def test_what_is_seen_is_learned_and_noise_is_not(tmp_path, run):
    here, there = write_labelled(tmp_path / "here"), write_labelled(tmp_path / "there", 20)
    code, out = run("train_segmentation.py", here, there, "--epochs", "8", *CHOICE)
    assert "16 images to train on, 20 to judge by: background, " + ", ".join(NAMES) in out
    assert re.search(r"^labels: 32 steps, 8.0 epochs, loss ", out, re.MULTILINE)
    found = rows(out)
    assert list(found) == ["network", "noise labels", "majority class", "random by frequency"]
    assert all(len(one) == 2 + 7 for one in found.values())
    assert found["network"][1] > 0.18
    assert found["noise labels"][1] < 0.15
    assert found["majority class"][1] < 0.05
    assert out.splitlines()[-1] == "better than noise and chance"
    assert code == 0


def test_scores_are_those_worked_by_hand(parts):
    wanted, found = np.array([0, 0, 0, 1, 1, -1, 0]), np.array([0, 0, 1, 1, 0, 1, 0])
    pixels = parts["confusion"](wanted, found, 3)
    np.testing.assert_array_equal(pixels, [[3, 1, 0], [1, 1, 0], [0, 0, 0]])
    score = parts["score"](pixels)
    assert score.accuracy == 4 / 6
    np.testing.assert_allclose(score.iou, [3 / 5, 1 / 3, np.nan])
    assert score.mean_iou == pytest.approx((3 / 5 + 1 / 3) / 2)


def test_chance_is_what_draws_get(parts):
    trained, judged = np.array([60, 30, 10]), np.array([400_000, 500_000, 100_000])
    found = parts["chance"](trained, judged)
    wanted = np.repeat([0, 1, 2], judged)
    drawn = np.random.default_rng(1).choice(3, len(wanted), p=trained / 100)
    for name, guess in (("majority class", np.zeros_like(wanted)), ("random by frequency", drawn)):
        score = parts["score"](parts["confusion"](wanted, guess, 3))
        assert found[name].accuracy == pytest.approx(score.accuracy, abs=5e-3)
        np.testing.assert_allclose(found[name].iou, score.iou, atol=5e-3)


def test_datasets_that_do_not_fit_are_refused_in_one_line(tmp_path, run):
    here, bare = write_labelled(tmp_path / "here"), write_dataset(tmp_path / "bare")
    code, out = run("train_segmentation.py", here, bare, *CHOICE)
    assert code.startswith(f"train_segmentation: folder {bare}: has no classes.json")
    other = write_labelled(tmp_path / "other")
    table = json.loads((other / "classes.json").read_text())
    table["classes"].pop()
    (other / "classes.json").write_text(json.dumps(table))
    code, out = run("train_segmentation.py", here, other, *CHOICE)
    assert code == f"train_segmentation: {other} has the classes background, {', '.join(NAMES[:-1])}"
    assert out == ""
    code, _ = run("train_segmentation.py", here, here, "--img-size", "60", "60", "3")
    assert code == 2


def test_houses_are_as_large_as_their_roofs(tmp_path, run):
    code, out = run("world_houses.py", "35.1412_-89.8612_35.1405_-89.8603", tmp_path / "houses.geojson")
    assert code == 0
    found = json.loads((tmp_path / "houses.geojson").read_text())["features"]
    assert out == f"{len(found):,} houses in {tmp_path / 'houses.geojson'}\n"
    assert {one["properties"]["roof"] for one in found} == {"flat", "gabled"}
    shapes = [shapely.geometry.shape(one["geometry"]) for one in found]
    assert all(one.is_valid and len(one.exterior.coords) == 5 for one in shapes)
    sides = np.array([35.1405, 35.1412]), np.array([-89.8612, -89.8603])
    houses = WorldHouses(chart_seed(2024, 0)).triangles(*sides)
    roofs = houses.take(houses.kind == ROOF)
    assert len(np.unique(roofs.instance)) > 10
    to_degrees = Transformer.from_crs("EPSG:4978", "EPSG:4979", always_xy=True)
    lon, lat, _ = to_degrees.transform(*np.moveaxis(roofs.corners_m, -1, 0))
    for number in np.unique(roofs.instance):
        of_house = np.stack([lon, lat], axis=-1)[roofs.instance == number]
        seen = shapely.union_all(shapely.polygons(of_house), grid_size=1e-9)
        (same,) = [one for one in shapes if one.contains(seen.centroid)]
        assert same.symmetric_difference(seen).area < 1e-3 * seen.area
    assert all(3.0 < one["properties"]["height"] < 30.0 for one in found)
