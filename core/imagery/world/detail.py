"""Fine texture of the ground: speckle without direction, and stripes along the rows of fields."""

from __future__ import annotations

import numpy as np

from .lattice import Array, Window, cell_hash, mix, refine, salt, signed
from .region import neighbourhood
from .samples import Grid, Samples
from .shared import shared

_SPECKLE_FIRST = 14

_STRIPE_COUNT = 8192
_STRIPES_PER_PX = 4
_STRIPES = ((48.0, 0.5), (22.0, 0.55), (9.0, 0.6), (4.2, 0.55), (2.0, 0.5), (0.9, 0.45), (0.4, 0.4))
"""Spacing in metres and strength of the bands of which field stripes are made."""


def speckle(seed: int, samples: Samples, last_level: int) -> Array | None:
    """Evaluate texture of all scales from 2.4 km down to `last_level`, with a standard deviation of 0.1 an octave."""
    if last_level < _SPECKLE_FIRST:
        return None
    return samples.spline(*_speckle(seed, last_level, *neighbourhood(samples)))


def _octave(seed: int, window: Window) -> Array:
    i, j = window.indices()
    noise = signed(cell_hash(salt(seed, 5), window.level, i, j))
    noise *= np.float32(0.36)
    return noise


@shared(32)
def _speckle(seed: int, level: int, zoom: int, x: int, y: int) -> tuple[Array, Window]:
    """Coefficients at `level` over a tile of any zoom."""
    windows = [Grid(zoom, x, y).cells(level).support()]
    while windows[-1].level > _SPECKLE_FIRST:
        windows.append(windows[-1].parent())
    coarse = windows.pop()
    c: Array = _octave(seed, coarse)
    for window in reversed(windows):
        c, coarse = refine(c, coarse, window), window
        c += _octave(seed, window)
    return c, coarse


@shared(32)
def _stripe_table(seed: int, pixel_m: float) -> Array:
    """One period of the stripes at a pixel size, sampled `_STRIPES_PER_PX` times a pixel.

    Bands a pixel cannot show are left out.
    """
    at = np.arange(_STRIPE_COUNT) / _STRIPES_PER_PX
    out = np.zeros(_STRIPE_COUNT, dtype=np.float32)
    period_px = _STRIPE_COUNT // _STRIPES_PER_PX
    for band, (spacing_m, strength) in enumerate(_STRIPES):
        wave_px = spacing_m / pixel_m
        weight = min(max((wave_px - 2.0) / 2.0, 0.0), 1.0) * strength
        if weight == 0.0:
            continue
        count = max(round(period_px / wave_px), 4)
        cell = at * (count / period_px)
        k = np.floor(cell).astype(np.int64)
        f = (cell - k).astype(np.float32)
        f = f * f * (np.float32(3) - np.float32(2) * f)
        value = signed(mix((np.arange(count + 1) % count).astype(np.uint32) + np.uint32(salt(seed, 6, band))))
        out += np.float32(weight) * (value[k] * (np.float32(1) - f) + value[k + 1] * f)
    out.flags.writeable = False
    return out


def stripes(seed: int, across_m: Array, pixel_m: float) -> Array:
    """Evaluate stripes by the distance across them, in metres."""
    place = across_m * np.float32(_STRIPES_PER_PX / pixel_m)
    index = place.astype(np.int32)
    index &= _STRIPE_COUNT - 1
    out: Array = _stripe_table(seed, pixel_m).take(index.astype(np.intp), mode="clip")
    return out
