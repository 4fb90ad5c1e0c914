"""Processor time of a plan's methods on this machine, measured on its captures with blank tiles."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..arrays import PixelValues
from ..bands import RGB, Bands
from ..errors import Message
from ..external.compiling import uses_numba
from ..geodesy.footprint import ground_corners
from ..imagery.source import Part, Window, tile_parts
from ..mission.plan import Plan
from ..timing import clock_step_s
from .camera_frame import camera_parts, load_code, parts_of_tiles, render
from .map_frame import assemble, capture_window
from .shot import Shot

#: Seconds from which on the first run is good enough: filling caches is a small part of it.
_LONG_S = 1.0


class Cost(NamedTuple):
    """Seconds on one core of all footprints of a plan and of one picture, without fetching or encoding.

    ``relief_by`` is what follows rays over relief, numba or numpy; empty over level ground.
    """

    footprints_s: float
    picture_s: float
    relief_by: str = ""

    def text(self, images: int) -> Message:
        """Text for users."""
        by = Message("timed here, over relief with {0}", self.relief_by) if self.relief_by else Message("timed here")
        return Message(
            "footprints {0}, images {1} each, {2} of one core in all ({3})",
            _time_text(self.footprints_s),
            _time_text(self.picture_s),
            _time_text(self.picture_s * images),
            by,
        )


def _time_text(seconds: float) -> Message:
    if seconds < 1e-3:
        return Message("{0:.0f} {1}", max(seconds, 1e-6) * 1e6, "µs")
    if seconds < 1.0:
        return Message("{0:.3g} {1}", seconds * 1000.0, "ms")
    return Message("{0:.3g} {1}", seconds, "s")


def timed_cost(plan: Plan, bands: Bands = RGB) -> Cost:
    """Measure the chosen methods; takes the time of some ten pictures, or of one that takes long.

    Raises
    ------
    Cancelled
        The enclosing `waiting.cancellable` is cancelled.
    """
    # The time of a capture does not depend on their number.
    few = plan.poses.take(np.arange(min(len(plan), 10_000)))
    camera, ground = plan.mission.camera, plan.ground
    footprints_s = _processor_s(lambda: ground_corners(camera, few, ground)) * len(plan) / len(few.lat_deg)
    index = len(plan) // 2
    if plan.frames.on_map:
        window = capture_window(plan, index)
        parts = tile_parts(window._replace(left_px=round(window.left_px), top_px=round(window.top_px)), plan.grid)
        blank = _blank(parts, bands)
        return Cost(footprints_s, _processor_s(lambda: assemble(window, parts, blank, bands)))
    load_code(plan)
    relief_by = "" if plan.relief.is_level else "numba" if uses_numba() else "numpy"
    if plan.mission.takes_time:
        parts = parts_of_tiles(plan.grid, Shot(plan, index).tiles)
        # Blur is for colours of 8 bits; a capture refuses others.
        bands = bands if bands.are_colours else RGB
        blank = _blank(parts, bands)
        return Cost(footprints_s, _processor_s(lambda: Shot(plan, index).draw(parts, blank, bands)), relief_by)
    view, lon = plan.views.view(index), float(plan.lon_deg[index])
    parts = camera_parts(view, lon)
    blank, resampling = _blank(parts, bands), plan.mission.accuracy.resampling
    views_s = 0.0
    if not plan.relief.is_level:
        # Over relief, captures share no view.
        start = time.thread_time()
        plan.views.view(index)
        views_s = time.thread_time() - start
    render_s = _processor_s(lambda: render(view, lon, parts, blank, resampling, bands))
    return Cost(footprints_s, views_s + render_s, relief_by)


def _blank(parts: list[Part], bands: Bands) -> dict[Window, PixelValues]:
    windows = [part.window for part in parts]
    return {window: np.zeros((window.height_px, window.width_px, len(bands)), bands.dtype) for window in windows}


def _processor_s(work: Callable[[], object]) -> float:
    """Mean processor time of work, in seconds."""
    start = time.thread_time()
    work()  # fills caches
    first_s = time.thread_time() - start
    if first_s > _LONG_S:
        return first_s
    # At least three runs, and ten steps of the clock, each 16 ms on some systems.
    least_s = 10 * clock_step_s()
    runs, start = 0, time.thread_time()
    while runs < 3 or time.thread_time() - start < least_s:
        work()
        runs += 1
    return (time.thread_time() - start) / runs
