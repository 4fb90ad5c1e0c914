"""The heights of the embedded world: in step with its pictures, across tiles and zooms, and the same everywhere."""

from __future__ import annotations

import math

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.mercator import HALF_WORLD_M
from terrainav.core.imagery.source import Window
from terrainav.core.world import World, WorldHeights
from terrainav.core.world.objects import EAVES_M, footprints
from terrainav.core.world.samples import Grid
from terrainav.core.world.scene import Scene

from tests.support.libraries import inexact

WORLD = World()


def tile_at(lat, lon, zoom):
    n = 1 << zoom
    v = 0.5 - math.asinh(math.tan(math.radians(lat))) / (2.0 * math.pi)
    return zoom, int((lon / 360.0 + 0.5) * n), int(v * n)


def metres_per_px(zoom, y):
    v = (y + 0.5) / (1 << zoom)
    return 2.0 * HALF_WORLD_M / (256 << zoom) / math.cosh(math.pi * (1.0 - 2.0 * v))


PLACES = [tile_at(lat, lon, 12) for lat in (-40.0, -5.0, 28.0, 51.0) for lon in (-150.0, -89.86, 10.0, 100.0)]


@pytest.mark.parametrize("place", PLACES, ids=str)
def test_ground_is_plausible_and_the_sea_is_level(place):
    ground = WORLD.heights(*place, bare=True)
    assert ground.dtype == np.float32
    assert ground.min() >= 0.0
    assert ground.max() < 6000.0
    down, across = np.gradient(ground, metres_per_px(place[0], place[2]))
    assert np.percentile(np.hypot(down, across), 99) < math.tan(math.radians(32.0))
    sea = Scene(WORLD.landscape, Grid(*place)).sea
    if sea is not None:
        assert (ground[sea == 1.0] == 0.0).all()


@pytest.mark.parametrize("zoom", [9, 12, 15, 17, 19])
def test_tiles_go_on_where_their_neighbours_end(zoom):
    _, x, y = tile_at(35.14, -89.86, zoom)
    tile, east, south = (WORLD.heights(zoom, *at, bare=True).astype(float) for at in ((x, y), (x + 1, y), (x, y + 1)))
    # What the last steps of one tile lead to is the first of the next one, but for the bend of the ground.
    for last, before, first in (
        (tile[:, -1], tile[:, -2], east[:, 0]),
        (tile[-1], tile[-2], south[0]),
    ):
        bend = np.abs(np.diff(tile, n=2, axis=0)).max() + 0.01
        assert np.abs(first - (2.0 * last - before)).max() <= 3.0 * bend


def test_coarser_zooms_are_the_finer_ones_without_their_detail():
    for zoom in (13, 15, 17):
        _, x, y = tile_at(35.14, -89.86, zoom)
        coarse = WORLD.heights(zoom, x, y, bare=True).astype(float)
        fine = np.block(
            [[WORLD.heights(zoom + 1, 2 * x + i, 2 * y + j, bare=True) for i in (0, 1)] for j in (0, 1)]
        ).astype(float)
        means = fine.reshape(256, 2, 256, 2).mean(axis=(1, 3))
        assert np.abs(coarse - means).max() < 3.0
        assert np.abs(coarse - means).mean() < 0.5


def scene_of_town(zoom=18):
    _, x, y = tile_at(35.14, -89.86, zoom)
    return (zoom, x, y), Scene(WORLD.landscape, Grid(zoom, x, y))


def test_crowns_stand_where_crowns_are_painted_and_no_houses():
    place, scene = scene_of_town()
    above = WORLD.heights(*place) - WORLD.heights(*place, bare=True)
    scale = metres_per_px(place[0], place[2]) / (2.0 * HALF_WORLD_M / (256 << place[0]))
    roofs = footprints(scene.parcels).cover().reshape(256, 256) == 1.0
    assert roofs.sum() > 1000
    # A few crowns reach over a roof.
    assert (above[roofs] < 0.01).mean() > 0.95
    assert above.max() < 12.0
    # What stands there are crowns, and they are as green as the picture has them.
    picture = WORLD.tile("satellite", *place).astype(int)
    crowns = picture[~roofs & (above > 0.9 * EAVES_M * scale)]
    assert len(crowns) > 100
    assert (crowns[:, 1] > crowns[:, 0] - 25).mean() > 0.9


def test_shadows_end_where_the_suns_rays_over_the_eaves_meet_the_ground():
    """The sun that the pictures are painted by stands in the north-west at 50 degrees."""
    zoom, x, y = tile_at(35.14, -89.86, 20)
    pixel = 2.0 * HALF_WORLD_M / (256 << zoom)
    along = EAVES_M / math.tan(math.radians(50.0)) / math.sqrt(2.0) / pixel
    tiles = [[(zoom, x + i, y + j) for i in range(4)] for j in range(4)]
    roofs = np.block(
        [
            [footprints(Scene(WORLD.landscape, Grid(*at)).parcels).cover().reshape(256, 256) > 0.5 for at in row]
            for row in tiles
        ]
    )
    picture = np.block([[WORLD.tile("satellite", *at).astype(int).sum(axis=2) for at in row] for row in tiles])
    # From the eaves in the south-east on, as far as no other roof is in the way.
    eaves = roofs.copy()
    eaves[:-1, :-1] &= ~roofs[1:, 1:]
    i, j = np.nonzero(eaves)

    def median_at(share):
        row, column = (np.rint(at + share * along).astype(int) for at in (i, j))
        good = (row < 1024) & (column < 1024)
        row, column = row[good], column[good]
        free = ~roofs[row, column]
        assert free.sum() > 50
        return np.median(picture[row, column][free])

    dark, lit = median_at(0.4), median_at(1.6)
    assert dark < 0.65 * lit
    shares = np.linspace(0.5, 1.5, 41)
    ends = shares[np.argmax([median_at(share) > (dark + lit) / 2.0 for share in shares])]
    # Towns are sheared, and shadows with them: by up to a third of a metre each way, and two pixels' rounding.
    assert abs(ends - 1.0) * along * pixel < 0.8 + 2.0 * pixel
    assert ends > 0.9


def test_heights_are_the_same_with_other_sines():
    place, _ = scene_of_town()
    plain = WORLD.heights(*place)
    with inexact(3):
        other = World(seed=2024).heights(*place)
    # An edge of a roof may lie on either side of a pixel's centre.
    assert (np.abs(plain - other) < 1e-3).mean() > 0.9999


@pytest.mark.parametrize("crs", ["EPSG:3413", "EPSG:3031"])
def test_the_caps_have_bare_ground(crs):
    world = World(crs=crs)
    ground = world.heights(6, 31, 31)
    assert np.isfinite(ground).all()
    np.testing.assert_array_equal(ground, world.heights(6, 31, 31, bare=True))


def test_heights_are_a_source_of_their_own_zooms():
    source = WorldHeights()
    assert source.grid.native_zoom == 19
    zoom, x, y = tile_at(35.14, -89.86, 19)
    part = source.parts(Window(zoom, x * 256, y * 256, 256, 256))[0].window
    np.testing.assert_array_equal(source.fetch("", part)[..., 0], WORLD.heights(zoom, x, y))
    with pytest.raises(InvalidInput, match="must be from 0 to"):
        WORLD.heights(3, 8, 0)
