"""Read poses from a table whose header names the columns, in any order and by any usual name."""

from __future__ import annotations

import csv
import itertools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ..errors import InvalidInput, Message
from ..numbers import real_number
from ..text.plain import time_s
from ..units import LENGTHS_M
from .areas.area import ANGLES, Points
from .clock import check_column
from .litchi_table import is_litchi, read_litchi

#: Usual names of the columns, in lower case; of several columns of heights, the one listed first counts.
_HEADERS = {
    "lat": ("lat", "latitude", "lat_deg", "latitude_deg", "y"),
    "lon": ("lon", "lng", "long", "longitude", "lon_deg", "longitude_deg", "x"),
    "agl": (
        "agl",
        "agl_m",
        "height_above_ground",
        "altitude_agl",
        "height",
        "height_m",
        "altitude",
        "alt",
        "z",
    ),
    "yaw": ("yaw", "yaw_deg", "heading", "heading_deg", "azimuth", "azimuth_deg", "course", "bearing"),
    "tilt": ("tilt", "tilt_deg", "off_nadir", "off_nadir_deg"),
    "gimbal_pitch": (
        "gimbal_pitch",
        "gimbal_pitch_deg",
        "gimbalpitchangle",
        "camera_pitch",
        "camera_pitch_deg",
    ),
    "roll": ("roll", "roll_deg", "gimbal_roll", "gimbal_roll_deg"),
    "time": ("time", "time_utc", "timestamp", "datetime", "date_time", "utc", "t"),
}
#: First line that states the separator of cells, as spreadsheets write it.
_SEPARATOR = re.compile(r'\ufeff?"?sep=(.)"?\s*', re.IGNORECASE)
#: Characters that stand for a hyphen in typeset text.
UNICODE_MINUS = {0x2212: "-", 0x2013: "-", 0xFE63: "-", 0xFF0D: "-"}


class _Row(NamedTuple):
    """A row of a table: number (from 1) and text of its first line, its cells, and whether commas are decimal."""

    number: int
    line: str
    cells: list[str]
    has_decimal_commas: bool


def read_header(lines: Iterable[str], where: str = Message("coordinates")) -> list[str]:
    """Return the names of a table's columns; no names if its first line has numbers or no usual name."""
    row = next(_rows(lines, where), None)
    cells = [] if row is None else [cell.lower() for cell in row.cells]
    known = {name for names in _HEADERS.values() for name in names}
    is_header = known.intersection(cells) and not any(cell[:1] in "+-.0123456789" for cell in cells if cell)
    return row.cells if row is not None and is_header else []


def states_separator(line: str) -> bool:
    """Whether the first line of a file gives spreadsheets the separator: ``sep=;``."""
    return _SEPARATOR.fullmatch(line) is not None


def usual_names(columns: Sequence[str]) -> dict[str, list[str]]:
    """Find the columns of `lat`, `lon`, `agl`, `yaw`, `tilt` and so on by their usual names.

    Of several columns for one quantity, the first counts. Quantities without a column are left out.
    """
    lower = [column.lower() for column in columns]
    headers: Mapping[str, Sequence[str]] = _HEADERS
    if "pose_lat_deg" in lower:
        # In the table of a dataset, Lat, Lon and Alt are the image's, not the pose's.
        pose_columns = {"lat": "pose_lat_deg", "lon": "pose_lon_deg", "agl": "agl_m", "time": "time_utc"}
        headers = {name: (pose_columns.get(name, f"{name}_deg"),) for name in ("lat", "lon", "agl", *ANGLES, "time")}
    found = {
        quantity: [column for name in names for column, low in zip(columns, lower) if low == name]
        for quantity, names in headers.items()
    }
    return {quantity: matches for quantity, matches in found.items() if matches}


def read_poses(
    lines: Sequence[str],
    where: str = Message("coordinates"),
    agl_unit: str = "m",
    agl_m: float | None = None,
    most: int | None = None,
) -> Points:
    """Read points from a table, or from a Litchi mission.

    The columns ``lat`` and ``lon`` are needed, and ``agl`` unless a height is given; ``yaw``, ``tilt`` (0 looks
    straight down) or ``gimbal_pitch`` (-90 does), ``roll`` and ``time`` are optional. Other usual names, such as
    ``longitude``, ``heading`` or ``timestamp``, are understood; columns of other names are ignored, as are empty lines
    and lines that begin with #.

    Cells are separated by commas, semicolons, tabs or spaces, or as a first line ``sep=;`` states; with semicolons and
    tabs, numbers may have decimal commas. Quoted cells may span lines. Times are ISO 8601, in UTC unless they state a
    zone, or seconds after 1970 or after a start.

    Parameters
    ----------
    where : str
        Name of the table, for messages.
    agl_unit : str
        Unit of the column of heights, m or ft.
    agl_m : float or None
        Height of all points in metres, instead of the column.
    most : int or None
        Greatest number of rows to read; None for all.

    Raises
    ------
    InvalidInput
        A column is missing or given twice, a line cannot be read, or the times are implausible.
    """
    rows = _rows(lines, where)
    headers = [cell.lower() for cell in next(rows).cells]
    if is_litchi(headers):
        content = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
        return read_litchi([line.removeprefix("\ufeff") for line in content], where, agl_m)
    columns = _columns(headers, where, needs_agl=agl_m is None)
    poses = list(itertools.islice(rows, most))
    if not poses:
        raise InvalidInput("{0}: holds no poses below its header", where)
    values: dict[str, list[float]] = {name: [] for name in columns}
    dated = False
    for row in poses:
        place = _line(where, row.number)
        if len(row.cells) != len(headers):
            raise InvalidInput(
                "{0} {1!r} has {2} cells; its header names {3}",
                place,
                row.line.strip()[:80],
                len(row.cells),
                len(headers),
            )
        for name, column in columns.items():
            cell = row.cells[column].translate(UNICODE_MINUS)
            number = cell.replace(",", ".") if row.has_decimal_commas else cell
            try:
                values[name].append(real_number(number))
            except ValueError as wrong:
                if name != "time":
                    raise InvalidInput("{0} {1} {2!r}: must be a number", place, name, cell[:80]) from wrong
                values[name].append(time_s(cell, place))
                dated = True
    m_per_unit = LENGTHS_M[agl_unit]
    values["agl"] = [agl_m] * len(poses) if agl_m is not None else [agl * m_per_unit for agl in values["agl"]]
    if "gimbal_pitch" in values:
        values["tilt"] = [90.0 + pitch for pitch in values["gimbal_pitch"]]
    try:
        points = _points(values, slice(None))
    except InvalidInput as wrong:
        for at, row in enumerate(poses):
            _check_point(values, at, _line(where, row.number))
        raise InvalidInput("{0} {1}", Message("{0}:", where), wrong) from wrong
    check_column(points.times_s, where, dated=dated)
    return points


