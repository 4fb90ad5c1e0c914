"""What threads that ask hand to the main one, where requests are made."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from typing import NamedTuple
from urllib.parse import urlsplit

from ...core.imagery.http.transport import Response, Timeouts


class Terms(NamedTuple):
    """What holds for all requests of a transport.

    Parameters
    ----------
    connections : int
        Connections kept open to a host.
    timeouts : Timeouts
        ``read_s`` holds for connecting as well.
    headers : mapping of str
    max_body_bytes : int
    authcfg : str
        Id of a configuration of QGIS's authentication database; empty for none.
    private : mapping of str
        Headers that are for the server that they were entered for, as the configuration is.
    home : tuple of scheme and host
        That server; its subdomains are it, too. An empty host for whichever is asked.
    """

    connections: int
    timeouts: Timeouts
    headers: Mapping[str, str]
    max_body_bytes: int
    authcfg: str
    private: Mapping[str, str] = {}
    home: tuple[str, str] = ("", "")

    def are_for(self, exchange: Exchange) -> bool:
        """Whether configuration and private headers are for the server that an exchange asks now."""
        parts = urlsplit(exchange.url)
        scheme, host = self.home
        asked = (parts.hostname or "").rstrip(".")
        at_home = not host or (
            (asked == host or asked.endswith("." + host)) and not (scheme == "https" != parts.scheme)
        )
        # Nor for one that the server points to.
        return at_home and exchange.at_origin


class Exchange:
    """A request on its way to an answer; handed from the thread that asks to the main one and back.

    Parameters
    ----------
    url : str
    headers : mapping
    origin : str
        As of `Transport.get`.

    Attributes
    ----------
    done : threading.Event
        There is an outcome.
    outcome : Response, Exception or None
        None until then. The first one counts.
    until_s, heard_s : float
        When it has to be over, and when the server was last heard of, on the clock of the worker.
    """

    def __init__(self, url: str, headers: Mapping[str, str], origin: str = "") -> None:
        self.url = url
        self.headers = headers
        #: Whether the server is that which was asked first: credentials are for it only.
        self.at_origin = urlsplit(url)[:2] == urlsplit(origin or url)[:2]
        self.received_bytes = 0
        self.until_s = self.heard_s = 0.0
        self.done = threading.Event()
        self.outcome: Response | Exception | None = None
        self._ending = threading.Lock()

    def end(self, outcome: Response | Exception) -> None:
        """Hand the outcome over, unless there is one."""
        with self._ending:
            if not self.done.is_set():
                self.outcome = outcome
                self.done.set()
