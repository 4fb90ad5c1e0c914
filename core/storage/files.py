"""Files and folders: atomic writing, reading within limits, locks for one run at a time."""

from __future__ import annotations

import codecs
import contextlib
import csv
import errno
import io
import json
import os
import shutil
import stat
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import IO, Any

from ..errors import InvalidInput, OutputError
from ..limits import MAX_LINE_BYTES, MAX_TABLE_BYTES
from .store_requests import larger_than
from .stores import get, get_each, is_address, open_object, put, put_new, remove, store_path

#: Suffix of a file while it is written; always the same, so that the next run overwrites a partial file.
PARTIAL_ENDING = ".part"

if sys.platform == "win32":
    import msvcrt

    #: Windows prevents other processes from reading locked bytes, so lock a byte beyond the end of any file.
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
        # Do not use lockf, whose locks do not exclude two captures in one process.
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def _unlock(file: int) -> None:
        # Unlock explicitly, as forked processes may have the file open, too.
        with contextlib.suppress(OSError):
            fcntl.flock(file, fcntl.LOCK_UN)


def file_exists(path: str | os.PathLike[str]) -> bool:
    """Whether a file exists; False for invalid names, for which `Path.is_file` raises."""
    return os.path.isfile(path)  # noqa: PTH113


def make_folder(folder: str | os.PathLike[str]) -> None:
    """Create a folder and its parents if they do not exist.

    Raises
    ------
    OutputError
        The folder cannot be created, or a file is in its place.
    """
    if is_address(folder):
        # Object stores have no folders, only names with slashes.
        return
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except FileExistsError as wrong:
        raise OutputError("folder {0}: a file is in its place", folder, remedy="choose another folder") from wrong
    except OSError as wrong:
        raise OutputError(
            "folder {0}: cannot be made ({1})", folder, wrong.strerror, remedy="choose another folder"
        ) from wrong


def new_folder(folder: str | os.PathLike[str]) -> Path:
    """Create a folder on this machine; raises OutputError if that fails or the folder is not empty."""
    if is_address(folder):
        raise OutputError("folder {0}: must be one of this machine", folder)
    path = Path(folder)
    make_folder(path)
    if any(path.iterdir()):
        raise OutputError("folder {0}: is not empty", folder, remedy="choose another folder")
    return path


def open_own(path: Path, mode: str, buffering: int = -1) -> IO[bytes]:
    """Open a file that TerrAInav writes, in a folder that may hold foreign files.

    Links are refused, as they would lead to other files, and pipes, as they may never end.

    Raises
    ------
    OSError
        The file is not regular, or cannot be opened.
    """
    file: IO[bytes] = open(path, mode, buffering, opener=_open_own)  # noqa: SIM115 (Path.open has no opener)
    return file


def open_foreign(path: str | os.PathLike[str], most_bytes: int | None = None, buffering: int = -1) -> IO[bytes]:
    """Open a foreign file for reading; devices and pipes, which may never end, are refused.

    An object of a store is first copied to a temporary file, see `stores.open_object`.

    Parameters
    ----------
    most_bytes : int or None
        Limit of size; None for a file of which only a small part is read.

    Raises
    ------
    InvalidInput
        The file is larger; the message has a few words, without the name.
    OSError
        The file is not regular, or cannot be opened.
    OutputError
        The store fails.
    """
    if is_address(path):
        return open_object(store_path(path), most_bytes or MAX_TABLE_BYTES)
    file: IO[bytes] = open(path, "rb", buffering, opener=_open_regular)  # noqa: SIM115 (as above)
    if most_bytes is not None and os.fstat(file.fileno()).st_size > most_bytes:
        file.close()
        raise larger_than(most_bytes)
    return file


def read_line(file: IO[bytes]) -> bytes:
    """Read a line of a foreign file; raises InvalidInput if it is too long."""
    line = file.readline(MAX_LINE_BYTES + 1)
    if len(line) > MAX_LINE_BYTES:
        raise too_long_line()
    return line


def too_long_line() -> InvalidInput:
    """Error for a line that is too long, in a few words."""
    return InvalidInput("a line is longer than {0} kB", MAX_LINE_BYTES >> 10)


def text_lines(file: IO[bytes], encoding: str) -> Iterator[str]:
    """Yield decoded lines with their line ends; raises as `read_line` does, and UnicodeDecodeError."""
    decode = codecs.getincrementaldecoder(encoding)().decode
    while line := read_line(file):
        text = decode(line)
        # A single carriage return also ends a line.
        yield from io.StringIO(text, newline="") if "\r" in text else (text,)
    decode(b"", True)


