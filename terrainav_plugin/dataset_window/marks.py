"""Crosses on the map over images that would be rejected."""

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
    """An image on the map canvas that moves with the map."""

    def __init__(self, canvas: QgsMapCanvas) -> None:
        super().__init__(canvas)
        self.image = QImage()

    def show_image(self, image: QImage, extent: QgsRectangle) -> None:
        """Show an image that covers an extent of the map."""
        self.image = image
        self.setRect(extent)
        self.update()

    def paint(self, painter: QPainter, *_: object) -> None:
        """Paint."""
        if not self.image.isNull():
            # QGIS adds a margin of a pixel on each side of the rectangle.
            painter.drawImage(self.boundingRect().adjusted(1.0, 1.0, -1.0, -1.0), self.image)


class Marks(QObject):
    """Redraw the crosses when the threshold or the map's view changes, off the main thread.

    Signals
    -------
    failed(object)
        The error that stopped a drawing.

    Attributes
    ----------
    drawn : int
        Number of images crossed out.
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
        """Whether a drawing is pending."""
        return self._worker.busy

    @property
    def item(self) -> MarksItem | None:
        """The item on the map canvas, if any."""
        return self._item

    def show(self, folder: Path, stems: Callable[[], Collection[str]]) -> None:
        """Cross out images of a dataset; ``stems`` returns their names without extension, on any thread."""
        self._wanted = folder, stems
        self._draw()

    def hide(self) -> None:
        """Remove the crosses from the map."""
        self._wanted = None
        self._clear()

    def find(self, folder: Path, stem: str, found: Callable[[QgsRectangle | None], None]) -> None:
        """Find the extent of a dataset's image in the map's CRS; ``found`` receives it, or None if it is unknown.

        This abandons a drawing of crosses, which is then requested again.
        """

        def answer(bounds: Bounds | None) -> None:
            found(None if bounds is None else QgsRectangle(*bounds))
            self._draw()

        wkt = self._wkt()
        self._worker.ask(lambda _: self._drawer.bounds(folder, wkt, stem), answer)

    def close(self) -> None:
        """Stop for good."""
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
        """Request a drawing of the current view, and abandon a drawing for an earlier view or threshold."""
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
    """Extent of the map canvas in the map's CRS, with its pixel size.

    Parameters
    ----------
    west, south, east, north : float
        Map units.
    units_per_px : float
    ratio : float
        Device pixels per Qt pixel.
    """

    west: float
    south: float
    east: float
    north: float
    units_per_px: float
    ratio: float


class Drawer:
    """Draw the crosses; the footprints of a dataset are kept until another dataset is drawn. Use on one thread only.

    Parameters
    ----------
    closed : callable
        Returns whether to stop reading a long file because nobody waits for it any longer.
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
        """Draw a view of a dataset; None if cancelled. Raises InvalidInput."""
        try:
            outlines, chosen = self._read_outlines(folder, wkt), stems()
            return Drawn(draw(outlines, chosen, view, cancelled), len(chosen))
        except Cancelled:
            return None

    def bounds(self, folder: Path, wkt: str, stem: str) -> Bounds | None:
        """West, south, east and north of an image in a CRS; None if it has no outline there. Raises InvalidInput."""
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
    """An image, and the number of outlines crossed out."""

    image: QImage
    count: int


def draw(
    outlines: Outlines, stems: Collection[str], view: MapExtent, cancelled: Callable[[], bool] = lambda: False
) -> QImage:
    """Image of a view in which the outlines of ``stems`` are crossed out; transparent elsewhere.

    Parameters
    ----------
    outlines : Outlines
        Outlines in the map's CRS.
    stems : collection of str
        Names of the images to cross out, without extension.

    Raises
    ------
    Cancelled
        ``cancelled`` has returned True.
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
    # Points outside the CRS's domain are infinite: their outlines are not drawn.
    seen = chosen & (left < wide) & (right > 0.0) & (top < high) & (bottom > 0.0) & np.isfinite(left + top)
    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    veil = QColor(REJECTED)
    veil.setAlpha(70)
    try:
        for done, ring in enumerate(np.flatnonzero(seen).tolist()):
            # Check for cancellation every 500 footprints.
            if done % 500 == 0 and cancelled():
                raise Cancelled(tr("footprints: stopped"))
            box = QRectF(left[ring], top[ring], right[ring] - left[ring], bottom[ring] - top[ring])
            # Draw footprints too small for a cross as dots.
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
    """Diagonals of closed rings."""
    half, count = (len(places) - 1) // 2, len(places) - 1
    corners = (0, count // 4, half, half + count // 4)
    a, b, c, d = (QPointF(x[places[at]], y[places[at]]) for at in corners)
    return [QLineF(a, c), QLineF(b, d)]
