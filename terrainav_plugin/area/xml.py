"""XML read by Qt, as some installations of QGIS lack lxml, which the core uses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from qgis.PyQt.QtCore import QXmlStreamReader

from ...core.limits import MAX_XML_DEPTH
from ...core.text.plain import one_line
from ...core.text.safe_xml import ATTRIBUTES, TEXTS, UnreadableXMLError, checked_text, too_deep


def xml_elements(body: bytes) -> Iterator[tuple[str, str, Mapping[str, str]]]:
    """Elements of a document, as from a `core.safe_xml.XMLReader`.

    Raises
    ------
    UnreadableXMLError
        The document is not XML, or `checked_text` refuses it.
    """
    reader, kinds = QXmlStreamReader(checked_text(body)), QXmlStreamReader.TokenType
    skip = QXmlStreamReader.ReadElementTextBehaviour.SkipChildElements
    depth = 0
    while not reader.atEnd():
        kind = reader.readNext()
        if kind == kinds.StartElement:
            depth += 1
            if depth > MAX_XML_DEPTH:
                raise too_deep()
            name = str(reader.name())
            if name not in TEXTS:
                yield name, "", _attributes(reader) if name in ATTRIBUTES else {}
                continue
            # This also reads the end of the element.
            text = reader.readElementText(skip)
            depth -= 1
            if not reader.hasError():
                yield name, text, {}
                yield "", "", {}
        elif kind == kinds.EndElement:
            depth -= 1
            yield "", "", {}
    if reader.hasError():
        raise UnreadableXMLError(one_line(reader.errorString()).rstrip("."))


def _attributes(reader: QXmlStreamReader) -> dict[str, str]:
    found = reader.attributes()
    return {str(one.name()): str(one.value()) for one in map(found.at, range(found.size()))}
