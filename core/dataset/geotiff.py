"""GeoTIFFs with bands other than 8-bit grey or colour, which captures write and Pillow cannot read unchanged."""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from html import unescape
from mmap import mmap
from typing import Any, NamedTuple

import numpy as np

from ..arrays import NDArray
from ..bands import BandMetadata, Bands, Range, colour_channels, percentiles, shown_in_8_bits, unnamed
from ..limits import MAX_BANDS, MAX_PICTURE_BYTES, MAX_PICTURE_SIDE_PX

_HEADER = b"II*\0"
#: Types of tags: bytes of a value, and the letter of `struct` if it is a number.
_TYPES = {1: (1, "B"), 2: (1, ""), 3: (2, "H"), 4: (4, "I"), 12: (8, "d")}
#: Tags of TIFF 6.0, GeoTIFF and GDAL.
_WIDTH, _HEIGHT, _BITS, _COMPRESSION, _PHOTOMETRIC = 256, 257, 258, 259, 262
_OFFSETS, _SAMPLES, _ROWS, _LENGTHS, _PLANES, _PREDICTOR = 273, 277, 278, 279, 284, 317
_EXTRA, _FORMAT, _PIXEL_SCALE, _METADATA, _NO_DATA = 338, 339, 33550, 42112, 42113
_TIE_POINTS, _TRANSFORMATION = 33922, 34264
#: Values of tags.
_DEFLATE, _RGB, _ALPHA, _FLOAT_PREDICTOR = 8, 2, 2, 3
_KINDS = {1: "u", 2: "i", 3: "f"}
#: Items of GDAL's metadata tag by name and band, from 0.
Items = Mapping[tuple[str, int], str]


class Strip(NamedTuple):
    """Position and length in bytes of a strip of compressed rows."""

    at: int
    length: int


@dataclass(frozen=True, eq=False)
class GeoTiff:
    """GeoTIFF with any bands; its tags have been read.

    Parameters
    ----------
    bands : Bands
    mask : str
        ``alpha`` for a mask in an additional channel, or the no-data value; empty without a mask.
    stated : mapping of int to (low, high)
        Values displayed darkest and brightest, by band.
    is_placed : bool
        Whether the file states the size of its pixels on the ground, as map frames do.
    """

    width: int
    height: int
    bands: Bands
    mask: str
    stated: Mapping[int, Range]
    is_placed: bool
    _strips: tuple[Strip, ...]
    _rows: int
    _channels: int
    _predictor: int
    _data: bytes

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in px."""
        return self.width, self.height

    @cached_property
    def _pixels(self) -> NDArray[Any]:
        dtype = self.bands.dtype
        pixels = np.empty((self.height, self.width, self._channels), dtype)
        if len(self._strips) * self._rows < self.height:
            raise ValueError("its pixels are damaged or cut off")
        for number, strip in enumerate(self._strips[: -(-self.height // self._rows)]):
            part = pixels[number * self._rows : (number + 1) * self._rows]
            packed = self._data[strip.at : strip.at + strip.length]
            found = zlib.decompressobj().decompress(packed, part.nbytes)
            if len(found) != part.nbytes:
                raise ValueError("its pixels are damaged or cut off")
            part[...] = _undo_predictor(np.frombuffer(found, np.uint8), part.shape, dtype, self._predictor)
        return pixels

    def values(self) -> NDArray[Any]:
        """Values (h, w, n) of the bands, without a mask; raises ValueError or zlib.error if damaged."""
        return self._pixels[..., : len(self.bands)]

    def seen(self) -> NDArray[np.bool_] | None:
        """Pixels (h, w) with data; None without a mask."""
        if self.mask == "alpha":
            return np.asarray(self._pixels[..., -1] != 0)
        if not self.mask:
            return None
        values = self._pixels
        no_data = np.isnan(values) if self.mask == "nan" else values == float(self.mask)
        # A pixel has no data only if all its bands have the no-data value.
        return np.asarray(~no_data.all(axis=-1))

    def shown(self) -> NDArray[np.uint8]:
        """Displayed image (h, w) or (h, w, 3), stretched between the values stated in the file, or else percentiles."""
        values = self.values()
        if self.bands.data_type == "uint8":
            return shown_in_8_bits(values, self.bands, ())
        ranges = [
            self.stated.get(band) or percentiles(values[..., band][np.isfinite(values[..., band])])
            for band in range(len(self.bands))
        ]
        return shown_in_8_bits(values, self.bands, ranges)


def parse_geotiff(data: bytes) -> GeoTiff | None:
    """Parse a GeoTIFF as captures write it; None for other files, and for 8-bit grey or colour.

    Raises
    ------
    ValueError
        The GeoTIFF is damaged.
    """
    if not data.startswith(_HEADER):
        return None
    try:
        tags = _read_tags(data)
        image = _make_image(tags, data)
    except (struct.error, IndexError, KeyError, TypeError):
        return None
    return image


def parse_affine(data: bytes | mmap) -> tuple[float, float, float, float, float, float] | None:
    """GDAL's six affine coefficients of a little-endian GeoTIFF, as captures write it; None if it has none."""
    try:
        tags = _read_tags(data)
        if _TRANSFORMATION in tags:
            of_x, of_y = tags[_TRANSFORMATION][:4], tags[_TRANSFORMATION][4:8]
            return (of_x[3], of_x[0], of_x[1], of_y[3], of_y[0], of_y[1])
        across, down = tags[_PIXEL_SCALE][:2]
        column, row, _, x, y = tags[_TIE_POINTS][:5]
    except (struct.error, IndexError, KeyError, ValueError):
        return None
    return (x - column * across, across, 0.0, y + row * down, 0.0, -down)


