from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image
from terrainav.core.errors import PartError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.source import Part, Window, tile_parts
from terrainav.core.picture.map_frame import assemble, resized

from tests.support.patterns import MODULUS, decode_position
from tests.support.sources import PatternSource
from tests.support.thinning import examples


def assembled(window, source):
    parts = source.parts(window)
    return assemble(window, parts, {part.window: source.fetch("satellite", part.window) for part in parts})


@settings(max_examples=examples(60), deadline=None)
@given(
    left=st.integers(-600, 3000), top=st.integers(0, 3000), width=st.integers(1, 700), height=st.integers(1, 700),
    tile_px=st.sampled_from([256, 512]),
)  # fmt: skip
def test_every_pixel_is_where_the_window_says(left, top, width, height, tile_px):
    window = Window(5, left, top, width, height)
    columns, rows = decode_position(assembled(window, PatternSource(tile_px=tile_px)))
    world = tile_px << 5
    assert np.array_equal(columns, np.broadcast_to((left + np.arange(width)) % world % MODULUS, (height, width)))
    assert np.array_equal(rows, np.broadcast_to(((top + np.arange(height)) % MODULUS)[:, np.newaxis], (height, width)))


def test_a_picture_with_a_hole_is_none():
    window = Window(5, 100, 100, 300, 300)
    source = PatternSource()
    parts = source.parts(window)
    pixels = {part.window: source.fetch("satellite", part.window) for part in parts}
    with pytest.raises(PartError, match=r"no imagery at \d+ of the image's 90000 pixels"):
        assemble(window, parts[:-1], pixels)
    shifted = [part._replace(dx_px=part.dx_px + 1) if part.dx_px < 0 else part for part in parts]
    assert assemble(window, shifted, pixels).shape == (
        300,
        300,
        3,
    )  # they overlap by a pixel and leave none open
    shifted = [part._replace(dx_px=part.dx_px - 1) if part.dx_px < 0 else part for part in parts]
    with pytest.raises(PartError, match=r"no imagery at 300 of the image's 90000 pixels"):
        assemble(window, shifted, pixels)


def test_transparent_pixels_are_no_imagery_where_the_picture_shows_them():
    part = Part(Window(5, 0, 0, 256, 256), -10, -20)
    tile = np.full((256, 256, 4), 255, np.uint8)
    tile[:20, :, 3] = 0
    tile[20, 10, :3] = (1, 2, 3)
    picture = assemble(Window(5, 10, 20, 50, 40), [part], {part.window: tile})
    assert picture.shape == (40, 50, 3)
    assert picture[0, 0].tolist() == [1, 2, 3]
    tile[25, 30, 3] = 0
    with pytest.raises(PartError, match="no imagery at 1 of the image's 2000 pixels"):
        assemble(Window(5, 10, 20, 50, 40), [part], {part.window: tile})


@pytest.mark.parametrize(
    "image",
    [np.zeros((256, 255, 3), np.uint8), np.zeros((256, 256), np.uint8), np.zeros((256, 256, 3), np.float32)],
)
def test_a_part_of_another_size_is_refused(image):
    part = Part(Window(5, 0, 0, 256, 256), 0, 0)
    with pytest.raises(PartError, match="was asked for"):
        assemble(Window(5, 0, 0, 10, 10), [part], {part.window: image})


def test_parts_are_left_as_they_are():
    window = Window(3, 0, 0, 256, 256)
    tile = PatternSource().fetch("satellite", window)
    picture = assemble(window, tile_parts(window, PixelGrid()), {window: tile})
    picture[:] = 0
    assert tile.any()


def test_sizes_and_channels():
    picture = np.random.default_rng(3).integers(0, 256, (60, 80, 3), np.uint8)
    assert resized(picture, None) is picture
    assert np.array_equal(resized(picture, (80, 60, 3)), picture)
    assert np.array_equal(resized(picture, (80, 60, 1)), np.asarray(Image.fromarray(picture).convert("L")))
    assert resized(picture, (33, 22, 3)).shape == (22, 33, 3)
    assert resized(picture, (160, 200, 1)).shape == (200, 160)


@pytest.mark.parametrize("size", [(40, 30), (17, 13), (200, 150)])
def test_resizing_keeps_the_ground_in_place(size):
    """A brightness that grows evenly over the ground still does, without a shift: Lanczos keeps planes."""
    width, height = 120, 90
    ramp = np.linspace(40.0, 200.0, width * 2 + 1)[1::2]
    picture = np.repeat(np.broadcast_to(np.round(ramp).astype(np.uint8), (height, width))[..., np.newaxis], 3, axis=2)
    small = resized(picture, (*size, 1)).astype(float)
    expected = np.linspace(40.0, 200.0, size[0] * 2 + 1)[1::2]
    inner = slice(size[0] // 4, -size[0] // 4)
    # Each grey level of the original is rounded by half at most, and so is each of the result.
    assert np.abs(small[:, inner] - expected[inner]).max() <= 1.0


def test_fine_detail_is_averaged_when_shrinking():
    stripes = np.zeros((64, 64, 3), np.uint8)
    stripes[:, ::2] = 255
    small = resized(stripes, (16, 16, 3)).astype(float)
    assert np.abs(small[2:-2, 2:-2] - 127.5).max() < 3.0
