"""Shortest ways around polygons."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.ways import way_around

from tests.support.thinning import examples

SQUARE = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]])


def length_of(way):
    return float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum())


def sampled(way, count=200):
    """Places all along a way."""
    share = np.linspace(0.0, 1.0, count)[:, np.newaxis]
    return np.concatenate([a + share * (b - a) for a, b in zip(way, way[1:])])


def distances_from_box(places, box):
    """Distances of places from a box (west, south, east, north), negative inside."""
    west, south, east, north = box
    dx = np.maximum(west - places[:, 0], places[:, 0] - east)
    dy = np.maximum(south - places[:, 1], places[:, 1] - north)
    return np.where((dx > 0) & (dy > 0), np.hypot(dx, dy), np.maximum(dx, dy))


def test_a_free_way_is_straight():
    way = way_around(np.array([-10.0, -50.0]), np.array([200.0, -50.0]), [[SQUARE]], 20.0)
    np.testing.assert_array_equal(way, [[-10.0, -50.0], [200.0, -50.0]])
    assert len(way_around(np.zeros(2), np.ones(2), [], 20.0)) == 2


@pytest.mark.parametrize("ring", [SQUARE, SQUARE[::-1], np.roll(SQUARE, 2, axis=0)])
def test_a_way_goes_by_the_nearer_corners(ring):
    way = way_around(np.array([-50.0, 30.0]), np.array([150.0, 30.0]), [[ring]])
    assert length_of(way) == pytest.approx(100.0 + 2.0 * math.hypot(50.0, 30.0), abs=0.01)
    assert way[1:-1, 1].max() <= 0.0


def test_a_distance_costs_what_tangents_and_arcs_do():
    distance, (x, y) = 20.0, (50.0, 30.0)
    way = way_around(np.array([-x, y]), np.array([100.0 + x, y]), [[SQUARE]], distance)
    # From either end to the circle about the corner, around it to the line below the square, and along that.
    far = math.hypot(x, y)
    tangent = math.sqrt(far * far - distance * distance)
    turn = math.atan2(y, x) + math.asin(distance / far)
    least = 2.0 * (tangent + distance * turn) + 100.0
    assert least <= length_of(way) <= least + 2.0 * 0.02 * distance
    assert distances_from_box(sampled(way), (0.0, 0.0, 100.0, 100.0)).min() >= distance * (1.0 - 1e-5)


def test_a_place_nearer_than_asked_keeps_what_it_has():
    way = way_around(np.array([-5.0, 50.0]), np.array([150.0, 50.0]), [[SQUARE]], 20.0)
    off = distances_from_box(sampled(way), (0.0, 0.0, 100.0, 100.0))
    assert off.min() == pytest.approx(5.0, rel=1e-5)


def test_two_areas_too_near_to_each_other_are_gone_around_together():
    other = SQUARE + np.array([0.0, 110.0])
    start, end = np.array([-50.0, 105.0]), np.array([150.0, 105.0])
    assert length_of(way_around(start, end, [[SQUARE], [other]], 4.0)) == pytest.approx(200.0)
    around = way_around(start, end, [[SQUARE], [other]], 6.0)
    assert length_of(around) > 100.0 + 2.0 * math.hypot(50.0, 105.0)


def test_a_hook_is_left_by_its_mouth():
    hook = np.array([[0, 0], [100, 0], [100, 100], [0, 100], [0, 90], [90, 90], [90, 10], [0, 10]], np.float64)
    way = way_around(np.array([50.0, 50.0]), np.array([150.0, 50.0]), [[hook]])
    expected = math.hypot(50.0, 40.0) + 10.0 + 100.0 + math.hypot(50.0, 50.0)
    assert length_of(way) == pytest.approx(expected, abs=0.02)


def test_ends_inside_are_refused_and_those_in_a_closed_hole_have_no_way_out():
    hole = SQUARE * 0.5 + 25.0
    with pytest.raises(InvalidInput, match="start of a leg: lies inside a no-fly area"):
        way_around(np.array([10.0, 10.0]), np.array([150.0, 50.0]), [[SQUARE, hole]])
    with pytest.raises(InvalidInput, match="end of a leg: lies inside a no-fly area"):
        way_around(np.array([150.0, 50.0]), np.array([10.0, 10.0]), [[SQUARE, hole]])
    with pytest.raises(InvalidInput, match="no way leads around"):
        way_around(np.array([50.0, 50.0]), np.array([150.0, 50.0]), [[SQUARE, hole]])
    inside = way_around(np.array([30.0, 30.0]), np.array([70.0, 70.0]), [[SQUARE, hole]])
    assert len(inside) == 2


boxes = st.tuples(st.integers(0, 8), st.integers(0, 8), st.integers(1, 4), st.integers(1, 4))


@settings(max_examples=examples(40), deadline=None)
@given(st.lists(boxes, min_size=1, max_size=5), st.sampled_from([0.0, 3.0]))
def test_ways_among_boxes_keep_off_are_no_longer_than_by_the_rim_and_the_same_back(found, clearance):
    rectangles = [(10.0 * x, 10.0 * y, 10.0 * (x + w), 10.0 * (y + h)) for x, y, w, h in found]
    polygons = [[np.array([[w, s], [e, s], [e, n], [w, n]])] for w, s, e, n in rectangles]
    start, end = np.array([-20.0, 55.0]), np.array([140.0, 47.0])
    way = way_around(start, end, polygons, clearance)
    places = sampled(way)
    for box in rectangles:
        assert distances_from_box(places, box).min() >= clearance * (1.0 - 1e-5) - 1e-9
    rim = np.array([start, [-20.0, -5.0], [140.0, -5.0], end])
    assert np.linalg.norm(end - start) - 1e-9 <= length_of(way) <= length_of(rim) + 1e-9
    back = way_around(end, start, polygons, clearance)
    assert length_of(back) == pytest.approx(length_of(way), rel=1e-9)


@settings(max_examples=examples(6), deadline=None)
@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), min_size=1, max_size=12, unique=True))
def test_ways_are_no_longer_than_the_shortest_on_a_lattice(cells):
    """Dijkstra on a lattice of 5 m with all legs of a knight's reach: longer than the true way, never shorter."""
    import heapq

    polygons = [[SQUARE * 0.1 + np.array([10.0 * x, 10.0 * y])] for x, y in cells]
    start, end = (-5.0, 50.0), (105.0, 50.0)
    moves = [(x, y) for x in range(-2, 3) for y in range(-2, 3) if math.gcd(x, y) == 1]

    def open_(x, y):
        return not any(10 * cx < x < 10 * cx + 10 and 10 * cy < y < 10 * cy + 10 for cx, cy in cells)

    best, waiting = {start: 0.0}, [(0.0, start)]
    while waiting:
        far, (x, y) = heapq.heappop(waiting)
        if (x, y) == end:
            break
        if far > best[(x, y)]:
            continue
        for dx, dy in moves:
            to = (x + 5.0 * dx, y + 5.0 * dy)
            if not (-5.0 <= to[0] <= 105.0 and -5.0 <= to[1] <= 105.0):
                continue
            steps = [(x + 5.0 * dx * t / 4.0, y + 5.0 * dy * t / 4.0) for t in range(1, 5)]
            if all(open_(*step) for step in steps):
                further = far + 5.0 * math.hypot(dx, dy)
                if further < best.get(to, math.inf):
                    best[to] = further
                    heapq.heappush(waiting, (further, to))
    # The lattice's ways touch the squares, and slip between those that meet at a corner; these may not.
    if any((x + 1, y + 1) in cells or (x + 1, y - 1) in cells for x, y in cells):
        return
    assert length_of(way_around(np.array(start), np.array(end), polygons)) <= best[end] + 0.1
