"""Capabilities of a WMTS or WMS: which are wanted, how they are fetched, and what both kinds have in common."""

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
from ...text.safe_xml import UnreadableXMLError, root_of, written
from ...text.secrets import MASK, Secrets
from ..entry import Dates
from ..http.client import Client
from ..http.transport import Transport
from ..policy import Policy
from ..systems import WORLD_DEG
from ..tiles import check_address

#: Choices after the # of each kind of service.
CHOICES = {
    "wmts": ("layer", "style", "tilematrixset", "tilematrix", "format"),
    "wms": ("layers", "styles", "format", "version"),
    "arcgis": ("service", "layers", "format"),
    "ogcapi": ("collection", "tilematrixset", "tilematrix", "format"),
}
#: What people call each kind.
TITLES = {"wmts": "WMTS", "wms": "WMS", "arcgis": "ArcGIS REST", "ogcapi": "OGC API"}
#: How the documents of each kind begin.
ROOTS = {"wmts": rb"<(\w+:)?Capabilities\b", "wms": rb"<(\w+:)?(WMS|WMT_MS)_Capabilities\b"}
#: Formats of tiles that can be decoded, the first that is offered is taken.
FORMATS = ("image/png", "image/jpeg", "image/webp", "image/gif")
#: PNG where pixels are missing, and JPEG elsewhere.
_EITHER = "image/vnd.jpeg-png"
#: Other names that servers give them, the best first: of 8 bits a PNG has 256 colours.
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
#: Attempts at a document: a person waits for it, and may try again.
_TRIES = 2
#: Layers and tile matrix sets that an error names.
NAMED = 8
_NOTHING = frozenset({"", "none", "no", "null", "no constraints", "no conditions apply", "-"})


