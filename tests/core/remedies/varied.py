"""What refusals of random values advise."""

from __future__ import annotations

from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.estimate import estimate
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.report.measure import measure

from tests.support.remedies import Case, remedy


def vary(text: str) -> Mission:
    return Mission(Box(35.16, -89.90, 35.159, -89.899), 120.0, vary=(text,))


@remedy(
    "mission/parts/varied.py",
    "vary {}: has no bounds, and {} must be {}; add bounds as within(low,high)",
)
def _without_bounds(case: Case) -> None:
    case.refused(lambda: vary("agl_m=normal(100,20)"))
    case.follow("add bounds as within(low,high)", lambda: vary("agl_m=normal(100,20)within(60,140)"))


@remedy("mission/parts/varied.py", "vary {}: the images of a mission have one shape; plan a mission for each")
def _shape(case: Case) -> None:
    case.refused(lambda: vary("aspect_ratio=choice(1,2)"))
    cameras = [Camera(aspect_ratio=ratio) for ratio in (1.0, 2.0)]
    case.follow(
        "plan a mission for each",
        lambda: [vary("agl_m=uniform(90,110)").replace(camera=camera) for camera in cameras],
    )


@remedy("report/measure.py", "vary {}: methods are measured with one camera; choose other fields")
def _measured(case: Case) -> None:
    def measured(text: str) -> None:
        source = open_source("world")
        measure(plan(vary(text).replace(image_px=64), source.grid), source, quick=True)

    case.refused(lambda: measured("k1=uniform(-0.1,0)"))
    case.follow("choose other fields", lambda: measured("agl_m=uniform(90,110)"))


@remedy(
    "mission/estimate.py",
    "vary {}: changes no image while the exposure is {}; choose another one (--exposure)",
)
def _ideal_exposure(case: Case) -> None:
    def warnings(**options: str) -> tuple[str, ...]:
        mission = vary("exposure_ms=uniform(1,2)").replace(exposure_ms=1.0, **options)
        return estimate(plan(mission, PixelGrid())).warnings

    (warning,) = warnings()
    case.says(warning)
    case.follow("choose another one (--exposure)", lambda: warnings(exposure="manual"))
    assert warnings(exposure="manual") == ()


@remedy(
    "mission/flight/varied.py",
    "vary {}: one of the cameras would be {} m above the ground; fly higher, or choose another distribution",
)
def _below_ground(case: Case) -> None:
    def planned(agl_m: float, text: str) -> None:
        # The second point is lower than the mission's height, which is that of the first.
        area = Points(((35.1, -89.9, agl_m), (35.1, -89.9, agl_m - 90.0)))
        plan(Mission(area, agl_m, vary=(text,)), PixelGrid())

    case.refused(lambda: planned(100.0, "agl_m=uniform(50,60)"))
    case.follow("fly higher", lambda: planned(150.0, "agl_m=uniform(120,130)"))
    case.follow("choose another distribution", lambda: planned(100.0, "agl_m=uniform(99,101)"))
