"""Cached tiles of one source, map type and date: read from a file, and written to it by a thread."""

from __future__ import annotations

import logging
import threading
import time
import zlib
from collections.abc import Mapping
from itertools import islice
from pathlib import Path
from typing import Callable, NamedTuple

from ..http.transport import Freshness, Response, freshness
from ..tiles import Tile
from .database import (
    BATCH_TILES,
    FILE_ERRORS,
    READ_WAIT_S,
    About,
    connect,
    create,
    delete,
    describe,
    fault,
    transaction,
)

#: Longest time that tiles wait to be written together, seconds; a killed run may lose the tiles of this time.
FLUSH_S = 1.0

_log = logging.getLogger(__name__)


class Kept(NamedTuple):
    """A stored tile."""

    body: bytes
    freshness: Freshness
    fetched_s: int
    used_s: int

    def seal(self, tile: Tile) -> int:
        """Checksum of file, tile address and freshness, as JPEG has no checksum and any byte may be damaged."""
        return zlib.crc32(repr((*tile, *self.freshness)).encode(), zlib.crc32(self.body))


class BrokenTileError(Exception):
    """A stored tile differs from what was written."""


class TileFile:
    """An open file of tiles; safe to use from several threads and processes.

    There is one connection for reading and one for writing: in WAL mode neither waits for the other.

    Parameters
    ----------
    path : Path
        Created if it does not exist.
    about : About

    Raises
    ------
    sqlite3.Error
        From all methods; see `fault`.
    """

    def __init__(self, path: Path, about: About) -> None:
        self.path = path
        self._reading, self._writing = threading.Lock(), threading.Lock()
        self._writer = create(path, about)
        try:
            self._reader = connect(path, wait_s=READ_WAIT_S)
        except FILE_ERRORS:
            self._writer.close()
            raise

    def read(self, tile: Tile) -> Kept | None:
        """Return a stored tile, or None.

        Raises
        ------
        BrokenTileError
        """
        with self._reading:
            rows = self._reader.execute(
                "SELECT tile_data, seal, expires_s, lifetime_s, stale_allowed, etag, last_modified, fetched_s, "
                "used_s FROM tiles JOIN freshness USING (zoom_level, tile_column, tile_row) "
                "WHERE zoom_level = ? AND tile_column = ? AND tile_row = ?",
                tile.tms,
            ).fetchall()
        if not rows:
            return None
        body, seal, expires_s, lifetime_s, stale_allowed, etag, last_modified, fetched_s, used_s = rows[0]
        if not isinstance(body, bytes):
            raise BrokenTileError
        fresh = Freshness(expires_s, lifetime_s, bool(stale_allowed), etag, last_modified)
        kept = Kept(body, fresh, fetched_s, used_s)
        if seal != kept.seal(tile):
            raise BrokenTileError
        return kept

    def write(self, changes: Mapping[Tile, Kept | None], used: Mapping[Tile, int]) -> None:
        """Write the changed tiles, remove tiles whose change is None, and note the times of use of other tiles."""
        with self._writing, transaction(self._writer):
            for tile, kept in changes.items():
                if kept is None:
                    delete(self._writer, [tile.tms])
                else:
                    self._put(tile, kept)
            self._writer.executemany(
                "UPDATE freshness SET used_s = ? WHERE zoom_level = ? AND tile_column = ? AND tile_row = ?",
                [(used_s, *tile.tms) for tile, used_s in used.items()],
            )
            written = {tile: kept.body for tile, kept in changes.items() if kept is not None}
            if written:
                describe(self._writer, written)

    def close(self) -> None:
        """Close both connections, once other threads have finished with them."""
        with self._reading:
            self._reader.close()
        with self._writing:
            self._writer.close()

    def _put(self, tile: Tile, kept: Kept) -> None:
        self._writer.execute(
            "INSERT OR REPLACE INTO tiles (zoom_level, tile_column, tile_row, tile_data) VALUES (?, ?, ?, ?)",
            (*tile.tms, kept.body),
        )
        self._writer.execute(
            "INSERT OR REPLACE INTO freshness VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
            (*tile.tms, kept.seal(tile), *kept.freshness, kept.fetched_s, kept.used_s),
        )


