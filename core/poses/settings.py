"""How a line is flown, and how wrong sensors are: what forms and the command show before numpy is needed."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import InvalidInput
from ..fields import Part, declared


@dataclass(frozen=True)
class LineFlight(Part):
    """How a line is flown: exactly one of the two intervals is needed.

    Raises
    ------
    InvalidInput
        Values outside their domain, no interval or two.
    """

    speed_m_per_s: float = declared(
        title="speed",
        help="speed over ground",
        label="&Speed",
        unit="m/s",
        least=0.1,
        most=340.0,
        suggested=12.0,
    )
    every_s: float | None = declared(
        None,
        title="interval in seconds",
        help="time from one exposure to the next",
        unit="s",
        option="every_s",
        above=0.0,
    )
    every_m: float | None = declared(
        None,
        title="interval in metres",
        help="way flown from one exposure to the next",
        unit="m",
        option="every_m",
        above=0.0,
    )
    bank_deg: float = declared(
        25.0,
        title="bank in turns",
        help="bank in turns; with the speed, it gives their radius",
        label="&Bank in turns",
        unit="deg",
        least=1.0,
        most=80.0,
    )
    fixed_camera: bool = declared(
        False,
        title="camera rolls with the aircraft",
        help="the camera is fixed to the aircraft; without this, a gimbal keeps it level in turns",
        label="Camera rolls with the aircr&aft",
    )

    def __post_init__(self) -> None:
        """Check every field, and that there is one interval."""
        super().__post_init__()
        if (self.every_s is None) == (self.every_m is None):
            raise InvalidInput("interval: must be either in seconds or in metres")


#: Beyond these a sensor says nothing of a pose.
_MOST = {"gnss_m": 10_000.0, "barometer_m": 10_000.0, "compass_deg": 180.0, "drift_s": 1e6}


@dataclass(frozen=True)
class Sensors:
    """How wrong sensors are.

    Parameters
    ----------
    gnss_m, barometer_m, compass_deg : float
        Standard deviations: of the place along east and along north, of the height, up to 10 km, and of the heading, up
        to 180.
    drift_s : float
        Time constant of the half of the variance that drifts, up to 1e6; 0 has all of it white.
    outage_share, outage_s : float
        Share of the time without a fix, from 0 to below 1, and mean length of an outage.

    Raises
    ------
    InvalidInput
        A number outside of its range.
    """

    gnss_m: float = 1.5
    barometer_m: float = 1.0
    compass_deg: float = 3.0
    drift_s: float = 60.0
    outage_share: float = 0.0
    outage_s: float = 10.0

    def __post_init__(self) -> None:
        for name, most in _MOST.items():
            value = getattr(self, name)
            if not 0.0 <= value <= most:
                raise InvalidInput("{0} {1}: must be from 0 to {2:,g}", name, value, most)
        if not 0.0 <= self.outage_share < 1.0:
            raise InvalidInput("share of outages {0}: must be from 0 to below 1", self.outage_share)
        if not (math.isfinite(self.outage_s) and self.outage_s > 0.0):
            raise InvalidInput("mean length of outages {0} s: must be above 0", self.outage_s)
