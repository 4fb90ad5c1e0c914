"""A picture read for the screen. On any thread; no file stays open."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from osgeo import gdal
from qgis.PyQt.QtGui import QImage

from ..i18n import tr
from .shown import open_shown

_OPAQUE = 255
_GREY_WITH_MASK, _COLOURS_WITH_MASK = 2, 4


class Picture(NamedTuple):
    """A picture, no larger than it is shown.

    Parameters
    ----------
    path : Path
    image : QImage or None
        With four channels; what the camera has nothing to show of is transparent. None where there is no picture.
    width_px, height_px : int
        Of the file.
    metadata : mapping of str to str
        The file's own.
    problem : str
        Why there is no image.
    """

    path: Path
    image: QImage | None
    width_px: int = 0
    height_px: int = 0
    metadata: Mapping[str, str] = MappingProxyType({})
    problem: str = ""


def read_picture(path: Path, longest_px: int) -> Picture:
    """Read a GeoTIFF, JPEG or PNG, made smaller where its longer side has more than ``longest_px``."""
    if not path.is_file():
        return Picture(path, None, problem=tr("There is no image (yet)."))
    try:
        file = open_shown(path)
        if file is None:
            raise RuntimeError(gdal.GetLastErrorMsg())
        width, height = file.RasterXSize, file.RasterYSize
        share = min(longest_px / max(width, height), 1.0)
        size = {"buf_xsize": max(round(width * share), 1), "buf_ysize": max(round(height * share), 1)}
        bands = file.ReadAsArray(resample_alg=gdal.GRIORA_Average, **size)
        metadata = dict(file.GetMetadata())
    except RuntimeError as wrong:
        return Picture(path, None, problem=tr("The image cannot be read: {reason}").format(reason=wrong))
    if bands is None:
        reason = gdal.GetLastErrorMsg()
        return Picture(path, None, problem=tr("The image cannot be read: {reason}").format(reason=reason))
    return Picture(path, _image(bands), width, height, metadata)


def _image(bands: np.ndarray) -> QImage:
    """Image of bands (h, w) or (b, h, w): grey or colours, with or without a mask."""
    bands = bands.reshape(-1, *bands.shape[-2:])
    count, height, width = bands.shape
    masked = count in (_GREY_WITH_MASK, _COLOURS_WITH_MASK)
    colours = bands[: count - 1] if masked else bands[:3]
    pixels = np.empty((height, width, 4), np.uint8)
    pixels[..., :3] = np.moveaxis(np.broadcast_to(colours, (3, height, width)), 0, -1)
    pixels[..., 3] = bands[-1] if masked else _OPAQUE
    # A copy: the image does not own what it is made from.
    return QImage(pixels.tobytes(), width, height, 4 * width, QImage.Format.Format_RGBA8888).copy()
