"""The tile cache: a folder with an MBTiles file for each source, map type, date and tile size."""

from __future__ import annotations

import hashlib
import heapq
import logging
import os
import re
import sqlite3
import sys
import time
import unicodedata
from collections.abc import Iterable, Mapping
from contextlib import closing, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable

from ...errors import InvalidInput, OutputError
from ...text.plain import whole_number
from . import database
from .database import FILE_ERRORS, About
from .tilestore import TileFile, TileStore

FOLDER_ENV = "TERRAINAV_CACHE_DIR"
#: Default limit of all files together, bytes.
LIMIT_BYTES = 4 << 30
#: Longest time that one `TileCache.trim` takes, seconds; the next call continues the work.
_TRIM_S = 1.0
#: File names of the cache: words, a hash, and a number if earlier files of that name were damaged.
_NAME = re.compile(r"(?P<stem>.+-[0-9a-f]{12})(~(?P<number>\d+))?\.mbtiles(?P<corrupt>\.corrupt)?")

_log = logging.getLogger(__name__)


def default_folder() -> Path:
    """Return ``$TERRAINAV_CACHE_DIR``, else ``terrainav`` in the platform's folder for caches."""
    if os.environ.get(FOLDER_ENV):
        return Path(os.environ[FOLDER_ENV])
    if sys.platform == "win32":
        local = os.environ.get("LOCALAPPDATA")
        return (Path(local) if local else Path.home() / "AppData" / "Local") / "terrainav" / "cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "terrainav"
    xdg = os.environ.get("XDG_CACHE_HOME", "")
    # The XDG Base Directory Specification requires relative paths to be ignored.
    return (Path(xdg) if Path(xdg).is_absolute() else Path.home() / ".cache") / "terrainav"


@dataclass(frozen=True)
class CacheFile:
    """A file of the cache.

    Parameters
    ----------
    path : Path
    source : str
        Name of the source, or the host of a template.
    title, map_type, date : str
    tile_px, tiles, bytes : int
    """

    path: Path
    source: str
    title: str
    map_type: str
    date: str
    tile_px: int
    tiles: int
    bytes: int


