"""Tiles kept from run to run: a folder with an MBTiles file for each source, map type, date and size of tiles."""

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
from ...text import whole_number
from . import tilefile
from .tilefile import FILE_ERRORS, About, TileFile
from .tilestore import TileStore

FOLDER_ENV = "TERRAINAV_CACHE_DIR"
#: Bytes of all files together, where nothing else is said.
LIMIT_BYTES = 4 << 30
#: Share of the limit that is left when tiles have to go, so that they do not have to with every write.
_TRIMMED_SHARE = 0.9
#: Longest time for that at once, seconds; the next write goes on with it.
_TRIM_S = 1.0
#: Later than any time, seconds since 1970.
_EVER = 1 << 62
#: Enters the files' names, so that files of another form are left alone.
_FORM = "1"
#: Files are told from others by their names: words, a hash, and a number where one before was damaged.
_NAME = re.compile(r"(?P<stem>.+-[0-9a-f]{12})(~(?P<number>\d+))?\.mbtiles(?P<corrupt>\.corrupt)?")
_SLUG_CHARACTERS = 60

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
    # A relative path there is to be ignored (XDG Base Directory Specification).
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
    """A folder of tiles. Several captures may use it at once, in one program or in several.

    Parameters
    ----------
    folder : path or None
        Made when the first tile is stored; None for `default_folder`.
    limit_bytes : int
        Of all files together; the tiles used least recently go first.
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
        """On another machine the usual folder is another one."""
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
        """Tiles of a source, to be closed after use. A folder that cannot be used is warned of, no error.

        Parameters
        ----------
        key : str
            What tells the source's tiles from all others: its URL template, without the user's key.
        source, title, attribution : str
        map_type, date : str
            Empty where the source has but one.
        tile_px : int
        """
        about = About(source, title, attribution, map_type, date, tile_px)
        digest = hashlib.sha256("\n".join((_FORM, key, map_type, date, str(tile_px))).encode()).hexdigest()
        slug = "-".join(filter(None, (_slug(text) for text in (source, map_type, date, str(tile_px)))))
        stem = f"{slug}-{digest[:12]}"

        def open_file(broken: TileFile | None) -> TileFile:
            self.folder.mkdir(parents=True, exist_ok=True)
            if broken is not None:
                self._set_aside(broken.path)
            path = self._current(stem)
            try:
                return TileFile(path, about)
            except FILE_ERRORS as wrong:
                if tilefile.fault(wrong) != "corrupt":
                    raise
                self._set_aside(path)
            return TileFile(self._current(stem), about)

        return TileStore(open_file, self.trim, self._clock)

    def list(self) -> tuple[CacheFile, ...]:
        """Files that hold tiles, by name."""
        found = []
        for path in self._paths():
            try:
                rows, tiles = tilefile.metadata(path)
            except FILE_ERRORS as wrong:
                _log.warning("cache %s: cannot be read (%s)", path, wrong)
                continue
            if tiles:
                found.append(_described(path, rows, tiles))
        return tuple(found)

    def clear(self, names: Iterable[str] | None = None) -> int:
        """Remove files, and return how many bytes that freed.

        A file that another capture has open is emptied instead.

        Parameters
        ----------
        names : iterable of str or None
            Sources, titles or names of files; None for everything.

        Raises
        ------
        InvalidInput
            A name that is not there.
        OutputError
            A file cannot be removed.
        """
        before = self._folder_bytes()
        everything = (*self._paths(), *self._paths(corrupt=True))
        # Where one cannot be removed, the others go all the same.
        failures = [_failure(path) for path in (everything if names is None else self._named(names))]
        for failure in filter(None, failures):
            raise failure
        return max(before - self._folder_bytes(), 0)

    def trim(self) -> None:
        """Remove the tiles used least recently until the files are within the limit, a second's worth at most."""
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
                closing(tilefile.connect(path, wait_s=tilefile.READ_WAIT_S)) as connection,
            ):
                tilefile.shrink(connection, until_s)
                sizes[path] = tilefile.live_bytes(connection)
                ages.extend((age_s, path) for age_s in _oldest(connection))
        excess = sum(sizes.values()) - self.limit_bytes
        if excess > 0:
            goal = excess + (1.0 - _TRIMMED_SHARE) * self.limit_bytes
            with suppress(*FILE_ERRORS):
                _remove_oldest(ages, goal, until_s)

    def _named(self, names: Iterable[str]) -> tuple[Path, ...]:
        listed = self.list()
        chosen: dict[Path, None] = {}
        for name in names:
            own = [
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
            if not own:
                known = ", ".join(sorted({file.source for file in listed})) or "nothing"
                raise InvalidInput("cache {0!r}: is not there; {1} holds {2}", name, self.folder, known)
            chosen.update(dict.fromkeys(own))
        return tuple(chosen)

    def _paths(self, *, corrupt: bool = False) -> tuple[Path, ...]:
        """Files of the cache, or those that were set aside; files of others are left alone."""
        try:
            with os.scandir(self.folder) as entries:
                names = sorted(entry.name for entry in entries if entry.is_file())
        except OSError:
            return ()
        found = ((name, _NAME.fullmatch(name)) for name in names)
        return tuple(
            self.folder / name for name, match in found if match and bool(match["corrupt"]) == corrupt
        )

    def _folder_bytes(self) -> int:
        try:
            with os.scandir(self.folder) as entries:
                return sum(_bytes(Path(entry.path)) for entry in entries if ".mbtiles" in entry.name)
        except OSError:
            return 0

    def _current(self, stem: str) -> Path:
        """Path of a file that is not damaged.

        One that is set aside keeps its number, and the next takes another: a program that still has the old one open
        must not come across the log (WAL) of the new one when it closes.
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
            # Another program has set it aside already.
            return
        except OSError:
            # Windows does not rename what another program has open. The mark alone has the next number taken.
            aside.touch()
        for ending in ("-wal", "-shm"):
            with suppress(OSError):
                path.with_name(path.name + ending).unlink()


def _slug(text: str) -> str:
    """Letters, digits, dots and hyphens that any file system takes."""
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode().lower()
    return re.sub(r"[^a-z0-9.]+", "-", plain).strip("-.")[:_SLUG_CHARACTERS]


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


def _failure(path: Path) -> OutputError | None:
    """Remove a file, or empty it where another program has it open; return why that was not possible."""
    try:
        if path.suffix == ".mbtiles" and _has_tiles(path):
            if not tilefile.remove(path):
                tilefile.empty(path, time.monotonic() + _TRIM_S)
        else:
            path.unlink(missing_ok=True)
    except (*FILE_ERRORS, OSError) as wrong:
        return OutputError("cache {0}: cannot be removed ({1})", path, wrong)
    return None


def _has_tiles(path: Path) -> bool:
    """Whether a file is whole enough to be asked for its tiles."""
    try:
        tilefile.metadata(path)
    except FILE_ERRORS as wrong:
        return tilefile.fault(wrong) != "corrupt"
    return True


def _oldest(connection: sqlite3.Connection) -> list[int]:
    """When the tile of a file that was used least recently was used, seconds since 1970; none where it is empty."""
    (used_s,) = connection.execute("SELECT min(used_s) FROM freshness").fetchone()
    return [] if used_s is None else [int(used_s)]


def _remove_oldest(ages: list[tuple[int, Path]], goal: float, until_s: float) -> None:
    """Remove tiles, oldest first over all files, until ``goal`` bytes are gone or the time is over."""
    heapq.heapify(ages)
    while ages and goal > 0 and time.monotonic() < until_s:
        _, path = heapq.heappop(ages)
        with closing(tilefile.connect(path, wait_s=tilefile.READ_WAIT_S)) as connection:
            with tilefile.transaction(connection):
                rows = connection.execute(
                    "SELECT zoom_level, tile_column, tile_row, coalesce(length(tile_data), 0) FROM freshness "
                    "LEFT JOIN tiles USING (zoom_level, tile_column, tile_row) WHERE used_s <= ? "
                    "ORDER BY used_s LIMIT ?",
                    # As far as the next file's oldest, and always one.
                    (ages[0][0] if ages else _EVER, tilefile.BATCH_TILES),
                ).fetchall()
                gone = []
                for *row, size in rows:
                    gone.append(tuple(row))
                    goal -= size
                    if goal <= 0:
                        break
                tilefile.delete(connection, gone)
            tilefile.shrink(connection, until_s)
            for age_s in _oldest(connection):
                heapq.heappush(ages, (age_s, path))
