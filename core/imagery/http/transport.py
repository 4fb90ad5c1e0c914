"""HTTP as the sources need it: one attempt at one URL gives a whole body, or says what went wrong.

Trying again, redirects, limits of rate and what a status means are in `client`, so that another transport (QGIS's own
network stack) has only `Transport` to fulfil; the one over requests is `requests_transport`.
"""

from __future__ import annotations

import datetime as dt
import zlib
from collections.abc import Mapping
from email.utils import parsedate_to_datetime
from typing import NamedTuple, Protocol

from ...errors import TerrAInavError
from ...limits import MAX_HEADERS
from ...resources import version
from ...text import one_line, whole_number

PROJECT_URL = "https://github.com/terrainav/terrainav"
#: What a body may be packed as although that was not asked for.
_ZLIB = frozenset({"gzip", "x-gzip", "deflate"})
_LONGEST_CODING = 40
#: A date of HTTP has 29 to 33 characters.
_DATE_CHARACTERS = 64


class Response(NamedTuple):
    """An answer, whole. Names of headers are in lower case."""

    status: int
    headers: Mapping[str, str]
    body: bytes


class TransportError(TerrAInavError):
    """An attempt without an answer. Its text names no URL, because URLs hold keys.

    Parameters
    ----------
    template : str or TerrAInavError
    *values : object
        As of any error.
    again : bool
        Whether another attempt may fare better.
    away : bool
        Whether the server could not be reached at all.
    late : bool
        Whether it had been waited for as long as is waited at all.
    """

    def __init__(
        self,
        template: object = "",
        *values: object,
        again: bool = True,
        away: bool = False,
        late: bool = False,
    ) -> None:
        super().__init__(template, *values)
        self.again = again
        self.away = away
        self.late = late


class Transport(Protocol):
    """One attempt at one URL; safe to call from several threads at once."""

    def get(self, url: str, headers: Mapping[str, str] | None = None, *, origin: str = "") -> Response:
        """Answer of any status, redirects too; its body as long as its Content-Length says, and unpacked.

        Parameters
        ----------
        url : str
        headers : mapping or None
        origin : str
            URL that was asked first, where a redirect led from it to this one: credentials that a transport has of its
            own are for that server only.

        Raises
        ------
        TransportError
            No whole answer.
        Cancelled
            Within half a second of `close`.
        """

    def close(self) -> None:
        """Free the connections and end what is under way."""


class Timeouts(NamedTuple):
    """Seconds to connect, between two pieces of an answer, and for one whole attempt."""

    connect_s: float = 10.0
    read_s: float = 20.0
    whole_s: float = 60.0


def too_long(max_body_bytes: int) -> TransportError:
    """Error of a body beyond its limit."""
    return TransportError("an answer of more than {0} bytes", max_body_bytes, again=False)


def too_many_headers() -> TransportError:
    """Error of an answer with more header lines than any server means to send; `http.client` has the same limit."""
    return TransportError("an answer of more than {0} header lines", MAX_HEADERS, again=False)


def check_length(received_bytes: int, headers: Mapping[str, str]) -> None:
    """Raise TransportError for a body that is shorter than its Content-Length says; names in lower case."""
    length = whole_number(headers.get("content-length", ""))
    if length is not None and "transfer-encoding" not in headers and received_bytes < length:
        raise TransportError("an answer cut off after {0} of {1} bytes", received_bytes, length)


def unpacked(body: bytes, headers: Mapping[str, str], max_body_bytes: int) -> bytes:
    """Body as it was before a server packed it, which nobody asks for: unpacked no further than to the limit.

    Parameters
    ----------
    body : bytes
    headers : mapping
        Names in lower case.
    max_body_bytes : int

    Raises
    ------
    TransportError
        It is too long then, broken, or packed in a way that has no such limit.
    """
    coding = headers.get("content-encoding", "").strip().lower()
    if coding in ("", "identity") or not body:
        return body
    if coding not in _ZLIB:
        raise TransportError(
            "an answer compressed as {0}, which was not requested",
            one_line(coding, _LONGEST_CODING),
            again=False,
        )
    # 32: zlib or gzip by its header. Some servers leave the header of zlib out.
    for window_bits in (32 + zlib.MAX_WBITS, -zlib.MAX_WBITS):
        unpacking = zlib.decompressobj(window_bits)
        try:
            plain = unpacking.decompress(body, max_body_bytes + 1)
        except zlib.error:
            continue
        if len(plain) > max_body_bytes:
            raise too_long(max_body_bytes)
        if unpacking.eof and not unpacking.unused_data:
            return plain
    raise TransportError("a compressed answer that is damaged")


def user_agent() -> str:
    """Return the name TerrAInav gives itself to servers."""
    return f"TerrAInav/{version()} (+{PROJECT_URL})"


def http_date_s(text: str) -> float | None:
    """Seconds since 1970 of a date as HTTP writes it, None of anything else."""
    if len(text) > _DATE_CHARACTERS:
        return None
    try:
        moment = parsedate_to_datetime(text)
        # The oldest of the three forms names no zone, and means UTC (RFC 9110, 5.6.7).
        return (moment if moment.tzinfo else moment.replace(tzinfo=dt.timezone.utc)).timestamp()
    except (TypeError, ValueError, IndexError, OverflowError):
        return None
