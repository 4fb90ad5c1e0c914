"""What refusals and warnings of a flight path advise."""

from __future__ import annotations

import re
from functools import partial

from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.export.vehicle import vehicle_text
from terrainav.core.mission.flight.pilot import greatest_speed_m_per_s, interval_warnings
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.remedies import Case, remedy

FIELD = Mission(Box(35.158, -89.90, 35.155, -89.894), 120.0, takeoff=(35.1565, -89.9015))


def flown(mission=FIELD, **changes):
    return plan(mission.replace(**changes), PixelGrid()).path


@remedy("mission/parts/flown.py", "set a take-off point (--takeoff)")
def _no_takeoff(case: Case) -> None:
    case.refused(lambda: FIELD.replace(takeoff=None, entry="nearest"))
    case.follow("set a take-off point (--takeoff)", lambda: FIELD.replace(entry="nearest", battery_min=10.0))


@remedy(
    "mission/flight/path.py",
    "take-off at latitude {}, longitude {}: lies inside a no-fly area; move it outside",
)
def _takeoff_in_no_fly(case: Case) -> None:
    mission = FIELD.replace(
        no_fly=(Polygon((((-89.91, 35.15), (-89.901, 35.15), (-89.901, 35.16), (-89.91, 35.16)),)),)
    )
    case.refused(partial(flown, mission))
    case.follow("move it outside", partial(flown, mission, takeoff=(35.1565, -89.8995)))


@remedy(
    "mission/flight/path.py",
    "battery of {} min: the way to image {} and back takes {} min; take off nearer to it, fly faster or take a larger "
    "battery",
)
def _too_far(case: Case) -> None:
    mission = FIELD.replace(takeoff=(35.19, -89.9), battery_min=6.0)
    case.refused(partial(flown, mission))
    case.follow("take off nearer to it", partial(flown, mission, takeoff=(35.16, -89.9)))
    case.follow("fly faster", partial(flown, mission, airspeed_m_per_s=30.0))
    case.follow("take a larger battery", partial(flown, mission, battery_min=12.0))


@remedy(
    "mission/flight/path.py",
    "battery of {} min: the flight needs more than {} sorties; take a smaller area, a nearer take-off or a larger "
    "battery",
)
def _too_many_sorties(case: Case) -> None:
    def points(count):
        return Points(tuple((35.0, -89.0 + 1e-8 * at, 100.0) for at in range(count)))

    # One image a sortie, and hardly more.
    mission = Mission(points(1001), 100.0, takeoff=(35.01, -89.0), trigger="hover", battery_min=3.65)
    case.refused(partial(flown, mission))
    case.follow("take a smaller area", partial(flown, mission, area=points(900)))
    case.follow("a nearer take-off", partial(flown, mission, takeoff=(35.002, -89.0)))
    case.follow("a larger battery", partial(flown, mission, battery_min=8.0))


def said(**changes):
    """What there is to say of a camera that takes an image every 2.6 s."""
    mission = FIELD.replace(overlap_along=0.8, photo_interval_s=2.6).replace(**changes)
    return "\n".join(interval_warnings(plan(mission, PixelGrid())))


@remedy("mission/flight/pilot.py", "{}; fly at {} m/s or slower (--airspeed)")
def _too_fast(case: Case) -> None:
    text = case.says(said())
    (named, speed) = re.findall(r"(fly at ([0-9.]+) m/s or slower \(--airspeed\))", text)[0]
    case.follow(named, lambda: not said(airspeed_m_per_s=float(speed)))


@remedy(
    "mission/flight/pilot.py",
    "airspeed auto: needs a limit of the camera; give its minimum image interval (--photo-interval) or its exposure "
    "time (--exposure-ms)",
)
def _no_limit(case: Case) -> None:
    def chosen(**changes):
        return greatest_speed_m_per_s(plan(FIELD.replace(**changes), PixelGrid()))

    case.refused(chosen)
    case.follow("give its minimum image interval (--photo-interval)", lambda: chosen(photo_interval_s=3.0))
    case.follow("its exposure time (--exposure-ms)", lambda: chosen(exposure_ms=1.0))


@remedy("mission/mission.py", "exposure {}: needs an exposure time; give it (--exposure-ms)")
def _no_exposure_time(case: Case) -> None:
    case.refused(lambda: FIELD.replace(exposure="manual"))
    case.follow("give it (--exposure-ms)", lambda: FIELD.replace(exposure="manual", exposure_ms=1.0))


@remedy(
    "mission/plan.py",
    "exposure time {} ms: longer than the {} ms between two images; fly slower, overlap less or shorten the exposure",
)
def _long_exposure(case: Case) -> None:
    def made(**changes):
        asked = {"exposure": "manual", "exposure_ms": 1_000.0, "overlap_along": 0.9, "airspeed_m_per_s": 20.0}
        return plan(FIELD.replace(**{**asked, **changes}), PixelGrid())

    case.refused(made)
    case.follow("fly slower", lambda: made(airspeed_m_per_s=2.0))
    case.follow("overlap less", lambda: made(overlap_along=0.0))
    case.follow("shorten the exposure", lambda: made(exposure_ms=5.0))


@remedy(
    "mission/plan.py",
    "exposure and reading of rows take {} ms: longer than the {} ms between two images; fly slower, overlap less or "
    "shorten the row time",
)
def _long_reading(case: Case) -> None:
    def made(**changes):
        asked = {"row_time_us": 1_000.0, "overlap_along": 0.95, "airspeed_m_per_s": 20.0, "image_px": 1500}
        return plan(FIELD.replace(**{**asked, **changes}), PixelGrid())

    case.refused(made)
    case.follow("fly slower", lambda: made(airspeed_m_per_s=2.0))
    case.follow("overlap less", lambda: made(overlap_along=0.0))
    case.follow("shorten the row time", lambda: made(row_time_us=20.0))


@remedy("mission/flight/pilot.py", "airspeed auto: no speed is slow enough for the camera; overlap less or fly higher")
def _no_speed(case: Case) -> None:
    def chosen(**changes):
        against = {"wind": Wind(9.0, 270.0, 0.0), "photo_interval_s": 5.0, "overlap_along": 0.8}
        return greatest_speed_m_per_s(plan(FIELD.replace(**against).replace(**changes), PixelGrid()))

    case.refused(chosen)
    case.follow("overlap less", lambda: chosen(overlap_along=0.0))
    case.follow("fly higher", lambda: chosen(agl_m=400.0))


@remedy("mission/flight/pilot.py", "{}; overlap less or fly higher")
def _never_slow_enough(case: Case) -> None:
    against = {"wind": Wind(9.0, 270.0, 0.0), "photo_interval_s": 8.0}
    case.says(said(**against))
    less = {**against, "photo_interval_s": 5.0}
    assert "overlap less" in said(**less)
    case.follow("overlap less", lambda: not said(**less, overlap_along=0.0))
    case.follow("fly higher", lambda: not said(**against, agl_m=1500.0))


@remedy("mission/export/vehicle.py", "flight of {} sorties: a vehicle takes one; choose one from 1 to {} (--sortie)")
def _several_sorties(case: Case) -> None:
    text = case.refused(lambda: vehicle_text(["first", "second"], None))
    assert "flight of 2 sorties" in text
    case.follow("choose one from 1 to 2 (--sortie)", lambda: vehicle_text(["first", "second"], 2) == "second")
