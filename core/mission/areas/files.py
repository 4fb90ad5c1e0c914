"""Polygons in files: GeoJSON, KML and KMZ."""

from __future__ import annotations

import io
import math
import os
import zipfile
import zlib
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from ...errors import InvalidInput, Message, OutputError
from ...limits import MAX_CAPABILITIES_BYTES, MAX_KMZ_FILES, MAX_MISSION_BYTES, MAX_POLYGONS
from ...numbers import real_number
from ...storage.files import read_limited
from ...text.safe_json import parse_json
from ...text.safe_xml import UnreadableXMLError, XMLReader, iterate_elements
from .area import Polygon, Polygons, check_rings
from .geojson import System, shapes

#: Ways in which files of a KMZ are packed; readers of others raise errors of their own.
_PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
#: What holds the rings of a Polygon: the outer one, and those of holes.
_BOUNDARIES = ("outerBoundaryIs", "innerBoundaryIs")
#: What `zipfile` raises of archives that are broken, encrypted, or not what they say.
_BROKEN = (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, NotImplementedError, ValueError, OSError)


_Rings = tuple[tuple[tuple[float, float], ...], ...]


def load_area(path: str | os.PathLike[str], read_xml: XMLReader = iterate_elements) -> Polygon | Polygons:
    """All polygons of a file as one area.

    Raises
    ------
    InvalidInput
        As `load_polygons` does.
    """
    found = load_polygons(path, Message("area file {0}", path), read_xml)
    return found[0] if len(found) == 1 else Polygons(found)


def load_no_fly(path: str | os.PathLike[str], read_xml: XMLReader = iterate_elements) -> tuple[Polygon, ...]:
    """All polygons of a file where no camera may stand; raises as `load_polygons` does."""
    return load_polygons(path, Message("no-fly file {0}", path), read_xml)


def load_polygons(
    path: str | os.PathLike[str], where: str, read_xml: XMLReader = iterate_elements
) -> tuple[Polygon, ...]:
    """All polygons of a GeoJSON, KML or KMZ file, in its order, each once.

    The kind of file is told by what it holds, whatever its name. Other geometries of it are left out, and so are the
    heights of corners. In KML rings count that are those of a Polygon or stand alone; what the file links to is not
    fetched.

    Parameters
    ----------
    where : str
        What the file is, for messages.
    read_xml : callable
        What reads KML; by default lxml does.

    Raises
    ------
    InvalidInput
        The file cannot be read, is in a reference system that is not known, holds no polygon, or one that is none, see
        `check_rings`.
    OutputError
        A KML file, and lxml is not installed.
    """
    try:
        body = read_limited(path, MAX_MISSION_BYTES, named_by_user=True)
    except OSError as wrong:
        raise InvalidInput("{0}: cannot be read ({1})", where, wrong.strerror or wrong) from wrong
    except InvalidInput as wrong:
        raise InvalidInput("{0}: cannot be read ({1})", where, wrong) from wrong
    found: Iterable[_Rings]
    # A KMZ is a zip.
    if body.startswith(b"PK\x03\x04"):
        found = _kmz_polygons(body, where, read_xml)
    # A mark of the encoding may come first, and UTF-16 has a zero beside each character.
    elif body.lstrip(b"\xef\xbb\xbf\xfe\xff\0 \t\r\n").startswith(b"<"):
        found = _kml_polygons(body, where, read_xml)
    else:
        found = _geojson_polygons(body, where)
    # Those that are there again take no time; they are numbered as the file has them.
    first: dict[_Rings, int] = {}
    for number, rings in enumerate(found, 1):
        first.setdefault(rings, number)
        if len(first) > MAX_POLYGONS:
            raise InvalidInput("{0}: holds more than {1:,} polygons", where, MAX_POLYGONS)
    polygons = dict.fromkeys(_polygon(rings, number, where) for rings, number in first.items())
    if not polygons:
        raise InvalidInput("{0}: holds no polygon", where, remedy="give a GeoJSON, KML or KMZ file with one or more")
    return tuple(polygons)


def _polygon(rings: _Rings, number: int, where: str) -> Polygon:
    try:
        polygon = Polygon(rings)
        check_rings(polygon)
    except InvalidInput as wrong:
        raise InvalidInput("{0}: polygon {1:,}: {2}", where, number, wrong) from wrong
    return polygon


# --- GeoJSON


def _geojson_polygons(body: bytes, where: str) -> Iterator[_Rings]:
    try:
        data = parse_json(body)
    except InvalidInput as wrong:
        raise InvalidInput("{0}: cannot be read as GeoJSON, KML or KMZ ({1})", where, wrong) from wrong
    try:
        for polygon, system in shapes(data, "Polygon", where):
            yield tuple(_ring_degrees(ring, system) for ring in polygon)
    except InvalidInput:
        raise
    except (TypeError, ValueError, IndexError, KeyError) as wrong:
        raise InvalidInput("{0}: a corner is not longitude, latitude ({1})", where, wrong) from wrong


