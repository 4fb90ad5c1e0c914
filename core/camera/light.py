"""Linear light and the values of images that show it, after sRGB (IEC 61966-2-1)."""

from __future__ import annotations

from functools import cache

import numpy as np

from ..arrays import Floats, NDArray, PixelValues


def linear(values: Floats) -> Floats:
    """Linear light (any shape) of sRGB values; both are 0 for black and 1 for white."""
    found: Floats = np.where(values <= 0.04045, values / 12.92, ((np.maximum(values, 0.0) + 0.055) / 1.055) ** 2.4)
    return found


def encoded(light: Floats) -> Floats:
    """SRGB values (any shape) of linear light, the inverse of `linear`; light beyond 0 and 1 is cut off."""
    cut = np.clip(light, 0.0, 1.0)
    found: Floats = np.where(cut <= 0.0031308, cut * 12.92, 1.055 * cut ** (1.0 / 2.4) - 0.055)
    return found


def linear_of_bytes(pixels: PixelValues) -> NDArray[np.float32]:
    """Linear light of sRGB values of 8 bits."""
    found: NDArray[np.float32] = _levels()[pixels]
    return found


def bytes_of_linear(light: NDArray[np.float32]) -> NDArray[np.uint8]:
    """The 8-bit sRGB values nearest to linear light; light beyond 0 and 1 is cut off."""
    # Searching for the borders between values is exact, and needs no power, of which processors differ.
    found: NDArray[np.uint8] = np.searchsorted(_borders(), light.ravel(), side="right").astype(np.uint8)
    return found.reshape(light.shape)


@cache
def _levels() -> NDArray[np.float32]:
    return linear(np.arange(256) / 255.0).astype(np.float32)


@cache
def _borders() -> NDArray[np.float32]:
    return linear((np.arange(255) + 0.5) / 255.0).astype(np.float32)