class TileCache:
    """A folder of tiles, which several captures may use at once, from one program or several.

    Parameters
    ----------
    folder : path or None
        Created when the first store opens; None for `default_folder`.
    limit_bytes : int
        Limit of all files together; the least recently used tiles are removed first.
    clock : callable
        Seconds since 1970.
    """

    def __init__(
        self,
        folder: str | os.PathLike[str] | None = None,
        limit_bytes: int = LIMIT_BYTES,
        clock: Callable[[], float] = time.time,
    ) -> None:
        if limit_bytes < 1:
            raise InvalidInput(
                "cache of {0} bytes: must be 1 or more", limit_bytes, remedy="leave the cache out for none"
            )
        self._given = folder
        self.folder = Path(folder) if folder is not None else default_folder()
        self.limit_bytes = limit_bytes
        self._clock = clock

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the folder as given to the constructor, as the default differs between machines."""
        return TileCache, (self._given, self.limit_bytes, self._clock)

    def store(
        self,
        key: str,
        *,
        source: str,
        title: str,
        attribution: str = "",
        map_type: str = "",
        date: str = "",
        tile_px: int = 256,
    ) -> TileStore:
        """Return the store of a source's tiles, to be closed after use; an unusable folder is logged only.

        Parameters
        ----------
        key : str
            Identifies the source's tiles: its URL template, without the user's key.
        source, title, attribution : str
        map_type, date : str
            Empty if the source has only one.
        tile_px : int
        """
        description = About(source, title, attribution, map_type, date, tile_px)
        # "1" is the version of the files' tables; files of another version are left alone.
        digest = hashlib.sha256("\n".join(("1", key, map_type, date, str(tile_px))).encode()).hexdigest()
        slug = "-".join(filter(None, (_slug(text) for text in (source, map_type, date, str(tile_px)))))
        stem = f"{slug}-{digest[:12]}"

        def open_file(broken: TileFile | None) -> TileFile:
            self.folder.mkdir(parents=True, exist_ok=True)
            if broken is not None:
                self._set_aside(broken.path)
            path = self._current(stem)
            try:
                return TileFile(path, description)
            except FILE_ERRORS as wrong:
                if database.fault(wrong) != "corrupt":
                    raise
                self._set_aside(path)
            return TileFile(self._current(stem), description)

        return TileStore(open_file, self.trim, self._clock)

    def list(self) -> tuple[CacheFile, ...]:
        """Return the files that hold tiles, sorted by name."""
        found = []
        for path in self._paths():
            try:
                rows, tiles = database.metadata(path)
            except FILE_ERRORS as wrong:
                _log.warning("cache %s: cannot be read (%s)", path, wrong)
                continue
            if tiles:
                found.append(_described(path, rows, tiles))
        return tuple(found)

    def clear(self, names: Iterable[str] | None = None) -> int:
        """Remove files and return the bytes freed; a file that another capture has open is emptied instead.

        Parameters
        ----------
        names : iterable of str or None
            Sources, titles or names of files; None for everything.

        Raises
        ------
        InvalidInput
            An unknown name.
        OutputError
            A file cannot be removed.
        """
        bytes_before = self._folder_bytes()
        everything = (*self._paths(), *self._paths(corrupt=True))
        # Try all files before raising the first failure.
        failures = [_remove_or_empty(path) for path in (everything if names is None else self._named(names))]
        for failure in filter(None, failures):
            raise failure
        return max(bytes_before - self._folder_bytes(), 0)

    def trim(self) -> None:
        """Remove the least recently used tiles until the files are within the limit; stop after a second."""
        if self._folder_bytes() <= self.limit_bytes:
            return
        for path in self._paths(corrupt=True):
            with suppress(OSError):
                path.unlink()
        until_s = time.monotonic() + _TRIM_S
        sizes: dict[Path, int] = {}
        ages: list[tuple[int, Path]] = []
        for path in self._paths():
            with (
                suppress(*FILE_ERRORS),
                closing(database.connect(path, wait_s=database.READ_WAIT_S)) as connection,
            ):
                database.shrink(connection, until_s)
                sizes[path] = database.live_bytes(connection)
                ages.extend((oldest_s, path) for oldest_s in _oldest(connection))
        excess = sum(sizes.values()) - self.limit_bytes
        if excess > 0:
            # Remove a tenth of the limit more, so that not every write trims again.
            goal = excess + 0.1 * self.limit_bytes
            with suppress(*FILE_ERRORS):
                _remove_oldest(ages, goal, until_s)

    def _named(self, names: Iterable[str]) -> tuple[Path, ...]:
        listed = self.list()
        chosen: dict[Path, None] = {}
        for name in names:
            found = [
                file.path
                for file in listed
                if name.casefold()
                in (
                    file.source.casefold(),
                    file.title.casefold(),
                    file.path.name.casefold(),
                    file.path.stem.casefold(),
                )
            ]
            if not found:
                known = ", ".join(sorted({file.source for file in listed})) or "nothing"
                raise InvalidInput("cache {0!r}: is not there; {1} holds {2}", name, self.folder, known)
            chosen.update(dict.fromkeys(found))
        return tuple(chosen)

    def _paths(self, *, corrupt: bool = False) -> tuple[Path, ...]:
        """Files of the cache, or the damaged files that were set aside; other files of the folder are ignored."""
        try:
            with os.scandir(self.folder) as entries:
                names = sorted(entry.name for entry in entries if entry.is_file())
        except OSError:
            return ()
        found = ((name, _NAME.fullmatch(name)) for name in names)
        return tuple(self.folder / name for name, match in found if match and bool(match["corrupt"]) == corrupt)

    def _folder_bytes(self) -> int:
        try:
            with os.scandir(self.folder) as entries:
                return sum(_bytes(Path(entry.path)) for entry in entries if ".mbtiles" in entry.name)
        except OSError:
            return 0

    def _current(self, stem: str) -> Path:
        """Path of the file in use, which is not marked as damaged.

        A file that was set aside keeps its number, and the new file takes the next number: a program that still has
        the old file open must not find the log (WAL) of the new file on closing.
        """
        highest, corrupt = 1, False
        for path in self._paths() + self._paths(corrupt=True):
            match = _NAME.fullmatch(path.name)
            if match and match["stem"] == stem:
                number = int(match["number"] or 1)
                if number >= highest:
                    highest, corrupt = number, bool(match["corrupt"])
        number = highest + 1 if corrupt else highest
        return self.folder / (f"{stem}.mbtiles" if number == 1 else f"{stem}~{number}.mbtiles")

    def _set_aside(self, path: Path) -> None:
        aside = path.with_name(path.name + ".corrupt")
        _log.warning("cache %s: is damaged; set aside as %s and begun anew", path, aside.name)
        try:
            os.replace(path, aside)
        except FileNotFoundError:
            # Another program has already set it aside.
            return
        except OSError:
            # Windows does not rename open files; an empty marker also makes the next file take another number.
            aside.touch()
        for ending in ("-wal", "-shm"):
            with suppress(OSError):
                path.with_name(path.name + ending).unlink()


def _slug(text: str) -> str:
    """Reduce a text to at most 60 letters, digits, dots and hyphens, valid in names on any file system."""
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode().lower()
    return re.sub(r"[^a-z0-9.]+", "-", plain).strip("-.")[:60]


def _bytes(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0


def _described(path: Path, rows: Mapping[str, str], tiles: int) -> CacheFile:
    return CacheFile(
        path,
        source=rows.get("source", ""),
        title=rows.get("title", ""),
        map_type=rows.get("map_type", ""),
        date=rows.get("date", ""),
        tile_px=whole_number(rows.get("tile_px", "")) or 0,
        tiles=tiles,
        bytes=sum(_bytes(path.with_name(path.name + ending)) for ending in ("", "-wal", "-shm")),
    )


def _remove_or_empty(path: Path) -> OutputError | None:
    """Remove a file, or empty it where another program has it open; return the error, if any."""
    try:
        if path.suffix == ".mbtiles" and _has_tiles(path):
            if not database.remove(path):
                database.empty(path, time.monotonic() + _TRIM_S)
        else:
            path.unlink(missing_ok=True)
    except (*FILE_ERRORS, OSError) as wrong:
        return OutputError("cache {0}: cannot be removed ({1})", path, wrong)
    return None


def _has_tiles(path: Path) -> bool:
    """Whether a file is sound enough to count its tiles."""
    try:
        database.metadata(path)
    except FILE_ERRORS as wrong:
        return database.fault(wrong) != "corrupt"
    return True


def _oldest(connection: sqlite3.Connection) -> list[int]:
    """Time of use of the least recently used tile, seconds since 1970, as a list; empty without tiles."""
    (used_s,) = connection.execute("SELECT min(used_s) FROM freshness").fetchone()
    return [] if used_s is None else [int(used_s)]


def _remove_oldest(ages: list[tuple[int, Path]], goal: float, until_s: float) -> None:
    """Remove tiles, oldest first among all files, until ``goal`` bytes are removed or the time is up."""
    heapq.heapify(ages)
    while ages and goal > 0 and time.monotonic() < until_s:
        _, path = heapq.heappop(ages)
        with closing(database.connect(path, wait_s=database.READ_WAIT_S)) as connection:
            with database.transaction(connection):
                rows = connection.execute(
                    "SELECT zoom_level, tile_column, tile_row, coalesce(length(tile_data), 0) FROM freshness "
                    "LEFT JOIN tiles USING (zoom_level, tile_column, tile_row) WHERE used_s <= ? "
                    "ORDER BY used_s LIMIT ?",
                    # Up to the oldest tile of the other files; without other files, any tile.
                    (ages[0][0] if ages else 1 << 62, database.BATCH_TILES),
                ).fetchall()
                removed = []
                for *row, size in rows:
                    removed.append(tuple(row))
                    goal -= size
                    if goal <= 0:
                        break
                database.delete(connection, removed)
            database.shrink(connection, until_s)
            for oldest_s in _oldest(connection):
                heapq.heappush(ages, (oldest_s, path))
