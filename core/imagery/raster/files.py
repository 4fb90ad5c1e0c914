"""What the rest of this package wants of the libraries that read raster files: facts, and pixels as they are stored."""

from __future__ import annotations

import importlib.util
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ...errors import InvalidInput
from ...files import is_there

Bytes = NDArray[np.uint8]

#: GDAL's option for errors instead of grey where a JPEG is broken off.
STRICT_JPEG = "GDAL_ERROR_ON_LIBJPEG_WARNING"

#: What GDAL's names of rasters within a file begin with, such as GPKG:ortho.gpkg:summer; a drive has one letter.
_DRIVER = re.compile(r"[A-Z][A-Za-z0-9_]+:")


def file_of_part(name: str) -> str:
    """Path of the file that GDAL's name of a raster within it is of, where it is there; empty for other names."""
    if not _DRIVER.match(name):
        return ""
    pieces = re.split(r'[:"]', name)
    spans = combinations(range(1, len(pieces) + 1), 2)
    # The longest first: a path may hold colons.
    paths = sorted((":".join(pieces[start:end]) for start, end in spans), key=len, reverse=True)
    return next((path for path in paths if path and is_there(path)), "")


class Box(NamedTuple):
    """A rectangle of a raster's own pixels, columns from its left and rows from its top."""

    left: int
    top: int
    width: int
    height: int


@dataclass(frozen=True)
class Band:
    """What a file says of one of its bands.

    Parameters
    ----------
    data_type : str
        numpy's name of the type of its values.
    colour : str
        GDAL's colour interpretation: gray, red, green, blue, alpha, palette, undefined, …
    nodata : float or None
        Value of pixels without data.
    bits : int or None
        Bits of a value that are used, where they are fewer than the type has.
    palette : tuple of (red, green, blue, alpha)
        Colours of the values from 0 on; empty without a palette.
    masked : bool
        The file has a mask for it, beside nodata and alpha.
    """

    data_type: str
    colour: str = "undefined"
    nodata: float | None = None
    bits: int | None = None
    palette: tuple[tuple[int, int, int, int], ...] = ()
    masked: bool = False


@dataclass(frozen=True)
class Facts:
    """What a file says of itself.

    Parameters
    ----------
    bands : tuple of Band
    sizes : tuple of (width, height)
        In px: of the raster, then of its overviews from fine to coarse.
    crs_wkt : str
        Empty where the file states none.
    geotransform : tuple of 6 float or None
        In GDAL's order: x of the upper left corner, its steps per column and row, then those of y. None where the
        file does not place its pixels by one.
    tags : mapping of str to str
        Metadata of the file as a whole.
    by_points : bool
        It is placed by ground control points.
    parts : tuple of str
        Names of the rasters within, where it holds several.
    """

    bands: tuple[Band, ...]
    sizes: tuple[tuple[int, int], ...]
    crs_wkt: str
    geotransform: tuple[float, ...] | None
    tags: Mapping[str, str]
    by_points: bool = False
    parts: tuple[str, ...] = ()


class ReadError(Exception):
    """A library's own words on what it could not open or read, in one line; callers say of which file."""

    def __init__(self, words: object) -> None:
        super().__init__(" ".join(str(words).split()) or "no reason given")


class RasterFile(Protocol):
    """An open raster, or an open overview of one; for one thread at a time."""

    def facts(self) -> Facts:
        """Read what the file says of itself; asked of the raster, not of an overview."""
        ...

    def read(self, bands: Sequence[int], box: Box) -> Bytes:
        """Values as they are stored, (len(bands), height, width); bands count from 1. Raises ReadError."""
        ...

    def read_mask(self, band: int, box: Box) -> Bytes:
        """Mask of a band, (height, width): 0 where there is no data. Raises ReadError."""
        ...

    def close(self) -> None:
        """Free it."""
        ...


#: Opens a path's raster (level 0) or its overviews (from 1 on), as one of the ``drivers`` named; raises ReadError.
Opener = Callable[..., RasterFile]


def opener() -> Opener:
    """Return the library to read raster files with: rasterio, or GDAL's own bindings.

    Where QGIS or GDAL's bindings are loaded, those bindings and never rasterio: its wheels bring a GDAL of their own,
    and two of them in one process are known to bring QGIS down.

    Raises
    ------
    InvalidInput
        Neither is there.
    """
    loaded = {"qgis", "osgeo"} & sys.modules.keys()
    if not loaded and importlib.util.find_spec("rasterio"):
        from .by_rasterio import RasterioFile

        return RasterioFile
    if importlib.util.find_spec("osgeo"):
        from .by_gdal import GdalFile

        return GdalFile
    raise InvalidInput("raster files need rasterio: pip install terrainav[raster]")
