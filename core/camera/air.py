"""Haze after Koschmieder: with distance the light of things fades, and that of the air takes its place."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Floats, NDArray

#: Contrast that black things have left at the range that is called visibility: the meteorological optical range (WMO).
THRESHOLD = 0.05


def extinction_per_m(visibility_km: float) -> float:
    """Extinction of air whose visibility, as a meteorological optical range, is given."""
    return -math.log(THRESHOLD) / (1000.0 * visibility_km)


def add_haze(light: NDArray[np.float32], range_m: Floats, extinction: float, airlight: Floats) -> None:
    """Put air between a camera and what its pixels show.

    Light L becomes L exp(-b R) + A (1 - exp(-b R)) at the range R in air of the extinction b.

    Parameters
    ----------
    light : array (h, w, channels)
        Linear light, changed in place.
    range_m : array (h, w)
        Distance of what each pixel shows, in metres; infinite for sky, which shows the airlight.
    extinction : float
        Per metre.
    airlight : array (channels,)
        Linear light A of air without end.
    """
    share = np.multiply(range_m, -extinction, dtype=np.float32, casting="same_kind")
    np.exp(share, out=share)
    # Channel by channel: broadcasting a last axis of 3 is several times as slow.
    for channel, air in enumerate(airlight.astype(np.float32)):
        values = light[..., channel]
        values -= air
        values *= share
        values += air
