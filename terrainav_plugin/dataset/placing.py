"""Adds results to their mission's group: mosaics, footprints and failed images."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import (
    QgsAction,
    QgsApplication,
    QgsDataProvider,
    QgsMapLayer,
    QgsProject,
    QgsRasterLayer,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QThread

from ..compat import field
from ..i18n import tr
from ..map.mission_group import CAPTURED, FAILED, MissionGroup, layer_file
from ..paths import path_key, style
from ..plain import escaped_field, image_in_tip, path_inside
from .layers import OpenedResults, hide_antimeridian, open_raster
from .mosaic import MosaicRaster

if TYPE_CHECKING:
    from ...core.mission.mission import Mission


class OpenProject:
    """Tracks whether the project in which work began is still open.

    Work continues after its project is closed. Its results are shown only if that project is still open, or if the open
    project has a group for the same folder.
    """

    def __init__(self, project: QgsProject) -> None:
        self.project = project
        #: Number of projects closed in this session before the open one.
        self.number = 0
        project.cleared.connect(self._closed)

    def close(self) -> None:
        """Stop for good."""
        self.project.cleared.disconnect(self._closed)

    def mission_group(self, folder: Path) -> MissionGroup:
        """Group of the mission captured into a folder."""
        return MissionGroup(self.project, folder)

    def shows(self, number: int | None, folder: Path) -> bool:
        """Whether to show results of a folder; the work began in project ``number``."""
        return number == self.number or self.mission_group(folder).find() is not None

    def _closed(self) -> None:
        self.number += 1


def show_results(group: MissionGroup, opened: OpenedResults, changed: bool = True) -> list[QgsMapLayer]:
    """Add a run's layers to its mission's group; existing layers reload their files.

    Parameters
    ----------
    changed : bool
        Whether images have been written since the group's layers were opened.
    """
    footprints = _show_footprints(group, opened)
    mosaics = [_show_mosaic(group, mosaic, layer, changed) for mosaic, layer in opened.mosaics]
    group.remember_mission(opened.mission.to_json())
    return [footprints, *mosaics]


def reread_footprints(group: MissionGroup) -> None:
    """Reload a group's footprint layer, if any."""
    layer = group.layer(CAPTURED)
    if layer is not None:
        layer.setDataSource(layer.source(), layer.name(), "ogr", QgsDataProvider.ProviderOptions())


def show_failed(group: MissionGroup, layer: QgsVectorLayer | None) -> None:
    """Replace the layer of failed images; None removes it."""
    if layer is None:
        group.remove(FAILED)
        return
    layer.loadNamedStyle(style("failed"))
    hide_antimeridian(layer)
    name, map_type, reason = (escaped_field(one) for one in ("name", "map_type", "reason"))
    layer.setMapTipTemplate(f"<b>{name}</b> ({map_type})<br/>{reason}")
    layer.setDisplayExpression('"name" || \': \' || "reason"')
    old = group.layer(FAILED)
    if old is None:
        group.add(layer, FAILED, 0).setExpanded(False)
    else:
        group.replace(old, layer, FAILED)


def load_test_shot(group: MissionGroup, picture: Path, title: str) -> QgsRasterLayer:
    """Add the image of a test shot to the group; raises OutputError if QGIS cannot open it."""
    layer = open_raster(picture, title)
    group.add(layer, "test-shot", 0).setExpanded(False)
    return layer


def place_mosaics(project: QgsProject, mosaics: Iterable[MosaicRaster]) -> None:
    """Put new mosaics in place, as `show_results` does; raises OutputError."""
    for mosaic in mosaics:
        if mosaic.is_made:
            _place(project, mosaic)


