"""Write tables of a dataset as Parquet: typed columns, and footprints as GeoParquet."""

from __future__ import annotations

import io
import json
import os
import struct
from array import array
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import NDArray
from ..dataset.dataset import Dataset, ImageSet, read_dataset
from ..dataset.folder import FOOTPRINTS_FILE, TABLE_FILE
from ..dataset.table import NUMBER, TEXT, TIME, Column, written_columns
from ..errors import InvalidInput, OutputError
from ..limits import MAX_TABLE_BYTES
from ..map_types import is_undistorted
from ..storage.files import make_folder, new_folder, open_foreign, read_line, write_whole
from ..storage.stores import Address, is_address, is_file, resolved, store_path
from ..text.plain import writable
from ..text.safe_json import parse_json

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

#: File beside ``meta_data.csv`` or, in another target, in a folder named like the map type.
PARQUET_FILE = TABLE_FILE.replace(".csv", ".parquet")
#: Column of the footprints.
GEOMETRY = "geometry"
#: Codes of well-known binary: little-endian byte order, and geometry types.
_LITTLE, _POLYGON, _MULTIPOLYGON = 1, 3, 6
#: Rows of a row group: readers skip groups by the bounds of their columns, and the writer holds one group in memory.
_ROWS_A_GROUP = 1 << 16


def write_parquet(
    folder: str | os.PathLike[str], target: str | os.PathLike[str], map_type: str | None = None
) -> list[Path]:
    """Write the tables of a dataset as Parquet, one for each map type; return the paths.

    The tables have the columns of ``meta_data.csv`` as whole numbers, numbers, times and texts, null where unknown. If
    the capture has written footprints, a column ``geometry`` has them in longitude and latitude of WGS 84.

    Parameters
    ----------
    target : path
        A new or empty folder, or the dataset's folder; there, files are written beside ``meta_data.csv`` and replace
        files of earlier exports.
    map_type : str or None
        Map type to export; None for all.

    Raises
    ------
    InvalidInput
        The folder is not a dataset, or lacks the map type.
    OutputError
        The folder cannot be written or is not empty, or pyarrow is not installed.
    """
    arrow = import_pyarrow("parquet")
    dataset = read_dataset(folder)
    sets = chosen_sets(dataset, map_type).values()
    root = dataset.folder if is_same(dataset.folder, target) else new_folder(target)
    written = []
    for images in sets:
        path = root / relative_folder(dataset, images.folder) / PARQUET_FILE
        make_folder(path.parent)
        write_whole(path, _blocks(arrow, images))
        written.append(path)
    return written


def chosen_sets(dataset: Dataset, map_type: str | None) -> dict[str, ImageSet]:
    """Image sets by map type: one, or all if ``map_type`` is None."""
    return dict(dataset.image_sets) if map_type is None else {map_type: dataset.image_set(map_type)}


def relative_folder(dataset: Dataset, folder: Path) -> Path:
    """Path of a folder relative to a dataset's folder, such as ``satellite``, ``2014/satellite`` or ``.``.

    Links, such as to a map type on another disk, are not followed.
    """
    if is_address(folder):
        return folder.relative_to(dataset.folder)
    return Path(os.path.abspath(folder)).relative_to(os.path.abspath(dataset.folder))  # noqa: PTH100


def described_folder(dataset: Dataset, folder: Path) -> Path:
    """Relative folder for a description in UTF-8; raises InvalidInput if the name is not UTF-8."""
    found = relative_folder(dataset, folder)
    if writable(str(found)) != str(found):
        raise InvalidInput("folder {0}: its name is not UTF-8, as a description of files needs it", folder)
    return found


def is_same(folder: Path, other: Address) -> bool:
    """Whether two paths or addresses are the same folder."""
    return resolved(folder) == resolved(store_path(other))


def image_stem(name: str) -> str:
    """Name of an image without its ending, like `Path.stem` but much faster."""
    return name.rpartition(".")[0] or name


def import_pyarrow(kind: str) -> Any:
    """Return pyarrow with its Parquet module; raises OutputError if it is not installed."""
    try:
        import pyarrow as pa
        import pyarrow.compute
        import pyarrow.parquet
    except ImportError as missing:
        raise OutputError(
            "format {0}: pyarrow cannot be imported ({1})",
            kind,
            missing,
            remedy="get it with: pip install 'terrainav[parquet]'",
        ) from missing
    return pa


