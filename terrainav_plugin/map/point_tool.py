"""Choosing where a test shot is taken: one click."""

from __future__ import annotations

from qgis.core import QgsCsException, QgsProject
from qgis.gui import QgsMapMouseEvent
from qgis.PyQt.QtCore import Qt, pyqtSignal

from ...core.errors import TerrAInavError
from ..i18n import told
from .canvas import TemporaryTool, lon_lat_of


class PointTool(TemporaryTool):
    """Tells the longitude and latitude of a click, whatever the project's CRS.

    Signals
    -------
    clicked(float, float)
        Latitude and longitude in degrees.
    refused(str)
        Why the place cannot be used.
    """

    clicked = pyqtSignal(float, float)
    refused = pyqtSignal(str)

    def canvasReleaseEvent(self, event: QgsMapMouseEvent) -> None:
        """Take the place."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        crs = self.canvas().mapSettings().destinationCrs()
        try:
            lon, lat = lon_lat_of(self.toMapCoordinates(event.pos()), crs, QgsProject.instance())
        except (TerrAInavError, QgsCsException) as wrong:
            self.refused.emit(told(wrong))
            return
        self.stop()
        self.clicked.emit(lat, lon)
