"""What asks object stores and web servers of datasets is told to follow none of their redirects to other hosts.

A store is trusted with what the user has: credentials that sign, and the images that are put there. Its libraries for
Python would send both to whatever host its answers name.
"""

from __future__ import annotations

import errno
import re
from functools import lru_cache
from importlib import import_module
from typing import Any

from ..errors import OutputError

_ELSEWHERE = "redirect to another host"
#: Words of a redirect that is not followed: ours, S3's, and those of its codes where an answer has none, as to HEAD.
_REDIRECT = re.compile(rf"{_ELSEWHERE}|PermanentRedirect|TemporaryRedirect|Moved Permanently|Temporary Redirect")


class Redirected(OSError):
    """A server has led a request to another host."""


def is_redirect(wrong: BaseException) -> bool:
    """Whether an error of a store's library, or one that it was raised from, is of a redirect that is not followed."""
    each: BaseException | None = wrong
    # Libraries raise errors from themselves, too.
    seen: set[int] = set()
    while each is not None and id(each) not in seen:
        seen.add(id(each))
        if isinstance(each, Redirected) or _REDIRECT.search(f"{type(each).__name__} {each}"):
            return True
        each = each.__cause__
    return False


def led_elsewhere(place: str) -> OutputError:
    """Return the error of a store or server that leads to another one."""
    return OutputError("{0}: its server leads to another one, which is not asked (name that one if it is meant)", place)


def unredirected(kind: str) -> dict[str, Any]:
    """Return options of fsspec's for addresses of a kind, such as ``s3``, beside those that the user has set."""
    if kind in ("s3", "s3a"):
        return {"config_kwargs": {**_configured("s3", "config_kwargs"), "http_session_cls": s3_session}}
    if kind in ("gs", "gcs"):
        traces = {"trace_configs": [same_server()]}
        return {"session_kwargs": {**_configured("gs", "session_kwargs"), **traces}}
    return {}


def follow_none(store: Any) -> Any:
    """Return a file system of fsspec's; have one of Azure's follow no redirect, for which it has no option."""
    clients = getattr(store, "service_client", None) if type(store).__module__.startswith("adlfs") else None
    for client in clients if isinstance(clients, list) else [clients] if clients is not None else []:
        # Azure's clients of containers and blobs take these policies over.
        policies = client._pipeline._impl_policies  # noqa: SLF001
        following = [one for one in policies if hasattr(one, "configure_redirects")]
        if not following:
            raise Redirected(errno.EREMOTE, _ELSEWHERE)
        for one in following:
            one.allow = False
    return store


def _configured(kind: str, name: str) -> dict[str, Any]:
    """Return what the user's configuration of fsspec has, of which ours would take the place."""
    fsspec: Any = import_module("fsspec")
    names = fsspec.get_filesystem_class(kind).protocol
    found: dict[str, Any] = {}
    for one in (names,) if isinstance(names, str) else names:
        found.update(fsspec.config.conf.get(one, {}).get(name) or {})
    return found


def s3_session(**options: Any) -> Any:
    """Return a session of aiobotocore's that leaves redirects to botocore, which goes to AWS's regions alone."""
    return _s3_session_class()(**options)


@lru_cache(maxsize=1)
def _s3_session_class() -> Any:
    base: Any = import_module("aiobotocore.httpsession").AIOHTTPSession
    failed: Any = import_module("botocore.exceptions").HTTPClientError
    # What it overrides has to be there: else nothing would be refused, in silence.
    _ = base._get_session  # noqa: SLF001

    class Session(base):  # type: ignore[misc]
        async def send(self, request: Any) -> Any:
            try:
                return await super().send(request)
            except failed as wrong:
                # As any other error of a request it would be tried again.
                raise (redirect if isinstance(redirect := wrong.kwargs.get("error"), Redirected) else wrong) from None

        async def _get_session(self, proxy_url: str | None) -> Any:
            return _Unredirected(await super()._get_session(proxy_url))

    return Session


class _Unredirected:
    """Session of aiohttp's that follows no redirect."""

    def __init__(self, session: Any) -> None:
        self._session = session

    async def request(self, *arguments: Any, **options: Any) -> Any:
        answer = await self._session.request(*arguments, **{**options, "allow_redirects": False})
        # S3 names the region of a bucket in this header.
        if answer.status in (301, 302, 303, 307, 308) and "x-amz-bucket-region" not in answer.headers:
            # botocore would ask for the region of the bucket, and be led elsewhere again, without end.
            answer.close()
            raise Redirected(errno.EREMOTE, _ELSEWHERE)
        return answer


@lru_cache(maxsize=1)
def same_server() -> Any:
    """Return what ends a request of aiohttp's that is led to another host; a server may lead to itself."""
    aiohttp: Any = import_module("aiohttp")

    class Trace(aiohttp.TraceConfig):  # type: ignore[misc]
        def __reduce__(self) -> tuple[Any, ...]:
            return same_server, ()

    trace = Trace()
    trace.on_request_redirect.append(_refuse)
    return trace


async def _refuse(_session: Any, _context: Any, asked: Any) -> None:
    url, headers = asked.response.url, asked.response.headers
    target = url.join(type(url)(headers.get("Location") or headers.get("URI") or ""))
    same_port = target.port == url.port or (target.is_default_port() and url.is_default_port())
    if target.host != url.host or target.scheme not in (url.scheme, "https") or not same_port:
        raise Redirected(errno.EREMOTE, _ELSEWHERE)
