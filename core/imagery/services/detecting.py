"""Detection of the kind of service at an address, by the address or by the server's answer."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

from ...errors import InvalidInput, Message, SourceError
from ...text.safe_json import parse_json
from ..opening import NamedSource, SourceOptions, named_source, source_kind
from .capabilities import CHOICES, ROOTS, Offered, fetch_document
from .ogcapi import OGCAPITiles


@dataclass(frozen=True)
class FoundService:
    """A service at an address.

    Parameters
    ----------
    source : NamedSource
        Source named as in a mission, except that the layer may still have to be chosen.
    layers : tuple of Offered, or None
        Layers to choose from; None if there is no choice.
    """

    source: NamedSource
    layers: tuple[Offered, ...] | None

    @property
    def kind(self) -> str:
        """Kind of the service, a key of `CHOICES`."""
        return self.source.text.partition(":")[0].lower()

    @property
    def layer_choice(self) -> str:
        """Name of the choice that selects a layer."""
        return CHOICES[self.kind][0]


def is_service_address(text: str) -> bool:
    """Whether a text may name a service: with a prefix of its kind, or by a web address without placeholders."""
    if source_kind(text).is_service:
        return True
    return re.match(r"https?://", text, re.IGNORECASE) is not None and not re.search(r"\{(?!key\})", text)


def found_service(text: str, options: SourceOptions) -> FoundService:
    """Detect the service at an address by requests.

    Parameters
    ----------
    text : str
        An address, or a name such as ``wms:URL``.
    options : SourceOptions

    Raises
    ------
    InvalidInput
        The address is invalid.
    SourceError
        No known service answers.
    """
    if source_kind(text).is_service:
        return _found(text, options)
    address = text.partition("#")[0]
    # Kinds to try. ArcGIS Server's WMS and WMTS addresses end with these words, not with MapServer.
    hints = (
        (r"/(Map|Image)Server(/\d+)?/?(\?|$)|/rest/services(/[^/?]*)?/?(\?|$)", ("arcgis",)),
        ("(?i)wmts", ("wmts", "wms")),
        ("(?i)wms", ("wms", "wmts")),
        (r"(?i)/collections(/|$|\?)|tilematrixset", ("ogcapi",)),
    )
    hinted = next((kinds for hint, kinds in hints if re.search(hint, address)), ())
    problem: SourceError | None = None
    for kind in hinted:
        try:
            return _found(f"{kind}:{text}", options)
        except SourceError as wrong:  # noqa: PERF203  there are two at most
            problem = problem or wrong
    if problem is not None:
        raise problem
    return _found(f"{_answered_kind(address, options)}:{text}", options)


def _found(text: str, options: SourceOptions) -> FoundService:
    source = named_source(text, options)
    layers = source.layers()
    return FoundService(source, None if layers is None else tuple(layers))


def _answered_kind(address: str, options: SourceOptions) -> str:
    """Request an address; return the kind of service that answers."""
    accept = {"Accept": "application/json, application/xml;q=0.9, text/xml;q=0.9, */*;q=0.1"}
    source = OGCAPITiles(f"ogcapi:{address}", options)
    service, key = source.service, source.key
    url = service.keyed_address(key)
    document, body, words = fetch_document(service, url, key, options.transport, Message("address"), accept)
    plain = body.replace(b"\0", b"")
    for kind, root in ROOTS.items():
        if re.search(root, plain):
            return kind
    names = _names(body)
    for kind, known in (
        ("arcgis", {"currentVersion", "mapName", "singleFusedMapCache", "services"}),
        ("ogcapi", {"collections", "tilesets", "links", "conformsTo"}),
    ):
        if names & known:
            return kind
    # Many services, most of them WMS, answer a bare address with a page for people.
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
    """Names of the members of a JSON object; empty for other documents."""
    try:
        value: Any = parse_json(body)
    except InvalidInput:
        return set()
    return set(value) if isinstance(value, dict) else set()
