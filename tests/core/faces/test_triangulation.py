"""Triangles of polygons: they cover the polygon exactly once."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.faces.triangulation import open_ring, signed_area, triangulate

SQUARE = np.array([[0, 0], [10, 0], [10, 10], [0, 10]], float)


def hole(x, y, side=2.0):
    return np.array([[x, y], [x, y + side], [x + side, y + side], [x + side, y]], float)


def star(radii):
    angle = np.arange(len(radii)) * 2 * np.pi / len(radii)
    return np.stack([radii * np.cos(angle), radii * np.sin(angle)], axis=-1)


def check(rings):
    """All triangles turn left, their areas add up, and their outline is the rings': so none lies outside."""
    triangles = triangulate(rings)
    points = np.concatenate(rings)
    first_at = {}
    same = [first_at.setdefault(tuple(point), i) for i, point in enumerate(points.tolist())]
    areas = [signed_area(points[one]) for one in triangles]
    total = sum(signed_area(ring) for ring in rings)
    assert min(areas) > 0
    assert sum(areas) == pytest.approx(total, rel=1e-9)
    edges = Counter((int(t[k]), int(t[(k + 1) % 3])) for t in triangles for k in range(3))
    outline, first = set(), 0
    for ring in rings:
        outline |= {(same[first + k], same[first + (k + 1) % len(ring)]) for k in range(len(ring))}
        first += len(ring)
    bare = {edge for edge in edges if edge[::-1] not in edges}
    # Where a ring touches another's edge, the edge has that vertex, too.
    assert bare == outline or len(bare) == len(outline) + 1
    assert max(edges.values()) == 1


@pytest.mark.parametrize(
    "rings",
    [
        [SQUARE],
        [np.array([[0, 0], [5, 0], [10, 0], [10, 5], [10, 10], [3, 10], [0, 10]], float)],
        [SQUARE, hole(4, 4)],
        [SQUARE, hole(1, 1), hole(4, 1), hole(7, 1), hole(1, 7), hole(4, 4), hole(7, 7)],
        [SQUARE, hole(1, 1), hole(3, 3)],
        [SQUARE, np.array([[0, 0], [2, 5], [5, 2]], float)],
        [SQUARE, np.array([[0, 5], [4, 6], [4, 4]], float)],
    ],
    ids=["square", "collinear", "hole", "holes", "touching holes", "hole at a corner", "hole at an edge"],
)
def test_covers_the_polygon_once(rings):
    check(rings)


@given(st.lists(st.floats(1.0, 10.0), min_size=3, max_size=90))
def test_covers_stars(radii):
    check([star(np.array(radii))])


@given(st.lists(st.floats(5.0, 10.0), min_size=8, max_size=60), st.lists(st.floats(0.5, 3.0), min_size=3, max_size=60))
def test_covers_stars_with_holes(radii, inner):
    check([star(np.array(radii)), star(np.array(inner))[::-1]])


def test_large_polygons():
    check([star(np.random.default_rng(1).uniform(5, 10, 3000))])


def test_rings_that_cross_or_have_no_area_have_no_triangles():
    assert len(triangulate([np.array([[0, 0], [1, 0], [2, 0]], float)])) == 0
    assert len(triangulate([np.array([[0, 0], [1, 1], [1, 0], [0, 1]], float)])) == 0


def test_open_ring_drops_repeated_vertices():
    closed = np.array([[0, 0], [1, 0], [1, 0], [1, 1], [0, 0]], float)
    assert open_ring(closed).tolist() == [[1, 0], [1, 1], [0, 0]] or len(open_ring(closed)) == 3
