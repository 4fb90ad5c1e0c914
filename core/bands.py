"""The bands of a source's pixels: their names and type, and which of them are shown as colours."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InvalidInput
from .numbers import real_number

#: Values of pixels that images may have, numpy's names.
DATA_TYPES = ("uint8", "uint16", "int16", "float32")
#: Grey, and red, green, blue.
_GREY, _COLOURS = 1, 3
#: Values stay as they are, or the middle of all that the file has becomes 8 bits; else two numbers do.
NO_STRETCH, PERCENTILE = "none", "percentile"
#: Shares of the file's values, in percent, that are shown darkest and brightest.
DARKEST_PERCENT, BRIGHTEST_PERCENT = 2.0, 98.0
_BRIGHTEST = 255

#: Pixels (h, w, n) of one of `DATA_TYPES`.
Values = NDArray[Any]
Range = tuple[float, float]


@dataclass(frozen=True)
class BandMetadata:
    """What a file says that the stored values of one of its bands mean.

    Parameters
    ----------
    scale, offset : float
        The quantity is so many times the stored value, and so much more.
    unit : str
        Of the quantity; empty for none.
    colour : str
        GDAL's name of its colour interpretation, such as NIR; empty for none.
    items : tuple of (domain, name, value)
        Of GDAL's metadata, such as its wavelength; the domain is empty for the default one.
    """

    scale: float = 1.0
    offset: float = 0.0
    unit: str = ""
    colour: str = ""
    items: tuple[tuple[str, str, str], ...] = ()

    @property
    def is_scaled(self) -> bool:
        """Whether the quantity is another number than the stored value."""
        return (self.scale, self.offset) != (1.0, 0.0)

    @property
    def quantity(self) -> BandMetadata:
        """Scale, offset and unit alone."""
        return replace(self, colour="", items=())


@dataclass(frozen=True)
class Bands:
    """What the channels of a source's pixels are.

    Parameters
    ----------
    names : tuple of str
        In the order of the channels.
    data_type : str
        Of `DATA_TYPES`.
    shown : tuple of int
        Channels, counted from 0, that are shown as red, green and blue, or the one as grey.
    metadata : tuple of BandMetadata
        Of each channel; empty where nothing is stated of any.
    nodata : float or None
        Stored value that stands for no data, in every band.
    """

    names: tuple[str, ...]
    data_type: str = "uint8"
    shown: tuple[int, ...] = (0, 1, 2)
    metadata: tuple[BandMetadata, ...] = ()
    nodata: float | None = None

    def __post_init__(self) -> None:
        if all(one == BandMetadata() for one in self.metadata):
            object.__setattr__(self, "metadata", ())

    def __len__(self) -> int:
        return len(self.names)

    @property
    def each_metadata(self) -> tuple[BandMetadata, ...]:
        """Metadata of each channel, of nothing where nothing is stated."""
        return self.metadata or (BandMetadata(),) * len(self)

    @cached_property
    def dtype(self) -> np.dtype[Any]:
        """Type of the values."""
        return np.dtype(self.data_type)

    @property
    def are_colours(self) -> bool:
        """Whether they are red, green and blue of 8 bits, or grey: what every program shows."""
        return self.data_type == "uint8" and self.shown == tuple(range(len(self)))

    def picture_bands(self, channels: int) -> Bands:
        """Bands of a picture that is made grey (1) or colours (3) of these."""
        metadata = tuple(self.metadata[at] for at in self.shown) if self.metadata else ()
        if channels == _GREY and len(self.shown) > _GREY:
            # A mean of values means what all of them do.
            quantities = {one.quantity for one in metadata}
            return Bands(("grey",), self.data_type, (0,), tuple(quantities) if len(quantities) == 1 else ())
        return Bands(
            tuple(self.names[at] for at in self.shown),
            self.data_type,
            tuple(range(len(self.shown))),
            metadata,
            self.nodata,
        )

    @property
    def bytes_per_px(self) -> int:
        """Bytes of a pixel."""
        return len(self) * self.dtype.itemsize

    def __str__(self) -> str:
        return f"{', '.join(self.names)} ({self.data_type})"


def full(dtype: np.dtype[Any]) -> Any:
    """Value of a mask, the channel after the bands', where there is imagery; of the bands' type."""
    return dtype.type(1.0 if dtype.kind == "f" else np.iinfo(dtype).max)


def fitted(values: NDArray[Any], dtype: np.dtype[Any]) -> Values:
    """Values as a type has them: whole numbers are rounded, and kept within its limits."""
    if dtype.kind == "f":
        floats: Values = values.astype(dtype, copy=False)
        return floats
    limits = np.iinfo(dtype)
    whole: Values = np.clip(np.rint(values), limits.min, limits.max).astype(dtype)
    return whole


#: What most sources have.
RGB = Bands(("red", "green", "blue"))


def source_bands(source: object) -> Bands:
    """Bands of a source: red, green and blue of 8 bits where it does not say."""
    # Not by `isinstance`: that asks for the ranges as well, for which a file is read.
    bands: Bands = getattr(source, "bands", RGB)
    return bands


def source_ranges(source: object) -> tuple[Range, ...]:
    """Values of each of a source's bands that are shown darkest and brightest."""
    ranges: tuple[Range, ...] = getattr(source, "ranges", ((0.0, float(_BRIGHTEST)),) * len(RGB))
    return ranges


