"""The one group of the layer tree that holds all layers of a mission."""

from __future__ import annotations

import os
from collections.abc import Callable
from itertools import takewhile
from pathlib import Path
from typing import NamedTuple

from qgis.core import (
    QgsLayerTreeGroup,
    QgsLayerTreeLayer,
    QgsLayerTreeNode,
    QgsMapLayer,
    QgsProject,
    QgsProviderRegistry,
)
from qgis.PyQt.QtCore import QObject

from ...core.dataset.folder import MISSION_FILE
from ...core.storage.files import file_exists
from ..i18n import tr
from ..tasks import single_shot

#: Custom properties of the group, saved with the project.
_FOLDER, _MISSION, _CURRENT = "terrainav/folder", "terrainav/mission", "terrainav/current"
#: Custom property of the group of a dataset that is at an address: without credentials.
_ADDRESS = "terrainav/address"
#: Custom property of a group that holds several datasets of one mission.
_SEVERAL = "terrainav/several"
#: Custom property of each layer: what it shows. A reopened project is recognised by it.
ROLE = "terrainav/role"
#: Role of the footprints that a dataset holds.
CAPTURED = "captured"
#: Role of the footprints whose images could not be made.
FAILED = "failed"


class SavedMission(NamedTuple):
    """A mission that a project holds.

    Parameters
    ----------
    title : str
        Name of its group, which the user may have changed.
    folder : str
        Empty where what was saved is no path.
    text : str
        The mission as JSON; empty where what was saved is no text.
    current : bool
        Whether it was the one in the panel last.
    """

    title: str
    folder: str
    text: str
    current: bool


def saved_missions(project: QgsProject) -> list[SavedMission]:
    """Missions of a project, one for each of its mission groups, from the top of the layer tree.

    A project may have been moved together with its datasets: its layers know where they are now.
    """
    missions = []
    for group in project.layerTreeRoot().findGroups(True):
        if not group.customProperty(_MISSION):
            continue
        captured = _child_layer(group, CAPTURED)
        if captured is not None and captured.providerType() == "ogr" and is_path(str(layer_dataset(captured))):
            group.setCustomProperty(_FOLDER, str(layer_dataset(captured)))
        folder = _text(group, _FOLDER)
        current = bool(group.customProperty(_CURRENT))
        missions.append(SavedMission(group.name(), folder if is_path(folder) else "", _text(group, _MISSION), current))
    return missions


def is_path(text: str) -> bool:
    """Whether a text may be a path: systems take no longer ones, and none with NUL or half a character."""
    try:
        name = os.fsencode(text)
    except ValueError:
        return False
    # The longest path that systems take.
    return bool(text.strip()) and len(text) <= 4096 and b"\0" not in name


def _text(group: QgsLayerTreeGroup, name: str) -> str:
    """Text that a project has saved with a group; empty where there is something else, which others have written."""
    value = group.customProperty(name)
    return value if isinstance(value, str) else ""


def addresses(project: QgsProject) -> list[tuple[Path, str]]:
    """Folders of the datasets of a project that were copied from an address, and these."""
    groups = project.layerTreeRoot().findGroups(True)
    found = [(_text(group, _FOLDER), _text(group, _ADDRESS)) for group in groups]
    return [(Path(folder), address) for folder, address in found if is_path(folder) and address]


def mission_layers(project: QgsProject, kind: object) -> list[tuple[str, QgsMapLayer]]:
    """Layers of a type in the mission groups of a project, from the top, each with the title of its group."""
    found = []
    for node in project.layerTreeRoot().findLayers():
        layer, group = node.layer(), _parent_group(node)
        if group is not None and layer is not None and layer.type() == kind:
            found.append((group.name(), layer))
    return found


def preview_layers(project: QgsProject) -> list[QgsMapLayer]:
    """Layers of previews, which hold what the map shows of a plan, and not all of it."""
    layers = project.mapLayers().values()
    return [one for one in layers if one.customProperty(ROLE) and one.providerType() == "memory"]


def layer_dataset(layer: QgsMapLayer) -> Path:
    """Folder of the dataset whose footprints a layer shows."""
    return layer_file(layer).parent


