"""Sample a raster file's layer, at its pixels or on another grid, without QGIS's approximate reprojection.

QGIS first resamples a raster to another grid and then takes the nearest pixels, which displaces them by more than a
pixel in places. Here QGIS only styles the raster; each image pixel takes the raster pixel that contains its centre.
"""

from __future__ import annotations

import math
import struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from qgis.core import (
    Qgis,
    QgsCoordinateTransform,
    QgsCsException,
    QgsGeometry,
    QgsMapSettings,
    QgsRasterDataProvider,
    QgsRasterLayer,
    QgsRectangle,
)

from ...core.arrays import Bytes, Floats
from ...core.picture.resampling import sample
from .renderer import Jobs, Pipes

#: Header of a line in well-known binary: byte order, type (2), number of points.
_HEADER = struct.Struct("<BII")
#: Margin around the outermost samples in pixels, which the widest kernel needs.
_MARGIN_PX = 2
#: Kernels by the names of QGIS's resamplers; nearest if a layer has none.
_KERNELS = {"bilinear": "bilinear", "cubic": "bicubic"}


class SampledWindow(NamedTuple):
    """Window of a raster in cells of ``factor`` pixels a side; columns and rows from the raster's upper left."""

    factor: int
    left: int
    top: int
    width: int
    height: int


def enlarging_kernel(layer: QgsRasterLayer) -> str:
    """Kernel that a layer uses for enlarging."""
    if resamples_early(layer):
        # Providers have further methods, all smoother than bilinear: cubic is the closest kernel.
        method = QgsRasterDataProvider.ResamplingMethod
        exact = {method.Nearest: "nearest", method.Bilinear: "bilinear"}
        return exact.get(layer.dataProvider().zoomedInResamplingMethod(), "bicubic")
    resampler = layer.resampleFilter().zoomedInResampler() if layer.resampleFilter() else None
    return _KERNELS.get(resampler.type(), "nearest") if resampler is not None else "nearest"


def resamples_early(layer: QgsRasterLayer) -> bool:
    """Whether a layer's provider resamples values before styling."""
    return bool(
        layer.resamplingStage() == Qgis.RasterResamplingStage.Provider
        and layer.dataProvider().isProviderResamplingEnabled()
    )


def sampled(
    pipes: Pipes,
    settings: QgsMapSettings,
    edges_m: tuple[float, float, float, float],
    size: tuple[int, int],
    jobs: Jobs,
) -> Bytes | None:
    """Pixels of a layer at the pixel centres of an image.

    Parameters
    ----------
    pipes : Pipes
        Pipes of a raster file's layer.
    settings : QgsMapSettings
        Settings with the CRS of the image.
    edges_m : west, south, east, north
        Edges of the image, in its CRS.
    size : width, height
        Size of the image in px.
    jobs : Jobs

    Returns
    -------
    array (height, width, 4) of uint8, or None if the layer shows nothing there
        Premultiplied RGBA; alpha is 0 beyond the raster.
    """
    layer, (width, height) = pipes.layer, size
    x, y = _raster_positions(layer, settings, _centres(edges_m, size))
    inside = (x >= 0.0) & (x < layer.width()) & (y >= 0.0) & (y < layer.height())
    if not inside.any():
        return None
    cells = _cells(layer, x.reshape(height, width), y.reshape(height, width), inside)
    shown = pipes.block(_extent(layer, cells), (cells.width, cells.height), jobs)
    columns, rows = x[inside] / cells.factor - cells.left, y[inside] / cells.factor - cells.top
    picture = np.zeros((height * width, 4), np.uint8)
    kernel = enlarging_kernel(layer)
    if kernel == "nearest":
        picture[inside] = shown[rows.astype(np.intp), columns.astype(np.intp)]
    else:
        picture[inside] = np.clip(np.rint(sample(shown, columns, rows, kernel)), 0, 255)
    return picture.reshape(height, width, 4)


