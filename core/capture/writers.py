"""Write image files: GeoTIFF, and JPEG or PNG with world file and .aux.xml."""

from __future__ import annotations

import io
import os
import zlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO, Union

import numpy as np
from PIL import Image, PngImagePlugin

from ..arrays import NDArray, PixelValues
from ..bands import Bands, Range, unnamed
from ..errors import InvalidInput
from ..storage.files import write_whole
from .georeference import ControlPoints, Georeference
from .metadata import SOFTWARE, Description, exif, xml_text, xmp
from .tiff import HEADER_BYTES, Tag, TagType, directory, header

#: Searching for runs only is four times as fast on photographs as zlib's default, with smaller files, as the predictor
#: leaves little else to find. Drawn maps are small with either strategy.
_ZLIB_STRATEGY, _ZLIB_LEVEL = zlib.Z_RLE, 6
#: No-data value in place of a mask, for types without one: GDAL supports alpha for unsigned integers only.
_NO_DATA: dict[str, float] = {"int16": -32768, **dict.fromkeys(("float32", "float64"), float("nan"))}
#: Item of a GeoTIFF's metadata: the values of a band that are displayed darkest and brightest.
DISPLAY_RANGE = "DISPLAY_RANGE"
#: Georeference of a map frame, or control points of a camera frame.
Place = Union[Georeference, ControlPoints]
#: Writes a file atomically.
Write = Callable[[Path, bytes], object]
#: With full colour resolution, a JPEG of this quality is within about a grey level of the source.
JPEG_QUALITY = 95


