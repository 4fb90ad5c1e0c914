"""Linear light, tone, exposure and white balance, against the formulas of their standards and colour-science."""

from __future__ import annotations

import json
import math
from decimal import Decimal

import numpy as np
import pytest
from terrainav.core.camera.light import (
    AVERAGE,
    FILMIC,
    HIGHLIGHTS,
    LINEAR,
    SRGB,
    bytes_of_linear,
    chromaticity,
    encoded,
    linear,
    linear_of_bytes,
    metered_gain,
    mixed,
    saturation_share,
    white_balance,
    white_exposure_s,
)

from tests.support.peers import told_by_peers


def exact(value: int) -> Decimal:
    share = Decimal(value) / 255
    if share <= Decimal("0.04045"):
        return share / Decimal("12.92")
    return ((share + Decimal("0.055")) / Decimal("1.055")) ** Decimal("2.4")


@pytest.mark.parametrize("value", [0, 1, 10, 11, 118, 188, 254, 255])
def test_linear_light_is_that_of_the_standard(value):
    assert linear(np.array(value / 255.0)) == pytest.approx(float(exact(value)), rel=1e-14)


def test_linear_light_is_encoded_as_it_was():
    values = np.linspace(0.0, 1.0, 10_001)
    assert encoded(linear(values)) == pytest.approx(values, abs=1e-7)


def test_every_byte_returns():
    values = np.arange(256, dtype=np.uint8).reshape(2, 128)
    assert (bytes_of_linear(linear_of_bytes(values)) == values).all()


# --- tone curves


def narkowicz(x):
    return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)


#: Values from 0 to 1 for linear light from 0 to 1.
CURVES = {SRGB: encoded, LINEAR: lambda x: x, FILMIC: lambda x: encoded(narkowicz(x) / narkowicz(1.0))}


@pytest.mark.parametrize("tone", CURVES)
def test_the_nearest_byte_of_a_tone_curve_is_taken(tone):
    # More values than are encoded together, and not all of them in whole batches.
    light = np.linspace(-0.1, 1.1, 100_003).astype(np.float32)
    wanted = CURVES[tone](np.clip(light.astype(np.float64), 0.0, 1.0)) * 255.0
    assert np.abs(bytes_of_linear(light, tone) - wanted).max() < 0.5 + 1e-4


@pytest.mark.parametrize("tone", CURVES)
def test_values_beside_the_border_of_two_bytes_are_told_apart(tone):
    low = np.float32(0.0)
    for value in range(255):
        # The least light that gives the next byte, by halving.
        high = np.float32(1.0)
        while np.nextafter(low, np.float32(1.0)) < high:
            middle = np.float32((low + high) / np.float32(2.0))
            low, high = (middle, high) if bytes_of_linear(middle.reshape(1), tone)[0] <= value else (low, middle)
        assert CURVES[tone](np.float64(high)) * 255.0 == pytest.approx(value + 0.5, abs=1e-3)


def test_pixels_keep_their_places():
    values = np.random.default_rng(1).integers(0, 256, (97, 301, 3), np.uint8)
    light = linear_of_bytes(values)
    assert (bytes_of_linear(light) == values).all()
    assert (bytes_of_linear(light[:, ::2].transpose(1, 0, 2)) == values[:, ::2].transpose(1, 0, 2)).all()
    assert bytes_of_linear(light[:0]).shape == (0, 301, 3)


def test_half_the_light_is_188():
    assert bytes_of_linear(np.float32([0.5]))[0] == 188


# --- exposure


def test_sunny_16():
    # In sunlight, f/16 and 1/ISO s: a meter of K = 12.5 cd s/m² (ISO 2720) reads its mean luminance, K N² / (t S).
    metered_lx = math.pi * 12.5 * 16.0**2 / (1.0 / 100.0 * 100.0)
    # A white diffuser is then four fifths of saturation, at any speed, in light of 80,000 lx, and a landscape of 12.6 %
    # reflectance is what the meter reads.
    for iso in (100.0, 400.0):
        assert saturation_share(80_000.0, 1.0 / iso, 16.0, iso) == pytest.approx(0.829, abs=0.001)
    assert metered_lx / 80_000.0 == pytest.approx(0.126, abs=0.001)


def test_exposure_saturates_at_the_exposure_of_the_standard():
    # H = 0.65 L t / N² lux seconds for L = E / pi, and S = 78 / H (ISO 12232).
    exposure_s = white_exposure_s(50_000.0, 4.0, 200.0)
    assert 0.65 * 50_000.0 / math.pi * exposure_s / 4.0**2 == pytest.approx(78.0 / 200.0)


def test_the_average_becomes_middle_grey():
    light = np.exp(np.random.default_rng(2).normal(-3.0, 0.5, (480, 640, 3))).astype(np.float32)
    luminance = light.astype(np.float64) @ [0.2126, 0.7152, 0.0722]
    gain = metered_gain(light, AVERAGE)
    assert np.exp(np.mean(np.log(luminance * gain))) == pytest.approx(0.18, rel=0.01)


