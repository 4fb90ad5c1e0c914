"""Bayer patterns against OpenCV, and the filters as Malvar, He and Cutler print them."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from scipy import ndimage
from terrainav.core.camera.bayer import BILINEAR, MALVAR, PATTERNS, demosaiced, mosaic

#: OpenCV names a pattern by its second row's second and third pixels.
CODES = {
    "rggb": cv2.COLOR_BayerBG2RGB,
    "bggr": cv2.COLOR_BayerRG2RGB,
    "grbg": cv2.COLOR_BayerGB2RGB,
    "gbrg": cv2.COLOR_BayerGR2RGB,
}
#: Figure 2 of the paper, times 8.
GREEN = [[0, 0, -1, 0, 0], [0, 0, 2, 0, 0], [-1, 2, 4, 2, -1], [0, 0, 2, 0, 0], [0, 0, -1, 0, 0]]
ROW = [[0, 0, 0.5, 0, 0], [0, -1, 0, -1, 0], [-1, 4, 5, 4, -1], [0, -1, 0, -1, 0], [0, 0, 0.5, 0, 0]]
CORNER = [[0, 0, -1.5, 0, 0], [0, 2, 0, 2, 0], [-1.5, 0, 6, 0, -1.5], [0, 2, 0, 2, 0], [0, 0, -1.5, 0, 0]]


def planes(height=37, width=52):
    bits = np.random.default_rng(3)
    return ndimage.gaussian_filter(bits.uniform(0.0, 4000.0, (height, width, 3)), (1.5, 1.5, 0)).astype(np.float32)


def masks(pattern, shape):
    row, column = np.mgrid[: shape[0], : shape[1]] % 2
    letters = np.array(list(pattern))[2 * row + column]
    return letters == "r", letters == "g", letters == "b"


@pytest.mark.parametrize("pattern", PATTERNS)
def test_a_pixel_measures_the_colour_of_its_filter(pattern):
    colours = planes()
    measured = mosaic(colours, pattern)
    for band, mask in enumerate(masks(pattern, measured.shape)):
        assert (measured[mask] == colours[..., band][mask]).all()
    assert measured[0, 0] == colours[0, 0, "rgb".index(pattern[0])]
    assert measured[1, 0] == colours[1, 0, "rgb".index(pattern[2])]


@pytest.mark.parametrize("method", [BILINEAR, MALVAR])
@pytest.mark.parametrize("pattern", PATTERNS)
def test_measured_colours_stay_and_even_colours_are_found(pattern, method):
    measured = mosaic(planes(), pattern)
    found = demosaiced(measured, pattern, method)
    for band, mask in enumerate(masks(pattern, measured.shape)):
        assert (found[..., band][mask] == measured[mask]).all()
    even = np.broadcast_to(np.float32([300.0, 200.0, 100.0]), (9, 8, 3))
    if method == BILINEAR:
        assert demosaiced(mosaic(even, pattern), pattern, method) == pytest.approx(even)
    grey = np.full((9, 8, 3), 200.0, np.float32)
    assert demosaiced(mosaic(grey, pattern), pattern, method) == pytest.approx(grey)


@pytest.mark.parametrize("pattern", PATTERNS)
def test_bilinear_is_that_of_opencv(pattern):
    measured = np.rint(mosaic(planes(), pattern)).astype(np.uint16)
    theirs = cv2.cvtColor(measured, CODES[pattern]).astype(np.float64)
    ours = demosaiced(measured.astype(np.float32), pattern, BILINEAR)
    # OpenCV rounds to whole numbers, and repeats its results along the edges.
    assert np.abs(ours - theirs)[1:-1, 1:-1].max() <= 0.5


@pytest.mark.parametrize("shape", [(37, 52), (8, 9), (2, 3), (3, 2)])
@pytest.mark.parametrize("pattern", PATTERNS)
def test_malvar_is_that_of_the_paper(pattern, shape):
    measured = mosaic(planes(*shape), pattern)
    around = np.pad(measured.astype(np.float64), 2, mode="reflect")
    filtered = {
        name: ndimage.correlate(around, np.array(kernel) / 8.0)[2:-2, 2:-2]
        for name, kernel in {"green": GREEN, "row": ROW, "column": np.transpose(ROW), "corner": CORNER}.items()
    }
    red, green, blue = masks(pattern, shape)
    red_row = red.any(axis=1)[:, np.newaxis]
    beside = np.where(red_row, filtered["row"], filtered["column"])
    above = np.where(red_row, filtered["column"], filtered["row"])
    wanted = np.stack(
        [
            np.select([red, green], [measured, beside], filtered["corner"]),
            np.where(green, measured, filtered["green"]),
            np.select([blue, green], [measured, above], filtered["corner"]),
        ],
        axis=-1,
    )
    assert demosaiced(measured, pattern, MALVAR) == pytest.approx(wanted, rel=1e-5, abs=2e-3)


def test_malvar_is_sharper_than_bilinear():
    grey = np.repeat(planes(80, 80)[..., :1], 3, axis=2)
    measured = mosaic(grey, "rggb")
    errors = {
        method: np.sqrt(np.mean((demosaiced(measured, "rggb", method) - grey) ** 2)) for method in (BILINEAR, MALVAR)
    }
    assert errors[MALVAR] < 0.6 * errors[BILINEAR]
