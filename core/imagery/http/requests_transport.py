"""The transport of the headless core: requests, with deadlines and cancelling of its own."""

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

_CHUNK_BYTES = 1 << 16
#: Hosts with a pool of connections each: a template's subdomains, and those that redirects lead to.
_HOSTS = 64
#: Seconds between two looks at the requests under way: well within the half second that closing may take.
_LOOK_S = 0.1
#: Looks at nothing before the thread goes.
_IDLE_LOOKS = 20


class _Host(NamedTuple):
    """What every request to one host needs: looked up once, because that takes longer than a request does.

    ``prefix`` stands before the path of each request: a proxy wants all of an http URL.
    """

    pool: HTTPConnectionPool
    headers: Mapping[str, str]
    prefix: str


class RequestsTransport:
    """Transport with a pool as large as the connections: requests' settings, urllib3's connections.

    What the environment says of proxies and certificates is asked of requests, once for each host; each request is
    then made on urllib3's pool, which takes two fifths of the processor time that it takes through a Session.

    Parameters
    ----------
    connections : int
        Connections kept open to a host.
    timeouts : Timeouts
    max_body_bytes : int
        Bodies beyond this are given up.
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
        # Pictures do not compress further, so their Content-Length may as well be that of the picture.
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
        # Also where nobody closes it, so that no connection and no filter stays behind.
        self._free = weakref.finalize(self, _free, self._session, _quiet(self._watch))

    def get(
        self,
        url: str,
        headers: Mapping[str, str] | None = None,
        *,
        origin: str = "",  # noqa: ARG002  (credentials of its own it has none)
    ) -> Response:
        """Answer of any status; see `Transport.get`."""
        problem: TransportError
        with self._watch.over(time.monotonic() + self._timeouts.whole_s) as exchange:
            try:
                return self._answer(urlsplit(url), headers or {})
            except TransportError as failure:
                problem = failure
            except (requests.RequestException, urllib3.exceptions.HTTPError, OSError, ValueError) as failure:
                problem = self._problem(failure, urlsplit(url).hostname)
        # Raised out here, where the failure that holds the URL is no part of it any more.
        if exchange.ended == "cancelled":
            raise Cancelled("cancelled while waiting for the network")
        if exchange.ended == "late":
            raise TransportError("no whole answer within {0:g} s", self._timeouts.whole_s, late=True)
        raise TransportError(problem, again=problem.again, away=problem.away, late=problem.late)

    def close(self) -> None:
        """Free the connections and end what is under way."""
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
        # What an unchanged picture would be long is not the length of this answer (RFC 9110, 8.6).
        if answer.status != HTTPStatus.NOT_MODIFIED:
            # urllib3 before 2 takes the end of the connection for the end of the body.
            check_length(len(body), named)
        return Response(answer.status, named, unpacked(body, named, self._max_body_bytes))

    def _host(self, parts: SplitResult) -> _Host:
        """Pool, headers and prefix for a URL's host, with the proxy and certificates the environment names."""
        named = parts.scheme, parts.netloc
        found = self._hosts.get(named)
        if found is None:
            # No more than urllib3 keeps: those it drops it closes.
            if len(self._hosts) >= _HOSTS:
                self._hosts.clear()
            found = self._hosts[named] = self._opened(parts)
        return found

    def _opened(self, parts: SplitResult) -> _Host:
        request = requests.Request(
            "GET", parts._replace(path="/", query="").geturl(), self._headers
        ).prepare()
        url = str(request.url)
        settings = self._session.merge_environment_settings(url, {}, None, None, None)
        proxy = select_proxy(url, settings["proxies"])
        managers: Any = self._adapter.poolmanager
        if proxy:
            managers = self._adapter.proxy_manager_for(proxy if "://" in proxy else f"http://{proxy}")
        pool = managers.connection_from_url(url)
        # By name also where it is the usual one: not every version of requests finds that itself here.
        bundle = DEFAULT_CA_BUNDLE_PATH if settings["verify"] is True else settings["verify"]
        self._adapter.cert_verify(pool, url, bundle, settings["cert"])  # type: ignore[no-untyped-call]
        # That is all of the URL where a proxy is asked for it, and the path elsewhere.
        prefix = str(self._adapter.request_url(request, settings["proxies"]))  # type: ignore[no-untyped-call]
        return _Host(pool, dict(request.headers), prefix.rstrip("/"))

    def _body(self, answer: urllib3.HTTPResponse) -> bytes:
        """Body as it is sent: unpacked it may be any length."""
        chunks, size = [], 0
        # Not `stream`: of a body in chunks that reads lines of any length.
        while chunk := answer.read(_CHUNK_BYTES, decode_content=False):
            chunks.append(chunk)
            size += len(chunk)
            if size > self._max_body_bytes:
                raise too_long(self._max_body_bytes)
        return b"".join(chunks)

    def _problem(self, failure: Exception, host: str | None) -> TransportError:
        """Say what failed in words of our own: those of the libraries quote the URL."""
        if isinstance(failure, (urllib3.exceptions.SSLError, requests.exceptions.SSLError)):
            return TransportError("no trusted connection to {0} (TLS)", host, again=False, away=True)
        # urllib3 hands on what it has met with as an argument of its own errors.
        met = {type(one) for one in (failure, *failure.args)}
        if _EndlessError in met:
            return too_long(self._max_body_bytes)
        if HTTPException in met:
            return too_many_headers()
        if isinstance(failure, urllib3.exceptions.ProxyError):
            return TransportError("the proxy does not answer", away=True)
        # Before the timeouts, which they are among.
        if isinstance(
            failure, (urllib3.exceptions.NewConnectionError, urllib3.exceptions.ConnectTimeoutError)
        ):
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
    """Keep urllib3 from logging the URLs of watched requests, which hold keys; return what undoes it."""

    def others(_record: logging.LogRecord) -> bool:
        return not watch.here()

    loggers = [logging.getLogger(f"urllib3.{name}") for name in ("connection", "connectionpool", "response")]
    for logger in loggers:
        logger.addFilter(others)

    def undo() -> None:
        for logger in loggers:
            logger.removeFilter(others)

    # A request that is given up logs its URL while it ends.
    return lambda: watch.when_idle(undo)


