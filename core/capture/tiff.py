"""Directories of TIFF tags as bytes, for GeoTIFF and EXIF (TIFF 6.0, BigTIFF, little-endian)."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from enum import IntEnum
from typing import NamedTuple

HEADER_BYTES = 8


class TagType(IntEnum):
    """Types of a tag's values."""

    BYTE = 1
    ASCII = 2
    SHORT = 3
    LONG = 4
    RATIONAL = 5
    UNDEFINED = 7
    DOUBLE = 12
    #: BigTIFF only.
    LONG8 = 16


class Tag(NamedTuple):
    """One tag: its number, the type of its values, and the values.

    ASCII has a str (written as UTF-8, as GDAL and ExifTool read it); RATIONAL has alternating numerators and
    denominators; UNDEFINED has bytes.
    """

    number: int
    kind: TagType
    values: str | bytes | Sequence[int] | Sequence[float]

    def packed(self) -> tuple[int, bytes]:
        """Count and bytes of the values."""
        if isinstance(self.values, str):
            data = self.values.replace("\0", " ").encode("utf-8", "replace") + b"\0"
            return len(data), data
        if isinstance(self.values, bytes):
            return len(self.values), self.values
        codes = {"BYTE": "B", "SHORT": "H", "LONG": "I", "RATIONAL": "I", "DOUBLE": "d", "LONG8": "Q"}
        data = struct.pack(f"<{len(self.values)}{codes[self.kind.name]}", *self.values)
        return (len(self.values) // 2 if self.kind is TagType.RATIONAL else len(self.values)), data


def rational(value: float) -> list[int]:
    """Approximate a number of 0 or more by a numerator and a denominator of 32 bits; the denominator is a power of ten.

    Numbers from 1 to 2^32 keep nine digits, and smaller numbers nine decimals. Positive numbers stay positive. Numbers
    from 2^32 - 1 become 2^32 - 1.
    """
    largest = (1 << 32) - 1
    if value >= largest:
        return [largest, 1]
    denominator = next(10**digits for digits in range(9, -1, -1) if value * 10**digits < largest)
    return [max(round(value * denominator), int(value > 0.0)), denominator]


def header(directory_at: int = HEADER_BYTES) -> bytes:
    """Header of a file; the directory is at an offset, by default directly after the header."""
    return struct.pack("<2sHI", b"II", 42, directory_at)


def big_header(directory_at: int) -> bytes:
    """Header (16 bytes) of a BigTIFF, which has offsets of 64 bits."""
    return struct.pack("<2sHHHQ", b"II", 43, 8, 0, directory_at)


def directory(tags: Sequence[Tag], at: int, *, big: bool = False) -> bytes:
    """Return a directory and the values that its entries point to.

    Parameters
    ----------
    tags : sequence of Tag
        Tags in any order; each number at most once.
    at : int
        Offset of the directory in the file; even.
    big : bool
        Whether the file is a BigTIFF.

    Returns
    -------
    bytes
        The number of bytes is even and does not depend on the values of numeric tags.
    """
    counted, offset = ("Q", "Q") if big else ("H", "I")
    inside = struct.calcsize(f"<{offset}")
    entries, values = b"", b""
    values_at = at + struct.calcsize(f"<{counted}") + (4 + 2 * inside) * len(tags) + inside
    for tag in sorted(tags):
        count, data = tag.packed()
        if len(data) <= inside:
            field = data.ljust(inside, b"\0")
        else:
            field = struct.pack(f"<{offset}", values_at + len(values))
            values += data + b"\0" * (len(data) % 2)
        entries += struct.pack(f"<HH{offset}", tag.number, tag.kind, count) + field
    return struct.pack(f"<{counted}", len(tags)) + entries + struct.pack(f"<{offset}", 0) + values