def row_groups(count: int) -> Iterator[slice]:
    """Yield the rows of each row group of a table; an empty table has one empty group."""
    for start in range(0, max(count, 1), _ROWS_A_GROUP):
        yield slice(start, min(start + _ROWS_A_GROUP, count))


def parquet_blocks(
    arrow: Any, schema: Any, metadata: Mapping[str, Any], groups: Iterator[Mapping[str, Any]]
) -> Iterator[bytes]:
    """Parquet file in blocks, one per row group.

    Parameters
    ----------
    schema : pyarrow.Schema
    metadata : mapping
        Metadata of the file, by key; values are JSON-ready.
    groups : iterator of mapping
        Arrays of each row group, by name of the column.
    """
    sink = _Sink()
    schema = schema.with_metadata({key: json.dumps(value, ensure_ascii=False) for key, value in metadata.items()})
    with arrow.parquet.ParquetWriter(arrow.PythonFile(sink, "w"), schema, compression="zstd") as writer:
        for columns in groups:
            writer.write_table(arrow.table([columns[name] for name in schema.names], schema=schema))
            yield sink.taken()
    yield sink.taken()


class _Sink(io.RawIOBase):
    """Writable file whose content is read in blocks with `taken`."""

    def __init__(self) -> None:
        super().__init__()
        self._blocks: list[bytes] = []
        self._written = 0

    def writable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._written

    def write(self, data: ReadableBuffer) -> int:
        self._blocks.append(bytes(data))
        self._written += len(self._blocks[-1])
        return len(self._blocks[-1])

    def taken(self) -> bytes:
        """Return the bytes written since the last call."""
        data, self._blocks = b"".join(self._blocks), []
        return data


def _blocks(arrow: Any, images: ImageSet) -> Iterator[bytes]:
    """Parquet file of the table of a map type, in blocks."""
    columns = written_columns(images.table)
    fields = [(one.header, arrow_type(arrow, one.kind)) for one in columns]
    shown = None if is_undistorted(images.map_type) else FootprintGeometries.read(images.folder.parent)
    metadata: dict[str, Any] = {}
    places = None if shown is None else shown.places(images.table.img_names)
    if shown is not None and places is not None:
        metadata["geo"] = shown.metadata(places)
        if GEOMETRY not in dict(fields):
            fields.append((GEOMETRY, arrow.binary()))

    def groups() -> Iterator[dict[str, Any]]:
        for rows in row_groups(len(images)):
            found = {}
            if shown is not None and places is not None:
                found[GEOMETRY] = shown.shapes(arrow, places[rows])
            yield {**found, **{one.header: arrow_array(arrow, one, rows) for one in columns}}

    return parquet_blocks(arrow, arrow.schema(fields), metadata, groups())


def arrow_type(arrow: Any, kind: str) -> Any:
    """Arrow type of a column's kind."""
    types = {TEXT: arrow.string(), NUMBER: arrow.float64(), TIME: arrow.timestamp("us", tz="UTC")}
    return types.get(kind, arrow.int64())


def arrow_array(arrow: Any, column: Column, rows: slice | NDArray[np.intp]) -> Any:
    """Arrow array of some rows of a column, null where unknown."""
    if isinstance(column.values, tuple):
        at = range(len(column.values))[rows] if isinstance(rows, slice) else rows.tolist()
        return arrow.array([column.values[row] or None for row in at], arrow.string())
    values = np.asarray(column.values)[rows]
    unknown = np.isnan(values) if values.dtype.kind == "f" else np.zeros(len(values), bool)
    if column.kind == NUMBER:
        return arrow.array(values.astype(np.float64), arrow.float64(), mask=unknown)
    scale = 1e6 if column.kind == TIME else 1.0
    whole = np.rint(np.where(unknown, 0.0, values) * scale).astype(np.int64)
    return arrow.array(whole, arrow.int64(), mask=unknown).cast(arrow_type(arrow, column.kind))


