"""Pictures in files: GeoTIFF, JPEG, and PNG with world file and .aux.xml, whole or not at all."""

from __future__ import annotations

import io
import os
import zlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO, Union

import numpy as np
from numpy.typing import NDArray
from PIL import Image, PngImagePlugin

from ..arrays import PixelValues
from ..bands import Bands, Range, unnamed
from ..errors import InvalidInput
from ..storage.files import write_whole
from .georeference import ControlPoints, Georeference
from .metadata import SOFTWARE, Description, exif, xml_text, xmp
from .tiff import HEADER_BYTES, Tag, TagType, directory, header

#: Only runs are searched for: on photographs that is four times as fast as zlib's default level and smaller too,
#: as the predictor has left little else to find; drawn maps are small either way.
_ZLIB_STRATEGY = zlib.Z_RLE
_ZLIB_LEVEL = 6
#: Bytes of pixels in a TIFF strip, so that readers of a large picture need not unpack all of it.
_STRIP_BYTES = 1 << 18
_COLOURS, _WITH_ALPHA = 3, 4
#: Types of values (SampleFormat) by numpy's kinds; what is packed (Predictor): differences, and those of floats' bytes.
_SAMPLE_FORMATS, _DIFFERENCES, _OF_FLOATS = {"u": 1, "i": 2, "f": 3}, 2, 3
#: Types whose mask is a value that they hardly ever have: GDAL knows alpha of whole numbers without sign alone.
_NO_DATA: dict[str, float] = {"int16": -32768, **dict.fromkeys(("float32", "float64"), float("nan"))}
#: Where a GeoTIFF says which values of a band are shown darkest and brightest.
DISPLAY_RANGE = "DISPLAY_RANGE"
#: Where a picture lies: a map frame by its edges, a camera frame by points.
Place = Union[Georeference, ControlPoints]
#: What takes a file, whole or not at all.
Write = Callable[[Path, bytes], object]
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
    folder: Path,
    image_format: str,
    pixels: PixelValues,
    place: Place,
    description: Description,
    bands: Bands | None = None,
    ranges: Sequence[Range] = (),
    write: Write = write_whole,
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
        bytes written depend on the arguments alone. With ``bands``, array (h, w, n) or (h, w, n + 1) of their type, the
        last channel the mask.
    bands : Bands or None
        None for grey, or red, green and blue.
    ranges : sequence of (low, high)
        Values of each band that are shown darkest and brightest.
    write : callable
        What takes each file.

    Returns
    -------
    int
        Bytes of all its files together.

    Raises
    ------
    OutputError
    """
    on_map = isinstance(place, Georeference)
    contents = [encoded(image_format, pixels, place, description, bands, ranges)]
    if image_format != "tif":
        contents.insert(0, place.aux_xml(description.metadata(), bands).encode("utf-8"))
        if isinstance(place, Georeference):
            contents.insert(0, place.world_file().encode("ascii"))
    for ending, data in zip(file_endings(image_format, on_map=on_map), contents):
        write(folder / (description.name + ending), data)
    return sum(map(len, contents))


def encoded(
    image_format: str,
    pixels: PixelValues,
    place: Place,
    description: Description,
    bands: Bands | None = None,
    ranges: Sequence[Range] = (),
) -> bytes:
    """Return the bytes of a picture's own file; parameters as of `write_picture`."""
    if image_format == "tif":
        return geotiff(pixels, place, description, bands, ranges)
    if pixels.shape[2:] == (1,):
        pixels = pixels[..., 0]
    return jpeg(pixels, description) if image_format == "jpg" else png(pixels, description)


def geotiff(
    pixels: PixelValues,
    place: Place,
    description: Description,
    bands: Bands | None = None,
    ranges: Sequence[Range] = (),
) -> bytes:
    """A lossless GeoTIFF (OGC 19-008) with deflate and horizontal differences.

    Written here and not by Pillow, whose TIFF encoder holds Python's lock: zlib lets go of it, so that the
    pictures of one run are packed on all cores.
    """
    if bands is not None:
        return _geotiff_of_bands(pixels, place, description, bands, ranges)
    channels = 1 if pixels.ndim == 2 else pixels.shape[2]
    tags = [
        Tag(262, TagType.SHORT, [1 if channels == 1 else 2]),  # black is zero; RGB
        Tag(42112, TagType.ASCII, gdal_metadata(_description_items(description))),
    ]
    if channels == _WITH_ALPHA:
        tags.append(
            Tag(338, TagType.SHORT, [2])
        )  # the fourth channel is alpha, and the others are not multiplied by it
    return _with_pixels(pixels, place, description, tags)


