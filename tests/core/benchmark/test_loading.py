"""Pairs of queries and tiles: those that the benchmark's truth has, with footprints intersected by another program."""

from __future__ import annotations

import csv
import os

import numpy as np
import pytest
from osgeo import ogr
from PIL import Image
from terrainav.core.benchmark.folder import Benchmark
from terrainav.core.benchmark.loading import Pairs
from terrainav.core.dataset.loading import Batches
from terrainav.core.errors import InvalidInput

from tests.core.benchmark.test_making import ground_ellipsoid

SIZE = (16, 12, 3)


def rows_of(path):
    with path.open(newline="", encoding="utf-8") as file:
        return {row["id"]: row for row in csv.DictReader(file)}


def polygon(x, y):
    ring = ogr.Geometry(ogr.wkbLinearRing)
    for corner in [*zip(x, y), (x[0], y[0])]:
        ring.AddPoint_2D(*map(float, corner))
    whole = ogr.Geometry(ogr.wkbPolygon)
    whole.AddGeometry(ring)
    return whole


def test_pairs_have_the_intersection_over_union_that_gdal_finds(benchmark):
    pairs = Pairs(benchmark.folder, part="all", img_size=SIZE)
    queries, tiles = (rows_of(benchmark.folder / name) for name in ("queries.csv", "references.csv"))
    footprints = {}
    for name, row in queries.items():
        width, height = float(row["width_px"]), float(row["height_px"])
        along = np.linspace(0.0, 1.0, 30)
        x = np.concatenate([along, np.ones(30), along[::-1], np.zeros(30)]) * width
        y = np.concatenate([np.zeros(30), along, np.ones(30), along[::-1]]) * height
        footprints[name] = polygon(*ground_ellipsoid(row, x, y))
    squares = {}
    for name, row in tiles.items():
        west, south, east, north = (float(row[edge]) for edge in ("west", "south", "east", "north"))
        squares[name] = polygon([west, east, east, west], [south, south, north, north])
    expected = {}
    for query, footprint in footprints.items():
        for tile, square in squares.items():
            shared = footprint.Intersection(square).Area()
            iou = shared / (footprint.Area() + square.Area() - shared)
            if iou > 0.14:
                expected[f"{query} {tile}"] = iou
    # At the limit itself a rounding decides.
    missing = set(expected) ^ set(pairs.names)
    assert all(expected.get(name, 0.14) < 0.1402 for name in missing)
    for name, (iou, positive) in zip(pairs.names, pairs.values.tolist()):
        assert iou == pytest.approx(expected.get(name, 0.14), abs=2e-3)
        assert bool(positive) == (iou >= np.float32(0.39))
    assert 0 < pairs.values[:, 1].sum() < len(pairs)


def test_pairs_are_those_of_the_truth_in_each_part(benchmark):
    with (benchmark.folder / "positives.csv").open(newline="", encoding="utf-8") as file:
        truth = [(row["query"], row["reference"], row["kind"]) for row in csv.DictReader(file)]
    part_of = {name: row["part"] for name, row in rows_of(benchmark.folder / "queries.csv").items()}
    for part in ("train", "validation", "test"):
        for with_semi in (True, False):
            pairs = Pairs(benchmark, part=part, with_semi=with_semi, img_size=SIZE)
            wanted = [
                f"{query} {tile}"
                for query, tile, kind in truth
                if part_of[query] == part and (with_semi or kind == "positive")
            ]
            assert list(pairs.names) == wanted
    with pytest.raises(InvalidInput, match="part 'tests': must be one of"):
        Pairs(benchmark, part="tests", img_size=SIZE)


