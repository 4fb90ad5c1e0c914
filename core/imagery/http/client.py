"""Polite requests: limits of connections and rate, retries, redirects, and the meaning of a status."""

from __future__ import annotations

import hashlib
import re
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass
from http import HTTPStatus
from typing import Callable, TypeVar
from urllib.parse import urljoin, urlsplit

from ...errors import Cancelled, Message, PartError, SourceError, TerrAInavError
from ...external.unexpected import UnexpectedErrors
from ...limits import MAX_LATE_PARTS, MAX_PART_S, MAX_REDIRECTS
from ...text.plain import first_words, whole_number
from ...text.secrets import Secrets
from .transport import Response, Transport, TransportError, http_date_s

#: Attempts at one part, the first included.
TRIES = 5
#: Wait before the second attempt, seconds; each further wait is twice as long, up to `LONGEST_WAIT_S`.
FIRST_WAIT_S = 0.5
LONGEST_WAIT_S = 30.0

_QUOTA = re.compile(
    r"quota|over_query_limit|(limit|allowance)\W+(is |was |has been )?(exceed|reach)"
    r"|api[ _-]?key|access[ _-]?token",
    re.IGNORECASE,
)

Picture = TypeVar("Picture")


class OutOfReach(PartError):
    """All attempts failed without an answer or with server errors (5xx)."""


class NotThere(PartError):
    """The provider lacks this part (404, 410)."""


class BrokenPictureError(PartError):
    """A complete answer cannot be decoded; a proxy's cache may hold a damaged copy."""


class Pace:
    """Times at which requests may start, by a rate and by waits that the server asked for.

    Parameters
    ----------
    requests_per_s : float or None
        None for no limit.
    """

    def __init__(self, requests_per_s: float | None = None) -> None:
        self._step_s = 1.0 / requests_per_s if requests_per_s else 0.0
        self._lock = threading.Lock()
        self._next_s = 0.0
        self._held_until_s = 0.0

    def turn_s(self) -> float:
        """Reserve the next turn and return the seconds until it."""
        with self._lock:
            now_s = time.monotonic()
            at_s = max(now_s, self._next_s, self._held_until_s)
            self._next_s = at_s + self._step_s
            return at_s - now_s

    def held_s(self) -> float:
        """Seconds left of the wait that the server asked for."""
        with self._lock:
            return max(self._held_until_s - time.monotonic(), 0.0)

    def hold(self, seconds: float) -> None:
        """Start no request for some seconds."""
        with self._lock:
            self._held_until_s = max(self._held_until_s, time.monotonic() + seconds)


@dataclass
class _Request:
    """A requested part: headers and check of its attempts, their total seconds, and the failure of the last attempt."""

    headers: Mapping[str, str] | None
    allow: Callable[[str], object] | None
    taken_s: float = 0.0
    reason: str = ""
    status: int = 0
    failure: TransportError | None = None


