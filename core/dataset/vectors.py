"""GeoJSON of a dataset, checked before another program opens it.

GDAL, and QGIS by it, finds out by content what a file is: one that is called ``.geojson`` may be a list of other files
and servers (OGR VRT, WFS, KML), and GeoJSON itself may name its reference system by a link, a file or a grid. All of
them are followed while the file is opened. So it must look as captures and GDAL write it, from its first byte on.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from functools import partial

from ..errors import InvalidInput
from ..limits import MAX_GEOJSON_CRS_BYTES
from ..storage.files import open_foreign

#: Beginning in which GDAL's drivers look for what a file is; the most that one of them looks at is some 20 kB.
HEAD_BYTES = 1 << 16
_COLLECTION = re.compile(rb'(?:\xef\xbb\xbf)?\s*\{\s*"type"\s*:\s*"FeatureCollection"\s*[,}]')
#: A name of the specification of 2008, however its letters are written, and with any quotes that GDAL takes.
_CRS = re.compile(rb"""["'](?:c|\\u00[46]3)(?:r|\\u00[57]2)(?:s|\\u00[57]3)["']""", re.IGNORECASE)
#: Values of it that lead nowhere: no system, and a code of PROJ's database.
_PLAIN = re.compile(
    rb'"crs"\s*:\s*(?:null|\{\s*"type"\s*:\s*"name"\s*,\s*"properties"\s*:\s*\{\s*"name"\s*:\s*"'
    rb"(?:(?:EPSG|ESRI|IGNF|OGC):\w+|urn:(?:x-)?ogc:def:crs:\w+:[\d.]*:\w+)"
    rb'"\s*\}\s*\})'
)


def check_geojson(path: str | os.PathLike[str]) -> None:
    """Refuse a file that is no GeoJSON as captures and GDAL write it, or that leads elsewhere.

    It is read once, in blocks.

    Raises
    ------
    InvalidInput
    """
    try:
        with open_foreign(path) as file:
            for _ in checked_geojson(iter(partial(file.read, 1 << 20), b""), path):
                pass
    except OSError as wrong:
        raise InvalidInput("footprints {0}: cannot be read ({1})", path, wrong.strerror) from wrong


def checked_geojson(blocks: Iterable[bytes], name: object) -> Iterator[bytes]:
    """Yield the blocks of a file of GeoJSON, checked as `check_geojson` does.

    Parameters
    ----------
    blocks : iterable of bytes
    name : object
        What the file is, for messages.

    Raises
    ------
    InvalidInput
    """
    head, rest = b"", b""
    for block in blocks:
        if len(head) < HEAD_BYTES:
            head += block[: HEAD_BYTES - len(head)]
            if len(head) == HEAD_BYTES:
                _check_head(head, name)
        # What a block ends with may go on in the next one.
        rest = _checked(rest + block, name, MAX_GEOJSON_CRS_BYTES)
        yield block
    if len(head) < HEAD_BYTES:
        _check_head(head, name)
    _checked(rest, name, 0)


def _check_head(head: bytes, name: object) -> None:
    if _COLLECTION.match(head) is None:
        raise InvalidInput(
            "footprints {0}: are no GeoJSON as captures write it, which begins with {1}; a file of another kind is "
            "not opened, as it may lead to other files and servers",
            name,
            '{"type": "FeatureCollection"',
        )
    if b"<" in head:
        raise InvalidInput(
            "footprints {0}: hold a < among their first {1} bytes, as documents do that lead to other files and "
            "servers; must be written as {2}",
            name,
            HEAD_BYTES,
            "\\u003c",
        )


def _checked(text: bytes, name: object, left: int) -> bytes:
    """Check each reference system that begins before the last ``left`` bytes; return what is still to be checked."""
    until = max(len(text) - left, 0)
    for found in _CRS.finditer(text):
        if found.start() >= until:
            break
        plain = _PLAIN.match(text, found.start(), found.start() + MAX_GEOJSON_CRS_BYTES)
        if plain is None:
            raise InvalidInput(
                "footprints {0}: their crs leads elsewhere, or is none of a code; must be a name such as EPSG:25832, "
                "or left out for WGS 84",
                name,
            )
    return text[until:]


def json_without_tags(text: str) -> str:
    """JSON in which no text looks like a tag of XML, by which GDAL would take the file for a document."""
    return text.replace("<", "\\u003c")
