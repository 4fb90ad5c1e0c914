"""Times of rows and instants while a shutter is open, and the strips of rows that one instant stands for."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Floats

#: Most instants of an exposure; longer streaks than half as many pixels have wider gaps between them.
MOST_INSTANTS = 65
#: Blur that is left out, px.
LEAST_BLUR_PX = 0.02


def row_times_s(height: int, row_time_us: float) -> Floats:
    """Times (height,) of the exposures of rows, after the time of an image, which is that of its middle."""
    times: Floats = (np.arange(height) + 0.5 - height / 2.0) * (row_time_us * 1e-6)
    return times


def instant_count(blur_px: float) -> int:
    """Number of instants whose mean stands for an exposure that moves the image by a number of pixels.

    Odd, so that one is the middle, and at most half a pixel apart, up to `MOST_INSTANTS`.
    """
    if not blur_px > LEAST_BLUR_PX:
        return 1
    return min(2 * math.ceil(min(blur_px, MOST_INSTANTS)) + 1, MOST_INSTANTS)


def instants_s(exposure_ms: float, count: int) -> Floats:
    """Times (count,) of the instants of an exposure, after its middle.

    Spaced evenly, so that their variance is that of all times of the exposure, a twelfth of its square: their mean is
    exact for light that changes as a polynomial of third order (Chebyshev's quadrature, for three instants).
    """
    if count == 1:
        return np.zeros(1)
    times: Floats = (np.arange(count) - (count - 1) / 2.0) * (exposure_ms * 1e-3 / math.sqrt(count**2 - 1.0))
    return times


def strips(moved_px: Floats, most_px: float) -> list[tuple[int, int]]:
    """Divide rows into strips within each of which no pixel moves by more than a number of pixels, or single rows.

    Parameters
    ----------
    moved_px : array (height,)
        How far the image moves from the time of each row to that of the next.

    Returns
    -------
    list of tuple of int
        First row, and the one after the last.
    """
    found, top, fastest_px = [], 0, 0.0
    for row, way_px in enumerate(moved_px.tolist()):
        fastest_px = max(fastest_px, way_px)
        if row > top and (row + 1 - top) * fastest_px > most_px:
            found.append((top, row))
            top, fastest_px = row, way_px
    return [*found, (top, len(moved_px))]
