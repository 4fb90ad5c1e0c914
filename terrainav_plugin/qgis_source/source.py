"""A layer of the project, or its whole map, as a source: drawn by QGIS off the main thread.

A raster file in a projected CRS is drawn, in its style, on its pixel grid; everything else on the map's grid.

There are two kinds of layers. *Ground* layers are rasters that have only rasters below them; they look the same
whatever extent is drawn. They are drawn tile by tile on the global pixel grid, each tile once (in larger images, QGIS
3.22 sometimes duplicates a row of a service's tiles). *Drawings* are all layers above the ground; QGIS places their
labels anew for each extent. They are drawn over a whole image at once, so that tile edges cut no label or symbol, and
with a margin, so that labels and symbols that cross the image's edge continue in the next image.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Iterable
from concurrent.futures import Future

import numpy as np
from numpy.typing import NDArray
from qgis.core import QgsMapLayer, QgsMapSettings, QgsRectangle
from qgis.PyQt.QtCore import QSize
from qgis.PyQt.QtGui import QColor, QImage, QPainter

from ...core.arrays import Bytes
from ...core.errors import PartError
from ...core.imagery.source import Part, Window, tile_parts
from .renderer import Jobs, Pipes, blank, to_array, to_image
from .sampling import averaged, resamples_early, sampled
from .snapshot import FILE_PROVIDER, Snapshot
from .tiles import ServerTiles

#: Default blend mode of layers.
_COVERING = QPainter.CompositionMode.CompositionMode_SourceOver


class LayerSource:
    """The layers of a `Snapshot`, as a `Source`.

    Parameters
    ----------
    snapshot : Snapshot
    jobs : Jobs or None
        None creates new `Jobs`.
    """

    map_types: tuple[str, ...] = ()

    def __init__(self, snapshot: Snapshot, jobs: Jobs | None = None) -> None:
        self.name, self.title = snapshot.name, snapshot.title
        self.attribution, self.date = snapshot.attribution, snapshot.date
        self.grid, self.policy = snapshot.grid, snapshot.policy
        self._snapshot = snapshot
        self._jobs = jobs or Jobs()
        self._tiles: OrderedDict[Window, Future[Bytes]] = OrderedDict()
        self._lock = threading.Lock()
        paper = snapshot.paper
        self._paper = np.array([paper.red(), paper.green(), paper.blue()], np.uint16)

    def parts(self, window: Window) -> list[Part]:
        """Return the tiles of a window; the whole window if there are drawings, which must not be cut."""
        if not self._snapshot.drawing:
            return tile_parts(window, self.grid)
        left_px = window.left_px % self.grid.world_px(window.zoom)
        return [Part(window._replace(left_px=left_px), 0, 0)]

    def fetch(self, map_type: str, part: Window) -> Bytes:  # noqa: ARG002
        """Pixels of a part, (height_px, width_px, 3) uint8, or 4 channels if some are missing.

        Raises
        ------
        PartError
            QGIS reports an error or takes too long, or there are no drawings here.
        Cancelled
            Within half a second of `close`.
        """
        if not self._snapshot.drawing:
            shown = self._tile(part)
            return self._on_paper(shown, shown[..., 3] == 0)
        ground = self._ground(part) if self._snapshot.ground else None
        none = np.zeros((part.height_px, part.width_px, 4), np.uint8)
        shown = self._draw_above(none if ground is None else ground, part)
        missing = np.zeros(shown.shape[:2], bool)
        if ground is not None:
            # Where a service returned nothing, pixels count as missing even below drawings.
            served = any(drawn.layer.providerType() != FILE_PROVIDER for drawn in self._snapshot.ground)
            missing = (ground if served else shown)[..., 3] == 0
        elif not shown[..., 3].any():
            # Between features the paper is shown, but an image without any feature is refused.
            raise PartError("{0} shows nothing here", self.title)
        if _any_blended(self._snapshot.drawing):
            below = self._on_paper(none if ground is None else ground, np.zeros_like(missing))
            shown = self._draw_above(np.dstack([below, np.full_like(below[..., :1], 255)]), part)
        return self._on_paper(shown, missing)

    def _draw_above(self, below: Bytes, part: Window) -> Bytes:
        """Drawings over the image below, premultiplied."""
        image, settings = to_image(below), self._settings(part)
        # Symbols and labels of features up to 128 px outside may reach into the image.
        settings.setExtentBuffer(128 * self.grid.pixel_size(part.zoom)[0])
        self._jobs.draw(image, settings, self._snapshot.drawing)
        return to_array(image)

    def close(self) -> None:
        """Cancel all drawings, so that `fetch` raises `Cancelled`."""
        for layer in self._snapshot.ground:
            if isinstance(layer, ServerTiles):
                layer.close()
        self._jobs.close()

    def _on_paper(self, shown: Bytes, missing: NDArray[np.bool_]) -> Bytes:
        """Premultiplied pixels over the background colour, with an alpha channel for missing imagery."""
        alpha = shown[..., 3]
        picture = shown[..., :3]
        if not (alpha == 255).all():
            through = (255 - alpha[..., None].astype(np.uint16)) * self._paper
            picture = (picture + (through + 127) // 255).astype(np.uint8)
        if not missing.any():
            return np.ascontiguousarray(picture)
        return np.dstack([picture, np.where(missing, 0, 255).astype(np.uint8)])

    def _ground(self, window: Window) -> Bytes:
        """Ground below a window, assembled from tiles."""
        ground = np.empty((window.height_px, window.width_px, 4), np.uint8)
        for part in tile_parts(window, self.grid):
            tile = self._tile(part.window)
            x, y = max(part.dx_px, 0), max(part.dy_px, 0)
            right = min(part.dx_px + part.window.width_px, window.width_px)
            bottom = min(part.dy_px + part.window.height_px, window.height_px)
            ground[y:bottom, x:right] = tile[y - part.dy_px : bottom - part.dy_px, x - part.dx_px : right - part.dx_px]
        return ground

    def _tile(self, tile: Window) -> Bytes:
        """Premultiplied pixels of a ground tile, drawn once for all threads that need it."""
        with self._lock:
            known = self._tiles.get(tile)
            if known is None:
                mine = self._tiles[tile] = Future()
                # 256 tiles take 64 MB.
                if len(self._tiles) > 256:
                    self._tiles.popitem(last=False)
            else:
                self._tiles.move_to_end(tile)
        if known is not None:
            return known.result()
        try:
            pixels = self._draw_tile(tile)
        except BaseException as wrong:
            mine.set_exception(wrong)
            with self._lock:
                self._tiles.pop(tile, None)
            raise
        mine.set_result(pixels)
        return pixels

    def _draw_tile(self, tile: Window) -> Bytes:
        image = blank(tile.width_px, tile.height_px)
        blended = self._blended(image)
        settings = self._settings(tile)
        for drawn in self._snapshot.ground:
            if not _is_shown(drawn.layer, settings):
                continue
            pixels = drawn.pixels(tile) if isinstance(drawn, ServerTiles) else self._pixels(drawn, settings, tile)
            if pixels is not None:
                _paint(image, pixels, _COVERING)
                if blended is not None:
                    _paint(blended, pixels, drawn.layer.blendMode())
        shown = to_array(image)
        return shown if blended is None else np.where(shown[..., 3:] > 0, to_array(blended), np.uint8(0))

    def _blended(self, below: QImage) -> QImage | None:
        """Paper image to blend layers with; None if every layer simply covers those below."""
        if not _any_blended(drawn.layer for drawn in self._snapshot.ground):
            return None
        paper = below.copy()
        paper.fill(QColor(*(int(colour) for colour in self._paper)))
        return paper

    def _pixels(
        self,
        pipes: Pipes,
        settings: QgsMapSettings,
        tile: Window,
    ) -> Bytes | None:
        """Pixels of one layer; None if it shows nothing."""
        layer, size = pipes.layer, (tile.width_px, tile.height_px)
        if not self.grid.plane.wraps and tile.zoom <= self.grid.native_zoom:
            factor = 1 << (self.grid.native_zoom - tile.zoom)
            return averaged(pipes, tile.left_px, tile.top_px, size, factor, self._jobs)
        if not self.grid.plane.wraps and resamples_early(layer):
            return pipes.block(settings.extent(), size, self._jobs)
        if layer.providerType() == FILE_PROVIDER:
            return sampled(pipes, settings, self._edges(tile), size, self._jobs)
        extent = settings.extent()
        if layer.crs() == settings.destinationCrs() and not _is_timed(layer, settings):
            # Shrink the extent slightly: otherwise QGIS also requests the neighbouring tiles. Every pixel's centre
            # stays in its pixel.
            extent.grow(-1e-3 * self.grid.pixel_size(tile.zoom)[0])
            return pipes.block(extent, size, self._jobs)
        image = blank(*size)
        self._jobs.draw(image, settings, [layer])
        return to_array(image)

    def _edges(self, window: Window) -> tuple[float, float, float, float]:
        _, *rectangle = window
        west, south, east, north = (float(edge) for edge in self.grid.edges(*rectangle, window.zoom))
        return west, south, east, north

    def _settings(self, window: Window) -> QgsMapSettings:
        settings = QgsMapSettings(self._snapshot.settings)
        settings.setOutputSize(QSize(window.width_px, window.height_px))
        settings.setExtent(QgsRectangle(*self._edges(window)))
        return settings


def _paint(image: QImage, pixels: Bytes, mode: QPainter.CompositionMode) -> None:
    painter = QPainter(image)
    painter.setCompositionMode(mode)
    painter.drawImage(0, 0, to_image(pixels))
    painter.end()


def _any_blended(layers: Iterable[QgsMapLayer]) -> bool:
    """Whether the look of a layer depends on those below it, down to the paper."""
    return any(layer.blendMode() != _COVERING for layer in layers)


def _is_timed(layer: QgsMapLayer, settings: QgsMapSettings) -> bool:
    """Whether a layer's contents depend on the time of the map."""
    times = layer.temporalProperties()
    return bool(settings.isTemporal() and times is not None and times.isActive())


def _is_shown(layer: QgsMapLayer, settings: QgsMapSettings) -> bool:
    """Whether a layer is visible at the map's scale and time."""
    times = layer.temporalProperties()
    timely = not _is_timed(layer, settings) or times.isVisibleInTemporalRange(settings.temporalRange())
    return timely and layer.isInScaleRange(settings.scale())
