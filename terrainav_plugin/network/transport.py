"""HTTP over QGIS's network stack, with the user's proxies, certificates and authentication."""

from __future__ import annotations

import threading
import weakref
from collections.abc import Mapping

from qgis.PyQt.QtCore import QEventLoop

from ...core.errors import Cancelled
from ...core.imagery.http.transport import Response, Timeouts, TransportError, user_agent
from ...core.limits import MAX_BODY_BYTES
from .worker import NetworkWorker, PendingRequest, Terms, in_main_thread


class QgisTransport:
    """Transport over QGIS's network stack; call `get` on any thread while the main thread's event loop runs.

    Requests are made on the main thread, and answers arrive while its event loop runs. While the event loop does not
    run, time does not count towards the time limits.

    Parameters
    ----------
    connections : int
        Largest number of open connections per host.
    timeouts : Timeouts
        Qt does not report when a connection is established: ``read_s`` also limits connecting.
    max_body_bytes : int
        Largest body accepted.
    authcfg : str
        Id of a configuration in QGIS's authentication database, applied to requests; empty for none. The database must
        be unlocked, as no dialog is opened.
    headers : mapping of str or None
        Headers sent with requests.
    home : tuple of scheme and host
        Server to which ``authcfg`` and ``headers`` are restricted, as from `credential_home`; an empty host for all
        servers. Other servers, to which it redirects or its capabilities refer, get neither.
    """

    def __init__(
        self,
        connections: int = 8,
        timeouts: Timeouts = Timeouts(),  # noqa: B008 (an immutable value)
        max_body_bytes: int = MAX_BODY_BYTES,
        *,
        authcfg: str = "",
        headers: Mapping[str, str] | None = None,
        home: tuple[str, str] = ("", ""),
    ) -> None:
        # Do not ask for compression: images hardly shrink, and Content-Length then states the size of the image.
        usual = {
            "User-Agent": user_agent(),
            "Accept": "image/*,*/*;q=0.1",
            "Accept-Encoding": "identity",
        }
        terms = Terms(connections, timeouts, usual, max_body_bytes, authcfg, headers or {}, home)
        self._worker = NetworkWorker(terms)
        self._lock = threading.Lock()
        self._closed = False
        self._waiting: set[PendingRequest] = set()
        # Free the connections even if `close` is not called.
        self._free = weakref.finalize(self, self._worker.closing.emit)
        # Not at exit, when the application and the worker no longer exist.
        self._free.atexit = False

    def get(
        self,
        url: str,
        headers: Mapping[str, str] | None = None,
        *,
        origin: str = "",
    ) -> Response:
        """Response of any status; see `Transport.get`."""
        try:
            exchange = PendingRequest(url, headers or {}, origin)
        except ValueError:
            raise TransportError("the URL is not valid", again=False) from None
        with self._lock:
            if self._closed:
                raise _cancelled()
            self._waiting.add(exchange)
            self._worker.asked.emit(exchange)
        try:
            _await(exchange)
        finally:
            with self._lock:
                self._waiting.discard(exchange)
                if not exchange.done.is_set():
                    exchange.end(_cancelled())
                    if not self._closed:
                        self._worker.dropped.emit(exchange)
        outcome = exchange.outcome
        if isinstance(outcome, Response):
            return outcome
        raise outcome or _cancelled()

    def close(self) -> None:
        """Free the connections and cancel requests, without waiting for the main thread."""
        with self._lock:
            self._closed = True
            for exchange in self._waiting:
                exchange.end(_cancelled())
            self._free()


def _await(exchange: PendingRequest) -> None:
    """Wait for the outcome, which is set by the worker within the time limits, or by `close`."""
    main = in_main_thread()
    while not exchange.done.is_set():
        if main:
            # Returns soon, as the timer of the worker makes events.
            QEventLoop().processEvents(
                QEventLoop.ProcessEventsFlag.ExcludeUserInputEvents | QEventLoop.ProcessEventsFlag.WaitForMoreEvents
            )
        else:
            exchange.done.wait(0.1)


def _cancelled() -> Cancelled:
    return Cancelled("cancelled while waiting for the network")
