"""Bilinear interpolation of images, compiled: the same as `resampling.PackedImage.sample`, several times as fast.

Needs numba; see `compiling`.
"""

from __future__ import annotations

import math

from ..arrays import Floats, PixelValues
from ..external.compiling import compiled


@compiled
def _shares(position: float, size: int) -> tuple[int, int, float, float]:
    """Indices and weights of the two pixels on either side of a position along an axis."""
    first = math.floor(position - 0.5)
    distance = position - 0.5 - first
    near, far = 1.0 - distance, 1.0 - abs(position - 0.5 - (first + 1))
    total = near + far
    last = size - 1
    return min(max(first, 0), last), min(max(first + 1, 0), last), near / total, far / total


@compiled
def interpolate(image: PixelValues, x_px: Floats, y_px: Floats, scratch: PixelValues, values: PixelValues) -> None:
    """Fill in values (n, c) of an image (h, w, c) at points (n,); ``scratch`` (8,) is of the values' type."""
    height, width, channels = image.shape
    for point in range(len(x_px)):
        # Arithmetic in the type of the values.
        left, right, scratch[0], scratch[1] = _shares(x_px[point], width)
        top, bottom, scratch[2], scratch[3] = _shares(y_px[point], height)
        for channel in range(channels):
            scratch[4], scratch[5] = image[top, left, channel], image[top, right, channel]
            scratch[6], scratch[7] = image[bottom, left, channel], image[bottom, right, channel]
            upper = scratch[4] * scratch[0] + scratch[5] * scratch[1]
            lower = scratch[6] * scratch[0] + scratch[7] * scratch[1]
            values[point, channel] = upper * scratch[2] + lower * scratch[3]
