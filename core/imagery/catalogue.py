"""Sources by name, from the shipped catalogue or the user, and the check of runs against terms."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any

from ..errors import InvalidInput, Message, OptionName
from ..geodesy.mercator import PixelGrid
from ..map_types import MAP_TYPES
from ..storage.config import Shelf, config_file, read_named, read_shelf, write_named
from ..text.plain import listed
from .entry import (
    NAME,
    CatalogueEntry,
    shipped,
    shipped_data,
    shipped_entry,
    under_provider,
)
from .opening import EntrySource, NamedSource, source_kind
from .placeholder import Placeholder
from .source import Source
from .tiles import KEY_ENV, Template, environment_key

FILE = "sources.json"
#: Highest zoom of a template that states none.
DEFAULT_MAX_ZOOM = 22


class CatalogueName(EntrySource):
    """A source by its name in the catalogue or among the user's sources."""

    @property
    def is_local(self) -> bool:
        """Whether this is the embedded world."""
        return self.entry.kind == "world"

    @property
    def is_lit_by_sun(self) -> bool:
        """Whether this is the embedded world."""
        return self.is_local

    @cached_property
    def _wanted(self) -> tuple[str, PixelGrid]:
        """Date and grid chosen by the options; the embedded world also has polar charts."""
        if not (self.is_local and self.options.crs):
            return super()._wanted
        self.entry.grid(self.options.tile_px)
        grid: PixelGrid = self._pixels.chart_grid(self.options.crs)
        return self.entry.date(self.options.date), grid

    def _find(self) -> CatalogueEntry:
        return entry_named(self.text)


class URLTemplate(EntrySource):
    """Tiles by a URL template."""

    @cached_property
    def _template(self) -> Template:
        return Template(self.text)

    @property
    def needs_key(self) -> bool:
        """Whether the text contains {key}, even if it is not a valid template."""
        return "{key}" in self.text

    def environment_key(self) -> str | None:
        """Return the environment's key if the hosts of the template may receive it."""
        return environment_key(self._template.hosts, named_by_user=self.options.named_by_user)

    def _find(self) -> CatalogueEntry:
        data = described(self.text, tile_px=self.options.tile_px or 256, max_zoom=self.options.max_zoom)
        return under_provider(CatalogueEntry.from_dict(self._template.text, data, user=True))


def sources() -> tuple[CatalogueEntry, ...]:
    """Return the catalogue, the embedded world first, then the user's sources (with ``user``)."""
    return (*shipped(), *user_sources())


def source_name(text: str) -> str:
    """Name of the source with this title, or this text in lists, in any case; other text is returned unchanged.

    Parameters
    ----------
    text : str
        A name, a title, an address or a file, as a user enters it.

    Raises
    ------
    InvalidInput
        Several sources have this title.
    """
    if text.lower() in shipped_data() or source_kind(text).name != "catalogue":
        return text
    user_shelf = shelf()
    if text.lower() in {*user_shelf.problems, *(entry.name for entry in user_shelf.entries)}:
        return text
    wanted = " ".join(text.split()).casefold()
    titles = [(name, str(data["title"])) for name, data in shipped_data().items()]
    titles += [(entry.name, entry.title) for entry in user_shelf.entries]
    found = [
        name
        for name, title in titles
        if wanted in (" ".join(one.split()).casefold() for one in (title, listed(name, title)))
    ]
    if len(found) > 1:
        raise InvalidInput("source {0!r}: several have this title; name one of {1}", text, ", ".join(found))
    return found[0] if found else text


