"""Well-mannered requests: limits of connections and rate, trying again, and what an answer's status means."""

from __future__ import annotations

import hashlib
import html
import json
import re
import threading
import time
from collections.abc import Mapping
from http import HTTPStatus
from typing import Callable, TypeVar
from urllib.parse import quote, quote_plus

from ..errors import Cancelled, PartError, SourceError
from .cache.freshness import http_date_s
from .transport import Response, Stop, Transport, TransportError

#: Attempts at one part, the first included.
TRIES = 5
#: Seconds before the second attempt; each further wait is twice as long, up to `LONGEST_WAIT_S`.
FIRST_WAIT_S = 0.5
LONGEST_WAIT_S = 30.0
#: A server that asks for a longer wait than this is not waited for: the run stops, to be resumed later.
LONGEST_RETRY_AFTER_S = 120.0
#: A server that gave no answer is taken to be out of reach for so long, where that saves asking in vain.
OUT_OF_REACH_S = 30.0
#: Seconds between two looks at whether the user cancelled.
_LOOK_S = 0.1

_REFUSED = frozenset({401, 402, 403, 407, 451})
_NOT_THERE = frozenset({404, 410})
_AGAIN = frozenset({408, 425, 429, 500, 502, 503, 504})
_QUOTA = re.compile(
    r"quota|over_query_limit|(limit|allowance)\W+(is |was |has been )?(exceed|reach)"
    r"|api[ _-]?key|access[ _-]?token",
    re.IGNORECASE,
)
_WORDS_CHARACTERS = 200
#: Ends what was cut short.
_CUT = "…"
#: Asks every cache on the way for the server's own answer (RFC 9111, 5.2.1.4); the second is for those of HTTP/1.0.
_PAST_CACHES = {"Cache-Control": "no-cache", "Pragma": "no-cache"}

Picture = TypeVar("Picture")


class OutOfReach(PartError):
    """No answer came, or none but failures of the server (5xx), however often it was tried."""


class NotThere(PartError):
    """The provider has no such part (404, 410)."""


class BrokenPictureError(PartError):
    """An answer came whole and cannot be decoded: what a cache on the way holds may be a bad copy."""


