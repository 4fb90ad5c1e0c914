"""JPEG files with EXIF and XMP."""

from __future__ import annotations

import io
import os
from contextlib import suppress
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ..errors import InvalidInput
from .description import Description
from .exif import exif
from .xmp import xmp

#: JPEG at this quality, without halving the colours' resolution, is within about a grey level of the source.
JPEG_QUALITY = 95
#: What every JPEG ends with (ITU-T T.81, B.1.1.3).
_END = b"\xff\xd9"
#: Where Pillow's first segment, JFIF's, begins: its marker, and a length that counts itself.
_JFIF, _MARKER_BYTES, _LENGTH_BYTES = b"\xff\xd8\xff\xe0", 2, 2
_APP1 = b"\xff\xe1"
_EXIF, _XMP = b"Exif\0\0", b"http://ns.adobe.com/xap/1.0/\0"
_LONGEST_SEGMENT = (1 << 16) - 1


def jpeg(pixels: NDArray[np.uint8], description: Description) -> bytes:
    """A JPEG with EXIF, and with XMP where the exposure is known.

    Raises
    ------
    InvalidInput
        Texts that EXIF has no room for.
    """
    image = Image.fromarray(np.ascontiguousarray(pixels[..., :3]) if pixels.ndim > 2 else pixels)
    segments = [_segment(_EXIF, exif(description))]
    if description.exposure is not None:
        segments.append(_segment(_XMP, xmp(description, description.exposure)))
    data = _encoded(image)
    # Pillow writes XMP since its version 11; the order here is the one it gives to EXIF.
    start = len(_JFIF) - _MARKER_BYTES
    if data.startswith(_JFIF):
        start = len(_JFIF) + int.from_bytes(data[len(_JFIF) : len(_JFIF) + _LENGTH_BYTES], "big")
    view = memoryview(data)
    return b"".join([view[:start], *segments, view[start:]])


def _segment(mark: bytes, data: bytes) -> bytes:
    length = _LENGTH_BYTES + len(mark) + len(data)
    if length > _LONGEST_SEGMENT:
        raise InvalidInput(
            f"description of a picture in {len(data)} bytes: a JPEG has room for {_LONGEST_SEGMENT - len(mark)}; "
            "choose tif or png, or shorten the source's attribution"
        )
    return b"".join([_APP1, length.to_bytes(_LENGTH_BYTES, "big"), mark, data])


def _encoded(image: Image.Image) -> bytes:
    with suppress(OSError):
        data = _saved(image, _encoders_file())
        # Pillow does not look whether all that it writes is taken: a file that may not grow is cut short.
        if data.endswith(_END):
            return data
    return _saved(image, io.BytesIO())


def _saved(image: Image.Image, file: BinaryIO) -> bytes:
    with file:
        image.save(file, "JPEG", quality=JPEG_QUALITY, subsampling=0)
        file.seek(0)
        return file.read()


def _encoders_file() -> BinaryIO:
    """A file in memory, one of the operating system's where it has such.

    Pillow lets go of Python's lock only while it encodes into a file that the operating system knows.
    """
    if hasattr(os, "memfd_create"):
        return os.fdopen(os.memfd_create("terrainav"), "w+b")
    return io.BytesIO()