def layer_file(layer: QgsMapLayer) -> Path:
    """File that a layer shows."""
    # Read as QGIS itself does: what follows a bar may be an option of the layer, or of the folder's name.
    parts = QgsProviderRegistry.instance().decodeUri(layer.providerType(), layer.source())
    return Path(str(parts.get("path") or layer.source()))


def _child_layer(group: QgsLayerTreeGroup | None, role: str) -> QgsMapLayer | None:
    for node in group.findLayers() if group is not None else ():
        layer = node.layer()
        # Groups of other datasets may be inside.
        if layer is not None and layer.customProperty(ROLE) == role and _parent_group(node) is group:
            return layer
    return None


def _parent_group(node: QgsLayerTreeNode) -> QgsLayerTreeGroup | None:
    """Mission group that a layer is in, the nearest one; None for a layer of none."""
    group = node.parent()
    while group is not None and not group.customProperty(_FOLDER):
        group = group.parent()
    return group


def _is_ours(node: QgsLayerTreeNode) -> bool:
    """Whether a node is a mission group, or one that holds several of one mission."""
    return bool(node.customProperty(_FOLDER) or node.customProperty(_SEVERAL))


def _is_foreign(node: QgsLayerTreeLayer | None) -> bool:
    """Whether a layer is there, and none of a mission's own."""
    return node is not None and node.layer() is not None and not node.layer().customProperty(ROLE)


class GroupsOnTop(QObject):
    """Keeps mission groups above layers that are added, which would hide what is planned.

    QGIS adds layers above the current one, and so into a mission group where that is one of the mission's. What users
    have put above a group or into it themselves stays there, and so does what comes above that.
    """

    def __init__(self, project: QgsProject) -> None:
        super().__init__()
        self._project = project
        self._added: set[str] = set()
        # QGIS reports layers before they are in the layer tree.
        self._soon = single_shot(self._move, self)
        project.legendLayersAdded.connect(self._note)
        # Layers of a project that is opened are where they were.
        project.readProject.connect(self._forget)

    def close(self) -> None:
        """End for good."""
        self._soon.stop()
        self._project.readProject.disconnect(self._forget)
        self._project.legendLayersAdded.disconnect(self._note)

    def _note(self, layers: list[QgsMapLayer]) -> None:
        self._added.update(layer.id() for layer in layers if not layer.customProperty(ROLE))
        self._soon.start()

    def _forget(self, *_: object) -> None:
        self._added = set()

    def _move(self) -> None:
        root = self._project.layerTreeRoot()
        # What has got a role meanwhile, as Processing's results do once they are loaded, is where it belongs.
        added = {node.layerId() for node in map(root.findLayer, self._added) if _is_foreign(node)}
        self._added = set()
        for node in map(root.findLayer, added):
            group = node.parent()
            if _is_ours(group):
                while _is_ours(group.parent()):
                    group = group.parent()
                around = group.parent()
                around.insertChildNode(around.children().index(group) + 1, node.clone())
                node.parent().removeChildNode(node)
        nodes = root.children()
        over = list(takewhile(lambda node: not _is_ours(node), nodes))
        if over and all(isinstance(node, QgsLayerTreeLayer) and node.layerId() in added for node in over):
            groups = list(takewhile(_is_ours, nodes[len(over) :]))
            root.insertChildNodes(0, [group.clone() for group in groups])
            for group in groups:
                root.removeChildNode(group)


