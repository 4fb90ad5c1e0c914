"""Sources of imagery on the command line: listed, shown, added, removed."""

from __future__ import annotations

import argparse
import json
import sys
import textwrap
from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput, Message, SourceError
from ..text import printable
from .exits import DONE

if TYPE_CHECKING:
    from ..imagery.entry import CatalogueEntry

_COLUMN = 22
#: Characters of a line of what is longer than one.
_WIDTH = 110


def run_sources(arguments: argparse.Namespace) -> int:
    """List, show, add or remove sources."""
    actions = {"show": _show, "add": _add, "remove": _remove}
    return actions.get(arguments.action or "", _list)(arguments)


def _list(arguments: argparse.Namespace) -> int:
    from ..imagery.catalogue import shelf
    from ..imagery.entry import shipped

    own = shelf()
    entries = (*shipped(), *own.entries)
    for problem in own.problems.values():
        print(f"terrainav: {printable(problem)}", file=sys.stderr)
    if arguments.json:
        print(json.dumps([entry.to_dict() for entry in entries], indent=1))
        return DONE
    for entry in entries:
        mark = " (your own)" if entry.user else ""
        dates = f"; dates: {entry.dates.text()}" if entry.dates else ""
        print(f"{entry.name:{_COLUMN}s}{entry.title}{mark}")
        print(
            f"{'':{_COLUMN}s}zoom {entry.min_zoom} to {entry.native_zoom}, bulk download: {entry.bulk_allowed}; "
            f"{entry.licence or 'licence not stated'}{dates}"
        )
    print(
        "\nA URL template with {z} {x} {y}, wmts:URL, wms:URL and a file work as sources too; see "
        "terrainav sources --help."
    )
    return DONE


def _show(arguments: argparse.Namespace) -> int:
    from ..imagery.opening import SourceOptions, named_source

    source = named_source(arguments.source, SourceOptions(crs=arguments.crs, named_by_user=True))
    offered = source.layers()
    if offered is not None:
        if arguments.json:
            print(json.dumps([{"name": layer.name, "title": layer.title} for layer in offered], indent=1))
            return DONE
        if not offered:
            raise SourceError("{0}: offers no layers", arguments.source)
        for layer in offered:
            print(printable(f"{layer.name:{_COLUMN}s} {layer.title}"))
        return DONE
    entry = source.entry
    # Some sources have several besides that of their entry, and refuse others by themselves.
    crs = source.grid.plane.crs if arguments.crs else ""
    if arguments.json:
        print(json.dumps(entry.to_dict(), indent=1))
        return DONE
    for label, text in _described(entry, crs):
        if text:
            print(printable(f"{label:{_COLUMN}s}{text}"))
    if entry.dates is not None and entry.dates.values:
        margin = " " * _COLUMN
        listed = ", ".join(sorted(entry.dates.values))
        wrapped = textwrap.fill(
            printable(listed), _WIDTH, initial_indent=margin, subsequent_indent=margin, break_on_hyphens=False
        )
        print(f"{'each of the dates':{_COLUMN}s}{wrapped.strip()}")
    return DONE


def _described(entry: CatalogueEntry, crs: str) -> list[tuple[str, str]]:
    from ..imagery.systems import MAP

    policy = entry.policy
    placeholders = entry.placeholder
    marks = len(placeholders.sha256) + len(placeholders.header) + len(placeholders.flat_rgb)
    urls = [(f"URL{f' ({map_type})' if map_type else ''}", url) for map_type, url in entry.urls.items()]
    return [
        ("name", entry.name + (" (your own)" if entry.user else "")),
        ("title", entry.title),
        ("area", entry.area),
        ("map types", ", ".join(entry.map_types) or "one kind of picture"),
        ("reference system", crs or (MAP if entry.plane is None else entry.plane.crs)),
        ("zooms", f"{entry.min_zoom} to {entry.max_zoom}, detail to {entry.native_zoom}"),
        ("tiles", f"{' or '.join(map(str, entry.tile_px))} px"),
        ("dates", entry.dates.text() if entry.dates else "none to choose from"),
        ("attribution", entry.attribution or "not stated"),
        ("licence", policy.licence or "not stated"),
        ("bulk download", f"{policy.bulk_allowed}: {policy.text()}"),
        ("terms", policy.terms),
        ("terms page", policy.terms_url),
        ("placeholders", f"{marks} known" if marks else "none known"),
        ("key", f"environment variable {entry.key_env}" if entry.key_env else "none needed"),
        *urls,
    ]


def _add(arguments: argparse.Namespace) -> int:
    from ..imagery.catalogue import add, described
    from ..imagery.opening import SourceOptions, kind_of, named_source
    from ..imagery.placeholder import Placeholder
    from ..imagery.systems import MAP, refused

    given: dict[str, Any] = {
        "title": arguments.title,
        "attribution": arguments.attribution,
        "licence": arguments.licence,
        "terms_url": arguments.terms_url,
        "min_zoom": arguments.min_zoom,
        "max_zoom": arguments.max_zoom,
        "native_zoom": arguments.native_zoom,
        "max_connections": arguments.max_connections,
        "requests_per_s": arguments.requests_per_s,
        "key_env": arguments.key_env,
    }
    given = {name: value for name, value in given.items() if value is not None}
    if arguments.no_storing:
        given["cache_allowed"] = False
    placeholders = arguments.placeholder or ()
    if kind_of(arguments.url).is_service:
        if arguments.default_date is not None:
            raise InvalidInput("--default-date: the dates of a service are those of its capabilities")
        asked = SourceOptions(tile_px=arguments.tile_size, crs=arguments.crs, named_by_user=True)
        entry = named_source(arguments.url, asked).entry
        files = list(Placeholder().with_files(placeholders).sha256)
        data = {**entry.to_data(), **given, **({"placeholder": {"sha256": files}} if files else {})}
    else:
        if arguments.crs not in ("", MAP):
            raise refused(arguments.crs, Message("a URL template"), [MAP])
        if arguments.tile_size is not None:
            given["tile_px"] = arguments.tile_size
        data = described(
            arguments.url, **given, default_date=arguments.default_date or "", placeholders=placeholders
        )
    added = add(arguments.name, data)
    print(f"{added.name} added: {added.title}")
    print(f"{added.bulk_allowed}: {added.policy.text()}")
    return DONE


def _remove(arguments: argparse.Namespace) -> int:
    from ..imagery.catalogue import remove

    remove(arguments.name)
    print(f"{arguments.name} removed")
    return DONE
