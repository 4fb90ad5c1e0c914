"""Frames in real time: each has a deadline, and says how old it is, whether it is late, and what stands in."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Floats
from ..errors import PartError, SourceError
from ..geodesy.mercator import PixelGrid
from ..imagery.source import Part, Window
from ..picture.camera_frame import parts_of_tiles
from .camera import FrameRequest, LiveCamera, LiveFrame, Prepared

#: Seconds ahead whose tiles are fetched, and between looks ahead.
_AHEAD_S, _LOOK_S = (0.5, 1.0, 1.5, 2.0, 3.0), 0.25
#: Seconds of poses that give a velocity, and the least of them; faster poses are jumps, metres per second.
_TRACK_S, _LEAST_TRACK_S, _FASTEST_M_S = 1.0, 0.05, 300.0
#: Least height above the level ground that stands in.
_LEAST_AGL_M = 1.0
#: Seconds until relief is tried again that took too long.
_RETRY_S = 1.0
#: Threads that read heights and trace rays for frames with a deadline.
_THREADS = 4


@dataclass(frozen=True, eq=False)
class TimedFrame:
    """A frame as a file, and when it was ready.

    Attributes
    ----------
    frame : LiveFrame
    data : bytes
    age_s : float
        Seconds from the arrival of the pose to the encoded frame.
    deadline_s : float or None
        Age that was allowed; None for a frame at full resolution, whenever it was ready.
    """

    frame: LiveFrame
    data: bytes
    age_s: float
    deadline_s: float | None = None

    @property
    def is_late(self) -> bool:
        """Whether the frame is older than allowed."""
        return self.deadline_s is not None and self.age_s > self.deadline_s

    def to_json(self) -> dict[str, Any]:
        """What the frame is, without its pixels."""
        timing = {"age_s": self.age_s, "deadline_s": self.deadline_s, "late": self.is_late}
        return {**self.frame.to_json(), **timing}


class RecentPoses:
    """Latest poses of one client, from which tiles ahead follow."""

    def __init__(self) -> None:
        self._poses: deque[tuple[float, float, float]] = deque()
        self.looked_s = -np.inf

    def add(self, at_s: float, request: FrameRequest) -> None:
        """Add a pose that arrived at a time."""
        self._poses.append((at_s, request.lat_deg, request.lon_deg))
        while at_s - self._poses[0][0] > _TRACK_S:
            self._poses.popleft()

    def per_s(self) -> tuple[float, float] | None:
        """Degrees of latitude and longitude per second; None if unknown, or if the poses jump."""
        (first_s, first_lat, first_lon), (last_s, last_lat, last_lon) = self._poses[0], self._poses[-1]
        passed_s = last_s - first_s
        if passed_s < _LEAST_TRACK_S:
            return None
        north, east = (last_lat - first_lat) / passed_s, (last_lon - first_lon) / passed_s
        metres = 111e3 * np.hypot(north, east * np.cos(np.radians(last_lat)))
        return (north, east) if metres <= _FASTEST_M_S else None


class RealTime:
    """A live camera whose frames are ready by a deadline, as well as they can be by then. Threads may share it.

    Over relief, level ground of the last known height stands in as long as heights are read or rays traced; tiles that
    are late or fail are stood in for by coarser ones.

    Parameters
    ----------
    clock : callable
        Seconds that never go back.
    """

    def __init__(self, camera: LiveCamera, clock: Callable[[], float] = time.monotonic) -> None:
        self.camera, self.clock = camera, clock
        self._pool = ThreadPoolExecutor(_THREADS, "terrainav-relief")
        self._behind: Future[Prepared] | None = None
        self._level_m = camera.mission.flight.ground_height_m
        # Seconds expected from tiles to the file, and from a pose to the tiles of level ground.
        self._drawing_s, self._levelling_s = 0.0, 0.0
        # Seconds that relief took last, and when it was tried last.
        self._tracing_s, self._tried_s = 0.0, -math.inf

    def frame(
        self,
        request: FrameRequest,
        encode: Callable[[LiveFrame], bytes],
        deadline_s: float | None = None,
        arrived_s: float | None = None,
        recent: RecentPoses | None = None,
    ) -> TimedFrame:
        """Make a frame.

        Parameters
        ----------
        encode : callable
            Makes the file of a frame.
        deadline_s : float or None
            Greatest age; None to wait for full resolution.
        arrived_s : float or None
            Time of the clock when the pose arrived; None for now.
        recent : RecentPoses or None
            Poses of the client; with a deadline, tiles ahead are fetched where the provider's terms allow it.

        Raises
        ------
        InvalidInput
            The pose is invalid.
        PartError, SourceError
            Without a deadline, imagery or heights are not available; with one, terms allow no further requests.
        """
        arrived_s = self.clock() if arrived_s is None else arrived_s
        if deadline_s is None:
            made = self.camera.take(request)
            return TimedFrame(made, encode(made), self.clock() - arrived_s)
        due_s = arrived_s + deadline_s
        prepared = self._prepared(request, due_s)
        ready = self.camera.tiles.until(prepared.parts, due_s - self.clock() - self._drawing_s)
        drawing_s = self.clock()
        made = self.camera.draw(prepared, ready)
        data = encode(made)
        ready_s = self.clock()
        self._drawing_s = _expected(self._drawing_s, ready_s - drawing_s)
        if recent is not None:
            recent.add(arrived_s, request)
            self._look_ahead(recent, request, prepared.parts)
        return TimedFrame(made, data, ready_s - arrived_s, deadline_s)

    def close(self) -> None:
        """Stop reading heights."""
        self._pool.shutdown(wait=False, cancel_futures=True)

    def _prepared(self, request: FrameRequest, due_s: float) -> Prepared:
        """Prepare a frame in time: over level ground if relief takes too long, or its heights cannot be had."""
        if self.camera.heights is None:
            return self.camera.prepare(request)
        left_s = due_s - self.clock() - self._drawing_s - self._levelling_s
        is_hopeless = self._tracing_s > left_s and self.clock() - self._tried_s < _RETRY_S
        # One that is behind goes on reading heights that later frames need; two would take turns.
        if not is_hopeless and (self._behind is None or self._behind.done()):
            self._tried_s = self.clock()
            preparing = self._pool.submit(self._traced, request)
            wait((preparing,), max(left_s, 0.0) if self._tracing_s <= left_s else 0.0)
            if preparing.done():
                with suppress(PartError, SourceError):
                    return preparing.result()
            self._behind = preparing
        begun_s, level_m = self.clock(), self._level_m
        if request.above_ellipsoid:
            # Valleys may be lower than the last known ground.
            level_m = min(level_m, request.up_m - _LEAST_AGL_M)
        levelled = self.camera.prepare(request, level_m)
        self._levelling_s = _expected(self._levelling_s, self.clock() - begun_s)
        return levelled

    def _traced(self, request: FrameRequest) -> Prepared:
        """Prepare a frame over relief."""
        begun_s = self.clock()
        try:
            prepared = self.camera.prepare(request)
        except (PartError, SourceError):
            # Frames do not wait until it has been had once.
            self._tracing_s = math.inf
            raise
        self._tracing_s = self.clock() - begun_s
        self._level_m = float(prepared.plan.ground_m[0])
        return prepared

    def _look_ahead(self, recent: RecentPoses, request: FrameRequest, parts: Sequence[Part]) -> None:
        """Begin to fetch the tiles that frames will show soon."""
        velocity, now_s = recent.per_s(), self.clock()
        if velocity is None or not self.camera.may_prefetch or now_s - recent.looked_s < _LOOK_S:
            return
        recent.looked_s = now_s
        grid, lat, lon = self.camera.source.grid, request.lat_deg, request.lon_deg
        lat_deg, lon_deg = (at + per_s * np.array((0.0, *_AHEAD_S)) for at, per_s in zip((lat, lon), velocity))
        u, v = grid.plane.forward(lat_deg, lon_deg)
        self.camera.tiles.keep_ahead(_moved(grid, parts, u[1:] - u[0], v[1:] - v[0]))


def _moved(grid: PixelGrid, parts: Sequence[Part], du: Floats, dv: Floats) -> list[Window]:
    """Tiles that parts cover once the ground has moved below them by shares of the world, (n,), the nearest first."""
    size, tiles = grid.tile_px, dict[tuple[int, int, int], None]()
    for right, down in zip(du.tolist(), dv.tolist()):
        for (zoom, *_), x_px, y_px in parts:
            world_px = grid.world_px(zoom)
            left, top = (x_px + right * world_px) / size, (y_px + down * world_px) / size
            for column in range(math.floor(left), math.ceil(left) + 1):
                for row in range(max(math.floor(top), 0), min(math.ceil(top), world_px // size - 1) + 1):
                    tiles[zoom, column, row] = None
    return [part.window for part in parts_of_tiles(grid, list(tiles))]


def _expected(before_s: float, last_s: float) -> float:
    """Seconds to allow for what took so long: quick to grow, slow to shrink."""
    return max(last_s, 0.9 * before_s + 0.1 * last_s)
