"""What refusals of the sun of a mission advise."""

from __future__ import annotations

from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.sunlight import mission_sun

from tests.support.remedies import Case, remedy


def sun(text: str, **flight: str) -> None:
    mission_sun(Mission(Box(35.16, -89.90, 35.159, -89.899), 120.0, sun=text, **flight))


@remedy("mission/sunlight.py", "sun {}: needs the start of the flight; give it (--start)")
def _without_start(case: Case) -> None:
    case.refused(lambda: sun("time"))
    case.follow("give it (--start)", lambda: sun("time", start="2024-06-21T16:00:00Z"))


@remedy(
    "mission/sunlight.py",
    "sun {}: at {} it is {} degrees below the horizon; start by day (--start), or give its height and azimuth",
)
def _by_night(case: Case) -> None:
    case.refused(lambda: sun("time", start="2024-06-21T06:00:00Z"))
    case.follow("start by day (--start)", lambda: sun("time", start="2024-06-21T16:00:00Z"))
    case.follow("give its height and azimuth", lambda: sun("30 135"))
