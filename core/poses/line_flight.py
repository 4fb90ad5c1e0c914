"""How a line is flown; apart from the flight, so that forms can show it before anything is computed."""

from __future__ import annotations

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
