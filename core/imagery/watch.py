"""Ends waits for the network of a transport that is closed, and those that take too long.

A blocking read of a socket ends when another thread shuts the socket down. One thread watches all requests of
a transport, asks ten times a second, and goes when there is nothing to watch.
"""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Callable

#: Seconds between two looks at the requests under way: well within the half second that closing may take.
_LOOK_S = 0.1
#: Looks at nothing before the thread goes.
_IDLE_LOOKS = 20


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
