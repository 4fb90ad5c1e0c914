"""An image and its depth map, read for display. On any thread; no file stays open."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple
from uuid import uuid4

import numpy as np
from osgeo import gdal
from qgis.PyQt.QtGui import QImage

from ...core.errors import InvalidInput
from ...core.imagery.raster.trust import check_fetched
from ...core.storage.files import file_exists
from ...core.text.plain import one_line
from ..i18n import tr
from .shown import open_image, open_shown

_GREY_WITH_MASK, _COLOURS, _COLOURS_WITH_MASK = 2, 3, 4
#: Evenly spaced colours from near to far: matplotlib's viridis, perceptually uniform, also for the colour-blind.
_VIRIDIS = (
    (68, 1, 84),
    (71, 45, 123),
    (59, 82, 139),
    (44, 114, 142),
    (33, 145, 140),
    (40, 174, 128),
    (94, 201, 98),
    (173, 220, 48),
    (253, 231, 37),
)


class DisplayImage(NamedTuple):
    """An image, reduced to its display size.

    Parameters
    ----------
    path : Path
    image : QImage or None
        RGBA; pixels without imagery are transparent. None if the file cannot be read.
    width_px, height_px : int
        Size of the image in the file.
    metadata : mapping of str to str
        Metadata of the file.
    problem : str
        Reason why the file cannot be read; empty if it can.
    """

    path: Path
    image: QImage | None
    width_px: int = 0
    height_px: int = 0
    metadata: Mapping[str, str] = MappingProxyType({})
    problem: str = ""


class Depth(NamedTuple):
    """The depth of an image.

    Parameters
    ----------
    metres : array (h, w) of float32
        Depth of the displayed pixels along the optical axis; NaN where no ground is visible.
    least_m, most_m : float
        Range of the depth of all pixels; NaN if no ground is visible.
    image : QImage
        Depth in colours on a logarithmic scale, which shows differences both near and far.
    problem : str
        Reason why the depth cannot be read; image and pixels are then empty.
    """

    metres: np.ndarray
    least_m: float
    most_m: float
    image: QImage | None
    problem: str = ""

    def metres_at_point(self, x: float, y: float) -> float:
        """Depth in metres at ``x, y``, shares of width and height from 0 to 1; NaN where no ground is visible."""
        height, width = self.metres.shape
        return float(self.metres[min(int(y * height), height - 1), min(int(x * width), width - 1)])

    def to_metres(self, share: float) -> float:
        """Depth at a share of the colour scale from near to far."""
        return float(self.least_m ** (1.0 - share) * self.most_m**share)


def read_depth(path: Path, longest_px: int, data: bytes | None = None) -> Depth | None:
    """Read the depth of an image; None if it has none.

    The size is reduced as by `read_picture`, but to the nearest pixels.

    Parameters
    ----------
    path : Path
    longest_px : int
    data : bytes or None
        Contents of a remote file.
    """
    if data is None and not file_exists(path):
        return None
    try:
        read, mask = read_band(path, longest_px, data)
    except (RuntimeError, InvalidInput) as wrong:
        # The image itself can still be shown.
        problem = tr("The depth cannot be read: {reason}").format(reason=one_line(str(wrong)))
        return Depth(np.empty((0, 0), np.float32), np.nan, np.nan, None, problem)
    metres = np.where(mask == 0, np.nan, read).astype(np.float32)
    metres[~(np.isfinite(metres) & (metres > 0.0))] = np.nan
    there = metres[~np.isnan(metres)]
    least, most = (float(there.min()), float(there.max())) if there.size else (np.nan, np.nan)
    span = np.log(most / least) if most > least else 1.0
    return Depth(metres, least, most, _image(np.moveaxis(depth_colours(np.log(metres / least) / span), -1, 0)))


def read_band(path: Path, longest_px: int, data: bytes | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Values and mask of a file's first band, reduced to the nearest pixels of the size in which images are read.

    Raises
    ------
    RuntimeError, InvalidInput
        The file cannot be read.
    """
    with _openable(path, data) as name:
        file = open_image(name)
        if file is None:
            raise RuntimeError(gdal.GetLastErrorMsg())
        band, size = file.GetRasterBand(1), _size(file, longest_px)
        read, mask = band.ReadAsArray(**size), band.GetMaskBand().ReadAsArray(**size)
        # Release the file before `_openable` removes the memory from which it is read.
        del band, file
    if read is None or mask is None:
        raise RuntimeError(gdal.GetLastErrorMsg())
    return read, mask


def legend_image(width: int) -> QImage:
    """Colours from near to far, one line."""
    return _image(np.moveaxis(depth_colours(np.linspace(0.0, 1.0, width)[np.newaxis]), -1, 0))


