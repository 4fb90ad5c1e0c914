"""Pictures with known pixels, which encode their position on the global pixel grid or show the embedded world."""

from __future__ import annotations

import io
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
from PIL import Image

# A tile: (map_type, zoom, x, y, size_px) -> (size_px, size_px, 3) uint8, or None where there is no imagery.
Painter = Callable[[str, int, int, int, int], "np.ndarray | None"]

# Positions are encoded modulo this: 12 bits for each axis fill the 24 bits of a pixel.
MODULUS = 4096
# Order of the channels by map type, so that map types cannot be confused.
_CHANNELS = {"satellite": (0, 1, 2), "roadmap": (1, 2, 0), "terrain": (2, 0, 1)}


def encode_position(columns, rows, map_type="satellite"):
    """Return a picture, (rows, columns, 3) uint8, whose pixels hold their column and row modulo `MODULUS`."""
    column, row = np.meshgrid(np.asarray(columns) % MODULUS, np.asarray(rows) % MODULUS)
    channels = (column & 255, row & 255, (column >> 8) | (row >> 8 << 4))
    order = _CHANNELS.get(map_type, (0, 1, 2))
    return np.stack([channels[at] for at in order], axis=-1).astype(np.uint8)


def decode_position(picture, map_type="satellite"):
    """Columns and rows, modulo `MODULUS`, that a picture's pixels hold."""
    order = _CHANNELS.get(map_type, (0, 1, 2))
    channels = {at: picture[..., index].astype(np.int64) for index, at in enumerate(order)}
    return channels[0] | (channels[2] & 15) << 8, channels[1] | channels[2] >> 4 << 8


def positions(map_type, zoom, x, y, size_px):
    """Paint a tile that holds global pixels."""
    steps = np.arange(size_px)
    return encode_position(x * size_px + steps, y * size_px + steps, map_type)


def encoded_positions(map_type, x, y, size_px, extension):
    """Encode a tile that holds global pixels; tiles repeat with the modulus."""
    return _encoded_positions(map_type, x % (MODULUS // size_px), y % (MODULUS // size_px), size_px, extension)


@cache
def _encoded_positions(map_type, x, y, size_px, extension):
    return to_bytes(positions(map_type, 0, x, y, size_px), extension)


def world(seed: int = 2024) -> Painter:
    """Painter of the embedded world."""
    from terrainav.core.imagery.opening import open_source
    from terrainav.core.imagery.source import Window

    source = open_source("world", seed=seed)

    def paint(map_type, zoom, x, y, size_px):
        if size_px != source.grid.tile_px:
            return None
        return source.fetch(map_type, Window(zoom, x * size_px, y * size_px, size_px, size_px))

    return paint


def folder(path: Path | str) -> Callable[[str, int, int, int, str], bytes | None]:
    """Reader of tiles made by another program: ``path/z/x/y.*``, or ``path/map_type/z/x/y.*``."""
    root = Path(path)

    def read(map_type, zoom, x, y, _extension):
        for top in (root / map_type, root):
            for found in sorted((top / str(zoom) / str(x)).glob(f"{y}.*")):
                if found.suffix.lower() in (".png", ".jpg", ".jpeg", ".webp"):
                    return found.read_bytes()
        return None

    return read


def to_bytes(picture, extension: str, **options) -> bytes:
    """Encode a picture (uint8 array or Pillow image) as png, jpg or webp; lossless where the format can."""
    image = picture if isinstance(picture, Image.Image) else Image.fromarray(picture)
    settings = {
        "png": {"compress_level": 1},
        "jpeg": {"quality": 95, "subsampling": 0},
        "webp": {"lossless": True},
    }
    kind = {"jpg": "jpeg", "jpeg": "jpeg", "webp": "webp"}.get(extension, "png")
    out = io.BytesIO()
    image.save(out, kind, **{**settings[kind], **options})
    return out.getvalue()


def content_type(body: bytes) -> str:
    """Media type of encoded bytes."""
    if body.startswith(b"\x89PNG"):
        return "image/png"
    return "image/webp" if body[8:12] == b"WEBP" else "image/jpeg"
