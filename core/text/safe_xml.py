"""XML of strangers: no document type, no entities, no network, and no more of it than the limits allow.

What other libraries read of a document is what was read and written anew here, so that their own settings (those of
OWSLib hold for one thread only) have nothing left to be wrong about.
"""

from __future__ import annotations

import codecs
import importlib
import re
from collections.abc import Iterator, Mapping
from typing import Any, Callable

from ..errors import Message
from ..limits import (
    MAX_CAPABILITIES_BYTES,
    MAX_SERVICE_LAYERS,
    MAX_XML_ATTRIBUTES,
    MAX_XML_DEPTH,
    MAX_XML_ELEMENTS,
    MAX_XML_INHERITED,
    MAX_XML_NAMES,
    MAX_XML_NODES,
)
from .plain import one_line

_ENCODINGS_TOLD = "UTF-8, UTF-16 or Latin-1"
#: Marks of the encoding at the beginning of a file, and the beginning of XML in UTF-16 without one.
_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
    (b"<\0", "utf-16-le"),
    (b"\0<", "utf-16-be"),
)
#: Characters within which a document states its encoding, and its type.
_HEAD_CHARACTERS = 1024
_STATED = re.compile(rb"<\?xml\s[^>]*?\bencoding\s*=\s*[\"']([\w.:-]+)[\"']", re.ASCII)
_DECLARATION = re.compile(r"\s*<\?xml\s[^>]*\?>")
_BEFORE_TYPE = re.compile(r"\s*(?:<!--.*?-->|<\?.*?\?>)", re.DOTALL)
#: The type that WMS 1.1.1 prescribes (OGC 01-068r3, annex A), with elements of its own and no entities.
_WMS_TYPE = re.compile(
    r"\s*<!DOCTYPE\s+WMT_MS_Capabilities\s+SYSTEM\s+(?:\"[^\"<>]*\"|'[^'<>]*')\s*"
    r"(?:\[(?:\s|<!(?:ELEMENT|ATTLIST)\s[^<>%&\[\]]*>)*\]\s*)?>"
)
_REFUSED = re.compile(r"<!(?:DOCTYPE|ENTITY)", re.IGNORECASE)
#: Names of elements and attributes.
_NAME = re.compile(r"<[^\s/<>]+|\s[^\s=<>\"'/]+\s*=")
#: Children of a layer of a WMS that the layers within it have as well.
_INHERITED = frozenset({"CRS", "SRS", "Style", "BoundingBox"})


#: What reads documents that people give: of each element, where it begins, the name without its namespace, its text and
#: its attributes; nothing of either where it ends. Readers may leave out texts but those of `TEXTS`, and attributes but
#: those of `ATTRIBUTES`. It raises `UnreadableXMLError`.
XMLReader = Callable[[bytes], Iterator[tuple[str, str, Mapping[str, str]]]]
#: Elements of KML and GPX whose text is read, and those whose attributes are.
TEXTS, ATTRIBUTES = ("coordinates", "ele", "time"), ("trkpt", "rtept")


class UnreadableXMLError(ValueError):
    """A document that is refused, or is no XML; the text says why."""


def decode_document(body: bytes) -> str:
    """Text of a document, without a declaration of its encoding.

    Raises
    ------
    UnreadableXMLError
        It is of another encoding than UTF-8, UTF-16 and Latin-1, or not of the one that it states.
    """
    body = body.lstrip(b" \t\r\n")
    encoding = next((name for mark, name in _MARKS if body.startswith(mark)), None)
    if encoding is None:
        found = _STATED.match(body[:_HEAD_CHARACTERS])
        stated = found.group(1).decode("ascii") if found else "utf-8"
        try:
            encoding = codecs.lookup(stated).name
        except LookupError:
            encoding = ""
        # Python's names of the encodings that are read.
        if encoding not in ("utf-8", "ascii", "utf-16", "iso8859-1"):
            raise UnreadableXMLError(Message("encoding {0}: must be {1}", stated, _ENCODINGS_TOLD))
    try:
        text = body.decode(encoding)
    except UnicodeDecodeError:
        raise UnreadableXMLError(Message("is not {0}; must be {1}, and say which", encoding, _ENCODINGS_TOLD)) from None
    found_text = _DECLARATION.match(text, 0, _HEAD_CHARACTERS)
    return text[found_text.end() :] if found_text else text


def checked_text(body: bytes) -> str:
    """Text of a document that any reader may be given: within the limits, and without a type or entities of its own.

    Raises
    ------
    UnreadableXMLError
        As `parse_xml` does.
    """
    text = _without_wms_type(decode_document(body))
    if _REFUSED.search(text):
        raise UnreadableXMLError(Message("a document type or entities of its own, which are not read"))
    _check_size(text)
    return text


