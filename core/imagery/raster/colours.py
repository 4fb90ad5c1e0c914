"""Choice of the bands of a picture, and the mask of its pixels with imagery."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ...arrays import Bytes, NDArray
from ...bands import DATA_TYPES, RGB, BandMetadata, Bands, chosen, colour_channels, unnamed
from ...errors import InvalidInput, Message, OptionName
from ...limits import MAX_BANDS
from ...text.plain import printable
from ..source import composite_on_white
from .reading import Band, Facts, OpenRaster, PixelBox, Values

#: Colour interpretations other than red, green, blue and grey.
_OTHER_COLOURS = frozenset(
    "hue saturation lightness cyan magenta yellow black ycbcr_y ycbcr_cb ycbcr_cr y cb cr".split()
)
#: Colour interpretations that do not name a band.
_NAMELESS = frozenset(["", "undefined", "palette", "gray"])
#: Most characters of a band's name and of its metadata's values, and most items of metadata.
_NAME_CHARACTERS, _VALUE_CHARACTERS, _MOST_ITEMS = 100, 1000, 100


@dataclass(frozen=True)
class Colours:
    """Conversion of a raster's values to the pixels of a source.

    Parameters
    ----------
    bands : tuple of int
        Bands to read, from 1: one for each channel, or a single band for all channels (greys, a palette).
    nodata : tuple of (float or None)
        Nodata value of each band. A pixel has no data only if all bands have none, as 0 is a valid red of water.
    kind : Bands
        Bands of the result.
    alpha : int or None
        The band declared as alpha; a fourth band is not alpha unless declared.
    mask : int or None
        The band whose mask applies.
    table : array (256 or more, 4) of uint8 or None
        Red, green, blue and alpha of each value; None if values are colours.
    white : int or None
        Value of black in the first band if 0 is white; None if 0 is black.
    over_white : bool
        Whether to lay translucent colours over white; otherwise pixels are kept as stored.
    stored_type : str
        Data type for reading; empty for the data type of ``kind``.
    """

    bands: tuple[int, ...]
    nodata: tuple[float | None, ...]
    kind: Bands = RGB
    alpha: int | None = None
    mask: int | None = None
    table: Bytes | None = field(default=None, compare=False)
    white: int | None = None
    over_white: bool = False
    stored_type: str = ""

    @property
    def are_stored(self) -> bool:
        """Whether all pixels are imagery, with the values that the file stores."""
        is_whole = None in self.nodata and self.alpha is None and self.mask is None
        return is_whole and self.table is None and self.white is None and self.kind.dtype.kind != "f"

    def read_stored(self, file: OpenRaster, box: PixelBox) -> Values:
        """Read a box, (height, width, bands), if `are_stored`."""
        values = file.read(self.bands, box, self.stored_type or self.kind.data_type)
        pixels = np.empty((box.height, box.width, len(self.kind)), values.dtype)
        for channel in range(len(self.kind)):
            pixels[..., channel] = values[channel % len(values)]
        return pixels

    def read(self, file: OpenRaster, box: PixelBox) -> Values:
        """Read a box, (height, width, bands + 1); the last channel is 1 for imagery, and other pixels are 0.

        Pixels whose alpha is not 0 are imagery.
        """
        wanted = self.bands if self.alpha is None else (*self.bands, self.alpha)
        values = file.read(wanted, box, self.stored_type or self.kind.data_type)
        pixels = values[: len(self.bands)]
        has_imagery = ~self._is_nodata(pixels)
        if pixels.dtype.kind == "f":
            has_imagery &= np.isfinite(pixels).all(axis=0)
        alpha = None if self.alpha is None else values[-1]
        if self.table is not None:
            looked_up = self.table[pixels[0]]
            pixels, alpha = np.moveaxis(looked_up[..., :3], 2, 0), looked_up[..., 3]
        elif self.white is not None:
            pixels = np.stack([self._inverted(at, values) for at, values in zip(self.bands, pixels)])
        if self.mask is not None:
            has_imagery &= file.read_mask(self.mask, box) != 0
        count = len(self.kind)
        over = alpha if self.over_white else None
        colours = np.empty((box.height, box.width, count + 1), pixels.dtype)
        for channel in range(count):
            band = pixels[channel % len(pixels)]
            colours[..., channel] = band if over is None else composite_on_white(band, over)
        if alpha is not None:
            has_imagery &= alpha != 0
        colours[..., count] = has_imagery
        if not has_imagery.all():
            colours[~has_imagery] = 0
        return colours

    def _inverted(self, band: int, values: Values) -> Values:
        """Values of a band with 0 as black; only the first band may have 0 as white."""
        if band != 1 or self.white is None:
            return values
        inverted: Values = values.dtype.type(self.white) - np.minimum(values, self.white)
        return inverted

    def _is_nodata(self, values: Values) -> NDArray[np.bool_]:
        absent = np.full(values.shape[1:], None not in self.nodata)
        if None not in self.nodata:
            for band, nodata in zip(values, self.nodata):
                absent &= band == nodata
        return absent


def choose_colours(
    facts: Facts,
    wanted: Sequence[str] = (),
    *,
    as_stored: bool = False,
    stretched: bool = False,
    title: str = "",
) -> Colours:
    """Choose the bands of the picture.

    By default these are, as stored, all bands except alpha; in 8 bits, the bands declared red, green and blue, or else
    the palette, the only grey band, or by convention the first three bands except alpha. A single band with a palette
    becomes colours.

    Parameters
    ----------
    wanted : sequence of str
        Names, or numbers from 1.
    as_stored : bool
        Whether to keep any number of bands in the file's data type; otherwise the result is red, green and blue.
    stretched : bool
        Whether values are stretched to 8 bits later.
    title : str
        The file, as errors name it.

    Raises
    ------
    InvalidInput
        Unknown band, unsupported data type, more than 8 bits without a stretch, or bands that are not a picture. Names
        the reason, not the file.
    """
    names = band_names(facts.bands)
    stated = {band.colour: 1 + i for i, band in reversed(list(enumerate(facts.bands)))}
    plain = [1 + i for i, band in enumerate(facts.bands) if band.colour != "alpha"]
    if wanted:
        bands = tuple(1 + at for at in chosen(wanted, names, title))
    elif as_stored and not _is_picture(facts.bands, plain):
        _check_colours(stated)
        bands = tuple(plain)
    else:
        bands = _chosen(facts.bands, stated, plain)
    if not as_stored and len(bands) not in (1, 3):
        raise InvalidInput(
            "{0} bands: JPEG and PNG have one or three",
            len(bands),
            field="bands",
            remedy=Message("name so many, or write GeoTIFF{0}", OptionName("format").in_brackets),
        )
    if not 1 <= len(bands) <= MAX_BANDS:
        raise InvalidInput("{0} bands: must be from 1 to {1}", len(bands), MAX_BANDS, field="bands")
    alpha = stated.get("alpha")
    alpha = None if alpha in bands else alpha
    first = facts.bands[bands[0] - 1]
    table = _table(first, len(bands), white_is_zero=facts.white_is_zero)
    data_type = _data_type([(index, facts.bands[index - 1]) for index in bands])
    if data_type != "uint8" and table is None and not as_stored and not stretched:
        raise InvalidInput(
            "values of band {0} are {1}, but JPEG and PNG have 8 bits",
            bands[0],
            data_type,
            field="stretch",
            remedy=Message(
                "choose how they become 8 bits{0}, such as percentile, or write GeoTIFF{1}",
                OptionName("stretch").in_brackets,
                OptionName("format").in_brackets,
            ),
        )
    as_colours = not as_stored or (not wanted and _is_picture(facts.bands, plain))
    nodata = tuple(_held(facts.bands[index - 1].nodata, data_type) for index in bands)
    white = _white(facts.bands[0]) if facts.white_is_zero and table is None and 1 in bands else None
    if table is not None:
        kind = RGB
    else:
        kind = _kind(facts.bands, bands, names, data_type, as_colours=as_colours, as_stored=as_stored)
        if not stretched:
            kind = _add_metadata(kind, facts.bands, bands, nodata, white)
    return Colours(
        bands,
        nodata,
        kind,
        alpha,
        bands[0] if first.masked else None,
        table,
        white,
        not as_stored and kind.are_colours,
        data_type,
    )


def _kind(
    available: Sequence[Band],
    bands: Sequence[int],
    names: Sequence[str],
    data_type: str,
    *,
    as_colours: bool,
    as_stored: bool,
) -> Bands:
    """Names, data type and colours of bands, given by their numbers from 1."""
    # Three colours without names are identified by their order.
    are_named = len(bands) == 3 and any(available[index - 1].name for index in bands)
    if data_type == "uint8" and as_colours and not are_named:
        return RGB
    kept = tuple(names[index - 1] for index in bands)
    if not as_stored:
        kept = kept * (3 // len(kept))
    return Bands(kept, data_type, colour_channels(kept))


def _add_metadata(
    kind: Bands,
    available: Sequence[Band],
    bands: Sequence[int],
    nodata: Sequence[float | None],
    white: int | None,
) -> Bands:
    """Add metadata to bands; for 8-bit colours, only the quantity of values."""
    each = [_metadata(available[index - 1], white if index == 1 else None) for index in bands]
    if kind.are_colours:
        each = [one.quantity for one in each]
    first = nodata[0] if nodata else None
    # Infinity and NaN count as missing anyway.
    is_one = first is not None and math.isfinite(first) and all(one == first for one in nodata)
    held = first if is_one and not kind.are_colours else None
    if held is not None and white is not None:
        held = white - held
    metadata = tuple(each[at % len(each)] for at in range(len(kind)))
    return replace(kind, metadata=metadata, nodata=held)


def _metadata(band: Band, white: int | None) -> BandMetadata:
    """Metadata of a band; if ``white`` is given, for values inverted so that 0 is black."""
    scale, offset = band.scale, band.offset
    if not (math.isfinite(scale) and math.isfinite(offset) and scale):
        scale, offset = 1.0, 0.0
    if white is not None and (scale, offset) != (1.0, 0.0):
        scale, offset = -scale, offset + scale * white
    # Leave out items that describe all values of the file, or that GDAL states elsewhere.
    left_out = r"STATISTICS_.*|DISPLAY_RANGE|DESCRIPTION|COLORINTERP|SCALE|OFFSET|UNITTYPE"
    items = tuple(
        (domain, name, " ".join(printable(value[:_VALUE_CHARACTERS]).split()))
        for domain, name, value in band.items[:_MOST_ITEMS]
        if re.fullmatch(r"[A-Za-z][\w .:-]{0,99}", name, re.ASCII) and not re.fullmatch(left_out, name, re.IGNORECASE)
    )
    unit = " ".join(printable(band.unit[:_NAME_CHARACTERS]).split())
    # Image files state these colours by the order of bands, or not at all.
    is_unstated = band.colour in {*_NAMELESS, *_OTHER_COLOURS, "red", "green", "blue", "alpha"}
    return BandMetadata(scale, offset, unit, "" if is_unstated else band.colour, items)


def _white(band: Band) -> int | None:
    """Value of black in a band in which 0 is white; None unless the type is unsigned."""
    if np.dtype(band.data_type).kind != "u":
        return None
    bits = 8 * np.dtype(band.data_type).itemsize if band.bits is None else band.bits
    return (1 << bits) - 1


def height_colours(facts: Facts) -> Colours:
    """Conversion of the first band, of any numeric type, to heights; raises InvalidInput for other values."""
    first = facts.bands[0]
    try:
        is_number = np.dtype(first.data_type).kind in "iuf"
    except TypeError:
        is_number = False
    if not is_number or first.colour in ("palette", "alpha") or (facts.bands[1:] and first.data_type == "uint8"):
        raise InvalidInput("its values are no heights: its first band is {0}, {1}", first.colour, first.data_type)
    nodata = _held(first.nodata, "float32")
    return Colours((1,), (nodata,), Bands(("height",), "float32", (0,)), None, 1 if first.masked else None)


def band_names(bands: Sequence[Band]) -> tuple[str, ...]:
    """Names of a file's bands: descriptions, otherwise colours, otherwise numbers."""

    def name(index: int, band: Band) -> str:
        described = " ".join(printable(band.name[:_NAME_CHARACTERS]).split())
        # GDAL reports grey for the first of several bands without a colour.
        if len(plain) == 1 and band.colour == "gray":
            return described or "grey"
        return described or (unnamed(index) if band.colour in _NAMELESS else band.colour)

    plain = [band for band in bands if band.colour != "alpha"]
    return tuple(name(index, band) for index, band in enumerate(bands))


