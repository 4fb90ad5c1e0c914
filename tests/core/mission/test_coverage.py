"""Gaps between rectangles: against painting them on the grid of all their edges, and how the work grows."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission import coverage
from terrainav.core.mission.area import Box
from terrainav.core.mission.coverage import Rectangles, gaps
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.wind import Wind

AGRICENTER = Box(35.16, -89.90, 35.115, -89.823)


def painted(rectangles, within):
    """Lines of the grid of all edges, and which of its cells inside the bounds no rectangle shows."""
    west, north, east, south = within
    x = np.unique(np.clip(np.concatenate([rectangles.x0, rectangles.x1, [west, east]]), west, east))
    y = np.unique(np.clip(np.concatenate([rectangles.y0, rectangles.y1, [north, south]]), north, south))
    bare = np.ones((len(y) - 1, len(x) - 1), bool)
    for x0, y0, x1, y1 in zip(*rectangles):
        shown = (x[:-1] >= x0) & (x[1:] <= x1)
        bare[np.ix_((y[:-1] >= y0) & (y[1:] <= y1), shown)] = False
    return x, y, bare


def check(rectangles, within):
    """Each place that nobody shows is in one gap, and no other is in any."""
    found = gaps(rectangles, within)
    # On the grid of the gaps' edges, too, which cut what is bare where the search has its lines.
    both = Rectangles(*(np.concatenate(sides) for sides in zip(rectangles, found)))
    x, y, _ = painted(both, within)
    x_mid, y_mid = (x[1:] + x[:-1]) / 2.0, (y[1:] + y[:-1]) / 2.0
    shown, in_gaps = (
        sum(
            (
                ((y_mid > y0) & (y_mid < y1))[:, np.newaxis] & ((x_mid > x0) & (x_mid < x1))
                for x0, y0, x1, y1 in zip(*some)
            ),
            np.zeros((len(y_mid), len(x_mid)), np.int64),
        )
        for some in (rectangles, found)
    )
    np.testing.assert_array_equal(in_gaps, np.where(shown > 0, 0, 1))
    assert (found.x1 > found.x0).all()
    assert (found.y1 > found.y0).all()
    return found


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 40), st.integers(1, 40), st.booleans(), st.booleans())
def test_gaps_are_what_painting_leaves(seed, count, largest, whole, in_rows):
    random = np.random.default_rng(seed)
    x0, y0 = random.uniform(-10.0, 50.0, (2, count))
    if in_rows:
        y0 = np.round(y0 / largest) * largest
    width, height = random.uniform(-1.0, largest, (2, count))
    rectangles = Rectangles(x0, y0, x0 + np.maximum(width, 0.0), y0 + np.maximum(height, 0.0))
    if whole:
        rectangles = Rectangles(*(np.round(side) for side in rectangles))
    west, north = random.uniform(-5.0, 5.0, 2)
    within = (west, north, west + random.uniform(1.0, 60.0), north + random.uniform(1.0, 60.0))
    check(rectangles, tuple(round(edge) for edge in within) if whole else within)


def test_few_rectangles_in_a_wide_field_leave_few_gaps():
    """As along a corridor, whose box is mostly empty."""
    at = np.arange(60.0) * 1000.0
    found = check(Rectangles(at, at, at + 1.0, at + 1.0), (-5.0, -5.0, 1e5, 1e5))
    assert len(found.x0) < 60 * 10
    (nothing,) = zip(*gaps(Rectangles(*np.empty((4, 0))), (0.0, 1.0, 2.0, 3.0)))
    assert nothing == (0.0, 1.0, 2.0, 3.0)
    assert not len(gaps(Rectangles(*np.empty((4, 0))), (0.0, 1.0, 0.0, 3.0)).x0)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"layout": "paper"},
        {"wind": Wind(8.0, 250.0, 0.2)},
        {"wind": Wind(8.0, 250.0, 0.2), "overlap_along": 0.6, "overlap_across": 0.3},
        {"tilt_deg": 40.0, "yaw_deg": 30.0, "layout": "paper"},
    ],
)
def test_coverage_is_that_of_the_painted_windows(changes):
    area = Box(35.16, -89.90, 35.145, -89.88)
    worked_out = plan(Mission(area, 120.0, **changes), PixelGrid())
    world = worked_out.grid.world_px(worked_out.zoom)
    lat = np.radians([35.16, 35.145])
    west, east = (-89.90 / 360.0 + 0.5) * world, (-89.88 / 360.0 + 0.5) * world
    north, south = ((0.5 - np.arcsinh(np.tan(lat)) / (2.0 * np.pi)) * world).tolist()
    x, y, bare = painted(Rectangles(*worked_out.windows.bounds_px), (west, north, east, south))
    # Ground of a pixel, from the ellipsoid's radii at the middle: 1e-4 of it over so small an area.
    share = float((bare * np.outer(np.diff(y), np.diff(x))).sum()) / ((east - west) * (south - north))
    found = worked_out.coverage
    assert found.uncovered_m2 / found.area_m2 == pytest.approx(share, rel=2e-3, abs=1e-9)
    assert found.complete == (not bare.any())


def test_work_grows_with_the_number_of_images_in_wind(monkeypatch):
    """Of strips across the whole area 16 times the images had 64 times the pieces."""
    counted = []
    pieces = coverage._pieces

    def noted(*arguments):
        found = pieces(*arguments)
        counted.append(len(found[0]))
        return found

    monkeypatch.setattr(coverage, "_pieces", noted)
    made = []
    for times in (1, 4):
        random = np.random.default_rng(7)
        row, column = (index.ravel() for index in np.indices((40 * times, 40 * times)))
        x0, y0 = (100.0 * index + random.uniform(-9.0, 9.0, index.size) for index in (column, row))
        counted.clear()
        gaps(Rectangles(x0, y0, x0 + 104.0, y0 + 104.0), (0.0, 0.0, 4000.0 * times, 4000.0 * times))
        made.append(sum(counted) / x0.size)
    assert made[0] > 1.0
    assert made[1] < 1.2 * made[0]
