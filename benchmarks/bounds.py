"""Measured errors against bounds, over a million random scenes.

    python benchmarks/bounds.py             # some minutes; writes docs/bounds.md

Scenes are drawn over the whole domain of each method: heights from 1 cm to 36,000 km, fields of view from 0.01 to
179.9 degrees, aspect ratios from 1e-3 to 1e3, latitudes up to the poles, any attitude; only scenes whose pixels float64
degrees do not resolve are left out. Errors are measured by the independent camera of the tests in long double.
"""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tests.core.geodesy import bounds, longdouble  # noqa: E402
from tests.support.libraries import ULPS, inexact  # noqa: E402

#: Cameras, and scenes of each, of the methods for level cameras and of the exact one.
DRAWS, EACH = 1_000, 400
#: Cameras, and frames of each, whose every pixel is traced.
FRAMES, FRAMES_EACH = 1_000, 6
#: Cameras of each mesh tolerance.
MESHES = 480
#: Share of the cameras that are drawn again with functions that are off.
INEXACT = 0.25
TOLERANCES_PX = (1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001)
#: Cameras, and poses of each, whose inscribed rectangles are looked at.
RECTANGLES = (2_000, 6)


def tallies(share: float = 1.0) -> dict[str, tuple[bounds.Tally, str]]:
    """Of each method, and what its scenes are called; for a share of the cameras."""
    draws, frames, meshes, wide = (round(share * count) for count in (DRAWS, FRAMES, MESHES, MESHES / 3))
    found = {name: (tally, "scenes") for name, tally in bounds.level_methods(2024, draws, EACH).items()}
    found["exact"] = bounds.exact_footprints(2025, draws, EACH), "scenes"
    found["camera by rays"] = bounds.camera_frames(2029, frames, FRAMES_EACH)[1], "frames"
    for tolerance in TOLERANCES_PX:
        found[f"mesh, {tolerance:g} px"] = bounds.meshes(2026, meshes, tolerance)[1], "meshes"
        some = bounds.meshes(2028, wide, tolerance, narrowest=20.0, widest=150.0)[1]
        found[f"mesh, {tolerance:g} px, 20° to 150°"] = some, "meshes"
    return found


def row(name: str, tally: bounds.Tally, unit: str, inexact_worst: float) -> str:
    """One line of the table."""
    scene = ", ".join(f"{key} {value:.5g}" for key, value in tally.scene.items() if value != 0.0)
    figures = f"{tally.worst:.3f} | {inexact_worst:.3f} | {tally.median:.3f}"
    return f"| {name} | {tally.count:,} {unit} | {figures} | {scene} |"


def page() -> str:
    """Text of docs/bounds.md."""
    own = tallies()
    with inexact(seed=2030):
        far_off = tallies(INEXACT)
    rows = [row(name, tally, unit, far_off[name][0].worst) for name, (tally, unit) in own.items()]
    rectangles = bounds.rectangles_inside(2027, *RECTANGLES)
    worst_px = max(rectangles.worst_px, 0.0)
    without = rectangles.count - rectangles.with_extent
    table = "\n".join(rows)
    total = sum(tally.count for tally, unit in own.values() if unit == "scenes")
    precise = "long double" if longdouble.EXTENDED else "float64 (this machine has no longer numbers)"
    return f"""# Bounds against measured errors

Made by `python benchmarks/bounds.py`. Scenes are drawn at random from the whole domain of each method: heights of 1 cm
to 36,000 km, fields of view from 0.01° to 179.9°, aspect ratios from 1e-3 to 1e3, latitudes to the poles, any longitude
and yaw, and for the exact camera, camera frames and the meshes any tilt to 110° and roll to 60°. Only scenes with
pixels below 4e-8 m are left out, because degrees in float64 cannot resolve them. Errors are in px of an image whose
longer side is 640, measured by the independent camera of the tests in {precise}.

{total:,} comparisons of corners and map frames. A bound holds if the worst ratio is below 1; the median shows how tight
it is. The second figure is the worst of {INEXACT:.0%} as many scenes with sines, tangents and similar functions off by
up to {ULPS:g} units in the last place, at random, like those of some processors. The ratio of a camera frame with every
pixel traced is that of the worst of {bounds.POINTS_A_FRAME:,} points, that of a mesh the worst of
{bounds.POINTS_A_MESH:,} points in its cells, each relative to the bound of its cell.

| method | drawn | worst error / bound | {ULPS:g} units off | median | worst scene |
| --- | ---: | ---: | ---: | ---: | --- |
{table}

Rectangles that camera frames cover, {rectangles.with_extent:,} for {RECTANGLES[0]:,} cameras at any tilt and height,
were checked: none exceeds its image by more than {worst_px:.2g} px beyond the noise of map positions (before they are
shrunk by half a pixel of the source), and the Earth hides no part of them. {without:,} more poses see ground but have
no rectangle.

The bounds of the exact camera and of traced pixels are for rounding errors, which are random: a bound for the worst of
a million scenes is far from the median. Fields of view are uniform in the logarithm of their tangent, so that half of
all cameras see less than 7°; for these, a mesh is a single cell, and its bound is also one of rounding. The rows for
wide cameras exclude them.
"""


def main() -> None:
    """Write the page and print it."""
    text = page()
    (ROOT / "docs" / "bounds.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