def file_endings(image_format: str, *, on_map: bool = True) -> tuple[str, ...]:
    """Endings of all files of an image; the image itself is last."""
    ending = f".{image_format}"
    if image_format == "tif":
        return (ending,)
    world_file = ({"jpg": ".jgw", "png": ".pgw"}[image_format],) if on_map else ()
    return (*world_file, f"{ending}.aux.xml", ending)


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
    """Write an image after its sidecar files, so that an existing image is complete.

    Parameters
    ----------
    folder : Path
        Existing folder for ``<name>.<ending>``.
    image_format : str
        tif, jpg or png.
    pixels : array (h, w), (h, w, 3) or (h, w, 4) of uint8
        A fourth channel is 0 for pixels without data and 255 for others; a JPEG omits it. With ``bands``, an array
        (h, w, n) of their data type, or (h, w, n + 1) with a mask as last channel. The bytes written depend only on the
        arguments.
    bands : Bands or None
        None for grey or RGB.
    ranges : sequence of (low, high)
        Values displayed darkest and brightest, for each band.
    write : callable
        Writes a file.

    Returns
    -------
    int
        Bytes of all files together.

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


def label_format(image_format: str, values: np.dtype[Any]) -> str:
    """Format of label files: that of images if it is lossless and holds the type of the values, else PNG or TIFF."""
    return "tif" if image_format == "tif" or values.itemsize > 2 else "png"


def write_labels(
    folder: Path,
    image_format: str,
    labels: NDArray[Any],
    place: Place,
    description: Description,
    colours: NDArray[np.uint8] | None = None,
    write: Write = write_whole,
) -> None:
    """Write an image of labels (h, w), of uint8, uint16 or uint32, after its sidecar files.

    Parameters
    ----------
    image_format : str
        From `label_format`.
    colours : array (256, 3) or None
        Colour table of labels of 8 bits; None for grey.

    Raises
    ------
    OutputError
    """
    is_tif = image_format == "tif"
    if is_tif:
        contents = [_label_tiff(labels, place, description, colours)]
    else:
        contents = [png(labels, description, colours)]
        contents.insert(0, place.aux_xml(description.metadata()).encode("utf-8"))
        if isinstance(place, Georeference):
            contents.insert(0, place.world_file().encode("ascii"))
    for ending, data in zip(file_endings(image_format, on_map=isinstance(place, Georeference)), contents):
        write(folder / (description.name + ending), data)


def _label_tiff(
    labels: NDArray[Any], place: Place, description: Description, colours: NDArray[np.uint8] | None
) -> bytes:
    tags = [Tag(42112, TagType.ASCII, gdal_metadata(_description_items(description)))]
    if colours is None:
        tags.append(Tag(262, TagType.SHORT, [1]))  # black is zero
    else:
        tags.append(Tag(262, TagType.SHORT, [3]))  # colour table: all red values, then green and blue, of 16 bits
        tags.append(Tag(320, TagType.SHORT, (colours.T.astype(np.int64) * 257).ravel().tolist()))
    return _pixel_file(labels, place, description, tags)


def encoded(
    image_format: str,
    pixels: PixelValues,
    place: Place,
    description: Description,
    bands: Bands | None = None,
    ranges: Sequence[Range] = (),
) -> bytes:
    """Return the bytes of the image file; parameters as for `write_picture`."""
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
    """Return a lossless GeoTIFF (OGC 19-008) with deflate and horizontal differences.

    Images are compressed with zlib, which releases Python's lock so that all cores are used; Pillow's TIFF encoder does
    not.
    """
    if bands is not None:
        return _geotiff_of_bands(pixels, place, description, bands, ranges)
    channels = 1 if pixels.ndim == 2 else pixels.shape[2]
    tags = [
        Tag(262, TagType.SHORT, [1 if channels == 1 else 2]),  # black is zero; RGB
        Tag(42112, TagType.ASCII, gdal_metadata(_description_items(description))),
    ]
    if channels == 4:
        tags.append(Tag(338, TagType.SHORT, [2]))  # unassociated alpha: colours are not multiplied by it
    return _pixel_file(pixels, place, description, tags)


def _geotiff_of_bands(
    pixels: PixelValues, place: Place, description: Description, bands: Bands, ranges: Sequence[Range]
) -> bytes:
    count = len(bands)
    is_masked = pixels.shape[2] > count
    are_shown_first = bands.shown == (0, 1, 2)
    extra = [0] * (count - (3 if are_shown_first else 1))
    items = band_items(bands, ranges, has_alpha=is_masked and bands.data_type not in _NO_DATA)
    tags = [
        Tag(262, TagType.SHORT, [2 if are_shown_first else 1]),  # RGB; black is zero
        Tag(42112, TagType.ASCII, gdal_metadata(_description_items(description) + items)),
    ]
    nodata = bands.nodata
    if nodata is not None:
        pixels = _avoid_nodata(bands.dtype.type(nodata), pixels, count)
    elif is_masked:
        nodata = _NO_DATA.get(bands.data_type)
    if nodata is not None:
        tags.append(Tag(42113, TagType.ASCII, repr(nodata)))
    if is_masked and nodata is not None:
        has_data = pixels[..., count:] != 0
        values = np.where(has_data, pixels[..., :count], bands.dtype.type(nodata))
        pixels = np.concatenate([values, pixels[..., count:]], axis=2)
    if is_masked and bands.data_type in _NO_DATA:
        pixels = pixels[..., :count]
    elif is_masked:
        extra.append(2)
    if extra:
        tags.append(Tag(338, TagType.SHORT, extra))
    if bands.dtype.kind != "u":
        sample_format = {"i": 2, "f": 3}[bands.dtype.kind]
        tags.append(Tag(339, TagType.SHORT, [sample_format] * pixels.shape[2]))
    return _pixel_file(pixels, place, description, tags)


def _avoid_nodata(nodata: Any, pixels: PixelValues, count: int) -> PixelValues:
    """Change pixels that have the no-data value in all bands, which resampling may produce.

    The first band gets the adjacent value, as in gdalwarp.
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


