"""Tables of a dataset as Parquet: columns with their types, and footprints as GeoParquet has them."""

from __future__ import annotations

import json
import os
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..dataset.dataset import Dataset, ImageSet, read_dataset
from ..dataset.folder import FOOTPRINTS_FILE, TABLE_FILE
from ..dataset.table import NUMBER, TEXT, TIME, Column, columns_of
from ..errors import InvalidInput, OutputError
from ..files import make_folder, new_folder, write_whole
from ..safe_json import parse_json

#: Beside ``meta_data.csv``, or in a folder of the same name elsewhere.
PARQUET_FILE = TABLE_FILE.replace(".csv", ".parquet")
#: Column of the footprints, and the version of GeoParquet that tells of it.
GEOMETRY, GEOPARQUET = "geometry", "1.1.0"
#: Of well-known binary: the byte order of most machines, and kinds of geometries.
_LITTLE, _POLYGON, _MULTIPOLYGON = 1, 3, 6
#: How the lines of features in a capture's GeoJSON begin.
_FEATURE = b'{"type": "Feature",'
_BLOCK_BYTES = 1 << 20


def write_parquet(
    folder: str | os.PathLike[str], target: str | os.PathLike[str], map_type: str | None = None
) -> list[Path]:
    """Write the tables of a dataset as Parquet, one for each map type; returns the files.

    They have the columns of ``meta_data.csv``, of whole numbers, numbers, times and texts, null where nothing is known.
    A column ``geometry`` has the footprints, in longitude and latitude of WGS 84, where the capture has left them.

    Parameters
    ----------
    target : path
        A new or empty folder; or the dataset's own: files then lie beside ``meta_data.csv``, and those of earlier
        exports are replaced.
    map_type : str or None
        One alone.

    Raises
    ------
    InvalidInput
        A folder that is no dataset, or has no such map type.
    OutputError
        A folder that cannot be written or is not empty, or no pyarrow.
    """
    arrow, parquet = _pyarrow()
    dataset = read_dataset(folder)
    sets = chosen_sets(dataset, map_type).values()
    root = dataset.folder if is_same(dataset.folder, target) else new_folder(target)
    written = []
    for images in sets:
        buffer = arrow.BufferOutputStream()
        parquet.write_table(_table(arrow, images), buffer, compression="zstd")
        path = root / relative_folder(dataset, images) / PARQUET_FILE
        make_folder(path.parent)
        write_whole(path, buffer.getvalue().to_pybytes())
        written.append(path)
    return written


def chosen_sets(dataset: Dataset, map_type: str | None) -> dict[str, ImageSet]:
    """Images of one map type, or of all for None, by their names."""
    return dict(dataset.image_sets) if map_type is None else {map_type: dataset.image_set(map_type)}


def relative_folder(dataset: Dataset, images: ImageSet) -> Path:
    """Folder of a table in its dataset's: ``satellite``, ``2014/satellite``, or ``.`` where they are one."""
    return images.folder.resolve().relative_to(dataset.folder.resolve())


def is_same(folder: Path, other: str | os.PathLike[str]) -> bool:
    """Whether two paths are of one folder."""
    return folder.resolve() == Path(other).resolve()


def _pyarrow() -> tuple[Any, Any]:
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError as missing:
        raise OutputError(
            "format parquet: pyarrow cannot be imported ({0})",
            missing,
            remedy="get it with: pip install 'terrainav[parquet]'",
        ) from missing
    return pa, pq


def _table(arrow: Any, images: ImageSet) -> Any:
    """Arrow table of a map type."""
    columns = columns_of(images.table)
    arrays = {one.header: _array(arrow, one) for one in columns}
    shown = _Footprints.read(images)
    if shown is None:
        return arrow.table(arrays)
    if GEOMETRY not in arrays:
        arrays[GEOMETRY] = arrow.array(shown.shapes, arrow.binary())
    return arrow.table(arrays).replace_schema_metadata({"geo": json.dumps(shown.about())})


