"""Sines and cosines of angles in degrees, which are exact where angles in radians are not."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_QUARTER_DEG = 90.0


def sin_cos(angle_deg: Floats | float) -> tuple[Floats, Floats]:
    """Sine and cosine of angles (any shape), each with small relative error, also where it is near 0.

    The nearest whole quarter turn is taken off in degrees, where that is exact: in radians the cosine of 89.9999
    degrees is off by a part in 10¹⁰, which is how far π/2 is from a float64.
    """
    angle = np.asarray(angle_deg, np.float64)
    quarters = np.round(angle / _QUARTER_DEG)
    rest = np.radians(angle - _QUARTER_DEG * quarters)
    sine, cosine = np.sin(rest), np.cos(rest)
    if not np.any(quarters):
        return sine, cosine
    turn = np.mod(quarters, 4.0)
    swapped, opposite = np.mod(turn, 2.0) == 1.0, turn >= 2.0
    sine, cosine = np.where(swapped, cosine, sine), np.where(swapped, sine, cosine)
    return np.where(opposite, -sine, sine), np.where((turn == 1.0) | (turn == 2.0), -cosine, cosine)
