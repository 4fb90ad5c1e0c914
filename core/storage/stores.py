"""Folders on this machine, and in object stores by fsspec addresses.

Functions that accept a folder also accept such an address: `store_path` converts it to a path with pathlib's methods.
Paths in object stores come from universal_pathlib, which is imported on demand. Objects are written atomically.
"""

from __future__ import annotations

import errno
import io
import os
import re
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

#: A folder or file on this machine or in an object store, as text or path.
Address = Union[str, "os.PathLike[str]"]

#: A single letter is a drive.
_SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9+.-]+)://")
#: Name for pip that installs everything for S3.
_EXTRA = "'terrainav[cluster]'"
#: For each scheme, the module that extends fsspec, and the package to install.
_PACKAGES = {
    **dict.fromkeys(("s3", "s3a"), ("s3fs", _EXTRA)),
    **dict.fromkeys(("gs", "gcs"), ("gcsfs", "gcsfs")),
    **dict.fromkeys(("az", "abfs", "abfss", "adl"), ("adlfs", "adlfs")),
}


def is_address(place: Address) -> bool:
    """Whether a place is in an object store, given as an address or a path."""
    if isinstance(place, str):
        found = _SCHEME.match(place)
        return found is not None and found[1].lower() not in ("file", "local")
    return not isinstance(place, Path) and hasattr(place, "storage_options")


def place_kind(place: Address) -> Message:
    """Noun for a place in messages."""
    return Message("address") if is_address(place) else Message("folder")


def check_no_credentials(place: object, what: str, instead: str, field: str = "") -> None:
    """Refuse an address of a store or a cluster that holds a user name, a password, a key or a signature.

    Parameters
    ----------
    place : str or path
        Ignored unless it is an address.
    what, instead : str
        Noun for the address, and the proper origin of credentials, for the error.
    field : str
        See `TerrAInavError`.

    Raises
    ------
    InvalidInput
        Quotes only the scheme of the address.
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
    """Convert a path on this machine, or an address such as ``s3://bucket/folder``, to a path.

    A path in an object store is not a pathlib.Path, but has the methods that make sense for a store.

    Raises
    ------
    InvalidInput
        The address has a scheme unknown to fsspec, or contains credentials, which the message does not quote.
    OutputError
        A package is missing, or there are no credentials.
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
        import logging

        # These libraries log pages of text for an error that is reported in one line.
        for log in map(logging.getLogger, ("azure", "gcsfs")):
            if log.level == logging.NOTSET:
                log.setLevel(logging.CRITICAL)
    options = {"get_client": http_client} if kind in ("http", "https") else unredirected(kind)
    path: Path = upath.UPath(place, **options)
    with store_errors(path):
        # This creates the client, without a request.
        follow_none(path.fs)  # type: ignore[attr-defined]
    return path


def resolved(path: Path) -> Path:
    """Resolve dots and links of a path; HTTP addresses, which would need a request, are unchanged."""
    by_http = is_address(path) and str(path).startswith(("http:", "https:"))
    return path if by_http else path.resolve()


def put(path: Path, data: bytes) -> None:
    """Put an object atomically, replacing an earlier one.

    Raises
    ------
    OutputError
    """
    with store_errors(path):
        ask(_filesystem(path), "pipe_file", _key(path), data, sent_bytes=len(data))


def put_new(path: Path, data: bytes) -> bool:
    """Put an object unless it exists; return whether it was put. Of concurrent writers, only one succeeds.

    Raises
    ------
    OutputError
    """
    with store_errors(path):
        try:
            ask(_filesystem(path), "pipe_file", _key(path), data, mode="create", sent_bytes=len(data))
        except FileExistsError as wrong:
            _drop_frames(wrong)
            return False
        except Exception as wrong:
            # S3 reports a failed precondition, an error that s3fs does not translate.
            if "PreconditionFailed" in repr(wrong) or "ConditionalRequestConflict" in repr(wrong):
                _drop_frames(wrong)
                return False
            raise
        return True


def get(path: Path, most_bytes: int = MAX_MISSION_BYTES) -> bytes | None:
    """Read an object; None if it does not exist.

    Raises
    ------
    InvalidInput
        The object is larger than ``most_bytes``; the message has a few words.
    OutputError
    """
    data = io.BytesIO()
    with store_errors(path):
        try:
            fetch(_filesystem(path), _key(path), data, most_bytes)
        except FileNotFoundError as wrong:
            _drop_frames(wrong)
            return None
    return data.getvalue()


