"""Polygons from GeoJSON, KML and KMZ files."""

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

#: Elements of a Polygon around its outer ring and its holes.
_BOUNDARIES = ("outerBoundaryIs", "innerBoundaryIs")
_Rings = tuple[tuple[tuple[float, float], ...], ...]


def load_area(path: str | os.PathLike[str], read_xml: XMLReader = iterate_elements) -> Polygon | Polygons:
    """Read all polygons of a file as one area; raises as `load_polygons` does."""
    found = load_polygons(path, Message("area file {0}", path), read_xml)
    return found[0] if len(found) == 1 else Polygons(found)


def load_no_fly(path: str | os.PathLike[str], read_xml: XMLReader = iterate_elements) -> tuple[Polygon, ...]:
    """Read all polygons of a file as no-fly areas; raises as `load_polygons` does."""
    return load_polygons(path, Message("no-fly file {0}", path), read_xml)


def load_polygons(
    path: str | os.PathLike[str], where: str, read_xml: XMLReader = iterate_elements
) -> tuple[Polygon, ...]:
    """Read the polygons of a GeoJSON, KML or KMZ file, in its order and without duplicates.

    The content decides the format, not the name. Other geometries and the heights of corners are ignored. In KML, rings
    outside a Polygon count as polygons; links are not followed.

    Parameters
    ----------
    where : str
        Name of the file, for messages.
    read_xml : callable
        Parser of KML, by default lxml's.

    Raises
    ------
    InvalidInput
        The file cannot be read, has an unknown reference system, no polygon, or an invalid polygon, see `check_rings`.
    OutputError
        The file is KML, and lxml is not installed.
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
    # KML may begin with a byte order mark, and in UTF-16 a zero byte beside each character.
    elif body.lstrip(b"\xef\xbb\xbf\xfe\xff\0 \t\r\n").startswith(b"<"):
        found = _kml_polygons(body, where, read_xml)
    else:
        found = _geojson_polygons(body, where)
    # Skip duplicates early, but number polygons as the file does.
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
    """Polygons of ``doc.kml`` in a KMZ; if it has none, of the other KML files, to which GDAL's ``doc.kml`` links."""
    main, *others = _unpacked(body, where)
    found = list(_kml_polygons(main, where, read_xml))
    return found or [rings for text in others for rings in _kml_polygons(text, where, read_xml)]


def _unpacked(body: bytes, where: str) -> list[bytes]:
    """Unpack the KML files of a KMZ, ``doc.kml`` first, then by depth; raises InvalidInput if there are none."""
    try:
        with zipfile.ZipFile(io.BytesIO(body)) as archive:
            entries = archive.infolist()
            if len(entries) > MAX_KMZ_FILES:
                raise InvalidInput("{0}: holds more than {1:,} files", where, MAX_KMZ_FILES)
            found = [one for one in entries if one.filename.lower().endswith(".kml")]
            if not found:
                raise InvalidInput("{0}: is a zip without a KML file", where)
            # Google Earth shows doc.kml; other programs name the file differently.
            found.sort(key=lambda one: (one.filename.lower() != "doc.kml", one.filename.count("/")))
            texts, left = [], MAX_CAPABILITIES_BYTES
            for one in found:
                # Other decompressors raise undocumented errors.
                if one.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                    raise InvalidInput("{0}: is compressed in a way that KMZ does not use", where)
                with archive.open(one) as packed:
                    # The stated size may be wrong.
                    texts.append(packed.read(left + 1))
                left -= len(texts[-1])
                if left < 0:
                    break
    except InvalidInput:
        raise
    # Raised by zipfile for broken, encrypted and forged archives.
    except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, NotImplementedError, ValueError, OSError) as wrong:
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
    """Read the rings of each Polygon, the outer one first, and each LinearRing outside a Polygon."""
    found: list[_Rings] = []
    path: list[str] = []
    ring: list[tuple[float, float]] = []
    rings: dict[str, list[tuple[tuple[float, float], ...]]] = {}
    for name, text in elements:
        if name:
            path.append(name)
            if name == "Polygon":
                rings = {boundary: [] for boundary in _BOUNDARIES}
            elif name == "LinearRing":
                ring = []
            elif path[-2:] == ["LinearRing", "coordinates"]:
                # Allow spaces after the commas of a corner.
                corners = ",".join(part.strip() for part in text.split(",")).split()
                ring += [_corner(corner, where) for corner in corners]
            continue
        ended, parent = path.pop(), path[-1] if path else ""
        if ended == "LinearRing" and parent not in _BOUNDARIES:
            found.append((tuple(ring),))
        elif ended == "LinearRing" and path[-2:-1] == ["Polygon"]:
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
