"""What a provider allows."""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass, replace
from typing import Any

from ..errors import InvalidInput, Message, OptionName, SourceError

BULK = ("yes", "ask", "no")
#: Share of a second that requests may be late on their way, so that one more of them would fall into it.
_APART = 0.1


class TermsError(SourceError):
    """A run of more requests than a provider's terms let pass.

    Parameters
    ----------
    title : str
        The source, as people see it.
    policy : Policy
    requests : int
    instead : tuple of str
        Sources that allow it.
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
    """A provider's terms, as far as a program can keep them.

    Parameters
    ----------
    bulk_allowed : str
        ``yes``; ``ask``, where the user must have agreed to the terms; ``no``, which nothing overrides.
    max_tiles : int or None
        Requests of one run that need no asking, or that are the most there may be where bulk is not allowed.
    cache_allowed : bool
        Whether pictures may be kept for a later run.
    max_connections : int or None
    requests_per_s : float or None
    licence : str
        Of the imagery.
    terms : str
        What the provider's terms say of downloading, in short.
    terms_url : str
    rest_s : float
        Seconds from the opening of a source to its first request.
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
            raise InvalidInput(
                "bulk_allowed {0!r} without max_tiles: say how many are no bulk", self.bulk_allowed
            )
        for name in ("max_tiles", "max_connections", "requests_per_s"):
            value = getattr(self, name)
            # Whole numbers may be too large for a float.
            if value is not None and not 0 < value <= sys.float_info.max:
                raise InvalidInput("{0} {1}: must be a number above 0, or left out", name, value)

    def connections(self, wanted: int) -> int:
        """Return the connections to open where ``wanted`` are asked for."""
        return wanted if self.max_connections is None else min(wanted, self.max_connections)

    @property
    def most_sharers(self) -> int | None:
        """Runs that may ask at the same time, each with a share that is a request a second at least; None for any."""
        limits = [self.max_connections, self.requests_per_s and max(math.floor(self.requests_per_s), 1)]
        known = [int(one) for one in limits if one]
        return min(known, default=None)

    def shared(self, sharers: int) -> Policy:
        """Share of each of several runs that ask at the same time, and know nothing of each other.

        No second has more requests in it than the provider allows, whenever these runs come and go, if the shares of
        those under way are never more than the whole: a share is a whole number of requests a second, a little more
        than evenly apart, and the first comes a good second after the run has begun, when what was asked for before it
        with the same share is past.

        Parameters
        ----------
        sharers : int
            `most_sharers` at most; 0 for a run that is alone, which has all there is.
        """
        if sharers == 0 or (self.requests_per_s is None and self.max_connections is None):
            return self
        rate, connections = self.requests_per_s, self.max_connections
        if rate is not None:
            rate = (max(rate // sharers, 1.0) if rate >= 1.0 else rate) / (1.0 + _APART)
        return replace(
            self,
            requests_per_s=rate,
            max_connections=None if connections is None else max(connections // sharers, 1),
            rest_s=0.0 if rate is None else 1.0 + _APART,
        )

    def check(
        self, title: str, requests: int, accept_terms: bool = False, instead: tuple[str, ...] = ()
    ) -> None:
        """Refuse a run of more requests than the terms let pass.

        Parameters
        ----------
        title : str
            The source, as people see it.
        requests : int
            Requests of the run.
        accept_terms : bool
            The user has agreed to the terms; counts for ``ask`` only.
        instead : tuple of str
            Sources that allow it, to be named.

        Raises
        ------
        TermsError
            Quoting the terms.
        """
        if self.stops(requests) and not (self.bulk_allowed == "ask" and accept_terms):
            raise TermsError(title, self, requests, instead)

    def stops(self, requests: int) -> bool:
        """Whether so many requests are more than pass without asking, or at all."""
        return self.bulk_allowed != "yes" and self.max_tiles is not None and requests > self.max_tiles

    def text(self) -> Message:
        """Words for people on how much may be downloaded."""
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
        told = [bulk, *([Message.joined(", ", pace)] if pace else [])]
        told += [] if self.cache_allowed else [Message("nothing may be cached")]
        return Message.joined("; ", told)
