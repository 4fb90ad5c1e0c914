"""Haze against Koschmieder's formula in decimal arithmetic."""

from __future__ import annotations

from decimal import Decimal

import numpy as np
import pytest
from terrainav.core.camera.air import add_haze, extinction_per_m


def test_visibility_leaves_a_contrast_of_five_percent():
    assert extinction_per_m(10.0) == pytest.approx(float(Decimal(20).ln() / 10_000), rel=1e-14)


@pytest.mark.parametrize("channels", [1, 3])
def test_light_fades_and_air_takes_its_place(channels):
    random = np.random.default_rng(5)
    light, range_m = random.random((40, 50, channels), np.float32), random.random((40, 50)) * 50_000.0
    air = np.array([0.5, 0.55, 0.7])[:channels]
    # exp(-b R) is 0.05 to the power of R / V.
    left = 0.05 ** (range_m / 8_000.0)[..., np.newaxis]
    wanted = light * left + air * (1.0 - left)
    add_haze(light, range_m, extinction_per_m(8.0), air)
    assert light == pytest.approx(wanted, abs=1e-6)


def test_sky_is_air_alone():
    light = np.zeros((1, 2, 3), np.float32)
    add_haze(light, np.array([[np.inf, 0.0]]), extinction_per_m(20.0), np.array([0.5, 0.6, 0.7]))
    assert light[0] == pytest.approx(np.array([[0.5, 0.6, 0.7], [0.0, 0.0, 0.0]]), abs=1e-7)
