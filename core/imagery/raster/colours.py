"""Which of a file's bands make a picture, and what of it is no imagery."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InvalidInput
from ..source import over_white
from .reading import Band, Box, Bytes, Facts, RasterFile

#: Colour interpretations whose values are neither red, green and blue nor greys.
_OTHER_COLOURS = frozenset(
    "hue saturation lightness cyan magenta yellow black ycbcr_y ycbcr_cb ycbcr_cr y cb cr".split()
)


@dataclass(frozen=True)
class Colours:
    """How to make colours of a raster's values.

    Parameters
    ----------
    bands : tuple of int
        Those of red, green and blue, or the one of greys or of a palette's values; counted from 1.
    nodata : tuple of (int or None)
        Of each of them. A pixel has no data only where all of them say so: 0 is a good value for the red of a pond.
    alpha : int or None
        The band that is stated to be alpha; a fourth band alone is not one.
    mask : int or None
        The band whose mask counts.
    table : array (256, 4) of uint8 or None
        Red, green, blue and alpha of values; None where values are colours.
    """

    bands: tuple[int, ...]
    nodata: tuple[int | None, ...]
    alpha: int | None = None
    mask: int | None = None
    table: Bytes | None = None

    def read(self, file: RasterFile, box: Box) -> Bytes:
        """Colours of a box, (height, width, 4): red, green, blue, and 1 for imagery; all 0 where there is none.

        Translucent pixels are laid over white, as those of tiles are.
        """
        wanted = self.bands if self.alpha is None else (*self.bands, self.alpha)
        values = file.read(wanted, box)
        rgb = values[: len(self.bands)]
        there = ~self._is_nodata(rgb)
        alpha = None if self.alpha is None else values[-1]
        if self.table is not None:
            looked_up = self.table[rgb[0]]
            rgb, alpha = np.moveaxis(looked_up[..., :3], 2, 0), looked_up[..., 3]
        if self.mask is not None:
            there &= file.read_mask(self.mask, box) != 0
        colours = np.empty((box.height, box.width, 4), np.uint8)
        for channel in range(3):
            band = rgb[channel % len(rgb)]
            colours[..., channel] = band if alpha is None else over_white(band, alpha)
        if alpha is not None:
            there &= alpha != 0
        colours[..., 3] = there
        colours[~there] = 0
        return colours

    def _is_nodata(self, values: Bytes) -> NDArray[np.bool_]:
        absent = np.full(values.shape[1:], None not in self.nodata)
        if None not in self.nodata:
            for band, nodata in zip(values, self.nodata):
                absent &= band == nodata
        return absent


def colours_of(facts: Facts) -> Colours:
    """Choose the bands that make the picture.

    Those that the file states to be red, green and blue; else its palette; else its one grey band; else the first
    three bands that are not alpha, as is the custom where nothing is stated. Values are taken as they are: nothing
    is stretched.

    Raises
    ------
    InvalidInput
        With the reason alone: other than 8 bits a value, or bands that are no picture.
    """
    stated = {band.colour: 1 + i for i, band in reversed(list(enumerate(facts.bands)))}
    plain = [1 + i for i, band in enumerate(facts.bands) if band.colour != "alpha"]
    bands = _chosen(facts.bands, stated, plain)
    first = facts.bands[bands[0] - 1]
    for index in bands:
        _check_type(index, facts.bands[index - 1])
    alpha = stated.get("alpha")
    if alpha is not None:
        _check_type(alpha, facts.bands[alpha - 1])
    nodata = tuple(_byte(facts.bands[index - 1].nodata) for index in bands)
    mask = bands[0] if first.masked else None
    return Colours(bands, nodata, alpha, mask, _table(first, len(bands)))


def _chosen(bands: Sequence[Band], stated: dict[str, int], plain: list[int]) -> tuple[int, ...]:
    if {"red", "green", "blue"} <= stated.keys():
        return stated["red"], stated["green"], stated["blue"]
    other = sorted(_OTHER_COLOURS & {colour.split(" ")[0].lower() for colour in stated})
    if other:
        raise InvalidInput("its bands are {0}, and not red, green, blue or grey", ", ".join(other))
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


def _check_type(index: int, band: Band) -> None:
    if band.data_type != "uint8":
        raise InvalidInput(
            "values of band {0} are {1}, and pictures have 8 bits: choose the range to show, as by "
            "gdal_translate -ot Byte -scale",
            index,
            band.data_type,
        )


def _table(band: Band, count: int) -> Bytes | None:
    """Colours that a palette, or fewer than 8 bits, give the values of a single band."""
    table = np.zeros((256, 4), np.uint8)
    if band.palette and band.colour == "palette" and count == 1:
        table[: len(band.palette)] = np.clip(np.array(band.palette[:256]), 0, 255)
        return table
    if band.bits is not None and band.bits < 8 and count == 1:
        most = (1 << band.bits) - 1
        table[: most + 1, :3] = np.rint(np.arange(most + 1) * (255.0 / most))[:, np.newaxis]
        table[: most + 1, 3] = 255
        return table
    return None


def _byte(nodata: float | None) -> int | None:
    """Nodata as one of the values a band can have; None where it is not."""
    return int(nodata) if nodata is not None and nodata in range(256) else None