def _is_picture(bands: Sequence[Band], plain: Sequence[int]) -> bool:
    """Whether bands are exactly 8-bit red, green and blue, or a single band with a palette."""
    colours = [bands[index - 1] for index in plain]
    if len(colours) == 1:
        return _table(colours[0], 1) is not None
    return len(colours) == 3 and all(one.data_type == "uint8" and not one.name for one in colours)


def _check_colours(stated: dict[str, int]) -> None:
    other = sorted(_OTHER_COLOURS & {colour.split(" ")[0].lower() for colour in stated})
    if other:
        raise InvalidInput("its bands are {0}, and not red, green, blue or grey", ", ".join(other))


def _chosen(bands: Sequence[Band], stated: dict[str, int], plain: list[int]) -> tuple[int, ...]:
    if {"red", "green", "blue"} <= stated.keys():
        return stated["red"], stated["green"], stated["blue"]
    _check_colours(stated)
    if "palette" in stated:
        return (stated["palette"],)
    if len(plain) >= 3:
        return plain[0], plain[1], plain[2]
    if len(plain) == 1:
        return (plain[0],)
    if "gray" in stated:
        return (stated["gray"],)
    kinds = ", ".join(band.colour for band in bands) or "none"
    raise InvalidInput("its bands ({0}) are neither a grey one nor red, green and blue", kinds)


