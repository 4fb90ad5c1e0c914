"""QGIS's renderer on capture threads: complete images only, with cancellation and a time limit."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import contextmanager
from queue import SimpleQueue
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from qgis.core import (
    QgsHillshadeRenderer,
    QgsMapLayer,
    QgsMapRendererCustomPainterJob,
    QgsMapSettings,
    QgsRasterBlockFeedback,
    QgsRasterContourRenderer,
    QgsRasterInterface,
    QgsRasterLayer,
    QgsRasterPipe,
    QgsRasterProjector,
    QgsRasterRenderer,
    QgsRectangle,
)
from qgis.PyQt.QtGui import QImage, QPainter

from ...core.errors import Cancelled, Message, PartError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from qgis.core import QgsMapRendererJob

#: Longest time to draw a part, in s: twice QGIS's network timeout (60 s), for one retry, and a reserve.
LONGEST_JOB_S = 150.0
#: Time between checks of running jobs, in s.
_LOOK_S = 0.1
_CANCELLED, _WORDS = "cancelled", Message("cancelled while drawing the map")
_FORMAT = QImage.Format.Format_ARGB32_Premultiplied


class Jobs:
    """Draw layers, on any number of threads.

    All threads share the layers: only one job is prepared at a time, but jobs are drawn in parallel.
    """

    def __init__(self, longest_s: float = LONGEST_JOB_S) -> None:
        self._longest_s = longest_s
        self._lock = threading.Lock()
        self._none_running = threading.Condition(self._lock)
        self._running: set[_Job] = set()
        self._closed = threading.Event()
        self._watch: threading.Thread | None = None
        self.preparing = threading.Lock()

    def draw(
        self,
        image: QImage,
        settings: QgsMapSettings,
        layers: Sequence[QgsMapLayer],
    ) -> None:
        """Draw ``layers``, the uppermost first, onto ``image``.

        Raises
        ------
        PartError
            The renderer reports an error, or takes too long.
        Cancelled
        """
        settings.setLayers(list(layers))
        painter = QPainter(image)
        try:
            job = QgsMapRendererCustomPainterJob(settings, painter)
            with self.watched(job.cancelWithoutBlocking) as going_on:
                with self.preparing:
                    job.prepare()
                # The job has ignored a cancellation before its preparation.
                if not going_on():
                    job.cancelWithoutBlocking()
                job.renderPrepared()
        finally:
            painter.end()
        refuse_errors(job.errors())

    @contextmanager
    def watched(self, end: Callable[[], None]) -> Iterator[Callable[[], bool]]:
        """Limit the time of a drawing: call ``end``, perhaps repeatedly, when the drawing must stop.

        Yield a function that returns whether the drawing may continue; raise on exit as `draw` does.
        """
        job = _Job(end, time.monotonic() + self._longest_s)
        with self._lock:
            if self._closed.is_set():
                raise Cancelled(_WORDS)
            self._running.add(job)
            if self._watch is None:
                self._watch = threading.Thread(target=self._look, name="terrainav-draw", daemon=True)
                self._watch.start()
        try:
            yield lambda: not job.reason
        finally:
            with self._lock:
                self._running.discard(job)
                self._none_running.notify_all()
        if job.reason == _CANCELLED:
            raise Cancelled(_WORDS)
        if job.reason:
            raise PartError(job.reason)

    def close(self) -> None:
        """Cancel all drawings, so that `draw` raises `Cancelled`, and wait for their end."""
        self._closed.set()
        self._end_unwanted()
        with self._lock:
            self._none_running.wait_for(lambda: not self._running)

    def _look(self) -> None:
        """Cancel jobs that must stop; repeatedly, as a job being prepared ignores a cancellation."""
        while self._running or not self._closed.is_set():
            self._end_unwanted()
            if self._closed.wait(_LOOK_S):
                time.sleep(_LOOK_S)

    def _end_unwanted(self) -> None:
        with self._lock:
            for job in self._running:
                job.reason = job.reason or self._reason(job)
                if job.reason:
                    job.end()

    def _reason(self, job: _Job) -> str:
        if self._closed.is_set():
            return _CANCELLED
        if time.monotonic() > job.until_s:
            return Message("QGIS had not drawn it after {0:.0f} s", self._longest_s)
        return ""


def refuse_errors(errors: Sequence[QgsMapRendererJob.Error]) -> None:
    """Raise PartError with the first of a renderer's errors, if any."""
    messages = [error.message for error in errors if error.message]
    if messages:
        raise PartError("QGIS could not draw it: {0}", messages[0])


