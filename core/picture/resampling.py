"""Interpolation of images: nearest, bilinear, bicubic and Lanczos."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats, PixelValues

#: Arrays of float32, which is enough for 8-bit images, or of float64.
Weights = NDArray[Any]

_LANCZOS_LOBES = 3


def _box(distance: Floats) -> Floats:
    return np.asarray((distance >= -0.5) & (distance < 0.5), np.float64)


def _triangle(distance: Floats) -> Floats:
    return np.maximum(1.0 - np.abs(distance), 0.0)


def _cubic(distance: Floats) -> Floats:
    # Keys' cubic with Pillow's slope.
    x, a = np.abs(distance), -0.5
    near = ((a + 2.0) * x - (a + 3.0)) * x * x + 1.0
    far = (((x - 5.0) * x + 8.0) * x - 4.0) * a
    return np.where(x < 1.0, near, np.where(x < 2.0, far, 0.0))


def _lanczos(distance: Floats) -> Floats:
    inside = np.abs(distance) < _LANCZOS_LOBES
    return np.where(inside, np.sinc(distance) * np.sinc(distance / _LANCZOS_LOBES), 0.0)


#: Each kernel and its radius in pixels.
KERNELS: dict[str, tuple[Callable[[Floats], Floats], float]] = {
    "nearest": (_box, 0.5),
    "bilinear": (_triangle, 1.0),
    "bicubic": (_cubic, 2.0),
    "lanczos": (_lanczos, float(_LANCZOS_LOBES)),
}


def sample(image: PixelValues, x_px: Floats, y_px: Floats, kernel: str) -> Weights:
    """Interpolate an image at points.

    Parameters
    ----------
    image : array (h, w, c)
        Beyond its edges, its outermost pixels are repeated.
    x_px, y_px : array (n,)
        Positions from the outer corner of the upper left pixel, whose centre is at 0.5, 0.5.
    kernel : str
        nearest, bilinear, bicubic or lanczos (three lobes).

    Returns
    -------
    array (n, c) of float32 for images of uint8, else of float64
        Not rounded; bicubic and Lanczos may overshoot the image's values.
    """
    function, reach = KERNELS[kernel]
    taps = math.ceil(2.0 * reach)
    kind: Any = np.float32 if image.dtype == np.uint8 else np.float64
    values = np.empty((len(x_px), image.shape[2]), kind)
    # 65,536 samples at a time, to bound memory.
    for start in range(0, len(x_px), 1 << 16):
        part = slice(start, start + (1 << 16))
        columns, across = _taps(x_px[part], taps, function, image.shape[1], kind)
        rows, down = _taps(y_px[part], taps, function, image.shape[0], kind)
        total: Weights = np.zeros((len(rows), image.shape[2]), kind)
        for j in range(taps):
            line = np.zeros_like(total)
            for i in range(taps):
                line += across[:, i, np.newaxis] * image[rows[:, j], columns[:, i]]
            total += down[:, j, np.newaxis] * line
        values[part] = total
    return values


def _taps(
    position: Floats, taps: int, function: Callable[[Floats], Floats], size: int, kind: Any
) -> tuple[NDArray[np.intp], Weights]:
    """Indices and weights (n, taps) of the pixels along one axis; the weights sum to 1."""
    first = np.floor(position - 0.5 * (taps - 1)).astype(np.intp)
    index = first[:, np.newaxis] + np.arange(taps)
    weights = function(position[:, np.newaxis] - 0.5 - index)
    weights /= weights.sum(axis=1, keepdims=True)
    return np.clip(index, 0, size - 1), weights.astype(kind)
