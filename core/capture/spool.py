"""Pixels that are needed later: a bounded amount in memory, the rest in a file that nobody sees."""

from __future__ import annotations

import io
import tempfile
from typing import IO, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

Pixels = NDArray[np.uint8]

#: Pixels in memory, bytes: a hundred tiles of 256 px, which is what missions of fifty pictures across share from one
#: strip to the next.
MEMORY_BYTES = 20 << 20


class Slot(NamedTuple):
    """Where a spool has an array: the array itself, or its place in the file and what it was."""

    held: Pixels | None
    at: int
    shape: tuple[int, ...]
    dtype: str


class Spool:
    """Arrays that wait: the first in memory, those for which there is no room in an anonymous file.

    The file is in the folder for temporary files (TMPDIR, TEMP), made when it is needed, and goes with the process,
    however that ends. The room of an array that was taken is used again for one of the same size, so that the file is
    as large as what it held at most. For one thread at a time.

    Parameters
    ----------
    memory_bytes : int
    """

    def __init__(self, memory_bytes: int = MEMORY_BYTES) -> None:
        self._room_bytes = memory_bytes
        self._file: io.FileIO | None = None
        self._end = 0
        self._free: dict[int, list[int]] = {}

    def put(self, pixels: Pixels) -> Slot:
        """Keep an array, which must not be changed any more.

        Raises
        ------
        OSError
            Where the disk does not take it; nothing is kept then.
        """
        size = pixels.nbytes
        if size <= self._room_bytes:
            self._room_bytes -= size
            return Slot(pixels, 0, pixels.shape, pixels.dtype.str)
        free = self._free.get(size)
        at = free[-1] if free else self._end
        self._write(at, np.ascontiguousarray(pixels))
        if free:
            free.pop()
        else:
            self._end += size
        return Slot(None, at, pixels.shape, pixels.dtype.str)

    def take(self, slot: Slot) -> Pixels:
        """Return an array and free its room.

        Raises
        ------
        OSError
            Where the disk does not give it back.
        """
        if slot.held is not None:
            self._room_bytes += slot.held.nbytes
            return slot.held
        pixels = np.empty(slot.shape, slot.dtype)
        self._free.setdefault(pixels.nbytes, []).append(slot.at)
        self._read(slot.at, pixels)
        return pixels

    def close(self) -> None:
        """Give the file up, and what it holds."""
        if self._file is not None:
            self._file.close()

    def _write(self, at: int, content: Pixels) -> None:
        if self._file is None:
            # Unbuffered: arrays are large, and what a full disk does not take is known at once.
            file: IO[bytes] = tempfile.TemporaryFile(prefix="terrainav-", buffering=0)  # noqa: SIM115 (see close)
            self._file = cast(io.FileIO, file)
        self._file.seek(at)
        if self._file.write(content.data) != content.nbytes:
            raise OSError("the disk took only a part of an array")

    def _read(self, at: int, pixels: Pixels) -> None:
        if self._file is None:
            raise ValueError("this spool has no file: the slot is of another one")
        self._file.seek(at)
        if self._file.readinto(pixels.data) != pixels.nbytes:
            raise OSError("the disk gave only a part of an array back")
