"""What providers' terms mean for live frames."""

from __future__ import annotations

from ..errors import SourceError
from ..imagery.policy import Policy
from ..imagery.source import Source


def check_live(source: Source) -> None:
    """Refuse a source whose provider forbids programs to use its pictures, or to keep them.

    Raises
    ------
    SourceError
        Contains the provider's terms.
    """
    policy = source.policy
    if policy.cache_allowed:
        return
    address = f" ({policy.terms_url})" if policy.terms_url else ""
    raise SourceError(
        "{0}: live frames keep tiles for the next ones, which the terms forbid: {1}{2}",
        source.title,
        policy.terms,
        address,
        remedy="take another source",
    )


def may_prefetch(policy: Policy, accept_terms: bool) -> bool:
    """Whether tiles may be fetched before a frame needs them: where runs of any size are allowed."""
    return policy.bulk_allowed == "yes" or (policy.bulk_allowed == "ask" and accept_terms)
