"""A user's MBTiles file as a source: tiles of PNG, JPEG or WebP in Web Mercator."""

from __future__ import annotations

import os
import re
import sqlite3
import sys
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import PixelValues
from ..errors import Cancelled, InvalidInput, Message, PartError
from ..geodesy.mercator import HIGHEST_ZOOM, PixelGrid, extent_of_box, v_to_lat
from ..limits import (
    MAX_METADATA_CHARACTERS,
    MAX_QUERY_S,
    MAX_STORED_TILE_BYTES,
    MAX_TILE_PX,
    MAX_VIEW_CHARACTERS,
)
from ..numbers import real_number
from ..text.plain import one_line, whole_number
from .cache.database import FILE_ERRORS, connect, fault
from .decode import decode, picture_size
from .opening import FileSource
from .policy import Policy
from .source import Part, Window, tile_parts
from .tiles import Tile, tile_address

#: SQL functions that views of a file may call. Others may create huge values, or (LIKE, GLOB) take for ever in a single
#: call.
_FUNCTIONS = frozenset(
    "abs coalesce count ifnull iif length lower max min nullif round substr substring sum total typeof upper".split()
)


class MBTilesFile(FileSource):
    """An MBTiles file as a mission names it."""

    def _open(self, date: str) -> MBTilesSource:  # noqa: ARG002
        return open_mbtiles(self.text, alpha=self.options.encoded)


class MBTilesSource:
    """Tiles of an MBTiles file, opened read-only by `open_mbtiles`.

    Parameters
    ----------
    path : Path
    connection : sqlite3.Connection
        Closed with the source.
    limit : _TimeLimit
        Time limit of the connection.
    rows : mapping
        Metadata of the file.
    grid : PixelGrid
    alpha : bool
        Whether `fetch` returns the alpha channel of tiles.
    from_north : bool
        Whether rows count from the north; the standard counts from the south.
    """

    map_types: tuple[str, ...] = ()

    def __init__(
        self,
        path: Path,
        connection: sqlite3.Connection,
        limit: _TimeLimit,
        rows: Mapping[str, str],
        grid: PixelGrid,
        *,
        alpha: bool = False,
        from_north: bool = False,
    ) -> None:
        self.name = str(path)
        self.title = one_line(rows.get("name", "")) or path.stem
        self.attribution = one_line(rows.get("attribution", ""), MAX_METADATA_CHARACTERS)
        self.grid = grid
        self._from_north = from_north
        date = rows.get("date", "").strip()
        self.date = date if re.fullmatch(r"\d{4}(-\d\d){0,2}", date) else ""
        self.policy = Policy(licence=one_line(rows.get("license", rows.get("licence", ""))))
        self._alpha = alpha
        self._connection: sqlite3.Connection | None = connection
        self._limit = limit
        self._lock = threading.Lock()

    def __repr__(self) -> str:
        return f"MBTilesSource({self.name!r}, {self.grid})"

    def parts(self, window: Window) -> list[Part]:
        """Tiles that fill ``window``."""
        return tile_parts(window, self.grid)

    def fetch(self, map_type: str, part: Window) -> PixelValues:  # noqa: ARG002
        """Pixels of a tile, (tile_px, tile_px, 3 or 4) uint8.

        Raises
        ------
        InvalidInput
            ``part`` is not a tile of the grid.
        PartError
            The tile is missing or damaged.
        Cancelled
        """
        tile = tile_address(part, self.grid, self.title)
        body = self._body(tile)
        if body is None:
            raise PartError("{0}: is not in {1}", tile, Path(self.name).name)
        try:
            return decode(body, part.width_px, part.height_px, alpha=self._alpha)
        except PartError as reason:
            raise PartError("{0}: {1}", tile, reason) from reason

    def close(self) -> None:
        """Close the file; reads in other threads end at once and raise Cancelled."""
        self._limit.stop()
        with self._lock:
            if self._connection is not None:
                self._connection.close()
                self._connection = None

    def _body(self, tile: Tile) -> bytes | None:
        until_s = time.monotonic() + 10.0
        while True:
            try:
                return self._stored(tile)
            except FILE_ERRORS as wrong:  # noqa: PERF203  (a busy file is read again)
                if self._limit.stopped:
                    raise Cancelled("the source was closed") from None
                if self._limit.has_ended():
                    raise _too_slow(str(tile)) from wrong
                if fault(wrong) != "busy" or time.monotonic() > until_s:
                    raise PartError("{0}: {1} cannot be read ({2})", tile, Path(self.name).name, wrong) from wrong

    def _stored(self, tile: Tile) -> bytes | None:
        with self._lock:
            if self._connection is None:
                raise Cancelled("the source was closed")
            self._limit.start()
            row = self._connection.execute(
                "SELECT CASE WHEN length(tile_data) <= ? THEN tile_data END FROM tiles "
                "WHERE zoom_level = ? AND tile_column = ? AND tile_row = ? LIMIT 1",
                (MAX_STORED_TILE_BYTES, tile.zoom, tile.x, self._row(tile)),
            ).fetchone()
        return bytes(row[0]) if row and isinstance(row[0], bytes) else None

    def _row(self, tile: Tile) -> int:
        return tile.y if self._from_north else tile.tms[2]