def _pixel_file(pixels: PixelValues, place: Place, description: Description, more: list[Tag]) -> bytes:
    """Return a TIFF file of pixels, with common and additional tags."""
    height, width = pixels.shape[:2]
    channels = 1 if pixels.ndim == 2 else pixels.shape[2]
    # Strips of 256 kB, so that readers need not decompress a large image as a whole.
    rows = max((1 << 18) // (width * channels * pixels.itemsize), 1)
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
        Tag(317, TagType.SHORT, [3 if is_float else 2]),  # predictor: of floating point, horizontal
        Tag(33432, TagType.ASCII, description.attribution),
        *place.tags(),
        *more,
    ]
    return _strip_file(tags, strips)


def _as_bytes(pixels: PixelValues) -> NDArray[np.uint8]:
    """Rearrange floats (h, w, n) as bytes (h, itemsize * w, n), in each row the highest bytes first (Predictor 3)."""
    height, width, channels = pixels.shape
    high_first = (
        np.ascontiguousarray(pixels, f">f{pixels.itemsize}").view(np.uint8).reshape(height, width * channels, -1)
    )
    return np.ascontiguousarray(high_first.transpose(0, 2, 1)).reshape(height, -1, channels)


def band_items(bands: Bands, ranges: Sequence[Range] = (), *, has_alpha: bool = False) -> str:
    """Items of GDAL's metadata tag for bands: names, units, scales, displayed ranges, and colours."""
    lines = []

    def add(band: int, name: str, text: str, role: str = "", domain: str = "") -> None:
        more = "".join(f' {key}="{value}"' for key, value in (("role", role), ("domain", domain)) if value)
        lines.append(f'  <Item name="{xml_text(name)}" sample="{band}"{more}>{xml_text(xml_text(text))}</Item>\n')

    for band, (name, about) in enumerate(zip(bands.names, bands.each_metadata)):
        if about.is_scaled:
            add(band, "OFFSET", repr(about.offset), "offset")
            add(band, "SCALE", repr(about.scale), "scale")
        if about.unit:
            add(band, "UNITTYPE", about.unit, "unittype")
        for domain, key, text in about.items:
            add(band, key, text, domain=domain)
        if name != unnamed(band):
            add(band, "DESCRIPTION", name, "description")
        if bands.data_type != "uint8":
            add(band, DISPLAY_RANGE, " ".join(map(repr, ranges[band])))
    for band, colour in _interpretations(bands, has_alpha=has_alpha).items():
        add(band, "COLORINTERP", colour, "colorinterp")
    return "".join(lines)


def _interpretations(bands: Bands, *, has_alpha: bool) -> dict[int, str]:
    """Colour interpretations by channel, where TIFF tags cannot express them."""
    found = {
        band: about.colour for band, about in enumerate(bands.each_metadata) if about.colour and band not in bands.shown
    }
    if len(bands.shown) == 3 and bands.shown != (0, 1, 2):
        found = {**dict.fromkeys(range(len(bands)), "Undefined"), **found}
        found.update(zip(bands.shown, ("Red", "Green", "Blue")))
        if has_alpha:
            found[len(bands)] = "Alpha"
    return found


def png(pixels: PixelValues, description: Description, colours: NDArray[np.uint8] | None = None) -> bytes:
    """Return a PNG with title, software, copyright and metadata as text chunks; ``colours`` (256, 3) are a palette."""
    info = PngImagePlugin.PngInfo()
    texts = {"Title": description.title, "Software": SOFTWARE, "Copyright": description.attribution}
    for key, value in {**texts, **description.metadata()}.items():
        info.add_text(key, value)
    buffer = io.BytesIO()
    image = Image.fromarray(pixels)
    if colours is not None:
        image.putpalette(colours.tobytes())
    image.save(buffer, "PNG", pnginfo=info, compress_level=_ZLIB_LEVEL, compress_type=_ZLIB_STRATEGY)
    return buffer.getvalue()