def too_deep() -> UnreadableXMLError:
    """Error of a document with elements that are within each other deeper than `MAX_XML_DEPTH`."""
    return UnreadableXMLError(Message("elements nested more than {0} deep", MAX_XML_DEPTH))


def parse_xml(body: bytes) -> Any:
    """Root of a document as lxml has it, with nothing in it but elements, attributes and text.

    Raises
    ------
    UnreadableXMLError
        It declares a type or entities (but for the type that WMS 1.1.1 prescribes, which is left out), is beyond the
        limits, or is no XML.
    """
    text = checked_text(body)
    etree = importlib.import_module("lxml.etree")
    parser = etree.XMLParser(
        # Whatever a second declaration says, which may stand behind the first.
        encoding="utf-8",
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        dtd_validation=False,
        attribute_defaults=False,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
    )
    try:
        root = etree.fromstring(text.encode(), parser)
    except etree.XMLSyntaxError as broken:
        raise UnreadableXMLError(one_line(str(broken))) from None
    if root.xpath(f"boolean({'/*' * (MAX_XML_DEPTH + 1)})"):
        raise too_deep()
    _check_layers(root)
    return root


def iterate_elements(body: bytes) -> Iterator[tuple[str, str, Mapping[str, str]]]:
    """Elements of a document as an `XMLReader` gives them, read by lxml; raises as `parse_xml` does."""
    todo: list[Any] = [parse_xml(body)]
    while todo:
        element = todo.pop()
        if element is None:
            yield "", "", {}
            continue
        yield _name(element), str(element.text or ""), element.attrib
        todo += [None, *reversed(element)]


def written(root: Any) -> bytes:
    """XML of what `parse_xml` has read, for other libraries to read."""
    xml: bytes = importlib.import_module("lxml.etree").tostring(root, encoding="utf-8")
    return xml


def _without_wms_type(text: str) -> str:
    """Leave out the type that every WMS 1.1.1 states: what it declares is of no use here."""
    at = 0
    head = text[: 1 << 16]
    while found := _BEFORE_TYPE.match(head, at):
        at = found.end()
    stated = _WMS_TYPE.match(head, at)
    return text[stated.end() :] if stated else text


def _check_size(text: str) -> None:
    """Refuse what would take memory or time beyond measure, before it is parsed."""
    # Each element has one bracket that begins it; those within comments and attributes count as if they had begun one.
    elements = text.count("<") - text.count("</")
    if len(text) > MAX_CAPABILITIES_BYTES or elements > MAX_XML_ELEMENTS or text.count("</") > MAX_XML_ELEMENTS:
        raise UnreadableXMLError(
            Message("more than {0} MB or {1:,} elements", MAX_CAPABILITIES_BYTES >> 20, MAX_XML_ELEMENTS)
        )
    if elements + text.count("=") > MAX_XML_NODES:
        raise UnreadableXMLError(Message("more than {0:,} elements and attributes", MAX_XML_NODES))
    for piece in text.split("<"):
        # Parsers compare each attribute of an element with all others. None is shorter than `a=""` with its space.
        if len(piece) > 5 * MAX_XML_ATTRIBUTES and piece.count("=") > MAX_XML_ATTRIBUTES:
            raise UnreadableXMLError(Message("more than {0:,} attributes of one element", MAX_XML_ATTRIBUTES))
    names = set()
    for found in _NAME.finditer(text):
        names.add(found.group())
        # Parsers keep each of them, in a table that does not grow with them.
        if len(names) > MAX_XML_NAMES:
            raise UnreadableXMLError(Message("more than {0:,} different names", MAX_XML_NAMES))


def _check_layers(root: Any) -> None:
    """Refuse more layers than memory and time are for, or what they pass on to those within: OWSLib copies it."""
    if sum(1 for _ in root.iter("{*}Layer", "{*}Style")) > MAX_SERVICE_LAYERS:
        raise UnreadableXMLError(Message("more than {0:,} layers and styles", MAX_SERVICE_LAYERS))
    total = 0
    # Of each layer, after those around it: how deep it is, and how much it passes on.
    known: dict[Any, tuple[int, int]] = {}
    for layer in root.iter("{*}Layer"):
        depth, passed_on = known.get(layer.getparent(), (0, 0))
        depth += 1
        passed_on += sum(max(len((child.text or "").split()), 1) for child in layer if _name(child) in _INHERITED)
        known[layer] = depth, passed_on
        # OWSLib reads a layer once more for each of those around it.
        total += depth * (1 + passed_on + len(layer))
        if total > MAX_XML_INHERITED:
            raise UnreadableXMLError(
                Message("layers that pass on more than {0:,} properties to those within them", MAX_XML_INHERITED)
            )


def _name(element: Any) -> str:
    """Name of an element without its namespace."""
    return str(element.tag).rpartition("}")[2]
