"""KML read by Qt, which every QGIS has; of lxml, with which the core reads it, some have none."""

from __future__ import annotations

from collections.abc import Iterator

from qgis.PyQt.QtCore import QXmlStreamReader

from ...core.safe_xml import UnreadableXMLError, checked_text
from ...core.text import one_line

_COORDINATES = "coordinates"


def xml_elements(body: bytes) -> Iterator[tuple[str, str]]:
    """Elements of a document, as `core.mission.area_files.XMLReader` gives them; text is that of coordinates alone.

    Raises
    ------
    UnreadableXMLError
        It is no XML, or none that is read (`checked_text`).
    """
    reader, kinds = QXmlStreamReader(checked_text(body)), QXmlStreamReader.TokenType
    skip = QXmlStreamReader.ReadElementTextBehaviour.SkipChildElements
    while not reader.atEnd():
        kind = reader.readNext()
        if kind == kinds.StartElement:
            name = str(reader.name())
            if name != _COORDINATES:
                yield name, ""
                continue
            # Up to the end of the element, which is then read.
            text = reader.readElementText(skip)
            if not reader.hasError():
                yield name, text
                yield "", ""
        elif kind == kinds.EndElement:
            yield "", ""
    if reader.hasError():
        raise UnreadableXMLError(one_line(reader.errorString()).rstrip("."))
