"""Wind and gusts of a mission."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...errors import InvalidInput
from ...fields import CheckedFields, declared, field_named
from ..parts import Flight, Imagery

if TYPE_CHECKING:
    from ...arrays import Floats


@dataclass(frozen=True)
class Wind(CheckedFields):
    """Wind at flight height; the seed makes flights reproducible."""

    speed_m_per_s: float = declared(
        0.0,
        title="wind speed",
        help="mean wind at flight height, below the airspeed",
        unit="m/s",
        least=0.0,
        suggested=5.0,
    )
    from_deg: float = declared(
        0.0,
        title="wind direction",
        help="direction the wind blows from, clockwise from north",
        unit="deg",
        suggested=270.0,
    )
    turbulence: float = declared(
        0.0,
        title="turbulence",
        help="standard deviation of the gusts over the mean wind: about 0.1 over water, 0.2 over fields, 0 for a "
        "steady wind",
        least=0.0,
        suggested=0.2,
    )
    seed: int = declared(Imagery.seed, title="seed of the wind", help="seed of the gusts", least=0)

    def checked(self, airspeed_m_per_s: float) -> Wind:
        """Return this wind if an aircraft of this airspeed can fly in it.

        Raises
        ------
        InvalidInput
            The mean wind is not below the airspeed, so that no aircraft advances against it; or the standard deviation
            of the gusts is not, so that they do not stay frozen while the aircraft flies through them; or the airspeed
            is invalid.
        """
        field_named(Flight, "airspeed_m_per_s").settled(airspeed_m_per_s)
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
        """Standard deviation of the horizontal gusts in metres per second."""
        return self.turbulence * self.speed_m_per_s

    def crab_deg(self, heading_deg: Floats | float, airspeed_m_per_s: float) -> Floats:
        """Crab angle from the track over ground to the heading through the air, clockwise positive.

        Parameters
        ----------
        heading_deg : array (...) or float
            Direction of the track over ground, clockwise from north.
        airspeed_m_per_s : float
            Above the mean wind.
        """
        import numpy as np

        against = self._against_rad(heading_deg)
        crab: Floats = np.degrees(np.arcsin(self.speed_m_per_s / airspeed_m_per_s * np.sin(against)))
        return crab

    def ground_speed_m_per_s(self, heading_deg: Floats | float, airspeed_m_per_s: Floats | float) -> Floats:
        """Speed over ground along a track, in m/s: above 0 where the airspeed exceeds the mean wind."""
        import numpy as np

        against = self._against_rad(heading_deg)
        forward = np.sqrt(airspeed_m_per_s**2 - (self.speed_m_per_s * np.sin(against)) ** 2)
        speed: Floats = forward - self.speed_m_per_s * np.cos(against)
        return speed

    def _against_rad(self, heading_deg: Floats | float) -> Floats:
        """Angle from a track to the direction the wind comes from, not reduced to one turn."""
        import numpy as np

        against: Floats = np.radians(float(self.from_deg) - np.asarray(heading_deg, np.float64))
        return against
