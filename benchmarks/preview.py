"""The preview of a thousand to a million captures in the real QGIS: seconds, longest block of the GUI, memory.

    python tools/qgis_app.py benchmarks/preview.py     # writes docs/preview.md

The mission is drawn on the map, zoomed into with the wheel's steps until single images are seen, and moved about at
every scale. A timer that should fire every millisecond tells how long the application's event loop was held up, and
the preview's own methods on the main thread are timed one by one.
"""

from __future__ import annotations

import os
import platform
import resource
import sys
import time
from pathlib import Path
from typing import NamedTuple

from heartbeat import Block, Heartbeat, Steps
from qgis.core import Qgis, QgsCoordinateReferenceSystem, QgsProject, QgsRectangle, QgsVector
from qgis.PyQt.QtCore import QCoreApplication, QEventLoop, QTimer
from qgis.utils import iface

ROOT = Path(__file__).resolve().parent.parent
#: Asked for; a sixth less are flown.
COUNTS = (1_200, 12_000, 120_000, 1_200_000)
PATIENCE_S = 120.0
#: What the preview does on the main thread: all that the event loop, the map and the panel call.
OWN_STEPS = ("show", "_follow", "_look", "_deliver", "_fill_next", "_forget")
#: The published mission's middle, and degrees a capture takes there at 120 m.
LAT_DEG, LON_DEG, STEP_LAT_DEG, STEP_LON_DEG = 35.1375, -89.8615, 0.00098, 0.00158
#: Steps of the wheel from the whole mission down to single images, at most.
STEPS = 16


class Figures(NamedTuple):
    """What was measured of one mission."""

    captures: int
    plan_s: float
    first_s: float
    zooms_ms: list[float]
    pans_ms: list[float]
    steps_ms: list[float]
    step_ms: float
    idle: Block
    block: Block
    work_ms: float
    drawn: int
    memory_mb: float


def wait(preview) -> None:
    """Let the application run until the preview is drawn."""
    end = time.perf_counter() + PATIENCE_S
    while preview.busy:
        QCoreApplication.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents)
        if time.perf_counter() > end:
            raise TimeoutError("the preview was not drawn")


def settle(seconds: float = 0.3) -> None:
    """Let the application run."""
    loop = QEventLoop()
    QTimer.singleShot(int(seconds * 1000), loop.quit)
    loop.exec()


def measure(count: int, folder: Path) -> Figures:
    """Preview a mission of about so many captures, and look around in it."""
    from terrainav.core.mission.areas.area import Box
    from terrainav.core.mission.estimate import estimate
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan
    from terrainav.terrainav_plugin.map.mission_group import MissionGroup
    from terrainav.terrainav_plugin.preview.preview import Preview
    from terrainav.terrainav_plugin.sources import mission_grid, request_costs

    side = count**0.5 / 2.0
    north, south = LAT_DEG + side * STEP_LAT_DEG, LAT_DEG - side * STEP_LAT_DEG
    west, east = LON_DEG - side * STEP_LON_DEG, LON_DEG + side * STEP_LON_DEG
    mission = Mission(area=Box(north, west, south, east), agl_m=120.0)
    canvas, project = iface.mapCanvas(), QgsProject.instance()
    iface.newProject(False)
    project.setCrs(QgsCoordinateReferenceSystem("EPSG:3857"))
    start = time.perf_counter()
    planned = plan(mission, mission_grid(mission))
    estimate(planned, request_costs(mission.imagery.source))
    plan_s = time.perf_counter() - start

    steps = Steps()
    watched = steps.watch(Preview, *OWN_STEPS)
    watched.__enter__()
    preview = Preview(project, canvas)
    left, bottom, right, top = planned.edges
    canvas.setExtent(QgsRectangle(left.min(), bottom.min(), right.max(), top.max()))
    settle()
    watch = Heartbeat()
    settle(1.0)
    idle = watch.longest
    watch.reset()
    steps.reset()
    start = time.perf_counter()
    preview.show(MissionGroup(project, folder), mission, planned)
    wait(preview)
    first_s = time.perf_counter() - start
    canvas.waitWhileRendering()
    settle()
    blocks, work, zooms, pans = [watch.longest], [watch.most_work_s], [], []
    totals, longest = [steps.total_s], [steps.longest_s]
    most = _drawn(preview)

    def timed(act) -> float:
        nonlocal most
        settle(0.1)
        watch.reset()
        steps.reset()
        begin = time.perf_counter()
        act()
        wait(preview)
        seconds = time.perf_counter() - begin
        canvas.waitWhileRendering()
        settle(0.1)
        blocks.append(watch.longest)
        work.append(watch.most_work_s)
        totals.append(steps.total_s)
        longest.append(steps.longest_s)
        most = max(most, _drawn(preview))
        return 1000.0 * seconds

    for _ in range(STEPS):
        if canvas.mapUnitsPerPixel() < 0.2:
            break
        zooms.append(timed(lambda: canvas.zoomByFactor(0.5)))
        for share in (0.2, 1.5):
            extent = canvas.extent()
            moved = QgsRectangle(extent)
            moved += QgsVector(extent.width() * share, 0.0)
            pans.append(timed(lambda moved=moved: canvas.setExtent(moved)))
            pans.append(timed(lambda extent=extent: canvas.setExtent(extent)))
    memory_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    preview.close()
    watched.__exit__(None, None, None)
    return Figures(
        *(len(planned), plan_s, first_s, zooms, pans),
        *([1000.0 * total for total in totals], 1000.0 * max(longest)),
        *(idle, max(blocks), 1000.0 * max(work), most, memory_mb),
    )


