"""Figures of a dataset's entropies: what they show of which images, and where they are written."""

from __future__ import annotations

import json
import shutil
import sys
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from terrainav.core.dataset import figures
from terrainav.core.dataset.clean import clean
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.entropy import deciding_entropies, entropy, image_entropies
from terrainav.core.dataset.figures import draw_bars, draw_histogram, save_figures
from terrainav.core.dataset.table import REJECTED, Table
from terrainav.core.errors import Cancelled, InvalidInput, OutputError
from terrainav.core.external import drawing

from tests.support.command import command
from tests.support.datasets import write_dataset

Figure = pytest.importorskip("matplotlib.figure", reason="matplotlib draws the figures").Figure

COUNT = 24
#: Sums of a thousand edges, bits.
ROUNDING = 1e-9
VALUES = np.array([0.0, 0.05, 2.0999, 2.1, 2.1001, 4.0, np.nan, 7.95, 8.0])
NAMES = [
    "entropy-bars-roadmap.png",
    "entropy-bars-satellite.png",
    "entropy-histogram-roadmap.png",
    "entropy-histogram-satellite.png",
]


def drawn(draw, values, threshold, **options):
    axes = Figure(figsize=(10, 5)).add_subplot()
    draw(axes, np.asarray(values, np.float64), threshold, **options)
    return axes