def depth_colours(share: np.ndarray) -> np.ndarray:
    """Colours (..., 3) of ``share``, from 0 (near) to 1 (far); grey for NaN."""
    at = np.linspace(0.0, 1.0, len(_VIRIDIS))
    channels = [np.interp(share, at, channel) for channel in zip(*_VIRIDIS)]
    # The scale contains no grey.
    colours = np.where(np.isnan(share)[..., np.newaxis], (128, 128, 128), np.stack(channels, axis=-1))
    return np.rint(colours).astype(np.uint8)


def read_picture(path: Path, longest_px: int, data: bytes | None = None) -> DisplayImage:
    """Read a GeoTIFF, JPEG or PNG, reduced if its longer side exceeds ``longest_px``.

    Parameters
    ----------
    path : Path
    longest_px : int
    data : bytes or None
        Contents of a remote file.
    """
    if data is None and not file_exists(path):
        return DisplayImage(path, None, problem=tr("There is no image (yet)."))
    try:
        with _openable(path, data) as name:
            file = open_shown(name)
            if file is None:
                raise RuntimeError(gdal.GetLastErrorMsg())
            width, height = file.RasterXSize, file.RasterYSize
            bands = file.ReadAsArray(resample_alg=gdal.GRIORA_Average, **_size(file, longest_px))
            metadata = dict(file.GetMetadata())
            # Release the file before `_openable` removes the memory from which it is read.
            del file
    except (RuntimeError, InvalidInput) as wrong:
        return DisplayImage(path, None, problem=tr("The image cannot be read: {reason}").format(reason=wrong))
    if bands is None:
        reason = gdal.GetLastErrorMsg()
        return DisplayImage(path, None, problem=tr("The image cannot be read: {reason}").format(reason=reason))
    return DisplayImage(path, _image(bands), width, height, metadata)


@contextmanager
def _openable(path: Path, data: bytes | None) -> Iterator[str]:
    """Name under which GDAL opens a file; fetched bytes become a file in memory until exit."""
    if data is None:
        yield str(path)
        return
    check_fetched(path.name, data)
    folder = f"/vsimem/terrainav-{uuid4().hex}"
    name = f"{folder}/{path.name}"
    gdal.FileFromMemBuffer(name, data)
    try:
        yield name
    finally:
        gdal.Unlink(name)


def _size(file: gdal.Dataset, longest_px: int) -> dict[str, int]:
    """Size at which to read a file for display."""
    width, height = file.RasterXSize, file.RasterYSize
    share = min(longest_px / max(width, height), 1.0)
    return {"buf_xsize": max(round(width * share), 1), "buf_ysize": max(round(height * share), 1)}


def _image(bands: np.ndarray) -> QImage:
    """Image of bands (h, w) or (b, h, w): grey or colours, with or without a mask."""
    bands = bands.reshape(-1, *bands.shape[-2:])
    count, height, width = bands.shape
    masked = count in (_GREY_WITH_MASK, _COLOURS_WITH_MASK)
    colours = bands[: count - 1] if masked else bands[:3]
    pixels = np.empty((height, width, 4), np.uint8)
    pixels[..., :3] = np.moveaxis(np.broadcast_to(colours, (3, height, width)), 0, -1)
    pixels[..., 3] = bands[-1] if masked else 255
    return rgba_image(pixels)


def picture_image(pixels: np.ndarray, *, masked: bool) -> QImage:
    """Image of a picture (h, w, bands) with a mask as its last band if ``masked``.

    Values other than 8-bit ones are stretched over their range.
    """
    colours = pixels[..., :-1] if masked else pixels
    there = pixels[..., -1] > 0 if masked else np.ones(pixels.shape[:2], bool)
    colours = colours[..., :3] if colours.shape[-1] >= _COLOURS else colours[..., :1]
    if colours.dtype != np.uint8:
        values = colours[there & np.isfinite(colours).all(axis=-1)]
        low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
        share = (colours.astype(np.float64) - low) / ((high - low) or 1.0)
        colours = np.rint(255.0 * np.clip(np.nan_to_num(share), 0.0, 1.0)).astype(np.uint8)
    alpha = np.where(there, np.uint8(255), np.uint8(0))[..., np.newaxis]
    return rgba_image(np.concatenate([np.broadcast_to(colours, (*colours.shape[:2], _COLOURS)), alpha], axis=-1))


def rgba_image(pixels: np.ndarray) -> QImage:
    """Image of pixels (h, w, 4) of uint8."""
    height, width = pixels.shape[:2]
    # A copy: QImage does not own the array's memory.
    return QImage(pixels.tobytes(), width, height, 4 * width, QImage.Format.Format_RGBA8888).copy()
