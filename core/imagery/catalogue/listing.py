"""The sources TerrAInav knows by name, and what their providers' terms let pass."""

from __future__ import annotations

import difflib
from functools import cached_property
from typing import Protocol

from ...errors import InvalidInput
from ..keys import environment_key
from ..named import EntrySource
from ..policy import Policy
from ..template import Template
from .entry import CatalogueEntry, shipped, under_provider
from .user_sources import described, shelf, user_sources


class CatalogueName(EntrySource):
    """A source by its name in the catalogue or among the user's own."""

    @property
    def is_local(self) -> bool:
        """Whether it is the embedded world."""
        return self.entry.kind == "world"

    def _find(self) -> CatalogueEntry:
        return entry_named(self.text)


class URLTemplate(EntrySource):
    """Tiles by a URL template."""

    @cached_property
    def _template(self) -> Template:
        return Template(self.text)

    @property
    def needs_key(self) -> bool:
        """Whether a key stands in it, be it right otherwise or not."""
        return "{key}" in self.text

    def environment_key(self) -> str | None:
        """Return the environment's key, if that is for its hosts."""
        return environment_key(self._template.hosts, named_by_user=self.options.named_by_user)

    def _find(self) -> CatalogueEntry:
        # A provider's terms hold however its tiles are asked for.
        data = described(self.text, tile_px=self.options.tile_px or 256, max_zoom=self.options.max_zoom)
        return under_provider(CatalogueEntry.from_dict(self._template.text, data, user=True))


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


class _WithTerms(Protocol):
    """A source, or what a text names one by."""

    @property
    def title(self) -> str: ...

    @property
    def map_types(self) -> tuple[str, ...]: ...

    @property
    def policy(self) -> Policy: ...


def check_policy(
    source: _WithTerms,
    requests: int,
    *,
    accept_terms: bool = False,
    map_types: tuple[str, ...] = (),
    bounds_deg: tuple[float, float, float, float] | None = None,
) -> None:
    """Refuse a run of more requests than the source's terms let pass.

    Parameters
    ----------
    source : Source or NamedSource
    requests : int
        Unique parts of the run, over all map types.
    accept_terms : bool
        The user has agreed to the terms.
    map_types, bounds_deg
        What is wanted and where, for naming other sources; see `alternatives`.

    Raises
    ------
    TermsError
        Quoting the terms and, where nothing can be done about them, naming sources that allow it.
    """
    instead = alternatives(map_types or source.map_types, bounds_deg) if source.policy.stops(requests) else ()
    source.policy.check(source.title, requests, accept_terms, instead)