def _ring_degrees(ring: list[Any], system: System) -> tuple[tuple[float, float], ...]:
    corners = np.array([(float(corner[0]), float(corner[1])) for corner in ring]).reshape(-1, 2)
    return tuple((lon, lat) for lon, lat in system.degrees(corners).tolist())


# --- KML


def _kmz_polygons(body: bytes, where: str, read_xml: XMLReader) -> list[_Rings]:
    """Polygons of a KMZ: those of ``doc.kml``, or where that only leads to other files in it, as GDAL's, theirs."""
    main, *others = _unpacked(body, where)
    found = list(_kml_polygons(main, where, read_xml))
    return found or [rings for text in others for rings in _kml_polygons(text, where, read_xml)]


def _unpacked(body: bytes, where: str) -> list[bytes]:
    """The KML files of a KMZ: ``doc.kml`` first, then those nearest to the top; raises where there is none."""
    try:
        with zipfile.ZipFile(io.BytesIO(body)) as archive:
            entries = archive.infolist()
            if len(entries) > MAX_KMZ_FILES:
                raise InvalidInput("{0}: holds more than {1:,} files", where, MAX_KMZ_FILES)
            found = [one for one in entries if one.filename.lower().endswith(".kml")]
            if not found:
                raise InvalidInput("{0}: is a zip without a KML file", where)
            # Google Earth calls the file that a KMZ shows doc.kml; others put it elsewhere.
            found.sort(key=lambda one: (one.filename.lower() != "doc.kml", one.filename.count("/")))
            texts, left = [], MAX_CAPABILITIES_BYTES
            for one in found:
                if one.compress_type not in _PACKED:
                    raise InvalidInput("{0}: is compressed in a way that KMZ does not use", where)
                with archive.open(one) as packed:
                    # What it says of its size may be wrong.
                    texts.append(packed.read(left + 1))
                left -= len(texts[-1])
                if left < 0:
                    break
    except InvalidInput:
        raise
    except _BROKEN as wrong:
        raise InvalidInput("{0}: cannot be read as KMZ ({1})", where, wrong) from wrong
    if left < 0:
        raise InvalidInput("{0}: its KML is larger than {1} MB", where, MAX_CAPABILITIES_BYTES >> 20)
    return texts


def _kml_polygons(body: bytes, where: str, read_xml: XMLReader) -> list[_Rings]:
    if len(body) > MAX_CAPABILITIES_BYTES:
        raise InvalidInput("{0}: its KML is larger than {1} MB", where, MAX_CAPABILITIES_BYTES >> 20)
    try:
        return _read_rings(((name, text) for name, text, _ in read_xml(body)), where)
    except UnreadableXMLError as wrong:
        raise InvalidInput("{0}: cannot be read as KML ({1})", where, wrong) from wrong
    except ImportError as missing:
        raise OutputError(
            "{0}: {1}, which reads KML, is not installed",
            where,
            "lxml",
            remedy=Message("get it with: pip install 'terrainav[{0}]', or give a GeoJSON file", "kml"),
        ) from missing


def _read_rings(elements: Iterable[tuple[str, str]], where: str) -> list[_Rings]:
    """Rings of each Polygon, the outer one first, and those that stand alone."""
    found: list[_Rings] = []
    open_: list[str] = []
    ring: list[tuple[float, float]] = []
    rings: dict[str, list[tuple[tuple[float, float], ...]]] = {}
    for name, text in elements:
        if name:
            open_.append(name)
            if name == "Polygon":
                rings = {boundary: [] for boundary in _BOUNDARIES}
            elif name == "LinearRing":
                ring = []
            elif open_[-2:] == ["LinearRing", "coordinates"]:
                # People write spaces after the commas of a corner.
                corners = ",".join(part.strip() for part in text.split(",")).split()
                ring += [_corner(corner, where) for corner in corners]
            continue
        ended, parent = open_.pop(), open_[-1] if open_ else ""
        if ended == "LinearRing" and parent not in _BOUNDARIES:
            found.append((tuple(ring),))
        elif ended == "LinearRing" and open_[-2:-1] == ["Polygon"]:
            rings[parent].append(tuple(ring))
        elif ended == "Polygon":
            outer, inner = rings.values()
            found += [(outer[0], *inner)] if outer else []
    return found


def _corner(text: str, where: str) -> tuple[float, float]:
    numbers = text.split(",")
    try:
        lon, lat = real_number(numbers[0]), real_number(numbers[1])
    except (ValueError, IndexError):
        lon = lat = math.nan
    if not (math.isfinite(lon) and math.isfinite(lat)):
        raise InvalidInput("{0}: corner {1!r} is not longitude,latitude", where, text[:60])
    return lon, lat
