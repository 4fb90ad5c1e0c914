"""The area that is entered, drawn over the map while nothing else shows it there."""

from __future__ import annotations

from qgis.core import QgsProject
from qgis.gui import QgsMapCanvas
from qgis.PyQt.QtCore import QObject

from ...core.mission.area import Area
from .area_bands import AreaBands
from .area_drag import middle_of
from .area_outline import Outline


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
