"""The result of a run on the map: one mosaic of map frames for each map type, and the footprints."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import (
    QgsAction,
    QgsBilinearRasterResampler,
    QgsField,
    QgsMapLayer,
    QgsRasterLayer,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QVariant

from ...core.errors import OutputError
from ..i18n import tr
from ..paths import style
from .mission_group import CAPTURED, MissionGroup
from .mosaic import Mosaic

if TYPE_CHECKING:
    from ...core.mission.mission import Mission

#: Formats that map tips can show.
_SHOWN_IN_TIPS = ("jpg", "png")
_TIP_PX = 320


def load_results(
    group: MissionGroup, folder: Path, mosaics: list[Mosaic], mission: Mission
) -> list[QgsMapLayer]:
    """Add a run's layers to its mission's group; those that are there already read their files anew.

    Raises
    ------
    OutputError
        Where QGIS cannot open what was written.
    """
    from ...core.capture.folder import FOOTPRINTS_FILE

    layers: list[QgsMapLayer] = [_mosaic_layer(group, mosaic) for mosaic in mosaics]
    layers.insert(0, _footprints_layer(group, folder / FOOTPRINTS_FILE, mission))
    return layers


def load_test_shot(group: MissionGroup, picture: Path, title: str) -> QgsRasterLayer:
    """Add the picture of a test shot to the group; raises OutputError where QGIS cannot open it."""
    layer = _raster_layer(picture, title)
    group.add(layer, "test-shot", 0).setExpanded(False)
    return layer


def _mosaic_layer(group: MissionGroup, mosaic: Mosaic) -> QgsMapLayer:
    role = f"mosaic/{mosaic.path.name}"
    layer = group.layer(role)
    if layer is None:
        layer = _raster_layer(mosaic.path, mosaic.title)
        group.add(layer, role, -1).setExpanded(False)
    else:
        _read_again(layer, mosaic.path)
    return layer


def _raster_layer(path: Path, title: str) -> QgsRasterLayer:
    layer = QgsRasterLayer(str(path), title, "gdal")
    if not layer.isValid():
        raise OutputError(f"picture {path}: QGIS cannot open it")
    # Smooth where several pixels of the picture share one of the screen; pixels stay pixels when enlarged.
    layer.resampleFilter().setZoomedOutResampler(QgsBilinearRasterResampler())
    return layer


def _footprints_layer(group: MissionGroup, path: Path, mission: Mission) -> QgsMapLayer:
    layer = group.layer(CAPTURED)
    if layer is None:
        layer = QgsVectorLayer(str(path), tr("Captured images"), "ogr")
        if not layer.isValid():
            raise OutputError(f"footprints {path}: QGIS cannot open them")
        layer.loadNamedStyle(style("captured"))
        _name_pictures(layer, mission)
        group.add(layer, CAPTURED, _above_rasters(group)).setExpanded(False)
    else:
        _read_again(layer, path)
    return layer


def _name_pictures(layer: QgsVectorLayer, mission: Mission) -> None:
    """Give footprints the paths of their pictures: as attributes, in map tips, and to be opened.

    Paths follow the layer: a folder can be moved together with its project.
    """
    tips = []
    for map_type in mission.map_types:
        path = f"file_path(decode_uri(@layer_id, 'path')) || '/{map_type}/' || \"name\" || '.{mission.image_format}'"
        field = f"{map_type}_file"
        layer.addExpressionField(path, QgsField(field, QVariant.String))
        layer.actions().addAction(
            QgsAction(
                QgsAction.ActionType.OpenUrl,
                tr("Open the picture ({map_type})").format(map_type=map_type),
                f'[% "{field}" %]',
                False,
            )
        )
        tip = f'[% "{field}" %]'
        if mission.image_format in _SHOWN_IN_TIPS:
            tip = f'<img src="file:///{tip}" width="{_TIP_PX}"/><br/>{tip}'
        tips.append(f"<p>{tip}</p>")
    pose = '[% round("yaw_deg", 2) %]°, [% round("tilt_deg", 2) %]°, [% round("roll_deg", 2) %]°'
    attitude = tr("yaw, tilt, roll: {angles}").format(angles=pose)
    layer.setMapTipTemplate(f'<b>[% "name" %]</b><br/>{attitude}{"".join(tips)}')


def _above_rasters(group: MissionGroup) -> int:
    """Place below the mission's other vector layers and above its first raster."""
    found = group.find()
    children = found.children() if found is not None else []
    for index, node in enumerate(children):
        if isinstance(getattr(node, "layer", lambda: None)(), QgsRasterLayer):
            return index
    return len(children)


def _read_again(layer: QgsMapLayer, path: Path) -> None:
    layer.setDataSource(str(path), layer.name(), layer.providerType(), layer.dataProvider().ProviderOptions())
    layer.triggerRepaint()
