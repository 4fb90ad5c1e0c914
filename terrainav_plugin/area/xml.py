"""XML read by Qt, which every QGIS has; of lxml, with which the core reads it, some have none."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from qgis.PyQt.QtCore import QXmlStreamReader

from ...core.limits import MAX_XML_DEPTH
from ...core.text.plain import one_line
from ...core.text.safe_xml import ATTRIBUTES, TEXTS, UnreadableXMLError, checked_text, too_deep


def xml_elements(body: bytes) -> Iterator[tuple[str, str, Mapping[str, str]]]:
    """Elements of a document, as a `core.safe_xml.XMLReader` gives them.

    Raises
    ------
    UnreadableXMLError
        It is no XML, or none that is read (`checked_text`).
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
            # Up to the end of the element, which is then read.
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
