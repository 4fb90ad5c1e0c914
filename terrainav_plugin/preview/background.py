"""Background imagery: the entered source, shown around the area."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from osgeo import gdal
from qgis.core import QgsMapLayer, QgsProject, QgsRasterLayer, QgsRectangle
from qgis.gui import QgisInterface
from qgis.PyQt.QtCore import QObject, pyqtSignal

from ...core.capture.georeference import WEB_MERCATOR_WKT
from ...core.errors import Cancelled, InvalidInput, OutputError, TerrAInavError
from ...core.geodesy.mercator import MAX_LAT_DEG, PixelGrid, lat_to_v, lon_to_u
from ...core.imagery.opening import open_source, source_kind
from ...core.imagery.raster.trust import name_for_gdal
from ...core.imagery.source import Window
from ...core.mission.areas.area import Box
from ...core.storage.files import make_folder, partial_file
from ..form import mission_form
from ..i18n import tr, translate
from ..map.canvas import canvas_rectangle, rectangle_box, show_extent
from ..map.mission_group import ROLE
from ..qgis_source.snapshot import is_of_qgis
from ..settings import Settings
from ..sources import WORLD, tile_layer_uri
from ..tasks import Task

if TYPE_CHECKING:
    from ..form.state import FormState
    from ..messages import Messages

_BACKGROUND = "background"
#: Largest number of pixels of an image: drawn in a few seconds, and sharp on the screen up to a twofold zoom.
_MOST_PX = 20_000_000
#: Size of the view when zooming to an area, in sizes of the area.
_ROOM = 1.2


class SourceOnMap(QObject):
    """Show sources as background; an image of the synthetic world is first drawn in a task.

    Parameters
    ----------
    background : Background
    messages : Messages
    read : callable
        Returns the state of the form.
    title : callable
        Returns the title of the entered source.

    Signals
    -------
    drawing(bool)
        Whether the synthetic world is being drawn.
    """

    drawing = pyqtSignal(bool)

    def __init__(
        self,
        background: Background,
        messages: Messages,
        read: Callable[[], FormState],
        title: Callable[[], str],
    ) -> None:
        super().__init__()
        self._background, self._messages = background, messages
        self._read, self._title = read, title
        self._task: WorldTask | None = None
        self._begin: Callable[[], None] | None = None
        self._then: Callable[[], None] | None = None
        self._coarse: Callable[[], None] = lambda: None

    def show(self, then: Callable[[], None] | None = None) -> None:
        """Show the entered source and zoom to the area; call ``then`` once the source is shown, or has failed."""
        state = self._read()
        area, seen = mission_form.box(state), self._background.visible_box()
        map_type = state.map_types[0] if state.map_types else "satellite"
        self._then = then or self._then
        try:
            stay = area is None and seen is not None
            if state.source == WORLD:
                # The fields of the published dataset, if nothing is entered and the map is empty.
                self._show_world(area or seen or Box(35.16, -89.90, 35.115, -89.823), map_type, state.seed, stay)
                return
            title = self._title()
            if source_kind(state.source).is_file:
                self._background.show_file(state.source, title)
            elif not is_of_qgis(state.source):
                self._background.show_tiles(state.source_name, map_type, title, state.date)
            if not stay:
                self._background.zoom_to_box(area)
        except TerrAInavError as wrong:
            self._messages.warning(translate(wrong))
        self._finish()

    def close(self) -> None:
        """Stop for good."""
        if self._task is not None:
            self._task.abandon()
            self._task = None

    def _show_world(self, box: Box, map_type: str, seed: int, stay: bool) -> None:
        """Draw and show the synthetic world around a box, and zoom there unless ``stay``."""
        if self._task is not None:
            return
        folder = Settings().backgrounds
        task = self._background.world_task(box, map_type, seed, folder)
        title = self._title()
        # The first image moves the map; after that, keep the user's view.
        self._begin = None if stay else lambda: self._background.zoom_to_box(box)

        def show(task: WorldTask | None) -> None:
            self._task = None
            self.drawing.emit(False)
            if task is not None and task.error:
                self._messages.error(translate(task.error), task.trace)
            elif task is None or not task.isCanceled():
                self._show_image(choose_picture(box, map_type, seed), folder, title)
                if task is not None:
                    task.remove_coarse()
            self._finish()

        if task is None:
            show(None)
            return
        self._task = task
        self.drawing.emit(True)
        # Connect a bound method of an object of the main thread, so that it is called on that thread.
        self._coarse = lambda: self._show_image(task.coarse, folder, title)
        task.coarse_drawn.connect(self._show_coarse)
        task.begin(show)

    def _show_coarse(self) -> None:
        if self._task is not None and not self._task.isCanceled():
            self._coarse()

    def _show_image(self, picture: WorldPicture, folder: Path, title: str) -> None:
        """Show an image of the synthetic world; the first one moves the map, and pending work begins."""
        begin, self._begin = self._begin, None
        try:
            self._background.show_picture(picture, folder, title)
            if begin is not None:
                begin()
        except TerrAInavError as wrong:
            self._messages.warning(translate(wrong))
        self._finish()

    def _finish(self) -> None:
        """Do the pending work, once the map shows something."""
        then, self._then = self._then, None
        if then is not None:
            then()


class WorldTask(Task):
    """Draw an image of the synthetic world: first a coarse one, quickly, then the fine one.

    Signals
    -------
    coarse_drawn()
        The coarse image can be shown; emitted on the drawing thread.
    """

    coarse_drawn = pyqtSignal()

    def __init__(self, picture: WorldPicture, folder: Path) -> None:
        super().__init__(tr("Drawing the synthetic landscape"))
        self.picture, self.coarse = picture, coarser(picture)
        self._folder = folder

    @property
    def path(self) -> Path:
        """File of the fine image."""
        return self._folder / self.picture.file_name

    def work(self) -> None:
        """Draw the images."""
        if self.coarse != self.picture:
            if not (self._folder / self.coarse.file_name).is_file():
                render(self.coarse, self._folder / self.coarse.file_name, lambda _: not self.isCanceled())
            self.coarse_drawn.emit()
        render(self.picture, self.path, self.report_progress)

    def remove_coarse(self) -> None:
        """Remove the coarse image, which the map no longer shows."""
        if self.coarse != self.picture:
            with suppress(OSError):
                (self._folder / self.coarse.file_name).unlink()


class Background:
    """Add sources below all layers of the project, at most one layer per source."""

    def __init__(self, project: QgsProject, iface: QgisInterface) -> None:
        self._project = project
        self._canvas = iface.mapCanvas()
        #: Id of a layer, and a function that zooms, to be called once the map has the layer.
        self._waiting: tuple[str, Callable[[], None]] | None = None
        self._bridge = iface.layerTreeCanvasBridge()
        self._bridge.canvasLayersChanged.connect(self._settled)

    def close(self) -> None:
        """Stop for good."""
        self._bridge.canvasLayersChanged.disconnect(self._settled)
        self._waiting = None

    def world_task(self, box: Box | None, map_type: str, seed: int, folder: Path) -> WorldTask | None:
        """Task that draws the synthetic world around a box; None if the image exists."""
        picture = choose_picture(box, map_type, seed)
        return None if (folder / picture.file_name).is_file() else WorldTask(picture, folder)

    def show_picture(self, picture: WorldPicture, folder: Path, title: str) -> QgsRasterLayer:
        """Show an existing image of the synthetic world."""
        return self._show(str(folder / picture.file_name), "gdal", title, WORLD)

    def show_tiles(self, source: str, map_type: str, title: str, date: str = "") -> QgsRasterLayer:
        """Show a tiled source; raises InvalidInput if it cannot be shown."""
        return self._show(tile_layer_uri(source, map_type, date), "wms", title, source)

    def show_file(self, path: str, title: str) -> QgsRasterLayer:
        """Show a raster or MBTiles file; raises InvalidInput if QGIS cannot open it."""
        return self._show(name_for_gdal(path), "gdal", title, path)

    def zoom_to_box(self, box: Box | None) -> None:
        """Zoom to a box; None zooms to all layers. Raises InvalidInput outside the domain of the project's CRS."""
        if box is None:
            self._when_settled(self._canvas.zoomToFullExtent)
            return
        self.rectangle(box)
        self._when_settled(lambda: show_extent(self._canvas, self.rectangle(box), _ROOM))

    def zoom_to_layer(self, layer: QgsRasterLayer) -> None:
        """Zoom to a layer."""
        extent = layer.extent()
        settings = self._canvas.mapSettings
        self._when_settled(
            lambda: show_extent(self._canvas, settings().layerExtentToOutputExtent(layer, extent), _ROOM)
        )

    def visible_box(self) -> Box | None:
        """Extent of the map as a box; None if the map is empty or extends beyond the domain of its CRS."""
        if not self._canvas.layers():
            return None
        try:
            return rectangle_box(self._canvas.extent(), self._canvas.mapSettings().destinationCrs(), self._project)
        except InvalidInput:
            return None

    def rectangle(self, box: Box) -> QgsRectangle:
        """Rectangle of the canvas around a box; raises InvalidInput outside the domain of the project's CRS."""
        return canvas_rectangle(box, self._canvas.mapSettings().destinationCrs(), self._project)

    def _when_settled(self, zoom: Callable[[], None]) -> None:
        """Zoom now or, if the map does not have the project's layers yet, as soon as it has them.

        A while after the first layer is added to a project, QGIS sets the CRS and zooms to the layer. Layers of an
        earlier project that the map still has do not count.
        """
        there = {layer.id() for layer in self._canvas.layers()}
        coming = [
            node.layerId()
            for node in self._project.layerTreeRoot().findLayers()
            if node.isVisible() and node.layerId() not in there and _is_drawn(node.layer())
        ]
        if coming:
            self._waiting = coming[0], zoom
        else:
            zoom()

    def _settled(self, layers: list[QgsMapLayer]) -> None:
        if self._waiting is None:
            return
        wanted, zoom = self._waiting
        node = self._project.layerTreeRoot().findLayer(wanted)
        # Do not wait for a layer that has been removed or hidden.
        if node is None or not node.isVisible() or wanted in {layer.id() for layer in layers}:
            self._waiting = None
            zoom()

    def _show(self, uri: str, provider: str, title: str, source: str) -> QgsRasterLayer:
        layer = self._find(source)
        if layer is not None:
            if layer.source() != uri:
                layer.setDataSource(uri, title, provider, layer.dataProvider().ProviderOptions())
            layer.triggerRepaint()
            return layer
        layer = QgsRasterLayer(uri, title, provider)
        if not layer.isValid():
            reason = layer.error().summary() or tr("no reason given")
            raise InvalidInput(tr("{title} cannot be shown: {reason}").format(title=title, reason=reason))
        layer.setCustomProperty(ROLE, f"{_BACKGROUND}/{source}")
        self._project.addMapLayer(layer, False)
        self._project.layerTreeRoot().insertLayer(-1, layer).setExpanded(False)
        return layer

    def _find(self, source: str) -> QgsRasterLayer | None:
        for layer in self._project.mapLayers().values():
            if layer.customProperty(ROLE) == f"{_BACKGROUND}/{source}":
                return layer
        return None


