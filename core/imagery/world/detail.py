"""Fine texture of the ground: speckle without direction, and stripes along the rows of fields."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from .lattice import Array, Grid, Samples, Window, cell_hash, mix, refine, salt, signed
from .region import BLOCK_ZOOM

_SPECKLE_FIRST = 14
_SPECKLE_KEPT = 20
"""Octaves down to this level are remembered for a block of tiles."""

_STRIPE_COUNT = 8192
_STRIPES_PER_PX = 4
_STRIPES = ((48.0, 0.5), (22.0, 0.55), (9.0, 0.6), (4.2, 0.55), (2.0, 0.5), (0.9, 0.45), (0.4, 0.4))
"""Spacing in metres and strength of the bands of which field stripes are made."""


def speckle(seed: int, samples: Samples, last_level: int) -> Array | None:
    """Evaluate texture of all scales from 2.4 km down to `last_level`, with a standard deviation of 0.1 an octave."""
    if last_level < _SPECKLE_FIRST:
        return None
    windows = [samples.cells(last_level).support()]
    top = max(min(last_level, _SPECKLE_KEPT), _SPECKLE_FIRST)
    while windows[-1].level > top:
        windows.append(windows[-1].parent())
    up = max(samples.zoom - BLOCK_ZOOM, 0)
    c, whole = _coarse_speckle(seed, samples.zoom - up, samples.x >> up, samples.y >> up, top)
    first = windows.pop()
    i, j = first.i0 - whole.i0, first.j0 - whole.j0
    c, coarse = c[j : j + first.rows, i : i + first.columns], first
    for window in reversed(windows):
        c, coarse = refine(c, coarse, window) + _octave(seed, window), window
    return samples.spline(c, coarse)


def _octave(seed: int, window: Window) -> Array:
    i, j = window.indices()
    noise = signed(cell_hash(salt(seed, 5), window.level, i, j))
    noise *= np.float32(0.36)
    return noise


@lru_cache(maxsize=48)
def _coarse_speckle(seed: int, zoom: int, x: int, y: int, level: int) -> tuple[Array, Window]:
    """Coefficients at `level` over a block, which neighbouring tiles share."""
    windows = [Grid(zoom, x, y).cells(level).support().grown(2)]
    while windows[-1].level > _SPECKLE_FIRST:
        windows.append(windows[-1].parent())
    coarse = windows.pop()
    c: Array = _octave(seed, coarse)
    for window in reversed(windows):
        c, coarse = refine(c, coarse, window) + _octave(seed, window), window
    return c, coarse


@lru_cache(maxsize=32)
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
