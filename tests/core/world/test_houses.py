"""Houses as faces: where the painter draws them, as high as their shadows say."""

from __future__ import annotations

import numpy as np
import pyproj
import pytest
from terrainav.core.geodesy.mercator import MERCATOR
from terrainav.core.geodesy.triangles import NO_FACES, ROOF, WALL
from terrainav.core.world.houses import WorldHouses, _houses
from terrainav.core.world.lattice import chart_seed
from terrainav.core.world.objects import EAVES_M, GABLE_RISE, footprints
from terrainav.core.world.samples import Grid
from terrainav.core.world.scene import Scene
from terrainav.core.world.source import World, WorldHeights

SEED, ZOOM = 2024, 19
#: A tile in a town, and the box of its positions.
COLUMN, ROW = 131253, 207446


@pytest.fixture(scope="module")
def box():
    u, v = np.array([COLUMN, COLUMN + 1]) / 2.0**ZOOM, np.array([ROW, ROW + 1]) / 2.0**ZOOM
    return MERCATOR.inverse(u, v)


@pytest.fixture(scope="module")
def houses(box):
    return WorldHouses(chart_seed(SEED, 0)).triangles(*box)


@pytest.fixture(scope="module")
def corners(houses):
    """Pixels of the tile, and heights, of the corners of faces (n, 3)."""
    to_degrees = pyproj.Transformer.from_crs(4978, 4979, always_xy=True)
    lon, lat, height = to_degrees.transform(*np.moveaxis(houses.corners_m, -1, 0))
    u, v = MERCATOR.forward(lat, lon)
    return (u * 2.0**ZOOM - COLUMN) * 256.0, (v * 2.0**ZOOM - ROW) * 256.0, height


def roofs_from_above(houses, corners):
    """Whether pixels of the tile see a roof from above, and its height."""
    x, y = np.meshgrid(np.arange(256) + 0.5, np.arange(256) + 0.5)
    inside, top = np.zeros(x.shape, bool), np.full(x.shape, np.nan)
    for at_x, at_y, height in zip(*(values[houses.kind == ROOF] for values in corners)):
        sides = (
            np.array([np.diff(at_x[[0, 1]])[0], np.diff(at_x[[0, 2]])[0]]),
            np.array([np.diff(at_y[[0, 1]])[0], np.diff(at_y[[0, 2]])[0]]),
        )
        shares = np.linalg.solve(np.array(sides), np.stack([(x - at_x[0]).ravel(), (y - at_y[0]).ravel()]))
        within = ((shares >= 0.0).all(axis=0) & (shares.sum(axis=0) <= 1.0)).reshape(x.shape)
        inside |= within
        values = height[0] + shares[0] * (height[1] - height[0]) + shares[1] * (height[2] - height[0])
        top[within] = values.reshape(x.shape)[within]
    return inside, top


def test_roofs_lie_where_the_painter_draws_houses_and_as_high_as_their_shadows_say(box, houses, corners):
    parcels = Scene(SEED, Grid(ZOOM, COLUMN, ROW)).parcels
    prints = footprints(parcels)
    drawn = np.minimum(np.minimum(prints.west, prints.east), np.minimum(prints.north, prints.south)) > 0.0
    inside, top = roofs_from_above(houses, corners)
    assert drawn.sum() > 10_000
    # Sides of houses are straight here, and as bent as the plane there.
    assert (inside != drawn).sum() < 20
    # Walls as high as their shadows are long, and gables over the longer sides, in metres of the map.
    buildings = parcels.division.looks.buildings
    ridge_x, pitch = (parcels.leaf(table).take(prints.index) for table in (buildings.ridge_x, buildings.pitch))
    across = np.where(ridge_x, np.minimum(prints.north, prints.south), np.minimum(prints.west, prints.east))
    above = EAVES_M + GABLE_RISE * across * (pitch > 0.0)
    lat = box[0].mean()
    wanted = World(SEED).heights(ZOOM, COLUMN, ROW, bare=True) + above.reshape(256, 256) * np.cos(np.radians(lat))
    off = (wanted - top)[inside & drawn]
    # Eaves are level, and the ground below is not.
    assert np.abs(np.median(off)) < 0.1
    assert np.percentile(np.abs(off), 90) < 0.4


def test_houses_are_closed_but_for_their_floor(houses, corners):
    rounded = np.round(np.stack(corners, axis=-1), 4)
    edges = {}
    for triangle in rounded:
        for start, end in zip(triangle, np.roll(triangle, -1, axis=0)):
            edges[tuple(start), tuple(end)] = edges.get((tuple(start), tuple(end)), 0) + 1
    assert set(edges.values()) == {1}
    open_ends = [edge for edge in edges if edge[::-1] not in edges]
    # Four sides of the open floor of each.
    assert len(open_ends) == 4 * len(np.unique(houses.instance))
    lowest = {}
    for number, height in zip(houses.instance, corners[2]):
        lowest[number] = min(lowest.get(number, np.inf), height.min())
    assert all(min(edge[0][2], edge[1][2]) in {round(low, 4) for low in lowest.values()} for edge in open_ends)