@dataclass(frozen=True)
class Service:
    """A service and what is wanted of it, as its name says.

    Parameters
    ----------
    kind : str
        One of `CHOICES`.
    address : str
        With {key} where the key stands.
    choices : mapping
        Of `CHOICES`.
    """

    kind: str
    address: str
    choices: Mapping[str, str]

    @classmethod
    def named(cls, name: str) -> Service:
        """Service of a source's name.

        Raises
        ------
        InvalidInput
            An unknown choice, or an address that is none or holds credentials.
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
        """Host asked."""
        return urlsplit(self.address).hostname or ""

    def address_with(self, key: str) -> str:
        """Address with a key in its place."""
        return self.address.replace("{key}", quote(key, safe=""))

    def document_url(self, key: str) -> str:
        """Address of the capabilities document."""
        parts = urlsplit(self.address_with(key))
        given = {name.lower() for name, _ in parse_qsl(parts.query, keep_blank_values=True)}
        if parts.path.lower().endswith(".xml") or "request" in given:
            return urlunsplit(parts)
        version = self.choices.get("version") or ("1.0.0" if self.kind == "wmts" else "1.3.0")
        wanted = {"service": self.kind.upper(), "request": "GetCapabilities", "version": version}
        more = urlencode({name.upper(): value for name, value in wanted.items() if name not in given})
        return urlunsplit(parts._replace(query=f"{parts.query}&{more}" if parts.query else more))


@dataclass(frozen=True)
class Offered:
    """A layer as its service offers it.

    Parameters
    ----------
    name, title : str
    systems : tuple of str
        Codes of the coordinate reference systems that it can be had in, as far as the list of layers tells them.
    sets : tuple of str
        Names of its tile matrix sets.
    dates : Dates or None
        Dates that it can be had of.
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
        With {key} where the server repeats the key, and nowhere else.
    url : str
        Where it came from; may hold the key.
    secrets : Secrets
        The key, where there is one.
    """

    service: Service
    root: Any
    url: str
    secrets: Secrets

    def wrong(self, reason: str) -> SourceError:
        """Error about this document, in one line and without the key."""
        text = Message("{0} of {1}: {2}", TITLES[self.service.kind], self.service.host, reason)
        return SourceError(text.with_texts(lambda one: self.secrets.masked(one).replace("{key}", MASK)))

    def without_key(self, text: str) -> str:
        """Put {key} where the key stands."""
        return self.secrets.replaced(text, "{key}")


def fetched(service: Service, key: str, transport: Transport | None) -> Document:
    """Capabilities of a service, asked for with the key where its address has {key}.

    Raises
    ------
    SourceError
        They cannot be had, are too large, or something else is at the address.
    """
    document, body, message = asked(
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
            Message(
                "the capabilities at this address are of a {0}: write {1}:URL", found[0].upper(), found[0]
            )
        )
    with reading(document):
        root = root_of(body)
        if key or b"{key}" in written(root):
            _mark_keys(root, document)
    return replace(document, root=root)


def asked(
    service: Service,
    url: str,
    key: str,
    transport: Transport | None,
    what: str,
    headers: Mapping[str, str] | None = None,
) -> tuple[Document, bytes, str]:
    """Ask for a document: all of it but its root, its body, and the first words of that for people.

    Raises
    ------
    SourceError
        It cannot be had.
    """
    used = _transport() if transport is None else transport
    secrets = (key,) if key else ()
    client = Client(used, service.host, connections=1, secrets=secrets, tries=_TRIES)
    try:
        response = client.get(url, what, headers)
    except PartError as failure:
        raise SourceError("{0}: {1}", service.host, failure) from None
    finally:
        # A transport that was given goes on to fetch the tiles.
        if transport is None:
            used.close()
    return Document(service, None, url, Secrets(secrets)), response.body, client.message(response)


def filled_template(document: Document, template: str, filled: Mapping[str, str]) -> str:
    """URL template of tiles, made of a service's own.

    Parameters
    ----------
    document : Document
        That names the template.
    template : str
        With the service's placeholders in braces.
    filled : mapping
        What stands for each of them, whose name is in lower case.
    """
    text = urljoin(document.url, template)
    # What is no placeholder is text, braces included, and so is what stands for one: nothing is filled twice.
    pieces = re.split(r"\{([^{}]*)\}", text)
    pieces[::2] = [piece.replace("{", "%7B").replace("}", "%7D") for piece in pieces[::2]]
    pieces[1::2] = [quote(filled.get(name.lower(), f"{{{name}}}"), safe="{}:") for name in pieces[1::2]]
    return document.without_key("".join(pieces))


def _transport() -> Transport:
    from ..http.requests_transport import RequestsTransport

    return RequestsTransport(1, max_body_bytes=MAX_CAPABILITIES_BYTES)


def _mark_keys(root: Any, document: Document) -> None:
    """Put {key} where a document repeats the key, and nowhere else: one of its own is text, and is never filled."""

    def with_key_marked(text: str) -> str:
        return document.without_key(text.replace("{key}", "%7Bkey%7D"))

    for element in root.iter():
        if element.text:
            element.text = with_key_marked(element.text)
        for name, value in element.items():
            element.set(name, with_key_marked(value))


@contextmanager
def reading(document: Document) -> Iterator[None]:
    """Turn what a reader of capabilities trips over into one line."""
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
            Message(
                "capabilities that cannot be read ({0}: {1})", type(broken).__name__, one_line(str(broken))
            )
        ) from broken


def chosen_one(document: Document, what: str, wanted: str | None, offered: Mapping[str, str]) -> str:
    """Return the choice asked for, or the only one.

    Parameters
    ----------
    what : str
        Name of the choice.
    wanted : str or None
    offered : mapping
        Names there are, to their titles.

    Raises
    ------
    InvalidInput
        It is not offered, or nothing is asked for and there are several.
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
    """Return the format asked for, or the best of those offered that can be decoded, as the service writes it."""
    wanted = document.service.choices.get("format")
    known = [kind for kind in offered if media_type(kind)]
    if wanted is not None:
        full = (wanted if "/" in wanted else f"image/{wanted}").lower()
        alike = [kind for kind in known if kind.lower() == full]
        alike += [kind for kind in known if media_type(kind) == media_type(full)]
        return alike[0] if alike else chosen_one(document, "format", full, dict.fromkeys(known, ""))
    if known:
        return min(known, key=_by_quality)
    raise document.wrong(
        Message("offers {0}, and none of {1}", ", ".join(offered) or Message("no format"), ", ".join(FORMATS))
    )


def media_type(kind: str) -> str:
    """Media type that a service's name of a format stands for, without parameters; empty where none can be decoded."""
    plain = kind.partition(";")[0].strip().lower()
    plain = _OTHER_NAMES.get(plain, plain)
    return plain if plain in FORMATS or plain == _EITHER else ""


def _by_quality(kind: str) -> tuple[int, int]:
    """Place of a format: those of the registered names, as it was before others were known; then the others."""
    plain = kind.strip().lower()
    if plain in FORMATS:
        return 0, FORMATS.index(plain)
    if plain not in _OTHER_NAMES:
        return 1, 0
    return 2, list(_OTHER_NAMES).index(plain)


def policy_of(identification: Any) -> Policy:
    """Terms as the capabilities state them: fees and access constraints."""
    stated = []
    for label, name in (("fees", "fees"), ("access constraints", "accessconstraints")):
        text = one_line(getattr(identification, name, None))
        if text.lower() not in _NOTHING:
            stated.append(f"{label}: {text}")
    return Policy(terms="; ".join(stated))


def credit_of(title: str | None, provider: Any) -> str:
    """Attribution: as the layer states it, else the provider's name."""
    return one_line(title) or one_line(getattr(provider, "name", None))


def bounds_of(layers: Iterable[Any]) -> tuple[float, float, float, float]:
    """West, south, east, north in degrees of all that layers say to show; the world where one does not say it."""
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