class FootprintGeometries(NamedTuple):
    """Footprints (m) that a capture has written, as consecutive well-known binary.

    Parameters
    ----------
    by_name : mapping of str to int
        Index of each footprint, by image name without ending.
    data, ends : bytes, array (m + 1,) of int64
        Binary of all footprints, and offsets of footprints in it.
    kinds : array (m,)
        Geometry types: 3 for a polygon, 6 for a multipolygon.
    bounds : array (m, 4)
        West, south, east, north. A footprint across the antimeridian has polygons on both sides, and bounds of -180
        and 180 degrees.
    """

    by_name: dict[str, int]
    data: bytes
    ends: NDArray[np.int64]
    kinds: NDArray[np.uint8]
    bounds: NDArray[np.float64]

    @classmethod
    def read(cls, folder: Path) -> FootprintGeometries | None:
        """Footprints of the capture in a folder; None without a file of footprints.

        Raises
        ------
        InvalidInput
            The file was not written by a capture.
        OutputError
            The store refuses access.
        """
        path = folder / FOOTPRINTS_FILE
        if not is_file(path):
            return None
        by_name: dict[str, int] = {}
        data, ends, kinds, bounds = bytearray(), array("q", [0]), bytearray(), array("d")
        try:
            for feature in _features(path):
                name, shape = feature["properties"]["name"], feature["geometry"]
                if shape is not None:
                    by_name[name] = len(kinds)
                    binary, edges = _packed(shape["type"], shape["coordinates"])
                    data += binary
                    ends.append(len(data))
                    kinds.append(_MULTIPOLYGON if shape["type"] == "MultiPolygon" else _POLYGON)
                    bounds.extend(edges)
        except (OSError, InvalidInput, KeyError, TypeError, ValueError, struct.error) as wrong:
            raise InvalidInput("{0}: cannot be read ({1})", path, wrong) from wrong
        return cls(
            by_name,
            bytes(data),
            np.frombuffer(ends, np.int64),
            np.frombuffer(bytes(kinds), np.uint8),
            np.frombuffer(bounds, np.float64).reshape(-1, 4),
        )

    def places(self, img_names: Sequence[str]) -> NDArray[np.intp]:
        """Indices (n,) of the footprints of images, by name; -1 for images without a footprint."""
        found = (self.by_name.get(image_stem(name), -1) for name in img_names)
        return np.fromiter(found, np.intp, len(img_names))

    def shapes(self, arrow: Any, places: NDArray[np.intp]) -> Any:
        """Arrow array of footprints by index; null for -1."""
        buffers = [None, arrow.py_buffer(self.ends), arrow.py_buffer(self.data)]
        whole = arrow.Array.from_buffers(arrow.large_binary(), len(self.kinds), buffers)
        return whole.take(arrow.array(places, mask=places < 0)).cast(arrow.binary())

    def metadata(self, places: NDArray[np.intp]) -> dict[str, Any]:
        """GeoParquet metadata of a column of footprints."""
        return geometry_metadata(self.geometry_types(places), self.bounds[places[places >= 0]])

    def geometry_types(self, places: NDArray[np.intp]) -> set[str]:
        """GeoJSON types of some footprints."""
        kinds = np.unique(self.kinds[places[places >= 0]]).tolist()
        return {"MultiPolygon" if kind == _MULTIPOLYGON else "Polygon" for kind in kinds}


def geometry_metadata(kinds: set[str], bounds: NDArray[np.float64]) -> dict[str, Any]:
    """GeoParquet metadata of a column of geometries of some types, with bounds (n, 4)."""
    whole = [*bounds[:, :2].min(axis=0), *bounds[:, 2:].max(axis=0)] if len(bounds) else [0.0] * 4
    column = {
        "encoding": "WKB",
        "geometry_types": sorted(kinds),
        "orientation": "counterclockwise",
        "bbox": [float(edge) for edge in whole],
    }
    return {"version": "1.1.0", "primary_column": GEOMETRY, "columns": {GEOMETRY: column}}


def _features(path: Path) -> Iterator[Any]:
    """Features of a capture's GeoJSON, one per line."""
    with open_foreign(path, MAX_TABLE_BYTES, 1 << 20) as file:
        while line := read_line(file):
            # Other lines begin and end the collection.
            if line.startswith(b'{"type": "Feature",'):
                yield parse_json(line.rstrip().rstrip(b","))


def _packed(kind: str, coordinates: Any) -> tuple[bytes, tuple[float, float, float, float]]:
    """Well-known binary of a GeoJSON polygon or multipolygon, and bounds: west, south, east, north."""
    polygons = coordinates if kind == "MultiPolygon" else [coordinates]
    parts, lons, lats = [], [], []
    for rings in polygons:
        parts.append(struct.pack("<BII", _LITTLE, _POLYGON, len(rings)))
        for ring in rings:
            flat = [value for place in ring for value in place]
            parts.append(struct.pack(f"<I{len(flat)}d", len(ring), *flat))
            lons += flat[::2]
            lats += flat[1::2]
    if kind == "MultiPolygon":
        parts.insert(0, struct.pack("<BII", _LITTLE, _MULTIPOLYGON, len(polygons)))
    return b"".join(parts), (min(lons), min(lats), max(lons), max(lats))
