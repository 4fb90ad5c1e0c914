"""GeoTIFFs larger than memory: tiles of 8-bit pixels with alpha, written one by one."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from ..arrays import Bytes
from ..bands import Bands
from ..capture.georeference import Georeference
from ..capture.metadata import SOFTWARE
from ..capture.tiff import Tag, TagType, big_header, directory, header
from ..capture.writers import band_items, gdal_metadata
from ..errors import OutputError
from ..storage.files import partial_file

#: Side of a tile, a multiple of 16.
TILE_PX = 256
#: Offsets of a classic TIFF have 32 bits; 16 MB are left for tags.
_MOST_BYTES = (1 << 32) - (1 << 24)


def packed_tile(pixels: Bytes) -> bytes:
    """Deflate a tile (h, w, n) with horizontal differencing (Predictor 2), padded with zeros to `TILE_PX`."""
    tile = np.zeros((TILE_PX, TILE_PX, pixels.shape[2]), np.uint8)
    tile[: pixels.shape[0], : pixels.shape[1]] = pixels
    tile[:, 1:] -= tile[:, :-1].copy()
    # Level 6 is fast, and within a few per cent of the smallest.
    packer = zlib.compressobj(6, zlib.DEFLATED, zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL, zlib.Z_RLE)
    return packer.compress(tile.tobytes()) + packer.flush()


def write_tiles(
    target: Path,
    place: Georeference,
    channels: int,
    tiles: Iterable[tuple[int, int, bytes]],
    title: str = "",
    attribution: str = "",
    bands: Bands | None = None,
) -> None:
    """Write a tiled GeoTIFF atomically, as BigTIFF if it might not fit a classic TIFF.

    Parameters
    ----------
    channels : int
        2 (grey and alpha) or 4 (red, green, blue and alpha).
    tiles : iterable of (column, row, bytes)
        `packed_tile` of each tile, in any order; missing tiles are transparent.
    bands : Bands or None
        Names and values of the bands for the metadata, if known.

    Raises
    ------
    OutputError
    """
    columns, rows = (-(-size // TILE_PX) for size in (place.width_px, place.height_px))
    is_big = columns * rows * TILE_PX * TILE_PX * channels > _MOST_BYTES
    offsets, lengths = np.zeros((2, rows, columns), np.int64)
    try:
        with partial_file(target) as partial, partial.open("xb") as file:
            # The offset of the directory is filled in at the end.
            file.write(big_header(0) if is_big else header().ljust(16, b"\0"))
            for column, row, data in tiles:
                offsets[row, column], lengths[row, column] = file.tell(), len(data)
                file.write(data)
            missing = lengths == 0
            if missing.any():
                # All missing tiles share one empty tile, as not every reader supports sparse files.
                data = packed_tile(np.zeros((1, 1, channels), np.uint8))
                offsets[missing], lengths[missing] = file.tell(), len(data)
                file.write(data)
            file.write(b"\0" * (file.tell() % 2))
            at = file.tell()
            kind = TagType.LONG8 if is_big else TagType.LONG
            tags = [
                Tag(256, TagType.LONG, [place.width_px]),
                Tag(257, TagType.LONG, [place.height_px]),
                Tag(258, TagType.SHORT, [8] * channels),
                Tag(259, TagType.SHORT, [8]),  # compression: deflate
                Tag(262, TagType.SHORT, [1 if channels == 2 else 2]),  # black is zero; RGB
                Tag(270, TagType.ASCII, title),
                Tag(277, TagType.SHORT, [channels]),
                Tag(284, TagType.SHORT, [1]),  # chunky
                Tag(305, TagType.ASCII, SOFTWARE),
                Tag(317, TagType.SHORT, [2]),  # horizontal differencing
                Tag(322, TagType.LONG, [TILE_PX]),
                Tag(323, TagType.LONG, [TILE_PX]),
                Tag(324, kind, offsets.ravel().tolist()),
                Tag(325, kind, lengths.ravel().tolist()),
                Tag(338, TagType.SHORT, [2]),  # unassociated alpha
                Tag(33432, TagType.ASCII, attribution),
                *place.tags(),
            ]
            if items := "" if bands is None else band_items(bands):
                tags.append(Tag(42112, TagType.ASCII, gdal_metadata(items)))
            file.write(directory(tags, at, big=is_big))
            file.seek(0)
            file.write(big_header(at) if is_big else header(at))
    except OSError as wrong:
        raise OutputError("mosaic {0}: cannot be written ({1})", target, wrong.strerror) from wrong
