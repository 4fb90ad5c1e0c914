"""Blending of colours over samples, one plane a channel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import NDArray
from .lattice import Array


class Canvas:
    """Colours of samples: float32 planes, shape (3, n), in grey levels; or one plane of heights."""

    def __init__(self, colour: Array | Sequence[float | Array], shape: tuple[int, ...]) -> None:
        self.shape = shape
        n = int(np.prod(shape))
        self.planes: NDArray[np.float32] = np.empty((len(colour), n), dtype=np.float32)
        for plane, c in zip(self.planes, colour):
            plane[:] = np.ravel(c)

    def blend(self, cover: Array | None, colour: Array | Sequence[float]) -> None:
        """Blend a colour, for all samples or one each, over the canvas with a coverage in 0..1."""
        if cover is None:
            return
        alpha = cover.ravel()
        at = np.flatnonzero(alpha != 0)  # faster than on numbers
        # Gathering is faster for less than about 0.3 of the samples.
        if at.size < 0.3 * alpha.size:
            if at.size:
                inks = [np.asarray(ink, np.float32).ravel() for ink in colour]
                self.touch(at, (alpha[at], [ink if ink.size == 1 else ink[at] for ink in inks]))
            return
        for channel, c in enumerate(colour):
            ink = np.float32(c) if np.ndim(c) == 0 else np.ravel(c)
            step = ink - self.planes[channel]
            step *= alpha
            self.planes[channel] += step

    def touch(self, at: Array, *layers: tuple[Array, Array | Sequence[float | Array]]) -> None:
        """Blend layers of coverage and colour, in order, over the samples with flat indices `at` only."""
        for channel, plane in enumerate(self.planes):
            few = plane.take(at, mode="clip")
            for alpha, colour in layers:
                c = colour[channel]
                step = (np.float32(c) if np.ndim(c) == 0 else c) - few
                step *= alpha
                few += step
            plane[at] = few

    def stroke(self, distance_m: Array, pixel_m: float, *strokes: tuple[float, float, Sequence[float]]) -> None:
        """Draw strokes (half width in m, opacity, colour), the widest first, along a line at the given distances."""
        d = distance_m.ravel()
        at = np.flatnonzero(d < np.float32(strokes[0][0] + pixel_m))
        if at.size:
            d = d.take(at, mode="clip")
            layers = [
                (line_cover(d, half_width_m, pixel_m) * np.float32(opacity), colour)
                for half_width_m, opacity, colour in strokes
            ]
            self.touch(at, *layers)

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
        """Return the colours rounded to bytes, shape (..., 3); overwrites the canvas."""
        out = np.empty((self.planes.shape[1], 3), dtype=np.uint8)
        # NumPy 1 compares arrays with arrays five times as fast as with numbers.
        black, white = (np.full(self.planes.shape[1], level, dtype=np.float32) for level in (0, 255))
        for channel, plane in enumerate(self.planes):
            np.maximum(plane, black, out=plane)
            np.minimum(plane, white, out=plane)
            np.add(plane, np.float32(0.5), out=plane)
            out[:, channel] = plane.astype(np.uint8)
        return out.reshape(*self.shape, 3)


def clip01(x: Array) -> Array:
    """Clip to 0..1 in place."""
    np.maximum(x, np.float32(0), out=x)
    return np.minimum(x, np.float32(1), out=x)


def ramp(x: Array, width: Array | float) -> Array:
    """Coverage by the side where `x` > 0, blurred over `width`."""
    out: Array = x / np.asarray(width, dtype=np.float32)
    out += np.float32(0.5)
    return clip01(out)


def line_cover(distance_m: Array, half_width_m: float, pixel_m: float) -> Array:
    """Share of a pixel covered by a line, from the distance between the pixel's centre and the line's middle."""
    d = distance_m * np.float32(1.0 / pixel_m)
    outer = clip01(np.float32(half_width_m / pixel_m + 0.5) - d)
    if half_width_m < pixel_m:
        outer -= clip01(np.float32(0.5 - half_width_m / pixel_m) - d)
    return outer