class MissionGroup:
    """The group of the mission that is captured into ``folder``; made when its first layer comes.

    It is looked up anew each time, because users move, rename and remove groups as they like.
    """

    def __init__(self, project: QgsProject, folder: Path) -> None:
        self.project = project
        self._title = tr("TerrAInav: {name}").format(name=folder.name or tr("mission"))
        self._folder = str(folder)

    def is_same(self, other: MissionGroup) -> bool:
        """Whether both are the group of one folder."""
        return self._folder == other._folder

    def find(self) -> QgsLayerTreeGroup | None:
        """Return the group, or None where there is none (any more)."""
        for group in self.project.layerTreeRoot().findGroups(True):
            if group.customProperty(_FOLDER) == self._folder:
                return group
        return None

    def layer(self, role: str) -> QgsMapLayer | None:
        """Layer of the group that shows ``role``, if there is one."""
        return _child_layer(self.find(), role)

    def add(self, layer: QgsMapLayer, role: str, index: int) -> QgsLayerTreeLayer:
        """Put a layer into the group, at ``index`` from the top (-1 for the bottom)."""
        layer.setCustomProperty(ROLE, role)
        self.project.addMapLayer(layer, False)
        return self.made().insertLayer(index, layer)

    def remove(self, role: str) -> None:
        """Take the layer that shows ``role`` off the map, if there is one."""
        layer = self.layer(role)
        if layer is not None:
            self.project.removeMapLayer(layer.id())
            self.remove_if_empty()

    def replace(self, old: QgsMapLayer, new: QgsMapLayer, role: str) -> None:
        """Put a layer into the place of another, as visible and under the same name."""
        node = self.project.layerTreeRoot().findLayer(old.id())
        parent, shown, expanded = node.parent(), node.itemVisibilityChecked(), node.isExpanded()
        new.setName(old.name())
        new.setCustomProperty(ROLE, role)
        self.project.addMapLayer(new, False)
        there = parent.insertLayer(parent.children().index(node), new)
        there.setItemVisibilityChecked(shown)
        there.setExpanded(expanded)
        self.project.removeMapLayer(old.id())

    def remember_mission(self, text: str) -> None:
        """Keep the mission's JSON with the group, so that the project knows it."""
        group = self.find()
        if group is not None:
            group.setCustomProperty(_MISSION, text)

    def remember_address(self, address: str) -> None:
        """Keep where the dataset is from with the group."""
        group = self.find()
        if group is not None:
            group.setCustomProperty(_ADDRESS, address)

    def gather(self, is_same: Callable[[str], bool]) -> None:
        """Put this group and those of the same mission, of other sources or dates, under one parent.

        Groups that users have put elsewhere stay there.

        Parameters
        ----------
        is_same : callable
            Whether a mission, as JSON, is the same but for its imagery.
        """
        root, own = self.project.layerTreeRoot(), self.find()
        if own is None or own.parent() is not root:
            return
        others = [
            group
            for group in root.findGroups(True)
            if group is not own
            and _text(group, _MISSION)
            and (group.parent() is root or group.parent().customProperty(_SEVERAL))
            and is_same(_text(group, _MISSION))
        ]
        if not others:
            return
        around = next((one.parent() for one in others if one.parent() is not root), None)
        if around is None:
            around = root.insertGroup(root.children().index(own), tr("TerrAInav: datasets of one mission"))
            around.setCustomProperty(_SEVERAL, True)
        for group in (own, *(one for one in others if one.parent() is root)):
            around.addChildNode(group.clone())
            root.removeChildNode(group)

    def make_current(self) -> None:
        """Have the project remember that this is the mission in the panel."""
        for group in self.project.layerTreeRoot().findGroups(True):
            if group.customProperty(_FOLDER) == self._folder:
                group.setCustomProperty(_CURRENT, True)
            elif group.customProperty(_CURRENT):
                group.removeCustomProperty(_CURRENT)

    def remove_if_empty(self) -> None:
        """Take the group away when nothing is in it."""
        group = self.find()
        while group is not None and _is_ours(group) and not group.children():
            around = group.parent()
            around.removeChildNode(group)
            group = around

    def made(self) -> QgsLayerTreeGroup:
        """Return the group, made where there is none yet."""
        group = self.find()
        if group is None:
            group = self._around().insertGroup(0, self._title)
            group.setCustomProperty(_FOLDER, self._folder)
        return group

    def _around(self) -> QgsLayerTreeGroup:
        """Group that this one is in: of the mission that has this dataset beside others, or the layer tree itself."""
        outer = Path(self._folder).parent
        if not file_exists(outer / MISSION_FILE):
            return self.project.layerTreeRoot()
        return MissionGroup(self.project, outer).made()
