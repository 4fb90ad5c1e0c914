"""Records of vector files, by GDAL's Python module (QGIS brings it along), by pyogrio, or of GeoJSON by neither."""

from __future__ import annotations

import contextlib
import importlib.util
import sys
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable

from ..errors import InvalidInput, Message
from ..resources import resource
from ..storage.files import open_foreign
from ..waiting import check_cancelled
from . import geojson

#: Geometry in well-known binary (empty if there is none), whether it was repaired, and the values of the fields.
Record = tuple[bytes, bool, tuple[Any, ...]]

#: Layers of OpenStreetMap files, the first is read if none is named.
_OSM_LAYERS = ("multipolygons", "lines", "points", "multilinestrings", "other_relations")
_OSM_ENDINGS = (".osm", ".pbf")
#: Features that pyogrio reads at once.
_PAGE = 50_000


@dataclass(frozen=True)
class RecordSource:
    """A layer that can be streamed.

    Parameters
    ----------
    layer : str
        Its name.
    crs : str
        Definition of its reference system; empty if it states none.
    fields : tuple of str
    records : callable
        Iterates over all `Record` in the layer's order.
    count : int
        Number of features, -1 if the file does not state it.
    """

    layer: str
    crs: str
    fields: tuple[str, ...]
    records: Callable[[], Iterator[Record]]
    count: int = -1


def backend() -> str:
    """Name of the module that reads files: ``osgeo``, ``pyogrio``, or empty."""
    for name in ("osgeo", "pyogrio"):
        if name in sys.modules or importlib.util.find_spec(name):
            return name
    return ""


def is_osm(path: str) -> bool:
    """Whether a file is of OpenStreetMap, by its ending."""
    return path.lower().endswith(_OSM_ENDINGS)


def layer_names(path: str) -> tuple[str, ...]:
    """Layers of a file.

    Raises
    ------
    InvalidInput
        It is no vector file.
    """
    _check(path)
    by = backend()
    if by == "osgeo":
        with _osgeo(path) as opened:
            return tuple(opened.GetLayer(place).GetName() for place in range(opened.GetLayerCount()))
    if by == "pyogrio":
        with _pyogrio(path) as reader:
            return tuple(str(name) for name in reader.list_layers(path)[:, 0])
    geojson.read_geojson(path)
    return (Path(path).stem,)


def open_records(path: str, layer: str) -> RecordSource:
    """Open a layer of a file; an empty name is its only layer, or the areas of OpenStreetMap.

    Raises
    ------
    InvalidInput
        The file cannot be read, or has no such layer.
    """
    names = layer_names(path)
    shown = Message.joined(", ", names[:20])
    if not names:
        raise InvalidInput("{0}: has no layers", Path(path).name)
    if not layer and len(names) > 1 and not is_osm(path):
        raise InvalidInput("{0}: has several layers; name one of {1}", Path(path).name, shown)
    layer = layer or (_OSM_LAYERS[0] if is_osm(path) else names[0])
    if layer not in names:
        raise InvalidInput("{0}: has no layer {1!r}, but {2}", Path(path).name, layer, shown)
    by = backend()
    if by == "osgeo":
        return _from_osgeo(path, layer)
    if by == "pyogrio":
        return _from_pyogrio(path, layer)
    crs, fields, features = geojson.read_geojson(path)
    return RecordSource(
        layer,
        crs,
        fields,
        lambda: ((shape, False, values) for shape, values in geojson.records(features, fields)),
        len(features),
    )


def _check(path: str) -> None:
    """Refuse what is no file, and descriptions that name other data (VRT), before GDAL sees them."""
    if Path(path).is_dir():
        return
    try:
        with open_foreign(path) as file:
            start = file.read(1024)
    except OSError as wrong:
        raise InvalidInput("{0}: cannot be read: {1}", Path(path).name, wrong) from wrong
    if b"<OGRVRT" in start:
        raise InvalidInput("{0}: refers to other files; name these", Path(path).name)


@contextlib.contextmanager
def _osgeo(path: str) -> Iterator[Any]:
    """Open a file by GDAL, without its messages on standard error."""
    from osgeo import gdal

    options = [f"CONFIG_FILE={resource('osmconf.ini')}"] if is_osm(path) else []
    gdal.PushErrorHandler("CPLQuietErrorHandler")
    try:
        opened, reason = None, ""
        try:
            opened = gdal.OpenEx(path, gdal.OF_VECTOR | gdal.OF_READONLY, open_options=options)
        except RuntimeError as wrong:
            reason = str(wrong)
        if opened is None:
            raise _unreadable(path, reason or gdal.GetLastErrorMsg())
        yield opened
    finally:
        gdal.PopErrorHandler()


def _unreadable(path: str, reason: str) -> InvalidInput:
    name = Path(path).name
    if not reason:
        return InvalidInput("{0}: not a vector file that can be read", name)
    return InvalidInput("{0}: cannot be read: {1}", name, " ".join(reason.split())[:200])


def _stated(crs: str) -> str:
    """A definition, or nothing for the stand-ins of GeoPackages, "Undefined geographic SRS" and such."""
    return "" if '["Undefined ' in crs[:40] else crs


def _from_osgeo(path: str, layer: str) -> RecordSource:
    with _osgeo(path) as opened:
        found = opened.GetLayerByName(layer)
        reference = found.GetSpatialRef()
        defined = found.GetLayerDefn()
        fields = tuple(defined.GetFieldDefn(place).GetName() for place in range(defined.GetFieldCount()))
        crs = reference.ExportToWkt(["FORMAT=WKT2_2018"]) if reference is not None else ""
        count = found.GetFeatureCount(force=0)
    return RecordSource(layer, _stated(crs), fields, lambda: _osgeo_records(path, layer), count)