def open_mbtiles(path: str | os.PathLike[str], *, alpha: bool = False) -> MBTilesSource:
    """Open an MBTiles file as a source.

    The tile size is read from the tiles, as are zooms if the metadata lack them. With ``alpha``, translucent tiles are
    returned unchanged.

    Raises
    ------
    InvalidInput
        The file is missing, is not MBTiles, or holds no pictures.
    """
    file = Path(path)
    try:
        exists = file.is_file()
    except OSError as wrong:
        raise InvalidInput("MBTiles {0}: cannot be read ({1})", file, wrong.strerror) from wrong
    if not exists:
        raise InvalidInput("MBTiles {0}: is not there", file)
    connection, limit = None, _TimeLimit()
    try:
        connection = _opened(file, limit)
        _check_defined(connection)
        rows, sample, place = _first_look(connection)
        grid = _grid(connection, rows, sample)
        from_north = _is_from_north(rows, *place)
        source = MBTilesSource(file, connection, limit, rows, grid, alpha=alpha, from_north=from_north)
    except InvalidInput as wrong:
        failure = InvalidInput("MBTiles {0}: {1}", file, wrong)
    except FILE_ERRORS as wrong:
        failure = InvalidInput("MBTiles {0}: is not an MBTiles file, or is damaged ({1})", file, wrong)
        if limit.has_ended():
            failure = InvalidInput(_too_slow(Message("MBTiles {0}", file)))
    else:
        return source
    if connection is not None:
        connection.close()
    raise failure


class _TimeLimit:
    """Time limit of queries, as views may loop for ever; for use by one thread at a time."""

    def __init__(self) -> None:
        self._until_s = 0.0
        self.stopped = False

    def start(self) -> None:
        """Start timing a query."""
        self._until_s = time.monotonic() + MAX_QUERY_S

    def stop(self) -> None:
        """End the running query and all later ones."""
        self.stopped = True

    def has_ended(self) -> bool:
        """Whether the query must end; called by SQLite from time to time."""
        return self.stopped or time.monotonic() > self._until_s


def _too_slow(what: str) -> PartError:
    return PartError(
        "{0}: takes more than {1:g} s to look a tile up",
        what,
        MAX_QUERY_S,
        remedy=("give the file an index: CREATE UNIQUE INDEX tile_index ON tiles (zoom_level, tile_column, tile_row)"),
    )


def _opened(file: Path, limit: _TimeLimit) -> sqlite3.Connection:
    try:
        return _readable(file, "mode=ro", limit)
    except sqlite3.OperationalError as wrong:
        # A file in WAL mode needs further files beside it, which a read-only folder does not allow. Without a log, no
        # program is writing, and the file can be opened as immutable.
        log = file.with_name(file.name + "-wal")
        if fault(wrong) != "unwritable" or (log.exists() and log.stat().st_size):
            raise
        return _readable(file, "mode=ro&immutable=1", limit)


