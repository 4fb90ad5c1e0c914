"""The example of an embedding: it finds what it has learned, and nothing before that."""

from __future__ import annotations

import re
import runpy
import sys
from pathlib import Path

import pytest
from terrainav.core.cli import main

pytest.importorskip("torch")
EXAMPLE = Path(__file__).resolve().parents[4] / "examples" / "train_embedding.py"
AREA = "35.1500_-89.9000_35.1440_-89.8930"


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """A benchmark of the synthetic world, and two captures of its places: ideal, and in random light."""
    folder = tmp_path_factory.mktemp("embedding")
    made = ("--format", "png", "--quiet", "--data-dir")
    size = ("--image-px", "90", "--zoom", "17")
    queries = ("--queries", "air=world", "--reference", "map=world", "--split", "none", "--yaw", "20")
    bench = folder / "bench"
    assert main(["benchmark", "make", "--coords", f"{AREA}_100", *size, *queries, *made, str(bench)]) == 0
    captures = []
    light = ("--exposure", "manual", "--exposure-ms", "1.5", "--vary", "exposure_ms=uniform(1,2)")
    for name, more in (("ideal", ()), ("varied", light)):
        view = ("--coords", f"{AREA}_130", "--aspect-ratio", "1", "1", "--overlap", "0.5")
        assert main(["capture", *view, "--img-size", "96", "96", "3", *more, *made, str(folder / name)]) == 0
        captures.append(folder / name)
    return bench, *captures


def run(monkeypatch, capsys, *arguments):
    """Run the example as a script, in this process; returns exit code and output."""
    monkeypatch.setattr(sys, "argv", ["train_embedding.py", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        runpy.run_path(str(EXAMPLE), run_name="__main__")
    return ended.value.code, capsys.readouterr().out


def test_places_are_found_by_what_was_learned(folders, monkeypatch, capsys):
    code, out = run(monkeypatch, capsys, *folders, "--steps", "40", "--seeds", "1", "--batch-size", "16")
    assert code == 0
    (share,) = re.findall(r"^Recall@1 of air: ([\d.]+) %", out, re.MULTILINE)
    (tiles,) = map(int, re.findall(r"(\d+) tiles", out))
    assert float(share) > 3.0 * 100.0 / tiles


def test_a_folder_that_is_no_dataset_is_named(folders, tmp_path, monkeypatch, capsys):
    code, _ = run(monkeypatch, capsys, folders[0], tmp_path)
    assert code.startswith(f"train_embedding: folder {tmp_path}: is not a dataset")
