"""HTTP over QGIS's own network stack: the user's proxies, certificates and authentication configurations hold."""

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
    """Transport over QGIS's network stack; `get` is called from any thread, the main one works through its events.

    The requests themselves are made in the main thread, so answers come in while its event loop turns. Time in which
    it does not turn counts for no limit.

    Parameters
    ----------
    connections : int
        Connections kept open to a host.
    timeouts : Timeouts
        Qt does not tell when a connection stands: ``read_s`` holds for connecting as well.
    max_body_bytes : int
        Bodies beyond this are given up.
    authcfg : str
        Id of a configuration of QGIS's authentication database to be applied to every request; empty for none.
        The database has to be unlocked: no dialog opens from here.
    headers : mapping of str or None
        To be sent along with every request.
    home : tuple of scheme and host
        Server that both are for, as `credential_home` returns it; an empty host for every one that is asked. What a
        server points to, or names in its capabilities, gets neither.
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
        # Pictures do not compress further, so their Content-Length may as well be that of the picture.
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
        # Also where nobody closes it.
        self._free = weakref.finalize(self, self._worker.closing.emit)
        # The application is gone by then, and the worker with it.
        self._free.atexit = False

    def get(
        self,
        url: str,
        headers: Mapping[str, str] | None = None,
        *,
        origin: str = "",
    ) -> Response:
        """Answer of any status; see `Transport.get`."""
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
        """Free the connections and end what is under way, without waiting for the main thread to see to it."""
        with self._lock:
            self._closed = True
            for exchange in self._waiting:
                exchange.end(_cancelled())
            self._free()


def _await(exchange: PendingRequest) -> None:
    """Wait for the outcome, of which the worker takes care within the limits of time, or `close`."""
    main = in_main_thread()
    while not exchange.done.is_set():
        if main:
            # The worker looks after requests under way, so events are never far.
            QEventLoop().processEvents(
                QEventLoop.ProcessEventsFlag.ExcludeUserInputEvents | QEventLoop.ProcessEventsFlag.WaitForMoreEvents
            )
        else:
            exchange.done.wait(0.1)


def _cancelled() -> Cancelled:
    return Cancelled("cancelled while waiting for the network")
