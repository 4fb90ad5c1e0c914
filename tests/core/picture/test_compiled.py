"""Camera frames by compiled code: the pixels of Pillow and numpy. Over level ground it is loaded where that pays."""

from __future__ import annotations

import subprocess
import sys
from contextlib import nullcontext

import numpy as np
import pytest
from terrainav.core.bands import Bands
from terrainav.core.errors import PartError
from terrainav.core.external import compiling
from terrainav.core.geodesy.areas import AreaCells, Areas, plane_areas
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.view import Patches, Samples, View
from terrainav.core.imagery.source import Part, Window
from terrainav.core.picture import camera_frame

needs_numba = pytest.mark.skipif(not compiling.uses_numba(), reason="numba is not installed")
GRID, ZOOM = PixelGrid(), 8
HEIGHT, WIDTH = 60, 90


def patches(rng, wide, high):
    """Two boxes of a picture, side by side, whose corners lie on an image of 90 x 60 px and around it."""
    box = np.array([[0, 0, 13, 20], [13, 0, 32, 20]])
    corners = np.array([[0.1, 0.1], [0.2, 0.9], [0.9, 1.05], [1.05, 0.0]]) * (WIDTH, HEIGHT)
    x, y = (corners + rng.uniform(-9.0, 9.0, (2, 4, 2))).transpose(2, 0, 1) / GRID.world_px(ZOOM)
    return Patches(ZOOM, wide, high, box, x, y)


def pictures(patch, pixels, kernel, missing=None):
    """The same picture by Pillow and by compiled code."""
    ground = camera_frame._Ground(pixels, missing, 0, 0)
    found = []
    for warp in (camera_frame._warp, camera_frame._warp_compiled):
        picture = np.zeros((24, 32, pixels.shape[2]), pixels.dtype)
        warp(picture, patch, ground, GRID, 0.0, kernel)
        found.append(picture)
    return found


@needs_numba
@pytest.mark.parametrize("kernel", ["nearest", "bilinear"])
@pytest.mark.parametrize(("wide", "high"), [(1, 1), (1, 2), (1, 8), (2, 1), (4, 1), (2, 2), (4, 8), (8, 4)])
@pytest.mark.parametrize(
    ("data_type", "channels"), [("uint8", 1), ("uint8", 3), ("uint8", 4), ("uint16", 2), ("int16", 1), ("float32", 3)]
)
def test_patches_are_those_of_pillow_to_the_last_bit(kernel, wide, high, data_type, channels):
    rng = np.random.default_rng([wide, high, channels])
    for _ in range(5):
        high_value = {"uint8": 256, "uint16": 65536}.get(data_type, 32768)
        low_value = -32768 if data_type == "int16" else 0
        pixels = rng.integers(low_value, high_value, (HEIGHT, WIDTH, channels)).astype(data_type)
        if data_type == "float32":
            pixels /= np.float32(7.0)
        wanted, found = pictures(patches(rng, wide, high), pixels, kernel)
        assert wanted.any()
        assert np.array_equal(found, wanted)


@needs_numba
def test_missing_imagery_is_refused_as_without():
    rng = np.random.default_rng(1)
    pixels, missing = np.full((HEIGHT, WIDTH, 3), 9, np.uint8), np.zeros((HEIGHT, WIDTH), bool)
    pictures(patches(rng, 1, 2), pixels, "bilinear", missing)
    missing[25:30, 40:45] = True
    reasons = []
    for warp in (camera_frame._warp, camera_frame._warp_compiled):
        ground = camera_frame._Ground(pixels, missing, 0, 0)
        with pytest.raises(PartError) as refused:
            warp(np.zeros((24, 32, 3), np.uint8), patches(np.random.default_rng(1), 1, 2), ground, GRID, 0.0, "nearest")
        reasons.append(str(refused.value))
    assert reasons[0] == reasons[1]


TILE_PX = GRID.tile_px
VALUES = {"uint8": (0, 256), "uint16": (0, 65536), "int16": (-32768, 32768), "float32": (-10000, 10000)}


