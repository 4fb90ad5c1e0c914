"""The layer tree group of a mission's layers."""

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

#: Custom properties of a mission group, saved with the project.
_FOLDER, _MISSION, _CURRENT = "terrainav/folder", "terrainav/mission", "terrainav/current"
#: Custom property of the group of a remote dataset: the dataset's address, without credentials.
_ADDRESS = "terrainav/address"
#: Custom property of a group that contains the groups of several datasets of one mission.
_SEVERAL = "terrainav/several"
#: Custom property of a layer: its role in the mission, saved with the project.
ROLE = "terrainav/role"
#: Role of the layer of a dataset's footprints.
CAPTURED = "captured"
#: Role of the layer of failed images.
FAILED = "failed"


class SavedMission(NamedTuple):
    """A mission saved in a project.

    Parameters
    ----------
    title : str
        Name of the mission group, which the user may have changed.
    folder : str
        Folder of the dataset; empty if the saved value is not a path.
    text : str
        The mission as JSON; empty if the saved value is not a text.
    current : bool
        Whether the mission was the latest one in the panel.
    """

    title: str
    folder: str
    text: str
    current: bool


def saved_missions(project: QgsProject) -> list[SavedMission]:
    """Missions of a project, one for each mission group, from the top of the layer tree.

    Folders are taken from the groups' layers if possible, as a project may have been moved with its datasets.
    """
    missions = []
    for group in project.layerTreeRoot().findGroups(True):
        if not group.customProperty(_MISSION):
            continue
        captured, folder = _child_layer(group, CAPTURED), _text(group, _FOLDER)
        if captured is not None and captured.providerType() == "ogr" and is_path(str(layer_dataset(captured))):
            moved = str(layer_dataset(captured))
            if moved != folder:
                group.setCustomProperty(_FOLDER, moved)
                for layer in project.mapLayers().values():
                    if folder and _text(layer, _FOLDER) == folder:
                        layer.setCustomProperty(_FOLDER, moved)
                folder = moved
        current = bool(group.customProperty(_CURRENT))
        missions.append(SavedMission(group.name(), folder if is_path(folder) else "", _text(group, _MISSION), current))
    return missions


def is_path(text: str) -> bool:
    """Whether a text may be a path: not too long, without NUL and without lone surrogates."""
    try:
        name = os.fsencode(text)
    except ValueError:
        return False
    # No system allows longer paths.
    return bool(text.strip()) and len(text) <= 4096 and b"\0" not in name


def _text(holder: QgsLayerTreeGroup | QgsMapLayer, name: str) -> str:
    """Text saved with a group or layer; empty if the saved value is not a text."""
    value = holder.customProperty(name)
    return value if isinstance(value, str) else ""


def addresses(project: QgsProject) -> list[tuple[Path, str]]:
    """Folder and address of each remote dataset in the project."""
    groups = project.layerTreeRoot().findGroups(True)
    found = [(_text(group, _FOLDER), _text(group, _ADDRESS)) for group in groups]
    return [(Path(folder), address) for folder, address in found if is_path(folder) and address]


def mission_layers(project: QgsProject, kind: object) -> list[tuple[str, QgsMapLayer]]:
    """Layers of a type in a project's missions, from the top of the layer tree, each after its group's title."""
    found = []
    for node in project.layerTreeRoot().findLayers():
        layer, group = node.layer(), _parent_group(node)
        if layer is None or layer.type() != kind:
            continue
        folder = _text(layer, _FOLDER)
        if group is None and is_path(folder):
            # Laid on top of the tree.
            group = MissionGroup(project, Path(folder)).find()
        if group is not None:
            found.append((group.name(), layer))
    return found


def preview_layers(project: QgsProject) -> list[QgsMapLayer]:
    """Layers of previews, which contain only the visible part of a plan."""
    layers = project.mapLayers().values()
    return [one for one in layers if one.customProperty(ROLE) and one.providerType() == "memory"]


def layer_dataset(layer: QgsMapLayer) -> Path:
    """Folder of the dataset whose footprints a layer shows."""
    return layer_file(layer).parent


def layer_file(layer: QgsMapLayer) -> Path:
    """File that a layer shows."""
    # Let QGIS parse the source: text after a bar may be a layer option, or part of a folder's name.
    parts = QgsProviderRegistry.instance().decodeUri(layer.providerType(), layer.source())
    return Path(str(parts.get("path") or layer.source()))


def _child_layer(group: QgsLayerTreeGroup | None, role: str) -> QgsMapLayer | None:
    for node in group.findLayers() if group is not None else ():
        layer = node.layer()
        # Skip nested groups of other datasets.
        if layer is not None and layer.customProperty(ROLE) == role and _parent_group(node) is group:
            return layer
    return None


def _parent_group(node: QgsLayerTreeNode) -> QgsLayerTreeGroup | None:
    """Innermost mission group that contains a node; None if there is none."""
    group = node.parent()
    while group is not None and not group.customProperty(_FOLDER):
        group = group.parent()
    return group


def _is_ours(node: QgsLayerTreeNode) -> bool:
    """Whether a node is a mission group, a group of several datasets of one mission, or a layer of a mission."""
    layer = node.layer() if isinstance(node, QgsLayerTreeLayer) else None
    return bool(node.customProperty(_FOLDER) or node.customProperty(_SEVERAL) or (layer and layer.customProperty(ROLE)))


