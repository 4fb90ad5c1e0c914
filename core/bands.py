"""Bands of a source's pixels: names, data type, and the channels displayed as colours."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from .arrays import NDArray
from .errors import InvalidInput
from .numbers import real_number

#: Types of pixel values, by numpy's names.
DATA_TYPES = ("uint8", "uint16", "int16", "float32")
#: Stretches to 8 bits by name: none, or from the 2nd to the 98th percentile of the file.
NO_STRETCH, PERCENTILE = "none", "percentile"

#: Pixels (h, w, n) of one of `DATA_TYPES`.
Values = NDArray[Any]
Range = tuple[float, float]


@dataclass(frozen=True)
class BandMetadata:
    """Meaning of the stored values of one band, as its file states it.

    Parameters
    ----------
    scale, offset : float
        The quantity is ``scale * stored value + offset``.
    unit : str
        Unit of the quantity; empty if not stated.
    colour : str
        GDAL's colour interpretation, such as NIR; empty if not stated.
    items : tuple of (domain, name, value)
        GDAL metadata items, such as the wavelength; the default domain is empty.
    """

    scale: float = 1.0
    offset: float = 0.0
    unit: str = ""
    colour: str = ""
    items: tuple[tuple[str, str, str], ...] = ()

    @property
    def is_scaled(self) -> bool:
        """Whether the quantity differs from the stored value."""
        return (self.scale, self.offset) != (1.0, 0.0)

    @property
    def quantity(self) -> BandMetadata:
        """Scale, offset and unit only."""
        return replace(self, colour="", items=())


@dataclass(frozen=True)
class Bands:
    """Channels of a source's pixels.

    Parameters
    ----------
    names : tuple of str
        In the order of the channels.
    data_type : str
        One of `DATA_TYPES`.
    shown : tuple of int
        Channels, counted from 0, displayed as red, green and blue, or the one displayed as grey.
    metadata : tuple of BandMetadata
        One for each channel; empty if the file states nothing for any.
    nodata : float or None
        Stored value that means no data, in every band.
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
        """Metadata of each channel, with defaults if the file states none."""
        return self.metadata or (BandMetadata(),) * len(self)

    @cached_property
    def dtype(self) -> np.dtype[Any]:
        """Data type of the values."""
        return np.dtype(self.data_type)

    @property
    def are_colours(self) -> bool:
        """Whether the bands are 8-bit red, green and blue, or grey, which every program displays."""
        return self.data_type == "uint8" and self.shown == tuple(range(len(self)))

    def picture_bands(self, channels: int) -> Bands:
        """Bands of a grey (1 channel) or colour (3 channels) picture made from these."""
        metadata = tuple(self.metadata[at] for at in self.shown) if self.metadata else ()
        if channels == 1 and len(self.shown) > 1:
            # The mean of channels has a quantity only if all channels have the same.
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
        """Size of a pixel in bytes."""
        return len(self) * self.dtype.itemsize

    def __str__(self) -> str:
        return f"{', '.join(self.names)} ({self.data_type})"


def full(dtype: np.dtype[Any]) -> Any:
    """Value of the mask (the channel after the bands) where there is imagery."""
    return dtype.type(1.0 if dtype.kind == "f" else np.iinfo(dtype).max)


def fitted(values: NDArray[Any], dtype: np.dtype[Any]) -> Values:
    """Convert values to a data type: integers are rounded and clipped."""
    if dtype.kind == "f":
        floats: Values = values.astype(dtype, copy=False)
        return floats
    limits = np.iinfo(dtype)
    rounded: Values = np.clip(np.rint(values), limits.min, limits.max).astype(dtype)
    return rounded


#: Bands of most sources.
RGB = Bands(("red", "green", "blue"))


def source_bands(source: object) -> Bands:
    """Bands of a source, by default 8-bit red, green and blue."""
    # `isinstance` of a protocol would also read `ranges`, which opens a file.
    bands: Bands = getattr(source, "bands", RGB)
    return bands


def source_ranges(source: object) -> tuple[Range, ...]:
    """Values displayed as darkest and brightest, for each band of a source."""
    ranges: tuple[Range, ...] = getattr(source, "ranges", ((0.0, 255.0),) * len(RGB))
    return ranges


def stretch_range(text: str) -> Range | None:
    """Parse the two numbers of a mission's stretch; None for a stretch by name.

    Raises
    ------
    InvalidInput
        Neither a name nor two ascending numbers.
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
    """Percentiles 2 and 98 of a band's values (n,); 0 and 1 if there are no values."""
    if not values.size:
        return 0.0, 1.0
    low, high = np.percentile(values, (2.0, 98.0))
    return float(low), float(high)


def in_8_bits(values: Values, ranges: Sequence[Range]) -> NDArray[np.uint8]:
    """Stretch the range of each channel of values (h, w, n) to 0 to 255, clipped."""
    shown = np.empty(values.shape, np.uint8)
    for channel, (low, high) in enumerate(ranges):
        # If the range is empty, values above it become 255 and all others 0.
        scale = 255 / (high - low) if high > low else math.inf
        with np.errstate(invalid="ignore"):
            level = (values[..., channel].astype(np.float64) - low) * scale
        shown[..., channel] = np.rint(np.clip(np.nan_to_num(level, posinf=np.inf, neginf=-np.inf), 0, 255))
    return shown


def shown_in_8_bits(values: Values, bands: Bands, ranges: Sequence[Range]) -> NDArray[np.uint8]:
    """8-bit display, (h, w) or (h, w, 3), of a picture (h, w, n) with or without a mask after its bands."""
    shown = list(bands.shown)
    picked = values[..., shown]
    if bands.data_type != "uint8":
        picked = in_8_bits(picked, [ranges[at] for at in shown])
    return picked[..., 0] if len(shown) == 1 else picked


def chosen(wanted: Sequence[str], names: Sequence[str], title: str) -> tuple[int, ...]:
    """Find bands by name or by number from 1; return their indices from 0.

    Parameters
    ----------
    wanted : sequence of str
    names : sequence of str
        All bands of the source.
    title : str
        Title of the source, for errors.

    Raises
    ------
    InvalidInput
        A band does not exist, or is named twice.
    """
    by_name = {name.casefold(): at for at, name in reversed(list(enumerate(names)))}
    found = []
    for one in wanted:
        number = int(one) - 1 if one.isdecimal() and one.isascii() else -1
        at = by_name.get(one.casefold(), number)
        if not 0 <= at < len(names):
            available = ", ".join(
                f"{1 + i}" if name == unnamed(i) else f"{1 + i} {name}" for i, name in enumerate(names)
            )
            raise InvalidInput("band {0!r}: {1} has {2}", one, title, available, field="bands")
        if at in found:
            raise InvalidInput("band {0!r}: is named twice", one, field="bands")
        found.append(at)
    return tuple(found)


def unnamed(index: int) -> str:
    """Name of a band without a name, by its index from 0."""
    return f"band {1 + index}"


def colour_channels(names: Sequence[str], first: Sequence[int] = (0, 1, 2)) -> tuple[int, ...]:
    """Channels displayed as colours: red, green and blue by name if there are more than three, else ``first``."""
    if len(names) > 3:
        lower = [name.casefold() for name in names]
        if {"red", "green", "blue"} <= set(lower):
            return tuple(lower.index(name) for name in ("red", "green", "blue"))
        return tuple(first)
    return (0, 1, 2) if len(names) == 3 else (0,)
