"""Whom a key is for: the one of the environment goes to hosts that the user has named, and to no other.

An address in a mission file, a config file or a server's document may have been written by anybody.
"""

from __future__ import annotations

import os
from collections.abc import Iterable

from ..errors import SourceError
from .catalogue.entry import KEY_ENV

#: Environment variable with the hosts that the key is for, with commas or spaces between them.
HOSTS_ENV = "TERRAINAV_KEY_HOSTS"


def environment_key(hosts: Iterable[str], *, named_by_user: bool) -> str | None:
    """Return the environment's key for an address that holds ``{key}``; None where there is none.

    Parameters
    ----------
    hosts : iterable of str
        All that the address leads to.
    named_by_user : bool
        Whether the user has named the address himself, for this run.

    Raises
    ------
    SourceError
        There is a key, and it is for other hosts.
    """
    key = os.environ.get(KEY_ENV)
    if not key or named_by_user:
        return key or None
    known = os.environ.get(HOSTS_ENV, "").replace(",", " ").lower().split()
    for host in hosts:
        if not any(host == own or host.endswith("." + own) for own in (one.strip(".") for one in known)):
            raise SourceError(
                f"{host}: {KEY_ENV} is not sent there, because a file names this host and not you; "
                f"set {HOSTS_ENV}={host} if the key is for it"
            )
    return key