def averaged(pipes: Pipes, left_px: int, top_px: int, size: tuple[int, int], factor: int, jobs: Jobs) -> Bytes | None:
    """Pixels of a layer at its raster's resolution, or means of square blocks of these pixels.

    Parameters
    ----------
    pipes : Pipes
        Pipes of a raster file's layer.
    left_px, top_px : int
        Upper left corner of the image, in image pixels from the upper left corner of the raster.
    size : width, height
        Size of the image in px.
    factor : int
        Number of raster pixels along each side of an image pixel; a power of two.
    jobs : Jobs

    Returns
    -------
    array (height, width, 4) of uint8, or None if the layer shows nothing there
        Premultiplied RGBA; alpha is 0 if any raster pixel in the block is missing.
    """
    layer, (width, height) = pipes.layer, size
    # Average at most 8 raster pixels a side, to keep blocks small; for larger factors, QGIS subsamples first.
    each = min(factor, 8)
    picked = factor // each
    left, top = max(left_px * each, 0), max(top_px * each, 0)
    right = min((left_px + width) * each, -(-layer.width() // picked))
    bottom = min((top_px + height) * each, -(-layer.height() // picked))
    if left >= right or top >= bottom:
        return None
    cells = SampledWindow(picked, left, top, right - left, bottom - top)
    shown = pipes.block(_extent(layer, cells), (cells.width, cells.height), jobs)
    whole = np.zeros((height * each, width * each, 4), np.uint8)
    row, column = top - top_px * each, left - left_px * each
    whole[row : row + cells.height, column : column + cells.width] = shown
    if each == 1:
        return whole
    parts = whole.reshape(height, each, width, each, 4)
    means = (parts.sum(axis=(1, 3), dtype=np.uint32) + each * each // 2) // (each * each)
    means[parts[..., 3].min(axis=(1, 3)) == 0] = 0
    return means.astype(np.uint8)


def _centres(edges_m: tuple[float, float, float, float], size: tuple[int, int]) -> Floats:
    """Pixel centres of an image, row by row, (width * height, 2)."""
    (west, south, east, north), (width, height) = edges_m, size
    x = west + (np.arange(width) + 0.5) * ((east - west) / width)
    y = north - (np.arange(height) + 0.5) * ((north - south) / height)
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


def _raster_positions(layer: QgsRasterLayer, settings: QgsMapSettings, points: Floats) -> tuple[Floats, Floats]:
    """Columns and rows of a raster at points in the image's CRS; infinite outside the domain of a CRS."""
    transform = QgsCoordinateTransform(settings.destinationCrs(), layer.crs(), settings.transformContext())
    if not transform.isShortCircuited():
        points = _transformed(points, transform)
    extent = layer.extent()
    x = (points[:, 0] - extent.xMinimum()) * (layer.width() / extent.width())
    y = (extent.yMaximum() - points[:, 1]) * (layer.height() / extent.height())
    return x, y


def _transformed(points: Floats, transform: QgsCoordinateTransform) -> Floats:
    """Points transformed by QGIS, many in each call."""
    # PyQGIS holds the GIL during a call; 4096 points take a few milliseconds.
    parts = np.array_split(points, -(-len(points) // 4096))
    return np.concatenate([_line_transformed(part, transform) for part in parts])


def _line_transformed(points: Floats, transform: QgsCoordinateTransform) -> Floats:
    line = QgsGeometry()
    line.fromWkb(_HEADER.pack(1, 2, len(points)) + points.astype("<f8").tobytes())
    try:
        line.transform(transform)
    except QgsCsException:
        return np.full_like(points, np.inf)
    return np.frombuffer(bytes(line.asWkb()), "<f8", offset=_HEADER.size).reshape(-1, 2)


def _cells(layer: QgsRasterLayer, x: Floats, y: Floats, inside: NDArray[np.bool_]) -> SampledWindow:
    """Window that contains all samples; cells are pixels, or blocks of them if an image pixel spans four or more."""
    steps = [np.abs(np.diff(values, axis=axis)) for values in (x, y) for axis in (0, 1)]
    # Raster pixels per image pixel, along each image axis: the raster may be rotated.
    ratio = min(
        float(np.median(np.hypot(steps[axis], steps[2 + axis]))) if steps[axis].size else 1.0 for axis in (0, 1)
    )
    factor = 1 << max(math.floor(math.log2(ratio)) - 1, 0) if math.isfinite(ratio) and ratio > 0.0 else 1
    columns, rows = x.ravel()[inside] / factor, y.ravel()[inside] / factor
    left, top = (max(math.floor(values.min()) - _MARGIN_PX, 0) for values in (columns, rows))
    right = min(math.floor(columns.max()) + 1 + _MARGIN_PX, -(-layer.width() // factor))
    bottom = min(math.floor(rows.max()) + 1 + _MARGIN_PX, -(-layer.height() // factor))
    return SampledWindow(factor, left, top, right - left, bottom - top)


def _extent(layer: QgsRasterLayer, cells: SampledWindow) -> QgsRectangle:
    """Extent of a window in the raster's CRS."""
    extent = layer.extent()
    step_x = extent.width() / layer.width() * cells.factor
    step_y = extent.height() / layer.height() * cells.factor
    west, north = extent.xMinimum() + cells.left * step_x, extent.yMaximum() - cells.top * step_y
    return QgsRectangle(west, north - cells.height * step_y, west + cells.width * step_x, north)
