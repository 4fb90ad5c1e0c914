"""Gaps between rectangles and their ground: against painting, against one by one, and how the work grows."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy import accuracy, footprint, rectangles
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.ellipsoid import WGS84
from terrainav.core.geodesy.frames import map_frame_edges
from terrainav.core.geodesy.mercator import PixelGrid, lat_to_v
from terrainav.core.geodesy.projections import LocalPlane
from terrainav.core.mission.areas.area import (
    Box,
    Polygon,
    area_within_m2,
    crossed_and_held,
    ground_m2,
    touching,
)
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.layout import coverage
from terrainav.core.mission.layout import parallels as layout
from terrainav.core.mission.layout.coverage import Rectangles, gaps, shares
from terrainav.core.mission.layout.rotated import PlaneArea
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.relief.ground import level_ground

from tests.support.thinning import examples

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


@settings(max_examples=examples(150), deadline=None)
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


@pytest.mark.parametrize("changes", [{}, {"row_azimuth_deg": 30.0}])
def test_plans_do_not_depend_on_the_size_of_their_batches(changes, monkeypatch):
    """Only sums of areas differ, by their rounding."""
    mission = Mission(Box(35.16, -89.90, 35.145, -89.88), 120.0, wind=Wind(8.0, 250.0, 0.2), **changes)
    whole = plan(mission, PixelGrid())
    for room, name, size in (
        (coverage, "_BAND", 7),
        (footprint, "_BATCH", 10),
        (accuracy, "_BATCH", 9),
        (rectangles, "_BATCH", 11),
    ):
        monkeypatch.setattr(room, name, size)
    parts = plan(mission, PixelGrid())
    assert parts.coverage.complete == whole.coverage.complete
    assert parts.coverage.uncovered_m2 == pytest.approx(whole.coverage.uncovered_m2, rel=1e-12)
    assert parts.accuracy == whole.accuracy
    for one, other in zip((*parts.corners, *parts.windows), (*whole.corners, *whole.windows)):
        np.testing.assert_array_equal(one, other)


def cut_ring(ring, rectangle):
    """Corners of a ring inside a rectangle, by Sutherland and Hodgman, a corner at a time."""
    west, south, east, north = rectangle
    for axis, limit, sense in ((0, west, 1.0), (0, east, -1.0), (1, south, 1.0), (1, north, -1.0)):
        kept = []
        for here, there in zip(ring, ring[1:] + ring[:1]):
            before, after = sense * (here[axis] - limit), sense * (there[axis] - limit)
            if before >= 0.0:
                kept.append(here)
            if (before >= 0.0) != (after >= 0.0):
                cut = [one + before / (before - after) * (other - one) for one, other in zip(here, there)]
                cut[axis] = limit
                kept.append(tuple(cut))
        ring = kept
    return ring if len(ring) > 2 else []


def green_m2(lon, lat):
    """Ground inside a ring: the integral of longitude, counted from the first corner, along its sides."""
    nodes, weights = np.polynomial.legendre.leggauss(20)
    share, lon, total = (1.0 + nodes) / 2.0, lon - lon[0], 0.0
    for lon0, lat0, lon1, lat1 in zip(lon, lat, np.roll(lon, -1), np.roll(lat, -1)):
        density = WGS84.area_density_m2(lat0 + share * (lat1 - lat0))
        total += float(np.sum((lon0 + share * (lon1 - lon0)) * density * weights)) * (lat1 - lat0) / 2.0
    return abs(total)


def ground_one_by_one_m2(rings, rectangles, geodetic):
    """Square metres of rings, the first less the others, inside each rectangle."""
    found = []
    for rectangle in zip(*(side.tolist() for side in rectangles)):
        ground = 0.0
        for sign, (x, y) in zip((1.0, *(-1.0 for _ in rings[1:])), rings):
            inside = cut_ring(list(zip(x.tolist(), y.tolist())), rectangle)
            if inside:
                lat, lon = geodetic(*np.array(inside).T)
                ground += sign * green_m2(lon, lat)
        found.append(ground)
    return np.array(found)


def star(random, corners, middle, size):
    """A ring about a place, its corners near and far by turns."""
    angle = np.sort(random.uniform(0.0, 2.0 * np.pi, corners))
    radius = size * random.uniform(0.3, 1.0, corners)
    return middle[0] + radius * np.cos(angle), middle[1] + radius * np.sin(angle)


def scattered(random, count, middle, size, whole):
    """Rectangles about a place, of all sizes, in no rows."""
    x0, y0 = (at + size * random.uniform(-1.2, 1.2, count) for at in middle)
    width, height = size * 10.0 ** random.uniform(-3.0, 0.3, (2, count))
    sides = Rectangles(x0, y0, x0 + width, y0 + height)
    if not whole:
        return sides
    x0, y0, x1, y1 = (np.round(side) for side in sides)
    return Rectangles(x0, y0, np.maximum(x1, x0 + 1.0), np.maximum(y1, y0 + 1.0))


@settings(max_examples=examples(25), deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(3, 30), st.integers(0, 2), st.booleans())
def test_ground_of_gaps_is_that_of_each_by_itself(seed, corners, holes, whole):
    random = np.random.default_rng(seed)
    plane = LocalPlane(random.uniform(-70.0, 70.0), random.uniform(-180.0, 180.0), random.uniform(-180.0, 180.0))
    rings = [star(random, corners, (0.0, 0.0), 5000.0)]
    rings += [star(random, 5, random.uniform(-600.0, 600.0, 2), 400.0) for _ in range(holes)]
    if whole:  # corners lie on lines of the rectangles, too
        rings = [(np.round(x / 500.0) * 500.0, np.round(y / 500.0) * 500.0) for x, y in rings]
    shape = PlaneArea(tuple(rings), 0.0)
    rectangles = scattered(random, 60, (0.0, 0.0), 5000.0, whole)
    crossed, held = crossed_and_held(shape, *rectangles)
    alone = [touching(shape, *(np.array([side]) for side in one))[0] for one in zip(*rectangles)]
    np.testing.assert_array_equal(crossed | held, alone)
    expected = ground_one_by_one_m2(rings, rectangles, plane.inverse)
    found = ground_m2(shape, *rectangles, plane.inverse)
    largest = np.max((rectangles.x1 - rectangles.x0) * (rectangles.y1 - rectangles.y0))
    # A nanometre along kilometres of side is what positions in degrees are good to.
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * largest)


def test_ground_of_a_polygon_in_gaps_of_degrees_is_that_of_each_by_itself():
    random = np.random.default_rng(11)
    lon, lat = star(random, 40, (10.0, 50.0), 0.2)
    hole = star(random, 4, (10.0, 50.0), 0.03)
    area = Polygon(tuple(tuple(zip(*(part.tolist() for part in ring))) for ring in ((lon, lat), hole)))
    rectangles = scattered(random, 500, (10.0, 50.0), 0.2, whole=False)
    expected = ground_one_by_one_m2(area.arrays(), rectangles, lambda lon, lat: (lat, lon))
    found = area_within_m2(area, *rectangles)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-3)
    assert (expected > 0.0).sum() > 100


def test_gaps_are_worked_out_together():
    random = np.random.default_rng(5)
    shape = PlaneArea((star(random, 30, (0.0, 0.0), 5000.0),), 0.0)
    plane, calls = LocalPlane(40.0, 10.0, 30.0), []

    def geodetic(x, y):
        calls.append(len(x))
        return plane.inverse(x, y)

    ground_m2(shape, *scattered(random, 2000, (0.0, 0.0), 5000.0, whole=False), geodetic)
    assert len(calls) < 10


def test_rows_of_very_different_heights_are_all_placed():
    """Towards the poles frames are higher and higher on the map, and neighbours share a part of the higher one."""

    def frames(lat_deg, agl_m):
        return map_frame_edges(Camera(), Poses.level(lat_deg, np.zeros_like(lat_deg), agl_m))

    mission = Mission(Box(80, 0, -80, 0.01), 1e5, overlap_across=0.9)
    placed = layout.lay_out(mission, frames, 0.0, level_ground(mission))
    _, _, top, bottom = frames(placed.lat_deg, placed.agl_m)
    assert (np.diff(placed.row) == 1).all()
    assert top[0] <= lat_to_v(np.array(80.0))
    assert bottom[-1] >= lat_to_v(np.array(-80.0))
    higher = np.maximum((bottom - top)[:-1], (bottom - top)[1:])
    np.testing.assert_allclose((bottom[:-1] - top[1:]) / higher, 0.9, rtol=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_rows_over_terraces_overlap_as_asked_where_no_position_is_right(seed):
    """Frames are higher and farther ahead over lower ground, and jump where their row moves by little."""
    terraces = np.random.default_rng(seed).uniform(0.8, 1.2, 64)

    def frames(lat_deg):
        level = map_frame_edges(Camera(), Poses.level(lat_deg, np.zeros_like(lat_deg), np.full(len(lat_deg), 300.0)))
        v = lat_to_v(lat_deg)
        high = 0.5 * (level.bottom_v - level.top_v) * terraces[(v * 2e5).astype(int) % len(terraces)]
        return level._replace(top_v=v - 3.0 * high, bottom_v=v - high)

    mission = Mission(Box(35.15, -89.90, 35.05, -89.899), 300.0, overlap_across=0.3)
    rows = layout._ParallelRows(mission, mission.area, frames, 1e-9, refuse_early=False)
    _, edges = rows.settle(rows.first_top, 20)
    top, bottom = edges.top_v, edges.bottom_v
    assert top[0] <= rows.first_top + 1e-14
    higher = np.maximum((bottom - top)[:-1], (bottom - top)[1:])
    assert ((bottom[:-1] - top[1:]) / higher).min() > 0.3 - 1e-9


def test_a_mission_of_far_too_many_images_is_refused_before_its_rows_are_placed(monkeypatch):
    mission = Mission(Box(80, -180, -80, 180), 8e5, overlap_along=0.999, overlap_across=0.999)
    monkeypatch.setattr(layout._ParallelRows, "settle", None)
    with pytest.raises(InvalidInput, match="images: the limit is") as refused:
        plan(mission, PixelGrid())
    named = float(re.search(r"of ([\d,]+) images", str(refused.value))[1].replace(",", ""))
    # The zone of a sphere, by what an image shows on level ground, a thousand times along and a thousand times across.
    width, height = mission.camera.ground_size_m(mission.flight.agl_m)
    zone_m2 = 4.0 * math.pi * 6_371_007.0**2 * math.sin(math.radians(80.0))
    assert named == pytest.approx(1e6 * zone_m2 / (width * height), rel=0.1)


@pytest.mark.parametrize("seed", range(3))
def test_overlap_is_a_number_where_gusts_leave_images_no_rectangle(seed):
    box = Box(35.16, -89.90, 35.1565, -89.894)
    blown = Wind(14.0, 250.0, 1.0, seed=seed)
    made = plan(Mission(box, 120.0, wind=blown, row_azimuth_deg=30.0), PixelGrid())
    assert np.isfinite([*vars(made.overlap).values()]).all()
    assert made.overlap.least_along < made.overlap.median_along < 1.0


def test_what_an_image_without_extent_shares_is_a_gap_of_its_neighbour():
    column, row = np.array([0, 1, 2, 0, 1]), np.array([0, 0, 0, 1, 1])
    x0, x1 = np.array([0.0, 15.0, 20.0, 3.0, 3.0]), np.array([10.0, 15.0, 30.0, 3.0, 3.0])
    y0, y1 = np.array([0.0, 0.0, 0.0, 12.0, 12.0]), np.array([10.0, 10.0, 10.0, 12.0, 12.0])
    along, across = shares(column, row, Rectangles(x0, y0, x1, y1), rows_are_level=False)
    assert along.tolist() == [-0.5, -0.5, -1.0]
    assert across.tolist() == pytest.approx([-0.2, -0.2])
