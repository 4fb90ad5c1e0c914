"""The tiles of one file of the cache, between a source and its server: what is asked for, kept, and used again."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Mapping
from http import HTTPStatus
from itertools import islice
from typing import Callable

from ...arrays import PixelValues
from ...errors import PartError
from ..http.client import NotThere, OutOfReach
from ..http.transport import Response
from ..source import Tile
from .freshness import Freshness, freshness
from .tilefile import BATCH_TILES, FILE_ERRORS, BrokenTileError, Kept, TileFile, fault

#: Seconds that tiles wait to be written together: what a killed run may lose.
FLUSH_S = 1.0
#: Bytes waiting that are written without waiting longer.
_FLUSH_BYTES = 4 << 20
#: Bytes waiting beyond which no more are stored, where the disk is slower than the network or locked by another.
_MOST_WAITING_BYTES = 64 << 20
#: When a tile was last used is noted to the hour: finer would have every warm run rewrite every row.
USED_STEP_S = 3600
#: Files set aside in one run until the disk counts as broken.
_MOST_SET_ASIDE = 3
#: Times another program may have held the file when tiles were to be written, one after the other.
_MOST_BUSY = 10

_log = logging.getLogger(__name__)

#: Turns body and headers into pixels, or raises PartError.
Read = Callable[[bytes, Mapping[str, str]], PixelValues]
#: Sends a request with these headers; an answer with status 200, or 304 where there were headers, and what the
#: callable reads of it.
Ask = Callable[[Mapping[str, str], Callable[[Response], PixelValues]], tuple[Response, PixelValues]]


class TileStore:
    """Tiles of one source, map type and date, kept from run to run; safe to use from several threads.

    Nothing that goes wrong with the file fails a picture: tiles are asked for as if there were no cache.
    They are written by a thread of its own, a second's worth at a time.

    Parameters
    ----------
    open_file : callable
        Opens the file; called with the file that is of no use any more where there was one, to set it aside.
    written : callable
        Called after tiles were written, to keep the cache within its size.
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

    def fetch(self, tile: Tile, ask: Ask, read: Read, out_of_reach: Callable[[], bool]) -> PixelValues:
        """Pixels of a tile: from the file while they are fresh, else from the server, which may confirm them.

        Parameters
        ----------
        tile : Tile
        ask, read : callable
        out_of_reach : callable
            Whether the server was out of reach a moment ago: then a copy that may be used stale is used unasked.

        Raises
        ------
        PartError, SourceError, Cancelled
            As ``ask`` and ``read`` do.
        """

        def new(response: Response) -> PixelValues:
            return read(response.body, response.headers)

        kept, pixels = self._usable(tile, read)
        if kept is None or pixels is None:
            return self._received(tile, *ask({}, new))
        stored = pixels
        stale_allowed = kept.freshness.stale_allowed
        now_s = self._clock()
        # One that is stored in the future was stored by a clock that was wrong, and so is the time it expires.
        fresh = kept.freshness.is_fresh(now_s) and kept.fetched_s <= now_s
        if fresh or (stale_allowed and out_of_reach()):
            self._note_use(tile, kept)
            return stored
        try:
            response, pixels = ask(
                kept.freshness.conditions(),
                lambda response: stored if response.status == HTTPStatus.NOT_MODIFIED else new(response),
            )
        except OutOfReach:
            if not stale_allowed:
                raise
            self._note_use(tile, kept)
            return stored
        except NotThere:
            self._change(tile, None)
            raise
        if response.status != HTTPStatus.NOT_MODIFIED:
            return self._received(tile, response, pixels)
        self._keep(tile, kept.body, kept.freshness.renewed(response.headers, self._clock()))
        return stored

    def flush(self) -> None:
        """Write what is waiting; where another program holds the file, it goes on waiting."""
        with self._flushing:
            with self._lock:
                file, changes, used = self._file, dict(self._changes), dict(self._used)
            if file is None or not (changes or used):
                return
            try:
                left = iter(changes.items())
                while batch := dict(islice(left, BATCH_TILES)):
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
        """Write what is waiting and close the file; from here on nothing is found nor kept."""
        with self._lock:
            self._closed = True
            writer = self._writer
        self._hurry.set()
        if writer is not None:
            writer.join()
        before = self._file
        self.flush()
        if self._file is not before:
            # Its damage showed now, and there is a new one.
            self.flush()
        with self._lock:
            file, self._file = self._file, None
            self._changes, self._used = {}, {}
        if file is not None:
            file.close()

    def _usable(self, tile: Tile, read: Read) -> tuple[Kept | None, PixelValues | None]:
        """Return the stored tile and its pixels; what is broken is dropped."""
        kept = self._stored(tile)
        if kept is None:
            return None, None
        try:
            return kept, read(kept.body, {})
        except PartError:
            self._change(tile, None)
            return None, None

    def _stored(self, tile: Tile) -> Kept | None:
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
            self._change(tile, None)
        except FILE_ERRORS as wrong:
            self._failed(wrong, file)
        return None

    def _received(self, tile: Tile, response: Response, pixels: PixelValues) -> PixelValues:
        """Keep an answer that has shown to be a picture, and return its pixels."""
        self._keep(tile, response.body, freshness(response.headers, self._clock()))
        return pixels

    def _keep(self, tile: Tile, body: bytes, fresh: Freshness | None) -> None:
        now_s = int(self._clock())
        self._change(tile, None if fresh is None else Kept(body, fresh, now_s, now_s))

    def _note_use(self, tile: Tile, kept: Kept) -> None:
        now_s = int(self._clock())
        if now_s - kept.used_s >= USED_STEP_S:
            with self._lock:
                if self._storing():
                    self._used[tile] = now_s
                    self._start_writer()

    def _change(self, tile: Tile, kept: Kept | None) -> None:
        size = 0 if kept is None else len(kept.body)
        with self._lock:
            if not self._storing() or self._waiting_bytes + size > _MOST_WAITING_BYTES:
                return
            self._changes[tile] = kept
            self._waiting_bytes += size
            self._start_writer()
            if self._waiting_bytes > _FLUSH_BYTES:
                self._hurry.set()

    def _storing(self) -> bool:
        return self._writable and not self._closed and self._file is not None

    def _start_writer(self) -> None:
        if self._writer is None:
            self._hurry.clear()
            # No daemon: at the end of the program it has a second's worth of tiles to write, and ends.
            self._writer = threading.Thread(target=self._write_behind, name="terrainav-cache", daemon=False)
            self._writer.start()

    def _write_behind(self) -> None:
        """Write each second for as long as there is something to write."""
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
                # What came for the same tile in the meantime stays.
                if tile in self._changes and self._changes[tile] is kept:
                    del self._changes[tile]
            self._waiting_bytes = sum(len(kept.body) for kept in self._changes.values() if kept is not None)

    def _failed(self, wrong: Exception, file: TileFile, *, writing: bool = False) -> None:
        kind = fault(wrong)
        with self._lock:
            # Several threads may come upon the same damage.
            if kind == "corrupt" and self._file is file:
                self._open(file)
            elif kind == "unwritable":
                self._stop_storing(f"cache {file.path}: {wrong}; nothing more is stored in this run")
            elif kind == "busy" and writing:
                self._busy += 1
                if self._busy > _MOST_BUSY:
                    self._stop_storing(f"cache {file.path}: another program holds it; nothing more is stored")

    def _open(self, broken: TileFile | None) -> None:
        """Open the file, or the one that takes the place of a broken one; the lock is held by the caller."""
        self._file = None
        try:
            if broken is not None:
                self._set_aside += 1
                broken.close()
            if self._set_aside <= _MOST_SET_ASIDE:
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
