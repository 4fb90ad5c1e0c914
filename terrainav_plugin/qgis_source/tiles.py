"""Tile layers, with pixels as the server sends them and the layer's colours.

QGIS (from 3.44) draws each tile a pixel larger on every side, to close gaps between tiles, so that any pixel may be
displaced. Tiles of Web Mercator layers are therefore requested from their server here, over QGIS's network stack and
under the provider's terms, and QGIS only applies the layer's colours.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from queue import SimpleQueue
from typing import TYPE_CHECKING, NamedTuple
from urllib.parse import parse_qs, urlsplit

import numpy as np
from numpy.typing import NDArray
from qgis.core import (
    Qgis,
    QgsBrightnessContrastFilter,
    QgsHueSaturationFilter,
    QgsRasterBlock,
    QgsRasterBlockFeedback,
    QgsRasterInterface,
    QgsRasterLayer,
    QgsRasterProjector,
    QgsRasterResampleFilter,
    QgsRectangle,
)

from ...core.errors import InvalidInput
from ...core.imagery.http.client import NotThere
from ...core.imagery.source import Window
from ..i18n import tr
from .connections import Connection, parse_connection
from .renderer import to_array, to_image

if TYPE_CHECKING:
    from qgis.PyQt.QtGui import QImage

    from ...core.imagery.entry import CatalogueEntry
    from ...core.imagery.source import Source

    Pixels = NDArray[np.uint8]

_MERCATOR = "EPSG:3857"
#: Format of pixels with colours premultiplied by alpha.
_PREMULTIPLIED = Qgis.DataType.ARGB32_Premultiplied


class ServerTiles:
    """A layer whose tiles are requested from their server.

    Create on the main thread, which owns the connections and the stages of the layer's style.

    Parameters
    ----------
    layer : QgsRasterLayer
        A copy of the project's layer, which may change.
    entry : callable
        Returns the catalogue entry of the tiles; called once, and not on the main thread: it may request a service.
    connection : Connection
        Parameters of requests to the server.
    """

    def __init__(self, layer: QgsRasterLayer, entry: Callable[[], CatalogueEntry], connection: Connection) -> None:
        from ..network.transport import QgisTransport
        from ..settings import Settings, credential_home

        settings = Settings()
        self.layer = layer
        self._entry, self._connection = entry, connection
        self._connections, self._cache = settings.connections, settings.tile_cache()
        self._transport = QgisTransport(
            self._connections,
            authcfg=connection.authcfg,
            headers=connection.headers,
            home=credential_home(connection.url),
        )
        self._colours = _colour_stages(layer)
        self._lock = threading.Lock()
        self._opened: Source | None = None

    def pixels(self, window: Window) -> Pixels | None:
        """Premultiplied pixels of a tile of 256 px, (256, 256, 4) uint8; None if the server does not have the tile.

        Raises
        ------
        PartError, SourceError, Cancelled
        """
        source = self._source()
        grid = source.grid
        # At the same zoom, tiles of double width have double resolution; above the highest zoom, pixels are repeated.
        finer = grid.scale.bit_length() - 1
        zoom = min(window.zoom - finer, grid.max_zoom)
        if zoom < grid.min_zoom:
            return None
        repeated = window.zoom - finer - zoom
        columns, rows = (
            (int(start) + np.arange(size)) >> repeated
            for start, size in ((window.left_px, window.width_px), (window.top_px, window.height_px))
        )
        left, top = (int(first) // grid.tile_px * grid.tile_px for first in (columns[0], rows[0]))
        tile = Window(zoom, left, top, grid.tile_px, grid.tile_px)
        try:
            fetched = source.fetch("", tile)
        except NotThere:
            return None
        return self._coloured(_premultiplied(fetched[np.ix_(rows - top, columns - left)]))

    def close(self) -> None:
        """Cancel the requests, so that `pixels` raises `Cancelled`."""
        # Close the transport first, without the lock, which a request for a service's capabilities may hold.
        self._transport.close()
        with self._lock:
            if self._opened is not None:
                self._opened.close()

    def _source(self) -> Source:
        from ...core.imagery.xyz import XYZSource

        with self._lock:
            if self._opened is None:
                entry = self._entry()
                grid = entry.grid()
                if grid.scale & (grid.scale - 1):
                    # The zooms of such tiles differ from the zooms of the image.
                    raise InvalidInput(
                        tr(
                            "layer {name}: its service has tiles of {size} px; choose a layer with tiles of 256, 512 "
                            "or 1024 px"
                        ).format(name=self.layer.name(), size=grid.tile_px)
                    )
                self._opened = XYZSource(
                    entry.templates(entry.date(None)),
                    name=entry.name,
                    title=self.layer.name(),
                    grid=grid,
                    key=self._connection.key or None,
                    date=entry.date(None),
                    placeholder=entry.placeholder,
                    policy=entry.policy,
                    transport=self._transport,
                    connections=self._connections,
                    cache=self._cache,
                    limits=entry.tile_limits,
                    alpha=True,
                    any_size=entry.any_size,
                )
            return self._opened

    def _coloured(self, pixels: Pixels) -> Pixels:
        if self._colours is None:
            return pixels
        stages = self._colours.get()
        try:
            return stages.applied(pixels)
        finally:
            self._colours.put(stages)


class TileAddress(NamedTuple):
    """Origin of the tiles of a Web Mercator layer, from its data source URI.

    Parameters
    ----------
    connection : Connection
        Parameters of requests to the server.
    entry : CatalogueEntry or None
        Catalogue entry of the tiles; None if it must be requested from ``service``.
    service : str
        Name of a WMTS or WMS; empty if ``entry`` is known.
    """

    connection: Connection
    entry: CatalogueEntry | None
    service: str = ""

    @property
    def highest_zoom(self) -> int | None:
        """Highest zoom with tiles, counted in tiles of 256 px; None if it must be requested from the service."""
        if self.entry is None:
            return None
        return self.connection.max_zoom + (self.connection.tile_px // 256).bit_length() - 1

    def tiles(self, copy: QgsRasterLayer) -> ServerTiles:
        """Tiles at the address, for a copy of the layer."""
        if self.entry is not None:
            return ServerTiles(copy, lambda: self.entry, self.connection)
        tiles = ServerTiles(copy, lambda: _service_entry(self.service, tiles), self.connection)
        return tiles


def tile_address(layer: QgsRasterLayer) -> TileAddress | None:
    """Origin of a layer's tiles; None if they are not in Web Mercator, or only QGIS can read them."""
    if layer.providerType() != "wms" or layer.crs().authid() != _MERCATOR:
        return None
    uri = layer.source()
    words = {key: values[0] for key, values in parse_qs(uri, keep_blank_values=True).items()}
    if words.get("interpretation"):
        return None
    try:
        known = parse_connection(layer.name(), uri)
        if words.get("type") == "xyz":
            return TileAddress(known, known.entry())
        if words.get("tileMatrixSet") and words.get("layers") and not words.get("tileDimensions"):
            address = urlsplit(known.url)._replace(fragment="").geturl()
            choices = {
                "layer": "layers",
                "style": "styles",
                "format": "format",
                "tilematrixset": "tileMatrixSet",
            }
            named = "&".join(f"{choice}={words[key]}" for choice, key in choices.items() if words.get(key))
            return TileAddress(known, None, f"wmts:{address}#{named}")
    except InvalidInput:
        # The address cannot be requested here: QGIS draws the layer.
        return None
    return None


