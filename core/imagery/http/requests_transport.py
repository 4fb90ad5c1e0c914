"""Transport of the headless core, based on requests and urllib3, with deadlines and cancelling."""

from __future__ import annotations

import io
import logging
import socket
import threading
import time
import weakref
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from http import HTTPStatus
from http.client import HTTPException, HTTPResponse
from typing import Any, Callable, NamedTuple
from urllib.parse import SplitResult, urlsplit

import requests
import urllib3
from requests.adapters import HTTPAdapter
from requests.utils import DEFAULT_CA_BUNDLE_PATH, select_proxy
from urllib3.connection import HTTPConnection, HTTPSConnection
from urllib3.connectionpool import HTTPConnectionPool, HTTPSConnectionPool

from ...errors import Cancelled
from ...limits import MAX_BODY_BYTES, MAX_FRAMING_BYTES
from .transport import (
    Response,
    Timeouts,
    TransportError,
    check_length,
    too_long,
    too_many_headers,
    unpacked,
    user_agent,
)

#: Most hosts with a pool of connections; subdomains and targets of redirects count.
_HOSTS = 64
#: Seconds between checks of running requests, as closing may take half a second at most.
_LOOK_S = 0.1


class _Host(NamedTuple):
    """Connections and headers for one host, determined once, as this takes longer than a request.

    ``prefix`` precedes the path of each request, as proxies need whole http URLs.
    """

    pool: HTTPConnectionPool
    headers: Mapping[str, str]
    prefix: str