def test_faces_are_seen_counter_clockwise_from_outside(houses):
    middle = {number: houses.corners_m[houses.instance == number].mean(axis=(0, 1)) for number in houses.instance}
    for corner, number in zip(houses.corners_m, houses.instance):
        normal = np.cross(corner[1] - corner[0], corner[2] - corner[0])
        assert normal @ (corner.mean(axis=0) - middle[number]) > 0.0


def test_walls_reach_below_the_ground(houses, corners):
    world = World(SEED)
    ground = world.heights(ZOOM, COLUMN, ROW, bare=True)
    walls = houses.kind == WALL
    inside = walls & ((corners[0] > 0) & (corners[0] < 256) & (corners[1] > 0) & (corners[1] < 256)).all(axis=1)
    assert inside.sum() > 50
    for number in np.unique(houses.instance[inside]):
        x, y, height = (values[inside & (houses.instance == number)] for values in corners)
        assert height.min() < ground[y.astype(int), x.astype(int)].min() - 1.5


def test_a_house_has_one_number_wherever_it_is_asked_for(box, houses):
    lat, lon = box
    wide = WorldHouses(chart_seed(SEED, 0)).triangles(lat + np.array([0.005, -0.005]), lon + np.array([-0.005, 0.005]))
    for number in np.unique(houses.instance):
        again = wide.take(wide.instance == number)
        assert (again.corners_m == houses.take(houses.instance == number).corners_m).all()
    turned = WorldHouses(chart_seed(SEED, 0)).triangles(lat, lon + 360.0)
    assert (turned.corners_m == houses.corners_m).all()


def test_where_houses_stand_does_not_depend_on_what_was_asked_for_before(box, houses):
    lat, lon = box
    _houses.cache_clear()
    middle = WorldHouses(chart_seed(SEED, 0)).triangles(*(at.mean() + np.array([-1e-4, 1e-4]) for at in box))
    assert 0 < len(middle) < len(houses)
    again = WorldHouses(chart_seed(SEED, 0)).triangles(lat, lon)
    assert (again.corners_m == houses.corners_m).all()
    assert (again.instance == houses.instance).all()


def test_walls_have_a_colour_of_their_house_that_matches_its_roof(box):
    lat, lon = box
    houses = WorldHouses(chart_seed(SEED, 0)).triangles(
        lat + np.array([0.002, -0.002]), lon + np.array([-0.002, 0.002])
    )
    walls, roofs = (
        {number: houses.colour[(houses.instance == number) & (houses.kind == kind)] for number in houses.instance}
        for kind in (WALL, ROOF)
    )
    assert all(len(np.unique(colours, axis=0)) == 1 for colours in (*walls.values(), *roofs.values()))
    assert len({tuple(colours[0]) for colours in walls.values()}) > 50
    # Red roofs have redder walls than grey ones, in the mean.
    warm = np.array([[colours[0][0] - float(colours[0][2]) for colours in (walls[n], roofs[n])] for n in walls]).T
    red = warm[1] > np.median(warm[1])
    assert warm[0][red].mean() > warm[0][~red].mean()


def test_houses_less_high_than_a_pixel_are_left_out(box, houses, corners):
    high = {n: np.ptp(corners[2][(houses.instance == n) & (houses.kind == ROOF)]) for n in houses.instance}
    kept = WorldHouses(chart_seed(SEED, 0)).triangles(*box, least_m=3.0)
    assert 0 < len(kept) < len(houses)
    scale = np.cos(np.radians(box[0].mean()))
    for number, rise_m in high.items():
        assert (number in kept.instance) == (EAVES_M * scale + rise_m >= 6.0)
    assert len(WorldHouses(chart_seed(SEED, 0)).triangles(*box, least_m=5.1)) == 0


def test_the_map_ends_before_the_pole():
    faces = WorldHouses(chart_seed(SEED, 0))
    assert len(faces.triangles(np.array([85.04, 90.0]), np.array([0.0, 0.001]))) == 0
    # The height of houses at 60 degrees is half of that at the equator.
    assert len(faces.triangles(np.array([0.0, 60.0]), np.array([0.0, 90.0]), least_m=5.0)) == 0
    assert len(faces.triangles(np.array([60.0, 75.0]), np.array([0.0, 90.0]), least_m=2.6)) == 0


def test_charts_about_the_poles_have_no_houses():
    assert WorldHeights(SEED).faces == WorldHouses(chart_seed(SEED, 0))
    assert WorldHeights(SEED, "EPSG:3413").faces is NO_FACES