def jpeg(pixels: NDArray[np.uint8], description: Description) -> bytes:
    """Return a JPEG with EXIF and, if the exposure is known, XMP.

    Raises
    ------
    InvalidInput
        Texts are too long for EXIF.
    """
    image = Image.fromarray(np.ascontiguousarray(pixels[..., :3]) if pixels.ndim > 2 else pixels)
    segments = [_segment(b"Exif\0\0", exif(description))]
    if description.exposure is not None:
        segments.append(_segment(b"http://ns.adobe.com/xap/1.0/\0", xmp(description, description.exposure)))
    data = _encoded(image)
    # Pillow writes XMP only since version 11. Insert EXIF and XMP after JFIF: a marker of 2 bytes, then a length that
    # counts itself.
    start = 2
    if data.startswith(b"\xff\xd8\xff\xe0"):
        start = 4 + int.from_bytes(data[4:6], "big")
    view = memoryview(data)
    return b"".join([view[:start], *segments, view[start:]])


def _packed_strips(pixels: PixelValues, rows: int) -> list[bytes]:
    """Compress strips of horizontal differences, one by one in a buffer that fits in the processor's cache."""
    strips = []
    # As little-endian unsigned integers, whose differences wrap around.
    pixels = pixels.astype(f"<{pixels.dtype.kind}{pixels.itemsize}", copy=False).view(f"<u{pixels.itemsize}")
    differences = np.empty((min(rows, len(pixels)), *pixels.shape[1:]), pixels.dtype)
    for top in range(0, len(pixels), rows):
        strip = pixels[top : top + rows]
        changes = differences[: len(strip)]
        changes[:, 0] = strip[:, 0]
        np.subtract(strip[:, 1:], strip[:, :-1], out=changes[:, 1:])
        pack = zlib.compressobj(_ZLIB_LEVEL, zlib.DEFLATED, zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL, _ZLIB_STRATEGY)
        strips.append(pack.compress(changes.data) + pack.flush())
    return strips


def _strip_file(tags: list[Tag], strips: list[bytes]) -> bytes:
    """Return a TIFF file of a directory and strips; the strips' offsets depend on the directory's length."""

    def strip_offsets(start: int) -> Tag:
        offsets = [start]
        for strip in strips[:-1]:
            offsets.append(offsets[-1] + len(strip))
        return Tag(273, TagType.LONG, offsets)

    length = len(directory([*tags, strip_offsets(0)], HEADER_BYTES))
    return b"".join([header(), directory([*tags, strip_offsets(HEADER_BYTES + length)], HEADER_BYTES), *strips])


def _description_items(description: Description) -> str:
    return "".join(
        f'  <Item name="{xml_text(key)}">{xml_text(xml_text(value))}</Item>\n'
        for key, value in description.metadata().items()
    )


def gdal_metadata(items: str) -> str:
    """XML of GDAL's metadata tag; its values are escaped twice, as GDAL writes and reads them."""
    return f"<GDALMetadata>\n{items}</GDALMetadata>\n"


def _segment(mark: bytes, data: bytes) -> bytes:
    length, longest = 2 + len(mark) + len(data), (1 << 16) - 1
    if length > longest:
        raise InvalidInput(
            "description of an image in {0} bytes: a JPEG has room for {1}",
            len(data),
            longest - len(mark),
            remedy="choose tif or png, or shorten the source's attribution",
        )
    return b"".join([b"\xff\xe1", length.to_bytes(2, "big"), mark, data])  # APP1


def _encoded(image: Image.Image) -> bytes:
    with suppress(OSError):
        data = _saved(image, _encoders_file())
        # Pillow does not check that all bytes are written; a whole JPEG ends with a marker (ITU-T T.81, B.1.1.3).
        if data.endswith(b"\xff\xd9"):
            return data
    return _saved(image, io.BytesIO())


def _saved(image: Image.Image, file: BinaryIO) -> bytes:
    with file:
        image.save(file, "JPEG", quality=JPEG_QUALITY, subsampling=0)
        file.seek(0)
        return file.read()


def _encoders_file() -> BinaryIO:
    """File in memory; the operating system's if possible, with which Pillow releases Python's lock."""
    if hasattr(os, "memfd_create"):
        return os.fdopen(os.memfd_create("terrainav"), "w+b")
    return io.BytesIO()
