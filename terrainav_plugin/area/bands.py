"""Rubber bands of an area, and text at the pointer."""

from __future__ import annotations

from typing import Any, NamedTuple

from qgis.core import QgsGeometry, QgsPointXY, QgsProject
from qgis.gui import QgsMapCanvas, QgsRubberBand
from qgis.PyQt.QtCore import QObject, QPoint, Qt
from qgis.PyQt.QtGui import QColor
from qgis.PyQt.QtWidgets import QLabel

from ...core.mission.areas.area import Area
from ..compat import POINT, POLYGON
from ..plain import plain_label
from .outline import AreaOutline, Corner, count_turns


class BandColours(NamedTuple):
    """Colours and brush style of a band."""

    line: QColor
    fill: QColor
    brush: Qt.BrushStyle = Qt.BrushStyle.SolidPattern


#: Vermillion of the Okabe-Ito palette, which colour-blind people distinguish, and a tint of it.
AREA_COLOURS = BandColours(QColor(213, 94, 0), QColor(213, 94, 0, 40))
#: Without a fill, which would tint the images inside.
OUTLINE_COLOURS = AREA_COLOURS._replace(fill=QColor(0, 0, 0, 0))
#: Red as on flight maps, hatched to leave the map below visible.
NO_FLY_COLOURS = BandColours(QColor(190, 0, 30), QColor(190, 0, 30, 200), Qt.BrushStyle.BDiagPattern)
_HANDLE_PX = 9
#: Width and height of the plugin's symbols, which are drawn at their original size.
_SYMBOL_PX = 24
#: Distance of the text from the pointer, so that it does not hide the target.
_ASIDE_PX = 16
#: Legible over any map, also in themes that paint no background for labels.
_READOUT_STYLE = "QLabel { background-color: #202020; color: #ffffff; border-radius: 3px; padding: 3px; }"


class AreaMark(QObject):
    """Outline of an area, in any CRS of the canvas.

    Parameters
    ----------
    colours : BandColours
    symbol : str
        Path of an image that marks points; empty for a dot.

    Attributes
    ----------
    area : Box, Polygon, Polygons, Points or None
        Area whose outline is drawn while the mark is shown.
    is_shown : bool
    """

    def __init__(self, canvas: QgsMapCanvas, colours: BandColours = OUTLINE_COLOURS, symbol: str = "") -> None:
        super().__init__()
        self._canvas = canvas
        self.area: Area | None = None
        self._drawn_on = 0
        self.is_shown = False
        self._bands = AreaBands(canvas, colours, symbol)
        canvas.destinationCrsChanged.connect(self._draw)
        canvas.extentsChanged.connect(self._follow)

    def close(self) -> None:
        """Remove the mark for good."""
        self._canvas.extentsChanged.disconnect(self._follow)
        self._canvas.destinationCrsChanged.disconnect(self._draw)
        self._bands.clear()

    def set_area(self, area: Area | None) -> None:
        """Set the area; None clears it."""
        if area != self.area:
            self.area = area
            self._draw()

    def set_shown(self, shown: bool) -> None:
        """Show or hide the mark."""
        if shown != self.is_shown:
            self.is_shown = shown
            self._draw()

    def _follow(self) -> None:
        """Redraw the mark if a geographic map now shows another turn around the Earth."""
        if self._turn() != self._drawn_on:
            self._draw()

    def _turn(self) -> int:
        """Number of turns around the Earth from the area to the middle of the view; 0 on projected maps."""
        if self.area is None or not self._canvas.mapSettings().destinationCrs().isGeographic():
            return 0
        return count_turns(self.area, self._canvas.extent().center().x())

    def _draw(self) -> None:
        self._drawn_on = self._turn()
        if self.area is None or not self.is_shown:
            self._bands.clear()
            return
        crs, near = self._canvas.mapSettings().destinationCrs(), self._canvas.extent().center().x()
        self._bands.show(AreaOutline(self.area, crs, QgsProject.instance(), near), with_handles=False)