def legend(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


@pytest.fixture
def dataset(tmp_path):
    """Satellite and roadmap, whose last row has failed; of the roadmap row 3 as well, and entropies 0, 0.2, 0.4, …"""
    folder = write_dataset(tmp_path / "data", COUNT, map_types=("satellite", "roadmap"))
    path = folder / "roadmap" / "meta_data.csv"
    table = Table.load(path)
    bits = np.where(np.isnan(table.entropies), np.nan, 0.2 * np.arange(COUNT))
    bits[3] = np.nan
    status = tuple("failed" if index == 3 else one for index, one in enumerate(table.status))
    (folder / "roadmap" / table.img_names[3]).unlink()
    replace(table, entropies=bits, status=status).save(path)
    return folder


def files(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


# --- whose entropies


def test_the_roadmaps_entropies_decide_where_they_are_there(dataset):
    found = deciding_entropies(dataset)
    satellite, roadmap = found["satellite"], found["roadmap"]
    expected = 0.2 * np.arange(COUNT)
    expected[3], expected[-1] = 5.0, np.nan
    assert np.array_equal(satellite.entropies, expected, equal_nan=True)
    assert np.flatnonzero(~satellite.by_roadmap).tolist() == [3, COUNT - 1]
    assert not roadmap.by_roadmap.any()
    assert np.flatnonzero(~roadmap.made).tolist() == [3, COUNT - 1]
    assert satellite.names == Table.load(dataset / "satellite" / "meta_data.csv").img_names
    assert satellite.image_folder == dataset / "satellite"
    # What cleaning marks is what they say.
    clean(dataset, 2.1)
    marks = Table.load(dataset / "satellite" / "meta_data.csv").other[REJECTED]
    assert [bool(mark) for mark in marks] == (satellite.entropies < 2.1).tolist()


def test_own_entropies_are_the_tables_or_the_images(dataset):
    path = dataset / "satellite" / "meta_data.csv"
    table = Table.load(path)
    table.entropies[:2] = np.nan
    table.save(path)
    for given in (dataset, read_dataset(dataset)):
        own = image_entropies(given)
        pixels = [np.asarray(Image.open(dataset / "satellite" / name)) for name in table.img_names[:2]]
        assert own["satellite"][:2].tolist() == [entropy(one) for one in pixels]
        assert set(own["satellite"][2:-1]) == {5.0}
        assert np.isnan(own["satellite"][-1])
        assert own["roadmap"][5] == 1.0


def test_reading_images_can_be_stopped(dataset):
    path = dataset / "satellite" / "meta_data.csv"
    table = Table.load(path)
    table.entropies[:] = np.nan
    table.save(path)
    before, shares = files(dataset), []

    def stop(share):
        shares.append(share)
        return len(shares) < 5

    with pytest.raises(Cancelled, match="nothing was changed"):
        clean(dataset, progress=stop)
    assert shares == sorted(shares)
    assert len(shares) == 5
    assert files(dataset) == before


# --- what is drawn


@pytest.mark.parametrize("threshold", [0.0, 0.05, 2.1, 4.0, 7.97, 8.0])
def test_the_histogram_has_every_image_on_its_side_of_the_threshold(threshold):
    axes = drawn(draw_histogram, VALUES, threshold, suggested=3.0, title="some")
    rejected, kept = axes.containers
    there = VALUES[~np.isnan(VALUES)]
    assert sum(bar.get_height() for bar in rejected) == (there < threshold).sum()
    assert sum(bar.get_height() for bar in kept) == (there >= threshold).sum()
    assert all(bar.get_x() + bar.get_width() <= threshold + ROUNDING for bar in rejected)
    assert all(bar.get_x() >= threshold for bar in kept)
    for bar in [*rejected, *kept]:
        inside = (there >= bar.get_x() - ROUNDING) & (there < bar.get_x() + bar.get_width() + ROUNDING)
        assert bar.get_height() <= inside.sum()
    line, suggestion = axes.lines
    assert list(line.get_xdata()) == [threshold, threshold]
    assert list(suggestion.get_xdata()) == [3.0, 3.0]
    assert "bits" in axes.get_xlabel()
    assert axes.get_title(loc="left") == "some"


def test_the_legend_counts(monkeypatch):
    expected = [
        "threshold 2.1 bits",
        "Otsu's method: 3.00 bits",
        "rejected: 3 (37.5%)",
        "kept: 5 (62.5%)",
    ]
    for draw in (draw_histogram, draw_bars):
        assert legend(drawn(draw, VALUES, 2.1, suggested=3.0)) == expected
        assert legend(drawn(draw, VALUES, 2.1)) == [expected[0], *expected[2:]]
    monkeypatch.setattr(figures, "_COLUMNS", 3)
    assert legend(drawn(draw_bars, VALUES, 2.1, suggested=3.0)) == expected


def test_each_image_has_a_bar_of_its_height():
    axes = drawn(draw_bars, VALUES, 2.1)
    rejected, kept = (one.get_paths()[0].vertices for one in axes.collections)
    for index, value in enumerate(VALUES):
        for vertices, mine in ((rejected, value < 2.1), (kept, value >= 2.1)):
            over = vertices[(vertices[:, 0] > index) & (vertices[:, 0] < index + 1)]
            assert over[:, 1].max() == (value if mine else 0.0)
    assert list(axes.lines[0].get_ydata()) == [2.1, 2.1]
    assert "bits" in axes.get_ylabel()
    assert axes.get_xlim() == (0.0, len(VALUES))


def test_bars_that_share_a_column_cover_as_much_of_it_as_they_would_one_by_one():
    random = np.random.default_rng(5)
    values = random.uniform(0.0, 8.0, 100_001)
    values[:40_000:3] = random.uniform(0.0, 2.1, len(values[:40_000:3]))
    values[7] = np.nan
    axes = drawn(draw_bars, values, 2.1)
    shades = np.asarray(axes.images[0].get_array())
    rows, columns = shades.shape[:2]
    per_column = 101
    assert columns == -(-len(values) // per_column) <= 1000
    assert list(axes.images[0].get_extent()) == [0.0, columns * per_column, 0.0, 8.0]
    assert f"{per_column} to a column" in axes.get_xlabel()
    # Grey and blue are told apart by solving for their shares in red, green and blue over white.
    colours = np.array([[0x9A, 0x9A, 0x9A], [0x00, 0x72, 0xB2]]) / 255.0 - 1.0
    shares = (shades - 1.0).reshape(-1, 3) @ np.linalg.pinv(colours)
    heights = shares.reshape(rows, columns, 2).sum(axis=0) * (8.0 / rows)
    padded = np.full(columns * per_column, np.nan)
    padded[: len(values)] = values
    groups = padded.reshape(columns, per_column)
    # The last column has fewer.
    images = np.minimum(len(values) - per_column * np.arange(columns), per_column)
    for at, mine in ((0, groups < 2.1), (1, groups >= 2.1)):
        # Each bar's top is rounded to the nearest row.
        expected = np.where(mine, groups, 0.0).sum(axis=1) / images
        assert np.abs(heights[:, at] - expected).max() < 0.5 * 8.0 / rows


def test_all_alike_or_nothing_is_drawn_too():
    for draw in (draw_histogram, draw_bars):
        assert "kept: 0" in legend(drawn(draw, [], 2.1))
        assert "rejected: 4 (100.0%)" in legend(drawn(draw, [0.0] * 4, 2.1))


# --- files


def test_figures_are_written_and_the_dataset_is_left_alone(dataset, tmp_path, monkeypatch):
    monkeypatch.setattr(drawing, "_DPI", 90)
    before = files(dataset)
    paths = save_figures(dataset, tmp_path / "deep" / "figures", 2.1)
    assert sorted(path.name for path in paths) == NAMES
    for path in paths:
        with Image.open(path) as image:
            image.load()
            assert image.format == "PNG"
            colours = {colour for _, colour in image.convert("RGB").getcolors(1 << 24)}
        # Threshold, rejected and kept ones.
        assert {(0xD5, 0x5E, 0x00), (0x9A, 0x9A, 0x9A), (0x00, 0x72, 0xB2)} <= colours
    written = files(tmp_path / "deep")
    save_figures(dataset, tmp_path / "deep" / "figures", 2.1)
    assert files(tmp_path / "deep") == written
    assert files(dataset) == before


def test_titles_say_whose_entropies_they_are(dataset, tmp_path, monkeypatch):
    titles = []
    monkeypatch.setattr(drawing, "_DPI", 20)
    monkeypatch.setattr(figures, "draw_histogram", lambda *_arguments, **_options: None)
    monkeypatch.setattr(figures, "draw_bars", lambda *_arguments, title, **_options: titles.append(title))
    save_figures(dataset, tmp_path / "figures", 2.1)
    assert titles == [
        "roadmap: 22 images by their entropies",
        "satellite: 23 images by the entropies of the roadmap, 1 by their own",
    ]


def test_a_map_type_without_images_has_no_figures(dataset, tmp_path, monkeypatch):
    monkeypatch.setattr(drawing, "_DPI", 40)
    path = dataset / "roadmap" / "meta_data.csv"
    table = Table.load(path)
    for image in (dataset / "roadmap").glob("*.png"):
        image.unlink()
    replace(table, status=("failed",) * COUNT).save(path)
    paths = save_figures(dataset, tmp_path / "figures", 2.1)
    assert sorted(path.name for path in paths) == [name for name in NAMES if "satellite" in name]


def test_what_is_no_dataset_has_none(tmp_path):
    with pytest.raises(InvalidInput, match="is not a dataset"):
        save_figures(tmp_path, tmp_path / "figures", 2.1)
    assert not (tmp_path / "figures").exists()


def test_without_matplotlib_one_line_says_how_to_get_it_and_nothing_is_changed(dataset, tmp_path, monkeypatch):
    before = files(dataset)
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    for draw in (
        lambda: clean(dataset, plot=tmp_path / "figures"),
        lambda: save_figures(dataset, tmp_path / "figures", 2.1),
    ):
        with pytest.raises(OutputError, match=r"matplotlib.* pip install 'terrainav\[report\]'") as refused:
            draw()
        assert "\n" not in str(refused.value)
    assert files(dataset) == before
    assert not (tmp_path / "figures").exists()
    # What draws nothing needs none.
    clean(dataset)


def test_where_figures_cannot_be_written_nothing_is_cleaned(dataset, tmp_path):
    before = files(dataset)
    (tmp_path / "taken").write_text("what somebody noted")
    with pytest.raises(OutputError, match="a file is in its place"):
        clean(dataset, plot=tmp_path / "taken")
    assert files(dataset) == before


# --- the command


def test_the_command(dataset, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(drawing, "_DPI", 40)
    run = command(tmp_path, monkeypatch, capsys)
    before = files(dataset)
    dry = run("clean", str(dataset), "--dry-run", "--plot", "figures")
    assert dry.returncode == 0, dry.stderr
    assert sorted(path.name for path in (tmp_path / "figures").iterdir()) == NAMES
    for name in NAMES:
        assert any(line.startswith("written") and line.endswith(name) for line in dry.stdout.splitlines())
    assert dry.stdout.splitlines()[-1] == "dry run: nothing was changed in the dataset"
    assert files(dataset) == before
    # Again, and in earnest: the same figures take the place of the earlier ones.
    pictures = files(tmp_path / "figures")
    done = run("clean", str(dataset), "--plot", "figures", "--json")
    assert {name for one in json.loads(done.stdout) for name in one["figures"]} == {
        str(path.relative_to(tmp_path)) for path in (tmp_path / "figures").iterdir()
    }
    assert files(tmp_path / "figures") == pictures
    assert files(dataset) != before
    shutil.rmtree(dataset / "roadmap")
    assert run("clean", str(dataset), "--plot", "figures").stdout.count("replaced  ") == len(NAMES) // 2


@pytest.mark.parametrize(
    ("arguments", "words"),
    [(("--undo", "--plot", "figures"), "does not go with --undo"), (("--plot", ""), "name of a folder")],
)
def test_the_command_refuses(dataset, tmp_path, monkeypatch, capsys, arguments, words):
    before = files(tmp_path)
    refused = command(tmp_path, monkeypatch, capsys)("clean", str(dataset), *arguments)
    assert refused.returncode == 2
    assert words in refused.stderr
    assert len(refused.stderr.splitlines()) == 1
    assert files(tmp_path) == before