def _drawn(preview) -> int:
    return sum(len(features) for features in preview.drawing.layers.values())


def page(rows: list[Figures]) -> str:
    """Text of the page."""
    canvas = iface.mapCanvas()
    machine = f"Machine: {os.cpu_count()} cores, {platform.system()}; QGIS {Qgis.QGIS_VERSION.partition('-')[0]}, "
    machine += f"virtual screen, map {canvas.width()} x {canvas.height()} px"
    load = f"; load average {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
    heads = (
        *("captures", "plan, s", "first preview, s", "zoom, ms: median, longest", "pan, ms: median, longest"),
        *("own steps, ms: longest, all of a view", "nothing done: longest block, ms"),
        *("longest block, ms", "most work at once, ms", "features", "memory, MB"),
    )
    lines = [
        "# Preview",
        "",
        "Made by `python tools/qgis_app.py benchmarks/preview.py`; all figures are from one run on one machine.",
        "",
        f"{machine}{load}.",
        "",
        "A mission at 120 m is previewed as a whole, then zoomed into in steps of two, with four pans at each. A",
        "zoom or pan is the time from the event until all layers are filled, including the 60 ms that the preview",
        "waits for the map to come to rest. Own steps are the preview's methods on the main thread: the longest of",
        "all, and the median over the views of their sum. The longest block is the longest time without a turn of",
        "the event loop, including QGIS's drawing; in brackets is how long the main thread worked in it, and how",
        "long it was ready while other threads or programs had the processors. With nothing done, the block is the",
        "machine's effect on an idle program. The most work at once is the largest processor time of the main",
        "thread between two turns of the event loop. Features are the maximum of all layers together. Memory is the",
        "peak of the process, which can only grow from row to row.",
        "",
        f"| {' | '.join(heads)} |",
        f"| {' | '.join(['---:'] * len(heads))} |",
    ]
    for row in rows:
        zoom, pan = (f"{sorted(times)[len(times) // 2]:.0f}, {max(times):.0f}" for times in (row.zooms_ms, row.pans_ms))
        of_a_view = sorted(row.steps_ms)[len(row.steps_ms) // 2]
        cells = (
            *(f"{row.captures:,}", f"{row.plan_s:.2f}", f"{row.first_s:.2f}", zoom, pan),
            *(f"{row.step_ms:.1f}, {of_a_view:.1f}", row.idle.text(), row.block.text()),
            *(f"{row.work_ms:.0f}", f"{row.drawn:,}", f"{row.memory_mb:.0f}"),
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*lines, ""])


def main() -> int:
    """Measure and write the page."""
    import tempfile

    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "preview.md"
    with tempfile.TemporaryDirectory() as folder:
        rows = [measure(count, Path(folder)) for count in COUNTS]
    text = page(rows)
    target.write_text(text, encoding="utf-8")
    print(text)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