def _readable(file: Path, mode: str, limit: _TimeLimit) -> sqlite3.Connection:
    """Open an untrusted file, and read its first page to detect errors, as SQLite opens files without reading."""
    # Wait only shortly for a program that writes the file, so that `close` takes effect between waits.
    connection = connect(file, mode, 0.25)
    try:
        connection.execute("PRAGMA trusted_schema = OFF")
        if sys.version_info >= (3, 11):
            connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, 2 * MAX_STORED_TILE_BYTES)
        connection.set_authorizer(_allowed)
        limit.start()
        # 100 steps between checks, as each step may copy a whole tile.
        connection.set_progress_handler(limit.has_ended, 100)
        connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
    except FILE_ERRORS:
        connection.close()
        raise
    return connection


def _allowed(action: int, _first: str | None, second: str | None, *_others: str | None) -> int:
    """Allow a statement, or a view that it reads, to select, read and call `_FUNCTIONS`, without recursion."""
    right = action in (sqlite3.SQLITE_SELECT, sqlite3.SQLITE_READ) or (
        action == sqlite3.SQLITE_FUNCTION and (second or "").lower() in _FUNCTIONS
    )
    return sqlite3.SQLITE_OK if right else sqlite3.SQLITE_DENY


def _check_defined(connection: sqlite3.Connection) -> None:
    """Refuse computed tables of tiles and metadata that depend on other computed tables.

    SQLite expands views before it checks any limit: a chain of thirty views, each naming the previous view twice, fills
    all memory.
    """
    defined = [
        (str(kind), str(name), str(sql or ""))
        for kind, name, sql in connection.execute(
            "SELECT type, name, substr(sql, 1, ?) FROM sqlite_master WHERE type IN ('table', 'view')",
            (MAX_VIEW_CHARACTERS + 1,),
        )
    ]
    # Matches tables with computed columns, and virtual tables.
    is_computed = re.compile(r"\bas\b\s*(?:\(|/\*|--)|\bvirtual\b", re.IGNORECASE)
    # Matches quoted text, quoted names and comments.
    quoted = r"'[^']*'|\"[^\"]*\"|`[^`]*`|\[[^\]]*\]|--[^\n]*|/\*.*?(?:\*/|\Z)"
    computed = {
        name
        for kind, name, sql in defined
        if kind == "view" or len(sql) > MAX_VIEW_CHARACTERS or is_computed.search(sql)
    }
    for kind, name, sql in defined:
        if name.lower() not in ("metadata", "tiles") or name not in computed:
            continue
        words = re.sub(quoted, " ", sql, flags=re.DOTALL).lower()
        selects, unions = (len(re.findall(rf"\b{word}\b", words)) for word in ("select", "union"))
        if (
            kind != "view"
            or len(sql) > MAX_VIEW_CHARACTERS
            or selects != unions + 1
            or any(_may_name(sql, other) for other in computed - {name})
        ):
            raise InvalidInput(
                "{0} is computed; must be a table, or a view that reads tables alone, of {1:,} characters at most",
                name,
                MAX_VIEW_CHARACTERS,
            )


def _may_name(sql: str, name: str) -> bool:
    """Whether a definition may name a table; True for every name that can be spelled in several ways."""
    if re.fullmatch(r"\w+", name) is None:
        return True
    return re.search(rf"(?<!\w){name}(?!\w)", sql, re.IGNORECASE) is not None


def _first_look(connection: sqlite3.Connection) -> tuple[dict[str, str], bytes, tuple[Any, Any]]:
    """Return the metadata, and some tile (empty if there are none) with its zoom and row."""
    found = connection.execute(
        "SELECT name, substr(value, 1, ?) FROM metadata WHERE name IN ('name', 'attribution', 'date', 'license', "
        "'licence', 'format', 'bounds', 'minzoom', 'maxzoom', 'scheme') LIMIT 100",
        (MAX_METADATA_CHARACTERS,),
    )
    rows = {str(name): str(value) for name, value in found}
    tile = connection.execute(
        "SELECT CASE WHEN length(tile_data) <= ? THEN tile_data END, zoom_level, tile_row FROM tiles LIMIT 1",
        (MAX_STORED_TILE_BYTES,),
    ).fetchone()
    body = tile[0] if tile else b""
    return rows, body if isinstance(body, bytes) else b"", tile[1:] if tile else (0, 0)


