"""The sun of a mission: one for all images, as they share the tiles of the imagery."""

from __future__ import annotations

import numpy as np

from ..errors import InvalidInput, Message, OptionName
from ..geodesy.sun import SunDirection, sun_position
from .mission import Mission
from .parts import BY_START, NO_SUN, Flight


def mission_sun(mission: Mission) -> SunDirection | None:
    """Sun over the middle of the area, as refraction shows it; None for the light of maps.

    Raises
    ------
    InvalidInput
        The sun stands where it does at the start, which is not stated, or at night.
    """
    text = mission.sunlight.sun
    if text == NO_SUN:
        return None
    west, south, east, north = mission.area.bounds.edges_deg
    lat, lon = (south + north) / 2.0, (west + east) / 2.0
    if text != BY_START:
        height, azimuth = map(float, text.split())
        return SunDirection(height, azimuth, lat, lon)
    times = mission.area.times_s
    if times:
        start = f"{np.datetime64(round(times[0] * 1e6), 'us')}Z"
    elif mission.flight.start != Flight.start:
        start = mission.flight.start
    else:
        # The default is a date for clocks.
        raise InvalidInput(
            "sun {0}: needs the start of the flight",
            BY_START,
            field="sun",
            remedy=Message("give it{0}", OptionName("start").in_brackets),
        )
    heights, azimuths = sun_position(start, np.zeros(1), lat, lon, refracted=True)
    height, azimuth = float(heights[0]), float(azimuths[0])
    if height <= 0.0:
        raise InvalidInput(
            "sun {0}: at {1} it is {2:.1f} degrees below the horizon",
            BY_START,
            start,
            -height,
            field="sun",
            remedy=Message("start by day{0}, or give its height and azimuth", OptionName("start").in_brackets),
        )
    return SunDirection(height, azimuth, lat, lon)
