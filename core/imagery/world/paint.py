"""Blending of colours over samples, one plane a channel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .lattice import Array

SPARSE = 0.3
"""Below this share of samples it is quicker to gather those concerned."""


class Canvas:
    """Colours of some samples: float32 planes, shape (3, n), in grey levels."""

    def __init__(self, colour: Array | Sequence[float], shape: tuple[int, ...]) -> None:
        self.shape = shape
        n = int(np.prod(shape))
        self.planes: NDArray[np.float32] = np.empty((3, n), dtype=np.float32)
        for plane, c in zip(self.planes, colour):
            plane[:] = np.ravel(c)

    def blend(self, cover: Array | None, colour: Array | Sequence[float]) -> None:
        """Lay a colour, one or one a sample, over the canvas with some coverage, 0..1."""
        if cover is None:
            return
        alpha = cover.ravel()
        at = np.flatnonzero(alpha)
        if at.size < SPARSE * alpha.size:
            if at.size:
                inks = [np.asarray(ink, np.float32).ravel() for ink in colour]
                self.touch(at, alpha[at], np.stack([ink if ink.size == 1 else ink[at] for ink in inks]))
            return
        for channel, c in enumerate(colour):
            ink = np.float32(c) if np.ndim(c) == 0 else np.ravel(c)
            step = ink - self.planes[channel]
            step *= alpha
            self.planes[channel] += step

    def touch(self, at: Array, alpha: Array, colour: Array | Sequence[float]) -> None:
        """Lay a colour over the samples with flat indices `at` only."""
        for plane, c in zip(self.planes, colour):
            old = plane[at]
            step = (np.float32(c) if np.ndim(c) == 0 else c) - old
            step *= alpha
            step += old
            plane[at] = step

    def lighten(self, factor: Array) -> None:
        """Multiply all channels."""
        self.planes *= factor.ravel()

    def pixels(self) -> Array:
        """Return the colours, shape (..., 3), clipped to 0..255."""
        out = np.empty((self.planes.shape[1], 3), dtype=np.float32)
        for channel, plane in enumerate(self.planes):
            np.clip(plane, 0.0, 255.0, out=out[:, channel])
        return out.reshape(*self.shape, 3)

    def rounded(self) -> NDArray[np.uint8]:
        """Return the colours rounded to bytes, shape (..., 3)."""
        out = np.empty((self.planes.shape[1], 3), dtype=np.uint8)
        for channel, plane in enumerate(self.planes):
            value = np.clip(plane, 0.0, 255.0)
            value += np.float32(0.5)
            out[:, channel] = value.astype(np.uint8)
        return out.reshape(*self.shape, 3)


def line_cover(distance_m: Array, half_width_m: float, pixel_m: float) -> Array:
    """Share of a pixel covered by a line, by the distance of the pixel's centre to the line's middle."""
    scale = np.float32(1.0 / pixel_m)
    d = distance_m * scale
    outer = np.float32(half_width_m / pixel_m + 0.5) - d
    np.clip(outer, 0.0, 1.0, out=outer)
    if half_width_m < pixel_m:
        np.subtract(np.float32(0.5 - half_width_m / pixel_m), d, out=d)
        np.clip(d, 0.0, 1.0, out=d)
        outer -= d
    return outer
