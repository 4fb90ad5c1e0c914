"""Read and write the table of a dataset, ``meta_data.csv``; parts of a split come from its column ``split``."""

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
from numpy.typing import NDArray

from ..arrays import Floats, Numbers
from ..errors import InvalidInput, Message, OutputError
from ..limits import MAX_TABLE_BYTES
from ..numbers import real_number
from ..storage.files import open_foreign, read_line, text_lines, write_whole
from ..storage.stores import Address, store_path
from ..text.plain import table_cell, time_s
from .cells import CsvRows, CutCells, ReadCells

#: Headers that differ from the names of `Table`'s fields: the published dataset's.
_HEADERS = {"lat_deg": "Lat", "lon_deg": "Lon", "zoom": "Alt"}
#: Columns of the published dataset, which every table has; all others may be missing, and their cells empty.
_NEEDED = ("img_names", "columns", "rows", "lat_deg", "lon_deg", "zoom")
_WHOLE = ("columns", "rows", "zoom")
#: Least and greatest of them: a double holds whole numbers up to 2^53, and pixels at a zoom above 1,000 no size.
_WHOLE_RANGES = {
    **dict.fromkeys(("columns", "rows"), (-(2.0**53), 2.0**53)),
    "zoom": (-1000.0, 1000.0),
}
_TEXT = ("img_names", "time_utc", "crs", "source", "attribution", "imagery_date", "status", "reason", "shard")
#: Columns of whole numbers, written as such; readers of other datasets may find none in them.
_COUNTS = (
    *("left_px", "top_px", "width_px", "height_px", "image_width_px", "image_height_px"),
    *("offset_bytes", "size_bytes"),
)
#: Column that is not ours alone: why an image is rejected; empty for one that is kept. A table without is not cleaned.
REJECTED = "rejected"
#: Kinds of columns.
WHOLE, NUMBER, TIME, TEXT = "whole", "number", "time", "text"
#: Rows that are text at a time.
_ROWS_A_BLOCK = 2000
#: Faults of a file that one message names.
_FAULTS_NAMED = 3
#: Read in one go. A thread that reads little at a time gives Python's lock away and takes it back before another one
#: wakes, and one that decodes a whole table in a single call keeps it: a window would stand still meanwhile.
_BLOCK_BYTES = 1 << 20
#: Column of the table: the part of an image. A table that has none is not split.
SPLIT = "split"
#: In place of a part: an image that is in none, as its ground is shared with another part or is too near to one.
GAP = "gap"


