"""Files and folders: written whole or not at all, read within limits, held by one run at a time."""

from __future__ import annotations

import codecs
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

from ..errors import InvalidInput, OutputError
from ..limits import MAX_LINE_BYTES, MAX_TABLE_BYTES
from .store_requests import larger_than
from .stores import get, get_each, is_address, open_object, put, put_new, remove, store_path

#: Ending of a file while it is being written. It is the same every time, so that what a killed run left behind
#: is overwritten by the next one.
PARTIAL_ENDING = ".part"
_BLOCK_BYTES = 1 << 20
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


def file_exists(path: str | os.PathLike[str]) -> bool:
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
        raise OutputError("folder {0}: a file is in its place", folder, remedy="choose another folder") from wrong
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


def open_foreign(path: str | os.PathLike[str], most_bytes: int | None = None, buffering: int = -1) -> IO[bytes]:
    """Open a file that somebody else may have made, to read it: no device and no pipe, which have no end.

    An object of a store is copied to a temporary file first, see `stores.open_object`.

    Parameters
    ----------
    most_bytes : int or None
        How large it may be; None for a file of which little is read, whatever its size.

    Raises
    ------
    InvalidInput
        It is larger; says so in a few words.
    OSError
        Where it is no regular file, or cannot be opened.
    OutputError
        A store that cannot be asked.
    """
    if is_address(path):
        return open_object(store_path(path), most_bytes or MAX_TABLE_BYTES)
    file: IO[bytes] = open(path, "rb", buffering, opener=_open_regular)  # noqa: SIM115 (as above)
    if most_bytes is not None and os.fstat(file.fileno()).st_size > most_bytes:
        file.close()
        raise larger_than(most_bytes)
    return file


def read_line(file: IO[bytes]) -> bytes:
    """Read a line of a file that somebody else may have made; raises InvalidInput of one that is too long."""
    line = file.readline(MAX_LINE_BYTES + 1)
    if len(line) > MAX_LINE_BYTES:
        raise too_long_line()
    return line


def too_long_line() -> InvalidInput:
    """Say in a few words that a line is too long."""
    return InvalidInput("a line is longer than {0} kB", MAX_LINE_BYTES >> 10)


def text_lines(file: IO[bytes], encoding: str) -> Iterator[str]:
    """Lines of such a file as text, with their ends as they are; raises as `read_line` does, or UnicodeDecodeError."""
    decode = codecs.getincrementaldecoder(encoding)().decode
    while line := read_line(file):
        text = decode(line)
        # A carriage return alone ends a line as well.
        yield from io.StringIO(text, newline="") if "\r" in text else (text,)
    decode(b"", True)


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


def read_limited(path: str | os.PathLike[str], most_bytes: int, *, named_by_user: bool = False) -> bytes:
    """Content of a file, or object, that somebody else may have made.

    Parameters
    ----------
    named_by_user : bool
        It may be a pipe or a device: who names one, such as ``/dev/stdin``, waits for what comes out of it.

    Raises
    ------
    InvalidInput
        Larger than that; says so in a few words, to be put into a message of what was read.
    OSError
        Where it cannot be read; an OutputError of a store.
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
        # A pipe, which has no size, or a file that grows.
        more = bytearray(data)
        while block := file.read(_BLOCK_BYTES):
            more += block
            if len(more) > most_bytes:
                raise larger_than(most_bytes)
    return bytes(more)


def read_existing(path: str | os.PathLike[str], most_bytes: int) -> bytes | None:
    """Content of a file, or object, as `read_limited` gives it; None where there is none.

    Raises
    ------
    InvalidInput, OutputError
        It is larger, or cannot be read; names it.
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
    """Content of files of one folder, or objects, as `read_existing` gives it; objects are asked for together."""
    if not (paths and is_address(paths[0])):
        return [read_existing(path, most_bytes) for path in paths]
    try:
        return get_each(paths, most_bytes)
    except InvalidInput as wrong:
        raise InvalidInput("folder {0}: cannot be read ({1})", paths[0].parent, wrong) from wrong


def write_whole(path: str | os.PathLike[str], data: bytes | Iterable[bytes], *, durable: bool = False) -> None:
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
        raise OutputError("folder {0}: cannot write {1} ({2})", target.parent, target.name, wrong.strerror) from wrong


def write_new(path: str | os.PathLike[str], data: bytes) -> bool:
    """Write a file or object unless it is there; of several writers at once, one does.

    Returns
    -------
    bool
        Whether it was written.

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
    """Remove a file or object, if it is there."""
    if is_address(path):
        remove(store_path(path))
    else:
        Path(path).unlink(missing_ok=True)


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
            with open_foreign(origin) as file:
                write_whole(target, iter(lambda: file.read(_BLOCK_BYTES), b""))
        except OSError as wrong:
            raise OutputError("image {0}: cannot be read ({1})", origin, wrong.strerror) from wrong


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
    """Hold a file's lock, unless another thread or process has it; whether it is held here.

    Raises
    ------
    OSError
        Where there can be no such file.
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
        return wrong.errno not in _HELD
    return True
