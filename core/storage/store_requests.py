"""Requests to object stores that are interruptible and limited in bytes, names and time.

fsspec communicates with network stores in a separate thread; functions here wait for this thread, watch the progress,
and can be interrupted. Stores that run in the caller's thread, such as the in-memory store, have only built-in
timeouts. asyncio takes long to import, so it is imported where used.
"""

# ruff: noqa: SLF001 (names of fsspec's asynchronous methods begin with an underscore)
from __future__ import annotations

import importlib
import time
from collections.abc import AsyncIterator, Awaitable, Sequence
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING, Any, Callable, NamedTuple

from ..errors import InvalidInput, Message
from ..limits import (
    MAX_STORE_ANSWER_BYTES,
    MAX_STORE_NAMES,
    MAX_STORE_S,
    MAX_STORE_SILENCE_S,
    MIN_STORE_BYTES_PER_S,
)
from ..waiting import wait_until_done
from .redirects import same_server

if TYPE_CHECKING:
    import asyncio

_PIECE_BYTES = 1 << 18
#: Bytes counted for a name, about as many as it takes in an answer of S3.
_NAME_BYTES = 300


class StoreLimitError(Exception):
    """A store exceeds a limit.

    Parameters
    ----------
    message : Message
        Text that follows the store's address.
    """

    def __init__(self, message: Message) -> None:
        super().__init__(message)
        self.message = message


class Entry(NamedTuple):
    """A name in a listing, with the size of its object."""

    name: str
    size_bytes: int
    is_folder: bool


@dataclass
class Moved:
    """Number of bytes received so far, and of bytes whose transfer, in either direction, cannot be observed."""

    come: int = 0
    uncounted: int = 0


def ask(store: Any, what: str, *arguments: Any, sent_bytes: int = 0, **options: Any) -> Any:
    """Call a method of an fsspec file system by name.

    Parameters
    ----------
    store : fsspec file system
    what : str
        Name of the method.
    sent_bytes : int
        Size of the request, which extends the time limit.

    Raises
    ------
    StoreLimitError
        The request takes too long.
    Exception
        As raised by the store's library.
    """
    if not store.async_impl:
        return getattr(store, what)(*arguments, **options)
    method = getattr(store, f"_{what}")
    return _ended(store, lambda _: method(*arguments, **options), Moved(uncounted=sent_bytes))


def fetch(store: Any, key: str, file: IO[bytes], most_bytes: int) -> None:
    """Copy an object into a file.

    Raises
    ------
    InvalidInput
        The object is larger; the message has a few words.
    """
    if store.async_impl:
        _ended(store, lambda moved: _copy_object(store, key, file, most_bytes, moved))
        return
    if (store.info(key)["size"] or 0) > most_bytes:
        raise larger_than(most_bytes)
    file.write(store.cat_file(key))


def fetch_range(store: Any, key: str, start: int, length: int, file: IO[bytes]) -> None:
    """Copy a range of an object into a file."""
    if store.async_impl:
        _ended(store, lambda moved: _copy_range(store, key, start, length, file, moved))
    else:
        file.write(store.cat_file(key, start=start, end=start + length))


def fetch_each(store: Any, keys: Sequence[str], files: Sequence[IO[bytes]], most_bytes: int) -> list[bool]:
    """Copy objects into files, several at once; return whether each exists."""
    import asyncio

    async def copy_existing(key: str, file: IO[bytes], moved: Moved, turn: asyncio.Semaphore) -> bool:
        async with turn:
            try:
                await _copy_object(store, key, file, most_bytes, moved)
            except FileNotFoundError:
                return False
            # A small object takes time, too: count the bytes of one second.
            moved.come += MIN_STORE_BYTES_PER_S
            return True

    async def all_copied(moved: Moved) -> list[bool]:
        # At most 16 requests at a time.
        turn = asyncio.Semaphore(16)
        return await asyncio.gather(*(copy_existing(key, file, moved, turn) for key, file in zip(keys, files)))

    found: list[bool] = _ended(store, all_copied)
    return found


