"""The part of a mission that states how long images take, while the camera moves on."""

from __future__ import annotations

from dataclasses import dataclass

from ...fields import CheckedFields, declared


@dataclass(frozen=True)
class Shutter(CheckedFields):
    """Shutter of the camera: motion blur and rolling shutter along the path of the flight."""

    motion_blur: bool = declared(
        False,
        title="blur by motion",
        help="blur images by the motion of the camera during the exposure time",
        advanced=True,
    )
    row_time_us: float = declared(
        0.0,
        title="row time",
        help="time from the exposure of a row of pixels to that of the next one (rolling shutter), from the top of the "
        "image to its bottom; 0 for a global shutter",
        unit="us",
        least=0.0,
        most=10_000.0,
        advanced=True,
    )

    @property
    def takes_time(self) -> bool:
        """Whether the motion of the camera changes its images."""
        return self.motion_blur or self.row_time_us > 0.0