class WorldPicture(NamedTuple):
    """Image of the synthetic world from tiles: columns and rows from ``left, top`` at ``zoom``."""

    map_type: str
    seed: int
    zoom: int
    left: int
    top: int
    columns: int
    rows: int

    @property
    def file_name(self) -> str:
        """Name of the image's file, which depends only on the image."""
        return f"synthetic-{'-'.join(str(part) for part in self)}.tif"


def choose_picture(box: Box | None, map_type: str, seed: int) -> WorldPicture:
    """Tiles around a box, at the highest zoom that keeps the image small; None for the whole world.

    Columns end at the antimeridian: for a box across it, the wider side is shown.
    """
    west, east, north, south = 0.0, 1.0, 0.0, 1.0
    if box is not None:
        west, east = (float(lon_to_u(np.asarray(lon))) for lon in (box.west_deg, box.continuous_east_deg))
        if east > 1.0:
            west, east = (west, 1.0) if 1.0 - west >= east - 1.0 else (0.0, east - 1.0)
        north, south = (
            float(lat_to_v(np.asarray(min(max(lat, -MAX_LAT_DEG), MAX_LAT_DEG))))
            for lat in (box.north_deg, box.south_deg)
        )
        width, height = east - west, south - north
        # Least ratio of the shorter side of the image to the longer one.
        narrowest = 0.75
        # Size of the image, in sizes of the area.
        around = 2.0
        # Least size in world fractions, to show surroundings of a small area.
        least = 2.0**-16
        half_u = max(width, narrowest * height, least) * around / 2.0
        half_v = max(height, narrowest * width, least) * around / 2.0
        middle_u, middle_v = (west + east) / 2.0, (north + south) / 2.0
        west, east, north, south = middle_u - half_u, middle_u + half_u, middle_v - half_v, middle_v + half_v
    grid = PixelGrid()
    zoom = 0
    for candidate in range(grid.max_zoom + 1):
        tiles = _tiles(west, east, north, south, candidate)
        if tiles[2] * tiles[3] * grid.tile_px**2 > _MOST_PX:
            break
        zoom = candidate
    return WorldPicture(map_type, seed, zoom, *_tiles(west, east, north, south, zoom))