class RequestsTransport:
    """Transport over urllib3's connection pools with the settings of requests.

    The library requests finds proxies and certificates of the environment once for each host. Each request then uses
    urllib3's pool directly, which takes two fifths of the processor time of a `requests.Session`.

    Parameters
    ----------
    connections : int
        Connections kept open to a host.
    timeouts : Timeouts
    max_body_bytes : int
        Longer bodies are refused.
    """

    def __init__(
        self,
        connections: int = 8,
        timeouts: Timeouts = Timeouts(),  # noqa: B008 (an immutable value)
        max_body_bytes: int = MAX_BODY_BYTES,
    ) -> None:
        self._timeouts = timeouts
        self._timeout = urllib3.Timeout(connect=timeouts.connect_s, read=timeouts.read_s)
        self._max_body_bytes = max_body_bytes
        self._watch = Watch()
        # Images do not compress further, and without an encoding Content-Length is the length of the image.
        self._headers = {
            "User-Agent": user_agent(),
            "Accept": "image/*,*/*;q=0.1",
            "Accept-Encoding": "identity",
        }
        self._session = requests.Session()
        self._adapter = _Adapter(connections, self._watch, max_body_bytes + MAX_FRAMING_BYTES)
        self._session.mount("http://", self._adapter)
        self._session.mount("https://", self._adapter)
        self._hosts: dict[tuple[str, str], _Host] = {}
        # Free connections and log filters even if `close` is not called.
        self._free = weakref.finalize(self, _free, self._session, _quiet(self._watch))

    def get(
        self,
        url: str,
        headers: Mapping[str, str] | None = None,
        *,
        origin: str = "",  # noqa: ARG002  (it sends no credentials)
    ) -> Response:
        """Return an answer of any status; see `Transport.get`."""
        problem: TransportError
        with self._watch.exchange(time.monotonic() + self._timeouts.whole_s) as exchange:
            try:
                return self._answer(urlsplit(url), headers or {})
            except TransportError as failure:
                problem = failure
            except (requests.RequestException, urllib3.exceptions.HTTPError, OSError, ValueError) as failure:
                problem = self._problem(failure, urlsplit(url).hostname)
        # Raised outside `except` so that an error that quotes the URL is not chained.
        if exchange.ended == "cancelled":
            raise Cancelled("cancelled while waiting for the network")
        if exchange.ended == "late":
            raise TransportError("no whole answer within {0:g} s", self._timeouts.whole_s, late=True)
        raise TransportError(problem, again=problem.again, away=problem.away, late=problem.late)

    def close(self) -> None:
        """Free the connections and end running requests."""
        self._watch.close()
        self._free()

    def _answer(self, parts: SplitResult, headers: Mapping[str, str]) -> Response:
        host = self._host(parts)
        path = host.prefix + (parts.path or "/")
        with closing(
            host.pool.urlopen(  # type: ignore[no-untyped-call]
                "GET",
                f"{path}?{parts.query}" if parts.query else path,
                headers={**host.headers, **headers},
                redirect=False,
                retries=False,
                assert_same_host=False,
                preload_content=False,
                timeout=self._timeout,
            )
        ) as answer:
            named = {name.lower(): value for name, value in answer.headers.items()}
            body = self._body(answer)
        # A 304 may state the length of the image it confirms (RFC 9110, 8.6).
        if answer.status != HTTPStatus.NOT_MODIFIED:
            # urllib3 before 2 accepts a body cut off by the end of the connection.
            check_length(len(body), named)
        return Response(answer.status, named, unpacked(body, named, self._max_body_bytes))

    def _host(self, parts: SplitResult) -> _Host:
        """Pool, headers and prefix for a URL's host, with the environment's proxy and certificates."""
        named = parts.scheme, parts.netloc
        found = self._hosts.get(named)
        if found is None:
            # urllib3 keeps as many pools and closes others, which must not be used here.
            if len(self._hosts) >= _HOSTS:
                self._hosts.clear()
            found = self._hosts[named] = self._opened(parts)
        return found

    def _opened(self, parts: SplitResult) -> _Host:
        request = requests.Request("GET", parts._replace(path="/", query="").geturl(), self._headers).prepare()
        url = str(request.url)
        settings = self._session.merge_environment_settings(url, {}, None, None, None)
        proxy = select_proxy(url, settings["proxies"])
        managers: Any = self._adapter.poolmanager
        if proxy:
            managers = self._adapter.proxy_manager_for(proxy if "://" in proxy else f"http://{proxy}")
        pool = managers.connection_from_url(url)
        # Name the default, too, as not every version of requests finds it here.
        bundle = DEFAULT_CA_BUNDLE_PATH if settings["verify"] is True else settings["verify"]
        self._adapter.cert_verify(pool, url, bundle, settings["cert"])  # type: ignore[no-untyped-call]
        # `request_url` returns the whole URL for a proxy, otherwise the path.
        prefix = str(self._adapter.request_url(request, settings["proxies"]))  # type: ignore[no-untyped-call]
        return _Host(pool, dict(request.headers), prefix.rstrip("/"))

    def _body(self, answer: urllib3.HTTPResponse) -> bytes:
        """Read the body without unpacking it; raise if it exceeds the limit."""
        chunks, size = [], 0
        # Do not use `stream`, which reads lines of any length from a chunked body.
        while chunk := answer.read(1 << 16, decode_content=False):
            chunks.append(chunk)
            size += len(chunk)
            if size > self._max_body_bytes:
                raise too_long(self._max_body_bytes)
        return b"".join(chunks)

    def _problem(self, failure: Exception, host: str | None) -> TransportError:
        """Error without the text of the libraries, which quotes the URL."""
        if isinstance(failure, (urllib3.exceptions.SSLError, requests.exceptions.SSLError)):
            return TransportError("no trusted connection to {0} (TLS)", host, again=False, away=True)
        # urllib3 wraps errors as arguments of others.
        wrapped = {type(one) for one in (failure, *failure.args)}
        if _EndlessError in wrapped:
            return too_long(self._max_body_bytes)
        if HTTPException in wrapped:
            return too_many_headers()
        if isinstance(failure, urllib3.exceptions.ProxyError):
            return TransportError("the proxy does not answer", away=True)
        # Check before TimeoutError, a base class of ConnectTimeoutError.
        if isinstance(failure, (urllib3.exceptions.NewConnectionError, urllib3.exceptions.ConnectTimeoutError)):
            late = isinstance(failure, urllib3.exceptions.ConnectTimeoutError)
            return TransportError("no connection to {0}", host, away=True, late=late)
        if isinstance(failure, urllib3.exceptions.TimeoutError):
            return TransportError("no answer from {0} for {1:g} s", host, self._timeouts.read_s, late=True)
        if isinstance(failure, (requests.exceptions.InvalidURL, urllib3.exceptions.LocationValueError)):
            return TransportError("the URL is not valid", again=False)
        return TransportError("connection to {0} was lost", host)