def _make_image(tags: Mapping[int, Any], data: bytes) -> GeoTiff | None:
    channels = tags.get(_SAMPLES, (1,))[0]
    bits, formats = set(tags[_BITS]), set(tags.get(_FORMAT, (1,)))
    is_supported = (
        tags.get(_COMPRESSION) == (_DEFLATE,)
        and tags.get(_PLANES, (1,)) == (1,)
        and len(bits) == len(formats) == 1
        and _OFFSETS in tags
    )
    if not is_supported:
        return None
    kind, size = _KINDS.get(min(formats), "c"), min(bits) // 8
    data_type = {"u1": "uint8", "u2": "uint16", "i2": "int16", "f4": "float32"}.get(f"{kind}{size}")
    has_alpha = _has_alpha(tags)
    count = channels - has_alpha
    if data_type is None or (data_type == "uint8" and count in (1, 3)):
        return None
    width, height = tags[_WIDTH][0], tags[_HEIGHT][0]
    is_too_large = max(width, height) > MAX_PICTURE_SIDE_PX or width * height * channels * size > MAX_PICTURE_BYTES
    if is_too_large or not 1 <= count <= MAX_BANDS or min(width, height) < 1:
        raise ValueError("it is larger than images are")
    items = _parse_band_items(str(tags.get(_METADATA, "")))
    return GeoTiff(
        width,
        height,
        _bands(tags, items, count, data_type),
        "alpha" if has_alpha else str(tags.get(_NO_DATA, "")),
        _display_ranges(items),
        not {_PIXEL_SCALE, _TRANSFORMATION}.isdisjoint(tags),
        tuple(Strip(*strip) for strip in zip(tags[_OFFSETS], tags[_LENGTHS])),
        max(tags.get(_ROWS, (height,))[0], 1),
        channels,
        tags.get(_PREDICTOR, (1,))[0],
        data,
    )


def parse_bands(data: bytes) -> Bands | None:
    """Bands stated by a GeoTIFF of a capture, including 8-bit grey or colour; None for other files."""
    if not data.startswith(_HEADER):
        return None
    try:
        tags = _read_tags(data)
        kind, bits = _KINDS.get(tags.get(_FORMAT, (1,))[0], "c"), tags[_BITS][0]
        count = tags.get(_SAMPLES, (1,))[0] - _has_alpha(tags)
        items = _parse_band_items(str(tags.get(_METADATA, "")))
        return _bands(tags, items, count, np.dtype(f"{kind}{bits // 8}").name)
    except (struct.error, IndexError, KeyError, TypeError, ValueError):
        return None