def _open_own(path: str, flags: int) -> int:
    try:
        return _open_regular(path, flags | getattr(os, "O_NOFOLLOW", 0))
    except OSError as wrong:
        if wrong.errno == errno.ELOOP:
            raise OSError(errno.ELOOP, "it is a link to another place; remove it") from wrong
        if wrong.errno == errno.EINVAL:
            raise OSError(errno.EINVAL, "it is not a regular file; remove it") from wrong
        raise


def _open_regular(path: str, flags: int) -> int:
    # Windows lacks O_NONBLOCK and O_NOFOLLOW, but lets only administrators create links.
    descriptor = os.open(path, flags | getattr(os, "O_NONBLOCK", 0), 0o666)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise OSError(errno.EINVAL, "it is not a regular file")
    return descriptor


def read_limited(path: str | os.PathLike[str], most_bytes: int, *, named_by_user: bool = False) -> bytes:
    """Read a foreign file or object.

    Parameters
    ----------
    path : path
    most_bytes : int
        Limit of size.
    named_by_user : bool
        Whether to accept pipes and devices: users who name one, such as ``/dev/stdin``, know that it may block.

    Raises
    ------
    InvalidInput
        The file is larger; the message has a few words, without the name.
    OSError
        The file cannot be read.
    OutputError
        The store fails.
    """
    if is_address(path):
        found = get(store_path(path), most_bytes)
        if found is None:
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
        return found
    with Path(path).open("rb") if named_by_user else open_foreign(path) as file:
        size = os.fstat(file.fileno()).st_size
        if size > most_bytes:
            raise larger_than(most_bytes)
        data = file.read(size + 1)
        if len(data) <= size:
            return data
        # The file is a pipe, whose size is 0, or it is growing.
        more = bytearray(data)
        while block := file.read(1 << 20):
            more += block
            if len(more) > most_bytes:
                raise larger_than(most_bytes)
    return bytes(more)


def read_existing(path: str | os.PathLike[str], most_bytes: int) -> bytes | None:
    """Read a file or object as `read_limited` does; None if it does not exist.

    Raises
    ------
    InvalidInput, OutputError
        The file is larger, or cannot be read; the message names it.
    """
    try:
        return read_limited(path, most_bytes)
    except FileNotFoundError:
        return None
    except InvalidInput as wrong:
        raise InvalidInput("file {0}: cannot be read ({1})", path, wrong) from wrong
    except OSError as wrong:
        raise OutputError("file {0}: cannot be read ({1})", path, wrong.strerror) from wrong


def read_each(paths: Sequence[Path], most_bytes: int) -> list[bytes | None]:
    """Read files or objects of one folder as `read_existing` does; objects are requested concurrently."""
    if not (paths and is_address(paths[0])):
        return [read_existing(path, most_bytes) for path in paths]
    try:
        return get_each(paths, most_bytes)
    except InvalidInput as wrong:
        raise InvalidInput("folder {0}: cannot be read ({1})", paths[0].parent, wrong) from wrong


def write_whole(path: str | os.PathLike[str], data: bytes | Iterable[bytes], *, durable: bool = False) -> None:
    """Write a file atomically: write under a temporary name, then rename.

    Concurrent calls must not write the same path. Object stores replace objects atomically.

    Parameters
    ----------
    path : path
    data : bytes or iterable of bytes
        Pass large files as an iterable of blocks, so that they need not fit into memory.
    durable : bool
        Whether to wait until the data is on the disk, so that it survives a power failure.

    Raises
    ------
    OutputError
        The file cannot be written; an earlier file is unchanged.
    """
    if is_address(path):
        put(store_path(path), data if isinstance(data, bytes) else b"".join(data))
        return
    target = Path(path)
    try:
        if not target.name:
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if target.exists() and not (target.is_file() or target.is_dir()):
            # Root would replace even a device such as /dev/null.
            raise OSError(errno.EINVAL, "it is not a regular file")
        with partial_file(target) as partial, partial.open("xb") as file:
            file.writelines([data] if isinstance(data, bytes) else data)
            if durable:
                file.flush()
                os.fsync(file.fileno())
        if durable:
            _sync_folder(target.parent)
    except OSError as wrong:
        raise OutputError("folder {0}: cannot write {1} ({2})", target.parent, target.name, wrong.strerror) from wrong


