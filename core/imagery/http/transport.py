"""HTTP for sources: a single attempt at a URL, which returns a whole response or raises; interpretation of headers.

Retries, redirects, rate limits and the meaning of a status are in `client`, so that another HTTP library, such as
QGIS's network stack, needs to implement `Transport` only. `requests_transport` implements it with requests.
"""

from __future__ import annotations

import datetime as dt
import re
import zlib
from collections.abc import Mapping
from email.utils import parsedate_to_datetime
from typing import NamedTuple, Protocol

from ...errors import TerrAInavError
from ...limits import MAX_HEADER_CHARACTERS, MAX_HEADERS
from ...resources import version
from ...text.plain import one_line, whole_number

#: Lifetime of an answer that states none, seconds: a week, the minimum that OpenStreetMap's tile usage policy requires.
HEURISTIC_LIFETIME_S = 7 * 86400
#: Longest lifetime, seconds (RFC 9111, 1.2.2).
LONGEST_LIFETIME_S = 2**31
_DIRECTIVE = re.compile(r"([\w!#$%&'*+.^`|~-]+)(?:\s*=\s*(\"(?:[^\"\\]|\\.)*\"|[^\s,]*))?")


class Response(NamedTuple):
    """A complete answer, with header names in lower case."""

    status: int
    headers: Mapping[str, str]
    body: bytes