def test_batches_have_the_images_of_their_pairs(benchmark):
    pairs = Pairs(benchmark, part="test", img_size=SIZE, tile_size=(20, 20, 1), dtype="uint8", shuffle=True)
    queries, tiles = (rows_of(benchmark.folder / name) for name in ("queries.csv", "references.csv"))
    loader = Batches(pairs, 5)
    first = list(loader)
    assert sum(len(labels) for _, labels in first) == len(pairs)
    order = pairs.order(0).tolist()
    assert sorted(order) == list(range(len(pairs))) != order
    (some, others), labels = first[0]
    assert (some.shape, others.shape) == ((5, 12, 16, 3), (5, 20, 20, 1))
    for at, number in enumerate(order[:5]):
        query, tile = pairs.names[number].split(" ")
        for rows, name, pixels, size, mode in (
            (queries, query, some[at], (16, 12), "RGB"),
            (tiles, tile, others[at, ..., 0], (20, 20), "L"),
        ):
            image = Image.open(benchmark.folder / rows[name]["file"]).convert("RGB").convert(mode)
            expected = np.asarray(image.resize(size, Image.Resampling.BILINEAR))
            assert np.abs(pixels.astype(int) - expected).max() <= 1
        np.testing.assert_array_equal(labels[at], pairs.values[number])
    threads = list(Batches(pairs, 5, workers=2))
    for ((one, two), values), ((other, another), same) in zip(first, threads):
        for left, right in ((one, other), (two, another), (values, same)):
            np.testing.assert_array_equal(left, right)
    loader.set_epoch(1)
    assert pairs.order(1).tolist() != order
    with pytest.raises(InvalidInput, match="img_size: is chosen where the pairs are made"):
        Batches(pairs, 5, img_size=SIZE)


def test_an_interrupted_epoch_goes_on(benchmark):
    pairs = Pairs(benchmark, part="train", img_size=SIZE)
    first = Batches(pairs, 4)
    begun = iter(first)
    next(begun)
    state = first.state_dict()
    rest, again = list(begun), Batches(Pairs(benchmark, part="train", img_size=SIZE), 4)
    again.load_state_dict(state)
    for ((one, _), _), ((other, _), _) in zip(rest, again):
        np.testing.assert_array_equal(one, other)


def test_torch_has_the_same_pairs(benchmark):
    pytest.importorskip("torch")
    from terrainav.core.dataset.loading.torch_loader import TorchDataset

    pairs = Pairs(benchmark, part="train", img_size=SIZE)
    for ((queries, tiles), labels), ((some, others), values) in zip(Batches(pairs, 4), TorchDataset(pairs).batches(4)):
        np.testing.assert_array_equal(some.numpy(), queries.transpose(0, 3, 1, 2))
        np.testing.assert_array_equal(others.numpy(), tiles.transpose(0, 3, 1, 2))
        np.testing.assert_array_equal(values.numpy(), labels)
    (query, tile), label = TorchDataset(pairs)[1]
    assert (tuple(query.shape), tuple(tile.shape), tuple(label.shape)) == ((3, 12, 16), (3, 12, 16), (2,))


@pytest.mark.thorough
def test_keras_has_the_same_pairs(benchmark):
    pytest.importorskip("torch")
    os.environ.setdefault("KERAS_BACKEND", "torch")
    pytest.importorskip("keras")
    from terrainav.core.dataset.loading.keras_loader import KerasDataset

    pairs = Pairs(benchmark, part="train", img_size=SIZE)
    dataset = KerasDataset(pairs, batch_size=4)
    for at, ((queries, tiles), labels) in enumerate(Batches(pairs, 4)):
        (some, others), values = dataset[at]
        for left, right in ((some, queries), (others, tiles), (values, labels)):
            np.testing.assert_array_equal(left, right)


def test_a_benchmark_of_before_is_loaded(benchmark, tmp_path):
    """Whose sizes have decimals, and which says nothing of what is inside."""
    for path in benchmark.folder.glob("*.*"):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    text = (tmp_path / "queries.csv").read_text()
    (tmp_path / "queries.csv").write_text(text.replace(",79,59", ",79.0,59.0"))
    assert (
        Pairs(Benchmark.read(tmp_path), part="all", img_size=SIZE).names
        == Pairs(benchmark, part="all", img_size=SIZE).names
    )
