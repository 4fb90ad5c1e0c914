"""Layers of a dataset, opened off the main thread, and the file of its failed images."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from qgis.core import (
    Qgis,
    QgsApplication,
    QgsBilinearRasterResampler,
    QgsCoordinateReferenceSystem,
    QgsGeometryGeneratorSymbolLayer,
    QgsLineSymbol,
    QgsMapLayer,
    QgsRasterLayer,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import Qt, QThread

from ...core.capture.journal import FAILED, Outcome
from ...core.dataset.folder import FOOTPRINTS_FILE, JOURNAL_FILE
from ...core.dataset.vectors import json_without_tags
from ...core.errors import InvalidInput, OutputError
from ...core.limits import MAX_JOURNAL_LINE_BYTES
from ...core.storage.files import file_exists, open_foreign, write_whole
from ..foreign import check_raster, check_vector
from ..i18n import tr, translate
from ..map.canvas import LON_LAT
from ..map.outlines import CUTS_WKT
from ..tasks import CRS_IDS, crs_named, read_crs_on_main_thread
from .footprints import feature_lines, read_feature
from .mosaic import MosaicRaster

if TYPE_CHECKING:
    from ...core.mission.mission import Mission

#: Name of the file of failed images, in the folder of the dataset.
FAILED_FILE = "failed.geojson"
_FAILED_MARK = f'"{FAILED}"'.encode()
_WITHOUT_CUTS = f"difference(boundary($geometry), geom_from_wkt('{CUTS_WKT}'))"
_NAME = re.compile(rb'"name": "([^"]*)"')


class OpenedResults(NamedTuple):
    """Layers of a dataset that are not in a project yet; they belong to the main thread.

    A mosaic has no layer if it still has to be put in place, or if only the main thread can open it. Images have no
    paths if they are not files in the folder.
    """

    folder: Path
    mission: Mission
    footprints: QgsVectorLayer
    mosaics: list[tuple[MosaicRaster, QgsRasterLayer | None]]
    has_paths: bool = True


def open_results(folder: Path, mission: Mission, mosaics: list[MosaicRaster]) -> OpenedResults:
    """Open the footprints of a dataset and its mosaics, on any thread.

    Raises
    ------
    InvalidInput, OutputError
        A file does not have the format of its name, or QGIS cannot open it.
    """
    footprints = open_footprints(folder / FOOTPRINTS_FILE, tr("Captured images"))
    # The footprints of a mission do not change: opening a project need not read their extent from the file. From 3.40
    # the user can choose this for a whole project.
    footprints.setReadExtentFromXml(True)
    footprints = _move_to_main_thread(footprints)
    opened = [None if mosaic.is_made else _opened(mosaic) for mosaic in mosaics]
    return OpenedResults(folder, mission, footprints, list(zip(mosaics, opened)))


def _opened(mosaic: MosaicRaster) -> QgsRasterLayer | None:
    crs = mosaic.crs()
    return _move_to_main_thread(open_raster(mosaic.path, mosaic.title), crs) if read_crs_on_main_thread(crs) else None


def open_footprints(path: Path, title: str) -> QgsVectorLayer:
    """Open a file of footprints as a layer; raises InvalidInput and OutputError.

    A style file of the same name is ignored: it might fetch symbols from servers, and run actions.
    """
    check_vector(path)
    options = QgsVectorLayer.LayerOptions()
    options.loadDefaultStyle = False
    layer = QgsVectorLayer(str(path), title, "ogr", options)
    if not layer.isValid():
        raise OutputError("footprints {0}: QGIS cannot open them", path)
    # Cache the extent: QGIS would otherwise read the whole file for it on the main thread.
    layer.extent()
    return layer


def hide_antimeridian(layer: QgsVectorLayer) -> None:
    """Hide outlines along ±180° and the poles, where files cut footprints: near a pole, they would cross the map.

    Change only layers that reach both, as drawing by an expression is slower.
    """
    extent = layer.extent()
    if extent.xMinimum() > -180.0 or extent.xMaximum() < 180.0:
        return
    symbol = layer.renderer().symbol()
    outline = symbol.symbolLayer(0)
    line = QgsLineSymbol.createSimple({"joinstyle": "miter"})
    line.setColor(outline.strokeColor())
    line.setWidth(outline.strokeWidth())
    drawn = QgsGeometryGeneratorSymbolLayer.create({"geometryModifier": _WITHOUT_CUTS})
    drawn.setSymbolType(Qgis.SymbolType.Line)
    drawn.setSubSymbol(line)
    outline.setStrokeStyle(Qt.PenStyle.NoPen)
    symbol.appendSymbolLayer(drawn)


def open_raster(path: Path, title: str) -> QgsRasterLayer:
    """Open an image as a layer, ignoring a style file of the same name; raises OutputError."""
    try:
        check_raster(path)
    except InvalidInput as wrong:
        raise OutputError("{0}", wrong) from wrong
    options = QgsRasterLayer.LayerOptions()
    options.loadDefaultStyle = False
    layer = QgsRasterLayer(str(path), title, "gdal", options)
    if not layer.isValid():
        raise OutputError("image {0}: QGIS cannot open it", path)
    # Interpolate only reduced images; enlarged pixels stay squares.
    layer.resampleFilter().setZoomedOutResampler(QgsBilinearRasterResampler())
    return layer


def open_failed(folder: Path) -> QgsVectorLayer | None:
    """Open the failed images of a dataset, on any thread; None if none has failed."""
    path = folder / FAILED_FILE
    return _move_to_main_thread(open_footprints(path, tr("Failed images"))) if file_exists(path) else None


class FailedImages:
    """The failed images of a dataset, read from its growing journal.

    Works on any thread, during a run in this or another process: only files are used.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._read_bytes = 0
        self._reasons: dict[tuple[str, str], str] = {}
        self._footprints: dict[str, dict[str, Any] | None] = {}
        self._written: dict[tuple[str, str], str] | None = None

    @property
    def path(self) -> Path:
        """Path of the file of failed images."""
        return self._folder / FAILED_FILE

    def __len__(self) -> int:
        return len(self._reasons)

    def update(self) -> bool:
        """Write the file of failed images from the journal, or remove it; return whether the failures have changed.

        Without failures the file does not exist.

        Raises
        ------
        OutputError
            The journal or the footprints cannot be read, or the file cannot be written or removed.
        """
        try:
            self._follow_journal()
            if self._reasons == self._written:
                return False
            self._find_footprints()
            if not self._reasons:
                self.path.unlink(missing_ok=True)
        except (OSError, InvalidInput) as wrong:
            raise OutputError(
                "failed images of {0}: cannot be written ({1})",
                self._folder,
                getattr(wrong, "strerror", None) or wrong,
            ) from wrong
        if self._reasons:
            write_whole(self.path, self._lines())
        self._written = dict(self._reasons)
        return True

    def _follow_journal(self) -> None:
        path = self._folder / JOURNAL_FILE
        if not file_exists(path):
            return
        with open_foreign(path) as file:
            file.seek(self._read_bytes)
            rest = b""
            # Read large blocks: a thread that reads little at a time holds up all other threads.
            while chunk := file.read(1 << 20):
                # A run is still writing the text after the last line end.
                whole, _, rest = (rest + chunk).rpartition(b"\n")
                self._note(whole)
                if len(rest) > MAX_JOURNAL_LINE_BYTES:
                    rest = b""
                self._read_bytes = file.tell() - len(rest)

    def _note(self, lines: bytes) -> None:
        # Most journals are long and have no failures: parsing every line would hold up all other threads.
        if not self._reasons and _FAILED_MARK not in lines:
            return
        for line in lines.split(b"\n"):
            outcome = Outcome.from_line(line)
            if outcome is None:
                continue
            if outcome.status == FAILED:
                self._reasons[outcome.map_type, outcome.name] = outcome.reason
            else:
                self._reasons.pop((outcome.map_type, outcome.name), None)

    def _find_footprints(self) -> None:
        """Copy the footprints of new failures from the dataset's file, one per line."""
        wanted = {name for _, name in self._reasons} - set(self._footprints)
        if not wanted:
            return
        for line in feature_lines(self._folder / FOOTPRINTS_FILE):
            found = _NAME.search(line)
            name = found[1].decode("utf-8", "replace") if found else ""
            if name in wanted:
                self._footprints[name] = _footprint(line)

    def _lines(self) -> list[bytes]:
        features = []
        for (map_type, name), reason in self._reasons.items():
            footprint = self._footprints.get(name)
            if footprint is None:
                continue
            more = {"map_type": map_type, "reason": translate(reason)}
            feature = {**footprint, "properties": {**footprint["properties"], **more}}
            features.append(json_without_tags(json.dumps(feature, ensure_ascii=False)).encode("utf-8"))
        return [b'{"type": "FeatureCollection", "features": [\n', b",\n".join(features), b"\n]}\n"]


def _move_to_main_thread(layer: QgsMapLayer, crs: str = LON_LAT) -> QgsMapLayer:
    main = QgsApplication.instance().thread()
    if QThread.currentThread() != main:
        # Set the CRS that the main thread has read (see `tasks`). First set another CRS, as QGIS ignores an equal one.
        layer.setCrs(QgsCoordinateReferenceSystem(next(other for other in CRS_IDS if other != crs)))
        layer.setCrs(crs_named(crs))
        layer.moveToThread(main)
    return layer


def _footprint(line: bytes) -> dict[str, Any] | None:
    """Feature of a line; None if the line was not written by a capture."""
    try:
        feature = read_feature(line)
    except InvalidInput:
        return None
    return feature if isinstance(feature.get("properties"), dict) else None
