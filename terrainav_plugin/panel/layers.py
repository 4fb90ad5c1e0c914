"""Lines for vector layers: labels with their field of classes, and buildings."""

from __future__ import annotations

from functools import partial

from qgis.core import QgsCategorizedSymbolRenderer, QgsMapLayer, QgsProject, QgsVectorLayer, QgsWkbTypes
from qgis.PyQt.QtCore import pyqtSignal
from qgis.PyQt.QtWidgets import QMenu

from ...core.errors import OutputError
from ..i18n import tr, translate
from ..map.mission_group import ROLE
from ..plain import shown_plain
from ..qgis_source.vector_files import layer_file
from .offers import OfferedLine


class LayersLine(OfferedLine):
    """Line for vector files, with a button that offers the layers of the project.

    Parameters
    ----------
    name : str
        Field of the entry.
    tip, button_tip : str

    Signals
    -------
    refused(str)
        A layer cannot be taken, with the reason.
    """

    refused = pyqtSignal(str)

    def __init__(self, name: str, tip: str, button_tip: str) -> None:
        super().__init__(name, f"{tip} " + tr("Separate several with ;"), button_tip)
        self._submenus: list[QMenu] = []

    def _fill(self) -> None:
        """Fill the menu with the vector layers of the project."""
        self._menu.clear()
        for menu in self._submenus:
            # Delete submenus later: one may contain the action just chosen.
            menu.deleteLater()
        self._submenus = []
        for layer in _vector_layers():
            self._offer(layer)
        self._menu.addSeparator()
        self._menu.addAction(tr("File…"), self._add_file)
        self._offer_none()

    def _offer(self, layer: QgsVectorLayer) -> None:
        """Offer a layer."""
        raise NotImplementedError

    def _add_file(self) -> None:
        self._choose_file(tr("Vector file"), tr("Vector files (*)"))

    def add_layer(self, layer: QgsVectorLayer, field: str = "") -> None:
        """Add a layer, as a file that can be read without QGIS."""
        try:
            text = ":".join(filter(None, (layer_file(layer, field), field)))
        except OutputError as wrong:
            self.refused.emit(translate(wrong))
            return
        if text not in self.words():
            self.enter((*self.words(), text))


class LabelsLine(LayersLine):
    """Line for layers of labels; each is offered with its fields."""

    def _offer(self, layer: QgsVectorLayer) -> None:
        menu = self._menu.addMenu(_as_text(layer.name()))
        menu.setObjectName(f"{self.objectName()}_fields")
        self._submenus.append(menu)
        menu.addAction(tr("One class"), partial(self.add_layer, layer))
        menu.addSeparator()
        for field in layer.fields():
            menu.addAction(_as_text(field.name()), partial(self.add_layer, layer, field.name()))

    def take_layer(self, layer: QgsVectorLayer) -> None:
        """Enter a layer alone, with the field by which the map tells its features apart, if any."""
        self.clear()
        renderer = layer.renderer()
        field = renderer.classAttribute() if isinstance(renderer, QgsCategorizedSymbolRenderer) else ""
        self.add_layer(layer, field if field in layer.fields().names() else "")


class BuildingsLine(LayersLine):
    """Line for footprints of buildings; layers of polygons are offered."""

    def _offer(self, layer: QgsVectorLayer) -> None:
        if layer.geometryType() == QgsWkbTypes.GeometryType.PolygonGeometry:
            self._menu.addAction(_as_text(layer.name()), partial(self.add_layer, layer))


def _vector_layers() -> list[QgsVectorLayer]:
    """Vector layers of the project with geometries, but not those of the preview."""
    layers = [layer for layer in QgsProject.instance().mapLayers().values() if layer.isValid()]
    found = [
        layer
        for layer in layers
        if isinstance(layer, QgsVectorLayer)
        and layer.isSpatial()
        and not layer.flags() & QgsMapLayer.LayerFlag.Private
        and not layer.customProperty(ROLE)
    ]
    return sorted(found, key=lambda layer: layer.name().casefold())


def _as_text(name: str) -> str:
    return shown_plain(name).replace("&", "&&")
