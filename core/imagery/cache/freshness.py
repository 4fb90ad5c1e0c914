"""How long an answer may be kept and used again (RFC 9111, for the cache of one user), and how it is asked for anew."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import NamedTuple

from ...limits import MAX_HEADER_CHARACTERS
from ...text.plain import whole_number
from ..http.transport import http_date_s

#: Lifetime of an answer that says nothing of one, seconds: a week, the least the tile usage policy of
#: OpenStreetMap asks of its users.
HEURISTIC_LIFETIME_S = 7 * 86400
#: What a longer lifetime counts as, seconds (RFC 9111, 1.2.2).
LONGEST_LIFETIME_S = 2**31
_DIRECTIVE = re.compile(r"([\w!#$%&'*+.^`|~-]+)(?:\s*=\s*(\"(?:[^\"\\]|\\.)*\"|[^\s,]*))?")


class Freshness(NamedTuple):
    """Until when a stored answer is fresh, and what becomes of it then.

    Parameters
    ----------
    expires_s : int
        Seconds since 1970.
    lifetime_s : int
        Its lifetime, for a confirmation (304) that states none.
    stale_allowed : bool
        Whether it may be used after that while the provider cannot be reached.
    etag, last_modified : str
        Validators as they were sent; empty without.
    """

    expires_s: int
    lifetime_s: int
    stale_allowed: bool
    etag: str
    last_modified: str

    def is_fresh(self, now_s: float) -> bool:
        """Whether it may be used without asking."""
        return now_s < self.expires_s

    def conditions(self) -> dict[str, str]:
        """Headers that ask for the answer only where it has changed; empty without a validator."""
        headers = {"If-None-Match": self.etag, "If-Modified-Since": self.last_modified}
        return {name: value for name, value in headers.items() if value}

    def renewed(self, headers: Mapping[str, str], now_s: float) -> Freshness | None:
        """Freshness after a 304 with ``headers``; None where the answer must not be kept any longer."""
        new = freshness(headers, now_s, self.lifetime_s)
        if new is None:
            return None
        says_all = "cache-control" in headers
        return new._replace(
            stale_allowed=new.stale_allowed if says_all else self.stale_allowed,
            etag=new.etag or self.etag,
            last_modified=new.last_modified or self.last_modified,
        )


def freshness(
    headers: Mapping[str, str], now_s: float, otherwise_s: float = HEURISTIC_LIFETIME_S
) -> Freshness | None:
    """Freshness of an answer that has just come; None where it must not be stored.

    Requests for tiles differ in nothing but the URL, so that any Vary but ``*`` is met.

    Parameters
    ----------
    headers : mapping
        Names in lower case.
    now_s : float
        Seconds since 1970.
    otherwise_s : float
        Lifetime where the headers state none.
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
    """Directives of a Cache-Control header and their values; of two of a name, the smaller number."""
    found: dict[str, str] = {}
    for name, value in _DIRECTIVE.findall(text[:MAX_HEADER_CHARACTERS]):
        plain = value.strip('"')
        before, now = whole_number(found.get(name.lower(), "")), whole_number(plain)
        if before is None or now is None or now < before:
            found[name.lower()] = plain
    return found


def _sendable(value: str) -> str:
    """Return a header's value if it can be sent back, else nothing."""
    sound = len(value) <= MAX_HEADER_CHARACTERS and value.isascii() and value.isprintable()
    return value if sound else ""


def _lifetime_s(
    headers: Mapping[str, str], directives: Mapping[str, str], now_s: float, otherwise_s: float
) -> float:
    if "no-cache" in directives:
        return 0.0
    if "max-age" in directives:
        # What is no number counts as past (RFC 9111, 4.2.1).
        return float(whole_number(directives["max-age"]) or 0)
    if "expires" in headers:
        expires_s = http_date_s(headers["expires"])
        sent_s = http_date_s(headers.get("date", ""))
        return 0.0 if expires_s is None else max(expires_s - (now_s if sent_s is None else sent_s), 0.0)
    return otherwise_s


def _age_s(headers: Mapping[str, str], now_s: float) -> float:
    """Age of an answer as it comes, from the caches on its way or from its own date (RFC 9111, 4.2.3).

    The time the answer took is left out: it counts in seconds, lifetimes of tiles count in hours.
    """
    stated_s = float(whole_number(headers.get("age", "")) or 0)
    sent_s = http_date_s(headers.get("date", ""))
    apparent_s = 0.0 if sent_s is None else max(now_s - sent_s, 0.0)
    return min(max(stated_s, apparent_s), float(LONGEST_LIFETIME_S))
