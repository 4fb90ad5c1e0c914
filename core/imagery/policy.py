"""Terms of a provider: number and rate of requests, and whether pictures may be kept."""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass, replace
from typing import Any

from ..errors import InvalidInput, Message, OptionName, SourceError

BULK = ("yes", "ask", "no")


class TermsError(SourceError):
    """A run of more requests than a provider's terms allow.

    Parameters
    ----------
    title : str
        Title of the source.
    policy : Policy
    requests : int
    instead : tuple of str
        Sources that allow such a run.
    """

    def __init__(self, title: str, policy: Policy, requests: int, instead: tuple[str, ...] = ()) -> None:
        can_agree = policy.bulk_allowed == "ask"
        if can_agree:
            way_out = Message("agree to the terms first{0}", OptionName("accept_terms").in_brackets)
        elif instead:
            way_out = Message("sources that allow it: {0}", Message.joined(", ", instead))
        else:
            way_out = Message("take another source")
        refused = Message(
            "{0}: {1:,} requests, but at most {2:,} are allowed without {3}: {4}{5}",
            title,
            requests,
            policy.max_tiles,
            Message("agreeing to its terms") if can_agree else Message("breaking its terms"),
            policy.terms,
            f" ({policy.terms_url})" if policy.terms_url else "",
        )
        super().__init__(refused, remedy=way_out)
        self.title, self.policy, self.requests, self.instead = title, policy, requests, instead
        #: Whether agreeing to the terms is enough.
        self.can_agree = can_agree

    def __reduce__(self) -> tuple[Any, ...]:
        return TermsError, (self.title, self.policy, self.requests, self.instead)


@dataclass(frozen=True)
class Policy:
    """A provider's terms, as far as a program can comply.

    Parameters
    ----------
    bulk_allowed : str
        ``yes``; ``ask`` if the user must have agreed to the terms; ``no``, which nothing overrides.
    max_tiles : int or None
        Most requests of one run without consent (``ask``) or at all (``no``).
    cache_allowed : bool
        Whether pictures may be kept for a later run.
    max_connections : int or None
    requests_per_s : float or None
    licence : str
        Licence of the imagery.
    terms : str
        Summary of the terms for downloads.
    terms_url : str
    rest_s : float
        Seconds from opening a source to its first request.
    """

    bulk_allowed: str = "yes"
    max_tiles: int | None = None
    cache_allowed: bool = True
    max_connections: int | None = None
    requests_per_s: float | None = None
    licence: str = ""
    terms: str = ""
    terms_url: str = ""
    rest_s: float = 0.0

    def __post_init__(self) -> None:
        if self.bulk_allowed not in BULK:
            raise InvalidInput("bulk_allowed {0!r}: must be one of {1}", self.bulk_allowed, ", ".join(BULK))
        if self.bulk_allowed != "yes" and self.max_tiles is None:
            raise InvalidInput("bulk_allowed {0!r} without max_tiles: say how many are no bulk", self.bulk_allowed)
        for name in ("max_tiles", "max_connections", "requests_per_s"):
            value = getattr(self, name)
            # Whole numbers may be too large for a float.
            if value is not None and not 0 < value <= sys.float_info.max:
                raise InvalidInput("{0} {1}: must be a number above 0, or left out", name, value)

    def connections(self, wanted: int) -> int:
        """Return the number of connections to open, at most ``wanted``."""
        return wanted if self.max_connections is None else min(wanted, self.max_connections)

    @property
    def most_sharers(self) -> int | None:
        """Most simultaneous runs with one connection and one request per second for each; None if unlimited."""
        limits = [self.max_connections, self.requests_per_s and max(math.floor(self.requests_per_s), 1)]
        known = [int(one) for one in limits if one]
        return min(known, default=None)

    def shared(self, sharers: int) -> Policy:
        """Share of the limits for each of several independent, simultaneous runs.

        As long as the shares of simultaneous runs add up to no more than the limits, no second has more requests than
        the provider allows, whenever runs begin and end. To ensure this, a share is a whole number of requests per
        second, spaced slightly wider than evenly, and a run starts its first request after more than a second: by then,
        the last request of an earlier run with the same share is over a second old.

        Parameters
        ----------
        sharers : int
            Number of runs, up to `most_sharers`; 0 for a single run, which has no reduced limits.
        """
        if sharers == 0 or (self.requests_per_s is None and self.max_connections is None):
            return self
        # Longest assumed delay of a request in the network, which could move one more request into a second.
        delay_s = 0.1
        rate, connections = self.requests_per_s, self.max_connections
        if rate is not None:
            rate = (max(rate // sharers, 1.0) if rate >= 1.0 else rate) / (1.0 + delay_s)
        return replace(
            self,
            requests_per_s=rate,
            max_connections=None if connections is None else max(connections // sharers, 1),
            rest_s=0.0 if rate is None else 1.0 + delay_s,
        )

    def check(self, title: str, requests: int, accept_terms: bool = False, instead: tuple[str, ...] = ()) -> None:
        """Refuse a run of more requests than the terms allow.

        Parameters
        ----------
        title : str
            Title of the source.
        requests : int
            Requests of the run.
        accept_terms : bool
            Whether the user has agreed to the terms; has an effect for ``ask`` only.
        instead : tuple of str
            Sources to suggest.

        Raises
        ------
        TermsError
            Contains the terms.
        """
        if self.stops(requests) and not (self.bulk_allowed == "ask" and accept_terms):
            raise TermsError(title, self, requests, instead)

    def stops(self, requests: int) -> bool:
        """Whether a number of requests exceeds `max_tiles`, so that consent is required or the run is refused."""
        return self.bulk_allowed != "yes" and self.max_tiles is not None and requests > self.max_tiles

    def text(self) -> Message:
        """Description for people of the allowed downloads."""
        if self.bulk_allowed == "yes" or self.max_tiles is None:
            bulk = Message("unlimited requests")
        elif self.bulk_allowed == "ask":
            bulk = Message(
                "over {0:,} requests require accepting the terms{1}",
                self.max_tiles,
                OptionName("accept_terms").in_brackets,
            )
        else:
            bulk = Message("at most {0:,} requests, whatever you agree to", self.max_tiles)
        pace = [] if self.max_connections is None else [Message("{0} connections", self.max_connections)]
        pace += [] if self.requests_per_s is None else [Message("{0:g} requests/s", self.requests_per_s)]
        parts = [bulk, *([Message.joined(", ", pace)] if pace else [])]
        parts += [] if self.cache_allowed else [Message("nothing may be cached")]
        return Message.joined("; ", parts)
