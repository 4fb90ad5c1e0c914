"""Options for clients of object stores and web servers that refuse redirects to other hosts.

A store receives the user's signed requests and images. Without these options, the store's Python libraries would send
both to any host that an answer names.
"""

from __future__ import annotations

import errno
import re
from functools import lru_cache
from importlib import import_module
from typing import Any

from ..errors import OutputError

_ELSEWHERE = "redirect to another host"


class Redirected(OSError):
    """A server redirects a request to another host."""


def is_redirect(wrong: BaseException) -> bool:
    """Whether an error of a store's library, or one of its causes, stems from a refused redirect."""
    # Words of this module, of S3, and of HTTP (answers to HEAD have no body).
    words = rf"{_ELSEWHERE}|PermanentRedirect|TemporaryRedirect|Moved Permanently|Temporary Redirect"
    each: BaseException | None = wrong
    # Chains of causes may be circular.
    seen: set[int] = set()
    while each is not None and id(each) not in seen:
        seen.add(id(each))
        if isinstance(each, Redirected) or re.search(words, f"{type(each).__name__} {each}"):
            return True
        each = each.__cause__
    return False


def led_elsewhere(place: str) -> OutputError:
    """Error for a store or server that redirects to another host."""
    return OutputError("{0}: its server leads to another one, which is not asked (name that one if it is meant)", place)


def unredirected(kind: str) -> dict[str, Any]:
    """Return fsspec options for a scheme, such as ``s3``, merged with the options in the user's configuration."""
    if kind in ("s3", "s3a"):
        return {"config_kwargs": {**_configured("s3", "config_kwargs"), "http_session_cls": s3_session}}
    if kind in ("gs", "gcs"):
        traces = {"trace_configs": [same_server()]}
        return {"session_kwargs": {**_configured("gs", "session_kwargs"), **traces}}
    return {}


def follow_none(store: Any) -> Any:
    """Turn off redirects of an fsspec file system; needed for Azure, which has no option. Return the file system."""
    clients = getattr(store, "service_client", None) if type(store).__module__.startswith("adlfs") else None
    for client in clients if isinstance(clients, list) else [clients] if clients is not None else []:
        # Clients of containers and blobs inherit these policies.
        policies = client._pipeline._impl_policies  # noqa: SLF001
        following = [one for one in policies if hasattr(one, "configure_redirects")]
        if not following:
            raise Redirected(errno.EREMOTE, _ELSEWHERE)
        for one in following:
            one.allow = False
    return store


def _configured(kind: str, name: str) -> dict[str, Any]:
    """Return the user's fsspec setting, which an option would otherwise replace."""
    fsspec: Any = import_module("fsspec")
    names = fsspec.get_filesystem_class(kind).protocol
    found: dict[str, Any] = {}
    for one in (names,) if isinstance(names, str) else names:
        found.update(fsspec.config.conf.get(one, {}).get(name) or {})
    return found


def s3_session(**options: Any) -> Any:
    """Create an aiobotocore session that leaves redirects to botocore, which follows them to AWS regions only."""
    return _s3_session_class()(**options)


@lru_cache(maxsize=1)
def _s3_session_class() -> Any:
    base: Any = import_module("aiobotocore.httpsession").AIOHTTPSession
    failed: Any = import_module("botocore.exceptions").HTTPClientError
    # Fail if the overridden method is missing, in which case nothing would be refused.
    _ = base._get_session  # noqa: SLF001

    class Session(base):  # type: ignore[misc]
        async def send(self, request: Any) -> Any:
            try:
                return await super().send(request)
            except failed as wrong:
                # Unwrap a Redirected error, which would otherwise be retried like any error of a request.
                raise (redirect if isinstance(redirect := wrong.kwargs.get("error"), Redirected) else wrong) from None

        async def _get_session(self, proxy_url: str | None) -> Any:
            return _Unredirected(await super()._get_session(proxy_url))

    return Session


class _Unredirected:
    """An aiohttp session that follows no redirects."""

    def __init__(self, session: Any) -> None:
        self._session = session

    async def request(self, *arguments: Any, **options: Any) -> Any:
        answer = await self._session.request(*arguments, **{**options, "allow_redirects": False})
        # S3 states the region of a bucket in this header.
        if answer.status in (301, 302, 303, 307, 308) and "x-amz-bucket-region" not in answer.headers:
            # botocore would ask for the region of the bucket and be redirected again, endlessly.
            answer.close()
            raise Redirected(errno.EREMOTE, _ELSEWHERE)
        return answer


@lru_cache(maxsize=1)
def same_server() -> Any:
    """Create an aiohttp trace that refuses redirects to other hosts and allows redirects to the same host."""
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