def get_each(paths: Sequence[Path], most_bytes: int) -> list[bytes | None]:
    """Read objects of one store concurrently; None for each that does not exist.

    Raises
    ------
    InvalidInput
        An object is larger than ``most_bytes``; the message has a few words.
    OutputError
    """
    if not paths:
        return []
    store = _filesystem(paths[0])
    if not store.async_impl:
        return [get(path, most_bytes) for path in paths]
    files = [io.BytesIO() for _ in paths]
    with store_errors(paths[0].parent):
        exists = fetch_each(store, [_key(path) for path in paths], files, most_bytes)
    return [file.getvalue() if found else None for file, found in zip(files, exists)]


def open_object(path: Path, most_bytes: int) -> IO[bytes]:
    """Copy an object to an anonymous temporary file, and return this file, open for reading.

    Raises
    ------
    FileNotFoundError
        There is no such object.
    InvalidInput
        The object is larger than ``most_bytes``; the message has a few words.
    OutputError
        The store fails, or the copy cannot be written.
    """
    import tempfile

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
    """Read a range of an object.

    Raises
    ------
    OutputError
        Also if the object does not exist.
    """
    data = io.BytesIO()
    with store_errors(path):
        fetch_range(_filesystem(path), _key(path), start, length, data)
    return data.getvalue()


def list_sizes(folder: Path) -> dict[str, int]:
    """Sizes in bytes of the objects or files in a folder, by name; empty if there is no such folder.

    Raises
    ------
    OutputError
    """
    if not is_address(folder):
        try:
            with os.scandir(folder) as scanned:
                return {one.name: one.stat().st_size for one in scanned if one.is_file()}
        except FileNotFoundError:
            return {}
        except OSError as wrong:
            raise OutputError("folder {0}: cannot be read ({1})", folder, wrong.strerror) from wrong
    found: list[Entry] = []
    with _ignore_missing(folder):
        found = entries(_filesystem(folder), _key(folder))
    return {one.name: one.size_bytes for one in found if not one.is_folder}


def list_folders(folder: Path) -> list[Path]:
    """Subfolders of a folder in a store, sorted by name.

    Raises
    ------
    OutputError
        Also if there is no such folder.
    """
    with store_errors(folder):
        found = entries(_filesystem(folder), _key(folder))
    return [folder / name for name in sorted(one.name for one in found if one.is_folder)]


def is_file(path: Path) -> bool:
    """Whether a file or object exists.

    Raises
    ------
    OutputError
        The store fails.
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
    """Remove an object, if it exists.

    Raises
    ------
    OutputError
    """
    with _ignore_missing(path):
        ask(_filesystem(path), "rm_file", _key(path))


@contextmanager
def store_errors(path: Path) -> Iterator[None]:
    """Convert errors of a store's library to an OutputError of one line, without words that may quote a key.

    Raises
    ------
    OutputError
    """
    try:
        yield
    except TerrAInavError:
        raise
    except Exception as wrong:  # noqa: BLE001  (each store's library has different errors)
        problem = _problem(path, wrong)
        _drop_frames(wrong)
    else:
        return
    # Do not chain the original error, which may quote a key.
    raise problem from None


@contextmanager
def _ignore_missing(path: Path) -> Iterator[None]:
    """Convert errors as `store_errors` does, but suppress the error if the object does not exist."""
    with store_errors(path):
        try:
            yield
        except FileNotFoundError as wrong:
            if is_redirect(wrong):
                raise
            _drop_frames(wrong)


def _drop_frames(wrong: Exception) -> None:
    """Drop the frames that an error holds.

    A frame of fsspec refers to the error. This cycle would keep all callers, such as loaders with worker processes,
    alive until garbage collection.
    """
    wrong.__traceback__ = None


def _problem(path: Path, wrong: Exception) -> OutputError:
    """Convert an error of a store's library to an OutputError of one line."""
    what, root = str(path), _root(path)
    if isinstance(wrong, StoreLimitError):
        return OutputError("{0}: {1}", what, wrong.message)
    words = f"{type(wrong).__name__} {wrong}".lower()
    if is_redirect(wrong):
        return led_elsewhere(what)
    if "expired" in words:
        return OutputError(
            "{0}: the credentials have expired: new ones are taken from where the store's own tools have them",
            what,
        )
    refused = "forbidden|access denied|accessdenied|permission|failed to authenticate|not authori[sz]ed"
    if isinstance(wrong, PermissionError) or re.search(refused, words):
        return OutputError("{0}: access is refused: the credentials do not allow it", what)
    anonymous = "credential|token|anonymous|unauthori[sz]ed|not authenticated|signing|connection string"
    if re.search(anonymous, words):
        return OutputError("{0}: no valid credentials: they are taken from where the store's own tools have them", what)
    missing = "nosuchbucket|no such bucket|bucket does not exist|not ?found|404|invalid ?(resource|bucket) ?name"
    if isinstance(wrong, FileNotFoundError) or re.search(missing, words):
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
    # Clients do not survive a fork.
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
