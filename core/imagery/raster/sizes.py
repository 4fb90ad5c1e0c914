"""Limits of a raster: bands, overviews, bytes of a block, directories of a TIFF.

Directories of TIFFs are checked before GDAL reads them, as a VRT may read any number of TIFFs. Texts in TIFFs are read
because they may name other files.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import IO, NamedTuple

from ...errors import InvalidInput
from ...limits import (
    MAX_RASTER_BANDS,
    MAX_RASTER_BLOCK_BYTES,
    MAX_RASTER_ITEMS,
    MAX_RASTER_OVERVIEWS,
    MAX_TIFF_DIRECTORIES,
)

#: Tags of TIFF, by number.
_WIDTH, _HEIGHT, _BITS, _COMPRESSION, _SAMPLES, _ROWS = 256, 257, 258, 259, 277, 278
_PLANAR, _TILE_WIDTH, _TILE_HEIGHT, _TIE_POINTS = 284, 322, 323, 33922
#: TIFF's types of whole numbers (1, 2, 4 and 8 bytes), with their formats in `struct`.
_TYPES = {1: "B", 3: "H", 4: "I", 16: "Q"}


def check_counts(bands: int, overviews: int) -> None:
    """Refuse too many bands or overviews; the InvalidInput names the reason, not the file."""
    if bands > MAX_RASTER_BANDS:
        raise InvalidInput(
            "has {0:,} bands: must be at most {1:,}",
            bands,
            MAX_RASTER_BANDS,
            remedy="make a copy of those that you need, with gdal_translate -b",
        )
    if overviews > MAX_RASTER_OVERVIEWS:
        raise InvalidInput(
            "has {0:,} overviews: must be at most {1:,}",
            overviews,
            MAX_RASTER_OVERVIEWS,
            remedy="make a copy without them, with gdal_translate",
        )


def check_block(width: int, height: int, bytes_per_px: float) -> None:
    """Refuse blocks of too many bytes; the InvalidInput names the reason, not the file."""
    size = width * height * bytes_per_px
    if size > MAX_RASTER_BLOCK_BYTES:
        raise InvalidInput(
            "is decoded in blocks of {0:,}x{1:,} px, {2:,.0f} MB each: must be at most {3:,} MB",
            width,
            height,
            size / (1 << 20),
            MAX_RASTER_BLOCK_BYTES >> 20,
            remedy="make a copy in tiles, with gdal_translate -co TILED=YES",
        )


class _Entry(NamedTuple):
    """Entry of a directory: type and number of values, the first value, and the values or their offset."""

    kind: int
    length: int
    first: int
    values: bytes


def check_directories(name: str, file: IO[bytes], head: bytes) -> None:
    """Refuse a TIFF with too many directories or control points, or too large blocks, for GDAL to read in time.

    Parameters
    ----------
    name : str
        Name of the file, for errors.
    head : bytes
        First bytes of the file; files other than TIFF pass.

    Raises
    ------
    InvalidInput
    """
    for _, entries in _directories(name, file, head):
        _check_entries(name, entries)


def tag_texts(name: str, file: IO[bytes], head: bytes, tag: int, most_bytes: int) -> Iterator[bytes]:
    """Yield the texts of a tag in a TIFF's directories, except those that fit in the entry itself (4 or 8 bytes).

    Other parameters are as for `check_directories`.

    Raises
    ------
    InvalidInput
        A text is longer than ``most_bytes``, or stored as numbers, which libtiff converts to text.
    """
    for order, entries in _directories(name, file, head):
        entry = entries.get(tag)
        if entry is None:
            continue
        # Accept all types of one byte.
        if entry.kind not in (1, 2, 6, 7):
            raise InvalidInput("{0} has numbers in place of the text of tag {1}", name, tag)
        if entry.length > most_bytes:
            raise InvalidInput("{0} holds more than {1:g} MB of metadata", name, most_bytes / (1 << 20))
        if entry.length > len(entry.values):
            file.seek(_offset(order, entry.values))
            yield file.read(entry.length)


def _directories(name: str, file: IO[bytes], head: bytes) -> Iterator[tuple[str, dict[int, _Entry]]]:
    """Yield the byte order and the entries of each readable directory."""
    # By version (TIFF, BigTIFF): format of offsets, place of the first offset, formats of entry count and of an entry.
    formats = {42: ("I", 4, "H", "HHI4s"), 43: ("Q", 8, "Q", "HHQ8s")}
    order = {b"II": "<", b"MM": ">"}.get(head[:2], "")
    form = formats.get(struct.unpack_from(f"{order}H", head, 2)[0]) if order and len(head) >= 16 else None
    if form is None:
        return
    offset_kind, offset_at, count_kind, entry_kind = form
    (at,) = struct.unpack_from(order + offset_kind, head, offset_at)
    number = 0
    while at:
        number += 1
        if number > MAX_TIFF_DIRECTORIES:
            raise InvalidInput(
                "{0} has more than {1:,} directories",
                name,
                MAX_TIFF_DIRECTORIES,
                remedy="make a copy of its first image, with gdal_translate",
            )
        try:
            file.seek(at)
            entries = _entries(file, order, count_kind, entry_kind)
            end = file.tell()
        except (OSError, OverflowError, ValueError, struct.error):
            # GDAL reports errors of such a file later.
            return
        yield order, entries
        file.seek(end)
        following = file.read(struct.calcsize(offset_kind))
        if len(following) < struct.calcsize(offset_kind):
            return
        (at,) = struct.unpack(order + offset_kind, following)


def _entries(file: IO[bytes], order: str, count_kind: str, entry_kind: str) -> dict[int, _Entry]:
    """Read a directory; return the entries by tag, with the file positioned after them."""
    (count,) = struct.unpack(order + count_kind, file.read(struct.calcsize(count_kind)))
    # libtiff refuses more entries.
    if count > 4096:
        raise ValueError(count)
    size = struct.calcsize(order + entry_kind)
    content = file.read(count * size)
    end = file.tell()
    wanted = {_WIDTH, _HEIGHT, _BITS, _COMPRESSION, _SAMPLES, _ROWS, _PLANAR, _TILE_WIDTH, _TILE_HEIGHT}
    found: dict[int, _Entry] = {}
    for tag, kind, length, values in struct.iter_unpack(order + entry_kind, content):
        is_read = kind in _TYPES and tag in wanted and tag not in found
        first = _first(file, order, _TYPES[kind], length, values) if is_read else 0
        found.setdefault(tag, _Entry(kind, length, first, values))
    file.seek(end)
    return found


def _first(file: IO[bytes], order: str, kind: str, length: int, values: bytes) -> int:
    """First value of an entry; 0 if it lies beyond the file's end, which libtiff tolerates for some tags."""
    size = struct.calcsize(kind)
    try:
        if size * length > len(values):
            file.seek(_offset(order, values))
            values = file.read(size)
        return int(struct.unpack_from(order + kind, values)[0])
    except (OSError, OverflowError, ValueError, struct.error):
        return 0


