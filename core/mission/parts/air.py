"""The part of a mission that states the air between the camera and the ground."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ...errors import InvalidInput
from ...fields import CheckedFields, declared

_AIRLIGHT = "[0-9]{1,3} [0-9]{1,3} [0-9]{1,3}"


def _check_airlight(text: str) -> None:
    if not (re.fullmatch(_AIRLIGHT, text) and all(int(one) <= 255 for one in text.split())):
        raise InvalidInput(
            "airlight {0!r}: must be red, green and blue from 0 to 255, such as 188 196 204", text, field="airlight"
        )


@dataclass(frozen=True)
class Air(CheckedFields):
    """Haze between the camera and the ground."""

    visibility_km: float | None = declared(
        None,
        title="visibility",
        help="distance at which 5 percent of the contrast of dark things is left (meteorological optical range): haze "
        "by the distance of what each pixel shows; left out, the air is clear",
        unit="km",
        above=0.0,
        most=10_000.0,
        suggested=20.0,
        advanced=True,
    )
    airlight: str = declared(
        "188 196 204",
        title="airlight",
        help="colour of haze without end, and of the sky: red, green and blue from 0 to 255",
        check=_check_airlight,
        schema={"pattern": f"^{_AIRLIGHT}$"},
        advanced=True,
    )

    @property
    def airlight_rgb(self) -> tuple[int, int, int]:
        """Colour of the airlight, sRGB values of 8 bits."""
        red, green, blue = map(int, self.airlight.split())
        return red, green, blue
