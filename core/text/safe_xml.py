"""Foreign XML, parsed within limits, without document types, entities or network access.

Other libraries, such as OWSLib, receive a document only after it was parsed and written again here, so that reading it
is safe with any settings of these libraries.
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

#: Document type that WMS 1.1.1 prescribes (OGC 01-068r3, annex A); it may declare elements, but not entities.
_WMS_TYPE = re.compile(
    r"\s*<!DOCTYPE\s+WMT_MS_Capabilities\s+SYSTEM\s+(?:\"[^\"<>]*\"|'[^'<>]*')\s*"
    r"(?:\[(?:\s|<!(?:ELEMENT|ATTLIST)\s[^<>%&\[\]]*>)*\]\s*)?>"
)

#: Reader of users' documents, which raises `UnreadableXMLError`. At the start of an element, it yields the name without
#: namespace, the text and the attributes; at the end, empty values. It may omit texts of elements other than `TEXTS`
#: and attributes of elements other than `ATTRIBUTES`.
XMLReader = Callable[[bytes], Iterator[tuple[str, str, Mapping[str, str]]]]
#: Elements of KML and GPX whose text is read, and elements whose attributes are read.
TEXTS, ATTRIBUTES = ("coordinates", "ele", "time"), ("trkpt", "rtept")


class UnreadableXMLError(ValueError):
    """A document is refused or is not XML; the text states the reason."""


def decode_document(body: bytes) -> str:
    """Decode a document and remove its XML declaration.

    Raises
    ------
    UnreadableXMLError
        The encoding is not UTF-8, UTF-16 or Latin-1, or differs from the declared encoding.
    """
    body = body.lstrip(b" \t\r\n")
    allowed = "UTF-8, UTF-16 or Latin-1"
    # Byte order marks, and the first bracket in UTF-16 without such a mark.
    marks = {
        codecs.BOM_UTF8: "utf-8-sig",
        codecs.BOM_UTF16_LE: "utf-16",
        codecs.BOM_UTF16_BE: "utf-16",
        b"<\0": "utf-16-le",
        b"\0<": "utf-16-be",
    }
    # The declaration lies within the first 1,024 characters.
    head_characters = 1024
    encoding = next((name for mark, name in marks.items() if body.startswith(mark)), None)
    if encoding is None:
        pattern = rb"<\?xml\s[^>]*?\bencoding\s*=\s*[\"']([\w.:-]+)[\"']"
        found = re.match(pattern, body[:head_characters], re.ASCII)
        stated = found.group(1).decode("ascii") if found else "utf-8"
        try:
            encoding = codecs.lookup(stated).name
        except LookupError:
            encoding = ""
        # Python's names of the allowed encodings.
        if encoding not in ("utf-8", "ascii", "utf-16", "iso8859-1"):
            raise UnreadableXMLError(Message("encoding {0}: must be {1}", stated, allowed))
    try:
        text = body.decode(encoding)
    except UnicodeDecodeError:
        raise UnreadableXMLError(Message("is not {0}; must be {1}, and say which", encoding, allowed)) from None
    declaration = re.match(r"\s*<\?xml\s[^>]*\?>", text[:head_characters])
    return text[declaration.end() :] if declaration else text


def checked_text(body: bytes) -> str:
    """Decode a document and check that it is safe for any reader: within limits, without document type and entities.

    Raises
    ------
    UnreadableXMLError
        As `parse_xml` does.
    """
    text = _without_wms_type(decode_document(body))
    if re.search("<!(?:DOCTYPE|ENTITY)", text, re.IGNORECASE):
        raise UnreadableXMLError(Message("a document type or entities, which are not read"))
    _check_size(text)
    return text


def too_deep() -> UnreadableXMLError:
    """Error for elements nested deeper than `MAX_XML_DEPTH`."""
    return UnreadableXMLError(Message("elements nested more than {0} deep", MAX_XML_DEPTH))


def parse_xml(body: bytes) -> Any:
    """Parse a document with lxml; return its root, with elements, attributes and text only.

    Raises
    ------
    UnreadableXMLError
        The document declares entities or a document type (other than that of WMS 1.1.1, which is removed), exceeds a
        limit, or is not XML.
    """
    text = checked_text(body)
    etree = importlib.import_module("lxml.etree")
    parser = etree.XMLParser(
        # A second declaration, after the removed one, may state another encoding.
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
    """Read a document with lxml, as an `XMLReader`; raises as `parse_xml` does."""
    todo: list[Any] = [parse_xml(body)]
    while todo:
        element = todo.pop()
        if element is None:
            yield "", "", {}
            continue
        yield _name(element), str(element.text or ""), element.attrib
        todo += [None, *reversed(element)]


def written(root: Any) -> bytes:
    """Write a parsed document for other libraries."""
    xml: bytes = importlib.import_module("lxml.etree").tostring(root, encoding="utf-8")
    return xml


def _without_wms_type(text: str) -> str:
    """Remove the document type of WMS 1.1.1, which is not needed."""
    comment = re.compile(r"\s*(?:<!--.*?-->|<\?.*?\?>)", re.DOTALL)
    at = 0
    head = text[: 1 << 16]
    while found := comment.match(head, at):
        at = found.end()
    stated = _WMS_TYPE.match(head, at)
    return text[stated.end() :] if stated else text


def _check_size(text: str) -> None:
    """Refuse a document that would take too much memory or time to parse."""
    # This is an upper bound, as brackets within comments and attributes are also counted.
    elements = text.count("<") - text.count("</")
    if len(text) > MAX_CAPABILITIES_BYTES or elements > MAX_XML_ELEMENTS or text.count("</") > MAX_XML_ELEMENTS:
        raise UnreadableXMLError(
            Message("more than {0} MB or {1:,} elements", MAX_CAPABILITIES_BYTES >> 20, MAX_XML_ELEMENTS)
        )
    if elements + text.count("=") > MAX_XML_NODES:
        raise UnreadableXMLError(Message("more than {0:,} elements and attributes", MAX_XML_NODES))
    for piece in text.split("<"):
        # Parsers compare each attribute of an element with all others. The shortest attribute is ` a=""`, 5 characters.
        if len(piece) > 5 * MAX_XML_ATTRIBUTES and piece.count("=") > MAX_XML_ATTRIBUTES:
            raise UnreadableXMLError(Message("more than {0:,} attributes of one element", MAX_XML_ATTRIBUTES))
    names = set()
    # Match names of elements and attributes.
    for found in re.finditer(r"<[^\s/<>]+|\s[^\s=<>\"'/]+\s*=", text):
        names.add(found.group())
        # Parsers keep all names in a hash table of fixed size.
        if len(names) > MAX_XML_NAMES:
            raise UnreadableXMLError(Message("more than {0:,} different names", MAX_XML_NAMES))


def _check_layers(root: Any) -> None:
    """Refuse too many layers, or too many inherited properties, which OWSLib copies to each layer."""
    if sum(1 for _ in root.iter("{*}Layer", "{*}Style")) > MAX_SERVICE_LAYERS:
        raise UnreadableXMLError(Message("more than {0:,} layers and styles", MAX_SERVICE_LAYERS))
    inherited, total = ("CRS", "SRS", "Style", "BoundingBox"), 0
    # Depth of each layer, and number of properties that the layer passes on; parents come first.
    known: dict[Any, tuple[int, int]] = {}
    for layer in root.iter("{*}Layer"):
        depth, passed_on = known.get(layer.getparent(), (0, 0))
        depth += 1
        passed_on += sum(max(len((child.text or "").split()), 1) for child in layer if _name(child) in inherited)
        known[layer] = depth, passed_on
        # OWSLib reads a layer once for each of its ancestors.
        total += depth * (1 + passed_on + len(layer))
        if total > MAX_XML_INHERITED:
            raise UnreadableXMLError(
                Message("layers that pass on more than {0:,} properties to those within them", MAX_XML_INHERITED)
            )


def _name(element: Any) -> str:
    """Name of an element without its namespace."""
    return str(element.tag).rpartition("}")[2]
