"""Every way out that a refusal of a plan names is gone, and works; a new one has to be put here."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.wind import Wind

CORE = Path(__file__).parents[3] / "core"
#: Whose refusals a plan may end with.
MODULES = (
    *(
        "mission/choosing.py",
        "mission/framing.py",
        "mission/layout.py",
        "mission/plan.py",
        "mission/turned.py",
    ),
    "geodesy/frames.py",
)
_ADVICE = re.compile(r"; ((?:ask|choose|draw|fly|go on|overlap|raise|take|tilt|use)\b.*)", re.DOTALL)

GRID = PixelGrid()
AREA = Box(35.16, -89.90, 35.15, -89.89)


def at(lat, agl, **more):
    return Mission(Points(((lat, 0.0, agl),)), agl, **more)


def moved(lat, agl):
    return {"area": Points(((lat, 0.0, agl),)), "agl_m": agl}


#: Where the advice is to take the figure that the refusal names.
NAMED = "the figure named"
HIGH = {"frame": "map", "accept_error": True}
SMALL = Box(35.002, -89.002, 35.0, -89.0)
#: Advice, and what provokes it: a mission and a grid, and what each part of the advice comes to.
WAYS_OUT = {
    "fly higher or widen the field of view": (
        (at(35.0, 0.01, camera=Camera(0.01, 1.0), frame="camera", upsample=True), GRID),
        [moved(35.0, 10.0), {"camera": Camera(60.0, 1.0)}],
    ),
    "raise --error-budget, or go on with --accept-error": (
        (Mission(AREA, 120.0, error_budget_px=1e-12), GRID),
        [{"error_budget_px": NAMED}, {"accept_error": True}],
    ),
    "choose a source of tiles": (
        (Mission(AREA, 120.0, tilt_deg=9.0), PixelGrid(centre_decimals=6, max_size_px=640)),
        [GRID],
    ),
    "fly lower": ((at(35.0, 9e3, **HIGH), PixelGrid(min_zoom=22)), [moved(35.0, 120.0)]),
    "fly lower, or allow larger pictures (--max-px)": (
        (Mission(AREA, 120.0, max_px=640), PixelGrid(min_zoom=19)),
        [{"agl_m": 60.0}, {"max_px": 700}],
    ),
    "choose a lower zoom": ((at(35.0, 9e3, zoom=22, **HIGH), GRID), [{"zoom": 17}]),
    "choose a lower zoom, or allow larger pictures (--max-px)": (
        (Mission(AREA, 120.0, zoom=19, max_px=640), GRID),
        [{"zoom": 18}, {"max_px": 700}],
    ),
    "choose a larger ground sample distance": (
        (at(35.0, 9e3, gsd_m_per_px=0.05, **HIGH), GRID),
        [{"gsd_m_per_px": 5.0}],
    ),
    "choose a larger ground sample distance, or allow larger pictures (--max-px)": (
        (Mission(AREA, 120.0, gsd_m_per_px=0.3, max_px=640), GRID),
        [{"gsd_m_per_px": 0.5}, {"max_px": 700}],
    ),
    "ask for that, or allow enlarged pixels (--upsample)": (
        (Mission(AREA, 120.0, zoom=20), PixelGrid(native_zoom=16)),
        [{"zoom": 16}, {"upsample": True}],
    ),
    "ask for that or more, or allow enlarged pixels (--upsample)": (
        (Mission(AREA, 120.0, gsd_m_per_px=0.5), PixelGrid(native_zoom=16)),
        [{"gsd_m_per_px": NAMED}, {"gsd_m_per_px": 3.0}, {"upsample": True}],
    ),
    "fly higher or nearer to the equator": ((at(86.0, 1e3), GRID), [moved(86.0, 1e6), moved(80.0, 1e3)]),
    "fly lower or nearer to the equator": (
        (at(85.0505, 300.0, **HIGH), GRID),
        [moved(85.0505, 3.0), moved(84.0, 300.0)],
    ),
    "fly higher or choose a higher zoom": (
        (at(35.0, 1.0, zoom=5), GRID),
        [moved(35.0, 1e5), {"zoom": 22}],
    ),
    "fly higher or choose a smaller ground sample distance": (
        (at(35.0, 1.0, gsd_m_per_px=90.0, frame="camera"), GRID),
        [moved(35.0, 1e4), {"gsd_m_per_px": 0.5}],
    ),
    "choose a less extreme aspect ratio or a larger image (--image-px)": (
        (at(0.0, 9e4, camera=Camera(20.0, 1e4), tilt_deg=1.0, frame="camera"), GRID),
        [{"camera": Camera(20.0, 10.0)}, {"image_px": 9_000}],
    ),
    "choose a less extreme aspect ratio or larger pictures (--max-px)": (
        (at(0.0, 9e4, camera=Camera(20.0, 1e4), tilt_deg=1.0, image_px=9_000, max_px=640), GRID),
        [{"camera": Camera(20.0, 10.0)}, {"max_px": 9_000}],
    ),
    "fly higher, draw a smaller area, or raise it (--max-images)": (
        (Mission(AREA, 120.0, max_images=20), GRID),
        [{"agl_m": 600.0}, {"area": SMALL}, {"max_images": 1000}],
    ),
    "choose a lower zoom, or make them smaller (--max-px)": (
        (at(35.0, 9e3, image_px=20_000, accept_error=True), GRID),
        [{"zoom": 16}, {"max_px": 10_000}],
    ),
    "overlap less": (
        (Mission(Box(35, -89, 35, -89), 120.0, overlap_along=0.9999999), GRID),
        [{"overlap_along": 0.9}],
    ),
    "use --layout cover": (
        (Mission(Box(10, -170, -10, 170), 1e5, layout="paper", accept_error=True), GRID),
        [{"layout": "cover"}],
    ),
    "fly higher or in less turbulence": (
        (Mission(SMALL, 3.0, wind=Wind(14.0, 250.0, 0.9), accept_error=True), GRID),
        [{"agl_m": 300.0}, {"wind": Wind(3.0, 250.0, 0.05)}],
    ),
}
#: What `framing` puts together of parts.
PUT_TOGETHER = {
    f"{first}{second}"
    for first in ("fly lower", "choose a lower zoom", "choose a larger ground sample distance")
    for second in ("", ", or allow larger pictures (--max-px)")
} | {"choose a lower zoom, or make them smaller (--max-px)"}
#: Advice that is tried elsewhere, or that no plan is known to end with.
ELSEWHERE = {
    "tilt it less or fly lower": "seen in test_plan",
    "tilt the camera less, fly lower or take a smaller area": "seen in test_plan",
    "fly lower or farther from it": "seen in the extreme suite",
    "fly lower or farther from the pole": "beyond the flat model's domain, which is refused before",
    "tilt it less, fly lower or fly north-up rows": "seen in test_turned",
    "take a smaller area or north-up rows": "seen in test_turned",
    "fly lower or narrow the field of view": "beyond the flat model's domain, which is refused before",
}


def advice_in(module):
    """What the module's refusals advise, places of values as {}."""
    for node in ast.walk(ast.parse((CORE / module).read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "InvalidInput" and node.args:
            found = _ADVICE.search(words(node.args[0]))
            if found is not None:
                yield found[1]


def words(node):
    if isinstance(node, ast.JoinedStr):
        return "".join("{}" if isinstance(part, ast.FormattedValue) else words(part) for part in node.values)
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


def test_all_advice_there_is_has_its_entry():
    found = {advice for module in MODULES for advice in advice_in(module)}
    assert found | PUT_TOGETHER == WAYS_OUT.keys() | ELSEWHERE.keys()
    assert not WAYS_OUT.keys() & ELSEWHERE.keys()


@pytest.mark.parametrize("advice", WAYS_OUT)
def test_what_is_advised_works(advice):
    (mission, grid), remedies = WAYS_OUT[advice]
    with pytest.raises(InvalidInput) as refused:
        plan(mission, grid)
    text = str(refused.value)
    assert text.endswith(f"; {advice}")
    assert remedies
    for remedy in remedies:
        if isinstance(remedy, PixelGrid):
            assert len(plan(mission, remedy))
            continue
        named = re.search(r"(?:with|are) ([0-9.e+-]+) (?:px|m)\b", text)
        change = {name: float(named[1]) if value == NAMED else value for name, value in remedy.items()}
        assert len(plan(mission.with_(**change), grid)), remedy
