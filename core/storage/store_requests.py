"""Requests to object stores that end: within limits of bytes, names and time, and where the caller is interrupted.

fsspec asks stores over the network in a thread of its own; who waits here looks at what has come, and can be
interrupted. Stores that it asks in the caller's thread, such as the one in memory, are left to their own timeouts.
"""

# ruff: noqa: SLF001 (fsspec's asynchronous methods have an underscore before the names of the others)
from __future__ import annotations

import asyncio
import importlib
import time
from collections.abc import AsyncIterator, Awaitable, Sequence
from dataclasses import dataclass
from typing import IO, Any, Callable, NamedTuple

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

_PIECE_BYTES = 1 << 18
#: Bytes that a name counts as: about what it takes in an answer of S3.
_NAME_BYTES = 300


class StoreLimitError(Exception):
    """A store goes beyond a limit: a message to follow its address.

    Parameters
    ----------
    message : Message
    """

    def __init__(self, message: Message) -> None:
        super().__init__(message)
        self.message = message


class Entry(NamedTuple):
    """A name in a listing, and the size of its object."""

    name: str
    size_bytes: int
    is_folder: bool


@dataclass
class Moved:
    """Bytes that have come so far, and those that come or are sent without being counted."""

    come: int = 0
    uncounted: int = 0


def ask(store: Any, what: str, *arguments: Any, sent_bytes: int = 0, **options: Any) -> Any:
    """Call a method of a filesystem of fsspec's by its name.

    Parameters
    ----------
    sent_bytes : int
        How much is sent, which takes its time.

    Raises
    ------
    StoreLimitError
        Nothing comes of it.
    Exception
        As the store's library raises.
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
        It is larger; says so in a few words.
    """
    if store.async_impl:
        _ended(store, lambda moved: _copied(store, key, file, most_bytes, moved))
        return
    if (store.info(key)["size"] or 0) > most_bytes:
        raise larger_than(most_bytes)
    file.write(store.cat_file(key))


def fetch_range(store: Any, key: str, start: int, length: int, file: IO[bytes]) -> None:
    """Copy part of an object into a file, no more than was asked for."""
    if store.async_impl:
        _ended(store, lambda moved: _copied_range(store, key, start, length, file, moved))
    else:
        file.write(store.cat_file(key, start=start, end=start + length))


def fetch_each(store: Any, keys: Sequence[str], files: Sequence[IO[bytes]], most_bytes: int) -> list[bool]:
    """Copy objects into files, several at once; whether each was there."""

    async def copy_existing(key: str, file: IO[bytes], moved: Moved, turn: asyncio.Semaphore) -> bool:
        async with turn:
            try:
                await _copied(store, key, file, most_bytes, moved)
            except FileNotFoundError:
                return False
            # Small ones take a moment, too.
            moved.come += MIN_STORE_BYTES_PER_S
            return True

    async def all_copied(moved: Moved) -> list[bool]:
        # 16 requests at a time.
        turn = asyncio.Semaphore(16)
        return await asyncio.gather(*(copy_existing(key, file, moved, turn) for key, file in zip(keys, files)))

    found: list[bool] = _ended(store, all_copied)
    return found


def entries(store: Any, key: str) -> list[Entry]:
    """Names right inside a folder.

    Raises
    ------
    FileNotFoundError
        There is nothing.
    StoreLimitError
        There are more than `MAX_STORE_NAMES`.
    """
    store.invalidate_cache()
    if _is_s3(store):
        listed: list[Entry] = _ended(store, lambda moved: _pages(store, key, moved))
        if not listed and "/" in key:
            raise FileNotFoundError(key)
        return listed
    # Of others nothing is seen to come before all has; of those by HTTP it is one page, which is limited.
    uncounted = 0 if _is_http(store) else MAX_STORE_NAMES * _NAME_BYTES
    found = ask(store, "ls", key, detail=True, sent_bytes=uncounted)
    return [_entry(one) for one in found]


def larger_than(most_bytes: int) -> InvalidInput:
    """Say of a file in a few words that it is too large."""
    return InvalidInput("larger than {0:,.0f} MB", most_bytes / 1000000.0)


# --- Waiting


