"""SQLite databases of cached tiles: MBTiles 1.3, and a table with the HTTP freshness of each tile."""

from __future__ import annotations

import os
import sqlite3
import time
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote

import numpy as np

from ...geodesy.mercator import u_to_lon, v_to_lat
from ..tiles import Tile

#: Seconds that a reader waits for another program's lock, as cancelling must take half a second at most.
READ_WAIT_S = 0.25
#: Seconds that a writer waits for the lock; this delays a capture at its end only.
WRITE_WAIT_S = 2.0
#: Tiles in one transaction; other captures wait a few hundredths of a second for such a transaction.
BATCH_TILES = 500
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
#: Errors of reading a file with arbitrary bytes; ValueError because SQLite quotes the file, which may not be UTF-8.
FILE_ERRORS = (sqlite3.Error, ValueError, TypeError, OverflowError, MemoryError)


class About(NamedTuple):
    """Source, style and date of the tiles of a file."""

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


def fault(error: Exception) -> str:
    """Classify an error of SQLite as ``busy``, ``unwritable`` or ``corrupt``.

    By the words of the message, as Python offers SQLite's error codes from 3.11 on only.
    """
    words = str(error)
    if "locked" in words or "schema has changed" in words:
        return "busy"
    if any(sign in words for sign in ("full", "disk I/O", "readonly", "unable to open", "too big")):
        return "unwritable"
    return "corrupt"


def database_uri(path: Path, mode: str) -> str:
    """URI of a database file, with special characters quoted; ``mode`` as in SQLite's URIs."""
    shown = quote(path.absolute().as_posix())
    return f"file://{'' if shown.startswith('/') else '/'}{shown}?{mode}"


def connect(path: Path, mode: str = "mode=rw", wait_s: float = WRITE_WAIT_S) -> sqlite3.Connection:
    """Open a database for use by one thread at a time, with explicit transactions."""
    connection = sqlite3.connect(
        database_uri(path, mode), uri=True, timeout=wait_s, isolation_level=None, check_same_thread=False
    )
    connection.execute("PRAGMA cell_size_check = ON")
    return connection


