"""Read and write the table of a dataset, ``meta_data.csv``."""

from __future__ import annotations

import csv
import io
import math
import os
from array import array
from collections import Counter, deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Floats, NDArray, Numbers
from ..errors import InvalidInput, Message, OutputError
from ..limits import MAX_TABLE_BYTES
from ..numbers import real_number
from ..storage.files import open_foreign, read_line, text_lines, write_whole
from ..storage.stores import Address, store_path
from ..text.plain import table_cell, time_s
from .cells import CsvRows, CutCells, ReadCells

#: Columns of the published dataset, which every table has; others may be missing or have empty cells.
_NEEDED = ("img_names", "columns", "rows", "lat_deg", "lon_deg", "zoom")
#: Columns of whole numbers, with least and greatest values: a double holds whole numbers up to 2^53, and pixels have no
#: size at zooms above 1,000.
_WHOLE = {
    **dict.fromkeys(("columns", "rows"), (-(2.0**53), 2.0**53)),
    "zoom": (-1000.0, 1000.0),
}
_TEXT = ("img_names", "time_utc", "crs", "source", "attribution", "imagery_date", "status", "reason", "shard")
#: Columns of numbers that are written without decimals if they are whole.
_COUNTS = (
    *("left_px", "top_px", "width_px", "height_px", "image_width_px", "image_height_px"),
    *("offset_bytes", "size_bytes"),
)
#: Additional column that cleaning writes: why an image is rejected, or empty.
REJECTED = "rejected"
#: Kinds of columns.
WHOLE, NUMBER, TIME, TEXT = "whole", "number", "time", "text"
#: Rows formatted at a time, as text takes far more memory than numbers.
_ROWS_A_BLOCK = 2000
#: Bytes read and decoded at a time. With few bytes, a thread retakes Python's lock before another thread wakes; a whole
#: table, decoded in one call, keeps the lock until the end. Either would freeze a window.
_BLOCK_BYTES = 1 << 20
#: Additional column that a split writes: the part of an image.
SPLIT = "split"
#: Cell of `SPLIT` for an image in no part, as its ground overlaps that of another part or is too close to it.
GAP = "gap"