def _line(where: str, number: int) -> Message:
    return Message("{0}, line {1}:", where, number)


def _points(values: Mapping[str, list[float]], rows: slice) -> Points:
    angles = {f"{name}s_deg": tuple(values[name][rows]) for name in ANGLES if name in values}
    poses = tuple(zip(*(values[name][rows] for name in ("lat", "lon", "agl"))))
    return Points(poses, **angles, times_s=tuple(values.get("time", [])[rows]))


def _check_point(values: Mapping[str, list[float]], at: int, where: str) -> None:
    try:
        _points(values, slice(at, at + 1))
    except InvalidInput as wrong:
        raise InvalidInput("{0} {1}", where, wrong) from wrong


def _rows(lines: Iterable[str], where: str) -> Iterator[_Row]:
    """Yield the rows of a table, its header first, without empty lines and comments (#)."""
    numbered = enumerate(lines, 1)
    separator: str | None = ""
    for number, line in numbered:
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        if separator == "":
            if stated := _SEPARATOR.fullmatch(line):
                separator = stated[1]
                continue
            separator = next((one for one in ";\t," if one in line), None)
        cells = line.removeprefix("\ufeff").split(separator)
        if separator is not None and '"' in line:
            cells = _quoted(line, numbered, separator, _line(where, number)) or cells
        yield _Row(number, line, [cell.strip().strip('"') for cell in cells], separator not in (None, ","))


def _quoted(line: str, following: Iterator[tuple[int, str]], separator: str, where: str) -> list[str] | None:
    """Cells of a line and the following lines that its quoted cells span; None if the csv module cannot read them."""
    ended, taken = False, 0

    def lines() -> Iterator[str]:
        nonlocal ended, taken
        yield line.removeprefix("\ufeff") + "\n"
        for _, one in following:
            taken += 1
            yield one + "\n"
        ended = True

    cells = None
    try:
        cells = next(csv.reader(lines(), delimiter=separator))
    except csv.Error:
        # Lines already consumed cannot be read again.
        ended = taken > 0
    if ended:
        raise InvalidInput("{0} has a quotation mark without another one that ends the cell", where)
    return cells


def _columns(headers: list[str], where: str, *, needs_agl: bool) -> dict[str, int]:
    """Index of the column of each quantity."""
    index = {}
    for name, matches in usual_names(headers).items():
        if matches.count(matches[0]) > 1 or (len(matches) > 1 and name != "agl"):
            raise InvalidInput("{0}: columns {1} say the same", where, " ".join(dict.fromkeys(matches)))
        index[name] = headers.index(matches[0])
    if not needs_agl:
        index.pop("agl", None)
    missing = [name for name in ("lat", "lon", *(["agl"] if needs_agl else [])) if name not in index]
    if missing:
        raise InvalidInput("{0}: has no column {1}, only {2}", where, missing[0], ", ".join(headers))
    tilts = [name for name in ("tilt", "gimbal_pitch") if name in index]
    if len(tilts) > 1:
        raise InvalidInput("{0}: columns {1} say the same", where, " ".join(tilts))
    if {"pitch", "pitch_deg"} & set(headers) and not tilts:
        raise InvalidInput(
            "{0}: its column pitch may count from the horizon or from straight down",
            where,
            remedy="name it tilt (0 looks straight down) or gimbal_pitch (-90 does)",
        )
    return index


def table_text(points: Points) -> str:
    """Write points as a table that `read_poses` reads back."""
    columns: dict[str, Sequence[object]] = dict(zip(("lat", "lon", "agl"), zip(*points.poses)))
    columns.update((name, points.stated_deg(name)) for name in ANGLES if points.stated_deg(name))
    if points.times_s:
        columns["time"] = points.times_s
    rows = zip(*columns.values())
    return "".join(",".join(map(str, row)) + "\n" for row in (tuple(columns), *rows))
