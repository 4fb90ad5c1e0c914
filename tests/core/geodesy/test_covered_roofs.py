"""Roofs beneath others: beside shapely, and across models."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from terrainav.core.geodesy.covered_roofs import with_covered
from terrainav.core.geodesy.joined_faces import joined_faces
from terrainav.core.geodesy.local import LocalFrame, geocentric
from terrainav.core.geodesy.triangles import FLOOR, ROOF, WALL, Triangles

from tests.core.geodesy.boxes import LAT, LON, Boxes

shapely = pytest.importorskip("shapely", reason="the oracle of overlaps")

FRAME = LocalFrame(LAT, LON, 0.0)


def roofs(corners_enu, kind=ROOF):
    """Triangles of corners (n, 3, 3), east, north and up of a place."""
    count = len(corners_enu)
    kinds = np.broadcast_to(kind, count).astype(np.uint8)
    return Triangles(
        geocentric(*FRAME.geodetic(np.asarray(corners_enu, float))),
        kinds,
        np.ones(count, np.int64),
        np.zeros((count, 3), np.uint8),
        kinds == ROOF,
    )


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_level_roofs_are_covered_where_higher_ones_overlap_them(seed):
    rng = np.random.default_rng(seed)
    centres = rng.uniform(-60.0, 60.0, (60, 1, 2))
    flat = centres + rng.uniform(-14.0, 14.0, (60, 3, 2))
    up = np.round(rng.uniform(0.0, 5.0, 60), 1)
    corners = np.concatenate([flat, np.broadcast_to(up[:, None, None], (60, 3, 1))], axis=2)
    found = with_covered(roofs(corners), np.arange(60)).shows_imagery
    shapes = [shapely.Polygon(one) for one in flat]
    for one, shape in enumerate(shapes):
        higher = [other for k, other in enumerate(shapes) if up[k] > up[one] + 0.05]
        # Overlaps as thin as the tolerance may count or not.
        surely = any(shape.buffer(-0.05).intersection(other.buffer(-0.05)).area > 0.02 for other in higher)
        maybe = any(shape.intersection(other).area > 0.0 for other in higher)
        assert found[one] if not maybe else True
        assert not found[one] if surely else True


def test_neighbours_that_share_an_edge_and_what_lies_beneath_do_not_cover():
    here = [[0, 0, 5], [10, 0, 5], [0, 10, 5]]
    beside = [[10, 0, 9], [10, 10, 9], [0, 10, 9]]
    beneath = [[0, 0, 2], [10, 0, 2], [0, 10, 2]]
    found = with_covered(roofs([here, beside, beneath]), np.arange(3))
    assert found.shows_imagery.tolist() == [True, True, False]


def test_undersides_cover_and_walls_and_the_same_group_do_not():
    low, high = [[0, 0, 5], [10, 0, 5], [0, 10, 5]], [[1, 1, 9], [4, 1, 9], [1, 4, 9]]
    for kind, group, shown in (
        (FLOOR, (0, 1), False),
        (WALL, (0, 1), True),
        (ROOF, (7, 7), True),
        (ROOF, (7, 8), False),
    ):
        assert with_covered(roofs([low, high], [ROOF, kind]), np.array(group)).shows_imagery[0] == shown


def test_slopes_count_where_they_overlap():
    slope = [[0, 0, 0], [20, 0, 20], [0, 20, 0]]
    for east, shown in ((1.0, False), (15.0, True)):
        plate = [[east, 0.5, 8], [east + 2, 0.5, 8], [east, 1.5, 8]]
        assert with_covered(roofs([slope, plate]), np.arange(2)).shows_imagery[0] == shown


@pytest.mark.parametrize("reverse", [False, True])
def test_a_roof_of_one_file_is_covered_by_a_bridge_of_another(reverse):
    low, high = Boxes([(0.0, 0.0, 20.0, 20.0, 0.0, 10.0)]), Boxes([(5.0, 5.0, 4.0, 4.0, 0.0, 30.0)])
    models = [high, low] if reverse else [low, high]
    around = np.array([LAT - 0.01, LAT + 0.01]), np.array([LON - 0.01, LON + 0.01])
    found = joined_faces(models).triangles(*around)
    highest = np.linalg.norm(found.corners_m, axis=2).mean(axis=1)
    tops = found.kind == ROOF
    upper = tops & (highest > highest[tops].mean())
    assert found.shows_imagery[upper].all()
    assert not found.shows_imagery[tops & ~upper].any()
    apart = joined_faces([low, Boxes([(50.0, 5.0, 4.0, 4.0, 0.0, 30.0)])]).triangles(*around)
    assert np.array_equal(apart.shows_imagery, apart.kind == ROOF)


def test_heaps_of_roofs_count_as_covered_without_comparing_each_with_each():
    rng = np.random.default_rng(1)
    heap = rng.uniform(0.0, 4.0, (50_000, 3, 3))
    apart = [[[100, 0, 5], [110, 0, 5], [100, 10, 5]]]
    found = with_covered(roofs(np.concatenate([heap, apart])), np.arange(50_001)).shows_imagery
    assert found[-1]
    assert not found[:-1].any()
