"""One capture of a plan, and the pictures that any method makes of it, with their seconds."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import PartError
from ..geodesy.accuracy import Scene
from ..geodesy.frames import map_windows
from ..geodesy.view import view
from ..imagery.source import Window
from ..mission.layout.framing import ground_of, sampled_zooms
from ..mission.plan import Plan
from ..picture.camera_frame import camera_parts, render
from ..picture.map_frame import assemble, resized, window_of
from ..timing import Effort, Seconds, timed_together
from .geometry import scene_of, spread
from .greys import file_bytes
from .tiles import Tiles

Pixels = NDArray[np.uint8]

#: Kernel that only single samples can have: it needs a ray for every pixel.
BY_RAYS = "lanczos"
#: Larger pictures are timed on so many pixels of theirs, and the time is scaled: a report must end.
_MOST_PX = 2_000_000
#: Captures that are tried for a picture where parts of the source are missing.
_TRIES = 3


class Way(NamedTuple):
    """How a camera frame is made: tolerance of its mesh in px (0 for rays) and kernel."""

    tolerance_px: float
    kernel: str


class Made(NamedTuple):
    """Seconds that a capture's picture takes, and the bytes of its file."""

    seconds: Seconds
    size_bytes: int


@dataclass(frozen=True)
class Bench:
    """What pictures are timed on.

    Attributes
    ----------
    plan : Plan
    tiles : Tiles
    effort : Effort
    index : int
        Of the capture.
    """

    plan: Plan
    tiles: Tiles
    effort: Effort
    index: int = 0

    @classmethod
    def of(cls, plan: Plan, tiles: Tiles, effort: Effort) -> Bench:
        """Bench of a capture whose picture the source has: the one in the middle, or another.

        Raises
        ------
        PartError, SourceError
            Where none can be had.
        """
        tries = [len(plan) // 2, *spread(len(plan), _TRIES).tolist()]
        for index in tries[:-1]:
            found = cls(plan, tiles, effort, index)
            try:
                found.own_picture()
            except PartError:
                continue
            return found
        last = cls(plan, tiles, effort, tries[-1])
        last.own_picture()
        return last

    @property
    def planned_px(self) -> tuple[int, int]:
        """Planned width and height of the capture's picture."""
        return int(self.plan.width_px[self.index]), int(self.plan.height_px[self.index])

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of the pictures that are timed: as planned, or of fewer pixels where those are many."""
        width, height = self.planned_px
        shrink = math.sqrt(min(_MOST_PX / (width * height), 1.0))
        return max(round(width * shrink), 1), max(round(height * shrink), 1)

    @property
    def enlarged(self) -> float:
        """Pixels of the planned picture for each one that is timed."""
        (width, height), (own_width, own_height) = self.planned_px, self.size_px
        return width * height / (own_width * own_height)

    @property
    def lon_deg(self) -> float:
        """Of the capture's camera."""
        return float(self.plan.lon_deg[self.index])

    def _scene(self) -> Scene:
        width, height = self.size_px
        scene = scene_of(self.plan, np.array([self.index], np.intp))
        return replace(scene, width_px=float(width), height_px=float(height))

    def camera_frames(self, ways: Sequence[Way], *, map_frame: bool) -> tuple[list[Made], Made | None]:
        """Camera frames of the capture and, if asked for, its map frame, timed in the same rounds.

        The captures of a row share their view, whose seconds count once a row.
        """
        plan, scene = self.plan, self._scene()
        zooms, rows = sampled_zooms(plan.mission, plan.grid), len(plan.poses.runs()[0])
        kinds = list(dict.fromkeys((way.tolerance_px, way.kernel == BY_RAYS) for way in ways))
        looks = [partial(view, scene, plan.grid, zooms, kind[0], by_rays=kind[1]) for kind in kinds]
        seen = {kind: look() for kind, look in zip(kinds, looks)}
        draws: list[Callable[[], Pixels]] = []
        for way in ways:
            one = seen[way.tolerance_px, way.kernel == BY_RAYS]
            parts = camera_parts(one, self.lon_deg)
            draws.append(partial(render, one, self.lon_deg, parts, self.tiles.of(parts), way.kernel))
        if map_frame:
            draws.append(self._map_frame())
        works: list[Callable[[], Any]] = [*looks, *draws]
        done = timed_together(works, self.effort)
        looking = {kind: seconds for kind, (_, seconds) in zip(kinds, done)}
        found = []
        for way, (picture, drawing) in zip(ways, done[len(kinds) :]):
            seconds = drawing + looking[way.tolerance_px, way.kernel == BY_RAYS] * (rows / len(plan))
            found.append(Made(seconds * self.enlarged, self._file_bytes(picture)))
        if not map_frame:
            return found, None
        picture, seconds = done[-1]
        return found, Made(seconds * self.enlarged, self._file_bytes(picture))

    def _map_frame(self) -> Callable[[], Pixels]:
        """What makes the map frame of the capture."""
        plan = self.plan
        if plan.size_px is None:
            window = window_of(plan, self.index)
        else:
            pose = plan.poses.take(np.array([self.index]))
            windows = map_windows(plan.mission.camera, pose, plan.grid, plan.zoom, ground_of(plan.mission))
            left, top, width, height = (part[0].item() for part in windows)
            window = Window(plan.zoom, left, top, width, height)
        if self.enlarged > 1.0 and plan.grid.centre_decimals is None:
            window = _middle(window, self.size_px)
        parts = self.tiles.source.parts(window)
        return partial(assemble, window, parts, self.tiles.of(parts))

    def own_picture(self) -> Pixels:
        """Picture of the capture by the plan's own methods, at the size that it is written in."""
        plan = self.plan
        if plan.size_px is None:
            return resized(self._map_frame()(), plan.mission.img_size)
        scene, zooms = self._scene(), sampled_zooms(plan.mission, plan.grid)
        kernel, tolerance = plan.mission.resampling, plan.accuracy.mesh_tolerance_px
        seen = view(scene, plan.grid, zooms, tolerance, by_rays=kernel == BY_RAYS)
        parts = camera_parts(seen, self.lon_deg)
        picture = render(seen, self.lon_deg, parts, self.tiles.of(parts), kernel)
        return resized(picture, plan.mission.img_size)

    def _file_bytes(self, picture: Pixels) -> int:
        """Bytes of a picture's file in the mission's format and at its size."""
        plan, source = self.plan, self.tiles.source
        sized = resized(picture, plan.mission.img_size)
        found = file_bytes(plan, source, self.index, self.tiles.map_type, sized)
        return found if plan.mission.img_size else round(found * self.enlarged)


def _middle(window: Window, size_px: tuple[int, int]) -> Window:
    """The middle of a window, no larger than a size."""
    width, height = (min(own, most) for own, most in zip(window[3:], size_px))
    left = window.left_px + (window.width_px - width) // 2
    top = window.top_px + (window.height_px - height) // 2
    return Window(window.zoom, left, top, width, height)