def write_new(path: str | os.PathLike[str], data: bytes) -> bool:
    """Write a file or object unless it exists; of several concurrent writers, only one succeeds.

    Returns
    -------
    bool
        Whether the file was written.

    Raises
    ------
    OutputError
    """
    if is_address(path):
        return put_new(store_path(path), data)
    target = Path(path)
    try:
        with open_own(target, "xb") as file:
            file.write(data)
    except FileExistsError:
        return False
    except OSError as wrong:
        raise OutputError("folder {0}: cannot write {1} ({2})", target.parent, target.name, wrong.strerror) from wrong
    return True


def remove_file(path: str | os.PathLike[str]) -> None:
    """Remove a file or object, if it exists."""
    if is_address(path):
        remove(store_path(path))
    else:
        Path(path).unlink(missing_ok=True)


def json_bytes(value: Any) -> bytes:
    """Encode a value as a JSON file."""
    return (json.dumps(value, indent=1, ensure_ascii=False) + "\n").encode("utf-8")


def csv_bytes(rows: Iterable[Sequence[object]]) -> bytes:
    """Encode rows as a CSV file; None is an empty cell."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode("utf-8")


def link_or_copy(origin: Path, target: Path) -> None:
    """Hard-link an image to another name; create the folder, but overwrite nothing.

    On file systems without hard links, such as FAT and some network drives, the image is copied.

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
            with open_foreign(origin) as file:
                write_whole(target, iter(lambda: file.read(1 << 20), b""))
        except OSError as wrong:
            raise OutputError("image {0}: cannot be read ({1})", origin, wrong.strerror) from wrong


@contextlib.contextmanager
def partial_file(target: Path, ending: str = PARTIAL_ENDING) -> Iterator[Path]:
    """Yield a temporary path beside a target; rename it to the target at the end, or remove it after an exception.

    A file or link of the temporary name, left over from a killed run, is removed first.

    Raises
    ------
    OSError
        Removing or renaming fails.
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


@contextlib.contextmanager
def partial_folder(folder: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a folder whose name ends in ``.part``; rename it to ``folder`` at the end, or remove it after an exception.

    Raises
    ------
    OutputError
        The folder cannot be made, or it or the partial one is not empty.
    """
    path = new_folder(folder).resolve()
    partial = path.with_name(path.name + PARTIAL_ENDING)
    if partial.exists():
        raise OutputError("folder {0}: left over from an interrupted export", partial, remedy="remove it")
    try:
        make_folder(partial)
        yield partial
        try:
            path.rmdir()
            os.replace(partial, path)
        except OSError as wrong:
            raise OutputError("folder {0}: cannot be made ({1})", folder, wrong.strerror) from wrong
    except BaseException:
        shutil.rmtree(partial, ignore_errors=True)
        with contextlib.suppress(OSError):
            path.rmdir()
        raise


def clear_partial(path: str | os.PathLike[str]) -> None:
    """Remove the partial file of a killed run, if possible."""
    with contextlib.suppress(OSError):
        target = Path(path)
        target.with_name(target.name + PARTIAL_ENDING).unlink()


def _sync_folder(folder: Path) -> None:
    """Wait until the entries of a folder are on the disk; Windows cannot open folders."""
    if os.name == "nt":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def open_locked(path: Path) -> IO[bytes]:
    """Open a file for appending, creating it if necessary, and lock it for this run.

    Returns
    -------
    file
        Unbuffered; closing it releases the lock.

    Raises
    ------
    OutputError
        Another run holds the lock, or the file cannot be written.
    """
    try:
        file = open_own(path, "ab", buffering=0)
    except OSError as wrong:
        raise OutputError("folder {0}: cannot write {1} ({2})", path.parent, path.name, wrong.strerror) from wrong
    if not _try_lock(file):
        file.close()
        raise OutputError(
            "folder {0}: another run is at work in it",
            path.parent,
            remedy="wait until it has ended or choose another folder",
        )
    return file


@contextlib.contextmanager
def lock_tried(path: Path) -> Iterator[bool]:
    """Try to lock a file, and yield whether that succeeded.

    Raises
    ------
    OSError
        The file cannot be created.
    """
    with open_own(path, "ab", buffering=0) as file:
        held = _try_lock(file)
        try:
            yield held
        finally:
            if held:
                _unlock(file.fileno())


def _try_lock(file: IO[bytes]) -> bool:
    try:
        _lock(file.fileno())
    except OSError as wrong:
        # Any other error means that the file system, such as some network drives, has no locks: go on without one.
        return wrong.errno not in (errno.EACCES, errno.EAGAIN, errno.EWOULDBLOCK, errno.EDEADLK)
    return True
