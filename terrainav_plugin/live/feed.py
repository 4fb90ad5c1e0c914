"""Pictures of the newest pose, taken in the background: first what is there in time, then at full resolution."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from qgis.PyQt.QtCore import QObject, pyqtSignal

from ...core.errors import Cancelled
from ..tasks import LatestWorker

if TYPE_CHECKING:
    from ...core.live.camera import FrameRequest
    from .source import LiveImage, LiveSource

#: Time in which a picture is made, with coarser tiles and level ground for what is not there by then.
DEADLINE_S = 0.25


class LiveFeed(QObject):
    """Take pictures one after another; of poses that come meanwhile, only the newest is taken.

    Signals
    -------
    shown(object)
        A `LiveImage`.
    failed(object)
        The error of the newest pose.
    """

    shown = pyqtSignal(object)
    failed = pyqtSignal(object)

    def __init__(self) -> None:
        super().__init__()
        self._source: LiveSource | None = None
        self._wanted: FrameRequest | None = None
        self._in_time, self._whole = LatestWorker("live", self), LatestWorker("live-whole", self)
        for worker in (self._in_time, self._whole):
            worker.failed.connect(self._fail)

    @property
    def busy(self) -> bool:
        """Whether a picture, or a better one, is pending."""
        return self._wanted is not None or self._in_time.is_awaited or self._whole.is_awaited

    @property
    def is_open(self) -> bool:
        """Whether there is a source of pictures."""
        return self._source is not None

    def open(self, source: LiveSource) -> None:
        """Take pictures of a source, in place of an earlier one."""
        self.stop()
        self._source = source

    def forget(self) -> None:
        """Emit no more pictures of poses so far."""
        self._wanted = None
        for worker in (self._in_time, self._whole):
            worker.forget()

    def stop(self) -> None:
        """Close the source, and emit no more pictures of it."""
        self.forget()
        source, self._source = self._source, None
        if source is not None:
            source.close()

    def close(self) -> None:
        """Stop for good."""
        self.stop()
        for worker in (self._in_time, self._whole):
            worker.close()

    def ask(self, request: FrameRequest) -> None:
        """Ask for the picture of a pose, in place of earlier ones that are not begun."""
        if self._source is not None:
            self._wanted = request
            self._whole.forget()
            self._take_next()

    def _take_next(self) -> None:
        if self._source is None or self._wanted is None or self._in_time.is_awaited:
            return
        request, self._wanted = self._wanted, None
        self._in_time.ask(partial(self._source.take, request, DEADLINE_S), self._show)

    def _show(self, taken: LiveImage) -> None:
        if self._source is not None and self._wanted is None and taken.coarse_share > 0.0:
            self._whole.ask(partial(self._source.take, taken.request, None), self.shown.emit)
        self.shown.emit(taken)
        self._take_next()

    def _fail(self, error: Exception) -> None:
        if not isinstance(error, Cancelled):
            self.failed.emit(error)
        self._take_next()
