"""The sources TerrAInav knows by name, and what their providers' terms let pass."""

from __future__ import annotations

import difflib

from ...errors import InvalidInput
from ..source import Source
from .entry import CatalogueEntry, shipped
from .user_sources import shelf, user_sources

__all__ = ["CatalogueEntry", "alternatives", "check_policy", "entry_named", "sources"]


def sources() -> tuple[CatalogueEntry, ...]:
    """Return the catalogue, the embedded world first, then the user's own sources (``user`` is True)."""
    return (*shipped(), *user_sources())


def entry_named(name: str) -> CatalogueEntry:
    """Entry of a name, in any case.

    Raises
    ------
    InvalidInput
        Naming those that are close.
    """
    # The user's file, which may be broken, is read only for what is not in the catalogue.
    entries = {entry.name: entry for entry in shipped()}
    if name.lower() not in entries:
        own = shelf()
        if name.lower() in own.problems:
            raise InvalidInput(own.problems[name.lower()])
        entries.update((entry.name, entry) for entry in own.entries)
    if name.lower() in entries:
        return entries[name.lower()]
    close = difflib.get_close_matches(name.lower(), entries, n=3, cutoff=0.5)
    hint = f"did you mean {' or '.join(close)}? " if close else ""
    raise InvalidInput(
        f"source {name!r} is unknown: {hint}`terrainav sources` lists the names; a file, a URL template with "
        "{z}, {x}, {y}, wmts:URL and wms:URL work as well"
    )


def alternatives(
    map_types: tuple[str, ...], bounds_deg: tuple[float, float, float, float] | None = None
) -> tuple[str, ...]:
    """Names of sources that much may be had from, best first; those that ask for consent say so.

    Parameters
    ----------
    map_types : tuple of str
        Those wanted; empty where it does not matter.
    bounds_deg : tuple of float or None
        West, south, east, north of the ground wanted.
    """
    found = [
        entry
        for entry in sources()
        if entry.bulk_allowed != "no"
        and entry.policy.cache_allowed
        and (not map_types or not entry.map_types or set(map_types) & set(entry.map_types))
        and (bounds_deg is None or entry.covers(bounds_deg))
    ]
    # Of those that cover the place, the finer first; the synthetic world, which shows no place, last.
    found.sort(key=lambda entry: (entry.kind == "world", -entry.native_zoom))
    return tuple(
        entry.name + (" (with --accept-terms)" if entry.bulk_allowed == "ask" else "") for entry in found
    )


def check_policy(
    source: Source,
    requests: int,
    *,
    accept_terms: bool = False,
    map_types: tuple[str, ...] = (),
    bounds_deg: tuple[float, float, float, float] | None = None,
) -> None:
    """Refuse a run of more requests than the source's terms let pass.

    Parameters
    ----------
    source : Source
    requests : int
        Unique parts of the run, over all map types.
    accept_terms : bool
        The user has agreed to the terms.
    map_types, bounds_deg
        What is wanted and where, for naming other sources; see `alternatives`.

    Raises
    ------
    SourceError
        Quoting the terms and, where nothing can be done about them, naming sources that allow it.
    """
    instead = alternatives(map_types or source.map_types, bounds_deg) if source.policy.stops(requests) else ()
    source.policy.check(source.title, requests, accept_terms, instead)