class Pace:
    """When the next request may start: a rate, and a hold that a server asked for.

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
        """Take the next turn; return how many seconds from now it is."""
        with self._lock:
            now_s = time.monotonic()
            at_s = max(now_s, self._next_s, self._held_until_s)
            self._next_s = at_s + self._step_s
            return at_s - now_s

    def held_s(self) -> float:
        """Seconds the server still wants to be left alone."""
        with self._lock:
            return max(self._held_until_s - time.monotonic(), 0.0)

    def hold(self, seconds: float) -> None:
        """Start no request for so long."""
        with self._lock:
            self._held_until_s = max(self._held_until_s, time.monotonic() + seconds)


class Client:
    """Requests to one provider, from any number of threads.

    Parameters
    ----------
    transport : Transport
        Closed with the client.
    title : str
        The provider, as errors name it.
    connections : int
        Requests under way at once.
    requests_per_s : float or None
    secrets : tuple of str
        Keys that no error may quote, even where the provider's own words do.
    tries, first_wait_s, longest_retry_after_s
        As the constants of this module.
    """

    def __init__(
        self,
        transport: Transport,
        title: str,
        *,
        connections: int = 8,
        requests_per_s: float | None = None,
        secrets: tuple[str, ...] = (),
        tries: int = TRIES,
        first_wait_s: float = FIRST_WAIT_S,
        longest_retry_after_s: float = LONGEST_RETRY_AFTER_S,
    ) -> None:
        self._transport = transport
        self._title = title
        self._free = threading.BoundedSemaphore(connections)
        self._pace = Pace(requests_per_s)
        self._secrets = secrets
        self._tries = tries
        self._first_wait_s = first_wait_s
        self._longest_retry_after_s = longest_retry_after_s
        self._closed = threading.Event()
        #: The last part found the server out of reach: until it answers, others are tried once only.
        self._away = threading.Event()
        self._silent_until_s = 0.0

    def get(
        self,
        url: str,
        what: str,
        cancelled: Stop | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> Response:
        """Answer with status 200; or 304, where ``headers`` are conditions.

        Parameters
        ----------
        url : str
        what : str
            The part that is asked for, as errors name it.
        cancelled : callable or None
            Asked during every wait.
        headers : mapping or None
            To be sent with the request, such as conditions under which an answer is wanted.

        Raises
        ------
        PartError
            This part cannot be had; `OutOfReach` and `NotThere` tell two of the reasons.
        SourceError
            The provider refuses: nothing can be had.
        Cancelled
        """
        tries = 1 if self._away.is_set() else self._tries
        reason, status, silent = "", 0, False
        for attempt in range(tries):
            try:
                response = self._attempt(url, cancelled, headers)
            except TransportError as failure:
                reason, status, silent = str(failure), 0, failure.again or failure.away
                if failure.away and attempt == tries - 1:
                    self._away.set()
                if not failure.again:
                    break
                wait_s = 0.0
            else:
                self._away.clear()
                self._silent_until_s = 0.0
                if response.status == HTTPStatus.OK or (
                    response.status == HTTPStatus.NOT_MODIFIED and _is_conditional(headers)
                ):
                    return self._without_secrets(response)
                reason, status, silent = self._judge(response, what), response.status, False
                wait_s = self._asked_wait_s(response, reason)
            if attempt < tries - 1:
                self._pause(max(wait_s, self._backoff_s(url, attempt)), cancelled)
        else:
            reason += _tried(tries)
        if status == HTTPStatus.TOO_MANY_REQUESTS:
            raise SourceError(f"{self._title}: {reason}; ask for less at a time, or resume later")
        if silent:
            self._silent_until_s = time.monotonic() + OUT_OF_REACH_S
        if silent or status >= HTTPStatus.INTERNAL_SERVER_ERROR:
            raise OutOfReach(f"{what}: {reason}")
        raise PartError(f"{what}: {reason}")

    def picture(
        self,
        url: str,
        what: str,
        read: Callable[[Response], Picture],
        cancelled: Stop | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> tuple[Response, Picture]:
        """Answer as of `get`, and what is read of it: a picture that is broken is asked for once more.

        The second request gets round the caches on the way, any of which may hold a bad copy.

        Parameters
        ----------
        read : callable
            Makes a picture of an answer, or raises PartError.

        Raises
        ------
        PartError, SourceError, Cancelled
            As `get` does; PartError also where the answer is no picture.
        """
        response, times = self.get(url, what, cancelled, headers), 1
        picture = _picture_or_problem(response, read)
        if isinstance(picture, BrokenPictureError):
            response, times = self.get(url, what, cancelled, _PAST_CACHES), 2
            picture = _picture_or_problem(response, read)
        if isinstance(picture, PartError):
            raise PartError(self.redacted(f"{what}: {picture}{_tried(times)}"))
        return response, picture

    def out_of_reach(self) -> bool:
        """Whether a part found no answer a moment ago, and none has come since."""
        return time.monotonic() < self._silent_until_s

    def redacted(self, text: str) -> str:
        """Return ``text`` without the keys, however they are written in it."""
        for secret in self._secrets:
            for written in {secret, quote(secret), quote(secret, safe=""), quote_plus(secret)}:
                text = text.replace(written, "***")
                if text.endswith(_CUT):
                    # What a provider says may have been cut short amid a key.
                    told = next(
                        (n for n in range(len(written), 0, -1) if text.endswith(written[:n] + _CUT)), 0
                    )
                    text = text[: len(text) - told - len(_CUT)] + ("***" if told else "") + _CUT
        return text

    def words(self, response: Response) -> str:
        """Return the first line of what a provider says, for people, without the keys."""
        return self.redacted(first_words(response.body, response.headers.get("content-type", "")))

    def close(self) -> None:
        """End every wait and request under way; they raise `Cancelled`."""
        self._closed.set()
        self._transport.close()

    def _attempt(self, url: str, cancelled: Stop | None, headers: Mapping[str, str] | None) -> Response:
        self._pause(self._pace.turn_s(), cancelled)
        while not self._free.acquire(timeout=_LOOK_S):
            self._refuse_cancelled(cancelled)
        try:
            # The server may have asked for a rest while this request waited for its turn.
            while held_s := self._pace.held_s():
                self._pause(held_s, cancelled)
            self._refuse_cancelled(cancelled)
            return self._transport.get(url, headers or None, cancelled)
        finally:
            self._free.release()

    def _without_secrets(self, response: Response) -> Response:
        """Leave out headers that quote a key: some are kept in files."""
        if not self._secrets:
            return response
        kept = {name: value for name, value in response.headers.items() if self.redacted(value) == value}
        return response._replace(headers=kept)

    def _judge(self, response: Response, what: str) -> str:
        """Reason to ask again; raises where asking again is of no use."""
        words = self.words(response)
        line = _status_line(response.status) + (f": {words}" if words else "")
        if response.status in _REFUSED or (response.status >= 400 and _is_quota(response.status, words)):
            raise SourceError(f"{self._title} refuses: {line}")
        if response.status in _NOT_THERE:
            raise NotThere(f"{what}: {line}")
        if response.status not in _AGAIN:
            raise PartError(f"{what}: {line}")
        return line

    def _asked_wait_s(self, response: Response, reason: str) -> float:
        """Seconds the server asks to wait, which then hold for every request; 0 where it asks for none."""
        seconds = retry_after_s(response, time.time())
        if seconds > self._longest_retry_after_s:
            raise SourceError(
                f"{self._title}: {reason}; it asks to come back in {seconds:.0f} s: resume then"
            )
        if seconds:
            self._pace.hold(seconds)
        return seconds

    def _backoff_s(self, url: str, attempt: int) -> float:
        """Seconds between attempts, spread by the URL so that parts that failed together do not return so."""
        digest = hashlib.sha256(f"{attempt} {url}".encode()).digest()
        spread = int.from_bytes(digest[:4], "big") / 2**32
        return min(self._first_wait_s * 2.0**attempt, LONGEST_WAIT_S) * (0.5 + spread)

    def _pause(self, seconds: float, cancelled: Stop | None) -> None:
        until_s = time.monotonic() + seconds
        self._refuse_cancelled(cancelled)
        while (left_s := until_s - time.monotonic()) > 0.0:
            self._closed.wait(min(left_s, _LOOK_S))
            self._refuse_cancelled(cancelled)

    def _refuse_cancelled(self, cancelled: Stop | None) -> None:
        if self._closed.is_set() or (cancelled is not None and cancelled()):
            raise Cancelled("cancelled while waiting for the network")


def _tried(times: int) -> str:
    return f" (tried {times} times)" if times > 1 else ""


def _picture_or_problem(response: Response, read: Callable[[Response], Picture]) -> Picture | PartError:
    """What is read; a problem is returned, so that one which quotes a key is no part of that which is raised of it."""
    try:
        return read(response)
    except PartError as wrong:
        return wrong


def _is_conditional(headers: Mapping[str, str] | None) -> bool:
    return any(name.startswith("If-") for name in headers or ())


def retry_after_s(response: Response, now_s: float) -> float:
    """Seconds a response's Retry-After asks to wait (RFC 9110, 10.2.3), 0 without one.

    A date is read against the response's own Date, so that the clocks need not agree.

    Parameters
    ----------
    response : Response
    now_s : float
        Seconds since 1970, for a response without Date.
    """
    asked = response.headers.get("retry-after", "").strip()
    if asked.isdigit():
        return float(asked)
    until_s = http_date_s(asked)
    if until_s is None:
        return 0.0
    since_s = http_date_s(response.headers.get("date", ""))
    return max(until_s - (now_s if since_s is None else since_s), 0.0)


def first_words(body: bytes, content_type: str) -> str:
    """First line of a text, HTML or JSON body, at most 200 characters; empty for anything else."""
    text = body[:16384].decode("utf-8", "replace").lstrip("\ufeff").strip()
    if text.count("\ufffd") > len(text) // 20 or "\0" in text:
        return ""
    if "json" in content_type or text[:1] in ("{", "["):
        text = _json_message(text)
    elif "html" in content_type or "xml" in content_type or text[:1] == "<":
        title = re.search(r"<title[^>]*>(.*?)</title>", text, re.IGNORECASE | re.DOTALL)
        plain = re.sub(r"<(script|style)\b.*?</\1>|<!--.*?-->", " ", text, flags=re.IGNORECASE | re.DOTALL)
        text = title.group(1) if title and title.group(1).strip() else re.sub(r"<[^>]*>", "\n", plain)
        text = html.unescape(text)
    line = next((line.strip() for line in text.splitlines() if line.strip()), "")
    line = "".join(character if character.isprintable() else " " for character in line)
    return line if len(line) <= _WORDS_CHARACTERS else line[: _WORDS_CHARACTERS - 1] + _CUT


def _json_message(text: str) -> str:
    try:
        found = json.loads(text)
    except ValueError:
        return text
    while isinstance(found, (dict, list)):
        if isinstance(found, list):
            found = found[0] if found else ""
            continue
        names = ("message", "error_message", "error", "errors", "detail", "title", "reason")
        found = next((found[name] for name in names if name in found), "")
    return str(found)


def _is_quota(status: int, words: str) -> bool:
    # Too many requests is what a rate limit says at first; only a spent quota ends the run at once.
    if status == HTTPStatus.TOO_MANY_REQUESTS:
        return "quota" in words.lower() or "daily" in words.lower()
    return bool(_QUOTA.search(words))


def _status_line(status: int) -> str:
    try:
        return f"{status} {HTTPStatus(status).phrase}"
    except ValueError:
        return str(status)
