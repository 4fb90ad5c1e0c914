"""What the optics of a camera do to light on its way to the image."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np

from ..arrays import Flags, Floats, NDArray

#: Wavelength of the light, micrometres: that of the eye's greatest sensitivity, as for photons.
WAVELENGTH_UM = 0.555
#: Cycles per px at which square pixels alone halve the contrast, where sin(πf) = πf/2.
PIXEL_MTF50 = 0.603354606
#: Pixels around an image from which light is spread into it, for spread of any width.
_LEAST_REACH_PX = 32
#: Least weight of what is known around a pixel.
_LEAST_WEIGHT = 1e-3


def cos4_falloff(right: Floats, down: Floats) -> NDArray[np.float32]:
    """Share (h, w) of the light by the fourth power of the cosine of the angle to the optical axis.

    Parameters
    ----------
    right, down : array
        Tangents of the angles between the axis and the pixels' rays, which broadcast to (h, w).
    """
    share = _squared(right) + (np.float32(1.0) + _squared(down))
    share *= share
    return np.divide(np.float32(1.0), share, out=share)


def _squared(values: Floats) -> NDArray[np.float32]:
    # Single precision takes half the time, and is exact to a ten-millionth.
    return np.square(values).astype(np.float32)


def radial_falloff(right: Floats, down: Floats, terms: Sequence[float]) -> NDArray[np.float32]:
    """Share (h, w) of the light by a polynomial 1 + a r² + b r⁴ + c r⁶; 0 where that is less.

    Parameters
    ----------
    right, down : array
        Distances from the principal point as shares of half the image's diagonal, which broadcast to (h, w).
    terms : sequence of float
        The coefficients a, b, c, of which the last ones may be left out.
    """
    squared = _squared(right) + _squared(down)
    share = np.zeros_like(squared)
    for term in reversed(terms):
        share += np.float32(term)
        share *= squared
    share += np.float32(1.0)
    return np.maximum(share, np.float32(0.0), out=share)


def dim(light: NDArray[np.float32], share: NDArray[np.float32]) -> None:
    """Multiply light (h, w, channels), in place, by the share (h, w) of it that arrives."""
    # Channel by channel: broadcasting a last axis of 3 is slower.
    for channel in range(light.shape[2]):
        light[..., channel] *= share


def pixel_contrast(frequency: Floats) -> Floats:
    """Contrast that square pixels leave of cycles per px along their rows or columns."""
    found: Floats = np.abs(np.sinc(frequency))
    return found


def cutoff_frequency(f_number: float, pixel_um: float) -> float:
    """Cycles per px from which on a circular aperture leaves no contrast."""
    return pixel_um / (WAVELENGTH_UM * f_number)


def diffraction_contrast(frequency: Floats, cutoff: float) -> Floats:
    """Contrast that a circular aperture without aberration leaves of cycles per px: the transform of Airy's disc."""
    share = np.minimum(np.abs(frequency) / cutoff, 1.0)
    found: Floats = (np.arccos(share) - share * np.sqrt(1.0 - share * share)) * (2.0 / np.pi)
    return found


def gaussian_contrast(frequency: Floats, mtf50: float) -> Floats:
    """Contrast by a Gaussian lens that, with square pixels, leaves half of the contrast at ``mtf50`` cycles per px."""
    rate = np.log(2.0 * np.sinc(mtf50)) / mtf50**2
    found: Floats = np.exp(-rate * np.square(frequency))
    return found


def half_contrast(contrast: Callable[[Floats], Floats]) -> float:
    """Cycles per px, at most `PIXEL_MTF50`, at which a lens and square pixels leave half of the contrast."""
    low, high = 0.0, PIXEL_MTF50
    for _ in range(40):
        middle = np.array((low + high) / 2.0)
        if contrast(middle) * pixel_contrast(middle) > 0.5:
            low = float(middle)
        else:
            high = float(middle)
    return (low + high) / 2.0


def spread_light(light: NDArray[np.float32], contrast: Callable[[Floats], Floats], shown: Flags | None) -> None:
    """Spread the light of each pixel as a lens does, in place.

    Beyond its edges the image goes on as its mirror image, so that they do not darken.

    Parameters
    ----------
    light : array (h, w, channels)
        Linear light.
    contrast : callable
        Contrast that the lens leaves of cycles per px, the same in all directions.
    shown : array (h, w) of bool, or None
        Pixels that show something; others, such as sky, stay as they are and give no light. None for all.
    """
    height, width, channels = light.shape
    reach = _reach_px(contrast)
    high, wide = (_smooth(size + 2 * reach) for size in (height, width))
    row, column = np.arange(high), np.arange(wide // 2 + 1)
    factors = contrast(np.hypot((np.minimum(row, high - row) / high)[:, np.newaxis], column / wide))
    edges = ((reach, high - height - reach), (reach, wide - width - reach))

    def spread(values: NDArray[np.float32]) -> Floats:
        around = np.pad(values, edges, mode="symmetric")
        found: Floats = np.fft.irfft2(np.fft.rfft2(around) * factors, (high, wide))
        return found[reach : reach + height, reach : reach + width]

    weights = None if shown is None else spread(shown.astype(np.float32))
    for channel in range(channels):
        values = light[..., channel]
        if shown is None or weights is None:
            values[...] = np.maximum(spread(values), 0.0)
        else:
            means = spread(np.where(shown, values, np.float32(0.0))) / np.maximum(weights, _LEAST_WEIGHT)
            values[shown] = np.maximum(means, 0.0)[shown]


def _reach_px(contrast: Callable[[Floats], Floats]) -> int:
    """Pixels to either side over which light is spread: four deviations of a Gaussian with the same half contrast."""
    half = half_contrast(contrast)
    return max(_LEAST_REACH_PX, int(np.ceil(4.0 * np.sqrt(np.log(2.0) / 2.0) / (np.pi * max(half, 1e-3)))))


@lru_cache(maxsize=64)
def _smooth(size: int) -> int:
    """Least even number of at least this size without prime factors above 5, whose transforms are fast."""
    size += size % 2
    rest = size
    for prime in (2, 3, 5):
        while rest % prime == 0:
            rest //= prime
    return size if rest == 1 else _smooth(size + 2)