class TransportError(TerrAInavError):
    """An attempt failed without a usable answer. The message contains no URL, as URLs may hold keys.

    Parameters
    ----------
    template : str or TerrAInavError
    *values : object
        As for any error.
    again : bool
        Whether another attempt may succeed.
    away : bool
        Whether the server could not be reached.
    late : bool
        Whether the attempt timed out.
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
        """Return the answer, of any status, redirects included; the body is complete by Content-Length and unpacked.

        Parameters
        ----------
        url : str
        headers : mapping or None
        origin : str
            First URL of a chain of redirects; a transport sends its credentials to the server of this URL only.

        Raises
        ------
        TransportError
            No complete answer.
        Cancelled
            Within half a second of `close`.
        """

    def close(self) -> None:
        """Close the connections and end running requests."""


class Timeouts(NamedTuple):
    """Longest seconds to connect, between two pieces of an answer, and for a whole attempt."""

    connect_s: float = 10.0
    read_s: float = 20.0
    whole_s: float = 60.0


def too_long(max_body_bytes: int) -> TransportError:
    """Error for a body above the limit."""
    return TransportError("an answer of more than {0} bytes", max_body_bytes, again=False)


def too_many_headers() -> TransportError:
    """Error for an answer with too many header lines; `http.client` has the same limit."""
    return TransportError("an answer of more than {0} header lines", MAX_HEADERS, again=False)


def check_length(received_bytes: int, headers: Mapping[str, str]) -> None:
    """Raise TransportError for a body shorter than its Content-Length; header names are in lower case."""
    length = whole_number(headers.get("content-length", ""))
    if length is not None and "transfer-encoding" not in headers and received_bytes < length:
        raise TransportError("an answer cut off after {0} of {1} bytes", received_bytes, length)


def unpacked(body: bytes, headers: Mapping[str, str], max_body_bytes: int) -> bytes:
    """Undo a Content-Encoding, which servers may apply unasked, up to a limit of size.

    Parameters
    ----------
    body : bytes
    headers : mapping
        Names in lower case.
    max_body_bytes : int

    Raises
    ------
    TransportError
        The body is too long, damaged, or compressed by a method other than gzip and deflate.
    """
    coding = headers.get("content-encoding", "").strip().lower()
    if coding in ("", "identity") or not body:
        return body
    if coding not in ("gzip", "x-gzip", "deflate"):
        raise TransportError(
            "an answer compressed as {0}, which was not requested",
            one_line(coding, 40),
            again=False,
        )
    # 32 detects zlib or gzip by the header; negative bits are for servers that omit the header of zlib.
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
    """Return the User-Agent of every request."""
    return f"TerrAInav/{version()} (+https://github.com/terrainav/terrainav)"


def http_date_s(text: str) -> float | None:
    """Parse a date of HTTP to seconds since 1970; None for other text."""
    # Each of the three forms has 24 to 33 characters.
    if len(text) > 64:
        return None
    try:
        moment = parsedate_to_datetime(text)
        # The oldest of the three forms has no zone and means UTC (RFC 9110, 5.6.7).
        return (moment if moment.tzinfo else moment.replace(tzinfo=dt.timezone.utc)).timestamp()
    except (TypeError, ValueError, IndexError, OverflowError):
        return None


class Freshness(NamedTuple):
    """Lifetime of a stored answer, and validators to confirm it afterwards (RFC 9111, for a private cache).

    Parameters
    ----------
    expires_s : int
        Seconds since 1970.
    lifetime_s : int
        Lifetime, which starts again after a confirmation (304) that states none.
    stale_allowed : bool
        Whether the answer may be used after it expires while the provider is out of reach.
    etag, last_modified : str
        Validators as received; empty if missing.
    """

    expires_s: int
    lifetime_s: int
    stale_allowed: bool
    etag: str
    last_modified: str

    def is_fresh(self, now_s: float) -> bool:
        """Whether the answer may be used without a request."""
        return now_s < self.expires_s

    def conditions(self) -> dict[str, str]:
        """Headers that request the answer only if it has changed; empty without a validator."""
        headers = {"If-None-Match": self.etag, "If-Modified-Since": self.last_modified}
        return {name: value for name, value in headers.items() if value}

    def renewed(self, headers: Mapping[str, str], now_s: float) -> Freshness | None:
        """Freshness after a 304 with ``headers``; None if the answer may no longer be stored."""
        new = freshness(headers, now_s, self.lifetime_s)
        if new is None:
            return None
        states_all = "cache-control" in headers
        return new._replace(
            stale_allowed=new.stale_allowed if states_all else self.stale_allowed,
            etag=new.etag or self.etag,
            last_modified=new.last_modified or self.last_modified,
        )


def freshness(headers: Mapping[str, str], now_s: float, otherwise_s: float = HEURISTIC_LIFETIME_S) -> Freshness | None:
    """Freshness of an answer that has just arrived; None if the answer must not be stored.

    Requests for tiles differ in URL only, so Vary has no effect unless it is ``*``.

    Parameters
    ----------
    headers : mapping
        Names in lower case.
    now_s : float
        Seconds since 1970.
    otherwise_s : float
        Lifetime if the headers state none.
    """
    directives = cache_control(headers.get("cache-control", ""))
    if "no-store" in directives or "*" in headers.get("vary", ""):
        return None
    lifetime_s = min(_lifetime_s(headers, directives, now_s, otherwise_s), LONGEST_LIFETIME_S)
    return Freshness(
        int(now_s + lifetime_s - _age_s(headers, now_s)),
        int(lifetime_s),
        not directives.keys() & {"no-cache", "must-revalidate"},
        _sendable(headers.get("etag", "")),
        _sendable(headers.get("last-modified", "")),
    )


def cache_control(text: str) -> dict[str, str]:
    """Directives of a Cache-Control header and their values; of repeated directives, the smallest number."""
    found: dict[str, str] = {}
    for name, value in _DIRECTIVE.findall(text[:MAX_HEADER_CHARACTERS]):
        plain = value.strip('"')
        earlier, number = whole_number(found.get(name.lower(), "")), whole_number(plain)
        if earlier is None or number is None or number < earlier:
            found[name.lower()] = plain
    return found


def _sendable(value: str) -> str:
    """Return the value of a header if it can be sent back, otherwise an empty string."""
    sound = len(value) <= MAX_HEADER_CHARACTERS and value.isascii() and value.isprintable()
    return value if sound else ""


def _lifetime_s(headers: Mapping[str, str], directives: Mapping[str, str], now_s: float, otherwise_s: float) -> float:
    if "no-cache" in directives:
        return 0.0
    if "max-age" in directives:
        # An invalid number counts as expired (RFC 9111, 4.2.1).
        return float(whole_number(directives["max-age"]) or 0)
    if "expires" in headers:
        expires_s = http_date_s(headers["expires"])
        sent_s = http_date_s(headers.get("date", ""))
        return 0.0 if expires_s is None else max(expires_s - (now_s if sent_s is None else sent_s), 0.0)
    return otherwise_s


def _age_s(headers: Mapping[str, str], now_s: float) -> float:
    """Age of an answer on arrival, by its Age and Date headers (RFC 9111, 4.2.3).

    The duration of the request is ignored, as requests take seconds and tiles are fresh for hours.
    """
    stated_s = float(whole_number(headers.get("age", "")) or 0)
    sent_s = http_date_s(headers.get("date", ""))
    apparent_s = 0.0 if sent_s is None else max(now_s - sent_s, 0.0)
    return min(max(stated_s, apparent_s), float(LONGEST_LIFETIME_S))