class AreaBands:
    """Outline and handles of one area."""

    def __init__(self, canvas: QgsMapCanvas, colours: BandColours = OUTLINE_COLOURS, symbol: str = "") -> None:
        self._canvas, self._colours, self._symbol = canvas, colours, symbol
        self._bands: list[QgsRubberBand] = []

    def show(self, outline: AreaOutline, with_handles: bool, picked: Corner | None = None) -> None:
        """Draw an outline in place of the previous one; the handle of the corner ``picked`` is filled."""
        if not self._bands:
            icons = QgsRubberBand.IconType
            self._bands = [
                area_band(self._canvas, POLYGON, self._colours),
                _icon_band(self._canvas, icons.ICON_CIRCLE, 8),
                _icon_band(self._canvas, icons.ICON_CIRCLE, 7),
                corner_band(self._canvas),
                _icon_band(self._canvas, icons.ICON_FULL_BOX, _HANDLE_PX),
            ]
            if self._symbol:
                self._bands[1].setSvgIcon(self._symbol, QPoint(-_SYMBOL_PX // 2, -_SYMBOL_PX // 2))
            self._bands[2].setFillColor(QColor(255, 255, 255))
            self._bands[4].setFillColor(AREA_COLOURS.line)
        area, points, middles, handles, chosen = self._bands
        area.reset(POLYGON)
        for band in (points, middles, handles, chosen):
            band.reset(POINT)
        shape = outline.shape
        if not shape.isEmpty():
            band = points if shape.type() == POINT else area
            # None for no transformation, as the coordinates are in the canvas's CRS.
            band.setToGeometry(shape, None)
        if with_handles:
            _show_points(handles, [*outline.handles.values(), *outline.corners.values()])
            # Edges shorter than 40 px on the screen get no handle in their middle.
            least = 40.0 * self._canvas.mapUnitsPerPixel()
            long = (
                corner
                for corner, segments in outline.edges.items()
                if sum(start.distance(end) for start, end in segments) >= least
            )
            _show_points(middles, [outline.middles[corner] for corner in long])
            _show_points(chosen, [outline.corners[picked]] if picked in outline.corners else [])

    def clear(self) -> None:
        """Remove the bands."""
        for band in self._bands:
            self._canvas.scene().removeItem(band)
        self._bands = []


class PointerText:
    """A line of text next to the pointer."""

    def __init__(self, canvas: QgsMapCanvas) -> None:
        self._canvas = canvas
        self._label: QLabel | None = None

    def say(self, text: str, at: QPoint) -> None:
        """Show a text next to a pixel, within the canvas."""
        if self._label is None:
            self._label = plain_label(parent=self._canvas.viewport())
            self._label.setObjectName("terrainav_readout")
            self._label.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
            self._label.setStyleSheet(_READOUT_STYLE)
        label = self._label
        label.setText(text)
        label.adjustSize()
        viewport = self._canvas.viewport()
        x = min(at.x() + _ASIDE_PX, viewport.width() - label.width())
        y = at.y() + _ASIDE_PX
        if y + label.height() > viewport.height():
            y = at.y() - _ASIDE_PX - label.height()
        label.move(max(x, 0), max(y, 0))
        label.setVisible(bool(text))

    def clear(self) -> None:
        """Remove the text."""
        if self._label is not None:
            self._label.hide()
            self._label.setParent(None)
            self._label.deleteLater()
            self._label = None


def area_band(canvas: QgsMapCanvas, kind: Any = POLYGON, colours: BandColours = AREA_COLOURS) -> QgsRubberBand:
    """Create a band for an area, or for its points."""
    band = QgsRubberBand(canvas, kind)
    band.setStrokeColor(colours.line)
    band.setFillColor(colours.fill)
    band.setBrushStyle(colours.brush)
    band.setWidth(2)
    return band


def corner_band(canvas: QgsMapCanvas, colours: BandColours = AREA_COLOURS) -> QgsRubberBand:
    """Create a band for handles, which are white inside to stand out from their line."""
    band = area_band(canvas, POINT, colours)
    band.setIcon(QgsRubberBand.IconType.ICON_FULL_BOX)
    band.setIconSize(_HANDLE_PX)
    band.setBrushStyle(Qt.BrushStyle.SolidPattern)
    band.setFillColor(QColor(255, 255, 255))
    return band


def _show_points(band: QgsRubberBand, points: list[QgsPointXY]) -> None:
    """Set all points of a band at once, as adding them one by one takes quadratic time."""
    if points:
        band.setToGeometry(QgsGeometry.fromMultiPointXY(points), None)


def _icon_band(canvas: QgsMapCanvas, icon: QgsRubberBand.IconType, size_px: int) -> QgsRubberBand:
    band = area_band(canvas, POINT)
    band.setIcon(icon)
    band.setIconSize(size_px)
    return band
