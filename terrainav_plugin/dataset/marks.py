"""The images that would be rejected, crossed out on the map."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import partial
from pathlib import Path
from typing import Any

from qgis.core import QgsCoordinateReferenceSystem, QgsRectangle
from qgis.gui import QgsMapCanvas, QgsMapCanvasItem
from qgis.PyQt.QtCore import QObject, pyqtSignal
from qgis.PyQt.QtGui import QImage, QPainter

from ..tasks import Worker
from .outlines import Bounds, Drawer, Drawn, View


class MarksItem(QgsMapCanvasItem):
    """A picture on the map that moves with it."""

    def __init__(self, canvas: QgsMapCanvas) -> None:
        super().__init__(canvas)
        self.image = QImage()

    def show_image(self, image: QImage, extent: QgsRectangle) -> None:
        """Show a picture of a part of the map."""
        self.image = image
        self.setRect(extent)
        self.update()

    def paint(self, painter: QPainter, *_: object) -> None:
        """Paint."""
        if not self.image.isNull():
            # Beyond the rectangle the item has a pixel on either side.
            painter.drawImage(self.boundingRect().adjusted(1.0, 1.0, -1.0, -1.0), self.image)


class Marks(QObject):
    """Keeps the crosses in step with the threshold and with the map's view; they are drawn beside the main thread.

    Signals
    -------
    refused(str)
        The message of an error.

    Attributes
    ----------
    drawn : int
        How many images the picture on the map was to cross out.
    """

    refused = pyqtSignal(str)

    def __init__(self, canvas: QgsMapCanvas) -> None:
        super().__init__()
        self._canvas = canvas
        self._worker = Worker()
        self._worker.refused.connect(self.refused)
        self._drawer = Drawer(lambda: self._worker.closed)
        self._item: MarksItem | None = None
        self._wanted: tuple[Path, Callable[[], Collection[str]]] | None = None
        self._asked = 0
        self.drawn = 0
        for signal in self._signals():
            signal.connect(self._draw)

    @property
    def busy(self) -> bool:
        """Whether a picture is still to come."""
        return self._worker.busy

    @property
    def item(self) -> MarksItem | None:
        """What is on the map, if anything is."""
        return self._item

    def show(self, folder: Path, stems: Callable[[], Collection[str]]) -> None:
        """Cross out images of a dataset; ``stems`` gives their names without ending, on any thread."""
        self._wanted = folder, stems
        self._draw()

    def hide(self) -> None:
        """Take the crosses off the map."""
        self._wanted = None
        self._clear()

    def find(self, folder: Path, stem: str, found: Callable[[QgsRectangle | None], None]) -> None:
        """Tell where an image of a dataset is, in the map's CRS; None where that is not known.

        Crosses that were being drawn are asked for again.
        """

        def answer(bounds: Bounds | None) -> None:
            found(None if bounds is None else QgsRectangle(*bounds))
            self._draw()

        self._worker.ask(partial(self._drawer.bounds_of, folder, self._wkt(), stem), answer)

    def close(self) -> None:
        """End for good."""
        for signal in self._signals():
            signal.disconnect(self._draw)
        self.hide()
        self._worker.close()

    def _signals(self) -> tuple[Any, ...]:
        return self._canvas.extentsChanged, self._canvas.destinationCrsChanged, self._canvas.rotationChanged

    def _clear(self) -> None:
        self._asked += 1
        self.drawn = 0
        if self._item is not None:
            self._canvas.scene().removeItem(self._item)
            self._item = None

    def _wkt(self) -> str:
        """The map's CRS."""
        crs = self._canvas.mapSettings().destinationCrs()
        return crs.toWkt(QgsCoordinateReferenceSystem.WktVariant.WKT_PREFERRED)

    def _draw(self, *_: object) -> None:
        """Have what is to be seen now drawn; what is being drawn for an earlier view or threshold is given up."""
        settings = self._canvas.mapSettings()
        extent = settings.visibleExtent()
        if self._wanted is None or extent.isEmpty():
            self._clear()
            return
        folder, stems = self._wanted
        view = View(
            extent.xMinimum(),
            extent.yMinimum(),
            extent.xMaximum(),
            extent.yMaximum(),
            settings.mapUnitsPerPixel(),
            self._canvas.devicePixelRatioF(),
        )
        self._asked += 1
        number = self._asked
        work = partial(
            self._drawer.draw,
            folder,
            self._wkt(),
            stems,
            view,
            lambda: number != self._asked or self._worker.closed,
        )
        self._worker.ask(work, partial(self._show, number, extent))

    def _show(self, number: int, extent: QgsRectangle, drawn: Drawn | None) -> None:
        if drawn is None or number != self._asked:
            return
        self.drawn = drawn.count
        if self._item is None:
            self._item = MarksItem(self._canvas)
        self._item.show_image(drawn.image, extent)
