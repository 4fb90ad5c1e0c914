"""A file of cached tiles: MBTiles 1.3, with what HTTP says of each tile in a table beside them."""

from __future__ import annotations

import os
import sqlite3
import threading
import time
import zlib
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote

import numpy as np

from ...geodesy.mercator import u_to_lon, v_to_lat
from ..source import Tile
from .freshness import Freshness

#: Seconds a reader waits for another program's lock: cancelling must not take longer than half a second.
READ_WAIT_S = 0.25
#: Seconds a writer does, which holds no capture up but at its end.
WRITE_WAIT_S = 2.0
#: Tiles in one transaction, so that other captures wait for a few hundredths of a second only.
BATCH_TILES = 500
#: Pages given back to the file system in one transaction.
_VACUUM_PAGES = 2000
_RETRY_S = 0.02
#: "MPBX": what the MBTiles specification has the file's header say.
_APPLICATION_ID = 0x4D504258
_SCHEMA = """
CREATE TABLE IF NOT EXISTS metadata (name text, value text);
CREATE UNIQUE INDEX IF NOT EXISTS metadata_name ON metadata (name);
CREATE TABLE IF NOT EXISTS tiles (zoom_level integer, tile_column integer, tile_row integer, tile_data blob);
CREATE UNIQUE INDEX IF NOT EXISTS tile_index ON tiles (zoom_level, tile_column, tile_row);
CREATE TABLE IF NOT EXISTS freshness (
    zoom_level integer, tile_column integer, tile_row integer, seal integer NOT NULL, expires_s integer NOT NULL,
    lifetime_s integer NOT NULL, stale_allowed integer NOT NULL, etag text NOT NULL, last_modified text NOT NULL,
    fetched_s integer NOT NULL, used_s integer NOT NULL, PRIMARY KEY (zoom_level, tile_column, tile_row)
) WITHOUT ROWID;
CREATE INDEX IF NOT EXISTS freshness_used ON freshness (used_s)
"""
_SELECT = (
    "SELECT tile_data, seal, expires_s, lifetime_s, stale_allowed, etag, last_modified, fetched_s, used_s "
    "FROM tiles JOIN freshness USING (zoom_level, tile_column, tile_row) "
    "WHERE zoom_level = ? AND tile_column = ? AND tile_row = ?"
)
_NOTE_USE = "UPDATE freshness SET used_s = ? WHERE zoom_level = ? AND tile_column = ? AND tile_row = ?"
_DELETE_TILE = "DELETE FROM tiles WHERE zoom_level = ? AND tile_column = ? AND tile_row = ?"
_DELETE_FRESHNESS = "DELETE FROM freshness WHERE zoom_level = ? AND tile_column = ? AND tile_row = ?"
_FORMATS = ((b"\x89PNG", "png"), (b"\xff\xd8\xff", "jpg"), (b"RIFF", "webp"), (b"GIF8", "image/gif"))


#: What reading a file may raise whose bytes anybody may have written: what is wrong with it is said in its own words,
#: which need not be UTF-8.
FILE_ERRORS = (sqlite3.Error, ValueError, TypeError, OverflowError, MemoryError)


class About(NamedTuple):
    """What a file of tiles is of."""

    source: str
    title: str
    attribution: str
    map_type: str
    date: str
    tile_px: int

    @property
    def metadata(self) -> dict[str, str]:
        """Rows of the metadata table that do not depend on the tiles."""
        return {
            "name": " ".join(filter(None, (self.title, self.map_type, self.date))),
            "type": "baselayer",
            "version": "1",
            "attribution": self.attribution,
            "source": self.source,
            "title": self.title,
            "map_type": self.map_type,
            "date": self.date,
            "tile_px": str(self.tile_px),
        }


class Kept(NamedTuple):
    """A tile as it is stored."""

    body: bytes
    freshness: Freshness
    fetched_s: int
    used_s: int

    def seal(self, tile: Tile) -> int:
        """Checksum over picture, place and freshness: JPEG files have none, and one byte may be wrong anywhere."""
        return zlib.crc32(repr((*tile, *self.freshness)).encode(), zlib.crc32(self.body))


class BrokenTileError(Exception):
    """A stored tile is not what was written."""


def fault(error: Exception) -> str:
    """Say what an error of SQLite means: ``busy``, ``unwritable`` or ``corrupt``.

    By its words, because Python before 3.11 does not tell SQLite's error codes.
    """
    words = str(error)
    if "locked" in words or "schema has changed" in words:
        return "busy"
    if any(sign in words for sign in ("full", "disk I/O", "readonly", "unable to open", "too big")):
        return "unwritable"
    return "corrupt"


def database_uri(path: Path, mode: str) -> str:
    """Address of a database file, whatever characters its name has; ``mode`` as in SQLite's URIs."""
    shown = quote(path.absolute().as_posix())
    return f"file://{'' if shown.startswith('/') else '/'}{shown}?{mode}"