@dataclass(frozen=True, eq=False)
class Table:
    """Rows of a dataset as arrays (n,).

    Unknown numbers are NaN, unknown texts are empty.

    Parameters
    ----------
    img_names : tuple of str
        File names with ending.
    columns, rows : array of int64
        Grid indices.
    lat_deg, lon_deg : array
        Centres of the images; headed ``Lat``, ``Lon``.
    zoom : array of int64
        Zooms; headed ``Alt``, as in the published dataset.
    entropies : array
        Bits; NaN for images that could not be made or whose entropy has not been computed.
    pose_lat_deg, pose_lon_deg, agl_m, yaw_deg, tilt_deg, roll_deg : array
        Poses of the camera.
    time_utc : tuple of str
        Times of capture in ISO 8601, if the mission's points state them; the column is written only then.
    height_m : array
        Heights above the WGS 84 ellipsoid of cameras over relief; this column and ``facade_share`` are written only
        with relief.
    left_px, top_px, width_px, height_px : array
        Windows in the source's global pixel grid at ``zoom``.
    image_width_px, image_height_px : array
        Sizes of the images as written.
    crs : tuple of str
        Code or WKT of the source's CRS; empty if the windows are of the Web-Mercator map. This column and the next four
        are written only if an image has a CRS.
    west, north, pixel_width, pixel_height : array
        Upper left corners of the windows and size of their pixels, in units of that CRS.
    fx_px, fy_px, cx_px, cy_px : array
        Focal lengths and principal point of the images as written; (0, 0) is the upper left corner of the image, (0.5,
        0.5) the centre of its first pixel. For map frames, of a camera that looks straight down and sees the frame,
        which is a pinhole image within the error bound of map frames.
    sky_share, unmapped_share, facade_share : array
        Shares of an image's pixels that see sky, ground beyond the Web-Mercator map, and faces of the relief that a map
        does not show.
    nominal_lat_deg, nominal_lon_deg, nominal_agl_m, nominal_yaw_deg, nominal_tilt_deg, nominal_roll_deg : array
        Planned poses, before wind moved the camera.
    status, reason : tuple of str
        ``done``, or ``failed`` and the reason.
    shard : tuple of str
        Name of the tar beside the table that holds the image; this column and the next two are written only for images
        in shards.
    offset_bytes, size_bytes : array
        Position and size of the image's data in that file.
    other : mapping of str to tuple of str
        Additional columns, kept unchanged.
    """

    img_names: tuple[str, ...]
    columns: Numbers
    rows: Numbers
    lat_deg: Floats
    lon_deg: Floats
    zoom: Numbers
    entropies: Floats
    pose_lat_deg: Floats
    pose_lon_deg: Floats
    agl_m: Floats
    yaw_deg: Floats
    tilt_deg: Floats
    roll_deg: Floats
    time_utc: tuple[str, ...]
    height_m: Floats
    left_px: Floats
    top_px: Floats
    width_px: Floats
    height_px: Floats
    image_width_px: Floats
    image_height_px: Floats
    crs: tuple[str, ...]
    west: Floats
    north: Floats
    pixel_width: Floats
    pixel_height: Floats
    fx_px: Floats
    fy_px: Floats
    cx_px: Floats
    cy_px: Floats
    sky_share: Floats
    unmapped_share: Floats
    facade_share: Floats
    nominal_lat_deg: Floats
    nominal_lon_deg: Floats
    nominal_agl_m: Floats
    nominal_yaw_deg: Floats
    nominal_tilt_deg: Floats
    nominal_roll_deg: Floats
    source: tuple[str, ...]
    attribution: tuple[str, ...]
    imagery_date: tuple[str, ...]
    status: tuple[str, ...]
    reason: tuple[str, ...]
    shard: tuple[str, ...]
    offset_bytes: Floats
    size_bytes: Floats
    other: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        columns = {name: getattr(self, name) for name in HEADERS} | dict(self.other)
        for name, column in columns.items():
            if len(column) != len(self.img_names):
                raise InvalidInput(
                    "table column {0} has {1} rows: the image names have {2}",
                    name,
                    len(column),
                    len(self.img_names),
                )

    def __len__(self) -> int:
        return len(self.img_names)

    @property
    def made(self) -> NDArray[np.bool_]:
        """Rows (n,) whose images have been made."""
        return np.array([status != "failed" for status in self.status], np.bool_)

    @property
    def written(self) -> dict[str, str]:
        """Headers of the written columns by field, without ``other``."""
        left_out = {
            *(() if any(self.crs) else ("crs", "west", "north", "pixel_width", "pixel_height")),
            *(() if any(self.time_utc) else ("time_utc",)),
            *(() if np.isfinite(self.height_m).any() else ("height_m", "facade_share")),
            *(() if np.isfinite(self.fx_px).any() else ("fx_px", "fy_px", "cx_px", "cy_px")),
            *(() if any(self.shard) else ("shard", "offset_bytes", "size_bytes")),
        }
        return {name: header for name, header in HEADERS.items() if name not in left_out}

    @classmethod
    def from_columns(cls, known: Mapping[str, Any], other: Mapping[str, tuple[str, ...]]) -> Table:
        """Make a table of some columns; all others are unknown.

        Parameters
        ----------
        known : mapping of str to array or tuple of str
            Columns by field, at least the columns that every table has.
        """
        count = len(known["img_names"])
        # Unknown columns share their cells, as cells are never changed.
        texts, numbers = ("",) * count, np.broadcast_to(np.nan, count)
        unknown = {name: texts if name in _TEXT else numbers for name in HEADERS}
        return cls(**{**unknown, **known}, other=other)

    def join_other(self, columns: Mapping[str, Mapping[str, str]]) -> Table:
        """Copy with these additional columns, keyed by image.

        Parameters
        ----------
        columns : mapping of str to mapping of str to str
            Cells by image name, for each header; empty for other images.
        """
        return self.replace_other(
            {header: tuple(cells.get(name, "") for name in self.img_names) for header, cells in columns.items()}
        )

    def replace_other(self, other: Mapping[str, tuple[str, ...]]) -> Table:
        """Copy with these additional columns, in the order of the rows."""
        return replace(self, other=other)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the table to a file atomically; raises OutputError."""
        write_whole(path, (block.encode("utf-8") for block in self._blocks()))

    def _blocks(self) -> Iterator[str]:
        """Yield the text of the headers, then of some rows at a time."""
        written = self.written
        yield _csv([[*written.values(), *self.other]])
        for start in range(0, len(self), _ROWS_A_BLOCK):
            rows = slice(start, start + _ROWS_A_BLOCK)
            cells = [_format_column(name, getattr(self, name)[rows]) for name in written]
            yield _csv(zip(*cells, *(column[rows] for column in self.other.values())))

    @classmethod
    def _parse(cls, texts: Iterable[str], name: str) -> Table:
        """Parse a table of a capture or of the published data, from texts of whole lines.

        Raises
        ------
        InvalidInput
            A column of the published data is missing, or rows cannot be read; messages call the table ``name``.
        """
        faults: list[tuple[int, str]] = []
        rows = CsvRows(texts, name, faults)
        gathered = _ColumnBuilder(rows.headers, name, faults)
        for cells in rows:
            gathered.add(cells)
        return gathered.table()

    @classmethod
    def load(cls, path: Address) -> Table:
        """Read a table from a file; raises InvalidInput if the file or a row cannot be read."""
        try:
            texts = _read_texts(store_path(path))
            try:
                return cls._parse(texts, Message("table {0}", path))
            except InvalidInput:
                # Report undecodable bytes before parse errors.
                deque(texts, maxlen=0)
                raise
        except (OSError, UnicodeDecodeError) as wrong:
            raise InvalidInput("table {0}: cannot be read ({1})", path, wrong) from wrong


class Column(NamedTuple):
    """A column of a table with the type of its values.

    Attributes
    ----------
    header : str
        Header as written.
    kind : str
        `WHOLE`, `NUMBER`, `TIME` (Unix seconds) or `TEXT`.
    values : array (n,) or tuple of str
        Unknown values are NaN or empty.
    """

    header: str
    kind: str
    values: Floats | Numbers | tuple[str, ...]


def written_columns(table: Table) -> list[Column]:
    """List all written columns; raises InvalidInput for invalid times."""
    found = []
    for name, header in table.written.items():
        values = getattr(table, name)
        if name == "time_utc":
            found.append(Column(header, TIME, unix_seconds(values)))
        elif name in _TEXT:
            found.append(Column(header, TEXT, values))
        else:
            known = values[np.isfinite(values)]
            # Tables from elsewhere may have windows in fractions of pixels.
            is_whole = name in (*_WHOLE, *_COUNTS) and bool((known == np.floor(known)).all())
            found.append(Column(header, WHOLE if is_whole else NUMBER, values))
    return found + [Column(header, TEXT, cells) for header, cells in table.other.items()]


def json_cell(column: Column, row: int) -> str | int | float | None:
    """Value of a column in a row for JSON; None if unknown."""
    value = column.values[row]
    if isinstance(value, str):
        return value or None
    if not np.isfinite(value):
        return None
    return int(value) if column.kind == WHOLE else float(value)


def unix_seconds(times_utc: Sequence[str]) -> Floats:
    """Convert times in ISO 8601 to Unix seconds (n,), NaN for empty texts; raises InvalidInput."""
    found = np.full(len(times_utc), np.nan)
    for row, text in enumerate(times_utc):
        if text:
            try:
                found[row] = time_s(text, "time_utc")
            except InvalidInput as wrong:
                raise InvalidInput("time_utc {0!r}: is not a time in ISO 8601", text) from wrong
    return found


def first_faults(faults: Sequence[str], joint: str = "; ") -> Message:
    """Join the first three faults, and the number of others."""
    more = [Message("and {0:,} more", len(faults) - 3)] if len(faults) > 3 else []
    return Message.joined(joint, [*faults[:3], *more])


def other_columns(path: Path) -> dict[str, dict[str, str]]:
    """Read the additional columns of a table as cells by image name; empty if the file does not exist.

    Raises
    ------
    OutputError
        The headers cannot be read, or the table has additional columns and cannot be read.
    """
    try:
        if _headers(path) <= set(HEADERS.values()):
            return {}
        table = Table.load(path)
    except InvalidInput as wrong:
        raise OutputError("{0}", wrong, remedy="repair the table, or remove it to have it written anew") from wrong
    return {header: dict(zip(table.img_names, cells)) for header, cells in table.other.items()}


def _headers(path: Path) -> set[str]:
    """Read the headers of a table, empty if the file does not exist; raises InvalidInput."""
    try:
        if not path.exists():
            return set()
        with open_foreign(path, MAX_TABLE_BYTES) as file:
            return set(next(csv.reader(text_lines(file, "utf-8-sig")), []))
    except (OSError, UnicodeDecodeError, csv.Error, InvalidInput) as wrong:
        reason = getattr(wrong, "strerror", None) or wrong
        raise InvalidInput("table {0}: cannot be read ({1})", path, reason) from wrong


#: Headers of columns by field of `Table`, in the order in which they are written.
#: Three headers are those of the published dataset.
HEADERS = {one.name: one.name for one in fields(Table) if one.name != "other"}
HEADERS.update(lat_deg="Lat", lon_deg="Lon", zoom="Alt")


def _read_texts(path: Path) -> Iterator[str]:
    r"""Yield the text of a file, some whole lines at a time, with all line ends as ``\n``."""
    start = 0
    for raw in _read_blocks(path):
        try:
            text = raw.decode("utf-8")
        except UnicodeDecodeError as wrong:
            raise _shift_error(wrong, start) from wrong
        if start == 0:
            # Some editors write a byte order mark.
            text = text.removeprefix("\ufeff")
        start += len(raw)
        yield text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text


def _read_blocks(path: Path) -> Iterator[bytes]:
    """Yield whole lines of a file, some at a time."""
    try:
        with open_foreign(path, MAX_TABLE_BYTES, _BLOCK_BYTES) as file:
            while raw := file.read(_BLOCK_BYTES) + read_line(file):
                yield raw
    except InvalidInput as wrong:
        raise InvalidInput("table {0}: cannot be read ({1})", path, wrong) from wrong


def _shift_error(wrong: UnicodeDecodeError, start: int) -> UnicodeDecodeError:
    """Shift a decoding error to its position in a file, for text that begins at byte ``start``."""
    before = b" " * start
    return UnicodeDecodeError(
        wrong.encoding, before + wrong.object, start + wrong.start, start + wrong.end, wrong.reason
    )


def _csv(rows: Iterable[Sequence[str]]) -> str:
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="\n").writerows(rows)
    return buffer.getvalue()


def _format_column(name: str, column: Sequence[str] | NDArray[Any]) -> Sequence[str]:
    """Format the cells of a column."""
    if isinstance(column, np.ndarray):
        # Compare bits: -0.0 is written differently from 0.0, and NaN equals NaN.
        bits = column.view(np.int64)
        is_constant = len(column) > 0 and bool((bits == bits[0]).all())
        values = column[:1] if is_constant else column
        texts = [_format_number(value, whole=name in _COUNTS) for value in values.tolist()]
        return texts * len(column) if is_constant else texts
    # Texts from a provider or server.
    if name in ("source", "attribution", "imagery_date", "reason"):
        written = {text: table_cell(text) for text in set(column)}
        return [written[text] for text in column]
    return column


def _format_number(value: float, *, whole: bool) -> str:
    if math.isnan(value):
        return ""
    return repr(int(value)) if whole and float(value).is_integer() else repr(value)


class _ColumnBuilder:
    """Collects the columns of a table from portions of its rows.

    Raises
    ------
    InvalidInput
        A column of the published data is missing, or one appears twice.
    """

    def __init__(self, headers: Sequence[str], name: str, faults: list[tuple[int, str]]) -> None:
        # An older spelling.
        headers = [{"row": "rows"}.get(header, header) for header in headers]
        needed = [HEADERS[field_name] for field_name in _NEEDED]
        for header in needed:
            if header not in headers:
                raise InvalidInput("{0}: has no column {1}; needs {2}", name, header, ",".join(needed))
        twice = [header for header, count in Counter(headers).items() if header and count > 1]
        if twice:
            raise InvalidInput(
                "{0}: has column {1} more than once", name, twice[0], remedy="rename or remove all but one"
            )
        self._headers, self._name, self._faults = headers, name, faults
        names = {header: field_name for field_name, header in HEADERS.items()}
        #: Field of each column, or the header of an additional column; empty for columns without a header.
        self._fields = [names.get(header, header) for header in headers]
        self._texts: dict[str, list[str]] = {
            field: [] for field in self._fields if field and (field in _TEXT or field not in HEADERS)
        }
        #: Numbers of columns by field, as arrays that grow in place; without columns that are empty so far.
        self._numbers: dict[str, array[float]] = {}
        self._count = 0
        #: Texts that appear in many rows.
        self._known: dict[str, str] = {}

    def add(self, cells: ReadCells | CutCells) -> None:
        """Add rows; report cells that cannot be read as faults of their lines."""
        for column, (field_name, header) in enumerate(zip(self._fields, self._headers)):
            if field_name in self._texts:
                self._texts[field_name] += _intern(cells.texts(column), self._known)
            elif field_name:
                values = cells.numbers(column)
                if values is None or not _are_allowed(field_name, values):
                    values = _read_one_by_one(field_name, header, cells.texts(column), cells.lines, self._faults)
                self._append(field_name, values)
        self._count += len(cells.lines)

    def _append(self, field_name: str, values: Floats) -> None:
        if field_name not in self._numbers:
            if values.strides == (0,) and np.isnan(values[0]):
                return
            self._numbers[field_name] = array("d", [math.nan]) * self._count
        self._numbers[field_name].frombytes(np.ascontiguousarray(values).data.cast("B"))

    def table(self) -> Table:
        """Make the table of all rows; raises InvalidInput with the first faults."""
        if self._faults:
            named = [Message("line {0} {1}", line, fault) for line, fault in sorted(self._faults)]
            raise InvalidInput("{0}: {1}", self._name, first_faults(named))
        columns: dict[str, Any] = {name: np.zeros(self._count) for name in _WHOLE}
        columns.update((name, np.frombuffer(values)) for name, values in self._numbers.items() if values)
        columns.update((name, columns[name].astype(np.int64)) for name in _WHOLE)
        texts = {header: tuple(cells) for header, cells in self._texts.items()}
        columns.update((name, cells) for name, cells in texts.items() if name in HEADERS)
        return Table.from_columns(columns, {header: cells for header, cells in texts.items() if header not in HEADERS})


def _intern(cells: Sequence[str], known: dict[str, str]) -> Sequence[str]:
    """Replace equal texts by one object, unless most texts are different."""
    if cells[0] is cells[-1] and cells == [cells[0]] * len(cells):
        return [known.setdefault(cells[0], cells[0])] * len(cells)
    if len(set(cells)) > len(cells) // 2:
        return cells
    return [known.setdefault(cell, cell) for cell in cells]


def _are_allowed(name: str, values: Floats) -> bool:
    """Whether a column may have these numbers, with NaN for empty cells."""
    if name in _NEEDED and not np.isfinite(values).all():
        return False
    if name not in _WHOLE:
        return True
    low, high = _WHOLE[name]
    return bool(((values == np.floor(values)) & (values >= low) & (values <= high)).all())


def _read_one_by_one(
    name: str, header: str, cells: Sequence[str], lines: Sequence[int], faults: list[tuple[int, str]]
) -> Floats:
    """Parse numbers one by one, NaN for empty cells if allowed; appends cells that cannot be read to ``faults``."""
    may_be_empty = name not in _NEEDED
    values = np.full(len(cells), np.nan)
    for index, (line, cell) in enumerate(zip(lines, cells)):
        if not cell and may_be_empty:
            continue
        try:
            values[index] = real_number(cell)
        except ValueError:
            faults.append((line, Message("has {0} {1!r}, not a number", header, cell)))
            continue
        if not may_be_empty and not math.isfinite(values[index]):
            faults.append((line, Message("has {0} {1!r}, not a finite number", header, cell)))
        elif name in _WHOLE and not values[index].is_integer():
            faults.append((line, Message("has {0} {1!r}, not a whole number", header, cell)))
        elif name in _WHOLE and not _are_allowed(name, values[index : index + 1]):
            low, high = _WHOLE[name]
            faults.append((line, Message("has {0} {1!r}, not from {2:.0f} to {3:.0f}", header, cell, low, high)))
    return values


def image_parts(table: Table) -> tuple[str, ...] | None:
    """Part of each row: one of `folder.PARTS`, `GAP`, or empty if the image is not used; None without a split."""
    return table.other.get(SPLIT)


def usable_rows(table: Table) -> NDArray[np.bool_]:
    """Rows (n,) whose images have been made and not rejected by cleaning."""
    marks = table.other.get(REJECTED, ("",) * len(table))
    return table.made & np.array([not mark for mark in marks], np.bool_)
