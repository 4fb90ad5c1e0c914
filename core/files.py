"""Files and folders: written whole or not at all, read within limits, held by one run at a time."""

from __future__ import annotations

import contextlib
import csv
import errno
import io
import json
import os
import stat
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import IO, Any

from .errors import InvalidInput, OutputError
from .stores import get_range, is_address, put, store_path

#: Ending of a file while it is being written. It is the same every time, so that what a killed run left behind
#: is overwritten by the next one.
PARTIAL_ENDING = ".part"
#: What the systems say where somebody else has the lock. Anything else means that the file system has no locks
#: (some network drives), which is no reason to refuse a capture.
_HELD = frozenset({errno.EACCES, errno.EAGAIN, errno.EWOULDBLOCK, errno.EDEADLK})

if sys.platform == "win32":
    import msvcrt

    #: Windows keeps other processes from reading what is locked: a byte that no file has.
    _LOCKED_BYTE = 1 << 30

    def _lock(file: int) -> None:
        os.lseek(file, _LOCKED_BYTE, os.SEEK_SET)
        msvcrt.locking(file, msvcrt.LK_NBLCK, 1)

    def _unlock(file: int) -> None:
        os.lseek(file, _LOCKED_BYTE, os.SEEK_SET)
        with contextlib.suppress(OSError):
            msvcrt.locking(file, msvcrt.LK_UNLCK, 1)

else:
    import fcntl

    def _lock(file: int) -> None:
        # flock and not lockf, whose locks do not keep two captures of one process apart.
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def _unlock(file: int) -> None:
        # Said, as processes that were forked meanwhile have the file open, too.
        with contextlib.suppress(OSError):
            fcntl.flock(file, fcntl.LOCK_UN)


def is_there(path: str | os.PathLike[str]) -> bool:
    """Whether there is such a file; not for a name that no file can have, where `Path.is_file` raises."""
    return os.path.isfile(path)  # noqa: PTH113


def make_folder(folder: str | os.PathLike[str]) -> None:
    """Make a folder, and those above it, unless it is there.

    Raises
    ------
    OutputError
        Where it cannot be made, or a file is in its place.
    """
    if is_address(folder):
        # Stores have no folders, but names with slashes.
        return
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except FileExistsError as wrong:
        raise OutputError(
            "folder {0}: a file is in its place", folder, remedy="choose another folder"
        ) from wrong
    except OSError as wrong:
        raise OutputError(
            "folder {0}: cannot be made ({1})", folder, wrong.strerror, remedy="choose another folder"
        ) from wrong


def new_folder(folder: str | os.PathLike[str]) -> Path:
    """Make a folder of this machine; raises OutputError where it cannot be made, or is not empty."""
    if is_address(folder):
        raise OutputError("folder {0}: must be one of this machine", folder)
    path = Path(folder)
    make_folder(path)
    if any(path.iterdir()):
        raise OutputError("folder {0}: is not empty", folder, remedy="choose another folder")
    return path


def open_own(path: Path, mode: str, buffering: int = -1) -> IO[bytes]:
    """Open a file of ours in a folder that somebody else may have prepared.

    A link is refused, through which another file would be written, and a pipe, which has no end.

    Raises
    ------
    OSError
        Where it is no file of its own, or cannot be opened.
    """
    file: IO[bytes] = open(path, mode, buffering, opener=_open_own)  # noqa: SIM115 (Path.open has no opener)
    return file


def open_foreign(path: str | os.PathLike[str], buffering: int = -1) -> IO[bytes]:
    """Open a file that somebody else may have made, to read it: no device and no pipe, which have no end.

    Raises
    ------
    OSError
        Where it is no regular file, or cannot be opened.
    """
    file: IO[bytes] = open(path, "rb", buffering, opener=_open_regular)  # noqa: SIM115 (as above)
    return file


def _open_own(path: str, flags: int) -> int:
    try:
        return _open_regular(path, flags | getattr(os, "O_NOFOLLOW", 0))
    except OSError as wrong:
        if wrong.errno == errno.ELOOP:
            raise OSError(errno.ELOOP, "it is a link to another place; remove it") from wrong
        if wrong.errno == errno.EINVAL:
            raise OSError(errno.EINVAL, "it is no regular file; remove it") from wrong
        raise


def _open_regular(path: str, flags: int) -> int:
    # Windows has none of these flags, and makes links for administrators only.
    descriptor = os.open(path, flags | getattr(os, "O_NONBLOCK", 0), 0o666)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise OSError(errno.EINVAL, "it is no regular file")
    return descriptor


def read_limited(path: str | os.PathLike[str], most_bytes: int) -> bytes:
    """Content of a file that somebody else may have made: it may have no end, as a device has none.

    Raises
    ------
    InvalidInput
        Longer than that; says so in a few words, to be put into a message of what was read.
    OSError
        Where it cannot be read; an OutputError of an object.
    """
    if is_address(path):
        data = get_range(store_path(path), 0, most_bytes + 1)
    else:
        with Path(path).open("rb") as file:
            data = file.read(most_bytes + 1)
    if len(data) > most_bytes:
        raise InvalidInput("larger than {0:,.0f} MB", most_bytes / 1000000.0)
    return data


