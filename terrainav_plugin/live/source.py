"""The camera of a mission as the panel has it, and its pictures for the screen. On any thread; no widgets."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple

from qgis.core import QgsGeometry
from qgis.PyQt.QtGui import QImage

from ...core.errors import Cancelled, InvalidInput
from ...core.waiting import cancellable
from ..dataset.picture import picture_image
from ..map.outlines import footprint_shapes
from ..sources import (
    credentials_problem,
    mission_heights,
    mission_snapshot,
    open_for_capture,
    source_key,
    source_transport,
)

if TYPE_CHECKING:
    from ...core.live.camera import FrameRequest, LiveFrame
    from ...core.live.realtime import RealTime
    from ...core.mission.methods import ChosenMethods
    from ...core.mission.mission import Mission


class LiveImage(NamedTuple):
    """A picture for the screen.

    Parameters
    ----------
    request : FrameRequest
    image : QImage
    footprint : QgsGeometry
        Ground that the camera sees, in ``crs``.
    crs : str
    agl_m, ground_m : float
        Height of the camera above ground, and of the ground above the ellipsoid.
    accuracy : ChosenMethods
    coarse_share : float
        Share of the pixels that are not at full resolution.
    is_levelled : bool
        Whether level ground stands in for relief that is not read yet; then the error is unknown.
    made_s : float
    """

    request: FrameRequest
    image: QImage
    footprint: QgsGeometry
    crs: str
    agl_m: float
    ground_m: float
    accuracy: ChosenMethods
    coarse_share: float
    is_levelled: bool
    made_s: float


class LiveSource:
    """Camera and imagery of a mission; opened by the first picture. Create and close on the main thread.

    Parameters
    ----------
    mission : Mission
        Mission of one imagery.

    Raises
    ------
    TerrAInavError
        The source cannot be used.
    """

    def __init__(self, mission: Mission) -> None:
        source = mission.imagery.source
        problem = credentials_problem(source)
        if problem:
            raise InvalidInput(problem)
        self.mission = mission
        self._key = source_key(source)
        self._snapshot = mission_snapshot(mission)
        self._transport = source_transport(source)
        self._lock = threading.Lock()
        self._camera: RealTime | None = None
        self._closed = False

    def take(self, request: FrameRequest, deadline_s: float | None, overtaken: Callable[[], bool]) -> LiveImage:
        """Take a picture.

        Parameters
        ----------
        deadline_s : float or None
            Time in which it is made as well as it can be; None to wait for relief and full resolution.

        Raises
        ------
        TerrAInavError
            The pose is invalid, or its imagery or heights are not available.
        Cancelled
            The source is closed, or the request is overtaken.
        """
        with cancellable(lambda: overtaken() or self._closed):
            return _live_image(self._opened().frame(request, _no_file, deadline_s).frame)

    def close(self) -> None:
        """Stop all requests."""
        self._closed = True
        self._transport.close()
        # While another thread opens the camera, which may take the main thread's help, that thread closes it.
        if not self._lock.acquire(blocking=False):
            return
        try:
            camera, self._camera = self._camera, None
        finally:
            self._lock.release()
        if camera is not None:
            camera.close()
            camera.camera.tiles.close()
            camera.camera.source.close()

    def _opened(self) -> RealTime:
        """The camera, opened once for all threads."""
        with self._lock:
            camera = self._camera
            if camera is None and not self._closed:
                camera = self._camera = self._open()
        if self._closed:
            self.close()
        if camera is None or self._closed:
            raise Cancelled("live view: closed")
        return camera

    def _open(self) -> RealTime:
        from ...core.live.camera import LiveCamera
        from ...core.live.realtime import RealTime

        source = open_for_capture(self.mission, self._key, transport=self._transport, snapshot=self._snapshot)
        try:
            return RealTime(LiveCamera(self.mission, source, mission_heights(self.mission)))
        except BaseException:
            with suppress(Exception):
                source.close()
            raise


def _no_file(_frame: LiveFrame) -> bytes:
    """No encoding, as the picture is shown from memory."""
    return b""


def _live_image(frame: LiveFrame) -> LiveImage:
    plan = frame.plan
    ground_m = float(plan.ground_m[0])
    shapes = list(footprint_shapes(plan))
    return LiveImage(
        frame.request,
        picture_image(frame.picture, masked=frame.job.masked),
        shapes[0] if shapes else QgsGeometry(),
        plan.grid.plane.crs,
        frame.height_m - ground_m,
        ground_m,
        plan.accuracy,
        frame.coarse_share,
        frame.level_m is not None,
        frame.made_s,
    )
