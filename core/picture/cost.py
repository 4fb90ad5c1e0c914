"""Cost of the chosen methods on this machine, timed on captures of the plan, with blank tiles."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..arrays import PixelValues
from ..bands import RGB, Bands
from ..errors import Message
from ..geodesy.footprint import ground_corners
from ..imagery.source import Part, Window, tile_parts
from ..mission.plan import Plan
from ..timing import clock_step_s
from .camera_frame import camera_parts, render
from .map_frame import assemble, capture_window

#: Runs, at least, and steps of the clock that they take together: some systems' are of 16 ms.
_RUNS, _LEAST_STEPS = 3, 10


class Cost(NamedTuple):
    """Seconds on one core: all footprints of the plan, and one of its pictures, without fetching or encoding."""

    footprints_s: float
    picture_s: float

    def text(self, images: int) -> Message:
        """Words for people."""
        return Message(
            "footprints {0}, images {1} each, {2} of one core in all (timed here)",
            _time_text(self.footprints_s),
            _time_text(self.picture_s),
            _time_text(self.picture_s * images),
        )


def _time_text(seconds: float) -> Message:
    if seconds < 1e-3:
        return Message("{0:.0f} {1}", max(seconds, 1e-6) * 1e6, "µs")
    if seconds < 1.0:
        return Message("{0:.3g} {1}", seconds * 1000.0, "ms")
    return Message("{0:.3g} {1}", seconds, "s")


def timed_cost(plan: Plan, bands: Bands = RGB) -> Cost:
    """Time the chosen methods on captures of the plan, with the bands of their source: some ten pictures' worth."""
    # More cost no more per capture.
    few = plan.poses.take(np.arange(min(len(plan), 10_000)))
    camera, ground = plan.mission.camera, plan.ground
    footprints_s = _own_s(lambda: ground_corners(camera, few, ground)) * len(plan) / len(few.lat_deg)
    index = len(plan) // 2
    if plan.frames.on_map:
        window = capture_window(plan, index)
        parts = tile_parts(window._replace(left_px=round(window.left_px), top_px=round(window.top_px)), plan.grid)
        blank = _blank(parts, bands)
        return Cost(footprints_s, _own_s(lambda: assemble(window, parts, blank, bands)))
    view, lon = plan.views.view(index), float(plan.lon_deg[index])
    parts = camera_parts(view, lon)
    blank, resampling = _blank(parts, bands), plan.mission.accuracy.resampling
    seeing_s = 0.0
    if not plan.relief.is_level:
        # Over relief the view of each capture is made to find its tiles, and again to draw it.
        start = time.thread_time()
        plan.views.view(index)
        seeing_s = 2.0 * (time.thread_time() - start)
    return Cost(footprints_s, seeing_s + _own_s(lambda: render(view, lon, parts, blank, resampling, bands)))


def _blank(parts: list[Part], bands: Bands) -> dict[Window, PixelValues]:
    windows = [part.window for part in parts]
    return {window: np.zeros((window.height_px, window.width_px, len(bands)), bands.dtype) for window in windows}


def _own_s(work: Callable[[], object]) -> float:
    """Seconds that work takes of the processor, without what else the machine does meanwhile."""
    work()  # what is only made once
    least_s = _LEAST_STEPS * clock_step_s()
    runs, start = 0, time.thread_time()
    while runs < _RUNS or time.thread_time() - start < least_s:
        work()
        runs += 1
    return (time.thread_time() - start) / runs
