"""Pictures in files: GeoTIFF, JPEG, and PNG with world file and .aux.xml, whole or not at all."""

from __future__ import annotations

import io
import os
import zlib
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO, Union

import numpy as np
from numpy.typing import NDArray
from PIL import Image, PngImagePlugin

from ..errors import InvalidInput
from ..files import write_whole
from .georeference import ControlPoints, Georeference
from .metadata import SOFTWARE, Description, exif, xml_text, xmp
from .tiff import HEADER_BYTES, Kind, Tag, directory, header

Pixels = NDArray[np.uint8]
#: Only runs are searched for: on photographs that is four times as fast as zlib's default level and smaller too,
#: as the predictor has left little else to find; drawn maps are small either way.
_ZLIB_STRATEGY = zlib.Z_RLE
_ZLIB_LEVEL = 6
#: Bytes of pixels in a TIFF strip, so that readers of a large picture need not unpack all of it.
_STRIP_BYTES = 1 << 18
_WITH_ALPHA = 4
#: Where a picture lies: a map frame by its edges, a camera frame by points.
Place = Union[Georeference, ControlPoints]
_WORLD_FILES = {"jpg": ".jgw", "png": ".pgw"}
#: JPEG at this quality, without halving the colours' resolution, is within about a grey level of the source.
JPEG_QUALITY = 95
#: What every JPEG ends with (ITU-T T.81, B.1.1.3).
_END = b"\xff\xd9"
#: Where Pillow's first segment, JFIF's, begins: its marker, and a length that counts itself.
_JFIF, _MARKER_BYTES, _LENGTH_BYTES = b"\xff\xd8\xff\xe0", 2, 2
_APP1 = b"\xff\xe1"
_EXIF, _XMP = b"Exif\0\0", b"http://ns.adobe.com/xap/1.0/\0"
_LONGEST_SEGMENT = (1 << 16) - 1


def file_endings(image_format: str, *, on_map: bool = True) -> tuple[str, ...]:
    """Endings of all the files of one picture, of a map frame or of a camera frame; the last is the picture's own."""
    own = f".{image_format}"
    if image_format == "tif":
        return (own,)
    world_file = (_WORLD_FILES[image_format],) if on_map else ()
    return (*world_file, f"{own}.aux.xml", own)


def write_picture(
    folder: Path, image_format: str, pixels: Pixels, place: Place, description: Description
) -> int:
    """Write a picture and what belongs beside it, itself last: a picture that is there is complete.

    Parameters
    ----------
    folder : Path
        Where ``<name>.<ending>`` goes; must be there.
    image_format : str
        tif, jpg or png.
    pixels : array (h, w), (h, w, 3) or (h, w, 4) of uint8
        A fourth channel is 0 where the picture has nothing to show and 255 elsewhere; a JPEG leaves it out. The
        bytes written depend on the arguments alone.

    Returns
    -------
    int
        Bytes of all its files together.

    Raises
    ------
    OutputError
    """
    on_map = isinstance(place, Georeference)
    contents = [encoded(image_format, pixels, place, description)]
    if image_format != "tif":
        contents.insert(0, place.aux_xml(description.metadata()).encode("utf-8"))
        if isinstance(place, Georeference):
            contents.insert(0, place.world_file().encode("ascii"))
    for ending, data in zip(file_endings(image_format, on_map=on_map), contents):
        write_whole(folder / (description.name + ending), data)
    return sum(map(len, contents))


def encoded(image_format: str, pixels: Pixels, place: Place, description: Description) -> bytes:
    """Return the bytes of a picture's own file."""
    if image_format == "tif":
        return geotiff(pixels, place, description)
    return jpeg(pixels, description) if image_format == "jpg" else png(pixels, description)


