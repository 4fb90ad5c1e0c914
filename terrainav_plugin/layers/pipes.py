"""Pixels of a raster layer as it is styled, straight from its pipe: asked for by extent, none is moved."""

from __future__ import annotations

from queue import SimpleQueue
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from qgis.core import (
    QgsRasterBlockFeedback,
    QgsRasterInterface,
    QgsRasterLayer,
    QgsRasterPipe,
    QgsRasterProjector,
    QgsRectangle,
)

from ...core.errors import PartError
from .jobs import Jobs, to_array

#: Copies of a layer's pipe: as many as a capture has connections. More threads than these wait for one another.
_COPIES = 8


class _Pipe(NamedTuple):
    """A pipe and its last stage, which gives the pixels; wrapped once, as wrapping is not safe on other threads."""

    pipe: QgsRasterPipe
    last: QgsRasterInterface


class Pipes:
    """A layer, and its pipes: one for each thread that draws it at the same time.

    Made and let go of on the main thread, which QGIS's providers belong to: one that is made, wrapped or destroyed on
    another thread while the main one goes on may end QGIS.
    """

    def __init__(self, layer: QgsRasterLayer) -> None:
        self.layer = layer
        self._idle: SimpleQueue[_Pipe] = SimpleQueue()
        for _ in range(_COPIES):
            pipe = _copy(layer.pipe())
            self._idle.put(_Pipe(pipe, pipe.last()))

    def block(
        self,
        extent: QgsRectangle,
        size: tuple[int, int],
        jobs: Jobs,
    ) -> NDArray[np.uint8]:
        """Premultiplied pixels of an extent in the layer's own CRS, (height, width, 4) uint8.

        Raises
        ------
        PartError
            The layer cannot be read, or it takes too long.
        Cancelled
        """
        feedback = QgsRasterBlockFeedback()
        pipe = self._idle.get()
        try:
            with jobs.watched(feedback.cancel):
                block = pipe.last.block(1, extent, *size, feedback)
        finally:
            self._idle.put(pipe)
        if feedback.errors():
            raise PartError(f"QGIS could not read it: {feedback.errors()[0]}")
        image = block.image()
        if not block.isValid() or image.isNull():
            raise PartError(f"QGIS could not read it: {block.error().summary() or 'no reason given'}")
        return to_array(image)


def _copy(pipe: QgsRasterPipe) -> QgsRasterPipe:
    """Pipe for one thread at a time, without reprojection."""
    copy = QgsRasterPipe()
    for index in range(pipe.size()):
        stage = pipe.at(index)
        if not isinstance(stage, QgsRasterProjector):
            copy.set(stage.clone())
    return copy
