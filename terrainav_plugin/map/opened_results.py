"""Layers of a dataset, opened away from the main thread: a large file is read for seconds."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from qgis.core import (
    QgsApplication,
    QgsBilinearRasterResampler,
    QgsCoordinateReferenceSystem,
    QgsMapLayer,
    QgsRasterLayer,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QThread

from ...core.dataset.folder import FOOTPRINTS_FILE
from ...core.errors import OutputError
from ..i18n import tr
from ..threads import CRS_IDS
from .failed_images import FAILED_FILE
from .mosaic import Mosaic

if TYPE_CHECKING:
    from ...core.mission.mission import Mission


class OpenedResults(NamedTuple):
    """Layers of a dataset that are in no project yet; they belong to the main thread.

    A mosaic that is still to be put in its place has none.
    """

    folder: Path
    mission: Mission
    footprints: QgsVectorLayer
    mosaics: list[tuple[Mosaic, QgsRasterLayer | None]]


def open_results(folder: Path, mission: Mission, mosaics: list[Mosaic]) -> OpenedResults:
    """Open the footprints of a dataset and its mosaics, on any thread.

    Raises
    ------
    OutputError
        Where QGIS cannot open one of them.
    """
    footprints = open_footprints(folder / FOOTPRINTS_FILE, tr("Captured images"))
    # Of a mission they stay where they are: a project that is opened need not read them for their extent. Newer QGIS
    # (3.40) leaves that to the project's own setting, which is the user's.
    footprints.setReadExtentFromXml(True)
    footprints = _for_main_thread(footprints)
    opened = [
        None if mosaic.is_made else _for_main_thread(open_raster(mosaic.path, mosaic.title))
        for mosaic in mosaics
    ]
    return OpenedResults(folder, mission, footprints, list(zip(mosaics, opened)))


def open_failed(folder: Path) -> QgsVectorLayer | None:
    """Open what has failed of a dataset, on any thread; None where nothing has."""
    path = folder / FAILED_FILE
    return _for_main_thread(open_footprints(path, tr("Failed images"))) if path.is_file() else None


def open_footprints(path: Path, title: str) -> QgsVectorLayer:
    """Open a file of footprints as a layer; raises OutputError."""
    layer = QgsVectorLayer(str(path), title, "ogr")
    if not layer.isValid():
        raise OutputError(f"footprints {path}: QGIS cannot open them")
    # QGIS asks for it on the main thread as soon as the layer is there, and then reads the whole file; it keeps it.
    layer.extent()
    return layer


def open_raster(path: Path, title: str) -> QgsRasterLayer:
    """Open a picture as a layer; raises OutputError."""
    layer = QgsRasterLayer(str(path), title, "gdal")
    if not layer.isValid():
        raise OutputError(f"picture {path}: QGIS cannot open it")
    # Smooth where several pixels of the picture share one of the screen; pixels stay pixels when enlarged.
    layer.resampleFilter().setZoomedOutResampler(QgsBilinearRasterResampler())
    return layer


def _for_main_thread(layer: QgsMapLayer) -> QgsMapLayer:
    main = QgsApplication.instance().thread()
    if QThread.currentThread() != main:
        # The same CRS, but as the main thread has read it (see `threads`); one that is equal would not be taken.
        held = QgsCoordinateReferenceSystem(layer.crs().authid())
        layer.setCrs(QgsCoordinateReferenceSystem(next(other for other in CRS_IDS if other != held.authid())))
        layer.setCrs(held)
        layer.moveToThread(main)
    return layer
