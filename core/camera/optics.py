"""What the optics of a camera do to light on its way to the image."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import Floats, NDArray


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
