"""Plans of a hundred to a million captures: seconds and memory, beside other ways to the same five points a capture.

    python benchmarks/million.py            # writes docs/million.md and docs/images/million.png

Every plan is made in a process of its own: poses, exact corners, integer windows, the number of tiles, coverage, least
overlap and bounds, once to warm up at a small size and then for the figure. The per-point ways are timed on a share of
the points and scaled, as the whole would take half an hour; the share is stated.
"""

from __future__ import annotations

import json
import math
import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyproj
from pyproj import Geod, Transformer
from terrainav.core.geodesy.footprint import ground_corners
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import Plan, plan
from terrainav.core.picture.heights import mission_heights

ROOT = Path(__file__).resolve().parents[1]
SIZES = (100, 1_000, 10_000, 100_000, 1_000_000)
#: A mission of so many captures covers so many metres of ground at 120 m: found by `mission_of`.
AGL_M, LAT_DEG, LON_DEG = 120.0, 35.14, -89.86
#: Points that the slow ways are timed on.
PER_POINT_SHARE, SCALAR_SHARE = 1_000, 50_000
POINTS_PER_CAPTURE = 5


def mission_of(captures: int) -> Mission:
    """Box about the Agricenter that takes about so many pictures, a little wider than high."""
    width_m, height_m = Mission(Box(1, 0, 0, 1), AGL_M).camera.ground_size_m(AGL_M)
    rows = math.sqrt(captures * width_m / height_m / 1.2)
    half_lat = rows * height_m / 111_000.0 / 2.0
    half_lon = captures / rows * width_m / 111_320.0 / math.cos(math.radians(LAT_DEG)) / 2.0
    return Mission(Box(LAT_DEG + half_lat, LON_DEG - half_lon, LAT_DEG - half_lat, LON_DEG + half_lon), AGL_M)


def hard_missions() -> dict[str, Mission]:
    """Missions whose captures share no rows of equal poses: in wind, and over the relief of the synthetic world."""
    hills = Box(LAT_DEG + 0.62, LON_DEG - 0.744, LAT_DEG - 0.62, LON_DEG + 0.744)
    relief = {"elevation": ("world",), "clearance_m": 100.0, "overlap_along": 0.0, "overlap_across": 0.0}
    oblique = Box(LAT_DEG + 0.02, LON_DEG - 0.024, LAT_DEG - 0.02, LON_DEG + 0.024)
    return {
        "wind of 5 m/s, turbulence 0.2": mission_of(1_000_000).replace(wind=Wind(5.0, 270.0, 0.2)),
        "synthetic relief, 200 m": Mission(hills, 200.0, **relief),
        "synthetic relief, 120 m, tilt 60°": Mission(
            oblique, AGL_M, **{**relief, "tilt_deg": 60.0, "overlap_along": 0.3, "overlap_across": 0.3}
        ),
    }


def worked_out(mission: Mission) -> Plan:
    """Plan with every figure that is worked out when first asked for."""
    made = plan(mission, PixelGrid(), mission_heights(mission))
    if not (made.requests and made.coverage and made.overlap and made.accuracy.bound_px):
        raise SystemExit("a figure of the plan is missing")
    return made


def measure_plan(mission: Mission) -> dict[str, float]:
    """One mission in this process: seconds, and the peak of its memory with Python and numpy in it."""
    worked_out(mission_of(100))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start = time.process_time()
    made = worked_out(mission)
    seconds = time.process_time() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return {"captures": len(made), "seconds": seconds, "peak_mb": peak / 1e3, "before_mb": before / 1e3}


def measure_export() -> list[dict[str, Any]]:
    """Seconds and bytes of a million rows in each format."""
    made = worked_out(mission_of(1_000_000))
    found: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as folder:
        for ending in ("csv", "geojson", "kml"):
            path = Path(folder) / f"plan.{ending}"
            start = time.process_time()
            write_plan(made, path)
            found.append({"format": ending, "seconds": time.process_time() - start, "bytes": path.stat().st_size})
            path.unlink()
    return found


def measure_others() -> list[dict[str, Any]]:
    """Seconds of the same five points for each of a million captures, by the ways that others take."""
    made = worked_out(mission_of(1_000_000))
    count = len(made) * POINTS_PER_CAPTURE
    width, height = made.mission.camera.ground_size_m(AGL_M)
    east = np.tile([0.0, -width / 2, width / 2, width / 2, -width / 2], len(made))
    north = np.tile([0.0, height / 2, height / 2, -height / 2, -height / 2], len(made))
    lat, lon = np.repeat(made.lat_deg, 5), np.repeat(made.lon_deg, 5)
    azimuth, distance = np.degrees(np.arctan2(east, north)), np.hypot(east, north)
    geod = Geod(ellps="WGS84")
    zone = "EPSG:32616"

    def per_point() -> None:
        for index in range(PER_POINT_SHARE):
            there = Transformer.from_crs("EPSG:4326", zone, always_xy=True)
            x, y = there.transform(lon[index], lat[index])
            back = Transformer.from_crs(zone, "EPSG:4326", always_xy=True)
            back.transform(x + east[index], y + north[index])

    def scalar() -> None:
        for index in range(SCALAR_SHARE):
            geod.fwd(lon[index], lat[index], azimuth[index], distance[index])

    def vectorised_utm() -> None:
        there = Transformer.from_crs("EPSG:4326", zone, always_xy=True)
        x, y = there.transform(lon, lat)
        there.transform(x + east, y + north, direction="INVERSE")

    def rays_once_a_row() -> None:
        ground_corners(made.mission.camera, made.poses)

    ways: list[tuple[str, Callable[[], None], int]] = [
        ("rays once a row (this core, exact)", rays_once_a_row, count),
        (
            "Geod.fwd, vectorised (flat offsets, no camera)",
            lambda: geod.fwd(lon, lat, azimuth, distance),
            count,
        ),
        ("UTM there and back, vectorised", vectorised_utm, count),
        ("Geod.fwd, point by point", scalar, SCALAR_SHARE),
        ("a Transformer made per point", per_point, PER_POINT_SHARE),
    ]
    found: list[dict[str, Any]] = []
    for name, way, timed in ways:
        times = []
        for _ in range(3):
            start = time.process_time()
            way()
            times.append(time.process_time() - start)
        found.append({"way": name, "seconds": min(times) * count / timed, "timed": timed, "points": count})
    return found


