"""Stream shards of an object store into training: fetch whole shards before they are needed, within a space limit.

The order of samples keeps together the samples of a group, a few shards. The shards of the current group and of the
next group are fetched into a folder that all workers on this machine share; the least recently needed shards are
removed to make room.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import threading
import time
import weakref
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import NDArray, Numbers
from ...errors import InvalidInput, OutputError, TerrAInavError
from ...storage.files import PARTIAL_ENDING, lock_tried
from ...storage.stores import get_range

#: Bytes of a shard requested at a time, in memory once for each shard being fetched.
_PART_BYTES = 16_000_000
#: Seconds between checks whether another worker has fetched a shard.
_PAUSE_S = 0.005
_LOCK_ENDING = ".lock"


class Shards:
    """Shards of images, and groups of shards whose images are taken together in an epoch.

    Parameters
    ----------
    names : sequence of str
        Shard of each image.
    at_once : int
        Number of shards in a group.

    Attributes
    ----------
    names : tuple of str
        Names of the shards, in the order of the images.
    of_image : array (n,)
        Index of each image's shard in ``names``.
    """

    def __init__(self, names: Sequence[str], at_once: int) -> None:
        number = {name: at for at, name in enumerate(dict.fromkeys(names))}
        self.names, self._at_once = tuple(number), at_once
        self.of_image = np.fromiter((number[name] for name in names), np.int64, len(names))
        self._images = np.bincount(self.of_image)
        self._last: tuple[str, Numbers, Numbers] | None = None

    def order(self, key: str) -> Numbers:
        """Indices of images in the random order of a key, group by group; for an empty key, ordered by shard."""
        if not key:
            return np.argsort(self.of_image, kind="stable")
        groups, _ = self._groups(key)
        found: Numbers = np.lexsort((random_numbers(key, len(self.of_image)), groups[self.of_image]))
        return found

    def ahead(self, indices: Sequence[int] | Numbers, key: str) -> tuple[list[str], list[str]]:
        """Shards of images, and the shards to fetch ahead in the order of ``key``.

        The shards to fetch are those of the images' groups and of the next group; none if the images do not follow each
        other in that order.

        Parameters
        ----------
        key : str
            As for `order`.
        """
        needed = np.unique(self.of_image[np.asarray(indices, np.int64)])
        groups, starts = self._groups(key)
        first, last = int(groups[needed].min()), int(groups[needed].max())
        ahead = np.empty(0, np.int64)
        if starts[last] - starts[first + 1] <= len(indices):
            ahead = np.flatnonzero((groups >= first) & (groups <= last + 1))
            ahead = ahead[np.argsort(groups[ahead], kind="stable")]
        return [self.names[one] for one in needed], [self.names[one] for one in ahead]

    def _groups(self, key: str) -> tuple[Numbers, Numbers]:
        """Group of each shard, and the number of images before each group, with the total at the end."""
        last = self._last
        if last is None or last[0] != key:
            place = np.arange(len(self.names))
            if key:
                place[np.argsort(random_numbers(f"{key}:shards", len(place)), kind="stable")] = place.copy()
            groups = place // self._at_once
            counts = np.bincount(groups, weights=self._images).astype(np.int64)
            # Set all at once, as several threads read it.
            self._last = last = key, groups, np.concatenate([[0], np.cumsum(counts)])
        return last[1:]


def random_numbers(key: str, count: int) -> NDArray[np.uint64]:
    """Random numbers (count,) of a key: the raw stream of numpy's Philox, the same in all versions (NEP 19)."""
    number = int.from_bytes(blake2b(key.encode(), digest_size=16).digest(), "little")
    return np.random.Philox(key=number).random_raw(count)


