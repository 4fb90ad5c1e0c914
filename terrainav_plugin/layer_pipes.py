"""Pixels of a raster layer as it is styled, straight from its pipe: asked for by extent, none is moved."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from qgis.core import QgsRasterBlockFeedback, QgsRasterLayer, QgsRasterPipe, QgsRasterProjector, QgsRectangle
from qgis.PyQt.QtCore import QCoreApplication, QObject

from ..core.errors import PartError
from .layer_jobs import Jobs, to_array


class Pipes:
    """A layer, and its pipes: one for each thread that draws it at the same time.

    Made and let go of on the main thread, which QGIS's providers belong to: one that is destroyed on another thread
    while the main one goes on may end QGIS.
    """

    def __init__(self, layer: QgsRasterLayer) -> None:
        self.layer = layer
        self._idle: list[QgsRasterPipe] = []

    def block(
        self,
        extent: QgsRectangle,
        size: tuple[int, int],
        jobs: Jobs,
        cancelled: Callable[[], bool] | None = None,
    ) -> NDArray[np.uint8]:
        """Premultiplied pixels of an extent in the layer's own CRS, (height, width, 4) uint8.

        Raises
        ------
        PartError
            The layer cannot be read, or it takes too long.
        Cancelled
        """
        feedback = QgsRasterBlockFeedback()
        with jobs.preparing:
            pipe = self._idle.pop() if self._idle else _copy(self.layer.pipe())
        try:
            with jobs.watched(feedback.cancel, cancelled):
                block = pipe.last().block(1, extent, *size, feedback)
        finally:
            self._idle.append(pipe)
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
            clone = stage.clone()
            if isinstance(clone, QObject):
                clone.moveToThread(QCoreApplication.instance().thread())
            copy.set(clone)
    return copy
