"""The images that would be rejected, crossed out on the map."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from qgis.core import QgsCoordinateReferenceSystem, QgsRectangle
from qgis.gui import QgsMapCanvas, QgsMapCanvasItem
from qgis.PyQt.QtCore import QLineF, QObject, QPointF, QRectF, Qt, pyqtSignal
from qgis.PyQt.QtGui import QColor, QImage, QPainter, QPen, QPolygonF

from ...core.arrays import Floats
from ...core.dataset.folder import FOOTPRINTS_FILE
from ...core.errors import Cancelled
from ..dataset.footprints import Bounds, Outlines, file_stamp, read_outlines
from ..i18n import tr
from ..tasks import LatestWorker
from .charts import REJECTED


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
    failed(object)
        An error that has kept them from being drawn.

    Attributes
    ----------
    drawn : int
        How many images the picture on the map was to cross out.
    """

    failed = pyqtSignal(object)

    def __init__(self, canvas: QgsMapCanvas) -> None:
        super().__init__()
        self._canvas = canvas
        self._worker = LatestWorker("marks")
        self._worker.failed.connect(self.failed)
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
        """Marks on the map, if any."""
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

        wkt = self._wkt()
        self._worker.ask(lambda _: self._drawer.bounds(folder, wkt, stem), answer)

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
        view = MapExtent(
            extent.xMinimum(),
            extent.yMinimum(),
            extent.xMaximum(),
            extent.yMaximum(),
            settings.mapUnitsPerPixel(),
            self._canvas.devicePixelRatioF(),
        )
        self._asked += 1
        number = self._asked
        wkt = self._wkt()

        def work(overtaken: Callable[[], bool]) -> Drawn | None:
            return self._drawer.draw(folder, wkt, stems, view, lambda: number != self._asked or overtaken())

        self._worker.ask(work, partial(self._show, number, extent))

    def _show(self, number: int, extent: QgsRectangle, drawn: Drawn | None) -> None:
        if drawn is None or number != self._asked:
            return
        self.drawn = drawn.count
        if self._item is None:
            self._item = MarksItem(self._canvas)
        self._item.show_image(drawn.image, extent)


class MapExtent(NamedTuple):
    """Rectangle shown by the map, in its CRS, and the size of a pixel.

    Parameters
    ----------
    west, south, east, north : float
        Map units.
    units_per_px : float
    ratio : float
        Pixels of the screen for each of Qt's.
    """

    west: float
    south: float
    east: float
    north: float
    units_per_px: float
    ratio: float


class Drawer:
    """Draws what would be rejected; knows the footprints of one dataset until another is asked for. On one thread.

    Parameters
    ----------
    closed : callable
        Whether nobody waits any more; reading a long file ends then.
    """

    def __init__(self, closed: Callable[[], bool]) -> None:
        self._closed = closed
        self._of: tuple[Path, tuple[int, int]] | None = None
        self._outlines: Outlines | None = None
        self._projected: tuple[str, Outlines] | None = None

    def draw(
        self,
        folder: Path,
        wkt: str,
        stems: Callable[[], Collection[str]],
        view: MapExtent,
        cancelled: Callable[[], bool],
    ) -> Drawn | None:
        """Draw a view of a dataset; None where it is wanted no more. Raises InvalidInput."""
        try:
            outlines, chosen = self._read_outlines(folder, wkt), stems()
            return Drawn(draw(outlines, chosen, view, cancelled), len(chosen))
        except Cancelled:
            return None

    def bounds(self, folder: Path, wkt: str, stem: str) -> Bounds | None:
        """West, south, east and north of an image in a CRS; None where it has no outline there. Raises InvalidInput."""
        try:
            return self._read_outlines(folder, wkt).bounds(stem)
        except Cancelled:
            return None

    def _read_outlines(self, folder: Path, wkt: str) -> Outlines:
        """Outlines of a dataset in a CRS."""
        of = folder, file_stamp(folder / FOOTPRINTS_FILE)
        if self._outlines is None or of != self._of:
            self._outlines, self._projected = read_outlines(folder, self._closed), None
            self._of = of
        if self._projected is None or self._projected[0] != wkt:
            self._projected = wkt, self._outlines.projected(wkt)
        return self._projected[1]


class Drawn(NamedTuple):
    """A picture, and how many outlines it was to show."""

    image: QImage
    count: int


def draw(
    outlines: Outlines, stems: Collection[str], view: MapExtent, cancelled: Callable[[], bool] = lambda: False
) -> QImage:
    """Picture of a view with some of the outlines crossed out, clear elsewhere.

    Parameters
    ----------
    outlines : Outlines
        In the map's CRS.
    stems : collection of str
        Names of the images.

    Raises
    ------
    Cancelled
        When ``cancelled`` said so.
    """
    wide = max(round((view.east - view.west) / view.units_per_px * view.ratio), 1)
    high = max(round((view.north - view.south) / view.units_per_px * view.ratio), 1)
    image = QImage(wide, high, QImage.Format.Format_ARGB32_Premultiplied)
    image.fill(Qt.GlobalColor.transparent)
    if not len(outlines.owners):
        return image
    scale = view.ratio / view.units_per_px
    x, y = (outlines.x - view.west) * scale, (view.north - outlines.y) * scale
    first = outlines.starts[:-1]
    left, top = np.minimum.reduceat(x, first), np.minimum.reduceat(y, first)
    right, bottom = np.maximum.reduceat(x, first), np.maximum.reduceat(y, first)
    wanted = set(stems)
    chosen = np.array([stem in wanted for stem in outlines.stems], np.bool_)[outlines.owners]
    # Whatever is infinite compares as outside.
    seen = chosen & (left < wide) & (right > 0.0) & (top < high) & (bottom > 0.0) & np.isfinite(left + top)
    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    veil = QColor(REJECTED)
    veil.setAlpha(70)
    try:
        for done, ring in enumerate(np.flatnonzero(seen).tolist()):
            # Ask every 500 footprints whether to go on.
            if done % 500 == 0 and cancelled():
                raise Cancelled(tr("footprints: stopped"))
            box = QRectF(left[ring], top[ring], right[ring] - left[ring], bottom[ring] - top[ring])
            # Footprints too small for a cross are blots.
            if max(box.width(), box.height()) < 6.0 * view.ratio:
                painter.fillRect(box, REJECTED)
                continue
            places = range(int(outlines.starts[ring]), int(outlines.starts[ring + 1]))
            painter.setPen(QPen(REJECTED, 2.0 * view.ratio))
            painter.setBrush(veil)
            painter.drawPolygon(QPolygonF([QPointF(x[at], y[at]) for at in places]))
            painter.drawLines(_cross(x, y, places))
    finally:
        painter.end()
    return image


def _cross(x: Floats, y: Floats, places: range) -> list[QLineF]:
    """Lines between opposite corners of a ring, which ends where it begins."""
    half, count = (len(places) - 1) // 2, len(places) - 1
    corners = (0, count // 4, half, half + count // 4)
    a, b, c, d = (QPointF(x[places[at]], y[places[at]]) for at in corners)
    return [QLineF(a, c), QLineF(b, d)]