def _geotiff_of_bands(
    pixels: PixelValues, place: Place, description: Description, bands: Bands, ranges: Sequence[Range]
) -> bytes:
    count = len(bands)
    is_masked = pixels.shape[2] > count
    are_shown_first = bands.shown == (0, 1, 2)
    extra = [0] * (count - (_COLOURS if are_shown_first else 1))
    items = band_items(bands, ranges, has_alpha=is_masked and bands.data_type not in _NO_DATA)
    tags = [
        Tag(262, TagType.SHORT, [2 if are_shown_first else 1]),  # RGB; black is zero
        Tag(42112, TagType.ASCII, gdal_metadata(_description_items(description) + items)),
    ]
    nodata = bands.nodata
    if nodata is not None:
        pixels = _without(bands.dtype.type(nodata), pixels, count)
    elif is_masked:
        nodata = _NO_DATA.get(bands.data_type)
    if nodata is not None:
        tags.append(Tag(42113, TagType.ASCII, repr(nodata)))
    if is_masked and nodata is not None:
        there = pixels[..., count:] != 0
        values = np.where(there, pixels[..., :count], bands.dtype.type(nodata))
        pixels = np.concatenate([values, pixels[..., count:]], axis=2)
    if is_masked and bands.data_type in _NO_DATA:
        pixels = pixels[..., :count]
    elif is_masked:
        extra.append(2)
    if extra:
        tags.append(Tag(338, TagType.SHORT, extra))
    if bands.dtype.kind != "u":
        tags.append(Tag(339, TagType.SHORT, [_SAMPLE_FORMATS[bands.dtype.kind]] * pixels.shape[2]))
    return _with_pixels(pixels, place, description, tags)


def _without(nodata: Any, pixels: PixelValues, count: int) -> PixelValues:
    """Pixels of which none has the value for no data in all of so many bands, as a mean of others may.

    The first band's value becomes the next one to it, as gdalwarp does.
    """
    alike = (pixels[..., :count] == nodata).all(axis=-1)
    if not alike.any():
        return pixels
    dtype = pixels.dtype
    if dtype.kind == "f":
        other = np.nextafter(nodata, dtype.type(0.0 if nodata else 1.0))
    else:
        other = dtype.type(int(nodata) + (1 if nodata < np.iinfo(dtype).max else -1))
    pixels = pixels.copy()
    pixels[alike, 0] = other
    return pixels


