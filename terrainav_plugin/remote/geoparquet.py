"""Conversion of the GeoParquet table of a dataset's images to footprints and tables.

Fetching the table takes a fraction of the bytes. QGIS's official builds have the GDAL driver; without it, the
footprints and tables themselves are copied.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path, PurePosixPath
from typing import Any

from osgeo import gdal, ogr

from ...core.dataset.folder import FOOTPRINTS_FILE, TABLE_FILE
from ...core.dataset.vectors import json_without_tags
from ...core.errors import Cancelled, InvalidInput
from ...core.storage.files import write_whole
from ...core.text.plain import one_line
from ..i18n import tr

ITEMS_FILE = "items.parquet"
_DRIVER = "Parquet"
_NAMES, _MAP_TYPE = "img_names", "map_type"
#: Columns of items that tables do not have; structures become columns with dotted names in GDAL.
_OF_ITEMS = frozenset(
    "type stac_version stac_extensions id collection bbox links assets datetime start_datetime end_datetime gsd".split()
)
#: Columns of tables, by the property of footprints with the same value.
_PROPERTIES = {
    "column": "columns",
    "row": "rows",
    "lat_deg": "pose_lat_deg",
    "lon_deg": "pose_lon_deg",
    "agl_m": "agl_m",
    "yaw_deg": "yaw_deg",
    "tilt_deg": "tilt_deg",
    "roll_deg": "roll_deg",
    "zoom": "Alt",
    "time": "time_utc",
    "left_px": "left_px",
    "top_px": "top_px",
    "width_px": "width_px",
    "height_px": "height_px",
}
Progress = Callable[[float], bool]


def can_read() -> bool:
    """Whether this GDAL reads GeoParquet."""
    return gdal.GetDriverByName(_DRIVER) is not None


def write_from_items(items: Path, folder: Path, map_types: Sequence[str], go_on: Progress) -> None:
    """Write footprints and tables of a dataset like a capture, except for failed images.

    Parameters
    ----------
    items : Path
        GeoParquet file.
    folder : Path
        Folder of the copy.
    map_types : sequence of str
    go_on : callable
        Takes the share done; returns whether to continue.

    Raises
    ------
    InvalidInput
        The file cannot be read, or describes other images.
    OutputError, Cancelled
    """
    try:
        table = gdal.OpenEx(str(items), gdal.OF_VECTOR, allowed_drivers=[_DRIVER])
        layer = None if table is None else table.GetLayer(0)
        if layer is None:
            raise _unreadable(items, gdal.GetLastErrorMsg())
        definition = layer.GetLayerDefn()
        names = [definition.GetFieldDefn(at).GetName() for at in range(definition.GetFieldCount())]
        if not {_NAMES, _MAP_TYPE, "columns", "rows"} <= {*names}:
            raise _unreadable(items, tr("it does not list images of a capture"))
        headers = [_NAMES] + [
            name
            for name in names
            if name not in (_NAMES, _MAP_TYPE, *_OF_ITEMS) and "." not in name and ":" not in name
        ]
        passes = 1 + len(map_types)
        features = _checked_features(layer, lambda share: go_on(share / passes))
        write_whole(folder / FOOTPRINTS_FILE, _footprints(items, features, {*names}))
        for number, map_type in enumerate(map_types, 1):
            layer.SetAttributeFilter(f"{_MAP_TYPE} = '{map_type}'")
            features = _checked_features(layer, lambda share, number=number: go_on((number + share) / passes))
            write_whole(folder / map_type / TABLE_FILE, _rows(features, headers))
    except RuntimeError as wrong:
        # GDAL raises RuntimeError if exceptions are enabled.
        raise _unreadable(items, wrong) from wrong


def _checked_features(layer: ogr.Layer, go_on: Progress) -> Iterator[ogr.Feature]:
    count = max(layer.GetFeatureCount(), 1)
    layer.ResetReading()
    for number, feature in enumerate(layer):
        # Check for cancellation every 500 items.
        if number % 500 == 0 and not go_on(number / count):
            raise Cancelled(tr("footprints: stopped"))
        yield feature


def _footprints(items: Path, features: Iterator[ogr.Feature], names: set[str]) -> Iterator[bytes]:
    """Lines of a footprint file; an image of several map types has one line."""
    known: set[str] = set()
    yield b'{"type": "FeatureCollection", "features": [\n'
    for feature in features:
        stem = PurePosixPath(str(feature[_NAMES])).stem
        if stem in known:
            continue
        properties: dict[str, Any] = {"name": stem}
        for name, header in _PROPERTIES.items():
            value = feature[header] if header in names else None
            if value is not None:
                properties[name] = value
        shape = feature.GetGeometryRef()
        geometry = json.loads(shape.ExportToJson()) if shape is not None else {}
        if geometry.get("type") not in ("Polygon", "MultiPolygon"):
            raise _unreadable(items, tr("it has no footprints"))
        about = {"type": "Feature", "properties": properties, "geometry": geometry}
        text = json_without_tags(json.dumps(about, ensure_ascii=False))
        yield (",\n" if known else "").encode() + text.encode()
        known.add(stem)
    yield b"\n]}\n"


def _rows(features: Iterator[ogr.Feature], headers: Sequence[str]) -> Iterator[bytes]:
    """Lines of a table."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(headers)
    for feature in features:
        values = (feature[header] for header in headers)
        writer.writerow(["" if value is None else value for value in values])
        yield text.getvalue().encode()
        text.seek(0)
        text.truncate()
    yield text.getvalue().encode()


def _unreadable(items: Path, reason: object) -> InvalidInput:
    return InvalidInput(tr("table {path}: cannot be read ({reason})").format(path=items, reason=one_line(str(reason))))
