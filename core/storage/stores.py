"""Where files lie: folders of this machine, and object stores by the addresses of fsspec.

What takes a folder takes such an address, too: `store_path` makes of it a path that has pathlib's words. Those of
object stores are universal_pathlib's, which is imported where an address asks for it. An object is put whole or not at
all.
"""

from __future__ import annotations

import errno
import io
import logging
import os
import re
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any, Union

from ..addresses import holds_credentials
from ..errors import InvalidInput, Message, OutputError, TerrAInavError
from ..external.importing import imported
from ..limits import MAX_MISSION_BYTES
from .redirects import follow_none, is_redirect, led_elsewhere, unredirected
from .store_requests import (
    Entry,
    StoreLimitError,
    ask,
    entries,
    fetch,
    fetch_each,
    fetch_range,
    http_client,
)

#: A folder or file of this machine or of an object store, as text or as a path.
Address = Union[str, "os.PathLike[str]"]

#: A letter alone is a drive.
_SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9+.-]+)://")
#: What brings all that S3 needs.
_EXTRA = "'terrainav[cluster]'"
#: Modules that know a store, where fsspec itself does not, and what to install for them, by the scheme of addresses.
_PACKAGES = {
    **dict.fromkeys(("s3", "s3a"), ("s3fs", _EXTRA)),
    **dict.fromkeys(("gs", "gcs"), ("gcsfs", "gcsfs")),
    **dict.fromkeys(("az", "abfs", "abfss", "adl"), ("adlfs", "adlfs")),
}
#: What stores say where nobody has told who asks: none of these quotes a key.
_NO_CREDENTIALS = re.compile(
    r"credential|token|anonymous|unauthori[sz]ed|not authenticated|signing|connection string", re.IGNORECASE
)
_EXPIRED = re.compile(r"expired", re.IGNORECASE)
_REFUSED = re.compile(
    r"forbidden|access denied|accessdenied|permission|failed to authenticate|not authori[sz]ed", re.IGNORECASE
)
_NOT_THERE = re.compile(
    r"nosuchbucket|no such bucket|bucket does not exist|not ?found|404|invalid ?(resource|bucket) ?name",
    re.IGNORECASE,
)


def is_address(place: Address) -> bool:
    """Whether a place is one of an object store, by its address or as such a path."""
    if isinstance(place, str):
        found = _SCHEME.match(place)
        return found is not None and found[1].lower() not in ("file", "local")
    return not isinstance(place, Path) and hasattr(place, "storage_options")


def place_kind(place: Address) -> Message:
    """Word for a place in messages."""
    return Message("address") if is_address(place) else Message("folder")


def check_no_credentials(place: object, what: str, instead: str, field: str = "") -> None:
    """Refuse an address of a store or a cluster that holds a user's name, a password, a key or a signature.

    Parameters
    ----------
    place : str or path
        What is no address is left alone.
    what, instead : str
        What it is, and where credentials are taken from instead, as the error says it.
    field : str
        As of errors.

    Raises
    ------
    InvalidInput
        Quotes nothing of the address but its scheme.
    """
    if holds_credentials(str(place)):
        raise InvalidInput(
            "{0} {1}://…: no user name, password, key or signature may stand in it ({2})",
            what,
            str(place).partition(":")[0],
            instead,
            field=field,
        )


def store_path(place: Address) -> Path:
    """Path of a folder or file of this machine, or of an address such as ``s3://bucket/folder``.

    A path of an object store is none of pathlib's, but has its words, as far as a store knows what they mean.

    Raises
    ------
    InvalidInput
        An address of a kind that fsspec does not know, or with credentials in it, which are not quoted.
    OutputError
        A package that it needs is missing, or there are no credentials.
    """
    check_no_credentials(place, "address", Message("credentials are taken from where the store's own tools have them"))
    if not isinstance(place, str):
        return place if is_address(place) else Path(place)  # type: ignore[return-value]
    scheme = _SCHEME.match(place)
    if scheme is None:
        return Path(place)
    kind = scheme[1].lower()
    if not is_address(place):
        return Path(place[scheme.end() :])
    upath, fsspec = _imported("upath"), _imported("fsspec")
    if kind not in fsspec.available_protocols():
        raise InvalidInput(
            "address {0!r}: must be a folder, or begin with {1}", place, "s3://, gs://, az:// or memory://"
        )
    if kind in _PACKAGES:
        _imported(*_PACKAGES[kind])
        # These libraries print pages where one line will do.
        for log in map(logging.getLogger, ("azure", "gcsfs")):
            if log.level == logging.NOTSET:
                log.setLevel(logging.CRITICAL)
    options = {"get_client": http_client} if kind in ("http", "https") else unredirected(kind)
    path: Path = upath.UPath(place, **options)
    with store_errors(path):
        # Asks for nothing, but makes what will ask.
        follow_none(path.fs)  # type: ignore[attr-defined]
    return path


