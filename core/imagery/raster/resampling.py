"""Colours of the map's pixels out of a raster's: each the mean over the ground that it covers.

A pixel of the map becomes a box of the raster, along its columns and rows, as wide as the pixel's footprint but one
pixel of the raster at least, and its colour is the mean over the box, parts of pixels counted by their area. Where
the map shrinks the raster that is the average; where it does not, it is bilinear interpolation; and where the two
grids fall together it is the raster's pixel itself.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .reading import Bytes

Floats = NDArray[np.float64]
Sums = NDArray[np.unsignedinteger[Any]]

#: Most pixels of a raster that a part of a picture is made of: their sums stay within 32 bits.
MOST_PX = 4096 * 4096
#: Share of a box that may lie beyond imagery: the noise of positions and weights, a fortieth of a grey level.
_SLACK = 1e-4


class Boxes(NamedTuple):
    """Boxes of a raster: centres and widths in px.

    Arrays (h, w), or (1, w) for columns and (h, 1) for rows where these do not depend on each other.
    """

    column_px: Floats
    row_px: Floats
    width_px: Floats
    height_px: Floats

    @property
    def are_upright(self) -> bool:
        """Whether columns and rows do not depend on each other."""
        return self.column_px.shape[0] == 1 and self.row_px.shape[1] == 1

    def scaled(self, left: float, top: float, x: float, y: float) -> Boxes:
        """Boxes in other pixels, which are ``x`` and ``y`` times as large and begin at ``left, top`` of these."""
        return Boxes(
            (self.column_px - left) / x, (self.row_px - top) / y, self.width_px / x, self.height_px / y
        )


def boxes(column_px: Floats, row_px: Floats) -> Boxes:
    """Footprints of the map's pixels in a raster.

    Parameters
    ----------
    column_px, row_px : array (h + 2, w + 2), or (1, w + 2) and (h + 2, 1)
        Positions of pixels' centres, with those of the pixels around.

    Returns
    -------
    Boxes
        Of the (h, w) pixels. Width is the step of columns across a pixel and down a pixel, taken together as by
        Pythagoras: a turned raster has boxes as large as one that is not. Not finite where positions are not.
    """
    with np.errstate(invalid="ignore"):
        if column_px.shape[0] == 1:
            return Boxes(
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
        return Boxes(column_px[inner], row_px[inner], sizes[0], sizes[1])


def _step(values: Floats, axis: int) -> Floats:
    """Step from pixel to pixel: the smaller one of those to both sides, one of which may go around the Earth."""
    steps = np.abs(np.diff(values, axis=axis))
    before, after = (steps[:-1], steps[1:]) if axis == 0 else (steps[:, :-1], steps[:, 1:])
    smaller: Floats = np.fmin(before, after)
    return smaller


def reduced(colours: Bytes, x: int, y: int) -> Sums:
    """Sums over blocks of ``x`` by ``y`` pixels of (h, w, c); blocks at the end may be less than full."""
    if x == y == 1:
        return colours
    rows = np.add.reduceat(colours, np.arange(0, colours.shape[0], y), axis=0, dtype=np.uint32)
    return np.add.reduceat(rows, np.arange(0, colours.shape[1], x), axis=1)


def means(ground: Sums, over: Boxes, block: int) -> Bytes:
    """Colours of boxes.

    Parameters
    ----------
    ground : array (h, w, 4)
        Sums of red, green and blue, and count of the pixels that have imagery, of ``block`` pixels each.
    over : Boxes
        In pixels of ``ground``; beyond it there is no imagery.
    block : int

    Returns
    -------
    array (height, width, 4) of uint8
        The fourth channel is 255 where the whole box has imagery, else all are 0.
    """
    if over.are_upright:
        down = _means_along(ground, over.row_px[:, 0], over.height_px[:, 0])
        total = _means_along(down.swapaxes(0, 1), over.column_px[0], over.width_px[0]).swapaxes(0, 1)
    else:
        total = _means_anyhow(ground, over)
    total /= block
    whole = total[..., 3] > 1.0 - _SLACK
    picture = np.zeros(total.shape, np.uint8)
    picture[..., :3] = np.minimum(np.rint(total[..., :3]), 255.0)
    picture[..., 3] = 255
    picture[~whole] = 0
    return picture


def _means_along(values: Sums | Floats, centre: Floats, width: Floats) -> Floats:
    """Means of the first axis over intervals, from the differences of running totals."""
    kind = np.float64 if values.dtype == np.float64 else np.uint32
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


def _means_anyhow(ground: Sums, over: Boxes) -> Floats:
    height, width, channels = ground.shape
    # Sums of bytes are exact in float32, and `take` is three times as fast as an index.
    flat = ground.reshape(-1, channels).astype(np.float32)
    columns, across = _taps(over.column_px, over.width_px, width)
    rows, down = _taps(over.row_px, over.height_px, height)
    total = np.zeros((over.column_px.size, channels), np.float32)
    for j in range(len(rows)):
        line = np.zeros_like(total)
        for i in range(len(columns)):
            line += across[i][:, np.newaxis] * flat.take(rows[j] * width + columns[i], axis=0)
        total += down[j][:, np.newaxis] * line
    return total.reshape(*over.column_px.shape, channels).astype(np.float64)


def _taps(centre: Floats, size: Floats, count: int) -> tuple[NDArray[np.intp], NDArray[np.float32]]:
    """Indices and weights (taps, n) of the pixels along one axis that boxes reach; weights are 0 beyond the raster."""
    reached = np.isfinite(centre) & np.isfinite(size)
    middle = np.where(reached, centre, -2.0 * count).ravel()
    wide = np.where(reached, size, 1.0).ravel()
    # Far beyond the raster a box reaches as little as just beyond it, and is no larger than need be there.
    beyond = (middle + wide / 2.0 <= 0.0) | (middle - wide / 2.0 >= count)
    middle, wide = np.where(beyond, -2.0, middle), np.where(beyond, 1.0, wide)
    low, high = middle - wide / 2.0, middle + wide / 2.0
    first = np.floor(low).astype(np.intp)
    taps = 1 + math.ceil(float(wide.max()))
    index = first + np.arange(taps)[:, np.newaxis]
    weights = np.clip(np.minimum(high, index + 1) - np.maximum(low, index), 0.0, None) / wide
    weights[(index < 0) | (index >= count)] = 0.0
    return np.clip(index, 0, count - 1), weights.astype(np.float32)