def test_one_percent_of_the_highlights_saturates():
    light = np.random.default_rng(3).random((480, 640, 3), np.float32) * np.float32(0.4)
    gain = metered_gain(light, HIGHLIGHTS)
    assert np.mean((light * gain >= 1.0).any(axis=2)) == pytest.approx(0.01, abs=0.003)


@pytest.mark.parametrize("metering", [AVERAGE, HIGHLIGHTS])
def test_hidden_pixels_and_darkness_are_not_metered(metering):
    light = np.full((60, 80, 1), 0.2, np.float32)
    light[:30] = 0.0
    seen = np.repeat(np.arange(60) >= 30, 80).reshape(60, 80)
    assert metered_gain(light, metering, seen) == pytest.approx({AVERAGE: 0.9, HIGHLIGHTS: 5.0}[metering], rel=1e-6)
    assert metered_gain(light, metering, ~seen) == 1.0


# --- white balance

#: CIE 1931 x and y of daylight (CIE 15:2004, table T.3 of D illuminants), to four digits.
ILLUMINANTS = {5003.0: (0.3457, 0.3586), 5503.0: (0.3325, 0.3476), 6504.0: (0.3127, 0.3291), 7504.0: (0.2990, 0.3150)}


@pytest.mark.parametrize("temperature_k", ILLUMINANTS)
def test_daylight_has_the_chromaticity_of_the_illuminants(temperature_k):
    assert chromaticity(temperature_k) == pytest.approx(ILLUMINANTS[temperature_k], abs=1e-4)


def test_tungsten_has_the_chromaticity_of_illuminant_a():
    # CIE 15:2018 defines it at 2,855.5 K by the present c2 of Planck's law.
    assert chromaticity(2855.5) == pytest.approx((0.44758, 0.40745), abs=4e-4)


def test_daylight_of_the_scene_changes_nothing():
    assert white_balance(6504.0) == pytest.approx(np.eye(3), abs=1e-3)


@pytest.mark.parametrize("temperature_k", [2000.0, 2856.0, 3999.0, 4000.0, 5000.0, 9300.0, 25_000.0])
def test_light_of_the_setting_is_shown_white(temperature_k):
    x, y = chromaticity(temperature_k)
    to_rgb = np.linalg.inv(
        # Of IEC 61966-2-1, to four digits.
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    )
    shown = white_balance(temperature_k) @ to_rgb @ [x / y, 1.0, (1.0 - x - y) / y]
    assert shown == pytest.approx(np.ones(3), abs=1e-3)


def test_a_warm_setting_makes_daylight_blue():
    red, _, blue = white_balance(4000.0) @ np.ones(3)
    assert red < 1.0 < blue
    red, _, blue = white_balance(9000.0) @ np.ones(3)
    assert red > 1.0 > blue


def test_channels_are_mixed_as_by_a_product_of_matrices():
    light = np.random.default_rng(4).random((20, 30, 3), np.float32)
    matrix = white_balance(3200.0)
    assert mixed(light, matrix) == pytest.approx(np.maximum(light @ matrix.T, 0.0), abs=1e-6)
    assert mixed(np.float32([[[1.0, 0.0, 0.0]]]), np.diag([-1.0, 1.0, 1.0]))[0, 0, 0] == 0.0


#: White points and matrices in linear sRGB by temperature: Planck's law summed with the CIE's colour matching
#: functions, or the CIE's daylight, and the adaptation of Bradford.
PEER_CODE = """
import json, sys, warnings
warnings.simplefilter("ignore")
import colour, numpy as np

cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
srgb = colour.RGB_COLOURSPACES["sRGB"]
to_xyz = colour.normalised_primary_matrix(srgb.primaries, srgb.whitepoint)
found = {}
for text in sys.argv[1:]:
    t = float(text)
    if t < 4000.0:
        xy = colour.XYZ_to_xy(colour.sd_to_XYZ(colour.sd_blackbody(t, cmfs.shape), cmfs))
    else:
        xy = colour.temperature.CCT_to_xy_CIE_D(t)
    whites = colour.xy_to_XYZ(xy), colour.xy_to_XYZ(srgb.whitepoint)
    matrix = colour.adaptation.matrix_chromatic_adaptation_VonKries(*whites, transform="Bradford")
    found[text] = xy.tolist(), (np.linalg.inv(to_xyz) @ matrix @ to_xyz).tolist()
print(json.dumps(found))
"""


def test_white_balance_is_that_of_colour_science():
    temperatures = ["2000", "2500", "2856", "3200", "3999", "4000", "4500", "6504", "7500", "12000", "25000"]
    for text, (xy, matrix) in json.loads(told_by_peers("-c", PEER_CODE, *temperatures)).items():
        # Krystek's formula for Planck's law is an approximation; those of daylight are the CIE's. At 2,000 K, z is
        # 0.06, of which its error is 0.7 %.
        planckian = float(text) < 4000.0
        assert chromaticity(float(text)) == pytest.approx(xy, abs=4e-4 if planckian else 1e-12)
        difference = np.abs(white_balance(float(text)) - matrix).max() / np.abs(matrix).max()
        assert difference < (1e-2 if planckian else 1e-9)