def _osgeo_records(path: str, layer: str) -> Iterator[Record]:
    with _osgeo(path) as opened:
        found = opened.GetLayerByName(layer)
        defined = found.GetLayerDefn()
        kinds = [defined.GetFieldDefn(place).GetType() for place in range(defined.GetFieldCount())]
        for feature in _osgeo_features(opened, found, layer, is_osm(path)):
            shape, repaired = _osgeo_shape(feature.GetGeometryRef())
            yield shape, repaired, tuple(_osgeo_value(feature, place, kind) for place, kind in enumerate(kinds))


def _osgeo_features(opened: Any, found: Any, layer: str, mixed: bool) -> Iterator[Any]:
    """Features of a layer; those of OpenStreetMap come mixed with those of other layers, in bounded memory."""
    if not mixed:
        while (feature := found.GetNextFeature()) is not None:
            yield feature
        return
    opened.ResetReading()
    while True:
        # Millions of features may come before the first one of the layer.
        check_cancelled()
        answer = opened.GetNextFeature()
        if answer is None or answer[0] is None:
            return
        feature, owner = answer[:2]
        if owner.GetName() == layer:
            yield feature


def _osgeo_shape(geometry: Any) -> tuple[bytes, bool]:
    from osgeo import ogr

    if geometry is None or geometry.IsEmpty():
        return b"", False
    if geometry.HasCurveGeometry():
        geometry = geometry.GetLinearGeometry()
    geometry.FlattenTo2D()
    repaired = geometry.GetDimension() == 2 and not geometry.IsValid()
    if repaired:
        geometry = geometry.MakeValid()
        if geometry is None or geometry.IsEmpty() or geometry.GetDimension() < 2:
            return b"", True
    return bytes(geometry.ExportToWkb(ogr.wkbNDR)), repaired


def _osgeo_value(feature: Any, place: int, kind: int) -> Any:
    from osgeo import ogr

    if not feature.IsFieldSetAndNotNull(place):
        return None
    if kind in (ogr.OFTInteger, ogr.OFTInteger64):
        return int(feature.GetField(place))
    if kind == ogr.OFTReal:
        return float(feature.GetField(place))
    text = feature.GetFieldAsString(place)
    return text.replace("/", "-").replace(" ", "T") if kind in (ogr.OFTDate, ogr.OFTDateTime) else text


@contextlib.contextmanager
def _pyogrio(path: str) -> Iterator[Any]:
    import pyogrio

    if is_osm(path):
        pyogrio.set_gdal_config_options({"OSM_CONFIG_FILE": str(resource("osmconf.ini"))})
    try:
        yield pyogrio
    except (pyogrio.errors.DataSourceError, pyogrio.errors.DataLayerError) as wrong:
        raise _unreadable(path, str(wrong)) from wrong


def _from_pyogrio(path: str, layer: str) -> RecordSource:
    with _pyogrio(path) as reader:
        about = reader.read_info(path, layer=layer)
    fields = tuple(str(name) for name in about["fields"])
    kinds = dict(zip(fields, (str(kind) for kind in about["dtypes"])))
    crs, count = _stated(about["crs"] or ""), int(about["features"])
    return RecordSource(layer, crs, fields, lambda: _pyogrio_records(path, layer, kinds), count)


def _pyogrio_records(path: str, layer: str, kinds: dict[str, str]) -> Iterator[Record]:
    import pyogrio.raw

    page, size = 0, _PAGE
    while size == _PAGE:
        with _pyogrio(path), warnings.catch_warnings():
            # GDAL's remarks on geometries that are repaired or left out, and counted.
            warnings.simplefilter("ignore", RuntimeWarning)
            about, _, shapes, columns = pyogrio.raw.read(
                path, layer=layer, force_2d=True, skip_features=page, max_features=_PAGE, datetime_as_string=True
            )
        size, page = len(shapes), page + _PAGE
        order = [list(about["fields"]).index(name) for name in kinds]
        values = [_plain_column(columns[place], kinds[name]) for place, name in zip(order, kinds)]
        repaired = _made_valid(shapes)
        rows = zip(*values) if values else iter([()] * size)
        yield from zip(repaired[0], repaired[1], rows)


def _plain_column(column: Any, kind: str) -> list[Any]:
    if kind.startswith(("int", "uint", "bool")):
        return [None if value != value or value is None else int(value) for value in column.tolist()]
    if kind.startswith("float"):
        return [None if value != value else float(value) for value in column.tolist()]
    return [None if value is None or value != value else str(value) for value in column.tolist()]


def _made_valid(shapes: Any) -> tuple[list[bytes], list[bool]]:
    """Geometries with self-crossing areas repaired, and which were."""
    import shapely

    made = shapely.from_wkb(shapes, on_invalid="ignore")
    wrong = (shapely.get_dimensions(made) == 2) & ~shapely.is_valid(made) & ~shapely.is_missing(made)
    made[wrong] = shapely.make_valid(made[wrong])
    made[shapely.is_empty(made) | (wrong & (shapely.get_dimensions(made) < 2))] = None
    binary = shapely.to_wkb(made, byte_order=1)
    return [one or b"" for one in binary.tolist()], wrong.tolist()
