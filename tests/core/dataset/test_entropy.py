from __future__ import annotations

import json
import math
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis.extra.numpy import array_shapes, arrays
from PIL import Image
from terrainav.core.dataset.dataset import Images, open_image
from terrainav.core.dataset.entropy import entropy
from terrainav.core.errors import InvalidInput

from tests.support.peers import told_by_peers
from tests.support.thinning import examples

# Sums of 256 terms in another order.
ROUNDING = 1e-12


def entropy_by_counting(grey) -> float:
    """Equation 10, term by term."""
    counts = Counter(np.asarray(grey).ravel().tolist())
    total = sum(counts.values())
    return math.fsum(-n / total * math.log2(n / total) for n in counts.values())


@settings(max_examples=examples(60), deadline=None)
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


# --- against scikit-image, which has an environment of its own

#: Images (name.npy) of a folder: made grey as Pillow does it there, and scikit-image's entropy of that.
PEER_CODE = """
import json, pathlib, sys
import numpy as np
from PIL import Image
from skimage.measure import shannon_entropy

found = {}
for path in pathlib.Path(sys.argv[1]).glob("*.npy"):
    found[path.stem] = float(shannon_entropy(np.asarray(Image.fromarray(np.load(path)).convert("L"))))
print(json.dumps(found))
"""


def kinds_of_images():
    """Images of every kind that a map or a camera gives, in colour and grey, and the extremes of the measure."""
    random = np.random.default_rng(4)
    x = np.arange(131)[None, :] + np.zeros((97, 1))
    photograph = 120.0 + 60.0 * np.sin(x / 17.0)[..., None] * [1.0, 0.8, 0.5] + random.normal(0, 9, (97, 131, 3))
    roadmap = np.full((480, 640, 3), (242, 240, 233), np.uint8)
    roadmap[200:220], roadmap[:, 300:312] = (255, 255, 255), (254, 216, 93)
    one_pixel = np.full((64, 64), 7, np.uint8)
    one_pixel[3, 5] = 8
    images = {
        "photograph": photograph.clip(0, 255).astype(np.uint8),
        "roadmap": roadmap,
        "noise": random.integers(0, 256, (64, 80, 3), np.uint8),
        "large": random.normal(90.0, 25.0, (900, 1100, 3)).clip(0, 255).astype(np.uint8),
        "ramp": np.arange(256, dtype=np.uint8).reshape(16, 16),
        "level": np.full((9, 7), 200, np.uint8),
        "one-pixel": one_pixel,
        "single": np.zeros((1, 1), np.uint8),
    }
    for levels in (2, 3, 17, 200):
        images[f"levels-{levels}"] = random.integers(0, levels, (50, 60), np.uint8)
    return images


def test_it_is_scikit_images_shannon_entropy(tmp_path):
    images = kinds_of_images()
    for name, image in images.items():
        np.save(tmp_path / f"{name}.npy", image)
    theirs = json.loads(told_by_peers("-I", "-c", PEER_CODE, tmp_path))
    assert theirs.keys() == images.keys()
    assert {name: entropy(image) for name, image in images.items()} == pytest.approx(theirs, rel=0, abs=ROUNDING)


def test_images_that_loaders_refuse_have_no_entropy_either(tmp_path):
    Image.fromarray(np.full((8, 8), 40_000, np.uint16)).save(tmp_path / "deep.png")
    with pytest.raises(InvalidInput, match="must be 8-bit grey or colour"):
        open_image(Images(tmp_path).path("deep.png"))
