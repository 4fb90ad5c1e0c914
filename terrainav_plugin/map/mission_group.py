"""The one group of the layer tree that holds all layers of a mission."""

from __future__ import annotations

from pathlib import Path

from qgis.core import QgsLayerTreeGroup, QgsLayerTreeLayer, QgsMapLayer, QgsProject

from ..i18n import tr

#: Custom properties of the group, saved with the project.
_FOLDER, _MISSION = "terrainav/folder", "terrainav/mission"
#: Custom property of each layer: what it shows. A reopened project is recognised by it.
ROLE = "terrainav/role"
#: Role of the footprints that a dataset holds.
CAPTURED = "captured"


def saved_missions(project: QgsProject) -> list[tuple[str, str]]:
    """Folder and mission (JSON) of every mission group of a project.

    A project may have been moved together with its datasets: its layers know where they are now.
    """
    missions = []
    for group in project.layerTreeRoot().findGroups(True):
        mission = group.customProperty(_MISSION)
        if not mission:
            continue
        captured = _layer_in(group, CAPTURED)
        if captured is not None:
            group.setCustomProperty(_FOLDER, str(Path(captured.source().partition("|")[0]).parent))
        missions.append((group.customProperty(_FOLDER), mission))
    return missions


def _layer_in(group: QgsLayerTreeGroup | None, role: str) -> QgsMapLayer | None:
    for node in group.findLayers() if group is not None else ():
        layer = node.layer()
        if layer is not None and layer.customProperty(ROLE) == role:
            return layer
    return None


class MissionGroup:
    """The group of the mission that is captured into ``folder``; made when its first layer comes.

    It is looked up anew each time, because users move, rename and remove groups as they like.
    """

    def __init__(self, project: QgsProject, name: str, folder: str) -> None:
        self._project = project
        self._title = tr("TerrAInav: {name}").format(name=name)
        self._folder = folder

    def is_same(self, other: MissionGroup) -> bool:
        """Whether both are the group of one folder."""
        return self._folder == other._folder

    def find(self) -> QgsLayerTreeGroup | None:
        """Return the group, or None where there is none (any more)."""
        for group in self._project.layerTreeRoot().findGroups(True):
            if group.customProperty(_FOLDER) == self._folder:
                return group
        return None

    def layer(self, role: str) -> QgsMapLayer | None:
        """Layer of the group that shows ``role``, if there is one."""
        return _layer_in(self.find(), role)

    def add(self, layer: QgsMapLayer, role: str, index: int) -> QgsLayerTreeLayer:
        """Put a layer into the group, at ``index`` from the top (-1 for the bottom)."""
        layer.setCustomProperty(ROLE, role)
        self._project.addMapLayer(layer, False)
        return self._made().insertLayer(index, layer)

    def remember_mission(self, text: str) -> None:
        """Keep the mission's JSON with the group, so that the project knows it."""
        group = self.find()
        if group is not None:
            group.setCustomProperty(_MISSION, text)

    def remove_if_empty(self) -> None:
        """Take the group away when nothing is in it."""
        group = self.find()
        if group is not None and not group.children():
            group.parent().removeChildNode(group)

    def _made(self) -> QgsLayerTreeGroup:
        group = self.find()
        if group is None:
            group = self._project.layerTreeRoot().insertGroup(0, self._title)
            group.setCustomProperty(_FOLDER, self._folder)
        return group