def _is_foreign(node: QgsLayerTreeLayer | None) -> bool:
    """Whether a node is a layer without a role in a mission."""
    return node is not None and node.layer() is not None and not node.layer().customProperty(ROLE)


class GroupsOnTop(QObject):
    """Keep mission groups above newly added layers, which would hide them.

    QGIS adds layers above the current layer, and thus into a mission group if the current layer is in it. Layers that
    the user has moved above or into a group stay there, and so do layers added above these.
    """

    def __init__(self, project: QgsProject) -> None:
        super().__init__()
        self._project = project
        self._added: set[str] = set()
        # Wait, as QGIS reports added layers before they are in the layer tree.
        self._soon = single_shot(self._move, self)
        project.legendLayersAdded.connect(self._note)
        # Layers of an opened project stay in place.
        project.readProject.connect(self._forget)

    def close(self) -> None:
        """Stop for good."""
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
        # Layers that have received a role meanwhile, such as results of Processing, are already in place.
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
    """The group of the mission captured into ``folder``; created with its first layer.

    The group is looked up each time, as users move, rename and remove groups.
    """

    def __init__(self, project: QgsProject, folder: Path) -> None:
        self.project = project
        self._title = tr("TerrAInav: {name}").format(name=folder.name or tr("mission"))
        self._folder = str(folder)

    def is_same(self, other: MissionGroup) -> bool:
        """Whether both are the group of the same folder."""
        return self._folder == other._folder

    def find(self) -> QgsLayerTreeGroup | None:
        """Return the group, or None if it does not exist (any more)."""
        for group in self.project.layerTreeRoot().findGroups(True):
            if group.customProperty(_FOLDER) == self._folder:
                return group
        return None

    def layer(self, role: str) -> QgsMapLayer | None:
        """Layer of the group with a role, if any."""
        return _child_layer(self.find(), role)

    def add(self, layer: QgsMapLayer, role: str, index: int) -> QgsLayerTreeLayer:
        """Add a layer to the group, at ``index`` from the top (-1 for the bottom)."""
        layer.setCustomProperty(ROLE, role)
        self.project.addMapLayer(layer, False)
        return self.made().insertLayer(index, layer)

    def on_top(self, role: str) -> QgsMapLayer | None:
        """Layer with a role that `add_on_top` has added, if it is still in the project."""
        for layer in self.project.mapLayers().values():
            if (layer.customProperty(ROLE), layer.customProperty(_FOLDER)) == (role, self._folder):
                return layer
        return None

    def add_on_top(self, layer: QgsMapLayer, role: str) -> QgsLayerTreeLayer:
        """Add a layer of the mission on top of the layer tree, above all groups."""
        layer.setCustomProperty(ROLE, role)
        layer.setCustomProperty(_FOLDER, self._folder)
        self.project.addMapLayer(layer, False)
        return self.project.layerTreeRoot().insertLayer(0, layer)

    def remove(self, role: str) -> None:
        """Remove the layer with a role from the project, if any."""
        layer = self.layer(role)
        if layer is not None:
            self.project.removeMapLayer(layer.id())
            self.remove_if_empty()

    def replace(self, old: QgsMapLayer, new: QgsMapLayer, role: str) -> None:
        """Replace a layer by another one with the same place, visibility and name."""
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
        """Save the mission's JSON with the group, in the project."""
        group = self.find()
        if group is not None:
            group.setCustomProperty(_MISSION, text)

    def remember_address(self, address: str) -> None:
        """Save the address of the dataset with the group."""
        group = self.find()
        if group is not None:
            group.setCustomProperty(_ADDRESS, address)

    def gather(self, is_same: Callable[[str], bool]) -> None:
        """Put this group, and groups of the same mission with other imagery, into one parent group.

        Groups that the user has moved elsewhere stay there.

        Parameters
        ----------
        is_same : callable
            Returns whether a mission, as JSON, is the same apart from its imagery.
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
        """Mark this mission as the one in the panel, in the project."""
        for group in self.project.layerTreeRoot().findGroups(True):
            if group.customProperty(_FOLDER) == self._folder:
                group.setCustomProperty(_CURRENT, True)
            elif group.customProperty(_CURRENT):
                group.removeCustomProperty(_CURRENT)

    def remove_if_empty(self) -> None:
        """Remove the group if it is empty."""
        group = self.find()
        while group is not None and _is_ours(group) and not group.children():
            around = group.parent()
            around.removeChildNode(group)
            group = around

    def made(self) -> QgsLayerTreeGroup:
        """Return the group, created if it does not exist."""
        group = self.find()
        if group is None:
            group = self._around().insertGroup(0, self._title)
            group.setCustomProperty(_FOLDER, self._folder)
        return group

    def _around(self) -> QgsLayerTreeGroup:
        """Parent for this group: the group of several datasets of its mission, or the root."""
        outer = Path(self._folder).parent
        if not file_exists(outer / MISSION_FILE):
            return self.project.layerTreeRoot()
        return MissionGroup(self.project, outer).made()