def in_own_process(job: str) -> Any:
    """Run one measurement of this file in a fresh interpreter."""
    done = subprocess.run([sys.executable, __file__, job], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def processor() -> str:
    """Return the processor's name, as the system tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.machine())


def draw(plans: list[dict[str, float]], path: Path) -> None:
    """Seconds and memory against the number of captures."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 3.8), layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2)
    n = [row["captures"] for row in plans]
    left.loglog(n, [row["seconds"] for row in plans], "o-", color="#0072B2", label="plan, all figures")
    slope = plans[-1]["seconds"] / plans[-1]["captures"]
    left.loglog(n, [slope * count for count in n], "--", color="#999999", label="in proportion to captures")
    left.axhline(1.0, color="#D55E00", linewidth=1, label="aim: 1 s")
    left.set(title="Time of a plan", xlabel="captures", ylabel="seconds")
    right.semilogx(n, [row["peak_mb"] for row in plans], "o-", color="#009E73", label="peak of the process")
    right.axhline(400.0, color="#D55E00", linewidth=1, label="aim: 400 MB")
    right.set(title="Memory of a plan", xlabel="captures", ylabel="MB", ylim=(0, None))
    for axes, place in ((left, "lower right"), (right, "center left")):
        axes.grid(visible=True, which="major", color="#dddddd")
        axes.legend(frameon=False, loc=place)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)


def page(
    plans: list[dict[str, float]],
    hard: dict[str, dict[str, float]],
    others: list[dict[str, Any]],
    exports: list[dict[str, Any]],
) -> str:
    """Text of docs/million.md."""
    whole = plans[-1]["seconds"]
    sizes = "\n".join(
        f"| {row['captures']:,} | {row['seconds']:.4f} | {row['seconds'] / row['captures'] * 1e6:.2f} | "
        f"{row['peak_mb']:.0f} |"
        for row in plans
    )
    hard_rows = "\n".join(
        f"| {name} | {row['captures']:,} | {row['seconds']:.1f} | {row['peak_mb']:.0f} |" for name, row in hard.items()
    )
    ways = "\n".join(
        f"| {row['way']} | {row['timed']:,} | {row['seconds']:,.3g} | {row['seconds'] / whole:,.3g} |" for row in others
    )
    files = "\n".join(f"| {row['format']} | {row['seconds']:.1f} | {row['bytes'] / 1e6:.0f} |" for row in exports)
    return f"""# A million captures

Made by `python benchmarks/million.py`; all figures are from one run on one machine; only the ratios are transferable.

Machine: {processor()}, {os.cpu_count()} cores, {platform.system()}. Python {platform.python_version()},
numpy {np.__version__}, pyproj {pyproj.__version__} (PROJ {pyproj.proj_version_str}).

A plan consists of poses, exact corners, integer windows, the number of tiles, coverage, least overlap and bounds, at
120 m over a box around the Agricenter. Figures are the least of three runs, each in a
separate process; seconds are of the processor.

![Seconds and memory of a plan against its captures](images/million.png)

| captures | seconds | microseconds a capture | peak of the process, MB |
| ---: | ---: | ---: | ---: |
{sizes}

The peak includes Python, numpy and PROJ: {plans[0]["before_mb"]:.0f} MB before the plan.

## Captures that differ

Captures of a row over level ground in still air share corners and windows. In wind and over relief each has others;
one run each.

| ground | captures | seconds | peak of the process, MB |
| --- | ---: | ---: | ---: |
{hard_rows}

## The same {others[0]["points"]:,} points by other methods

Centre and corners of each capture. Methods that work point by point are timed on a part of the points and scaled. The
ratio is relative to the whole plan above, including all its other figures.

| method | points timed | seconds for all | times the whole plan |
| --- | ---: | ---: | ---: |
{ways}

## Export of the million rows

| format | seconds | MB |
| --- | ---: | ---: |
{files}
"""


def main() -> None:
    """Measure, or one measurement where that is asked for."""
    if len(sys.argv) > 1:
        job = sys.argv[1]
        found: Any
        if job == "export":
            found = measure_export()
        elif job == "others":
            found = measure_others()
        else:
            hard = hard_missions()
            found = measure_plan(hard[job] if job in hard else mission_of(int(job)))
        print(json.dumps(found))
        return
    plans = []
    for size in SIZES:
        runs = [in_own_process(str(size)) for _ in range(3)]
        plans.append(min(runs, key=lambda run: run["seconds"]))
        print(plans[-1], flush=True)
    hard = {name: in_own_process(name) for name in hard_missions()}
    others = in_own_process("others")
    exports = in_own_process("export")
    draw(plans, ROOT / "docs" / "images" / "million.png")
    text = page(plans, hard, others, exports)
    (ROOT / "docs" / "million.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
