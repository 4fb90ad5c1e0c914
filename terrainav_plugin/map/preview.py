"""The preview: what would be captured, as layers that follow every change."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from qgis.core import QgsProject, QgsVectorLayer
from qgis.PyQt.QtCore import QObject, QTimer, pyqtSignal

from ..i18n import tr
from ..paths import style
from .mission_group import MissionGroup
from .preview_features import CRS, FIELDS, PreviewFeatures, field_names

if TYPE_CHECKING:
    from ...core.mission.mission import Mission


@dataclass(frozen=True)
class _Kind:
    """One of the preview's layers."""

    role: str
    geometry: str

    def new_layer(self, title: str) -> QgsVectorLayer:
        uri = f"{self.geometry}?crs={CRS}&{FIELDS[self.role]}"
        layer = QgsVectorLayer(uri, title, "memory")
        layer.loadNamedStyle(style(self.role))
        # It can be made again at any time, so closing the project need not ask whether to save it.
        layer.setCustomProperty("skipMemoryLayersCheck", 1)
        layer.setReadOnly(True)
        return layer


#: Features added in one go: a few milliseconds.
_PIECE = 1000
_ALL_DONE = object()
#: From the top of the group to its bottom.
_KINDS = (
    _Kind("area", "MultiPolygon"),
    _Kind("centres", "Point"),
    _Kind("flight", "MultiLineString"),
    _Kind("footprints", "MultiPolygon"),
)


def _titles(outlined: bool) -> dict[str, str]:
    return {
        "area": tr("Area"),
        "centres": tr("Capture centres"),
        "flight": tr("Flight line"),
        "footprints": tr("Planned rows (too many images to draw each)") if outlined else tr("Planned images"),
    }


class Preview(QObject):
    """Shows one plan at a time.

    Signals
    -------
    closed()
        After the user removed the preview's layers, or the project was closed.
    """

    closed = pyqtSignal()

    def __init__(self, project: QgsProject) -> None:
        super().__init__()
        self._project = project
        self._group: MissionGroup | None = None
        self._ids: dict[str, str] = {}
        self._pieces: Iterator[None] | None = None
        self._turn = QTimer(self)
        self._turn.setSingleShot(True)
        self._turn.timeout.connect(self._fill_on)
        project.layersRemoved.connect(self._forget)

    @property
    def shown(self) -> bool:
        """Whether there are preview layers in the project."""
        return bool(self._ids)

    @property
    def busy(self) -> bool:
        """Whether layers are still being filled."""
        return self._pieces is not None

    def layer(self, role: str) -> QgsVectorLayer | None:
        """Layer of a kind: area, footprints, centres or flight."""
        return self._project.mapLayer(self._ids.get(role, ""))

    def show(self, group: MissionGroup, mission: Mission, features: PreviewFeatures) -> None:
        """Draw a plan; layers that are there already are filled anew, in place."""
        titles = _titles(features.outlined)
        self._move_to(group)
        for index, kind in enumerate(_KINDS):
            layer = self.layer(kind.role)
            if layer is None:
                layer = self._adopt(kind.role) or self._add(kind, titles[kind.role], index)
            if layer.name() != titles[kind.role]:
                layer.setName(titles[kind.role])
        group.remember_mission(mission.to_json())
        self._pieces = self._fill(features)
        self._fill_on()

    def set_footprints_visible(self, visible: bool) -> None:
        """Tick or untick the planned images, centres and flight line in the layer tree."""
        for role in ("footprints", "centres", "flight"):
            layer = self.layer(role)
            node = self._project.layerTreeRoot().findLayer(layer) if layer is not None else None
            if node is not None:
                node.setItemVisibilityChecked(visible)

    def remove(self) -> None:
        """Take the preview off the map; results in its group stay."""
        self._pieces = None
        ids, self._ids = list(self._ids.values()), {}
        self._project.removeMapLayers([layer_id for layer_id in ids if self._project.mapLayer(layer_id)])
        if self._group is not None:
            self._group.remove_if_empty()
        self._group = None

    def close(self) -> None:
        """End for good: nothing of the preview and no connection to the project is left."""
        self._project.layersRemoved.disconnect(self._forget)
        self.remove()

    def _fill_on(self) -> None:
        """Add one piece and let the application breathe before the next."""
        if self._pieces is None:
            return
        if next(self._pieces, _ALL_DONE) is _ALL_DONE:
            self._pieces = None
        else:
            self._turn.start(0)

    def _fill(self, features: PreviewFeatures) -> Iterator[None]:
        """Fill the layers piece by piece; one that the user removes meanwhile is left out."""
        for kind in _KINDS:
            wanted = getattr(features, kind.role)
            for start in range(0, max(len(wanted), 1), _PIECE):
                layer = self.layer(kind.role)
                if layer is None:
                    break
                if start == 0:
                    layer.dataProvider().truncate()
                layer.dataProvider().addFeatures(wanted[start : start + _PIECE])
                yield None
            layer = self.layer(kind.role)
            if layer is not None:
                layer.updateExtents()
                layer.triggerRepaint()

    def _move_to(self, group: MissionGroup) -> None:
        """A mission with another folder has a group of its own."""
        if self._group is not None and not self._group.is_same(group):
            self.remove()
        self._group = group

    def _adopt(self, role: str) -> QgsVectorLayer | None:
        """Take over the empty layer that a reopened project has kept of an earlier preview."""
        layer = self._group.layer(role)
        if not (isinstance(layer, QgsVectorLayer) and layer.providerType() == "memory"):
            return None
        if layer.fields().names() != field_names(role):
            # Of another version, which knew other attributes.
            self._project.removeMapLayer(layer.id())
            return None
        self._ids[role] = layer.id()
        return layer

    def _add(self, kind: _Kind, title: str, index: int) -> QgsVectorLayer:
        layer = kind.new_layer(title)
        self._group.add(layer, kind.role, index).setExpanded(False)
        self._ids[kind.role] = layer.id()
        return layer

    def _forget(self, layer_ids: list[str]) -> None:
        """Notice layers that the user has removed; the preview ends with its footprints."""
        gone = set(layer_ids)
        if not gone & set(self._ids.values()):
            return
        over = self._ids.get("footprints") in gone
        self._ids = {role: layer_id for role, layer_id in self._ids.items() if layer_id not in gone}
        if over:
            self.remove()
            self.closed.emit()
