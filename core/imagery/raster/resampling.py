"""Resampling of a raster to the map's pixels, each of which becomes the mean over the ground it covers.

The footprint of a map pixel is a box along the raster's columns and rows, at least one raster pixel wide; the pixel's
colour is the mean over this box, weighted by area. The result is an average if the map is coarser than the raster, a
bilinear interpolation if not, and a copy if the grids coincide.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Floats, NDArray
from ...bands import fitted, full
from .reading import Values

#: Sums of blocks of pixels: whole numbers, or float64 for values that are floats.
Sums = NDArray[Any]

#: Most pixels of a raster read for a part of a picture, so that sums of bytes fit 32 bits.
MOST_PX = 4096 * 4096


class PixelFootprints(NamedTuple):
    """Boxes in a raster, by centres and sizes in px.

    Arrays (h, w), or, if columns and rows are independent, (1, w) for columns and (h, 1) for rows.
    """

    column_px: Floats
    row_px: Floats
    width_px: Floats
    height_px: Floats

    @property
    def are_upright(self) -> bool:
        """Whether columns and rows are independent."""
        return self.column_px.shape[0] == 1 and self.row_px.shape[1] == 1

    def scaled(self, left: float, top: float, x: float, y: float) -> PixelFootprints:
        """Convert to pixels of ``x`` by ``y`` px, counted from ``left, top``."""
        return PixelFootprints(
            (self.column_px - left) / x, (self.row_px - top) / y, self.width_px / x, self.height_px / y
        )


def pixel_footprints(column_px: Floats, row_px: Floats) -> PixelFootprints:
    """Footprints of the map's pixels in a raster.

    Parameters
    ----------
    column_px, row_px : array (h + 2, w + 2), or (1, w + 2) and (h + 2, 1)
        Positions of the centres of the pixels and of a border of one pixel.

    Returns
    -------
    PixelFootprints
        Footprints of the (h, w) pixels. The width is the root of the sum of squares of the column steps across and down
        a pixel, which a rotation of the raster does not change. Values are not finite where positions are not.
    """
    with np.errstate(invalid="ignore"):
        if column_px.shape[0] == 1:
            return PixelFootprints(
                column_px[:, 1:-1],
                row_px[1:-1],
                np.maximum(_step(column_px, 1), 1.0),
                np.maximum(_step(row_px, 0), 1.0),
            )
        inner = (slice(1, -1), slice(1, -1))
        sizes = [
            np.maximum(np.hypot(_step(values[1:-1], 1), _step(values[:, 1:-1], 0)), 1.0)
            for values in (column_px, row_px)
        ]
        return PixelFootprints(column_px[inner], row_px[inner], sizes[0], sizes[1])


def _step(values: Floats, axis: int) -> Floats:
    """Smaller of the steps to both neighbours, as the other step may cross the antimeridian."""
    steps = np.abs(np.diff(values, axis=axis))
    before, after = (steps[:-1], steps[1:]) if axis == 0 else (steps[:, :-1], steps[:, 1:])
    smaller: Floats = np.fmin(before, after)
    return smaller


def are_pixels(footprints: PixelFootprints, height: int, width: int) -> bool:
    """Whether footprints are the pixels of a raster (height, width), each once."""
    shape = footprints.row_px.shape[0], footprints.column_px.shape[1]
    return shape == (height, width) and _whole_pixels(footprints) == ((0, 1), (0, 1))


def reduced(colours: Values, x: int, y: int) -> Sums:
    """Sums of values (h, w, c) over blocks of ``x`` by ``y`` pixels; blocks at the ends may be smaller."""
    if x == y == 1:
        return colours
    wide: Any = np.float64 if colours.dtype.kind == "f" else np.int64
    kind = wide if colours.dtype.itemsize > 1 else np.uint32
    rows = np.add.reduceat(colours, np.arange(0, colours.shape[0], y), axis=0, dtype=kind)
    return np.add.reduceat(rows, np.arange(0, colours.shape[1], x), axis=1)


def means(ground: Sums, footprints: PixelFootprints, block: int, data_type: str = "uint8") -> Values:
    """Means of the values over footprints.

    Parameters
    ----------
    ground : array (h, w, c + 1)
        Sums of the bands' values, and the number of pixels with imagery, for blocks of ``block`` pixels.
    footprints : PixelFootprints
        In pixels of ``ground``; there is no imagery beyond ``ground``.
    block : int
    data_type : str
        Type of the result.

    Returns
    -------
    array (height, width, c + 1) of that type
        The last channel is nonzero (255 for uint8) if the whole footprint has imagery; otherwise all channels are 0.
    """
    kind = np.dtype(data_type)
    pixels = _whole_pixels(footprints)
    shape = footprints.row_px.shape[0], footprints.column_px.shape[1]
    if pixels is not None and block == 1:
        picture = _copied_pixels(ground, shape, pixels).astype(kind, copy=False)
        picture[..., -1] *= full(kind)
        return picture
    if pixels is not None:
        total = _copied_pixels(ground, shape, pixels).astype(np.float64)
    elif not footprints.are_upright:
        total = _rotated_means(ground, footprints)
    elif kind.kind == "f":
        # Running totals of floats would lose digits to distant values.
        down = _weighted(ground, footprints.row_px[:, 0], footprints.height_px[:, 0])
        total = _weighted(down.swapaxes(0, 1), footprints.column_px[0], footprints.width_px[0]).swapaxes(0, 1)
    else:
        down = _running_means(ground, footprints.row_px[:, 0], footprints.height_px[:, 0])
        total = _running_means(down.swapaxes(0, 1), footprints.column_px[0], footprints.width_px[0]).swapaxes(0, 1)
    total /= block
    # The tolerance of 1e-4, a fortieth of a grey level, covers the noise of positions and weights.
    is_covered = total[..., -1] > 1.0 - 1e-4
    picture = fitted(total, kind)
    picture[..., -1] = full(kind)
    picture[~is_covered] = 0
    return picture


def without_mask(picture: Values) -> Values:
    """Copy all channels of a picture (h, w, c + 1) but the last; numpy is quicker channel by channel."""
    copied = np.empty((*picture.shape[:2], picture.shape[2] - 1), picture.dtype)
    for channel in range(copied.shape[2]):
        copied[..., channel] = picture[..., channel]
    return copied


def _whole_pixels(footprints: PixelFootprints) -> tuple[tuple[int, int], tuple[int, int]] | None:
    """First row and first column, each with its step, of pixels equal to the footprints; None if any differs."""
    # Tolerance for the noise of positions, px.
    same_px = 1e-5
    if not footprints.are_upright:
        return None
    found = []
    for centre, width in (
        (footprints.row_px[:, 0], footprints.height_px),
        (footprints.column_px[0], footprints.width_px),
    ):
        if not np.isfinite(centre).all():
            return None
        index = np.floor(centre)
        if np.abs(centre - index - 0.5).max() > same_px or np.abs(width - 1.0).max() > same_px:
            return None
        step = int(index[1] - index[0]) if len(index) > 1 else 1
        # Footprints must be adjacent, in either direction.
        if abs(step) != 1 or index[-1] - index[0] != step * (len(index) - 1):
            return None
        found.append((int(index[0]), step))
    return found[0], found[1]


def _copied_pixels(
    ground: Sums,
    shape: tuple[int, int],
    first: tuple[tuple[int, int], tuple[int, int]],
) -> Sums:
    """Copy pixels, starting at a row and a column, each with its step; 0 beyond the ground.

    The ground itself is returned if that is all of it.
    """
    if ground.shape[:2] == shape and first == ((0, 1), (0, 1)):
        return ground
    picture = np.zeros((*shape, ground.shape[2]), ground.dtype)
    target, origin = zip(*(_common(*one, *sizes) for one, sizes in zip(first, zip(shape, ground.shape))))
    picture[target] = ground[origin]
    return picture


def _common(first: int, step: int, count: int, size: int) -> tuple[slice, slice]:
    """Slices of positions in a sequence of ``count`` indices, and of these indices, limited to 0 ≤ index < ``size``."""
    low, high = (-first, size - first) if step > 0 else (first - size + 1, first + 1)
    low, high = min(max(low, 0), count), min(max(high, 0), count)
    if low >= high:
        return slice(0, 0), slice(0, 0)
    start, end = first + step * low, first + step * high
    return slice(low, high), slice(start, None if end < 0 else end, step)


def _weighted(values: Sums | Floats, centre: Floats, width: Floats) -> Floats:
    """Means along the first axis over intervals, as weighted sums of the values within."""
    index, weights = _taps(centre, width, len(values), np.float64)
    total: Floats = np.zeros((len(centre), *values.shape[1:]))
    for rows, share in zip(index, weights):
        total += share.reshape(-1, *[1] * (values.ndim - 1)) * values[rows]
    return total


def _running_means(values: Sums | Floats, centre: Floats, width: Floats) -> Floats:
    """Means along the first axis over intervals, as differences of running totals."""
    kind: Any = np.float64 if values.dtype == np.float64 else np.int64
    if values.dtype in (np.uint8, np.uint32):
        kind = np.uint32
    totals = np.zeros((len(values) + 1, *values.shape[1:]), kind)
    np.cumsum(values, axis=0, out=totals[1:])

    def total_until(position: Floats) -> Floats:
        inside = np.clip(position, 0.0, len(values))
        index = np.minimum(inside.astype(np.intp), len(values) - 1)
        share = (inside - index).reshape(-1, *[1] * (values.ndim - 1))
        until: Floats = totals[index] + share * (totals[index + 1] - totals[index])
        return until

    sums = total_until(centre + width / 2.0) - total_until(centre - width / 2.0)
    result: Floats = sums / width.reshape(-1, *[1] * (values.ndim - 1))
    return result


def _rotated_means(ground: Sums, footprints: PixelFootprints) -> Floats:
    height, width, channels = ground.shape
    # float32 is precise enough for sums of bytes; `take` is three times as fast as indexing.
    kind: Any = np.float32 if ground.dtype in (np.uint8, np.uint32) else np.float64
    flat = ground.reshape(-1, channels).astype(kind)
    columns, across = _taps(footprints.column_px, footprints.width_px, width, kind)
    rows, down = _taps(footprints.row_px, footprints.height_px, height, kind)
    total: NDArray[Any] = np.zeros((footprints.column_px.size, channels), kind)
    for j in range(len(rows)):
        line = np.zeros_like(total)
        for i in range(len(columns)):
            line += across[i][:, np.newaxis] * flat.take(rows[j] * width + columns[i], axis=0)
        total += down[j][:, np.newaxis] * line
    return total.reshape(*footprints.column_px.shape, channels).astype(np.float64)


def _taps(centre: Floats, size: Floats, count: int, kind: Any) -> tuple[NDArray[np.intp], NDArray[Any]]:
    """Indices and weights (taps, n) of the pixels along an axis under footprints; weights are 0 beyond the raster."""
    reached = np.isfinite(centre) & np.isfinite(size)
    middle = np.where(reached, centre, -2.0 * count).ravel()
    wide = np.where(reached, size, 1.0).ravel()
    # To keep the number of taps small, move footprints beyond the raster near to it and set their width to 1.
    beyond = (middle + wide / 2.0 <= 0.0) | (middle - wide / 2.0 >= count)
    middle, wide = np.where(beyond, -2.0, middle), np.where(beyond, 1.0, wide)
    low, high = middle - wide / 2.0, middle + wide / 2.0
    first = np.floor(low).astype(np.intp)
    taps = 1 + math.ceil(float(wide.max()))
    index = first + np.arange(taps)[:, np.newaxis]
    weights = np.clip(np.minimum(high, index + 1) - np.maximum(low, index), 0.0, None) / wide
    weights[(index < 0) | (index >= count)] = 0.0
    return np.clip(index, 0, count - 1), weights.astype(kind)