def coarser(picture: WorldPicture) -> WorldPicture:
    """Tiles around the same image at a lower zoom, which are drawn quickly."""
    # Three zooms lower, for a 64th of the pixels.
    steps = min(3, picture.zoom)
    left, top = picture.left >> steps, picture.top >> steps
    right = (picture.left + picture.columns - 1 >> steps) + 1
    bottom = (picture.top + picture.rows - 1 >> steps) + 1
    return picture._replace(zoom=picture.zoom - steps, left=left, top=top, columns=right - left, rows=bottom - top)


def render(picture: WorldPicture, path: Path, progress: Callable[[float], bool]) -> None:
    """Draw an image and write it as GeoTIFF with overviews, completely or not at all.

    Raises
    ------
    Cancelled
        ``progress``, which takes the share done, has returned False.
    OutputError
    """
    make_folder(path.parent)
    try:
        with partial_file(path) as partial:
            _write(picture, partial, progress)
    except OSError as wrong:
        raise OutputError("background {0}: cannot be written ({1})", path, wrong.strerror) from wrong


def _is_drawn(layer: QgsMapLayer | None) -> bool:
    return layer is not None and layer.isValid() and layer.isSpatial()


def _tiles(west: float, east: float, north: float, south: float, zoom: int) -> tuple[int, int, int, int]:
    count = 1 << zoom
    left, top = (min(max(math.floor(edge * count), 0), count - 1) for edge in (west, north))
    right, bottom = (min(max(math.ceil(edge * count), 1), count) for edge in (east, south))
    return left, top, max(right - left, 1), max(bottom - top, 1)