def connect(path: Path, mode: str = "mode=rw", wait_s: float = WRITE_WAIT_S) -> sqlite3.Connection:
    """Open a database for use by any thread, one at a time; transactions are begun and ended by hand."""
    connection = sqlite3.connect(
        database_uri(path, mode), uri=True, timeout=wait_s, isolation_level=None, check_same_thread=False
    )
    connection.execute("PRAGMA cell_size_check = ON")
    return connection


@contextmanager
def transaction(connection: sqlite3.Connection) -> Iterator[None]:
    """Write all or nothing."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        yield
        connection.execute("COMMIT")
    except BaseException:
        if connection.in_transaction:
            connection.execute("ROLLBACK")
        raise


class TileFile:
    """An open file of tiles; safe to use from several threads and processes.

    Reading and writing have a connection each: in WAL mode neither waits for the other.

    Parameters
    ----------
    path : Path
        Made if it is not there.
    about : About

    Raises
    ------
    sqlite3.Error
        As all methods do; `fault` tells which kind.
    """

    def __init__(self, path: Path, about: About) -> None:
        self.path = path
        self._reading, self._writing = threading.Lock(), threading.Lock()
        self._writer = _create(path, about)
        try:
            self._reader = connect(path, wait_s=READ_WAIT_S)
        except FILE_ERRORS:
            self._writer.close()
            raise

    def read(self, tile: Tile) -> Kept | None:
        """Return a tile, None where it is not there.

        Raises
        ------
        BrokenTileError
        """
        with self._reading:
            rows = self._reader.execute(_SELECT, _row(tile)).fetchall()
        if not rows:
            return None
        body, seal, expires_s, lifetime_s, stale_allowed, etag, last_modified, fetched_s, used_s = rows[0]
        if not isinstance(body, bytes):
            raise BrokenTileError
        freshness = Freshness(expires_s, lifetime_s, bool(stale_allowed), etag, last_modified)
        kept = Kept(body, freshness, fetched_s, used_s)
        if seal != kept.seal(tile):
            raise BrokenTileError
        return kept

    def write(self, changes: Mapping[Tile, Kept | None], used: Mapping[Tile, int]) -> None:
        """Write tiles, remove those that are None, note when others were used last."""
        with self._writing, transaction(self._writer):
            for tile, kept in changes.items():
                if kept is None:
                    delete(self._writer, [_row(tile)])
                else:
                    self._put(tile, kept)
            self._writer.executemany(_NOTE_USE, [(used_s, *_row(tile)) for tile, used_s in used.items()])
            written = {tile: kept.body for tile, kept in changes.items() if kept is not None}
            if written:
                _describe(self._writer, written)

    def close(self) -> None:
        """Close both connections; what other threads are doing with them ends first."""
        with self._reading:
            self._reader.close()
        with self._writing:
            self._writer.close()

    def _put(self, tile: Tile, kept: Kept) -> None:
        self._writer.execute(
            "INSERT OR REPLACE INTO tiles (zoom_level, tile_column, tile_row, tile_data) VALUES (?, ?, ?, ?)",
            (*_row(tile), kept.body),
        )
        self._writer.execute(
            "INSERT OR REPLACE INTO freshness VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
            (*_row(tile), kept.seal(tile), *kept.freshness, kept.fetched_s, kept.used_s),
        )


def delete(connection: sqlite3.Connection, rows: list[tuple[int, int, int]]) -> None:
    """Remove tiles by zoom, column and row of the file."""
    connection.executemany(_DELETE_TILE, rows)
    connection.executemany(_DELETE_FRESHNESS, rows)


def live_bytes(connection: sqlite3.Connection) -> int:
    """Bytes of a file but for its free pages."""
    pages, free, size = (
        connection.execute(f"PRAGMA {name}").fetchone()[0]
        for name in ("page_count", "freelist_count", "page_size")
    )
    return int((pages - free) * size)


def shrink(connection: sqlite3.Connection, until_s: float) -> None:
    """Give free pages back to the file system, for as long as `time.monotonic` is before ``until_s``."""
    while connection.execute("PRAGMA freelist_count").fetchone()[0] and time.monotonic() < until_s:
        connection.execute(f"PRAGMA incremental_vacuum({_VACUUM_PAGES})").fetchall()
    # Says busy, and does what it can, where others are reading.
    connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchall()


def _row(tile: Tile) -> tuple[int, int, int]:
    """Zoom, column and row as MBTiles counts them: from the south (TMS)."""
    return tile.zoom, tile.x, (1 << tile.zoom) - 1 - tile.y


def _create(path: Path, about: About) -> sqlite3.Connection:
    """Open a file for writing, made and described where it is new."""
    until_s = time.monotonic() + WRITE_WAIT_S
    while True:
        connection = connect(path, "mode=rwc")
        try:
            _prepare(connection, about)
            # Another process may have removed the file between its opening and the first lock.
            if path.exists():
                return connection
        except FILE_ERRORS as wrong:
            # SQLite does not wait for the lock that the switch to WAL needs.
            if fault(wrong) != "busy" or time.monotonic() > until_s:
                connection.close()
                raise
        connection.close()
        time.sleep(_RETRY_S)


def _prepare(connection: sqlite3.Connection, about: About) -> None:
    if connection.execute("PRAGMA page_count").fetchone()[0] == 0:
        # Before anything else is in the file: it cannot be changed later.
        connection.execute("PRAGMA auto_vacuum = INCREMENTAL")
    connection.execute("PRAGMA journal_mode = WAL").fetchall()
    # After a loss of power the last transactions may be missing; the file stays whole.
    connection.execute("PRAGMA synchronous = NORMAL")
    if connection.execute("PRAGMA application_id").fetchone()[0] != _APPLICATION_ID:
        with transaction(connection):
            connection.execute(f"PRAGMA application_id = {_APPLICATION_ID}")
            for statement in _SCHEMA.split(";"):
                connection.execute(statement)
    wanted = about.metadata
    if wanted.items() - dict(connection.execute("SELECT name, value FROM metadata").fetchall()).items():
        with transaction(connection):
            _set_metadata(connection, wanted)


def _set_metadata(connection: sqlite3.Connection, rows: Mapping[str, str]) -> None:
    connection.executemany("INSERT OR REPLACE INTO metadata (name, value) VALUES (?, ?)", rows.items())


def _describe(connection: sqlite3.Connection, written: Mapping[Tile, bytes]) -> None:
    """Widen format, zooms and bounds of the metadata to tiles that were just written."""
    known = dict(connection.execute("SELECT name, value FROM metadata").fetchall())
    zooms = [tile.zoom for tile in written] + [
        int(known[name]) for name in ("minzoom", "maxzoom") if name in known
    ]
    bounds = _bounds(written)
    if "bounds" in known:
        before = np.array([float(value) for value in known["bounds"].split(",")])
        bounds = np.concatenate([np.minimum(before, bounds)[:2], np.maximum(before, bounds)[2:]])
    body = next(iter(written.values()))
    new = {
        "format": known.get("format")
        or next((name for magic, name in _FORMATS if body[:4].startswith(magic)), "png"),
        "minzoom": str(min(zooms)),
        "maxzoom": str(max(zooms)),
        "bounds": ",".join(f"{value:.9f}" for value in bounds),
    }
    if new.items() - known.items():
        _set_metadata(connection, new)


def _bounds(tiles: Mapping[Tile, bytes]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """West, south, east, north of tiles together, degrees."""
    zoom, x, y = np.array(list(tiles), np.float64).T
    columns, rows = np.concatenate([x, x + 1.0]), np.concatenate([y, y + 1.0])
    world = np.tile(np.exp2(zoom), 2)
    lon_deg, lat_deg = u_to_lon(columns / world), v_to_lat(rows / world)
    return np.array([lon_deg.min(), lat_deg.min(), lon_deg.max(), lat_deg.max()])


def metadata(path: Path) -> tuple[dict[str, str], int]:
    """Metadata of a file of tiles, and how many tiles it has."""
    with closing(connect(path)) as connection:
        rows = connection.execute("SELECT name, value FROM metadata").fetchall()
        (count,) = connection.execute("SELECT count(*) FROM freshness").fetchone()
    return dict(rows), int(count)


def remove(path: Path) -> bool:
    """Remove a file unless another program has it open; whether it is gone."""
    with closing(connect(path, wait_s=READ_WAIT_S)) as connection:
        try:
            connection.execute("PRAGMA locking_mode = EXCLUSIVE").fetchall()
            # Merges the log and needs the file for itself; a file out of WAL mode has no companions left.
            connection.execute("PRAGMA journal_mode = DELETE").fetchall()
            connection.execute("BEGIN EXCLUSIVE")
        except sqlite3.OperationalError:
            return False
        try:
            os.unlink(path)  # noqa: PTH108
        except OSError:
            return False  # Windows keeps open files
    return True


def empty(path: Path, until_s: float) -> None:
    """Remove all tiles of a file that others may have open; pages are given back until ``until_s``, as in `shrink`."""
    with closing(connect(path)) as connection:
        with transaction(connection):
            connection.execute("DELETE FROM tiles")
            connection.execute("DELETE FROM freshness")
            connection.execute(
                "DELETE FROM metadata WHERE name IN ('format', 'bounds', 'minzoom', 'maxzoom')"
            )
        shrink(connection, until_s)
