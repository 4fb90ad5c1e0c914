"""HTTP as the sources need it: one attempt at one URL gives a whole body, or says what went wrong.

Trying again, limits of rate and what a status means are in `client`, so that another transport (QGIS's own
network stack) has only `Transport` to fulfil; the one over requests is `requests_transport`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Callable, NamedTuple, Protocol

from ..errors import TerrAInavError
from ..version import version

PROJECT_URL = "https://github.com/terrainav/terrainav"
#: Largest body read; a tile of 512 px takes about 1 MB at most as PNG.
MAX_BODY_BYTES = 32 << 20
#: Redirects followed for one request; tile servers need one or two.
MAX_REDIRECTS = 5

Stop = Callable[[], bool]


class Response(NamedTuple):
    """An answer, whole. Names of headers are in lower case."""

    status: int
    headers: Mapping[str, str]
    body: bytes


class TransportError(TerrAInavError):
    """An attempt without an answer. Its text names no URL, because URLs hold keys.

    Parameters
    ----------
    reason : str
    again : bool
        Whether another attempt may fare better.
    away : bool
        Whether the server could not be reached at all.
    """

    def __init__(self, reason: str, *, again: bool = True, away: bool = False) -> None:
        super().__init__(reason)
        self.again = again
        self.away = away


class Transport(Protocol):
    """One attempt at one URL; safe to call from several threads at once."""

    def get(
        self, url: str, headers: Mapping[str, str] | None = None, cancelled: Stop | None = None
    ) -> Response:
        """Answer of any status, its body as long as its Content-Length says.

        Raises
        ------
        TransportError
            No whole answer.
        Cancelled
            Within half a second of ``cancelled`` answering true, or of `close`.
        """
        ...

    def close(self) -> None:
        """Free the connections and end what is under way."""
        ...


class Timeouts(NamedTuple):
    """Seconds to connect, between two pieces of an answer, and for one whole attempt."""

    connect_s: float = 10.0
    read_s: float = 20.0
    whole_s: float = 60.0


def user_agent() -> str:
    """Return the name TerrAInav gives itself to servers."""
    return f"TerrAInav/{version()} (+{PROJECT_URL})"