def _write(picture: WorldPicture, path: Path, progress: Callable[[float], bool]) -> None:
    source = open_source("world", seed=picture.seed)
    size = source.grid.tile_px
    width, height = picture.columns * size, picture.rows * size
    pixels = np.empty((3, height, width), np.uint8)
    places = [(column, row) for row in range(picture.rows) for column in range(picture.columns)]

    def draw(column: int, row: int) -> None:
        left, top = (picture.left + column) * size, (picture.top + row) * size
        tile = source.fetch(picture.map_type, Window(picture.zoom, left, top, size, size))
        pixels[:, row * size : (row + 1) * size, column * size : (column + 1) * size] = np.moveaxis(tile, -1, 0)

    with ThreadPoolExecutor(os.cpu_count() or 1, thread_name_prefix="terrainav-world") as pool:
        drawing = [pool.submit(draw, *place) for place in places]
        try:
            for done, future in enumerate(as_completed(drawing), 1):
                future.result()
                if not progress(0.9 * done / len(places)):
                    raise Cancelled("background: stopped")
        finally:
            for future in drawing:
                future.cancel()
    edges = source.grid.edges(picture.left * size, picture.top * size, width, height, picture.zoom)
    _save(pixels, path, float(edges[0]), float(edges[3]), source.grid.pixel_size(picture.zoom)[0])


def _save(pixels: np.ndarray, path: Path, west_m: float, north_m: float, resolution_m: float) -> None:
    _, height, width = pixels.shape
    raster = gdal.GetDriverByName("GTiff").Create(
        str(path),
        width,
        height,
        3,
        gdal.GDT_Byte,
        ["COMPRESS=JPEG", "JPEG_QUALITY=90", "PHOTOMETRIC=YCBCR", "TILED=YES"],
    )
    if raster is None:
        raise OutputError("background {0}: cannot be written ({1})", path, gdal.GetLastErrorMsg())
    raster.SetProjection(WEB_MERCATOR_WKT)
    raster.SetGeoTransform((west_m, resolution_m, 0.0, north_m, 0.0, -resolution_m))
    raster.WriteArray(pixels)
    raster.FlushCache()
    factors = [factor for factor in (2, 4, 8, 16, 32) if max(width, height) // factor >= 256]
    if factors:
        raster.BuildOverviews("AVERAGE", factors)
    del raster
