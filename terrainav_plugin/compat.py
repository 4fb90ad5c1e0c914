"""Names that differ between QGIS 3.22 and QGIS 4, Qt 5 and Qt 6."""

from __future__ import annotations

from qgis.core import (
    Qgis,
    QgsField,
    QgsMapLayer,
    QgsMapLayerProxyModel,
    QgsMapLayerType,
    QgsPalLayerSettings,
    QgsProcessingAlgorithm,
    QgsTask,
    QgsWkbTypes,
)
from qgis.PyQt import QtCore, QtGui, QtWidgets

# In Qt 6, these classes are in QtGui.
QAction = getattr(QtGui, "QAction", None) or QtWidgets.QAction
QUndoCommand = getattr(QtGui, "QUndoCommand", None) or QtWidgets.QUndoCommand
QUndoStack = getattr(QtGui, "QUndoStack", None) or QtWidgets.QUndoStack

if hasattr(Qgis, "GeometryType"):  # QGIS 3.30
    POINT, LINE, POLYGON = Qgis.GeometryType.Point, Qgis.GeometryType.Line, Qgis.GeometryType.Polygon
else:
    POINT, LINE, POLYGON = (
        QgsWkbTypes.GeometryType.PointGeometry,
        QgsWkbTypes.GeometryType.LineGeometry,
        QgsWkbTypes.GeometryType.PolygonGeometry,
    )

if hasattr(Qgis, "LayerFilter"):  # QGIS 3.34
    POINT_LAYERS, LINE_LAYERS, POLYGON_LAYERS = (
        Qgis.LayerFilter.PointLayer,
        Qgis.LayerFilter.LineLayer,
        Qgis.LayerFilter.PolygonLayer,
    )
else:
    POINT_LAYERS, LINE_LAYERS, POLYGON_LAYERS = (
        QgsMapLayerProxyModel.Filter.PointLayer,
        QgsMapLayerProxyModel.Filter.LineLayer,
        QgsMapLayerProxyModel.Filter.PolygonLayer,
    )

if hasattr(Qgis, "LayerType"):  # QGIS 3.30
    VECTOR, RASTER = Qgis.LayerType.Vector, Qgis.LayerType.Raster
else:
    VECTOR, RASTER = QgsMapLayerType.VectorLayer, QgsMapLayerType.RasterLayer

LABELS_ALONG_LINE = Qgis.LabelPlacement.Line if hasattr(Qgis, "LabelPlacement") else QgsPalLayerSettings.Placement.Line

#: Flags of a task that can be cancelled and, from QGIS 3.26, shows no notice of its end.
TASK_FLAGS = QgsTask.Flag.CanCancel
if hasattr(QgsTask.Flag, "Silent"):
    TASK_FLAGS |= QgsTask.Flag.Silent

#: Method of an algorithm that returns the chosen field names; takes the parameters, a name and the context.
chosen_fields = getattr(QgsProcessingAlgorithm, "parameterAsStrings", None) or QgsProcessingAlgorithm.parameterAsFields

#: Whether the log panel shows messages verbatim. QGIS 3.40.6 takes them for HTML, and 3.44.15 does not; between these
#: versions, messages are escaped, since entities in a log do less harm than tags.
LOG_IS_PLAIN = Qgis.QGIS_VERSION_INT >= 34415

#: Names of attribute types in Qt 6, and in Qt 5's QVariant.
_KINDS = {
    "text": ("QString", "String"),
    "integer": ("Int", "Int"),
    "number": ("Double", "Double"),
    "yes_no": ("Bool", "Bool"),
    "time": ("QDateTime", "DateTime"),
}


def attribution(layer: QgsMapLayer) -> str:
    """Credit that a layer's server asks for."""
    # Since 3.38, the credit is among the server properties of a layer.
    if Qgis.QGIS_VERSION_INT >= 33800:
        return layer.serverProperties().attribution()
    return layer.attribution()


def field(name: str, kind: str) -> QgsField:
    """Attribute of a layer; ``kind`` is text, integer, number, yes_no or time."""
    meta_type, variant_type = _KINDS[kind]
    # Since 3.38, fields take the types of Qt 6, also under Qt 5.
    if Qgis.QGIS_VERSION_INT >= 33800:
        return QgsField(name, getattr(QtCore.QMetaType.Type, meta_type))
    return QgsField(name, getattr(QtCore.QVariant, variant_type))
