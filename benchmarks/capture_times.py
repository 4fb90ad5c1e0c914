"""Estimated times of captures with their mosaics, as QGIS makes both, against the times that they take.

    python benchmarks/capture_times.py

Over the embedded world, and over a tile server on the loopback with a latency of 60 ms, as estimates assume. The last
column is the processor time of both, per processor: on a busy machine, ratios grow and it does not. Needs the Python
packages of GDAL and QGIS. ``TERRAINAV_FAST=0`` leaves numba out, as most QGIS have none.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from contextlib import closing, nullcontext
from pathlib import Path

from terrainav.core.capture.runner import capture
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.estimate import OFFLINE, ONLINE, estimate
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights
from terrainav.terrainav_plugin.dataset.mosaic import build_any_mosaics

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from tests.support.tileserver import TileServer  # noqa: E402

RELIEF = {"elevation": ("world",), "frame": "camera"}
OVERLAPS = {"overlap_along": 0.8, "overlap_across": 0.7}
#: Degrees of latitude of the area, whether tiles come from a server, and options.
MISSIONS = {
    "map frames": (0.02, False, {}),
    "map frames, JPEG": (0.02, False, {"image_format": "jpg"}),
    "map frames, overlaps": (0.008, False, OVERLAPS),
    "map frames, server": (0.02, True, {}),
    "rotated": (0.006, False, {"yaw_deg": 30.0}),
    "rotated, overlaps": (0.003, False, {"yaw_deg": 30.0, **OVERLAPS}),
    "tilted": (0.004, False, {"tilt_deg": 30.0}),
    "tilted, 4000 px": (0.002, False, {"tilt_deg": 20.0, "image_px": 4000}),
    "tilted, server": (0.004, True, {"tilt_deg": 30.0}),
    "relief": (0.002, False, RELIEF),
    "relief, tilted": (0.001, False, {**RELIEF, "tilt_deg": 30.0}),
}


def main() -> None:
    """Print a line for each mission."""
    cores = os.cpu_count() or 1
    print(f"{'mission':22} {'images':>6} {'estimate':>16} {'real':>16} {'ratio':>6} {'processors':>11}  seconds")
    for title, (size_deg, is_served, options) in MISSIONS.items():
        with TileServer() if is_served else nullcontext() as server, tempfile.TemporaryDirectory() as place:
            name = "world"
            if is_served:
                server.latency_s, name = 0.06, server.url_template
            area = Box(35.14, -89.87, 35.14 - size_deg, -89.87 + 1.2 * size_deg)
            mission, source = Mission(area, 120.0, source=name, **options), named_source(name)
            made = plan(mission, source.grid, mission_heights(mission))
            expected = estimate(made, ONLINE if is_served else OFFLINE, cores=cores)
            marks = [(time.perf_counter(), time.process_time())]
            with closing(source.open()) as opened:
                capture(made, opened, Path(place) / "dataset")
            marks.append((time.perf_counter(), time.process_time()))
            build_any_mosaics(made, Path(place) / "dataset", mission_heights, lambda _share: True)
            marks.append((time.perf_counter(), time.process_time()))
        real_s = [after[0] - before[0] for before, after in zip(marks, marks[1:])]
        ratio = sum(real_s) / (expected.seconds + expected.mosaic_s)
        processors_s = (marks[2][1] - marks[0][1]) / cores
        print(
            f"{title:22} {len(made):6} {expected.seconds:7.1f} + {expected.mosaic_s:6.1f} "
            f"{real_s[0]:7.1f} + {real_s[1]:6.1f} {ratio:6.2f} {processors_s:11.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
