"""Images of any bands for display: grey or colours of 8 bits. Runs in the background; no widgets."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from osgeo import gdal

from ...core.bands import colour_channels
from ...core.capture.writers import DISPLAY_RANGE
from ...core.imagery.raster.trust import VIRTUAL, allowed_drivers

_DARKEST, _BRIGHTEST = 0.0, 255.0


class ImageRendering(NamedTuple):
    """Display parameters of an image.

    Parameters
    ----------
    bands : tuple of int
        Numbers of the red, green and blue bands, or of the grey one; from 1.
    ranges : tuple of (low, high)
        Darkest and brightest value of each band; empty for bands of 8 bits.
    data_type : str
        GDAL's name of the data type.
    mask : int or str or None
        Number of the band that is 0 in transparent pixels; ``mask`` if a nodata value marks such pixels; None without.
    stated : tuple of mapping
        For each band of 8 bits, the description, unit, offset and scale that the file has, by their element in GDAL's
        virtual rasters.
    """

    bands: tuple[int, ...]
    ranges: tuple[tuple[float, float], ...]
    data_type: str
    mask: int | str | None
    stated: tuple[dict[str, str], ...] = ()

    @property
    def is_plain(self) -> bool:
        """Whether the bands are the file's first ones in order, of 8 bits."""
        return not self.ranges and self.bands == tuple(range(1, 1 + len(self.bands)))


def image_rendering(image: gdal.Dataset) -> ImageRendering:
    """Display parameters of an open image."""
    bands = [image.GetRasterBand(1 + i) for i in range(image.RasterCount)]
    kinds = [band.GetColorInterpretation() for band in bands]
    colours = (gdal.GCI_RedBand, gdal.GCI_GreenBand, gdal.GCI_BlueBand)
    alpha = kinds.index(gdal.GCI_AlphaBand) if gdal.GCI_AlphaBand in kinds else None
    if all(colour in kinds for colour in colours):
        shown = tuple(1 + kinds.index(colour) for colour in colours)
    else:
        there = [f"{i}" for i in range(len(bands)) if i != alpha]
        # As in the core, for bands without colours.
        shown = tuple(1 + at for at in colour_channels(there)) if len(there) == 3 else (1,)
    first = bands[0]
    mask: int | str | None = None if alpha is None else 1 + alpha
    if mask is None and first.GetNoDataValue() is not None:
        mask = "mask"
    is_8_bit = first.DataType == gdal.GDT_Byte
    ranges = () if is_8_bit else tuple(_range(bands[at - 1]) for at in shown)
    stated = tuple(_stated(bands[at - 1]) for at in shown) if is_8_bit else ()
    return ImageRendering(shown, ranges, gdal.GetDataTypeName(first.DataType), mask, stated)


def open_image(path: str | Path) -> gdal.Dataset | None:
    """Open a GeoTIFF, JPEG or PNG that does not refer to other files; None if it has another format.

    Raises
    ------
    InvalidInput
        The file, or a sidecar file that GDAL opens with it, refers to other files, or its CRS names files for PROJ.
    """
    if not str(path).startswith(VIRTUAL):
        allowed_drivers(str(path))
    # A foreign file named .png may actually describe a service: allow only image drivers.
    return gdal.OpenEx(str(path), gdal.OF_RASTER, allowed_drivers=("GTiff", "JPEG", "PNG"))


def open_shown(path: str | Path) -> gdal.Dataset | None:
    """Open an image as 8 bits, grey or colours, with its mask, if any; None if GDAL cannot open it."""
    image = open_image(path)
    if image is None:
        return None
    shown = image_rendering(image)
    count = len(shown.bands) + (shown.mask is not None)
    # The mask of a nodata value is not a band.
    if shown.is_plain and image.RasterCount == count and shown.mask in (None, count):
        return image
    bands: list[int | str] = [*shown.bands]
    ranges = [list(one) for one in shown.ranges] or [[_DARKEST, _BRIGHTEST]] * len(bands)
    if shown.mask is not None:
        bands.append(shown.mask)
        wide = shown.mask != "mask" and shown.data_type == "UInt16"
        ranges.append([_DARKEST, 65535.0 if wide else _BRIGHTEST])
    return gdal.Translate(
        "",
        image,
        format="VRT",
        bandList=bands,
        outputType=gdal.GDT_Byte,
        scaleParams=[[*one, _DARKEST, _BRIGHTEST] for one in ranges],
        noData="none",
    )


def _stated(band: gdal.Band) -> dict[str, str]:
    """The description, unit, offset and scale that a band has, by their element in GDAL's virtual rasters."""
    found = {"Description": band.GetDescription(), "UnitType": band.GetUnitType()}
    numbers = {"Offset": (band.GetOffset(), 0.0), "Scale": (band.GetScale(), 1.0)}
    found.update({name: repr(value) for name, (value, plain) in numbers.items() if value not in (None, plain)})
    return {name: text for name, text in found.items() if text}


def _range(band: gdal.Band) -> tuple[float, float]:
    """Darkest and brightest value of a band: the display range stated in its file, otherwise the actual range."""
    stated = band.GetMetadataItem(DISPLAY_RANGE)
    low, high = (float(one) for one in stated.split()) if stated else band.ComputeRasterMinMax(True)
    return low, high if high > low else low + 1.0
