"""Areas from the project's layers and from files, read on a thread."""

from __future__ import annotations

from collections.abc import Callable

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsFeatureRequest,
    QgsMapLayer,
    QgsProject,
    QgsVectorLayer,
    QgsVectorLayerFeatureSource,
)

from ...core.errors import InvalidInput
from ...core.mission.area import Area, Box
from ...core.mission.coords import parse_coords
from ..i18n import tr
from ..tasks import Task
from .area_layers import PointFields, points_of, polygon_of
from .canvas import box_of

#: What reads an area, and the height of its first point in metres where it has one; it may be cancelled.
Reading = Callable[[Callable[[], bool]], "tuple[Area, float | None]"]


class ReadTask(Task):
    """Reads an area.

    Attributes
    ----------
    found : tuple of (area, height above ground in metres or None), or None
        Once it has ended.
    step : str
        Name of the change that it makes.
    """

    def __init__(self, step: str, read: Reading) -> None:
        super().__init__(tr("Reading the area"))
        self.step = step
        self.found: tuple[Area, float | None] | None = None
        self._read = read

    def work(self) -> None:
        """Read."""
        self.found = self._read(self.isCanceled)


def selected_polygon(layer: QgsVectorLayer, project: QgsProject) -> Reading:
    """Reader of the selected polygon of a layer; of the only one, where nothing is selected."""
    crs, context = _crs(layer), project.transformContext()
    is_only = not layer.selectedFeatureCount() and layer.featureCount() == 1
    # A snapshot: the layer itself belongs to the main thread.
    source = QgsVectorLayerFeatureSource(layer)
    request = QgsFeatureRequest() if is_only else _selected(layer)
    return lambda _cancelled: (polygon_of(source.getFeatures(request), crs, context), None)


def points(layer: QgsVectorLayer, only_selected: bool, fields: PointFields, project: QgsProject) -> Reading:
    """Reader of the points of a layer."""
    crs, context = _crs(layer), project.transformContext()
    source = QgsVectorLayerFeatureSource(layer)
    request = _selected(layer) if only_selected else QgsFeatureRequest()

    def read(cancelled: Callable[[], bool]) -> tuple[Area, float | None]:
        found = points_of(source.getFeatures(request), crs, context, fields, cancelled)
        return found, found.poses[0][2]

    return read


def text_file(path: str, agl_unit: str) -> Reading:
    """Reader of a file of points."""
    return lambda _cancelled: parse_coords(path, agl_unit=agl_unit)


def extent_of(layer: QgsMapLayer, project: QgsProject) -> Box:
    """Box around a layer.

    Raises
    ------
    InvalidInput
        An empty layer, or one without a CRS.
    """
    extent = layer.extent()
    if extent.isNull() or not extent.isFinite():
        raise InvalidInput(tr("layer “{name}” is empty: it has no extent").format(name=layer.name()))
    return box_of(extent, _crs(layer), project)


def _crs(layer: QgsMapLayer) -> QgsCoordinateReferenceSystem:
    if not layer.crs().isValid():
        raise InvalidInput(
            tr("layer “{name}” has no CRS: set it in the layer's properties").format(name=layer.name())
        )
    return layer.crs()


def _selected(layer: QgsVectorLayer) -> QgsFeatureRequest:
    return QgsFeatureRequest().setFilterFids(layer.selectedFeatureIds())
