"""Documents of services: fetching, with keys masked; choices, formats and terms in them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any
from urllib.parse import parse_qsl, quote, urlencode, urljoin, urlsplit, urlunsplit

from ...errors import InvalidInput, Message, PartError, SourceError, TerrAInavError
from ...limits import MAX_CAPABILITIES_BYTES
from ...text.plain import one_line
from ...text.safe_xml import UnreadableXMLError, parse_xml, written
from ...text.secrets import MASK, Secrets
from ..entry import Dates
from ..http.client import Client
from ..http.transport import Transport
from ..policy import Policy
from ..systems import WORLD_DEG
from ..tiles import check_address

#: Choices after ``#`` for each kind of service; the first one selects a layer.
CHOICES = {
    "wmts": ("layer", "style", "tilematrixset", "tilematrix", "format"),
    "wms": ("layers", "styles", "format", "version"),
    "arcgis": ("service", "layers", "format"),
    "ogcapi": ("collection", "tilematrixset", "tilematrix", "format"),
}
#: Names of the kinds for people.
TITLES = {"wmts": "WMTS", "wms": "WMS", "arcgis": "ArcGIS REST", "ogcapi": "OGC API"}
#: Patterns of the root elements of XML documents.
ROOTS = {"wmts": rb"<(\w+:)?Capabilities\b", "wms": rb"<(\w+:)?(WMS|WMT_MS)_Capabilities\b"}
#: Formats of tiles that can be decoded, in order of preference.
FORMATS = ("image/png", "image/jpeg", "image/webp", "image/gif")
#: Format of tiles that are PNG if pixels are missing, and JPEG otherwise.
_EITHER = "image/vnd.jpeg-png"
#: Other names of these formats, the best format first: a PNG of 8 bits has only 256 colours.
_OTHER_NAMES = {
    "image/png32": "image/png",
    "image/png24": "image/png",
    "image/x-png": "image/png",
    _EITHER: _EITHER,
    "image/jpgpng": _EITHER,
    "image/jpg": "image/jpeg",
    "image/pjpeg": "image/jpeg",
    "image/png8": "image/png",
    "image/vnd.jpeg-png8": _EITHER,
}
#: Most layers or tile matrix sets listed in an error.
NAMED = 8


@dataclass(frozen=True)
class Service:
    """A service and the choices in its name.

    Parameters
    ----------
    kind : str
        One of `CHOICES`.
    address : str
        With {key} in place of the key.
    choices : mapping
        Values of choices, by their names in `CHOICES`.
    """

    kind: str
    address: str
    choices: Mapping[str, str]

    @classmethod
    def named(cls, name: str) -> Service:
        """Parse the name of a source.

        Raises
        ------
        InvalidInput
            The choice is unknown, or the address is invalid or contains credentials.
        """
        kind, _, rest = name.partition(":")
        kind = kind.lower()
        address, _, fragment = rest.partition("#")
        check_address(address, Message("address of a {0}", TITLES[kind]))
        choices = {}
        for choice, value in parse_qsl(fragment, keep_blank_values=True):
            if choice.lower() not in CHOICES[kind]:
                raise InvalidInput(
                    "choice {0!r} of a {1}: must be one of {2}",
                    choice,
                    TITLES[kind],
                    ", ".join(CHOICES[kind]),
                )
            choices[choice.lower()] = value
        return cls(kind, address, choices)

    @property
    def host(self) -> str:
        """Host of the service."""
        return urlsplit(self.address).hostname or ""

    def keyed_address(self, key: str) -> str:
        """Address with the key."""
        return self.address.replace("{key}", quote(key, safe=""))

    def document_url(self, key: str) -> str:
        """Address of the capabilities document, with the key."""
        parts = urlsplit(self.keyed_address(key))
        given = {name.lower() for name, _ in parse_qsl(parts.query, keep_blank_values=True)}
        if parts.path.lower().endswith(".xml") or "request" in given:
            return urlunsplit(parts)
        version = self.choices.get("version") or ("1.0.0" if self.kind == "wmts" else "1.3.0")
        wanted = {"service": self.kind.upper(), "request": "GetCapabilities", "version": version}
        more = urlencode({name.upper(): value for name, value in wanted.items() if name not in given})
        return urlunsplit(parts._replace(query=f"{parts.query}&{more}" if parts.query else more))


@dataclass(frozen=True)
class Offered:
    """A layer offered by a service.

    Parameters
    ----------
    name, title : str
    systems : tuple of str
        Codes of coordinate reference systems, as far as the list of layers states them.
    sets : tuple of str
        Names of tile matrix sets.
    dates : Dates or None
        Available dates.
    """

    name: str
    title: str
    systems: tuple[str, ...] = ()
    sets: tuple[str, ...] = ()
    dates: Dates | None = None


@dataclass(frozen=True)
class Document:
    """A capabilities document.

    Parameters
    ----------
    service : Service
    root : element of lxml, or value of a JSON text
        In texts, {key} stands in place of the key, and only there.
    url : str
        Address of the document; may contain the key.
    secrets : Secrets
        The key, if any.
    """

    service: Service
    root: Any
    url: str
    secrets: Secrets

    def wrong(self, reason: str) -> SourceError:
        """Error about this document, in one line, with the key masked."""
        text = Message("{0} of {1}: {2}", TITLES[self.service.kind], self.service.host, reason)
        return SourceError(text.map_texts(lambda one: self.secrets.masked(one).replace("{key}", MASK)))

    def without_key(self, text: str) -> str:
        """Replace the key by {key}."""
        return self.secrets.replaced(text, "{key}")


def fetch_capabilities(service: Service, key: str, transport: Transport | None) -> Document:
    """Fetch the capabilities of a service, with the key in place of {key} in the address.

    Raises
    ------
    SourceError
        The capabilities are not available or too large, or the address has another document.
    """
    document, body, message = fetch_document(
        service, service.document_url(key), key, transport, Message("capabilities")
    )
    if len(body) > MAX_CAPABILITIES_BYTES:
        raise document.wrong(Message("capabilities of more than {0} bytes", MAX_CAPABILITIES_BYTES))
    plain = body.replace(b"\0", b"")
    found = [kind for kind, root in ROOTS.items() if re.search(root, plain)]
    if not found:
        raise document.wrong(Message("no capabilities at this address{0}", f": {message}" if message else ""))
    if service.kind not in found:
        raise document.wrong(
            Message("the capabilities at this address are of a {0}: write {1}:URL", found[0].upper(), found[0])
        )
    with reading(document):
        root = parse_xml(body)
        if key or b"{key}" in written(root):
            _mark_keys(root, document)
    return replace(document, root=root)


def fetch_document(
    service: Service,
    url: str,
    key: str,
    transport: Transport | None,
    what: str,
    headers: Mapping[str, str] | None = None,
) -> tuple[Document, bytes, str]:
    """Fetch a document; return it without a root, with the body and the first words of the body for people.

    Raises
    ------
    SourceError
        The document is not available.
    """
    used = _transport() if transport is None else transport
    secrets = (key,) if key else ()
    client = Client(used, service.host, connections=1, secrets=secrets, tries=2)
    try:
        response = client.get(url, what, headers)
    except PartError as failure:
        raise SourceError("{0}: {1}", service.host, failure) from None
    finally:
        # Leave a given transport open, as it also fetches the tiles.
        if transport is None:
            used.close()
    return Document(service, None, url, Secrets(secrets)), response.body, client.message(response)


def filled_template(document: Document, template: str, filled: Mapping[str, str]) -> str:
    """Convert a service's template of tiles to a URL template.

    Parameters
    ----------
    document : Document
        Document that contains the template.
    template : str
        Template with the service's placeholders in braces.
    filled : mapping
        Values of placeholders, by name in lower case.
    """
    text = urljoin(document.url, template)
    # Treat other text as literal, braces included, and values, too, so that nothing is filled twice.
    pieces = re.split(r"\{([^{}]*)\}", text)
    pieces[::2] = [piece.replace("{", "%7B").replace("}", "%7D") for piece in pieces[::2]]
    pieces[1::2] = [quote(filled.get(name.lower(), f"{{{name}}}"), safe="{}:") for name in pieces[1::2]]
    return document.without_key("".join(pieces))


def _transport() -> Transport:
    from ..http.requests_transport import RequestsTransport

    return RequestsTransport(1, max_body_bytes=MAX_CAPABILITIES_BYTES)


def _mark_keys(root: Any, document: Document) -> None:
    """Replace the key in a document by {key}; escape a literal {key}, so that it is never filled."""

    def marked(text: str) -> str:
        return document.without_key(text.replace("{key}", "%7Bkey%7D"))

    for element in root.iter():
        if element.text:
            element.text = marked(element.text)
        for name, value in element.items():
            element.set(name, marked(value))


@contextmanager
def reading(document: Document) -> Iterator[None]:
    """Convert errors while reading capabilities to a SourceError."""
    try:
        yield
    except TerrAInavError:
        raise
    except ImportError as missing:
        raise SourceError(
            "source {0}:{1}: needs OWSLib: pip install owslib", document.service.kind, document.service.host
        ) from missing
    except UnreadableXMLError as wrong:
        raise document.wrong(Message("capabilities that cannot be read: {0}", wrong)) from None
    except (ArithmeticError, AttributeError, LookupError, SyntaxError, TypeError, ValueError) as broken:
        raise document.wrong(
            Message("capabilities that cannot be read ({0}: {1})", type(broken).__name__, one_line(str(broken)))
        ) from broken


def chosen_one(document: Document, what: str, wanted: str | None, offered: Mapping[str, str]) -> str:
    """Return the wanted choice, or the only one.

    Parameters
    ----------
    what : str
        Name of the choice.
    wanted : str or None
    offered : mapping
        Maps available names to titles.

    Raises
    ------
    InvalidInput
        The wanted choice is not available; or none is wanted and there is not exactly one.
    """
    if wanted is not None and wanted in offered:
        return wanted
    if wanted is None and len(offered) == 1:
        return next(iter(offered))
    host = document.service.host
    names: str = ", ".join(list(offered)[:NAMED])
    if len(offered) > NAMED:
        names = Message("{0} and {1} more", names, len(offered) - NAMED)
    if wanted is None:
        raise InvalidInput(
            "{0} of {1}: say which with #{2}=…: {3}; `terrainav sources show` lists them",
            TITLES[document.service.kind],
            host,
            what,
            names or Message("it offers none"),
        )
    raise InvalidInput("{0} {1!r}: {2} offers {3}", what, wanted, host, names or Message("none"))


def chosen_format(document: Document, offered: list[str]) -> str:
    """Return the wanted format, or the best that can be decoded, as the service spells it."""
    wanted = document.service.choices.get("format")
    known = [kind for kind in offered if media_type(kind)]
    if wanted is not None:
        full = (wanted if "/" in wanted else f"image/{wanted}").lower()
        matching = [kind for kind in known if kind.lower() == full]
        matching += [kind for kind in known if media_type(kind) == media_type(full)]
        return matching[0] if matching else chosen_one(document, "format", full, dict.fromkeys(known, ""))
    if known:
        return min(known, key=_format_rank)
    raise document.wrong(
        Message("offers {0}, and none of {1}", ", ".join(offered) or Message("no format"), ", ".join(FORMATS))
    )


def media_type(kind: str) -> str:
    """Media type, without parameters, of a format as a service names it; empty if the format cannot be decoded."""
    plain = kind.partition(";")[0].strip().lower()
    plain = _OTHER_NAMES.get(plain, plain)
    return plain if plain in FORMATS or plain == _EITHER else ""


def _format_rank(kind: str) -> tuple[int, int]:
    """Rank of a format for `min`; registered names come first, as earlier releases chose these."""
    plain = kind.strip().lower()
    if plain in FORMATS:
        return 0, FORMATS.index(plain)
    if plain not in _OTHER_NAMES:
        return 1, 0
    return 2, list(_OTHER_NAMES).index(plain)


def read_policy(identification: Any) -> Policy:
    """Terms in the capabilities: fees and access constraints."""
    empty = ("", "none", "no", "null", "no constraints", "no conditions apply", "-")
    stated = []
    for label, name in (("fees", "fees"), ("access constraints", "accessconstraints")):
        text = one_line(getattr(identification, name, None))
        if text.lower() not in empty:
            stated.append(f"{label}: {text}")
    return Policy(terms="; ".join(stated))


def read_credit(title: str | None, provider: Any) -> str:
    """Attribution that the layer states, otherwise the provider's name."""
    return one_line(title) or one_line(getattr(provider, "name", None))


def read_bounds(layers: Iterable[Any]) -> tuple[float, float, float, float]:
    """West, south, east, north in degrees of all layers together; the world if a layer states no bounds."""
    boxes = []
    for layer in layers:
        box = getattr(layer, "boundingBoxWGS84", None)
        if not box:
            return WORLD_DEG
        boxes.append(tuple(map(float, box)))
    wests, souths, easts, norths = zip(*boxes)
    west, south, east, north = min(wests), min(souths), max(easts), max(norths)
    sound = -180.0 <= west < east <= 180.0 and -90.0 <= south < north <= 90.0
    return (west, south, east, north) if sound else WORLD_DEG