class Client:
    """Requests to one provider, from any number of threads.

    Parameters
    ----------
    transport : Transport
        Closed with the client.
    title : str
        The provider, as errors name it.
    connections : int
        Most simultaneous requests.
    requests_per_s : float or None
    first_after_s : float
        Seconds from now to the first request.
    secrets : tuple of str
        Keys to mask in every error, in any spelling in which the provider may quote them.
    tries : int
        Attempts at one part.
    first_wait_s : float
        As `FIRST_WAIT_S`.
    longest_retry_after_s : float
        If the server asks for a longer wait, the run stops; it can be resumed later.
    """

    def __init__(
        self,
        transport: Transport,
        title: str,
        *,
        connections: int = 8,
        requests_per_s: float | None = None,
        first_after_s: float = 0.0,
        secrets: tuple[str, ...] = (),
        tries: int = TRIES,
        first_wait_s: float = FIRST_WAIT_S,
        longest_retry_after_s: float = 120.0,
    ) -> None:
        self._transport = transport
        self._title = title
        self._free = threading.BoundedSemaphore(connections)
        self._pace = Pace(requests_per_s)
        self._pace.hold(first_after_s)
        self._secrets = Secrets(secrets)
        self._unexpected = UnexpectedErrors()
        self._tries = tries
        self._first_wait_s = first_wait_s
        self._longest_retry_after_s = longest_retry_after_s
        self._closed = threading.Event()
        #: Set while the server is out of reach; each part is then tried once only.
        self._away = threading.Event()
        self._silent_until_s = 0.0
        #: Number of successive parts that timed out.
        self._late_parts = 0

    def get(
        self,
        url: str,
        what: object,
        headers: Mapping[str, str] | None = None,
        allow: Callable[[str], object] | None = None,
    ) -> Response:
        """Return the answer of status 200, or of 304 or 206 if ``headers`` contain conditions or a range.

        Redirects are followed.

        Parameters
        ----------
        url : str
        what : object
            The part that is requested, as errors name it.
        headers : mapping or None
            Sent with the request, such as conditions.
        allow : callable or None
            Called with the URL of each attempt and redirect before it is sent; raises to refuse it.

        Raises
        ------
        PartError
            This part is not available; `OutOfReach` and `NotThere` are two of the reasons.
        SourceError
            The provider refuses all requests.
        Cancelled
        """
        if self._is_suspended():
            raise OutOfReach(
                "{0}: not requested, as the last {1} requests had no answer in time",
                what,
                MAX_LATE_PARTS,
                remedy="resume later",
            )
        tries = 1 if self._away.is_set() or self._late_parts >= MAX_LATE_PARTS else self._tries
        request = _Request(headers, allow)
        for attempt in range(tries):
            try:
                response = self._follow_redirects(url, what, request)
            except TransportError as failure:
                request.reason, request.status, request.failure = failure.message, 0, failure
                if failure.away and attempt == tries - 1:
                    self._away.set()
                if not failure.again:
                    break
                wait_s = 0.0
            else:
                self._away.clear()
                self._silent_until_s, self._late_parts = 0.0, 0
                if (
                    response.status == HTTPStatus.OK
                    or (response.status == HTTPStatus.NOT_MODIFIED and _is_conditional(headers))
                    or (response.status == HTTPStatus.PARTIAL_CONTENT and "Range" in (headers or {}))
                ):
                    return self._without_secrets(response)
                request.reason, request.status = self._judge(response, what), response.status
                request.failure = None
                wait_s = self._requested_wait_s(response, request.reason)
            if attempt == tries - 1 or request.taken_s > MAX_PART_S or self._is_suspended():
                request.reason = Message("{0}{1}", request.reason, _tried(attempt + 1))
                break
            self._pause(max(wait_s, self._backoff_s(url, attempt)))
        raise self._final_error(what, request)

    def picture(
        self,
        url: str,
        what: object,
        read: Callable[[Response], Picture],
        headers: Mapping[str, str] | None = None,
        allow: Callable[[str], object] | None = None,
    ) -> tuple[Response, Picture]:
        """Return an answer as `get` does, and the picture read from it; a broken picture is requested once more.

        Parameters
        ----------
        read : callable
            Decodes an answer, or raises PartError.

        Raises
        ------
        PartError, SourceError, Cancelled
            As `get` does; PartError also if ``read`` raises it.
        """
        response, times = self.get(url, what, headers, allow), 1
        picture = self._picture_or_problem(response, read)
        if isinstance(picture, BrokenPictureError):
            # Bypass proxies' caches, which may hold a damaged copy (RFC 9111, 5.2.1.4); Pragma is for HTTP/1.0.
            past_caches = {"Cache-Control": "no-cache", "Pragma": "no-cache"}
            response, times = self.get(url, what, past_caches, allow), 2
            picture = self._picture_or_problem(response, read)
        if isinstance(picture, PartError):
            raise PartError("{0}: {1}{2}", what, picture, _tried(times)).map_texts(self.redacted)
        return response, picture

    def out_of_reach(self) -> bool:
        """Whether the last part failed without an answer within the last half minute."""
        return time.monotonic() < self._silent_until_s

    def redacted(self, text: str) -> str:
        """Return ``text`` with the keys masked, in any spelling."""
        return self._secrets.masked(text)

    def message(self, response: Response) -> str:
        """Return the first line of a provider's message, with the keys masked."""
        return first_words(response.body, response.headers.get("content-type", ""), self._secrets.masked)

    def close(self) -> None:
        """End all waits and running requests, which raise `Cancelled`."""
        self._closed.set()
        self._transport.close()

    def _final_error(self, what: object, request: _Request) -> TerrAInavError:
        """Error of a part after its last attempt."""
        if request.status == HTTPStatus.TOO_MANY_REQUESTS:
            return SourceError(
                "{0}: {1}", self._title, request.reason, remedy="ask for less at a time, or resume later"
            )
        failure = request.failure
        silent = failure is not None and (failure.again or failure.away)
        if failure is not None and failure.late:
            self._late_parts += 1
        if silent:
            self._silent_until_s = time.monotonic() + 30.0
        kind = OutOfReach if silent or request.status >= HTTPStatus.INTERNAL_SERVER_ERROR else PartError
        return kind("{0}: {1}", what, request.reason)

    def _is_suspended(self) -> bool:
        """Whether requests are suspended because several successive parts timed out, the last within half a minute."""
        return self._late_parts >= MAX_LATE_PARTS and self.out_of_reach()

    def _follow_redirects(self, url: str, what: object, request: _Request) -> Response:
        """Follow redirects, each in its turn, and return the final answer."""
        first = url
        for _ in range(MAX_REDIRECTS + 1):
            if request.allow is not None:
                request.allow(url)
            response = self._attempt(url, "" if url is first else first, what, request)
            target = redirect_target(response)
            if target is None:
                return response
            url = joined(url, target)
        raise TransportError("more than {0} redirects", MAX_REDIRECTS, again=False)

    def _attempt(self, url: str, origin: str, what: object, request: _Request) -> Response:
        # Take the connection before the turn: requests that wait with past turns would start all at once.
        while not self._free.acquire(timeout=0.1):
            self._refuse_closed()
        began_s = time.monotonic()
        try:
            self._pause(self._pace.turn_s())
            # The server may have asked for a wait in the meantime.
            while self._pace.held_s():
                self._pause(self._pace.turn_s())
            self._refuse_closed()
            began_s = time.monotonic()
            more = {"origin": origin} if origin else {}
            return self._transport.get(url, request.headers or None, **more)
        except TerrAInavError:
            raise
        except Exception as wrong:  # noqa: BLE001  (any error fails this part only)
            failure = self._unexpected.failure(wrong, self.redacted)
        finally:
            self._free.release()
            request.taken_s += time.monotonic() - began_s
        # Raised outside `except` so that an error that may quote a key is not chained.
        raise PartError("{0}: {1}", what, failure)

    def _picture_or_problem(self, response: Response, read: Callable[[Response], Picture]) -> Picture | PartError:
        """Read a picture, or return the error, so that the caller can raise it without a chain that quotes a key."""
        try:
            return read(response)
        except PartError as wrong:
            return wrong
        except TerrAInavError:
            raise
        except Exception as wrong:  # noqa: BLE001  (any error fails this part only)
            return self._unexpected.failure(wrong, self.redacted)

    def _without_secrets(self, response: Response) -> Response:
        """Remove headers that quote a key, as some headers are written to files."""
        written = "\n".join(response.headers.values())
        if self.redacted(written) == written:
            return response
        kept = {name: value for name, value in response.headers.items() if self.redacted(value) == value}
        return response._replace(headers=kept)

    def _judge(self, response: Response, what: object) -> str:
        """Return the reason for another attempt; raise if another attempt is pointless."""
        message = self.message(response)
        line = _status_line(response.status) + (f": {message}" if message else "")
        if response.status in (401, 402, 403, 407, 451) or (
            response.status >= 400 and _is_quota(response.status, message)
        ):
            raise SourceError("{0} refuses: {1}", self._title, line)
        if response.status in (404, 410):
            raise NotThere("{0}: {1}", what, line)
        if response.status not in (408, 425, 429, 500, 502, 503, 504):
            raise PartError("{0}: {1}", what, line)
        return line

    def _requested_wait_s(self, response: Response, reason: str) -> float:
        """Seconds that the server asks to wait, for all requests; 0 if it does not ask."""
        seconds = retry_after_s(response, time.time())
        if seconds > self._longest_retry_after_s:
            raise SourceError("{0}: {1}; it asks to come back in {2:.0f} s: resume then", self._title, reason, seconds)
        if seconds:
            self._pace.hold(seconds)
        return seconds

    def _backoff_s(self, url: str, attempt: int) -> float:
        """Seconds between attempts; they vary with the URL, so that parts that failed together are retried apart."""
        digest = hashlib.sha256(f"{attempt} {url}".encode()).digest()
        spread = int.from_bytes(digest[:4], "big") / 2**32
        return min(self._first_wait_s * 2.0**attempt, LONGEST_WAIT_S) * (0.5 + spread)

    def _pause(self, seconds: float) -> None:
        until_s = time.monotonic() + seconds
        self._refuse_closed()
        while (left_s := until_s - time.monotonic()) > 0.0:
            self._closed.wait(left_s)
            self._refuse_closed()

    def _refuse_closed(self) -> None:
        if self._closed.is_set():
            raise Cancelled("cancelled while waiting for the network")