def _place(project: QgsProject, mosaic: MosaicRaster) -> None:
    """Put a new mosaic in place; layers of the project release the old file first, and open the new one afterwards.

    Layers are left alone on other threads than the main one, on which a Processing model calls this.

    Raises
    ------
    OutputError
        The file cannot be replaced; layers then keep showing the old one.
    """
    place = path_key(mosaic.path)
    on_main_thread = QThread.currentThread() == QgsApplication.instance().thread()
    holding = [
        layer
        for layer in (project.mapLayers().values() if on_main_thread else ())
        if isinstance(layer, QgsRasterLayer) and path_key(layer_file(layer)) == place
    ]
    sources = [layer.source() for layer in holding]
    try:
        with nullcontext() if mosaic.is_made else mosaic.kept():
            for layer in holding:
                _set_source(layer, "")
        if mosaic.is_made:
            mosaic.put_in_place()
    finally:
        for layer, source in zip(holding, sources):
            _set_source(layer, source)
            layer.triggerRepaint()


def _set_source(layer: QgsRasterLayer, source: str) -> None:
    """Change the file of a layer; empty for none. Style and name stay."""
    layer.setDataSource(source, layer.name(), "gdal", QgsDataProvider.ProviderOptions())


def _show_mosaic(
    group: MissionGroup, mosaic: MosaicRaster, opened: QgsRasterLayer | None, changed: bool
) -> QgsMapLayer:
    role = f"mosaic/{mosaic.path.name}"
    layer = group.layer(role)
    if mosaic.is_made or (layer is not None and (changed or not layer.isValid())):
        _place(group.project, mosaic)
    if layer is None:
        layer = opened or open_raster(mosaic.path, mosaic.title)
        group.add(layer, role, -1).setExpanded(False)
    return layer


def _show_footprints(group: MissionGroup, opened: OpenedResults) -> QgsMapLayer:
    """Add the layer of footprints, or return the existing one: they are the same in every run of a mission."""
    layer = group.layer(CAPTURED)
    if layer is not None and layer.isValid():
        layer.triggerRepaint()
        return layer
    opened.footprints.loadNamedStyle(style("captured"))
    hide_antimeridian(opened.footprints)
    _name_pictures(opened.footprints, opened.mission, opened.has_paths)
    if layer is not None:
        group.replace(layer, opened.footprints, CAPTURED)
    else:
        group.add(opened.footprints, CAPTURED, _above_rasters(group)).setExpanded(False)
    return opened.footprints


def _name_pictures(layer: QgsVectorLayer, mission: Mission, has_paths: bool) -> None:
    """Add the paths of images to their footprints: as attributes, in map tips, and for opening.

    Paths are relative to the layer, so that the folder can be moved with its project. If images are not local files,
    map tips show only poses.
    """
    tips = []
    for map_type in mission.imagery.map_types if has_paths else ():
        ending = mission.output.image_format
        path = path_inside(f"file_path(decode_uri(@layer_id, 'path')) || '/{map_type}'", "name", f".{ending}")
        # A field of the file with the same name would hide the virtual field.
        taken, name = layer.fields().names(), f"{map_type}_file"
        while name in taken:
            name += "_"
        layer.addExpressionField(path, field(name, "text"))
        layer.actions().addAction(
            QgsAction(
                QgsAction.ActionType.OpenUrl,
                tr("Open the image ({map_type})").format(map_type=map_type),
                f'[% "{name}" %]',
                False,
            )
        )
        tip = escaped_field(name)
        # Map tips can show these formats.
        if mission.output.image_format in ("jpg", "png"):
            tip = image_in_tip(name, 320) + tip
        tips.append(f"<p>{tip}</p>")
    pose = '[% round("yaw_deg", 2) %]°, [% round("tilt_deg", 2) %]°, [% round("roll_deg", 2) %]°'
    attitude = tr("yaw, tilt, roll: {angles}").format(angles=pose)
    layer.setMapTipTemplate(f"<b>{escaped_field('name')}</b><br/>{attitude}{''.join(tips)}")


def _above_rasters(group: MissionGroup) -> int:
    """Index below the mission's other vector layers and above its first raster."""
    found = group.find()
    children = found.children() if found is not None else []
    for index, node in enumerate(children):
        if isinstance(getattr(node, "layer", lambda: None)(), QgsRasterLayer):
            return index
    return len(children)