@contextmanager
def transaction(connection: sqlite3.Connection) -> Iterator[None]:
    """Commit all changes of the block, or none if it raises."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        yield
        connection.execute("COMMIT")
    except BaseException:
        if connection.in_transaction:
            connection.execute("ROLLBACK")
        raise


def delete(connection: sqlite3.Connection, rows: list[tuple[int, int, int]]) -> None:
    """Remove tiles by zoom, column and row of the file."""
    connection.executemany("DELETE FROM tiles WHERE zoom_level = ? AND tile_column = ? AND tile_row = ?", rows)
    connection.executemany("DELETE FROM freshness WHERE zoom_level = ? AND tile_column = ? AND tile_row = ?", rows)


def live_bytes(connection: sqlite3.Connection) -> int:
    """Bytes of a file without its free pages."""
    pages, free, size = (
        connection.execute(f"PRAGMA {name}").fetchone()[0] for name in ("page_count", "freelist_count", "page_size")
    )
    return int((pages - free) * size)


def shrink(connection: sqlite3.Connection, until_s: float) -> None:
    """Return free pages to the file system, until `time.monotonic` reaches ``until_s``."""
    while connection.execute("PRAGMA freelist_count").fetchone()[0] and time.monotonic() < until_s:
        connection.execute("PRAGMA incremental_vacuum(2000)").fetchall()
    # While others are reading, the checkpoint is partial and reports busy.
    connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchall()


def create(path: Path, about: About) -> sqlite3.Connection:
    """Open a file for writing; a new one gets its tables and metadata."""
    until_s = time.monotonic() + WRITE_WAIT_S
    while True:
        connection = connect(path, "mode=rwc")
        try:
            _prepare(connection, about)
            # Another process may have removed the file between its opening and the first lock.
            if path.exists():
                return connection
        except FILE_ERRORS as wrong:
            # SQLite does not wait for the lock needed to switch to WAL, so try again.
            if fault(wrong) != "busy" or time.monotonic() > until_s:
                connection.close()
                raise
        connection.close()
        time.sleep(0.02)


def _prepare(connection: sqlite3.Connection, about: About) -> None:
    if connection.execute("PRAGMA page_count").fetchone()[0] == 0:
        # SQLite accepts this setting for empty files only.
        connection.execute("PRAGMA auto_vacuum = INCREMENTAL")
    connection.execute("PRAGMA journal_mode = WAL").fetchall()
    # A power failure may lose the last transactions but does not corrupt the file.
    connection.execute("PRAGMA synchronous = NORMAL")
    # "MPBX", which the MBTiles specification prescribes for a file's header.
    application_id = 0x4D504258
    if connection.execute("PRAGMA application_id").fetchone()[0] != application_id:
        with transaction(connection):
            connection.execute(f"PRAGMA application_id = {application_id}")
            for statement in _SCHEMA.split(";"):
                connection.execute(statement)
    wanted = about.metadata
    if wanted.items() - dict(connection.execute("SELECT name, value FROM metadata").fetchall()).items():
        with transaction(connection):
            _set_metadata(connection, wanted)


def _set_metadata(connection: sqlite3.Connection, rows: Mapping[str, str]) -> None:
    connection.executemany("INSERT OR REPLACE INTO metadata (name, value) VALUES (?, ?)", rows.items())


def describe(connection: sqlite3.Connection, written: Mapping[Tile, bytes]) -> None:
    """Extend zooms and bounds of the metadata to tiles that were just written; set the format if missing."""
    known = dict(connection.execute("SELECT name, value FROM metadata").fetchall())
    zooms = [tile.zoom for tile in written] + [int(known[name]) for name in ("minzoom", "maxzoom") if name in known]
    bounds = _bounds(written)
    if "bounds" in known:
        known_bounds = np.array([float(value) for value in known["bounds"].split(",")])
        bounds = np.concatenate([np.minimum(known_bounds, bounds)[:2], np.maximum(known_bounds, bounds)[2:]])
    # MBTiles 1.3 names jpg, png and webp; other formats are given as media types.
    formats = ((b"\xff\xd8\xff", "jpg"), (b"RIFF", "webp"), (b"GIF8", "image/gif"))
    body = next(iter(written.values()))
    new = {
        "format": known.get("format") or next((name for magic, name in formats if body.startswith(magic)), "png"),
        "minzoom": str(min(zooms)),
        "maxzoom": str(max(zooms)),
        "bounds": ",".join(f"{value:.9f}" for value in bounds),
    }
    if new.items() - known.items():
        _set_metadata(connection, new)


def _bounds(tiles: Mapping[Tile, bytes]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """West, south, east and north, in degrees, of the extent of all tiles."""
    zoom, x, y = np.array(list(tiles), np.float64).T
    columns, rows = np.concatenate([x, x + 1.0]), np.concatenate([y, y + 1.0])
    world = np.tile(np.exp2(zoom), 2)
    lon_deg, lat_deg = u_to_lon(columns / world), v_to_lat(rows / world)
    return np.array([lon_deg.min(), lat_deg.min(), lon_deg.max(), lat_deg.max()])


def metadata(path: Path) -> tuple[dict[str, str], int]:
    """Return the metadata of a file and the number of tiles in it."""
    with closing(connect(path)) as connection:
        rows = connection.execute("SELECT name, value FROM metadata").fetchall()
        (count,) = connection.execute("SELECT count(*) FROM freshness").fetchone()
    return dict(rows), int(count)


def remove(path: Path) -> bool:
    """Remove a file unless another program has it open; return whether it was removed."""
    with closing(connect(path, wait_s=READ_WAIT_S)) as connection:
        try:
            connection.execute("PRAGMA locking_mode = EXCLUSIVE").fetchall()
            # This needs exclusive access; it merges the log and removes the -wal and -shm files.
            connection.execute("PRAGMA journal_mode = DELETE").fetchall()
            connection.execute("BEGIN EXCLUSIVE")
        except sqlite3.OperationalError:
            return False
        try:
            os.unlink(path)  # noqa: PTH108
        except OSError:
            return False  # Windows refuses while the file is open
    return True


def empty(path: Path, until_s: float) -> None:
    """Remove all tiles of a file that others may have open, then `shrink` the file."""
    with closing(connect(path)) as connection:
        with transaction(connection):
            connection.execute("DELETE FROM tiles")
            connection.execute("DELETE FROM freshness")
            connection.execute("DELETE FROM metadata WHERE name IN ('format', 'bounds', 'minzoom', 'maxzoom')")
        shrink(connection, until_s)
