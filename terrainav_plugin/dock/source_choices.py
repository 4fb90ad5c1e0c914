"""The entries of the source chooser: catalogue, the user's own sources, the project's layers, and files."""

from __future__ import annotations

import html
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import QgsProject

from ...core.errors import InvalidInput
from ..i18n import tr
from ..layers.snapshot import is_of_qgis, layer_choices
from .choices import CATALOGUE, FILE, OWN, PROJECT, SourceChoice

if TYPE_CHECKING:
    from ...core.imagery.catalogue.entry import CatalogueEntry


def source_choices(project: QgsProject) -> tuple[list[SourceChoice], str]:
    """Entries of the source chooser, the embedded world first; and what is wrong with the user's own sources."""
    from ...core.imagery.catalogue.entry import shipped
    from ...core.imagery.catalogue.user_sources import user_sources

    wrong = ""
    entries = list(shipped())
    try:
        entries += user_sources()
    except InvalidInput as unreadable:
        wrong = str(unreadable)
    choices = [_of_entry(entry) for entry in entries]
    drawn = tr("Drawn by QGIS as the map shows it, and read from where the layer's data are.")
    choices += [
        SourceChoice(name, title, group=PROJECT, limits=html.escape(drawn))
        for name, title in layer_choices(project)
    ]
    return choices, wrong


def unlisted(name: str) -> SourceChoice | None:
    """Entry for a source that the chooser does not list: a file, or a layer that is not there (any more)."""
    from ...core.imagery.opening import is_file

    if is_of_qgis(name):
        return SourceChoice(name, tr("Layer that is not there"), group=PROJECT)
    if is_file(name):
        return SourceChoice(name, Path(name).name, group=FILE, limits=html.escape(name))
    return None


def _of_entry(entry: CatalogueEntry) -> SourceChoice:
    dates = entry.dates
    return SourceChoice(
        entry.name,
        entry.title,
        tuple(entry.map_types),
        entry.key_env is not None,
        OWN if entry.user else CATALOGUE,
        limits_html(entry),
        "" if dates is None else _without_options(dates.text()),
        "" if dates is None else dates.default,
    )


def limits_html(entry: CatalogueEntry) -> str:
    """What a source's provider allows, in a few lines."""
    if entry.kind == "world":
        return html.escape(tr("Computed on this computer, for any place; no limits."))
    policy = entry.policy
    if policy.bulk_allowed == "yes" or policy.max_tiles is None:
        bulk = tr("any number of requests")
    elif policy.bulk_allowed == "ask":
        bulk = tr("more than {count} requests after agreeing to the terms").format(
            count=f"{policy.max_tiles:,}"
        )
    else:
        bulk = tr("at most {count} requests").format(count=f"{policy.max_tiles:,}")
    words = [bulk, tr("zoom {least} to {most}").format(least=entry.min_zoom, most=entry.max_zoom)]
    if entry.native_zoom < entry.max_zoom:
        words[-1] += tr(" (own detail to {native})").format(native=entry.native_zoom)
    if policy.max_connections is not None:
        words.append(tr("{count} connections").format(count=policy.max_connections))
    if policy.requests_per_s is not None:
        words.append(tr("{rate:g} requests a second").format(rate=policy.requests_per_s))
    words.append(tr("kept in the cache") if policy.cache_allowed else tr("not kept in the cache"))
    words[0] = words[0][:1].upper() + words[0][1:]
    text = html.escape("; ".join(words))
    licence = html.escape(policy.licence or tr("Licence not stated"))
    if policy.terms_url:
        terms = f'<a href="{html.escape(policy.terms_url)}">{html.escape(tr("terms"))}</a>'
        licence = f"{licence} ({terms})"
    return f"{text}.<br/>{licence}"


def _without_options(text: str) -> str:
    """Words of the core without the names of its command's options."""
    return text.replace(" (--date)", "")