def _service_entry(name: str, tiles: ServerTiles) -> CatalogueEntry:
    from ...core.imagery.opening import SourceOptions, named_source

    connection, transport = tiles._connection, tiles._transport  # noqa: SLF001
    # The layer is in Web Mercator; request its tiles in the same CRS.
    options = SourceOptions(key=connection.key or None, transport=transport, crs=_MERCATOR)
    return named_source(name, options).entry


def _premultiplied(pixels: Pixels) -> Pixels:
    """Premultiplied RGBA of pixels with or without alpha."""
    if pixels.shape[2] == 3:
        return np.dstack([pixels, np.full(pixels.shape[:2], 255, np.uint8)])
    alpha = pixels[..., 3:].astype(np.uint16)
    return np.concatenate([(pixels[..., :3] * alpha + 127) // 255, alpha], axis=2).astype(np.uint8)


class _Given(QgsRasterInterface):
    """Start of a pipe that returns given pixels, in place of a provider."""

    def __init__(self) -> None:
        super().__init__()
        self.image: QImage | None = None

    def dataType(self, _band: int) -> Qgis.DataType:
        return _PREMULTIPLIED

    def bandCount(self) -> int:
        return 1

    def block(
        self,
        _band: int,
        _extent: QgsRectangle,
        width: int,
        height: int,
        _feedback: QgsRasterBlockFeedback | None = None,
    ) -> QgsRasterBlock:
        block = QgsRasterBlock(_PREMULTIPLIED, width, height)
        block.setImage(self.image)
        return block


class _Stages:
    """The stages of a layer's pipe that change colours pixel by pixel."""

    def __init__(self, layer: QgsRasterLayer) -> None:
        self._given = _Given()
        self._stages: list[QgsRasterInterface] = [self._given]
        pipe = layer.pipe()
        for index in range(1, pipe.size()):
            if not isinstance(pipe.at(index), (QgsRasterProjector, QgsRasterResampleFilter)):
                stage = pipe.at(index).clone()
                stage.setInput(self._stages[-1])
                self._stages.append(stage)

    def applied(self, pixels: Pixels) -> Pixels:
        """Premultiplied pixels in the layer's colours."""
        height, width = pixels.shape[:2]
        self._given.image = to_image(pixels)
        # QGIS 3.44 crashes without feedback. The extent has no effect: the pixels are given.
        feedback, extent = QgsRasterBlockFeedback(), QgsRectangle(0.0, 0.0, 1.0, 1.0)
        return to_array(self._stages[-1].block(1, extent, width, height, feedback).image())


def _colour_stages(layer: QgsRasterLayer) -> SimpleQueue[_Stages] | None:
    """Stages that colour a layer's pixels, one set for each thread; None if they change nothing."""
    if _is_plain(layer):
        return None
    stages: SimpleQueue[_Stages] = SimpleQueue()
    # One set for each connection of a capture.
    for _ in range(8):
        stages.put(_Stages(layer))
    return stages


def _is_plain(layer: QgsRasterLayer) -> bool:
    brightness: QgsBrightnessContrastFilter | None = layer.brightnessFilter()
    hue: QgsHueSaturationFilter | None = layer.hueSaturationFilter()
    plain_light = brightness is None or (
        brightness.brightness() == 0 and brightness.contrast() == 0 and brightness.gamma() == 1.0
    )
    plain_hue = hue is None or (
        hue.saturation() == 0
        and hue.grayscaleMode() == QgsHueSaturationFilter.GrayscaleMode.GrayscaleOff
        and not hue.colorizeOn()
        and not getattr(hue, "invertColors", bool)()
    )
    return plain_light and plain_hue and layer.renderer().opacity() == 1.0
