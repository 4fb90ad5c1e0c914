"""The part of a mission that says in which light the synthetic world lies."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ...errors import InvalidInput
from ...fields import CheckedFields, declared
from ...numbers import NUMBER

#: No sun; the sun at the start of the flight.
NO_SUN, BY_START = "off", "time"
_SUN = f"{NO_SUN}|{BY_START}|{NUMBER} {NUMBER}"


def _check_sun(text: str) -> None:
    if text in (NO_SUN, BY_START):
        return
    if not re.fullmatch(_SUN, text):
        raise InvalidInput(
            "sun {0!r}: must be {1}, {2}, or its height and azimuth in degrees, such as 30 135",
            text,
            NO_SUN,
            BY_START,
            field="sun",
        )
    # Imported here, as only missions with a sun need numerics.
    from ...geodesy.sun import SunDirection

    SunDirection(*map(float, text.split()))


@dataclass(frozen=True)
class Sunlight(CheckedFields):
    """Sun and sky over the synthetic world."""

    sun: str = declared(
        NO_SUN,
        title="sun",
        help="sun over the synthetic world, whose relief, houses and trees it lights and whose shadows it casts: off; "
        "time, for where it stands at the start of the flight; or its height and azimuth in degrees, such as 30 135. "
        "Photographs have the light in which they were taken",
        advanced=True,
        check=_check_sun,
        schema={"pattern": f"^({_SUN})$"},
    )
