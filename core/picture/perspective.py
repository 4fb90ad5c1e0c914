"""Perspective transforms of images, compiled: to the last bit as Pillow's `transform` and `reduce`, and faster.

Needs numba; see `compiling`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..arrays import Floats, Numbers, PixelValues
from ..external.compiling import compiled

#: Type of offsets: for signed ones, numba also looks whether they count from the end.
_Offset = np.uint64


@compiled
def _draw_line(
    image: PixelValues,
    size: tuple[int, int],
    channels: int,
    perspective: Floats,
    y_px: float,
    is_nearest: bool,
    x: Floats,
    y: Floats,
    lines: PixelValues,
    line: int,
) -> None:
    """Sample a line of a patch at the centres of its pixels; 0 outside the image."""
    high, wide = size
    a, b, c, d, e, f, g, h = perspective
    # Apart from the rest, so that several are computed at once.
    for column in range(len(x)):
        x_px = column + 0.5
        divisor = g * x_px + h * y_px + 1.0
        x[column], y[column] = (a * x_px + b * y_px + c) / divisor, (d * x_px + e * y_px + f) / divisor
    kind: Any = lines.dtype.type
    pixel, row, to = _Offset(channels), _Offset(wide) * _Offset(channels), _Offset(0)
    for column in range(len(x)):
        is_inside = 0.0 <= x[column] < wide and 0.0 <= y[column] < high
        if is_nearest or not is_inside:
            at = _Offset(int(y[column])) * row + _Offset(int(x[column])) * pixel if is_inside else _Offset(0)
            for _ in range(channels):
                lines[line, to] = image[at] if is_inside else 0
                at, to = at + _Offset(1), to + _Offset(1)
            continue
        across, down = x[column] - 0.5, y[column] - 0.5
        left, top = math.floor(across), math.floor(down)
        across, down = across - left, down - top
        at = _Offset(max(top, 0)) * row + _Offset(max(left, 0)) * pixel
        right = pixel if 0 <= left < wide - 1 else _Offset(0)
        below = at + row if 0 <= top < high - 1 else at
        for _ in range(channels):
            one, other = kind(image[at]), kind(image[at + right])
            upper = one + (other - one) * across
            one, other = kind(image[below]), kind(image[below + right])
            lower = one + (other - one) * across
            # Integers are cut off.
            lines[line, to] = upper + (lower - upper) * down
            at, below, to = at + _Offset(1), below + _Offset(1), to + _Offset(1)


@compiled
def _add_lines(lines: PixelValues, count: int, wide: int, channels: int, sums: Floats) -> None:
    """Add one or two lines of samples to the sums of pixels: up to four as they are, then to a double."""
    if wide == 1:
        for at in range(len(sums)):
            sums[at] += lines[0, at] + lines[1, at] if count > 1 else lines[0, at]
        return
    for at in range(len(sums)):
        first = at // channels * wide * channels + at % channels
        for one in range(first, first + wide * channels, 2 * channels):
            part = lines[0, one] + lines[0, one + channels]
            sums[at] += part + lines[1, one] + lines[1, one + channels] if count > 1 else part


@compiled
def warp(
    image: PixelValues,
    size: tuple[int, int],
    perspectives: Floats,
    box: Numbers,
    samples: tuple[int, int],
    is_nearest: bool,
    scratch: Floats,
    lines: PixelValues,
    picture: PixelValues,
) -> None:
    """Fill boxes (k, 4) of a picture by perspective transforms (k, 8), each pixel with the mean of its samples.

    Parameters
    ----------
    image : array (height * width * channels,)
    size : (height, width) of the image
    samples : (x, y) of a pixel
        Powers of 2.
    scratch : array (3, samples of the longest line * channels)
    lines : array (2, samples of the longest line * channels) of int32 for images of uint8, else of float32
        Scratch.
    picture : array (h, w, channels) of uint8, or of float32 for images of other types
    """
    wide, high = samples
    channels = picture.shape[2]
    # Means of integers are rounded.
    half = 0.5 if picture.itemsize == 1 else 0.0
    for patch in range(len(box)):
        left, top, right, bottom = box[patch]
        width = (right - left) * wide
        x, y, sums = scratch[0, :width], scratch[1, :width], scratch[2, : (right - left) * channels]
        for row in range(top, bottom):
            sums[:] = 0.0
            for first in range(0, high, 2):
                count = min(high - first, 2)
                for line in range(count):
                    y_px = (row - top) * high + first + line + 0.5
                    _draw_line(image, size, channels, perspectives[patch], y_px, is_nearest, x, y, lines, line)
                _add_lines(lines, count, wide, channels, sums)
            at = _Offset(0)
            for column in range(left, right):
                for channel in range(channels):
                    picture[row, column, channel] = half + sums[at] * (1.0 / (wide * high))
                    at += _Offset(1)
