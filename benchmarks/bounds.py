"""Measured errors against bounds, over more than a million random scenes.

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

#: Cameras, and scenes of each, of the methods for level cameras and of the exact one.
DRAWS, EACH = 2_200, 600
#: Cameras of each mesh tolerance.
MESHES = 1_200
TOLERANCES_PX = (1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001)
#: Cameras, and poses of each, whose inscribed rectangles are looked at.
RECTANGLES = (10_000, 6)


def row(name: str, tally: bounds.Tally, unit: str) -> str:
    """One line of the table."""
    scene = ", ".join(
        f"{key} {float(value):.5g}" for key, value in tally.scene.items() if float(value) != 0.0
    )
    return f"| {name} | {tally.count:,} {unit} | {tally.worst:.3f} | {tally.median:.3f} | {scene} |"


def page() -> str:
    """Text of docs/bounds.md."""
    level = bounds.level_methods(2024, DRAWS, EACH)
    rows = [row(name, tally, "scenes") for name, tally in level.items()]
    rows.append(row("exact", bounds.exact_footprints(2025, DRAWS, EACH), "scenes"))
    for tolerance in TOLERANCES_PX:
        _, meshes = bounds.meshes(2026, MESHES, tolerance)
        rows.append(row(f"mesh-{tolerance:g}px", meshes, "meshes"))
        _, wide = bounds.meshes(2028, MESHES // 3, tolerance, narrowest=20.0, widest=150.0)
        rows.append(row(f"mesh-{tolerance:g}px, 20° to 150°", wide, "meshes"))
    rectangles = bounds.rectangles_inside(2027, *RECTANGLES)
    worst_px = max(rectangles.worst_px, 0.0)
    without = rectangles.count - rectangles.with_extent
    table = "\n".join(rows)
    total = sum(tally.count for tally in level.values())
    precise = "long double" if longdouble.EXTENDED else "float64 (this machine has no longer numbers)"
    return f"""# Bounds against measured errors

Made by `python benchmarks/bounds.py`. Scenes are random over the whole domain of each method: heights of 1 cm to
36,000 km, fields of view from 0.01° to 179.9°, aspect ratios from 1e-3 to 1e3, latitudes to the poles, any yaw, and
for the exact camera and the meshes any tilt to 110° and roll to 60°. Left out are only scenes whose pixels are below
4e-8 m, which degrees in float64 do not resolve. Errors are in px of an image whose longer side is 640, measured by the
independent camera of the tests in {precise}.

{total:,} comparisons for level cameras. A bound holds where the worst ratio stays below 1; the median says how
tight it is. For a mesh the ratio is that of the worst of {bounds.POINTS_A_MESH:,} points in its cells, each over
its own cell's bound.

| method | drawn | worst error / bound | median | worst scene |
| --- | ---: | ---: | ---: | --- |
{table}

Of the rectangles that camera frames count for in covering, {rectangles.with_extent:,} for {RECTANGLES[0]:,} cameras at
any tilt and height were looked at: none leaves its image by more than {worst_px:.2g} px beyond the noise
of map positions (before they give way by half a pixel of the source), and the Earth hides nothing of them. {without:,}
more poses see ground and have no rectangle.

The bound of the exact camera is one of rounding, which is random: what holds in the worst of a million scenes is
far from the median one. Draws of fields of view are even in the logarithm of their tangent, so that half of all
cameras see less than 7°; a mesh is a single cell there, and its bound is rounding, too. The rows for wide cameras
leave those out.
"""


def main() -> None:
    """Write the page and print it."""
    text = page()
    (ROOT / "docs" / "bounds.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
