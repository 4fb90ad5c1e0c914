"""The result of a run on the map: one mosaic for each map type, and the footprints."""

from __future__ import annotations

from pathlib import Path

from qgis.core import QgsBilinearRasterResampler, QgsMapLayer, QgsRasterLayer, QgsVectorLayer

from ..core.errors import OutputError
from .i18n import tr
from .mission_group import CAPTURED, MissionGroup
from .mosaic import Mosaic
from .paths import style


def load_results(group: MissionGroup, folder: Path, mosaics: list[Mosaic]) -> list[QgsMapLayer]:
    """Add a run's layers to its mission's group; those that are there already read their files anew.

    Raises
    ------
    OutputError
        Where QGIS cannot open what was written.
    """
    from ..core.capture.folder import FOOTPRINTS_FILE

    layers: list[QgsMapLayer] = [_mosaic_layer(group, mosaic) for mosaic in mosaics]
    layers.insert(0, _footprints_layer(group, folder / FOOTPRINTS_FILE))
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


def _footprints_layer(group: MissionGroup, path: Path) -> QgsMapLayer:
    layer = group.layer(CAPTURED)
    if layer is None:
        layer = QgsVectorLayer(str(path), tr("Captured images"), "ogr")
        if not layer.isValid():
            raise OutputError(f"footprints {path}: QGIS cannot open them")
        layer.loadNamedStyle(style("captured"))
        group.add(layer, CAPTURED, _above_rasters(group)).setExpanded(False)
    else:
        _read_again(layer, path)
    return layer


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