def drawn(rng, tiles, bands, samples):
    """The same pixels, sampled in three of four tiles and around them, by numpy and by compiled code."""
    places = list(tiles)
    parts = [Part(Window(ZOOM, x, y, TILE_PX, TILE_PX), x, y) for x, y in places]
    pixels = {part.window: tile for part, tile in zip(parts, tiles.values())}
    row, column = np.divmod(rng.permutation(24 * 32)[:500], 32)
    du = rng.uniform(-9.0, 2.0 * TILE_PX + 9.0, (500, samples))
    # On the middle of a border, and of pixels, too.
    du[0], du[1] = TILE_PX, TILE_PX - 0.5
    v = np.where(du < TILE_PX - 5, 1.0, 0.5) * rng.uniform(-9.0, 2.0 * TILE_PX - 9.0, (500, samples))
    world = GRID.world_px(ZOOM)
    seen = Samples(ZOOM, row, column, (du + TILE_PX) / world, (v + TILE_PX) / world)
    found = []
    for ground in (
        camera_frame._ground(ZOOM, parts, pixels, bands, is_warped=False),
        camera_frame._Tiles.found(ZOOM, parts, pixels, bands, TILE_PX),
    ):
        picture = np.zeros((24, 32, len(bands)), bands.dtype)
        camera_frame._gather(picture, seen, ground, GRID, 0.0, "bilinear")
        found.append(picture)
    return found


def tiles_of(rng, data_type, channels, depths=(0, 0, 0)):
    """Tiles of 2 columns and 2 rows without the lower right one, some with a mask."""
    places = [(TILE_PX, TILE_PX), (2 * TILE_PX, TILE_PX), (TILE_PX, 2 * TILE_PX)]
    made = {}
    for place, more in zip(places, depths):
        tile = rng.integers(*VALUES[data_type], (TILE_PX, TILE_PX, channels + more)).astype(data_type)
        tile[..., channels:] = 1
        made[place] = tile
    return made


@needs_numba
@pytest.mark.parametrize("samples", [1, 2, 4, 16])
@pytest.mark.parametrize(
    ("data_type", "channels"), [("uint8", 3), ("uint8", 2), ("uint16", 4), ("int16", 2), ("float32", 3)]
)
def test_samples_of_tiles_are_those_of_joined_ones_to_the_last_bit(samples, data_type, channels):
    rng = np.random.default_rng([samples, channels])
    bands = Bands(tuple(map(str, range(channels))), data_type, (0,))
    for depths in ((0, 0, 0), (1, 0, 1)):
        wanted, found = drawn(rng, tiles_of(rng, data_type, channels, depths), bands, samples)
        assert wanted.any()
        assert np.array_equal(found, wanted)


@needs_numba
@pytest.mark.parametrize(
    ("data_type", "channels", "in_light"),
    [("uint8", 3, True), ("uint8", 1, True), ("uint8", 3, False), ("uint16", 4, False)],
)
def test_areas_over_tiles_are_those_over_joined_ones_to_the_last_bit(data_type, channels, in_light):
    """Some reach across borders of tiles, beyond them, and into tiles with a mask."""
    rng, count, world = np.random.default_rng(channels), 500, GRID.world_px(ZOOM)
    bands = Bands(tuple(map(str, range(channels))), data_type, (0,))
    row, column = np.divmod(rng.permutation(24 * 32)[:count], 32)
    x = TILE_PX + rng.uniform(-9.0, 2.0 * TILE_PX + 9.0, count)
    y = TILE_PX + np.where(x < 2.0 * TILE_PX - 40.0, 1.0, 0.4) * rng.uniform(-9.0, 2.0 * TILE_PX - 9.0, count)
    counts, steps = rng.integers(1, 9, (count, 2)), rng.uniform(-2.0, 2.0, (count, 4))
    areas = Areas(ZOOM, row, column, x / world, y / world, steps / world, counts)
    for depths in ((0, 0, 0), (1, 0, 1)):
        tiles = tiles_of(rng, data_type, channels, depths)
        parts = [Part(Window(ZOOM, *place, TILE_PX, TILE_PX), *place) for place in tiles]
        pixels = {part.window: tile for part, tile in zip(parts, tiles.values())}
        found = []
        for ground in (
            camera_frame._ground(ZOOM, parts, pixels, bands, is_warped=False),
            camera_frame._Tiles.found(ZOOM, parts, pixels, bands, TILE_PX),
        ):
            picture = np.zeros((24, 32, channels), bands.dtype)
            ground.average(picture, areas, 0.0, world, in_light=in_light)
            found.append(picture)
        assert found[0].any()
        assert np.array_equal(*found)


@needs_numba
@pytest.mark.parametrize("zooms", [(3, 20), (17, 17)])
def test_areas_and_their_samples_are_those_of_numpy_to_the_last_bit(zooms):
    """Of pixels of every size, shape and turn, and some of circles."""
    import numba  # noqa: F401

    rng, count = np.random.default_rng(6), 3_000
    steps = rng.normal(size=(4, count)) * 2.0 ** rng.uniform(-34.0, -10.0, (2, count)).repeat(2, axis=0)
    steps[:, :3] = 2.0**-20 * np.array([[1.0], [0.0], [0.0], [1.0]])
    place, pixels = rng.uniform(0.1, 0.9, (2, count)), (np.arange(count), np.arange(count)[::-1])
    found = []
    for code in (compiling.without_numba(), nullcontext()):
        with code:
            found.append(plane_areas(*pixels, tuple(place), (tuple(steps[:2]), tuple(steps[2:])), GRID, zooms))
    assert [one.zoom for one in found[0]] == [one.zoom for one in found[1]]
    for one, other in zip(*found):
        for values, others in zip(one[1:], other[1:]):
            assert np.array_equal(values, others)