def resolved(path: Path) -> Path:
    """Path without dots and links; of an address by HTTP the address, whose server would be asked where it leads."""
    by_http = is_address(path) and str(path).startswith(("http:", "https:"))
    return path if by_http else path.resolve()


def put(path: Path, data: bytes) -> None:
    """Put an object, whole or not at all; one that is there is replaced.

    Raises
    ------
    OutputError
    """
    with store_errors(path):
        ask(_filesystem(path), "pipe_file", _key(path), data, sent_bytes=len(data))


def put_new(path: Path, data: bytes) -> bool:
    """Put an object unless there is one; whether it was put. Of several that try at once, one does.

    Raises
    ------
    OutputError
    """
    with store_errors(path):
        try:
            ask(_filesystem(path), "pipe_file", _key(path), data, mode="create", sent_bytes=len(data))
        except FileExistsError as wrong:
            _let_go(wrong)
            return False
        except Exception as wrong:
            # S3 says so with the status of a condition that does not hold, of which s3fs makes no error of its own.
            if "PreconditionFailed" in repr(wrong) or "ConditionalRequestConflict" in repr(wrong):
                _let_go(wrong)
                return False
            raise
        return True


def get(path: Path, most_bytes: int = MAX_MISSION_BYTES) -> bytes | None:
    """Content of an object; None where there is none.

    Raises
    ------
    InvalidInput
        Larger than that; says so in a few words.
    OutputError
    """
    data = io.BytesIO()
    with store_errors(path):
        try:
            fetch(_filesystem(path), _key(path), data, most_bytes)
        except FileNotFoundError as wrong:
            _let_go(wrong)
            return None
    return data.getvalue()


def get_each(paths: Sequence[Path], most_bytes: int) -> list[bytes | None]:
    """Content of objects of one store, asked for together; None for each that is not there.

    Raises
    ------
    InvalidInput
        One of them is larger than that; says so in a few words.
    OutputError
    """
    if not paths:
        return []
    store = _filesystem(paths[0])
    if not store.async_impl:
        return [get(path, most_bytes) for path in paths]
    files = [io.BytesIO() for _ in paths]
    with store_errors(paths[0].parent):
        there = fetch_each(store, [_key(path) for path in paths], files, most_bytes)
    return [file.getvalue() if found else None for file, found in zip(files, there)]


def open_object(path: Path, most_bytes: int) -> IO[bytes]:
    """Object to be read as a file: a copy in the folder for temporary files, which has no name.

    Raises
    ------
    FileNotFoundError
        No such object.
    InvalidInput
        Larger than that; says so in a few words.
    OutputError
        A store that cannot be asked, or no room for the copy.
    """
    found = False
    try:
        file: IO[bytes] = tempfile.TemporaryFile(prefix="terrainav-")  # noqa: SIM115 (the caller closes it)
    except OSError as wrong:
        raise OutputError("folder {0}: cannot be written ({1})", tempfile.gettempdir(), wrong.strerror) from wrong
    try:
        with _ignore_missing(path):
            fetch(_filesystem(path), _key(path), file, most_bytes)
            found = True
        if not found:
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
        file.seek(0)
    except BaseException:
        file.close()
        raise
    return file


def get_range(path: Path, start: int, length: int) -> bytes:
    """Part of an object, no longer than was asked for.

    Raises
    ------
    OutputError
        Also where it is not there.
    """
    data = io.BytesIO()
    with store_errors(path):
        fetch_range(_filesystem(path), _key(path), start, length, data)
    return data.getvalue()