@dataclass(frozen=True, eq=False)
class Table:
    """Rows of a dataset as arrays (n,).

    Numbers that are not known are NaN, texts that are not known are empty.

    Parameters
    ----------
    img_names : tuple of str
        File names in the table's folder, with ending.
    columns, rows : array of int64
        Grid indices.
    lat_deg, lon_deg : array
        Centres of the images themselves (``Lat``, ``Lon``).
    zoom : array of int64
        Headed ``Alt``, as published.
    entropies : array
        Bits; NaN for images that could not be made, or whose entropy nobody has worked out.
    pose_lat_deg, pose_lon_deg, agl_m, yaw_deg, tilt_deg, roll_deg : array
        Poses of the camera.
    time_utc : tuple of str
        When each was captured, as ISO 8601, of points that say so; tables of others are written without it.
    height_m : array
        Of cameras over relief, above the WGS 84 ellipsoid; tables of others are written without it and the share of
        faces.
    left_px, top_px, width_px, height_px : array
        Windows in the source's global pixel grid at ``zoom``.
    image_width_px, image_height_px : array
        Sizes of the images as written.
    crs : tuple of str
        Code or WKT of the source's own CRS; empty where the windows are of the Web-Mercator map. Where no image has
        one, tables are written without it and the next four.
    west, north, pixel_width, pixel_height : array
        Where the windows lie in that CRS, in its unit: their upper left corners, and the pixels of ``zoom``.
    fx_px, fy_px, cx_px, cy_px : array
        Focal lengths and principal point of the images as written; (0, 0) is the upper left corner of the image, the
        centre of its first pixel (0.5, 0.5). Of map frames they are those of the camera that looks straight down and
        sees the frame, which is a pinhole's picture within the bound of the map frame.
    sky_share, unmapped_share, facade_share : array
        Shares of an image's pixels that see no ground, ground that no Web-Mercator source has, and faces of the relief
        that no map shows.
    nominal_lat_deg, nominal_lon_deg, nominal_agl_m, nominal_yaw_deg, nominal_tilt_deg, nominal_roll_deg : array
        Poses as they were meant to be, where wind has moved the camera.
    status, reason : tuple of str
        ``done``, or ``failed`` and why.
    shard : tuple of str
        Name of the tar beside the table that an image is in; tables of images that are files are written without it
        and the next two.
    offset_bytes, size_bytes : array
        Where the image's own data begin in that file, and how many they are.
    other : mapping of str to tuple of str
        Columns that are not ours, kept as they are.
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
        columns = {name: getattr(self, name) for name in FIELDS} | dict(self.other)
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
        """Headers of the columns that are written, by field; without `other`."""
        left_out = {
            *(() if any(self.crs) else ("crs", "west", "north", "pixel_width", "pixel_height")),
            *(() if any(self.time_utc) else ("time_utc",)),
            *(() if np.isfinite(self.height_m).any() else ("height_m", "facade_share")),
            *(() if np.isfinite(self.fx_px).any() else ("fx_px", "fy_px", "cx_px", "cy_px")),
            *(() if any(self.shard) else ("shard", "offset_bytes", "size_bytes")),
        }
        return {name: header for header, name in _FIELD_OF.items() if name not in left_out}

    @classmethod
    def from_columns(cls, known: Mapping[str, Any], other: Mapping[str, tuple[str, ...]]) -> Table:
        """Table of some columns, by the names of fields; all others are not known.

        Parameters
        ----------
        known : mapping of str to array or tuple of str
            At least those that every table has.
        """
        count = len(known["img_names"])
        # Of which there are many columns: one text, and one number that is not written to.
        texts, numbers = ("",) * count, np.broadcast_to(np.nan, count)
        unknown = {name: texts if name in _TEXT else numbers for name in FIELDS}
        return cls(**{**unknown, **known}, other=other)

    def join_other(self, columns: Mapping[str, Mapping[str, str]]) -> Table:
        """Copy with these columns as those that are not ours.

        Parameters
        ----------
        columns : mapping of str to mapping of str to str
            Cells by image name; those of images without one are empty.
        """
        return self.replace_other(
            {header: tuple(cells.get(name, "") for name in self.img_names) for header, cells in columns.items()}
        )

    def replace_other(self, other: Mapping[str, tuple[str, ...]]) -> Table:
        """Copy with these columns, cells in the order of the rows, as those that are not ours."""
        return replace(self, other=other)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the table to a file, whole or not at all; raises OutputError."""
        write_whole(path, (block.encode("utf-8") for block in self._blocks()))

    def _blocks(self) -> Iterator[str]:
        """Text of the headers and then of some rows at a time, as cells take far more memory than numbers."""
        written = self.written
        yield _csv([[*written.values(), *self.other]])
        for start in range(0, len(self), _ROWS_A_BLOCK):
            rows = slice(start, start + _ROWS_A_BLOCK)
            own = [_format_column(name, getattr(self, name)[rows]) for name in written]
            yield _csv(zip(*own, *(column[rows] for column in self.other.values())))

    @classmethod
    def _parse(cls, texts: Iterable[str], name: str) -> Table:
        """Table from texts of whole lines, or from those of a published one.

        Raises
        ------
        InvalidInput
            Without one of the published columns, or with rows that cannot be read, which are named by line; messages
            call the table ``name``.
        """
        faults: list[tuple[int, str]] = []
        rows = CsvRows(texts, name, faults)
        gathered = _ColumnBuilder(rows.headers, name, faults)
        for cells in rows:
            gathered.add(cells)
        return gathered.table()

    @classmethod
    def load(cls, path: Address) -> Table:
        """Table from a file; raises InvalidInput where it cannot be read, as a whole or in some rows."""
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
        As it is written.
    kind : str
        `WHOLE`, `NUMBER`, `TIME` (Unix seconds) or `TEXT`.
    values : array (n,) or tuple of str
        NaN and empty texts are not known.
    """

    header: str
    kind: str
    values: Floats | Numbers | tuple[str, ...]


def written_columns(table: Table) -> list[Column]:
    """Return all columns that are written; raises InvalidInput for invalid times."""
    found = []
    for name, header in table.written.items():
        values = getattr(table, name)
        if name == "time_utc":
            found.append(Column(header, TIME, unix_seconds(values)))
        elif name in _TEXT:
            found.append(Column(header, TEXT, values))
        else:
            known = values[np.isfinite(values)]
            # Windows in pixels are whole ones in our tables, and may be others in those of others.
            is_whole = name in (*_WHOLE, *_COUNTS) and bool((known == np.floor(known)).all())
            found.append(Column(header, WHOLE if is_whole else NUMBER, values))
    return found + [Column(header, TEXT, cells) for header, cells in table.other.items()]


def json_cell(column: Column, row: int) -> str | int | float | None:
    """Value of a column in a row as JSON has it; None where it is not known."""
    value = column.values[row]
    if isinstance(value, str):
        return value or None
    if not np.isfinite(value):
        return None
    return int(value) if column.kind == WHOLE else float(value)


def unix_seconds(times_utc: Sequence[str]) -> Floats:
    """Unix seconds (n,) of times in ISO 8601, NaN for empty ones; raises InvalidInput for invalid times."""
    found = np.full(len(times_utc), np.nan)
    for at, text in enumerate(times_utc):
        if text:
            try:
                found[at] = time_s(text, "time_utc")
            except InvalidInput as wrong:
                raise InvalidInput("time_utc {0!r}: is no time in ISO 8601", text) from wrong
    return found


def first_faults(faults: Sequence[str], joint: str = "; ") -> Message:
    """Return the first faults of many, and how many more there are."""
    more = [Message("and {0:,} more", len(faults) - _FAULTS_NAMED)] if len(faults) > _FAULTS_NAMED else []
    return Message.joined(joint, [*faults[:_FAULTS_NAMED], *more])


def other_columns(path: Path) -> dict[str, dict[str, str]]:
    """Columns of a table that are not ours, each as cells by image name; empty where there is no such file.

    Raises
    ------
    OutputError
        Where it has such columns and cannot be read.
    """
    try:
        if _headers(path) <= set(HEADERS):
            return {}
        table = Table.load(path)
    except InvalidInput as wrong:
        raise OutputError("{0}", wrong, remedy="repair the table, or remove it to have it written anew") from wrong
    return {header: dict(zip(table.img_names, cells)) for header, cells in table.other.items()}


def _headers(path: Path) -> set[str]:
    """Headers of a table, none where there is no such file; raises InvalidInput, which names it."""
    try:
        if not path.exists():
            return set()
        with open_foreign(path, MAX_TABLE_BYTES) as file:
            return set(next(csv.reader(text_lines(file, "utf-8-sig")), []))
    except (OSError, UnicodeDecodeError, csv.Error, InvalidInput) as wrong:
        reason = getattr(wrong, "strerror", None) or wrong
        raise InvalidInput("table {0}: cannot be read ({1})", path, reason) from wrong


#: Fields of `Table` that are columns of ours, in the order they are written.
FIELDS = tuple(f.name for f in fields(Table) if f.name != "other")
#: Their headers.
HEADERS = tuple(_HEADERS.get(name, name) for name in FIELDS)
_FIELD_OF = dict(zip(HEADERS, FIELDS))


def _read_texts(path: Path) -> Iterator[str]:
    """Text of a file, some whole lines at a time, with the ends that Python gives them, whatever system wrote them."""
    start = 0
    for raw in _read_blocks(path):
        try:
            text = raw.decode("utf-8")
        except UnicodeDecodeError as wrong:
            raise _shift_error(wrong, start) from wrong
        if start == 0:
            # The byte order mark that some editors write.
            text = text.removeprefix("\ufeff")
        start += len(raw)
        yield text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text


def _read_blocks(path: Path) -> Iterator[bytes]:
    """Whole lines of a file, some at a time."""
    try:
        with open_foreign(path, MAX_TABLE_BYTES, _BLOCK_BYTES) as file:
            while raw := file.read(_BLOCK_BYTES) + read_line(file):
                yield raw
    except InvalidInput as wrong:
        raise InvalidInput("table {0}: cannot be read ({1})", path, wrong) from wrong


def _shift_error(wrong: UnicodeDecodeError, start: int) -> UnicodeDecodeError:
    """An error of a text that begins at byte ``start``, with its place in the file."""
    before = b" " * start
    return UnicodeDecodeError(
        wrong.encoding, before + wrong.object, start + wrong.start, start + wrong.end, wrong.reason
    )


def _csv(rows: Iterable[Sequence[str]]) -> str:
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="\n").writerows(rows)
    return buffer.getvalue()


def _format_column(name: str, column: Sequence[str] | NDArray[Any]) -> Sequence[str]:
    """Cells of a column."""
    if isinstance(column, np.ndarray):
        # By their bits: -0.0 is written otherwise than 0.0, and NaN is as good as any.
        bits = column.view(np.int64)
        alike = len(column) > 0 and bool((bits == bits[0]).all())
        values = column[:1] if alike else column
        texts = [_format_number(value, whole=name in _COUNTS) for value in values.tolist()]
        return texts * len(column) if alike else texts
    # Texts of a provider or a server.
    if name in ("source", "attribution", "imagery_date", "reason"):
        written = {text: table_cell(text) for text in set(column)}
        return [written[text] for text in column]
    return column


def _format_number(value: float, *, whole: bool) -> str:
    if math.isnan(value):
        return ""
    return repr(int(value)) if whole and float(value).is_integer() else repr(value)


class _ColumnBuilder:
    """Columns of a table, of which some rows come at a time.

    Raises
    ------
    InvalidInput
        Headers without one of the published columns, or with one more than once.
    """

    def __init__(self, headers: Sequence[str], name: str, faults: list[tuple[int, str]]) -> None:
        # An older spelling.
        headers = [{"row": "rows"}.get(header, header) for header in headers]
        needed = [_HEADERS.get(field_name, field_name) for field_name in _NEEDED]
        for header in needed:
            if header not in headers:
                raise InvalidInput("{0}: has no column {1}; needs {2}", name, header, ",".join(needed))
        twice = [header for header, count in Counter(headers).items() if header and count > 1]
        if twice:
            raise InvalidInput(
                "{0}: has column {1} more than once", name, twice[0], remedy="rename or remove all but one"
            )
        self._headers, self._name, self._faults = headers, name, faults
        #: By field, or by header where the column is not ours; what has no header is left out.
        self._fields = [_FIELD_OF.get(header, header) for header in headers]
        self._format_column: dict[str, list[str]] = {
            field: [] for field in self._fields if field and (field in _TEXT or field not in FIELDS)
        }
        #: Doubles that grow in place; of columns that are empty so far there are none.
        self._numbers: dict[str, array[float]] = {}
        self._count = 0
        #: Texts that are in many rows, by themselves.
        self._known: dict[str, str] = {}

    def add(self, cells: ReadCells | CutCells) -> None:
        """Some rows; cells that cannot be read are faults of their lines."""
        for column, (field_name, header) in enumerate(zip(self._fields, self._headers)):
            if field_name in self._format_column:
                self._format_column[field_name] += _intern(cells.texts(column), self._known)
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
        """Table of all rows; raises InvalidInput with the first faults where there are any."""
        if self._faults:
            named = [Message("line {0} {1}", line, fault) for line, fault in sorted(self._faults)]
            raise InvalidInput("{0}: {1}", self._name, first_faults(named))
        columns: dict[str, Any] = {name: np.zeros(self._count) for name in _WHOLE}
        columns.update((name, np.frombuffer(values)) for name, values in self._numbers.items() if values)
        columns.update((name, columns[name].astype(np.int64)) for name in _WHOLE)
        texts = {header: tuple(cells) for header, cells in self._format_column.items()}
        columns.update((name, cells) for name, cells in texts.items() if name in FIELDS)
        return Table.from_columns(columns, {header: cells for header, cells in texts.items() if header not in FIELDS})


def _intern(cells: Sequence[str], known: dict[str, str]) -> Sequence[str]:
    """Cells, as the texts that are ``known`` already; those of which most are different are left alone."""
    if cells[0] is cells[-1] and cells == [cells[0]] * len(cells):
        return [known.setdefault(cells[0], cells[0])] * len(cells)
    if len(set(cells)) > len(cells) // 2:
        return cells
    return [known.setdefault(cell, cell) for cell in cells]


def _are_allowed(name: str, values: Floats) -> bool:
    """Whether a column may have such numbers, NaN among them for empty cells."""
    if name in _NEEDED and not np.isfinite(values).all():
        return False
    if name not in _WHOLE:
        return True
    low, high = _WHOLE_RANGES[name]
    return bool(((values == np.floor(values)) & (values >= low) & (values <= high)).all())


def _read_one_by_one(
    name: str, header: str, cells: Sequence[str], lines: Sequence[int], faults: list[tuple[int, str]]
) -> Floats:
    """Numbers of cells, NaN for empty ones where they may be; those that cannot be read are added to ``faults``."""
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
            low, high = _WHOLE_RANGES[name]
            faults.append((line, Message("has {0} {1!r}, not from {2:.0f} to {3:.0f}", header, cell, low, high)))
    return values


def image_parts(table: Table) -> tuple[str, ...] | None:
    """Part of each row: one of `folder.PARTS`, `GAP`, or empty where the image is not taken; None without a split."""
    return table.other.get(SPLIT)


def usable_rows(table: Table) -> NDArray[np.bool_]:
    """Rows (n,) whose images are there and have not been rejected by cleaning."""
    marks = table.other.get(REJECTED, ("",) * len(table))
    return table.made & np.array([not mark for mark in marks], np.bool_)
