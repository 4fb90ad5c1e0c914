"""Captures in view are found, counted and summed as brute force finds them, and few others are looked at."""

from __future__ import annotations

import numpy as np
import pytest
from qgis.core import QgsPointXY
from terrainav.core.geodesy.mercator import HALF_WORLD_M
from terrainav.terrainav_plugin.preview.density import DensityCells, density_features, levels, mean_images
from terrainav.terrainav_plugin.preview.index import CaptureIndex, Rects, count_shown
from terrainav.terrainav_plugin.preview.view import WORLD, WORLD_M, Rect

# Of edges in metres, 4 nm, in cells of a centimetre, for dozens of images.
_ROUNDING = 1e-5
RECTS = [
    Rect(-1e6, -1e6, 1e6, 1e6),
    Rect(19e6, -3e6, 23e6, 2e6),
    Rect(-HALF_WORLD_M, -2e6, -19.5e6, 2e6),
    Rect(123.0, 77.0, 124.0, 78.0),
    Rect(HALF_WORLD_M - 1.0, -9e6, HALF_WORLD_M + WORLD_M - 2.0, 9e6),
    WORLD,
]


@pytest.fixture(scope="module")
def boxes():
    """Rectangles of a metre to half the world, all over it and across its end."""
    rng = np.random.default_rng(5)
    count = 3000
    width = np.exp(rng.uniform(0.0, np.log(2e7), count))
    height = width * rng.uniform(0.3, 3.0, count)
    x = rng.uniform(-3.0, 3.0, count) * HALF_WORLD_M
    y = rng.uniform(-0.9, 0.9, count) * HALF_WORLD_M
    return Rects.wrapped(x, y - height / 2.0, x + width, y + height / 2.0)


def turned(boxes):
    """Every rectangle at each of its places on a world that repeats itself."""
    return [(boxes.west + shift, boxes.south, boxes.east + shift, boxes.north) for shift in (-WORLD_M, 0, WORLD_M)]


@pytest.mark.parametrize("rect", RECTS)
@pytest.mark.parametrize("from_m", [0.0, 50.0, 1e5])
def test_index_finds_what_brute_force_finds(boxes, rect, from_m):
    index = CaptureIndex(boxes)
    expected = np.zeros(len(boxes.west), bool)
    for west, south, east, north in turned(boxes):
        expected |= (west <= rect.east) & (east >= rect.west) & (south <= rect.north) & (north >= rect.south)
    expected &= np.maximum(boxes.east - boxes.west, boxes.north - boxes.south) >= from_m
    assert index.find(rect, from_m).tolist() == np.flatnonzero(expected).tolist()
    assert index.count(rect, from_m) >= expected.sum()


def test_query_touches_few_captures_outside_of_the_view():
    """Of a million captures a view of a thousand touches few more: a ring of bins around it."""
    side = 1000
    west, south = (values.ravel() * 100.0 for values in np.meshgrid(np.arange(side), np.arange(side)))
    index = CaptureIndex(Rects.wrapped(west, south, west + 101.0, south + 99.0))
    view = Rect(50_000.0, 40_000.0, 53_000.0, 43_000.0)
    # The last that starts before the view reaches a metre into it; upwards each ends a metre short.
    assert len(index.find(view)) == 32 * 31
    assert index.count(view) <= 37 * 37


@pytest.mark.parametrize("rect", RECTS)
def test_density_is_the_mean_number_of_images_over_each_cell(boxes, rect):
    cells = DensityCells.covering(rect, 100.0 / rect.longer_m)
    x = -HALF_WORLD_M + cells.size_m * (cells.column + np.arange(cells.columns + 1))
    y = -HALF_WORLD_M + cells.size_m * (cells.row + np.arange(cells.rows + 1))
    assert x[0] <= rect.west
    assert x[-1] >= rect.east
    expected = np.zeros((cells.rows, cells.columns))
    for west, south, east, north in turned(boxes):
        across, along = (
            np.clip(np.minimum(last[:, None], at[1:]) - np.maximum(first[:, None], at[:-1]), 0.0, None)
            for first, last, at in ((west, east, x), (south, north, y))
        )
        expected += along.T @ across / cells.size_m**2
    assert mean_images(boxes, cells) == pytest.approx(expected, rel=1e-9, abs=_ROUNDING)


def test_a_regular_mission_has_no_pattern_from_afar():
    """Images with 60 and 30 % overlap, smaller than a cell: the same everywhere but at the mission's border."""
    side = 400
    west, south = (at.ravel() for at in np.meshgrid(np.arange(side) * 40.0, np.arange(side) * 52.5))
    boxes = Rects.wrapped(west, south, west + 100.0, south + 75.0)
    cells = DensityCells.covering(Rect(1000.0, 1000.0, 15_000.0, 19_000.0), 0.04)
    inner = levels(mean_images(boxes, cells))[2:-2, 2:-2] / 4.0
    assert cells.size_m > 100.0
    # One step of the levels about the mean that every place has: all of one colour.
    assert set(np.unique(inner)) <= {3.5, 3.75}


def test_levels_are_few_and_near():
    means = np.geomspace(0.2, 3e4, 10_000)
    shown = levels(means) / 4.0
    assert (np.abs(shown - means) <= np.maximum(0.125, means / 10.0)).all()
    assert len(np.unique(shown)) < 160
    assert levels(np.zeros(1)) == [0]


def test_density_features_hold_the_cells_of_their_level():
    rect = Rect(HALF_WORLD_M - 300.0, 0.0, HALF_WORLD_M + 300.0, 300.0)
    cells = DensityCells.covering(rect, 0.4)
    rng = np.random.default_rng(6)
    quarters = rng.integers(0, 4, (cells.rows, cells.columns))
    features = density_features(quarters, cells)
    assert [feature.attributes() for feature in features] == [[0.25], [0.5], [0.75]]
    areas = {feature.attributes()[0]: feature.geometry().area() for feature in features}
    for images, area in areas.items():
        assert area == pytest.approx((quarters == 4.0 * images).sum() * cells.size_m**2, rel=1e-6)
    for row in range(cells.rows):
        for column in range(cells.columns):
            x = -HALF_WORLD_M + (cells.column + column + 0.5) * cells.size_m
            x -= WORLD_M if x > HALF_WORLD_M else 0.0
            middle = QgsPointXY(x, -HALF_WORLD_M + (cells.row + row + 0.5) * cells.size_m)
            there = [f.attributes()[0] for f in features if f.geometry().contains(middle)]
            expected = quarters[row, column] / 4.0
            assert there == ([expected] if expected else [])


def test_cells_keep_their_places_when_the_map_moves():
    before = DensityCells.covering(Rect(1000.0, 1000.0, 9000.0, 7000.0), 0.1)
    after = DensityCells.covering(Rect(1033.0, 1011.0, 9033.0, 7011.0), 0.1)
    assert before.level == after.level
    assert 8.0 <= before.size_m * 0.1 < 16.0


def test_overlap_of_a_place_is_the_number_of_images_that_show_it(boxes):
    rng = np.random.default_rng(7)
    x, y = rng.uniform(-1.0, 1.0, (2, 700)) * HALF_WORLD_M * 0.9
    expected = np.zeros(len(x), int)
    for west, south, east, north in turned(boxes):
        inside = (west[:, None] <= x) & (x < east[:, None]) & (south[:, None] <= y) & (y < north[:, None])
        expected += inside.sum(axis=0)
    assert count_shown(boxes, x, y).tolist() == expected.tolist()