def list_sizes(folder: Path) -> dict[str, int]:
    """Bytes of the objects, or files, right inside a folder, by name; empty where there is none.

    Raises
    ------
    OutputError
    """
    if not is_address(folder):
        try:
            with os.scandir(folder) as entries_here:
                return {one.name: one.stat().st_size for one in entries_here if one.is_file()}
        except FileNotFoundError:
            return {}
        except OSError as wrong:
            raise OutputError("folder {0}: cannot be read ({1})", folder, wrong.strerror) from wrong
    found: list[Entry] = []
    with _ignore_missing(folder):
        found = entries(_filesystem(folder), _key(folder))
    return {one.name: one.size_bytes for one in found if not one.is_folder}


def list_folders(folder: Path) -> list[Path]:
    """Folders right inside a folder, by name: a store's names have slashes where those of others have folders.

    Raises
    ------
    OutputError
        Also where there is nothing at all.
    """
    with store_errors(folder):
        found = entries(_filesystem(folder), _key(folder))
    return [folder / name for name in sorted(one.name for one in found if one.is_folder)]


def is_file(path: Path) -> bool:
    """Whether there is such a file of this machine, or such an object.

    Raises
    ------
    OutputError
        Where a store does not say.
    """
    if not is_address(path):
        return path.is_file()
    kind = None
    with _ignore_missing(path):
        store = _filesystem(path)
        store.invalidate_cache()
        kind = ask(store, "info", _key(path))["type"]
    return bool(kind == "file")


def remove(path: Path) -> None:
    """Remove an object, if it is there.

    Raises
    ------
    OutputError
    """
    with _ignore_missing(path):
        ask(_filesystem(path), "rm_file", _key(path))


@contextmanager
def store_errors(path: Path) -> Iterator[None]:
    """Say in one line what a store refuses, in no words that may quote a key.

    Raises
    ------
    OutputError
    """
    try:
        yield
    except TerrAInavError:
        raise
    except Exception as wrong:  # noqa: BLE001  (each store's library has errors of its own)
        problem = _problem(path, wrong)
        _let_go(wrong)
    else:
        return
    # What was raised may quote a key.
    raise problem from None


@contextmanager
def _ignore_missing(path: Path) -> Iterator[None]:
    """The same, and go on after what is done where there is no such object."""
    with store_errors(path):
        try:
            yield
        except FileNotFoundError as wrong:
            if is_redirect(wrong):
                raise
            _let_go(wrong)


def _let_go(wrong: Exception) -> None:
    """Let go of the frames that an error was raised through.

    fsspec's own refers to the error, in a circle that would keep all callers and what they hold, such as loaders with
    worker processes, until garbage is collected.
    """
    wrong.__traceback__ = None


def _problem(path: Path, wrong: Exception) -> OutputError:
    """One line for what a store's library has raised."""
    what, root = str(path), _root(path)
    if isinstance(wrong, StoreLimitError):
        return OutputError("{0}: {1}", what, wrong.message)
    said = f"{type(wrong).__name__} {wrong}"
    if is_redirect(wrong):
        return led_elsewhere(what)
    if _EXPIRED.search(said):
        return OutputError(
            "{0}: the credentials have expired: new ones are taken from where the store's own tools have them",
            what,
        )
    if isinstance(wrong, PermissionError) or _REFUSED.search(said):
        return OutputError("{0}: access is refused: the credentials do not allow it", what)
    if _NO_CREDENTIALS.search(said):
        return OutputError("{0}: no valid credentials: they are taken from where the store's own tools have them", what)
    if isinstance(wrong, FileNotFoundError) or _NOT_THERE.search(said):
        return OutputError("{0}: is not there, or {1} is not", what, root, remedy="make the bucket first")
    known = isinstance(wrong, OSError) and wrong.strerror
    return OutputError("{0}: cannot be reached ({1})", what, str(known or type(wrong).__name__)[:120])


def _root(path: Path) -> str:
    """Scheme and bucket of an address."""
    scheme, _, rest = str(path).partition("://")
    return f"{scheme}://{rest.partition('/')[0]}"


def _filesystem(path: Any) -> Any:
    store = path.fs
    if getattr(store, "_pid", os.getpid()) == os.getpid():
        return follow_none(store)
    # What asks a store is of one process; those that were forked from it make their own.
    return follow_none(type(store)(**path.storage_options))


def _key(path: Any) -> str:
    return str(path.path)


def _imported(name: str, package: str = _EXTRA) -> Any:
    try:
        return imported(name)
    except ImportError as missing:
        raise OutputError(
            "addresses of object stores: {0} cannot be imported ({1})",
            name,
            missing,
            remedy=Message("get it with: pip install {0}", package),
        ) from missing