class ShardCache:
    """Copies of a dataset's shards in a temporary folder, which is removed with the instance that made the folder.

    Pickled instances share the folder.

    Parameters
    ----------
    folder : Path
        Address of the shards in an object store.
    sizes : mapping of str to int
        Size of each shard in bytes.
    shards_at_once : int
        Number of shards in a group.
    limit_bytes : int or None
        Most bytes kept; None for three groups.

    Raises
    ------
    OutputError
        The temporary folder cannot be made.
    """

    def __init__(self, folder: Path, sizes: Mapping[str, int], shards_at_once: int, limit_bytes: int | None) -> None:
        self._folder, self._sizes = folder, dict(sizes)
        # Room for the current group, the next group, and a group that another worker still needs.
        default = 3 * shards_at_once * max(self._sizes.values())
        self.limit_bytes = default if limit_bytes is None else limit_bytes
        try:
            self._place = Path(tempfile.mkdtemp(prefix="terrainav-shards-"))
        except OSError as wrong:
            raise OutputError("folder {0}: cannot be written ({1})", tempfile.gettempdir(), wrong.strerror) from wrong
        weakref.finalize(self, _remove, self._place, os.getpid())
        self.__setstate__({})

    def __getstate__(self) -> dict[str, Any]:
        of_process = ("_process", "_lock", "_waiting", "_wanted", "_fetching")
        return {name: value for name, value in vars(self).items() if name not in of_process}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._process, self._lock = os.getpid(), threading.Lock()
        #: Names of shards to fetch.
        self._waiting: deque[str] = deque()
        #: Names of shards to keep.
        self._wanted: frozenset[str] = frozenset()
        #: Number of threads that fetch.
        self._fetching = 0

    def copy(self, name: str) -> Path:
        """Path of a shard's copy, if it exists."""
        return self._place / name

    def hold(self, needed: Sequence[str], ahead: Sequence[str]) -> None:
        """Fetch shards if there is room, and the next shards in the background.

        Parameters
        ----------
        needed : sequence of str
            Shards to be read now.
        ahead : sequence of str
            The needed shards, then others to be read later, in order.

        Raises
        ------
        InvalidInput
            A shard has another length than before.
        OutputError
            A shard cannot be fetched or written.
        """
        if self._process != os.getpid():
            # After a fork: a thread that holds the lock does not exist in this process.
            self.__setstate__({})
        with self._lock:
            self._wanted = frozenset(ahead)
            self._waiting = deque(name for name in ahead if not self.copy(name).exists())
            # Each process fetches with at most four threads.
            more = max(min(4, len(self._waiting)) - self._fetching, 0)
            self._fetching += more
        for _ in range(more):
            threading.Thread(target=self._fetch_waiting, daemon=True).start()
        for name in needed:
            # If another worker takes longer to fetch the shard, its images are read one by one.
            deadline = time.monotonic() + 120.0
            while not self._has_tried(name) and time.monotonic() < deadline:
                time.sleep(_PAUSE_S)

    def _fetch_waiting(self) -> None:
        while True:
            with self._lock:
                if not self._waiting:
                    self._fetching -= 1
                    return
                name = self._waiting.popleft()
            # The reader that needs the shard tries again and reports the error.
            with suppress(TerrAInavError, OSError):
                self._has_tried(name, if_wanted=True)

    def _has_tried(self, name: str, *, if_wanted: bool = False) -> bool:
        """Fetch a missing shard if there is room; returns False if another worker is fetching it.

        With ``if_wanted``, skip a shard that is no longer wanted.
        """
        copy = self.copy(name)
        if self._sizes[name] > self.limit_bytes:
            return True
        try:
            with suppress(FileNotFoundError):
                # Mark an existing copy as recently needed.
                os.utime(copy)
                return True
            self._place.mkdir(exist_ok=True)
            with lock_tried(self.copy(name + _LOCK_ENDING)) as held:
                if held and not copy.exists() and (name in self._wanted or not if_wanted):
                    self._fetch(name)
                return held
        except OSError as wrong:
            raise OutputError(
                "folder {0}: cannot keep the shard {1} ({2})",
                self._place,
                name,
                wrong.strerror,
                remedy="set TMPDIR to a folder with more room",
            ) from wrong

    def _fetch(self, name: str) -> None:
        """Fetch a shard whose lock is held, if there is room."""
        size, partial = self._sizes[name], self.copy(name + PARTIAL_ENDING)
        if not self._reserve(partial, size):
            return
        try:
            with partial.open("r+b") as file:
                for start in range(0, size, _PART_BYTES):
                    length = min(_PART_BYTES, size - start)
                    data = get_range(self._folder / name, start, length)
                    if len(data) != length:
                        raise InvalidInput("shard {0}: is cut short", self._folder / name)
                    file.write(data)
            with self._room():
                os.replace(partial, self.copy(name))
        except BaseException:
            with suppress(OSError):
                partial.unlink()
            raise

    def _reserve(self, partial: Path, size: int) -> bool:
        """Make room for a shard and create a file of its size; returns whether there is room."""
        with self._room():
            partial.unlink(missing_ok=True)
            if not self._makes_room(size):
                return False
            with partial.open("xb") as file:
                file.truncate(size)
        return True

    @contextmanager
    def _room(self) -> Iterator[None]:
        """Lock the cache against other workers."""
        while True:
            with lock_tried(self.copy("room.lock")) as held:
                if held:
                    yield
                    return
            time.sleep(_PAUSE_S)

    def _makes_room(self, size: int) -> bool:
        kept = []
        with os.scandir(self._place) as entries:
            for entry in entries:
                # Files of failed fetches may be removed at any time.
                with suppress(FileNotFoundError):
                    if not entry.name.endswith(_LOCK_ENDING):
                        kept.append((entry.stat().st_mtime_ns, entry.stat().st_size, entry.name))
        room = self.limit_bytes - sum(one for _, one, _ in kept)
        for _, freed, name in sorted(kept):
            if room >= size:
                break
            if name not in self._wanted and not name.endswith(PARTIAL_ENDING):
                # Workers that are reading the shard continue, or read its images from the store.
                with suppress(OSError):
                    self.copy(name).unlink()
                    room += freed
        return room >= size


def _remove(folder: Path, maker: int) -> None:
    """Remove a cache, if this process made it."""
    if os.getpid() == maker:
        shutil.rmtree(folder, ignore_errors=True)
