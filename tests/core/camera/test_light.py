"""Linear light against the formulas of IEC 61966-2-1 in decimal arithmetic."""

from __future__ import annotations

from decimal import Decimal

import numpy as np
import pytest
from terrainav.core.camera.light import bytes_of_linear, encoded, linear, linear_of_bytes


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


def test_the_nearest_byte_is_taken():
    light = np.linspace(-0.1, 1.1, 5_001).astype(np.float32)
    nearest = np.rint(encoded(light.astype(np.float64)) * 255.0)
    away = np.abs(bytes_of_linear(light).astype(float) - encoded(light.astype(np.float64)) * 255.0)
    assert (np.abs(bytes_of_linear(light) - nearest) <= 1).all()
    assert away.max() < 0.5 + 1e-4


def test_half_the_light_is_188():
    assert bytes_of_linear(np.float32([0.5]))[0] == 188