def _is_from_north(rows: Mapping[str, str], zoom: Any, row: Any) -> bool:
    """Whether rows count from the north, by the scheme in the metadata, unless the bounds there contradict it.

    Parameters
    ----------
    zoom, row : object
        Zoom and row of some tile, as stored.
    """
    if rows.get("scheme", "").strip().lower() != "xyz":
        return False
    bounds = _bounds(rows.get("bounds", ""))
    if bounds is None or not (isinstance(zoom, int) and 0 <= zoom <= HIGHEST_ZOOM and isinstance(row, int)):
        return True
    # Some programs copy the scheme of the tiles' source, but store rows from the south.
    _, south, _, north = bounds

    def meets(row_from_north: int) -> bool:
        top_deg, bottom_deg = v_to_lat(np.array([row_from_north, row_from_north + 1]) / (1 << zoom)).tolist()
        return bool(bottom_deg < north and top_deg > south)

    return meets(row) or not meets((1 << zoom) - 1 - row)


def _extent(bounds: str) -> tuple[tuple[float, float], ...] | None:
    """Corners of the bounds in the metadata; None if invalid."""
    edges = _bounds(bounds)
    return None if edges is None else extent_of_box(*edges)


def _bounds(bounds: str) -> tuple[float, float, float, float] | None:
    """West, south, east and north from the metadata; None if invalid."""
    try:
        west, south, east, north = (real_number(part) for part in bounds.split(","))
    except ValueError:
        return None
    sound = -180.0 <= west <= 180.0 and -180.0 <= east <= 180.0 and west != east and -90.0 <= south < north <= 90.0
    return (west, south, east, north) if sound else None


def _grid(connection: sqlite3.Connection, rows: Mapping[str, str], sample: bytes) -> PixelGrid:
    if not sample:
        raise InvalidInput("holds no tiles")
    # Vector tiles are compressed with gzip.
    if rows.get("format") == "pbf" or sample.startswith(b"\x1f\x8b"):
        raise InvalidInput("holds vector tiles (pbf); must hold images (png, jpg or webp)")
    lowest, highest = _zooms(connection, rows)
    return PixelGrid(_tile_px(sample), lowest, highest, highest, extent=_extent(rows.get("bounds", "")))


def _zooms(connection: sqlite3.Connection, rows: Mapping[str, str]) -> tuple[int, int]:
    """Lowest and highest zoom, from the metadata if valid, otherwise from the tiles."""
    lowest, highest = (whole_number(rows.get(name, "")) for name in ("minzoom", "maxzoom"))
    if lowest is not None and highest is not None and lowest <= highest <= HIGHEST_ZOOM:
        return lowest, highest
    # Use two subqueries, as SQLite answers each by an index.
    found: Any = connection.execute(
        "SELECT (SELECT min(zoom_level) FROM tiles), (SELECT max(zoom_level) FROM tiles)"
    ).fetchone()
    if not all(isinstance(zoom, int) for zoom in found):
        raise InvalidInput("its tiles are of zooms {0!r} to {1!r}; must be whole numbers", found[0], found[1])
    return int(found[0]), int(found[1])


def _tile_px(sample: bytes) -> int:
    """Width of a picture, from its header."""
    try:
        width_px, height_px = picture_size(sample)
    except PartError as reason:
        raise InvalidInput("its tiles are no images ({0}); must be png, jpg or webp", reason) from None
    if width_px != height_px or width_px > MAX_TILE_PX:
        raise InvalidInput(
            "its tiles are of {0}x{1} px; must be square, of {2} px at most", width_px, height_px, MAX_TILE_PX
        )
    return width_px