def _array(arrow: Any, column: Column) -> Any:
    """Arrow array of a column."""
    if column.kind == TEXT:
        return arrow.array([text or None for text in column.values], arrow.string())
    values = np.asarray(column.values)
    unknown = np.isnan(values) if values.dtype.kind == "f" else np.zeros(len(values), bool)
    if column.kind == NUMBER:
        return arrow.array(values, arrow.float64(), mask=unknown)
    scale, kind = (1e6, arrow.timestamp("us", tz="UTC")) if column.kind == TIME else (1.0, arrow.int64())
    whole = np.rint(np.where(unknown, 0.0, values) * scale).astype(np.int64)
    return arrow.array(whole, arrow.int64(), mask=unknown).cast(kind)


class _Footprints(NamedTuple):
    """Footprints of the rows of a table, and their bounds: west, south, east, north."""

    shapes: list[bytes | None]
    kinds: set[str]
    bounds: tuple[float, float, float, float]

    @classmethod
    def read(cls, images: ImageSet) -> _Footprints | None:
        """Those that a capture has left beside a map type; None where it has not."""
        path = images.folder.parent / FOOTPRINTS_FILE
        if not path.is_file():
            return None
        row_of = {Path(name).stem: row for row, name in enumerate(images.table.img_names)}
        shapes: list[bytes | None] = [None] * len(images.table)
        kinds: set[str] = set()
        edges: list[tuple[float, float, float, float]] = []
        try:
            with path.open("rb", buffering=_BLOCK_BYTES) as file:
                for line in file:
                    if line.startswith(_FEATURE):
                        feature = parse_json(line.rstrip().rstrip(b","))
                        row, shape = row_of.get(feature["properties"]["name"]), feature["geometry"]
                        if row is not None and shape is not None:
                            shapes[row] = _binary(shape["type"], shape["coordinates"])
                            kinds.add(shape["type"])
                            edges.append(_bounds(shape["type"], shape["coordinates"]))
        except (OSError, InvalidInput, KeyError, TypeError, ValueError) as wrong:
            raise InvalidInput("{0}: cannot be read ({1})", path, wrong) from wrong
        west, south, east, north = zip(*edges) if edges else ((0.0,),) * 4
        return cls(shapes, kinds, (min(west), min(south), max(east), max(north)))

    def about(self) -> dict[str, Any]:
        """What GeoParquet has to say of the column."""
        column = {
            "encoding": "WKB",
            "geometry_types": sorted(self.kinds),
            "orientation": "counterclockwise",
            "bbox": list(self.bounds),
        }
        return {"version": GEOPARQUET, "primary_column": GEOMETRY, "columns": {GEOMETRY: column}}


def _polygons(kind: str, coordinates: Any) -> Sequence[Any]:
    return coordinates if kind == "MultiPolygon" else [coordinates]


def _bounds(kind: str, coordinates: Any) -> tuple[float, float, float, float]:
    places = np.concatenate([np.asarray(rings[0], np.float64) for rings in _polygons(kind, coordinates)])
    (west, south), (east, north) = places.min(axis=0).tolist(), places.max(axis=0).tolist()
    return west, south, east, north


def _binary(kind: str, coordinates: Any) -> bytes:
    """Well-known binary of a GeoJSON polygon or several."""
    polygons = [_polygon(rings) for rings in _polygons(kind, coordinates)]
    if kind != "MultiPolygon":
        return polygons[0]
    return struct.pack("<BII", _LITTLE, _MULTIPOLYGON, len(polygons)) + b"".join(polygons)


def _polygon(rings: Sequence[Any]) -> bytes:
    parts = [struct.pack("<BII", _LITTLE, _POLYGON, len(rings))]
    for ring in rings:
        parts += [struct.pack("<I", len(ring)), np.asarray(ring, "<f8").tobytes()]
    return b"".join(parts)
