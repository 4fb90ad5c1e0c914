"""Tables of a dataset as Parquet: columns with their types, and footprints as GeoParquet has them."""

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
from numpy.typing import NDArray

from ..dataset.dataset import Dataset, ImageSet, read_dataset
from ..dataset.folder import FOOTPRINTS_FILE, TABLE_FILE
from ..dataset.table import NUMBER, TEXT, TIME, Column, written_columns
from ..errors import InvalidInput, OutputError
from ..limits import MAX_TABLE_BYTES
from ..storage.files import make_folder, new_folder, open_foreign, read_line, write_whole
from ..storage.stores import Address, is_address, is_file, resolved, store_path
from ..text.plain import writable
from ..text.safe_json import parse_json

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

#: Beside ``meta_data.csv``, or in a folder of the same name elsewhere.
PARQUET_FILE = TABLE_FILE.replace(".csv", ".parquet")
#: Column of the footprints, and the version of GeoParquet that tells of it.
GEOMETRY, GEOPARQUET = "geometry", "1.1.0"
#: Of well-known binary: the byte order of most machines, and kinds of geometries.
_LITTLE, _POLYGON, _MULTIPOLYGON = 1, 3, 6
#: Rows of a row group: readers skip groups by the bounds of their columns, and writers hold one in memory.
_ROWS_A_GROUP = 1 << 16


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
    """Images of one map type, or of all for None, by their names."""
    return dict(dataset.image_sets) if map_type is None else {map_type: dataset.image_set(map_type)}


def relative_folder(dataset: Dataset, folder: Path) -> Path:
    """Folder inside a dataset's, such as ``satellite``, ``2014/satellite``, or ``.`` for its own.

    It goes by its name there: links, as of a map type that lies on another disk, are not followed.
    """
    if is_address(folder):
        return folder.relative_to(dataset.folder)
    return Path(os.path.abspath(folder)).relative_to(os.path.abspath(dataset.folder))  # noqa: PTH100


def described_folder(dataset: Dataset, folder: Path) -> Path:
    """The same for a file that describes others, which is UTF-8; raises InvalidInput of a name that is not."""
    found = relative_folder(dataset, folder)
    if writable(str(found)) != str(found):
        raise InvalidInput("folder {0}: its name is not UTF-8, as a description of files needs it", folder)
    return found


def is_same(folder: Path, other: Address) -> bool:
    """Whether two places are one folder."""
    return resolved(folder) == resolved(store_path(other))


def image_stem(name: str) -> str:
    """Name of an image without its ending: what `Path.stem` gives, in a fraction of its time."""
    return name.rpartition(".")[0] or name


def import_pyarrow(kind: str) -> Any:
    """Return pyarrow with its Parquet; raises OutputError where it is not installed."""
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
    """Rows of each row group of a table; one without rows has one of none."""
    for start in range(0, max(count, 1), _ROWS_A_GROUP):
        yield slice(start, min(start + _ROWS_A_GROUP, count))


def parquet_blocks(
    arrow: Any, schema: Any, about: Mapping[str, Any], groups: Iterator[Mapping[str, Any]]
) -> Iterator[bytes]:
    """File of Parquet, a row group at a time.

    Parameters
    ----------
    schema : pyarrow.Schema
    about : mapping
        What the file says of itself, by key, JSON-ready.
    groups : iterator of mapping
        Arrays of each row group, by column.
    """
    sink = _Sink()
    schema = schema.with_metadata({key: json.dumps(value, ensure_ascii=False) for key, value in about.items()})
    with arrow.parquet.ParquetWriter(arrow.PythonFile(sink, "w"), schema, compression="zstd") as writer:
        for columns in groups:
            writer.write_table(arrow.table([columns[name] for name in schema.names], schema=schema))
            yield sink.taken()
    yield sink.taken()


class _Sink(io.RawIOBase):
    """File that is written to, and whose content is taken as it comes."""

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
        """What has been written since it was last taken."""
        data, self._blocks = b"".join(self._blocks), []
        return data


def _blocks(arrow: Any, images: ImageSet) -> Iterator[bytes]:
    """File of a map type's table."""
    columns = written_columns(images.table)
    fields = [(one.header, arrow_type(arrow, one.kind)) for one in columns]
    shown = FootprintGeometries.read(images.folder.parent)
    about: dict[str, Any] = {}
    places = None if shown is None else shown.places(images.table.img_names)
    if shown is not None and places is not None:
        about["geo"] = shown.about(places)
        if GEOMETRY not in dict(fields):
            fields.append((GEOMETRY, arrow.binary()))

    def groups() -> Iterator[dict[str, Any]]:
        for rows in row_groups(len(images)):
            found = {}
            if shown is not None and places is not None:
                found[GEOMETRY] = shown.shapes(arrow, places[rows])
            yield {**found, **{one.header: arrow_array(arrow, one, rows) for one in columns}}

    return parquet_blocks(arrow, arrow.schema(fields), about, groups())