def _offset(order: str, values: bytes) -> int:
    return int(struct.unpack(order + ("I" if len(values) == 4 else "Q"), values)[0])


def _check_entries(name: str, entries: dict[int, _Entry]) -> None:
    def value(tag: int, usual: int) -> int:
        return entries[tag].first if tag in entries else usual

    # A tie point has six numbers.
    points = entries[_TIE_POINTS].length // 6 if _TIE_POINTS in entries else 0
    if points > MAX_RASTER_ITEMS:
        raise InvalidInput("{0} has {1:,} ground control points: must be at most {2:,}", name, points, MAX_RASTER_ITEMS)
    width, height = value(_WIDTH, 0), value(_HEIGHT, 0)
    bits = value(_BITS, 1)
    is_separate, is_uncompressed = value(_PLANAR, 1) == 2, value(_COMPRESSION, 1) == 1
    samples = 1 if is_separate else value(_SAMPLES, 1)
    across, down = value(_TILE_WIDTH, 0), value(_TILE_HEIGHT, 0)
    if not (across and down):
        across, down = width, min(value(_ROWS, height), height)
        # GDAL reads a large single strip of this kind line by line.
        if (is_uncompressed or bits <= 8) and down == height > 2000:
            return
    try:
        check_block(across, down, samples * bits / 8)
    except InvalidInput as wrong:
        raise InvalidInput("{0} {1}", name, wrong) from wrong
