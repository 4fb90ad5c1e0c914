"""Files that are there whole or not at all."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable
from pathlib import Path

from .errors import OutputError

#: Ending of a file while it is being written. It is the same every time, so that what a killed run left behind
#: is overwritten by the next one.
PARTIAL_ENDING = ".part"


def is_there(path: str | os.PathLike[str]) -> bool:
    """Whether there is such a file; not for a name that no file can have."""
    try:
        return Path(path).is_file()
    except (OSError, ValueError):
        return False


def make_folder(folder: str | os.PathLike[str]) -> None:
    """Make a folder, and those above it, unless it is there.

    Raises
    ------
    OutputError
        Where it cannot be made, or a file is in its place.
    """
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except FileExistsError as wrong:
        raise OutputError(f"folder {folder}: a file is in its place; choose another folder") from wrong
    except OSError as wrong:
        raise OutputError(
            f"folder {folder}: cannot be made ({wrong.strerror}); choose another folder"
        ) from wrong


def write_whole(
    path: str | os.PathLike[str], data: bytes | Iterable[bytes], *, durable: bool = False
) -> None:
    """Write a file under a temporary name beside it, then rename it: readers see all of it or nothing.

    Large files come as an iterable of blocks, so that they need not be in memory. Two calls at once must not
    write the same path.

    Parameters
    ----------
    path : path
    data : bytes or iterable of bytes
    durable : bool
        Wait until the disk has it, so that a power failure afterwards leaves it whole too.

    Raises
    ------
    OutputError
        Where it cannot be written; what was there before is left alone.
    """
    target = Path(path)
    partial = _partial(target)
    try:
        try:
            with partial.open("wb") as file:
                file.writelines([data] if isinstance(data, bytes) else data)
                if durable:
                    file.flush()
                    os.fsync(file.fileno())
            os.replace(partial, target)
            if durable:
                _sync_folder(target.parent)
        except BaseException:
            with contextlib.suppress(OSError):
                partial.unlink()
            raise
    except OSError as wrong:
        raise OutputError(f"folder {target.parent}: cannot write {target.name} ({wrong.strerror})") from wrong


def clear_partial(path: str | os.PathLike[str]) -> None:
    """Remove what a killed run has left of writing a file, where it can be removed."""
    with contextlib.suppress(OSError):
        _partial(Path(path)).unlink()


def _partial(target: Path) -> Path:
    return target.with_name(target.name + PARTIAL_ENDING)


def _sync_folder(folder: Path) -> None:
    """Wait until the disk has the names in a folder, where the system opens folders (Windows does not)."""
    if os.name == "nt":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
