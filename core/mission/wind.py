"""Wind: what a mission is flown in."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput

Floats = NDArray[np.float64]
#: Airspeeds that the model is of: hovering drift to the speed of sound.
AIRSPEEDS_M_PER_S = (0.1, 340.0)


def check_airspeed(airspeed_m_per_s: float) -> None:
    """Refuse a speed through the air that is not of `AIRSPEEDS_M_PER_S`."""
    slowest, fastest = AIRSPEEDS_M_PER_S
    if not slowest <= airspeed_m_per_s <= fastest:
        raise InvalidInput(
            "airspeed {0} m/s: must be {1} to {2}",
            airspeed_m_per_s,
            slowest,
            fastest,
            field="airspeed_m_per_s",
        )


@dataclass(frozen=True)
class Wind:
    """Wind at flight height.

    Parameters
    ----------
    speed_m_per_s : float
        Mean wind, >= 0.
    from_deg : float
        Direction it blows from, clockwise from north.
    turbulence : float
        Intensity: sigma of the horizontal gusts over the mean wind, >= 0 (some 0.1 over water, 0.2 over fields).
    seed : int
        Of the gusts, >= 0: the same seed gives the same flight.
    """

    speed_m_per_s: float = 0.0
    from_deg: float = 0.0
    turbulence: float = 0.0
    seed: int = 2024

    def __post_init__(self) -> None:
        if not (math.isfinite(self.speed_m_per_s) and self.speed_m_per_s >= 0.0):
            raise InvalidInput("wind speed {0} m/s: must be 0 or more", self.speed_m_per_s)
        if not math.isfinite(self.from_deg):
            raise InvalidInput("wind from {0} deg: must be a number", self.from_deg)
        if not (math.isfinite(self.turbulence) and self.turbulence >= 0.0):
            raise InvalidInput(
                "turbulence intensity {0}: must be 0 or more (sigma / mean wind)", self.turbulence
            )
        if not (self.seed >= 0 and self.seed % 1 == 0):
            raise InvalidInput("seed {0!r} of the wind: must be a whole number, 0 or more", self.seed)

    def flown_at(self, airspeed_m_per_s: float) -> Wind:
        """Return this wind, where an aircraft of that airspeed can fly in it.

        Raises
        ------
        InvalidInput
            A mean wind or a sigma of the gusts that is not below the airspeed: the one cannot be flown against, and
            the other is not frozen while the aircraft flies through; an airspeed that `check_airspeed` refuses.
        """
        check_airspeed(airspeed_m_per_s)
        if self.speed_m_per_s >= airspeed_m_per_s:
            raise InvalidInput(
                "wind speed {0} m/s: must be below the airspeed, {1} m/s, to fly against it",
                self.speed_m_per_s,
                airspeed_m_per_s,
            )
        if self.sigma_m_per_s >= airspeed_m_per_s:
            raise InvalidInput(
                "turbulence intensity {0}: gusts of {1:g} m/s must stay below the airspeed, {2} m/s",
                self.turbulence,
                self.sigma_m_per_s,
                airspeed_m_per_s,
            )
        return self

    @property
    def sigma_m_per_s(self) -> float:
        """Sigma of the horizontal gusts in metres a second."""
        return self.turbulence * self.speed_m_per_s

    def crab_deg(self, heading_deg: Floats | float, airspeed_m_per_s: float) -> Floats:
        """Angle into the wind, clockwise positive, by which flight through the air leads the track over ground.

        Parameters
        ----------
        heading_deg : array (...) or float
            Direction of the track over ground, clockwise from north.
        airspeed_m_per_s : float
            Above the mean wind.
        """
        against = self._against_rad(heading_deg)
        crab: Floats = np.degrees(np.arcsin(self.speed_m_per_s / airspeed_m_per_s * np.sin(against)))
        return crab

    def ground_speed_m_per_s(self, heading_deg: Floats | float, airspeed_m_per_s: float) -> Floats:
        """Speed over ground along a track, in metres a second: above 0 where the airspeed is above the mean wind."""
        against = self._against_rad(heading_deg)
        forward = np.sqrt(airspeed_m_per_s**2 - (self.speed_m_per_s * np.sin(against)) ** 2)
        speed: Floats = forward - self.speed_m_per_s * np.cos(against)
        return speed

    def _against_rad(self, heading_deg: Floats | float) -> Floats:
        """Angle from a track to where the wind comes from; a direction in a mission file may be any number."""
        against: Floats = np.radians(float(self.from_deg) - np.asarray(heading_deg, np.float64))
        return against
