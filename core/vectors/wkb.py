"""Geometries in well-known binary (OGC 06-103r4), in two dimensions."""

from __future__ import annotations

import struct

import numpy as np

from ..arrays import Floats
from .features import LINE, POINT, POLYGON

#: A polygon, line or point, with its rings (each (k, 2)).
Part = tuple[int, list[Floats]]

_POINT, _LINE, _POLYGON = 1, 2, 3
#: Multi-geometries, collections, and surfaces of polygons.
_COLLECTIONS = (4, 5, 6, 7, 15, 16)
_TRIANGLE = 17


def parse_wkb(data: bytes) -> list[Part]:
    """Parts of a geometry whose kind has the most dimensions; none of an empty geometry.

    A collection of polygons, lines and points is read as its polygons.
    """
    parts: list[Part] = []
    _read(data, 0, parts)
    parts = [(kind, rings) for kind, rings in parts if rings and len(rings[0]) and np.isfinite(rings[0]).all()]
    least = min((kind for kind, _ in parts), default=POINT)
    return [part for part in parts if part[0] == least]


def _read(data: bytes, at: int, parts: list[Part]) -> int:
    order = "<" if data[at] else ">"
    code: int
    count: int
    (code,) = struct.unpack_from(order + "I", data, at + 1)
    code = (code & 0xFF) if code & 0xE0000000 else code % 1000
    at += 5
    if code == _POINT:
        parts.append((POINT, [np.frombuffer(data, order + "f8", 2, at).astype(np.float64).reshape(1, 2)]))
        return at + 16
    (count,) = struct.unpack_from(order + "I", data, at)
    at += 4
    if code in _COLLECTIONS:
        for _ in range(count):
            at = _read(data, at, parts)
        return at
    if code == _LINE:
        parts.append((LINE, [_vertices(data, order, count, at)]))
        return at + 16 * count
    if code not in (_POLYGON, _TRIANGLE):
        raise ValueError(code)
    rings = []
    for _ in range(count):
        size: int = struct.unpack_from(order + "I", data, at)[0]
        rings.append(_vertices(data, order, size, at + 4))
        at += 4 + 16 * size
    parts.append((POLYGON, rings))
    return at


def _vertices(data: bytes, order: str, count: int, at: int) -> Floats:
    return np.frombuffer(data, order + "f8", 2 * count, at).astype(np.float64).reshape(count, 2)
