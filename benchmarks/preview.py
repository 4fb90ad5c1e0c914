"""The preview of a thousand to a million captures in the real QGIS: seconds, longest block of the GUI, memory.

    python tools/qgis_app.py benchmarks/preview.py     # writes docs/preview.md

The mission is drawn on the map, zoomed into with the wheel's steps until single images are seen, and moved about at
every scale. A timer that should fire every millisecond tells how long the application's event loop was held up.
"""

from __future__ import annotations

import os
import platform
import resource
import sys
import time
from pathlib import Path
from typing import NamedTuple

from qgis.core import Qgis, QgsCoordinateReferenceSystem, QgsProject, QgsRectangle, QgsVector
from qgis.PyQt.QtCore import QCoreApplication, QEventLoop, QTimer
from qgis.utils import iface

ROOT = Path(__file__).resolve().parent.parent
COUNTS = (1_000, 10_000, 100_000, 1_000_000)
PATIENCE_S = 120.0
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
    block_ms: float
    drawn: int
    memory_mb: float


class Watch:
    """Longest time for which the event loop did not turn."""

    def __init__(self) -> None:
        self.longest_s = 0.0
        self._last = time.perf_counter()
        self._timer = QTimer()
        self._timer.timeout.connect(self._turned)
        self._timer.start(1)

    def _turned(self) -> None:
        now = time.perf_counter()
        self.longest_s, self._last = max(self.longest_s, now - self._last), now

    def reset(self) -> None:
        """Begin anew."""
        self.longest_s, self._last = 0.0, time.perf_counter()


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
    from terrainav.core.mission.area import Box
    from terrainav.core.mission.estimate import estimate
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan
    from terrainav.terrainav_plugin.map.mission_group import MissionGroup
    from terrainav.terrainav_plugin.map.preview import Preview
    from terrainav.terrainav_plugin.sources import costs_of, grid_of

    side = count**0.5 / 2.0
    north, south = LAT_DEG + side * STEP_LAT_DEG, LAT_DEG - side * STEP_LAT_DEG
    west, east = LON_DEG - side * STEP_LON_DEG, LON_DEG + side * STEP_LON_DEG
    mission = Mission(area=Box(north, west, south, east), agl_m=120.0)
    canvas, project = iface.mapCanvas(), QgsProject.instance()
    iface.newProject(False)
    project.setCrs(QgsCoordinateReferenceSystem("EPSG:3857"))
    start = time.perf_counter()
    planned = plan(mission, grid_of(mission))
    estimate(planned, costs_of(mission.source))
    plan_s = time.perf_counter() - start

    preview = Preview(project, canvas)
    left, bottom, right, top = planned.edges_m
    canvas.setExtent(QgsRectangle(left.min(), bottom.min(), right.max(), top.max()))
    settle()
    watch = Watch()
    settle(0.05)
    watch.reset()
    start = time.perf_counter()
    preview.show(MissionGroup(project, "benchmark", str(folder)), mission, planned)
    wait(preview)
    first_s = time.perf_counter() - start
    canvas.waitWhileRendering()
    settle()
    blocks, zooms, pans = [watch.longest_s], [], []
    most = _drawn(preview)

    def timed(act) -> float:
        nonlocal most
        settle(0.1)
        watch.reset()
        begin = time.perf_counter()
        act()
        wait(preview)
        seconds = time.perf_counter() - begin
        canvas.waitWhileRendering()
        settle(0.1)
        blocks.append(watch.longest_s)
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
    return Figures(len(planned), plan_s, first_s, zooms, pans, 1000.0 * max(blocks), most, memory_mb)


def _drawn(preview) -> int:
    return sum(len(features) for features in preview.drawing.layers.values())


def page(rows: list[Figures]) -> str:
    """Text of the page."""
    canvas = iface.mapCanvas()
    machine = (
        f"Machine: {os.cpu_count()} cores, {platform.system()}; QGIS {Qgis.QGIS_VERSION.partition('-')[0]}, "
    )
    machine += f"virtual screen, map {canvas.width()} x {canvas.height()} px."
    heads = "captures|plan, s|first preview, s|zoom, ms: median, longest|pan, ms: median, longest|longest block, ms"
    lines = [
        "# Preview",
        "",
        "Made by `python tools/qgis_app.py benchmarks/preview.py`; every figure is of one run on one machine.",
        "",
        machine,
        "",
        "A mission at 120 m is previewed whole, then zoomed into by steps of two, with four moves at each. A",
        "zoom or pan is the time from the event until all layers are filled, with the pause of 60 ms that the preview",
        "waits for the map to come to rest. The longest block is the longest time the event loop did not turn in all",
        "of that, QGIS's own drawing included. Features are those of all layers together, at most. Memory is the peak",
        "of the process, which only grows from one row to the next.",
        "",
        f"| {heads.replace('|', ' | ')} | features | memory, MB |",
        "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for row in rows:
        zoom, pan = (
            f"{sorted(times)[len(times) // 2]:.0f}, {max(times):.0f}" for times in (row.zooms_ms, row.pans_ms)
        )
        lines.append(
            f"| {row.captures:,} | {row.plan_s:.2f} | {row.first_s:.2f} | {zoom} | {pan} | {row.block_ms:.0f} "
            f"| {row.drawn:,} | {row.memory_mb:.0f} |"
        )
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
