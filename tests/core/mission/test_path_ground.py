"""Highest and lowest ground around positions: of few and of many, against the pixels themselves."""

from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.raytracing.surface import Surface
from terrainav.core.mission.relief.path_ground import cell_size_m, highest_around, lowest_around

ROWS, COLUMNS = 40, 60


@pytest.fixture(scope="module")
def surface():
    """Surface with rough heights, holes, and a corner without heights."""
    rng = np.random.default_rng(5)
    heights = rng.uniform(0.0, 500.0, (ROWS, COLUMNS)).astype(np.float32)
    heights[rng.random((ROWS, COLUMNS)) < 0.1] = np.nan
    heights[:12, :12] = np.nan
    return Surface(PixelGrid(), 15, 17000, 9000, heights)


@pytest.mark.parametrize("reach", [1, 3, 25, 200])
@pytest.mark.parametrize("count", [1, 3, ROWS * COLUMNS])
def test_extremes_are_those_of_the_pixels_around_each_position(surface, reach, count):
    row, column = (at.ravel() for at in np.mgrid[:ROWS, :COLUMNS])
    # Also the pixels of the empty corner.
    which = np.linspace(0, ROWS * COLUMNS - 1, count).astype(int)
    row, column = row[which], column[which]
    lat, lon = surface.places(column.astype(float), row.astype(float))
    # `highest_around` reaches a cell farther than asked.
    radius_m = (reach - 1.5) * cell_size_m(surface)
    heights = surface.heights_m
    around = [
        heights[max(i - reach, 0) : i + reach + 1, max(j - reach, 0) : j + reach + 1] for i, j in zip(row, column)
    ]
    most, least = ([np.nan if np.isnan(one).all() else find(one) for one in around] for find in (np.nanmax, np.nanmin))
    np.testing.assert_array_equal(highest_around(surface, radius_m)(lat, lon), most)
    np.testing.assert_array_equal(lowest_around(surface, radius_m)(lat, lon), least)