@needs_numba
def test_areas_of_cells_are_those_of_numpy_to_the_last_bit():
    import numba  # noqa: F401

    rng, found = np.random.default_rng(7), []
    box, corners = np.array([[0, 0, 13, 20], [13, 0, 32, 20]]), np.array([[0, 0], [0.1, 1], [1, 0.9], [0.9, 0]])
    u, v = (corners + rng.uniform(-0.05, 0.05, (2, 4, 2))).transpose(2, 0, 1) / GRID.world_px(ZOOM)
    for code in (compiling.without_numba(), nullcontext()):
        with code:
            found += AreaCells(ZOOM + 8, box, u, v).areas(GRID, None)
    for values, others in zip(*(one[1:] for one in found)):
        assert np.array_equal(values, others)


@needs_numba
def test_samples_of_a_single_band_are_added_in_the_same_order():
    """Another order would change a grey level in some of many pixels."""
    rng, side = np.random.default_rng(4), 400
    part = Part(Window(ZOOM, 0, 0, TILE_PX, TILE_PX), 0, 0)
    pixels = {part.window: rng.integers(0, 256, (TILE_PX, TILE_PX, 1)).astype(np.uint8)}
    row, column = (at.ravel() for at in np.mgrid[:side, :side])
    place = rng.uniform(0.0, TILE_PX, (2, side * side, 32)) / GRID.world_px(ZOOM)
    view = View(side, side, GRID, (), (Samples(ZOOM, row, column, *place),), None, None, 0.0)
    found = []
    for code in (compiling.without_numba(), nullcontext()):
        with code:
            found.append(camera_frame.render(view, -180.0, [part], pixels, "bilinear", Bands(("grey",), "uint8", (0,))))
    assert np.array_equal(*found)


@needs_numba
def test_tiles_of_another_size_are_refused():
    part = Part(Window(ZOOM, 0, 0, TILE_PX, TILE_PX // 2), 0, 0)
    with pytest.raises(PartError, match="has shape"):
        camera_frame._Tiles.found(
            ZOOM,
            [part],
            {part.window: np.zeros((TILE_PX // 2, TILE_PX, 1), np.uint8)},
            Bands(("grey",), "uint8", (0,)),
            TILE_PX,
        )


@needs_numba
def test_samples_without_imagery_are_refused_as_without():
    bands = Bands(("grey", "nir"), "uint8", (0,))
    tiles = tiles_of(np.random.default_rng(0), "uint8", 2, (1, 1, 0))
    tiles[TILE_PX, TILE_PX][90:100, :, 2] = 0
    parts = [Part(Window(ZOOM, x, y, TILE_PX, TILE_PX), x, y) for x, y in tiles]
    pixels = {part.window: tile for part, tile in zip(parts, tiles.values())}
    place = np.random.default_rng(2).uniform(1.1, 1.9, (2, 400, 4)) * TILE_PX / GRID.world_px(ZOOM)
    seen = Samples(ZOOM, np.arange(400) // 20, np.arange(400) % 20, *place)
    view = View(20, 20, GRID, (), (seen,), None, None, 0.0)
    reasons = []
    for code in (compiling.without_numba(), nullcontext()):
        with code, pytest.raises(PartError) as refused:
            camera_frame.render(view, -180.0, parts, pixels, "bilinear", bands)
        reasons.append(str(refused.value))
    assert reasons[0] == reasons[1]


@needs_numba
@pytest.mark.parametrize(("images", "is_loaded"), [(1, False), (99, False), (100, True)])
def test_numba_is_loaded_only_where_level_images_are_many(images, is_loaded):
    code = f"""
import sys
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.camera_frame import load_code
from terrainav.core.picture.shot import draw, make_shot, picture_parts
from terrainav.core.world import WorldSource

source = WorldSource()
points = tuple((35.14 + 1e-5 * at, -89.86, 120.0) for at in range({images}))
made = plan(Mission(Points(points), 120.0, tilt_deg=60.0), source.grid)
load_code(made)
parts = picture_parts(made, source, 0)
draw(make_shot(made, 0), parts, {{part.window: source.fetch("satellite", part.window) for part in parts}})
print("numba" in sys.modules)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == f"{is_loaded}\n"
