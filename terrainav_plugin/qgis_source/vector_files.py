"""Vector layers of the project as files, which the core reads without QGIS."""

from __future__ import annotations

import hashlib
from pathlib import Path

from qgis.core import (
    QgsApplication,
    QgsCategorizedSymbolRenderer,
    QgsCoordinateTransformContext,
    QgsFeature,
    QgsProviderRegistry,
    QgsVectorFileWriter,
    QgsVectorLayer,
)

from ...core.errors import OutputError
from ...core.labels.classes import SIDE_FILE
from ...core.storage.files import json_bytes, write_whole

#: Prefix of GDAL's virtual files, whose names GDAL alone understands.
_VIRTUAL = "/vsi"


def layer_file(layer: QgsVectorLayer, field: str = "") -> str:
    """Name of a layer as FILE or FILE:LAYER: its own file, or a GeoPackage with a copy of what the map shows.

    Copied are layers without a file, filtered layers, and layers with changes that are not saved. A copy is named by
    its content, so that an unchanged layer has an unchanged name. Beside it are the names and colours that the map's
    symbols give the values of a field; beside the user's own files nothing is written.

    Raises
    ------
    OutputError
        The copy cannot be written.
    """
    return _own_file(layer) or _copied(layer, _classes(layer, field))


def _classes(layer: QgsVectorLayer, field: str) -> list[dict[str, object]]:
    """Values of a field with the names and colours of their categories; empty if the map does not tell them apart."""
    renderer = layer.renderer()
    if not (field and isinstance(renderer, QgsCategorizedSymbolRenderer) and renderer.classAttribute() == field):
        return []
    found = []
    for category in renderer.categories():
        values = category.value() if isinstance(category.value(), list) else [category.value()]
        for value in values:
            # The category of all other values has none.
            if isinstance(value, (str, int, float)) and value != "" and category.renderState():
                text = str(int(value)) if isinstance(value, float) and value.is_integer() else str(value)
                name = category.label() or text
                found.append({"value": text, "name": name, "color": category.symbol().color().name()})
    return found


def _own_file(layer: QgsVectorLayer) -> str:
    """Name of the layer's own file; empty if it has none, or if the map shows something else."""
    if layer.providerType() != "ogr" or layer.isModified() or layer.subsetString():
        return ""
    parts = QgsProviderRegistry.instance().decodeUri("ogr", layer.source())
    path = str(parts.get("path") or "")
    if not path or path.startswith(_VIRTUAL) or not Path(path).is_file() or parts.get("geometryType"):
        return ""
    name = str(parts.get("layerName") or "")
    return f"{path}:{name}" if name else path


def _copied(layer: QgsVectorLayer, classes: list[dict[str, object]]) -> str:
    folder = Path(QgsApplication.qgisSettingsDirPath()) / "terrainav" / "layers"
    name = "".join(sign if sign.isalnum() else "_" for sign in layer.name())[:60] or "layer"
    table = json_bytes({"classes": classes}) if classes else b""
    path = folder / f"{name}-{_content_hash(layer, table)}.gpkg"
    if not path.is_file():
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as wrong:
            raise OutputError("folder {0}: cannot be written ({1})", folder, wrong.strerror) from wrong
        options = QgsVectorFileWriter.SaveVectorOptions()
        options.driverName, options.layerName = "GPKG", name
        partial = path.with_suffix(".partial.gpkg")
        failed, reason = QgsVectorFileWriter.writeAsVectorFormatV3(
            layer, str(partial), QgsCoordinateTransformContext(), options
        )[:2]
        if failed != QgsVectorFileWriter.WriterError.NoError:
            partial.unlink(missing_ok=True)
            raise OutputError("layer {0}: cannot be written to {1} ({2})", layer.name(), path, reason)
        if table:
            write_whole(path.with_suffix(SIDE_FILE), table)
        partial.replace(path)
    return f"{path}:{name}"


def _content_hash(layer: QgsVectorLayer, table: bytes) -> str:
    """Hash of a layer's reference system, fields, geometries and attributes, and of its table of classes."""
    found = hashlib.sha256(layer.crs().toWkt().encode("utf-8") + table)
    found.update(repr([field.name() for field in layer.fields()]).encode("utf-8"))
    feature = QgsFeature()
    features = layer.getFeatures()
    while features.nextFeature(feature):
        found.update(bytes(feature.geometry().asWkb()))
        found.update(repr(feature.attributes()).encode("utf-8"))
    return found.hexdigest()[:16]
