"""GeoJSON (RFC 7946) without GDAL. Areas that cross themselves cannot be repaired without it, and are left out."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput
from ..storage.files import read_limited
from ..text.safe_json import parse_json

#: Largest GeoJSON file that is read without GDAL, as a whole.
MAX_BYTES = 256 * 2**20
_TYPES = ("Point", "LineString", "Polygon", "MultiPoint", "MultiLineString", "MultiPolygon", "GeometryCollection")


def read_geojson(path: str) -> tuple[str, tuple[str, ...], list[dict[str, Any]]]:
    """CRS, fields and features of a file.

    Raises
    ------
    InvalidInput
        It is no GeoJSON.
    """
    try:
        content = parse_json(read_limited(path, MAX_BYTES))
    except InvalidInput as wrong:
        raise InvalidInput("{0}: cannot be read: {1}", Path(path).name, wrong) from wrong
    kind = content.get("type") if isinstance(content, dict) else None
    features = content.get("features") if kind == "FeatureCollection" else [content] if kind == "Feature" else None
    if not isinstance(features, list) or not all(isinstance(one, dict) for one in features):
        raise InvalidInput("{0}: not a vector file that can be read", Path(path).name)
    fields = dict.fromkeys(name for one in features for name in one.get("properties") or {})
    named = (content.get("crs") or {}).get("properties") or {}
    return str(named.get("name") or "OGC:CRS84"), tuple(fields), features


def records(features: list[dict[str, Any]], fields: tuple[str, ...]) -> Iterator[tuple[bytes, tuple[Any, ...]]]:
    """Geometry (well-known binary, empty if there is none) and values of each feature."""
    for one in features:
        values = one.get("properties") or {}
        geometry = one.get("geometry")
        yield _binary(geometry) if geometry else b"", tuple(_plain(values.get(name)) for name in fields)


def _plain(value: Any) -> Any:
    if value is None or isinstance(value, (str, float)):
        return value
    return int(value) if isinstance(value, int) else str(value)


def _binary(geometry: dict[str, Any]) -> bytes:
    """Well-known binary of a geometry; empty if its coordinates are not such."""
    try:
        code = _TYPES.index(geometry["type"]) + 1
        if code == 7:
            inner = [_binary(one) for one in geometry["geometries"]]
            return struct.pack("<BII", 1, 7, len(inner)) + b"".join(inner)
        at = geometry["coordinates"]
        if code > 3:
            inner = [_binary({"type": _TYPES[code - 4], "coordinates": one}) for one in at]
            return struct.pack("<BII", 1, code, len(inner)) + b"".join(inner)
        if code == 1:
            return struct.pack("<BIdd", 1, 1, *at[:2])
        rings = [at] if code == 2 else at
        if code == 3 and _crosses(rings):
            return b""
        head = struct.pack("<BI", 1, 2) if code == 2 else struct.pack("<BII", 1, 3, len(rings))
        return head + b"".join(
            struct.pack(f"<I{2 * len(ring)}d", len(ring), *(value for place in ring for value in place[:2]))
            for ring in rings
        )
    except (KeyError, IndexError, TypeError, ValueError, struct.error):
        return b""


def _crosses(rings: list[list[list[float]]]) -> bool:
    """Whether any two edges of a polygon cross inside both."""
    edges = [np.array([place[:2] for place in ring], np.float64) for ring in rings]
    start = np.concatenate([ring[:-1] for ring in edges])
    along = np.concatenate([np.diff(ring, axis=0) for ring in edges])
    for origin, edge in zip(start, along):
        # On which side of this edge the others begin and end, and on which sides of the others this one does.
        begin = start - origin
        first, second = _cross(edge, begin), _cross(edge, begin + along)
        third, fourth = _cross(along, -begin), _cross(along, edge - begin)
        if ((first * second < 0.0) & (third * fourth < 0.0)).any():
            return True
    return False


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