def entry_named(name: str) -> CatalogueEntry:
    """Entry of a source by name or title, in any case.

    Raises
    ------
    InvalidInput
        The name is unknown; the error suggests similar ones.
    """
    wanted = source_name(name).lower()
    if wanted in shipped_data():
        return shipped_entry(wanted)
    # The user's file, which may be damaged, is read only for names that are not in the catalogue.
    user_shelf = shelf()
    if wanted in user_shelf.problems:
        raise InvalidInput(user_shelf.problems[wanted])
    entries = {entry.name: entry for entry in user_shelf.entries}
    if wanted in entries:
        return entries[wanted]
    import difflib

    close = difflib.get_close_matches(wanted, [*shipped_data(), *entries], n=3, cutoff=0.5)
    hint = Message("did you mean {0}? ", " or ".join(close)) if close else ""
    raise InvalidInput(
        "source {0!r} is unknown: {1}`terrainav sources` lists the names; a file, a URL template with "
        "{{z}}, {{x}}, {{y}}, and wmts:URL, wms:URL, arcgis:URL and ogcapi:URL work as well",
        name,
        hint,
    )


def alternatives(
    map_types: tuple[str, ...], bounds_deg: tuple[float, float, float, float] | None = None
) -> tuple[str, ...]:
    """Titles and names of sources that allow bulk downloads, best first, with a note if a source requires consent.

    Parameters
    ----------
    map_types : tuple of str
        Wanted map types; empty for any.
    bounds_deg : tuple of float or None
        West, south, east, north of the wanted ground.
    """
    found = [
        entry
        for entry in sources()
        if entry.bulk_allowed != "no"
        and entry.policy.cache_allowed
        and (not map_types or not entry.map_types or set(map_types) & set(entry.map_types))
        and (bounds_deg is None or entry.covers(bounds_deg))
    ]
    # The finest first; the synthetic world, which shows no real place, last.
    found.sort(key=lambda entry: (entry.kind == "world", -entry.native_zoom))
    hint = Message(" (with {0})", OptionName("accept_terms"))
    return tuple(
        Message("{0}{1}", entry.listed, hint) if entry.bulk_allowed == "ask" else entry.listed for entry in found
    )


def check_policy(
    source: Source | NamedSource,
    requests: int,
    *,
    accept_terms: bool = False,
    map_types: tuple[str, ...] = (),
    bounds_deg: tuple[float, float, float, float] | None = None,
) -> None:
    """Refuse a run of more requests than the source's terms allow.

    Parameters
    ----------
    source : Source or NamedSource
    requests : int
        Unique parts of the run, of all map types.
    accept_terms : bool
        The user has agreed to the terms.
    map_types, bounds_deg
        As for `alternatives`, to suggest other sources.

    Raises
    ------
    TermsError
        Contains the terms and, if consent does not help, sources that allow the run.
    """
    instead = alternatives(map_types or source.map_types, bounds_deg) if source.policy.stops(requests) else ()
    source.policy.check(source.title, requests, accept_terms, instead)


def shared_requests(asked: Sequence[tuple[Source | NamedSource, int]]) -> list[int]:
    """Requests of each source of a run, added to the requests of the sources with the same terms.

    Parameters
    ----------
    asked : sequence of (Source or NamedSource, int)
        Sources, which may repeat, and the requests of each.
    """
    policies = [source.policy for source, _ in asked]
    return [sum(requests for (_, requests), other in zip(asked, policies) if other == policy) for policy in policies]


def shelf(folder: str | os.PathLike[str] | None = None) -> Shelf[CatalogueEntry]:
    """Return the user's valid entries, with the providers' terms, and the errors of invalid ones; see `read_shelf`."""
    return read_shelf(config_file(FILE, folder), Message("sources"), _entry)


def user_sources(folder: str | os.PathLike[str] | None = None) -> tuple[CatalogueEntry, ...]:
    """Return the user's valid entries; raises as `shelf` does."""
    return shelf(folder).entries