def parse_pam_bands(text: str, channels: int) -> Bands:
    """Bands stated by the PAM file of an image in 8-bit grey (1 channel) or colour (3), as captures write it."""
    items = {
        (element, int(number) - 1): unescape(value)
        for number, inside in _pam_lines(text)
        for element, value in re.findall(r"<(\w+)>([^<]*)</\1>", inside)
    }
    names = tuple(items.get(("Description", band), unnamed(band)) for band in range(channels))
    metadata = (_metadata(items, band, "Scale", "Offset", "UnitType") for band in range(channels))
    return Bands(names, "uint8", colour_channels(names), tuple(metadata))


def _pam_lines(text: str) -> Iterator[tuple[str, str]]:
    """Yield the number of each band, from 1, and its elements; takes time proportional to the text's length."""
    for line in text.split("\n"):
        begin, end = re.search(r'<PAMRasterBand band="(\d{1,4})">', line), line.rfind("</PAMRasterBand>")
        if begin is not None and end >= begin.end():
            yield begin[1], line[begin.end() : end]


def _has_alpha(tags: Mapping[int, Any]) -> bool:
    extra = tags.get(_EXTRA, ())
    return bool(extra) and extra[-1] == _ALPHA


def _bands(tags: Mapping[int, Any], items: Items, count: int, data_type: str) -> Bands:
    names = tuple(items.get(("DESCRIPTION", band), unnamed(band)) for band in range(count))
    if tags.get(_PHOTOMETRIC) == (_RGB,):
        shown: tuple[int, ...] = (0, 1, 2)
    else:
        stated = {items.get(("COLORINTERP", band)): band for band in range(count)}
        colours = tuple(stated.get(colour, -1) for colour in ("Red", "Green", "Blue"))
        shown = colours if min(colours) >= 0 else (0,)
    metadata = (_metadata(items, band, "SCALE", "OFFSET", "UNITTYPE") for band in range(count))
    return Bands(names, data_type, shown, tuple(metadata))


def _metadata(items: Items, band: int, scale: str, offset: str, unit: str) -> BandMetadata:
    return BandMetadata(
        float(items.get((scale, band), 1.0)), float(items.get((offset, band), 0.0)), items.get((unit, band), "")
    )


def _read_tags(data: bytes | mmap) -> dict[int, Any]:
    """Numbers or text of a file's first directory, by tag."""
    (at,) = struct.unpack_from("<I", data, 4)
    (count,) = struct.unpack_from("<H", data, at)
    tags: dict[int, Any] = {}
    for entry in range(count):
        place = at + 2 + entry * 12
        tag, kind, values = struct.unpack_from("<HHI", data, place)
        if kind not in _TYPES:
            continue
        size, letter = _TYPES[kind]
        start = place + 8
        if values * size > 4:
            (start,) = struct.unpack_from("<I", data, start)
        if start + values * size > len(data):
            raise IndexError(start)
        if letter:
            tags[tag] = struct.unpack_from(f"<{values}{letter}", data, start)
        else:
            tags[tag] = data[start : start + values].rstrip(b"\0").decode("utf-8", "replace")
    return tags


def _parse_band_items(text: str) -> Items:
    """Parse the items of GDAL's metadata tag, which are escaped twice."""
    found = re.findall(r'<Item name="([A-Z_]+)" sample="(\d{1,4})"[^<>]*>([^<]*)</Item>', text)
    return {(name, int(band)): unescape(unescape(value)) for name, band, value in found}


def _display_ranges(items: Items) -> dict[int, Range]:
    found = {}
    for (name, band), text in items.items():
        if name == "DISPLAY_RANGE":
            low, high = (float(one) for one in text.split())
            found[band] = low, high
    return found


def _undo_predictor(
    data: NDArray[np.uint8], shape: tuple[int, ...], dtype: np.dtype[Any], predictor: int
) -> NDArray[Any]:
    """Restore values (rows, width, channels) from the differences in decompressed bytes."""
    rows, width, channels = shape
    if predictor == _FLOAT_PREDICTOR:
        planes = data.reshape(rows, -1, channels).cumsum(axis=1, dtype=np.uint8)
        high_first = planes.reshape(rows, dtype.itemsize, width * channels).transpose(0, 2, 1)
        return np.ascontiguousarray(high_first).view(f">{dtype.kind}{dtype.itemsize}").reshape(shape)
    whole = data.view(f"<u{dtype.itemsize}").reshape(shape)
    if predictor == 1:
        return whole.view(dtype)
    return whole.cumsum(axis=1, dtype=whole.dtype).view(dtype)
