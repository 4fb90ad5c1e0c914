"""Random numbers that are the same in every version of numpy, from a generator's raw words."""

from __future__ import annotations

import numpy as np

from ...arrays import Floats


def normal(bits: np.random.PCG64, count: int, size: int) -> Floats:
    """Independent standard normal deviates (count, size), by Box and Muller's method.

    Made from the generator's raw words, which are the same in every version of numpy; its normal deviates may change.
    Every row takes the same number of words, so that a flight does not depend on how it is divided.
    """
    pairs = (size + 1) // 2
    even = uniform(bits, 2 * count * pairs).reshape(count, 2, pairs)
    radius = np.sqrt(-2.0 * np.log(1.0 - even[:, 0]))  # logarithms of 2^-53 to 1, exactly
    angle = (2.0 * np.pi) * even[:, 1]
    normal: Floats = np.concatenate([radius * np.cos(angle), radius * np.sin(angle)], axis=1)[:, :size]
    return normal


def uniform(bits: np.random.PCG64, count: int) -> Floats:
    """Uniform numbers (count,) in [0, 1), of 53 bits of a raw word each."""
    words = np.asarray(bits.random_raw(count), np.uint64)
    numbers: Floats = (words >> np.uint64(11)) * 2.0**-53
    return numbers