def described(
    url: str,
    *,
    max_zoom: int | None = None,
    native_zoom: int | None = None,
    tile_px: int = 256,
    default_date: str = "",
    key_env: str = KEY_ENV,
    placeholders: Iterable[str] = (),
    **stated: Any,
) -> dict[str, Any]:
    """Data of an entry for a URL template, for `add`.

    Parameters
    ----------
    url : str
        Template, with {key} in place of the key, which the environment variable ``key_env`` contains.
    max_zoom, native_zoom : int or None
        By default 22, and ``max_zoom``.
    default_date : str
        For a template with {date}; without it, each mission must state a date.
    placeholders : iterable of str
        SHA-256, or the first 16 digits or more, of files that count as missing.
    **stated
        Further fields of an entry: title (its host by default), attribution, licence and other terms.

    Raises
    ------
    InvalidInput
        The template is not valid.
    """
    template = Template(url)
    highest = DEFAULT_MAX_ZOOM if max_zoom is None else max_zoom
    data: dict[str, Any] = {
        "min_zoom": 0,
        **stated,
        "title": stated.get("title") or template.host,
        "kind": "xyz",
        "urls": {"": template.text},
        "tile_px": [tile_px],
        "max_zoom": highest,
        "native_zoom": highest if native_zoom is None else native_zoom,
    }
    if "{s}" in template.text and template.subdomains != ("a", "b", "c"):
        # Keep the text as entered, with its subdomains.
        data["urls"] = {"": url.strip()}
    files = Placeholder().extended(placeholders).sha256
    if files:
        data["placeholder"] = {"sha256": list(files)}
    if "map_type" in template.names:
        data["map_types"] = list(MAP_TYPES)
    if "key" in template.names:
        data["key_env"] = key_env
    if "date" in template.names:
        data["dates"] = {"kind": "any", "default": default_date}
    elif default_date:
        raise InvalidInput("date {0!r}: the URL has no {{date}} to put it in", default_date, field="date")
    return data


def add(name: str, data: Mapping[str, Any], folder: str | os.PathLike[str] | None = None) -> CatalogueEntry:
    """Save a source under a name.

    Parameters
    ----------
    name : str
        An unused name of lower-case letters, digits, hyphens and underscores.
    data : mapping
        In the form of ``resources/sources.json``: from `described`, or `CatalogueEntry.to_data`.

    Raises
    ------
    InvalidInput
        The name or the data is invalid.
    OutputError
        The file cannot be written.
    """
    _check_name(name)
    path = config_file(FILE, folder)
    known = read_named(path, Message("sources"))
    if name in known:
        raise InvalidInput(
            "source name {0!r}: is taken",
            name,
            field="name",
            remedy="choose another, or `terrainav sources remove` it",
        )
    entry = _entry(name, data)
    write_named(path, {**known, name: dict(data)})
    return entry


def remove(name: str, folder: str | os.PathLike[str] | None = None) -> None:
    """Remove a source of the user.

    Raises
    ------
    InvalidInput
        The source is unknown, or part of the catalogue.
    """
    path = config_file(FILE, folder)
    known = read_named(path, Message("sources"))
    if name not in known:
        if name in shipped_data():
            raise InvalidInput("source {0!r}: is part of the catalogue, which stays as it is", name)
        raise InvalidInput(
            "source {0!r}: not one of your own, which are {1}", name, ", ".join(known) or Message("none")
        )
    write_named(path, {other: data for other, data in known.items() if other != name})


def _check_name(name: str) -> None:
    if not NAME.fullmatch(name):
        raise InvalidInput(
            "source name {0!r}: must be lower-case letters, digits, hyphens and underscores, at most 64",
            name,
            field="name",
        )
    if name in shipped_data():
        raise InvalidInput("source name {0!r}: is one of the catalogue's", name, field="name", remedy="choose another")


def _entry(name: str, data: Any) -> CatalogueEntry:
    _check_name(name)
    if not isinstance(data, Mapping):
        raise InvalidInput("catalogue entry {0!r}: must be an object", name)
    entry = CatalogueEntry.from_dict(name, data, user=True)
    if entry.kind != "xyz":
        raise InvalidInput("catalogue entry {0!r}: must be of kind xyz", name)
    return under_provider(entry)
