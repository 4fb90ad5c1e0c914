"""An opened layer of a vector file."""

from __future__ import annotations

import contextlib
import hashlib
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import InvalidInput, Message
from ..imagery.cache.tile_cache import default_folder
from ..storage.files import lock_tried, make_folder, partial_file
from ..waiting import check_cancelled, report_progress
from .features import Features
from .index import count_rows, read_about, read_rows, read_values, unpack, write_index
from .names import LayerName, split_name
from .reading import backend, is_osm, layer_names, open_records
from .shaping import Reference

#: Most distinct values of a field: as many as 16 bits hold.
MAX_VALUES = 65_535
#: Number of the layout of index files; indices of other layouts are made anew.
_LAYOUT = 1
#: Endings of the files that formats keep beside the one that is named: of shapefiles, and of MapInfo.
_COMPANIONS = (".shp", ".shx", ".dbf", ".prj", ".cpg", ".tab", ".dat", ".map", ".id", ".ind", ".mif", ".mid")
_INDEXING = threading.Lock()


@dataclass(frozen=True)
class VectorLayer:
    """A layer whose features are indexed; it can be pickled, and used by several threads.

    Parameters
    ----------
    title, attribution : str
        Name of the layer, and whom its data are to be credited to (empty if unknown).
    count : int
        Features in the layer, those that were left out included: the greatest number of a feature.
    fields : tuple of str
    repaired, dropped : int
        Geometries that were repaired, as their areas cross themselves, and that were left out, as they are empty or
        have no area or length.
    index : Path
        SQLite file of the features.
    """

    title: str
    attribution: str
    count: int
    fields: tuple[str, ...]
    repaired: int
    dropped: int
    index: Path

    def features(
        self,
        west_deg: float,
        south_deg: float,
        east_deg: float,
        north_deg: float,
        fields: Sequence[str] = (),
        least_m: float = 0.0,
        most: int = -1,
    ) -> Features:
        """Features whose boxes meet a box, in the layer's order.

        Parameters
        ----------
        west_deg, south_deg, east_deg, north_deg : float
            Longitudes may lie beyond ±180, such as 179 to 181; those of features are shifted to them.
        fields : sequence of str
            Fields whose values are wanted.
        least_m : float
            Lines and areas whose boxes are smaller than this are left out.
        most : int
            Largest number of features, those nearest to the middle of the box; negative for all.

        Raises
        ------
        InvalidInput
            There is no such field.
        """
        chosen = {name: self._place(name) for name in fields}
        box = (west_deg, south_deg, east_deg, north_deg)
        return unpack(read_rows(self.index, box, least_m, most), chosen)

    def count_in(self, west_deg: float, south_deg: float, east_deg: float, north_deg: float) -> int:
        """Number of features whose boxes meet a box, as for `features`."""
        return count_rows(self.index, (west_deg, south_deg, east_deg, north_deg))

    def values(self, field: str) -> dict[Any, int]:
        """Distinct values of a field, in order of first use, with the number of features that have each.

        Raises
        ------
        InvalidInput
            There is no such field, or it has more than `MAX_VALUES` distinct values.
        """
        place = self._place(field)
        counts: dict[Any, int] = {}
        for row in read_values(self.index):
            check_cancelled()
            counts[row[place]] = counts.get(row[place], 0) + 1
            if len(counts) > MAX_VALUES:
                raise InvalidInput(
                    "field {0!r} of {1}: more than {2:,} distinct values, which 16 bits cannot hold",
                    field,
                    self.title,
                    MAX_VALUES,
                    remedy="choose a field with fewer values, or none and tell features apart by the product instances",
                )
        return counts

    def _place(self, field: str) -> int:
        if field not in self.fields:
            known = Message.joined(", ", self.fields[:30]) if self.fields else Message("no fields")
            raise InvalidInput("{0}: has no field {1!r}, but {2}", self.title, field, known)
        return self.fields.index(field)