class NoStore:
    """The store of a source whose tiles are not kept."""

    def find(self, tile: Tile) -> Kept | None:  # noqa: ARG002
        """Return nothing."""
        return None

    def is_fresh(self, kept: Kept) -> bool:  # noqa: ARG002
        """Return False."""
        return False

    def keep(self, tile: Tile, response: Response) -> None:
        """Store nothing."""

    def renew(self, tile: Tile, kept: Kept, headers: Mapping[str, str]) -> None:
        """Store nothing."""

    def note_use(self, tile: Tile, kept: Kept) -> None:
        """Note nothing."""

    def remove(self, tile: Tile) -> None:
        """Remove nothing."""

    def close(self) -> None:
        """Close nothing."""


class TileStore(NoStore):
    """Tiles of one source, map type and date, kept from run to run; safe to use from several threads.

    Errors of the file never fail a picture: without the file, no tile is found or kept. A thread writes new tiles once
    a second.

    Parameters
    ----------
    open_file : callable
        Opens the file; its argument is a damaged file to set aside first, or None.
    written : callable
        Called after tiles were written, to keep the cache within its limit.
    clock : callable
        Seconds since 1970.
    """

    def __init__(
        self,
        open_file: Callable[[TileFile | None], TileFile],
        written: Callable[[], None],
        clock: Callable[[], float] = time.time,
    ) -> None:
        self._open_file, self._written, self._clock = open_file, written, clock
        self._lock = threading.Lock()
        self._flushing = threading.Lock()
        self._hurry = threading.Event()
        self._changes: dict[Tile, Kept | None] = {}
        self._used: dict[Tile, int] = {}
        self._waiting_bytes = 0
        self._writer: threading.Thread | None = None
        self._writable = True
        self._closed = False
        self._set_aside = self._busy = 0
        self._file: TileFile | None = None
        self._open(None)

    def find(self, tile: Tile) -> Kept | None:
        """Stored tile, or None; a broken one is removed."""
        with self._lock:
            if self._closed:
                return None
            if tile in self._changes:
                return self._changes[tile]
            file = self._file
        if file is None:
            return None
        try:
            return file.read(tile)
        except BrokenTileError:
            self.remove(tile)
        except FILE_ERRORS as wrong:
            self._failed(wrong, file)
        return None

    def is_fresh(self, kept: Kept) -> bool:
        """Whether a stored tile may be used without a request."""
        now_s = self._clock()
        # A tile stored in the future comes from a wrong clock, so its expiry is wrong, too.
        return kept.freshness.is_fresh(now_s) and kept.fetched_s <= now_s

    def keep(self, tile: Tile, response: Response) -> None:
        """Store an answer that was decoded, if it may be stored."""
        self._keep(tile, response.body, freshness(response.headers, self._clock()))

    def renew(self, tile: Tile, kept: Kept, headers: Mapping[str, str]) -> None:
        """Store a tile again that the server has confirmed (304)."""
        self._keep(tile, kept.body, kept.freshness.renewed(headers, self._clock()))

    def note_use(self, tile: Tile, kept: Kept) -> None:
        """Note that a tile was used, at most once an hour, so that not every run writes every row again."""
        now_s = int(self._clock())
        if now_s - kept.used_s >= 3600:
            with self._lock:
                if self._storing():
                    self._used[tile] = now_s
                    self._start_writer()

    def remove(self, tile: Tile) -> None:
        """Remove a tile."""
        self._change(tile, None)

    def flush(self) -> None:
        """Write waiting tiles; they go on waiting while another program has the file locked."""
        with self._flushing:
            with self._lock:
                file, changes, used = self._file, dict(self._changes), dict(self._used)
            if file is None or not (changes or used):
                return
            try:
                remaining = iter(changes.items())
                while batch := dict(islice(remaining, BATCH_TILES)):
                    file.write(batch, {})
                    self._done(batch)
                file.write({}, used)
            except FILE_ERRORS as wrong:
                self._failed(wrong, file, writing=True)
                return
            with self._lock:
                self._busy = 0
                self._used = {tile: at for tile, at in self._used.items() if used.get(tile) != at}
        self._written()

    def close(self) -> None:
        """Write waiting tiles and close the file; after that, no tile is found or kept."""
        with self._lock:
            self._closed = True
            writer = self._writer
        self._hurry.set()
        if writer is not None:
            writer.join()
        first_file = self._file
        self.flush()
        if self._file is not first_file:
            # Writing found damage and opened another file.
            self.flush()
        with self._lock:
            file, self._file = self._file, None
            self._changes, self._used = {}, {}
        if file is not None:
            file.close()

    def _keep(self, tile: Tile, body: bytes, fresh: Freshness | None) -> None:
        now_s = int(self._clock())
        self._change(tile, None if fresh is None else Kept(body, fresh, now_s, now_s))

    def _change(self, tile: Tile, kept: Kept | None) -> None:
        size = 0 if kept is None else len(kept.body)
        with self._lock:
            # Store no more if the disk is slower than the network, or the file is locked.
            if not self._storing() or self._waiting_bytes + size > 64 << 20:
                return
            self._changes[tile] = kept
            self._waiting_bytes += size
            self._start_writer()
            if self._waiting_bytes > 4 << 20:
                self._hurry.set()

    def _storing(self) -> bool:
        return self._writable and not self._closed and self._file is not None

    def _start_writer(self) -> None:
        if self._writer is None:
            self._hurry.clear()
            # Not a daemon, so that the program ends after the last tiles are written.
            self._writer = threading.Thread(target=self._write_behind, name="terrainav-cache", daemon=False)
            self._writer.start()

    def _write_behind(self) -> None:
        """Write every second while tiles wait."""
        while True:
            self._hurry.wait(FLUSH_S)
            self._hurry.clear()
            self.flush()
            with self._lock:
                if self._closed or not (self._changes or self._used):
                    self._writer = None
                    return

    def _done(self, batch: Mapping[Tile, Kept | None]) -> None:
        with self._lock:
            for tile, kept in batch.items():
                # A tile that was stored again in the meantime still waits.
                if tile in self._changes and self._changes[tile] is kept:
                    del self._changes[tile]
            self._waiting_bytes = sum(len(kept.body) for kept in self._changes.values() if kept is not None)

    def _failed(self, wrong: Exception, file: TileFile, *, writing: bool = False) -> None:
        kind = fault(wrong)
        with self._lock:
            # Several threads may meet the same damage.
            if kind == "corrupt" and self._file is file:
                self._open(file)
            elif kind == "unwritable":
                self._stop_storing(f"cache {file.path}: {wrong}; nothing more is stored in this run")
            elif kind == "busy" and writing:
                self._busy += 1
                if self._busy > 10:
                    self._stop_storing(f"cache {file.path}: another program holds it; nothing more is stored")

    def _open(self, broken: TileFile | None) -> None:
        """Open the file, or another in place of a damaged file; the caller holds the lock."""
        self._file = None
        try:
            if broken is not None:
                self._set_aside += 1
                broken.close()
            # With the fourth damaged file in one run, the disk counts as broken.
            if self._set_aside <= 3:
                self._file = self._open_file(broken)
        except (*FILE_ERRORS, OSError) as wrong:
            self._stop_storing(f"cache: {wrong}; this run goes without it")
        else:
            if self._file is None:
                self._stop_storing("cache: file after file is damaged; this run goes without it")

    def _stop_storing(self, why: str) -> None:
        if self._writable:
            _log.warning("%s", why)
        self._writable = False
        self._changes, self._used, self._waiting_bytes = {}, {}, 0