def stretch_range(text: str) -> Range | None:
    """Two values that a mission's stretch states; None where it is one of the words.

    Raises
    ------
    InvalidInput
        Neither.
    """
    if text in (NO_STRETCH, PERCENTILE):
        return None
    try:
        low, high = (real_number(one) for one in text.split())
    except ValueError:
        low, high = math.nan, math.nan
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise InvalidInput(
            "stretch {0!r}: must be {1}, {2}, or two numbers, the lower one first",
            text,
            NO_STRETCH,
            PERCENTILE,
            field="stretch",
        )
    return low, high


def percentiles(values: Values) -> Range:
    """Range of some of a band's values (n,) that leaves out the darkest and the brightest few; 0 to 1 for none."""
    if not values.size:
        return 0.0, 1.0
    low, high = np.percentile(values, (DARKEST_PERCENT, BRIGHTEST_PERCENT))
    return float(low), float(high)


def in_8_bits(values: Values, ranges: Sequence[Range]) -> NDArray[np.uint8]:
    """Values (h, w, n) with the range of each channel stretched to 0 to 255; what is beyond becomes the end of it."""
    shown = np.empty(values.shape, np.uint8)
    for channel, (low, high) in enumerate(ranges):
        # A range without width parts what is above it from the rest.
        scale = _BRIGHTEST / (high - low) if high > low else math.inf
        with np.errstate(invalid="ignore"):
            level = (values[..., channel].astype(np.float64) - low) * scale
        shown[..., channel] = np.rint(np.clip(np.nan_to_num(level, posinf=np.inf, neginf=-np.inf), 0, _BRIGHTEST))
    return shown


def shown_in_8_bits(values: Values, bands: Bands, ranges: Sequence[Range]) -> NDArray[np.uint8]:
    """Picture (h, w, n), with or without a mask after its bands, as it is shown: (h, w) or (h, w, 3)."""
    shown = list(bands.shown)
    picked = values[..., shown]
    if bands.data_type != "uint8":
        picked = in_8_bits(picked, [ranges[at] for at in shown])
    return picked[..., 0] if len(shown) == _GREY else picked


def chosen(wanted: Sequence[str], names: Sequence[str], title: str) -> tuple[int, ...]:
    """Bands, counted from 0, that a mission wants, each by its name or by its number from 1.

    Parameters
    ----------
    wanted : sequence of str
    names : sequence of str
        Of all the source's bands.
    title : str
        The source, as errors name it.

    Raises
    ------
    InvalidInput
        A band that is not there, or one that is named twice.
    """
    by_name = {name.casefold(): at for at, name in reversed(list(enumerate(names)))}
    found = []
    for one in wanted:
        number = int(one) - 1 if one.isdecimal() and one.isascii() else -1
        at = by_name.get(one.casefold(), number)
        if not 0 <= at < len(names):
            there = ", ".join(f"{1 + i}" if name == unnamed(i) else f"{1 + i} {name}" for i, name in enumerate(names))
            raise InvalidInput("band {0!r}: {1} has {2}", one, title, there, field="bands")
        if at in found:
            raise InvalidInput("band {0!r}: is named twice", one, field="bands")
        found.append(at)
    return tuple(found)


def unnamed(index: int) -> str:
    """Name of a band that its file gives none, by its index from 0."""
    return f"band {1 + index}"


def colour_channels(names: Sequence[str], first: Sequence[int] = (0, 1, 2)) -> tuple[int, ...]:
    """Channels that are shown as colours: red, green and blue where there are more than three, else in their order."""
    if len(names) > _COLOURS:
        lower = [name.casefold() for name in names]
        if {"red", "green", "blue"} <= set(lower):
            return tuple(lower.index(name) for name in ("red", "green", "blue"))
        return tuple(first)
    return (0, 1, 2) if len(names) == _COLOURS else (0,)