def blank(width_px: int, height_px: int) -> QImage:
    """Transparent image; raises PartError if it does not fit in memory."""
    image = QImage(width_px, height_px, _FORMAT)
    if image.isNull():
        raise PartError("image of {0}x{1} px: too large to be drawn", width_px, height_px)
    image.fill(0)
    return image


def to_array(image: QImage) -> NDArray[np.uint8]:
    """Premultiplied RGBA of an image, (height, width, 4) uint8."""
    plain = image.convertToFormat(QImage.Format.Format_RGBA8888_Premultiplied)
    height, width = plain.height(), plain.width()
    lines = np.frombuffer(plain.constBits().asstring(plain.sizeInBytes()), np.uint8)
    return lines.reshape(height, plain.bytesPerLine())[:, : 4 * width].reshape(height, width, 4)


def to_image(pixels: NDArray[np.uint8]) -> QImage:
    """Inverse of `to_array`."""
    height, width = pixels.shape[:2]
    data = np.ascontiguousarray(pixels).tobytes()
    image = QImage(data, width, height, 4 * width, QImage.Format.Format_RGBA8888_Premultiplied)
    # ``image`` uses memory that Python frees; the conversion makes a copy.
    return image.convertToFormat(_FORMAT)


class Pipes:
    """A layer and its pipes, one for each thread that draws the layer at the same time.

    Create and release on the main thread, which owns QGIS's providers: creating, wrapping or destroying a provider on
    another thread may crash QGIS.
    """

    def __init__(self, layer: QgsRasterLayer) -> None:
        self.layer = layer
        self._margin_px = _margin_px(layer.renderer())
        self._idle: SimpleQueue[_Pipe] = SimpleQueue()
        # One pipe for each connection of a capture; further threads wait.
        for _ in range(8):
            pipe = _copy(layer.pipe())
            self._idle.put(_Pipe(pipe, pipe.last()))

    def block(
        self,
        extent: QgsRectangle,
        size: tuple[int, int],
        jobs: Jobs,
    ) -> NDArray[np.uint8]:
        """Premultiplied pixels of an extent in the layer's CRS, (height, width, 4) uint8.

        Raises
        ------
        PartError
            The layer cannot be read, or takes too long.
        Cancelled
        """
        feedback = QgsRasterBlockFeedback()
        margin, (width, height) = self._margin_px, size
        east, north = margin * extent.width() / width, margin * extent.height() / height
        extent = QgsRectangle(
            extent.xMinimum() - east,
            extent.yMinimum() - north,
            extent.xMaximum() + east,
            extent.yMaximum() + north,
        )
        pipe = self._idle.get()
        try:
            with jobs.watched(feedback.cancel):
                block = pipe.last.block(1, extent, width + 2 * margin, height + 2 * margin, feedback)
        finally:
            self._idle.put(pipe)
        if feedback.errors():
            raise PartError("QGIS could not read it: {0}", feedback.errors()[0])
        image = block.image()
        if not block.isValid() or image.isNull():
            raise PartError("QGIS could not read it: {0}", block.error().summary() or Message("no reason given"))
        return to_array(image)[margin : margin + height, margin : margin + width]


class _Job:
    """A running drawing: how to end it, its time limit, and why it was ended."""

    def __init__(self, end: Callable[[], None], until_s: float) -> None:
        self.end, self.until_s = end, until_s
        self.reason = ""


class _Pipe(NamedTuple):
    """A pipe and its last stage, which returns the pixels; both wrapped on the main thread (see `Pipes`)."""

    pipe: QgsRasterPipe
    last: QgsRasterInterface


def _margin_px(renderer: QgsRasterRenderer) -> int:
    """Margin in pixels to draw around a block so that its style shows no seams."""
    if isinstance(renderer, QgsHillshadeRenderer):
        return 1
    if isinstance(renderer, QgsRasterContourRenderer):
        # QGIS draws contours on a coarser grid, and reads two of its pixels around a block.
        return 2 * math.ceil(renderer.downscale())
    return 0


def _copy(pipe: QgsRasterPipe) -> QgsRasterPipe:
    """Pipe for one thread at a time, without reprojection."""
    copy = QgsRasterPipe()
    for index in range(pipe.size()):
        stage = pipe.at(index)
        if not isinstance(stage, QgsRasterProjector):
            copy.set(stage.clone())
    # The resampling stage is a setting of the pipe, not copied with its stages.
    copy.setResamplingStage(pipe.resamplingStage())
    return copy
