from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis.extra.numpy import array_shapes, arrays
from PIL import Image
from terrainav.core.dataset.entropy import entropy
from terrainav.core.errors import InvalidInput

# Sums of 256 terms in another order.
ROUNDING = 1e-12


def entropy_by_counting(grey) -> float:
    """Equation 10, term by term."""
    counts = Counter(np.asarray(grey).ravel().tolist())
    total = sum(counts.values())
    return math.fsum(-n / total * math.log2(n / total) for n in counts.values())


@settings(max_examples=60, deadline=None)
@given(arrays(np.uint8, array_shapes(min_dims=2, max_dims=2, max_side=40)))
def test_grey_images_match_the_formula(image):
    assert entropy(image) == pytest.approx(entropy_by_counting(image), abs=ROUNDING)


def test_colours_become_grey_as_pillows_l():
    image = np.random.default_rng(1).integers(0, 256, (121, 87, 3), np.uint8)
    red, green, blue = (image[..., at].astype(np.int64) for at in range(3))
    # ITU-R 601 in sixteen-bit fractions, rounded.
    luma = (19595 * red + 38470 * green + 7471 * blue + 0x8000) >> 16
    assert np.array_equal(luma, np.asarray(Image.fromarray(image).convert("L")))
    assert entropy(image) == pytest.approx(entropy_by_counting(luma), abs=ROUNDING)


def test_one_level_has_none_and_all_levels_have_eight_bits():
    assert math.copysign(1.0, entropy(np.full((9, 7), 200, np.uint8))) == 1.0
    assert entropy(np.full((9, 7, 3), 200, np.uint8)) == 0.0
    assert entropy(np.arange(256, dtype=np.uint8).reshape(16, 16)) == 8.0


def test_a_view_is_read_as_it_looks():
    image = np.random.default_rng(2).integers(0, 256, (40, 60, 3), np.uint8)
    assert entropy(image[::2, ::-3]) == entropy(image[::2, ::-3].copy())


def test_large_pictures_are_counted_whole():
    """Larger than what is counted at a time, in colour and grey, with a rest."""
    colour = np.random.default_rng(3).normal(120.0, 30.0, (1300, 1000, 3)).clip(0, 255).astype(np.uint8)
    grey = np.asarray(Image.fromarray(colour).convert("L"))
    assert entropy(colour) == entropy(grey) == pytest.approx(entropy_by_counting(grey), abs=ROUNDING)


@pytest.mark.parametrize(
    "image",
    [
        np.zeros((4, 4), np.float64),
        np.zeros((4, 4, 4), np.uint8),
        np.zeros((4,), np.uint8),
        np.zeros((0, 4), np.uint8),
    ],
)
def test_what_is_no_image_is_refused(image):
    with pytest.raises(InvalidInput, match="must be"):
        entropy(image)
