"""The embedded world: one landscape, whatever is asked of it first, at whatever zoom, style, thread or seed."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache, partial

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.imagery.source import Window
from terrainav.core.world import World, WorldSource

from tests.support.thinning import sampled

STYLES = ("satellite", "roadmap", "terrain")
WORLD = World(2024)
#: The paper's Agricenter, as world fractions.
AGRICENTER = (0.25038, 0.39581)
#: Zoom z + 1 averaged two by two is zoom z within this root mean square of grey levels: what a pixel's low-pass
#: and the average of four, a box, make different of the same detail. Maps are flat, photographs are not.
PYRAMID_RMS = {"satellite": 22.0, "roadmap": 8.0, "terrain": 13.0}


def tile_at(zoom, place=AGRICENTER):
    return int(place[0] * 2**zoom), int(place[1] * 2**zoom)


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("zoom", [0, 3, 9, 14, 18, 22])
def test_a_tile_is_its_pixels_one_by_one(style, zoom):
    x, y = tile_at(zoom)
    tile = WORLD.tile(style, zoom, x, y)
    rows, columns = np.random.default_rng(zoom).integers(0, 256, (2, 300))
    side = 2.0**-zoom / 256
    u, v = (x * 256 + columns + 0.5) * side, (y * 256 + rows + 0.5) * side
    colour = WORLD.colour(style, u, v, zoom)
    # A tile's float32 arithmetic runs in another order, which may round half a grey level the other way.
    assert np.abs(colour - tile[rows, columns].astype(float)).max() <= 0.52


@pytest.mark.parametrize("style", STYLES)
def test_every_zoom_shows_something(style):
    for zoom in range(23):
        tile = WORLD.tile(style, zoom, *tile_at(zoom))
        assert tile.shape == (256, 256, 3)
        assert tile.dtype == np.uint8
    assert all(WORLD.tile(style, zoom, *tile_at(zoom)).std() > 1 for zoom in (0, 5, 10, 14))


def steps(pixels):
    """Mean change of colour from each column to the next."""
    return np.abs(np.diff(pixels.astype(float), axis=1)).mean(axis=(0, 2))


@pytest.mark.parametrize("style", sampled(STYLES, 3))
@pytest.mark.parametrize(("zoom", "y"), [(4, 6), (9, 200), (15, 12_970)])
def test_tiles_have_no_seams_also_across_the_antimeridian(style, zoom, y):
    here = tile_at(zoom)[0]
    for left, right in (((1 << zoom) - 1, 0), (here, here + 1)):
        pair = np.concatenate([WORLD.tile(style, zoom, left, y), WORLD.tile(style, zoom, right, y)], axis=1)
        inside = np.delete(steps(pair), 255)
        assert steps(pair)[255] <= inside.max() + 1e-9
        down = np.concatenate([WORLD.tile(style, zoom, left, y), WORLD.tile(style, zoom, left, y + 1)], axis=0)
        across = steps(down.swapaxes(0, 1))
        assert across[255] <= np.delete(across, 255).max() + 1e-9


def test_order_and_threads_make_no_difference():
    x, y = tile_at(18)
    wanted = [(style, 18, x + i % 3, y + i // 3) for i in range(6) for style in STYLES]
    alone = [World(2024).tile(*tile) for tile in wanted]
    world = World(2024)
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda tile: world.tile(*tile), reversed(wanted)))[::-1]
    for one, other in zip(alone, together):
        np.testing.assert_array_equal(one, other)


def test_another_seed_is_another_world():
    x, y = tile_at(14)
    assert (World(1).tile("satellite", 14, x, y) != World(2).tile("satellite", 14, x, y)).mean() > 0.5


@pytest.mark.parametrize("step", [3, pytest.param(1, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("style", STYLES)
def test_a_zoom_is_the_next_one_averaged(style, step):
    random = np.random.default_rng(5)
    # A tile is one of those below the tile of the zoom before, too.
    tile = lru_cache(8)(partial(WORLD.tile, style))
    for zoom in range(0, 22, step):
        places = [AGRICENTER, (random.uniform(), random.uniform(0.2, 0.8))]
        for place in places[: 1 + (zoom % 6 == 0)]:
            x, y = tile_at(zoom, place)
            below = np.concatenate(
                [np.concatenate([tile(zoom + 1, 2 * x + i, 2 * y + j) for i in (0, 1)], axis=1) for j in (0, 1)]
            )
            averaged = below.reshape(256, 2, 256, 2, 3).mean(axis=(1, 3))
            assert np.sqrt(np.mean((averaged - tile(zoom, x, y)) ** 2)) < PYRAMID_RMS[style]


@pytest.mark.parametrize(("x", "y"), [(510, 1614), (267, 2734), (559, 1664), (3490, 2707), (1777, 2584)])
def test_the_styles_show_the_same_water(x, y):
    roadmap, satellite, terrain = (
        WORLD.tile(style, 12, x, y).astype(int) for style in ("roadmap", "satellite", "terrain")
    )
    # Street maps draw water in a blue that nothing else has.
    water = (roadmap[..., 2] > roadmap[..., 0] + 30) & (roadmap[..., 2] > 190)
    assert 0.1 < water.mean() < 0.9
    for other in (satellite, terrain):
        blueness = other[..., 2] - other[..., 0]
        right = (blueness > (blueness[water].mean() + blueness[~water].mean()) / 2) == water
        assert right.mean() > 0.95


def entropy(tile):
    grey = (tile.astype(float) @ [0.299, 0.587, 0.114]).round().astype(int)
    share = np.bincount(grey.ravel(), minlength=256) / grey.size
    return float(-(share[share > 0] * np.log2(share[share > 0])).sum())


def test_maps_of_fields_are_emptier_than_maps_of_towns():
    x, y = tile_at(18)
    bits = [entropy(WORLD.tile("roadmap", 18, x + 3 * i, y + 3 * j)) for i in range(6) for j in range(6)]
    # The paper drops pictures below 2.1 bits.
    assert min(bits) < 2.1 < max(bits)


def test_the_source_gives_tiles_where_parts_ask_for_them():
    source = WorldSource(7)
    parts = source.parts(Window(18, 16795785, 26545153, 323, 243))
    for part in parts:
        pixels = source.fetch("roadmap", part.window)
        x, y = int(part.window.left_px) // 256, int(part.window.top_px) // 256
        np.testing.assert_array_equal(pixels, World(7).tile("roadmap", 18, x, y))
    assert source.title == "Synthetic (offline)"


@pytest.mark.parametrize(
    "ask",
    [
        lambda: WORLD.tile("hybrid", 3, 0, 0),
        lambda: WORLD.tile("terrain", 23, 0, 0),
        lambda: WORLD.tile("terrain", -1, 0, 0),
        lambda: WORLD.tile("terrain", 3, 8, 0),
        lambda: WORLD.tile("terrain", 3, 0, -1),
        lambda: WORLD.colour("terrain", np.array([np.nan]), np.array([0.5]), 3),
        lambda: WORLD.colour("terrain", np.array([0.5]), np.array([1.5]), 3),
    ],
)
def test_what_is_not_of_this_world_is_refused(ask):
    with pytest.raises(InvalidInput):
        ask()