def geotiff(pixels: Pixels, place: Place, description: Description) -> bytes:
    """A lossless GeoTIFF (OGC 19-008) with deflate and horizontal differences.

    Written here and not by Pillow, whose TIFF encoder holds Python's lock: zlib lets go of it, so that the
    pictures of one run are packed on all cores.
    """
    height, width = pixels.shape[:2]
    channels = 1 if pixels.ndim == 2 else pixels.shape[2]
    rows = max(_STRIP_BYTES // (width * channels), 1)
    strips = _packed_strips(pixels, rows)
    tags = [
        Tag(256, Kind.LONG, [width]),
        Tag(257, Kind.LONG, [height]),
        Tag(258, Kind.SHORT, [8] * channels),
        Tag(259, Kind.SHORT, [8]),  # compression: deflate
        Tag(262, Kind.SHORT, [1 if channels == 1 else 2]),  # black is zero; RGB
        Tag(270, Kind.ASCII, description.title),
        Tag(277, Kind.SHORT, [channels]),
        Tag(278, Kind.LONG, [rows]),
        Tag(279, Kind.LONG, [len(strip) for strip in strips]),
        Tag(284, Kind.SHORT, [1]),  # channels pixel by pixel
        Tag(305, Kind.ASCII, SOFTWARE),
        Tag(317, Kind.SHORT, [2]),  # horizontal differences
        Tag(33432, Kind.ASCII, description.attribution),
        *place.tags(),
        Tag(42112, Kind.ASCII, _gdal_metadata(description)),
    ]
    if channels == _WITH_ALPHA:
        tags.append(
            Tag(338, Kind.SHORT, [2])
        )  # the fourth channel is alpha, and the others are not multiplied by it
    return _with_strips(tags, strips)


def png(pixels: Pixels, description: Description) -> bytes:
    """A PNG with its title, software, copyright and the metadata as text chunks."""
    info = PngImagePlugin.PngInfo()
    texts = {"Title": description.title, "Software": SOFTWARE, "Copyright": description.attribution}
    for key, value in {**texts, **description.metadata()}.items():
        info.add_text(key, value)
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(
        buffer, "PNG", pnginfo=info, compress_level=_ZLIB_LEVEL, compress_type=_ZLIB_STRATEGY
    )
    return buffer.getvalue()


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


def _packed_strips(pixels: Pixels, rows: int) -> list[bytes]:
    """Strips one after the other, in one piece of memory that fits the processor's cache."""
    strips = []
    differences = np.empty((min(rows, len(pixels)), *pixels.shape[1:]), np.uint8)
    for top in range(0, len(pixels), rows):
        strip = pixels[top : top + rows]
        changes = differences[: len(strip)]
        changes[:, 0] = strip[:, 0]
        np.subtract(strip[:, 1:], strip[:, :-1], out=changes[:, 1:])
        pack = zlib.compressobj(
            _ZLIB_LEVEL, zlib.DEFLATED, zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL, _ZLIB_STRATEGY
        )
        strips.append(pack.compress(changes.data) + pack.flush())
    return strips


def _with_strips(tags: list[Tag], strips: list[bytes]) -> bytes:
    """File of a directory followed by its strips, whose offsets depend on the directory's own length."""

    def offsets_from(start: int) -> Tag:
        offsets = [start]
        for strip in strips[:-1]:
            offsets.append(offsets[-1] + len(strip))
        return Tag(273, Kind.LONG, offsets)

    length = len(directory([*tags, offsets_from(0)], HEADER_BYTES))
    return b"".join(
        [header(), directory([*tags, offsets_from(HEADER_BYTES + length)], HEADER_BYTES), *strips]
    )


def _gdal_metadata(description: Description) -> str:
    """XML of GDAL's own tag, whose values are escaped twice: GDAL writes them so, and undoes both."""
    items = (
        f'  <Item name="{xml_text(key)}">{xml_text(xml_text(value))}</Item>\n'
        for key, value in description.metadata().items()
    )
    return "<GDALMetadata>\n" + "".join(items) + "</GDALMetadata>\n"


def _segment(mark: bytes, data: bytes) -> bytes:
    length = _LENGTH_BYTES + len(mark) + len(data)
    if length > _LONGEST_SEGMENT:
        raise InvalidInput(
            "description of a picture in {0} bytes: a JPEG has room for {1}",
            len(data),
            _LONGEST_SEGMENT - len(mark),
            remedy="choose tif or png, or shorten the source's attribution",
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