def write_whole(
    path: str | os.PathLike[str], data: bytes | Iterable[bytes], *, durable: bool = False
) -> None:
    """Write a file under a temporary name beside it, then rename it: readers see all of it or nothing.

    Large files come as an iterable of blocks, so that they need not be in memory. Two calls at once must not
    write the same path. Object stores take what is whole.

    Parameters
    ----------
    durable : bool
        Wait until the disk has it, so that a power failure afterwards leaves it whole too.

    Raises
    ------
    OutputError
        Where it cannot be written; what was there before is left alone.
    """
    if is_address(path):
        put(store_path(path), data if isinstance(data, bytes) else b"".join(data))
        return
    target = Path(path)
    try:
        if not target.name:
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if target.exists() and not (target.is_file() or target.is_dir()):
            # As root, even a device such as /dev/null would be replaced.
            raise OSError(errno.EINVAL, "it is no regular file")
        with partial_file(target) as partial, partial.open("xb") as file:
            file.writelines([data] if isinstance(data, bytes) else data)
            if durable:
                file.flush()
                os.fsync(file.fileno())
        if durable:
            _sync_folder(target.parent)
    except OSError as wrong:
        raise OutputError(
            "folder {0}: cannot write {1} ({2})", target.parent, target.name, wrong.strerror
        ) from wrong


def json_bytes(value: Any) -> bytes:
    """What a file of JSON holds."""
    return (json.dumps(value, indent=1, ensure_ascii=False) + "\n").encode("utf-8")


def csv_bytes(rows: Iterable[Sequence[object]]) -> bytes:
    """What a file of CSV holds; None is an empty cell."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode("utf-8")


def link_or_copy(origin: Path, target: Path) -> None:
    """Give an image one more name, whose folder is made; nothing is overwritten.

    It is a copy on file systems that have no further names for a file, such as FAT and some network drives.

    Raises
    ------
    OutputError
        The name is taken, the image cannot be read, or the copy cannot be written.
    """
    make_folder(target.parent)
    try:
        os.link(origin, target)
    except FileExistsError as wrong:
        raise OutputError("image {0}: cannot be placed ({1})", target, wrong.strerror) from wrong
    except OSError:
        try:
            data = origin.read_bytes()
        except OSError as wrong:
            raise OutputError("image {0}: cannot be read ({1})", origin, wrong.strerror) from wrong
        write_whole(target, data)


@contextlib.contextmanager
def partial_file(target: Path, ending: str = PARTIAL_ENDING) -> Iterator[Path]:
    """Name beside a file to write it under: it gets its own name at the end, and is removed where that is not reached.

    Nothing is there under that name: what a killed run has left is removed, and so is a link, through which another
    file would be written.

    Raises
    ------
    OSError
        Where it cannot be renamed, or what is there not be removed.
    """
    partial = target.with_name(target.name + ending)
    partial.unlink(missing_ok=True)
    try:
        yield partial
        os.replace(partial, target)
    except BaseException:
        with contextlib.suppress(OSError):
            partial.unlink()
        raise


def clear_partial(path: str | os.PathLike[str]) -> None:
    """Remove what a killed run has left of writing a file, where it can be removed."""
    with contextlib.suppress(OSError):
        target = Path(path)
        target.with_name(target.name + PARTIAL_ENDING).unlink()


def _sync_folder(folder: Path) -> None:
    """Wait until the disk has the names in a folder, where the system opens folders (Windows does not)."""
    if os.name == "nt":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def open_locked(path: Path) -> IO[bytes]:
    """Open a file to append to it, for this run alone; it is made if it is not there.

    Returns
    -------
    file
        Unbuffered; the lock ends when it is closed.

    Raises
    ------
    OutputError
        Another run has it, or it cannot be written.
    """
    try:
        # Not inherited by programs that the run starts, which may outlive it.
        file = open_own(path, "ab", buffering=0)
    except OSError as wrong:
        raise OutputError(
            "folder {0}: cannot write {1} ({2})", path.parent, path.name, wrong.strerror
        ) from wrong
    if not _is_locked_by(file):
        file.close()
        raise OutputError(
            "folder {0}: another run is at work in it",
            path.parent,
            remedy="wait until it has ended or choose another folder",
        )
    return file


@contextlib.contextmanager
def lock_tried(path: Path) -> Iterator[bool]:
    """Hold a file's lock, unless another thread or process has it; whether it is held here.

    Raises
    ------
    OSError
        Where there can be no such file.
    """
    with open_own(path, "ab", buffering=0) as file:
        held = _is_locked_by(file)
        try:
            yield held
        finally:
            if held:
                _unlock(file.fileno())


def _is_locked_by(file: IO[bytes]) -> bool:
    try:
        _lock(file.fileno())
    except OSError as wrong:
        return wrong.errno not in _HELD
    return True