def _free(session: requests.Session, undo: Callable[[], None]) -> None:
    session.close()
    undo()


def _quiet(watch: Watch) -> Callable[[], None]:
    """Keep urllib3 from logging URLs of watched requests, which may hold keys; return a function that undoes it."""

    def others(_record: logging.LogRecord) -> bool:
        return not watch.is_active()

    loggers = [logging.getLogger(f"urllib3.{name}") for name in ("connection", "connectionpool", "response")]
    for logger in loggers:
        logger.addFilter(others)

    def undo() -> None:
        for logger in loggers:
            logger.removeFilter(others)

    # An abandoned request logs its URL while it ends.
    return lambda: watch.when_idle(undo)


class _Adapter(HTTPAdapter):
    """Adapter whose connections can be abandoned during a wait."""

    def __init__(self, connections: int, watch: Watch, max_answer_bytes: int) -> None:
        self._pools = _pool_classes(watch, max_answer_bytes)
        super().__init__(pool_connections=_HOSTS, pool_maxsize=connections)

    def init_poolmanager(self, *args: Any, **kwargs: Any) -> None:
        super().init_poolmanager(*args, **kwargs)  # type: ignore[no-untyped-call]
        self.poolmanager.pool_classes_by_scheme = self._pools

    def proxy_manager_for(self, proxy: str, **kwargs: Any) -> Any:
        manager = super().proxy_manager_for(proxy, **kwargs)  # type: ignore[no-untyped-call]
        manager.pool_classes_by_scheme = self._pools
        return manager


class _EndlessError(OSError):
    """An answer exceeds the limit."""


class _Counted(io.RawIOBase):
    """Stream of an answer from a socket that raises beyond a limit, as lines and chunks may claim any length."""

    def __init__(self, raw: io.RawIOBase, most_bytes: int) -> None:
        self._raw, self._left_bytes = raw, most_bytes

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int | None:
        count = self._raw.readinto(buffer)
        self._left_bytes -= count or 0
        if self._left_bytes < 0:
            raise _EndlessError
        return count

    def close(self) -> None:
        self._raw.close()
        super().close()


def _pool_classes(watch: Watch, max_answer_bytes: int) -> dict[str, type[HTTPConnectionPool]]:
    """Connection pools of urllib3 whose connections report their sockets to ``watch`` and limit their answers."""

    class Limited(HTTPResponse):
        def __init__(self, sock: Any, *args: Any, **kwargs: Any) -> None:
            super().__init__(sock, *args, **kwargs)
            whole = self.fp
            self.fp = io.BufferedReader(_Counted(whole.detach(), max_answer_bytes))

    class Watched:
        sock: Any
        response_class: Any = Limited

        def connect(self) -> None:
            watch.run(super().connect, self.close)  # type: ignore[misc]
            watch.attach(self.sock)

        def getresponse(self, *args: Any, **kwargs: Any) -> Any:
            watch.attach(self.sock)
            return super().getresponse(*args, **kwargs)  # type: ignore[misc]

        def close(self) -> None:
            super().close()  # type: ignore[misc]

    class Plain(Watched, HTTPConnection):
        pass

    class Secure(Watched, HTTPSConnection):
        pass

    class PlainPool(HTTPConnectionPool):
        ConnectionCls = Plain

    class SecurePool(HTTPSConnectionPool):
        ConnectionCls = Secure

    return {"http": PlainPool, "https": SecurePool}


class EndedError(OSError):
    """A request was abandoned before it had a connection."""