def parse_layer(text: str) -> LayerName:
    """Parse ``FILE[:LAYER][:FIELD]``; one part after the file is a layer if the file has such a layer, else a field.

    Raises
    ------
    InvalidInput
        There is no such file, or it cannot be read.
    """
    path, rest = split_name(text)
    if len(rest) == 2:
        return LayerName(path, *rest)
    if not rest:
        return LayerName(path)
    return LayerName(path, rest[0]) if rest[0] in layer_names(path) else LayerName(path, "", rest[0])


def open_layer(path: str, layer: str = "", *, index_dir: Path | None = None) -> VectorLayer:
    """Open a layer, and index it if it has not been, or has changed.

    Parameters
    ----------
    layer : str
        Name; empty for the only layer, or for the areas of a file of OpenStreetMap.
    index_dir : Path, optional
        Folder for the index; by default in the cache of tiles.

    Raises
    ------
    InvalidInput
        The file cannot be read, or has no such layer; the layer has no reference system, or no features.
    Cancelled
        The enclosing `waiting.cancellable` is cancelled; `waiting.reporting` gets the number of features read.
    """
    file = Path(path)
    folder = index_dir if index_dir is not None else default_folder() / "vectors"
    target = folder / f"{_fingerprint(file, layer)}.sqlite"
    if not target.is_file():
        with _alone(target):
            if not target.is_file():
                _write(target, path, layer)
    about = read_about(target)
    if about["count"] == about["dropped"]:
        raise InvalidInput("layer {0} of {1}: has no features with a geometry", about["title"], file.name)
    return VectorLayer(
        about["title"],
        about["attribution"],
        about["count"],
        tuple(about["fields"]),
        about["repaired"],
        about["dropped"],
        target,
    )


@contextlib.contextmanager
def _alone(target: Path) -> Iterator[None]:
    """Let one thread of one process write an index, as others may need the same; raises Cancelled from the wait."""
    make_folder(target.parent)
    while not _INDEXING.acquire(timeout=0.1):
        check_cancelled()
    try:
        while True:
            with lock_tried(target.parent.with_suffix(".lock")) as held:
                if held:
                    yield
                    return
            check_cancelled()
            time.sleep(0.1)
    finally:
        _INDEXING.release()


def _write(target: Path, path: str, layer: str) -> None:
    """Index a layer; raises as `open_layer` does."""
    file = Path(path).name
    report_progress(Message("{0}: opening…", file))
    source = open_records(path, layer)
    if not source.crs:
        raise InvalidInput(
            "layer {0} of {1}: has no reference system (CRS), so nobody can place it on the Earth",
            source.layer,
            file,
        )
    written: dict[str, Any] = {
        "title": source.layer,
        "fields": source.fields,
        "attribution": "© OpenStreetMap contributors" if is_osm(path) else "",
    }

    def progress(count: int) -> None:
        # Files of OpenStreetMap do not state how many features they have.
        report_progress(
            Message("{0}: {1:,} features read", file, count)
            if source.count < count
            else Message("{0}: {1:,} of {2:,} features read", file, count, source.count)
        )

    with partial_file(target) as partial:
        write_index(partial, source.records(), Reference(source.crs), written, progress)


def _fingerprint(file: Path, layer: str) -> str:
    """Hash of what an index depends on: the file and those beside it of its name, and what reads them."""
    try:
        states = [
            (one.name, one.stat().st_size, one.stat().st_mtime_ns)
            for one in sorted(file.absolute().parent.iterdir())
            if one.name == file.name
            or (one.stem == file.stem and one.suffix.lower() in _COMPANIONS)
            or one.name == f"{file.name}-wal"
        ]
    except OSError as wrong:
        raise InvalidInput("{0}: cannot be read: {1}", file.name, wrong) from wrong
    key = repr((str(file.absolute()), states, layer, backend(), _LAYOUT))
    return hashlib.sha256(key.encode("utf-8", "surrogatepass")).hexdigest()[:32]
