"""Augmentation: what is drawn, what it does to pixels, and that it is the same everywhere."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from terrainav.core.dataset.loading.augment import Augmentation, Change, apply_change
from terrainav.core.errors import InvalidInput

ROOT = Path(__file__).resolve().parents[4]
NAMES = [f"{column}_{row}_35.16_-89.9_17" for column in range(40) for row in range(25)]
#: Positions of a smooth spot are measured on whole grey levels, which are cut: about a hundredth of a pixel.
SPOT_TOLERANCE_PX = 0.03
ALL = Augmentation(contrast=0.4, brightness=0.3)


def textured(height, width, channels=3):
    """Pixels of all values, none like its neighbours."""
    y, x, c = np.mgrid[:height, :width, :channels]
    values = (x * 37 + y * 101 + c * 59 + (x * y) % 83) % 256
    return values.astype(np.uint8)


def image_of(pixels):
    return Image.fromarray(pixels if pixels.shape[2] == 3 else pixels[..., 0])


def pixels_of(image):
    pixels = np.asarray(image)
    return pixels if pixels.ndim == 3 else pixels[..., None]


def by_definition(pixels, change):
    """Each pixel from the four around its place in the reflected image, in plain double arithmetic."""
    height, width = pixels.shape[:2]
    angle = math.radians(change.rotation_deg)
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, np.arange(height) + 0.5 - height / 2)
    x, y = x * (-1 if change.mirrored else 1), y * (-1 if change.upside_down else 1)
    along = (math.cos(angle) * x - math.sin(angle) * y) / change.magnification + width / 2 - 0.5
    down = (math.sin(angle) * x + math.cos(angle) * y) / change.magnification + height / 2 - 0.5
    margin = 2 * max(height, width)
    reflected = np.pad(pixels, ((margin, margin), (margin, margin), (0, 0)), mode="symmetric").astype(float)
    left, top = np.floor(along).astype(int), np.floor(down).astype(int)
    right_share, low_share = (along - left)[..., None], (down - top)[..., None]
    at = lambda row, column: reflected[top + row + margin, left + column + margin]  # noqa: E731
    upper = at(0, 0) * (1 - right_share) + at(0, 1) * right_share
    lower = at(1, 0) * (1 - right_share) + at(1, 1) * right_share
    return upper * (1 - low_share) + lower * low_share


@pytest.mark.parametrize("shape", [(48, 64, 3), (33, 33, 1), (20, 90, 3), (7, 5, 1)])
@pytest.mark.parametrize("number", range(6))
def test_pixels_are_those_of_the_definition(shape, number):
    pixels = textured(*shape)
    change = Augmentation(180.0).draw_change(NAMES[number], 7, 1)
    found = pixels_of(apply_change(image_of(pixels), change))
    assert found.shape == shape
    # Cut to whole levels, of positions that are off by half a step of the coefficients: at most 255 levels a pixel.
    steps = max(shape) * 2.0**-16 * 255
    off = by_definition(pixels, change) - found
    assert off.min() > -2 * steps
    assert off.max() < 1 + 2 * steps


@pytest.mark.parametrize("size", [(8, 8), (9, 9)])
@pytest.mark.parametrize("turns", [1, 2, -1])
def test_quarter_turns_are_counter_clockwise_and_exact(size, turns):
    pixels = textured(*size)
    found = apply_change(image_of(pixels), Change(rotation_deg=90.0 * turns))
    np.testing.assert_array_equal(pixels_of(found), np.rot90(pixels, turns))


@pytest.mark.parametrize("shape", [(6, 11, 3), (10, 4, 1)])
def test_mirroring_is_exact(shape):
    pixels = textured(*shape)
    image = image_of(pixels)
    np.testing.assert_array_equal(pixels_of(apply_change(image, Change(mirrored=True))), pixels[:, ::-1])
    np.testing.assert_array_equal(pixels_of(apply_change(image, Change(upside_down=True))), pixels[::-1])
    assert apply_change(image, Change()) is image


@pytest.mark.parametrize("size", [(60, 80), (61, 81)])
def test_the_centre_stays_where_it_is(size):
    """The label is the position of the centre: a spot there may be turned and zoomed, and never moved."""
    height, width = size
    y, x = np.mgrid[:height, :width] + 0.5
    spot = np.exp(-((x - width / 2) ** 2 + 2.0 * (y - height / 2) ** 2) / 60.0)
    image = Image.fromarray((250 * spot).astype(np.uint8))
    for name in NAMES[:40]:
        found = np.asarray(ALL.apply(image, name, 2024, 3), np.float64)
        found -= found.min()
        assert (found * x).sum() / found.sum() == pytest.approx(width / 2, abs=SPOT_TOLERANCE_PX)
        assert (found * y).sum() / found.sum() == pytest.approx(height / 2, abs=SPOT_TOLERANCE_PX)


def test_magnification_shows_less_and_that_larger():
    pixels = np.zeros((41, 41, 1), np.uint8)
    pixels[15:26, 15:26] = 200
    twice = pixels_of(apply_change(image_of(pixels), Change(magnification=2.0)))
    half = pixels_of(apply_change(image_of(pixels), Change(magnification=0.5)))
    assert (twice[20] > 100).sum() == pytest.approx(22, abs=1)
    # In between lies ground that was beyond the borders: the square comes again there.
    assert (half[20, 10:31] > 100).sum() == pytest.approx(5.5, abs=1)


@pytest.mark.parametrize("size", [(640, 100), (3, 200), (64, 64)])
def test_nothing_but_the_image_is_seen_beyond_its_borders(size):
    """An image of one grey stays one, however it lies: no corner is filled with anything else."""
    image = Image.new("L", size, 77)
    for rotation_deg in (0.0, 13.0, 45.0, 90.0, 180.0):
        found = apply_change(image, Change(rotation_deg=rotation_deg, magnification=0.5))
        assert found.size == size
        assert found.getextrema() == (77, 77)


def test_contrast_is_about_the_mean_and_brightness_a_share_of_the_range():
    image = image_of(np.repeat(np.arange(100, 150, dtype=np.uint8)[None, :, None], 3, axis=2))
    flat = np.asarray(apply_change(image, Change(contrast=0.5)), np.float64)
    assert flat.mean() == pytest.approx(124.5, abs=0.5)
    assert np.ptp(flat) == pytest.approx(49 / 2, abs=1.0)
    lighter = np.asarray(apply_change(image, Change(brightness=0.2)), np.float64)
    np.testing.assert_array_equal(lighter, np.asarray(image) + 51.0)
    assert apply_change(image, Change(contrast=2.0, brightness=1.0)).getextrema() == ((255, 255),) * 3


def test_changes_fill_their_ranges_evenly():
    found = [ALL.draw_change(name, 2024, 0) for name in NAMES]
    turns = np.array([one.rotation_deg for one in found])
    scales = np.log([one.magnification for one in found]) / math.log(1.3)
    contrasts = np.array([one.contrast - 1.0 for one in found]) / 0.4
    lights = np.array([one.brightness for one in found]) / 0.3
    for values in (turns / 90.0, scales, contrasts, lights):
        # Ten bins of a thousand values: 100 each, give or take four standard deviations.
        counts, _ = np.histogram(values, 10, (-1.0, 1.0))
        assert counts.sum() == len(NAMES)
        assert np.abs(counts - 100).max() < 40
    assert 430 < sum(one.mirrored for one in found) < 570
    assert 430 < sum(one.upside_down for one in found) < 570
    assert abs(np.corrcoef(turns, scales)[0, 1]) < 0.15


def test_what_is_drawn_follows_from_seed_epoch_and_name_alone():
    usual = Augmentation()
    one = usual.draw_change(NAMES[0], 2024, 0)
    assert one == usual.draw_change(NAMES[0], 2024, 0)
    others = {usual.draw_change(name, seed, epoch) for name in NAMES[:5] for seed in (1, 2024) for epoch in (0, 1)}
    assert one in others
    assert len(others) == 20
    # What is asked for besides leaves the rest as it is; nothing is asked for by default.
    assert ALL.draw_change(NAMES[0], 2024, 0)[:4] == one[:4]
    assert one[4:] == (1.0, 0.0)
    assert Augmentation(0.0, flip=False, zoom=0.0).draw_change(NAMES[0], 2024, 0) == Change()


#: Of ten images of `textured`, changed in every way: made on x86-64 with Pillow 9.4; equal with Pillow 13.0.
DIGEST = "4b4c465f0c7e69c13d16f86f22604d1e9545fecc6e58409efdc61a43862197fc"
PRINT_DIGEST = """
import hashlib, sys
from terrainav.core.dataset.loading.augment import Augmentation
from PIL import Image
whole = hashlib.sha256()
greys = [bytes((i * k) % 251 for i in range(97 * 61)) for k in (3, 7, 11)]
image = Image.merge("RGB", [Image.frombytes("L", (97, 61), one) for one in greys])
every = Augmentation(180.0, contrast=0.4, brightness=0.3)
for number in range(10):
    whole.update(every.apply(image, f"name {number}", 2024, number).tobytes())
print(whole.hexdigest())
"""


def test_pixels_are_the_same_on_every_machine():
    """In another process, whose strings hash otherwise, and against what other machines have found."""
    found = subprocess.run(
        [sys.executable, "-c", PRINT_DIGEST], cwd=ROOT.parent, capture_output=True, text=True, check=True
    )
    assert found.stdout.strip() == DIGEST


@pytest.mark.parametrize(
    ("choice", "words"),
    [
        ({"rotation_deg": -1.0}, "rotation_deg -1.0: must be from 0 to 180"),
        ({"zoom": 1.5}, "zoom 1.5: must be from 0 to 1"),
        ({"contrast": math.nan}, "contrast nan"),
        ({"brightness": 2}, "brightness 2"),
    ],
)
def test_ranges_are_checked(choice, words):
    with pytest.raises(InvalidInput, match=words):
        Augmentation(**choice)


def test_images_too_narrow_to_be_turned_are_refused_before_memory_is_taken():
    with pytest.raises(InvalidInput, match=r"image of 60000 x 1 px: augmented, it needs \d+ x \d+ px"):
        apply_change(Image.new("L", (60000, 1)), Change(rotation_deg=45.0))
