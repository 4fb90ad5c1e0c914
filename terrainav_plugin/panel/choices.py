"""Choices of the panel: cameras by name, and sources of all kinds."""

from __future__ import annotations

import html
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from qgis.core import QgsProject

from ...core.errors import InvalidInput, TerrAInavError
from ..i18n import number_text, tr, translate
from ..qgis_source.connections import (
    SERVICE_PREFIX,
    XYZ,
    connection,
    connection_names,
    is_connection,
    service_names,
)
from ..qgis_source.snapshot import is_of_qgis, layer_choices

if TYPE_CHECKING:
    from ...core.imagery.entry import CatalogueEntry

#: Groups of the source chooser, in order.
CATALOGUE, REGIONAL, OWN, CONNECTION, SERVICE, PROJECT, FILE, OTHER = range(8)


class SourceChoice(NamedTuple):
    """An entry of the source chooser.

    Parameters
    ----------
    name, title : str
    map_types : tuple of str
        Empty for a source with one kind of image.
    needs_key : bool
    group : int
        Group in the chooser, such as `CATALOGUE`.
    limits : str
        Terms of the source's provider, as HTML.
    dates : str
        Text on the available dates; empty if there is only one.
    default_date : str
    may_authenticate : bool
        Whether requests to the source can be authenticated.
    """

    name: str
    title: str
    map_types: tuple[str, ...] = ()
    needs_key: bool = False
    group: int = CATALOGUE
    limits: str = ""
    dates: str = ""
    default_date: str = ""
    may_authenticate: bool = False


class CameraChoice(NamedTuple):
    """An entry of the camera chooser.

    Parameters
    ----------
    name : str
    fov_deg : float
        Diagonal field of view.
    aspect_ratio : float
    sensor_mm : (width, height) or None
        Size of the sensor, if known.
    image_px : int or None
        Number of pixels along the longer side of an image, if known.
    tip : str
        Description of the camera, with the source of its data.
    user : bool
        Whether the user has saved the camera.
    lens : tuple of (str, float or str)
        Fields of its lens.
    """

    name: str
    fov_deg: float
    aspect_ratio: float
    sensor_mm: tuple[float, float] | None = None
    image_px: int | None = None
    tip: str = ""
    user: bool = False
    lens: tuple[tuple[str, Any], ...] = ()


def source_choices(project: QgsProject) -> tuple[list[SourceChoice], str]:
    """Entries of the source chooser, the synthetic world first; and a text on problems with the user's sources."""
    from ...core.imagery.catalogue import shelf
    from ...core.imagery.entry import shipped

    wrong = ""
    entries = list(shipped())
    try:
        own = shelf()
        entries += own.entries
        wrong = "; ".join(map(translate, own.problems.values()))
    except InvalidInput as unreadable:
        wrong = translate(unreadable)
    choices = [_entry_choice(entry) for entry in entries]
    choices += [_connection_choice(name) for name in connection_names()]
    asked = tr("A service with several layers: choose it, then a layer. The layer is saved with your own sources.")
    choices += [
        SourceChoice(SERVICE_PREFIX + name, tr("{name}…").format(name=name), group=SERVICE, limits=asked)
        for name in service_names()
    ]
    drawn = tr("QGIS draws it as on the map, from the layer's data source.")
    choices += [
        SourceChoice(name, title, group=PROJECT, limits=html.escape(drawn)) for name, title in layer_choices(project)
    ]
    return sorted(choices, key=lambda choice: choice.group), wrong


def unlisted(name: str) -> SourceChoice | None:
    """Entry for a source that the chooser does not list: a file, or a layer that does not exist (any more)."""
    from ...core.imagery.opening import source_kind

    if is_connection(name):
        title = tr("Missing connection")
        return SourceChoice(name, title, group=CONNECTION, limits=html.escape(name[len(XYZ) :]))
    if is_of_qgis(name):
        return SourceChoice(name, tr("Missing layer"), group=PROJECT)
    if source_kind(name).is_file:
        return SourceChoice(name, Path(name).name, group=FILE, limits=html.escape(name))
    return None


def template_limits(template: str) -> str:
    """Terms of the provider of a URL template, as HTML; empty for an invalid template."""
    from ...core.imagery.opening import named_source, source_kind

    kind = source_kind(template)
    if not kind.is_address or kind.is_service:
        return ""
    try:
        return limits_html(named_source(template).entry)
    except TerrAInavError:
        return ""


def limits_html(entry: CatalogueEntry) -> str:
    """Terms of a source's provider, in a few lines."""
    if entry.kind == "world":
        return html.escape(tr("Computed on this computer for any place, without limits."))
    policy = entry.policy
    if policy.bulk_allowed == "yes" or policy.max_tiles is None:
        bulk = tr("unlimited requests")
    elif policy.bulk_allowed == "ask":
        bulk = tr("over {count} requests require accepting the terms").format(count=number_text(policy.max_tiles))
    else:
        bulk = tr("at most {count} requests").format(count=number_text(policy.max_tiles))
    words = [bulk, tr("zoom {least} to {most}").format(least=entry.min_zoom, most=entry.max_zoom)]
    if entry.native_zoom < entry.max_zoom:
        words[-1] += tr(" (native up to zoom {native})").format(native=entry.native_zoom)
    if policy.max_connections is not None:
        words.append(tr("{count} connections").format(count=policy.max_connections))
    if policy.requests_per_s is not None:
        words.append(tr("{rate} requests a second").format(rate=number_text(policy.requests_per_s, "g")))
    words.append(tr("tiles are cached") if policy.cache_allowed else tr("tiles are not cached"))
    words[0] = words[0][:1].upper() + words[0][1:]
    text = html.escape("; ".join(words))
    if entry.user and not (policy.licence or policy.terms or policy.terms_url):
        unknown = tr("Its terms are unknown: check them yourself.")
        return f"{text}.<br/>{html.escape(unknown)}"
    licence = html.escape(policy.licence or tr("Licence not stated"))
    if policy.terms_url:
        terms = f'<a href="{html.escape(policy.terms_url)}">{html.escape(tr("terms"))}</a>'
        licence = f"{licence} ({terms})"
    return f"{text}.<br/>{licence}"


def _entry_choice(entry: CatalogueEntry) -> SourceChoice:
    dates = entry.dates
    return SourceChoice(
        entry.name,
        entry.title,
        tuple(entry.map_types),
        entry.key_env is not None,
        _group(entry),
        limits_html(entry),
        "" if dates is None else translate(dates.text()),
        "" if dates is None else dates.default,
        entry.user,
    )


def _group(entry: CatalogueEntry) -> int:
    if entry.user:
        return OWN
    from ...core.imagery.entry import WORLD_DEG

    return CATALOGUE if entry.bounds_deg == WORLD_DEG else REGIONAL


def _connection_choice(name: str) -> SourceChoice:
    try:
        limits = limits_html(connection(XYZ + name).entry())
    except InvalidInput as wrong:
        limits = html.escape(translate(wrong))
    return SourceChoice(XYZ + name, name, group=CONNECTION, limits=limits)
