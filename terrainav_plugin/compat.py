"""Names that differ between QGIS 3.22 and QGIS 4, Qt 5 and Qt 6."""

from __future__ import annotations

from qgis.core import Qgis, QgsTask, QgsWkbTypes

try:
    from qgis.PyQt.QtGui import QAction
except ImportError:  # Qt 5
    from qgis.PyQt.QtWidgets import QAction

__all__ = ["POLYGON", "TASK_FLAGS", "QAction"]

POLYGON = Qgis.GeometryType.Polygon if hasattr(Qgis, "GeometryType") else QgsWkbTypes.PolygonGeometry

#: A task that can be stopped; the plugin says itself how it ended, where QGIS (3.26) lets it.
TASK_FLAGS = QgsTask.Flag.CanCancel
if hasattr(QgsTask.Flag, "Silent"):
    TASK_FLAGS |= QgsTask.Flag.Silent