def _with_pixels(pixels: PixelValues, place: Place, description: Description, more: list[Tag]) -> bytes:
    """File of pixels, with the tags that every picture has and some more."""
    height, width = pixels.shape[:2]
    channels = 1 if pixels.ndim == 2 else pixels.shape[2]
    rows = max(_STRIP_BYTES // (width * channels * pixels.itemsize), 1)
    is_float = pixels.dtype.kind == "f"
    strips = _packed_strips(_as_bytes(pixels) if is_float else pixels, rows)
    tags = [
        Tag(256, TagType.LONG, [width]),
        Tag(257, TagType.LONG, [height]),
        Tag(258, TagType.SHORT, [8 * pixels.itemsize] * channels),
        Tag(259, TagType.SHORT, [8]),  # compression: deflate
        Tag(270, TagType.ASCII, description.title),
        Tag(277, TagType.SHORT, [channels]),
        Tag(278, TagType.LONG, [rows]),
        Tag(279, TagType.LONG, [len(strip) for strip in strips]),
        Tag(284, TagType.SHORT, [1]),  # channels pixel by pixel
        Tag(305, TagType.ASCII, SOFTWARE),
        Tag(317, TagType.SHORT, [_OF_FLOATS if is_float else _DIFFERENCES]),
        Tag(33432, TagType.ASCII, description.attribution),
        *place.tags(),
        *more,
    ]
    return _with_strips(tags, strips)


def _as_bytes(pixels: PixelValues) -> NDArray[np.uint8]:
    """Floats (h, w, n) as bytes (h, 4 w, n), of 8 bytes (h, 8 w, n): of each row the highest first (Predictor 3)."""
    height, width, channels = pixels.shape
    high_first = (
        np.ascontiguousarray(pixels, f">f{pixels.itemsize}")
        .view(np.uint8)
        .reshape(height, width * channels, -1)
    )
    return np.ascontiguousarray(high_first.transpose(0, 2, 1)).reshape(height, -1, channels)


def band_items(bands: Bands, ranges: Sequence[Range] = (), *, has_alpha: bool = False) -> str:
    """What GDAL's tag says of bands: names, what values mean and are shown by, and colours that do not come first."""
    lines = []

    def say(band: int, name: str, text: str, role: str = "", domain: str = "") -> None:
        more = "".join(f' {key}="{value}"' for key, value in (("role", role), ("domain", domain)) if value)
        lines.append(
            f'  <Item name="{xml_text(name)}" sample="{band}"{more}>{xml_text(xml_text(text))}</Item>\n'
        )

    for band, (name, about) in enumerate(zip(bands.names, bands.each_metadata)):
        if about.is_scaled:
            say(band, "OFFSET", repr(about.offset), "offset")
            say(band, "SCALE", repr(about.scale), "scale")
        if about.unit:
            say(band, "UNITTYPE", about.unit, "unittype")
        for domain, key, text in about.items:
            say(band, key, text, domain=domain)
        if name != unnamed(band):
            say(band, "DESCRIPTION", name, "description")
        if bands.data_type != "uint8":
            say(band, DISPLAY_RANGE, " ".join(map(repr, ranges[band])))
    for band, colour in _interpretations(bands, has_alpha=has_alpha).items():
        say(band, "COLORINTERP", colour, "colorinterp")
    return "".join(lines)


def _interpretations(bands: Bands, *, has_alpha: bool) -> dict[int, str]:
    """Colour interpretations of channels that TIFF's own tags do not tell, by the channel."""
    found = {
        band: about.colour
        for band, about in enumerate(bands.each_metadata)
        if about.colour and band not in bands.shown
    }
    if len(bands.shown) == _COLOURS and bands.shown != (0, 1, 2):
        found = {**dict.fromkeys(range(len(bands)), "Undefined"), **found}
        found.update(zip(bands.shown, ("Red", "Green", "Blue")))
        if has_alpha:
            found[len(bands)] = "Alpha"
    return found


def png(pixels: PixelValues, description: Description) -> bytes:
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


def _packed_strips(pixels: PixelValues, rows: int) -> list[bytes]:
    """Strips one after the other, in one piece of memory that fits the processor's cache."""
    strips = []
    # As little-endian whole numbers without sign, whose differences wrap around.
    pixels = pixels.astype(f"<{pixels.dtype.kind}{pixels.itemsize}", copy=False).view(f"<u{pixels.itemsize}")
    differences = np.empty((min(rows, len(pixels)), *pixels.shape[1:]), pixels.dtype)
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
        return Tag(273, TagType.LONG, offsets)

    length = len(directory([*tags, offsets_from(0)], HEADER_BYTES))
    return b"".join(
        [header(), directory([*tags, offsets_from(HEADER_BYTES + length)], HEADER_BYTES), *strips]
    )


def _description_items(description: Description) -> str:
    return "".join(
        f'  <Item name="{xml_text(key)}">{xml_text(xml_text(value))}</Item>\n'
        for key, value in description.metadata().items()
    )


def gdal_metadata(items: str) -> str:
    """XML of GDAL's own tag, whose values are escaped twice: GDAL writes them so, and undoes both."""
    return f"<GDALMetadata>\n{items}</GDALMetadata>\n"


def _segment(mark: bytes, data: bytes) -> bytes:
    length = _LENGTH_BYTES + len(mark) + len(data)
    if length > _LONGEST_SEGMENT:
        raise InvalidInput(
            "description of an image in {0} bytes: a JPEG has room for {1}",
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