def _data_type(bands: Sequence[tuple[int, Band]]) -> str:
    """Data type that can hold the values of all bands, which are given with numbers from 1."""
    held = bands[0][1].data_type
    for index, band in bands:
        try:
            held = np.result_type(held, band.data_type).name
        except TypeError:
            held = band.data_type
        if held not in DATA_TYPES:
            raise InvalidInput(
                "values of band {0} are {1}: must be one of {2}, as gdal_translate -ot Float32 makes them",
                index,
                band.data_type,
                ", ".join(DATA_TYPES),
            )
    return held


def _table(band: Band, count: int, *, white_is_zero: bool = False) -> Bytes | None:
    """Colours of the values of a single band, by its palette or a depth below 8 bits; None for other bands."""
    if band.data_type not in ("uint8", "uint16") or count != 1:
        return None
    table = np.zeros((1 << 8 * np.dtype(band.data_type).itemsize, 4), np.uint8)
    if band.palette and band.colour == "palette":
        table[: len(band.palette)] = np.clip(np.array(band.palette[: len(table)]), 0, 255)
        return table
    if band.bits is not None and band.bits < 8:
        most = (1 << band.bits) - 1
        levels = np.arange(most, -1, -1) if white_is_zero else np.arange(most + 1)
        table[: most + 1, :3] = np.rint(levels * (255.0 / most))[:, np.newaxis]
        table[: most + 1, 3] = 255
        return table
    return None


def _held(nodata: float | None, data_type: str) -> float | None:
    """Nodata as a value of a data type; None if the type cannot hold it."""
    if nodata is None:
        return None
    if data_type == "float32":
        with np.errstate(over="ignore"):
            return float(np.float32(nodata))
    limits = np.iinfo(data_type)
    return int(nodata) if limits.min <= nodata <= limits.max and nodata == int(nodata) else None
