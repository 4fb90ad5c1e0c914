"""Names that no file can be written with, no terminal prints, or other programs would read as something else."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from urllib.parse import unquote

import numpy as np
import pytest
from terrainav.core.external import drawing
from terrainav.core.text.plain import writable

from tests.support import rasters
from tests.support.command import command
from tests.support.datasets import write_dataset

#: No text in UTF-8: Python has half characters for its bytes.
BYTES = os.fsdecode(b"d\xff\xfe")
COORDS = "35.16_-89.90_35.155_-89.89_400"
#: Mathematical text to matplotlib, or broken mathematical text.
FORMULAS = (
    r"$\frac{a$",
    "$$$",
    r"$a_b^c$",
    r"\$5 and 7$",
    "100 %",
    "a_b",
    "^",
    "\\",
    "$" + "{" * 50 + "$",
    "a\x07b",
    "\ud800",
)


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    return command(tmp_path, monkeypatch, capsys)


@pytest.fixture
def odd_folder(tmp_path):
    """A dataset in a folder whose name is no UTF-8."""
    try:
        return write_dataset(tmp_path / BYTES, 3)
    except OSError:
        pytest.skip("this file system has no such names")


@pytest.mark.parametrize("name", FORMULAS)
def test_names_are_drawn_as_they_are(name):
    pytest.importorskip("matplotlib", reason="matplotlib draws")
    figure = drawing.new_figure(3.0, 2.0)
    axes = figure.add_subplot()
    drawing.dress(axes, name, name, name)
    axes.plot([0.0, 1.0], [1.0, 2.0], label=name)
    axes.annotate(name, (0.5, 1.5))
    axes.legend(title=name)
    assert drawing.png(figure).startswith(b"\x89PNG")
    own = axes.title, axes.xaxis.label, axes.yaxis.label, *axes.get_legend().get_texts()
    assert not any(text.get_parse_math() or text.get_usetex() for text in [*own, axes.texts[0]])


def test_a_formula_is_drawn_like_any_other_letters():
    """The width of what is drawn is that of all letters of the name, dollars and backslashes too."""
    pytest.importorskip("matplotlib", reason="matplotlib draws")
    widths = []
    for name in (r"$\alpha$", r"S\alphaS"):
        figure = drawing.new_figure(3.0, 2.0)
        text = figure.text(0.1, 0.5, name)
        drawing.png(figure)
        widths.append(text.get_window_extent().width)
    formula, letters = widths
    assert formula == pytest.approx(letters, rel=0.1)


def test_latex_of_the_users_settings_is_not_asked_for_names():
    matplotlib = pytest.importorskip("matplotlib", reason="matplotlib draws")
    with matplotlib.rc_context({"text.usetex": True}):
        figure = drawing.new_figure(3.0, 2.0)
        title = figure.text(0.1, 0.5, r"\input{secret}")
        assert title.get_usetex()
        assert drawing.png(figure).startswith(b"\x89PNG")
        assert not title.get_usetex()


def test_a_folder_whose_name_is_no_utf_8_is_described(run, odd_folder):
    pytest.importorskip("pyarrow", reason="STAC's items are Parquet")
    for kind in ("stac", "croissant"):
        done = run("export", "--as", kind, str(odd_folder))
        assert done.returncode == 0, done.stderr
    shown = json.loads((odd_folder / "croissant.json").read_text("utf-8"))["name"]
    assert shown == writable(BYTES) == "d\ufffd\ufffd"
    assert json.loads((odd_folder / "collection.json").read_text("utf-8"))["id"] == shown


@pytest.mark.parametrize("kind", ["stac", "croissant"])
def test_a_map_type_whose_name_is_no_utf_8_is_refused(run, tmp_path, kind):
    pytest.importorskip("pyarrow", reason="STAC's items are Parquet")
    folder = write_dataset(tmp_path / "data", 3)
    try:
        (folder / "satellite").rename(folder / BYTES)
    except OSError:
        pytest.skip("this file system has no such names")
    done = run("export", "--as", kind, str(folder), "--map-type", BYTES)
    assert done.returncode == 2
    assert "its name is not UTF-8" in done.stderr


def test_links_to_images_are_percent_encoded(run, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet", reason="STAC's items are Parquet")
    folder = write_dataset(tmp_path / "data", 3)
    name = "a #1?%41é" if os.name != "nt" else "a #1%41é"
    (folder / "satellite").rename(folder / name)
    done = run("export", "--as", "stac", str(folder), "--map-type", name)
    assert done.returncode == 0, done.stderr
    for assets in parquet.read_table(folder / "items.parquet")["assets"].to_pylist():
        href = assets["image"]["href"]
        assert href.isascii()
        assert not set("#? ") & set(href)
        assert (folder / unquote(href)).is_file()


@pytest.mark.skipif(os.name == "nt", reason="Windows makes links for administrators only")
@pytest.mark.parametrize("kind", ["stac", "croissant", "parquet"])
def test_a_map_type_may_be_a_link(run, tmp_path, kind):
    """As to another disk: descriptions go by its name in the dataset, which leads to the same files."""
    pytest.importorskip("pyarrow", reason="tables as Parquet")
    folder = write_dataset(tmp_path / "data", 3)
    (folder / "satellite").rename(tmp_path / "elsewhere")
    (folder / "satellite").symlink_to(tmp_path / "elsewhere", target_is_directory=True)
    done = run("export", "--as", kind, str(folder))
    assert done.returncode == 0, done.stderr
    if kind == "croissant":
        files = json.loads((folder / "croissant.json").read_text("utf-8"))["distribution"]
        assert files[0]["contentUrl"] == "satellite/meta_data.csv"


@pytest.mark.thorough
def test_what_the_output_has_no_word_for_is_printed_all_the_same(tmp_path):
    """Of names in an encoding that lacks them, and of names that are no text."""
    folder = tmp_path / "é"
    for name, encoding in ((folder, "ascii"), (tmp_path / BYTES, "utf-8")):
        asked = ("capture", "--coords", COORDS, "--image-px", "20", "--quiet", "--data-dir", str(name))
        done = subprocess.run(
            [sys.executable, "-m", "terrainav.core.cli", *asked],
            cwd=tmp_path,
            env={**os.environ, "PYTHONIOENCODING": encoding, "TERRAINAV_CACHE_DIR": str(tmp_path / "cache")},
            capture_output=True,
            timeout=300,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        assert b"dataset in" in done.stdout


def test_a_source_whose_name_is_no_utf_8_is_refused_in_one_line(run, tmp_path):
    """Missions are UTF-8 and name their source: a file that they cannot name is not flown over."""
    plain = tmp_path / "r.tif"
    rasters.write(plain, np.zeros((1, 300, 300), np.uint8), (-89.90, 1e-4, 0.0, 35.16, 0.0, -1e-4), 4326)
    try:
        path = plain.rename(tmp_path / f"{BYTES}.tif")
    except OSError:
        pytest.skip("this file system has no such names")
    asked = ("--coords", "35.155_-89.895_100", "--data-dir", "out", "--quiet")
    done = run("capture", *asked, "--source", str(path))
    assert done.returncode in (2, 3), done.stderr
    (line,) = done.stderr.splitlines()
    assert "internal error" not in line


def test_a_name_with_nul_is_refused_in_one_line(run, tmp_path):
    """No system has such names, and Python's own error of them says nothing of what it is about."""
    (tmp_path / "config.json").write_text(json.dumps({"coords": COORDS, "no_fly": "a\0b"}))
    done = run("plan")
    assert done.returncode == 2, done.stderr
    (line,) = done.stderr.splitlines()
    assert "null character" in line