def arrow_type(arrow: Any, kind: str) -> Any:
    """Arrow's type of a kind of columns."""
    types = {TEXT: arrow.string(), NUMBER: arrow.float64(), TIME: arrow.timestamp("us", tz="UTC")}
    return types.get(kind, arrow.int64())


def arrow_array(arrow: Any, column: Column, rows: slice | NDArray[np.intp]) -> Any:
    """Arrow array of some rows of a column, null for what is not known."""
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
    """Footprints that a capture has left, as well-known binary, one after the other.

    Parameters
    ----------
    place_of : mapping of str to int
        Which of them is an image's, by its name without ending.
    data, ends : bytes, array (m + 1,) of int64
        The footprints, and where in the data each ends and the next begins.
    kinds : array (m,)
        3 for a polygon, 6 for several.
    bounds : array (m, 4)
        West, south, east, north. Those that cross the antimeridian have a polygon on either side and reach from -180 to
        180 degrees.
    """

    place_of: dict[str, int]
    data: bytes
    ends: NDArray[np.int64]
    kinds: NDArray[np.uint8]
    bounds: NDArray[np.float64]

    @classmethod
    def read(cls, folder: Path) -> FootprintGeometries | None:
        """Those of the capture in a folder; None where it has left none.

        Raises
        ------
        InvalidInput
            A file that is none of a capture's.
        OutputError
            A store that refuses.
        """
        path = folder / FOOTPRINTS_FILE
        if not is_file(path):
            return None
        place_of: dict[str, int] = {}
        data, ends, kinds, bounds = bytearray(), array("q", [0]), bytearray(), array("d")
        try:
            for feature in _features(path):
                name, shape = feature["properties"]["name"], feature["geometry"]
                if shape is not None:
                    place_of[name] = len(kinds)
                    binary, edges = _packed(shape["type"], shape["coordinates"])
                    data += binary
                    ends.append(len(data))
                    kinds.append(_MULTIPOLYGON if shape["type"] == "MultiPolygon" else _POLYGON)
                    bounds.extend(edges)
        except (OSError, InvalidInput, KeyError, TypeError, ValueError, struct.error) as wrong:
            raise InvalidInput("{0}: cannot be read ({1})", path, wrong) from wrong
        return cls(
            place_of,
            bytes(data),
            np.frombuffer(ends, np.int64),
            np.frombuffer(bytes(kinds), np.uint8),
            np.frombuffer(bounds, np.float64).reshape(-1, 4),
        )

    def places(self, img_names: Sequence[str]) -> NDArray[np.intp]:
        """Footprints (n,) of images by their names; -1 where there is none."""
        found = (self.place_of.get(image_stem(name), -1) for name in img_names)
        return np.fromiter(found, np.intp, len(img_names))

    def shapes(self, arrow: Any, places: NDArray[np.intp]) -> Any:
        """Arrow array of footprints, null where there is none."""
        buffers = [None, arrow.py_buffer(self.ends), arrow.py_buffer(self.data)]
        whole = arrow.Array.from_buffers(arrow.large_binary(), len(self.kinds), buffers)
        return whole.take(arrow.array(places, mask=places < 0)).cast(arrow.binary())

    def about(self, places: NDArray[np.intp]) -> dict[str, Any]:
        """What GeoParquet has to say of a column of them."""
        return geometry_metadata(self.names_of(places), self.bounds[places[places >= 0]])

    def names_of(self, places: NDArray[np.intp]) -> set[str]:
        """Kinds of some footprints, by GeoJSON's names."""
        kinds = np.unique(self.kinds[places[places >= 0]]).tolist()
        return {"MultiPolygon" if kind == _MULTIPOLYGON else "Polygon" for kind in kinds}


def geometry_metadata(kinds: set[str], bounds: NDArray[np.float64]) -> dict[str, Any]:
    """What GeoParquet has to say of a column of geometries of some kinds, with their bounds (n, 4)."""
    whole = [*bounds[:, :2].min(axis=0), *bounds[:, 2:].max(axis=0)] if len(bounds) else [0.0] * 4
    column = {
        "encoding": "WKB",
        "geometry_types": sorted(kinds),
        "orientation": "counterclockwise",
        "bbox": [float(edge) for edge in whole],
    }
    return {"version": GEOPARQUET, "primary_column": GEOMETRY, "columns": {GEOMETRY: column}}


def _features(path: Path) -> Iterator[Any]:
    """Features of a capture's GeoJSON, which has each in a line."""
    with open_foreign(path, MAX_TABLE_BYTES, 1 << 20) as file:
        while line := read_line(file):
            # Lines of features begin so in the GeoJSON of a capture.
            if line.startswith(b'{"type": "Feature",'):
                yield parse_json(line.rstrip().rstrip(b","))


def _packed(kind: str, coordinates: Any) -> tuple[bytes, tuple[float, float, float, float]]:
    """Well-known binary of a GeoJSON polygon or several, and their bounds: west, south, east, north."""
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
