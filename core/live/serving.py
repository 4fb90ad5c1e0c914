"""Frames for many clients at once: a few at a time, with a bounded number of requests that wait."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import TypeVar

from ..errors import InvalidInput, TerrAInavError
from .camera import FrameRequest, LiveCamera, LiveFrame
from .realtime import RealTime

Made = TypeVar("Made")

#: Most requests that wait for a worker.
WAITING = 64


class BusyError(TerrAInavError):
    """More requests wait than the server accepts."""


def _follow_nothing() -> FrameRequest:
    raise InvalidInput(
        "follow: no vehicle sends its poses here", remedy="give where it sends them (--fdm or --mavlink)"
    )


class FrameServer:
    """A camera that many clients share; used from one event loop.

    Parameters
    ----------
    workers : int
        Frames made at once.
    most_waiting : int
        Requests that may wait; others are refused at once.

    Attributes
    ----------
    followed : callable
        Request for the frame of a vehicle's last pose; raises InvalidInput without one.
    video : str
        Address of the video stream; empty without one.
    """

    def __init__(self, camera: LiveCamera, workers: int = 1, most_waiting: int = WAITING) -> None:
        self.camera, self.real_time = camera, RealTime(camera)
        self._most_waiting, self._workers, self._under_way = most_waiting, workers, 0
        self.followed: Callable[[], FrameRequest] = _follow_nothing
        self.video = ""
        self._pool = ThreadPoolExecutor(workers, "terrainav-frames")

    async def frame(self, request: FrameRequest, wait_s: float | None = None) -> LiveFrame:
        """Take a picture; errors are those of `LiveCamera.take`.

        Raises
        ------
        BusyError
            Too many requests wait.
        """
        return await self.run(lambda: self.camera.take(request, wait_s))

    async def run(self, make: Callable[[], Made]) -> Made:
        """Run a function in a worker; it is not run if the caller has gone before its turn.

        Raises
        ------
        BusyError
            Too many requests wait.
        """
        if self._under_way >= self._workers + self._most_waiting:
            raise BusyError("busy: {0} requests wait; ask again later", self._most_waiting)
        self._under_way += 1
        try:
            return await asyncio.wrap_future(self._pool.submit(make))
        finally:
            self._under_way -= 1

    @property
    def follows(self) -> bool:
        """Whether there is a vehicle to follow."""
        return self.followed is not _follow_nothing

    @contextmanager
    def following(self, followed: Callable[[], FrameRequest]) -> Iterator[None]:
        """Follow a vehicle until the end of the block."""
        self.followed, before = followed, self.followed
        try:
            yield
        finally:
            self.followed = before

    def close(self) -> None:
        """Stop the workers; waiting requests are cancelled."""
        self._pool.shutdown(wait=False, cancel_futures=True)
        self.real_time.close()
        self.camera.tiles.close()