def _tried(times: int) -> str:
    return Message(" (tried {0} times)", times) if times > 1 else ""


def _is_conditional(headers: Mapping[str, str] | None) -> bool:
    return any(name.startswith("If-") for name in headers or ())


def retry_after_s(response: Response, now_s: float) -> float:
    """Seconds to wait according to a response's Retry-After header (RFC 9110, 10.2.3); 0 without it.

    A date is compared with the response's Date header, so that the clocks need not agree.

    Parameters
    ----------
    response : Response
    now_s : float
        Seconds since 1970, for a response without Date.
    """
    header = response.headers.get("retry-after", "").strip()
    seconds = whole_number(header)
    if seconds is not None:
        return float(seconds)
    until_s = http_date_s(header)
    if until_s is None:
        return 0.0
    since_s = http_date_s(response.headers.get("date", ""))
    return max(until_s - (now_s if since_s is None else since_s), 0.0)


def _is_quota(status: int, message: str) -> bool:
    # 429 usually means a rate limit; only an exhausted quota ends the run at once.
    if status == HTTPStatus.TOO_MANY_REQUESTS:
        return "quota" in message.lower() or "daily" in message.lower()
    return bool(_QUOTA.search(message))


def _status_line(status: int) -> str:
    try:
        return f"{status} {HTTPStatus(status).phrase}"
    except ValueError:
        return str(status)


def redirect_target(answer: Response) -> str | None:
    """Location of a redirect, possibly relative; None for other answers."""
    is_redirect = answer.status in (301, 302, 303, 307, 308)
    return (answer.headers.get("location") or None) if is_redirect else None


def joined(url: str, target: str) -> str:
    """Absolute URL of a redirect from ``url``.

    Raises
    ------
    TransportError
        Not a URL, or neither http nor https.
    """
    try:
        absolute = urljoin(url, target)
        scheme = urlsplit(absolute).scheme
    except ValueError:
        raise TransportError("redirect to something that is not a URL", again=False) from None
    if scheme not in ("http", "https"):
        raise TransportError("redirect to an address that is neither http nor https", again=False)
    return absolute
