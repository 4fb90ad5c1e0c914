"""Interpolation of images: nearest, bilinear, bicubic and Lanczos."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import as_strided

from ..arrays import Floats, NDArray, PixelValues
from ..external.compiling import uses_numba

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


def _padding(channels: int, dtype: Any) -> int:
    """Number of channels to add, so that numpy copies pixels in chunks of 4 bytes, several times as fast as of 3."""
    return 1 if dtype == np.uint8 and channels == 3 else 0


def blank_image(height: int, width: int, channels: int, dtype: Any) -> PixelValues:
    """Zeros (height, width, channels), laid out so that numpy's `PackedImage` needs no copy."""
    return np.zeros((height, width, channels + _padding(channels, dtype)), dtype)[..., :channels]


class PackedImage:
    """Image to be sampled at points.

    Parameters
    ----------
    image : array (h, w, c)
        Beyond its edges, its outermost pixels are repeated.
    is_compiled : bool
        Whether to sample with compiled code.
    """

    def __init__(self, image: PixelValues, *, is_compiled: bool) -> None:
        self._is_compiled = is_compiled
        self._height, self._width, self._channels = height, width, channels = image.shape
        padded = channels + (0 if is_compiled else _padding(channels, image.dtype))
        if image.strides != (width * padded * image.itemsize, padded * image.itemsize, image.itemsize):
            plain, image = image, np.empty((height, width, padded), image.dtype)[..., :channels]
            image[...] = plain
        self._pixels = as_strided(image, (height * width, padded), image.strides[1:])

    def sample(self, x_px: Floats, y_px: Floats, kernel: str) -> Weights:
        """Interpolate the image at points.

        Parameters
        ----------
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
        kind: Any = np.float32 if self._pixels.dtype == np.uint8 else np.float64
        values = np.empty((len(x_px), self._channels), kind)
        if kernel == "bilinear" and self._is_compiled:
            from .taps import interpolate

            interpolate(self._pixels.reshape(self._height, self._width, -1), x_px, y_px, np.empty(8, kind), values)
            return values
        # The data of 16,384 samples fits a processor's cache.
        for start in range(0, len(x_px), 1 << 14):
            part = slice(start, start + (1 << 14))
            columns, across = _taps(x_px[part], taps, function, self._width, kind)
            rows, down = _taps(y_px[part], taps, function, self._height, kind)
            total: Weights = np.zeros((self._channels, len(rows[0])), kind)
            for row, share in zip(rows, down):
                line = np.zeros_like(total)
                for column, weight in zip(columns, across):
                    found = self._pixels.take(row * self._width + column, axis=0)[:, : self._channels]
                    pixels = found.T.astype(kind, order="C")
                    pixels *= weight
                    line += pixels
                line *= share
                total += line
            values[part] = total.T
        return values


def sample(image: PixelValues, x_px: Floats, y_px: Floats, kernel: str) -> Weights:
    """Interpolate an image (h, w, c) once: see `PackedImage.sample`."""
    return PackedImage(image, is_compiled=uses_numba()).sample(x_px, y_px, kernel)


def _taps(
    position: Floats, taps: int, function: Callable[[Floats], Floats], size: int, kind: Any
) -> tuple[list[NDArray[np.intp]], list[Weights]]:
    """Indices and weights, (n,) each, of the pixels that a sample is made of along one axis; the weights sum to 1."""
    first = np.floor(position - 0.5 * (taps - 1)).astype(np.intp)
    indices = [first + tap for tap in range(taps)]
    weights = [function(position - 0.5 - index) for index in indices]
    total = sum(weights[1:], weights[0])
    return [np.clip(index, 0, size - 1) for index in indices], [(weight / total).astype(kind) for weight in weights]