def _ended(store: Any, work: Callable[[Moved], Awaitable[Any]], moved: Moved | None = None) -> Any:
    """Result of what runs in fsspec's thread; it is cancelled where nothing comes, or the caller is interrupted."""
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
    """Raises StoreLimitError where too little has come, or all takes too long."""

    def __init__(self, moved: Moved) -> None:
        self._moved, self._before = moved, 0
        self._began_s = self._since_s = time.monotonic()

    def look(self) -> None:
        """Look at what has come."""
        moved, now_s = self._moved, time.monotonic()
        if now_s - self._began_s > MAX_STORE_S:
            raise StoreLimitError(Message("the answer has not ended within {0:,.0f} s", MAX_STORE_S))
        past_s = now_s - self._since_s
        if past_s > MAX_STORE_SILENCE_S + moved.uncounted / MIN_STORE_BYTES_PER_S:
            come = moved.come - self._before
            if come < MIN_STORE_BYTES_PER_S * past_s:
                raise StoreLimitError(Message("only {0:,} bytes have come within {1:,.0f} s", come, past_s))
            self._since_s, self._before = now_s, moved.come


# --- Bodies of objects


async def _copied(store: Any, key: str, file: IO[bytes], most_bytes: int, moved: Moved) -> None:
    async def copy() -> None:
        left = most_bytes
        async for piece in _pieces(store, key, None, most_bytes, moved):
            left -= len(piece)
            if left < 0:
                raise larger_than(most_bytes)
            file.write(piece)
            moved.come += len(piece)

    await _tried(copy, file)


async def _copied_range(store: Any, key: str, start: int, length: int, file: IO[bytes], moved: Moved) -> None:
    async def copy() -> None:
        left = length
        async for piece in _pieces(store, key, (start, start + length), length, moved):
            file.write(piece[:left])
            moved.come += len(piece)
            left -= len(piece)
            if left <= 0:
                # A store that heeds no range would go on.
                return

    await _tried(copy, file)


async def _tried(copy: Callable[[], Awaitable[None]], file: IO[bytes]) -> None:
    """Copy a body, and begin again where it breaks off."""
    # A body that breaks off is requested three times.
    for tries_left in reversed(range(3)):
        try:
            return await copy()
        except InvalidInput:  # noqa: PERF203 (a try is a request)
            raise
        except Exception:
            # Where nothing has come the store's library has tried again by itself.
            if not tries_left or not file.tell():
                raise
            file.seek(0)
            file.truncate()
    return None


async def _pieces(
    store: Any, key: str, within: tuple[int, int] | None, most_bytes: int, moved: Moved
) -> AsyncIterator[bytes]:
    """Body of an object, or of a range of it."""
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
    """Names in a listing of S3's, page by page."""
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
        # It is one already, raised from what has its reason, where s3fs has made it.
        if (made := errors.translate_boto_error(wrong)) is wrong:
            raise
        raise made from wrong
    return found


def _entry(one: dict[str, Any]) -> Entry:
    return Entry(one["name"].rstrip("/").rpartition("/")[2], int(one["size"] or 0), one["type"] != "file")


# --- All other answers


async def _limit_answers(store: Any) -> None:
    """Have a store of S3's read answers up to a limit only; those by HTTP do so from the start."""
    if _is_s3(store):
        client = await store.set_session()

        async def send(request: Any, **_: Any) -> Any:
            return await _sent(client, request)

        # Once: the name is known from then on.
        client.meta.events.register("before-send.s3", send, unique_id="terrainav-limit")


async def _sent(client: Any, request: Any) -> Any:
    """Answer of a request of botocore's, read up to the limit unless it is the body of an object."""
    errors = importlib.import_module("botocore.exceptions")
    is_object, request.stream_output = request.stream_output, True
    answer = await client._endpoint.http_session.send(request)
    if not is_object or answer.status_code >= 300:
        try:
            # Where botocore itself keeps what it has read.
            answer._content = await limited(answer.raw.content)
        except (asyncio.TimeoutError, OSError) as wrong:
            raise errors.ConnectionClosedError(error=wrong, request=request, endpoint_url=request.url) from wrong
    return answer


async def limited(content: Any) -> bytes:
    """All of what comes from a stream of aiohttp's; raises StoreLimitError."""
    found = bytearray()
    while piece := await content.read(_PIECE_BYTES):
        found += piece
        if len(found) > MAX_STORE_ANSWER_BYTES:
            raise StoreLimitError(Message("the answer is larger than {0} MB", MAX_STORE_ANSWER_BYTES >> 20))
    return bytes(found)


async def http_client(**options: Any) -> Any:
    """Client of a store by HTTP, which reads answers up to the limit, and is not led to other servers."""
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
