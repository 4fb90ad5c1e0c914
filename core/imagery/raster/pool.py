"""Open rasters, lent to one thread at a time: GDAL's datasets are not safe to share."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from ...errors import Cancelled
from .files import Opener, RasterFile


class Pool:
    """Handles of a raster and its overviews, as many as were ever needed at once.

    Parameters
    ----------
    open_file : callable
    path : str
    """

    def __init__(self, open_file: Opener, path: str) -> None:
        self._open, self._path = open_file, path
        self._free: dict[int, list[RasterFile]] = {}
        self._closed = False
        self._lock = threading.Lock()

    @contextmanager
    def lent(self, level: int) -> Iterator[RasterFile]:
        """Lend the raster (level 0) or an overview; one that failed is not lent again.

        Raises
        ------
        ReadError
            It cannot be opened.
        Cancelled
            The pool is closed.
        """
        with self._lock:
            if self._closed:
                raise Cancelled(f"{self._path}: closed")
            free = self._free.setdefault(level, [])
            known = free.pop() if free else None
        file = known or self._open(self._path, level)
        try:
            yield file
        except BaseException:
            file.close()
            raise
        if not self._taken_back(level, file):
            file.close()

    def _taken_back(self, level: int, file: RasterFile) -> bool:
        with self._lock:
            if not self._closed:
                self._free[level].append(file)
            return not self._closed

    def close(self) -> None:
        """Close the handles: those that are lent as soon as they come back."""
        with self._lock:
            self._closed = True
            files = [file for free in self._free.values() for file in free]
            self._free.clear()
        for file in files:
            file.close()
