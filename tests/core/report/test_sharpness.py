"""The slanted-edge tool, against edges whose blur and pixels are integrated exactly."""

from __future__ import annotations

import math

import numpy as np
import pytest
from PIL import Image
from scipy.special import erf
from terrainav.core.camera.light import encoded
from terrainav.core.camera.optics import gaussian_contrast, half_contrast, pixel_contrast
from terrainav.core.cli import main
from terrainav.core.errors import InvalidInput
from terrainav.core.report.sharpness import edge_response


def blurred_edge(deviation, slant_deg, shape=(160, 160), low=0.2, high=0.6, place=0.3):
    """A Gaussian edge, integrated over square pixels: exact along rows, by 64 Gauss points down columns."""
    rows, columns = shape
    turn = math.radians(slant_deg)
    nodes, weights = np.polynomial.legendre.leggauss(64)
    y = np.arange(rows)[:, None, None] + nodes / 2.0 - rows / 2.0
    x = np.arange(columns + 1)[None, :, None] - columns / 2.0 - 0.5 - place
    along = (x * math.cos(turn) - y * math.sin(turn)) / deviation
    # Integral of the normal distribution function.
    integral = along * (1.0 + erf(along / math.sqrt(2.0))) / 2.0 + np.exp(-(along**2) / 2.0) / math.sqrt(2.0 * math.pi)
    means = np.diff(integral * deviation / math.cos(turn), axis=1) @ (weights / 2.0)
    return low + (high - low) * means


@pytest.mark.parametrize("mtf50", [0.05, 0.1, 0.2, 0.3, 0.4, 0.5])
@pytest.mark.parametrize("slant_deg", [2.0, 5.0, -7.5, 12.0])
def test_the_tool_finds_the_product_of_lens_and_pixels(mtf50, slant_deg):
    deviation = math.sqrt(math.log(2.0 * np.sinc(mtf50)) / 2.0) / (math.pi * mtf50)
    image = blurred_edge(deviation, slant_deg)
    found = edge_response(image)
    assert abs(found.slant_deg - abs(slant_deg)) < 0.02
    # Pixels average along the edge, too, where it is slanted.
    turn = math.radians(slant_deg)
    wanted = (
        gaussian_contrast(found.frequency, mtf50)
        * pixel_contrast(found.frequency * math.cos(turn))
        * pixel_contrast(found.frequency * math.sin(turn))
    )
    below = found.frequency <= 0.5
    assert np.abs(found.contrast - wanted)[below].max() < 0.01
    assert abs(found.mtf50 / mtf50 - 1.0) < 0.01
    for other in (image.T, image[::-1], image[:, ::-1], 0.8 - image):
        assert abs(edge_response(other).mtf50 / found.mtf50 - 1.0) < 0.005


def test_half_the_contrast_of_pixels_alone():
    assert abs(half_contrast(np.ones_like) - 0.6033546) < 1e-6
    assert abs(half_contrast(lambda f: gaussian_contrast(f, 0.27)) - 0.27) < 1e-9


@pytest.mark.parametrize(
    ("image", "words"),
    [
        (np.zeros((10, 40)), "edge in an image of 40 x 10 px: needs one channel of 16 x 16 px or more"),
        (np.full((40, 40), 0.5), "edge whose sides differ by 0 of white: must be 0.02 or more"),
        (np.arange(40) * np.ones((40, 1)) > 20, "edge slanted by 0.00 deg: must be 1 to 40 deg from rows or columns"),
    ],
)
def test_other_images_are_refused(image, words):
    with pytest.raises(InvalidInput) as refused:
        edge_response(image)
    assert str(refused.value) == words


def test_the_command_prints_the_sharpness_of_an_image(tmp_path, capsys):
    exact = blurred_edge(1.2, 5.0, low=0.04, high=0.95)
    image = np.rint(255.0 * encoded(exact))
    Image.fromarray(image.astype(np.uint8)).save(tmp_path / "edge.png")
    assert main(["report", "--mtf", str(tmp_path / "edge.png")]) == 0
    first, *lines = capsys.readouterr().out.splitlines()
    wanted = edge_response(exact)
    assert first.startswith("MTF50 ")
    assert first.endswith("cycles/px, edge slanted by 5.00 deg")
    assert abs(float(first.split()[1]) / wanted.mtf50 - 1.0) < 0.01
    assert len(lines) == 10
    assert main(["report", "--mtf", str(tmp_path / "none.png")]) == 2
    assert "none.png: cannot be read" in capsys.readouterr().err
