"""Check a dataset's GeoJSON before another program opens it.

GDAL, and so QGIS, recognises files by content: a ``.geojson`` may be a list of other files and servers (OGR VRT, WFS,
KML), and GeoJSON may name its reference system by a link, a file or a grid. GDAL follows all of these when it opens the
file. Therefore, the file must look from its first byte on as captures and GDAL write it.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from functools import partial

from ..errors import InvalidInput
from ..limits import MAX_GEOJSON_CRS_BYTES
from ..storage.files import open_foreign

#: Bytes at the start of a file that are checked; GDAL's drivers recognise files by at most 20 kB.
HEAD_BYTES = 1 << 16
#: The key ``crs`` of GeoJSON 2008, with letters escaped or not, and any quotes that GDAL accepts.
_CRS = re.compile(rb"""["'](?:c|\\u00[46]3)(?:r|\\u00[57]2)(?:s|\\u00[57]3)["']""", re.IGNORECASE)
#: The key ``crs`` with a harmless value: null, or a code of PROJ's database.
_PLAIN = re.compile(
    rb'"crs"\s*:\s*(?:null|\{\s*"type"\s*:\s*"name"\s*,\s*"properties"\s*:\s*\{\s*"name"\s*:\s*"'
    rb"(?:(?:EPSG|ESRI|IGNF|OGC):\w+|urn:(?:x-)?ogc:def:crs:\w+:[\d.]*:\w+)"
    rb'"\s*\}\s*\})'
)


def check_geojson(path: str | os.PathLike[str]) -> None:
    """Raise InvalidInput for a file that is not GeoJSON as captures and GDAL write it, or refers to other files."""
    try:
        with open_foreign(path) as file:
            for _ in checked_geojson(iter(partial(file.read, 1 << 20), b""), path):
                pass
    except OSError as wrong:
        raise InvalidInput("footprints {0}: cannot be read ({1})", path, wrong.strerror) from wrong


def checked_geojson(blocks: Iterable[bytes], name: object) -> Iterator[bytes]:
    """Yield the blocks of a GeoJSON file, checked as by `check_geojson`.

    Parameters
    ----------
    blocks : iterable of bytes
    name : object
        Name of the file for messages.

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
        # A CRS at the end of a block may continue in the next one.
        rest = _checked(rest + block, name, MAX_GEOJSON_CRS_BYTES)
        yield block
    if len(head) < HEAD_BYTES:
        _check_head(head, name)
    _checked(rest, name, 0)


def _check_head(head: bytes, name: object) -> None:
    if re.match(rb'(?:\xef\xbb\xbf)?\s*\{\s*"type"\s*:\s*"FeatureCollection"\s*[,}]', head) is None:
        raise InvalidInput(
            "footprints {0}: are not GeoJSON as captures write it, which begins with {1}; a file of another kind is "
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
    """Check each CRS that begins before the last ``left`` bytes; return these bytes, which are still to be checked."""
    until = max(len(text) - left, 0)
    for found in _CRS.finditer(text):
        if found.start() >= until:
            break
        plain = _PLAIN.match(text, found.start(), found.start() + MAX_GEOJSON_CRS_BYTES)
        if plain is None:
            raise InvalidInput(
                "footprints {0}: their crs is not the code of a system; must be a name such as EPSG:25832, "
                "or left out for WGS 84",
                name,
            )
    return text[until:]


def json_without_tags(text: str) -> str:
    """Escape ``<`` in JSON, which GDAL could take for the start of an XML document."""
    return text.replace("<", "\\u003c")
