"""Which kind of service is at an address: told by the address where it says so, and by what the server answers."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

from ...errors import InvalidInput, Message, SourceError
from ...text.safe_json import parse_json
from ..opening import NamedSource, SourceOptions, named_source, source_kind
from .capabilities import ROOTS, Offered, asked
from .ogcapi import OGCAPITiles

#: What addresses say, by the kind that they say it of; the first is tried first. A WMS or WMTS of ArcGIS Server ends
#: with its own name.
_HINTS = (
    (re.compile(r"/(Map|Image)Server(/\d+)?/?(\?|$)|/rest/services(/[^/?]*)?/?(\?|$)"), ("arcgis",)),
    (re.compile(r"wmts", re.IGNORECASE), ("wmts", "wms")),
    (re.compile(r"wms", re.IGNORECASE), ("wms", "wmts")),
    (re.compile(r"/collections(/|$|\?)|tilematrixset", re.IGNORECASE), ("ogcapi",)),
)
#: Names that stand in a document of each kind that describes itself in JSON.
_JSON = {
    "arcgis": {"currentVersion", "mapName", "singleFusedMapCache", "services"},
    "ogcapi": {"collections", "tilesets", "links", "conformsTo"},
}
_ACCEPT = {"Accept": "application/json, application/xml;q=0.9, text/xml;q=0.9, */*;q=0.1"}
#: How the choice of a layer is called, by kind.
LAYER_CHOICES = {"wmts": "layer", "wms": "layers", "arcgis": "service", "ogcapi": "collection"}


@dataclass(frozen=True)
class FoundService:
    """A service at an address.

    Parameters
    ----------
    source : NamedSource
        Named in full, as a mission has it, but for a layer where one is to be chosen.
    layers : tuple of Offered, or None
        Layers to choose from; None where none is to be chosen.
    """

    source: NamedSource
    layers: tuple[Offered, ...] | None

    @property
    def kind(self) -> str:
        """One of the keys of `LAYER_CHOICES`."""
        return self.source.text.partition(":")[0].lower()


def is_service_address(text: str) -> bool:
    """Whether a text may be the address of a service: one in full, or an address of the web without placeholders."""
    if source_kind(text).is_service:
        return True
    return re.match(r"https?://", text, re.IGNORECASE) is not None and not re.search(r"\{(?!key\})", text)


def found_service(text: str, options: SourceOptions) -> FoundService:
    """Service at an address, which is asked what it is.

    Parameters
    ----------
    text : str
        An address, or a name such as ``wms:URL``.
    options : SourceOptions

    Raises
    ------
    InvalidInput
        The address is not right.
    SourceError
        No such service answers there.
    """
    if source_kind(text).is_service:
        return _found(text, options)
    address = text.partition("#")[0]
    hinted = next((kinds for hint, kinds in _HINTS if hint.search(address)), ())
    problem: SourceError | None = None
    for kind in hinted:
        try:
            return _found(f"{kind}:{text}", options)
        except SourceError as wrong:  # noqa: PERF203  there are two at most
            problem = problem or wrong
    if problem is not None:
        raise problem
    return _found(f"{_told_kind(address, options)}:{text}", options)


def _found(text: str, options: SourceOptions) -> FoundService:
    source = named_source(text, options)
    layers = source.layers()
    return FoundService(source, None if layers is None else tuple(layers))


def _told_kind(address: str, options: SourceOptions) -> str:
    """Kind of the service by its answer."""
    source = OGCAPITiles(f"ogcapi:{address}", options)
    service, key = source.service, source.key
    url = service.address_with(key)
    document, body, words = asked(service, url, key, options.transport, Message("address"), _ACCEPT)
    plain = body.replace(b"\0", b"")
    for kind, root in ROOTS.items():
        if re.search(root, plain):
            return kind
    names = _names(body)
    for kind, known in _JSON.items():
        if names & known:
            return kind
    # Most services of maps answer a bare address with a page for people; a WMS is what is behind most of those.
    try:
        _found(f"wms:{address}", options)
    except SourceError:
        raise SourceError(
            "{0}: no service known here answers{1}; needs a WMTS, WMS, ArcGIS REST service or OGC API, or a URL "
            "template",
            document.service.host,
            Message(" ({0})", words) if words else "",
        ) from None
    return "wms"


def _names(body: bytes) -> set[str]:
    """Names in a JSON object; none of anything else."""
    try:
        value: Any = parse_json(body)
    except InvalidInput:
        return set()
    return set(value) if isinstance(value, dict) else set()
