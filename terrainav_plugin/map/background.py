"""The map below: a source shown as background, and the way to the typed coordinates."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import QgsMapLayer, QgsProject, QgsRasterLayer, QgsRectangle
from qgis.gui import QgisInterface

from ...core.errors import InvalidInput
from ..i18n import tr
from ..sources import WORLD, tile_layer_uri
from ..tasks import Task
from .canvas import box_of, canvas_rectangle
from .mission_group import ROLE
from .world_picture import WorldPicture, choose_picture, render

if TYPE_CHECKING:
    from ...core.mission.area import Box

_BACKGROUND = "background"
#: Room left around the area that is zoomed to, as a share of it.
_MARGIN = 1.2


class WorldTask(Task):
    """Renders a picture of the embedded world."""

    def __init__(self, picture: WorldPicture, path: Path) -> None:
        super().__init__(tr("Drawing the synthetic landscape"))
        self.picture = picture
        self.path = path

    def work(self) -> None:
        """Render."""
        render(self.picture, self.path, self._go_on)

    def _go_on(self, share: float) -> bool:
        self.setProgress(100.0 * share)
        return not self.isCanceled()


def _is_drawn(layer: QgsMapLayer | None) -> bool:
    return layer is not None and layer.isValid() and layer.isSpatial()


class Background:
    """Adds a source below all layers of the project; at most one layer for each source."""

    def __init__(self, project: QgsProject, iface: QgisInterface) -> None:
        self._project = project
        self._canvas = iface.mapCanvas()
        #: A zoom to be done once the map has a layer, by the layer's id.
        self._waiting: tuple[str, Callable[[], None]] | None = None
        self._bridge = iface.layerTreeCanvasBridge()
        self._bridge.canvasLayersChanged.connect(self._settled)

    def close(self) -> None:
        """End for good."""
        self._bridge.canvasLayersChanged.disconnect(self._settled)
        self._waiting = None

    def world_task(self, box: Box | None, map_type: str, seed: int, folder: Path) -> WorldTask | None:
        """Task that draws the embedded world around a box; None where that is there already."""
        picture = choose_picture(box, map_type, seed)
        path = folder / picture.file_name
        return None if path.is_file() else WorldTask(picture, path)

    def show_world(
        self, box: Box | None, map_type: str, seed: int, folder: Path, title: str
    ) -> QgsRasterLayer:
        """Show the embedded world as it was drawn for a box."""
        path = folder / choose_picture(box, map_type, seed).file_name
        return self._show(str(path), "gdal", title, WORLD)

    def show_tiles(self, source: str, map_type: str, title: str, date: str = "") -> QgsRasterLayer:
        """Show a source of tiles; raises InvalidInput where it cannot be shown."""
        return self._show(tile_layer_uri(source, map_type, date), "wms", title, source)

    def show_file(self, path: str, title: str) -> QgsRasterLayer:
        """Show a raster or MBTiles file; raises InvalidInput where QGIS cannot open it."""
        return self._show(path, "gdal", title, path)

    def zoom_to(self, box: Box | None) -> None:
        """Zoom to a box, or to everything; raises InvalidInput where the project's CRS has no such place."""
        if box is None:
            self._when_settled(self._canvas.zoomToFullExtent)
            return
        self.rectangle(box)
        self._when_settled(lambda: self._show_extent(self.rectangle(box)))

    def zoom_to_layer(self, layer: QgsRasterLayer) -> None:
        """Zoom to a layer."""
        extent = layer.extent()
        self._when_settled(
            lambda: self._show_extent(self._canvas.mapSettings().layerExtentToOutputExtent(layer, extent))
        )

    def looked_at(self) -> Box | None:
        """What the map shows; None for an empty map, or one that shows no place on Earth."""
        if not self._canvas.layers():
            return None
        try:
            return box_of(self._canvas.extent(), self._canvas.mapSettings().destinationCrs(), self._project)
        except InvalidInput:
            return None

    def rectangle(self, box: Box) -> QgsRectangle:
        """Rectangle of the canvas around a box; raises InvalidInput where the project's CRS has no such place."""
        return canvas_rectangle(box, self._canvas.mapSettings().destinationCrs(), self._project)

    def _when_settled(self, zoom: Callable[[], None]) -> None:
        """Zoom now; or, while the map has not got all layers that it is to show, once it has.

        With the first layer of a project QGIS takes its CRS and zooms to it, a while after it was added. What the map
        still shows of an earlier project says nothing about that.
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
        # A layer that has been removed or hidden meanwhile does not come.
        if node is None or not node.isVisible() or wanted in {layer.id() for layer in layers}:
            self._waiting = None
            zoom()

    def _show_extent(self, rectangle: QgsRectangle) -> None:
        rectangle.scale(_MARGIN)
        self._canvas.setExtent(rectangle)
        self._canvas.refresh()

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