class _Adapter(HTTPAdapter):
    """Adapter whose connections can be given up while they wait."""

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
    """An answer has gone on beyond what is read of one."""


class _Counted(io.RawIOBase):
    """What comes from a socket for one answer, up to a limit: a line or a chunk in it may claim any length."""

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
    """Make connection pools of urllib3 whose connections tell ``watch`` what they wait on, and end endless answers."""

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
    """A request was given up before it had a connection."""


class Exchange:
    """A request under way.

    Attributes
    ----------
    ended : str
        Why it was given up: ``cancelled`` or ``late``; empty while it was not.
    """

    def __init__(self, deadline_s: float) -> None:
        self.ended = ""
        self._deadline_s = deadline_s
        self._socket: socket.socket | None = None

    def look(self, closed: bool) -> None:
        """Give the request up if it is time to."""
        if not self.ended:
            if closed:
                self.ended = "cancelled"
            elif time.monotonic() > self._deadline_s:
                self.ended = "late"
        if self.ended and self._socket is not None:
            _shut_down(self._socket)

    def attach(self, waits_on: socket.socket | None) -> None:
        """Note the socket the request waits on."""
        self._socket = waits_on
        if self.ended:
            raise EndedError(self.ended)


def _shut_down(waited_on: socket.socket) -> None:
    try:
        # The class's own method: that of a TLS socket drops its state under the thread that reads it.
        socket.socket.shutdown(waited_on, socket.SHUT_RDWR)
    except OSError:
        return  # closed already, which is as good


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
    def over(self, deadline_s: float) -> Iterator[Exchange]:
        """Watch over the request the calling thread makes within."""
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
                # From here on the socket may serve another request.
                self._running.discard(exchange)
                left = [] if self._running else self._when_idle
                self._when_idle = self._when_idle if self._running else []
            self._current.exchange = None
            for call in left:
                call()

    def when_idle(self, call: Callable[[], None]) -> None:
        """Call once no request is under way: now, or in the thread whose request is the last to end."""
        with self._lock:
            if self._running:
                self._when_idle.append(call)
                return
        call()

    def close(self) -> None:
        """Give up what is under way and all that comes."""
        with self._lock:
            self._closed = True
            for exchange in self._running:
                exchange.look(closed=True)

    def here(self) -> bool:
        """Whether the calling thread is within a request."""
        return getattr(self._current, "exchange", None) is not None

    def attach(self, waits_on: socket.socket | None) -> None:
        """Note the socket the calling thread's request waits on."""
        exchange: Exchange | None = getattr(self._current, "exchange", None)
        if exchange is not None:
            with self._lock:
                exchange.attach(waits_on)

    def run(self, connect: Callable[[], None], drop: Callable[[], None]) -> None:
        """Run ``connect`` (name, TCP, TLS), which nothing can interrupt, on a thread that can be left behind.

        Raises
        ------
        EndedError
            The request was given up; ``drop`` is called once ``connect`` comes back.
        """
        exchange: Exchange | None = getattr(self._current, "exchange", None)
        if exchange is None:
            connect()
            return
        done, left = threading.Event(), threading.Event()
        failures: list[BaseException] = []

        def work() -> None:
            try:
                connect()
            except BaseException as failure:  # noqa: BLE001 (handed to the thread that asked)
                failures.append(failure)
            done.set()
            if left.is_set():
                drop()

        threading.Thread(target=work, name="terrainav-connect", daemon=True).start()
        while not done.wait(_LOOK_S):
            if exchange.ended:
                left.set()
                raise EndedError(exchange.ended)
        if failures:
            raise failures[0]

    def _look(self) -> None:
        idle = 0
        while True:
            time.sleep(_LOOK_S)
            with self._lock:
                idle = 0 if self._running else idle + 1
                if idle > _IDLE_LOOKS:
                    self._thread = None
                    return
                for exchange in self._running:
                    exchange.look(self._closed)
