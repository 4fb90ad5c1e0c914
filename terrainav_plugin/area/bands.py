"""An area drawn over the canvas, and what is said at the pointer."""

from __future__ import annotations

from typing import Any

from qgis.core import QgsProject
from qgis.gui import QgsMapCanvas, QgsRubberBand
from qgis.PyQt.QtCore import QObject, QPoint, Qt
from qgis.PyQt.QtGui import QColor
from qgis.PyQt.QtWidgets import QLabel

from ...core.mission.area import Area
from ..compat import POINT, POLYGON
from ..plain import plain_label
from .outline import Outline, middle_of

#: Vermillion and its tint of the Okabe-Ito palette, which colour-blind people tell apart.
LINE, FILL = QColor(213, 94, 0), QColor(213, 94, 0, 40)
_HANDLE_PX = 9
_POINT_PX = 8
#: The readout stands this far from the pointer, so that it hides nothing of what is aimed at.
_ASIDE_PX = 16
#: Over maps of any colour, in themes that paint no background of labels: the readout brings its own.
_READOUT_STYLE = "QLabel { background-color: #202020; color: #ffffff; border-radius: 3px; padding: 3px; }"


class AreaMark(QObject):
    """Outline of an area, in any CRS of the canvas."""

    def __init__(self, canvas: QgsMapCanvas) -> None:
        super().__init__()
        self._canvas = canvas
        self._area: Area | None = None
        self._drawn_on = 0
        self._shown = False
        self._bands = AreaBands(canvas)
        canvas.destinationCrsChanged.connect(self._draw)
        canvas.extentsChanged.connect(self._follow)

    def close(self) -> None:
        """Take it away for good."""
        self._canvas.extentsChanged.disconnect(self._follow)
        self._canvas.destinationCrsChanged.disconnect(self._draw)
        self._bands.clear()

    def set_area(self, area: Area | None) -> None:
        """Take another area; None for none."""
        if area != self._area:
            self._area = area
            self._draw()

    def set_shown(self, shown: bool) -> None:
        """Draw it, or take it away."""
        if shown != self._shown:
            self._shown = shown
            self._draw()

    def _follow(self) -> None:
        """Draw degrees on the turn that is in view."""
        if self._turn() != self._drawn_on:
            self._draw()

    def _turn(self) -> int:
        """Turns around the Earth between the area and the middle of the view; 0 in maps without such turns."""
        if self._area is None or not self._canvas.mapSettings().destinationCrs().isGeographic():
            return 0
        return round((self._canvas.extent().center().x() - middle_of(self._area)[0]) / 360.0)

    def _draw(self) -> None:
        self._drawn_on = self._turn()
        if self._area is None or not self._shown:
            self._bands.clear()
            return
        crs, near = self._canvas.mapSettings().destinationCrs(), self._canvas.extent().center().x()
        self._bands.show(Outline(self._area, crs, QgsProject.instance(), near), with_handles=False)


class AreaBands:
    """Outline and handles of one area."""

    def __init__(self, canvas: QgsMapCanvas) -> None:
        self._canvas = canvas
        self._bands: list[QgsRubberBand] = []

    def show(self, outline: Outline, with_handles: bool) -> None:
        """Draw an outline in place of the one before."""
        if not self._bands:
            icons = QgsRubberBand.IconType
            self._bands = [
                area_band(self._canvas),
                _icon_band(self._canvas, icons.ICON_CIRCLE, _POINT_PX),
                _icon_band(self._canvas, icons.ICON_FULL_BOX, _HANDLE_PX),
            ]
            # The images inside are looked at in their own colours.
            self._bands[0].setFillColor(QColor(0, 0, 0, 0))
            # White inside tells handles from the line they lie on.
            self._bands[2].setFillColor(QColor(255, 255, 255))
        area, points, handles = self._bands
        area.reset(POLYGON)
        points.reset(POINT)
        handles.reset(POINT)
        shape = outline.shape
        if not shape.isEmpty():
            band = points if shape.type() == POINT else area
            # The canvas's own coordinates: nothing is to be transformed.
            band.setToGeometry(shape, None)
        if with_handles:
            for place in outline.handles.values():
                handles.addPoint(place)

    def clear(self) -> None:
        """Take it away."""
        for band in self._bands:
            self._canvas.scene().removeItem(band)
        self._bands = []


class PointerText:
    """A line of text beside the pointer."""

    def __init__(self, canvas: QgsMapCanvas) -> None:
        self._canvas = canvas
        self._label: QLabel | None = None

    def say(self, text: str, at: QPoint) -> None:
        """Show a text beside a pixel, inside the canvas."""
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
        """Take it away."""
        if self._label is not None:
            self._label.hide()
            self._label.setParent(None)
            self._label.deleteLater()
            self._label = None


def area_band(canvas: QgsMapCanvas, kind: Any = POLYGON) -> QgsRubberBand:
    """Make a band for an area, or for points of it."""
    band = QgsRubberBand(canvas, kind)
    band.setStrokeColor(LINE)
    band.setFillColor(FILL)
    band.setWidth(2)
    return band


def _icon_band(canvas: QgsMapCanvas, icon: QgsRubberBand.IconType, size_px: int) -> QgsRubberBand:
    band = area_band(canvas, POINT)
    band.setIcon(icon)
    band.setIconSize(size_px)
    return band