def entries(store: Any, key: str) -> list[Entry]:
    """List a folder.

    Raises
    ------
    FileNotFoundError
        There is no such folder.
    StoreLimitError
        The folder holds more than `MAX_STORE_NAMES`.
    """
    store.invalidate_cache()
    if _is_s3(store):
        listed: list[Entry] = _ended(store, lambda moved: _pages(store, key, moved))
        if not listed and "/" in key:
            raise FileNotFoundError(key)
        return listed
    # Other stores report no progress. An HTTP listing is a single page, whose size is limited.
    uncounted = 0 if _is_http(store) else MAX_STORE_NAMES * _NAME_BYTES
    found = ask(store, "ls", key, detail=True, sent_bytes=uncounted)
    return [_entry(one) for one in found]


def larger_than(most_bytes: int) -> InvalidInput:
    """Error for a file that is too large, in a few words."""
    return InvalidInput("larger than {0:,.0f} MB", most_bytes / 1000000.0)


# --- Waiting


def _ended(store: Any, work: Callable[[Moved], Awaitable[Any]], moved: Moved | None = None) -> Any:
    """Run a coroutine in fsspec's thread; cancel it if it stalls or the caller is interrupted."""
    import asyncio

    moved = moved or Moved()

    async def limited_work() -> Any:
        await _limit_answers(store)
        return await work(moved)

    future = asyncio.run_coroutine_threadsafe(limited_work(), store.loop)
    try:
        wait_until_done(future, _Watch(moved).look)
    except BaseException:
        future.cancel()
        raise
    return future.result()


class _Watch:
    """Check of progress; raises StoreLimitError if too few bytes arrive or the request takes too long.

    Time during which this process was suspended does not count.
    """

    def __init__(self, moved: Moved) -> None:
        self._moved, self._before = moved, 0
        self._began_s = self._since_s = self._looked_s = time.monotonic()

    def look(self) -> None:
        """Check the progress; called several times a second."""
        moved, now_s = self._moved, time.monotonic()
        # Longer gaps between checks mean that the process was suspended, as even a busy machine runs it sooner.
        if (stopped_s := now_s - self._looked_s) > 5.0:
            self._began_s += stopped_s
            self._since_s += stopped_s
        self._looked_s = now_s
        if now_s - self._began_s > MAX_STORE_S:
            raise StoreLimitError(Message("the answer has not ended within {0:,.0f} s", MAX_STORE_S))
        past_s = now_s - self._since_s
        if past_s > MAX_STORE_SILENCE_S + moved.uncounted / MIN_STORE_BYTES_PER_S:
            received = moved.come - self._before
            if received < MIN_STORE_BYTES_PER_S * past_s:
                raise StoreLimitError(Message("only {0:,} bytes have come within {1:,.0f} s", received, past_s))
            self._since_s, self._before = now_s, moved.come


# --- Bodies of objects


async def _copy_object(store: Any, key: str, file: IO[bytes], most_bytes: int, moved: Moved) -> None:
    async def copy() -> None:
        left = most_bytes
        async for piece in _pieces(store, key, None, most_bytes, moved):
            left -= len(piece)
            if left < 0:
                raise larger_than(most_bytes)
            file.write(piece)
            moved.come += len(piece)

    await _copy_with_retries(copy, file)


async def _copy_range(store: Any, key: str, start: int, length: int, file: IO[bytes], moved: Moved) -> None:
    async def copy() -> None:
        left = length
        async for piece in _pieces(store, key, (start, start + length), length, moved):
            file.write(piece[:left])
            moved.come += len(piece)
            left -= len(piece)
            if left <= 0:
                # Stop here, as a store that ignores the range sends more.
                return

    await _copy_with_retries(copy, file)


async def _copy_with_retries(copy: Callable[[], Awaitable[None]], file: IO[bytes]) -> None:
    """Copy a body; if it breaks off, start again, up to three attempts in all."""
    for tries_left in reversed(range(3)):
        try:
            return await copy()
        except InvalidInput:  # noqa: PERF203 (a try is a request)
            raise
        except Exception:
            # If nothing arrived, the store's library has already retried.
            if not tries_left or not file.tell():
                raise
            file.seek(0)
            file.truncate()
    return None