class Exchange:
    """A running request.

    Attributes
    ----------
    ended : str
        ``cancelled`` or ``late``; empty while the request goes on.
    """

    def __init__(self, deadline_s: float) -> None:
        self.ended = ""
        self._deadline_s = deadline_s
        self._socket: socket.socket | None = None

    def look(self, closed: bool) -> None:
        """Abandon the request if the transport is closed or the deadline past."""
        if not self.ended:
            if closed:
                self.ended = "cancelled"
            elif time.monotonic() > self._deadline_s:
                self.ended = "late"
        if self.ended and self._socket is not None:
            _shut_down(self._socket)

    def attach(self, waits_on: socket.socket | None) -> None:
        """Note the socket that the request waits on."""
        self._socket = waits_on
        if self.ended:
            raise EndedError(self.ended)


def _shut_down(waited_on: socket.socket) -> None:
    try:
        # Call the base class's method: a TLS socket's method drops state that another thread is reading.
        socket.socket.shutdown(waited_on, socket.SHUT_RDWR)
    except OSError:
        return  # already closed


class Watch:
    """The requests of one transport."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._running: set[Exchange] = set()
        self._thread: threading.Thread | None = None
        self._current = threading.local()
        self._closed = False
        self._when_idle: list[Callable[[], None]] = []

    @contextmanager
    def exchange(self, deadline_s: float) -> Iterator[Exchange]:
        """Watch the request that the calling thread makes in this context."""
        exchange = Exchange(deadline_s)
        self._current.exchange = exchange
        with self._lock:
            self._running.add(exchange)
            if self._thread is None:
                self._thread = threading.Thread(target=self._look, name="terrainav-watch", daemon=True)
                self._thread.start()
        try:
            yield exchange
        finally:
            with self._lock:
                # After this, the socket may serve another request.
                self._running.discard(exchange)
                calls = [] if self._running else self._when_idle
                self._when_idle = self._when_idle if self._running else []
            self._current.exchange = None
            for call in calls:
                call()

    def when_idle(self, call: Callable[[], None]) -> None:
        """Call a function when no request is running: now, or in the thread whose request ends last."""
        with self._lock:
            if self._running:
                self._when_idle.append(call)
                return
        call()

    def close(self) -> None:
        """Abandon all requests, running and future."""
        with self._lock:
            self._closed = True
            for exchange in self._running:
                exchange.look(closed=True)

    def is_active(self) -> bool:
        """Whether the calling thread is making a request."""
        return getattr(self._current, "exchange", None) is not None

    def attach(self, waits_on: socket.socket | None) -> None:
        """Note the socket that the calling thread's request waits on."""
        exchange: Exchange | None = getattr(self._current, "exchange", None)
        if exchange is not None:
            with self._lock:
                exchange.attach(waits_on)

    def run(self, connect: Callable[[], None], drop: Callable[[], None]) -> None:
        """Run ``connect`` (DNS, TCP, TLS), which cannot be interrupted, in a thread that can be abandoned.

        Raises
        ------
        EndedError
            The request was abandoned; ``drop`` is called once ``connect`` returns.
        """
        exchange: Exchange | None = getattr(self._current, "exchange", None)
        if exchange is None:
            connect()
            return
        done, abandoned = threading.Event(), threading.Event()
        failures: list[BaseException] = []

        def work() -> None:
            try:
                connect()
            except BaseException as failure:  # noqa: BLE001 (raised in the calling thread)
                failures.append(failure)
            done.set()
            if abandoned.is_set():
                drop()

        threading.Thread(target=work, name="terrainav-connect", daemon=True).start()
        while not done.wait(_LOOK_S):
            if exchange.ended:
                abandoned.set()
                raise EndedError(exchange.ended)
        if failures:
            raise failures[0]

    def _look(self) -> None:
        idle = 0
        while True:
            time.sleep(_LOOK_S)
            with self._lock:
                idle = 0 if self._running else idle + 1
                # The thread ends after two seconds without a request.
                if idle > 20:
                    self._thread = None
                    return
                for exchange in self._running:
                    exchange.look(self._closed)