async def _pieces(
    store: Any, key: str, within: tuple[int, int] | None, most_bytes: int, moved: Moved
) -> AsyncIterator[bytes]:
    """Yield the body of an object, or a range of it."""
    headers = {} if within is None else {"Range": f"bytes={within[0]}-{within[1] - 1}"}
    if _is_s3(store):
        bucket, name, version = store.split_path(key)
        versions = {"VersionId": version} if version else {}
        answer = await store._call_s3("get_object", Bucket=bucket, Key=name, **headers, **versions)
        body = answer["Body"]
        try:
            while piece := await body.read(_PIECE_BYTES):
                yield piece
        finally:
            body.close()
    elif _is_http(store):
        session = await store.set_session()
        options = {**store.kwargs, "headers": {**store.kwargs.get("headers", {}), **headers}}
        async with session.get(store.encode_url(key), **options) as answer:
            if answer.status == 404:
                raise FileNotFoundError(key)
            answer.raise_for_status()
            if within is not None and within[0] and answer.status != 206:
                raise OSError("the server sends whole files only")
            while piece := await answer.content.read(_PIECE_BYTES):
                yield piece
    else:
        size = (await store._info(key))["size"] if within is None else within[1] - within[0]
        if size > most_bytes:
            raise larger_than(most_bytes)
        moved.uncounted += size
        start, end = within or (None, None)
        yield await store._cat_file(key, start=start, end=end)


# --- Listings


async def _pages(store: Any, key: str, moved: Moved) -> list[Entry]:
    """List a folder of S3 page by page."""
    errors = importlib.import_module("s3fs.errors")
    bucket, prefix, _ = store.split_path(key)
    found = []
    try:
        async for one in store._iterdir(bucket, prefix=prefix.rstrip("/") + "/" if prefix else ""):
            found.append(_entry(one))
            moved.come += _NAME_BYTES
            if len(found) > MAX_STORE_NAMES:
                raise StoreLimitError(Message("it holds more than {0:,} objects", MAX_STORE_NAMES))
    except StoreLimitError:
        raise
    except Exception as wrong:
        # The function returns errors that s3fs has already translated unchanged.
        if (made := errors.translate_boto_error(wrong)) is wrong:
            raise
        raise made from wrong
    return found


def _entry(one: dict[str, Any]) -> Entry:
    return Entry(one["name"].rstrip("/").rpartition("/")[2], int(one["size"] or 0), one["type"] != "file")


# --- All other answers


async def _limit_answers(store: Any) -> None:
    """Limit the size of S3's answers; `http_client` does this for HTTP stores."""
    if _is_s3(store):
        client = await store.set_session()

        async def send(request: Any, **_: Any) -> Any:
            return await _send_limited(client, request)

        # The unique_id prevents a second registration.
        client.meta.events.register("before-send.s3", send, unique_id="terrainav-limit")


async def _send_limited(client: Any, request: Any) -> Any:
    """Send a botocore request; read the answer up to the limit, unless it is the body of an object."""
    import asyncio

    errors = importlib.import_module("botocore.exceptions")
    is_object, request.stream_output = request.stream_output, True
    answer = await client._endpoint.http_session.send(request)
    if not is_object or answer.status_code >= 300:
        try:
            # botocore caches a body in this attribute.
            answer._content = await limited(answer.raw.content)
        except (asyncio.TimeoutError, OSError) as wrong:
            raise errors.ConnectionClosedError(error=wrong, request=request, endpoint_url=request.url) from wrong
    return answer


async def limited(content: Any) -> bytes:
    """Read an aiohttp stream to its end; raises StoreLimitError for answers above the limit."""
    found = bytearray()
    while piece := await content.read(_PIECE_BYTES):
        found += piece
        if len(found) > MAX_STORE_ANSWER_BYTES:
            raise StoreLimitError(Message("the answer is larger than {0} MB", MAX_STORE_ANSWER_BYTES >> 20))
    return bytes(found)


async def http_client(**options: Any) -> Any:
    """Create the client of an HTTP store, which limits answers and refuses redirects to other servers."""
    import aiohttp

    class Limited(aiohttp.ClientResponse):
        async def read(self) -> bytes:
            if self._body is None:
                self._body = await limited(self.content)
            return self._body

    traces = [*options.pop("trace_configs", ()), same_server()]
    return aiohttp.ClientSession(response_class=Limited, trace_configs=traces, **options)


def _is_s3(store: Any) -> bool:
    return hasattr(store, "_call_s3")


def _is_http(store: Any) -> bool:
    return getattr(store, "get_client", None) is http_client
